//! Numbers of a run as one object: `run --json`, `summary.json`, and the source of the printed tables.
//!
//! Names are a contract with users' scripts. A number that was not computed, or is not finite, is null. Units for people (degC, kJ, L/100 km)
//! begin here.

mod alike;
mod failure;
mod known;
mod maps_left;
mod phases;
mod price;
mod run;

pub use alike::{Difference, differences, words as likeness};
pub use failure::{Deficit, Failure, has_failed_trace};
pub use known::{Contradiction, DrawnDifference, FAILED_SHARES};
pub use maps_left::{MapLeft, find_maps_left};
pub use phases::PhaseSummary;
pub use price::{LossPrice, PairPrice, PriceSummary, Saving};
pub use run::{Over, RunSummary, Solve, run_summary};

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use super::record::{Manifest, Record, run_word};
use crate::fleet_spread::FleetRange;
use crate::number::{finite, plain};
use cvtcycle_config::cycle::{Cycle, Repair};
use cvtcycle_config::setup::{Setup, start_of_log};
use cvtcycle_model::drive::{Outcome, Start};
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::thermal::{START_NODES, StartTemperatures};

/// Version of the object; a new number when a name goes or changes its meaning.
pub const SCHEMA: u32 = 1;
/// Role of a car that is the subject before the changes of its user.
pub const UNCHANGED: &str = "unchanged";

/// A whole run: the subject and its baselines through one cycle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Version [`SCHEMA`] of this object, and the program.
    #[serde(flatten)]
    pub manifest: Manifest,
    /// Name of the cycle.
    pub cycle: String,
    /// Interpretation of the cycle's file, if it is not in the program's own form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub read_as: Option<String>,
    /// How the cycle's recording was repaired, and what is doubted; none of a cycle that was written as one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordingSummary>,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `soak`, `warm`, the temperature of all nodes in degC, or those of single nodes.
    pub start: StartWord,
    /// Other settings.
    pub settings: Settings,
    /// The subject, then the baselines.
    pub runs: Vec<RunSummary>,
    /// The subject against each baseline.
    pub comparison: Vec<Comparison>,
    /// Published numbers that this run contradicts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub contradicted: Vec<Contradiction>,
}

/// A recorded cycle: its repairs and doubts, and how far its resolution leaves the results open.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordingSummary {
    /// Repairs that were made.
    pub repairs: Vec<RepairSummary>,
    /// Doubts, each a sentence without its full stop.
    pub doubts: Vec<String>,
    /// True where rows come at a rate, so that it is a log and no schedule.
    pub is_log: bool,
    /// Ends of the subject's fuel, in the unit of its headline, that rate, resolution and smoothing leave; none of speeds that were not smoothed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fuel: Option<[f64; 2]>,
    /// The same of the difference to each baseline, per cent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub percent: Vec<Option<[f64; 2]>>,
    /// Other quantities of the log, with those that are computed of the subject.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<MeasuredSummary>,
    /// True where the drive starts with the temperatures with which the log begins.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub starts: bool,
}

/// A quantity of a log and the computed one, over the time in which it was recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredSummary {
    /// Name.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Mean of the log.
    pub measured: f64,
    /// Mean as computed.
    pub computed: f64,
    /// Root mean square of the difference.
    pub rms: f64,
    /// Time in which it was recorded, s.
    pub seconds: f64,
    /// Means over up to 300 stretches of the drive: time at the middle, s, log, computed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub series: Vec<[f64; 3]>,
}

/// A repair of a recording.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RepairSummary {
    /// Name, as `--repair` has it.
    pub name: String,
    /// Number of rows, samples or gaps.
    pub count: usize,
    /// Description of what was done.
    pub what: String,
}

impl RecordingSummary {
    /// Repairs and doubts of a cycle.
    #[must_use]
    pub fn of(cycle: &Cycle) -> Option<Self> {
        let recording = cycle.recording.as_deref()?;
        let repair = |repair: &Repair| RepairSummary {
            name: repair.name.clone(),
            count: repair.count,
            what: repair.what.clone(),
        };
        Some(RecordingSummary {
            repairs: recording.repairs.iter().map(repair).collect(),
            doubts: recording.doubts.clone(),
            is_log: recording.is_log,
            ..RecordingSummary::default()
        })
    }
}

