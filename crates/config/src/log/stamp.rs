//! Time stamps: numbers in a unit, clocks, dates.

use jiff::civil::DateTime;
use jiff::fmt::strtime::BrokenDownTime;

/// Form of the stamps of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// Hours, minutes and seconds; over midnight it begins again.
    Clock,
    /// Minutes and seconds, as a stopwatch has them; over the hour it begins again.
    MinutesSeconds,
    /// The figures of a clock, or of a date and a clock, without signs between them, as satellite receivers write them: 235959.90, 20260312235959.
    Figures,
    /// Date and time by this format.
    Date(&'static str),
}

/// Formats of dates with a time, as instruments and phones write them, without commas and names of zones ([`normal`]). Day and month of those with slashes
/// are distinguished by all stamps of a file ([`Form::of_all`]).
const FORMATS: [&str; 46] = [
    "%Y-%m-%dT%H:%M:%S%.f%:z",
    "%Y-%m-%dT%H:%M:%S%.f%z",
    "%Y-%m-%dT%H:%M:%S%.fZ",
    "%Y-%m-%dT%H:%M:%S%.f",
    "%Y-%m-%d %H:%M:%S%.f%:z",
    "%Y-%m-%d %H:%M:%S%.f %z",
    "%Y-%m-%d %H:%M:%S%.fZ",
    "%Y-%m-%d %H:%M:%S%.f",
    "%Y-%m-%d %I:%M:%S%.f %p",
    "%Y-%m-%d_%H:%M:%S%.f",
    "%Y-%m-%d_%H-%M-%S%.f",
    "%Y-%jT%H:%M:%S%.f",
    "%Y/%m/%d %H:%M:%S%.f",
    "%Y/%m/%dT%H:%M:%S%.f",
    "%Y.%m.%d %H:%M:%S%.f",
    "%d-%b-%Y %H:%M:%S%.f",
    "%d-%b-%Y %I:%M:%S%.f %p",
    "%d-%b-%y %H:%M:%S%.f",
    "%d %b %Y %H:%M:%S%.f",
    "%d/%b/%Y %H:%M:%S%.f",
    "%b %d %Y %H:%M:%S%.f",
    "%b %d %Y %I:%M:%S%.f %p",
    "%d.%m.%Y %H:%M:%S%.f",
    "%d.%m.%Y %I:%M:%S%.f %p",
    "%d.%m.%y %H:%M:%S%.f",
    "%m/%d/%Y %I:%M:%S%.f %p",
    "%d/%m/%Y %I:%M:%S%.f %p",
    "%m/%d/%Y %H:%M:%S%.f",
    "%d/%m/%Y %H:%M:%S%.f",
    "%m/%d/%y %H:%M:%S%.f",
    "%d/%m/%y %H:%M:%S%.f",
    "%m/%d/%y %I:%M:%S%.f %p",
    "%d/%m/%y %I:%M:%S%.f %p",
    "%d-%m-%Y %H:%M:%S%.f",
    "%m-%d-%Y %H:%M:%S%.f",
    "%a %b %d %H:%M:%S GMT%:z %Y",
    "%a %b %d %H:%M:%S %Y",
    "%a %d %b %Y %H:%M:%S %z",
    "%a %d %b %Y %H:%M:%S",
    "%Y%m%d %H%M%S%.f",
    "%Y%m%dT%H%M%S%.f",
    "%Y%m%dT%H%M%S%.fZ",
    "%Y-%m-%d %H:%M",
    "%d.%m.%Y %H:%M",
    "%m/%d/%Y %H:%M",
    "%d/%m/%Y %H:%M",
];

/// Seconds of a day, and of an hour.
const DAY_S: f64 = 86_400.0;
const HOUR_S: f64 = 3600.0;
/// A stopwatch is as near to the full hour before and after it begins again, s.
const NEAR_HOUR_S: f64 = 120.0;
/// Stamps of a file by which its form is chosen.
const SAMPLE: usize = 60;

impl Form {
    /// Form of a stamp that is no number.
    pub(super) fn of(text: &str) -> Option<Form> {
        if clock(text).is_some() {
            return Some(Form::Clock);
        }
        if minutes(text).is_some() {
            return Some(Form::MinutesSeconds);
        }
        if !may_be_date(text) {
            return None;
        }
        let text = normal(text);
        let parses = |format: &&&str| date(&text, format).is_some();
        FORMATS.iter().find(parses).map(|format| Form::Date(format))
    }

