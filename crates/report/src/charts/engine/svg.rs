//! Drawing surface: shapes in pixels become SVG text.

use std::fmt::{Display, Write as _};

use crate::number::typeset;
use cvtcycle_output::escape::xml;

/// Canvas units per pixel. Coordinates are written in whole units; at one unit per pixel gentle slopes would turn into stairs.
pub(crate) const UNITS: f64 = 4.0;

/// A point in pixels or in the units of a panel's axes.
pub(crate) type Point = (f64, f64);

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Rect {
    /// A rectangle from its upper left corner, width and height.
    pub fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Rect {
            left,
            top,
            right: left + width,
            bottom: top + height,
        }
    }

    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }
}

/// An SVG document under construction.
#[derive(Debug)]
pub(crate) struct Svg {
    pub width: f64,
    pub height: f64,
    defs: String,
    /// Ids of the definitions.
    defined: Vec<String>,
    body: String,
}

impl Svg {
    /// An empty document of a size in pixels.
    pub fn new(width: f64, height: f64) -> Self {
        Svg {
            width: width.round(),
            height: height.round(),
            defs: String::new(),
            defined: Vec::new(),
            body: String::new(),
        }
    }

    /// Adds an empty element; `paint` holds further attributes.
    pub fn element(&mut self, name: &str, place: &[(&str, &dyn Display)], paint: &str) {
        self.tag(name, place, paint);
        self.body.push_str("/>\n");
    }

    /// Adds an element with text.
    pub fn text_element(&mut self, place: &[(&str, &dyn Display)], paint: &str, text: &str) {
        self.tag("text", place, paint);
        // Writing into a String cannot fail, here and below.
        let _ = writeln!(self.body, ">{}</text>", xml(&set(text)));
    }

    fn tag(&mut self, name: &str, place: &[(&str, &dyn Display)], paint: &str) {
        let _ = write!(self.body, "<{name}");
        for (key, value) in place {
            let _ = write!(self.body, " {key}=\"{value}\"");
        }
        if !paint.is_empty() {
            let _ = write!(self.body, " {paint}");
        }
    }

    /// Opens a group with attributes; close it with [`Svg::close`].
    pub fn open(&mut self, attributes: &str) {
        let _ = writeln!(self.body, "<g {attributes}>");
    }

    /// Opens a group with a text shown as a tooltip.
    pub fn open_titled(&mut self, title: &str) {
        let _ = writeln!(self.body, "<g><title>{}</title>", xml(&set(title)));
    }

    /// Closes the group.
    pub fn close(&mut self) {
        self.body.push_str("</g>\n");
    }

    /// Adds a definition unless the id exists.
    pub fn define(&mut self, id: &str, element: impl FnOnce() -> String) {
        if !self.defined.iter().any(|other| other == id) {
            self.defined.push(id.to_owned());
            self.defs.push_str(&element());
        }
    }

    /// Adds a clip path; returns the attribute that uses it.
    pub fn clip(&mut self, path: &str) -> String {
        let id = format!("clip-{}", self.defined.len());
        self.define(&id, || {
            format!("<clipPath id=\"{id}\"><path d=\"{path}\"/></clipPath>\n")
        });
        format!("clip-path=\"url(#{id})\"")
    }

    /// Adds a rectangle.
    pub fn rect(&mut self, rect: Rect, paint: &str) {
        let (x, y) = (units(rect.left), units(rect.top));
        let (width, height) = (units(rect.right) - x, units(rect.bottom) - y);
        let place: [(&str, &dyn Display); 4] =
            [("x", &x), ("y", &y), ("width", &width), ("height", &height)];
        self.element("rect", &place, paint);
    }

    /// Adds a straight line.
    pub fn line(&mut self, from: Point, to: Point, paint: &str) {
        let (x1, y1, x2, y2) = (units(from.0), units(from.1), units(to.0), units(to.1));
        let place: [(&str, &dyn Display); 4] = [("x1", &x1), ("y1", &y1), ("x2", &x2), ("y2", &y2)];
        self.element("line", &place, paint);
    }

