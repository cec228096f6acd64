//! Inheritance between vehicle files. The truth is the parent's own reading, or a value that the test itself writes.

use std::collections::BTreeMap;

use cvtcycle_config::bounded::ReadError;
use cvtcycle_config::setup::new_car::ClassOf;
use cvtcycle_config::setup::{Files, Kind, Options, ParamSet, Setup, load, read};
use cvtcycle_config::{KeyInfo, Override, Problems};

/// Files in memory.
#[derive(Clone, Debug, Default)]
struct Shelf(BTreeMap<&'static str, String>);

impl Files for Shelf {
    fn read(&self, path: &str) -> Result<Vec<u8>, ReadError> {
        let missing = || ReadError::Unreadable(std::io::ErrorKind::NotFound.into());
        let text = self.0.get(path).ok_or_else(missing)?;
        Ok(text.clone().into_bytes())
    }
}

/// The vehicle `folder/car.toml` in the folder of the other files.
fn car(text: &str, others: &[(&'static str, &str)]) -> Result<Setup, Problems> {
    let shelf = others
        .iter()
        .map(|(name, text)| (*name, (*text).to_owned()));
    let shelf = Shelf(shelf.collect());
    read(
        "folder/car.toml",
        text,
        Box::new(shelf),
        &Options::default(),
    )
}

fn like(names: &str) -> String {
    format!("[vehicle]\nlike = {names}\n")
}

fn shipped(name: &str) -> Setup {
    load(name, &Options::default()).unwrap()
}

fn find<'s>(setup: &'s Setup, key: &str) -> &'s KeyInfo {
    let found = setup.keys.iter().find(|info| info.key == key);
    found.unwrap_or_else(|| panic!("{key}"))
}

/// Values by key, without the names of the car.
fn values(setup: &Setup) -> Vec<(&str, &str)> {
    let own = setup.keys.iter();
    let own = own.filter(|info| !info.key.starts_with("vehicle."));
    let mut list: Vec<(&str, &str)> = own.map(|info| (&*info.key, &*info.value)).collect();
    list.sort_unstable();
    list
}

#[test]
fn a_car_without_values_of_its_own_is_its_parent() {
    for name in Kind::Vehicle.names() {
        let (parent, child) = (
            shipped(name),
            car(&like(&format!("{name:?}")), &[]).unwrap(),
        );
        assert_eq!(values(&parent), values(&child), "{name}");
        // Names are its own.
        assert_eq!((child.title.as_str(), child.name.as_str()), ("car", "car"));
        assert!(child.baselines.is_empty());
    }
}

#[test]
fn no_inherited_value_has_the_status_of_its_parent() {
    let text = like("[\"class:compact_2020\", \"rover_216_cvt\"]") + "road_load.mass_kg = 1320\n";
    let text = text
        .replace("road_load", "title = \"x\"\n[road_load]\n#")
        .replace("#.mass_kg", "mass_kg");
    let child = car(&text, &[]).unwrap();
    let of_vehicle = child
        .keys
        .iter()
        .filter(|info| !info.key.starts_with("lubricant.") && !info.key.starts_with("engine_oil."));
    let mut count = 0;
    for info in of_vehicle {
        let (status, from) = (info.status.as_str(), info.from.as_str());
        let good = match status {
            "like" => from == "like rover_216_cvt" && info.source.contains("not of this car"),
            "class" => from == "class compact_2020",
            "user" => from.starts_with("line "),
            "default" => from == "default",
            "" => info.value.is_empty(),
            _ => false,
        };
        assert!(good, "{info:?}");
        count += usize::from(status == "like");
    }
    assert!(count > 150, "{count}");
    // The remark of the parent on a value is kept.
    let offset = find(&child, "transmission.cvt.belt.band_offset_mm");
    assert_eq!(offset.note, "there source: thesis App. C");
    assert_eq!(find(&child, "road_load.mass_kg").from, "line 5");
}

#[test]
fn own_values_come_before_the_later_parent_and_that_before_the_earlier() {
    let others = [
        (
            "a.toml",
            "[vehicle]\nlike = \"rover_216_5mt\"\n[road_load]\nmass_kg = 1001\npayload_kg = 11\naltitude_m = 101\n",
        ),
        ("b.toml", "[road_load]\npayload_kg = 12\naltitude_m = 102\n"),
    ];
    let text = like("[\"a.toml\", \"b.toml\"]") + "[road_load]\naltitude_m = 103\n";
    let child = car(&text, &others).unwrap();
    let got = ["mass_kg", "payload_kg", "altitude_m", "rotating_factor"].map(|key| {
        let info = find(&child, &format!("road_load.{key}"));
        (info.value.clone(), info.from.clone())
    });
    let want = [
        ("1001", "like a"),
        ("12", "like b"),
        ("103", "line 4"),
        ("0.015", "like rover_216_5mt"),
    ];
    assert_eq!(
        got,
        want.map(|(value, from)| (value.to_owned(), from.to_owned()))
    );
    // The other order, and the same in one text.
    let text = like("\"b.toml, a.toml\"") + "[road_load]\naltitude_m = 103\n";
    assert_eq!(
        find(&car(&text, &others).unwrap(), "road_load.payload_kg").value,
        "11"
    );
}

#[test]
fn another_option_replaces_that_of_the_parent() {
    let clamp = "[transmission.cvt.clamp.torque_following]\nsafety_factor = 1.4\n";
    for text in [clamp, "[transmission.cvt]\nclamp = \"torque_following\"\n"] {
        let child = car(&(like("\"rover_216_cvt\"") + text), &[]).unwrap();
        assert_eq!(
            find(&child, "transmission.cvt.clamp").value,
            "torque_following"
        );
        assert!(
            child
                .keys
                .iter()
                .all(|info| !info.key.contains("clamp.map"))
        );
    }
    // The same option keeps the rest of its table, by its table and by its word.
    let parent = shipped("rover_216_cvt");
    for text in [
        "[transmission.cvt.clamp.map]\nslow_rpm = 900\n",
        "[transmission.cvt]\nclamp = \"map\"\n",
    ] {
        let child = car(&(like("\"rover_216_cvt\"") + text), &[]).unwrap();
        let key = "transmission.cvt.clamp.map.base_bar";
        assert_eq!(find(&child, key).value, find(&parent, key).value);
    }
}

#[test]
fn a_car_with_another_box_has_no_key_of_the_former_one() {
    let text = like("[\"rover_216_cvt\", \"class:box_manual_6\"]");
    let child = car(&text, &[]).unwrap();
    assert!(!child.transmission().is_cvt());
    assert!(child.keys.iter().all(|info| !info.key.contains("cvt.")));
    // The belt's heat leaves nothing to read and no problem.
    let belt = "thermal.transmission.belt_kj_k";
    assert!(!find(&shipped("rover_216_cvt"), belt).value.is_empty());
    assert!(child.keys.iter().all(|info| info.key != belt));
    assert_eq!(find(&child, "thermal.cooler.fitted").value, "false");
    let engine = "engine.displacement_cc";
    assert_eq!(
        find(&child, engine).value,
        find(&shipped("rover_216_cvt"), engine).value
    );
}

#[test]
fn mistakes_of_a_parent_are_at_their_place() {
    let others = [(
        "a.toml",
        "[vehicle]\nlike = \"rover_216_cvt\"\n[road_load]\nmass_kgs = 3\nmass_kg = -3\n",
    )];
    let problems = car(&like("\"a.toml\""), &others).unwrap_err();
    let places: Vec<String> = problems
        .iter()
        .map(|problem| {
            format!(
                "{}:{} {}",
                problem.place.input, problem.place.line, problem.key
            )
        })
        .collect();
    assert_eq!(
        places,
        [
            "folder/a.toml:4 road_load.mass_kgs",
            "folder/a.toml:5 road_load.mass_kg"
        ]
    );
}

#[test]
fn files_that_a_parent_names_are_found_from_its_folder() {
    let map = "ratio,torque_loss_nm\n0.4,3\n2.5,3\n";
    let oil = std::fs::read_to_string("../../lubricants/dexron_iii.toml").unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("base")).unwrap();
    let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    put("base/map.csv", map);
    put("base/oil.toml", &oil);
    put(
        "base/a.toml",
        "[vehicle]\nlike = \"rover_216_cvt\"\ntransmission_oil = \"./oil.toml\"\n[transmission.cvt.maps]\nbelt = \"map.csv\"\n",
    );
    put("car.toml", &like("\"base/a.toml\""));
    let path = folder.path().join("car.toml");
    let word = path.to_str().unwrap();
    let child = load(word, &Options::default()).unwrap();
    assert_eq!(child.transmission().maps().count(), 1);
    assert_eq!(child.oils().0.title, shipped_oil());
    // A study, which builds the car again from its values.
    let params = ParamSet::load(word, &Options::default()).unwrap();
    let built = params.with("transmission.cvt.belt.band_offset_mm", 2.0);
    let built = built.unwrap();
    assert_eq!(built.vehicle().transmission().maps().count(), 1);
    // The record of a run has all files.
    let parents: Vec<&str> = child
        .origin
        .parents
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    assert!(parents[0].ends_with("base/a.toml"), "{parents:?}");
    assert_eq!(parents[1], "embedded:rover_216_cvt.toml");
}

