//! `new`: a vehicle file from catalogue numbers.

mod ask;

use std::io::{IsTerminal, Write};

use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use cvtcycle::config::bounded::TOML;
use cvtcycle::config::procedure::Procedure;
use cvtcycle::config::setup::Kind;
use cvtcycle::config::setup::catalogue::{ENGINE_OIL, OIL};
use cvtcycle::config::setup::new_car::{self, Answers, ClassOf, NUMBERS, NewCar};
use cvtcycle::config::{Problem, Problems, decode};
use cvtcycle::fleet::weights::{Weight, weights};
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::table::wrapped;

use super::Execute;
use crate::args::problems::{bad_value, cite_options};
use crate::args::{Names, OutArgs, bytes};
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Arguments of `new`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE.toml").help("Write this file [default: NAME.toml]")),
    mut_arg("force", |force| force.help("Replace the file")),
    after_help = "\
Example:
  cvtcycle new mycar --mass 1320 --f0 105 --f1 0.55 --f2 0.0305 --tyre '215/55 R16' --displacement 1.8l --power 104kW@6400 --torque 172@4000

What is not given comes from a class (`cvtcycle list classes`) or from the car of --like, with the status `class` or `like`; the file says what was given and
which rule made what follows from it. A unit may be given with each number, and has to be with power: 3000lb, 17.4lbf, 158hp@6500. `cvtcycle new mycar` in a \
terminal has a question for each. Then `cvtcycle check mycar.toml`, `cvtcycle run --vehicle mycar.toml`."
)]
pub struct NewArgs {
    /// Name of the car and of its file: letters, digits, - and _
    #[arg(value_name = "NAME")]
    name: String,
    /// Title [default: NAME]
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Car from which the rest comes: a name, or a path relative to the new file
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    like: Option<String>,
    /// Class of body and engine [default: compact_2020]
    #[arg(long, value_name = "CLASS", value_parser = Names(|| ClassOf::Body.names()), hide_possible_values = true)]
    class: Option<String>,
    /// Class of the transmission [default: that of --like, else box_cvt_clutch]
    #[arg(long = "box", value_name = "CLASS", value_parser = Names(|| ClassOf::Box.names()), hide_possible_values = true)]
    gearbox: Option<String>,
    /// Technology of the engine: pfi, di, di_high_compression, atkinson, turbo, diesel [default: that of the class]
    #[arg(long, value_name = "TECHNOLOGY", value_parser = Names(new_car::technologies), hide_possible_values = true)]
    engine: Option<String>,
    /// Year of the engine: the newest set of its technology that is not newer
    #[arg(long, value_name = "YEAR")]
    engine_year: Option<String>,
    /// Measured engine that it has, such as honda_l15b7; without size, power and torque all of it, with power its line of full load scaled
    #[arg(long, value_name = "ENGINE", value_parser = Names(new_car::named_engines), hide_possible_values = true)]
    engine_like: Option<String>,
    /// Take what is not given as an option from this file, a TOML table: mass = "3000lb"
    #[arg(long, value_name = "FILE.toml")]
    answers: Option<String>,
    /// Ask for each number that is not given [default: in a terminal, where displacement or power is missing]
    #[arg(long)]
    ask: bool,
    #[command(flatten)]
    numbers: Numbers,
    #[command(flatten)]
    out: OutArgs,
}

