//! Main effects: mean over all other factors, level by level, a panel for each factor.

use super::{FOOT, RIGHT, Shown, by_size, value};
use crate::charts::engine::{
    Axis, BELOW, Chart, Cut, Entry, Fill, LEFT, Label, PLAIN, PLOT_LEFT, Panel, Rect, Shape, Style,
    Symbol, at, cell, round_step, stroke, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital_first, sign};
use cvtcycle_study::statistics::{Group, Groups};

/// One factor.
#[derive(Clone, Debug)]
pub struct EffectFactor<'a> {
    /// Name.
    pub name: &'a str,
    /// Unit; `-` or empty without one.
    pub unit: &'a str,
    /// Positions of the levels, in the order of the groups; empty for words.
    pub at: Vec<f64>,
    /// Means and spreads of the output.
    pub groups: &'a Groups,
}

const TOP: f64 = 58.0;
const GAP: f64 = 14.0;
/// Maximum width of a panel, pixels.
const WIDEST: f64 = 480.0;
/// Most room of words that are turned, and room below them for the name of the factor, pixels.
const MAX_TURNED: f64 = 86.0;
const BELOW_TURNED: f64 = 30.0;
const LEVEL: f64 = 11.0;
const TITLE: f64 = 12.0;
/// Maximum number of drawn factors that fit on a page.
const MAX_FACTORS: usize = 12;

/// Draws the mean of the output at each level of each factor with its spread over all others (the deviation of draws, the ends of a grid), in
/// descending effect. A common vertical axis makes effects comparable.
pub fn effects_plot(shown: &Shown, factors: &[EffectFactor]) -> Picture {
    let mut factors: Vec<&EffectFactor> = factors.iter().collect();
    by_size(&mut factors, |f| f.groups.range);
    let table = table(shown, &factors);
    let mut note = "Over all levels of the other factors. Equal vertical axes; the largest range of means first.".to_owned();
    if factors.len() > MAX_FACTORS {
        let more = factors.len() - MAX_FACTORS;
        note += &format!(" {more} more factors in the table.");
        factors.truncate(MAX_FACTORS);
    }
    let drawn = groups(&factors).any(|g| g.sd.is_finite());
    let what = if drawn {
        "Standard deviation"
    } else {
        "Least to largest"
    };
    let spread = Entry::fill(Fill::plain("#dfe3eb"), what);
    let widest = factors.first().filter(|f| f.groups.range > 0.0);
    let title = match widest {
        Some(factor) => format!(
            "{} moves the mean {} most: by {}{}",
            capital_first(factor.name),
            shown.output,
            value(factor.groups.range, factor.groups.range),
            shown.after()
        ),
        None => format!("Main effects: {}", shown.output),
    };
    Chart::new(title, shown.subject, PLOT_LEFT)
        .panels(panels(shown, &factors))
        .legend(FOOT, [Entry::line(PLAIN, "Mean"), spread])
        .notes(FOOT, vec![note])
        .picture(table)
}

/// A panel for each factor, in rows.
fn panels(shown: &Shown, factors: &[&EffectFactor]) -> Vec<Panel> {
    let (columns, tall) = match factors.len() {
        0 | 1 => (1, 230.0),
        2..=4 => (2, 200.0),
        _ => (3, 150.0),
    };
    let room = RIGHT - 8.0 - columns as f64 * LEFT - (columns - 1) as f64 * GAP;
    let wide = (room / columns as f64).min(WIDEST);
    let ends = |g: &Group| [g.mean, band(g)[0], band(g)[1]];
    let y = Axis::round(&shown.axis("Mean"), groups(factors).flat_map(ends), 5);
    let (mut panels, mut top, mut table_row) = (Vec::new(), TOP, 0);
    for row in factors.chunks(columns) {
        let below = row.iter().map(|f| below(f, wide)).fold(BELOW, f64::max);
        for (column, factor) in row.iter().enumerate() {
            let left = PLOT_LEFT + (LEFT + wide + GAP) * column as f64;
            let rect = Rect::new(left, top, wide, tall);
            panels.push(draw(rect, factor, y.clone(), table_row).below(below + GAP));
            table_row += factor.groups.groups.len();
        }
        top += tall + below + GAP;
    }
    if factors.is_empty() {
        let axis = || Axis::exact("", 0.0, 1.0, 3);
        let panel = Panel::new(Rect::new(PLOT_LEFT, top, wide, tall), axis(), axis());
        panels.push(panel.no_data(true).x_labels(false));
    }
    panels
}

