//! How an output, or a difference of pairs, is distributed: histogram over cumulative curve.

use super::super::axis::{Axis, range, round_step};
use super::super::figure::{Anchor, Figure, INK, Path, Rect, UNITS, units};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::style::{STROKES, Stroke};
use super::text::{foot, foot_height, lines, middle, percent, value};
use super::{RIGHT, Shown, WIDTH, capital};
use cvtcycle_study::statistics::{Share, Summary, quantile_of_sorted};

/// Values of an output and what they are of.
#[derive(Clone, Copy, Debug)]
pub struct DistributionPlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// Subject and baselines, or differences; the first seven are drawn.
    pub series: &'a [DistributionSeries<'a>],
    /// Whether the values are differences of pairs: zero is marked and the share above it written.
    pub differences: bool,
}

/// One car, or one pair of cars.
#[derive(Clone, Copy, Debug)]
pub struct DistributionSeries<'a> {
    /// Name in the legend.
    pub name: &'a str,
    /// Values; those that are not finite are missing.
    pub values: &'a [f64],
}

/// A series prepared for drawing.
struct Drawn<'a> {
    name: &'a str,
    sorted: Vec<f64>,
    summary: Summary,
    above: Share,
}

const TOP: f64 = 58.0;
const PLOT_LEFT: f64 = LEFT + 8.0;
const WIDE: f64 = RIGHT - PLOT_LEFT;
const TALL: f64 = 230.0;
const GAP: f64 = 16.0;
/// Most steps of a cumulative curve: more could not be seen.
const STEPS: usize = 1500;
/// Bins at most.
const BINS: f64 = 100.0;
/// Rounding up after a division by this lands on the nearest round number.
const NEAREST: f64 = 1.6;
/// Quantiles with a mark.
const MARKED: [f64; 3] = [0.05, 0.5, 0.95];
/// Dashed, so that it stays apart from the frame.
const ZERO: Stroke = Stroke {
    colour: "#000000",
    width: 1.4,
    dash: &[6.0, 2.0],
};
const GUIDE: Stroke = Stroke {
    colour: "#555555",
    width: 0.9,
    dash: &[3.0, 3.0],
};

/// Draws histogram and cumulative curve of each series over one axis, with the 5, 50 and 95 % quantiles marked.
#[must_use]
pub fn distribution_plot(plot: &DistributionPlot) -> Picture {
    let series: Vec<Drawn> = plot
        .series
        .iter()
        .take(STROKES.len())
        .map(prepare)
        .collect();
    let edges = edges(&series, plot.differences);
    let shares: Vec<Vec<f64>> = series.iter().map(|s| shares(s, &edges)).collect();
    let told = told(plot, &series);
    let mut marks: Vec<(Mark, &str)> = series
        .iter()
        .enumerate()
        .map(|(k, s)| (Mark::Line(STROKES[k]), s.name))
        .collect();
    if plot.differences {
        marks.push((Mark::Line(ZERO), "No difference"));
    }
    let headline = headline(plot, &series);
    let head = lines(&headline, 12.0, WIDE);
    let top = TOP
        + if head.is_empty() {
            0.0
        } else {
            16.0 * head.len() as f64 + 6.0
        };
    let upper = Rect {
        left: PLOT_LEFT,
        right: RIGHT,
        top,
        bottom: top + TALL,
    };
    let lower = Rect {
        top: upper.bottom + GAP,
        bottom: upper.bottom + GAP + TALL,
        ..upper
    };
    let below = (PLOT_LEFT, lower.bottom + BELOW + 8.0);
    let names: Vec<&str> = marks.iter().map(|(_, name)| *name).collect();
    let tall = below.1 + foot_height(names.into_iter(), WIDE, &told);
    let what = if plot.differences {
        "Distribution of the difference"
    } else {
        "Distribution"
    };
    let title = format!("{what}: {}", plot.shown.output);
    let desc = format!(
        "Histogram over cumulative curve, quantiles of 5, 50 and 95 % marked. {headline} {}",
        told.join(" ")
    )
    .replace('\u{a0}', " ");
    let mut figure = Figure::new((WIDTH, tall), PLOT_LEFT, &title, plot.shown.subject, &desc);
    for (k, line) in head.iter().enumerate() {
        figure.text(
            (PLOT_LEFT, TOP + 6.0 + 16.0 * k as f64),
            12.0,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            line,
        );
    }
    let output = if plot.differences {
        format!("Difference: {}", plot.shown.output)
    } else {
        capital(plot.shown.output)
    };
    let x = || {
        Axis::exact(
            &plot.shown.axis(&middle(&output, 12.0, WIDE - 90.0)),
            edges[0],
            edges[edges.len() - 1],
            9,
        )
    };
    histogram(&mut figure, (upper, x()), &series, &shares, &edges);
    cumulative(&mut figure, lower, x(), &series);
    foot(&mut figure, below, WIDE, marks, &told);
    Picture {
        svg: figure.finish(),
        table: table(plot, &output, &series, &edges, &shares, &told),
    }
}

