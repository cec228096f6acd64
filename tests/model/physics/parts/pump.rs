//! Unit tests of `model::transmission::cvt::pump`.
use cvtcycle_model::transmission::cvt::pump::{ETA_REFERENCE_PA_S, Pump, PumpKind};
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;

pub fn pump(kind: PumpKind) -> Pump {
    Pump {
        kind,
        displacement_m3_rad: 9.8e-6 / std::f64::consts::TAU,
        friction: 0.0,
        viscous: 14_750.0,
        viscous_exponent: 0.9,
        heating: ViscousSelfHeating::NONE,
        inlet_pa_s_m3: 0.0,
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
    assert!((p.state(&p.at(ETA_REFERENCE_PA_S), 0.0, 35e5, 0.0).torque_nm - 5.459).abs() < 1e-3);
}

#[test]
fn smaller_displacement_at_work_costs_less_but_never_nothing() {
    let need = 8e-3 / 60.0;
    let t = |kind| {
        pump(kind)
            .state(&pump(kind).at(ETA_REFERENCE_PA_S), 300.0, 20e5, need)
            .torque_nm
    };
    let (fixed, dual, variable) = (
        t(PumpKind::Fixed),
        t(PumpKind::DualCavity { share: 0.5 }),
        t(PumpKind::Variable { least: 0.2 }),
    );
    assert!(
        variable < dual && dual < fixed && variable > 0.0,
        "{fixed} {dual} {variable}"
    );
}

#[test]
fn says_when_flow_falls_short() {
    let p = pump(PumpKind::Fixed);
    let now = p.at(ETA_REFERENCE_PA_S);
    assert!(p.state(&now, 50.0, 20e5, 5e-3 / 60.0).flow_limited);
    assert!(!p.state(&now, 200.0, 20e5, 5e-3 / 60.0).flow_limited);
}

/// Hand calculation: 0.0003 bar per l/min at 10 mPa s are 0.09 bar per l/min at 3000 mPa s; 0.7 bar push 7.8 l/min through.
#[test]
fn val_thick_oil_fills_no_more_than_the_air_pushes_in() {
    let litre_min = 1e-3 / 60.0;
    let p = Pump {
        inlet_pa_s_m3: 0.0003e5 / litre_min,
        ..pump(PumpKind::Fixed)
    };
    let cold = p.at(3.0);
    assert!((1.0 / cold.inv_inlet_flow / litre_min - 7.78).abs() < 0.01);
    let need = 9.0 * litre_min;
    let (fast, warm) = (
        p.state(&cold, 400.0, 20e5, need),
        p.state(&p.at(ETA_REFERENCE_PA_S), 400.0, 20e5, need),
    );
    assert!(
        fast.flow_limited
            && fast.working_m3_s < 7.78 * litre_min
            && fast.working_m3_s > 7.7 * litre_min
    );
    assert!(!warm.flow_limited && (warm.working_m3_s / warm.flow_m3_s - 1.0).abs() < 1e-7);
    // The torque loses nothing: the chamber is filled from the outlet.
    let unbounded = Pump {
        inlet_pa_s_m3: 0.0,
        ..p
    };
    assert_eq!(
        fast.torque_nm.to_bits(),
        unbounded
            .state(&unbounded.at(3.0), 400.0, 20e5, need)
            .torque_nm
            .to_bits()
    );
}
