//! The selector at rest (SE-1 to SE-3), and the drag of the box inside a coast-down (RL-9).
//!
//! Truth: the definitions by hand; a car with that many newtons less on its rollers; both ledgers.

use crate::common::{Keep, ZERO, car, cycle, soak_rows, try_car};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Row, State, simulate};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::selector::{Selector, SelectorSignals};

const BY_CYCLE: &str = "transmission.cvt.selector.at_start=by_cycle";
const CONVERTER: &str = "transmission.cvt.launch.torque_converter.capacity_nm=27";

fn launch_w(row: &Row) -> f64 {
    row.loss_w[Component::LaunchClutch]
}

fn fuel_kg(rows: &[Row]) -> f64 {
    rows.iter().map(|row| row.fuel_kg_s * row.dt_s).sum()
}

/// SE-1, SE-2 by hand, with steps that the changes lie in.
#[test]
fn val_selector_by_hand() {
    let share = |by_cycle, neutral_after_s, running_s, rested_s, dt_s| {
        let selector = Selector {
            by_cycle,
            neutral_after_s,
        };
        selector.neutral_share(&SelectorSignals {
            procedure_s: 15.0,
            running_s,
            rested_s,
            dt_s,
        })
    };
    let never = f64::INFINITY;
    for (wanted, found) in [
        (1.0, share(true, never, 14.0, 14.0, 1.0)),
        (0.0, share(true, never, 15.0, 15.0, 1.0)),
        (0.25, share(true, never, 14.5, 14.5, 2.0)),
        (0.0, share(true, never, never, 0.0, 1.0)),
        (0.0, share(false, never, 0.0, 0.0, 1.0)),
        (0.0, share(false, 3.0, 0.0, 2.0, 1.0)),
        (0.75, share(false, 3.0, 0.0, 2.5, 2.0)),
        (1.0, share(true, 3.0, 90.0, 3.0, 1.0)),
    ] {
        assert!((wanted - found).abs() < 1e-15, "{wanted} {found}");
    }
}

/// SE-1, SE-3 on FTP75: no loss of the launch device in the first 15 s after both starts, all of it afterwards; on a cycle without such a procedure, and in
/// a car that is in drive at once, nothing changes.
#[test]
fn us_city_test_begins_in_neutral() {
    let ftp = cycle("ftp75");
    for launch in [None, Some(CONVERTER)] {
        let sets = |more: &[&'static str]| -> Vec<&str> {
            launch.into_iter().chain(more.iter().copied()).collect()
        };
        let rows = soak_rows(&car("rover_216_cvt", &sets(&[BY_CYCLE])), &ftp, -6.7).rows;
        let drive = soak_rows(&car("rover_216_cvt", &sets(&[])), &ftp, -6.7).rows;
        let hot_s = rows
            .windows(2)
            .find(|w| w[0].engine_speed_rad_s <= 0.0 && w[1].engine_speed_rad_s > 0.0)
            .expect("a second start")[0]
            .time_s;
        for from_s in [0.0, hot_s] {
            for (row, in_drive) in rows.iter().zip(&drive) {
                let after_s = row.time_s - from_s;
                if after_s > 0.0 && after_s <= 15.0 {
                    assert!(launch_w(row).abs() <= 0.0 && launch_w(in_drive) > 100.0);
                    assert!(row.fuel_kg_s < in_drive.fuel_kg_s, "{}", row.time_s);
                } else if after_s > 15.0 && after_s < 20.0 {
                    assert!(launch_w(row) > 100.0, "{}", row.time_s);
                }
            }
        }
        assert!(rows.iter().all(|row| row.power_ledger_error < 1e-12));
        let nedc = cycle("ece15_eudc");
        let [a, b] = [sets(&[BY_CYCLE]), sets(&[])]
            .map(|sets| fuel_kg(&soak_rows(&car("rover_216_cvt", &sets), &nedc, 25.0).rows));
        assert!((a - b).abs() <= 0.0);
    }
}

/// SE-2: neutral at long stops takes the creep away from its time on, saves fuel, whatever the step; the belt of a clutch behind the variator turns on.
#[test]
fn neutral_at_long_stops() {
    let urban = cycle("ece15");
    for place in ["input", "output"] {
        let place = format!("transmission.cvt.launch_at={place}");
        let neutral = |after_s: f64| -> Setup {
            let after = format!("transmission.cvt.selector.neutral_after_s={after_s}");
            car("rover_216_cvt", &[&place, &after])
        };
        let plain = fuel_kg(&soak_rows(&car("rover_216_cvt", &[&place]), &urban, 25.0).rows);
        let rows = soak_rows(&neutral(3.0), &urban, 25.0).rows;
        let mut rested_s = 0.0;
        for row in &rows {
            rested_s = if row.speed_m_s > 0.0 {
                0.0
            } else {
                rested_s + row.dt_s
            };
            if rested_s > 3.0 {
                assert!(launch_w(row).abs() <= 0.0, "{}", row.time_s);
            } else if rested_s > 0.0 {
                assert!(launch_w(row) > 100.0, "{}", row.time_s);
            }
            assert!(row.power_ledger_error < 1e-12 && row.heat_ledger_error < 1e-12);
        }
        let saved = 1.0 - fuel_kg(&rows) / plain;
        assert!((0.002..0.05).contains(&saved), "{place} {saved}");
        assert!(fuel_kg(&soak_rows(&neutral(0.0), &urban, 25.0).rows) < fuel_kg(&rows));
        let spent_j = |dt_s: f64| {
            let mut keep = Keep::default();
            let car = neutral(3.6).car(ZERO + 80.0);
            simulate(
                &car,
                urban.trace_for(true),
                dt_s,
                State::at(ZERO + 80.0),
                &mut keep,
            );
            let resting = keep.rows.iter().filter(|row| row.speed_m_s <= 0.0);
            resting.map(|row| launch_w(row) * row.dt_s).sum::<f64>()
        };
        assert!((spent_j(1.0) / spent_j(0.1) - 1.0).abs() < 1e-2);
    }
}

/// RL-9: what is taken off is taken off, coefficient by coefficient; a box with more drag than the target is refused.
#[test]
fn drag_inside_a_coast_down_is_taken_off() {
    let key = |name: &str, value: f64| format!("road_load.form.coefficients.{name}={value}");
    let at = |coefficients: [f64; 3], driveline: [f64; 3]| {
        let names = ["f0_n", "f1_n_per_kmh", "f2_n_per_kmh2"];
        let own = names.iter().zip(coefficients).map(|(name, x)| key(name, x));
        let box_names = names.map(|name| format!("driveline_{name}"));
        let of_box = box_names
            .iter()
            .zip(driveline)
            .map(|(name, x)| key(name, x));
        let sets: Vec<String> = own.chain(of_box).collect();
        try_car("civic_20_cvt", &sets)
    };
    let target = at([142.88, -0.5177, 0.033697], [27.0, -0.13, 0.001]).unwrap();
    let body = at([115.88, -0.3877, 0.032697], [0.0; 3]).unwrap();
    let hwfet = cycle("hwfet");
    let [a, b] = [&target, &body].map(|car| fuel_kg(&soak_rows(car, &hwfet, 24.0).rows));
    assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    let refused = at([20.0, 0.0, 0.03], [60.0, 0.0, 0.0]).unwrap_err();
    assert!(refused.contains("the road would push the car"), "{refused}");
}
