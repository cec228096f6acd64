//! Files read whole, and of no file more than its kind may have.
//!
//! | kind | bytes | why so many |
//! |---|---|---|
//! | [`TOML`] | 1 MiB | the largest shipped file has 57 kB; its values are kept with their places, some hundred bytes each |
//! | [`TABLE`] | 64 MiB | a map of a million points |
//! | [`LOG`] | 256 MiB | a log of ten million rows with three channels: two weeks at 10 Hz |
//! | [`TRACE`] | 512 MiB | a trace of a million steps, as `run --out` writes it, with all columns |
//! | [`RECORD`] | 64 MiB | JSON of the program; the manifest of a study with a plan of 1 MiB stays below |
//! | [`CHECKSUMS`] | 1 MiB | ten thousand files |
//! | [`LOGO`] | 500 kB | it is copied into the report |
//!
//! Sizes are counted before anything is computed or built:
//!
//! | limit | number | of |
//! |---|---|---|
//! | [`STEPS`] | 2 000 000 | rows that are kept of all cars of a run together: 23 days at 1 s |
//! | [`SOURCE_ROWS`] | 500 000 | rows of all sources of a file of rows or of a calibration; the largest shipped file has 115 000 |
//! | [`NODES`] | 1 000 000 | values of a JSON file of the program; one takes 32 bytes and more, however short it is |
//! | [`CELLS`] | 64 000 000 | numbers of the traces of one point of a study, which a thread holds: 512 MB |
//!
//! The size of a file is read first, so that a large one is refused unread, but it is not trusted: pipes and devices have none, and a file
//! may grow while it is read.

use super::carried;
use crate::problem::Problem;
use crate::problem::place::Place;
use serde_json::Value;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// How large a file of a kind may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// Most bytes.
    pub bytes: u64,
    /// Hint for a file that exceeds the limit.
    pub hint: &'static str,
}

const MIB: u64 = 1 << 20;
const DAMAGED: &str =
    "no file that this program writes is as large: it is damaged, or another file";

/// A TOML file of the user: vehicle, lubricant, plan, rows, cover.
pub const TOML: Limit = Limit {
    bytes: MIB,
    hint: "is this the file that was meant? measured values belong into a CSV file that it names",
};
/// A CSV table of the user: cycle, map, measured data.
pub const TABLE: Limit = Limit {
    bytes: 64 * MIB,
    hint: "is this the file that was meant? otherwise thin it out: fewer rows, fewer decimals",
};
/// A drive cycle or a log of a car.
pub const LOG: Limit = Limit {
    bytes: 256 * MIB,
    hint: "is this the file that was meant? otherwise cut it into drives, or leave out columns",
};
/// A trace of a run as CSV.
pub const TRACE: Limit = Limit {
    bytes: 512 * MIB,
    hint: "run it again with a larger time step, or with its trace as Parquet",
};
/// JSON of the program: summary, inputs, manifest.
pub const RECORD: Limit = Limit {
    bytes: 64 * MIB,
    hint: DAMAGED,
};
/// A list of checksums.
pub const CHECKSUMS: Limit = Limit {
    bytes: MIB,
    hint: DAMAGED,
};
/// A logo.
pub const LOGO: Limit = Limit {
    bytes: 500_000,
    hint: "make it smaller: it is copied into the report",
};

/// Most rows that are kept of all cars of a run together, and most that a trace may have which is read.
pub const STEPS: usize = 2_000_000;
/// Most rows of all sources of a file of rows or of a calibration.
pub const SOURCE_ROWS: usize = 500_000;
/// Most numbers of the traces of one point of a study.
pub const CELLS: usize = 64_000_000;
/// Most values of a JSON file of the program.
pub const NODES: usize = 1_000_000;
/// Longest time step that a run may have, s.
const LONGEST_STEP_S: f64 = 10.0;

/// Checks that a run of so many steps of up to `dt_s` may keep their rows. The caller gives the place.
///
/// # Errors
/// There are more than [`STEPS`].
pub fn kept_steps(steps: usize, dt_s: f64) -> Result<(), Problem> {
    if steps <= STEPS {
        return Ok(());
    }
    let step = long_enough_s(steps, dt_s, STEPS);
    let step = step.map(|step_s| format!("take a step of {step_s} s or more, "));
    let other = "drive a part of the cycle or fewer cars, or keep no rows";
    let message = format!("the run keeps {steps} steps of {dt_s} s");
    Err(Problem::too_large(message)
        .allowed(format!("up to {STEPS} steps"))
        .hint(step.unwrap_or_default() + other))
}

