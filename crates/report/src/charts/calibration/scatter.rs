//! Measured against computed: a panel for each unit, a mark for each observation.

use super::{
    BEFORE, FOOT, RIGHT, TOP, common_note, groups, in_sd, label, measured_cells, shown, subject,
    symbol, unit,
};
use crate::charts::engine::{
    Axis, BELOW, Block, CONTEXT, Chart, Entry, LEFT, PLOT_LEFT, Panel, Rect, Shape, Style, Symbol,
    at, grid, range, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_study::fit::outcome::{Outcome, Residual};

/// Most panels: more do not fit on a page.
const MAX_PANELS: usize = 8;
const GAP: (f64, f64) = (18.0, 10.0);
const RADIUS: f64 = 3.4;

/// Draws computed over measured numbers, before (open) and after (filled), with standard deviations, ranges and the line of agreement.
#[must_use]
pub fn scatter_plot(outcome: &Outcome) -> Picture {
    let (kept, thinned) = shown(outcome);
    let mut table = table();
    let rows = kept.iter().map(|k| &outcome.residuals[*k]);
    let rows: Vec<(&Residual, usize)> = rows.map(|r| (r, table.push(cells(r)))).collect();
    let mut units: Vec<&str> = Vec::new();
    for (r, _) in &rows {
        if !units.contains(&unit(&r.unit)) {
            units.push(unit(&r.unit));
        }
    }
    let mut notes = vec!["Bars: a standard deviation on either side, or the measured range. Thin line: computed = measured.".to_owned()];
    notes.extend(thinned);
    notes.extend(common_note(outcome));
    if units.len() > MAX_PANELS {
        notes.push(format!(
            "In the table only: {}.",
            units[MAX_PANELS..].join(", ")
        ));
        units.truncate(MAX_PANELS);
    }
    table.note = notes.join(" ");
    let groups = groups(outcome);
    let entry = |name: &&str| {
        let (symbol, colour) = symbol(&groups, name);
        Entry::symbol(symbol, Symbol::filled(colour), *name)
    };
    let open = Entry::symbol(
        Symbol::CIRCLE,
        Symbol::open(BEFORE),
        "open: with the files' values",
    );
    // A lone panel is larger.
    let room = (RIGHT - 8.0 - 2.0 * LEFT - GAP.0) / 2.0;
    let size = if units.len() > 1 {
        (room, 290.0)
    } else {
        (560.0, 440.0)
    };
    let pitch = (LEFT + size.0 + GAP.0, size.1 + BELOW + GAP.1);
    let place = grid((PLOT_LEFT, TOP), size, pitch, 2);
    let panel = |(k, name): (usize, &&str)| {
        let own = rows.iter().filter(|(r, _)| unit(&r.unit) == *name);
        draw(place(k), name, &own.copied().collect::<Vec<_>>(), &groups)
    };
    let chart = Chart {
        title: "Measured and computed".to_owned(),
        subject: subject(outcome),
        description: describe(outcome, &units),
        left: PLOT_LEFT,
        panels: units.iter().enumerate().map(panel).collect(),
        foot: vec![
            Block::legend(FOOT, "", groups.iter().map(entry).chain([open]).collect()),
            Block::notes(FOOT, notes),
        ],
        table,
        ..Chart::default()
    };
    chart.picture()
}

fn table() -> PictureTable {
    PictureTable::new(&[
        ("Group", ""),
        ("Observation", ""),
        ("Unit", ""),
        ("Measured, or from", ""),
        ("Measured, or to", ""),
        ("Standard deviation", ""),
        ("Files' values", ""),
        ("Fitted", ""),
    ])
}

fn cells(r: &Residual) -> Vec<String> {
    let [low, high] = measured_cells(r);
    let computed = [
        in_sd(Some(r.sd), r),
        in_sd(r.before, r),
        in_sd(Some(r.after), r),
    ];
    [
        r.group.clone(),
        label(r),
        unit(&r.unit).to_owned(),
        low,
        high,
    ]
    .into_iter()
    .chain(computed)
    .collect()
}

/// Place of the mark of an observation on the measured axis: in the middle of a range, or at the end that there is.
fn place(r: &Residual) -> Option<f64> {
    let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
    match (finite(r.low), finite(r.high)) {
        (Some(low), Some(high)) => Some(f64::midpoint(low, high)),
        (one, other) => one.or(other),
    }
}

/// What was measured, and what may have been, on the measured axis; an open end is none.
fn bar(r: &Residual) -> [Option<f64>; 2] {
    match (r.low, r.high) {
        (Some(low), Some(high)) if low.total_cmp(&high).is_eq() => {
            [Some(low - r.sd), Some(high + r.sd)]
        }
        (low, high) => [
            low.filter(|x| x.is_finite()),
            high.filter(|x| x.is_finite()),
        ],
    }
}

fn draw(rect: Rect, name: &str, rows: &[(&Residual, usize)], groups: &[&str]) -> Panel {
    let seen = |r: &Residual| {
        let computed = [r.after].into_iter().chain(r.before);
        bar(r)
            .into_iter()
            .flatten()
            .chain(computed)
            .collect::<Vec<f64>>()
    };
    let (low, high) = range(rows.iter().flat_map(|(r, _)| seen(r))).unwrap_or((0.0, 1.0));
    let span = high - low;
    let wide = span > 1e-9 * high.abs();
    let room = if wide {
        0.05 * span
    } else {
        0.1 * high.abs() + 1e-3
    };
    let axis = |what: &str| Axis::exact(&format!("{what} [{name}]"), low - room, high + room, 7);
    let mut panel = Panel::new(rect, axis("Measured"), axis("Computed"));
    let corners = (
        at(f64::NEG_INFINITY, f64::NEG_INFINITY),
        at(f64::INFINITY, f64::INFINITY),
    );
    panel.add(Shape::Segment(corners.0, corners.1), Style::line(CONTEXT));
    for (r, row) in rows {
        let (Some(x), (symbol, colour)) = (place(r), symbol(groups, &r.group)) else {
            continue;
        };
        let before = at(x, r.before.unwrap_or(f64::NAN));
        panel.symbol(symbol, before, RADIUS, Symbol::open(colour).row(*row));
        // An open end goes on to the edge.
        let [from, to] = bar(r);
        let from = at(from.unwrap_or(f64::NEG_INFINITY), r.after);
        let to = at(to.unwrap_or(f64::INFINITY), r.after);
        let style = Style::line(stroke(colour, 0.75, &[])).stroke_opacity(0.6);
        panel.add(Shape::Segment(from, to), style.row(*row));
        panel.symbol(
            symbol,
            at(x, r.after),
            RADIUS,
            Symbol::filled(colour).row(*row),
        );
    }
    panel
}

fn describe(outcome: &Outcome, units: &[&str]) -> String {
    let [before, after, _] = outcome
        .rms_sd()
        .map(|x| x.map_or_else(|| "unknown".to_owned(), |x| format!("{x:.2}")));
    format!(
        "Computed over measured numbers, a panel for each of the units {}. Root mean square of the residuals {before} standard deviations with the files' values, {after} fitted.",
        units.join(", ")
    )
}
