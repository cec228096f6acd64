//! Names of lines at their right ends, moved apart to avoid overlaps.

use super::panel::Panel;
use super::place::{End, Label, at};
use super::text::{Cut, text_width};

/// Minimum distance of two names, pixels.
const APART: f64 = 14.0;
/// Maximum width of a name over cells, pixels.
pub(crate) const ON_CELLS: f64 = 180.0;
/// Size of a name, pixels.
const TEXT: f64 = 11.0;
/// Distance from the frame within which names are written beyond it, pixels.
const NEAR: f64 = 30.0;

/// Writes the names of lines of a panel to the right of their ends, the highest end on top, in the colours of the lines.
pub(super) fn labels(panel: &Panel) -> Vec<Label> {
    let mut ends = panel.ends.clone();
    ends.retain(|end| end.at.0.is_finite() && end.at.1.is_finite());
    ends.sort_by(|a, b| b.at.1.total_cmp(&a.at.1));
    let lowest = panel.rect.bottom + 8.0;
    let (count, mut free) = (ends.len(), f64::NEG_INFINITY);
    let label = |(k, end): (usize, End)| {
        // A line may leave the panel.
        let own = panel.py(end.at.1).clamp(panel.rect.top, panel.rect.bottom) + 4.0;
        let x = panel.px(end.at.0).clamp(panel.rect.left, panel.rect.right);
        let room = lowest - APART * (count - 1 - k) as f64;
        let y = own.max(free).min(room.max(free));
        free = y + APART;
        let corner = at(f64::NEG_INFINITY, f64::INFINITY);
        // Lines that reach the frame, or nearly do, are named beyond it.
        let is_beyond = panel.rect.right - x < NEAR;
        let x = if is_beyond { panel.rect.right } else { x };
        let place = corner.shift(x - panel.rect.left + 7.0, y - panel.rect.top);
        let mut label = Label::new(place, end.text).colour(end.colour);
        if panel.on_cells {
            label = label.cut(Cut::End, ON_CELLS);
        }
        label.ground = panel.on_cells && !is_beyond;
        label
    };
    ends.into_iter().enumerate().map(label).collect()
}

/// Distance of two names above a panel, and room right of the last one, pixels.
const GAPS: (f64, f64) = (8.0, 4.0);

/// Writes names above the places where lines leave a panel, each cut to the room before the next one.
pub(super) fn labels_above(panel: &Panel, width: f64) -> Vec<Label> {
    let mut ends = panel.above.clone();
    ends.sort_by(|a, b| a.at.0.total_cmp(&b.at.0));
    let size = |end: &End| text_width(&end.text, TEXT);
    let lefts: Vec<f64> = ends.iter().map(|end| panel.px(end.at.0) - 4.0).collect();
    let edge = width - GAPS.1;
    let label = |(k, end): (usize, &End)| {
        let is_last = k + 1 == ends.len();
        let left = match is_last {
            true => lefts[k].min((edge - size(end)).max(panel.rect.left)),
            false => lefts[k],
        };
        let before = k.checked_sub(1).map_or(f64::NEG_INFINITY, |before| {
            lefts[before] + size(&ends[before]) + GAPS.0
        });
        let left = left.max(before.min(lefts[k]));
        let next = lefts.get(k + 1).map_or(edge, |next| next - GAPS.0);
        let text = Cut::End.apply(&end.text, TEXT, next - left);
        let place = at(f64::NEG_INFINITY, f64::INFINITY);
        let place = place.shift(left - panel.rect.left, -5.0);
        Label::new(place, text).colour(end.colour)
    };
    ends.iter().enumerate().map(label).collect()
}
