//! Sentences about a run: fuel, difference to each baseline with its uncertainty, the price of its losses, and the published
//! numbers that contradict it.

use std::borrow::Cow;
use std::cell::OnceCell;

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::decimal;
use cvtcycle_config::setup::{Kind, Options, Setup, load};
use cvtcycle_output::fleet_spread::{Compared, DrivenOn, Other, difference_range, fuel_range};
use cvtcycle_output::number::{fixed, signed};
use cvtcycle_output::provenance::car_sha256;
use cvtcycle_output::summary::{
    Comparison, Contradiction, DrawnDifference, Driven, MapLeft, Over, RecordingSummary,
    RunSummary, StartWord, Summary, UNCHANGED,
};

use super::intervals as drawn;
use super::{
    against_print, between, decimals, difference_of_cars, fuel_ranges, more_or_less, of_difference,
    than,
};
use crate::attribute::answer as price;
use cvtcycle_study::statistics::{Confidence, Enough};
use cvtcycle_validate::rule::Printed;
use cvtcycle_validate::{About, ValidationRow, published};

/// Distance of the ambient temperatures up to which a published number is one of this run, K.
const NEAR_K: f64 = 5.0;

/// Looks up how sure the fuel of a run and its differences are, and which published numbers it contradicts. Draws and published numbers are of cars as
/// they are shipped; of all others measured cars tell.
pub fn assess(
    summary: &mut Summary,
    cycle: &Cycle,
    driven: &[Driven],
    known: Option<&[ValidationRow]>,
) {
    assess_draws(summary, cycle, driven, known);
    assess_fleet(summary);
}

/// Ranges from measured cars: of the fuel of each car that is not shipped, and of each difference to another car. They hold the error of the model,
/// which draws of its inputs do not.
pub fn assess_fleet(summary: &mut Summary) {
    let (cycle, degc) = (summary.cycle.clone(), summary.ambient_degc);
    let kinds: Vec<String> = summary
        .runs
        .iter()
        .map(|run| run.transmission.clone())
        .collect();
    let is_named = |run: &RunSummary| Kind::Vehicle.names().contains(&run.vehicle.as_str());
    let is_shipped = summary.runs.iter().all(is_named);
    let roles: Vec<String> = summary.runs.iter().map(|run| run.role.clone()).collect();
    // Measured cars drove their cycle: nothing is known of one that does not.
    let drives: Vec<bool> = summary
        .runs
        .iter()
        .map(|run| run.faults().is_empty())
        .collect();
    let twin = summary
        .runs
        .first()
        .map_or_else(String::new, |run| format!("{}_twin", run.vehicle));
    let baselines = kinds.iter().zip(&roles).zip(&drives).skip(1);
    for (comparison, ((other, role), drives_too)) in summary.comparison.iter_mut().zip(baselines) {
        // Measured cars differ by more than a change of one of them.
        if role == UNCHANGED || !(drives[0] && *drives_too) {
            continue;
        }
        let of = Compared {
            kinds: [&kinds[0], other],
            other: match comparison.differences.is_empty() {
                true if comparison.baseline == twin => Other::Twin,
                true => Other::Alike,
                false => Other::Any,
            },
        };
        comparison.fleet = comparison
            .fuel_percent
            .and_then(|percent| difference_range(of, DrivenOn::whole(&cycle, degc), percent));
        let of_part = |percent: Option<f64>| {
            Some(difference_range(of, DrivenOn::part(&cycle, degc), percent?)?.ends)
        };
        let parts = comparison.phases_percent.iter();
        comparison.phases_fleet = parts
            .filter(|_| !is_shipped)
            .filter_map(|(name, percent)| Some((name.to_owned(), of_part(percent)?)))
            .collect();
    }
    for (run, drives) in summary.runs.iter_mut().zip(drives) {
        let fuel = run.headline_fuel().filter(|_| drives);
        run.fleet = fuel
            .filter(|_| !is_named(run))
            .and_then(|fuel| fuel_range(&run.transmission, &cycle, degc, fuel));
    }
}

