//! One evaluation of the driveline: torques that follow from a guess of the unknowns, and what follows from those torques.
//!
//! An evaluation takes slip in at once: the belt is worked out at the speed of a guessed slip, which it feels through centrifugal
//! force only, and everything behind it at the speed of the slip that comes out. At the wheels' demand it takes in the engine's speed
//! at once too.

use super::controller::ClampSignals;
use super::pump::{PumpNow, PumpState};
use super::spin::SpinNow;
use super::variator::{BeltAtRatio, BeltLoad, BeltLosses, belt_losses};
use super::{Cvt, CvtMaps};
use crate::math::{held, ramp};
use crate::thermal::SUMP;
use crate::transmission::Surroundings;
use crate::transmission::loss_map::{LossMap, MapPoint};

/// Everything of a step that does not change during the solve.
pub(super) struct Step<'a> {
    pub cvt: &'a Cvt,
    pub around: &'a Surroundings<'a>,
    pub at: &'a BeltAtRatio,
    pub secondary_rad_s: f64,
    pub spin: SpinNow,
    pub drive_nm: f64,
    pub pump: PumpNow,
    pub leakage_m3_s_pa: f64,
    pub load: BeltLoad,
    pub radius_factor: f64,
    pub shift_flow_m3_s: f64,
    /// Whether pump flow held the shift back.
    pub shift_held: bool,
    /// Engine speed before the step, and how far it can come within it, rad/s.
    pub engine_before: f64,
    pub pace_rad_s: f64,
    pub coupled: bool,
    /// Primary speed from which the launch device holds (LC-5); infinite while it has not locked yet.
    pub locked_from_rad_s: f64,
    /// Measured maps, if there are any.
    pub maps: Option<&'a CvtMaps>,
}

/// Unknowns of the solve.
#[derive(Clone, Copy, Default)]
pub(super) struct Guess {
    pub output_nm: f64,
    pub slip: f64,
    pub engine_rad_s: f64,
    pub pressure_pa: f64,
}

impl Guess {
    /// The middle between two guesses.
    pub(super) fn halfway(&self, other: &Guess) -> Guess {
        let mid = |a: f64, b: f64| 0.5 * (a + b);
        Guess {
            output_nm: mid(self.output_nm, other.output_nm),
            slip: mid(self.slip, other.slip),
            engine_rad_s: mid(self.engine_rad_s, other.engine_rad_s),
            pressure_pa: mid(self.pressure_pa, other.pressure_pa),
        }
    }
}

/// Torques of the parts at one evaluation, Nm.
struct PartTorques {
    secondary: f64,
    clutch: f64,
    /// Belt, if a map stands for it.
    belt_map: Option<f64>,
    inside_maps: bool,
}

/// One evaluation: torques that follow from a guess, and what engine speed and pressure follow from them.
#[derive(Default)]
pub(super) struct Point {
    /// The guess with slip and engine speed in force.
    pub guess: Guess,
    /// Slip for which the belt was worked out.
    pub slip_guessed: f64,
    pub next_engine_rad_s: f64,
    pub next_pressure_pa: f64,
    pub throttle: f64,
    /// Full load at the next engine speed, Nm.
    pub full_load_nm: f64,
    pub secondary_nm: f64,
    pub primary_rad_s: f64,
    pub primary_nm: f64,
    /// Primary torque above what the engine asks for where it binds, Nm.
    pub miss_nm: f64,
    pub flywheel_nm: f64,
    pub belt: BeltLosses,
    pub belt_map_nm: Option<f64>,
    pub clutch_nm: f64,
    pub pump_nm: f64,
    pub shaft_nm: f64,
    pub flow_limited: bool,
    pub oil_flow_m3_s: f64,
    pub inside_maps: bool,
    /// Whether the launch device holds engine and primary together (LC-5).
    pub locked: bool,
}

impl Point {
    #[inline]
    pub(super) fn moved(&self) -> f64 {
        let g = &self.guess;
        let mut most = (g.pressure_pa / self.next_pressure_pa - 1.0).abs();
        let engine = if self.locked {
            0.0
        } else {
            (g.engine_rad_s / self.next_engine_rad_s - 1.0).abs()
        };
        for d in [(g.slip - self.slip_guessed).abs(), engine] {
            most = if d > most { d } else { most };
        }
        most
    }

    /// The guess that follows without a secant.
    pub(super) fn next(&self) -> Guess {
        Guess {
            engine_rad_s: self.next_engine_rad_s,
            pressure_pa: self.next_pressure_pa,
            ..self.guess
        }
    }
}

/// Clutch torque at the engine for a torque at the primary (CV-6): the same in drive; in overrun the power passes unchanged, since a
/// clutch whose engine is still running down from a higher speed can neither give nor take energy.
#[inline]
fn engine_side_nm(primary_nm: f64, primary_rad_s: f64, engine_rad_s: f64) -> f64 {
    if primary_nm < 0.0 {
        primary_nm * primary_rad_s / engine_rad_s
    } else {
        primary_nm
    }
}

