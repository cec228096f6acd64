//! Columns of the rig's tests, for CSV and JSON alike. Here SI becomes engineer's units.

use std::io::{self, Write};

use serde_json::{Map, Value as Json};

use cvtcycle_model::bench::transmission::{Moment, Piece, Stage, SteadyPoint, StripDown, TwoBoxes};
use cvtcycle_model::bench::{BenchAnswer, BenchPoint};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_output::columns::Value;
use cvtcycle_output::trace::push_value;
use cvtcycle_output::{Component, Flags};

/// rad/s to rpm.
const RPM: f64 = 30.0 / std::f64::consts::PI;

/// One column of a table.
pub struct Column<T> {
    /// Name in the header, ending in its unit where it has one.
    pub name: String,
    /// Its cell in a row.
    pub get: Box<dyn Fn(&T) -> Value>,
}

impl<T> Column<T> {
    fn new(name: impl Into<String>, get: impl Fn(&T) -> Value + 'static) -> Self {
        Column {
            name: name.into(),
            get: Box::new(get),
        }
    }

    fn number(name: impl Into<String>, get: impl Fn(&T) -> f64 + 'static) -> Self {
        Column::new(name, move |row| Value::Number(get(row)))
    }
}

/// Writes a header and one line per row; an empty field where there is no number.
///
/// # Errors
/// Whatever `out` reports.
pub fn write_csv<T>(out: &mut dyn Write, columns: &[Column<T>], rows: &[T]) -> io::Result<()> {
    let mut writer = csv::Writer::from_writer(out);
    writer.write_record(columns.iter().map(|column| &column.name))?;
    let mut text = String::new();
    for row in rows {
        for column in columns {
            text.clear();
            push_value(&mut text, (column.get)(row), &[]);
            writer.write_field(&text)?;
        }
        writer.write_record(None::<&[u8]>)?;
    }
    writer.flush()
}

/// Rows as JSON objects; `null` where there is no number, a list of names for flags.
#[must_use]
pub fn json_rows<T>(columns: &[Column<T>], rows: &[T]) -> Json {
    let cell = |value: Value| match value {
        Value::Number(x) => serde_json::Number::from_f64(x).map_or(Json::Null, Json::Number),
        Value::Count(n) => Json::from(n),
        Value::Phase(n) => Json::from(n),
        Value::Text(word) => Json::from(word),
        Value::Flags(flags) => Flags::NAMES
            .iter()
            .filter(|(flag, _)| flags.contains(*flag))
            .map(|(_, name)| Json::from(*name))
            .collect(),
    };
    let object = |row: &T| {
        columns
            .iter()
            .map(|column| (column.name.clone(), cell((column.get)(row))))
            .collect::<Map<_, _>>()
    };
    rows.iter().map(|row| Json::Object(object(row))).collect()
}

/// A number that was set, without what converting it there and back has added.
#[must_use]
pub fn clean(x: f64) -> f64 {
    (x * 1e9).round() / 1e9 + 0.0
}

/// Input speed, rpm.
#[must_use]
pub fn rpm(set: &BenchPoint) -> f64 {
    clean(set.input_rad_s * RPM)
}

/// Bulk oil, degC.
#[must_use]
pub fn oil_degc(set: &BenchPoint) -> f64 {
    clean(set.sump_k - ZERO_DEGC_K)
}

/// What applies to any of some answers.
pub fn union<'a>(answers: impl IntoIterator<Item = &'a BenchAnswer>) -> Flags {
    answers.into_iter().fold(Flags::default(), |all, answer| {
        Flags(all.0 | answer.flags.0)
    })
}

fn set_columns<T: 'static>(set: fn(&T) -> &BenchPoint) -> Vec<Column<T>> {
    vec![
        Column::number("ratio", move |row| set(row).ratio),
        Column::number("input_speed_rpm", move |row| rpm(set(row))),
        Column::number("oil_degc", move |row| oil_degc(set(row))),
    ]
}

/// Parts of the belt that a CVT can have.
const BELT: [Component; 6] = [
    Component::BeltBand,
    Component::BeltFilm,
    Component::BeltSlip,
    Component::BeltWedge,
    Component::BeltPenetration,
    Component::BeltMap,
];

fn part_columns<T: 'static>(answer: fn(&T) -> &BenchAnswer) -> Vec<Column<T>> {
    let mut columns: Vec<Column<T>> = Vec::new();
    for piece in Piece::ALL {
        columns.push(Column::number(format!("{}_nm", piece.name()), move |row| {
            piece.loss_nm(answer(row))
        }));
    }
    for part in BELT {
        columns.push(Column::number(format!("{}_nm", part.name()), move |row| {
            answer(row).part_nm(part)
        }));
    }
    columns.push(Column::number("belt_degc", move |row| {
        answer(row).belt_k - ZERO_DEGC_K
    }));
    columns.push(Column::new("flags", move |row| {
        Value::Flags(answer(row).flags)
    }));
    columns
}

