//! Cells to numbers in SI.

use std::collections::HashMap;

use super::choose::{Chosen, Reading, Source};
use super::sheet::{Met, Sheet, is_missing, number};
use crate::channel::is_identity;

/// Most values of a column that tells cars or drives apart.
const MAX_VALUES: usize = 200;
/// Most lines of a footer.
const MAX_FOOTER: usize = 20;
/// Most bad lines that are repeated.
const MAX_SHOWN: usize = 3;

/// Channels of the rows that are kept.
#[derive(Debug, Default)]
pub(super) struct Filled {
    /// In the order of [`Chosen`]: times, speeds, others. NaN where a cell has no value; of words their index.
    pub values: Vec<Vec<f64>>,
    /// Number of the line of each row.
    pub lines: Vec<u32>,
    /// Words of channels of words.
    pub words: Vec<String>,
    /// Rows in which a time or each speed has no value.
    pub empty: usize,
    /// Names or units again.
    pub repeated: usize,
    /// Lines behind the last row that are no rows.
    pub footer: usize,
    /// Lines between rows that are none: number and text of the first.
    pub other: Vec<(usize, String)>,
    pub others: usize,
    /// Values of columns that tell cars or drives apart, with the number of rows of each.
    pub identities: Vec<(usize, Vec<(String, usize)>)>,
    /// Columns of clocks: the last stamp of each, and the seconds after which it began again.
    clocks: Vec<(usize, f64, f64)>,
}

impl Filled {
    /// True if a clock began again, as over midnight.
    pub(super) fn begins_again(&self) -> bool {
        self.clocks.iter().any(|(_, _, shift_s)| *shift_s > 0.0)
    }

    pub(super) fn of(sheet: &Sheet<'_>, chosen: &Chosen) -> Filled {
        let sources: Vec<&Source> = chosen
            .times
            .iter()
            .chain(&chosen.speeds)
            .chain(&chosen.others)
            .collect();
        let (times, needed) = (chosen.times.len(), chosen.times.len() + chosen.speeds.len());
        let mut filled = Filled {
            values: vec![Vec::new(); sources.len()],
            ..Filled::default()
        };
        let is_filtered = |column: &usize| chosen.filters.iter().any(|(own, _)| own == column);
        let identities = (0..sheet.names.len().min(sheet.width))
            .filter(|column| is_identity(&sheet.names[*column]) && !is_filtered(column));
        let mut identities: Vec<(usize, HashMap<String, usize>)> =
            identities.map(|column| (column, HashMap::new())).collect();
        let mut row = vec![f64::NAN; sources.len()];
        let mut pending: Vec<(usize, String)> = Vec::new();
        let mut pending_count = 0;
        sheet.lines(|line, text, met| {
            let mut bad = |filled: &mut Filled| {
                let _ = &filled;
                pending_count += 1;
                if pending.len() < MAX_SHOWN {
                    pending.push((line, text.chars().take(80).collect()));
                }
            };
            let fields = match met {
                Met::Row(fields) => fields,
                Met::Head => {
                    filled.repeated += 1;
                    return;
                }
                Met::Other => return bad(&mut filled),
            };
            let cell = |column: usize| Sheet::text_of(text, fields[column]);
            if !chosen
                .filters
                .iter()
                .all(|(column, value)| cell(*column) == value)
            {
                return;
            }
            for (k, source) in sources.iter().enumerate() {
                row[k] = match &source.only {
                    Some((column, word)) if cell(*column) != word => f64::NAN,
                    _ => match filled.value(cell(source.column), source, sheet) {
                        Some(value) => value,
                        None if k < needed => return bad(&mut filled),
                        None => f64::NAN,
                    },
                };
            }
            if pending_count > 0 {
                filled.others += pending_count;
                let room = MAX_SHOWN.saturating_sub(filled.other.len());
                filled.other.extend(pending.drain(..).take(room));
                pending_count = 0;
            }
            let has_none = row[..times].iter().all(|value| value.is_nan())
                || row[times..needed].iter().all(|value| value.is_nan());
            if needed > 0 && has_none {
                let by_choice = sources.iter().any(|source| source.only.is_some());
                filled.empty += usize::from(!by_choice);
                return;
            }
            // In a table of names and values the other rows have numbers of their own.
            for (column, values) in &mut identities {
                if values.len() < MAX_VALUES && !is_missing(cell(*column)) {
                    *values.entry(cell(*column).to_owned()).or_default() += 1;
                }
            }
            for (values, value) in filled.values.iter_mut().zip(&row) {
                values.push(*value);
            }
            filled.lines.push(u32::try_from(line).unwrap_or(u32::MAX));
        });
        // A footer has some lines; more of them are rows that are not understood.
        match pending_count > MAX_FOOTER {
            true => {
                filled.others += pending_count;
                filled.other.append(&mut pending);
            }
            false => filled.footer = pending_count,
        }
        filled.identities = identities
            .into_iter()
            // A column with a value of its own in most rows numbers the rows.
            .filter(|(_, values)| {
                values.len() > 1
                    && values.len() < MAX_VALUES
                    && values.values().sum::<usize>() >= 5 * values.len()
            })
            .map(|(column, values)| {
                let mut values: Vec<(String, usize)> = values.into_iter().collect();
                values.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
                (column, values)
            })
            .collect();
        filled
    }

