//! A chart laid out for a narrow screen: panels below each other, names of rows above their bars with the numbers next to them, names of lines
//! in the legend where there is no room at their ends, texts wrapped. Shapes stay where the axes put them.

use super::axis::{Axis, range};
use super::backend::axis_width;
use super::chart::{Block, Chart, Content, Entry};
use super::panel::{BELOW, Item, PAD, Panel, Shape, row_middle};
use super::place::{End, Label, Place, at};
use super::style::stroke;
use super::svg::Rect;
use super::text::{Cut, lines, text_width};

/// Width, pixels: a phone shows text of 11 px as such.
const WIDTH: f64 = 360.0;
/// Edge of the picture, left edge of a plot with a vertical axis, room right of it for the last label of its axis, pixels.
const EDGE: f64 = 6.0;
const LEFT: f64 = 58.0;
const RIGHT: f64 = 16.0;
/// Maximum room for names at the ends of lines, pixels: longer ones are in the legend.
const NAMES: f64 = 96.0;
/// Maximum height of a plot, height of a line of text, pixels.
const TALL: f64 = 250.0;
const LINE: f64 = 14.0;
const TEXT: f64 = 11.0;

impl Chart {
    /// The chart for a narrow screen; `None` for one that is drawn in pixels.
    pub(super) fn narrowed(&self) -> Option<Chart> {
        if let Some(other) = &self.other {
            return other.narrowed();
        }
        let is_free =
            |panel: &Panel| !panel.framed || panel.pitch.is_none() && has_left_labels(panel);
        if self.panels.iter().any(is_free) {
            return None;
        }
        let room = WIDTH - 2.0 * EDGE;
        let mut chart = Chart {
            title: self.title.clone(),
            subject: self.subject.clone(),
            left: EDGE,
            width: WIDTH,
            is_narrow: true,
            ..Chart::default()
        };
        let (mut top, mut named) = (chart.head_height(), Vec::new());
        for panel in &self.panels {
            let is_headed = !panel.heading.is_empty() || has_labels_above(panel);
            top += if is_headed { 22.0 } else { 9.0 };
            let (mut own, names) = match panel.pitch {
                Some(pitch) => (rows(panel, &self.panels, (pitch, top)), Vec::new()),
                None => plot(panel, top),
            };
            let title = match panel.x_labels {
                true => lines(&std::mem::take(&mut own.x.title), 12.0, room),
                false => Vec::new(),
            };
            for (k, text) in title.iter().enumerate() {
                let place = at(f64::NEG_INFINITY, f64::NEG_INFINITY);
                let middle = 0.5 * WIDTH - own.rect.left;
                let label = Label::new(place.shift(middle, 33.0 + LINE * k as f64), text);
                own.label(label.size(12.0).middle());
            }
            let more = LINE * title.len().saturating_sub(1) as f64;
            own.below = match own.x_labels {
                true => BELOW + more + 6.0,
                false => hanging(&own).max(8.0),
            };
            top = own.rect.bottom + own.below;
            named.extend(names);
            chart.panels.push(own);
        }
        // A legend that has a name already has its line as well.
        let has = |name: &str, content: &Content| match content {
            Content::Legend(_, entries) => entries.iter().any(|entry| entry.name == name),
            _ => false,
        };
        named.retain(|entry: &Entry| {
            !self
                .foot
                .iter()
                .any(|block| has(&entry.name, &block.content))
        });
        let legends = self.sides.iter();
        let legends =
            legends.map(|side| Content::Legend(side.heading.clone(), side.entries.clone()));
        let foot = self.foot.iter().map(|block| block.content.clone());
        let named = (!named.is_empty()).then(|| Content::Legend(String::new(), named));
        for content in named.into_iter().chain(legends).chain(foot) {
            // The labels at the ends of a key are wider than its strip.
            let place = match content {
                Content::Key(_) => (EDGE + 10.0, room - 24.0),
                _ => (EDGE, room),
            };
            chart = chart.foot(Block::new(place, content));
        }
        Some(chart)
    }
}

/// True if texts have their place left of a plot, where there is no room.
fn has_left_labels(panel: &Panel) -> bool {
    labels(panel).any(|label| {
        let wide = match label.anchor {
            "end" => text_width(&label.text, label.size).min(label.room),
            _ => 0.0,
        };
        label.at.x.is_infinite() && label.at.x < 0.0 && label.at.dx - wide < -LEFT
    })
}

/// True if texts have their place above a plot.
fn has_labels_above(panel: &Panel) -> bool {
    labels(panel).any(|label| label.at.y.is_infinite() && label.at.y > 0.0 && label.at.dy < 0.0)
}

/// Room of the texts below a plot that writes no labels of an axis, pixels: words of its levels may be turned.
fn hanging(panel: &Panel) -> f64 {
    let below = labels(panel).filter(|label| label.at.y.is_infinite() && label.at.y < 0.0);
    let end = |label: &Label| match label.turned {
        true => label.at.dy + text_width(&label.text, label.size).min(label.room),
        false => label.at.dy + 4.0,
    };
    below.map(end).fold(0.0, f64::max) + 6.0
}

