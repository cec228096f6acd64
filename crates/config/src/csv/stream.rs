//! Lines of a table of any length, one at a time.

use std::io::{BufRead, Read};

use super::collector::{Collector, Line, MAX_LINE_LEN, long_line};
use super::text::{BYTE_ORDER_MARK, bare_returns, check_encoding, zero_byte};
use crate::Problem;

/// Reads lines without their ends; blank ones are passed over.
#[derive(Debug)]
pub struct Lines<R> {
    reader: R,
    buffer: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    /// The lines of `reader`.
    pub fn new(reader: R) -> Self {
        Lines {
            reader,
            buffer: Vec::new(),
            number: 0,
        }
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
            } else if !bytes.iter().all(u8::is_ascii_whitespace) {
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
        let count = read.map_err(|error| {
            Problem::unreadable(format!("cannot read on: {error}"))
                .hint("check the file and its disk")
        })?;
        if count == 0 {
            return Ok(None);
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
