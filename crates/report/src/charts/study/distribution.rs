//! How an output, or a difference of pairs, is distributed: histogram over cumulative curve.

use super::{FOOT, Shown, WIDE, percent, value};
use crate::charts::engine::{
    Axis, Chart, Cut, Entry, INK, Label, PLOT_LEFT, Panel, Point, QUIET, Rect, STROKES, Shape,
    Stroke, Style, Symbol, at, cell, lines, range, round_step, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital_first;
use cvtcycle_study::statistics::{Confidence, Numbers, Share, Summary, quantiles};

/// One car, or one pair of cars.
#[derive(Clone, Copy, Debug)]
pub struct DistributionSeries<'a, P: ?Sized = [f64]> {
    /// Name in the legend.
    pub name: &'a str,
    /// Values; those that are not finite are missing.
    pub values: &'a P,
}

/// A series prepared for drawing.
struct Drawn<'a> {
    name: &'a str,
    /// The cumulative curve.
    steps: Vec<(f64, f64)>,
    summary: Summary,
    above: Share,
    confidence: Confidence,
}

impl Drawn<'_> {
    fn is_empty(&self) -> bool {
        self.summary.n == 0
    }
}

const TOP: f64 = 58.0;
const TALL: f64 = 230.0;
const GAP: f64 = 16.0;
/// Most steps of a cumulative curve: more could not be seen.
const STEPS: usize = 1500;
/// Bins at most.
const BINS: f64 = 100.0;
/// Rounding up after a division by this lands on the nearest round number.
const NEAREST: f64 = 1.6;
/// Of fewer pairs than these only the counts are given.
const FEW: usize = 200;
/// Most series that the picture in words describes.
const IN_WORDS: usize = 2;
/// Probabilities of the quantiles with a mark.
fn marked(confidence: Confidence) -> [f64; 3] {
    let [low, high] = confidence.ends();
    [low, 0.5, high]
}
/// Dashed, so that it stays apart from the frame.
const ZERO: Stroke = stroke(INK, 1.4, &[6.0, 2.0]);
const GUIDE: Stroke = stroke(QUIET, 0.9, &[3.0, 3.0]);

/// Draws histogram and cumulative curve of each series over one axis, with the median and the two ends of its confidence marked; of more
/// than seven the first seven. Of differences of pairs zero is marked and the share above it written.
///
/// # Errors
/// Values that cannot be had.
pub fn distribution_plot<P: Numbers + ?Sized>(
    shown: &Shown,
    all: &[DistributionSeries<P>],
    differences: bool,
) -> Result<Picture, P::Error> {
    let drawn = &all[..all.len().min(STROKES.len())];
    let series = drawn.iter().map(|series| prepare(series, shown.confidence));
    let series: Vec<Drawn> = series.collect::<Result<_, _>>()?;
    let edges = edges(&series, differences);
    let shares = drawn.iter().map(|series| shares(series.values, &edges));
    let shares: Vec<Vec<f64>> = shares.collect::<Result<_, _>>()?;
    Ok(drawing(
        shown,
        (all.len(), &series),
        (&edges, &shares),
        differences,
    ))
}

