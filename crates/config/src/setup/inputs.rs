//! The documents of a car, and one reading of them.

use super::contacts;
use super::like::resolve;
use super::twin::{TwinTable, twin};
use super::{
    Disk, Files, Kind, NamedBy, Options, Origin, ParamSet, is_path, is_twin, load_lubricant,
    read_lubricant, stem, text_of,
};
use crate::files::TableCache;
use crate::reader::recorded::Recorded;
use crate::{Argument, Document, KeyInfo, Override, Place, Problem, Problems, Reader, Target};
use cvtcycle_model::drive::{ChangedParts, Vehicle};
use cvtcycle_model::engine::FuelModel;
use cvtcycle_model::files::{HEAD, TwinKeys};
use cvtcycle_model::keys::Values;
use cvtcycle_model::lubricant::{Friction, Lubricant};
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::Formulation;
use rustc_hash::FxHashMap;
use std::path::Path;
use std::sync::{Arc, Mutex, OnceLock};

/// A document and what is wrong with it so far.
#[derive(Clone, Debug, Default)]
pub(super) struct CarFile {
    /// `None` if it could not be read.
    pub document: Option<Document>,
    pub problems: Problems,
}

/// The files of a car with the overrides put in, before they are checked.
#[derive(Debug)]
pub(super) struct Inputs {
    pub frame: Arc<Frame>,
    /// In the order of [`Target::CAR`].
    pub files: [CarFile; 3],
    /// A car of the program's own, with nothing changed.
    is_shipped: bool,
}

/// Context for reading a car's documents.
#[derive(Debug)]
pub(super) struct Frame {
    /// Name of the car.
    pub name: String,
    /// Names or paths of transmission oil and engine oil; empty where neither vehicle nor user has one.
    fluids: [String; 2],
    files: TableCache,
    /// Where the tables are that the fluids' files name: next to them.
    fluid_files: [TableCache; 2],
    formulation: Formulation,
    /// Friction of the vehicle's own transmission oil where another oil is in its place.
    own_friction: Option<Friction>,
}

impl Inputs {
    /// Reads the files and puts the overrides in.
    ///
    /// # Errors
    /// Problems that leave nothing to read: no such vehicle, no TOML, overrides of a box that the vehicle does not have.
    pub fn gather(word: &str, options: &Options) -> Result<Self, Problems> {
        let (file, text, disk) = text_of(word, Kind::Vehicle, options.named_by)?;
        let is_twin = is_twin(word);
        let inputs = Inputs::parse(&file, &text, Box::new(disk), options, is_twin)?;
        Ok(Inputs {
            is_shipped: !is_twin && !is_path(word) && options.change_nothing(),
            ..inputs
        })
    }

    /// As [`Inputs::gather`], for the text of a vehicle or of its twin; `file` is its name or path, `files` where the maps are that it names.
    ///
    /// # Errors
    /// As there.
    pub fn parse(
        file: &str,
        text: &str,
        files: Box<dyn Files>,
        options: &Options,
        is_twin: bool,
    ) -> Result<Self, Problems> {
        let files = TableCache::new(files);
        let mut document = resolve(Document::parse(file, text)?, &files)?;
        let mut name = stem(file.strip_prefix("embedded:").unwrap_or(file));
        // Set all the same, keys of another box would call for a whole box.
        wrong_keys(&document, &options.set, &name).finish()?;
        let of_vehicle = |target| [Target::Vehicle, Target::Rig].contains(&target);
        let problems = apply(&mut document, &options.set, of_vehicle);
        if is_twin {
            document = twin(document, file, &files)?;
            name += "_twin";
        }
        let own = head(&Reader::new(&document).root(), "");
        let written_in = |key: &str| written_in(&document, key, file);
        let files_of_fluids = FLUIDS.map(written_in);
        let own_friction = options
            .lubricant
            .as_ref()
            .and_then(|_| friction(&files_of_fluids[0], &own.fluid));
        let [of_oil, of_engine_oil] = &files_of_fluids;
        let words = [
            fluid_word(of_oil, own.fluid, &options.lubricant, Argument::Lubricant),
            fluid_word(
                of_engine_oil,
                own.engine_oil,
                &options.engine_oil,
                Argument::EngineOil,
            ),
        ];
        let [
            (oil, oil_word, oil_disk),
            (engine_oil, engine_oil_word, engine_oil_disk),
        ] = [
            fluid_file(&words[0], options, Target::Lubricant),
            fluid_file(&words[1], options, Target::EngineOil),
        ];
        let vehicle = CarFile {
            document: Some(document),
            problems,
        };
        let frame = Frame {
            name,
            fluids: [oil_word, engine_oil_word],
            files,
            fluid_files: [oil_disk, engine_oil_disk].map(|disk| TableCache::new(Box::new(disk))),
            formulation: options.formulation,
            own_friction,
        };
        Ok(Inputs {
            frame: Arc::new(frame),
            files: [vehicle, oil, engine_oil],
            is_shipped: false,
        })
    }

