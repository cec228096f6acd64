//! Files of a study: their checksums, as lists in the format of `sha256sum`; put into place, removed.

use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::names::{self, MANIFEST, PARTS, PLAN, RESULTS};
use cvtcycle_config::bounded;
use cvtcycle_output::files::{LOCK, Summing, hex, is_temporary, temporary_in};
pub use cvtcycle_output::files::{Sum, sha256, sum_of};
use tempfile::NamedTempFile;

/// Names of files with their checksums.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Checksums(pub Vec<(String, Sum)>);

impl Checksums {
    /// The list as text, one file a line.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for (name, sum) in &self.0 {
            text += &format!("{}  {name}\n", hex(sum));
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

/// Files of a folder, and links, which are not followed; none of a folder that is not there.
fn files_in(folder: &Path, which: impl Fn(&str) -> bool) -> io::Result<Vec<PathBuf>> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry?;
        if which(&entry.file_name().to_string_lossy()) && !entry.file_type()?.is_dir() {
            found.push(entry.path());
        }
    }
    Ok(found)
}

/// Removes the results and parts of an earlier study, and nothing else.
pub fn clear(path: &Path) -> io::Result<()> {
    removals(path)?.iter().try_for_each(fs::remove_file)
}

/// Lists the files that [`clear`] removes, in this order: marks go before the files that they vouch for, so that an interruption leaves a
/// study with fewer parts, and the list of the results after them, so that the next one finds them.
fn removals(path: &Path) -> io::Result<Vec<PathBuf>> {
    let results = Checksums::read(&path.join(RESULTS)).unwrap_or_default();
    let parts = names::parts_folder(path);
    let is_mark = |name: &str| names::marked_part(name).is_some();
    Ok([
        files_in(&parts, is_mark)?,
        files_in(path, |name| {
            is_temporary(name) || (names::is_result(name) && results.get(name).is_some())
        })?,
        files_in(path, |name| name == RESULTS)?,
        files_in(&parts, |name| {
            !is_mark(name) && (is_temporary(name) || names::is_part_file(name))
        })?,
    ]
    .concat())
}

/// The first of a study's own names that is a link, in words: what is behind it is no part of the study.
pub fn link_in(path: &Path) -> Option<String> {
    let is_link =
        |name: &&str| fs::symlink_metadata(path.join(name)).is_ok_and(|found| found.is_symlink());
    let name = [LOCK, MANIFEST, PLAN, PARTS, RESULTS]
        .into_iter()
        .find(is_link)?;
    Some(format!(
        "{name} in {} is a link; it is not followed",
        path.display()
    ))
}

/// Advice where [`link_in`] finds a link.
pub const NO_LINK: &str = "put the file or folder itself there, or name another directory";

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

    /// Wherever the removal of an earlier study ends, every mark that is left has its files, and the next removal finds the rest.
    #[test]
    fn what_an_interrupted_removal_leaves_is_a_study_with_fewer_parts() {
        let folder = || {
            let dir = tempfile::tempdir().expect("a folder");
            let parts = names::parts_folder(dir.path());
            fs::create_dir(&parts).expect("made");
            let write =
                |name: &str, text: &str| fs::write(dir.path().join(name), text).expect("written");
            for part in 0..3 {
                write(&format!("parts/runs_{part:05}.parquet"), "rows");
                write(&format!("parts/{}", names::part_mark(part)), "sums");
            }
            let sums =
                ["statistics.json", "tornado.svg"].map(|name| (name.to_owned(), sha256(b"")));
            sums.iter().for_each(|(name, _)| write(name, ""));
            write(RESULTS, &Checksums(sums.to_vec()).text());
            write("mine.svg", "");
            dir
        };
        let there = |dir: &Path, name: String| dir.join(PARTS).join(name).exists();
        let all = removals(folder().path()).expect("listed").len();
        assert_eq!(all, 9);
        for removed in 0..=all {
            let dir = folder();
            let list = removals(dir.path()).expect("listed");
            for path in &list[..removed] {
                fs::remove_file(path).expect("removed");
            }
            let marked = (0..3).filter(|part| there(dir.path(), names::part_mark(*part)));
            let marked: Vec<usize> = marked.collect();
            assert_eq!(marked.len(), 3_usize.saturating_sub(removed));
            assert!(
                marked
                    .iter()
                    .all(|part| there(dir.path(), names::part_file("runs", *part, "parquet")))
            );
            clear(dir.path()).expect("cleared");
            let left = fs::read_dir(dir.path())
                .expect("read")
                .filter_map(Result::ok);
            let mut left: Vec<_> = left.map(|entry| entry.file_name()).collect();
            left.sort();
            assert_eq!(left, ["mine.svg", PARTS]);
        }
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
