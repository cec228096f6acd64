//! The runs of a point as rows of the table of runs.

use std::sync::Arc;

use super::plan::FactorValue;
use super::point::{PointRun, Status};
use super::prepare::Study;
use super::table::{Rows, Values};

/// Puts the runs of consecutive points into rows of the table of runs.
pub(super) struct Filler<'s> {
    study: &'s Study,
    words: Words,
}

/// Words of many rows, each held once.
struct Words {
    empty: Arc<str>,
    ok: Arc<str>,
}

impl<'s> Filler<'s> {
    pub fn new(study: &'s Study) -> Self {
        Filler {
            study,
            words: Words {
                empty: "".into(),
                ok: "ok".into(),
            },
        }
    }

    /// Appends the runs of a point.
    pub fn push(&self, point: u64, runs: &[PointRun], rows: &mut Rows) {
        for (car, run) in self.study.cars.iter().zip(runs) {
            let word = |text: &str| {
                if text.is_empty() {
                    self.words.empty.clone()
                } else {
                    Arc::from(text)
                }
            };
            let status = if run.status == Status::Ok {
                self.words.ok.clone()
            } else {
                word(run.status.word())
            };
            let mut columns = rows.values.iter_mut();
            let head = [
                car.name.clone(),
                car.role.clone(),
                status,
                word(run.status.reason()),
            ];
            if let Some(Values::Count(cells)) = columns.next() {
                cells.push(i64::try_from(point).unwrap_or(i64::MAX));
            }
            for text in head {
                if let Some(Values::Text(cells)) = columns.next() {
                    cells.push(text);
                }
            }
            for (factors, cells) in self.study.factor_columns.iter().zip(columns.by_ref()) {
                let value = factors.iter().find_map(|&f| run.factors[f].as_ref());
                match (cells, value) {
                    (Values::Number(cells), Some(FactorValue::Number(x))) => cells.push(*x),
                    (Values::Number(cells), _) => cells.push(f64::NAN),
                    (Values::Text(cells), Some(value)) => cells.push(value.text()),
                    (Values::Text(cells), None) => cells.push(self.words.empty.clone()),
                    (Values::Count(cells), _) => cells.push(0),
                }
            }
            for (cells, number) in columns.zip(&run.numbers) {
                if let Values::Number(cells) = cells {
                    cells.push(*number);
                }
            }
        }
    }
}
