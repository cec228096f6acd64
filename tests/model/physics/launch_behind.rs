//! The launch clutch behind the variator (LO-1 to LO-4).
//!
//! Truth: the same car with its clutch at the input, which it is while the clutch is locked; statics and power by hand at rest; both ledgers and
//! the independent checks of physics.

use crate::common::bench_step::{Bench, Setting};
use crate::common::{Keep, RPM, ZERO, car, cycle, larger, soak_rows};
use cvtcycle_config::cycle::read_csv;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::cycle::Cycle;
use cvtcycle_model::drive::{Row, State, check_physics, simulate};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::component::Component;

const BEHIND: &str = "transmission.cvt.launch_at=output";

fn behind(sets: &[&str]) -> Setup {
    let all: Vec<&str> = [BEHIND].iter().chain(sets).copied().collect();
    car("rover_216_cvt", &all)
}

/// A drive from rest to 50 km/h, a stop that the shift rate cannot follow, and ten seconds of rest before the next start.
fn hard_stop() -> Cycle {
    let text = "time_s,speed_kmh\n0,0\n5,0\n20,50\n60,50\n62.5,0\n75,0\n90,50\n100,50\n";
    read_csv("hard_stop.csv", text.as_bytes()).expect("a cycle")
}

fn belt_w(row: &Row) -> f64 {
    let parts = Component::ALL.into_iter().filter(|part| part.is_belt());
    parts.map(|part| row.loss_w[part]).sum()
}

/// LO-2, LO-3: locked, the place of the clutch changes nothing, to the rounding of sums in another order.
#[test]
fn locked_it_is_the_clutch_at_the_input() {
    let [input, output] = [car("rover_216_cvt", &[]), behind(&[])].map(|car| Bench::new(&car));
    for ratio in [0.45, 1.0, 2.2] {
        for wheel_nm in [-150.0, -20.0, 40.0, 400.0, 5000.0] {
            for sump_degc in [-10.0, 80.0] {
                let s = Setting {
                    ratio,
                    wheel_rad_s: 60.0,
                    wheel_nm,
                    sump_degc,
                    ..Setting::default()
                };
                let (a, b) = (input.solve(&s), output.solve(&s));
                assert!(!b.flags.contains(Flags::CLUTCH_SLIPPING), "{s:?}");
                let pairs = [
                    (a.engine_rad_s, b.engine_rad_s),
                    (a.shaft_nm, b.shaft_nm),
                    (a.secondary_pa, b.secondary_pa),
                    (a.slip, b.slip),
                    (a.output_w, b.output_w),
                    (a.brake_w, b.brake_w),
                    (a.secondary_nm, b.secondary_nm),
                ];
                let losses = Component::ALL.map(|part| (a.loss_w[part], b.loss_w[part]));
                for (x, y) in pairs.into_iter().chain(losses) {
                    let near = (x - y).abs() <= 1e-9 * (x.abs() + y.abs()) + 1e-9;
                    assert!(near, "{x} {y} at {s:?}");
                }
            }
        }
    }
}

/// LO-4: at rest belt and pulleys turn with the idling engine and lose; the clutch takes creep torque at idle speed; all losses together are what the
/// engine gives. A belt behind its clutch is at rest.
#[test]
fn at_rest_the_belt_turns_and_loses() {
    let idle = cycle("ece15");
    for (setup, turns) in [(car("rover_216_cvt", &[]), false), (behind(&[]), true)] {
        let rows = soak_rows(&setup, &idle, 25.0).rows;
        let resting: Vec<&Row> = rows.iter().filter(|row| row.speed_m_s <= 0.0).collect();
        assert!(resting.len() > 30);
        for row in resting {
            assert_eq!(
                belt_w(row) > 10.0,
                turns,
                "{} s: {}",
                row.time_s,
                belt_w(row)
            );
            let [drag_w, shaft_w] =
                [Component::ClutchDrag, Component::FinalDrive].map(|part| row.loss_w[part]);
            assert!((drag_w > 0.0) == turns && shaft_w.abs() <= 0.0);
            let creep_w = 5.0 * row.engine_speed_rad_s;
            let clutch_w = row.loss_w[Component::LaunchClutch];
            assert!(
                (clutch_w / creep_w - 1.0).abs() < 1e-8, // the solve leaves 1e-7 of pressure and slip
                "{} s: {clutch_w} W, {creep_w} W, {} W of {} rad/s",
                row.time_s,
                row.kinetic_w,
                row.engine_speed_rad_s
            );
            let lost_w: f64 = row.loss_w.iter().sum();
            let given_w = row.engine_torque_nm * row.engine_speed_rad_s;
            assert!((lost_w / given_w - 1.0).abs() < 1e-12, "{lost_w} {given_w}");
        }
    }
}

