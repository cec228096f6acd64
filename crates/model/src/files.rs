//! Keys of whole files: vehicle, lubricant, rig.

pub use crate::drive::vehicle_keys::{HEAD, HeadKeys, TWIN, TwinKeys, VEHICLE_FILE, VehicleKeys};
use crate::keys::Table;
use crate::lubricant::FluidKeys;
use crate::rig::transmission::RigKeys;

/// A vehicle file.
pub const VEHICLE: Table = VehicleKeys::TABLE;
/// A lubricant file.
pub const LUBRICANT: Table = FluidKeys::TABLE;
/// A rig file.
pub const RIG: Table = Table::from_tables(&[RigKeys::TABLE]);
