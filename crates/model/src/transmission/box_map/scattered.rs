//! Measured points that fill no grid, brought onto one.
//!
//! | label | statement | status |
//! |---|---|---|
//! | MP-5 | y(x) at each node of 15 values an axis: plane through the 12 nearest points by least squares, weights 1/d^2, d in shares of the axes; a point on the node counts alone; then multilinear | derived: a plane gives a linear field exactly; 12, 15 and 1/d^2 ASSUMED |
//!
//! Refused where the points lie in one plane, and where a node is farther from every point than a quarter of an axis: nothing is guessed there.

use super::NoMap;
use crate::maps::Scatter;
use crate::math::GRID_AXES;

/// Values of an axis of the grid.
const NODES: usize = 15;
/// Points of a plane.
const NEAREST: usize = 12;
/// Farthest point of a node, in shares of the axes.
const FARTHEST: f64 = 0.25;
/// Most points: each node looks at all of them.
const MAX_POINTS: usize = 2000;
/// Distance at which a point is on a node.
const ON_NODE: f64 = 1e-9;
/// Least part of a sum of squares that the other directions leave of it, where a plane has all of them.
const MIN_PIVOT: f64 = 1e-9;
/// Unknowns of a plane: its height and a slope for each axis.
const UNKNOWNS: usize = GRID_AXES + 1;

/// A point: its axes, and its value.
type Point = ([f64; GRID_AXES], f64);

/// Ends of the axes that have more than one value.
struct Axes {
    used: Vec<usize>,
    low: [f64; GRID_AXES],
    width: [f64; GRID_AXES],
}

impl Axes {
    fn new(points: &[Point]) -> Self {
        let mut axes = Axes {
            used: Vec::new(),
            low: [0.0; GRID_AXES],
            width: [0.0; GRID_AXES],
        };
        for k in 0..GRID_AXES {
            let values = || points.iter().map(|(x, _)| x[k]);
            axes.low[k] = values().fold(f64::INFINITY, f64::min);
            axes.width[k] = values().fold(f64::NEG_INFINITY, f64::max) - axes.low[k];
            if axes.width[k] > 0.0 {
                axes.used.push(k);
            }
        }
        axes
    }

    /// Way from a node to a point, in shares of the axes.
    fn way(&self, node: &[f64; GRID_AXES], point: &[f64; GRID_AXES]) -> [f64; GRID_AXES] {
        let mut way = [0.0; GRID_AXES];
        for &k in &self.used {
            way[k] = (point[k] - node[k]) / self.width[k];
        }
        way
    }

    /// The nodes of the grid.
    fn nodes(&self) -> impl Iterator<Item = [f64; GRID_AXES]> + '_ {
        let count = NODES.pow(self.used.len() as u32);
        (0..count).map(move |index| {
            let (mut node, mut rest) = (self.low, index);
            for &k in &self.used {
                let share = (rest % NODES) as f64 / (NODES - 1) as f64;
                node[k] += share * self.width[k];
                rest /= NODES;
            }
            node
        })
    }
}

/// The points of a grid through scattered ones (MP-5).
///
/// # Errors
/// Too few or too many points, points in one plane, a node far from all points.
pub fn gridded(points: &[Point]) -> Result<Vec<Point>, NoMap> {
    let axes = Axes::new(points);
    if points.len() <= NEAREST || points.len() > MAX_POINTS {
        return Err(NoMap {
            allowed: format!("{} to {MAX_POINTS} points", NEAREST + 1),
            message: format!("there are {} scattered points", points.len()),
            hint: "measure more of them, or bring them onto a grid yourself".to_owned(),
        });
    }
    axes.nodes()
        .map(|node| Ok((node, at_node(&axes, &node, points)?)))
        .collect()
}

