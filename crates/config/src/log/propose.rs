//! The columns that mend a refusal, as a text for `--columns` that works.

use super::choose::{Chosen, Reading, Source};
use super::sheet::{Met, Sheet, is_missing, number};
use super::stamp::Form;
use crate::channel::Quantity;
use crate::readable;

/// Accelerations of a drive on a road, m/s2: the largest is between these.
const PLAUSIBLE_M_S2: [f64; 2] = [0.5, 6.0];

/// Cars of normal drivers gain more at times, m/s2: of the shipped cycles all but two.
const SLOW_M_S2: f64 = 0.9;

/// An entry, in double quotes where it has a comma or quotes.
fn entry(text: &str) -> String {
    match text.contains([',', '"']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

/// `time=NAME:UNIT,speed=NAME:UNIT`, with the other channels that are known and the rows that are meant.
pub(super) fn columns(
    sheet: &Sheet<'_>,
    chosen: &Chosen,
    (time, speed): (&Source, &Source),
    more: &[(Quantity, usize, &str)],
    filters: &[(String, String)],
) -> String {
    let name = |column: usize| {
        sheet
            .names
            .get(column)
            .cloned()
            .unwrap_or_else(|| (column + 1).to_string())
    };
    let of = |source: &Source| {
        let name = match &source.only {
            Some((column, word)) => format!("{}[{}={word}]", name(source.column), name(*column)),
            None => name(source.column),
        };
        let quantity = source.quantity.name();
        entry(&match source.reading {
            Reading::Number(unit) => {
                let stated = sheet
                    .stated_unit(source.quantity, source.column)
                    .filter(|_| source.only.is_none());
                let force = if stated.is_some_and(|stated| stated != unit) {
                    "!"
                } else {
                    ""
                };
                format!("{quantity}={name}:{}{force}", unit.name)
            }
            Reading::Stamp(_) | Reading::Word => format!("{quantity}={name}"),
        })
    };
    if sheet.names.is_empty() {
        return in_order(time, speed);
    }
    let mut named: Vec<Quantity> = vec![Quantity::Time, Quantity::Speed];
    let mut others = Vec::new();
    let plain = chosen.no_unit.iter();
    let plain =
        plain.filter_map(|(quantity, column)| Some((*quantity, *column, usual(*quantity)?)));
    for (quantity, column, unit) in more.iter().copied().chain(plain) {
        if !named.contains(&quantity) {
            named.push(quantity);
            others.push(entry(&format!(
                "{}={}:{unit}",
                quantity.name(),
                name(column)
            )));
        }
    }
    for source in &chosen.others {
        if !named.contains(&source.quantity) {
            named.push(source.quantity);
            others.push(of(source));
        }
    }
    let filters = filters
        .iter()
        .map(|(name, value)| entry(&format!("where={name}:{value}")));
    let list: Vec<String> = [of(time), of(speed)]
        .into_iter()
        .chain(others)
        .chain(filters)
        .collect();
    list.join(",")
}

/// Unit in which nearly all logs have a quantity; none where there are several.
fn usual(quantity: Quantity) -> Option<&'static str> {
    match quantity {
        Quantity::EngineSpeed => Some("rpm"),
        Quantity::Coolant | Quantity::EngineOil | Quantity::Sump | Quantity::Ambient => {
            Some("degC")
        }
        _ => None,
    }
}

/// The columns of a file without names.
fn in_order(time: &Source, speed: &Source) -> String {
    let unit = |source: &Source| match source.reading {
        Reading::Number(unit) => unit.name,
        Reading::Stamp(form @ Form::Figures) => form.name(),
        _ => "s",
    };
    let mut both = [
        (time.column, format!("time:{}", unit(time))),
        (speed.column, format!("speed:{}", unit(speed))),
    ];
    both.sort();
    match both {
        [(0, first), (1, second)] => format!("{first},{second}"),
        _ => format!(
            "time={}:{},speed={}:{}",
            time.column + 1,
            unit(time),
            speed.column + 1,
            unit(speed)
        ),
    }
}

/// Numbers of a column in the first rows.
pub(super) fn raw(sheet: &Sheet<'_>, column: usize) -> Vec<f64> {
    let cell = |row: &Vec<&str>| {
        let cell = row.get(column).copied().filter(|cell| !is_missing(cell))?;
        number(cell, sheet.decimal_comma)
    };
    sheet.sample.iter().filter_map(cell).collect()
}

/// Unit of stamps by their steps: a log has some rows a second.
pub(super) fn time_unit(stamps: &[f64]) -> &'static str {
    let steps = stamps
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0);
    let step = super::smooth::median(steps.collect()).unwrap_or(1.0);
    match step {
        // Days since 1900, as workbooks write a date.
        step if step < 0.5 / 1000.0 && stamps.first().is_some_and(|first| *first > 20_000.0) => "d",
        step if step < 0.5 / 1000.0 => "h",
        // A second is 1/60 min; steps of 0.01, 0.02 and 0.05 are those of seconds.
        step if (step * 60.0 - 1.0).abs() < 0.03 => "min",
        step if step < 15.0 => "s",
        step if step < 15e3 => "ms",
        step if step < 15e6 => "us",
        _ => "ns",
    }
}

