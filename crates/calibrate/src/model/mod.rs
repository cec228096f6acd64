//! Numbers for the parameters to computed observations: cars are built, rigs and cycles run for each set of values.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CM-1 | residual = (computed + common error of its group - measured) / sd; 0 within a measured range | convention |
//! | CM-2 | sd of a trace's values: sd sqrt(n / (duration / t_i + 1)), n values, t_i time after which two are independent | derived: as many values count as are independent |

mod cars;
mod evaluation;
mod known;

use super::plan::{CalibrationPlan, Observation};
use super::solve::{Parameter, Prior, Residuals};
use cars::Cars;
use cvtcycle_config::Problems;
use known::Known;

pub use evaluation::Prediction;

/// Width of the range of a common error, in its standard deviations.
const COMMON_WIDTH: f64 = 8.0;

/// A plan with its cars loaded: ready to be evaluated.
pub struct Model<'p> {
    plan: &'p CalibrationPlan,
    cars: Cars<'p>,
    parameters: Vec<Parameter>,
    /// Index of the common error of each group among the parameters.
    common: Vec<Option<usize>>,
    known: Known,
}

impl<'p> Model<'p> {
    /// Loads the cars of a plan.
    ///
    /// # Errors
    /// The problems of its vehicle, keys, bounds and sources.
    pub fn new(plan: &'p CalibrationPlan) -> Result<Self, Problems> {
        let (cars, mut parameters) = Cars::load(plan)?;
        let mut common = Vec::new();
        for group in &plan.groups {
            common.push(group.common_sd.map(|_| parameters.len()));
            if let Some(sd) = group.common_sd {
                let (name, wide) = (format!("common error of {}", group.name), COMMON_WIDTH * sd);
                parameters.push(Parameter {
                    prior: Some(Prior { mean: 0.0, sd }),
                    ..Parameter::new(name, 0.0, -wide, wide)
                });
            }
        }
        Ok(Model {
            plan,
            cars,
            parameters,
            common,
            known: Known::default(),
        })
    }

    /// The plan.
    #[must_use]
    pub fn plan(&self) -> &'p CalibrationPlan {
        self.plan
    }

    /// Parameters of the fit: those of the plan in their order, then the common errors of groups.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Values of the files; the first start unless the plan has another.
    #[must_use]
    pub fn file_values(&self) -> Vec<f64> {
        let own = self.cars.known.iter().map(|(value, _)| *value);
        let common = &self.parameters[self.plan.parameters.len()..];
        own.chain(common.iter().map(|parameter| parameter.start))
            .collect()
    }

    /// Units of the parameters.
    #[must_use]
    pub fn units(&self) -> Vec<String> {
        let own = self.cars.known.iter().map(|(_, unit)| unit.clone());
        let groups = self.plan.groups.iter().enumerate();
        let common = groups.filter(|(_, group)| group.common_sd.is_some());
        let unit_of = |group: usize| {
            let mut observations = self.plan.observations.iter();
            let first = observations.find(|o| o.group == group);
            first.map(|o| o.unit.clone()).unwrap_or_default()
        };
        own.chain(common.map(|(k, _)| unit_of(k))).collect()
    }

    /// Computes all observations, once for each set of values of the cars.
    ///
    /// # Errors
    /// Why one of them has no number at these values.
    pub fn predict(&self, values: &[f64]) -> Result<Prediction, String> {
        let cars = &values[..self.plan.parameters.len().min(values.len())];
        let count = self.plan.observations.len();
        self.known.once(cars, count, || {
            evaluation::predict(&self.cars, self.plan, cars)
        })
    }

    /// Distance of each computed observation from the measured one, in its own unit, common errors included (CM-1).
    #[must_use]
    pub fn distances(&self, computed: &[f64], values: &[f64]) -> Vec<f64> {
        let one = |(observation, computed): (&Observation, &f64)| {
            let common = self.common[observation.group].map_or(0.0, |k| values[k]);
            observation.measured.distance(computed + common) // CM-1
        };
        let pairs = self.plan.observations.iter().zip(computed);
        pairs.map(one).collect()
    }
}

impl Residuals for Model<'_> {
    fn count(&self) -> usize {
        self.plan.observations.len()
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let prediction = self.predict(values)?;
        let distances = self.distances(&prediction.computed, values);
        let pairs = self.plan.observations.iter().zip(distances);
        Ok(pairs.map(|(o, distance)| distance / o.weight_sd).collect())
    }
}
