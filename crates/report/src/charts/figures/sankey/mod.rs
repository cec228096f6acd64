//! Where energy goes: a trunk from a source through stages, each of which branches off its flows. Widths are in proportion to energy.
//!
//! Branches leave the trunk downwards and end in one column at the right, the last stage on top: so none crosses another, and the ends
//! are far enough apart for one line of text each. What is negative flows in: it begins at the left above the source.

mod layout;

use layout::{Flows, Ribbon, lay_out};

use super::{MARGIN, TEXT, TOP, Term, energy, finite, percent};
use crate::charts::engine::{
    Chart, Cut, Label, Panel, QUIET, Rect, Shape, Style, WIDTH, at, cell, free, lines, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::Component;

/// An energy flow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sankey {
    /// What it shows.
    pub title: String,
    /// Of which car.
    pub subject: String,
    /// Name and energy of what the trunk begins with, kJ.
    pub source: (String, f64),
    /// Stages along the trunk.
    pub stages: Vec<SankeyStage>,
    /// Name and size of what shares of energies refer to, kJ; one or two.
    pub shares_of: Vec<(String, f64)>,
}

/// A place along the trunk.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SankeyStage {
    /// Name; a stage without one is not marked on the trunk.
    pub name: String,
    /// What leaves here.
    pub branches: Vec<SankeyBranch>,
}

/// A flow that leaves the trunk, or enters it if its energy is negative.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SankeyBranch {
    /// Name.
    pub name: String,
    /// Energy, kJ.
    pub kj: f64,
    /// Component of the transmission, for its fill.
    pub component: Option<Component>,
    /// What it is otherwise, for its fill.
    pub term: Term,
}

impl SankeyBranch {
    /// A loss of the transmission.
    #[must_use]
    pub fn of(component: Component, kj: f64) -> Self {
        SankeyBranch {
            name: capital(component.name()),
            kj,
            component: Some(component),
            term: Term::Other,
        }
    }

    /// A term of the ledger.
    #[must_use]
    pub fn term(name: &str, term: Term, kj: f64) -> Self {
        SankeyBranch {
            name: name.to_owned(),
            kj,
            component: None,
            term,
        }
    }
}

/// Height of all that flows in, pixels.
const TALL: f64 = 300.0;
/// Where what flows in begins: its label lies left of it, pixels.
const LEFT: f64 = 118.0;
/// Height of the names of stages above the trunk, pixels.
const BAND: f64 = 62.0;
/// Height of a line of a label, pixels.
const LINE: f64 = 14.0;
/// Distance between two columns of shares, pixels.
const SHARE: f64 = 76.0;

/// Draws an energy flow.
#[must_use]
pub fn sankey(of: &Sankey) -> Picture {
    let of = balanced(of);
    let flows = lay_out(&of);
    let mut table = PictureTable::new(&[("flow", ""), ("way", ""), ("energy", "kJ")]);
    let shares = of
        .shares_of
        .iter()
        .map(|(name, _)| (format!("share of {name}"), "%"));
    table.columns.extend(shares);
    table.note =
        "Widths are in proportion to energy. What enters and what leaves add up to the same sum."
            .to_owned();
    let mut panel = free(Rect::new(0.0, 0.0, WIDTH, flows.bottom));
    panel.below = 16.0;
    flows.draw_trunk(&mut panel, &mut table);
    for ribbon in &flows.entering {
        flows.draw_entering(&mut panel, ribbon, &mut table);
    }
    for ribbon in &flows.leaving {
        flows.draw_leaving(&mut panel, ribbon, &mut table);
    }
    if scale(&of) <= 0.0 {
        let place = at(0.5 * (LEFT + flows.end), TOP + BAND + 80.0);
        panel.label(
            Label::new(place, "no energy flows")
                .size(12.0)
                .middle()
                .quiet(),
        );
    }
    flows.stage_names(&mut panel);
    flows.headings(&mut panel);
    let chart = Chart {
        title: of.title.clone(),
        subject: of.subject.clone(),
        description: describe(&of),
        left: MARGIN,
        panels: vec![panel],
        table,
        ..Chart::default()
    };
    chart.picture()
}

