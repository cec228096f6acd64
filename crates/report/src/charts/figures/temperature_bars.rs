//! Losses of a transmission against the temperature of its oil, while the car moved.

use super::{TOP, Term, finite};
use crate::charts::engine::{
    Axis, Chart, Entry, Fill, PLOT_LEFT, Panel, Rect, Style, WIDTH, at, cell, number, range,
    round_step,
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
pub fn loss_by_temperature(of: &LossTrace) -> Picture {
    let (bins, left_out_s) = bins(of);
    let [mut upper, mut lower] = panels(&bins);
    let mut table = table(of, left_out_s);
    for bin in &bins {
        let mean = |joule: &f64| joule / bin.seconds;
        let watts = bin.joule.iter().map(mean).chain([bin.watts()]);
        let numbers = [bin.seconds].into_iter().chain(watts).map(|x| cell(x, 0.1));
        let ends = [bin.low_degc, bin.high_degc].map(|x| cell(x, 1.0));
        let row = table.push(ends.into_iter().chain(numbers));
        let mut base = 0.0;
        for (joule, (component, _)) in bin.joule.iter().zip(&of.losses_w) {
            let next = base + mean(joule);
            column(
                &mut upper,
                bin,
                (base, next),
                Fill::component(*component),
                row,
            );
            base = next;
        }
        column(&mut lower, bin, (0.0, bin.seconds), Term::Other.fill(), row);
    }
    let entry = |(c, _): &(Component, _)| Entry::fill(Fill::component(*c), capital(c.name()));
    let place = (PLOT_LEFT, WIDE);
    Chart::new(
        "Transmission losses against oil temperature",
        &of.subject,
        PLOT_LEFT,
    )
    .panels([upper, lower])
    .legend(place, of.losses_w.iter().map(entry))
    .notes(place, vec![REMARK.to_owned()])
    .picture(table)
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
    [
        Panel::new(upper, x(), Axis::round("Mean loss power [W]", watts, 7)).x_labels(false),
        Panel::new(lower, x(), Axis::round("Time [s]", seconds, 3)),
    ]
    .map(|panel| panel.no_data(bins.is_empty()))
}

fn column(panel: &mut Panel, bin: &Bin, (from, to): (f64, f64), fill: Fill, row: usize) {
    if to > from {
        let style = Style::edged(fill, 0.25).class("bar").row(row);
        panel.rectangle(at(bin.low_degc, to), at(bin.high_degc, from), style);
    }
}

/// Bins from cold to warm, and the time of those too short to count, s.
fn bins(of: &LossTrace) -> (Vec<Bin>, f64) {
    let moved = |i: &usize| {
        let at = |list: &[f64]| list.get(*i).copied().unwrap_or(f64::NAN);
        let seconds = at(of.seconds);
        at(of.speed_kmh) > REST_KMH
            && at(of.sump_degc).is_finite()
            && seconds > 0.0
            && seconds.is_finite()
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
    let empty = |k: usize| Bin {
        low_degc: edge(k),
        high_degc: edge(k + 1),
        seconds: 0.0,
        joule: vec![0.0; of.losses_w.len()],
    };
    let mut bins: Vec<Bin> = (0..count).map(empty).collect();
    for i in steps {
        let Some(bin) = bins.get_mut(((of.sump_degc[i] / size).floor() - first) as usize) else {
            continue;
        };
        bin.seconds += of.seconds[i];
        for (sum, (_, watts)) in bin.joule.iter_mut().zip(&of.losses_w) {
            *sum += watts.get(i).map_or(0.0, |w| finite(*w).max(0.0)) * of.seconds[i];
        }
    }
    let (kept, short): (Vec<Bin>, Vec<Bin>) =
        bins.into_iter().partition(|bin| bin.seconds >= MIN_S);
    (kept, short.iter().map(|bin| bin.seconds).sum())
}

fn table(of: &LossTrace, left_out_s: f64) -> PictureTable {
    let mut table = PictureTable::new(&[("from", "\u{b0}C"), ("to", "\u{b0}C"), ("time", "s")]);
    let names = of.losses_w.iter().map(|(c, _)| capital(c.name()));
    let names = names.chain(["all".to_owned()]);
    table.columns.extend(names.map(|name| (name, "W")));
    table.note = format!("Means over the time in which the car moved. {REMARK}");
    if left_out_s > 0.0 {
        let seconds = number(left_out_s, 0.1);
        table.note += &format!(" Bins of less than {MIN_S} s are left out, {seconds} s in all.");
    }
    table
}
