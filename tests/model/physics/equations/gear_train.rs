//! Gear train of both boxes: GM-1 to GM-3, BR-1 to BR-3, CH-1, LS-1, GT-1, GT-2, and with them FD-1, FD-2 and MB-1 to MB-4.
//!
//! Truth: arithmetic with the printed forms, powers that add, limits and signs, and the published hot loss of manual boxes.

use super::{near, same};
use crate::common::{RPM, ZERO, car};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::lubricant::OilState;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::gear_train::bearing::{Bearing, BearingFactors, load_share};
use cvtcycle_model::transmission::gear_train::churning::{self, Churner};
use cvtcycle_model::transmission::gear_train::mesh::{Stage, Teeth};
use cvtcycle_model::transmission::gear_train::seal::LipSeal;
use cvtcycle_model::transmission::gear_train::{GearParts, GearTrain, TurningTrain};
use cvtcycle_model::transmission::manual::Manual;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const TEETH: Teeth = Teeth {
    roughness_m: 0.5e-6,
    oil_factor: 1.0,
};
/// First stage of the Rover's final drive: 25.5 and 45.9 teeth.
const STAGE: Stage = Stage {
    centre_m: 0.085,
    module_m: 2.1e-3,
    face_m: 0.028,
    helix_rad: 28.0 * std::f64::consts::PI / 180.0,
};
const FACTORS: BearingFactors = BearingFactors {
    friction: 0.0015,
    unloaded: 1.0,
    preload: 1.0,
    heating_w: 400.0,
};
fn warm() -> OilState {
    OilState::new(11e-6, 820.0)
}

fn parts() -> GearParts {
    let bearing = |shaft, mean_m, preload_nm| Bearing {
        shaft,
        count: 2.0,
        mean_m,
        bore_m: 0.04,
        f0: 4.0,
        preload_nm,
    };
    GearParts {
        stages: [
            STAGE,
            Stage {
                centre_m: 0.115,
                module_m: 2.6e-3,
                ..STAGE
            },
        ],
        teeth: TEETH,
        bearings: vec![
            bearing(0, 0.045, 0.1),
            bearing(1, 0.05, 0.4),
            bearing(2, 0.062, 0.9),
        ],
        bearing: FACTORS,
        churners: vec![Churner {
            shaft: 2,
            radius_m: 0.095,
            face_m: 0.03,
            immersion_m: 0.03,
        }],
        churning: 3.0,
        seals: vec![
            LipSeal {
                shaft: 0,
                count: 1.0,
                diameter_m: 0.025,
            },
            LipSeal {
                shaft: 2,
                count: 2.0,
                diameter_m: 0.038,
            },
        ],
        oil_m3: 4e-3,
    }
}

/// Hand calculation: centre distance 85 mm, module 2.1 mm, helix 28 degrees, 1.8. u = 1.8, d_1 = 60.7143 mm, z_1 = 25.5274, alpha_t = 22.4018
/// degrees, contact ratio 1.41075 of 0.68511 and 0.72564: H_V = 0.124830. At 4100 rpm v = 13.034 m/s, v_S = 9.934 m/s, rho_C = 8.30 mm; at
/// 150 N/mm and 9 mPa s mu = 0.048 (150/(9.934 8.30))^0.2 9^-0.05 0.5^0.25 = 0.04077: 0.509 % of the power.
#[test]
fn val_mesh_efficiency_by_hand() {
    let mesh = STAGE.mesh(1.8, 1.0, TEETH);
    near(STAGE.pinion_teeth(1.8), 25.527_396_392, 1e-9);
    near(mesh.loss_factor, 0.124_829_924_214, 1e-9);
    let (w, log_eta) = (4100.0 * RPM, 9f64.ln());
    near(mesh.friction(w, 0.0, log_eta), 0.040_773_077_945, 1e-9);
    near(mesh.share(w, 0.0, log_eta), 0.005_089_700_230, 1e-9);
    // 200 Nm at shaft 0 load the teeth with 200/(0.0280656 28) = 254.5 N/mm, in both directions.
    for torque in [200.0, -200.0] {
        near(mesh.share(w, torque, log_eta), 0.005_657_336_813, 1e-9);
    }
    // An overdrive pair is the same pair turned round: the same teeth, and their pinion turns faster than shaft 0.
    let over = STAGE.mesh(1.0 / 1.8, 1.0, TEETH);
    near(over.loss_factor, mesh.loss_factor, 1e-12);
    near(
        over.friction(w / 1.8, 360.0, log_eta),
        mesh.friction(w, 200.0, log_eta),
        1e-12,
    );
}

