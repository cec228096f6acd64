//! The assembly of the CVT: which part turns with which shaft, what torque it takes, and what it loses. Driving and bench share it.

use super::controller::ClampSignals;
use super::pulley_bearing::PulleyBearing;
use super::pump::{PumpAtTemperature, PumpState, TurningPump};
use super::range_gear::TurningRange;
use super::variator::{BeltAtRatio, BeltLoad, BeltLosses, belt_losses};
use super::{Cvt, LossChanges, viscosity_power};
use crate::lubricant::{Lubricant, OilState};
use crate::maps::MapPoint;
use crate::math::{MAX_LANES, Mask, Real, physics};
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
pub(crate) struct ViscosityPowers<R: Real = f64> {
    pub shaft: R,
    pub clutch: R,
}

impl<R: Real> ViscosityPowers<R> {
    /// The powers at a viscosity.
    pub fn new(cvt: &Cvt<R>, nu_m2_s: R) -> Self {
        ViscosityPowers {
            shaft: viscosity_power(nu_m2_s, cvt.shaft_drag.exponent),
            clutch: viscosity_power(nu_m2_s, cvt.clutch_drag.exponent),
        }
    }

    /// Their logarithms, from ln(nu/nu_80).
    #[physics]
    pub fn exponents(cvt: &Cvt<R>, log_nu: R) -> [R; 2] {
        [
            cvt.shaft_drag.exponent * log_nu,
            cvt.clutch_drag.exponent * log_nu,
        ]
    }
}

/// Bearings and seal rings of the pulleys at one ratio.
#[derive(Clone, Copy)]
pub(crate) struct PulleyShafts<R: Real = f64> {
    /// Radial force on each shaft per clamping force of the secondary; 0 without a belt that pulls (PB-1).
    pull_per_clamp: R,
    /// Torque of the rings over the pressure of their cylinder, Nm/Pa; 0 without pressure (SR-1).
    ring_per_pa: R,
    /// True where the shafts drag without load: not in the printed forms, nor where a measured map of the belt includes them (PB-3).
    counted: bool,
}

#[physics]
impl<R: Real> PulleyShafts<R> {
    /// Keeps those of the parts in the box. The printed forms have neither, and a measured map of the belt includes the bearings.
    #[inline]
    pub fn new(cvt: &Cvt<R>, at: &BeltAtRatio<R>, parts: Parts) -> Self {
        let none = at.direction.splat(0.0);
        let counted = cvt.belt.formulation.by_statics();
        let pulled = counted && parts.belt && !cvt.has_map(Component::BeltMap);
        PulleyShafts {
            pull_per_clamp: if pulled {
                PulleyBearing::pull_per_clamp(&cvt.belt, at)
            } else {
                none
            },
            counted: pulled,
            ring_per_pa: if counted && parts.pump && parts.seal_rings {
                cvt.seal_ring.torque_per_pa()
            } else {
                none
            },
        }
    }
}

/// Inputs of a component's map.
#[derive(Clone, Copy)]
struct MapInputs<R> {
    speed_rad_s: R,
    torque_nm: R,
    pressure_pa: R,
}

/// The CVT at one ratio and oil temperature: what depends on neither torque, pressure nor speed.
#[derive(Clone, Copy)]
pub(crate) struct Driveline<'a, R: Real = f64> {
    pub cvt: &'a Cvt<R>,
    pub at: &'a BeltAtRatio<R>,
    pub parts: Parts,
    pub viscosity: ViscosityPowers<R>,
    pub pump: PumpAtTemperature<R>,
    pub shafts: PulleyShafts<R>,
    /// Factor of the clamp map at the ratio (PC-1).
    pub radius_factor: R,
    /// Logarithm of the force ratio that the shift needs (PC-5).
    pub force_log: R,
    /// Transmission oil, K.
    pub oil_k: R,
    /// The same oil.
    pub oil: OilState<R>,
    /// Set behind the secondary, in a box with two ranges.
    pub range: Option<TurningRange<'a, R>>,
    /// Losses that are not those of the models, if there are any.
    pub changes: Option<&'a LossChanges<R>>,
}

