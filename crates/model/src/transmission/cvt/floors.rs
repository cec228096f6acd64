//! Lower bounds of the secondary pressure other than the belt's torque, in a box with one line pressure.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PC-5 | p >= each of p_control; p_return + b \|T_out\|/I; (T_0 beta_s/(2 tan th) - F_0)/A_s; (F_need e - F_0)/A_s while shifting towards low; tau e F_0/(A_p - tau e A_s) towards high where the line is the secondary's (HC-1); F_0 = F_s at p = 0, tau = F_p/F_s without torque, e = exp(\|r\|/(w_p c)) | derived: valves; forward clutch; strand that keeps segments in line; shift by creep at rate r of ln I, \|r\| = w_p c \|ln(F_p/F_s) - ln tau\| (form: Carbone et al. 2007); all sizes ASSUMED |
//!
//! F_need is the force of PC-3. Towards low the primary gives way, but not below what carries the torque, so the secondary presses e times as hard;
//! towards high the primary has F_p = tau e F_s out of the same line pressure, p A_p >= tau e (p A_s + F_0); where no pressure does, the cap. What torque
//! adds to F_p (TE-9) is not raised for.
//! PC-5 binds PC-3, PC-4 and PC-6; a map was measured with its causes in it, and is held at p_control alone.

use super::Cvt;
use super::circuit::LineCircuit;
use super::variator::{BeltAtRatio, BeltLoad};
use crate::keys::{Values, keys};
use crate::math::{Gather, Mask, Real, physics};
use crate::transmission::clamp_cause::ClampCause;

/// The checked floors.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Floors<R: Real = f64> {
    /// Pressure that valves, cooler and lubrication need, Pa.
    pub control_pa: R,
    /// Pressure against the return spring of the forward clutch, Pa.
    pub clutch_return_pa: R,
    /// Pressure for a torque through that clutch, Pa/Nm.
    pub clutch_pa_per_nm: R,
    /// Least tension of a strand, N.
    pub strand_n: R,
    /// Creep c: rate of ln I per angle of the primary and logarithm of the force ratio, 1/rad.
    pub creep_per_rad: R,
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
}

#[physics]
impl<R: Real> Floors<R> {
    /// Logarithm of the force ratio over tau that shifts ln I at a rate: positive towards low, negative towards high, 0 at rest.
    pub fn force_log(&self, rate_per_s: R, primary_rad_s: R) -> R {
        let creep = primary_rad_s * self.creep_per_rad;
        creep.gt(0.0).select(rate_per_s / creep, creep.splat(0.0))
    }
}

/// The belt that the floors look at.
pub(super) struct Held<'a, R: Real = f64> {
    pub cvt: &'a Cvt<R>,
    pub at: &'a BeltAtRatio<R>,
    pub load: &'a BeltLoad<R>,
    /// Force of the secondary without pressure, N.
    pub own_n: R,
    /// Force that the torque needs, N (PC-3).
    pub need_n: R,
    /// Logarithm of the force ratio over tau that the shift needs.
    pub force_log: R,
}

#[physics]
impl<R: Real> Held<'_, R> {
    /// The pressure that each cause needs, Pa (PC-5).
    fn each_pa(&self) -> [(R, ClampCause); 5] {
        let (cvt, floors) = (self.cvt, &self.cvt.floors);
        let zero = self.own_n.splat(0.0);
        let primary_nm = self.load.output_torque_nm.abs() * self.at.geometry.inv_ratio;
        let strands_n = floors.strand_n * self.at.geometry.secondary_wrap_rad;
        let (mut down_pa, mut up_pa) = (zero, zero);
        let down = self.force_log.gt(0.0);
        let up = match cvt.circuit {
            LineCircuit::LineIsSecondary => zero.gt(self.force_log),
            LineCircuit::Independent | LineCircuit::TorqueSensor { .. } => zero.gt(zero),
        };
        if down.any() {
            let pressed_pa = self.pressure_pa(self.need_n * self.force_log.exp());
            down_pa = down.select(pressed_pa, zero);
        }
        if up.any() {
            let ratio = self.at.thrust_ratio * (-self.force_log).exp();
            let left_m2 = cvt.primary_piston_m2 - ratio * cvt.secondary_piston_m2;
            let enough = left_m2.gt(0.0);
            let most = zero.splat(f64::INFINITY);
            let pressed_pa = enough.select(ratio * self.own_n / left_m2, most);
            up_pa = up.select(pressed_pa, zero);
        }
        [
            (floors.control_pa, ClampCause::Control),
            (
                floors.clutch_return_pa + floors.clutch_pa_per_nm * primary_nm,
                ClampCause::Clutch,
            ),
            (
                self.pressure_pa(strands_n / (2.0 * cvt.belt.tan_wedge)),
                ClampCause::Belt,
            ),
            (down_pa, ClampCause::ShiftDown),
            (up_pa, ClampCause::ShiftUp),
        ] // PC-5
    }

    /// Pressure for a force, Pa.
    fn pressure_pa(&self, force_n: R) -> R {
        (force_n - self.own_n) / self.cvt.secondary_piston_m2
    }

    /// Pressure for the force that the torque needs, Pa.
    pub fn of_torque_pa(&self) -> R {
        self.pressure_pa(self.need_n)
    }

    /// The larger of a law's pressure, Pa, and what each cause needs, with the number of the cause.
    pub fn raised(&self, law_pa: R) -> (R, R) {
        let mut most = (law_pa, law_pa.splat(ClampCause::Law.number()));
        for (floor_pa, cause) in self.each_pa() {
            let binds = floor_pa.gt(most.0);
            most.0 = binds.select(floor_pa, most.0);
            most.1 = binds.select(most.1.splat(cause.number()), most.1);
        }
        most
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