/// GM-2 on both sides of its bounds: load, speed, friction.
#[test]
fn val_tooth_friction_and_its_bounds() {
    let mesh = STAGE.mesh(1.8, 1.0, TEETH);
    let log_eta = 2.0;
    let at = |rpm: f64, nm: f64| mesh.friction(rpm * RPM, nm, log_eta);
    same(at(2000.0, 10.0), at(2000.0, 100.0)); // below 150 N/mm, which is 117.9 Nm
    near(at(2000.0, 400.0), at(2000.0, 200.0) * 2f64.powf(0.2), 1e-12);
    near(at(4000.0, 0.0), at(2000.0, 0.0) * 0.5f64.powf(0.2), 1e-12);
    same(at(10.0, 0.0), at(150.0, 0.0)); // below 0.5 m/s, which is 157 rpm
    assert!(at(160.0, 0.0) < at(150.0, 0.0));
    same(mesh.friction(1.0, 1e9, -10.0), 0.15);
    near(
        mesh.friction(300.0, 0.0, 3.0),
        mesh.friction(300.0, 0.0, 2.0) * (-0.05f64).exp(),
        1e-12,
    );
    let rough = STAGE.mesh(
        1.8,
        1.0,
        Teeth {
            roughness_m: 1e-6,
            oil_factor: 0.75,
        },
    );
    near(
        rough.friction(300.0, 0.0, 2.0),
        mesh.friction(300.0, 0.0, 2.0) * 0.75 * 2f64.powf(0.25),
        1e-12,
    );
}

/// Hand calculation, Palmgren: 11 mm2/s, 2500 rpm, 65 mm, f_0 = 2: 2e-7 27500^(2/3) 65^3 = 50.04 Nmm; with the heat of its film 2 T/(1 +
/// sqrt(1 + 4 T w/P)). Below nu n = 2000 it stays.
#[test]
fn val_palmgren() {
    let b = Bearing {
        shaft: 0,
        count: 1.0,
        mean_m: 0.065,
        bore_m: 0.04,
        f0: 2.0,
        preload_nm: 0.0,
    };
    let cold = BearingFactors {
        heating_w: 1e12,
        ..FACTORS
    };
    let at = |b: &Bearing, f: &BearingFactors, w: f64, nu_n: f64| b.torque_nm(f, w, nu_n.ln());
    let w = 2500.0 * RPM;
    near(at(&b, &cold, w, 27_500.0), 0.050_039, 1e-4);
    let plain = at(&b, &cold, w, 27_500.0);
    near(
        at(&b, &FACTORS, w, 27_500.0),
        2.0 * plain / (1.0 + (1.0 + 4.0 * plain * w / 400.0).sqrt()),
        1e-9,
    );
    near(
        at(&b, &cold, w, 100.0),
        2e-10 * 2000f64.powf(2.0 / 3.0) * 65f64.powi(3),
        1e-9,
    );
    same(at(&b, &cold, w, 1999.0), at(&b, &cold, w, 1.0));
    // Two of them at six times the factor, each with its own film.
    let pair = Bearing {
        count: 2.0,
        preload_nm: 1.0,
        ..b
    };
    let more = BearingFactors {
        unloaded: 6.0,
        preload: 0.0,
        ..FACTORS
    };
    let unheated = 12.0 * plain;
    near(
        at(&pair, &more, w, 27_500.0),
        2.0 * unheated / (1.0 + (1.0 + 4.0 * unheated * w / 800.0).sqrt()),
        1e-9,
    );
    // The factor holds what preload adds: it does not act where there is none.
    same(at(&b, &more, w, 27_500.0), at(&b, &FACTORS, w, 27_500.0));
}

