//! The oil pump, driven at engine speed or by a motor.
//!
//! | label | statement | status |
//! |---|---|---|
//! | PU-1 | T = D (1 + C_f) p + C_v eta_r (eta/eta_r)^m w D + C_h rho_r w2 D^(5/3) + T_c, eta_r = 10 mPa s, rho_r = 850 kg/m3, the second term by FH-1 | source: thesis 7.4 (Schlosser, Wilson); C_v and m fitted, C_f and T_c not identifiable with D; C_h 0 where nothing is known of it |
//! | PU-2 | flow need = V_lub min(1, 1 Pa s/eta) + leakage p (eta_r/eta) + shift flow | ASSUMED values; thick oil runs through what lubricates as through leaks |
//! | PU-3 | shift flow = A \|dx/dt\|, x = 2 tan th R | derived: thesis 9.1 requires it |
//! | PU-4 | dual cavity and variable: only the share of D that the need requires works against p, the rest against a residual pressure | source: thesis 9.1 in words; control ASSUMED |
//! | PU-6 | p <= (drawn flow - lubrication - flow before the clamp)/(leakage eta_r/eta), at least 0.1 bar; before it no flow but that of an imposed shift (PU-7) | derived: a circuit holds the pressure that its flow keeps up; 0.1 bar keeps the solve finite |
//! | PU-7 | line pressure comes first: V_shift <= drawn flow - V_lub - leakage p eta_r/eta, the pressure by PU-6 without the shift flow; the shift's rate falls by RC-5 until it is so. A ratio that is imposed (RC-12) takes its flow, and the pressure by PU-6 falls | derived: valve bodies of CVTs have the line regulator before the ratio valve, so that the clamp is fed first and the shift waits |
//! | PU-5 | drawn flow = V/(1 + (V/V_max)^4)^(1/4), V_max = p_i/(k eta/eta_r) | derived: laminar drop k eta V in strainer and suction line, bounded by the air's pressure; k and p_i = 0.7 bar ASSUMED |
//! | EP-2 | electric: T_e = P/w, P = (p + line drop) V/eta_p, V the need of PU-2 and PU-3 up to that of the fastest motor; besides P (1/eta_a - 1) is lost in the alternator | derived; eta_p 0.4 to 0.75 ASSUMED; eta_a source: alternators 0.5 to 0.6, 48 V machines 0.8 |
//!
//! D displacement per radian m3/rad, p pump outlet pressure Pa, w rad/s, V flow of the displacement that draws. Valid for p >= 0, w >= 0.
//!
//! PU-5: the air over the sump pushes oil into the pump with at most about 0.7 bar before vapour and dissolved air come out; oil as thick as
//! in the cold then fills the chambers in part. The torque stays D p: a chamber filled in part is filled from the outlet as soon as it
//! opens to it, and is then pushed out against p in full; what flowed back is lost as heat. Only flow is missing. The depression itself
//! adds D 0.7 bar at most, 0.1 Nm for 9 cm3/rev, and is left out.

use crate::keys::{Choice, Values, keys};
use crate::math::{Gather, Mask, Real, exp, ln, physics, smooth_ramp};
use crate::transmission::viscous_self_heating::SELF_HEATING;
use crate::transmission::viscous_self_heating::ViscousSelfHeating;
use std::f64::consts::LN_10;

/// How the displacement follows the need for flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PumpKind<R: Real = f64> {
    /// All of it, always.
    Fixed,
    /// Two cavities: the second one is switched off when the first suffices.
    DualCavity {
        /// Share of the displacement in the cavity that always works.
        share: R,
    },
    /// Stroke follows the need.
    Variable {
        /// Smallest share of the displacement.
        least: R,
    },
    /// Driven by a motor, whose power comes from the alternator.
    Electric(ElectricPump<R>),
}

