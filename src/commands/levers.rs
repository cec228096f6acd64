//! `levers`: changes of a design next to the car as it is.

use clap::Args;
use cvtcycle::analysis::levers::{COMBINE, Combine, Lever, LeverFile, LeverRequest, prepare};
use cvtcycle::config::cycle;
use cvtcycle::config::setup::{Kind, Options, is_path};
use cvtcycle::config::{Bound, Problem, Problems};
use cvtcycle::output::summary::start_on;
use cvtcycle::study::Study;
use cvtcycle::study::plan::{MAX_SAMPLES, Plan};

use super::Execute;
use super::study::execution::StudyRunArgs;
use super::study::levers::LeverResults;
use crate::args::input_kind::InputKind;
use crate::args::problems::{bad_value, cite, cite_options, did_you_mean};
use crate::args::{AmbientsArgs, CycleArgs, DriveArgs, Names, count, number};
use crate::print::{CommandResult, Terminal};

/// Allowed `--nvh-rpm`, rpm: engine speed below which load causes noise and vibration.
const NVH_SPEED_RPM: Bound = Bound::closed(500.0, 4000.0);
/// Maximum number of vehicle variants of a study, all of which are in memory.
const MAX_VARIANTS: usize = 500;

/// Arguments of `levers`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle levers
  cvtcycle levers --ambient -10,25 --vehicle rover_216_cvt --vehicle mycar.toml --out levers
  cvtcycle levers my_levers.toml --samples 512 --seed 3
  cvtcycle levers --only variable_pump,offset_2mm --combine variable_pump+offset_2mm
  cvtcycle levers --out levers --resume

Each lever is driven with the same draws of the uncertain values as the car as it is, so that the difference is that of the lever alone: its \
median, what 90 % of the draws are within (`--confidence`), and in how many it saves. The plan is taken relative to the values of its own cars, so that it \
serves any car. A lever that gives a key a value leaves the doubt about that key out, in its reference as well. The combination has the levers \
that save fuel and go together, the best of each group; --combine names others, `none` drives none.

docs/book has the page `Levers`. Exit codes: 0 success, with the number of draws that fail a check and are left out; 1 the car as it is fails in more than half of its draws (without draws: a run fails); 2 bad input; 130 stopped by Ctrl-C: finished parts are kept, \
--resume continues.")]
pub struct LeversArgs {
    /// Lever files: names of built-in ones, or TOML files [default: all built-in ones]
    #[arg(value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Levers.names()), hide_possible_values = true)]
    files: Vec<String>,
    /// Vehicle; repeatable
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    vehicle: Vec<String>,
    #[command(flatten)]
    cycle: CycleArgs,
    #[command(flatten)]
    ambients: AmbientsArgs,
    #[command(flatten)]
    drive: DriveArgs,
    /// Engine oil of all vehicles
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Lubricant.names()), hide_possible_values = true)]
    engine_oil: Option<String>,
    /// Plan whose uncertain values are drawn; `none` for the cars as their files have them
    #[arg(long, value_name = "NAME|PLAN.toml|none", default_value = "uncertainty_rover", value_parser = Names(|| [Kind::Plan.names(), vec!["none"]].concat()), hide_possible_values = true)]
    plan: String,
    /// Draws; 0 for the cars as their files have them
    #[arg(
        long,
        value_name = "N",
        default_value = "256",
        allow_hyphen_values = true
    )]
    samples: String,
    /// Seed of the draws
    #[arg(
        long,
        value_name = "N",
        default_value = "1",
        allow_hyphen_values = true
    )]
    seed: String,
    /// Levers, by name; others are left out
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    only: Vec<String>,
    /// Levers that are left out, by name
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    without: Vec<String>,
    /// Levers that are driven together, by name; repeatable; `none` for no combination [default: those that save and go together]
    #[arg(long, value_name = "NAME+NAME|none")]
    combine: Vec<String>,
    /// Engine speed, rpm, 500 to 4000, below which load is heard and felt
    #[arg(
        long,
        value_name = "RPM",
        default_value = "1300",
        allow_hyphen_values = true
    )]
    nvh_rpm: String,
    #[command(flatten)]
    run: StudyRunArgs,
}

impl Execute for LeversArgs {
    type Plan = Study;

    fn plan(&self, problems: &mut Problems) -> Option<Study> {
        self.run.begin(problems);
        let study = self.study(problems);
        self.run.check_directory(problems);
        study
    }

    fn run(&self, study: Study, terminal: Terminal) -> CommandResult {
        self.run.run::<LeverResults>(&study, terminal)
    }
}

impl LeversArgs {
    /// Builds the study of all levers. None after a problem.
    fn study(&self, problems: &mut Problems) -> Option<Study> {
        let levers = self.levers(problems);
        let cycle = problems.take(cycle::find(&self.cycle.word));
        let ambients = self.ambients.get(problems);
        let (start, dt_s) = self.drive.get(problems);
        let draws = self.draws(problems);
        let combine = self.combinations(problems);
        let heard_rpm = problems.take(number(
            "--nvh-rpm",
            &self.nvh_rpm,
            NVH_SPEED_RPM,
            "heard_rpm",
        ));
        let start = start_on(&cycle?, start?);
        let request = LeverRequest {
            levers: levers?,
            vehicles: self.vehicle.clone(),
            ambients_degc: ambients?,
            cycle: self.cycle.word.clone(),
            start: start.1.text(),
            dt_s: dt_s?,
            base: Options {
                engine_oil: self.engine_oil.clone(),
                ..Options::default()
            },
            set_all: Vec::new(),
            others: Vec::new(),
            draws: draws?,
            combine: combine?,
            heard_rpm: heard_rpm?,
        };
        let columns = request.vehicles.len() * request.ambients_degc.len() * request.levers.len();
        if columns > MAX_VARIANTS {
            let message = format!("{columns} levers of all vehicles at all temperatures");
            let (allowed, hint) = (format!("up to {MAX_VARIANTS}"), "take fewer temperatures");
            problems.add(bad_value(
                "--ambient",
                &self.ambients.ambient,
                &allowed,
                &message,
                hint,
            ));
            return None;
        }
        if !problems.is_empty() {
            return None;
        }
        let cite_option = |problem: Problem| match problem.key.as_str() {
            COMBINE => problem.in_file("--combine").key("--combine"),
            _ => cite_options(problem),
        };
        let study = prepare(&request).map_err(|found| found.map(cite_option));
        self.run.check_run_count(problems.take(study)?, problems)
    }
}

