//! Tornado: effect of each factor on an output when it alone is changed from its base.

use super::{MARGIN, MAX_ROWS, RIGHT, ROW, Shown, WIDE_FOOT, value};
use crate::charts::engine::{
    Axis, Chart, Cut, Entry, Fill, INK, Label, Panel, Style, Symbol, at, cell, range, round_step,
    row_middle, rows_left, rows_panel, stroke, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital_first, signed};
use cvtcycle_study::statistics::{Tornado, TornadoBar, TornadoEnd};

/// Size of the values at the ends of bars, and their maximum width, pixels.
const END: (f64, f64) = (11.0, 120.0);

/// Mark of a level between the ends.
const BETWEEN: Symbol = Symbol::CIRCLE;

/// Draws the tornado: change of the output against the base, with the factor's values at the ends of its bar.
pub fn tornado_plot(shown: &Shown, tornado: &Tornado) -> Picture {
    let all = &tornado.bars;
    let many = all.len() > MAX_ROWS + 1;
    let count = if many { MAX_ROWS } else { all.len() };
    let bars = &all[..count];
    let effects = bars.iter().flat_map(ends).map(|end| end.effect);
    let (low, high) = range(effects.chain([0.0])).unwrap_or((0.0, 1.0));
    let left = rows_left(bars.iter().map(|bar| bar.name.as_str()), 11.0);
    let x = axis(shown, bars, (low, high), RIGHT - left);
    let dots = bars.iter().any(|bar| bar.between().next().is_some());
    let panel = rows_panel((left, 58.0), RIGHT, bars.len().max(2), ROW, x);
    let mut panel = panel.no_data(bars.is_empty());
    for (k, bar) in bars.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), &bar.name).class("row").row(k));
        draw(&mut panel, k, bar);
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let names = ["Low or first value", "High or second value"];
    let entry = |(k, name): (usize, &str)| Entry::fill(Fill::nth(k, 2), name);
    let dots = dots.then(|| Entry::symbol(BETWEEN, Style::colour(INK), "Levels between"));
    let widest = bars
        .iter()
        .find_map(|bar| Some((bar, bar.low.as_ref()?, bar.high.as_ref()?)));
    let title = match widest {
        Some((bar, a, b)) => {
            let (least, most) = (a.effect.min(b.effect), a.effect.max(b.effect));
            let digits = |x: f64| signed(value(x, high - low), x);
            format!(
                "{} moves the {} most: {} to {}{}",
                capital_first(&bar.name),
                shown.output,
                digits(least),
                digits(most),
                shown.after()
            )
        }
        None => format!("One factor at a time: {}", shown.output),
    };
    Chart::new(title, shown.subject, MARGIN)
        .panels([panel])
        .legend(
            WIDE_FOOT,
            names.into_iter().enumerate().map(entry).chain(dots),
        )
        .notes(WIDE_FOOT, notes(shown, tornado, bars, high - low))
        .picture(table(shown, tornado, high - low))
}

fn notes(shown: &Shown, tornado: &Tornado, bars: &[TornadoBar], spread: f64) -> Vec<String> {
    let all = &tornado.bars;
    let base = value(tornado.base, spread);
    let mut notes = vec![
        format!("Base: {base}{}", shown.after()),
        "At the ends of the bars: values of the factor. Of more than two, those with the least and the largest output.".to_owned(),
    ];
    let missing: usize = all.iter().map(|bar| bar.missing).sum();
    if missing > 0 {
        let values: usize = all.iter().map(|bar| bar.entries.len()).sum();
        notes.push(format!(
            "Left out without an output: {missing} of {values} values."
        ));
    }
    if bars.len() < all.len() {
        let more = all.len() - bars.len();
        notes.push(format!(
            "{more} more factors with narrower bars are in the table."
        ));
    }
    notes
}

