//! The assembly of the CVT: which part turns with which shaft, what torque it takes, and what it loses. Driving and bench share it.

use super::controller::ClampSignals;
use super::pulley_bearing::PulleyBearing;
use super::pump::{PumpAtTemperature, PumpState, TurningPump};
use super::variator::{BeltAtRatio, BeltLoad, BeltLosses, belt_losses};
use super::{Cvt, LossChanges, viscosity_power};
use crate::fluid::{Lubricant, OilState};
use crate::maps::MapPoint;
use crate::transmission::component::Component;
use crate::transmission::gear_train::{TrainLosses, TurningTrain};

/// The parts of a CVT that are in the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Final drive.
    pub final_drive: bool,
    /// Belt; without it nothing behind the primary turns.
    pub belt: bool,
    /// Plates of the reverse clutch.
    pub reverse_clutch: bool,
    /// Pump; without it the circuit has no pressure.
    pub pump: bool,
    /// Friction of the rings that seal the oil feed of the pulleys; no test takes them out, but a map of the belt is without them.
    pub seal_rings: bool,
}

impl Parts {
    /// The complete box.
    pub const ALL: Parts = Parts {
        final_drive: true,
        belt: true,
        reverse_clutch: true,
        pump: true,
        seal_rings: true,
    };
}

/// Shaft on which a loss torque acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shaft {
    Engine,
    Primary,
    Secondary,
    /// The shaft into the final drive: the secondary's but for a clutch behind it.
    Output,
}

/// Powers of viscosity in the drags of the shafts, (nu/nu_80)^m with the exponent of each.
#[derive(Clone, Copy)]
pub(crate) struct ViscosityPowers {
    pub shaft: f64,
    pub clutch: f64,
}

impl ViscosityPowers {
    /// The powers at a viscosity.
    pub fn new(cvt: &Cvt, nu_m2_s: f64) -> Self {
        ViscosityPowers {
            shaft: viscosity_power(nu_m2_s, cvt.shaft_drag.exponent),
            clutch: viscosity_power(nu_m2_s, cvt.clutch_drag.exponent),
        }
    }

    /// Their logarithms, from ln(nu/nu_80).
    #[inline]
    pub fn exponents(cvt: &Cvt, log_nu: f64) -> [f64; 2] {
        [cvt.shaft_drag.exponent, cvt.clutch_drag.exponent].map(|exponent| exponent * log_nu)
    }
}

/// Bearings and seal rings of the pulleys at one ratio.
#[derive(Clone, Copy)]
pub(crate) struct PulleyShafts {
    /// Radial force on each shaft per clamping force of the secondary; 0 without a belt that pulls (PB-1).
    pull_per_clamp: f64,
    /// Torque of the rings over the pressure of their cylinder, Nm/Pa; 0 without pressure (SR-1).
    ring_per_pa: f64,
}

impl PulleyShafts {
    /// What the parts in the box leave of them. The printed forms know neither, and a measured map of the belt holds the bearings.
    #[inline]
    pub fn new(cvt: &Cvt, at: &BeltAtRatio, parts: Parts) -> Self {
        let counted = cvt.belt.formulation.by_statics();
        let pulled = counted && parts.belt && !cvt.has_map(Component::BeltMap);
        PulleyShafts {
            pull_per_clamp: if pulled {
                PulleyBearing::pull_per_clamp(&cvt.belt, at)
            } else {
                0.0
            },
            ring_per_pa: if counted && parts.pump && parts.seal_rings {
                cvt.seal_ring.torque_per_pa()
            } else {
                0.0
            },
        }
    }
}

/// The CVT at one ratio and oil temperature: what depends on neither torque, pressure nor speed.
#[derive(Clone, Copy)]
pub(crate) struct Driveline<'a> {
    pub cvt: &'a Cvt,
    pub at: &'a BeltAtRatio,
    pub parts: Parts,
    pub viscosity: ViscosityPowers,
    pub pump: PumpAtTemperature,
    pub shafts: PulleyShafts,
    /// Factor of the clamp map at the ratio (PC-1).
    pub radius_factor: f64,
    /// Logarithm of the force ratio that the shift needs (PC-5).
    pub force_log: f64,
    /// Transmission oil, K.
    pub oil_k: f64,
    /// The same oil.
    pub oil: OilState,
    /// Losses that are not those of the models, if there are any.
    pub changes: Option<&'a LossChanges>,
}

