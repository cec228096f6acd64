//! The cars of a study, and how each factor reaches each of them.

use std::sync::{Arc, OnceLock};

use crate::plan::{Acts, Base, Cars, Factor, FactorValue, Plan};
use cvtcycle_config::setup::template::{ParameterRef, VehicleTemplate};
use cvtcycle_config::setup::{NamedBy, Options, Setup, is_twin};
use cvtcycle_config::{Override, Problem, ProblemKind, Problems};
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_output::provenance::car_sha256;

/// Largest number of combinations of words of a car: each keeps its documents in memory.
pub const MAX_VARIANTS: usize = 4096;

/// How a factor acts on one car.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding {
    /// Not at all.
    Not,
    /// A number of the car's files.
    Number(Acts),
    /// Words that need documents of their own; the weight of a word in the variant's index.
    Words {
        /// Weight.
        stride: usize,
    },
    /// Ambient temperature, degC.
    Ambient,
    /// Start.
    Start,
    /// Cycle.
    Cycle,
    /// Largest step, s.
    Step,
}

/// A car in one combination of words: checked documents, and the places of the numbers in them.
pub(super) struct CarVariant {
    pub blueprint: VehicleTemplate,
    /// By factor; none for factors that are no number of this car.
    pub slots: Vec<Option<ParameterRef>>,
    /// Keys of factors that this car does not know, with what is to be said of them.
    pub unknown: Vec<(usize, Problem)>,
    /// The car with all numbers as its files have them.
    pub setup: Setup,
}

/// A car of a study.
pub struct StudyCar {
    /// Name in the table, unique within the study.
    pub name: Arc<str>,
    /// `subject` or `baseline`.
    pub role: Arc<str>,
    /// Name or path of its file.
    pub word: String,
    pub(super) bindings: Vec<Binding>,
    options: Options,
    variants: Vec<OnceLock<Result<CarVariant, Problems>>>,
}

impl StudyCar {
    /// A car of the plan.
    ///
    /// # Errors
    /// A problem at the factor with which the words have more than [`MAX_VARIANTS`] combinations.
    pub(super) fn new(name: &str, word: &str, subject: bool, plan: &Plan) -> Result<Self, Problem> {
        let mut stride = 1_usize;
        let mut bindings = Vec::with_capacity(plan.factors.len());
        for factor in &plan.factors {
            bindings.push(binding(factor, subject, stride));
            if matches!(bindings.last(), Some(Binding::Words { .. })) {
                stride = stride.saturating_mul(words(factor).len() + 1);
            }
            if stride > MAX_VARIANTS {
                return Err(too_many(factor));
            }
        }
        Ok(StudyCar {
            name: name.into(),
            role: if subject { "subject" } else { "baseline" }.into(),
            word: word.to_owned(),
            bindings,
            options: match is_twin(word) {
                true => options(&plan.base, true).of_twin(NamedBy::File),
                false => options(&plan.base, subject),
            },
            variants: (0..stride).map(|_| OnceLock::new()).collect(),
        })
    }

    /// The weight of a factor's value in the index of the variant; 0 for what is no word of this car.
    pub(super) fn weight(&self, factor: usize, of: &Factor, value: Option<&FactorValue>) -> usize {
        match (self.bindings[factor], value) {
            (Binding::Words { stride }, Some(value)) => of.entry_of(value) * stride,
            _ => 0,
        }
    }

    /// Hash of the car as its files have it; empty of a car that cannot be read.
    pub fn sha256(&self, factors: &[Factor]) -> String {
        let variant = self.variant(0, factors);
        variant.map_or_else(|_| String::new(), |variant| car_sha256(&variant.setup))
    }

    /// A variant, made when it is first asked for; its problems if its words do not go together.
    pub(super) fn variant(
        &self,
        index: usize,
        factors: &[Factor],
    ) -> Result<&CarVariant, &[Problem]> {
        self.variants[index]
            .get_or_init(|| self.make(index, factors))
            .as_ref()
            .map_err(|problems| problems.as_slice())
    }

    /// The baselines that the file of the unchanged car names.
    ///
    /// # Errors
    /// The problems of its files and of the factors' keys.
    pub(super) fn baselines(&self, factors: &[Factor]) -> Result<Vec<String>, Problems> {
        let variant = self
            .variant(0, factors)
            .map_err(|problems| problems.to_vec())?;
        Ok(variant.setup.baselines.clone())
    }

