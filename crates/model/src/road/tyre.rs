//! Tyres warm up by their own rolling resistance, on the rollers of a dynamometer too.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RL-6 | F += x m g c_r (r - 1) while the car rolls, r = max(1 + k (T_w - T_t), 1/2) | k from UN R117 (0.008 per kelvin of ambient, steady at 80 km/h), derived for the tyre's own temperature; c_r, x ASSUMED within their class |
//! | RL-7 | C_t dT_t/dt = m g c_r r v - (U_0 + U_v v^0.7)(T_t - T_amb), linearly implicit | derived: energy balance of four tyres as one node (Mars, Luchini 1999 in form); C_t, U ASSUMED |
//!
//! The road load's coefficients hold at the tyre temperature T_w: 20 K above the 20 degC for which the coefficients are. The heat is part of the work at the wheels.

use super::GRAVITY_M_S2;
use crate::cycle::Motion;
use crate::keys::{Values, keys};
use crate::math::{Gather, Mask, Real, physics};

/// The checked tyres.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Tyre<R: Real = f64> {
    /// Rolling resistance of the warm car, N; 0 without a tyre model.
    pub warm_n: R,
    /// Share of it that takes part in the measured load.
    pub share: R,
    /// Rise per kelvin below the warm temperature, 1/K.
    pub per_k: R,
    /// Temperature at which the road load holds, K.
    pub warm_k: R,
    /// Heat capacity of all tyres, J/K.
    pub capacity_j_k: R,
    /// To the air at standstill, W/K.
    pub still_w_k: R,
    /// To the air over road speed to the power of 0.7, W/K.
    pub wind_w_k: R,
}

/// Least rolling resistance over that of the warm tyre.
const LEAST: f64 = 0.5;

#[physics]
impl<R: Real> Tyre<R> {
    /// Rolling resistance over that of the warm tyre.
    fn ratio(&self, tyre_k: R) -> R {
        (1.0 + self.per_k * (self.warm_k - tyre_k)).max(LEAST)
    }

    /// Force that tyres at a temperature add to the road load, N.
    pub fn extra_n(&self, tyre_k: R) -> R {
        self.share * self.warm_n * (self.ratio(tyre_k) - 1.0) // RL-6
    }

    /// Temperature of the tyres at the end of a step, K.
    pub fn advance_k(&self, tyre_k: R, ambient_k: R, motion: &Motion, dt_s: f64) -> R {
        let ratio = self.ratio(tyre_k);
        let warm_w = self.warm_n * motion.speed_m_s;
        let air_w_k = self.still_w_k + self.wind_w_k * motion.speed_power_07;
        let slope_w_k = ratio
            .gt(LEAST)
            .select(self.per_k * warm_w, warm_w.splat(0.0));
        let surplus_w = warm_w * ratio - air_w_k * (tyre_k - ambient_k);
        tyre_k + surplus_w / (self.capacity_j_k * dt_s.recip() + air_w_k + slope_w_k) // RL-7
    }
}

keys! {
    /// Keys of `[road_load.tyre]`.
    TYRE: TyreKeys = "tyre" [] {
        rolling_coefficient: or(0.0, number(0.0, 0.05)), "c_r of the warm tyre; 0: the tyres do not warm up. On the road it replaces rolling_per_k", ["RL-6"];
        per_k: or(0.0095, number(0.0, 0.03)), "rise of rolling resistance per kelvin of tyre temperature", ["RL-6"];
        warm_degc: or(40.0, number(-40.0, 100.0)), "tyre temperature at which the road load holds", ["RL-6"];
        share: or(1.0, number(0.0, 1.0)), "share of the car's rolling resistance that takes part: less on rollers under one axle", ["RL-6"];
        heat_capacity_kj_k: or(45.0, number(1.0, 500.0)), "heat capacity of all tyres", ["RL-7"];
        still_w_k: or(20.0, number(0.0, 1000.0)), "tyres to air at standstill", ["RL-7"];
        wind_w_k: or(13.7, number(0.0, 1000.0)), "tyres to air, times road speed in m/s to the power of 0.7", ["RL-7"];
    }
}

impl Tyre {
    /// Checked tyres from the values of their table, for a mass with payload.
    pub(super) fn from_values<V: Values>(s: &V, mass_kg: f64) -> Self {
        Tyre {
            warm_n: mass_kg * GRAVITY_M_S2 * s.number(&TYRE.rolling_coefficient),
            share: s.number(&TYRE.share),
            per_k: s.number(&TYRE.per_k),
            warm_k: s.number(&TYRE.warm_degc),
            capacity_j_k: s.number(&TYRE.heat_capacity_kj_k),
            still_w_k: s.number(&TYRE.still_w_k),
            wind_w_k: s.number(&TYRE.wind_w_k),
        }
    }
}
