//! Statistics of a study, recomputed from the exported rows: Saltelli blocks, one at a time, groups of words.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::{FACTORS, ends, folder, stderr};

const HEAD: &str = r#"
[study]
title = "three factors"
question = "Which of them moves the fuel?"
vehicle = "rover_216_cvt"
baselines = ["rover_216_5mt"]
cycle = "minute.csv"
ambient_degc = -10
analyse = ["headline_fuel_l_per_100km", "subject_excess_percent"]
"#;
const START: &str = r#"
[[factor]]
key = "start"
values = ["soak", "warm"]
"#;
const FUEL: &str = "headline_fuel_l_per_100km";
const CVT: &str = "rover_216_cvt";

fn plan(design: &str) -> String {
    format!("{HEAD}\n{design}\n{FACTORS}{START}")
}

/// Replaces line breaks by spaces.
fn flat(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Rows of a CSV file by column name without unit.
fn rows(file: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(file).unwrap();
    let mut reader = csv::Reader::from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let names: Vec<String> = reader
        .headers()
        .unwrap()
        .iter()
        .map(|name| name.split(" [").next().unwrap().to_owned())
        .collect();
    reader
        .records()
        .map(|row| {
            names
                .iter()
                .cloned()
                .zip(row.unwrap().iter().map(str::to_owned))
                .collect()
        })
        .collect()
}

fn number(row: &BTreeMap<String, String>, name: &str) -> f64 {
    row[name]
        .parse()
        .unwrap_or_else(|_| panic!("{name}: `{}`", row[name]))
}

/// Runs a study; returns its output and the exported rows of the subject.
fn studied(dir: &Path, words: &[&str]) -> (String, Vec<BTreeMap<String, String>>) {
    let printed = ends(
        dir,
        &[&["study", "plan.toml", "--out", "out"], words].concat(),
        0,
    );
    ends(
        dir,
        &[
            "study", "export", "out", "--out", "rows.csv", "--quiet", "--force",
        ],
        0,
    );
    let own = rows(&dir.join("rows.csv"))
        .into_iter()
        .filter(|row| row["vehicle"] == CVT)
        .collect();
    (String::from_utf8(printed.stdout).unwrap(), own)
}

/// Report of a study as Markdown.
fn reported(dir: &Path) -> String {
    ends(dir, &["report", "out", "--out", "report.md", "--quiet"], 0);
    fs::read_to_string(dir.join("report.md")).unwrap()
}

/// Truth: SO-1 to SO-4 by definition, from rows whose factors identify sample and block.
#[test]
fn val_blocks_of_saltelli() {
    let dir = folder(&plan("[study.design.saltelli]\nsamples = 32\nseed = 3\n"));
    let (printed, own) = studied(dir.path(), &[]);
    let keys = [
        "transmission.cvt.pump.displacement_cc_rev",
        "engine.electrical_w",
        "start",
    ];
    assert_eq!(own.len(), 32 * (keys.len() + 2));
    let factors = |row: &BTreeMap<String, String>| keys.map(|key| row[key].clone());
    let all: Vec<f64> = own.iter().map(|row| number(row, FUEL)).collect();
    let centre = all.iter().sum::<f64>() / all.len() as f64;
    let samples: Vec<_> = own.chunks_exact(keys.len() + 2).collect();
    let y = |row: &BTreeMap<String, String>| number(row, FUEL) - centre;
    let both: Vec<f64> = samples
        .iter()
        .flat_map(|block| [y(&block[0]), y(&block[1])])
        .collect();
    let mean = both.iter().sum::<f64>() / 64.0;
    let variance = both.iter().map(|f| f * f).sum::<f64>() / 64.0 - mean * mean;
    let file = rows(&dir.path().join("out/sobol_indices.csv"));
    for (i, name) in ["pump", "current", "start"].into_iter().enumerate() {
        let (mut first, mut total) = (0.0, 0.0);
        for block in &samples {
            let (a, b) = (factors(&block[0]), factors(&block[1]));
            let mut mixed = a.clone();
            mixed[i].clone_from(&b[i]);
            assert_eq!(factors(&block[2 + i]), mixed, "A with {name} of B");
            let step = y(&block[2 + i]) - y(&block[0]);
            first += y(&block[1]) * step / 32.0;
            total += step * step / 32.0;
        }
        let named = |row: &&BTreeMap<String, String>| {
            row["factor"] == name
                && row["car"] == CVT
                && row["output"] == FUEL
                && row["samples"] == "32"
        };
        let row = file.iter().find(named).unwrap();
        for (column, want) in [
            ("first", first / variance),
            ("total", total / (2.0 * variance)),
        ] {
            let got = number(row, column);
            assert!(
                (got - want).abs() < 1e-9,
                "{name}: {column} {got}, by hand {want}"
            );
            let shown = format!("{want:.3}");
            let line = printed
                .lines()
                .skip_while(|line| !line.starts_with("Effects on headline"))
                .find(|line| line.contains(name));
            assert!(
                line.unwrap().contains(shown.trim_start_matches('-')),
                "{shown} is not in {line:?}"
            );
        }
        assert!(
            number(row, "first_low95") <= number(row, "first")
                && number(row, "total") <= number(row, "total_high95")
        );
    }
    // The answer names the most important factor first. With 32 samples its share is too uncertain to state the remaining spread.
    assert!(
        flat(&printed).contains("32 samples are too few to say what knowing start would leave"),
        "{printed}"
    );
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(dir.path().join("out/statistics.json")).unwrap()).unwrap();
    let of = &json["outputs"][0]["information"];
    let largest = &of["factors"][0];
    assert!(
        largest["name"] == "start" && of["noise"].is_number() && largest["above_chance"] == true
    );
    let [sd, share, left] = [
        &of["sd"],
        &largest["share"]["value"],
        &largest["sd_left"]["value"],
    ]
    .map(|x| x.as_f64().unwrap());
    assert!(
        (sd - variance.sqrt()).abs() < 1e-9 && (left - sd * (1.0 - share).sqrt()).abs() < 1e-12
    );
    assert!(
        printed.contains("Which of them moves the fuel?")
            && printed.contains("Saltelli blocks of 32 samples, seed 3")
    );
    let page = reported(dir.path());
    assert!(
        flat(&page).contains("32 samples are too few to say what knowing start would leave")
            && page.contains("Which of them moves the fuel?"),
        "{page}"
    );
    // Reading it later gives the same answer.
    let again = ends(dir.path(), &["study", "show", "out"], 0);
    let again = String::from_utf8(again.stdout).unwrap();
    let answer = |text: &str| {
        text[text.find(" uses more fuel than ").unwrap()..]
            .split("\nFiles written")
            .next()
            .unwrap()
            .trim_end()
            .to_owned()
    };
    assert_eq!(answer(&again), answer(&printed));
}

