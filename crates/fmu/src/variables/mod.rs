//! Variables of a unit. A row has name, causality, unit, start, range, meaning, and the source of its value.
//!
//! Names follow the pattern of Japan's METI guideline for plant models, as TRAMI's transmission models use it: quantity, part (`ENG` engine,
//! `FW` flywheel, `DS` drive shaft, `AT` transmission, `HYD` hydraulics, `GB` gearbox, `VEH` vehicle), `PNT` for a plant, direction, unit.

pub mod car;
pub mod forward;
pub mod point;

use cvtcycle_model::drive::{Car, Row, Turned};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::rig::{BenchAnswer, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::{ByComponent, Component};
use cvtcycle_model::transmission::cvt::Cvt;

/// Kind of unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Whole car that follows a speed, from the wheels back to the fuel.
    Car,
    /// Losses of a transmission at an operating point, with the launch device locked.
    Losses,
    /// CVT with launch device and ratio rate, driven by a torque.
    Cvt,
}

impl Kind {
    /// Names on the command line.
    pub const NAMES: [(&'static str, Kind); 3] = [
        ("car", Kind::Car),
        ("losses", Kind::Losses),
        ("cvt", Kind::Cvt),
    ];

    /// True if a car with this transmission can be such a unit.
    #[must_use]
    pub fn fits(self, transmission: &Transmission) -> bool {
        self != Kind::Cvt || transmission.is_cvt()
    }

    /// Name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// Description in a phrase.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Kind::Car => "whole car, backward: follows a speed; fuel, heat, losses",
            Kind::Losses => "losses and heat of the transmission at an operating point",
            Kind::Cvt => "CVT with launch device, forward: torque in, torque out; losses, heat",
        }
    }
}

/// Role of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Causality {
    /// Time.
    Independent,
    /// Set before the start.
    Parameter,
    /// Set before each step.
    Input,
    /// Computed.
    Output,
}

/// Source of the outputs of a car.
#[derive(Clone, Copy, Debug)]
pub struct CarResult<'a> {
    /// The last step.
    pub row: &'a Row,
    /// Fuel since the start, kg.
    pub fuel_kg: f64,
    /// Distance since the start, m.
    pub distance_m: f64,
    /// The car.
    pub car: &'a Car,
}

/// Source of the outputs of an operating point.
#[derive(Clone, Copy, Debug)]
pub struct LossResult {
    /// Requested point.
    pub point: BenchPoint,
    /// Losses and speeds computed there.
    pub answer: BenchAnswer,
}

/// Source of the outputs of a CVT driven by a torque.
#[derive(Clone, Copy, Debug)]
pub struct CvtResult<'a> {
    /// The last step.
    pub turned: &'a Turned,
    /// Belt temperature at the end of the step, K.
    pub belt_k: f64,
    /// The box.
    pub cvt: &'a Cvt,
}

/// Source of a variable's value.
#[derive(Clone, Copy, Debug)]
pub enum Get {
    /// Stored value.
    Stored,
    /// Computed from a step of the car.
    Car(fn(&CarResult) -> f64),
    /// Computed from an operating point.
    Losses(fn(&LossResult) -> f64),
    /// Computed from a step of the CVT driven by a torque.
    Cvt(fn(&CvtResult) -> f64),
    /// Power loss of a component, W.
    Loss(Component),
}

/// Variable; its value reference is its index in the table.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// Role.
    pub causality: Causality,
    /// Unit as in [`UNITS`]; `1` for none.
    pub unit: &'static str,
    /// True for an integer.
    pub whole: bool,
    /// Start value of an input or parameter.
    pub start: f64,
    /// Minimum and maximum of an input or parameter.
    pub range: (f64, f64),
    /// Meaning.
    pub description: String,
    /// Source of the value.
    pub get: Get,
}

/// Units with the exponents of kg, m, s, K and rad.
pub const UNITS: [(&str, [i8; 5]); 10] = [
    ("s", [0, 0, 1, 0, 0]),
    ("m", [0, 1, 0, 0, 0]),
    ("m/s", [0, 1, -1, 0, 0]),
    ("K", [0, 0, 0, 1, 0]),
    ("rad/s", [0, 0, -1, 0, 1]),
    ("N.m", [1, 2, -2, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0]),
    ("W", [1, 2, -3, 0, 0]),
    ("kg", [1, 0, 0, 0, 0]),
    ("kg/s", [1, 0, -1, 0, 0]),
];

/// Unbounded range.
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
fn row(name: &str, causality: Causality, unit: &'static str, description: &str) -> Variable {
    Variable {
        name: name.to_owned(),
        causality,
        unit,
        whole: false,
        start: 0.0,
        range: ANY,
        description: description.to_owned(),
        get: Get::Stored,
    }
}

fn input(
    name: &str,
    unit: &'static str,
    start: f64,
    range: (f64, f64),
    description: &str,
) -> Variable {
    Variable {
        start,
        range,
        ..row(name, Causality::Input, unit, description)
    }
}

/// Variables of a kind of unit for a transmission.
#[must_use]
pub fn variables(kind: Kind, transmission: &Transmission) -> Vec<Variable> {
    let mut all = vec![row("time", Causality::Independent, "s", "simulation time")];
    match kind {
        Kind::Car => car::rows(transmission, &mut all),
        Kind::Losses => point::rows(transmission, &mut all),
        Kind::Cvt => forward::rows(transmission, &mut all),
    }
    let mut components = transmission.components();
    if kind == Kind::Losses {
        components.retain(|component| *component != Component::LaunchClutch);
    }
    all.extend(components.into_iter().map(|component| Variable {
        get: Get::Loss(component),
        ..row(
            &format!("P_loss_{}_AT_PNT_W", component.name()),
            Causality::Output,
            "W",
            component.doc(),
        )
    }));
    all
}

/// Meaning of the bits of the flags.
fn flag_words() -> String {
    let names = Flags::NAMES.iter();
    let bits = names.map(|(flag, name)| format!("{} {name}", flag.0.trailing_zeros()));
    let bits: Vec<String> = bits.collect();
    let bits = bits.join(", ");
    format!("states and departures from validity, bits from the lowest: {bits}")
}

/// Sum of all losses except the pump's.
fn mechanical(loss: &ByComponent<f64>) -> f64 {
    loss.iter().sum::<f64>() - loss[Component::Pump]
}
