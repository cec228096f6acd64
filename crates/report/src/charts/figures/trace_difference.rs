//! Differences of two runs along the drive: fuel that B has burnt more than A up to each moment, and other quantities of B minus those of A.

use super::TOP;
use super::overlay::{OverlayPanel, at};
use crate::charts::engine::{
    Axis, CONTEXT, Chart, PLAIN, PLOT_LEFT, Panel, Point, Rect, Shape, Style, WIDTH, ZERO, cell,
    range, signed_colour,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{grouped, sign, with_unit};

/// Two runs over one time axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceDifference {
    /// Names of runs A and B.
    pub names: [String; 2],
    /// Vehicle speed of A, km/h, for context.
    pub speed_kmh: Vec<Point>,
    /// Fuel flow of A and of B, g/s, with the end of each step and its length, s.
    pub fuel_g_s: [Vec<(f64, f64, f64)>; 2],
    /// Other quantities, drawn as B minus A.
    pub panels: Vec<OverlayPanel>,
}

const WIDE: f64 = WIDTH - 20.0 - PLOT_LEFT;
/// Heights of the panel of the fuel, of the others, and of the speed, pixels.
const TALL: (f64, f64, f64) = (190.0, 100.0, 80.0);
/// Room between panels, including a heading, pixels.
const GAP: f64 = 32.0;
/// Maximum number of rows of the table.
const ROWS: usize = 600;

/// A panel: title of its axis, points, step of its cells.
struct Line {
    name: String,
    unit: &'static str,
    points: Vec<Point>,
    step: f64,
}

/// Fuel burnt up to the end of each step, g.
fn summed(flow: &[(f64, f64, f64)]) -> Vec<Point> {
    let mut sum = 0.0;
    let step = |(end, dt, g_s): &(f64, f64, f64)| {
        let grams = g_s * dt;
        sum += if grams.is_finite() { grams } else { 0.0 };
        (*end, sum)
    };
    flow.iter().map(step).collect()
}

/// B minus A at the times of A.
fn less(a: &[Point], b: &[Point]) -> Vec<Point> {
    a.iter().map(|(t, x)| (*t, at(b, *t) - x)).collect()
}

/// Draws the excess fuel of B up to each moment above the differences of the other quantities, with the vehicle speed for context.
pub fn trace_difference(data: &TraceDifference) -> Picture {
    let [a, b] = data.fuel_g_s.each_ref().map(|flow| summed(flow));
    let fuel = Line {
        name: "Fuel of B less that of A, so far".to_owned(),
        unit: "g",
        points: less(&a, &b),
        step: 0.01,
    };
    let other = |panel: &OverlayPanel| Line {
        name: panel.title.clone(),
        unit: panel.sign(),
        points: less(&panel.runs[0], &panel.runs[1]),
        step: 0.1 * panel.digits(),
    };
    let lines: Vec<Line> = std::iter::once(fuel)
        .chain(data.panels.iter().map(other))
        .collect();
    let end = range(a.iter().map(|p| p.0)).map_or(1.0, |(_, end)| end);
    let time = Axis::exact("Time [s]", 0.0, end, 10);
    let mut top = TOP + 18.0;
    let mut panels = Vec::new();
    for (k, line) in lines.iter().enumerate() {
        let tall = if k == 0 { TALL.0 } else { TALL.1 };
        let rect = Rect::new(PLOT_LEFT, top, WIDE, tall);
        let values = line.points.iter().map(|p| p.1).chain([0.0]);
        let y = Axis::round(
            &with_unit("B \u{2212} A", line.unit),
            values,
            if k == 0 { 6 } else { 3 },
        );
        let panel = Panel::new(rect, time.clone(), y)
            .over_table()
            .x_labels(false);
        let mut panel = panel
            .heading(&line.name)
            .no_data(!line.points.iter().any(|p| p.1.is_finite()));
        areas(&mut panel, &line.points);
        panel.series(line.points.clone(), PLAIN);
        panel.level(0.0, ZERO);
        panels.push(panel);
        top += tall + GAP;
    }
    let y = Axis::round(
        "Speed [km/h]",
        data.speed_kmh.iter().map(|p| p.1).chain([0.0]),
        3,
    );
    let rect = Rect::new(PLOT_LEFT, top, WIDE, TALL.2);
    let mut panel = Panel::new(rect, time, y)
        .over_table()
        .heading("Vehicle speed");
    panel.series(data.speed_kmh.clone(), CONTEXT);
    panels.push(panel);
    let subject = format!("A: {}; B: {}", data.names[0], data.names[1]);
    Chart::new(title(&lines[0].points), subject, PLOT_LEFT)
        .lead("What B has more or less than A at each moment")
        .panels(panels)
        .picture(table(&lines, &data.speed_kmh))
}

/// Draws positive and negative areas in the two signed colours.
fn areas(panel: &mut Panel, points: &[Point]) {
    for more in [false, true] {
        let part = |y: f64| if more { y.max(0.0) } else { y.min(0.0) };
        let area = points.iter().filter(|p| p.1.is_finite());
        let area: Vec<(f64, f64, f64)> = area.map(|(x, y)| (*x, 0.0, part(*y))).collect();
        if area.iter().any(|(_, _, y)| y.abs() > 0.0) {
            let style = Style::colour(&signed_colour(more)).fill_opacity(0.7);
            panel.add(Shape::between(&area), style.class("signed"));
        }
    }
}

/// Title: excess fuel of B, and the time by which half of it has been burnt.
fn title(fuel: &[Point]) -> String {
    let end = fuel.iter().rfind(|p| p.1.is_finite());
    let Some((_, total)) = end.filter(|p| p.1.abs() >= 0.005) else {
        return "B burns as much as A".to_owned();
    };
    let more = if *total < 0.0 { "less" } else { "more" };
    let half = fuel
        .iter()
        .rposition(|p| p.1 / total < 0.5)
        .and_then(|k| fuel.get(k + 1));
    let half = half.map_or_else(String::new, |(t, _)| {
        format!(", half of it by {} s", grouped(*t, 0))
    });
    format!("B burns {} g {more} than A{half}", grouped(total.abs(), 2))
}

fn table(lines: &[Line], speed: &[Point]) -> PictureTable {
    let mut table = PictureTable::new(&[("time", "s")]);
    let difference = |line: &Line| match line.name.as_str() {
        name if name.starts_with("Fuel") => (name.to_owned(), line.unit),
        name => (format!("{name}, B \u{2212} A"), sign(line.unit)),
    };
    table.columns.extend(lines.iter().map(difference));
    table.columns.push(("speed of A".to_owned(), "km/h"));
    let times: Vec<f64> = lines[0].points.iter().map(|p| p.0).collect();
    let every = times.len().div_ceil(ROWS).max(1);
    for time in times.iter().step_by(every) {
        let mut cells = vec![cell(*time, 0.1)];
        cells.extend(
            lines
                .iter()
                .map(|line| cell(at(&line.points, *time), line.step)),
        );
        cells.push(cell(at(speed, *time), 0.1));
        table.push(cells);
    }
    if every > 1 {
        table.note = format!("One of {every} times is listed; the lines are drawn from all.");
    }
    table
}
