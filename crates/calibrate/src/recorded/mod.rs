//! Values of a car by its logs: idle, fuel cut, ratios, lock-up, operating lines and warm-up, each with an interval, and what they cannot tell.
//!
//! A calibration searches for values with which the model agrees with data. A log has engine speed, speed, fuel and temperatures next to each other, so that
//! these quantities can be read from it directly: no search, no prior, and no other part of the model has to be right. Only what needs a power or a heat
//! takes the car: the power at the wheels of its drive over the log, and how fast its own coolant warms on it.
//!
//! | file | content |
//! |---|---|
//! | `seconds` | the logs, second by second |
//! | `resample` | intervals from blocks of time (CL-1) |
//! | `idle` | idle speed and flow, engine at rest |
//! | `cut` | fuel cut in overrun |
//! | `ratio` | kind of gearbox, ends of the ratio, lock-up |
//! | `line` | operating line and line of overrun |
//! | `warm_up` | thermostat and heat capacity |
//! | `fragment` | the car with the values that were found, and their ranges as factors of a study |

mod cut;
mod fragment;
mod idle;
mod line;
mod ratio;
mod resample;
mod seconds;
mod warm_up;

pub use fragment::{ranges, vehicle};

use cvtcycle_config::Problems;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{ParamSet, Setup};
use ratio::Ratios;
use resample::Estimate;
use seconds::Second;
use serde::Serialize;

/// A log as it was read.
#[derive(Clone, Debug)]
pub struct RecordedLog {
    /// Name for people.
    pub name: String,
    /// The drive with its channels.
    pub cycle: Cycle,
}

/// A car that is known but for what its logs tell.
#[derive(Clone, Debug)]
pub struct KnownCar {
    /// Name or path.
    pub word: String,
    /// Values at the log's times.
    pub values: ParamSet,
}

/// Logs of one car, and what is known of it.
#[derive(Clone, Debug)]
pub struct Question {
    /// The logs.
    pub logs: Vec<RecordedLog>,
    /// The car; without one, what needs its mass, road load and rated power stays open.
    pub car: Option<KnownCar>,
    /// Ambient temperature of logs without that channel, degC.
    pub ambient_degc: f64,
}

/// A quantity that was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    /// Name.
    pub name: &'static str,
    /// Key of a vehicle file that it sets; none where it has none.
    pub key: Option<&'static str>,
    /// Label of its equation.
    pub label: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Ends of 90 % of the resamples (CL-1); none from too few blocks of time.
    pub range: Option<[f64; 2]>,
    /// Seconds, or events, that it is from.
    pub count: usize,
    /// Noun of the count.
    pub counted: &'static str,
    /// Value of the car's own files.
    pub before: Option<f64>,
}

impl Value {
    /// A quantity from seconds of the logs.
    fn of_seconds(
        name: &'static str,
        key: Option<&'static str>,
        label: &'static str,
        unit: &'static str,
        own: Estimate,
    ) -> Self {
        Value {
            name,
            key,
            label,
            unit,
            value: own.value,
            range: own.range,
            count: own.count,
            counted: "s",
            before: None,
        }
    }
}

/// Engine speed over something else.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Name.
    pub name: &'static str,
    /// Key of a vehicle file that it sets.
    pub key: &'static str,
    /// Label of its equation.
    pub label: &'static str,
    /// Unit of what it is over.
    pub unit: &'static str,
    /// Points with rising abscissae.
    pub points: Vec<LinePoint>,
    /// Root mean square of the engine speeds about the line, rpm.
    pub rms_rpm: f64,
    /// Share of the variance about the line that road speed explains.
    pub by_speed: f64,
}

/// Point of a line: the middle of a band.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinePoint {
    /// Abscissa: median of the band.
    pub x: f64,
    /// Engine speed, rpm: median of the band.
    pub rpm: f64,
    /// Ends of 90 % of its resamples (CL-1), rpm.
    pub range: Option<[f64; 2]>,
    /// Quartiles of the engine speeds in the band, rpm.
    pub quartiles: [f64; 2],
    /// Seconds in the band.
    pub seconds: usize,
}

/// A log in a sentence.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Head {
    /// Name.
    pub name: String,
    /// Duration, s.
    pub duration_s: f64,
    /// Distance, km.
    pub distance_km: f64,
    /// Channels besides time and speed.
    pub channels: Vec<String>,
    /// Repairs and doubts of the reader, a sentence each.
    pub said: Vec<String>,
}

/// Findings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// The logs.
    pub logs: Vec<Head>,
    /// Name or path of the car.
    pub car: Option<String>,
    /// Quantities.
    pub values: Vec<Value>,
    /// Lines.
    pub lines: Vec<Line>,
    /// Doubts about them, a sentence each.
    pub doubts: Vec<String>,
    /// Quantities that the logs cannot tell, with the reason, a sentence each.
    pub cannot_tell: Vec<String>,
}

