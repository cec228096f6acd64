//! Page 1: question, answer with its interval and contradicting numbers, price of the losses, options, risk, next test, decision.

use super::super::document::{Block, Section};
use super::super::number::{Quantity, capital_first, grouped, words};
use super::super::results::{RunResults, StudyResults};
use super::super::{study, study_answers, validation};
use super::{Car, conditions_line, cycle_title, doubts};
use crate::charts::decision::{Against, against, answer_strip, level};
use crate::charts::{foremost_levers, lever_title, saves};
use cvtcycle_analysis::answer::Answer;
use cvtcycle_analysis::attribute;
use cvtcycle_analysis::levers::{LeverAnswer, LeverBlock, LeverRow};
use cvtcycle_analysis::words::run::{contradictions, doubtful, mass_in_time, resolution_left};
use cvtcycle_analysis::words::{decimals, fuel_ranges};
use cvtcycle_output::summary::{
    Comparison, Contradiction, DrawnDifference, Over, RunSummary, Summary, UNCHANGED,
};
use cvtcycle_study::answer::{Information, KnownFactor};
use cvtcycle_study::execute::side_effects::FLOOR;

/// Maximum number of levers on page 1, and among the decisions.
const OPTIONS: (usize, usize) = (4, 2);
/// Minimum change of the minimum clamp safety that is mentioned.
const SAFETY: f64 = 0.05;

/// Minimum time, s, in which a floor decides the pressure of a change and not that of the car as it is.
const FLOOR_S: f64 = 60.0;

/// Minimum share of the variance of a change that is mentioned.
const SIZE: f64 = 0.2;

/// Levers for the car and the ambient temperature of a run.
pub(super) type Options = Option<(LeverAnswer, LeverBlock)>;

pub(super) fn section(found: &RunResults, cars: &[Car], options: &Options) -> Section {
    let mut section = Section::new("answer", "Answer");
    let (summary, record) = (&found.summary, found.record.as_ref());
    let cycle = cycle_title(summary, record);
    let cycle = brief(&cycle);
    section
        .blocks
        .push(Block::Question(question(summary, cycle)));
    let best = options
        .as_ref()
        .and_then(|(answer, block)| best(answer, block));
    let contradicted = (!summary.contradicted.is_empty())
        .then(|| "A published number contradicts the model, see below.".to_owned());
    let lead = [Some(lead(summary, cycle)), contradicted, best];
    let lead = lead.into_iter().flatten();
    section
        .blocks
        .push(Block::Lead(lead.collect::<Vec<_>>().join(" ")));
    let failing = found.answer.as_ref().and_then(Answer::failures_in_words);
    for line in checks(summary)
        .into_iter()
        .chain(
            failing
                .iter()
                .map(|words| match found.answer.as_ref().is_some_and(Answer::is_known) {
                    true => format!("{words}. The ranges are those of the others."),
                    false => format!("{words}. No range, price or change of the design is claimed: mend what fails first."),
                }),
        )
        .chain(found.missing.iter().map(|line| capital_first(line) + "."))
    {
        section.alert(line);
    }
    strip(&mut section, summary, cycle);
    for line in contradictions(&summary.labelled()) {
        // "Soak" is a term of test cells, unfamiliar to other readers.
        section.alert(line.replace("soak, ", "cold start, "));
    }
    if let Some(price) = cars.first().and_then(|car| attribute::answer(car.run)) {
        section.text(price);
    }
    match options {
        Some((answer, block)) => {
            let caption = format!(
                "Options: what the most effective changes of the design (levers) do to the fuel of {}.",
                block.vehicle
            );
            section.figure(
                "options",
                caption,
                foremost_levers(answer, block, OPTIONS.0),
            );
        }
        None => section.text(match &found.answer {
            Some(answer) if !answer.is_known() => "Options: no change of the design is compared with a car that fails in so many draws.",
            _ => "Options: not computed for this case.",
        }),
    }
    let own = found
        .studies
        .iter()
        .find_map(|study| next_test(study, summary));
    let computed = || test_of(found.answer.as_ref()?.information.as_ref()?, summary);
    let next = own.or_else(computed);
    let no_test = no_test(found.answer.as_ref());
    section.blocks.push(Block::Boxes(vec![
        ("Risk".to_owned(), risks(found, cars, options)),
        (
            "Next test".to_owned(),
            vec![next.as_ref().map_or(no_test, |next| next.0.clone())],
        ),
        (
            "Decision".to_owned(),
            decisions(options, next.map(|next| next.1)),
        ),
    ]));
    section
}

