//! Loss power by group of components, stacked over time: a panel for each car, all on one scale.

use super::PlotRun;
use super::timeline::{HEADED, PLOT_TOP, PLOT_WIDE, phases, time_axis};
use crate::charts::engine::{
    Axis, BELOW, Block, Chart, Entry, Fill, PLOT_LEFT, Panel, Rect, Shape, Style, cell, group_line,
    number,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, list_of, words};
use cvtcycle_model::transmission::component::LossGroup;
use cvtcycle_output::table::distinct;
use cvtcycle_output::{Component, History};

/// Maximum number of bins in a plot: more are indistinguishable, and would enlarge the file.
const BINS: usize = 300;
/// Heights of a lone panel, and of one of several, pixels.
const TALL: [f64; 2] = [340.0, 165.0];

/// Mean loss power by component, W.
pub type Means = [f64; Component::COUNT];

/// Loss power averaged over stretches of a trace.
#[derive(Clone, Debug, Default)]
pub struct LossBins {
    /// Edges of the bins, s: one more than there are bins.
    pub edges_s: Vec<f64>,
    /// Time covered by the rows of each bin, s.
    pub seconds: Vec<f64>,
    /// Mean loss power of each bin, by component, W.
    pub mean_w: Vec<Means>,
}

impl LossBins {
    /// Energy that a component has lost in all bins, J.
    pub fn energy_j(&self, component: Component) -> f64 {
        let bins = self.mean_w.iter().zip(&self.seconds);
        bins.map(|(w, s)| w[component as usize] * s).sum()
    }
}

/// Averages the losses over at most `bins` stretches of about the same length.
///
/// Steps are never divided, and means are weighted by time, which preserves the energy of every component. Losses that are not finite count as
/// zero.
pub fn bin_losses(history: &History, bins: usize) -> LossBins {
    let mut out = LossBins::default();
    let (time, steps) = (history.time_s(), history.dt_s());
    let seconds = |dt: &f64| if dt.is_finite() { dt.max(0.0) } else { 0.0 };
    let total: f64 = steps.iter().map(seconds).sum();
    let length = total / bins.max(1) as f64;
    let losses = Component::ALL.map(|component| history.loss_w(component));
    let (mut elapsed, mut bin, mut energy) = (0.0, 0.0, [0.0; Component::COUNT]);
    let first = time.first().zip(steps.first());
    out.edges_s.extend(first.map(|(end, dt)| end - seconds(dt)));
    for (i, (end, dt)) in time.iter().zip(steps).enumerate() {
        let dt = seconds(dt);
        elapsed += dt;
        bin += dt;
        for (sum, watts) in energy.iter_mut().zip(losses) {
            let loss = watts.get(i).copied().unwrap_or(0.0);
            *sum += if loss.is_finite() { loss * dt } else { 0.0 };
        }
        // Edges are multiples of the length, so that errors do not accumulate to an extra bin.
        let full = elapsed >= length * (out.seconds.len() + 1) as f64 * (1.0 - 1e-12);
        if bin > 0.0 && (full || i + 1 == time.len()) {
            out.edges_s.push(*end);
            out.seconds.push(bin);
            out.mean_w.push(energy.map(|joule| joule / bin));
            (bin, energy) = (0.0, [0.0; Component::COUNT]);
        }
    }
    out
}

/// A car with its bins and the groups of its losses in the order of the power flow.
struct Binned<'a> {
    run: &'a PlotRun<'a>,
    bins: LossBins,
    groups: Vec<(LossGroup, Vec<Component>)>,
}

impl<'a> Binned<'a> {
    fn new(run: &'a PlotRun<'a>) -> Self {
        let components = run.history.components();
        let groups = distinct(components.iter().map(|c| c.group())).into_iter();
        let own = |group| -> Vec<Component> {
            components
                .iter()
                .copied()
                .filter(|c| c.group() == group)
                .collect()
        };
        Binned {
            run,
            bins: bin_losses(run.history, BINS),
            groups: groups.map(|group| (group, own(group))).collect(),
        }
    }

    fn energy_j(&self, parts: &[Component]) -> f64 {
        parts.iter().map(|c| self.bins.energy_j(*c)).sum()
    }

