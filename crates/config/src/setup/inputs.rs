//! The documents of a car, and one reading of them.

use super::like::resolve;
use super::twin::{TwinTable, twin};
use super::{
    Files, Kind, NamedBy, Options, Origin, Setup, is_path, is_twin, load_lubricant, read_lubricant,
    stem, text_of,
};
use crate::files::TableCache;
use crate::{Argument, Document, KeyInfo, Override, Place, Problem, Problems, Reader, Target};
use cvtcycle_model::drive::{Car, Vehicle};
use cvtcycle_model::engine::Engine;
use cvtcycle_model::files::{HEAD, TwinKeys, VEHICLE_FILE};
use cvtcycle_model::keys::Values;
use cvtcycle_model::lubricant::{Friction, Lubricant};
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::road::RoadLoadInput;
use cvtcycle_model::thermal::Network;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_model::transmission::manual::Manual;
use std::path::Path;
use std::sync::Arc;

/// A document and what is wrong with it so far.
#[derive(Clone, Debug, Default)]
pub(super) struct CarFile {
    /// None if it could not be read.
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

/// What a reading of a car's documents needs besides them.
#[derive(Debug)]
pub(super) struct Frame {
    /// Name of the car.
    pub name: String,
    /// Names or paths of transmission oil and engine oil; empty where neither vehicle nor user has one.
    fluids: [String; 2],
    pub files: TableCache,
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
        let inputs = Inputs::of(&file, &text, Box::new(disk), options, is_twin)?;
        Ok(Inputs {
            is_shipped: !is_twin && !is_path(word) && options.change_nothing(),
            ..inputs
        })
    }

    /// As [`Inputs::gather`], for the text of a vehicle; `file` is its name or path, `files` where the maps are that it names.
    ///
    /// # Errors
    /// As there.
    pub fn of_text(
        file: &str,
        text: &str,
        files: Box<dyn Files>,
        options: &Options,
    ) -> Result<Self, Problems> {
        Inputs::of(file, text, files, options, false)
    }

    /// Of the car of a text, or of its twin.
    pub fn of(
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
        let own = head(&Reader::check_only(&document).root(), "");
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
        let [(oil, oil_word), (engine_oil, engine_oil_word)] = [
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
            formulation: options.formulation,
            own_friction,
        };
        Ok(Inputs {
            frame: Arc::new(frame),
            files: [vehicle, oil, engine_oil],
            is_shipped: false,
        })
    }