/// Start as the user wrote it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum StartWord {
    /// `soak` or `warm`.
    Word(String),
    /// All nodes at a temperature, degC.
    Degc(f64),
    /// Nodes at temperatures of their own by name, degC; the others follow (TH-10).
    Nodes(IndexMap<String, f64>),
}

/// The word of a start that follows the log.
pub const AUTO: &str = "auto";

/// A start as it is on a cycle: that of the word `auto` is with the temperatures with which a log begins, where it has them, else a soak.
#[must_use]
pub fn start_on(cycle: &Cycle, (start, word): (Start, StartWord)) -> (Start, StartWord) {
    if word != StartWord::Word(AUTO.to_owned()) {
        return (start, word);
    }
    let recording = cycle.recording.as_deref().filter(|own| own.is_log);
    match recording.and_then(start_of_log) {
        Some(nodes) => (Start::Nodes(nodes), StartWord::of_nodes(&nodes)),
        None => (Start::Soak, StartWord::Word("soak".to_owned())),
    }
}

impl StartWord {
    /// Formats as an option: the word, or the number.
    #[must_use]
    pub fn text(&self) -> String {
        match self {
            StartWord::Word(word) => word.clone(),
            StartWord::Degc(degc) => degc.to_string(),
            StartWord::Nodes(nodes) => {
                let each = nodes.iter().map(|(name, degc)| format!("{name}={degc}"));
                each.collect::<Vec<_>>().join(",")
            }
        }
    }

    /// Temperatures of single nodes.
    #[must_use]
    pub fn of_nodes(start: &StartTemperatures) -> Self {
        let given = START_NODES.iter().zip(start.given_k);
        let degc = |k: f64| ((k - ZERO_DEGC_K) * 1e9).round() / 1e9; // as written: rounding of the shift to K goes
        StartWord::Nodes(
            given
                .filter_map(|(name, k)| Some(((*name).to_owned(), degc(k?))))
                .collect(),
        )
    }

    /// Says where single nodes begin, with the nodes that follow them: "coolant (engine oil) at 81 degC, sump (metal, belt) at 60 degC, tyre at
    /// ambient"; none for the other starts.
    #[must_use]
    pub fn nodes_in_words(&self) -> Option<String> {
        let StartWord::Nodes(nodes) = self else {
            return None;
        };
        let given_k = START_NODES.map(|name| nodes.get(name).copied());
        let start = StartTemperatures { given_k };
        let spoken = |node: usize| START_NODES[node].replace('_', " ");
        let led_by = |leader: Option<usize>| -> Vec<String> {
            let all = 0..START_NODES.len();
            let follows = |node: &usize| start.source(*node) == leader && Some(*node) != leader;
            all.filter(follows).map(spoken).collect()
        };
        let of_given = |(node, degc): (usize, f64)| {
            let with = match led_by(Some(node)).join(", ") {
                with if with.is_empty() => with,
                with => format!(" ({with})"),
            };
            format!("{}{with} at {} degC", spoken(node), plain(degc))
        };
        let given = given_k.into_iter().enumerate();
        let mut parts: Vec<String> = given
            .filter_map(|(node, degc)| Some(of_given((node, degc?))))
            .collect();
        let rest = led_by(None).join(", ");
        parts.extend((!rest.is_empty()).then(|| format!("{rest} at ambient")));
        Some(parts.join(", "))
    }
}

/// Settings other than cycle, ambient and start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Largest step, s.
    pub dt_s: f64,
    /// Reading of the belt model.
    pub formulation: String,
    /// Overrides of the subject.
    pub set: Vec<String>,
    /// Overrides of all cars.
    pub set_all: Vec<String>,
    /// True if departures from validity fail the run.
    pub strict: bool,
}

