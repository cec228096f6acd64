//! Files read whole, and of no file more than its kind may have.
//!
//! | kind | bytes | why so many |
//! |---|---|---|
//! | [`TOML`] | 1 MiB | the largest shipped file has 57 kB; its values are kept with their places, some hundred bytes each |
//! | [`TABLE`] | 64 MiB | a cycle of a week at 10 Hz, or a map of a million points |
//! | [`TRACE`] | 512 MiB | a trace of a million steps, as `run --out` writes it, with all columns |
//! | [`RECORD`] | 64 MiB | JSON of the program; the manifest of a study with a plan of 1 MiB stays below |
//! | [`CHECKSUMS`] | 1 MiB | ten thousand files |
//! | [`LOGO`] | 500 kB | it is copied into the report |
//!
//! The size of a file is read first, so that a large one is refused unread, but it is not trusted: pipes and devices have none, and a file
//! may grow while it is read.

use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

/// How large a file of a kind may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limit {
    /// Most bytes.
    pub bytes: u64,
    /// What helps where a file has more.
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

impl Limit {
    /// What is allowed, in words.
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
    /// What would be accepted: the limit where the file is too large, else `usual`.
    #[must_use]
    pub fn allowed(&self, usual: &str) -> String {
        match self {
            ReadError::TooLarge(_, limit) => limit.allowed(),
            ReadError::Unreadable(_) | ReadError::NoFile => usual.to_owned(),
        }
    }

    /// What helps: less of it where the file is too large, else `usual`.
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
        Err(ReadError::TooLarge(None, limit))
    } else {
        Ok(bytes)
    }
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
    let found = fs::metadata(path)?;
    // A directory has its own words from the operating system.
    if found.is_file() || found.is_dir() {
        Ok(())
    } else {
        Err(ReadError::NoFile)
    }
}
