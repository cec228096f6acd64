//! The matrix of ambient temperatures as tables.

use cvtcycle::output::number::{plain, signed};
use cvtcycle::output::table::TextColumns;
use cvtcycle::study::answer::ambient::Matrix;

use crate::print::colour::Paint;
use crate::print::sections;

/// Start and ambient temperature of a row, by index.
type Row = (usize, usize);

/// Fuel of each part of the cycle with the difference to the baselines, and end temperatures.
pub fn tables(matrix: &Matrix, paint: Paint) -> String {
    let rows = |columns: &TextColumns<Row>| {
        let ambients = matrix.ambient_degc.len();
        let of_start = |start| (0..ambients).map(move |ambient| (start, ambient));
        let rows: Vec<Row> = (0..matrix.starts.len()).flat_map(of_start).collect();
        columns.text(&rows)
    };
    let fuel = matrix.fuel.iter().map(|part| {
        let name = match part.name.as_str() {
            "total" => "whole cycle",
            name => name,
        };
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.l_per_100km) {
            columns = columns.number(car, 2, |row| cell(numbers, row));
        }
        for (car, numbers) in matrix.cars.iter().skip(1).zip(&part.excess_percent) {
            columns = columns.right(format!("over {car}"), |row| signed(cell(numbers, row), 1));
        }
        let title = format!("Fuel, {name}, L/100 km, and difference of the subject, %");
        (title, rows(&columns))
    });
    let ends = matrix.ends.iter().map(|part| {
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.degc) {
            columns = columns.number(car, 1, |row| cell(numbers, row));
        }
        let title = format!("End temperature, {}, degC", part.name);
        (title, rows(&columns))
    });
    sections(fuel.chain(ends), paint)
}

fn cell(numbers: &[Vec<f64>], (start, ambient): &Row) -> Option<f64> {
    numbers.get(*start)?.get(*ambient).copied()
}

/// Columns of start and ambient temperature; a start is named in its first row.
fn lead(matrix: &Matrix) -> TextColumns<'_, Row> {
    let start = |(start, ambient): &Row| match ambient {
        0 => matrix.starts[*start].as_str(),
        _ => "",
    };
    TextColumns::new()
        .left("start", start)
        .right("ambient", |(_, ambient)| {
            plain(matrix.ambient_degc[*ambient])
        })
}