    /// Form of the stamps of a file, from its first rows and its last ones. Of several formats of dates that of most stamps is taken, then that of the shortest
    /// drive: 05/06 and, after midnight, 06/06 are a day apart and no month.
    pub(super) fn of_all<'c>(
        first: impl Iterator<Item = &'c str>,
        last: impl Iterator<Item = &'c str>,
    ) -> Option<Form> {
        let cells: Vec<&str> = first.take(SAMPLE).chain(last).collect();
        let form = Form::of(cells.first()?)?;
        let Form::Date(own) = form else {
            return Some(form);
        };
        let stamps: Vec<String> = cells.iter().map(|cell| normal(cell)).collect();
        let rated = FORMATS
            .iter()
            .filter(|format| date(&stamps[0], format).is_some());
        let rated = rated.map(|format| {
            let known: Vec<f64> = stamps
                .iter()
                .filter_map(|text| date(text, format))
                .collect();
            let span = known.last().zip(known.first()).map_or(0.0, |(a, b)| a - b);
            (known.len(), span.abs(), *format)
        });
        let best = rated.reduce(|best, other| {
            let is_better = other.0 > best.0 || other.0 == best.0 && other.1 < best.1;
            if is_better { other } else { best }
        });
        Some(Form::Date(best.map_or(own, |(_, _, format)| format)))
    }

    /// The form of a clock without signs, if all stamps of a file may be such: a minute that is passed shows it, since its last figures stay below 60.
    pub(super) fn of_figures<'c>(
        first: impl Iterator<Item = &'c str>,
        last: impl Iterator<Item = &'c str>,
    ) -> Option<Form> {
        let cells: Vec<&str> = first.chain(last).collect();
        let seconds: Option<Vec<f64>> = cells.iter().map(|cell| figures(cell)).collect();
        let seconds = seconds.filter(|seconds| seconds.len() > 1)?;
        let numbers: Option<Vec<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
        let numbers = numbers?;
        let passes = |k: usize| {
            numbers[k] - numbers[k - 1] > seconds[k] - seconds[k - 1] + 39.0
                && seconds[k] >= seconds[k - 1]
        };
        (1..cells.len()).any(passes).then_some(Form::Figures)
    }

    /// Seconds from any beginning.
    pub(super) fn seconds(self, text: &str) -> Option<f64> {
        match self {
            Form::Clock => clock(text),
            Form::MinutesSeconds => minutes(text),
            Form::Figures => figures(text),
            Form::Date(format) => date(&normal(text), format),
        }
    }

    /// Seconds after which a clock that shows `seconds` after `before` began again; 0 where it did not.
    pub(super) fn began_again_s(self, before: f64, seconds: f64) -> f64 {
        let fall = before - seconds;
        match self {
            // Twelve hours without the half of the day.
            Form::Clock if fall <= 0.5 * DAY_S && fall > 0.5 * DAY_S - 60.0 => 0.5 * DAY_S,
            // A clock that falls by more than half a day has passed midnight.
            Form::Clock | Form::Figures if fall > 0.5 * DAY_S && before < DAY_S => DAY_S,
            Form::MinutesSeconds
                if (HOUR_S - NEAR_HOUR_S..HOUR_S).contains(&before) && seconds < NEAR_HOUR_S =>
            {
                HOUR_S
            }
            _ => 0.0,
        }
    }

    /// Name, for people.
    pub(super) fn name(self) -> &'static str {
        match self {
            Form::Clock => "h:m:s",
            Form::MinutesSeconds => "m:s",
            Form::Figures => "hhmmss",
            Form::Date(_) => "date and time",
        }
    }
}

/// True if a text has the figures of a date: most words have not, and are not tried in each format.
fn may_be_date(text: &str) -> bool {
    let digits = text.bytes().filter(u8::is_ascii_digit).count();
    (8..=40).contains(&digits) && text.len() <= 60
}

