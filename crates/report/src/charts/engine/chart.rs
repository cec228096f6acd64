//! A picture as data.

use super::axis::Axis;
use super::place::{Label, Place, at};
use super::style::{Fill, Stroke, Style};
use super::svg::{Point, Rect};
use super::symbol::Symbol;
use crate::charts::picture::PictureTable;

/// Width of a picture: on A4 its text can still be read, pixels.
pub(crate) const WIDTH: f64 = 880.0;
/// Room left of a plot for its axis, pixels.
pub(crate) const LEFT: f64 = 66.0;
/// Room below a plot for its axis, pixels.
pub(crate) const BELOW: f64 = 40.0;
/// Left edge of the first plot of a picture, pixels.
pub(crate) const PLOT_LEFT: f64 = LEFT + 8.0;

/// A picture: panels, legends and notes below them, and the numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chart {
    pub title: String,
    /// Of what, and under which conditions; may be empty.
    pub subject: String,
    /// The picture in words, for those who cannot see it.
    pub description: String,
    /// Where the title begins, pixels.
    pub left: f64,
    /// Width, pixels; zero is [`WIDTH`].
    pub width: f64,
    pub panels: Vec<Panel>,
    /// Legends with a place of their own.
    pub sides: Vec<Side>,
    /// What follows below the panels, from the top.
    pub foot: Vec<Block>,
    pub table: PictureTable,
}

/// A legend of one column with a place of its own; names may take two lines.
#[derive(Clone, Debug, Default)]
pub(crate) struct Side {
    /// Upper left corner and width, pixels.
    pub corner: Point,
    pub width: f64,
    pub heading: String,
    pub entries: Vec<Entry>,
}

/// A pair of axes and what is drawn between them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Panel {
    pub heading: String,
    pub rect: Rect,
    pub x: Axis,
    pub y: Axis,
    /// Whether grid, ticks and a border are drawn.
    pub framed: bool,
    /// Whether ticks and title of the horizontal axis are written: not in a panel that shares them with the one below.
    pub x_labels: bool,
    /// Whether the first column of the table is the horizontal axis.
    pub over_table: bool,
    /// Columns of the table that the panel draws; all if empty.
    pub columns: Vec<usize>,
    /// Whether to write that there are no data.
    pub no_data: bool,
    /// Room below the panel, pixels.
    pub below: f64,
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

    pub fn add(&mut self, shape: Shape, style: Style) {
        self.items.push(Item { shape, style });
    }

    /// Adds a line of data.
    pub fn series(&mut self, points: Vec<Point>, stroke: Stroke) {
        self.add(Shape::Line(points), Style::line(stroke).class("series"));
    }

    /// Adds a line at a height from edge to edge.
    pub fn level(&mut self, y: f64, stroke: Stroke) {
        let ends = (at(f64::NEG_INFINITY, y), at(f64::INFINITY, y));
        self.add(Shape::Segment(ends.0, ends.1), Style::line(stroke));
    }

    /// Adds a line at a place of the horizontal axis from edge to edge.
    pub fn upright(&mut self, x: f64, stroke: Stroke) {
        let ends = (at(x, f64::NEG_INFINITY), at(x, f64::INFINITY));
        self.add(Shape::Segment(ends.0, ends.1), Style::line(stroke));
    }

    /// Adds a symbol with a radius in pixels.
    pub fn symbol(&mut self, symbol: Symbol, place: Place, radius: f64, style: Style) {
        self.add(Shape::Symbol(symbol, place, radius), style);
    }

    /// Adds text.
    pub fn label(&mut self, label: Label) {
        self.add(Shape::Label(label), Style::default());
    }

    /// Where a value of the horizontal axis lies, pixels; infinite ones lie on the edge.
    pub fn px(&self, x: f64) -> f64 {
        let rect = self.rect;
        match x {
            f64::NEG_INFINITY => rect.left,
            f64::INFINITY => rect.right,
            x => rect.left + self.x.share(x) * rect.width(),
        }
    }

    /// Where a value of the vertical axis lies, pixels; infinite ones lie on the edge.
    pub fn py(&self, y: f64) -> f64 {
        let rect = self.rect;
        match y {
            f64::NEG_INFINITY => rect.bottom,
            f64::INFINITY => rect.top,
            y => rect.bottom - self.y.share(y) * rect.height(),
        }
    }
}

