//! Doubts about a recording: motions that no car has; likeness to drives that the caller knows.

use super::samples::Samples;
use crate::readable;

/// No road car gains speed as fast over a second, m/s2.
const FASTEST_M_S2: f64 = 7.0;
/// A drive whose largest acceleration is smaller is in slow motion, m/s2.
const SLOWEST_M_S2: f64 = 0.15;

/// Likeness of a recording to a shipped cycle.
#[derive(Debug, Default)]
pub(crate) struct Likeness {
    pub doubt: Option<String>,
    /// The same speeds.
    pub is_exact: bool,
}

/// Motions that no car has, and those of a clock that is too slow.
pub(crate) fn motions(samples: &Samples) -> Vec<String> {
    let mut doubts = Vec::new();
    let Some((first, last)) = samples.time_s.first().zip(samples.time_s.last()) else {
        return doubts;
    };
    let duration = last - first;
    let range = samples
        .speed_m_s
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
            (low.min(*v), high.max(*v))
        });
    // Over a second at least, so that noise does not count.
    let (mut behind, mut most) = (0, 0.0_f64);
    for k in 1..samples.time_s.len() {
        while samples.time_s[k] - samples.time_s[behind + 1] >= 1.0 && behind + 1 < k {
            behind += 1;
        }
        let step = samples.time_s[k] - samples.time_s[behind];
        if step >= 0.99 {
            most = most.max((samples.speed_m_s[k] - samples.speed_m_s[behind]) / step);
        }
    }
    if most > FASTEST_M_S2 {
        doubts.push(format!(
            "the car gains {} m/s2 over a second: are speed and time in the units that are stated?",
            readable(most, 1)
        ));
    }
    if duration > 60.0
        && range.1 - range.0 > 5.0
        && most < SLOWEST_M_S2
        && samples.time_s.len() >= 20
    {
        doubts.push(format!(
            "in {} s the car never gains more than {} m/s2: is the time in the unit that is stated?",
            readable(duration, 0),
            readable(most, 3)
        ));
    }
    doubts
}
