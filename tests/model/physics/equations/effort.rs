//! What the solve costs and leaves: a wrong slope, guess or bound of the iteration still ends at the same fixed point, later.
//!
//! Truth of the counts: today's program, frozen; they fall when the solve gets better, and are then written down anew.

use crate::common::{CARS, Keep, ZERO, car, cycle, hill};
use cvtcycle_model::drive::{State, simulate};

/// Evaluations of the driveline over a cycle, the most in a row, and the largest residual.
fn effort(name: &str, cycle_name: &str, degc: f64) -> (u32, u16, f64) {
    let setup = car(name, &[]);
    let car = setup.car(degc + ZERO);
    let cycle = if cycle_name == "hill" {
        hill()
    } else {
        cycle(cycle_name)
    };
    let mut keep = Keep::default();
    simulate(
        &car,
        cycle.trace_for(car.transmission.is_cvt()),
        1.0,
        State::at(car.ambient_k),
        &mut keep,
    );
    let rows = &keep.rows;
    let most = rows.iter().map(|r| r.iterations).max().unwrap();
    let left = rows
        .iter()
        .map(|r| r.solve_residual)
        .fold(0.0, |a: f64, b| if b > a { b } else { a });
    (
        rows.iter().map(|r| u32::from(r.iterations)).sum(),
        most,
        left,
    )
}

#[test]
fn evaluations_of_the_solve() {
    let frozen = [
        (CARS[0], "ece15_eudc", -10.0, 2696, 8),
        (CARS[0], "ftp75", 25.0, 5679, 9),
        (CARS[0], "hill", 60.0, 372, 7),
        (CARS[1], "hill", 20.0, 278, 7),
    ];
    let got = frozen.map(|(name, cycle, degc, ..)| {
        let (sum, most, left) = effort(name, cycle, degc);
        assert!(left <= 1e-7, "{name} {cycle}: {left}");
        (name, cycle, degc, sum, most)
    });
    assert_eq!(got, frozen);
}
