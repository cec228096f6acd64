//! Lines of a table of any length, one at a time.

use std::io::{BufRead, Read};

use cvtcycle_config::cycle::problems::{Complaint, Line};

/// Longer is no row of a table.
const MAX_LINE_LEN: u64 = 1 << 20;

/// What stands in a file's way of being read on.
#[derive(Debug)]
pub enum Broken {
    /// This line is bad, the next may be good.
    Line(usize, Complaint),
    /// The whole file is.
    File(Complaint),
}

/// Reads lines without their ends; blank ones are passed over.
#[derive(Debug)]
pub struct Lines<R> {
    reader: R,
    buffer: Vec<u8>,
    number: usize,
}

impl<R: BufRead> Lines<R> {
    pub fn new(reader: R) -> Self {
        Lines {
            reader,
            buffer: Vec::new(),
            number: 0,
        }
    }

    /// The next line, or none at the end of the file.
    pub fn next(&mut self) -> Option<Result<Line<'_>, Broken>> {
        let start = loop {
            match self.fill() {
                Err(complaint) => return Some(Err(Broken::File(complaint))),
                Ok(None) => return None,
                Ok(Some(start)) if self.buffer[start..].iter().all(u8::is_ascii_whitespace) => {}
                Ok(Some(start)) => break start,
            }
        };
        let number = self.number;
        Some(match std::str::from_utf8(&self.buffer[start..]) {
            Ok(text) => Ok(Line { number, text }),
            Err(_) => {
                let hint = "save it as CSV UTF-8; a spreadsheet's own format cannot be read";
                Err(Broken::Line(
                    number,
                    Complaint::new("this line is not UTF-8 text", "UTF-8 text", hint),
                ))
            }
        })
    }

    /// Reads one line into the buffer; where its text begins in it.
    fn fill(&mut self) -> Result<Option<usize>, Complaint> {
        self.buffer.clear();
        let read = self
            .reader
            .by_ref()
            .take(MAX_LINE_LEN)
            .read_until(b'\n', &mut self.buffer);
        let count = read.map_err(|error| {
            Complaint::new(
                format!("cannot read on: {error}"),
                "",
                "check the file and its disk",
            )
        })?;
        if count == 0 {
            return Ok(None);
        }
        self.number += 1;
        let first = self.number == 1;
        if first && (self.buffer.starts_with(b"\xff\xfe") || self.buffer.starts_with(b"\xfe\xff")) {
            return Err(Complaint::new(
                "the file is UTF-16 text",
                "UTF-8 text",
                "save it as CSV UTF-8",
            ));
        }
        if self.buffer.contains(&0) {
            let message = format!(
                "the file is not text: it has a zero byte in line {}",
                self.number
            );
            return Err(Complaint::new(
                message,
                "UTF-8 text",
                "save the table as CSV; a spreadsheet's own format cannot be read",
            ));
        }
        match self.buffer.pop_if(|byte| *byte == b'\n') {
            Some(_) => drop(self.buffer.pop_if(|byte| *byte == b'\r')),
            None if self.buffer.len() as u64 >= MAX_LINE_LEN => {
                let message = format!("line {} is too long for a row of a table", self.number);
                return Err(Complaint::new(
                    message,
                    "up to 1048576 bytes",
                    "is this a CSV file?",
                ));
            }
            None => {}
        }
        Ok(Some(if first && self.buffer.starts_with(b"\xef\xbb\xbf") {
            3
        } else {
            0
        }))
    }
}