fn shipped_oil() -> String {
    cvtcycle_config::setup::load_lubricant("dexron_iii")
        .unwrap()
        .0
        .title
}

#[test]
fn overrides_belong_to_the_car_and_studies_see_what_it_inherits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("car.toml");
    std::fs::write(&path, like("\"rover_216_cvt\"")).unwrap();
    let word = path.to_str().unwrap();
    let set = Override::number("transmission.cvt.belt.band_offset_mm", 1.0);
    let options = Options {
        set: vec![set.clone()],
        ..Options::default()
    };
    let changed = load(word, &options).unwrap();
    let info = find(&changed, set.key());
    assert_eq!(
        (&*info.status, &*info.from, &*info.value),
        ("set", "override", "1")
    );
    let params = ParamSet::load(word, &Options::default()).unwrap();
    let param = params.param(set.key()).unwrap();
    assert!((param.base() - 3.0).abs() < 1e-12);
    let built = params.with_numbers(&[(&param, 1.0)]).unwrap();
    assert_eq!(built.keys(), changed.keys);
    let built = Setup::from_params(&built);
    let offset = |setup: &Setup| match setup.transmission() {
        cvtcycle_model::transmission::Transmission::Cvt(cvt) => cvt.belt.band_offset_m,
        cvtcycle_model::transmission::Transmission::Manual(_) => f64::NAN,
    };
    assert_eq!(offset(&built).to_bits(), offset(&changed).to_bits());
    assert!((offset(&built) - 0.001).abs() < 1e-12);
}

