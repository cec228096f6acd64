//! Energy that each group of components has lost since the start, as fuel of that energy: a panel for each car, all on one scale.

use super::PlotRun;
use super::timeline::{HEADED, PLOT_TOP, PLOT_WIDE, phases, time_axis};
use crate::charts::engine::{
    Axis, BELOW, Chart, End, INK, PLOT_LEFT, Panel, Rect, cell, group_line, number, round_step,
    stroke, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, grouped, list_of, words};
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

    /// Energy that each group, then all, has lost at the end of each bin, kJ.
    fn lost_kj(&self) -> Vec<Vec<f64>> {
        let mut sums = vec![0.0; self.groups.len()];
        let bins = self.bins.mean_w.iter().zip(&self.bins.seconds);
        let at_end = |(watts, seconds): (&Means, &f64)| {
            for (sum, (_, parts)) in sums.iter_mut().zip(&self.groups) {
                let watts: f64 = parts.iter().map(|&c| watts[c as usize]).sum();
                *sum += 1e-3 * watts * seconds;
            }
            let all = sums.iter().sum();
            sums.iter().copied().chain([all]).collect()
        };
        bins.map(at_end).collect()
    }
}

/// Energies as fuel: unit, and the factor on the kJ of each car. Without the fuel of a car they stay energies.
struct AsFuel {
    unit: &'static str,
    factors: Vec<f64>,
}

impl AsFuel {
    fn new(runs: &[PlotRun]) -> Self {
        let factors = runs
            .iter()
            .map(PlotRun::fuel_of_kj)
            .collect::<Option<Vec<_>>>();
        match (factors, runs.first()) {
            (Some(factors), Some(run)) => AsFuel {
                unit: run.fuel_unit,
                factors,
            },
            _ => AsFuel {
                unit: "kJ",
                factors: vec![1.0; runs.len()],
            },
        }
    }
}

/// Room right of a panel for the names at the ends of its lines with their numbers, pixels.
const NAMES: f64 = 14.0;

/// Energy that each group of components of each transmission has lost since the start, as fuel of that energy; each line has its name and number at
/// its end.
pub fn losses(runs: &[PlotRun]) -> Picture {
    let cars: Vec<Binned> = runs.iter().map(Binned::new).collect();
    let fuel = AsFuel::new(runs);
    let lost = |(car, factor): (&Binned, &f64)| -> Vec<Vec<f64>> {
        let at_end = car.lost_kj().into_iter();
        at_end
            .map(|of| of.iter().map(|kj| kj * factor).collect())
            .collect()
    };
    let lost: Vec<Vec<Vec<f64>>> = cars.iter().zip(&fuel.factors).map(lost).collect();
    let most = lost.iter().filter_map(|of| of.last()?.last().copied());
    let most = most.fold(0.0, f64::max);
    let digits = decimals(most);
    let y_title = format!("Energy lost, as fuel [{}]", fuel.unit);
    let y = Axis::round(&y_title, [0.0, most].into_iter(), 6);
    let several = cars.len() > 1;
    let tall = TALL[usize::from(several)];
    let top = PLOT_TOP + if several { HEADED } else { 0.0 };
    let ends: Vec<Vec<End>> = cars
        .iter()
        .zip(&lost)
        .map(|(car, lost)| ends(car, lost, digits))
        .collect();
    let names = ends
        .iter()
        .flatten()
        .map(|end| text_width(&end.text, 11.0) + NAMES);
    let wide = PLOT_WIDE - names.fold(0.0, f64::max);
    let mut first = 2;
    let panel = |(k, (car, ends)): (usize, (&Binned, Vec<End>))| {
        let pitch = tall + 14.0 + HEADED;
        let rect = Rect::new(PLOT_LEFT, top + pitch * k as f64, wide, tall);
        let mut panel = Panel::new(rect, time_axis(car.run.history), y.clone())
            .over_table()
            .x_labels(k + 1 == cars.len())
            .no_data(car.bins.mean_w.is_empty());
        if several {
            panel = panel.heading(format!("{}: {}", car.run.name, kilojoule(car.total_j())));
        }
        panel.columns = (first..=first + car.groups.len()).collect();
        first += car.groups.len() + 1;
        for (g, end) in ends.iter().enumerate() {
            let start = car.bins.edges_s.first().map(|s| (*s, 0.0));
            let points = car.bins.edges_s.iter().skip(1).zip(&lost[k]);
            let points = points.map(|(s, lost)| (*s, lost[g]));
            let line = stroke(
                end.colour,
                if g == car.groups.len() { 2.2 } else { 1.6 },
                &[],
            );
            panel.series(start.into_iter().chain(points).collect(), line);
        }
        panel.ends = ends;
        phases(&mut panel, car.run.history, k == 0 && !several);
        panel
    };
    let panels = cars.iter().zip(ends).enumerate().map(panel);
    let mut panels: Vec<Panel> = panels.collect();
    let bottom = panels.last().map_or(top, |panel| panel.rect.bottom + BELOW);
    let lead = cars.iter().map(in_words).collect::<Vec<_>>().join(". ");
    if let Some(last) = panels.last_mut() {
        last.below = bottom - last.rect.bottom + 8.0;
    }
    let subject = match runs {
        [run] => run.name.to_owned(),
        _ => "Energy of the losses as fuel, one scale".to_owned(),
    };
    Chart::new(title(&cars, &fuel, digits), subject, PLOT_LEFT)
        .lead(lead)
        .panels(panels)
        .picture(table(&cars, &lost, (fuel.unit, digits)))
}

