//! Keys of whole files: vehicle, lubricant, rig.

use crate::bench::transmission::RigKeys;
use crate::engine::EngineKeys;
use crate::fluid::FluidKeys;
use crate::keys::{Choice, Kind, Presence, Table, keys};
use crate::road::RoadLoadKeys;
use crate::thermal::ThermalKeys;
use crate::transmission::cvt::CvtKeys;
use crate::transmission::manual::ManualKeys;

/// Names: one text with commas, or a list of texts.
const NAMES: Kind<'static> = Kind::Either(&[Kind::Text, Kind::Texts]);

keys! {
    /// Keys of `[vehicle]`.
    HEAD: HeadKeys = "vehicle" [] {
        title: computed("name of the file", text()), "name for people";
        like: (NAMES, Presence::Optional), "what gives the values that this file leaves out: vehicles by name or path, and classes as class:NAME; of several, the later takes precedence";
        baselines: (NAMES, Presence::Computed("none")), "names of the baseline vehicles";
        transmission_oil: text(), "name of the transmission oil";
        engine_oil: text(), "name of the engine oil";
    }

    /// Keys of a vehicle file.
    VEHICLE_FILE: VehicleKeys = "" [HeadKeys::TABLE, RoadLoadKeys::TABLE, EngineKeys::TABLE, ThermalKeys::TABLE] {
        transmission: options(&[
            Choice::new("cvt", "CVT with a pushing belt", CvtKeys::TABLE),
            Choice::new("manual", "manual gearbox", ManualKeys::TABLE),
        ]), "kind of transmission";
    }
}

/// A vehicle file.
pub const VEHICLE: Table = VehicleKeys::TABLE;
/// A lubricant file.
pub const LUBRICANT: Table = FluidKeys::TABLE;
/// A rig file.
pub const RIG: Table = Table::of(&[RigKeys::TABLE]);
