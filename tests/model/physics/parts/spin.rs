//! Unit tests of `model::transmission::cvt::spin`.
use cvtcycle_model::transmission::cvt::spin::Spin;
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;

fn spin() -> Spin {
    let rpm = std::f64::consts::PI / 30.0;
    Spin {
        shaft_constant_nm: 0.97,
        shaft_viscous_nm_s: 0.07 / (1000.0 * rpm),
        shaft_exponent: 0.75,
        shaft_heating: ViscousSelfHeating::NONE,
        clutch_nm: 0.25,
        clutch_exponent: 0.55,
        clutch_cap_nm: 0.5,
        drive_boundary_nm: 1.2,
        drive_scale_rad_s: 2000.0 * rpm,
        drive_viscous_nm: 0.29,
        drive_exponent: 0.72,
        drive_heating: ViscousSelfHeating::NONE,
        mesh_efficiency: 0.98,
    }
}

/// Thesis 5.5.5: 1-2 Nm over 1000-4000 rpm and 25-95 degC (68 to 7.8 mm2/s).
#[test]
fn val_input_shaft_range() {
    let rpm = std::f64::consts::PI / 30.0;
    let low = spin().at(7.8e-6).shaft_nm(1000.0 * rpm);
    let high = spin().at(68e-6).shaft_nm(4000.0 * rpm);
    assert!(
        (0.9..1.2).contains(&low) && (1.8..2.3).contains(&high),
        "{low} {high}"
    );
}

#[test]
fn final_drive_loss_is_positive_both_ways_and_continuous() {
    let s = spin();
    let mut last = s.secondary_torque_nm(1.0, -60.0);
    for i in -600..600 {
        let out = f64::from(i) * 0.1;
        let t = s.secondary_torque_nm(1.0, out);
        assert!(t - out > 0.0 && (t - last).abs() < 0.12, "{out}: {t}");
        last = t;
    }
}