/// Draws and published numbers, of cars as they are shipped.
fn assess_draws(
    summary: &mut Summary,
    cycle: &Cycle,
    driven: &[Driven],
    known: Option<&[ValidationRow]>,
) {
    let usual = summary.settings.dt_s >= 1.0 && summary.settings.formulation == "smooth";
    let named = driven.iter().zip(&summary.runs);
    let names = named.filter(|(_, run)| run.role != UNCHANGED);
    let names = names.map(|(car, _)| car.name);
    let StartWord::Word(start) = summary.start.clone() else {
        return;
    };
    if !usual
        || !names
            .clone()
            .all(|name| Kind::Vehicle.names().contains(&name))
    {
        return;
    }
    summary.contradicted = contradicted(summary, &start, driven, known);
    let ambient_degc = summary.ambient_degc;
    let Some((subject, baselines)) = driven.split_first() else {
        return;
    };
    let (cycle_sha256, subject_sha256) = (OnceCell::new(), OnceCell::new());
    for (comparison, baseline) in summary.comparison.iter_mut().zip(baselines) {
        comparison.interval = drawn::known(&drawn::Pair {
            cycle,
            ambient_degc,
            start: &start,
            cars: [subject.setup, baseline.setup],
            cycle_sha256: &cycle_sha256,
            subject_sha256: &subject_sha256,
        });
    }
}

/// True if a car is that of its file, unchanged. Overrides that repeat the file's values count as unchanged.
fn is_shipped(name: &str, setup: &Setup) -> bool {
    if setup.origin.is_shipped && setup.name == name {
        return true;
    }
    load(name, &Options::default()).is_ok_and(|own| car_sha256(&own) == car_sha256(setup))
}

/// The published numbers, of `known` or else of all that are about the cars, that a run contradicts; `start` as the rows have it.
pub fn contradicted(
    summary: &Summary,
    start: &str,
    driven: &[Driven],
    known: Option<&[ValidationRow]>,
) -> Vec<Contradiction> {
    let Some(subject) = driven.first() else {
        return Vec::new();
    };
    let rows = match known {
        Some(rows) => Cow::Borrowed(rows),
        None => {
            let baselines: Vec<&str> = driven.iter().skip(1).map(|car| car.name).collect();
            Cow::Owned(published(subject.name, &baselines, &summary.cycle))
        }
    };
    // A car is read again once at most, and only where a row is about it.
    let shipped: Vec<OnceCell<bool>> = vec![OnceCell::new(); driven.len()];
    let is_shipped = |k: usize| {
        let car = &driven[k];
        *shipped[k].get_or_init(|| is_shipped(car.name, car.setup))
    };
    let of_run = |about: &About| {
        about.start == start && (about.ambient_degc - summary.ambient_degc).abs() <= NEAR_K
    };
    let found = rows.iter().filter_map(|row| {
        let about = row.about.clone().filter(of_run)?;
        let baseline = about.baseline.as_deref();
        let other = match baseline {
            None => None,
            Some(name) => Some(driven.iter().skip(1).position(|car| car.name == name)?),
        };
        let computed = number(summary, &about, other)?;
        let of_cars = || is_shipped(0) && other.is_none_or(|k| is_shipped(k + 1));
        (row.contradicts(computed) && of_cars()).then(|| Contradiction {
            row: row.id.clone(),
            baseline: about.baseline.clone(),
            phase: about.phase.clone(),
            computed,
            unit: row.unit.clone(),
            printed: row.printed_text.clone(),
            between: match row.printed {
                Some(Printed::Range(low, high)) if low.is_finite() && high.is_finite() => {
                    Some([low, high])
                }
                _ => None,
            },
            condition: row.condition.clone(),
        })
    });
    found.collect()
}

/// The number of a run that a row is about.
fn number(summary: &Summary, about: &About, baseline: Option<usize>) -> Option<f64> {
    let run = summary.runs.first()?;
    match (about.baseline.is_some(), &about.phase) {
        (true, None) => summary.comparison.get(baseline?)?.fuel_percent,
        (true, Some(phase)) => {
            let comparison = summary.comparison.get(baseline?)?;
            comparison.phases_percent.get(phase)
        }
        (false, None) => run.headline_fuel(),
        (false, Some(phase)) => {
            let mut phases = run.phases.iter();
            phases.find(|of| of.name == *phase)?.fuel_l_per_100km
        }
    }
}

/// Says how far rate and resolution of a log leave the fuel and the difference to each baseline open; `None` of speeds that were not smoothed.
pub fn resolution_left(summary: &Summary) -> Option<String> {
    let own = summary.recording.as_ref()?;
    let (fuel, run) = (own.fuel?, summary.runs.first()?);
    let unit = run.over().unit();
    let [low, high] = fuel.map(|end| fixed(end, 2));
    let differences = summary
        .comparison
        .iter()
        .zip(&summary.runs[1..])
        .enumerate();
    let differences = differences.filter_map(|(k, (_, other))| {
        let ends = own.percent.get(k).copied().flatten()?;
        Some(format!(", {} to {}", between(ends, "%"), other.label()))
    });
    let differences: String = differences.collect();
    Some(format!(
        "Rate and resolution of the log leave {low} to {high} {unit}{differences}."
    ))
}

