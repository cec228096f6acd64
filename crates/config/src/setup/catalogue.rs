//! Every key that the program can read, with its value in each embedded file.
//!
//! Nothing is listed by hand: the readers themselves are run, over the embedded files and over every option that
//! these leave unchosen.

use std::collections::{BTreeSet, VecDeque};
use std::sync::OnceLock;

use super::inputs::{head, parts};
use super::{Disk, Kind, embedded_lubricants, embedded_rigs, embedded_vehicles};
use crate::parts::lubricant as fluid_table;
use crate::rig;
use crate::{Document, KeyInfo, Reader};
use cvtcycle_model::fluid::Lubricant;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Prefix of the keys of the transmission oil, as in `--set lubricant.KEY=VALUE`.
pub const OIL: &str = "lubricant.";
/// Prefix of the keys of the engine oil.
pub const ENGINE_OIL: &str = "engine_oil.";

/// An embedded file and all its keys.
#[derive(Clone, Debug)]
pub struct File {
    /// Name without the ending.
    pub name: &'static str,
    /// Vehicle, lubricant or rig.
    pub kind: Kind,
    /// Keys in the order of reading, without a prefix.
    pub keys: Vec<KeyInfo>,
}

impl File {
    /// Key as `--set` and `explain` have it.
    #[must_use]
    pub fn full_key(&self, key: &str) -> String {
        if self.kind == Kind::Lubricant {
            format!("{OIL}{key}")
        } else {
            key.to_owned()
        }
    }
}

/// All embedded files: vehicles, lubricants, rigs.
#[must_use]
pub fn files() -> Vec<File> {
    let vehicles = embedded_vehicles()
        .iter()
        .map(|(name, text)| (*name, *text, Kind::Vehicle));
    let lubricants = embedded_lubricants()
        .iter()
        .map(|(name, text)| (*name, *text, Kind::Lubricant));
    let rigs = embedded_rigs()
        .iter()
        .map(|(name, text)| (*name, *text, Kind::Rig));
    vehicles
        .chain(lubricants)
        .chain(rigs)
        .map(|(name, text, kind)| File {
            name,
            kind,
            keys: keys(name, text, kind, &[]),
        })
        .collect()
}

/// Every key of any vehicle, lubricant or rig, those of the transmission oil with [`OIL`]; without values. They are the same in every
/// call, and gathered in the first one.
#[must_use]
pub fn known_keys() -> &'static [KeyInfo] {
    static KNOWN: OnceLock<Vec<KeyInfo>> = OnceLock::new();
    KNOWN.get_or_init(gathered)
}

/// Names of [`known_keys`].
#[must_use]
pub fn known_names() -> &'static [String] {
    static NAMES: OnceLock<Vec<String>> = OnceLock::new();
    NAMES.get_or_init(|| known_keys().iter().map(|info| info.key.clone()).collect())
}

fn gathered() -> Vec<KeyInfo> {
    let mut known: Vec<KeyInfo> = Vec::new();
    let mut seen = BTreeSet::new();
    for file in files() {
        let text = file
            .kind
            .embedded()
            .iter()
            .find(|(name, _)| *name == file.name)
            .map_or("", |(_, text)| text);
        let mut queue = VecDeque::from([Vec::new()]);
        let mut tried = BTreeSet::new();
        while let Some(sets) = queue.pop_front() {
            for info in keys(file.name, text, file.kind, &sets) {
                for word in options(&info) {
                    let set = format!("{}={word}", info.key);
                    if tried.insert(set.clone()) {
                        queue.push_back(sets.iter().cloned().chain([set]).collect());
                    }
                }
                let key = file.full_key(&info.key);
                if seen.insert(key.clone()) {
                    let (unit, allowed, doc) = (info.unit, info.allowed, info.doc);
                    known.push(KeyInfo {
                        key,
                        unit,
                        allowed,
                        doc,
                        ..KeyInfo::default()
                    });
                }
            }
        }
    }
    known
}

/// The words from which a key's value is chosen.
fn options(info: &KeyInfo) -> impl Iterator<Item = &str> {
    info.allowed
        .strip_prefix("one of ")
        .into_iter()
        .flat_map(|list| list.split(", "))
}

/// Keys that reading a text asks for, whatever problems there are: an option without its keys has many.
fn keys(name: &str, text: &str, kind: Kind, sets: &[String]) -> Vec<KeyInfo> {
    let Ok(mut document) = Document::parse(name, text) else {
        return Vec::new();
    };
    if sets.iter().any(|set| document.set(set).is_err()) {
        return Vec::new();
    }
    let reader = Reader::new(&document);
    match (kind, oil()) {
        (Kind::Lubricant, _) => drop(fluid_table::load(&reader.root(), name)),
        (Kind::Vehicle, Some(oil)) => {
            let root = reader.root();
            drop(head(&root, name));
            drop(parts(
                &root,
                &Disk::default(),
                [oil.clone(), oil],
                Formulation::default(),
                name.to_owned(),
            ));
        }
        (Kind::Rig, _) => drop(rig::read(&reader.root())),
        (Kind::Vehicle, None) => {}
    }
    reader.known()
}

/// Any checked fluid: which one has no influence on the keys of a vehicle.
fn oil() -> Option<Lubricant> {
    let (name, _) = embedded_lubricants().first()?;
    super::load_lubricant(name, "", &[], "")
        .ok()
        .map(|(oil, _)| oil)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_that_no_file_chooses_are_known() {
        let keys = known_keys();
        for key in [
            "transmission.cvt.pump.kind.dual_cavity.share",
            "transmission.cvt.clamp.torque_following.safety_factor",
            "road_load.form.body.drag_coefficient",
            "transmission.cvt.belt.band_offset_mm",
            "lubricant.kv40_mm2_s",
            "vehicle.transmission_oil",
            "rig.pressure.second_box",
        ] {
            let info = keys.iter().find(|info| info.key == key);
            assert!(info.is_some_and(|info| !info.doc.is_empty()), "{key}");
        }
    }

    #[test]
    fn the_catalogue_holds_what_loading_reports() {
        for file in files().iter().filter(|file| file.kind == Kind::Vehicle) {
            let setup =
                super::super::load(file.name, "", &super::super::Options::default()).unwrap();
            let own = setup
                .keys
                .iter()
                .filter(|k| !k.key.starts_with(OIL) && !k.key.starts_with(ENGINE_OIL));
            assert_eq!(own.cloned().collect::<Vec<_>>(), file.keys, "{}", file.name);
        }
    }
}
