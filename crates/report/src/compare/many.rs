//! Comparison of any number of runs: the subject of each against that of a reference.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Serialize;

use crate::problems::problem;
use crate::results::{ResultDir, RunResults, find};
use crate::whatif::base_of_run;
use cvtcycle_analysis::draws;
use cvtcycle_config::setup::Kind;
use cvtcycle_config::{Problem, Problems, Setting};
use cvtcycle_output::fleet_spread::{Compared, DrivenOn, FleetRange, Other, difference_range};
use cvtcycle_output::number::{finite, plain};
use cvtcycle_output::record::Manifest;
use cvtcycle_output::summary::{DrawnDifference, Over, RunSummary, StartWord, Summary};
use cvtcycle_output::{Component, summary::SCHEMA};
use cvtcycle_study::plan::Base;

/// Losses are omitted if their difference is below this share of the largest one.
const MIN_SHARE: f64 = 0.01;
/// Maximum number of named differences between runs.
const FEW: usize = 8;

/// Runs next to each other.
#[derive(Clone, Debug, Serialize)]
pub struct RunComparison {
    /// Version of the object, and program.
    #[serde(flatten)]
    pub manifest: Manifest,
    /// Name of the run that the others are compared with.
    pub reference: String,
    /// The runs, the reference first.
    pub runs: Vec<Side>,
    /// Conditions that differ between the runs.
    pub conditions: Vec<DifferingValue>,
    /// Values that differ between the cars; `None` where a run has no record of them.
    pub values: Option<Vec<DifferingValue>>,
    /// Losses with a relevant difference, in the order of the power flow.
    pub components: Vec<String>,
}

/// The subject of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Side {
    /// Name of the directory, unique.
    pub name: String,
    /// Name of its vehicle.
    pub vehicle: String,
    /// Headline fuel.
    pub fuel_l_per_100km: Option<f64>,
    /// Difference to the reference.
    pub difference_l_per_100km: Option<f64>,
    /// Fuel over time.
    pub fuel_l_per_h: Option<f64>,
    /// Difference of the fuel over time to the reference.
    pub difference_l_per_h: Option<f64>,
    /// Difference of the headline fuel, of the fuel over time where the reference has no distance to speak of, per cent.
    pub difference_percent: Option<f64>,
    /// Difference of 90 % of such cars, per cent, by measured ones, of another car than the reference; `None` of two shipped cars.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetRange>,
    /// Carbon dioxide of the headline fuel.
    pub co2_g_per_km: Option<f64>,
    /// Loss of each component per kilometre; empty without distance.
    pub loss_kj_per_km: BTreeMap<String, Option<f64>>,
    /// Total loss of the transmission per kilometre.
    pub transmission_loss_kj_per_km: Option<f64>,
    /// Loss of each component per hour.
    pub loss_kj_per_h: BTreeMap<String, Option<f64>>,
    /// Total loss of the transmission per hour.
    pub transmission_loss_kj_per_h: Option<f64>,
    /// Smallest clamp safety factor.
    pub min_clamp_safety: Option<f64>,
    /// Time in which the car could not follow the trace.
    pub trace_missed_s: f64,
    /// Difference of the fuel over the same draws of what is uncertain, of a car whose values differ from those of the reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawn: Option<DrawnDifference>,
    /// Names of the failed checks.
    pub failed_checks: Vec<String>,
    /// Failed checks and gross slip with their times: the numbers are none of a car that drives the cycle.
    pub faults: Vec<String>,
}

impl Side {
    /// Denominator of the fuel: distance, or time for a car that hardly moves.
    pub fn over(&self) -> Over {
        match self.fuel_l_per_100km {
            Some(_) => Over::Distance,
            None => Over::Time,
        }
    }

    /// Loss of each component per kilometre or hour.
    pub fn losses_kj(&self, over: Over) -> &BTreeMap<String, Option<f64>> {
        match over {
            Over::Distance => &self.loss_kj_per_km,
            Over::Time => &self.loss_kj_per_h,
        }
    }
}

/// A value or condition that differs between runs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct DifferingValue {
    /// Dotted key, or a condition of the run.
    pub key: String,
    /// Unit, `-` for none.
    pub unit: String,
    /// Value in each run, empty if absent.
    pub values: Vec<String>,
}

impl DifferingValue {
    fn unless_equal(key: &str, unit: &str, values: Vec<String>) -> Option<Self> {
        let same = values.windows(2).all(|pair| pair[0] == pair[1]);
        (!same).then(|| DifferingValue {
            key: key.to_owned(),
            unit: unit.to_owned(),
            values,
        })
    }
}