/// Shortens the title of a cycle: "NEDC" of "NEDC: four ECE 15 and one EUDC, 1180 s (UN R83)".
pub(crate) fn brief(title: &str) -> &str {
    title.split([':', '(', ',']).next().map_or(title, str::trim)
}

fn question(summary: &Summary, cycle: &str) -> String {
    let subject = summary.runs.first().map_or("car", RunSummary::label);
    let conditions = conditions_line(summary);
    let against = summary.runs.get(1).map_or_else(String::new, |run| {
        format!(", compared with the {}", run.label())
    });
    format!(
        "How much fuel does the {subject} use on the cycle {cycle} ({conditions}){against}? What do the losses of its transmission cost, and which changes are worthwhile?"
    )
}

/// Levers that were driven for this report, with the car named as in tables and figures.
pub(super) fn computed_options(found: &RunResults) -> Options {
    // Draws in which a failing car happens to work are those of another car.
    let answer = found.answer.as_ref().filter(|answer| answer.is_known());
    let mut answer = answer?.levers.clone()?;
    if answer.blocks.is_empty() {
        return None;
    }
    let mut block = answer.blocks.swap_remove(0);
    let subject = found.summary.runs.first()?;
    subject.label().clone_into(&mut block.vehicle);
    Some((answer, block))
}

/// Range of a difference, and whether it is by measured cars: that of like cars, which holds the error of the model, before that of draws of the
/// inputs; none where too many draws fail.
fn interval(comparison: &Comparison) -> Option<([f64; 2], bool)> {
    let drawn = comparison.interval.as_ref();
    if drawn.is_some_and(|drawn| drawn.ends().is_none()) {
        return None;
    }
    match &comparison.fleet {
        Some(fleet) => Some((fleet.ends, true)),
        None => Some((drawn?.ends()?, false)),
    }
}

/// Fuel of the subject, and its difference to the first baseline with the known uncertainty.
fn lead(summary: &Summary, cycle: &str) -> String {
    let Some(subject) = summary.runs.first() else {
        return String::new();
    };
    let over = subject.over();
    let fuel = Quantity::fuel(over).text(subject.consumption(over));
    let mass = match over {
        Over::Distance => String::new(),
        Over::Time => format!(" ({})", mass_in_time(subject)),
    };
    let weighted = match subject.weighted_fuel_l_per_100km {
        Some(_) => " (weighted)",
        None => "",
    };
    let range = fuel_ranges(subject);
    let recording = summary.recording.as_ref();
    let doubt = recording.map_or_else(String::new, |own| doubtful("Doubtful", own));
    let faults = subject.faults();
    let failed = match faults.is_empty() {
        true => String::new(),
        false => format!("FAILED, {}. ", faults.join(", ")),
    };
    let text = format!(
        "{doubt}{failed}The {} uses {fuel}{mass}{weighted}{range} on {cycle}",
        subject.label()
    );
    // A change is compared with the car before it, then with the first other car.
    let is_changed = summary.runs.get(1).is_some_and(|run| run.role == UNCHANGED);
    let sentence = |k: usize| {
        let (comparison, baseline) = (summary.comparison.get(k)?, summary.runs.get(k + 1)?);
        Some(difference(comparison, baseline, comparison.fuel_percent?))
    };
    let all = (0..if is_changed { 2 } else { 1 }).filter_map(sentence);
    match all.collect::<Vec<_>>() {
        list if list.is_empty() => text + ".",
        list => format!("{text}: {}.", list.join("; ")),
    }
}

