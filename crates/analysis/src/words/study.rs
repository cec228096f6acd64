//! Sentences about a study: how often and by how much the subject uses more, the factor that decides it and is worth knowing, the minimum of an output,
//! and the published numbers that contradict it.

use cvtcycle_config::setup::{Kind, is_same_vehicle};
use cvtcycle_output::fleet_spread::{Compared, DrivenOn, FleetRange, Other, difference_range};
use cvtcycle_output::number::{fixed, plain, signed};

use super::effects::decided;
use super::{Written, against_print, between, decimals, difference_of_cars, ends_in};
use cvtcycle_study::answer::ambient::Matrix;
use cvtcycle_study::answer::{Answer, Comparison, OutputAnswer, Range};
use cvtcycle_study::execute::manifest::StudyManifest;
use cvtcycle_study::execute::outputs::EXCESS;
use cvtcycle_study::statistics::{Confidence, Summary, least_draws};
use cvtcycle_validate::{About, published};

/// The first lines of a study, a sentence each; none before a part of it is there.
pub fn sentences(answer: &Answer, outline: &StudyManifest) -> Vec<String> {
    if answer.points_done == 0 {
        return Vec::new();
    }
    let mut list = match &answer.matrix {
        Some(matrix) => of_climates(matrix, outline),
        None => of_design(answer, outline),
    };
    list.extend(contradictions(answer, outline));
    list
}

/// Range of the difference of the subject to a car of a study, by its place, for 90 % of such cars, as a run has it: measured cars tell. None of the same
/// car, and of studies of earlier versions.
#[must_use]
pub fn fleet_range(
    outline: &StudyManifest,
    baseline: usize,
    percent: f64,
    on: DrivenOn,
) -> Option<FleetRange> {
    let base = &outline.plan.base;
    // A car against itself with another oil or another value: no pair of measured cars differs by that alone.
    let is_same = base
        .baselines
        .as_ref()
        .and_then(|names| names.get(baseline.checked_sub(1)?));
    if is_same.is_some_and(|name| is_same_vehicle(name, &base.vehicle)) {
        return None;
    }
    let places = [0, baseline];
    let kind = |k: usize| {
        let kind = outline.kinds.get(k)?.as_str();
        (!kind.is_empty()).then_some(kind)
    };
    let [own, other] = places.map(kind);
    let is_twin = outline.cars[baseline] == format!("{}_twin", outline.cars[0]);
    let of = Compared {
        kinds: [own?, other?],
        other: match outline.alike.get(baseline) {
            _ if is_twin && outline.plan.base.set.is_empty() => Other::Twin,
            Some(true) => Other::Alike,
            _ => Other::Any,
        },
    };
    difference_range(of, on, percent).filter(|_| percent.is_finite())
}

/// Cycle and temperature of a study without a matrix; where they vary, the case with the widest range.
fn driven_on(outline: &StudyManifest) -> DrivenOn<'_> {
    let base = &outline.plan.base;
    let varies = |key: &str| outline.plan.factors.iter().any(|factor| factor.key == key);
    DrivenOn::whole(
        if varies("cycle") { "" } else { &base.cycle },
        if varies("ambient_degc") {
            f64::NEG_INFINITY
        } else {
            base.ambient_degc
        },
    )
}

/// The differences to the baselines and what decides them; without baselines the first output.
fn of_design(answer: &Answer, outline: &StudyManifest) -> Vec<String> {
    let mut list = Vec::new();
    for of in &answer.comparisons {
        list.push(compared(of, answer));
        list.extend(by_cars(of, outline));
        let mut outputs = answer.outputs.iter();
        let output = outputs.find(|o| o.output == EXCESS && o.car == of.baseline);
        list.extend(output.and_then(|output| decided(output, answer)));
    }
    if let Some(first) = answer
        .outputs
        .first()
        .filter(|_| answer.comparisons.is_empty())
    {
        list.extend(first.range.as_ref().and_then(|range| ends(first, range)));
        list.extend(
            first
                .summary
                .as_ref()
                .map(|of| spread(first, of, answer.confidence)),
        );
        list.extend(decided(first, answer));
    }
    list
}

/// Range of a difference by measured cars: of points that are no sample from the lower end of the least to the upper end of the largest.
fn by_cars(of: &Comparison, outline: &StudyManifest) -> Option<String> {
    let baseline = outline.cars.iter().position(|car| *car == of.baseline)?;
    let [least, largest] = match (&of.excess_range, &of.excess_percent) {
        (Some(range), _) => [range.least?, range.largest?],
        (None, Some(summary)) => [summary.quantile(0.5); 2],
        (None, None) => return None,
    };
    let on = driven_on(outline);
    let [mut range, high] = [least, largest].map(|x| fleet_range(outline, baseline, x, on));
    if let (Some(range), Some(high)) = (&mut range, high) {
        range.ends[1] = high.ends[1];
    }
    Some(format!(
        "Computed cars are not measured ones: the difference has a {}.",
        difference_of_cars(&range?)
    ))
}

