//! Losses of a transmission against the temperature of its oil, while the car moved.
use super::{TOP, WIDTH, component_words, remark, remark_lines, sound};
use crate::charts::axis::{Axis, number, range, round_step};
use crate::charts::figure::{Figure, INK, Rect};
use crate::charts::legend::{Mark, below_height, legend_below};
use crate::charts::panel::{BELOW, LEFT, Panel};
use crate::charts::style::component_fill;
use crate::charts::{Picture, PictureTable, cell};
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

const PLOT_LEFT: f64 = LEFT + 8.0;
const PLOT_RIGHT: f64 = WIDTH - 20.0;
const TALL: f64 = 260.0;
const STRIP: f64 = 62.0;
const GAP: f64 = 16.0;
const BIN_K: f64 = 5.0;
const MOST_BINS: f64 = 20.0;
/// Below this a bin says nothing, s.
const LEAST_S: f64 = 1.0;
/// A car slower than this stands, km/h.
const STANDS_KMH: f64 = 0.1;
const REMARK: &str = "Within one cycle oil temperature and phase go together: cold bins are from its beginning, warm ones from its end, so the \
    difference between two bins is not that of temperature alone.";

/// Mean loss power by component against the temperature of the sump, with the time spent in each bin of temperature below it.
#[must_use]
pub fn loss_by_temperature(of: &LossTrace) -> Picture {
    let (bins, left_out_s) = bins(of);
    let names: Vec<String> = of
        .losses_w
        .iter()
        .map(|(c, _)| component_words(*c))
        .collect();
    let lines = remark_lines(REMARK, WIDTH - PLOT_LEFT - 20.0);
    let strip_top = TOP + TALL + GAP;
    let legend_top = strip_top + STRIP + BELOW + 8.0;
    let remark_top = legend_top
        + below_height(
            names.iter().map(String::as_str),
            WIDTH - PLOT_LEFT - 20.0,
            "",
        )
        + 4.0;
    let size = (WIDTH, remark_top + 14.0 * lines.len() as f64 + 8.0);
    let mut figure = Figure::new(
        size,
        PLOT_LEFT,
        "Transmission losses against oil temperature",
        &of.subject,
        &describe(&bins),
    );
    let (low, high) =
        range(bins.iter().flat_map(|bin| [bin.low_degc, bin.high_degc])).unwrap_or((0.0, 1.0));
    let x = Axis::exact("Oil temperature in the sump [\u{b0}C]", low, high, 10);
    let watts = Axis::round(
        "Mean loss power [W]",
        bins.iter()
            .map(|bin| bin.joule.iter().sum::<f64>() / bin.seconds)
            .chain([0.0]),
        7,
    );
    let time = Axis::round(
        "Time [s]",
        bins.iter().map(|bin| bin.seconds).chain([0.0]),
        3,
    );
    let rect = |top: f64, tall: f64| Rect {
        left: PLOT_LEFT,
        right: PLOT_RIGHT,
        top,
        bottom: top + tall,
    };
    let upper = Panel::draw(&mut figure, rect(TOP, TALL), x.clone(), watts, false);
    let lower = Panel::draw(&mut figure, rect(strip_top, STRIP), x, time, true);
    let paints: Vec<String> = of
        .losses_w
        .iter()
        .map(|(c, _)| component_fill(&mut figure, "warm", *c))
        .collect();
    let mut table = table(&names, left_out_s);
    for bin in &bins {
        let mut cells = vec![
            cell(bin.low_degc, 1.0),
            cell(bin.high_degc, 1.0),
            cell(bin.seconds, 0.1),
        ];
        cells.extend(
            bin.joule
                .iter()
                .chain([&bin.joule.iter().sum()])
                .map(|joule| cell(joule / bin.seconds, 0.1)),
        );
        let row = table.push(cells);
        let mut base = 0.0;
        for (joule, paint) in bin.joule.iter().zip(&paints) {
            let next = base + joule / bin.seconds;
            column(&mut figure, &upper, bin, (base, next), paint, row);
            base = next;
        }
        column(&mut figure, &lower, bin, (0.0, bin.seconds), "#bcbcbc", row);
    }
    for panel in [&upper, &lower] {
        if bins.is_empty() {
            panel.empty(&mut figure);
        }
        panel.outline(&mut figure);
    }
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(names).collect();
    legend_below(
        &mut figure,
        (PLOT_LEFT, legend_top),
        WIDTH - PLOT_LEFT - 20.0,
        "",
        &entries,
    );
    remark(&mut figure, (PLOT_LEFT, remark_top), &lines);
    Picture {
        svg: figure.finish(),
        table,
    }
}

fn column(
    figure: &mut Figure,
    panel: &Panel,
    bin: &Bin,
    (from, to): (f64, f64),
    paint: &str,
    row: usize,
) {
    if to > from {
        let rect = Rect {
            left: panel.px(bin.low_degc),
            right: panel.px(bin.high_degc),
            top: panel.py(to),
            bottom: panel.py(from),
        };
        figure.rect(rect, &format!("class=\"bar\" data-row=\"{row}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"1\""));
    }
}

