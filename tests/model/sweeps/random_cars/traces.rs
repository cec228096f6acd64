//! Random short cycles.

use std::fmt::{self, Write as _};

use cvtcycle_config::cycle::{Cycle, read_csv};
use cvtcycle_config::render;
use proptest::prelude::*;

/// A stretch with one acceleration.
#[derive(Clone, Debug)]
struct Leg {
    /// Speed at its end, km/h.
    to_kmh: f64,
    /// Largest acceleration and braking, m/s2.
    hard_m_s2: f64,
    /// Quarters of a second beyond what the acceleration needs: times are then exact in binary.
    more: u8,
    grade: f64,
    engine_off: bool,
}

/// A row of a cycle.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub time_s: f64,
    pub kmh: f64,
    pub grade: f64,
    pub engine_off: bool,
}

/// A cycle as rows.
#[derive(Clone)]
pub struct Rows(pub Vec<Point>);

impl fmt::Debug for Rows {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.csv(0.0, ("speed_kmh", |x| x), ("grade", |x| x)))
    }
}

fn leg() -> impl Strategy<Value = Leg> {
    let to = prop_oneof![2 => Just(0.0), 5 => 0.0..70.0, 2 => 60.0..130.0];
    let grade = prop_oneof![3 => Just(0.0), 1 => -0.08..0.08];
    (to, 0.2..3.5, 0_u8..40, grade, prop::bool::weighted(0.2)).prop_map(
        |(to_kmh, hard_m_s2, more, grade, engine_off)| Leg {
            to_kmh,
            hard_m_s2,
            more,
            grade,
            engine_off,
        },
    )
}

/// Up to some twenty legs: starts, stops, slopes, engine off at standstill, and stretches in which the acceleration changes its sign every
/// second.
pub fn traces() -> impl Strategy<Value = Rows> {
    let shake = prop::option::of((3_u8..12, 0.3..2.5, 0_usize..20));
    (
        prop_oneof![4 => Just(0.0), 1 => 5.0..90.0],
        prop::collection::vec(leg(), 1..20),
        shake,
    )
        .prop_map(|(first, legs, shake)| {
            let mut rows = vec![Point {
                time_s: 0.0,
                kmh: first,
                grade: 0.0,
                engine_off: false,
            }];
            for (k, leg) in legs.iter().enumerate() {
                add(&mut rows, leg);
                if let Some((count, accel, _)) = shake.filter(|shake| shake.2 == k) {
                    shaken(&mut rows, count, accel);
                }
            }
            Rows(rows)
        })
}

fn add(rows: &mut Vec<Point>, leg: &Leg) {
    let last = rows.len() - 1;
    let from = rows[last];
    let least_s = (leg.to_kmh - from.kmh).abs() / 3.6 / leg.hard_m_s2;
    let seconds = (4.0 * least_s).ceil() / 4.0 + 0.25 * f64::from(leg.more) + 0.25;
    let at_rest = from.kmh <= 0.0 && leg.to_kmh <= 0.0;
    // A row's slope and switch hold until the next one.
    rows[last].grade = leg.grade;
    rows[last].engine_off = at_rest && leg.engine_off;
    rows.push(Point {
        time_s: from.time_s + seconds,
        kmh: leg.to_kmh,
        grade: 0.0,
        engine_off: false,
    });
}

fn shaken(rows: &mut Vec<Point>, count: u8, accel_m_s2: f64) {
    for k in 0..count {
        let from = rows[rows.len() - 1];
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        let kmh = (from.kmh + sign * 3.6 * accel_m_s2).max(0.0);
        rows.push(Point {
            time_s: from.time_s + 1.0,
            kmh,
            ..from
        });
    }
}

/// How a number of a column is written.
pub type Write = fn(f64) -> f64;

impl Rows {
    /// The file, with its times moved and its speeds and slopes in other units.
    pub fn csv(&self, later_s: f64, speed: (&str, Write), grade: (&str, Write)) -> String {
        let mut text = format!("time_s,{},{},engine_off\n", speed.0, grade.0);
        for p in &self.0 {
            let (speed, grade) = (speed.1(p.kmh), grade.1(p.grade));
            writeln!(
                text,
                "{:?},{speed:?},{grade:?},{}",
                p.time_s + later_s,
                u8::from(p.engine_off)
            )
            .unwrap();
        }
        text
    }

    /// The cycle.
    pub fn cycle(&self) -> Cycle {
        read(&self.csv(0.0, ("speed_kmh", |x| x), ("grade", |x| x)))
    }
}

/// A cycle from the text of its file.
pub fn read(text: &str) -> Cycle {
    read_csv("random.csv", text.as_bytes())
        .unwrap_or_else(|problems| panic!("{}\n{text}", render(&problems, false)))
}
