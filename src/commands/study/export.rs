//! `study export`: all rows as one file.

use std::path::PathBuf;

use clap::Args;
use cvtcycle::output::file::OutputFile;
use cvtcycle::study::execute::manifest::{RUNS, TRACES};
use cvtcycle::study::store::Study;
use cvtcycle::study::store::{Format, export};

use crate::args::{OutArgs, OutputArgs};
use crate::commands::Execute;
use crate::print::{CommandResult, Results, Terminal, json_text};
use cvtcycle::config::Problems;

/// Arguments of `study export`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.required(true).value_name("FILE").help("File to write; its extension gives the format: .csv or .parquet")),
    after_help = "\
Examples:
  cvtcycle study export my_study --out my_study.csv
  cvtcycle study export my_study --out my_study.parquet
  cvtcycle study export ambient_study --table traces --out traces.parquet

Units are in the header (CSV) or in the metadata (Parquet)."
)]
pub struct StudyExportArgs {
    /// Directory written by `study --out`
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    #[command(flatten)]
    out: OutArgs,
    /// Table to write
    #[arg(long, value_enum, value_name = "TABLE", default_value = "runs")]
    table: ExportedTable,
    #[command(flatten)]
    output: OutputArgs,
}

/// Tables of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ExportedTable {
    /// A row for each run
    Runs,
    /// A row for each time step, if traces are kept
    Traces,
}

impl Execute for StudyExportArgs {
    type Plan = (Format, Study, OutputFile);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        let path = self.out.path(problems)?;
        let format = problems.take(Format::of(path));
        let study = problems.take(Study::open(&self.dir));
        // Without a valid format, other problems of the file name are not reported.
        let format = format?;
        let out = problems.take(OutputFile::create(path, self.out.force));
        Some((format, study?, out?))
    }

    fn run(&self, (format, study, mut out): Self::Plan, _: Terminal) -> CommandResult {
        let table = match self.table {
            ExportedTable::Runs => RUNS,
            ExportedTable::Traces => TRACES,
        };
        let exported = export(&study, table, format, &mut out)?;
        let path = out.commit()?.display().to_string();
        let (rows, status) = (exported.rows, &exported.status);
        let (present, expected) = (status.present, status.expected);
        let partial = (!status.is_complete()).then(|| {
            format!("the study is not finished: {present} of {expected} parts are in the file")
        });
        let results = Results {
            json: json_text(&serde_json::json!({ "rows": rows, "file": path }))?,
            failures: partial.into_iter().collect(),
            ..Results::default()
        };
        Ok(results.output(&self.output, || format!("{rows} rows in {path}\n")))
    }
}
