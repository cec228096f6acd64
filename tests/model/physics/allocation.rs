//! The loop does not allocate: counted with a counting allocator, alone in its program.

use crate::common::{CARS, ZERO, car, cycle};
use cvtcycle_model::drive::{EnergyTerms, Row, Totals};
use cvtcycle_model::drive::{Recorder, State, simulate};

/// Keeps rows within a capacity that was reserved before.
struct Reserved {
    rows: Vec<Row>,
    totals: Totals,
}

impl Recorder for Reserved {
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        self.rows.push(*row);
        self.totals.record(row, terms);
    }
}

/// Property: not one allocation from the first step of a cycle to its last, with totals and rows kept, for every car.
#[test]
fn no_allocation_between_the_first_step_and_the_last() {
    for name in CARS {
        let setup = car(name, &[]);
        for cycle_name in ["ece15_eudc", "ftp75", "us06", "wltc_class3b"] {
            let c = cycle(cycle_name);
            let sim = setup.car(ZERO - 10.0);
            let trace = c.trace_for(sim.transmission.is_cvt());
            let mut keep = Reserved {
                rows: Vec::with_capacity(trace.step_count(1.0)),
                totals: Totals::new(c.phases.len()),
            };
            let counted = allocation_counter::measure(|| {
                simulate(&sim, trace, 1.0, State::at(ZERO - 10.0), &mut keep);
            });
            assert!(!keep.rows.is_empty());
            assert_eq!(counted.count_total, 0, "{name} {cycle_name}: {counted:?}");
        }
    }
    // The counter counts.
    assert!(
        allocation_counter::measure(|| drop(std::hint::black_box(vec![1u8; 100]))).count_total > 0
    );
}