    /// The unchanged car in every combination of words that goes together.
    pub(super) fn setups<'s>(&'s self, factors: &'s [Factor]) -> impl Iterator<Item = &'s Setup> {
        (0..self.variants.len())
            .filter_map(|index| self.variant(index, factors).ok())
            .map(|variant| &variant.setup)
    }

    fn make(&self, index: usize, factors: &[Factor]) -> Result<CarVariant, Problems> {
        let options = self.options_of(index, factors)?;
        let (blueprint, setup) = VehicleTemplate::load(&self.word, &options)?;
        let mut variant = CarVariant {
            blueprint,
            slots: Vec::with_capacity(factors.len()),
            unknown: Vec::new(),
            setup,
        };
        for (index, (factor, binding)) in factors.iter().zip(&self.bindings).enumerate() {
            let slot = match binding {
                Binding::Number(_) => variant.blueprint.slot(&factor.key).map(Some),
                _ => Ok(None),
            };
            variant.slots.push(slot.unwrap_or_else(|problem| {
                variant.unknown.push((index, self.unknown(factor, problem)));
                None
            }));
        }
        Ok(variant)
    }

    /// The problem of a key that this car does not know.
    fn unknown(&self, factor: &Factor, problem: Problem) -> Problem {
        let hint = match problem.kind {
            ProblemKind::WrongTransmission => format!(
                "{}; `cars = \"baselines\"` varies the baselines alone",
                problem.hint
            ),
            _ => problem.hint.clone(),
        };
        let problem = problem.with_context(&format!("{}: ", self.name)).hint(hint);
        problem.at(factor.place.clone()).key(factor.key.as_str())
    }

    fn options_of(&self, index: usize, factors: &[Factor]) -> Result<Options, Problem> {
        let mut options = self.options.clone();
        for (factor, binding) in factors.iter().zip(&self.bindings) {
            let Binding::Words { stride } = binding else {
                continue;
            };
            let words = words(factor);
            let entry = index / stride % (words.len() + 1);
            let Some(word) = entry.checked_sub(1).map(|k| words[k].to_string()) else {
                continue;
            };
            match factor.key.as_str() {
                "lubricant" => options.lubricant = Some(word),
                "engine_oil" => options.engine_oil = Some(word),
                "formulation" => {
                    options.formulation = Formulation::named(&word).unwrap_or(options.formulation)
                }
                key => options.set.push(Override::new(key, &word)?),
            }
        }
        Ok(options)
    }
}

/// What the plan says for all runs, of one car.
fn options(base: &Base, subject: bool) -> Options {
    let own: &[Override] = if subject { &base.set } else { &[] };
    Options {
        lubricant: base.lubricant.clone().filter(|_| subject),
        engine_oil: base.engine_oil.clone(),
        set: base.set_all.iter().chain(own).cloned().collect(),
        formulation: base.formulation,
        named_by: NamedBy::File,
    }
}

fn binding(factor: &Factor, subject: bool, stride: usize) -> Binding {
    let reached = match factor.cars {
        Cars::All => true,
        Cars::Subject => subject,
        Cars::Baselines => !subject,
    };
    match factor.key.as_str() {
        _ if !reached => Binding::Not,
        "ambient_degc" => Binding::Ambient,
        "start" => Binding::Start,
        "cycle" => Binding::Cycle,
        "dt_s" => Binding::Step,
        _ if !factor.values.are_numbers() => Binding::Words { stride },
        _ => Binding::Number(factor.acts),
    }
}

/// The entries of a factor's list as text; nothing for a distribution.
pub(super) fn words(factor: &Factor) -> Vec<Arc<str>> {
    factor.values.list().iter().map(FactorValue::text).collect()
}

fn too_many(factor: &Factor) -> Problem {
    let key = &factor.key;
    let message = format!("with `{key}` the words of the factors have too many combinations");
    Problem::too_large(message)
        .at(factor.place.clone())
        .key(key.as_str())
        .names_key()
        .allowed(format!(
            "at most {MAX_VARIANTS} combinations of words of one car"
        ))
        .hint("give fewer words, or split the plan")
}
