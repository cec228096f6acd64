//! `study export`: all rows as one file.

use std::path::PathBuf;

use cvtcycle::output::file::OutputFile;
use cvtcycle::study::export::{Format, export};
use cvtcycle::study::manifest::{RUNS, TRACES};
use cvtcycle::study::store;

use crate::print::{Answer, FAILED, Reply};

/// Arguments of `study export`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle study export my_study --out my_study.csv
  cvtcycle study export my_study --out my_study.xlsx
  cvtcycle study export ambient_study --table traces --out traces.parquet

Units stand in the header (CSV, Excel) or in the metadata (Parquet).")]
pub struct Args {
    /// Directory that was given to --out
    #[arg(value_name = "DIR")]
    dir: PathBuf,
    /// File to write; its ending says the format: .csv, .parquet or .xlsx
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Table to write
    #[arg(long, value_enum, value_name = "TABLE", default_value = "runs")]
    table: Table,
    /// Replace the file
    #[arg(long)]
    force: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    quiet: bool,
}

/// Tables of a study.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Table {
    /// A row a run
    Runs,
    /// A row a time step, where traces are kept
    Traces,
}

/// Runs the command.
pub fn answer(args: &Args) -> Reply {
    Ok(written(args)?)
}

fn written(args: &Args) -> Result<Answer, cvtcycle::config::Problem> {
    let format = Format::of(&args.out)?;
    let study = store::Study::open(&args.dir)?;
    let mut out = OutputFile::create(&args.out, args.force)?;
    let table = if args.table == Table::Runs {
        RUNS
    } else {
        TRACES
    };
    let exported = export(&study, table, format, &mut out)?;
    let path = out.commit()?;
    let whole = exported.status.is_complete();
    let stdout = if args.quiet {
        String::new()
    } else {
        format!("{} rows in {}\n", exported.rows, path.display())
    };
    let partial = format!(
        "cvtcycle: the study is not finished: {} of {} parts are in the file\n",
        exported.status.present, exported.status.expected
    );
    Ok(Answer {
        stdout,
        stderr: if whole { String::new() } else { partial },
        code: if whole { 0 } else { FAILED },
    })
}
