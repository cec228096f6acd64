//! Titles of the rig's figures: sentences with numbers of the drawn points.

use super::PrintedMark;
use crate::charts::engine;
use crate::number::grouped;
use cvtcycle_model::rig::BenchPoint;
use cvtcycle_output::number::signed;
use cvtcycle_output::rig::rpm;

/// Preferred speed of single numbers, rpm: that of the transients of thesis 5.3.2.
const SHOWN_RPM: f64 = 2500.0;

/// Distance of a point from that speed, rpm.
pub(super) fn from_shown(set: &BenchPoint) -> f64 {
    (rpm(set) - SHOWN_RPM).abs()
}

/// Minimum and maximum of the finite values.
pub(super) fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    engine::range(values)
}

/// Mean of the finite values; NaN if there are none.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let finite = values.filter(|x| x.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / count
}

/// Maximum distance of values at one place.
pub(super) fn apart(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut points: Vec<(f64, f64)> = points.filter(|p| p.1.is_finite()).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = points.chunk_by(|a, b| (a.0 - b.0).abs() < 1e-6);
    let spans = same.filter_map(|chunk| range(chunk.iter().map(|p| p.1)));
    spans.map(|(low, high)| high - low).fold(0.0, f64::max)
}

/// "8.3 to 12.6 Nm".
fn span((low, high): (f64, f64), unit: &str) -> String {
    format!("{} to {} {unit}", grouped(low, 1), grouped(high, 1))
}

const NOTHING: &str = "No point was solved";

pub(super) fn loss(range: Option<(f64, f64)>, place: &str, printed: &[PrintedMark]) -> String {
    let Some(range) = range else {
        return NOTHING.to_owned();
    };
    let printed = printed.first().map_or_else(String::new, |mark| {
        let [low, high] = mark.y.map(cvtcycle_output::number::plain);
        format!("; the thesis prints {low} to {high}")
    });
    format!(
        "Without load the box loses {} {place}{printed}",
        span(range, "Nm")
    )
}

pub(super) fn pressure(range: Option<(f64, f64)>, apart: f64, place: &str) -> String {
    let Some(range) = range else {
        return NOTHING.to_owned();
    };
    format!(
        "Secondary pressure is {} {place}; the oil's temperature changes it by {} bar at most",
        span(range, "bar"),
        grouped(apart, 1)
    )
}

pub(super) fn load(added: Option<(f64, f64)>, max_nm: f64, place: &str) -> String {
    let Some((low, high)) = added else {
        return "One torque alone was tested".to_owned();
    };
    let [low, high] = [low, high].map(|x| signed(x, 2));
    let max = cvtcycle_output::number::plain(max_nm);
    format!("{max} Nm at the output change the loss by {low} to {high} Nm {place}")
}

pub(super) fn transient(widest: Option<(f64, f64)>, place: &str) -> String {
    match widest {
        Some((gap, _)) if gap > 0.0 => format!(
            "At the same oil temperature a box that cools loses up to {} Nm more {place}",
            grouped(gap, 2)
        ),
        _ => format!("Cooling costs no more than warming {place}"),
    }
}

pub(super) fn second_box(pressure: f64, gap_nm: f64, place: &str) -> String {
    let less = 100.0 * (1.0 - pressure);
    let more = if less < 0.0 { "more" } else { "less" };
    format!(
        "{} % {more} pressure changes the loss by {} Nm {place}, on average",
        cvtcycle_output::number::plain((less.abs() * 10.0).round() / 10.0),
        signed(gap_nm, 2)
    )
}

/// `left`: speed, temperature and the remaining loss of each stage.
pub(super) fn stages(left: Option<(f64, f64, [f64; 5])>, place: &str) -> String {
    let Some((rpm, degc, losses)) = left else {
        return NOTHING.to_owned();
    };
    let losses = losses.map(|nm| grouped(nm, 1)).join(", ");
    format!(
        "Part by part {losses} Nm are left {place} ({} rpm, {degc} \u{b0}C)",
        grouped(rpm, 0)
    )
}

/// `sums` of each piece over the drawn points.
pub(super) fn contributions(sums: &[(&str, f64)], place: &str) -> String {
    let all: f64 = sums.iter().map(|(_, nm)| nm).sum();
    let mut order = sums.to_vec();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    match order.as_slice() {
        [(a, first), (b, second), ..] if all > 0.0 => format!(
            "{a} and {} are {} % of the loss without load {place}",
            b.to_lowercase(),
            grouped(100.0 * (first + second) / all, 0)
        ),
        _ => NOTHING.to_owned(),
    }
}

pub(super) fn components(more_nm: f64, place: &str) -> String {
    let whose = if more_nm < 0.0 {
        "too little"
    } else {
        "too much"
    };
    format!(
        "The strip-down gives the final drive {} Nm {whose} {place}, on average: it is the belt's",
        grouped(more_nm.abs(), 2)
    )
}
