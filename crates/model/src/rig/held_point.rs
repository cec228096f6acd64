//! A transmission on a motor bench: what each part loses at one operating point.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RB-1 | T_in = T_p + T_pump + T_shaft, T_p = T_sec w_s/w_in + belt + drag + bearing + rings, T_sec from T_out by FD-1, FD-2 and the secondary's bearing and rings; clutch locked, w_p = w_in | derived: CV-1, CV-2 read from the motor's side |
//! | RB-2 | belt and spray in steady state: T_belt = T_sump + share P_belt / G_spray | derived: heat balance of the belt node (TH-1) |
//! | RB-3 | manual box: T_in = T_out/i + mesh + seal + bearing + churning | derived: MB-1 |
//!
//! The part models are those of driving; nothing is computed twice. Losses are torques at the input shaft. The pressure is the clamp
//! law's at the bench's throttle, times a factor for another box, or given.

use super::cvt_bench::{self, Near};
use super::point::{BenchAnswer, BenchPoint};
use crate::drive::{Car, Vehicle};
use crate::flags::Flags;
use crate::lubricant::VALID_K;
use crate::transmission::Transmission;
use crate::transmission::component::ByComponent;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::variator::{BeltAtRatio, Formulation};
use crate::transmission::manual::Manual;

/// A transmission on the bench.
///
/// ```
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::rig::{Bench, BenchPoint};
///
/// let car = load("rover_216_cvt", &Options::default()).expect("a shipped car");
/// let cold = BenchPoint { ratio: 0.5, sump_k: 298.15, ..BenchPoint::default() };
/// let warm = BenchPoint { sump_k: 353.15, ..cold };
/// let bench = Bench::new(&car);
/// assert!(bench.solve(&cold).total_nm() > bench.solve(&warm).total_nm());
/// ```
#[derive(Clone, Debug)]
pub struct Bench {
    car: Car,
    printed: bool,
}

impl Bench {
    /// Puts a vehicle's transmission on the bench.
    pub fn new(vehicle: &Vehicle) -> Self {
        Bench {
            car: vehicle.car(crate::road::REFERENCE_K),
            printed: false,
        }
    }

    /// The same with the belt as printed (PR-1 to PR-5) where the formulation is one of the thesis's two: whole active segments, no
    /// blending, no bound of slip. Not defined at a ratio of exactly 1.
    pub fn as_printed(vehicle: &Vehicle) -> Self {
        let bench = Bench::new(vehicle);
        let printed = bench
            .cvt()
            .is_some_and(|cvt| cvt.belt.formulation != Formulation::Smooth);
        Bench { printed, ..bench }
    }

    /// The vehicle whose transmission is on the bench.
    pub fn car(&self) -> &Car {
        &self.car
    }

    /// The CVT, if it is one.
    pub fn cvt(&self) -> Option<&Cvt> {
        match &self.car.transmission {
            Transmission::Cvt(cvt) => Some(cvt),
            Transmission::Manual(_) => None,
        }
    }

    /// Solves one operating point.
    pub fn solve(&self, p: &BenchPoint) -> BenchAnswer {
        self.at_ratio(p.ratio).solve(p)
    }

    /// The bench at a belt ratio, or with a gear engaged.
    pub fn at_ratio(&self, ratio: f64) -> AtRatio<'_> {
        AtRatio {
            bench: self,
            ratio,
            belt: self
                .cvt()
                .map(|cvt| (cvt, BeltAtRatio::new(&cvt.belt, ratio))),
        }
    }

    fn solve_manual(&self, manual: &Manual, p: &BenchPoint) -> BenchAnswer {
        let gear = p.ratio as u8;
        let overall = manual.overall[usize::from(gear) - 1];
        let output_nm = p.output_nm / overall;
        let oil = (self.car.oil.state(p.sump_k), p.sump_k);
        let (parts, inside) = manual
            .engaged(gear, p.input_rad_s, output_nm, oil)
            .losses_nm(output_nm);
        let mut loss_nm = ByComponent::default();
        for (component, loss) in parts {
            loss_nm[component] = loss;
        }
        let input_nm = output_nm + loss_nm.iter().sum::<f64>(); // RB-3
        let mut flags = Flags::default();
        flags.set(
            Flags::OUTSIDE_VALIDITY,
            !VALID_K.contains(&p.sump_k) || !inside,
        );
        flags.set(Flags::OVERRUN, input_nm < 0.0);
        BenchAnswer {
            point: *p,
            loss_nm,
            primary_ring_nm: 0.0,
            input_nm,
            output_rad_s: p.input_rad_s / overall,
            secondary_pa: f64::NAN,
            belt_k: f64::NAN,
            belt: None,
            oil_flow_m3_s: 0.0,
            flags,
        }
    }
}

/// A bench at one ratio: what depends on nothing else is known.
#[derive(Clone, Debug)]
pub struct AtRatio<'a> {
    bench: &'a Bench,
    ratio: f64,
    /// The CVT and its belt, if it is one.
    belt: Option<(&'a Cvt, BeltAtRatio)>,
}

impl AtRatio<'_> {
    /// Solves one operating point, at this ratio whatever its own is.
    pub fn solve(&self, p: &BenchPoint) -> BenchAnswer {
        self.solve_near(p, None)
    }

    /// The same, begun where the answer is expected: fewer passes of the fixed point (RB-1), and the same answer within its tolerance.
    pub(super) fn solve_near(&self, p: &BenchPoint, near: Option<Near>) -> BenchAnswer {
        let (bench, ratio) = (self.bench, self.ratio);
        let p = BenchPoint { ratio, ..*p };
        match (&self.belt, &bench.car.transmission) {
            (Some((cvt, at)), _) => {
                cvt_bench::solve(&bench.car, (cvt, at), &p, bench.printed, near)
            }
            (None, Transmission::Manual(manual)) => bench.solve_manual(manual, &p),
            (None, Transmission::Cvt(_)) => unreachable!("a CVT has a belt"),
        }
    }
}

/// A bench that keeps its ratio from point to point.
#[derive(Clone, Debug)]
pub struct KeptRatio<'a> {
    at: AtRatio<'a>,
}

impl<'a> KeptRatio<'a> {
    /// The bench at a first ratio.
    pub fn new(bench: &'a Bench, ratio: f64) -> Self {
        KeptRatio {
            at: bench.at_ratio(ratio),
        }
    }

    /// The bench at a ratio.
    pub fn at(&mut self, ratio: f64) -> &AtRatio<'a> {
        if self.at.ratio.to_bits() != ratio.to_bits() {
            self.at = self.at.bench.at_ratio(ratio);
        }
        &self.at
    }
}
