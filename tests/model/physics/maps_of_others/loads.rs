//! A load that a map says twice, as a torque or power and as a mean effective pressure.

use super::{ENGINE, LIST, MATRIX, car, engine, litres, points};
use cvtcycle_model::keys::rad_s;
use std::fmt::Write;

/// Torques of 2 and mean effective pressures of 3 decimals.
const MAZDA: &str = include_str!("mazda_2014.csv");

/// The list with the mean effective pressure that its torques have with a swept volume, in bar with as many decimals.
fn with_pressure(swept_m3: f64, decimals: usize) -> String {
    let mut text = "speed_rpm,torque_nm,bmep_bar,bsfc_g_kwh\n".to_owned();
    for [rpm, nm, g_kwh] in points() {
        let bar = nm * 4e-5 * std::f64::consts::PI / swept_m3;
        writeln!(text, "{rpm},{nm},{bar:.decimals$},{g_kwh}").unwrap();
    }
    text
}

/// Number of problems of a refusal.
fn count(refusal: &str) -> usize {
    refusal.matches("error: ").count()
}

/// Truth: the swept volume 4 pi T / p is one in all rows. Rows that have another one are one problem with their count, the first of them and what to
/// type; either column alone is the map again.
#[test]
fn loads_that_contradict_are_one_problem() {
    let swept_m3 = engine("a.csv", LIST).unwrap().engine().displacement_m3;
    let right = litres(&engine("a.csv", LIST).unwrap());
    let both = with_pressure(swept_m3, 5);
    let lines: Vec<&str> = both.lines().collect();
    let exchanged = |k: usize, by: f64| {
        let mut cells: Vec<String> = lines[k].split(',').map(str::to_owned).collect();
        cells[2] = format!("{:.5}", cells[2].parse::<f64>().unwrap() * by);
        cells.join(",")
    };
    let with = |changed: &[(usize, f64)]| {
        let mut all: Vec<String> = lines.iter().map(|&line| line.to_owned()).collect();
        for (k, by) in changed {
            all[*k] = exchanged(*k, *by);
        }
        all.join("\n")
    };
    let text = with(&[(7, 1.1), (30, 0.5), (31, -1.0)]);
    let why = engine("a.csv", &text).unwrap_err();
    assert_eq!(count(&why), 1, "{why}");
    for said in [
        "contradict each other in 3 of 132 rows",
        "a.csv:8:",
        "a swept volume of 1444 cc, and the other rows have 1588 cc",
        "columns = \"speed_rpm=speed_rpm,torque_nm=torque_nm,bsfc_g_kwh=bsfc_g_kwh\"",
        "columns = \"speed_rpm=speed_rpm,bmep_bar=bmep_bar,bsfc_g_kwh=bsfc_g_kwh\"",
    ] {
        assert!(why.contains(said), "{said}: {why}");
    }
    for load in ["torque_nm=torque_nm", "bmep_bar=bmep_bar"] {
        let columns = format!("speed_rpm=speed_rpm,{load},bsfc_g_kwh=bsfc_g_kwh");
        let value = format!("{{ value = \"a.csv\", columns = \"{columns}\" }}");
        let of_text = if load.starts_with('t') { &text } else { &both };
        let own = litres(&car("a.csv", of_text, ENGINE, &value, &[]).unwrap());
        assert!(
            (own / right - 1.0).abs() < 1e-4,
            "{load}: {own} for {right}"
        );
    }
    // The share of 2 % is one of each row; opposite signs are no volume, and a power next to a pressure is a torque.
    assert!(engine("a.csv", &with(&[(7, 1.015), (30, 0.985)])).is_ok());
    assert!(
        engine("a.csv", &with(&[(7, 1.045)]))
            .unwrap_err()
            .contains("in 1 of 132 rows")
    );
    let all: Vec<(usize, f64)> = (1..lines.len()).map(|k| (k, -1.0)).collect();
    let why = engine("a.csv", &with(&all)).unwrap_err();
    assert!(
        why.contains("in 132 of 132 rows") && why.contains("are no swept volume"),
        "{why}"
    );
    let mut power = "speed_rpm,power_kw,bmep_bar,bsfc_g_kwh\n".to_owned();
    for [rpm, nm, g_kwh] in points() {
        let bar = nm * 4e-5 * std::f64::consts::PI / swept_m3;
        writeln!(power, "{rpm},{:.6},{bar:.3},{g_kwh}", nm * rad_s(rpm) / 1e3).unwrap();
    }
    let own = litres(&engine("a.csv", &power).unwrap());
    assert!((own / right - 1.0).abs() < 1e-3, "{own} for {right}");
    let slip = power.replacen(",4.900885,", ",3.900885,", 1);
    assert!(slip != power, "{power}");
    let why = engine("a.csv", &slip).unwrap_err();
    assert!(why.contains("in 1 of 132 rows"), "{why}");
}

