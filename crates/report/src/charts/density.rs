//! Time spent in the cells of a grid, coloured by its seconds: little is light, much is dark.
use std::collections::BTreeMap;

use super::axis::{Axis, number, round_step};
use super::figure::{Anchor, Figure, INK, Rect, text_width};
use super::panel::Panel;
use super::style::ramp;

/// Height of the key with its heading and labels, pixels.
pub(in crate::charts) const KEY_HEIGHT: f64 = 48.0;
/// Time spans beyond this ratio are coloured by their logarithm.
const LINEAR_UP_TO: f64 = 100.0;
const SLICES: usize = 64;
const TEXT: f64 = 11.0;

/// One cell and the time spent in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::charts) struct DensityCell {
    /// Lower and upper edge on the horizontal axis, in its unit.
    pub x: (f64, f64),
    /// Lower and upper edge on the vertical axis, in its unit.
    pub y: (f64, f64),
    /// Time, s.
    pub seconds: f64,
}

/// Seconds by cell. Cell edges lie on multiples of the cell's size, so that two cars share a grid.
#[derive(Clone, Debug, Default)]
pub(in crate::charts) struct Density {
    size: (f64, f64),
    seconds: BTreeMap<(i64, i64), f64>,
}

impl Density {
    /// Gathers points of x, y and seconds in cells of that size. A point without finite place or positive time counts as nothing.
    pub(in crate::charts) fn gather(
        size: (f64, f64),
        points: impl Iterator<Item = (f64, f64, f64)>,
    ) -> Self {
        let mut seconds: BTreeMap<(i64, i64), f64> = BTreeMap::new();
        for (x, y, dt) in points {
            if x.is_finite() && y.is_finite() && dt.is_finite() && dt > 0.0 {
                *seconds
                    .entry(((x / size.0).floor() as i64, (y / size.1).floor() as i64))
                    .or_default() += dt;
            }
        }
        Density { size, seconds }
    }

    /// A round size with at most `most` cells along an axis.
    pub(in crate::charts) fn size_for(axis: &Axis, most: usize) -> f64 {
        round_step((axis.high - axis.low) / most.max(1) as f64)
    }

    /// Time in all cells, s.
    pub(in crate::charts) fn total_s(&self) -> f64 {
        self.seconds.values().sum()
    }

    /// The cells in which time was spent, by x and then y.
    pub(in crate::charts) fn cells(&self) -> impl Iterator<Item = DensityCell> {
        let edges = |k: i64, size: f64| (k as f64 * size, (k + 1) as f64 * size);
        self.seconds
            .iter()
            .map(move |(&(i, j), &seconds)| DensityCell {
                x: edges(i, self.size.0),
                y: edges(j, self.size.1),
                seconds,
            })
    }

    /// How seconds become a colour.
    pub(in crate::charts) fn scale(&self) -> DensityScale {
        let most = self.seconds.values().copied().fold(0.0, f64::max);
        let least = self.seconds.values().copied().fold(f64::INFINITY, f64::min);
        DensityScale::new(least, most)
    }
}

/// How seconds become a colour: in proportion, or by the logarithm over more than two decades.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::charts) struct DensityScale {
    low: f64,
    high: f64,
    log: bool,
}

impl DensityScale {
    /// A scale for times from `least` to `most`, s; several panels share one made of the extremes of all.
    pub(in crate::charts) fn new(least: f64, most: f64) -> Self {
        let high = if most.is_finite() && most > 0.0 {
            most
        } else {
            1.0
        };
        let log = least > 0.0 && high / least > LINEAR_UP_TO;
        DensityScale {
            low: if log { least } else { 0.0 },
            high,
            log,
        }
    }

    /// Where a time lies on the scale, 0 to 1.
    fn share(&self, seconds: f64) -> f64 {
        let share = if self.log {
            (seconds / self.low).ln() / (self.high / self.low).ln()
        } else {
            (seconds - self.low) / (self.high - self.low)
        };
        share.clamp(0.0, 1.0)
    }

    /// The time at a place on the scale, s.
    fn seconds(&self, share: f64) -> f64 {
        if self.log {
            self.low * (self.high / self.low).powf(share)
        } else {
            self.low + share * (self.high - self.low)
        }
    }

    /// The colour of a time.
    pub(in crate::charts) fn colour(&self, seconds: f64) -> String {
        // The ends of the ramp are left out: as yellow as paper, as dark as lines.
        ramp(0.97 - 0.9 * self.share(seconds))
    }

