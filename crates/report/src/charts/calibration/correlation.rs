//! Correlation of the parameters as coloured cells.

use super::{MARGIN, RIGHT, TOP, WIDE_FOOT, subject};
use crate::charts::engine::{
    Axis, Block, Chart, Cut, DIVERGING, Key, Label, Panel, Rect, Shape, Style, at, between, cell,
    stroke, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_study::fit::outcome::Outcome;

/// Most parameters that are drawn: more could not be read.
const MAX_DRAWN: usize = 50;
/// Numbers are written from this correlation on.
const STRONG: f64 = 0.5;
/// Room for names: of few parameters, and of so many that cells need it to hold their numbers, pixels.
const NAMES: [f64; 2] = [300.0, 200.0];
const FEW: usize = 18;
const TEXT: f64 = 11.0;
/// Largest cell, and the smallest one that holds a number, pixels.
const CELL: f64 = 40.0;
const HOLDS: f64 = 24.0;
/// Room above the cells for the numbers of the columns, pixels.
const HEAD: f64 = 20.0;
const SLICES: usize = 40;
/// Ink on light cells: no text colour of the page, for the cells keep their colours where a dark page turns those around.
const ON_LIGHT: &str = "#111111";
const ON_DARK: &str = "#ffffff";

/// Draws the matrix of correlations, rows and columns in the order of the parameters.
#[must_use]
pub fn correlation_plot(outcome: &Outcome) -> Picture {
    let count = outcome.parameters.len();
    let n = count.min(MAX_DRAWN);
    let mut table = PictureTable::new(&[
        ("Parameter", ""),
        ("Other parameter", ""),
        ("Correlation", ""),
    ]);
    let mut notes =
        vec!["Columns bear the numbers of the rows. Crossed out: not known, for the data do not determine the parameter.".to_owned()];
    if n < count {
        notes.push(format!(
            "The first {n} of {count} parameters; correlation.csv has all."
        ));
    }
    table.note = notes.join(" ");
    let names = NAMES[usize::from(n > FEW)];
    let size = ((RIGHT - MARGIN - names) / n.max(1) as f64).min(CELL);
    let rect = Rect::new(MARGIN + names, TOP + HEAD, n as f64 * size, n as f64 * size);
    let mut panel = Panel {
        x_labels: false,
        below: 14.0,
        ..Panel::new(rect, Axis::bare(0.0, n as f64), Axis::bare(n as f64, 0.0))
    };
    for i in 0..n {
        name(&mut panel, outcome, i, size);
        for j in 0..n {
            let row = (j < i).then(|| table.push(cells(outcome, i, j)));
            draw(&mut panel, outcome, (i, j), size, row);
        }
    }
    let colour = |k: usize| colour(2.0 * (k as f64 + 0.5) / SLICES as f64 - 1.0);
    let label = |r: f64| (0.5 + 0.5 * r, cell(r, 0.1));
    let key = Key {
        heading: "Correlation [-]".to_owned(),
        colours: (0..SLICES).map(colour).collect(),
        labels: [-1.0, -0.5, 0.0, 0.5, 1.0].map(label).into(),
    };
    let chart = Chart {
        title: "Correlation of the parameters".to_owned(),
        subject: subject(outcome),
        description: describe(outcome),
        left: MARGIN,
        panels: vec![panel],
        foot: vec![
            Block::key((MARGIN + 8.0, 260.0), key),
            Block::notes(WIDE_FOOT, notes),
        ],
        table,
        ..Chart::default()
    };
    chart.picture()
}

/// Writes name and number of a row, and the number of its column.
fn name(panel: &mut Panel, outcome: &Outcome, i: usize, size: f64) {
    // Names of rows that are lower than a line of text would run into each other.
    let every = (13.0 / size).ceil().max(1.0) as usize;
    if !i.is_multiple_of(every) {
        return;
    }
    let (middle, number) = (i as f64 + 0.5, (i + 1).to_string());
    let left = at(f64::NEG_INFINITY, middle);
    let name = Label::new(left.shift(-30.0, 4.0), &outcome.parameters[i].name).end();
    let room = panel.rect.left - MARGIN - 36.0;
    panel.label(name.class("row").cut(Cut::Start, room));
    panel.label(Label::new(left.shift(-7.0, 4.0), &number).end().bold(true));
    if size >= text_width("00", TEXT) {
        let above = at(middle, f64::INFINITY).shift(0.0, -6.0);
        panel.label(Label::new(above, number).middle().bold(true));
    }
}

fn correlation(outcome: &Outcome, i: usize, j: usize) -> Option<f64> {
    outcome
        .correlation
        .get(i)?
        .get(j)
        .copied()
        .flatten()
        .filter(|r| r.is_finite())
}

fn cells(outcome: &Outcome, i: usize, j: usize) -> Vec<String> {
    let names = [i, j].map(|k| outcome.parameters[k].name.clone());
    let number = correlation(outcome, i, j).map_or_else(String::new, |r| cell(r, 0.001));
    names.into_iter().chain([number]).collect()
}

fn colour(r: f64) -> String {
    between(DIVERGING, 0.5 + 0.5 * r)
}

/// Adds a cell; only those below the diagonal are in the table, each pair once.
fn draw(
    panel: &mut Panel,
    outcome: &Outcome,
    (i, j): (usize, usize),
    size: f64,
    row: Option<usize>,
) {
    let r = correlation(outcome, i, j);
    let (x, y, own) = (j as f64, i as f64, i == j);
    let fill = match r {
        _ if own => Style::colour("#b0b0b0"),
        Some(r) => Style::colour(&colour(r)),
        None => Style::default(),
    };
    let style = Style {
        stroke: Some(stroke("#dedede", 0.25, &[])),
        row,
        ..fill.class("cell")
    };
    panel.add(Shape::Rect(at(x, y), at(x + 1.0, y + 1.0)), style);
    match r {
        _ if own => {}
        Some(r) if r.abs() >= STRONG && size >= HOLDS => {
            let ink = if r.abs() > 0.75 { ON_DARK } else { ON_LIGHT };
            let text = cell(r, 0.01).replacen("0.", ".", 1);
            let middle = at(x + 0.5, y + 0.5).shift(0.0, 4.0);
            panel.label(Label::new(middle, text).middle().colour(ink));
        }
        Some(_) => {}
        None => {
            let (low, high) = (
                at(x, y + 1.0).shift(3.0, -3.0),
                at(x + 1.0, y).shift(-3.0, 3.0),
            );
            let line = Style::line(stroke("#8c8c8c", 0.75, &[]));
            panel.add(Shape::Segment(low, high), line);
        }
    }
}

fn describe(outcome: &Outcome) -> String {
    let n = outcome.parameters.len();
    let mut pairs: Vec<(f64, usize, usize)> = (0..n)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .filter_map(|(i, j)| Some((correlation(outcome, i, j)?, i, j)))
        .collect();
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let pair = |(r, i, j): &(f64, usize, usize)| {
        format!(
            "{} with {}: {}",
            outcome.parameters[*i].name,
            outcome.parameters[*j].name,
            cell(*r, 0.01)
        )
    };
    let list: Vec<String> = pairs.iter().take(12).map(pair).collect();
    let words = if list.is_empty() {
        "None is known".to_owned()
    } else {
        list.join("; ")
    };
    format!("Correlation of the fitted parameters, the strongest first. {words}.")
}
