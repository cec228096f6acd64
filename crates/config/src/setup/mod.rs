//! Checked files to a car: vehicle, fluids, overrides, ambient.
//!
//! A name without a path and without `.toml` is an embedded file; anything else is a path.

pub mod assumptions;
pub mod carried;
pub mod catalogue;
pub mod contacts;
mod doubts;
pub mod new_car;
mod inputs;
mod like;
mod params;
pub mod rig;
mod start;
mod twin;

pub use self::params::{Param, ParamSet, ParamValue};
pub use self::start::{start_nodes, start_of_log, start_of_nodes};
pub use crate::files::embedded::{
    is_path, lubricants as embedded_lubricants, vehicles as embedded_vehicles,
};
pub use crate::files::{Disk, Files};

use crate::files::bounded::{self, ReadError};
use crate::files::embedded;
use crate::{
    Argument, Bound, Document, KeyInfo, Override, Problem, Problems, Reader, Target, decode,
    did_you_mean,
};
use cvtcycle_model::drive::Vehicle;

use cvtcycle_model::lubricant::Lubricant;

use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Fluids, overrides and belt model besides the vehicle file.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Transmission oil, name or path; the vehicle's own if none.
    pub lubricant: Option<String>,
    /// Engine oil, name or path; the vehicle's own if none.
    pub engine_oil: Option<String>,
    /// Overrides of the files' values, in order.
    pub set: Vec<Override>,
    /// Reading of the belt model.
    pub formulation: Formulation,
    /// Origin of the names of vehicle and fluids.
    pub named_by: NamedBy,
}

/// Origin of the name of an input file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NamedBy {
    /// The caller.
    #[default]
    Caller,
    /// Another file, whose author may be unknown: pipes and devices are refused.
    File,
}

/// A vehicle with its fluids, checked, and where each of its values comes from. It is used like the [`Vehicle`] in it.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Name of the vehicle file without `.toml`.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Name in tables and figures.
    pub short: String,
    /// Names of its baselines.
    pub baselines: Vec<String>,
    /// The car before the ambient temperature is known.
    pub vehicle: Vehicle,
    /// Every key that was read, vehicle first, then `lubricant.` and `engine_oil.`.
    pub keys: Vec<KeyInfo>,
    /// Notes for readers of the results, a sentence each.
    pub notes: Vec<String>,
    /// The files that its own inherits from, and the words by which its fluids were found.
    pub origin: Origin,
}

/// The files of a car besides its own.
#[derive(Clone, Debug, Default)]
pub struct Origin {
    /// Name and text of each file that the vehicle's own inherits from.
    pub parents: Vec<(String, String)>,
    /// Name or path of transmission oil and engine oil.
    pub fluids: [String; 2],
    /// True if the program carries all of its files, and nothing else was asked for.
    pub is_shipped: bool,
}

impl Setup {
    /// The car of a set of values; its keys and its origin, which take as long as all the rest, are left out ([`ParamSet::setup`] has them).
    #[must_use]
    pub fn from_params(params: &ParamSet) -> Self {
        let frame = &params.read.inputs.frame;
        Setup::noted(params, frame.notes(params.vehicle(), &params.read.keys))
    }

    /// As [`Setup::from_params`], with these notes.
    fn noted(params: &ParamSet, notes: Vec<String>) -> Self {
        let head = &params.assembled.head;
        let frame = &params.read.inputs.frame;
        Setup {
            name: frame.name.clone(),
            title: head.title.clone(),
            short: head.short.clone(),
            baselines: head.baselines.clone(),
            vehicle: params.vehicle().clone(),
            keys: Vec::new(),
            notes,
            origin: Origin::default(),
        }
    }

    /// Likely slips in the values, a sentence each.
    #[must_use]
    pub fn doubts(&self) -> Vec<String> {
        doubts::doubts(self)
    }
}

impl std::ops::Deref for Setup {
    type Target = Vehicle;

    fn deref(&self) -> &Vehicle {
        &self.vehicle
    }
}

/// Kinds of input file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A vehicle.
    Vehicle,
    /// Values of a class of cars, for `like` of a vehicle.
    Class,
    /// A lubricant.
    Lubricant,
    /// Settings of a test rig.
    Rig,
    /// The plan of a study.
    Plan,
    /// Changes of a car's design.
    Levers,
    /// The plan of a calibration.
    Calibration,
    /// A test of a regulation.
    Test,
}

