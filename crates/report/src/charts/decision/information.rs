//! Spread that remains when one value is known: the basis of the next test.

use super::{MARGIN, TOP, says};
use crate::charts::engine::{
    Axis, Chart, Fill, INK, Label, Style, WIDTH, at, cell, optional_cell, row_middle, rows_left,
    rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::grouped;
use cvtcycle_study::answer::Information;

/// Right edge of the plot, height of a row, pixels; maximum number of factors.
const RIGHT: f64 = WIDTH - 40.0;
const ROW: f64 = 24.0;
const MAX_FACTORS: usize = 5;

/// Bars of the standard deviation as it is and with each of the first factors known, with intervals. `subject` names the output and the study.
pub fn information(data: &Information, unit: &'static str, subject: &str) -> Picture {
    let shown = data.factors.iter().take(MAX_FACTORS);
    let names = shown.clone().map(|factor| format!("{} known", factor.name));
    let names: Vec<String> = ["as it is".to_owned()].into_iter().chain(names).collect();
    let x = Axis::round(
        &format!("Standard deviation [{unit}]"),
        [0.0, 1.12 * data.sd].into_iter(),
        6,
    );
    let left = rows_left(names.iter().map(String::as_str), 11.0);
    let mut panel = rows_panel((left, TOP), RIGHT, names.len(), ROW, x);
    let columns = [
        ("Known", ""),
        ("Deviation left", unit),
        ("from", unit),
        ("to", unit),
        ("Share of the variance", "%"),
    ];
    let mut table = PictureTable::new(&columns);
    let first = [
        names[0].clone(),
        cell(data.sd, 0.01),
        String::new(),
        String::new(),
        String::new(),
    ];
    table.push(first);
    for (k, name) in names.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), name).class("row").row(k));
    }
    let bar = |cause: bool, k: usize| {
        Style::edged(
            if cause {
                Fill::car(0)
            } else {
                Fill::plain("#c9c9c9")
            },
            0.5,
        )
        .row(k)
    };
    panel.bar(0, (0.0, data.sd), (-8.0, 8.0), bar(false, 0));
    let words = |panel: &mut crate::charts::engine::Panel, k: usize, x: f64, right: f64| {
        let place = at(right.max(x), row_middle(k)).shift(6.0, 4.0);
        panel.label(Label::new(place, grouped(x, 1)).size(11.0));
    };
    words(&mut panel, 0, data.sd, data.sd);
    for (k, factor) in shown.enumerate() {
        let (row, left) = (k + 1, factor.sd_left);
        panel.bar(
            row,
            (0.0, left.value),
            (-8.0, 8.0),
            bar(factor.above_chance, row),
        );
        if let Some(interval) = left.interval {
            panel.whisker(row, interval, 0.0, row);
        }
        words(
            &mut panel,
            row,
            left.value,
            left.interval.map_or(left.value, |ends| ends[1]),
        );
        let ends = [0, 1].map(|k| optional_cell(left.interval.map(|data| data[k]), 0.01));
        let [from, to] = ends;
        let share = cell(100.0 * factor.share.value.clamp(0.0, 1.0), 1.0);
        table.push([names[row].clone(), cell(left.value, 0.01), from, to, share]);
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let best = data.causes().next();
    let best = best.map(|factor| (factor.name.as_str(), data.sd, factor.sd_left.value));
    let note = format!(
        "Grey: not above chance. Whiskers: intervals from {} runs.",
        data.n
    );
    Chart::new(says::information(best, unit), subject, MARGIN)
        .panels([panel])
        .notes((MARGIN, WIDTH - 2.0 * MARGIN), vec![note])
        .picture(table)
}
