//! An instantiated unit: inputs, steps, outputs, saved states.

mod driven_box;
mod driving;
mod operating_point;

use std::fmt::Write;
use std::path::Path;

use cvtcycle_config::ProblemKind::{
    Conflict, Damaged, OutOfRange, UnknownKey, Unreadable, WrongTransmission,
};
use cvtcycle_config::setup::{Setup, carried};
use cvtcycle_config::{ProblemKind, Problems, bounded, one_line};
use cvtcycle_model::drive::Car;
use cvtcycle_model::rig::Bench;
use cvtcycle_model::transmission::component::ByComponent;

use crate::UNIT_FILE;
use crate::variables::{self, Causality, Get, Kind, Variable, car, forward};
use driving::Driven;
pub(crate) use driving::{INPUTS, StepInputs};

/// Minimum and maximum communication step, s. The minimum equals that of a run.
pub const STEP_S: (f64, f64) = (0.01, 3600.0);
/// Maximum absolute time, s. Beyond it a short step would lose digits.
pub(crate) const MAX_TIME_S: f64 = 1e9;
/// Relative tolerance between the start of a step and the end of the previous one.
const STEP_TOLERANCE: f64 = 1e-6;

/// Checks start and length of a step, s.
pub(crate) fn is_valid_step(from_s: f64, dt_s: f64) -> bool {
    let (least, most) = STEP_S;
    // Subtracting two times leaves their rounding error.
    from_s.abs() <= MAX_TIME_S && least * (1.0 - STEP_TOLERANCE) <= dt_s && dt_s <= most
}

/// Refused call; the unit keeps its previous state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// True for a warning: the results of the call are valid.
    pub warns: bool,
    /// Kind of problem.
    pub kind: ProblemKind,
    /// Variable concerned; may be empty.
    pub variable: String,
    /// Message with value and allowed range.
    pub message: String,
}

impl Refusal {
    /// Creates an error of a call without effect.
    pub fn new(kind: ProblemKind, message: impl Into<String>) -> Self {
        Refusal {
            warns: false,
            kind,
            variable: String::new(),
            message: message.into(),
        }
    }

    /// Adds the variable.
    #[must_use]
    pub fn about(mut self, variable: &str) -> Self {
        variable.clone_into(&mut self.variable);
        self
    }
}

impl From<Problems> for Refusal {
    fn from(problems: Problems) -> Self {
        let mut message = String::new();
        let kind = problems.iter().next().map(|problem| problem.kind);
        for problem in problems.iter() {
            let place = problem.place.file_name().unwrap_or_default();
            // Writing to a string is infallible.
            let _ = write!(message, "{place}: {}; {} ", problem.message, problem.hint);
        }
        Refusal::new(kind.unwrap_or_default(), one_line(message.trim_end()))
    }
}

/// State of a unit apart from its car, copied when saved.
#[derive(Clone, Debug)]
pub struct Saved {
    pub(crate) values: Vec<f64>,
    pub(crate) time_s: f64,
    pub(crate) drive: Option<Driven>,
    /// True if inputs of an operating point changed since the outputs were computed.
    stale: bool,
}

/// Instantiated unit.
#[derive(Debug)]
pub struct Unit {
    kind: Kind,
    setup: Setup,
    bench: Option<Bench>,
    /// Car at the ambient temperature of the last step.
    car: Car,
    variables: Vec<Variable>,
    saved: Saved,
}

impl Unit {
    /// Creates the unit of a car.
    #[must_use]
    pub fn new(kind: Kind, setup: Setup) -> Self {
        let variables = variables::variables(kind, setup.transmission());
        let values = variables.iter().map(|variable| variable.start).collect();
        Unit {
            kind,
            bench: (kind == Kind::Losses).then(|| Bench::new(&setup)),
            car: setup.car(car::START_AMBIENT_K),
            setup,
            variables,
            saved: Saved {
                values,
                time_s: 0.0,
                drive: None,
                stale: true,
            },
        }
    }

