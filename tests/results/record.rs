//! Record of a run: files with hashes, changes against a shipped vehicle, lines of the variogram.

use cvtcycle::config::Override;
use cvtcycle::config::setup::{Options, embedded_vehicles, load};
use cvtcycle::output::provenance::car_record;
use cvtcycle::output::provenance::hash;
use cvtcycle::output::record::{CarRecord, Effect, SpeedLine};

fn record_of(word: &str, set: &[&str], lubricant: Option<&str>) -> CarRecord {
    let set = Override::parse_all(set).unwrap_or_else(|p| unreachable!("{p}"));
    let options = Options {
        set,
        lubricant: lubricant.map(str::to_owned),
        ..Options::default()
    };
    let setup = load(word, &options).unwrap_or_else(|p| unreachable!("{p:?}"));
    car_record("car", word, &options, &setup).unwrap_or_else(|p| unreachable!("{p:?}"))
}

#[test]
fn a_shipped_car_does_not_differ_from_itself() {
    for (name, text) in embedded_vehicles() {
        let record = record_of(name, &[], None);
        assert_eq!(
            (record.reference.as_str(), record.changes.len()),
            (*name, 0)
        );
        assert_eq!(record.reference_values.0, record.reference_values.1);
        assert_eq!(record.vehicle.sha256, hash(text.as_bytes()));
    }
}

#[test]
fn changed_values_come_first_and_another_oil_in_full() {
    let key = "transmission.cvt.belt.band_offset_mm";
    let record = record_of(
        "rover_216_cvt",
        &[&format!("{key}=3.25"), "lubricant.density15_kg_m3=900"],
        Some("dexron_ii"),
    );
    assert_eq!(
        (
            record.changes[0].key.as_str(),
            record.changes[0].here.as_str(),
            record.changes[0].unit.as_str()
        ),
        (key, "3.25", "mm")
    );
    assert!(!record.changes[0].shipped.is_empty());
    assert_eq!(record.changes[1].key, "lubricant.density15_kg_m3");
    assert!(
        record
            .changes
            .iter()
            .any(|c| c.key.starts_with("lubricant.") && c.key.contains("kv")),
        "{:?}",
        record.changes
    );
    assert!(record.lubricant.file.contains("dexron_ii"));
}

/// The hash of a car depends on its values and the contents of its maps, but not on number formats or names.
#[test]
fn the_hash_of_a_car_is_that_of_its_values() {
    let hash_of = |word: &str, set: &[&str]| record_of(word, set, None).resolved_sha256;
    let (car, offset) = ("rover_216_cvt", "transmission.cvt.belt.band_offset_mm");
    let shipped = hash_of(car, &[]);
    for same in [
        format!("{offset}=3.0"),
        format!("{offset}=3e0"),
        "vehicle.title=\"another name\"".to_owned(),
    ] {
        assert_eq!(hash_of(car, &[&same]), shipped, "{same}");
    }
    assert_ne!(hash_of(car, &[&format!("{offset}=3.1")]), shipped);
    let dir = tempfile::tempdir().unwrap_or_else(|e| unreachable!("{e}"));
    let mut found = vec![shipped];
    for loss in ["0.7", "0.8"] {
        let path = dir.path().join("pump.csv");
        let text = format!("torque_loss_nm\n{loss}\n");
        std::fs::write(&path, text).unwrap_or_else(|e| unreachable!("{e}"));
        let set = format!("transmission.cvt.maps.pump={:?}", path.display());
        found.push(hash_of(car, &[&set]));
    }
    let count = found.len();
    found.sort_unstable();
    found.dedup();
    assert_eq!(found.len(), count, "{found:?}");
}

/// Lines from rest, with the slopes of their ratios. The range of the file's belt ratios lies between both limits.
#[test]
fn lines_of_the_variogram_are_those_of_the_ratios() {
    let record = record_of("rover_216_cvt", &[], None);
    let lines = &record.speed_lines;
    assert_eq!(
        (lines[0].name.as_str(), lines[1].name.as_str(), lines.len()),
        ("lowest ratio", "highest ratio", 6)
    );
    let number = |end: &str| {
        let value = record
            .values
            .iter()
            .find(|v| v.key.ends_with(end))
            .map(|v| v.value.parse::<f64>());
        value
            .unwrap_or_else(|| unreachable!("{end}"))
            .unwrap_or_else(|e| unreachable!("{e}"))
    };
    let slope = |line: &SpeedLine| line.points[1].1 / line.points[1].0;
    let span = number(".ratio.low") / number(".ratio.high");
    assert!((slope(&lines[0]) / slope(&lines[1]) / span - 1.0).abs() < 1e-12);
    assert_eq!(record_of("rover_216_5mt", &[], None).speed_lines.len(), 5);
}

#[test]
fn the_size_of_an_effect_is_that_of_its_larger_side() {
    let effect = |lowered_percent, raised_percent| Effect {
        car: String::new(),
        key: String::new(),
        lowered_percent,
        raised_percent,
    };
    assert!((effect(Some(-0.4), Some(0.3)).size_percent() - 0.4).abs() < 1e-15);
    assert!((effect(None, Some(0.3)).size_percent() - 0.3).abs() < 1e-15);
    assert!(effect(None, None).size_percent().is_nan());
}
