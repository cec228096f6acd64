//! The bench and its rows: RB-1 to RB-3, flags on both sides of their bounds, powers and efficiency; the same losses as in driving.

use super::{near, same};
use crate::common::bench_step::{Bench as StepBench, Setting};
use crate::common::{RPM, ZERO, car, loaded_point, rover_bench};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint, Parts};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::point::LIMIT_SLACK;
use cvtcycle_model::transmission::cvt::variator::{BeltAtRatio, BeltLoad, Formulation, belt_point};

/// Default settings of the rig: ratio 1, 2500 rpm, 75 degC, the shipped box, no load.
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
    let bench = rover_bench();
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
                seal_rings: true,
            };
            let pressure_pa = Some(15e5);
            let p = BenchPoint {
                output_nm,
                parts,
                pressure_pa,
                ratio: 0.8,
                ..loaded_point()
            };
            let a = bench.solve(&p);
            let slip = a.belt.unwrap().losses.slip_total;
            let ws = p.input_rad_s * (1.0 - slip) / 0.8;
            near(a.output_rad_s, ws / cvt.final_drive.ratio, 1e-9);
            let lost: f64 = a.loss_nm.iter().sum();
            near(
                a.input_nm,
                output_nm / cvt.final_drive.ratio * ws / p.input_rad_s + lost,
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
        ..loaded_point()
    });
    assert!(bare.output_rad_s == 0.0 && bare.belt_k.is_nan() && bare.belt.is_none());
    same(
        bare.input_nm,
        bare.part_nm(Component::Pump)
            + bare.part_nm(Component::InputShaft)
            + bare.part_nm(Component::ClutchDrag)
            + bare.primary_ring_nm,
    );
}

/// RB-2: the belt's temperature over the sump, from its loss.
#[test]
fn val_belt_warms_over_the_sump() {
    let bench = rover_bench();
    let p = BenchPoint {
        belt_k: None,
        sump_k: 60.0 + ZERO,
        ..loaded_point()
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
    let bench = rover_bench();
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
                ..loaded_point()
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
                ..loaded_point()
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
            ..loaded_point()
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
            let (at_input, oil) = (output_nm / overall, bench.car().oil.state(p.sump_k));
            let (parts, _) = m
                .engaged(gear, p.input_rad_s, at_input, (oil, p.sump_k))
                .losses_nm(at_input);
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
            ..loaded_point()
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
                .band(90.0 + ZERO, oil.dynamic_pa_s(90.0 + ZERO), [0.0; 2]),
            film_n: [0.0; 2],
            segment_friction: cvt.belt.formulation.segment_friction(oil.friction.segment),
            capacity_friction: oil.friction.capacity,
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
    let shipped = rover_bench().cvt().unwrap().belt.clone();
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
        let (high, low) = cvtcycle_model::rig::solvable_ratios(&belt);
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
        ..loaded_point()
    };
    let (a, car) = (bench.solve(&p), bench.car());
    same(a.belt_nm(), 4.0);
    same(
        a.belt_k - p.sump_k,
        car.belt_heat_share * 4.0 * p.input_rad_s / car.network.spray_now_w_k(p.input_rad_s),
    );
}

fn close(a: f64, b: f64, relative: f64, what: &str) {
    assert!(
        (a - b).abs() <= relative * (a.abs() + b.abs()) + 1e-12,
        "{what}: {a} {b}"
    );
}

/// Outside truth is the vehicle's own step, solved from the wheel: the bench at the torque and speed that the step found must give
/// the same losses, in drive and in overrun. The step reads the band friction at the sliding speed without slip, hence 5e-4.
#[test]
fn val_the_bench_loses_what_a_step_of_driving_loses() {
    let setup = car("rover_216_cvt", &[]);
    let step = StepBench::new(&setup);
    let bench = Bench::new(&setup);
    for (ratio, wheel_rad_s, wheel_nm) in [
        (2.3, 20.0, 400.0),
        (1.0, 40.0, 150.0),
        (0.5, 80.0, 80.0),
        (0.6, 60.0, -60.0),
        (1.5, 30.0, -40.0),
    ] {
        let s = Setting {
            ratio,
            wheel_rad_s,
            wheel_nm,
            ..Setting::default()
        };
        let drive = step.solve(&s);
        assert!(
            drive.engine_rad_s > 120.0,
            "the clutch must be locked, {ratio}"
        );
        let answer = bench.solve(&BenchPoint {
            ratio,
            input_rad_s: drive.engine_rad_s,
            // Torque that passed the output shaft: in overrun the brakes take a part.
            output_nm: drive.output_w / wheel_rad_s,
            pressure_pa: Some(drive.secondary_pa),
            sump_k: s.sump_degc + ZERO,
            belt_k: Some(s.belt_degc + ZERO),
            ..BenchPoint::default()
        });
        for component in Component::ALL {
            let driving = drive.loss_w[component] / drive.engine_rad_s;
            let rig = answer.part_nm(component);
            assert!(
                (driving - rig).abs() < 5e-4 * (1.0 + rig),
                "ratio {ratio}, {}: {driving} {rig}",
                component.name()
            );
        }
        assert!(
            (answer.input_nm - drive.shaft_nm).abs() < 3e-3,
            "ratio {ratio}: {} {}",
            answer.input_nm,
            drive.shaft_nm
        );
        assert_eq!(answer.flags.contains(Flags::OVERRUN), answer.input_nm < 0.0);
    }
}

