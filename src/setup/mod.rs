//! Checked files to a car: vehicle, fluids, overrides, ambient.
//!
//! A name without a path and without `.toml` is an embedded file; anything else is a path.

pub mod assumptions;
pub mod catalogue;
mod embedded;
mod other_box;
pub mod equations;
pub mod tables;

pub use embedded::{embedded_lubricants, embedded_map, embedded_rigs, embedded_vehicles};

use crate::config::{Bound, Document, KeyInfo, Place, Problem, Reader, decode, near};
use crate::lubricant::{self, Lubricant};
use crate::simulate::Car;
use crate::transmission::cvt::variator::Formulation;
use crate::transmission::{Transmission, cvt, manual};
use crate::vehicle::RoadLoadInput;
use crate::{engine, thermal, vehicle};

/// Reads files that an input names; the only way in which loading touches the disk.
pub trait Files {
    /// Bytes of a file.
    ///
    /// # Errors
    /// The operating system's words.
    fn read(&self, path: &str) -> Result<Vec<u8>, String>;
}

/// The disk, with names relative to a folder.
#[derive(Clone, Debug, Default)]
pub struct Disk {
    /// Folder of the file that names others; empty for the current one.
    pub folder: std::path::PathBuf,
}

impl Files for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(self.folder.join(path)).map_err(|e| e.to_string())
    }
}

/// What the user asks for beside the vehicle file.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Transmission oil, name or path; the vehicle's own if none.
    pub lubricant: Option<String>,
    /// Engine oil, name or path; the vehicle's own if none.
    pub engine_oil: Option<String>,
    /// `KEY=VALUE` overrides; `lubricant.` and `engine_oil.` go to those files.
    pub set: Vec<String>,
    /// Reading of the belt model.
    pub formulation: Formulation,
}

/// A vehicle with its fluids, checked, before an ambient is known.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Name of the vehicle file without `.toml`.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Names of its baselines.
    pub baselines: Vec<String>,
    /// Road load.
    pub road_load: RoadLoadInput,
    /// Everything else, for 20 degC.
    car: Car,
    /// Every key that was read, vehicle first, then `lubricant.` and `engine_oil.`.
    pub keys: Vec<KeyInfo>,
}

impl Setup {
    /// The car at an ambient temperature, K.
    #[must_use]
    pub fn car(&self, ambient_k: f64) -> Car {
        let mut car = self.car.clone();
        car.road_load = self.road_load.at(ambient_k);
        car.full_load_factor = self.road_load.full_load_factor();
        car.ambient_k = ambient_k;
        car
    }

    /// The car's transmission.
    #[must_use]
    pub fn transmission(&self) -> &Transmission {
        &self.car.transmission
    }

    /// The car's engine.
    #[must_use]
    pub fn engine(&self) -> &engine::Engine {
        &self.car.engine
    }

    /// Names of transmission and engine oil.
    #[must_use]
    pub fn oils(&self) -> (&Lubricant, &Lubricant) {
        (&self.car.oil, &self.car.engine_oil)
    }
}

/// Kinds of input file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A vehicle.
    Vehicle,
    /// A lubricant.
    Lubricant,
    /// What a test rig is set to.
    Rig,
}

impl Kind {
    fn embedded(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Kind::Vehicle => embedded_vehicles(),
            Kind::Lubricant => embedded_lubricants(),
            Kind::Rig => embedded_rigs(),
        }
    }

    fn word(self) -> &'static str {
        match self {
            Kind::Vehicle => "vehicle",
            Kind::Lubricant => "lubricant",
            Kind::Rig => "rig",
        }
    }
}

/// Whether a word given by the user is meant as a path.
#[must_use]
pub fn is_path(word: &str) -> bool {
    word.contains(['/', '\\']) || std::path::Path::new(word).extension().is_some()
}