/// The first lines of a run, a sentence each.
pub fn sentences(summary: &Summary) -> Vec<String> {
    let Some(run) = summary.runs.first() else {
        return Vec::new();
    };
    let over = run.over();
    let Some(fuel) = run.consumption(over) else {
        return Vec::new();
    };
    // The first interval alone carries the explanation of runs.
    let mut explained = [false, run.fleet.is_some()];
    let recording = summary.recording.as_ref();
    let left = |k: usize| recording.and_then(|own| own.percent.get(k).copied().flatten());
    // Next to a car that is like for like another car says little: the table has it.
    let is_other = |k: usize| summary.runs[k + 1].role != UNCHANGED;
    let mut compared = summary.comparison.iter().enumerate();
    let has_alike = compared.any(|(k, of)| is_other(k) && of.differences.is_empty());
    let against = summary.comparison.iter().enumerate().filter_map(|(k, of)| {
        if has_alike && is_other(k) && !of.differences.is_empty() {
            return None;
        }
        let said = against(of, [run, &summary.runs[k + 1]], explained).map(|said| match left(k) {
            Some(ends) => format!(
                "{said} [{} by the resolution of the log]",
                between(ends, "%")
            ),
            None => said,
        });
        explained[0] |=
            of.fleet.is_none() && of.interval.as_ref().is_some_and(|of| of.ends().is_some());
        explained[1] |= of.fleet.is_some();
        said
    });
    let against: String = against.collect();
    let range = fuel_ranges(run);
    let resolution = recording
        .and_then(|own| own.fuel)
        .map_or_else(String::new, |ends| {
            let [low, high] = ends.map(|end| fixed(end, 2));
            format!(" [{low} to {high} by the resolution of the log]")
        });
    let doubt = recording.map_or_else(String::new, |own| doubtful("DOUBTFUL", own));
    let mass = match over {
        Over::Distance => String::new(),
        Over::Time => format!(" ({})", mass_in_time(run)),
    };
    let faults = run.faults();
    let failed = match faults.is_empty() {
        true => String::new(),
        false => format!(
            "FAILED, {}; not the numbers of a car that drives this cycle. ",
            faults.join(", ")
        ),
    };
    let first = format!(
        "{doubt}{failed}{}: {} {}{mass}{resolution}{range}{against}.",
        run.vehicle,
        fixed(fuel, 2),
        over.unit()
    );
    let measured = recording.and_then(compared_log);
    let starts = recording
        .filter(|own| own.starts)
        .and_then(|_| summary.start.nodes_in_words())
        .map(|nodes| format!("The drive starts as the log does: {nodes}."));
    let rest = [recording.and_then(repaired), starts, measured, price(run)];
    let lines = std::iter::once(first)
        .chain(failing_draws(summary))
        .chain(rest.into_iter().flatten());
    let lines = lines.chain(input_doubts(summary));
    let lines = lines.chain(draw_doubts(summary)).chain(maps_left(summary));
    lines.chain(contradictions(summary)).collect()
}

/// Draws in which a car fails, where they are more than a few: the first risk.
fn failing_draws(summary: &Summary) -> Vec<String> {
    let drawn = summary.comparison.iter().filter_map(|comparison| {
        let words = comparison.interval.as_ref()?.failures_in_words()?;
        Some(format!(
            "Risk: against {} {words}. A smaller range of the values that cause it, or another value, is needed before these cars can be compared.",
            comparison.baseline
        ))
    });
    drawn.collect()
}

/// Means of other quantities of the log and of the computed car, a sentence.
fn compared_log(recording: &RecordingSummary) -> Option<String> {
    let each = recording.measured.iter().map(|own| {
        let name = own.quantity.replace('_', " ");
        let decimals = match own.unit.as_str() {
            "g/s" => 3,
            "rpm" => 0,
            _ => 1,
        };
        let [measured, computed, rms] = [own.measured, own.computed, own.rms].map(|x| fixed(x, decimals));
        let percent = match own.quantity.as_str() {
            "fuel" => format!(" ({} %)", signed(100.0 * (own.computed / own.measured - 1.0), 1)),
            _ => String::new(),
        };
        format!("{name} {measured} {} in the log, {computed} computed{percent}, rms of the difference {rms}", own.unit)
    });
    let each: Vec<String> = each.collect();
    (!each.is_empty()).then(|| format!("Means against the log: {}.", each.join("; ")))
}

