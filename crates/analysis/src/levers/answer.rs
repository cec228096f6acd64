//! From the table of a lever study to what each lever saves, how sure that is, and what it does besides.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PV-1 | d_k = B_lever(x_k)/B_reference(x_k) - 1: of one draw x_k, the same value of every factor in both cars | derived |
//! | PV-2 | the two quantiles of d between which that share of the draws is, 90 % by default (DS-3), each with its own interval (IV-3) | source: Hyndman and Fan 1996 |
//! | PV-3 | a lever saves in k of n draws; the share of all cases from it by IV-2 | source: Clopper and Pearson 1934 |
//! | PV-4 | interaction of a combination: its median d less the sum of those of its levers | derived |
//! | PV-5 | median of d over the draws of each form (DE-10); the forms differ in sign, or by more than a third of the range of PV-2 | derived; ASSUMED: a third |
//!
//! Draws of which one of the two runs failed are left out of d and counted.

use std::sync::Arc;

use serde::Serialize;

use super::request::{ColumnNote, LeverNotes};
use crate::draws::failed_checks;
use crate::words::decimals;
use cvtcycle_config::setup::Kind;
use cvtcycle_config::{Problem, ProblemKind};
use cvtcycle_output::fleet_spread::{FleetRange, fuel_range};
use cvtcycle_study::StudyManifest;
use cvtcycle_study::answer::{Ended, Information, Status, StudyTable, counted, ended};
use cvtcycle_study::execute::manifest::SCHEMA;
use cvtcycle_study::execute::outputs::FUEL;
use cvtcycle_study::execute::side_effects::{FLOOR, LOCKED, LUGGING, RESERVE};
use cvtcycle_study::statistics::{
    Confidence, Enough, Quantile, Share, Summary, quantile_of_sorted,
};

/// Change of fuel, %, up to which a lever saves nothing: half of the last digit that is printed.
const NOTHING_PERCENT: f64 = 0.005;

/// Share of the draws above which failed ones make that a lever does not work in a car, or a car not in its draws.
const MAX_FAILED: f64 = 0.5;

/// Column of the carbon dioxide.
const CO2: &str = "co2_g_per_km";

/// Columns of side effects, with whether the largest value is the worst.
const EFFECTS: [(&str, &str, bool); 8] = [
    ("min_clamp_safety", "-", false),
    (FLOOR, "s", true),
    ("flow_limited_s", "s", true),
    (LUGGING, "s", true),
    (LOCKED, "rpm", false),
    (RESERVE, "%", false),
    ("launch_not_in_low_s", "s", true),
    ("end_transmission_sump_degc", "degC", true),
];

/// Results of a lever study.
#[derive(Clone, Debug, Serialize)]
pub struct LeverAnswer {
    /// Version of this object.
    pub schema: u32,
    /// Name of the study.
    pub title: String,
    /// Plan whose factors are drawn; none without draws.
    pub plan: Option<String>,
    /// Draws.
    pub draws: u64,
    /// Draws whose runs are there.
    pub draws_done: u64,
    /// How sure the intervals are.
    pub confidence: Confidence,
    /// Statements that the number of draws allows.
    pub enough: Enough,
    /// Engine speed below which a loaded engine behind a closed clutch is heard and felt, rpm.
    pub heard_rpm: f64,
    /// How the runs ended.
    pub runs: Ended,
    /// By car and ambient temperature.
    pub blocks: Vec<LeverBlock>,
    /// Notes for the reader, a sentence each.
    pub notes: Vec<String>,
}

/// One car at one ambient temperature.
#[derive(Clone, Debug, Serialize)]
pub struct LeverBlock {
    /// Name of the car.
    pub vehicle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// Fuel of the car as it is, median, L/100 km.
    pub fuel_l_per_100km: f64,
    /// Fuel of 90 % of such cars, by measured ones; none of a shipped car.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetRange>,
    /// Draws in which the car as it is fails a check or cannot be driven.
    pub failed: usize,
    /// Number of draws in total.
    pub n: usize,
    /// Checks that it fails there with their counts, the commonest first.
    pub reasons: Vec<(String, usize)>,
    /// Levers, then combinations, each from the largest saving on.
    pub rows: Vec<LeverRow>,
    /// The foremost single levers against each other, the better one first.
    pub between: Vec<Between>,
}

