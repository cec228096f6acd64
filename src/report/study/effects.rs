//! Main effects of a grid: the mean over everything else, level by level, a panel a factor.

use super::super::axis::Axis;
use super::super::figure::{Figure, Path, Rect, UNITS, text_width, units};
use super::super::legend::{Mark, legend};
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::style::{PLAIN, Stroke};
use super::Shown;
use super::text::{Side, name, notes, value};
use crate::study::statistics::{Group, Groups};

/// Main effects and what they are on.
#[derive(Clone, Copy, Debug)]
pub struct EffectsPlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// Factors.
    pub factors: &'a [EffectFactor<'a>],
}

/// One factor.
#[derive(Clone, Debug)]
pub struct EffectFactor<'a> {
    /// Name.
    pub name: &'a str,
    /// Its unit; `-` or empty without one.
    pub unit: &'a str,
    /// Where the levels lie, in the order of the groups; empty if they are words.
    pub at: Vec<f64>,
    /// Means and spreads of the output.
    pub groups: &'a Groups,
}

const TOP: f64 = 58.0;
const HEADING: f64 = 22.0;
const WIDE: f64 = 210.0;
const TALL: f64 = 150.0;
const GAP: f64 = 16.0;
const STRIP: f64 = 200.0;
/// Room below a panel whose words stand upright, pixels.
const UPRIGHT: f64 = 84.0;
const LEVEL: f64 = 10.0;
const BAND: &str = "#1f3b73";

/// Draws the mean of the output at each level of each factor with its spread over all others, the factor with the largest effect first. All
/// panels have one vertical axis, so that effects can be compared.
#[must_use]
pub fn effects_plot(plot: &EffectsPlot) -> String {
    let mut factors: Vec<&EffectFactor> = plot.factors.iter().collect();
    let range = |f: &EffectFactor| f.groups.range;
    factors.sort_by(|a, b| range(a).is_nan().cmp(&range(b).is_nan()).then(range(b).total_cmp(&range(a))));
    let columns = match factors.len() {
        0 | 1 => 1,
        2..=4 => 2,
        5..=12 => 3,
        _ => 4,
    };
    let pitch = LEFT + WIDE + GAP;
    let right = 8.0 + pitch * columns as f64 - GAP;
    let below = |row: &[&EffectFactor]| if row.iter().any(|f| words(f) && upright(f)) { UPRIGHT } else { BELOW };
    let tall: f64 = factors.chunks(columns).map(|row| HEADING + TALL + below(row) + GAP).sum();
    let size = (right + 18.0 + STRIP, TOP + tall.max(260.0));
    let title = format!("Main effects: {}", plot.shown.output);
    let mut figure = Figure::new(size, LEFT + 8.0, &title, plot.shown.subject, &describe(plot, &factors));
    let ends = |g: &Group| [g.mean, g.mean - spread(g), g.mean + spread(g)];
    let all: Vec<f64> = factors.iter().flat_map(|f| &f.groups.groups).flat_map(ends).collect();
    let mut top = TOP + HEADING;
    for row in factors.chunks(columns) {
        for (column, factor) in row.iter().enumerate() {
            let left = 8.0 + LEFT + pitch * column as f64;
            let title = if column == 0 { plot.shown.axis("Mean") } else { String::new() };
            let y = Axis::round(&title, all.iter().copied(), 5);
            draw(&mut figure, Rect { left, right: left + WIDE, top, bottom: top + TALL }, factor, y);
        }
        top += HEADING + TALL + below(row) + GAP;
    }
    if factors.is_empty() {
        let rect = Rect { left: 8.0 + LEFT, right, top, bottom: top + TALL };
        Panel::draw(&mut figure, rect, Axis::exact("", 0.0, 1.0, 3), Axis::exact("", 0.0, 1.0, 3), false).empty(&mut figure);
    }
    let entries = [(Mark::Line(PLAIN), "Mean".to_owned()), (Mark::Fill("#dfe3eb".to_owned()), "Standard deviation".to_owned())];
    let beside = (right + 18.0, STRIP - 8.0);
    let end = legend(&mut figure, (beside.0, TOP + HEADING), beside.1, "", &entries);
    let note = "Over all levels of the other factors. Equal vertical axes; the largest range of means first.";
    notes(&mut figure, (beside.0, end + 10.0), beside.1, &[note.to_owned()]);
    figure.finish()
}

/// Half of the height of the band; nothing where there is a single value.
fn spread(group: &Group) -> f64 {
    if group.sd.is_finite() { group.sd } else { 0.0 }
}

fn words(factor: &EffectFactor) -> bool {
    factor.at.len() != factor.groups.groups.len() || factor.at.iter().any(|x| !x.is_finite())
}

/// Room for the word of a level, pixels.
fn slot(factor: &EffectFactor) -> f64 {
    WIDE / factor.groups.groups.len().max(1) as f64
}

/// Whether words have to stand upright: they do not fit beside each other, and cut they would say too little.
fn upright(factor: &EffectFactor) -> bool {
    let room = slot(factor) - 6.0;
    room < 60.0 && factor.groups.groups.iter().any(|g| text_width(&g.label, LEVEL) > room)
}

