//! Values at all pairs of two lists of coordinates from points that need not fill them: linear in the triangles of a Delaunay triangulation,
//! by a rule of the caller beyond their convex hull.
//!
//! The triangles are those of `spade`: its predicates are exact, so that points on circles and lines, of which a measured grid with holes
//! consists, are no special case.

use std::collections::HashMap;

use spade::{DelaunayTriangulation, FloatTriangulation, HasPosition, Point2, Triangulation};

/// Fewest points that are triangulated: three have one triangle, which is no map. ASSUMED.
const LEAST_POINTS: usize = 4;
/// Largest distance from the hull, in shares of the axis, that rounding explains.
const ON_HULL: f64 = 1e-9;

/// A point of the triangulation.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    at: Point2<f64>,
    value: f64,
}

impl HasPosition for Vertex {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.at
    }
}

/// Values at the pairs of two lists.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// `values[i][k]` at the `i`-th x and the `k`-th y.
    pub values: Vec<Vec<f64>>,
    /// True where the pair lies in the convex hull of the points.
    pub known: Vec<Vec<bool>>,
}

/// The points at one x: where they end, and their values between.
#[derive(Clone, Copy, Debug)]
pub struct Across<'t> {
    triangles: &'t Triangles,
    x: f64,
    /// Lowest and highest y in the hull.
    pub ends: [f64; 2],
    /// Values there.
    pub at_ends: [f64; 2],
}

impl Across<'_> {
    /// The value at a y, held at the ends.
    #[must_use]
    pub fn held(&self, y: f64) -> f64 {
        let [low, high] = self.ends;
        if y <= low {
            return self.at_ends[0];
        }
        if y >= high {
            return self.at_ends[1];
        }
        let inside = self.triangles.inside(self.x, y);
        inside.unwrap_or(0.5 * (self.at_ends[0] + self.at_ends[1]))
    }
}

/// Triangles of points, in axes scaled to their ranges: the unit of an axis does not matter.
#[derive(Debug)]
struct Triangles {
    all: DelaunayTriangulation<Vertex>,
    from: [f64; 2],
    width: [f64; 2],
}

impl Triangles {
    fn new(points: &[([f64; 2], f64)]) -> Option<Self> {
        let ends = [0, 1].map(|k| {
            let values = points.iter().map(|(x, _)| x[k]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        });
        let from = ends.map(|[low, _]| low);
        let width = ends.map(|[low, high]| high - low);
        if points.len() < LEAST_POINTS || width.iter().any(|width| *width <= 0.0) {
            return None;
        }
        let vertex = |(x, value): &([f64; 2], f64)| Vertex {
            at: Point2::new((x[0] - from[0]) / width[0], (x[1] - from[1]) / width[1]),
            value: *value,
        };
        let all = DelaunayTriangulation::bulk_load(points.iter().map(vertex).collect()).ok()?;
        (all.num_inner_faces() > 0).then_some(Triangles { all, from, width })
    }

    fn scaled(&self, x: f64, y: f64) -> Point2<f64> {
        let [u, v] = [(x, 0), (y, 1)].map(|(x, k)| (x - self.from[k]) / self.width[k]);
        Point2::new(u, v)
    }

    /// Value at a point of the hull.
    fn inside(&self, x: f64, y: f64) -> Option<f64> {
        let weights = self.all.barycentric();
        weights.interpolate(|vertex| vertex.data().value, self.scaled(x, y))
    }

    /// Ends of the hull at an x; none beyond it.
    fn across(&self, x: f64) -> Option<Across<'_>> {
        let u = self.scaled(x, self.from[1]).x;
        let mut ends: Option<[(f64, f64); 2]> = None;
        let mut see = |v: f64, value: f64| {
            let [low, high] = ends.unwrap_or([(v, value); 2]);
            let low = if v < low.0 { (v, value) } else { low };
            let high = if v > high.0 { (v, value) } else { high };
            ends = Some([low, high]);
        };
        for edge in self.all.convex_hull() {
            let [a, b] = edge.vertices().map(|vertex| *vertex.data());
            let (left, right) = (a.at.x.min(b.at.x), a.at.x.max(b.at.x));
            if u < left - ON_HULL || u > right + ON_HULL {
                continue;
            }
            if right - left <= ON_HULL {
                see(a.at.y, a.value);
                see(b.at.y, b.value);
                continue;
            }
            let share = ((u - a.at.x) / (b.at.x - a.at.x)).clamp(0.0, 1.0);
            see(
                a.at.y + share * (b.at.y - a.at.y),
                a.value + share * (b.value - a.value),
            );
        }
        let ends = ends?;
        Some(Across {
            triangles: self,
            x,
            ends: ends.map(|(v, _)| self.from[1] + v * self.width[1]),
            at_ends: ends.map(|(_, value)| value),
        })
    }
}

impl Lattice {
    /// The values at all pairs of `xs` and `ys`; `beyond` gives those at a y beyond the ends of the points at an x. An x beyond all points has the values
    /// of the last one. A point that is a pair itself has its own value to the bit. None of fewer than four points, and of points on one line.
    pub fn new(
        points: &[([f64; 2], f64)],
        [xs, ys]: [&[f64]; 2],
        beyond: impl Fn(&Across<'_>, f64) -> f64,
    ) -> Option<Lattice> {
        let triangles = Triangles::new(points)?;
        let bits = |x: f64, y: f64| [x.to_bits(), y.to_bits()];
        let own: HashMap<[u64; 2], f64> = points
            .iter()
            .map(|(x, value)| (bits(x[0], x[1]), *value))
            .collect();
        let mut lattice = Lattice {
            values: Vec::with_capacity(xs.len()),
            known: Vec::with_capacity(xs.len()),
        };
        let slack = ON_HULL * triangles.width[1];
        let (first, last) = (triangles.from[0], triangles.from[0] + triangles.width[0]);
        for &x in xs {
            let held = x.max(first).min(last);
            let is_held = (held - x).abs() > ON_HULL * triangles.width[0];
            let across = triangles.across(held)?;
            let [low, high] = across.ends;
            let at = |&y: &f64| match own.get(&bits(x, y)) {
                Some(value) => (*value, true),
                None if y < low - slack || y > high + slack => (beyond(&across, y), false),
                None => (across.held(y), true),
            };
            let (values, mut known): (Vec<f64>, Vec<bool>) = ys.iter().map(at).unzip();
            if is_held {
                known.fill(false);
            }
            lattice.values.push(values);
            lattice.known.push(known);
        }
        Some(lattice)
    }
}
