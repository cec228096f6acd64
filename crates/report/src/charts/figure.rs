//! The SVG document: header, heading, text and paths.
use std::fmt::Write as _;

/// Canvas units per pixel of the picture. Paths are written in whole units; at one unit per pixel
/// gentle slopes would turn into stairs.
pub(super) const UNITS: f64 = 4.0;

/// Text colours: as dark as print, and a quieter one for context.
pub(super) const INK: &str = "#000000";
/// Colour of what is context only.
pub(super) const QUIET: &str = "#555555";

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rect {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

/// Which part of a text stands at its place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A picture in the making. Lengths are in pixels.
pub(super) struct Figure {
    width: f64,
    height: f64,
    title: String,
    desc: String,
    defs: String,
    body: String,
}

impl Figure {
    /// A white picture with a heading over `left`: what it shows, and of which vehicle.
    pub fn new(size: (f64, f64), left: f64, title: &str, subject: &str, desc: &str) -> Self {
        let (width, height) = size;
        let full = if subject.is_empty() {
            title.to_string()
        } else {
            format!("{title}: {subject}")
        };
        let mut figure = Figure {
            width,
            height,
            title: full,
            desc: desc.to_string(),
            defs: String::new(),
            body: String::new(),
        };
        let room = width - left - 10.0;
        figure.text(
            (left, 24.0),
            15.0,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            &fit(title, 15.0, room),
        );
        figure.text(
            (left, 42.0),
            12.0,
            Anchor::Start,
            "",
            QUIET,
            &fit(subject, 12.0, room),
        );
        figure
    }

    /// Size in pixels.
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// Adds SVG elements in canvas units.
    pub fn raw(&mut self, elements: &str) {
        self.body.push_str(elements);
        self.body.push('\n');
    }

    /// Adds a definition in canvas units.
    pub fn define(&mut self, element: &str) {
        self.defs.push_str(element);
    }

    /// Opens a group of a class; close with [`Figure::close`].
    pub fn open(&mut self, class: &str) {
        self.raw(&format!("<g class=\"{class}\">"));
    }

    /// Closes the group.
    pub fn close(&mut self) {
        self.raw("</g>");
    }

    /// A line of text at its base line, with further attributes.
    pub fn text(
        &mut self,
        at: (f64, f64),
        size: f64,
        anchor: Anchor,
        attributes: &str,
        colour: &str,
        text: &str,
    ) {
        if text.is_empty() {
            return;
        }
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (x, y, size) = (units(at.0), units(at.1), units(size));
        let text = escape(text);
        self.raw(&format!(
            "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{colour}\" {attributes}>{text}</text>"
        ));
    }

    /// A rectangle with SVG paint attributes.
    pub fn rect(&mut self, rect: Rect, attributes: &str) {
        let (x, y) = (units(rect.left), units(rect.top));
        let (width, height) = (units(rect.right) - x, units(rect.bottom) - y);
        self.raw(&format!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" {attributes}/>"
        ));
    }

    /// A straight line with SVG paint attributes.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), attributes: &str) {
        let (x1, y1, x2, y2) = (units(from.0), units(from.1), units(to.0), units(to.1));
        self.raw(&format!(
            "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" {attributes}/>"
        ));
    }

    /// The document.
    pub fn finish(self) -> String {
        let (width, height) = (self.width.round(), self.height.round());
        let (w, h) = (units(width), units(height));
        let (title, desc) = (escape(&self.title), escape(&self.desc));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {w} {h}\">\n<title>{title}</title>\n\
             <desc>{desc}</desc>\n<defs>{}</defs>\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.defs, self.body
        )
    }
}

/// Pixels to whole canvas units. What lies absurdly far out is kept where viewers can still count.
pub(super) fn units(pixels: f64) -> i64 {
    (pixels * UNITS).clamp(-1e6, 1e6).round() as i64
}

/// The data of an SVG path, in whole canvas units and relative steps to keep it short.
#[derive(Default)]
pub(super) struct Path {
    text: String,
    at: Option<(i64, i64)>,
    start: bool,
}

impl Path {
    /// Starts a new stroke at a place in pixels.
    pub fn move_to(&mut self, x: f64, y: f64) {
        self.finish_dot();
        let (x, y) = (units(x), units(y));
        // Writing into a String cannot fail, here and below.
        let _ = write!(self.text, "M{x} {y}");
        self.at = Some((x, y));
        self.start = true;
    }

    /// Draws on to a place in pixels.
    pub fn line_to(&mut self, x: f64, y: f64) {
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

    /// Closes the stroke to an area.
    pub fn close(&mut self) {
        self.text.push('Z');
        self.start = false;
    }

    /// The path data; empty if nothing was drawn.
    pub fn finish(mut self) -> String {
        self.finish_dot();
        self.text
    }

    /// A stroke of one place would be invisible: it gets the least length there is.
    fn finish_dot(&mut self) {
        if self.start {
            self.text.push_str("h1");
            self.start = false;
        }
    }
}

/// Text that XML can hold.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\r' | '\t' => out.push(' '),
            // XML 1.0 has no way to write these.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// About how wide a text comes out in a wide sans-serif face, in pixels.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|c| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '|' | '\'' | '!' | '(' | ')' | '[' | ']'
        | ' ' => 0.4,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 1.0,
        c if c as u32 >= 0x1100 => 1.05,
        c if c.is_uppercase() => 0.75,
        _ => 0.64,
    });
    ems.sum::<f64>() * size
}

/// The text in at most two lines, broken between words and cut where that is not enough.
pub(super) fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    let mut breaks = text.match_indices(' ').map(|(at, _)| at);
    let best = breaks.rfind(|at| text_width(&text[..*at], size) <= width);
    match best {
        Some(at) if text_width(text, size) > width => {
            vec![
                text[..at].to_string(),
                fit(text[at..].trim_start(), size, width),
            ]
        }
        _ => vec![fit(text, size, width)],
    }
}

/// The text, or as much of its beginning as fits, with an ellipsis.
pub(super) fn fit(text: &str, size: f64, width: f64) -> String {
    if text_width(text, size) <= width {
        return text.to_string();
    }
    let mut short = String::new();
    for c in text.chars() {
        short.push(c);
        if text_width(&short, size) + size > width {
            short.pop();
            break;
        }
    }
    short.truncate(short.trim_end().len());
    short + "\u{2026}"
}
