//! Contour lines on a grid, by marching squares, and their labels: separate, within the panel, and clear of other items where possible.

use std::collections::BTreeMap;

use crate::charts::engine::{Label, Panel, Point, Rect, at, text_width};

/// Values on a grid: `values[i][j]` at `x[i]`, `y[j]`.
pub(crate) struct Grid<'a> {
    pub x: &'a [f64],
    pub y: &'a [f64],
    pub values: &'a [Vec<f64>],
}

/// An edge of the grid: its lower node, and true if it runs along y.
type Edge = (usize, usize, bool);

impl Grid<'_> {
    fn at(&self, i: usize, j: usize) -> f64 {
        let column = self.values.get(i);
        column
            .and_then(|column| column.get(j))
            .copied()
            .unwrap_or(f64::NAN)
    }

    /// Connected lines on which the values are `level`. Cells with a corner that is not finite have none.
    pub fn lines(&self, level: f64) -> Vec<Vec<Point>> {
        let mut next: BTreeMap<Edge, Vec<Edge>> = BTreeMap::new();
        for i in 1..self.x.len() {
            for j in 1..self.y.len() {
                for (a, b) in self.cell(i - 1, j - 1, level) {
                    next.entry(a).or_default().push(b);
                    next.entry(b).or_default().push(a);
                }
            }
        }
        let mut lines = Vec::new();
        // Open lines are traced first, from one of their ends; the remaining ones are rings.
        for open in [true, false] {
            loop {
                let start = next
                    .iter()
                    .find(|(_, to)| !to.is_empty() && (!open || to.len() == 1));
                let Some((&start, _)) = start else { break };
                let edges = walk(&mut next, start);
                lines.push(
                    edges
                        .into_iter()
                        .map(|edge| self.crossing(edge, level))
                        .collect(),
                );
            }
        }
        lines
    }

    /// Pieces of line in one cell, each from edge to edge.
    fn cell(&self, i: usize, j: usize, level: f64) -> Vec<(Edge, Edge)> {
        let corners = [
            self.at(i, j),
            self.at(i + 1, j),
            self.at(i + 1, j + 1),
            self.at(i, j + 1),
        ];
        if corners.iter().any(|value| !value.is_finite()) {
            return Vec::new();
        }
        // Bottom, right, top, left: edge k lies between corners k and k + 1.
        let edges: [Edge; 4] = [
            (i, j, false),
            (i + 1, j, true),
            (i, j + 1, false),
            (i, j, true),
        ];
        let above = corners.map(|value| value >= level);
        let crossed: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
        match crossed[..] {
            [a, b] => vec![(edges[a], edges[b])],
            [_, _, _, _] => {
                // In a saddle, the middle decides the pairing of the corners.
                let middle = corners.iter().sum::<f64>() / 4.0 >= level;
                if middle == above[0] {
                    vec![(edges[0], edges[1]), (edges[2], edges[3])]
                } else {
                    vec![(edges[3], edges[0]), (edges[1], edges[2])]
                }
            }
            _ => Vec::new(),
        }
    }

    /// Intersection of the level with an edge.
    fn crossing(&self, (i, j, along_y): Edge, level: f64) -> Point {
        let (i1, j1) = if along_y { (i, j + 1) } else { (i + 1, j) };
        let (a, b) = (self.at(i, j), self.at(i1, j1));
        let t = ((level - a) / (b - a)).clamp(0.0, 1.0);
        (
            self.x[i] + t * (self.x[i1] - self.x[i]),
            self.y[j] + t * (self.y[j1] - self.y[j]),
        )
    }
}

/// Follows a line to its other end, and removes its pieces from `next`.
fn walk(next: &mut BTreeMap<Edge, Vec<Edge>>, start: Edge) -> Vec<Edge> {
    let mut edges = vec![start];
    let mut here = start;
    while let Some(there) = next.get_mut(&here).and_then(Vec::pop) {
        if let Some(back) = next.get_mut(&there)
            && let Some(at) = back.iter().position(|edge| *edge == here)
        {
            back.swap_remove(at);
        }
        edges.push(there);
        here = there;
    }
    edges
}

/// Candidate positions of a label along its line, per cent of its length: from the middle outwards.
const PLACES: [usize; 15] = [50, 60, 40, 70, 30, 80, 20, 90, 10, 65, 35, 75, 25, 5, 95];

/// Labels of a panel under construction.
pub(super) struct LineLabels {
    rect: Rect,
    size: f64,
    /// Areas that labels must avoid.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cone_has_one_ring_contour() {
        let axis: Vec<f64> = (0..41).map(|i| -2.0 + 0.1 * f64::from(i)).collect();
        let values: Vec<Vec<f64>> = axis
            .iter()
            .map(|x| axis.iter().map(|y| x.hypot(*y)).collect())
            .collect();
        let grid = Grid {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = grid.lines(1.23);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        for (x, y) in &lines[0] {
            assert!((x.hypot(*y) - 1.23).abs() < 0.005);
        }
    }

    #[test]
    fn slope_has_one_open_contour_with_gaps_at_nan() {
        let axis: Vec<f64> = (0..11).map(f64::from).collect();
        let mut values: Vec<Vec<f64>> = axis.iter().map(|_| axis.clone()).collect();
        let grid = Grid {
            x: &axis,
            y: &axis,
            values: &values,
        };
        let lines = grid.lines(4.5);
        assert_eq!((lines.len(), lines[0].len()), (1, 11));
        values[5][4] = f64::NAN;
        let grid = Grid {
            x: &axis,
            y: &axis,
            values: &values,
        };
        assert_eq!(grid.lines(4.5).len(), 2);
        assert!(
            Grid {
                x: &[],
                y: &axis,
                values: &[]
            }
            .lines(1.0)
            .is_empty()
        );
    }

    #[test]
    fn saddle_contours_do_not_cross() {
        let values = vec![vec![0.0, 1.0], vec![1.0, 0.0]];
        let grid = Grid {
            x: &[0.0, 1.0],
            y: &[0.0, 1.0],
            values: &values,
        };
        assert_eq!(grid.lines(0.4).len(), 2);
        assert_eq!(grid.lines(0.6).len(), 2);
    }
}
