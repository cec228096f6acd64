//! Losses of a transmission against the temperature of its oil, while the car moved.

use super::{TOP, Term, finite};
use crate::charts::engine::{
    Axis, Block, Chart, Entry, Fill, PLOT_LEFT, Panel, Rect, Shape, Style, WIDTH, at, cell, number,
    range, round_step,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::Component;

/// Losses of one car step by step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LossTrace<'a> {
    /// Name of the car.
    pub subject: String,
    /// Length of each step, s.
    pub seconds: &'a [f64],
    /// Temperature of the sump, degC.
    pub sump_degc: &'a [f64],
    /// Vehicle speed, km/h.
    pub speed_kmh: &'a [f64],
    /// Loss power of each component, W, in the order of the power flow.
    pub losses_w: Vec<(Component, &'a [f64])>,
}

/// Time and energies within a span of temperatures.
#[derive(Clone, Debug, Default, PartialEq)]
struct Bin {
    low_degc: f64,
    high_degc: f64,
    seconds: f64,
    joule: Vec<f64>,
}

const WIDE: f64 = WIDTH - 20.0 - PLOT_LEFT;
const TALL: f64 = 260.0;
const STRIP: f64 = 62.0;
const GAP: f64 = 16.0;
const BIN_K: f64 = 5.0;
const MAX_BINS: f64 = 20.0;
/// Bins of less time are left out, s.
const MIN_S: f64 = 1.0;
/// A car slower than this is at rest, km/h.
const REST_KMH: f64 = 0.1;
const REMARK: &str = "Within one cycle oil temperature and phase go together: cold bins are from its beginning, warm ones from its end, so the \
    difference between two bins is not that of temperature alone.";

impl Bin {
    /// Mean loss power, W.
    fn watts(&self) -> f64 {
        self.joule.iter().sum::<f64>() / self.seconds
    }
}

/// Mean loss power by component against the temperature of the sump, with the time spent in each bin of temperature below it.
#[must_use]
pub fn loss_by_temperature(of: &LossTrace) -> Picture {
    let (bins, left_out_s) = bins(of);
    let [mut upper, mut lower] = panels(&bins);
    let mut table = table(of, left_out_s);
    for bin in &bins {
        let mut cells = vec![cell(bin.low_degc, 1.0), cell(bin.high_degc, 1.0)];
        let watts = bin
            .joule
            .iter()
            .map(|joule| joule / bin.seconds)
            .chain([bin.watts()]);
        cells.extend([bin.seconds].into_iter().chain(watts).map(|x| cell(x, 0.1)));
        let row = table.push(cells);
        let mut base = 0.0;
        for (joule, (component, _)) in bin.joule.iter().zip(&of.losses_w) {
            let next = base + joule / bin.seconds;
            column(
                &mut upper,
                bin,
                (base, next),
                Fill::component(*component),
                row,
            );
            base = next;
        }
        column(
            &mut lower,
            bin,
            (0.0, bin.seconds),
            Term::Other.fill(None),
            row,
        );
    }
    let entry = |(c, _): &(Component, _)| Entry::fill(Fill::component(*c), capital(c.name()));
    let place = (PLOT_LEFT, WIDE);
    let chart = Chart {
        title: "Transmission losses against oil temperature".to_owned(),
        subject: of.subject.clone(),
        description: describe(&bins),
        left: PLOT_LEFT,
        panels: vec![upper, lower],
        foot: vec![
            Block::legend(place, "", of.losses_w.iter().map(entry).collect()),
            Block::notes(place, vec![REMARK.to_owned()]),
        ],
        table,
        ..Chart::default()
    };
    chart.picture()
}

/// Empty panels for loss power and for time over the bins.
fn panels(bins: &[Bin]) -> [Panel; 2] {
    let ends = bins.iter().flat_map(|bin| [bin.low_degc, bin.high_degc]);
    let (low, high) = range(ends).unwrap_or((0.0, 1.0));
    let x = || Axis::exact("Oil temperature in the sump [\u{b0}C]", low, high, 10);
    let watts = bins.iter().map(Bin::watts).chain([0.0]);
    let seconds = bins.iter().map(|bin| bin.seconds).chain([0.0]);
    let upper = Rect::new(PLOT_LEFT, TOP, WIDE, TALL);
    let lower = Rect::new(PLOT_LEFT, TOP + TALL + GAP, WIDE, STRIP);
    let panels = [
        Panel::new(upper, x(), Axis::round("Mean loss power [W]", watts, 7)),
        Panel::new(lower, x(), Axis::round("Time [s]", seconds, 3)),
    ];
    panels.map(|panel| Panel {
        x_labels: panel.rect == lower,
        no_data: bins.is_empty(),
        ..panel
    })
}

fn column(panel: &mut Panel, bin: &Bin, (from, to): (f64, f64), fill: Fill, row: usize) {
    if to > from {
        let style = Style::edged(fill, 0.25).class("bar").row(row);
        panel.add(
            Shape::Rect(at(bin.low_degc, to), at(bin.high_degc, from)),
            style,
        );
    }
}

/// Bins from cold to warm, and the time of those too short to count, s.
fn bins(of: &LossTrace) -> (Vec<Bin>, f64) {
    let moved = |i: &usize| {
        let at = |list: &[f64]| list.get(*i).copied().unwrap_or(f64::NAN);
        at(of.speed_kmh) > REST_KMH
            && at(of.sump_degc).is_finite()
            && at(of.seconds) > 0.0
            && at(of.seconds).is_finite()
    };
    let steps: Vec<usize> = (0..of.seconds.len()).filter(moved).collect();
    let Some((low, high)) = range(steps.iter().map(|i| of.sump_degc[*i])) else {
        return (Vec::new(), 0.0);
    };
    let size = if high - low > MAX_BINS * BIN_K {
        round_step((high - low) / (MAX_BINS - 1.0)).max(BIN_K)
    } else {
        BIN_K
    };
    let first = (low / size).floor();
    let count = ((high / size).floor() - first) as usize + 1;
    let edge = |k: usize| (first + k as f64) * size;
    let mut bins: Vec<Bin> = (0..count)
        .map(|k| Bin {
            low_degc: edge(k),
            high_degc: edge(k + 1),
            seconds: 0.0,
            joule: vec![0.0; of.losses_w.len()],
        })
        .collect();
    for i in steps {
        let Some(bin) = bins.get_mut(((of.sump_degc[i] / size).floor() - first) as usize) else {
            continue;
        };
        bin.seconds += of.seconds[i];
        for (sum, (_, watts)) in bin.joule.iter_mut().zip(&of.losses_w) {
            *sum += watts.get(i).map_or(0.0, |w| finite(*w).max(0.0)) * of.seconds[i];
        }
    }
    let left_out = bins
        .iter()
        .map(|bin| bin.seconds)
        .filter(|s| *s < MIN_S)
        .sum();
    bins.retain(|bin| bin.seconds >= MIN_S);
    (bins, left_out)
}

fn table(of: &LossTrace, left_out_s: f64) -> PictureTable {
    let mut table = PictureTable::new(&[("from", "\u{b0}C"), ("to", "\u{b0}C"), ("time", "s")]);
    let names = of.losses_w.iter().map(|(c, _)| capital(c.name()));
    table
        .columns
        .extend(names.chain(["all".to_owned()]).map(|name| (name, "W")));
    table.note = format!("Means over the time in which the car moved. {REMARK}");
    if left_out_s > 0.0 {
        let seconds = number(left_out_s, 0.1);
        table.note += &format!(" Bins of less than {MIN_S} s are left out, {seconds} s in all.");
    }
    table
}

fn describe(bins: &[Bin]) -> String {
    let bin = |bin: &Bin| {
        let [low, high, watts, seconds] =
            [bin.low_degc, bin.high_degc, bin.watts(), bin.seconds].map(|x| number(x, 1.0));
        format!("{low} to {high} \u{b0}C {watts} W in {seconds} s")
    };
    format!(
        "Mean loss power while the car moved, by sump temperature: {}. {REMARK}",
        bins.iter().map(bin).collect::<Vec<_>>().join("; ")
    )
}
