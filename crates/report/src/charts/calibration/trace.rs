//! Measured traces against time, with what is computed.

use super::super::axis::Axis;
use super::super::figure::{Figure, INK, Path, Rect};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::study::text::{foot, foot_height};
use super::super::style::Stroke;
use super::{AFTER, BEFORE, LEFT_OUT, RIGHT, TOP, WIDTH, common_note, in_sd, subject, unit};
use cvtcycle_study::fit::outcome::{Outcome, Residual};

const TALL: f64 = 330.0;
/// Standard deviations on either side of what was measured.
const BAND: f64 = 2.0;
const BAND_COLOUR: &str = "#8c8c8c";
/// Most rows of a table.
const MOST_ROWS: usize = 600;
const STROKES: [Stroke; 4] = [
    Stroke {
        colour: INK,
        width: 1.2,
        dash: &[],
    },
    Stroke {
        colour: BEFORE,
        width: 1.5,
        dash: &[5.0, 3.0],
    },
    Stroke {
        colour: AFTER,
        width: 2.0,
        dash: &[],
    },
    Stroke {
        colour: LEFT_OUT,
        width: 1.5,
        dash: &[2.0, 2.5],
    },
];
const KEYS: [&str; 4] = [
    "Measured",
    "With the files' values",
    "Fitted",
    "Predicted: fitted without its fold",
];

/// Draws each measured column of each trace over time, with its name.
#[must_use]
pub fn trace_plots(outcome: &Outcome) -> Vec<(String, Picture)> {
    let mut found: Vec<(&str, &str, Vec<&Residual>)> = Vec::new();
    for r in outcome
        .residuals
        .iter()
        .filter(|r| r.time_s.is_some_and(f64::is_finite))
    {
        match found
            .iter_mut()
            .find(|(group, column, _)| *group == r.group && *column == r.column)
        {
            Some((.., list)) => list.push(r),
            None => found.push((&r.group, &r.column, vec![r])),
        }
    }
    let mut names: Vec<String> = Vec::new();
    let mut pictures = Vec::new();
    for (group, column, mut list) in found {
        list.sort_by(|a, b| a.time_s.unwrap_or(0.0).total_cmp(&b.time_s.unwrap_or(0.0)));
        let plain = format!("trace_{}_{}", word(group), word(column));
        let same = names.iter().filter(|name| **name == plain).count();
        let name = if same > 0 {
            format!("{plain}_{}", same + 1)
        } else {
            plain.clone()
        };
        names.push(plain);
        pictures.push((name, trace(outcome, group, column, &list)));
    }
    pictures
}

