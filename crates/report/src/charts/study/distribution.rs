//! Distribution of an output, or of a difference of pairs: a dot for each equal share of the runs.

use super::{MARGIN, RIGHT, Shown, WIDE_FOOT, percent, value};
use crate::charts::engine::{
    Axis, Chart, Cut, Entry, Fill, INK, Label, PUBLISHED, Panel, STROKES, Style, Symbol, at, cell,
    round_step, row_middle, rows_left, rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital_first, grouped};
use cvtcycle_study::statistics::{Confidence, Numbers, Share, Summary, quantiles};

/// One car, or one pair of cars.
#[derive(Clone, Copy, Debug)]
pub struct DistributionSeries<'a, P: ?Sized = [f64]> {
    /// Name of its row.
    pub name: &'a str,
    /// Values; missing if not finite.
    pub values: &'a P,
    /// Numbers known independently of the values.
    pub known: KnownValue,
}

/// Numbers of the same quantity from other sources than the values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct KnownValue {
    /// Result with the nominal values, those of the files.
    pub nominal: Option<f64>,
    /// A published range.
    pub published: Option<[f64; 2]>,
}

/// A series prepared for drawing.
struct Drawn<'a> {
    name: &'a str,
    known: KnownValue,
    /// Quantiles at the middles of equal shares, ascending.
    dots: Vec<f64>,
    summary: Summary,
    above: Share,
    confidence: Confidence,
}

impl Drawn<'_> {
    /// Median and the two ends of the confidence.
    fn marked(&self) -> [f64; 3] {
        let [low, high] = self.confidence.ends();
        [low, 0.5, high].map(|p| self.summary.quantile(p))
    }

    /// All numbers that must lie on the axis.
    fn seen(&self) -> Vec<f64> {
        let known = self.known.published.into_iter().flatten();
        let known = known.chain(self.known.nominal);
        known.chain(self.dots.iter().copied()).collect()
    }
}

const TOP: f64 = 58.0;
/// Height of the row of a lone series, and of one of several, pixels.
const ROWS: [f64; 2] = [150.0, 110.0];
/// Maximum number of dots of a series: each is a hundredth of its runs.
const DOTS: usize = 100;
/// Maximum number of stacks of dots over the width of the plot.
const STACKS: f64 = 55.0;
/// Maximum radius of a dot, and of a mark on the base line, pixels.
const DOT: f64 = 5.0;
const MARK: f64 = 5.5;
/// Number of pairs below which only counts are given.
const FEW: usize = 200;
/// Maximum number of series described in the picture in words.
const IN_WORDS: usize = 2;

/// Draws the values of each series as dots of equal shares of the runs, stacked where they coincide, over an interval with the median and the
/// two ends of its confidence; of more than seven series the first seven. For differences of pairs the part below zero is shaded and labelled
/// with its share.
///
/// # Errors
/// The values cannot be read.
pub fn distribution_plot<P: Numbers + ?Sized>(
    shown: &Shown,
    all: &[DistributionSeries<P>],
    differences: bool,
) -> Result<Picture, P::Error> {
    let drawn = &all[..all.len().min(STROKES.len())];
    let series = drawn.iter().map(|series| prepare(series, shown.confidence));
    let series: Vec<Drawn> = series.collect::<Result<_, _>>()?;
    Ok(drawing(shown, all.len(), &series, differences))
}

