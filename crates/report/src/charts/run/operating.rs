//! Operating points: fuel burnt by torque and speed, on the engine's map, with lines of equal power and the line of minimum consumption; a panel
//! for each car, all on one scale.

use super::PlotRun;
use crate::charts::engine::{
    Axis, Block, Chart, Entry, INK, Item, Key, LEFT, Label, PLOT_LEFT, Panel, Point, QUIET, RULE,
    Rect, Shape, Stroke, Style, WIDTH, ZERO, at, cell, grid, number, range, stroke,
};
use crate::charts::grids::{Density, DensityCell, ISO, iso_lines};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::grouped;
use cvtcycle_model::drive::FuelMap;
use cvtcycle_model::keys::RAD_S;
use cvtcycle_output::{Flags, History};

/// Sizes of a lone panel and of one of two in a row, pixels.
const LONE: Point = (850.0 - PLOT_LEFT, 460.0);
const PAIRED: Point = ((WIDTH - PLOT_LEFT - LEFT - 48.0) / 2.0, 270.0);
const TOP: f64 = 58.0;
/// Room for the heading of a panel, and between rows, pixels.
const HEADING: f64 = 22.0;
const PITCH: f64 = 74.0;
/// Maximum number of cells along an axis: small enough for detail, large enough to be seen.
const CELLS: (usize, usize) = (60, 50);
const FULL_LOAD: Stroke = stroke(INK, 2.0, &[]);
/// Line of minimum consumption for each power.
const BEST: Stroke = stroke("#c0392b", 1.8, &[7.0, 3.0]);
const POWER: Stroke = stroke("#b9b9b9", 0.8, &[2.0, 2.0]);
/// Powers of the lines of equal power, kW.
const POWERS_KW: [f64; 6] = [5.0, 10.0, 20.0, 40.0, 80.0, 160.0];
/// Width of the speed range named in a title, rpm.
const STRETCH: f64 = 500.0;

/// A step with the engine running: speed in rpm, torque in Nm, length in s, fuel in g.
type Moment = (f64, f64, f64, f64);

/// Engine torque against engine speed: fuel burnt in the cells of a grid, on the fuel map. Omits times with the engine off or burning no fuel.
pub fn operating_points(runs: &[PlotRun]) -> Picture {
    let cars: Vec<(&PlotRun, Vec<Moment>)> =
        runs.iter().map(|run| (run, moments(run.history))).collect();
    let (x, y) = axes(&cars);
    let cells = Density::size_for(&x, &y, CELLS);
    let several = cars.len() > 1;
    let (size, columns) = if several { (PAIRED, 2) } else { (LONE, 1) };
    let top = TOP + if several { HEADING } else { 0.0 };
    let pitch = (size.0 + LEFT + 20.0, size.1 + PITCH);
    let place = grid((PLOT_LEFT, top), size, pitch, columns);
    let mut table = table(&cars);
    let burnt = |moments: &[Moment]| Density::new(cells, moments.iter().map(|m| (m.0, m.1, m.3)));
    let ends = cars.iter().map(|(_, moments)| burnt(moments).ends());
    let span = ends.fold((f64::INFINITY, 0.0_f64), |a, b| {
        (a.0.min(b.0), a.1.max(b.1))
    });
    // A thousandth of the maximum is invisible.
    let span = (span.0.max(1e-3 * span.1), span.1);
    let mut key = None;
    let mut panels = Vec::new();
    let mut is_mapped = false;
    for (k, (run, moments)) in cars.iter().enumerate() {
        let panel = Panel::new(place(k), x.clone(), y.clone()).no_data(moments.is_empty());
        let mut panel = if several {
            panel.heading(run.name)
        } else {
            panel
        };
        let fuel = burnt(moments).on_scale(span);
        let time = Density::new(cells, moments.iter().map(|m| (m.0, m.1, m.2)));
        lines_of_power(&mut panel);
        panel.items.extend(fuel.items(|cell| {
            let middle = (0.5 * (cell.x.0 + cell.x.1), 0.5 * (cell.y.0 + cell.y.1));
            let own = [cell.seconds, time.within(middle)];
            table.push(self::cells(run.name, cell, own, fuel.total_s()))
        }));
        key = key.or_else(|| (!moments.is_empty()).then(|| fuel.key(FUEL)));
        if panel.y.low < 0.0 {
            panel.level(0.0, ZERO);
        }
        if let Some(map) = &run.fuel_map {
            is_mapped = true;
            mapped(&mut panel, map, &fuel);
        }
        panels.push(panel);
    }
    let subject = match runs {
        [run] => run.name.to_owned(),
        _ => "Fuel in cells of engine torque and speed, one scale".to_owned(),
    };
    let chart = Chart::new(title(&cars), subject, PLOT_LEFT).panels(panels);
    legend(chart, is_mapped, key).picture(table)
}

const FUEL: &str = "Fuel burnt in a cell [g]";