/// Parts on the engine's shaft, at its speed.
#[derive(Clone, Copy)]
pub(crate) struct EngineShaft<'a, R: Real = f64> {
    pub rad_s: R,
    pub pump: TurningPump<'a, R>,
    /// Drag of the input shaft by its model, Nm.
    drag_nm: R,
}

/// Answer of the pump's circuit to the pressure that the clamp law sets.
#[derive(Clone, Copy)]
pub(crate) struct Circuit<R: Real = f64> {
    /// Pressure that it holds, Pa.
    pub pressure_pa: R,
    /// True where the pump's flow is what limits it.
    pub limited: R::Mask,
    /// Flow that is left for the shift at that pressure, m3/s; where that is more than the shift takes, maybe what it takes, but in a search.
    pub left_m3_s: R,
}

/// A shift as the pump's circuit sees it.
#[derive(Clone, Copy)]
pub(crate) struct ShiftNeed<R: Real = f64> {
    /// Flow into the pulleys, m3/s.
    pub flow_m3_s: R,
    /// True where the clamp is fed before it (PU-7).
    pub clamp_first: bool,
    /// True while the largest flow that there is for it is searched (RC-5): what is left is worked out also where there is surely enough.
    pub searched: bool,
}

/// How the secondary is clamped.
#[derive(Clone, Copy)]
pub(crate) struct Clamp<R: Real = f64> {
    /// Pressure of the secondary, Pa.
    pub pressure_pa: R,
    /// Force of the secondary, N.
    pub secondary_n: R,
}

/// Torques of all parts at one operating point, Nm, each at its own shaft.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PartTorques<R: Real = f64> {
    /// Loss of the final drive, at the secondary.
    pub final_drive: R,
    /// Loss of the set with two ranges, at the secondary.
    pub range_gear: R,
    /// Torque that a launch gear takes past the belt, at the secondary (RG-6).
    pub past_belt: R,
    /// At the secondary pulley, bearing and rings of its shaft with it: what the belt carries.
    pub secondary: R,
    /// Bearings of the pulley shafts, primary and secondary.
    pub bearing: [R; 2],
    /// Seal rings of the pulleys, primary and secondary.
    pub ring: [R; 2],
    /// Belt, by part.
    pub belt: BeltLosses<R>,
    /// Belt, where a map replaces its parts.
    pub belt_map: Option<R>,
    /// The whole box, where a map replaces all of it, at the flywheel (MP-3).
    pub box_map: Option<R>,
    pub clutch: R,
    pub pump: R,
    /// Loss of the alternator for an electric pump.
    pub alternator: R,
    pub shaft: R,
}

#[physics]
impl<R: Real> PartTorques<R> {
    /// None; `like` has the lanes.
    pub fn none(like: R) -> Self {
        let none = like.splat(0.0);
        PartTorques {
            final_drive: none,
            range_gear: none,
            past_belt: none,
            secondary: none,
            bearing: [none; 2],
            ring: [none; 2],
            belt: BeltLosses {
                band_nm: none,
                film_nm: none,
                joint_nm: none,
                pin_nm: none,
                slip_nm: none,
                wedge_nm: none,
                penetration_nm: none,
                slip_total: none,
                capacity_nm: none,
                holding_n: none,
                gross_slip: like.splat_mask(false),
            },
            belt_map: None,
            box_map: None,
            clutch: none,
            pump: none,
            alternator: none,
            shaft: none,
        }
    }

    /// Parts that turn with the primary, the belt apart, Nm at the primary.
    pub fn primary_nm(&self) -> R {
        self.clutch + self.bearing[0] + self.ring[0]
    }

