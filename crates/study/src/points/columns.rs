//! The columns of belt points: what is read, what is computed, and the line of their names.

use std::sync::LazyLock;

use cvtcycle_config::cycle::problems::{Collector, Complaint, Line};
use cvtcycle_config::cycle::text::Field;
use cvtcycle_config::{Bound, near};
use cvtcycle_output::columns;
use cvtcycle_output::table::{self, Cell};

use super::model::{Solved, name};

/// A number that a row gives.
#[derive(Debug)]
pub struct Number {
    pub name: &'static str,
    pub allowed: Bound,
    pub unit: &'static str,
    pub whole: bool,
}

impl Number {
    const fn new(name: &'static str, allowed: Bound, unit: &'static str) -> Self {
        Number {
            name,
            allowed,
            unit,
            whole: false,
        }
    }
}

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
    Number::new("ratio", Bound::any(), ""),
    Number::new("input_speed_rpm", Bound::closed(0.0, 100_000.0), "rpm"),
    Number::new(
        "secondary_pressure_bar",
        Bound::closed(0.0, 10_000.0),
        "bar",
    ),
    Number::new(
        "output_torque_nm",
        Bound::closed(-100_000.0, 100_000.0),
        "Nm",
    ),
    Number::new("pulley_half_angle_deg", Bound::closed(1.0, 45.0), "degrees"),
    Number::new("wedge_half_angle_deg", Bound::closed(1.0, 45.0), "degrees"),
    Number::new("band_offset_mm", Bound::closed(0.0, 50.0), "mm"),
    Number::new("band_friction", Bound::closed(0.0, 0.5), ""),
    Number::new("segment_friction", Bound::closed(0.01, 1.0), ""),
    Number {
        name: "band_count",
        allowed: Bound::closed(1.0, 100.0),
        unit: "",
        whole: true,
    },
    Number {
        name: "primary_on_stop",
        allowed: Bound::closed(0.0, 1.0),
        unit: "",
        whole: true,
    },
    Number::new("belt_temp_degc", Bound::closed(-60.0, 200.0), "degC"),
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
        text FORMULATION, "", "", (_, s) => name(s.formulation);
    };
    if !with_case {
        list.remove(0);
    }
    list.extend(NUMBERS.iter().enumerate().map(|(k, number)| {
        table::Column::number(number.name, number.unit, "", move |(_, s): &Point| {
            s.numbers[k]
        })
    }));
    list.extend(OUTPUTS.iter().cloned());
    list
}

/// What a column of the input says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    Case,
    Formulation,
    /// Place in [`NUMBERS`].
    Number(usize),
    /// A column that this command computes.
    Output(&'static str),
}

impl Column {
    fn of(name: &str) -> Option<Self> {
        if name == CASE {
            return Some(Column::Case);
        }
        if name == FORMULATION {
            return Some(Column::Formulation);
        }
        if let Some(place) = NUMBERS.iter().position(|number| number.name == name) {
            return Some(Column::Number(place));
        }
        computed().find(|known| *known == name).map(Column::Output)
    }

    pub fn name(self) -> &'static str {
        match self {
            Column::Case => CASE,
            Column::Formulation => FORMULATION,
            Column::Number(place) => NUMBERS[place].name,
            Column::Output(name) => name,
        }
    }
}

fn computed() -> impl Iterator<Item = &'static str> {
    OUTPUTS.iter().map(|column| &*column.name)
}

fn read() -> impl Iterator<Item = &'static str> {
    [CASE, FORMULATION]
        .into_iter()
        .chain(NUMBERS.iter().map(|number| number.name))
}

/// The columns of a file, in its order; `None` for one that is not known.
#[derive(Debug)]
pub struct Header {
    pub columns: Vec<Option<Column>>,
}

impl Header {
    /// Reads the column names. `None` where the rest of the file cannot be understood without them.
    pub fn read(line: Line<'_>, problems: &mut Collector<'_>) -> Option<Self> {
        if line.text.contains('\r') {
            let message = "the lines end with a carriage return alone";
            problems.file(Complaint::new(
                message,
                "lines that end with LF or CR LF",
                "save it with the line ends of today",
            ));
            return None;
        }
        let fields = problems.names(line)?;
        if fields.iter().all(|field| field.text.parse::<f64>().is_ok()) {
            let hint = "put the names above the numbers: ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm";
            problems.line(line, "", || {
                Complaint::new("the first line has numbers and no column names", "", hint)
            });
            return None;
        }
        let mut header = Header {
            columns: Vec::with_capacity(fields.len()),
        };
        for field in fields {
            let column = header.column(line, field, problems);
            header.columns.push(column);
        }
        for number in NUMBERS
            .iter()
            .take(REQUIRED)
            .filter(|number| !header.names().any(|name| name == number.name))
        {
            problems.line(line, number.name, || {
                let allowed = NUMBERS
                    .iter()
                    .take(REQUIRED)
                    .map(|number| number.name)
                    .collect::<Vec<_>>()
                    .join(", ");
                Complaint::new(
                    format!("the column {} is missing", number.name),
                    allowed,
                    "add it; the unit is in the name",
                )
            });
        }
        Some(header)
    }

    fn column(
        &self,
        line: Line<'_>,
        field: Field<'_>,
        problems: &mut Collector<'_>,
    ) -> Option<Column> {
        let Some(column) = Column::of(field.text) else {
            problems.value(line, field, field.text, || unknown(field.text));
            return None;
        };
        if self.columns.contains(&Some(column)) {
            let twice = || {
                Complaint::new(
                    "this column stands here twice",
                    "each column once",
                    "remove one of them",
                )
            };
            problems.value(line, field, column.name(), twice);
        }
        Some(column)
    }

    fn names(&self) -> impl Iterator<Item = &'static str> {
        self.columns.iter().flatten().map(|column| column.name())
    }

    pub fn has(&self, column: Column) -> bool {
        self.columns.contains(&Some(column))
    }

    /// Columns of the input that are computed and not read.
    pub fn ignored(&self) -> Vec<&'static str> {
        self.columns
            .iter()
            .flatten()
            .filter(|column| matches!(column, Column::Output(_)))
            .map(|column| column.name())
            .collect()
    }
}

fn unknown(name: &str) -> Complaint {
    if name.is_empty() {
        return Complaint::new(
            "this column has no name",
            "",
            "remove the comma or name the column",
        );
    }
    let names = near(name, read());
    let hint = if names.is_empty() {
        "remove it or rename it".to_owned()
    } else {
        format!("did you mean {}?", names.join(" or "))
    };
    Complaint::new(
        "there is no such column",
        read().collect::<Vec<_>>().join(", "),
        hint,
    )
}