/// What turns with the engine's shaft, at its speed.
#[derive(Clone, Copy)]
pub(crate) struct EngineShaft<'a> {
    pub rad_s: f64,
    pub pump: TurningPump<'a>,
    /// Drag of the input shaft by its model, Nm.
    drag_nm: f64,
}

/// How the secondary is clamped.
#[derive(Clone, Copy)]
pub(crate) struct Clamp {
    /// Pressure of the secondary, Pa.
    pub pressure_pa: f64,
    /// Force of the secondary, N.
    pub secondary_n: f64,
}

/// Torques of all parts at one operating point, Nm, each at its own shaft.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PartTorques {
    /// Loss of the final drive, at the secondary.
    pub final_drive: f64,
    /// At the secondary pulley, bearing and rings of its shaft with it: what the belt carries.
    pub secondary: f64,
    /// Bearings of the pulley shafts, primary and secondary.
    pub bearing: [f64; 2],
    /// Seal rings of the pulleys, primary and secondary.
    pub ring: [f64; 2],
    /// Belt, by part.
    pub belt: BeltLosses,
    /// Belt, where a map replaces its parts.
    pub belt_map: Option<f64>,
    /// The whole box, where a map replaces all of it, at the flywheel (MP-3).
    pub box_map: Option<f64>,
    pub clutch: f64,
    pub pump: f64,
    /// Loss of the alternator for an electric pump.
    pub alternator: f64,
    pub shaft: f64,
}

impl PartTorques {
    /// Parts that turn with the primary, the belt apart, Nm at the primary.
    #[inline]
    pub fn primary_nm(&self) -> f64 {
        self.clutch + self.bearing[0] + self.ring[0]
    }

    /// Slip and loss torque of the belt, Nm at the primary: a map has no slip.
    #[inline]
    pub fn belt_in_force(&self) -> (f64, f64) {
        match self.belt_map {
            Some(loss) => (0.0, loss),
            None => (self.belt.slip_total, self.belt.sum_nm()),
        }
    }

    /// Parts that turn with the engine, Nm at the flywheel.
    #[inline]
    pub fn engine_nm(&self) -> f64 {
        self.pump + self.shaft + self.alternator + self.box_map.unwrap_or(0.0)
    }

    /// Torque at the flywheel with that of the coupling, Nm.
    pub fn flywheel_nm(&self, coupling_nm: f64) -> f64 {
        coupling_nm + self.pump + self.shaft + self.alternator + self.box_map.unwrap_or(0.0)
    }

    /// Gives every loss torque with its component and shaft.
    #[inline(always)]
    pub fn for_each_loss(&self, mut give: impl FnMut(Component, Shaft, f64)) {
        if let Some(loss) = self.box_map {
            return give(Component::BoxMap, Shaft::Engine, loss);
        }
        match self.belt_map {
            Some(loss) => give(Component::BeltMap, Shaft::Primary, loss),
            None => {
                let belt = &self.belt;
                give(Component::PulleyBearing, Shaft::Primary, self.bearing[0]);
                give(Component::PulleyBearing, Shaft::Secondary, self.bearing[1]);
                give(Component::BeltBand, Shaft::Primary, belt.band_nm);
                give(Component::BeltFilm, Shaft::Primary, belt.film_nm);
                give(Component::BeltSlip, Shaft::Primary, belt.slip_nm);
                give(Component::BeltWedge, Shaft::Primary, belt.wedge_nm);
                give(
                    Component::BeltPenetration,
                    Shaft::Primary,
                    belt.penetration_nm,
                );
            }
        }
        give(Component::FinalDrive, Shaft::Output, self.final_drive);
        give(Component::SealRing, Shaft::Primary, self.ring[0]);
        give(Component::SealRing, Shaft::Secondary, self.ring[1]);
        give(Component::ClutchDrag, Shaft::Primary, self.clutch);
        give(Component::Pump, Shaft::Engine, self.pump);
        give(Component::InputShaft, Shaft::Engine, self.shaft);
    }
}

