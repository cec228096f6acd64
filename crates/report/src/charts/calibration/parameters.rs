//! Parameters: what was known before and what the fit found, between their bounds.

use super::super::axis::{Axis, round_step};
use super::super::figure::{Anchor, Figure, INK, QUIET, Rect};
use super::super::legend::Mark;
use super::super::panel::{BELOW, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::study::text::{foot, foot_height, middle, value};
use super::super::style::Stroke;
use super::super::symbol::Symbol;
use super::{AFTER, BEFORE, MARGIN, RIGHT, TOP, WIDTH, key, subject, unit};
use cvtcycle_study::fit::outcome::{Outcome, Parameter};

const ROW: f64 = 32.0;
/// Room for names on the left and for numbers on the right, pixels.
const NAMES: f64 = 290.0;
const NUMBERS: f64 = 172.0;
const TEXT: f64 = 11.0;
/// The axis ends so far beyond the bounds, as a share of their distance.
const BEYOND: f64 = 0.08;
/// Most rows: more do not fit on a page.
const MOST: usize = 50;
/// Errors are drawn to so many standard deviations.
const WIDE: f64 = 2.0;
const PRIOR: Stroke = Stroke {
    colour: BEFORE,
    width: 3.2,
    dash: &[],
};
const FITTED: Stroke = Stroke {
    colour: AFTER,
    width: 2.2,
    dash: &[],
};
const BOUND: Stroke = Stroke {
    colour: INK,
    width: 1.2,
    dash: &[5.0, 3.0],
};
const KEYS: [&str; 4] = [
    "Known before: mean and 2 sd",
    "Fitted, and 2 standard errors",
    "Value of the files",
    "Bounds",
];

/// Draws a row for each parameter: prior above, fitted value below, both with two standard deviations, on an axis from bound to bound.
#[must_use]
pub fn parameters_plot(outcome: &Outcome) -> Picture {
    let all = &outcome.parameters;
    let rows = &all[..all.len().min(MOST)];
    let mut table = PictureTable::new(&[
        ("Parameter", ""),
        ("Unit", ""),
        ("Value of the files", ""),
        ("Fitted", ""),
        ("Standard error", ""),
        ("Low", ""),
        ("High", ""),
        ("Prior mean", ""),
        ("Prior sd", ""),
        ("Share of the prior", "%"),
    ]);
    for p in all {
        table.push(cells(p));
    }
    let mut notes = vec!["Share of the prior: variance after the fit over variance before; near 100 % the data say nothing.".to_owned()];
    if rows.len() < all.len() {
        notes.push(format!(
            "{} more parameters are in the table.",
            all.len() - rows.len()
        ));
    }
    table.note = notes.join(" ");
    let rect = Rect {
        left: MARGIN + NAMES,
        right: RIGHT - NUMBERS,
        top: TOP,
        bottom: TOP + 6.0 + ROW * rows.len().max(2) as f64,
    };
    let (end, wide) = ((MARGIN, rect.bottom + BELOW + 8.0), RIGHT - MARGIN);
    let tall = end.1 + foot_height(KEYS.into_iter(), wide, &notes);
    let mut figure = Figure::new(
        (WIDTH, tall),
        MARGIN,
        "Parameters",
        &subject(outcome),
        &describe(outcome),
    );
    let mut y = Axis::exact("", 0.0, 1.0, 2);
    y.ticks.clear();
    let x = Axis::exact("Place between the bounds [-]", -BEYOND, 1.0 + BEYOND, 6);
    let panel = Panel::draw(&mut figure, rect, x, y, true);
    for bound in [0.0, 1.0] {
        panel.line_any(&mut figure, &[(bound, 0.0), (bound, 1.0)], BOUND);
    }
    for (k, p) in rows.iter().enumerate() {
        draw(
            &mut figure,
            &panel,
            (k, rect.top + 3.0 + (k as f64 + 0.5) * ROW),
            p,
        );
    }
    panel.outline(&mut figure);
    let marks = [
        Mark::Line(PRIOR),
        Mark::Line(FITTED),
        Mark::Point(Symbol::plain(0, INK), false),
        Mark::Line(BOUND),
    ];
    foot(
        &mut figure,
        end,
        wide,
        marks.into_iter().zip(KEYS).collect(),
        &notes,
    );
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// A step that leaves three digits of what a parameter is known to.
fn step(p: &Parameter) -> f64 {
    let error = p.standard_error.filter(|x| *x > 0.0 && x.is_finite());
    round_step((error.unwrap_or(p.high - p.low) / 200.0).abs().max(1e-300))
}

fn cells(p: &Parameter) -> Vec<String> {
    let step = step(p);
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| cell(x, step));
    let bound = |x: f64| cell(x, round_step(((p.high - p.low) / 1000.0).abs().max(1e-300)));
    vec![
        p.name.clone(),
        unit(&p.unit).to_owned(),
        number(Some(p.file_value)),
        number(Some(p.value)),
        number(p.standard_error),
        bound(p.low),
        bound(p.high),
        number(p.prior.map(|prior| prior[0])),
        number(p.prior.map(|prior| prior[1])),
        p.prior_share
            .map_or_else(String::new, |share| cell(100.0 * share, 0.1)),
    ]
}

fn draw(figure: &mut Figure, panel: &Panel, (row, y): (usize, f64), p: &Parameter) {
    let of_row = format!("data-row=\"{row}\"");
    let rect = panel.rect;
    let span = p.high - p.low;
    let at = |x: f64| panel.px(((x - p.low) / span).clamp(panel.x.low, panel.x.high));
    let sound = |x: f64| x.is_finite() && span > 0.0;
    if row > 0 {
        let line = y - 0.5 * ROW;
        figure.line(
            (rect.left, line),
            (rect.right, line),
            "stroke=\"#dedede\" stroke-width=\"2\"",
        );
    }
    if let Some([mean, sd]) = p.prior.filter(|[mean, sd]| sound(*mean) && sd.is_finite()) {
        let y = y - 6.0;
        span_of(
            figure,
            (at(mean - WIDE * sd), at(mean + WIDE * sd), y),
            PRIOR,
            &of_row,
        );
        figure.line(
            (at(mean), y - 5.0),
            (at(mean), y + 5.0),
            &format!("{} {of_row}", PRIOR.attributes()),
        );
    }
    if sound(p.file_value) {
        Symbol::plain(0, INK).open(figure, (at(p.file_value), y + 6.0), 4.6, &of_row);
    }
    if sound(p.value) {
        if let Some(error) = p.standard_error.filter(|x| x.is_finite()) {
            span_of(
                figure,
                (
                    at(p.value - WIDE * error),
                    at(p.value + WIDE * error),
                    y + 6.0,
                ),
                FITTED,
                &of_row,
            );
        }
        Symbol::plain(0, AFTER).filled(figure, (at(p.value), y + 6.0), 3.2, &of_row);
    }
    let left = (rect.left - 10.0, y - 3.0);
    key(
        figure,
        left,
        NAMES - 14.0,
        &format!("class=\"row\" {of_row}"),
        &p.name,
    );
    let bounds = format!(
        "{} to {}{}",
        value(p.low, span),
        value(p.high, span),
        after(p)
    );
    figure.text(
        (left.0, y + 11.0),
        TEXT,
        Anchor::End,
        "",
        QUIET,
        &middle(&bounds, TEXT, NAMES - 14.0),
    );
    let right = rect.right + 10.0;
    figure.text(
        (right, y - 3.0),
        TEXT,
        Anchor::Start,
        "",
        INK,
        &middle(&found(p), TEXT, NUMBERS - 10.0),
    );
    figure.text(
        (right, y + 11.0),
        TEXT,
        Anchor::Start,
        "",
        QUIET,
        &middle(&remark(p), TEXT, NUMBERS - 10.0),
    );
}

/// A line with end marks.
fn span_of(figure: &mut Figure, (from, to, y): (f64, f64, f64), stroke: Stroke, attributes: &str) {
    let paint = format!("{} {attributes}", stroke.attributes());
    figure.line((from, y), (to, y), &paint);
}

/// The unit after a number.
fn after(p: &Parameter) -> String {
    match unit(&p.unit) {
        "-" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// "0.314 ± 0.021 Nm".
fn found(p: &Parameter) -> String {
    // Two digits of the error.
    let step = 10.0 * step(p);
    let error = p.standard_error.map_or_else(String::new, |error| {
        format!(" \u{b1} {}", cell(error, step))
    });
    format!("{}{error}{}", cell(p.value, step), after(p))
}

/// What has to be known of a parameter beside its value.
fn remark(p: &Parameter) -> String {
    match (p.is_dead, p.at_bound, p.standard_error, p.prior_share) {
        (true, ..) => "moves no observation".to_owned(),
        (_, Some(end), ..) => format!("at its {end} bound"),
        (.., None, _) => "the data do not tell it".to_owned(),
        (.., Some(share)) => format!("share of the prior {} %", cell(100.0 * share, 1.0)),
        _ => "no prior".to_owned(),
    }
}

fn describe(outcome: &Outcome) -> String {
    let told = |p: &Parameter| {
        format!(
            "{}: {}, {} to {}, {}",
            p.name,
            found(p),
            p.low,
            p.high,
            remark(p)
        )
    };
    format!(
        "Fitted parameters between their bounds. {}.",
        outcome
            .parameters
            .iter()
            .map(told)
            .collect::<Vec<_>>()
            .join("; ")
    )
}