    /// Slip and loss torque of the belt, Nm at the primary: a map has no slip.
    pub fn belt_in_force(&self) -> (R, R) {
        match self.belt_map {
            Some(loss) => (loss.splat(0.0), loss),
            None => (self.belt.slip_total, self.belt.sum_nm()),
        }
    }

    /// Parts that turn with the engine, Nm at the flywheel.
    pub fn engine_nm(&self) -> R {
        self.pump + self.shaft + self.alternator + self.box_map_nm()
    }

    /// Loss of a box that is a map, Nm at the flywheel; 0 without one.
    fn box_map_nm(&self) -> R {
        match self.box_map {
            Some(loss) => loss,
            None => self.pump.splat(0.0),
        }
    }

    /// Torque at the flywheel with that of the coupling, Nm.
    pub fn flywheel_nm(&self, coupling_nm: R) -> R {
        coupling_nm + self.pump + self.shaft + self.alternator + self.box_map_nm()
    }

    /// Gives every loss torque with its component and shaft.
    pub fn for_each_loss(&self, mut give: impl FnMut(Component, Shaft, R)) {
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
                give(Component::ChainJoint, Shaft::Primary, belt.joint_nm);
                give(Component::ChainPin, Shaft::Primary, belt.pin_nm);
                give(Component::BeltSlip, Shaft::Primary, belt.slip_nm);
                give(Component::BeltWedge, Shaft::Primary, belt.wedge_nm);
                give(
                    Component::BeltPenetration,
                    Shaft::Primary,
                    belt.penetration_nm,
                );
            }
        }
        give(Component::RangeGear, Shaft::Output, self.range_gear);
        give(Component::FinalDrive, Shaft::Output, self.final_drive);
        give(Component::SealRing, Shaft::Primary, self.ring[0]);
        give(Component::SealRing, Shaft::Secondary, self.ring[1]);
        give(Component::ClutchDrag, Shaft::Primary, self.clutch);
        give(Component::Pump, Shaft::Engine, self.pump);
        give(Component::InputShaft, Shaft::Engine, self.shaft);
    }
}

/// The final drive at a speed of the secondary, for a torque that is demanded behind it, Nm at the secondary (FD-1).
#[physics]
pub(super) fn final_drive<R: Real>(
    cvt: &Cvt<R>,
    secondary_rad_s: R,
    demand_nm: R,
    oil: OilState<R>,
) -> TurningTrain<R> {
    let train = &cvt.final_drive.train;
    let turning = train.turning(secondary_rad_s, demand_nm, oil);
    match cvt.changes.as_deref() {
        Some(changes) => {
            turning.times(&TrainLosses::all(changes.factor[Component::FinalDrive])) // CV-7
        }
        None => turning,
    }
}

#[physics]
impl<'a, R: Real> Driveline<'a, R> {
    /// The box with some of its parts at an oil temperature, K.
    #[inline]
    pub fn new(
        cvt: &'a Cvt<R>,
        at: &'a BeltAtRatio<R>,
        oil: &Lubricant<R>,
        oil_k: R,
        parts: Parts,
    ) -> Self {
        let state = oil.state(oil_k);
        Driveline {
            cvt,
            at,
            parts,
            viscosity: ViscosityPowers::new(cvt, state.kinematic_m2_s),
            pump: cvt.pump.at(state.dynamic_pa_s),
            shafts: PulleyShafts::new(cvt, at, parts),
            radius_factor: cvt.radius_factor(at),
            force_log: oil_k.splat(0.0),
            oil_k,
            oil: state,
            range: (cvt.ranges.as_ref()).map(|set| set.in_oil(set.in_high(), state.kinematic_m2_s)),
            changes: cvt.changes.as_deref(),
        }
    }

