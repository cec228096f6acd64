//! Renders a chart to a picture.

use super::backend::frame;
use super::chart::{Chart, WIDTH};
use super::ends;
use super::panel::{Item, Panel, Shape, free};
use super::place::{Label, Place, at};
use super::style::{INK, Style, marks, stroke};
use super::svg::{Path, Point, Rect, Svg, units};
use super::text::{Cut, lines, text_width};
use crate::charts::picture::{MAX_SPANS, Narrow, Picture, PictureTable};
use cvtcycle_output::table::distinct;

/// Size of the title, its minimum for a long title, and size of the line below it, pixels.
const TITLE: f64 = 15.0;
const MIN_TITLE: f64 = 12.5;
const SUBJECT: f64 = 12.0;
/// Size of the subject of a narrow picture, and room between lines of titles and subjects, pixels.
const NARROW_SUBJECT: f64 = 11.0;
const LEADING: f64 = 4.0;

impl Chart {
    /// Draws the chart, whose numbers are in a table.
    pub fn picture(mut self, table: PictureTable) -> Picture {
        self.make_room_for_head();
        let words = self.alt_text(&table);
        let svg = self.drawn(&words);
        let narrow = Narrow::by(move || Some(self.narrowed()?.drawn(&words)));
        Picture { svg, narrow, table }
    }

    fn drawn(&self, words: &str) -> String {
        let width = self.wide();
        let ends = self.panels.iter().map(|p| p.rect.bottom + p.below);
        let (mut top, mut row) = (ends.fold(0.0, f64::max), 0.0_f64);
        let mut tops = Vec::new();
        for block in &self.foot {
            tops.push(top);
            row = row.max(block.height());
            if !block.before_next {
                top += row;
                row = 0.0;
            }
        }
        let margin = if self.foot.is_empty() { -2.0 } else { 6.0 };
        let mut svg = Svg::new(width, top + margin);
        self.head(&mut svg);
        for panel in &self.panels {
            draw_panel(&mut svg, panel);
        }
        for side in &self.sides {
            side.draw(&mut svg);
        }
        for (block, top) in self.foot.iter().zip(tops) {
            block.draw(&mut svg, top);
        }
        let title = match self.subject.as_str() {
            "" => self.title.clone(),
            subject => format!("{}: {subject}", self.title),
        };
        svg.finish(&title, words)
    }

    /// Lines of title and subject with their sizes. A long sentence is shrunk a little before it wraps.
    fn head_lines(&self) -> [(Vec<String>, f64); 2] {
        let narrow = self.is_narrow;
        let right = if narrow { self.left } else { 10.0 };
        let room = self.wide() - self.left - right;
        let fits = room / text_width(&self.title, 1.0).max(1.0);
        let size = if narrow {
            MIN_TITLE
        } else {
            fits.clamp(MIN_TITLE, TITLE)
        };
        let below = if narrow { NARROW_SUBJECT } else { SUBJECT };
        [(&self.title, size), (&self.subject, below)]
            .map(|(text, size)| (lines(text, size, room), size))
    }

    fn wide(&self) -> f64 {
        if self.width > 0.0 { self.width } else { WIDTH }
    }

    /// Height of title and subject of a narrow picture, pixels.
    pub(super) fn head_height(&self) -> f64 {
        let lines = self.head_lines();
        let lines = lines
            .iter()
            .map(|(lines, size)| lines.len() as f64 * (size + LEADING));
        lines.sum::<f64>() + 8.0
    }

    /// Moves all below a title and subject of more than one line each down.
    fn make_room_for_head(&mut self) {
        let more = |(lines, size): &(Vec<String>, f64)| {
            lines.len().saturating_sub(1) as f64 * (size + LEADING)
        };
        let more: f64 = self.head_lines().iter().map(more).sum();
        for panel in &mut self.panels {
            panel.rect.top += more;
            panel.rect.bottom += more;
        }
        for side in &mut self.sides {
            side.corner.1 += more;
        }
    }

    fn head(&self, svg: &mut Svg) {
        let [title, subject] = self.head_lines();
        let mut y = if self.is_narrow {
            2.0 + MIN_TITLE + LEADING
        } else {
            24.0
        };
        for line in &title.0 {
            let label = Label::new(at(self.left, y), line).size(title.1);
            draw_text(svg, label.bold(true));
            y += title.1 + LEADING;
        }
        if !self.is_narrow {
            // The base line of the subject of a title of one line is at 42.
            y = 42.0 + (y - 24.0 - title.1 - LEADING).max(0.0);
        }
        for line in &subject.0 {
            draw_text(
                svg,
                Label::new(at(self.left, y), line).size(subject.1).quiet(),
            );
            y += subject.1 + LEADING;
        }
    }

