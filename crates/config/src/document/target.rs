//! The file that a key belongs to, and the row of a key among the tables of all files.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use cvtcycle_model::files;
use cvtcycle_model::keys::{Key, Table};

/// Dotted key, taken apart.
pub type KeyPath = Arc<[Box<str>]>;

/// The file that an override goes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// The vehicle.
    Vehicle,
    /// The transmission oil: keys that begin with `lubricant.`.
    Lubricant,
    /// The engine oil: keys that begin with `engine_oil.`.
    EngineOil,
    /// The transmission rig: keys that begin with `rig.`.
    Rig,
}

impl Target {
    /// The files of a car.
    pub const CAR: [Target; 3] = [Target::Vehicle, Target::Lubricant, Target::EngineOil];

    /// Prefix of the keys, before their path in the file.
    #[must_use]
    pub const fn prefix(self) -> &'static str {
        match self {
            Target::Lubricant => "lubricant.",
            Target::EngineOil => "engine_oil.",
            Target::Vehicle | Target::Rig => "",
        }
    }

    /// The file of a key, and the key in it.
    #[must_use]
    pub fn from_key(key: &str) -> (Target, &str) {
        let fluid = |target: Target| Some((target, key.strip_prefix(target.prefix())?));
        let fluids = fluid(Target::Lubricant).or_else(|| fluid(Target::EngineOil));
        fluids.unwrap_or(match key.starts_with("rig.") {
            true => (Target::Rig, key),
            false => (Target::Vehicle, key),
        })
    }
}

/// The names of a dotted key.
pub(crate) fn path_of(key: &str) -> KeyPath {
    key.split('.').map(|name| name.trim().into()).collect()
}

/// The row of a key, with the prefix of its file; none of an unknown key.
pub(super) fn row(key: &str) -> Option<&'static Key<'static>> {
    static ROWS: OnceLock<HashMap<String, &'static Key<'static>>> = OnceLock::new();
    let known = ROWS.get_or_init(|| rows().collect());
    let own = key.strip_prefix(Target::EngineOil.prefix());
    let key = own.map_or_else(
        || key.to_owned(),
        |own| format!("{}{own}", Target::Lubricant.prefix()),
    );
    known.get(&key).copied()
}

/// The rows of all tables with their dotted keys.
pub(crate) fn rows() -> impl Iterator<Item = (String, &'static Key<'static>)> {
    let tables = [
        ("", files::VEHICLE),
        (Target::Lubricant.prefix(), files::LUBRICANT),
        ("", files::RIG),
    ];
    let tables = tables.into_iter();
    tables.flat_map(|(prefix, table)| rows_of(prefix, &table))
}

/// The rows of a table with their dotted keys.
pub(crate) fn rows_of(prefix: &str, table: &Table) -> Vec<(String, &'static Key<'static>)> {
    let mut rows = Vec::new();
    table.walk("", &mut |path, key| {
        rows.push((format!("{prefix}{path}"), key))
    });
    rows
}