/// Property: the rounding of a column contradicts nothing, whatever its last digit; decimal commas and cells without a number neither.
#[test]
fn rounded_loads_do_not_contradict() {
    let swept_m3 = engine("a.csv", LIST).unwrap().engine().displacement_m3;
    let right = litres(&engine("a.csv", LIST).unwrap());
    for decimals in 0..5 {
        let text = with_pressure(swept_m3, decimals);
        let commas = text.replace(',', ";").replace('.', ",");
        let holes = text.replacen("1000,15.6,", "1000,15.6,-", 1);
        let holes = holes.replacen(
            &format!(
                "-{:.decimals$}",
                15.6 * 4e-5 * std::f64::consts::PI / swept_m3
            ),
            "",
            1,
        );
        for text in [text, commas, holes] {
            let own =
                litres(&engine("a.csv", &text).unwrap_or_else(|why| panic!("{decimals}: {why}")));
            assert!(
                (own / right - 1.0).abs() < 1e-9,
                "{decimals}: {own} for {right}"
            );
        }
    }
    let mazda = |set: &[&str]| car("a.csv", MAZDA, ENGINE, "\"a.csv\"", set);
    mazda(&["engine.model.bsfc_map.measured_cc=1998"]).unwrap();
    let why = mazda(&[]).unwrap_err();
    assert!(why.contains("measured_cc = 1998"), "{why}");
    // No more than that: 6 bar in place of 5 in a column of whole numbers.
    let whole = with_pressure(swept_m3, 0);
    let slip = whole.replacen("2000,62.4,5,", "2000,62.4,6,", 1);
    assert!(slip != whole && engine("a.csv", &slip).is_err());
}

/// Truth: columns of one swept volume that is not that of the engine are of another engine. The message has both volumes and the key to type, with
/// which the map is that of its torque for this key.
#[test]
fn a_map_of_another_swept_volume_says_what_to_type() {
    let own_m3 = engine("a.csv", LIST).unwrap().engine().displacement_m3;
    let other = with_pressure(1.9012e-3, 4);
    let why = engine("a.csv", &other).unwrap_err();
    assert_eq!(count(&why), 1, "{why}");
    for said in [
        "torque_nm over bmep_bar in a.csv is a swept volume of 1901 cc",
        "has 1588 cc",
        "measured_cc = 1901",
    ] {
        assert!(why.contains(said), "{said}: {why}");
    }
    let set = ["engine.model.bsfc_map.measured_cc=1901"];
    let with = |text: &str| car("a.csv", text, ENGINE, "\"a.csv\"", &set);
    let (both, alone) = (litres(&with(&other).unwrap()), litres(&with(LIST).unwrap()));
    assert!((both / alone - 1.0).abs() < 1e-9, "{both} {alone}");
    // Volumes within 3 % are one, and the key that is wrong is named too.
    for share in [0.975, 1.025] {
        let own = litres(&engine("a.csv", &with_pressure(own_m3 * share, 5)).unwrap());
        assert!(
            (own / litres(&engine("a.csv", LIST).unwrap()) - 1.0).abs() < 1e-9,
            "{own}"
        );
    }
    let wrong = with(&with_pressure(own_m3, 5)).unwrap_err();
    assert!(
        wrong.contains("1588 cc, and the engine that was measured has 1901 cc"),
        "{wrong}"
    );
    // kPa under the name of bar.
    let kpa = with_pressure(own_m3 / 100.0, 3);
    let why = engine("a.csv", &kpa).unwrap_err();
    assert!(
        why.contains("correct the unit of one of the columns"),
        "{why}"
    );
}

/// Property: a quantity that is named twice, or not at all, is refused and not chosen in silence.
#[test]
fn two_columns_of_one_quantity_are_never_chosen_from() {
    let mut two = "speed_rpm,torque_nm,bsfc_g_kwh,fuel_g_s\n".to_owned();
    for [rpm, nm, g_kwh] in points() {
        let g_s = 2.0 * g_kwh * nm * rad_s(rpm) / 3.6e6;
        writeln!(two, "{rpm},{nm},{g_kwh},{g_s:.5}").unwrap();
    }
    let said = "fuel_g_s and bsfc_g_kwh say the same thing";
    let why = engine("a.csv", &two).unwrap_err();
    assert!(why.contains(said), "{why}");
    let refused = |file: &str, text: &str, columns: &str| {
        let value = format!("{{ value = \"{file}\", columns = \"{columns}\" }}");
        car(file, text, ENGINE, &value, &[]).unwrap_err()
    };
    let axes = "speed=speed_rpm:rpm,torque=torque_nm:Nm";
    let why = refused(
        "a.csv",
        &two,
        &format!("{axes},fuel=fuel_g_s:g/s,bsfc=bsfc_g_kwh:g/kWh"),
    );
    assert!(why.contains(said), "{why}");
    let why = refused("a.csv", MATRIX, "speed:rpm,torque:Nm,bmep:bar");
    assert!(
        why.contains("torque_nm and bmep_bar say the same thing")
            || why.contains("bmep_bar and torque_nm say the same thing"),
        "{why}"
    );
    let script = "a=[1 2 3]*1000*pi/30;\nb=[10 50 100];\n";
    let why = refused("a.m", script, "speed=a:rad/s,torque=b:Nm");
    assert!(
        why.contains("the columns name no fuel_g_s or bsfc_g_kwh"),
        "{why}"
    );
    let why = refused("a.m", script, "speed=a:rad/s,torque=b:Nm,bmep=b:bar");
    assert!(why.contains("say the same thing"), "{why}");
}
