//! Files of a gigabyte, lines of a hundred megabytes, files at their limit and one byte above it.

use std::fs;
use std::io::Write;
use std::path::Path;

use cvtcycle::config::bounded::{self, LOG, LOGO, Limit, RECORD, TABLE, TOML, TRACE};
use cvtcycle::config::cycle;
use cvtcycle::config::setup::{self, Options};

use crate::sources::{Source, sources};

use super::{MIB, folder, refused, refused_once, short_run, sparse, within};

/// Size of the large test files.
const GIGABYTE: u64 = 1 << 30;
const SIZE: &str = "it has 1073741824 bytes";

/// Commands that read a file, with the limit of its kind.
const READERS: [(&str, Limit); 13] = [
    (
        "run --vehicle big.toml --cycle short.csv --baseline none",
        TOML,
    ),
    ("run --cycle short.csv --baseline big.toml", TOML),
    (
        "run --cycle short.csv --baseline none --lubricant big.toml",
        TOML,
    ),
    (
        "run --cycle short.csv --baseline none --engine-oil big.toml",
        TOML,
    ),
    ("study big.toml --out nowhere", TOML),
    ("calibrate big.toml --out nowhere", TOML),
    ("validate --rows big.toml", TOML),
    ("check big.toml", TOML),
    ("check big.csv", LOG),
    ("show big.toml", TOML),
    ("run --cycle big.csv --baseline none", LOG),
    (
        "run --cycle short.csv --baseline none --set transmission.cvt.maps.belt=big.csv",
        TABLE,
    ),
    ("calibrate calibration.toml --out nowhere", TABLE),
];

#[test]
fn a_file_of_a_gigabyte_is_refused_without_being_read() {
    let dir = folder();
    for name in ["big.toml", "big.csv"] {
        sparse(&dir.path().join(name), GIGABYTE);
    }
    for (line, limit) in READERS {
        refused_once(dir.path(), 64, line, &[SIZE, &limit.allowed(), limit.hint]);
    }
    // Read line by line without a limit of the file; the first line has zeros only.
    refused_once(
        dir.path(),
        64,
        "belt --points big.csv",
        &["the file is not text: it has a zero byte in line 1"],
    );
    assert!(!dir.path().join("nowhere").exists());
}

#[test]
fn results_of_a_gigabyte_are_refused_without_being_read() {
    let dir = folder();
    short_run(dir.path());
    let path = |name: &str| dir.path().join("made").join(name);
    let kept = |name: &str| fs::read(path(name)).unwrap();
    for (name, limit) in [
        ("trace_rover_216_cvt.csv", TRACE),
        ("inputs.json", RECORD),
        ("summary.json", RECORD),
    ] {
        let content = kept(name);
        sparse(&path(name), GIGABYTE);
        refused_once(
            dir.path(),
            64,
            "report made --out r.html",
            &[SIZE, &limit.allowed(), name],
        );
        fs::write(path(name), content).unwrap();
    }
    // A footer of zeros is invalid. Without the record any trace is read.
    fs::remove_file(path("inputs.json")).unwrap();
    fs::remove_file(path("trace_rover_216_cvt.csv")).unwrap();
    sparse(&path("trace_rover_216_cvt.parquet"), GIGABYTE);
    let message = refused(dir.path(), 64, "report made --out r.html");
    assert!(message.contains("trace_rover_216_cvt.parquet"), "{message}");
    fs::remove_file(path("trace_rover_216_cvt.parquet")).unwrap();
    sparse(&path("study.json"), GIGABYTE);
    for line in [
        "report made --out r.html",
        "study show made",
        "study export made --out r.csv",
    ] {
        refused_once(
            dir.path(),
            64,
            line,
            &[SIZE, &RECORD.allowed(), "study.json"],
        );
    }
    fs::remove_file(path("study.json")).unwrap();
    sparse(&dir.path().join("big.png"), GIGABYTE);
    fs::write(dir.path().join("cover.toml"), "logo = \"big.png\"\n").unwrap();
    refused_once(
        dir.path(),
        64,
        "report made --out r.html --cover cover.toml",
        &["the logo has 1073741824 bytes", LOGO.hint],
    );
    assert!(!dir.path().join("r.html").exists());
}

