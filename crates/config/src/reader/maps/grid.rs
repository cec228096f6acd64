//! A user's map to a table of numbers, or to all that is wrong with it.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use super::box_script;
use super::fuel::{self, Unread};
use super::loads::{Doubled, Loads};
use super::row::{Row, is_value};
use super::script::{Matrix, Script};
use super::wide::Wide;
use crate::csv::{self, Collector, Column, Columns, Line, Schema};
use crate::{Argument, Problem, Problems};
use cvtcycle_model::maps::Swept;

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

/// A table as it was read.
pub(super) struct Rows {
    /// Indices of its columns in the schema.
    pub columns: Vec<usize>,
    /// Rows in the units of the columns, each with its line in the file.
    pub rows: Vec<(usize, Vec<f64>)>,
    /// Swept volumes that a load gives which the file says twice.
    pub swept: Vec<Swept>,
    /// How it was read, in words, where it is not written as the program's own are.
    pub read_as: Option<String>,
}

/// Purpose of a file.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'w> {
    pub schema: &'w Schema,
    pub rules: Rules,
    /// True of a map of fuel.
    pub is_fuel: bool,
}

/// Reads a map as a list, a matrix or a script. The last column of the schema, or another one of its group, is its value; the others span its grid.
///
/// # Errors
/// All problems with line, column and value; after 50 the rest is counted in one last entry.
pub(super) fn read(file: &str, bytes: &[u8], wanted: Wanted<'_>) -> Result<Rows, Problems> {
    let Wanted {
        schema,
        rules,
        is_fuel,
    } = wanted;
    let mut problems = Collector::new(file);
    let is_script = Path::new(file)
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("m"));
    let text = String::from_utf8_lossy(bytes);
    let mut swept = Vec::new();
    let (columns, mut rows, read_as) = if is_script {
        script(schema, &text, is_fuel, &mut problems)
    } else {
        match Wide::detect(schema, bytes, is_fuel) {
            Some(Ok(wide)) => {
                let (columns, rows) = wide.read(schema, bytes, &mut problems);
                (columns, rows, wide.read_as)
            }
            Some(Err(problem)) => {
                problems.file(problem);
                (Vec::new(), Vec::new(), None)
            }
            None => long(schema, bytes, &mut swept, &mut problems),
        }
    };
    if problems.is_empty() {
        full(schema, (&columns, rules.is_grid), &mut rows, &mut problems);
    }
    if let Some(group) = rules.rises_with.filter(|_| problems.is_empty()) {
        rising(schema, (&columns, group), &rows, &mut problems);
    }
    problems.finish().finish()?;
    let rows = rows.into_iter().map(|row| (row.line.number, row.values));
    Ok(Rows {
        columns,
        rows: rows.collect(),
        swept,
        read_as,
    })
}

/// Columns, rows, and how they were read.
type Found<'t> = (Vec<usize>, Vec<Row<'t>>, Option<String>);

