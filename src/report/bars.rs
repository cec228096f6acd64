//! Fuel of several runs side by side.
use super::PlotRun;
use super::axis::Axis;
use super::figure::{Anchor, Figure, INK, Rect, fit, text_width};
use super::legend::{ENTRY, Mark, height, legend};
use super::panel::{LEFT, Panel};
use super::style::fill;

const TOP: f64 = 58.0;
const TALL: f64 = 340.0;
const PLOT_LEFT: f64 = LEFT + 8.0;
const STRIP: f64 = 250.0;
const LABEL: f64 = 10.0;
/// Width of a group's share that stays empty.
const GAP: f64 = 0.28;

/// Fuel in L/100 km by phase group and in total, one bar per vehicle.
#[must_use]
pub fn fuel_bars(runs: &[PlotRun]) -> String {
    let groups = groups(runs);
    let bars = (groups.len() * runs.len()).max(1) as f64;
    // Wide enough for the values over the bars, as long as that stays a picture and not a scroll.
    let plot = (bars * 36.0 / (1.0 - GAP)).clamp(420.0, 1300.0);
    let (right, bottom) = (PLOT_LEFT + plot, TOP + TALL);
    let names: Vec<String> = runs.iter().map(|run| run.name.to_string()).collect();
    let strip_end = TOP + ENTRY + height(&names, STRIP - 8.0) + 8.0;
    let size = (right + 16.0 + STRIP, (bottom + 40.0).max(strip_end));
    let subject = match runs {
        [run] => run.name.to_string(),
        _ => format!("{} vehicles", runs.len()),
    };
    let mut figure = Figure::new(size, PLOT_LEFT, "Fuel consumption", &subject, &describe(runs));
    let rect = Rect { left: PLOT_LEFT, right, top: TOP, bottom };
    let y = axis(runs);
    let mut x = Axis::exact("", 0.0, groups.len().max(1) as f64, 5);
    // Groups have names in place of numbers; these are written below.
    x.ticks.clear();
    let panel = Panel::draw(&mut figure, rect, x, y, false);
    let paints: Vec<String> = (0..runs.len()).map(|i| fill(&mut figure, "fuel", i, runs.len())).collect();
    draw_groups(&mut figure, &panel, runs, &groups, &paints);
    if groups.is_empty() {
        panel.empty(&mut figure);
    }
    panel.outline(&mut figure);
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(names).collect();
    legend(&mut figure, (right + 16.0, TOP), STRIP - 8.0, "Vehicle", &entries);
    figure.finish()
}

fn draw_groups(figure: &mut Figure, panel: &Panel, runs: &[PlotRun], groups: &[String], paints: &[String]) {
    let width = (1.0 - GAP) / runs.len().max(1) as f64;
    for (g, group) in groups.iter().enumerate() {
        for (i, (run, paint)) in runs.iter().zip(paints).enumerate() {
            let from = g as f64 + 0.5 * GAP + i as f64 * width;
            if let Some(value) = value_of(run, group) {
                bar(figure, panel, (from, from + width), value, paint);
            }
        }
        let middle = panel.px(g as f64 + 0.5);
        let room = panel.px(1.0) - panel.px(0.0) - 6.0;
        let name = fit(group, 12.0, room);
        let weight = if group == "total" { "font-weight=\"bold\"" } else { "" };
        let at = (middle, panel.rect.bottom + 20.0);
        figure.text(at, 12.0, Anchor::Middle, weight, INK, &name);
    }
}

/// From zero, with room for the values over the highest bar.
fn axis(runs: &[PlotRun]) -> Axis {
    let values = || runs.iter().flat_map(|run| run.group_fuel.iter().map(|(_, fuel)| *fuel));
    let highest = values().filter(|x| x.is_finite()).fold(0.0, f64::max);
    Axis::round("Fuel [L/100 km]", [0.0, 1.12 * highest].into_iter(), 8)
}

fn bar(figure: &mut Figure, panel: &Panel, (from, to): (f64, f64), value: f64, paint: &str) {
    let (left, right, top) = (panel.px(from), panel.px(to), panel.py(value));
    let rect = Rect { left, right, top, bottom: panel.rect.bottom };
    let attributes = format!("class=\"bar\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"3\"");
    figure.rect(rect, &attributes);
    let text = format!("{value:.2}");
    let middle = 0.5 * (left + right);
    if text_width(&text, LABEL) < right - left + 2.0 {
        figure.text((middle, top - 4.0), LABEL, Anchor::Middle, "", INK, &text);
    } else {
        // Upright where the bars are thinner than their values are wide.
        let (x, y) = (super::figure::units(middle + 3.5), super::figure::units(top - 4.0));
        let turn = format!("transform=\"rotate(-90 {x} {y})\"");
        figure.text((middle + 3.5, top - 4.0), LABEL, Anchor::Start, &turn, INK, &text);
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
            let fuel: Vec<String> = run.group_fuel.iter().map(|(name, fuel)| format!("{name} {fuel:.2}")).collect();
            format!("{}: {}", run.name, fuel.join(", "))
        })
        .collect();
    format!("Fuel in L/100 km by part of the cycle, one bar per vehicle. {}.", told.join("; "))
}
