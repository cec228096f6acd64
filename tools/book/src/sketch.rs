//! SVG sketches from numbers: lines, areas, and text with symbols as in the equations.

use std::fmt::Write as _;

/// Colours of the sketches; `theme/equations.css` defines each for every theme.
pub mod colour {
    pub const INK: &str = "#000000";
    pub const QUIET: &str = "#555555";
    pub const FORCE: &str = "#b34700";
    pub const BLUE: &str = "#005c94";
    pub const GREEN: &str = "#00664a";
    pub const GRID: &str = "#dedede";
    pub const METAL: &str = "#e3e3e3";
}

/// Side of a text at its position.
#[derive(Clone, Copy)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

const MATHS: &str = "font-family=\"Latin Modern Math, serif\"";

/// Sketch under construction.
pub struct Sketch {
    size: (f64, f64),
    body: String,
}

impl Sketch {
    /// Creates an empty sketch of `width` by `height` pixels; up to 480 wide it fits a phone.
    pub fn new(width: f64, height: f64) -> Self {
        Sketch {
            size: (width, height),
            body: String::new(),
        }
    }

    /// Adds text of a size in pixels; parts between dollar signs are symbols as in `$C_x$`, `$T_{out}$`, `$\mu N_p$`.
    pub fn text(&mut self, at: (f64, f64), anchor: Anchor, size: f64, colour: &str, words: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        // Writing to a String is infallible, here and below.
        let _ = writeln!(
            self.body,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\">{}</text>",
            at.0,
            at.1,
            symbols(words, size)
        );
    }

    /// Adds an SVG path.
    pub fn path(&mut self, d: &str, colour: &str, width: f64, dash: &str) {
        let dash = match dash {
            "" => String::new(),
            dash => format!(" stroke-dasharray=\"{dash}\""),
        };
        let _ = writeln!(
            self.body,
            "<path d=\"{d}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dash}/>"
        );
    }

    /// Adds a line through points.
    pub fn line(&mut self, points: &[(f64, f64)], colour: &str, width: f64, dash: &str) {
        let places: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1} {y:.1}"))
            .collect();
        self.path(&format!("M{}", places.join("L")), colour, width, dash);
    }

    /// Adds a filled polygon.
    pub fn area(&mut self, points: &[(f64, f64)], colour: &str) {
        let places: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1} {y:.1}"))
            .collect();
        let _ = writeln!(
            self.body,
            "<path d=\"M{}Z\" fill=\"{colour}\"/>",
            places.join("L")
        );
    }

    /// Adds a dot.
    pub fn dot(&mut self, (x, y): (f64, f64), r: f64, colour: &str) {
        let _ = writeln!(
            self.body,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r}\" fill=\"{colour}\"/>"
        );
    }

    /// Returns the SVG with title and description.
    pub fn finish(self, title: &str, shows: &str) -> String {
        let (w, h) = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"sans-serif\">\n<title>{title}</title>\n<desc>{shows}</desc>\n{}</svg>\n",
            self.body
        )
    }
}

/// Converts text to SVG: slanted symbols as in the equations, with subscripts.
fn symbols(words: &str, size: f64) -> String {
    let mut out = String::new();
    // A vertical shift applies to all following text until it is undone.
    let mut down = 0.0;
    let mut span = |text: &str, attributes: &str, dy: f64| {
        let shift = match dy - down {
            0.0 => String::new(),
            shift => format!(" dy=\"{shift:.2}\""),
        };
        down = dy;
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        if attributes.is_empty() && shift.is_empty() {
            out.push_str(&text);
        } else {
            let _ = write!(out, "<tspan{attributes}{shift}>{text}</tspan>");
        }
    };
    for (k, part) in words.split('$').enumerate() {
        if k % 2 == 0 {
            if !part.is_empty() {
                span(part, "", 0.0);
            }
            continue;
        }
        let (base, index) = part.split_once('_').unwrap_or((part, ""));
        span(&slanted(base), &format!(" {MATHS}"), 0.0);
        let index = index.trim_matches(['{', '}']);
        let small = format!(" font-size=\"{:.1}\"", 0.72 * size);
        match index.chars().count() {
            0 => {}
            1 => span(&slanted(index), &format!(" {MATHS}{small}"), 0.22 * size),
            _ => span(index, &small, 0.22 * size),
        }
    }
    out
}

/// Converts a symbol to the mathematical letters of Unicode, as in the equations; `\mu ` and similar ones by name.
fn slanted(text: &str) -> String {
    let names = [
        ("\\mu ", "\u{3bc}"),
        ("\\beta", "\u{3b2}"),
        ("\\Delta ", "\u{394}"),
    ];
    let named = names.iter().fold(text.to_owned(), |text, (name, letter)| {
        text.replace(name, letter)
    });
    let moved = |c: char, from: char, to: u32| char::from_u32(u32::from(c) - u32::from(from) + to);
    let letter = |c: char| match c {
        'h' => Some('\u{210e}'),
        'a'..='z' => moved(c, 'a', 0x1d44e),
        'A'..='Z' => moved(c, 'A', 0x1d434),
        '\u{3b1}'..='\u{3c9}' => moved(c, '\u{3b1}', 0x1d6fc),
        _ => None,
    };
    named.chars().map(|c| letter(c).unwrap_or(c)).collect()
}
