//! The rigs: a transient from its seconds, the second box, the variator rig from its parts.

use super::{near, same};
use crate::common::{ZERO, car, rover_bench};
use cvtcycle_config::Override;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, METAL, NODES, SUMP};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad};

/// A transient of the transmission rig: energies from its own seconds, the branches between them, the gap and where it is widest.
#[test]
fn val_transient_from_its_seconds() {
    use cvtcycle_model::rig::transmission::{Branch, transient};
    let (bench, mut c) = (
        rover_bench(),
        cvtcycle_config::rig::load(&[Override::number("rig.transient.end_degc", 45.0)])
            .unwrap()
            .0,
    );
    c.transient.start_k = 20.0 + ZERO;
    let run = transient(&bench, &c, c.low_ratio);
    assert!(run.complete && run.energy.error().abs() < 1e-9);
    let (w, car) = (c.transient.speed_rad_s, bench.car());
    let turned = run
        .moments
        .windows(2)
        .position(|m| m[0].branch != m[1].branch)
        .unwrap();
    let steps = run
        .moments
        .windows(2)
        .enumerate()
        .filter(|(k, _)| *k != turned)
        .map(|(_, m)| (m[0], m[1].time_s - m[0].time_s));
    let (mut shaft, mut cooler) = (0.0, 0.0);
    for (m, dt) in steps {
        assert!(dt == 1.0);
        shaft += m.answer.input_nm * w * dt;
        let carried = c.cooler.flow_m3_s
            * car.oil.density_kg_m3(m.sump_k)
            * car.oil.heat_capacity_j_kgk(m.sump_k);
        let share = 1.0 - (-c.cooler.conductance_w_k / carried).exp();
        cooler += if m.branch == Branch::Cooling {
            carried * share * (m.sump_k - c.cooler.coolant_k) * dt
        } else {
            0.0
        }; // RT-2
    }
    // The first minute once more by the network itself (RT-1), heat by SI-3.
    let network = cvtcycle_model::rig::transmission::on_the_rig(&car.network);
    let mut node_k = [c.transient.start_k; NODES];
    (node_k[COOLANT], node_k[ENGINE_OIL]) = (c.room_k, c.room_k);
    let mut heat = Heat { node_k };
    for m in &run.moments[..60] {
        assert!(
            (heat.node_k[SUMP] - m.sump_k).abs() < 1e-9
                && (heat.node_k[METAL] - m.metal_k).abs() < 1e-9,
            "{} s",
            m.time_s
        );
        let belt = car.belt_heat_share * m.answer.belt_nm();
        let shaft =
            m.answer.part_nm(Component::InputShaft) + m.answer.part_nm(Component::PulleyBearing);
        let mut power_w = [0.0; NODES];
        (power_w[BELT], power_w[METAL], power_w[SUMP]) = (
            belt * w,
            shaft * w,
            (m.answer.total_nm() - belt - shaft) * w,
        );
        let input = HeatInput {
            power_w,
            ambient_k: c.room_k,
            speed_m_s: 0.0,
            pump_rad_s: w,
            oil_flow_m3_s: m.answer.oil_flow_m3_s,
            oil_volume_heat_j_m3k: 1.0,
            running: true,
            dt_s: 1.0,
        };
        heat = network.advance(&heat, &input).heat;
    }
    near(run.energy.shaft_j, shaft, 1e-9);
    near(run.energy.to_cooler_j, cooler, 1e-9);
    let ends = (
        run.moments[0].sump_k,
        run.moments[turned].sump_k,
        run.moments.last().unwrap().sump_k,
    );
    assert!(ends.0 == 20.0 + ZERO && ends.1 >= 45.0 + ZERO && ends.2 <= 20.0 + ZERO);
    // Between two seconds linear, on either branch; beyond the branch none.
    for (branch, k) in [
        (Branch::Warming, turned / 2),
        (Branch::Cooling, turned + 20),
    ] {
        let (a, b) = (run.moments[k], run.moments[k + 1]);
        let at = |share: f64| {
            run.at(branch, a.sump_k + share * (b.sump_k - a.sump_k), |m| {
                m.metal_k
            })
            .unwrap()
        };
        for share in [0.01, 0.4, 0.99] {
            near(at(share), a.metal_k + share * (b.metal_k - a.metal_k), 1e-9);
        }
        near(
            run.loss_nm(branch, a.sump_k).unwrap(),
            a.answer.total_nm(),
            1e-9,
        );
    }
    assert!(
        run.at(Branch::Warming, 10.0 + ZERO, |m| m.sump_k).is_none()
            && run.at(Branch::Cooling, 60.0 + ZERO, |m| m.sump_k).is_none()
    );
    let half: Vec<(f64, f64)> = (0..200)
        .map(|k| ends.0.min(ends.2) + 0.5 * f64::from(k))
        .filter(|k| *k <= ends.1)
        .filter_map(|k| {
            Some((
                k,
                run.loss_nm(Branch::Cooling, k)? - run.loss_nm(Branch::Warming, k)?,
            ))
        })
        .collect();
    let best = half
        .iter()
        .fold(half[0], |best, g| if g.1 > best.1 { *g } else { best });
    let (gap, k) = run.widest().unwrap();
    same(gap, best.1);
    same(k, best.0);
    for near_nm in [0.5 * gap, 0.9 * gap, -9.0] {
        let want = half
            .iter()
            .take_while(|g| g.0 <= best.0)
            .filter(|g| g.1 <= near_nm)
            .last()
            .map(|g| g.0);
        assert_eq!(run.meeting_k(near_nm), want, "{near_nm} of {gap}");
    }
}

