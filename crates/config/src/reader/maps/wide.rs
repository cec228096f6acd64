//! A map as a matrix: a column for each value of an axis.
//!
//! The name of the column before them says what is in that column, what the names behind it are, and what is in the cells:
//! `input_speed_rpm/input_torque_nm/torque_loss_nm`, or as people write it, `rpm\Nm`. A title above may say what is in the cells, and the user may say
//! all three. Columns before it are axes as in the long form.

use std::borrow::Cow;

use super::fuel;
use super::row::{Row, is_value};
use crate::Problem;
use crate::csv::{self, Cells, Collector, Column, Schema};

/// Least number of columns of a matrix whose corner has no names of the long form.
const LEAST_HEADS: usize = 2;

/// How a matrix is read.
pub(super) struct Wide {
    /// Columns of the file.
    schema: Schema,
    /// For each of the file's columns up to the corner its place in the schema of the long form.
    axes: Vec<(usize, usize)>,
    /// Place of what the names of the other columns are, and of what is in the cells.
    across: usize,
    value: usize,
    /// These names as numbers, each with the place of its column.
    heads: Vec<(f64, usize)>,
    /// How the matrix is read, in words, where its corner does not say it as the program's own do.
    pub read_as: Option<String>,
}

/// Columns of the schema in the first column of a matrix, across it, and in its cells.
type Meaning = [usize; 3];

impl Wide {
    /// The form of a file's matrix; none where it is none, a problem where it is one that can be read in several ways.
    pub fn detect(long: &Schema, bytes: &[u8], is_fuel: bool) -> Option<Result<Wide, Problem>> {
        let lines = csv::first_fields(bytes);
        let (title, names, rows) = match lines.as_slice() {
            [first, rest @ ..] if is_matrix(first).is_some() => (None, first, rest),
            [first, second, rest @ ..] if is_title(first) && is_matrix(second).is_some() => {
                (first.iter().find(|text| !text.is_empty()), second, rest)
            }
            _ => return None,
        };
        let corner = is_matrix(names)?;
        let heads: Vec<f64> = names[corner + 1..]
            .iter()
            .filter_map(|name| number(name))
            .collect();
        let own = three_names(long, &names[corner]);
        let (meaning, read_as) = match own {
            Some(meaning) if long.named.as_ref().is_none_or(csv::Columns::is_empty) => {
                (meaning, None)
            }
            _ if heads.len() < LEAST_HEADS => return None,
            _ => {
                let matrix = Matrix {
                    long,
                    corner: &names[corner],
                    title: title.map(String::as_str),
                    heads: &heads,
                    down: rows
                        .iter()
                        .filter_map(|row| number(row.get(corner)?))
                        .collect(),
                    cells: rows
                        .iter()
                        .map(|row| {
                            row.iter()
                                .skip(corner + 1)
                                .map(|cell| number(cell).unwrap_or(f64::NAN))
                                .collect()
                        })
                        .collect(),
                    is_fuel,
                };
                match matrix.meaning() {
                    Ok(meaning) => {
                        let [down, across, value] = meaning.map(|k| &*long.columns[k].name);
                        let words = format!("a matrix of {value}, {down} down and {across} across");
                        (meaning, Some(words))
                    }
                    Err(problem) => return Some(Err(problem)),
                }
            }
        };
        let heads = names[corner + 1..]
            .iter()
            .filter_map(|name| Some((name, number(name)?)));
        let wide = Wide::new(long, &names[corner], heads.collect(), meaning);
        Some(Ok(Wide { read_as, ..wide }))
    }

    fn new(
        long: &Schema,
        corner: &str,
        names: Vec<(&String, f64)>,
        [down, across, value]: Meaning,
    ) -> Wide {
        let mut columns = vec![Column {
            name: Cow::Owned(corner.to_owned()),
            group: "",
            is_alias: false,
            ..long.columns[down].clone()
        }];
        let mut axes = vec![(0, down)];
        let used = [down, across, value].map(|k| &long.columns[k]);
        for (k, own) in long.columns.iter().enumerate() {
            if !used.iter().any(|other| own.is_same(other)) {
                axes.push((columns.len(), k));
                columns.push(own.clone());
            }
        }
        let first = columns.len();
        for (name, _) in &names {
            columns.push(Column {
                name: Cow::Owned((*name).clone()),
                group: "",
                required: true,
                is_alias: false,
                ..long.columns[value].clone()
            });
        }
        Wide {
            schema: Schema {
                columns,
                max_values: long.max_rows.0,
                named: None,
                ..long.clone()
            },
            axes,
            across,
            value,
            heads: names.iter().map(|(_, head)| *head).zip(first..).collect(),
            read_as: None,
        }
    }

