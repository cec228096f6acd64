//! One car with other numbers, as a function of them: what optimisers and sensitivity analyses of other programs call.
//!
//! Points are driven side by side as those of a study are, and fail as a run of a study fails.

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{AMBIENT, Param, ParamSet, Setup};
use cvtcycle_config::{Problem, Problems};
use cvtcycle_model::drive::{self, Conditions, Outcome, drive_each};
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_output::summary::{Driven, Settings, run_summary};
use cvtcycle_output::table::{Column, Head};

use crate::execute::outputs::{FUEL, Run, outputs};
use crate::execute::{reason, status};

/// The argument that is no key of the car's files.
const AMBIENT_DEGC: &str = "ambient_degc";

/// Target of a number of a point.
enum Argument {
    /// A number of the car's files.
    Number(Param),
    /// Ambient temperature, degC.
    Ambient,
}

/// A car, a cycle, and the keys whose values are the arguments.
///
/// ```
/// use cvtcycle_config::{cycle, setup::{Options, ParamSet}};
/// use cvtcycle_model::drive::{Conditions, Start};
/// use cvtcycle_study::family::Family;
/// let car = ParamSet::load("rover_216_cvt", &Options::default())?;
/// let conditions = Conditions { ambient_k: 298.15, start: Start::Soak, max_dt_s: 1.0, keep_rows: false };
/// let family = Family::new(car, cycle::find("ece15")?, conditions, &["road_load.mass_kg"])?;
/// let fuel = family.outputs_of(&["fuel_l_per_100km"])?;
/// let masses_kg: [&[f64]; 3] = [&[1300.0], &[1100.0], &[-1.0]];
/// let points = family.points(masses_kg, &fuel);
/// assert!(points[0].numbers > points[1].numbers);
/// assert!(points[2].numbers[0].is_nan() && !points[2].reason.is_empty());
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub struct Family {
    params: ParamSet,
    cycle: Cycle,
    conditions: Conditions,
    arguments: Vec<Argument>,
    outputs: Vec<Column<Run>>,
}

/// Results of a point.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyPoint {
    /// The wanted outputs; NaN for a car that cannot be driven, and for what it has not.
    pub numbers: Vec<f64>,
    /// Why the car could not be driven, or which check its drive failed; empty if all is well.
    pub reason: String,
}

impl Family {
    /// The family of a car, with the keys that are its arguments: those of its files, and `ambient_degc`.
    ///
    /// # Errors
    /// Keys that the car does not have, or that hold no single number.
    pub fn new<S: AsRef<str>>(
        params: ParamSet,
        cycle: Cycle,
        conditions: Conditions,
        keys: &[S],
    ) -> Result<Self, Problems> {
        let mut problems = Problems::new();
        let argument = |key: &S| match key.as_ref() {
            AMBIENT_DEGC => Some(Argument::Ambient),
            key => problems.take(params.param(key)).map(Argument::Number),
        };
        let arguments: Vec<Argument> = keys.iter().filter_map(argument).collect();
        problems.finish()?;
        let groups = cycle.phase_groups();
        let phases = groups.into_iter().map(|(name, _)| name);
        let phases: Vec<String> = phases.collect();
        let phases = if phases.len() > 1 { phases } else { Vec::new() };
        Ok(Family {
            outputs: outputs(&phases, &params.vehicle().transmission().components()),
            params,
            cycle,
            conditions: Conditions {
                keep_rows: false,
                ..conditions
            },
            arguments,
        })
    }

    /// Name and unit of each argument.
    pub fn arguments(&self) -> Vec<(String, &'static str)> {
        let argument = |argument: &Argument| match argument {
            Argument::Number(param) => (param.key().to_owned(), param.unit()),
            Argument::Ambient => (AMBIENT_DEGC.to_owned(), "degC"),
        };
        self.arguments.iter().map(argument).collect()
    }

    /// The value of each argument in the car as it is.
    pub fn base(&self) -> Vec<f64> {
        let base = |argument: &Argument| match argument {
            Argument::Number(param) => param.base(),
            Argument::Ambient => self.conditions.ambient_k - ZERO_DEGC_K,
        };
        self.arguments.iter().map(base).collect()
    }

