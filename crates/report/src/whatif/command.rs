//! Shell command that prints the numbers of a state.

use super::scene::{DRAWS, Scene};
use crate::live_section::State;

/// Builds the command that prints the numbers of a state: overrides in the order of the page, then the cars.
pub(super) fn command(
    scene: &Scene,
    state: &State,
    set: &[String],
    baselines: &[String],
) -> String {
    let mut list: Vec<&str> = vec!["cvtcycle", "run", "--vehicle", &scene.vehicle];
    let mut option = |name: &'static str, value| list.extend([name, value]);
    let ambient = state.ambient_degc.to_string();
    let (dt, draws) = (scene.dt_s.to_string(), DRAWS.to_string());
    option("--cycle", &state.cycle);
    option("--ambient", &ambient);
    option("--start", &scene.start);
    if (scene.dt_s - 1.0).abs() > 0.0 {
        option("--dt", &dt);
    }
    if scene.formulation().name() != "smooth" {
        option("--formulation", &scene.formulation);
    }
    for text in &scene.set_all {
        option("--set-all", text);
    }
    for text in set {
        option("--set", text);
    }
    if let Some(oil) = &state.lubricant {
        option("--lubricant", oil);
    }
    if let Some(oil) = &scene.engine_oil {
        option("--engine-oil", oil);
    }
    for name in baselines {
        option("--baseline", name);
    }
    match baselines.is_empty() {
        true => option("--baseline", "none"),
        false => option("--draws", &draws),
    }
    let quoted = list.into_iter().map(quoted);
    quoted.collect::<Vec<_>>().join(" ")
}

/// Quotes a word for a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-+=./:,%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}
