//! Main cause of an output, in a sentence: the factor that moves it most or is worth knowing, and where it is smallest.

use super::decimals;
use cvtcycle_output::number::{fixed, plain, signed};
use cvtcycle_study::answer::{
    Answer, GridMatrix, Information, KnownFactor, MinimumOver, OutputAnswer,
};
use cvtcycle_study::execute::outputs::EXCESS;
use cvtcycle_study::statistics::Tornado;

/// Describes the main cause of an output, by design.
pub(super) fn decided(output: &OutputAnswer, answer: &Answer) -> Option<String> {
    let unit = match output.output.as_str() {
        EXCESS => "points",
        _ => output.unit.as_str(),
    };
    if let Some(tornado) = &output.tornado {
        return largest_swing(tornado, unit);
    }
    if let Some(matrix) = &output.matrix {
        let words = [least(matrix, &output.unit), open_order(matrix)];
        let words: Vec<String> = words.into_iter().flatten().collect();
        return (!words.is_empty()).then(|| words.join(" "));
    }
    let summary = output.summary.as_ref()?;
    match &output.information {
        Some(information) => worth_knowing(information, unit),
        None if summary.sd > 0.0 => {
            let n = summary.n;
            Some(format!(
                "{n} runs are too few to name a cause of the spread."
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
        MinimumOver::All => {
            let place = *matrix.least.first()?;
            let value = fixed(number(place)?, 3);
            let (row, column) = (&matrix.rows[place[0]], &matrix.columns[place[1]]);
            return Some(format!(
                "Least, {value} {unit}, with {of_rows} {row} and {of_columns} {column}."
            ));
        }
        MinimumOver::Row => (of_rows, of_columns, 0, (&matrix.rows, &matrix.columns)),
        MinimumOver::Column => (of_columns, of_rows, 1, (&matrix.columns, &matrix.rows)),
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

/// Where what is known of the frictions leaves open which number of a matrix is the least.
fn open_order(matrix: &GridMatrix) -> Option<String> {
    if matrix.ends.is_empty() || matrix.least_of == MinimumOver::All {
        return None;
    }
    let by_row = matrix.least_of == MinimumOver::Row;
    let (conditions, condition) = match by_row {
        true => (&matrix.rows, &matrix.factors[0]),
        false => (&matrix.columns, &matrix.factors[1]),
    };
    let choices = match by_row {
        true => matrix.columns.len(),
        false => matrix.rows.len(),
    };
    let ends = |at: usize, choice: usize| {
        let [i, k] = if by_row { [at, choice] } else { [choice, at] };
        *matrix.ends.get(i)?.get(k)?
    };
    let is_open = |at: &usize| {
        let place = matrix
            .least
            .iter()
            .find(|place| place[usize::from(!by_row)] == *at);
        let best = place.map(|place| place[usize::from(by_row)]);
        let Some((best, [_, high])) = best.and_then(|best| Some((best, ends(*at, best)?))) else {
            return false;
        };
        let mut others = (0..choices).filter(|choice| *choice != best);
        others.any(|other| ends(*at, other).is_some_and(|[low, _]| low <= high))
    };
    let open: Vec<&str> = (0..conditions.len())
        .filter(is_open)
        .map(|at| conditions[at].as_str())
        .collect();
    let ranges = "the ranges of what is known of the frictions";
    Some(match (open.len(), conditions.len()) {
        (0, _) => format!("That order holds over {ranges}."),
        (n, all) if n == all => {
            format!("Which one is least is open at every {condition}: {ranges} overlap.")
        }
        _ => format!(
            "At {} {ranges} overlap: which one is least is open there.",
            open.join(", ")
        ),
    })
}

/// Width of the interval of a share from which on it says next to nothing.
const WIDE: f64 = 0.5;

/// Names the factor that is worth a test and the spread that remains; says so if none is above chance.
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
        // Fewer than there are would be no advice.
        let needed = of.draws_needed().filter(|n| *n > 2.0 * of.n as f64);
        let needed = needed.map_or_else(String::new, |n| {
            let round = 10f64.powf(n.log10().floor());
            format!(
                "; about {} runs would tell",
                plain((n / round).ceil() * round)
            )
        });
        let n = of.n;
        return Some(format!(
            "No single factor is above chance in {n} runs{largest}{needed}."
        ));
    };
    if let Some([low, high]) = first.share.interval.filter(|[low, high]| high - low > WIDE) {
        let (n, name) = (of.n, &first.name);
        // The width of an interval falls with the root of the samples.
        let needed = n as f64 * ((high - low) / WIDE).powi(2);
        let round = 10f64.powf(needed.log10().floor());
        let needed = plain((needed / round).ceil() * round);
        let [low, high] = [low, high].map(|x| fixed(100.0 * x.clamp(0.0, 1.0), 0));
        return Some(format!(
            "{n} samples are too few to say what knowing {name} would leave: its share of the variance is {low} to {high} %; about {needed} would tell."
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

/// True if the order of two factors is known: intervals that do not overlap, or shares that differ by more than chance.
fn is_settled(first: &KnownFactor, second: &KnownFactor, noise: f64) -> bool {
    match (first.share.interval, second.share.interval) {
        (Some([low, _]), Some([_, high])) => low > high,
        _ => first.share.value - second.share.value > noise,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cvtcycle_study::statistics::{Estimate, TornadoInput, tornado};

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
                && text.starts_with("No single factor is above chance in 256 runs"),
            "{text}"
        );
        // 256 (0.06 / 0.03)^(4/3) = 645.
        assert!(text.ends_with("; about 700 runs would tell."), "{text}");
        let nothing = information(0.06, vec![factor("pump", -0.01, None, false)]);
        assert_eq!(
            say(&nothing),
            "No single factor is above chance in 256 runs."
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
            "256 samples are too few to say what knowing a would leave: its share of the variance is 30 to 100 %; about 2000 would tell."
        );
    }

    fn matrix(cells: [[f64; 2]; 2], least_of: MinimumOver, least: &[[usize; 2]]) -> GridMatrix {
        let words = |list: [&str; 2]| list.map(str::to_owned);
        GridMatrix {
            factors: words(["ambient", "oil"]),
            rows: words(["-30 \u{b0}C", "40 \u{b0}C"]).to_vec(),
            columns: words(["thick", "thin"]).to_vec(),
            cells: cells.map(|row| row.map(Some).to_vec()).to_vec(),
            least_of,
            least: least.to_vec(),
            ends: Vec::new(),
            pairs: Vec::new(),
        }
    }

    /// Property: the order is open exactly where the range of the least overlaps another one.
    #[test]
    fn an_order_within_its_ranges_is_open() {
        let mut of = matrix(
            [[0.4, -0.5], [0.1, 0.0]],
            MinimumOver::Row,
            &[[0, 1], [1, 1]],
        );
        assert_eq!(open_order(&of), None);
        let range = |x: f64, half: f64| Some([x - half, x + half]);
        of.ends = vec![
            vec![range(0.4, 0.3), range(-0.5, 0.3)],
            vec![range(0.1, 0.3), range(0.0, 0.0)],
        ];
        let words = open_order(&of).unwrap();
        assert!(words.starts_with("At 40 \u{b0}C the ranges"), "{words}");
        of.ends[1][0] = range(0.1, 0.05);
        assert!(open_order(&of).unwrap().starts_with("That order holds"));
        of.ends[0][0] = range(0.4, 2.0);
        of.ends[1][0] = range(0.1, 2.0);
        let words = open_order(&of).unwrap();
        assert!(words.contains("is open at every ambient"), "{words}");
    }

    #[test]
    fn the_least_is_found_by_condition() {
        let always = matrix(
            [[0.4, -0.5], [0.1, 0.0]],
            MinimumOver::Row,
            &[[0, 1], [1, 1]],
        );
        assert_eq!(
            least(&always, "%").unwrap(),
            "Least with oil thin at every ambient: -0.500 to 0.000 %."
        );
        let changing = matrix(
            [[0.4, -0.5], [0.1, 0.3]],
            MinimumOver::Row,
            &[[0, 1], [1, 0]],
        );
        assert_eq!(
            least(&changing, "%").unwrap(),
            "Least by ambient: thick at 40 \u{b0}C; thin at -30 \u{b0}C."
        );
        // A row without numbers has no least: then it is not every one.
        let gap = matrix(
            [[0.4, -0.5], [f64::NAN, f64::NAN]],
            MinimumOver::Row,
            &[[0, 1]],
        );
        assert!(least(&gap, "%").unwrap().contains("at ambient -30 \u{b0}C"));
        let one = matrix([[0.4, -0.5], [0.1, 0.3]], MinimumOver::All, &[[0, 1]]);
        assert_eq!(
            least(&one, "%").unwrap(),
            "Least, -0.500 %, with ambient -30 \u{b0}C and oil thin."
        );
        assert_eq!(
            least(&matrix([[0.0; 2]; 2], MinimumOver::All, &[]), "%"),
            None
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
