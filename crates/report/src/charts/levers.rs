//! Savings of each lever of a car, as a strip of its draws.

use super::engine::{
    Axis, Chart, Entry, Fill, INK, Label, QUIET, Style, Symbol, WIDTH, at, optional_cell,
    row_middle, rows_left, rows_panel, stroke,
};
use super::picture::{Picture, PictureTable};
use crate::number::{capital_first, degc};
use cvtcycle_analysis::levers::{LeverAnswer, LeverBlock, LeverRow};

/// Right edge of the plot with room for the counts, left edge of blocks below it, height of a row, pixels.
const RIGHT: f64 = WIDTH - 96.0;
const MARGIN: f64 = 12.0;
const ROW: f64 = 20.0;
/// Half of the height of the bar of a range, radius of its median, pixels.
const HALF: f64 = 5.0;
const RADIUS: f64 = 4.5;
/// Number of levers of a combination named below the figure; tables list all.
const NAMED: usize = 3;
/// Names of the marks.
const MARKS: [&str; 2] = ["One change", "Changes together"];

/// Draws the range of the draws and their median for each lever of a car at one ambient temperature; combinations last.
pub fn lever_strip(answer: &LeverAnswer, block: &LeverBlock) -> Picture {
    strip(answer, block, &block.rows.iter().collect::<Vec<_>>())
}

/// As [`lever_strip`], for at most `max_shown` levers with the largest savings, and the combinations.
pub fn foremost_levers(answer: &LeverAnswer, block: &LeverBlock, max_shown: usize) -> Picture {
    let (together, single): (Vec<_>, Vec<_>) =
        block.rows.iter().partition(|row| row.is_combination());
    let single = single.into_iter().filter(|row| saves(row)).take(max_shown);
    strip(answer, block, &single.chain(together).collect::<Vec<_>>())
}

/// True if a lever works and saves fuel.
pub fn saves(row: &LeverRow) -> bool {
    !row.does_not_work() && row.fuel_percent.value < 0.0
}

/// Name of a lever; an unnamed combination is named by its number of levers.
pub fn lever_title(row: &LeverRow) -> String {
    match row.of.title.as_str() {
        "combination" => format!("combination of {} changes", row.of.members.len()),
        title => title.to_owned(),
    }
}

fn strip(answer: &LeverAnswer, block: &LeverBlock, rows: &[&LeverRow]) -> Picture {
    let ends = rows.iter().flat_map(|row| {
        let quantiles = [row.low_percent, row.fuel_percent, row.high_percent];
        quantiles.map(|q| q.value)
    });
    let ends = ends.filter(|x| x.is_finite()).chain([0.0]);
    let x = Axis::round("Change of the fuel [%]", ends, 8);
    let titles: Vec<String> = rows.iter().map(|row| lever_title(row)).collect();
    let left = rows_left(titles.iter().map(String::as_str), 11.0);
    let panel = rows_panel((left, 58.0), RIGHT, rows.len().max(2), ROW, x);
    let mut panel = panel.no_data(rows.is_empty());
    for (k, row) in rows.iter().enumerate() {
        let name = Label::new(at(0.0, 0.0), titles[k].as_str());
        panel.row_name(k, name.class("row").row(k));
        let fill = Fill::car(usize::from(row.is_combination()));
        if answer.plan.is_some() && row.n > 0 {
            let style = Style::edged(fill.clone(), 0.5).row(k);
            let range = (row.low_percent.value, row.high_percent.value);
            panel.bar(k, range, (-HALF, HALF), style);
        }
        let middle = at(row.fuel_percent.value, row_middle(k));
        panel.symbol(Symbol::CIRCLE, middle, RADIUS, Symbol::white(INK).row(k));
        let count = at(f64::INFINITY, row_middle(k)).shift(8.0, 4.0);
        panel.label(
            Label::new(count, counted(answer, row))
                .size(10.5)
                .colour(QUIET),
        );
    }
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let kinds = if rows.iter().any(|row| row.is_combination()) {
        2
    } else {
        1
    };
    let entry = |(k, name): (usize, &str)| Entry::fill(Fill::car(k), name);
    let foot = (MARGIN, WIDTH - 2.0 * MARGIN);
    let ambient = degc(block.ambient_degc);
    let subject = format!("Against {} as it is, ambient {ambient}", block.vehicle);
    let legend = MARKS.into_iter().take(kinds).enumerate().map(entry);
    Chart::new(title(block), subject, MARGIN)
        .panels([panel])
        .legend(foot, legend)
        .notes(foot, notes(answer, block, rows))
        .picture(table(answer, rows))
}

