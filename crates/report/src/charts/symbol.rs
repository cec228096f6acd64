//! Marks of single points: shapes that stay apart in black and white and for the colour-blind.

use super::figure::{Figure, Path, UNITS, units};
use super::style::STROKES;

/// The shape and colour of a group of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Symbol {
    shape: usize,
    colour: &'static str,
}

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

/// Colours in an order in which neighbours differ most.
const ORDER: [usize; 7] = [2, 1, 3, 4, 0, 6, 5];

impl Symbol {
    /// The symbol of the group with that number; no two of the first 49 are alike.
    pub fn of(index: usize) -> Self {
        let (turn, k) = (index / SHAPES.len(), index % SHAPES.len());
        Symbol {
            shape: (k + turn) % SHAPES.len(),
            colour: STROKES[ORDER[k]].colour,
        }
    }

    /// A symbol of one colour that is no group's.
    pub fn plain(shape: usize, colour: &'static str) -> Self {
        Symbol {
            shape: shape % SHAPES.len(),
            colour,
        }
    }

    /// Its colour.
    pub fn colour(self) -> &'static str {
        self.colour
    }

    /// Draws it filled, with further SVG attributes.
    pub fn filled(self, figure: &mut Figure, at: (f64, f64), radius: f64, attributes: &str) {
        self.draw(
            figure,
            at,
            radius,
            &format!(
                "fill=\"{0}\" stroke=\"{0}\" stroke-width=\"2\" {attributes}",
                self.colour
            ),
        );
    }

    /// Draws its outline only, with further SVG attributes.
    pub fn open(self, figure: &mut Figure, at: (f64, f64), radius: f64, attributes: &str) {
        self.draw(
            figure,
            at,
            radius,
            &format!("fill=\"none\" stroke=\"{}\" stroke-width=\"4\" stroke-opacity=\"0.7\" {attributes}", self.colour),
        );
    }

    fn draw(self, figure: &mut Figure, (x, y): (f64, f64), radius: f64, attributes: &str) {
        let corners = SHAPES[self.shape];
        if corners.is_empty() {
            let (cx, cy, r) = (units(x), units(y), radius * UNITS);
            return figure.raw(&format!(
                "<circle cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" {attributes}/>"
            ));
        }
        let mut path = Path::default();
        for (dx, dy) in corners {
            path.line_to(x + dx * radius, y + dy * radius);
        }
        path.close();
        let data = path.finish();
        figure.raw(&format!("<path d=\"{data}\" {attributes}/>"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_of_the_first_49_are_alike() {
        let all: Vec<Symbol> = (0..49).map(Symbol::of).collect();
        for (k, one) in all.iter().enumerate() {
            assert!(!all[..k].contains(one), "{k}: {one:?}");
        }
        assert_ne!(all[0].colour, all[1].colour);
    }
}
