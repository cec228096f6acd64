//! Questions to a person, with the value that the car has without an answer.

use super::rules::has_lbf;
use super::{Answers, Base, is_missing, made, meaning};
use crate::{Problem, ProblemKind, Problems};

/// Numbers of every car, in the order of the questions, and the key whose inherited value holds without an answer.
const OF_ALL: [(&str, &str); 11] = [
    ("mass", "road_load.mass_kg"),
    ("f0", "road_load.form.coefficients.f0_n"),
    ("f1", "road_load.form.coefficients.f1_n_per_kmh"),
    ("f2", "road_load.form.coefficients.f2_n_per_kmh2"),
    ("road-load", ""),
    ("tyre", "road_load.wheel_radius_m"),
    ("displacement", "engine.displacement_cc"),
    ("power", "engine.rated_kw"),
    ("torque", "engine.full_load"),
    ("idle", "engine.idle.hot_rpm"),
    ("oil", "thermal.transmission.oil_l"),
];
/// Numbers of a CVT.
const OF_CVT: [(&str, &str); 5] = [
    ("final-drive", "transmission.cvt.final_drive_ratio"),
    ("ratio-low", "transmission.cvt.ratio.low"),
    ("ratio-high", "transmission.cvt.ratio.high"),
    (
        "centre-distance",
        "transmission.cvt.variator.centre_distance_mm",
    ),
    ("pump", "transmission.cvt.pump.displacement_cc_rev"),
];
/// Numbers of a manual box; its gears are those of the final drive already.
const OF_MANUAL: [(&str, &str); 2] = [
    ("final-drive", "transmission.manual.final_ratio"),
    ("gears", "transmission.manual.overall_ratios"),
];
/// Numbers that take the place of others.
const INSTEAD: [(&str, &[&str]); 2] = [
    ("wheel-radius", &["tyre"]),
    ("span", &["ratio-low", "ratio-high"]),
];

/// A number that is not given.
#[derive(Clone, Debug)]
pub struct Question {
    /// Name.
    pub name: &'static str,
    /// Meaning and units.
    pub meaning: &'static str,
    /// Value without an answer, and its origin; `None` if an answer is needed.
    pub usual: Option<String>,
}

/// The numbers that are not given.
///
/// # Errors
/// A class or a car that is none.
pub fn questions(answers: &Answers) -> Result<Vec<Question>, Problems> {
    let base = Base::from_answers(answers)?;
    let of_box: &[(&str, &str)] = match base.car.transmission().is_cvt() {
        true => &OF_CVT,
        false => &OF_MANUAL,
    };
    let is_given = |name: &str| {
        let instead = INSTEAD.iter().filter(|(_, list)| list.contains(&name));
        let mut names = instead.map(|(other, _)| *other).chain([name]);
        names.any(|name| answers.numbers.contains_key(name))
    };
    let usual = |name: &str, key: &str| {
        if name == "road-load" {
            return Some(road_load_default(answers));
        }
        let is_scaled = answers.engine_like.is_some() && answers.numbers.contains_key("power");
        if name == "torque" && is_scaled {
            return Some("the engine's own line, scaled to the power, NC-19".to_owned());
        }
        let has_line = answers.engine_like.is_some();
        if name == "torque"
            && !has_line
            && (answers.like.is_none() || answers.numbers.contains_key("power"))
        {
            return Some("from the power, NC-2".to_owned());
        }
        let info = base.car.keys.iter().find(|info| info.key == key)?;
        let unit = if info.unit == "-" { "" } else { &info.unit };
        let value = format!("{} {unit}", info.value);
        Some(format!("{}, {}", value.trim_end(), info.from))
    };
    let all = OF_ALL.iter().chain(of_box);
    let open = all.filter(|(name, _)| !is_given(name));
    let list = open.map(|(name, key)| Question {
        name,
        meaning: meaning(name),
        usual: usual(name, key).filter(|_| !is_missing(answers, name)),
    });
    Ok(list.collect())
}

/// Names the procedure that road load coefficients are assumed to be from without an answer, and the reason.
#[must_use]
pub fn road_load_default(answers: &Answers) -> String {
    match has_lbf(answers) {
        true => "neutral: targets in lbf are EPA's, of coast-downs in neutral".to_owned(),
        false => "body".to_owned(),
    }
}

/// Names the assumed procedure of the road load coefficients for the car's file; `None` if an answer named it, or there are none.
pub(super) fn road_load_note(answers: &Answers) -> Option<String> {
    let has = |name: &str| answers.numbers.contains_key(name);
    if has("road-load") || !["f0", "f1", "f2"].iter().any(|name| has(name)) {
        return None;
    }
    Some(match has_lbf(answers) {
        true => "road load: f0, f1 and f2 in lbf are taken for EPA's targets, of a coast-down in neutral, and the drag of the box is taken off them (NC-18); if they are of the body alone, road-load is body".to_owned(),
        false => "road load: f0, f1 and f2 are taken for those of the body; of a coast-down in neutral they have the drag of the box in them, and road-load is neutral".to_owned(),
    })
}

/// Problem of a number, by itself or with those that are given.
#[must_use]
pub fn mistake(answers: &Answers, name: &'static str, text: &str) -> Option<Problem> {
    let found = |answers: &Answers| made(answers, &[]).err().into_iter().flatten();
    let before: Vec<Problem> = found(answers).collect();
    let mut with = answers.clone();
    with.numbers.insert(name, text.to_owned());
    let mut new = found(&with)
        .filter(|problem| problem.kind != ProblemKind::Missing && !before.contains(problem));
    new.next()
}
