//! Operating point of the worked examples of the belt, computed as by `cvtcycle belt`.

use super::reference::Reference;
use cvtcycle::config::{Problems, render};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::validate::belt::{Job, Model, OUTPUTS, Solved, Take, read};

/// Columns of the table read by `cvtcycle belt`.
pub const HEAD: &str = "ratio,input_speed_rpm,secondary_pressure_bar,output_torque_nm";
/// Operating point at low ratio.
pub const POINT: &str = "2.417,2000,30,100";

/// Operating point with all results.
pub struct Answer(Solved);

impl Answer {
    /// Number in a column of `cvtcycle belt`.
    /// # Panics
    /// For an unknown column; the figures contain the names, and a test of the book uses all of them.
    pub fn column(&self, column: &str) -> f64 {
        let found = OUTPUTS.iter().find(|output| output.name == column);
        let column = found.unwrap_or_else(|| panic!("`cvtcycle belt` has no column {column}"));
        column.number_of(&(String::new(), self.0))
    }
}

/// Ratio, speed in rpm, pressure in bar and torque in Nm of a row.
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

/// Evaluates rows under [`HEAD`] for the reference car.
/// # Errors
/// Problems of the rows.
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