/// BR-2: all of the preload's friction at rest, a third of it on a full film, and the weighting in between; its power rises with speed.
#[test]
fn val_preload_lifts_off() {
    let b = Bearing {
        shaft: 0,
        count: 2.0,
        mean_m: 0.062,
        bore_m: 0.04,
        f0: 0.0,
        preload_nm: 0.9,
    };
    let at = |nu_n: f64| b.torque_nm(&FACTORS, 100.0, nu_n.ln());
    near(at(1e-3), 0.9, 1e-9);
    near(at(1e7), 0.3, 1e-9);
    let psi = (-2.6e-8 * 11_000f64.powf(1.4) * 62.0).exp();
    near(at(11_000.0), 0.9 * (0.04 + 0.08 * psi) / 0.12, 1e-9);
    let half = BearingFactors {
        preload: 0.5,
        ..FACTORS
    };
    near(
        b.torque_nm(&half, 100.0, 9.0),
        0.5 * b.torque_nm(&FACTORS, 100.0, 9.0),
        1e-12,
    );
    let mut last = 0.0;
    for i in 1..4000 {
        let nu_n = 25.0 * f64::from(i);
        assert!(nu_n * at(nu_n) > last, "power falls at nu n = {nu_n}");
        last = nu_n * at(nu_n);
    }
}

/// BR-3: bearings of 40 and 50 mm bore on wheels of 60 and 120 mm carry 1.1 times the force of the teeth: 1.1 0.0015 (40/60 + 50/120).
#[test]
fn val_bearings_under_load_by_hand() {
    near(
        load_share(0.0015, [0.04, 0.05], 0.03, 2.0),
        1.1 * 0.0015 * (40.0 / 60.0 + 50.0 / 120.0),
        1e-12,
    );
}

/// CH-1 with its groups written down.
#[test]
fn val_churning_by_hand() {
    let wheel = Churner {
        shaft: 2,
        radius_m: 0.095,
        face_m: 0.03,
        immersion_m: 0.03,
    };
    let (r, b, h, v, nu, rho, w) = (0.095f64, 0.03, 0.03, 5e-3, 50e-6, 840.0, 120.0f64);
    let half = (1.0f64 - h / r).acos();
    let wetted = r * r * (2.0 * half - (2.0 * half).sin()) + 2.0 * half * r * b;
    near(wheel.wetted_m2(), wetted, 1e-12);
    let (froude, reynolds) = (w * w * r / 9.81, w * r * r / nu);
    let want = 0.5
        * rho
        * w
        * w
        * r.powi(3)
        * wetted
        * 1.366
        * (h / (2.0 * r)).powf(0.45)
        * (v / (2.0 * r).powi(3)).powf(0.1)
        * froude.powf(-0.6)
        * reynolds.powf(-0.21)
        * (b / r).powf(0.21);
    near(want, 0.155_128, 1e-5);
    let got = churning::torque_nm(wheel.factor(v), rho, w.ln(), nu.ln());
    near(got, want, 1e-10);
    let dry = Churner {
        immersion_m: 0.0,
        ..wheel
    };
    same(dry.factor(v), 0.0);
    // A wheel under the oil is wetted all round, and no deeper.
    let deep = |immersion_m: f64| Churner {
        immersion_m,
        ..wheel
    };
    same(deep(0.19).factor(v), deep(0.3).factor(v));
    near(
        deep(0.3).wetted_m2(),
        2.0 * std::f64::consts::PI * r * (r + b),
        1e-12,
    );
}

/// Hand calculation: 7.34e-5 40^2 = 0.11744 Nm a seal, the power of ISO/TR 14179-2 (7.69e-6 40^2 n W) over the speed.
#[test]
fn val_lip_seal() {
    let seal = LipSeal {
        shaft: 0,
        count: 2.0,
        diameter_m: 0.04,
    };
    near(seal.torque_nm(), 2.0 * 0.117_44, 1e-12);
    near(seal.torque_nm(), 2.0 * 7.69e-6 * 1600.0 / RPM, 1e-3);
}

