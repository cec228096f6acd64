//! Pipes and devices: without a size they are read up to the limit. Files may not name them.

use std::fs;
use std::process::{Child, Command};

use super::{folder, refused_once, within};

/// Creates a pipe in the folder, and a shell that writes into it.
fn pipe(dir: &std::path::Path, name: &str, writer: Option<&str>) -> Option<Child> {
    let made = Command::new("mkfifo").arg(dir.join(name)).status().unwrap();
    assert!(made.success());
    writer.map(|writer| {
        Command::new("sh")
            .current_dir(dir)
            .args(["-c", &format!("{writer} > {name} 2>/dev/null")])
            .spawn()
            .unwrap()
    })
}

#[test]
fn devices_and_pipes_without_end_are_read_up_to_the_limit() {
    let dir = folder();
    refused_once(
        dir.path(),
        64,
        "run --vehicle /dev/zero --cycle short.csv --baseline none",
        &["it has more than 1 MiB", "up to 1 MiB"],
    );
    refused_once(
        dir.path(),
        700,
        "run --cycle /dev/zero --baseline none",
        &["it has more than 256 MiB", "up to 256 MiB"],
    );
    let mut writer = pipe(dir.path(), "endless.csv", Some("yes")).unwrap();
    refused_once(
        dir.path(),
        700,
        "run --cycle endless.csv --baseline none",
        &["it has more than 256 MiB"],
    );
    // It ended when the reader closed the pipe.
    writer.wait().unwrap();
}

#[test]
fn a_pipe_that_the_user_names_is_read() {
    let dir = folder();
    let mut writer = pipe(dir.path(), "piped.csv", Some("cat short.csv")).unwrap();
    let output = within(
        dir.path(),
        64,
        "run --cycle piped.csv --baseline none --quiet",
    );
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(writer.wait().unwrap().success());
}

#[test]
fn a_pipe_that_a_file_names_is_not_waited_for() {
    let dir = folder();
    let words = ["it is a pipe or a device and no file"];
    pipe(dir.path(), "big.csv", None);
    refused_once(
        dir.path(),
        64,
        "calibrate calibration.toml --out nowhere",
        &words,
    );
    refused_once(
        dir.path(),
        64,
        "run --cycle short.csv --baseline none --set transmission.cvt.maps.belt=big.csv",
        &words,
    );
    pipe(dir.path(), "oil.toml", None);
    let car = cvtcycle::config::setup::embedded_vehicles()
        .iter()
        .find(|(name, _)| *name == "rover_216_cvt")
        .unwrap()
        .1;
    let line = car
        .lines()
        .find(|line| line.starts_with("transmission_oil"))
        .unwrap();
    fs::write(
        dir.path().join("car.toml"),
        car.replace(line, "transmission_oil = \"oil.toml\""),
    )
    .unwrap();
    refused_once(
        dir.path(),
        64,
        "run --cycle short.csv --baseline none --vehicle car.toml",
        &words,
    );
    fs::create_dir(dir.path().join("made")).unwrap();
    pipe(dir.path(), "made/summary.json", None);
    refused_once(dir.path(), 64, "report made --out r.html", &words);
}
