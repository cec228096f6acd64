//! `accelerate`: what it prints and refuses. Its physics are tested with the model.

use super::{json, one_line, refused, run, stdout};
use serde_json::Value;

fn times(found: &Value) -> Vec<(String, f64)> {
    let spans = found["spans"].as_array().unwrap().iter();
    let of = |span: &Value| {
        let name = span["span"].as_str().unwrap().to_owned();
        (name, span["time_s"].as_f64().unwrap_or(f64::NAN))
    };
    spans.map(of).collect()
}

/// Truth: spans overlap. 60 mph (96.56 km/h) is reached before 100 km/h, a quarter mile before a kilometre; a span of its own has the time of the table; and the
/// work of the crank is more than that at the wheels and less than the energy of the fuel.
#[test]
fn usual_times_are_those_of_one_drive() {
    for car in ["civic_20_cvt", "civic_20_6mt"] {
        let found = json(&["accelerate", "--vehicle", car, "--json"]);
        let usual = times(&found);
        let names: Vec<&str> = usual.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "0-100 km/h",
                "0-60 mph",
                "80-120 km/h",
                "quarter mile",
                "1000 m"
            ]
        );
        let of = |k: usize| usual[k].1;
        assert!(of(1) < of(0) && of(0) < of(3) && of(3) < of(4), "{usual:?}");
        let own = |words: &[&str]| {
            let words = [&["accelerate", "--vehicle", car, "--json"], words].concat();
            times(&json(&words))[0].1
        };
        assert_eq!(own(&["--to", "100"]).to_bits(), of(0).to_bits());
        assert_eq!(
            own(&["--from", "80", "--to", "120"]).to_bits(),
            of(2).to_bits()
        );
        assert!((own(&["--from", "0", "--to", "60mph"]) - of(1)).abs() < 1e-9);
        assert!(own(&["--to", "100", "--load", "300"]) > of(0) + 0.3);
        assert!(own(&["--to", "100", "--grade", "8"]) > of(0) + 1.0);
        assert!(own(&["--to", "100", "--grip", "0.25"]) > of(0) + 0.5);
        assert!(own(&["--to", "100", "--grip", "none"]) < of(0));
        for drive in found["drives"].as_array().unwrap() {
            let kj = |key: &str| drive[key].as_f64().unwrap();
            assert!(kj("wheel_work_kj") < kj("crank_work_kj"));
            assert!(kj("crank_work_kj") < 0.45 * kj("fuel_energy_kj"));
            assert!(kj("ledger_error") < 1e-9);
        }
    }
}

/// Truth: the cycle that no car can drive. `run` says by how much; `accelerate` says how fast the car is, with its assumed values and the way there.
#[test]
fn text_has_times_and_assumed_values() {
    let text = one_line(&stdout(&run(&["accelerate", "--vehicle", "civic_20_6mt"])));
    for part in [
        "civic_20_6mt: 0-100 km/h in ",
        "0-60 mph",
        "error of the step s",
        "gears 2 at ",
        "grip 0.90 of the front wheels with 0.60 of the weight",
        "0.50 s for a change of gear (AC-4)",
        "coolant (engine oil) at 90 degC, sump (metal, belt) at 80 degC, tyre at ambient",
        "the first foot, which US magazines do not count",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let slow = stdout(&run(&[
        "accelerate",
        "--vehicle",
        "rover_216_cvt",
        "--to",
        "300",
    ]));
    assert!(
        one_line(&slow).contains("0 km/h to 300 km/h is not reached"),
        "{slow}"
    );
}

/// Each option out of its range or of no meaning is one problem with what is allowed.
#[test]
fn bad_options_are_named() {
    for (words, part) in [
        (&["--to", "0"][..], "above 0"),
        (&["--from", "120", "--to", "100"], "above 120"),
        (&["--to", "1000"], "0 to 400"),
        (&["--grip", "3"], "0.05 to 2"),
        (&["--driven", "left"], "front"),
        (&["--axle-share", "1"], "0.2 to 0.9"),
        (&["--grade", "90"], "-30 to 40"),
        (&["--load", "-1"], "0 to 5000"),
        (&["--shift-time", "9"], "0 to 3"),
        (&["--gear", "4"], "none with a CVT"),
        (&["--gear", "9", "--vehicle", "rover_216_5mt"], "1 to 5"),
        (
            &["--start", "oil=80"],
            "coolant, engine_oil, sump, metal, belt, tyre",
        ),
        (&["--dt", "2"], "0.005 to 0.5"),
    ] {
        let text = one_line(&refused(&[&["accelerate"], words].concat()));
        assert!(text.contains(part), "{words:?}: {text}");
        assert!(text.contains("1 problem"), "{words:?}: {text}");
    }
}
