//! The results of a study in sentences.

use serde_json::Value;

use super::number::{Quantity, degc};
use super::results::StudyResults;
use cvtcycle_output::summary::{StartWord, Summary};
use cvtcycle_study::ambient::Matrix;
use cvtcycle_study::answer::{Comparison, OutputAnswer};
use cvtcycle_study::outputs::EXCESS;

/// Differences between the cases of a study and of a run; none if they are the same.
///
/// Ambient and start count only where no factor sets them.
#[must_use]
pub fn other_case(study: &StudyResults, run: &Summary) -> Option<String> {
    let (plan, base) = (&study.outline.plan, &study.manifest["base"]);
    let free = |key: &str| plan.factors.iter().all(|factor| factor.key != key);
    let mut list = Vec::new();
    let mut differ = |what: &str, own: &str, other: &str| {
        if own != other {
            list.push(format!("{what} {own} instead of {other}"));
        }
    };
    let cycles = study.manifest["cycles"].as_array().into_iter().flatten();
    let cycles: Vec<&str> = cycles.filter_map(|cycle| cycle["name"].as_str()).collect();
    if !cycles.contains(&run.cycle.as_str()) {
        differ("cycle", &cycles.join(", "), &run.cycle);
    }
    let subject = run.runs.first().map_or("", |run| run.vehicle.as_str());
    let own = study.outline.cars.first().map_or("", String::as_str);
    differ("subject", own, subject);
    let ambient = base["ambient_degc"]
        .as_f64()
        .filter(|_| free("ambient_degc"));
    if let Some(ambient) = ambient.filter(|own| (own - run.ambient_degc).abs() > 1e-9) {
        differ("ambient", &degc(ambient), &degc(run.ambient_degc));
    }
    let start = match &run.start {
        StartWord::Word(word) => word.clone(),
        StartWord::Degc(degc) => degc.to_string(),
    };
    if let Some(own) = base["start"].as_str().filter(|_| free("start")) {
        differ("start", own, &start);
    }
    let set = |value: &Value| -> Vec<String> {
        let texts = value
            .as_array()
            .into_iter()
            .flatten()
            .filter_map(Value::as_str);
        texts.map(str::to_owned).collect()
    };
    if set(&base["set"]) != run.settings.set || set(&base["set_all"]) != run.settings.set_all {
        list.push("other values set".to_owned());
    }
    (!list.is_empty()).then(|| list.join(", "))
}

/// The answer of a study in sentences.
#[must_use]
pub fn answers(study: &StudyResults) -> Vec<String> {
    let answer = &study.answer;
    if answer.points_done == 0 {
        return Vec::new();
    }
    if let Some(matrix) = &answer.matrix {
        return matrix_answers(matrix);
    }
    answer
        .comparisons
        .iter()
        .flat_map(|comparison| {
            [
                Some(compared(study, comparison)),
                decided(study, comparison),
            ]
        })
        .flatten()
        .collect()
}

/// In how many pairs the subject uses more, and how much more.
///
/// A grid is no sample: its share says nothing beyond its own points.
fn compared(study: &StudyResults, of: &Comparison) -> String {
    let subject = study
        .outline
        .cars
        .first()
        .map_or("the subject", String::as_str);
    let (excess, worse) = (&of.excess_percent, &of.worse);
    let signed = |x: f64| Quantity::Percent.signed(x);
    if worse.n == 0 {
        return format!(
            "The study \u{201c}{}\u{201d} has no pair of good runs of {subject} and {}.",
            study.answer.title, of.baseline
        );
    }
    let head = format!(
        "In the study \u{201c}{}\u{201d} {subject} uses more fuel than {}",
        study.answer.title, of.baseline
    );
    if !study.outline.plan.design.is_sampled() {
        let mean = signed(excess.mean);
        return format!(
            "{head} at {} of {} points; the excess is {} to {}, {mean} on average.",
            worse.k,
            worse.n,
            signed(excess.min),
            signed(excess.max)
        );
    }
    let percent = |share: f64| Quantity::Percent.bare(100.0 * share);
    let [low, high] = worse.interval95;
    format!(
        "{head} in {} of {} pairs, {} % (95 % interval {} to {} %). The excess is {} on average with a standard deviation of {} points; 90 % of the pairs lie between {} and {}.",
        worse.k,
        worse.n,
        percent(worse.share),
        percent(low),
        percent(high),
        signed(excess.mean),
        Quantity::Percent.bare(excess.sd),
        signed(excess.quantile(0.05)),
        signed(excess.quantile(0.95))
    )
}

/// Which factors decide the excess.
fn decided(study: &StudyResults, of: &Comparison) -> Option<String> {
    let output = study
        .answer
        .outputs
        .iter()
        .find(|o| o.output == EXCESS && o.car == of.baseline)?;
    let (measure, mut ranked) = ranked(study, output)?;
    ranked.retain(|(_, x)| x.is_finite());
    ranked.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let factors: Vec<String> = ranked
        .iter()
        .take(MAX_NAMED)
        .map(|(name, x)| format!("{name} ({})", Quantity::Index.bare(*x)))
        .collect();
    (!factors.is_empty()).then(|| format!("Most decided by {} [{measure}].", factors.join(", ")))
}

fn ranked(
    study: &StudyResults,
    output: &OutputAnswer,
) -> Option<(&'static str, Vec<(String, f64)>)> {
    if let Some(indices) = output.sobol.last() {
        let factors = study.outline.plan.factors.iter().zip(&indices.factors);
        return Some((
            "total share of the variance",
            factors
                .map(|(factor, i)| (factor.name.clone(), i.total.value))
                .collect(),
        ));
    }
    if let Some(tornado) = &output.tornado {
        return Some((
            "swing in percentage points",
            tornado
                .bars
                .iter()
                .map(|bar| (bar.name.clone(), bar.swing))
                .collect(),
        ));
    }
    let rank = output.rank.as_ref()?;
    Some((
        "rank correlation",
        rank.factors
            .iter()
            .zip(&rank.of.factors)
            .map(|(name, f)| (name.clone(), f.spearman.value))
            .collect(),
    ))
}

/// The excess at the coldest and the warmest ambient, for each start.
fn matrix_answers(matrix: &Matrix) -> Vec<String> {
    let (Some(subject), Some(total)) = (matrix.cars.first(), matrix.fuel.first()) else {
        return Vec::new();
    };
    let mut order: Vec<usize> = (0..matrix.ambient_degc.len()).collect();
    order.sort_by(|a, b| matrix.ambient_degc[*a].total_cmp(&matrix.ambient_degc[*b]));
    let (Some(&cold), Some(&warm)) = (order.first(), order.last()) else {
        return Vec::new();
    };
    let at = |numbers: &[f64], k: usize| {
        Quantity::Percent.signed(numbers.get(k).copied().unwrap_or(f64::NAN))
    };
    let mut list = Vec::new();
    for (baseline, by_start) in matrix.cars.iter().skip(1).zip(&total.excess_percent) {
        let starts: Vec<String> = matrix
            .starts
            .iter()
            .zip(by_start)
            .map(|(start, numbers)| {
                let (cold_degc, warm_degc) = (
                    degc(matrix.ambient_degc[cold]),
                    degc(matrix.ambient_degc[warm]),
                );
                format!(
                    "{} at {cold_degc} and {} at {warm_degc} (start {start})",
                    at(numbers, cold),
                    at(numbers, warm)
                )
            })
            .collect();
        list.push(format!(
            "Fuel of {subject} over {baseline}: {}.",
            starts.join("; ")
        ));
    }
    list
}

/// Most factors named in a sentence.
const MAX_NAMED: usize = 3;