impl RunComparison {
    /// Cause of the differences, if it fits in a sentence.
    pub fn cause(&self) -> Option<String> {
        let found = self.values.as_deref()?;
        let said = |different: &DifferingValue| {
            let unit = match different.unit.as_str() {
                "-" | "" => String::new(),
                unit => format!(" {unit}"),
            };
            format!("{}: {}{unit}", different.key, different.values.join(", "))
        };
        Some(match found {
            [] => "no value of the cars differs".to_owned(),
            [one] => format!("they differ in one value alone, {}", said(one)),
            some if some.len() <= FEW => {
                let list: Vec<String> = some.iter().map(said).collect();
                format!("they differ in {}", list.join("; "))
            }
            many => format!("they differ in {} values", many.len()),
        })
    }
}

/// Compares the runs of some directories with that at the place `reference`. Runs under different conditions are refused unless `loosely`.
///
/// # Errors
/// Directories without a run; runs under different conditions.
pub fn compare(
    dirs: &[PathBuf],
    reference: usize,
    loosely: bool,
) -> Result<RunComparison, Problems> {
    let (mut problems, mut found) = (Problems::new(), Vec::new());
    for dir in dirs {
        match find(dir, &[]) {
            Ok(ResultDir::Run(run)) => found.push(*run),
            Ok(ResultDir::Study(_)) => {
                let message = format!("{} holds a study, not a run", dir.display());
                let hint = "a study compares its cars itself: `cvtcycle study show DIR`";
                problems.push(problem(dir, &message, hint));
            }
            Err(more) => problems.extend(more),
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut named: Vec<(String, RunResults)> = names(dirs).into_iter().zip(found).collect();
    named[..=reference].rotate_right(1);
    let conditions = conditions(&named);
    if let Some(first) = conditions.first().filter(|_| !loosely) {
        return Err(apart(first, &named).into());
    }
    let mut compared = compare_runs(&named, conditions);
    if compared.conditions.is_empty() {
        draw(&named, &mut compared);
    }
    Ok(compared)
}

/// Draws of a comparison: as many as give the ends of a difference a range of their own (ES-3).
const DRAWS: u64 = 72;

/// Adds the draws of what is uncertain, the same for all runs; none where a car or the cycle has changed since its run.
fn draw(named: &[(String, RunResults)], compared: &mut RunComparison) {
    let base = |(_, run): &(String, RunResults)| {
        base_of_run(&run.path, &run.summary, run.record.as_ref()?).ok()
    };
    let bases: Option<Vec<Base>> = named.iter().map(base).collect();
    let Some([first, others @ ..]) = bases.as_deref() else {
        return;
    };
    let Ok(drawn) = draws::compare(first, others, DRAWS) else {
        return;
    };
    for (side, drawn) in compared.runs.iter_mut().skip(1).zip(drawn) {
        side.drawn = Some(drawn);
    }
}

/// Names of the directories, numbered where they are equal.
pub fn names(dirs: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for dir in dirs {
        let name = match dir.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => dir.display().to_string(),
        };
        let numbered = (2..).map(|n| format!("{name}_{n}"));
        let mut tried = std::iter::once(name.clone()).chain(numbered);
        names.extend(tried.find(|name| !names.contains(name)));
    }
    names
}

/// Conditions that differ between the runs.
fn conditions(named: &[(String, RunResults)]) -> Vec<DifferingValue> {
    let each = |key: &str, unit: &str, value_of: &dyn Fn(&RunResults) -> String| {
        let values = named.iter().map(|(_, run)| value_of(run));
        DifferingValue::unless_equal(key, unit, values.collect())
    };
    let start = |run: &RunResults| match &run.summary.start {
        StartWord::Word(word) => word.clone(),
        StartWord::Degc(degc) => format!("{} degC", plain(*degc)),
        StartWord::Nodes(_) => run.summary.start.text(),
    };
    // A cycle's file may have changed under the same name.
    let trace = |run: &RunResults| {
        let record = run.record.as_ref();
        record.map_or_else(String::new, |record| record.cycle.sha256.clone())
    };
    let cycle = each("cycle", "-", &|run| run.summary.cycle.clone());
    let recorded = named.iter().all(|(_, run)| run.record.is_some());
    let traces = each("SHA-256 of the cycle", "-", &trace).filter(|_| recorded && cycle.is_none());
    let ambient = each("ambient temperature", "degC", &|run| {
        plain(run.summary.ambient_degc)
    });
    let step = each("time step", "s", &|run| plain(run.summary.settings.dt_s));
    let belt = each("belt model", "-", &|run| {
        run.summary.settings.formulation.clone()
    });
    let all = [
        cycle,
        traces,
        ambient,
        each("start", "-", &start),
        step,
        belt,
    ];
    all.into_iter().flatten().collect()
}

/// Problem of runs under different conditions.
fn apart(different: &DifferingValue, named: &[(String, RunResults)]) -> Problem {
    let other = different
        .values
        .iter()
        .position(|value| *value != different.values[0]);
    let other = other.unwrap_or(0);
    let (key, [a, b]) = (&different.key, [0, other].map(|k| &named[k].0));
    let [here, there] = [0, other].map(|k| &different.values[k]);
    let message = format!("{key} of {a} is {here}, of {b} {there}");
    let hint = "drive both alike, or compare them all the same";
    problem(&named[other].1.path, &message, hint).settings(&[Setting::Loosely])
}

fn compare_runs(named: &[(String, RunResults)], conditions: Vec<DifferingValue>) -> RunComparison {
    let base = &named[0].1.summary.runs[0];
    let runs: Vec<Side> = named
        .iter()
        .map(|(name, run)| side(name, &run.summary, base))
        .collect();
    let over = base.over();
    let spread = |component: &Component| {
        let losses = runs.iter().map(|run| loss(run, component.name(), over));
        let ends = losses.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        ends.1 - ends.0
    };
    let largest = Component::ALL.iter().map(spread).fold(0.0, f64::max);
    let counts = |c: &Component| largest > 0.0 && spread(c) >= MIN_SHARE * largest;
    let components = Component::ALL.into_iter().filter(counts);
    RunComparison {
        manifest: Manifest::new(SCHEMA),
        reference: runs[0].name.clone(),
        components: components.map(|c| c.name().to_owned()).collect(),
        conditions,
        values: values(named),
        runs,
    }
}

/// Loss per kilometre or hour; zero for a car without this component.
fn loss(run: &Side, component: &str, over: Over) -> f64 {
    run.losses_kj(over)
        .get(component)
        .copied()
        .flatten()
        .unwrap_or(0.0)
}

/// Difference of another car than the reference, by measured cars.
fn by_cars(summary: &Summary, base: &RunSummary, percent: f64) -> Option<FleetRange> {
    let run = summary.runs.first()?;
    let shipped = Kind::Vehicle.names();
    let is_shipped = |run: &RunSummary| shipped.contains(&run.vehicle.as_str());
    if run.vehicle == base.vehicle || is_shipped(run) && is_shipped(base) {
        return None;
    }
    let of = Compared {
        kinds: [&run.transmission, &base.transmission],
        other: match base.vehicle == format!("{}_twin", run.vehicle) {
            true => Other::Twin,
            false => Other::Any,
        },
    };
    let on = DrivenOn::whole(&summary.cycle, summary.ambient_degc);
    difference_range(of, on, percent)
}

fn side(name: &str, summary: &Summary, base: &RunSummary) -> Side {
    let run = &summary.runs[0];
    let each_km = |kj: f64| finite(kj / run.distance_km).filter(|_| run.over() == Over::Distance);
    let each_hour = |kj: f64| finite(kj * 3600.0 / run.duration_s);
    let own = |each: &dyn Fn(f64) -> Option<f64>| {
        let own = |c: Component| {
            let each = run.loss_kj.get(c.name()).and_then(each)?;
            Some((c.name().to_owned(), Some(each)))
        };
        Component::ALL.into_iter().filter_map(own).collect()
    };
    let difference = |over: Over| Some(run.consumption(over)? - base.consumption(over)?);
    let over = base.over();
    let fuels = run.consumption(over).zip(base.consumption(over));
    let percent = fuels.and_then(|(fuel, base)| finite(100.0 * (fuel / base - 1.0)));
    Side {
        fleet: percent.and_then(|percent| by_cars(summary, base, percent)),
        name: name.to_owned(),
        vehicle: run.vehicle.clone(),
        fuel_l_per_100km: run.headline_fuel(),
        difference_l_per_100km: difference(Over::Distance),
        fuel_l_per_h: run.litres_per_hour(),
        difference_l_per_h: difference(Over::Time),
        difference_percent: percent,
        co2_g_per_km: run.weighted_co2_g_per_km.or(run.co2_g_per_km),
        loss_kj_per_km: own(&each_km),
        transmission_loss_kj_per_km: each_km(run.transmission_loss_kj()),
        loss_kj_per_h: own(&each_hour),
        transmission_loss_kj_per_h: each_hour(run.transmission_loss_kj()),
        min_clamp_safety: run.min_clamp_safety,
        trace_missed_s: run.trace_missed_s,
        drawn: None,
        failed_checks: run.failed_checks.clone(),
        faults: run.faults(),
    }
}

/// Values of the subjects that differ, in the order of their keys; `None` where a run has no record.
fn values(named: &[(String, RunResults)]) -> Option<Vec<DifferingValue>> {
    let mut by_key: BTreeMap<&str, (&str, Vec<String>)> = BTreeMap::new();
    for (place, (_, run)) in named.iter().enumerate() {
        let car = run.record.as_ref()?.cars.first()?;
        for value in &car.values {
            let none = || (value.unit.as_str(), vec![String::new(); named.len()]);
            by_key.entry(&value.key).or_insert_with(none).1[place].clone_from(&value.value);
        }
    }
    let different = by_key.into_iter();
    Some(
        different
            .filter_map(|(key, (unit, values))| DifferingValue::unless_equal(key, unit, values))
            .collect(),
    )
}
