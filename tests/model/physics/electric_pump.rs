//! The electric oil pump: its power by hand, its books, and what it does to a car.

use crate::common::bench_step::{Bench, Setting};
use crate::common::{ZERO, at, car, cycle, soak_rows};
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Outcome, Start, drive};
use cvtcycle_model::transmission::component::Component;

const KIND: &str = "transmission.cvt.pump.kind.electric";

fn electric(sets: &[&str]) -> Setup {
    let own = [format!("{KIND}.efficiency=0.6")];
    let more = sets.iter().map(|set| match set.contains("transmission.") {
        true => (*set).to_owned(),
        false => format!("{KIND}.{set}"),
    });
    let all: Vec<String> = own.into_iter().chain(more).collect();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    car("rover_216_cvt", &all)
}

fn fuel(o: &Outcome) -> f64 {
    o.totals.total().fuel_kg
}

/// EP-2 on the bench: electric power is pressure times the flow that the circuit needs (PU-2) over the efficiency, and the engine gives that over
/// the alternator's; both shares do not depend on the engine's speed.
#[test]
fn val_power_by_hand() {
    let bench = Bench::new(&electric(&["alternator_efficiency=0.5"]));
    for (wheel_rad_s, wheel_nm, sump_degc) in
        [(30.0, 200.0, 60.0), (60.0, 80.0, 30.0), (0.0, 0.0, 80.0)]
    {
        let s = Setting {
            wheel_rad_s,
            wheel_nm,
            sump_degc,
            ..Setting::default()
        };
        let d = bench.solve(&s);
        let oil = &bench.car.oil;
        let eta = oil.kinematic_m2_s(sump_degc + ZERO) * oil.density_kg_m3(sump_degc + ZERO);
        let need = bench.cvt().pump.steady_need_m3_s(d.secondary_pa, eta);
        let pump = &bench.cvt().pump;
        let want_w = (d.secondary_pa + pump.line_drop_pa) * need / 0.6;
        let got_w = d.loss_w[Component::Pump];
        assert!((got_w / want_w - 1.0).abs() < 1e-6, "{got_w} for {want_w}");
        assert!((d.alternator_w / got_w - 1.0).abs() < 1e-12);
        assert!((d.oil_flow_m3_s / need - 1.0).abs() < 1e-6);
    }
}

/// A motor that is too slow is short of flow as a small pump is (PU-6); one that is fast enough does not feel its largest speed.
#[test]
fn val_a_slow_motor_limits_the_flow() {
    let ece = cycle("ece15_eudc");
    let run = |rpm: &str| drive(&electric(&[rpm]), &ece, &at(25.0, Start::Soak));
    let (slow, fast, faster) = (
        run("fastest_rpm=500"),
        run("fastest_rpm=4000"),
        run("fastest_rpm=6000"),
    );
    let limited = |o: &Outcome| o.totals.seconds(cvtcycle_model::flags::Flags::FLOW_LIMITED);
    println!(
        "flow limited {} {} {} s",
        limited(&slow),
        limited(&fast),
        limited(&faster)
    );
    assert!(limited(&slow) > 10.0 * limited(&fast));
    assert!((fuel(&fast) / fuel(&faster) - 1.0).abs() < 1e-3);
}

/// Contract: both ledgers close in every row; what the alternator loses is a term of its own and heats no oil.
#[test]
fn books_close_over_the_electric_pump() {
    for name in ["ece15_eudc", "us06"] {
        for degc in [-10.0, 25.0] {
            let o = soak_rows(
                &electric(&["alternator_efficiency=0.8"]),
                &cycle(name),
                degc,
            );
            for row in &o.rows {
                let place = format!("{name} {degc} {} s", row.time_s);
                assert!(
                    row.power_ledger_error < 1e-9,
                    "{place}: {}",
                    row.power_ledger_error
                );
                assert!(
                    row.heat_ledger_error < 1e-9,
                    "{place}: {}",
                    row.heat_ledger_error
                );
            }
            let t = o.totals.total();
            let pump_j = t.loss_j[Component::Pump];
            assert!((t.terms.electric_loss / (0.25 * pump_j) - 1.0).abs() < 1e-9);
        }
    }
}

/// The same load by another way: a car whose pump costs nothing and whose alternator gives the pump's mean power burns the same within 0.5 %, its oil
/// being heated by less. Better motors and alternators burn less.
#[test]
fn the_same_load_at_the_alternator() {
    let ece = cycle("ece15_eudc");
    let warm = at(25.0, Start::At(85.0 + ZERO));
    let o = drive(&electric(&[]), &ece, &warm);
    let t = o.totals.total();
    let mean_w = (t.loss_j[Component::Pump] + t.terms.electric_loss) / t.duration_s;
    let plain = car("rover_216_cvt", &[]).engine().electrical_w;
    let other = car(
        "rover_216_cvt",
        &[
            "transmission.cvt.loss_factor.pump=0",
            &format!("engine.electrical_w={}", plain + mean_w),
        ],
    );
    let moved = fuel(&drive(&other, &ece, &warm)) / fuel(&o) - 1.0;
    let fixed = drive(&car("rover_216_cvt", &[]), &ece, &warm);
    println!(
        "{mean_w} W; {:.3} % apart; {:.2} % of the fixed pump's fuel",
        100.0 * moved,
        100.0 * fuel(&o) / fuel(&fixed)
    );
    assert!(moved.abs() < 0.005);
    let run = |set: &str| fuel(&drive(&electric(&[set]), &ece, &warm));
    assert!(run("efficiency=0.75") < fuel(&o) && run("alternator_efficiency=0.8") < fuel(&o));
}
