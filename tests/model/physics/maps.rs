//! Measured torque-loss maps in place of models, read from CSV files in the folder of a vehicle file.
#![allow(clippy::unwrap_used, reason = "tests")]

use cvtcycle_config::cycle::embedded;
use cvtcycle_config::setup::{Options, Setup, load};
use cvtcycle_config::{Override, render};
use cvtcycle_model::drive::{Conditions, Outcome, Start, drive};
use cvtcycle_model::transmission::component::Component;

/// A vehicle file in its own folder with a map; the overrides name the map.
fn car(vehicle: &str, csv: &str, set: &str) -> Result<Setup, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    std::fs::copy(
        format!(
            "{}/../../vehicles/{vehicle}.toml",
            env!("CARGO_MANIFEST_DIR")
        ),
        &file,
    )
    .unwrap();
    std::fs::write(folder.path().join("map.csv"), csv).unwrap();
    let options = Options {
        set: vec![Override::new(set, "map.csv").unwrap()],
        ..Options::default()
    };
    load(file.to_str().unwrap(), &options).map_err(|p| render(&p, false))
}

fn driven(setup: &Setup) -> Outcome {
    let conditions = Conditions {
        ambient_k: 298.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: true,
    };
    drive(setup, &embedded("ece15").unwrap(), &conditions)
}

/// Hand calculation: 2 Nm at every engine speed is 2 Nm times the speed in every row, standstill included.
#[test]
fn val_a_constant_pump_map() {
    let csv = "input_speed_rpm,torque_loss_nm\n0,2\n7000,2\n";
    let o = driven(&car("rover_216_cvt", csv, "transmission.cvt.maps.pump").unwrap());
    for r in &o.rows {
        let want = 2.0 * r.engine_speed_rad_s;
        let got = r.loss_w[Component::Pump];
        assert!(
            (got - want).abs() <= 1e-9 * want,
            "{} s: {got} instead of {want}",
            r.time_s
        );
    }
    assert!(o.totals.ledger_error < 1e-9);
}

/// Property: a belt map takes the place of all belt parts and of slip, scales with its values, and the books still close.
#[test]
fn a_belt_map_replaces_every_belt_part() {
    let csv = |scale: f64| {
        let mut text = String::from("ratio,oil_temp_degc,torque_loss_nm\n");
        for (ratio, temp, loss) in [
            (0.4, 0.0, 6.0),
            (0.4, 90.0, 5.0),
            (2.5, 0.0, 4.0),
            (2.5, 90.0, 3.0),
        ] {
            text += &format!("{ratio},{temp},{}\n", loss * scale);
        }
        text
    };
    let key = "transmission.cvt.maps.belt";
    let (one, two) = (
        driven(&car("rover_216_cvt", &csv(1.0), key).unwrap()),
        driven(&car("rover_216_cvt", &csv(2.0), key).unwrap()),
    );
    let (a, b) = (one.totals.total(), two.totals.total());
    let listed = car("rover_216_cvt", &csv(1.0), key)
        .unwrap()
        .transmission()
        .components();
    assert!(listed.contains(&Component::BeltMap));
    for part in [
        Component::PulleyBearing,
        Component::BeltBand,
        Component::BeltFilm,
        Component::BeltSlip,
        Component::BeltWedge,
        Component::BeltPenetration,
    ] {
        assert!(a.loss_j[part].abs() < 1e-12 && !listed.contains(&part));
    }
    let doubled = b.loss_j[Component::BeltMap] / a.loss_j[Component::BeltMap];
    assert!((doubled - 2.0).abs() < 0.02, "{doubled}");
    assert!(b.fuel_kg > a.fuel_kg && two.totals.ledger_error < 1e-9);
    assert!(one.rows.iter().all(|r| r.slip.abs() < 1e-12));
}

/// Hand calculation: a box map of 3 Nm loses 3 Nm times the input speed in gear; it replaces all of the box's parts, whose losses are then absent.
#[test]
fn val_a_constant_box_map() {
    let csv = "gear,input_torque_nm,torque_loss_nm\n1,-100,3\n1,200,3\n5,-100,3\n5,200,3\n";
    let o = driven(&car("rover_216_5mt", csv, "transmission.manual.maps.box").unwrap());
    let locked = o
        .rows
        .iter()
        .filter(|r| r.gear > 0 && r.speed_m_s > 5.0 && r.flags.0 & 0b1100_0000 == 0);
    let mut count = 0;
    for r in locked {
        let want = 3.0 * r.engine_speed_rad_s;
        let got = r.loss_w[Component::BoxMap];
        assert!(
            r.loss_w[Component::GearMesh].abs() < 1e-12 && r.loss_w[Component::Seal].abs() < 1e-12
        );
        assert!(
            (got - want).abs() <= 1e-6 * want,
            "{} s: {got} instead of {want}",
            r.time_s
        );
        count += 1;
    }
    assert!(count > 50 && o.totals.ledger_error < 1e-9, "{count} rows");
}

/// A map with a hole, a text cell and an unknown column is refused with places.
#[test]
fn bad_maps_are_refused() {
    let hole = car(
        "rover_216_cvt",
        "ratio,input_speed_rpm,torque_loss_nm\n0.4,0,1\n2.4,5000,1\n",
        "transmission.cvt.maps.pump",
    )
    .unwrap_err();
    assert!(
        hole.contains("there is no row for ratio 0.4, input_speed_rpm 5000"),
        "{hole}"
    );
    let text = car(
        "rover_216_cvt",
        "input_sped_rpm,torque_loss_nm\n0,nan\n",
        "transmission.cvt.maps.pump",
    )
    .unwrap_err();
    assert!(
        text.contains("input_speed_rpm") && text.contains("nan"),
        "{text}"
    );
}
