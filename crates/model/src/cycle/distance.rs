//! A cycle over distance to one over time: the driver accelerates to the target speed of a row, holds it, and brakes ahead of a lower one.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CY-1 | the target of a row holds up to the next row, after a stop that of the row behind it; v2 = v1 + a dt with a of 1.0 m/s2 up and 1.5 m/s2 down, dt = 2 ds/(v1 + v2), so that the speed over time covers the distance exactly | derived: constant acceleration; the two accelerations ASSUMED, of a car in traffic (0.8 to 1.5, 1.0 to 2.0) |

/// A row: its place, the target speed from it on, and the time at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceRow {
    /// Distance from the first row, m.
    pub distance_m: f64,
    /// Target speed, m/s.
    pub speed_m_s: f64,
    /// Time at rest, s.
    pub stop_s: f64,
}

/// A stretch of constant acceleration, or a rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Index of its row.
    pub row: usize,
    /// Time at the start and at the end, s.
    pub time_s: [f64; 2],
    /// Speed at the start and at the end, m/s.
    pub speed_m_s: [f64; 2],
}

/// Acceleration of the driver, m/s2.
const UP_M_S2: f64 = 1.0;
/// Deceleration of the driver, m/s2.
const DOWN_M_S2: f64 = 1.5;

/// The drive over a table of rising distances. A stretch that is too short for a time of its own is left out.
#[must_use]
pub fn stretches(rows: &[DistanceRow]) -> Vec<Stretch> {
    let ends = speeds_m_s(rows);
    let mut drive = Drive {
        list: Vec::new(),
        time_s: 0.0,
    };
    for (k, pair) in rows.windows(2).enumerate() {
        drive.rest(k, &pair[0]);
        let length_m = length_m(pair);
        // The speed at which accelerating goes over into braking, if the target is not reached.
        let (from, to) = (ends[k], ends[k + 1]);
        let squares = DOWN_M_S2 * from * from + UP_M_S2 * to * to;
        let peak = (2.0 * UP_M_S2 * DOWN_M_S2 * length_m + squares) / (UP_M_S2 + DOWN_M_S2); // CY-1
        let top = peak.sqrt().min(target_m_s(pair)).max(from).max(to);
        let up_m = (top * top - from * from) / (2.0 * UP_M_S2);
        let down_m = (top * top - to * to) / (2.0 * DOWN_M_S2);
        let hold_m = length_m - up_m - down_m;
        // Without a stretch at the target the two others share what rounding leaves.
        match hold_m > 1e-9 * length_m {
            true => {
                drive.go(k, (from, top), up_m);
                drive.go(k, (top, top), hold_m);
                drive.go(k, (top, to), down_m);
            }
            false => {
                drive.go(k, (from, top), length_m - down_m);
                drive.go(k, (top, to), down_m);
            }
        }
    }
    if let Some(last) = rows.last() {
        drive.rest(rows.len() - 1, last);
    }
    drive.list
}

fn length_m(pair: &[DistanceRow]) -> f64 {
    pair[1].distance_m - pair[0].distance_m
}

/// The target between two rows: that of the first, or after a stop that of the second.
fn target_m_s(pair: &[DistanceRow]) -> f64 {
    let [from, to] = [pair[0].speed_m_s, pair[1].speed_m_s];
    if from > 0.0 { from } else { to }
}

/// The speed of the car at each row: what the targets on both sides and the two accelerations allow.
fn speeds_m_s(rows: &[DistanceRow]) -> Vec<f64> {
    let mut speeds: Vec<f64> = rows.iter().map(|row| row.speed_m_s).collect();
    for (k, pair) in rows.windows(2).enumerate() {
        let reached = (speeds[k] * speeds[k] + 2.0 * UP_M_S2 * length_m(pair)).sqrt(); // CY-1
        speeds[k + 1] = speeds[k + 1].min(target_m_s(pair)).min(reached);
    }
    for (k, pair) in rows.windows(2).enumerate().rev() {
        let next = speeds[k + 1];
        let stopped_from = (next * next + 2.0 * DOWN_M_S2 * length_m(pair)).sqrt(); // CY-1
        speeds[k] = speeds[k].min(stopped_from);
    }
    speeds
}

/// The stretches so far.
struct Drive {
    list: Vec<Stretch>,
    time_s: f64,
}

impl Drive {
    /// A stretch of constant acceleration; none without a length.
    fn go(&mut self, row: usize, speed_m_s: (f64, f64), length_m: f64) {
        let (from, to) = speed_m_s;
        if length_m > 0.0 {
            self.add(row, [from, to], 2.0 * length_m / (from + to)); // CY-1
        }
    }

    /// The time at rest of a row.
    fn rest(&mut self, k: usize, row: &DistanceRow) {
        if row.stop_s > 0.0 {
            self.add(k, [0.0, 0.0], row.stop_s);
        }
    }

    fn add(&mut self, row: usize, speed_m_s: [f64; 2], dt_s: f64) {
        let start_s = self.time_s;
        self.time_s += dt_s;
        if self.time_s > start_s {
            self.list.push(Stretch {
                row,
                time_s: [start_s, self.time_s],
                speed_m_s,
            });
        }
    }
}
