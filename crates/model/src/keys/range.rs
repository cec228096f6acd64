//! Allowed range of a number.
use std::fmt;

/// Allowed range of a number, in the unit of the key it belongs to. Only finite numbers are ever allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    low: f64,
    high: f64,
    low_included: bool,
}

impl Bound {
    /// From `low` to `high`, both included; an infinite end means no limit on that side.
    pub const fn closed(low: f64, high: f64) -> Self {
        Bound {
            low,
            high,
            low_included: true,
        }
    }

    /// Above `low`, up to and including `high`.
    pub const fn open_low(low: f64, high: f64) -> Self {
        Bound {
            low,
            high,
            low_included: false,
        }
    }

    /// Above zero.
    pub const fn positive() -> Self {
        Bound::open_low(0.0, f64::INFINITY)
    }

    /// Any finite number.
    pub const fn any() -> Self {
        Bound::closed(f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Lower end; infinite where there is none.
    pub const fn low(&self) -> f64 {
        self.low
    }

    /// Upper end; infinite where there is none.
    pub const fn high(&self) -> f64 {
        self.high
    }

    /// True if the lower end itself is allowed.
    pub const fn includes_low(&self) -> bool {
        self.low_included
    }

    /// True if `x` is allowed; false for NaN and infinities.
    pub fn contains(&self, x: f64) -> bool {
        let above = if self.low_included {
            self.low <= x
        } else {
            self.low < x
        };
        above && x <= self.high && x.is_finite()
    }

    /// The range in words with its unit, such as "0.5 to 10 mm"; `-` for no unit.
    pub fn in_unit(&self, unit: &str) -> String {
        if unit == "-" || unit.is_empty() || *self == Bound::any() {
            self.to_string()
        } else {
            format!("{self} {unit}")
        }
    }
}

/// The range in words without a unit.
impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bound {
            low,
            high,
            low_included,
        } = *self;
        match (low.is_finite(), high.is_finite()) {
            (true, true) if low_included => write!(f, "{low} to {high}"),
            (true, true) => write!(f, "above {low} up to {high}"),
            (true, false) if low_included => write!(f, "at least {low}"),
            (true, false) => write!(f, "above {low}"),
            (false, true) => write!(f, "at most {high}"),
            (false, false) => write!(f, "any finite number"),
        }
    }
}
