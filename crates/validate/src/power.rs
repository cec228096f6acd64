//! Power of the rows: every number of the cars changed by itself, every choice made otherwise, and the rows judged again. A row that
//! keeps its verdict under all of that is no evidence for any of it.
//!
//! A change goes to every car of the sources that has its keys, before the overrides of the source. Small factors and choices are tried on all
//! rows, large factors on those that have kept their verdict until then.

use std::cell::RefCell;
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Value, json as object};

use super::judge::{CandidateVehicle, Judged, Report, judge_rows};
use super::perturbation::{KnownCars, Perturbation, lists};
use super::rows::{RowFile, ValidationRow};
use super::rule::Verdict;
use super::source::Source;
use super::store::{Cars, once};
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{KeyInfo, Override, Problems, Target};
use cvtcycle_model::rig::transmission::Conditions;
use cvtcycle_output::columns;
use cvtcycle_output::progress::Progress;
use cvtcycle_output::table::{Column, csv_bytes};

/// Keys that flip a sharp row by a small factor, at least.
const SHARP: usize = 3;

/// Name, options and own overrides of the car of a source.
fn parts(
    candidate: &CandidateVehicle,
    source: Option<&Source>,
) -> (String, Options, Vec<Override>) {
    let mut options = candidate.options(source);
    let set = source.map_or(&[][..], |source| &source.set);
    let own = set.iter().filter(|by| by.target() != Target::Rig).count();
    let own = options.set.split_off(options.set.len().saturating_sub(own));
    let name = format!("{} {options:?}", candidate.vehicle_of(source));
    (name, options, own)
}

/// Every change of the cars of some files.
pub struct Perturbations {
    known: KnownCars,
    /// Those that all rows see, then the large ones.
    lists: [Vec<Perturbation>; 2],
}

impl Perturbations {
    /// The changes of the cars of all sources.
    #[must_use]
    pub fn new(files: &[RowFile], candidate: &CandidateVehicle) -> Self {
        let mut known = KnownCars::new();
        let sources = files.iter().flat_map(|file| &file.sources).map(Some);
        for source in std::iter::once(None).chain(sources) {
            let (name, options, _) = parts(candidate, source);
            let keys = || load(candidate.vehicle_of(source), &options).map(|setup| setup.keys);
            known
                .entry(name)
                .or_insert_with(|| keys().unwrap_or_default());
        }
        let lists = lists(&known);
        Perturbations { known, lists }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lists.iter().map(Vec::len).sum()
    }

    /// Judges the rows of a report again under each change, on all threads; none if `progress` stopped it.
    #[must_use]
    pub fn power(
        &self,
        files: &[RowFile],
        report: &Report,
        progress: &dyn Progress,
    ) -> Option<PowerReport> {
        let compared = report.rows.iter();
        let compared: Vec<&Judged> = compared
            .filter(|judged| judged.computed.is_some() && judged.row.printed.is_some())
            .collect();
        let mut rows: Vec<RowPower> = compared
            .iter()
            .map(|judged| RowPower::new(judged))
            .collect();
        let mut refused = Vec::new();
        for list in &self.lists {
            // The first list goes to all of them: nothing has flipped yet.
            let left = rows.iter().zip(&compared);
            let left: HashMap<&str, (usize, &Judged)> = left
                .enumerate()
                .filter(|(_, (row, _))| row.flips.is_empty())
                .map(|(k, (_, judged))| (judged.row.id.as_str(), (k, *judged)))
                .collect();
            let try_one = |by: &Perturbation| {
                if progress.stopped() {
                    return Ok(Vec::new());
                }
                let cars = ChangedCars {
                    candidate: &report.candidate,
                    known: &self.known,
                    by,
                    setups: RefCell::default(),
                };
                let found = rejudged(files, &cars, &left);
                progress.advance(1);
                found
            };
            let found: Vec<Result<Vec<Seen>, String>> = list.par_iter().map(try_one).collect();
            if progress.stopped() {
                return None;
            }
            for (by, found) in list.iter().zip(found) {
                match found {
                    Ok(found) => found
                        .into_iter()
                        .for_each(|seen| rows[seen.row].note(by, seen.verdict)),
                    Err(why) => refused.push(Refused {
                        change: by.text(),
                        why,
                    }),
                }
            }
        }
        Some(PowerReport {
            rows,
            tried: self.count(),
            refused,
        })
    }
}