    /// Every output that a point has.
    pub fn outputs(&self) -> Vec<Head> {
        self.outputs.iter().map(Column::head).collect()
    }

    /// Places of outputs by their names; without a name the headline fuel.
    ///
    /// # Errors
    /// Names that no output has.
    pub fn outputs_of<S: AsRef<str>>(&self, names: &[S]) -> Result<Vec<usize>, Problems> {
        let mut problems = Problems::new();
        let all = || self.outputs.iter().map(|column| &*column.name);
        let mut place = |name: &str| {
            let found = all().position(|own| own == name);
            if found.is_none() {
                let hint = cvtcycle_config::did_you_mean(name, all());
                let message = format!("there is no output `{name}`");
                let problem = Problem::unknown_name(message).key("outputs").value(name);
                problems.add(problem.hint(hint.unwrap_or_default()));
            }
            found
        };
        let found: Vec<usize> = match names {
            [] => place(FUEL).into_iter().collect(),
            names => names
                .iter()
                .filter_map(|name| place(name.as_ref()))
                .collect(),
        };
        problems.finish().map(|()| found)
    }

    /// Drives the car at points, rows of values of the arguments in the units of their keys: side by side,
    /// [`MAX_TOGETHER`](cvtcycle_model::drive::MAX_TOGETHER) at a time, each with the numbers that it has alone.
    pub fn points<'n>(
        &self,
        points: impl IntoIterator<Item = &'n [f64]>,
        wanted: &[usize],
    ) -> Vec<FamilyPoint> {
        let points = points.into_iter();
        let cars: Vec<_> = points.map(|numbers| self.car_at(numbers)).collect();
        let mut runs = Vec::with_capacity(cars.len());
        for (setup, conditions) in cars.iter().flatten() {
            runs.push(drive::Run {
                vehicle: setup,
                conditions: *conditions,
            });
        }
        let mut outcomes = drive_each(&runs, &self.cycle).into_iter();
        let point = |car: &Result<(Setup, Conditions), String>| {
            let driven = (car.as_ref())
                .map_err(String::as_str)
                .and_then(|(setup, _)| Ok((setup, outcomes.next().ok_or("it was not driven")?)));
            match driven {
                Ok((setup, outcome)) => self.finished(setup, &outcome, wanted),
                Err(reason) => FamilyPoint {
                    numbers: vec![f64::NAN; wanted.len()],
                    reason: reason.to_owned(),
                },
            }
        };
        cars.iter().map(point).collect()
    }

    /// The car at a point and how it is driven, or why there is none.
    fn car_at(&self, numbers: &[f64]) -> Result<(Setup, Conditions), String> {
        let mut conditions = self.conditions;
        let mut values = Vec::with_capacity(numbers.len());
        for (argument, number) in self.arguments.iter().zip(numbers) {
            match argument {
                Argument::Number(param) => values.push((param, *number)),
                Argument::Ambient if AMBIENT.contains(*number) => {
                    conditions.ambient_k = number + ZERO_DEGC_K;
                }
                Argument::Ambient => {
                    let allowed = AMBIENT.in_unit("degC");
                    return Err(format!(
                        "`{AMBIENT_DEGC}` is out of range (allowed: {allowed})"
                    ));
                }
            }
        }
        let set = self.params.with_numbers(&values);
        let set = set.map_err(|problems| reason(&problems))?;
        Ok((Setup::from_params(&set), conditions))
    }

    /// Collects the results of a car that has been driven.
    fn finished(&self, setup: &Setup, outcome: &Outcome, wanted: &[usize]) -> FamilyPoint {
        let driven = Driven {
            name: &setup.name,
            setup,
            outcome,
        };
        let summary = run_summary(&self.cycle, "subject", &Settings::default(), &driven);
        let reason = status(&summary).reason().to_owned();
        let run = (summary, None);
        let numbers = wanted.iter().map(|k| self.outputs[*k].number_of(&run));
        FamilyPoint {
            numbers: numbers.collect(),
            reason,
        }
    }
}
