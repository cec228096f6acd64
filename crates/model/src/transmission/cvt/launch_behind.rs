//! A launch clutch between variator and final drive: belt and pulleys turn with the engine, at rest too.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LO-1 | w_p = w_e; w_s = w_e (1 - s)/I, and w_fd = i i_fd w_wheel behind the clutch, i of the range (RG-1) | derived: layout; a starting clutch on the driven pulley's shaft, as in Honda's Multi Matic |
//! | LO-2 | LC-1 to LC-6 with T' = T_fd (1 - s)/I in place of T and w' = I w_fd/(1 - s) in place of the speed of the input shaft | derived: torque and speeds of the clutch seen from the engine through the variator; so it locks and lets go where a clutch at the input does |
//! | LO-3 | T' >= creep below idle speed, >= -share (drag + accessories + pump + shaft + T_v) above it, T' <= full load - accessories - pump - shaft - T_v; T_v losses of pulley shafts, belt and reverse clutch at the primary | derived: CV-3 and CV-4 with what lies between clutch and engine |
//! | LO-4 | at rest w_e = idle speed, T' the creep torque: pulleys, belt and pump turn, and the ratio goes to low by RC-4 and RC-5 | derived |
//!
//! T_fd torque into the final drive, s slip of the belt, I its ratio. Locked, it is the car with the clutch at the input. Its own drag while open is not modelled.

