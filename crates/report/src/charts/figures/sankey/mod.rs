//! Sankey diagram: a trunk from a source through stages, each of which branches off its flows. Widths are proportional to energy.
//!
//! Branches leave the trunk downwards and end in one column at the right, the last stage on top, so that none cross, and the ends leave room for
//! one line of text each. Negative energies flow in, and begin at the left above the source.

mod layout;

use layout::{Flows, Ribbon, lay_out};

use super::{MARGIN, TEXT, TOP, Term, finite, per_km, percent};
use crate::charts::engine::{
    Chart, Cut, Label, Panel, Point, QUIET, Rect, Shape, Style, WIDTH, at, cell, free, lines,
    stroke,
};
use crate::charts::picture::{Picture, PictureTable};

/// An energy flow.
#[derive(Clone, Debug)]
pub(super) struct Sankey<'a> {
    pub title: String,
    pub subject: &'a str,
    /// Largest source of the figures on this scale, kJ/km; ignored if the own one is larger.
    pub largest_kj_km: f64,
    /// Source of the trunk.
    pub source: Whole,
    pub stages: Vec<Stage>,
    /// References of the shares; one or two.
    pub shares_of: Vec<Whole>,
}

/// An energy with its name.
#[derive(Clone, Debug)]
pub(super) struct Whole {
    pub name: &'static str,
    pub kj_km: f64,
}

impl Whole {
    pub fn new(name: &'static str, kj_km: f64) -> Self {
        Whole { name, kj_km }
    }
}

/// A position along the trunk; marked if it has a name.
#[derive(Clone, Debug, Default)]
pub(super) struct Stage {
    pub name: &'static str,
    /// Flows that leave here.
    pub branches: Vec<Branch>,
}

impl Stage {
    pub fn new(name: &'static str, branches: Vec<Branch>) -> Self {
        Stage { name, branches }
    }
}

/// A flow that leaves the trunk, or enters it if its energy is negative.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    pub name: String,
    pub kj_km: f64,
    pub term: Term,
}

pub(super) fn branch(name: &str, term: Term, kj_km: f64) -> Branch {
    let name = name.to_owned();
    Branch { name, kj_km, term }
}

/// Height of all inflows, pixels.
const TALL: f64 = 300.0;
/// Left end of inflows, with their labels left of it, pixels.
const LEFT: f64 = 118.0;
/// Height of the names of stages above the trunk, pixels.
const BAND: f64 = 62.0;
/// Height of a line of a label, pixels.
const LINE: f64 = 14.0;
/// Distance between two columns of shares, pixels.
const SHARE: f64 = 76.0;

/// Draws an energy flow.
pub(super) fn sankey(flow: Sankey) -> Picture {
    let flow = balanced(flow);
    let flows = lay_out(&flow);
    let mut table = PictureTable::new(&[("flow", ""), ("way", ""), ("energy", "kJ/km")]).note(
        "Widths are in proportion to energy. What enters and what leaves add up to the same sum.",
    );
    let shares = flow.shares_of.iter();
    let shares = shares.map(|whole| (format!("share of {}", whole.name), "%"));
    table.columns.extend(shares);
    let mut panel = free(Rect::new(0.0, 0.0, WIDTH, flows.bottom)).below(16.0);
    flows.draw_trunk(&mut panel, &mut table);
    for ribbon in &flows.entering {
        flows.draw_entering(&mut panel, ribbon, &mut table);
    }
    for ribbon in &flows.leaving {
        flows.draw_leaving(&mut panel, ribbon, &mut table);
    }
    if flow.scale() <= 0.0 {
        let place = at(0.5 * (LEFT + flows.end), TOP + BAND + 80.0);
        let label = Label::new(place, "no energy flows").size(12.0);
        panel.label(label.middle().quiet());
    }
    flows.stage_names(&mut panel);
    flows.headings(&mut panel);
    Chart::new(flow.title, flow.subject, MARGIN)
        .panels([panel])
        .picture(table)
}

