//! The bench and its rows: RB-1, RB-2, RB-3, flags on both sides of their bounds, powers and efficiency.

use super::{near, same};
use crate::common::{RPM, ZERO, car};
use cvtcycle_config::Override;
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::bench::{Bench, BenchAnswer, BenchPoint, Parts};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, METAL, NODES, SUMP};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::point::LIMIT_SLACK;
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, Formulation, belt_point};

fn bench() -> Bench {
    Bench::new(&car("rover_216_cvt", &[]))
}

fn point() -> BenchPoint {
    BenchPoint {
        output_nm: 200.0,
        throttle: 0.3,
        belt_k: Some(90.0 + ZERO),
        ..BenchPoint::default()
    }
}

/// What a bench is set to where nothing is said: ratio 1, 2500 rpm, 75 degC, the shipped box, no load.
#[test]
fn defaults_of_the_bench() {
    let p = BenchPoint::default();
    assert!(
        p.ratio == 1.0
            && p.output_nm == 0.0
            && p.throttle == 0.0
            && p.pressure_factor == 1.0
            && p.sump_k == 348.15
            && p.parts == Parts::ALL
    );
    same(p.input_rad_s, 2500.0 * RPM);
    same(
        Bench::new(&car("rover_216_cvt", &[])).car().ambient_k,
        293.15,
    );
}

/// RB-1: the sum over the parts, with the box complete and with parts taken out; speeds and slip at the output.
#[test]
fn val_bench_torques_add_up() {
    let bench = bench();
    let cvt = bench.cvt().unwrap();
    for (final_drive, pump, reverse_clutch) in [
        (true, true, true),
        (false, true, true),
        (true, false, true),
        (true, true, false),
    ] {
        for output_nm in [-150.0, 0.0, 300.0] {
            let parts = Parts {
                final_drive,
                belt: true,
                reverse_clutch,
                pump,
            };
            let pressure_pa = Some(15e5);
            let p = BenchPoint {
                output_nm,
                parts,
                pressure_pa,
                ratio: 0.8,
                ..point()
            };
            let a = bench.solve(&p);
            let slip = a.belt.unwrap().losses.slip_total;
            let ws = p.input_rad_s * (1.0 - slip) / 0.8;
            near(a.output_rad_s, ws / cvt.final_drive, 1e-9);
            let lost: f64 = a.loss_nm.iter().sum();
            near(
                a.input_nm,
                output_nm / cvt.final_drive * ws / p.input_rad_s + lost,
                1e-9,
            );
            same(a.total_nm(), lost);
            assert_eq!(a.part_nm(Component::FinalDrive) == 0.0, !final_drive);
            assert_eq!(a.part_nm(Component::Pump) == 0.0, !pump);
            assert_eq!(a.part_nm(Component::ClutchDrag) == 0.0, !reverse_clutch);
            assert!(if pump {
                a.secondary_pa == 15e5
            } else {
                a.secondary_pa.is_nan()
            });
        }
    }
    let bare = bench.solve(&BenchPoint {
        parts: Parts {
            belt: false,
            ..Parts::ALL
        },
        ..point()
    });
    assert!(bare.output_rad_s == 0.0 && bare.belt_k.is_nan() && bare.belt.is_none());
    same(
        bare.input_nm,
        bare.part_nm(Component::Pump)
            + bare.part_nm(Component::InputShaft)
            + bare.part_nm(Component::ClutchDrag),
    );
}

/// RB-2: the belt's temperature over the sump, from its loss.
#[test]
fn val_belt_warms_over_the_sump() {
    let bench = bench();
    let p = BenchPoint {
        belt_k: None,
        sump_k: 60.0 + ZERO,
        ..point()
    };
    let a = bench.solve(&p);
    let car = bench.car();
    let rise = car.belt_heat_share * a.belt_nm() * p.input_rad_s
        / car.network.spray_now_w_k(p.input_rad_s);
    assert!(
        rise > 1.0 && (a.belt_k - p.sump_k - rise).abs() < 1e-6,
        "{} {rise}",
        a.belt_k - p.sump_k
    );
}