#[test]
fn every_class_of_body_makes_a_car_with_every_class_of_box() {
    let (boxes, bodies) = (ClassOf::Box.names(), ClassOf::Body.names());
    assert!(boxes.len() >= 3 && bodies.len() >= 5);
    for body in &bodies {
        for name in &boxes {
            let text = like(&format!("[\"class:{body}\", \"class:{name}\"]"));
            let child = car(&text, &[]).unwrap_or_else(|found| panic!("{body} {name}: {found:?}"));
            let statuses = child
                .keys
                .iter()
                .filter(|info| info.key.starts_with("road_load."));
            assert!(
                statuses
                    .clone()
                    .all(|info| ["class", "default", ""].contains(&&*info.status))
            );
        }
    }
}

/// Every value of a class says how it is known.
#[test]
fn classes_say_where_their_values_come_from() {
    let files = cvtcycle_config::setup::catalogue::files();
    for file in files.iter().filter(|file| file.kind == Kind::Class) {
        // Inherited values are documented in the class that they come from.
        let own = |info: &&KeyInfo| info.status != "class" && info.key != "vehicle.like";
        for info in file.keys.iter().filter(own) {
            let known = ["source", "derived", "assumed", "choice"].contains(&info.status.as_str());
            let sourced = info.status == "choice" || !info.source.is_empty();
            assert!(known && sourced, "{}: {info:?}", file.name);
        }
    }
}

#[test]
fn a_circle_is_named() {
    let own = like("\"a.toml\"");
    let (a, b) = (like("\"./b.toml\""), like("\"car.toml\""));
    let others = [("a.toml", &*a), ("b.toml", &*b), ("car.toml", &*own)];
    let problems = car(&own, &others).unwrap_err();
    assert_eq!(
        problems[0].message,
        "`folder/car.toml` inherits from itself: folder/car.toml -> folder/a.toml -> folder/b.toml -> folder/car.toml"
    );
}
