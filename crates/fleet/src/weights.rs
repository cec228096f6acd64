//! Sensitivity of the fuel to each number of a car, over its usual uncertainty.
//!
//! | label | statement | status |
//! |---|---|---|
//! | NW-1 | w = 100 (F_1 - F_2)/(2 F), F_1 and F_2 the fuel with a number larger and smaller by its usual uncertainty; where only one of the two is a car, 100 (F_1 - F)/F | definition |
//! | NW-2 | uncertainty of a number: mass 2 %, f0 5 %, f1 20 %, f2 3 %, N/V, final drive and wheel 1 %, power 3 %, torque 3 %, idle 5 %, highest speed 3 %, ratios of the belt 2 %, centre distance 1 %, pump 15 %, oil 10 %, displacement 1 %; year of the engine 3 years | ASSUMED: what two sources of one car differ by; half to twice |
//! | NW-3 | what the coefficients of the road load are of: half of the difference of `body` and `neutral` | as NW-2 |

use cvtcycle_config::procedure::Procedure;
use cvtcycle_config::setup::Setup;
use cvtcycle_config::setup::new_car::{Answers, param_set};
use rayon::prelude::*;

use crate::driven::figures;

/// Usual uncertainty of a number, per cent (NW-2).
const UNCERTAIN: [(&str, f64); 17] = [
    ("mass", 2.0),
    ("f0", 5.0),
    ("f1", 20.0),
    ("f2", 3.0),
    ("n-over-v", 1.0),
    ("final-drive", 1.0),
    ("wheel-radius", 1.0),
    ("power", 3.0),
    ("torque", 3.0),
    ("idle", 5.0),
    ("highest", 3.0),
    ("ratio-low", 2.0),
    ("ratio-high", 2.0),
    ("centre-distance", 1.0),
    ("pump", 15.0),
    ("oil", 10.0),
    ("displacement", 1.0),
];
/// Uncertainty of the year of an engine (NW-2).
const YEARS: i32 = 3;

/// How much a number of a car matters.
#[derive(Clone, Debug, PartialEq)]
pub struct Weight {
    /// Name of the number, that of the option of `new`.
    pub name: &'static str,
    /// By how much it was changed, in words.
    pub by: String,
    /// Change of the fuel with a larger number, per cent (NW-1); of words the size alone.
    pub fuel_percent: f64,
}

/// The fuel of a test, L/100 km, and how much each number that is given matters, the largest first. `None` of a car that cannot be made or driven.
///
/// ```
/// use cvtcycle_config::procedure::Procedure;
/// use cvtcycle_config::setup::new_car::Answers;
/// let mut answers = Answers::default();
/// answers.add_file("mine", "mass = 1300\ndisplacement = \"1.8l\"\npower = \"104kW\"")?;
/// let (fuel, weights) = cvtcycle_fleet::weights::weights(&answers, &Procedure::open("ftp75")?).expect("a car");
/// assert!(fuel > 3.0);
/// assert!(weights.iter().any(|weight| weight.name == "mass" && weight.fuel_percent > 0.0));
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
#[must_use]
pub fn weights(answers: &Answers, test: &Procedure) -> Option<(f64, Vec<Weight>)> {
    let fuel_of = |answers: &Answers| {
        let params = test.load(&param_set(answers, &[]).ok()?).ok()?;
        let found = figures(&Setup::from_params(&params), test, 1.0);
        let whole = test
            .results
            .iter()
            .find(|result| result.phases.is_empty())?;
        let fuel = found.fuel.get(&whole.column()).copied()?;
        fuel.is_finite().then_some(fuel)
    };
    let fuel = fuel_of(answers)?;
    let mut weights: Vec<Weight> = changes(answers)
        .into_par_iter()
        .filter_map(|change| {
            let [more, less] = change.cars.map(|car| car.and_then(|car| fuel_of(&car)));
            let change_percent = 100.0
                * match (more, less) {
                    (Some(more), Some(less)) => (more - less) / (2.0 * fuel), // NW-1
                    (Some(more), None) => (more - fuel) / fuel,
                    (None, Some(less)) => (fuel - less) / fuel,
                    (None, None) => return None,
                };
            Some(Weight {
                name: change.name,
                by: change.by,
                fuel_percent: match change.is_word {
                    true => change_percent.abs(),
                    false => change_percent,
                },
            })
        })
        .collect();
    weights.sort_by(|a, b| b.fuel_percent.abs().total_cmp(&a.fuel_percent.abs()));
    Some((fuel, weights))
}