/// The subject against one baseline; positive means that the subject uses more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the baseline.
    pub baseline: String,
    /// Difference of the fuel per distance over the whole cycle (FTP75: weighted), of that per hour where there is no distance, per cent.
    pub fuel_percent: Option<f64>,
    /// Difference by group of phases, per cent.
    pub phases_percent: Named,
    /// "like for like", or a summary of the differences; empty in results of earlier versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub likeness: String,
    /// Differences other than the transmission and its oil: empty if the comparison is like for like.
    #[serde(default)]
    pub differences: Vec<Difference>,
    /// Difference over the draws of a plan of uncertainty; `None` for a case that was not drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<DrawnDifference>,
    /// Range of the difference from measured cars, where no draws give one, per cent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetRange>,
    /// Ranges of the differences by group of phases from measured cars, of cars that are not shipped, per cent.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub phases_fleet: IndexMap<String, [f64; 2]>,
}

/// A car that has been driven.
#[derive(Clone, Copy, Debug)]
pub struct Driven<'a> {
    /// Name, unique within the run.
    pub name: &'a str,
    /// Input.
    pub setup: &'a Setup,
    /// Result.
    pub outcome: &'a Outcome,
}

/// Summarises a run; the first car is the subject.
///
/// ```
/// use cvtcycle_config::Problems;
/// use cvtcycle_config::cycle;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::{Conditions, Start, drive};
/// use cvtcycle_output::summary::{Driven, Settings, StartWord, summarise};
/// let setup = load("rover_216_cvt", &Options::default())?;
/// let cycle = cycle::find("ece15_eudc")?;
/// let conditions = Conditions {
///     ambient_k: 263.15,
///     start: Start::Soak,
///     max_dt_s: 1.0,
///     keep_rows: false,
/// };
/// let outcome = drive(&setup, &cycle, &conditions);
/// let driven = [Driven { name: "rover", setup: &setup, outcome: &outcome }];
/// let start = StartWord::Word("soak".to_owned());
/// let summary = summarise(&cycle, -10.0, start, Settings::default(), &driven);
/// let fuel = summary.runs[0].fuel_l_per_100km.unwrap_or(f64::NAN);
/// assert!((5.0..12.0).contains(&fuel), "{fuel} L/100 km");
/// # Ok::<(), Problems>(())
/// ```
pub fn summarise(
    cycle: &Cycle,
    ambient_degc: f64,
    start: StartWord,
    settings: Settings,
    driven: &[Driven],
) -> Summary {
    let roles = ["subject"].into_iter().chain(std::iter::repeat("baseline"));
    let runs = driven.iter().zip(roles);
    let mut runs: Vec<RunSummary> = runs
        .map(|(car, role)| RunSummary {
            notes: notes(car.setup, driven[0].setup, ambient_degc),
            ..run_summary(cycle, role, &settings, car)
        })
        .collect();
    // Equal short names would be ambiguous in a table.
    let shorts: Vec<String> = runs.iter().map(|run| run.short.clone()).collect();
    for run in &mut runs {
        if shorts.iter().filter(|short| **short == run.short).count() > 1 {
            run.short.clone_from(&run.vehicle);
        }
    }
    let baselines = runs.iter().zip(driven).skip(1);
    let comparison = baselines
        .map(|(baseline, driven_baseline)| {
            let subject = driven[0].setup;
            let differences = differences(subject, driven_baseline.setup);
            Comparison {
                likeness: likeness(subject, driven_baseline.setup, &differences),
                differences,
                ..compare(&runs[0], baseline)
            }
        })
        .collect();
    Summary {
        manifest: Manifest::new(SCHEMA),
        cycle: cycle.name.clone(),
        read_as: cycle.read_as.clone(),
        recording: RecordingSummary::of(cycle),
        ambient_degc,
        start,
        settings,
        runs,
        comparison,
        contradicted: Vec::new(),
    }
}

impl Summary {
    /// Takes the ranges of one sample, of the first comparisons in their order, and with them that of the subject's fuel.
    pub fn take_drawn(&mut self, drawn: Vec<DrawnDifference>) {
        if let (Some(run), Some(first)) = (self.runs.first_mut(), drawn.first()) {
            run.drawn = first.fuel_l_per_100km;
        }
        for (comparison, drawn) in self.comparison.iter_mut().zip(drawn) {
            comparison.interval = Some(drawn);
        }
    }