/// Copy with a source that is not negative, finite numbers, and a trunk without remainder.
fn balanced(mut flow: Sankey) -> Sankey {
    if flow.stages.is_empty() {
        flow.stages.push(Stage::default());
    }
    flow.source.kj_km = finite(flow.source.kj_km);
    for branch in flow.stages.iter_mut().flat_map(|stage| &mut stage.branches) {
        branch.kj_km = finite(branch.kj_km);
    }
    let mut last = Vec::new();
    if flow.source.kj_km < 0.0 {
        last.push(branch(flow.source.name, Term::Trunk, -flow.source.kj_km));
        flow.source.kj_km = 0.0;
    }
    let branches = || flow.branches().chain(&last).map(|branch| branch.kj_km);
    let left_over = flow.source.kj_km - branches().sum::<f64>();
    if left_over.abs() > 1e-6 * (flow.source.kj_km + branches().map(f64::abs).sum::<f64>()) {
        last.push(branch("Not accounted for", Term::Other, left_over));
    }
    if let Some(stage) = flow.stages.last_mut() {
        stage.branches.extend(last);
    }
    flow
}

impl Sankey<'_> {
    fn branches(&self) -> impl Iterator<Item = &Branch> {
        self.stages.iter().flat_map(|stage| &stage.branches)
    }

    /// Pixels per kJ/km; zero without any flow.
    fn scale(&self) -> f64 {
        let inflow = self.source.kj_km + self.branches().map(|b| (-b.kj_km).max(0.0)).sum::<f64>();
        let scale = TALL / inflow.max(finite(self.largest_kj_km));
        if inflow > 0.0 && scale.is_finite() {
            scale
        } else {
            0.0
        }
    }

    /// Adds a row to the table; returns its index.
    fn push(&self, table: &mut PictureTable, name: &str, way: &str, kj_km: f64) -> usize {
        let shares = self
            .shares_of
            .iter()
            .map(|whole| 100.0 * kj_km / whole.kj_km);
        let numbers = [kj_km].into_iter().chain(shares).map(|x| cell(x, 0.01));
        let words = [name, way].map(str::to_owned);
        table.push(words.into_iter().chain(numbers))
    }
}

