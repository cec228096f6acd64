//! Plotters draws the frames of panels - grid, ticks, titles of the axes - on our own drawing surface.

use std::convert::Infallible;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use plotters::prelude::*;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingErrorKind,
};

use super::axis::Axis;
use super::chart::LEFT;
use super::panel::{BELOW, Panel};
use super::svg::{Svg, UNITS, units};
use super::text::text_width;

/// Text sizes, pixels.
const TICK_TEXT: f64 = 11.0;
const TITLE_TEXT: f64 = 12.0;
/// Room of a turned title, and the gap between labels and plot, pixels.
const TITLE_AND_GAP: f64 = 22.0;
/// Ratio of plotters' font sizes to those of SVG.
const FONT: f64 = 1.24;
/// Width of a letter, and depth of a line below its base, in heights of a letter.
const LETTER: f64 = 0.7;
const BELOW_LINE: f64 = 0.24;

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

/// The surface as a drawing backend of plotters; coordinates are canvas units.
struct Surface<'a>(&'a mut Svg);

impl DrawingBackend for Surface<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        (units(self.0.width) as u32, units(self.0.height) as u32)
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        let paint = format!("width=\"1\" height=\"1\" fill=\"{}\"", hex(color));
        self.0.element("rect", &[("x", &x), ("y", &y)], &paint);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        let points: Vec<String> = path.into_iter().map(|(x, y)| format!("{x},{y}")).collect();
        let (points, stroke) = (points.join(" "), hex(style.color()));
        let paint = format!(
            "fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{}\"",
            style.stroke_width()
        );
        if style.color().alpha > 0.0 {
            self.0.element("polyline", &[("points", &points)], &paint);
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Drawn {
        let size = style.size() / FONT;
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Right => "end",
            HPos::Center => "middle",
        };
        // From the anchor to the base line.
        let down = match style.anchor().v_pos {
            VPos::Top => 0.76 * size,
            VPos::Center => 0.27 * size,
            VPos::Bottom => -0.27 * size,
        };
        let down = down.round() as i32;
        let (x, y, turn) = match style.transform() {
            FontTransform::Rotate270 => (x + down, y, -90),
            FontTransform::Rotate90 => (x - down, y, 90),
            _ => (x, y + down, 0),
        };
        let mut paint = format!(
            "text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size:.0}\" fill=\"{}\"",
            hex(style.color())
        );
        if turn != 0 {
            paint += &format!(" transform=\"rotate({turn} {x} {y})\"");
        }
        if !text.is_empty() {
            self.0.text_element(&[("x", &x), ("y", &y)], &paint, text);
        }
        Ok(())
    }

    /// Estimates as plotters does without a font; in a browser it would ask the page, which a chart there cannot see.
    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Infallible>> {
        let em = style.size() / FONT / FONT;
        let wide = (LETTER * em * text.len() as f64).round();
        let tall = em.round() + (BELOW_LINE * em).round();
        Ok((wide as u32, tall as u32))
    }
}

fn hex(color: BackendColor) -> String {
    let (r, g, b) = color.rgb;
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Draws grid, ticks and titles of a panel.
pub(super) fn frame(svg: &mut Svg, panel: &Panel) {
    // Drawing into a text cannot fail; without a frame the data would still show.
    let _ = try_frame(svg, panel);
}

/// Room for the labels of the vertical axis, its turned title and the gap to the plot, pixels.
pub(super) fn axis_width(panel: &Panel) -> f64 {
    let labels = panel.y.ticks.iter();
    let widest = labels.map(|(_, text)| text_width(text, TICK_TEXT));
    widest.fold(0.0, f64::max) + TITLE_AND_GAP
}

fn try_frame(svg: &mut Svg, panel: &Panel) -> Result<(), Box<dyn std::error::Error>> {
    let below = if panel.x_labels {
        units(BELOW) as i32
    } else {
        0
    };
    let rect = panel.rect;
    let left = LEFT.max(axis_width(panel)).min(rect.left);
    let corner = (units(rect.left - left) as i32, units(rect.top) as i32);
    let size = (
        units(rect.right) as i32 - corner.0,
        units(rect.bottom) as i32 - corner.1 + below,
    );
    let surface = Surface(svg).into_drawing_area();
    let area = surface.shrink(corner, size);
    let mut builder = ChartBuilder::on(&area);
    builder
        .y_label_area_size(units(left) as i32)
        .x_label_area_size(below);
    let mut chart = builder.build_cartesian_2d(Scale(&panel.x), Scale(&panel.y))?;
    // Plotters truncates sizes to whole numbers.
    let text = |size: f64| ("sans-serif", (size * UNITS * FONT).ceil());
    let mut mesh = chart.configure_mesh();
    mesh.max_light_lines(0)
        .bold_line_style(ShapeStyle::from(&RGBColor(222, 222, 222)).stroke_width(2))
        .axis_style(ShapeStyle::from(&BLACK).stroke_width(2))
        .set_all_tick_mark_size(units(4.0) as i32)
        .label_style(text(TICK_TEXT))
        .axis_desc_style(text(TITLE_TEXT))
        .y_desc(panel.y.title.clone());
    if panel.x_labels {
        mesh.x_desc(panel.x.title.clone());
    }
    mesh.draw()?;
    Ok(())
}

/// An axis for plotters, with our ticks and labels.
struct Scale<'a>(&'a Axis);

impl Ranged for Scale<'_> {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        from + (self.0.share(*value) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Light points would become lines between the ticks.
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.0.ticks.iter().map(|(value, _)| *value).collect()
        }
    }

    fn range(&self) -> std::ops::Range<f64> {
        self.0.low..self.0.high
    }
}

impl ValueFormatter<f64> for Scale<'_> {
    fn format_ext(&self, value: &f64) -> String {
        let tick = self
            .0
            .ticks
            .iter()
            .find(|(tick, _)| tick.to_bits() == value.to_bits());
        tick.map_or_else(String::new, |(_, label)| label.clone())
    }
}
