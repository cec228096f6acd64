//! A car with every file that it is read from, to be read again where these files are not: in an FMU.

use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::{Files, Kind, NamedBy, Options, Setup, is_twin, read, read_twin, stem, text_of};
use crate::files::bounded::{self, ReadError};
use crate::{KeyInfo, Override, Problem, Problems, decode};

/// Name of the list of the files.
pub const LIST: &str = "car.json";

/// Files that a car was read from.
#[derive(Clone, Debug)]
pub struct CarriedCar {
    list: List,
    /// Name in the folder and bytes of each file.
    files: Vec<(String, Vec<u8>)>,
}

/// Roles of the files.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct List {
    vehicle: String,
    /// True if the car is the twin of the vehicle.
    twin: bool,
    lubricant: String,
    engine_oil: String,
    /// Overrides, in order.
    set: Vec<String>,
    /// Files that these name, by the path that they give.
    named: BTreeMap<String, String>,
}

type Bytes = BTreeMap<String, Vec<u8>>;

/// Hands files on and keeps what it has read.
#[derive(Debug)]
struct Recorded {
    files: Box<dyn Files>,
    read: Arc<Mutex<Bytes>>,
}

impl Files for Recorded {
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        let bytes = self.files.read(path)?;
        let mut read = self.read.lock().unwrap_or_else(PoisonError::into_inner);
        read.insert(path.to_owned(), bytes.clone());
        Ok(bytes)
    }
}

/// Files of a folder by the paths that the car's own files give.
#[derive(Debug)]
struct Carried {
    folder: PathBuf,
    named: BTreeMap<String, String>,
}

impl Files for Carried {
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        let absent = || ReadError::Unreadable(io::ErrorKind::NotFound.into());
        let name = self.named.get(path).ok_or_else(absent)?;
        bounded::read_file(self.folder.join(name), bounded::TABLE)
    }
}

impl CarriedCar {
    /// Reads and checks a car as [`super::load`] does, and keeps the files.
    ///
    /// # Errors
    /// As there.
    pub fn load(word: &str, options: &Options) -> Result<(CarriedCar, Setup), Problems> {
        let (file, text, disk) = text_of(word, Kind::Vehicle, options.named_by)?;
        let kept: Arc<Mutex<Bytes>> = Arc::default();
        let recorded = Box::new(Recorded {
            files: Box::new(disk),
            read: Arc::clone(&kept),
        });
        let twin = is_twin(word);
        let setup = match twin {
            true => read_twin(&file, &text, recorded, options)?,
            false => read(&file, &text, recorded, options)?,
        };
        let mut list = List {
            twin,
            set: options.set.iter().map(ToString::to_string).collect(),
            ..List::default()
        };
        let mut files = Vec::new();
        let mut keep = |folder: &str, name: &str, bytes: Vec<u8>| {
            let name = format!("{folder}/{name}");
            files.push((name.clone(), bytes));
            name
        };
        let own = stem(file.strip_prefix("embedded:").unwrap_or(&file)) + ".toml";
        list.vehicle = keep("vehicle", &own, text.into_bytes());
        let [oil, engine_oil] = &setup.origin.fluids;
        for (folder, word, place) in [
            ("lubricant", oil, &mut list.lubricant),
            ("engine_oil", engine_oil, &mut list.engine_oil),
        ] {
            let (_, mut text, disk) = text_of(word, Kind::Lubricant, options.named_by)?;
            for (number, path) in tables(&setup.keys, folder).enumerate() {
                let Ok(bytes) = disk.read(path) else {
                    continue; // it has been read: gone since
                };
                // Next to the fluid's file, under a name of its own.
                let name = Path::new(path).file_name().unwrap_or_default();
                let name = format!("{number}_{}", name.to_string_lossy());
                for quote in ['"', '\''] {
                    let [old, new] = [path, name.as_str()].map(|of| format!("{quote}{of}{quote}"));
                    text = text.replace(&old, &new);
                }
                keep(folder, &name, bytes);
            }
            *place = keep(folder, &(stem(word) + ".toml"), text.into_bytes());
        }
        let kept = std::mem::take(&mut *kept.lock().unwrap_or_else(PoisonError::into_inner));
        for (number, (path, bytes)) in kept.into_iter().enumerate() {
            // Two paths may end in one name.
            let name = Path::new(&path).file_name().unwrap_or_default();
            let name = format!("{number}_{}", name.to_string_lossy());
            let name = keep("named", &name, bytes);
            list.named.insert(path, name);
        }
        Ok((CarriedCar { list, files }, setup))
    }

    /// Name and bytes of each file of a folder from which [`open`] reads the car.
    #[must_use]
    pub fn into_files(self) -> Vec<(String, Vec<u8>)> {
        let list = serde_json::to_vec_pretty(&self.list).unwrap_or_default();
        let mut files = self.files;
        files.push((LIST.to_owned(), list));
        files
    }
}

/// Paths of the tables of friction that a fluid names, each once.
fn tables<'k>(keys: &'k [KeyInfo], fluid: &'k str) -> impl Iterator<Item = &'k str> {
    let is_table = move |info: &&KeyInfo| {
        let own = info.key.strip_prefix(fluid);
        own.is_some_and(|own| own.starts_with(".friction.") && own.ends_with(".table"))
            && !info.value.is_empty()
    };
    let paths: BTreeSet<&str> = keys
        .iter()
        .filter(is_table)
        .map(|info| info.value.as_str())
        .collect();
    paths.into_iter()
}

/// Reads the car whose files are in a folder.
///
/// # Errors
/// A file that is missing or damaged; all problems of the car.
pub fn open(folder: &Path) -> Result<Setup, Problems> {
    let text = |name: &str, limit| -> Result<(String, String), Problems> {
        let path = folder.join(name);
        let shown = path.to_string_lossy().into_owned();
        let bytes = bounded::read_file(&path, limit).map_err(|why| unreadable(&shown, &why))?;
        let text = decode(&shown, &bytes)?;
        Ok((shown, text))
    };
    let (shown, json) = text(LIST, bounded::RECORD)?;
    let list: List = serde_json::from_str(&json).map_err(|error| {
        Problem::unreadable(format!("cannot read `{shown}`: {error}"))
            .in_file(shown.as_str())
            .hint("write the FMU again with `cvtcycle fmu`")
    })?;
    let (_, vehicle) = text(&list.vehicle, bounded::TOML)?;
    let path = |name: &str| Some(folder.join(name).to_string_lossy().into_owned());
    let options = Options {
        lubricant: path(&list.lubricant),
        engine_oil: path(&list.engine_oil),
        set: Override::parse_all(&list.set)?,
        named_by: NamedBy::File,
        ..Options::default()
    };
    let files = Box::new(Carried {
        folder: folder.to_owned(),
        named: list.named,
    });
    let file = stem(&list.vehicle) + ".toml";
    match list.twin {
        true => read_twin(&file, &vehicle, files, &options),
        false => read(&file, &vehicle, files, &options),
    }
}

fn unreadable(file: &str, why: &ReadError) -> Problem {
    Problem::unreadable(format!("cannot read `{file}`: {why}"))
        .in_file(file)
        .allowed(why.allowed("a readable file"))
        .hint("write the FMU again with `cvtcycle fmu`")
}
