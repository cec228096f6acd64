//! Lines and fills distinguishable in black and white and by the colour-blind.

use super::svg::{Svg, UNITS};
use cvtcycle_model::transmission::component::{Fill as Place, LossGroup};
use cvtcycle_output::Component;

/// Colour of text and of frames.
pub(crate) const INK: &str = "#000000";
/// Colour of context.
pub(crate) const QUIET: &str = "#555555";

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    /// Colour.
    pub colour: &'static str,
    /// Width, pixels.
    pub width: f64,
    /// Dash pattern, pixels; empty for a solid line.
    pub dash: &'static [f64],
}

/// A line of a colour, a width and a dash pattern in pixels.
pub(crate) const fn stroke(colour: &'static str, width: f64, dash: &'static [f64]) -> Stroke {
    Stroke {
        colour,
        width,
        dash,
    }
}

/// The line of a plot with one series.
pub(crate) const PLAIN: Stroke = stroke("#1f3b73", 1.3, &[]);
/// A line that is only context.
pub(crate) const CONTEXT: Stroke = stroke("#777777", 1.0, &[]);
/// A line at zero.
pub(crate) const ZERO: Stroke = stroke(INK, 0.8, &[]);
/// A line between groups of rows.
pub(crate) const RULE: Stroke = stroke("#dedede", 0.5, &[]);

/// Lines of a plot with several series: each differs in colour, lightness and dashes.
pub(crate) const STROKES: [Stroke; 7] = [
    stroke(INK, 2.2, &[]),
    stroke("#d55e00", 1.5, &[]),
    stroke("#0072b2", 1.9, &[9.0, 4.0]),
    stroke("#009e73", 1.9, &[9.0, 3.0, 2.0, 3.0]),
    stroke("#aa4499", 1.7, &[4.0, 2.5]),
    stroke("#666666", 2.0, &[1.5, 2.5]),
    stroke("#4b2991", 1.5, &[14.0, 3.0, 2.0, 3.0, 2.0, 3.0]),
];

/// Colours of an ordered quantity from its minimum to its maximum: blue over purple to orange, and ever lighter.
const ORDERED: [&str; 7] = [
    "#1d3a8f", "#4b3a9c", "#79349a", "#a0338a", "#c23f6d", "#d6574a", "#dc7423",
];
/// Colour of published or measured numbers in every figure.
pub(crate) const PUBLISHED: &str = "#a3311c";

/// Meaning of the colours of the lines of a figure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Things of different kinds.
    #[default]
    Kinds,
    /// Cars, the subject first.
    Cars,
    /// Values of one quantity in ascending order, such as temperatures.
    Ordered,
}

impl Palette {
    /// Line style `index` of `count`.
    pub(crate) fn stroke(self, index: usize, count: usize) -> Stroke {
        let of_kind = STROKES[index % STROKES.len()];
        match self {
            Palette::Kinds => of_kind,
            Palette::Cars => stroke(CARS[index % CARS.len()], 2.0, of_kind.dash),
            Palette::Ordered => stroke(ordered(index, count), 1.8, of_kind.dash),
        }
    }
}

/// Colour of a value of an ordered quantity by its rank `index` of `count`.
pub(crate) fn ordered(index: usize, count: usize) -> &'static str {
    let last = count.saturating_sub(1).max(1);
    ORDERED[(index * (ORDERED.len() - 1) + last / 2) / last % ORDERED.len()]
}