/// LO-4, RC-4: after a stop that the shift cannot follow, the ratio goes to low at rest, and the car pulls away in low; with the clutch at the input
/// it pulls away as it stopped.
#[test]
fn ratio_returns_to_low_at_rest() {
    let stop = hard_stop();
    let at = |rows: &[Row], time_s: f64| {
        let near = rows.iter().find(|row| row.time_s >= time_s);
        near.expect("a row").belt_ratio
    };
    let slow = "transmission.cvt.ratio.down_per_s=0.3";
    let input = soak_rows(&car("rover_216_cvt", &[slow]), &stop, 25.0).rows;
    let output = soak_rows(&behind(&[slow]), &stop, 25.0).rows;
    let low = at(&input, 1.0);
    assert!(at(&input, 63.0) < 0.9 * low && at(&output, 63.0) < 0.9 * low);
    assert!((at(&input, 75.0) - at(&input, 63.0)).abs() < 1e-12);
    assert!((at(&output, 75.0) / low - 1.0).abs() < 1e-12);
    let late = |rows: &[Row]| {
        let flag = |row: &&Row| row.flags.contains(Flags::LAUNCH_NOT_IN_LOW);
        rows.iter().filter(flag).count()
    };
    assert!(late(&input) > 0 && late(&output) == 0);
}

/// Both ledgers close in every row, solves converge and no loss is negative; the car uses more than with its clutch at the input.
#[test]
fn books_close_behind_the_variator() {
    for sets in [
        &[][..],
        &["transmission.cvt.clamp=torque_following"],
        &["transmission.cvt.loss_factor.launch_clutch=0"],
        &[
            "transmission.cvt.loss_factor.belt_band=0",
            "transmission.cvt.launch.friction_clutch.creep_nm=0",
        ],
    ] {
        let setup = behind(sets);
        for (name, degc, dt_s) in [
            ("ece15_eudc", -20.0, 1.0),
            ("us06", 25.0, 1.0),
            ("ftp75", 25.0, 0.2),
        ] {
            let mut keep = Keep::default();
            let c = cycle(name);
            simulate(
                &setup.car(ZERO + degc),
                c.trace_for(true),
                dt_s,
                State::at(ZERO + degc),
                &mut keep,
            );
            for row in &keep.rows {
                let place = format!("{sets:?} {name} {degc} {} s", row.time_s);
                assert!(
                    row.power_ledger_error < 1e-12,
                    "{place} {}",
                    row.power_ledger_error
                );
                assert!(row.heat_ledger_error < 1e-12, "{place}");
                assert!(!row.flags.contains(Flags::NOT_CONVERGED), "{place}");
                assert!(
                    row.loss_w.iter().all(|w| *w >= 0.0),
                    "{place} {:?}",
                    row.loss_w
                );
            }
        }
    }
    let urban = cycle("ece15");
    let fuel = |setup: &Setup| {
        let rows = soak_rows(setup, &urban, 25.0).rows;
        rows.iter().map(|r| r.fuel_kg_s * r.dt_s).sum::<f64>()
    };
    assert!(fuel(&behind(&[])) > 1.01 * fuel(&car("rover_216_cvt", &[])));
}

/// PX-1 to PX-8, which share no code with the solve.
#[test]
fn physics_checks_hold_behind_the_variator() {
    for degc in [-10.0, 25.0] {
        for found in check_physics(&behind(&[]), &cycle("ece15_eudc"), degc + ZERO, 1.0) {
            assert!(found.holds(), "{degc}: {found:?}");
        }
    }
}

/// The clutch closes, creeps and lets go without a step: torque at the flywheel and loss of the clutch in a slow launch and stop, from one hundredth of a
/// second to the next.
#[test]
fn launch_behind_is_continuous() {
    let text = "time_s,speed_kmh\n0,0\n2,0\n42,30\n60,30\n100,0\n104,0\n";
    let slow = read_csv("slow.csv", text.as_bytes()).expect("a cycle");
    let worst = |setup: &Setup| {
        let mut keep = Keep::default();
        let sim = setup.car(ZERO + 60.0);
        simulate(
            &sim,
            slow.trace_for(true),
            0.01,
            State::at(ZERO + 60.0),
            &mut keep,
        );
        let steps = keep.rows[200..].windows(2).map(|w| {
            let apart = |f: fn(&Row) -> f64| (f(&w[1]) - f(&w[0])).abs();
            [
                apart(|row| row.engine_torque_nm),
                apart(|row| row.engine_speed_rad_s / RPM),
                apart(|row| row.loss_w[Component::LaunchClutch]) / 100.0,
            ]
        });
        steps.fold([0.0; 3], |most: [f64; 3], step| {
            [0, 1, 2].map(|i| larger(step[i], most[i]))
        })
    };
    let (input, output) = (worst(&car("rover_216_cvt", &[])), worst(&behind(&[])));
    for i in 0..3 {
        assert!(output[i] < 1.5 * input[i] + 1.0, "{input:?} {output:?}");
    }
}