    /// The picture in words: its first sentence, the titles of its axes, its key numbers.
    fn alt_text(&self, table: &PictureTable) -> String {
        let framed = || self.panels.iter().filter(|panel| panel.framed);
        let axes = distinct(framed().map(|panel| panel.x.title.as_str()));
        let axes = axes.into_iter().map(|x| {
            let own = framed().filter(|panel| panel.x.title == x);
            let y = distinct(own.map(|panel| panel.y.title.as_str())).join(", ");
            joined([y, x.to_owned()], " over ")
        });
        let numbers = match self.panels.iter().all(|panel| panel.no_data) {
            true => "Without any data".to_owned(),
            false => self.key_numbers(table),
        };
        let lead = self.lead.trim_end_matches('.').to_owned();
        joined([lead, joined(axes, "; "), numbers], ". ") + "."
    }

    /// Key numbers in words; for many lines, the span of each quantity.
    fn key_numbers(&self, table: &PictureTable) -> String {
        let lines = self.panels.iter().flat_map(|panel| &panel.columns);
        if lines.count() <= MAX_SPANS {
            return table.in_words();
        }
        let over = self.panels.iter().find(|panel| panel.over_table);
        let over = over.and_then(|panel| table.span(&panel.x.title, &[0]));
        let quantities = distinct(self.panels.iter().map(|panel| panel.y.title.as_str()));
        let spans = quantities.into_iter().filter_map(|y| {
            let own = self.panels.iter().filter(|panel| panel.y.title == y);
            let columns: Vec<usize> = own.flat_map(|panel| panel.columns.clone()).collect();
            table.span(y, &columns)
        });
        joined(over.into_iter().chain(spans), "; ")
    }
}

/// Joins non-empty texts.
fn joined(parts: impl IntoIterator<Item = String>, sign: &str) -> String {
    let parts = parts.into_iter().filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(sign)
}

fn draw_panel(svg: &mut Svg, panel: &Panel) {
    let columns: Vec<String> = panel.columns.iter().map(usize::to_string).collect();
    if !columns.is_empty() {
        svg.open(&format!("data-columns=\"{}\"", columns.join(" ")));
    }
    if panel.framed {
        frame(svg, panel);
    }
    let corner = at(f64::NEG_INFINITY, f64::INFINITY);
    let heading = Label::new(corner.shift(0.0, -7.0), &panel.heading).size(12.0);
    let heading = heading.bold(true).cut(Cut::End, panel.rect.width());
    draw_label(svg, panel, &heading);
    for item in &panel.items {
        draw(svg, panel, item);
    }
    let named = ends::labels(panel).into_iter();
    for label in named.chain(ends::labels_above(panel, svg.width)) {
        draw_label(svg, panel, &label);
    }
    if panel.no_data {
        let (half_x, half_y) = (0.5 * panel.rect.width(), 0.5 * panel.rect.height());
        let label = Label::new(corner.shift(half_x, half_y + 4.0), "no data");
        draw_label(svg, panel, &label.size(12.0).middle().quiet());
    }
    if panel.framed {
        // Drawn over the data, which cover half of the axis lines.
        let border = Style::line(stroke(INK, 0.75, &[])).class("plot");
        let mut paint = border.attributes(svg);
        if panel.over_table {
            let (low, high) = (panel.x.low, panel.x.high);
            paint += &format!(" data-x0=\"{low:?}\" data-x1=\"{high:?}\"");
        }
        svg.rect(panel.rect, &paint);
    }
    if !columns.is_empty() {
        svg.close();
    }
}

