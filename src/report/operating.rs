//! Where the engine runs: torque against speed, on its fuel map.
use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::PlotRun;
use super::axis::{Axis, number, range};
use super::figure::{Figure, Rect, UNITS, units};
use super::iso::{Circle, iso_lines, label};
use super::legend::{Mark, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::Stroke;
use crate::results::Flags;
use crate::results::columns::column;

pub(super) const RPM: f64 = 30.0 / PI;
pub(super) const RECT: Rect = Rect { left: LEFT + 8.0, top: 58.0, right: 760.0, bottom: 518.0 };
const STRIP: f64 = 190.0;
/// Points are gathered in squares of this size, pixels.
const CELL: f64 = 14.0;
/// Radius of the largest circle, pixels.
const LARGEST: f64 = 17.0;
const FULL_LOAD: Stroke = Stroke { colour: "#000000", width: 2.0, dash: &[] };
pub(super) const ISO: Stroke = Stroke { colour: "#8c8c8c", width: 1.0, dash: &[] };
const ZERO: Stroke = Stroke { colour: "#000000", width: 0.8, dash: &[] };
const CIRCLE: &str = "fill=\"#d55e00\" fill-opacity=\"0.6\" stroke=\"#5c2600\" stroke-width=\"3\"";

/// Time spent around one point.
#[derive(Clone, Copy, Debug, Default)]
struct Spot {
    seconds: f64,
    rpm_s: f64,
    nm_s: f64,
}

/// Engine torque against engine speed: circles whose area is the time spent there, over lines of
/// equal specific consumption and the full-load torque.
#[must_use]
pub fn operating_points(run: &PlotRun) -> String {
    let rows = points(run);
    let map = run.fuel_map.as_ref();
    let full_load: Vec<(f64, f64)> =
        map.map_or_else(Vec::new, |map| map.speed_rad_s.iter().zip(&map.full_load_nm).map(|(w, t)| (w * RPM, *t)).collect());
    let speeds = rows.iter().map(|p| p.0).chain(full_load.iter().map(|p| p.0));
    let torques = rows.iter().map(|p| p.1).chain(full_load.iter().map(|p| p.1));
    let x = Axis::round("Engine speed [rpm]", speeds, 9);
    let y = Axis::round("Engine torque [Nm]", torques.chain([0.0, overrun_room(&rows)]), 9);
    let size = (RECT.right + 16.0 + STRIP, RECT.bottom + BELOW + 6.0);
    let desc = describe(&rows, map.is_some());
    let mut figure = Figure::new(size, RECT.left, "Engine operating points", run.name, &desc);
    let panel = Panel::draw(&mut figure, RECT, x, y, true);
    if panel.y.low < 0.0 {
        panel.line(&mut figure, &[(panel.x.low, 0.0), (panel.x.high, 0.0)], ZERO);
    }
    let spots = gather(&panel, &rows);
    let most = spots.iter().map(|spot| spot.seconds).fold(0.0, f64::max);
    let radius = |seconds: f64| LARGEST * (seconds / most).sqrt();
    let centre = |spot: &Spot| (panel.px(spot.rpm_s / spot.seconds), panel.py(spot.nm_s / spot.seconds));
    let taken: Vec<Circle> = spots.iter().map(|spot| (centre(spot), radius(spot.seconds))).collect();
    let labels = map.map_or_else(Vec::new, |map| iso_lines(&mut figure, &panel, map, &full_load, &taken));
    panel.line(&mut figure, &full_load, FULL_LOAD);
    circles(&mut figure, &taken);
    label(&mut figure, labels);
    if spots.is_empty() {
        panel.empty(&mut figure);
    }
    keys(&mut figure, map.is_some(), most, radius);
    figure.finish()
}

fn circles(figure: &mut Figure, circles: &[Circle]) {
    for ((x, y), r) in circles {
        let (cx, cy, r) = (units(*x), units(*y), r * UNITS);
        figure.raw(&format!("<circle class=\"spot\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" {CIRCLE}/>"));
    }
}

/// Speed in rpm, torque in Nm and time of every row with the engine running.
fn points(run: &PlotRun) -> Vec<(f64, f64, f64)> {
    let (Some(speed), Some(torque)) = (column("engine_speed_rpm"), column("engine_torque_nm")) else {
        return Vec::new();
    };
    run.rows
        .iter()
        .filter(|row| !row.flags.contains(Flags::ENGINE_OFF))
        .map(|row| (speed.number(row), torque.number(row), row.dt_s))
        .filter(|(n, t, dt)| n.is_finite() && t.is_finite() && dt.is_finite() && *dt > 0.0)
        .collect()
}

/// A torque below the lowest one in overrun, for the lower half of its circle.
fn overrun_room(rows: &[(f64, f64, f64)]) -> f64 {
    let (low, high) = range(rows.iter().map(|p| p.1)).unwrap_or((0.0, 0.0));
    if low < 0.0 { low - 0.04 * (high - low) } else { 0.0 }
}

fn describe(rows: &[(f64, f64, f64)], with_map: bool) -> String {
    let speed = range(rows.iter().map(|p| p.0));
    let torque = range(rows.iter().map(|p| p.1));
    let Some(((slow, fast), (low, high))) = speed.zip(torque) else {
        return "Engine torque against speed, without data.".to_string();
    };
    let seconds: f64 = rows.iter().map(|p| p.2).sum();
    let map = if with_map { ", over lines of equal specific fuel consumption" } else { "" };
    format!(
        "Engine torque against speed{map}; circles in proportion to the time spent, {} s in all, from {} to {} rpm and from {} to {} Nm.",
        number(seconds, 1.0),
        number(slow, 1.0),
        number(fast, 1.0),
        number(low, 1.0),
        number(high, 1.0)
    )
}

/// Sums up the time in each square; most time first, so that small circles end up on top.
fn gather(panel: &Panel, rows: &[(f64, f64, f64)]) -> Vec<Spot> {
    let mut squares: BTreeMap<(i64, i64), Spot> = BTreeMap::new();
    for &(rpm, nm, dt) in rows {
        let square = ((panel.px(rpm) / CELL).floor() as i64, (panel.py(nm) / CELL).floor() as i64);
        let spot = squares.entry(square).or_default();
        spot.seconds += dt;
        spot.rpm_s += rpm * dt;
        spot.nm_s += nm * dt;
    }
    let mut spots: Vec<Spot> = squares.into_values().collect();
    spots.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    spots
}

fn keys(figure: &mut Figure, with_map: bool, most: f64, radius: impl Fn(f64) -> f64) {
    let (left, width) = (RECT.right + 16.0, STRIP - 8.0);
    let mut top = RECT.top;
    if with_map {
        let lines = [(Mark::Line(FULL_LOAD), "Full load".to_string()), (Mark::Line(ISO), "Consumption [g/kWh]".to_string())];
        top = legend(figure, (left, top), width, "", &lines) + 12.0;
    }
    if most > 0.0 {
        let entries: Vec<_> = [1.0, 0.2, 0.04]
            .iter()
            .map(|share| round_down(most * share))
            .map(|s| (Mark::Circle(radius(s), CIRCLE.to_string()), format!("{s} s")))
            .collect();
        legend(figure, (left, top), width, "Time spent [s]", &entries);
    }
}

/// 1, 2 or 5 times a power of ten, not above `x`.
fn round_down(x: f64) -> f64 {
    let power = 10f64.powf(x.log10().floor());
    let factor = [5.0, 2.0].into_iter().find(|f| x / power >= *f).unwrap_or(1.0);
    factor * power
}
