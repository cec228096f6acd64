//! Values of an option: a number, a list, ranges, or these mixed, such as `25,50,75` or `1000..4000:250`.

use cvtcycle::config::{Bound, Problem, Problems, unit_of};

use super::problems::bad_value;

/// Largest number of values of one option.
const MAX_VALUES: f64 = 1e6;
/// A range without a step is cut into at most this many pieces.
const PIECES: f64 = 10.0;

/// The values that the text of an option gives, in the order written, each once.
///
/// Parts are separated by commas. A part is a number, `FROM..TO:STEP` or `FROM..TO` with a round step; the ends of a range
/// belong to it, and TO closes it even where the steps do not meet it. `suffix` is that of a key with the same unit.
///
/// # Errors
/// A problem for each part that is none or out of range.
pub fn values(
    option: &str,
    text: &str,
    allowed: Bound,
    suffix: &str,
) -> Result<Vec<f64>, Problems> {
    values_or_words(option, text, allowed, suffix, &[])
}

/// Like [`values`], with words for some numbers.
///
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
        match list.part(part.trim()) {
            Ok(values) => found.extend(values),
            Err(problem) => problems.push(problem),
        }
    }
    if problems.is_empty() {
        Ok(once(found))
    } else {
        Err(problems)
    }
}

/// Removes repeated values.
fn once(values: Vec<f64>) -> Vec<f64> {
    let mut seen = std::collections::BTreeSet::new();
    // Adding zero turns a negative zero into a plain one.
    values
        .into_iter()
        .map(|x| x + 0.0)
        .filter(|x| seen.insert(x.to_bits()))
        .collect()
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
            return Err(self.bad(
                part,
                "has a step that is not above zero",
                format!("write, for example, {from}..{to}:{}", step_for(low, high)),
            ));
        }
        let count = ((high - low) / step * (1.0 + 1e-12)).floor();
        if count >= MAX_VALUES {
            return Err(self.bad(
                part,
                &format!("has {:.0} values", count + 1.0),
                format!("at most {MAX_VALUES} values; take a larger step"),
            ));
        }
        let mut values: Vec<f64> = (0..=count as u32)
            .map(|i| clean(low + f64::from(i) * step))
            .collect();
        let near = |x: &f64| (high - x).abs() <= 1e-9 * step;
        if values.last().is_some_and(near) {
            values.pop();
        }
        values.push(high);
        Ok(values)
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
        text.parse::<f64>()
            .ok()
            .filter(|x| x.is_finite())
            .ok_or_else(|| self.bad(part, what, self.example()))
    }

    fn within(&self, part: &str, x: f64) -> Result<f64, Problem> {
        if self.allowed.contains(x) {
            Ok(x)
        } else {
            Err(self.bad(part, "is out of range", String::new()))
        }
    }

    fn bad(&self, part: &str, what: &str, hint: String) -> Problem {
        let named = if part.is_empty() {
            "an empty value".to_owned()
        } else {
            format!("`{part}`")
        };
        let words: String = self
            .words
            .iter()
            .map(|(word, _)| format!("{word}, "))
            .collect();
        let also = if words.is_empty() { "" } else { "or " };
        let allowed = format!("{words}{also}{}", self.allowed.in_unit(self.unit));
        bad_value(
            self.option,
            part,
            &allowed,
            &format!("{named} {what}"),
            &hint,
        )
    }

    fn example(&self) -> String {
        let (low, high) = (10.0, 40.0);
        let (low, high) = if self.allowed.contains(low) && self.allowed.contains(high) {
            (low, high)
        } else {
            (0.5, 2.0)
        };
        let step = step_for(low, high);
        format!(
            "write a number, a list ({0} {low},{high}), a range with a step ({0} {low}..{high}:{step}), or these mixed",
            self.option
        )
    }
}

/// A round step for a range.
fn step_for(low: f64, high: f64) -> f64 {
    clean(round_step((high - low) / PIECES))
}

/// Without the last digits, in which sums of decimal fractions carry their rounding.
fn clean(x: f64) -> f64 {
    format!("{x:.12e}").parse().unwrap_or(x)
}

/// 1, 2 or 5 times a power of ten, not below `x`; 1 where there is no range.
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
mod tests {
    use super::*;

    fn good(text: &str) -> Vec<f64> {
        values("--speed", text, Bound::closed(-100.0, 7000.0), "_rpm")
            .unwrap_or_else(|p| panic!("{text}: {p:?}"))
    }

    fn bad(text: &str) -> Problems {
        values("--speed", text, Bound::closed(-100.0, 7000.0), "_rpm").expect_err(text)
    }

    #[test]
    fn numbers_lists_and_ranges_mixed() {
        assert_eq!(good("2500"), [2500.0]);
        assert_eq!(good(" 25, 50 ,75"), [25.0, 50.0, 75.0]);
        assert_eq!(good("1000..1500:250"), [1000.0, 1250.0, 1500.0]);
        assert_eq!(good("-10..40:25"), [-10.0, 15.0, 40.0]);
        assert_eq!(good("5,1..3:1,3,7"), [5.0, 1.0, 2.0, 3.0, 7.0]);
        assert_eq!(good("3..3"), [3.0]);
        assert_eq!(good("-0"), [0.0]);
        assert!(good("0,-0").len() == 1);
    }

    /// Hand calculation: both ends belong to a range, and decimal steps stay decimal.
    #[test]
    fn val_ends_and_decimals() {
        assert_eq!(good("0..0.3:0.1"), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(good("1000..2100:500"), [1000.0, 1500.0, 2000.0, 2100.0]);
        assert_eq!(
            good("1000..4000"),
            [1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0]
        );
        assert_eq!(good("0..100").len(), 11);
        assert_eq!(good("10..12:0.5"), [10.0, 10.5, 11.0, 11.5, 12.0]);
        assert_eq!(good("1e3..3e3:1e3"), [1000.0, 2000.0, 3000.0]);
    }

    #[test]
    fn words_replace_numbers() {
        let words = [("low", 2.4), ("high", 0.4)];
        let found = values_or_words(
            "--ratio",
            "high,1..low:1",
            Bound::closed(0.3, 3.0),
            "",
            &words,
        )
        .expect("words");
        assert_eq!(found, [0.4, 1.0, 2.0, 2.4]);
        let problems = values_or_words("--ratio", "lo", Bound::closed(0.3, 3.0), "", &words)
            .expect_err("no word");
        assert!(
            problems[0].allowed.contains("low, high, or 0.3 to 3"),
            "{problems:?}"
        );
    }

    #[test]
    fn every_bad_part_is_reported() {
        assert_eq!(bad("25,x,50,9999").len(), 2);
        for (text, word) in [
            ("", "empty"),
            ("25,", "empty"),
            ("nan", "not a number"),
            ("inf", "not a number"),
            ("5..1:1", "begins above"),
            ("1..5:0", "above zero"),
            ("1..5:-1", "above zero"),
            ("1..5:x", "not a number"),
            ("1..", "not a number"),
            ("..5", "not a number"),
            ("1..2..3", "not a number"),
            ("0..7000:0.001", "7000001 values"),
            ("0..8000:1", "out of range"),
            ("1000-4000", "not a number"),
        ] {
            let problems = bad(text);
            assert!(
                problems[0].message.contains(word),
                "{text}: {:?}",
                problems[0]
            );
            assert_eq!(problems[0].allowed, "-100 to 7000 rpm");
        }
        assert!(
            bad("x")[0].hint.contains("--speed 10..40:5"),
            "{}",
            bad("x")[0].hint
        );
    }
}
