//! Results in sentences, for the terminal and for documents. A sentence is made only where it is true; a number has the digits that its
//! interval leaves it.

mod effects;
pub mod intervals;
pub mod run;
pub mod study;

use cvtcycle_output::fleet_spread::FleetRange;
use cvtcycle_output::number::{fixed, signed};
use cvtcycle_output::summary::RunSummary;

/// Decimals of a number between two ends: to the first digit of half their distance.
pub fn decimals([low, high]: [f64; 2]) -> usize {
    let half = 0.5 * (high - low).abs();
    match half > 0.0 && half.is_finite() {
        true => (-half.log10().floor()).clamp(0.0, 3.0) as usize,
        false => 1,
    }
}

/// "6 % more", by the sign of a difference; "as much" where its digits are zero.
pub fn more_or_less(percent: f64, decimals: usize) -> String {
    let size = fixed(percent.abs(), decimals);
    match size.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        true if percent < 0.0 => format!("{size} % less"),
        true => format!("{size} % more"),
        false => "as much".to_owned(),
    }
}

/// "than" or "as", after [`more_or_less`].
pub fn than(compared: &str) -> &'static str {
    match compared {
        "as much" => "as",
        _ => "than",
    }
}

/// " (90 % range 6.8 to 8.2, by the error of the model on 65 measured cars)": fuel.
#[must_use]
pub fn of_cars(range: &FleetRange) -> String {
    let [low, high] = range.ends.map(|end| fixed(end, 1));
    let cars = range.cars;
    format!(" (90 % range {low} to {high}, by the error of the model on {cars} measured cars)")
}

/// " (90 % range 6.8 to 8.2, by the error of the model on 65 measured cars; uncertain inputs alone 7.0 to 7.6)": the ranges that are known of a fuel, that
/// of measured cars first; empty without one.
#[must_use]
pub fn fuel_ranges(run: &RunSummary) -> String {
    let inputs = run.drawn.map(|[low, _, high]| {
        let digits = decimals([low, high]);
        let [low, high] = [low, high].map(|end| fixed(end, digits));
        format!("{low} to {high}")
    });
    match (&run.fleet, inputs) {
        (Some(fleet), None) => of_cars(fleet),
        (Some(fleet), Some(inputs)) => {
            let range = of_cars(fleet);
            let range = range.trim_end_matches(')');
            format!("{range}; uncertain inputs alone {inputs})")
        }
        (None, Some(inputs)) => format!(" (uncertain inputs alone, 90 %: {inputs})"),
        (None, None) => String::new(),
    }
}

/// "90 % range -6 to +10 %, by the error of the model on 28 measured cars": a difference.
#[must_use]
pub fn difference_of_cars(range: &FleetRange) -> String {
    let (ends, cars) = (between(range.ends, "%"), range.cars);
    format!("90 % range {ends}, by the error of the model on {cars} measured cars")
}

/// "-1 to +9 %".
pub fn between(ends: [f64; 2], unit: &str) -> String {
    ends_in(ends, decimals(ends), (unit, signed))
}

/// How a number is written with so many decimals: a difference with its sign, an output without.
type Written = fn(f64, usize) -> String;

fn ends_in([low, high]: [f64; 2], decimals: usize, (unit, written): (&str, Written)) -> String {
    let [low, high] = [low, high].map(|x| written(x, decimals));
    format!("{low} to {high} {unit}")
}

/// "13.3 % less than the baseline in a phase".
fn of_difference(percent: f64, baseline: &str, phase: Option<&str>) -> String {
    let compared = more_or_less(percent, 1);
    let phase = phase.map_or_else(String::new, |phase| format!(" in {phase}"));
    format!("{compared} {} {baseline}{phase}", than(&compared))
}

/// A computed number and the published one that it contradicts.
fn against_print(computed: &str, printed: &str, condition: &str, row: &str) -> String {
    format!(
        "Contradicted by a published number: computed {computed}, published \"{printed}\" ({condition}; row {row} of `cvtcycle validate`)."
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_end_where_the_interval_begins() {
        for (ends, digits) in [
            ([-1.0, 9.0], 0),
            ([5.1, 6.3], 1),
            ([5.12, 5.16], 2),
            ([-1e-9, 1e-9], 3),
            ([0.0, 4000.0], 0),
            ([2.0, 2.0], 1),
        ] {
            assert_eq!(decimals(ends), digits, "{ends:?}");
        }
        assert_eq!(between([-1.2, 9.1], "%"), "-1 to +9 %");
        assert_eq!(between([5.11, 6.34], "%"), "+5.1 to +6.3 %");
        assert_eq!(more_or_less(6.2, 0), "6 % more");
        assert_eq!(more_or_less(-11.26, 1), "11.3 % less");
        assert_eq!(
            (more_or_less(-0.04, 1).as_str(), than("as much")),
            ("as much", "as")
        );
    }
}