impl Stroke {
    fn attributes(&self) -> String {
        let mut text = format!(
            "stroke=\"{}\" stroke-width=\"{:.1}\" stroke-linejoin=\"round\"",
            self.colour,
            self.width * UNITS
        );
        if !self.dash.is_empty() {
            let dashes = self.dash.iter().map(|d| format!("{:.0}", d * UNITS));
            let dashes: Vec<String> = dashes.collect();
            text += &format!(" stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        text
    }
}

/// Anchors of a ramp of colours.
type Ramp = &'static [(f64, f64, f64)];

/// Ramp of evenly rising lightness, also for the colour-blind.
const RAMP: Ramp = &[
    (52.0, 20.0, 94.0),
    (69.0, 74.0, 139.0),
    (49.0, 113.0, 145.0),
    (36.0, 149.0, 139.0),
    (75.0, 187.0, 112.0),
    (155.0, 217.0, 75.0),
    (245.0, 230.0, 90.0),
];

/// A second ramp of the same kind, for the parts of a manual box next to those of a CVT.
const WARM: Ramp = &[
    (82.0, 8.0, 24.0),
    (152.0, 38.0, 18.0),
    (208.0, 88.0, 28.0),
    (238.0, 156.0, 62.0),
    (250.0, 222.0, 150.0),
];

/// Diverging palette from -1 over 0 to 1: blue, white, brown, distinguishable by the colour-blind, and darker with magnitude.
pub(crate) const DIVERGING: Ramp = &[
    (5.0, 80.0, 150.0),
    (125.0, 180.0, 220.0),
    (247.0, 247.0, 247.0),
    (243.0, 175.0, 105.0),
    (160.0, 72.0, 5.0),
];

/// Colour of an area above or below zero: the two sides of the signed palette.
pub(crate) fn signed_colour(more: bool) -> String {
    between(DIVERGING, if more { 0.82 } else { 0.18 })
}

/// Colour of the ramp at a share of 0 to 1.
pub(crate) fn ramp(share: f64) -> String {
    between(RAMP, share)
}

/// Colour between anchors at a share of 0 to 1.
pub(crate) fn between(anchors: &[(f64, f64, f64)], share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (anchors.len() - 1) as f64;
    let cell = (place.floor() as usize).min(anchors.len() - 2);
    let (a, b, t) = (anchors[cell], anchors[cell + 1], place - cell as f64);
    let mix = |a: f64, b: f64| (a + (b - a) * t).round() as u8;
    let [red, green, blue] = [mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2)];
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Colours of cars, the subject first and strongest.
const CARS: [&str; 5] = ["#0b5a8c", "#d58a3c", "#8f8f8f", "#7a4f8f", "#5f8f5a"];

/// Colour of a line for a group of losses, in the hues of [`Fill::component`].
pub(crate) fn group_line(group: LossGroup) -> &'static str {
    match group {
        LossGroup::Launch => "#4b2991",
        LossGroup::Pump => "#1f3b73",
        LossGroup::Shafts => "#0072b2",
        LossGroup::Belt => "#009e73",
        LossGroup::FinalDrive => "#b38600",
        LossGroup::Gears => "#a3311c",
        LossGroup::BearingsAndSeals => "#d55e00",
        LossGroup::Churning => "#b98b66",
    }
}

/// Fill of an area: a colour, and a hatch that distinguishes it from its neighbours in print.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Fill {
    colour: String,
    /// Number of the hatch; zero for none.
    hatch: usize,
    /// True for a white hatch.
    dark: bool,
}

impl Fill {
    /// A plain colour.
    pub fn plain(colour: &str) -> Self {
        Fill {
            colour: colour.to_owned(),
            hatch: 0,
            dark: false,
        }
    }

    /// The fill of a car by its place in the run, the same in every picture.
    pub fn car(index: usize) -> Self {
        Fill {
            colour: CARS[index % CARS.len()].to_owned(),
            hatch: index / CARS.len(),
            dark: false,
        }
    }

    /// Fill `index` of `count`: lightness rises with the index; neighbours also differ in their hatch.
    pub fn nth(index: usize, count: usize) -> Self {
        let last = count.saturating_sub(1) as f64;
        let share = if last > 0.0 { index as f64 / last } else { 0.4 };
        Fill::hatched(RAMP, share, index)
    }

    /// The fill of a component, the same in every picture: within a car lightness rises in the order of the power flow.
    pub fn component(component: Component) -> Self {
        let (anchors, index, last) = match component.fill() {
            Place::Cvt(place) => (RAMP, usize::from(place), 12.0),
            Place::Manual(place) => (WARM, usize::from(place), 4.0),
        };
        Fill::hatched(anchors, index as f64 / last, index)
    }

    fn hatched(anchors: Ramp, share: f64, index: usize) -> Self {
        Fill {
            colour: between(anchors, share),
            hatch: index % 5,
            dark: share < 0.55,
        }
    }

