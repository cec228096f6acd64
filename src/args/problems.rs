//! Problems of options, and the library's problems under the options of the command line.

use cvtcycle::config::{Argument, Input, Override, Place, Problem, Problems, Setting};

/// A problem of an option or argument.
pub fn problem(option: &str, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .in_file(option)
        .key(option)
        .hint(hint)
}

/// A problem of the value of an option, with the allowed values.
pub fn bad_value(option: &str, value: &str, allowed: &str, message: &str, hint: &str) -> Problem {
    problem(option, message, hint).value(value).allowed(allowed)
}

/// Hint that names known names similar to the given one; empty without any.
pub fn did_you_mean(value: &str, known: &[&str]) -> String {
    cvtcycle::config::did_you_mean(value, known.iter().copied()).unwrap_or_default()
}

/// Parses the overrides of an option. Invalid ones are reported under it and left out.
pub fn overrides(option: &str, texts: &[String], problems: &mut Problems) -> Vec<Override> {
    let parse = |text: &String| {
        let found = text.parse::<Override>();
        problems.take(found.map_err(|problem| cite_override(option, text, problem)))
    };
    texts.iter().filter_map(parse).collect()
}

/// A problem of an override under the option that gives it.
pub fn cite_override(option: &str, text: &str, problem: Problem) -> Problem {
    problem.in_file(format!("{option} {text}"))
}

/// Problems of arguments of the library under the option that gives them.
pub fn cite(option: &str, found: impl Into<Problems>) -> Problems {
    found.into().map(|problem| match problem.place.input {
        // Columns have an option of their own.
        Input::Argument(Argument::Columns) => cite_options(problem),
        Input::Argument(_) => problem.in_file(option).key(option),
        _ => problem,
    })
}

/// Cites the option or argument of the command line that a problem is about, and those that its hint mentions.
pub fn cite_options(mut problem: Problem) -> Problem {
    if !problem.settings.is_empty() {
        let options: Vec<&str> = problem.settings.iter().map(|s| setting_flag(*s)).collect();
        problem.hint += &format!(" ({})", options.join(", "));
        // Added once, even if the problem passes here again.
        problem.settings = &[];
    }
    match &problem.place.input {
        Input::File(_) => {}
        Input::Override(text) => problem.place = Place::file(format!("--set {text}")),
        Input::Argument(argument) => {
            let option = argument_option(*argument);
            problem = problem.in_file(option);
            if problem.key.is_empty() {
                option.clone_into(&mut problem.key);
            }
        }
    }
    problem
}

/// The option of the command line for a setting of the library.
fn setting_flag(setting: Setting) -> &'static str {
    match setting {
        Setting::Replace => "--force",
        Setting::Resume => "--resume",
        Setting::Added => "--with",
        Setting::Loosely => "--loosely",
        Setting::Columns => "--columns",
        Setting::Repair => "--repair",
    }
}

/// The option or argument of the command line for an argument of the library.
fn argument_option(argument: Argument) -> &'static str {
    match argument {
        Argument::Vehicle => "--vehicle",
        Argument::Lubricant => "--lubricant",
        Argument::EngineOil => "--engine-oil",
        Argument::Cycle => "--cycle",
        Argument::Plan | Argument::Calibration => "PLAN",
        Argument::Cover => "--cover",
        Argument::Columns => "--columns",
        Argument::Repair => "--repair",
        Argument::Output => "--out",
        Argument::File => "FILE",
    }
}

/// A problem with the vehicle cites the argument `CAR` of a command that names it without an option.
pub fn cite_car(problem: Problem) -> Problem {
    match problem.place.is_argument(Argument::Vehicle) {
        true => problem.in_file("CAR").key("CAR"),
        false => problem,
    }
}
