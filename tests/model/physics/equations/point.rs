//! Flags of a point of the `belt` command: each by itself, from both sides of its bound.

use crate::common::ZERO;
use cvtcycle_model::lubricant::BandFriction;
use cvtcycle_model::transmission::cvt::variator::point::{LIMIT_SLACK, PointFlags, PointLimits};
use cvtcycle_model::transmission::cvt::variator::{
    BeltAtRatio, BeltLoad, BeltPoint, Formulation, belt_point,
};

const LIMITS: PointLimits = PointLimits {
    ratio: [0.5, 2.0],
    pressure_pa: [8e5, 40e5],
    highest_rad_s: 600.0,
};
/// Places in [`PointFlags::NAMES`].
const PLACES: [&str; 9] = [
    "outside_ratio_range",
    "above_capacity",
    "gross_slip",
    "no_active_arc",
    "overrun",
    "above_pressure_cap",
    "below_pressure_floor",
    "overspeed",
    "outside_validity",
];

fn load(torque: f64, speed: f64) -> BeltLoad {
    BeltLoad {
        primary_speed_rad_s: speed,
        output_torque_nm: torque,
        secondary_clamp_n: 12_000.0,
        band: BandFriction::dry(0.12),
        film_n: [0.0; 2],
        segment_friction: 0.125,
        capacity_friction: 0.125,
        flank_friction: 0.13,
    }
}

fn point(ratio: f64, load: &BeltLoad) -> BeltPoint {
    let belt = super::belt::belt(Formulation::Smooth);
    belt_point(&belt, &BeltAtRatio::new(&belt, ratio), load)
}

/// The flags that are set, by place.
fn set(p: &BeltPoint, l: &BeltLoad, pa: f64, degc: f64) -> Vec<&'static str> {
    let flags = PointFlags::new(p, l, pa, degc + ZERO, &LIMITS);
    assert!(
        flags.names().eq(PointFlags::NAMES
            .iter()
            .enumerate()
            .filter(|(k, _)| flags.has(*k))
            .map(|(_, n)| n.0))
    );
    flags.names().collect()
}

#[test]
fn names_stand_in_their_order() {
    assert_eq!(PointFlags::NAMES.map(|n| n.0), PLACES);
}

#[test]
fn each_flag_from_both_sides() {
    let l = load(30.0, 250.0);
    let at = |ratio: f64| set(&point(ratio, &l), &l, 20e5, 80.0);
    let none: Vec<&str> = Vec::new();
    for (ratio, out) in [
        (0.5 * (1.0 - 1.01 * LIMIT_SLACK), true),
        (0.5 * (1.0 - 0.99 * LIMIT_SLACK), false),
        (2.0 * (1.0 + 0.99 * LIMIT_SLACK), false),
        (2.0 * (1.0 + 1.01 * LIMIT_SLACK), true),
    ] {
        assert_eq!(
            at(ratio),
            if out { vec![PLACES[0]] } else { none.clone() },
            "{ratio}"
        );
    }
    let p = point(1.2, &l);
    for (pa, degc, want) in [
        (40e5, 80.0, None),
        (40e5 + 1.0, 80.0, Some(5)),
        (8e5, 80.0, None),
        (8e5 - 1.0, 80.0, Some(6)),
        (20e5, 159.9, None),
        (20e5, 160.1, Some(8)),
        (20e5, -39.9, None),
        (20e5, -40.1, Some(8)),
    ] {
        assert_eq!(
            set(&p, &l, pa, degc),
            want.map_or(none.clone(), |k| vec![PLACES[k]]),
            "{pa} {degc}"
        );
    }
    for (speed, over) in [
        (600.0 * (1.0 + 0.9e-9), false),
        (600.0 * (1.0 + 1.1e-9), true),
    ] {
        let l = load(30.0, speed);
        assert_eq!(
            set(&point(1.2, &l), &l, 20e5, 80.0),
            if over { vec![PLACES[7]] } else { none.clone() }
        );
    }
    // Overrun, and torque above capacity in both directions: from both sides of what the point says of itself.
    for sign in [1.0, -1.0] {
        for (share, above) in [(0.999, false), (1.001, true)] {
            let l = load(sign * share * p.capacity_nm, 250.0);
            let flags = set(&point(1.2, &l), &l, 20e5, 80.0);
            assert_eq!(
                (flags.contains(&PLACES[1]), flags.contains(&PLACES[4])),
                (above, sign < 0.0),
                "{flags:?}"
            );
        }
    }
    // Compression beyond the fitted area, 4492 N, in either strut.
    for compression_n in [4491.0, 4493.0, -4491.0, -4493.0] {
        let mut p = p;
        p.tension.compression_n = compression_n;
        assert_eq!(
            set(&p, &l, 20e5, 80.0).contains(&PLACES[8]),
            compression_n.abs() > 4492.0,
            "{compression_n}"
        );
    }
}
