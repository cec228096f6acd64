//! Correlation of the parameters as coloured cells.

use super::super::figure::{Anchor, Figure, INK, Rect, text_width};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::study::text::{foot_height, middle};
use super::super::style::between;
use super::{MARGIN, RIGHT, TOP, WIDTH, key, subject};
use cvtcycle_study::fit::outcome::Outcome;

/// Most parameters that are drawn: more could not be read.
const MOST: usize = 50;
/// Numbers are written from this correlation on.
const STRONG: f64 = 0.5;
/// Room for names: of few parameters, and of so many that cells need it to hold their numbers, pixels.
const NAMES: [f64; 2] = [300.0, 200.0];
const FEW: usize = 18;
const TEXT: f64 = 11.0;
/// Largest cell, and the smallest one that holds a number, pixels.
const CELL: f64 = 40.0;
const HOLDS: f64 = 24.0;
/// Room between the names and the last row of cells, and the key, pixels.
const HEAD: f64 = 20.0;
const KEY: f64 = 52.0;
const SLICES: usize = 40;
/// From -1 over 0 to 1: blue, white, brown, which the colour-blind tell apart, and the darker the stronger.
const DIVERGING: [(f64, f64, f64); 5] = [
    (5.0, 80.0, 150.0),
    (125.0, 180.0, 220.0),
    (247.0, 247.0, 247.0),
    (243.0, 175.0, 105.0),
    (160.0, 72.0, 5.0),
];
/// Ink on light cells: no text colour of the page, for the cells keep their colours where a dark page turns those around.
const ON_LIGHT: &str = "#111111";
const ON_DARK: &str = "#ffffff";