    /// Loss that a component's map gives at a speed, torque and pressure, times the component's factor, Nm; clears `inside` outside the map.
    fn mapped(&self, component: Component, at: MapInputs<R>, inside: &mut R::Mask) -> Option<R> {
        let changes = self.changes?;
        let map = changes.maps[component].as_ref()?;
        // Copied here, so that a car without maps does not store it.
        let at = MapInputs { ..at };
        let loss = self.looked_up(at, inside, |lane, point| R::get(map, lane).loss_nm(point));
        Some(changes.factor[component] * loss) // CV-7
    }

    /// Looks up the maps of the runs at a speed, torque and pressure, one by one; clears `inside` outside a map.
    #[inline]
    fn looked_up(
        &self,
        at: MapInputs<R>,
        inside: &mut R::Mask,
        of: impl Fn(usize, &MapPoint) -> (f64, bool),
    ) -> R {
        let (mut loss, mut within) = (at.torque_nm, [true; MAX_LANES]);
        for (lane, within) in within.iter_mut().enumerate().take(R::LANES) {
            let point = MapPoint {
                ratio: self.at.geometry.ratio.lane(lane),
                input_speed_rad_s: at.speed_rad_s.lane(lane),
                torque_nm: at.torque_nm.lane(lane),
                pressure_pa: at.pressure_pa.lane(lane),
                oil_k: self.oil_k.lane(lane),
            };
            let nm;
            (nm, *within) = of(lane, &point);
            loss = loss.with_lane(lane, nm);
        }
        *inside = *inside & loss.mask_lanes(|lane| within[lane]);
        loss
    }

    /// A model's loss torque, Nm, with the component's factor.
    fn scaled(&self, component: Component, model_nm: R) -> R {
        match self.changes {
            Some(changes) => changes.factor[component] * model_nm, // CV-7
            None => model_nm,
        }
    }

    /// Loss torque of a component, Nm: of its map at a speed, torque and pressure, else of its model.
    fn loss_nm(
        &self,
        component: Component,
        at: MapInputs<R>,
        inside: &mut R::Mask,
        model_nm: impl FnOnce() -> R,
    ) -> R {
        match self.mapped(component, at, inside) {
            Some(loss) => loss,
            None => self.scaled(component, model_nm()),
        }
    }

    /// Losses and slip of the belt.
    pub fn belt_losses(&self, load: &BeltLoad<R>) -> BeltLosses<R> {
        let losses = belt_losses(&self.cvt.belt, self.at, load);
        match self.changes {
            Some(changes) => losses.times(&changes.factor), // CV-7
            None => losses,
        }
    }

    /// The final drive at a speed of the secondary, for a torque that is demanded behind it, Nm at the secondary (FD-1).
    #[inline]
    pub fn final_drive(&self, secondary_rad_s: R, demand_nm: R) -> TurningTrain<R> {
        final_drive(self.cvt, secondary_rad_s, demand_nm, self.oil)
    }

    /// Sets the torques to those of what turns with the secondary for a torque behind the final drive, Nm: those of the final drive, `drive`,
    /// then bearing and rings of the shaft.
    pub fn secondary(
        &self,
        output_nm: R,
        drive: impl FnOnce() -> TurningTrain<R>,
        (primary_rad_s, secondary_rad_s): (R, R),
        clamp: &Clamp<R>,
        inside: &mut R::Mask,
        torques: &mut PartTorques<R>,
    ) {
        let speeds_rad_s = (primary_rad_s, secondary_rad_s);
        let drive_nm = self.through_nm(output_nm, drive, speeds_rad_s, clamp.pressure_pa, inside);
        torques.final_drive = drive_nm - output_nm;
        torques.range_gear = self.range_nm(drive_nm, secondary_rad_s);
        torques.past_belt = self.past_belt_nm(drive_nm);
        torques.secondary = drive_nm + torques.range_gear - torques.past_belt;
        self.turn_secondary(torques, clamp, secondary_rad_s);
    }

