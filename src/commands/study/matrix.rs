//! The matrix of ambient temperatures as tables for people.

use cvtcycle::study::ambient::Matrix;

use crate::print::colour::Paint;
use crate::print::grid::Grid;
use cvtcycle::output::number::{fixed, plain, signed};

/// Fuel of each part of the cycle with the subject's excess, and end temperatures.
pub fn tables(matrix: &Matrix, paint: Paint) -> String {
    let mut text = String::new();
    for part in &matrix.fuel {
        let name = if part.name == "total" {
            "whole cycle"
        } else {
            &part.name
        };
        text += &format!(
            "\n{}\n",
            paint.heading(&format!(
                "Fuel, {name}, L/100 km, and what the subject uses more, %"
            ))
        );
        let fuel = Block {
            heads: matrix.cars.clone(),
            numbers: &part.l_per_100km,
            decimals: 2,
            sign: false,
        };
        let over = matrix
            .cars
            .iter()
            .skip(1)
            .map(|car| format!("over {car}"))
            .collect();
        let excess = Block {
            heads: over,
            numbers: &part.excess_percent,
            decimals: 1,
            sign: true,
        };
        text += &table(matrix, &[fuel, excess]);
    }
    for part in &matrix.ends {
        text += &format!(
            "\n{}\n",
            paint.heading(&format!("End temperature, {}, degC", part.name))
        );
        text += &table(
            matrix,
            &[Block {
                heads: matrix.cars.clone(),
                numbers: &part.degc,
                decimals: 1,
                sign: false,
            }],
        );
    }
    text
}

/// Columns of one kind of number: one for each car.
struct Block<'a> {
    heads: Vec<String>,
    numbers: &'a [Vec<Vec<f64>>],
    decimals: usize,
    sign: bool,
}

fn table(matrix: &Matrix, blocks: &[Block]) -> String {
    let columns: usize = blocks.iter().map(|block| block.numbers.len()).sum();
    let mut grid = Grid::new(&("lr".to_owned() + &"r".repeat(columns))).indented();
    grid.row(
        ["start", "ambient"].into_iter().chain(
            blocks
                .iter()
                .flat_map(|block| &block.heads)
                .map(String::as_str),
        ),
    );
    for (s, start) in matrix.starts.iter().enumerate() {
        for (a, degc) in matrix.ambient_degc.iter().enumerate() {
            let cells = blocks.iter().flat_map(|block| {
                block.numbers.iter().map(move |by_start| {
                    let x = by_start
                        .get(s)
                        .and_then(|by_ambient| by_ambient.get(a))
                        .copied();
                    if block.sign {
                        signed(x, block.decimals)
                    } else {
                        fixed(x, block.decimals)
                    }
                })
            });
            let word = if a == 0 { start.as_str() } else { "" };
            grid.row([word.to_owned(), plain(*degc)].into_iter().chain(cells));
        }
    }
    grid.text()
}
