//! One operating point of a CVT on the bench: a fixed point in slip, pressure and belt temperature (RB-1, RB-2).

use super::point::{BenchAnswer, BenchPoint, belt_nm};
use crate::drive::Car;
use crate::flags::Flags;
use crate::lubricant::VALID_K;
use crate::transmission::component::ByComponent;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::controller::ClampLaw;
use crate::transmission::cvt::driveline::{Clamp, Driveline, PartTorques, Shaft};
use crate::transmission::cvt::variator::point::{LIMIT_SLACK, PointStatus};
use crate::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltLosses, BeltState, Slip, belt_point, belt_state,
};

/// Largest number of passes of the fixed point; its contraction is below 0.2 in the shipped box, so far fewer are used.
const MAX_PASSES: u32 = 120;
/// Passes after which it goes on in half steps.
const DAMPED_FROM: u32 = 30;
/// It stops when slip and belt temperature (K) move less than this, and the pressure (Pa) 1e5 times as much.
const STILL: f64 = 1e-10;

/// Unknowns of the fixed point.
#[derive(Clone, Copy)]
struct Unknown {
    slip: f64,
    belt_k: f64,
    pressure_pa: f64,
}

impl Unknown {
    fn moved(&self, to: &Unknown) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= STILL;
        !(near(self.slip, to.slip)
            && near(self.belt_k, to.belt_k)
            && near(1e-5 * self.pressure_pa, 1e-5 * to.pressure_pa))
    }

    fn halfway(&self, to: &Unknown) -> Unknown {
        Unknown {
            slip: 0.5 * (self.slip + to.slip),
            belt_k: 0.5 * (self.belt_k + to.belt_k),
            pressure_pa: 0.5 * (self.pressure_pa + to.pressure_pa),
        }
    }
}

/// The belt in its printed form (PR-1 to PR-5) under the names of driving; slip and its losses are NaN where it has no active arc.
fn printed_state(belt: &Belt, at: &BeltAtRatio, load: &BeltLoad) -> BeltState {
    let segment_friction = belt.formulation.segment_friction(load.segment_friction);
    let p = belt_point(
        belt,
        at,
        &BeltLoad {
            segment_friction,
            ..*load
        },
    );
    let sum = |pair: [f64; 2]| pair[0] + pair[1];
    let [primary, secondary] = p.slip_m_s.map(|v| v / p.belt_speed_m_s);
    BeltState {
        input_torque_nm: p.input_torque_nm,
        tension: p.tension,
        slip: Slip {
            primary,
            secondary,
            gap: p.gap_slip_m_s / p.belt_speed_m_s,
            idle: p.idle_slip_m_s / p.belt_speed_m_s,
            primary_loss_nm: p.slip_loss_nm[0],
            secondary_loss_nm: p.slip_loss_nm[1],
            active_segments: p.active_segments,
            held: false,
        },
        band_nm: sum(p.band_loss_nm),
        film_nm: sum(p.film_loss_nm),
        losses: BeltLosses {
            slip_total: p.slip_total,
            band_nm: sum(p.band_loss_nm),
            film_nm: sum(p.film_loss_nm),
            joint_nm: sum(p.joint_loss_nm),
            pin_nm: sum(p.pin_loss_nm),
            slip_nm: sum(p.slip_loss_nm),
            wedge_nm: sum(p.wedge_loss_nm),
            penetration_nm: sum(p.penetration_loss_nm),
            capacity_nm: p.capacity_nm,
            holding_n: p.tension.primary_clamp_n,
            gross_slip: p.status != PointStatus::Ok,
        },
    }
}

/// Constants of the fixed point.
struct OnBench<'a> {
    car: &'a Car,
    point: &'a BenchPoint,
    line: Driveline<'a>,
    printed: bool,
    /// The belt at its temperature, where that is held.
    held: Option<BeltLoad>,
}

/// One pass with the result of the pass before.
struct Pass {
    next: Unknown,
    loss_nm: ByComponent<f64>,
    secondary_rad_s: f64,
    secondary_nm: f64,
    primary_ring_nm: f64,
    oil_flow_m3_s: f64,
    belt: Option<BeltState>,
    flow_limited: bool,
    inside_maps: bool,
}

/// The belt at a temperature, K, without torque and clamping force.
fn turning(car: &Car, cvt: &Cvt, at: &BeltAtRatio, point: &BenchPoint, belt_k: f64) -> BeltLoad {
    let (of_belt, speeds) = (
        (at.prepared.film_area_m2, at.geometry.primary_radius_m),
        (point.ratio, point.input_rad_s),
    );
    BeltLoad::turning_on(&cvt.belt, of_belt, &car.oil, belt_k, speeds)
}

