//! `cvtcycle schema`: accepts the shipped files, and detects mistakes of range, option and key.
//!
//! Truth: the rules of JSON Schema draft 07 for the keywords that the schemas use, implemented here; any other
//! keyword fails the test. `tools/schema_check` does the same with an independent validator.
use cvtcycle::analysis::levers::keys::LEVER_FILE;
use cvtcycle::calibrate::plan::keys::CALIBRATION;
use cvtcycle::config::procedure::TEST_FILE;
use cvtcycle::config::schema;
use cvtcycle::config::setup::Kind;
use cvtcycle::model::files;
use cvtcycle::model::keys::Table;
use cvtcycle::study::plan::PLAN;
use cvtcycle::validate::keys::VALIDATION;
use cvtcycle::validate::{COMMON, embedded_rows};
use serde_json::{Value, json};

/// Places and reasons of mistakes in a value.
fn mistakes(schema: &Value, value: &Value, at: &str) -> Vec<String> {
    let number = value.as_f64();
    let mut found = Vec::new();
    for (word, rule) in schema.as_object().expect("a schema") {
        let limit = rule.as_f64().unwrap_or(f64::NAN);
        let holds = match word.as_str() {
            "$schema" | "title" | "description" | "default" | "if" => true,
            "else" => {
                if !mistakes(&schema["if"], value, at).is_empty() {
                    found.extend(mistakes(rule, value, at));
                }
                true
            }
            "type" => is_type(value, rule.as_str().expect("one type")),
            "enum" => rule.as_array().expect("values").contains(value),
            "minimum" => number.is_none_or(|x| x >= limit),
            "exclusiveMinimum" => number.is_none_or(|x| x > limit),
            "maximum" => number.is_none_or(|x| x <= limit),
            "pattern" => {
                assert_eq!(rule, r"\.\..*:", "the only pattern");
                let after = |text: &str| {
                    text.split_once("..")
                        .is_some_and(|(_, to)| to.contains(':'))
                };
                value.as_str().is_none_or(after)
            }
            "minItems" => value.as_array().is_none_or(|a| a.len() as f64 >= limit),
            "maxItems" => value.as_array().is_none_or(|a| a.len() as f64 <= limit),
            "maxProperties" => value.as_object().is_none_or(|o| o.len() as f64 <= limit),
            "required" => value.as_object().is_none_or(|o| {
                let names = rule.as_array().expect("names").iter();
                names
                    .filter_map(Value::as_str)
                    .all(|name| o.contains_key(name))
            }),
            "anyOf" => {
                let forms = rule.as_array().expect("schemas").iter();
                let tried: Vec<_> = forms.map(|form| mistakes(form, value, at)).collect();
                if !tried.iter().any(Vec::is_empty) {
                    found.extend(tried.into_iter().flatten());
                }
                true
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    let schema = rule.as_array().map_or(rule, |list| &list[k]);
                    found.extend(mistakes(schema, item, &format!("{at}[{k}]")));
                }
                true
            }
            "properties" => {
                for (name, item) in value.as_object().into_iter().flatten() {
                    if let Some(schema) = rule.get(name) {
                        found.extend(mistakes(schema, item, &format!("{at}.{name}")));
                    }
                }
                true
            }
            "additionalProperties" => {
                let known = &schema["properties"];
                for (name, item) in value.as_object().into_iter().flatten() {
                    let at = format!("{at}.{name}");
                    match rule {
                        _ if known.get(name).is_some() => {}
                        Value::Bool(true) => {}
                        Value::Bool(false) => found.push(format!("{at}: unknown")),
                        schema => found.extend(mistakes(schema, item, &at)),
                    }
                }
                true
            }
            _ => false,
        };
        if !holds {
            found.push(format!("{at}: {word}"));
        }
    }
    found
}

fn is_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64(),
        "number" => value.is_number(),
        other => panic!("type {other}"),
    }
}

fn parsed(text: &str) -> Value {
    let value: toml::Value = toml::from_str(text).expect("TOML");
    json!(value)
}

fn checked(keys: &Table, text: &str) -> Vec<String> {
    mistakes(&schema::json_schema("", keys), &parsed(text), "")
}

#[test]
fn the_shipped_files_are_valid() {
    for (kind, keys) in [
        (Kind::Vehicle, files::VEHICLE),
        (Kind::Lubricant, files::LUBRICANT),
        (Kind::Rig, files::RIG),
        (Kind::Calibration, CALIBRATION),
        (Kind::Plan, PLAN),
        (Kind::Levers, LEVER_FILE),
        (Kind::Test, TEST_FILE),
    ] {
        for (name, text) in kind.embedded() {
            assert_eq!(checked(&keys, text), [] as [&str; 0], "{name}");
        }
    }
    let rows = embedded_rows().iter().chain([&COMMON]);
    for (name, text) in rows {
        assert_eq!(checked(&VALIDATION, text), [] as [&str; 0], "{name}");
    }
}