    /// Times that are marked on the key: its ends and round numbers between.
    fn marks(&self) -> Vec<f64> {
        if !self.log {
            let step = round_step(self.high / 5.0);
            return (0..=5)
                .map(|k| f64::from(k) * step)
                .filter(|s| *s <= self.high * (1.0 + 1e-9))
                .collect();
        }
        let (from, to) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let round =
            (from..=to).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| digit * 10f64.powi(power)));
        round
            .filter(|s| *s >= self.low * (1.0 - 1e-9) && *s <= self.high * (1.0 + 1e-9))
            .collect()
    }
}

/// Draws the cells in the panel, as far as they lie in it; `row` gives the row of the table in which a cell stands.
pub(in crate::charts) fn draw_cells(
    figure: &mut Figure,
    panel: &Panel,
    density: &Density,
    scale: &DensityScale,
    mut row: impl FnMut(&DensityCell) -> usize,
) {
    figure.open("density");
    for cell in density.cells() {
        let index = row(&cell);
        let rect = Rect {
            left: panel.px(cell.x.0).max(panel.rect.left),
            right: panel.px(cell.x.1).min(panel.rect.right),
            top: panel.py(cell.y.1).max(panel.rect.top),
            bottom: panel.py(cell.y.0).min(panel.rect.bottom),
        };
        if rect.right > rect.left && rect.bottom > rect.top {
            let colour = scale.colour(cell.seconds);
            figure.rect(rect, &format!("class=\"cell\" data-row=\"{index}\" fill=\"{colour}\" shape-rendering=\"crispEdges\""));
        }
    }
    figure.close();
}

/// Draws the key of the colours with its upper left corner at `at`: a heading, a strip and times in seconds. It is [`KEY_HEIGHT`] tall.
pub(in crate::charts) fn colour_key(
    figure: &mut Figure,
    at: (f64, f64),
    width: f64,
    scale: &DensityScale,
) {
    let (left, top) = at;
    figure.open("legend");
    let heading = if scale.log {
        "Time spent in a cell [s], logarithmic"
    } else {
        "Time spent in a cell [s]"
    };
    figure.text((left, top + TEXT), TEXT, Anchor::Start, "", INK, heading);
    let strip = Rect {
        left,
        right: left + width,
        top: top + 17.0,
        bottom: top + 29.0,
    };
    for k in 0..SLICES {
        let place = |k: usize| left + width * k as f64 / SLICES as f64;
        let colour = scale.colour(scale.seconds((k as f64 + 0.5) / SLICES as f64));
        let slice = Rect {
            left: place(k),
            right: place(k + 1),
            ..strip
        };
        figure.rect(
            slice,
            &format!("fill=\"{colour}\" shape-rendering=\"crispEdges\""),
        );
    }
    figure.rect(
        strip,
        &format!("fill=\"none\" stroke=\"{INK}\" stroke-width=\"2\""),
    );
    // From the end: the greatest time is what one looks for first.
    let mut free_to = f64::INFINITY;
    for seconds in scale.marks().into_iter().rev() {
        let x = left + width * scale.share(seconds);
        figure.line(
            (x, strip.bottom),
            (x, strip.bottom + 3.0),
            &format!("stroke=\"{INK}\" stroke-width=\"3\""),
        );
        let label = number(
            seconds,
            if scale.log {
                seconds.max(1e-4)
            } else {
                round_step(scale.high / 5.0)
            },
        );
        let half = 0.5 * text_width(&label, TEXT);
        if x + half + 4.0 < free_to {
            figure.text(
                (x, strip.bottom + 15.0),
                TEXT,
                Anchor::Middle,
                "",
                INK,
                &label,
            );
            free_to = x - half;
        }
    }
    figure.close();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_time_is_in_the_cells_and_borders_belong_to_one_cell() {
        let points = [
            (0.0, 0.0, 1.0),
            (9.99, 4.9, 0.5),
            (10.0, 5.0, 2.0),
            (-0.1, -5.0, 4.0),
            (f64::NAN, 0.0, 8.0),
            (1.0, 1.0, -1.0),
        ];
        let density = Density::gather((10.0, 5.0), points.into_iter());
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
    fn more_time_is_darker_and_marks_lie_on_the_key() {
        let light = |colour: &str| {
            let part =
                |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap_or(0));
            0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5)
        };
        for (scale, log) in [
            (DensityScale::new(0.1, 400.0), true),
            (DensityScale::new(1.0, 40.0), false),
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
    fn no_time_at_all_still_has_a_key() {
        let density = Density::gather((1.0, 1.0), std::iter::empty());
        let mut figure = Figure::new((300.0, 100.0), 10.0, "t", "", "");
        colour_key(&mut figure, (10.0, 50.0), 200.0, &density.scale());
        let svg = figure.finish();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
}
