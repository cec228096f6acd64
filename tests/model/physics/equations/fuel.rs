//! Fuel: WI-1, WI-2, BM-1 to BM-3, and the bounds of both.

use super::same;
use cvtcycle_model::engine::{FuelModel, Willans};
use cvtcycle_model::maps::{Basis, BsfcMap, Fuel, FuelRow, FuelTable, Load};

/// Rubbing friction of the default line, which does not matter here.
const FRICTION: (f64, f64) = (2.398_82, 0.002_86);

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

/// WI-1 and WI-2 with the root found by bisection of the balance itself.
#[test]
fn val_willans_root_of_its_balance() {
    let w = willans();
    for (cm, brake, friction) in [
        (3.0, 1.0, 2.5),
        (9.0, 8.0, 2.6),
        (14.0, 4.0, 4.0),
        (2.0, -2.0, 2.4),
    ] {
        let b = w.a + w.b * cm + w.c * cm * cm;
        let balance = |f: f64| w.a2 * f * f + b * f - (friction + brake);
        let (mut low, mut high) = (0.0, -b / (2.0 * w.a2));
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if balance(middle) < 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        let p = FuelModel::Willans(w).fuel_mep(cm, 200.0, brake * BAR, friction * BAR);
        same(p.fuel_pa, 0.5 * (low + high) * BAR);
        same(p.indicated_pa, (brake + friction) * BAR);
        assert!(!p.outside);
    }
    same(
        FuelModel::Willans(w).hot_friction_pa(9.0),
        (2.39882 + 0.00286 * 81.0) * BAR,
    );
}

/// Beyond the turning point fuel is held there and the point is flagged; so is an efficiency outside 0.05 to 1.
#[test]
fn val_willans_bounds() {
    let (w, need) = (willans(), 30.0);
    let b = w.a + w.b * 5.0 + w.c * 25.0;
    assert!(b * b + 4.0 * w.a2 * need < 0.0);
    let p = FuelModel::Willans(w).fuel_mep(5.0, 200.0, (need - 3.0) * BAR, 3.0 * BAR);
    same(p.fuel_pa, 2.0 * need / b * BAR);
    same(p.indicated_pa, need * BAR);
    assert!(p.outside);
    for (a, held, outside) in [
        (0.02, 0.05, true),
        (0.05, 0.05, false),
        (1.0, 1.0, false),
        (1.4, 1.0, true),
    ] {
        let w = Willans {
            a,
            b: 0.0,
            c: 0.0,
            a2: 0.0,
            ..willans()
        };
        let p = FuelModel::Willans(w).fuel_mep(5.0, 200.0, 2.0 * BAR, BAR);
        same(p.fuel_pa, 3.0 / held * BAR);
        assert_eq!(p.outside, outside, "a = {a}");
    }
}

fn map() -> BsfcMap {
    BsfcMap {
        speed_rad_s: vec![100.0, 200.0, 400.0],
        bmep_pa: vec![2.0 * BAR, 4.0 * BAR, 9.0 * BAR],
        fuel_pa: vec![
            vec![9.0 * BAR, 14.0 * BAR, 27.0 * BAR],
            vec![10.0 * BAR, 15.0 * BAR, 26.0 * BAR],
            vec![12.0 * BAR, 18.0 * BAR, 31.0 * BAR],
        ],
        friction: (2.0, 0.01),
        known: None,
        origin: None,
    }
}

