//! One operating point of a CVT on the bench: a fixed point in slip, pressure and belt temperature (RB-1, RB-2).

use super::bench::{BELT_PARTS, BenchAnswer, BenchPoint};
use crate::drive::Car;
use crate::drive::{Component, Flags};
use crate::fluid::VALID_K;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::controller::ClampSignals;
use crate::transmission::cvt::pump::PumpNow;
use crate::transmission::cvt::spin::SpinNow;
use crate::transmission::cvt::variator::point::LIMIT_SLACK;
use crate::transmission::cvt::variator::point::PointStatus;
use crate::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, BeltState, Slip, belt_point, belt_state, sliding_speed_m_s,
};
use crate::transmission::loss_map::{LossMap, MapPoint};

/// Most passes of the fixed point; its contraction is below 0.2 in the shipped box, so far fewer are used.
const MOST_PASSES: u32 = 120;
/// Passes after which it goes on in half steps.
const DAMPED_FROM: u32 = 30;
/// It stops when slip and belt temperature (K) move less than this, and the pressure (Pa) 1e5 times as much.
const STILL: f64 = 1e-10;

/// What the fixed point looks for.
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
        slip_total: p.slip_total,
        band_nm: sum(p.band_loss_nm),
        film_nm: sum(p.film_loss_nm),
        slip_nm: sum(p.slip_loss_nm),
        wedge_nm: sum(p.wedge_loss_nm),
        penetration_nm: sum(p.penetration_loss_nm),
        capacity_nm: p.capacity_nm,
        gross_slip: p.status != PointStatus::Ok,
    }
}

/// What does not change during the fixed point.
struct OnBench<'a> {
    car: &'a Car,
    cvt: &'a Cvt,
    point: &'a BenchPoint,
    at: BeltAtRatio,
    spin: SpinNow,
    pump: PumpNow,
    eta_sump: f64,
    printed: bool,
}

/// One pass with what the pass before left.
struct Pass {
    next: Unknown,
    loss_nm: [f64; Component::COUNT],
    secondary_rad_s: f64,
    secondary_nm: f64,
    oil_flow_m3_s: f64,
    belt: Option<BeltState>,
    flow_limited: bool,
    inside_maps: bool,
}

/// Solves one operating point of a CVT.
pub(super) fn solve(car: &Car, cvt: &Cvt, point: &BenchPoint, printed: bool) -> BenchAnswer {
    let eta_sump = car.oil.dynamic_pa_s(point.sump_k);
    let this = OnBench {
        car,
        cvt,
        point,
        printed,
        at: BeltAtRatio::new(&cvt.belt, point.ratio),
        spin: cvt.spin.at(car.oil.kinematic_m2_s(point.sump_k)),
        pump: cvt.pump.at(eta_sump),
        eta_sump,
    };
    let mut unknown = Unknown {
        slip: 0.0,
        belt_k: point.belt_k.unwrap_or(point.sump_k),
        pressure_pa: point.pressure_pa.unwrap_or(cvt.floor_pa),
    };
    let mut count = 0;
    let pass = loop {
        let pass = this.pass(&unknown);
        count += 1;
        if !unknown.moved(&pass.next) || count >= MOST_PASSES {
            break pass;
        }
        unknown = if count > DAMPED_FROM {
            unknown.halfway(&pass.next)
        } else {
            pass.next
        };
    };
    this.answer(&unknown, &pass, count < MOST_PASSES)
}