impl Gather for PumpKind {
    type Together<R: Real> = PumpKind<R>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> PumpKind<R> {
        let number = |f: fn(&PumpKind) -> f64| like.map_lanes(|lane| f(of[lane]));
        match of[0] {
            PumpKind::Fixed => PumpKind::Fixed,
            PumpKind::DualCavity { .. } => PumpKind::DualCavity {
                share: number(|kind| kind.numbers()[0]),
            },
            PumpKind::Variable { .. } => PumpKind::Variable {
                least: number(|kind| kind.numbers()[0]),
            },
            PumpKind::Electric(_) => PumpKind::Electric(ElectricPump {
                efficiency: number(|kind| kind.numbers()[0]),
                alternator: number(|kind| kind.numbers()[1]),
                fastest_rad_s: number(|kind| kind.numbers()[2]),
            }),
        }
    }

    fn lane<R: Real>(together: &PumpKind<R>, lane: usize) -> Self {
        match together {
            PumpKind::Fixed => PumpKind::Fixed,
            PumpKind::DualCavity { share } => PumpKind::DualCavity {
                share: share.lane(lane),
            },
            PumpKind::Variable { least } => PumpKind::Variable {
                least: least.lane(lane),
            },
            PumpKind::Electric(of) => PumpKind::Electric(Gather::lane(of, lane)),
        }
    }

    fn groups_with(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other)
    }
}

impl PumpKind {
    /// The numbers of a kind, in their order.
    fn numbers(&self) -> [f64; 3] {
        match self {
            PumpKind::Fixed => [0.0; 3],
            PumpKind::DualCavity { share: x } | PumpKind::Variable { least: x } => [*x, 0.0, 0.0],
            PumpKind::Electric(of) => [of.efficiency, of.alternator, of.fastest_rad_s],
        }
    }
}

/// Motor and alternator of an electric pump.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct ElectricPump<R: Real = f64> {
    /// Hydraulic over electric power.
    pub efficiency: R,
    /// Electric over shaft power of the alternator.
    pub alternator: R,
    /// Largest speed, rad/s.
    pub fastest_rad_s: R,
}

/// The checked pump.
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Pump<R: Real = f64> {
    /// Kind.
    pub kind: PumpKind<R>,
    /// Displacement, m3/rad.
    pub displacement_m3_rad: R,
    /// Coulomb coefficient C_f.
    pub friction: R,
    /// Viscous coefficient C_v.
    pub viscous: R,
    /// Exponent m of viscosity.
    pub viscous_exponent: R,
    /// Heating of the films in its gaps (FH-1).
    pub heating: ViscousSelfHeating<R>,
    /// Pressure drop of strainer and suction line over flow at reference viscosity, Pa s/m3; 0 without one (PU-5).
    pub inlet_pa_s_m3: R,
    /// Depression at the inlet that fills no further: air pressure less vapour, dissolved air and height, Pa (PU-5).
    pub inlet_depression_pa: R,
    /// Torque that accelerates the oil over the square of the speed, C_h rho_r D^(5/3), Nm s2.
    pub hydrodynamic_nm_s2: R,
    /// Constant torque T_c, Nm.
    pub constant_nm: R,
    /// Pressure drop between pump and secondary, Pa.
    pub line_drop_pa: R,
    /// Pressure against which idle displacement turns, Pa.
    pub residual_pa: R,
    /// Lubrication flow, m3/s.
    pub lubrication_m3_s: R,
    /// Leakage per pressure at 80 degC viscosity, m3/(s Pa).
    pub leakage_m3_s_pa: R,
}

/// Pressure that is left of a flow that does not cover lubrication and shift, Pa (PU-6).
const MIN_PA: f64 = 1e4;

/// Viscosity above which oil runs into lubrication as through leaks, 1 Pa s, over that at which C_v is defined (PU-2).
const THICK: f64 = 1.0 / ETA_REFERENCE_PA_S;

/// Viscosity at which C_v is defined, Pa s.
pub const ETA_REFERENCE_PA_S: f64 = 0.010;

/// Density of the oil in the term of C_h, kg/m3.
const RHO_REFERENCE_KG_M3: f64 = 850.0;

