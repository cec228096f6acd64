//! Loss power by component, stacked over time.
use super::axis::{Axis, number};
use super::figure::{Figure, INK, Path, Rect};
use super::legend::{Mark, below_height, legend_below};
use super::panel::{BELOW, Panel};
use super::style::component_fill;
use super::timeline::{PLOT_LEFT, PLOT_RIGHT, PLOT_TOP, WIDTH, phases, time_axis};
use super::{Picture, PictureTable, PlotRun, cell};
use cvtcycle_output::{Component, History};

/// Most bins in a plot: more cannot be told apart, and the file stays small.
const BINS: usize = 300;
const TALL: f64 = 400.0;

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
        self.mean_w
            .iter()
            .zip(&self.seconds)
            .map(|(w, s)| w[component as usize] * s)
            .sum()
    }
}

/// Averages the losses over at most `bins` stretches of about the same length.
///
/// Steps are never divided, and means are weighted by time: the energy of every component stays the
/// same. Losses that are not finite count as nothing.
#[must_use]
pub fn bin_losses(history: &History, bins: usize) -> LossBins {
    let mut out = LossBins::default();
    let (time, steps) = (history.time_s(), history.dt_s());
    let seconds = |dt: &f64| if dt.is_finite() { dt.max(0.0) } else { 0.0 };
    let total: f64 = steps.iter().map(seconds).sum();
    let length = total / bins.max(1) as f64;
    let losses = Component::ALL.map(|component| history.loss_w(component));
    let (mut elapsed, mut bin, mut energy) = (0.0, 0.0, [0.0; Component::COUNT]);
    out.edges_s.extend(
        time.first()
            .zip(steps.first())
            .map(|(end, dt)| end - seconds(dt)),
    );
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
#[must_use]
pub fn losses(run: &PlotRun) -> Picture {
    let bins = bin_losses(run.history, BINS);
    let components = run.history.components();
    let energy: Vec<f64> = components.iter().map(|&c| bins.energy_j(c)).collect();
    let total: f64 = energy.iter().sum();
    let told: Vec<String> = components
        .iter()
        .zip(&energy)
        .map(|(&component, &joule)| told(component, joule, total))
        .collect();
    let desc = format!(
        "Loss power over time, stacked from the bottom in the order of the power flow. Energy lost in all: {}. By component: {}.",
        kilojoule(total),
        told.join("; ")
    );
    let heading = format!("All losses: {}", kilojoule(total));
    let (width, bottom) = (PLOT_RIGHT - PLOT_LEFT, PLOT_TOP + TALL);
    let below = below_height(told.iter().map(String::as_str), width, &heading);
    let mut figure = Figure::new(
        (WIDTH, bottom + BELOW + 8.0 + below),
        PLOT_LEFT,
        "Transmission losses",
        run.name,
        &desc,
    );
    let rect = Rect {
        left: PLOT_LEFT,
        right: PLOT_RIGHT,
        top: PLOT_TOP,
        bottom,
    };
    let stack = |watts: &[f64; Component::COUNT]| {
        components.iter().map(|&c| watts[c as usize]).sum::<f64>()
    };
    let y = Axis::round(
        "Loss power [W]",
        bins.mean_w.iter().map(stack).chain([0.0]),
        8,
    );
    let panel = Panel::over_table(&mut figure, rect, time_axis(run.history), y, true);
    let paints: Vec<String> = components
        .iter()
        .map(|&c| component_fill(&mut figure, "losses", c))
        .collect();
    let mut base = vec![0.0; bins.mean_w.len()];
    for (&component, paint) in components.iter().zip(&paints) {
        layer(&mut figure, &panel, &bins, component, &mut base, paint);
    }
    if bins.mean_w.is_empty() {
        panel.empty(&mut figure);
    }
    panel.outline(&mut figure);
    phases(&mut figure, &panel, run.history, true);
    // Listed from the top, as they lie in the stack.
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(told).rev().collect();
    legend_below(
        &mut figure,
        (PLOT_LEFT, bottom + BELOW + 8.0),
        width,
        &heading,
        &entries,
    );
    Picture {
        svg: figure.finish(),
        table: table(&bins, &components),
    }
}

/// The stretches with the mean of each component.
fn table(bins: &LossBins, components: &[Component]) -> PictureTable {
    let names: Vec<String> = components.iter().map(|&c| name(c)).collect();
    let mut columns = vec![("Middle of the stretch", "s"), ("Length", "s")];
    columns.extend(names.iter().map(|name| (name.as_str(), "W")));
    columns.push(("All", "W"));
    let mut table = PictureTable::new(&columns);
    for ((edges, seconds), watts) in bins.edges_s.windows(2).zip(&bins.seconds).zip(&bins.mean_w) {
        let of = |&c: &Component| watts[c as usize];
        let mut cells = vec![cell(0.5 * (edges[0] + edges[1]), 0.1), cell(*seconds, 0.1)];
        cells.extend(components.iter().map(|c| cell(of(c), 0.1)));
        cells.push(cell(components.iter().map(of).sum(), 0.1));
        table.push(cells);
    }
    table.note = format!(
        "Means over stretches of the cycle, {} at most; the picture is drawn from them. They keep the energy of every component.",
        BINS
    );
    table
}

/// Draws one component on top of `base`, and raises that.
fn layer(
    figure: &mut Figure,
    panel: &Panel,
    bins: &LossBins,
    component: Component,
    base: &mut [f64],
    paint: &str,
) {
    let top: Vec<f64> = base
        .iter()
        .zip(&bins.mean_w)
        .map(|(low, watts)| low + watts[component as usize])
        .collect();
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

/// A component in words.
fn name(component: Component) -> String {
    let words = component.name().replace('_', " ");
    let mut letters = words.chars();
    letters
        .next()
        .map(|c| c.to_ascii_uppercase())
        .into_iter()
        .chain(letters)
        .collect()
}

/// A component with its energy and share.
fn told(component: Component, joule: f64, total: f64) -> String {
    let name = name(component);
    if total > 0.0 {
        format!(
            "{name}: {} ({:.0} %)",
            kilojoule(joule),
            100.0 * joule / total
        )
    } else {
        name
    }
}

fn kilojoule(joule: f64) -> String {
    let step = if joule.abs() < 1e4 { 0.01 } else { 1.0 };
    format!("{} kJ", number(joule / 1000.0, step))
}
