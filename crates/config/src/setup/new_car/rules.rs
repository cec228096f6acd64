//! From catalogue numbers to values of keys (NC-1 to NC-19).

mod box_size;
mod driveline;
mod engine;

use std::f64::consts::PI;

use super::tyre::tyre;
use super::{Answers, NUMBERS, meaning};
use crate::document::units::{
    FORCE, FORCE_PER_SPEED, FORCE_PER_SPEED2, LENGTH, MASS, OIL, PER_TURN, SPEED, Units, VOLUME,
};
use crate::setup::Setup;
use crate::{Problem, Problems, decimal};

/// A value of the file.
pub(super) struct Line {
    pub key: &'static str,
    /// As TOML.
    pub value: String,
    /// `derived`, `assumed`, or nothing for what the user has given.
    pub status: &'static str,
    pub source: String,
    /// The option whose number it is.
    pub option: Option<&'static str>,
}

impl Line {
    pub fn table(&self) -> &'static str {
        self.key.rsplit_once('.').map_or("", |(table, _)| table)
    }

    /// As a line of its table.
    pub fn text(&self) -> String {
        let name = self.key.rsplit('.').next().unwrap_or_default();
        let status = match self.status {
            "" => String::new(),
            status => format!(", status = \"{status}\""),
        };
        let source = toml::Value::String(self.source.clone());
        format!(
            "{name} = {{ value = {}{status}, source = {source} }}\n",
            self.value
        )
    }
}

/// Numbers that are values of a key as they are: option, key, units.
pub(super) const PLAIN: [(&str, &str, Units); 9] = [
    ("mass", "road_load.mass_kg", MASS),
    ("f0", "road_load.form.coefficients.f0_n", FORCE),
    (
        "f1",
        "road_load.form.coefficients.f1_n_per_kmh",
        FORCE_PER_SPEED,
    ),
    (
        "f2",
        "road_load.form.coefficients.f2_n_per_kmh2",
        FORCE_PER_SPEED2,
    ),
    ("displacement", "engine.displacement_cc", VOLUME),
    ("idle", "engine.idle.hot_rpm", SPEED),
    ("highest", "engine.highest_rpm", SPEED),
    (
        "pump",
        "transmission.cvt.pump.displacement_cc_rev",
        PER_TURN,
    ),
    ("oil", "thermal.transmission.oil_l", OIL),
];

const BEYOND_RATED_RPM: f64 = 400.0;

/// Keys of the drag of the box in f0, f1 and f2 (RL-9).
const DRAG: [&str; 3] = [
    "road_load.form.coefficients.driveline_f0_n",
    "road_load.form.coefficients.driveline_f1_n_per_kmh",
    "road_load.form.coefficients.driveline_f2_n_per_kmh2",
];

/// True for coefficients of a coast-down in neutral: by the answer, else where one of them is in lbf, as EPA gives its targets.
pub(super) fn is_neutral(answers: &Answers) -> bool {
    match answers.numbers.get("road-load") {
        Some(word) => word == "neutral",
        None => has_lbf(answers),
    }
}

/// True if a coefficient of the road load is in lbf.
pub(super) fn has_lbf(answers: &Answers) -> bool {
    ["f0", "f1", "f2"].iter().any(|name| {
        let text = answers.numbers.get(name);
        text.is_some_and(|text| text.to_ascii_lowercase().contains("lbf"))
    })
}

/// The drag of the box in the coefficients of a coast-down in neutral.
pub(super) fn drag_lines(drag: [f64; 3]) -> impl Iterator<Item = Line> {
    DRAG.into_iter()
        .zip(drag)
        .zip([2, 4, 6])
        .map(|((key, value), digits)| Line {
            key,
            value: format!("{value:.digits$}"),
            status: "derived",
            source: "NC-18: the box turned by the wheels without torque, in oil of 60 degC"
                .to_owned(),
            option: None,
        })
}

/// The numbers that are given.
struct Given<'a> {
    answers: &'a Answers,
    base: &'a Setup,
    problems: Problems,
    lines: Vec<Line>,
}

