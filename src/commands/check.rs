//! `check`: input files without a run.

use clap::Args;
use cvtcycle::config::setup::{self, Kind, Options};
use cvtcycle::config::{Problem, Problems, cycle, render};
use cvtcycle::study::Study;
use cvtcycle::study::fit::open;
use cvtcycle::study::plan::Plan;
use serde_json::{Value, json};

use super::Execute;
use crate::args::input_kind::InputKind;
use crate::args::{JsonArgs, relative_to};
use crate::print::{CommandOutput, CommandResult, Ending, Terminal, json_text};

/// Arguments of `check`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Example: cvtcycle check rover_216_cvt

Prints `ok` for every file without problems, and all problems of the others with place, value, allowed range and a hint; the exit
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
        Some(
            self.files
                .iter()
                .map(|file| (file.clone(), check(file)))
                .collect(),
        )
    }

    fn run(&self, checked: Self::Plan, terminal: Terminal) -> CommandResult {
        let ending = match checked.iter().all(|(_, result)| result.is_ok()) {
            true => Ending::Success,
            false => Ending::BadInput,
        };
        if self.output.json {
            let files: Vec<Value> = checked
                .iter()
                .map(|(file, result)| json_entry(file, result))
                .collect();
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
            stderr: render(
                &bad.flatten().cloned().collect::<Vec<_>>(),
                terminal.stderr.is_on(),
            ),
            ending,
        })
    }
}

fn check(file: &str) -> Checked {
    let (kind, word) = InputKind::detect(file, true)?;
    match kind {
        InputKind::Cycle => drop(cycle::find("FILE", &word)?),
        // Only embedded.
        InputKind::Rig => {}
        InputKind::Calibration => drop(open(&word, "FILE")?),
        InputKind::Study => drop(Study::prepare(Plan::open(&word, "FILE")?)?),
        InputKind::Lubricant => drop(setup::load_lubricant(&word, "FILE", &[], "")?),
        InputKind::Vehicle => {
            let setup = setup::load(&word, "FILE", &Options::default())?;
            // Only a run reads the baselines; an unknown name is reported here.
            let mut problems = Problems::default();
            for name in &setup.baselines {
                problems.take(setup::text_of(
                    &relative_to(&word, name),
                    Kind::Vehicle,
                    file,
                ));
            }
            problems.finish()?;
        }
    }
    Ok(kind)
}

fn json_entry(file: &str, result: &Checked) -> Value {
    let problem = |p: &Problem| {
        json!({
            "file": p.place.file, "line": p.place.line, "column": p.place.column, "key": p.key, "value": p.value,
            "allowed": p.allowed, "message": p.message, "hint": p.hint,
        })
    };
    let problems: Vec<Value> = result
        .as_ref()
        .err()
        .into_iter()
        .flatten()
        .map(problem)
        .collect();
    let kind = result.as_ref().ok().map(|kind| kind.word());
    json!({ "file": file, "ok": result.is_ok(), "kind": kind, "problems": problems })
}
