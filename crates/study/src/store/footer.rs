//! The footer of a Parquet file before the library reads it: the library makes room for as many entries as a list says that it has.
//!
//! A footer is a structure in Thrift's compact protocol. It is walked through without being kept.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Most bytes of a footer; that of a table with all columns and a hundred groups of rows has some hundred kB.
const MAX_BYTES: u32 = 16 << 20;
/// Most structures in it; that table has less than a tenth of them.
const MAX_STRUCTURES: usize = 1_000_000;
/// Most structures and lists within each other; a table has ten.
const MAX_DEPTH: usize = 24;
/// The end of a file: the length of its footer, and its magic word.
const END: u64 = 8;

/// Whether a file has no footer, which the library reports, or one in which every list and text is as long as it says. The file is left at
/// its beginning.
pub(super) fn is_sound(file: &mut File) -> io::Result<bool> {
    let whole = file.seek(SeekFrom::End(0))?;
    let mut end = [0; 8];
    if whole > END {
        file.seek(SeekFrom::End(-8))?;
        file.read_exact(&mut end)?;
    }
    let [a, b, c, d, magic @ ..] = end;
    let length = u32::from_le_bytes([a, b, c, d]);
    let mut footer = Vec::new();
    let is_there = magic == *b"PAR1" && u64::from(length) + END <= whole;
    if is_there && length <= MAX_BYTES {
        file.seek(SeekFrom::Start(whole - END - u64::from(length)))?;
        let mut part = Read::by_ref(file).take(length.into());
        part.read_to_end(&mut footer)?;
    }
    file.rewind()?;
    Ok(!is_there || (length <= MAX_BYTES && is_whole(&footer)))
}

/// Whether every list and text of a structure is as long as it says.
fn is_whole(footer: &[u8]) -> bool {
    let mut walk = Walk {
        rest: footer,
        structures: 0,
    };
    walk.structure(0).is_some()
}

/// What is left of a footer. Every step takes at least one byte of it, or ends.
struct Walk<'f> {
    rest: &'f [u8],
    structures: usize,
}

impl Walk<'_> {
    fn skip(&mut self, bytes: u64) -> Option<()> {
        self.rest = self.rest.get(usize::try_from(bytes).ok()?..)?;
        Some(())
    }

    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(*first)
    }

    /// Seven bits a byte, the last one without the eighth.
    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }

    /// Fields up to the one of kind 0.
    fn structure(&mut self, depth: usize) -> Option<()> {
        self.structures += 1;
        if depth > MAX_DEPTH || self.structures > MAX_STRUCTURES {
            return None;
        }
        loop {
            let head = self.byte()?;
            let kind = head & 0xf;
            if kind == 0 {
                return Some(());
            }
            // The step from the field before, or the field's own number.
            if head >> 4 == 0 {
                self.number()?;
            }
            // A field that is true or false has no more bytes.
            if !matches!(kind, 1 | 2) {
                self.value(kind, depth)?;
            }
        }
    }

    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.number().map(drop),
            7 => self.skip(8),
            8 => {
                let length = self.number()?;
                self.skip(length)
            }
            9 | 10 if depth < MAX_DEPTH => {
                let head = self.byte()?;
                let count = match head >> 4 {
                    15 => self.number()?,
                    few => few.into(),
                };
                (0..count).try_for_each(|_| self.value(head & 0xf, depth + 1))
            }
            12 => self.structure(depth + 1),
            // Maps, which no footer has, and what is no kind.
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, after the description of the compact protocol: field 1 a number, field 2 a list of three texts, field 3 a structure.
    const WHOLE: [u8; 15] = [
        0x15, 0x02, 0x19, 0x38, 1, b'a', 0, 2, b'b', b'c', 0x1c, 0x11, 0x12, 0, 0,
    ];

    #[test]
    fn a_structure_is_walked_to_its_end() {
        assert!(is_whole(&WHOLE));
        assert!(is_whole(&[0]));
        // What comes after its end is not looked at.
        assert!(is_whole(&[&WHOLE[..], &[0xff; 9]].concat()));
        for length in 0..WHOLE.len() {
            assert!(!is_whole(&WHOLE[..length]), "cut at {length}");
        }
    }

    #[test]
    fn what_says_that_it_is_longer_is_not_whole() {
        // Lists of 4, and of 2^35 texts; a text of 100 bytes; a list of structures of which each has a byte.
        for (at, with) in [
            (3, &[0x48][..]),
            (3, &[0xf8, 0x80, 0x80, 0x80, 0x80, 0x7f]),
            (4, &[100]),
            (3, &[0xfc, 0xff, 0xff, 0x03]),
        ] {
            let bytes = [&WHOLE[..at], with, &WHOLE[at + 1..]].concat();
            assert!(!is_whole(&bytes), "{bytes:x?}");
        }
        let deep = [&[0x1c; 1000][..], &[0; 1001]].concat();
        assert!(!is_whole(&deep) && is_whole(&deep[1000 - MAX_DEPTH..]));
        let lists = [&[0x19][..], &[0x19; 1000], &[0; 1000]].concat();
        assert!(!is_whole(&lists));
        let empty = [&[0x19, 0xfc, 0xc1, 0x84, 0x3d][..], &[0; 1_000_002]].concat();
        assert!(!is_whole(&empty), "1 000 001 empty structures");
    }
}