/// Text of an input and the name under which problems cite it.
///
/// # Errors
/// Unknown name (with the near ones), unreadable path, binary or empty file.
pub fn text_of(word: &str, kind: Kind, option: &str) -> Result<(String, String, Disk), Vec<Problem>> {
    if !is_path(word) {
        if let Some((name, text)) = kind.embedded().iter().find(|(n, _)| *n == word) {
            return Ok((format!("embedded:{name}.toml"), (*text).to_owned(), Disk::default()));
        }
        return Err(vec![unknown_name(word, kind, option)]);
    }
    let path = std::path::Path::new(word);
    let bytes = std::fs::read(path).map_err(|e| vec![unreadable(word, option, &e.to_string())])?;
    let folder = path.parent().map(std::path::Path::to_path_buf).unwrap_or_default();
    Ok((word.to_owned(), decode(word, &bytes)?, Disk { folder }))
}

fn unknown_name(word: &str, kind: Kind, option: &str) -> Problem {
    let names: Vec<&str> = kind.embedded().iter().map(|(n, _)| *n).collect();
    let close = near(word, names.iter().copied());
    let hint = if close.is_empty() { String::new() } else { format!("did you mean {}? ", close.join(", ")) };
    Problem {
        place: Place { file: option.to_owned(), ..Place::default() },
        key: option.to_owned(),
        value: word.to_owned(),
        allowed: format!("{}, or the path of a TOML file", names.join(", ")),
        message: format!("there is no {} named `{word}`", kind.word()),
        hint: format!("{hint}`cvtcycle list {}s` shows all; a path needs a / or an ending", kind.word()),
    }
}

fn unreadable(word: &str, option: &str, why: &str) -> Problem {
    Problem {
        place: Place { file: option.to_owned(), ..Place::default() },
        key: option.to_owned(),
        value: word.to_owned(),
        allowed: "a readable file".into(),
        message: format!("cannot read `{word}`: {why}"),
        hint: "check the path and its permissions".into(),
    }
}

