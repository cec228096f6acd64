//! Unit tests of the parts of `model::transmission`: viscous self-heating, pump, drags of the shafts, launch clutch, control, shift speeds.

use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad, FrictionClutch};
use cvtcycle_model::transmission::cvt::controller::{
    ClampSignals, ColdRise, MapLaw, RatioControl, RatioDemand,
};
use cvtcycle_model::transmission::cvt::pump::{ETA_REFERENCE_PA_S, Pump, PumpKind};
use cvtcycle_model::transmission::cvt::shaft_drag::ShaftDrag;
use cvtcycle_model::transmission::cvt::viscosity_power;
use cvtcycle_model::transmission::manual::ShiftSpeeds;
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;

/// Exact drag T exp(T w/P_h) = T_0, by bisection: truth from the equation itself, without its first order.
fn exponential_nm(unheated_nm: f64, speed_rad_s: f64, halving_w: f64) -> f64 {
    let (mut low, mut high) = (0.0, unheated_nm);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle * (middle * speed_rad_s / halving_w).exp() < unheated_nm {
            low = middle
        } else {
            high = middle
        }
    }
    0.5 * (low + high)
}

#[test]
fn val_half_the_drag_at_the_dissipation_that_the_key_names() {
    // 8 Nm unheated, 4 Nm in force at 300 rad/s: 1200 W.
    assert!(
        (ViscousSelfHeating::halving_at_w(Some(1200.0)).torque_nm(8.0, 300.0) - 4.0).abs() < 1e-12
    );
}

#[test]
fn val_lies_between_the_exponential_and_no_heating() {
    for halving_w in [100.0, 1200.0, 1e4] {
        let heating = ViscousSelfHeating::halving_at_w(Some(halving_w));
        for (unheated, w) in [(0.01, 100.0), (1.0, 300.0), (12.0, 500.0), (80.0, 900.0)] {
            let (drag, exact) = (
                heating.torque_nm(unheated, w),
                exponential_nm(unheated, w, halving_w),
            );
            assert!(
                exact <= drag && drag <= unheated,
                "{halving_w} W, {unheated} Nm: {exact} {drag}"
            );
            // To first order they agree: what differs is of second order in the Nahme number.
            let nahme = unheated * w / halving_w;
            assert!(
                drag - exact <= 0.5 * unheated * nahme * nahme,
                "{drag} {exact} at {nahme}"
            );
        }
    }
}

#[test]
fn without_heating_or_speed_the_power_law_stays_to_the_last_bit() {
    for unheated in [0.0, 1e-9, 0.31, 5.0, 1e3] {
        for w in [0.0, 1.0, 700.0] {
            assert_eq!(
                ViscousSelfHeating::NONE.torque_nm(unheated, w).to_bits(),
                unheated.to_bits()
            );
            assert_eq!(
                ViscousSelfHeating::halving_at_w(None)
                    .torque_nm(unheated, w)
                    .to_bits(),
                unheated.to_bits()
            );
        }
        assert_eq!(
            ViscousSelfHeating::halving_at_w(Some(500.0))
                .torque_nm(unheated, 0.0)
                .to_bits(),
            unheated.to_bits()
        );
        let huge = ViscousSelfHeating::halving_at_w(Some(1e18)).torque_nm(unheated, 700.0);
        assert!((huge - unheated).abs() <= 1e-12 * unheated);
    }
}

#[test]
fn colder_oil_never_costs_less_and_far_out_the_root_remains() {
    let heating = ViscousSelfHeating::halving_at_w(Some(1000.0));
    let mut last = (0.0, 0.0);
    for i in 0..2000 {
        let unheated = 1e-4 * f64::from(i * i);
        let drag = heating.torque_nm(unheated, 300.0);
        assert!(drag >= last.1 && drag <= unheated, "{unheated}: {drag}");
        assert!(
            drag * 300.0 <= (unheated * 300.0 * 1000.0).sqrt() * (1.0 + 1e-12),
            "grows faster than the root"
        );
        last = (unheated, drag);
    }
    assert!(
        last.0 > 300.0
            && (heating.torque_nm(4e6, 300.0) / heating.torque_nm(1e6, 300.0) - 2.0).abs() < 2e-3
    );
    let power = |w: f64| heating.torque_nm(5.0, w) * w;
    assert!(
        (1..500).all(|i| power(f64::from(i)) >= power(f64::from(i - 1))),
        "power falls with speed"
    );
}

