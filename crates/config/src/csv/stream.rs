//! Lines of a table of any length, one at a time.

use std::io::{BufRead, Chain, Cursor, Error, Read};

use super::collector::{Collector, Line, MAX_LINE_LEN, long_line};
use super::schema::Schema;
use super::table::Table;
use super::text::{BYTE_ORDER_MARK, bare_returns, check_encoding, zero_byte};
use crate::Problem;

/// Bytes at the beginning in which the signs between columns and decimals are looked for.
const SAMPLE: usize = 1 << 16;

/// Reads lines without their ends; blank ones and comments are passed over.
#[derive(Debug)]
pub struct Lines<R> {
    reader: Chain<Cursor<Vec<u8>>, R>,
    /// Why the beginning could not be read to its end.
    failed: Option<Error>,
    buffer: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// The lines of `reader`.
    pub fn new(mut reader: R) -> Self {
        let mut sample = Vec::new();
        let read = reader.by_ref().take(SAMPLE as u64).read_to_end(&mut sample);
        Lines {
            reader: Cursor::new(sample).chain(reader),
            failed: read.err(),
            buffer: Vec::new(),
            number: 0,
        }
    }

    /// Opens the table that the lines are, and passes over those above its first row; none where the rows cannot be understood.
    pub fn open<'s>(
        &mut self,
        schema: &'s Schema,
        problems: &mut Collector<'_>,
    ) -> Option<Table<'s>> {
        let Some(names) = self.next(problems) else {
            problems.no_text();
            return None;
        };
        let (number, text) = (names.number, names.text.to_owned());
        let sample = self.reader.get_ref().0.get_ref();
        let whole = match sample.len() < SAMPLE {
            true => sample.len(),
            // The last line may go on.
            false => sample.iter().rposition(|byte| *byte == b'\n').unwrap_or(0),
        };
        let sample = String::from_utf8_lossy(&sample[..whole]).into_owned();
        let lines = (1..).zip(sample.lines());
        let below = lines
            .map(|(number, text)| Line { number, text })
            .filter(|line| line.number > number && line.has_content());
        let text = &text;
        let table = Table::open(Line { number, text }, below, schema, problems)?;
        for _ in 1..table.head_lines() {
            self.next(problems);
        }
        Some(table)
    }

    /// The next line; none at the end, or where the file cannot be read further, which is reported. A line that is no text is reported and
    /// passed over.
    pub fn next(&mut self, problems: &mut Collector<'_>) -> Option<Line<'_>> {
        let start = loop {
            let start = match self.fill() {
                Ok(start) => start?,
                Err(problem) => {
                    problems.file(problem);
                    return None;
                }
            };
            let bytes = &self.buffer[start..];
            if std::str::from_utf8(bytes).is_err() {
                let line = Line {
                    number: self.number,
                    text: "",
                };
                problems.line(line, "", || {
                    Problem::syntax("this line is not UTF-8 text")
                        .allowed("UTF-8 text")
                        .hint("save it as CSV UTF-8; a spreadsheet's own format cannot be read")
                });
            } else if bytes
                .trim_ascii_start()
                .first()
                .is_some_and(|first| *first != b'#')
            {
                break start;
            }
        };
        let text = std::str::from_utf8(&self.buffer[start..]).ok()?;
        Some(Line {
            number: self.number,
            text,
        })
    }

    /// Reads one line into the buffer; the index at which its text begins.
    fn fill(&mut self) -> Result<Option<usize>, Problem> {
        self.buffer.clear();
        let read = self
            .reader
            .by_ref()
            .take(MAX_LINE_LEN as u64)
            .read_until(b'\n', &mut self.buffer);
        let count = read.map_err(|error| cannot_read(&error))?;
        if count == 0 {
            return match self.failed.take() {
                Some(error) => Err(cannot_read(&error)),
                None => Ok(None),
            };
        }
        self.number += 1;
        let first = self.number == 1;
        if first {
            check_encoding(&self.buffer)?;
        }
        if self.buffer.contains(&0) {
            return Err(zero_byte(self.number));
        }
        match self.buffer.pop_if(|byte| *byte == b'\n') {
            Some(_) => drop(self.buffer.pop_if(|byte| *byte == b'\r')),
            None if self.buffer.len() >= MAX_LINE_LEN => return Err(long_line(self.number)),
            None => {}
        }
        if first && self.buffer.contains(&b'\r') {
            return Err(bare_returns());
        }
        let has_mark = first && self.buffer.starts_with(BYTE_ORDER_MARK);
        Ok(Some(if has_mark { BYTE_ORDER_MARK.len() } else { 0 }))
    }
}

fn cannot_read(error: &Error) -> Problem {
    Problem::unreadable(format!("cannot read on: {error}")).hint("check the file and its disk")
}