/// Each point against the plane of the others; none where the others lie in one plane.
#[must_use]
pub fn leave_one_out(points: &[Point]) -> Option<Scatter> {
    let axes = Axes::new(points);
    let (mut squares, mut largest_nm) = (0.0, 0.0f64);
    for k in 0..points.len() {
        let others = [&points[..k], &points[k + 1..]].concat();
        let near = nearest(&axes, &points[k].0, &others);
        let miss = plane(&axes, &points[k].0, &near)? - points[k].1;
        squares += miss * miss;
        largest_nm = largest_nm.max(miss.abs());
    }
    Some(Scatter {
        points: points.len(),
        rms_nm: (squares / points.len() as f64).sqrt(),
        largest_nm,
    })
}

fn distance(way: &[f64; GRID_AXES]) -> f64 {
    way.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The nearest points of a node, with their distances.
fn nearest<'p>(axes: &Axes, node: &[f64; GRID_AXES], points: &'p [Point]) -> Vec<(f64, &'p Point)> {
    let far = |point: &'p Point| (distance(&axes.way(node, &point.0)), point);
    let mut all: Vec<(f64, &Point)> = points.iter().map(far).collect();
    let count = NEAREST.min(all.len());
    all.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0));
    all.truncate(count);
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

fn at_node(axes: &Axes, node: &[f64; GRID_AXES], points: &[Point]) -> Result<f64, NoMap> {
    let near = nearest(axes, node, points);
    let places = || {
        let values = axes.used.iter().map(|k| format!("{:.4}", node[*k]));
        values.collect::<Vec<_>>().join(", ")
    };
    let within = |(_, point): &(f64, &Point)| {
        let way = axes.way(node, &point.0);
        way.iter().all(|x| x.abs() <= FARTHEST)
    };
    if !near.iter().any(within) {
        return Err(NoMap {
            allowed: "a point within a quarter of each axis of every node".to_owned(),
            message: format!(
                "the scattered points leave a hole at ({}) in SI units",
                places()
            ),
            hint: "measure there, or leave out the points that lie far from the others".to_owned(),
        });
    }
    plane(axes, node, &near).ok_or_else(|| NoMap {
        allowed: "points that differ in each column by itself".to_owned(),
        message: format!(
            "the {NEAREST} points nearest to ({}) in SI units lie in one plane",
            places()
        ),
        hint: "give them as a grid, or leave out the column that follows from the others"
            .to_owned(),
    })
}

/// Height at a node of the plane through points; none where they lie in one plane of fewer directions (MP-5).
fn plane(axes: &Axes, node: &[f64; GRID_AXES], near: &[(f64, &Point)]) -> Option<f64> {
    if let Some((first, point)) = near.first()
        && *first <= ON_NODE
    {
        return Some(point.1); // MP-5
    }
    let size = axes.used.len() + 1;
    let mut normal = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
    for (far, point) in near {
        let way = axes.way(node, &point.0);
        let mut basis = [0.0; UNKNOWNS];
        basis[0] = 1.0;
        for (b, k) in basis[1..].iter_mut().zip(&axes.used) {
            *b = way[*k];
        }
        let weight = 1.0 / (far * far); // MP-5
        for (row, a) in normal.iter_mut().zip(basis) {
            for (sum, b) in row.iter_mut().zip(basis) {
                *sum += weight * a * b;
            }
            row[UNKNOWNS] += weight * a * point.1;
        }
    }
    solve(&mut normal, size)
}

/// First unknown of a system of linear equations, its right side in the last column, by elimination with pivots; none where it has no only solution.
fn solve(rows: &mut [[f64; UNKNOWNS + 1]; UNKNOWNS], size: usize) -> Option<f64> {
    let before: [f64; UNKNOWNS] = std::array::from_fn(|k| rows[k][k]);
    // The unknowns from the last one down, so that the first is found at the end.
    for k in (0..size).rev() {
        let scale = rows[k][k];
        if scale <= MIN_PIVOT * before[k] {
            return None;
        }
        let pivot = rows[k];
        for row in rows.iter_mut().take(k) {
            let part = row[k] / scale;
            for (x, p) in row.iter_mut().zip(pivot) {
                *x -= part * p;
            }
        }
    }
    Some(rows[0][UNKNOWNS] / rows[0][0])
}
