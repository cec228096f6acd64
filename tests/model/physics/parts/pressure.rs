//! Unit tests of `model::transmission::cvt::controller::pressure`.
use cvtcycle_model::transmission::cvt::controller::{ClampSignals, MapLaw};

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
