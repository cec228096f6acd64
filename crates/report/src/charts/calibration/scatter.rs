//! Measured against computed: a panel for each unit, a mark for each observation.

use super::{
    BEFORE, FOOT, RIGHT, TOP, common_note, groups, in_sd, label, rms_in_words, rms_title, shown,
    subject, symbol, unit,
};
use crate::charts::engine::{
    Axis, BELOW, CONTEXT, Chart, Entry, LEFT, PLOT_LEFT, Panel, Rect, Style, Symbol, at, grid,
    range, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_calibrate::outcome::{Outcome, Residual};
use cvtcycle_output::table::distinct;

/// Maximum number of panels that fit on a page.
const MAX_PANELS: usize = 8;
const GAP: (f64, f64) = (18.0, 10.0);
const RADIUS: f64 = 3.4;

/// Draws computed over measured numbers, before (open) and after (filled), with standard deviations, ranges and the line of agreement.
pub fn scatter_plot(outcome: &Outcome) -> Picture {
    let (kept, thinned) = shown(outcome);
    let mut table = table();
    let rows = kept.iter().map(|k| &outcome.residuals[*k]);
    let rows: Vec<(&Residual, usize)> = rows.map(|r| (r, table.push(cells(r)))).collect();
    let mut units = distinct(rows.iter().map(|(r, _)| unit(&r.unit)));
    let mut notes = vec!["Bars: a standard deviation on either side, or the measured range. Thin line: computed = measured.".to_owned()];
    notes.extend(thinned);
    notes.extend(common_note(outcome));
    if units.len() > MAX_PANELS {
        let others = units[MAX_PANELS..].join(", ");
        notes.push(format!("In the table only: {others}."));
        units.truncate(MAX_PANELS);
    }
    table.note = notes.join(" ");
    let groups = groups(outcome);
    let entry = |name: &&str| {
        let (symbol, colour) = symbol(&groups, name);
        Entry::symbol(symbol, Symbol::filled(colour), *name)
    };
    let (style, name) = (Symbol::open(BEFORE), "open: with the files' values");
    let open = Entry::symbol(Symbol::CIRCLE, style, name);
    // A lone panel is larger.
    let room = (RIGHT - 8.0 - 2.0 * LEFT - GAP.0) / 2.0;
    let several = units.len() > 1;
    let size = if several {
        (room, room)
    } else {
        (460.0, 460.0)
    };
    let pitch = (LEFT + size.0 + GAP.0, size.1 + BELOW + GAP.1);
    let place = grid((PLOT_LEFT, TOP), size, pitch, 2);
    let panel = |(k, name): (usize, &&str)| {
        let own = rows.iter().filter(|(r, _)| unit(&r.unit) == *name);
        draw(place(k), name, &own.copied().collect::<Vec<_>>(), &groups)
    };
    let entries = groups.iter().map(entry).chain([open]);
    Chart::new(rms_title(outcome), subject(outcome), PLOT_LEFT)
        .lead(rms_in_words(outcome))
        .panels(units.iter().enumerate().map(panel))
        .legend(FOOT, entries)
        .notes(FOOT, notes)
        .picture(table)
}

fn table() -> PictureTable {
    let names = [
        "Group",
        "Observation",
        "Unit",
        "Measured, or from",
        "Measured, or to",
        "Standard deviation",
        "Files' values",
        "Fitted",
    ];
    PictureTable::new(&names.map(|name| (name, "")))
}

fn cells(r: &Residual) -> impl Iterator<Item = String> {
    let words = [r.group.clone(), label(r), unit(&r.unit).to_owned()];
    let numbers = [r.low, r.high, Some(r.sd), r.before, Some(r.after)];
    words.into_iter().chain(numbers.map(|x| in_sd(x, r)))
}

/// Position of an observation on the measured axis: the middle of a range, or its only end.
fn place(r: &Residual) -> Option<f64> {
    let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
    match (finite(r.low), finite(r.high)) {
        (Some(low), Some(high)) => Some(f64::midpoint(low, high)),
        (one, other) => one.or(other),
    }
}

/// Measured number with its uncertainty on the measured axis; `None` for an open end.
fn bar(r: &Residual) -> [Option<f64>; 2] {
    match (r.low, r.high) {
        (Some(low), Some(high)) if low.total_cmp(&high).is_eq() => {
            [Some(low - r.sd), Some(high + r.sd)]
        }
        (low, high) => [low, high].map(|x| x.filter(|x| x.is_finite())),
    }
}

fn draw(rect: Rect, name: &str, rows: &[(&Residual, usize)], groups: &[&str]) -> Panel {
    let seen = |r: &Residual| {
        let ends = bar(r).into_iter().flatten();
        let computed = [r.after].into_iter().chain(r.before);
        ends.chain(computed).collect::<Vec<f64>>()
    };
    let (low, high) = range(rows.iter().flat_map(|(r, _)| seen(r))).unwrap_or((0.0, 1.0));
    let span = high - low;
    let wide = span > 1e-9 * high.abs();
    let lone = 0.1 * high.abs() + 1e-3;
    let room = if wide { 0.05 * span } else { lone };
    let axis = |what: &str| Axis::exact(&format!("{what} [{name}]"), low - room, high + room, 7);
    let mut panel = Panel::new(rect, axis("Measured"), axis("Computed"));
    let [low, high] = [f64::NEG_INFINITY, f64::INFINITY].map(|x| at(x, x));
    panel.segment(low, high, Style::line(CONTEXT));
    for (r, row) in rows {
        let (Some(x), (symbol, colour)) = (place(r), symbol(groups, &r.group)) else {
            continue;
        };
        let before = at(x, r.before.unwrap_or(f64::NAN));
        panel.symbol(symbol, before, RADIUS, Symbol::open(colour).row(*row));
        // An open end extends to the edge.
        let [from, to] = bar(r);
        let from = at(from.unwrap_or(f64::NEG_INFINITY), r.after);
        let to = at(to.unwrap_or(f64::INFINITY), r.after);
        let style = Style::line(stroke(colour, 0.75, &[])).stroke_opacity(0.6);
        panel.segment(from, to, style.row(*row));
        let style = Symbol::filled(colour).row(*row);
        panel.symbol(symbol, at(x, r.after), RADIUS, style);
    }
    panel
}
