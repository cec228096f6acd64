//! SHA-256 of files.

use std::fs::File;
use std::io::{self, Read, Write};

use indexmap::IndexMap;
use sha2::{Digest, Sha256};

/// SHA-256 of a file's bytes.
pub type Sum = [u8; 32];
/// SHA-256 of files in hexadecimal, by their names.
pub type Sums = IndexMap<String, String>;

/// Hashes bytes.
pub fn sha256(bytes: &[u8]) -> Sum {
    Sha256::digest(bytes).into()
}

/// Formats a checksum in hexadecimal.
pub fn hex(sum: &Sum) -> String {
    sum.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Hashes the rest of a file.
///
/// # Errors
/// Errors of the operating system.
pub fn sum_of(mut file: &File) -> io::Result<Sum> {
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        match file.read(&mut buffer) {
            Ok(0) => return Ok(hasher.finalize().into()),
            Ok(n) => hasher.update(&buffer[..n]),
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// Writer that hashes the bytes passed through it.
#[derive(Debug)]
pub struct Summing<W> {
    out: W,
    hasher: Sha256,
}

impl<W: Write> Summing<W> {
    /// Starts with an empty hash.
    pub fn new(out: W) -> Self {
        Summing {
            out,
            hasher: Sha256::new(),
        }
    }

    /// Returns the checksum.
    pub fn finish(self) -> Sum {
        self.hasher.finalize().into()
    }
}

impl<W: Write> Write for Summing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
