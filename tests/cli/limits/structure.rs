//! Files within their size limit that hold as much as possible: tables, keys, brackets, lists, mistakes.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::{MIB, folder, refused, refused_once, within};

/// Memory that a TOML file of the largest size may take, MiB.
const TOML_MIB: u64 = 300;

const VEHICLE: &str = "run --vehicle big.toml --cycle short.csv --baseline none";

/// Repeats a piece as often as it fits into the largest TOML file, between a head and a tail.
fn filled(head: &str, piece: &str, tail: &str) -> String {
    let room = usize::try_from(MIB).unwrap() - head.len() - tail.len();
    format!("{head}{}{tail}", piece.repeat(room / piece.len()))
}

fn numbered(piece: impl Fn(usize) -> String) -> String {
    let mut text = String::new();
    for k in 0.. {
        let next = piece(k);
        if text.len() + next.len() > usize::try_from(MIB).unwrap() {
            break;
        }
        text += &next;
    }
    text
}

fn message(dir: &Path, text: &str, line: &str) -> String {
    fs::write(dir.join("big.toml"), text).unwrap();
    refused(dir, TOML_MIB, line)
}

#[test]
fn brackets_and_keys_nested_without_end_are_one_problem() {
    let dir = folder();
    let path = vec!["a"; 40].join(".");
    let few = vec!["a"; 16].join(".");
    let levels = |depth: usize, open: &str, close: &str| {
        format!("x = {}1{}\n", open.repeat(depth), close.repeat(depth))
    };
    let texts = [
        (filled("x = ", "[", ""), "recur"),
        (filled("x = ", "{a=", ""), "too many tables"),
        (format!("x = {}", "[ { a = ".repeat(50)), "recur"),
        (filled("", "a.", "a = 1"), "too many names"),
        (filled("[", "a.", "a]"), "too many names"),
        (
            filled("x = [", &format!("{{{path} = 1}},"), "]"),
            "too many names",
        ),
        (levels(79, "[", "]"), "nested too deep"),
        (levels(79, &format!("{{{few} = "), "}"), "nested too deep"),
        (
            format!("[{few}]\n{}", levels(70, &format!("{{{few} = "), "}")),
            "nested too deep",
        ),
    ];
    for (text, words) in texts {
        fs::write(dir.path().join("big.toml"), &text).unwrap();
        refused_once(dir.path(), TOML_MIB, VEHICLE, &[words]);
    }
}

#[test]
fn tables_without_end_are_one_problem() {
    let dir = folder();
    for text in [
        numbered(|k| format!("[k{k}]\n")),
        filled("", "[[factor]]\n", ""),
        filled("x = [", "{},", "]"),
        filled("x = [", "{a=1},", "]"),
        filled(
            "x = [",
            &format!("{{{} = 1}},", vec!["a"; 16].join(".")),
            "]",
        ),
        numbered(|k| format!("k{k}.a = 1\n")),
    ] {
        fs::write(dir.path().join("big.toml"), &text).unwrap();
        refused_once(
            dir.path(),
            TOML_MIB,
            VEHICLE,
            &["the file has too many tables", "up to 20000 tables"],
        );
    }
}

#[test]
fn as_many_keys_values_and_mistakes_as_fit_are_reported_in_bounded_memory() {
    let dir = folder();
    for (text, words) in [
        // Each unknown key is compared with the known ones.
        (
            numbered(|k| format!("k{k} = 1\n")),
            "more problems are not shown",
        ),
        (
            filled("", "a = 1 # the same key again\n", ""),
            "more problems are not shown",
        ),
        (filled("", "=\n", ""), "too many keys"),
        ("=\n".repeat(100_000), "more problems are not shown"),
        (filled("", "a\n", ""), "more problems are not shown"),
        (filled("a = 1", " b b b b b = 1", ""), "not valid TOML"),
        (filled("x = [", "1,", "]"), "unknown key `x`"),
        (filled("x = [", "[1],", "]"), "unknown key `x`"),
        (
            filled("[engine.full_load]\nrows = [", "[1,\"x\"],", "]"),
            "problems in big.toml",
        ),
        (filled("", "a", " = 1"), "unknown key"),
        (filled("x = \"", "b", "\""), "unknown key `x`"),
        (
            filled("[vehicle]\ntransmission_oil = \"", "b", "\""),
            "there is no lubricant named",
        ),
        (filled("#", "b", "\n[vehicle]\n"), "missing key"),
    ] {
        let message = message(dir.path(), &text, VEHICLE);
        assert!(
            message.contains(words),
            "{:.40}...: no {words:?} in\n{:.3000}",
            text,
            message
        );
    }
}

