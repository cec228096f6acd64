//! Full-throttle times of a car: from one speed to another, over a distance, with the limit of grip.

use std::collections::BTreeMap;

use cvtcycle_model::drive::{Accelerated, Driven, FullThrottle, Grip, Row, Vehicle, accelerate};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::Bound;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::math::larger;
use cvtcycle_model::thermal::{COOLANT, SUMP, StartTemperatures};
use serde::Serialize;

/// A mile, m.
const MILE_M: f64 = 1609.344;
/// Way before the clock of US magazines starts: one foot, m.
const ROLLOUT_M: f64 = 0.3048;
/// Time between the rows of a printed trace, s.
const TRACE_S: f64 = 0.1;
/// Error of a row's energy balance from which the answer is none. The limit of a run.
const LEDGER: f64 = 1e-6;

/// Allowed speeds, km/h.
pub const SPEED_KMH: Bound = Bound::closed(0.0, 400.0);
/// Allowed friction coefficients.
pub const GRIP: Bound = Bound::closed(0.05, 2.0);
/// Allowed share of the weight on the driven axle.
pub const AXLE_SHARE: Bound = Bound::closed(0.2, 0.9);
/// Allowed height of the centre of mass over the wheelbase.
pub const HEIGHT_OVER_BASE: Bound = Bound::closed(0.0, 0.5);
/// Allowed slope, per cent.
pub const GRADE_PERCENT: Bound = Bound::closed(-30.0, 40.0);
/// Allowed time of a change of gear, s.
pub const SHIFT_S: Bound = Bound::closed(0.0, 3.0);
/// Allowed step, s.
pub const STEP_S: Bound = Bound::closed(0.005, 0.5);

/// Speeds or distance that is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Span {
    /// From one speed to another, m/s.
    Speeds(f64, f64),
    /// A distance from rest, m.
    Distance(f64),
}

impl Span {
    /// Speed at its begin, m/s.
    fn start_m_s(self) -> f64 {
        match self {
            Span::Speeds(from, _) => from,
            Span::Distance(_) => 0.0,
        }
    }
}

/// The usual spans with their names: 0 to 100 km/h, 0 to 60 mph, 80 to 120 km/h, a quarter mile and a kilometre from rest.
pub fn usual_spans() -> Vec<(String, Span)> {
    let kmh = |from: f64, to: f64| Span::Speeds(from / 3.6, to / 3.6);
    [
        ("0-100 km/h", kmh(0.0, 100.0)),
        ("0-60 mph", Span::Speeds(0.0, 60.0 * MILE_M / 3600.0)),
        ("80-120 km/h", kmh(80.0, 120.0)),
        ("quarter mile", Span::Distance(0.25 * MILE_M)),
        ("1000 m", Span::Distance(1000.0)),
    ]
    .map(|(name, span)| (name.to_owned(), span))
    .to_vec()
}

/// How the car is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Temperatures of the car.
    pub start: StartTemperatures,
    /// Slope of the road, rise over run.
    pub grade: f64,
    /// Grip; none without a limit.
    pub grip: Option<Grip>,
    /// Time of a change of gear, s.
    pub shift_s: f64,
    /// Gear of a manual box that is kept.
    pub gear: Option<u8>,
    /// Step, s.
    pub dt_s: f64,
}

/// Time of a span.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SpanTime {
    /// Name.
    pub span: String,
    /// Time, s; null where the car does not get there.
    pub time_s: Option<f64>,
    /// Difference to the time of twice the step, s: the error of the step is about as large or less (AC-5).
    pub error_s: Option<f64>,
    /// Speed at the end, km/h: the highest reached where the car does not get there.
    pub end_kmh: f64,
}

/// A drive from one speed, which one or more spans are of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drive {
    /// Speed at its begin, km/h.
    pub from_kmh: f64,
    /// Time over the first foot, which US magazines do not count, s; null from a speed.
    pub first_foot_s: Option<f64>,
    /// Time with the grip as the limit, s.
    pub grip_limited_s: f64,
    /// Highest speed, km/h.
    pub highest_kmh: f64,
    /// Changes of gear: time, s, and new gear.
    pub shifts: Vec<(f64, u8)>,
    /// Time with each flag that stood at all, s: `gross_slip` where the clamp does not hold the torque.
    pub flags_s: BTreeMap<String, f64>,
    /// Work at the driven wheels, kJ.
    pub wheel_work_kj: f64,
    /// Work of the crank, kJ: wheels, losses, accessories, and rotating parts.
    pub crank_work_kj: f64,
    /// Energy of the fuel, kJ.
    pub fuel_energy_kj: f64,
    /// Largest relative error of a row's power balance.
    pub ledger_error: f64,
    /// Events, by time.
    pub trace: Trace,
}

