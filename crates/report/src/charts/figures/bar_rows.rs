//! Rows of horizontal bars with a label at the outer end of each.

use super::{MARGIN, TEXT, WIDTH};
use crate::charts::engine::{
    Axis, Chart, Label, Panel, Point, Style, at, row_middle, rows_panel, text_width,
};

/// Right edge of the bars, pixels.
const RIGHT: f64 = WIDTH - 18.0;
/// Height of a row, pixels.
const PITCH: f64 = 21.0;

/// An axis over values for bars from `left` on, with room for the longest of the labels at the outer ends of all bars, within reason.
pub(super) fn axis_with_room(
    title: &str,
    left: f64,
    values: impl Iterator<Item = f64>,
    labels: impl Iterator<Item = String>,
) -> Axis {
    let widths = labels.map(|label| text_width(&label, TEXT));
    let label = (widths.fold(0.0, f64::max) + 12.0).clamp(60.0, 270.0);
    let (mut low, mut high) = (0.0_f64, 0.0_f64);
    for value in values.filter(|x| x.is_finite()) {
        (low, high) = (low.min(value), high.max(value));
    }
    // A value next to zero needs room for its label like any other.
    let sides = if low < 0.0 { 2.0 } else { 1.0 };
    let span = (high - low) / (1.0 - sides * label / (RIGHT - left));
    let room = span * label / (RIGHT - left);
    let low = if low < 0.0 { low - room } else { 0.0 };
    Axis::exact(title, low, if span > 0.0 { high + room } else { 1.0 }, 7)
}

/// A panel of `count` rows with its upper left corner at a point.
pub(super) fn bars_panel(corner: Point, count: usize, x: Axis) -> Panel {
    rows_panel(corner, RIGHT, count, PITCH, x)
}

/// Heights above a panel and between two panels, pixels.
pub(super) type Gaps = (f64, f64);

/// Adds panels of bars below each other, with one horizontal axis; `draw` gets the number and the upper left corner of each.
pub(super) fn stacked(
    chart: Chart,
    (left, top): Point,
    (heading, gap): Gaps,
    count: usize,
    mut draw: impl FnMut(usize, Point) -> Panel,
) -> Chart {
    let mut top = top + heading;
    let panels = (0..count).map(|k| {
        let panel = draw(k, (left, top)).x_labels(k + 1 == count);
        top = panel.rect.bottom + gap + heading;
        panel
    });
    let panels: Vec<Panel> = panels.collect();
    chart.panels(panels)
}

/// A chart of bars with its title.
pub(super) fn bar_chart(title: &str, subject: String) -> Chart {
    Chart::new(title, subject, MARGIN)
}

/// Writes the name of a row.
pub(super) fn name(panel: &mut Panel, row: usize, text: &str, bold: bool) {
    panel.row_name(row, Label::new(at(0.0, 0.0), text).size(TEXT).bold(bold));
}

/// Adds a bar between two values; none if they are the same.
pub(super) fn bar(panel: &mut Panel, row: usize, (from, to): Point, style: Style) {
    if from < to || to < from {
        panel.bar(row, (from, to), (-7.0, 7.0), style);
    }
}

/// Writes a text at the outer end of a bar: right of a value, or left of a negative one.
pub(super) fn at_end(panel: &mut Panel, row: usize, value: f64, bold: bool, text: String) {
    let side = if value < 0.0 { -6.0 } else { 6.0 };
    let place = at(value, row_middle(row)).shift(side, 4.0);
    let label = Label::new(place, text).size(TEXT).bold(bold);
    panel.label(if value < 0.0 { label.end() } else { label });
}