impl LeverBlock {
    /// Decimals of the changes of the fuel in a table of this block, one for all rows: those that half of its ranges warrant, at least one.
    #[must_use]
    pub fn decimals(&self) -> usize {
        let ranges = self.rows.iter().filter(|row| row.n > 0);
        let of = |row: &LeverRow| decimals([row.low_percent.value, row.high_percent.value]);
        let mut all: Vec<usize> = ranges.map(of).collect();
        all.sort_unstable();
        all.get(all.len() / 2)
            .map_or(1, |digits| (*digits).clamp(1, 2))
    }
}

/// Two levers against each other, draw by draw.
#[derive(Clone, Debug, Serialize)]
pub struct Between {
    /// Names for people of the first and the second lever.
    pub titles: [String; 2],
    /// Quantiles 0.05, 0.5 and 0.95 of the fuel of the first less that of the second, per cent of the second.
    pub percent: [f64; 3],
    /// In how many draws the first uses less.
    pub better: Share,
}

/// One lever of a car.
#[derive(Clone, Debug, Serialize)]
pub struct LeverRow {
    /// Description of the column.
    #[serde(flatten)]
    pub of: ColumnNote,
    /// Draws with both runs.
    pub n: usize,
    /// Draws in which its own run fails a check or cannot be driven and that of the reference can.
    pub failed: usize,
    /// Checks that its own run fails there with their counts, the commonest first.
    pub reasons: Vec<(String, usize)>,
    /// Median change of the fuel, %.
    pub fuel_percent: Quantile,
    /// The lower end of the draws.
    pub low_percent: Quantile,
    /// The upper end of the draws.
    pub high_percent: Quantile,
    /// In how many draws it saves fuel.
    pub saves: Share,
    /// Median change of the fuel, L/100 km.
    pub fuel_l_per_100km: f64,
    /// Median change of carbon dioxide, g/km.
    pub co2_g_per_km: f64,
    /// Sum of the medians of the levers of a combination, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sum_percent: Option<f64>,
    /// Median by form of the law, where the plan has several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub by_form: Vec<OfForm>,
    /// The uncertain value that sets the size of the change; none where no value is seen to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub set_by: Option<SetBy>,
    /// Effects other than fuel.
    pub effects: Vec<SideEffect>,
}

/// A change over the draws of one form of a law (PV-5).
#[derive(Clone, Debug, Serialize)]
pub struct OfForm {
    /// Name of the form.
    pub form: String,
    /// Name for people.
    pub title: String,
    /// Draws with both runs.
    pub n: usize,
    /// Median change of the fuel, %.
    pub median_percent: f64,
}

/// A number that a lever moves besides the fuel.
#[derive(Clone, Debug, Serialize)]
pub struct SideEffect {
    /// Column of the table of runs.
    pub name: &'static str,
    /// Unit of the effect.
    pub unit: &'static str,
    /// Median of the draws.
    pub median: f64,
    /// Worst of all draws.
    pub worst: f64,
    /// Worst of the reference.
    pub reference_worst: f64,
    /// Median of the change.
    pub change: f64,
    /// Quantiles 0.05 and 0.95 of the change, draw by draw.
    pub change_ends: [f64; 2],
}

/// The uncertain value that sets the size of a change: the one with the largest share of the variance, above what chance gives.
#[derive(Clone, Debug, Serialize)]
pub struct SetBy {
    /// Name of the factor.
    pub factor: String,
    /// Key of the factor.
    pub key: String,
    /// Share of the variance of the change (IN-2).
    pub share: f64,
}

impl LeverAnswer {
    /// True if an unchanged car fails in most of its draws; without draws, if any run fails.
    pub fn is_failed(&self) -> bool {
        match self.plan {
            Some(_) => self
                .blocks
                .iter()
                .any(|block| is_most(block.failed, block.n)),
            None => self.runs.failed + self.runs.not_run > 0,
        }
    }
}

/// True if too many draws failed for the others to represent all.
fn is_most(failed: usize, n: usize) -> bool {
    failed as f64 > MAX_FAILED * n as f64
}

impl LeverRow {
    /// True if it fails in most of the draws in which its reference does not.
    pub fn does_not_work(&self) -> bool {
        is_most(self.failed, self.failed + self.n)
    }