/// A car with a number larger, and one with it smaller.
struct Change {
    name: &'static str,
    by: String,
    is_word: bool,
    cars: [Option<Answers>; 2],
}

fn changes(answers: &Answers) -> Vec<Change> {
    let with = |name: &'static str, text: String| {
        let mut other = answers.clone();
        other.numbers.insert(name, text);
        other
    };
    let number = |(name, percent): &(&'static str, f64)| {
        let text = answers.numbers.get(name)?;
        let scaled = |sign: f64| Some(with(name, scaled(text, 1.0 + sign * percent / 100.0)?));
        Some(Change {
            name,
            by: format!("{percent} %"),
            is_word: false,
            cars: [scaled(1.0), scaled(-1.0)],
        })
    };
    let mut all: Vec<Change> = UNCERTAIN.iter().filter_map(number).collect();
    if answers.numbers.contains_key("f0") {
        let of = |word: &str| Some(with("road-load", word.to_owned()));
        all.push(Change {
            name: "road-load",
            by: "body or neutral".to_owned(),
            is_word: true,
            cars: [of("body"), of("neutral")], // NW-3
        });
    }
    if let Some(year) = answers
        .engine_year
        .as_ref()
        .and_then(|year| year.trim().parse::<i32>().ok())
    {
        let of = |years: i32| {
            Some(Answers {
                engine_year: Some((year + years).to_string()),
                ..answers.clone()
            })
        };
        all.push(Change {
            name: "engine-year",
            by: format!("{YEARS} years"),
            is_word: false,
            cars: [of(YEARS), of(-YEARS)],
        });
    }
    all
}

/// A text with its first number multiplied: "104kW@6400" to "107.12kW@6400".
fn scaled(text: &str, factor: f64) -> Option<String> {
    let text = text.trim();
    let end = text
        .find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)))
        .unwrap_or(text.len());
    let number: f64 = text.get(..end)?.parse().ok()?;
    Some(format!("{:.6}{}", number * factor, &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_number_is_scaled_and_its_unit_kept() {
        assert_eq!(
            scaled("104kW@6400", 1.5).as_deref(),
            Some("156.000000kW@6400")
        );
        assert_eq!(scaled("-1.5lbf", 2.0).as_deref(), Some("-3.000000lbf"));
        assert_eq!(scaled("kW", 2.0), None);
    }

    /// Properties: twice the uncertainty is near twice the weight; more mass, drag and displacement take more fuel.
    #[test]
    fn weights_have_the_sign_of_what_takes_fuel() {
        let mut answers = Answers::default();
        let text = "mass = 1400\nf0 = 100\nf1 = 0.5\nf2 = 0.035\ndisplacement = \"1.8l\"\npower = \"104kW\"\npump = 9\nbox = \"box_cvt_converter\"";
        assert!(answers.add_file("mine", text).is_ok());
        let test = Procedure::open("ftp75").ok();
        let found = test.and_then(|test| weights(&answers, &test));
        let (_, found) = found.unwrap_or_default();
        let of = |name: &str| {
            let own = found.iter().find(|weight| weight.name == name);
            own.map_or(f64::NAN, |weight| weight.fuel_percent)
        };
        for name in ["mass", "f0", "f1", "f2", "displacement", "pump"] {
            assert!(of(name) > 0.0, "{name}: {}", of(name));
        }
        // A share of the fuel that mass and road load can have at most: all work at the wheels.
        assert!(of("mass") < 2.0 && of("f2") < 1.5, "{found:?}");
        assert!(
            found
                .windows(2)
                .all(|pair| pair[0].fuel_percent.abs() >= pair[1].fuel_percent.abs())
        );
    }
}
