//! Legends, in a strip beside the plot or below it, where no data can be.
use super::figure::{Anchor, Figure, INK, Rect, UNITS, escape, fit, text_width, units, wrap};
use super::style::Stroke;
use super::symbol::Symbol;

/// What a legend shows beside a name.
pub(super) enum Mark {
    /// A piece of line.
    Line(Stroke),
    /// A filled box.
    Fill(String),
    /// A circle of that radius in pixels, with SVG paint attributes.
    Circle(f64, String),
    /// The mark of a point, filled or open.
    Point(Symbol, bool),
}

/// Height of an entry with a small mark, pixels.
pub(super) const ENTRY: f64 = 19.0;
const MARK_WIDTH: f64 = 30.0;
/// Radius of the mark of a point, pixels.
const POINT: f64 = 4.4;
const SIZE: f64 = 11.0;
const LINE: f64 = 13.0;

/// Draws a legend with its upper left corner at `at`; returns where it ends.
pub(super) fn legend(
    figure: &mut Figure,
    at: (f64, f64),
    width: f64,
    heading: &str,
    entries: &[(Mark, String)],
) -> f64 {
    let (left, mut top) = at;
    figure.open("legend");
    if !heading.is_empty() {
        figure.text(
            (left, top + 12.0),
            SIZE,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            heading,
        );
        top += ENTRY;
    }
    let widest = entries
        .iter()
        .map(|(mark, _)| mark.width())
        .fold(MARK_WIDTH, f64::max);
    for (mark, name) in entries {
        let room = width - widest - 8.0;
        let lines = wrap(name, SIZE, room);
        let height = mark.height() + LINE * (lines.len() - 1) as f64;
        draw_mark(figure, mark, (left + widest / 2.0, top + height / 2.0));
        write(
            figure,
            (left + widest + 8.0, top + height / 2.0 + 4.0),
            name,
            &lines,
        );
        top += height;
    }
    figure.close();
    top
}

/// Room between the columns of a legend below the plot, pixels.
const GUTTER: f64 = 22.0;

/// Columns of a legend below the plot, their width in pixels, and entries in each.
fn columns<'n>(names: impl Iterator<Item = &'n str>, width: f64) -> (usize, f64, usize) {
    let (mut count, mut widest) = (0_usize, 0.0_f64);
    for name in names {
        count += 1;
        widest = widest.max(text_width(name, SIZE));
    }
    let wide = (MARK_WIDTH + 8.0 + widest).min(width);
    let columns = ((width + GUTTER) / (wide + GUTTER)).floor().max(1.0) as usize;
    (columns, wide, count.div_ceil(columns))
}

/// Height of [`legend_below`], pixels.
pub(super) fn below_height<'n>(
    names: impl Iterator<Item = &'n str>,
    width: f64,
    heading: &str,
) -> f64 {
    let (.., rows) = columns(names, width);
    (rows + usize::from(!heading.is_empty())) as f64 * ENTRY
}

/// Draws a legend below a plot, its upper left corner at `at`: under each other in as many columns as the width holds.
pub(super) fn legend_below(
    figure: &mut Figure,
    at: (f64, f64),
    width: f64,
    heading: &str,
    entries: &[(Mark, String)],
) {
    let (left, mut top) = at;
    figure.open("legend");
    if !heading.is_empty() {
        figure.text(
            (left, top + 12.0),
            SIZE,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            heading,
        );
        top += ENTRY;
    }
    let (_, wide, rows) = columns(entries.iter().map(|(_, name)| name.as_str()), width);
    for (k, (mark, name)) in entries.iter().enumerate() {
        let x = left + (k / rows) as f64 * (wide + GUTTER);
        let middle = top + ((k % rows) as f64 + 0.5) * ENTRY;
        draw_mark(figure, mark, (x + MARK_WIDTH / 2.0, middle));
        // Half a pixel more, lest rounding cuts the widest name.
        let room = wide - MARK_WIDTH - 7.5;
        write(
            figure,
            (x + MARK_WIDTH + 8.0, middle + 4.0),
            name,
            &[fit(name, SIZE, room)],
        );
    }
    figure.close();
}

impl Mark {
    fn width(&self) -> f64 {
        match self {
            Mark::Circle(radius, _) => 2.0 * radius,
            _ => MARK_WIDTH,
        }
    }

    fn height(&self) -> f64 {
        match self {
            Mark::Circle(radius, _) => (2.0 * radius + 6.0).max(ENTRY),
            _ => ENTRY,
        }
    }
}

fn draw_mark(figure: &mut Figure, mark: &Mark, (x, y): (f64, f64)) {
    let half = MARK_WIDTH / 2.0;
    match mark {
        Mark::Line(stroke) => figure.line((x - half, y), (x + half, y), &stroke.attributes()),
        Mark::Fill(paint) => {
            let rect = Rect {
                left: x - half,
                right: x + half,
                top: y - 6.5,
                bottom: y + 6.5,
            };
            figure.rect(
                rect,
                &format!("fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"2\""),
            );
        }
        Mark::Circle(radius, attributes) => {
            let (x, y, r) = (units(x), units(y), radius * UNITS);
            figure.raw(&format!(
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r:.1}\" {attributes}/>"
            ));
        }
        Mark::Point(symbol, true) => symbol.filled(figure, (x, y), POINT, ""),
        Mark::Point(symbol, false) => symbol.open(figure, (x, y), POINT, ""),
    }
}

/// Height of a legend without heading whose marks are small, pixels.
pub(super) fn height(names: &[String], width: f64) -> f64 {
    let lines = |name: &String| wrap(name, SIZE, width - MARK_WIDTH - 8.0).len();
    names
        .iter()
        .map(|name| ENTRY + LINE * (lines(name) - 1) as f64)
        .sum()
}

/// Writes a name around the height of `at`. Where it had to be cut, the full one shows up under
/// the pointer.
fn write(figure: &mut Figure, (x, y): (f64, f64), name: &str, lines: &[String]) {
    let cut = lines.iter().any(|line| line.ends_with('\u{2026}'));
    if cut {
        figure.raw(&format!("<g><title>{}</title>", escape(name)));
    }
    let first = y - 0.5 * LINE * (lines.len() - 1) as f64;
    for (i, line) in lines.iter().enumerate() {
        figure.text(
            (x, first + LINE * i as f64),
            SIZE,
            Anchor::Start,
            "",
            INK,
            line,
        );
    }
    if cut {
        figure.close();
    }
}