/// Title: the lever with the largest saving, and the largest combination.
fn title(block: &LeverBlock) -> String {
    let (together, mut single): (Vec<_>, Vec<_>) =
        (block.rows.iter().filter(|row| saves(row))).partition(|row| row.is_combination());
    single.truncate(1);
    let saved = |row: &LeverRow| -row.fuel_percent.value;
    let Some(best) = single.first() else {
        return "No change of the design saves fuel".to_owned();
    };
    let name = capital_first(&best.of.title);
    let alone = format!("{name} saves most: {:.1} % of the fuel", saved(best));
    match together.first() {
        None => alone,
        Some(all) => format!("{alone}; the combination of changes {:.1} %", saved(all)),
    }
}

fn notes(answer: &LeverAnswer, block: &LeverBlock, rows: &[&LeverRow]) -> Vec<String> {
    let marks = match answer.plan {
        None => "Points: the car as its file has it; nothing is varied.".to_owned(),
        Some(_) => format!(
            "Bars: {} % of {} runs, all uncertain values varied. Points: medians. Right: runs in which it saves fuel.",
            answer.confidence.draws_percent(),
            answer.draws_done
        ),
    };
    let together = rows.iter().filter(|row| row.is_combination());
    let together = together.map(|row| {
        let title = |name: &String| {
            let of = block.rows.iter().find(|other| other.of.name == *name);
            of.map_or_else(|| name.clone(), |other| other.of.title.clone())
        };
        let members: Vec<String> = row.of.members.iter().map(title).collect();
        let (shown, rest) = members.split_at(members.len().min(NAMED));
        let more = match rest.len() {
            0 => String::new(),
            n => format!("; and {n} more"),
        };
        let name = capital_first(&lever_title(row));
        format!("{name}: {}{more}.", shown.join("; "))
    });
    [marks].into_iter().chain(together).collect()
}

/// Counts the draws in which a lever saves.
fn counted(answer: &LeverAnswer, row: &LeverRow) -> String {
    match answer.plan {
        Some(_) if row.n == 0 => "no good run".to_owned(),
        Some(_) => format!("{} of {}", row.saves.k, row.saves.n),
        None if row.n == 0 => "no good run".to_owned(),
        None => String::new(),
    }
}

fn table(answer: &LeverAnswer, rows: &[&LeverRow]) -> PictureTable {
    let [low, high] = answer
        .confidence
        .ends()
        .map(|p| format!("{:.0} % of the runs below", 100.0 * p));
    let columns = [
        ("Change".to_owned(), ""),
        ("Median".to_owned(), "%"),
        (low, "%"),
        (high, "%"),
        ("Saves in".to_owned(), ""),
    ];
    let mut table = PictureTable::with_columns(columns);
    for row in rows {
        let of = |value: f64| optional_cell(Some(value).filter(|x| x.is_finite()), 0.01);
        let ends = match answer.plan {
            Some(_) => [row.low_percent, row.high_percent].map(|q| of(q.value)),
            None => [of(f64::NAN), of(f64::NAN)],
        };
        let cells = [lever_title(row), of(row.fuel_percent.value)];
        table.push(cells.into_iter().chain(ends).chain([counted(answer, row)]));
    }
    table
}
