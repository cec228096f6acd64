//! A map as a matrix: a column for each value of an axis.
//!
//! The name of the column before them has three names of the long form, `input_speed_rpm/input_torque_nm/torque_loss_nm`: what is in that column,
//! what the names behind it are, what is in the cells. Columns before it are axes as in the long form.

use std::borrow::Cow;

use crate::Problem;
use crate::csv::{self, Cells, Collector, Column, Line, Schema};

/// A row with its line.
pub(super) struct Row<'t> {
    pub line: Line<'t>,
    pub values: Vec<f64>,
}

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
}

impl Wide {
    /// The form of a file's matrix; none where it is none.
    pub fn detect(long: &Schema, bytes: &[u8]) -> Option<Wide> {
        let is_named = long.named.as_ref().is_some_and(|named| !named.is_empty());
        let names = csv::first_names(bytes);
        let corner = names.iter().position(|name| name.contains('/'))?;
        let place = |name: &str| long.columns.iter().position(|own| own.name == name.trim());
        let parts: Option<Vec<usize>> = names[corner].split('/').map(place).collect();
        let &[down, across, value] = parts?.as_slice() else {
            return None;
        };
        let number = |name: &String| name.replacen(',', ".", 1).parse::<f64>().ok();
        let heads: Option<Vec<f64>> = names[corner + 1..].iter().map(number).collect();
        let heads = heads.filter(|heads| !heads.is_empty() && !is_named)?;
        let mut columns = vec![Column {
            name: Cow::Owned(names[corner].clone()),
            group: "",
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
        for name in &names[corner + 1..] {
            columns.push(Column {
                name: Cow::Owned(name.clone()),
                group: "",
                required: true,
                ..long.columns[value].clone()
            });
        }
        Some(Wide {
            schema: Schema {
                columns,
                max_values: long.max_rows.0,
                ..long.clone()
            },
            axes,
            across,
            value,
            heads: heads.into_iter().zip(first..).collect(),
        })
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
                    rows.push(Row {
                        line: row.line,
                        values: values.into_iter().map(|(_, x)| x).collect(),
                    });
                }
                true
            },
        );
        (columns, rows)
    }
}
