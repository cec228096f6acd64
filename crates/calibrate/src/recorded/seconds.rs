//! Logs second by second.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-2 | warm: coolant from 70 degC on; without that channel from 600 s after the log begins | ASSUMED: idle and shifting are those of a warm car from 60 to 71 degC on (EN-1, RC-11) |

use super::Question;
use super::resample::BLOCK_S;
use cvtcycle_config::cycle::{Cycle, Measured};
use cvtcycle_config::setup::{Setup, start_of_log};
use cvtcycle_model::drive::{Conditions, Row, Start, drive};
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use std::f64::consts::PI;

/// Coolant of a warm car, degC (CL-2).
pub const WARM_DEGC: f64 = 70.0;
/// Time after which a car without that channel is warm, s (CL-2).
const WARM_S: f64 = 600.0;
/// Speeds below are rest, km/h.
pub const REST_KMH: f64 = 0.3;
/// Speed of the engine below which it rests, rpm.
pub const OFF_RPM: f64 = 200.0;

/// A second of a log: means, but for the speeds at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Second {
    /// Log.
    pub log: usize,
    /// Begin, s from the start of the log.
    pub start_s: f64,
    /// Block of time (CL-1).
    pub block: usize,
    /// Speeds at begin and end, km/h.
    pub ends_kmh: [f64; 2],
    pub rpm: Option<f64>,
    pub fuel_g_s: Option<f64>,
    pub coolant_degc: Option<f64>,
    /// Power at the wheels over the rated power of the car, per cent.
    pub share: Option<f64>,
    /// Coolant and fuel of the computed car.
    pub computed: Option<Computed>,
}

/// The car that drives the log, in the same second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Computed {
    pub coolant_degc: f64,
    pub fuel_g_s: f64,
}

impl Second {
    /// Mean speed, km/h.
    pub fn kmh(&self) -> f64 {
        0.5 * (self.ends_kmh[0] + self.ends_kmh[1])
    }

    /// Acceleration, m/s2.
    pub fn accel(&self) -> f64 {
        (self.ends_kmh[1] - self.ends_kmh[0]) / 3.6
    }

    /// True where the car rests.
    pub fn rests(&self) -> bool {
        self.ends_kmh[0].max(self.ends_kmh[1]) < REST_KMH
    }

    /// True where the car is warm (CL-2).
    pub fn is_warm(&self) -> bool {
        match self.coolant_degc {
            Some(degc) => degc >= WARM_DEGC, // CL-2
            None => self.start_s >= WARM_S,
        }
    }

    /// Engine speed over road speed, rpm per km/h, of a running engine and a car that moves.
    pub fn rpm_per_kmh(&self) -> Option<f64> {
        let moving = self.kmh() > 3.0;
        let running = self.rpm.filter(|rpm| *rpm > OFF_RPM);
        running.filter(|_| moving).map(|rpm| rpm / self.kmh())
    }

    /// True if this is the next second of the same log.
    pub fn follows(&self, before: &Second) -> bool {
        self.log == before.log && (self.start_s - before.start_s - 1.0).abs() < 0.5
    }
}

/// Ambient temperature of a log, degC: that of its channel, else the one that is given.
pub fn ambient_degc(cycle: &Cycle, given: f64) -> f64 {
    let recording = cycle.recording.as_deref();
    recording
        .and_then(|own| own.first("ambient"))
        .unwrap_or(given)
}

/// The car on a log, from the temperatures with which the log begins.
pub fn driven(setup: &Setup, cycle: &Cycle, given: f64) -> Vec<Row> {
    let recording = cycle.recording.as_deref();
    let start = recording.and_then(start_of_log);
    let conditions = Conditions {
        ambient_k: ambient_degc(cycle, given) + ZERO_DEGC_K,
        start: start.map_or(Start::Soak, Start::Nodes),
        max_dt_s: 1.0,
        keep_rows: true,
    };
    drive(setup, cycle, &conditions).rows
}

/// The seconds of all logs.
pub fn of(question: &Question, setup: Option<&Setup>) -> Vec<Second> {
    let mut list = Vec::new();
    for (number, log) in question.logs.iter().enumerate() {
        let rows = setup.map(|setup| driven(setup, &log.cycle, question.ambient_degc));
        let rated_w = setup.map_or(1.0, |setup| setup.engine().rated_w);
        let first_block = list.last().map_or(0, |last: &Second| last.block + 1);
        of_log(
            &log.cycle,
            rows.as_deref(),
            rated_w,
            (number, first_block),
            &mut list,
        );
    }
    list
}

fn of_log(
    cycle: &Cycle,
    rows: Option<&[Row]>,
    rated_w: f64,
    (log, first_block): (usize, usize),
    list: &mut Vec<Second>,
) {
    let channel = |name: &str| {
        let measured = cycle
            .recording
            .as_deref()
            .map_or(&[][..], |own| &own.measured);
        measured.iter().find(|own| own.quantity == name)
    };
    let [engine, fuel, coolant] = ["engine_speed", "fuel", "coolant"].map(channel);
    let trace = &cycle.manual;
    let count = trace.duration_s().floor() as usize;
    let mut at = 0;
    let mut speed_at = |time_s: f64| {
        while at + 1 < trace.intervals.len() && trace.intervals[at].end_s < time_s {
            at += 1;
        }
        let own = &trace.intervals[at];
        let share = ((time_s - own.start_s) / (own.end_s - own.start_s)).clamp(0.0, 1.0);
        3.6 * (own.start_speed_m_s + share * (own.end_speed_m_s - own.start_speed_m_s))
    };
    let mut rows = rows.map(|rows| rows.iter().peekable());
    let mut before_kmh = speed_at(0.0);
    for k in 0..count {
        let (start_s, end_s) = (k as f64, k as f64 + 1.0);
        let after_kmh = speed_at(end_s);
        let mean = |own: Option<&Measured>| own.and_then(|own| own.mean(start_s, end_s));
        let (mut seconds, mut power_j, mut fuel_kg, mut coolant_k) = (0.0, 0.0, 0.0, f64::NAN);
        if let Some(rows) = &mut rows {
            while let Some(row) = rows.next_if(|row| row.time_s - 0.5 * row.dt_s < end_s) {
                seconds += row.dt_s;
                power_j += row.dt_s * row.wheel_power_w;
                fuel_kg += row.dt_s * row.fuel_kg_s;
                coolant_k = row.coolant_k;
            }
        }
        list.push(Second {
            log,
            start_s,
            block: first_block + (start_s / BLOCK_S) as usize,
            ends_kmh: [before_kmh, after_kmh],
            rpm: mean(engine).map(|rad_s| rad_s * 30.0 / PI),
            fuel_g_s: mean(fuel).map(|kg_s| 1e3 * kg_s),
            coolant_degc: mean(coolant),
            share: (seconds > 0.0).then(|| 100.0 * power_j / seconds / rated_w),
            computed: (seconds > 0.0).then(|| Computed {
                coolant_degc: coolant_k - ZERO_DEGC_K,
                fuel_g_s: 1e3 * fuel_kg / seconds,
            }),
        });
        before_kmh = after_kmh;
    }
}