fn drawing(shown: &Shown, all: usize, series: &[Drawn], differences: bool) -> Picture {
    let notes = notes(shown, all, series, differences);
    let output = match differences {
        true => format!("Difference: {}", shown.output),
        false => capital_first(shown.output),
    };
    let zero = differences.then_some(0.0);
    let values = series.iter().flat_map(Drawn::seen).chain(zero);
    let left = rows_left(series.iter().map(|s| s.name), 11.0);
    let title = Cut::Middle.apply(&output, 12.0, RIGHT - left - 90.0);
    let x = Axis::round(&shown.axis(&title), values, 9);
    let tall = ROWS[usize::from(series.len() > 1)];
    let panel = rows_panel((left, TOP), RIGHT, series.len().max(1), tall, x);
    let mut panel = panel.no_data(series.iter().all(|s| s.dots.is_empty()));
    if differences && !panel.no_data && panel.x.low < 0.0 {
        let below = Style::colour(INK).fill_opacity(0.07).class("below");
        let (low, high) = (at(panel.x.low, f64::NEG_INFINITY), at(0.0, f64::INFINITY));
        panel.rectangle(low, high, below);
    }
    if differences && !panel.no_data {
        panel.upright(0.0, stroke(INK, 1.2, &[]));
    }
    let radius = radius(&panel, series, tall);
    let mut table = table(shown, &notes);
    for (k, s) in series.iter().enumerate() {
        panel.row_name(k, Label::new(at(0.0, 0.0), s.name).class("row"));
        dots(&mut panel, &mut table, (k, s), (tall, radius));
    }
    let lead = notes[..notes.len().min(IN_WORDS)].join(" ");
    Chart::new(sentence(shown, series, differences), shown.subject, MARGIN)
        .lead(lead.replace('\u{a0}', " "))
        .panels([panel])
        .legend(WIDE_FOOT, legend(series, differences))
        .notes(WIDE_FOOT, notes)
        .picture(table)
}

fn legend(series: &[Drawn], differences: bool) -> Vec<Entry> {
    let dots = series.iter().map(|s| s.dots.len()).max().unwrap_or(0);
    let all = series.iter().map(|s| s.summary.n).max().unwrap_or(0);
    let each = match dots {
        _ if dots == all => "one run".to_owned(),
        dots => format!("1/{dots} of the runs"),
    };
    let colour = Style::colour(STROKES[DOTTED].colour);
    let level = series
        .first()
        .map_or(Confidence::default(), |s| s.confidence);
    let of_known = |wanted: fn(&KnownValue) -> bool| series.iter().any(|s| wanted(&s.known));
    let list = [
        Some(Entry::symbol(Symbol::CIRCLE, colour, each)),
        Some(Entry::line(
            stroke(INK, 1.25, &[]),
            format!("{} % of the runs, and their median", level.draws_percent()),
        )),
        differences.then(|| {
            let below = Fill::plain("#ededed");
            Entry::fill(below, "less fuel")
        }),
        of_known(|known| known.nominal.is_some())
            .then(|| Entry::symbol(Symbol::CIRCLE, Style::colour(INK), "nominal values")),
        of_known(|known| known.published.is_some())
            .then(|| Entry::symbol(Symbol::DIAMOND, Symbol::white(PUBLISHED), "published")),
    ];
    list.into_iter().flatten().collect()
}

/// Index of the line style with the colour of dots.
const DOTTED: usize = 2;

/// Stacks of coinciding dots, with their positions on the axis.
fn stacks<'a>(x: &Axis, dots: &'a [f64]) -> impl Iterator<Item = (f64, &'a [f64])> {
    let (low, step) = (x.low, (x.high - x.low) / STACKS);
    let place = move |x: f64| ((x - low) / step).floor();
    let together = dots.chunk_by(move |a, b| place(*a).total_cmp(&place(*b)).is_eq());
    together.map(move |stack| (low + (place(stack[0]) + 0.5) * step, stack))
}

/// Maximum radius at which the highest stack fits in its row, pixels.
fn radius(panel: &Panel, series: &[Drawn], tall: f64) -> f64 {
    let all = series.iter().flat_map(|s| stacks(&panel.x, &s.dots));
    let highest = all.map(|(_, stack)| stack.len()).max().unwrap_or(1);
    let room = tall - BELOW_DOTS - 8.0;
    let wide = 0.5 * panel.rect.width() / STACKS;
    (0.5 * room / highest as f64).min(wide).min(DOT)
}

/// Height of the base line of the dots over the lower end of their row, pixels.
const BELOW_DOTS: f64 = 30.0;

