//! Rows of horizontal bars: names at the left, a value axis below.
use super::{TEXT, WIDTH};
use crate::charts::axis::Axis;
use crate::charts::figure::{Anchor, Figure, INK, Rect, fit, text_width};
use crate::charts::panel::Panel;

/// Right edge of the bars, pixels.
pub(super) const RIGHT: f64 = WIDTH - 18.0;
/// Height of a row, pixels.
pub(super) const PITCH: f64 = 21.0;
/// Height of a bar, pixels.
const BAR: f64 = 14.0;

/// Left edge of bars whose names stand before it: as far right as the longest name needs, within reason, pixels.
pub(super) fn left_for<'a>(names: impl Iterator<Item = &'a str>) -> f64 {
    let widest = names.map(|name| text_width(name, TEXT)).fold(0.0, f64::max);
    (widest + 24.0).clamp(120.0, 300.0)
}

/// Room that the longest of the labels at the ends of bars needs, within reason, pixels.
pub(super) fn label_room(labels: impl Iterator<Item = String>) -> f64 {
    (labels
        .map(|label| text_width(&label, TEXT))
        .fold(0.0, f64::max)
        + 12.0)
        .clamp(60.0, 270.0)
}

/// An axis over values for bars from `left` on, with room for a label of `label` pixels at the outer end of every bar.
pub(super) fn axis_with_room(
    title: &str,
    left: f64,
    values: impl Iterator<Item = f64>,
    label: f64,
) -> Axis {
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for value in values.filter(|x| x.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
    }
    // A value next to zero needs room for its label like any other.
    let sides = if low < 0.0 { 2.0 } else { 1.0 };
    let span = (high - low) / (1.0 - sides * label / (RIGHT - left));
    let room = span * label / (RIGHT - left);
    Axis::exact(
        title,
        if low < 0.0 { low - room } else { 0.0 },
        if span > 0.0 { high + room } else { 1.0 },
        7,
    )
}

/// A panel of `count` rows with its upper left corner at `at`.
pub(super) fn rows_panel(
    figure: &mut Figure,
    at: (f64, f64),
    count: usize,
    x: Axis,
    with_x: bool,
) -> Panel {
    let rect = Rect {
        left: at.0,
        right: RIGHT,
        top: at.1,
        bottom: at.1 + tall(count),
    };
    let mut y = Axis::exact("", 0.0, count.max(1) as f64, 5);
    // Rows have names in place of numbers.
    y.ticks.clear();
    Panel::draw(figure, rect, x, y, with_x)
}

/// Height of a panel of rows, pixels.
pub(super) fn tall(count: usize) -> f64 {
    PITCH * count.max(1) as f64 + 4.0
}

/// Middle of a row, pixels.
fn middle(panel: &Panel, row: usize) -> f64 {
    panel.rect.top + 2.0 + PITCH * (row as f64 + 0.5)
}

/// The name of a row.
pub(super) fn name(figure: &mut Figure, panel: &Panel, row: usize, text: &str, bold: bool) {
    let weight = if bold { "font-weight=\"bold\"" } else { "" };
    let text = fit(text, TEXT, panel.rect.left - 20.0);
    figure.text(
        (panel.rect.left - 8.0, middle(panel, row) + 4.0),
        TEXT,
        Anchor::End,
        weight,
        INK,
        &text,
    );
}

/// A bar between two values, with the row of the table in which it stands.
pub(super) fn bar(
    figure: &mut Figure,
    panel: &Panel,
    row: usize,
    (from, to): (f64, f64),
    paint: &str,
    table_row: usize,
) {
    let (a, b) = (panel.px(from.min(to)), panel.px(from.max(to)));
    if b <= a {
        return;
    }
    let y = middle(panel, row);
    let rect = Rect {
        left: a,
        right: b,
        top: y - 0.5 * BAR,
        bottom: y + 0.5 * BAR,
    };
    figure.rect(rect, &format!("class=\"bar\" data-row=\"{table_row}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"2\""));
}

/// Text at the outer end of a bar: right of a value, or left of it.
pub(super) fn at_end(
    figure: &mut Figure,
    panel: &Panel,
    row: usize,
    value: f64,
    bold: bool,
    text: &str,
) {
    let weight = if bold { "font-weight=\"bold\"" } else { "" };
    let y = middle(panel, row) + 4.0;
    if value < 0.0 {
        figure.text(
            (panel.px(value) - 6.0, y),
            TEXT,
            Anchor::End,
            weight,
            INK,
            text,
        );
    } else {
        figure.text(
            (panel.px(value) + 6.0, y),
            TEXT,
            Anchor::Start,
            weight,
            INK,
            text,
        );
    }
}
