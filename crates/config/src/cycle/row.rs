//! One row of the table: its values, each checked for itself.

use super::gears::Note;
use super::header::{Column, Header, SpeedUnit};
use super::problems::{Cell, Collector, Complaint, Line};
use super::text::Field;
use crate::readable;

/// Faster is no road car; a higher number is nearly always a wrong unit.
const HIGHEST_KMH: f64 = 300.0;
/// The steepest streets stay below this slope (rise over run).
const STEEPEST: f64 = 0.35;
/// A file with more phases has its row number or its time in the column.
const MAX_PHASES: usize = 200;

/// The values of a row, in SI. What a column does not give, or gives badly, stays at its default.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    pub(super) time_s: Option<f64>,
    pub(super) speed_m_s: Option<f64>,
    pub(super) phase: u16,
    pub(super) grade: f64,
    pub(super) engine_off: bool,
    pub(super) gear: u8,
    pub(super) gear_5: u8,
    pub(super) gear_6: u8,
    pub(super) note: Note,
}

/// Reads the fields of a line that has as many as the header.
pub(super) fn read<'t>(
    line: Line<'t>,
    fields: &[Field<'t>],
    header: &Header,
    phases: &mut Vec<String>,
    problems: &mut Collector<'_>,
) -> Row {
    let mut row = Row::default();
    for (&field, &column) in fields.iter().zip(&header.columns) {
        let Some((column, key)) = column else {
            continue;
        };
        let cell = Cell { line, key, field };
        match column {
            Column::Time => row.time_s = number(&cell, "a time in s", problems),
            Column::Speed(unit) => row.speed_m_s = speed(&cell, unit, problems),
            Column::Phase => row.phase = phase(&cell, row.phase, phases, problems),
            Column::Gear => row.gear = gear(&cell, 10, problems),
            Column::Gear5 => row.gear_5 = gear(&cell, 5, problems),
            Column::Gear6 => row.gear_6 = gear(&cell, 6, problems),
            Column::GearNote => row.note = note(&cell, header.highest_gear(), problems),
            Column::Operation => {}
            Column::Grade(divisor) => row.grade = grade(&cell, divisor, problems),
            Column::EngineOff => row.engine_off = engine_off(&cell, problems),
        }
    }
    check_note(line, &row, problems);
    row
}

fn check_note(line: Line<'_>, row: &Row, problems: &mut Collector<'_>) {
    if let Note::Gear(gear) = row.note
        && gear > 0
        && row.gear.max(row.gear_5).max(row.gear_6) == 0
    {
        problems.line(line, "gear_note", || {
            let message = format!("the note says gear {gear} and the gear column says none");
            Complaint::new(
                message,
                "the same gear",
                "write the gear into the gear column",
            )
        });
    }
}

fn number(cell: &Cell<'_>, allowed: &str, problems: &mut Collector<'_>) -> Option<f64> {
    let text = cell.field.text;
    let (message, hint) = match text.parse::<f64>() {
        Ok(value) if value.is_finite() => return Some(value),
        Ok(value) if value.is_nan() => ("this is not a number", "fill the gap or remove the row"),
        Ok(_) => (
            "this is not a finite number",
            "fill the gap or remove the row",
        ),
        Err(_) if text.is_empty() => ("the value is missing", "fill the gap or remove the row"),
        Err(_) if text.contains(',') => (
            "this is not a number",
            "write a decimal point: 12.5 and not 12,5",
        ),
        Err(_) => (
            "this is not a number",
            "write the bare number; the unit is in the column's name",
        ),
    };
    problems.cell(cell, || Complaint::new(message, allowed, hint));
    None
}

fn speed(cell: &Cell<'_>, unit: SpeedUnit, problems: &mut Collector<'_>) -> Option<f64> {
    let value = number(cell, "a speed from 0 to 300 km/h", problems)?;
    let kmh = unit.kmh(value);
    if (0.0..=HIGHEST_KMH).contains(&kmh) {
        // turns -0 into 0
        return Some(unit.m_s(value) + 0.0);
    }
    problems.cell(cell, || {
        let (message, hint) = if value < 0.0 {
            (
                "the speed is negative".to_owned(),
                "set a sensor's small negative values to 0; reversing cannot be driven".to_owned(),
            )
        } else {
            (
                format!("{} km/h is too fast", readable(kmh, 1)),
                format!("is the column in another unit than {} says?", cell.key),
            )
        };
        Complaint::new(message, "0 to 300 km/h", hint)
    });
    None
}

fn phase(
    cell: &Cell<'_>,
    last: u16,
    phases: &mut Vec<String>,
    problems: &mut Collector<'_>,
) -> u16 {
    let name = cell.field.text;
    if let Some(found) = phases.iter().position(|known| known == name) {
        return u16::try_from(found).unwrap_or(last);
    }
    if name.is_empty() {
        problems.cell(cell, || {
            Complaint::new(
                "the phase has no name",
                "a name in each row",
                "repeat the name in each row of the phase",
            )
        });
    } else if phases.len() >= MAX_PHASES {
        let allowed = format!("up to {MAX_PHASES} different names");
        problems.cell(cell, || {
            Complaint::new(
                "there are too many phases",
                allowed,
                "a phase is a part of the cycle that is reported by itself",
            )
        });
    } else {
        phases.push(name.to_owned());
        return u16::try_from(phases.len() - 1).unwrap_or(last);
    }
    last
}

fn gear(cell: &Cell<'_>, highest: u8, problems: &mut Collector<'_>) -> u8 {
    let text = cell.field.text;
    // other programs write whole numbers as 3.0
    let value = text
        .parse::<f64>()
        .ok()
        .filter(|value| value.fract() == 0.0 && (0.0..=f64::from(highest)).contains(value));
    if let Some(value) = value {
        return value as u8;
    }
    let hint = "write the number alone, and 0 where no gear is engaged";
    problems.cell(cell, || {
        Complaint::new(
            "this is no gear",
            format!("a whole number from 0 to {highest}; 0: no gear engaged"),
            hint,
        )
    });
    0
}

fn note(cell: &Cell<'_>, highest: u8, problems: &mut Collector<'_>) -> Note {
    match Note::parse(cell.field.text) {
        Some(Note::Declutched(gear)) if gear > highest => {}
        Some(note) => return note,
        None => {}
    }
    let allowed = format!(
        "PM (neutral), K1 to K{highest} (clutch disengaged in that gear), GC (gear change), the gear again or nothing"
    );
    problems.cell(cell, || {
        Complaint::new(
            "this note is not known",
            allowed,
            "leave the cell empty where the gear column says all",
        )
    });
    Note::Blank
}

fn grade(cell: &Cell<'_>, divisor: f64, problems: &mut Collector<'_>) -> f64 {
    let limit = STEEPEST * divisor;
    let allowed = format!("-{limit} to {limit}");
    let Some(value) = number(cell, &allowed, problems) else {
        return 0.0;
    };
    if value.abs() <= limit {
        return value / divisor;
    }
    let hint = if divisor > 1.0 {
        "is the column in per mille or in degrees?"
    } else {
        "is the column in percent? then name it grade_percent"
    };
    problems.cell(cell, || {
        Complaint::new("the road is too steep", allowed, hint)
    });
    0.0
}

fn engine_off(cell: &Cell<'_>, problems: &mut Collector<'_>) -> bool {
    match cell.field.text {
        "1" => true,
        "0" => false,
        _ => {
            problems.cell(cell, || {
                Complaint::new(
                    "this is neither 0 nor 1",
                    "0 (engine on) or 1 (engine off)",
                    "write 1 only where the driver stops the engine",
                )
            });
            false
        }
    }
}