fn draw(figure: &mut Figure, rect: Rect, factor: &EffectFactor, y: Axis) {
    let groups = &factor.groups.groups;
    let words = words(factor);
    let at = |k: usize| if words { k as f64 } else { factor.at[k] };
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by(|&i, &j| at(i).total_cmp(&at(j)));
    let (low, high) = (order.first().map_or(0.0, |&k| at(k)), order.last().map_or(1.0, |&k| at(k)));
    // Half a slot beside words; a little beside numbers, more beside a lone one.
    let room = match high - low {
        _ if words => 0.5,
        span if span > 1e-9 * high.abs() => 0.06 * span,
        _ => (0.5 * high.abs()).max(1e-3),
    };
    let unit = if words || matches!(factor.unit, "" | "-") { String::new() } else { format!("[{}]", factor.unit) };
    let mut x = Axis::exact(&unit, low - room, high + room, 3);
    if words {
        x.ticks.clear();
    }
    let panel = Panel::draw(figure, rect, x, y, !words);
    let title_at = (rect.left, rect.top - 7.0);
    name(figure, title_at, Side::Right, (12.0, WIDE), "class=\"factor\" font-weight=\"bold\"", factor.name);
    let told: Vec<usize> = order.into_iter().filter(|&k| groups[k].mean.is_finite()).collect();
    if words {
        whiskers(figure, &panel, &told.iter().map(|&k| (at(k), &groups[k])).collect::<Vec<_>>());
    } else {
        band(figure, &panel, &told.iter().map(|&k| (at(k), &groups[k])).collect::<Vec<_>>());
    }
    // Words have no order: the line between them only leads the eye.
    let stroke = if words { Stroke { width: 0.7, dash: &[2.0, 2.5], ..PLAIN } } else { PLAIN };
    panel.line_any(figure, &told.iter().map(|&k| (at(k), groups[k].mean)).collect::<Vec<_>>(), stroke);
    for &k in &told {
        let (cx, cy, r) = (units(panel.px(at(k))), units(panel.py(groups[k].mean)), 2.8 * UNITS);
        figure.raw(&format!("<circle class=\"mark\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" fill=\"{}\" stroke=\"none\"/>", PLAIN.colour));
    }
    if told.is_empty() {
        panel.empty(figure);
    }
    if words {
        level_names(figure, &panel, factor);
    }
    panel.outline(figure);
}

fn band(figure: &mut Figure, panel: &Panel, groups: &[(f64, &Group)]) {
    let mut path = Path::default();
    for (x, g) in groups {
        path.line_to(panel.px(*x), panel.py(g.mean + spread(g)));
    }
    for (x, g) in groups.iter().rev() {
        path.line_to(panel.px(*x), panel.py(g.mean - spread(g)));
    }
    path.close();
    let data = path.finish();
    if groups.len() > 1 {
        figure.raw(&format!("<path class=\"band\" d=\"{data}\" fill=\"{BAND}\" fill-opacity=\"0.14\" stroke=\"none\"/>"));
    } else {
        whiskers(figure, panel, groups);
    }
}

/// A box of the spread at each word, for there is nothing between words.
fn whiskers(figure: &mut Figure, panel: &Panel, groups: &[(f64, &Group)]) {
    for (x, g) in groups {
        let (top, bottom) = (panel.py(g.mean + spread(g)), panel.py(g.mean - spread(g)));
        let rect = Rect { left: panel.px(*x) - 4.0, right: panel.px(*x) + 4.0, top, bottom };
        figure.rect(rect, &format!("class=\"band\" fill=\"{BAND}\" fill-opacity=\"0.14\" stroke=\"none\""));
    }
}

fn level_names(figure: &mut Figure, panel: &Panel, factor: &EffectFactor) {
    let upright = upright(factor);
    for (k, group) in factor.groups.groups.iter().enumerate() {
        let x = panel.px(k as f64);
        if upright {
            let at = (x + 3.6, panel.rect.bottom + 8.0);
            let turn = format!("class=\"level\" transform=\"rotate(-90 {} {})\"", units(at.0), units(at.1));
            name(figure, at, Side::Left, (LEVEL, UPRIGHT - 12.0), &turn, &group.label);
        } else {
            let at = (x, panel.rect.bottom + 16.0);
            name(figure, at, Side::Over, (LEVEL, slot(factor) - 6.0), "class=\"level\"", &group.label);
        }
    }
}

fn describe(plot: &EffectsPlot, factors: &[&EffectFactor]) -> String {
    let all = factors.iter().map(|f| f.groups.range).filter(|r| *r > 0.0).fold(f64::NAN, f64::max);
    let level = |g: &Group| format!("{} at {}", value(g.mean, all), g.label);
    let told = |f: &&EffectFactor| format!("{}: {}", f.name, f.groups.groups.iter().map(level).collect::<Vec<_>>().join(", "));
    format!(
        "Mean of {}{} at each level of each factor. {}.",
        plot.shown.output,
        plot.shown.after().replace('\u{a0}', " "),
        factors.iter().map(told).collect::<Vec<_>>().join("; ")
    )
}
