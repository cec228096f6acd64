//! Time spent in the cells of a grid, coloured by duration: short is light, long is dark.

use std::collections::BTreeMap;

use crate::charts::engine::{Axis, Item, Key, Shape, Style, at, number, ramp, round_step};

/// Ratio of durations beyond which colours are logarithmic.
const LINEAR_UP_TO: f64 = 100.0;
const SLICES: usize = 64;

/// One cell and the time spent in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DensityCell {
    /// Lower and upper edge on the horizontal axis, in its unit.
    pub x: (f64, f64),
    /// Lower and upper edge on the vertical axis, in its unit.
    pub y: (f64, f64),
    /// Time, s.
    pub seconds: f64,
}

/// Shifts both ends of a cell down.
fn lowered((from, to): (f64, f64), by: f64) -> (f64, f64) {
    (from - by, to - by)
}

/// Seconds by cell. Cell edges lie on multiples of the cell's size, so that two cars share a grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Density {
    size: (f64, f64),
    /// Offset of cells below the multiples of their size on the vertical axis.
    lower: f64,
    /// Minimum and maximum amount that the colours span; by default of the own cells.
    span: Option<(f64, f64)>,
    seconds: BTreeMap<(i64, i64), f64>,
}

impl Density {
    /// Sums seconds of points x, y in cells of that size. Points with a position that is not finite, or without positive time, are ignored.
    pub(crate) fn new(size: (f64, f64), points: impl Iterator<Item = (f64, f64, f64)>) -> Self {
        let mut seconds: BTreeMap<(i64, i64), f64> = BTreeMap::new();
        for (x, y, dt) in points {
            if x.is_finite() && y.is_finite() && dt.is_finite() && dt > 0.0 {
                *seconds
                    .entry(((x / size.0).floor() as i64, (y / size.1).floor() as i64))
                    .or_default() += dt;
            }
        }
        Density {
            size,
            lower: 0.0,
            span: None,
            seconds,
        }
    }

    /// Round cell sizes with at most `max` cells along each axis.
    pub(crate) fn size_for(x: &Axis, y: &Axis, max: (usize, usize)) -> (f64, f64) {
        let size = |axis: &Axis, max: usize| round_step((axis.high - axis.low) / max.max(1) as f64);
        (size(x, max.0), size(y, max.1))
    }

    /// Minimum and maximum amount in a cell.
    pub(crate) fn ends(&self) -> (f64, f64) {
        let max_s = self.seconds.values().copied().fold(0.0, f64::max);
        let min_s = self.seconds.values().copied().fold(f64::INFINITY, f64::min);
        (min_s, max_s)
    }

    /// Sets a colour span common to several figures, which makes them comparable.
    pub(crate) fn on_scale(mut self, span: (f64, f64)) -> Self {
        self.span = Some(span);
        self
    }

    /// Amount in the cell that contains a point; zero for an empty one.
    pub(crate) fn within(&self, (x, y): (f64, f64)) -> f64 {
        let key = (
            (x / self.size.0).floor() as i64,
            (y / self.size.1).floor() as i64,
        );
        self.seconds.get(&key).copied().unwrap_or(0.0)
    }

    /// Time in all cells, s.
    pub(crate) fn total_s(&self) -> f64 {
        self.seconds.values().sum()
    }

    /// Shifts the cells down on the vertical axis.
    pub(crate) fn lowered(mut self, by: f64) -> Self {
        self.lower = by;
        self
    }

    /// Non-empty cells, by x and then y.
    pub(crate) fn cells(&self) -> impl Iterator<Item = DensityCell> {
        let edges = |k: i64, size: f64| (k as f64 * size, (k + 1) as f64 * size);
        let cells = self.seconds.iter();
        cells.map(move |(&(i, j), &seconds)| DensityCell {
            x: edges(i, self.size.0),
            y: lowered(edges(j, self.size.1), self.lower),
            seconds,
        })
    }

    /// Shapes of the cells; `row` gives the table row of a cell's numbers.
    pub(crate) fn items(&self, mut row: impl FnMut(&DensityCell) -> usize) -> Vec<Item> {
        let scale = self.scale();
        let item = |cell: DensityCell| {
            let style = Style::colour(&scale.colour(cell.seconds))
                .crisp()
                .class("cell");
            Item {
                shape: Shape::Rect(at(cell.x.0, cell.y.0), at(cell.x.1, cell.y.1)),
                style: style.row(row(&cell)),
            }
        };
        self.cells().map(item).collect()
    }