fn legend(chart: Chart, is_mapped: bool, key: Option<Key>) -> Chart {
    let half = 0.5 * LONE.0;
    let mut entries = vec![Entry::line(POWER, "Equal power [kW]")];
    if is_mapped {
        entries.push(Entry::line(FULL_LOAD, "Full load"));
        entries.push(Entry::line(ISO, "Consumption [g/kWh]"));
        entries.push(Entry::line(BEST, "Least consumption for a power"));
    }
    let mut legend = Block::legend((PLOT_LEFT, half - 20.0), "", entries);
    legend.before_next = key.is_some();
    let chart = chart.foot(legend);
    match key {
        Some(key) => chart.foot(Block::key((PLOT_LEFT + half, half - 4.0), key)),
        None => chart,
    }
}

/// Title: operating range in which each car burns the largest part of its fuel.
fn title(cars: &[(&PlotRun, Vec<Moment>)]) -> String {
    let most = |(run, moments): &(&PlotRun, Vec<Moment>)| {
        let all: f64 = moments.iter().map(|m| m.3).sum();
        let mut stretches: Vec<(i64, f64)> = Vec::new();
        for moment in moments {
            let stretch = (moment.0 / STRETCH).floor() as i64;
            match stretches
                .iter_mut()
                .find(|density_cell| density_cell.0 == stretch)
            {
                Some(density_cell) => density_cell.1 += moment.3,
                None => stretches.push((stretch, moment.3)),
            }
        }
        let (stretch, fuel) = stretches.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let ends = [stretch, stretch + 1].map(|k| grouped(k as f64 * STRETCH, 0));
        let share = grouped(100.0 * fuel / all, 0);
        let [from, to] = ends;
        (all > 0.0).then(|| (run.name.to_owned(), share, format!("at {from} to {to} rpm")))
    };
    let mut list = cars.iter().filter_map(most);
    let Some((name, share, place)) = list.next() else {
        return "Engine operating points".to_owned();
    };
    let own = format!("{name} burns {share} % of its fuel {place}");
    match list.next() {
        Some((other, share, place)) => format!("{own}, {other} {share} % {place}"),
        None => own,
    }
}

/// Adds contours of equal consumption, full load, and the line of minimum consumption.
fn mapped(panel: &mut Panel, map: &FuelMap, fuel: &Density) {
    let full_load = full_load(map);
    let taken = occupied(panel, fuel);
    let labels = iso_lines(panel, map, &full_load, taken);
    // The map extends beyond the driven speeds.
    if let Some(lines) = panel.items.pop() {
        panel.add(Shape::Within(None, vec![lines]), Style::default());
    }
    let line = |points: Vec<Point>, stroke: Stroke| Item {
        shape: Shape::Line(points),
        style: Style::line(stroke).class("series"),
    };
    let lines = vec![
        line(full_load.clone(), FULL_LOAD),
        line(best(map, &full_load), BEST),
    ];
    panel.add(Shape::Within(None, lines), Style::default());
    labels.into_iter().for_each(|label| panel.label(label));
}

/// Lines of equal power with their kW at the right.
fn lines_of_power(panel: &mut Panel) {
    let (low, high) = (panel.x.low.max(1.0), panel.x.high);
    let mut lines = Vec::new();
    for kw in POWERS_KW {
        let torque = |rpm: f64| 1e3 * kw / (rpm / RAD_S);
        if torque(high) < 0.04 * panel.y.high || torque(high) > 0.96 * panel.y.high {
            continue;
        }
        let step = |k: u32| low + (high - low) * f64::from(k) / 60.0;
        let points = (0..=60).map(step).map(|rpm| (rpm, torque(rpm)));
        lines.push(Item {
            shape: Shape::Line(points.filter(|p| p.1 <= panel.y.high).collect()),
            style: Style::line(POWER),
        });
        // Beyond the frame, clear of other labels; the legend has the unit.
        let place = at(high, torque(high)).shift(3.0, 4.0);
        panel.label(Label::new(place, cvtcycle_output::number::plain(kw)).colour(QUIET));
    }
    let labels = std::mem::take(&mut panel.items);
    panel.add(Shape::Within(None, lines), Style::line(RULE));
    panel.items.extend(labels);
}

fn full_load(map: &FuelMap) -> Vec<Point> {
    let points = map.speed_rad_s.iter().zip(&map.full_load_nm);
    points.map(|(w, t)| (w * RAD_S, *t)).collect()
}

