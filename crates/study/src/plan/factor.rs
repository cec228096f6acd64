//! One `[[factor]]` of a plan.

use super::values::{self, Of};
use super::{Acts, Cars, Factor, FactorValue, FactorValues, Places, RUN_OPTIONS, options};
use cvtcycle_config::{Document, Problem, Problems, Reader, Section, did_you_mean, unit_of};
use cvtcycle_model::keys::{Key, spec::text};

const CARS: [(&str, Cars); 3] = [
    ("subject", Cars::Subject),
    ("baselines", Cars::Baselines),
    ("all", Cars::All),
];
const ACTS: [(&str, Acts); 3] = [
    ("value", Acts::Value),
    ("scale", Acts::Scale),
    ("offset", Acts::Offset),
];
const STATUSES: [&str; 4] = ["source", "derived", "fitted", "assumed"];

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
    ["key", "name", "cars"]
        .into_iter()
        .for_each(|key| places.add_given(&s, key, key));
    let acts = acts(&s, &key);
    let values = values::read(&s, Of { key: &key, acts }, &mut places);
    let is_number = values.as_ref().is_none_or(FactorValues::are_numbers);
    if acts != Acts::Value && !is_number {
        s.complain(
            "acts",
            "value",
            "words cannot be scaled or offset",
            "remove `acts`",
        );
    }
    let status = s
        .word_or(
            "status",
            &STATUSES.map(|word| word),
            "",
            "how the values are known",
        )
        .to_owned();
    if s.has("distribution") && !s.has("status") {
        s.complain(
            "status",
            &format!("one of {}", STATUSES.join(", ")),
            "a distribution needs a status",
            "add `status = \"assumed\"`",
        );
    }
    let factor = Factor {
        name: name(&s, &key, cars),
        unit: if is_number {
            unit(&key, acts)
        } else {
            String::new()
        },
        cars,
        acts,
        values: values.unwrap_or(FactorValues::List(Vec::new())),
        status,
        source: s.text_or("source", "", "reason or reference for the values"),
        place: s.place("key"),
        places,
        key,
    };
    reader
        .finish()
        .map(|_| factor)
        .map_err(|problems| of_factor(problems, document))
}

/// Problems under the name of their factor, and without words that fit the top of a file only.
fn of_factor(problems: Problems, document: &Document) -> Problems {
    let reader = Reader::new(document);
    let key = reader.root().optional_text(&Key::new("key", text(), ""));
    let key = key.filter(|key| !key.is_empty());
    let of = key.map_or_else(String::new, |key| format!("factor {key}: "));
    // A mistyped `values` explains that there are none.
    let meant = |p: &Problem| {
        let suggested = p.suggested.iter().map(String::as_str);
        suggested
            .into_iter()
            .any(|name| values::WAYS.contains(&name))
    };
    let mistyped = problems.iter().any(meant);
    let shown = problems
        .into_iter()
        .filter(|p| !(mistyped && p.message == values::NONE));
    shown.map(|p| p.with_context(&of)).collect()
}

fn key(s: &Section) -> String {
    let key = s.text("key", "run option or dotted key that is varied");
    if key.is_empty() || options::is_option(&key) {
        return key;
    }
    let bare = |part: &str| {
        !part.is_empty()
            && part
                .chars()
                .all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
    };
    let allowed = format!(
        "a dotted key of a car's files, or one of {}",
        RUN_OPTIONS.join(", ")
    );
    if !key.split('.').all(bare) {
        s.complain(
            "key",
            &allowed,
            &format!("`{key}` is no key"),
            "write, for example, transmission.cvt.pump.displacement_cc_rev",
        );
    } else if !key.contains('.') {
        let hint = did_you_mean(&key, RUN_OPTIONS)
            .unwrap_or_else(|| "`cvtcycle show` lists the keys".to_owned());
        s.complain(
            "key",
            &allowed,
            &format!("`{key}` is neither a run option nor a dotted key"),
            &hint,
        );
    }
    key
}

fn cars(s: &Section, key: &str) -> Cars {
    let is_option = options::is_option(key) && key != "lubricant";
    let default = if is_option { "all" } else { "subject" };
    let word = s.word_or(
        "cars",
        &CARS.map(|(word, _)| word),
        default,
        "whose value it is",
    );
    if is_option && word != "all" {
        s.complain(
            "cars",
            "all",
            &format!("`{key}` is the same for all cars"),
            "remove `cars`",
        );
    }
    CARS.iter()
        .find(|(name, _)| *name == word)
        .map_or(Cars::Subject, |(_, cars)| *cars)
}

fn acts(s: &Section, key: &str) -> Acts {
    let word = s.word_or(
        "acts",
        &ACTS.map(|(word, _)| word),
        "value",
        "what a number does with the value of the car's file",
    );
    if options::is_option(key) && word != "value" {
        s.complain(
            "acts",
            "value",
            &format!("`{key}` is in no car's file that it could {word}"),
            "remove `acts`",
        );
        return Acts::Value;
    }
    ACTS.iter()
        .find(|(name, _)| *name == word)
        .map_or(Acts::Value, |(_, acts)| *acts)
}

/// Name of a factor; two of the same key differ by their cars.
fn name(s: &Section, key: &str, cars: Cars) -> String {
    let default = if cars == Cars::Baselines {
        format!("{key} (baselines)")
    } else {
        key.to_owned()
    };
    let name = s.text_or("name", &default, "short name for tables and plots");
    if s.has("name") && name.trim().is_empty() {
        s.complain(
            "name",
            "a short name",
            "`name` is empty",
            "remove it for the key itself",
        );
    }
    name
}

/// Unit of its numbers.
fn unit(key: &str, acts: Acts) -> String {
    let unit = unit_of(options::quantity(
        key.rsplit('.').next().unwrap_or_default(),
    ));
    let unit = match acts {
        Acts::Value => unit,
        Acts::Scale => "-",
        Acts::Offset if unit == unit_of("_degc") => unit_of("_k"),
        Acts::Offset => unit,
    };
    unit.to_owned()
}

impl FactorValues {
    /// Whether they are numbers.
    #[must_use]
    pub fn are_numbers(&self) -> bool {
        match self {
            FactorValues::List(values) => values
                .iter()
                .all(|value| matches!(value, FactorValue::Number(_))),
            FactorValues::Distribution(_) => true,
        }
    }
}
