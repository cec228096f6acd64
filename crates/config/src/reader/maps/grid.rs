//! A user's CSV map to a table of numbers on a full grid, or to all that is wrong with it.

use std::collections::HashMap;

use crate::csv::{self, Collector, Line, Schema};
use crate::{Problem, Problems};

/// The limit of rows, as many points as `losses` writes, and what helps beyond it.
pub(super) const MAX_ROWS: (usize, &str) = (
    1_000_000,
    "a coarser grid will do: between its points a map is interpolated",
);

/// A row with its line.
struct Row<'t> {
    line: Line<'t>,
    values: Vec<f64>,
}

/// Reads a map: the indices of its columns in the schema, and its rows in the columns' own units. The last column of the schema is its value,
/// the others span its grid.
///
/// # Errors
/// All problems with line, column and value; after 50 the rest is counted in one last entry.
pub(super) fn read(
    file: &str,
    bytes: &[u8],
    schema: &Schema,
) -> Result<(Vec<usize>, Vec<Vec<f64>>), Problems> {
    let mut problems = Collector::new(file);
    let mut rows = Vec::new();
    let table = csv::read(
        bytes,
        schema,
        &mut problems,
        |_, _, _| {},
        |row, _| {
            let indices = 0..schema.columns.len();
            let there = indices.filter(|k| row.table().has(*k));
            let values = there.map(|k| row.number(k).unwrap_or(f64::NAN)).collect();
            rows.push(Row {
                line: row.line,
                values,
            });
            true
        },
    );
    let columns: Vec<usize> = table.map_or_else(Vec::new, |table| {
        let indices = 0..schema.columns.len();
        indices.filter(|k| table.has(*k)).collect()
    });
    if problems.is_empty() {
        full(schema, &columns, &rows, &mut problems);
    }
    problems.finish().finish()?;
    let rows = rows.into_iter().map(|row| row.values).collect();
    Ok((columns, rows))
}

/// Looks for combinations of the axes' values that have two rows, or none. Values are shown in the units of the file.
fn full(schema: &Schema, columns: &[usize], rows: &[Row], problems: &mut Collector) {
    let value = schema.columns.len() - 1;
    let axes: Vec<(usize, &str)> = columns
        .iter()
        .enumerate()
        .filter(|(_, column)| **column != value)
        .map(|(k, column)| (k, &*schema.columns[*column].name))
        .collect();
    let mut lines: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut levels: Vec<Vec<f64>> = vec![Vec::new(); axes.len()];
    for row in rows {
        let at: Vec<u64> = axes.iter().map(|(k, _)| row.values[*k].to_bits()).collect();
        levels
            .iter_mut()
            .zip(&axes)
            .for_each(|(level, (k, _))| level.push(row.values[*k]));
        if let Some(first) = lines.insert(at, row.line.number) {
            let message = format!("this row has the same {} as line {first}", words(&axes));
            problems.line(row.line, "", || {
                Problem::duplicate(message)
                    .allowed("each combination once")
                    .hint("remove one of them")
            });
        }
    }
    if !problems.is_empty() {
        return;
    }
    for level in &mut levels {
        level.sort_by(f64::total_cmp);
        level.dedup_by_key(|x| x.to_bits());
    }
    // At most as many combinations are there as there are rows: the search ends soon.
    let mut place = vec![0; axes.len()];
    while lines.contains_key(
        &place
            .iter()
            .zip(&levels)
            .map(|(k, level)| level[*k].to_bits())
            .collect::<Vec<_>>(),
    ) {
        let Some(axis) = (0..axes.len())
            .rev()
            .find(|axis| place[*axis] + 1 < levels[*axis].len())
        else {
            return;
        };
        place[axis] += 1;
        place[axis + 1..].fill(0);
    }
    let here: Vec<String> = axes
        .iter()
        .zip(place.iter().zip(&levels))
        .map(|((_, name), (k, level))| format!("{name} {}", level[*k]))
        .collect();
    let message = format!("there is no row for {}", here.join(", "));
    let hint = "add it, or remove the rows that belong to no full grid";
    problems.file(
        Problem::missing(message)
            .allowed(format!("a row for every combination of {}", words(&axes)))
            .hint(hint),
    );
}

fn words(axes: &[(usize, &str)]) -> String {
    axes.iter()
        .map(|(_, name)| *name)
        .collect::<Vec<_>>()
        .join(", ")
}