/// Reads a lever file; the problem of a vehicle file in its place has a hint.
fn read_levers(word: &str) -> Result<LeverFile, Problems> {
    let is_vehicle = || matches!(InputKind::detect(word, true), Ok((InputKind::Vehicle, _)));
    if is_path(word) && is_vehicle() {
        let hint = format!("name it with --vehicle {word}");
        let message = "this is a vehicle";
        return Err(bad_value("FILE", word, "a lever file", message, &hint).into());
    }
    LeverFile::open(word).map_err(|found| cite("FILE", found))
}

impl LeversArgs {
    /// Reads the levers of all requested files. None after a problem.
    fn levers(&self, problems: &mut Problems) -> Option<Vec<Lever>> {
        let is_named = !self.files.is_empty();
        let shipped = || {
            Kind::Levers
                .names()
                .into_iter()
                .map(str::to_owned)
                .collect()
        };
        let words: Vec<String> = match is_named {
            true => self.files.clone(),
            false => shipped(),
        };
        let mut all: Vec<Lever> = Vec::new();
        for word in &words {
            let file = problems.take(read_levers(word));
            for lever in file?.levers {
                let same = |other: &&Lever| {
                    let apart = other.of_cvt.zip(lever.of_cvt).is_some_and(|(a, b)| a != b);
                    other.name == lever.name && !apart
                };
                if let Some(other) = all.iter().find(same) {
                    let (name, file) = (&lever.name, other.place.file_name().unwrap_or_default());
                    let problem = Problem::conflict(format!("lever {name} is in {file} as well"));
                    let problem = problem.at(lever.place.clone()).key("lever.name");
                    problems.add(problem.hint("give it another name, or name one file"));
                }
                all.push(lever);
            }
        }
        let only = self.named("--only", &self.only, &all, problems);
        let without = self.named("--without", &self.without, &all, problems);
        let is_wanted = |lever: &Lever| {
            let among = |list: &[String]| list.contains(&lever.name);
            (only.is_empty() || among(&only)) && !among(&without)
        };
        let levers: Vec<Lever> = all
            .into_iter()
            .filter(is_wanted)
            .map(|lever| Lever {
                is_named: is_named || !only.is_empty(),
                ..lever
            })
            .collect();
        if levers.is_empty() && problems.is_empty() {
            let hint = "name fewer in --without";
            let list = self.without.join(",");
            problems.add(bad_value("--without", &list, "", "no lever is left", hint));
        }
        Some(levers)
    }

    /// Parses names of levers; unknown ones are problems.
    fn named(
        &self,
        option: &str,
        names: &[String],
        levers: &[Lever],
        problems: &mut Problems,
    ) -> Vec<String> {
        let known: Vec<&str> = levers.iter().map(|lever| lever.name.as_str()).collect();
        for name in names.iter().filter(|name| !known.contains(&name.as_str())) {
            let message = format!("there is no lever named `{name}`");
            let (allowed, hint) = (known.join(", "), did_you_mean(name, &known));
            problems.add(bad_value(option, name, &allowed, &message, &hint));
        }
        names.to_vec()
    }

    /// Parses the plan, the number of draws and the seed. The inner value is None for no draws.
    fn draws(&self, problems: &mut Problems) -> Option<Option<(Plan, u64, u64)>> {
        let samples = problems.take(count("--samples", &self.samples, 0..=MAX_SAMPLES));
        let seed = problems.take(count("--seed", &self.seed, 0..=u64::MAX));
        if samples == Some(1) {
            let message = "one draw tells nothing of the others";
            let hint = "0 drives the cars as their files have them";
            problems.add(bad_value(
                "--samples",
                "1",
                "0, or 2 and more",
                message,
                hint,
            ));
        }
        let plan = match self.plan.as_str() {
            "none" => None,
            word => Some(problems.take(Plan::open(word))?),
        };
        Some(match (plan, samples?) {
            (None, _) | (_, 0) => None,
            (Some(plan), samples) => Some((plan, samples, seed?)),
        })
    }

    fn combinations(&self, problems: &mut Problems) -> Option<Combine> {
        let is_none = |text: &String| text == "none";
        if self.combine.iter().any(is_none) {
            if self.combine.len() > 1 {
                let (message, hint) = ("`none` together with a combination", "keep one of them");
                let list = self.combine.join(" ");
                problems.add(bad_value("--combine", &list, "", message, hint));
                return None;
            }
            return Some(Combine::None);
        }
        if self.combine.is_empty() {
            return Some(Combine::Automatic);
        }
        let names = |text: &String| text.split('+').map(|name| name.trim().to_owned()).collect();
        Some(Combine::Lists(self.combine.iter().map(names).collect()))
    }
}