/// The table of a script.
fn script<'t>(
    schema: &Schema,
    text: &'t str,
    is_fuel: bool,
    problems: &mut Collector<'_>,
) -> Found<'t> {
    let none = (Vec::new(), Vec::new(), None);
    let script = Script::new(text);
    let lines: Vec<Line<'t>> = (1..)
        .zip(text.lines())
        .map(|(number, text)| Line { number, text })
        .collect();
    let named = schema.named.as_ref().filter(|named| !named.is_empty());
    if let Some(places) = box_script::places(schema) {
        let ratio = named.map(|named| named.by_name(schema));
        let ratio = match ratio {
            Some(Ok(list)) if list.len() == 1 && list[0].1 == places[0] => {
                Some(list[0].0.to_owned())
            }
            _ => None,
        };
        let is_own = named.is_none() || ratio.is_some();
        let found = box_script::from_script(places, &script, &lines, ratio.as_deref());
        match found.filter(|_| is_own) {
            Some(Ok(found)) => return found,
            Some(Err((why, hint))) => {
                unread(&why, &lines, problems, hint);
                return none;
            }
            None => {}
        }
    }
    if let Some(named) = named {
        return match by_names(schema, named, &script, &lines) {
            Ok((columns, rows)) => (columns, rows, Some("a script".to_owned())),
            Err(problem) => {
                problems.add(problem);
                none
            }
        };
    }
    if let Some(found) = full_load(schema, &script, &lines) {
        return found;
    }
    let is_box = box_script::places(schema).is_some();
    let hint = match is_box {
        true => {
            "say which names are meant: KEY = { value = \"FILE\", columns = \"ratio=NAME,speed=NAME:rad/s,torque=NAME:Nm,efficiency=NAME\" }"
        }
        false => {
            "say which names are meant: KEY = { value = \"FILE\", columns = \"speed=NAME:rad/s,torque=NAME:Nm,fuel=NAME:g/s\" }"
        }
    };
    match is_fuel
        .then(|| fuel::from_script(&script, &lines))
        .flatten()
    {
        Some(Ok(found)) => (found.columns, found.rows, Some(found.read_as)),
        Some(Err(why)) => {
            unread(&why, &lines, problems, hint);
            none
        }
        None => {
            let allowed = match is_box {
                true => box_script::NAMES,
                false => fuel::SCRIPT_NAMES,
            };
            problems.file(
                Problem::missing("the script has no table that is known")
                    .allowed(allowed)
                    .hint(hint),
            );
            none
        }
    }
}

/// Reports the reason for which a script is not read.
fn unread(why: &Unread, lines: &[Line<'_>], problems: &mut Collector<'_>, hint: &str) {
    let line = lines.get(why.line.saturating_sub(1)).copied();
    let line = line.unwrap_or(Line {
        number: 1,
        text: "",
    });
    problems.line(line, "", || {
        Problem::conflict(why.why.clone())
            .allowed(why.allowed)
            .hint(hint)
    });
}

/// The full-load line of a script, where the schema is one.
fn full_load<'t>(schema: &Schema, script: &Script, lines: &[Line<'t>]) -> Option<Found<'t>> {
    const NAMES: [[&str; 2]; 3] = [
        ["fc_map_spd", "fc_max_trq"],
        ["*full_throttle_speed_radps", "*full_throttle_torque_Nm"],
        ["eng_max_trq_spd", "eng_max_trq"],
    ];
    let place = |name: &str| schema.columns.iter().position(|own| own.name == name);
    let columns = [place("speed_rad_s")?, place("torque_nm")?];
    let is_line = schema
        .columns
        .iter()
        .all(|own| ["speed", "torque"].contains(&own.group));
    let both = NAMES.iter().filter(|_| is_line).find_map(|names| {
        let [speed, torque] = names.map(|name| script.find(name));
        let ((speed_name, speeds), (torque_name, torques)) = (speed?, torque?);
        let fits = speeds.values.len() == torques.values.len();
        let words = format!("{speed_name} and {torque_name} of a script");
        fits.then_some((speeds, torques, words))
    });
    let (speeds, torques, words) = both?;
    let number = torques.lines.first().copied().unwrap_or(1);
    let line = lines.get(number.saturating_sub(1)).copied();
    let row = |(speed, torque): (&f64, &f64)| Row {
        line: line.unwrap_or(Line { number, text: "" }),
        values: vec![*speed, *torque],
    };
    let rows = speeds.values.iter().zip(&torques.values).map(row);
    Some((columns.to_vec(), rows.collect(), Some(words)))
}