/// GT-1: every part once more by its own speed, and the sum of powers over the speed of shaft 0.
#[test]
fn val_no_load_torque_is_the_sum_of_powers() {
    let p = parts();
    for ratios in [[1.8, 3.5], [0.8, 4.0]] {
        let train = p.train(ratios);
        for (rpm, oil) in [(300.0, warm()), (5000.0, OilState::new(900e-6, 880.0))] {
            let w = rpm * RPM;
            let got = train.turning(w, 40.0, oil);
            let turns = [1.0, 1.0 / ratios[0], 1.0 / ratios[0] / ratios[1]];
            let mut watts = [0.0; 3];
            for b in &p.bearings {
                let own = w * turns[b.shaft];
                let log_nu_n = (oil.kinematic_m2_s * 1e6 * own / RPM).ln();
                watts[0] += own * b.torque_nm(&FACTORS, own, log_nu_n);
            }
            for c in &p.churners {
                let own = w * turns[c.shaft];
                let nm = churning::torque_nm(
                    c.factor(4e-3),
                    oil.density_kg_m3,
                    own.ln(),
                    oil.kinematic_m2_s.ln(),
                );
                watts[1] += 3.0 * own * nm;
            }
            for s in &p.seals {
                watts[2] += w * turns[s.shaft] * s.torque_nm();
            }
            near(got.bearing_nm * w, watts[0], 1e-10);
            near(got.churning_nm * w, watts[1], 1e-10);
            near(got.seal_nm * w, watts[2], 1e-12);
            let log_eta = (1e3 * oil.kinematic_m2_s * oil.density_kg_m3).ln();
            let share = |k: usize| {
                let mesh = p.stages[k].mesh(ratios[k], turns[k], TEETH);
                mesh.share(w, 40.0, log_eta)
            };
            near(got.mesh_share, share(0) + share(1), 1e-10);
        }
        assert_eq!(train.turning(0.0, 40.0, warm()), TurningTrain::default());
    }
}

/// GT-2 by hand: 1.5 Nm without load and 4 % under it, in drive, overrun and where nothing passes; and the inverse.
#[test]
fn val_train_in_drive_and_overrun_by_hand() {
    let train = TurningTrain {
        bearing_nm: 0.9,
        churning_nm: 0.4,
        seal_nm: 0.2,
        mesh_share: 0.03,
        bearing_share: 0.01,
    };
    for (out, want) in [
        (46.5, 48.0 / 0.96),
        (-0.3, 1.2 / 0.96),
        (-1.5, 0.0),
        (-49.5, -48.0 * 0.96),
    ] {
        near(train.input_nm(out) + 1.0, want + 1.0, 1e-12);
        near(train.output_nm(want) + 100.0, out + 100.0, 1e-12);
        let parts = train.losses(out);
        near(
            out + parts.mesh + parts.bearing + parts.churning + parts.seal + 1.0,
            want + 1.0,
            1e-12,
        );
    }
    // 2 Nm of 50 Nm: 1.5 in the teeth, 0.5 in the bearings; the same of 48 Nm in overrun.
    near(train.losses(46.5).mesh, 1.5, 1e-12);
    near(train.losses(46.5).bearing, 0.9 + 0.5, 1e-12);
    near(train.losses(-49.5).mesh, 0.03 * 48.0, 1e-12);
}

// ---------------------------------------------------------------- properties

prop_compose! {
    fn any_stage()(centre in 0.06..0.16f64, module in 1.5e-3..3e-3f64, face in 0.015..0.05f64, helix in 0.0..0.6f64) -> Stage {
        Stage { centre_m: centre, module_m: module, face_m: face, helix_rad: helix }
    }
}

prop_compose! {
    fn any_bearing()(shaft in 0..3usize, count in 1..4i32, mean in 0.03..0.08f64, f0 in 0.5..8.0f64, preload_nm in 0.0..2.0f64) -> Bearing {
        Bearing { shaft, count: f64::from(count), mean_m: mean, bore_m: 0.7 * mean, f0, preload_nm }
    }
}

