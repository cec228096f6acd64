//! The matrix of ambient temperatures as tables.

use cvtcycle::study::ambient::Matrix;

use crate::print::colour::Paint;
use crate::print::table::TextColumns;
use cvtcycle::output::number::{fixed, plain, signed};

/// Start and ambient temperature of a row, by index.
type Row = (usize, usize);

/// Fuel of each part of the cycle with the difference to the baselines, and end temperatures.
pub fn tables(matrix: &Matrix, paint: Paint) -> String {
    let mut text = String::new();
    for part in &matrix.fuel {
        let name = match part.name.as_str() {
            "total" => "whole cycle",
            name => name,
        };
        let heading = format!("Fuel, {name}, L/100 km, and difference of the subject, %");
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.l_per_100km) {
            columns = columns.right(car, |row| fixed(cell(numbers, row), 2));
        }
        for (car, numbers) in matrix.cars.iter().skip(1).zip(&part.excess_percent) {
            columns = columns.right(format!("over {car}"), |row| signed(cell(numbers, row), 1));
        }
        text += &section(&heading, matrix, &columns, paint);
    }
    for part in &matrix.ends {
        let mut columns = lead(matrix);
        for (car, numbers) in matrix.cars.iter().zip(&part.degc) {
            columns = columns.right(car, |row| fixed(cell(numbers, row), 1));
        }
        text += &section(
            &format!("End temperature, {}, degC", part.name),
            matrix,
            &columns,
            paint,
        );
    }
    text
}

fn cell(numbers: &[Vec<f64>], (start, ambient): &Row) -> Option<f64> {
    numbers.get(*start)?.get(*ambient).copied()
}

/// Columns of start and ambient temperature; a start is named in its first row.
fn lead(matrix: &Matrix) -> TextColumns<'_, Row> {
    let start = |(start, ambient): &Row| match ambient {
        0 => matrix.starts[*start].clone(),
        _ => String::new(),
    };
    TextColumns::new()
        .left("start", start)
        .right("ambient", |(_, ambient)| {
            plain(matrix.ambient_degc[*ambient])
        })
}

fn section(heading: &str, matrix: &Matrix, columns: &TextColumns<Row>, paint: Paint) -> String {
    let of_start =
        |start: usize| (0..matrix.ambient_degc.len()).map(move |ambient| (start, ambient));
    let rows: Vec<Row> = (0..matrix.starts.len()).flat_map(of_start).collect();
    format!(
        "\n{}\n{}",
        paint.heading(heading),
        columns.table(&rows).indented().text()
    )
}
