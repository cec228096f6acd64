//! Errors of computed fuel of many cars by groups and over a number, and differences of pairs: computed against measured.

use super::engine::{
    Axis, BELOW, CONTEXT, Chart, Entry, Fill, INK, LEFT, Label, PLOT_LEFT, Panel, QUIET, Rect,
    Style, Symbol, WIDTH, ZERO, at, grid, range, row_middle, rows_left, rows_panel, stroke,
};
use super::picture::{Picture, PictureTable};
use cvtcycle_output::number::{fixed, signed};
use cvtcycle_output::table::distinct;

/// The error of a car.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetError {
    /// Name of the car.
    pub car: String,
    /// Group, such as its make.
    pub group: String,
    /// Number over which it is drawn, such as engine speed over road speed.
    pub over: f64,
    /// Kind of its box.
    pub transmission: String,
    /// Figure, such as `FTP75`.
    pub figure: String,
    /// Computed over measured fuel, less one, per cent.
    pub error_percent: f64,
}

/// The difference of a car to one that it is a pair with.
#[derive(Clone, Debug, PartialEq)]
pub struct FleetPair {
    /// Name of the car.
    pub car: String,
    /// Group, such as its make.
    pub group: String,
    /// Figure, such as `FTP75`.
    pub figure: String,
    /// Measured difference, per cent.
    pub measured_percent: f64,
    /// Computed difference, per cent.
    pub computed_percent: f64,
}

/// Within which tests of equal cars repeat, per cent, of HWFET and of all others: US lists of 2010 to 2019.
#[must_use]
pub fn repeat_percent(figure: &str) -> f64 {
    match figure {
        "HWFET" => 2.5,
        _ => 2.8,
    }
}

const RIGHT: f64 = WIDTH - 150.0;
const TOP: f64 = 58.0;
const ROW: f64 = 20.0;
const RADIUS: f64 = 3.2;
/// Room between the panels of two figures, with the heading of the second, pixels.
const BETWEEN: f64 = 30.0;
/// Most groups of a picture.
const MOST: usize = 30;
const BAND: &str = "#d4dae6";

/// The band that two tests of one car fill.
pub(super) fn band() -> Style {
    Style::fill(Fill::plain(BAND)).fill_opacity(0.7)
}

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len() as f64
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt()
}

/// A dot for the error of each car, a row for each group and a panel for each figure; the mark is the mean of a group. `by` names the groups.
#[must_use]
pub fn fleet_by_group(by: &str, errors: &[FleetError]) -> Picture {
    let figures = distinct(errors.iter().map(|error| error.figure.as_str()));
    let mut groups = distinct(errors.iter().map(|error| error.group.as_str()));
    groups.sort_unstable();
    groups.truncate(MOST);
    let left = rows_left(groups.iter().copied(), 11.0);
    let height = groups.len().max(1) as f64 * ROW + 6.0;
    let title = |figure: &str| format!("{figure}: computed over measured fuel, less one [%]");
    let axis = |figure: &str| {
        let all = errors.iter().map(|error| error.error_percent);
        Axis::round(&title(figure), all.chain([0.0]), 10)
    };
    let mut table =
        PictureTable::new(&[("Figure", ""), ("Group", ""), ("Car", ""), ("Error", "%")]);
    let mut panels = Vec::new();
    for (f, figure) in figures.iter().enumerate() {
        let top = TOP + f as f64 * (height + BELOW + BETWEEN);
        let mut panel = rows_panel((left, top), RIGHT, groups.len(), ROW, axis(figure));
        let repeat = repeat_percent(figure);
        panel.rectangle(
            at(-repeat, f64::NEG_INFINITY),
            at(repeat, f64::INFINITY),
            band(),
        );
        panel.upright(0.0, ZERO);
        for (k, group) in groups.iter().enumerate() {
            panel.row_name(k, Label::new(at(0.0, 0.0), *group).class("row"));
            let own = errors
                .iter()
                .filter(|error| error.figure == *figure && error.group == *group);
            let mut list = Vec::new();
            for (j, error) in own.enumerate() {
                let row = table.push([
                    error.figure.clone(),
                    error.group.clone(),
                    error.car.clone(),
                    signed(error.error_percent, 1),
                ]);
                let colour = Symbol::nth(usize::from(error.transmission == "manual"));
                let shift = 2.2 * ((j % 5) as f64 - 2.0);
                let place = at(error.error_percent, row_middle(k)).shift(0.0, shift);
                panel.symbol(colour.0, place, RADIUS, Symbol::filled(colour.1).row(row));
                list.push(error.error_percent);
            }
            if list.is_empty() {
                continue;
            }
            let x = mean(&list);
            let ends = [-7.0, 7.0].map(|dy| at(x, row_middle(k)).shift(0.0, dy));
            panel.segment(ends[0], ends[1], Style::line(stroke(INK, 2.0, &[])));
            let words = format!(
                "{} %, rms {}, n {}",
                signed(x, 1),
                fixed(rms(&list), 1),
                list.len()
            );
            let place = at(f64::INFINITY, row_middle(k)).shift(8.0, 4.0);
            panel.label(Label::new(place, words).size(10.0).colour(QUIET));
        }
        panels.push(panel);
    }
    let foot = (left, RIGHT - left);
    let note = "Dot: a car; line: mean of the group; band: tests of equal cars repeat within 2.8 % on FTP75 and 2.5 % on HWFET.";
    Chart::new(
        format!("Error by {by}"),
        spread(errors, &figures),
        PLOT_LEFT,
    )
    .panels(panels)
    .legend(foot, boxes(errors))
    .notes(foot, vec![note.to_owned()])
    .picture(table)
}

