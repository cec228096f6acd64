//! Bearings and seal rings of the pulleys: PB-1 against the strands' own forces, PB-2 and SR-1 by hand, and what the belt carries with them.

use crate::common::{RPM, ZERO, car};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::rig::transmission::Piece;
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint, Parts};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::pulley_bearing::PulleyBearing;
use cvtcycle_model::transmission::cvt::seal_ring::SealRing;
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, Formulation, belt_state};
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;

const CAR: &str = "rover_216_cvt";

fn bench() -> Bench {
    Bench::new(&car(CAR, &[]))
}

fn point(ratio: f64, bar: f64) -> BenchPoint {
    BenchPoint {
        ratio,
        pressure_pa: Some(bar * 1e5),
        sump_k: 80.0 + ZERO,
        belt_k: Some(90.0 + ZERO),
        ..BenchPoint::default()
    }
}

/// PB-1 against the vectors of both strands: tension of the bands, push of the segments in one of them, and the flow of momentum that turns the
/// belt and not the shaft. The part across the line of centres, which PB-1 leaves out, adds half the square of its share.
#[test]
fn val_shaft_load_is_the_strands_pull() {
    let bench = bench();
    let belt = &bench.cvt().unwrap().belt;
    for ratio in [0.42, 0.5, 0.8, 1.3, 2.0, 2.4] {
        let at = BeltAtRatio::new(belt, ratio);
        let (cos, g) = (at.geometry.strut_m / belt.centre_distance_m, &at.geometry);
        let sin = (g.secondary_radius_m - g.primary_radius_m) / belt.centre_distance_m;
        for clamp_n in [8e3, 20e3, 38e3] {
            for rpm in [600.0, 2500.0, 5500.0] {
                for torque_nm in [-60.0, 0.0, 30.0, 100.0] {
                    let load = BeltLoad {
                        output_torque_nm: torque_nm * ratio,
                        secondary_clamp_n: clamp_n,
                        ..BeltLoad::turning(belt, &bench.car().oil, 363.15, ratio, rpm * RPM)
                    };
                    let t = belt_state(belt, &at, &load).tension;
                    let v = rpm * RPM * g.primary_radius_m;
                    let own_n = belt.mass_kg_m * v * v;
                    let (mean, step, push) = (t.mean_tension_n(g), t.step_n, t.compression_n);
                    // One strand pulls with more of the step, the segments push in one of them.
                    let one = mean + 0.5 * step - push.max(0.0) - own_n;
                    let other = mean - 0.5 * step + push.min(0.0) - own_n;
                    let truth = ((one + other) * cos).hypot((one - other) * sin);
                    let pull = PulleyBearing::pull_per_clamp(belt, &at) * clamp_n;
                    let across = ((one - other) * sin / (one + other) / cos).abs();
                    assert!(
                        (pull / truth - 1.0).abs() <= 0.5 * across * across + 1e-9,
                        "{ratio} {clamp_n} N {rpm} rpm {torque_nm} Nm: {pull} and {truth} N"
                    );
                }
            }
        }
    }
    // From radii found by bisection of GE-3: 37.3 bar in low, 11.5 bar in high.
    for (ratio, bar, want) in [(2.4169, 37.3, 7458.53), (0.5, 11.5, 3364.17)] {
        let at = BeltAtRatio::new(belt, ratio);
        let clamp_n = bar * 1e5 * 97.19e-4 + 750.0;
        let pull = PulleyBearing::pull_per_clamp(belt, &at) * clamp_n;
        assert!((pull / want - 1.0).abs() < 1e-5, "{ratio}: {pull} N");
    }
}

/// PB-2: 0.0015 times 7458 N at a bore of 45 mm is 0.252 Nm; each shaft has its own bore.
#[test]
fn val_bearing_torque() {
    let bearing = PulleyBearing {
        friction: 0.0015,
        bore_m: [0.045, 0.060],
        idle_nm: 0.1,
        idle_nm_s: 2e-3,
    };
    assert!((bearing.torque_nm(0, 7458.0) - 0.25171).abs() < 1e-5);
    assert!((bearing.torque_nm(1, 7458.0) - 0.33561).abs() < 1e-5);
    // PB-3: 0.1 + 1.5 x 2e-3 x 300 = 1 Nm without heating; half of the film's 0.9 Nm where its own power of 0.9 x 300 W halves it twice over.
    let idle_nm = |heating| bearing.idle_nm(1.5, &heating, 300.0);
    assert!((idle_nm(ViscousSelfHeating::NONE) - 1.0).abs() < 1e-12);
    let heated = idle_nm(ViscousSelfHeating::halving_at_w(Some(135.0))); // F (1 + F w/P) = 0.9: F = 0.45
    assert!((heated - 0.55).abs() < 1e-12, "{heated}");
}

