//! A picture as data: panels, legends and notes.

use super::panel::Panel;
use super::style::{Fill, Stroke, Style};
use super::svg::Point;
use super::symbol::Symbol;

/// Width of a picture, pixels: its text remains legible on A4.
pub(crate) const WIDTH: f64 = 880.0;
/// Room left of a plot for its axis, pixels.
pub(crate) const LEFT: f64 = 66.0;
/// Left edge of the first plot of a picture, pixels.
pub(crate) const PLOT_LEFT: f64 = LEFT + 8.0;

/// A picture: panels, and legends and notes below them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chart {
    pub title: String,
    /// Subject and conditions; may be empty.
    pub subject: String,
    /// First sentence of the picture in words; axes and numbers are appended.
    pub lead: String,
    /// Left edge of the title, pixels.
    pub left: f64,
    /// Width, pixels; zero is [`WIDTH`].
    pub width: f64,
    /// True for the layout of a narrow screen.
    pub is_narrow: bool,
    /// The chart for a narrow screen, where it is not this one with its panels below each other.
    pub other: Option<Box<Chart>>,
    pub panels: Vec<Panel>,
    /// Legends with fixed places.
    pub sides: Vec<Side>,
    /// Blocks below the panels, from the top.
    pub foot: Vec<Block>,
}

impl Chart {
    /// An empty picture; title and subject begin at `left` pixels.
    pub fn new(title: impl Into<String>, subject: impl Into<String>, left: f64) -> Self {
        Chart {
            title: title.into(),
            subject: subject.into(),
            left,
            ..Chart::default()
        }
    }

    pub fn width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }

    pub fn lead(mut self, lead: impl Into<String>) -> Self {
        self.lead = lead.into();
        self
    }

    /// Sets the chart for a narrow screen.
    pub fn narrow(mut self, other: Chart) -> Self {
        self.other = Some(Box::new(other));
        self
    }

    pub fn panels(mut self, panels: impl IntoIterator<Item = Panel>) -> Self {
        self.panels.extend(panels);
        self
    }

    pub fn side(mut self, side: Side) -> Self {
        self.sides.push(side);
        self
    }

    /// Adds a part below the panels.
    pub fn foot(mut self, block: Block) -> Self {
        self.foot.push(block);
        self
    }

    /// Adds a legend between a left edge and a width.
    pub fn legend(self, place: Point, entries: impl IntoIterator<Item = Entry>) -> Self {
        self.foot(Block::legend(place, "", entries.into_iter().collect()))
    }

    /// Adds remarks between a left edge and a width.
    pub fn notes(self, place: Point, notes: Vec<String>) -> Self {
        self.foot(Block::new(place, Content::Notes(notes)))
    }
}

/// A legend of one column with a fixed place; names may take two lines.
#[derive(Clone, Debug, Default)]
pub(crate) struct Side {
    /// Upper left corner and width, pixels.
    pub corner: Point,
    pub width: f64,
    pub heading: String,
    pub entries: Vec<Entry>,
}

/// A block below the panels.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Left edge and width, pixels.
    pub left: f64,
    pub width: f64,
    /// True if the next block lies to the right of it instead of below.
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
    pub(super) fn new((left, width): Point, content: Content) -> Self {
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
}

/// A mark and its name.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub mark: Mark,
    pub name: String,
}

/// Sample shown next to a name in a legend.
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
    /// Labels with their places from 0 to 1; overlapping ones are dropped, the last ones kept.
    pub labels: Vec<(f64, String)>,
}