    /// True if the forms do not agree (PV-5): on the sign, or by more than a third of the range.
    pub fn depends_on_form(&self) -> bool {
        let medians = || self.by_form.iter().map(|of| of.median_percent);
        let (low, high) = (
            medians().fold(f64::NAN, f64::min),
            medians().fold(f64::NAN, f64::max),
        );
        let range = self.high_percent.value - self.low_percent.value;
        self.is_open_by_form() || high - low > range / 3.0 // PV-5
    }

    /// True if it saves in one form and does not in another.
    pub fn is_open_by_form(&self) -> bool {
        let saves = |of: &OfForm| of.median_percent < -NOTHING_PERCENT;
        self.by_form.iter().any(saves) && !self.by_form.iter().all(saves)
    }

    /// A side effect by its name.
    pub fn effect(&self, name: &str) -> Option<&SideEffect> {
        self.effects.iter().find(|effect| effect.name == name)
    }

    /// The worst value of a side effect; NaN where there is none.
    pub fn worst(&self, name: &str) -> f64 {
        self.effect(name).map_or(f64::NAN, |effect| effect.worst)
    }

    /// True for a combination.
    pub fn is_combination(&self) -> bool {
        self.of.kind == "combination"
    }
}

/// The numbers of a study, by column and point.
struct Numbers {
    fuel: Vec<Vec<f64>>,
    co2: Vec<Vec<f64>>,
    effects: Vec<Vec<Vec<f64>>>,
    ok: Vec<Vec<bool>>,
    /// Reasons of failed runs; none of a column without one.
    reasons: Vec<Vec<Arc<str>>>,
}

impl Numbers {
    /// The checks that a column fails at some points.
    fn reasons(&self, column: usize, at: &[bool]) -> Vec<(String, usize)> {
        let of_points = self.reasons[column].iter().zip(at);
        let texts = of_points.filter(|(_, at)| **at);
        counted(texts.flat_map(|(text, _)| failed_checks(text)))
    }
}

/// Computes what a lever study says from the parts that are there.
///
/// # Errors
/// A part that cannot be read, or a study that is none of levers.
pub fn lever_answer(frame: &StudyTable, confidence: Confidence) -> Result<LeverAnswer, Problem> {
    let outline = frame.outline;
    let about = outline.levers.clone().unwrap_or_default();
    let about: LeverNotes = serde_json::from_value(about).map_err(|error| {
        let message = format!("the study is none of levers: {error}");
        Problem::new(ProblemKind::Damaged, message)
    })?;
    if about.columns.len() != outline.cars.len() {
        let message = "the study has other columns than its levers";
        return Err(Problem::new(ProblemKind::Damaged, message));
    }
    let names = EFFECTS.map(|(name, ..)| name);
    let wanted: Vec<&str> = [FUEL, CO2].into_iter().chain(names).collect();
    // A column that a cycle or its cars do not have has no numbers.
    let known = |name: &&str| outline.columns.iter().any(|(column, _)| column == name);
    let there: Vec<&str> = wanted.iter().copied().filter(known).collect();
    let found = frame.by_car(&there)?;
    let of = |name: &str| match there.iter().position(|other| *other == name) {
        Some(k) => found[k].clone(),
        None => vec![Vec::new(); outline.cars.len()],
    };
    let is_ok = |car: usize| -> Result<Vec<bool>, Problem> {
        let status = frame.status(car)?.into_iter();
        Ok(status.map(|status| status == Status::Ok).collect())
    };
    let bad = |car: usize| {
        let counts = [Status::Failed, Status::NotRun].map(|status| frame.count_of(car, status));
        counts.iter().sum::<usize>()
    };
    let reasons = (0..outline.cars.len()).map(|car| match bad(car) > 0 {
        true => frame.words("reason", car),
        false => Ok(Vec::new()),
    });
    let numbers = Numbers {
        reasons: reasons.collect::<Result<_, _>>()?,
        fuel: of(FUEL),
        co2: of(CO2),
        effects: names.iter().map(|name| of(name)).collect(),
        ok: (0..outline.cars.len())
            .map(is_ok)
            .collect::<Result<_, _>>()?,
    };
    let points = usize::try_from(outline.points).unwrap_or(usize::MAX);
    let done = points - frame.count_of(0, Status::Missing);
    Ok(LeverAnswer {
        schema: SCHEMA,
        title: outline.title.clone(),
        draws: outline.points,
        draws_done: done as u64,
        confidence,
        enough: Enough::from_draws(if about.plan.is_some() { done } else { 0 }, confidence),
        plan: about.plan,
        heard_rpm: about.heard_rpm,
        runs: ended(frame)?,
        blocks: blocks(&about.columns, &numbers, confidence, outline),
        notes: about.notes,
    })
}

