//! One car, built again and again with other numbers.
//!
//! A study drives up to a million cars that differ in a few numbers. A [`VehicleTemplate`] parses and checks the files once; a [`Variant`], one a
//! thread, changes numbers in the parsed documents and reads them in check-only mode ([`Reader::check_only`]): with the same readers, checks and
//! results as [`super::load`], but without a text for every key. The texts of problems come from an ordinary reading, done when a car is refused.

use std::collections::HashMap;
use std::sync::Arc;

use super::inputs::{Anew, Earlier, Inputs, Read, wrong_keys};
use super::{Files, Options, Setup};
use crate::document::target::path_of;
use crate::{
    Document, Input, KeyInfo, KeyPath, Override, PatchedDocument, Problem, Problems, Reader,
    Target, unit_of,
};

/// The parsed and checked files of one car.
#[derive(Clone, Debug)]
pub struct VehicleTemplate {
    inputs: Arc<Inputs>,
    /// The unchanged car.
    read: Arc<Read>,
    /// Of every key what a reference needs: value and range.
    keys: HashMap<String, KeyInfo>,
}

/// Place of a number in the files of a template.
#[derive(Clone, Debug)]
pub struct ParameterRef {
    key: Arc<str>,
    /// Index in [`Target::CAR`].
    file: usize,
    path: KeyPath,
    base: f64,
    allowed: Arc<str>,
    /// Not read as long as the files are unchanged: it belongs to an option that the number itself chooses.
    inactive: bool,
}

impl ParameterRef {
    /// Dotted key with the prefix of its file.
    #[must_use]
    pub fn key(&self) -> &str {
        &self.key
    }

    /// Value of the file, or the program's default, in the key's own unit; NaN where there is neither.
    #[must_use]
    pub fn base(&self) -> f64 {
        self.base
    }

    /// Unit of the key, `-` for none.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        unit_of(&self.key)
    }

    /// What the key accepts, in words.
    #[must_use]
    pub fn allowed(&self) -> &str {
        &self.allowed
    }

    /// Whether the unchanged files have the key: not one of an option that they do not choose.
    #[must_use]
    pub fn is_active(&self) -> bool {
        !self.inactive
    }
}

impl VehicleTemplate {
    /// Reads and checks a vehicle with its fluids as [`super::load`] does; also gives the unchanged car.
    ///
    /// # Errors
    /// All problems of the files and of the overrides.
    ///
    /// ```
    /// use cvtcycle_config::setup::{Options, template::VehicleTemplate};
    /// let (template, _) = VehicleTemplate::load("rover_216_cvt", &Options::default())?;
    /// let mass = template.slot("road_load.mass_kg")?;
    /// let mut variant = template.bench();
    /// variant.set(&mass, 2.0 * mass.base());
    /// assert_eq!(variant.build().unwrap().road_load.base.mass_kg, 2.0 * mass.base());
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    pub fn load(word: &str, options: &Options) -> Result<(VehicleTemplate, Setup), Problems> {
        VehicleTemplate::of(Inputs::gather(word, options)?)
    }

    /// As [`VehicleTemplate::load`], for a vehicle's text, as [`super::read`] takes it.
    ///
    /// # Errors
    /// As there.
    pub fn read(
        file: &str,
        text: &str,
        files: Box<dyn Files>,
        options: &Options,
    ) -> Result<(VehicleTemplate, Setup), Problems> {
        VehicleTemplate::of(Inputs::of_text(file, text, files, options)?)
    }

    fn of(inputs: Inputs) -> Result<(VehicleTemplate, Setup), Problems> {
        let setup = inputs.read()?;
        let known = |info: &KeyInfo| KeyInfo {
            value: info.value.clone(),
            si: info.si,
            allowed: info.allowed.clone(),
            is_number: info.is_number,
            ..KeyInfo::default()
        };
        let keys = setup
            .keys
            .iter()
            .map(|info| (info.key.clone(), known(info)))
            .collect();
        let template = VehicleTemplate {
            inputs: Arc::new(inputs),
            read: Arc::new(Read::of(&setup)),
            keys,
        };
        Ok((template, setup))
    }

