//! One `[[parameter]]` of a plan.

use super::types::FreeParameter;
use crate::fit::solve::Prior;
use cvtcycle_config::{Bound, Document, Problems, Reader, Section};

/// How a prior may be known.
const STATUSES: [&str; 4] = ["source", "derived", "fitted", "assumed"];

/// Reads a parameter.
///
/// # Errors
/// All its problems.
pub(super) fn read(document: &Document) -> Result<FreeParameter, Problems> {
    let reader = Reader::new(document);
    let s = reader.root();
    let any = Bound::any();
    let key = s.text("key", "dotted key of the vehicle or of its fluids");
    if !key.is_empty() && !key.contains('.') {
        s.complain(
            "key",
            "a dotted key of the vehicle's files",
            &format!("`{key}` is no dotted key"),
            "`cvtcycle show VEHICLE` lists the keys",
        );
    }
    let (low, high) = (
        s.number("low", any, "least value, in the unit of the key"),
        s.number("high", any, "largest value"),
    );
    if low >= high {
        s.complain(
            "low",
            "below `high`",
            "`low` is not below `high`",
            "swap them, or leave the parameter out to hold it",
        );
    }
    let start = s.optional_number("start", any, "first value; that of the file if absent");
    let inside = |x: f64| low <= x && x <= high;
    if start.is_some_and(|x| !inside(x) && low < high && x.is_finite()) {
        s.complain(
            "start",
            &format!("{low} to {high}"),
            "`start` is outside the bounds",
            "move it, or widen the bounds",
        );
    }
    let prior = prior(&s);
    let status = s
        .word_or(
            "status",
            &STATUSES.map(|word| word),
            "assumed",
            "how the prior is known",
        )
        .to_owned();
    if prior.is_some() && !s.has("status") {
        s.complain(
            "status",
            &format!("one of {}", STATUSES.join(", ")),
            "a prior needs a status",
            "add `status = \"assumed\"`",
        );
    }
    let source = s.text_or("source", "", "reason or reference for bounds and prior");
    let status = if prior.is_some() {
        status
    } else {
        String::new()
    };
    let free = FreeParameter {
        low,
        high,
        start,
        prior,
        status,
        source,
        place: s.place("key"),
        bounds: ["low", "high"].map(|key| s.place(key)),
        key,
    };
    reader.finish().map(|_| free.clone()).map_err(|problems| {
        let of = if free.key.is_empty() {
            String::new()
        } else {
            format!("parameter {}: ", free.key)
        };
        problems.into_iter().map(|p| p.with_context(&of)).collect()
    })
}

fn prior(s: &Section) -> Option<Prior> {
    let table = s.table("prior");
    if !table.exists() {
        return None;
    }
    let mean = table.number("mean", Bound::any(), "most likely value without the data");
    let sd = table.number("sd", Bound::any(), "standard deviation of it");
    if sd <= 0.0 {
        table.complain(
            "sd",
            "above 0",
            "the standard deviation is not above 0",
            "leave the parameter out to hold it at its value",
        );
    }
    Some(Prior { mean, sd })
}