/// The difference to another car, and how sure it is.
fn difference(comparison: &Comparison, baseline: &RunSummary, percent: f64) -> String {
    let other = match baseline.role.as_str() {
        UNCHANGED => "the car unchanged".to_owned(),
        _ => format!("the {}", baseline.label()),
    };
    let range = interval(comparison);
    let difference = against(percent, range.map(|(ends, _)| ends), &other);
    let kind = likeness(comparison);
    let drawn = comparison.interval.as_ref();
    let inputs = drawn.and_then(|drawn| Some((drawn.draws, level(drawn.ends()?))));
    let known = match (&comparison.fleet, range, inputs) {
        (Some(fleet), Some((ends, _)), inputs) => {
            let inputs = inputs.map_or_else(String::new, |(_, ends)| {
                format!("; the uncertain inputs alone give {ends}")
            });
            format!(
                "90 % range {}, by the error of the model on {} measured cars{inputs}",
                level(ends),
                fleet.cars
            )
        }
        (None, Some(_), Some((draws, ends))) => {
            format!("with the uncertain inputs varied 90 % of {draws} runs give {ends}")
        }
        _ => match drawn.and_then(DrawnDifference::failures_in_words) {
            Some(words) => format!("no range can be given: {words}"),
            None => "how sure that is, no measured cars tell".to_owned(),
        },
    };
    format!("{difference}{kind}; {known}")
}

/// " (not like for like)", where that applies.
fn likeness(comparison: &Comparison) -> &'static str {
    match comparison.differences.is_empty() {
        true => "",
        false => " (not like for like)",
    }
}

/// Sentence on the lever with the largest saving.
fn best(answer: &LeverAnswer, block: &LeverBlock) -> Option<String> {
    let row = single(block).next()?;
    let (name, saved) = (&row.of.title, -row.fuel_percent.value);
    // A second one that may save as much has a claim to be looked at.
    let rival = block.between.first().filter(|of| of.percent[2] > 0.0);
    let rival = rival.map_or_else(String::new, |of| {
        format!(" Whether {} saves as much is open.", of.titles[1])
    });
    let ends = [-row.high_percent.value, -row.low_percent.value];
    Some(match answer.plan {
        Some(_) => {
            let digits = decimals(ends);
            let [low, high] = ends.map(|x| grouped(x, digits));
            format!(
                "Best single change: {name}, which saves {} % ({low} to {high} %).{rival}",
                grouped(saved, digits)
            )
        }
        None => format!(
            "Best single change: {name}, which saves {} % (without draws no interval).",
            grouped(saved, 1)
        ),
    })
}

/// Working levers that save fuel, in descending saving.
fn single(block: &LeverBlock) -> impl Iterator<Item = &LeverRow> {
    let single = block.rows.iter().filter(|row| !row.is_combination());
    single.filter(|row| saves(row))
}

/// Adds a figure of the confidence in the difference to each baseline, if there is one.
pub(crate) fn strip(section: &mut Section, summary: &Summary, cycle: &str) {
    let Some((subject, baselines)) = summary.runs.split_first() else {
        return;
    };
    if baselines.is_empty() {
        return;
    }
    let row = |(baseline, comparison): (&RunSummary, &Comparison)| Against {
        baseline: baseline.label().to_owned(),
        title: format!("{}{}", baseline.title, likeness(comparison)),
        files: comparison.fuel_percent,
        drawn: match (interval(comparison), &comparison.interval) {
            (Some((_, false)), Some(drawn)) => Some(drawn.percent),
            (Some(([low, high], _)), _) => comparison.fuel_percent.map(|own| [low, own, high]),
            (None, _) => None,
        },
        is_by_cars: comparison.fleet.is_some(),
        published: published(summary, &baseline.vehicle),
    };
    let rows: Vec<Against> = baselines.iter().zip(&summary.comparison).map(row).collect();
    let conditions = format!("{cycle}, {}", conditions_line(summary));
    let picture = answer_strip(subject.label(), &conditions, &rows);
    let caption = format!(
        "Fuel of {} against each baseline, and how sure that is.",
        subject.label()
    );
    section.figure("answer", caption, picture);
}

/// Published range of the difference to a baseline over the whole cycle, if it contradicts that of the run.
pub(super) fn published(summary: &Summary, baseline: &str) -> Option<[f64; 2]> {
    let mut contradicted = summary.contradicted.iter();
    let own =
        |row: &&Contradiction| row.phase.is_none() && row.baseline.as_deref() == Some(baseline);
    contradicted.find(own)?.between
}

