//! `check`: input files without a run; with `--physics` vehicles, by laws that do not share the code they check.

mod physics;

use clap::Args;
use cvtcycle::analysis::levers::LeverFile;
use cvtcycle::calibrate::open;
use cvtcycle::config::csv::Columns;
use cvtcycle::config::procedure::Procedure;
use cvtcycle::config::setup::{self, NamedBy, Options};
use cvtcycle::config::{Problem, Problems, bounded, cycle};
use cvtcycle::output::summary::{differences, likeness};
use cvtcycle::output::table::wrapped;
use cvtcycle::study::Study;
use cvtcycle::study::plan::Plan;
use serde_json::{Value, json};

use super::Execute;
use crate::args::input_kind::InputKind;
use crate::args::problems::{bad_value, cite, cite_options};
use crate::args::{ColumnsArgs, JsonArgs, Names, bytes, cycles};
use crate::print::{CommandOutput, CommandResult, Ending, Terminal, json_text, problems_text};
use physics::PhysicsPlan;

/// Arguments of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle check rover_216_cvt
  cvtcycle check --physics rover_216_cvt --cycle ece15 --ambient -10

Prints `ok` for every file without problems, and all problems of the others with place, value, allowed range and a hint; the exit \
code is then 2. With --physics every vehicle is driven after a soak, and each law has a line: the step in which most of its bound is \
used, by how much, and whether it holds; the exit code is 1 if one fails.")]
pub struct CheckArgs {
    /// Vehicle, lubricant, calibration, study or levers (TOML), or cycle (CSV); detected from the contents of the file
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Drive each vehicle, and check torques, forces, power and heat of every step by statics and energy, apart from the model
    #[arg(long)]
    physics: bool,
    /// Cycle of --physics: a name, constant_V (V in km/h, 600 s), or a CSV file
    #[arg(long, value_name = "NAME|FILE.csv", default_value = "ece15_eudc", requires = "physics", value_parser = Names(cycles), hide_possible_values = true)]
    cycle: String,
    /// Ambient temperature of --physics, degC, -40 to 60
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "25",
        requires = "physics",
        allow_hyphen_values = true
    )]
    ambient: String,
    #[command(flatten)]
    columns: ColumnsArgs,
    #[command(flatten)]
    output: JsonArgs,
}

/// Kind of a file and notes for its reader, or its problems.
type Checked = Result<(InputKind, Vec<String>), Problems>;

impl Execute for CheckArgs {
    type Plan = CheckPlan;

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        if self.physics {
            let drive = (&*self.cycle, &*self.ambient);
            return physics::plan(&self.files, drive, problems)
                .map(|plan| CheckPlan::Physics(Box::new(plan)));
        }
        let columns = self.columns.get(problems);
        let files = self
            .files
            .iter()
            .map(|file| (file.clone(), check(file, &columns)));
        Some(CheckPlan::Files(files.collect()))
    }

    fn run(&self, plan: Self::Plan, terminal: Terminal) -> CommandResult {
        match plan {
            CheckPlan::Files(checked) => self.files(&checked, terminal),
            CheckPlan::Physics(plan) => physics::run(&plan, self.output, terminal),
        }
    }
}

/// Checked input of `check`.
pub enum CheckPlan {
    Files(Vec<(String, Checked)>),
    Physics(Box<PhysicsPlan>),
}

impl CheckArgs {
    fn files(&self, checked: &[(String, Checked)], terminal: Terminal) -> CommandResult {
        let ending = match checked.iter().all(|(_, result)| result.is_ok()) {
            true => Ending::Success,
            false => Ending::BadInput,
        };
        if self.output.json {
            let files = checked
                .iter()
                .map(|(file, result)| json_entry(file, result));
            let files: Vec<Value> = files.collect();
            return Ok(CommandOutput {
                stdout: json_text(&json!({ "files": files }))?,
                ending,
                ..CommandOutput::default()
            });
        }
        let ok = checked
            .iter()
            .filter_map(|(file, result)| Some((file, result.as_ref().ok()?)));
        let bad = checked
            .iter()
            .filter_map(|(_, result)| result.as_ref().err());
        Ok(CommandOutput {
            stdout: ok
                .map(|(file, (kind, notes))| {
                    let notes = notes.iter().map(|note| wrapped(note, "    "));
                    format!("ok  {file} ({})\n", kind.word()) + &notes.collect::<String>()
                })
                .collect(),
            problems: problems_text(
                &bad.flatten().cloned().collect::<Vec<_>>(),
                terminal.stderr.is_on(),
            ),
            ending,
            ..CommandOutput::default()
        })
    }
}

