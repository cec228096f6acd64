//! One rule from computed and printed to a verdict.
//!
//! A number agrees within the printed range widened by the tolerance on both sides, a computed range if both of its ends do, an order or
//! sign if it comes out as printed. What would agree is a fit if a parameter was fitted to it.

use super::expr::Computed;
use super::keys::VERDICTS;

/// What came out of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Computed as printed, within the tolerance.
    Agrees,
    /// Computed as printed because a parameter was fitted to it.
    Fit,
    /// Computed otherwise.
    Differs,
    /// The program has nothing to compare.
    NotComparable,
    /// It has, but not for this car: the number does not exist.
    NotComputed,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Verdict; 5] = [
        Verdict::Agrees,
        Verdict::Fit,
        Verdict::Differs,
        Verdict::NotComparable,
        Verdict::NotComputed,
    ];

    /// The word.
    #[must_use]
    pub fn word(self) -> &'static str {
        let recorded = VERDICTS.get(self as usize);
        recorded.map_or("not computed", |choice| choice.name)
    }

    /// The verdict of a word that a file may record: a row that cannot be computed is a finding, never what was expected.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        let place = VERDICTS.iter().position(|choice| choice.name == word)?;
        Some(Self::ALL[place])
    }
}

/// What is printed, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Printed {
    /// From a smallest to a largest number; infinite where one side is open.
    Range(f64, f64),
    /// An order or sign, or its contrary.
    Truth(bool),
}

/// The verdict of a computed row; `widths` of the tolerance below and above what is printed, in the row's unit.
#[must_use]
pub fn verdict(computed: &Computed, printed: Printed, widths: [f64; 2], fitted: bool) -> Verdict {
    let agrees = match (computed, printed) {
        (Computed::Truth(holds, _), Printed::Truth(wanted)) => *holds == wanted,
        (Computed::Number(x), Printed::Range(..)) => within([*x; 2], printed, widths),
        (Computed::Range(from, to), Printed::Range(..)) => within([*from, *to], printed, widths),
        _ => false,
    };
    match (agrees, fitted) {
        (true, false) => Verdict::Agrees,
        (true, true) => Verdict::Fit,
        (false, _) => Verdict::Differs,
    }
}

/// Whether both ends lie within what is printed and its tolerance; on the limits but for rounding.
fn within([from, to]: [f64; 2], printed: Printed, widths: [f64; 2]) -> bool {
    let Printed::Range(low, high) = printed else {
        return false;
    };
    let (low, high) = (low - widths[0], high + widths[1]);
    let slack = |x: f64| 1e-12 * x.abs();
    low - slack(low) <= from && to <= high + slack(high)
}

/// How far a computed number lies outside the printed range, in widths of the tolerance on that side: 0 within what is printed, up to 1 where it
/// agrees; of a range its worse end. None for orders and signs, and where the tolerance has no width.
#[must_use]
pub fn off(computed: &Computed, printed: Printed, widths: [f64; 2]) -> Option<f64> {
    let Printed::Range(low, high) = printed else {
        return None;
    };
    let one = |x: f64| {
        let below = x < low;
        let beyond = if below { low - x } else { x - high };
        let width = widths[usize::from(!below)];
        match beyond <= 0.0 {
            true => Some(0.0),
            false => (width > 0.0).then(|| beyond / width),
        }
    };
    match computed {
        Computed::Number(x) => one(*x),
        Computed::Range(from, to) => Some(one(*from)?.max(one(*to)?)),
        Computed::Truth(..) => None,
    }
}
