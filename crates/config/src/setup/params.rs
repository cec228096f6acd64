//! The values of a car by key, and the car that they make.
//!
//! A [`ParamSet`] comes from one validation of the car's files. [`ParamSet::with`] gives a set with another value: a number is checked against
//! its row and put in place of the recorded one, and the parts that depend on it are built again; the other parts are shared. Whatever that
//! cannot do (words, files, keys of an option that is not chosen, values that the car refuses) goes through the documents: the value is put into
//! them as an override, and they are validated again, so that every problem has the words and the place that `--set` gives it.

use std::cell::Cell;
use std::sync::{Arc, PoisonError, Weak};

use super::inputs::{Assembled, Inputs, Validated, head, wrong_keys};
use super::{Files, Options, Setup};
use crate::document::target::path_of;
use crate::reader::recorded::RecordedTable;
use crate::{Input, KeyInfo, Override, Problem, Problems, Reader, Target, unit_of};
use cvtcycle_model::drive::{ChangedParts, Vehicle};

/// The checked values of a car, each with its origin.
///
/// ```
/// use cvtcycle_config::setup::{Options, ParamSet, Setup};
/// let base = ParamSet::load("rover_216_cvt", &Options::default())?;
/// let heavy = base.with("road_load.mass_kg", 1250.0)?;
/// let car = Setup::from_params(&heavy);
/// assert_eq!(car.road_load.base.mass_kg, 1250.0);
/// assert!(base.with("road_load.mass_kg", -1.0).is_err());
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
#[derive(Clone, Debug)]
pub struct ParamSet {
    /// The last reading of documents.
    pub(super) read: Arc<Validated>,
    /// Numbers in SI units by file, in the order of [`Target::CAR`].
    numbers: [Arc<Vec<f64>>; 3],
    /// Numbers set since that reading, in the units of their keys.
    changes: Vec<(Param, f64)>,
    pub(super) assembled: Assembled,
}

/// The place of a number in a set.
#[derive(Clone, Debug)]
pub struct Param {
    of: Arc<ParamRow>,
}

#[derive(Debug)]
struct ParamRow {
    key: String,
    /// Index in [`Target::CAR`].
    file: usize,
    /// Index of the number in the reading of these documents; none of a number that changes which keys are read.
    place: Option<(Weak<Validated>, usize)>,
    base: f64,
    allowed: String,
    is_active: bool,
}

impl Param {
    /// Dotted key with the prefix of its file.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.of.key
    }

    /// Value in the set, or the program's default, in the key's own unit; NaN where there is neither.
    #[must_use]
    pub fn base(&self) -> f64 {
        self.of.base
    }

    /// Unit of the key, `-` for none.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        unit_of(&self.of.key)
    }

    /// Allowed values, in words.
    #[must_use]
    pub fn allowed(&self) -> &str {
        &self.of.allowed
    }

    /// True where the set has the key: it does not belong to an option that is not chosen.
    #[must_use]
    pub fn is_active(&self) -> bool {
        self.of.is_active
    }
}

/// A value for a key.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// A number in the key's unit.
    Number(f64),
    /// A text, a word, or any value as TOML.
    Text(String),
}

impl From<f64> for ParamValue {
    fn from(number: f64) -> Self {
        ParamValue::Number(number)
    }
}

impl From<bool> for ParamValue {
    fn from(flag: bool) -> Self {
        ParamValue::Text(flag.to_string())
    }
}

impl From<&str> for ParamValue {
    fn from(text: &str) -> Self {
        ParamValue::Text(text.to_owned())
    }
}

impl ParamSet {
    /// Reads and checks a vehicle with its fluids, as [`super::load`] does.
    ///
    /// # Errors
    /// All problems of the files and of the overrides.
    pub fn load(word: &str, options: &Options) -> Result<ParamSet, Problems> {
        Ok(ParamSet::from_reading(
            Inputs::gather(word, options)?.validate()?,
        ))
    }

    /// As [`ParamSet::load`], for a vehicle's text, as [`super::read`] takes it.
    ///
    /// # Errors
    /// As there.
    pub fn read(
        file: &str,
        text: &str,
        files: Box<dyn Files>,
        options: &Options,
    ) -> Result<ParamSet, Problems> {
        let inputs = Inputs::parse(file, text, files, options, false)?;
        Ok(ParamSet::from_reading(inputs.validate()?))
    }

