//! Files of a study: their checksums, as lists in the format of `sha256sum`; put into place, locked, removed.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::Path;

use super::names::{self, LOCK, RESULTS};
use cvtcycle_config::{Problem, bounded};
use cvtcycle_output::files::{failed, is_temporary, problem, temporary_in};
use sha2::{Digest, Sha256};
use tempfile::NamedTempFile;

/// SHA-256 of a file's bytes.
pub type Sum = [u8; 32];

/// SHA-256 of some bytes.
pub fn sha256(bytes: &[u8]) -> Sum {
    Sha256::digest(bytes).into()
}

/// SHA-256 of what is left to read of a file.
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

/// Takes the checksum of what is written through it.
pub struct Summing<W> {
    out: W,
    hasher: Sha256,
}

impl<W: Write> Summing<W> {
    /// Nothing yet.
    pub fn new(out: W) -> Self {
        Summing {
            out,
            hasher: Sha256::new(),
        }
    }

    /// The checksum.
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

/// Names of files with their checksums.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Checksums(pub Vec<(String, Sum)>);

impl Checksums {
    /// The list as text, one file a line.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (name, sum) in &self.0 {
            text.extend(sum.iter().map(|byte| format!("{byte:02x}")));
            text += &format!("  {name}\n");
        }
        text
    }

    /// Reads a list; none if it is not one from its first byte to its last.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let text = std::str::from_utf8(bytes).ok()?;
        let lines = text.strip_suffix('\n')?.split('\n');
        let entry = |line: &str| {
            let name = line.get(66..).filter(|name| !name.is_empty())?;
            Some((name.to_owned(), sum_in(line)?))
        };
        lines.map(entry).collect::<Option<_>>().map(Checksums)
    }

    /// The list in a file; none if there is no such file, or it is damaged.
    pub fn read(path: &Path) -> Option<Self> {
        Self::parse(&bounded::read_file(path, bounded::CHECKSUMS).ok()?)
    }

    /// The checksum of a file.
    pub fn get(&self, name: &str) -> Option<&Sum> {
        let found = self.0.iter().find(|(other, _)| other == name);
        found.map(|(_, sum)| sum)
    }
}

/// The checksum at the beginning of a line, with the two spaces behind it.
fn sum_in(line: &str) -> Option<Sum> {
    let digits = line.get(..66)?.strip_suffix("  ")?.as_bytes();
    let digit = |d: u8| match d.is_ascii_uppercase() {
        true => None,
        false => char::from(d).to_digit(16),
    };
    let mut sum = Sum::default();
    for (byte, pair) in sum.iter_mut().zip(digits.chunks_exact(2)) {
        *byte = u8::try_from(16 * digit(pair[0])? + digit(pair[1])?).ok()?;
    }
    Some(sum)
}

/// Writes a file under a temporary name, down to the disk, and renames it. On an error nothing is left of it.
pub fn put(
    folder: &Path,
    name: &str,
    f: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> io::Result<Sum> {
    let file: NamedTempFile = temporary_in(folder)?;
    // The bare file: the named one would add its temporary name to every error.
    let mut out = Summing::new(BufWriter::new(file.as_file()));
    f(&mut out)?;
    out.flush()?;
    let sum = out.finish();
    file.as_file().sync_all()?;
    file.persist(folder.join(name))
        .map_err(|error| error.error)?;
    Ok(sum)
}

/// Locks the directory for this process. The lock ends with the process, however that ends; the file stays and means nothing.
pub fn lock(path: &Path) -> Result<File, Problem> {
    let cannot =
        |error: &io::Error| failed(path, &format!("cannot lock {}", path.display()), error);
    let file = OpenOptions::new()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path.join(LOCK))
        .map_err(|error| cannot(&error))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => {
            let message = format!("another process is writing the study in {}", path.display());
            Err(problem(
                path,
                &message,
                "wait until it has ended, or choose another directory",
            ))
        }
        // Some network file systems know no locks; nothing is written over unless two studies are begun there at once.
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(cannot(&error)),
    }
}

/// Removes what an interrupted process left half written; this process holds the lock.
pub fn remove_temporary(folder: &Path) -> io::Result<()> {
    remove_files(folder, is_temporary)
}

fn remove_files(folder: &Path, which: impl Fn(&str) -> bool) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if which(&entry.file_name().to_string_lossy()) && !entry.file_type()?.is_dir() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

/// Removes the results and parts of an earlier study, and nothing else.
pub fn clear(path: &Path) -> io::Result<()> {
    let results = Checksums::read(&path.join(RESULTS)).unwrap_or_default();
    remove_files(path, |name| {
        is_temporary(name) || (names::is_result(name) && results.get(name).is_some())
    })?;
    remove_files(path, |name| name == RESULTS)?;
    let parts = names::parts_folder(path);
    if parts.is_dir() {
        remove_files(&parts, |name| {
            is_temporary(name) || names::is_part_file(name)
        })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// FIPS 180-2, appendix B.1: the digest of "abc".
    #[test]
    fn val_checksum_of_the_standard_and_its_line() {
        let list = Checksums(vec![("abc.txt".to_owned(), sha256(b"abc"))]);
        let line = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  abc.txt\n";
        assert_eq!(list.text(), line);
        assert_eq!(Checksums::parse(line.as_bytes()), Some(list));
    }

    #[test]
    fn a_list_that_was_cut_off_or_changed_is_none_or_another() {
        let list = Checksums(vec![
            ("a".to_owned(), sha256(b"1")),
            ("b ü".to_owned(), sha256(b"2")),
        ]);
        let text = list.text();
        for end in 0..text.len() {
            // Cut at the end of a line it is a list without the later files, which then are missed.
            let cut = Checksums::parse(&text.as_bytes()[..end]);
            assert!(cut.is_none_or(|short| short.0.len() == 1), "{end}");
        }
        for at in 0..text.len() {
            for bit in 0..8 {
                let mut bytes = text.clone().into_bytes();
                bytes[at] ^= 1 << bit;
                assert_ne!(Checksums::parse(&bytes).as_ref(), Some(&list), "{at} {bit}");
            }
        }
    }
}
