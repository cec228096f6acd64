//! The renderer: a chart becomes a picture.

use super::backend::frame;
use super::chart::{Chart, Item, Panel, Shape, WIDTH, free};
use super::label::{draw_label, pixel};
use super::place::{Label, Place, at};
use super::style::{INK, QUIET, Style, stroke};
use super::svg::{Path, Point, Rect, Svg};
use super::text::Cut;
use crate::charts::picture::Picture;

/// Size of the title and of the line below it, pixels.
const TITLE: f64 = 15.0;
const SUBJECT: f64 = 12.0;

impl Chart {
    /// Draws the chart.
    pub fn picture(self) -> Picture {
        let width = if self.width > 0.0 { self.width } else { WIDTH };
        let below = self
            .panels
            .iter()
            .map(|panel| panel.rect.bottom + panel.below);
        let below = below.fold(0.0, f64::max);
        let mut tops = Vec::new();
        let (mut top, mut row) = (below, 0.0_f64);
        for block in &self.foot {
            tops.push(top);
            row = row.max(block.height());
            if !block.before_next {
                top += row;
                row = 0.0;
            }
        }
        let height = if self.foot.is_empty() {
            top - 2.0
        } else {
            top + 6.0
        };
        let mut svg = Svg::new(width, height);
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
        let title = if self.subject.is_empty() {
            self.title
        } else {
            format!("{}: {}", self.title, self.subject)
        };
        Picture {
            svg: svg.finish(&title, &self.description),
            table: self.table,
        }
    }

    fn head(&self, svg: &mut Svg) {
        let room = svg.width - self.left - 10.0;
        let panel = free(Rect::new(0.0, 0.0, svg.width, svg.height));
        let title = Cut::End.apply(&self.title, TITLE, room);
        let title = Label::new(at(self.left, 24.0), title)
            .size(TITLE)
            .bold(true);
        draw_label(svg, &panel, &title);
        let subject = Cut::End.apply(&self.subject, SUBJECT, room);
        let subject = Label::new(at(self.left, 42.0), subject)
            .size(SUBJECT)
            .quiet();
        draw_label(svg, &panel, &subject);
    }
}

fn draw_panel(svg: &mut Svg, panel: &Panel) {
    let rect = panel.rect;
    let columns: Vec<String> = panel.columns.iter().map(usize::to_string).collect();
    if !columns.is_empty() {
        svg.open(&format!("data-columns=\"{}\"", columns.join(" ")));
    }
    if panel.framed {
        frame(svg, panel);
    }
    let heading = Label::new(
        at(f64::NEG_INFINITY, f64::INFINITY).shift(0.0, -7.0),
        &panel.heading,
    );
    let heading = heading.size(12.0).bold(true).cut(Cut::End, rect.width());
    draw_label(svg, panel, &heading);
    for item in &panel.items {
        draw(svg, panel, item);
    }
    if panel.no_data {
        let middle = at(f64::NEG_INFINITY, f64::INFINITY);
        let middle = middle.shift(0.5 * rect.width(), 0.5 * rect.height() + 4.0);
        let label = Label::new(middle, "no data")
            .size(12.0)
            .middle()
            .colour(QUIET);
        draw_label(svg, panel, &label);
    }
    if panel.framed {
        // Over the data, which cover half of the axis lines.
        let mut paint = Style::line(stroke(INK, 0.75, &[]))
            .class("plot")
            .attributes(svg);
        if panel.over_table {
            let (low, high) = (panel.x.low, panel.x.high);
            paint += &format!(" data-x0=\"{low:?}\" data-x1=\"{high:?}\"");
        }
        svg.rect(rect, &paint);
    }
    if !columns.is_empty() {
        svg.close();
    }
}

fn draw(svg: &mut Svg, panel: &Panel, item: &Item) {
    let pixels = |points: &[Point]| -> Vec<Point> {
        points
            .iter()
            .map(|(x, y)| (panel.px(*x), panel.py(*y)))
            .collect()
    };
    match &item.shape {
        Shape::Line(points) => draw_line(svg, panel, points, &item.style),
        Shape::Area(polygons) => {
            let mut path = Path::default();
            for polygon in polygons {
                path.add_polygon(pixels(polygon));
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
            path.add_ribbon(*from, *to, *height);
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
            let corners = || {
                vec![
                    (r.left, r.top),
                    (r.right, r.top),
                    (r.right, r.bottom),
                    (r.left, r.bottom),
                ]
            };
            let outline = outline
                .as_ref()
                .map_or_else(corners, |points| pixels(points));
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
        let pixels: Vec<Point> = part
            .iter()
            .map(|(x, y)| (panel.px(*x), panel.py(*y)))
            .collect();
        // What turns back on its way is drawn in full.
        let rising = pixels.is_sorted_by(|a, b| a.0 <= b.0);
        path.add_line(if rising { thinned(&pixels) } else { pixels });
    }
    let paint = style.attributes(svg);
    svg.path(path, &paint);
}

/// Points that look the same: of each column of pixels the first, lowest, highest and last.
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
