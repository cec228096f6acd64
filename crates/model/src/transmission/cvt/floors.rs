//! What needs a smallest secondary pressure besides the belt's torque, in a box with one line pressure.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PC-5 | p >= each of p_control; p_return + b \|T_out\|/I; (T_0 beta_s/(2 tan th) - F_0)/A_s; (F_need e - F_0)/A_s while shifting towards low; tau e F_0/(A_p - tau e A_s) towards high; F_0 = F_s at p = 0, tau = F_p/F_s, e = exp(\|r\|/(w_p c)) | derived: valves; forward clutch; strand that keeps segments in line; shift by creep at rate r of ln I, \|r\| = w_p c \|ln(F_p/F_s) - ln tau\| (form: Carbone et al. 2007); all sizes ASSUMED |
//!
//! F_need is the force of PC-3. Towards low the primary gives way, but not below what carries the torque, so the secondary presses e times as hard;
//! towards high the primary has F_p = tau e F_s out of the same line pressure, p A_p >= tau e (p A_s + F_0); where no pressure does, the cap.
//! PC-5 binds PC-3, PC-4 and PC-6; a map was measured with its causes in it, and is held at p_control alone.

use super::Cvt;
use super::variator::{BeltAtRatio, BeltLoad};
use crate::keys::{Values, keys};
use crate::math::exp;
use crate::transmission::clamp_cause::ClampCause;

/// The checked floors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floors {
    /// Pressure that valves, cooler and lubrication need, Pa.
    pub control_pa: f64,
    /// Pressure against the return spring of the forward clutch, Pa.
    pub clutch_return_pa: f64,
    /// Pressure for a torque through that clutch, Pa/Nm.
    pub clutch_pa_per_nm: f64,
    /// Least tension of a strand, N.
    pub strand_n: f64,
    /// Creep c: rate of ln I per angle of the primary and logarithm of the force ratio, 1/rad.
    pub creep_per_rad: f64,
}

impl Floors {
    /// A floor of control alone.
    pub const fn of_control(control_pa: f64) -> Self {
        Floors {
            control_pa,
            clutch_return_pa: 0.0,
            clutch_pa_per_nm: 0.0,
            strand_n: 0.0,
            creep_per_rad: f64::INFINITY,
        }
    }

    /// Logarithm of the force ratio over tau that shifts ln I at a rate: positive towards low, negative towards high, 0 at rest.
    #[inline]
    pub fn force_log(&self, rate_per_s: f64, primary_rad_s: f64) -> f64 {
        let creep = primary_rad_s * self.creep_per_rad;
        if creep > 0.0 { rate_per_s / creep } else { 0.0 }
    }
}

/// The belt that the floors look at.
pub(super) struct Held<'a> {
    pub cvt: &'a Cvt,
    pub at: &'a BeltAtRatio,
    pub load: &'a BeltLoad,
    /// Force of the secondary without pressure, N.
    pub own_n: f64,
    /// Force that the torque needs, N (PC-3).
    pub need_n: f64,
    /// Logarithm of the force ratio over tau that the shift needs.
    pub force_log: f64,
}

impl Held<'_> {
    /// The pressure that each cause needs, Pa (PC-5).
    fn each_pa(&self) -> [(f64, ClampCause); 5] {
        let (cvt, floors) = (self.cvt, &self.cvt.floors);
        let pressure_pa = |force_n: f64| (force_n - self.own_n) / cvt.secondary_piston_m2;
        let primary_nm = self.load.output_torque_nm.abs() * self.at.prepared.inv_ratio;
        let strands_n = floors.strand_n * self.at.geometry.secondary_wrap_rad;
        let (mut down_pa, mut up_pa) = (0.0, 0.0);
        if self.force_log > 0.0 {
            down_pa = pressure_pa(self.need_n * exp(self.force_log));
        } else if self.force_log < 0.0 {
            let ratio = self.at.thrust_ratio * exp(-self.force_log);
            let left_m2 = cvt.primary_piston_m2 - ratio * cvt.secondary_piston_m2;
            up_pa = if left_m2 > 0.0 {
                ratio * self.own_n / left_m2
            } else {
                f64::INFINITY
            };
        }
        [
            (floors.control_pa, ClampCause::Control),
            (
                floors.clutch_return_pa + floors.clutch_pa_per_nm * primary_nm,
                ClampCause::Clutch,
            ),
            (
                pressure_pa(strands_n / (2.0 * cvt.belt.tan_wedge)),
                ClampCause::Belt,
            ),
            (down_pa, ClampCause::ShiftDown),
            (up_pa, ClampCause::ShiftUp),
        ] // PC-5
    }

    /// Pressure for the force that the torque needs, Pa.
    pub fn of_torque_pa(&self) -> f64 {
        (self.need_n - self.own_n) / self.cvt.secondary_piston_m2
    }

    /// The larger of a law's pressure, Pa, and what each cause needs.
    pub fn above(&self, law_pa: f64) -> (f64, ClampCause) {
        self.each_pa()
            .into_iter()
            .fold((law_pa, ClampCause::Law), |most, floor| {
                if floor.0 > most.0 { floor } else { most }
            })
    }
}

keys! {
    /// Keys of `[transmission.cvt.pressure]`.
    PRESSURE: PressureKeys = "pressure" [] {
        radius_exponent: or(1.43, number(0.0, 4.0)), "exponent of primary radius in the clamp map", ["PC-1"];
        cap_bar: number(1.0, 200.0), "largest secondary pressure";
        control_bar: or(5.0, number(0.0, 50.0)), "pressure that valves, cooler and lubrication need", ["PC-5"];
        clutch_return_bar: or(1.0, number(0.0, 20.0)), "pressure against the return spring of the forward clutch", ["PC-5"];
        clutch_bar_per_nm: or(0.06, number(0.0, 1.0)), "pressure for a newton metre through that clutch, safety included", ["PC-5"];
        strand_n: or(300.0, number(0.0, 5000.0)), "least tension of a strand, both packs", ["PC-5"];
        creep_per_rad: or(0.02, above(0.0, 1.0)), "rate of ln I per radian of the primary and logarithm of the force ratio", ["PC-5"];
    }
}

impl Floors {
    /// The floors and the largest pressure, Pa, from the values of their table.
    pub(super) fn from_values<V: Values>(s: &V) -> (Self, f64) {
        let floors = Floors {
            control_pa: s.number(&PRESSURE.control_bar),
            clutch_return_pa: s.number(&PRESSURE.clutch_return_bar),
            clutch_pa_per_nm: s.number(&PRESSURE.clutch_bar_per_nm),
            strand_n: s.number(&PRESSURE.strand_n),
            creep_per_rad: s.number(&PRESSURE.creep_per_rad),
        };
        let cap_pa = s.number(&PRESSURE.cap_bar);
        if floors.control_pa > cap_pa {
            s.complain(
                "control_bar",
                "at most cap_bar",
                "the smallest pressure is above the largest",
                "lower control_bar or raise cap_bar",
            );
        }
        (floors, cap_pa)
    }
}