    /// The rows in the long form, and the places of their values in its schema.
    pub fn read<'t>(
        &self,
        long: &Schema,
        bytes: &'t [u8],
        problems: &mut Collector<'_>,
    ) -> (Vec<usize>, Vec<Row<'t>>) {
        let across = &long.columns[self.across];
        if let Cells::Number(range) = across.cells {
            for (head, k) in self.heads.iter().filter(|(head, _)| !range.contains(*head)) {
                let text = &self.schema.columns[*k].name;
                let message = format!("the column {text} is {head} as {}", across.name);
                problems.file(
                    Problem::out_of_range(message)
                        .allowed(range.in_unit(""))
                        .hint("correct the name of the column"),
                );
            }
        }
        let mut rows = Vec::new();
        let mut columns: Vec<usize> = Vec::new();
        csv::read(
            bytes,
            &self.schema,
            problems,
            |_, _, _| {},
            |row, _| {
                let axes = self.axes.iter().filter(|(k, _)| row.table().has(*k));
                let axes: Vec<(usize, f64)> = axes
                    .map(|(k, place)| (*place, row.number(*k).unwrap_or(f64::NAN)))
                    .collect();
                for (head, k) in &self.heads {
                    let cell = row.number(*k).unwrap_or(f64::NAN);
                    let mut values = axes.clone();
                    values.extend([(self.across, *head), (self.value, cell)]);
                    values.sort_by_key(|(place, _)| *place);
                    columns = values.iter().map(|(place, _)| *place).collect();
                    // A cell without a value is a hole, or has its problem.
                    if cell.is_finite() || row.is_bad(*k) {
                        rows.push(Row {
                            line: row.line,
                            values: values.into_iter().map(|(_, x)| x).collect(),
                        });
                    }
                }
                true
            },
        );
        (columns, rows)
    }
}

/// A number with a decimal point or comma; the names of what is none are no numbers.
fn number(text: &str) -> Option<f64> {
    let found = text.trim().replacen(',', ".", 1).parse::<f64>().ok();
    found.filter(|x| x.is_finite())
}

/// Place of the corner in the names of a matrix: the last one that is no number.
fn is_matrix(names: &[String]) -> Option<usize> {
    let corner = names.iter().rposition(|name| number(name).is_none())?;
    (corner + 1 < names.len()).then_some(corner)
}

/// True of a line with one text, which is no number.
fn is_title(fields: &[String]) -> bool {
    let mut filled = fields.iter().filter(|text| !text.is_empty());
    filled.next().is_some_and(|text| number(text).is_none()) && filled.next().is_none()
}

/// The meaning of a corner with three names of the schema.
fn three_names(long: &Schema, corner: &str) -> Option<Meaning> {
    let place = |name: &str| long.columns.iter().position(|own| own.name == name.trim());
    let parts: Option<Vec<usize>> = corner.split('/').map(place).collect();
    <Meaning>::try_from(parts?).ok()
}

/// A matrix as it is written.
struct Matrix<'m> {
    long: &'m Schema,
    corner: &'m str,
    title: Option<&'m str>,
    heads: &'m [f64],
    down: Vec<f64>,
    cells: Vec<Vec<f64>>,
    is_fuel: bool,
}

