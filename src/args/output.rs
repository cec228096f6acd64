//! Options for the place and the form of results.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use cvtcycle::config::Problems;
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::files::OutputDir;

use super::problems::{bad_value, cite_options, problem};

/// Output directory or file.
#[derive(Args, Clone, Debug)]
pub struct OutArgs {
    /// Write the results as files into this directory
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Replace the results of an earlier run there
    #[arg(long)]
    pub force: bool,
}

impl OutArgs {
    /// Creates the output directory, if the option is given.
    pub fn dir(&self, problems: &mut Problems) -> Option<OutputDir> {
        let path = self.path(problems)?;
        problems.take(OutputDir::create(path, self.force))
    }

    /// Begins the single output file of a command, with a fixed extension. The default name is None where it follows from bad input.
    pub fn file(
        &self,
        usual: Option<PathBuf>,
        ending: &str,
        problems: &mut Problems,
    ) -> Option<OutputFile> {
        let path = self.out.clone().or(usual)?;
        let own = path.extension().unwrap_or_default();
        if !path.is_dir() && !own.eq_ignore_ascii_case(ending) {
            let (value, allowed) = (path.display().to_string(), format!("a name in .{ending}"));
            let message = "the file has another ending than what is written";
            let hint = format!("for example {}", path.with_extension(ending).display());
            problems.add(bad_value("--out", &value, &allowed, message, &hint));
            return None;
        }
        problems.take(OutputFile::create(path, self.force).map_err(cite_options))
    }

    /// Output path, if the option is given.
    pub fn path(&self, problems: &mut Problems) -> Option<&Path> {
        if self.force && self.out.is_none() {
            let message = "there is no --out whose files could be replaced";
            problems.add(problem("--force", message, "add --out"));
        }
        self.out.as_deref()
    }
}

/// Form of the result on standard output, for commands without a quiet form.
#[derive(Args, Clone, Copy, Debug)]
pub struct JsonArgs {
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

/// Form of the result on standard output.
#[derive(Args, Clone, Copy, Debug)]
pub struct OutputArgs {
    #[command(flatten)]
    json: JsonArgs,
    /// Print problems only, no tables and no progress
    #[arg(long, short)]
    pub quiet: bool,
}

impl OutputArgs {
    /// Problems only.
    pub fn silent() -> OutputArgs {
        OutputArgs {
            json: JsonArgs { json: false },
            quiet: true,
        }
    }

    /// True if a JSON object is printed.
    pub fn json(&self) -> bool {
        self.json.json
    }
}

/// Place and form of the results of a command.
#[derive(Args, Clone, Debug)]
pub struct ResultArgs {
    #[command(flatten)]
    pub out: OutArgs,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Form of a table of points on standard output.
#[derive(Args, Clone, Copy, Debug)]
pub struct TableOutputArgs {
    /// Print a table for people, or CSV with all columns
    #[arg(
        long,
        value_enum,
        value_name = "FORMAT",
        default_value = "table",
        conflicts_with = "json"
    )]
    format: TableFormat,
    #[command(flatten)]
    pub output: OutputArgs,
}

/// Forms of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum TableFormat {
    /// A table for people
    Table,
    /// All columns as CSV
    Csv,
}

impl TableOutputArgs {
    /// True if JSON or CSV is printed row by row.
    pub fn is_streamed(&self) -> bool {
        self.output.json() || self.format == TableFormat::Csv
    }
}