prop_compose! {
    fn any_churner()(shaft in 0..3usize, radius in 0.03..0.12f64, face in 0.01..0.1f64, deep in 0.0..2.5f64) -> Churner {
        Churner { shaft, radius_m: radius, face_m: face, immersion_m: deep * radius }
    }
}

prop_compose! {
    fn any_parts()(
        stages in [any_stage(), any_stage()],
        bearings in prop::collection::vec(any_bearing(), 0..5),
        churners in prop::collection::vec(any_churner(), 0..3),
        (unloaded, preload, heating_w, churning) in (0.0..8.0f64, 0.0..2.0f64, 50.0..1e5f64, 0.0..6.0f64),
        oil_m3 in 1e-3..8e-3f64,
    ) -> GearParts {
        GearParts {
            stages, teeth: TEETH, bearings, churners, churning, oil_m3,
            bearing: BearingFactors { friction: 0.0015, unloaded, preload, heating_w },
            seals: vec![LipSeal { shaft: 2, count: 2.0, diameter_m: 0.038 }],
        }
    }
}

fn oil(nu: f64) -> OilState {
    OilState::new(nu, 850.0)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2010), ..ProptestConfig::with_cases(2000) })]

    /// Nothing is negative or no number, the parts sum up to the loss, no more than a tenth is lost under load, and the train loses in both
    /// directions of power; torque before it rises with the one behind it.
    #[test]
    fn a_train_loses_in_both_directions(
        p in any_parts(), first in 0.6..4.0f64, second in 2.5..5.0f64,
        w in 0.0..800.0f64, nu in 3e-6..5e-2f64, demand in -300.0..300.0f64, out in -300.0..300.0f64,
    ) {
        let now = p.train([first, second]).turning(w, demand, oil(nu));
        let losses = now.losses(out);
        let parts = [losses.mesh, losses.bearing, losses.churning, losses.seal];
        prop_assert!(parts.iter().all(|nm| nm.is_finite() && *nm >= 0.0), "{parts:?}");
        prop_assert!(now.share() <= 0.1 + 1e-12);
        let input = now.input_nm(out);
        prop_assert!((input - out - parts.iter().sum::<f64>()).abs() <= 1e-10 * (1.0 + out.abs()));
        prop_assert!((now.output_nm(input) - out).abs() <= 1e-10 * (1.0 + out.abs()));
        prop_assert!(now.input_nm(out + 1e-3) > input);
        prop_assert!(input - out >= now.no_load_nm() * 0.9 - 1e-9);
    }

    /// Thicker oil never costs less without load, but for preloaded bearings, whose rollers it lifts (BR-2).
    #[test]
    fn thicker_oil_never_costs_less_without_load(
        p in any_parts(), first in 0.6..4.0f64, w in 1.0..800.0f64, nu in 3e-6..1e-2f64, times in 1.0..4.0f64,
    ) {
        let no_preload = GearParts { bearing: BearingFactors { preload: 0.0, ..p.bearing }, ..p };
        let train = no_preload.train([first, 3.5]);
        let (thin, thick) = (train.turning(w, 0.0, oil(nu)), train.turning(w, 0.0, oil(nu * times)));
        for (a, b) in [(thin.bearing_nm, thick.bearing_nm), (thin.churning_nm, thick.churning_nm), (thin.seal_nm, thick.seal_nm)] {
            prop_assert!(b >= a * (1.0 - 1e-12), "{a} {b}");
        }
    }

    /// A faster train never takes less power without load, preload and all.
    #[test]
    fn faster_never_costs_less_power(p in any_parts(), first in 0.6..4.0f64, w in 0.1..700.0f64, times in 1.0..3.0f64, nu in 3e-6..1e-2f64) {
        let train = p.train([first, 3.5]);
        let power = |w: f64| w * train.turning(w, 0.0, oil(nu)).no_load_nm();
        prop_assert!(power(times * w) >= power(w) * (1.0 - 1e-12));
    }

    /// Turned round, a first stage loses the same power: as many revolutions of the same shafts.
    #[test]
    fn a_train_has_no_side(p in any_parts(), ratio in 0.6..2.0f64, w in 1.0..500.0f64, nu in 3e-6..1e-3f64) {
        let own = |shaft: usize| GearParts {
            bearings: p.bearings.iter().filter(|b| b.shaft == shaft).copied().collect(),
            churners: p.churners.iter().filter(|c| c.shaft == shaft).copied().collect(),
            seals: Vec::new(),
            ..p.clone()
        };
        let turned = |mut parts: GearParts, shaft: usize| {
            parts.bearings.iter_mut().for_each(|b| b.shaft = shaft);
            parts.churners.iter_mut().for_each(|c| c.shaft = shaft);
            parts
        };
        let a = own(1).train([ratio, 3.5]).turning(w, 0.0, oil(nu));
        let b = turned(own(1), 0).train([1.0 / ratio, 3.5]).turning(w / ratio, 0.0, oil(nu));
        let (a, b) = (a.no_load_nm() * w, b.no_load_nm() * w / ratio);
        prop_assert!((a - b).abs() <= 1e-9 * (a + b) + 1e-12, "{a} {b} W");
    }
}

