//! Rows of a trace as a table of a study, and as Parquet.

use std::collections::HashMap;
use std::io::{self, Write};
use std::sync::Arc;

use super::parquet::ParquetTable;
use crate::table::{Column, Kind, Rows, Values};
use cvtcycle_output::columns::{self, Value};
use cvtcycle_output::trace::push_value;
use cvtcycle_output::{Flags, Row};

/// Rows that are turned at a time, a row group each.
const GROUP: usize = 1 << 16;

/// Columns of a trace as those of a table: the same names, units and cells as in CSV.
pub struct TraceColumns {
    columns: Vec<&'static columns::Column>,
    heads: Vec<Column>,
    phases: Vec<Arc<str>>,
    words: HashMap<u32, Arc<str>>,
    empty: Arc<str>,
}

impl TraceColumns {
    /// Some columns of a trace and the names of the phases of its cycle.
    #[must_use]
    pub fn new(columns: &[&'static columns::Column], phases: &[String]) -> Self {
        let blank = Row::default();
        let head = |column: &&'static columns::Column| Column {
            name: column.name.to_owned(),
            unit: column.unit.to_owned(),
            doc: column.doc.to_owned(),
            kind: match (column.get)(&blank) {
                Value::Number(_) => Kind::Number,
                Value::Count(_) => Kind::Count,
                Value::Text(_) | Value::Phase(_) | Value::Flags(_) => Kind::Text,
            },
        };
        TraceColumns {
            columns: columns.to_vec(),
            heads: columns.iter().map(head).collect(),
            phases: phases.iter().map(|name| Arc::from(name.as_str())).collect(),
            words: HashMap::new(),
            empty: Arc::from(""),
        }
    }

    /// Heads of the columns.
    #[must_use]
    pub fn heads(&self) -> &[Column] {
        &self.heads
    }

    /// Appends the cells of a row to as many columns, which may be the last ones of a wider table.
    pub fn push(&mut self, values: &mut [Values], row: &Row) {
        for (column, values) in self.columns.iter().zip(values) {
            match ((column.get)(row), values) {
                (Value::Number(x), Values::Number(into)) => into.push(x),
                (Value::Count(n), Values::Count(into)) => into.push(i64::from(n)),
                (Value::Phase(k), Values::Text(into)) => into.push(
                    self.phases
                        .get(usize::from(k))
                        .unwrap_or(&self.empty)
                        .clone(),
                ),
                (Value::Flags(flags), Values::Text(into)) => into.push(
                    self.words
                        .entry(flags.0)
                        .or_insert_with(|| word(flags))
                        .clone(),
                ),
                (Value::Text(text), Values::Text(into)) => into.push(Arc::from(text)),
                (_, _) => debug_assert!(false, "{} is not of the kind of its head", column.name),
            }
        }
    }
}

/// Flags as they stand in CSV.
fn word(flags: Flags) -> Arc<str> {
    let mut text = String::new();
    push_value(&mut text, Value::Flags(flags), &[]);
    Arc::from(text)
}

/// Writes the rows of a run as Parquet, with the columns and cells of its CSV.
///
/// # Errors
/// Whatever `out` reports.
pub fn write_trace_parquet<W: Write + Send>(
    out: W,
    columns: &[&'static columns::Column],
    rows: &[Row],
    phases: &[String],
) -> io::Result<()> {
    let mut trace = TraceColumns::new(columns, phases);
    let mut turned = |rows: &[Row]| {
        let mut turned = Rows::with_capacity(trace.heads(), rows.len());
        rows.iter()
            .for_each(|row| trace.push(&mut turned.values, row));
        turned
    };
    let mut groups = rows.chunks(GROUP);
    let first = turned(groups.next().unwrap_or_default());
    let heads = TraceColumns::new(columns, phases).heads;
    let mut table = ParquetTable::new(out, &heads, &[], &first)?;
    table.write(&first)?;
    groups.try_for_each(|group| table.write(&turned(group)))?;
    table.finish()
}