/// Catalogue numbers, one option each.
#[derive(Clone, Debug, Default)]
struct Numbers(Vec<(&'static str, String)>);

impl FromArgMatches for Numbers {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = NUMBERS.iter().filter_map(|(name, _)| {
            let text = matches.get_one::<String>(name)?;
            Some((*name, text.clone()))
        });
        Ok(Numbers(given.collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Numbers::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Numbers {
    fn augment_args(command: Command) -> Command {
        NUMBERS.iter().fold(command, |command, (name, meaning)| {
            let mut meaning = (*meaning).to_owned();
            meaning[..1].make_ascii_uppercase();
            let option = Arg::new(*name).long(*name).help(meaning);
            command.arg(option.value_name("VALUE").allow_hyphen_values(true))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Numbers::augment_args(command)
    }
}

/// Note on the default box, printed if no box is named.
const USUAL_BOX: &str = "box: box_cvt_clutch, with a wet launch clutch; most CVTs from 2010 on have a torque converter: --box box_cvt_converter\n";

/// Car and its file.
pub struct NewPlan {
    car: NewCar,
    /// Answers from which the car is made.
    answers: Answers,
    /// True if the box is the default because none was named.
    has_usual_box: bool,
    file: OutputFile,
}

impl Execute for NewArgs {
    type Plan = NewPlan;

    fn plan(&self, problems: &mut Problems) -> Option<NewPlan> {
        let fits = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
        if self.name.is_empty() || self.name.starts_with('-') || !self.name.chars().all(fits) {
            let message = "this is no name of a car";
            let hint = "a path is given with --out, words for people with --title";
            let allowed = "letters, digits, - and _";
            problems.add(bad_value("NAME", &self.name, allowed, message, hint));
            return None;
        }
        let path = match &self.out.out {
            Some(path) => path.clone(),
            None => format!("{}.toml", self.name).into(),
        };
        let mut answers = Answers {
            file: path.display().to_string(),
            title: self.title.clone().unwrap_or_default(),
            like: self.like.clone(),
            class: self.class.clone(),
            gearbox: self.gearbox.clone(),
            engine: self.engine.clone(),
            engine_year: self.engine_year.clone(),
            engine_like: self.engine_like.clone(),
            numbers: self.numbers.0.iter().cloned().collect(),
            ..Answers::default()
        };
        self.complete(&mut answers, problems);
        let has_usual_box = answers.like.is_none() && answers.gearbox.is_none();
        let car = problems.take(new_car::write(&answers).map_err(|found| found.map(option)));
        let file = self.out.file(Some(path), "toml", problems);
        Some(NewPlan {
            car: car?,
            answers,
            has_usual_box,
            file: file?,
        })
    }

    fn run(&self, plan: NewPlan, _: Terminal) -> CommandResult {
        let NewPlan {
            car,
            has_usual_box,
            answers,
            mut file,
        } = plan;
        let written = file.write_all(car.text.as_bytes());
        written.map_err(|error| cite_options(file.cannot_write(&error)))?;
        let path = file.commit().map_err(cite_options)?;
        let path = path.display();
        let is_fluid = |key: &str| key.starts_with(OIL) || key.starts_with(ENGINE_OIL);
        let count = |status: &str| {
            let keys = car.setup.keys.iter();
            keys.filter(|info| info.status == status && !is_fluid(&info.key))
                .count()
        };
        let [given, derived] = ["user", "derived"].map(count);
        let inherited = count("class") + count("like");
        let mut text = format!(
            "{path}  {}\n{given} values given, {derived} by rule, {inherited} inherited: `cvtcycle show {path}` prints them\n",
            car.setup.title
        );
        if has_usual_box {
            text += USUAL_BOX;
        }
        text.extend(car.notes.iter().map(|note| format!("{note}\n")));
        text += &weighed(&answers);
        let doubts = car.setup.doubts().into_iter();
        text.extend(doubts.map(|doubt| format!("doubt: {doubt}\n")));
        Ok(CommandOutput::text(text))
    }
}

/// Test whose fuel tells which numbers matter.
const TEST: &str = "ftp75";
/// Numbers that are named.
const NAMED: usize = 3;

/// The numbers that matter most for the fuel of a test, in words; empty where none matters or the car cannot be driven.
fn weighed(answers: &Answers) -> String {
    let test = Procedure::open(TEST).ok();
    let Some((fuel, weights)) = test.and_then(|test| weights(answers, &test)) else {
        return String::new();
    };
    let said = |weight: &&Weight| weight.fuel_percent.abs() >= 0.05;
    let words = |weight: &Weight| {
        let (name, by) = (weight.name, &weight.by);
        match (name, weight.by.ends_with('%')) {
            ("road-load", _) => format!("{name} ({by}) {} %", fixed(weight.fuel_percent, 1)),
            (_, true) => format!("{name} ({by} more) {} %", signed(weight.fuel_percent, 1)),
            _ => format!("{name} ({by} later) {} %", signed(weight.fuel_percent, 1)),
        }
    };
    let list: Vec<String> = weights.iter().filter(said).take(NAMED).map(words).collect();
    if list.is_empty() {
        return String::new();
    }
    let line = format!(
        "FTP75: {} L/100 km. Of what was given, these matter most for it, by their usual uncertainty: {}",
        fixed(fuel, 2),
        list.join(", ")
    );
    wrapped(&line, "")
}

impl NewArgs {
    /// Adds answers from a file and from the terminal, and a default title.
    fn complete(&self, answers: &mut Answers, problems: &mut Problems) {
        if let Some(file) = &self.answers {
            let text = bytes("--answers", file, TOML).and_then(|bytes| decode(file, &bytes));
            problems.take(text.and_then(|text| answers.add_file(file, &text)));
        }
        let (input, output) = (std::io::stdin(), std::io::stderr());
        let in_terminal = input.is_terminal() && output.is_terminal() && needs_numbers(answers);
        if problems.is_empty() && (self.ask || in_terminal) {
            problems.take(ask::ask(
                answers,
                input.is_terminal(),
                &mut input.lock(),
                &mut output.lock(),
            ));
        }
        if answers.title.is_empty() {
            answers.title.clone_from(&self.name);
        }
    }
}

/// True if a number is missing that neither the class nor the base car has.
fn needs_numbers(answers: &Answers) -> bool {
    new_car::questions(answers)
        .is_ok_and(|list| list.iter().any(|question| question.usual.is_none()))
}

/// Cites the option of a catalogue number.
fn option(problem: Problem) -> Problem {
    if problem.place.line > 0 {
        return problem;
    }
    let is_number = NUMBERS.iter().any(|(name, _)| *name == problem.key);
    let words = ["class", "box", "engine", "engine-year", "engine-like"];
    if is_number || words.contains(&problem.key.as_str()) {
        let option = format!("--{}", problem.key);
        return problem.in_file(&option).key(option);
    }
    problem
}