impl OnBench<'_> {
    /// Loss that a measured map gives at the input shaft, Nm, if there is one.
    fn mapped(
        &self,
        map: Option<&LossMap>,
        torque_nm: f64,
        pressure_pa: f64,
        inside: &mut bool,
    ) -> Option<f64> {
        let p = self.point;
        let (loss, ok) = map?.loss_nm(&MapPoint {
            ratio: p.ratio,
            input_speed_rad_s: p.input_rad_s,
            torque_nm,
            pressure_pa,
            oil_k: p.sump_k,
        });
        *inside &= ok;
        Some(loss)
    }

    fn pass(&self, u: &Unknown) -> Pass {
        let (cvt, p, w) = (self.cvt, self.point, self.point.input_rad_s);
        let mut inside_maps = true;
        let secondary_rad_s = w * (1.0 - u.slip) / p.ratio; // CV-1
        let output_nm = p.output_nm / cvt.final_drive;
        let secondary_nm = if !p.parts.final_drive {
            output_nm
        } else if let Some(loss) = self.mapped(
            cvt.maps.final_drive.as_ref(),
            output_nm,
            u.pressure_pa,
            &mut inside_maps,
        ) {
            output_nm + loss * w / secondary_rad_s
        } else {
            cvt.spin
                .secondary_torque_nm(cvt.spin.drive_nm(&self.spin, secondary_rad_s), output_nm)
        };
        let load = self.load(u, secondary_nm, secondary_rad_s);
        let held_k = p.belt_k.unwrap_or(p.sump_k);
        let mut pass = Pass {
            next: Unknown {
                slip: 0.0,
                belt_k: held_k,
                pressure_pa: self.pressure_pa(&load, secondary_rad_s),
            },
            loss_nm: [0.0; Component::COUNT],
            secondary_rad_s,
            secondary_nm,
            oil_flow_m3_s: 0.0,
            belt: None,
            flow_limited: false,
            inside_maps,
        };
        if p.parts.belt {
            pass.loss_nm[Component::FinalDrive as usize] =
                (secondary_nm - output_nm) * secondary_rad_s / w;
            self.belt(&mut pass, &load, u);
        }
        self.engine_side(&mut pass, u);
        pass
    }

    /// Belt losses, and the belt temperature that they keep up (RB-2).
    fn belt(&self, pass: &mut Pass, load: &BeltLoad, u: &Unknown) {
        let (cvt, p) = (self.cvt, self.point);
        let mut tells = true;
        let state = if self.printed {
            printed_state(&cvt.belt, &self.at, load)
        } else {
            belt_state(&cvt.belt, &self.at, load)
        };
        if let Some(loss) = self.mapped(
            cvt.maps.belt.as_ref(),
            load.output_torque_nm,
            u.pressure_pa,
            &mut pass.inside_maps,
        ) {
            pass.loss_nm[Component::BeltMap as usize] = loss;
        } else {
            // Where a printed form has no meaning, it must not carry speeds and belt temperature away with it.
            tells = !(self.printed && state.gross_slip);
            pass.next.slip = if tells { state.slip_total } else { 0.0 };
            pass.loss_nm[Component::BeltBand as usize] = state.band_nm;
            pass.loss_nm[Component::BeltFilm as usize] = state.film_nm;
            pass.loss_nm[Component::BeltSlip as usize] = state.slip_nm;
            pass.loss_nm[Component::BeltWedge as usize] = state.wedge_nm;
            pass.loss_nm[Component::BeltPenetration as usize] = state.penetration_nm;
            pass.belt = Some(state);
        }
        if p.belt_k.is_none() {
            let belt_w = BELT_PARTS
                .iter()
                .map(|c| pass.loss_nm[*c as usize])
                .sum::<f64>()
                * p.input_rad_s;
            let rise_k =
                self.car.belt_heat_share * belt_w / self.car.network.spray_now_w_k(p.input_rad_s); // RB-2
            pass.next.belt_k = p.sump_k + if tells { rise_k } else { 0.0 };
        }
    }

    /// Losses of the parts that turn with the input shaft.
    fn engine_side(&self, pass: &mut Pass, u: &Unknown) {
        let (cvt, p, w) = (self.cvt, self.point, self.point.input_rad_s);
        let maps = &cvt.maps;
        if p.parts.reverse_clutch {
            let mapped = self.mapped(
                maps.clutch_drag.as_ref(),
                0.0,
                u.pressure_pa,
                &mut pass.inside_maps,
            );
            pass.loss_nm[Component::ClutchDrag as usize] = mapped.unwrap_or(self.spin.clutch_nm);
        }
        if p.parts.pump {
            let need = cvt.pump.steady_need_m3_s(u.pressure_pa, self.eta_sump);
            let pump = cvt.pump.state(&self.pump, w, u.pressure_pa, need);
            let mapped = self.mapped(
                maps.pump.as_ref(),
                0.0,
                u.pressure_pa,
                &mut pass.inside_maps,
            );
            pass.loss_nm[Component::Pump as usize] = mapped.unwrap_or(pump.torque_nm);
            pass.oil_flow_m3_s = pump.working_m3_s;
            pass.flow_limited = pump.flow_limited;
        }
        let mapped = self.mapped(
            maps.input_shaft.as_ref(),
            0.0,
            u.pressure_pa,
            &mut pass.inside_maps,
        );
        pass.loss_nm[Component::InputShaft as usize] =
            mapped.unwrap_or_else(|| self.spin.shaft_nm(w));
    }

    fn load(&self, u: &Unknown, output_torque_nm: f64, secondary_rad_s: f64) -> BeltLoad {
        let (cvt, p, oil) = (self.cvt, self.point, &self.car.oil);
        let eta_pa_s = oil.dynamic_pa_s(u.belt_k);
        let film = cvt.belt.formulation.has_film();
        let sliding = if film {
            sliding_speed_m_s(&cvt.belt, p.ratio, p.input_rad_s)
        } else {
            0.0
        };
        BeltLoad {
            primary_speed_rad_s: p.input_rad_s,
            output_torque_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(
                if p.parts.pump { u.pressure_pa } else { 0.0 },
                secondary_rad_s,
            ),
            band: oil.friction.band(u.belt_k, eta_pa_s, sliding),
            eta_pa_s,
            film_thickness_m: oil.friction.film_thickness_m,
            segment_friction: oil.friction.segment,
            flank_friction: oil.friction.flank,
        }
    }

    /// Pressure given, or the clamp law's for this box.
    fn pressure_pa(&self, load: &BeltLoad, secondary_rad_s: f64) -> f64 {
        let p = self.point;
        let signals = ClampSignals {
            throttle: p.throttle,
            engine_rad_s: p.input_rad_s,
            oil_k: p.sump_k,
            radius_factor: self.cvt.radius_factor(&self.at),
        };
        p.pressure_pa.unwrap_or_else(|| {
            p.pressure_factor
                * self
                    .cvt
                    .pressure_pa(&signals, &self.at, || *load, secondary_rad_s)
        })
    }

    fn answer(&self, u: &Unknown, pass: &Pass, converged: bool) -> BenchAnswer {
        let (cvt, p) = (self.cvt, self.point);
        let through = if p.parts.belt {
            p.output_nm / cvt.final_drive * pass.secondary_rad_s / p.input_rad_s
        } else {
            0.0
        };
        let input_nm = through + pass.loss_nm.iter().sum::<f64>(); // RB-1
        let limits = cvt.ratio.high * (1.0 - LIMIT_SLACK)..=cvt.ratio.low * (1.0 + LIMIT_SLACK);
        let valid = VALID_K.contains(&p.sump_k)
            && VALID_K.contains(&u.belt_k)
            && pass.inside_maps
            && limits.contains(&p.ratio);
        let mut flags = Flags::default();
        flags.set(Flags::NOT_CONVERGED, !converged);
        flags.set(Flags::GROSS_SLIP, pass.belt.is_some_and(|b| b.gross_slip));
        flags.set(
            Flags::LOW_CLAMP,
            pass.belt
                .is_some_and(|b| b.capacity_nm < pass.secondary_nm.abs()),
        );
        flags.set(Flags::FLOW_LIMITED, pass.flow_limited);
        flags.set(Flags::OVERRUN, input_nm < 0.0);
        flags.set(Flags::OUTSIDE_VALIDITY, !valid);
        BenchAnswer {
            loss_nm: pass.loss_nm,
            input_nm,
            output_rad_s: if p.parts.belt {
                pass.secondary_rad_s / cvt.final_drive
            } else {
                0.0
            },
            secondary_pa: if p.parts.pump {
                u.pressure_pa
            } else {
                f64::NAN
            },
            belt_k: if p.parts.belt { u.belt_k } else { f64::NAN },
            belt: pass.belt,
            oil_flow_m3_s: pass.oil_flow_m3_s,
            flags,
        }
    }
}
