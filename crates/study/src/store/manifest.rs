//! Differences between two manifests.

use serde_json::Value;

/// Longest value that is shown.
const MAX_LEN: usize = 60;

/// A place where two manifests differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Dotted path of the value, `cars[0].values.mass_kg`; with the line for words of several lines.
    pub path: String,
    /// Value that the study was begun with.
    pub stored: String,
    /// Value that it would continue with.
    pub now: String,
}

/// All differences in the order of the stored manifest, what is new last. None for the same values in another order or spacing.
pub fn differences(stored: &Value, now: &Value) -> Vec<Difference> {
    let mut found = Vec::new();
    compare("", Some(stored), Some(now), &mut found);
    found
}

fn compare(path: &str, stored: Option<&Value>, now: Option<&Value>, found: &mut Vec<Difference>) {
    match (stored, now) {
        (Some(Value::Object(a)), Some(Value::Object(b))) => {
            let new = b.keys().filter(|key| !a.contains_key(*key));
            for key in a.keys().chain(new) {
                let path = match path {
                    "" => key.clone(),
                    path => format!("{path}.{key}"),
                };
                compare(&path, a.get(key), b.get(key), found);
            }
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) => {
            for k in 0..a.len().max(b.len()) {
                compare(&format!("{path}[{k}]"), a.get(k), b.get(k), found);
            }
        }
        (Some(Value::String(a)), Some(Value::String(b)))
            if a != b && (a.contains('\n') || b.contains('\n')) =>
        {
            found.push(lines(path, a, b));
        }
        (a, b) if a == b => {}
        (a, b) => found.push(Difference {
            path: path.to_owned(),
            stored: shown(a),
            now: shown(b),
        }),
    }
}

/// The first line in which two texts differ, that do.
pub fn lines(path: &str, stored: &str, now: &str) -> Difference {
    let same = stored
        .lines()
        .zip(now.lines())
        .take_while(|(a, b)| a == b)
        .count();
    let is_end = [stored, now].map(|text| text.lines().nth(same)) == [None; 2];
    let (path, [stored, now]) = match is_end {
        false => {
            let line = |text: &str| text.lines().nth(same).map(|line| cut(&format!("`{line}`")));
            let shown = |text| line(text).unwrap_or_else(|| "no such line".to_owned());
            (
                format!("{path}, line {}", same + 1),
                [stored, now].map(shown),
            )
        }
        true => {
            let ends = |text: &str| match text.contains('\r') {
                true => "with carriage returns".to_owned(),
                false => "other line ends".to_owned(),
            };
            (path.to_owned(), [stored, now].map(ends))
        }
    };
    Difference { path, stored, now }
}

fn shown(value: Option<&Value>) -> String {
    value.map_or_else(|| "absent".to_owned(), |value| cut(&value.to_string()))
}

fn cut(text: &str) -> String {
    if text.chars().count() <= MAX_LEN {
        text.to_owned()
    } else {
        text.chars().take(MAX_LEN).chain("...".chars()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn first(stored: &Value, now: &Value) -> (String, String, String) {
        let found = differences(stored, now)
            .into_iter()
            .next()
            .expect("a difference");
        (found.path, found.stored, found.now)
    }

    fn words(path: &str, stored: &str, now: &str) -> (String, String, String) {
        (path.to_owned(), stored.to_owned(), now.to_owned())
    }

    #[test]
    fn differences_have_their_path_and_both_values() {
        let base = json!({ "program": "cvtcycle 0.1.0", "plan": "a = 1\nb = 2\n", "cars": [{ "mass_kg": 1100.0 }], "seed": 7 });
        let with = |key: &str, value: Value| {
            let mut other = base.clone();
            other[key] = value;
            other
        };
        assert_eq!(differences(&base, &base), []);
        assert_eq!(
            first(&base, &with("program", json!("cvtcycle 0.2.0"))),
            words("program", "\"cvtcycle 0.1.0\"", "\"cvtcycle 0.2.0\"")
        );
        assert_eq!(
            first(&base, &with("plan", json!("a = 1\nb = 3\n"))),
            words("plan, line 2", "`b = 2`", "`b = 3`")
        );
        assert_eq!(
            first(&base, &with("plan", json!("a = 1\n"))),
            words("plan, line 2", "`b = 2`", "no such line")
        );
        assert_eq!(
            first(&base, &with("plan", json!("a = 1\r\nb = 2\r\n"))),
            words("plan", "other line ends", "with carriage returns")
        );
        assert_eq!(
            first(&base, &with("cars", json!([{ "mass_kg": 1095.0 }]))),
            words("cars[0].mass_kg", "1100.0", "1095.0")
        );
        assert_eq!(
            first(&base, &with("cars", json!([]))),
            words("cars[0]", "{\"mass_kg\":1100.0}", "absent")
        );
        assert_eq!(
            first(&base, &with("new", json!(null))),
            words("new", "absent", "null")
        );
        let long = json!("x".repeat(200));
        assert_eq!(
            first(&base, &with("seed", long)).2.chars().count(),
            MAX_LEN + 3
        );
        let both = json!({ "seed": 8, "plan": "a = 1\nb = 2\n", "cars": [], "program": 0 });
        assert_eq!(differences(&base, &both).len(), 3);
    }
}
