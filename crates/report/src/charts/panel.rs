//! One pair of axes and what is drawn between them.
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;

use super::axis::Axis;
use super::figure::{Anchor, Figure, INK, Path, QUIET, Rect, UNITS, units};
use super::style::Stroke;

/// Room left of a plot for its axis, pixels.
pub(super) const LEFT: f64 = 66.0;
/// Room below a plot for its axis, pixels.
pub(super) const BELOW: f64 = 40.0;
/// Text sizes, pixels.
const TICK_TEXT: f64 = 11.0;
const TITLE_TEXT: f64 = 12.0;
/// Plotters divides font sizes by this before it writes them.
const FONT: f64 = 1.24;

/// Axes in their place.
pub(super) struct Panel {
    /// Where the data go.
    pub rect: Rect,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Whether the first column of the picture's table is the horizontal axis.
    of_table: bool,
}

impl Panel {
    /// Draws grid, ticks and titles. The horizontal ticks and title are left out of a panel that
    /// shares them with the one below.
    pub fn draw(figure: &mut Figure, rect: Rect, x: Axis, y: Axis, with_x: bool) -> Self {
        Self::drawn(
            figure,
            Panel {
                rect,
                x,
                y,
                of_table: false,
            },
            with_x,
        )
    }

    /// The same, of a picture whose table has the horizontal axis as its first column: the frame tells its ends.
    pub fn over_table(figure: &mut Figure, rect: Rect, x: Axis, y: Axis, with_x: bool) -> Self {
        Self::drawn(
            figure,
            Panel {
                rect,
                x,
                y,
                of_table: true,
            },
            with_x,
        )
    }

    fn drawn(figure: &mut Figure, panel: Self, with_x: bool) -> Self {
        let mut svg = String::new();
        // Writing SVG into a String has no way to fail; the data would still show without a frame.
        if panel.frame(&mut svg, figure.size(), with_x).is_ok() {
            let start = svg
                .find("<svg")
                .and_then(|at| svg[at..].find('>').map(|end| at + end + 1));
            let end = svg.rfind("</svg>");
            if let Some(elements) = start.zip(end).and_then(|(start, end)| svg.get(start..end)) {
                figure.raw(elements.trim());
            }
        }
        panel.outline(figure);
        panel
    }

    /// The border of the plot, again, for areas and lines cover the half of the axis lines.
    pub fn outline(&self, figure: &mut Figure) {
        let ends = if self.of_table {
            format!(
                " data-x0=\"{:?}\" data-x1=\"{:?}\"",
                self.x.low, self.x.high
            )
        } else {
            String::new()
        };
        let attributes =
            format!("class=\"plot\" fill=\"none\" stroke=\"{INK}\" stroke-width=\"3\"{ends}");
        figure.rect(self.rect, &attributes);
    }

    fn frame(
        &self,
        svg: &mut String,
        (width, height): (f64, f64),
        with_x: bool,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let backend = SVGBackend::with_string(svg, (units(width) as u32, units(height) as u32));
        let below = if with_x { units(BELOW) as i32 } else { 0 };
        let rect = self.rect;
        let corner = (units(rect.left - LEFT) as i32, units(rect.top) as i32);
        let size = (
            units(rect.right) as i32 - corner.0,
            units(rect.bottom) as i32 - corner.1 + below,
        );
        let area = backend.into_drawing_area().shrink(corner, size);
        let mut builder = ChartBuilder::on(&area);
        builder
            .y_label_area_size(units(LEFT) as i32)
            .x_label_area_size(below);
        let mut chart = builder.build_cartesian_2d(Scale(&self.x), Scale(&self.y))?;
        // Plotters takes whole sizes and drops the rest.
        let text = |size: f64| ("sans-serif", (size * UNITS * FONT).ceil());
        let mut mesh = chart.configure_mesh();
        mesh.max_light_lines(0)
            .bold_line_style(ShapeStyle::from(&RGBColor(222, 222, 222)).stroke_width(2))
            .axis_style(ShapeStyle::from(&BLACK).stroke_width(2))
            .set_all_tick_mark_size(units(4.0) as i32)
            .label_style(text(TICK_TEXT))
            .axis_desc_style(text(TITLE_TEXT))
            .y_desc(self.y.title.clone());
        if with_x {
            mesh.x_desc(self.x.title.clone());
        }
        mesh.draw()?;
        area.present()?;
        Ok(())
    }

    /// Where a value of the horizontal axis lies, pixels.
    pub fn px(&self, x: f64) -> f64 {
        self.rect.left + self.x.share(x) * (self.rect.right - self.rect.left)
    }

    /// Where a value of the vertical axis lies, pixels.
    pub fn py(&self, y: f64) -> f64 {
        self.rect.bottom - self.y.share(y) * (self.rect.bottom - self.rect.top)
    }

    /// Draws a line through points of rising x, with gaps where values are not finite.
    pub fn line(&self, figure: &mut Figure, points: &[(f64, f64)], stroke: Stroke) {
        let mut path = Path::default();
        for part in points.split(|(x, y)| !x.is_finite() || !y.is_finite()) {
            let pixels: Vec<_> = part
                .iter()
                .map(|&(x, y)| (self.px(x), self.py(y)))
                .collect();
            for (i, (x, y)) in thinned(&pixels).into_iter().enumerate() {
                if i == 0 {
                    path.move_to(x, y);
                } else {
                    path.line_to(x, y);
                }
            }
        }
        let data = path.finish();
        if data.is_empty() {
            return;
        }
        let attributes = stroke.attributes();
        figure.raw(&format!(
            "<path class=\"series\" d=\"{data}\" {attributes}/>"
        ));
    }

    /// Draws a line through points in any order of x, all of them.
    pub fn line_any(&self, figure: &mut Figure, points: &[(f64, f64)], stroke: Stroke) {
        let mut path = Path::default();
        for &(x, y) in points {
            path.line_to(self.px(x), self.py(y));
        }
        let (data, attributes) = (path.finish(), stroke.attributes());
        figure.raw(&format!("<path d=\"{data}\" {attributes}/>"));
    }

    /// Says that there is nothing to see.
    pub fn empty(&self, figure: &mut Figure) {
        let at = (
            0.5 * (self.rect.left + self.rect.right),
            0.5 * (self.rect.top + self.rect.bottom) + 4.0,
        );
        figure.text(at, 12.0, Anchor::Middle, "", QUIET, "no data");
    }
}

/// An axis as plotters wants it: with our ticks and labels, for its own print as `60.0`.
struct Scale<'a>(&'a Axis);

impl Ranged for Scale<'_> {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.0.share(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Light points would be lines between the ticks.
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.0.ticks.clone()
        }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.0.low..self.0.high
    }
}

impl ValueFormatter<f64> for Scale<'_> {
    fn format_ext(&self, value: &f64) -> String {
        self.0.label(*value)
    }
}

/// Points that look the same: of each column of pixels the first, lowest, highest and last.
fn thinned(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut kept = Vec::new();
    for column in points.chunk_by(|a, b| a.0.floor().total_cmp(&b.0.floor()).is_eq()) {
        if column.len() <= 4 {
            kept.extend_from_slice(column);
            continue;
        }
        let last = column.len() - 1;
        let by_y = |&i: &usize, &j: &usize| column[i].1.total_cmp(&column[j].1);
        let low = (0..=last).min_by(by_y).unwrap_or(0);
        let high = (0..=last).max_by(by_y).unwrap_or(last);
        let mut chosen = [0, low.min(high), low.max(high), last].to_vec();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|i| column[i]));
    }
    kept
}