/// A name that can be part of a file's.
fn word(name: &str) -> String {
    name.chars()
        .map(|c| {
            if c.is_ascii_alphanumeric() {
                c.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .take(60)
        .collect()
}

/// Measured number, with the files' values, fitted, predicted.
fn numbers(r: &Residual) -> [Option<f64>; 4] {
    [r.low, r.before, Some(r.after), r.left_out].map(|x| x.filter(|x| x.is_finite()))
}

fn trace(outcome: &Outcome, group: &str, column: &str, list: &[&Residual]) -> Picture {
    let table = table(list);
    let unit = unit(list.first().map_or("", |r| &r.unit));
    let there: Vec<usize> = (0..4)
        .filter(|k| list.iter().any(|r| numbers(r)[*k].is_some()))
        .collect();
    let mut notes =
        vec!["Grey band: two standard deviations on either side of what was measured.".to_owned()];
    notes.extend(common_note(outcome));
    notes.extend((!table.note.is_empty()).then(|| table.note.clone()));
    let rect = Rect {
        left: LEFT + 8.0,
        right: RIGHT,
        top: TOP,
        bottom: TOP + TALL,
    };
    let (end, wide) = ((rect.left, rect.bottom + BELOW + 8.0), RIGHT - rect.left);
    let names: Vec<&str> = there.iter().map(|k| KEYS[*k]).collect();
    let tall = end.1 + foot_height(names.iter().copied(), wide, &notes);
    let desc = format!(
        "{column} of the data {group} over time: measured with two standard deviations, and computed. {}",
        ends(list, unit)
    );
    let mut figure = Figure::new(
        (WIDTH, tall),
        rect.left,
        &format!("{column}, {group}"),
        &subject(outcome),
        &desc,
    );
    let time = |r: &&Residual| r.time_s.unwrap_or(0.0);
    let (from, to) = (
        list.first().map_or(0.0, time),
        list.last().map_or(1.0, time),
    );
    let all = list.iter().flat_map(|r| {
        numbers(r)
            .into_iter()
            .flatten()
            .chain(band(r).into_iter().flatten())
    });
    let x = if to > from {
        Axis::exact("Time [s]", from, to, 9)
    } else {
        Axis::exact("Time [s]", from - 1.0, to + 1.0, 9)
    };
    let panel = Panel::over_table(
        &mut figure,
        rect,
        x,
        Axis::round(&format!("{column} [{unit}]"), all, 8),
        true,
    );
    draw_band(&mut figure, &panel, list);
    for k in &there {
        let points: Vec<(f64, f64)> = list
            .iter()
            .map(|r| (time(r), numbers(r)[*k].unwrap_or(f64::NAN)))
            .collect();
        panel.line(&mut figure, &points, STROKES[*k]);
    }
    panel.outline(&mut figure);
    let marks = there
        .iter()
        .map(|k| Mark::Line(STROKES[*k]))
        .zip(names)
        .collect();
    foot(&mut figure, end, wide, marks, &notes);
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// The ends of the band.
fn band(r: &Residual) -> [Option<f64>; 2] {
    let sd = if r.sd.is_finite() { r.sd } else { 0.0 };
    [r.low.map(|x| x - BAND * sd), r.high.map(|x| x + BAND * sd)]
}

/// The band where something was measured, thinned to what can be seen.
fn draw_band(figure: &mut Figure, panel: &Panel, list: &[&Residual]) {
    let every = list.len().div_ceil(1500).max(1);
    let seen: Vec<(f64, f64, f64)> = list
        .iter()
        .enumerate()
        .filter(|(k, _)| k.is_multiple_of(every) || k + 1 == list.len())
        .filter_map(|(_, r)| {
            let [low, high] = band(r);
            Some((
                r.time_s?,
                low.filter(|x| x.is_finite())?,
                high.filter(|x| x.is_finite())?,
            ))
        })
        .collect();
    let mut path = Path::default();
    for (t, _, high) in &seen {
        path.line_to(panel.px(*t), panel.py(*high));
    }
    for (t, low, _) in seen.iter().rev() {
        path.line_to(panel.px(*t), panel.py(*low));
    }
    path.close();
    let data = path.finish();
    if seen.len() > 1 {
        figure.raw(&format!("<path class=\"band\" d=\"{data}\" fill=\"{BAND_COLOUR}\" fill-opacity=\"0.3\" stroke=\"none\"/>"));
    }
}

fn table(list: &[&Residual]) -> PictureTable {
    let mut table = PictureTable::new(&[
        ("Time", "s"),
        ("Measured", ""),
        ("Standard deviation", ""),
        ("Files' values", ""),
        ("Fitted", ""),
        ("Predicted", ""),
    ]);
    let every = list.len().div_ceil(MOST_ROWS).max(1);
    for r in list.iter().step_by(every) {
        let [measured, before, after, left_out] = numbers(r).map(|x| in_sd(x, r));
        table.push(vec![
            cell(r.time_s.unwrap_or(f64::NAN), 0.1),
            measured,
            in_sd(Some(r.sd), r),
            before,
            after,
            left_out,
        ]);
    }
    if every > 1 {
        table.note = format!("One value in {every} is listed; residuals.csv has all.");
    }
    table
}

fn ends(list: &[&Residual], unit: &str) -> String {
    let told = |r: &Residual| {
        let number = |x: Option<f64>| x.map_or_else(|| "nothing".to_owned(), |x| in_sd(Some(x), r));
        let [measured, _, after, _] = numbers(r).map(number);
        format!(
            "{measured} measured and {after} fitted at {} s",
            cell(r.time_s.unwrap_or(0.0), 0.1)
        )
    };
    let list: Vec<String> = list
        .first()
        .into_iter()
        .chain(list.last())
        .map(|r| told(r))
        .collect();
    format!("{} [{unit}].", list.join("; "))
}
