//! `check`: inputs without a run.

use cvtcycle::config::setup::{self, Kind, Options};
use cvtcycle::config::{Problem, Problems, render};
use cvtcycle::study::Study;
use cvtcycle::study::fit::open;
use cvtcycle::study::plan::Plan;

use super::Context;
use crate::args as inputs;
use crate::args::sniff::{Sort, sort_of};
use crate::print::{Answer, BAD_INPUT, Reply, json_text};

/// Arguments of `check`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Example: cvtcycle check rover_216_cvt

Prints `ok` for every file without problems, and all problems of the others with place, value, allowed range and a hint;
then the exit code is 2.")]
pub struct Args {
    /// Vehicle, lubricant, calibration or study (TOML), or cycle (CSV) files; what a file is shows in its contents
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let checked: Vec<(&String, Result<Sort, Problems>)> =
        args.files.iter().map(|file| (file, check(file))).collect();
    let code = if checked.iter().all(|(_, result)| result.is_ok()) {
        0
    } else {
        BAD_INPUT
    };
    if args.json {
        let files: Vec<serde_json::Value> = checked
            .iter()
            .map(|(file, result)| json(file, result))
            .collect();
        return Ok(Answer {
            stdout: json_text(&serde_json::json!({ "files": files }))?,
            code,
            ..Answer::default()
        });
    }
    let ok = checked
        .iter()
        .filter_map(|(file, result)| result.as_ref().ok().map(|sort| (file, sort)));
    let stdout = ok
        .map(|(file, sort)| format!("ok  {file} ({})\n", sort.word()))
        .collect();
    let problems: Problems = checked
        .iter()
        .filter_map(|(_, result)| result.as_ref().err())
        .flatten()
        .cloned()
        .collect();
    Ok(Answer {
        stdout,
        stderr: render(&problems, context.colour.stderr().is_on()),
        code,
    })
}

fn check(file: &str) -> Result<Sort, Problems> {
    let (sort, word) = sort_of(file, true)?;
    match sort {
        Sort::Cycle => drop(inputs::cycle("FILE", &word)?),
        // Only embedded, and read by `rig`.
        Sort::Rig => {}
        Sort::Calibration => drop(open(&word, "FILE")?),
        Sort::Study => drop(Study::prepare(Plan::open(&word, "FILE")?)?),
        Sort::Lubricant => drop(setup::load_lubricant(&word, "FILE", &[], "")?),
        Sort::Vehicle => {
            let setup = setup::load(&word, "FILE", &Options::default())?;
            // Only a run reads the baselines; a name that leads nowhere should show now.
            let texts = setup.baselines.iter().map(|name| {
                setup::text_of(&inputs::beside(&word, name), Kind::Vehicle, file).map(drop)
            });
            let bad: Problems = texts.filter_map(Result::err).flatten().collect();
            if !bad.is_empty() {
                return Err(bad);
            }
        }
    }
    Ok(sort)
}

fn json(file: &str, result: &Result<Sort, Problems>) -> serde_json::Value {
    let problem = |p: &Problem| {
        serde_json::json!({
            "file": p.place.file, "line": p.place.line, "column": p.place.column, "key": p.key, "value": p.value,
            "allowed": p.allowed, "message": p.message, "hint": p.hint,
        })
    };
    let (kind, problems) = match result {
        Ok(sort) => (Some(sort.word()), Vec::new()),
        Err(problems) => (None, problems.iter().map(problem).collect()),
    };
    serde_json::json!({ "file": file, "ok": result.is_ok(), "kind": kind, "problems": problems })
}
