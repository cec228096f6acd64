//! The bench: the same losses as in driving, power balance, a manual box by hand.
use crate::common::bench_step::{Bench as StepBench, Setting};
use crate::common::{RPM, ZERO, car};
use cvtcycle_model::bench::{Bench, BenchPoint};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::component::Component;

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
            // What really passed the output shaft: in overrun the brakes take a part.
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

/// Hand calculation: 300 Nm at the wheels in third (overall 5.25) is 57.142857 Nm at the input, of which two meshes of 0.985 together lose
/// 57.142857 (1/0.985 - 1) = 0.870196 Nm; in overrun -57.142857 (0.985 - 1) = 0.857143 Nm.
#[test]
fn val_manual_box_by_hand() {
    let bench = Bench::new(&car(
        "rover_216_5mt",
        &["transmission.manual.mesh.efficiency=0.985"],
    ));
    let at = |output_nm: f64| {
        bench.solve(&BenchPoint {
            ratio: 3.0,
            output_nm,
            ..BenchPoint::default()
        })
    };
    assert!(
        (at(300.0).part_nm(Component::GearMesh) - 0.870_195_794).abs() < 1e-8,
        "{}",
        at(300.0).part_nm(Component::GearMesh)
    );
    assert!((at(-300.0).part_nm(Component::GearMesh) - 0.857_142_857).abs() < 1e-8);
    let idle = at(0.0);
    assert!(idle.part_nm(Component::GearMesh).abs() < 1e-15);
    close(idle.input_nm, idle.total_nm(), 1e-12, "no load");
    assert!((at(300.0).input_nm - (300.0 / 5.25 + at(300.0).total_nm())).abs() < 1e-12);
    assert!((at(0.0).output_rad_s - 2500.0 * RPM / 5.25).abs() < 1e-9);
}
