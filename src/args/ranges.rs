//! Values of an option: a number, a list, ranges, or these mixed, such as `25,50,75` or `1000..4000:250`.

use cvtcycle::config::{Bound, Problem, Problems, decimal, evenly, unit_of};

use super::problems::bad_value;
use super::{nearest, quoted};

/// Maximum number of values of one option.
const MAX_VALUES: f64 = 1e6;
/// A range without a step is cut into at most this many pieces.
const PIECES: f64 = 10.0;

/// Parses the values of an option, in the order written, without repetitions.
/// Parts are separated by commas. A part is a number, `FROM..TO:STEP` or `FROM..TO` with a round step; the ends of a range
/// belong to it, and TO closes it even if no step meets it. `suffix` is that of a key with the same unit.
/// # Errors
/// One problem for each part that is malformed or out of range.
pub fn values(
    option: &str,
    text: &str,
    allowed: Bound,
    suffix: &str,
) -> Result<Vec<f64>, Problems> {
    values_or_words(option, text, allowed, suffix, &[])
}

/// As [`values`], with words for some numbers.
/// # Errors
/// As [`values`].
pub fn values_or_words(
    option: &str,
    text: &str,
    allowed: Bound,
    suffix: &str,
    words: &[(&str, f64)],
) -> Result<Vec<f64>, Problems> {
    let list = List {
        option,
        allowed,
        unit: unit_of(suffix),
        words,
    };
    let (mut found, mut problems) = (Vec::new(), Problems::new());
    for part in text.split(',') {
        found.extend(problems.take(list.part(part.trim())).unwrap_or_default());
    }
    problems.finish().map(|()| without_repeats(found))
}

/// Removes repeated values and keeps the order.
fn without_repeats(values: Vec<f64>) -> Vec<f64> {
    let mut seen = std::collections::BTreeSet::new();
    // Adding zero turns -0.0 into 0.0.
    let values = values.into_iter().map(|x| x + 0.0);
    values.filter(|x| seen.insert(x.to_bits())).collect()
}

struct List<'a> {
    option: &'a str,
    allowed: Bound,
    unit: &'a str,
    words: &'a [(&'a str, f64)],
}

impl List<'_> {
    fn part(&self, part: &str) -> Result<Vec<f64>, Problem> {
        let Some((from, rest)) = part.split_once("..") else {
            return self.within(part, self.number(part, part)?).map(|x| vec![x]);
        };
        let (to, step) = rest
            .split_once(':')
            .map_or((rest, None), |(to, step)| (to, Some(step)));
        let low = self.within(part, self.number(part, from)?)?;
        let high = self.within(part, self.number(part, to)?)?;
        if low > high {
            return Err(self.bad(part, "begins above its end", format!("write {to}..{from}")));
        }
        let step = match step {
            Some(text) => self.number(part, text)?,
            None => round_step((high - low) / PIECES),
        };
        if step <= 0.0 || !step.is_finite() {
            let hint = format!("write, for example, {from}..{to}:{}", step_for(low, high));
            return Err(self.bad(part, "has a step that is not above zero", hint));
        }
        evenly(low, high, step, MAX_VALUES).map_err(|count| {
            let hint = format!("at most {MAX_VALUES} values; take a larger step");
            self.bad(part, &format!("has {count:.0} values"), hint)
        })
    }

    fn number(&self, part: &str, text: &str) -> Result<f64, Problem> {
        let text = text.trim();
        if let Some((_, x)) = self.words.iter().find(|(word, _)| *word == text) {
            return Ok(*x);
        }
        let what = if part == text || text.is_empty() {
            "is not a number"
        } else {
            "has an end or step that is not a number"
        };
        let number = text.parse::<f64>().ok().filter(|x| x.is_finite());
        number.ok_or_else(|| self.bad(part, what, self.example()))
    }

    fn within(&self, part: &str, x: f64) -> Result<f64, Problem> {
        match self.allowed.contains(x) {
            true => Ok(x),
            false => {
                let hint = nearest(self.allowed, x, self.unit);
                Err(self.bad(part, "is out of range", hint))
            }
        }
    }

    fn bad(&self, part: &str, what: &str, hint: String) -> Problem {
        let words = self.words.iter().map(|(word, _)| format!("{word}, "));
        let words: String = words.collect();
        let also = if words.is_empty() { "" } else { "or " };
        let allowed = format!("{words}{also}{}", self.allowed.in_unit(self.unit));
        let message = format!("{} {what}", quoted(part));
        bad_value(self.option, part, &allowed, &message, &hint)
    }

    fn example(&self) -> String {
        let both = |low, high| self.allowed.contains(low) && self.allowed.contains(high);
        let (low, high) = if both(10.0, 40.0) {
            (10.0, 40.0)
        } else {
            (0.5, 2.0)
        };
        let (option, step) = (self.option, step_for(low, high));
        format!(
            "write a number, a list ({option} {low},{high}), a range with a step ({option} {low}..{high}:{step}), or these mixed"
        )
    }
}

/// Round step that divides a range into at most [`PIECES`].
fn step_for(low: f64, high: f64) -> f64 {
    decimal(round_step((high - low) / PIECES))
}

/// Smallest number not below `x` that is 1, 2 or 5 times a power of ten; 1 for an empty range.
fn round_step(x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let power = 10f64.powf(x.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|f| x / power <= f * (1.0 + 1e-9));
    power * factor.unwrap_or(10.0)
}

#[cfg(test)]
#[path = "../../tests/cli/ranges.rs"]
mod tests;