fn draw(svg: &mut Svg, panel: &Panel, item: &Item) {
    match &item.shape {
        Shape::Line(points) => draw_line(svg, panel, points, &item.style),
        Shape::Area(polygons) => {
            let mut path = Path::default();
            for polygon in polygons {
                path.add_polygon(polygon.iter().map(|point| panel.pixel(*point)));
            }
            let paint = item.style.attributes(svg);
            svg.path(path, &paint);
        }
        Shape::Segment(a, b) => {
            if let Some((a, b)) = pixel(panel, *a).zip(pixel(panel, *b)) {
                let paint = item.style.attributes(svg);
                svg.line(a, b, &paint);
            }
        }
        Shape::Rect(a, b) => draw_rect(svg, panel, (*a, *b), &item.style),
        Shape::Ribbon(from, to, height) => {
            let mut path = Path::default();
            path.add_ribbon(panel.pixel(*from), panel.pixel(*to), *height);
            let paint = item.style.attributes(svg);
            svg.path(path, &paint);
        }
        Shape::Symbol(symbol, place, radius) => {
            if let Some(place) = pixel(panel, *place) {
                symbol.draw(svg, place, *radius, &item.style);
            }
        }
        Shape::Label(label) => draw_label(svg, panel, label),
        Shape::Within(outline, items) => {
            let r = panel.rect;
            let [a, b] = [r.top, r.bottom].map(|y| [(r.left, y), (r.right, y)]);
            let outline = match outline {
                Some(points) => points.iter().map(|point| panel.pixel(*point)).collect(),
                None => vec![a[0], a[1], b[1], b[0]],
            };
            let clip = svg.clip(&Path::polygon(outline).finish());
            svg.open(&clip);
            for item in items {
                draw(svg, panel, item);
            }
            svg.close();
        }
    }
}

fn draw_rect(svg: &mut Svg, panel: &Panel, (a, b): (Place, Place), style: &Style) {
    let Some((a, b)) = pixel(panel, a).zip(pixel(panel, b)) else {
        return;
    };
    let r = panel.rect;
    let rect = Rect {
        left: a.0.min(b.0).max(r.left),
        right: a.0.max(b.0).min(r.right),
        top: a.1.min(b.1).max(r.top),
        bottom: a.1.max(b.1).min(r.bottom),
    };
    if rect.left <= rect.right && rect.top <= rect.bottom {
        let paint = style.attributes(svg);
        svg.rect(rect, &paint);
    }
}

fn draw_line(svg: &mut Svg, panel: &Panel, points: &[Point], style: &Style) {
    let mut path = Path::default();
    for part in points.split(|(x, y)| !x.is_finite() || !y.is_finite()) {
        let pixels: Vec<Point> = part.iter().map(|point| panel.pixel(*point)).collect();
        // Lines that turn back are drawn in full.
        let rising = pixels.is_sorted_by(|a, b| a.0 <= b.0);
        path.add_line(if rising { thinned(&pixels) } else { pixels });
    }
    let paint = style.attributes(svg);
    svg.path(path, &paint);
}

/// Thins points without a visible change: of each column of pixels the first, lowest, highest and last.
fn thinned(points: &[Point]) -> Vec<Point> {
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

/// Writes a label whose place is in pixels.
pub(super) fn draw_text(svg: &mut Svg, label: Label) {
    let panel = free(Rect::new(0.0, 0.0, svg.width, svg.height));
    draw_label(svg, &panel, &label);
}

/// Writes a label; the full text of a cut one shows as a tooltip.
fn draw_label(svg: &mut Svg, panel: &Panel, label: &Label) {
    let Some((x, y)) = pixel(panel, label.at).filter(|_| !label.text.is_empty()) else {
        return;
    };
    let text = label.cut.apply(&label.text, label.size, label.room);
    if label.ground {
        let wide = text_width(&text, label.size) + 2.0;
        let left = match label.anchor {
            "start" => x - 1.0,
            _ => x - 0.5 * wide,
        };
        let ground = Rect::new(left, y - 11.0, wide, 14.0);
        let paint = Style::colour("#ffffff").fill_opacity(0.85).attributes(svg);
        svg.rect(ground, &paint);
    }
    let ([x, y, size], anchor) = ([x, y, label.size].map(units), label.anchor);
    let mut paint = marks(label.class, label.row);
    paint += &format!(
        "text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size}\" fill=\"{}\"",
        label.colour
    );
    if label.bold {
        paint += " font-weight=\"bold\"";
    }
    if label.turned {
        paint += &format!(" transform=\"rotate(-90 {x} {y})\"");
    }
    let cut = text != label.text;
    if cut {
        svg.open_titled(&label.text);
    }
    svg.text_element(&[("x", &x), ("y", &y)], &paint, &text);
    if cut {
        svg.close();
    }
}

/// Converts a place to pixels, if it is finite.
fn pixel(panel: &Panel, place: Place) -> Option<Point> {
    let (x, y) = (panel.px(place.x) + place.dx, panel.py(place.y) + place.dy);
    (x.is_finite() && y.is_finite()).then_some((x, y))
}