fn checks(summary: &Summary) -> Vec<String> {
    let failed = |run: &&RunSummary| !run.failed_checks.is_empty();
    let sentence = |run: &RunSummary| {
        let check = |check: &String| match run.flags_s.get(check) {
            Some(s) => format!("{} for {}", words(check), Quantity::Seconds.text(s)),
            None => words(check),
        };
        let list: Vec<String> = run.failed_checks.iter().map(check).collect();
        format!(
            "A check failed for {}: {}. Its numbers are not those of a car that has driven this cycle.",
            run.title,
            list.join(", ")
        )
    };
    summary.runs.iter().filter(failed).map(sentence).collect()
}

fn risks(found: &RunResults, cars: &[Car], options: &Options) -> Vec<String> {
    let failing = found.answer.as_ref().and_then(Answer::failures_in_words);
    let mut list: Vec<String> = failing.map(|words| words + ".").into_iter().collect();
    list.extend(resolution_left(&found.summary));
    list.extend(doubts::cold(cars.get(..1).unwrap_or_default()));
    list.extend(found.validation.as_ref().map(validation::differing));
    let block = options.iter().map(|(_, block)| block);
    let duration_s = cars.first().map_or(f64::NAN, |car| car.run.duration_s);
    list.extend(
        block
            .flat_map(asked)
            .filter_map(|row| risk(row, duration_s)),
    );
    if list.is_empty() {
        list.push("The model was not compared with measurements in this report, and no change of the design was driven.".to_owned());
    }
    list
}

/// Proposed changes: the first single levers, and the combinations.
fn asked(block: &LeverBlock) -> impl Iterator<Item = &LeverRow> {
    let together = block.rows.iter();
    let together = together.filter(|row| row.is_combination() && saves(row));
    single(block).take(OPTIONS.1).chain(together)
}

/// Risk of a change: draws in which it fails, safety against belt slip of the same draw, the value that its size depends on, and parts to be
/// built or proven.
fn risk(row: &LeverRow, duration_s: f64) -> Option<String> {
    let fails = (row.failed > 0).then(|| {
        let (failed, all) = (row.failed, row.failed + row.n);
        let names: Vec<&str> = row.reasons.iter().map(|(name, _)| name.as_str()).collect();
        let names = words(&names.join(", "));
        format!("it fails in {failed} of {all} runs ({names})")
    });
    let safety = row.effect("min_clamp_safety");
    // Draw by draw: the worst draw of the change against the worst one of the car as it is, not against its nominal value.
    let falls =
        safety.filter(|own| own.change < -SAFETY || own.worst < own.reference_worst - SAFETY);
    let falls = falls.map(|own| {
        let ratio = |x: f64| Quantity::Ratio.text(Some(x));
        format!(
            "lowest clamping safety over all runs: {} with this change, {} without it (below 1 the belt slips)",
            ratio(own.worst),
            ratio(own.reference_worst)
        )
    });
    let floor = row.effect(FLOOR).filter(|own| own.change > FLOOR_S);
    let floor = floor.map(|own| {
        format!(
            "for {} of {} the hydraulics' least pressure sets the clamp, not its law",
            Quantity::Seconds.text(own.median),
            Quantity::Seconds.text(duration_s)
        )
    });
    let size = row.set_by.as_ref().filter(|of| of.share >= SIZE);
    let size = size.map(|of| {
        format!(
            "the largest part of the uncertainty of what it saves is {} ({} % of the variance)",
            of.factor,
            grouped(100.0 * of.share.min(1.0), 0)
        )
    });
    let needs = row.of.needs.trim_end_matches('.');
    let needs = (!needs.is_empty()).then(|| format!("it needs {needs}"));
    // A combination has the floors, doubts and needs of its changes.
    let own = match row.is_combination() {
        true => [fails, falls, None, None, None],
        false => [fails, falls, floor, size, needs],
    };
    let both: Vec<String> = own.into_iter().flatten().collect();
    let title = capital_first(&lever_title(row));
    (!both.is_empty()).then(|| format!("{title}: {}.", both.join("; ")))
}

fn no_test(answer: Option<&Answer>) -> String {
    match answer {
        Some(answer) => format!(
            "No single value narrows the answer by more than chance in {} runs.",
            answer.draws
        ),
        None => "Not known: the uncertain values of this case were not varied.".to_owned(),
    }
}

