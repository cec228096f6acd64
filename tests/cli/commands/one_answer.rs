//! One answer everywhere: terminal, JSON, report and live page have the same numbers for ten cases of cars, cycles, temperatures, oils and `--set`.
//!
//! Truth: the sample itself, driven by the library as `Car.answer` of Python drives it.

use super::{one_line, run_in, stderr, stdout};
use cvtcycle::analysis::answer::{HEARD_RPM, Question, drive, prepare};
use cvtcycle::analysis::words::between;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::number::fixed;
use cvtcycle::output::progress::NoProgress;
use cvtcycle::study::plan::Base;
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Draws of a live page.
const DRAWS: u64 = 256;

struct Case {
    vehicle: &'static str,
    cycle: &'static str,
    ambient_degc: f64,
    start: &'static str,
    baseline: &'static str,
    lubricant: Option<&'static str>,
    set: &'static [&'static str],
}

/// A case of the Rover on ECE 15 against its manual sister.
const ROVER: Case = Case {
    vehicle: "rover_216_cvt",
    cycle: "ece15",
    ambient_degc: 25.0,
    start: "soak",
    baseline: "rover_216_5mt",
    lubricant: None,
    set: &[],
};

const CASES: [Case; 10] = [
    Case {
        ambient_degc: -10.0,
        ..ROVER
    },
    Case {
        set: &["transmission.cvt.belt.band_offset_mm=2"],
        ..ROVER
    },
    // Slips in nearly all draws: no range.
    Case {
        set: &["transmission.cvt.pump.displacement_cc_rev=2"],
        ..ROVER
    },
    Case {
        cycle: "eudc",
        ambient_degc: -7.0,
        lubricant: Some("dexron_iii"),
        ..ROVER
    },
    Case {
        cycle: "constant_120",
        start: "warm",
        ..ROVER
    },
    Case {
        vehicle: "civic_20_cvt",
        ambient_degc: -7.0,
        baseline: "civic_20_6mt",
        ..ROVER
    },
    Case {
        vehicle: "civic_20_cvt",
        cycle: "eudc",
        ambient_degc: 24.0,
        baseline: "twin",
        ..ROVER
    },
    Case {
        vehicle: "justy_ecvt",
        ambient_degc: 20.0,
        baseline: "twin",
        ..ROVER
    },
    Case {
        vehicle: "rover_216_5mt",
        ambient_degc: 0.0,
        baseline: "mondeo_20_5mt",
        ..ROVER
    },
    Case {
        vehicle: "own.toml",
        cycle: "eudc",
        baseline: "twin",
        ..ROVER
    },
];

/// A car of classes.
const OWN: &str = "[vehicle]\nlike = [\"class:compact_2020\", \"class:box_cvt_converter\"]\n";

impl Case {
    fn words(&self) -> Vec<String> {
        let ambient = self.ambient_degc.to_string();
        let pairs = [
            ("--vehicle", self.vehicle),
            ("--cycle", self.cycle),
            ("--ambient", &ambient),
            ("--start", self.start),
            ("--baseline", self.baseline),
        ];
        let given = self.lubricant.iter().map(|oil| ("--lubricant", *oil));
        let given = given.chain(self.set.iter().map(|set| ("--set", *set)));
        let all = pairs.into_iter().chain(given);
        all.flat_map(|(name, value)| [name.to_owned(), value.to_owned()])
            .collect()
    }

    /// The sample, as Python drives it.
    fn truth(&self, folder: &Path) -> Value {
        let word = match self.vehicle {
            own if own.contains('.') => folder.join(own).to_string_lossy().into_owned(),
            shipped => shipped.to_owned(),
        };
        let question = Question {
            base: Base {
                vehicle: word,
                baselines: Some(vec![self.baseline.to_owned()]),
                cycle: self.cycle.to_owned(),
                ambient_degc: self.ambient_degc,
                start: self.start.to_owned(),
                lubricant: self.lubricant.map(str::to_owned),
                engine_oil: None,
                set: self.set.iter().map(|set| set.parse().unwrap()).collect(),
                set_all: Vec::new(),
                dt_s: 1.0,
                formulation: Formulation::default(),
            },
            levers: Vec::new(),
            prices: false,
            draws: DRAWS,
            heard_rpm: HEARD_RPM,
        };
        let answer = drive(&prepare(&question).unwrap(), &NoProgress)
            .unwrap()
            .unwrap();
        serde_json::to_value(&answer).unwrap()
    }
}