#[test]
fn lists_of_tables_without_end_are_reported_in_bounded_memory() {
    let dir = folder();
    // Below the limit of tables; each item has problems of its own.
    let many = |head: &str, item: &str| {
        format!(
            "{head}{}",
            item.repeat((20_000 - 10) / item.matches(['[', '{']).count().max(1) / 2)
        )
    };
    for (text, line) in [
        (many("", "[[factor]]\n"), "study big.toml --out nowhere"),
        (
            many("[study]\n", "[[factor]]\nkey = \"a\"\n"),
            "study big.toml --out nowhere",
        ),
        (
            many("[calibration]\n", "[[parameter]]\n"),
            "calibrate big.toml --out nowhere",
        ),
        (
            many("[calibration]\n", "[[data]]\n"),
            "calibrate big.toml --out nowhere",
        ),
        (many("", "[[row]]\n"), "validate --rows big.toml"),
        (
            many("", "[[row]]\nid = \"x\"\n"),
            "validate --rows big.toml",
        ),
    ] {
        let message = message(dir.path(), &text, line);
        assert!(
            message.contains("more problems are not shown"),
            "{line}: {:.2000}",
            message
        );
    }
}

#[test]
fn a_table_of_nothing_but_mistakes_is_reported_in_bounded_memory() {
    let dir = folder();
    let big = |head: &str, row: &str| {
        fs::write(
            dir.path().join("big.csv"),
            head.to_owned() + &row.repeat((16 << 20) / row.len()),
        )
        .unwrap()
    };
    let cycle = "run --cycle big.csv --baseline none";
    let map = "run --cycle short.csv --baseline none --set transmission.cvt.maps.belt=big.csv";
    let data = "calibrate calibration.toml --out nowhere";
    for (head, row, line, mib) in [
        ("time_s,speed_kmh\n", "x,y\n", cycle, 400),
        ("time_s,speed_kmh\n", "\"\n", cycle, 400),
        (
            "ratio,input_speed_rpm,output_torque_nm,torque_loss_nm\n",
            "x,,,\n",
            map,
            400,
        ),
        ("ratio,speed_rpm,total_nm\n", "x,y,z\n", data, 400),
    ] {
        big(head, row);
        let message = refused(dir.path(), mib, line);
        assert!(
            message.contains("more problems are not shown"),
            "{line}: {:.2000}",
            message
        );
    }
    // One line of column names of the maximum length, and rows of commas only.
    let mut names = String::new();
    while names.len() < (1 << 20) - 20 {
        write!(names, "spede_{},", names.len()).unwrap();
    }
    big(&format!("{names}\n"), ",,,,,,,,\n");
    for line in [cycle, map, data] {
        refused_once(dir.path(), 200, line, &["column names", "up to 1000"]);
    }
    big(
        "time_s,speed_kmh\n",
        &format!("{}\n", ",".repeat((1 << 20) - 2)),
    );
    let message = refused(dir.path(), 200, cycle);
    assert!(
        message.contains("this row has 1048575 values"),
        "{:.2000}",
        message
    );
}

/// File of one row with an expression.
fn row(sources: &str, compute: &str) -> String {
    format!(
        "[tolerances.t]\nshare = 0.1\nunit = \"-\"\nfrom = \"x\"\n{sources}\n[[row]]\nid = \"a\"\nchapter = \"x\"\n\
        mechanism = \"geometry\"\nkind = \"C\"\nwhat = \"w\"\nprinted = \"1\"\nvalue = 1\ntolerance = \"t\"\ncompute = \"{compute}\"\n\
        verdict = \"agrees\"\n"
    )
}