#[test]
fn a_line_of_a_hundred_megabytes_is_refused() {
    let dir = folder();
    let long = |bytes: usize, name: &str| {
        let mut file = fs::File::create(dir.path().join(name)).unwrap();
        let piece = vec![b'1'; 1 << 20];
        (0..bytes >> 20).for_each(|_| file.write_all(&piece).unwrap());
    };
    long(100 << 20, "big.csv");
    refused_once(
        dir.path(),
        64,
        "run --cycle short.csv --baseline none --set transmission.cvt.maps.belt=big.csv",
        &["it has 104857600 bytes"],
    );
    refused_once(
        dir.path(),
        64,
        "belt --points big.csv",
        &["line 1 is too long for a row of a table"],
    );
    // Below the limit of the file.
    long(60 << 20, "big.csv");
    let words = [
        "line 1 is too long for a row of a table",
        "up to 1048576 bytes",
    ];
    for line in [
        "run --cycle big.csv --baseline none",
        "run --cycle short.csv --baseline none --set transmission.cvt.maps.belt=big.csv",
        "calibrate calibration.toml --out nowhere",
    ] {
        refused_once(dir.path(), 128, line, &words);
    }
}

#[test]
fn a_file_at_its_limit_is_read_and_one_byte_more_is_not() {
    let dir = folder();
    let path = |name: &str| dir.path().join(name).to_str().unwrap().to_owned();
    let (_, shipped) = setup::embedded_lubricants()[0];
    let size = usize::try_from(TOML.bytes).unwrap();
    for (more, is_read) in [(0, true), (1, false)] {
        let name = path("oil.toml");
        fs::write(
            &name,
            format!(
                "{shipped}\n#{}",
                "x".repeat(size + more - shipped.len() - 2)
            ),
        )
        .unwrap();
        assert_eq!(fs::metadata(&name).unwrap().len(), TOML.bytes + more as u64);
        let read = setup::load_lubricant(&name);
        assert_eq!(
            read.as_ref()
                .err()
                .map(|problems| problems[0].allowed.as_str()),
            (!is_read).then_some("up to 1 MiB")
        );
        let name = path("cycle.csv");
        fs::write(
            &name,
            padded("time_s,speed_kmh\n0,0\n10,20\n", LOG.bytes + more as u64),
        )
        .unwrap();
        let read = cycle::find(&name);
        assert_eq!(
            read.as_ref()
                .err()
                .map(|problems| problems[0].allowed.as_str()),
            (!is_read).then_some("up to 256 MiB")
        );
    }
    // Results: reads the bytes only.
    for limit in [RECORD, LOGO] {
        for (more, is_read) in [(0, true), (1, false)] {
            sparse(Path::new(&path("result")), limit.bytes + more);
            assert_eq!(bounded::read_file(path("result"), limit).is_ok(), is_read);
        }
    }
}

/// Pads a table with blank lines.
fn padded(table: &str, bytes: u64) -> Vec<u8> {
    let mut text = table.as_bytes().to_vec();
    while (text.len() as u64) < bytes {
        let rest = (bytes - text.len() as u64).min(MIB / 2) - 1;
        text.resize(text.len() + usize::try_from(rest).unwrap(), b' ');
        text.push(b'\n');
    }
    text
}

#[test]
fn a_setup_is_read_under_the_same_bound() {
    // The memory bound of the other tests suffices for normal input.
    let dir = folder();
    let output = within(
        dir.path(),
        64,
        "run --cycle short.csv --baseline none --quiet",
    );
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    assert!(setup::load("rover_216_cvt", &Options::default()).is_ok());
}

/// Modules that open files directly, with the reason.
const DIRECT_READERS: [(&str, &str); 7] = [
    ("config::csv::stream", "the first bytes of a stream"),
    ("config::files::bounded", "has the limits"),
    ("cvtcycle::commands::belt", "reads line by line"),
    (
        "output::files::lock",
        "directories, to be locked and synced",
    ),
    ("report::results", "the checksum of a trace"),
    (
        "report::write",
        "the first and the last bytes of an earlier report",
    ),
    (
        "study::store::footer",
        "the footer of a part, as long as the part says and no longer than its limit",
    ),
];

#[test]
fn every_file_is_read_through_its_limit() {
    let calls = [
        "fs::read(",
        "read_to_string(",
        "read_to_end(",
        "File::open(",
    ];
    // Excludes longer names such as `LeverFile::open(`.
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let opens = |source: &Source| {
        let ends = |call: &&str| {
            let calls = source.code.match_indices(*call);
            calls.map(|(at, _)| &source.code[..at]).collect::<Vec<_>>()
        };
        calls
            .iter()
            .flat_map(ends)
            .any(|before| !before.ends_with(is_name))
    };
    let found = sources().into_iter().filter(opens);
    let found: Vec<String> = found.map(|source| source.module).collect();
    let own = DIRECT_READERS.map(|(module, _)| module);
    assert_eq!(
        found, own,
        "read files through config::bounded, or give the reason here"
    );
}