fn check(file: &str, columns: &Columns) -> Checked {
    let (kind, word) = InputKind::detect(file, true)?;
    let none = |()| Vec::new();
    let notes = match kind {
        InputKind::Cycle => match cycle::open(&word, columns) {
            Ok(cycle) => {
                let read_as = cycle.read_as.map(|words| format!("read as: {words}"));
                let recording = cycle.recording.unwrap_or_default();
                let repairs = recording
                    .repairs
                    .iter()
                    .map(|repair| format!("{}: {}", repair.name, repair.what));
                let doubts = recording
                    .doubts
                    .iter()
                    .map(|doubt| format!("doubt: {doubt}"));
                Ok(read_as.into_iter().chain(repairs).chain(doubts).collect())
            }
            Err(found) => Err(map_problem(&word).map_or(found, Into::into)),
        },
        // Classes and rigs are embedded and have no files.
        InputKind::Class | InputKind::Rig => Ok(Vec::new()),
        InputKind::Calibration => open(&word).map(drop).map(none),
        InputKind::Levers => LeverFile::open(&word).map(drop).map(none),
        InputKind::Test => Procedure::open(&word).map(drop).map(none),
        InputKind::Study => Plan::open(&word)
            .and_then(Study::prepare)
            .map(drop)
            .map(none),
        InputKind::Lubricant => setup::load_lubricant(&word).map(drop).map(none),
        InputKind::Vehicle => check_vehicle(file, &word),
    }
    .map_err(|found| cite("FILE", found).map(cite_options))?;
    Ok((kind, notes))
}

/// Columns found in measured maps of a vehicle and nowhere else.
const MAP_COLUMNS: [&str; 2] = ["torque_loss_nm", "bsfc_g_kwh"];

/// Problem of a table that is a map of a vehicle instead of a cycle.
fn map_problem(word: &str) -> Option<Problem> {
    let bytes = bytes("FILE", word, bounded::TABLE).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let head = text
        .lines()
        .find(|line| !line.trim_start().starts_with('#'))?;
    let is_map = MAP_COLUMNS.iter().any(|column| head.contains(column));
    let hint = "check the vehicle file that names it: its maps are read with it";
    is_map.then(|| {
        bad_value(
            "FILE",
            word,
            "a cycle",
            "this is a measured map of a vehicle",
            hint,
        )
    })
}

/// Reads the baselines as well, which otherwise only a run does. Their problems are reported, and differences that spoil the comparison give a note.
fn check_vehicle(file: &str, word: &str) -> Result<Vec<String>, Problems> {
    let setup = setup::load(word, &Options::default())?;
    let mut problems = Problems::default();
    let doubts = setup.doubts().into_iter();
    let mut notes: Vec<String> = doubts.map(|doubt| format!("doubt: {doubt}")).collect();
    let options = Options {
        named_by: NamedBy::File,
        ..Options::default()
    };
    for name in &setup.baselines {
        let baseline = setup::load(&setup::baseline_of(word, name), &options);
        let baseline = problems.take(baseline.map_err(|found| cite(file, found)));
        let Some(baseline) = baseline else { continue };
        let unlike = differences(&setup, &baseline);
        if !unlike.is_empty() {
            let why = likeness(&setup, &baseline, &unlike);
            notes.push(format!("doubt: baseline {name} is {why}"));
        }
    }
    notes.extend(setup.notes);
    problems.finish().map(|()| notes)
}

fn json_entry(file: &str, result: &Checked) -> Value {
    let problem = |p: &Problem| {
        json!({
            "file": p.place.input.to_string(), "line": p.place.line, "column": p.place.column, "key": p.key, "value": p.value,
            "allowed": p.allowed, "message": p.message, "hint": p.hint,
        })
    };
    let found = result.as_ref().err().into_iter().flatten();
    let problems: Vec<Value> = found.map(problem).collect();
    let (kind, notes) = result
        .as_ref()
        .ok()
        .map(|(kind, notes)| (kind.word(), notes))
        .unzip();
    let notes = notes.map_or(&[][..], Vec::as_slice);
    json!({ "file": file, "ok": result.is_ok(), "kind": kind, "problems": problems, "notes": notes })
}