/// The final drive at a speed of the secondary, for a torque that is demanded behind it, Nm at the secondary (FD-1).
pub(super) fn final_drive(
    cvt: &Cvt,
    secondary_rad_s: f64,
    demand_nm: f64,
    oil: OilState,
) -> TurningTrain {
    let train = &cvt.final_drive.train;
    let turning = train.turning(secondary_rad_s, demand_nm, oil);
    match cvt.changes.as_deref() {
        Some(changes) => {
            turning.times(&TrainLosses::all(changes.factor[Component::FinalDrive])) // CV-7
        }
        None => turning,
    }
}

impl<'a> Driveline<'a> {
    /// The box with some of its parts at an oil temperature, K.
    pub fn new(
        cvt: &'a Cvt,
        at: &'a BeltAtRatio,
        oil: &Lubricant,
        oil_k: f64,
        parts: Parts,
    ) -> Self {
        let state = oil.state(oil_k);
        let eta_pa_s = state.kinematic_m2_s * state.density_kg_m3;
        Driveline {
            cvt,
            at,
            parts,
            viscosity: ViscosityPowers::new(cvt, state.kinematic_m2_s),
            pump: cvt.pump.at(eta_pa_s),
            shafts: PulleyShafts::new(cvt, at, parts),
            radius_factor: cvt.radius_factor(at),
            force_log: 0.0,
            oil_k,
            oil: state,
            changes: cvt.changes.as_deref(),
        }
    }

