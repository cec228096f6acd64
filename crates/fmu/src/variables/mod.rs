//! The variables of a unit, each a row: name, causality, unit, start, range, meaning, and where its value comes from.
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

/// What a unit simulates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A whole car that follows a speed, from the wheels back to the fuel.
    Car,
    /// The losses of its transmission at an operating point, with the launch device locked.
    Losses,
    /// Its CVT with launch device and ratio rate, driven by a torque.
    Cvt,
}

impl Kind {
    /// Names, as the command line has them.
    pub const NAMES: [(&'static str, Kind); 3] = [
        ("car", Kind::Car),
        ("losses", Kind::Losses),
        ("cvt", Kind::Cvt),
    ];

    /// Whether a car with this transmission has such a unit.
    #[must_use]
    pub fn fits(self, transmission: &Transmission) -> bool {
        self != Kind::Cvt || transmission.is_cvt()
    }

    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// What it is, one phrase.
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

/// What the outputs of a car come from.
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

/// What the outputs of an operating point come from.
#[derive(Clone, Copy, Debug)]
pub struct LossResult {
    /// What was asked for.
    pub point: BenchPoint,
    /// The bench's answer.
    pub answer: BenchAnswer,
}

/// What the outputs of a CVT that is driven by a torque come from.
#[derive(Clone, Copy, Debug)]
pub struct CvtResult<'a> {
    /// The last step.
    pub turned: &'a Turned,
    /// Temperature of the belt at its end, K.
    pub belt_k: f64,
    /// The box.
    pub cvt: &'a Cvt,
}

/// Where the value of a variable comes from.
#[derive(Clone, Copy, Debug)]
pub enum Get {
    /// It is kept as it was set.
    Kept,
    /// From a step of the car.
    Car(fn(&CarResult) -> f64),
    /// From an operating point.
    Losses(fn(&LossResult) -> f64),
    /// From a step of the CVT that is driven by a torque.
    Cvt(fn(&CvtResult) -> f64),
    /// Loss power of a component, W.
    Loss(Component),
}

/// One variable; its value reference is its place in the table.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// Role.
    pub causality: Causality,
    /// Unit as in [`UNITS`]; `1` for none.
    pub unit: &'static str,
    /// Whether it is a whole number.
    pub whole: bool,
    /// Value at the start, of inputs and parameters.
    pub start: f64,
    /// Least and most that an input or parameter may be.
    pub range: (f64, f64),
    /// Meaning.
    pub description: String,
    /// Where its value comes from.
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

/// Any number.
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
        get: Get::Kept,
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

/// The variables of a kind of unit for a transmission.
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

/// What the bits of the flags are.
fn flag_words() -> String {
    let names = Flags::NAMES.iter();
    let bits = names.map(|(flag, name)| format!("{} {name}", flag.0.trailing_zeros()));
    let bits: Vec<String> = bits.collect();
    let bits = bits.join(", ");
    format!("states and departures from validity, bits from the lowest: {bits}")
}

/// All losses but that of the pump.
fn mechanical(loss: &ByComponent<f64>) -> f64 {
    loss.iter().sum::<f64>() - loss[Component::Pump]
}