/// Where a fixed point begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near {
    /// Slip that is expected.
    pub slip: f64,
    /// Pressure of a point near it, Pa.
    pub pressure_pa: f64,
}

/// Solves one operating point of a CVT, whose belt is at the ratio of the point.
pub(super) fn solve(
    car: &Car,
    (cvt, at): (&Cvt, &BeltAtRatio),
    point: &BenchPoint,
    printed: bool,
    near: Option<Near>,
) -> BenchAnswer {
    let turning = |belt_k| turning(car, cvt, at, point, belt_k);
    let this = OnBench {
        car,
        point,
        printed,
        line: Driveline::new(cvt, at, &car.oil, point.sump_k, point.parts),
        held: point.belt_k.map(turning),
    };
    let mut unknown = Unknown {
        slip: 0.0,
        belt_k: point.belt_k.unwrap_or(point.sump_k),
        pressure_pa: point.pressure_pa.unwrap_or(cvt.floors.control_pa),
    };
    if let Some(near) = near.filter(|near| near.slip.is_finite()) {
        unknown.slip = near.slip;
        unknown.pressure_pa = match cvt.clamp {
            // The map needs no belt, so its pressure is the exact one.
            ClampLaw::Map(_) => this.pressure_pa(&this.load(&unknown, 0.0, 0.0), 0.0),
            _ => point.pressure_pa.unwrap_or(near.pressure_pa),
        };
    }
    let mut count = 0;
    let pass = loop {
        let pass = this.pass(&unknown);
        count += 1;
        if !unknown.moved(&pass.next) || count >= MAX_PASSES {
            break pass;
        }
        unknown = if count > DAMPED_FROM {
            unknown.halfway(&pass.next)
        } else {
            pass.next
        };
    };
    this.answer(&unknown, &pass, count < MAX_PASSES)
}