/// "FTP75: rms 5.6 % of 88 cars; HWFET: ...".
fn spread(errors: &[FleetError], figures: &[&str]) -> String {
    let of = |figure: &&str| {
        let own = errors.iter().filter(|error| error.figure == **figure);
        let own: Vec<f64> = own.map(|error| error.error_percent).collect();
        format!(
            "{figure}: rms {} % of {} cars",
            fixed(rms(&own), 1),
            own.len()
        )
    };
    figures.iter().map(of).collect::<Vec<_>>().join("; ")
}

/// Symbols of the boxes that are there.
fn boxes(errors: &[FleetError]) -> Vec<Entry> {
    let names = [("cvt", "CVT"), ("manual", "manual box")];
    let known = names
        .into_iter()
        .enumerate()
        .filter(|(_, (word, _))| errors.iter().any(|error| error.transmission == *word));
    known
        .map(|(k, (_, name))| {
            let (symbol, colour) = Symbol::nth(k);
            Entry::symbol(symbol, Symbol::filled(colour), name)
        })
        .collect()
}

/// Panels side by side, one for each figure.
fn side_by_side(count: usize) -> impl Fn(usize) -> Rect {
    let right = WIDTH - 24.0;
    let room = (right - 8.0 - 2.0 * LEFT - 18.0) / 2.0;
    let size = match count {
        0 | 1 => (460.0, 460.0),
        _ => (room, room),
    };
    grid(
        (PLOT_LEFT, TOP),
        size,
        (LEFT + size.0 + 18.0, size.1 + BELOW + 10.0),
        2,
    )
}

/// The foot of panels side by side.
const FOOT: (f64, f64) = (PLOT_LEFT, WIDTH - 24.0 - PLOT_LEFT);

/// The error of each car over a number; `over` names it with its unit.
#[must_use]
pub fn fleet_over(over: &str, errors: &[FleetError]) -> Picture {
    let figures = distinct(errors.iter().map(|error| error.figure.as_str()));
    let place = side_by_side(figures.len());
    let mut table = PictureTable::new(&[("Figure", ""), ("Car", ""), (over, ""), ("Error", "%")]);
    let all = || errors.iter().map(|error| error.error_percent);
    let numbers = || errors.iter().map(|error| error.over);
    let mut panels = Vec::new();
    for (k, figure) in figures.iter().enumerate() {
        let x = Axis::round(over, numbers(), 6);
        let ends = [x.low, x.high];
        let title = format!("Error of {figure} [%]");
        let mut panel = Panel::new(place(k), x, Axis::round(&title, all().chain([0.0]), 8));
        let repeat = repeat_percent(figure);
        panel.rectangle(at(ends[0], -repeat), at(ends[1], repeat), band());
        panel.level(0.0, ZERO);
        let own: Vec<&FleetError> = errors
            .iter()
            .filter(|error| error.figure == *figure)
            .collect();
        for error in &own {
            let row = table.push([
                error.figure.clone(),
                error.car.clone(),
                fixed(error.over, 2),
                signed(error.error_percent, 1),
            ]);
            let (symbol, colour) = Symbol::nth(usize::from(error.transmission == "manual"));
            let place = at(error.over, error.error_percent);
            panel.symbol(symbol, place, RADIUS, Symbol::filled(colour).row(row));
        }
        if let Some((a, b)) = line(&own) {
            let [from, to] = range(own.iter().map(|error| error.over))
                .map_or(ends, |(low, high)| [low, high])
                .map(|x| at(x, a + b * x));
            panel.segment(from, to, Style::line(CONTEXT));
        }
        panels.push(panel);
    }
    let note = "Line: least squares; band: tests of equal cars repeat within 2.8 % on FTP75 and 2.5 % on HWFET.";
    Chart::new(
        format!("Error by {}", over.split(" [").next().unwrap_or(over)),
        spread(errors, &figures),
        PLOT_LEFT,
    )
    .panels(panels)
    .legend(FOOT, boxes(errors))
    .notes(FOOT, vec![note.to_owned()])
    .picture(table)
}