/// Columns of a drive, a row each tenth of a second.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Trace {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Speed, km/h.
    pub speed_kmh: Vec<f64>,
    /// Distance, m.
    pub distance_m: Vec<f64>,
    /// Acceleration, m/s2.
    pub accel_m_s2: Vec<f64>,
    /// Engine speed, rpm.
    pub engine_speed_rpm: Vec<f64>,
    /// Gear of a manual box; 0 for a CVT, and with the clutch open for a change.
    pub gear: Vec<u8>,
    /// Belt ratio; null for a manual box.
    pub belt_ratio: Vec<Option<f64>>,
    /// Power at the driven wheels, kW.
    pub wheel_power_kw: Vec<f64>,
}

/// Answer: the times, and the drives that they are of.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Times {
    /// A time for each span.
    pub spans: Vec<SpanTime>,
    /// The drives.
    pub drives: Vec<Drive>,
}

impl Times {
    /// Checks that failed, each as the end of a sentence.
    pub fn failed_checks(&self) -> Vec<&'static str> {
        let closes = |drive: &Drive| drive.ledger_error <= LEDGER;
        let solved = |drive: &Drive| !drive.flags_s.contains_key("not_converged");
        let all = [
            (
                self.drives.iter().all(closes),
                "the energy of a step does not balance",
            ),
            (self.drives.iter().all(solved), "a solve did not converge"),
        ];
        all.into_iter()
            .filter_map(|(good, words)| (!good).then_some(words))
            .collect()
    }
}

/// Times a car. Spans from the same speed are of one drive; each is driven with the step and with half of it, the second counts.
///
/// ```
/// use cvtcycle_analysis::accelerate::{Conditions, times, usual_spans};
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::Grip;
///
/// let car = load("rover_216_5mt", &Options::default())?;
/// let conditions = Conditions {
///     ambient_k: 298.15,
///     start: Default::default(),
///     grade: 0.0,
///     grip: Some(Grip::default()),
///     shift_s: 0.5,
///     gear: None,
///     dt_s: 0.2,
/// };
/// let found = times(&car, &usual_spans()[..2], &conditions);
/// let [to_100_kmh, to_60_mph] = [0, 1].map(|k| found.spans[k].time_s.unwrap_or(f64::NAN));
/// assert!(to_60_mph < to_100_kmh && (6.0..20.0).contains(&to_100_kmh));
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn times(vehicle: &Vehicle, spans: &[(String, Span)], conditions: &Conditions) -> Times {
    let car = vehicle.car(conditions.ambient_k);
    let mut starts: Vec<f64> = Vec::new();
    for (_, span) in spans {
        let from = span.start_m_s();
        if !starts.iter().any(|own| own.total_cmp(&from).is_eq()) {
            starts.push(from);
        }
    }
    let driven: Vec<[Accelerated; 2]> = starts
        .iter()
        .map(|from| {
            let own = spans
                .iter()
                .filter(|(_, span)| span.start_m_s().total_cmp(from).is_eq());
            let ends = own.map(|(_, span)| match span {
                Span::Speeds(_, to) => (*to, 0.0),
                Span::Distance(distance_m) => (0.0, *distance_m),
            });
            let (to_m_s, distance_m) =
                ends.fold((0.0, 0.0), |a, b| (larger(a.0, b.0), larger(a.1, b.1)));
            [conditions.dt_s, 0.5 * conditions.dt_s].map(|dt_s| {
                let asked = FullThrottle {
                    from_m_s: *from,
                    to_m_s,
                    distance_m,
                    grade: conditions.grade,
                    grip: conditions.grip,
                    shift_s: conditions.shift_s,
                    gear: conditions.gear,
                    heat: conditions.start.at(conditions.ambient_k),
                    dt_s,
                };
                accelerate(&car, &asked)
            })
        })
        .collect();
    let of = |(name, span): &(String, Span)| {
        let from = span.start_m_s();
        let place = starts.iter().position(|own| own.total_cmp(&from).is_eq());
        let [coarse, fine] = &driven[place.unwrap_or(0)];
        time(name, *span, coarse, fine)
    };
    Times {
        spans: spans.iter().map(of).collect(),
        drives: driven.iter().map(|[_, fine]| drive(fine)).collect(),
    }
}