/// The cars of the sources with one change.
struct ChangedCars<'a> {
    candidate: &'a CandidateVehicle,
    known: &'a KnownCars,
    by: &'a Perturbation,
    setups: RefCell<HashMap<String, Result<Rc<Setup>, Problems>>>,
}

impl Cars for ChangedCars<'_> {
    fn setup(&self, source: Option<&Source>) -> Result<Rc<Setup>, Problems> {
        let (name, mut options, own) = parts(self.candidate, source);
        let known = self.known.get(&name).map_or(&[][..], Vec::as_slice);
        options.set.extend(self.by.overrides(known));
        options.set.extend(own);
        let vehicle = self.candidate.vehicle_of(source);
        once(&self.setups, format!("{vehicle} {options:?}"), || {
            load(vehicle, &options).map(Rc::new)
        })
    }

    fn conditions(&self, source: Option<&Source>) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        self.candidate.conditions(source)
    }
}

/// A row that came out otherwise under a change.
struct Seen {
    row: usize,
    verdict: Verdict,
}

/// How easily the verdict of a row flips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strength {
    /// By small factors on three keys or more.
    Sharp,
    /// By small factors on one or two keys.
    Weak,
    /// By a large factor or another choice alone.
    Blunt,
    /// By nothing that was tried.
    Never,
}

impl Strength {
    /// All of them.
    pub const ALL: [Strength; 4] = [
        Strength::Sharp,
        Strength::Weak,
        Strength::Blunt,
        Strength::Never,
    ];

    /// The word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Strength::Sharp => "sharp",
            Strength::Weak => "weak",
            Strength::Blunt => "blunt",
            Strength::Never => "never",
        }
    }
}

/// A change that flips the verdict of a row.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Flip {
    /// The change, such as `transmission.cvt.ratio.low x0.6`.
    pub change: String,
    /// Verdict after the change.
    pub verdict: &'static str,
    /// True for a small factor on a number.
    pub small: bool,
    /// Key, or name of the keys.
    #[serde(skip)]
    name: String,
}

/// Effect of the changes on a row.
#[derive(Clone, Debug, PartialEq)]
pub struct RowPower {
    /// Identifier.
    pub id: String,
    /// Word of its group.
    pub group: &'static str,
    /// Verdict without a change.
    pub verdict: Verdict,
    /// Recorded verdict.
    pub recorded: Option<Verdict>,
    /// Changes that flip the verdict.
    pub flips: Vec<Flip>,
    /// Changes under which the computed result, or a number behind it, is another one.
    pub moved: usize,
}

impl RowPower {
    fn new(judged: &Judged) -> Self {
        RowPower {
            id: judged.row.id.clone(),
            group: judged.group.word(),
            verdict: judged.verdict,
            recorded: judged.row.recorded,
            flips: Vec::new(),
            moved: 0,
        }
    }

    /// Notes a change under which the row comes out otherwise, with its verdict then.
    fn note(&mut self, by: &Perturbation, verdict: Verdict) {
        self.moved += 1;
        // Without a number there is no verdict that it could be.
        if verdict != self.verdict && verdict != Verdict::NotComputed {
            self.flips.push(Flip {
                change: by.text(),
                verdict: verdict.word(),
                small: by.is_small(),
                name: by.name.clone(),
            });
        }
    }

    /// How easily its verdict flips.
    #[must_use]
    pub fn strength(&self) -> Strength {
        let small = self.flips.iter().filter(|flip| flip.small);
        let keys: BTreeSet<&str> = small.map(|flip| flip.name.as_str()).collect();
        match (keys.len(), self.flips.is_empty()) {
            (SHARP.., _) => Strength::Sharp,
            (1.., _) => Strength::Weak,
            (0, false) => Strength::Blunt,
            (0, true) => Strength::Never,
        }
    }

