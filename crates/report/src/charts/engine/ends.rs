//! Names of lines at their right ends, moved apart to avoid overlaps.

use super::panel::Panel;
use super::place::{Label, at};
use super::svg::Point;

/// Minimum distance of two names, pixels.
const APART: f64 = 14.0;
/// Distance from the frame within which names are written beyond it, pixels.
const NEAR: f64 = 30.0;

/// Right end of a line, and its label.
#[derive(Clone, Debug)]
pub(crate) struct End {
    pub at: Point,
    pub text: String,
    pub colour: &'static str,
}

/// Writes names to the right of the ends of lines, the highest end on top, in the colours of the lines.
pub(crate) fn label_ends(panel: &mut Panel, ends: Vec<End>) {
    name_ends(panel, ends, false);
}

/// As [`label_ends`], over cells, where a name within the panel needs a white background.
pub(crate) fn label_ends_on_cells(panel: &mut Panel, ends: Vec<End>) {
    name_ends(panel, ends, true);
}

fn name_ends(panel: &mut Panel, mut ends: Vec<End>, cells: bool) {
    ends.retain(|end| end.at.0.is_finite() && end.at.1.is_finite());
    ends.sort_by(|a, b| b.at.1.total_cmp(&a.at.1));
    let lowest = panel.rect.bottom + 8.0;
    let (count, mut free) = (ends.len(), f64::NEG_INFINITY);
    for (k, end) in ends.into_iter().enumerate() {
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
        label.ground = cells && !is_beyond;
        panel.label(label);
    }
}