/// Exponent of the displacement in the term of C_h.
const FIVE_THIRDS: f64 = 5.0 / 3.0;

/// Logarithm of the reference viscosity.
pub(super) const LN_ETA_REFERENCE: f64 = -2.0 * LN_10;

/// Pump quantities of the oil at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PumpAtTemperature<R: Real = f64> {
    /// Factor (eta/eta_r)^m of PU-1.
    pub viscous_factor: R,
    /// One over the largest flow that the inlet passes, s/m3; 0 without a bound (PU-5).
    pub inv_inlet_flow: R,
    /// Flow into lubrication, m3/s (PU-2).
    pub lubrication_m3_s: R,
    /// Leakage per pressure, m3/(s Pa) (PU-2).
    pub leakage_m3_s_pa: R,
    /// One over it, Pa s/m3; without bound where nothing leaks.
    pub inv_leakage: R,
}

#[physics]
impl<R: Real> PumpAtTemperature<R> {
    /// Flow that is needed without shifting, m3/s (PU-2).
    pub fn need_m3_s(&self, secondary_pa: R) -> R {
        self.lubrication_m3_s + secondary_pa * self.leakage_m3_s_pa // PU-2
    }

    /// Flow that is drawn of the flow of a displacement, m3/s (PU-5).
    pub fn drawn_m3_s(&self, flow_m3_s: R) -> R {
        let x = flow_m3_s * self.inv_inlet_flow;
        let square = x * x;
        flow_m3_s / (1.0 + square * square).sqrt().sqrt() // PU-5
    }
}

/// State of the pump at one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PumpState<R: Real = f64> {
    /// Torque at the pump shaft, Nm; of an electric pump, that of its power at the engine's.
    pub torque_nm: R,
    /// Torque that the alternator loses for it, over that torque.
    pub alternator_share: R,
    /// Theoretical flow, m3/s.
    pub flow_m3_s: R,
    /// Flow drawn by the displacement that works against pressure, m3/s.
    pub working_m3_s: R,
    /// True where the flow of the whole displacement falls short of the need.
    pub flow_limited: R::Mask,
}

#[physics]
impl<R: Real> PumpState<R> {
    /// State without a pump; `like` has the lanes.
    pub fn none(like: R) -> Self {
        let none = like.splat(0.0);
        PumpState {
            torque_nm: none,
            alternator_share: none,
            flow_m3_s: none,
            working_m3_s: none,
            flow_limited: like.splat_mask(false),
        }
    }
}

#[physics]
impl<R: Real> Pump<R> {
    /// Flow of the whole displacement with an engine at a speed, m3/s.
    pub fn full_flow_m3_s(&self, engine_rad_s: R) -> R {
        let speed_rad_s = match &self.kind {
            PumpKind::Electric(electric) => electric.fastest_rad_s,
            _ => engine_rad_s,
        };
        self.displacement_m3_rad * speed_rad_s
    }

    /// Flow that is needed without shifting at a viscosity, m3/s (PU-2).
    #[inline]
    pub fn steady_need_m3_s(&self, secondary_pa: R, eta_pa_s: R) -> R {
        self.with_factor(eta_pa_s, eta_pa_s.splat(1.0))
            .need_m3_s(secondary_pa)
    }

    /// Largest pressure that the flow of the whole displacement keeps up, with a flow into the pulleys, Pa.
    pub fn deliverable_pa(
        &self,
        now: &PumpAtTemperature<R>,
        speed_rad_s: R,
        shift_flow_m3_s: R,
    ) -> R {
        self.turning(now, speed_rad_s)
            .deliverable_pa(shift_flow_m3_s)
    }

