//! Where the engine runs: time at torque and speed, on its fuel map.
use std::f64::consts::PI;

use super::axis::{Axis, number, range};
use super::density::{Density, DensityScale, KEY_HEIGHT, colour_key, draw_cells};
use super::figure::{Figure, Rect};
use super::iso::{iso_lines, label};
use super::legend::{Mark, below_height, legend_below};
use super::panel::{BELOW, LEFT, Panel};
use super::style::Stroke;
use super::{Picture, PictureTable, PlotRun, cell};
use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::{Flags, History};

pub(super) const RPM: f64 = 30.0 / PI;
pub(super) const RECT: Rect = Rect {
    left: LEFT + 8.0,
    top: 58.0,
    right: 860.0,
    bottom: 518.0,
};
const WIDTH: f64 = 880.0;
/// Cells along an axis at most: small enough to show where time goes, large enough to be seen.
const CELLS: (usize, usize) = (70, 60);
const FULL_LOAD: Stroke = Stroke {
    colour: "#000000",
    width: 2.0,
    dash: &[],
};
/// A line of equal consumption; it lies on a wider one in the colour of the paper.
pub(super) const ISO: Stroke = Stroke {
    colour: "#555555",
    width: 1.0,
    dash: &[],
};
const ZERO: Stroke = Stroke {
    colour: "#000000",
    width: 0.8,
    dash: &[],
};

/// Engine torque against engine speed: time spent in the cells of a grid, under lines of equal specific consumption and the
/// full-load torque. Times in which the engine is off are left out.
#[must_use]
pub fn operating_points(run: &PlotRun) -> Picture {
    let points = points(run.history);
    let map = run.fuel_map.as_ref();
    let full_load = map.map_or_else(Vec::new, full_load);
    let (panel_x, panel_y) = axes(&points, &full_load);
    let size = (
        Density::size_for(&panel_x, CELLS.0),
        Density::size_for(&panel_y, CELLS.1),
    );
    let density = Density::gather(size, points.iter().copied());
    let lines = [
        (Mark::Line(FULL_LOAD), "Full load".to_owned()),
        (Mark::Line(ISO), "Consumption [g/kWh]".to_owned()),
    ];
    let lines = if map.is_some() { &lines[..] } else { &[] };
    let width = RECT.right - RECT.left;
    let below = RECT.bottom + BELOW + 8.0;
    let tall =
        below_height(lines.iter().map(|(_, name)| name.as_str()), 0.5 * width, "").max(KEY_HEIGHT);
    let desc = describe(&points, size, map.is_some());
    let mut figure = Figure::new(
        (WIDTH, below + tall + 4.0),
        RECT.left,
        "Engine operating points",
        run.name,
        &desc,
    );
    let panel = Panel::draw(&mut figure, RECT, panel_x, panel_y, true);
    let scale = density.scale();
    let table = cells(&mut figure, &panel, &density, &scale);
    if panel.y.low < 0.0 {
        panel.line(
            &mut figure,
            &[(panel.x.low, 0.0), (panel.x.high, 0.0)],
            ZERO,
        );
    }
    let labels = map.map_or_else(Vec::new, |map| {
        iso_lines(
            &mut figure,
            &panel,
            map,
            &full_load,
            &taken(&panel, &density),
        )
    });
    panel.line(&mut figure, &full_load, FULL_LOAD);
    label(&mut figure, labels);
    if points.is_empty() {
        panel.empty(&mut figure);
    } else {
        colour_key(
            &mut figure,
            (RECT.left + 0.5 * width, below),
            0.5 * width - 4.0,
            &scale,
        );
    }
    legend_below(
        &mut figure,
        (RECT.left, below),
        0.5 * width - 20.0,
        "",
        lines,
    );
    Picture {
        svg: figure.finish(),
        table,
    }
}

fn full_load(map: &FuelMap) -> Vec<(f64, f64)> {
    map.speed_rad_s
        .iter()
        .zip(&map.full_load_nm)
        .map(|(w, t)| (w * RPM, *t))
        .collect()
}

/// Both axes: all points, the full-load line, and no torque below the lowest one but for a little room.
fn axes(points: &[(f64, f64, f64)], full_load: &[(f64, f64)]) -> (Axis, Axis) {
    let speeds = points
        .iter()
        .map(|p| p.0)
        .chain(full_load.iter().map(|p| p.0));
    let torques = points
        .iter()
        .map(|p| p.1)
        .chain(full_load.iter().map(|p| p.1));
    (
        Axis::round("Engine speed [rpm]", speeds, 9),
        Axis::round("Engine torque [Nm]", torques.chain([0.0]), 9),
    )
}

/// Draws the cells; returns them as a table.
fn cells(
    figure: &mut Figure,
    panel: &Panel,
    density: &Density,
    scale: &DensityScale,
) -> PictureTable {
    let mut table = PictureTable::new(&[
        ("Engine speed", "rpm"),
        ("Engine torque", "Nm"),
        ("Time", "s"),
        ("Share of time", "%"),
    ]);
    let total = density.total_s();
    draw_cells(figure, panel, density, scale, |of| {
        let span = |(from, to): (f64, f64)| {
            format!("{} to {}", number(from, to - from), number(to, to - from))
        };
        table.push(vec![
            span(of.x),
            span(of.y),
            cell(of.seconds, 0.01),
            cell(100.0 * of.seconds / total, 0.01),
        ])
    });
    table.note = format!(
        "Cells in which the engine ran, {} s in all; a cell without time is not listed.",
        number(total, 0.1)
    );
    table
}

/// Where the cells are, pixels: labels keep clear of them if they can.
fn taken(panel: &Panel, density: &Density) -> Vec<Rect> {
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
    let (speed, torque) = (
        history.column("engine_speed_rpm"),
        history.column("engine_torque_nm"),
    );
    let steps = speed.iter().zip(torque).zip(history.dt_s()).enumerate();
    steps
        .filter(|(i, _)| !history.flags(*i).contains(Flags::ENGINE_OFF))
        .map(|(_, ((n, t), dt))| (*n, *t, *dt))
        .filter(|(n, t, dt)| n.is_finite() && t.is_finite() && dt.is_finite() && *dt > 0.0)
        .collect()
}

fn describe(points: &[(f64, f64, f64)], size: (f64, f64), with_map: bool) -> String {
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
    format!(
        "Engine torque against speed{map}; time spent in cells of {} rpm by {} Nm, {} s in all, from {} to {} rpm and from {} to {} Nm.",
        number(size.0, size.0),
        number(size.1, size.1),
        number(seconds, 1.0),
        number(slow, 1.0),
        number(fast, 1.0),
        number(low, 1.0),
        number(high, 1.0)
    )
}