    /// The files with more overrides.
    pub fn with(&self, set: &[Override]) -> Self {
        let mut files = self.files.clone();
        for (file, target) in files.iter_mut().zip(Target::CAR) {
            if let Some(document) = &mut file.document {
                file.problems
                    .extend(apply(document, set, |of| of == target));
            }
        }
        Inputs {
            frame: Arc::clone(&self.frame),
            files,
            is_shipped: false,
        }
    }

    /// Reads and checks the car.
    ///
    /// # Errors
    /// All problems of its files and of the overrides.
    pub fn validate(self) -> Result<(Validated, Assembled), Problems> {
        let documents = self.files.each_ref().map(|input| input.document.as_ref());
        let readers = self.frame.readers(&documents);
        let assembled = self.frame.assemble(&readers);
        let mut problems = Problems::new();
        let mut keys = Vec::new();
        let mut recorded = <[Recorded; 3]>::default();
        for (k, (reader, input)) in readers.into_iter().zip(&self.files).enumerate() {
            let answer = match reader {
                Some(reader) => reader.finish_with_values(),
                // A fluid that the vehicle does not name is missing there already.
                None if k > 0 && !problems.is_empty() && self.frame.fluids[k - 1].is_empty() => {
                    continue;
                }
                None => Ok(Default::default()),
            };
            match answer {
                Ok((read, values)) => {
                    let prefix = Target::CAR[k].prefix();
                    keys.extend(read.into_iter().map(|info| info.prefixed(prefix)));
                    recorded[k] = values;
                }
                Err(found) => problems.extend(found),
            }
            problems.extend(input.problems.iter().cloned());
        }
        let assembled = assembled?;
        problems.finish()?;
        let read = Validated {
            index: OnceLock::new(),
            inputs: self,
            keys,
            recorded,
            chosen: Mutex::default(),
        };
        Ok((read, assembled))
    }
}

/// A reading of a car's documents that found nothing wrong.
#[derive(Debug)]
pub(super) struct Validated {
    pub inputs: Inputs,
    /// Every key that was read, vehicle first, with the prefixes of the fluids.
    pub keys: Vec<KeyInfo>,
    /// Places in `keys`, once one is looked for: a run looks for none.
    index: OnceLock<FxHashMap<String, usize>>,
    /// The values of each file, in the order of [`Target::CAR`].
    pub recorded: [Recorded; 3],
    /// The last set that chooses other options, and the keys that choose them.
    pub chosen: Mutex<Option<(Vec<String>, ParamSet)>>,
}

impl Validated {
    /// Knowledge about a key.
    pub fn info(&self, key: &str) -> Option<&KeyInfo> {
        let index = self.index.get_or_init(|| {
            let keys = self.keys.iter().enumerate();
            keys.map(|(k, info)| (info.key.clone(), k)).collect()
        });
        self.keys.get(*index.get(key)?)
    }
}