/// In how many pairs the subject uses more, and how much more. Points that are no sample say nothing beyond themselves.
fn compared(of: &Comparison, answer: &Answer) -> String {
    let subject = answer.cars.first().map_or("the subject", String::as_str);
    let (worse, baseline) = (&of.worse, &of.baseline);
    if worse.n == 0 {
        return format!("{subject} and {baseline}: no pair of good runs.");
    }
    let (k, n) = (worse.k, worse.n);
    if let Some(range) = &of.excess_range {
        let [low, high] = [range.least, range.largest].map(|x| signed(x, 1));
        let where_to = match range.is_one() {
            true => format!("{low} % {}", range.least_at),
            false => format!(
                "{low} % ({}) to {high} % ({})",
                range.least_at, range.largest_at
            ),
        };
        return format!(
            "{subject} uses more fuel than {baseline} at {k} of {n} points; the difference is {where_to}."
        );
    }
    let (Some(s), Some(interval)) = (&of.excess_percent, worse.interval) else {
        return String::new();
    };
    let percent = |x: f64| fixed(100.0 * x, if n >= 1000 { 1 } else { 0 });
    let (share, [low, high]) = (percent(worse.share), interval.map(percent));
    let level = answer.confidence.percent();
    let (spread, digits) = middle(s, answer.confidence, ("%", signed));
    let (mean, sd) = (signed(s.mean, digits + 1), fixed(s.sd, digits + 1));
    format!(
        "{subject} uses more fuel than {baseline} in {k} of {n} pairs: {share} % ({level} % interval {low} to {high} %). \
         The difference is {mean} % on average, sd {sd}; {spread}."
    )
}

/// Where most of the draws lie, and the median; of too few draws their ends. And the decimals of its numbers.
fn middle(
    s: &Summary,
    confidence: Confidence,
    (unit, written): (&str, Written),
) -> (String, usize) {
    let [low, high] = confidence.ends();
    if s.n < least_draws(high, confidence) {
        let n = s.n;
        let digits = decimals([s.min, s.max]);
        let ends = ends_in([s.min, s.max], digits, (unit, written));
        let text = format!("the least and the largest of {n} runs are {ends}");
        return (text, digits);
    }
    let ends = [s.quantile(low), s.quantile(high)];
    let (draws, digits) = (confidence.draws_percent(), decimals(ends));
    let (ends, median) = (
        ends_in(ends, digits, (unit, written)),
        written(s.quantile(0.5), digits),
    );
    (
        format!("{draws} % of the runs are {ends}, the median is {median} {unit}"),
        digits,
    )
}

/// The spread of an output without anything to compare it with.
fn spread(output: &OutputAnswer, s: &Summary, confidence: Confidence) -> String {
    let (name, car) = (&output.output, &output.car);
    let text = middle(s, confidence, (&output.unit, fixed)).0;
    format!("{name} of {car}: {text}.")
}

/// The ends of an output over points that are no sample.
fn ends(output: &OutputAnswer, range: &Range) -> Option<String> {
    let (name, car, unit) = (&output.output, &output.car, &output.unit);
    let [least, largest] = [range.least?, range.largest?].map(|x| fixed(x, 3));
    let (at, other) = (&range.least_at, &range.largest_at);
    Some(match range.is_one() {
        true => format!("{name} of {car} is {least} {unit} {at}."),
        false => format!("{name} of {car} is {least} {unit} ({at}) to {largest} {unit} ({other})."),
    })
}