    /// As [`ParamSet::read`], for the twin of the vehicle: the same car with a manual box.
    ///
    /// # Errors
    /// As there.
    pub fn read_twin(
        file: &str,
        text: &str,
        files: Box<dyn Files>,
        options: &Options,
    ) -> Result<ParamSet, Problems> {
        let inputs = Inputs::parse(file, text, files, options, true)?;
        Ok(ParamSet::from_reading(inputs.validate()?))
    }

    fn from_reading((read, assembled): (Validated, Assembled)) -> ParamSet {
        let numbers = read.recorded.each_ref();
        ParamSet {
            numbers: numbers.map(|recorded| Arc::new(recorded.numbers.clone())),
            read: Arc::new(read),
            changes: Vec::new(),
            assembled,
        }
    }

    /// The vehicle.
    #[must_use]
    pub fn vehicle(&self) -> &Vehicle {
        &self.assembled.vehicle
    }

    /// Every key with its value and origin, vehicle first, then `lubricant.` and `engine_oil.`.
    #[must_use]
    pub fn keys(&self) -> Vec<KeyInfo> {
        let mut keys = self.read.keys.clone();
        for (param, number) in &self.changes {
            let Some((file, index)) = self.place(param) else {
                continue;
            };
            for info in &mut keys {
                if info.key == param.key() {
                    info.set_number(*number, self.numbers[file][index]);
                } else if is_within(param.key(), &info.key) {
                    // The choice to which the number belongs.
                    info.set_by_key(self.has_table(file, info));
                }
            }
        }
        keys
    }

    /// True where the file of a choice has a table for the option that is chosen.
    fn has_table(&self, file: usize, choice: &KeyInfo) -> bool {
        let document = self.read.inputs.files[file].document.as_ref();
        let path = path_of(&format!("{}.{}", file_of(&choice.key).1, choice.value));
        let path: Vec<&str> = path.iter().map(|name| &**name).collect();
        document.is_some_and(|document| document.root.node(&path).is_some())
    }

    /// The car with its keys and origin, as [`super::load`] gives it.
    #[must_use]
    pub fn setup(&self) -> Setup {
        self.setup_with(self.keys())
    }

    /// As [`ParamSet::setup`], without a copy of the keys that only this set has.
    pub(super) fn into_setup(mut self) -> Setup {
        let keys = match Arc::get_mut(&mut self.read) {
            Some(read) if self.changes.is_empty() => std::mem::take(&mut read.keys),
            _ => self.keys(),
        };
        self.setup_with(keys)
    }

    /// The car with these keys, from which its notes are.
    fn setup_with(&self, keys: Vec<KeyInfo>) -> Setup {
        let notes = self.read.inputs.frame.notes(self.vehicle(), &keys);
        Setup {
            keys,
            origin: self.read.inputs.origin(),
            ..Setup::noted(self, notes)
        }
    }

