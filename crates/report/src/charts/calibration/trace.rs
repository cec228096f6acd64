//! Measured traces against time, with the computed ones.

use super::{AFTER, BEFORE, FOOT, LEFT_OUT, TOP, common_note, in_sd, subject, unit};
use crate::charts::engine::{
    Axis, Chart, Entry, INK, PLOT_LEFT, Panel, Rect, Shape, Stroke, Style, optional_cell, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::charts::study::value;
use crate::number::words;
use cvtcycle_calibrate::outcome::{Outcome, Residual, rms};

const TALL: f64 = 330.0;
/// Half-width of the band around the measurement, standard deviations.
const BAND: f64 = 2.0;
const BAND_COLOUR: &str = "#8c8c8c";
/// Maximum number of rows of a table, and of points of the band.
const MAX_ROWS: usize = 600;
const MAX_BAND: usize = 1500;
const LINES: [(Stroke, &str); 4] = [
    (stroke(INK, 1.2, &[]), "Measured"),
    (stroke(BEFORE, 1.5, &[5.0, 3.0]), "With the files' values"),
    (stroke(AFTER, 2.0, &[]), "Fitted"),
    (
        stroke(LEFT_OUT, 1.5, &[2.0, 2.5]),
        "Predicted: fitted without its fold",
    ),
];

/// Draws each measured column of each trace over time, with its name.
pub fn trace_plots(outcome: &Outcome) -> Vec<(String, Picture)> {
    let timed = |r: &&Residual| r.time_s.is_some_and(f64::is_finite);
    let mut found: Vec<(&str, &str, Vec<&Residual>)> = Vec::new();
    for r in outcome.residuals.iter().filter(timed) {
        let same = |of: &&mut (&str, &str, Vec<_>)| of.0 == r.group && of.1 == r.column;
        match found.iter_mut().find(same) {
            Some((.., list)) => list.push(r),
            None => found.push((&r.group, &r.column, vec![r])),
        }
    }
    let mut names: Vec<String> = Vec::new();
    let picture = |(group, column, mut list): (&str, &str, Vec<&Residual>)| {
        list.sort_by(|a, b| time(a).total_cmp(&time(b)));
        let plain = format!("trace_{}_{}", word(group), word(column));
        names.push(plain.clone());
        let name = match names.iter().filter(|name| **name == plain).count() {
            0 | 1 => plain,
            same => format!("{plain}_{same}"),
        };
        (name, trace(outcome, group, column, &list))
    };
    found.into_iter().map(picture).collect()
}

/// Converts a name for use in a file name.
fn word(name: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '_'
        }
    };
    name.chars().map(plain).take(60).collect()
}

/// Measured number, with the files' values, fitted, predicted.
fn numbers(r: &Residual) -> [Option<f64>; 4] {
    [r.low, r.before, Some(r.after), r.left_out].map(|x| x.filter(|x| x.is_finite()))
}

fn trace(outcome: &Outcome, group: &str, column: &str, list: &[&Residual]) -> Picture {
    let table = table(list);
    let unit = unit(list.first().map_or("", |r| &r.unit));
    let mut notes =
        vec!["Grey band: two standard deviations on either side of what was measured.".to_owned()];
    notes.extend(common_note(outcome));
    notes.extend((!table.note.is_empty()).then(|| table.note.clone()));
    let ends_of_band = |r: &&Residual| band(r).into_iter().flatten().collect::<Vec<f64>>();
    let values = list.iter().flat_map(|r| numbers(r).into_iter().flatten());
    let values = values.chain(list.iter().flat_map(ends_of_band));
    let y = Axis::round(&format!("{column} [{unit}]"), values, 8);
    let rect = Rect::new(PLOT_LEFT, TOP, FOOT.1, TALL);
    let mut panel = Panel::new(rect, x_axis(list), y).over_table();
    let seen = band_points(list);
    if seen.len() > 1 {
        let style = Style::colour(BAND_COLOUR).fill_opacity(0.3).class("band");
        panel.add(Shape::between(&seen), style);
    }
    let mut entries = Vec::new();
    for (k, (stroke, name)) in LINES.into_iter().enumerate() {
        let point = |r: &&Residual| (time(r), numbers(r)[k].unwrap_or(f64::NAN));
        let points: Vec<(f64, f64)> = list.iter().map(point).collect();
        if points.iter().any(|p| p.1.is_finite()) {
            panel.series(points, stroke);
            entries.push(Entry::line(stroke, name));
        }
    }
    let about = format!("{}; {group}", subject(outcome));
    Chart::new(title(column, unit, list), about, PLOT_LEFT)
        .panels([panel])
        .legend(FOOT, entries)
        .notes(FOOT, notes)
        .picture(table)
}