/// Derived: power in is power out plus losses, in drive and overrun, and no loss is negative.
#[test]
fn the_books_close() {
    let setup = car("rover_216_cvt", &[]);
    let bench = Bench::new(&setup);
    for ratio in [0.42, 0.9, 1.0, 2.3] {
        for torque in [-300.0, -50.0, 0.0, 60.0, 400.0] {
            let p = BenchPoint {
                ratio,
                output_nm: torque,
                sump_k: 330.0,
                ..BenchPoint::default()
            };
            let a = bench.solve(&p);
            let (input, output) = (a.input_nm * p.input_rad_s, torque * a.output_rad_s);
            close(
                input,
                output + a.total_nm() * p.input_rad_s,
                1e-9,
                &format!("{ratio} {torque}"),
            );
            assert!(
                a.loss_nm.iter().all(|loss| *loss >= 0.0),
                "{ratio} {torque}: {:?}",
                a.loss_nm
            );
        }
    }
}

/// Hand calculation: 300 Nm at the wheels in third (overall 5.25) is 57.142857 Nm at the input; with the torque without load T_0 and the shares k
/// of the power that teeth and bearings lose, the teeth take their share of (57.142857 + T_0)/(1 - k) in drive, and of |T_0 - 57.142857| in overrun.
#[test]
fn val_manual_box_by_hand() {
    let bench = Bench::new(&car("rover_216_5mt", &[]));
    let at = |output_nm: f64| {
        bench.solve(&BenchPoint {
            ratio: 3.0,
            output_nm,
            ..BenchPoint::default()
        })
    };
    let Transmission::Manual(m) = &bench.car().transmission else {
        panic!("a manual box")
    };
    let oil = bench.car().oil.state(BenchPoint::default().sump_k);
    let train = m.trains[2].turning(2500.0 * RPM, 57.142_857, oil);
    let (t_0, k) = (train.no_load_nm(), train.share());
    assert!(t_0 > 0.5 && k > 0.01);
    let driven = train.mesh_share * (57.142_857_143 + t_0) / (1.0 - k);
    let driving = train.mesh_share * (57.142_857_143 - t_0);
    close(
        at(300.0).part_nm(Component::GearMesh),
        driven,
        1e-8,
        "drive",
    );
    close(
        at(-300.0).part_nm(Component::GearMesh),
        driving,
        1e-8,
        "overrun",
    );
    let idle = at(0.0);
    close(idle.total_nm(), t_0 / (1.0 - k), 1e-9, "no load");
    close(idle.input_nm, idle.total_nm(), 1e-12, "no load");
    assert!((at(300.0).input_nm - (300.0 / 5.25 + at(300.0).total_nm())).abs() < 1e-12);
    assert!((at(0.0).output_rad_s - 2500.0 * RPM / 5.25).abs() < 1e-9);
}

/// A point found by the torque at the input takes that torque, with the throttle that full load gives it, in both kinds of boxes.
#[test]
fn val_a_torque_at_the_input_is_met() {
    for (name, ratio) in [("rover_216_cvt", 0.8), ("rover_216_5mt", 3.0)] {
        let setup = car(name, &[]);
        let full_load_nm = setup.car(293.15).engine.full_load.at(2500.0 * RPM);
        let bench = Bench::new(&setup);
        for wanted_nm in [-20.0, 0.0, 60.0] {
            let asked = BenchPoint {
                ratio,
                throttle: 0.3,
                ..BenchPoint::default()
            };
            let found = bench.at_input_torque(&asked, wanted_nm);
            let got_nm = bench.solve(&found).input_nm;
            assert!(
                (got_nm - wanted_nm).abs() <= 1e-12 * (1.0 + wanted_nm.abs()),
                "{name}: {got_nm} instead of {wanted_nm}"
            );
            let throttle = match setup.car(293.15).transmission {
                Transmission::Cvt(_) => (wanted_nm / full_load_nm).max(0.0),
                Transmission::Manual(_) => 0.3,
            };
            same(found.throttle, throttle);
        }
    }
}
