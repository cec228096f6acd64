//! Shares of a study: the parts that one process drives, and an estimate of the whole.

use std::ops::Range;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::output::number::fixed;
use cvtcycle::output::table::TextTable;
use cvtcycle::study::Study;
use cvtcycle::study::store::StudyDir;
use serde_json::json;

use crate::args::OutputArgs;
use crate::args::problems::bad_value;
use crate::print::{CommandResult, Results, WrittenFiles, json_text};

/// Selection of parts.
#[derive(Args, Clone, Debug)]
pub struct ShareArgs {
    /// Drive only share K of N of the parts, K from 0: one of N processes or machines
    #[arg(
        long,
        value_name = "K/N",
        requires = "out",
        conflicts_with = "parts",
        allow_hyphen_values = true
    )]
    shard: Option<String>,
    /// Drive only the parts from A up to, and without, B
    #[arg(
        long,
        value_name = "A..B",
        requires = "out",
        allow_hyphen_values = true
    )]
    parts: Option<String>,
    /// Drive a few points only, and print what the study takes: points, parts, bytes, time
    #[arg(long, conflicts_with_all = ["out", "shard", "parts"])]
    pub dry_run: bool,
}

/// Parses two numbers with a separator.
fn pair(text: &str, sign: &str) -> Option<(u64, u64)> {
    let (a, b) = text.split_once(sign)?;
    Some((a.trim().parse().ok()?, b.trim().parse().ok()?))
}

impl ShareArgs {
    /// True if some parts are left to other processes.
    pub fn is_given(&self) -> bool {
        self.shard.is_some() || self.parts.is_some()
    }

    /// Selected parts; all without an option.
    pub fn parts(&self, study: &Study, problems: &mut Problems) -> Range<u64> {
        let all = study.parts();
        if let Some(text) = &self.shard {
            match pair(text, "/") {
                Some((k, n)) if k < n => return study.shard(k, n),
                _ => {
                    let message = format!("`{text}` is no share");
                    let hint = "the first of a hundred is 0/100, the last one 99/100";
                    let allowed = "K/N with whole numbers, K from 0 to N - 1";
                    problems.add(bad_value("--shard", text, allowed, &message, hint));
                }
            }
        }
        if let Some(text) = &self.parts {
            match pair(text, "..") {
                Some((from, to)) if from < to && to <= all => return from..to,
                _ => {
                    let message = format!("`{text}` are no parts of this study");
                    let allowed = format!("A..B within 0..{all}");
                    let hint = "B is not driven itself; `--dry-run` prints the number of parts";
                    problems.add(bad_value("--parts", text, &allowed, &message, hint));
                }
            }
        }
        0..all
    }
}

/// Output of a process that drives a share of the study.
pub fn driven(study: &Study, dir: &StudyDir, output: &OutputArgs) -> CommandResult {
    let (parts, path) = (study.parts(), dir.path().display());
    let there = parts - dir.missing().len() as u64;
    let object = json!({ "parts_there": there, "parts": parts, "directory": path.to_string() });
    let results = Results::new(json_text(&object)?, Vec::new(), WrittenFiles::default());
    let text = format!(
        "{there} of {parts} parts are in {path}; `cvtcycle study merge WHOLE DIR...` puts all shards together\n"
    );
    Ok(results.output(output, || text))
}

/// Estimates time and size of a study.
pub fn estimate(study: &Study, output: &OutputArgs) -> CommandResult {
    let pilot = study.pilot();
    let (points, runs, parts) = (study.points, study.runs(), study.parts());
    let mut object = json!({
        "points": points, "cars": study.cars.len(), "runs": runs, "parts": parts,
        "points_per_part": study.points_per_part(),
    });
    let estimates = serde_json::to_value(pilot).unwrap_or_default();
    for (key, value) in estimates.as_object().into_iter().flatten() {
        object[key] = value.clone();
    }
    let results = Results::new(json_text(&object)?, Vec::new(), WrittenFiles::default());
    let table = || {
        let mut table = TextTable::new("lrl");
        table.row(["points", &points.to_string(), ""]);
        table.row(["runs", &runs.to_string(), ""]);
        table.row(["parts", &parts.to_string(), ""]);
        table.row(["size", &fixed(pilot.bytes as f64 / 1e6, 2), "MB, estimated"]);
        let basis = format!("s of one thread, from {} points", pilot.pilot_points);
        table.row(["time", &fixed(pilot.cpu_s, 1), &basis]);
        table.row([
            "time of a part",
            &fixed(pilot.cpu_s_per_part, 2),
            "s of one thread",
        ]);
        table.text()
    };
    Ok(results.output(output, table))
}
