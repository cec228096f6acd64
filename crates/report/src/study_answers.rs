//! The results of a study in sentences.

use serde_json::Value;

use super::number::{Quantity, degc};
use super::results::StudyResults;
use cvtcycle_output::summary::{StartWord, Summary};
use cvtcycle_study::StudyManifest;
use cvtcycle_study::answer::ambient::Matrix;
use cvtcycle_study::answer::{Comparison, OutputAnswer};
use cvtcycle_study::execute::outputs::EXCESS;

/// Differences between the cases of a study and of a run; none if they are the same.
///
/// Ambient and start count only where no factor sets them.
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
    let ambient = base["ambient_degc"].as_f64();
    let ambient = ambient.filter(|own| (own - run.ambient_degc).abs() > 1e-9);
    if let Some(ambient) = ambient.filter(|_| free("ambient_degc")) {
        differ("ambient", &degc(ambient), &degc(run.ambient_degc));
    }
    let start = match &run.start {
        StartWord::Word(word) => word.clone(),
        StartWord::Degc(degc) => degc.to_string(),
    };
    if let Some(own) = base["start"].as_str().filter(|_| free("start")) {
        differ("start", own, &start);
    }
    let same = |key: &str, own: &[String]| {
        let texts = base[key].as_array().into_iter().flatten();
        texts
            .filter_map(Value::as_str)
            .eq(own.iter().map(|text| &**text))
    };
    if !same("set", &run.settings.set) || !same("set_all", &run.settings.set_all) {
        list.push("other values set".to_owned());
    }
    (!list.is_empty()).then(|| list.join(", "))
}

/// The answer of a study in sentences.
pub fn answers(study: &StudyResults) -> Vec<String> {
    let answer = &study.answer;
    if answer.points_done == 0 {
        return Vec::new();
    }
    if let Some(matrix) = &answer.matrix {
        return matrix_answers(matrix);
    }
    let sentences = |of: &Comparison| [Some(compared(study, of)), decided(study, of)];
    let sentences = answer.comparisons.iter().flat_map(sentences);
    sentences.flatten().collect()
}

/// In how many pairs the subject uses more, and how much more.
///
/// A grid is no sample: its share says nothing beyond its own points.
fn compared(study: &StudyResults, of: &Comparison) -> String {
    let subject = study.outline.cars.first();
    let subject = subject.map_or("the subject", String::as_str);
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
    let own = |o: &&OutputAnswer| o.output == EXCESS && o.car == of.baseline;
    let output = study.answer.outputs.iter().find(own)?;
    let (measure, ranked) = ranked(output, &study.outline)?;
    let measure = match measure {
        Measure::Variance => "total share of the variance",
        Measure::Swing => "swing in percentage points",
        Measure::Rank => "rank correlation",
    };
    let factor = |(name, x): &(String, f64)| format!("{name} ({})", Quantity::Index.bare(*x));
    let factors: Vec<String> = ranked.iter().take(MAX_NAMED).map(factor).collect();
    Some(format!(
        "Most decided by {} [{measure}].",
        factors.join(", ")
    ))
}

/// What ranks the factors of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Total share of the variance.
    Variance,
    /// Swing of the output between the ends of a factor.
    Swing,
    /// Rank correlation.
    Rank,
}

/// Factors with the measure of the design, the strongest first; none where no factor has one.
pub fn ranked(
    output: &OutputAnswer,
    outline: &StudyManifest,
) -> Option<(Measure, Vec<(String, f64)>)> {
    let (measure, mut list): (_, Vec<(String, f64)>) = if let Some(indices) = output.sobol.last() {
        let factors = outline.plan.factors.iter().zip(&indices.factors);
        let factors = factors.map(|(factor, i)| (factor.name.clone(), i.total.value));
        (Measure::Variance, factors.collect())
    } else if let Some(tornado) = &output.tornado {
        let bars = tornado.bars.iter().map(|bar| (bar.name.clone(), bar.swing));
        (Measure::Swing, bars.collect())
    } else {
        let rank = output.rank.as_ref()?;
        let factors = rank.factors.iter().zip(&rank.of.factors);
        let factors = factors.map(|(name, f)| (name.clone(), f.spearman.value));
        (Measure::Rank, factors.collect())
    };
    list.retain(|(_, x)| x.is_finite());
    list.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    (!list.is_empty()).then_some((measure, list))
}

/// The excess at the coldest and the warmest ambient, for each start.
fn matrix_answers(matrix: &Matrix) -> Vec<String> {
    let (Some(subject), Some(total)) = (matrix.cars.first(), matrix.fuel.first()) else {
        return Vec::new();
    };
    let ambient = matrix.ambient_degc.iter().enumerate();
    let cold = ambient.clone().min_by(|a, b| a.1.total_cmp(b.1));
    let (Some(cold), Some(warm)) = (cold, ambient.max_by(|a, b| a.1.total_cmp(b.1))) else {
        return Vec::new();
    };
    let mut list = Vec::new();
    for (baseline, by_start) in matrix.cars.iter().skip(1).zip(&total.excess_percent) {
        let start = |(start, numbers): (&String, &Vec<f64>)| {
            let [cold, warm] = [cold, warm].map(|(k, ambient)| {
                let excess = numbers.get(k).copied();
                format!("{} at {}", Quantity::Percent.signed(excess), degc(*ambient))
            });
            format!("{cold} and {warm} (start {start})")
        };
        let starts: Vec<String> = matrix.starts.iter().zip(by_start).map(start).collect();
        let starts = starts.join("; ");
        list.push(format!("Fuel of {subject} over {baseline}: {starts}."));
    }
    list
}

/// Most factors named in a sentence.
const MAX_NAMED: usize = 3;
