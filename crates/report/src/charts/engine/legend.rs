//! Legends, keys of colours, and notes.

use super::chart::{Block, Content, Entry, Key, Mark, Side};
use super::place::{Label, at};
use super::render::draw_text as text;
use super::style::{INK, Style, stroke};
use super::svg::{Point, Rect, Svg};
use super::text::{Cut, lines, text_width, wrap};

/// Height of an entry, pixels.
const ENTRY: f64 = 19.0;
const MARK_WIDTH: f64 = 30.0;
/// Room for a mark and the gap to the name, pixels.
const MARK: f64 = MARK_WIDTH + 8.0;
const SIZE: f64 = 11.0;
/// Height of a line of a wrapped name, pixels.
const LINE: f64 = 13.0;
/// Height of a line of notes, and room after a note, pixels.
const NOTE: (f64, f64) = (15.0, 5.0);
/// Room between columns, and maximum width of a name, pixels.
const GUTTER: f64 = 22.0;
const NAME: f64 = 420.0;
/// Height of a key with heading and labels, pixels.
const KEY_HEIGHT: f64 = 48.0;

impl Block {
    pub(super) fn height(&self) -> f64 {
        match &self.content {
            Content::Legend(_, entries) if entries.is_empty() => 0.0,
            Content::Legend(heading, entries) => {
                let rows = columns(entries, self.width).2;
                (rows + usize::from(!heading.is_empty())) as f64 * ENTRY + 6.0
            }
            Content::Key(_) => KEY_HEIGHT,
            Content::Notes(notes) => notes
                .iter()
                .map(|note| NOTE.0 * lines(note, SIZE, self.width).len() as f64 + NOTE.1)
                .sum(),
        }
    }

    pub(super) fn draw(&self, svg: &mut Svg, top: f64) {
        match &self.content {
            Content::Legend(_, entries) if entries.is_empty() => {}
            Content::Legend(heading, entries) => {
                legend_below(svg, (self.left, top), self.width, heading, entries);
            }
            Content::Key(key) => draw_key(svg, (self.left, top), self.width, key),
            Content::Notes(notes) => {
                let mut y = top + SIZE;
                for note in notes {
                    for line in lines(note, SIZE, self.width) {
                        text(svg, Label::new(at(self.left, y), line).quiet());
                        y += NOTE.0;
                    }
                    y += NOTE.1;
                }
            }
        }
    }
}

/// Number of columns of a legend, their width in pixels, and entries in each.
fn columns(entries: &[Entry], width: f64) -> (usize, f64, usize) {
    let widest = entries
        .iter()
        .map(|entry| text_width(&entry.name, SIZE))
        .fold(0.0, f64::max);
    let wide = (MARK + widest.min(NAME)).min(width);
    let columns = ((width + GUTTER) / (wide + GUTTER)).floor().max(1.0) as usize;
    (columns, wide, entries.len().div_ceil(columns))
}

fn legend_below(svg: &mut Svg, (left, mut top): Point, width: f64, title: &str, entries: &[Entry]) {
    svg.open("class=\"legend\"");
    top += heading(svg, (left, top), title);
    let (_, wide, rows) = columns(entries, width);
    for (k, Entry { mark, name }) in entries.iter().enumerate() {
        let x = left + (k / rows) as f64 * (wide + GUTTER);
        let y = top + ((k % rows) as f64 + 0.5) * ENTRY;
        draw_mark(svg, mark, (x + MARK_WIDTH / 2.0, y));
        let label = Label::new(at(x + MARK, y + 4.0), name);
        // The extra half pixel keeps rounding from cutting the widest name.
        text(svg, label.cut(Cut::Middle, wide - MARK + 0.5));
    }
    svg.close();
}

impl Side {
    /// Height, pixels.
    pub fn height(&self) -> f64 {
        let lines = |entry: &Entry| wrap(&entry.name, SIZE, self.width - MARK).len();
        let names = self
            .entries
            .iter()
            .map(|entry| ENTRY + LINE * (lines(entry) - 1) as f64);
        names.sum::<f64>() + if self.heading.is_empty() { 0.0 } else { ENTRY }
    }

    pub(super) fn draw(&self, svg: &mut Svg) {
        let (left, mut top) = self.corner;
        svg.open("class=\"legend\"");
        top += heading(svg, self.corner, &self.heading);
        for Entry { mark, name } in &self.entries {
            let lines = wrap(name, SIZE, self.width - MARK);
            let height = ENTRY + LINE * (lines.len() - 1) as f64;
            let middle = top + height / 2.0;
            draw_mark(svg, mark, (left + MARK_WIDTH / 2.0, middle));
            let cut = lines.iter().any(|line| line.ends_with('\u{2026}'));
            if cut {
                svg.open_titled(name);
            }
            let first = middle + 4.0 - 0.5 * LINE * (lines.len() - 1) as f64;
            for (k, line) in lines.into_iter().enumerate() {
                text(
                    svg,
                    Label::new(at(left + MARK, first + LINE * k as f64), line),
                );
            }
            if cut {
                svg.close();
            }
            top += height;
        }
        svg.close();
    }
}

/// Writes the heading of a legend, if it has one; returns its height.
fn heading(svg: &mut Svg, (left, top): Point, heading: &str) -> f64 {
    text(svg, Label::new(at(left, top + 12.0), heading).bold(true));
    if heading.is_empty() { 0.0 } else { ENTRY }
}

fn draw_mark(svg: &mut Svg, mark: &Mark, (x, y): Point) {
    let half = MARK_WIDTH / 2.0;
    match mark {
        Mark::Line(stroke) => {
            let paint = Style::line(*stroke).attributes(svg);
            svg.line((x - half, y), (x + half, y), &paint);
        }
        Mark::Fill(fill) => {
            let paint = Style::edged(fill.clone(), 0.5).attributes(svg);
            svg.rect(Rect::new(x - half, y - 6.5, MARK_WIDTH, 13.0), &paint);
        }
        Mark::Symbol(symbol, radius, style) => symbol.draw(svg, (x, y), *radius, style),
    }
}

fn draw_key(svg: &mut Svg, (left, top): Point, width: f64, key: &Key) {
    svg.open("class=\"legend\"");
    text(svg, Label::new(at(left, top + SIZE), &key.heading));
    let strip = Rect::new(left, top + 17.0, width, 12.0);
    let wide = width / key.colours.len().max(1) as f64;
    for (k, colour) in key.colours.iter().enumerate() {
        let slice = Rect::new(left + wide * k as f64, strip.top, wide, strip.height());
        let paint = Style::colour(colour).crisp().attributes(svg);
        svg.rect(slice, &paint);
    }
    let edge = Style::line(stroke(INK, 0.5, &[])).attributes(svg);
    svg.rect(strip, &edge);
    let tick = Style::line(stroke(INK, 0.75, &[])).attributes(svg);
    let mut free_to = f64::INFINITY;
    for (share, label) in key.labels.iter().rev() {
        let x = left + width * share;
        svg.line((x, strip.bottom), (x, strip.bottom + 3.0), &tick);
        let half = 0.5 * text_width(label, SIZE);
        if x + half + 4.0 < free_to {
            text(svg, Label::new(at(x, strip.bottom + 15.0), label).middle());
            free_to = x - half;
        }
    }
    svg.close();
}
