//! Layout of a table in text: the sign between columns, what is above the rows and below them, names and units.

use std::collections::HashMap;

use super::stamp::Form;
use crate::channel::Quantity;
use crate::csv::{Field, split};

/// Lines at the beginning in which the layout is looked for.
const SAMPLE: usize = 400;
/// Lines at the end that show how stamps go on.
const TAIL: usize = 20;
/// Rows that must follow each other to be the beginning of the rows.
const FOLLOWING: usize = 3;
/// Most lines between names and rows: units and second names.
const MAX_HEAD: usize = 4;
/// Most lines between these and the rows.
const MAX_BETWEEN: usize = 3;
/// No table has as many columns.
const MAX_COLUMNS: usize = 2000;

/// Sign between columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    Sign(char),
    /// Any number of blanks.
    Blanks,
}

/// In the order in which they are preferred where several fit as well.
const SEPARATORS: [(Separator, &str); 5] = [
    (Separator::Sign('\t'), "tabs"),
    (Separator::Sign(';'), "semicolons"),
    (Separator::Sign('|'), "bars"),
    (Separator::Sign(','), "commas"),
    (Separator::Blanks, "blanks"),
];

impl Separator {
    /// Fields of a line; false where a quote is not closed.
    pub(super) fn split(self, line: &str, fields: &mut Vec<Field>) -> bool {
        match self {
            Separator::Sign(sign) => split(line, sign, fields).is_ok(),
            Separator::Blanks => {
                fields.clear();
                let start = |part: &str| part.as_ptr() as usize - line.as_ptr() as usize;
                fields.extend(line.split_whitespace().map(|part| Field {
                    start: start(part),
                    end: start(part) + part.len(),
                }));
                true
            }
        }
    }

    fn cells(self, line: &str) -> Option<Vec<&str>> {
        let mut fields = Vec::new();
        self.split(line, &mut fields).then(|| {
            fields
                .iter()
                .map(|field| &line[field.start..field.end])
                .collect()
        })
    }
}

/// A cell without a value, as instruments write it.
pub(super) fn is_missing(cell: &str) -> bool {
    const WORDS: [&str; 26] = [
        "<na>",
        "nat",
        "err",
        "error",
        "#err",
        "#error",
        "#value!",
        "#ref!",
        "#num!",
        "#div/0!",
        "#name?",
        "no_data",
        "invalid",
        "timeout",
        "inf",
        "-inf",
        "nan",
        "n/a",
        "na",
        "null",
        "none",
        "no data",
        "nodata",
        "#n/a",
        "nil",
        "not available",
    ];
    cell.chars().all(|c| "-–—?*∞ ".contains(c))
        || cell.len() <= 13 && !cell.is_empty() && WORDS.contains(&cell.to_lowercase().as_str())
}

/// Number of a cell.
pub(super) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let number = match decimal_comma && !cell.contains('.') {
        true => cell.replacen(',', ".", 1).parse::<f64>(),
        false => cell.parse::<f64>(),
    };
    number.ok().filter(|number| number.is_finite())
}

/// A comment, of scripts of MATLAB too.
fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%'])
}

fn is_value(cell: &str) -> bool {
    number(cell, true).is_some() || Form::of(cell).is_some()
}

/// Layout of a table.
#[derive(Debug)]
pub(super) struct Sheet<'t> {
    text: &'t str,
    pub separator: Separator,
    /// True where numbers have decimal commas.
    pub decimal_comma: bool,
    /// Names of the columns; empty where there are none.
    pub names: Vec<String>,
    /// Unit of each column in a row of its own; empty where there is none.
    pub units: Vec<String>,
    /// Number of columns.
    pub width: usize,
    /// Number of the first line of the rows, from 0.
    first: usize,
    /// Lines above the rows that occur again between them.
    head: Vec<&'t str>,
    /// How it was read, in words.
    pub read_as: Vec<String>,
    /// Cells of the first rows.
    pub sample: Vec<Vec<&'t str>>,
    /// Cells of the last rows.
    pub tail: Vec<Vec<&'t str>>,
}

/// First columns of a trace of this program.
const TRACE: [&str; 5] = ["time_s", "dt_s", "phase", "speed_kmh", "accel_m_s2"];

/// A line as the reader meets it.
pub(super) enum Met<'f> {
    Row(&'f [Field]),
    /// Names or units again.
    Head,
    /// No row.
    Other,
}