fn flag(a: &BenchAnswer, flag: Flags) -> bool {
    a.flags.contains(flag)
}

/// Flags of the bench: each bound from both sides, each cause by itself.
#[test]
fn flags_of_the_bench() {
    let bench = bench();
    let cvt = bench.cvt().unwrap();
    let outside = |p: BenchPoint| flag(&bench.solve(&p), Flags::OUTSIDE_VALIDITY);
    let (low, high) = (cvt.ratio.low, cvt.ratio.high);
    for (ratio, want) in [
        (low * (1.0 + 0.99 * LIMIT_SLACK), false),
        (low * (1.0 + 1.01 * LIMIT_SLACK), true),
        (high * (1.0 - 0.99 * LIMIT_SLACK), false),
        (high * (1.0 - 1.01 * LIMIT_SLACK), true),
    ] {
        assert_eq!(
            outside(BenchPoint {
                ratio,
                output_nm: 0.0,
                ..point()
            }),
            want,
            "{ratio}"
        );
    }
    same(LIMIT_SLACK, 1e-3);
    for (sump, belt, want) in [
        (60.0, 90.0, false),
        (-41.0, 20.0, true),
        (20.0, 161.0, true),
        (20.0, 159.0, false),
        (-39.0, -39.0, false),
    ] {
        assert_eq!(
            outside(BenchPoint {
                sump_k: sump + ZERO,
                belt_k: Some(belt + ZERO),
                ..point()
            }),
            want,
            "{sump} {belt}"
        );
    }
    for output_nm in [
        -3000.0, -900.0, -100.0, -20.0, -3.0, 3.0, 100.0, 900.0, 3000.0,
    ] {
        let a = bench.solve(&BenchPoint {
            output_nm,
            pressure_pa: Some(8e5),
            ..point()
        });
        let belt = a.belt.unwrap();
        let secondary =
            (belt.input_torque_nm - belt.losses.sum_nm()) / (1.0 - belt.losses.slip_total);
        assert_eq!(
            flag(&a, Flags::LOW_CLAMP),
            belt.losses.capacity_nm < secondary.abs(),
            "{output_nm}"
        );
        assert_eq!(flag(&a, Flags::OVERRUN), a.input_nm < 0.0);
        assert_eq!(flag(&a, Flags::GROSS_SLIP), belt.losses.gross_slip);
        assert!(!flag(&a, Flags::NOT_CONVERGED) || belt.losses.gross_slip);
    }
}

/// RB-3 and its flags.
#[test]
fn val_manual_box_on_the_bench() {
    let bench = Bench::new(&car("rover_216_5mt", &[]));
    let Transmission::Manual(m) = &bench.car().transmission else {
        panic!("a manual box")
    };
    for gear in [1u8, 4] {
        for (output_nm, degc) in [
            (-300.0, 60.0),
            (0.0, 159.0),
            (400.0, 161.0),
            (-2.0, -39.0),
            (90.0, -41.0),
        ] {
            let p = BenchPoint {
                ratio: f64::from(gear),
                output_nm,
                sump_k: degc + ZERO,
                ..BenchPoint::default()
            };
            let (a, overall) = (bench.solve(&p), m.overall[usize::from(gear) - 1]);
            let nu = bench.car().oil.kinematic_m2_s(p.sump_k);
            let (parts, _) =
                m.part_losses_nm(gear, p.input_rad_s, output_nm / overall, nu, p.sump_k);
            near(
                a.input_nm + 100.0,
                output_nm / overall + parts.iter().map(|x| x.1).sum::<f64>() + 100.0,
                1e-12,
            );
            parts
                .iter()
                .for_each(|(part, nm)| same(a.part_nm(*part), *nm));
            same(a.output_rad_s, p.input_rad_s / overall);
            assert_eq!(flag(&a, Flags::OVERRUN), a.input_nm < 0.0);
            assert_eq!(
                flag(&a, Flags::OUTSIDE_VALIDITY),
                !(-40.0..=160.0).contains(&degc)
            );
        }
    }
}

