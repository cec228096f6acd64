//! A car ready to drive.

use crate::engine::Engine;
use crate::lubricant::Lubricant;
use crate::math::Real;
use crate::road::{RoadLoad, Tyre};
use crate::thermal::Network;
use crate::transmission::Transmission;

/// A car ready to drive: every part checked, for one ambient.
#[derive(Clone, Debug)]
pub struct Car<R: Real = f64, T = Transmission> {
    /// Name of the vehicle file.
    pub name: String,
    /// Road load for the ambient.
    pub road_load: RoadLoad<R>,
    /// Tyres.
    pub tyre: Tyre<R>,
    /// Transmission.
    pub transmission: T,
    /// Engine.
    pub engine: Engine<R>,
    /// Thermal network.
    pub network: Network<R>,
    /// Transmission oil.
    pub oil: Lubricant<R>,
    /// Engine oil.
    pub engine_oil: Lubricant<R>,
    /// Ambient temperature, K.
    pub ambient_k: R,
    /// Charge of the engine's cylinders over that at 25 degC and sea level (EN-5).
    pub charge: R,
    /// Share of belt loss that heats the belt node.
    pub belt_heat_share: R,
}