    /// True where the set has the key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.info(key.trim()).is_some()
    }

    fn info(&self, key: &str) -> Option<&KeyInfo> {
        self.read.info(key)
    }

    /// Finds a number by its dotted key (`lubricant.` and `engine_oil.` for the fluids). It may be at its default; it may also belong to an
    /// option that is not chosen, which a value then chooses.
    ///
    /// # Errors
    /// The problem of an override of an unknown key; a problem for a key that holds no single number.
    pub fn param(&self, key: &str) -> Result<Param, Problem> {
        let key = key.trim();
        let (file, own) = file_of(key);
        let place = self.read.recorded[file].find(own);
        let inactive;
        let (info, is_active) = match self.info(key) {
            Some(info) => (info, true),
            None => {
                inactive = self.elsewhere(key, own, file)?;
                (&inactive, false)
            }
        };
        let change = self.changes.iter().rfind(|(param, _)| param.key() == key);
        let base = match info.si {
            _ if change.is_some() => change.map_or(f64::NAN, |(_, number)| *number),
            Some(_) => info.value.parse().unwrap_or(f64::NAN),
            // Nothing has been given: the kind of the key decides.
            None if info.value.is_empty() && info.is_number => f64::NAN,
            None => return Err(no_number(key, info.clone())),
        };
        Ok(Param {
            of: Arc::new(ParamRow {
                key: key.to_owned(),
                file,
                place: place.map(|index| (Arc::downgrade(&self.read), index)),
                base,
                allowed: info.allowed.clone(),
                is_active,
            }),
        })
    }

    /// A key that the set does not have.
    fn elsewhere(&self, key: &str, own: &str, file: usize) -> Result<KeyInfo, Problem> {
        let unset = |problem: Problem| problem.at(Input::Override(key.to_owned())).value("");
        let by = Override::new(key, "0").map_err(unset)?;
        let inputs = &self.read.inputs;
        let set = std::slice::from_ref(&by);
        if let Some(wrong) = self.wrong_keys(set).pop() {
            return Err(unset(wrong));
        }
        let mut documents = inputs.files.each_ref().map(|file| file.document.clone());
        if let Some(document) = &mut documents[file] {
            document.reach(&by).map_err(unset)?;
        }
        let readers = inputs
            .frame
            .readers(&documents.each_ref().map(Option::as_ref));
        let _ = inputs.frame.assemble(&readers);
        let known = readers[file].as_ref().map(Reader::known);
        let mut known = known.into_iter().flatten();
        if let Some(info) = known.find(|info| info.key == own) {
            return Ok(info);
        }
        let problems = inputs.with(set).validate().err().unwrap_or_default();
        let problem = problems.into_iter().find(|problem| problem.key == own);
        let unknown = || {
            Problem::unknown_key(format!("unknown key `{key}`"))
                .key(key)
                .names_key()
        };
        Err(unset(problem.unwrap_or_else(unknown)))
    }

    fn wrong_keys(&self, set: &[Override]) -> Problems {
        let inputs = &self.read.inputs;
        let document = inputs.files[0].document.as_ref();
        document.map_or_else(Problems::new, |document| {
            wrong_keys(document, set, &inputs.frame.name)
        })
    }

    /// The set with another value of a key.
    ///
    /// # Errors
    /// All problems of the car with that value, at the place of the override `KEY=VALUE`.
    pub fn with(&self, key: &str, value: impl Into<ParamValue>) -> Result<ParamSet, Problems> {
        let key = key.trim();
        match value.into() {
            ParamValue::Number(number) if self.has(key) => match self.param(key) {
                Ok(param) => self.with_numbers(&[(&param, number)]),
                Err(_) => self.validated_with([Override::number(key, number)]),
            },
            ParamValue::Number(number) => self.validated_with([Override::number(key, number)]),
            ParamValue::Text(text) => self.validated_with([Override::new(key, &text)?]),
        }
    }

    /// The set with other numbers, each in the unit of its key. They are checked together: the car that they make is what counts, whatever
    /// their order.
    ///
    /// # Errors
    /// As of [`ParamSet::with`].
    pub fn with_numbers(&self, numbers: &[(&Param, f64)]) -> Result<ParamSet, Problems> {
        let known = self.rebuilt(numbers);
        if let Some(set) = known.or_else(|| self.with_other_options(numbers)) {
            return Ok(set);
        }
        self.validated_with(overrides(numbers))
    }

    /// As [`ParamSet::rebuilt`], for numbers of options that these files do not choose. The last choice is kept: the points of a study make the
    /// same one.
    fn with_other_options(&self, numbers: &[(&Param, f64)]) -> Option<ParamSet> {
        let mut of_option = numbers.to_vec();
        of_option.retain(|(param, _)| self.place(param).is_none());
        let keys: Vec<&str> = of_option.iter().map(|(param, _)| param.key()).collect();
        if keys.is_empty() {
            return None;
        }
        let mut last = self
            .read
            .chosen
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        if last.as_ref().is_none_or(|(of, _)| *of != keys) {
            let files = self.read.inputs.with(&overrides(&of_option));
            let set = ParamSet::from_reading(files.validate().ok()?);
            let keys = keys.into_iter().map(str::to_owned);
            *last = Some((keys.collect(), set));
        }
        let (_, set) = last.as_ref()?;
        let changes = self.changes.iter().map(|(param, number)| (param, *number));
        let all: Vec<(&Param, f64)> = changes.chain(numbers.iter().copied()).collect();
        set.rebuilt(&all)
    }

    /// Index of the file and of the number of a parameter, which may be that of another set.
    fn place(&self, param: &Param) -> Option<(usize, usize)> {
        let file = param.of.file;
        match &param.of.place {
            Some((read, index)) if read.as_ptr() == Arc::as_ptr(&self.read) => Some((file, *index)),
            _ => {
                let index = self.read.recorded[file].find(file_of(param.key()).1);
                index.map(|index| (file, index))
            }
        }
    }

    /// The set with numbers in place of recorded ones and the parts that they concern built again; none where that is no possible car, or
    /// not all of it.
    fn rebuilt(&self, numbers: &[(&Param, f64)]) -> Option<ParamSet> {
        let mut values = self.numbers.clone();
        let (mut parts, mut is_head) = (ChangedParts::default(), false);
        for (param, number) in numbers {
            let (file, index) = self.place(param)?;
            let row = &self.read.recorded[file].rows[index];
            let si = row.to_si(*number)?;
            Arc::make_mut(&mut values[file])[index] = si;
            match Target::CAR[file] {
                Target::Lubricant => parts.oil = true,
                Target::EngineOil => parts.engine_oil = true,
                _ => is_head |= !parts.add_key(&row.key),
            }
        }
        let (frame, refused) = (&self.read.inputs.frame, Cell::new(false));
        let root =
            |file: usize| RecordedTable::root(&self.read.recorded[file], &values[file], &refused);
        let head = match is_head {
            true => Arc::new(head(&root(0), &frame.name)),
            false => Arc::clone(&self.assembled.head),
        };
        let base = &self.assembled.vehicle;
        let mut oils = base.shared_oils();
        for (k, changed) in [parts.oil, parts.engine_oil].into_iter().enumerate() {
            if changed {
                oils[k] = frame.lubricant(&root(1 + k), k);
            }
        }
        let vehicle = frame.vehicle(&root(0), oils, Some((base, &parts)));
        if refused.get() {
            return None;
        }
        let new = numbers.iter();
        let new = new.map(|(param, number)| ((*param).clone(), *number));
        Some(ParamSet {
            read: Arc::clone(&self.read),
            changes: self.changes.iter().cloned().chain(new).collect(),
            numbers: values,
            assembled: Assembled { head, vehicle },
        })
    }

    /// The set with overrides, from its documents.
    fn validated_with(
        &self,
        set: impl IntoIterator<Item = Override>,
    ) -> Result<ParamSet, Problems> {
        let changes = self.changes.iter().map(|(param, number)| (param, *number));
        let changes = overrides(&changes.collect::<Vec<_>>());
        let mut all: Vec<Override> = Vec::new();
        for by in changes.into_iter().chain(set) {
            // The last value of a key, at the place of its first.
            match all.iter_mut().find(|old| old.key() == by.key()) {
                Some(old) => *old = by,
                None => all.push(by),
            }
        }
        self.wrong_keys(&all).finish()?;
        let changed = self.read.inputs.with(&all);
        changed.validate().map(ParamSet::from_reading)
    }
}

/// True for a key in the table of another one.
fn is_within(key: &str, table: &str) -> bool {
    let rest = key.strip_prefix(table);
    rest.is_some_and(|rest| rest.starts_with('.'))
}

/// Numbers as overrides of the files.
fn overrides(numbers: &[(&Param, f64)]) -> Vec<Override> {
    let numbers = numbers.iter();
    let number = |(param, number): &(&Param, f64)| Override::number(param.key(), *number);
    numbers.map(number).collect()
}

/// Index of the file of a key in [`Target::CAR`], and the key in it.
fn file_of(key: &str) -> (usize, &str) {
    let (target, own) = Target::from_key(key);
    let file = Target::CAR.iter().position(|of| *of == target);
    (file.unwrap_or(0), own)
}

fn no_number(key: &str, info: KeyInfo) -> Problem {
    Problem::not_single(format!("`{key}` holds no single number"))
        .at(Input::Override(key.to_owned()))
        .key(key)
        .names_key()
        .value(info.value)
        .allowed(info.allowed)
        .hint("give its values as texts")
}