    /// Whether the unchanged files have the key.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.keys.contains_key(key.trim())
    }

    /// Finds a number by its dotted key (`lubricant.` and `engine_oil.` for the fluids). The files may leave it at its default; it may
    /// also belong to an option that they do not choose, which an override of the key then chooses.
    ///
    /// # Errors
    /// The problem of an override of an unknown key; a problem for a key that holds no single number.
    pub fn slot(&self, key: &str) -> Result<ParameterRef, Problem> {
        let key = key.trim();
        let (target, own) = Target::of(key);
        let file = Target::CAR.iter().position(|of| *of == target).unwrap_or(0);
        let (info, inactive) = match self.keys.get(key) {
            Some(info) => (info.clone(), false),
            None => (self.elsewhere(key, own, file)?, true),
        };
        let base = match info.si {
            Some(_) => info.value.parse().unwrap_or(f64::NAN),
            // Nothing has been given: the kind of the key decides.
            None if info.value.is_empty() && info.is_number => f64::NAN,
            None => return Err(no_number(key, info)),
        };
        Ok(ParameterRef {
            key: key.into(),
            file,
            path: path_of(own),
            base,
            allowed: info.allowed.into(),
            inactive,
        })
    }

    /// A key that the unchanged files do not ask for.
    fn elsewhere(&self, key: &str, own: &str, file: usize) -> Result<KeyInfo, Problem> {
        let unset = |problem: Problem| problem.at(Input::Override(key.to_owned())).value("");
        let by = Override::new(key, "0").map_err(unset)?;
        let inputs = &self.inputs;
        let set = std::slice::from_ref(&by);
        if let Some(document) = &inputs.files[0].document
            && let Some(wrong) = wrong_keys(document, set, &inputs.frame.name).pop()
        {
            return Err(unset(wrong));
        }
        let mut documents = inputs.files.each_ref().map(|file| file.document.clone());
        if let Some(document) = &mut documents[file] {
            document.reach(&by).map_err(unset)?;
        }
        let reader = |document| Reader::new(document).with_files(&inputs.frame.files);
        let readers = documents
            .each_ref()
            .map(|document| document.as_ref().map(reader));
        let _ = inputs.frame.assemble(&readers, None);
        let known = readers[file].as_ref().map(Reader::known);
        let mut known = known.into_iter().flatten();
        if let Some(info) = known.find(|info| info.key == own) {
            return Ok(info);
        }
        let problems = changed(inputs, set).read().err().unwrap_or_default();
        let problem = problems.into_iter().find(|problem| problem.key == own);
        let unknown = || {
            Problem::unknown_key(format!("unknown key `{key}`"))
                .key(key)
                .names_key()
        };
        Err(unset(problem.unwrap_or_else(unknown)))
    }

    /// A thread's own copy of the files, unchanged.
    #[must_use]
    pub fn bench(&self) -> Variant {
        let empty =
            Document::parse("", "").unwrap_or_else(|_| unreachable!("no text has no mistakes"));
        let document =
            |document: &Option<Document>| PatchedDocument::new(document.as_ref().unwrap_or(&empty));
        Variant {
            inputs: Arc::clone(&self.inputs),
            read: Arc::clone(&self.read),
            anew: Anew::default(),
            documents: self
                .inputs
                .files
                .each_ref()
                .map(|file| document(&file.document)),
            numbers: Vec::new(),
            conflicts: 0,
            inactive: Vec::new(),
            checked: Vec::new(),
        }
    }
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

