//! Formats numbers for the report: decimals and unit of each kind of quantity are defined here only.

use cvtcycle_output::number;
use cvtcycle_output::summary::Over;

/// Separator of a number and its unit, which keeps them on one line.
const SPACE: char = '\u{a0}';
/// A minus sign as wide as the digits.
const MINUS: char = '\u{2212}';
/// Placeholder for a missing number.
pub const NONE: &str = "\u{2013}";

/// Energy from which on whole kJ are written, kJ.
const GROUPED: f64 = 999.95;

/// A kind of quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Fuel over distance, L/100 km.
    Fuel,
    /// Fuel over time, L/h.
    FuelInTime,
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
    /// Fuel over distance or time.
    #[must_use]
    pub fn fuel(over: Over) -> Self {
        match over {
            Over::Distance => Quantity::Fuel,
            Over::Time => Quantity::FuelInTime,
        }
    }

    /// Decimals.
    fn decimals(self) -> usize {
        match self {
            Quantity::Seconds => 0,
            Quantity::Energy | Quantity::Degc | Quantity::Percent | Quantity::Co2 => 1,
            Quantity::Fuel
            | Quantity::FuelInTime
            | Quantity::Effect
            | Quantity::Ratio
            | Quantity::Index => 2,
            Quantity::FuelShare | Quantity::Distance => 3,
        }
    }

    /// Unit; empty for none.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Quantity::Fuel | Quantity::FuelShare => "L/100\u{a0}km",
            Quantity::FuelInTime => "L/h",
            Quantity::Co2 => "g/km",
            Quantity::Distance => "km",
            Quantity::Seconds => "s",
            Quantity::Energy => "kJ",
            Quantity::Degc => "\u{b0}C",
            Quantity::Percent | Quantity::Effect => "%",
            Quantity::Ratio | Quantity::Index => "",
        }
    }

    /// Formats the number alone, for a cell whose column has the unit.
    #[must_use]
    pub fn bare(self, x: impl Into<Option<f64>>) -> String {
        let x = x.into().unwrap_or(f64::NAN);
        let whole = self == Quantity::Energy && x.abs() >= GROUPED;
        grouped(x, if whole { 0 } else { self.decimals() })
    }

    /// Formats the number alone, with its sign.
    #[must_use]
    pub fn bare_signed(self, x: impl Into<Option<f64>>) -> String {
        let x = x.into();
        signed(self.bare(x), x.unwrap_or(f64::NAN))
    }

    /// Formats the number with its unit.
    #[must_use]
    pub fn text(self, x: impl Into<Option<f64>>) -> String {
        self.with_unit(self.bare(x))
    }

    /// Formats the number with sign and unit.
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

/// Formats a number with decimals and a true minus; with five digits and more before the point, groups of three are separated. [`NONE`] if not
/// finite.
pub fn grouped(x: f64, decimals: usize) -> String {
    if !x.is_finite() {
        return NONE.to_owned();
    }
    let text = format!("{:.decimals$}", x.abs());
    let whole = text.find('.').unwrap_or(text.len());
    let mut out = if x < 0.0 { "-" } else { "" }.to_owned();
    for (k, digit) in text.chars().enumerate() {
        if whole > 4 && k > 0 && k < whole && (whole - k).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    minus(&out)
}

/// Adds a plus sign to the text of a number that is positive and not rounded to zero.
pub(crate) fn signed(text: String, x: f64) -> String {
    let plus = x > 0.0 && has_digits(&text);
    if plus { format!("+{text}") } else { text }
}

/// True for a text with a digit other than zero.
fn has_digits(text: &str) -> bool {
    text.bytes().any(|b| (b'1'..=b'9').contains(&b))
}

/// Gives the text of a number a true minus, and zero no sign.
pub(crate) fn minus(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(rest) if has_digits(rest) => format!("{MINUS}{rest}"),
        Some(rest) => rest.to_owned(),
        None => text.to_owned(),
    }
}

/// Unit as printed.
pub(crate) fn sign(unit: &str) -> &str {
    match unit {
        "degC" => "\u{b0}C",
        "Nm" => "N\u{a0}m",
        "Nms" => "N\u{a0}m\u{a0}s",
        "L/100 km" => "L/100\u{a0}km",
        unit => unit,
    }
}

/// Units kept on the line of their number.
const UNITS: [&str; 12] = [
    "%", "kJ", "MJ", "km", "s", "K", "W", "rpm", "bar", "mm", "g/km", "kJ/km",
];

/// Typesets a text of the program: units as `sign` writes them and on the line of their number, true minus signs, \u{b1}. Terminal input stays
/// unchanged: words in backticks, options with their value, settings.
pub fn typeset(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 8);
    let (mut code, mut option) = (false, false);
    for (k, word) in text.split(' ').enumerate() {
        let ticks = word.matches('`').count();
        let typed = code || option || ticks > 0 || word.contains('=') || word.starts_with("--");
        code ^= ticks % 2 == 1;
        option = word.starts_with("--");
        let unit = word.trim_matches(|c: char| "[](),.;:".contains(c));
        let written = if typed { unit } else { sign(unit) };
        if k > 0 {
            let is_unit = written != unit || UNITS.contains(&unit);
            let counted = is_unit && !typed && out.ends_with(|c: char| c.is_ascii_digit());
            out.push(if counted { SPACE } else { ' ' });
        }
        match written == unit {
            true if typed => out += word,
            true => with_signs(&mut out, word),
            false => out += &word.replacen(unit, written, 1),
        }
    }
    out
}

/// Adds a word with true minus signs before numbers, and \u{b1}.
fn with_signs(out: &mut String, word: &str) {
    let word = word.replace("+-", "\u{b1}");
    let mut before = ' ';
    let mut rest = word.chars().peekable();
    while let Some(c) = rest.next() {
        let sign = c == '-' && !before.is_alphanumeric() && before != '_';
        let number = sign && rest.peek().is_some_and(char::is_ascii_digit);
        out.push(if number { MINUS } else { c });
        before = c;
    }
}

/// "Torque [Nm]"; the name alone without a unit.
pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    match sign(unit) {
        "" => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    }
}

/// Formats a temperature as the user gave it, without extra decimals.
pub fn degc(x: f64) -> String {
    format!("{}{SPACE}\u{b0}C", minus(&format!("{}", x + 0.0)))
}

/// Formats a part of a whole, per cent.
pub fn percent(part: impl Into<Option<f64>>, whole: f64) -> String {
    Quantity::Percent.bare(part.into().map(|part| 100.0 * part / whole))
}

/// Formats a small error such as 3e-15.
pub fn tiny(x: Option<f64>) -> String {
    let text = |_| number::tiny(x).replace('-', &MINUS.to_string());
    x.map_or_else(|| NONE.to_owned(), text)
}

/// "a, b and c".
pub(crate) fn list_of(words: &[String]) -> String {
    match words {
        [rest @ .., last] if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        words => words.concat(),
    }
}

/// Formats a name of the program for people.
pub fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// Formats the name of a phase for people: `ECE15`, `EUDC`, but `cold transient`.
pub fn phase(name: &str) -> String {
    let code = name.chars().any(|c| c.is_ascii_digit()) || name.eq_ignore_ascii_case("eudc");
    if code {
        words(name).to_uppercase()
    } else {
        words(name)
    }
}

/// Formats the name of a phase as the beginning of a line.
pub fn capital(name: &str) -> String {
    capital_first(&words(name))
}

/// Capitalises the first letter of a text.
pub fn capital_first(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().into_iter().flat_map(char::to_uppercase);
    first.collect::<String>() + letters.as_str()
}