impl Flows<'_> {
    /// Position of a stage along the trunk, pixels.
    fn stage_x(&self, stage: usize) -> f64 {
        let first = LEFT + 0.09 * (self.end - LEFT);
        let last = self.end - 0.2 * (self.end - LEFT);
        let share = match self.sankey.stages.len() {
            0 | 1 => 0.5,
            count => stage as f64 / (count - 1) as f64,
        };
        first + share * (last - first)
    }

    fn draw_trunk(&self, panel: &mut Panel, table: &mut PictureTable) {
        let Whole { name, kj_km } = self.sankey.source;
        let source = self.sankey.push(table, name, "enters", kj_km);
        let mut from = LEFT;
        for (s, (stage, trunk)) in self.sankey.stages.iter().zip(&self.trunk).enumerate() {
            let to = self.stage_x(s);
            let row = if s == 0 || stage.name.is_empty() {
                source
            } else {
                self.sankey.push(table, stage.name, "arrives", trunk.kj_km)
            };
            if trunk.bottom > trunk.top {
                let style = Style::fill(Term::Trunk.fill()).crisp().class("trunk");
                panel.rectangle(at(from, trunk.top), at(to, trunk.bottom), style.row(row));
            }
            from = to;
        }
        let middle = 0.5 * (self.trunk[0].top + self.trunk[0].bottom);
        self.source_label(panel, name, kj_km, middle);
    }

    fn draw_entering(&self, panel: &mut Panel, ribbon: &Ribbon, table: &mut PictureTable) {
        let branch = ribbon.branch;
        let row = self
            .sankey
            .push(table, &branch.name, "enters", -branch.kj_km);
        let to = (self.stage_x(ribbon.stage), ribbon.at_trunk);
        draw_ribbon(panel, (LEFT, ribbon.at_end), to, ribbon, row);
        self.source_label(panel, &branch.name, -branch.kj_km, ribbon.middle());
    }

    fn draw_leaving(&self, panel: &mut Panel, ribbon: &Ribbon, table: &mut PictureTable) {
        let branch = ribbon.branch;
        let row = self
            .sankey
            .push(table, &branch.name, "leaves", branch.kj_km.abs());
        let from = (self.stage_x(ribbon.stage), ribbon.at_trunk);
        draw_ribbon(panel, from, (self.end, ribbon.at_end), ribbon, row);
        let (middle, end) = (ribbon.middle(), self.end);
        let tick = Style::line(stroke(QUIET, 0.5, &[]));
        panel.segment(at(end + 2.0, middle), at(end + 10.0, middle), tick);
        let text = |x: f64, text: &str| Label::new(at(x, middle + 4.0), text).size(TEXT);
        let room = self.energy - 72.0 - end - 14.0;
        panel.label(text(end + 14.0, &branch.name).cut(Cut::End, room));
        panel.label(text(self.energy, &per_km(branch.kj_km)).end());
        for (x, whole) in self.shares.iter().zip(&self.sankey.shares_of) {
            panel.label(text(*x, &percent(branch.kj_km, whole.kj_km)).end());
        }
    }

    /// Energy, and share of the first reference.
    fn size(&self, kj_km: f64) -> impl Iterator<Item = String> {
        let whole = self.sankey.shares_of.first();
        let share = whole
            .map(|whole| percent(kj_km, whole.kj_km))
            .filter(|share| !share.is_empty());
        [per_km(kj_km)].into_iter().chain(share)
    }

    /// Writes name, energy and share left of the beginning of a flow.
    fn source_label(&self, panel: &mut Panel, name: &str, kj_km: f64, middle: f64) {
        let room = LEFT - 8.0 - MARGIN;
        // Bold letters are wider than plain ones.
        let mut lines = lines(name, TEXT, 0.94 * room);
        lines.truncate(2);
        let names = lines.len();
        lines.extend(self.size(kj_km));
        let first = middle - 0.5 * LINE * (lines.len() - 1) as f64 + 4.0;
        for (k, line) in lines.into_iter().enumerate() {
            let place = at(LEFT - 8.0, first + LINE * k as f64);
            let label = Label::new(place, line).size(TEXT).end().bold(k < names);
            panel.label(label.cut(Cut::End, room));
        }
    }

    /// Writes the names of the stages above the trunk, with the energy that arrives at each.
    fn stage_names(&self, panel: &mut Panel) {
        let stages = || self.sankey.stages.iter().enumerate();
        for (s, stage) in stages().filter(|(_, stage)| !stage.name.is_empty()) {
            let x = self.stage_x(s);
            let next = stages().find(|(k, stage)| *k > s && !stage.name.is_empty());
            let next = next.map_or(self.end + 30.0, |(next, _)| self.stage_x(next));
            let room = next - x - 9.0;
            let trunk = &self.trunk[s];
            let foot = trunk.bottom.max(trunk.top + 4.0);
            let rule = Style::line(stroke(QUIET, 0.5, &[]));
            panel.segment(at(x, TOP + 2.0), at(x, foot), rule);
            let mut text = lines(stage.name, TEXT, room);
            text.truncate(2);
            text.extend(self.size(trunk.kj_km));
            for (n, line) in text.into_iter().enumerate() {
                let place = at(x + 5.0, TOP + 12.0 + LINE * n as f64);
                panel.label(Label::new(place, line).size(TEXT).cut(Cut::End, room));
            }
        }
    }

    /// Writes the references of the shares above their columns.
    fn headings(&self, panel: &mut Panel) {
        let Some(first) = self.leaving.first() else {
            return;
        };
        let foot = first.middle() - 18.0;
        for (x, whole) in self.shares.iter().zip(&self.sankey.shares_of) {
            let lines = lines(&format!("of {}", whole.name), 11.0, SHARE - 2.0);
            for (k, line) in lines.into_iter().rev().enumerate() {
                let place = at(*x, foot - 13.0 * k as f64);
                panel.label(Label::new(place, line).end().quiet());
            }
        }
    }
}

/// Draws a flow of constant height.
fn draw_ribbon(panel: &mut Panel, from: Point, to: Point, ribbon: &Ribbon, row: usize) {
    if ribbon.wide > 0.0 {
        let style = Style::edged(ribbon.branch.term.fill(), 0.25).class("ribbon");
        panel.add(Shape::Ribbon(from, to, ribbon.wide), style.row(row));
    }
}