/// BM-1 and BM-2 by hand: inside two cells, on the edges, below the lowest load, and outside in each direction.
#[test]
fn val_map_by_hand() {
    let model = FuelModel::Map(map());
    let hot = (2.0 + 0.01 * 36.0) * BAR;
    same(model.hot_friction_pa(6.0), hot);
    let at = |speed: f64, bmep: f64| {
        let p = model.fuel_mep(6.0, speed, bmep * BAR, hot);
        same(p.indicated_pa, bmep * BAR + hot);
        (p.fuel_pa / BAR, p.outside)
    };
    for (speed, bmep, fuel, outside) in [
        (150.0, 3.0, 0.5 * (11.5 + 12.5), false),
        (250.0, 3.0, 0.75 * 12.5 + 0.25 * 15.0, false),
        (300.0, 6.5, 0.5 * (20.5 + 24.5), false),
        (100.0, 4.0, 14.0, false),
        (400.0, 9.0, 31.0, false),
        (200.0, 2.0, 10.0, false),
        (90.0, 4.0, 14.0, true),
        (500.0, 4.0, 18.0, true),
        (200.0, 9.5, 26.0 + 0.1 * 11.0, true),
        (200.0, 0.0, 10.0 * 2.36 / 4.36, false),
        (300.0, -1.0, 11.0 * 1.36 / 4.36, false),
    ] {
        let (got, flag) = at(speed, bmep);
        same(got, fuel);
        assert_eq!(flag, outside, "{speed} rad/s {bmep} bar");
    }
}

/// BM-3: friction above that of the hot engine is met as load; fuel is never below the indicated work, which is then flagged.
#[test]
fn val_cold_map_and_work_of_nothing() {
    let model = FuelModel::Map(map());
    let hot = model.hot_friction_pa(6.0);
    let (cold, loaded) = (
        model.fuel_mep(6.0, 150.0, 2.2 * BAR, hot + 1.5 * BAR),
        model.fuel_mep(6.0, 150.0, 3.7 * BAR, hot),
    );
    same(cold.fuel_pa, loaded.fuel_pa);
    same(cold.indicated_pa, loaded.indicated_pa);
    let cut = model.fuel_mep(6.0, 150.0, -2.0 * BAR, 2.0 * BAR);
    assert!(cut.fuel_pa == 0.0 && cut.indicated_pa == 0.0 && !cut.outside);
    let greedy = FuelModel::Map(BsfcMap {
        fuel_pa: vec![vec![5.0 * BAR, 6.0 * BAR, 7.0 * BAR]; 3],
        ..map()
    });
    let p = greedy.fuel_mep(6.0, 150.0, 8.0 * BAR, hot);
    same(p.fuel_pa, 8.0 * BAR + hot);
    assert!(p.outside);
    // Within a millionth and a thousandth of a pascal it is rounding and not flagged, beyond it is.
    for (miss, outside) in [(0.9, false), (1.1, true)] {
        let need = 4.0 * BAR + hot;
        let edge = need - miss * (1e-6 * need + 1e-3);
        let p = FuelModel::Map(BsfcMap {
            fuel_pa: vec![vec![edge; 3]; 3],
            ..map()
        })
        .fuel_mep(6.0, 150.0, 4.0 * BAR, hot);
        assert_eq!(p.outside, outside, "{miss}");
        same(p.fuel_pa, need);
    }
}