fn drawing(
    shown: &Shown,
    (all, series): (usize, &[Drawn]),
    (edges, shares): (&[f64], &[Vec<f64>]),
    differences: bool,
) -> Picture {
    let (headline, notes) = (
        headline(series, differences),
        notes(shown, all, series, differences),
    );
    let lines = lines(&headline, 12.0, WIDE);
    let gap = if lines.is_empty() { 0.0 } else { 6.0 };
    let head = 16.0 * lines.len() as f64 + gap;
    let (what, output) = match differences {
        true => (
            "Distribution of the difference",
            format!("Difference: {}", shown.output),
        ),
        false => ("Distribution", capital_first(shown.output)),
    };
    let title = Cut::Middle.apply(&output, 12.0, WIDE - 90.0);
    let title = shown.axis(&title);
    let x = Axis::exact(&title, edges[0], edges[edges.len() - 1], 9);
    let rect = Rect::new(PLOT_LEFT, TOP + head, WIDE, TALL);
    let mut upper = histogram((rect, x.clone()), series, shares, edges);
    for (k, line) in lines.into_iter().enumerate() {
        let place = at(f64::NEG_INFINITY, f64::INFINITY);
        let place = place.shift(0.0, 6.0 - head + 16.0 * k as f64);
        upper.label(Label::new(place, line).size(12.0).bold(true));
    }
    let rect = Rect::new(PLOT_LEFT, rect.bottom + GAP, WIDE, TALL);
    let lower = cumulative((rect, x), series, marked(shown.confidence));
    let names = series.iter().zip(STROKES);
    let names = names.map(|(s, stroke)| Entry::line(stroke, s.name));
    let zero = differences.then(|| Entry::line(ZERO, "No difference"));
    let table = table(shown, &output, series, (edges, shares), &notes);
    let title = sentence(shown, series, differences, what);
    let lead = format!(
        "{headline} {}",
        notes[..notes.len().min(IN_WORDS)].join(" ")
    );
    Chart::new(title, shown.subject, PLOT_LEFT)
        .lead(lead.trim().replace('\u{a0}', " "))
        .panels([upper, lower])
        .legend(FOOT, names.chain(zero))
        .notes(FOOT, notes)
        .picture(table)
}

/// A row for each bin, its middle first.
/// A sentence on one series, else what is drawn.
fn sentence(shown: &Shown, series: &[Drawn], differences: bool, what: &str) -> String {
    match series {
        [s] if differences && s.above.n > 0 => {
            format!(
                "{} is above zero in {}",
                capital_first(shown.output),
                above(&s.above)
            )
        }
        [s] if s.summary.n > 0 => {
            let [low, high] = s.confidence.ends().map(|p| s.summary.quantile(p));
            let digits = |x: f64| value(x, high - low);
            let level = s.confidence.draws_percent();
            format!(
                "{level} % of the values of the {} lie between {} and {}{}",
                shown.output,
                digits(low),
                digits(high),
                shown.after()
            )
        }
        _ => format!("{what}: {}", shown.output),
    }
}

fn table(
    shown: &Shown,
    output: &str,
    series: &[Drawn],
    (edges, shares): (&[f64], &[Vec<f64>]),
    notes: &[String],
) -> PictureTable {
    let column = |name: &str| shown.column(name);
    let mut columns = vec![
        column(&format!("{output}, middle")),
        column("From"),
        column("To"),
    ];
    for s in series {
        let names = ["runs in the bin", "runs up to its end"];
        columns.extend(names.map(|name| (format!("{}: {name}", s.name), "%")));
    }
    let note = notes.join(" ").replace('\u{a0}', " ");
    let mut table = PictureTable::with_columns(columns).note(note);
    for (k, pair) in edges.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        let middle = cell(0.5 * (pair[0] + pair[1]), 0.1 * step);
        let mut cells = vec![middle, cell(pair[0], step), cell(pair[1], step)];
        for shares in shares {
            cells.extend([cell(shares[k], 0.1), cell(shares[..=k].iter().sum(), 0.1)]);
        }
        table.push(cells);
    }
    table
}

fn prepare<'a, P: Numbers + ?Sized>(
    series: &DistributionSeries<'a, P>,
    confidence: Confidence,
) -> Result<Drawn<'a>, P::Error> {
    let summary = Summary::over(series.values, confidence)?;
    Ok(Drawn {
        name: series.name,
        steps: steps(series.values, &summary)?,
        above: Share::over_zero(series.values, Some(confidence))?,
        summary,
        confidence,
    })
}

