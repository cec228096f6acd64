//! `fmu`: the written file and refused options. tools/fmu runs the contents of the file.

use std::fs::{self, File};
use std::io::Read;

use super::{run_in, stderr};

/// First bytes of a shared library for Linux on x86-64. The program checks no others.
fn library() -> Vec<u8> {
    let mut bytes = b"\x7fELF\x02\x01\x01".to_vec();
    bytes.resize(18, 0);
    bytes.extend([62, 0]);
    bytes.resize(64, 0);
    bytes
}

/// The FMU contains the description, the files of the car, and the library under the name in the description. Equal input gives equal bytes.
#[test]
fn an_fmu_has_all_that_it_needs() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("own.so"), library()).unwrap();
    for (fmi, place) in [("2", "binaries/linux64"), ("3", "binaries/x86_64-linux")] {
        let words = ["fmu", "civic_20_cvt", "--fmi", fmi, "--library", "own.so"];
        let out = run_in(dir, &[&words[..], &["--out", "a.fmu", "--force"]].concat());
        assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
        let out = run_in(dir, &[&words[..], &["--out", "b.fmu", "--force"]].concat());
        assert_eq!(out.status.code(), Some(0), "{}", stderr(&out));
        let [a, b] = ["a.fmu", "b.fmu"].map(|name| fs::read(dir.join(name)).unwrap());
        assert!(a == b);
        let mut archive = zip::ZipArchive::new(File::open(dir.join("a.fmu")).unwrap()).unwrap();
        let names: Vec<String> = archive
            .file_names()
            .map(|name| name.unwrap().into_owned())
            .collect();
        for name in [
            "modelDescription.xml".to_owned(),
            "documentation/index.html".to_owned(),
            format!("{place}/civic_20_cvt_car.so"),
            "resources/car.json".to_owned(),
            "resources/vehicle/civic_20_cvt.toml".to_owned(),
        ] {
            assert!(names.contains(&name), "{name} is not in {names:?}");
        }
        let mut text = String::new();
        let mut file = archive.by_name("modelDescription.xml").unwrap();
        file.read_to_string(&mut text).unwrap();
        let xml = roxmltree::Document::parse(&text).unwrap();
        let version = xml.root_element().attribute("fmiVersion");
        assert_eq!(version, Some(format!("{fmi}.0").as_str()));
        let name = |node: roxmltree::Node| node.attribute("name") == Some("v_VEH_PNT_in_mps");
        assert!(xml.descendants().any(name));
    }
}

/// All problems are reported at once, each with its option, and no file is left.
#[test]
fn fmu_reports_all_problems_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let dir = folder.path();
    fs::write(dir.join("own.so"), library()).unwrap();
    fs::write(dir.join("text.so"), "no library").unwrap();
    for (words, says) in [
        (vec!["--kind", "cars"], "did you mean `car`"),
        (vec!["--fmi", "1"], "one of 2, 3"),
        (
            vec!["--library", "none.so"],
            "cargo build --release -p cvtcycle-fmu-library",
        ),
        (vec!["--library", "text.so"], "no such library"),
        (
            vec!["--library", "own.so", "--library", "own.so"],
            "a second library",
        ),
        (vec!["--set", "road_load.mass_kg=-1"], "road_load.mass_kg"),
        (vec!["--kind", "cars", "--fmi", "1"], "--fmi"),
    ] {
        let out = run_in(
            dir,
            &[&["fmu", "rover_216_cvt"][..], &words, &["--out", "a.fmu"]].concat(),
        );
        assert_eq!(out.status.code(), Some(2), "{words:?}");
        assert!(stderr(&out).contains(says), "{words:?}: {}", stderr(&out));
        assert!(!dir.join("a.fmu").exists());
    }
    let unknown = run_in(
        dir,
        &["fmu", "rover", "--library", "own.so", "--out", "a.fmu"],
    );
    assert!(stderr(&unknown).contains("there is no vehicle named `rover`"));
}
