//! A car ready to drive.

use crate::engine::Engine;
use crate::fluid::Lubricant;
use crate::road::{RoadLoad, Tyre};
use crate::thermal::Network;
use crate::transmission::Transmission;

/// A car ready to drive: every part checked, for one ambient.
#[derive(Clone, Debug)]
pub struct Car {
    /// Name of the vehicle file.
    pub name: String,
    /// Road load for the ambient.
    pub road_load: RoadLoad,
    /// Tyres.
    pub tyre: Tyre,
    /// Transmission.
    pub transmission: Transmission,
    /// Engine.
    pub engine: Engine,
    /// Thermal network.
    pub network: Network,
    /// Transmission oil.
    pub oil: Lubricant,
    /// Engine oil.
    pub engine_oil: Lubricant,
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Charge of the engine's cylinders over that at 25 degC and sea level (EN-5).
    pub charge: f64,
    /// Share of belt loss that heats the belt node.
    pub belt_heat_share: f64,
}
