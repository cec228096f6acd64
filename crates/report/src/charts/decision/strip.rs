//! Confidence in the difference to each baseline: nominal values (those of the files), range of the draws, published number.

use super::{MARGIN, TOP, says};
use crate::charts::engine::{
    Axis, Chart, Entry, Fill, INK, Label, PUBLISHED, QUIET, Style, Symbol, WIDTH, at,
    optional_cell, row_middle, rows_left, rows_panel, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_analysis::words::decimals;

/// Right edge of the plot with room for the numbers in words, height of a row, pixels.
const RIGHT: f64 = WIDTH - 240.0;
const ROW: f64 = 30.0;
/// Half of the height of a bar, radius of a mark, pixels.
const HALF: f64 = 6.0;
const RADIUS: f64 = 5.5;

/// The difference to one baseline, per cent of its fuel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Against {
    /// Name of the baseline.
    pub baseline: String,
    /// Full name of that car.
    pub title: String,
    /// Difference with the nominal values, those of the files.
    pub files: Option<f64>,
    /// 5 %, 50 % and 95 % of the draws.
    pub drawn: Option<[f64; 3]>,
    /// True if these are of measured cars, not of draws: 90 % of such cars, about the difference with the nominal values.
    pub is_by_cars: bool,
    /// A published range that contradicts it.
    pub published: Option<[f64; 2]>,
}

impl Against {
    fn interval(&self) -> Option<[f64; 2]> {
        self.drawn.map(|[low, _, high]| [low, high])
    }
}