fn stem(word: &str) -> String {
    std::path::Path::new(word).file_stem().map_or_else(|| word.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Reads and checks a lubricant.
///
/// # Errors
/// All problems of the file and of the overrides that go to it.
pub fn load_lubricant(word: &str, option: &str, sets: &[String], prefix: &str) -> Result<(Lubricant, Vec<KeyInfo>), Vec<Problem>> {
    let (file, text, _) = text_of(word, Kind::Lubricant, option)?;
    let mut document = Document::parse(&file, &text)?;
    let as_given = |problems: Vec<Problem>| problems.into_iter().map(|problem| whole_option(problem, prefix)).collect::<Vec<_>>();
    apply(&mut document, sets, |key| key.strip_prefix(prefix).map(str::to_owned)).map_err(as_given)?;
    let reader = Reader::new(&document);
    let lubricant = lubricant::load(&reader.root(), &stem(word));
    let keys = reader.finish().map_err(as_given)?;
    let keys = keys.into_iter().map(|k| KeyInfo { key: format!("{prefix}{}", k.key), ..k }).collect();
    Ok((lubricant, keys))
}

/// A problem of an override of a fluid, with the option as the user wrote it: the fluid's own keys have no prefix.
fn whole_option(mut problem: Problem, prefix: &str) -> Problem {
    if let Some(assignment) = problem.place.file.strip_prefix("--set ") {
        problem.place.file = format!("--set {prefix}{assignment}");
    }
    problem
}

/// Applies those overrides whose key `pick` accepts (and may rename).
fn apply(document: &mut Document, sets: &[String], pick: impl Fn(&str) -> Option<String>) -> Result<(), Vec<Problem>> {
    let mut problems = Vec::new();
    for set in sets {
        if let Some(assignment) = pick(set)
            && let Err(problem) = document.set(&assignment)
        {
            problems.push(problem);
        }
    }
    if problems.is_empty() { Ok(()) } else { Err(problems) }
}

const FLUIDS: [&str; 2] = ["lubricant.", "engine_oil."];

/// Reads and checks a vehicle with its fluids.
///
/// # Errors
/// All problems of the vehicle file, of its fluids and of the overrides.
pub fn load(word: &str, option: &str, options: &Options) -> Result<Setup, Vec<Problem>> {
    let (file, text, disk) = text_of(word, Kind::Vehicle, option)?;
    let mut problems = Vec::new();
    let mut document = Document::parse(&file, &text)?;
    let own = |key: &str| (!FLUIDS.iter().any(|f| key.starts_with(f))).then(|| key.to_owned());
    let strangers = other_box::strangers(&document, &options.set, &stem(word));
    if !strangers.is_empty() {
        return Err(strangers); // set all the same, they would call for a whole box
    }
    if let Err(mut p) = apply(&mut document, &options.set, own) {
        problems.append(&mut p);
    }
    let reader = Reader::new(&document);
    let root = reader.root();
    let Head { title, baselines, fluid, engine_oil } = head(&root, &stem(word));
    let mut fluid_keys = Vec::new();
    let mut read_fluid = |own: &str, asked: &Option<String>, option: &str, prefix: &str| {
        // A path in the vehicle file is relative to that file, one on the command line to the current folder.
        let beside = if is_path(own) { disk.folder.join(own).to_string_lossy().into_owned() } else { own.to_owned() };
        let word = asked.as_deref().unwrap_or(&beside);
        let option = if asked.is_some() { option } else { file.as_str() };
        match load_lubricant(word, option, &options.set, prefix) {
            Ok((oil, mut keys)) => {
                fluid_keys.append(&mut keys);
                Some(oil)
            }
            Err(mut p) => {
                if !word.is_empty() {
                    problems.append(&mut p);
                }
                None
            }
        }
    };
    let oil = read_fluid(&fluid, &options.lubricant, "--lubricant", "lubricant.");
    let engine_oil = read_fluid(&engine_oil, &options.engine_oil, "--engine-oil", "engine_oil.");
    let placeholder = load_lubricant("cvtf_ezl799_class", "", &[], "").map(|l| l.0);
    let (oil, engine_oil) = match (oil, engine_oil, placeholder) {
        (Some(a), Some(b), _) => (a, b),
        (a, b, Ok(p)) => (a.unwrap_or_else(|| p.clone()), b.unwrap_or(p)),
        (_, _, Err(p)) => return Err(p),
    };
    let (road_load, car) = parts(&root, &disk, oil, engine_oil, options.formulation, stem(word));
    let keys = match reader.finish() {
        Ok(keys) => keys,
        Err(mut p) => {
            p.append(&mut problems);
            return Err(p);
        }
    };
    if !problems.is_empty() {
        return Err(problems);
    }
    let baselines = baselines.split(',').map(|b| b.trim().to_owned()).filter(|b| !b.is_empty()).collect();
    Ok(Setup { name: stem(word), title, baselines, road_load, car, keys: keys.into_iter().chain(fluid_keys).collect() })
}

/// What the `[vehicle]` table says.
struct Head {
    title: String,
    baselines: String,
    fluid: String,
    engine_oil: String,
}

fn head(root: &crate::config::Section, name: &str) -> Head {
    let head = root.table("vehicle");
    Head {
        title: head.text_or("title", name, "name for people"),
        baselines: head.text_or("baselines", "", "names of the baseline vehicles, comma separated"),
        fluid: head.text("transmission_oil", "name of the transmission oil"),
        engine_oil: head.text("engine_oil", "name of the engine oil"),
    }
}

fn parts(
    root: &crate::config::Section,
    disk: &Disk,
    oil: Lubricant,
    engine_oil: Lubricant,
    formulation: Formulation,
    name: String,
) -> (RoadLoadInput, Car) {
    let road_load = vehicle::load(&root.table("road_load"));
    let engine = engine::load(&root.table("engine"), disk);
    let (kind, section) = root.choose("transmission", &["cvt", "manual"], None, "kind of transmission");
    let (transmission, belt_heat_share) = if kind == "cvt" {
        let cvt = cvt::load(&section, disk, &engine, &oil, formulation);
        let share = cvt.belt_heat_share;
        (Transmission::Cvt(Box::new(cvt)), share)
    } else {
        (Transmission::Manual(Box::new(manual::load(&section, disk))), 0.0)
    };
    let network = thermal::load(&root.table("thermal"), kind == "cvt", &oil);
    let car = Car {
        name,
        road_load: road_load.base,
        transmission,
        engine,
        network,
        oil,
        engine_oil,
        ambient_k: vehicle::REFERENCE_K,
        full_load_factor: 1.0,
        belt_heat_share,
    };
    (road_load, car)
}

/// Range of ambient temperatures, degC (test cell of the thesis widened).
pub const AMBIENT: Bound = Bound::closed(-40.0, 60.0);
