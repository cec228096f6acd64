//! `rig transmission`: the tests of thesis chapters 4 and 5 on a CVT.

mod files;
mod json;
mod text;

use cvtcycle::config::rig::{OIL, PREFIX, TORQUE};
use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Bound, Problem, Problems, to_si};
use cvtcycle::model::bench::transmission::{
    self as rig, Conditions, Loop, Plan, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle::model::bench::{Bench, BenchAnswer, solvable_ratios};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::Flags;
use cvtcycle::output::files::OutputDir;

use crate::args::ranges::{values, values_or_words};
use crate::args::{self as inputs, Offering, bad_value};
use crate::commands::Context;
use crate::commands::run::{files::Written, formulations};
use crate::print::{Answer, FAILED, Reply, json_text};

/// Ratios that can be tested.
const RATIO: Bound = Bound::closed(0.3, 3.0);
/// Input speeds that can be tested, rpm.
const SPEED: Bound = Bound::closed(100.0, 8000.0);
/// Most that a transient's energy may miss of what was put in.
const ENERGY: f64 = 1e-9;

/// Arguments of `rig transmission`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle rig transmission
  cvtcycle rig transmission --test strip_down --out strip
  cvtcycle rig transmission --test steady --ratio low,1 --speed 1000..4000:500 --temp -10,25,95
  cvtcycle rig transmission --test transient --set rig.transient.start_degc=10 --json

Numbers, lists and ranges FROM..TO:STEP are taken for --ratio, --speed, --temp and --torque; without them the rig's own points are
tested. Transients run at rig.transient.speed_rpm; --speed, --temp and --torque do not concern them. `cvtcycle explain rig.pressure`
and the like explain what the rig is set to.")]
pub struct Args {
    /// Which test: all, steady, loaded, strip_down, transient or second_box
    #[arg(long, value_name = "TEST", default_value = "all", value_parser = Offering(tests), hide_possible_values = true)]
    test: String,
    /// Vehicle whose transmission is on the rig; it must be a CVT
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Belt ratios, 0.3 to 3, `low` and `high` being those of the rig [default: low,high]
    #[arg(long, value_name = "VALUES")]
    ratio: Option<String>,
    /// Input speeds, rpm, 100 to 8000 [default: 1000..4000:250 in low, 1750..4000:250 in high]
    #[arg(long, value_name = "VALUES")]
    speed: Option<String>,
    /// Temperatures of the bulk oil, degC, -30 to 120 [default: 25,50,75,95]
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    temp: Option<String>,
    /// Torques at the output shaft in the loaded test, Nm, -100 to 1000 [default: 0,25,50,75,100]
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    torque: Option<String>,
    /// Transmission oil in place of the vehicle's own
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Reading of the belt model: smooth, appendix_c or chapter_8
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Offering(formulations), hide_possible_values = true)]
    formulation: String,
    /// Override one value; repeatable. `rig.KEY` reaches the rig, `lubricant.KEY` the oil, any other the vehicle
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print one JSON object instead of tables
    #[arg(long)]
    json: bool,
    /// Write summary.json, tables (CSV) and plots (SVG) into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

/// Which tests are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Test {
    All,
    Steady,
    Loaded,
    StripDown,
    Transient,
    SecondBox,
}

const TESTS: [(&str, Test); 6] = [
    ("all", Test::All),
    ("steady", Test::Steady),
    ("loaded", Test::Loaded),
    ("strip_down", Test::StripDown),
    ("transient", Test::Transient),
    ("second_box", Test::SecondBox),
];

fn tests() -> Vec<&'static str> {
    TESTS.iter().map(|(name, _)| *name).collect()
}

/// Everything that the tests need, checked.
struct Job {
    test: Test,
    setup: Setup,
    conditions: Conditions,
    plan: Plan,
    formulation: String,
    set: Vec<String>,
    out: Option<OutputDir>,
}