/// Next test by the sample of the report.
fn test_of(information: &Information, summary: &Summary) -> Option<(String, String)> {
    let best = information.causes().next()?;
    let is_compared = summary.runs.iter().skip(1).any(|run| run.role != UNCHANGED);
    let of = match is_compared {
        true => ("fuel difference", "percentage points"),
        false => ("fuel", "L/100 km"),
    };
    let (text, test) = test_words(information, best, of);
    let by_cars = summary.comparison.iter().any(|of| of.fleet.is_some());
    let text = match by_cars {
        true => {
            text + " That is the part of the inputs: the error of the model stays, which a measurement of this car would show."
        }
        false => text,
    };
    Some((text, test))
}

/// Next test: the reduction of the spread by knowing a value, and the test in a few words.
fn next_test(own: &StudyResults, summary: &Summary) -> Option<(String, String)> {
    if study_answers::other_case(own, summary).is_some() {
        return None;
    }
    let (information, best) = study::cause(own)?;
    let of = ("fuel difference", "percentage points");
    Some(test_words(information, best, of))
}

fn test_words(
    information: &Information,
    best: &KnownFactor,
    (what, unit): (&str, &str),
) -> (String, String) {
    let digits = decimals([0.0, information.sd]) + 1;
    let [sd, left] = [information.sd, best.sd_left.value].map(|x| grouped(x, digits));
    let name = &best.name;
    let test = match best.test.as_str() {
        "" => format!("measure {name}"),
        test => test.to_owned(),
    };
    let text = format!(
        "{}. With the {name} known, the standard deviation of the {what} falls from {sd} to {left} {unit}.",
        capital_first(&test)
    );
    (text, format!("Measure: {name}"))
}

fn decisions(options: &Options, test: Option<String>) -> Vec<String> {
    let levers = options.iter().flat_map(|(_, block)| asked(block));
    let levers = levers.map(|row| format!("Develop: {}", lever_title(row)));
    let boxes = levers.chain(test).chain(["None of these".to_owned()]);
    let mut list: Vec<String> = boxes.map(|text| format!("\u{2610} {text}")).collect();
    list.push("Reviewed ________________".to_owned());
    list.push("Date ____________________".to_owned());
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use cvtcycle_analysis::levers::SideEffect;
    use cvtcycle_study::statistics::{Quantile, Share};

    /// A lever with the clamping safety of its worst draw, of the worst draw of the car as it is, and the median of its change.
    fn lever(worst: f64, reference_worst: f64, change: f64) -> LeverRow {
        let note = serde_json::json!({
            "vehicle": "car", "ambient_degc": -7.0, "kind": "lever", "name": "pump", "title": "variable pump", "reference": 0,
            "needs": "control of displacement"
        });
        let quantile = Quantile {
            p: 0.5,
            value: -1.0,
            interval: [None; 2],
        };
        LeverRow {
            of: serde_json::from_value(note).unwrap(),
            n: 256,
            failed: 0,
            reasons: Vec::new(),
            by_form: Vec::new(),
            fuel_percent: quantile,
            low_percent: quantile,
            high_percent: quantile,
            saves: Share::new(&[-1.0], None, |x| x < 0.0),
            fuel_l_per_100km: -0.1,
            co2_g_per_km: -2.0,
            sum_percent: None,
            set_by: None,
            effects: vec![SideEffect {
                name: "min_clamp_safety",
                unit: "-",
                median: worst + 0.2,
                worst,
                reference_worst,
                change,
                change_ends: [change; 2],
            }],
        }
    }

    /// A lever whose worst draw is better than that of the car as it is has no risk of safety, whatever the car has with its nominal values: a
    /// variable pump on a Civic was said to lower the safety from the nominal 1.27 to 1.01, where the worst draw of the car has 1.001.
    #[test]
    fn safety_is_compared_draw_by_draw() {
        let raised = risk(&lever(1.01, 1.001, 0.02), 1874.0).unwrap();
        assert_eq!(raised, "Variable pump: it needs control of displacement.");
        let lowered = risk(&lever(1.05, 1.38, -0.67), 1874.0).unwrap();
        assert!(
            lowered.contains(
                "lowest clamping safety over all runs: 1.05 with this change, 1.38 without it (below 1 the belt slips)"
            ),
            "{lowered}"
        );
    }
}