    /// Key of the colours; `what` names the amount in cells with its unit.
    pub(crate) fn key(&self, what: &str) -> Key {
        let scale = self.scale();
        let colour = |k: usize| scale.colour(scale.seconds((k as f64 + 0.5) / SLICES as f64));
        let step = |seconds: f64| match scale.log {
            true => seconds.max(1e-4),
            false => round_step(scale.high / 5.0),
        };
        let label = |seconds: f64| (scale.share(seconds), number(seconds, step(seconds)));
        let log = if scale.log { ", logarithmic" } else { "" };
        Key {
            heading: format!("{what}{log}"),
            colours: (0..SLICES).map(colour).collect(),
            labels: scale.marks().into_iter().map(label).collect(),
        }
    }

    /// Colour scale of the durations.
    fn scale(&self) -> TimeScale {
        let (min, max) = self.span.unwrap_or_else(|| self.ends());
        TimeScale::new(min, max)
    }
}

/// Maps seconds to a colour: linearly, or logarithmically over more than two decades.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimeScale {
    low: f64,
    high: f64,
    log: bool,
}

impl TimeScale {
    /// A scale for times from `least` to `max`, s; several panels share one over all of them.
    pub(crate) fn new(least: f64, most: f64) -> Self {
        let some = most.is_finite() && most > 0.0;
        let high = if some { most } else { 1.0 };
        let log = least > 0.0 && high / least > LINEAR_UP_TO;
        let low = if log { least } else { 0.0 };
        TimeScale { low, high, log }
    }

    /// Relative position of a time on the scale, 0 to 1.
    fn share(&self, seconds: f64) -> f64 {
        let share = if self.log {
            (seconds / self.low).ln() / (self.high / self.low).ln()
        } else {
            (seconds - self.low) / (self.high - self.low)
        };
        share.clamp(0.0, 1.0)
    }

    /// Time at a relative position on the scale, s.
    fn seconds(&self, share: f64) -> f64 {
        if self.log {
            self.low * (self.high / self.low).powf(share)
        } else {
            self.low + share * (self.high - self.low)
        }
    }

    /// The colour of a time.
    fn colour(&self, seconds: f64) -> String {
        // The ends of the ramp are omitted: too close to paper and lines.
        ramp(0.97 - 0.9 * self.share(seconds))
    }

    /// Marked times of the key: its ends and round numbers between.
    fn marks(&self) -> Vec<f64> {
        let step = round_step(self.high / 5.0);
        let round: Vec<f64> = if self.log {
            let [from, to] = [self.low.log10().floor(), self.high.log10().ceil()];
            let digits = |power: i32| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(power));
            (from as i32..=to as i32).flat_map(digits).collect()
        } else {
            (0..=5).map(|k| f64::from(k) * step).collect()
        };
        let inside = |s: &f64| *s >= self.low * (1.0 - 1e-9) && *s <= self.high * (1.0 + 1e-9);
        round.into_iter().filter(inside).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_all_time_and_own_their_borders() {
        let points = [
            (0.0, 0.0, 1.0),
            (9.99, 4.9, 0.5),
            (10.0, 5.0, 2.0),
            (-0.1, -5.0, 4.0),
            (f64::NAN, 0.0, 8.0),
            (1.0, 1.0, -1.0),
        ];
        let density = Density::new((10.0, 5.0), points.into_iter());
        assert!((density.total_s() - 7.5).abs() < 1e-12);
        let cells: Vec<_> = density.cells().collect();
        assert_eq!(cells.len(), 3);
        assert_eq!(
            cells[0],
            DensityCell {
                x: (-10.0, 0.0),
                y: (-5.0, 0.0),
                seconds: 4.0
            }
        );
        assert_eq!(
            cells[1],
            DensityCell {
                x: (0.0, 10.0),
                y: (0.0, 5.0),
                seconds: 1.5
            }
        );
    }

    #[test]
    fn longer_time_is_darker_and_marks_lie_on_key() {
        let light = |colour: &str| {
            let part =
                |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap_or(0));
            0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
        };
        for (scale, log) in [
            (TimeScale::new(0.1, 400.0), true),
            (TimeScale::new(1.0, 40.0), false),
        ] {
            assert_eq!(scale.log, log);
            let seen: Vec<f64> = (0..=20)
                .map(|k| light(&scale.colour(scale.seconds(f64::from(k) / 20.0))))
                .collect();
            assert!(seen.windows(2).all(|pair| pair[1] < pair[0]), "{seen:?}");
            let marks = scale.marks();
            assert!(
                marks.len() >= 3
                    && marks
                        .iter()
                        .all(|s| *s >= scale.low - 1e-12 && *s <= scale.high + 1e-9),
                "{marks:?}"
            );
            for share in [0.0, 0.3, 1.0] {
                assert!((scale.share(scale.seconds(share)) - share).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn empty_density_has_a_key() {
        let key = Density::new((1.0, 1.0), std::iter::empty()).key("Time spent in a cell [s]");
        assert!(
            key.labels
                .iter()
                .all(|(share, label)| share.is_finite() && !label.is_empty())
        );
        assert_eq!(key.colours.len(), SLICES);
    }
}