/// SR-1: two rings of 40 mm with 2 mm of flank, half of 37.3 bar, friction 0.05: 0.9375 Nm.
#[test]
fn val_ring_torque() {
    let ring = SealRing {
        friction: 0.05,
        rings: 2.0,
        diameter_m: 0.040,
        flank_m: 0.002,
        pressed_share: 0.5,
    };
    let flank_m2 = 251.327e-6;
    let by_hand = 2.0 * 0.05 * (0.5 * 37.3e5 * flank_m2) * 0.020;
    assert!((ring.torque_per_pa() * 37.3e5 - by_hand).abs() < 1e-5);
    assert!((by_hand - 0.9375).abs() < 1e-3);
}

/// Torque that the belt carries at the secondary, from its own balance (VA-1).
fn carried_nm(answer: &BenchAnswer, ratio: f64) -> f64 {
    let belt = answer.belt.unwrap();
    (belt.input_torque_nm - belt.losses.sum_nm()) * ratio / (1.0 - belt.losses.slip_total)
}

/// Without load the belt carries the final drive and the secondary's bearing and rings, each by hand from pressure and clamping force.
#[test]
fn rings_and_bearings_load_the_belt() {
    let bench = bench();
    let cvt = bench.cvt().unwrap();
    for (ratio, bar) in [(2.4, 37.3), (1.1, 20.0), (0.5, 11.5)] {
        let at = BeltAtRatio::new(&cvt.belt, ratio);
        let clamp_n = bar * 1e5 * cvt.secondary_piston_m2 + cvt.spring_n;
        let pull = PulleyBearing::pull_per_clamp(&cvt.belt, &at) * clamp_n;
        let no_drive = bench.solve(&BenchPoint {
            parts: Parts {
                final_drive: false,
                ..Parts::ALL
            },
            ..point(ratio, bar)
        });
        let primary_n = no_drive.belt.unwrap().losses.holding_n;
        let primary_pa = primary_n / cvt.primary_piston_m2;
        let per_pa = cvt.seal_ring.torque_per_pa();
        let bearing = [0, 1].map(|k| cvt.pulley_bearing.torque_nm(k, pull));
        let ring = [per_pa * primary_pa, per_pa * bar * 1e5];
        let near = |got: f64, want: f64| {
            assert!(
                (got - want).abs() < 1e-9,
                "{ratio}: {got} Nm, by hand {want}"
            );
        };
        near(carried_nm(&no_drive, ratio), bearing[1] + ring[1]);
        let turns = |a: &BenchAnswer| (1.0 - a.belt.unwrap().losses.slip_total) / ratio;
        let a = bench.solve(&point(ratio, bar));
        let drive = a.part_nm(Component::FinalDrive) / turns(&a);
        near(carried_nm(&a, ratio), drive + bearing[1] + ring[1]);
        near(
            a.part_nm(Component::PulleyBearing),
            bearing[0] + bearing[1] * turns(&a),
        );
        // The force that holds the ratio follows what the belt carries (TE-9).
        let primary_nm = per_pa * a.belt.unwrap().losses.holding_n / cvt.primary_piston_m2;
        near(
            a.part_nm(Component::SealRing),
            primary_nm + ring[1] * turns(&a),
        );
        near(a.primary_ring_nm, primary_nm);
        near(no_drive.primary_ring_nm, ring[0]);
        let belt = Piece::Belt.loss_nm(&a) - a.belt_nm();
        near(belt, bearing[0] + (bearing[1] + ring[1]) * turns(&a));
    }
}

/// Losses that leave the box with a part: all with the belt except the primary's rings, which leave with the pump.
#[test]
fn rings_stay_with_the_pump() {
    let bench = bench();
    let with = |parts: Parts| {
        bench.solve(&BenchPoint {
            parts,
            ..point(0.5, 11.5)
        })
    };
    let no_belt = with(Parts {
        belt: false,
        ..Parts::ALL
    });
    assert!(no_belt.part_nm(Component::PulleyBearing) == 0.0);
    assert!((no_belt.part_nm(Component::SealRing) - no_belt.primary_ring_nm).abs() < 1e-15);
    assert!(no_belt.primary_ring_nm > 0.1);
    let no_pump = with(Parts {
        pump: false,
        ..Parts::ALL
    });
    assert!(no_pump.part_nm(Component::SealRing) == 0.0);
    // The spring alone still pulls on the shafts.
    let sprung = no_pump.part_nm(Component::PulleyBearing);
    assert!(sprung > 0.0 && sprung < 0.1 * with(Parts::ALL).part_nm(Component::PulleyBearing));
}

/// The thesis's two readings know neither.
#[test]
fn printed_forms_have_neither() {
    for formulation in [Formulation::AppendixC, Formulation::Chapter8] {
        let options = Options {
            formulation,
            ..Options::default()
        };
        let vehicle = load(CAR, &options).unwrap();
        for bench in [Bench::new(&vehicle), Bench::as_printed(&vehicle)] {
            let a = bench.solve(&point(0.5, 11.5));
            assert!(a.part_nm(Component::PulleyBearing) == 0.0);
            assert!(a.part_nm(Component::SealRing) == 0.0 && a.primary_ring_nm == 0.0);
        }
    }
}
