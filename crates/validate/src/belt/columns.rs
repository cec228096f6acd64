//! The columns of belt points: what is read and what is computed.

use std::sync::LazyLock;

use super::model::Solved;
use super::rows::{BAND_COUNT, NUMBERS, Number, ON_STOP, REQUIRED};
use cvtcycle_config::csv::{Cells, Column, Schema};
use cvtcycle_output::columns;
use cvtcycle_output::table::{self, Cell};

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

fn computed() -> impl Iterator<Item = &'static str> {
    OUTPUTS.iter().map(|column| &*column.name)
}
