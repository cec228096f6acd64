//! Unit tests of `model::transmission::viscous_self_heating`.
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
