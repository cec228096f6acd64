//! The operating point that the belt's pages work through, as `cvtcycle belt` computes it.

use super::reference::Reference;
use cvtcycle::config::{Problems, render};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::validate::belt::{Job, Model, OUTPUTS, Solved, Take, read};

/// Columns of the table that `cvtcycle belt` reads.
pub const HEAD: &str = "ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm";
/// The point: low ratio.
pub const POINT: &str = "2.417,2000,30,100";

/// A point with all that the program says of it.
pub struct Answer(Solved);

impl Answer {
    /// The number in a column of `cvtcycle belt`.
    ///
    /// # Panics
    /// Where there is no such column: its name is written in the figures, and a test of the book meets it.
    pub fn of(&self, column: &str) -> f64 {
        let found = OUTPUTS.iter().find(|of| of.name == column);
        let column = found.unwrap_or_else(|| panic!("`cvtcycle belt` has no column {column}"));
        column.number_of(&(String::new(), self.0))
    }
}

/// Ratio, speed in rpm, pressure in bar and torque in Nm of a row.
///
/// # Errors
/// A sentence, if the row does not have four numbers.
pub fn numbers(row: &str) -> Result<[f64; 4], String> {
    let numbers: Vec<f64> = row.split(',').filter_map(|x| x.parse().ok()).collect();
    numbers
        .try_into()
        .map_err(|_| format!("{row} are not four numbers"))
}

struct Rows(Vec<Answer>);

impl Take for Rows {
    fn begin(&mut self, _: bool) -> Result<(), Problems> {
        Ok(())
    }

    fn put(&mut self, _: &str, row: &Solved) -> Result<(), Problems> {
        self.0.push(Answer(*row));
        Ok(())
    }
}

/// Answers to rows under [`HEAD`] for the reference car.
///
/// # Errors
/// What is wrong with the rows.
pub fn answers(r: &Reference, rows: &[&str]) -> Result<Vec<Answer>, String> {
    let table = format!("{HEAD}\n{}\n", rows.join("\n"));
    let mut taken = Rows(Vec::new());
    let job = Job {
        model: Model::new(&r.cvt_car, None),
        formulation: Formulation::Smooth,
        rows: &mut taken,
    };
    read("points.csv", table.as_bytes(), job).map_err(|problems| render(&problems, false))?;
    Ok(taken.0)
}
