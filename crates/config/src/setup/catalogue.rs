//! Every key that the program can read, with its value in each embedded file.
//!
//! The keys are the rows of the model's tables; the values come from reading the files.

use std::sync::{Arc, OnceLock};

use super::inputs::head;
use super::like::resolve;
use super::{Disk, Kind};
use crate::document::target::{rows, rows_of};
use crate::files::embedded;
use crate::setup::rig;
use crate::{Document, KeyInfo, Reader, Target};
use cvtcycle_model::drive::Vehicle;
use cvtcycle_model::keys::{Key, Table};
use cvtcycle_model::lubricant::Lubricant;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Prefix of the keys of the transmission oil.
pub const OIL: &str = Target::Lubricant.prefix();
/// Prefix of the keys of the engine oil.
pub const ENGINE_OIL: &str = Target::EngineOil.prefix();

/// An embedded file and all its keys.
#[derive(Clone, Debug)]
pub struct File {
    /// Name without the ending.
    pub name: &'static str,
    /// Vehicle, class, lubricant or rig.
    pub kind: Kind,
    /// Keys in the order of reading, without a prefix.
    pub keys: Vec<KeyInfo>,
}

impl File {
    /// Key as overrides and `explain` have it.
    #[must_use]
    pub fn full_key(&self, key: &str) -> String {
        if self.kind == Kind::Lubricant {
            format!("{OIL}{key}")
        } else {
            key.to_owned()
        }
    }
}

/// All embedded files: vehicles, classes, lubricants, rigs.
#[must_use]
pub fn files() -> Vec<File> {
    let kinds = [Kind::Vehicle, Kind::Class, Kind::Lubricant, Kind::Rig];
    let file = |kind: Kind, (name, text): embedded::File| File {
        name,
        kind,
        keys: values(name, text, kind),
    };
    let of = |kind: Kind| kind.embedded().iter().map(move |found| file(kind, *found));
    kinds.into_iter().flat_map(of).collect()
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
    NAMES.get_or_init(|| rows().map(|(key, _)| key).collect())
}

fn gathered() -> Vec<KeyInfo> {
    rows().map(info).collect()
}

/// Every key of a table, those of unchosen options too; without values.
#[must_use]
pub fn keys_of(table: &Table) -> Vec<KeyInfo> {
    rows_of("", table).into_iter().map(info).collect()
}

fn info((key, row): (String, &Key<'_>)) -> KeyInfo {
    KeyInfo {
        key,
        unit: row.unit(),
        allowed: row.allowed(),
        is_number: row.is_number(),
        doc: row.doc.to_owned(),
        labels: row.labels,
        ..KeyInfo::default()
    }
}

/// Keys that are read from a text, with their values.
fn values(name: &str, text: &str, kind: Kind) -> Vec<KeyInfo> {
    let document = Document::parse(name, text);
    let document = document.and_then(|document| resolve(document, &Disk::default()));
    let Ok(document) = document else {
        return Vec::new();
    };
    let reader = Reader::new(&document);
    let root = reader.root();
    match kind {
        Kind::Lubricant => drop(Lubricant::from_values(&root, name)),
        Kind::Vehicle | Kind::Class => drop(head(&root, name)),
        Kind::Rig => drop(rig::read(&root)),
        Kind::Plan | Kind::Levers | Kind::Calibration | Kind::Test => {}
    }
    if let (Kind::Vehicle | Kind::Class, Some(oil)) = (kind, oil()) {
        let oil = Arc::new(oil);
        let oils = [Arc::clone(&oil), oil];
        let formulation = Formulation::default();
        drop(Vehicle::from_values(&root, oils, formulation, name, None));
    }
    let mut keys = reader.known();
    if kind == Kind::Class {
        // It need not have all that a car has.
        keys.retain(|info| !["", "default"].contains(&info.status.as_str()));
    }
    keys
}

/// Any checked fluid: which one has no influence on the keys of a vehicle.
fn oil() -> Option<Lubricant> {
    let (name, _) = embedded::lubricants().first()?;
    super::load_lubricant(name).ok().map(|(oil, _)| oil)
}
