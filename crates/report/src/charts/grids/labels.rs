//! Labels on lines of equal value: apart from each other, within the panel, and clear of other things where possible.

use crate::charts::engine::{Label, Panel, Point, Rect, at, text_width};

/// Places along a line at which its label may lie, per cent of its length: from the middle outwards.
const PLACES: [usize; 15] = [50, 60, 40, 70, 30, 80, 20, 90, 10, 65, 35, 75, 25, 5, 95];

/// The labels of a panel in the making.
pub(super) struct LineLabels {
    rect: Rect,
    size: f64,
    /// What labels are to keep clear of.
    taken: Vec<Rect>,
    placed: Vec<(Point, String)>,
}

impl LineLabels {
    pub fn new(rect: Rect, size: f64, taken: Vec<Rect>) -> Self {
        let placed = Vec::new();
        LineLabels {
            rect,
            size,
            taken,
            placed,
        }
    }

    /// Places a text on a line of points in pixels, if there is room for it.
    pub fn place(&mut self, text: String, line: &[Point]) {
        let half = |text: &str| 0.5 * text_width(text, self.size) + 3.0;
        let (own, r) = (half(&text), self.rect);
        let fits = |&(x, y): &Point| {
            let inside =
                x > r.left + own && x < r.right - own && y > r.top + 8.0 && y < r.bottom - 8.0;
            let mut others = self.placed.iter();
            let apart = others
                .all(|((u, v), other)| (x - u).abs() > own + half(other) || (y - v).abs() > 14.0);
            inside && apart
        };
        let clear = |&&(x, y): &&Point| {
            let apart = |r: &Rect| {
                x + 14.0 < r.left || x - 14.0 > r.right || y + 8.0 < r.top || y - 8.0 > r.bottom
            };
            self.taken.iter().all(apart)
        };
        let places = PLACES
            .iter()
            .filter_map(|percent| line.get(percent * line.len() / 100));
        let places: Vec<Point> = places.copied().filter(fits).collect();
        let place = places.iter().find(clear).or(places.first()).copied();
        self.placed.extend(place.map(|place| (place, text)));
    }

    /// The labels for a panel.
    pub fn labels(self, panel: &Panel) -> Vec<Label> {
        let (r, size) = (panel.rect, self.size);
        let label = |((x, y), text): (Point, String)| {
            let corner = at(f64::NEG_INFINITY, f64::INFINITY);
            let label = Label::new(corner.shift(x - r.left, y - r.top + 4.0), text);
            Label {
                ground: true,
                ..label.size(size).middle().class("iso")
            }
        };
        self.placed.into_iter().map(label).collect()
    }
}