    /// Opens the unit whose resources are in a folder, and checks the token of its description.
    /// # Errors
    /// Missing or damaged files, a description of another unit, all problems of the car.
    pub fn open(resources: &Path, token: &str) -> Result<Self, Refusal> {
        let path = resources.join(UNIT_FILE);
        let bytes = bounded::read_file(&path, bounded::CHECKSUMS).map_err(|error| {
            let path = path.display();
            let message = format!("cannot read the resource {path}: {error}");
            Refusal::new(Unreadable, message)
        })?;
        let text = String::from_utf8_lossy(&bytes);
        let (kind, own) = text.trim().split_once(' ').unwrap_or_default();
        let known = Kind::NAMES.into_iter().find(|(name, _)| *name == kind);
        let Some((_, kind)) = known else {
            let path = path.display();
            let message = format!("{path} names no kind of unit");
            return Err(Refusal::new(Damaged, message));
        };
        if own != token {
            let token = one_line(token);
            let message = format!("the token `{token}` is not that of these resources, `{own}`");
            return Err(Refusal::new(Conflict, message));
        }
        let setup = carried::open(resources)?;
        if !kind.fits(setup.transmission()) {
            let name = kind.name();
            let message = format!("the unit `{name}` needs a CVT");
            return Err(Refusal::new(WrongTransmission, message));
        }
        Ok(Unit::new(kind, setup))
    }