/// Bins from cold to warm, and the time of those too short to tell anything, s.
fn bins(of: &LossTrace) -> (Vec<Bin>, f64) {
    let moved = |i: &usize| {
        let at = |list: &[f64]| list.get(*i).copied().unwrap_or(f64::NAN);
        at(of.speed_kmh) > STANDS_KMH
            && at(of.sump_degc).is_finite()
            && at(of.seconds) > 0.0
            && at(of.seconds).is_finite()
    };
    let steps: Vec<usize> = (0..of.seconds.len()).filter(moved).collect();
    let Some((low, high)) = range(steps.iter().map(|i| of.sump_degc[*i])) else {
        return (Vec::new(), 0.0);
    };
    let size = if high - low > MOST_BINS * BIN_K {
        round_step((high - low) / (MOST_BINS - 1.0)).max(BIN_K)
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
            *sum += watts.get(i).map_or(0.0, |w| sound(*w).max(0.0)) * of.seconds[i];
        }
    }
    let left_out = bins
        .iter()
        .map(|bin| bin.seconds)
        .filter(|s| *s < LEAST_S)
        .sum();
    bins.retain(|bin| bin.seconds >= LEAST_S);
    (bins, left_out)
}

fn table(names: &[String], left_out_s: f64) -> PictureTable {
    let mut table = PictureTable::new(&[("from", "\u{b0}C"), ("to", "\u{b0}C"), ("time", "s")]);
    table
        .columns
        .extend(names.iter().map(|name| (name.clone(), "W")));
    table.columns.push(("all".to_owned(), "W"));
    table.note = format!("Means over the time in which the car moved. {REMARK}");
    if left_out_s > 0.0 {
        table.note += &format!(
            " Bins of less than {LEAST_S} s are left out, {} s in all.",
            number(left_out_s, 0.1)
        );
    }
    table
}

fn describe(bins: &[Bin]) -> String {
    let told = |bin: &Bin| {
        let watts = number(bin.joule.iter().sum::<f64>() / bin.seconds, 1.0);
        format!(
            "{} to {} \u{b0}C {watts} W in {} s",
            number(bin.low_degc, 1.0),
            number(bin.high_degc, 1.0),
            number(bin.seconds, 1.0)
        )
    };
    format!(
        "Mean loss power while the car moved, by sump temperature: {}. {REMARK}",
        bins.iter().map(told).collect::<Vec<_>>().join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    #[test]
    fn energy_and_time_are_those_of_the_moving_car() {
        let seconds = [1.0, 2.0, 1.0, 0.5, 3.0, 4.0];
        let sump = [-7.0, -6.0, -2.0, 12.0, 21.0, 24.9];
        let speed = [10.0, 20.0, 0.0, 30.0, 40.0, 50.0];
        let (pump, drive) = ([100.0, 400.0, 900.0, 9e9, 50.0, 85.0], [10.0; 6]);
        let losses_w = vec![
            (Component::Pump, &pump[..]),
            (Component::FinalDrive, &drive[..]),
        ];
        let trace = LossTrace {
            subject: "<a & b>".to_owned(),
            seconds: &seconds,
            sump_degc: &sump,
            speed_kmh: &speed,
            losses_w,
        };
        let picture = loss_by_temperature(&trace);
        check(&picture);
        let rows: Vec<Vec<f64>> = picture
            .table
            .rows
            .iter()
            .map(|row| row.iter().map(|cell| numbers(cell)).collect())
            .collect();
        assert_eq!(
            rows,
            [
                [-10.0, -5.0, 3.0, 300.0, 10.0, 310.0],
                [20.0, 25.0, 7.0, 70.0, 10.0, 80.0]
            ]
        );
        assert!(picture.table.note.contains("0.5 s in all") && picture.svg.contains("go together"));
    }

    #[test]
    fn many_temperatures_make_wider_bins() {
        let sump: Vec<f64> = (0..400).map(|k| -40.0 + 0.5 * f64::from(k)).collect();
        let (ones, speed) = (vec![1.0; 400], vec![30.0; 400]);
        let losses_w = vec![(Component::Churning, &ones[..])];
        let trace = LossTrace {
            seconds: &ones,
            sump_degc: &sump,
            speed_kmh: &speed,
            losses_w,
            ..LossTrace::default()
        };
        let picture = loss_by_temperature(&trace);
        check(&picture);
        assert!(picture.table.rows.len() <= 20 && picture.table.rows.len() > 5);
        let time: f64 = picture.table.rows.iter().map(|row| numbers(&row[2])).sum();
        assert!((time - 400.0).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_still_a_picture() {
        check(&loss_by_temperature(&LossTrace::default()));
        let broken = [f64::NAN, 1.0];
        let losses_w = vec![(Component::Seal, &broken[..1])];
        check(&loss_by_temperature(&LossTrace {
            seconds: &broken,
            sump_degc: &broken,
            speed_kmh: &broken,
            losses_w,
            ..LossTrace::default()
        }));
    }
}