/// The shortest even step with which so many steps of `dt_s` become at most `most`; none if the longest is too short.
#[must_use]
pub fn long_enough_s(steps: usize, dt_s: f64, most: usize) -> Option<f64> {
    let least_s = dt_s * steps as f64 / most as f64;
    even_steps().find(|step_s| *step_s >= least_s)
}

/// Steps of 1, 2 and 5 times a power of ten up to the longest, s: the rows of most cycles are cut by them without a rest.
fn even_steps() -> impl Iterator<Item = f64> {
    let all = [0.01, 0.1, 1.0, LONGEST_STEP_S].map(|power| [power, 2.0 * power, 5.0 * power]);
    let all = all.into_iter().flatten();
    all.take_while(|step_s| *step_s <= LONGEST_STEP_S)
}

/// JSON of the program. The caller gives the file.
///
/// # Errors
/// It has more than [`NODES`] values, or is no whole JSON at a line and column.
pub fn json(bytes: &[u8]) -> Result<Value, Problem> {
    if nodes(bytes) > NODES {
        return Err(
            Problem::too_large(format!("the file has more than {NODES} values"))
                .allowed(format!("up to {NODES}"))
                .hint(DAMAGED),
        );
    }
    serde_json::from_slice(bytes).map_err(|error| {
        let place = Place {
            line: error.line(),
            column: error.column(),
            ..Place::default()
        };
        Problem::syntax(format!("this is no whole JSON: {error}"))
            .at(place)
            .hint("the file is damaged; run it again")
    })
}

/// Values of a JSON text, names of values counted as such: each has a sign before or after it outside strings.
fn nodes(bytes: &[u8]) -> usize {
    let (mut count, mut in_string, mut escaped) = (0, false, false);
    for byte in bytes {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = in_string,
            b'"' => in_string = !in_string,
            b',' | b':' | b'[' | b'{' if !in_string => count += 1,
            _ => {}
        }
    }
    count
}

impl Limit {
    /// Limit in words.
    #[must_use]
    pub fn allowed(&self) -> String {
        format!("up to {}", self.size())
    }

    fn size(&self) -> String {
        match self.bytes {
            bytes if bytes.is_multiple_of(MIB) => format!("{} MiB", bytes / MIB),
            bytes => format!("{} kB", bytes / 1000),
        }
    }
}

/// Why a file was not read.
#[derive(Debug)]
pub enum ReadError {
    /// The operating system's words.
    Unreadable(io::Error),
    /// It has more bytes than allowed; so many, where that is known.
    TooLarge(Option<u64>, Limit),
    /// A pipe or a device where only a file can be meant.
    NoFile,
}

impl ReadError {
    /// Accepted input: the limit if the file is too large, else `usual`.
    #[must_use]
    pub fn allowed(&self, usual: &str) -> String {
        match self {
            ReadError::TooLarge(_, limit) => limit.allowed(),
            ReadError::Unreadable(_) | ReadError::NoFile => usual.to_owned(),
        }
    }

    /// Hint: a smaller file if it is too large, else `usual`.
    #[must_use]
    pub fn hint<'h>(&self, usual: &'h str) -> &'h str {
        match self {
            ReadError::TooLarge(_, limit) => limit.hint,
            ReadError::NoFile => "name a file",
            ReadError::Unreadable(_) => usual,
        }
    }

    /// Kind of the operating system's error.
    #[must_use]
    pub fn kind(&self) -> io::ErrorKind {
        match self {
            ReadError::Unreadable(error) => error.kind(),
            ReadError::TooLarge(..) => io::ErrorKind::FileTooLarge,
            ReadError::NoFile => io::ErrorKind::Unsupported,
        }
    }
}

impl fmt::Display for ReadError {
    /// The reason, as the end of "cannot read NAME: ".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ReadError::Unreadable(error) => error.fmt(f),
            ReadError::TooLarge(Some(bytes), _) => write!(f, "it has {bytes} bytes"),
            ReadError::TooLarge(None, limit) => write!(f, "it has more than {}", limit.size()),
            ReadError::NoFile => f.write_str("it is a pipe or a device and no file"),
        }
    }
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        ReadError::Unreadable(error)
    }
}