    /// The pump with an engine at a speed, in its oil.
    pub fn turning(&self, now: &PumpAtTemperature<R>, speed_rad_s: R) -> TurningPump<'_, R> {
        let flow_m3_s = self.full_flow_m3_s(speed_rad_s);
        let viscous_nm = self.viscous
            * ETA_REFERENCE_PA_S
            * now.viscous_factor
            * speed_rad_s
            * self.displacement_m3_rad;
        TurningPump {
            pump: self,
            now: *now,
            speed_rad_s,
            flow_m3_s,
            viscous_nm: self.heating.torque_nm(viscous_nm, speed_rad_s)
                + self.hydrodynamic_nm_s2 * speed_rad_s * speed_rad_s, // PU-1
        }
    }

    /// Computes the pump quantities of the oil at a viscosity (PU-1, PU-2, PU-5).
    pub fn at(&self, eta_pa_s: R) -> PumpAtTemperature<R> {
        let log = eta_pa_s.ln() - LN_ETA_REFERENCE;
        self.with_factor(eta_pa_s, (self.viscous_exponent * log).exp())
    }

    /// The same with the factor (eta/eta_r)^m of PU-1 known.
    pub fn with_factor(&self, eta_pa_s: R, viscous_factor: R) -> PumpAtTemperature<R> {
        let thicker = eta_pa_s * ETA_REFERENCE_PA_S.recip();
        let thinner = 1.0 / thicker;
        PumpAtTemperature {
            viscous_factor,
            inv_inlet_flow: self.inlet_pa_s_m3 * thicker / self.inlet_depression_pa, // PU-5
            lubrication_m3_s: self.lubrication_m3_s * (THICK * thinner).min(1.0),    // PU-2
            leakage_m3_s_pa: self.leakage_m3_s_pa * thinner,                         // PU-2
            inv_leakage: thicker / self.leakage_m3_s_pa,
        }
    }

    /// Share of the displacement that works against pressure (PU-4), from the flow that all of it draws.
    fn share(&self, need_m3_s: R, drawn_m3_s: R) -> R {
        let whole = drawn_m3_s.splat(1.0);
        let wanted = drawn_m3_s.gt(0.0).select(need_m3_s / drawn_m3_s, whole);
        match self.kind {
            PumpKind::Fixed | PumpKind::Electric(_) => whole,
            PumpKind::DualCavity { share } => {
                share + (1.0 - share) * smooth_ramp(wanted, 0.85 * share, share)
            } // PU-4
            PumpKind::Variable { least } => wanted.clamp(least, 1.0), // PU-4
        }
    }

    /// Torque and flow (PU-1, PU-4).
    pub fn state(
        &self,
        now: &PumpAtTemperature<R>,
        speed_rad_s: R,
        secondary_pa: R,
        need_m3_s: R,
    ) -> PumpState<R> {
        self.turning(now, speed_rad_s)
            .state(secondary_pa, need_m3_s)
    }
}

/// The pump at a speed in its oil: what depends on neither pressure nor need is known.
#[derive(Clone, Copy, Debug)]
pub struct TurningPump<'a, R: Real = f64> {
    pump: &'a Pump<R>,
    now: PumpAtTemperature<R>,
    speed_rad_s: R,
    /// Flow of the whole displacement, m3/s.
    flow_m3_s: R,
    /// The second term of PU-1.
    viscous_nm: R,
}

