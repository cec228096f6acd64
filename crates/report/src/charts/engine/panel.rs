//! Panels: a pair of axes and the shapes between them; panels of rows with names at the left.

use super::axis::Axis;
use super::place::{End, Label, Place, at};
use super::style::{INK, Stroke, Style, stroke};
use super::svg::{Point, Rect};
use super::symbol::Symbol;
use super::text::{Cut, text_width};

/// Room below a plot for its axis, pixels.
pub(crate) const BELOW: f64 = 40.0;
/// Room of a panel of rows above the first and below the last one, pixels.
pub(super) const PAD: f64 = 3.0;

/// A pair of axes and the shapes between them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    pub heading: String,
    pub rect: Rect,
    pub x: Axis,
    pub y: Axis,
    /// True if grid, ticks and a border are drawn.
    pub framed: bool,
    /// True if ticks and title of the horizontal axis are written: false in a panel that shares them with the one below.
    pub x_labels: bool,
    /// True if the first column of the table is the horizontal axis.
    pub over_table: bool,
    /// Columns of the table that the panel draws; all if empty.
    pub columns: Vec<usize>,
    /// True to write that there are no data.
    pub no_data: bool,
    /// Room below the panel, pixels.
    pub below: f64,
    /// Height of a row of a panel of rows, pixels.
    pub pitch: Option<f64>,
    /// Names of lines at their right ends, and above the places where lines leave the panel.
    pub ends: Vec<End>,
    pub above: Vec<End>,
    /// True if names of lines lie on cells.
    pub on_cells: bool,
    /// Shapes, the first at the bottom.
    pub items: Vec<Item>,
}

impl Panel {
    pub fn new(rect: Rect, x: Axis, y: Axis) -> Self {
        Panel {
            rect,
            x,
            y,
            framed: true,
            x_labels: true,
            below: BELOW + 8.0,
            ..Panel::default()
        }
    }

    pub fn heading(mut self, heading: impl Into<String>) -> Self {
        self.heading = heading.into();
        self
    }

    /// The first column of the table is the horizontal axis.
    pub fn over_table(mut self) -> Self {
        self.over_table = true;
        self
    }

    pub fn x_labels(mut self, x_labels: bool) -> Self {
        self.x_labels = x_labels;
        self
    }

    pub fn no_data(mut self, no_data: bool) -> Self {
        self.no_data = no_data;
        self
    }

    pub fn below(mut self, below: f64) -> Self {
        self.below = below;
        self
    }

    pub fn add(&mut self, shape: Shape, style: Style) {
        self.items.push(Item { shape, style });
    }

    /// Adds a line of data.
    pub fn series(&mut self, points: Vec<Point>, stroke: Stroke) {
        self.add(Shape::Line(points), Style::line(stroke).class("series"));
    }

    /// Adds a straight line.
    pub fn segment(&mut self, from: Place, to: Place, style: Style) {
        self.add(Shape::Segment(from, to), style);
    }

    /// Adds a rectangle between two corners, clipped to the panel.
    pub fn rectangle(&mut self, from: Place, to: Place, style: Style) {
        self.add(Shape::Rect(from, to), style);
    }

    /// Adds a horizontal line from edge to edge.
    pub fn level(&mut self, y: f64, stroke: Stroke) {
        let ends = [f64::NEG_INFINITY, f64::INFINITY].map(|x| at(x, y));
        self.segment(ends[0], ends[1], Style::line(stroke));
    }

    /// Adds a vertical line from edge to edge.
    pub fn upright(&mut self, x: f64, stroke: Stroke) {
        let ends = [f64::NEG_INFINITY, f64::INFINITY].map(|y| at(x, y));
        self.segment(ends[0], ends[1], Style::line(stroke));
    }

    /// Adds a symbol with a radius in pixels.
    pub fn symbol(&mut self, symbol: Symbol, place: Place, radius: f64, style: Style) {
        self.add(Shape::Symbol(symbol, place, radius), style);
    }

    /// Adds text.
    pub fn label(&mut self, label: Label) {
        self.add(Shape::Label(label), Style::default());
    }

    /// Pixel position of a value of the horizontal axis; infinite ones are placed on the edge.
    pub fn px(&self, x: f64) -> f64 {
        let rect = self.rect;
        match x {
            f64::NEG_INFINITY => rect.left,
            f64::INFINITY => rect.right,
            x => rect.left + self.x.share(x) * rect.width(),
        }
    }

    /// Pixel position of a value of the vertical axis; infinite ones are placed on the edge.
    pub fn py(&self, y: f64) -> f64 {
        let rect = self.rect;
        match y {
            f64::NEG_INFINITY => rect.bottom,
            f64::INFINITY => rect.top,
            y => rect.bottom - self.y.share(y) * rect.height(),
        }
    }