/// Title: distance of the computed trace from the measured one, with the values of the files and fitted.
fn title(column: &str, unit: &str, list: &[&Residual]) -> String {
    let off = |k: usize| {
        let differences = list.iter().filter_map(|r| {
            let [measured, ..] = numbers(r);
            Some(numbers(r)[k]? - measured?)
        });
        rms(differences)
    };
    let name = words(column.strip_suffix("_degc").unwrap_or(column));
    let digits = |x: f64| value(x, off(1).unwrap_or(x));
    match (off(1), off(2)) {
        (Some(before), Some(after)) => format!(
            "The fit brings the {name} from {} to {} {unit} off the measured one (root mean square)",
            digits(before),
            digits(after)
        ),
        (None, Some(after)) => format!(
            "Fitted, the {name} is {} {unit} off the measured one (root mean square)",
            digits(after)
        ),
        _ => format!("Measured and computed {name}"),
    }
}

fn time(r: &Residual) -> f64 {
    r.time_s.unwrap_or(0.0)
}

fn x_axis(list: &[&Residual]) -> Axis {
    let from = list.first().map_or(0.0, |r| time(r));
    let to = list.last().map_or(1.0, |r| time(r));
    let room = if to > from { 0.0 } else { 1.0 };
    Axis::exact("Time [s]", from - room, to + room, 9)
}

/// Ends of the band.
fn band(r: &Residual) -> [Option<f64>; 2] {
    let sd = if r.sd.is_finite() { r.sd } else { 0.0 };
    [r.low.map(|x| x - BAND * sd), r.high.map(|x| x + BAND * sd)]
}

/// Band over the measured points, thinned to the visible resolution.
fn band_points(list: &[&Residual]) -> Vec<(f64, f64, f64)> {
    let every = list.len().div_ceil(MAX_BAND).max(1);
    let kept = list.iter().enumerate();
    let kept = kept.filter(|(k, _)| k.is_multiple_of(every) || k + 1 == list.len());
    let ends = |(_, r): (usize, &&Residual)| {
        let [low, high] = band(r).map(|x| x.filter(|x| x.is_finite()));
        Some((r.time_s?, low?, high?))
    };
    kept.filter_map(ends).collect()
}

fn table(list: &[&Residual]) -> PictureTable {
    let names = [
        "Measured",
        "Standard deviation",
        "Files' values",
        "Fitted",
        "Predicted",
    ];
    let mut table = PictureTable::new(&[("Time", "s")]);
    table
        .columns
        .extend(names.map(|name| (name.to_owned(), "")));
    let every = list.len().div_ceil(MAX_ROWS).max(1);
    for r in list.iter().step_by(every) {
        let [measured, before, after, left_out] = numbers(r);
        let numbers = [measured, Some(r.sd), before, after, left_out];
        let numbers = numbers.map(|x| in_sd(x, r));
        table.push([optional_cell(r.time_s, 0.1)].into_iter().chain(numbers));
    }
    if every > 1 {
        table.note = format!("One value in {every} is listed; residuals.csv has all.");
    }
    table
}
