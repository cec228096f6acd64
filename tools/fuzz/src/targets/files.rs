//! Files read in their folder: Parquet tables, and the journal of a pending commit.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;

use cvtcycle::config::ProblemKind;
use cvtcycle::output::files::settle;
use cvtcycle::study::store::{Head, Kind, ParquetFile, Rows, Values, sha256, write_parquet};
use tempfile::{NamedTempFile, TempDir};

use super::results::checked;
use super::{Bytes, within_memory};

/// Metadata key of the column heads.
const COLUMNS: &str = "cvtcycle.columns";
/// Maximum number of edits of a table.
const MAX_EDITS: usize = 16;
/// Length of the end of a Parquet file: the length of the footer, and the magic word.
const END: usize = 8;

/// Small table with a column of each kind.
fn table() -> &'static [u8] {
    static TABLE: OnceLock<Vec<u8>> = OnceLock::new();
    TABLE.get_or_init(|| {
        let head = |(name, kind): (&str, Kind)| Head {
            name: name.to_owned(),
            unit: "-".to_owned(),
            doc: "m".to_owned(),
            kind,
        };
        let heads = [("x", Kind::Number), ("n", Kind::Count), ("w", Kind::Text)].map(head);
        let values = vec![
            Values::Number(vec![1.0, f64::NAN, -2.5, 1e300]),
            Values::Count(vec![1, 1, 1, -4]),
            Values::Text(["a", "", "a", "b"].map(Into::into).into()),
        ];
        let mut bytes = Vec::new();
        let written = write_parquet(
            &mut bytes,
            &heads,
            &Rows { values },
            &[("cvtcycle.run", "7")],
        );
        written.unwrap_or_else(|error| unreachable!("{error}"));
        bytes
    })
}

/// Returns the remaining bytes unchanged, or a table with edits, most of them in its footer, whose length stays correct.
fn edited(mut bytes: Bytes) -> Vec<u8> {
    if bytes.one_in(8) {
        return bytes.rest().to_vec();
    }
    let mut body = table().to_vec();
    let mut end = body.split_off(body.len() - END);
    let length = u32::from_le_bytes([end[0], end[1], end[2], end[3]]) as usize;
    let mut footer = body.split_off(body.len() - length);
    for _ in 0..MAX_EDITS {
        if bytes.is_empty() {
            break;
        }
        let part = match bytes.byte() % 16 {
            0 => &mut end,
            1 => &mut body,
            _ => &mut footer,
        };
        edit(part, &mut bytes);
    }
    if end.len() == END {
        let length = u32::try_from(footer.len()).unwrap_or(0);
        end[..4].copy_from_slice(&length.to_le_bytes());
    }
    [body, footer, end].concat()
}

fn edit(part: &mut Vec<u8>, bytes: &mut Bytes) {
    let (way, at) = (bytes.byte(), usize::from(bytes.short()) % (part.len() + 1));
    let count = |bytes: &mut Bytes| usize::from(bytes.byte() % 16);
    match way % 4 {
        0 if at < part.len() => part[at] = bytes.byte(),
        1 if at < part.len() => part[at] ^= 1 << (bytes.byte() % 8),
        2 => drop(part.drain(at..(at + count(bytes)).min(part.len()))),
        _ => {
            let count = count(bytes);
            let junk: Vec<u8> = (0..count).map(|_| bytes.byte()).collect();
            drop(part.splice(at..at, junk));
        }
    }
}

/// Reads metadata only. Pages are read after the checksum matches, since the library trusts them.
pub fn parquet(data: &[u8]) {
    let bytes = edited(Bytes(data));
    let mut file = NamedTempFile::new().expect("a file");
    file.write_all(&bytes).expect("written");
    let sum = sha256(&bytes);
    within_memory(bytes.len(), || {
        if let Some(found) = checked(ParquetFile::open(file.path(), &sum)) {
            let mut pairs = found.metadata().into_iter();
            assert!(pairs.any(|(key, _)| key == COLUMNS), "no heads");
        }
    });
}

/// Creates a folder with files of the user in it and next to it, and two files that wait for their names.
fn folder(journal: &[u8]) -> TempDir {
    let outer = TempDir::new().expect("a folder");
    let dir = outer.path().join("dir");
    fs::create_dir_all(dir.join("folder")).expect("made");
    #[cfg(unix)]
    std::os::unix::fs::symlink("..", dir.join("link")).expect("linked");
    for (name, text) in [
        ("mine.txt", &b"mine"[..]),
        ("dir/mine.txt", b"mine"),
        ("dir/folder/mine.txt", b"mine"),
        ("dir/.cvtcycle-0.tmp", b"new"),
        ("dir/.cvtcycle-1.tmp", b"new"),
        (JOURNAL, journal),
    ] {
        fs::write(outer.path().join(name), text).expect("written");
    }
    outer
}

/// Journal of the folder.
const JOURNAL: &str = "dir/.cvtcycle-commit.json";

/// Contents of a path. None if it is not a file.
fn text(outer: &Path, name: &str) -> Option<Vec<u8>> {
    fs::read(outer.join(name)).ok()
}

/// A journal is applied within its folder, or refused without changes.
pub fn journal(data: &[u8]) {
    let outer = folder(data);
    let root = outer.path();
    let mut settled = None;
    within_memory(data.len(), || settled = Some(settle(&root.join("dir"))));
    let settled = settled.expect("the closure has run");
    let outside: Vec<_> = fs::read_dir(root).expect("read").flatten().collect();
    assert!(outside.len() == 2 && text(root, "mine.txt").as_deref() == Some(b"mine"));
    match settled {
        Ok(()) => assert!(!root.join(JOURNAL).exists(), "the journal is still there"),
        Err(problem) => {
            if problem.kind == ProblemKind::Damaged {
                let own = ["dir/mine.txt", "dir/folder/mine.txt"];
                let new = ["dir/.cvtcycle-0.tmp", "dir/.cvtcycle-1.tmp"];
                assert!(
                    own.iter()
                        .all(|name| text(root, name).as_deref() == Some(b"mine"))
                );
                assert!(
                    new.iter()
                        .all(|name| text(root, name).as_deref() == Some(b"new"))
                );
            }
            assert!(checked::<()>(Err(problem)).is_none());
        }
    }
}
