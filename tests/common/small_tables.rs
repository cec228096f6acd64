//! Two small tables for expressions: a source of six rows with columns `x`, `g` and `y`, the last row at gross slip, and a run with one total.

use std::cell::Cell;
use std::rc::Rc;

use cvtcycle::validate::expr::{Names, Table, Tables};

pub struct SmallTables {
    keys: Vec<String>,
    low: Rc<Table>,
    trip: Rc<Table>,
    /// Number of rows left out at gross slip.
    pub left_out: Cell<usize>,
    /// Evaluations left.
    pub left: Cell<u64>,
}

impl SmallTables {
    /// Creates tables with two groups of rows, `g` 0 and 1.
    pub fn new(x: [f64; 6], y: [f64; 6], evaluations: u64) -> Self {
        let g = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let make_table = |columns: Vec<Vec<f64>>, weight: &[f64], gross: &[bool]| {
            let count = columns.len();
            let make = Box::new(move |place: usize| columns[place].clone());
            Table::new(count, make, weight.to_vec(), [gross.to_vec(), Vec::new()])
        };
        let low = make_table(
            [x, g, y].map(Vec::from).into(),
            &[1.0, 1.0, 2.0, 1.0, 1.0, 1.0],
            &[false, false, false, false, false, true],
        );
        let trip = make_table(vec![vec![6.5]], &[1.0], &[]);
        SmallTables {
            keys: vec!["belt.offset_mm".to_owned()],
            low: Rc::new(low),
            trip: Rc::new(trip),
            left_out: Cell::default(),
            left: Cell::new(evaluations),
        }
    }
}

impl Names for SmallTables {
    fn sources(&self) -> Vec<&str> {
        vec!["low", "trip"]
    }

    fn columns(&self, source: usize, totals: bool) -> Vec<&'static str> {
        match (source, totals) {
            (0, false) => vec!["x", "g", "y"],
            (1, true) => vec!["fuel"],
            _ => Vec::new(),
        }
    }

    fn keys(&self) -> &[String] {
        &self.keys
    }
}

impl Tables for SmallTables {
    fn table(&self, source: usize, _: bool) -> Result<Rc<Table>, String> {
        Ok([&self.low, &self.trip][source].clone())
    }

    fn key(&self, _: Option<usize>, _: &str, item: Option<usize>) -> Result<f64, String> {
        Ok(item.map_or(3.0, |k| k as f64))
    }

    fn spend(&self, evaluations: u64) -> Result<(), String> {
        let left = self.left.get().checked_sub(evaluations);
        self.left.set(left.unwrap_or(0));
        left.map(drop)
            .ok_or_else(|| "no evaluations are left".to_owned())
    }

    fn left_out(&self, rows: usize) {
        self.left_out.set(self.left_out.get() + rows);
    }

    fn outside(&self, _: usize) {}
}
