//! Unit tests of `model::transmission::cvt::controller::ratio`.
use cvtcycle_model::transmission::cvt::controller::{RatioControl, RatioDemand};

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
    }
}

fn demand(secondary: f64, power: f64, before: f64) -> RatioDemand {
    RatioDemand {
        secondary_rad_s: secondary,
        power_w: power,
        rated_w: 82e3,
        full_load_rad_s: 0.0,
        ratio_before: before,
        flow_down_per_s: 9.0,
        flow_up_per_s: 9.0,
        coupled: true,
        last_direction: 0,
        free_up_to_rad_s: 0.0,
        dt_s: 1.0,
    }
}

/// Thesis 1.1.2: about 1700 rpm in gentle acceleration, more with power; no shift at rest.
#[test]
fn val_variogram() {
    let c = control();
    assert!((c.target_rad_s(&demand(100.0, 5e3, 1.0)) / RPM - 1700.0).abs() < 1e-9);
    assert!((c.target_rad_s(&demand(100.0, 41e3, 1.0)) / RPM - 3100.0).abs() < 1e-9);
    assert!((c.target_rad_s(&demand(100.0, -5e3, 1.0)) / RPM - 1500.0).abs() < 1e-9);
    assert!((c.step(&demand(0.0, 0.0, 1.3)).0 - 1.3).abs() < 1e-15);
}

#[test]
fn shift_rate_is_limited_and_says_when_flow_does_it() {
    let c = control();
    let fast = c.step(&demand(400.0, 5e3, 1.0));
    assert!(((1.0 / fast.0).ln() - 0.35).abs() < 1e-9 && !fast.2);
    let slow = c.step(&RatioDemand {
        flow_up_per_s: 0.1,
        ..demand(400.0, 5e3, 1.0)
    });
    assert!(((1.0 / slow.0).ln() - 0.1).abs() < 1e-9 && (slow.1 + 0.1).abs() < 1e-12 && slow.2);
}
