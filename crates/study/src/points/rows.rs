//! The values of one row of belt points.

use cvtcycle_config::csv::{Collector, Row};
use cvtcycle_config::{Problem, did_you_mean};
use cvtcycle_model::transmission::cvt::variator::Formulation;

use super::columns::{CASE_INDEX, FORMULATION_INDEX, NUMBERS, REQUIRED};

/// The values of a row as given; `None` where nothing is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given<'t> {
    pub case: &'t str,
    pub formulation: Option<Formulation>,
    pub numbers: [Option<f64>; NUMBERS.len()],
}

impl<'t> Given<'t> {
    /// The values of a row.
    pub fn read(row: &Row<'_, 't>, problems: &mut Collector<'_>) -> Self {
        Given {
            case: row.word(CASE_INDEX),
            formulation: formulation(row, problems),
            numbers: std::array::from_fn(|place| row.number(place)),
        }
    }

    /// True if the row has all numbers that it must have.
    pub fn is_whole(&self) -> bool {
        self.numbers.iter().take(REQUIRED).all(Option::is_some)
    }

    /// A number that every whole row has.
    pub fn required(&self, place: usize) -> f64 {
        self.numbers[place].unwrap_or(f64::NAN)
    }
}

fn formulation(row: &Row<'_, '_>, problems: &mut Collector<'_>) -> Option<Formulation> {
    let word = row.word(FORMULATION_INDEX);
    let known = Formulation::named(word);
    if known.is_none() && !word.is_empty() {
        let names = Formulation::NAMES.map(|(name, _)| name);
        let problem = Problem::unknown_name("this formulation is not known")
            .allowed(format!("one of {}", names.join(", ")))
            .hint(did_you_mean(word, names).unwrap_or_default());
        row.report(FORMULATION_INDEX, problems, problem);
    }
    known
}