/// The columns by car and ambient temperature, in their order.
fn blocks(
    columns: &[ColumnNote],
    numbers: &Numbers,
    confidence: Confidence,
    outline: &StudyManifest,
) -> Vec<LeverBlock> {
    let mut blocks: Vec<LeverBlock> = Vec::new();
    for (k, column) in columns.iter().enumerate() {
        if column.kind == "reference" {
            if column.name == "reference" {
                let failed = numbers.ok[k].iter().map(|ok| !ok);
                let failed: Vec<bool> = failed.collect();
                let fuel = median(numbers.fuel[k].iter().copied());
                let is_shipped = Kind::Vehicle.names().contains(&column.vehicle.as_str());
                let kind = outline.kinds.get(k).filter(|_| !is_shipped);
                let cycle = outline.plan.base.cycle.as_str();
                blocks.push(LeverBlock {
                    fleet: kind.and_then(|kind| fuel_range(kind, cycle, column.ambient_degc, fuel)),
                    vehicle: column.vehicle.clone(),
                    ambient_degc: column.ambient_degc,
                    fuel_l_per_100km: fuel,
                    failed: failed.iter().filter(|failed| **failed).count(),
                    n: failed.len(),
                    reasons: numbers.reasons(k, &failed),
                    rows: Vec::new(),
                    between: Vec::new(),
                });
            }
            continue;
        }
        let is_lever = ["lever", "combination"].contains(&column.kind.as_str());
        if let Some(block) = blocks.last_mut().filter(|_| is_lever) {
            block
                .rows
                .push(row(k, column, numbers, (confidence, outline)));
        }
    }
    for block in &mut blocks {
        let single = block.rows.clone();
        for row in block.rows.iter_mut().filter(|row| row.is_combination()) {
            let of = |name: &String| single.iter().find(|other| other.of.name == *name);
            let medians = row
                .of
                .members
                .iter()
                .map(|name| Some(of(name)?.fuel_percent.value));
            row.sum_percent = medians.sum(); // PV-4
        }
        let key = |row: &LeverRow| (row.is_combination(), row.fuel_percent.value);
        block.rows.sort_by(|a, b| {
            let ((a_last, a), (b_last, b)) = (key(a), key(b));
            a_last.cmp(&b_last).then(a.total_cmp(&b))
        });
        block.between = between(columns, block, numbers, confidence);
    }
    blocks
}

/// Number of levers that are compared with each other.
const FOREMOST: usize = 3;

/// The foremost single levers of a car against each other.
fn between(
    columns: &[ColumnNote],
    block: &LeverBlock,
    numbers: &Numbers,
    confidence: Confidence,
) -> Vec<Between> {
    let column = |row: &LeverRow| {
        let own = |note: &ColumnNote| {
            note.kind == row.of.kind
                && note.name == row.of.name
                && note.vehicle == block.vehicle
                && note.ambient_degc.total_cmp(&block.ambient_degc).is_eq()
        };
        columns.iter().position(own)
    };
    let single = block.rows.iter().filter(|row| !row.is_combination());
    let works = single.filter(|row| !row.does_not_work() && row.fuel_percent.value < 0.0);
    let foremost: Vec<(&LeverRow, usize)> = works
        .take(FOREMOST)
        .filter_map(|row| Some((row, column(row)?)))
        .collect();
    let mut list = Vec::new();
    for (k, (first, own)) in foremost.iter().enumerate() {
        for (second, other) in &foremost[k + 1..] {
            let pairs = numbers.fuel[*own].iter().zip(&numbers.fuel[*other]);
            let percent: Vec<f64> = pairs.map(|(a, b)| 100.0 * (a / b - 1.0)).collect();
            let quantiles = sorted(percent.iter().copied());
            list.push(Between {
                titles: [first.of.title.clone(), second.of.title.clone()],
                percent: [0.05, 0.5, 0.95].map(|p| quantile_of_sorted(&quantiles, p)),
                better: Share::new(&percent, Some(confidence), |x| x < 0.0),
            });
        }
    }
    list
}

