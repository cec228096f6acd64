//! The oil pump, driven at engine speed.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PU-1 | T = D (1 + C_f) p + C_v eta_r (eta/eta_r)^m w D + T_c, eta_r = 10 mPa s | source: thesis 7.4 (Schlosser, Wilson); C_v and m fitted, C_f and T_c not identifiable beside D |
//! | PU-2 | flow need = lubrication + leakage p (eta_80/eta) + shift flow | ASSUMED values |
//! | PU-3 | shift flow = A \|dx/dt\|, x = 2 tan th R | derived: thesis 9.1 asks for it |
//! | PU-4 | dual cavity and variable: only the share of D that the need asks for works against p, the rest against a residual pressure | source: thesis 9.1 in words; control ASSUMED |
//!
//! D displacement per radian m3/rad, p pump outlet pressure Pa, w rad/s. Valid for p >= 0, w >= 0.

use crate::numeric::{exp, held, ln, smooth_ramp};

/// How the displacement follows the need for flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PumpKind {
    /// All of it, always.
    Fixed,
    /// Two cavities: the second one is switched off when the first suffices.
    DualCavity {
        /// Share of the displacement in the cavity that always works.
        share: f64,
    },
    /// Stroke follows the need.
    Variable {
        /// Smallest share of the displacement.
        least: f64,
    },
}

/// The checked pump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pump {
    /// Kind.
    pub kind: PumpKind,
    /// Displacement, m3/rad.
    pub displacement_m3_rad: f64,
    /// Coulomb coefficient C_f.
    pub friction: f64,
    /// Viscous coefficient C_v.
    pub viscous: f64,
    /// Exponent m of viscosity.
    pub viscous_exponent: f64,
    /// Constant torque T_c, Nm.
    pub constant_nm: f64,
    /// Pressure drop between pump and secondary, Pa.
    pub line_drop_pa: f64,
    /// Pressure against which idle displacement turns, Pa.
    pub residual_pa: f64,
    /// Lubrication flow, m3/s.
    pub lubrication_m3_s: f64,
    /// Leakage per pressure at 80 degC viscosity, m3/(s Pa).
    pub leakage_m3_s_pa: f64,
}

/// Viscosity at which C_v is defined, Pa s.
pub const ETA_REFERENCE_PA_S: f64 = 0.010;

/// State of the pump at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PumpState {
    /// Torque at the pump shaft, Nm.
    pub torque_nm: f64,
    /// Theoretical flow, m3/s.
    pub flow_m3_s: f64,
    /// Flow of the displacement that works against pressure, m3/s.
    pub working_m3_s: f64,
    /// Whether the flow falls short of the need.
    pub flow_limited: bool,
}

impl Pump {
    /// Flow that is needed without shifting, m3/s (PU-2).
    #[must_use]
    #[inline]
    pub fn steady_need_m3_s(&self, secondary_pa: f64, eta_pa_s: f64) -> f64 {
        self.need_m3_s(secondary_pa, self.leakage_now_m3_s_pa(eta_pa_s))
    }

    /// Leakage per pressure at a viscosity, m3/(s Pa) (PU-2).
    #[must_use]
    #[inline]
    pub fn leakage_now_m3_s_pa(&self, eta_pa_s: f64) -> f64 {
        self.leakage_m3_s_pa * ETA_REFERENCE_PA_S / eta_pa_s
    }

    /// Flow that is needed without shifting with the leakage known, m3/s (PU-2).
    #[must_use]
    #[inline]
    pub fn need_m3_s(&self, secondary_pa: f64, leakage_m3_s_pa: f64) -> f64 {
        self.lubrication_m3_s + secondary_pa * leakage_m3_s_pa // PU-2
    }

    /// Factor (eta/eta_r)^m of PU-1.
    #[must_use]
    #[inline]
    pub fn viscous_factor(&self, eta_pa_s: f64) -> f64 {
        exp(self.viscous_exponent * ln(eta_pa_s / ETA_REFERENCE_PA_S))
    }

    /// Share of the displacement that works against pressure (PU-4).
    fn share(&self, need_m3_s: f64, flow_m3_s: f64) -> f64 {
        let wanted = if flow_m3_s > 0.0 { need_m3_s / flow_m3_s } else { 1.0 };
        match self.kind {
            PumpKind::Fixed => 1.0,
            PumpKind::DualCavity { share } => share + (1.0 - share) * smooth_ramp(wanted, 0.85 * share, share), // PU-4
            PumpKind::Variable { least } => held(wanted, least, 1.0),                                           // PU-4
        }
    }

    /// Torque and flow (PU-1, PU-4).
    #[must_use]
    #[inline(always)]
    pub fn state(&self, speed_rad_s: f64, secondary_pa: f64, need_m3_s: f64, viscous_factor: f64) -> PumpState {
        let flow = self.displacement_m3_rad * speed_rad_s;
        let share = if self.kind == PumpKind::Fixed { 1.0 } else { self.share(need_m3_s, flow) };
        let pressure = share * (secondary_pa + self.line_drop_pa) + (1.0 - share) * self.residual_pa; // PU-4
        let torque = self.displacement_m3_rad * (1.0 + self.friction) * pressure
            + self.viscous * ETA_REFERENCE_PA_S * viscous_factor * speed_rad_s * self.displacement_m3_rad
            + self.constant_nm; // PU-1
        PumpState { torque_nm: torque, flow_m3_s: flow, working_m3_s: share * flow, flow_limited: need_m3_s > flow }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn pump(kind: PumpKind) -> Pump {
        Pump {
            kind,
            displacement_m3_rad: 9.8e-6 / std::f64::consts::TAU,
            friction: 0.0,
            viscous: 14_750.0,
            viscous_exponent: 0.9,
            constant_nm: 0.0,
            line_drop_pa: 0.0,
            residual_pa: 1e5,
            lubrication_m3_s: 3e-3 / 60.0,
            leakage_m3_s_pa: 1e-4 / 60.0 / 1e5,
        }
    }

    /// Hand calculation: 9.8 cc/rev at 35 bar takes 5.46 Nm without viscous drag.
    #[test]
    fn val_displacement_times_pressure() {
        let p = pump(PumpKind::Fixed);
        assert!((p.state(0.0, 35e5, 0.0, 1.0).torque_nm - 5.459).abs() < 1e-3);
    }

    #[test]
    fn smaller_displacement_at_work_costs_less_but_never_nothing() {
        let need = 8e-3 / 60.0;
        let t = |kind| pump(kind).state(300.0, 20e5, need, 1.0).torque_nm;
        let (fixed, dual, variable) = (t(PumpKind::Fixed), t(PumpKind::DualCavity { share: 0.5 }), t(PumpKind::Variable { least: 0.2 }));
        assert!(variable < dual && dual < fixed && variable > 0.0, "{fixed} {dual} {variable}");
    }

    #[test]
    fn says_when_flow_falls_short() {
        assert!(pump(PumpKind::Fixed).state(50.0, 20e5, 5e-3 / 60.0, 1.0).flow_limited);
        assert!(!pump(PumpKind::Fixed).state(200.0, 20e5, 5e-3 / 60.0, 1.0).flow_limited);
    }
}