/// Ranges that are claimed, in words: of the fuel, and of each difference.
fn ranges(answer: &Value) -> Vec<String> {
    let list = answer["differences"].as_array().unwrap();
    let ends = |of: &Value| [0, 2].map(|k| of[k].as_f64().unwrap_or(f64::NAN));
    let claimed = |of: &&Value| {
        let [good, bad] = ["draws", "left_out"].map(|key| of[1][key].as_f64().unwrap());
        bad <= 0.2 * (good + bad)
    };
    let differences = list.iter().filter(claimed);
    let differences = differences.map(|of| between(ends(&of[1]["percent"]), "%"));
    let fuel = &list[0][1]["fuel_l_per_100km"];
    let fuel = (!fuel.is_null()).then(|| {
        let [low, high] = ends(fuel);
        let digits = cvtcycle::analysis::words::decimals([low, high]);
        format!("{} to {}", fixed(low, digits), fixed(high, digits))
    });
    fuel.into_iter().chain(differences).collect()
}

/// Text without tags, in the signs of the terminal.
fn plain(text: &str) -> String {
    let mut inside = false;
    let shown = text.chars().filter(|c| {
        let was = inside;
        inside = *c == '<' || inside && *c != '>';
        !was && !inside
    });
    let text: String = shown.collect();
    one_line(
        &text
            .replace('\u{2212}', "-")
            .replace(['\u{a0}', '\u{202f}'], " "),
    )
}

#[test]
fn ten_cases_have_the_same_numbers_everywhere() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("own.toml"), OWN).unwrap();
    let draws = DRAWS.to_string();
    for (k, case) in CASES.iter().enumerate() {
        let truth = case.truth(dir.path());
        let words = case.words();
        let mut args = vec!["run", "--draws", &draws, "--price", "never"];
        args.extend(words.iter().map(String::as_str));
        let folder = format!("run{k}");
        let made = run_in(
            dir.path(),
            &[
                &args[..],
                &["--sensitivity", "never", "--out", &folder, "--json"],
            ]
            .concat(),
        );
        let found: Value = serde_json::from_slice(&made.stdout)
            .unwrap_or_else(|error| panic!("{words:?}: {error}: {}", stderr(&made)));
        let answer = &found["answer"];
        for key in [
            "schema",
            "plan",
            "draws",
            "failed_draws",
            "reasons",
            "fuel_l_per_100km",
            "differences",
        ] {
            assert_eq!(answer[key], truth[key], "{words:?}: {key}");
        }
        let intervals = found["comparison"].as_array().unwrap().iter();
        let intervals: Vec<&Value> = intervals.map(|of| &of["interval"]).collect();
        let drawn: Vec<&Value> = truth["differences"]
            .as_array()
            .unwrap()
            .iter()
            .map(|of| &of[1])
            .collect();
        assert_eq!(intervals, drawn, "{words:?}");
        let ranges = ranges(&truth);
        let printed = one_line(&stdout(&run_in(dir.path(), &args)));
        let reported = run_in(
            dir.path(),
            &[
                "report",
                &folder,
                "--stored",
                "--live",
                "--out",
                "page.html",
                "--force",
            ],
        );
        assert_eq!(
            reported.status.code(),
            Some(0),
            "{words:?}: {}",
            stderr(&reported)
        );
        let page = fs::read_to_string(dir.path().join("page.html")).unwrap();
        let (_, scene) = page.split_once("id=\"live-scene\">").unwrap();
        let scene: Value = serde_json::from_str(scene.split_once("</script>").unwrap().0).unwrap();
        let live: Vec<&Value> = scene["drawn"].as_array().unwrap().iter().collect();
        assert_eq!(live, drawn, "{words:?}");
        let (_, lead) = page.split_once("<p class=\"lead\">").unwrap();
        let lead = lead.split_once("</p>").unwrap().0;
        // The live section has its own first sentence, the last one of the page.
        let (_, of_live) = page.rsplit_once("<p class=\"lead\">").unwrap();
        let of_live = of_live.split_once("</p>").unwrap().0;
        let places = [
            ("terminal", printed),
            ("report", plain(lead)),
            ("live page", plain(of_live)),
        ];
        for range in &ranges {
            for (place, text) in &places {
                assert!(
                    text.contains(range.as_str()),
                    "{words:?}: {place} without {range}: {text:.800}"
                );
            }
        }
        // The case that slips claims nothing.
        assert_eq!(ranges.is_empty(), k == 2, "{words:?}: {ranges:?}");
    }
}