/// The difference at the coldest and the warmest ambient temperature, for each start.
fn of_climates(matrix: &Matrix, outline: &StudyManifest) -> Vec<String> {
    let (Some(subject), Some(total)) = (matrix.cars.first(), matrix.fuel.first()) else {
        return Vec::new();
    };
    let ambient = matrix.ambient_degc.iter().enumerate();
    let cold = ambient.clone().min_by(|a, b| a.1.total_cmp(b.1));
    let (Some(cold), Some(warm)) = (cold, ambient.max_by(|a, b| a.1.total_cmp(b.1))) else {
        return Vec::new();
    };
    let mut list = Vec::new();
    let mut known = None;
    let baselines = (1..).zip(matrix.cars.iter().skip(1));
    for ((place, baseline), by_start) in baselines.zip(&total.excess_percent) {
        let mut start = |(start, numbers): (&String, &Vec<f64>)| {
            let [cold, warm] = [cold, warm].map(|(k, degc)| {
                let excess = numbers.get(k).copied();
                let on = DrivenOn::whole(&outline.plan.base.cycle, *degc);
                let range = fleet_range(outline, place, excess.unwrap_or(f64::NAN), on);
                let ends = range.as_ref().map_or_else(String::new, |range| {
                    format!(" ({})", between(range.ends, "%"))
                });
                known = range.map(|range| range.cars).or(known);
                format!("{} %{ends} at {} degC", signed(excess, 1), plain(*degc))
            });
            format!("{cold} and {warm} (start {start})")
        };
        let starts: Vec<String> = matrix.starts.iter().zip(by_start).map(&mut start).collect();
        let starts = starts.join("; ");
        list.push(format!("Fuel of {subject} over {baseline}: {starts}."));
    }
    if known.is_some() {
        list.push("In brackets: 90 % range by the error of the model on measured cars.".to_owned());
    }
    list
}

/// Published numbers that the study contradicts, of cars as they are shipped.
fn contradictions(answer: &Answer, outline: &StudyManifest) -> Vec<String> {
    let base = &outline.plan.base;
    let changed = !base.set.is_empty() || !base.set_all.is_empty();
    let other_oil = base.lubricant.is_some() || base.engine_oil.is_some();
    let shipped = |name: &str| Kind::Vehicle.names().contains(&name);
    let subject = answer.cars.first().filter(|name| shipped(name));
    let Some(subject) = subject.filter(|_| !changed && !other_oil) else {
        return Vec::new();
    };
    let in_matrix = answer.matrix.iter().flat_map(|matrix| &matrix.cars);
    let compared = answer.comparisons.iter().map(|of| &of.baseline);
    let baselines: Vec<&str> = in_matrix.chain(compared).map(String::as_str).collect();
    let said = published(subject, &baselines, &base.cycle)
        .into_iter()
        .filter_map(|row| {
            let about = row.about.as_ref()?;
            let baseline = about.baseline.as_deref().filter(|name| shipped(name))?;
            let computed = number(answer, outline, about, baseline)?;
            row.contradicts(computed).then(|| {
                let words = super::of_difference(computed, baseline, about.phase.as_deref());
                against_print(&words, &row.printed_text, &row.condition, &row.id)
            })
        });
    said.collect()
}

/// The number of a study that a row is about: a cell of the matrix of climates, or the median of the draws of this case.
fn number(answer: &Answer, outline: &StudyManifest, about: &About, baseline: &str) -> Option<f64> {
    let base = &outline.plan.base;
    if let Some(matrix) = &answer.matrix {
        let car = matrix.cars.iter().position(|name| name == baseline)?;
        let name = about.phase.as_deref().unwrap_or("total");
        let part = matrix.fuel.iter().find(|part| part.name == name)?;
        let start = matrix
            .starts
            .iter()
            .position(|start| *start == about.start)?;
        let near = |degc: &f64| (degc - about.ambient_degc).abs() < 1e-9;
        let ambient = matrix.ambient_degc.iter().position(near)?;
        return part
            .excess_percent
            .get(car - 1)?
            .get(start)?
            .get(ambient)
            .copied();
    }
    let same = (base.ambient_degc - about.ambient_degc).abs() < 1e-9 && base.start == about.start;
    let free = |key: &str| outline.plan.factors.iter().all(|factor| factor.key != key);
    let conditions = ["ambient_degc", "start", "cycle"].into_iter().all(free);
    let of = answer
        .comparisons
        .iter()
        .find(|of| of.baseline == baseline)?;
    let median = of.excess_percent.as_ref().map(|s| s.quantile(0.5));
    median.filter(|x| same && conditions && about.phase.is_none() && x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_need_draws_that_reach_them() {
        let usual = Confidence::default();
        let draws = |n: usize| (0..n).map(|k| k as f64).collect::<Vec<_>>();
        let text = |n: usize| middle(&Summary::new(&draws(n), usual), usual, ("%", signed)).0;
        assert_eq!(
            text(71),
            "the least and the largest of 71 runs are 0 to +70 %"
        );
        // An output has no sign.
        let output = Summary::new(&draws(101), usual);
        assert_eq!(
            middle(&output, usual, ("W", fixed)).0,
            "90 % of the runs are 5 to 95 W, the median is 50 W"
        );
        assert_eq!(
            text(101),
            "90 % of the runs are +5 to +95 %, the median is +50 %"
        );
        let wide = Confidence::from_level(0.99);
        let text = middle(&Summary::new(&draws(101), wide), wide, ("%", signed)).0;
        assert!(
            text.starts_with("the least and the largest of 101 runs"),
            "{text}"
        );
    }
}