    /// The changes that flip it, in one line.
    #[must_use]
    pub fn flips_text(&self, most: usize) -> String {
        let shown = self.flips.iter().take(most);
        let mut texts: Vec<String> = shown
            .map(|flip| format!("{} ({})", flip.change, flip.verdict))
            .collect();
        if self.flips.len() > most {
            texts.push(format!("{} more", self.flips.len() - most));
        }
        texts.join("; ")
    }

    /// Finds a fault of the recorded verdict from the effect of the changes.
    fn fault(&self) -> Option<String> {
        let id = &self.id;
        match (self.recorded?, self.flips.first()) {
            (Verdict::Identity, Some(flip)) => Some(format!(
                "row {id}: `identity` recorded, but {} makes it `{}`",
                flip.change, flip.verdict
            )),
            (Verdict::Agrees, None) if self.moved == 0 => Some(format!(
                "row {id}: `agrees` recorded, but no change of the cars reaches its number: `identity`"
            )),
            _ => None,
        }
    }
}

/// A change that the program refuses for the candidate vehicle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refused {
    /// The change.
    pub change: String,
    /// Why.
    pub why: String,
}

/// Effect of the changes on the rows that are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerReport {
    /// Rows in order.
    pub rows: Vec<RowPower>,
    /// Number of changes.
    pub tried: usize,
    /// Those that are refused.
    pub refused: Vec<Refused>,
}

impl PowerReport {
    /// Rows of a strength.
    pub fn rows_with(&self, strength: Strength) -> impl Iterator<Item = &RowPower> {
        self.rows
            .iter()
            .filter(move |row| row.strength() == strength)
    }

    /// A line for each row whose recorded verdict the changes contradict.
    #[must_use]
    pub fn faults(&self) -> Vec<String> {
        self.rows.iter().filter_map(RowPower::fault).collect()
    }

    /// As an entry of the JSON object of the rows.
    #[must_use]
    pub fn json(&self) -> Value {
        let row = |row: &RowPower| {
            object!({
                "id": row.id,
                "power": row.strength().word(),
                "moved": row.moved,
                "flips": row.flips,
            })
        };
        let count = |strength: Strength| {
            let count = self.rows_with(strength).count();
            (strength.word().to_owned(), count.into())
        };
        object!({
            "tried": self.tried,
            "refused": self.refused,
            "counts": Strength::ALL.into_iter().map(count).collect::<serde_json::Map<_, Value>>(),
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
        })
    }

    /// A line a row; empty without rows.
    #[must_use]
    pub fn csv(&self) -> Vec<u8> {
        csv_bytes(&of_row(), &self.rows).unwrap_or_default()
    }
}

fn of_row() -> Vec<Column<RowPower>> {
    columns! { RowPower;
        text "id", "", "row", r => r.id.clone();
        text "group", "", "whose number it is", r => r.group.to_owned();
        text "verdict", "", "verdict without a change", r => r.verdict.word().to_owned();
        text "recorded", "", "recorded verdict", r => r.recorded.map_or("", Verdict::word).to_owned();
        text "power", "", "how easily the verdict flips", r => r.strength().word().to_owned();
        text "flips", "", "changes that flip it", r => r.flips.len().to_string();
        text "moved", "", "changes that move its number", r => r.moved.to_string();
        text "flipped_by", "", "the changes, with the verdict", r => r.flips_text(usize::MAX);
    }
}

/// Rows that come out otherwise with changed cars, or why there are no such cars.
fn rejudged(
    files: &[RowFile],
    cars: &ChangedCars<'_>,
    left: &HashMap<&str, (usize, &Judged)>,
) -> Result<Vec<Seen>, String> {
    let first = |problems: Problems| {
        let first = problems.first().map(|problem| problem.message.clone());
        first.unwrap_or_default()
    };
    cars.setup(None).map_err(first)?;
    let wanted = |row: &ValidationRow| left.contains_key(row.id.as_str());
    let (rows, _) = judge_rows(files, cars, wanted).map_err(|problem| problem.message)?;
    let other = rows.iter().filter_map(|judged| {
        let (row, before) = left.get(judged.row.id.as_str())?;
        (judged.computed != before.computed).then_some(Seen {
            row: *row,
            verdict: judged.verdict,
        })
    });
    Ok(other.collect())
}
