//! Two energy ledgers a row. Every term is computed by the model that owns it; none is found as a remainder.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LE-1 | fuel + work from wheels = work to wheels + brake + accessories + transmission losses + change of rotating energy + heat to the engine + exhaust | derived: first law |
//! | LE-2 | transmission losses + heat to the engine = heat into the nodes = stored + given to the air | derived: first law |
//! | LE-3 | error = \|in - out\| / sum of absolute terms, 0 for an empty row | contract |

use crate::math::larger;

/// Terms of both ledgers in one row, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyTerms {
    /// Fuel power.
    pub fuel: f64,
    /// Power at the wheels as delivered; negative when the wheels drive.
    pub wheels: f64,
    /// Brakes.
    pub brake: f64,
    /// Accessories.
    pub accessories: f64,
    /// Sum of the transmission losses.
    pub losses: f64,
    /// Change of rotating energy.
    pub kinetic: f64,
    /// Heat into the engine's nodes.
    pub engine_heat: f64,
    /// Exhaust.
    pub exhaust: f64,
    /// Heat into all nodes, as the thermal network received it.
    pub node_heat: f64,
    /// Heat stored.
    pub stored: f64,
    /// Heat given to the air.
    pub to_air: f64,
}

/// Names of the terms, in the order of [`EnergyTerms::as_array`].
pub const TERM_NAMES: [&str; 11] = [
    "fuel",
    "wheels",
    "brake",
    "accessories",
    "losses",
    "kinetic",
    "engine_heat",
    "exhaust",
    "node_heat",
    "stored",
    "to_air",
];

#[inline]
fn error(difference: f64, scale: f64) -> f64 {
    if scale > 0.0 { difference / scale } else { 0.0 } // LE-3
}

impl EnergyTerms {
    /// Relative error of the power ledger (LE-1).
    #[inline]
    pub fn power_error(&self) -> f64 {
        let (from, to) = if self.wheels < 0.0 {
            (-self.wheels, 0.0)
        } else {
            (0.0, self.wheels)
        };
        let out = to
            + self.brake
            + self.accessories
            + self.losses
            + self.kinetic
            + self.engine_heat
            + self.exhaust;
        let scale = self.fuel.abs()
            + self.wheels.abs()
            + self.brake.abs()
            + self.accessories.abs()
            + self.losses.abs()
            + self.kinetic.abs()
            + self.engine_heat.abs()
            + self.exhaust.abs();
        error((self.fuel + from - out).abs(), scale)
    }

    /// Relative error of the heat ledger (LE-2).
    #[inline]
    pub fn heat_error(&self) -> f64 {
        let scale = self.node_heat.abs() + self.stored.abs() + self.to_air.abs();
        let balance = (self.node_heat - (self.stored + self.to_air)).abs();
        let handed = (self.losses + self.engine_heat - self.node_heat).abs();
        error(larger(handed, balance), scale)
    }

    /// The terms in the order of [`TERM_NAMES`].
    #[inline]
    pub fn as_array(&self) -> [f64; 11] {
        [
            self.fuel,
            self.wheels,
            self.brake,
            self.accessories,
            self.losses,
            self.kinetic,
            self.engine_heat,
            self.exhaust,
            self.node_heat,
            self.stored,
            self.to_air,
        ]
    }

    /// Terms from an array in the order of [`TERM_NAMES`].
    #[inline]
    pub fn from_array(a: [f64; 11]) -> Self {
        EnergyTerms {
            fuel: a[0],
            wheels: a[1],
            brake: a[2],
            accessories: a[3],
            losses: a[4],
            kinetic: a[5],
            engine_heat: a[6],
            exhaust: a[7],
            node_heat: a[8],
            stored: a[9],
            to_air: a[10],
        }
    }

    /// Adds another row's terms, weighted by its length, J.
    #[inline]
    pub fn add(&mut self, other: &EnergyTerms, dt_s: f64) {
        let mut sum = self.as_array();
        for (s, o) in sum.iter_mut().zip(other.as_array()) {
            *s += o * dt_s;
        }
        *self = EnergyTerms::from_array(sum);
    }
}
