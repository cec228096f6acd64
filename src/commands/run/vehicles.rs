//! The vehicles of a run: the subject with its overrides, then the baselines.

use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Document, Place, Problem, Problems};
use cvtcycle::model::transmission::cvt::variator::Formulation;

use super::RunArgs;

/// A vehicle of a run.
pub struct RunVehicle {
    /// Name of the vehicle file, with a number if two vehicles share it.
    pub name: String,
    /// Checked input.
    pub setup: Setup,
    /// Name or path as the user, or the file of the subject, has it.
    pub word: String,
    /// Options it was loaded with.
    pub options: Options,
}

/// Loads all vehicles, subject first. A bad one leaves its problems, and the others are read as well.
pub fn load(args: &RunArgs, formulation: Formulation, problems: &mut Problems) -> Vec<RunVehicle> {
    check_syntax(args, problems);
    let (car, comparison) = (&args.car, &args.comparison);
    let subject = Options {
        lubricant: car.lubricant.clone(),
        engine_oil: comparison.engine_oil.clone(),
        set: comparison.set_all.iter().chain(&car.set).cloned().collect(),
        formulation,
    };
    let baseline = Options {
        lubricant: None,
        set: comparison.set_all.clone(),
        ..subject.clone()
    };
    let setup = problems.take(load_one(&car.vehicle, "--vehicle", &subject, args));
    if setup.is_none() {
        // The fluids are checked by themselves where the vehicle cannot be read.
        let fluids = [
            (&car.lubricant, "--lubricant"),
            (&comparison.engine_oil, "--engine-oil"),
        ];
        for (word, option) in fluids {
            if let Some(word) = word {
                problems.take(setup::load_lubricant(word, option, &[], ""));
            }
        }
    }
    let names = comparison.baselines(&car.vehicle, setup.as_ref(), problems);
    // Problems of a baseline cite the file or the option that names it.
    let named_by = match comparison.baseline.is_empty() {
        true => car.vehicle.as_str(),
        false => "--baseline",
    };
    let mut loaded = vec![(&car.vehicle, setup, subject)];
    for name in &names {
        let setup = problems.take(load_one(name, named_by, &baseline, args));
        loaded.push((name, setup, baseline.clone()));
    }
    let mut vehicles: Vec<RunVehicle> = Vec::new();
    for (word, setup, options) in loaded {
        let Some(setup) = setup else { continue };
        vehicles.push(RunVehicle {
            name: unique(&setup.name, &vehicles),
            setup,
            word: word.clone(),
            options,
        });
    }
    vehicles
}

/// Reports assignments with bad syntax once, without a vehicle.
fn check_syntax(args: &RunArgs, problems: &mut Problems) {
    for (option, list) in [
        ("--set", &args.car.set),
        ("--set-all", &args.comparison.set_all),
    ] {
        for assignment in list {
            let empty = Document::parse("", "");
            if let Some(mut document) = problems.take(empty)
                && let Err(problem) = document.set(assignment)
            {
                problems.add(renamed(problem, option, assignment));
            }
        }
    }
}

/// The problem under the option that the user wrote: the library calls every assignment `--set`.
fn renamed(problem: Problem, option: &str, assignment: &str) -> Problem {
    if problem.place.file != format!("--set {assignment}") {
        return problem;
    }
    Problem {
        place: Place {
            file: format!("{option} {assignment}"),
            ..problem.place
        },
        ..problem
    }
}

fn load_one(
    word: &str,
    option: &str,
    options: &Options,
    args: &RunArgs,
) -> Result<Setup, Problems> {
    let for_all = |mut problem: Problem| {
        let own = |a: &&String| problem.place.file == format!("--set {a}");
        if let Some(assignment) = args.comparison.set_all.iter().find(own) {
            problem = renamed(problem, "--set-all", assignment);
            if !problem.key.is_empty() && assignment.contains('=') {
                problem.message = format!("{word}: {}", problem.message);
            }
        }
        problem
    };
    setup::load(word, option, options)
        .map_err(|problems| problems.into_iter().map(for_all).collect())
}

fn unique(name: &str, vehicles: &[RunVehicle]) -> String {
    let taken = |name: &String| {
        vehicles
            .iter()
            .any(|car| car.name.eq_ignore_ascii_case(name))
    };
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken(name)).unwrap_or_default()
}