#[test]
fn an_expression_without_end_is_one_problem_of_every_command() {
    let dir = folder();
    let calibration = |compute: &str| {
        format!(
            "[calibration]\nvehicle = \"rover_216_cvt\"\n[[parameter]]\nkey = \"transmission.cvt.pump.displacement_cc_rev\"\nlow = 5\n\
            high = 20\n[[data]]\nfrom = \"a test\"\ncompute = \"{compute}\"\nvalue = 1\nsd = 0.1\n"
        )
    };
    let long = |sign: &str, count: usize| vec!["1"; count].join(sign);
    for compute in [
        long("+", 2000),
        long("^", 30_000),
        long(" and ", 30_000),
        filled("", "1-", "1")[..1_000_000].to_owned() + "1",
    ] {
        fs::write(dir.path().join("rows.toml"), row("", &compute)).unwrap();
        fs::write(dir.path().join("fit.toml"), calibration(&compute)).unwrap();
        for line in [
            "validate --only-rows --rows rows.toml",
            "check fit.toml",
            "calibrate fit.toml --out nowhere",
        ] {
            refused_once(
                dir.path(),
                64,
                line,
                &["more than 1000 words, numbers and signs"],
            );
        }
    }
    assert!(!dir.path().join("nowhere").exists());
}

#[test]
fn loops_without_end_are_one_problem() {
    let dir = folder();
    let each = (0..30).fold("1 == 1".to_owned(), |inner, k| {
        format!("each(a{k} in 0,1,2,3,4,5,6,7,8,9: {inner})")
    });
    let sum = (0..9).fold("loss_nm".to_owned(), |inner, _| format!("sum(b: {inner})"));
    let belt = "[sources.b]\nsource = \"belt\"\nratio = [0.5, 1]\nspeed_rpm = 2000\npressure_bar = 20\ntorque_nm = \"0..60:10\"\n";
    let each = row("", &each).replace("value = 1\ntolerance = \"t\"\n", "");
    for text in [each, row(belt, &sum)] {
        fs::write(dir.path().join("rows.toml"), text).unwrap();
        let line = "validate --only-rows --rows rows.toml";
        refused_once(dir.path(), 64, line, &["more than 100000000 evaluations"]);
    }
}

