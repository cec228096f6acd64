//! One row of belt points: its values, each checked for itself.

use cvtcycle_config::cycle::problems::{Cell, Collector, Complaint, Line};
use cvtcycle_config::cycle::text::Field;
use cvtcycle_config::near;
use cvtcycle_model::transmission::cvt::variator::Formulation;

use super::columns::{Column, FORMULATION, Header, NUMBERS, ON_STOP, REQUIRED};

/// The values of a row as given; `None` where nothing is.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given<'t> {
    pub case: &'t str,
    pub formulation: Option<Formulation>,
    pub numbers: [Option<f64>; NUMBERS.len()],
}

impl Given<'_> {
    /// Whether the row has all numbers that it must have.
    pub fn is_whole(&self) -> bool {
        self.numbers.iter().take(REQUIRED).all(Option::is_some)
    }

    /// A number that every whole row has.
    pub fn required(&self, place: usize) -> f64 {
        self.numbers[place].unwrap_or(f64::NAN)
    }
}

/// Reads the fields of a line that has as many as the header, and says whether all are good.
pub fn read<'t>(
    line: Line<'t>,
    fields: &[Field<'t>],
    header: &Header,
    problems: &mut Collector<'_>,
) -> (Given<'t>, bool) {
    let mut given = Given::default();
    let mut good = true;
    for (&field, column) in fields.iter().zip(&header.columns) {
        match column {
            Some(Column::Case) => given.case = field.text,
            Some(Column::Formulation) if !field.text.is_empty() => {
                given.formulation = formulation(
                    &Cell {
                        line,
                        key: FORMULATION,
                        field,
                    },
                    problems,
                );
                good &= given.formulation.is_some();
            }
            Some(Column::Number(place)) if !field.text.is_empty() || *place < REQUIRED => {
                given.numbers[*place] = number(
                    *place,
                    &Cell {
                        line,
                        key: NUMBERS[*place].name,
                        field,
                    },
                    problems,
                );
                good &= given.numbers[*place].is_some();
            }
            _ => {}
        }
    }
    (given, good)
}

fn formulation(cell: &Cell<'_>, problems: &mut Collector<'_>) -> Option<Formulation> {
    let text = cell.field.text;
    let found = Formulation::NAMES
        .iter()
        .find(|(name, _)| *name == text)
        .map(|(_, formulation)| *formulation);
    if found.is_none() {
        problems.cell(cell, || {
            let names = Formulation::NAMES.map(|(name, _)| name);
            let close = near(text, names.into_iter());
            let hint = if close.is_empty() {
                String::new()
            } else {
                format!("did you mean {}?", close.join(" or "))
            };
            Complaint::new(
                "this formulation is not known",
                format!("one of {}", names.join(", ")),
                hint,
            )
        });
    }
    found
}

fn number(place: usize, cell: &Cell<'_>, problems: &mut Collector<'_>) -> Option<f64> {
    let (text, column) = (cell.field.text, &NUMBERS[place]);
    let parsed = text.parse::<f64>();
    if let Ok(value) = parsed
        && column.allowed.contains(value)
        && (!column.whole || value.fract().abs() <= 0.0)
    {
        // turns -0 into 0
        return Some(value + 0.0);
    }
    problems.cell(cell, || {
        let (message, hint) = match parsed {
            Ok(value) if value.is_nan() => {
                ("this is not a number", "fill the gap or remove the row")
            }
            Ok(value) if value.is_infinite() => (
                "this is not a finite number",
                "fill the gap or remove the row",
            ),
            Ok(value) if column.allowed.contains(value) => {
                ("this is not a whole number", "write it without decimals")
            }
            Ok(_) if column.unit.is_empty() => ("this value is out of range", ""),
            Ok(_) => (
                "this value is out of range",
                "the unit is in the column's name",
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
        let allowed = match (place, column.whole) {
            (ON_STOP, _) => "1 (no deflection), 0 (full deflection) or nothing".to_owned(),
            (_, true) => format!("a whole number from {}", column.allowed),
            (_, false) => column.allowed.in_unit(column.unit),
        };
        Complaint::new(message, allowed, hint)
    });
    None
}