/// The second box against the first (RT-6).
#[test]
fn val_second_box_is_a_difference() {
    use cvtcycle_model::rig::transmission::{Plan, second_box};
    let c = cvtcycle_config::rig::load(&[]).unwrap().0;
    for two in second_box(&rover_bench(), &c, &Plan::from_conditions(&c)) {
        same(
            two.difference_nm(),
            two.second.answer.total_nm() - two.first.answer.total_nm(),
        );
    }
}

/// The variator rig: the belt at the slip that comes out, with an uncompensated cylinder and a film; limits from both sides; summary.
#[test]
fn val_variator_rig_from_its_parts() {
    use cvtcycle_model::rig::variator::{Held, Resolution, VariatorRig};
    use cvtcycle_model::transmission::cvt::variator::belt_state;
    let setup = car(
        "rover_216_cvt",
        &["transmission.cvt.variator.compensated=false"],
    );
    let rig = VariatorRig::new(&setup).unwrap();
    let (cvt, oil) = (rig.cvt(), setup.oils().0);
    let head =
        std::f64::consts::PI * oil.density_kg_m3(353.15) * (0.063f64.powi(4) - 0.030f64.powi(4))
            / 4.0; // VA-3
    near(cvt.centrifugal_n_s2, head, 1e-12);
    let held = Held {
        ratio: 0.6,
        pressure_pa: 12e5,
        input_rad_s: 180.0,
        belt_k: 80.0 + ZERO,
    };
    let at = BeltAtRatio::new(&cvt.belt, 0.6);
    for row in rig.rows(&held, &[-30.0, 0.0, 40.0, 60.0]) {
        let ws = 180.0 * (1.0 - row.belt.losses.slip_total) / 0.6;
        let l = BeltLoad {
            primary_speed_rad_s: 180.0,
            output_torque_nm: row.output_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(12e5, ws),
            ..BeltLoad::turning(&cvt.belt, oil, held.belt_k, 0.6, 180.0)
        };
        let want = belt_state(&cvt.belt, &at, &l);
        assert!(
            (want.losses.slip_total - row.belt.losses.slip_total).abs() < 1e-12
                && (want.losses.sum_nm() - row.belt.losses.sum_nm()).abs() < 1e-9
        );
        same(row.shaft_rad_s[1], ws);
        assert!(row.flags.is_fine() == row.flags.text().is_empty());
        let r = Resolution::new(&row, cvt.belt.length_m, cvt.belt.segment_thickness_m, 20.0);
        same(
            r.segments,
            row.belt_m_s * 10.0 / cvt.belt.segment_thickness_m,
        );
        same(r.belt_per_segment, 1.0 / r.segments);
        same(
            r.slip_per_pulse[1],
            1.0 / (ws * 10.0 / std::f64::consts::TAU * 20.0),
        );
    }
    let flags = |held: Held, nm: f64| rig.rows(&held, &[nm])[0].flags.text();
    let w = 100.0 * std::f64::consts::PI;
    let wide = Held {
        ratio: 1.5,
        pressure_pa: 39e5,
        ..held
    };
    for (input_rad_s, fast) in [
        (w * (1.0 + 0.9e-9), false),
        (w * (1.0 + 1.1e-9), true),
        (0.99 * w, false),
    ] {
        assert_eq!(
            flags(
                Held {
                    input_rad_s,
                    ..wide
                },
                10.0
            )
            .contains("rig_speed"),
            fast,
            "{input_rad_s}"
        );
    }
    // In high the secondary is the faster shaft.
    for (share, fast) in [(0.59, false), (0.61, true)] {
        assert_eq!(
            flags(
                Held {
                    input_rad_s: share * w,
                    pressure_pa: 39e5,
                    ..held
                },
                0.0
            )
            .contains("rig_speed"),
            fast,
            "{share}"
        );
    }
    let turns = |ratio: f64| {
        Resolution::new(
            &rig.rows(&Held { ratio, ..held }, &[5.0])[0],
            0.6486,
            1.46e-3,
            20.0,
        )
        .belt_turns
    };
    assert!(!turns(0.99) && turns(1.01));
    let summary = rig.summary(&wide);
    let three = summary.three_percent_nm;
    assert!(three > 0.0 && summary.three_percent_m_s == rig.rows(&wide, &[three])[0].slip_m_s());
    assert!(
        flags(
            Held {
                input_rad_s: 0.7 * w,
                ..held
            },
            10.0
        )
        .contains("rig_speed")
            && !flags(
                Held {
                    input_rad_s: 0.5 * w,
                    ..held
                },
                10.0
            )
            .contains("rig_speed")
    );
    for nm in [399.9, 400.1, -400.1, 300.0, 350.0, 380.0, -380.0] {
        let row = &rig.rows(&wide, &[nm])[0];
        assert_eq!(
            row.flags.text().contains("rig_output_torque"),
            nm.abs() > 400.0,
            "{nm}"
        );
        assert_eq!(
            row.flags.text().contains("rig_input_torque"),
            row.belt.input_torque_nm.abs() > 250.0,
            "{nm}"
        );
        assert!(!row.flags.is_fine() || nm.abs() < 400.0);
    }
    let near_limit = (1..4000).map(|k| 0.1 * f64::from(k)).filter(|nm| {
        let row = &rig.rows(&wide, &[*nm])[0];
        (250.0..262.0).contains(&row.belt.input_torque_nm)
            && row.flags.text().contains("rig_input_torque")
    });
    assert!(near_limit.count() > 5);
}
