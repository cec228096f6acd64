//! The chain: KC-1 to KC-6, once with the numbers of the book's worked point, then over ratio, torque and clamp with each loss as power, joint
//! by joint.

use super::belt::belt;
use super::{near, same};
use cvtcycle_model::lubricant::BandFriction;
use cvtcycle_model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, Chain, Formulation, Geometry, belt_losses, belt_state,
    driving_point,
};
use std::f64::consts::PI;

/// A chain on the pulleys of the other tests.
pub fn chain() -> Belt {
    Belt {
        segment_thickness_m: 9e-3,
        mass_kg_m: 2.5,
        band_mass_kg_m: 0.0,
        chain: Some(OWN),
        ..belt(Formulation::Smooth)
    }
}

const OWN: Chain = Chain {
    joint_m: 2e-5,
    pin_m: 4e-4,
    slip: 0.02,
    stiffness_n: 5e6,
};

fn load(output_torque_nm: f64, secondary_clamp_n: f64) -> BeltLoad {
    BeltLoad {
        primary_speed_rad_s: 200.0,
        output_torque_nm,
        secondary_clamp_n,
        // A chain has no bands: nothing of this may act.
        band: BandFriction {
            film_share: [0.3, 0.04],
            ..BandFriction::dry(0.12)
        },
        film_n: [220.0, 9.0],
        segment_friction: 0.14,
        capacity_friction: 0.09,
        flank_friction: 0.12,
    }
}

/// The worked point of the page: each number by a pocket calculator from the table of labels.
#[test]
fn val_the_worked_point_of_the_chain() {
    let b = chain();
    let at = BeltAtRatio::new(&b, 1.0);
    let s = belt_state(&b, &at, &load(50.0, 20e3));
    let l = &s.losses;
    near(at.geometry.primary_radius_m, 0.053_889_86, 1e-6); // (0.6486 - 2 0.155)/(2 pi)
    near(s.tension.step_n, 927.818, 1e-5); // 50/0.05389
    near(l.capacity_nm, 197.635, 1e-5); // 2 0.09 20 kN 0.05389/0.98163
    near(s.tension.mean_tension_n(&at.geometry), 3183.43, 1e-5); // 2546.48 + 346.54 + 290.41
    near(l.holding_n, 25_443.5, 1e-5); // 20 kN + pi 927.8 0.74701/0.4
    near(l.joint_nm, 0.254_675, 1e-5); // 2 0.02 mm 3183.4 N 2
    near(l.pin_nm, 0.415_911, 1e-5); // twice 4 0.12 20 kN 9 mm 0.4 mm/(pi 0.98163 53.89 mm)
    near(l.slip_total, 0.002_899_64, 1e-5); // 0.02 (1 - 0.74701^0.5) + 927.8/5e6
    near(l.slip_nm, 0.144_982, 1e-5);
    assert!(l.band_nm == 0.0 && l.film_nm == 0.0 && !l.gross_slip);
}

/// Each loss as the work of one joint times the joints that pass, over the speed of the primary; strands by the free body of each wrap.
#[test]
fn val_the_chain_joint_by_joint() {
    let b = chain();
    let (mut held, mut over) = (0, 0);
    for ratio in [0.42, 0.7, 1.0, 1.6, 2.3] {
        for torque in [-400.0, -90.0, -10.0, 0.0, 4.0, 60.0, 150.0, 500.0] {
            for clamp in [1500.0, 9000.0, 30_000.0] {
                let at = BeltAtRatio::new(&b, ratio);
                let g: Geometry = at.geometry;
                let l = load(torque, clamp);
                let s = belt_state(&b, &at, &l);
                let radius = [g.primary_radius_m, g.secondary_radius_m];
                let wrap = [g.primary_wrap_rad, g.secondary_wrap_rad];
                let force = [clamp * wrap[0] / wrap[1], clamp];
                let pull = torque / radius[1];
                let grip = 2.0 * 0.09 * force[0].min(force[1]) * radius[1] / b.cos_wedge;
                let x = torque.abs() / grip;
                let v = 200.0 * radius[0];
                // The secondary changes the tension over the last part of its wrap, from that of the strand that comes in.
                let a = x.min(1.0);
                let mean_of_wrap = 2.0 * clamp * b.tan_wedge / wrap[1] + 2.5 * v * v;
                let strand_in = mean_of_wrap - 0.5 * a * pull;
                let strands = [strand_in + pull, strand_in];
                same(
                    s.tension.mean_tension_n(&g),
                    0.5 * (strands[0] + strands[1]),
                ); // KC-2
                // On the primary it comes in with the other strand, and the sheave holds the mean.
                let mean_of_primary = strands[0] - 0.5 * a * pull;
                let holds = (mean_of_primary - 2.5 * v * v) * wrap[0] / (2.0 * b.tan_wedge);
                same(s.losses.holding_n, holds.max(0.0)); // KC-2
                let passing = v / 9e-3;
                let (mut joint_w, mut pin_w) = (0.0, 0.0);
                for pulley in [0, 1] {
                    let turn = 9e-3 / radius[pulley];
                    for strand in strands {
                        joint_w += passing * strand * 2e-5 * turn; // KC-3
                    }
                    let face_n = force[pulley] / b.cos_wedge * turn / wrap[pulley];
                    let moment_nm = 2.0 * 0.12 * face_n * 4e-4;
                    pin_w += 2.0 * passing * moment_nm * turn; // KC-4
                }
                same(s.losses.joint_nm, joint_w / 200.0);
                same(s.losses.pin_nm, pin_w / 200.0);
                let slides = if x <= 1.0 {
                    1.0 - (1.0 - x).sqrt()
                } else {
                    1.0 + 20.0 * (x - 1.0)
                };
                let free = 0.02 * slides + pull.abs() / 5e6;
                let slip = torque.signum() * free.min(0.2); // KC-5, SL-9
                let slip = if torque == 0.0 { 0.0 } else { slip };
                same(s.losses.slip_total, slip);
                same(s.losses.slip_nm, slip * torque / ratio);
                assert_eq!(s.slip.held, free > 0.2);
                assert_eq!(s.losses.gross_slip, x > 1.0 || free > 0.2);
                held += u32::from(free > 0.2);
                over += u32::from(x > 1.0);
                // Second law: what comes out is less than what goes in, in both directions.
                let input_w = s.input_torque_nm * 200.0;
                let output_w = torque * 200.0 * (1.0 - slip) / ratio;
                let losses = belt_losses(&b, &at, &l);
                same(input_w - output_w, 200.0 * losses.sum_nm());
                for part in [
                    losses.joint_nm,
                    losses.pin_nm,
                    losses.slip_nm,
                    losses.wedge_nm,
                ] {
                    assert!(part >= 0.0, "{ratio} {torque} {clamp}: {losses:?}");
                }
                let p = driving_point(&b, &at, &l);
                same(p.joint_loss_nm[0] + p.joint_loss_nm[1], losses.joint_nm);
                same(p.pin_loss_nm[0] + p.pin_loss_nm[1], losses.pin_nm);
                same(p.loss_nm, losses.sum_nm());
                same(p.band_tension_n[1] - p.band_tension_n[0], pull.abs());
            }
        }
    }
    assert!(held > 10 && over > held, "{held} {over}");
}

