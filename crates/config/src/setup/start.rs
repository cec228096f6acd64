//! Temperatures of single nodes at the start, as a user writes them: `coolant=81,sump=60`.

use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::thermal::{COOLANT, START_NODES, StartTemperatures};

use super::START;
use crate::{Bound, Problem, did_you_mean};
use cvtcycle_model::cycle::Recording;

/// Temperatures of a log's first rows that are taken: -40 degC is what a port gives for none.
const LOGGED: Bound = Bound::closed(-39.0, 129.0);

/// Parses temperatures of nodes in degC, `NODE=DEGC` with commas between (TH-10).
///
/// # Errors
/// An unknown node, a node twice, a number that is none or out of range.
pub fn start_nodes(text: &str) -> Result<StartTemperatures, Problem> {
    let parts = text.split(',').map(|part| {
        let (name, degc) = part.split_once('=').unwrap_or((part, ""));
        let degc = degc.trim();
        let degc = degc.strip_suffix("degC").unwrap_or(degc).trim();
        (name.trim(), degc.parse().map_err(|_| degc.to_owned()))
    });
    nodes(text, parts)
}

/// The same of names with their temperatures, degC.
///
/// # Errors
/// As [`start_nodes`].
pub fn start_of_nodes(list: &[(String, f64)]) -> Result<StartTemperatures, Problem> {
    let text: Vec<String> = list.iter().map(|(name, x)| format!("{name}={x}")).collect();
    let parts = list.iter().map(|(name, degc)| (name.as_str(), Ok(*degc)));
    nodes(&text.join(","), parts)
}

/// The temperatures with which a log begins, of the nodes that it has channels of; none without the coolant's, as an oil may be the engine's or the box's. A value out of the range of a start is that of a missing
/// sensor, and is passed over.
#[must_use]
pub fn start_of_log(recording: &Recording) -> Option<StartTemperatures> {
    // No sensor is finer than 0.1 K.
    let first = |name: &str| {
        recording
            .first(name)
            .map(|degc| (10.0 * degc).round() / 10.0)
    };
    let of = |name: &str| first(name).filter(|degc| LOGGED.contains(*degc));
    let given_k = START_NODES.map(|name| of(name).map(|degc| degc + ZERO_DEGC_K));
    let start = StartTemperatures { given_k };
    start.given_k[COOLANT].is_some().then_some(start)
}

fn nodes<'a>(
    text: &str,
    parts: impl Iterator<Item = (&'a str, Result<f64, String>)>,
) -> Result<StartTemperatures, Problem> {
    let names = START_NODES.join(", ");
    let bad = |message: String, hint: String| {
        let form = format!(
            "NODE=DEGC with commas between, {}; nodes: {names}",
            START.in_unit("degC")
        );
        Problem::invalid(message)
            .key("start")
            .value(text)
            .allowed(form)
            .hint(hint)
    };
    let mut start = StartTemperatures::default();
    let mut empty = true;
    for (name, degc) in parts {
        let Some(node) = START_NODES.iter().position(|own| *own == name) else {
            let known = START_NODES.iter().copied();
            let hint = did_you_mean(name, known).unwrap_or_default();
            return Err(bad(format!("there is no node `{name}`"), hint));
        };
        let degc = degc.map_err(|word| {
            let message = format!("the temperature of `{name}` is not a number: `{word}`");
            bad(message, "coolant=81,sump=60".to_owned())
        })?;
        if !START.contains(degc) {
            let message = format!("{degc} degC of `{name}` is out of range");
            return Err(bad(message, String::new()));
        }
        if start.given_k[node].is_some() {
            let hint = "give each node once".to_owned();
            return Err(bad(format!("`{name}` is given twice"), hint));
        }
        start.given_k[node] = Some(degc + ZERO_DEGC_K);
        empty = false;
    }
    match empty {
        true => Err(bad("no node is given".to_owned(), String::new())),
        false => Ok(start),
    }
}