// ---------------------------------------------------------------- in the boxes

fn cvt(setup: &Setup) -> &Cvt {
    let Transmission::Cvt(cvt) = setup.transmission() else {
        panic!("a CVT")
    };
    cvt
}

fn manual(setup: &Setup) -> &Manual {
    let Transmission::Manual(manual) = setup.transmission() else {
        panic!("a manual box")
    };
    manual
}

/// One model: the wheels of the Rover's final drive in a manual box lose what they lose in the CVT, to the bit.
#[test]
fn val_same_parts_same_loss() {
    let rover = car("rover_216_cvt", &[]);
    let keys = [
        "bearing_friction",
        "bearing_factor",
        "bearing_heating_w",
        "preload_factor",
        "churning_factor",
        "roughness_um",
        "oil_factor",
        "stages",
        "bearings",
        "churners",
        "seals",
    ];
    let value = |key: String| {
        let info = rover.keys.iter().find(|info| info.key == key);
        info.unwrap_or_else(|| panic!("no key {key}")).value.clone()
    };
    let mut sets: Vec<String> = keys
        .iter()
        .map(|key| {
            let value = value(format!("transmission.cvt.final_drive.{key}"));
            format!("transmission.manual.gears.{key}={value}")
        })
        .collect();
    let all = cvt(&rover).final_drive.ratio;
    let last = all / 1.8;
    sets.extend([
        format!("transmission.manual.final_ratio={last:?}"),
        format!("transmission.manual.overall_ratios=[{all:?}, 5]"),
        "transmission.manual.upshift_kmh=[30]".into(),
        "transmission.manual.downshift_kmh=[20]".into(),
        format!(
            "thermal.transmission.oil_l={}",
            value("thermal.transmission.oil_l".into())
        ),
    ]);
    let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
    let other = car("rover_216_5mt", &sets);
    let (here, there): (&GearTrain, &GearTrain) =
        (&cvt(&rover).final_drive.train, &manual(&other).trains[0]);
    for degc in [-30.0, 25.0, 90.0] {
        let oil = rover.oils().0.state(degc + ZERO);
        for (rpm, nm) in [(200.0, -400.0), (1500.0, 0.0), (6000.0, 90.0)] {
            let (a, b) = (
                here.turning(rpm * RPM, nm, oil),
                there.turning(rpm * RPM, nm, oil),
            );
            near(a.no_load_nm(), b.no_load_nm(), 1e-12);
            near(a.share(), b.share(), 1e-12);
            assert!(a.no_load_nm() > 0.3);
        }
    }
}