/// Truth: TO-1 from the rows: the base is the first point, every other one differs from it in one factor.
#[test]
fn val_one_at_a_time() {
    let dir = folder(&plan("[study.design.one_at_a_time]\n"));
    let (printed, own) = studied(dir.path(), &[]);
    let base = number(&own[0], FUEL);
    let file = rows(&dir.path().join("out/tornado.csv"));
    let mut widths = Vec::new();
    for (k, name) in ["pump", "current", "start"].into_iter().enumerate() {
        let [low, high] = [1, 2].map(|end| number(&own[2 * k + end], FUEL));
        let swing = high.max(low).max(base) - low.min(high).min(base);
        let levels: Vec<_> = file
            .iter()
            .filter(|row| row["factor"] == name && row["car"] == CVT && row["output"] == FUEL)
            .collect();
        assert_eq!(levels.len(), 2);
        for (row, (end, want)) in levels.iter().zip([("low", low), ("high", high)]) {
            assert_eq!(row["end"], end);
            for (column, want) in [
                ("base", base),
                ("value", want),
                ("effect", want - base),
                ("swing", swing),
            ] {
                assert!(
                    (number(row, column) - want).abs() < 1e-12,
                    "{name}: {column}"
                );
            }
        }
        widths.push((swing, name));
        let line = printed
            .lines()
            .skip_while(|line| !line.starts_with("Effects on headline"))
            .find(|line| line.contains(name))
            .unwrap();
        assert!(
            line.ends_with(&format!("{swing:.3}")),
            "{swing} is not at the end of {line}"
        );
    }
    assert!(flat(&reported(dir.path())).contains(" by itself moves it most, over "));
    assert!(
        flat(&printed).contains(" by itself moves it most, over "),
        "{printed}"
    );
    // Uniform from 7 to 11: the quantiles 0.05 and 0.95 are 7.2 and 10.8.
    let pump: Vec<f64> = own[1..3]
        .iter()
        .map(|row| number(row, "transmission.cvt.pump.displacement_cc_rev"))
        .collect();
    assert!(
        (pump[0] - 7.2).abs() < 1e-9 && (pump[1] - 10.8).abs() < 1e-9,
        "{pump:?}"
    );
    widths.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut order: Vec<&str> = file
        .iter()
        .filter(|row| row["car"] == CVT && row["output"] == FUEL)
        .map(|row| row["factor"].as_str())
        .collect();
    order.dedup();
    assert_eq!(
        order,
        widths.iter().map(|(_, name)| *name).collect::<Vec<_>>()
    );
}

