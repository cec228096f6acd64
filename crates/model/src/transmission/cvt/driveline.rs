//! The assembly of the CVT: which part turns with which shaft, what torque it takes, and what it loses. Driving and bench share it.

use super::controller::ClampSignals;
use super::pump::{PumpAtTemperature, PumpState};
use super::variator::{BeltAtRatio, BeltLosses};
use super::{Cvt, CvtMaps, viscosity_power};
use crate::fluid::Lubricant;
use crate::maps::MapPoint;
use crate::math::exp;
use crate::transmission::component::Component;

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
}

impl Parts {
    /// The complete box.
    pub const ALL: Parts = Parts {
        final_drive: true,
        belt: true,
        reverse_clutch: true,
        pump: true,
    };
}

/// Shaft on which a loss torque acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shaft {
    Engine,
    Primary,
    Secondary,
}

/// Powers of viscosity in the drags of the shafts, (nu/nu_80)^m with the exponent of each.
#[derive(Clone, Copy)]
pub(crate) struct ViscosityPowers {
    pub shaft: f64,
    pub clutch: f64,
    pub final_drive: f64,
}

impl ViscosityPowers {
    /// The powers at a viscosity.
    pub fn new(cvt: &Cvt, nu_m2_s: f64) -> Self {
        ViscosityPowers {
            shaft: viscosity_power(nu_m2_s, cvt.shaft_drag.exponent),
            clutch: viscosity_power(nu_m2_s, cvt.clutch_drag.exponent),
            final_drive: viscosity_power(nu_m2_s, cvt.final_drive.exponent),
        }
    }

    /// Their logarithms, from ln(nu/nu_80).
    #[inline]
    pub fn exponents(cvt: &Cvt, log_nu: f64) -> [f64; 3] {
        [
            cvt.shaft_drag.exponent,
            cvt.clutch_drag.exponent,
            cvt.final_drive.exponent,
        ]
        .map(|exponent| exponent * log_nu)
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
    /// Leakage of the oil circuit, m3/(s Pa).
    pub leakage_m3_s_pa: f64,
    /// Factor of the clamp map at the ratio (PC-1).
    pub radius_factor: f64,
    /// Transmission oil, K.
    pub oil_k: f64,
    /// Measured maps, if there are any.
    pub maps: Option<&'a CvtMaps>,
}

/// Torques of all parts at one operating point, Nm, each at its own shaft.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PartTorques {
    /// Behind the final drive, referred to the secondary.
    pub output: f64,
    /// At the secondary pulley.
    pub secondary: f64,
    /// Belt, by part.
    pub belt: BeltLosses,
    /// Belt, where a map replaces its parts.
    pub belt_map: Option<f64>,
    pub clutch: f64,
    pub pump: f64,
    pub shaft: f64,
}

impl PartTorques {
    /// Parts that turn with the primary, the belt apart, Nm at the primary.
    #[inline]
    pub fn primary_nm(&self) -> f64 {
        self.clutch
    }

    /// Parts that turn with the engine, Nm at the flywheel.
    #[inline]
    pub fn engine_nm(&self) -> f64 {
        self.pump + self.shaft
    }

    /// Torque at the flywheel with that of the coupling, Nm.
    pub fn flywheel_nm(&self, coupling_nm: f64) -> f64 {
        coupling_nm + self.pump + self.shaft
    }