/// KC-6: wedging and penetration are those of a belt under the same forces, whatever the pitch.
#[test]
fn wedging_of_a_chain_is_that_of_a_belt() {
    let b = chain();
    let push = belt(Formulation::Smooth);
    for ratio in [0.42, 1.0, 2.0] {
        let of = |b: &Belt| belt_losses(b, &BeltAtRatio::new(b, ratio), &load(60.0, 15e3));
        let [pull, push] = [of(&b), of(&push)];
        same(pull.wedge_nm, push.wedge_nm);
        same(pull.penetration_nm, push.penetration_nm);
    }
}

/// No jump over torque, through zero and through the capacity, and over ratio; an even slip in drive and overrun.
#[test]
fn the_chain_is_continuous() {
    let b = chain();
    let values = |ratio: f64, torque: f64| {
        let l = belt_losses(&b, &BeltAtRatio::new(&b, ratio), &load(torque, 12e3));
        [
            l.joint_nm,
            l.pin_nm,
            l.slip_total,
            l.holding_n / 12e3,
            l.capacity_nm,
        ]
    };
    let jump = |a: [f64; 5], b: [f64; 5]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let torques = |step: f64| {
        let count = (400.0 / step) as u32;
        let at = |i: u32| values(0.8, -200.0 + step * f64::from(i));
        (0..count)
            .map(|i| jump(at(i), at(i + 1)))
            .fold(0.0, f64::max)
    };
    let ratios = |step: f64| {
        let count = (1.9 / step) as u32;
        let at = |i: u32| values(0.45 + step * f64::from(i), 40.0);
        (0..count)
            .map(|i| jump(at(i), at(i + 1)))
            .fold(0.0, f64::max)
    };
    // The root at the capacity: a tenth of the step is a third of the rise.
    assert!(
        torques(0.01) < 0.4 * torques(0.1),
        "{} {}",
        torques(0.01),
        torques(0.1)
    );
    assert!(
        ratios(0.001) < 0.15 * ratios(0.01),
        "{} {}",
        ratios(0.001),
        ratios(0.01)
    );
    let [drive, overrun] = [values(0.8, 50.0)[2], values(0.8, -50.0)[2]];
    assert_eq!(drive, -overrun);
    assert!(PI > drive && drive > 0.0);
}

/// Every number of a chain moves a loss, and none of a belt's bands does.
#[test]
fn numbers_of_bands_act_on_nothing_in_a_chain() {
    let b = chain();
    let of = |b: &Belt| belt_state(b, &BeltAtRatio::new(b, 1.7), &load(60.0, 15e3));
    let own = of(&b);
    let with = |chain: Chain| Belt {
        chain: Some(chain),
        ..b.clone()
    };
    for other in [
        with(Chain {
            joint_m: 3e-5,
            ..OWN
        }),
        with(Chain { pin_m: 5e-4, ..OWN }),
        with(Chain { slip: 0.03, ..OWN }),
        with(Chain {
            stiffness_n: 4e6,
            ..OWN
        }),
        Belt {
            segment_thickness_m: 8e-3,
            ..b.clone()
        },
        Belt {
            mass_kg_m: 2.0,
            ..b.clone()
        },
    ] {
        assert!(
            of(&other).losses.sum_nm() != own.losses.sum_nm(),
            "{other:?}"
        );
    }
    let bands = Belt {
        band_count: 9.0,
        band_thickness_m: 0.3e-3,
        band_width_m: 30e-3,
        band_offset_m: 1e-3,
        youngs_pa: 100e9,
        strut_area_m2: 5e-6,
        initial_gap_m: 1e-4,
        unity_width: 0.1,
        blend_n: 500.0,
        shoulder_friction: 0.5,
        ..b.clone()
    };
    assert_eq!(of(&bands), own);
    assert_eq!(bands.sliding_m_s(1.7, 200.0), [0.0; 2]);
}
