//! Symbols of points, distinguishable in black and white and by the colour-blind.

use super::style::{STROKES, Style, stroke};
use super::svg::{Path, Point, Svg};

/// Corners of a shape around its middle, as shares of its radius.
type Corners = &'static [(f64, f64)];

/// Shapes with corners; the first one, a circle, has none.
const SHAPES: [Corners; 7] = [
    &[],
    &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
    &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
    &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)],
    &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
    &[
        (-0.4, -1.2),
        (0.4, -1.2),
        (0.4, -0.4),
        (1.2, -0.4),
        (1.2, 0.4),
        (0.4, 0.4),
        (0.4, 1.2),
        (-0.4, 1.2),
        (-0.4, 0.4),
        (-1.2, 0.4),
        (-1.2, -0.4),
        (-0.4, -0.4),
    ],
    &[
        (-0.6, -1.1),
        (0.6, -1.1),
        (1.2, 0.0),
        (0.6, 1.1),
        (-0.6, 1.1),
        (-1.2, 0.0),
    ],
];

/// Triangles at the left and right edge of a panel, for points beyond it.
const EDGES: [Corners; 2] = [
    &[(0.0, 0.0), (2.0, -1.0), (2.0, 1.0)],
    &[(0.0, 0.0), (-2.0, -1.0), (-2.0, 1.0)],
];

/// Colours ordered for maximum contrast between neighbours.
const ORDER: [usize; 7] = [2, 1, 3, 4, 0, 6, 5];

/// The shape of the mark of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Symbol(Corners);

impl Symbol {
    pub const CIRCLE: Symbol = Symbol(SHAPES[0]);
    pub const DIAMOND: Symbol = Symbol(SHAPES[3]);

    /// Shape and colour of the group with that number; the first 49 are distinct.
    pub fn nth(index: usize) -> (Self, &'static str) {
        let (turn, k) = (index / SHAPES.len(), index % SHAPES.len());
        let shape = SHAPES[(k + turn) % SHAPES.len()];
        (Symbol(shape), STROKES[ORDER[k]].colour)
    }

    /// A triangle that points to the left or right edge.
    pub fn edge(right: bool) -> Self {
        Symbol(EDGES[usize::from(right)])
    }

    /// The style of a filled symbol.
    pub fn filled(colour: &'static str) -> Style {
        Style::colour(colour).edge(stroke(colour, 0.5, &[]))
    }

    /// The style of an outline.
    pub fn open(colour: &'static str) -> Style {
        Style::line(stroke(colour, 1.0, &[])).stroke_opacity(0.7)
    }

    /// The style of a white symbol with an outline of 1.5 px.
    pub fn white(colour: &'static str) -> Style {
        Style::colour("#ffffff").edge(stroke(colour, 1.5, &[]))
    }

    /// Draws the symbol at a position in pixels.
    pub(super) fn draw(self, svg: &mut Svg, (x, y): Point, radius: f64, style: &Style) {
        let paint = style.attributes(svg);
        if self.0.is_empty() {
            return svg.circle((x, y), radius, &paint);
        }
        let corners = self.0.iter();
        let corners = corners.map(|(dx, dy)| (x + dx * radius, y + dy * radius));
        svg.path(Path::polygon(corners), &paint);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_49_symbols_are_distinct() {
        let all: Vec<_> = (0..49).map(Symbol::nth).collect();
        for (k, one) in all.iter().enumerate() {
            assert!(!all[..k].contains(one), "{k}: {one:?}");
        }
        assert_ne!(all[0].1, all[1].1);
    }
}