/// Largest gain of speed over a second, in the unit of the numbers over seconds.
fn largest_gain(pairs: &[(f64, f64)]) -> f64 {
    let (mut behind, mut most) = (0, 0.0_f64);
    for k in 1..pairs.len() {
        while behind + 1 < k && pairs[k].0 - pairs[behind + 1].0 >= 1.0 {
            behind += 1;
        }
        let step = pairs[k].0 - pairs[behind].0;
        if step > 0.0 {
            most = most.max((pairs[k].1 - pairs[behind].1) / step.max(1.0));
        }
    }
    most
}

/// Unit of speeds by what a car can do, the first that is plausible; and the acceleration in each, in words.
fn speed_unit(pairs: &[(f64, f64)], is_of_satellites: bool) -> (&'static str, String) {
    let top = pairs
        .iter()
        .fold(0.0_f64, |top, (_, speed)| top.max(*speed));
    let gain = largest_gain(pairs);
    let units = [("km/h", 1.0 / 3.6), ("mph", 0.447_04), ("m/s", 1.0)];
    let is_plausible = |factor: f64| {
        let [low, high] = PLAUSIBLE_M_S2;
        (low..=high).contains(&(gain * factor)) && top * factor < 70.0
    };
    // Receivers and phones have SI; and a car that never gains a quarter of what tyres hold is likelier one whose numbers are in m/s.
    let is_si =
        is_plausible(1.0) && (is_of_satellites || gain / 3.6 < SLOW_M_S2 && gain >= SLOW_M_S2);
    let found = match is_si {
        true => Some(&units[2]),
        false => units.iter().find(|(_, factor)| is_plausible(*factor)),
    };
    let words =
        units.map(|(name, factor)| format!("{} m/s2 in {name}", readable(gain * factor, 1)));
    let hint = match gain > 0.0 {
        true => format!(
            "the largest gain over a second would be {}",
            words.join(", ")
        ),
        false => String::new(),
    };
    (found.map_or("km/h", |(name, _)| name), hint)
}

/// True if a word of a name is `time` but for a letter.
fn is_like_time(name: &str) -> bool {
    let bare = crate::channel::bare(name);
    bare.split('_')
        .any(|word| word.len() > 2 && strsim::levenshtein(word, "time") == 1)
}

/// True if a column counts rows and is no time.
fn counts_rows(sheet: &Sheet<'_>, column: usize) -> bool {
    const WORDS: [&str; 12] = [
        "frame", "frames", "index", "idx", "sample", "samples", "row", "rows", "count", "counter",
        "nr", "no",
    ];
    let name = sheet.names.get(column).map_or("", String::as_str);
    crate::channel::bare(name)
        .split('_')
        .any(|word| WORDS.contains(&word))
}

/// True if the name of a column says that it is something else than a speed: another unit in brackets, a distance, an acceleration.
fn is_no_speed(sheet: &Sheet<'_>, column: usize) -> bool {
    const WORDS: [&str; 12] = [
        "distance",
        "dist",
        "odometer",
        "accel",
        "acceleration",
        "acc",
        "ax",
        "rpm",
        "pedal",
        "torque",
        "power",
        "temp",
    ];
    let name = sheet.names.get(column).map_or("", String::as_str);
    let has_unit =
        name.ends_with([']', ')']) || sheet.units.get(column).is_some_and(|unit| !unit.is_empty());
    let is_word = crate::channel::bare(name)
        .split('_')
        .any(|word| WORDS.contains(&word));
    is_word || has_unit && sheet.stated_unit(Quantity::Speed, column).is_none()
}

/// Stamps and speeds of all rows, in the units of the file and seconds.
fn pairs(
    sheet: &Sheet<'_>,
    time: &Source,
    column: usize,
    only: Option<&(usize, String)>,
) -> Vec<(f64, f64)> {
    /// Rows from which a unit is guessed.
    const ROWS: usize = 100_000;
    let at = |cell: &str| match time.reading {
        Reading::Stamp(form) => form.seconds(cell),
        Reading::Number(unit) => number(cell, sheet.decimal_comma).map(|stamp| unit.si(stamp)),
        Reading::Word => None,
    };
    let mut pairs = Vec::new();
    sheet.lines(|_, text, met| {
        let Met::Row(fields) = met else { return };
        let cell = |column: usize| Sheet::text_of(text, fields[column]);
        if pairs.len() >= ROWS || only.is_some_and(|(column, word)| cell(*column) != word) {
            return;
        }
        let pair = at(cell(time.column)).zip(number(cell(column), sheet.decimal_comma));
        pairs.extend(pair);
    });
    pairs
}