/// A row for each baseline; `conditions` are cycle and temperatures in words.
pub fn answer_strip(subject: &str, conditions: &str, rows: &[Against]) -> Picture {
    let values = rows.iter().flat_map(|row| {
        let drawn = row.drawn.into_iter().flatten();
        let published = row.published.into_iter().flatten();
        row.files.into_iter().chain(drawn).chain(published)
    });
    let x = Axis::round(
        &format!("Fuel of {subject} against each car [%]"),
        values.chain([0.0]),
        8,
    );
    let left = rows_left(rows.iter().map(|row| row.baseline.as_str()), 12.0);
    let panel = rows_panel((left, TOP), RIGHT, rows.len().max(1), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    let mut table = table();
    for (k, row) in rows.iter().enumerate() {
        let over = Label::new(at(0.0, 0.0), row.baseline.as_str());
        panel.row_name(k, over.size(12.0).class("row").row(k));
        let middle = |x: f64| at(x, row_middle(k));
        if let Some([low, median, high]) = row.drawn {
            let has_median = !row.is_by_cars;
            let style = Style::edged(Fill::car(usize::from(row.is_by_cars)), 0.5).row(k);
            panel.bar(k, (low, high), (-HALF, HALF), style);
            if has_median {
                panel.symbol(
                    Symbol::CIRCLE,
                    middle(median),
                    RADIUS - 1.0,
                    Symbol::white(INK).row(k),
                );
            }
        }
        if let Some([low, high]) = row.published {
            let line = Style::line(stroke(PUBLISHED, 2.0, &[])).row(k);
            panel.segment(middle(low), middle(high), line);
            let mark = middle(0.5 * (low + high));
            panel.symbol(
                Symbol::DIAMOND,
                mark,
                RADIUS,
                Symbol::white(PUBLISHED).row(k),
            );
        }
        if let Some(files) = row.files {
            panel.symbol(Symbol::CIRCLE, middle(files), RADIUS, nominal().row(k));
        }
        let words = Label::new(
            at(f64::INFINITY, row_middle(k)).shift(8.0, 4.0),
            in_words(row),
        );
        panel.label(words.size(11.0).colour(QUIET));
        table.push(cells(row));
    }
    panel.upright(0.0, stroke(INK, 1.2, &[]));
    let first = rows.first();
    let is_by_cars = first.is_some_and(|row| row.is_by_cars);
    let first = first.and_then(|row| Some((row.baseline.as_str(), row.files?, row.interval())));
    let has = |by_cars: bool| {
        rows.iter()
            .any(|row| row.drawn.is_some() && row.is_by_cars == by_cars)
    };
    let varied = match (has(false), has(true)) {
        (true, false) => "; bar: 90 %, uncertain inputs only",
        (false, true) => "; bar: 90 %, by the error of the model on measured cars",
        (true, true) => "; bars: two kinds of 90 % range",
        (false, false) => "",
    };
    Chart::new(
        says::strip(subject, first, is_by_cars),
        format!("{conditions}{varied}"),
        MARGIN,
    )
    .panels([panel])
    .legend((MARGIN, WIDTH - 2.0 * MARGIN), legend(rows))
    .notes((MARGIN, WIDTH - 2.0 * MARGIN), titles(rows))
    .picture(table)
}

/// Dark, with a pale edge that shows it on a bar.
fn nominal() -> Style {
    Style::colour(INK).edge(stroke("#ffffff", 1.0, &[]))
}

/// Lists the full names of baselines that differ from their names.
fn titles(rows: &[Against]) -> Vec<String> {
    let named = rows.iter().filter(|row| !row.title.is_empty());
    let named = named.filter(|row| row.title != row.baseline);
    let titles: Vec<String> = named
        .map(|row| format!("{}: {}.", row.baseline, row.title))
        .collect();
    (!titles.is_empty())
        .then(|| titles.join(" "))
        .into_iter()
        .collect()
}

fn legend(rows: &[Against]) -> Vec<Entry> {
    let mut list = vec![Entry::symbol(Symbol::CIRCLE, nominal(), "nominal values")];
    let drawn = |by_cars: bool| {
        rows.iter()
            .any(|row| row.drawn.is_some() && row.is_by_cars == by_cars)
    };
    if drawn(true) {
        list.push(Entry::fill(
            Fill::car(1),
            "error of the model on measured cars",
        ));
    }
    if drawn(false) {
        list.push(Entry::fill(Fill::car(0), "uncertain inputs only"));
        list.push(Entry::symbol(
            Symbol::CIRCLE,
            Symbol::white(INK),
            "median of these runs",
        ));
    }
    if rows.iter().any(|row| row.published.is_some()) {
        list.push(Entry::symbol(
            Symbol::DIAMOND,
            Symbol::white(PUBLISHED),
            "published, other sign or far off",
        ));
    }
    list
}

/// "+7 % (+1 to +10 %)", followed by the published number.
fn in_words(row: &Against) -> String {
    let digits = row.interval().map_or(1, decimals);
    let number = |x: f64, digits| cvtcycle_output::number::signed(x, digits);
    let mut text = row
        .files
        .map_or_else(String::new, |x| format!("{} %", number(x, digits)));
    if let Some(interval) = row.interval() {
        text += &format!(" ({})", says::level(interval));
    }
    if let Some([low, high]) = row.published {
        text += &format!(", published {} %", number(0.5 * (low + high), 0));
    }
    text
}

fn table() -> PictureTable {
    PictureTable::new(&[
        ("Against", ""),
        ("Nominal values", "%"),
        ("5 % below", "%"),
        ("Median", "%"),
        ("95 % below", "%"),
        ("Published from", "%"),
        ("to", "%"),
    ])
}

fn cells(row: &Against) -> Vec<String> {
    let median = |k| k == 1 && row.is_by_cars;
    let drawn = (0..3).map(|k| row.drawn.filter(|_| !median(k)).map(|of| of[k]));
    let published = (0..2).map(|k| row.published.map(|of| of[k]));
    let numbers = [row.files].into_iter().chain(drawn).chain(published);
    let cells = numbers.map(|x| optional_cell(x, 0.01));
    [row.baseline.clone()].into_iter().chain(cells).collect()
}