/// Mistakes of a calibration plan and of a validation file, one per text.
#[test]
fn mistakes_in_calibrations_and_rows_are_seen() {
    let parameter = "[calibration]\n[[parameter]]\nkey = \"engine.idle\"\nlow = 1\n";
    for (text, mistake) in [
        (
            "[calibration]\nstarts = 1001\n",
            ".calibration.starts: maximum",
        ),
        (
            "[calibration]\ncolour = \"a\"\n",
            ".calibration.colour: unknown",
        ),
        (parameter, ".parameter[0]: required"),
        (
            "[[data]]\nfrom = \"a\"\nsd = 0\n",
            ".data[0].sd: exclusiveMinimum",
        ),
        (
            "[sources.a]\nsource = \"boat\"\n",
            ".sources.a.source: enum",
        ),
        ("[sources.a]\nratio = 50\n", ".sources.a.ratio: maximum"),
    ] {
        let found = checked(&CALIBRATION, text);
        assert!(
            found.iter().any(|m| m.starts_with(mistake)),
            "{mistake}: {found:?}"
        );
    }
    for (text, mistake) in [
        ("[[row]]\nverdict = \"maybe\"\n", ".row[0].verdict: enum"),
        ("[[row]]\nvalue = \"5\"\n", ".row[0].value: type"),
        ("[[row]]\ncolour = \"red\"\n", ".row[0].colour: unknown"),
        ("[[row]]\n", ".row[0]: required"),
        (
            "[tolerances.a]\nwidth = -1\n",
            ".tolerances.a.width: minimum",
        ),
        (
            "[sources.a]\nthrottle = 2\n",
            ".sources.a.throttle: maximum",
        ),
    ] {
        let found = checked(&VALIDATION, text);
        assert!(
            found.iter().any(|m| m.starts_with(mistake)),
            "{mistake}: {found:?}"
        );
    }
}

#[test]
fn mistakes_are_seen() {
    let (_, rover) = Kind::Vehicle
        .embedded()
        .iter()
        .find(|(name, _)| *name == "rover_216_cvt")
        .expect("the shipped car");
    for (key, value, mistake) in [
        ("colour", json!("red"), ".road_load.colour: unknown"),
        (
            "wheel_radius_m",
            json!(9),
            ".road_load.wheel_radius_m: maximum",
        ),
        ("surface", json!("sand"), ".road_load.surface: enum"),
        ("payload_kg", json!("much"), ".road_load.payload_kg: type"),
    ] {
        let mut car = parsed(rover);
        car["road_load"][key] = value;
        let found = mistakes(&schema::json_schema("", &files::VEHICLE), &car, "");
        assert!(
            found.iter().any(|m| m.starts_with(mistake)),
            "{mistake}: {found:?}"
        );
    }
    let status = "density15_kg_m3 = { value = 850, status = \"guessed\" }\nkv40_mm2_s = 30\nkv100_mm2_s = 7\n";
    let found = checked(&files::LUBRICANT, status);
    assert_eq!(
        found,
        [".density15_kg_m3: type", ".density15_kg_m3.status: enum"]
    );
}

/// Only a file that inherits may omit required keys of a car.
#[test]
fn a_car_that_inherits_may_be_incomplete() {
    let checked = |text: &str| checked(&files::VEHICLE, text);
    let like = "[vehicle]\nlike = [\"class:compact_2020\", \"class:box_cvt_clutch\"]\n";
    let own = "[road_load]\nmass_kg = 1320\n[road_load.form.coefficients]\nf0_n = 100\n";
    assert_eq!(checked(&format!("{like}{own}")), [] as [&str; 0]);
    let wrong = checked(&format!("{like}{own}f9_n = 3\n"));
    assert!(
        wrong.iter().any(|m| m.ends_with(".f9_n: unknown")),
        "{wrong:?}"
    );
    let alone = checked(own);
    for mistake in [
        ": required",
        ".road_load: required",
        ".road_load.form.coefficients: required",
    ] {
        assert!(alone.iter().any(|m| m == mistake), "{mistake}: {alone:?}");
    }
}

#[test]
fn mistakes_in_a_plan_are_seen() {
    let text = "[study]\nstart = \"cold\"\nambient_degc = 61\ndesing = 3\nset = [4]\n\
        [study.design.sobol]\nsamples = 1\n\
        [[factor]]\nkey = \"dt_s\"\ncars = \"both\"\nrange = { from = 1, too = 2 }\n\
        [factor.distribution.normal]\nmean = 1\nsd = 0\n";
    let found = checked(&PLAN, text);
    for mistake in [
        ".study.start: enum",
        ".study.ambient_degc: maximum",
        ".study.desing: unknown",
        ".study.set[0]: type",
        ".study.design.sobol.samples: minimum",
        ".factor[0].cars: enum",
        ".factor[0].range: required",
        ".factor[0].range.too: unknown",
        ".factor[0].distribution.normal.sd: exclusiveMinimum",
    ] {
        assert!(found.iter().any(|m| m == mistake), "{mistake}: {found:#?}");
    }
}
