//! Numbers to text: each kind of quantity has its decimals and its unit here and nowhere else.

/// Between a number and its unit: they stay on one line.
const SPACE: char = '\u{a0}';
/// A minus sign as wide as the digits.
const MINUS: char = '\u{2212}';
/// Where there is no number.
pub const NONE: &str = "\u{2013}";

/// Energies from here on, kJ, are written in whole kJ.
const GROUPED: f64 = 999.95;

/// A kind of quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Fuel over distance, L/100 km.
    Fuel,
    /// A small difference of fuel over distance, L/100 km.
    FuelShare,
    /// Carbon dioxide, g/km.
    Co2,
    /// Distance, km.
    Distance,
    /// Duration, s.
    Seconds,
    /// Energy, kJ.
    Energy,
    /// Temperature, degC.
    Degc,
    /// A share or difference, %.
    Percent,
    /// A small effect, %.
    Effect,
    /// A plain ratio.
    Ratio,
    /// A share between 0 and 1 such as a Sobol index.
    Index,
}

impl Quantity {
    /// Decimals.
    fn decimals(self) -> usize {
        match self {
            Quantity::Seconds => 0,
            Quantity::Energy | Quantity::Degc | Quantity::Percent | Quantity::Co2 => 1,
            Quantity::Fuel | Quantity::Effect | Quantity::Ratio | Quantity::Index => 2,
            Quantity::FuelShare | Quantity::Distance => 3,
        }
    }

    /// Unit; empty for none.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Fuel | Quantity::FuelShare => "L/100\u{a0}km",
            Quantity::Co2 => "g/km",
            Quantity::Distance => "km",
            Quantity::Seconds => "s",
            Quantity::Energy => "kJ",
            Quantity::Degc => "\u{b0}C",
            Quantity::Percent | Quantity::Effect => "%",
            Quantity::Ratio | Quantity::Index => "",
        }
    }

    /// The number alone, for a cell whose column has the unit.
    #[must_use]
    pub fn bare(self, x: impl Into<Option<f64>>) -> String {
        match x.into().filter(|x| x.is_finite()) {
            Some(x) if self == Quantity::Energy && x.abs() >= GROUPED => minus(&grouped(x)),
            Some(x) => minus(&format!("{x:.*}", self.decimals())),
            None => NONE.to_owned(),
        }
    }

    /// The number alone, with its sign.
    #[must_use]
    pub fn bare_signed(self, x: impl Into<Option<f64>>) -> String {
        let x = x.into();
        let text = self.bare(x);
        let plus = x.is_some_and(|x| x > 0.0) && text.bytes().any(|b| (b'1'..=b'9').contains(&b));
        if plus { format!("+{text}") } else { text }
    }

    /// The number with its unit.
    #[must_use]
    pub fn text(self, x: impl Into<Option<f64>>) -> String {
        self.with_unit(self.bare(x))
    }

    /// The number with sign and unit.
    #[must_use]
    pub fn signed(self, x: impl Into<Option<f64>>) -> String {
        self.with_unit(self.bare_signed(x))
    }

    fn with_unit(self, number: String) -> String {
        match self.unit() {
            "" => number,
            _ if number == NONE => number,
            unit => format!("{number}{SPACE}{unit}"),
        }
    }
}

/// A whole number; of five digits and more with its thousands set apart by thin spaces.
fn grouped(x: f64) -> String {
    let digits = format!("{:.0}", x.abs());
    let mut text = if x < 0.0 {
        "-".to_owned()
    } else {
        String::new()
    };
    for (k, digit) in digits.chars().enumerate() {
        if digits.len() > 4 && k > 0 && (digits.len() - k).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A true minus, and none before a zero.
fn minus(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("{MINUS}{rest}"),
        Some(rest) => rest.to_owned(),
        None => text.to_owned(),
    }
}

/// A temperature as the user gave it, without decimals that he did not write.
#[must_use]
pub fn degc(x: f64) -> String {
    format!("{}{SPACE}\u{b0}C", minus(&format!("{}", x + 0.0)))
}

/// A part of a whole, per cent.
#[must_use]
pub fn percent(part: impl Into<Option<f64>>, whole: f64) -> String {
    Quantity::Percent.bare(part.into().map(|part| 100.0 * part / whole))
}

/// A small error such as 3e-15.
#[must_use]
pub fn tiny(x: Option<f64>) -> String {
    match x {
        Some(x) if x.abs() > 0.0 => format!("{x:.0e}").replace('-', &MINUS.to_string()),
        Some(_) => "0".to_owned(),
        None => NONE.to_owned(),
    }
}

/// A word of the program as people read it.
#[must_use]
pub fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// A phase as people write it: `ECE15`, `EUDC`, but `cold transient`.
#[must_use]
pub fn phase(name: &str) -> String {
    let code = name.chars().any(|c| c.is_ascii_digit()) || name.eq_ignore_ascii_case("eudc");
    if code {
        words(name).to_uppercase()
    } else {
        words(name)
    }
}

/// The same, as the beginning of a line.
#[must_use]
pub fn capital(name: &str) -> String {
    capital_first(&words(name))
}

/// A text with a capital first letter.
#[must_use]
pub fn capital_first(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|c| c.to_uppercase().collect::<String>())
        .unwrap_or_default()
        + letters.as_str()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_keeps_its_unit_and_loses_a_rounded_sign() {
        assert_eq!(Quantity::Fuel.text(7.726), "7.73\u{a0}L/100\u{a0}km");
        assert_eq!(Quantity::Percent.signed(5.94), "+5.9\u{a0}%");
        assert_eq!(Quantity::Percent.signed(-0.01), "0.0\u{a0}%");
        assert_eq!(Quantity::Percent.signed(0.01), "0.0\u{a0}%");
        assert_eq!(Quantity::Percent.bare(-11.93), "\u{2212}11.9");
        assert_eq!(Quantity::Energy.text(27199.1), "27\u{202f}199\u{a0}kJ");
        assert_eq!(
            Quantity::Energy.bare_signed(-1234567.0),
            "\u{2212}1\u{202f}234\u{202f}567"
        );
        assert_eq!(
            (Quantity::Energy.bare(999.96), Quantity::Energy.bare(999.94)),
            ("1000".into(), "999.9".into())
        );
        assert_eq!(
            (phase("ece15"), phase("eudc"), phase("cold_transient")),
            ("ECE15".into(), "EUDC".into(), "cold transient".into())
        );
        assert_eq!(Quantity::Fuel.text(None), NONE);
        assert_eq!(Quantity::Fuel.text(f64::NAN), NONE);
        assert_eq!(
            (degc(-10.0), degc(-0.0), degc(22.5)),
            (
                "\u{2212}10\u{a0}\u{b0}C".into(),
                "0\u{a0}\u{b0}C".into(),
                "22.5\u{a0}\u{b0}C".into()
            )
        );
        assert_eq!(
            (percent(1.0, 8.0), tiny(Some(3.2e-15)), capital("belt_band")),
            ("12.5".into(), "3e\u{2212}15".into(), "Belt band".into())
        );
    }
}
