//! Two energy ledgers a row. Every term is computed by the model that owns it; none is found as a remainder.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LE-1 | fuel + work from wheels + power out of the electric store = work to wheels + brake + accessories + transmission losses + change of rotating energy + heat to the engine + exhaust + electric losses | derived: first law |
//! | LE-2 | transmission losses + heat to the engine = heat into the nodes = stored + given to the air | derived: first law |
//! | LE-3 | error = \|in - out\| / sum of absolute terms, 0 for an empty row | contract |

use crate::math::{Mask, Real, physics};

macro_rules! energy_terms {
    ($($term:ident: $doc:literal;)*) => {
        /// Terms of both balances in one row, W.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct EnergyTerms<R: Real = f64> {
            $(#[doc = $doc] pub $term: R,)*
        }

        /// Names of the terms, in the order of [`EnergyTerms::as_array`].
        pub const TERM_NAMES: [&str; [$($doc),*].len()] = [$(stringify!($term)),*];

        #[physics]
        impl<R: Real> EnergyTerms<R> {
            /// The terms in the order of [`TERM_NAMES`].
            pub fn as_array(&self) -> [R; TERM_NAMES.len()] {
                [$(self.$term),*]
            }

            /// Terms from an array in the order of [`TERM_NAMES`].
            pub fn from_array([$($term),*]: [R; TERM_NAMES.len()]) -> Self {
                EnergyTerms { $($term),* }
            }

            /// Adds another row's terms, weighted by its length, J.
            pub fn add(&mut self, other: &EnergyTerms<R>, dt_s: f64) {
                $(self.$term = self.$term + other.$term * dt_s;)*
            }
        }
    };
}

energy_terms! {
    fuel: "Fuel power.";
    wheels: "Power at the wheels as delivered; negative when the wheels drive.";
    brake: "Brakes.";
    accessories: "Accessories.";
    losses: "Sum of the transmission losses.";
    kinetic: "Change of rotating energy.";
    engine_heat: "Heat into the engine's nodes.";
    exhaust: "Exhaust.";
    node_heat: "Heat into all nodes, as the thermal network received it.";
    stored: "Heat stored.";
    to_air: "Heat given to the air.";
    store: "Power out of the electric store; negative into it.";
    electric_loss: "Losses of alternator, electric store and starter, those of the alternator's own load apart.";
}

#[physics]
fn error<R: Real>(difference: R, scale: R) -> R {
    scale
        .gt(scale.splat(0.0))
        .select(difference / scale, scale.splat(0.0)) // LE-3
}

#[physics]
impl<R: Real> EnergyTerms<R> {
    /// Relative error of the power ledger (LE-1).
    pub fn power_error(&self) -> R {
        let zero = self.wheels.splat(0.0);
        let driven = zero.gt(self.wheels);
        let from = driven.select(-self.wheels, zero);
        let to = driven.select(zero, self.wheels);
        let out = to
            + self.brake
            + self.accessories
            + self.losses
            + self.kinetic
            + self.engine_heat
            + self.exhaust
            + self.electric_loss;
        let scale = self.fuel.abs()
            + self.wheels.abs()
            + self.brake.abs()
            + self.accessories.abs()
            + self.losses.abs()
            + self.kinetic.abs()
            + self.engine_heat.abs()
            + self.exhaust.abs()
            + self.store.abs()
            + self.electric_loss.abs();
        error((self.fuel + from + self.store - out).abs(), scale)
    }

    /// Relative error of the heat ledger (LE-2).
    pub fn heat_error(&self) -> R {
        let scale = self.node_heat.abs() + self.stored.abs() + self.to_air.abs();
        let balance = (self.node_heat - (self.stored + self.to_air)).abs();
        let handed = (self.losses + self.engine_heat - self.node_heat).abs();
        error(handed.max(balance), scale)
    }
}