/// The same flow with a source that is not negative, finite numbers, and nothing left over at the end of the trunk.
fn balanced(of: &Sankey) -> Sankey {
    let mut of = of.clone();
    if of.stages.is_empty() {
        of.stages.push(SankeyStage::default());
    }
    of.source.1 = finite(of.source.1);
    for branch in of.stages.iter_mut().flat_map(|stage| &mut stage.branches) {
        branch.kj = finite(branch.kj);
    }
    let mut last = Vec::new();
    if of.source.1 < 0.0 {
        last.push(SankeyBranch::term(&of.source.0, Term::Trunk, -of.source.1));
        of.source.1 = 0.0;
    }
    let branches = || {
        of.stages
            .iter()
            .flat_map(|stage| &stage.branches)
            .chain(&last)
            .map(|branch| branch.kj)
    };
    let left_over = of.source.1 - branches().sum::<f64>();
    if left_over.abs() > 1e-6 * (of.source.1 + branches().map(f64::abs).sum::<f64>()) {
        last.push(SankeyBranch::term(
            "Not accounted for",
            Term::Other,
            left_over,
        ));
    }
    if let Some(stage) = of.stages.last_mut() {
        stage.branches.extend(last);
    }
    of
}

/// Pixels per kJ; zero where nothing flows.
fn scale(of: &Sankey) -> f64 {
    let inflow: f64 = of.source.1
        + of.stages
            .iter()
            .flat_map(|stage| &stage.branches)
            .map(|b| (-b.kj).max(0.0))
            .sum::<f64>();
    if inflow > 0.0 && (TALL / inflow).is_finite() {
        TALL / inflow
    } else {
        0.0
    }
}

/// Adds a row to the table; returns its index.
fn push(table: &mut PictureTable, of: &Sankey, name: &str, way: &str, kj: f64) -> usize {
    let shares = of.shares_of.iter().map(|(_, whole)| 100.0 * kj / whole);
    let numbers = [kj].into_iter().chain(shares).map(|x| cell(x, 0.01));
    table.push(
        [name.to_owned(), way.to_owned()]
            .into_iter()
            .chain(numbers)
            .collect(),
    )
}