/// Columns of the steady tests, with and without load.
#[must_use]
pub fn steady_columns() -> Vec<Column<SteadyPoint>> {
    let mut columns = set_columns(|p: &SteadyPoint| &p.set);
    columns.extend([
        Column::number("output_torque_nm", |p: &SteadyPoint| p.set.output_nm),
        Column::number("secondary_pressure_bar", |p: &SteadyPoint| {
            p.answer.secondary_pa / 1e5
        }),
        Column::number("torque_loss_nm", |p: &SteadyPoint| p.answer.total_nm()),
        Column::number("input_torque_nm", |p: &SteadyPoint| p.answer.input_nm),
        Column::number("output_speed_rpm", |p: &SteadyPoint| {
            p.answer.output_rad_s * RPM
        }),
        Column::number("efficiency_percent", efficiency_percent),
        Column::number("slip_percent", |p: &SteadyPoint| {
            100.0 * p.answer.belt.map_or(f64::NAN, |b| b.slip_total)
        }),
    ]);
    columns.extend(part_columns(|p: &SteadyPoint| &p.answer));
    columns
}

/// Output over input power, %; NaN where nothing is delivered.
fn efficiency_percent(p: &SteadyPoint) -> f64 {
    let out = p.set.output_nm * p.answer.output_rad_s;
    if out > 0.0 {
        100.0 * out / (p.answer.input_nm * p.set.input_rad_s)
    } else {
        f64::NAN
    }
}

/// Columns of the strip-down.
#[must_use]
pub fn strip_columns() -> Vec<Column<StripDown>> {
    let mut columns = set_columns(|s: &StripDown| &s.set);
    for stage in Stage::ALL {
        columns.push(Column::number(
            format!("{}_loss_nm", stage.name()),
            move |s: &StripDown| s.stage(stage).total_nm(),
        ));
        columns.push(Column::number(
            format!("{}_pressure_bar", stage.name()),
            move |s: &StripDown| s.stage(stage).secondary_pa / 1e5,
        ));
    }
    for piece in Piece::ALL {
        let name = |what: &str| format!("{}_{what}_nm", piece.name());
        columns.push(Column::number(name("difference"), move |s: &StripDown| {
            s.piece(piece).uncorrected_nm
        }));
        columns.push(Column::number(name("corrected"), move |s: &StripDown| {
            s.piece(piece).corrected_nm
        }));
        columns.push(Column::number(name("true"), move |s: &StripDown| {
            s.piece(piece).true_nm
        }));
        if matches!(piece, Piece::Belt | Piece::FinalDrive) {
            columns.push(Column::number(
                name("interaction_pressure"),
                move |s: &StripDown| s.piece(piece).by_pressure_nm,
            ));
            columns.push(Column::number(
                name("interaction_torque"),
                move |s: &StripDown| s.piece(piece).by_torque_nm,
            ));
        }
        columns.push(Column::number(name("remainder"), move |s: &StripDown| {
            s.piece(piece).remainder_nm()
        }));
    }
    columns.push(Column::new("flags", |s: &StripDown| {
        Value::Flags(union(&s.stages))
    }));
    columns
}

/// Columns of a second of a transient, with the ratio of its loop.
#[must_use]
pub fn transient_columns() -> Vec<Column<(f64, Moment)>> {
    let mut columns: Vec<Column<(f64, Moment)>> = vec![
        Column::number("ratio", |m: &(f64, Moment)| m.0),
        Column::new("branch", |m: &(f64, Moment)| Value::Text(m.1.branch.word())),
        Column::number("time_s", |m: &(f64, Moment)| m.1.time_s),
        Column::number("bulk_oil_degc", |m: &(f64, Moment)| {
            m.1.sump_k - ZERO_DEGC_K
        }),
        Column::number("metal_degc", |m: &(f64, Moment)| m.1.metal_k - ZERO_DEGC_K),
        Column::number("secondary_pressure_bar", |m: &(f64, Moment)| {
            m.1.answer.secondary_pa / 1e5
        }),
        Column::number("torque_loss_nm", |m: &(f64, Moment)| m.1.answer.total_nm()),
    ];
    columns.extend(part_columns(|m: &(f64, Moment)| &m.1.answer));
    columns
}

/// Columns of the two boxes.
#[must_use]
pub fn two_box_columns() -> Vec<Column<TwoBoxes>> {
    let mut columns = set_columns(|t: &TwoBoxes| &t.first.set);
    columns.extend([
        Column::number("first_pressure_bar", |t: &TwoBoxes| {
            t.first.answer.secondary_pa / 1e5
        }),
        Column::number("second_pressure_bar", |t: &TwoBoxes| {
            t.second.answer.secondary_pa / 1e5
        }),
        Column::number("first_loss_nm", |t: &TwoBoxes| t.first.answer.total_nm()),
        Column::number("second_loss_nm", |t: &TwoBoxes| t.second.answer.total_nm()),
        Column::number("difference_nm", TwoBoxes::difference_nm),
        Column::new("flags", |t: &TwoBoxes| {
            Value::Flags(union([&t.first.answer, &t.second.answer]))
        }),
    ]);
    columns
}
