use cvtcycle::run::*;
use cvtcycle::setup::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let cycle_name = args.get(1).map_or("ece15_eudc", |s| s.as_str());
    let amb: f64 = args.get(2).map_or(-10.0, |s| s.parse().unwrap());
    let start = if args.get(3).map(|s| s.as_str()) == Some("warm") { Start::Warm } else { Start::Soak };
    let sets: Vec<String> = args.iter().skip(4).cloned().collect();
    let cycle = cvtcycle::cycle::embedded(cycle_name).unwrap();
    for name in ["rover_216_cvt", "rover_216_5mt", "mondeo_20_5mt"] {
        let sets = if name == "rover_216_cvt" { sets.clone() } else { vec![] };
        let setup = match load(name, "--vehicle", &Options { set: sets, ..Options::default() }) {
            Ok(s) => s,
            Err(p) => {
                println!("{}", cvtcycle::config::render(&p, false));
                continue;
            }
        };
        let c = Conditions { ambient_k: amb + 273.15, start, max_dt_s: 1.0, keep_rows: true };
        let t0 = std::time::Instant::now();
        let o = drive(&setup, &cycle, &c);
        let el = t0.elapsed();
        print!("{name:15} ");
        for (g, p) in cycle.phase_groups() {
            let t = o.totals.over(&p);
            print!("{g} {:.2} ", litres_per_100km(t.fuel_kg, 745.0, t.distance_m));
        }
        let t = o.totals.total();
        println!(
            "total {:.3} L/100km {:.3} km; end {:?} ledger {:.1e} resid {:.1e} eval/row {:.2} minS {:.2}@{} missed {} {:.1} kW@{} time {:?} ns/row {:.0}",
            litres_per_100km(t.fuel_kg, 745.0, t.distance_m),
            t.distance_m / 1e3,
            o.end.node_k.map(|x| ((x - 273.15) * 10.0).round() / 10.0),
            o.totals.ledger_error,
            o.totals.worst_residual,
            o.totals.evaluations as f64 / o.totals.rows as f64,
            o.totals.min_clamp_safety,
            o.totals.min_clamp_at_s,
            o.totals.seconds(cvtcycle::results::Flags::MISSED_TRACE),
            o.totals.worst_deficit_w / 1e3,
            o.totals.worst_deficit_at_s,
            el,
            el.as_nanos() as f64 / o.totals.rows as f64
        );
        print!("   ");
        for k in components(setup.transmission()) {
            print!("{} {:.0}  ", k.name(), t.loss_j[k as usize] / 1e3);
        }
        println!(
            " brake {:.0} acc {:.0} fuel {:.0} kJ W+ {:.2} W- {:.2}",
            t.terms.brake / 1e3,
            t.terms.accessories / 1e3,
            t.terms.fuel / 1e3,
            t.wheel_positive_j / 1e3,
            t.wheel_negative_j / 1e3
        );
        for (f, s) in cvtcycle::results::Flags::NAMES.iter().zip(o.totals.flag_s) {
            if s > 0.0 {
                print!("{} {s} ", f.1);
            }
        }
        println!();
        if std::env::var("TRACE").is_ok() && name == "rover_216_cvt" {
            for r in &o.rows {
                println!(
                    "{} v {:.1} n {:.1} I {:.3} p {:.1} T {:.1} thr {:.3} slip {:.3}% S {:.2} sump {:.1} belt {:.1} it {} fl {:b}",
                    r.time_s,
                    r.speed_m_s * 3.6,
                    r.engine_speed_rad_s * 30.0 / std::f64::consts::PI,
                    r.belt_ratio,
                    r.secondary_pressure_pa / 1e5,
                    r.engine_torque_nm,
                    r.throttle,
                    r.slip * 100.0,
                    r.clamp_safety,
                    r.sump_k - 273.15,
                    r.belt_spray_k - 273.15,
                    r.iterations,
                    r.flags.0
                );
            }
        }
    }
}
