//! One car, built again and again with other numbers.
//!
//! A study drives up to a million cars that differ in a few numbers. A [`VehicleTemplate`] parses and checks the files once; a [`Variant`], one a
//! thread, changes numbers in the parsed documents and reads them silently ([`Reader::check_only`]): with the same readers, checks and results
//! as [`super::load`], but without a text for every key. The texts of problems come from an ordinary reading, done when a car is refused.

use std::collections::HashMap;
use std::sync::Arc;

use super::inputs::{FLUIDS, Input, Inputs};
use super::{Options, Setup, wrong_transmission};
use crate::{Document, KeyInfo, KeyPath, PatchedDocument, Problem, Problems, Reader, unit_of};

/// The parsed and checked files of one car.
#[derive(Clone, Debug)]
pub struct VehicleTemplate {
    inputs: Arc<Inputs>,
    /// Of every key what a slot needs: value and range.
    keys: HashMap<String, KeyInfo>,
}

/// Place of a number in the files of a template.
#[derive(Clone, Debug)]
pub struct ParameterRef {
    key: Arc<str>,
    /// Index of vehicle, transmission oil or engine oil.
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
}

impl VehicleTemplate {
    /// Reads and checks a vehicle with its fluids as [`super::load`] does; also gives the unchanged car.
    ///
    /// # Errors
    /// All problems of the files and of the overrides.
    pub fn load(
        word: &str,
        option: &str,
        options: &Options,
    ) -> Result<(VehicleTemplate, Setup), Problems> {
        let inputs = Inputs::gather(word, option, options)?;
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
        Ok((
            VehicleTemplate {
                inputs: Arc::new(inputs),
                keys,
            },
            setup,
        ))
    }

    /// Finds a number by its dotted key, as `--set` has it (`lubricant.` and `engine_oil.` for the fluids). The files may leave it at its
    /// default; it may also belong to an option that they do not choose, which is then chosen as by `--set`.
    ///
    /// # Errors
    /// What `--set` would say of an unknown key; a problem for a key that holds no single number.
    pub fn slot(&self, key: &str) -> Result<ParameterRef, Problem> {
        let key = key.trim();
        let file = FLUIDS
            .iter()
            .position(|prefix| key.starts_with(prefix))
            .map_or(0, |k| k + 1);
        let own = if file == 0 {
            key
        } else {
            key.strip_prefix(FLUIDS[file - 1]).unwrap_or(key)
        };
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
        let path = own.split('.').map(|name| name.trim().into()).collect();
        Ok(ParameterRef {
            key: key.into(),
            file,
            path,
            base,
            allowed: info.allowed.into(),
            inactive,
        })
    }

    /// A key that the unchanged files do not ask for.
    fn elsewhere(&self, key: &str, own: &str, file: usize) -> Result<KeyInfo, Problem> {
        let unset = |problem: Problem| problem.in_file(format!("--set {key}")).value(String::new());
        if let Some(document) = &self.inputs.files[0].document
            && let Some(wrong) = wrong_transmission::wrong_transmission_keys(
                document,
                &[format!("{key}=0")],
                &self.inputs.frame.name,
            )
            .pop()
        {
            return Err(unset(wrong));
        }
        let mut documents = self
            .inputs
            .files
            .each_ref()
            .map(|input| input.document.clone());
        if let Some(document) = &mut documents[file] {
            document.reach(own).map_err(unset)?;
        }
        let readers = documents.each_ref().map(|document| {
            let reader = |document| Reader::new(document).with_files(&self.inputs.frame.files);
            document.as_ref().map(reader)
        });
        let _ = self.inputs.frame.assemble(&readers);
        let known = readers[file]
            .as_ref()
            .map(Reader::known)
            .unwrap_or_default();
        if let Some(info) = known.into_iter().find(|info| info.key == own) {
            return Ok(info);
        }
        let problems = changed(&self.inputs, &[(file, own.to_owned(), 0.0)])
            .read()
            .err()
            .unwrap_or_default();
        let problem = problems.into_iter().find(|problem| problem.key == own);
        Err(unset(problem.unwrap_or_else(|| {
            Problem::unknown_key(format!("unknown key `{key}`")).key(key)
        })))
    }

