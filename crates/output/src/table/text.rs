//! Tables for people: aligned columns without rules, fitted to the terminal, readable by `grep`; or Markdown.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use comfy_table::presets::NOTHING;
use comfy_table::{Cell, CellAlignment, ColumnConstraint, Table, Width};

/// Columns of a line that is not shown in a terminal.
const LINE: usize = 100;
/// Allowed columns of a line: below, no table of numbers fits; above, lines are hard to follow.
const LINES: std::ops::RangeInclusive<usize> = 60..=140;
/// Current width of lines, columns.
static LINE_WIDTH: AtomicUsize = AtomicUsize::new(LINE);
/// Blanks between two columns.
const GAP: usize = 2;
/// Prefix of the lines of an indented table.
const INDENT: &str = "  ";
/// Minimum number of columns in a table of numbers that may continue below itself.
const FOLDED: usize = 3;
/// Lines narrower than this have the text of a last column below its row, indented by `HANG`, if fewer than `TEXT` columns remain for it.
const NARROW: usize = 76;
const HANG: &str = "    ";
const TEXT: usize = 22;

/// Sets the width of all further lines, in columns, clamped to 60 to 140. A program calls it once, for its terminal; the default is 100 columns.
pub fn set_line_width(columns: usize) {
    let columns = columns.clamp(*LINES.start(), *LINES.end());
    LINE_WIDTH.store(columns, Ordering::Relaxed);
}

/// Width of a line, columns.
pub fn line_width() -> usize {
    LINE_WIDTH.load(Ordering::Relaxed)
}

/// Table of texts, row by row.
#[derive(Clone, Debug)]
pub struct TextTable {
    right: Vec<bool>,
    rows: Vec<Vec<String>>,
    indent: &'static str,
    min_widths: Vec<usize>,
}

impl TextTable {
    /// Creates a table with columns aligned right (`r`) or left (`l`).
    ///
    /// ```
    /// use cvtcycle_output::table::TextTable;
    /// let mut table = TextTable::new("lr");
    /// table.row(["belt", "3.25"]);
    /// table.row(["oil pump", "12.50"]);
    /// assert_eq!(table.text(), "belt       3.25\noil pump  12.50\n");
    /// ```
    pub fn new(columns: &str) -> Self {
        TextTable {
            right: columns.bytes().map(|c| c == b'r').collect(),
            rows: Vec::new(),
            indent: "",
            min_widths: Vec::new(),
        }
    }

    /// Indents all lines by two blanks.
    #[must_use]
    pub fn indented(self) -> Self {
        TextTable {
            indent: INDENT,
            ..self
        }
    }

    /// Widens the leading columns to at least these widths, which aligns tables that follow each other.
    #[must_use]
    pub fn min_widths(self, widths: &[usize]) -> Self {
        TextTable {
            min_widths: widths.to_vec(),
            ..self
        }
    }

    /// Adds a row.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// Formats the table for a terminal. If it does not fit, words are wrapped in the widest columns, and a table of numbers continues below
    /// itself; words and numbers are not cut, except keys and paths at their joints.
    pub fn text(&self) -> String {
        self.text_in(line_width() - self.indent.len())
    }

    /// Formats the table; empty if there are no rows below the headings.
    pub(super) fn unless_empty(&self) -> String {
        match self.rows.len() {
            0 | 1 => String::new(),
            _ => self.text(),
        }
    }

    /// Formats the table for a width.
    fn text_in(&self, width: usize) -> String {
        if self.goes_below(width) {
            return self.with_text_below(width);
        }
        match self.fitting(width) {
            Some(columns) => {
                let first = self.part(0..columns).text_in(width);
                let rest = self.part(columns..self.right.len()).text_in(width);
                first + "\n" + &rest
            }
            None => self.lines(width),
        }
    }