/// Truth: the exported rows. All seven levels are printed with their effects in the order of the plan, and the ends are named with their levels. Mean and
/// deviation are not printed, because the points are not a sample.
#[test]
fn one_at_a_time_prints_every_level_and_no_mean() {
    let factor = "[[factor]]\nkey = \"transmission.cvt.pump.displacement_cc_rev\"\nname = \"pump\"\nrange = { from = 6, to = 12, step = 1 }\n";
    let dir = folder(&format!("{HEAD}\n[study.design.one_at_a_time]\n{factor}"));
    let (printed, own) = studied(dir.path(), &[]);
    assert_eq!(own.len(), 8);
    let fuels: Vec<f64> = own.iter().map(|row| number(row, FUEL)).collect();
    let lines: Vec<Vec<&str>> = printed
        .lines()
        .skip_while(|line| !line.starts_with("Effects on headline"))
        .skip(3)
        .take(7)
        .map(|line| line.split_whitespace().collect())
        .collect();
    for (k, (line, fuel)) in lines.iter().zip(&fuels[1..]).enumerate() {
        let first = usize::from(k == 0);
        let effect = fuel - fuels[0];
        assert_eq!(line[first], (k + 6).to_string(), "{line:?}");
        assert_eq!(line[first + 2], format!("{fuel:.3}"));
        assert!(
            (line[first + 3].parse::<f64>().unwrap() - effect).abs() < 6e-4,
            "{line:?}"
        );
    }
    let json = fs::read(dir.path().join("out/statistics.json")).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let output = &json["outputs"][0];
    assert!(output["summary"].is_null() && json["comparisons"][0]["excess_percent"].is_null());
    assert!(json["comparisons"][0]["worse"]["interval"].is_null());
    let range = &output["range"];
    assert_eq!(range["least_at"], "pump 6 cm\u{b3}/rev");
    assert_eq!(range["largest_at"], "pump 12 cm\u{b3}/rev");
    assert!((range["least"].as_f64().unwrap() - fuels[1]).abs() < 1e-12);
    let csv = rows(&dir.path().join("out/statistics.csv"));
    let of_fuel = csv
        .iter()
        .find(|row| row["output"] == FUEL && row["car"] == CVT)
        .unwrap();
    assert!(
        of_fuel["mean"].is_empty()
            && of_fuel["sd"].is_empty()
            && of_fuel["quantile_0.5"].is_empty()
    );
    assert_eq!(
        (of_fuel["n"].as_str(), of_fuel["max_at"].as_str()),
        ("8", "pump 12 cm\u{b3}/rev")
    );
    // The manual box has no pump, so its fuel is constant.
    let manual = &json["outputs"][1];
    assert_eq!(
        (manual["range"]["least_at"].as_str(), manual["car"].as_str()),
        (Some("everywhere"), Some("rover_216_5mt"))
    );
    for text in [&printed, &reported(dir.path())] {
        assert!(
            !text.contains("on average")
                && !text.contains(" sd ")
                && !text.contains("standard deviation"),
            "{text}"
        );
        assert!(text.contains("pump 12 cm\u{b3}/rev"), "{text}");
    }
}

