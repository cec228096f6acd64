//! Scene of a run in a directory.

use std::path::Path;

use cvtcycle_config::setup::{Options, TWIN, baseline_of, is_twin, load};
use cvtcycle_config::{Problems, cycle};
use cvtcycle_output::provenance::{car_sha256, cycle_sha256};
use cvtcycle_output::record::{CarRecord, Record};
use cvtcycle_output::summary::{Summary, UNCHANGED};
use cvtcycle_study::plan::Base;

use super::scene::Scene;
use crate::live_section::{LiveSection, State};
use crate::problems::problem;
use crate::results::{ResultDir, find};

/// Builds the live section of the run in a directory, with the cars as driven there. `first_figure` is the number of its first figure.
///
/// # Errors
/// The directory holds no run with its inputs; a car or the cycle has changed since the run.
pub fn section_of_dir(dir: &Path, first_figure: usize) -> Result<LiveSection, Problems> {
    let hint = "`cvtcycle whatif CAR` makes such a page of any car";
    let ResultDir::Run(found) = find(dir, &[])? else {
        return Err(problem(dir, "only the report of a run can be driven again", hint).into());
    };
    let Some(record) = &found.record else {
        let message = "the run has no inputs.json, which says what its cars are made of";
        return Err(problem(dir, message, "run it again").into());
    };
    let scene = scene(dir, &found.summary, record, first_figure)?;
    LiveSection::new(scene)
}

/// Cars and conditions of a run, as a study has them.
///
/// # Errors
/// A car or the cycle has changed since the run.
pub(crate) fn base_of_run(
    dir: &Path,
    summary: &Summary,
    record: &Record,
) -> Result<Base, Problems> {
    let scene = scene(dir, summary, record, 0)?;
    let [set_all, set] = scene.overrides()?;
    Ok(Base {
        vehicle: scene.vehicle.clone(),
        baselines: Some(scene.baselines.iter().map(twin_or_word).collect()),
        cycle: scene.state.cycle.clone(),
        ambient_degc: scene.state.ambient_degc,
        start: scene.start.clone(),
        lubricant: scene.state.lubricant.clone(),
        engine_oil: scene.engine_oil.clone(),
        set,
        set_all,
        dt_s: scene.dt_s,
        formulation: scene.formulation(),
    })
}

/// The word of a baseline in a plan.
fn twin_or_word(word: &String) -> String {
    if is_twin(word) { TWIN } else { word }.to_owned()
}

fn scene(
    dir: &Path,
    summary: &Summary,
    record: &Record,
    first_figure: usize,
) -> Result<Scene, Problems> {
    let settings = &summary.settings;
    let changed = |what: &str, hint: &str| {
        let message = format!("{what} is not found again as it was driven");
        Problems::from(problem(dir, &message, hint))
    };
    let [subject, baselines @ ..] = &record.cars[..] else {
        return Err(changed("the car", "run it again"));
    };
    let vehicle = word(&subject.vehicle.file);
    let roles = summary.runs.iter().map(|run| run.role.as_str());
    let others = baselines.iter().zip(roles.skip(1));
    let others = others.filter(|(_, role)| *role != UNCHANGED);
    let is_own =
        |car: &&CarRecord| car.vehicle == subject.vehicle && car.lubricant != subject.lubricant;
    let baseline = |car: &CarRecord| match is_own(&car) {
        true => baseline_of(&vehicle, TWIN),
        false => word(&car.vehicle.file),
    };
    let mut scene = Scene {
        baselines: others.map(|(car, _)| baseline(car)).collect(),
        vehicle,
        set: settings.set.clone(),
        set_all: settings.set_all.clone(),
        engine_oil: None,
        start: summary.start.text(),
        dt_s: settings.dt_s,
        formulation: settings.formulation.clone(),
        state: State {
            cycle: (record.cycle.file.clone()).unwrap_or_else(|| summary.cycle.clone()),
            ambient_degc: summary.ambient_degc,
            ..State::default()
        },
        first_figure,
        ..Scene::default()
    };
    let own = load(&scene.vehicle, &Options::default())?;
    let [oil, engine_oil] = &own.origin.fluids;
    let given = |file: &str, own: &String| Some(word(file)).filter(|word| word != own);
    scene.state.lubricant = given(&subject.lubricant.file, oil);
    scene.engine_oil = given(&subject.engine_oil.file, engine_oil);
    let hint = "a file has changed since, or lies elsewhere: run it again, or make a page with `cvtcycle whatif`";
    let driven = load(&scene.vehicle, &scene.subject(&scene.state, &[])?)?;
    if car_sha256(&driven) != subject.resolved_sha256 {
        return Err(changed(&format!("car {}", subject.name), hint));
    }
    let cycle = cycle::find(&scene.state.cycle);
    let same = |found: cycle::Cycle| {
        let found = cycle::for_car(&scene.state.cycle, found, &driven);
        cycle_sha256(&found) == record.cycle.sha256
    };
    match cycle.is_ok_and(same) {
        true => Ok(scene),
        false => Err(changed(&format!("cycle {}", summary.cycle), hint)),
    }
}

/// Word that names a file of a record.
fn word(file: &str) -> String {
    let embedded = file.strip_prefix("embedded:");
    let name = embedded.and_then(|name| name.strip_suffix(".toml"));
    name.unwrap_or(file).to_owned()
}
