//! Catalogue numbers with their units (NC-7): what is given without a unit is in the first of its kind.

use crate::problem::near::one_of;
use crate::{Problem, did_you_mean};

/// Names of a unit, and its size in the unit of the key.
type Unit = (&'static [&'static str], f64);

/// Units of a catalogue number; the first has the size 1.
#[derive(Debug)]
pub(super) struct Units(pub &'static [Unit]);

const LB: f64 = 0.453_592_37;
/// N of a pound-force.
const LBF: f64 = 4.448_221_615_260_5;
/// km of a mile.
const MILE: f64 = 1.609_344;

pub(super) const MASS: Units = Units(&[(&["kg"], 1.0), (&["lb", "lbs"], LB), (&["t"], 1000.0)]);
pub(super) const FORCE: Units = Units(&[(&["N"], 1.0), (&["lbf"], LBF)]);
pub(super) const FORCE_PER_SPEED: Units = Units(&[
    (&["N/(km/h)", "N/kmh"], 1.0),
    (&["lbf/mph", "lbf"], LBF / MILE),
]);
pub(super) const FORCE_PER_SPEED2: Units = Units(&[
    (&["N/(km/h)2", "N/kmh2"], 1.0),
    (&["lbf/mph2", "lbf"], LBF / (MILE * MILE)),
]);
pub(super) const VOLUME: Units = Units(&[(&["cm3", "cc", "ccm"], 1.0), (&["l", "L"], 1000.0)]);
pub(super) const OIL: Units = Units(&[(&["l", "L"], 1.0)]);
pub(super) const POWER: Units = Units(&[
    (&["kW"], 1.0),
    (&["hp", "bhp"], 0.745_699_87),
    (&["PS"], 0.735_498_75),
]);
pub(super) const TORQUE: Units =
    Units(&[(&["Nm"], 1.0), (&["lbft", "lb-ft", "ftlb"], 1.355_817_9)]);
pub(super) const SPEED: Units = Units(&[(&["rpm"], 1.0)]);
pub(super) const LENGTH: Units = Units(&[(&["mm"], 1.0), (&["cm"], 10.0), (&["m"], 1000.0)]);
pub(super) const PER_TURN: Units = Units(&[(&["cc/rev", "cc", "cm3"], 1.0)]);
pub(super) const RATIO: Units = Units(&[]);

impl Units {
    /// The number of a text, in the unit of the key.
    pub fn number(&self, text: &str) -> Result<f64, Problem> {
        let text = text.trim();
        let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)));
        let (figure, unit) = text.split_at(end.unwrap_or(text.len()));
        let unit = unit.trim();
        let size = match self.0.iter().find(|(names, _)| names.contains(&unit)) {
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

/// Width mm, height over width in per cent, and rim in inches of a tyre code such as 215/55 R16.
pub(super) fn tyre(code: &str) -> Option<[f64; 3]> {
    let (width, rest) = code.trim().split_once('/')?;
    let (height, rim) = rest.split_once(['R', 'r'])?;
    let height = height.trim_end_matches(|c: char| c.is_ascii_alphabetic() || c == ' ');
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let found = [number(width)?, number(height)?, number(rim)?];
    let ranges = [125.0..=355.0, 20.0..=90.0, 10.0..=24.0];
    let fits = found.iter().zip(ranges).all(|(x, range)| range.contains(x));
    fits.then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn tyre_codes_are_read() {
        for good in ["215/55 R16", "215/55R16", "215/55 r16", "215/55 ZR16"] {
            assert_eq!(tyre(good), Some([215.0, 55.0, 16.0]), "{good}");
        }
        for bad in [
            "215/55",
            "55/215 R16",
            "215-55-16",
            "R16",
            "215/55 R",
            "215/55 R160",
        ] {
            assert_eq!(tyre(bad), None, "{bad}");
        }
    }
}
