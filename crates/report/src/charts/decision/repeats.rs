//! One part of a cycle driven repeatedly while the oil warms: cost of the cold by group of losses, everything else equal.

use super::{MARGIN, TOP, says};
use crate::charts::engine::{
    Axis, BELOW, Chart, End, Panel, RULE, Rect, Shape, Style, Symbol, WIDTH, at, cell, group_line,
    stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, capital_first, grouped, words};
use cvtcycle_model::transmission::component::LossGroup;

/// Left and right edge of the plot, and its height, pixels.
const SIDES: (f64, f64) = (78.0, WIDTH - 250.0);
const TALL: f64 = 300.0;
/// Row of the first group in the table, after those of the oil.
const FIRST_ROW: usize = 2;

/// One repetition of the drive.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Repeat {
    /// Oil at its beginning and end, degC.
    pub oil_degc: [f64; 2],
    /// Loss of each group, kJ, all drives in the same order.
    pub losses_kj: Vec<(LossGroup, f64)>,
}

impl Repeat {
    fn total_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| kj).sum()
    }
}

/// Draws a line for each group of losses over the drives, named at its end; `subject` is the car with the repeated part.
pub fn repeats(subject: &str, drives: &[Repeat]) -> Picture {
    let last = drives.len().saturating_sub(1);
    let places = drives
        .iter()
        .enumerate()
        .map(|(k, drive)| (k as f64, span(drive)));
    let pad = 0.04 * last.max(1) as f64;
    let x = Axis::labelled(
        "Transmission oil, beginning to end [degC]",
        (-pad, last as f64 + pad),
        places.collect(),
    );
    let values = drives
        .iter()
        .flat_map(|drive| drive.losses_kj.iter().map(|(_, kj)| *kj));
    let y = Axis::round("Loss in one drive [kJ]", values.chain([0.0]), 6);
    let rect = Rect::new(SIDES.0, TOP, SIDES.1 - SIDES.0, TALL);
    let mut panel = Panel::new(rect, x, y)
        .below(BELOW + 10.0)
        .no_data(drives.len() < 2);
    for k in 0..drives.len() {
        panel.upright(k as f64, RULE);
    }
    let mut parts = Vec::new();
    let groups = drives.first().map_or(&[][..], |drive| &drive.losses_kj);
    for (g, (group, first)) in groups.iter().enumerate() {
        let points = drives
            .iter()
            .enumerate()
            .map(|(k, drive)| (k as f64, drive.losses_kj[g].1));
        let points: Vec<(f64, f64)> = points.collect();
        let end = points.last().map_or(*first, |point| point.1);
        let colour = group_line(*group);
        panel.add(
            Shape::Line(points.clone()),
            Style::line(stroke(colour, 2.2, &[])).class("series"),
        );
        for point in &points {
            panel.symbol(
                Symbol::CIRCLE,
                at(point.0, point.1),
                3.4,
                Symbol::filled(colour).row(FIRST_ROW + g),
            );
        }
        parts.push((words(group.name()), [*first, end]));
    }
    let ends = groups.iter().zip(&parts);
    let ends = ends.map(|((group, _), part)| named(*group, part, last as f64));
    panel.ends = ends.collect();
    let totals: Vec<f64> = drives.iter().map(Repeat::total_kj).collect();
    let title = says::repeats(&totals, &parts);
    Chart::new(title, subject, MARGIN)
        .panels([panel])
        .picture(table(drives))
}

fn span(drive: &Repeat) -> String {
    let [from, to] = drive.oil_degc.map(|degc| grouped(degc, 0));
    format!("{from} to {to}")
}

/// Names and changes at the ends of the lines.
fn named(group: LossGroup, parts: &(String, [f64; 2]), last: f64) -> End {
    let (name, [from, to]) = parts;
    let change = 100.0 * (to / from - 1.0);
    let change = crate::number::signed(grouped(change, 0), change);
    End {
        at: (last, *to),
        text: format!("{} {} ({change} %)", capital_first(name), grouped(*to, 0)),
        colour: group_line(group),
    }
}

fn table(drives: &[Repeat]) -> PictureTable {
    let heads = (1..=drives.len()).map(|k| (format!("Drive {k}"), ""));
    let columns = [("".to_owned(), "")].into_iter().chain(heads);
    let mut table = PictureTable::with_columns(columns);
    let mut row = |name: &str, value_of: &dyn Fn(&Repeat) -> f64| {
        let cells = drives.iter().map(|drive| cell(value_of(drive), 0.1));
        table.push([name.to_owned()].into_iter().chain(cells));
    };
    row("Oil at the beginning [degC]", &|drive| drive.oil_degc[0]);
    row("Oil at the end [degC]", &|drive| drive.oil_degc[1]);
    let groups = drives.first().map_or(&[][..], |drive| &drive.losses_kj);
    for (g, (group, _)) in groups.iter().enumerate() {
        row(&format!("{} [kJ]", capital(group.name())), &|drive| {
            drive.losses_kj[g].1
        });
    }
    row("All [kJ]", &Repeat::total_kj);
    table
}