fn time(name: &str, span: Span, coarse: &Accelerated, fine: &Accelerated) -> SpanTime {
    let time_s = |of: &Accelerated| match span {
        Span::Speeds(_, to) => of.time_to_speed_s(to),
        Span::Distance(distance_m) => of.at_distance(distance_m).map(|found| found.0),
    };
    let found = time_s(fine);
    let end_m_s = match (span, found) {
        (Span::Speeds(_, to), Some(_)) => to,
        (Span::Distance(distance_m), Some(_)) => {
            fine.at_distance(distance_m).map_or(0.0, |found| found.1)
        }
        (_, None) => fine.highest_m_s(),
    };
    SpanTime {
        span: name.to_owned(),
        time_s: found,
        error_s: found
            .zip(time_s(coarse))
            .map(|(fine, coarse)| (fine - coarse).abs()),
        end_kmh: 3.6 * end_m_s,
    }
}

fn drive(of: &Accelerated) -> Drive {
    let rows = || of.steps.iter().map(|step| &step.row);
    let sum_kj = |power_w: &dyn Fn(&Row) -> f64| {
        rows().map(|row| power_w(row) * row.dt_s).sum::<f64>() / 1e3
    };
    let mut trace = Trace::default();
    let mut next_s = 0.0;
    for step in &of.steps {
        if step.time_s < next_s - 1e-9 {
            continue;
        }
        next_s = (step.time_s / TRACE_S + 1e-9).floor() * TRACE_S + TRACE_S;
        let row = &step.row;
        trace.time_s.push(step.time_s);
        trace.speed_kmh.push(3.6 * step.speed_m_s);
        trace.distance_m.push(step.distance_m);
        trace.accel_m_s2.push(row.accel_m_s2);
        let rpm = row.engine_speed_rad_s * 30.0 / std::f64::consts::PI;
        trace.engine_speed_rpm.push(rpm);
        trace.gear.push(row.gear);
        let ratio = Some(row.belt_ratio).filter(|ratio| ratio.is_finite());
        trace.belt_ratio.push(ratio);
        trace.wheel_power_kw.push(row.wheel_power_w / 1e3);
    }
    Drive {
        from_kmh: 3.6 * of.from_m_s,
        first_foot_s: of
            .at_distance(ROLLOUT_M)
            .filter(|_| of.from_m_s <= 0.0)
            .map(|found| found.0),
        grip_limited_s: of.grip_limited_s(),
        highest_kmh: 3.6 * of.highest_m_s(),
        shifts: of.shifts.clone(),
        flags_s: flags_s(of),
        wheel_work_kj: sum_kj(&|row| row.wheel_power_w),
        crank_work_kj: sum_kj(&|row| {
            let lost: f64 = row.loss_w.iter().sum();
            row.wheel_power_w - row.deficit_w
                + lost
                + row.accessories_w
                + row.brake_w
                + row.kinetic_w
        }),
        fuel_energy_kj: sum_kj(&|row| row.fuel_power_w),
        ledger_error: rows().fold(0.0, |worst, row| {
            larger(row.power_ledger_error, larger(row.heat_ledger_error, worst))
        }),
        trace,
    }
}

fn flags_s(of: &Accelerated) -> BTreeMap<String, f64> {
    let seconds = |flag: Flags| -> f64 {
        let rows = of.steps.iter().map(|step| &step.row);
        let with = rows.filter(|row| row.flags.contains(flag));
        with.map(|row| row.dt_s).sum()
    };
    // The end speed of a step is sought so that rounding is all that is missing.
    let all = Flags::NAMES
        .iter()
        .filter(|(flag, _)| ![Flags::MISSED_TRACE, Flags::FULL_LOAD].contains(flag));
    let all = all.map(|(flag, name)| ((*name).to_owned(), seconds(*flag)));
    all.filter(|(_, seconds)| *seconds > 0.0).collect()
}

/// Grip of some wheels with the usual values; on a rear axle half of the weight. ASSUMED as AC-3 says.
pub fn usual_grip(driven: Driven) -> Grip {
    Grip {
        driven,
        axle_share: match driven {
            Driven::Rear => 0.5,
            Driven::Front | Driven::All => Grip::default().axle_share,
        },
        ..Grip::default()
    }
}

/// Names of the driven wheels.
pub const DRIVEN: [(&str, Driven); 3] = [
    ("front", Driven::Front),
    ("rear", Driven::Rear),
    ("all", Driven::All),
];

/// Temperatures of a warm car, K: coolant and engine oil 90, transmission oil 80 degC, tyres as ambient. ASSUMED: coolant 85 to 100, oil of the transmission 60
/// to 95 degC.
pub fn warm_car() -> StartTemperatures {
    let mut start = StartTemperatures::default();
    for (node, degc) in [(COOLANT, 90.0), (SUMP, 80.0)] {
        start.given_k[node] = Some(degc + ZERO_DEGC_K);
    }
    start
}
