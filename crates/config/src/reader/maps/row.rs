//! Rows of a map and the column of its value, in which all forms agree.

use crate::csv::{Line, Schema};

/// A row with its line.
pub(super) struct Row<'t> {
    pub line: Line<'t>,
    pub values: Vec<f64>,
}

/// True if a column of the schema is the value of the map.
pub(super) fn is_value(schema: &Schema, column: usize) -> bool {
    let last = schema.columns.len() - 1;
    let [own, last] = [column, last].map(|k| &schema.columns[k]);
    own.name == last.name || !own.group.is_empty() && own.group == last.group
}
