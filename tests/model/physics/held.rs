//! Held steps (RC-12): ratio and clamp law from outside in place of the controller's.
//!
//! Truth: a car that chooses these ratios, or that has this law, by itself.

use crate::common::{ZERO, car, cycle};
use cvtcycle_model::drive::{Drive, Row, State};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Hold;
use cvtcycle_model::transmission::cvt::controller::ClampLaw;

const CVT: &str = "rover_216_cvt";

/// Rows by the car's own controller, then rows of another car that is held at their ratios under a law.
fn driven_and_held(
    sets: &[&str],
    held_sets: &[&str],
    clamp: Option<ClampLaw>,
) -> (Vec<Row>, Vec<Row>) {
    let (own, other) = (car(CVT, sets).car(ZERO), car(CVT, held_sets).car(ZERO));
    let cycle = cycle("ece15");
    let steps: Vec<_> = cycle.trace_for(true).steps(1.0).collect();
    let mut drive = Drive::new(&own, State::at(ZERO + 25.0));
    // The first step begins the box and has nothing to hold: both drives have it in common.
    drive.step(&steps[0]);
    let begun = drive.state();
    let mut ends = Vec::new();
    let rows: Vec<Row> = steps[1..]
        .iter()
        .map(|step| {
            let row = drive.step(step).0;
            ends.push(end_ratio(&drive));
            row
        })
        .collect();
    let mut drive = Drive::new(&other, begun);
    let held = steps[1..]
        .iter()
        .zip(rows.iter().zip(&ends))
        .map(|(step, (row, end))| {
            let hold = Hold {
                ratio: row.belt_ratio,
                clamp,
                end: Some(*end),
                paced: false,
            };
            drive.step_held(step, &hold).0
        });
    let held = held.collect();
    (rows, held)
}

/// Belt ratio at the end of the last step.
fn end_ratio(drive: &Drive) -> f64 {
    let own = drive.state().transmission.and_then(|own| own.cvt);
    own.expect("a CVT").shifting.ratio
}

fn assert_alike(rows: &[Row], held: &[Row]) {
    for (a, b) in rows.iter().zip(held) {
        for (name, x, y) in [
            ("fuel", a.fuel_kg_s, b.fuel_kg_s),
            ("speed", a.engine_speed_rad_s, b.engine_speed_rad_s),
            ("torque", a.engine_torque_nm, b.engine_torque_nm),
            ("pressure", a.secondary_pressure_pa, b.secondary_pressure_pa),
            ("sump", a.sump_k, b.sump_k),
        ] {
            let near = (x - y).abs() <= 1e-6 * (x.abs() + y.abs()) + 1e-12;
            assert!(near, "{name} at {} s: {x} {y}", a.time_s);
        }
        assert!(b.power_ledger_error < 1e-12 && b.heat_ledger_error < 1e-12);
    }
}

#[test]
fn a_car_held_at_its_own_ratios_is_that_car() {
    let (rows, held) = driven_and_held(&[], &[], None);
    assert_alike(&rows, &held);
    let moves = rows
        .windows(2)
        .filter(|w| w[0].belt_ratio > w[1].belt_ratio);
    assert!(moves.count() > 5, "the cycle shifts");
}

#[test]
fn a_held_clamp_law_is_the_law_of_a_car_that_has_it() {
    let following = ["transmission.cvt.clamp=torque_following"];
    let own = car(CVT, &following).car(ZERO);
    let Transmission::Cvt(cvt) = &own.transmission else {
        unreachable!("a CVT")
    };
    let law = cvt.clamp;
    assert!(matches!(law, ClampLaw::TorqueFollowing { .. }));
    let (rows, held) = driven_and_held(&following, &[], Some(law));
    assert_alike(&rows, &held);
}

/// At rest no ratio moves (RC-4), and a hold makes no other try where full load does not suffice (RC-7).
#[test]
fn a_hold_moves_nothing_at_rest_and_kicks_nothing_down() {
    let own = car(CVT, &["road_load.mass_kg=4000"]).car(ZERO);
    let cycle = cycle("ece15");
    let mut drive = Drive::new(&own, State::at(ZERO + 80.0));
    let high = Hold {
        ratio: 0.4137,
        clamp: None,
        end: None,
        paced: false,
    };
    let mut missed = 0;
    for step in cycle.trace_for(true).steps(1.0) {
        let (row, _) = drive.step_held(&step, &high);
        let rests = step.end_speed_m_s <= 0.0 && step.start_speed_m_s <= 0.0;
        let expected = if step.time_s < 11.5 { 2.4169 } else { 0.4137 };
        assert!(
            (row.belt_ratio - expected).abs() < 1e-12 || rests,
            "{}",
            row.belt_ratio
        );
        missed += usize::from(row.flags.contains(Flags::FULL_LOAD));
    }
    assert!(missed > 0);
}
