//! The plots of every kind of run.
use cvtcycle::model::drive::FuelMap;
use cvtcycle::output::columns::columns_for;
use cvtcycle::output::{Component, History, Row};
use cvtcycle::report::charts::{
    Picture, PlotRun, driveline, fuel_bars, losses, operating_points, pressure, temperatures,
};

use super::{history, phases, rows, run};

/// All plots of a run, with their names.
pub fn all(run: &PlotRun) -> Vec<(&'static str, Picture)> {
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
pub fn every_plot() -> Vec<(String, Picture)> {
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
    let huge = Row {
        time_s: 1e300,
        dt_s: 1e300,
        speed_m_s: 1e300,
        coolant_k: -1e305,
        loss_w: [1e290; Component::COUNT],
        ..Row::default()
    };
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
        let full = history(*cvt, rows, &phases);
        let plain = run(name, &full);
        plots.extend(
            all(&plain)
                .into_iter()
                .map(|(plot, picture)| (format!("{name}: {plot}"), picture)),
        );
        let bare = History::of(rows, &columns_for(*cvt, &[]), &[]);
        let group_fuel = vec![("<odd> & so on".into(), f64::NAN), ("total".into(), 0.0)];
        let bare = PlotRun {
            history: &bare,
            fuel_map: None,
            group_fuel,
            ..plain
        };
        plots.extend(
            all(&bare)
                .into_iter()
                .map(|(plot, picture)| (format!("{name} bare: {plot}"), picture)),
        );
    }
    let (a, b) = (
        history(true, &cases[0].2, &phases),
        history(false, &cases[1].2, &phases),
    );
    let runs = [run("cvt", &a), run("manual", &b), run(odd, &a)];
    plots.push(("three runs".into(), fuel_bars(&runs)));
    plots.push(("no runs".into(), fuel_bars(&[])));
    let names: Vec<String> = (0..40).map(|k| format!("car {k}")).collect();
    let many: Vec<PlotRun> = names.iter().map(|name| run(name, &a)).collect();
    plots.push(("twelve runs".into(), fuel_bars(&many[..12])));
    plots.push(("forty runs".into(), fuel_bars(&many)));
    plots.push((
        "no steps at all".into(),
        driveline(&run("", &History::default())),
    ));
    let broken = FuelMap {
        speed_rad_s: vec![100.0, 200.0],
        torque_nm: vec![1.0],
        bsfc_kg_j: vec![vec![]],
        full_load_nm: vec![f64::NAN],
    };
    let odd_map = PlotRun {
        fuel_map: Some(broken),
        ..run("odd map", &a)
    };
    plots.push(("odd map".into(), operating_points(&odd_map)));
    plots
}
