//! Catalogue numbers with their units: what is given without a unit is in the first of its kind.

use crate::document::units::{Units, decimal_comma, parts_thousands};
use crate::problem::near::one_of;
use crate::{Problem, did_you_mean};

impl Units {
    /// As [`Units::number`], of a text that has to have its unit.
    ///
    /// # Errors
    /// The text is no number, or has no unit.
    pub fn number_with_unit(&self, text: &str, hint: &str) -> Result<f64, Problem> {
        let number = self.number(text)?;
        match text
            .trim()
            .ends_with(|c: char| c.is_ascii_digit() || c == '.')
        {
            false => Ok(number),
            true => Err(Problem::missing("the number has no unit")
                .allowed(self.allowed())
                .hint(hint)),
        }
    }

    /// The number of a text, in the unit of the key.
    pub fn number(&self, text: &str) -> Result<f64, Problem> {
        let text = text.trim();
        let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)));
        let (figure, unit) = text.split_at(end.unwrap_or(text.len()));
        let unit = unit.trim();
        if let Some(problem) = self.with_comma(text) {
            return Err(problem);
        }
        let size = match self.find(unit) {
            Some((_, size)) => *size,
            None if unit.is_empty() => 1.0,
            None => return Err(self.wrong_unit(unit)),
        };
        match figure.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number * size),
            _ => Err(Problem::wrong_type("this is no number")
                .allowed(self.allowed())
                .hint("write the number with a decimal point, and its unit after it")),
        }
    }

    /// A number with a comma, which is a decimal point in one country and parts thousands in another.
    fn with_comma(&self, text: &str) -> Option<Problem> {
        let (length, point) = decimal_comma(text)?;
        let (figure, rest) = text.split_at(length);
        let mut hint = format!("write {point}{rest} with a decimal point");
        if parts_thousands(&point) {
            hint += &format!(", or {}{rest} without a comma", figure.replace(',', ""));
        }
        Some(
            Problem::wrong_type("a number with a comma")
                .allowed(self.allowed())
                .hint(hint),
        )
    }

    fn wrong_unit(&self, unit: &str) -> Problem {
        let names = self.0.iter().flat_map(|(names, _)| names.iter().copied());
        let message = match self.0 {
            [] => format!("a ratio has no unit, not `{unit}`"),
            _ => format!("`{unit}` is no unit of it"),
        };
        let question = did_you_mean(unit, names).unwrap_or_default();
        Problem::unknown_name(message)
            .allowed(self.allowed())
            .hint(question)
    }

    fn allowed(&self) -> String {
        let names: Vec<&str> = self.0.iter().map(|(names, _)| names[0]).collect();
        match names.as_slice() {
            [] => "a number".to_owned(),
            [one] => format!("a number in {one}"),
            all => format!("a number in {}", one_of(all)),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::document::units::{
        FORCE, FORCE_PER_SPEED, FORCE_PER_SPEED2, MASS, POWER, TORQUE, VOLUME,
    };

    /// Definitions of the units: 17.45 lbf, 0.1608 lbf/mph and 0.01586 lbf/mph2 are 77.62 N, 0.4445 N/(km/h) and 0.02724 N/(km/h)2.
    #[test]
    fn units_are_their_definitions() {
        for (units, text, value) in [
            (FORCE, "17.45lbf", 77.62),
            (FORCE_PER_SPEED, "0.1608 lbf/mph", 0.4444),
            (FORCE_PER_SPEED2, "0.01586lbf", 0.027_24),
            (MASS, "3000 lb", 1360.78),
            (MASS, "1.32t", 1320.0),
            (MASS, "1320", 1320.0),
            (VOLUME, "1.8 l", 1800.0),
            (POWER, "158hp", 117.82),
            (TORQUE, "138 lb-ft", 187.1),
        ] {
            let got = units.number(text).unwrap_or(f64::NAN);
            assert!((got / value - 1.0).abs() < 5e-4, "{text}: {got}");
        }
        for bad in ["", "kg", "1,320", "1320 stone", "1e999", "nan"] {
            assert!(MASS.number(bad).is_err(), "{bad}");
        }
    }
}
