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

    /// Whether the lower end itself is allowed.
    pub const fn includes_low(&self) -> bool {
        self.low_included
    }

    /// Whether `x` is allowed; never for NaN and infinities.
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

#[cfg(test)]
mod tests {
    use super::Bound;

    #[test]
    fn ends_belong_to_the_range_as_stated() {
        let closed = Bound::closed(0.5, 10.0);
        assert!(closed.contains(0.5) && closed.contains(10.0));
        assert!(!closed.contains(0.499) && !closed.contains(10.001));
        let open = Bound::open_low(0.0, 1.0);
        assert!(!open.contains(0.0) && open.contains(1e-300) && open.contains(1.0));
        assert!(!Bound::positive().contains(0.0) && Bound::positive().contains(1e300));
        assert!(Bound::any().contains(-1e300));
    }

    #[test]
    fn what_is_not_a_number_is_never_allowed() {
        for bound in [Bound::any(), Bound::positive(), Bound::closed(0.0, 1.0)] {
            assert!(!bound.contains(f64::NAN));
            assert!(!bound.contains(f64::INFINITY));
            assert!(!bound.contains(f64::NEG_INFINITY));
        }
    }

    #[test]
    fn ranges_in_words() {
        assert_eq!(Bound::closed(0.5, 10.0).in_unit("mm"), "0.5 to 10 mm");
        assert_eq!(Bound::open_low(0.0, 1.0).in_unit("-"), "above 0 up to 1");
        assert_eq!(Bound::positive().in_unit("kg"), "above 0 kg");
        assert_eq!(
            Bound::closed(f64::NEG_INFINITY, 3.0).in_unit("bar"),
            "at most 3 bar"
        );
        assert_eq!(
            Bound::closed(2.0, f64::INFINITY).in_unit("bar"),
            "at least 2 bar"
        );
        assert_eq!(Bound::any().in_unit("bar"), "any finite number");
    }
}