/// A date as the formats have it: a comma before the fraction of a second is a point, others go; `p.m.` is PM; the name of a zone at the end goes, since only
/// differences count.
fn normal(text: &str) -> String {
    let text = text.trim().replace(", ", " ").replace(',', ".");
    let (rest, last) = text.rsplit_once(' ').unwrap_or(("", &text));
    match last {
        "a.m." | "am" => format!("{rest} AM"),
        "p.m." | "pm" => format!("{rest} PM"),
        "AM" | "PM" => text,
        zone if (3..=5).contains(&zone.len()) && zone.bytes().all(|b| b.is_ascii_uppercase()) => {
            rest.to_owned()
        }
        _ => text,
    }
}

fn date(text: &str, format: &str) -> Option<f64> {
    // A year in two figures is none of the first century.
    let has_year = text.len() > 4 && text.as_bytes()[..4].iter().all(u8::is_ascii_digit);
    if format.starts_with("%Y") && !has_year {
        return None;
    }
    let parsed = BrokenDownTime::parse(format, text).ok()?;
    let offset_s = parsed
        .offset()
        .map_or(0.0, |offset| f64::from(offset.seconds()));
    let time: DateTime = parsed.to_datetime().ok()?;
    let epoch = DateTime::constant(1970, 1, 1, 0, 0, 0, 0);
    let since = time.duration_since(epoch);
    Some(since.as_secs_f64() - offset_s)
}

/// Seconds of `hhmmss`, `yyyymmddhhmmss` or this with milliseconds, with a fraction or without.
fn figures(text: &str) -> Option<f64> {
    let (whole, rest) = text.split_once('.').unwrap_or((text, ""));
    if !whole
        .bytes()
        .chain(rest.bytes())
        .all(|b| b.is_ascii_digit())
    {
        return None;
    }
    let fraction = |digits: &str| match digits {
        "" => Some(0.0),
        _ => format!("0.{digits}").parse::<f64>().ok(),
    };
    match whole.len() {
        // A workbook takes the first zero away.
        5 | 6 => {
            let number: u32 = whole.parse().ok()?;
            let parts = [number / 10_000, number / 100 % 100, number % 100];
            let [hours, minutes, seconds] = parts.map(f64::from);
            let is_clock = hours < 24.0 && minutes < 60.0 && seconds < 60.0;
            let seconds = 3600.0 * hours + 60.0 * minutes + seconds + fraction(rest)?;
            is_clock.then_some(seconds)
        }
        14 | 17 if ("1980".."2100").contains(&&whole[..4]) => {
            let seconds = date(&whole[..14], "%Y%m%d%H%M%S")?;
            Some(
                seconds
                    + fraction(if whole.len() == 17 {
                        &whole[14..]
                    } else {
                        rest
                    })?,
            )
        }
        _ => None,
    }
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
    if !text.contains(':') {
        return None;
    }
    // Differences of times as pandas writes them: 0 days 00:01:05.
    let (days, text) = match text.split_once(" day") {
        Some((days, rest)) => {
            let days: f64 = days.parse().ok()?;
            (days, rest.strip_prefix('s').unwrap_or(rest).trim_start())
        }
        None => (0.0, text),
    };
    let (text, half) = match text.rsplit_once(' ') {
        Some((clock, half)) => match half.to_lowercase().as_str() {
            "pm" | "p.m." => (clock, Some(12.0)),
            "am" | "a.m." => (clock, Some(0.0)),
            _ => return None,
        },
        None => (text, None),
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
    let seconds = 60.0 * part(minutes, false)? + part(seconds, false)? + fraction;
    Some(DAY_S * days + 3600.0 * hours + seconds)
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
            ["31/12/25 23:59:59", "01/01/26 00:00:00"],
            ["2026/01/05T23:59:59", "2026/01/06T00:00:00"],
            ["Jan 05, 2026 23:59:59", "Jan 06, 2026 00:00:00"],
            ["Jan 05 2026 11:59:59 PM", "Jan 06 2026 12:00:00 AM"],
            ["2026-01-05 23:59:59 CET", "2026-01-06 00:00:00 CET"],
            ["2026-005T23:59:59", "2026-006T00:00:00"],
            ["05.01.2026 11:59:59 p.m.", "06.01.2026 12:00:00 a.m."],
            ["0 days 23:59:59", "1 days 00:00:00"],
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
