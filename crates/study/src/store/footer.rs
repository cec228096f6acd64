//! The footer of a Parquet file before the library reads it: the library makes room for as many entries as a list, and as many columns as a
//! group of columns, says that it has.
//!
//! A footer is a structure in Thrift's compact protocol. It is walked through without being kept. Where the library goes by the number of a
//! field and not by its kind, in the elements of the schema, the kinds have to be right as well.

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

/// Checks that every list and text of the footer is as long as it says; a file without footer passes, as the library reports it. Leaves the file at
/// the beginning.
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

/// The first fields of a footer: its version, and the list of the elements of its schema.
const VERSION: (u64, u8) = (1, I32);
const SCHEMA: (u64, u8) = (2, LIST);
/// Kinds of the fields of an element, by their numbers from 1: type, length, repetition, name, columns of a group, four numbers, and a logical
/// type.
const ELEMENT: [u8; 10] = [I32, I32, I32, TEXT, I32, I32, I32, I32, I32, STRUCTURE];
/// The number of columns of a group, and the logical type, in [`ELEMENT`].
const COLUMNS: u64 = 5;
const LOGICAL: u64 = 10;

/// Kinds of values.
const I32: u8 = 5;
const TEXT: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const STRUCTURE: u8 = 12;

/// Type of a structure.
#[derive(Clone, Copy)]
enum Part {
    /// The footer itself.
    Footer,
    /// One of so many elements of the schema.
    Element(u64),
    /// A logical type, which is made of structures without values: all types of this program are.
    Logical,
    Other,
}

/// Checks that every list and text of a footer is as long as it says.
fn is_whole(footer: &[u8]) -> bool {
    let mut walk = Walk {
        rest: footer,
        structures: 0,
    };
    walk.structure(Part::Footer, 0).is_some()
}