/// The rows of a script whose names the user gives: two vectors and a matrix over them, or vectors of one length.
fn by_names<'t>(
    schema: &Schema,
    named: &Columns,
    script: &Script,
    lines: &[Line<'t>],
) -> Result<(Vec<usize>, Vec<Row<'t>>), Problem> {
    let mut found = Vec::new();
    for (name, column) in named.by_name(schema)? {
        let value = script.value(name).ok_or_else(|| {
            Problem::unknown_name(format!("the script has no value of `{name}`"))
                .at(Argument::Columns)
                .value(name)
                .allowed("a name of the script, or sums and products of them")
        })?;
        found.push((column, value));
    }
    let is_there = |own: &Column| {
        let mut columns = found.iter().map(|(column, _)| &schema.columns[*column]);
        columns.any(|other| other.is_same(own))
    };
    let mut required = schema.columns.iter().filter(|own| own.required);
    if let Some(own) = required.find(|own| !is_there(own)) {
        let same = schema.columns.iter().filter(|other| other.is_same(own));
        let same = same.filter(|other| !other.is_alias);
        let names: Vec<&str> = same.map(|other| &*other.name).collect();
        let names = names.join(" or ");
        return Err(Problem::missing(format!("the columns name no {names}"))
            .at(Argument::Columns)
            .allowed(names)
            .hint("name it too"));
    }
    found.sort_by_key(|(column, _)| *column);
    let columns: Vec<usize> = found.iter().map(|(column, _)| *column).collect();
    let count = found.first().map_or(0, |(_, value)| value.values.len());
    if found.iter().all(|(_, value)| value.values.len() == count) && count > 0 {
        let row = |k: usize| Row {
            line: lines[0],
            values: found.iter().map(|(_, value)| value.values[k]).collect(),
        };
        return Ok((columns, (0..count).map(row).collect()));
    }
    let wrong = |why: String| {
        Problem::conflict(why)
            .at(Argument::Columns)
            .allowed("two vectors and a matrix over them, or vectors of one length")
    };
    let [(a, first), (b, second), (c, map)] = found.as_slice() else {
        let count = |(column, value): &(usize, Matrix)| {
            format!(
                "{} has {} values",
                schema.columns[*column].name,
                value.values.len()
            )
        };
        let counts: Vec<String> = found.iter().map(count).collect();
        return Err(wrong(format!(
            "the names are no table: {}",
            counts.join(", ")
        )));
    };
    fuel::table([first, second, map], [*a, *b, *c], true, lines)
        .map_err(|why| wrong(format!("`{}` {why}", schema.columns[*c].name)))
}

/// The rows of a file with a line for each point.
fn long<'t>(
    schema: &Schema,
    bytes: &'t [u8],
    swept: &mut Vec<Swept>,
    problems: &mut Collector<'_>,
) -> Found<'t> {
    let mut rows = Vec::new();
    let (mut doubled, mut loads) = (Doubled::default(), Loads::default());
    let table = csv::read(
        bytes,
        schema,
        problems,
        |table, names, _| doubled = Doubled::new(table, schema, names),
        |row, _| {
            let indices = 0..schema.columns.len();
            let there = indices.filter(|k| row.table().has(*k));
            let values = there.map(|k| row.number(k).unwrap_or(f64::NAN)).collect();
            let values: Vec<f64> = values;
            // A row without a value is a hole, or has its problem.
            if values.iter().all(|x| x.is_finite()) || row.has_bad() {
                loads.take(row, schema);
                rows.push(Row {
                    line: row.line,
                    values,
                });
            }
            true
        },
    );
    if problems.is_empty() {
        *swept = loads.swept(doubled, problems);
    }
    let read_as = table.as_ref().and_then(|table| table.read_as());
    let read_as = read_as.map(str::to_owned);
    let columns = table.map_or_else(Vec::new, |table| {
        let indices = 0..schema.columns.len();
        indices.filter(|k| table.has(*k)).collect()
    });
    (columns, rows, read_as)
}

/// Looks for combinations of the axes' values that have two rows, or in a grid none. Values are shown in the units of the file. A row that is there
/// twice with the same value is taken once.
fn full(
    schema: &Schema,
    (columns, is_grid): (&[usize], bool),
    rows: &mut Vec<Row>,
    problems: &mut Collector,
) {
    let axes: Vec<(usize, &str)> = columns
        .iter()
        .enumerate()
        .filter(|(_, column)| !is_value(schema, **column) && !schema.columns[**column].is_extra)
        .map(|(k, column)| (k, &*schema.columns[*column].name))
        .collect();
    let mut lines: HashMap<Vec<u64>, usize> = HashMap::new();
    let mut levels: Vec<Vec<f64>> = vec![Vec::new(); axes.len()];
    let mut whole: HashSet<Vec<u64>> = HashSet::new();
    rows.retain(|row| whole.insert(row.values.iter().map(|x| x.to_bits()).collect()));
    for row in &*rows {
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
