//! Time stamps: numbers in a unit, clocks, dates.

use jiff::civil::DateTime;
use jiff::fmt::strtime::BrokenDownTime;

/// Form of the stamps of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// Hours, minutes and seconds; over midnight it begins again.
    Clock,
    /// Minutes and seconds, as a stopwatch has them.
    MinutesSeconds,
    /// Date and time by this format.
    Date(&'static str),
}

/// Formats of dates with a time, as instruments and phones write them. Day and month of the two with slashes cannot be distinguished, and need not be:
/// only differences count.
const FORMATS: [&str; 26] = [
    "%Y-%m-%dT%H:%M:%S%.f%:z",
    "%Y-%m-%dT%H:%M:%S%.f%z",
    "%Y-%m-%dT%H:%M:%S%.fZ",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y-%m-%d %H:%M:%S%.f%:z",
    "%Y-%m-%d %H:%M:%S%.f %z",
    "%Y-%m-%d %H:%M:%S%.f UTC",
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%d %I:%M:%S%.f %p",
    "%Y/%m/%d %H:%M:%S%.f",
    "%d-%b-%Y %H:%M:%S%.f",
    "%d-%b-%y %H:%M:%S%.f",
    "%d %b %Y %H:%M:%S%.f",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d.%m.%y %H:%M:%S%.f",
    "%m/%d/%Y %I:%M:%S%.f %p",
    "%d/%m/%Y %I:%M:%S%.f %p",
    "%m/%d/%Y %H:%M:%S%.f",
    "%d/%m/%Y %H:%M:%S%.f",
    "%m/%d/%y %H:%M:%S%.f",
    "%d-%m-%Y %H:%M:%S%.f",
    "%a %b %d %H:%M:%S GMT%:z %Y",
    "%a %b %d %H:%M:%S %Y",
    "%a, %d %b %Y %H:%M:%S %z",
    "%Y%m%d %H%M%S%.f",
    "%Y%m%dT%H%M%S%.f",
];

/// Seconds of a day.
pub(super) const DAY_S: f64 = 86_400.0;

impl Form {
    /// Form of a stamp that is no number.
    pub(super) fn of(text: &str) -> Option<Form> {
        if clock(text).is_some() {
            return Some(Form::Clock);
        }
        if minutes(text).is_some() {
            return Some(Form::MinutesSeconds);
        }
        let text = with_point(text);
        let parses = |format: &&&str| date(&text, format).is_some();
        FORMATS.iter().find(parses).map(|format| Form::Date(format))
    }

    /// Seconds from any beginning.
    pub(super) fn seconds(self, text: &str) -> Option<f64> {
        match self {
            Form::Clock => clock(text),
            Form::MinutesSeconds => minutes(text),
            Form::Date(format) => date(&with_point(text), format),
        }
    }

    /// Name, for people.
    pub(super) fn name(self) -> &'static str {
        match self {
            Form::Clock => "h:m:s",
            Form::MinutesSeconds => "m:s",
            Form::Date(_) => "date and time",
        }
    }
}

/// A comma before the fraction of a second is read as a point.
fn with_point(text: &str) -> String {
    text.trim().replace(',', ".").replace(". ", ", ")
}

fn date(text: &str, format: &str) -> Option<f64> {
    let parsed = BrokenDownTime::parse(format, text).ok()?;
    let offset_s = parsed
        .offset()
        .map_or(0.0, |offset| f64::from(offset.seconds()));
    let time: DateTime = parsed.to_datetime().ok()?;
    let epoch = DateTime::constant(1970, 1, 1, 0, 0, 0, 0);
    let since = time.duration_since(epoch);
    Some(since.as_secs_f64() - offset_s)
}

/// Seconds of a number that may have a decimal comma, below 60 where it is not the first part.
fn part(text: &str, is_first: bool) -> Option<f64> {
    let digits = text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.' || byte == b',');
    let number: f64 = text.replace(',', ".").parse().ok()?;
    (digits && (is_first || number < 60.0)).then_some(number)
}

fn clock(text: &str) -> Option<f64> {
    let text = text.trim();
    let (text, half) = match text.rsplit_once(' ') {
        Some((clock, half)) if half.eq_ignore_ascii_case("pm") => (clock, Some(12.0)),
        Some((clock, half)) if half.eq_ignore_ascii_case("am") => (clock, Some(0.0)),
        _ => (text, None),
    };
    let parts: Vec<&str> = text.split(':').collect();
    // The fourth part, milliseconds or hundredths, is a fraction of a second by its digits.
    let (fraction, parts) = match parts.as_slice() {
        [_, _, seconds, fraction] if !seconds.contains(['.', ',']) => {
            (format!("0.{fraction}").parse::<f64>().ok()?, &parts[..3])
        }
        _ => (0.0, &parts[..]),
    };
    let [hours, minutes, seconds] = parts else {
        return None;
    };
    let hours = part(hours, true).filter(|hours| hours.fract() == 0.0)?;
    let hours = half.map_or(hours, |half| hours % 12.0 + half);
    Some(3600.0 * hours + 60.0 * part(minutes, false)? + part(seconds, false)? + fraction)
}

fn minutes(text: &str) -> Option<f64> {
    let (minutes, seconds) = text.trim().split_once(':')?;
    let minutes = part(minutes, true).filter(|minutes| minutes.fract() == 0.0)?;
    Some(60.0 * minutes + part(seconds, false)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: stamps a second apart differ by one second, in each form, and over midnight of a date.
    #[test]
    fn a_second_is_a_second() {
        for [first, next] in [
            ["08:00:59", "08:01:00"],
            ["8:59:59.5", "9:00:00.5"],
            ["12:59:59 PM", "1:00:00 PM"],
            ["00:59.9", "01:00.9"],
            ["08:00:59:250", "08:01:00:250"],
            [
                "2026-01-05T23:59:59.250+01:00",
                "2026-01-06T00:00:00.250+01:00",
            ],
            ["2026-01-05T23:59:59Z", "2026-01-06T00:00:00Z"],
            ["2026-01-05 23:59:59", "2026-01-06 00:00:00"],
            ["2026-01-05 23:59:59,125", "2026-01-06 00:00:00,125"],
            ["05-Jan-2026 08:00:59.137", "05-Jan-2026 08:01:00.137"],
            [
                "Mon Jan 05 08:00:59 GMT+01:00 2026",
                "Mon Jan 05 08:01:00 GMT+01:00 2026",
            ],
            ["05.01.2026 08:00:59", "05.01.2026 08:01:00"],
            ["01/05/2026 11:59:59 AM", "01/05/2026 12:00:00 PM"],
            ["31/12/2025 23:59:59", "01/01/2026 00:00:00"],
        ] {
            let form = Form::of(first).unwrap_or_else(|| panic!("{first}"));
            let seconds = |text: &str| {
                form.seconds(text)
                    .unwrap_or_else(|| panic!("{text} by {form:?}"))
            };
            assert!(
                (seconds(next) - seconds(first) - 1.0).abs() < 1e-6,
                "{first} {form:?}"
            );
        }
        for text in [
            "",
            "12",
            "a:b",
            "1:2:3:4:5",
            "2026-13-05 00:00:00",
            "99:99:99",
        ] {
            assert_eq!(Form::of(text), None, "{text}");
        }
    }
}