/// Room below a panel, pixels.
fn below(factor: &EffectFactor, wide: f64) -> f64 {
    match words(factor) && turned(factor, wide) {
        true => turned_room(factor) + BELOW_TURNED,
        false => BELOW,
    }
}

/// Room of the words of a factor that are turned, pixels: cut in their middle two of them may look alike.
fn turned_room(factor: &EffectFactor) -> f64 {
    let labels = factor.groups.groups.iter();
    let widths = labels.map(|group| text_width(&group.label, LEVEL) + 1.0);
    widths.fold(0.0, f64::max).min(MAX_TURNED)
}

/// A row for each level of each factor.
fn table(shown: &Shown, factors: &[&EffectFactor]) -> PictureTable {
    let columns = vec![
        ("Factor".to_owned(), ""),
        ("Level".to_owned(), ""),
        shown.column("Mean"),
        shown.column("Standard deviation"),
        shown.column("Least"),
        shown.column("Largest"),
        ("Runs".to_owned(), ""),
    ];
    let mut table = PictureTable::with_columns(columns);
    let widest = widest(factors);
    let step = round_step(if widest > 0.0 { widest / 500.0 } else { 1e-3 });
    for factor in factors {
        for group in &factor.groups.groups {
            let unit = unit_after(factor);
            let unit = if words(factor) { "" } else { &unit };
            let level = format!("{}{unit}", group.label);
            let numbers = [group.mean, group.sd, group.min, group.max].map(|x| cell(x, step));
            let head = [factor.name.to_owned(), level].into_iter().chain(numbers);
            table.push(head.chain([group.n.to_string()]));
        }
    }
    table
}

/// Maximum range of means; NaN without one.
fn widest(factors: &[&EffectFactor]) -> f64 {
    let ranges = factors.iter().map(|f| f.groups.range);
    ranges.filter(|r| *r > 0.0).fold(f64::NAN, f64::max)
}

fn unit_after(factor: &EffectFactor) -> String {
    if matches!(factor.unit, "" | "-") {
        String::new()
    } else {
        format!(" {}", sign(factor.unit))
    }
}

/// Ends of the band: a deviation either way, or minimum and maximum of values that are not a sample.
fn band(group: &Group) -> [f64; 2] {
    match group.sd.is_finite() {
        true => [group.mean - group.sd, group.mean + group.sd],
        false => [group.min, group.max],
    }
}

fn groups<'a>(factors: &[&EffectFactor<'a>]) -> impl Iterator<Item = &'a Group> {
    let groups = factors.iter().map(|f| f.groups.groups.iter());
    groups.collect::<Vec<_>>().into_iter().flatten()
}

fn words(factor: &EffectFactor) -> bool {
    factor.at.len() != factor.groups.groups.len() || factor.at.iter().any(|x| !x.is_finite())
}

/// Width available for the word of a level, pixels.
fn level_width(factor: &EffectFactor, wide: f64) -> f64 {
    wide / factor.groups.groups.len().max(1) as f64
}

/// True if words must be turned: they do not fit next to each other, and cutting would lose too much.
fn turned(factor: &EffectFactor, wide: f64) -> bool {
    let room = level_width(factor, wide) - 6.0;
    let mut labels = factor.groups.groups.iter().map(|g| &g.label);
    room < 60.0 && labels.any(|label| text_width(label, LEVEL) > room)
}

/// Position of each level on the horizontal axis.
fn places(factor: &EffectFactor) -> Vec<f64> {
    if words(factor) {
        (0..factor.groups.groups.len()).map(|k| k as f64).collect()
    } else {
        factor.at.clone()
    }
}

