//! Parameters: prior and fitted value, between their bounds.

use super::{AFTER, BEFORE, MARGIN, RIGHT, TOP, WIDE_FOOT, subject, unit};
use crate::charts::engine::{
    Axis, Chart, Cut, Entry, INK, Label, Panel, RULE, Stroke, Style, Symbol, at, cell,
    optional_cell, round_step, row_middle, rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::charts::study::value;
use cvtcycle_calibrate::outcome::{Outcome, Parameter};

const ROW: f64 = 32.0;
/// Room for names on the left and for numbers on the right, pixels.
const NAMES: f64 = 290.0;
const NUMBERS: f64 = 172.0;
/// Extension of the axis beyond the bounds, as a share of their distance.
const BEYOND: f64 = 0.08;
/// Maximum number of rows that fit on a page.
const MAX_ROWS: usize = 50;
/// Length of error bars, standard deviations.
const WIDE: f64 = 2.0;
const PRIOR: Stroke = stroke(BEFORE, 3.2, &[]);
const FITTED: Stroke = stroke(AFTER, 2.2, &[]);
const BOUND: Stroke = stroke(INK, 1.2, &[5.0, 3.0]);

/// Draws a row for each parameter: prior above, fitted value below, both with two standard deviations, on an axis from bound to bound.
pub fn parameters_plot(outcome: &Outcome) -> Picture {
    let all = &outcome.parameters;
    let rows = &all[..all.len().min(MAX_ROWS)];
    let names = [
        "Parameter",
        "Unit",
        "Value of the files",
        "Fitted",
        "Standard error",
        "Low",
        "High",
        "Prior mean",
        "Prior sd",
    ];
    let mut table = PictureTable::new(&names.map(|name| (name, "")));
    table.columns.push(("Share of the prior".to_owned(), "%"));
    table.rows = all.iter().map(cells).collect();
    let mut notes = vec!["Share of the prior: variance after the fit over variance before; near 100 % the data say nothing.".to_owned()];
    if rows.len() < all.len() {
        notes.push(format!(
            "{} more parameters are in the table.",
            all.len() - rows.len()
        ));
    }
    table.note = notes.join(" ");
    let x = Axis::exact("Place between the bounds [-]", -BEYOND, 1.0 + BEYOND, 6);
    let corner = (MARGIN + NAMES, TOP);
    let mut panel = rows_panel(corner, RIGHT - NUMBERS, rows.len().max(2), ROW, x);
    for bound in [0.0, 1.0] {
        panel.upright(bound, BOUND);
    }
    for (k, p) in rows.iter().enumerate() {
        draw(&mut panel, k, p);
        describe_row(&mut panel, k, p);
    }
    let entries = vec![
        Entry::line(PRIOR, "Known before: mean and 2 sd"),
        Entry::line(FITTED, "Fitted, and 2 standard errors"),
        Entry::symbol(Symbol::CIRCLE, Symbol::open(INK), "Value of the files"),
        Entry::line(BOUND, "Bounds"),
    ];
    Chart::new(title(all), subject(outcome), MARGIN)
        .panels([panel])
        .legend(WIDE_FOOT, entries)
        .notes(WIDE_FOOT, notes)
        .picture(table)
}

/// Title: the parameter best determined by the data.
fn title(all: &[Parameter]) -> String {
    let known = all.iter().filter_map(|p| Some((p, p.prior_share?)));
    match known.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((p, share)) => format!(
            "The data say most of {}: {} % of the prior variance is left",
            p.name,
            cell(100.0 * share, 1.0)
        ),
        None => "Parameters between their bounds".to_owned(),
    }
}

/// Step that leaves three digits of a parameter's standard deviation.
fn step(p: &Parameter) -> f64 {
    let error = p.standard_error.filter(|x| *x > 0.0 && x.is_finite());
    round_step((error.unwrap_or(p.high - p.low) / 200.0).abs().max(1e-300))
}

