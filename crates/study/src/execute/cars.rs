//! The cars of a study, and how each factor reaches each of them.
//!
//! They are those of the plan, subject and baselines, or [`Column`]s: vehicles with changes of their own. All cars of a point have the same
//! draw, so that two columns of one vehicle differ by their changes alone.

use std::sync::{Arc, OnceLock};

use crate::plan::{Acts, Base, Cars, Factor, FactorValue, Plan, RUN_OPTIONS};
use cvtcycle_config::setup::{NamedBy, Options, Param, ParamSet, Setup, is_twin};
use cvtcycle_config::{Bound, Override, Problem, ProblemKind, Problems};
use cvtcycle_model::keys::Kind;
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
    pub base: ParamSet,
    /// By factor; none for factors that are no number of this car.
    pub params: Vec<Option<Param>>,
    /// Keys of factors that this car does not know, with what is to be said of them.
    pub unknown: Vec<(usize, Problem)>,
    /// The car with all numbers as its files have them.
    pub setup: Setup,
}

/// A car that the plan does not name: a vehicle with changes of its own.
#[derive(Clone, Debug)]
pub struct Column {
    /// Name in the table, unique within the study.
    pub name: String,
    /// Role in the study, a word.
    pub role: String,
    /// Name or path of its file.
    pub word: String,
    /// True if it is varied as the subject of the plan, false if as its baselines.
    pub is_subject: bool,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// Changes: overrides and fluids. A relative one acts on the drawn value.
    pub options: Options,
    /// Factors that do not act on it.
    pub left_out: Vec<usize>,
    /// True to keep its side effects, for which it is driven by itself and not next to its other draws.
    pub is_watched: bool,
}

/// A car of a study.
pub struct StudyCar {
    /// Name in the table, unique within the study.
    pub name: Arc<str>,
    /// `subject` or `baseline`, or that of a column.
    pub role: Arc<str>,
    /// Name or path of its file.
    pub word: String,
    /// Ambient temperature of its own, degC.
    pub ambient_degc: Option<f64>,
    /// Factors that would act on it, but for a key that it does not have, or for 0 of which they are a share.
    pub idle: Vec<usize>,
    /// True if its side effects are kept.
    pub(super) is_watched: bool,
    pub(super) bindings: Vec<Binding>,
    /// Overrides applied to the drawn value, by factor.
    then: Vec<Vec<Override>>,
    /// Range that values are clamped to, by factor, where the plan says so.
    held: Vec<Option<Bound>>,
    options: Options,
    /// The car without words, where it has been read.
    read: Option<ParamSet>,
    variants: Vec<OnceLock<Result<CarVariant, Problems>>>,
}

impl StudyCar {
    /// A car of the plan.
    ///
    /// # Errors
    /// A problem at the factor with which the words have more than [`MAX_VARIANTS`] combinations; of a plan that skips what is missing the
    /// problems of the car as well.
    pub(super) fn new(
        name: &str,
        word: &str,
        subject: bool,
        plan: &Plan,
    ) -> Result<Self, Problems> {
        let options = match is_twin(word) {
            true => options(&plan.base, true).of_twin(NamedBy::File),
            false => options(&plan.base, subject),
        };
        let car = StudyCar {
            name: name.into(),
            role: if subject { "subject" } else { "baseline" }.into(),
            word: word.to_owned(),
            ambient_degc: None,
            idle: Vec::new(),
            is_watched: false,
            bindings: Vec::new(),
            then: vec![Vec::new(); plan.factors.len()],
            held: held(plan),
            options,
            read: None,
            variants: Vec::new(),
        };
        car.bound(plan, subject, &[])
    }

    /// A column of a study of this plan.
    ///
    /// # Errors
    /// As those of a car.
    pub(super) fn of_column(column: &Column, plan: &Plan) -> Result<Self, Problems> {
        let acts_on = |factor: &Factor, by: &Override| {
            by.acts() != Acts::Value
                && by.key() == factor.key
                && matches!(binding(factor, column.is_subject, 1), Binding::Number(_))
        };
        let mut then = vec![Vec::new(); plan.factors.len()];
        let mut options = column.options.clone();
        options.set.retain(|by| {
            let mut factors = (0..plan.factors.len()).filter(|f| !column.left_out.contains(f));
            let factor = factors.find(|f| acts_on(&plan.factors[*f], by));
            factor.is_none_or(|f| {
                then[f].push(by.clone());
                false
            })
        });
        let car = StudyCar {
            name: column.name.as_str().into(),
            role: column.role.as_str().into(),
            word: column.word.clone(),
            ambient_degc: Some(column.ambient_degc),
            idle: Vec::new(),
            is_watched: column.is_watched,
            bindings: Vec::new(),
            then,
            held: held(plan),
            options,
            read: None,
            variants: Vec::new(),
        };
        car.bound(plan, column.is_subject, &column.left_out)
    }