impl Matrix<'_> {
    /// Meaning of its parts: said by the user, by its corner and title, or by what an engine can be.
    fn meaning(&self) -> Result<Meaning, Problem> {
        if let Some(named) = self.long.named.as_ref().filter(|named| !named.is_empty()) {
            let places = named.in_order(self.long)?;
            let fits = <Meaning>::try_from(places)
                .ok()
                .filter(|_| named.are_in_order());
            return fits
                .ok_or_else(|| self.unclear("the columns of a matrix are three, without names"));
        }
        let parts = self.parts();
        let value_of = |part: usize| self.is_value(part).then_some(part);
        let title = self
            .title
            .and_then(|title| self.long.column_of(title))
            .and_then(value_of);
        let (axes, value) = match parts.as_slice() {
            [down, across, value] if self.is_value(*value) => ([*down, *across], Some(*value)),
            [down, across] => ([*down, *across], title),
            _ => {
                return Err(
                    self.unclear("a matrix says in its first name what its rows and columns are")
                );
            }
        };
        if self.is_value(axes[0])
            || self.is_value(axes[1])
            || self.long.columns[axes[0]].is_same(&self.long.columns[axes[1]])
        {
            return Err(
                self.unclear("the rows and columns of this matrix are not two axes of the map")
            );
        }
        let axes = match self.is_fuel {
            true => {
                let in_order = fuel::speed_is_first(axes, [&self.down, self.heads]);
                let is_first = fuel::gives(axes[0]) == fuel::Gives::Speed;
                // By the numbers the first axis may be that across.
                match in_order {
                    Some(speed_down) if speed_down != is_first => [axes[1], axes[0]],
                    _ => axes,
                }
            }
            false => axes,
        };
        match value {
            Some(value) => Ok([axes[0], axes[1], value]),
            None if self.is_fuel => self.likely(axes),
            None => Err(self.unclear("nothing says what is in the cells of this matrix")),
        }
    }

    /// The columns that the corner names.
    fn parts(&self) -> Vec<usize> {
        let by_sign = ['\\', '|']
            .into_iter()
            .find(|sign| self.corner.contains(*sign));
        let texts: Vec<String> = match by_sign {
            Some(sign) => self.corner.split(sign).map(str::to_owned).collect(),
            None => self.corner.split('/').map(str::to_owned).collect(),
        };
        // The sign may be part of a unit: as many neighbours are joined as have a meaning together.
        let mut parts = Vec::new();
        let mut at = 0;
        while at < texts.len() {
            let longest = (at + 1..=texts.len().min(at + 3)).rev().find_map(|end| {
                let text = texts[at..end].join("/");
                Some((self.long.column_of(&text)?, end))
            });
            let Some((column, end)) = longest else {
                return Vec::new();
            };
            parts.push(column);
            at = end;
        }
        parts
    }

    /// The only quantity and unit that the cells can have in an engine.
    fn likely(&self, axes: [usize; 2]) -> Result<Meaning, Problem> {
        let speed_down = fuel::gives(axes[0]) == fuel::Gives::Speed;
        let in_order = match speed_down {
            true => axes,
            false => [axes[1], axes[0]],
        };
        let mut rows = Vec::new();
        for (down, cells) in self.down.iter().zip(&self.cells) {
            for (across, cell) in self.heads.iter().zip(cells) {
                let (speed, load) = match speed_down {
                    true => (*down, *across),
                    false => (*across, *down),
                };
                rows.push([speed, load, *cell]);
            }
        }
        let likely = fuel::likely(in_order, &rows);
        let place = |name: &str| self.long.columns.iter().position(|own| own.name == name);
        match likely.as_slice() {
            [only] => match place(only) {
                Some(value) => Ok([axes[0], axes[1], value]),
                None => Err(self.unclear("nothing says what is in the cells of this matrix")),
            },
            [] => Err(self.unclear("nothing says what is in the cells of this matrix, and in no unit do they make an engine")),
            several => Err(self.unclear(&format!(
                "nothing says what is in the cells of this matrix: they may be {}",
                several.join(" or ")
            ))),
        }
    }

    fn is_value(&self, column: usize) -> bool {
        is_value(self.long, column)
    }

    /// The problem of a matrix that can be read in several ways.
    fn unclear(&self, message: &str) -> Problem {
        let example = match self.is_fuel {
            true => "KEY = { value = \"FILE\", columns = \"speed:rpm,torque:Nm,bsfc:g/kWh\" }",
            false => {
                "KEY = { value = \"FILE\", columns = \"input_speed:rpm,input_torque:Nm,torque_loss:Nm\" }"
            }
        };
        let corner = match self.corner.is_empty() {
            true => "its first name is empty".to_owned(),
            false => format!("its first name is `{}`", self.corner),
        };
        Problem::missing(format!("{message} ({corner})"))
            .allowed("what is down, across and in the cells, each with its unit")
            .hint(format!("say it in this order: {example}"))
    }
}
