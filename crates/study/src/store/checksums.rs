//! Checksums of files, as lists in the format of `sha256sum`.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use sha2::{Digest, Sha256};

use cvtcycle_config::bounded;

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
