//! Unit tests of `model::road`.
use cvtcycle_model::road::{Ambient, RoadLoad, Surface};

fn rover() -> RoadLoad {
    RoadLoad {
        f0_n: 6.3,
        f1_n_per_m_s: 0.0,
        f2_n_per_m_s2: 0.0433 * 12.96,
        mass_kg: 1130.0,
        inertia_kg: 1130.0 * 1.015,
        wheel_radius_m: 0.2832,
    }
}

/// Colder air is denser and tyres roll harder; a dynamometer does not know.
#[test]
fn cold_road_drags_more() {
    let cold = Ambient {
        temp_k: 263.15,
        altitude_m: 0.0,
    };
    let road = rover().for_ambient(Surface::Road, &cold, 0.00864);
    assert!(road.f0_n > 1.2 * 6.3 && road.f2_n_per_m_s2 > 1.1 * rover().f2_n_per_m_s2);
    assert_eq!(
        rover().for_ambient(Surface::Dynamometer, &cold, 0.00864),
        rover()
    );
}

/// Standard atmosphere: 0.7942 of the density at 2260 m by the isothermal part, pressure 898.7 hPa at 1000 m.
#[test]
fn val_standard_atmosphere() {
    let p = Ambient {
        temp_k: 288.15,
        altitude_m: 1000.0,
    }
    .pressure_ratio()
        * 1013.25;
    assert!((p - 898.75).abs() < 0.1, "{p}");
}
