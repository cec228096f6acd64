//! Operating line and line of overrun.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-12 | drive: median engine speed in bands of the power at the wheels over rated power (mean with the second before, within 4 %, or a third of itself, of that two seconds before), at its median; warm car, above 30 km/h, ratio 3 % off its ends, engine speed within 5 % of the second before | definition: RC-13 has engine speed over that share; power by the car on the drive of the log |
//! | CL-13 | overrun: the same in bands of road speed while the wheels give power | definition: RC-13 |
//! | CL-14 | share of the variance about the line that a straight line over road speed explains | definition |

use super::idle::seconds;
use super::resample::{median, quantile};
use super::seconds::Second;
use super::{Found, Line, LinePoint};

/// Edges of the bands of power, per cent of rated power.
const SHARES: [f64; 14] = [
    0.5, 3.0, 6.0, 9.0, 12.0, 16.0, 20.0, 25.0, 30.0, 40.0, 50.0, 65.0, 80.0, 100.0,
];
/// Edges of the bands of road speed, km/h.
const SPEEDS: [f64; 10] = [
    15.0, 25.0, 35.0, 45.0, 55.0, 70.0, 85.0, 100.0, 120.0, 150.0,
];
/// Fewest seconds of a band.
const FEWEST: usize = 10;
/// Part of the variance from which road speed is said to matter (CL-14).
const BY_SPEED: f64 = 0.2;

/// A second on a line.
#[derive(Clone, Copy)]
struct On {
    block: usize,
    x: f64,
    rpm: f64,
    kmh: f64,
}

pub fn find(found: &mut Found) {
    if found.setup.is_none() || !found.seconds.iter().any(|own| own.rpm.is_some()) {
        return;
    }
    let drive: Vec<On> = found
        .seconds
        .windows(3)
        .filter_map(|own| drives(found, own))
        .collect();
    let overrun: Vec<On> = found.seconds.windows(2).filter_map(overruns).collect();
    let lines = [
        (
            "operating line",
            "transmission.cvt.ratio.drive_line",
            "CL-12",
            "% of rated power",
            &drive,
            &SHARES[..],
        ),
        (
            "line of overrun",
            "transmission.cvt.ratio.overrun_line",
            "CL-13",
            "km/h",
            &overrun,
            &SPEEDS[..],
        ),
    ];
    for (name, key, label, unit, on, edges) in lines {
        let on: Vec<On> = on.iter().copied().filter(|own| own.x >= edges[0]).collect();
        let on = &on;
        let points = points(on, edges);
        if points.len() < 2 {
            found.cannot(format!(
                "{name}: {} on it, in {} with {FEWEST} or more",
                seconds(on.len()),
                bands(points.len())
            ));
            continue;
        }
        let (rms_rpm, by_speed) = about(on, &points);
        if let Some(last) = points
            .last()
            .filter(|last| last.x < 0.5 * edges[edges.len() - 1])
        {
            found.cannot(format!(
                "{name} above {} {unit}: it is as long as the log drives it",
                last.x.round()
            ));
        }
        if label == "CL-12" && by_speed > BY_SPEED {
            found.findings.doubts.push(format!(
                "road speed explains {} % of what the {name} leaves: the car shifts by power and speed, and a line over power is its mean on this drive",
                (100.0 * by_speed).round()
            ));
        }
        found.findings.lines.push(Line {
            name,
            key,
            label,
            unit,
            points,
            rms_rpm,
            by_speed,
        });
    }
}

fn bands(count: usize) -> String {
    match count {
        1 => "1 band".to_owned(),
        n => format!("{n} bands"),
    }
}

/// The last of three seconds, if it is on the operating line (CL-12).
fn drives(found: &Found, own: &[Second]) -> Option<On> {
    let [first, before, last] = own else {
        return None;
    };
    let ratio = last.rpm_per_kmh()?;
    let share = 0.5 * (last.share? + before.share?);
    let even = (last.share? - first.share?).abs() < f64::max(4.0, share / 3.0);
    let holds = (last.rpm? / before.rpm?).ln().abs() < 0.05;
    let off = |end: Option<f64>| end.is_none_or(|end| (ratio / end).ln().abs() > 0.03);
    let inside = off(found.ratios.low) && off(found.ratios.high);
    let follows = last.follows(before) && before.follows(first);
    let fits =
        follows && even && holds && inside && share > 0.0 && last.is_warm() && last.kmh() > 30.0;
    fits.then_some(On {
        block: last.block,
        x: share,
        rpm: last.rpm?,
        kmh: last.kmh(),
    }) // CL-12
}

/// The last of two seconds, if it is on the line of overrun (CL-13).
fn overruns(own: &[Second]) -> Option<On> {
    let [before, last] = own else {
        return None;
    };
    let pulled = last.share? < -0.5 && before.share? < -0.5;
    let running = last.rpm_per_kmh().is_some();
    let fits = last.follows(before) && pulled && running && last.is_warm();
    fits.then_some(On {
        block: last.block,
        x: last.kmh(),
        rpm: last.rpm?,
        kmh: last.kmh(),
    }) // CL-13
}

/// Points of bands with enough seconds.
fn points(on: &[On], edges: &[f64]) -> Vec<LinePoint> {
    let band = |pair: &[f64]| {
        let inside = on.iter().filter(|own| (pair[0]..pair[1]).contains(&own.x));
        let list: Vec<(usize, f64)> = inside.clone().map(|own| (own.block, own.rpm)).collect();
        let mut at: Vec<f64> = inside.map(|own| own.x).collect();
        let own = median(&list).filter(|own| own.count >= FEWEST)?;
        let mut speeds: Vec<f64> = list.iter().map(|(_, rpm)| *rpm).collect();
        let mut quarter = |share| quantile(&mut speeds, share).unwrap_or(own.value);
        Some(LinePoint {
            x: quantile(&mut at, 0.5)?,
            rpm: own.value,
            range: own.range,
            quartiles: [quarter(0.25), quarter(0.75)],
            seconds: own.count,
        })
    };
    edges.windows(2).filter_map(band).collect()
}

/// Root mean square about the line, rpm, and the share of that which road speed explains (CL-14).
fn about(on: &[On], points: &[LinePoint]) -> (f64, f64) {
    let line = |x: f64| {
        let behind = points
            .partition_point(|own| own.x < x)
            .clamp(1, points.len() - 1);
        let (a, b) = (&points[behind - 1], &points[behind]);
        let share = ((x - a.x) / (b.x - a.x)).clamp(0.0, 1.0);
        a.rpm + share * (b.rpm - a.rpm)
    };
    let count = on.len() as f64;
    let left: Vec<(f64, f64)> = on
        .iter()
        .map(|own| (own.kmh, own.rpm - line(own.x)))
        .collect();
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| left.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|own| own.0), mean(&|own| own.1));
    let xx = mean(&|own| (own.0 - x).powi(2));
    let yy = mean(&|own| (own.1 - y).powi(2));
    let xy = mean(&|own| (own.0 - x) * (own.1 - y));
    let by_speed = match xx > 0.0 && yy > 0.0 {
        true => xy * xy / (xx * yy), // CL-14
        false => 0.0,
    };
    (mean(&|own| own.1 * own.1).sqrt(), by_speed)
}
