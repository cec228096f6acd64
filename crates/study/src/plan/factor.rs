//! One `[[factor]]` of a plan.

use super::keys::{FACTOR, quantity, run_option};
use super::values::{self, Of};
use super::{Acts, Cars, Factor, FactorValues, OfForm, Places, RUN_OPTIONS};
use cvtcycle_config::ProblemKind;
use cvtcycle_config::{Document, Problem, Problems, Reader, Section, did_you_mean, unit_of};
use cvtcycle_model::keys::{Key, Presence, Values};

/// Reads a factor.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document) -> Result<Factor, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let key = key(&s);
    let cars = cars(&s, &key);
    let mut places = Places::new(s.place(""));
    for key in ["key", "name", "cars", "form"] {
        places.add_given(&s, key, key);
    }
    let acts = acts(&s, &key);
    let values = values::read(&s, Of { key: &key, acts }, &mut places);
    let is_number = values.as_ref().is_none_or(FactorValues::are_numbers);
    if acts != Acts::Value && !is_number {
        s.conflict(
            "acts",
            "value",
            "words cannot be scaled or offset",
            "remove `acts`",
        );
    }
    let status = s.word(&FACTOR.status).to_owned();
    if s.has("distribution") && !s.has("status") {
        let (message, hint) = (
            "a distribution needs a status",
            "add `status = \"assumed\"`",
        );
        s.missing("status", &FACTOR.status.allowed(), message, hint);
    }
    let factor = Factor {
        name: name(&s, &key, cars),
        form: s.has("form").then(|| OfForm {
            name: Values::text_or(&s, &FACTOR.form, ""),
            span: [0.0, 1.0],
        }),
        unit: if is_number {
            unit(&key, acts)
        } else {
            String::new()
        },
        cars,
        acts,
        values: values.unwrap_or(FactorValues::List(Vec::new())),
        status,
        source: Values::text_or(&s, &FACTOR.source, ""),
        test: Values::text_or(&s, &FACTOR.test, ""),
        place: s.place("key"),
        places,
        key,
    };
    let of = match factor.key.as_str() {
        "" => String::new(),
        key => format!("factor {key}: "),
    };
    reader
        .finish()
        .map(|_| factor)
        .map_err(|problems| of_factor(problems, &of))
}

/// Problems under the name of their factor, and without words that fit the top of a file only.
fn of_factor(problems: Problems, of: &str) -> Problems {
    // A mistyped `values` explains that there are none.
    let is_way = |name: &String| values::WAYS.contains(&name.as_str());
    let mistyped = problems.iter().any(|p| p.suggested.iter().any(is_way));
    let shown = |p: &Problem| !(mistyped && p.message == values::NONE);
    problems
        .into_iter()
        .filter(shown)
        .map(|p| p.with_context(of))
        .collect()
}

fn key(s: &Section) -> String {
    let key = Values::text(s, &FACTOR.key);
    if key.is_empty() || run_option(&key).is_some() {
        return key;
    }
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let bare = |part: &str| !part.is_empty() && part.chars().all(is_bare);
    let allowed = format!(
        "a dotted key of a car's files, or one of {}",
        RUN_OPTIONS.join(", ")
    );
    if !key.split('.').all(bare) {
        let hint = "write, for example, transmission.cvt.pump.displacement_cc_rev";
        s.unknown_key("key", &allowed, &format!("`{key}` is no key"), hint);
    } else if !key.contains('.') {
        let hint = did_you_mean(&key, RUN_OPTIONS)
            .unwrap_or_else(|| "`cvtcycle show` lists the keys".to_owned());
        let message = format!("`{key}` is neither a run option nor a dotted key");
        s.unknown_key("key", &allowed, &message, &hint);
    }
    key
}

fn cars(s: &Section, key: &str) -> Cars {
    let is_shared = run_option(key).is_some() && key != "lubricant";
    let presence = Presence::Word(if is_shared { "all" } else { "subject" });
    let word = s.word(&Key {
        presence,
        ..FACTOR.cars
    });
    if is_shared && word != "all" {
        s.conflict(
            "cars",
            "all",
            &format!("`{key}` is the same for all cars"),
            "remove `cars`",
        );
    }
    match word {
        "baselines" => Cars::Baselines,
        "all" => Cars::All,
        _ => Cars::Subject,
    }
}

fn acts(s: &Section, key: &str) -> Acts {
    let word = s.word(&FACTOR.acts);
    if run_option(key).is_some() && word != "value" {
        let message = format!("`{key}` is in no car's file that it could {word}");
        s.conflict("acts", "value", &message, "remove `acts`");
        return Acts::Value;
    }
    match word {
        "scale" => Acts::Scale,
        "offset" => Acts::Offset,
        _ => Acts::Value,
    }
}

/// Name of a factor; two of the same key differ by their cars.
fn name(s: &Section, key: &str, cars: Cars) -> String {
    let default = match cars {
        _ if s.has("form") => format!("{key} ({})", Values::text_or(s, &FACTOR.form, "")),
        Cars::Baselines => format!("{key} (baselines)"),
        _ => key.to_owned(),
    };
    let name = Values::text_or(s, &FACTOR.name, &default);
    if s.has("name") && name.trim().is_empty() {
        s.complain_by_name(
            ProblemKind::Missing,
            "name",
            "a short name",
            "`name` is empty",
            "remove it for the key itself",
        );
    }
    name
}

/// Unit of its numbers.
pub(crate) fn unit(key: &str, acts: Acts) -> String {
    let unit = quantity(key).unit();
    let unit = match acts {
        Acts::Scale => "-",
        Acts::Offset if unit == unit_of("_degc") => unit_of("_k"),
        Acts::Value | Acts::Offset => unit,
    };
    unit.to_owned()
}