    /// Torque into the final drive for one behind it, both at the secondary, Nm.
    pub fn through_nm(
        &self,
        output_nm: R,
        drive: impl FnOnce() -> TurningTrain<R>,
        (primary_rad_s, secondary_rad_s): (R, R),
        pressure_pa: R,
        inside: &mut R::Mask,
    ) -> R {
        if self.parts.final_drive && !self.is_mapped() {
            let at = MapInputs {
                speed_rad_s: primary_rad_s,
                torque_nm: output_nm,
                pressure_pa,
            };
            match self.mapped(Component::FinalDrive, at, inside) {
                Some(loss) => output_nm + loss * primary_rad_s / secondary_rad_s,
                None => match &self.range {
                    Some(range) => {
                        let ratio = range.ratio();
                        drive().input_nm(output_nm * ratio) / ratio // FD-2, RG-1
                    }
                    None => drive().input_nm(output_nm), // FD-2
                },
            }
        } else {
            output_nm
        }
    }

    /// Loss of the set with two ranges for a torque into the final drive, both at the secondary, Nm.
    pub fn range_nm(&self, drive_nm: R, secondary_rad_s: R) -> R {
        match &self.range {
            Some(range) if self.parts.final_drive && !self.is_mapped() => self.scaled(
                Component::RangeGear,
                range.loss_nm(drive_nm, secondary_rad_s),
            ),
            _ => drive_nm.splat(0.0),
        }
    }

    /// Torque that a launch gear takes past the belt for one into the final drive, both at the secondary, Nm (RG-6).
    fn past_belt_nm(&self, drive_nm: R) -> R {
        match &self.range {
            Some(range) if self.parts.final_drive && !self.is_mapped() => {
                range.past_belt_nm(drive_nm)
            }
            _ => drive_nm.splat(0.0),
        }
    }

    /// Adds bearing and rings of the secondary's shaft to its torque.
    pub fn turn_secondary(
        &self,
        torques: &mut PartTorques<R>,
        clamp: &Clamp<R>,
        secondary_rad_s: R,
    ) {
        if self.parts.belt && !self.is_mapped() {
            torques.bearing[1] =
                self.bearing_nm(1, clamp) + self.secondary_idle_nm(secondary_rad_s);
            if !self.cvt.has_map(Component::SealRing) {
                let nm = self.shafts.ring_per_pa * clamp.pressure_pa;
                torques.ring[1] = self.scaled(Component::SealRing, nm);
            }
            torques.secondary = torques.secondary + (torques.bearing[1] + torques.ring[1]);
        }
    }

    /// Torque of the bearing on a pulley's shaft, Nm (PB-2).
    fn bearing_nm(&self, pulley: usize, clamp: &Clamp<R>) -> R {
        let pull_n = self.shafts.pull_per_clamp * clamp.secondary_n;
        let nm = self.cvt.pulley_bearing.torque_nm(pulley, pull_n);
        self.scaled(Component::PulleyBearing, nm)
    }

    /// Torque of the secondary's shaft without load, Nm (PB-3).
    fn secondary_idle_nm(&self, secondary_rad_s: R) -> R {
        let cvt = self.cvt;
        let none = secondary_rad_s.splat(0.0);
        if !self.shafts.counted {
            return none;
        }
        let power = self.viscosity.shaft;
        let nm = (cvt.pulley_bearing).idle_nm(power, &cvt.shaft_drag.heating, secondary_rad_s);
        let turns = secondary_rad_s.gt(0.0);
        self.scaled(Component::PulleyBearing, turns.select(nm, none))
    }

    /// Torque of the primary's rings, Nm, or of those of both pulleys where a map has them (SR-1).
    fn primary_ring_nm(
        &self,
        primary_rad_s: R,
        (clamp, primary_n): (&Clamp<R>, R),
        inside: &mut R::Mask,
    ) -> R {
        let none = primary_rad_s.splat(0.0);
        if !self.parts.pump {
            return none;
        }
        let at = MapInputs {
            speed_rad_s: primary_rad_s,
            torque_nm: none,
            pressure_pa: clamp.pressure_pa,
        };
        self.loss_nm(Component::SealRing, at, inside, || {
            self.shafts.ring_per_pa * self.cvt.primary_pa(primary_n)
        })
    }