    /// Number of leading columns that fit a width; `None` if all fit, or the table is not one of numbers.
    fn fitting(&self, width: usize) -> Option<usize> {
        let numbers = self.right.iter().filter(|right| **right).count();
        let mut end = 0;
        let fits = (0..self.right.len()).take_while(|column| {
            end += self.longest_word(*column) + if *column > 0 { GAP } else { 0 };
            end <= width
        });
        // At least the first column and one other are shown.
        let fitting = fits.count().max(2);
        (numbers >= FOLDED && fitting < self.right.len()).then_some(fitting)
    }

    /// True if a narrow line cannot fit the texts of the last column next to the others.
    fn goes_below(&self, width: usize) -> bool {
        let last = self.right.len().saturating_sub(1);
        if width >= NARROW || last < 2 || self.right[last] || self.fitting(width).is_some() {
            return false;
        }
        let room = width - last * GAP;
        let widths = self.widths(room);
        let squeezed = widths[last] < TEXT && self.widest(last, characters) > widths[last];
        squeezed || widths.iter().sum::<usize>() > room
    }

    /// Formats the table with the text of the last column below its row, indented.
    fn with_text_below(&self, width: usize) -> String {
        let last = self.right.len() - 1;
        let before = self.part(0..last);
        let widths = before.widths(width - (last - 1) * GAP);
        let mut text = String::new();
        for (row, cells) in self.rows.iter().zip(&before.rows) {
            text += &before.row_lines(&[cells], &widths);
            let below = row.get(last).map_or("", String::as_str);
            let below = folded(below, width - HANG.len());
            let below = below.lines().filter(|line| !line.is_empty());
            text.extend(below.map(|line| format!("{}{HANG}{line}\n", self.indent)));
        }
        text
    }

    /// Selects some of the columns, after the first, which names the rows.
    fn part(&self, columns: Range<usize>) -> TextTable {
        let taken: Vec<usize> = [0]
            .into_iter()
            .chain(columns.start.max(1)..columns.end)
            .collect();
        let measure = |cells: &Vec<String>| {
            let cells = taken.iter().filter_map(|k| cells.get(*k).cloned());
            cells.collect()
        };
        TextTable {
            right: taken.iter().map(|k| self.right[*k]).collect(),
            rows: self.rows.iter().map(measure).collect(),
            indent: self.indent,
            min_widths: Vec::new(),
        }
    }

    fn lines(&self, width: usize) -> String {
        let last = self.right.len().saturating_sub(1);
        let rows: Vec<&Vec<String>> = self.rows.iter().collect();
        self.row_lines(&rows, &self.widths(width - last * GAP))
    }

    /// Formats some of the rows in columns of these widths.
    fn row_lines(&self, rows: &[&Vec<String>], widths: &[usize]) -> String {
        let mut table = Table::new();
        table.load_style(NOTHING);
        let last = self.right.len().saturating_sub(1);
        for row in rows {
            let cells = row.iter().zip(&self.right).zip(widths);
            let cells = cells.map(|((text, right), width)| match right {
                true => Cell::new(text).set_alignment(CellAlignment::Right),
                false => Cell::new(folded(text, *width)).set_alignment(CellAlignment::Left),
            });
            table.add_row(cells);
        }
        for (k, (column, width)) in table.column_iter_mut().zip(widths).enumerate() {
            let gap = if k == last { 0 } else { GAP };
            column.set_padding((0, gap as u16));
            let width = u16::try_from(*width + gap).unwrap_or(u16::MAX);
            column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
        }
        let lines = table.trim_fmt();
        let lines = lines.lines().map(str::trim_end);
        lines
            .map(|line| format!("{}{line}\n", self.indent))
            .collect()
    }