/// Truth: Student's t of 31 degrees of freedom at 0.9 (1.3095, printed in tables) against 0.975 (2.0395): equal numbers with other intervals and
/// texts.
#[test]
fn another_confidence_changes_the_intervals_only() {
    let dir = folder(&plan(
        "[study.design.latin_hypercube]\nsamples = 32\nseed = 3\n",
    ));
    let answers = |words: &[&str]| {
        let (printed, _) = studied(dir.path(), &[words, &["--force"]].concat());
        let json = fs::read(dir.path().join("out/statistics.json")).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
        (printed, json, rows(&dir.path().join("out/statistics.csv")))
    };
    let (usual, json, table) = answers(&[]);
    let (given, json80, table80) = answers(&["--confidence", "0.8"]);
    let half = |json: &serde_json::Value| {
        let of = &json["outputs"][0]["summary"];
        let ends = [0, 1].map(|k| of["mean_interval"][k].as_f64().unwrap());
        (of["mean"].as_f64().unwrap(), 0.5 * (ends[1] - ends[0]))
    };
    let ((mean, wide), (mean80, narrow)) = (half(&json), half(&json80));
    assert_eq!(mean.to_bits(), mean80.to_bits());
    assert!(
        (narrow / wide - 1.3095 / 2.0395).abs() < 1e-4,
        "{narrow} {wide}"
    );
    let share = |json: &serde_json::Value, k: usize| {
        json["comparisons"][0]["worse"]["interval"][k].as_f64()
    };
    assert!(share(&json80, 0) > share(&json, 0));
    let spearman = |json: &serde_json::Value| {
        let ends = &json["outputs"][0]["rank"]["of"]["factors"][0]["spearman"]["interval"];
        ends[1].as_f64().unwrap() - ends[0].as_f64().unwrap()
    };
    assert!(spearman(&json80) < spearman(&json));
    assert!(
        flat(&usual).contains("(95 % interval") && flat(&usual).contains("32 runs are"),
        "{usual}"
    );
    assert!(
        flat(&given).contains("(80 % interval") && flat(&given).contains("80 % of the runs are"),
        "{given}"
    );
    assert!(table[0].contains_key("mean_low95") && table80[0].contains_key("mean_low80"));
    assert!(table80[0].contains_key("quantile_0.1") && table80[0].contains_key("quantile_0.9"));
    // The answer of a finished study at another confidence, without running it again.
    let shown = ends(
        dir.path(),
        &["study", "show", "out", "--confidence", "0.99", "--json"],
        0,
    );
    let shown: serde_json::Value = serde_json::from_slice(&shown.stdout).unwrap();
    assert!(
        (half(&shown).1 / wide - 2.7440 / 2.0395).abs() < 1e-4,
        "{shown}"
    );
    for (word, part) in [
        ("0.3", "0.5 to 0.999"),
        ("1", "0.999"),
        ("95", "0.5 to 0.999"),
        ("nan", "not a finite number"),
    ] {
        let output = ends(
            dir.path(),
            &["study", "show", "out", "--confidence", word],
            2,
        );
        assert!(
            stderr(&output).contains(part),
            "{word}: {}",
            stderr(&output)
        );
    }
}

/// Truth: means of the rows by word.
#[test]
fn val_words_of_a_grid_are_compared_by_group() {
    let factor = "[[factor]]\nkey = \"lubricant\"\nname = \"oil\"\nvalues = [\"dexron_ii\", \"cvtf_ezl799_class\"]\n\
        [[factor]]\nkey = \"ambient_degc\"\nname = \"air\"\nvalues = [-20, 0, 20]\n\
        [[factor]]\nkey = \"start\"\nvalues = [\"soak\", \"warm\"]\n";
    let dir = folder(&format!(
        "{}\n[study.design.grid]\n{factor}",
        HEAD.replace("ambient_degc = -10\n", "")
    ));
    let (printed, own) = studied(dir.path(), &[]);
    assert_eq!(own.len(), 12);
    for oil in ["dexron_ii", "cvtf_ezl799_class"] {
        let fuels: Vec<f64> = own
            .iter()
            .filter(|row| row["lubricant"] == oil)
            .map(|row| number(row, FUEL))
            .collect();
        let mean = fuels.iter().sum::<f64>() / 6.0;
        let of = |f: fn(f64, f64) -> f64| fuels.iter().copied().reduce(f).unwrap();
        let line = printed
            .lines()
            .skip_while(|line| !line.starts_with("Effects on headline"))
            .find(|line| line.contains(oil))
            .unwrap();
        let cells: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        assert_eq!(
            cells[1..],
            [
                "6".to_owned(),
                format!("{mean:.3}"),
                format!("{:.3}", of(f64::min)),
                format!("{:.3}", of(f64::max))
            ]
        );
    }
}