fn x_axis(factor: &EffectFactor, wide: f64) -> Axis {
    let places = places(factor);
    let low = places.iter().copied().min_by(f64::total_cmp).unwrap_or(0.0);
    let high = places.iter().copied().max_by(f64::total_cmp).unwrap_or(1.0);
    // Half a cell next to words; a small margin next to numbers, a larger one next to a lone one.
    match high - low {
        _ if words(factor) => Axis::bare(low - 0.5, high + 0.5),
        span => {
            let (lone, ticks) = (span <= 1e-9 * high.abs(), if wide > 300.0 { 6 } else { 3 });
            let around = (0.5 * high.abs()).max(1e-3);
            let room = if lone { around } else { 0.06 * span };
            Axis::exact("", low - room, high + room, ticks)
        }
    }
}

/// Position of a level, its row in the table, and its numbers.
type Level<'a> = (f64, usize, &'a Group);

/// Draws a factor; `row` is the table row of its first level.
fn draw(rect: Rect, factor: &EffectFactor, y: Axis, row: usize) -> Panel {
    let (words, places) = (words(factor), places(factor));
    let x = x_axis(factor, rect.width());
    let mut panel = Panel::new(rect, x, y).x_labels(!words);
    axis_title(&mut panel, factor);
    let groups = factor.groups.groups.iter().enumerate();
    let levels = groups.map(|(k, group)| (places[k], row + k, group));
    let mut levels: Vec<Level> = levels.filter(|l| l.2.mean.is_finite()).collect();
    levels.sort_by(|a, b| a.0.total_cmp(&b.0));
    panel.no_data = levels.is_empty();
    let style = Style::colour(PLAIN.colour).fill_opacity(0.14).class("band");
    if words || levels.len() < 2 {
        // A box of the spread at each word, since nothing lies between words.
        for (x, row, g) in &levels {
            let [low, high] = band(g);
            let (low, high) = (at(*x, low).shift(-5.0, 0.0), at(*x, high).shift(5.0, 0.0));
            panel.rectangle(low, high, style.clone().row(*row));
        }
    } else {
        let ends = |(x, _, g): &Level| (*x, band(g)[0], band(g)[1]);
        let ends: Vec<_> = levels.iter().map(ends).collect();
        panel.add(Shape::between(&ends), style);
    }
    // Words are unordered: the line between them only guides the eye.
    let line = if words {
        stroke(PLAIN.colour, 0.7, &[2.0, 2.5])
    } else {
        PLAIN
    };
    let means = levels.iter().map(|(x, _, g)| (*x, g.mean)).collect();
    panel.add(Shape::Line(means), Style::line(line));
    for (x, row, g) in levels {
        let style = Style::colour(PLAIN.colour).class("mark").row(row);
        panel.symbol(Symbol::CIRCLE, at(x, g.mean), 3.2, style);
    }
    if words {
        level_names(&mut panel, factor);
    }
    panel
}

/// Writes the factor and its unit under the levels, cut to the width of the panel.
fn axis_title(panel: &mut Panel, factor: &EffectFactor) {
    let unit = match (words(factor), unit_after(factor)) {
        (true, _) => String::new(),
        (false, unit) if unit.is_empty() => " [-]".to_owned(),
        (false, unit) => format!(" [{}]", unit.trim_start()),
    };
    let wide = panel.rect.width();
    let down = below(factor, wide) - 4.0;
    let place = at(f64::NEG_INFINITY, f64::NEG_INFINITY).shift(0.5 * wide, down);
    let label = Label::new(place, format!("{}{unit}", factor.name));
    let label = label.size(TITLE).middle().class("factor");
    panel.label(label.cut(Cut::Middle, wide));
}

fn level_names(panel: &mut Panel, factor: &EffectFactor) {
    let wide = panel.rect.width();
    for (k, group) in factor.groups.groups.iter().enumerate() {
        let label = |dx: f64, dy: f64| {
            let place = at(k as f64, f64::NEG_INFINITY).shift(dx, dy);
            Label::new(place, &group.label).class("level")
        };
        let (label, room) = if turned(factor, wide) {
            (label(4.0, 8.0).turned().end(), turned_room(factor))
        } else {
            (label(0.0, 16.0).middle(), level_width(factor, wide) - 6.0)
        };
        panel.label(label.cut(Cut::Middle, room));
    }
}