    /// Copy with the cars under their names in tables and figures.
    #[must_use]
    pub fn labelled(&self) -> Self {
        let mut labelled = self.clone();
        let names: Vec<_> = self
            .runs
            .iter()
            .map(|run| (&run.vehicle, run.label()))
            .collect();
        let label = |name: &mut String| {
            if let Some((_, label)) = names.iter().find(|(vehicle, _)| *vehicle == name) {
                *name = (*label).to_owned();
            }
        };
        labelled
            .runs
            .iter_mut()
            .for_each(|run| label(&mut run.vehicle));
        labelled
            .comparison
            .iter_mut()
            .for_each(|comparison| label(&mut comparison.baseline));
        let contradicted = labelled.contradicted.iter_mut();
        contradicted
            .filter_map(|row| row.baseline.as_mut())
            .for_each(label);
        labelled
    }
}

/// Notes for readers of a car's numbers, its doubts first. Doubts of the subject are not repeated.
fn notes(setup: &Setup, subject: &Setup, ambient_degc: f64) -> Vec<String> {
    let mut doubts = setup.doubts();
    if !std::ptr::eq(setup, subject) {
        let known = subject.doubts();
        doubts.retain(|doubt| !known.contains(doubt));
    }
    let mut notes = setup.notes.clone();
    let least_degc = setup
        .engine()
        .start_stop
        .map(|on| on.ambient_k - ZERO_DEGC_K);
    notes.extend(least_degc.filter(|least| ambient_degc < *least).map(|least| {
        format!(
            "start-stop does not stop the engine below {least:.0} degC of ambient (engine.start_stop.ambient_min_degc)"
        )
    }));
    notes.extend(doubts.first().map(|first| match doubts.len() - 1 {
        0 => format!("doubt: {first}"),
        n => format!("doubt: {first} ({n} more: `cvtcycle check` prints them)"),
    }));
    notes
}

/// Names the run in a summary and its record, by a hash of both without the command line.
pub fn name_run(summary: &mut Summary, record: &mut Record) {
    let bare = Record {
        command: String::new(),
        ..record.clone()
    };
    let word = run_word(&(&*summary, bare));
    summary.manifest.run.clone_from(&word);
    record.manifest.run = word;
}

/// The subject against one baseline.
pub fn compare(subject: &RunSummary, baseline: &RunSummary) -> Comparison {
    let percent =
        |s: Option<f64>, b: Option<f64>| s.zip(b).and_then(|(s, b)| finite((s / b - 1.0) * 100.0));
    let phases = subject.phases.iter().zip(&baseline.phases);
    let over = subject.over();
    let fuel = |phase: &PhaseSummary| match over {
        Over::Distance => phase.fuel_l_per_100km,
        Over::Time => phase.fuel_l_per_h,
    };
    let phases = phases.map(|(s, b)| (&*s.name, percent(fuel(s), fuel(b))));
    Comparison {
        baseline: baseline.vehicle.clone(),
        fuel_percent: percent(subject.consumption(over), baseline.consumption(over)),
        phases_percent: phases.collect(),
        likeness: String::new(),
        differences: Vec::new(),
        interval: None,
        fleet: None,
        phases_fleet: IndexMap::new(),
    }
}

/// Numbers by name, in insertion order; `None` for a number that was not computed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Named(IndexMap<String, Option<f64>>);

impl Named {
    /// Number of that name, if present and computed.
    pub fn get(&self, name: &str) -> Option<f64> {
        *self.0.get(name)?
    }

    /// Names and numbers in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Option<f64>)> {
        self.0.iter().map(|(name, value)| (name.as_str(), *value))
    }
}

impl<'a> FromIterator<(&'a str, Option<f64>)> for Named {
    fn from_iter<I: IntoIterator<Item = (&'a str, Option<f64>)>>(list: I) -> Self {
        let owned = list
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value));
        Named(owned.collect())
    }
}