    /// With the way in which each factor reaches it.
    fn bound(mut self, plan: &Plan, subject: bool, left_out: &[usize]) -> Result<Self, Problems> {
        let own = match plan.skip_missing || plan.by_box.is_some() {
            true => Some(ParamSet::load(&self.word, &self.options)?),
            false => None,
        };
        self.read.clone_from(&own);
        let is_cvt = |own: &ParamSet| own.vehicle().transmission().is_cvt();
        let by_box = plan.by_box.zip(own.as_ref().map(is_cvt));
        let subject = by_box.map_or(subject, |(of, is_cvt)| of == is_cvt);
        let own = own.filter(|_| plan.skip_missing);
        let mut stride = 1_usize;
        for (index, factor) in plan.factors.iter().enumerate() {
            let mut binding = match left_out.contains(&index) {
                true => Binding::Not,
                false => binding(factor, subject, stride),
            };
            let acts = binding != Binding::Not;
            if let Some(own) = own.as_ref().filter(|_| acts)
                && (self.is_missing(factor, own) || is_share_of_zero(binding, factor, own))
            {
                binding = Binding::Not;
                self.idle.push(index);
            }
            self.bindings.push(binding);
            if matches!(binding, Binding::Words { .. }) {
                stride = stride.saturating_mul(words(factor).len() + 1);
            }
            if stride > MAX_VARIANTS {
                return Err(too_many(factor).into());
            }
        }
        self.variants = (0..stride).map(|_| OnceLock::new()).collect();
        Ok(self)
    }

    /// True if the car lacks the key of a factor: unknown, of an option that is not chosen, or without a value to act on.
    fn is_missing(&self, factor: &Factor, own: &ParamSet) -> bool {
        if RUN_OPTIONS.contains(&factor.key.as_str()) {
            return false;
        }
        if factor.values.are_numbers() {
            let param = own.param(&factor.key);
            return !param.is_ok_and(|param| param.is_active() && !param.base().is_nan());
        }
        // A twin has keys that no word can be set for: they follow from its car.
        let word = words(factor).into_iter().next();
        let set = word.and_then(|word| Override::new(&factor.key, &word).ok());
        let mut options = self.options.clone();
        options.set.extend(set);
        !own.has(&factor.key) || ParamSet::load(&self.word, &options).is_err()
    }

    /// Computes the value from a number of a factor and the file's value, before it is clamped to the range of its key.
    pub(super) fn drawn(&self, factor: usize, acts: Acts, base: f64, number: f64) -> f64 {
        let change = |x: f64, by: &Override| by.number_over(Some(x)).unwrap_or(x);
        let then = &self.then[factor];
        then.iter().fold(acts.resolved(base, number), change)
    }

    /// As [`StudyCar::drawn`], held in the range of the key where the plan says so.
    pub(super) fn resolved(&self, factor: usize, acts: Acts, base: f64, number: f64) -> f64 {
        let value = self.drawn(factor, acts, base, number);
        match self.held[factor] {
            Some(bound) => clipped(value, bound),
            None => value,
        }
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
        let base = match (index, &self.read) {
            (0, Some(read)) => read.clone(),
            _ => ParamSet::load(&self.word, &self.options_of(index, factors)?)?,
        };
        let mut variant = CarVariant {
            setup: base.setup(),
            base,
            params: Vec::with_capacity(factors.len()),
            unknown: Vec::new(),
        };
        for (index, (factor, binding)) in factors.iter().zip(&self.bindings).enumerate() {
            let param = match binding {
                Binding::Number(_) => variant.base.param(&factor.key).map(Some),
                _ => Ok(None),
            };
            variant.params.push(param.unwrap_or_else(|problem| {
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

/// Takes the options of one car from the plan's options for all runs.
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

fn held(plan: &Plan) -> Vec<Option<Bound>> {
    let factors = plan.factors.iter();
    let held = factors.map(|factor| bound_of(factor).filter(|_| plan.clip));
    held.collect()
}

/// Range of the numbers of a factor's key, in its unit.
pub(super) fn bound_of(factor: &Factor) -> Option<Bound> {
    match Override::number(&factor.key, 0.0).row()?.kind {
        Kind::Number(bound) => Some(bound),
        _ => None,
    }
}

/// The nearest value of a range; an end that is not in it is passed by.
fn clipped(value: f64, bound: Bound) -> f64 {
    let low = match bound.includes_low() {
        true => bound.low(),
        false => bound.low().next_up(),
    };
    if value < low {
        low
    } else if value > bound.high() {
        bound.high()
    } else {
        value
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

/// True if the factor scales a value that is 0 in the car's file.
fn is_share_of_zero(binding: Binding, factor: &Factor, own: &ParamSet) -> bool {
    let base = || own.param(&factor.key).map(|param| param.base());
    binding == Binding::Number(Acts::Scale) && base().is_ok_and(|base| base == 0.0)
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
