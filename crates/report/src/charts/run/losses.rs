//! Loss power by component, stacked over time.

use super::PlotRun;
use super::timeline::{PLOT_TOP, PLOT_WIDE, phases, time_axis};
use crate::charts::engine::{
    Axis, Block, Chart, Entry, Fill, PLOT_LEFT, Panel, Rect, Shape, Style, cell, number,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::{Component, History};

/// Most bins in a plot: more cannot be distinguished, and the file stays small.
const BINS: usize = 300;
const TALL: f64 = 400.0;

/// Mean loss power by component, W.
pub type Means = [f64; Component::COUNT];

/// Loss power averaged over stretches of a trace.
#[derive(Clone, Debug, Default)]
pub struct LossBins {
    /// Where the bins begin and end, s: one more than there are bins.
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
/// Steps are never divided, and means are weighted by time: the energy of every component stays the
/// same. Losses that are not finite count as nothing.
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
        // Ends are multiples of the length, so that errors do not add up to a bin too many.
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

/// Loss power of the transmission over time, stacked in the order of the power flow.
pub fn losses(run: &PlotRun) -> Picture {
    let bins = bin_losses(run.history, BINS);
    let components = run.history.components();
    let total: f64 = components.iter().map(|&c| bins.energy_j(c)).sum();
    let all = |watts: &Means| components.iter().map(|&c| watts[c as usize]).sum::<f64>();
    let heights = bins.mean_w.iter().map(all).chain([0.0]);
    let rect = Rect::new(PLOT_LEFT, PLOT_TOP, PLOT_WIDE, TALL);
    let y = Axis::round("Loss power [W]", heights, 8);
    let mut panel = Panel::new(rect, time_axis(run.history), y)
        .over_table()
        .no_data(bins.mean_w.is_empty());
    let mut base = vec![0.0; bins.mean_w.len()];
    for component in &components {
        layer(&mut panel, &bins, *component, &mut base);
    }
    phases(&mut panel, run.history, true);
    // Listed from the top, as they lie in the stack.
    let entry = |c: &Component| {
        let name = described(*c, bins.energy_j(*c), total);
        Entry::fill(Fill::component(*c), name)
    };
    let entries: Vec<Entry> = components.iter().rev().map(entry).collect();
    let names = entries.iter().rev().map(|entry| entry.name.as_str());
    let names: Vec<&str> = names.collect();
    let heading = format!("All losses: {}", kilojoule(total));
    Chart::new("Transmission losses", run.name, PLOT_LEFT)
        .lead(format!("{heading}. By component: {}", names.join("; ")))
        .panels([panel])
        .foot(Block::legend((PLOT_LEFT, PLOT_WIDE), &heading, entries))
        .picture(table(&bins, &components))
}

/// The bins with the mean of each component.
fn table(bins: &LossBins, components: &[Component]) -> PictureTable {
    let names = components.iter().map(|c| capital(c.name()));
    let mut table = PictureTable::new(&[("Middle of the stretch", "s"), ("Length", "s")]);
    let names = names.chain(["All".to_owned()]);
    table.columns.extend(names.map(|name| (name, "W")));
    for ((edges, seconds), watts) in bins.edges_s.windows(2).zip(&bins.seconds).zip(&bins.mean_w) {
        let of = |&c: &Component| watts[c as usize];
        let all = components.iter().map(of).sum();
        let numbers = [0.5 * (edges[0] + edges[1]), *seconds].into_iter();
        let numbers = numbers.chain(components.iter().map(of)).chain([all]);
        table.push(numbers.map(|x| cell(x, 0.1)));
    }
    table.note(format!(
        "Means over stretches of the cycle, {BINS} at most; the picture is drawn from them. They keep the energy of every component."
    ))
}

/// Adds one component on top of `base`, and raises that.
fn layer(panel: &mut Panel, bins: &LossBins, component: Component, base: &mut [f64]) {
    let mut outline = Vec::new();
    let mut any = false;
    let bins = bins.edges_s.windows(2).zip(&bins.mean_w);
    for ((span, watts), low) in bins.zip(base) {
        let high = *low + watts[component as usize];
        any |= high > *low;
        outline.extend(span.iter().map(|edge| (*edge, *low, high)));
        *low = high;
    }
    if any {
        let style = Style::edged(Fill::component(component), 0.25).class("layer");
        panel.add(Shape::between(&outline), style);
    }
}

/// A component with its energy and share.
fn described(component: Component, joule: f64, total: f64) -> String {
    let name = capital(component.name());
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