    /// Gives every loss torque with its component and shaft.
    #[inline(always)]
    pub fn for_each_loss(&self, mut give: impl FnMut(Component, Shaft, f64)) {
        match self.belt_map {
            Some(loss) => give(Component::BeltMap, Shaft::Primary, loss),
            None => {
                let belt = &self.belt;
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
        give(
            Component::FinalDrive,
            Shaft::Secondary,
            self.secondary - self.output,
        );
        give(Component::ClutchDrag, Shaft::Primary, self.clutch);
        give(Component::Pump, Shaft::Engine, self.pump);
        give(Component::InputShaft, Shaft::Engine, self.shaft);
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
        let eta_pa_s = oil.dynamic_pa_s(oil_k);
        Driveline {
            cvt,
            at,
            parts,
            viscosity: ViscosityPowers::new(cvt, oil.kinematic_m2_s(oil_k)),
            pump: cvt.pump.at(eta_pa_s),
            leakage_m3_s_pa: cvt.pump.leakage_now_m3_s_pa(eta_pa_s),
            radius_factor: cvt.radius_factor(at),
            oil_k,
            maps: cvt.maps.as_deref(),
        }
    }

    /// Loss that a component's map gives at a speed, torque and pressure, Nm; clears `inside` outside the map.
    fn mapped(
        &self,
        component: Component,
        (speed_rad_s, torque_nm, pressure_pa): (f64, f64, f64),
        inside: &mut bool,
    ) -> Option<f64> {
        let map = self.maps?[component].as_ref()?;
        let (loss, within) = map.loss_nm(&MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: speed_rad_s,
            torque_nm,
            pressure_pa,
            oil_k: self.oil_k,
        });
        *inside &= within;
        Some(loss)
    }

    /// Load-independent torque of the final drive at the secondary shaft, Nm (FD-1).
    pub fn final_drive_nm(&self, secondary_rad_s: f64) -> f64 {
        let drive = &self.cvt.final_drive;
        let fall = exp(drive.fall_exponent(secondary_rad_s));
        drive.drag_nm(self.viscosity.final_drive, fall, secondary_rad_s)
    }

    /// Torque at the secondary pulley for a torque behind the final drive, `drive_nm` its load-independent loss, Nm.
    #[inline]
    pub fn secondary_nm(
        &self,
        output_nm: f64,
        drive_nm: impl FnOnce() -> f64,
        (primary_rad_s, secondary_rad_s): (f64, f64),
        pressure_pa: f64,
        inside: &mut bool,
    ) -> f64 {
        if !self.parts.final_drive {
            return output_nm;
        }
        let at = (primary_rad_s, output_nm, pressure_pa);
        match self.mapped(Component::FinalDrive, at, inside) {
            Some(loss) => output_nm + loss * primary_rad_s / secondary_rad_s,
            None => self
                .cvt
                .final_drive
                .secondary_torque_nm(drive_nm(), output_nm),
        }
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
        let at = (primary_rad_s, secondary_nm, pressure_pa);
        self.mapped(Component::BeltMap, at, inside)
    }

    /// Sets the torques of the parts that turn with the primary, the belt apart, at its speed and a pressure.
    #[inline]
    pub fn turn_primary(
        &self,
        torques: &mut PartTorques,
        primary_rad_s: f64,
        pressure_pa: f64,
        inside: &mut bool,
    ) {
        if self.parts.reverse_clutch {
            let at = (primary_rad_s, 0.0, pressure_pa);
            let mapped = self.mapped(Component::ClutchDrag, at, inside);
            torques.clutch =
                mapped.unwrap_or_else(|| self.cvt.clutch_drag.torque_nm(self.viscosity.clutch));
        }
    }

    /// Sets the torques of the parts that turn with the engine, at its speed, a pressure and a flow into the pulleys; the pump's state.
    #[inline(always)]
    pub fn turn_engine(
        &self,
        torques: &mut PartTorques,
        engine_rad_s: f64,
        pressure_pa: f64,
        shift_flow_m3_s: f64,
        inside: &mut bool,
    ) -> PumpState {
        let at = (engine_rad_s, 0.0, pressure_pa);
        let mut state = PumpState::default();
        if self.parts.pump {
            let pump = &self.cvt.pump;
            let need = pump.need_m3_s(pressure_pa, self.leakage_m3_s_pa) + shift_flow_m3_s;
            state = pump.state(&self.pump, engine_rad_s, pressure_pa, need);
            if let Some(loss) = self.mapped(Component::Pump, at, inside) {
                state.torque_nm = loss;
            }
        }
        torques.pump = state.torque_nm;
        torques.shaft = self
            .mapped(Component::InputShaft, at, inside)
            .unwrap_or_else(|| {
                self.cvt
                    .shaft_drag
                    .torque_nm(self.viscosity.shaft, engine_rad_s)
            });
        state
    }

    /// Signals of the clamp law.
    #[inline]
    pub fn signals(&self, throttle: f64, engine_rad_s: f64) -> ClampSignals {
        ClampSignals {
            throttle,
            engine_rad_s,
            oil_k: self.oil_k,
            radius_factor: self.radius_factor,
        }
    }
}