/// Edges of the bins of all series: at round numbers, so that zero is one of them; about as wide as Freedman and Diaconis (1981) advise.
fn edges(series: &[Drawn], with_zero: bool) -> Vec<f64> {
    let ends = series.iter().flat_map(|s| [s.summary.min, s.summary.max]);
    let Some((low, high)) = range(ends.chain(with_zero.then_some(0.0))) else {
        return vec![0.0, 1.0];
    };
    let advised = |s: &Drawn| {
        2.0 * (s.summary.quantile(0.75) - s.summary.quantile(0.25)) / (s.summary.n as f64).cbrt()
    };
    let advised = series.iter().map(advised).filter(|width| *width > 0.0);
    let advised = advised.fold(f64::INFINITY, f64::min);
    let (span, size) = (high - low, low.abs().max(high.abs()));
    let step = if span > 1e-9 * size {
        round_step((advised.min(span / 4.0) / NEAREST).max(span / BINS))
    } else {
        round_step((0.02 * size).max(1e-12))
    };
    // A bin beyond zero where nothing else lies there, lest the line of no difference hides in the frame.
    let alone = |end: f64| with_zero && end.abs() < 1e-9 * step;
    let apart = |end: f64| if alone(end) { 1.0 } else { 0.0 };
    let first = (low / step + 1e-9).floor() - apart(low);
    let last = (high / step - 1e-9).ceil() + apart(high);
    // A value on the last edge belongs into the last bin; a lone value gets a bin around it.
    let count = (last - first).clamp(1.0, 2.0 * BINS) as usize;
    (0..=count).map(|i| (first + i as f64) * step).collect()
}

/// How much of a series lies in each bin, %. The outer bins take in what lies on the outer edges, or next to them by rounding.
fn shares<P: Numbers + ?Sized>(values: &P, edges: &[f64]) -> Result<Vec<f64>, P::Error> {
    let last = edges.len() - 2;
    let inner = &edges[1..=last];
    let mut counts = vec![0_u64; last + 1];
    values.pass(|piece| {
        for x in piece.iter().filter(|x| x.is_finite()) {
            counts[inner.partition_point(|edge| edge <= x)] += 1;
        }
    })?;
    let all = counts.iter().sum::<u64>().max(1) as f64;
    Ok(counts
        .iter()
        .map(|count| 100.0 * *count as f64 / all)
        .collect())
}

fn histogram(
    (rect, x): (Rect, Axis),
    series: &[Drawn],
    shares: &[Vec<f64>],
    edges: &[f64],
) -> Panel {
    let heights = shares.iter().flatten().copied();
    let y = Axis::round("Runs in a bin [%]", heights.chain([0.0]), 6);
    let mut panel = Panel::new(rect, x, y)
        .over_table()
        .x_labels(false)
        .no_data(series.iter().all(Drawn::is_empty));
    for (k, shares) in shares.iter().enumerate().rev() {
        if series[k].is_empty() {
            continue;
        }
        let bins = edges.windows(2).zip(shares);
        let steps = bins.flat_map(|(pair, share)| [(pair[0], *share), (pair[1], *share)]);
        let ends = [edges[0], edges[edges.len() - 1]].map(|x| (x, 0.0));
        let outline = [ends[0]].into_iter().chain(steps).chain([ends[1]]);
        let outline: Vec<Point> = outline.collect();
        let area = Style::colour(STROKES[k].colour).fill_opacity(0.12);
        panel.add(Shape::Area(vec![outline.clone()]), area.class("area"));
        panel.series(outline, STROKES[k]);
    }
    if !panel.no_data {
        zero(&mut panel);
        quantile_lines(&mut panel, series);
    }
    panel
}

fn cumulative((rect, x): (Rect, Axis), series: &[Drawn], marked: [f64; 3]) -> Panel {
    let y = Axis::exact("Runs at or below [%]", 0.0, 104.0, 6);
    let mut panel = Panel::new(rect, x, y).over_table();
    for p in marked {
        panel.level(100.0 * p, GUIDE);
    }
    zero(&mut panel);
    quantile_lines(&mut panel, series);
    for (k, s) in series.iter().enumerate().rev() {
        panel.add(Shape::Line(s.steps.clone()), Style::line(STROKES[k]));
    }
    let known = |(s, _): &(&Drawn, _)| !s.is_empty();
    for (s, stroke) in series.iter().zip(STROKES).filter(known) {
        for p in marked {
            let place = at(s.summary.quantile(p), 100.0 * p);
            let style = Symbol::white(stroke.colour).class("mark");
            panel.symbol(Symbol::CIRCLE, place, 3.4, style);
        }
    }
    panel
}