/// A row for each bin, its middle first.
fn table(
    plot: &DistributionPlot,
    output: &str,
    series: &[Drawn],
    edges: &[f64],
    shares: &[Vec<f64>],
    told: &[String],
) -> PictureTable {
    let mut columns = vec![
        plot.shown.column(format!("{output}, middle")),
        plot.shown.column("From"),
        plot.shown.column("To"),
    ];
    for s in series {
        columns.extend([
            (format!("{}: runs in the bin", s.name), "%"),
            (format!("{}: runs up to its end", s.name), "%"),
        ]);
    }
    let mut table = PictureTable {
        columns,
        note: told.join(" ").replace('\u{a0}', " "),
        ..PictureTable::default()
    };
    for (k, pair) in edges.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        let mut cells = vec![
            cell(0.5 * (pair[0] + pair[1]), 0.1 * step),
            cell(pair[0], step),
            cell(pair[1], step),
        ];
        for shares in shares {
            cells.extend([cell(shares[k], 0.1), cell(shares[..=k].iter().sum(), 0.1)]);
        }
        table.push(cells);
    }
    table
}

fn prepare<'a>(series: &DistributionSeries<'a>) -> Drawn<'a> {
    let mut sorted: Vec<f64> = series
        .values
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .collect();
    sorted.sort_unstable_by(f64::total_cmp);
    Drawn {
        name: series.name,
        sorted,
        summary: Summary::of(series.values),
        above: Share::above_zero(series.values),
    }
}

/// Edges of the bins of all series: at round numbers, so that zero is one of them; about as wide as Freedman and Diaconis (1981) advise.
fn edges(series: &[Drawn], with_zero: bool) -> Vec<f64> {
    let ends = series
        .iter()
        .flat_map(|s| [s.summary.min, s.summary.max])
        .chain(with_zero.then_some(0.0));
    let Some((low, high)) = range(ends) else {
        return vec![0.0, 1.0];
    };
    let advised = |s: &Drawn| {
        2.0 * (s.summary.quantile(0.75) - s.summary.quantile(0.25)) / (s.summary.n as f64).cbrt()
    };
    let advised = series
        .iter()
        .map(advised)
        .filter(|width| *width > 0.0)
        .fold(f64::INFINITY, f64::min);
    let (span, size) = (high - low, low.abs().max(high.abs()));
    let step = if span > 1e-9 * size {
        round_step((advised.min(span / 4.0) / NEAREST).max(span / BINS))
    } else {
        round_step((0.02 * size).max(1e-12))
    };
    // A bin beyond zero where nothing else lies there, lest the line of no difference hides in the frame.
    let apart = |end: f64| {
        if with_zero && end.abs() < 1e-9 * step {
            1.0
        } else {
            0.0
        }
    };
    let (first, last) = (
        (low / step + 1e-9).floor() - apart(low),
        (high / step - 1e-9).ceil() + apart(high),
    );
    // A value on the last edge belongs into the last bin; a lone value gets a bin around it.
    let count = (last - first).clamp(1.0, 2.0 * BINS) as usize;
    (0..=count).map(|i| (first + i as f64) * step).collect()
}

/// How much of a series lies in each bin, %.
fn shares(series: &Drawn, edges: &[f64]) -> Vec<f64> {
    let sorted = &series.sorted;
    let last = edges.len() - 2;
    // The outer bins take in what lies on the outer edges, or beside them by rounding.
    let upto = |k: usize| {
        if k > last {
            sorted.len()
        } else {
            sorted.partition_point(|x| *x < edges[k])
        }
    };
    let count = |k: usize| upto(k + 1) - if k == 0 { 0 } else { upto(k) };
    (0..=last)
        .map(|k| 100.0 * count(k) as f64 / sorted.len().max(1) as f64)
        .collect()
}

fn histogram(
    figure: &mut Figure,
    (rect, x): (Rect, Axis),
    series: &[Drawn],
    shares: &[Vec<f64>],
    edges: &[f64],
) {
    let y = Axis::round(
        "Runs in a bin [%]",
        shares.iter().flatten().copied().chain([0.0]),
        6,
    );
    let panel = Panel::over_table(figure, rect, x, y, false);
    for (k, shares) in shares.iter().enumerate().rev() {
        if series[k].sorted.is_empty() {
            continue;
        }
        let mut path = Path::default();
        path.move_to(panel.px(edges[0]), panel.py(0.0));
        for (pair, share) in edges.windows(2).zip(shares) {
            path.line_to(panel.px(pair[0]), panel.py(*share));
            path.line_to(panel.px(pair[1]), panel.py(*share));
        }
        path.line_to(panel.px(edges[edges.len() - 1]), panel.py(0.0));
        let (data, line, colour) = (path.finish(), STROKES[k].attributes(), STROKES[k].colour);
        figure.raw(&format!("<path class=\"area\" d=\"{data}\" fill=\"{colour}\" fill-opacity=\"0.12\" stroke=\"none\"/>"));
        figure.raw(&format!("<path class=\"series\" d=\"{data}\" {line}/>"));
    }
    if series.iter().all(|s| s.sorted.is_empty()) {
        panel.empty(figure);
    } else {
        zero(figure, &panel);
        quantile_lines(figure, &panel, series);
    }
    panel.outline(figure);
}

