//! One `[[parameter]]` of a plan.

use super::FreeParameter;
use super::keys::{PARAMETER, PRIOR};
use crate::solve::Prior;
use cvtcycle_config::ProblemKind;
use cvtcycle_config::{Document, Problems, Reader, Section};
use cvtcycle_model::keys::Values;
use cvtcycle_model::transmission::loss_factor;
use cvtcycle_validate::source::relative_to;

/// Reads a parameter of a plan file; without vehicles where it names none.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document, file: &str) -> Result<FreeParameter, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let key = Values::text(&s, &PARAMETER.key);
    let also = s.texts(&PARAMETER.also);
    judge(&s, "key", &key);
    for other in &also {
        judge(&s, "also", other);
    }
    let mut all = std::iter::once(&key).chain(&also);
    if let Some(twice) = all.find(|a| {
        std::iter::once(&key)
            .chain(&also)
            .filter(|b| b == a)
            .count()
            > 1
    }) {
        s.complain_by_name(
            ProblemKind::Duplicate,
            "also",
            "keys other than `key`, each once",
            &format!("`{twice}` is named twice"),
            "remove one",
        );
    }
    let [low, high] = [&PARAMETER.low, &PARAMETER.high].map(|key| Values::number(&s, key));
    if low >= high {
        let hint = "swap them, or leave the parameter out to hold it";
        s.complain_by_name(
            ProblemKind::Conflict,
            "low",
            "below `high`",
            "`low` is not below `high`",
            hint,
        );
    }
    let start = s.optional(&PARAMETER.start);
    let inside = |x: f64| low <= x && x <= high;
    if start.is_some_and(|x| !inside(x) && low < high && x.is_finite()) {
        let (allowed, hint) = (format!("{low} to {high}"), "move it, or widen the bounds");
        s.complain_by_name(
            ProblemKind::OutOfRange,
            "start",
            &allowed,
            "`start` is outside the bounds",
            hint,
        );
    }
    let prior = prior(&s);
    let status = s.word(&PARAMETER.status);
    if prior.is_some() && !s.has("status") {
        let allowed = PARAMETER.status.allowed();
        let hint = "add `status = \"assumed\"`";
        s.missing("status", &allowed, "a prior needs a status", hint);
    }
    let free = FreeParameter {
        low,
        high,
        start,
        status: prior.map_or("", |_| status),
        prior,
        vehicles: (s.texts(&PARAMETER.vehicles).iter())
            .map(|word| relative_to(file, word))
            .collect(),
        source: Values::text(&s, &PARAMETER.source),
        place: s.place("key"),
        also_place: s.place("also"),
        also,
        bounds: ["low", "high"].map(|key| s.place(key)),
        key,
    };
    let context = match free.key.as_str() {
        "" => String::new(),
        key => format!("parameter {key}: "),
    };
    let read = reader.finish();
    read.map(|_| free)
        .map_err(|problems| problems.map(|p| p.with_context(&context)))
}

/// Complains of a key that no file has, or that is no parameter of the physics.
fn judge(s: &Section, name: &str, key: &str) {
    if !key.is_empty() && !key.contains('.') {
        let allowed = "a dotted key of the vehicle's files";
        let message = format!("`{key}` is no dotted key");
        let hint = "`cvtcycle show VEHICLE` lists the keys";
        s.unknown_key(name, allowed, &message, hint);
    }
    if loss_factor::is_key(key) {
        s.complain_by_name(
            ProblemKind::Conflict,
            name,
            "a parameter of the model",
            "a factor on a loss is no parameter of the physics",
            "fit what the loss depends on: `cvtcycle explain KEY` names the equations",
        );
    }
}

fn prior(s: &Section) -> Option<Prior> {
    let s = s.table("prior");
    if !s.exists() {
        return None;
    }
    let [mean, sd] = [&PRIOR.mean, &PRIOR.sd].map(|key| Values::number(&s, key));
    if sd <= 0.0 {
        let message = "the standard deviation is not above 0";
        let hint = "leave the parameter out to hold it at its value";
        s.out_of_range("sd", "above 0", message, hint);
    }
    Some(Prior { mean, sd })
}