/// The files with more overrides.
fn changed(inputs: &Inputs, set: &[Override]) -> Inputs {
    let mut files = inputs.files.clone();
    for (file, target) in files.iter_mut().zip(Target::CAR) {
        let of_file = set.iter().filter(|by| by.target() == target);
        if let Some(document) = &mut file.document {
            let refused = of_file.filter_map(|by| document.set(by).err());
            file.problems.extend(refused);
        }
    }
    inputs.with_files(files)
}

/// A car was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// Number of problems, as counted; [`Variant::problems`] has their words.
    pub problems: usize,
}

/// A template's documents with changed numbers.
#[derive(Clone, Debug)]
pub struct Variant {
    inputs: Arc<Inputs>,
    /// The unchanged car.
    read: Arc<Read>,
    /// Which of its parts the numbers change.
    anew: Anew,
    /// In the order of [`Target::CAR`].
    documents: [PatchedDocument; 3],
    /// The numbers in force, in the order in which they came.
    numbers: Vec<(ParameterRef, f64)>,
    /// So many of them could not be put in, because another one is in the way.
    conflicts: usize,
    /// Numbers of options that the files do not choose.
    inactive: Vec<Arc<str>>,
    /// Such numbers, for which it is known that no key is left over.
    checked: Vec<Arc<str>>,
}

impl Variant {
    /// Puts in a number, in the unit of the key. The car is what [`super::load`] makes of an [`Override::number`].
    pub fn set(&mut self, slot: &ParameterRef, number: f64) {
        if !self.documents[slot.file].set(&slot.path, number) {
            self.conflicts += 1;
        }
        self.anew.add(slot.file, &slot.path);
        if slot.inactive && !self.inactive.contains(&slot.key) {
            self.inactive.push(Arc::clone(&slot.key));
        }
        let same = |(set, _): &&mut (ParameterRef, f64)| set.key == slot.key;
        match self.numbers.iter_mut().find(same) {
            Some((_, old)) => *old = number,
            None => self.numbers.push((slot.clone(), number)),
        }
    }

    /// Takes all numbers back.
    pub fn reset(&mut self) {
        self.documents.iter_mut().for_each(PatchedDocument::reset);
        self.numbers.clear();
        self.conflicts = 0;
        self.inactive.clear();
        self.anew = Anew::default();
    }

    /// The car with the numbers in force; it has no [`Setup::keys`].
    ///
    /// # Errors
    /// How many problems it has.
    pub fn build(&mut self) -> Result<Setup, Rejected> {
        let rejected = |problems: usize| Err(Rejected { problems });
        if self.conflicts > 0 {
            return rejected(self.conflicts);
        }
        let readers = self.documents.each_ref().map(|patched| {
            Some(Reader::check_only(patched.document()).with_files(&self.inputs.frame.files))
        });
        let earlier = Earlier {
            read: &self.read,
            anew: self.anew,
        };
        let setup = match self.inputs.frame.assemble(&readers, Some(&earlier)) {
            Ok(setup) => setup,
            Err(problems) => return rejected(problems.len()),
        };
        let found = readers
            .into_iter()
            .flatten()
            .map(|reader| reader.finish().err().map_or(0, |problems| problems.len()))
            .sum();
        if found > 0 {
            return rejected(found);
        }
        // A check-only reading does not look for unknown keys. Only a number that chooses an option can leave such keys behind, and
        // which keys these are does not depend on its value.
        if self.inactive != self.checked {
            let problems = self.problems();
            if !problems.is_empty() {
                return rejected(problems.len());
            }
            self.checked.clone_from(&self.inactive);
        }
        Ok(setup)
    }

    /// What is wrong with the car, in the words that [`super::load`] has for overrides with these numbers; nothing if all is well. Takes
    /// as long as an ordinary reading.
    #[must_use]
    pub fn problems(&self) -> Problems {
        let number = |(slot, number): &(ParameterRef, f64)| Override::number(&slot.key, *number);
        let set: Vec<Override> = self.numbers.iter().map(number).collect();
        changed(&self.inputs, &set).read().err().unwrap_or_default()
    }
}
