//! Fuel of several runs side by side.

use super::PlotRun;
use crate::charts::engine::{
    Axis, Block, Chart, Cut, Entry, Fill, Label, PLOT_LEFT, Panel, Rect, Style, at, optional_cell,
    row_middle, rows_panel, text_width,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{list_of, phase};
use cvtcycle_analysis::words::{more_or_less, than};
use cvtcycle_output::table::distinct;

const TOP: f64 = 58.0;
const TALL: f64 = 340.0;
/// Minimum and maximum width of the plot: room for names, and the width of a page.
const WIDTHS: (f64, f64) = (660.0, 786.0);
const LABEL: f64 = 11.0;
/// Width below which bars have their values in the table only, pixels.
const TURNED: f64 = 15.0;
/// Height of a row of the picture for a narrow screen besides its name, pixels: forty cars of a cycle with two parts are less than 4000 px.
const PITCH: f64 = 17.0;
/// Empty share of a group's width.
const GAP: f64 = 0.28;

/// Fuel by phase group and in total, one bar per vehicle.
pub fn fuel_bars(runs: &[PlotRun]) -> Picture {
    let groups = groups(runs);
    let bars = (groups.len() * runs.len()).max(1) as f64;
    // Wide enough for the values over the bars, up to the width of the page.
    let plot = (bars * 40.0 / (1.0 - GAP)).clamp(WIDTHS.0, WIDTHS.1);
    let x = Axis::bare(0.0, groups.len().max(1) as f64);
    let rect = Rect::new(PLOT_LEFT, TOP, plot, TALL);
    let mut panel = Panel::new(rect, x, axis(runs))
        .no_data(groups.is_empty())
        .x_labels(false)
        .below(34.0);
    let table = draw_groups(&mut panel, runs, &groups);
    let entry = |(i, run): (usize, &PlotRun)| Entry::fill(Fill::car(i), run.name);
    let entries = runs.iter().enumerate().map(entry).collect();
    let subject = match runs {
        [run] => run.name.to_owned(),
        _ => format!("{} vehicles", runs.len()),
    };
    let chart = Chart::new(title(runs), &subject, PLOT_LEFT)
        .width(PLOT_LEFT + plot + 20.0)
        .panels([panel])
        .foot(Block::legend((PLOT_LEFT, plot), "Vehicle", entries));
    // Without any group there is no row: the plot says that it has no data.
    let chart = match groups.is_empty() {
        true => chart,
        false => {
            chart.narrow(Chart::new(title(runs), subject, PLOT_LEFT).panels(rows(runs, &groups)))
        }
    };
    chart.picture(table)
}

/// Adds the bars of all groups; returns their values.
fn draw_groups(panel: &mut Panel, runs: &[PlotRun], groups: &[String]) -> PictureTable {
    let names = [("Part of the cycle", ""), ("Vehicle", "")];
    let mut table = PictureTable::new(&[&names[..], &[("Fuel", unit(runs))]].concat());
    let width = (1.0 - GAP) / runs.len().max(1) as f64;
    let headline = headline(groups);
    for (g, group) in groups.iter().enumerate() {
        for (i, run) in runs.iter().enumerate() {
            let from = g as f64 + 0.5 * GAP + i as f64 * width;
            let value = value_of(run, group);
            let number = optional_cell(value, 0.01);
            let row = table.push([group.clone(), run.name.to_owned(), number]);
            if let Some(value) = value {
                let style = Style::edged(Fill::car(i), 0.75).class("bar");
                bar(panel, (from, from + width), value, style.row(row));
            }
        }
        let place = at(g as f64 + 0.5, f64::NEG_INFINITY).shift(0.0, 20.0);
        let room = panel.px(1.0) - panel.px(0.0) - 6.0;
        let name = Label::new(place, phase(group)).size(12.0).middle();
        panel.label(name.bold(group == headline).cut(Cut::End, room));
    }
    table
}

/// A panel of horizontal bars for each group, which fit on a narrow screen; marks have the rows of the table of [`draw_groups`].
fn rows(runs: &[PlotRun], groups: &[String]) -> Vec<Panel> {
    let panel = |(g, group): (usize, &String)| {
        let mut panel = rows_panel((PLOT_LEFT, TOP), WIDTHS.0, runs.len(), PITCH, axis(runs))
            .heading(phase(group))
            .x_labels(g + 1 == groups.len());
        for (i, run) in runs.iter().enumerate() {
            let value = value_of(run, group);
            let name = Label::new(at(0.0, 0.0), run.name).bold(group == headline(groups));
            panel.row_name(i, name);
            if let Some(value) = value {
                let style = Style::edged(Fill::car(i), 0.75).row(g * runs.len() + i);
                panel.bar(i, (0.0, value), (-6.0, 6.0), style);
                let end = at(value, row_middle(i)).shift(6.0, 4.0);
                panel.label(Label::new(end, format!("{value:.2}")));
            }
        }
        panel
    };
    groups.iter().enumerate().map(panel).collect()
}

/// Headline group: weighted where the cycle is, else the whole cycle.
fn headline(groups: &[String]) -> &str {
    let mut names = ["weighted", "total"].into_iter();
    let there = |name: &&str| groups.iter().any(|group| group == name);
    names.find(there).unwrap_or("total")
}

/// Title: fuel of the first car, and its difference to the others.
fn title(runs: &[PlotRun]) -> String {
    let name = headline(&groups(runs)).to_owned();
    let Some((first, own)) = runs
        .first()
        .and_then(|run| Some((run, value_of(run, &name)?)))
    else {
        return "Fuel consumption".to_owned();
    };
    let weighted = if name == "weighted" {
        " (weighted)"
    } else {
        ""
    };
    let other = |run: &PlotRun| {
        let compared = more_or_less(100.0 * (own / value_of(run, &name)? - 1.0), 1);
        Some(format!("{compared} {} {}", than(&compared), run.name))
    };
    let others: Vec<String> = runs[1..].iter().take(NAMED).filter_map(other).collect();
    let rest = if others.is_empty() {
        String::new()
    } else {
        format!(": {}", list_of(&others))
    };
    format!(
        "{} uses {own:.2} {}{weighted}{rest}",
        first.name,
        unit(runs)
    )
}

/// Number of other cars named in the title.
const NAMED: usize = 2;

/// Axis from zero, with room for the values over the highest bar.
fn axis(runs: &[PlotRun]) -> Axis {
    let groups = runs.iter().flat_map(|run| &run.group_fuel);
    let values = groups.map(|(_, fuel)| *fuel);
    let highest = values.filter(|x| x.is_finite()).fold(0.0, f64::max);
    let title = format!("Fuel [{}]", unit(runs));
    Axis::round(&title, [0.0, 1.12 * highest].into_iter(), 8)
}

/// Unit of the fuel of the first car, which is that of all on the same cycle.
fn unit(runs: &[PlotRun]) -> &'static str {
    runs.first().map_or("L/100 km", |run| run.fuel_unit)
}

fn bar(panel: &mut Panel, (from, to): (f64, f64), value: f64, style: Style) {
    panel.rectangle(at(from, value), at(to, f64::NEG_INFINITY), style);
    let wide = panel.px(to) - panel.px(from);
    let (text, top) = (format!("{value:.2}"), at(0.5 * (from + to), value));
    if text_width(&text, LABEL) < wide {
        panel.label(Label::new(top.shift(0.0, -4.0), text).middle());
    } else if wide >= TURNED {
        // Turned if the bars are thinner than their values are wide.
        panel.label(Label::new(top.shift(3.5, -4.0), text).turned());
    }
}

/// Finite and non-negative fuel; `None` draws no bar.
fn value_of(run: &PlotRun, group: &str) -> Option<f64> {
    let (_, fuel) = run.group_fuel.iter().find(|(name, _)| name == group)?;
    (fuel.is_finite() && *fuel >= 0.0).then_some(*fuel)
}

/// The groups of all runs in the order of their first mention, the total last.
fn groups(runs: &[PlotRun]) -> Vec<String> {
    let names = runs.iter().flat_map(|run| &run.group_fuel);
    let mut groups = distinct(names.map(|(name, _)| name.clone()));
    groups.sort_by_key(|name| name == "total");
    groups
}
