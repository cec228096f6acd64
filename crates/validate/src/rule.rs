//! One rule from computed and printed to a verdict.
//!
//! A number agrees within the printed range widened by the tolerance on both sides, a computed range if both of its ends do, an order or
//! sign if it comes out as printed. Against a fleet a number agrees where it lies as near to the mean as one more car of that fleet may. What
//! would agree is a fit if a parameter was fitted to it.

use super::expr::Computed;
use super::keys::{GROUPS, VERDICTS};

/// What came out of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// Computed as printed, within the tolerance.
    Agrees,
    /// Computed as printed because a parameter was fitted to it.
    Fit,
    /// Computed as printed, and recorded as what cannot come out otherwise.
    Identity,
    /// Computed otherwise.
    Differs,
    /// The program has nothing to compare.
    NotComparable,
    /// It has, but not for this car: the number does not exist.
    NotComputed,
}

impl Verdict {
    /// All of them.
    pub const ALL: [Verdict; 6] = [
        Verdict::Agrees,
        Verdict::Fit,
        Verdict::Identity,
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

/// Whose numbers the rows of a file have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// The thesis.
    Thesis,
    /// Public data of other cars.
    Outside,
    /// The user's.
    Own,
}

impl Group {
    /// All of them.
    pub const ALL: [Group; 3] = [Group::Thesis, Group::Outside, Group::Own];

    /// The word.
    #[must_use]
    pub fn word(self) -> &'static str {
        GROUPS[self as usize].name
    }

    /// The group of a word; the user's for any other.
    #[must_use]
    pub fn from_word(word: &str) -> Self {
        let found = Self::ALL.into_iter().find(|group| group.word() == word);
        found.unwrap_or(Group::Own)
    }
}

/// Cars of which a mean is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fleet {
    /// Mean.
    pub mean: f64,
    /// Standard deviation of one car.
    pub sd: f64,
    /// Number of cars.
    pub n: f64,
    /// Largest distance that agrees.
    pub z: f64,
}

impl Fleet {
    /// Distance of a number from the mean, in standard deviations of one more car against a mean of n.
    #[must_use]
    pub fn distance(&self, x: f64) -> f64 {
        (x - self.mean) / (self.sd * (1.0 + 1.0 / self.n).sqrt())
    }
}

/// What is printed, in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Printed {
    /// From a smallest to a largest number; infinite where one side is open.
    Range(f64, f64),
    /// An order or sign, or its contrary.
    Truth(bool),
    /// A fleet.
    Fleet(Fleet),
}

/// The verdict of a computed row; `widths` of the tolerance below and above what is printed, in the row's unit.
#[must_use]
pub fn verdict(computed: &Computed, printed: Printed, widths: [f64; 2], fitted: bool) -> Verdict {
    let agrees = match (computed, printed) {
        (Computed::Truth(holds, _), Printed::Truth(wanted)) => *holds == wanted,
        (Computed::Number(x), Printed::Range(..)) => within([*x; 2], printed, widths),
        (Computed::Range(from, to), Printed::Range(..)) => within([*from, *to], printed, widths),
        (Computed::Number(x), Printed::Fleet(fleet)) => fleet.distance(*x).abs() <= fleet.z,
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
/// agrees; of a range its worse end; of a fleet the distance over the largest one that agrees. None for orders and signs, and where the tolerance
/// has no width.
#[must_use]
pub fn off(computed: &Computed, printed: Printed, widths: [f64; 2]) -> Option<f64> {
    let (low, high) = match (printed, computed) {
        (Printed::Range(low, high), _) => (low, high),
        (Printed::Fleet(fleet), Computed::Number(x)) => {
            return Some(fleet.distance(*x).abs() / fleet.z);
        }
        _ => return None,
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