    /// Variables; the value reference is the index.
    #[must_use]
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// End of the last step, s.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.saved.time_s
    }

    /// Value of a variable.
    /// # Errors
    /// Unknown variable; operating point without a solution.
    pub fn get(&mut self, reference: u32) -> Result<f64, Refusal> {
        self.variable(reference)?;
        if self.kind == Kind::Losses && self.saved.stale {
            self.solve()?;
        }
        match reference {
            0 => Ok(self.saved.time_s),
            _ => Ok(self.saved.values[reference as usize]),
        }
    }

    /// True for an integer variable.
    /// # Errors
    /// Unknown variable.
    pub fn is_whole(&self, reference: u32) -> Result<bool, Refusal> {
        Ok(self.variable(reference)?.whole)
    }

    /// Sets an input, or a parameter before the start.
    /// # Errors
    /// Unknown variable, a variable that cannot be set, or a value out of range.
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), Refusal> {
        let Variable {
            name,
            causality,
            range: (low, high),
            whole,
            unit,
            ..
        } = self.variable(reference)?;
        match causality {
            Causality::Input => {}
            Causality::Parameter if self.saved.drive.is_none() => {}
            Causality::Parameter => {
                let message =
                    format!("{name} is a parameter: set it before the end of initialization");
                return Err(Refusal::new(Conflict, message).about(name));
            }
            Causality::Independent | Causality::Output => {
                let message = format!("{name} is computed: it cannot be set");
                return Err(Refusal::new(Conflict, message).about(name));
            }
        }
        let fits = *low <= value && value <= *high && (!whole || value.fract().abs() <= 0.0);
        if !fits {
            let message = format!("{name} = {value} is out of range: {low} to {high} {unit}");
            return Err(Refusal::new(OutOfRange, message).about(name));
        }
        self.saved.values[reference as usize] = value;
        self.saved.stale = true;
        Ok(())
    }

    fn variable(&self, reference: u32) -> Result<&Variable, Refusal> {
        let count = self.variables.len();
        self.variables.get(reference as usize).ok_or_else(|| {
            let last = count - 1;
            let message = format!(
                "there is no variable with value reference {reference}; the last is {last}"
            );
            Refusal::new(UnknownKey, message)
        })
    }

    /// Ends initialization at a time, s.
    /// # Errors
    /// Non-finite time, start temperature between 0 and 233.15 K, operating point without a solution.
    pub fn start(&mut self, time_s: f64) -> Result<(), Refusal> {
        let is_near = time_s.abs() <= MAX_TIME_S;
        if !is_near {
            let message = format!(
                "the start time {time_s} s is out of range: {} to {MAX_TIME_S} s",
                -MAX_TIME_S
            );
            return Err(Refusal::new(OutOfRange, message));
        }
        self.saved.time_s = time_s;
        let values = &self.saved.values;
        match self.kind {
            Kind::Losses => return self.solve(),
            Kind::Cvt => {
                let own = [forward::SPEED, forward::OIL, forward::COOLANT];
                self.begin_forward(own.map(|place| values[place]));
                return Ok(());
            }
            Kind::Car => {}
        }
        let (ambient_k, asked_k) = (values[car::AMBIENT], values[car::START]);
        let start_k = if asked_k > 0.0 { asked_k } else { ambient_k };
        self.begin([values[car::SPEED], ambient_k, start_k])
    }

    /// Advances by a communication step from a time, s.
    /// # Errors
    /// A step that is too short or too long, or does not begin where the last one ended; it has no effect. A warning for an operating
    /// point without a solution.
    pub fn step(&mut self, from_s: f64, dt_s: f64) -> Result<(), Refusal> {
        let (least, most) = STEP_S;
        if !is_valid_step(self.saved.time_s, dt_s) {
            let message =
                format!("a communication step of {dt_s} s is out of range: {least} to {most} s");
            return Err(Refusal::new(OutOfRange, message));
        }
        let at_s = self.saved.time_s;
        let follows = (from_s - at_s).abs() <= STEP_TOLERANCE * dt_s;
        if !follows {
            let message = format!("the step begins at {from_s} s, the last one ended at {at_s} s");
            return Err(Refusal::new(Conflict, message));
        }
        let solved = match self.kind {
            Kind::Losses => self.solve().map_err(|refused| Refusal {
                warns: true,
                ..refused
            }),
            Kind::Car | Kind::Cvt => {
                let inputs = match self.kind {
                    Kind::Cvt => self.forward_inputs(),
                    _ => self.car_inputs(),
                };
                self.advance(&StepInputs {
                    from_s,
                    dt_s,
                    inputs,
                })?;
                Ok(())
            }
        };
        self.saved.time_s = from_s + dt_s;
        solved
    }

    /// Advances a unit that has steps.
    pub(crate) fn advance(&mut self, step: &StepInputs) -> Result<(), Refusal> {
        match self.kind {
            Kind::Cvt => self.drive_forward(step),
            _ => self.drive(step),
        }
    }

    /// Inputs of a car for the next step.
    fn car_inputs(&self) -> [f64; INPUTS] {
        let value = |place: usize| self.saved.values[place];
        let has_gears = self
            .variables
            .get(car::GEAR)
            .is_some_and(|own| own.causality == Causality::Input);
        let gear = if has_gears { value(car::GEAR) } else { -1.0 };
        [
            value(car::SPEED),
            value(car::GRADE),
            value(car::AMBIENT),
            gear,
            0.0,
        ]
    }

    /// Copies the state.
    #[must_use]
    pub fn save(&self) -> Saved {
        self.saved.clone()
    }

    /// Restores a state.
    /// # Errors
    /// A state of another unit.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), Refusal> {
        if saved.values.len() != self.variables.len() {
            return Err(Refusal::new(Conflict, "the state is of another unit"));
        }
        self.saved = saved.clone();
        Ok(())
    }

    /// Returns to the state before initialization.
    pub fn reset(&mut self) {
        let values = self.variables.iter().map(|variable| variable.start);
        self.saved = Saved {
            values: values.collect(),
            time_s: 0.0,
            drive: None,
            stale: true,
        };
    }

    pub(crate) fn kind(&self) -> Kind {
        self.kind
    }

    pub(crate) fn saved(&mut self) -> &mut Saved {
        &mut self.saved
    }
}

/// Sets outputs. An undefined one (the ratio with the engine off) keeps its last value.
fn set_outputs(
    variables: &[Variable],
    values: &mut [f64],
    loss_w: &ByComponent<f64>,
    value: impl Fn(&Get) -> Option<f64>,
) {
    for (variable, place) in variables.iter().zip(values) {
        let new = match variable.get {
            Get::Loss(component) => Some(loss_w[component]),
            ref get => value(get),
        };
        if let Some(new) = new.filter(|new| !new.is_nan()) {
            *place = new;
        }
    }
}
