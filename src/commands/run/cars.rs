//! The cars of a run: the subject with its overrides, then the baselines.

use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Document, Place, Problem, Problems};
use cvtcycle::model::transmission::cvt::variator::Formulation;

use super::Args;
use crate::args::beside;
use crate::print::problem;

/// A car under the name that it bears in this run.
pub struct Car {
    /// Name of the vehicle file, with a number if two cars share it.
    pub name: String,
    /// Checked input.
    pub setup: Setup,
    /// What the user, or the subject's file, calls it.
    pub word: String,
    /// What it was loaded with.
    pub options: Options,
}

/// Loads all cars, subject first. Where one is bad, its problems are noted and the others are read all the same.
pub fn load(args: &Args, formulation: Formulation, problems: &mut Problems) -> Vec<Car> {
    syntax(args, problems);
    let subject_sets: Vec<String> = args.set_all.iter().chain(&args.set).cloned().collect();
    let subject = Options {
        lubricant: args.lubricant.clone(),
        engine_oil: args.engine_oil.clone(),
        set: subject_sets,
        formulation,
    };
    let baseline = Options {
        lubricant: None,
        set: args.set_all.clone(),
        ..subject.clone()
    };
    let setup = problems.take(one(&args.vehicle, "--vehicle", &subject, args));
    // The fluids by themselves: a car that cannot be read at all says nothing about them.
    for (word, option) in [
        (&args.lubricant, "--lubricant"),
        (&args.engine_oil, "--engine-oil"),
    ] {
        if let (Some(word), None) = (word, &setup) {
            problems.take(setup::load_lubricant(word, option, &[], ""));
        }
    }
    let own = setup
        .iter()
        .flat_map(|s| &s.baselines)
        .map(|name| beside(&args.vehicle, name))
        .collect();
    let names = baselines(args, own, problems);
    let mut cars = Vec::new();
    // Whoever named a baseline is to be cited for it.
    let namer = if args.baseline.is_empty() {
        args.vehicle.as_str()
    } else {
        "--baseline"
    };
    let others = names
        .iter()
        .map(|name| problems.take(one(name, namer, &baseline, args)));
    let others: Vec<Option<Setup>> = others.collect();
    let words = [&args.vehicle].into_iter().chain(&names);
    let options = [subject].into_iter().chain(std::iter::repeat(baseline));
    for ((setup, word), options) in [setup].into_iter().chain(others).zip(words).zip(options) {
        if let Some(setup) = setup {
            cars.push(Car {
                name: unique(&setup.name, &cars),
                setup,
                word: word.clone(),
                options,
            });
        }
    }
    cars
}

/// Assignments that are none, once and without a car.
fn syntax(args: &Args, problems: &mut Problems) {
    for (option, list) in [("--set", &args.set), ("--set-all", &args.set_all)] {
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

/// Under the option that the user wrote: below, every assignment is called `--set`.
fn renamed(problem: Problem, option: &str, assignment: &str) -> Problem {
    if problem.place.file != format!("--set {assignment}") {
        return problem;
    }
    let place = Place {
        file: format!("{option} {assignment}"),
        ..problem.place.clone()
    };
    problem.at(place)
}

fn one(word: &str, option: &str, options: &Options, args: &Args) -> Result<Setup, Problems> {
    setup::load(word, option, options).map_err(|problems| {
        let for_all = |mut problem: Problem| {
            if let Some(assignment) = args
                .set_all
                .iter()
                .find(|a| problem.place.file == format!("--set {a}"))
            {
                problem = renamed(problem, "--set-all", assignment);
                if !problem.key.is_empty() && assignment.contains('=') {
                    problem.message = format!("{word}: {}", problem.message);
                }
            }
            problem
        };
        problems.into_iter().map(for_all).collect()
    })
}

fn baselines(args: &Args, own: Vec<String>, problems: &mut Problems) -> Vec<String> {
    if args.baseline.is_empty() {
        return own;
    }
    let (none, named): (Vec<&String>, Vec<&String>) =
        args.baseline.iter().partition(|name| *name == "none");
    if !none.is_empty() && !named.is_empty() {
        problems.add(problem(
            "--baseline",
            "`none` beside a baseline",
            "give either `--baseline none` or names",
        ));
    }
    named.into_iter().cloned().collect()
}

fn unique(name: &str, cars: &[Car]) -> String {
    let taken = |name: &str| cars.iter().any(|car| car.name.eq_ignore_ascii_case(name));
    if !taken(name) {
        return name.to_owned();
    }
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    numbered
        .into_iter()
        .find(|name| !taken(name))
        .unwrap_or_default()
}