impl Flows<'_> {
    /// Place of a stage along the trunk, pixels.
    fn stage_x(&self, stage: usize) -> f64 {
        let first = LEFT + 0.09 * (self.end - LEFT);
        let last = self.end - 0.2 * (self.end - LEFT);
        let share = if self.of.stages.len() > 1 {
            stage as f64 / (self.of.stages.len() - 1) as f64
        } else {
            0.5
        };
        first + share * (last - first)
    }

    fn draw_trunk(&self, panel: &mut Panel, table: &mut PictureTable) {
        let (name, kj) = &self.of.source;
        let source = push(table, self.of, name, "enters", *kj);
        let mut from = LEFT;
        for (s, (stage, trunk)) in self.of.stages.iter().zip(&self.trunk).enumerate() {
            let to = self.stage_x(s);
            let row = if s == 0 || stage.name.is_empty() {
                source
            } else {
                push(table, self.of, &stage.name, "arrives", trunk.kj)
            };
            if trunk.bottom > trunk.top {
                let style = Style::fill(Term::Trunk.fill(None))
                    .crisp()
                    .class("trunk")
                    .row(row);
                panel.add(
                    Shape::Rect(at(from, trunk.top), at(to, trunk.bottom)),
                    style,
                );
            }
            from = to;
        }
        let middle = 0.5 * (self.trunk[0].top + self.trunk[0].bottom);
        self.source_label(panel, name, *kj, middle);
    }

    fn draw_entering(&self, panel: &mut Panel, ribbon: &Ribbon, table: &mut PictureTable) {
        let of = ribbon.of;
        let row = push(table, self.of, &of.name, "enters", -of.kj);
        let to = (self.stage_x(ribbon.stage), ribbon.at_trunk);
        draw_ribbon(panel, (LEFT, ribbon.at_end), to, ribbon, row);
        self.source_label(panel, &of.name, -of.kj, ribbon.middle());
    }

    fn draw_leaving(&self, panel: &mut Panel, ribbon: &Ribbon, table: &mut PictureTable) {
        let of = ribbon.of;
        let row = push(table, self.of, &of.name, "leaves", of.kj.abs());
        let from = (self.stage_x(ribbon.stage), ribbon.at_trunk);
        draw_ribbon(panel, from, (self.end, ribbon.at_end), ribbon, row);
        let (middle, end) = (ribbon.middle(), self.end);
        let tick = Style::line(stroke(QUIET, 0.5, &[]));
        panel.add(
            Shape::Segment(at(end + 2.0, middle), at(end + 10.0, middle)),
            tick,
        );
        let text = |x: f64, text: &str| Label::new(at(x, middle + 4.0), text).size(TEXT);
        let room = self.energy - 72.0 - end - 14.0;
        panel.label(text(end + 14.0, &of.name).cut(Cut::End, room));
        panel.label(text(self.energy, &energy(of.kj)).end());
        for (x, (_, whole)) in self.shares.iter().zip(&self.of.shares_of) {
            panel.label(text(*x, &percent(of.kj, *whole)).end());
        }
    }

    /// Energy and share of the first whole.
    fn size(&self, kj: f64) -> impl Iterator<Item = String> {
        let whole = self.of.shares_of.first();
        let share = whole.map_or(String::new(), |(_, whole)| percent(kj, *whole));
        [energy(kj), share]
            .into_iter()
            .filter(|line| !line.is_empty())
    }

    /// Name, energy and share left of where a flow begins.
    fn source_label(&self, panel: &mut Panel, name: &str, kj: f64, middle: f64) {
        let room = LEFT - 8.0 - MARGIN;
        // Bold letters are wider than plain ones.
        let mut lines = lines(name, TEXT, 0.94 * room);
        lines.truncate(2);
        let names = lines.len();
        lines.extend(self.size(kj));
        let first = middle - 0.5 * LINE * (lines.len() - 1) as f64 + 4.0;
        for (k, line) in lines.into_iter().enumerate() {
            let place = at(LEFT - 8.0, first + LINE * k as f64);
            let label = Label::new(place, line).size(TEXT).end().bold(k < names);
            panel.label(label.cut(Cut::End, room));
        }
    }

    /// Names of the stages above the trunk, with the energy that arrives at each.
    fn stage_names(&self, panel: &mut Panel) {
        let stages = self.of.stages.iter().enumerate();
        let named: Vec<usize> = stages
            .filter(|(_, s)| !s.name.is_empty())
            .map(|(s, _)| s)
            .collect();
        for (k, &s) in named.iter().enumerate() {
            let x = self.stage_x(s);
            let next = named
                .get(k + 1)
                .map_or(self.end + 30.0, |next| self.stage_x(*next));
            let room = next - x - 9.0;
            let trunk = &self.trunk[s];
            let foot = trunk.bottom.max(trunk.top + 4.0);
            let rule = Style::line(stroke(QUIET, 0.5, &[]));
            panel.add(Shape::Segment(at(x, TOP + 2.0), at(x, foot)), rule);
            let mut text = lines(&self.of.stages[s].name, TEXT, room);
            text.truncate(2);
            text.extend(self.size(trunk.kj));
            for (n, line) in text.into_iter().enumerate() {
                let place = at(x + 5.0, TOP + 12.0 + LINE * n as f64);
                panel.label(Label::new(place, line).size(TEXT).cut(Cut::End, room));
            }
        }
    }

    /// What the shares refer to, above their columns.
    fn headings(&self, panel: &mut Panel) {
        let Some(first) = self.leaving.first() else {
            return;
        };
        let foot = first.middle() - 18.0;
        for (x, (name, _)) in self.shares.iter().zip(&self.of.shares_of) {
            let lines = lines(&format!("of {name}"), 11.0, SHARE - 2.0);
            for (k, line) in lines.into_iter().rev().enumerate() {
                let place = at(*x, foot - 13.0 * k as f64);
                panel.label(Label::new(place, line).end().quiet());
            }
        }
    }
}

/// One flow: its height is the same all along.
fn draw_ribbon(panel: &mut Panel, from: (f64, f64), to: (f64, f64), of: &Ribbon, row: usize) {
    if of.wide > 0.0 {
        let fill = of.of.term.fill(of.of.component);
        let style = Style::edged(fill, 0.25).class("ribbon").row(row);
        panel.add(Shape::Ribbon(from, to, of.wide), style);
    }
}

fn describe(of: &Sankey) -> String {
    let whole = of.shares_of.first().map_or(f64::NAN, |(_, kj)| *kj);
    let branch = |b: &SankeyBranch| {
        let (word, kj) = if b.kj < 0.0 {
            ("flows in: ", -b.kj)
        } else {
            ("", b.kj)
        };
        let share = percent(kj, whole);
        if share.is_empty() {
            format!("{word}{} {}", b.name, energy(kj))
        } else {
            format!("{word}{} {} ({share})", b.name, energy(kj))
        }
    };
    let parts: Vec<String> = of
        .stages
        .iter()
        .flat_map(|stage| &stage.branches)
        .map(branch)
        .collect();
    format!(
        "Energy flow of {}, {}: {}.",
        of.source.0,
        energy(of.source.1),
        parts.join("; ")
    )
}
