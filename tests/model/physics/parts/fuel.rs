//! Unit tests of `model::engine::fuel`.
use cvtcycle_model::engine::{FuelModel, Willans};
use cvtcycle_model::maps::BsfcMap;

const BAR: f64 = 1e5;

fn willans() -> Willans {
    Willans {
        a: 0.4851,
        b: 0.01193,
        c: -0.00065,
        a2: -0.00385,
        l: 2.39882,
        l2: 0.00286,
    }
}

/// BSFC of the natural-aspiration set at 2000 rpm and 79 mm stroke, from the facts table (g/kWh at bmep bar).
#[test]
fn val_bsfc_table() {
    let w = willans();
    let cm = 2000.0 * 79.0 / 30_000.0;
    let friction = (w.l + w.l2 * cm * cm) * BAR;
    for (bmep, bsfc) in [
        (1.0, 576.0),
        (2.0, 377.0),
        (3.0, 313.0),
        (4.0, 283.0),
        (6.0, 257.0),
        (8.0, 249.0),
        (10.0, 251.0),
    ] {
        let p = FuelModel::Willans(w).fuel_mep(cm, 209.0, bmep * BAR, friction);
        let got = p.fuel_pa / (bmep * BAR) / 43.2e6 * 3.6e9;
        assert!(
            (got / bsfc - 1.0).abs() < 0.004,
            "{bmep} bar: {got:.1} instead of {bsfc}"
        );
    }
}

#[test]
fn fuel_is_cut_where_the_line_reaches_zero() {
    let p = FuelModel::Willans(willans()).fuel_mep(5.0, 200.0, -3.0 * BAR, 2.4 * BAR);
    assert!(p.fuel_pa.abs() < 1e-12 && !p.outside);
}

/// A map made from the Willans line gives the line back at its points, hot and cold.
#[test]
fn map_agrees_with_the_line_it_was_made_from() {
    let line = FuelModel::Willans(willans());
    let speeds = [100.0, 200.0, 400.0];
    let bmeps: Vec<f64> = (1..=20).map(|i| 0.5 * BAR * f64::from(i)).collect();
    let stroke = 0.079;
    let cm = |s: f64| s * stroke / std::f64::consts::PI;
    let fuel = speeds
        .iter()
        .map(|&s| {
            bmeps
                .iter()
                .map(|&p| {
                    line.fuel_mep(cm(s), s, p, line.hot_friction_pa(cm(s)))
                        .fuel_pa
                })
                .collect()
        })
        .collect();
    let map = FuelModel::Map(BsfcMap {
        speed_rad_s: speeds.to_vec(),
        bmep_pa: bmeps,
        fuel_pa: fuel,
        friction: (2.39882, 0.00286),
    });
    for p in [1.0, 3.0, 6.0] {
        let hot = line.hot_friction_pa(cm(200.0));
        let a = line.fuel_mep(cm(200.0), 200.0, p * BAR, 1.5 * hot).fuel_pa;
        let b = map
            .fuel_mep(
                cm(200.0),
                200.0,
                p * BAR,
                1.5 * map.hot_friction_pa(cm(200.0)),
            )
            .fuel_pa;
        assert!((a / b - 1.0).abs() < 0.01, "{p} bar: {a} {b}");
    }
}