/// The value that sets the size of a change.
fn set_by(outline: &StudyManifest, percent: &[f64], confidence: Confidence) -> Option<SetBy> {
    let of = Information::of_sample(&outline.plan, percent, confidence)?;
    let first = of.causes().next()?;
    let factor = outline
        .plan
        .factors
        .iter()
        .find(|factor| factor.name == first.name)?;
    Some(SetBy {
        factor: first.name.clone(),
        key: factor.key.clone(),
        share: first.share.value,
    })
}

/// Medians by form; none of a plan with one form, or of draws that have none of its values.
fn by_form(outline: &StudyManifest, percent: &[f64]) -> Vec<OfForm> {
    let plan = &outline.plan;
    let mut by_form = vec![Vec::new(); plan.forms_drawn().len()];
    for (point, x) in (0..).zip(percent) {
        let form = plan.form_of(point).filter(|_| x.is_finite());
        if let Some(of_form) = form.and_then(|form| by_form.get_mut(form)) {
            of_form.push(*x);
        }
    }
    let named = plan.forms_drawn().iter().zip(by_form);
    let of = named.filter(|(_, list)| !list.is_empty());
    of.map(|(form, list)| OfForm {
        form: form.name.clone(),
        title: form.title.clone(),
        n: list.len(),
        median_percent: median(list.into_iter()),
    })
    .collect()
}

fn row(
    column: usize,
    note: &ColumnNote,
    numbers: &Numbers,
    (confidence, outline): (Confidence, &StudyManifest),
) -> LeverRow {
    let reference = note.reference;
    let pairs = |of: &[Vec<f64>]| -> Vec<(f64, f64)> {
        of[column]
            .iter()
            .copied()
            .zip(of[reference].iter().copied())
            .collect()
    };
    let fuel = pairs(&numbers.fuel);
    let percent: Vec<f64> = fuel.iter().map(|(x, of)| 100.0 * (x / of - 1.0)).collect(); // PV-1
    let summary = Summary::new(&percent, confidence);
    let quantile = |p: f64| {
        let found = summary.quantiles.iter().find(|q| (q.p - p).abs() < 1e-9);
        found.copied().unwrap_or(Quantile {
            p,
            value: f64::NAN,
            interval: [None; 2],
        })
    };
    let [low, high] = confidence.ends();
    let changes = |of: &[Vec<f64>]| sorted(pairs(of).into_iter().map(|(x, of)| x - of));
    let differences = |of: &[Vec<f64>]| quantile_of_sorted(&changes(of), 0.5);
    let both = numbers.ok[column].iter().zip(&numbers.ok[reference]);
    let failed: Vec<bool> = both.map(|(own, reference)| !own && *reference).collect();
    let effects = EFFECTS.iter().zip(&numbers.effects);
    LeverRow {
        of: note.clone(),
        n: summary.n,
        failed: failed.iter().filter(|failed| **failed).count(),
        reasons: numbers.reasons(column, &failed),
        fuel_percent: quantile(0.5),
        low_percent: quantile(low),   // PV-2
        high_percent: quantile(high), // PV-2
        saves: Share::new(&percent, Some(confidence), |x| x < -NOTHING_PERCENT), // PV-3
        fuel_l_per_100km: differences(&numbers.fuel),
        co2_g_per_km: differences(&numbers.co2),
        sum_percent: None,
        by_form: by_form(outline, &percent),
        set_by: set_by(outline, &percent, confidence),
        effects: effects
            .map(|((name, unit, largest), of)| {
                let changes = changes(of);
                SideEffect {
                    name,
                    unit,
                    median: median(of[column].iter().copied()),
                    worst: worst(&of[column], *largest),
                    reference_worst: worst(&of[reference], *largest),
                    change: quantile_of_sorted(&changes, 0.5),
                    change_ends: [0.05, 0.95].map(|p| quantile_of_sorted(&changes, p)),
                }
            })
            .collect(),
    }
}

/// The largest or the least of the values; NaN without one.
fn worst(values: &[f64], largest: bool) -> f64 {
    let all = values.iter().copied();
    match largest {
        true => all.fold(f64::NAN, f64::max),
        false => all.fold(f64::NAN, f64::min),
    }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.filter(|x| x.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    quantile_of_sorted(&sorted(values), 0.5)
}