    fn total_j(&self) -> f64 {
        self.energy_j(&self.run.history.components())
    }

    /// Group with the largest loss, and its energy.
    fn largest_group(&self) -> Option<(LossGroup, f64)> {
        let groups = self.groups.iter();
        let energies = groups.map(|(group, parts)| (*group, self.energy_j(parts)));
        energies.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Loss power of each group in each bin, then of all, W.
    fn heights(&self) -> impl Iterator<Item = Vec<f64>> {
        self.bins.mean_w.iter().map(|watts| {
            let of = |(_, parts): &(LossGroup, Vec<Component>)| {
                parts.iter().map(|&c| watts[c as usize]).sum::<f64>()
            };
            let groups: Vec<f64> = self.groups.iter().map(of).collect();
            let all = groups.iter().sum();
            groups.into_iter().chain([all]).collect()
        })
    }
}

/// Loss power of the transmissions over time, stacked by group in the order of the power flow.
pub fn losses(runs: &[PlotRun]) -> Picture {
    let cars: Vec<Binned> = runs.iter().map(Binned::new).collect();
    let all = cars.iter().flat_map(Binned::heights);
    let y = Axis::round(
        "Loss power [W]",
        all.filter_map(|of| of.last().copied()).chain([0.0]),
        6,
    );
    let several = cars.len() > 1;
    let tall = TALL[usize::from(several)];
    let top = PLOT_TOP + if several { HEADED } else { 0.0 };
    let mut first = 2;
    let panel = |(k, car): (usize, &Binned)| {
        let rect = Rect::new(
            PLOT_LEFT,
            top + (tall + 14.0 + HEADED) * k as f64,
            PLOT_WIDE,
            tall,
        );
        let mut panel = Panel::new(rect, time_axis(car.run.history), y.clone())
            .over_table()
            .x_labels(k + 1 == cars.len())
            .no_data(car.bins.mean_w.is_empty());
        if several {
            panel = panel.heading(format!("{}: {}", car.run.name, kilojoule(car.total_j())));
        }
        panel.columns = (first..=first + car.groups.len()).collect();
        first += car.groups.len() + 1;
        layers(&mut panel, car);
        phases(&mut panel, car.run.history, k == 0 && !several);
        panel
    };
    let panels: Vec<Panel> = cars.iter().enumerate().map(panel).collect();
    let bottom = panels.last().map_or(top, |panel| panel.rect.bottom + BELOW);
    let groups = distinct(
        cars.iter()
            .flat_map(|car| car.groups.iter().map(|(group, _)| *group)),
    );
    let entry = |group: LossGroup| {
        let own = cars.first().filter(|_| !several);
        let parts = own.and_then(|car| Some((car, &car.groups.iter().find(|of| of.0 == group)?.1)));
        let name = parts.map_or_else(
            || capital(group.name()),
            |(car, parts)| described(group, car.energy_j(parts), car.total_j()),
        );
        Entry::fill(Fill::plain(group_line(group)), name)
    };
    // Listed from the top, as in the stack.
    let entries: Vec<Entry> = groups.iter().rev().map(|group| entry(*group)).collect();
    let lead = cars.iter().map(in_words).collect::<Vec<_>>().join(". ");
    let mut panels = panels;
    if let Some(last) = panels.last_mut() {
        last.below = bottom - last.rect.bottom + 8.0;
    }
    let subject = match runs {
        [run] => run.name.to_owned(),
        _ => "Loss power over time, one scale; stacked in the order of the power flow".to_owned(),
    };
    Chart::new(title(&cars), subject, PLOT_LEFT)
        .lead(lead)
        .panels(panels)
        .foot(Block::legend((PLOT_LEFT, PLOT_WIDE), "", entries))
        .picture(table(&cars))
}

/// Share from which a part is most of a whole.
const MOST: f64 = 0.5;

/// Title: losses of each car, and the largest group of the first one.
fn title(cars: &[Binned]) -> String {
    let some = |car: &&Binned| car.total_j() > 0.0;
    let Some(first) = cars.first().filter(some) else {
        return "No losses are known".to_owned();
    };
    let own = format!("{} loses {}", first.run.name, kilojoule(first.total_j()));
    let others = cars[1..].iter().filter(some);
    let others: Vec<String> = others
        .map(|car| format!("{} {}", car.run.name, kilojoule(car.total_j())))
        .collect();
    match (first.largest_group(), others.is_empty()) {
        (Some((group, joule)), true) => {
            let word = match joule > MOST * first.total_j() {
                true => "most of it",
                false => "the largest part",
            };
            format!(
                "{own}, {word} in {} ({})",
                words(group.name()),
                kilojoule(joule)
            )
        }
        _ => format!("{own}, {}", list_of(&others)),
    }
}

fn in_words(car: &Binned) -> String {
    let groups = car.groups.iter();
    let total = car.total_j();
    let groups = groups.map(|(group, parts)| described(*group, car.energy_j(parts), total));
    let list = groups.collect::<Vec<_>>().join("; ");
    format!(
        "{}, all losses: {}. By group: {list}",
        car.run.name,
        kilojoule(total)
    )
}

/// Bins of the first car with the means of each car's groups; cells of a car with other bins are empty.
fn table(cars: &[Binned]) -> PictureTable {
    let mut table = PictureTable::new(&[("Middle of the stretch", "s"), ("Length", "s")]);
    for car in cars {
        let names = car.groups.iter().map(|(group, _)| capital(group.name()));
        let names = names.chain(["All".to_owned()]);
        let of_car = |name: String| match cars.len() {
            1 => name,
            _ => format!("{}: {}", car.run.name, name.to_lowercase()),
        };
        table.columns.extend(names.map(|name| (of_car(name), "W")));
    }
    let Some(first) = cars.first() else {
        return table;
    };
    let edges = &first.bins.edges_s;
    let heights: Vec<Vec<Vec<f64>>> = cars.iter().map(|car| car.heights().collect()).collect();
    let near = |a: f64, b: Option<&f64>| b.is_some_and(|b| (a - b).abs() < 0.5);
    for (k, seconds) in first.bins.seconds.iter().enumerate() {
        let numbers = [0.5 * (edges[k] + edges[k + 1]), *seconds];
        let mut cells: Vec<String> = numbers.iter().map(|x| cell(*x, 0.1)).collect();
        for (car, heights) in cars.iter().zip(&heights) {
            let here = near(edges[k + 1], car.bins.edges_s.get(k + 1));
            let own = heights.get(k).filter(|_| here);
            let count = car.groups.len() + 1;
            let own = own.map_or_else(
                || vec![String::new(); count],
                |own| own.iter().map(|x| cell(*x, 0.1)).collect(),
            );
            cells.extend(own);
        }
        table.push(cells);
    }
    table.note(format!(
        "Means over stretches of the cycle, {BINS} at most; the picture is drawn from them. They keep the energy of every component."
    ))
}

/// Adds the groups as stacked layers.
fn layers(panel: &mut Panel, car: &Binned) {
    let mut base = vec![0.0; car.bins.mean_w.len()];
    for (g, (group, _)) in car.groups.iter().enumerate() {
        let mut outline = Vec::new();
        let mut any = false;
        let bins = car.bins.edges_s.windows(2).zip(car.heights());
        for ((span, heights), low) in bins.zip(&mut base) {
            let high = *low + heights[g];
            any |= high > *low;
            outline.extend(span.iter().map(|edge| (*edge, *low, high)));
            *low = high;
        }
        if any {
            let fill = Fill::plain(group_line(*group));
            panel.add(
                Shape::between(&outline),
                Style::edged(fill, 0.2).class("layer"),
            );
        }
    }
}

/// A group with its energy and share.
fn described(group: LossGroup, joule: f64, total: f64) -> String {
    let name = capital(group.name());
    if total > 0.0 {
        let percent = 100.0 * joule / total;
        format!("{name}: {} ({percent:.0} %)", kilojoule(joule))
    } else {
        name
    }
}

fn kilojoule(joule: f64) -> String {
    let step = if joule.abs() < 1e4 { 0.01 } else { 1.0 };
    format!("{} kJ", number(joule / 1000.0, step))
}