    /// Loss that a component's map gives at a speed, torque and pressure, times the component's factor, Nm; clears `inside` outside the map.
    fn mapped(
        &self,
        component: Component,
        (speed_rad_s, torque_nm, pressure_pa): (f64, f64, f64),
        inside: &mut bool,
    ) -> Option<f64> {
        let changes = self.changes?;
        let map = changes.maps[component].as_ref()?;
        let (loss, within) = map.loss_nm(&MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: speed_rad_s,
            torque_nm,
            pressure_pa,
            oil_k: self.oil_k,
        });
        *inside &= within;
        Some(changes.factor[component] * loss) // CV-7
    }

    /// A model's loss torque, Nm, with the component's factor.
    #[inline]
    fn scaled(&self, component: Component, model_nm: f64) -> f64 {
        match self.changes {
            Some(changes) => changes.factor[component] * model_nm, // CV-7
            None => model_nm,
        }
    }

    /// Loss torque of a component, Nm: of its map at a speed, torque and pressure, else of its model.
    #[inline]
    fn loss_nm(
        &self,
        component: Component,
        at: (f64, f64, f64),
        inside: &mut bool,
        model_nm: impl FnOnce() -> f64,
    ) -> f64 {
        self.mapped(component, at, inside)
            .unwrap_or_else(|| self.scaled(component, model_nm()))
    }

    /// Losses and slip of the belt.
    #[inline(always)]
    pub fn belt_losses(&self, load: &BeltLoad) -> BeltLosses {
        let losses = belt_losses(&self.cvt.belt, self.at, load);
        match self.changes {
            Some(changes) => losses.times(&changes.factor), // CV-7
            None => losses,
        }
    }

    /// The final drive at a speed of the secondary, for a torque that is demanded behind it, Nm at the secondary (FD-1).
    pub fn final_drive(&self, secondary_rad_s: f64, demand_nm: f64) -> TurningTrain {
        final_drive(self.cvt, secondary_rad_s, demand_nm, self.oil)
    }

    /// Sets the torques to those of what turns with the secondary for a torque behind the final drive, Nm: those of the final drive, `drive`,
    /// then bearing and rings of the shaft.
    #[inline(always)]
    pub fn secondary(
        &self,
        output_nm: f64,
        drive: impl FnOnce() -> TurningTrain,
        (primary_rad_s, secondary_rad_s): (f64, f64),
        clamp: &Clamp,
        inside: &mut bool,
        torques: &mut PartTorques,
    ) {
        *torques = self.through(
            output_nm,
            drive,
            (primary_rad_s, secondary_rad_s),
            clamp.pressure_pa,
            inside,
        );
        self.turn_secondary(torques, clamp);
    }

    /// Torque into the final drive for one behind it, Nm, in place of the secondary's.
    #[inline(always)]
    pub fn through(
        &self,
        output_nm: f64,
        drive: impl FnOnce() -> TurningTrain,
        (primary_rad_s, secondary_rad_s): (f64, f64),
        pressure_pa: f64,
        inside: &mut bool,
    ) -> PartTorques {
        let through_nm = if self.parts.final_drive && !self.is_mapped() {
            let at = (primary_rad_s, output_nm, pressure_pa);
            match self.mapped(Component::FinalDrive, at, inside) {
                Some(loss) => output_nm + loss * primary_rad_s / secondary_rad_s,
                None => drive().input_nm(output_nm), // FD-2
            }
        } else {
            output_nm
        };
        PartTorques {
            final_drive: through_nm - output_nm,
            secondary: through_nm,
            ..PartTorques::default()
        }
    }

    /// Adds bearing and rings of the secondary's shaft to its torque.
    #[inline(always)]
    pub fn turn_secondary(&self, torques: &mut PartTorques, clamp: &Clamp) {
        if self.parts.belt && !self.is_mapped() {
            torques.bearing[1] = self.bearing_nm(1, clamp);
            if !self.cvt.has_map(Component::SealRing) {
                let nm = self.shafts.ring_per_pa * clamp.pressure_pa;
                torques.ring[1] = self.scaled(Component::SealRing, nm);
            }
            torques.secondary += torques.bearing[1] + torques.ring[1];
        }
    }

    /// Torque of the bearing on a pulley's shaft, Nm (PB-2).
    #[inline]
    fn bearing_nm(&self, pulley: usize, clamp: &Clamp) -> f64 {
        let pull_n = self.shafts.pull_per_clamp * clamp.secondary_n;
        let nm = self.cvt.pulley_bearing.torque_nm(pulley, pull_n);
        self.scaled(Component::PulleyBearing, nm)
    }

    /// Torque of the primary's rings, Nm, or of those of both pulleys where a map has them (SR-1).
    #[inline]
    fn primary_ring_nm(&self, primary_rad_s: f64, clamp: &Clamp, inside: &mut bool) -> f64 {
        if !self.parts.pump {
            return 0.0;
        }
        let at = (primary_rad_s, 0.0, clamp.pressure_pa);
        self.loss_nm(Component::SealRing, at, inside, || {
            self.shafts.ring_per_pa * self.cvt.primary_pa(clamp.secondary_n, self.at)
        })
    }

    /// Whether a map is in the place of all losses of the box (MP-3).
    #[inline]
    fn is_mapped(&self) -> bool {
        self.changes
            .is_some_and(|changes| changes.maps[Component::BoxMap].is_some())
    }

    /// Sets the loss of a box that is replaced by a map to that at rest, where it is known (MP-3).
    pub fn rest(&self, torques: &mut PartTorques) {
        let at_rest = self.changes.and_then(|changes| {
            let factor = changes.factor[Component::BoxMap];
            changes.at_rest_nm.map(|nm| factor * nm)
        });
        torques.box_map = torques.box_map.map(|loss| at_rest.unwrap_or(loss)); // MP-3
    }

    /// Loss of a box that is replaced by a map, Nm at the flywheel, for a torque behind it at the secondary (MP-3).
    #[inline]
    fn box_map_nm(&self, secondary_nm: f64, engine_rad_s: f64, inside: &mut bool) -> Option<f64> {
        let changes = self.changes?;
        let map = changes.maps[Component::BoxMap].as_ref()?;
        let behind = MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: engine_rad_s,
            torque_nm: secondary_nm * self.at.prepared.inv_ratio,
            pressure_pa: 0.0,
            oil_k: self.oil_k,
        };
        let (loss, within) = map.loss_behind_nm(&behind, changes.factor[Component::BoxMap]);
        *inside &= within;
        Some(loss) // MP-3
    }

    /// Loss of a belt that is replaced by a map, Nm at the primary.
    #[inline]
    pub fn belt_map_nm(
        &self,
        secondary_nm: f64,
        primary_rad_s: f64,
        pressure_pa: f64,
        inside: &mut bool,
    ) -> Option<f64> {
        if self.is_mapped() {
            return Some(0.0); // MP-3
        }
        let at = (primary_rad_s, secondary_nm, pressure_pa);
        self.mapped(Component::BeltMap, at, inside)
    }

    /// Sets the torques of the parts that turn with the primary, the belt apart, at its speed and a clamping force.
    #[inline]
    pub fn turn_primary(
        &self,
        torques: &mut PartTorques,
        primary_rad_s: f64,
        clamp: &Clamp,
        inside: &mut bool,
    ) {
        if self.is_mapped() {
            return;
        }
        torques.bearing[0] = self.bearing_nm(0, clamp);
        torques.ring[0] = self.primary_ring_nm(primary_rad_s, clamp, inside);
        if self.parts.reverse_clutch {
            let at = (primary_rad_s, 0.0, clamp.pressure_pa);
            let clutch = &self.cvt.clutch_drag;
            torques.clutch = self.loss_nm(Component::ClutchDrag, at, inside, || {
                clutch.torque_nm(self.viscosity.clutch, primary_rad_s)
            });
        }
    }

    /// What turns with the engine's shaft at a speed.
    #[inline(always)]
    pub fn engine_shaft(&self, rad_s: f64) -> EngineShaft<'_> {
        EngineShaft {
            rad_s,
            pump: self.turning_pump(rad_s),
            drag_nm: (self.cvt.shaft_drag).torque_nm(self.viscosity.shaft, rad_s),
        }
    }

    /// The pump at a speed of the engine.
    #[inline(always)]
    pub fn turning_pump(&self, engine_rad_s: f64) -> TurningPump<'_> {
        self.cvt.pump.turning(&self.pump, engine_rad_s)
    }

    /// Sets the torques of the parts that turn with the engine, at its speed, a pressure and a flow into the pulleys; the pump's state.
    #[inline(always)]
    pub fn turn_engine(
        &self,
        torques: &mut PartTorques,
        shaft: &EngineShaft,
        pressure_pa: f64,
        shift_flow_m3_s: f64,
        inside: &mut bool,
    ) -> PumpState {
        let at = (shaft.rad_s, 0.0, pressure_pa);
        let mut state = PumpState::none(pressure_pa);
        if self.parts.pump {
            let need = self.pump.need_m3_s(pressure_pa) + shift_flow_m3_s;
            state = shaft.pump.state(pressure_pa, need);
            state.torque_nm = self.loss_nm(Component::Pump, at, inside, || state.torque_nm);
        }
        torques.box_map = self.box_map_nm(torques.secondary, shaft.rad_s, inside);
        if torques.box_map.is_some() {
            return state;
        }
        torques.pump = state.torque_nm;
        torques.alternator = state.alternator_share * state.torque_nm; // EP-2
        torques.shaft = self.loss_nm(Component::InputShaft, at, inside, || shaft.drag_nm);
        state
    }

    /// The pressure that the circuit holds of the one that the clamp law sets, Pa, and whether the pump's flow is what limits it (PU-6). A pump
    /// that is a measured map says nothing of its flow: it holds any pressure.
    #[inline]
    pub fn held_pa(&self, set_pa: f64, pump: &TurningPump, shift_flow_m3_s: f64) -> (f64, bool) {
        let most_pa = pump.deliverable_pa(shift_flow_m3_s);
        let short = set_pa > most_pa;
        let limits = short && !self.cvt.has_map(Component::Pump);
        (if limits { most_pa } else { set_pa }, short)
    }

    /// Signals of the clamp law.
    #[inline]
    pub fn signals(&self, throttle: f64, engine_rad_s: f64) -> ClampSignals {
        ClampSignals {
            throttle,
            engine_rad_s,
            oil_k: self.oil_k,
            radius_factor: self.radius_factor,
            force_log: self.force_log,
        }
    }
}