/// `--samples` and `--seed` change the draws of plans that draw, and are refused for others.
#[test]
fn samples_and_seed_change_the_draws() {
    let dir = folder(&plan("[study.design.saltelli]\nsamples = 32\nseed = 3\n"));
    let (printed, own) = studied(dir.path(), &["--samples", "4", "--seed", "9"]);
    assert!(
        own.len() == 20 && printed.contains("Saltelli blocks of 4 samples, seed 9"),
        "{printed}"
    );
    let (_, other) = studied(dir.path(), &["--samples", "4", "--force"]);
    assert!(other[0]["engine.electrical_w"] != own[0]["engine.electrical_w"]);
    for (design, words, code, expected) in [
        (
            "[study.design.saltelli]\nsamples = 32\n",
            &["--samples", "1"][..],
            2,
            "out of range",
        ),
        (
            "[study.design.saltelli]\nsamples = 32\n",
            &["--samples", "100000"],
            2,
            "65536",
        ),
        (
            "[study.design.one_at_a_time]\n",
            &["--seed", "2"],
            2,
            "draws no samples",
        ),
        (
            "[study.design.latin_hypercube]\nsamples = 3\n",
            &["--samples", "5"],
            0,
            "",
        ),
        (
            "[study.design.sobol]\nsamples = 4\n",
            &["--samples", "8"],
            0,
            "",
        ),
        (
            "[study.design.monte_carlo]\nsamples = 3\n",
            &["--seed", "5"],
            0,
            "",
        ),
    ] {
        fs::write(dir.path().join("plan.toml"), plan(design)).unwrap();
        let output = ends(dir.path(), &[&["study", "plan.toml"], words].concat(), code);
        assert!(
            stderr(&output).contains(expected),
            "{expected} is not in {}",
            stderr(&output)
        );
        assert_eq!(output.stdout.is_empty(), code == 2);
    }
    assert!(stderr(&ends(dir.path(), &["study"], 2)).contains("no plan is named"));
}

/// The finished part of an unfinished study is reported, with the missing share.
#[test]
fn an_unfinished_study_can_be_shown() {
    let dir = folder(&plan("[study.design.monte_carlo]\nsamples = 400\n"));
    studied(dir.path(), &[]);
    let out = dir.path().join("out");
    let all = super::parts(&out);
    fs::remove_file(out.join("results.sha256")).unwrap();
    fs::remove_file(out.join("parts/part_00001.sha256")).unwrap();
    let words = String::from_utf8(ends(dir.path(), &["study", "show", "out"], 0).stdout).unwrap();
    let line = words
        .lines()
        .find(|line| line.starts_with("not finished"))
        .unwrap_or_else(|| panic!("{words}"));
    assert!(
        line.contains(&format!("{} of {all} parts", all - 1)) && line.contains("of 400 points"),
        "{line}"
    );
    // The mean is that of the rows present.
    ends(
        dir.path(),
        &["study", "export", "out", "--out", "rows.csv", "--force"],
        1,
    );
    let own: Vec<f64> = rows(&dir.path().join("rows.csv"))
        .iter()
        .filter(|row| row["vehicle"] == CVT)
        .map(|row| number(row, FUEL))
        .collect();
    let mean = format!("{:.3}", own.iter().sum::<f64>() / own.len() as f64);
    let line = words
        .lines()
        .find(|line| line.trim_start().starts_with(FUEL))
        .unwrap();
    assert!(
        own.len() < 400 && line.contains(&mean),
        "{mean} is not in {line}"
    );
}