fn cumulative(figure: &mut Figure, rect: Rect, x: Axis, series: &[Drawn]) {
    let panel = Panel::over_table(
        figure,
        rect,
        x,
        Axis::exact("Runs at or below [%]", 0.0, 104.0, 6),
        true,
    );
    for p in MARKED {
        panel.line(
            figure,
            &[(panel.x.low, 100.0 * p), (panel.x.high, 100.0 * p)],
            GUIDE,
        );
    }
    zero(figure, &panel);
    quantile_lines(figure, &panel, series);
    for (k, s) in series.iter().enumerate().rev() {
        panel.line_any(figure, &steps(&s.sorted), STROKES[k]);
    }
    for (k, s) in series
        .iter()
        .enumerate()
        .filter(|(_, s)| !s.sorted.is_empty())
    {
        for p in MARKED {
            let (cx, cy, r) = (
                units(panel.px(s.summary.quantile(p))),
                units(panel.py(100.0 * p)),
                3.4 * UNITS,
            );
            let colour = STROKES[k].colour;
            figure.raw(&format!(
                "<circle class=\"mark\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" fill=\"#ffffff\" stroke=\"{colour}\" stroke-width=\"6\"/>"
            ));
        }
    }
    panel.outline(figure);
}

/// The cumulative curve as far as it can be seen: a stair of few values, a line through quantiles of many.
fn steps(sorted: &[f64]) -> Vec<(f64, f64)> {
    if sorted.len() > STEPS {
        return (0..=STEPS)
            .map(|k| k as f64 / STEPS as f64)
            .map(|p| (quantile_of_sorted(sorted, p), 100.0 * p))
            .collect();
    }
    let share = |k: usize| 100.0 * k as f64 / sorted.len() as f64;
    sorted
        .iter()
        .enumerate()
        .flat_map(|(k, x)| [(*x, share(k)), (*x, share(k + 1))])
        .collect()
}

/// The line of no difference, where zero lies within.
fn zero(figure: &mut Figure, panel: &Panel) {
    if panel.x.low <= 0.0 && 0.0 <= panel.x.high && panel.x.low < panel.x.high {
        let at = panel.px(0.0);
        figure.line(
            (at, panel.rect.top),
            (at, panel.rect.bottom),
            &format!("class=\"zero\" {}", ZERO.attributes()),
        );
    }
}

/// Of a lone series the marked quantiles run through both panels.
fn quantile_lines(figure: &mut Figure, panel: &Panel, series: &[Drawn]) {
    if let [s] = series {
        for x in MARKED
            .map(|p| s.summary.quantile(p))
            .into_iter()
            .filter(|x| x.is_finite())
        {
            panel.line_any(figure, &[(x, panel.y.low), (x, panel.y.high)], GUIDE);
        }
    }
}

/// The answer in one sentence, for one series of differences.
fn headline(plot: &DistributionPlot, series: &[Drawn]) -> String {
    match series {
        [s] if plot.differences && s.above.n > 0 => format!("Above zero in {}.", above(&s.above)),
        _ => String::new(),
    }
}

/// "934 of 1000 pairs: 93.4 % (91.7 to 94.9 %)".
fn above(share: &Share) -> String {
    let [low, high] = share.interval95.map(percent);
    format!(
        "{} of {} pairs: {}\u{a0}% ({low} to {high}\u{a0}%)",
        share.k,
        share.n,
        percent(share.share)
    )
}

fn told(plot: &DistributionPlot, series: &[Drawn]) -> Vec<String> {
    let spread = series
        .iter()
        .map(|s| s.summary.quantile(0.975) - s.summary.quantile(0.025))
        .filter(|w| *w > 0.0)
        .fold(f64::NAN, f64::min);
    let unit = plot.shown.after();
    let digits = |x: f64| value(x, spread);
    let one = |s: &Drawn| {
        if s.summary.n == 0 {
            return format!("{}: no values, {} missing.", s.name, s.summary.missing);
        }
        let q = |p: f64| digits(s.summary.quantile(p));
        let mut text = format!(
            "{}: median {}{unit}, 90\u{a0}% within {} to {}",
            s.name,
            q(0.5),
            q(0.05),
            q(0.95)
        );
        if let Some([low, high]) = s.summary.mean_interval95 {
            text += &format!(
                "; mean {} ({} to {})",
                digits(s.summary.mean),
                digits(low),
                digits(high)
            );
        }
        if plot.differences && series.len() > 1 && s.above.n > 0 {
            text += &format!("; above zero in {}", above(&s.above));
        }
        let missing = if s.summary.missing > 0 {
            format!(", {} missing", s.summary.missing)
        } else {
            String::new()
        };
        text + &format!("; n\u{a0}=\u{a0}{}{missing}.", s.summary.n)
    };
    let mut notes: Vec<String> = series.iter().map(one).collect();
    if plot.series.len() > series.len() {
        notes.push(format!(
            "{} more are not drawn.",
            plot.series.len() - series.len()
        ));
    }
    notes
}