    /// True if a map replaces all losses of the box (MP-3).
    fn is_mapped(&self) -> bool {
        self.changes
            .is_some_and(|changes| changes.maps[Component::BoxMap].is_some())
    }

    /// Sets the loss of a box that is replaced by a map to that at rest, where it is known (MP-3).
    #[inline]
    pub fn rest(&self, torques: &mut PartTorques<R>) {
        if let (Some(changes), Some(loss)) = (self.changes, &mut torques.box_map)
            && let Some(nm) = changes.at_rest_nm
        {
            *loss = changes.factor[Component::BoxMap] * nm; // MP-3
        }
    }

    /// Loss of a box that is replaced by a map, Nm at the flywheel, for a torque behind it at the secondary (MP-3).
    fn box_map_nm(&self, secondary_nm: R, engine_rad_s: R, inside: &mut R::Mask) -> Option<R> {
        let changes = self.changes?;
        let map = changes.maps[Component::BoxMap].as_ref()?;
        let factor = changes.factor[Component::BoxMap];
        let behind_nm = secondary_nm * self.at.geometry.inv_ratio;
        let at = MapInputs {
            speed_rad_s: engine_rad_s,
            torque_nm: behind_nm,
            pressure_pa: behind_nm.splat(0.0),
        };
        Some(self.looked_up(at, inside, |lane, behind| {
            R::get(map, lane).loss_behind_nm(behind, factor.lane(lane))
        })) // MP-3
    }

    /// Loss of a belt that is replaced by a map, Nm at the primary.
    pub fn belt_map_nm(
        &self,
        secondary_nm: R,
        primary_rad_s: R,
        pressure_pa: R,
        inside: &mut R::Mask,
    ) -> Option<R> {
        if self.is_mapped() {
            return Some(secondary_nm.splat(0.0)); // MP-3
        }
        let at = MapInputs {
            speed_rad_s: primary_rad_s,
            torque_nm: secondary_nm,
            pressure_pa,
        };
        self.mapped(Component::BeltMap, at, inside)
    }

    /// Sets the torques of the parts that turn with the primary, the belt apart, at its speed, a clamp and its own clamping force, N.
    pub fn turn_primary(
        &self,
        torques: &mut PartTorques<R>,
        primary_rad_s: R,
        (clamp, primary_n): (&Clamp<R>, R),
        inside: &mut R::Mask,
    ) {
        if self.is_mapped() {
            return;
        }
        torques.bearing[0] = self.bearing_nm(0, clamp);
        torques.ring[0] = self.primary_ring_nm(primary_rad_s, (clamp, primary_n), inside);
        if self.parts.reverse_clutch {
            let at = MapInputs {
                speed_rad_s: primary_rad_s,
                torque_nm: primary_rad_s.splat(0.0),
                pressure_pa: clamp.pressure_pa,
            };
            let clutch = &self.cvt.clutch_drag;
            torques.clutch = self.loss_nm(Component::ClutchDrag, at, inside, || {
                clutch.torque_nm(self.viscosity.clutch, primary_rad_s)
            });
        }
    }

