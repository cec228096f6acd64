//! `study merge`: merges the shards of a study.

use std::path::PathBuf;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::report::results::StudyResults;
use cvtcycle::study::StudyManifest;
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::store::{self, StudyDir};

use super::execution::StudyOutput;
use super::levers::LeverResults;
use super::tables::written;
use crate::args::{ConfidenceArgs, OutputArgs};
use crate::commands::{Execute, threads};
use crate::print::{CommandResult, Terminal};

/// Arguments of `study merge`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle study my_plan.toml --out s_0 --shard 0/2
  cvtcycle study my_plan.toml --out s_1 --shard 1/2
  cvtcycle study merge my_study s_0 s_1

The merged study is byte for byte that of one machine. docs/clusters.md has scripts for Slurm, HTCondor, Kubernetes and Snakemake.")]
pub struct StudyMergeArgs {
    /// Directory of the merged study
    #[arg(value_name = "WHOLE")]
    whole: PathBuf,
    /// Directories written by `study --out` with --shard or --parts
    #[arg(value_name = "DIR", required = true)]
    shards: Vec<PathBuf>,
    /// Replace the results of an earlier study there
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    output: OutputArgs,
}

impl Execute for StudyMergeArgs {
    type Plan = Confidence;

    fn plan(&self, problems: &mut Problems) -> Option<Confidence> {
        problems.take(threads::begin(None));
        Some(self.confidence.get(problems))
    }

    fn run(&self, confidence: Confidence, terminal: Terminal) -> CommandResult {
        let dir = StudyDir::merge(&self.whole, &self.shards, self.force)?;
        let (outline, store) = StudyResults::stored(&self.whole)?;
        match outline.levers {
            Some(_) => self.finish::<LeverResults>(&dir, (outline, store, confidence), terminal),
            None => self.finish::<StudyResults>(&dir, (outline, store, confidence), terminal),
        }
    }
}

impl StudyMergeArgs {
    fn finish<S: StudyOutput>(
        &self,
        dir: &StudyDir,
        (outline, store, confidence): (StudyManifest, store::Study, Confidence),
        terminal: Terminal,
    ) -> CommandResult {
        let found = S::evaluate(outline, store, confidence)?;
        let list = written(dir.path(), &dir.finish(&found.files()?)?);
        let tables = || found.tables(terminal.stdout) + &list;
        Ok(found.results()?.output(&self.output, tables))
    }
}
