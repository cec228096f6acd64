//! Computed against measured fuel of many cars: a panel for each figure, a symbol for each group.

use super::engine::{
    Axis, BELOW, Chart, Entry, INK, Item, LEFT, PLOT_LEFT, Panel, Rect, Shape, Style, Symbol,
    WIDTH, at, grid, range, stroke,
};
use super::fleet_groups::{band, repeat_percent};
use super::picture::{Picture, PictureTable};
use cvtcycle_output::number::{fixed, signed};
use cvtcycle_output::table::distinct;

/// A car in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetMark {
    /// Name of the car.
    pub car: String,
    /// Group whose symbol it has.
    pub group: String,
    /// Figure, such as `FTP75`.
    pub figure: String,
    /// Measured fuel, L/100 km.
    pub measured: f64,
    /// Computed fuel, L/100 km.
    pub computed: f64,
}

const RIGHT: f64 = WIDTH - 24.0;
const TOP: f64 = 58.0;
const GAP: (f64, f64) = (18.0, 10.0);
const FOOT: (f64, f64) = (PLOT_LEFT, RIGHT - PLOT_LEFT);
const RADIUS: f64 = 3.4;
/// Error of the thin lines.
const THIN: f64 = 0.05;

/// Draws computed over measured fuel, with the line of equality, the band within which tests of equal cars repeat, and lines 5 % above and below.
#[must_use]
pub fn fleet_scatter(marks: &[FleetMark]) -> Picture {
    let figures = distinct(marks.iter().map(|mark| mark.figure.as_str()));
    let groups = distinct(marks.iter().map(|mark| mark.group.as_str()));
    let names = [
        ("Figure", ""),
        ("Car", ""),
        ("Group", ""),
        ("Measured", "L/100 km"),
        ("Computed", "L/100 km"),
        ("Error", "%"),
    ];
    let mut table = PictureTable::new(&names);
    let rows: Vec<(&FleetMark, usize)> = marks
        .iter()
        .map(|mark| {
            let error = 100.0 * (mark.computed / mark.measured - 1.0);
            let words = [mark.figure.clone(), mark.car.clone(), mark.group.clone()];
            let numbers = [
                fixed(mark.measured, 2),
                fixed(mark.computed, 2),
                signed(error, 1),
            ];
            (mark, table.push(words.into_iter().chain(numbers)))
        })
        .collect();
    let room = (RIGHT - 8.0 - 2.0 * LEFT - GAP.0) / 2.0;
    let size = if figures.len() > 1 {
        (room, room)
    } else {
        (460.0, 460.0)
    };
    let pitch = (LEFT + size.0 + GAP.0, size.1 + BELOW + GAP.1);
    let place = grid((PLOT_LEFT, TOP), size, pitch, 2);
    let panels = figures.iter().enumerate().map(|(k, figure)| {
        let own: Vec<(&FleetMark, usize)> = rows
            .iter()
            .filter(|(mark, _)| mark.figure == *figure)
            .copied()
            .collect();
        panel(place(k), figure, &own, &groups)
    });
    let entries = groups.iter().enumerate().map(|(k, name)| {
        let (symbol, colour) = Symbol::nth(k);
        Entry::symbol(symbol, Symbol::filled(colour), *name)
    });
    let note = "Thick line: computed = measured; band: tests of equal cars repeat within 2.8 % on FTP75 and 2.5 % on HWFET; dashed lines: 5 % more and less.";
    Chart::new(
        "Computed against measured fuel",
        rms(marks, &figures),
        PLOT_LEFT,
    )
    .panels(panels)
    .legend(FOOT, entries)
    .notes(FOOT, vec![note.to_owned()])
    .picture(table)
}

/// "FTP75: rms 5.4 % of 65 cars; HWFET: rms 4.5 % of 65 cars".
fn rms(marks: &[FleetMark], figures: &[&str]) -> String {
    let of = |figure: &&str| {
        let errors: Vec<f64> = marks
            .iter()
            .filter(|mark| mark.figure == **figure)
            .map(|mark| 100.0 * (mark.computed / mark.measured - 1.0))
            .collect();
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
        format!(
            "{figure}: rms {} % of {} cars",
            fixed(mean.sqrt(), 1),
            errors.len()
        )
    };
    figures.iter().map(of).collect::<Vec<_>>().join("; ")
}

fn panel(rect: Rect, figure: &str, rows: &[(&FleetMark, usize)], groups: &[&str]) -> Panel {
    let seen = rows
        .iter()
        .flat_map(|(mark, _)| [mark.measured, mark.computed]);
    let (low, high) = range(seen).unwrap_or((0.0, 1.0));
    let room = 0.05 * (high - low) + 1e-3;
    let axis = |what: &str| {
        Axis::exact(
            &format!("{what} {figure} [L/100 km]"),
            low - room,
            high + room,
            7,
        )
    };
    let mut panel = Panel::new(rect, axis("Measured"), axis("Computed"));
    let [from, to] = [low - room, high + room];
    let share = repeat_percent(figure) / 100.0;
    let corners = [
        (from, (1.0 - share) * from),
        (from, (1.0 + share) * from),
        (to, (1.0 + share) * to),
        (to, (1.0 - share) * to),
    ];
    let repeats = Item {
        shape: Shape::Area(vec![corners.to_vec()]),
        style: band(),
    };
    panel.add(Shape::Within(None, vec![repeats]), Style::default());
    for factor in [1.0 - THIN, 1.0 + THIN] {
        // Within the frame.
        let [left, right] = [from.max(from / factor), to.min(to / factor)];
        panel.segment(
            at(left, factor * left),
            at(right, factor * right),
            Style::line(stroke("#777777", 0.8, &[4.0, 3.0])),
        );
    }
    panel.segment(
        at(from, from),
        at(to, to),
        Style::line(stroke(INK, 1.6, &[])),
    );
    for (mark, row) in rows {
        let k = groups
            .iter()
            .position(|group| *group == mark.group)
            .unwrap_or(0);
        let (symbol, colour) = Symbol::nth(k);
        panel.symbol(
            symbol,
            at(mark.measured, mark.computed),
            RADIUS,
            Symbol::filled(colour).row(*row),
        );
    }
    panel
}