/// "DOUBTFUL, this is udds times 0.6214: are the numbers mph? ": begins a text about a doubted recording; empty for one without doubts.
pub fn doubtful(word: &str, recording: &RecordingSummary) -> String {
    let text = recording.doubts.join("; ");
    match text.chars().last() {
        None => text,
        Some('?') => format!("{word}, {text} "),
        Some(_) => format!("{word}, {text}. "),
    }
}

/// The repairs of a recording, a sentence.
fn repaired(recording: &RecordingSummary) -> Option<String> {
    let repairs = recording.repairs.iter();
    let list: Vec<String> = repairs
        .map(|own| format!("{} ({})", own.what, own.name))
        .collect();
    (!list.is_empty()).then(|| format!("The log was repaired: {}.", list.join("; ")))
}

/// "151.2 g in 600 s, 0.907 kg/h; 0 m are too short for L/100 km": what is added to a consumption over time.
pub fn mass_in_time(run: &RunSummary) -> String {
    let (grams, seconds) = (fixed(run.fuel_kg * 1e3, 1), fixed(run.duration_s, 0));
    let (an_hour, metres) = (
        fixed(run.fuel_kg * 3600.0 / run.duration_s, 3),
        fixed(run.distance_km * 1e3, 0),
    );
    format!(
        "{grams} g in {seconds} s, {an_hour} kg/h; {metres} m in that time are too few for L/100 km"
    )
}

/// Share of the distance between the ends of the draws by which the car as it is may be from their median. ASSUMED: half of the draws of any bell
/// are nearer, so that beyond it the draws are about other cars.
const NEAR_MEDIAN: f64 = 0.25;

/// Where draws say less of a difference than their interval looks like: too few, or the difference of the cars as they are not among them.
fn draw_doubts(summary: &Summary) -> Vec<String> {
    let confidence = Confidence::default();
    let drawn = summary.comparison.iter().filter_map(|comparison| {
        let (of, percent) = (comparison.interval.as_ref()?, comparison.fuel_percent?);
        of.ends()?;
        let [low, median, high] = of.percent;
        let n = usize::try_from(of.draws).ok()?;
        let mut doubts = Enough::from_draws(n, confidence).doubts(confidence);
        let decimals = decimals([low, high]);
        let [in_median, as_is] = [median, percent].map(|x| signed(x, decimals));
        let is_far = (percent - median).abs() > NEAR_MEDIAN * (high - low);
        // Numbers that are written alike are no doubt.
        if is_far && in_median != as_is {
            let (median, percent) = (in_median, as_is);
            doubts.push(format!(
                "the median of the varied runs is {median} %, the cars as they are have {percent} %: the ranges of the plan are not centred on these cars"
            ));
        }
        let forms = of.forms_in_words();
        doubts.extend(forms.map(|list| format!("by the form of the law: {list}")));
        let baseline = &comparison.baseline;
        (!doubts.is_empty()).then(|| format!("Varied runs against {baseline}: {}.", doubts.join("; ")))
    });
    drawn.collect()
}

/// Beginning of a note that is a doubt about what was read.
pub const DOUBT: &str = "doubt: ";

/// The doubts about what was read of each car: numbers from it are as doubtful.
pub fn input_doubts(summary: &Summary) -> Vec<String> {
    let of = |run: &RunSummary| {
        let doubts = run.notes.iter().filter(|note| note.starts_with(DOUBT));
        let lines: Vec<String> = doubts
            .map(|note| format!("{}: {note}.", run.vehicle))
            .collect();
        lines
    };
    summary.runs.iter().flat_map(of).collect()
}

/// The measured maps that a car left for a large part of the run, a sentence each.
pub fn maps_left(summary: &Summary) -> Vec<String> {
    let of = |run: &RunSummary| {
        let maps = run.maps_left.iter();
        maps.map(|map| left_map(run, map)).collect::<Vec<_>>()
    };
    summary.runs.iter().flat_map(of).collect()
}

/// A measured map that a car left: "mycar: pump.csv was left for 78 % of the time with the engine on, most of it with …".
fn left_map(run: &RunSummary, map: &MapLeft) -> String {
    let end = map
        .end
        .map_or_else(String::new, |end| format!(" {}", decimal(end)));
    let (vehicle, file) = (&run.vehicle, &map.file);
    let time = match map.seconds {
        Some(seconds) => format!(" ({} s)", fixed(seconds, 0)),
        None => String::new(),
    };
    let percent = fixed(map.percent, 0);
    let left =
        format!("{vehicle}: {file} was left for {percent} % of the time with the engine on{time}");
    match map.column.as_str() {
        "" => format!(
            "{left}, most in holes between its points; what is there follows from the nearest of them."
        ),
        column => format!(
            "{left}, most by {column} {}{end}; the value of its edge is held there.",
            map.side
        ),
    }
}