/// What the tests found; empty where a test was not asked for.
#[derive(Debug, Default)]
struct Found {
    steady: Vec<SteadyPoint>,
    loaded: Vec<SteadyPoint>,
    strip_down: Vec<StripDown>,
    loops: Vec<Loop>,
    second_box: Vec<TwoBoxes>,
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let mut job = job(args)?;
    let found = run(&job);
    let failed = failures(&job, &found);
    let json = json_text(&json::summary(&job, &found, &failed))?;
    let written = match job.out.take() {
        Some(dir) => files::write(dir, &json, &job, &found)?,
        None => Written::default(),
    };
    let code = if failed.is_empty() { 0 } else { FAILED };
    let told: String = failed
        .iter()
        .map(|line| format!("cvtcycle: {line}\n"))
        .collect();
    if args.json || args.quiet {
        let stdout = if args.json { json } else { String::new() };
        return Ok(Answer {
            stdout,
            stderr: told + &written.left_over_text(),
            code,
        });
    }
    let checks: String = failed
        .iter()
        .map(|line| context.paint.bad(line) + "\n")
        .collect();
    let stdout = text::tables(&job, &found, context.paint) + &checks + &written.text();
    Ok(Answer {
        stdout,
        stderr: written.left_over_text(),
        code,
    })
}

fn run(job: &Job) -> Found {
    let bench = Bench::new(&job.setup);
    let (c, plan) = (&job.conditions, &job.plan);
    let wanted = |test: Test| job.test == Test::All || job.test == test;
    let mut found = Found::default();
    if wanted(Test::Steady) {
        found.steady = rig::steady(&bench, c, plan);
    }
    if wanted(Test::Loaded) {
        found.loaded = rig::loaded(&bench, c, plan);
    }
    if wanted(Test::StripDown) {
        found.strip_down = rig::strip_down(&bench, c, plan);
    }
    if wanted(Test::Transient) {
        found.loops = plan
            .ratios
            .iter()
            .map(|ratio| rig::transient(&bench, c, *ratio))
            .collect();
    }
    if wanted(Test::SecondBox) {
        found.second_box = rig::second_box(&bench, c, plan);
    }
    found
}

fn job(args: &Args) -> Result<Job, Problems> {
    let mut problems = Problems::default();
    let test = problems.take(inputs::word("--test", &args.test, &TESTS));
    let formulation = problems.take(inputs::word(
        "--formulation",
        &args.formulation,
        &Formulation::NAMES,
    ));
    let (of_rig, of_vehicle): (Vec<String>, Vec<String>) = args
        .set
        .iter()
        .cloned()
        .partition(|set| set.starts_with(PREFIX));
    let options = Options {
        lubricant: args.lubricant.clone(),
        set: of_vehicle,
        formulation: formulation.unwrap_or_default(),
        ..Options::default()
    };
    let setup = problems.take(setup::load(&args.vehicle, "--vehicle", &options));
    if setup
        .as_ref()
        .is_some_and(|setup| !setup.transmission().is_cvt())
    {
        problems.add(manual(&args.vehicle));
    }
    let conditions = problems
        .take(cvtcycle::config::rig::load(&of_rig))
        .map(|(conditions, _)| conditions);
    let plan = plan(args, conditions.as_ref(), &mut problems);
    if let (Some(setup), Some(plan)) = (&setup, &plan) {
        beyond_the_belt(setup, plan, &mut problems);
    }
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    problems.finish()?;
    match (test, setup, conditions, plan) {
        (Some(test), Some(setup), Some(conditions), Some(plan)) => Ok(Job {
            test,
            setup,
            conditions,
            plan,
            formulation: args.formulation.clone(),
            set: args.set.clone(),
            out,
        }),
        _ => unreachable!("what is missing has left a problem"),
    }
}

fn manual(vehicle: &str) -> Problem {
    let hint = format!("`cvtcycle losses --vehicle {vehicle}` shows the losses of a manual box");
    bad_value(
        "--vehicle",
        vehicle,
        "a vehicle with a CVT",
        format!("`{vehicle}` has a manual box"),
        hint,
    )
}