    /// Computes the parts on the engine's shaft at a speed.
    pub fn engine_shaft(&self, rad_s: R) -> EngineShaft<'_, R> {
        EngineShaft {
            rad_s,
            pump: self.turning_pump(rad_s),
            drag_nm: (self.cvt.shaft_drag).torque_nm(self.viscosity.shaft, rad_s),
        }
    }

    /// The pump at a speed of the engine.
    pub fn turning_pump(&self, engine_rad_s: R) -> TurningPump<'_, R> {
        self.cvt.pump.turning(&self.pump, engine_rad_s)
    }

    /// Sets the torques of the parts that turn with the engine, at its speed, a pressure and a flow into the pulleys; the pump's state.
    pub fn turn_engine(
        &self,
        torques: &mut PartTorques<R>,
        shaft: &EngineShaft<R>,
        pressure_pa: R,
        shift_flow_m3_s: R,
        inside: &mut R::Mask,
    ) -> PumpState<R> {
        let at = MapInputs {
            speed_rad_s: shaft.rad_s,
            torque_nm: pressure_pa.splat(0.0),
            pressure_pa,
        };
        let mut state = PumpState::none(pressure_pa);
        if self.parts.pump {
            let need = self.pump.need_m3_s(pressure_pa) + shift_flow_m3_s;
            state = shaft.pump.state(pressure_pa, need);
            let by_model = state.torque_nm;
            state.torque_nm = self.loss_nm(Component::Pump, at, inside, || by_model);
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

    /// Computes the pressure that the circuit reaches of the one that the clamp law sets, Pa, with a flow into the pulleys; the clamp is fed before
    /// it, or not (PU-6, PU-7). A pump that is a measured map has no flow: it reaches any pressure. `above_pa` is the pressure of the line
    /// less that of the secondary, if they differ: less of the line leaves less for the secondary, and no less than none.
    pub fn circuit(
        &self,
        set_pa: R,
        above_pa: Option<R>,
        pump: &TurningPump<R>,
        shift: ShiftNeed<R>,
    ) -> Circuit<R> {
        let Some(above_pa) = above_pa else {
            return self.line_circuit(set_pa, pump, shift);
        };
        let circuit = self.line_circuit(set_pa + above_pa, pump, shift);
        Circuit {
            pressure_pa: (circuit.limited)
                .select((circuit.pressure_pa - above_pa).max(0.0), set_pa),
            ..circuit
        }
    }

    /// The same for the pressure of the line.
    fn line_circuit(&self, set_pa: R, pump: &TurningPump<R>, shift: ShiftNeed<R>) -> Circuit<R> {
        let shift_flow_m3_s = shift.flow_m3_s;
        let searched = set_pa.splat_mask(shift.searched);
        let short = searched | !pump.surely_holds(set_pa, shift_flow_m3_s);
        let mut circuit = Circuit {
            pressure_pa: set_pa,
            limited: short,
            left_m3_s: shift_flow_m3_s,
        };
        if !short.any() {
            return circuit;
        }
        let before_m3_s = match shift.clamp_first {
            true => set_pa.splat(0.0),
            false => shift_flow_m3_s,
        };
        let most_pa = pump.deliverable_pa(before_m3_s);
        circuit.limited = set_pa.gt(most_pa);
        if !self.cvt.has_map(Component::Pump) {
            circuit.pressure_pa = circuit.limited.select(most_pa, set_pa);
            let left_m3_s = pump.left_m3_s(circuit.pressure_pa); // PU-7
            circuit.left_m3_s = short.select(left_m3_s, shift_flow_m3_s);
        }
        circuit
    }

    /// Oil flow of the pump with the engine at a speed, at a pressure and a flow into the pulleys, m3/s.
    pub fn oil_flow_m3_s(&self, engine_rad_s: R, pressure_pa: R, shift_flow_m3_s: R) -> R {
        if !self.parts.pump {
            return pressure_pa.splat(0.0);
        }
        let need = self.pump.need_m3_s(pressure_pa) + shift_flow_m3_s;
        let pump = self.turning_pump(engine_rad_s);
        pump.state(pressure_pa, need).working_m3_s
    }

    /// Signals of the clamp law.
    pub fn signals(&self, throttle: R, engine_rad_s: R) -> ClampSignals<R> {
        ClampSignals {
            throttle,
            engine_rad_s,
            oil_k: self.oil_k,
            radius_factor: self.radius_factor,
            force_log: self.force_log,
        }
    }
}
