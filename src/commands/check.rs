//! `check`: input files without a run.

use clap::Args;
use cvtcycle::config::setup::{self, Kind, NamedBy, Options};
use cvtcycle::config::{Problem, Problems, cycle, render};
use cvtcycle::study::Study;
use cvtcycle::study::fit::open;
use cvtcycle::study::plan::Plan;
use serde_json::{Value, json};

use super::Execute;
use crate::args::input_kind::InputKind;
use crate::args::problems::{cite, in_options};
use crate::args::{JsonArgs, relative_to};
use crate::print::{CommandOutput, CommandResult, Ending, Terminal, json_text};

/// Arguments of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Example: cvtcycle check rover_216_cvt

Prints `ok` for every file without problems, and all problems of the others with place, value, allowed range and a hint; the exit \
code is then 2.")]
pub struct CheckArgs {
    /// Vehicle, lubricant, calibration or study (TOML), or cycle (CSV); detected from the contents of the file
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    #[command(flatten)]
    output: JsonArgs,
}

type Checked = Result<InputKind, Problems>;

impl Execute for CheckArgs {
    type Plan = Vec<(String, Checked)>;

    fn plan(&self, _: &mut Problems) -> Option<Self::Plan> {
        let files = self.files.iter();
        Some(files.map(|file| (file.clone(), check(file))).collect())
    }

    fn run(&self, checked: Self::Plan, terminal: Terminal) -> CommandResult {
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
                .map(|(file, kind)| format!("ok  {file} ({})\n", kind.word()))
                .collect(),
            problems: render(
                &bad.flatten().cloned().collect::<Vec<_>>(),
                terminal.stderr.is_on(),
            ),
            ending,
            ..CommandOutput::default()
        })
    }
}

fn check(file: &str) -> Checked {
    let (kind, word) = InputKind::detect(file, true)?;
    match kind {
        InputKind::Cycle => cycle::find(&word).map(drop),
        // Only embedded.
        InputKind::Rig => Ok(()),
        InputKind::Calibration => open(&word).map(drop),
        InputKind::Study => Plan::open(&word).and_then(Study::prepare).map(drop),
        InputKind::Lubricant => setup::load_lubricant(&word).map(drop),
        InputKind::Vehicle => check_vehicle(file, &word),
    }
    .map_err(|found| cite("FILE", found).map(in_options))?;
    Ok(kind)
}

/// Only a run reads the baselines; an unknown name is reported here.
fn check_vehicle(file: &str, word: &str) -> Result<(), Problems> {
    let setup = setup::load(word, &Options::default())?;
    let mut problems = Problems::default();
    for name in &setup.baselines {
        let read = setup::text_of(&relative_to(word, name), Kind::Vehicle, NamedBy::File);
        problems.take(read.map_err(|found| cite(file, found)));
    }
    problems.finish()
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
    let kind = result.as_ref().ok().map(|kind| kind.word());
    json!({ "file": file, "ok": result.is_ok(), "kind": kind, "problems": problems })
}