/// Decimals of the parts of a whole: to a hundredth of its size.
fn decimals(most: f64) -> usize {
    match most > 0.0 {
        true => (-round_step(0.005 * most).log10()).ceil().clamp(0.0, 3.0) as usize,
        false => 2,
    }
}

/// Names of the groups and of all losses at the ends of their lines, with their numbers.
fn ends(car: &Binned, lost: &[Vec<f64>], digits: usize) -> Vec<End> {
    let groups = car.groups.iter();
    let groups = groups.map(|(group, _)| (capital(group.name()), group_line(*group)));
    let names = groups.chain([("All".to_owned(), INK)]).enumerate();
    let at_end = car.bins.edges_s.last().zip(lost.last());
    let end = |(g, (name, colour)): (usize, (String, &'static str))| {
        let at = at_end.map_or((f64::NAN, f64::NAN), |(s, lost)| (*s, lost[g]));
        let text = format!("{name} {}", grouped(at.1, digits));
        End { at, text, colour }
    };
    names.map(end).collect()
}

/// Share from which a part is most of a whole.
const MOST: f64 = 0.5;

/// Title: losses of each car, and the largest group of the first one.
fn title(cars: &[Binned], fuel: &AsFuel, digits: usize) -> String {
    let some = |(car, _): &(&Binned, &f64)| car.total_j() > 0.0;
    let number = |joule: f64, factor: f64| grouped(1e-3 * joule * factor, digits);
    let mut all = cars.iter().zip(&fuel.factors);
    let Some((first, factor)) = all.next().filter(some) else {
        return "No losses are known".to_owned();
    };
    let total = first.total_j();
    let own = format!(
        "{} loses {} {}",
        first.run.name,
        number(total, *factor),
        fuel.unit
    );
    let others = all.filter(some);
    let others =
        others.map(|(car, factor)| format!("{} {}", car.run.name, number(car.total_j(), *factor)));
    let others: Vec<String> = others.collect();
    match (first.largest_group(), others.is_empty()) {
        (Some((group, joule)), true) => {
            let word = match joule > MOST * total {
                true => "most of it",
                false => "the largest part",
            };
            let name = words(group.name());
            format!("{own}, {word} in {name} ({})", number(joule, *factor))
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

/// Ends of the bins of the first car with all that each group of each car has lost by then; cells of a car with other bins are empty.
fn table(
    cars: &[Binned],
    lost: &[Vec<Vec<f64>>],
    (unit, digits): (&'static str, usize),
) -> PictureTable {
    let mut table = PictureTable::new(&[("Time", "s"), ("Length of the stretch", "s")]);
    for car in cars {
        let names = car.groups.iter().map(|(group, _)| capital(group.name()));
        let names = names.chain(["All".to_owned()]);
        let of_car = |name: String| match cars.len() {
            1 => name,
            _ => format!("{}: {}", car.run.name, name.to_lowercase()),
        };
        table.columns.extend(names.map(|name| (of_car(name), unit)));
    }
    let Some(first) = cars.first() else {
        return table;
    };
    let edges = &first.bins.edges_s;
    let step = 0.1_f64.powi(digits as i32 + 1);
    let near = |a: f64, b: Option<&f64>| b.is_some_and(|b| (a - b).abs() < 0.5);
    for (k, seconds) in first.bins.seconds.iter().enumerate() {
        let mut cells: Vec<String> = [edges[k + 1], *seconds].map(|x| cell(x, 0.1)).to_vec();
        for (car, lost) in cars.iter().zip(lost) {
            let here = near(edges[k + 1], car.bins.edges_s.get(k + 1));
            let own = lost.get(k).filter(|_| here);
            let count = car.groups.len() + 1;
            let own = own.map_or_else(
                || vec![String::new(); count],
                |own| own.iter().map(|x| cell(*x, step)).collect(),
            );
            cells.extend(own);
        }
        table.push(cells);
    }
    table.note(format!(
        "Sums over stretches of the cycle, {BINS} at most; the picture is drawn from them. They keep the energy of every component."
    ))
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