/// The cumulative curve as far as it can be seen: a stair of few values, a line through quantiles of many.
fn steps<P: Numbers + ?Sized>(values: &P, summary: &Summary) -> Result<Vec<(f64, f64)>, P::Error> {
    if summary.n > STEPS {
        let shares: Vec<f64> = (0..=STEPS).map(|k| k as f64 / STEPS as f64).collect();
        let found = quantiles(values, summary, &shares)?.into_iter();
        return Ok(found.zip(shares).map(|(x, p)| (x, 100.0 * p)).collect());
    }
    let mut sorted = Vec::with_capacity(summary.n);
    values.pass(|piece| sorted.extend(piece.iter().filter(|x| x.is_finite())))?;
    sorted.sort_unstable_by(f64::total_cmp);
    let share = |k: usize| 100.0 * k as f64 / sorted.len() as f64;
    let step = |(k, x): (usize, &f64)| [(*x, share(k)), (*x, share(k + 1))];
    Ok(sorted.iter().enumerate().flat_map(step).collect())
}

/// The line of no difference, where zero lies within.
fn zero(panel: &mut Panel) {
    if panel.x.low <= 0.0 && 0.0 <= panel.x.high && panel.x.low < panel.x.high {
        let [low, high] = [f64::NEG_INFINITY, f64::INFINITY].map(|y| at(0.0, y));
        panel.segment(low, high, Style::line(ZERO).class("zero"));
    }
}

/// Of a lone series the marked quantiles run through both panels.
fn quantile_lines(panel: &mut Panel, series: &[Drawn]) {
    if let [s] = series {
        for p in marked(s.confidence) {
            panel.upright(s.summary.quantile(p), GUIDE);
        }
    }
}

/// The answer in one sentence, for one series of differences.
fn headline(series: &[Drawn], differences: bool) -> String {
    match series {
        [s] if differences && s.above.n > 0 => format!("Above zero in {}.", above(&s.above)),
        _ => String::new(),
    }
}

/// "934 of 1000 pairs: 93.4 % (91.7 to 94.9 %)".
fn above(share: &Share) -> String {
    let (k, n) = (share.k, share.n);
    let [low, high] = share.interval.unwrap_or([0.0, 1.0]).map(percent);
    if n < FEW {
        return format!("{k} of {n} pairs ({low} to {high}\u{a0}%)");
    }
    let own = percent(share.share);
    format!("{k} of {n} pairs: {own}\u{a0}% ({low} to {high}\u{a0}%)")
}

fn notes(shown: &Shown, all: usize, series: &[Drawn], differences: bool) -> Vec<String> {
    let spread = |s: &Drawn| s.summary.quantile(0.975) - s.summary.quantile(0.025);
    let spreads = series.iter().map(spread).filter(|w| *w > 0.0);
    let spread = spreads.fold(f64::NAN, f64::min);
    let unit = shown.after();
    let digits = |x: f64| value(x, spread);
    let one = |s: &Drawn| {
        if s.summary.n == 0 {
            return format!("{}: no values, {} missing.", s.name, s.summary.missing);
        }
        let [low, median, high] = marked(s.confidence).map(|p| digits(s.summary.quantile(p)));
        let mut text = format!(
            "{}: median {median}{unit}, {}\u{a0}% within {low} to {high}",
            s.name,
            s.confidence.draws_percent()
        );
        if let Some([low, high]) = s.summary.mean_interval {
            let [mean, low, high] = [s.summary.mean, low, high].map(digits);
            text += &format!("; mean {mean} ({low} to {high})");
        }
        if differences && series.len() > 1 && s.above.n > 0 {
            text += &format!("; above zero in {}", above(&s.above));
        }
        text += &format!("; n\u{a0}=\u{a0}{}", s.summary.n);
        if s.summary.missing > 0 {
            text += &format!(", {} missing", s.summary.missing);
        }
        text + "."
    };
    let mut notes: Vec<String> = series.iter().map(one).collect();
    if all > series.len() {
        let more = all - series.len();
        notes.push(format!("{more} more are not drawn."));
    }
    notes
}
