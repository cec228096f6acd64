//! Settings and answer of the rig at one operating point.

use crate::flags::Flags;
use crate::transmission::component::{ByComponent, Component};
use crate::transmission::cvt::Parts;
use crate::transmission::cvt::variator::BeltState;

/// Settings of the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchPoint {
    /// Belt ratio; gear number of a manual box.
    pub ratio: f64,
    /// Input speed, rad/s, above 0.
    pub input_rad_s: f64,
    /// Torque taken from the output shaft, Nm; negative where the output drives.
    pub output_nm: f64,
    /// Throttle that the clamp law sees, 0..1.
    pub throttle: f64,
    /// Secondary pressure, Pa; the clamp law's where none is given.
    pub pressure_pa: Option<f64>,
    /// Factor on the clamp law's pressure, 1 for the shipped box.
    pub pressure_factor: f64,
    /// Transmission oil in the sump, K.
    pub sump_k: f64,
    /// Belt and spray, K; in steady state over the sump where none is given (RB-2).
    pub belt_k: Option<f64>,
    /// Parts in the box.
    pub parts: Parts,
}

impl Default for BenchPoint {
    fn default() -> Self {
        BenchPoint {
            ratio: 1.0,
            input_rad_s: crate::keys::rad_s(2500.0),
            output_nm: 0.0,
            throttle: 0.0,
            pressure_pa: None,
            pressure_factor: 1.0,
            sump_k: 348.15,
            belt_k: None,
            parts: Parts::ALL,
        }
    }
}

/// The bench's answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchAnswer {
    /// The point that it is of.
    pub point: BenchPoint,
    /// Loss of each component, Nm at the input shaft; NaN where slip leaves no point at which the box turns.
    pub loss_nm: ByComponent<f64>,
    /// Part of the seal rings' loss at the primary, Nm: it stays in the box as long as the pump does.
    pub primary_ring_nm: f64,
    /// Torque at the input shaft, Nm (RB-1, RB-3).
    pub input_nm: f64,
    /// Speed of the output shaft, rad/s.
    pub output_rad_s: f64,
    /// Secondary pressure, Pa; NaN for a manual box and without a pump.
    pub secondary_pa: f64,
    /// Belt and spray, K; NaN without a belt.
    pub belt_k: f64,
    /// The belt in detail; none for a manual box, a removed belt or one replaced by a map.
    pub belt: Option<BeltState>,
    /// Flow of the pump that works against pressure, m3/s.
    pub oil_flow_m3_s: f64,
    /// Flags that apply at this point.
    pub flags: Flags,
}

impl BenchAnswer {
    /// Loss of one component, Nm at the input shaft.
    pub fn part_nm(&self, component: Component) -> f64 {
        self.loss_nm[component]
    }

    /// All losses, Nm at the input shaft.
    pub fn total_nm(&self) -> f64 {
        self.loss_nm.iter().sum()
    }

    /// All belt losses, Nm at the input shaft.
    pub fn belt_nm(&self) -> f64 {
        belt_nm(&self.loss_nm)
    }
}

/// All belt losses, Nm at the input shaft.
pub(super) fn belt_nm(loss_nm: &ByComponent<f64>) -> f64 {
    let belt = Component::ALL.into_iter().filter(|c| c.is_belt());
    belt.map(|c| loss_nm[c]).sum()
}