/// The printed forms on the bench: slip shares are the printed speeds over the belt's.
#[test]
fn val_printed_slip_on_the_bench() {
    for formulation in [Formulation::AppendixC, Formulation::Chapter8] {
        let setup = load(
            "rover_216_cvt",
            &Options {
                formulation,
                ..Options::default()
            },
        )
        .unwrap();
        let bench = Bench::as_printed(&setup);
        let cvt = bench.cvt().unwrap();
        let p = BenchPoint {
            ratio: 2.0,
            output_nm: 350.0,
            pressure_pa: Some(25e5),
            ..point()
        };
        let (a, oil) = (bench.solve(&p), &bench.car().oil);
        let belt = a.belt.unwrap();
        let ws = p.input_rad_s * (1.0 - belt.losses.slip_total) / 2.0;
        let secondary_nm =
            (belt.input_torque_nm - belt.losses.sum_nm()) * 2.0 / (1.0 - belt.losses.slip_total);
        let l = BeltLoad {
            primary_speed_rad_s: p.input_rad_s,
            output_torque_nm: secondary_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(25e5, ws),
            band: oil
                .friction
                .band(90.0 + ZERO, oil.dynamic_pa_s(90.0 + ZERO), 0.0),
            eta_pa_s: oil.dynamic_pa_s(90.0 + ZERO),
            film_thickness_m: oil.friction.film_thickness_m,
            segment_friction: cvt.belt.formulation.segment_friction(oil.friction.segment),
            flank_friction: oil.friction.flank,
        };
        let printed = belt_point(&cvt.belt, &BeltAtRatio::new(&cvt.belt, 2.0), &l);
        let v = printed.belt_speed_m_s;
        near(v, p.input_rad_s * printed.geometry.primary_radius_m, 1e-12);
        near(belt.slip.gap, printed.gap_slip_m_s / v, 1e-9);
        near(belt.slip.idle, printed.idle_slip_m_s / v, 1e-9);
        near(belt.slip.primary, printed.slip_m_s[0] / v, 1e-9);
        near(belt.slip.secondary, printed.slip_m_s[1] / v, 1e-9);
        assert!(!belt.slip.held);
        let lost: f64 = [
            printed.band_loss_nm,
            printed.slip_loss_nm,
            printed.wedge_loss_nm,
            printed.penetration_loss_nm,
        ]
        .iter()
        .flatten()
        .sum();
        near(printed.loss_nm, lost, 1e-12);
        near(
            printed.input_torque_nm,
            secondary_nm / 2.0 * (1.0 - printed.slip_total) + lost,
            1e-12,
        ); // VA-1
        near(belt.losses.sum_nm(), lost, 1e-9);
    }
}

