//! Tornado: what each factor does to an output when it alone leaves its base.

use super::super::axis::{Axis, range, round_step};
use super::super::figure::text_width;
use super::super::legend::Mark;
use super::super::picture::{Picture, PictureTable, cell};
use super::super::style::fill;
use super::Shown;
use super::rows::{Frame, MOST_ROWS, Rows, width_of};
use super::text::{Side, name, value};
use cvtcycle_study::statistics::{Tornado, TornadoBar, TornadoEnd};

/// A tornado and what it is of.
#[derive(Clone, Copy, Debug)]
pub struct TornadoPlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// The bars.
    pub tornado: &'a Tornado,
}

/// Size of the values at the ends of bars, pixels.
const END: f64 = 11.0;
/// Widest such value, pixels.
const END_WIDTH: f64 = 120.0;

/// Draws the tornado: change of the output against the base, with the factor's values at the ends of its bar.
#[must_use]
pub fn tornado_plot(plot: &TornadoPlot) -> Picture {
    let all = &plot.tornado.bars;
    let bars = &all[..if all.len() > MOST_ROWS + 1 {
        MOST_ROWS
    } else {
        all.len()
    }];
    let effects = || bars.iter().flat_map(ends).map(|end| end.effect);
    let (low, high) = range(effects().chain([0.0])).unwrap_or((0.0, 1.0));
    let missing: usize = all.iter().map(|bar| bar.missing).sum();
    let mut notes = vec![format!(
        "Base: {}{}",
        value(plot.tornado.base, high - low),
        plot.shown.after()
    )];
    notes.push("At the ends of the bars: values of the factor. Of more than two, those with the least and the largest output.".to_owned());
    if missing > 0 {
        notes.push(format!(
            "Left out without an output: {missing} of {} values.",
            all.iter().map(|bar| bar.values).sum::<usize>()
        ));
    }
    if bars.len() < all.len() {
        notes.push(format!(
            "{} more factors with narrower bars are in the table.",
            all.len() - bars.len()
        ));
    }
    let frame = Frame {
        title: format!("One factor at a time: {}", plot.shown.output),
        subject: plot.shown.subject,
        desc: describe(plot, high - low),
        x: axis(&plot.shown, bars, (low, high)),
        names: bars.iter().map(|bar| bar.name.as_str()).collect(),
        entries: ["Low or first value", "High or second value"],
        notes,
    };
    let mut paints = Vec::new();
    let mut picture = Rows::new(frame, |figure| {
        paints = (0..2).map(|k| fill(figure, "end", k, 2)).collect();
        paints.iter().cloned().map(Mark::Fill).collect()
    });
    for (k, bar) in bars.iter().enumerate() {
        draw(&mut picture, k, bar, &paints);
    }
    picture.mark(0.0);
    picture.finish(table(plot, high - low))
}

/// Draws the ends of a factor, with their values beside them.
fn draw(picture: &mut Rows, row: usize, bar: &TornadoBar, paints: &[String]) {
    let middle = picture.middle(row);
    let apart = match (&bar.low, &bar.high) {
        (Some(a), Some(b)) => a.effect * b.effect > 0.0,
        _ => false,
    };
    // Ends on one side of the base would hide each other: then each has half of the row.
    let places = if apart {
        [(middle - 12.0, middle), (middle, middle + 12.0)]
    } else {
        [(middle - 8.0, middle + 8.0); 2]
    };
    for ((end, paint), place) in [&bar.low, &bar.high].into_iter().zip(paints).zip(places) {
        if let Some(end) = end {
            picture.bar(row, (0.0, end.effect), place, paint);
        }
    }
    for (first, (end, place)) in [true, false]
        .into_iter()
        .zip([&bar.low, &bar.high].into_iter().zip(places))
    {
        if let Some(end) = end {
            label(
                picture,
                end,
                leftward(bar, first),
                0.5 * (place.0 + place.1) + 4.0,
            );
        }
    }
}

