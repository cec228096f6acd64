//! Losses written as a map of a component, and a car that reads it. Truth: the component.

use super::*;

/// A bench with a belt map has one column for it, and no status of the unused belt model.
#[test]
fn a_belt_map_has_one_column() {
    let csv = b"ratio,oil_temp_degc,torque_loss_nm\n0.4,0,6\n0.4,90,6\n2.5,0,6\n2.5,90,6\n";
    let setup = with_map("rover_216_cvt", csv, "transmission.cvt.maps.belt");
    let mut grid = LossGrid::default();
    for (axis, value) in [
        (Axis::Ratio, 1.0),
        (Axis::Sump, 50.0),
        (Axis::Speed, 2000.0),
    ] {
        grid.values[axis as usize] = vec![value];
    }
    let of_cvt = columns(setup.transmission());
    let row = grid.rows(&Bench::new(&setup)).next().unwrap();
    let shown = |name: &str| {
        let column = of_cvt
            .iter()
            .find(|column| column.name == name)
            .unwrap_or_else(|| panic!("no {name}"));
        (&column.doc, column.cell(&row))
    };
    let (doc, loss) = shown("belt_map_loss_nm");
    assert!(
        doc.contains("measured map") && matches!(loss, Cell::Number(nm) if (nm - 6.0).abs() < 1e-9),
        "{loss:?}"
    );
    assert!(matches!(shown("belt_status").1, Cell::Text(word) if word.is_empty()));
    assert!(
        of_cvt
            .iter()
            .all(|column| column.name != "belt_slip_loss_nm")
    );
    let csv = b"gear,input_torque_nm,torque_loss_nm\n1,-100,3\n1,200,3\n5,-100,3\n5,200,3\n";
    let manual = with_map("rover_216_5mt", csv, "transmission.manual.maps.box");
    let of_manual = columns(manual.transmission());
    let parts: Vec<_> = of_manual
        .iter()
        .filter(|column| column.name.ends_with("_loss_nm") && column.name != "total_loss_nm")
        .collect();
    assert!(
        parts.len() == 1
            && parts[0].name == "box_map_loss_nm"
            && parts[0].doc.contains("measured map"),
        "{parts:?}"
    );
}

/// Setup whose vehicle file is in a folder with a map.
fn with_map(vehicle: &str, csv: &[u8], key: &str) -> Setup {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    std::fs::copy(
        format!("{}/vehicles/{vehicle}.toml", env!("CARGO_MANIFEST_DIR")),
        &file,
    )
    .unwrap();
    std::fs::write(folder.path().join("map.csv"), csv).unwrap();
    let options = Options {
        set: vec![Override::new(key, "map.csv").unwrap()],
        ..Options::default()
    };
    load(file.to_str().unwrap(), &options)
        .unwrap_or_else(|p| panic!("{key}: {}", render(&p, false)))
}

/// Round trip: a map written from a component and read in its place has the same losses at every point of the grid.
#[test]
fn maps_round_trip() {
    for (name, part) in MapPart::NAMES {
        let vehicle = if part.is_cvt_only() {
            "rover_216_cvt"
        } else {
            "rover_216_5mt"
        };
        let bench = Bench::new(&car(vehicle, &[]));
        let mut grid = LossGrid::default();
        let ratios = if part.is_cvt_only() {
            vec![0.5, 1.2, 2.3]
        } else {
            vec![1.0, 3.0, 5.0]
        };
        let torque = if part.torque_column().is_some() {
            vec![-20.0, 0.0, 35.0]
        } else {
            vec![0.0]
        };
        let pressure = if part.is_cvt_only() {
            vec![15.0, 30.0]
        } else {
            Vec::new()
        };
        for (axis, values) in [
            (Axis::Ratio, ratios),
            (Axis::Sump, vec![-10.0, 80.0]),
            (Axis::Pressure, pressure),
            (Axis::Torque, torque),
            (Axis::Speed, vec![800.0, 2500.0]),
        ] {
            grid.values[axis as usize] = values;
        }
        grid.values[Axis::Throttle as usize] = vec![0.0];
        let mut csv = Vec::new();
        write_map(&mut csv, &bench, part, &grid).unwrap();
        let table = if part.is_cvt_only() { "cvt" } else { "manual" };
        let again = Bench::new(&with_map(
            vehicle,
            &csv,
            &format!("transmission.{table}.maps.{name}"),
        ));
        assert_eq!(
            String::from_utf8(csv).unwrap().lines().count(),
            grid.len() + 1
        );
        for k in 0..grid.len() {
            let p = cvtcycle::output::losses::bench_point(&grid.at(k));
            let (model, map) = (part.loss_nm(&bench, &p), part_of_map(part, &again, &p));
            close(model, map, 1e-9, &format!("{name} {p:?}"));
        }
    }
}

/// Loss of the component on a bench with its map.
fn part_of_map(part: MapPart, bench: &Bench, point: &BenchPoint) -> f64 {
    let loss = part.loss_nm(bench, point);
    if part == MapPart::Belt {
        let answer = bench.solve(&BenchPoint {
            belt_k: None,
            ..*point
        });
        let others = Component::ALL
            .into_iter()
            .filter(|c| c.is_belt() && *c != Component::BeltMap)
            .map(|c| answer.part_nm(c))
            .sum::<f64>();
        assert!(
            others.abs() < 1e-15,
            "the map replaces every part of the belt"
        );
    }
    loss
}

/// The command line writes the library's map.
#[test]
fn map_on_the_command_line() {
    let text = good(&[
        "--as-map",
        "pump",
        "--ratio",
        "0.5,2",
        "--speed",
        "1000,2000",
        "--temp",
        "25",
        "--pressure",
        "10,30",
    ]);
    let mut lines = text.lines();
    assert_eq!(
        lines.next(),
        Some("ratio,input_speed_rpm,secondary_pressure_bar,oil_temp_degc,torque_loss_nm")
    );
    assert_eq!(lines.count(), 8);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("map");
    good(&[
        "--as-map",
        "belt",
        "--torque",
        "0..60:20",
        "--out",
        out.to_str().unwrap(),
    ]);
    assert_eq!(files(&out), ["map_belt.csv", "summary.json"]);
}