/// BM-1's rows: grid, order, units, and what is refused.
#[test]
fn val_rows_make_a_map() {
    let row = |speed: f64, bar: f64, g_kwh: f64| (speed, bar * BAR, g_kwh / 3.6e9);
    let good = [
        row(300.0, 6.0, 260.0),
        row(100.0, 2.0, 400.0),
        row(100.0, 6.0, 270.0),
        row(300.0, 2.0, 390.0),
    ];
    let made = |rows: &[(f64, f64, f64)]| {
        let row = |(k, row): (usize, &(f64, f64, f64))| FuelRow {
            speed_rad_s: row.0,
            load: row.1,
            fuel: row.2,
            line: k + 2,
        };
        let table = FuelTable {
            file: "map".to_owned(),
            read_as: None,
            swept: Vec::new(),
            load: Load::Bmep,
            fuel: Fuel::PerWork,
            rows: rows.iter().enumerate().map(row).collect(),
        };
        let basis = Basis {
            heating_value_j_kg: 43e6,
            displacement_m3: 1e-3,
            cylinders: None,
        };
        BsfcMap::from_table(&table, &basis, FRICTION).map_err(|why| why.message)
    };
    let map = made(&good).unwrap();
    assert_eq!(
        (map.speed_rad_s.as_slice(), map.bmep_pa.as_slice()),
        (&[100.0, 300.0][..], &[2.0 * BAR, 6.0 * BAR][..])
    );
    for (i, j, bar, g_kwh) in [
        (0, 0, 2.0, 400.0),
        (0, 1, 6.0, 270.0),
        (1, 0, 2.0, 390.0),
        (1, 1, 6.0, 260.0),
    ] {
        same(map.fuel_pa[i][j], g_kwh / 3.6e9 * bar * BAR * 43e6);
    }
    // Points that fill a grid but for the rounding of five figures are a grid; others are not.
    let mut close = good;
    close[2].0 = 100.0 * (1.0 + 0.9e-9);
    close[0].1 = 6.0 * BAR * (1.0 - 0.9e-9);
    assert_eq!(made(&close).unwrap().fuel_pa[0].len(), 2);
    close[2].0 = 100.0 * (1.0 + 0.9e-4);
    assert_eq!(made(&close).unwrap().speed_rad_s.len(), 2);
    close[2].0 = 100.0 * (1.0 + 2e-4);
    assert_eq!(made(&close).unwrap().speed_rad_s.len(), 3);
    for rows in [&good[..3], &good[1..3], &[good[1], good[3]][..]] {
        assert!(
            made(rows).unwrap_err().contains("do not fill a grid"),
            "{rows:?}"
        );
    }
    assert!(made(&[]).is_err());
    let mut twice = good;
    twice[3] = good[1];
    assert!(
        made(&twice)
            .unwrap_err()
            .contains("line 5 has the speed and the load of line 3")
    );
    let negative = [row(100.0, -0.5, 300.0)];
    assert!(
        made(&negative)
            .unwrap_err()
            .contains("no meaning at -0.500 bar")
    );
    // What falls is judged below full load.
    let falling = made(&[good[1], good[3], row(100.0, 6.0, 120.0), good[0]]).unwrap();
    let refused = falling.judge(|_| 7.0 * BAR).refusal.unwrap();
    assert!(refused.message.contains("line 4") && refused.message.contains("must rise with load"));
    assert_eq!(falling.judge(|_| 5.0 * BAR).refusal, None);
    let level = made(&[
        good[1],
        good[3],
        row(100.0, 4.0, 200.0),
        row(300.0, 4.0, 260.0),
    ]);
    let doubts = level.unwrap().judge(|_| 7.0 * BAR).doubts;
    assert!(doubts[0].contains("burns no more at"), "{doubts:?}");
}

/// A line whose efficiency leaves 0.05 to 1 only between rest and the highest speed, at its bend, is refused; one that bends earlier is not.
#[test]
fn an_efficiency_above_one_at_the_bend_is_refused() {
    let line = |a: f64, b: f64, c: f64| {
        let sets = [("a", a), ("b", b), ("c", c)]
            .map(|(key, x)| format!("engine.model.willans.{key}={x}"));
        crate::common::try_car("rover_216_cvt", &sets).map(|setup| {
            let e = setup.engine();
            e.piston_m_s(e.highest_rad_s)
        })
    };
    let fastest = line(0.5, 0.0, 0.0).unwrap();
    let at = |v: f64, c: f64| 0.7 + 0.05 * v + c * v * v;
    assert!(
        at(12.5, -0.002) > 1.0 && at(fastest, -0.002) < 1.0 && fastest > 12.5,
        "{fastest}"
    );
    assert!(line(0.7, 0.05, -0.002).unwrap_err().contains("12.5 m/s"));
    assert!(
        line(0.7, 0.05, -0.004).is_ok()
            && line(0.7, 0.01, 0.0).is_ok()
            && line(0.7, 0.03, 0.0).is_err()
    );
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
        known: None,
        origin: None,
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