    /// Number of a cell; NaN where it has no value, none where it is something else.
    fn value(&mut self, cell: &str, source: &Source, sheet: &Sheet<'_>) -> Option<f64> {
        if is_missing(cell) {
            return Some(f64::NAN);
        }
        match source.reading {
            Reading::Number(unit) => {
                number(cell, sheet.decimal_comma).map(|number| unit.si(number))
            }
            Reading::Stamp(form) => {
                let seconds = form.seconds(cell)?;
                let known = self
                    .clocks
                    .iter()
                    .position(|(column, _, _)| *column == source.column);
                let known = known.unwrap_or_else(|| {
                    self.clocks.push((source.column, seconds, 0.0));
                    self.clocks.len() - 1
                });
                let (_, before, shift_s) = &mut self.clocks[known];
                *shift_s += form.began_again_s(*before, seconds);
                *before = seconds;
                Some(seconds + *shift_s)
            }
            Reading::Word => {
                let known = self.words.iter().position(|word| word == cell);
                Some(known.unwrap_or_else(|| {
                    self.words.push(cell.to_owned());
                    self.words.len() - 1
                }) as f64)
            }
        }
    }
}

/// Columns by whose values the time rises, where it does not over all rows: cars or drives one among the other. `is_strict`: each stamp once.
pub(super) fn telling(
    sheet: &Sheet<'_>,
    time: &Source,
    is_strict: bool,
) -> Option<(usize, Vec<(String, usize)>)> {
    let mut columns: Vec<Option<HashMap<String, (f64, usize)>>> =
        vec![Some(HashMap::new()); sheet.width];
    columns[time.column] = None;
    let mut reader = Filled::default();
    sheet.lines(|_, text, met| {
        let Met::Row(fields) = met else { return };
        let at = reader.value(Sheet::text_of(text, fields[time.column]), time, sheet);
        let Some(at) = at.filter(|at| at.is_finite()) else {
            return;
        };
        for (column, values) in columns.iter_mut().enumerate() {
            let Some(known) = values else { continue };
            let cell = Sheet::text_of(text, fields[column]);
            if cell
                .parse::<f64>()
                .is_ok_and(|number| number.fract() != 0.0)
                || known.len() > MAX_VALUES
            {
                *values = None;
                continue;
            }
            let (last, rows) = known
                .entry(cell.to_owned())
                .or_insert((f64::NEG_INFINITY, 0));
            if at < *last || is_strict && at <= *last {
                *values = None;
                continue;
            }
            (*last, *rows) = (at, *rows + 1);
        }
    });
    let found = columns
        .into_iter()
        .enumerate()
        .filter_map(|(column, values)| Some((column, values?)));
    // Each has several rows; a name that says so goes first, then the fewest values.
    let found =
        found.filter(|(_, values)| values.len() > 1 && values.values().all(|(_, rows)| *rows > 1));
    let name = |column: usize| sheet.names.get(column).map_or("", String::as_str);
    let (column, values) =
        found.min_by_key(|(column, values)| (!is_identity(name(*column)), values.len()))?;
    let mut values: Vec<(String, usize)> = values
        .into_iter()
        .map(|(word, (_, rows))| (word, rows))
        .collect();
    values.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    Some((column, values))
}