/// Draws the matrix of correlations, rows and columns in the order of the parameters.
#[must_use]
pub fn correlation_plot(outcome: &Outcome) -> Picture {
    let count = outcome.parameters.len();
    let n = count.min(MOST);
    let mut table = PictureTable::new(&[
        ("Parameter", ""),
        ("Other parameter", ""),
        ("Correlation", ""),
    ]);
    let mut notes =
        vec!["Columns bear the numbers of the rows. Crossed out: not known, for the data do not tell the parameter.".to_owned()];
    if n < count {
        notes.push(format!(
            "The first {n} of {count} parameters; correlation.csv has all."
        ));
    }
    table.note = notes.join(" ");
    let names = NAMES[usize::from(n > FEW)];
    let size = ((RIGHT - MARGIN - names) / n.max(1) as f64).min(CELL);
    let (left, top) = (MARGIN + names, TOP + HEAD);
    let bottom = top + n as f64 * size;
    let (strip, wide) = ((MARGIN, bottom + 14.0), RIGHT - MARGIN);
    let tall = strip.1 + KEY + foot_height(std::iter::empty(), wide, &notes);
    let mut figure = Figure::new(
        (WIDTH, tall),
        MARGIN,
        "Correlation of the parameters",
        &subject(outcome),
        &describe(outcome),
    );
    for (i, p) in outcome.parameters.iter().take(n).enumerate() {
        let middle_y = top + (i as f64 + 0.5) * size;
        // Names of rows that are lower than a line of text would run into each other.
        let every = (13.0 / size).ceil().max(1.0) as usize;
        if i.is_multiple_of(every) {
            let y = middle_y + 4.0;
            key(
                &mut figure,
                (left - 30.0, y),
                names - 36.0,
                "class=\"row\"",
                &p.name,
            );
            figure.text(
                (left - 7.0, y),
                TEXT,
                Anchor::End,
                "font-weight=\"bold\"",
                INK,
                &(i + 1).to_string(),
            );
            let x = left + (i as f64 + 0.5) * size;
            if size >= text_width("00", TEXT) {
                figure.text(
                    (x, top - 6.0),
                    TEXT,
                    Anchor::Middle,
                    "font-weight=\"bold\"",
                    INK,
                    &(i + 1).to_string(),
                );
            }
        }
        for j in 0..n {
            let rect = Rect {
                left: left + j as f64 * size,
                right: left + (j + 1) as f64 * size,
                top: middle_y - 0.5 * size,
                bottom: middle_y + 0.5 * size,
            };
            let r = correlation(outcome, i, j);
            let row = (j < i).then(|| table.push(cells(outcome, i, j)));
            draw(&mut figure, rect, r, i == j, row);
        }
    }
    let frame = Rect {
        left,
        right: left + n as f64 * size,
        top,
        bottom,
    };
    figure.rect(
        frame,
        &format!("class=\"plot\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"3\""),
    );
    colour_key(&mut figure, strip);
    for (k, line) in notes.iter().enumerate() {
        let at = (MARGIN, strip.1 + KEY + 11.0 + 20.0 * k as f64);
        figure.text(
            at,
            TEXT,
            Anchor::Start,
            "",
            super::super::figure::QUIET,
            &middle(line, TEXT, wide),
        );
    }
    Picture {
        svg: figure.finish(),
        table,
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
    between(&DIVERGING, 0.5 + 0.5 * r)
}

/// Draws a cell; only those below the diagonal stand in the table, each pair once.
fn draw(figure: &mut Figure, rect: Rect, r: Option<f64>, own: bool, row: Option<usize>) {
    let of_row = row.map_or_else(String::new, |row| format!(" data-row=\"{row}\""));
    let fill = match r {
        _ if own => "#b0b0b0".to_owned(),
        Some(r) => colour(r),
        None => "none".to_owned(),
    };
    figure.rect(
        rect,
        &format!("class=\"cell\" fill=\"{fill}\" stroke=\"#dedede\" stroke-width=\"1\"{of_row}"),
    );
    let (x, y) = (
        0.5 * (rect.left + rect.right),
        0.5 * (rect.top + rect.bottom),
    );
    match r {
        _ if own => {}
        Some(r) if r.abs() >= STRONG && rect.right - rect.left >= HOLDS => {
            let ink = if r.abs() > 0.75 { ON_DARK } else { ON_LIGHT };
            let text = cell(r, 0.01).replacen("0.", ".", 1);
            figure.text((x, y + 4.0), TEXT, Anchor::Middle, "", ink, &text);
        }
        Some(_) => {}
        None => figure.line(
            (rect.left + 3.0, rect.bottom - 3.0),
            (rect.right - 3.0, rect.top + 3.0),
            "stroke=\"#8c8c8c\" stroke-width=\"3\"",
        ),
    }
}

fn colour_key(figure: &mut Figure, (left, top): (f64, f64)) {
    figure.open("legend");
    figure.text(
        (left, top + TEXT),
        TEXT,
        Anchor::Start,
        "",
        INK,
        "Correlation [-]",
    );
    let strip = Rect {
        left: left + 8.0,
        right: left + 268.0,
        top: top + 17.0,
        bottom: top + 29.0,
    };
    let place = |share: f64| strip.left + (strip.right - strip.left) * share;
    for k in 0..SLICES {
        let slice = Rect {
            left: place(k as f64 / SLICES as f64),
            right: place((k + 1) as f64 / SLICES as f64),
            ..strip
        };
        let fill = colour(2.0 * (k as f64 + 0.5) / SLICES as f64 - 1.0);
        figure.rect(
            slice,
            &format!("fill=\"{fill}\" shape-rendering=\"crispEdges\""),
        );
    }
    figure.rect(
        strip,
        &format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"2\""),
    );
    for r in [-1.0, -0.5, 0.0, 0.5, 1.0] {
        let x = place(0.5 + 0.5 * r);
        figure.line(
            (x, strip.bottom),
            (x, strip.bottom + 3.0),
            &format!("stroke=\"{INK}\" stroke-width=\"3\""),
        );
        figure.text(
            (x, strip.bottom + 15.0),
            TEXT,
            Anchor::Middle,
            "",
            INK,
            &cell(r, 0.1),
        );
    }
    figure.close();
}

fn describe(outcome: &Outcome) -> String {
    let n = outcome.parameters.len();
    let mut pairs: Vec<(f64, usize, usize)> = (0..n)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .filter_map(|(i, j)| Some((correlation(outcome, i, j)?, i, j)))
        .collect();
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let told = |(r, i, j): &(f64, usize, usize)| {
        format!(
            "{} with {}: {}",
            outcome.parameters[*i].name,
            outcome.parameters[*j].name,
            cell(*r, 0.01)
        )
    };
    let list: Vec<String> = pairs.iter().take(12).map(told).collect();
    let words = if list.is_empty() {
        "None is known".to_owned()
    } else {
        list.join("; ")
    };
    format!("Correlation of the fitted parameters, the strongest first. {words}.")
}