    /// SVG paint; a hatch is defined on first use.
    fn paint(&self, svg: &mut Svg) -> String {
        let marks = match self.hatch {
            0 => return self.colour.clone(),
            1 => "<path d=\"M-6 6L6 -6M0 24L24 0M18 30L30 18\"/>",
            2 => "<path d=\"M5 6h2M17 18h2\" stroke-linecap=\"round\" stroke-width=\"6\"/>",
            3 => "<path d=\"M-6 18L6 30M0 0L24 24M18 -6L30 6\"/>",
            _ => "<path d=\"M0 6H24M0 18H24\"/>",
        };
        let (base, ink) = (&self.colour, if self.dark { "#ffffff" } else { INK });
        let id = format!("hatch-{}-{}", self.hatch, base.trim_start_matches('#'));
        svg.define(&id, || format!(
            "<pattern id=\"{id}\" width=\"24\" height=\"24\" patternUnits=\"userSpaceOnUse\">\
             <rect width=\"24\" height=\"24\" fill=\"{base}\"/>\
             <g stroke=\"{ink}\" stroke-opacity=\"0.7\" stroke-width=\"2\" fill=\"none\">{marks}</g></pattern>\n"
        ));
        format!("url(#{id})")
    }
}

/// Colours, lines and meaning of a shape.
#[derive(Clone, Debug, Default)]
pub(crate) struct Style {
    pub fill: Option<Fill>,
    /// Opacity of the fill; zero is full.
    pub fill_opacity: f64,
    pub stroke: Option<Stroke>,
    /// Opacity of the stroke; zero is full.
    pub stroke_opacity: f64,
    /// True for edges that must not be anti-aliased.
    pub crisp: bool,
    /// Class for the style sheet and for tests; may be empty.
    pub class: &'static str,
    /// Row of the table with its numbers.
    pub row: Option<usize>,
}

impl Style {
    /// A line.
    pub fn line(stroke: Stroke) -> Self {
        Style {
            stroke: Some(stroke),
            ..Style::default()
        }
    }

    /// A filled area without an edge.
    pub fn fill(fill: Fill) -> Self {
        Style {
            fill: Some(fill),
            ..Style::default()
        }
    }

    /// An area of a plain colour.
    pub fn colour(colour: &str) -> Self {
        Style::fill(Fill::plain(colour))
    }

    /// A filled area with a black edge of a width in pixels.
    pub fn edged(fill: Fill, width: f64) -> Self {
        Style::fill(fill).edge(stroke(INK, width, &[]))
    }

    pub fn class(mut self, class: &'static str) -> Self {
        self.class = class;
        self
    }

    pub fn row(mut self, row: usize) -> Self {
        self.row = Some(row);
        self
    }

    pub fn fill_opacity(mut self, opacity: f64) -> Self {
        self.fill_opacity = opacity;
        self
    }

    pub fn stroke_opacity(mut self, opacity: f64) -> Self {
        self.stroke_opacity = opacity;
        self
    }

    /// Adds an edge.
    pub fn edge(mut self, stroke: Stroke) -> Self {
        self.stroke = Some(stroke);
        self
    }

    pub fn crisp(mut self) -> Self {
        self.crisp = true;
        self
    }

    /// SVG attributes.
    pub fn attributes(&self, svg: &mut Svg) -> String {
        let mut text = marks(self.class, self.row);
        let fill = self.fill.as_ref().map(|fill| fill.paint(svg));
        text += &format!("fill=\"{}\"", fill.as_deref().unwrap_or("none"));
        if self.fill_opacity > 0.0 {
            text += &format!(" fill-opacity=\"{}\"", self.fill_opacity);
        }
        if let Some(stroke) = &self.stroke {
            text += " ";
            text += &stroke.attributes();
            if stroke.dash.is_empty() && self.fill.is_none() {
                text += " stroke-linecap=\"round\"";
            }
        }
        if self.stroke_opacity > 0.0 {
            text += &format!(" stroke-opacity=\"{}\"", self.stroke_opacity);
        }
        if self.crisp {
            text += " shape-rendering=\"crispEdges\"";
        }
        text
    }
}

/// The attributes of a class and of a row of the table.
pub(super) fn marks(class: &str, row: Option<usize>) -> String {
    let mut text = String::new();
    if !class.is_empty() {
        text += &format!("class=\"{class}\" ");
    }
    if let Some(row) = row {
        text += &format!("data-row=\"{row}\" ");
    }
    text
}
