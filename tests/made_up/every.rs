//! The plots of every kind of run.
use cvtcycle::report::{FuelMap, PlotRun, driveline, fuel_bars, losses, operating_points, pressure, temperatures};
use cvtcycle::results::{Component, Row};

use super::{phases, rows, run};

/// All plots of a run, with their names.
pub fn all(run: &PlotRun) -> Vec<(&'static str, String)> {
    vec![
        ("driveline", driveline(run)),
        ("pressure", pressure(run)),
        ("temperatures", temperatures(run)),
        ("losses", losses(run)),
        ("operating_points", operating_points(run)),
        ("fuel_bars", fuel_bars(std::slice::from_ref(run))),
    ]
}

/// Every kind of run, ordinary and not, with its plots.
pub fn every_plot() -> Vec<(String, String)> {
    let phases = phases();
    let odd = "A <very> long & \"quoted\" name ]]> with \u{1} and \u{1f697} that goes on and on, \
               far beyond the right-hand edge of whatever picture it could be asked to head";
    let nan = Row {
        time_s: f64::NAN,
        dt_s: f64::NAN,
        speed_m_s: f64::NAN,
        belt_ratio: f64::INFINITY,
        loss_w: [f64::NAN; Component::COUNT],
        engine_torque_nm: f64::NEG_INFINITY,
        ..Row::default()
    };
    let huge = Row { time_s: 1e300, dt_s: 1e300, speed_m_s: 1e300, coolant_k: -1e305, loss_w: [1e290; Component::COUNT], ..Row::default() };
    let mut still = rows(40, 1.0, true);
    still.iter_mut().for_each(|row| row.time_s = 5.0);
    let cases = [
        ("cvt", true, rows(1180, 1.0, true)),
        ("manual", false, rows(1180, 1.0, false)),
        (odd, true, rows(30_000, 0.1, true)),
        ("one row", true, rows(1, 1.0, true)),
        ("no row", false, Vec::new()),
        ("zeros", true, vec![Row::default(); 50]),
        ("no numbers", true, vec![nan; 50]),
        ("huge", true, vec![huge; 2]),
        ("no time", true, still),
    ];
    let mut plots = Vec::new();
    for (name, cvt, rows) in &cases {
        let mut run = run(name, *cvt, rows, &phases);
        plots.extend(all(&run).into_iter().map(|(plot, svg)| (format!("{name}: {plot}"), svg)));
        run.fuel_map = None;
        run.group_fuel = vec![("<odd> & so on".into(), f64::NAN), ("total".into(), 0.0)];
        run.components = &[];
        plots.extend(all(&run).into_iter().map(|(plot, svg)| (format!("{name} bare: {plot}"), svg)));
    }
    let (a, b) = (&cases[0].2, &cases[1].2);
    let runs = [run("cvt", true, a, &phases), run("manual", false, b, &phases), run(odd, true, a, &phases)];
    plots.push(("three runs".into(), fuel_bars(&runs)));
    plots.push(("no runs".into(), fuel_bars(&[])));
    let broken = FuelMap { speed_rad_s: vec![100.0, 200.0], torque_nm: vec![1.0], bsfc_kg_j: vec![vec![]], full_load_nm: vec![f64::NAN] };
    let mut odd_map = run("odd map", true, a, &phases);
    odd_map.fuel_map = Some(broken);
    plots.push(("odd map".into(), operating_points(&odd_map)));
    plots
}
