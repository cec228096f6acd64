//! How a table separates its columns and writes its decimals: found in its text, and refused where it can be read in two ways.

use super::collector::{Collector, Line};
use super::text::Delimiter::{self, Comma};
use super::text::{Field, split};
use crate::Problem;
use crate::problem::source::shortened;

/// Rows that decide between two signs that both separate the column names.
const SAMPLE: usize = 20;
/// A longer number is not repeated in a sentence.
const MAX_NUMBER_LEN: usize = 30;

impl Delimiter {
    /// The number of fields of a line; none where a quote is not closed.
    fn count(self, line: Line<'_>) -> Option<usize> {
        let mut fields = Vec::new();
        split(line.text, self.sign(), &mut fields).ok()?;
        Some(fields.len())
    }

    /// Separator of a line of column names and the lines below it: the only sign that splits the names, or the one of several that splits most of
    /// the lines below into as many fields.
    ///
    /// # Errors
    /// Two signs do so equally well.
    pub(super) fn detect<'t>(
        names: Line<'t>,
        below: impl Iterator<Item = Line<'t>> + Clone,
    ) -> Result<Delimiter, [Delimiter; 2]> {
        let splits = |d: &Delimiter| d.count(names).is_some_and(|count| count > 1);
        let fitting = |d: Delimiter| {
            let fits = |line: &Line<'_>| d.count(*line) == d.count(names);
            below.clone().take(SAMPLE).filter(fits).count()
        };
        let there = Delimiter::ALL.into_iter().filter(splits);
        let mut rated: Vec<(usize, Delimiter)> = there.map(|d| (fitting(d), d)).collect();
        rated.sort_by_key(|(count, _)| std::cmp::Reverse(*count));
        match rated.as_slice() {
            [] => Ok(Comma),
            [(first, one), (second, other), ..] if first == second => Err([*one, *other]),
            [(_, one), ..] => Ok(*one),
        }
    }

    /// [`Delimiter::of`], with two readings reported.
    pub(super) fn find<'t>(
        names: Line<'t>,
        below: impl Iterator<Item = Line<'t>> + Clone,
        problems: &mut Collector<'_>,
    ) -> Option<Delimiter> {
        let found = Delimiter::detect(names, below);
        let report = |both: &[Delimiter; 2]| {
            let [one, other] = both.map(|d| (d.count(names).unwrap_or(0), d.word()));
            let message = format!(
                "these column names can be read in two ways: {} with a {} between them, or {} with a {}",
                one.0, one.1, other.0, other.1
            );
            problems.line(names, "", || {
                Problem::syntax(message)
                    .allowed("one sign between all columns")
                    .hint("put a name that holds such a sign into double quotes")
            });
        };
        found.inspect_err(report).ok()
    }
}

/// How the text of a number writes its decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Decimals {
    Point,
    Comma,
    /// A comma, after which there are three figures as between thousands.
    Either,
}

fn decimals(text: &str) -> Option<Decimals> {
    let is_number = |text: &str| text.parse::<f64>().is_ok_and(f64::is_finite);
    match (text.contains('.'), text.split_once(',')) {
        (true, None) => is_number(text).then_some(Decimals::Point),
        (false, Some((whole, rest))) => {
            let digits = whole.trim_start_matches(['+', '-']);
            let thousands = (1..=3).contains(&digits.len())
                && !digits.starts_with('0')
                && rest.len() == 3
                && rest.bytes().all(|byte| byte.is_ascii_digit());
            let either = if thousands {
                Decimals::Either
            } else {
                Decimals::Comma
            };
            is_number(&with_point(text)).then_some(either)
        }
        _ => None,
    }
}

/// A number with a decimal comma as the program's own.
pub(super) fn with_point(text: &str) -> String {
    text.replacen(',', ".", 1)
}

/// True if the numbers of a table have decimal commas; only the columns of numbers count. None where they can be read in two ways,
/// which is reported at the cell that shows it.
pub(super) fn decimal_comma<'t>(
    rows: impl Iterator<Item = Line<'t>>,
    delimiter: Delimiter,
    is_number: &[bool],
    problems: &mut Collector<'_>,
) -> Option<bool> {
    if delimiter == Comma {
        return Some(false);
    }
    let mut fields = Vec::new();
    let mut first: [Option<(Line<'t>, Field)>; 3] = [None; 3];
    for line in rows {
        if split(line.text, delimiter.sign(), &mut fields).is_err() {
            continue;
        }
        for (&field, _) in fields.iter().zip(is_number).filter(|(_, is)| **is) {
            if let Some(found) = decimals(line.text_of(field)) {
                first[found as usize].get_or_insert((line, field));
            }
        }
        if let [Some(point), comma, either] = first
            && let Some(other) = comma.or(either)
        {
            return two_ways(point, other, problems);
        }
    }
    match first {
        [None, None, Some((line, field))] => {
            let text = line.text_of(field);
            let (small, large) = (with_point(text), text.replacen(',', "", 1));
            problems.value(line, field, "", || {
                Problem::syntax(format!(
                    "this number can be read in two ways: {small}, or {large} with a comma between thousands"
                ))
                .allowed("a number whose figures behind the comma cannot be thousands, such as 1,50")
                .hint("save it with decimal points, and with no sign between thousands")
            });
            None
        }
        [_, comma, _] => Some(comma.is_some()),
    }
}

/// Reports a number with a decimal point and one with a comma, at the later one.
fn two_ways(
    point: (Line<'_>, Field),
    comma: (Line<'_>, Field),
    problems: &mut Collector<'_>,
) -> Option<bool> {
    let place = |(line, field): (Line<'_>, Field)| (line.number, field.start);
    let (first, later) = match place(point) < place(comma) {
        true => (point, comma),
        false => (comma, point),
    };
    let other = shortened(first.0.text_of(first.1), MAX_NUMBER_LEN);
    let message = format!(
        "this number and {other} in line {} do not write their decimals alike",
        first.0.number
    );
    problems.value(later.0, later.1, "", || {
        Problem::syntax(message)
            .allowed("decimal points in all numbers, or decimal commas in all")
            .hint("save it with decimal points, and with no sign between thousands")
    });
    None
}