#[physics]
impl<R: Real> TurningPump<'_, R> {
    /// Flow of the whole displacement, m3/s (PU-5). The roots take longer than the rest of the pump and are seldom needed.
    fn drawn_m3_s(&self) -> R {
        self.now.drawn_m3_s(self.flow_m3_s)
    }

    /// Where a pressure is held with a flow into the pulleys even by the least that PU-5 leaves: (1 + x4)^(-1/4) is at least 1 - x4/4.
    pub fn surely_holds(&self, pressure_pa: R, shift_flow_m3_s: R) -> R::Mask {
        let now = &self.now;
        let x = self.flow_m3_s * now.inv_inlet_flow;
        let square = x * x;
        let drawn = self.flow_m3_s * (1.0 - 0.25 * (square * square));
        let spare = drawn - now.lubrication_m3_s - shift_flow_m3_s;
        spare.gt(MIN_PA * now.leakage_m3_s_pa) & (spare * now.inv_leakage).gt(pressure_pa)
    }

    /// Largest pressure that the flow of the whole displacement keeps up, with a flow into the pulleys, Pa.
    pub fn deliverable_pa(&self, shift_flow_m3_s: R) -> R {
        let now = &self.now;
        let spare = self.drawn_m3_s() - now.lubrication_m3_s - shift_flow_m3_s;
        let enough = spare.gt(MIN_PA * now.leakage_m3_s_pa);
        enough.select(spare * now.inv_leakage, spare.splat(MIN_PA)) // PU-6
    }

    /// Flow of the whole displacement that a pressure and lubrication leave, m3/s, at least none (PU-7).
    pub fn left_m3_s(&self, pressure_pa: R) -> R {
        (self.drawn_m3_s() - self.now.need_m3_s(pressure_pa)).max(0.0) // PU-7
    }

    /// Torque and flow at a pressure and a need (PU-1, PU-4).
    pub fn state(&self, secondary_pa: R, need_m3_s: R) -> PumpState<R> {
        let (pump, drawn) = (self.pump, self.drawn_m3_s());
        if let PumpKind::Electric(of) = &pump.kind {
            return self.electric(of, secondary_pa, need_m3_s);
        }
        let (share, working) = if matches!(pump.kind, PumpKind::Fixed) {
            (drawn.splat(1.0), drawn)
        } else {
            let share = pump.share(need_m3_s, drawn);
            (share, self.now.drawn_m3_s(share * self.flow_m3_s))
        };
        let pressure =
            share * (secondary_pa + pump.line_drop_pa) + (1.0 - share) * pump.residual_pa; // PU-4
        let torque = pump.displacement_m3_rad * (1.0 + pump.friction) * pressure
            + self.viscous_nm
            + pump.constant_nm; // PU-1
        PumpState {
            torque_nm: torque,
            alternator_share: drawn.splat(0.0),
            flow_m3_s: self.flow_m3_s,
            working_m3_s: working,
            flow_limited: need_m3_s.gt(drawn),
        }
    }

    /// An electric pump (EP-2).
    fn electric(&self, of: &ElectricPump<R>, secondary_pa: R, need_m3_s: R) -> PumpState<R> {
        let most_m3_s = self.drawn_m3_s();
        let working_m3_s = need_m3_s.min(most_m3_s);
        let electric_w = (secondary_pa + self.pump.line_drop_pa) * working_m3_s / of.efficiency; // EP-2
        PumpState {
            torque_nm: electric_w / self.speed_rad_s,
            alternator_share: 1.0 / of.alternator - 1.0,
            flow_m3_s: working_m3_s,
            working_m3_s,
            flow_limited: need_m3_s.gt(most_m3_s),
        }
    }
}