/// The lines of a car that inherits from `base`.
///
/// # Errors
/// All numbers that are none, or do not fit each other or the box.
pub(super) fn lines(answers: &Answers, base: &Setup) -> Result<Vec<Line>, Problems> {
    let mut given = Given {
        answers,
        base,
        problems: Problems::new(),
        lines: Vec::new(),
    };
    given.refuse_other_box();
    for (option, key, units) in &PLAIN {
        if let Some(value) = given.number(option, units) {
            given.is_given(option, key, digits(value));
        }
    }
    for (option, key) in [
        ("fluid", "vehicle.transmission_oil"),
        ("engine-oil", "vehicle.engine_oil"),
    ] {
        if let Some(word) = answers.numbers.get(option) {
            given.is_given(option, key, toml::Value::String(word.clone()).to_string());
        }
    }
    given.road_load();
    given.wheel();
    given.size();
    given.power();
    match base.transmission().is_cvt() {
        true => {
            given.belt();
            given.fit_box();
        }
        false => given.gears(),
    }
    given.problems.finish()?;
    // The head of the file has its table already.
    given
        .lines
        .sort_by_key(|line| !line.key.starts_with("vehicle."));
    Ok(given.lines)
}

/// A number without the digits of its rounding.
fn digits(value: f64) -> String {
    let text = decimal((value * 1e6).round() / 1e6).to_string();
    if text.contains('.') {
        text
    } else {
        text + ".0"
    }
}

fn list(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|x| format!("{x:.3}")).collect();
    format!("[{}]", values.join(", "))
}

impl Given<'_> {
    fn text(&self, option: &str) -> Option<&str> {
        self.answers.numbers.get(option).map(String::as_str)
    }

    /// The number of an option, in the unit of its key; none if it is not given, or no number.
    fn number(&mut self, option: &str, units: &Units) -> Option<f64> {
        let text = self.text(option)?.to_owned();
        self.read(option, &text, &text, units)
    }

    /// A number that is a part of the text of an option.
    fn read(&mut self, option: &str, part: &str, text: &str, units: &Units) -> Option<f64> {
        self.take(option, text, units.number(part))
    }

    fn take(&mut self, option: &str, text: &str, found: Result<f64, Problem>) -> Option<f64> {
        self.problems
            .take(found.map_err(|problem| problem.key(option).value(text)))
    }

    fn complain(&mut self, option: &str, message: &str, hint: &str) {
        let value = self.text(option).unwrap_or_default().to_owned();
        let problem = Problem::conflict(message).key(option).value(value);
        self.problems
            .push(problem.allowed(meaning(option)).hint(hint));
    }

    fn is_given(&mut self, option: &str, key: &'static str, value: String) {
        let source = format!("given: {}", self.text(option).unwrap_or_default());
        self.lines.push(Line {
            key,
            value,
            status: "",
            source,
            option: NUMBERS
                .iter()
                .map(|(own, _)| *own)
                .find(|own| *own == option),
        });
    }

    fn follows(&mut self, key: &'static str, value: String, source: String) {
        self.lines.push(Line {
            key,
            value,
            status: "derived",
            source,
            option: None,
        });
    }

    /// A number of the class or car that the new one inherits from.
    fn inherited(&self, key: &str) -> f64 {
        let found = self.base.keys.iter().find(|info| info.key == key);
        found
            .and_then(|info| info.value.parse().ok())
            .unwrap_or(f64::NAN)
    }

    /// The drag of the box inside a coast-down in neutral.
    fn road_load(&mut self) {
        match self.text("road-load") {
            None | Some("body") => {}
            Some("neutral") if self.text("f0").is_none() => self.complain(
                "road-load",
                "there is no coast-down to take the drag of the box from",
                "give f0, f1 and f2 as well",
            ),
            Some("neutral") => {}
            Some(_) => self.complain(
                "road-load",
                "this is no kind of road load",
                "write body or neutral",
            ),
        }
    }

    fn wheel(&mut self) {
        let radius_mm = self.number("wheel-radius", &LENGTH);
        if let Some(radius_mm) = radius_mm {
            self.is_given(
                "wheel-radius",
                "road_load.wheel_radius_m",
                digits(radius_mm / 1e3),
            );
        }
        let Some(code) = self.text("tyre").map(str::to_owned) else {
            return;
        };
        match tyre(&code) {
            None => self.complain(
                "tyre",
                "this is no tyre code",
                "write it as it is on the tyre, such as 215/55 R16",
            ),
            Some(_) if radius_mm.is_some() => {
                self.complain(
                    "tyre",
                    "a tyre and a wheel radius at once",
                    "give one of them",
                );
            }
            Some([width, height, rim]) => {
                let diameter_mm = 25.4 * rim + 2.0 * width * height / 100.0;
                let radius_m = 3.05 * diameter_mm / (2.0 * PI) / 1e3; // NC-1
                self.follows(
                    "road_load.wheel_radius_m",
                    format!("{radius_m:.4}"),
                    format!("NC-1: {code}"),
                );
            }
        }
    }
}