/// What the factors do, all of them.
fn table(plot: &TornadoPlot, spread: f64) -> PictureTable {
    let columns = [
        "Factor",
        "Low or first value",
        "Change at it",
        "High or second value",
        "Change at that",
        "Swing",
    ];
    let in_unit = |name: &str| {
        if name.starts_with("Change") || name == "Swing" {
            plot.shown.column(name)
        } else {
            (name.to_owned(), "")
        }
    };
    let mut table = PictureTable {
        columns: columns.map(in_unit).into(),
        ..PictureTable::default()
    };
    let step = round_step(if spread > 0.0 { spread / 500.0 } else { 1e-3 });
    for bar in &plot.tornado.bars {
        let end = |end: &Option<TornadoEnd>| {
            end.as_ref().map_or_else(Default::default, |e| {
                [e.label.clone(), cell(e.effect, step)]
            })
        };
        let mut cells = vec![bar.name.clone()];
        cells.extend(end(&bar.low));
        cells.extend(end(&bar.high));
        cells.push(cell(bar.swing, step));
        table.push(cells);
    }
    table.note = format!(
        "Changes are against the base of {}{}.",
        value(plot.tornado.base, spread),
        plot.shown.after().replace('\u{a0}', " ")
    );
    table
}

fn ends(bar: &TornadoBar) -> impl Iterator<Item = &TornadoEnd> {
    bar.low.iter().chain(&bar.high)
}

/// On which side the label of an end stands: an end without an effect gives way to the other one.
fn leftward(bar: &TornadoBar, first: bool) -> bool {
    let (own, other) = if first {
        (&bar.low, &bar.high)
    } else {
        (&bar.high, &bar.low)
    };
    let effect = own.as_ref().map_or(0.0, |end| end.effect);
    let other = other.as_ref().map_or(0.0, |end| end.effect);
    if effect.abs() > 0.0 {
        effect < 0.0
    } else if other.abs() > 0.0 {
        other > 0.0
    } else {
        first
    }
}

fn label(picture: &mut Rows, end: &TornadoEnd, left: bool, y: f64) {
    let x = picture.panel.px(end.effect);
    let (x, side) = if left {
        (x - 4.0, Side::Left)
    } else {
        (x + 4.0, Side::Right)
    };
    name(
        &mut picture.figure,
        (x, y),
        side,
        (END, END_WIDTH),
        "class=\"end\"",
        &end.label,
    );
}

/// An axis with room for the labels at both ends.
fn axis(shown: &Shown, bars: &[TornadoBar], (low, high): (f64, f64)) -> Axis {
    let title = shown.axis("Change against the base");
    let room = |left: bool| {
        let labels = bars.iter().flat_map(|bar| {
            [(true, &bar.low), (false, &bar.high)].map(|(first, end)| (leftward(bar, first), end))
        });
        let widths = labels
            .filter(|(side, _)| *side == left)
            .filter_map(|(_, end)| end.as_ref())
            .map(|end| text_width(&end.label, END));
        widths.fold(0.0, f64::max).min(END_WIDTH) + 10.0
    };
    let (before, after) = (room(true), room(false));
    let span = if high > low { high - low } else { 1.0 };
    let pixel = span / (width_of(bars.iter().map(|bar| bar.name.as_str())) - before - after);
    Axis::exact(&title, low - before * pixel, high + after * pixel, 7)
}

fn describe(plot: &TornadoPlot, spread: f64) -> String {
    let unit = plot.shown.after().replace('\u{a0}', " ");
    let end = |end: &TornadoEnd| format!("{} at {}", value(end.effect, spread), end.label);
    let bar = |bar: &TornadoBar| {
        format!(
            "{}: {}",
            bar.name,
            ends(bar).map(end).collect::<Vec<_>>().join(", ")
        )
    };
    let told: Vec<String> = plot.tornado.bars.iter().map(bar).collect();
    format!(
        "Change of {} against the base of {}{unit} by factor, the widest first. {}.",
        plot.shown.output,
        value(plot.tornado.base, spread),
        told.join("; ")
    )
}