/// Ends of the ratio that the geometry allows: at the third digit inside the belt fits, at the next one outside it does not.
#[test]
fn val_solvable_ratios_are_the_last_that_fit() {
    let shipped = bench().cvt().unwrap().belt.clone();
    for (centre, length) in [
        (shipped.centre_distance_m, shipped.length_m),
        (0.155, 0.45),
        (0.3, 0.66),
        (0.3, 0.62),
        (0.155, 0.325),
    ] {
        let belt = cvtcycle_model::transmission::cvt::variator::Belt {
            centre_distance_m: centre,
            length_m: length,
            ..shipped.clone()
        };
        let fits = |ratio: f64| {
            let g =
                cvtcycle_model::transmission::cvt::variator::Geometry::new(ratio, centre, length);
            let (p, s) = (
                g.primary_radius_m * g.primary_wrap_rad,
                g.secondary_radius_m * g.secondary_wrap_rad,
            );
            let pitch = belt.segment_thickness_m;
            p >= pitch && s >= pitch && (p + s + 2.0 * g.strut_m - length).abs() <= 1e-9 * length
        };
        let (high, low) = cvtcycle_model::bench::solvable_ratios(&belt);
        assert!(
            (0.05..=1.0).contains(&high) && (1.0..=20.0).contains(&low),
            "{high} {low}"
        );
        for (edge, out, end) in [(high, -1e-3, 0.05), (low, 1e-3, 20.0)] {
            assert!(fits(edge), "{edge} of {centre} {length}");
            assert!(
                !fits(edge + out) || (edge - end).abs() < 1e-12,
                "{} of {centre} {length}",
                edge + out
            );
            assert!(((edge * 1e3).round() / 1e3 - edge).abs() < 1e-12);
        }
    }
}

/// A transient of the transmission rig: energies from its own seconds, the branches between them, the gap and where it is widest.
#[test]
fn val_transient_from_its_seconds() {
    use cvtcycle_model::bench::transmission::{Branch, transient};
    let (bench, mut c) = (
        bench(),
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
    let network = cvtcycle_model::bench::transmission::on_the_rig(&car.network);
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
        let shaft = m.answer.part_nm(Component::InputShaft);
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
    use cvtcycle_model::bench::transmission::{Plan, second_box};
    let c = cvtcycle_config::rig::load(&[]).unwrap().0;
    for two in second_box(&bench(), &c, &Plan::of(&c)) {
        same(
            two.difference_nm(),
            two.second.answer.total_nm() - two.first.answer.total_nm(),
        );
    }
}

/// The variator rig: the belt at the slip that comes out, with an uncompensated cylinder and a film; limits from both sides; summary.
#[test]
fn val_variator_rig_from_its_parts() {
    use cvtcycle_model::bench::variator::{Held, Resolution, VariatorRig};
    use cvtcycle_model::transmission::cvt::variator::{belt_state, sliding_speed_m_s};
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
        let eta = oil.dynamic_pa_s(held.belt_k);
        let l = BeltLoad {
            primary_speed_rad_s: 180.0,
            output_torque_nm: row.output_nm,
            secondary_clamp_n: cvt.secondary_clamp_n(12e5, ws),
            band: oil
                .friction
                .band(held.belt_k, eta, sliding_speed_m_s(&cvt.belt, 0.6, 180.0)),
            eta_pa_s: eta,
            film_thickness_m: oil.friction.film_thickness_m,
            segment_friction: oil.friction.segment,
            flank_friction: oil.friction.flank,
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

/// RB-2 with a measured belt: its loss warms the belt as the model's would.
#[test]
fn val_a_mapped_belt_warms_over_the_sump() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    std::fs::write(
        &file,
        include_str!("../../../../vehicles/rover_216_cvt.toml"),
    )
    .unwrap();
    std::fs::write(
        folder.path().join("map.csv"),
        "ratio,oil_temp_degc,torque_loss_nm\n0.4,0,4\n0.4,90,4\n2.5,0,4\n2.5,90,4\n",
    )
    .unwrap();
    let set = vec!["transmission.cvt.maps.belt=map.csv".parse().unwrap()];
    let setup = load(
        file.to_str().unwrap(),
        &Options {
            set,
            ..Options::default()
        },
    )
    .unwrap();
    let bench = Bench::new(&setup);
    let p = BenchPoint {
        belt_k: None,
        sump_k: 60.0 + ZERO,
        ..point()
    };
    let (a, car) = (bench.solve(&p), bench.car());
    same(a.belt_nm(), 4.0);
    same(
        a.belt_k - p.sump_k,
        car.belt_heat_share * 4.0 * p.input_rad_s / car.network.spray_now_w_k(p.input_rad_s),
    );
}
