//! Main effects of a grid: the mean over everything else, level by level, a panel a factor.

use super::super::axis::{Axis, round_step};
use super::super::figure::{Anchor, Figure, INK, Path, Rect, UNITS, escape, text_width, units};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::style::{PLAIN, Stroke};
use super::text::{Side, foot, foot_height, middle, name, value};
use super::{RIGHT, Shown, WIDTH, sign};
use cvtcycle_study::statistics::{Group, Groups};

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
const GAP: f64 = 14.0;
/// Widest panel, pixels.
const WIDEST: f64 = 480.0;
/// Room below a panel whose words stand upright, pixels.
const UPRIGHT: f64 = 108.0;
const LEVEL: f64 = 11.0;
const TITLE: f64 = 12.0;
const BAND: &str = "#1f3b73";
/// Most factors that are drawn: more do not fit on a page.
const MOST: usize = 12;

/// Draws the mean of the output at each level of each factor with its spread over all others, the factor with the largest effect first. All
/// panels have one vertical axis, so that effects can be compared.
#[must_use]
pub fn effects_plot(plot: &EffectsPlot) -> Picture {
    let mut factors: Vec<&EffectFactor> = plot.factors.iter().collect();
    let range = |f: &EffectFactor| f.groups.range;
    factors.sort_by(|a, b| {
        range(a)
            .is_nan()
            .cmp(&range(b).is_nan())
            .then(range(b).total_cmp(&range(a)))
    });
    let (table, desc) = (table(plot, &factors), describe(plot, &factors));
    let mut note = "Over all levels of the other factors. Equal vertical axes; the largest range of means first.".to_owned();
    if factors.len() > MOST {
        note += &format!(" {} more factors in the table.", factors.len() - MOST);
        factors.truncate(MOST);
    }
    let grid = Grid::of(&factors);
    let tall: f64 = factors
        .chunks(grid.columns)
        .map(|row| grid.tall + below(row, grid.wide) + GAP)
        .sum::<f64>()
        .max(grid.tall + GAP);
    let end = (LEFT + 8.0, TOP + tall);
    let keys = ["Mean", "Standard deviation"];
    let wide = RIGHT - end.0;
    let size = (
        WIDTH,
        end.1 + foot_height(keys.into_iter(), wide, std::slice::from_ref(&note)),
    );
    let title = format!("Main effects: {}", plot.shown.output);
    let mut figure = Figure::new(size, LEFT + 8.0, &title, plot.shown.subject, &desc);
    let ends = |g: &Group| [g.mean, g.mean - spread(g), g.mean + spread(g)];
    let all: Vec<f64> = factors
        .iter()
        .flat_map(|f| &f.groups.groups)
        .flat_map(ends)
        .collect();
    let (mut top, mut first_row) = (TOP, 0);
    for row in factors.chunks(grid.columns) {
        for (column, factor) in row.iter().enumerate() {
            let y = Axis::round(&plot.shown.axis("Mean"), all.iter().copied(), 5);
            draw(&mut figure, grid.rect(column, top), factor, y, first_row);
            first_row += factor.groups.groups.len();
        }
        top += grid.tall + below(row, grid.wide) + GAP;
    }
    if factors.is_empty() {
        Panel::draw(
            &mut figure,
            grid.rect(0, top),
            Axis::exact("", 0.0, 1.0, 3),
            Axis::exact("", 0.0, 1.0, 3),
            false,
        )
        .empty(&mut figure);
    }
    let marks = [Mark::Line(PLAIN), Mark::Fill("#dfe3eb".to_owned())];
    foot(
        &mut figure,
        end,
        wide,
        marks.into_iter().zip(keys).collect(),
        &[note],
    );
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// How panels stand.
struct Grid {
    columns: usize,
    wide: f64,
    tall: f64,
}

impl Grid {
    fn of(factors: &[&EffectFactor]) -> Self {
        let (columns, tall) = match factors.len() {
            0 | 1 => (1, 230.0),
            2..=4 => (2, 200.0),
            _ => (3, 150.0),
        };
        let room = RIGHT - 8.0 - columns as f64 * LEFT - (columns - 1) as f64 * GAP;
        Grid {
            columns,
            wide: (room / columns as f64).min(WIDEST),
            tall,
        }
    }

    fn rect(&self, column: usize, top: f64) -> Rect {
        let left = 8.0 + LEFT + (LEFT + self.wide + GAP) * column as f64;
        Rect {
            left,
            right: left + self.wide,
            top,
            bottom: top + self.tall,
        }
    }
}

/// Room below a row of panels, pixels.
fn below(row: &[&EffectFactor], wide: f64) -> f64 {
    if row.iter().any(|f| words(f) && upright(f, wide)) {
        UPRIGHT
    } else {
        BELOW
    }
}

/// A row for each level of each factor.
fn table(plot: &EffectsPlot, factors: &[&EffectFactor]) -> PictureTable {
    let mut columns = vec![("Factor".to_owned(), ""), ("Level".to_owned(), "")];
    columns.extend([
        plot.shown.column("Mean"),
        plot.shown.column("Standard deviation"),
        ("Runs".to_owned(), ""),
    ]);
    let mut table = PictureTable {
        columns,
        ..PictureTable::default()
    };
    let widest = factors
        .iter()
        .map(|f| f.groups.range)
        .filter(|r| *r > 0.0)
        .fold(f64::NAN, f64::max);
    let step = round_step(if widest > 0.0 { widest / 500.0 } else { 1e-3 });
    for factor in factors {
        for group in &factor.groups.groups {
            let level = if words(factor) {
                group.label.clone()
            } else {
                format!("{}{}", group.label, unit_after(factor))
            };
            table.push(vec![
                factor.name.to_owned(),
                level,
                cell(group.mean, step),
                cell(group.sd, step),
                group.n.to_string(),
            ]);
        }
    }
    table
}

fn unit_after(factor: &EffectFactor) -> String {
    if matches!(factor.unit, "" | "-") {
        String::new()
    } else {
        format!(" {}", sign(factor.unit))
    }
}

/// Half of the height of the band; nothing where there is a single value.
fn spread(group: &Group) -> f64 {
    if group.sd.is_finite() { group.sd } else { 0.0 }
}

fn words(factor: &EffectFactor) -> bool {
    factor.at.len() != factor.groups.groups.len() || factor.at.iter().any(|x| !x.is_finite())
}

/// Room for the word of a level, pixels.
fn slot(factor: &EffectFactor, wide: f64) -> f64 {
    wide / factor.groups.groups.len().max(1) as f64
}

/// Whether words have to stand upright: they do not fit beside each other, and cut they would say too little.
fn upright(factor: &EffectFactor, wide: f64) -> bool {
    let room = slot(factor, wide) - 6.0;
    room < 60.0
        && factor
            .groups
            .groups
            .iter()
            .any(|g| text_width(&g.label, LEVEL) > room)
}

/// Draws a factor, whose levels stand in the table from a row on.
fn draw(figure: &mut Figure, rect: Rect, factor: &EffectFactor, y: Axis, row: usize) {
    let groups = &factor.groups.groups;
    let words = words(factor);
    let at = |k: usize| if words { k as f64 } else { factor.at[k] };
    let mut order: Vec<usize> = (0..groups.len()).collect();
    order.sort_by(|&i, &j| at(i).total_cmp(&at(j)));
    let (low, high) = (
        order.first().map_or(0.0, |&k| at(k)),
        order.last().map_or(1.0, |&k| at(k)),
    );
    // Half a slot beside words; a little beside numbers, more beside a lone one.
    let room = match high - low {
        _ if words => 0.5,
        span if span > 1e-9 * high.abs() => 0.06 * span,
        _ => (0.5 * high.abs()).max(1e-3),
    };
    let mut x = Axis::exact(
        "",
        low - room,
        high + room,
        if rect.right - rect.left > 300.0 { 6 } else { 3 },
    );
    if words {
        x.ticks.clear();
    }
    let panel = Panel::draw(figure, rect, x, y, !words);
    axis_title(figure, rect, factor);
    let told: Vec<usize> = order
        .into_iter()
        .filter(|&k| groups[k].mean.is_finite())
        .collect();
    let spots: Vec<(f64, usize, &Group)> = told.iter().map(|&k| (at(k), k, &groups[k])).collect();
    if words {
        whiskers(figure, &panel, &spots, row);
    } else {
        band(figure, &panel, &spots, row);
    }
    // Words have no order: the line between them only leads the eye.
    let stroke = if words {
        Stroke {
            width: 0.7,
            dash: &[2.0, 2.5],
            ..PLAIN
        }
    } else {
        PLAIN
    };
    panel.line_any(
        figure,
        &told
            .iter()
            .map(|&k| (at(k), groups[k].mean))
            .collect::<Vec<_>>(),
        stroke,
    );
    for &k in &told {
        let (cx, cy, r) = (
            units(panel.px(at(k))),
            units(panel.py(groups[k].mean)),
            3.2 * UNITS,
        );
        let (row, colour) = (row + k, PLAIN.colour);
        figure.raw(&format!("<circle class=\"mark\" data-row=\"{row}\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" fill=\"{colour}\"/>"));
    }
    if told.is_empty() {
        panel.empty(figure);
    }
    if words {
        level_names(figure, &panel, factor);
    }
    panel.outline(figure);
}

/// Writes the factor and its unit under the levels, cut to the width of the panel.
fn axis_title(figure: &mut Figure, rect: Rect, factor: &EffectFactor) {
    let unit = match (words(factor), unit_after(factor)) {
        (true, _) => String::new(),
        (false, unit) if unit.is_empty() => " [-]".to_owned(),
        (false, unit) => format!(" [{}]", unit.trim_start()),
    };
    let wide = rect.right - rect.left;
    let shown = format!(
        "{}{unit}",
        middle(factor.name, TITLE, wide - text_width(&unit, TITLE))
    );
    let full = format!("{}{unit}", factor.name);
    let down = if words(factor) && upright(factor, wide) {
        UPRIGHT
    } else {
        BELOW
    };
    let at = (0.5 * (rect.left + rect.right), rect.bottom + down - 4.0);
    if shown != full {
        figure.raw(&format!("<g><title>{}</title>", escape(&full)));
    }
    figure.text(at, TITLE, Anchor::Middle, "class=\"factor\"", INK, &shown);
    if shown != full {
        figure.close();
    }
}

fn band(figure: &mut Figure, panel: &Panel, spots: &[(f64, usize, &Group)], row: usize) {
    if spots.len() < 2 {
        return whiskers(figure, panel, spots, row);
    }
    let mut path = Path::default();
    for (x, _, g) in spots {
        path.line_to(panel.px(*x), panel.py(g.mean + spread(g)));
    }
    for (x, _, g) in spots.iter().rev() {
        path.line_to(panel.px(*x), panel.py(g.mean - spread(g)));
    }
    path.close();
    let data = path.finish();
    figure.raw(&format!(
        "<path class=\"band\" d=\"{data}\" fill=\"{BAND}\" fill-opacity=\"0.14\" stroke=\"none\"/>"
    ));
}

/// A box of the spread at each word, for there is nothing between words.
fn whiskers(figure: &mut Figure, panel: &Panel, spots: &[(f64, usize, &Group)], row: usize) {
    for (x, k, g) in spots {
        let (top, bottom) = (panel.py(g.mean + spread(g)), panel.py(g.mean - spread(g)));
        let rect = Rect {
            left: panel.px(*x) - 5.0,
            right: panel.px(*x) + 5.0,
            top,
            bottom,
        };
        let row = row + k;
        figure.rect(rect, &format!("class=\"band\" data-row=\"{row}\" fill=\"{BAND}\" fill-opacity=\"0.14\" stroke=\"none\""));
    }
}

fn level_names(figure: &mut Figure, panel: &Panel, factor: &EffectFactor) {
    let wide = panel.rect.right - panel.rect.left;
    let upright = upright(factor, wide);
    for (k, group) in factor.groups.groups.iter().enumerate() {
        let x = panel.px(k as f64);
        if upright {
            let at = (x + 4.0, panel.rect.bottom + 8.0);
            let turn = format!(
                "class=\"level\" transform=\"rotate(-90 {} {})\"",
                units(at.0),
                units(at.1)
            );
            name(
                figure,
                at,
                Side::Left,
                (LEVEL, UPRIGHT - 30.0),
                &turn,
                &group.label,
            );
        } else {
            let at = (x, panel.rect.bottom + 16.0);
            name(
                figure,
                at,
                Side::Over,
                (LEVEL, slot(factor, wide) - 6.0),
                "class=\"level\"",
                &group.label,
            );
        }
    }
}

fn describe(plot: &EffectsPlot, factors: &[&EffectFactor]) -> String {
    let all = factors
        .iter()
        .map(|f| f.groups.range)
        .filter(|r| *r > 0.0)
        .fold(f64::NAN, f64::max);
    let level = |g: &Group| format!("{} at {}", value(g.mean, all), g.label);
    let told = |f: &&EffectFactor| {
        format!(
            "{}: {}",
            f.name,
            f.groups
                .groups
                .iter()
                .map(level)
                .collect::<Vec<_>>()
                .join(", ")
        )
    };
    format!(
        "Mean of {}{} at each level of each factor. {}.",
        plot.shown.output,
        plot.shown.after().replace('\u{a0}', " "),
        factors.iter().map(told).collect::<Vec<_>>().join("; ")
    )
}
