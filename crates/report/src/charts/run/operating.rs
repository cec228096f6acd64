//! Where the engine runs: time at torque and speed, on its fuel map.

use super::PlotRun;
use crate::charts::engine::{
    Axis, Block, Chart, Entry, INK, PLOT_LEFT, Panel, Point, Rect, Stroke, ZERO, cell, number,
    stroke,
};
use crate::charts::grids::{Density, DensityCell, ISO, iso_lines};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_model::drive::FuelMap;
use cvtcycle_model::keys::RAD_S;
use cvtcycle_output::{Flags, History};

const WIDE: f64 = 860.0 - PLOT_LEFT;
/// Cells along an axis at most: small enough to show where time goes, large enough to be seen.
const CELLS: (usize, usize) = (70, 60);
const FULL_LOAD: Stroke = stroke(INK, 2.0, &[]);

/// Engine torque against engine speed: time spent in the cells of a grid, under lines of equal specific consumption and the full-load
/// torque. Times in which the engine is off are left out.
pub fn operating_points(run: &PlotRun) -> Picture {
    let points = points(run.history);
    let map = run.fuel_map.as_ref();
    let full_load = map.map_or_else(Vec::new, full_load);
    let (x, y) = axes(&points, &full_load);
    let density = Density::new(Density::size_for(&x, &y, CELLS), points.iter().copied());
    let mut table = table(&density);
    let rect = Rect::new(PLOT_LEFT, 58.0, WIDE, 460.0);
    let mut panel = Panel::new(rect, x, y).no_data(points.is_empty());
    panel.items = density.items(|cell| table.push(cells(cell, density.total_s())));
    if panel.y.low < 0.0 {
        panel.level(0.0, ZERO);
    }
    let mut labels = Vec::new();
    let mut lines = Vec::new();
    if let Some(map) = map {
        let taken = occupied(&panel, &density);
        labels = iso_lines(&mut panel, map, &full_load, taken);
        lines.push(Entry::line(FULL_LOAD, "Full load"));
        lines.push(Entry::line(ISO, "Consumption [g/kWh]"));
    }
    panel.series(full_load, FULL_LOAD);
    labels.into_iter().for_each(|label| panel.label(label));
    let mut legend = Block::legend((PLOT_LEFT, 0.5 * WIDE - 20.0), "", lines);
    legend.before_next = !points.is_empty();
    let mut chart = Chart::new("Engine operating points", run.name, PLOT_LEFT)
        .panels([panel])
        .foot(legend);
    if !points.is_empty() {
        let place = (PLOT_LEFT + 0.5 * WIDE, 0.5 * WIDE - 4.0);
        chart = chart.foot(Block::key(place, density.key()));
    }
    chart.picture(table)
}

fn full_load(map: &FuelMap) -> Vec<Point> {
    let points = map.speed_rad_s.iter().zip(&map.full_load_nm);
    points.map(|(w, t)| (w * RAD_S, *t)).collect()
}

/// Both axes: all points, the full-load line, and zero torque.
fn axes(points: &[(f64, f64, f64)], full_load: &[Point]) -> (Axis, Axis) {
    let all = || {
        points
            .iter()
            .map(|p| (p.0, p.1))
            .chain(full_load.iter().copied())
    };
    let y = all().map(|p| p.1).chain([0.0]);
    (
        Axis::round("Engine speed [rpm]", all().map(|p| p.0), 9),
        Axis::round("Engine torque [Nm]", y, 9),
    )
}

fn table(density: &Density) -> PictureTable {
    let engine = [("Engine speed", "rpm"), ("Engine torque", "Nm")];
    let time = [("Time", "s"), ("Share of time", "%")];
    PictureTable::new(&[engine, time].concat()).note(format!(
        "Cells in which the engine ran, {} s in all; a cell without time is not listed.",
        number(density.total_s(), 0.1)
    ))
}

fn cells(of: &DensityCell, total_s: f64) -> [String; 4] {
    let span = |(from, to): (f64, f64)| {
        let step = to - from;
        format!("{} to {}", number(from, step), number(to, step))
    };
    let [time, share] = [of.seconds, 100.0 * of.seconds / total_s].map(|x| cell(x, 0.01));
    [span(of.x), span(of.y), time, share]
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