/// The published numbers that a run contradicts, a sentence each.
pub fn contradictions(summary: &Summary) -> Vec<String> {
    let Some(run) = summary.runs.first() else {
        return Vec::new();
    };
    let all = summary.contradicted.iter();
    all.map(|of| contradiction(run, of)).collect()
}

/// How sure the differences to the baselines are, a sentence for each of which it is known.
pub fn intervals(summary: &Summary) -> Vec<String> {
    let drawn = summary.comparison.iter().filter_map(|comparison| {
        let of = comparison.interval.as_ref()?;
        let ends = of.ends()?;
        let median = signed(of.percent[1], decimals(ends));
        let ends = between(ends, "%");
        let (baseline, plan, draws, more) = (&comparison.baseline, &of.plan, of.draws, of.more);
        Some(format!(
            "Difference to {baseline} over {draws} runs with the uncertain values of the plan {plan} varied: 90 % of them are {ends}, the median is {median} %; the subject uses more in {more}."
        ))
    });
    drawn.chain(draw_doubts(summary)).collect()
}

/// ", 6.6 % more than the baseline (90 % range -3 to +13 %, by the error of the model on 28 measured cars; uncertain inputs alone +1 to +10 %, more in
/// 252 of 256 runs)".
fn against(
    comparison: &Comparison,
    [own, other]: [&RunSummary; 2],
    [explained, explained_fleet]: [bool; 2],
) -> Option<String> {
    let percent = comparison.fuel_percent?;
    let is_change = other.role == UNCHANGED;
    let baseline = match is_change {
        true => "the car unchanged",
        false => comparison.baseline.as_str(),
    };
    let faults = other.faults();
    let is_failed = !faults.is_empty() || !own.faults().is_empty();
    let baseline = match faults.is_empty() {
        true => baseline.to_owned(),
        false => format!("{baseline}, which failed ({})", faults.join(", ")),
    };
    let drawn = comparison.interval.as_ref();
    let failing = drawn.filter(|of| of.ends().is_none());
    let inputs = drawn.and_then(|of| Some((of, of.ends()?)));
    let fleet = comparison.fleet.as_ref().filter(|_| failing.is_none());
    let digits = match (fleet, inputs) {
        (None, Some((_, ends))) => decimals(ends),
        _ if is_change => 2,
        _ => 1,
    };
    let left_out = match drawn.map_or(0, |of| of.left_out) {
        0 => String::new(),
        n => format!("; {n} left out"),
    };
    let range = match (fleet, inputs) {
        (Some(of), inputs) => {
            let range = match explained_fleet {
                true => between(of.ends, "%"),
                false => difference_of_cars(of),
            };
            let inputs = inputs.map_or_else(String::new, |(of, ends)| {
                let (ends, more, all) = (between(ends, "%"), of.more, of.draws);
                format!("; uncertain inputs alone {ends}, more in {more} of {all} runs{left_out}")
            });
            range + &inputs
        }
        (None, Some((of, ends))) => {
            let (ends, draws, more) = (between(ends, "%"), of.draws, of.more);
            let runs = match explained {
                false => format!("{draws} runs with uncertain inputs varied"),
                true => format!("{draws} runs"),
            };
            format!("90 % of {runs}: {ends}; more in {more}{left_out}")
        }
        (None, None) => match failing.and_then(DrawnDifference::failures_in_words) {
            Some(words) => format!("no range: {words}"),
            None if is_failed => "no range: a car that fails is compared".to_owned(),
            None if is_change => "range not computed".to_owned(),
            None => "how sure this is, no measured cars tell".to_owned(),
        },
    };
    let compared = more_or_less(percent, digits);
    let than = than(&compared);
    Some(format!(", {compared} {than} {baseline} ({range})"))
}

/// A published number against that of the run.
fn contradiction(run: &RunSummary, of: &Contradiction) -> String {
    let computed = match &of.baseline {
        Some(baseline) => of_difference(of.computed, baseline, of.phase.as_deref()),
        None => {
            let phase = of.phase.as_deref();
            let phase = phase.map_or_else(String::new, |phase| format!(" in {phase}"));
            let (car, unit) = (&run.vehicle, &of.unit);
            format!("{} {unit} of {car}{phase}", fixed(of.computed, 2))
        }
    };
    against_print(&computed, &of.printed, &of.condition, &of.row)
}
