//! Where energy goes: a trunk from a source through stages, each of which branches off its flows. Widths are in proportion to energy.
//!
//! Branches leave the trunk downwards and end in one column at the right, the last stage on top: so none crosses another, and the ends
//! are far enough apart for one line of text each. What is negative flows in: it begins at the left above the source.
use super::sankey_labels::{Columns, source_label, stage_names};
use super::{TOP, Term, WIDTH, component_words, energy, percent, sound, term_fill};
use crate::charts::figure::{Anchor, Figure, INK, QUIET, Rect, units};
use crate::charts::style::component_fill;
use crate::charts::{Picture, PictureTable, cell};
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
    /// Name and size of what energies are told as shares of, kJ; one or two.
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
            name: component_words(component),
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
/// Least distance between the middles of two ends, pixels.
const PITCH: f64 = 19.0;
/// The same at the left, where a label has three lines.
const LEFT_PITCH: f64 = 60.0;
const GAP: f64 = 3.0;
/// Where what flows in begins: its words stand left of it, pixels.
pub(super) const LEFT: f64 = 118.0;
/// Where the names of stages begin, pixels.
pub(super) const BAND_TOP: f64 = TOP;
/// Height of the names of stages above the trunk, pixels.
const BAND: f64 = 62.0;

/// A flow with its place: upper edge at either end.
pub(super) struct Ribbon<'a> {
    pub of: &'a SankeyBranch,
    pub stage: usize,
    pub wide: f64,
    at_trunk: f64,
    pub at_end: f64,
}

/// All flows in their places.
pub(super) struct Flows<'a> {
    source_kj: f64,
    /// Upper and lower edge of the trunk before the first stage and after each.
    pub trunk: Vec<(f64, f64)>,
    /// Energy in the trunk, likewise, kJ.
    pub trunk_kj: Vec<f64>,
    leaving: Vec<Ribbon<'a>>,
    pub entering: Vec<Ribbon<'a>>,
    bottom: f64,
}