/// Ratios that a belt of this length cannot run at.
fn beyond_the_belt(setup: &Setup, plan: &Plan, problems: &mut Problems) {
    let Transmission::Cvt(cvt) = setup.transmission() else {
        return;
    };
    let (low, high) = solvable_ratios(&cvt.belt);
    for ratio in plan
        .ratios
        .iter()
        .filter(|ratio| !(low..=high).contains(*ratio))
    {
        let hint =
            "check the belt's length and the centre distance, or choose other ratios with --ratio"
                .to_owned();
        let message = format!("the belt does not fit around the pulleys at ratio {ratio}");
        problems.add(bad_value(
            "--ratio",
            &ratio.to_string(),
            &format!("{low} to {high} with this belt"),
            message,
            hint,
        ));
    }
}

/// The rig's points with those of the options; none where the rig's own could not be read.
fn plan(args: &Args, conditions: Option<&Conditions>, problems: &mut Problems) -> Option<Plan> {
    let mut list = |option: &str, text: &Option<String>, bound: Bound, suffix: &str| {
        let read = text
            .as_ref()
            .map(|text| values(option, text, bound, suffix));
        read.and_then(|read| problems.take(read)).map(|list| {
            list.into_iter()
                .map(|x| to_si(suffix, x))
                .collect::<Vec<f64>>()
        })
    };
    let speeds_rad_s = list("--speed", &args.speed, SPEED, "_rpm");
    let oil_k = list("--temp", &args.temp, OIL, "_degc");
    let torques_nm = list("--torque", &args.torque, TORQUE, "_nm");
    let words: Vec<(&str, f64)> = conditions
        .iter()
        .flat_map(|c| [("low", c.low_ratio), ("high", c.high_ratio)])
        .collect();
    let ratios = args
        .ratio
        .as_ref()
        .map(|text| values_or_words("--ratio", text, RATIO, "", &words));
    // With bad conditions the words mean nothing, and that has been told.
    let ratios = ratios
        .filter(|_| conditions.is_some())
        .and_then(|read| problems.take(read));
    let own = Plan::of(conditions?);
    Some(Plan {
        ratios: ratios.unwrap_or(own.ratios),
        speeds_rad_s,
        oil_k: oil_k.unwrap_or(own.oil_k),
        torques_nm: torques_nm.unwrap_or(own.torques_nm),
    })
}

impl Found {
    /// Every operating point that was solved.
    fn answers(&self) -> impl Iterator<Item = &BenchAnswer> {
        let steady = self.steady.iter().chain(&self.loaded).map(|p| &p.answer);
        let boxes = self
            .second_box
            .iter()
            .flat_map(|t| [&t.first.answer, &t.second.answer]);
        let stages = self.strip_down.iter().flat_map(|s| &s.stages);
        let moments = self
            .loops
            .iter()
            .flat_map(|l| &l.moments)
            .map(|m| &m.answer);
        steady.chain(boxes).chain(stages).chain(moments)
    }

    /// Points with a flag.
    fn flagged(&self, flag: Flags) -> usize {
        self.answers().filter(|a| a.flags.contains(flag)).count()
    }
}

/// One line for every check that failed.
fn failures(job: &Job, found: &Found) -> Vec<String> {
    let mut failed = Vec::new();
    let unsolved = found.flagged(Flags::NOT_CONVERGED);
    if unsolved > 0 {
        failed.push(format!(
            "check failed: {unsolved} operating points without a solution"
        ));
    }
    for l in &found.loops {
        let name = job.conditions.ratio_name(l.ratio);
        if !l.complete {
            let (start, end) = (
                job.conditions.transient.start_k - ZERO_DEGC_K,
                job.conditions.transient.end_k - ZERO_DEGC_K,
            );
            failed
                .push(format!("check failed: the transient at {name} comes to rest on its way from {start:.0} to {end:.0} degC and back"));
        }
        let balanced = l.energy.error().abs() <= ENERGY;
        if !balanced {
            failed.push(format!(
                "check failed: heat of the transient at {name} does not balance: {:.0e} of it",
                l.energy.error()
            ));
        }
    }
    failed
}
