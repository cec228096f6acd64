//! Fuel of several runs side by side.
use super::axis::Axis;
use super::figure::{Anchor, Figure, INK, Rect, fit, text_width};
use super::legend::{Mark, below_height, legend_below};
use super::panel::{LEFT, Panel};
use super::style::fill;
use super::{Picture, PictureTable, PlotRun, cell};

const TOP: f64 = 58.0;
const TALL: f64 = 340.0;
const PLOT_LEFT: f64 = LEFT + 8.0;
/// Widths of the plot: room for names, and no more than fits on a page.
const WIDTHS: (f64, f64) = (480.0, 786.0);
const LABEL: f64 = 11.0;
/// Bars thinner than this have their values in the table alone.
const UPRIGHT: f64 = 15.0;
/// Width of a group's share that stays empty.
const GAP: f64 = 0.28;

/// Fuel in L/100 km by phase group and in total, one bar per vehicle.
#[must_use]
pub fn fuel_bars(runs: &[PlotRun]) -> Picture {
    let groups = groups(runs);
    let bars = (groups.len() * runs.len()).max(1) as f64;
    // Wide enough for the values over the bars, as long as the page is.
    let plot = (bars * 40.0 / (1.0 - GAP)).clamp(WIDTHS.0, WIDTHS.1);
    let (right, bottom) = (PLOT_LEFT + plot, TOP + TALL);
    let names: Vec<String> = runs.iter().map(|run| run.name.to_string()).collect();
    let below = below_height(names.iter().map(String::as_str), plot, "Vehicle");
    let size = (right + 20.0, bottom + 40.0 + below);
    let subject = match runs {
        [run] => run.name.to_string(),
        _ => format!("{} vehicles", runs.len()),
    };
    let mut figure = Figure::new(
        size,
        PLOT_LEFT,
        "Fuel consumption",
        &subject,
        &describe(runs),
    );
    let rect = Rect {
        left: PLOT_LEFT,
        right,
        top: TOP,
        bottom,
    };
    let y = axis(runs);
    let mut x = Axis::exact("", 0.0, groups.len().max(1) as f64, 5);
    // Groups have names in place of numbers; these are written below.
    x.ticks.clear();
    let panel = Panel::draw(&mut figure, rect, x, y, false);
    let paints: Vec<String> = (0..runs.len())
        .map(|i| fill(&mut figure, "fuel", i, runs.len()))
        .collect();
    let table = draw_groups(&mut figure, &panel, runs, &groups, &paints);
    if groups.is_empty() {
        panel.empty(&mut figure);
    }
    panel.outline(&mut figure);
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(names).collect();
    legend_below(
        &mut figure,
        (PLOT_LEFT, bottom + 34.0),
        plot,
        "Vehicle",
        &entries,
    );
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// Draws the bars of all groups; returns their values.
fn draw_groups(
    figure: &mut Figure,
    panel: &Panel,
    runs: &[PlotRun],
    groups: &[String],
    paints: &[String],
) -> PictureTable {
    let mut table = PictureTable::new(&[
        ("Part of the cycle", ""),
        ("Vehicle", ""),
        ("Fuel", "L/100 km"),
    ]);
    let width = (1.0 - GAP) / runs.len().max(1) as f64;
    for (g, group) in groups.iter().enumerate() {
        for (i, (run, paint)) in runs.iter().zip(paints).enumerate() {
            let from = g as f64 + 0.5 * GAP + i as f64 * width;
            let value = value_of(run, group);
            let row = table.push(vec![
                group.clone(),
                run.name.to_owned(),
                cell(value.unwrap_or(f64::NAN), 0.01),
            ]);
            if let Some(value) = value {
                bar(figure, panel, (from, from + width), value, (paint, row));
            }
        }
        let middle = panel.px(g as f64 + 0.5);
        let room = panel.px(1.0) - panel.px(0.0) - 6.0;
        let name = fit(group, 12.0, room);
        let weight = if group == "total" {
            "font-weight=\"bold\""
        } else {
            ""
        };
        let at = (middle, panel.rect.bottom + 20.0);
        figure.text(at, 12.0, Anchor::Middle, weight, INK, &name);
    }
    table
}

/// From zero, with room for the values over the highest bar.
fn axis(runs: &[PlotRun]) -> Axis {
    let values = || {
        runs.iter()
            .flat_map(|run| run.group_fuel.iter().map(|(_, fuel)| *fuel))
    };
    let highest = values().filter(|x| x.is_finite()).fold(0.0, f64::max);
    Axis::round("Fuel [L/100 km]", [0.0, 1.12 * highest].into_iter(), 8)
}

fn bar(
    figure: &mut Figure,
    panel: &Panel,
    (from, to): (f64, f64),
    value: f64,
    (paint, row): (&str, usize),
) {
    let (left, right, top) = (panel.px(from), panel.px(to), panel.py(value));
    let rect = Rect {
        left,
        right,
        top,
        bottom: panel.rect.bottom,
    };
    let attributes = format!(
        "class=\"bar\" data-row=\"{row}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"3\""
    );
    figure.rect(rect, &attributes);
    let text = format!("{value:.2}");
    let middle = 0.5 * (left + right);
    if text_width(&text, LABEL) < right - left {
        figure.text((middle, top - 4.0), LABEL, Anchor::Middle, "", INK, &text);
    } else if right - left >= UPRIGHT {
        // Upright where the bars are thinner than their values are wide.
        let (x, y) = (
            super::figure::units(middle + 3.5),
            super::figure::units(top - 4.0),
        );
        let turn = format!("transform=\"rotate(-90 {x} {y})\"");
        figure.text(
            (middle + 3.5, top - 4.0),
            LABEL,
            Anchor::Start,
            &turn,
            INK,
            &text,
        );
    }
}

/// Finite and not negative, or there is no bar.
fn value_of(run: &PlotRun, group: &str) -> Option<f64> {
    let (_, fuel) = run.group_fuel.iter().find(|(name, _)| name == group)?;
    (fuel.is_finite() && *fuel >= 0.0).then_some(*fuel)
}

/// The groups of all runs in the order of their first mention, the total last.
fn groups(runs: &[PlotRun]) -> Vec<String> {
    let mut groups: Vec<String> = Vec::new();
    for (name, _) in runs.iter().flat_map(|run| &run.group_fuel) {
        if !groups.contains(name) {
            groups.push(name.clone());
        }
    }
    groups.sort_by_key(|name| name == "total");
    groups
}

fn describe(runs: &[PlotRun]) -> String {
    let told: Vec<String> = runs
        .iter()
        .map(|run| {
            let fuel: Vec<String> = run
                .group_fuel
                .iter()
                .map(|(name, fuel)| format!("{name} {fuel:.2}"))
                .collect();
            format!("{}: {}", run.name, fuel.join(", "))
        })
        .collect();
    format!(
        "Fuel in L/100 km by part of the cycle, one bar per vehicle. {}.",
        told.join("; ")
    )
}
