//! Plots over time.
use super::PlotRun;
use super::axis::{Axis, number, range};
use super::figure::{Anchor, Figure, INK, QUIET, Rect, fit, text_width};
use super::legend::{Mark, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::{CONTEXT, PLAIN, PRESSURES, STROKES, Stroke};
use crate::results::Row;
use crate::results::columns::column;

const WIDTH: f64 = 900.0;
/// Left edge of the plots.
pub(super) const PLOT_LEFT: f64 = LEFT + 8.0;
/// Upper edge of the first panel: below the heading and the names of the phases.
pub(super) const PLOT_TOP: f64 = 70.0;
const GAP: f64 = 16.0;
const STRIP: f64 = 200.0;

type Points = Vec<(f64, f64)>;
/// Title, line and data.
type Series = (&'static str, Stroke, Points);

/// Vehicle speed, ratio or gear, and engine speed over time.
#[must_use]
pub fn driveline(run: &PlotRun) -> String {
    let ratio = if run.cvt { ("belt_ratio", "Belt ratio") } else { ("gear", "Gear") };
    let series = [("speed_kmh", "Vehicle speed"), ratio, ("engine_speed_rpm", "Engine speed")];
    let points: Vec<Points> = series.iter().map(|(name, _)| steps_or_means(run, name)).collect();
    let words: Vec<String> = series.iter().zip(&points).map(|((name, title), points)| words(title, name, points)).collect();
    let desc = format!("Three panels over time. {}.", words.join("; "));
    let size = (WIDTH, PLOT_TOP + 3.0 * 165.0 + 2.0 * GAP + BELOW + 6.0);
    let mut figure = Figure::new(size, PLOT_LEFT, "Vehicle speed, ratio and engine speed", run.name, &desc);
    let time = time_axis(run.rows);
    for (i, ((name, title), points)) in series.iter().zip(&points).enumerate() {
        let top = PLOT_TOP + i as f64 * (165.0 + GAP);
        let rect = Rect { left: PLOT_LEFT, right: WIDTH - 20.0, top, bottom: top + 165.0 };
        let y = Axis::round(&titled(title, name), zero_and(points), 6);
        let panel = Panel::draw(&mut figure, rect, time.clone(), y, i == 2);
        phases(&mut figure, &panel, run, i == 0);
        draw(&mut figure, &panel, points, PLAIN);
    }
    figure.finish()
}

/// Secondary and primary pressure over time, with the vehicle speed for context.
#[must_use]
pub fn pressure(run: &PlotRun) -> String {
    let names = [("secondary_pressure_bar", "Secondary"), ("primary_pressure_bar", "Primary")];
    let all: Vec<Series> = names
        .iter()
        .zip(PRESSURES)
        .map(|((name, title), stroke)| (*title, stroke, means(run.rows, name)))
        .filter(|(.., points)| has_data(points))
        .collect();
    let speed = means(run.rows, "speed_kmh");
    let mut said: Vec<String> = all.iter().map(|(title, _, points)| words(title, names[0].0, points)).collect();
    said.push(words("Vehicle speed", "speed_kmh", &speed));
    let desc = format!("Pulley pressures over time. {}.", said.join("; "));
    let (tall, low) = (280.0, 110.0);
    let size = (WIDTH + STRIP, PLOT_TOP + tall + GAP + low + BELOW + 6.0);
    let mut figure = Figure::new(size, PLOT_LEFT, "Pulley pressures", run.name, &desc);
    let y = Axis::round("Pressure [bar]", all.iter().flat_map(|s| zero_and(&s.2)), 7);
    several(&mut figure, run, (PLOT_TOP, PLOT_TOP + tall), y, &all, false);
    let top = PLOT_TOP + tall + GAP;
    let y = Axis::round("Speed [km/h]", zero_and(&speed), 4);
    let context = [("Vehicle speed", CONTEXT, speed)];
    several(&mut figure, run, (top, top + low), y, &context, true);
    figure.finish()
}

/// Draws a panel with its legend beside it. The last panel of a picture has the time axis, the
/// first one the names of the phases.
fn several(figure: &mut Figure, run: &PlotRun, (top, bottom): (f64, f64), y: Axis, all: &[Series], last: bool) {
    let rect = Rect { left: PLOT_LEFT, right: WIDTH - 20.0, top, bottom };
    let panel = Panel::draw(figure, rect, time_axis(run.rows), y, last);
    phases(figure, &panel, run, top <= PLOT_TOP);
    // The first of the list ends up on top.
    for (_, stroke, points) in all.iter().rev() {
        panel.line(figure, points, *stroke);
    }
    if !all.iter().any(|(.., points)| has_data(points)) {
        panel.empty(figure);
    }
    let entries: Vec<_> = all.iter().map(|(title, stroke, _)| (Mark::Line(*stroke), (*title).to_string())).collect();
    legend(figure, (WIDTH - 4.0, top), STRIP - 8.0, "", &entries);
}

/// Temperatures over time.
#[must_use]
pub fn temperatures(run: &PlotRun) -> String {
    let names = [
        ("coolant_degc", "Coolant"),
        ("engine_oil_degc", "Engine oil"),
        ("transmission_sump_degc", "Transmission sump"),
        ("transmission_metal_degc", "Transmission metal"),
        ("belt_spray_degc", "Belt spray"),
        ("cooler_out_degc", "Cooler outlet"),
    ];
    let all: Vec<Series> = names
        .iter()
        .zip(STROKES)
        .map(|((name, title), stroke)| (*title, stroke, ends(run.rows, name)))
        .filter(|(.., points)| has_data(points))
        .collect();
    let said: Vec<String> = all
        .iter()
        .map(|(title, _, points)| {
            let last = points.iter().rev().find(|point| point.1.is_finite());
            let end = last.map_or(String::new(), |p| format!(" and {} at the end", number(p.1, 1.0)));
            words(title, "coolant_degc", points) + &end
        })
        .collect();
    let desc = format!("Temperatures over time. {}.", said.join("; "));
    let size = (WIDTH + STRIP, PLOT_TOP + 400.0 + BELOW + 6.0);
    let mut figure = Figure::new(size, PLOT_LEFT, "Temperatures", run.name, &desc);
    let values = all.iter().flat_map(|(.., points)| points.iter().map(|p| p.1));
    let y = Axis::round("Temperature [\u{b0}C]", values, 9);
    several(&mut figure, run, (PLOT_TOP, PLOT_TOP + 400.0), y, &all, true);
    figure.finish()
}

fn draw(figure: &mut Figure, panel: &Panel, points: &[(f64, f64)], stroke: Stroke) {
    if has_data(points) {
        panel.line(figure, points, stroke);
    } else {
        panel.empty(figure);
    }
}

fn has_data(points: &[(f64, f64)]) -> bool {
    points.iter().any(|(_, y)| y.is_finite())
}

/// The time axis of a trace: all of it, no more.
pub(super) fn time_axis(rows: &[Row]) -> Axis {
    let start = rows.first().map_or(0.0, |row| row.time_s - row.dt_s);
    let end = rows.last().map_or(1.0, |row| row.time_s);
    Axis::exact("Time [s]", start, end, 10)
}

/// Means over steps stand in the middle of their step.
fn means(rows: &[Row], name: &str) -> Points {
    let Some(column) = column(name) else {
        return Vec::new();
    };
    rows.iter().map(|row| (row.time_s - 0.5 * row.dt_s, column.number(row))).collect()
}

/// States stand at the end of their step.
fn ends(rows: &[Row], name: &str) -> Points {
    let Some(column) = column(name) else {
        return Vec::new();
    };
    rows.iter().map(|row| (row.time_s, column.number(row))).collect()
}

/// A gear holds for its whole step; everything else goes on smoothly.
fn steps_or_means(run: &PlotRun, name: &str) -> Points {
    if name != "gear" {
        return means(run.rows, name);
    }
    run.rows
        .iter()
        .flat_map(|row| {
            let gear = f64::from(row.gear);
            [(row.time_s - row.dt_s, gear), (row.time_s, gear)]
        })
        .collect()
}

fn zero_and(points: &[(f64, f64)]) -> impl Iterator<Item = f64> {
    points.iter().map(|p| p.1).chain([0.0])
}

fn titled(title: &str, name: &str) -> String {
    match column(name).map_or("", |column| column.unit) {
        "" => title.to_string(),
        unit => format!("{title} [{unit}]"),
    }
}

/// A series in words, for those who cannot see the picture.
fn words(title: &str, name: &str, points: &[(f64, f64)]) -> String {
    let Some((low, high)) = range(points.iter().map(|p| p.1)) else {
        return format!("{title} without data");
    };
    let unit = match column(name).map_or("", |column| column.unit) {
        "-" | "" => "",
        "degC" => " \u{b0}C",
        unit => &format!(" {unit}"),
    };
    let step = if high - low < 20.0 { 0.01 } else { 1.0 };
    format!("{title} from {} to {}{unit}", number(low, step), number(high, step))
}

/// Marks where phases begin, with their names above the plot where these fit.
pub(super) fn phases(figure: &mut Figure, panel: &Panel, run: &PlotRun, named: bool) {
    let mut from = run.rows.first().map_or(0.0, |row| row.time_s - row.dt_s);
    let parts: Vec<&[Row]> = run.rows.chunk_by(|a, b| a.phase == b.phase).collect();
    let several = parts.len() > 1;
    for (i, part) in parts.iter().enumerate() {
        let (Some(first), Some(last)) = (part.first(), part.last()) else {
            continue;
        };
        let (left, right) = (panel.px(from), panel.px(last.time_s));
        if i > 0 && left.is_finite() && right - left > 3.0 {
            let attributes = format!("stroke=\"{QUIET}\" stroke-width=\"3\" stroke-dasharray=\"4 10\"");
            figure.line((left, panel.rect.top), (left, panel.rect.bottom), &attributes);
        }
        let name = run.phases.get(usize::from(first.phase)).map_or("", String::as_str);
        let short = fit(name, 10.0, right - left - 4.0);
        // A name cut to a few letters tells nothing.
        let tells = short == name || text_width(&short, 10.0) > 40.0;
        if named && several && tells && !short.is_empty() {
            let at = (0.5 * (left + right), panel.rect.top - 5.0);
            figure.text(at, 10.0, Anchor::Middle, "class=\"phase\"", INK, &short);
        }
        from = last.time_s;
    }
}
