//! What is wrong between the parts of a plan.

use super::types::{CalibrationPlan, problem};
use cvtcycle_config::{Place, Problems};

/// All clashes; `[parameters, groups]` is how many were written, and `sound` whether nothing else is wrong.
pub(super) fn clashes(
    plan: &CalibrationPlan,
    [parameters, groups]: [usize; 2],
    sound: bool,
) -> Problems {
    let mut problems = Problems::new();
    let mut add = |place: &Place, key: &str, allowed: &str, message: String, hint: &str| {
        problems.push(problem(place, key, allowed, message, hint));
    };
    if parameters == 0 {
        let (allowed, message) = ("at least one [[parameter]]", "nothing is free".to_owned());
        let hint = "add a [[parameter]] with key, low and high";
        add(&plan.place, "parameter", allowed, message, hint);
    }
    if groups == 0 {
        let (allowed, message) = ("at least one [[data]]", "there are no data".to_owned());
        let hint = "add a [[data]] with what was measured";
        add(&plan.place, "data", allowed, message, hint);
    }
    for (k, free) in plan.parameters.iter().enumerate() {
        if let Some(first) = plan.parameters[..k]
            .iter()
            .find(|other| other.key == free.key)
        {
            let (key, line) = (&free.key, first.place.line);
            let message = format!("`{key}` is free twice, first in line {line}");
            add(&free.place, "key", "", message, "remove one");
        }
    }
    for (k, group) in plan.groups.iter().enumerate() {
        if let Some(first) = plan.groups[..k]
            .iter()
            .find(|other| other.name == group.name)
        {
            let (name, line) = (&group.name, first.place.line);
            let message = format!("the name `{name}` was used before, by the data in line {line}");
            add(
                &group.place,
                "name",
                "",
                message,
                "give each [[data]] a `name` of its own",
            );
        }
    }
    for (k, id) in plan.rows.iter().enumerate() {
        if plan.rows[..k].contains(id) {
            // Observations of rows bear their identifiers.
            let last = plan.observations.iter().rfind(|o| o.label == *id);
            let place = last.map_or(&plan.place, |o| &o.place);
            let message = format!("row {id} is used by two groups");
            let hint = "a number counts once: remove it from one of them";
            add(place, "rows", "", message, hint);
        }
    }
    let measured = plan.observations.len();
    let priors = plan
        .parameters
        .iter()
        .filter(|free| free.prior.is_some())
        .count();
    if sound && groups > 0 && measured + priors < parameters {
        let message = format!(
            "too few data: measured numbers {measured}, priors {priors}, parameters {parameters}"
        );
        let allowed = format!("at least {parameters} measured numbers and priors together");
        let hint = "hold some parameters, add data, or give priors";
        add(&plan.place, "data", &allowed, message, hint);
    }
    problems
}
