//! Doubts about a recording: motions that no car has; likeness to drives that the caller knows.

use super::samples::Samples;
use crate::readable;
use cvtcycle_model::cycle::is_standstill;

/// No road car gains speed as fast over a second, m/s2.
const FASTEST_M_S2: f64 = 7.0;
/// A drive whose largest acceleration is smaller is in slow motion, m/s2.
const SLOWEST_M_S2: f64 = 0.15;

/// Starts at least, and how long each is looked at, s.
const START: (usize, f64) = (3, 4.0);
/// The liveliest start of the slowest shipped cycle has 0.60 m/s2 (WLTC class 1), that of Artemis urban in m/s, taken for km/h, 0.51.
const SLOWEST_START_M_S2: f64 = 0.55;
/// Mean of the slopes of mountain roads, per cent.
const STEEPEST_MEAN: f64 = 8.0;

/// Likeness of a recording to a shipped cycle.
#[derive(Debug, Default)]
pub(crate) struct Likeness {
    pub doubt: Option<String>,
    /// The same speeds.
    pub is_exact: bool,
    /// Name of the cycle that it is like.
    pub cycle: Option<String>,
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
    doubts.extend(starts(samples));
    doubts
}

/// Starts from rest that are all slower than those of any schedule: speeds in m/s that are taken for km/h have a quarter of theirs.
fn starts(samples: &Samples) -> Option<String> {
    let (time, speed) = (&samples.time_s, &samples.speed_m_s);
    let mut gains: Vec<f64> = Vec::new();
    for k in 1..time.len() {
        if !is_standstill(speed[k - 1]) || is_standstill(speed[k]) {
            continue;
        }
        let at = time[k - 1] + START.1;
        let end = (k..time.len()).find(|k| time[*k] >= at)?;
        let share = (at - time[end - 1]) / (time[end] - time[end - 1]);
        let own = speed[end - 1] + share.clamp(0.0, 1.0) * (speed[end] - speed[end - 1]);
        gains.push(own / START.1);
    }
    let most = gains.iter().copied().fold(0.0, f64::max);
    let is_slow = gains.len() >= START.0 && most < SLOWEST_START_M_S2;
    is_slow.then(|| {
        format!(
            "in {} starts from rest the car gains at most {} m/s2 over {} s: is the speed in the unit that is stated?",
            gains.len(),
            readable(most, 2),
            readable(START.1, 0)
        )
    })
}

/// Slopes that no drive has on average, as where per cent are read as a share.
pub(crate) fn steep(grades: impl Iterator<Item = f64>) -> Option<String> {
    let (count, sum) = grades.fold((0.0, 0.0), |(count, sum), grade| {
        (count + 1.0, sum + grade.abs())
    });
    let mean = 100.0 * sum / f64::max(count, 1.0);
    (count >= 20.0 && mean > STEEPEST_MEAN).then(|| {
        format!(
            "the road rises or falls by {} % on average: is the slope in the unit that is stated?",
            readable(mean, 1)
        )
    })
}