/// The bytes of what the user has named, which may be a pipe.
///
/// # Errors
/// It cannot be read, or has more bytes than its limit.
pub fn read(path: impl AsRef<Path>, limit: Limit) -> Result<Vec<u8>, ReadError> {
    let path = path.as_ref();
    if let Some(bytes) = carried::find(path) {
        return Ok(bytes.to_vec());
    }
    let file = File::open(path)?;
    let found = file.metadata()?;
    let size = if found.is_file() { found.len() } else { 0 };
    if size > limit.bytes {
        return Err(ReadError::TooLarge(Some(size), limit));
    }
    // One byte more than allowed shows that the file goes on.
    let mut bytes = Vec::with_capacity(usize::try_from(size + 1).unwrap_or(0));
    let read = file.take(limit.bytes + 1).read_to_end(&mut bytes)?;
    if read as u64 > limit.bytes {
        return Err(ReadError::TooLarge(None, limit));
    }
    carried::note(path, &bytes);
    Ok(bytes)
}

/// The bytes of a file that another file names, or that the program has written: its author may be unknown, and a pipe
/// without a writer would be waited for without end.
///
/// # Errors
/// As [`read`], and for what is no file.
pub fn read_file(path: impl AsRef<Path>, limit: Limit) -> Result<Vec<u8>, ReadError> {
    is_file(path.as_ref())?;
    read(path, limit)
}

/// Opens a file that another file names, or that the program has written, to be read in parts.
///
/// # Errors
/// It cannot be opened, or is a pipe or a device.
pub fn open_file(path: impl AsRef<Path>) -> Result<File, ReadError> {
    is_file(path.as_ref())?;
    Ok(File::open(path)?)
}

fn is_file(path: &Path) -> Result<(), ReadError> {
    if carried::find(path).is_some() {
        return Ok(());
    }
    let found = fs::metadata(path)?;
    // A directory has its own words from the operating system.
    if found.is_file() || found.is_dir() {
        Ok(())
    } else {
        Err(ReadError::NoFile)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_values_are_counted_outside_strings() {
        for (text, count) in [
            ("", 0),
            ("1", 0),
            ("[]", 1),
            ("[1,2,[3]]", 4),
            ("{\"a\":{\"b\":[1,2]},\"c\":null}", 8),
            ("{\"[,:{\":\"[[[[\\\"[[[\\\\\"}", 2),
            ("\\[", 1),
            ("\"\\", 0),
        ] {
            assert_eq!(nodes(text.as_bytes()), count, "{text}");
        }
        let list = |count: usize| format!("[{}1]", "1,".repeat(count));
        assert!(json(list(NODES - 1).as_bytes()).is_ok());
        let problem = json(list(NODES).as_bytes()).expect_err("one too many");
        assert_eq!(problem.message, "the file has more than 1000000 values");
        let broken = json(b"{\n \"a\": }").expect_err("no value");
        assert_eq!((broken.place.line, broken.place.column), (2, 7));
    }

    #[test]
    fn more_steps_than_are_kept_are_refused_with_the_step_that_is_enough() {
        assert_eq!(kept_steps(STEPS, 1.0), Ok(()));
        let other = "drive a part of the cycle or fewer cars, or keep no rows";
        for (steps, dt_s, step) in [
            (9_972_000, 0.1, "take a step of 0.5 s or more, "),
            (STEPS + 1, 1.0, "take a step of 2 s or more, "),
            (2 * STEPS, 0.01, "take a step of 0.02 s or more, "),
            (10 * STEPS, 1.0, "take a step of 10 s or more, "),
            (10 * STEPS + 1, 1.0, ""),
            (usize::MAX, 0.01, ""),
        ] {
            let problem = kept_steps(steps, dt_s).expect_err(step);
            assert_eq!(
                problem.message,
                format!("the run keeps {steps} steps of {dt_s} s")
            );
            assert_eq!(problem.allowed, "up to 2000000 steps");
            assert_eq!(problem.hint, format!("{step}{other}"));
        }
    }
}
