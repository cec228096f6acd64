//! The equations at the heads of the model files, with label, status and place.
//!
//! The heads are read from the sources themselves, so that `explain` and the book of assumptions cannot drift from them.

/// One line of a model file's head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Equation {
    /// Label, such as `SL-3`.
    pub label: &'static str,
    /// Statement.
    pub statement: &'static str,
    /// `source …`, `derived …`, `fitted …` or `ASSUMED …`.
    pub status: &'static str,
    /// Source file, from the root of the repository.
    pub file: &'static str,
}

macro_rules! source {
    ($path:literal) => {
        ($path, include_str!(concat!("../../../../", $path)))
    };
}

/// Model files in the order in which power and heat flow, then the rigs and the studies.
const SOURCES: &[(&str, &str)] = &[
    source!("crates/model/src/road.rs"),
    source!("crates/model/src/transmission/coupling/friction_clutch.rs"),
    source!("crates/model/src/transmission/film_heating.rs"),
    source!("crates/model/src/transmission/cvt/mod.rs"),
    source!("crates/model/src/transmission/cvt/controller/ratio.rs"),
    source!("crates/model/src/transmission/cvt/controller/pressure.rs"),
    source!("crates/model/src/transmission/cvt/variator/mod.rs"),
    source!("crates/model/src/transmission/cvt/variator/geometry.rs"),
    source!("crates/model/src/transmission/cvt/variator/tension.rs"),
    source!("crates/model/src/transmission/cvt/variator/bands.rs"),
    source!("crates/model/src/transmission/cvt/variator/slip.rs"),
    source!("crates/model/src/transmission/cvt/variator/deflection.rs"),
    source!("crates/model/src/transmission/cvt/variator/printed.rs"),
    source!("crates/model/src/transmission/cvt/pump.rs"),
    source!("crates/model/src/transmission/cvt/spin.rs"),
    source!("crates/model/src/transmission/manual/mod.rs"),
    source!("crates/model/src/engine/mod.rs"),
    source!("crates/model/src/engine/fuel.rs"),
    source!("crates/model/src/maps/bsfc.rs"),
    source!("crates/model/src/fluid/mod.rs"),
    source!("crates/model/src/thermal/mod.rs"),
    source!("crates/model/src/drive/step.rs"),
    source!("crates/model/src/drive/balance.rs"),
    source!("crates/model/src/bench/held_point.rs"),
    source!("crates/model/src/bench/transmission/transient.rs"),
    source!("crates/model/src/bench/transmission/strip_down.rs"),
    source!("crates/model/src/bench/variator/mod.rs"),
    source!("crates/study/src/design/mod.rs"),
    source!("crates/study/src/design/draw.rs"),
    source!("crates/study/src/plan/distribution.rs"),
    source!("crates/study/src/statistics/describe.rs"),
    source!("crates/study/src/statistics/intervals.rs"),
    source!("crates/study/src/statistics/sobol.rs"),
    source!("crates/study/src/statistics/rank.rs"),
    source!("crates/study/src/statistics/groups.rs"),
    source!("crates/study/src/statistics/tornado.rs"),
];

/// All equations.
pub fn equations() -> impl Iterator<Item = Equation> {
    SOURCES
        .iter()
        .flat_map(|(file, text)| text.lines().filter_map(|line| equation(file, line)))
}

/// The equation of that label.
#[must_use]
pub fn by_label(label: &str) -> Option<Equation> {
    equations().find(|equation| equation.label.eq_ignore_ascii_case(label))
}

/// The equations whose labels a text names in brackets, as in "displacement (PU-1, PU-4)".
pub fn cited(text: &str) -> Vec<Equation> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words
        .filter(|word| is_label(word))
        .filter_map(by_label)
        .collect()
}

fn is_label(word: &str) -> bool {
    word.split_once('-').is_some_and(|(letters, digits)| {
        letters.len() == 2
            && letters.bytes().all(|b| b.is_ascii_uppercase())
            && !digits.is_empty()
            && digits.bytes().all(|b| b.is_ascii_digit())
    })
}

/// `//! | label | statement | status |`, where a bar within a cell is written `\\|`.
fn equation(file: &'static str, line: &'static str) -> Option<Equation> {
    let mut cells = Vec::new();
    let mut rest = line.strip_prefix("//! |")?;
    while let Some(end) = bar(rest) {
        cells.push(rest[..end].trim());
        rest = &rest[end + 1..];
    }
    match cells.as_slice() {
        [label, statement, status] if is_label(label) => Some(Equation {
            label,
            statement,
            status,
            file,
        }),
        _ => None,
    }
}

/// The first bar that is none of the cell's own.
fn bar(text: &str) -> Option<usize> {
    text.bytes()
        .enumerate()
        .find(|(at, byte)| *byte == b'|' && !text[..*at].ends_with('\\'))
        .map(|(at, _)| at)
}

/// Source files below a folder, as paths relative to it.
#[cfg(test)]
fn source_files(folder: &std::path::Path, below: &str, list: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let name = format!("{below}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            source_files(&entry.path(), &format!("{name}/"), list);
        } else {
            list.push(name);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_with_such_a_head_is_listed() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        let mut files = Vec::new();
        source_files(&folder, "", &mut files);
        for file in files.iter().filter(|file| !file.ends_with("equations.rs")) {
            let text = std::fs::read_to_string(folder.join(file)).unwrap();
            let listed = SOURCES.iter().any(|(name, _)| name == file);
            assert_eq!(
                text.contains("\n//! | label | statement | status |"),
                listed,
                "{file}"
            );
        }
    }

    #[test]
    fn labels_are_unique_and_every_line_has_a_status() {
        let all: Vec<Equation> = equations().collect();
        assert!(all.len() > 80, "{}", all.len());
        for (k, equation) in all.iter().enumerate() {
            assert!(
                all[..k].iter().all(|other| other.label != equation.label),
                "{}",
                equation.label
            );
            assert!(
                !equation.status.is_empty() && !equation.statement.is_empty(),
                "{}",
                equation.label
            );
        }
        assert!(by_label("LE-3").unwrap().statement.contains("in - out"));
        assert_eq!(cited("displacement (PU-1, PU-4)").len(), 2);
        assert!(cited("class UN-R83 (none)").is_empty());
    }
}