keys! {
    /// Keys of `[transmission.cvt.pump]`.
    PUMP: PumpKeys = "pump" [] {
        kind: or_word("fixed", options(&[
            Choice::word("fixed", "the whole displacement works"),
            Choice::new("dual_cavity", "one of two cavities can idle", DualCavityKeys::TABLE),
            Choice::new("variable", "the displacement follows the demand", VariableKeys::TABLE),
            Choice::new("electric", "a motor drives it as fast as the demand is", ElectricKeys::TABLE),
        ])), "fixed, dual_cavity or variable displacement, or an electric pump", ["PU-4", "EP-2"];
        displacement_cc_rev: number(0.5, 100.0), "displacement", ["PU-1"];
        friction_coefficient: or(0.0, number(0.0, 1.0)), "Coulomb coefficient C_f", ["PU-1"];
        viscous_coefficient: number(0.0, 1e6), "viscous coefficient C_v", ["PU-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["PU-1"];
        hydrodynamic_coefficient: or(0.0, number(0.0, 2000.0)), "coefficient C_h of the oil that is accelerated", ["PU-1"];
        film_heating_w: SELF_HEATING, "viscous dissipation at which the heat of the gaps halves the viscous torque; absent: no heating", ["PU-1", "FH-1"];
        inlet_bar_per_l_min: optional(number(0.0, 1.0)), "drop in strainer and suction line at 10 mPa s; absent: none", ["PU-5"];
        inlet_depression_bar: or(0.7, number(0.1, 1.0)), "depression at the inlet that fills the pump no further", ["PU-5"];
        constant_nm: or(0.0, number(0.0, 10.0)), "constant torque T_c", ["PU-1"];
        line_drop_bar: or(0.0, number(0.0, 50.0)), "pressure drop between pump and secondary", ["PU-1"];
        residual_bar: or(1.0, number(0.0, 50.0)), "pressure against which idle displacement turns", ["PU-4"];
        lubrication_l_min: or(3.0, number(0.0, 50.0)), "lubrication flow", ["PU-2"];
        leakage_l_min_per_bar: or(0.1, number(0.0, 2.0)), "leakage at 10 mPa s", ["PU-2"];
    }

    /// Keys of `[transmission.cvt.pump.kind.dual_cavity]`.
    DUAL_CAVITY: DualCavityKeys = "dual_cavity" [] {
        share: or(0.5, number(0.05, 1.0)), "share of displacement in the cavity that always works", ["PU-4"];
    }

    /// Keys of `[transmission.cvt.pump.kind.variable]`.
    VARIABLE: VariableKeys = "variable" [] {
        least_share: or(0.25, number(0.05, 1.0)), "smallest share of the displacement", ["PU-4"];
    }

    /// Keys of `[transmission.cvt.pump.kind.electric]`.
    ELECTRIC: ElectricKeys = "electric" [] {
        efficiency: or(0.6, above(0.05, 1.0)), "hydraulic over electric power", ["EP-2"];
        alternator_efficiency: or(0.6, above(0.05, 1.0)), "electric over shaft power of the alternator that feeds it", ["EP-2"];
        fastest_rpm: or(3000.0, number(300.0, 10_000.0)), "largest speed of its motor", ["EP-2"];
    }
}

impl Pump {
    /// A pump from the values of its table.
    pub fn from_values<V: Values>(p: &V) -> Self {
        let (kind, k) = p.choose(&PUMP.kind);
        let kind = match kind {
            "dual_cavity" => PumpKind::DualCavity {
                share: k.number(&DUAL_CAVITY.share),
            },
            "variable" => PumpKind::Variable {
                least: k.number(&VARIABLE.least_share),
            },
            "electric" => PumpKind::Electric(ElectricPump {
                efficiency: k.number(&ELECTRIC.efficiency),
                alternator: k.number(&ELECTRIC.alternator_efficiency),
                fastest_rad_s: k.number(&ELECTRIC.fastest_rpm),
            }),
            _ => PumpKind::Fixed,
        };
        let displacement_m3_rad = p.number(&PUMP.displacement_cc_rev);
        Pump {
            kind,
            displacement_m3_rad,
            hydrodynamic_nm_s2: p.number(&PUMP.hydrodynamic_coefficient)
                * RHO_REFERENCE_KG_M3
                * exp(FIVE_THIRDS * ln(displacement_m3_rad)), // PU-1
            friction: p.number(&PUMP.friction_coefficient),
            viscous: p.number(&PUMP.viscous_coefficient),
            viscous_exponent: p.number(&PUMP.viscous_exponent),
            heating: ViscousSelfHeating::from_values(p, &PUMP.film_heating_w),
            inlet_pa_s_m3: p.optional(&PUMP.inlet_bar_per_l_min).unwrap_or(0.0),
            inlet_depression_pa: p.number(&PUMP.inlet_depression_bar),
            constant_nm: p.number(&PUMP.constant_nm),
            line_drop_pa: p.number(&PUMP.line_drop_bar),
            residual_pa: p.number(&PUMP.residual_bar),
            lubrication_m3_s: p.number(&PUMP.lubrication_l_min),
            leakage_m3_s_pa: p.number(&PUMP.leakage_l_min_per_bar),
        }
    }
}