/// Proposed columns, and a hint about the unit of the speed.
pub(super) struct Guess {
    pub columns: String,
    pub hint: String,
}

/// The column that is named as a time and rises like one, and the first that rises.
fn time_columns(
    sheet: &Sheet<'_>,
    chosen: &Chosen,
    speed_column: Option<usize>,
) -> (Option<usize>, Option<usize>) {
    let rises = |column: &usize| {
        let values = raw(sheet, *column);
        values.len() > 2
            && values.windows(2).all(|pair| pair[1] >= pair[0])
            && values.last() > values.first()
    };
    let times = chosen.no_unit.iter();
    let named = times
        .filter(|(own, _)| *own == Quantity::Time)
        .map(|(_, column)| *column)
        .next();
    // A port counts many times: of those that are named the one that rises is meant.
    let is_free = |column: &usize| Some(*column) != speed_column && !counts_rows(sheet, *column);
    let all = || (0..sheet.width).filter(is_free).filter(rises);
    let is_named = |column: &usize| chosen.no_unit.contains(&(Quantity::Time, *column));
    let changes = |column: &usize| {
        let values = raw(sheet, *column);
        values.windows(2).filter(|pair| pair[1] > pair[0]).count()
    };
    let most = all().map(|column| changes(&column)).max().unwrap_or(0);
    // Minutes since an event rise, too, but a tenth as often.
    let is_fine = |column: &usize| 10 * changes(column) >= most;
    let is_misspelt = |column: &usize| {
        sheet
            .names
            .get(*column)
            .is_some_and(|name| is_like_time(name))
    };
    let named_time = all().find(|column| is_named(column) && is_fine(column));
    let named_time = named_time.or_else(|| all().find(is_misspelt));
    let named_time = named_time.or_else(|| all().find(is_named));
    let named_time = named_time.or_else(|| named.filter(|_| all().next().is_none()));
    (named_time, all().next())
}

/// Columns for a file whose names do not say all: by the names that mean something, by a column that never falls, by the units that fit a car.
pub(super) fn guess(
    sheet: &Sheet<'_>,
    chosen: &Chosen,
    filters: &[(String, String)],
) -> Option<Guess> {
    let mut hint = String::new();
    let is_number = |column: &usize| raw(sheet, *column).len() > 1;
    let named = |quantity: Quantity| {
        chosen
            .no_unit
            .iter()
            .find(|(own, _)| *own == quantity)
            .map(|(_, column)| *column)
    };
    let stamps = |column: &usize| sheet.form(*column);
    let speed_column = chosen
        .speeds
        .first()
        .map(|source| source.column)
        .or_else(|| named(Quantity::Speed));
    let (named_time, rising) = time_columns(sheet, chosen, speed_column);
    let time = match (chosen.times.first(), named_time) {
        (Some(time), _) => time.clone(),
        (None, named) => {
            let stamped = || (0..sheet.width).find(|column| stamps(column).is_some());
            let column = named.or_else(stamped).or(rising)?;
            let reading = match stamps(&column) {
                Some(form) => Reading::Stamp(form),
                None => Reading::Number(Quantity::Time.unit(time_unit(&raw(sheet, column)))?),
            };
            Source {
                quantity: Quantity::Time,
                column,
                reading,
                only: None,
            }
        }
    };
    let speed = match chosen.speeds.first() {
        Some(speed) => speed.clone(),
        None => {
            // Without a name that means a speed, only a table of two columns leaves no choice, or the speed of a wheel.
            let other = || {
                (0..sheet.width)
                    .find(|column| *column != time.column && is_number(column))
                    .filter(|_| sheet.width == 2 || sheet.names.is_empty())
                    .filter(|column| !is_no_speed(sheet, *column))
            };
            let wheel = || {
                (0..sheet.names.len()).find(|column| {
                    let name = crate::channel::bare(&sheet.names[*column]);
                    name.contains("wheel")
                        && name.contains("speed")
                        && is_number(column)
                        && sheet.stated_unit(Quantity::Speed, *column).is_some()
                })
            };
            let column = named(Quantity::Speed).or_else(other).or_else(wheel)?;
            let only = chosen.only_no_unit.clone();
            let pairs = pairs(sheet, &time, column, only.as_ref());
            let is_position = |name: &String| {
                let name = crate::channel::bare(name);
                ["lat", "latitude"]
                    .iter()
                    .any(|word| name.split('_').any(|own| own == *word))
            };
            let of_satellites = sheet.names.iter().any(is_position);
            let (guessed, words) = speed_unit(&pairs, of_satellites);
            let stated = sheet.stated_unit(Quantity::Speed, column);
            let unit = stated.map_or(guessed, |unit| unit.name);
            hint = words;
            Source {
                quantity: Quantity::Speed,
                column,
                reading: Reading::Number(Quantity::Speed.unit(unit)?),
                only,
            }
        }
    };
    let columns = columns(sheet, chosen, (&time, &speed), &[], filters);
    Some(Guess { columns, hint })
}
