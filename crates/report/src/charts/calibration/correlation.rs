//! Correlation of the parameters as coloured cells.

use super::{MARGIN, RIGHT, TOP, WIDE_FOOT, subject};
use crate::charts::engine::{
    Axis, Block, Chart, Cut, DIVERGING, Key, Label, Panel, Rect, Style, at, between, cell,
    optional_cell, stroke, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_calibrate::outcome::Outcome;

/// Maximum number of drawn parameters: more would be illegible.
const MAX_DRAWN: usize = 50;
/// Correlation from which on the number is written.
const STRONG: f64 = 0.5;
/// Room for names, pixels: of up to `FEW` parameters, and of more, where cells need the room for their numbers.
const NAMES: [f64; 2] = [300.0, 200.0];
const FEW: usize = 18;
const TEXT: f64 = 11.0;
/// Maximum cell size, and minimum size of a cell with a number, pixels.
const CELL: f64 = 40.0;
const HOLDS: f64 = 30.0;
/// Room above the cells for the numbers of the columns, pixels.
const HEAD: f64 = 20.0;
const SLICES: usize = 40;
/// Ink on light cells. Not a text colour of the page, which a dark page inverts while the cells keep their colours.
const ON_LIGHT: &str = "#111111";
const ON_DARK: &str = "#ffffff";

/// Draws the matrix of correlations, rows and columns in the order of the parameters.
pub fn correlation_plot(outcome: &Outcome) -> Picture {
    let count = outcome.parameters.len();
    let n = count.min(MAX_DRAWN);
    let unknown = (0..n).any(|i| (0..i).any(|j| correlation(outcome, i, j).is_none()));
    let crossed = if unknown {
        " Crossed out: not identifiable from these data."
    } else {
        ""
    };
    let mut notes = vec![format!("Columns bear the numbers of the rows.{crossed}")];
    if n < count {
        notes.push(format!(
            "The first {n} of {count} parameters; correlation.csv has all."
        ));
    }
    let columns = ["Parameter", "Other parameter", "Correlation"].map(|name| (name, ""));
    let mut table = PictureTable::new(&columns).note(notes.join(" "));
    let names = NAMES[usize::from(n > FEW)];
    let size = ((RIGHT - MARGIN - names) / n.max(1) as f64).min(CELL);
    let rect = Rect::new(MARGIN + names, TOP + HEAD, n as f64 * size, n as f64 * size);
    let n_rows = n as f64;
    let mut panel = Panel::new(rect, Axis::bare(0.0, n_rows), Axis::bare(n_rows, 0.0))
        .x_labels(false)
        .below(14.0);
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
    Chart::new(title(outcome, n), subject(outcome), MARGIN)
        .panels([panel])
        .foot(Block::key((MARGIN + 8.0, 260.0), key))
        .notes(WIDE_FOOT, notes)
        .picture(table)
}

/// The strongest correlation of two parameters.
fn title(outcome: &Outcome, n: usize) -> String {
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
    let known = pairs.filter_map(|(i, j)| Some((i, j, correlation(outcome, i, j)?)));
    match known.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs())) {
        Some((i, j, r)) => format!(
            "The strongest correlation of two parameters is {}: {} and {}",
            cell(r, 0.01),
            j + 1,
            i + 1
        ),
        None => "Correlation of the parameters".to_owned(),
    }
}

/// Writes name and number of a row, and the number of its column.
fn name(panel: &mut Panel, outcome: &Outcome, i: usize, size: f64) {
    // Row names in rows lower than a line of text would overlap.
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
    let row = outcome.correlation.get(i)?;
    (*row.get(j)?).filter(|r| r.is_finite())
}

fn cells(outcome: &Outcome, i: usize, j: usize) -> [String; 3] {
    let name = |k: usize| outcome.parameters[k].name.clone();
    let number = optional_cell(correlation(outcome, i, j), 0.001);
    [name(i), name(j), number]
}

fn colour(r: f64) -> String {
    between(DIVERGING, 0.5 + 0.5 * r)
}

/// Adds a cell. The table lists each pair once: only cells below the diagonal.
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
    let mut style = fill.class("cell").edge(stroke("#dedede", 0.25, &[]));
    style.row = row;
    panel.rectangle(at(x, y), at(x + 1.0, y + 1.0), style);
    match r {
        _ if own => {}
        Some(r) if r.abs() >= STRONG && size >= HOLDS => {
            let ink = if r.abs() > 0.75 { ON_DARK } else { ON_LIGHT };
            let text = cell(r, 0.01);
            let middle = at(x + 0.5, y + 0.5).shift(0.0, 4.0);
            panel.label(Label::new(middle, text).middle().colour(ink));
        }
        Some(_) => {}
        None => {
            let low = at(x, y + 1.0).shift(3.0, -3.0);
            let high = at(x + 1.0, y).shift(-3.0, 3.0);
            let line = Style::line(stroke("#8c8c8c", 0.75, &[]));
            panel.segment(low, high, line);
        }
    }
}