/// Which condition fixes the output torque.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Bind {
    /// The wheels' demand.
    Demand,
    /// The least primary torque (CV-3).
    Least,
    /// Full load (CV-4).
    FullLoad,
}

impl Step<'_> {
    pub(super) fn mapped(
        &self,
        map: Option<&LossMap>,
        speed: f64,
        torque: f64,
        pa: f64,
        inside: &mut bool,
    ) -> Option<f64> {
        let map = map?;
        let (loss, ok) = map.loss_nm(&MapPoint {
            ratio: self.at.geometry.ratio,
            input_speed_rad_s: speed,
            torque_nm: torque,
            pressure_pa: pa,
            oil_k: self.around.heat.node_k[SUMP],
        });
        *inside &= ok;
        Some(loss)
    }

    /// Pump and input shaft at an engine speed and pressure: torques Nm by model or map, and the pump's flow.
    #[inline(always)]
    pub(super) fn pump_and_shaft(
        &self,
        engine_rad_s: f64,
        pa: f64,
        inside: &mut bool,
    ) -> (PumpState, f64) {
        let pump = &self.cvt.pump;
        let need = pump.need_m3_s(pa, self.leakage_m3_s_pa) + self.shift_flow_m3_s;
        let mut state = pump.state(&self.pump, engine_rad_s, pa, need);
        let mut shaft_nm = self.spin.shaft_nm(engine_rad_s);
        if let Some(maps) = self.maps {
            state.torque_nm = self
                .mapped(maps.pump.as_ref(), engine_rad_s, 0.0, pa, inside)
                .unwrap_or(state.torque_nm);
            shaft_nm = self
                .mapped(maps.input_shaft.as_ref(), engine_rad_s, 0.0, pa, inside)
                .unwrap_or(shaft_nm);
        }
        (state, shaft_nm)
    }

    /// Primary speed at a slip, rad/s (CV-1).
    #[inline]
    pub(super) fn primary_rad_s(&self, slip: f64) -> f64 {
        self.at.geometry.ratio * self.secondary_rad_s / (1.0 - slip) // CV-1
    }

    /// What final drive and clutch take, and the belt if a map stands for it.
    #[inline]
    fn part_torques(&self, g: &Guess, primary_rad_s: f64) -> PartTorques {
        let secondary = self
            .cvt
            .spin
            .secondary_torque_nm(self.drive_nm, g.output_nm);
        let models = PartTorques {
            secondary,
            clutch: self.spin.clutch_nm,
            belt_map: None,
            inside_maps: true,
        };
        match self.maps {
            None => models,
            Some(maps) => self.mapped_torques(maps, g, primary_rad_s, models),
        }
    }

    fn mapped_torques(
        &self,
        maps: &CvtMaps,
        g: &Guess,
        primary_rad_s: f64,
        models: PartTorques,
    ) -> PartTorques {
        let (pa, mut inside) = (g.pressure_pa, true);
        let secondary = self
            .mapped(
                maps.final_drive.as_ref(),
                primary_rad_s,
                g.output_nm,
                pa,
                &mut inside,
            )
            .map_or(models.secondary, |loss| {
                g.output_nm + loss * primary_rad_s / self.secondary_rad_s
            });
        let belt_map = self.mapped(
            maps.belt.as_ref(),
            primary_rad_s,
            secondary,
            pa,
            &mut inside,
        );
        let clutch = self
            .mapped(
                maps.clutch_drag.as_ref(),
                primary_rad_s,
                0.0,
                pa,
                &mut inside,
            )
            .unwrap_or(models.clutch);
        PartTorques {
            secondary,
            clutch,
            belt_map,
            inside_maps: inside,
        }
    }

    /// Works out a guess, in place: a point is large.
    ///
    /// Where the engine binds, pressure and engine speed follow from the torque that it asks for, not from the one that the guessed
    /// output torque gives: so the two unknowns do not disturb each other.
    pub(super) fn evaluate(&self, g: &Guess, bind: Bind, point: &mut Point) {
        let (cvt, engine, pa) = (self.cvt, self.around.engine, g.pressure_pa);
        let belt_rad_s = self.primary_rad_s(g.slip);
        let PartTorques {
            secondary: secondary_nm,
            clutch: clutch_nm,
            belt_map: belt_map_nm,
            mut inside_maps,
        } = self.part_torques(g, belt_rad_s);
        let load = || BeltLoad {
            primary_speed_rad_s: belt_rad_s,
            output_torque_nm: secondary_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(pa, self.secondary_rad_s),
            ..self.load
        };
        let belt = belt_losses(&cvt.belt, self.at, &load());
        let (slip, belt_nm) =
            belt_map_nm.map_or((belt.slip_total, belt.sum_nm()), |loss| (0.0, loss));
        let primary_rad_s = self.primary_rad_s(slip);
        let locked = self.locked(primary_rad_s);
        // VA-1 with the slip in force, so that the power balance holds for this iterate exactly.
        let primary_nm =
            secondary_nm * ((1.0 - slip) * self.at.prepared.per_ratio) + belt_nm + clutch_nm;
        // Never slower than the primary, and the same while locked, so that the clutch cannot give energy back.
        let engine_rad_s = if locked {
            primary_rad_s
        } else if bind == Bind::Demand {
            self.free_engine_rad_s(primary_nm, primary_rad_s) // at once: nothing before it feels the engine's speed
        } else if g.engine_rad_s > primary_rad_s {
            g.engine_rad_s
        } else {
            primary_rad_s
        };
        let (pump, shaft_nm) = self.pump_and_shaft(engine_rad_s, pa, &mut inside_maps);
        let spin_nm = pump.torque_nm + shaft_nm;
        let flywheel_nm =
            |primary_nm: f64| engine_side_nm(primary_nm, primary_rad_s, engine_rad_s) + spin_nm; // CV-2, CV-6
        let asked_nm = match bind {
            Bind::Demand => primary_nm,
            Bind::Least => self.least_primary_nm(primary_rad_s, engine_rad_s, spin_nm),
            Bind::FullLoad => self.most_primary_nm(engine_rad_s, spin_nm),
        };
        let next_engine_rad_s = if locked || bind == Bind::Demand {
            engine_rad_s
        } else {
            self.free_engine_rad_s(asked_nm, primary_rad_s)
        };
        let crank_nm = flywheel_nm(asked_nm) + engine.accessories_nm(next_engine_rad_s);
        let full_load_nm = engine.full_load_nm(next_engine_rad_s);
        let throttle = held(crank_nm / full_load_nm, 0.0, 1.0);
        let signals = self.signals(throttle, next_engine_rad_s);
        *point = Point {
            guess: Guess {
                engine_rad_s,
                slip,
                ..*g
            },
            slip_guessed: g.slip,
            next_engine_rad_s,
            next_pressure_pa: cvt.pressure_pa(&signals, self.at, load, self.secondary_rad_s),
            throttle,
            full_load_nm,
            secondary_nm,
            primary_rad_s,
            primary_nm,
            miss_nm: primary_nm - asked_nm,
            flywheel_nm: flywheel_nm(primary_nm),
            belt,
            belt_map_nm,
            clutch_nm,
            pump_nm: pump.torque_nm,
            shaft_nm,
            flow_limited: pump.flow_limited,
            oil_flow_m3_s: pump.working_m3_s,
            inside_maps,
            locked,
        };
    }

    /// Whether the launch device holds engine and primary together (LC-5).
    #[inline]
    pub(super) fn locked(&self, primary_rad_s: f64) -> bool {
        primary_rad_s >= self.locked_from_rad_s
    }

    /// Engine speed over a slipping launch device, within what the engine's inertia lets it reach.
    fn free_engine_rad_s(&self, primary_nm: f64, primary_rad_s: f64) -> f64 {
        let wanted = self.cvt.launch.engine_speed_rad_s(
            primary_nm,
            primary_rad_s,
            self.around.engine.idle_rad_s,
            self.coupled,
        );
        let limited = held(
            wanted,
            self.engine_before - self.pace_rad_s,
            self.engine_before + self.pace_rad_s,
        );
        if limited > primary_rad_s {
            limited
        } else {
            primary_rad_s
        }
    }

    /// Least primary torque that the engine and the launch device leave to the belt, Nm, with pump and shaft taking `spin_nm` (CV-3).
    pub(super) fn least_primary_nm(
        &self,
        primary_rad_s: f64,
        engine_rad_s: f64,
        spin_nm: f64,
    ) -> f64 {
        let engine = self.around.engine;
        let idle = engine.idle_rad_s;
        if primary_rad_s < idle {
            return self.cvt.launch.creep_torque_nm(primary_rad_s, idle);
        }
        // A slipping clutch whose engine is faster cannot take torque from the belt; faded in, so that the solve sees no step.
        let together = 1.0 - ramp(engine_rad_s / primary_rad_s, 1.0, 1.02);
        let share = self.cvt.launch.overrun_share(primary_rad_s, idle);
        -together
            * share
            * (engine.drag_nm(engine_rad_s) + engine.accessories_nm(engine_rad_s) + spin_nm)
    }

    pub(super) fn most_primary_nm(&self, engine_rad_s: f64, spin_nm: f64) -> f64 {
        let engine = self.around.engine;
        engine.full_load_nm(engine_rad_s) - engine.accessories_nm(engine_rad_s) - spin_nm
    }

    pub(super) fn signals(&self, throttle: f64, engine_rad_s: f64) -> ClampSignals {
        ClampSignals {
            throttle,
            engine_rad_s,
            oil_k: self.around.heat.node_k[SUMP],
            radius_factor: self.radius_factor,
        }
    }
}