impl OnBench<'_> {
    fn pass(&self, u: &Unknown) -> Pass {
        let (line, p, w) = (&self.line, self.point, self.point.input_rad_s);
        let (cvt, pa) = (line.cvt, u.pressure_pa);
        let mut inside_maps = true;
        let secondary_rad_s = w * (1.0 - u.slip) / p.ratio; // CV-1
        let output = p.output_nm / cvt.final_drive.ratio;
        let pressure_pa = if p.parts.pump { pa } else { 0.0 };
        let clamp = Clamp {
            pressure_pa: pa,
            secondary_n: cvt.secondary_clamp_n(pressure_pa, secondary_rad_s),
        };
        let mut torques = PartTorques::none(0.0);
        line.secondary(
            output,
            || line.final_drive(secondary_rad_s, output),
            (w, secondary_rad_s),
            &clamp,
            &mut inside_maps,
            &mut torques,
        );
        let secondary = torques.secondary;
        let load = self.load(u, secondary, clamp.secondary_n);
        let mut next = Unknown {
            slip: 0.0,
            belt_k: p.belt_k.unwrap_or(p.sump_k),
            pressure_pa: self.pressure_pa(&load, secondary_rad_s),
        };
        if !p.parts.belt {
            torques.final_drive = 0.0; // nothing behind the primary turns
        }
        let mut belt = None;
        let mut primary_n = clamp.secondary_n * line.at.thrust_ratio; // as with a belt without torque
        if p.parts.belt {
            torques.belt_map = line.belt_map_nm(secondary, w, pa, &mut inside_maps);
            let state = self.belt_state(&load);
            primary_n = state.losses.holding_n;
            if torques.belt_map.is_none() {
                torques.belt = state.losses;
                belt = Some(state);
            }
        }
        line.turn_primary(&mut torques, w, (&clamp, primary_n), &mut inside_maps);
        let shaft = line.engine_shaft(w);
        let line_pa = cvt.line_pa(pa, cvt.primary_pa(primary_n));
        let pump = line.turn_engine(&mut torques, &shaft, line_pa, 0.0, &mut inside_maps);
        let mut loss_nm = ByComponent::default();
        torques.for_each_loss(|component, shaft, torque_nm| {
            loss_nm[component] += match shaft {
                Shaft::Engine | Shaft::Primary => torque_nm,
                Shaft::Secondary | Shaft::Output => torque_nm * secondary_rad_s / w,
            };
        });
        if p.parts.belt {
            self.follow_belt(&mut next, &loss_nm, belt.as_ref());
        }
        Pass {
            next,
            loss_nm,
            secondary_rad_s,
            secondary_nm: secondary,
            primary_ring_nm: torques.ring[0],
            oil_flow_m3_s: pump.working_m3_s,
            belt,
            flow_limited: pump.flow_limited,
            inside_maps,
        }
    }

    fn belt_state(&self, load: &BeltLoad) -> BeltState {
        let belt = &self.line.cvt.belt;
        let state = if self.printed {
            printed_state(belt, self.line.at, load)
        } else {
            belt_state(belt, self.line.at, load)
        };
        match self.line.changes {
            Some(changes) => state.times(&changes.factor, load.output_torque_nm, self.point.ratio),
            None => state,
        }
    }

    /// Slip of the belt, and the belt temperature that its losses keep up (RB-2).
    fn follow_belt(
        &self,
        next: &mut Unknown,
        loss_nm: &ByComponent<f64>,
        belt: Option<&BeltState>,
    ) {
        let p = self.point;
        // Where a printed form has no meaning, it must not carry speeds and belt temperature away with it.
        let valid = !(self.printed && belt.is_some_and(|state| state.losses.gross_slip));
        if let Some(state) = belt {
            next.slip = if valid { state.losses.slip_total } else { 0.0 };
        }
        if p.belt_k.is_none() {
            let belt_w = belt_nm(loss_nm) * p.input_rad_s;
            let rise_k =
                self.car.belt_heat_share * belt_w / self.car.network.spray_now_w_k(p.input_rad_s); // RB-2
            next.belt_k = p.sump_k + if valid { rise_k } else { 0.0 };
        }
    }

    fn load(&self, u: &Unknown, output_torque_nm: f64, secondary_clamp_n: f64) -> BeltLoad {
        let (cvt, p) = (self.line.cvt, self.point);
        let turning = || turning(self.car, cvt, self.line.at, p, u.belt_k);
        BeltLoad {
            output_torque_nm,
            secondary_clamp_n,
            ..self.held.unwrap_or_else(turning)
        }
    }

    /// Pressure given, or the clamp law's for this box.
    fn pressure_pa(&self, load: &BeltLoad, secondary_rad_s: f64) -> f64 {
        let (line, p) = (&self.line, self.point);
        p.pressure_pa.unwrap_or_else(|| {
            let signals = line.signals(p.throttle, p.input_rad_s);
            let demand = line
                .cvt
                .pressure_pa(&signals, line.at, || *load, secondary_rad_s);
            p.pressure_factor * demand.0
        })
    }

    fn answer(&self, u: &Unknown, pass: &Pass, converged: bool) -> BenchAnswer {
        let (cvt, p) = (self.line.cvt, self.point);
        let through = if p.parts.belt {
            p.output_nm / cvt.final_drive.ratio * pass.secondary_rad_s / p.input_rad_s
        } else {
            0.0
        };
        // A belt that slips by all of its speed or more leaves the secondary shaft at rest or turning backward: there is no such point.
        let turns = !p.parts.belt || pass.secondary_rad_s > 0.0;
        let loss_nm = pass.loss_nm.map(|nm| if turns { nm } else { f64::NAN });
        let input_nm = through + loss_nm.iter().sum::<f64>(); // RB-1
        let limits = cvt.ratio.high * (1.0 - LIMIT_SLACK)..=cvt.ratio.low * (1.0 + LIMIT_SLACK);
        let valid = VALID_K.contains(&p.sump_k)
            && VALID_K.contains(&u.belt_k)
            && pass.inside_maps
            && limits.contains(&p.ratio);
        let belt = pass.belt;
        let low_clamp = belt.is_some_and(|b| b.losses.capacity_nm < pass.secondary_nm.abs());
        let mut flags = Flags::default();
        let slips = belt.is_some_and(|b| b.losses.gross_slip);
        flags.set(Flags::NOT_CONVERGED, !converged || !turns);
        flags.set(Flags::GROSS_SLIP, slips || !turns);
        flags.set(Flags::LOW_CLAMP, low_clamp);
        flags.set(Flags::FLOW_LIMITED, pass.flow_limited);
        flags.set(Flags::OVERRUN, input_nm < 0.0);
        flags.set(Flags::OUTSIDE_VALIDITY, !valid);
        let with = |part: bool, value: f64, without: f64| if part { value } else { without };
        BenchAnswer {
            point: *p,
            loss_nm,
            primary_ring_nm: pass.primary_ring_nm,
            input_nm,
            output_rad_s: with(
                p.parts.belt,
                pass.secondary_rad_s / cvt.final_drive.ratio,
                0.0,
            ),
            secondary_pa: with(p.parts.pump, u.pressure_pa, f64::NAN),
            belt_k: with(p.parts.belt, u.belt_k, f64::NAN),
            belt,
            oil_flow_m3_s: pass.oil_flow_m3_s,
            flags,
        }
    }
}
