//! Sensitivity of the fuel to each value.

use cvtcycle::analysis::sensitivity::{Named, sensitivity};
use cvtcycle::config::cycle::embedded;
use cvtcycle::config::setup::Options;
use cvtcycle::model::drive::{Conditions, Start};

/// Property: a larger loss costs fuel, a smaller one saves it, and the answer does not depend on the number of threads.
#[test]
fn a_larger_pump_costs_fuel_whatever_the_number_of_threads() {
    let cars = [Named {
        name: "car".into(),
        word: "rover_216_cvt".into(),
        options: Options::default(),
    }];
    let cycle = embedded("ece15").unwrap_or_else(|| unreachable!("shipped"));
    let conditions = Conditions {
        ambient_k: 263.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: true,
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap_or_else(|e| unreachable!("{e}"));
        pool.install(|| sensitivity(&cars, &cycle, &conditions))
            .unwrap_or_else(|p| unreachable!("{p:?}"))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one, three);
    let pump = one
        .effects
        .iter()
        .find(|e| e.key == "transmission.cvt.pump.displacement_cc_rev");
    let pump = pump.unwrap_or_else(|| unreachable!("the pump's size is a number"));
    let (Some(less), Some(more)) = (pump.lowered_percent, pump.raised_percent) else {
        unreachable!("both sides are cars")
    };
    assert!(
        less < 0.0 && more > 0.0 && (less + more).abs() < 0.5 * more,
        "{less} {more}"
    );
    // The unchanged car has zero effect: a value unused in this cycle changes nothing.
    assert!(one.effects.iter().any(|e| e.size_percent() < 1e-12));
}