/// A panel without a frame whose axes are pixels of the picture.
pub(crate) fn free(rect: Rect) -> Panel {
    let (x, y) = (
        Axis::bare(rect.left, rect.right),
        Axis::bare(rect.bottom, rect.top),
    );
    Panel {
        framed: false,
        below: 14.0,
        ..Panel::new(rect, x, y)
    }
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

/// A shape and its look.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub shape: Shape,
    pub style: Style,
}

/// What a panel can show. Shapes at places that are not finite are left out.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// A line with gaps where values are not finite.
    Line(Vec<Point>),
    /// Closed polygons.
    Area(Vec<Vec<Point>>),
    /// A straight line.
    Segment(Place, Place),
    /// A rectangle between two corners, as far as it lies in the panel.
    Rect(Place, Place),
    /// A ribbon between two upper ends of a height in pixels.
    Ribbon(Point, Point, f64),
    /// A symbol with a radius in pixels.
    Symbol(Symbol, Place, f64),
    Label(Label),
    /// Shapes as far as they lie within a polygon, or else within the panel.
    Within(Option<Vec<Point>>, Vec<Item>),
}

impl Shape {
    /// The area between two lines over common places: place, lower and upper end.
    pub fn between(points: &[(f64, f64, f64)]) -> Self {
        let upper = points.iter().map(|(x, _, high)| (*x, *high));
        let lower = points.iter().rev().map(|(x, low, _)| (*x, *low));
        Shape::Area(vec![upper.chain(lower).collect()])
    }
}

/// A part of what follows below the panels.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Left edge and width, pixels.
    pub left: f64,
    pub width: f64,
    /// Whether the next block lies to the right of it, not below.
    pub before_next: bool,
    pub content: Content,
}

#[derive(Clone, Debug)]
pub(crate) enum Content {
    /// A legend with a heading, which may be empty.
    Legend(String, Vec<Entry>),
    /// A strip that explains colours.
    Key(Key),
    /// Remarks, each from a line of its own.
    Notes(Vec<String>),
}

impl Block {
    fn new((left, width): Point, content: Content) -> Self {
        Block {
            left,
            width,
            before_next: false,
            content,
        }
    }

    /// A legend between a left edge and a width.
    pub fn legend(place: Point, heading: &str, entries: Vec<Entry>) -> Self {
        Block::new(place, Content::Legend(heading.to_owned(), entries))
    }

    pub fn key(place: Point, key: Key) -> Self {
        Block::new(place, Content::Key(key))
    }

    pub fn notes(place: Point, notes: Vec<String>) -> Self {
        Block::new(place, Content::Notes(notes))
    }
}

/// A mark and its name.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub mark: Mark,
    pub name: String,
}

/// What a legend shows next to a name.
#[derive(Clone, Debug)]
pub(crate) enum Mark {
    Line(Stroke),
    Fill(Fill),
    /// A symbol with its radius in pixels.
    Symbol(Symbol, f64, Style),
}

impl Entry {
    pub fn line(stroke: Stroke, name: impl Into<String>) -> Self {
        let (mark, name) = (Mark::Line(stroke), name.into());
        Entry { mark, name }
    }

    pub fn fill(fill: Fill, name: impl Into<String>) -> Self {
        let (mark, name) = (Mark::Fill(fill), name.into());
        Entry { mark, name }
    }

    pub fn symbol(symbol: Symbol, style: Style, name: impl Into<String>) -> Self {
        let (mark, name) = (Mark::Symbol(symbol, 4.4, style), name.into());
        Entry { mark, name }
    }
}

/// A strip of colours with labels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Key {
    pub heading: String,
    /// Colours from left to right.
    pub colours: Vec<String>,
    /// Labels with their places from 0 to 1; of those that would overlap the last ones are written.
    pub labels: Vec<(f64, String)>,
}