fn labels(panel: &Panel) -> impl Iterator<Item = &Label> {
    panel.items.iter().filter_map(|item| match &item.shape {
        Shape::Label(label) => Some(label),
        _ => None,
    })
}

/// Panel of a plot with a vertical axis, and the legend of lines whose names have no room at their ends.
fn plot(panel: &Panel, top: f64) -> (Panel, Vec<Entry>) {
    let mut own = panel.clone();
    let names = panel
        .ends
        .iter()
        .map(|end| text_width(&end.text, TEXT) + 12.0);
    let names = names.fold(0.0, f64::max);
    let mut legend = std::mem::take(&mut own.above);
    if names > NAMES {
        legend.append(&mut own.ends);
    }
    let beyond = |item: &Item| match &item.shape {
        Shape::Label(label) if label.at.x >= panel.x.high && label.anchor == "start" => {
            label.at.dx + text_width(&label.text, label.size)
        }
        _ => 0.0,
    };
    let beyond = panel
        .items
        .iter()
        .map(beyond)
        .fold(RIGHT, f64::max)
        .min(NAMES);
    let beyond = if names > NAMES {
        beyond
    } else {
        beyond.max(names)
    };
    let tall = panel.rect.height().min(TALL);
    // Labels as long as 2.0e289 keep off the title of their axis.
    let left = LEFT.max(axis_width(panel));
    own.rect = Rect::new(left, top, WIDTH - left - beyond, tall);
    own.x = thinned(&panel.x, own.rect.width(), (left, beyond));
    let scale = own.rect.width() / panel.rect.width();
    let scale_y = tall / panel.rect.height();
    let mut placed = Vec::new();
    own.items.retain_mut(|item| match &mut item.shape {
        Shape::Label(label) if label.class == "phase" => {
            label.room *= scale;
            text_width(&label.text, label.size) <= label.room
        }
        // A place within the plot in pixels from its upper left corner.
        Shape::Label(label)
            if label.at.x.is_infinite() && label.at.y.is_infinite() && label.at.dy > 0.0 =>
        {
            label.at.dx *= scale;
            label.at.dy *= scale_y;
            // Of two texts that would lie on each other the first one stays.
            let wide = text_width(&label.text, label.size);
            let (x, y) = (label.at.dx, label.at.dy);
            let is_free = placed
                .iter()
                .all(|(other_x, other_y, other): &(f64, f64, f64)| {
                    (x - other_x).abs() > 0.5 * (wide + other) || (y - other_y).abs() > LINE
                });
            if is_free {
                placed.push((x, y, wide));
            }
            is_free
        }
        _ => true,
    });
    // Lines of several panels may have one name.
    let of = panel.heading.split(':').next().unwrap_or_default();
    let entry = |end: &End| {
        let name = match of {
            "" => end.text.clone(),
            of => format!("{of}: {}", end.text),
        };
        Entry::line(stroke(end.colour, 2.0, &[]), name)
    };
    (own, legend.iter().map(entry).collect())
}

/// Panel of rows: the labels of a row are one text above its bars.
fn rows(panel: &Panel, all: &[Panel], (pitch, top): (f64, f64)) -> Panel {
    let mut own = panel.clone();
    let count = ((panel.y.low - panel.y.high - 2.0 * PAD / pitch).round()).max(1.0) as usize;
    let row_of = |place: &Place| (0..count).find(|k| (place.y - row_middle(*k)).abs() < 1e-9);
    let mut names: Vec<Option<Label>> = vec![None; count];
    own.items.retain(|item| match &item.shape {
        Shape::Label(label) => match row_of(&label.at) {
            Some(row) => {
                join(&mut names[row], label);
                false
            }
            None => true,
        },
        // Links between rows would cross the names.
        Shape::Segment(a, b) if a.y.is_finite() && b.y.is_finite() => {
            a.y.floor().total_cmp(&b.y.floor()).is_eq()
        }
        _ => true,
    });
    let room = WIDTH - 2.0 * EDGE - RIGHT - 8.0;
    let text = |name: &Option<Label>| {
        let name = name.as_ref();
        name.map_or_else(Vec::new, |name| lines(&name.text, name.size, room))
    };
    let texts: Vec<Vec<String>> = names.iter().map(text).collect();
    let above = LINE * texts.iter().map(Vec::len).max().unwrap_or(0) as f64;
    let tall = pitch + above;
    own.rect = Rect::new(
        EDGE + 4.0,
        top,
        WIDTH - EDGE - 4.0 - RIGHT,
        count as f64 * tall + 2.0 * PAD,
    );
    // The middle of a row is that of its bars, below the names.
    let high = -(PAD + 0.5 * above) / tall;
    own.y = Axis::bare(high + own.rect.height() / tall, high);
    own.x = thinned(
        &without_room(panel, all),
        own.rect.width(),
        (EDGE + 4.0, RIGHT),
    );
    for (k, (name, texts)) in names.into_iter().zip(texts).enumerate() {
        let Some(name) = name else { continue };
        let first = own.rect.top + PAD + k as f64 * tall + above - LINE * texts.len() as f64;
        for (line, text) in texts.into_iter().enumerate() {
            let y = first + LINE * (line + 1) as f64 - 2.0 - own.rect.top;
            let mut label = name.clone();
            label.at = at(f64::NEG_INFINITY, f64::INFINITY).shift(4.0, y);
            (label.text, label.anchor, label.ground) = (text, "start", true);
            (label.cut, label.room) = (Cut::End, f64::INFINITY);
            own.label(label);
        }
    }
    own
}