    /// Widths of the columns: of their contents if they fit; else the widest are narrowed to one width, but no column below its longest word.
    fn widths(&self, room: usize) -> Vec<usize> {
        let columns = 0..self.right.len();
        let own: Vec<usize> = columns.map(|k| self.widest(k, characters)).collect();
        let aligned = own.iter().enumerate().map(|(k, own)| {
            let min = self.min_widths.get(k);
            (*own).max(min.copied().unwrap_or(0))
        });
        let aligned: Vec<usize> = aligned.collect();
        if aligned.iter().sum::<usize>() <= room {
            return aligned;
        }
        let least: Vec<usize> = (0..own.len()).map(|k| self.longest_word(k)).collect();
        let capped = |cap: usize| {
            let narrowed = own.iter().zip(&least);
            narrowed.map(move |(own, least)| (*own).min(cap.max(*least)))
        };
        let caps = (1..=room).rev();
        let cap = caps
            .into_iter()
            .find(|cap| capped(*cap).sum::<usize>() <= room);
        capped(cap.unwrap_or(1)).collect()
    }

    /// Minimum width of a column: its longest word. Numbers with their units, below a right-aligned heading, count as one word.
    fn longest_word(&self, column: usize) -> usize {
        let right = self.right.get(column).copied().unwrap_or(false);
        let words = |text: &str| pieces(text).map(|(_, piece)| piece.chars().count()).max();
        let head = self
            .rows
            .iter()
            .take(1)
            .filter_map(|row| words(row.get(column)?));
        let head = head.max().unwrap_or(0);
        let rest = match right {
            true => self.widest_of(self.rows.iter().skip(1), column, characters),
            false => self.widest(column, |text| words(text).unwrap_or(0)),
        };
        head.max(rest).max(1)
    }

    fn widest(&self, column: usize, measure: impl Fn(&str) -> usize) -> usize {
        self.widest_of(self.rows.iter(), column, measure)
    }

    fn widest_of<'t>(
        &self,
        rows: impl Iterator<Item = &'t Vec<String>>,
        column: usize,
        measure: impl Fn(&str) -> usize,
    ) -> usize {
        let cells = rows.filter_map(|row| row.get(column));
        cells.map(|text| measure(text)).max().unwrap_or(0)
    }
}

/// Number of characters of the longest line of a text.
fn characters(text: &str) -> usize {
    let lines = text.lines().map(|line| line.chars().count());
    lines.max().unwrap_or(0)
}

/// Length from which a word may be split at its joints: keys, paths, lists without blanks.
const LONG_WORD: usize = 16;
/// Ends of the parts of a long word.
const JOINTS: [char; 5] = ['/', '_', ':', '.', ','];

/// Splits a text into words, each with the blank before it; parts of long words have none.
fn pieces(text: &str) -> impl Iterator<Item = (&'static str, &str)> {
    text.split_whitespace().flat_map(|word| {
        let parts: Vec<&str> = match word.chars().count() > LONG_WORD {
            true => word.split_inclusive(JOINTS).collect(),
            false => vec![word],
        };
        let blanks = [" "].into_iter().chain(std::iter::repeat(""));
        blanks.zip(parts)
    })
}

/// Wraps a text to a width, keeping its line breaks. Text that fits is unchanged.
fn folded(text: &str, width: usize) -> String {
    if characters(text) <= width {
        return text.to_owned();
    }
    let fold = |line: &str| {
        let mut lines = vec![String::new()];
        for (blank, piece) in pieces(line) {
            let used = lines.last().map_or(0, |line| line.chars().count());
            match lines.last_mut() {
                Some(line) if used == 0 => line.push_str(piece),
                Some(line) if used + blank.len() + piece.chars().count() <= width => {
                    line.push_str(blank);
                    line.push_str(piece);
                }
                _ => lines.push(piece.to_owned()),
            }
        }
        lines.join("\n")
    };
    let lines: Vec<String> = text.lines().map(fold).collect();
    lines.join("\n")
}

/// Wraps a sentence to the width of the tables, with a mark before its first line.
pub fn wrapped(sentence: &str, mark: &str) -> String {
    let blank = " ".repeat(mark.chars().count());
    let mut table = TextTable::new("l");
    table.row([sentence]);
    let text = table.text_in(line_width() - blank.chars().count());
    let marks = [mark].into_iter().chain(std::iter::repeat(blank.as_str()));
    let lines = text.lines().zip(marks);
    lines
        .map(|(line, mark)| format!("{mark}{line}\n"))
        .collect()
}