use super::driveline::{Clamp, PartTorques};
use super::evaluate::{Chain, Guess, Limit, Step};
use super::variator::BeltLoad;
use crate::math::{Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use crate::thermal::BELT;
use crate::transmission::coupling::{Coupling, EngineSide};

#[physics]
impl<P: PrimeMover<R>, R: Real> Step<'_, P, R> {
    /// From the wheels through a clutch behind the variator to the engine.
    pub(super) fn launch_behind(
        &self,
        g: &Guess<R>,
        limit: &Limit<R::Mask>,
        inside: &mut R::Mask,
        torques: &mut PartTorques<R>,
    ) -> Chain<R> {
        let (line, cvt) = (&self.line, self.line.cvt);
        let over_rad_s = self.primary_rad_s(g.slip);
        *torques = self.behind_clutch(g, over_rad_s, inside);
        let clutch_nm = torques.secondary;
        let guessed = self.at_primary(g.slip);
        let first = self.engine_side(
            g,
            limit,
            (clutch_nm * guessed, over_rad_s),
            self.locked(over_rad_s),
        );
        torques.secondary = self.shaft_nm(clutch_nm, &first, g.slip);
        let w = first.engine_rad_s;
        let clamp = Clamp {
            pressure_pa: g.pressure_pa,
            secondary_n: cvt
                .secondary_clamp_n(g.pressure_pa, self.behind_belt_rad_s(&first, g.slip)),
        };
        line.turn_secondary(torques, &clamp, self.behind_belt_rad_s(&first, g.slip));
        let load = BeltLoad {
            primary_speed_rad_s: w,
            secondary_clamp_n: clamp.secondary_n,
            output_torque_nm: torques.secondary,
            ..self.turning_load(&first, g.slip)
        };
        torques.belt = line.belt_losses(&load);
        torques.belt_map = line.belt_map_nm(torques.secondary, w, g.pressure_pa, inside);
        let primary_n = torques.belt.holding_n;
        line.turn_primary(torques, w, (&clamp, primary_n), inside);
        let (slip, belt_nm) = torques.belt_in_force();
        // With the slip in force, so that the power balance holds for this iterate exactly.
        let over_rad_s = self.primary_rad_s(slip);
        let (locked, referred) = (self.locked(over_rad_s), self.at_primary(slip));
        let passed_nm = clutch_nm * referred; // LO-2
        let mut side = first;
        if !locked.all() {
            let least = cvt.coupling.min_engine_rad_s(over_rad_s);
            side = cvt
                .coupling
                .engine_side(passed_nm, over_rad_s, w.max(least));
        }
        if locked.any() {
            let held = cvt
                .coupling
                .locked_side(passed_nm, over_rad_s, self.hold.slip_rad_s);
            side = EngineSide::select(locked, &held, &side);
        }
        torques.secondary =
            self.shaft_nm(clutch_nm, &side, slip) + (torques.bearing[1] + torques.ring[1]);
        let primary_nm = torques.secondary * referred + belt_nm + torques.primary_nm();
        Chain {
            load,
            slip,
            secondary_rad_s: self.behind_belt_rad_s(&side, slip),
            primary_rad_s: side.engine_rad_s, // LO-1
            primary_nm,
            passed_nm,
            over_rad_s,
            between_nm: primary_nm - side.engine_nm, // LO-3
            side,
            locked,
        }
    }

    /// Torque at the primary over that at the secondary at a slip, without losses.
    fn at_primary(&self, slip: R) -> R {
        (1.0 - slip) * self.line.at.geometry.inv_ratio
    }

    /// The torque that the clutch gives to its output: what the final drive takes, or at rest what creeps.
    fn behind_clutch(&self, g: &Guess<R>, over_rad_s: R, inside: &mut R::Mask) -> PartTorques<R> {
        // All runs of a group are at rest together.
        if self.secondary_rad_s.gt(0.0).any() {
            let speeds = (over_rad_s, self.secondary_rad_s);
            let drive_nm =
                self.line
                    .through_nm(g.output_nm, || self.drive, speeds, g.pressure_pa, inside);
            let range_gear = self.line.range_nm(drive_nm, self.secondary_rad_s);
            return PartTorques {
                final_drive: drive_nm - g.output_nm,
                range_gear,
                secondary: drive_nm + range_gear,
                ..PartTorques::none(drive_nm)
            };
        }
        let idle_rad_s = self.input.engine.idle_rad_s();
        let in_drive = 1.0 - self.input.neutral_share;
        let creep_nm = in_drive
            * self
                .line
                .cvt
                .coupling
                .creep_nm(idle_rad_s.splat(0.0), idle_rad_s); // SE-3
        PartTorques {
            secondary: creep_nm / self.at_primary(g.slip), // LO-4
            ..PartTorques::none(creep_nm)
        }
    }

    /// True where the engine turns as fast as the locked clutch has it.
    fn together(&self, side: &EngineSide<R>, slip: R) -> R::Mask {
        self.primary_rad_s(slip).ge(side.engine_rad_s)
    }

    /// Torque of the clutch at the secondary's shaft, Nm.
    fn shaft_nm(&self, clutch_nm: R, side: &EngineSide<R>, slip: R) -> R {
        let slipping_nm = side.engine_nm / self.at_primary(slip);
        self.together(side, slip).select(clutch_nm, slipping_nm)
    }

    /// Speed of the secondary, rad/s (LO-1).
    fn behind_belt_rad_s(&self, side: &EngineSide<R>, slip: R) -> R {
        let slipping = side.engine_rad_s * self.at_primary(slip); // LO-1
        self.together(side, slip)
            .select(self.secondary_rad_s, slipping)
    }

    /// The unloaded belt at the engine's speed.
    fn turning_load(&self, side: &EngineSide<R>, slip: R) -> BeltLoad<R> {
        let together = self.together(side, slip);
        if together.all() {
            return self.load;
        }
        let (line, oil) = (&self.line, self.input.oil);
        let belt_k = self.input.heat.node_k[BELT];
        let primary_rad_s = line.at.geometry.ratio * self.behind_belt_rad_s(side, slip);
        let sliding = line
            .cvt
            .belt
            .sliding_m_s(line.at.geometry.ratio, primary_rad_s);
        let eta_pa_s = oil.dynamic_pa_s(belt_k);
        let band = oil.friction.band(belt_k, eta_pa_s, sliding);
        let belt_m_s = line.at.geometry.belt_m_s(primary_rad_s);
        let elements = oil.friction.elements(belt_k, eta_pa_s, belt_m_s);
        let film_area_m2 = line.at.prepared.film_area_m2;
        let slipping =
            BeltLoad::unloaded(&oil.friction, band, film_area_m2, sliding).with_elements(elements);
        BeltLoad::select(together, &self.load, &slipping)
    }
}