/// In the cold the Rover's final drive takes what its parts can take: below 8 Nm at the secondary at -30 degC at any speed (an exponent of
/// viscosity without speed had 18.7 Nm at 600 rpm), and its meshes are those of a good gearbox.
#[test]
fn val_final_drive_in_the_cold() {
    let rover = car("rover_216_cvt", &[]);
    let train = &cvt(&rover).final_drive.train;
    let oil = |degc: f64| rover.oils().0.state(degc + ZERO);
    for rpm in (50..9000).step_by(50) {
        let nm = train
            .turning(f64::from(rpm) * RPM, 0.0, oil(-30.0))
            .no_load_nm();
        assert!(nm > 0.5 && nm < 8.0, "{nm} Nm at {rpm} rpm");
    }
    let warm = train.turning(4100.0 * RPM, 0.0, oil(80.0));
    near(1.0 - warm.mesh_share, 0.9877, 5e-4);
    near(warm.no_load_nm(), 0.603, 0.01);
    near(
        train.turning(4100.0 * RPM, 0.0, oil(-10.0)).no_load_nm(),
        2.769,
        0.01,
    );
}

/// Outside truth: losses of manual boxes by class, hot at 80 degC 0.925 Nm + 0.000407 Nm/rpm and cold, at 40 degC, 1.323 Nm + 0.000485 Nm/rpm for
/// 145 Nm at the input (CO2MPAS), 1.1 times that for the Mondeo; with the bearings' factor of the final drive of the CVT. Churning grows less with
/// speed than the published lines.
#[test]
fn val_manual_boxes_without_load() {
    for (name, times) in [("rover_216_5mt", 1.0), ("mondeo_20_5mt", 1.1)] {
        let setup = car(name, &[]);
        let box_ = manual(&setup);
        let mean = |rpm: f64, degc: f64| {
            let k = degc + ZERO;
            let oil = setup.oils().0.state(k);
            let gears = 3..=5u8;
            gears
                .map(|gear| box_.trains[usize::from(gear) - 1].turning(rpm * RPM, 0.0, oil))
                .map(|train| train.no_load_nm())
                .sum::<f64>()
                / 3.0
        };
        let mut over = 0.0;
        for (degc, nm, nm_per_rpm) in [(80.0, 0.925, 0.000_407), (40.0, 1.323, 0.000_485)] {
            for rpm in [1000.0, 2000.0, 3000.0, 4000.0] {
                let ratio = mean(rpm, degc) / (times * (nm + nm_per_rpm * rpm));
                println!("{name} at {degc} degC, {rpm} rpm: {ratio:.3} of the published line");
                assert!((ratio - 1.0).abs() < 0.25, "{name} {degc} {rpm}: {ratio}");
                over += 0.125 * ratio;
            }
        }
        assert!((over - 1.0).abs() < 0.10, "{name}: {over}");
        // Loss under load: two meshes and their bearings.
        for (gear, train) in box_.trains.iter().enumerate() {
            let oil = setup.oils().0.state(80.0 + ZERO);
            let now = train.turning(2000.0 * RPM, 50.0, oil);
            assert!(
                (0.973..0.985).contains(&(1.0 - now.share())),
                "{name}, gear {}: {}",
                gear + 1,
                now.share()
            );
        }
    }
}

/// FD-1, FD-2 in the box: the component is what the train takes, in drive, in overrun and in the cold.
#[test]
fn val_final_drive_is_its_train() {
    use cvtcycle_model::rig::{Bench, BenchPoint};
    let setup = car("rover_216_cvt", &[]);
    let bench = Bench::new(&setup);
    let drive = &cvt(&setup).final_drive;
    for (output_nm, degc) in [(300.0, 80.0), (-120.0, 25.0), (0.0, -20.0)] {
        let a = bench.solve(&BenchPoint {
            ratio: 1.3,
            output_nm,
            sump_k: degc + ZERO,
            pressure_pa: Some(20e5),
            ..BenchPoint::default()
        });
        let (ws, at_secondary) = (a.output_rad_s * drive.ratio, output_nm / drive.ratio);
        let oil = setup.oils().0.state(degc + ZERO);
        let train = drive.train.turning(ws, at_secondary, oil);
        let want = (train.input_nm(at_secondary) - at_secondary) * ws;
        let w = BenchPoint::default().input_rad_s;
        near(a.part_nm(Component::FinalDrive) * w, want, 1e-7);
        assert!(want > 0.0);
    }
}