impl Kind {
    /// The files of this kind that the program carries: name and text.
    #[must_use]
    pub const fn embedded(self) -> &'static [embedded::File] {
        match self {
            Kind::Vehicle => embedded::vehicles(),
            Kind::Class => embedded::classes(),
            Kind::Lubricant => embedded::lubricants(),
            Kind::Rig => embedded::rigs(),
            Kind::Plan => embedded::plans(),
            Kind::Levers => embedded::levers(),
            Kind::Calibration => embedded::calibrations(),
            Kind::Test => embedded::tests(),
        }
    }

    /// Names of the files of this kind that the program carries.
    #[must_use]
    pub fn names(self) -> Vec<&'static str> {
        self.embedded().iter().map(|(name, _)| *name).collect()
    }

    /// The argument of a call that names such a file.
    const fn argument(self) -> Argument {
        match self {
            Kind::Vehicle => Argument::Vehicle,
            Kind::Lubricant => Argument::Lubricant,
            Kind::Plan => Argument::Plan,
            Kind::Calibration => Argument::Calibration,
            Kind::Class | Kind::Rig | Kind::Levers | Kind::Test => Argument::File,
        }
    }

    pub(crate) const fn word(self) -> &'static str {
        match self {
            Kind::Vehicle => "vehicle",
            Kind::Class => "class",
            Kind::Lubricant => "lubricant",
            Kind::Rig => "rig",
            Kind::Plan => "plan",
            Kind::Levers => "lever file",
            Kind::Calibration => "calibration",
            Kind::Test => "test",
        }
    }
}

/// Text of an input, the name under which problems cite it, and its folder.
///
/// # Errors
/// Unknown name (with the near ones), unreadable path, binary or empty file.
pub fn text_of(word: &str, kind: Kind, by: NamedBy) -> Result<(String, String, Disk), Problems> {
    let word = match kind {
        // That of its car.
        Kind::Vehicle => word.strip_prefix(twin::MARK).unwrap_or(word),
        _ => word,
    };
    if !is_path(word) {
        let text = embedded::text(kind.embedded(), word).ok_or_else(|| unknown_name(word, kind))?;
        let file = format!("embedded:{word}.toml");
        return Ok((file, text.to_owned(), Disk::default()));
    }
    let path = std::path::Path::new(word);
    let read = match by {
        NamedBy::Caller => bounded::read(path, bounded::TOML),
        NamedBy::File => bounded::read_file(path, bounded::TOML),
    };
    let bytes = read.map_err(|error| unreadable(word, kind, &error))?;
    let folder = path.parent().map(ToOwned::to_owned).unwrap_or_default();
    Ok((word.to_owned(), decode(word, &bytes)?, Disk { folder }))
}

/// As a baseline the same car with a manual box.
pub const TWIN: &str = "twin";

impl Options {
    /// True if they change nothing of a car.
    #[must_use]
    pub fn change_nothing(&self) -> bool {
        let own = Options::default();
        let files = self.lubricant.is_none() && self.engine_oil.is_none();
        files && self.set.is_empty() && self.formulation == own.formulation
    }

    /// Options of the car's twin: it has another transmission oil, and all else of the car.
    #[must_use]
    pub fn of_twin(&self, named_by: NamedBy) -> Options {
        let own = self.set.iter();
        let own = own.filter(|by| by.target() != Target::Lubricant);
        Options {
            lubricant: None,
            set: own.cloned().collect(),
            named_by,
            ..self.clone()
        }
    }
}

/// True if the word is that of a twin.
#[must_use]
pub fn is_twin(word: &str) -> bool {
    word.starts_with(twin::MARK)
}

/// Name of a car by its word, as results have it.
#[must_use]
pub fn name_of(word: &str) -> String {
    match word.strip_prefix(twin::MARK) {
        Some(of) => stem(of) + "_twin",
        None => stem(word),
    }
}

/// The word for a vehicle that the file of the vehicle `of` names as its baseline: a path is relative to that file, `twin` is the same car
/// with a manual box.
#[must_use]
pub fn baseline_of(of: &str, named: &str) -> String {
    if named == TWIN {
        return format!("{}{of}", twin::MARK);
    }
    let folder = std::path::Path::new(of).parent();
    match folder.filter(|_| is_path(of) && is_path(named)) {
        Some(folder) => folder.join(named).to_string_lossy().into_owned(),
        None => named.to_owned(),
    }
}

/// True if two words name one vehicle: the same name, or paths of one file.
///
/// ```
/// use cvtcycle_config::setup::is_same_vehicle;
/// assert!(is_same_vehicle("rover_216_cvt", "rover_216_cvt"));
/// assert!(is_same_vehicle("./Cargo.toml", "Cargo.toml"));
/// assert!(!is_same_vehicle("rover_216_cvt", "rover_216_cvt.toml"));
/// ```
#[must_use]
pub fn is_same_vehicle(a: &str, b: &str) -> bool {
    let place = |word: &str| std::fs::canonicalize(word).ok().filter(|_| is_path(word));
    a == b || place(a).is_some_and(|a| Some(a) == place(b))
}