/// Adds the ends of a factor, with their values next to them.
fn draw(panel: &mut Panel, row: usize, bar: &TornadoBar) {
    let apart = match (&bar.low, &bar.high) {
        (Some(a), Some(b)) => a.effect * b.effect > 0.0,
        _ => false,
    };
    // Ends on one side of the base would hide each other: each gets half of the row.
    let halves = [(-12.0, 0.0), (0.0, 12.0)];
    let places = if apart { halves } else { [(-8.0, 8.0); 2] };
    let both = || [&bar.low, &bar.high].into_iter().zip(places).enumerate();
    for (k, (end, place)) in both() {
        if let Some(end) = end {
            let style = Style::edged(Fill::nth(k, 2), 0.5).row(row);
            panel.bar(row, (0.0, end.effect), place, style);
        }
    }
    for level in bar.between() {
        let style = Style::colour(INK).class("mark").row(row);
        panel.symbol(BETWEEN, at(level.effect, row_middle(row)), 3.0, style);
    }
    for (k, (end, place)) in both() {
        let Some(end) = end else { continue };
        let down = 0.5 * (place.0 + place.1) + 4.0;
        let place = at(end.effect, row_middle(row));
        let label = |dx: f64| Label::new(place.shift(dx, down), &end.label);
        let left = leftward(bar, k == 0);
        let label = if left { label(-4.0).end() } else { label(4.0) };
        panel.label(label.class("end").cut(Cut::Middle, END.1));
    }
}

/// Table of the effects of all factors.
fn table(shown: &Shown, tornado: &Tornado, spread: f64) -> PictureTable {
    let columns = [
        ("Factor".to_owned(), ""),
        ("Low or first value".to_owned(), ""),
        shown.column("Change at it"),
        ("High or second value".to_owned(), ""),
        shown.column("Change at that"),
    ];
    let between = tornado
        .bars
        .iter()
        .any(|bar| bar.between().next().is_some());
    let levels = between.then(|| ("Changes at levels between".to_owned(), ""));
    let columns = columns.into_iter().chain(levels);
    let columns = columns.chain([shown.column("Swing")]);
    let note = format!(
        "Changes are against the base of {}{}.",
        value(tornado.base, spread),
        shown.after().replace('\u{a0}', " ")
    );
    let mut table = PictureTable::with_columns(columns).note(note);
    let step = round_step(if spread > 0.0 { spread / 500.0 } else { 1e-3 });
    for bar in &tornado.bars {
        let end = |end: &Option<TornadoEnd>| {
            let cells = end
                .as_ref()
                .map(|e| [e.label.clone(), cell(e.effect, step)]);
            cells.unwrap_or_default()
        };
        let ends = [end(&bar.low), end(&bar.high)].concat();
        let levels = bar
            .between()
            .map(|e| format!("{}: {}", e.label, cell(e.effect, step)));
        let levels = between.then(|| levels.collect::<Vec<_>>().join("; "));
        let cells = [bar.name.clone()].into_iter().chain(ends).chain(levels);
        table.push(cells.chain([cell(bar.swing, step)]));
    }
    table
}

fn ends(bar: &TornadoBar) -> impl Iterator<Item = &TornadoEnd> {
    bar.low.iter().chain(&bar.high)
}

/// True if the label of an end lies to its left: an end without an effect leaves room for the other one.
fn leftward(bar: &TornadoBar, first: bool) -> bool {
    let effect = |end: &Option<TornadoEnd>| end.as_ref().map_or(0.0, |end| end.effect);
    let (low, high) = (effect(&bar.low), effect(&bar.high));
    let (own, other) = if first { (low, high) } else { (high, low) };
    if own.abs() > 0.0 {
        own < 0.0
    } else if other.abs() > 0.0 {
        other > 0.0
    } else {
        first
    }
}

/// An axis with room for the labels at both ends in a plot of a width in pixels.
fn axis(shown: &Shown, bars: &[TornadoBar], (low, high): (f64, f64), wide: f64) -> Axis {
    let title = shown.axis("Change against the base");
    let room = |left: bool| {
        let sides = bars.iter().flat_map(|bar| {
            [(true, &bar.low), (false, &bar.high)].map(|(first, end)| (leftward(bar, first), end))
        });
        let own = sides.filter_map(|(side, end)| end.as_ref().filter(|_| side == left));
        let widths = own.map(|end| text_width(&end.label, END.0));
        widths.fold(0.0, f64::max).min(END.1) + 10.0
    };
    let (before, after) = (room(true), room(false));
    let span = if high > low { high - low } else { 1.0 };
    let pixel = span / (wide - before - after);
    Axis::exact(&title, low - before * pixel, high + after * pixel, 7)
}