/// Constant and slope of the line of least squares; `None` of points at one place.
fn line(errors: &[&FleetError]) -> Option<(f64, f64)> {
    let n = errors.len() as f64;
    let mx = errors.iter().map(|error| error.over).sum::<f64>() / n;
    let my = errors.iter().map(|error| error.error_percent).sum::<f64>() / n;
    let of = |f: fn(f64, f64) -> f64| -> f64 {
        let terms = errors
            .iter()
            .map(|error| f(error.over - mx, error.error_percent - my));
        terms.sum()
    };
    let (xx, xy) = (of(|x, _| x * x), of(|x, y| x * y));
    (xx > 0.0).then(|| (my - mx * xy / xx, xy / xx))
}

/// The computed difference of each pair against the measured one, a symbol for each group. The band is root 2 times that of one
/// test.
#[must_use]
pub fn fleet_pairs(pairs: &[FleetPair]) -> Picture {
    let figures = distinct(pairs.iter().map(|pair| pair.figure.as_str()));
    let groups = distinct(pairs.iter().map(|pair| pair.group.as_str()));
    let place = side_by_side(figures.len());
    let mut table = PictureTable::new(&[
        ("Figure", ""),
        ("Car", ""),
        ("Group", ""),
        ("Measured", "%"),
        ("Computed", "%"),
        ("Error", "points"),
    ]);
    let mut panels = Vec::new();
    for (k, figure) in figures.iter().enumerate() {
        let own = || pairs.iter().filter(|pair| pair.figure == *figure);
        let seen = own().flat_map(|pair| [pair.measured_percent, pair.computed_percent, 0.0]);
        let (low, high) = range(seen).unwrap_or((-1.0, 1.0));
        let room = 0.08 * (high - low) + 0.5;
        let [from, to] = [low - room, high + room];
        let axis =
            |what: &str| Axis::exact(&format!("{what} difference, {figure} [%]"), from, to, 7);
        let mut panel = Panel::new(place(k), axis("Measured"), axis("Computed"));
        let half = std::f64::consts::SQRT_2 * repeat_percent(figure);
        let corners = [
            (from, from - half),
            (from, from + half),
            (to, to + half),
            (to, to - half),
        ];
        panel.add(
            super::engine::Shape::Within(
                None,
                vec![super::engine::Item {
                    shape: super::engine::Shape::Area(vec![corners.to_vec()]),
                    style: band(),
                }],
            ),
            Style::default(),
        );
        panel.level(0.0, ZERO);
        panel.upright(0.0, ZERO);
        panel.segment(at(from, from), at(to, to), Style::line(CONTEXT));
        for pair in own() {
            let error = pair.computed_percent - pair.measured_percent;
            let words = [pair.figure.clone(), pair.car.clone(), pair.group.clone()];
            let numbers = [
                signed(pair.measured_percent, 1),
                signed(pair.computed_percent, 1),
                signed(error, 1),
            ];
            let row = table.push(words.into_iter().chain(numbers));
            let group = groups.iter().position(|group| *group == pair.group);
            let (symbol, colour) = Symbol::nth(group.unwrap_or(0));
            panel.symbol(
                symbol,
                at(pair.measured_percent, pair.computed_percent),
                RADIUS,
                Symbol::filled(colour).row(row),
            );
        }
        panels.push(panel);
    }
    let entries = groups.iter().enumerate().map(|(k, name)| {
        let (symbol, colour) = Symbol::nth(k);
        Entry::symbol(symbol, Symbol::filled(colour), *name)
    });
    let of = |figure: &&str| {
        let own = pairs.iter().filter(|pair| pair.figure == **figure);
        let errors: Vec<f64> = own
            .map(|pair| pair.computed_percent - pair.measured_percent)
            .collect();
        format!(
            "{figure}: rms {} points of {} pairs",
            fixed(rms(&errors), 1),
            errors.len()
        )
    };
    let said: Vec<String> = figures.iter().map(of).collect();
    let note = "Line: computed = measured; band: root 2 times that within which tests of equal cars repeat, 2.8 % on FTP75 and 2.5 % on HWFET.";
    Chart::new(
        "Difference to the same car with a manual box",
        said.join("; "),
        PLOT_LEFT,
    )
    .panels(panels)
    .legend(FOOT, entries)
    .notes(FOOT, vec![note.to_owned()])
    .picture(table)
}