/// Unread bytes of a footer. Every step takes at least one byte, or ends.
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
    fn structure(&mut self, part: Part, depth: usize) -> Option<()> {
        self.structures += 1;
        if depth > MAX_DEPTH || self.structures > MAX_STRUCTURES {
            return None;
        }
        let mut field = 0;
        loop {
            let before = field;
            let head = self.byte()?;
            let kind = head & 0xf;
            if kind == 0 {
                return Some(());
            }
            // The step from the field before, or the field's own number of 16 bits, with its sign last.
            field = match head >> 4 {
                0 => self.number().filter(|own| own % 2 == 0 && *own <= 0xffff)? / 2,
                step => before + u64::from(step),
            };
            self.field(part, (before, field), kind, depth)?;
        }
    }

    fn field(
        &mut self,
        part: Part,
        (before, field): (u64, u64),
        kind: u8,
        depth: usize,
    ) -> Option<()> {
        match part {
            // The version, then the schema: the library reads no other field as one before it has the schema, and no schema after that.
            Part::Footer if before == 0 => ((field, kind) == VERSION).then_some(())?,
            Part::Footer if before == VERSION.0 => {
                ((field, kind) == SCHEMA).then_some(())?;
                return self.schema(depth);
            }
            Part::Element(of) => {
                let place = usize::try_from(field).ok()?.checked_sub(1)?;
                ELEMENT
                    .get(place)
                    .is_none_or(|right| *right == kind)
                    .then_some(())?;
                if field == COLUMNS {
                    return (self.number()? >> 1 <= of).then_some(());
                }
                if field == LOGICAL {
                    return self.structure(Part::Logical, depth + 1);
                }
            }
            Part::Logical if kind == STRUCTURE => return self.structure(part, depth + 1),
            Part::Logical => return None,
            Part::Footer | Part::Other => {}
        }
        // A field that is true or false has no more bytes.
        match kind {
            1 | 2 => Some(()),
            _ => self.value(kind, depth),
        }
    }

    fn schema(&mut self, depth: usize) -> Option<()> {
        let (inner, count) = self.list()?;
        (inner == STRUCTURE).then_some(())?;
        (0..count).try_for_each(|_| self.structure(Part::Element(count), depth + 1))
    }

    /// The kind of the entries of a list, and how many there are.
    fn list(&mut self) -> Option<(u8, u64)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.number()?,
            few => few.into(),
        };
        Some((head & 0xf, count))
    }

    fn value(&mut self, kind: u8, depth: usize) -> Option<()> {
        match kind {
            1..=3 => self.skip(1),
            4..=6 => self.number().map(drop),
            7 => self.skip(8),
            TEXT => {
                let length = self.number()?;
                self.skip(length)
            }
            LIST | SET if depth < MAX_DEPTH => {
                let (inner, count) = self.list()?;
                (0..count).try_for_each(|_| self.value(inner, depth + 1))
            }
            STRUCTURE => self.structure(Part::Other, depth + 1),
            // Maps, which no footer has, and what is no kind.
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, after the description of the compact protocol: a version, and a schema of two elements, of which one is a group, before other
    /// fields.
    fn footer(group: &[u8], logical: &[u8], fields: &[u8]) -> Vec<u8> {
        let column = [0x15, 0x0c, 0x38, 1, b'w', 0x6c];
        let schema = [
            &[0x15, 2, 0x19, 0x2c][..],
            group,
            &[0],
            &column,
            logical,
            &[0],
        ]
        .concat();
        [&schema[..], fields].concat()
    }

    /// A group `s` of one column, a logical type, a list of three texts and a structure.
    const GROUP: &[u8] = &[0x48, 1, b's', 0x15, 2];
    const TEXTS: &[u8] = &[0x1c, 0, 0];
    const FIELDS: &[u8] = &[
        0x19, 0x38, 1, b'a', 0, 2, b'b', b'c', 0x1c, 0x11, 0x12, 0, 0,
    ];

    fn with_fields(fields: &[u8]) -> bool {
        is_whole(&footer(GROUP, TEXTS, fields))
    }

    #[test]
    fn a_footer_is_walked_to_its_end() {
        let whole = footer(GROUP, TEXTS, FIELDS);
        assert!(is_whole(&whole) && with_fields(&[0]));
        // Bytes after the end are ignored.
        assert!(is_whole(&[&whole[..], &[0xff; 9]].concat()));
        for length in 0..whole.len() {
            assert!(!is_whole(&whole[..length]), "cut at {length}");
        }
    }

    #[test]
    fn what_says_that_it_is_longer_is_not_whole() {
        // Lists of 4, and of 2^35 texts; a text of 100 bytes; a list of structures of which each has a byte.
        for (at, with) in [
            (1, &[0x48][..]),
            (1, &[0xf8, 0x80, 0x80, 0x80, 0x80, 0x7f]),
            (2, &[100]),
            (1, &[0xfc, 0xff, 0xff, 0x03]),
        ] {
            let fields = [&FIELDS[..at], with, &FIELDS[at + 1..]].concat();
            assert!(!with_fields(&fields), "{fields:x?}");
        }
        let deep = |levels: usize| [&vec![0x1c; levels][..], &vec![0; levels + 1]].concat();
        assert!(!with_fields(&deep(1000)) && with_fields(&deep(MAX_DEPTH)));
        assert!(!with_fields(&[&[0x19; 1000][..], &[0; 1000]].concat()));
        let empty = [&[0x19, 0xfc, 0xc1, 0x84, 0x3d][..], &[0; 1_000_002]].concat();
        assert!(!with_fields(&empty), "1 000 001 empty structures");
    }

    #[test]
    fn a_schema_has_no_more_columns_than_elements() {
        for wrong in [
            // Three columns, 2^30, and a number of columns that is a text.
            &[0x48, 1, b's', 0x15, 6][..],
            &[0x48, 1, b's', 0x15, 0x80, 0x80, 0x80, 0x80, 8],
            &[0x48, 1, b's', 0x18, 1, b'x'],
            // The same by the field's own number, and one below zero.
            &[0x48, 1, b's', 0x05, 10, 6],
            &[0x48, 1, b's', 0x05, 9, 2],
        ] {
            assert!(!is_whole(&footer(wrong, TEXTS, &[0])), "{wrong:x?}");
        }
        let number = footer(GROUP, &[0x1c, 0x15, 2, 0, 0], &[0]);
        assert!(!is_whole(&number), "a number in a logical type");
        // Another field first, a version that is a text, a schema that is a number or a list of texts.
        let whole = footer(GROUP, TEXTS, &[0]);
        for begin in [
            &[0x35, 2, 0x05, 4][..],
            &[0x18, 1, b'x'],
            &[0x15, 2, 0x15, 2],
        ] {
            assert!(!is_whole(&[begin, &whole[2..]].concat()), "{begin:x?}");
        }
        assert!(!is_whole(&[0x15, 2, 0x19, 0x18, 1, b'x', 0]));
    }
}