/// The car that a reading makes.
#[derive(Clone, Debug)]
pub(super) struct Assembled {
    pub head: Arc<Head>,
    pub vehicle: Vehicle,
}

impl Inputs {
    /// The files that are read besides the vehicle's own.
    pub fn origin(&self) -> Origin {
        let sources = self.files[0].document.iter().flat_map(|of| &of.sources);
        let parents = sources.filter(|source| source.parent.is_some());
        Origin {
            parents: parents
                .map(|source| (source.input.to_string(), source.text.clone()))
                .collect(),
            fluids: self.frame.fluids.clone(),
            is_shipped: self.is_shipped,
        }
    }
}

impl Frame {
    /// Readers of the documents of a car, in the order of [`Target::CAR`].
    pub fn readers<'d>(&'d self, documents: &[Option<&'d Document>; 3]) -> [Option<Reader<'d>>; 3] {
        let [oil, engine_oil] = &self.fluid_files;
        let files = [&self.files, oil, engine_oil];
        std::array::from_fn(|k| {
            documents[k].map(|document| Reader::new(document).with_files(files[k]))
        })
    }

    /// Puts a car together from readings of vehicle, transmission oil and engine oil, which take what is wrong with it.
    ///
    /// # Errors
    /// Not for what is wrong with the car.
    pub fn assemble(&self, readers: &[Option<Reader<'_>>; 3]) -> Result<Assembled, Problems> {
        let [vehicle, oil, engine_oil] = readers;
        let Some(vehicle) = vehicle else {
            return Err(Problems::new());
        };
        let root = vehicle.root();
        let head = head(&root, &self.name);
        let fluid = |reader: &Option<Reader>, k: usize| match reader {
            Some(reader) => Ok(self.lubricant(&reader.root(), k)),
            // Some fluid, so that the reading goes on.
            None => load_lubricant("cvtf_ezl799_class").map(|found| Arc::new(found.0)),
        };
        let fluids = [fluid(oil, 0)?, fluid(engine_oil, 1)?];
        Ok(Assembled {
            head: Arc::new(head),
            vehicle: self.vehicle(&root, fluids, None),
        })
    }

    /// Transmission oil (0) or engine oil (1) from the values of its file.
    pub fn lubricant<V: Values>(&self, root: &V, k: usize) -> Arc<Lubricant> {
        Arc::new(Lubricant::from_values(root, &stem(&self.fluids[k])))
    }

    /// The vehicle from the values of its file, and from another one of which some parts have other values.
    pub fn vehicle<V: Values>(
        &self,
        root: &V,
        oils: [Arc<Lubricant>; 2],
        base: Option<(&Vehicle, &ChangedParts)>,
    ) -> Vehicle {
        Vehicle::from_values(root, oils, self.formulation, &self.name, base)
    }

    /// Notes for readers of the results of a car.
    pub fn notes(&self, vehicle: &Vehicle, keys: &[KeyInfo]) -> Vec<String> {
        let transmission = vehicle.transmission();
        let oil = vehicle.oils().0;
        let own = self.own_friction.filter(|_| transmission.is_cvt());
        let mut notes = match own == Some(oil.friction) {
            true => vec![SAME_FRICTION.to_owned()],
            false => Vec::new(),
        };
        let prefix = Target::Lubricant.prefix();
        let known = own.map(|_| contacts::contacts(oil, keys, prefix));
        notes.extend(known.and_then(|known| contacts::not_measured(oil, &known)));
        notes.extend(changed_losses(transmission));
        notes.extend(scattered_maps(transmission));
        notes.extend(filled_maps(transmission));
        notes.extend(fuel_map(vehicle));
        notes
    }
}

/// A sentence on each loss that the files change by a factor.
fn changed_losses(transmission: &Transmission) -> impl Iterator<Item = String> {
    let factors = transmission.loss_factors();
    let changed = Component::ALL
        .into_iter()
        .filter(move |component| (factors[*component] - 1.0).abs() > 0.0);
    changed.map(move |component| {
        let (name, factor) = (component.name(), factors[component]);
        format!(
            "loss_factor.{name} = {factor}: to see what a loss costs, no car that could be built"
        )
    })
}

/// A sentence on each map that is beyond its points in part (MP-7).
fn filled_maps(transmission: &Transmission) -> impl Iterator<Item = String> {
    let of = |(_, map): (Component, &LossMap)| {
        let share = 100.0 * map.grid().known_share();
        (share < 100.0).then(|| {
            format!(
                "the points of the map of the whole box fill no grid: {share:.0} % of its grid lies within their triangles, the rest is beyond them, and time there is outside_validity"
            )
        })
    };
    transmission.maps().filter_map(of)
}

/// How the map of fuel was read (BM-4), where it is no grid in the program's own form.
fn fuel_map(vehicle: &Vehicle) -> Vec<String> {
    let FuelModel::Map(map) = &vehicle.engine().fuel else {
        return Vec::new();
    };
    let Some(origin) = map.origin.as_deref() else {
        return Vec::new();
    };
    let file = &origin.file;
    let read_as = origin.read_as.iter();
    let mut notes: Vec<String> = read_as
        .map(|words| format!("{file} is read as {words}"))
        .collect();
    if let Some((count, line)) = origin.left_out {
        notes.push(format!(
            "{count} points of {file} are left out, the first in line {line}: below 100 rpm, without a value, or a consumption for no work"
        ));
    }
    let share = 100.0 * map.known_share();
    if map.known.is_some() {
        notes.push(format!(
            "the {} points of {file} fill no grid: between them triangles, which are {share:.0} % of their speeds and loads; beyond them the specific consumption of the last load, and time there is outside_validity",
            origin.points.len()
        ));
    }
    notes
}

/// A sentence on each map from scattered points (MP-5): what its interpolation misses.
fn scattered_maps(transmission: &Transmission) -> impl Iterator<Item = String> {
    let of = |(_, map): (Component, &LossMap)| {
        let scatter = map.scatter()?;
        Some(format!(
            "the map of the whole box has {} scattered points: each differs from the plane through the others by {:.2} N m (root of the mean square), {:.2} N m at most",
            scatter.points, scatter.rms_nm, scatter.largest_nm
        ))
    };
    transmission.maps().filter_map(of)
}

/// Limit of a comparison of fluids.
const SAME_FRICTION: &str = "this oil has the friction of the vehicle's own one: the comparison moves viscosity, density and heat capacity only";

/// Name or path of a fluid as a vehicle's file has it: a path is relative to that file.
fn fluid_of_file(file: &str, fluid: String) -> String {
    let folder = Path::new(file).parent().filter(|_| is_path(&fluid));
    folder.map_or_else(
        || fluid.clone(),
        |folder| folder.join(&fluid).to_string_lossy().into_owned(),
    )
}

/// Keys of `[vehicle]` that name its fluids.
const FLUIDS: [&str; 2] = [HEAD.transmission_oil.name, HEAD.engine_oil.name];

/// Name of the file in which a key of `[vehicle]` is written: that of the car, or one that it inherits from.
fn written_in(document: &Document, key: &str, file: &str) -> String {
    let node = document.root.node(&["vehicle", key]);
    let parent = node.filter(|node| document.parent(&node.span).is_some());
    parent.map_or_else(
        || file.to_owned(),
        |node| document.sources[node.span.source].input.to_string(),
    )
}

/// Friction of the fluid that a vehicle's file names; none where it cannot be read.
fn friction(file: &str, fluid: &str) -> Option<Friction> {
    let word = fluid_of_file(file, fluid.to_owned());
    let (name, text, disk) = text_of(&word, Kind::Lubricant, NamedBy::File).ok()?;
    let (own, _) = read_lubricant(&name, &text, &disk).ok()?;
    Some(own.friction)
}

/// Name of a fluid and its origin.
struct FluidWord {
    word: String,
    by: Option<NamedBy>,
    /// Where problems of the word are.
    place: Place,
}

/// The fluid that was asked for, or that of the vehicle's file.
fn fluid_word(file: &str, own: String, asked: &Option<String>, argument: Argument) -> FluidWord {
    match asked {
        Some(word) => FluidWord {
            word: word.clone(),
            by: None,
            place: argument.into(),
        },
        None => FluidWord {
            word: fluid_of_file(file, own),
            by: Some(NamedBy::File),
            place: Place::file(file),
        },
    }
}

/// The file of a fluid with its overrides, and its name or path.
/// Also where the tables are that it names.
fn fluid_file(of: &FluidWord, options: &Options, target: Target) -> (CarFile, String, Disk) {
    let by = of.by.unwrap_or(options.named_by);
    let read = text_of(&of.word, Kind::Lubricant, by)
        .and_then(|(file, text, disk)| Ok((Document::parse(&file, &text)?, disk)));
    let mut folder = Disk::default();
    let file = match read.map(|(document, disk)| {
        folder = disk;
        document
    }) {
        Ok(mut document) => CarFile {
            problems: apply(&mut document, &options.set, |of| of == target),
            document: Some(document),
        },
        Err(problems) => CarFile {
            document: None,
            problems: problems.map(|problem| {
                match problem.place.is_argument(Argument::Lubricant) {
                    true => problem.at(of.place.clone()),
                    false => problem,
                }
            }),
        },
    };
    (file, of.word.clone(), folder)
}

/// Puts in the overrides of some files; their problems.
fn apply(document: &mut Document, set: &[Override], is_of: impl Fn(Target) -> bool) -> Problems {
    set.iter()
        .filter(|by| is_of(by.target()))
        .filter_map(|by| document.set(by).err())
        .collect()
}

/// Values of the `[vehicle]` table.
#[derive(Clone, Debug)]
pub(super) struct Head {
    pub title: String,
    pub short: String,
    pub baselines: Vec<String>,
    fluid: String,
    engine_oil: String,
}

pub(super) fn head<V: Values>(root: &V, name: &str) -> Head {
    let head = root.table("vehicle");
    // Resolved before; what is made of the rest is the twin's.
    let _ = head.texts(&HEAD.like);
    let twin = root.table(TwinKeys::TABLE.name);
    if twin.exists() {
        let _ = TwinTable::from_values(&twin);
    }
    Head {
        title: head.text_or(&HEAD.title, name),
        short: head.text_or(&HEAD.short, &name.replace('_', " ")),
        baselines: head.texts(&HEAD.baselines),
        fluid: head.text(&HEAD.transmission_oil),
        engine_oil: head.text(&HEAD.engine_oil),
    }
}

/// The kinds of box with their words.
const BOXES: [(&str, &str); 2] = [("cvt", "CVT"), ("manual", "manual box")];

/// Overrides of keys of a kind of box that the vehicle does not have.
pub(super) fn wrong_keys(document: &Document, set: &[Override], name: &str) -> Problems {
    let reader = Reader::new(document);
    let own = reader.root().table("transmission").names();
    let Some((there, has)) = BOXES.iter().find(|(kind, _)| own.contains(kind)) else {
        return Problems::new();
    };
    let of = |by: &Override| {
        let kind = by.key().strip_prefix("transmission.")?.split('.').next()?;
        let (_, lacks) = BOXES
            .iter()
            .find(|(known, _)| *known == kind && !own.contains(known))?;
        let problem = Problem::wrong_transmission(format!("{name} has a {has} and no {lacks}"))
            .at(by.input())
            .key(by.key())
            .value(by.to_string())
            .allowed(format!("keys of [transmission.{there}]"))
            .hint(format!(
                "set a key of [transmission.{there}], or take another vehicle"
            ));
        Some(problem)
    };
    set.iter().filter_map(of).collect()
}