    /// Converts a point to pixels.
    pub fn pixel(&self, (x, y): Point) -> Point {
        (self.px(x), self.py(y))
    }

    /// Writes the name of a row to the left of the panel, cut in its middle.
    pub fn row_name(&mut self, row: usize, mut name: Label) {
        name.at = at(f64::NEG_INFINITY, row_middle(row)).shift(-8.0, 4.0);
        let room = self.rect.left - 16.0;
        self.label(name.end().cut(Cut::Middle, room));
    }

    /// Adds a bar from one value to another between two heights in pixels from the middle of the row.
    pub fn bar(&mut self, row: usize, (from, to): Point, (top, bottom): Point, style: Style) {
        let corner = |x: f64, dy: f64| at(x, row_middle(row)).shift(0.0, dy);
        self.rectangle(corner(from, top), corner(to, bottom), style.class("bar"));
    }

    /// Adds an interval with end marks, on a pale line that shows it on dark fills too.
    pub fn whisker(&mut self, row: usize, [low, high]: [f64; 2], dy: f64, table_row: usize) {
        let place = |x: f64, more: f64| at(x, row_middle(row)).shift(0.0, dy + more);
        for (colour, width, class) in [("#ffffff", 2.25, ""), (INK, 1.25, "interval")] {
            let line = Style::line(stroke(colour, width, &[]));
            let style = line.class(class).row(table_row);
            self.segment(place(low, 0.0), place(high, 0.0), style.clone());
            for x in [low, high] {
                self.segment(place(x, -3.0), place(x, 3.0), style.clone());
            }
        }
    }
}

/// A panel without a frame whose axes are pixels of the picture.
pub(crate) fn free(rect: Rect) -> Panel {
    let x = Axis::bare(rect.left, rect.right);
    let mut panel = Panel::new(rect, x, Axis::bare(rect.bottom, rect.top)).below(14.0);
    panel.framed = false;
    panel
}

/// Rectangles of panels of a size in rows of `columns` below each other, from an upper left corner and with a pitch.
pub(crate) fn grid(
    (left, top): Point,
    (width, height): Point,
    pitch: Point,
    columns: usize,
) -> impl Fn(usize) -> Rect {
    move |k| {
        let (column, row) = ((k % columns) as f64, (k / columns) as f64);
        Rect::new(left + pitch.0 * column, top + pitch.1 * row, width, height)
    }
}

/// A panel of `count` rows of a pitch in pixels between an upper left corner and a right edge. Its vertical axis counts the rows from the top;
/// the middle of the first one is at 0.5.
pub(crate) fn rows_panel(
    (left, top): Point,
    right: f64,
    count: usize,
    pitch: f64,
    x: Axis,
) -> Panel {
    let rows = count.max(1) as f64;
    let rect = Rect::new(left, top, right - left, rows * pitch + 2.0 * PAD);
    let pad = PAD / pitch;
    let mut panel = Panel::new(rect, x, Axis::bare(rows + pad, -pad));
    panel.pitch = Some(pitch);
    panel
}

/// Left edge of rows with names, pixels: room for the longest name, up to a limit.
pub(crate) fn rows_left<'n>(names: impl Iterator<Item = &'n str>, size: f64) -> f64 {
    let widest = names.map(|name| text_width(name, size)).fold(0.0, f64::max);
    (widest + 24.0).clamp(74.0, 430.0)
}

/// Middle of a row on the vertical axis.
pub(crate) fn row_middle(row: usize) -> f64 {
    row as f64 + 0.5
}

/// A shape and its look.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub shape: Shape,
    pub style: Style,
}

/// A drawable shape. Shapes at positions that are not finite are omitted.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// A line with gaps where values are not finite.
    Line(Vec<Point>),
    /// Closed polygons.
    Area(Vec<Vec<Point>>),
    /// A straight line.
    Segment(Place, Place),
    /// A rectangle between two corners, clipped to the panel.
    Rect(Place, Place),
    /// A ribbon between two upper ends of a height in pixels.
    Ribbon(Point, Point, f64),
    /// A symbol with a radius in pixels.
    Symbol(Symbol, Place, f64),
    Label(Label),
    /// Shapes clipped to a polygon, or to the panel.
    Within(Option<Vec<Point>>, Vec<Item>),
}

impl Shape {
    /// The area between two lines with common abscissae: position, lower and upper end.
    pub fn between(points: &[(f64, f64, f64)]) -> Self {
        let upper = points.iter().map(|(x, _, high)| (*x, *high));
        let lower = points.iter().rev().map(|(x, low, _)| (*x, *low));
        Shape::Area(vec![upper.chain(lower).collect()])
    }
}
