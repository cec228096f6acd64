//! A user's CSV map to a table of numbers on a full grid, or to all that is wrong with it.

use std::collections::HashMap;

use super::wide::{Row, Wide};
use crate::csv::{self, Collector, Schema};
use crate::{Problem, Problems};

/// The limit of rows, as many points as `losses` writes, and what helps beyond it.
pub(super) const MAX_ROWS: (usize, &str) = (
    1_000_000,
    "a coarser grid will do: between its points a map is interpolated",
);

/// Conditions between the rows of a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rules {
    /// Group of columns along which the value may not fall.
    pub rises_with: Option<&'static str>,
    /// True if the rows fill a grid.
    pub is_grid: bool,
}

/// Reads a map: the indices of its columns in the schema, and its rows in the columns' own units. The last column of the schema, or another one of
/// its group, is its value; the others span its grid.
///
/// # Errors
/// All problems with line, column and value; after 50 the rest is counted in one last entry.
pub(super) fn read(
    file: &str,
    bytes: &[u8],
    schema: &Schema,
    rules: Rules,
) -> Result<(Vec<usize>, Vec<Vec<f64>>), Problems> {
    let mut problems = Collector::new(file);
    let (columns, rows) = match Wide::detect(schema, bytes) {
        Some(wide) => wide.read(schema, bytes, &mut problems),
        None => long(schema, bytes, &mut problems),
    };
    if problems.is_empty() {
        full(schema, (&columns, rules.is_grid), &rows, &mut problems);
    }
    if let Some(group) = rules.rises_with.filter(|_| problems.is_empty()) {
        rising(schema, (&columns, group), &rows, &mut problems);
    }
    problems.finish().finish()?;
    let rows = rows.into_iter().map(|row| row.values).collect();
    Ok((columns, rows))
}

/// The rows of a file with a line for each point.
fn long<'t>(
    schema: &Schema,
    bytes: &'t [u8],
    problems: &mut Collector<'_>,
) -> (Vec<usize>, Vec<Row<'t>>) {
    let mut rows = Vec::new();
    let table = csv::read(
        bytes,
        schema,
        problems,
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
    let columns = table.map_or_else(Vec::new, |table| {
        let indices = 0..schema.columns.len();
        indices.filter(|k| table.has(*k)).collect()
    });
    (columns, rows)
}

/// Looks for combinations of the axes' values that have two rows, or in a grid none. Values are shown in the units of the file.
fn full(
    schema: &Schema,
    (columns, is_grid): (&[usize], bool),
    rows: &[Row],
    problems: &mut Collector,
) {
    let axes: Vec<(usize, &str)> = columns
        .iter()
        .enumerate()
        .filter(|(_, column)| !is_value(schema, **column))
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
    if problems.is_empty() && is_grid {
        hole((&axes, &mut levels), &lines, problems);
    }
}

/// Reports the first combination of the axes' values that has no row.
fn hole(
    (axes, levels): (&[(usize, &str)], &mut [Vec<f64>]),
    lines: &HashMap<Vec<u64>, usize>,
    problems: &mut Collector,
) {
    for level in &mut *levels {
        level.sort_by(f64::total_cmp);
        level.dedup_by_key(|x| x.to_bits());
    }
    // At most as many combinations are there as there are rows: the search ends soon.
    let mut place = vec![0; axes.len()];
    while lines.contains_key(
        &place
            .iter()
            .zip(&*levels)
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
        .zip(place.iter().zip(&*levels))
        .map(|((_, name), (k, level))| format!("{name} {}", level[*k]))
        .collect();
    let message = format!("there is no row for {}", here.join(", "));
    let hint = "add it, or remove the rows that belong to no full grid";
    problems.file(
        Problem::missing(message)
            .allowed(format!("a row for every combination of {}", words(axes)))
            .hint(hint),
    );
}

/// True if a column of the schema is the value of the map.
fn is_value(schema: &Schema, column: usize) -> bool {
    let last = schema.columns.len() - 1;
    let [own, last] = [column, last].map(|k| &schema.columns[k]);
    own.name == last.name || !own.group.is_empty() && own.group == last.group
}

/// Looks for rows whose value is below that of the row with the next smaller value of an axis and the same other ones.
fn rising(
    schema: &Schema,
    (columns, group): (&[usize], &str),
    rows: &[Row],
    problems: &mut Collector,
) {
    let at = |is: &dyn Fn(usize) -> bool| columns.iter().position(|column| is(*column));
    let axis = at(&|column| schema.columns[column].group == group);
    let value = at(&|column| is_value(schema, column));
    let (Some(axis), Some(value)) = (axis, value) else {
        return;
    };
    let name = |k: usize| &*schema.columns[columns[k]].name;
    let mut sorted: Vec<&Row> = rows.iter().collect();
    let others = |row: &Row| -> Vec<u64> {
        let all = row.values.iter().enumerate();
        let others = all.filter(|(k, _)| *k != axis && *k != value);
        others.map(|(_, x)| x.to_bits()).collect()
    };
    sorted.sort_by(|a, b| {
        let by_others = others(a).cmp(&others(b));
        by_others.then(a.values[axis].total_cmp(&b.values[axis]))
    });
    let mut falls: Vec<[&Row; 2]> = Vec::new();
    for pair in sorted.windows(2) {
        let is_series = others(pair[0]) == others(pair[1]);
        if is_series && pair[1].values[value] < pair[0].values[value] {
            falls.push([pair[0], pair[1]]);
        }
    }
    falls.sort_by_key(|[_, row]| row.line.number);
    for [before, row] in falls {
        let message = format!(
            "{} falls with {}: it is {} in line {} and {} here",
            name(value),
            name(axis),
            before.values[value],
            before.line.number,
            row.values[value]
        );
        problems.line(row.line, "", || {
            Problem::conflict(message)
                .allowed(format!("at least {}", before.values[value]))
                .hint("correct the row; are two columns exchanged?")
        });
    }
}

fn words(axes: &[(usize, &str)]) -> String {
    axes.iter()
        .map(|(_, name)| *name)
        .collect::<Vec<_>>()
        .join(", ")
}