/// Wraps each line to the line width; continuation lines keep its indentation.
pub fn paragraphs(text: &str) -> String {
    let wrap = |line: &str| {
        let blank = line.len() - line.trim_start().len();
        wrapped(&line[blank..], &line[..blank])
    };
    text.lines().map(wrap).collect()
}

/// Cuts a text to a number of characters.
pub fn cut(text: &str, max_len: usize) -> String {
    match text.char_indices().nth(max_len) {
        None => text.to_owned(),
        Some(_) => text.chars().take(max_len - 1).collect::<String>() + "…",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> TextTable {
        let mut table = TextTable::new("llrl");
        table.row(["key", "meaning", "over rover_216_5mt", "source"]);
        table.row([
            "displacement_cc",
            "volume that the pump moves in one revolution",
            "8.57 cm³/rev",
            "thesis, chapter 4",
        ]);
        table
    }

    /// Property: at any width the words are those of the widest table, in order by column, and lines keep within the width if the longest words
    /// do.
    #[test]
    fn wrapping_never_cuts_a_word() {
        let table = rows();
        let words = |text: &str| {
            let mut words: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
            words.sort();
            words
        };
        let whole = words(&table.text_in(400));
        for width in 20..=140 {
            let text = table.text_in(width);
            assert_eq!(words(&text), whole, "{width}\n{text}");
            // Longest words of the columns and the gaps between them: 15 + 2 + 10 + 2 + 13 + 2 + 8.
            assert!(characters(&text) <= width.max(52), "{width}\n{text}");
        }
    }

    /// Property: on a narrow line a text that does not fit lies below its row, complete, and no line is too wide.
    #[test]
    fn long_text_moves_below_its_row() {
        let mut table = TextTable::new("llll");
        table.row(["row", "verdict", "computed", "what"]);
        let what = "inertia classes of the two cars lie within what the dynamometer can set";
        table.row(["3.01a", "not comparable", "yes: 454 <= 1130 <= 2722", what]);
        table.row(["3.01b", "agrees", "15.48", ""]);
        let text = table.text_in(60);
        let end = "\n    inertia classes of the two cars lie within what the\n    dynamometer can set\n3.01b";
        assert!(text.contains(end), "{text}");
        assert!(characters(&text) <= 60, "{text}");
        assert_eq!(table.text_in(120).lines().count(), 3);
    }

    /// Property: a table of numbers that does not fit continues below itself, each part with the first column, within the width.
    #[test]
    fn wide_table_of_numbers_continues_below() {
        let mut table = TextTable::new("lrrrrr");
        table.row(["bar", "break", "capacity", "primary", "secondary", "linear"]);
        table.row(["15", "41.2", "143.8", "0.122", "0.069", "0.949"]);
        let text = table.text_in(30);
        assert_eq!(
            text,
            "bar  break  capacity  primary\n15    41.2     143.8    0.122\n\n\
             bar  secondary  linear\n15       0.069   0.949\n"
        );
        assert!(!table.text_in(60).contains("\n\n"));
    }

    #[test]
    fn long_names_split_at_their_joints() {
        let text = "as in calibrations/rover_216_transmission.toml (fit)";
        assert_eq!(
            folded(text, 22),
            "as in calibrations/\nrover_216_\ntransmission.toml\n(fit)"
        );
        assert_eq!(folded("no long name", 40), "no long name");
    }

    /// Numbers keep their units on the same line, headings above them may not.
    #[test]
    fn number_keeps_its_unit() {
        let text = rows().text_in(46);
        assert!(text.contains("8.57 cm³/rev"), "{text}");
        assert!(!text.contains("over rover_216_5mt"), "{text}");
    }
}
