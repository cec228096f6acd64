//! What a study says: how often and by how much the subject uses more, which factor decides it and is worth knowing, where an output is least,
//! and the published numbers that contradict it.

use cvtcycle_config::setup::Kind;
use cvtcycle_output::number::{fixed, plain, signed};

use super::{against_print, between, decimals};
use crate::answer::ambient::Matrix;
use crate::answer::{
    Answer, Comparison, GridMatrix, Information, KnownFactor, LeastOf, OutputAnswer, Range,
};
use crate::check::{About, published};
use crate::execute::manifest::StudyManifest;
use crate::execute::outputs::EXCESS;
use crate::statistics::{Confidence, Summary, Tornado, least_draws};

/// The first lines of a study, a sentence each; none before a part of it is there.
pub fn sentences(answer: &Answer, outline: &StudyManifest) -> Vec<String> {
    if answer.points_done == 0 {
        return Vec::new();
    }
    let mut list = match &answer.matrix {
        Some(matrix) => of_climates(matrix),
        None => of_design(answer),
    };
    list.extend(contradictions(answer, outline));
    list
}

/// The differences to the baselines and what decides them; without baselines the first output.
fn of_design(answer: &Answer) -> Vec<String> {
    let mut list = Vec::new();
    for of in &answer.comparisons {
        list.push(compared(of, answer));
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
    let (spread, digits) = middle(s, answer.confidence, "%");
    let (mean, sd) = (signed(s.mean, digits + 1), fixed(s.sd, digits + 1));
    format!(
        "{subject} uses more fuel than {baseline} in {k} of {n} pairs: {share} % ({level} % interval {low} to {high} %). \
         The difference is {mean} % on average, sd {sd}; {spread}."
    )
}

/// Where most of the draws lie, and the median; of too few draws their ends. And the decimals of its numbers.
fn middle(s: &Summary, confidence: Confidence, unit: &str) -> (String, usize) {
    let [low, high] = confidence.ends();
    let median = s.quantile(0.5);
    if s.n < least_draws(high, confidence) {
        let n = s.n;
        let digits = decimals([s.min, s.max]);
        let ends = between([s.min, s.max], unit);
        let text = format!("the least and the largest of {n} draws are {ends}");
        return (text, digits);
    }
    let ends = [s.quantile(low), s.quantile(high)];
    let (draws, digits) = (confidence.draws_percent(), decimals(ends));
    let (ends, median) = (between(ends, unit), signed(median, digits));
    (
        format!("{draws} % of the draws are {ends}, the median is {median} {unit}"),
        digits,
    )
}

/// The spread of an output without anything to compare it with.
fn spread(output: &OutputAnswer, s: &Summary, confidence: Confidence) -> String {
    let (name, car) = (&output.output, &output.car);
    let text = middle(s, confidence, &output.unit).0;
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

/// What decides an output, by design.
fn decided(output: &OutputAnswer, answer: &Answer) -> Option<String> {
    let unit = match output.output.as_str() {
        EXCESS => "points",
        _ => output.unit.as_str(),
    };
    if let Some(tornado) = &output.tornado {
        return largest_swing(tornado, unit);
    }
    if let Some(matrix) = &output.matrix {
        return least(matrix, &output.unit);
    }
    let summary = output.summary.as_ref()?;
    match &output.information {
        Some(information) => worth_knowing(information, unit),
        None if summary.sd > 0.0 => {
            let n = summary.n;
            Some(format!(
                "{n} draws are too few to name a cause of the spread."
            ))
        }
        None => answer
            .points
            .checked_sub(1)
            .map(|_| "The output does not vary.".to_owned()),
    }
}

/// The factor that moves an output most when it alone leaves the base.
fn largest_swing(tornado: &Tornado, unit: &str) -> Option<String> {
    let bar = tornado.bars.first().filter(|bar| bar.swing > 0.0)?;
    let (name, swing) = (&bar.name, fixed(bar.swing, 2));
    let side = |label: &str, effect: f64| format!("{} with {label}", signed(effect, 2));
    let known = bar
        .entries
        .iter()
        .filter(|end| end.effect.is_finite() && end.effect.abs() > 0.0);
    let sides: Vec<String> = known.map(|end| side(&end.label, end.effect)).collect();
    let sides = match sides.len() {
        1..=4 => format!(" ({})", sides.join(", ")),
        _ => String::new(),
    };
    Some(format!(
        "{name} by itself moves it most, over {swing} {unit}{sides}."
    ))
}

/// Where the numbers of a matrix are least.
fn least(matrix: &GridMatrix, unit: &str) -> Option<String> {
    let number = |[i, k]: [usize; 2]| matrix.cells.get(i).and_then(|row| *row.get(k)?);
    let [of_rows, of_columns] = &matrix.factors;
    let (condition, other, along, names) = match matrix.least_of {
        LeastOf::All => {
            let place = *matrix.least.first()?;
            let value = fixed(number(place)?, 3);
            let (row, column) = (&matrix.rows[place[0]], &matrix.columns[place[1]]);
            return Some(format!(
                "Least, {value} {unit}, with {of_rows} {row} and {of_columns} {column}."
            ));
        }
        LeastOf::Row => (of_rows, of_columns, 0, (&matrix.rows, &matrix.columns)),
        LeastOf::Column => (of_columns, of_rows, 1, (&matrix.columns, &matrix.rows)),
    };
    let (conditions, choices) = names;
    let by_choice = |choice: usize| -> Vec<&str> {
        let own = matrix
            .least
            .iter()
            .filter(|place| place[1 - along] == choice);
        own.map(|place| conditions[place[along]].as_str()).collect()
    };
    let chosen = (0..choices.len()).map(|choice| (choice, by_choice(choice)));
    let chosen: Vec<(usize, Vec<&str>)> = chosen.filter(|(_, at)| !at.is_empty()).collect();
    if let [(choice, at)] = chosen.as_slice() {
        let choice = &choices[*choice];
        let every = match at.len() == conditions.len() {
            true => format!("at every {condition}"),
            false => format!("at {condition} {}", at.join(", ")),
        };
        let values = matrix.least.iter().filter_map(|place| number(*place));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let [low, high] = [low, high].map(|x| fixed(x, 3));
        return Some(format!(
            "Least with {other} {choice} {every}: {low} to {high} {unit}."
        ));
    }
    let part =
        |(choice, at): &(usize, Vec<&str>)| format!("{} at {}", choices[*choice], at.join(", "));
    let parts: Vec<String> = chosen.iter().map(part).collect();
    (!parts.is_empty()).then(|| format!("Least by {condition}: {}.", parts.join("; ")))
}

/// Width of the interval of a share from which on it says next to nothing.
const WIDE: f64 = 0.5;

/// Which factor is worth a test, and what it would leave of the spread; that none is above chance where none is.
fn worth_knowing(of: &Information, unit: &str) -> Option<String> {
    let causes: Vec<&KnownFactor> = of.causes().collect();
    let share = |factor: &KnownFactor| fixed(100.0 * factor.share.value, 0);
    let Some(first) = causes.first() else {
        let largest = of.factors.first().filter(|factor| factor.share.value > 0.0);
        let largest = largest.map_or_else(String::new, |factor| {
            format!(
                ": the largest share of the variance, {} % of {}, is what chance gives",
                share(factor),
                factor.name
            )
        });
        let needed = of.draws_needed().map_or_else(String::new, |n| {
            let round = 10f64.powf(n.log10().floor());
            format!(
                "; about {} draws would tell",
                plain((n / round).ceil() * round)
            )
        });
        let n = of.n;
        return Some(format!(
            "No single factor is above chance in {n} draws{largest}{needed}."
        ));
    };
    if let Some([low, high]) = first.share.interval.filter(|[low, high]| high - low > WIDE) {
        let [low, high] = [low, high].map(|x| fixed(100.0 * x, 0));
        let (n, name) = (of.n, &first.name);
        return Some(format!(
            "{n} samples are too few to say what knowing {name} would leave: its share of the variance is {low} to {high} %."
        ));
    }
    let digits = decimals([0.0, of.sd]) + 1;
    let [sd, left] = [of.sd, first.sd_left.value].map(|x| fixed(x, digits));
    let (name, test) = (&first.name, &first.test);
    let test = match test.is_empty() {
        true => String::new(),
        false => format!("; the next test: {test}"),
    };
    let rival = causes
        .get(1)
        .filter(|second| !is_settled(first, second, of.noise));
    let rival = rival.map_or_else(String::new, |second| {
        format!(
            " {name} and {}: which of them counts more is not settled.",
            second.name
        )
    });
    Some(format!(
        "If {name} were known, the deviation would fall from {sd} to {left} {unit}{test}.{rival}"
    ))
}

/// Whether the order of two factors is known: intervals that do not overlap, or shares further apart than chance makes them.
fn is_settled(first: &KnownFactor, second: &KnownFactor, noise: f64) -> bool {
    match (first.share.interval, second.share.interval) {
        (Some([low, _]), Some([_, high])) => low > high,
        _ => first.share.value - second.share.value > noise,
    }
}

/// The difference at the coldest and the warmest ambient temperature, for each start.
fn of_climates(matrix: &Matrix) -> Vec<String> {
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
            let [cold, warm] = [cold, warm].map(|(k, degc)| {
                let excess = signed(numbers.get(k).copied(), 1);
                format!("{excess} % at {} degC", plain(*degc))
            });
            format!("{cold} and {warm} (start {start})")
        };
        let starts: Vec<String> = matrix.starts.iter().zip(by_start).map(start).collect();
        let starts = starts.join("; ");
        list.push(format!("Fuel of {subject} over {baseline}: {starts}."));
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
    let said = published(subject, &base.cycle)
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
    use crate::statistics::{Estimate, TornadoInput, tornado};

    fn factor(
        name: &str,
        share: f64,
        interval: Option<[f64; 2]>,
        above_chance: bool,
    ) -> KnownFactor {
        let estimate = |value| Estimate {
            value,
            interval: None,
        };
        KnownFactor {
            name: name.to_owned(),
            test: String::new(),
            share: Estimate {
                value: share,
                interval,
            },
            sd_left: estimate(3.0 * (1.0 - share).sqrt()),
            above_chance,
        }
    }

    fn information(noise: f64, factors: Vec<KnownFactor>) -> Information {
        Information {
            n: 256,
            sd: 3.0,
            noise,
            factors,
        }
    }

    /// By hand: 3 sqrt(1 - 0.64) = 1.8.
    #[test]
    fn a_test_is_named_only_where_a_factor_above_chance() {
        let say = |of: &Information| worth_knowing(of, "points").unwrap();
        let mut gears = factor("gear set", 0.64, None, true);
        let alone = information(0.06, vec![gears.clone(), factor("pump", 0.05, None, false)]);
        let text = say(&alone);
        assert_eq!(
            text,
            "If gear set were known, the deviation would fall from 3.0 to 1.8 points."
        );
        "read them off a box".clone_into(&mut gears.test);
        let text = say(&information(0.06, vec![gears]));
        assert!(
            text.ends_with("1.8 points; the next test: read them off a box."),
            "{text}"
        );
        let quiet = information(0.06, vec![factor("pump", 0.03, None, false)]);
        let text = say(&quiet);
        assert!(
            !text.contains("were known")
                && text.starts_with("No single factor is above chance in 256 draws"),
            "{text}"
        );
        // 256 (0.06 / 0.03)^(4/3) = 645.
        assert!(text.ends_with("; about 700 draws would tell."), "{text}");
        let nothing = information(0.06, vec![factor("pump", -0.01, None, false)]);
        assert_eq!(
            say(&nothing),
            "No single factor is above chance in 256 draws."
        );
    }

    #[test]
    fn an_order_that_is_not_settled_is_said_to_be_open() {
        let text = |a, b| worth_knowing(&information(0.06, vec![a, b]), "points").unwrap();
        let unsettled = "which of them counts more is not settled";
        let near = text(factor("a", 0.3, None, true), factor("b", 0.27, None, true));
        assert!(near.contains(unsettled), "{near}");
        let far = text(factor("a", 0.3, None, true), factor("b", 0.1, None, true));
        assert!(!far.contains(unsettled), "{far}");
        let overlap = text(
            factor("a", 0.3, Some([0.2, 0.4]), true),
            factor("b", 0.25, Some([0.1, 0.3]), true),
        );
        assert!(overlap.contains(unsettled), "{overlap}");
        let apart = text(
            factor("a", 0.3, Some([0.25, 0.4]), true),
            factor("b", 0.1, Some([0.05, 0.2]), true),
        );
        assert!(!apart.contains(unsettled), "{apart}");
        let wide = text(
            factor("a", 0.9, Some([0.3, 1.5]), true),
            factor("b", 0.0, None, false),
        );
        assert_eq!(
            wide,
            "256 samples are too few to say what knowing a would leave: its share of the variance is 30 to 150 %."
        );
    }

    fn matrix(cells: [[f64; 2]; 2], least_of: LeastOf, least: &[[usize; 2]]) -> GridMatrix {
        let words = |list: [&str; 2]| list.map(str::to_owned);
        GridMatrix {
            factors: words(["ambient", "oil"]),
            rows: words(["-30 \u{b0}C", "40 \u{b0}C"]).to_vec(),
            columns: words(["thick", "thin"]).to_vec(),
            cells: cells.map(|row| row.map(Some).to_vec()).to_vec(),
            least_of,
            least: least.to_vec(),
        }
    }

    #[test]
    fn the_least_is_found_by_condition() {
        let always = matrix([[0.4, -0.5], [0.1, 0.0]], LeastOf::Row, &[[0, 1], [1, 1]]);
        assert_eq!(
            least(&always, "%").unwrap(),
            "Least with oil thin at every ambient: -0.500 to 0.000 %."
        );
        let changing = matrix([[0.4, -0.5], [0.1, 0.3]], LeastOf::Row, &[[0, 1], [1, 0]]);
        assert_eq!(
            least(&changing, "%").unwrap(),
            "Least by ambient: thick at 40 \u{b0}C; thin at -30 \u{b0}C."
        );
        // A row without numbers has no least: then it is not every one.
        let gap = matrix([[0.4, -0.5], [f64::NAN, f64::NAN]], LeastOf::Row, &[[0, 1]]);
        assert!(least(&gap, "%").unwrap().contains("at ambient -30 \u{b0}C"));
        let one = matrix([[0.4, -0.5], [0.1, 0.3]], LeastOf::All, &[[0, 1]]);
        assert_eq!(
            least(&one, "%").unwrap(),
            "Least, -0.500 %, with ambient -30 \u{b0}C and oil thin."
        );
        assert_eq!(least(&matrix([[0.0; 2]; 2], LeastOf::All, &[]), "%"), None);
    }

    #[test]
    fn ends_need_draws_that_reach_them() {
        let usual = Confidence::default();
        let draws = |n: usize| (0..n).map(|k| k as f64).collect::<Vec<_>>();
        let text = |n: usize| middle(&Summary::of(&draws(n), usual), usual, "%").0;
        assert_eq!(
            text(71),
            "the least and the largest of 71 draws are 0 to +70 %"
        );
        assert_eq!(
            text(101),
            "90 % of the draws are +5 to +95 %, the median is +50 %"
        );
        let wide = Confidence::of(0.99);
        let text = middle(&Summary::of(&draws(101), wide), wide, "%").0;
        assert!(
            text.starts_with("the least and the largest of 101 draws"),
            "{text}"
        );
    }

    #[test]
    fn a_factor_that_moves_nothing_is_not_named() {
        let input = |levels: &[(&str, f64)]| TornadoInput {
            name: "oil".to_owned(),
            entries: levels.iter().map(|(l, y)| ((*l).to_owned(), *y)).collect(),
        };
        let moved = tornado(7.0, &[input(&[("a", 7.2), ("b", 7.0), ("c", 6.9)])]);
        assert_eq!(
            largest_swing(&moved, "L/100 km").unwrap(),
            "oil by itself moves it most, over 0.30 L/100 km (+0.20 with a, -0.10 with c)."
        );
        assert_eq!(
            largest_swing(&tornado(7.0, &[input(&[("a", 7.0)])]), ""),
            None
        );
        assert_eq!(
            largest_swing(&tornado(f64::NAN, &[input(&[("a", 7.0)])]), ""),
            None
        );
    }
}
