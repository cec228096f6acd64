//! What is wrong with an input, as data: place, value, allowed range and a hint.

/// Where in the user's input a problem stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// File name as the user gave it, `embedded:NAME`, or `--set` / `--ambient` for the command line.
    pub file: String,
    /// Line, counted from 1; 0 where the input has no lines.
    pub line: usize,
    /// Column of the first character of the value, counted from 1; 0 where unknown.
    pub column: usize,
    /// The text of that line, for the caret; empty where unknown.
    pub line_text: String,
    /// Number of characters that the caret underlines.
    pub width: usize,
}

/// One problem of the user's input. All problems of an input are collected before any is shown.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problem {
    /// Where it stands.
    pub place: Place,
    /// Dotted key, CSV column name or option; empty where the whole file is meant.
    pub key: String,
    /// The offending value as written; empty where something is missing.
    pub value: String,
    /// What would be accepted, in words or as a range with its unit; empty where there is no range.
    pub allowed: String,
    /// What is wrong, one sentence without the place.
    pub message: String,
    /// What to do about it; empty if nothing useful can be said.
    pub hint: String,
}

/// A number for a sentence: so many decimals, and with a power of ten where the figures before the point would be no help.
pub fn readable(x: f64, decimals: usize) -> String {
    if x.abs() < 1e6 {
        format!("{x:.decimals$}")
    } else {
        format!("{x:.1e}")
    }
}

/// The end of the sentence that counts what is not shown, for one and for several.
const NOT_SHOWN: [&str; 2] = [" more problem is not shown", " more problems are not shown"];

impl Problem {
    /// The last entry of a list that would be too long: how many more problems the file has.
    #[must_use]
    pub fn more(file: &str, count: usize) -> Self {
        Problem {
            place: Place {
                file: file.to_string(),
                ..Place::default()
            },
            message: format!("{count}{}", NOT_SHOWN[usize::from(count != 1)]),
            hint: "mend the ones above first; they often have one cause".to_string(),
            ..Problem::default()
        }
    }

    /// The number of a [`Problem::more`]; none of any other problem.
    #[must_use]
    pub fn not_shown(&self) -> Option<usize> {
        let count = NOT_SHOWN
            .iter()
            .find_map(|end| self.message.strip_suffix(end));
        count
            .filter(|_| self.place.line == 0)
            .and_then(|count| count.parse().ok())
    }
}

/// Most problems of one input that are kept in words.
const MOST_KEPT: usize = 1000;

/// Puts the problems of a part of an input behind those of the parts before it. Beyond some number they are counted only, in one last entry:
/// a file of nothing but mistakes has more of them than its own size in memory.
pub fn append(all: &mut Vec<Problem>, found: Vec<Problem>) {
    let mut rest = all.pop_if(|last| last.not_shown().is_some());
    for problem in found {
        match (problem.not_shown(), all.len() < MOST_KEPT) {
            (None, true) => all.push(problem),
            (count, _) => {
                let before = rest.and_then(|rest| rest.not_shown()).unwrap_or(0);
                rest = Some(Problem::more(
                    &problem.place.file,
                    before + count.unwrap_or(1),
                ));
            }
        }
    }
    all.extend(rest);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(count: usize) -> Vec<Problem> {
        let one = |line| Problem {
            place: Place {
                file: "f".into(),
                line,
                ..Place::default()
            },
            message: "no".into(),
            ..Problem::default()
        };
        (1..=count).map(one).collect()
    }

    #[test]
    fn problems_beyond_some_number_are_counted_together() {
        let mut all = Vec::new();
        append(&mut all, some(MOST_KEPT - 1));
        assert_eq!(all.len(), MOST_KEPT - 1);
        append(&mut all, some(2));
        assert_eq!(all[MOST_KEPT].message, "1 more problem is not shown");
        append(&mut all, [some(3), vec![Problem::more("f", 70)]].concat());
        append(&mut all, Vec::new());
        assert_eq!(
            (
                all.len(),
                all[MOST_KEPT].not_shown(),
                all[MOST_KEPT].place.file.as_str()
            ),
            (MOST_KEPT + 1, Some(74), "f")
        );
        assert!(
            all[..MOST_KEPT]
                .iter()
                .all(|problem| problem.not_shown().is_none())
        );
        let mut short = some(1);
        append(&mut short, vec![Problem::more("g", 5)]);
        append(&mut short, some(1));
        assert_eq!(
            short
                .iter()
                .filter_map(Problem::not_shown)
                .collect::<Vec<_>>(),
            [5]
        );
        assert_eq!((short.len(), short[2].not_shown()), (3, Some(5)));
    }
}