    /// Adds a path, unless it is empty.
    pub fn path(&mut self, path: Path, paint: &str) {
        let data = path.finish();
        if !data.is_empty() {
            self.element("path", &[("d", &data)], paint);
        }
    }

    /// Adds a circle.
    pub fn circle(&mut self, at: Point, radius: f64, paint: &str) {
        let (cx, cy, r) = (units(at.0), units(at.1), format!("{:.1}", radius * UNITS));
        self.element("circle", &[("cx", &cx), ("cy", &cy), ("r", &r)], paint);
    }

    /// Completes the document with its title and its description for screen readers.
    pub fn finish(self, title: &str, description: &str) -> String {
        let (width, height) = (self.width, self.height);
        let (w, h) = (units(width), units(height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {w} {h}\">\n<title>{}</title>\n\
             <desc>{}</desc>\n<defs>{}</defs>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            xml(&set(title)),
            xml(&set(description)),
            self.defs,
            self.body
        )
    }
}

/// Typesets a text for a picture, with plain blanks, since SVG lines do not wrap.
fn set(text: &str) -> String {
    typeset(text).replace('\u{a0}', " ")
}

/// Converts pixels to whole canvas units, limited to the range that viewers can handle.
pub(crate) fn units(pixels: f64) -> i64 {
    (pixels * UNITS).clamp(-1e6, 1e6).round() as i64
}

/// The data of an SVG path, in whole canvas units and relative steps to keep it short.
#[derive(Default)]
pub(crate) struct Path {
    text: String,
    at: Option<(i64, i64)>,
    start: bool,
}

impl Path {
    /// A closed polygon.
    pub fn polygon(points: impl IntoIterator<Item = Point>) -> Self {
        let mut path = Path::default();
        path.add_polygon(points);
        path
    }

    /// Adds a closed polygon.
    pub fn add_polygon(&mut self, points: impl IntoIterator<Item = Point>) {
        self.add_line(points);
        if self.at.is_some() {
            self.text.push('Z');
            self.start = false;
        }
    }

    /// Adds an open line.
    pub fn add_line(&mut self, points: impl IntoIterator<Item = Point>) {
        for (k, (x, y)) in points.into_iter().enumerate() {
            if k == 0 {
                self.move_to(x, y);
            } else {
                self.line_to(x, y);
            }
        }
    }

    fn move_to(&mut self, x: f64, y: f64) {
        self.finish_dot();
        let (x, y) = (units(x), units(y));
        let _ = write!(self.text, "M{x} {y}");
        self.at = Some((x, y));
        self.start = true;
    }

    fn line_to(&mut self, x: f64, y: f64) {
        let Some((x0, y0)) = self.at else {
            return self.move_to(x, y);
        };
        let (x, y) = (units(x), units(y));
        let _ = match (x - x0, y - y0) {
            (0, 0) => return,
            (dx, 0) => write!(self.text, "h{dx}"),
            (0, dy) => write!(self.text, "v{dy}"),
            (dx, dy) if dy < 0 => write!(self.text, "l{dx}{dy}"),
            (dx, dy) => write!(self.text, "l{dx} {dy}"),
        };
        self.at = Some((x, y));
        self.start = false;
    }

    /// Adds a ribbon of constant height between two upper ends, curved from horizontal to horizontal.
    pub fn add_ribbon(&mut self, from: Point, to: Point, height: f64) {
        let (x0, x1, middle) = (units(from.0), units(to.0), units(0.5 * (from.0 + to.0)));
        let [a, b, c, d] = [from.1, from.1 + height, to.1, to.1 + height].map(units);
        let _ = write!(
            self.text,
            "M{x0} {a}C{middle} {a} {middle} {c} {x1} {c}V{d}C{middle} {d} {middle} {b} {x0} {b}Z"
        );
    }

    /// The path data; empty if nothing was drawn.
    pub fn finish(mut self) -> String {
        self.finish_dot();
        self.text
    }

    /// A stroke without extent would be invisible and gets the minimum length.
    fn finish_dot(&mut self) {
        if self.start {
            self.text.push_str("h1");
            self.start = false;
        }
    }
}