    /// The same car with other documents.
    pub fn with_files(&self, files: [CarFile; 3]) -> Self {
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
    pub fn read(&self) -> Result<Setup, Problems> {
        let documents = self.files.each_ref().map(|input| input.document.as_ref());
        let reader = |document| Reader::new(document).with_files(&self.frame.files);
        let readers = documents.map(|document| document.map(reader));
        let assembled = self.frame.assemble(&readers, None);
        let mut problems = Problems::new();
        let mut keys = Vec::new();
        for (k, (reader, input)) in readers.into_iter().zip(&self.files).enumerate() {
            let answer = match (k, reader) {
                (0, Some(reader)) => reader.finish(),
                (_, Some(reader)) => fluid_keys(reader, Target::CAR[k]),
                // A fluid that the vehicle does not name is missing there already.
                (_, None) if !problems.is_empty() && self.frame.fluids[k - 1].is_empty() => {
                    continue;
                }
                (_, None) => Ok(Vec::new()),
            };
            match answer {
                Ok(mut read) => keys.append(&mut read),
                Err(found) => problems.extend(found),
            }
            problems.extend(input.problems.iter().cloned());
        }
        let setup = assembled?;
        if problems.is_empty() {
            let origin = self.origin();
            Ok(Setup {
                keys,
                origin,
                ..setup
            })
        } else {
            Err(problems)
        }
    }
}

impl Inputs {
    /// The files that are read besides the vehicle's own.
    fn origin(&self) -> Origin {
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
    /// Puts a car together from readings of vehicle, transmission oil and engine oil, which take what is wrong with it. Of an earlier
    /// reading, which found nothing wrong, those parts are taken whose values are the same.
    ///
    /// # Errors
    /// Not for what is wrong with the car.
    pub fn assemble(
        &self,
        readers: &[Option<Reader<'_>>; 3],
        earlier: Option<&Earlier<'_>>,
    ) -> Result<Setup, Problems> {
        let [vehicle, oil, engine_oil] = readers;
        let Some(vehicle) = vehicle else {
            return Err(Problems::new());
        };
        let root = vehicle.root();
        let head = match kept(earlier, |anew| anew.vehicle) {
            Some(of) => of.head.clone(),
            None => head(&root, &self.name),
        };
        let fluid = |reader: &Option<Reader>, k: usize| match reader {
            Some(reader) => Ok(Lubricant::from_values(
                &reader.root(),
                &stem(&self.fluids[k]),
            )),
            // Some fluid, so that the reading goes on.
            None => load_lubricant("cvtf_ezl799_class").map(|found| found.0),
        };
        let fluids = [
            match kept(earlier, |anew| anew.oil) {
                Some(of) => of.car.oil.clone(),
                None => fluid(oil, 0)?,
            },
            match kept(earlier, |anew| anew.engine_oil) {
                Some(of) => of.car.engine_oil.clone(),
                None => fluid(engine_oil, 1)?,
            },
        ];
        let same = self.own_friction == Some(fluids[0].friction);
        let name = self.name.clone();
        let (road_load, car) = parts(&root, fluids, self.formulation, name, earlier);
        let mut notes = match car.transmission.is_cvt() && same {
            true => vec![SAME_FRICTION.to_owned()],
            false => Vec::new(),
        };
        notes.extend(changed_losses(&car.transmission));
        notes.extend(scattered_maps(&car.transmission));
        Ok(Setup {
            name: self.name.clone(),
            title: head.title,
            short: head.short,
            baselines: head.baselines,
            vehicle: Vehicle::new(car, road_load),
            keys: Vec::new(),
            notes,
            origin: Origin::default(),
        })
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

/// What a comparison of fluids does not tell.
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
    let (name, text, _) = text_of(&word, Kind::Lubricant, NamedBy::File).ok()?;
    let (own, _) = read_lubricant(&name, &text).ok()?;
    Some(own.friction)
}

/// What names a fluid.
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
fn fluid_file(of: &FluidWord, options: &Options, target: Target) -> (CarFile, String) {
    let by = of.by.unwrap_or(options.named_by);
    let read = text_of(&of.word, Kind::Lubricant, by)
        .and_then(|(file, text, _)| Document::parse(&file, &text));
    let file = match read {
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
    (file, of.word.clone())
}

/// Ends the reading of a fluid; its keys with their prefix.
///
/// # Errors
/// All problems.
fn fluid_keys(reader: Reader, target: Target) -> Result<Vec<KeyInfo>, Problems> {
    let mut keys = reader.finish()?;
    for info in &mut keys {
        info.key.insert_str(0, target.prefix());
    }
    Ok(keys)
}

/// Puts in the overrides of some files; their problems.
fn apply(document: &mut Document, set: &[Override], is_of: impl Fn(Target) -> bool) -> Problems {
    set.iter()
        .filter(|by| is_of(by.target()))
        .filter_map(|by| document.set(by).err())
        .collect()
}

/// The car of an earlier reading of the same files, in which nothing was wrong.
#[derive(Clone, Debug)]
pub(super) struct Read {
    head: Head,
    road_load: RoadLoadInput,
    car: Car,
}

impl Read {
    /// The parts of a car.
    pub fn of(setup: &Setup) -> Self {
        Read {
            head: Head {
                title: setup.title.clone(),
                short: setup.short.clone(),
                baselines: setup.baselines.clone(),
                fluid: String::new(),
                engine_oil: String::new(),
            },
            road_load: setup.road_load,
            car: setup.car(cvtcycle_model::road::REFERENCE_K),
        }
    }
}

/// Which parts of a car have other values than in an earlier reading.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Anew {
    road_load: bool,
    engine: bool,
    transmission: bool,
    thermal: bool,
    /// Any other table of the vehicle's file.
    vehicle: bool,
    oil: bool,
    engine_oil: bool,
}

impl Anew {
    /// Adds the value at a path in a file, by its place in [`Target::CAR`].
    pub fn add(&mut self, file: usize, path: &[Box<str>]) {
        let table = path.first().map_or("", |name| &**name);
        let part = match (Target::CAR[file], table) {
            (Target::Lubricant, _) => &mut self.oil,
            (Target::EngineOil, _) => &mut self.engine_oil,
            (_, ROAD_LOAD) => &mut self.road_load,
            (_, ENGINE) => &mut self.engine,
            (_, TRANSMISSION) => &mut self.transmission,
            (_, THERMAL) => &mut self.thermal,
            _ => &mut self.vehicle,
        };
        *part = true;
    }

    /// Whether the thermal network has other values, which the oil fills.
    fn network(&self) -> bool {
        self.vehicle || self.thermal || self.oil
    }

    /// Whether the transmission has other values than the oil in the sump: the same oil is in it, and the engine limits the control.
    fn transmission(&self) -> bool {
        self.vehicle || self.transmission || self.engine || self.oil
    }

    fn driveline(&self) -> bool {
        self.network() || self.transmission()
    }
}

/// An earlier reading, and what has changed since.
#[derive(Clone, Copy, Debug)]
pub(super) struct Earlier<'e> {
    pub read: &'e Read,
    pub anew: Anew,
}

/// The earlier reading where a part is as it was.
fn kept<'e>(earlier: Option<&Earlier<'e>>, is_new: impl Fn(&Anew) -> bool) -> Option<&'e Read> {
    earlier
        .filter(|earlier| !is_new(&earlier.anew))
        .map(|earlier| earlier.read)
}

/// Tables of a vehicle's file that are a part of the car by themselves.
const ROAD_LOAD: &str = "road_load";
const ENGINE: &str = "engine";
const TRANSMISSION: &str = "transmission";
const THERMAL: &str = "thermal";

/// What the `[vehicle]` table says.
#[derive(Clone, Debug)]
pub(super) struct Head {
    title: String,
    short: String,
    baselines: Vec<String>,
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

pub(super) fn parts<V: Values>(
    root: &V,
    [oil, engine_oil]: [Lubricant; 2],
    formulation: Formulation,
    name: String,
    earlier: Option<&Earlier<'_>>,
) -> (RoadLoadInput, Car) {
    let road_load = match kept(earlier, |anew| anew.road_load) {
        Some(of) => of.road_load,
        None => RoadLoadInput::from_values(&root.table(ROAD_LOAD)),
    };
    let engine = match kept(earlier, |anew| anew.engine) {
        Some(of) => of.car.engine.clone(),
        None => Engine::from_values(&root.table(ENGINE)),
    };
    let (network, transmission) = match kept(earlier, Anew::driveline) {
        Some(of) => (of.car.network.clone(), of.car.transmission.clone()),
        None => driveline(root, &engine, &oil, formulation, earlier),
    };
    let belt_heat_share = match &transmission {
        Transmission::Cvt(cvt) => cvt.belt_heat_share,
        Transmission::Manual(_) => 0.0,
    };
    let car = Car {
        name,
        road_load: road_load.base,
        tyre: road_load.tyre,
        transmission,
        engine,
        network,
        oil,
        engine_oil,
        ambient_k: cvtcycle_model::road::REFERENCE_K,
        charge: 1.0,
        belt_heat_share,
    };
    (road_load, car)
}

fn driveline<V: Values>(
    root: &V,
    engine: &Engine,
    oil: &Lubricant,
    formulation: Formulation,
    earlier: Option<&Earlier<'_>>,
) -> (Network, Transmission) {
    let (kind, section) = root.choose(&VEHICLE_FILE.transmission);
    let network = match kept(earlier, Anew::network) {
        Some(of) => of.car.network.clone(),
        None => Network::from_values(&root.table(THERMAL), kind == "cvt", oil),
    };
    // The gears of the transmission turn in the oil of the network's sump.
    let sump_oil_m3 = network.sump_oil_m3;
    let as_full = |of: &&Read| of.car.network.sump_oil_m3.to_bits() == sump_oil_m3.to_bits();
    let transmission = match kept(earlier, Anew::transmission).filter(as_full) {
        Some(of) => of.car.transmission.clone(),
        None if kind == "cvt" => {
            let cvt = Cvt::from_values(&section, engine, (oil, sump_oil_m3), formulation);
            Transmission::Cvt(Box::new(cvt))
        }
        None => Transmission::Manual(Box::new(Manual::from_values(&section, sump_oil_m3))),
    };
    (network, transmission)
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
