//! The values of one row of belt points.

use cvtcycle_config::csv::{Collector, Row};
use cvtcycle_config::{Bound, Problem, did_you_mean};
use cvtcycle_model::lubricant::FRICTION;
use cvtcycle_model::transmission::cvt::variator::{BELT, Formulation, VARIATOR};

/// A number that a row gives: name, unit, and range in that unit.
pub type Number = (&'static str, &'static str, Bound);

pub const RATIO: usize = 0;
pub const SPEED: usize = 1;
pub const PRESSURE: usize = 2;
pub const TORQUE: usize = 3;
pub const PULLEY_ANGLE: usize = 4;
pub const WEDGE_ANGLE: usize = 5;
pub const BAND_OFFSET: usize = 6;
pub const BAND_FRICTION: usize = 7;
pub const SEGMENT_FRICTION: usize = 8;
pub const BAND_COUNT: usize = 9;
pub const ON_STOP: usize = 10;
pub const BELT_TEMP: usize = 11;
/// The first of these must be given in each row.
pub const REQUIRED: usize = 4;

const HALF_ANGLE: Bound = VARIATOR.half_wedge_deg.range();

/// Numbers that are read, in the order of the output. Their ranges keep out what is a slip of the pen or has no solution;
/// what is merely outside the vehicle's or the model's validity is computed and flagged.
/// What a vehicle or a lubricant has a key for has the range of that key; the friction of the bands is that at the point's temperature and
/// sliding speed, not the key's at 85 degC.
pub const NUMBERS: [Number; 12] = [
    // What the belt can run at is the model's to say.
    ("ratio", "", Bound::any()),
    ("input_speed_rpm", "rpm", Bound::closed(0.0, 100_000.0)),
    (
        "secondary_pressure_bar",
        "bar",
        Bound::closed(0.0, 10_000.0),
    ),
    (
        "output_torque_nm",
        "Nm",
        Bound::closed(-100_000.0, 100_000.0),
    ),
    ("pulley_half_angle_deg", "degrees", HALF_ANGLE),
    ("wedge_half_angle_deg", "degrees", HALF_ANGLE),
    (BELT.band_offset_mm.name, "mm", BELT.band_offset_mm.range()),
    ("band_friction", "", Bound::closed(0.0, 0.5)),
    ("segment_friction", "", FRICTION.segment.range()),
    ("band_count", "", BELT.band_count.range()),
    ("primary_on_stop", "", Bound::closed(0.0, 1.0)),
    ("belt_temp_degc", "degC", Bound::closed(-60.0, 200.0)),
];

/// Index of the column `case` in the schema.
pub const CASE_INDEX: usize = NUMBERS.len();
/// Index of the column `formulation` in the schema.
pub const FORMULATION_INDEX: usize = CASE_INDEX + 1;

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
