//! The equations that stand at the heads of the model files, with label, status and place.
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
    /// File below `src`.
    pub file: &'static str,
}

macro_rules! source {
    ($path:literal) => {
        ($path, include_str!(concat!("../", $path)))
    };
}

/// Model files in the order in which power and heat flow, then the rigs and the studies.
const SOURCES: &[(&str, &str)] = &[
    source!("vehicle/mod.rs"),
    source!("transmission/launch.rs"),
    source!("transmission/film_heating.rs"),
    source!("transmission/cvt/mod.rs"),
    source!("transmission/cvt/controller/ratio.rs"),
    source!("transmission/cvt/controller/pressure.rs"),
    source!("transmission/cvt/variator/mod.rs"),
    source!("transmission/cvt/variator/geometry.rs"),
    source!("transmission/cvt/variator/tension.rs"),
    source!("transmission/cvt/variator/bands.rs"),
    source!("transmission/cvt/variator/slip.rs"),
    source!("transmission/cvt/variator/deflection.rs"),
    source!("transmission/cvt/variator/printed.rs"),
    source!("transmission/cvt/pump.rs"),
    source!("transmission/cvt/spin.rs"),
    source!("transmission/manual/mod.rs"),
    source!("engine/mod.rs"),
    source!("engine/fuel.rs"),
    source!("lubricant/mod.rs"),
    source!("thermal/mod.rs"),
    source!("simulate.rs"),
    source!("results/ledger.rs"),
    source!("rig/bench.rs"),
    source!("rig/transmission/transient.rs"),
    source!("rig/transmission/strip_down.rs"),
    source!("rig/variator/mod.rs"),
    source!("study/design/mod.rs"),
    source!("study/design/draw.rs"),
    source!("study/plan/distribution.rs"),
    source!("study/statistics/describe.rs"),
    source!("study/statistics/intervals.rs"),
    source!("study/statistics/sobol.rs"),
    source!("study/statistics/rank.rs"),
    source!("study/statistics/groups.rs"),
    source!("study/statistics/tornado.rs"),
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
