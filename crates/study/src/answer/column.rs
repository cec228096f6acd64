//! One column of a study, gone through as often as its description needs: held while it is short, else in a temporary file.

use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};

use crate::statistics::Numbers;
use cvtcycle_config::{Problem, ProblemKind};

/// Maximum of numbers kept in memory; a longer column goes to a file.
const HELD: usize = 1 << 18;
/// Numbers of a piece that is read from the file.
const PIECE: usize = 1 << 13;
const BYTES: usize = size_of::<f64>();

/// Numbers in the order of the points; NaN where there is none.
pub struct Column {
    /// The first numbers.
    held: Vec<f64>,
    /// The others.
    rest: Option<File>,
}

/// A column that is being gathered.
pub(super) struct Gathering {
    held: Vec<f64>,
    most: usize,
    rest: Option<BufWriter<File>>,
}

impl Default for Gathering {
    fn default() -> Self {
        Gathering {
            held: Vec::new(),
            most: HELD,
            rest: None,
        }
    }
}

impl Gathering {
    /// Adds a number.
    pub(super) fn push(&mut self, x: f64) -> Result<(), Problem> {
        if self.held.len() < self.most {
            self.held.push(x);
            return Ok(());
        }
        self.spill(x).map_err(|error| unkept(&error))
    }

    fn spill(&mut self, x: f64) -> io::Result<()> {
        let file = match &mut self.rest {
            Some(file) => file,
            none => none.insert(BufWriter::new(tempfile::tempfile()?)),
        };
        file.write_all(&x.to_le_bytes())
    }

    /// The column.
    pub(super) fn finish(self) -> Result<Column, Problem> {
        let file =
            |file: BufWriter<File>| file.into_inner().map_err(io::IntoInnerError::into_error);
        let rest = self.rest.map(file).transpose();
        Ok(Column {
            held: self.held,
            rest: rest.map_err(|error| unkept(&error))?,
        })
    }
}

impl Column {
    /// The first numbers, so many at most.
    pub(super) fn first(&self, most: usize) -> Result<Vec<f64>, Problem> {
        if let Some(first) = self.held.get(..most) {
            return Ok(first.to_vec());
        }
        let mut first = Vec::new();
        self.pass(|piece| {
            let room = most - first.len();
            first.extend_from_slice(&piece[..piece.len().min(room)]);
        })?;
        Ok(first)
    }

    /// All numbers: only of designs whose points are few by themselves.
    pub(super) fn all(&self) -> Result<Vec<f64>, Problem> {
        self.first(usize::MAX)
    }

    fn each_of_file(mut file: &File, mut f: impl FnMut(&[f64])) -> io::Result<()> {
        let (mut bytes, mut piece) = (vec![0; PIECE * BYTES], Vec::with_capacity(PIECE));
        file.rewind()?;
        loop {
            let mut filled = 0;
            while filled < bytes.len() {
                match file.read(&mut bytes[filled..])? {
                    0 => break,
                    more => filled += more,
                }
            }
            if filled == 0 {
                return Ok(());
            }
            let (numbers, _) = bytes[..filled].as_chunks::<BYTES>();
            piece.clear();
            piece.extend(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)));
            f(&piece);
        }
    }
}

impl Numbers for Column {
    type Error = Problem;

    fn pass(&self, mut f: impl FnMut(&[f64])) -> Result<(), Problem> {
        f(&self.held);
        let rest = self.rest.as_ref();
        rest.map_or(Ok(()), |file| Self::each_of_file(file, f))
            .map_err(|error| unkept(&error))
    }
}

/// The temporary file cannot be written or read.
fn unkept(error: &io::Error) -> Problem {
    let folder = std::env::temp_dir();
    let message = format!(
        "cannot keep a column of the study in a temporary file in {}: {error}",
        folder.display()
    );
    Problem::new(ProblemKind::Unreadable, message)
        .hint("make room there, or name another folder in TMPDIR")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A column that does not fit says the same as one that does.
    #[test]
    fn what_is_in_the_file_comes_after_what_is_held() {
        let numbers: Vec<f64> = (0..3 * PIECE + 5).map(|k| k as f64 * 0.1).collect();
        for most in [0, 7, PIECE, numbers.len(), numbers.len() + 1] {
            let mut gathering = Gathering {
                most,
                ..Gathering::default()
            };
            for x in &numbers {
                gathering.push(*x).expect("kept");
            }
            let column = gathering.finish().expect("kept");
            for _ in 0..2 {
                assert_eq!(column.all().expect("read"), numbers);
            }
            let first = column.first(PIECE + 3).expect("read");
            assert_eq!(first, numbers[..PIECE + 3]);
        }
    }
}
