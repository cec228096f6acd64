//! The user's files where there is no disk: a program in a page has with it what was read when the page was made.
//!
//! [`reading`] notes every file that something reads; [`carry`] gives the same files to a program elsewhere, under the same names.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// Files by the path under which they were read, with `/` between folders.
pub type Files = BTreeMap<String, Vec<u8>>;

static CARRIED: OnceLock<Files> = OnceLock::new();

thread_local! {
    static NOTED: RefCell<Option<Files>> = const { RefCell::new(None) };
}

/// Result of `read`, and every file that it has read on this thread.
pub fn reading<T>(read: impl FnOnce() -> T) -> (T, Files) {
    let before = NOTED.replace(Some(Files::new()));
    let made = read();
    (made, NOTED.replace(before).unwrap_or_default())
}

/// Gives files to this program for as long as it runs: they are read in place of those on a disk. Only the first call counts.
pub fn carry(files: Files) {
    let _ = CARRIED.set(files);
}

/// The bytes of a carried file.
pub(super) fn find(path: &Path) -> Option<&'static [u8]> {
    let files = CARRIED.get()?;
    files.get(&name(path)).map(Vec::as_slice)
}

/// Notes a file that was read.
pub(super) fn note(path: &Path, bytes: &[u8]) {
    NOTED.with_borrow_mut(|noted| {
        if let Some(files) = noted {
            files.insert(name(path), bytes.to_vec());
        }
    });
}

fn name(path: &Path) -> String {
    let text = path.to_string_lossy();
    match cfg!(windows) {
        true => text.replace('\\', "/"),
        false => text.into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::bounded;
    use super::*;

    /// Truth: what was written. The file is gone when it is read again.
    #[test]
    #[allow(clippy::unwrap_used, reason = "a test")]
    fn what_was_read_can_be_read_where_there_is_no_disk() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.toml");
        std::fs::write(&file, "text").unwrap();
        let (bytes, files) = reading(|| bounded::read_file(&file, bounded::TOML).unwrap());
        assert_eq!(bytes, b"text");
        assert_eq!(files.into_values().collect::<Vec<_>>(), [b"text".to_vec()]);
        let gone = folder.path().join("gone.toml");
        assert!(bounded::read_file(&gone, bounded::TOML).is_err());
        carry(Files::from([(name(&gone), b"carried".to_vec())]));
        let found = bounded::read_file(&gone, bounded::TOML).unwrap();
        assert_eq!(found, b"carried");
        let (_, files) = reading(|| ());
        assert!(files.is_empty());
    }
}