/// Point of minimum consumption at each power, by linear interpolation between the points of the map.
fn best(map: &FuelMap, full_load: &[Point]) -> Vec<Point> {
    let Some((_, most)) = range(full_load.iter().map(|(n, t)| n / RAD_S * t)) else {
        return Vec::new();
    };
    let at = |k: u32| most * (0.04 + 0.96 * f64::from(k) / 48.0);
    let least = |w: f64| {
        let places = 0..=120;
        let (low, high) = (full_load.first()?.0, full_load.last()?.0);
        let rpm = places.map(|k| low + (high - low) * f64::from(k) / 120.0);
        let points = rpm.filter_map(|n| {
            Some((
                (n, w * RAD_S / n),
                consumption(map, n / RAD_S, w * RAD_S / n)?,
            ))
        });
        points
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(point, _)| point)
    };
    (0..=48).map(at).filter_map(least).collect()
}

/// Consumption between four points of the map; `None` outside it, or next to an unknown one.
fn consumption(map: &FuelMap, rad_s: f64, nm: f64) -> Option<f64> {
    let below = |axis: &[f64], x: f64| {
        let i = axis.partition_point(|a| *a <= x).checked_sub(1)?;
        let next = axis.get(i + 1)?;
        Some((i, (x - axis[i]) / (next - axis[i])))
    };
    let ((i, a), (j, b)) = (below(&map.speed_rad_s, rad_s)?, below(&map.torque_nm, nm)?);
    let value = |i: usize, j: usize| map.bsfc_kg_j.get(i)?.get(j).copied();
    let row = |i: usize| Some(value(i, j)? * (1.0 - b) + value(i, j + 1)? * b);
    let mixed = row(i)? * (1.0 - a) + row(i + 1)? * a;
    (mixed > 0.0 && mixed.is_finite()).then_some(mixed)
}

/// Axes over all points with a fifth more speed, full load over that range, and zero torque.
fn axes(cars: &[(&PlotRun, Vec<Moment>)]) -> (Axis, Axis) {
    let moments = || cars.iter().flat_map(|(_, moments)| moments);
    let lines: Vec<Point> = cars
        .iter()
        .filter_map(|(run, _)| run.fuel_map.as_ref())
        .flat_map(full_load)
        .collect();
    let driven = range(moments().map(|m| m.0));
    let speeds = match driven {
        Some((low, high)) => vec![low, high + 0.2 * (high - low)],
        None => lines.iter().map(|p| p.0).collect(),
    };
    let x = Axis::round("Engine speed [rpm]", speeds.into_iter(), 7);
    let within = lines.iter().filter(|p| p.0 <= x.high).map(|p| p.1);
    let torques = moments().map(|m| m.1).chain(within).chain([0.0]);
    let y = Axis::round("Engine torque [Nm]", torques, 7);
    (x, y)
}

fn table(cars: &[(&PlotRun, Vec<Moment>)]) -> PictureTable {
    let columns = [
        ("Engine speed", "rpm"),
        ("Engine torque", "Nm"),
        ("Time", "s"),
        ("Fuel", "g"),
        ("Share of the fuel", "%"),
        ("Car", ""),
    ];
    let totals = cars.iter().map(|(run, moments)| {
        let grams: f64 = moments.iter().map(|m| m.3).sum();
        format!("{} g in {}", number(grams, 0.1), run.name)
    });
    PictureTable::new(&columns).note(format!(
        "Cells in which fuel was burnt, {} in all; a cell without fuel is not listed.",
        totals.collect::<Vec<_>>().join(", ")
    ))
}

fn cells(
    car: &str,
    density_cell: &DensityCell,
    [fuel, seconds]: [f64; 2],
    total: f64,
) -> [String; 6] {
    let span = |(from, to): (f64, f64)| {
        let step = to - from;
        format!("{} to {}", number(from, step), number(to, step))
    };
    let [time, fuel_g] = [seconds, fuel].map(|x| cell(x, 0.01));
    let share = cell(100.0 * fuel / total, 0.01);
    [
        span(density_cell.x),
        span(density_cell.y),
        time,
        fuel_g,
        share,
        car.to_owned(),
    ]
}

/// Rectangles of the cells, pixels: labels avoid them if possible.
fn occupied(panel: &Panel, density: &Density) -> Vec<Rect> {
    let rect = |x: (f64, f64), y: (f64, f64)| Rect {
        left: panel.px(x.0),
        right: panel.px(x.1),
        top: panel.py(y.1),
        bottom: panel.py(y.0),
    };
    density.cells().map(|cell| rect(cell.x, cell.y)).collect()
}

/// Every step with the engine running that burns fuel.
fn moments(history: &History) -> Vec<Moment> {
    let speed = history.column("engine_speed_rpm").iter();
    let torque = history.column("engine_torque_nm");
    let fuel = history.column("fuel_g_s");
    let steps = speed.zip(torque).zip(fuel).zip(history.dt_s()).enumerate();
    steps
        .filter(|(i, _)| !history.flags(*i).contains(Flags::ENGINE_OFF))
        .map(|(_, (((n, t), fuel), dt))| (*n, *t, *dt, fuel * dt))
        .filter(|(n, t, dt, g)| {
            n.is_finite() && t.is_finite() && *dt > 0.0 && g.is_finite() && *g > 0.0
        })
        .collect()
}
