//! Totals against the rows they were gathered from, with steps other than 1 s.
//!
//! Truth: a sum is the quantity of each row times its step, by phase; an extreme is the largest of the rows, at the end of the first row that has it.
#![allow(
    clippy::float_cmp,
    reason = "numbers that are handed on are promised exactly"
)]

use crate::common::{CARS, Keep, ZERO, car, cycle};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{
    EnergyTerms, PhaseTotals, Recorder, Row, State, TERM_NAMES, Totals, simulate,
};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::transmission::clamp_cause::ClampCause;
use cvtcycle_model::transmission::component::Component;

/// Keeps the rows of a drive and its totals.
struct Both {
    keep: Keep,
    totals: Totals,
}

impl Recorder for Both {
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        self.keep.record(row, terms);
        self.totals.record(row, terms);
    }
}

fn driven(setup: &Setup, cycle: &Cycle, dt_s: f64) -> (Keep, Totals) {
    let sim = setup.car(ZERO - 10.0);
    let mut both = Both {
        keep: Keep::default(),
        totals: Totals::new(cycle.phases.len()),
    };
    let trace = cycle.trace_for(sim.transmission.is_cvt());
    simulate(&sim, trace, dt_s, State::at(ZERO - 10.0), &mut both);
    (both.keep, both.totals)
}

/// Names and values of the sums of a phase.
fn sums(p: &PhaseTotals) -> Vec<(&'static str, f64)> {
    let mut list = vec![
        ("duration", p.duration_s),
        ("distance", p.distance_m),
        ("fuel", p.fuel_kg),
        ("standstill_fuel", p.standstill_fuel_kg),
        ("wheel_positive", p.wheel_positive_j),
        ("wheel_negative", p.wheel_negative_j),
    ];
    list.extend(Component::ALL.map(|c| (c.name(), p.loss_j[c])));
    list.extend(TERM_NAMES.into_iter().zip(p.terms.as_array()));
    list
}

/// Contribution of a row to the totals: means times the length of the step, and the sums that the row has.
fn parts(row: &Row, terms: &EnergyTerms) -> Vec<f64> {
    let dt_s = row.dt_s;
    let fuel_kg = row.fuel_kg_s * dt_s;
    let at_rest_kg = if row.speed_m_s > 0.0 { 0.0 } else { fuel_kg };
    let mut list = vec![
        dt_s,
        row.distance_m,
        fuel_kg,
        at_rest_kg,
        row.wheel_work_positive_j,
        row.wheel_work_negative_j,
    ];
    list.extend(Component::ALL.map(|c| row.loss_w[c] * dt_s));
    list.extend(terms.as_array().map(|term| term * dt_s));
    list
}

/// Property: energy, fuel, distance and time of each phase are the sums of the rows' values times their steps, at a step of 0.5 s and at one that does
/// not divide the second.
#[test]
fn sums_are_rows_times_steps() {
    for name in CARS {
        for dt_s in [0.5, 0.3] {
            let c = cycle("ece15_eudc");
            let (keep, totals) = driven(&car(name, &[]), &c, dt_s);
            assert!(keep.rows.iter().all(|row| row.dt_s < 0.6), "{name} {dt_s}");
            assert_eq!(totals.phases.len(), c.phases.len());
            let mut losses_j = 0.0;
            for (phase, found) in totals.phases.iter().enumerate() {
                let rows = || keep.rows.iter().zip(&keep.terms);
                for (k, (what, found)) in sums(found).into_iter().enumerate() {
                    let mut want = 0.0;
                    let mut scale = 0.0;
                    for (row, terms) in rows().filter(|(r, _)| usize::from(r.phase) == phase) {
                        let part = parts(row, terms)[k];
                        want += part;
                        scale += part.abs();
                    }
                    assert!(
                        (found - want).abs() <= 1e-12 * scale,
                        "{name} {dt_s} s, phase {phase}: {what} is {found}, its rows have {want}"
                    );
                }
                losses_j += found.terms.losses;
            }
            assert!(losses_j > 1e5, "{name}: {losses_j} J");
            let total = totals.total();
            assert!(
                (total.duration_s - c.trace_for(true).duration_s()).abs() < 1e-6,
                "{name}"
            );
            assert_eq!(totals.rows, keep.rows.len() as u64);
        }
    }
}

/// Property: times with a flag and with a cause of the pressure are the steps of the rows that have it; a cause counts where the car moves.
#[test]
fn times_are_those_of_the_rows() {
    let small = ["transmission.cvt.pump.displacement_cc_rev=5"];
    for (name, sets) in [(CARS[0], &small[..]), (CARS[1], &[])] {
        let (keep, totals) = driven(&car(name, sets), &cycle("us06"), 0.3);
        let seconds = |has: &dyn Fn(&Row) -> bool| {
            let rows = keep.rows.iter().filter(|row| has(row));
            rows.map(|row| row.dt_s).sum::<f64>()
        };
        let mut seen = 0;
        for (flag, word) in Flags::NAMES {
            let want = seconds(&|row| row.flags.contains(flag));
            let found = totals.seconds(flag);
            assert!(
                (found - want).abs() < 1e-6,
                "{name} {word}: {found} s, {want} s"
            );
            seen += u32::from(want > 0.0 && want < totals.total().duration_s);
        }
        assert!(seen > 1, "{name}: {seen} flags");
        for (cause, (_, word)) in ClampCause::NAMES.iter().enumerate() {
            let want = seconds(&|row| row.speed_m_s > 0.0 && row.clamp_cause as usize == cause);
            let found = totals.clamp_cause_s[cause];
            assert!(
                (found - want).abs() < 1e-6,
                "{name} {word}: {found} s, {want} s"
            );
        }
    }
}

/// Row at a time with a missed trace.
fn missed(time_s: f64, deficit_w: f64) -> Row {
    Row {
        time_s,
        deficit_w,
        wheel_torque_nm: 400.0,
        wheel_power_w: 2.0 * deficit_w,
        flags: Flags::FULL_LOAD,
        ..Row::default()
    }
}

/// Property: extremes are those of the rows, at the end of the first that has them; a row of a phase that the totals do not have counts in the last.
#[test]
fn extremes_are_those_of_the_first_row() {
    let mut totals = Totals::new(2);
    for (time_s, deficit_w) in [
        (1.0, 0.0),
        (2.0, 30.0),
        (3.0, 70.0),
        (4.0, 70.0),
        (5.0, 50.0),
    ] {
        let row = Row {
            phase: 7,
            fuel_kg_s: 0.25,
            dt_s: 2.0,
            ..missed(time_s, deficit_w)
        };
        totals.record(&row, &EnergyTerms::default());
    }
    let found = [
        totals.worst_deficit_w,
        totals.worst_deficit_nm,
        totals.worst_deficit_at_s,
        totals.phases[0].fuel_kg,
        totals.phases[1].fuel_kg,
    ];
    assert!(found == [70.0, 200.0, 3.0, 0.0, 2.5], "{found:?}");
    let safety = |time_s, clamp_safety| Row {
        time_s,
        clamp_safety,
        ..Row::default()
    };
    let mut totals = Totals::new(1);
    for (time_s, clamp_safety) in [(1.0, f64::INFINITY), (2.0, 1.2), (3.0, 1.2), (4.0, 1.3)] {
        totals.record(&safety(time_s, clamp_safety), &EnergyTerms::default());
    }
    let found = [totals.min_clamp_safety, totals.min_clamp_at_s];
    assert!(found == [1.2, 2.0], "{found:?}");
}
