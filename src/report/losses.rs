//! Loss power by component, stacked over time.
use super::PlotRun;
use super::axis::{Axis, number};
use super::figure::{Figure, INK, Path, Rect};
use super::legend::{Mark, legend};
use super::panel::{BELOW, Panel};
use super::style::component_fill;
use super::traces::{PLOT_LEFT, PLOT_TOP, phases, time_axis};
use crate::results::{Component, Row};

/// Most bins in a plot: more cannot be told apart, and the file stays small.
const BINS: usize = 300;
const RIGHT: f64 = 860.0;
const TALL: f64 = 400.0;
const STRIP: f64 = 250.0;

/// Loss power averaged over stretches of a trace.
#[derive(Clone, Debug, Default)]
pub struct LossBins {
    /// Where the bins begin and end, s: one more than there are bins.
    pub edges_s: Vec<f64>,
    /// Time covered by the rows of each bin, s.
    pub seconds: Vec<f64>,
    /// Mean loss power of each bin, by component, W.
    pub mean_w: Vec<[f64; Component::COUNT]>,
}

impl LossBins {
    /// Energy that a component has lost in all bins, J.
    #[must_use]
    pub fn energy_j(&self, component: Component) -> f64 {
        self.mean_w.iter().zip(&self.seconds).map(|(w, s)| w[component as usize] * s).sum()
    }
}

/// Averages the losses over at most `bins` stretches of about the same length.
///
/// Rows are never divided, and means are weighted by time: the energy of every component stays the
/// same. Losses that are not finite count as nothing.
#[must_use]
pub fn bin_losses(rows: &[Row], bins: usize) -> LossBins {
    let mut out = LossBins::default();
    let seconds = |row: &Row| {
        if row.dt_s.is_finite() { row.dt_s.max(0.0) } else { 0.0 }
    };
    let total: f64 = rows.iter().map(seconds).sum();
    let length = total / bins.max(1) as f64;
    let (mut elapsed, mut bin, mut energy) = (0.0, 0.0, [0.0; Component::COUNT]);
    out.edges_s.extend(rows.first().map(|row| row.time_s - seconds(row)));
    for (i, row) in rows.iter().enumerate() {
        let dt = seconds(row);
        elapsed += dt;
        bin += dt;
        for (sum, loss) in energy.iter_mut().zip(row.loss_w) {
            *sum += if loss.is_finite() { loss * dt } else { 0.0 };
        }
        // Ends are multiples of the length, so that errors do not add up to a bin too many.
        let full = elapsed >= length * (out.seconds.len() + 1) as f64 * (1.0 - 1e-12);
        if bin > 0.0 && (full || i + 1 == rows.len()) {
            out.edges_s.push(row.time_s);
            out.seconds.push(bin);
            out.mean_w.push(energy.map(|joule| joule / bin));
            (bin, energy) = (0.0, [0.0; Component::COUNT]);
        }
    }
    out
}

/// Loss power of the transmission over time, stacked in the order of the power flow.
#[must_use]
pub fn losses(run: &PlotRun) -> String {
    let bins = bin_losses(run.rows, BINS);
    let energy: Vec<f64> = run.components.iter().map(|&c| bins.energy_j(c)).collect();
    let total: f64 = energy.iter().sum();
    let told: Vec<String> = run.components.iter().zip(&energy).map(|(&component, &joule)| told(component, joule, total)).collect();
    let desc = format!(
        "Loss power over time, stacked from the bottom in the order of the power flow. Energy lost in all: {}. By component: {}.",
        kilojoule(total),
        told.join("; ")
    );
    let size = (RIGHT + 16.0 + STRIP, PLOT_TOP + TALL + BELOW + 6.0);
    let mut figure = Figure::new(size, PLOT_LEFT, "Transmission losses", run.name, &desc);
    let rect = Rect { left: PLOT_LEFT, right: RIGHT, top: PLOT_TOP, bottom: PLOT_TOP + TALL };
    let stack = |watts: &[f64; Component::COUNT]| run.components.iter().map(|&c| watts[c as usize]).sum::<f64>();
    let y = Axis::round("Loss power [W]", bins.mean_w.iter().map(stack).chain([0.0]), 8);
    let panel = Panel::draw(&mut figure, rect, time_axis(run.rows), y, true);
    let paints: Vec<String> = run.components.iter().map(|&c| component_fill(&mut figure, "losses", c)).collect();
    let mut base = vec![0.0; bins.mean_w.len()];
    for (&component, paint) in run.components.iter().zip(&paints) {
        layer(&mut figure, &panel, &bins, component, &mut base, paint);
    }
    if bins.mean_w.is_empty() {
        panel.empty(&mut figure);
    }
    panel.outline(&mut figure);
    phases(&mut figure, &panel, run, true);
    // Listed from the top, as they lie in the stack.
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(told).rev().collect();
    let heading = format!("All losses: {}", kilojoule(total));
    legend(&mut figure, (RIGHT + 16.0, PLOT_TOP), STRIP - 8.0, &heading, &entries);
    figure.finish()
}

/// Draws one component on top of `base`, and raises that.
fn layer(figure: &mut Figure, panel: &Panel, bins: &LossBins, component: Component, base: &mut [f64], paint: &str) {
    let top: Vec<f64> = base.iter().zip(&bins.mean_w).map(|(low, watts)| low + watts[component as usize]).collect();
    let spans = || bins.edges_s.windows(2).zip(&top).zip(base.iter());
    if spans().any(|((_, high), low)| high > low) {
        let mut path = Path::default();
        for (i, ((span, high), _)) in spans().enumerate() {
            if i == 0 {
                path.move_to(panel.px(span[0]), panel.py(*high));
            }
            path.line_to(panel.px(span[0]), panel.py(*high));
            path.line_to(panel.px(span[1]), panel.py(*high));
        }
        for ((span, _), low) in spans().rev() {
            path.line_to(panel.px(span[1]), panel.py(*low));
            path.line_to(panel.px(span[0]), panel.py(*low));
        }
        path.close();
        figure.raw(&format!(
            "<path class=\"layer\" d=\"{}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"1\" stroke-linejoin=\"round\"/>",
            path.finish()
        ));
    }
    base.copy_from_slice(&top);
}

/// A component with its energy and share.
fn told(component: Component, joule: f64, total: f64) -> String {
    let words = component.name().replace('_', " ");
    let mut letters = words.chars();
    let name: String = letters.next().map(|c| c.to_ascii_uppercase()).into_iter().chain(letters).collect();
    if total > 0.0 { format!("{name}: {} ({:.0} %)", kilojoule(joule), 100.0 * joule / total) } else { name }
}

fn kilojoule(joule: f64) -> String {
    let step = if joule.abs() < 1e4 { 0.01 } else { 1.0 };
    format!("{} kJ", number(joule / 1000.0, step))
}