impl<'t> Sheet<'t> {
    /// Finds the layout; none where no two columns can be distinguished.
    pub(super) fn find(text: &'t str) -> Option<Sheet<'t>> {
        let lines: Vec<(usize, &str)> = text
            .lines()
            .enumerate()
            .filter(|(_, line)| !line.trim().is_empty())
            .take(SAMPLE)
            .collect();
        let (separator, word, width) = separator(&lines)?;
        let cells: Vec<Option<Vec<&'t str>>> = lines
            .iter()
            .map(|(_, line)| separator.cells(line))
            .collect();
        let fits = |cells: &Option<Vec<&'t str>>| {
            cells
                .as_ref()
                .is_some_and(|cells| trimmed(cells, width).len() == width)
        };
        let is_row = |cells: &Option<Vec<&'t str>>| {
            fits(cells) && cells.iter().flatten().any(|cell| is_value(cell))
        };
        let begins = |k: &usize| {
            let next = &cells[*k..cells.len().min(*k + FOLLOWING)];
            !is_comment(lines[*k].1)
                && next.iter().all(is_row)
                && (next.len() == FOLLOWING || *k + next.len() == cells.len())
        };
        let first = (0..lines.len()).find(begins)?;
        // A line such as [Data] may stand between names and rows; a comment has no names.
        let has_head = |k: &usize| fits(&cells[*k]) && !is_comment(lines[*k].1);
        let is_between = |k: &usize| !has_head(k);
        let above = |first: usize| -> Vec<usize> {
            let between = (0..first).rev().take_while(is_between).count();
            let from = match between <= MAX_BETWEEN {
                true => first - between,
                false => first,
            };
            let above = (0..from).rev().take_while(has_head).take(MAX_HEAD);
            let above: Vec<usize> = above.collect();
            above.into_iter().rev().collect()
        };
        let names_both = |k: usize| {
            let names = cells[k].as_deref().unwrap_or_default();
            let has = |wanted| {
                names
                    .iter()
                    .any(|name| Quantity::of_name(name) == Some(wanted))
            };
            has(Quantity::Time) && has(Quantity::Speed)
        };
        // A preamble of as many columns, with numbers in it, looks like rows: the line that names a time and a speed ends it.
        let later = || {
            let is_head = |k: &usize| {
                has_head(k)
                    && names_both(*k)
                    && !cells[*k].iter().flatten().any(|cell| is_value(cell))
            };
            let head = (first + 1..lines.len()).find(is_head)?;
            (head + 1..lines.len().min(head + 2 + MAX_BETWEEN)).find(begins)
        };
        let first = match above(first).into_iter().any(names_both) {
            true => first,
            false => later().unwrap_or(first),
        };
        let above = above(first);
        let rows = above.iter().filter_map(|k| cells[*k].clone());
        let head = Head::of(&rows.collect::<Vec<_>>(), width);
        let mut read_as = Vec::new();
        if separator != Separator::Sign(',') {
            read_as.push(word.to_owned());
        }
        let sample = cells[first..].iter().filter(|cells| fits(cells)).flatten();
        let sample: Vec<Vec<&str>> = sample.map(|cells| trimmed(cells, width).to_vec()).collect();
        let decimal_comma = decimal_comma(separator, &sample)?;
        if decimal_comma {
            read_as.push("decimal commas".to_owned());
        }
        let used = above.len();
        if first > used {
            read_as.push(match first - used {
                1 => "a line above the names".to_owned(),
                n => format!("{n} lines above the names"),
            });
        }
        read_as.extend(head.words());
        let script = named_by_script(&lines[..first], width);
        let names = script.unwrap_or(head.names);
        let tail = last_rows(text, separator, width);
        Some(Sheet {
            text,
            separator,
            decimal_comma,
            names,
            units: head.units,
            width,
            first: lines[first].0,
            head: above.iter().map(|k| lines[*k].1).collect(),
            read_as,
            sample,
            tail,
        })
    }

    /// True of a trace of this program, whose rows are means over the steps that end at their times.
    pub(super) fn is_trace(&self) -> bool {
        self.names
            .iter()
            .map(String::as_str)
            .take(TRACE.len())
            .eq(TRACE)
    }

    /// Calls `take` with the number of each line below the names, counted from 1, its text and its fields. Blank lines and comments are passed over.
    pub(super) fn lines(&self, mut take: impl FnMut(usize, &'t str, Met<'_>)) {
        let mut fields = Vec::new();
        for (number, line) in self.text.lines().enumerate().skip(self.first) {
            let trimmed = line.trim_start();
            if trimmed.is_empty() || is_comment(line) {
                continue;
            }
            let met = if self.head.contains(&line) {
                Met::Head
            } else if !self.separator.split(line, &mut fields) {
                Met::Other
            } else {
                if fields.len() == self.width + 1
                    && fields.last().is_some_and(|field| field.start >= field.end)
                {
                    fields.pop();
                }
                match fields.len() == self.width {
                    true => Met::Row(&fields),
                    false => Met::Other,
                }
            };
            take(number + 1, line, met);
        }
    }

    /// Name of a column for people: as it is written, or its number.
    pub(super) fn label(&self, column: usize) -> String {
        match self.names.get(column) {
            Some(name) if !name.is_empty() => name.clone(),
            _ => format!("column {}", column + 1),
        }
    }

    /// Text of a field.
    pub(super) fn text_of(line: &'t str, field: Field) -> &'t str {
        line.get(field.start..field.end).unwrap_or_default()
    }
}