/// Draws an energy flow.
#[must_use]
pub fn sankey(of: &Sankey) -> Picture {
    let of = balanced(of);
    let flows = lay_out(&of);
    let mut table = PictureTable::new(&[("flow", ""), ("way", ""), ("energy", "kJ")]);
    table.columns.extend(
        of.shares_of
            .iter()
            .map(|(name, _)| (format!("share of {name}"), "%")),
    );
    table.note =
        "Widths are in proportion to energy. What enters and what leaves add up to the same sum."
            .to_owned();
    let mut figure = Figure::new(
        (WIDTH, flows.bottom + 14.0),
        14.0,
        &of.title,
        &of.subject,
        &describe(&of),
    );
    let columns = Columns::of(&of);
    draw_trunk(&mut figure, &of, &flows, columns.end, &mut table);
    for (way, ribbons) in [("enters", &flows.entering), ("leaves", &flows.leaving)] {
        for ribbon in ribbons {
            let row = push(&mut table, &of, &ribbon.of.name, way, ribbon.of.kj.abs());
            let paint = match ribbon.of.component {
                Some(component) => component_fill(&mut figure, "flow", component),
                None => term_fill(ribbon.of.term).to_owned(),
            };
            let x = stage_x(&of, columns.end, ribbon.stage);
            if way == "enters" {
                band(
                    &mut figure,
                    (LEFT, ribbon.at_end),
                    (x, ribbon.at_trunk),
                    ribbon.wide,
                    &paint,
                    row,
                );
                source_label(
                    &mut figure,
                    &of,
                    &ribbon.of.name,
                    -ribbon.of.kj,
                    ribbon.at_end + 0.5 * ribbon.wide,
                );
            } else {
                band(
                    &mut figure,
                    (x, ribbon.at_trunk),
                    (columns.end, ribbon.at_end),
                    ribbon.wide,
                    &paint,
                    row,
                );
                columns.label(&mut figure, &of, ribbon);
            }
        }
    }
    if scale(&of) <= 0.0 {
        figure.text(
            (0.5 * (LEFT + columns.end), TOP + BAND + 80.0),
            12.0,
            Anchor::Middle,
            "",
            QUIET,
            "no energy flows",
        );
    }
    stage_names(&mut figure, &of, &flows, columns.end);
    columns.headings(&mut figure, &of, flows.leaving.first());
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// The same flow with a source that is not negative, finite numbers, and nothing left over at the end of the trunk.
fn balanced(of: &Sankey) -> Sankey {
    let mut of = of.clone();
    if of.stages.is_empty() {
        of.stages.push(SankeyStage::default());
    }
    of.source.1 = sound(of.source.1);
    for branch in of.stages.iter_mut().flat_map(|stage| &mut stage.branches) {
        branch.kj = sound(branch.kj);
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

fn lay_out(of: &Sankey) -> Flows<'_> {
    let per_kj = scale(of);
    let ins = || {
        of.stages
            .iter()
            .enumerate()
            .flat_map(|(s, stage)| stage.branches.iter().map(move |b| (s, b)))
            .filter(|(_, b)| b.kj < 0.0)
    };
    let wide = of.source.1 * per_kj;
    // Labels of what flows in stand above that of the source.
    let room: f64 = ins()
        .map(|(_, b)| (-b.kj * per_kj + GAP).max(LEFT_PITCH))
        .sum();
    let above = if room > 0.0 {
        room + (0.5 * (LEFT_PITCH - wide)).max(0.0)
    } else {
        (0.5 * (40.0 - wide)).max(0.0)
    };
    let first = TOP + BAND + above;
    let mut trunk = vec![(first, first + wide)];
    let mut trunk_kj = vec![of.source.1];
    let (mut leaving, mut entering) = (Vec::new(), Vec::new());
    let (mut top, mut bottom, mut kj) = (first, first + wide, of.source.1);
    let mut left = (first, first + 0.5 * wide);
    for (s, stage) in of.stages.iter().enumerate() {
        for branch in &stage.branches {
            let wide = branch.kj.abs() * per_kj;
            kj -= branch.kj;
            if branch.kj < 0.0 {
                top -= wide;
                let end = (left.0 - GAP - wide).min(left.1 - LEFT_PITCH - 0.5 * wide);
                left = (end, end + 0.5 * wide);
                entering.push(Ribbon {
                    of: branch,
                    stage: s,
                    wide,
                    at_trunk: top,
                    at_end: end,
                });
            } else {
                bottom -= wide;
                leaving.push(Ribbon {
                    of: branch,
                    stage: s,
                    wide,
                    at_trunk: bottom,
                    at_end: bottom,
                });
            }
        }
        trunk.push((top, bottom));
        trunk_kj.push(kj);
    }
    leaving.reverse();
    let mut free: Option<(f64, f64)> = None;
    for ribbon in &mut leaving {
        if let Some((edge, middle)) = free {
            ribbon.at_end = ribbon
                .at_end
                .max(edge + GAP)
                .max(middle + PITCH - 0.5 * ribbon.wide);
        }
        free = Some((
            ribbon.at_end + ribbon.wide,
            ribbon.at_end + 0.5 * ribbon.wide,
        ));
    }
    let last = free.map_or(0.0, |(edge, middle)| edge.max(middle + 10.0));
    // Room for the word that nothing flows.
    let last = last.max(TOP + BAND + 90.0);
    let bottom = last.max(first + wide).max(first + 0.5 * wide + 24.0);
    Flows {
        source_kj: of.source.1,
        trunk,
        trunk_kj,
        leaving,
        entering,
        bottom,
    }
}

/// Where a stage stands along the trunk, pixels.
pub(super) fn stage_x(of: &Sankey, end: f64, stage: usize) -> f64 {
    let first = LEFT + 0.09 * (end - LEFT);
    let last = end - 0.2 * (end - LEFT);
    let share = if of.stages.len() > 1 {
        stage as f64 / (of.stages.len() - 1) as f64
    } else {
        0.5
    };
    first + share * (last - first)
}

fn push(table: &mut PictureTable, of: &Sankey, name: &str, way: &str, kj: f64) -> usize {
    let mut cells = vec![name.to_owned(), way.to_owned(), cell(kj, 0.01)];
    cells.extend(
        of.shares_of
            .iter()
            .map(|(_, whole)| cell(100.0 * kj / whole, 0.01)),
    );
    table.push(cells)
}

fn draw_trunk(figure: &mut Figure, of: &Sankey, flows: &Flows, end: f64, table: &mut PictureTable) {
    let mut from = LEFT;
    let row = push(table, of, &of.source.0, "enters", flows.source_kj);
    for (s, stage) in of.stages.iter().enumerate() {
        let (top, bottom) = flows.trunk[s];
        let to = stage_x(of, end, s);
        let came = flows
            .entering
            .iter()
            .filter(|ribbon| ribbon.stage == s)
            .map(|ribbon| -ribbon.of.kj)
            .sum::<f64>();
        let row = if s == 0 || stage.name.is_empty() {
            row
        } else {
            push(table, of, &stage.name, "arrives", flows.trunk_kj[s] + came)
        };
        if bottom > top {
            let fill = term_fill(Term::Trunk);
            let attributes = format!(
                "class=\"trunk\" data-row=\"{row}\" fill=\"{fill}\" shape-rendering=\"crispEdges\""
            );
            figure.rect(
                Rect {
                    left: from,
                    right: to,
                    top,
                    bottom,
                },
                &attributes,
            );
        }
        from = to;
    }
    source_label(
        figure,
        of,
        &of.source.0,
        flows.source_kj,
        0.5 * (flows.trunk[0].0 + flows.trunk[0].1),
    );
}

/// One flow: its height is the same all along.
fn band(figure: &mut Figure, from: (f64, f64), to: (f64, f64), wide: f64, paint: &str, row: usize) {
    if wide <= 0.0 {
        return;
    }
    let (x0, x1, middle) = (units(from.0), units(to.0), units(0.5 * (from.0 + to.0)));
    let (a, b, c, d) = (
        units(from.1),
        units(from.1 + wide),
        units(to.1),
        units(to.1 + wide),
    );
    figure.raw(&format!(
        "<path class=\"ribbon\" data-row=\"{row}\" d=\"M{x0} {a}C{middle} {a} {middle} {c} {x1} {c}V{d}C{middle} {d} {middle} {b} {x0} {b}Z\" \
         fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"1\"/>"
    ));
}

fn describe(of: &Sankey) -> String {
    let whole = of.shares_of.first().map_or(f64::NAN, |(_, kj)| *kj);
    let told = |b: &SankeyBranch| {
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
        .map(told)
        .collect();
    format!(
        "Energy flow of {}, {}: {}.",
        of.source.0,
        energy(of.source.1),
        parts.join("; ")
    )
}