/// Adds the dots of a series, its interval and its known numbers, each with its row of the table.
fn dots(
    panel: &mut Panel,
    table: &mut PictureTable,
    (row, s): (usize, &Drawn),
    (tall, radius): (f64, f64),
) {
    let base = 0.5 * tall - BELOW_DOTS;
    let step = round_step(((panel.x.high - panel.x.low) / 500.0).max(1e-12));
    let dots = s.dots.len() as f64;
    let (x, mut placed) = (panel.x.clone(), 0);
    for (middle, stack) in stacks(&x, &s.dots) {
        for (level, x) in stack.iter().enumerate() {
            placed += 1;
            let share = 100.0 * (f64::from(placed) - 0.5) / dots;
            let cells = [s.name.to_owned(), cell(share, 0.1), cell(*x, step)];
            let style = Style::colour(STROKES[DOTTED].colour).class("dot");
            let down = base - radius - 2.0 * radius * level as f64;
            let place = at(middle, row_middle(row)).shift(0.0, down);
            let own = table.push(cells);
            panel.symbol(Symbol::CIRCLE, place, 0.92 * radius, style.row(own));
        }
    }
    if s.dots.is_empty() {
        return;
    }
    let mut add =
        |what: &str, x: f64| table.push([s.name.to_owned(), what.to_owned(), cell(x, step)]);
    let down = base + 12.0;
    let on_base = |x: f64| at(x, row_middle(row)).shift(0.0, down);
    let [low, median, high] = s.marked();
    let own = add("median", median);
    panel.whisker(row, [low, high], down, own);
    let style = Symbol::white(INK).class("mark").row(own);
    panel.symbol(Symbol::CIRCLE, on_base(median), MARK - 1.0, style);
    if let Some([low, high]) = s.known.published {
        let middle = 0.5 * (low + high);
        let own = add("published", middle);
        let style = Symbol::white(PUBLISHED).class("printed").row(own);
        panel.symbol(Symbol::DIAMOND, on_base(middle), MARK, style);
    }
    if let Some(x) = s.known.nominal {
        let own = add("nominal values", x);
        let style = Style::colour(INK).edge(stroke("#ffffff", 1.0, &[]));
        panel.symbol(
            Symbol::CIRCLE,
            on_base(x),
            MARK,
            style.class("mark").row(own),
        );
    }
}

/// Title: a sentence on a lone series, else a description.
fn sentence(shown: &Shown, series: &[Drawn], differences: bool) -> String {
    match series {
        [s, ..] if differences && s.above.n > 0 => {
            let of = match series.len() {
                1 => String::new(),
                _ => format!(", {}", s.name),
            };
            format!(
                "{}{of} is above zero in {}",
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
        _ => format!("Distribution: {}", shown.output),
    }
}

fn table(shown: &Shown, notes: &[String]) -> PictureTable {
    let columns = [
        ("Runs".to_owned(), ""),
        ("Share below, or what".to_owned(), ""),
        shown.column("Value"),
    ];
    let note = notes.join(" ").replace('\u{a0}', " ");
    PictureTable::with_columns(columns).note(note)
}

fn prepare<'a, P: Numbers + ?Sized>(
    series: &DistributionSeries<'a, P>,
    confidence: Confidence,
) -> Result<Drawn<'a>, P::Error> {
    let summary = Summary::over(series.values, confidence)?;
    let count = summary.n.min(DOTS);
    let middle = |k: usize| (k as f64 + 0.5) / count as f64;
    let shares: Vec<f64> = (0..count).map(middle).collect();
    Ok(Drawn {
        name: series.name,
        known: series.known,
        dots: quantiles(series.values, &summary, &shares)?,
        above: Share::over_zero(series.values, Some(confidence))?,
        summary,
        confidence,
    })
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
        let [low, median, high] = s.marked().map(digits);
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
        if let Some(x) = s.known.nominal {
            text += &format!("; nominal values {}", digits(x));
        }
        if let Some([low, high]) = s.known.published {
            text += &format!("; published {}", grouped(0.5 * (low + high), 0));
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