fn cells(p: &Parameter) -> Vec<String> {
    let step = step(p);
    let number = |x: Option<f64>| optional_cell(x, step);
    let wide = round_step(((p.high - p.low) / 1000.0).abs().max(1e-300));
    let [low, high] = [p.low, p.high].map(|x| cell(x, wide));
    vec![
        p.name.clone(),
        unit(&p.unit).to_owned(),
        number(Some(p.file_value)),
        number(Some(p.value)),
        number(p.standard_error),
        low,
        high,
        number(p.prior.map(|prior| prior[0])),
        number(p.prior.map(|prior| prior[1])),
        optional_cell(p.prior_share.map(|share| 100.0 * share), 0.1),
    ]
}

/// Adds the marks of a parameter.
fn draw(panel: &mut Panel, row: usize, p: &Parameter) {
    let (span, ends) = (p.high - p.low, (panel.x.low, panel.x.high));
    let place = |x: f64, down: f64| {
        let share = ((x - p.low) / span).clamp(ends.0, ends.1);
        at(share, row_middle(row)).shift(0.0, down)
    };
    let known = |x: f64| x.is_finite() && span > 0.0;
    if row > 0 {
        panel.level(row as f64, RULE);
    }
    let style = |stroke: Stroke| Style::line(stroke).row(row);
    if let Some([mean, sd]) = p.prior.filter(|[mean, sd]| known(*mean) && sd.is_finite()) {
        let [low, high] = [mean - WIDE * sd, mean + WIDE * sd].map(|x| place(x, -6.0));
        panel.segment(low, high, style(PRIOR));
        panel.segment(place(mean, -11.0), place(mean, -1.0), style(PRIOR));
    }
    if known(p.file_value) {
        let style = Symbol::open(INK).row(row);
        panel.symbol(Symbol::CIRCLE, place(p.file_value, 6.0), 4.6, style);
    }
    if known(p.value) {
        if let Some(error) = p.standard_error.filter(|x| x.is_finite()) {
            let ends = [p.value - WIDE * error, p.value + WIDE * error];
            let [low, high] = ends.map(|x| place(x, 6.0));
            panel.segment(low, high, style(FITTED));
        }
        let style = Symbol::filled(AFTER).row(row);
        panel.symbol(Symbol::CIRCLE, place(p.value, 6.0), 3.2, style);
    }
}

/// Writes name and bounds of a parameter on the left, value and remark on the right.
fn describe_row(panel: &mut Panel, row: usize, p: &Parameter) {
    let span = p.high - p.low;
    let [low, high] = [p.low, p.high].map(|x| value(x, span));
    let bounds = format!("{low} to {high}{}", after(p));
    let left = |down: f64| at(f64::NEG_INFINITY, row_middle(row)).shift(-10.0, down);
    let right = |down: f64| at(f64::INFINITY, row_middle(row)).shift(10.0, down);
    let name = Label::new(left(-3.0), &p.name).end().class("row").row(row);
    panel.label(name.cut(Cut::Start, NAMES - 14.0));
    let bounds = Label::new(left(11.0), bounds).end().quiet();
    panel.label(bounds.cut(Cut::Middle, NAMES - 14.0));
    let room = NUMBERS - 10.0;
    panel.label(Label::new(right(-3.0), found(p)).cut(Cut::Middle, room));
    let remark = Label::new(right(11.0), remark(p)).quiet();
    panel.label(remark.cut(Cut::Middle, room));
}

/// Unit to follow a number.
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

/// Remark on the fit of a parameter.
fn remark(p: &Parameter) -> String {
    match (p.is_dead, p.at_bound, p.standard_error, p.prior_share) {
        (true, ..) => "moves no observation".to_owned(),
        (_, Some(end), ..) => format!("at its {end} bound"),
        (.., None, _) => "not determined by the data".to_owned(),
        (.., Some(share)) => format!("share of the prior {} %", cell(100.0 * share, 1.0)),
        _ => "no prior".to_owned(),
    }
}