    /// A thread's own copy of the files, unchanged.
    #[must_use]
    pub fn bench(&self) -> Variant {
        let empty =
            Document::parse("", "").unwrap_or_else(|_| unreachable!("no text has no mistakes"));
        let drafts = self
            .inputs
            .files
            .each_ref()
            .map(|input| PatchedDocument::new(input.document.as_ref().unwrap_or(&empty)));
        Variant {
            inputs: Arc::clone(&self.inputs),
            drafts,
            conflicts: Vec::new(),
            inactive: Vec::new(),
            checked: Vec::new(),
        }
    }
}

fn no_number(key: &str, info: KeyInfo) -> Problem {
    Problem::not_single(format!("`{key}` holds no single number"))
        .in_file(format!("--set {key}"))
        .key(key)
        .value(info.value)
        .allowed(info.allowed)
        .hint("give its values as texts")
}

/// The files with numbers set as by `--set`, in order: index of the file, key without prefix, value.
fn changed(inputs: &Inputs, numbers: &[(usize, String, f64)]) -> Inputs {
    let mut files = inputs.files.clone();
    for (file, key, number) in numbers {
        let Input {
            document: Some(document),
            problems,
        } = &mut files[*file]
        else {
            continue;
        };
        // TOML has its own word for what is no number.
        let text = if number.is_nan() {
            "nan".to_owned()
        } else {
            number.to_string()
        };
        if let Err(mut problem) = document.set(&format!("{key}={text}")) {
            if *file > 0 {
                problem.place.file = format!("--set {}{key}={text}", FLUIDS[*file - 1]);
            }
            problems.push(problem);
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
    /// Vehicle, transmission oil, engine oil.
    drafts: [PatchedDocument; 3],
    /// Numbers that could not be put in, because another one is in the way.
    conflicts: Vec<(ParameterRef, f64)>,
    /// Numbers of options that the files do not choose.
    inactive: Vec<Arc<str>>,
    /// Such numbers, for which it is known that no key is left over.
    checked: Vec<Arc<str>>,
}

impl Variant {
    /// Puts in a number, in the unit of the slot's key. The car is what [`super::load`] makes of `--set KEY=NUMBER`.
    pub fn set(&mut self, slot: &ParameterRef, number: f64) {
        if !self.drafts[slot.file].set(&slot.path, number) {
            self.conflicts.push((slot.clone(), number));
        }
        if slot.inactive && !self.inactive.contains(&slot.key) {
            self.inactive.push(Arc::clone(&slot.key));
        }
    }

    /// Takes all numbers back.
    pub fn reset(&mut self) {
        self.drafts.iter_mut().for_each(PatchedDocument::reset);
        self.conflicts.clear();
        self.inactive.clear();
    }

    /// The car with the numbers in force; it has no [`Setup::keys`].
    ///
    /// # Errors
    /// How many problems it has.
    pub fn build(&mut self) -> Result<Setup, Rejected> {
        let rejected = |problems: usize| Err(Rejected { problems });
        if !self.conflicts.is_empty() {
            return rejected(self.conflicts.len());
        }
        let readers = self.drafts.each_ref().map(|draft| {
            Some(Reader::check_only(draft.document()).with_files(&self.inputs.frame.files))
        });
        let setup = match self.inputs.frame.assemble(&readers) {
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

    /// What is wrong with the car, in the words that [`super::load`] has for `--set KEY=NUMBER`; nothing if all is well. Takes as long as
    /// an ordinary reading.
    #[must_use]
    pub fn problems(&self) -> Problems {
        let of_file = |(file, draft): (usize, &PatchedDocument)| {
            draft
                .numbers()
                .map(|(key, number)| (file, key, number))
                .collect::<Vec<_>>()
        };
        let conflicts = self
            .conflicts
            .iter()
            .map(|(slot, number)| (slot.file, slot.path.join("."), *number));
        let numbers: Vec<_> = self
            .drafts
            .iter()
            .enumerate()
            .flat_map(of_file)
            .chain(conflicts)
            .collect();
        changed(&self.inputs, &numbers)
            .read()
            .err()
            .unwrap_or_default()
    }
}
