//! Unit tests of `model::transmission::coupling::friction_clutch`.
use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad, FrictionClutch};

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
