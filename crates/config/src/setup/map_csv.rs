//! A user's CSV map to a table of numbers on a full grid, or to all that is wrong with it.

use std::collections::HashMap;

use crate::cycle::problems::{Collector, Complaint, Line};
use crate::cycle::text::Field;
use crate::{Problems, near};

/// One column: name, and range in its own unit.
pub(super) struct Column {
    pub name: &'static str,
    pub low: f64,
    pub high: f64,
}

/// What a map may hold. The last column is its value, the others span its grid.
pub(super) struct Form<'a> {
    pub columns: &'a [Column],
    /// Of each of these just one column has to be there.
    pub required: &'a [&'a [&'static str]],
}

impl Form<'_> {
    fn all(&self) -> String {
        self.columns
            .iter()
            .map(|column| column.name)
            .collect::<Vec<_>>()
            .join(", ")
    }
}

/// Most rows: as many points as `losses` writes.
const MAX_ROWS: usize = 1_000_000;

/// A row with its line.
struct Row<'t> {
    line: Line<'t>,
    values: Vec<f64>,
}

/// A map as read.
pub(super) struct Read {
    /// Names of the columns.
    pub names: Vec<&'static str>,
    /// Values in the columns' own units.
    pub rows: Vec<Vec<f64>>,
}

/// Reads a map.
///
/// # Errors
/// All problems with line, column and value; after 50 the rest is counted in one last entry.
pub(super) fn read(file: &str, bytes: &[u8], form: &Form) -> Result<Read, Problems> {
    let mut problems = Collector::new(file);
    let Some(mut lines) = problems.lines(bytes) else {
        return Err(problems.finish());
    };
    let Some(columns) = lines
        .next()
        .and_then(|line| header(line, form, &mut problems))
    else {
        return Err(problems.finish());
    };
    let mut rows = Vec::new();
    let mut fields = Vec::new();
    let mut count = 0;
    for line in lines {
        if count == MAX_ROWS {
            let hint = "a coarser grid will do: between its points a map is interpolated";
            problems.line(line, "", || {
                Complaint::new(
                    "the map has too many rows",
                    format!("up to {MAX_ROWS} rows"),
                    hint,
                )
            });
            break;
        }
        count += 1;
        if problems.split(line, columns.len(), &mut fields) {
            let values = fields.iter().zip(&columns).map(|(field, column)| {
                column.map_or(f64::NAN, |c| number(line, *field, c, &mut problems))
            });
            rows.push(Row {
                line,
                values: values.collect(),
            });
        }
    }
    if count == 0 {
        problems.file(Complaint::new(
            "the file has column names and no rows",
            "a row for every point of the grid",
            "add the rows",
        ));
    }
    if problems.is_empty() {
        full(form, &columns, &rows, &mut problems);
    }
    if !problems.is_empty() {
        return Err(problems.finish());
    }
    let names = columns
        .into_iter()
        .flatten()
        .map(|column| column.name)
        .collect();
    Ok(Read {
        names,
        rows: rows.into_iter().map(|row| row.values).collect(),
    })
}

/// The columns of the file; none where the lines below them cannot be understood.
fn header<'f>(
    line: Line,
    form: &Form<'f>,
    problems: &mut Collector,
) -> Option<Vec<Option<&'f Column>>> {
    let fields = problems.names(line)?;
    let mut columns: Vec<Option<&Column>> = Vec::new();
    for field in fields {
        let known = form.columns.iter().find(|column| column.name == field.text);
        if known.is_none() {
            problems.value(line, field, field.text, || unknown(field.text, form));
        } else if columns
            .iter()
            .flatten()
            .any(|column| column.name == field.text)
        {
            problems.value(line, field, field.text, || {
                Complaint::new(
                    "this column stands here twice",
                    "each column once",
                    "remove one of them",
                )
            });
        }
        columns.push(known);
    }
    for names in form.required {
        let there = || {
            columns
                .iter()
                .flatten()
                .filter(|column| names.contains(&column.name))
        };
        // A name that is not known may be the misspelt one.
        if there().next().is_none() && columns.iter().all(Option::is_some) {
            let message = format!("a column {} is missing", names.join(" or "));
            problems.line(line, names[0], || {
                Complaint::new(message, form.all(), "add it; the unit is in the name")
            });
        } else if let Some(other) =
            there().find(|column| there().any(|first| first.name != column.name))
        {
            let message = format!("{} say the same thing", names.join(" and "));
            problems.line(line, other.name, || {
                Complaint::new(message, "one of them", "remove one of them")
            });
        }
    }
    Some(columns)
}

fn unknown(name: &str, form: &Form) -> Complaint {
    if name.is_empty() {
        return Complaint::new(
            "this column has no name",
            form.all(),
            "remove the comma or name the column",
        );
    }
    let close = near(name, form.columns.iter().map(|column| column.name));
    let hint = if close.is_empty() {
        "remove it or rename it".to_owned()
    } else {
        format!("did you mean {}?", close.join(" or "))
    };
    Complaint::new("there is no such column", form.all(), hint)
}

fn number(line: Line, field: Field, column: &Column, problems: &mut Collector) -> f64 {
    let (message, hint) = match field.text.parse::<f64>() {
        // turns -0 into 0
        Ok(x) if column.low <= x && x <= column.high => return x + 0.0,
        Ok(x) if x.is_finite() => (
            "this value is out of range",
            "the unit is in the column's name",
        ),
        Ok(_) => (
            "this is not a finite number",
            "fill the gap or remove the row",
        ),
        Err(_) if field.text.is_empty() => {
            ("the value is missing", "fill the gap or remove the row")
        }
        Err(_) if field.text.contains(',') => (
            "this is not a number",
            "write a decimal point: 12.5 and not 12,5",
        ),
        Err(_) => (
            "this is not a number",
            "write the bare number; the unit is in the column's name",
        ),
    };
    problems.value(line, field, column.name, || {
        Complaint::new(
            message,
            format!("a number from {} to {}", column.low, column.high),
            hint,
        )
    });
    f64::NAN
}

/// Looks for combinations of the axes' values that stand twice, or never. What the file says is repeated in its own units.
fn full(form: &Form, columns: &[Option<&Column>], rows: &[Row], problems: &mut Collector) {
    let Some((value, _)) = form.columns.split_last() else {
        return;
    };
    let axes: Vec<(usize, &str)> = columns
        .iter()
        .enumerate()
        .filter_map(|(k, column)| column.filter(|c| c.name != value.name).map(|c| (k, c.name)))
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
                Complaint::new(message, "each combination once", "remove one of them")
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
    problems.file(Complaint::new(
        message,
        format!("a row for every combination of {}", words(&axes)),
        hint,
    ));
}

fn words(axes: &[(usize, &str)]) -> String {
    axes.iter()
        .map(|(_, name)| *name)
        .collect::<Vec<_>>()
        .join(", ")
}