/// Cycles and grids of a few bytes that expand to millions of rows.
#[test]
fn rows_that_are_kept_are_counted_before_anything_is_computed() {
    let dir = folder();
    let points: Vec<String> = (0..27)
        .map(|k| format!("[{}, {}]", k * 3590, 50 * (k % 2)))
        .collect();
    let run = format!(
        "[sources.g]\nsource = \"run\"\ndt_s = 0.01\npoints = [{}]\n",
        points.join(", ")
    );
    let bench = |k: usize| {
        format!(
            "[sources.g{k}]\nsource = \"bench\"\nratio = [0.5, 1, 2]\nspeed_rpm = \"1000..6000:1\"\ntemp_degc = \"20..29:1\"\n"
        )
    };
    let benches: String = (0..12).map(bench).collect();
    let transient = "[sources.g]\nsource = \"transient\"\nratio = \"0.5..2.4:0.002\"\n";
    for (sources, compute, words) in [
        (run.as_str(), "max(g: time_s)", "take a dt_s of 0.2 or more"),
        (
            &benches,
            "max(g0: total_nm)",
            "the sources have 600120 rows together with this one",
        ),
        (transient, "max(g: time_s)", "rows together with this one"),
    ] {
        fs::write(dir.path().join("rows.toml"), row(sources, compute)).unwrap();
        refused_once(
            dir.path(),
            64,
            "validate --only-rows --rows rows.toml",
            &[words],
        );
        let calibration = format!(
            "[calibration]\nvehicle = \"rover_216_cvt\"\n{sources}[[parameter]]\nkey = \"transmission.cvt.pump.displacement_cc_rev\"\n\
            low = 5\nhigh = 20\n[[data]]\nfrom = \"a test\"\ncompute = \"{compute}\"\nvalue = 1\nsd = 0.1\n"
        );
        fs::write(dir.path().join("fit.toml"), calibration).unwrap();
        for line in ["check fit.toml", "calibrate fit.toml --out nowhere"] {
            refused_once(dir.path(), 64, line, &[words]);
        }
    }
    let cycle: String = (0..=19_944)
        .map(|k| format!("{},{}\n", k * 50, 50 * (k % 2)))
        .collect();
    fs::write(
        dir.path().join("long.csv"),
        format!("time_s,speed_kmh\n{cycle}"),
    )
    .unwrap();
    let plan = |dt: &str, factor: &str| {
        format!(
            "[study]\nvehicle = \"rover_216_5mt\"\nbaselines = []\ncycle = \"long.csv\"\ndt_s = {dt}\nkeep = \"everything\"\n\
            design = \"grid\"\n[[factor]]\n{factor}\n"
        )
    };
    for text in [
        plan("0.1", "key = \"ambient_degc\"\nvalues = [0, 10]"),
        plan("10", "key = \"dt_s\"\nvalues = [0.1]"),
    ] {
        fs::write(dir.path().join("plan.toml"), text).unwrap();
        for line in [
            "check plan.toml",
            "study plan.toml",
            "study plan.toml --out nowhere",
        ] {
            refused_once(dir.path(), 64, line, &["steps of 0.1 s"]);
        }
    }
    assert!(!dir.path().join("nowhere").exists());
    // A run that keeps its steps, and one that does not.
    let run = "run --cycle long.csv --vehicle rover_216_5mt --baseline none --quiet --dt 0.1";
    refused_once(
        dir.path(),
        64,
        &format!("{run} --out nowhere"),
        &[
            "--dt: the run keeps 9972000 steps of 0.1 s",
            "take a step of 0.5 s or more",
        ],
    );
    assert!(!dir.path().join("nowhere").exists());
    let short: String = (0..=4032)
        .map(|k| format!("{},{}\n", k * 50, 50 * (k % 2)))
        .collect();
    let short = format!("time_s,speed_kmh\n{short}");
    fs::write(dir.path().join("long.csv"), short).unwrap();
    refused(dir.path(), 64, &format!("{run} --out nowhere"));
    let output = within(dir.path(), 64, run);
    let printed = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{printed}");
}

#[test]
fn json_of_more_values_than_any_result_is_one_problem() {
    let dir = folder();
    let made = dir.path().join("made");
    fs::create_dir(&made).unwrap();
    let filled = |head: &str, piece: &str, tail: &str| {
        format!("{head}{}{tail}", piece.repeat((60 << 20) / piece.len()))
    };
    for (head, piece, tail) in [
        ("{\"schema\": 1, \"runs\": [", "1,", "1]}"),
        ("{\"schema\": 1, \"runs\": [", "[],", "1]}"),
        ("{\"schema\": 1, \"runs\": ", "[", ""),
    ] {
        let text = filled(head, piece, tail);
        for (name, line) in [
            ("summary.json", "report made --out r.html"),
            ("study.json", "study show made"),
            ("study.json", "study short.toml --out made --resume"),
        ] {
            fs::write(made.join(name), &text).unwrap();
            fs::write(dir.path().join("short.toml"), PLAN).unwrap();
            let words = ["the file has more than 1000000 values", name];
            if line.ends_with("resume") {
                refused(dir.path(), 256, line);
            } else {
                refused_once(dir.path(), 256, line, &words);
            }
            fs::remove_file(made.join(name)).unwrap();
        }
    }
    // One text counts as one value, whatever it contains.
    let text = filled("{\"schema\": 1, \"x\": \"", "[,", "\"}");
    fs::write(made.join("summary.json"), text).unwrap();
    let printed = refused(dir.path(), 256, "report made --out r.html");
    assert!(
        printed.contains("not as this program writes it"),
        "{printed:.1000}"
    );
}

const PLAN: &str = "[study]\ntitle = \"t\"\nvehicle = \"rover_216_cvt\"\nbaselines = []\ncycle = \"ece15\"\n[study.design.grid]\n\
    [[factor]]\nkey = \"road_load.mass_kg\"\nvalues = [1000, 1100]\n";