/// Findings while they are collected.
struct Found<'q> {
    question: &'q Question,
    setup: Option<Setup>,
    seconds: Vec<Second>,
    ratios: Ratios,
    findings: Findings,
}

impl Found<'_> {
    /// True if the car has this key, or no car is known.
    fn has(&self, key: &str) -> bool {
        let car = self.question.car.as_ref();
        car.is_none_or(|car| car.values.param(key).is_ok_and(|param| param.is_active()))
    }

    /// Value of a key of the car.
    fn of_car(&self, key: &str) -> Option<f64> {
        let param = self.question.car.as_ref()?.values.param(key).ok()?;
        Some(param.base()).filter(|value| value.is_finite())
    }

    /// Adds a quantity, with its value before; its key stays where the car has it.
    fn add(&mut self, value: Value) {
        let before = value.key.and_then(|key| self.of_car(key));
        let key = value.key.filter(|key| self.has(key));
        self.findings.values.push(Value {
            key,
            before,
            ..value
        });
    }

    /// Quantity of a name that was found before.
    fn value(&self, name: &str) -> Option<f64> {
        let mut values = self.findings.values.iter();
        values.find(|own| own.name == name).map(|own| own.value)
    }

    fn cannot(&mut self, what: impl Into<String>) {
        self.findings.cannot_tell.push(what.into());
    }
}

/// Reads what the logs of a car tell of it.
///
/// # Errors
/// The car does not take a heat capacity that its warm-up needs.
pub fn estimate(question: &Question) -> Result<Findings, Problems> {
    let setup = question
        .car
        .as_ref()
        .map(|car| Setup::from_params(&car.values));
    let seconds = seconds::of(question, setup.as_ref());
    let mut found = Found {
        question,
        ratios: Ratios::of_car(setup.as_ref()),
        setup,
        seconds,
        findings: Findings {
            logs: question.logs.iter().map(head).collect(),
            car: question.car.as_ref().map(|car| car.word.clone()),
            values: Vec::new(),
            lines: Vec::new(),
            doubts: Vec::new(),
            cannot_tell: Vec::new(),
        },
    };
    found.missing();
    idle::find(&mut found);
    ratio::find(&mut found);
    cut::find(&mut found);
    line::find(&mut found);
    warm_up::find(&mut found)?;
    found.cannot(
        "torque of the engine, losses of the box, slip of belt and tyres, clamp pressure: no channel of them is in a log of this kind",
    );
    Ok(found.findings)
}

impl Found<'_> {
    /// Channels that no log has.
    fn missing(&mut self) {
        let has = |of: fn(&Second) -> Option<f64>| self.seconds.iter().any(|own| of(own).is_some());
        let (engine, fuel) = (has(|own| own.rpm), has(|own| own.fuel_g_s));
        let coolant = has(|own| own.coolant_degc);
        let sloped = |log: &RecordedLog| {
            log.cycle
                .manual
                .intervals
                .iter()
                .any(|own| own.grade.abs() > 0.0)
        };
        let has_slope = self.question.logs.iter().any(sloped);
        let list = [
            (
                !engine,
                "idle, ratios, lock-up, fuel cut and lines: there is no channel of the engine's speed",
            ),
            (
                !fuel,
                "fuel cut, idle flow: there is no channel of the fuel's flow",
            ),
            (
                !coolant,
                "warm-up, and idle and lines of the cold car: there is no channel of the coolant; the first ten minutes are left out",
            ),
            (
                self.question.car.is_none(),
                "operating line and heat capacity: these need mass, road load and rated power of a car, and none is named",
            ),
            (
                !has_slope,
                "slopes: the power at the wheels is that of a level road",
            ),
        ];
        for (_, what) in list.into_iter().filter(|(is, _)| *is) {
            self.cannot(what);
        }
    }
}

/// A log in a sentence.
fn head(log: &RecordedLog) -> Head {
    let trace = &log.cycle.manual;
    let recording = log.cycle.recording.as_deref();
    let channels = recording.map_or(&[][..], |own| &own.measured);
    let repairs = recording.map_or(&[][..], |own| &own.repairs);
    let doubts = recording.map_or(&[][..], |own| &own.doubts);
    Head {
        name: log.name.clone(),
        duration_s: trace.duration_s(),
        distance_km: trace.distance_m() / 1e3,
        channels: channels
            .iter()
            .map(|own| own.quantity.replace('_', " "))
            .collect(),
        said: repairs
            .iter()
            .map(|own| own.what.clone())
            .chain(doubts.iter().cloned())
            .collect(),
    }
}
