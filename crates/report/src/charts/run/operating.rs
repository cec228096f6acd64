//! Where the engine runs: time at torque and speed, on its fuel map.

use super::PlotRun;
use crate::charts::engine::{
    Axis, Block, Chart, Entry, INK, PLOT_LEFT, Panel, Point, Rect, Stroke, ZERO, cell, number,
    range, stroke,
};
use crate::charts::grids::{Density, ISO, iso_lines};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::{Flags, History};

/// rad/s in rpm.
const RPM: f64 = 30.0 / std::f64::consts::PI;
const WIDE: f64 = 860.0 - PLOT_LEFT;
/// Cells along an axis at most: small enough to show where time goes, large enough to be seen.
const CELLS: (usize, usize) = (70, 60);
const FULL_LOAD: Stroke = stroke(INK, 2.0, &[]);

/// Engine torque against engine speed: time spent in the cells of a grid, under lines of equal specific consumption and the full-load
/// torque. Times in which the engine is off are left out.
#[must_use]
pub fn operating_points(run: &PlotRun) -> Picture {
    let points = points(run.history);
    let map = run.fuel_map.as_ref();
    let full_load = map.map_or_else(Vec::new, full_load);
    let (x, y) = axes(&points, &full_load);
    let size = (
        Density::size_for(&x, CELLS.0),
        Density::size_for(&y, CELLS.1),
    );
    let density = Density::new(size, points.iter().copied());
    let mut table = table(&density);
    let mut panel = Panel {
        no_data: points.is_empty(),
        ..Panel::new(Rect::new(PLOT_LEFT, 58.0, WIDE, 460.0), x, y)
    };
    panel.items = density.items(|cell| table.push(cells(cell, density.total_s())));
    if panel.y.low < 0.0 {
        panel.level(0.0, ZERO);
    }
    let labels = map.map_or_else(Vec::new, |map| {
        let taken = occupied(&panel, &density);
        iso_lines(&mut panel, map, &full_load, taken)
    });
    panel.series(full_load, FULL_LOAD);
    labels.into_iter().for_each(|label| panel.label(label));
    let lines = map.map_or_else(Vec::new, |_| {
        vec![
            Entry::line(FULL_LOAD, "Full load"),
            Entry::line(ISO, "Consumption [g/kWh]"),
        ]
    });
    let mut foot = vec![Block::legend((PLOT_LEFT, 0.5 * WIDE - 20.0), "", lines)];
    if !points.is_empty() {
        foot[0].before_next = true;
        foot.push(Block::key(
            (PLOT_LEFT + 0.5 * WIDE, 0.5 * WIDE - 4.0),
            density.key(),
        ));
    }
    let chart = Chart {
        title: "Engine operating points".to_owned(),
        subject: run.name.to_owned(),
        description: describe(&points, size, map.is_some()),
        left: PLOT_LEFT,
        panels: vec![panel],
        foot,
        table,
        ..Chart::default()
    };
    chart.picture()
}

fn full_load(map: &FuelMap) -> Vec<Point> {
    let points = map.speed_rad_s.iter().zip(&map.full_load_nm);
    points.map(|(w, t)| (w * RPM, *t)).collect()
}

/// Both axes: all points, the full-load line, and zero torque.
fn axes(points: &[(f64, f64, f64)], full_load: &[Point]) -> (Axis, Axis) {
    let points = || {
        points
            .iter()
            .map(|p| (p.0, p.1))
            .chain(full_load.iter().copied())
    };
    (
        Axis::round("Engine speed [rpm]", points().map(|p| p.0), 9),
        Axis::round("Engine torque [Nm]", points().map(|p| p.1).chain([0.0]), 9),
    )
}

fn table(density: &Density) -> PictureTable {
    let mut table = PictureTable::new(&[
        ("Engine speed", "rpm"),
        ("Engine torque", "Nm"),
        ("Time", "s"),
        ("Share of time", "%"),
    ]);
    table.note = format!(
        "Cells in which the engine ran, {} s in all; a cell without time is not listed.",
        number(density.total_s(), 0.1)
    );
    table
}

fn cells(of: &crate::charts::grids::DensityCell, total_s: f64) -> Vec<String> {
    let span = |(from, to): (f64, f64)| {
        let step = to - from;
        format!("{} to {}", number(from, step), number(to, step))
    };
    let share = 100.0 * of.seconds / total_s;
    vec![
        span(of.x),
        span(of.y),
        cell(of.seconds, 0.01),
        cell(share, 0.01),
    ]
}

/// Where the cells are, pixels: labels keep clear of them if they can.
fn occupied(panel: &Panel, density: &Density) -> Vec<Rect> {
    let rect = |x: (f64, f64), y: (f64, f64)| Rect {
        left: panel.px(x.0),
        right: panel.px(x.1),
        top: panel.py(y.1),
        bottom: panel.py(y.0),
    };
    density.cells().map(|cell| rect(cell.x, cell.y)).collect()
}

/// Speed in rpm, torque in Nm and length in s of every step with the engine running.
fn points(history: &History) -> Vec<(f64, f64, f64)> {
    let speed = history.column("engine_speed_rpm").iter();
    let torque = history.column("engine_torque_nm");
    let steps = speed.zip(torque).zip(history.dt_s()).enumerate();
    steps
        .filter(|(i, _)| !history.flags(*i).contains(Flags::ENGINE_OFF))
        .map(|(_, ((n, t), dt))| (*n, *t, *dt))
        .filter(|(n, t, dt)| n.is_finite() && t.is_finite() && dt.is_finite() && *dt > 0.0)
        .collect()
}

fn describe(points: &[(f64, f64, f64)], size: Point, with_map: bool) -> String {
    let speed = range(points.iter().map(|p| p.0));
    let torque = range(points.iter().map(|p| p.1));
    let Some(((slow, fast), (low, high))) = speed.zip(torque) else {
        return "Engine torque against speed, without data.".to_string();
    };
    let seconds: f64 = points.iter().map(|p| p.2).sum();
    let map = if with_map {
        ", under lines of equal specific fuel consumption"
    } else {
        ""
    };
    let [seconds, slow, fast, low, high] = [seconds, slow, fast, low, high].map(|x| number(x, 1.0));
    format!(
        "Engine torque against speed{map}; time spent in cells of {} rpm by {} Nm, {seconds} s in all, from {slow} to {fast} rpm and from {low} to {high} Nm.",
        number(size.0, size.0),
        number(size.1, size.1)
    )
}