/// Adds a label to the text of its row.
fn join(name: &mut Option<Label>, label: &Label) {
    match name {
        _ if label.text.is_empty() => {}
        Some(name) => {
            let sign = if name.text.contains(": ") { ", " } else { ": " };
            name.text = format!("{}{sign}{}", name.text, label.text);
        }
        None => *name = Some(label.clone()),
    }
}

/// The axis of a panel without the room that labels have at the ends of bars; panels of one scale keep one.
fn without_room(panel: &Panel, all: &[Panel]) -> Axis {
    let mut x = panel.x.clone();
    let ends = |panel: &Panel| [panel.x.low, panel.x.high].map(f64::to_bits);
    let alike = all.iter().filter(|other| ends(other) == ends(panel));
    let mut places = Vec::new();
    alike.for_each(|other| abscissae(&other.items, &mut places));
    let inner = places
        .into_iter()
        .filter(|place| (x.low..=x.high).contains(place));
    if let Some((low, high)) = range(inner).filter(|(low, high)| high > low) {
        let room = 0.04 * (high - low);
        (x.low, x.high) = (x.low.max(low - room), x.high.min(high + room));
        x.ticks.retain(|(tick, _)| (x.low..=x.high).contains(tick));
    }
    x
}

/// Places of shapes on the horizontal axis.
fn abscissae(items: &[Item], places: &mut Vec<f64>) {
    for item in items {
        match &item.shape {
            Shape::Line(points) => places.extend(points.iter().map(|point| point.0)),
            Shape::Area(areas) => places.extend(areas.iter().flatten().map(|point| point.0)),
            Shape::Segment(a, b) | Shape::Rect(a, b) => places.extend([a.x, b.x]),
            Shape::Symbol(_, place, _) => places.push(place.x),
            Shape::Within(_, items) => abscissae(items, places),
            Shape::Ribbon(..) | Shape::Label(_) => {}
        }
    }
}

/// An axis whose labels have room on a width, and beyond its ends: every second one, every third one, ...
fn thinned(axis: &Axis, width: f64, (left, right): (f64, f64)) -> Axis {
    let mut axis = axis.clone();
    let mut ticks = std::mem::take(&mut axis.ticks);
    ticks.retain(|(tick, text)| {
        let (middle, half) = (axis.share(*tick) * width, 0.5 * text_width(text, TEXT));
        middle - half > -left && middle + half < width + right
    });
    axis.ticks = ticks;
    let widest = axis
        .ticks
        .iter()
        .map(|(_, text)| text_width(text, TEXT) + 10.0);
    let widest = widest.fold(0.0, f64::max);
    let [first, .., last] = &axis.ticks[..] else {
        return axis;
    };
    let span = (axis.share(last.0) - axis.share(first.0)).abs() * width;
    let apart = span / (axis.ticks.len() - 1) as f64;
    let every = (widest / apart).ceil().max(1.0) as usize;
    // Zero keeps its label.
    let zero = axis
        .ticks
        .iter()
        .position(|(tick, _)| tick.abs() < 1e-12)
        .unwrap_or(0);
    let ticks = std::mem::take(&mut axis.ticks).into_iter().enumerate();
    let kept = ticks.filter(|(k, _)| k.abs_diff(zero) % every == 0);
    axis.ticks = kept.map(|(_, tick)| tick).collect();
    axis
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Property: words below a plot, turned or not, end above the next plot.
    #[test]
    fn words_below_a_plot_have_room() {
        let axis = || Axis::exact("", 0.0, 1.0, 3);
        let rect = || Rect::new(60.0, 60.0, 200.0, 150.0);
        for (turned, room) in [(true, 78.0), (false, 4.0)] {
            let mut first = Panel::new(rect(), axis(), axis()).x_labels(false);
            let place = at(0.5, f64::NEG_INFINITY).shift(4.0, 8.0);
            let label = Label::new(place, "a word that is longer than its room");
            let label = match turned {
                true => label.turned().end(),
                false => label,
            };
            first.label(label.cut(Cut::Middle, 78.0));
            let chart = Chart::new("t".to_owned(), "s", 60.0);
            let chart = chart.panels([first, Panel::new(rect(), axis(), axis())]);
            let narrow = chart.narrowed().unwrap();
            let [above, below] = &narrow.panels[..] else {
                panic!("two panels")
            };
            let free = below.rect.top - above.rect.bottom;
            assert!(free >= 8.0 + room, "{free}");
        }
    }
}