fn unknown_name(word: &str, kind: Kind) -> Problem {
    let names = kind.names();
    let question = did_you_mean(word, names.iter().copied());
    let names = names.join(", ");
    let problem = Problem::unknown_name(format!("there is no {} named `{word}`", kind.word()))
        .at(kind.argument())
        .value(word);
    if kind == Kind::Class {
        return problem.allowed(names).hint(question.unwrap_or_default());
    }
    let file = format!("{word}.toml");
    let question = match std::path::Path::new(&file).is_file() {
        true => Some(format!("did you mean `{file}`?")),
        false => question,
    };
    let question = question.map_or_else(String::new, |question| question + " ");
    problem
        .allowed(format!("{names}, or the path of a TOML file"))
        .hint(format!("{question}a path needs a / or an ending"))
}

fn unreadable(word: &str, kind: Kind, why: &ReadError) -> Problem {
    Problem::unreadable(format!("cannot read `{word}`: {why}"))
        .at(kind.argument())
        .value(word)
        .allowed(why.allowed("a readable file"))
        .hint(why.hint("check the path and its permissions"))
}

fn stem(word: &str) -> String {
    std::path::Path::new(word)
        .file_stem()
        .map_or_else(|| word.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Reads and checks a lubricant by its name or path.
///
/// # Errors
/// All problems of the file.
///
/// ```
/// use cvtcycle_config::setup::load_lubricant;
/// let (oil, keys) = load_lubricant("dexron_iii")?;
/// assert_eq!(keys[0].key, "title");
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn load_lubricant(word: &str) -> Result<(Lubricant, Vec<KeyInfo>), Problems> {
    let (file, text, disk) = text_of(word, Kind::Lubricant, NamedBy::Caller)?;
    read_lubricant(&file, &text, &disk)
}

/// As [`load_lubricant`], for a fluid's text that need not be on disk; `file` is its name or path, which problems cite. The tables that the text
/// names come from `files`.
///
/// # Errors
/// As there.
pub fn read_lubricant(
    file: &str,
    text: &str,
    files: &dyn Files,
) -> Result<(Lubricant, Vec<KeyInfo>), Problems> {
    let document = Document::parse(file, text)?;
    let reader = Reader::new(&document).with_files(files);
    let name = stem(file.strip_prefix("embedded:").unwrap_or(file));
    let lubricant = Lubricant::from_values(&reader.root(), &name);
    Ok((lubricant, reader.finish()?))
}

/// Reads and checks a vehicle by its name or path, with its fluids and with other values in place of the files'.
///
/// # Errors
/// All problems of the vehicle file, of its fluids and of the overrides.
///
/// ```
/// use cvtcycle_config::Override;
/// use cvtcycle_config::setup::{Options, load};
/// let options = Options {
///     lubricant: Some("dexron_iii".into()),
///     set: vec![Override::number("road_load.mass_kg", 1250.0)],
///     ..Options::default()
/// };
/// let car = load("rover_216_cvt", &options)?;
/// assert_eq!(car.road_load.base.mass_kg, 1250.0);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn load(word: &str, options: &Options) -> Result<Setup, Problems> {
    Ok(ParamSet::load(word, options)?.into_setup())
}

/// As [`load`], for a vehicle's text that need not be on disk. `file` is its name or path, which problems cite and from which paths of
/// fluids are taken; the maps that the text names come from `files`.
///
/// # Errors
/// As there.
///
/// ```
/// use cvtcycle_config::setup::{Disk, Kind, Options, read};
/// let (_, shipped) = Kind::Vehicle.embedded()[0];
/// let text = shipped.replace("title =", "titel =");
/// let problems = read("own.toml", &text, Box::new(Disk::default()), &Options::default()).unwrap_err();
/// assert_eq!(problems[0].hint, "did you mean `title`?");
/// ```
pub fn read(
    file: &str,
    text: &str,
    files: Box<dyn Files>,
    options: &Options,
) -> Result<Setup, Problems> {
    Ok(ParamSet::read(file, text, files, options)?.into_setup())
}

/// As [`read`], for the twin of the vehicle: the same car with a manual box.
///
/// # Errors
/// As there.
pub fn read_twin(
    file: &str,
    text: &str,
    files: Box<dyn Files>,
    options: &Options,
) -> Result<Setup, Problems> {
    Ok(ParamSet::read_twin(file, text, files, options)?.into_setup())
}

/// Range of the temperatures at the start, of all parts or of one, degC.
pub const START: Bound = Bound::closed(-40.0, 130.0);

/// Range of the longest step, s.
pub const STEP: Bound = Bound::closed(0.01, 10.0);

/// Range of ambient temperatures, degC (test cell of the thesis widened).
pub const AMBIENT: Bound = Bound::closed(-40.0, 60.0);
