//! The columns of belt points: what is read and what is computed.

use std::sync::LazyLock;

use cvtcycle_config::Bound;
use cvtcycle_config::csv::{Cells, Column, Schema};
use cvtcycle_output::columns;
use cvtcycle_output::table::{self, Cell};

use super::model::Solved;

/// A number that a row gives: name, unit, and range in that unit.
type Number = (&'static str, &'static str, Bound);

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

/// Numbers that are read, in the order of the output. Their ranges keep out what is a slip of the pen or has no solution;
/// what is merely outside the vehicle's or the model's validity is computed and flagged.
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
    ("pulley_half_angle_deg", "degrees", Bound::closed(1.0, 45.0)),
    ("wedge_half_angle_deg", "degrees", Bound::closed(1.0, 45.0)),
    ("band_offset_mm", "mm", Bound::closed(0.0, 50.0)),
    ("band_friction", "", Bound::closed(0.0, 0.5)),
    ("segment_friction", "", Bound::closed(0.01, 1.0)),
    ("band_count", "", Bound::closed(1.0, 100.0)),
    ("primary_on_stop", "", Bound::closed(0.0, 1.0)),
    ("belt_temp_degc", "degC", Bound::closed(-60.0, 200.0)),
];

/// Name of the column that is passed through.
pub const CASE: &str = "case";
/// Name of the column of the belt model's reading.
pub const FORMULATION: &str = "formulation";
/// Name of the column that says how a point was solved.
pub const STATUS: &str = "status";
/// Name of the column of what a point departs from.
pub const FLAGS: &str = "flags";

/// A solved point and its `case`.
pub type Point = (String, Solved);

/// Computed columns, in the order of the output.
pub static OUTPUTS: LazyLock<Vec<table::Column<Point>>> = LazyLock::new(|| {
    columns! { Point;
        number "primary_radius_m", "m", "", (_, s) => s.point.geometry.primary_radius_m;
        number "secondary_radius_m", "m", "", (_, s) => s.point.geometry.secondary_radius_m;
        number "primary_wrap_rad", "rad", "", (_, s) => s.point.geometry.primary_wrap_rad;
        number "secondary_wrap_rad", "rad", "", (_, s) => s.point.geometry.secondary_wrap_rad;
        number "strut_length_m", "m", "", (_, s) => s.point.geometry.strut_m;
        number "belt_speed_m_s", "m/s", "", (_, s) => s.point.belt_speed_m_s;
        number "primary_clamp_n", "N", "", (_, s) => s.point.tension.primary_clamp_n;
        number "secondary_clamp_n", "N", "", (_, s) => s.point.tension.secondary_clamp_n;
        number "primary_shoulder_force_n", "N", "", (_, s) => s.point.tension.primary_shoulder_n;
        number "secondary_shoulder_force_n", "N", "", (_, s) => s.point.tension.secondary_shoulder_n;
        number "band_tension_1_n", "N", "", (_, s) => s.point.band_tension_n[0];
        number "band_tension_2_n", "N", "", (_, s) => s.point.band_tension_n[1];
        number "band_tension_step_n", "N", "", (_, s) => s.point.tension.step_n;
        number "segment_compression_n", "N", "", (_, s) => s.point.tension.compression_n;
        number "band_1_travel_m_per_rev", "m", "", (_, s) => s.point.band_travel_m[0];
        number "band_i_travel_m_per_rev", "m", "", (_, s) => s.point.band_travel_m[1];
        number "band_loss_primary_nm", "Nm", "", (_, s) => s.point.band_loss_nm[0] + s.point.film_loss_nm[0];
        number "band_loss_secondary_nm", "Nm", "", (_, s) => s.point.band_loss_nm[1] + s.point.film_loss_nm[1];
        number "active_segments", "", "", (_, s) => s.point.active_segments;
        number "gap_slip_m_s", "m/s", "", (_, s) => s.point.gap_slip_m_s;
        number "idle_slip_m_s", "m/s", "", (_, s) => s.point.idle_slip_m_s;
        number "primary_slip_m_s", "m/s", "", (_, s) => s.point.slip_m_s[0];
        number "secondary_slip_m_s", "m/s", "", (_, s) => s.point.slip_m_s[1];
        number "slip_percent", "%", "", (_, s) => 100.0 * s.point.slip_total;
        number "slip_loss_primary_nm", "Nm", "", (_, s) => s.point.slip_loss_nm[0];
        number "slip_loss_secondary_nm", "Nm", "", (_, s) => s.point.slip_loss_nm[1];
        number "wedge_loss_primary_nm", "Nm", "", (_, s) => s.point.wedge_loss_nm[0];
        number "wedge_loss_secondary_nm", "Nm", "", (_, s) => s.point.wedge_loss_nm[1];
        number "penetration_loss_primary_nm", "Nm", "", (_, s) => s.point.penetration_loss_nm[0];
        number "penetration_loss_secondary_nm", "Nm", "", (_, s) => s.point.penetration_loss_nm[1];
        number "belt_loss_nm", "Nm", "", (_, s) => s.point.loss_nm;
        text STATUS, "", "", (_, s) => s.point.status.name();
        words FLAGS, "", "", (_, s) => Cell::Names(s.flags.names().collect());
    }
});

/// The columns of the output, in their order: what was read, then [`OUTPUTS`].
#[must_use]
pub fn output_columns(with_case: bool) -> Vec<table::Column<Point>> {
    let mut list = columns! { Point;
        text CASE, "", "", (case, _) => case.clone();
        text FORMULATION, "", "", (_, s) => s.formulation.name();
    };
    if !with_case {
        list.remove(0);
    }
    list.extend(NUMBERS.iter().enumerate().map(|(k, (name, unit, _))| {
        table::Column::number(*name, unit, "", move |(_, s): &Point| s.numbers[k])
    }));
    list.extend(OUTPUTS.iter().cloned());
    list
}

/// The columns of a table of points: the numbers in their order, then `case`, `formulation` and what is computed.
pub fn schema() -> Schema {
    let number = |(place, (name, _, range)): (usize, Number)| {
        let column = match place {
            BAND_COUNT => Column::new(name, Cells::Whole(range)),
            ON_STOP => Column::new(name, Cells::Whole(range))
                .allowed("1 (no deflection), 0 (full deflection) or nothing"),
            _ => Column::number(name, range),
        };
        match place {
            0..REQUIRED => column.required(),
            _ => column.or_empty(),
        }
    };
    let word = |name| Column::new(name, Cells::Word).or_empty();
    let computed = computed().map(|name| Column::new(name, Cells::Ignored));
    Schema {
        columns: (NUMBERS.into_iter().enumerate().map(number))
            .chain([word(CASE), word(FORMULATION)])
            .chain(computed)
            .collect(),
        ..Schema::default()
    }
}

/// Index of the column `case` in the schema.
pub const CASE_INDEX: usize = NUMBERS.len();
/// Index of the column `formulation` in the schema.
pub const FORMULATION_INDEX: usize = CASE_INDEX + 1;

fn computed() -> impl Iterator<Item = &'static str> {
    OUTPUTS.iter().map(|column| &*column.name)
}