pub fn pump(kind: PumpKind) -> Pump {
    Pump {
        kind,
        displacement_m3_rad: 9.8e-6 / std::f64::consts::TAU,
        friction: 0.0,
        viscous: 14_750.0,
        viscous_exponent: 0.9,
        heating: ViscousSelfHeating::NONE,
        inlet_pa_s_m3: 0.0,
        inlet_depression_pa: 0.7e5,
        hydrodynamic_nm_s2: 0.0,
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
    let high_up = Pump {
        inlet_depression_pa: 0.5e5,
        ..p
    };
    let share = p.at(3.0).inv_inlet_flow / high_up.at(3.0).inv_inlet_flow;
    assert!((share - 5.0 / 7.0).abs() < 1e-15);
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

/// Thesis 5.5.5: 1-2 Nm over 1000-4000 rpm and 25-95 degC (68 to 7.8 mm2/s).
#[test]
fn val_input_shaft_range() {
    let rpm = std::f64::consts::PI / 30.0;
    let shaft = ShaftDrag {
        constant_nm: 0.97,
        viscous_nm_s: 0.07 / (1000.0 * rpm),
        exponent: 0.75,
        heating: ViscousSelfHeating::NONE,
    };
    let low = shaft.torque_nm(viscosity_power(7.8e-6, 0.75), 1000.0 * rpm);
    let high = shaft.torque_nm(viscosity_power(68e-6, 0.75), 4000.0 * rpm);
    assert!(
        (0.9..1.2).contains(&low) && (1.8..2.3).contains(&high),
        "{low} {high}"
    );
}

fn clutch() -> FrictionClutch {
    let rpm = std::f64::consts::PI / 30.0;
    FrictionClutch {
        engage_rad_s: 1000.0 * rpm,
        gain_nm_s2: 2.1e-5 / rpm / rpm,
        creep_nm: 5.0,
        release_rad_s: 1000.0 * rpm,
    }
}

fn engine_rad_s(
    c: &FrictionClutch,
    output_nm: f64,
    output_rad_s: f64,
    idle_rad_s: f64,
    coupled: bool,
) -> f64 {
    c.engine_rad_s(&CouplingLoad::new(
        output_nm,
        output_rad_s,
        idle_rad_s,
        coupled,
    ))
}

#[test]
fn creeps_at_idle_and_rises_with_torque() {
    let (c, idle) = (clutch(), 89.0);
    assert!((engine_rad_s(&c, 5.0, 0.0, idle, false) - idle).abs() < 1e-12);
    let mut last = idle;
    for i in 1..100 {
        let now = engine_rad_s(&c, 5.0 + f64::from(i), 0.0, idle, false);
        assert!(now > last);
        last = now;
    }
    assert!((engine_rad_s(&c, 20.0, 300.0, idle, false) - 300.0).abs() < 1e-12);
}

#[test]
fn stays_locked_until_near_idle() {
    let (c, idle) = (clutch(), 89.0);
    assert!((engine_rad_s(&c, 60.0, 150.0, idle, true) - 150.0).abs() < 1e-12);
    assert!(engine_rad_s(&c, 60.0, 150.0, idle, false) > 200.0);
    assert!(engine_rad_s(&c, 60.0, 95.0, idle, true) > 120.0);
}

#[test]
fn creep_vanishes_at_idle_speed_and_overrun_share_stays_in_bounds() {
    let c = clutch();
    assert!((c.creep_nm(0.0, 89.0) - 5.0).abs() < 1e-12 && c.creep_nm(89.0, 89.0).abs() < 1e-12);
    assert!(
        c.overrun_share(89.0, 89.0).abs() < 1e-12
            && (c.overrun_share(200.0, 89.0) - 1.0).abs() < 1e-12
    );
}

fn law() -> MapLaw {
    let rpm = std::f64::consts::PI / 30.0;
    MapLaw {
        base_pa: 36.5e5,
        throttle_pa: 12e5,
        cold_per_k: 0.0006,
        slow_factor: 0.68,
        slow_rad_s: 1000.0 * rpm,
        full_rad_s: 2000.0 * rpm,
        fall_s: 0.009 / (1000.0 * rpm),
    }
}

/// Thesis 3.7 in signs: more throttle, colder oil, faster engine and lower gear all raise pressure.
#[test]
fn val_signs_of_the_map() {
    let s = ClampSignals {
        throttle: 0.2,
        engine_rad_s: 150.0,
        oil_k: 300.0,
        radius_factor: 0.5,
        force_log: 0.0,
    };
    let p = law().pressure_pa(&s);
    assert!(law().pressure_pa(&ClampSignals { throttle: 0.3, ..s }) > p);
    assert!(law().pressure_pa(&ClampSignals { oil_k: 290.0, ..s }) > p);
    assert!(
        law().pressure_pa(&ClampSignals {
            engine_rad_s: 160.0,
            ..s
        }) > p
    );
    assert!(
        law().pressure_pa(&ClampSignals {
            radius_factor: 0.6,
            ..s
        }) > p
    );
    let fast = |rad_s: f64| {
        law().pressure_pa(&ClampSignals {
            engine_rad_s: rad_s,
            ..s
        })
    };
    assert!(fast(400.0) < fast(210.0) && fast(400.0) > 0.98 * fast(210.0));
}

const RPM: f64 = std::f64::consts::PI / 30.0;

fn control() -> RatioControl {
    RatioControl {
        low: 2.4169,
        high: 0.4137,
        gentle_rad_s: 1700.0 * RPM,
        gentle_share: 0.15,
        rise_rad_s: 4000.0 * RPM,
        overrun_rad_s: 1500.0 * RPM,
        highest_rad_s: 6000.0 * RPM,
        route_efficiency: 0.85,
        up_per_s: 0.35,
        down_per_s: 1.0,
        rate_speed_rad_s: 1000.0 * RPM,
        hysteresis: 0.05,
        filter_s: 0.0,
        cold: ColdRise::NONE,
        line: None,
        shift_map: None,
    }
}

fn demand(secondary: f64, power: f64, before: f64) -> RatioDemand {
    RatioDemand {
        begins: None,
        secondary_rad_s: secondary,
        primary_rad_s: before * secondary,
        speed_m_s: 10.0,
        power_w: power,
        share: power / 82e3,
        full_load_rad_s: 0.0,
        mapped_rad_s: None,
        cold_rad_s: 0.0,
        ratio_before: before,
        flow_down_per_s: 9.0,
        flow_up_per_s: 9.0,
        coupled: true,
        locks_at: 1.0,
        last_direction: 0,
        free_up_to_rad_s: 0.0,
        dt_s: 1.0,
    }
}

/// Thesis 1.1.2: about 1700 rpm in gentle acceleration, more with power; no shift at rest.
#[test]
fn val_variogram() {
    let c = control();
    assert!((c.target_rad_s(&demand(100.0, 12.3e3, 1.0)) / RPM - 1700.0).abs() < 1e-9);
    assert!((c.target_rad_s(&demand(100.0, 6.15e3, 1.0)) / RPM - 1600.0).abs() < 1e-9);
    assert!((c.target_rad_s(&demand(100.0, 41e3, 1.0)) / RPM - 3100.0).abs() < 1e-9);
    assert!((c.target_rad_s(&demand(100.0, -5e3, 1.0)) / RPM - 1500.0).abs() < 1e-9);
    assert!((c.step(&demand(0.0, 0.0, 1.3)).end - 1.3).abs() < 1e-15);
}

#[test]
fn shift_rate_is_limited_and_says_when_flow_does_it() {
    let c = control();
    let fast = c.step(&demand(400.0, 5e3, 1.0));
    assert!(((1.0_f64 / fast.end).ln() - 0.35).abs() < 1e-9 && !fast.held);
    let slow = c.step(&RatioDemand {
        flow_up_per_s: 0.1,
        ..demand(400.0, 5e3, 1.0)
    });
    assert!(
        ((1.0_f64 / slow.end).ln() - 0.1).abs() < 1e-9
            && (slow.change + 0.1).abs() < 1e-12
            && slow.held
    );
}

#[test]
fn shifts_with_hysteresis() {
    let s = ShiftSpeeds {
        up_m_s: vec![5.0, 10.0],
        down_m_s: vec![3.0, 7.0],
    };
    assert_eq!(s.for_speed(6.0, 1, 3), 2);
    assert_eq!(s.for_speed(4.0, 2, 3), 2);
    assert_eq!(s.for_speed(2.0, 2, 3), 1);
    assert_eq!(s.for_speed(30.0, 0, 3), 3);
    assert_eq!(s.for_speed(8.0, 3, 3), 3);
}