/// Cells of the last rows.
fn last_rows(text: &str, separator: Separator, width: usize) -> Vec<Vec<&str>> {
    let lines = text.lines().rev().filter(|line| !line.trim().is_empty());
    let mut rows: Vec<Vec<&str>> = lines
        .take(TAIL)
        .filter_map(|line| separator.cells(line))
        .filter(|cells| trimmed(cells, width).len() == width)
        .map(|cells| trimmed(&cells, width).to_vec())
        .collect();
    rows.reverse();
    rows
}

/// Cells without an empty one behind the last separator.
fn trimmed<'c, 't>(cells: &'c [&'t str], width: usize) -> &'c [&'t str] {
    match cells.last() {
        Some(&"") if cells.len() == width + 1 => &cells[..width],
        _ => cells,
    }
}

/// The sign that cuts most lines into as many cells, of which most have a value; with the number of cells.
fn separator(lines: &[(usize, &str)]) -> Option<(Separator, &'static str, usize)> {
    let mut best: Option<(f64, (Separator, &'static str, usize))> = None;
    for (separator, word) in SEPARATORS {
        let cells: Vec<Vec<&str>> = lines
            .iter()
            .filter(|(_, line)| !is_comment(line))
            .filter_map(|(_, line)| separator.cells(line))
            .collect();
        // A separator behind the last cell makes an empty one in every row.
        let mut counts: HashMap<usize, (usize, usize)> = HashMap::new();
        for cells in &cells {
            let entry = counts.entry(cells.len()).or_default();
            entry.0 += 1;
            entry.1 += usize::from(cells.last() == Some(&""));
        }
        let Some((&count, &(rows, trailing))) = counts
            .iter()
            .max_by_key(|(count, (rows, _))| (*rows, **count))
        else {
            continue;
        };
        // A line of names as long as the rows says that their last cell is one of theirs.
        let has_name = cells.iter().any(|cells| {
            cells.len() == count
                && cells.last() != Some(&"")
                && !cells.iter().any(|cell| is_value(cell))
        });
        let width = count - usize::from(trailing > 0 && 10 * trailing >= 9 * rows && !has_name);
        if !(2..=MAX_COLUMNS).contains(&width) {
            continue;
        }
        let (mut filled, mut values) = (0_usize, 0_usize);
        for cell in cells
            .iter()
            .filter(|cells| cells.len() == count)
            .flatten()
            .filter(|cell| !is_missing(cell))
        {
            filled += 1;
            values += usize::from(is_value(cell));
        }
        let share = rows as f64 / lines.len() as f64 * (0.2 + values as f64 / filled.max(1) as f64);
        if best.is_none_or(|(other, _)| share > 1.02 * other) {
            best = Some((share, (separator, word, width)));
        }
    }
    best.map(|(_, found)| found)
}

/// True where numbers have decimal commas; none where they can be read in two ways.
fn decimal_comma(separator: Separator, sample: &[Vec<&str>]) -> Option<bool> {
    // Between commas only a cell in quotes has one.
    let commas = sample
        .iter()
        .flatten()
        .filter(|cell| cell.parse::<f64>().is_err() && number(cell, true).is_some());
    let mut commas = commas.peekable();
    if commas.peek().is_none() {
        return Some(false);
    }
    // Three figures behind a comma may be thousands.
    let is_sure = |cell: &&str| {
        let (whole, rest) = cell.split_once(',').unwrap_or_default();
        let digits = whole.trim_start_matches(['-', '+']);
        rest.len() != 3 || digits.len() > 3 || digits.starts_with('0')
    };
    match (commas.any(is_sure), separator) {
        (true, _) => Some(true),
        (false, Separator::Sign(',')) => Some(false),
        (false, _) => None,
    }
}

/// Names of the columns of a matrix of time and speed in a script, by the name of the matrix: `cyc_mph = [`.
fn named_by_script(above: &[(usize, &str)], width: usize) -> Option<Vec<String>> {
    let (_, line) = above.last().filter(|_| width == 2)?;
    let (name, rest) = line.split_once('=')?;
    let name = name.trim();
    let is_word = name.chars().all(|c| c.is_alphanumeric() || c == '_');
    (is_word && rest.trim().trim_end_matches('.').trim() == "[").then_some(())?;
    unit_in(Quantity::Speed, name)?;
    Some(vec!["cyc_time_s".to_owned(), name.to_owned()])
}

/// The lines between the preamble and the rows.
#[derive(Default)]
struct Head {
    names: Vec<String>,
    units: Vec<String>,
    has_second: bool,
}

impl Head {
    fn of(lines: &[Vec<&str>], width: usize) -> Head {
        let is_unit = |cell: &&&str| {
            Quantity::ALL
                .iter()
                .any(|(quantity, _)| quantity.unit(cell).is_some())
                || is_bracketed(cell)
        };
        let are_units = |line: &[&str]| {
            let filled = line.iter().filter(|cell| !cell.is_empty()).count();
            // A name that is only a unit, such as KPH next to time_s, is a name.
            let named = line
                .iter()
                .filter(|cell| Quantity::of_name(cell).is_some() && !is_bracketed(cell))
                .count();
            filled > 0 && 2 * line.iter().filter(is_unit).count() >= filled && named < filled
        };
        let known = |line: &[&str]| -> usize {
            let meaning = |cell: &&str| {
                let quantity = Quantity::of_name(cell);
                usize::from(quantity.is_some())
                    + usize::from(quantity.is_some_and(|own| unit_in(own, cell).is_some()))
            };
            line.iter().map(meaning).sum()
        };
        let mut names: Vec<(usize, &[&str])> = Vec::new();
        let mut units = Vec::new();
        for line in lines {
            let line = trimmed(line, width);
            match are_units(line) && !names.is_empty() {
                true if units.is_empty() => {
                    units = line.iter().map(|cell| (*cell).to_owned()).collect()
                }
                true => {}
                false => names.push((known(line), line)),
            }
        }
        let best = names.iter().rev().max_by_key(|(known, _)| *known);
        Head {
            names: best
                .map(|(_, line)| line.iter().map(|cell| (*cell).to_owned()).collect())
                .unwrap_or_default(),
            has_second: names.len() > 1,
            units,
        }
    }

    fn words(&self) -> Vec<String> {
        let words = [
            (self.has_second, "two lines of names"),
            (!self.units.is_empty(), "a row of units"),
            (self.names.is_empty(), "no names"),
        ];
        words
            .iter()
            .filter(|(is, _)| *is)
            .map(|(_, word)| (*word).to_owned())
            .collect()
    }
}

fn is_bracketed(cell: &str) -> bool {
    cell.starts_with(['[', '(']) && cell.ends_with([']', ')'])
}

/// The unit that the name of a channel of this quantity has in it: in brackets, behind a comma, or as its last word.
pub(super) fn unit_in(quantity: Quantity, name: &str) -> Option<crate::channel::Unit> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((_, inner)) = name.rsplit_once(open)
            && let Some(unit) = inner.split(close).next()
        {
            // Empty brackets say nothing; other words in them may be no unit, as in "Speed (OBD)".
            match quantity.unit(unit) {
                Some(unit) => return Some(unit),
                None if name.matches(open).count() == 1
                    && name.ends_with(close)
                    && !unit.trim().is_empty() => {}
                None => {}
            }
        }
    }
    if let Some((_, unit)) = name.rsplit_once(',')
        && let Some(unit) = quantity.unit(unit)
    {
        return Some(unit);
    }
    let bare = crate::channel::bare(name);
    let mut ends = bare.match_indices('_').map(|(at, _)| &bare[at + 1..]);
    let at_end = ends.find_map(|end| quantity.unit(end));
    // A name that is a unit alone, such as KPH or seconds, is of a quantity whose unit no other has.
    at_end.or_else(|| quantity.unit(&bare).filter(|_| bare.len() > 1))
}
