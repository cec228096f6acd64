//! Execution of a study: threads, directory, progress, results.

use std::collections::BTreeSet;
use std::path::Path;

use clap::Args;
use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::results::StudyResults;
use cvtcycle::report::study_pictures::study_files;
use cvtcycle::study::execute::DirWriter;
use cvtcycle::study::plan::Plan;
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::store::{self, StudyDir};
use cvtcycle::study::{End, Study, StudyManifest};
use tempfile::TempDir;

use super::super::threads;
use super::share::{self, ShareArgs};
use super::tables;
use crate::args::problems::{bad_value, cite_options, problem};
use crate::args::{ConfidenceArgs, OutArgs, OutputArgs, ThreadArgs};
use crate::print::colour::Paint;
use crate::print::progress::{Progress, handle_interrupts};
use crate::print::{
    CommandOutput, CommandResult, Ending, Results, Terminal, WrittenFiles, json_text,
};

/// Options of all studies that run.
#[derive(Args, Clone, Debug)]
#[command(mut_arg("out", |out| out.help("Keep tables, statistics and plots in this directory; without it they are deleted after the results are printed")))]
pub struct StudyRunArgs {
    #[command(flatten)]
    pub out: OutArgs,
    /// Continue the interrupted study in the --out directory; finished parts are not run again
    #[arg(long, requires = "out", conflicts_with = "force")]
    resume: bool,
    /// Format of the tables in the --out directory
    #[arg(
        long,
        value_enum,
        value_name = "FORMAT",
        default_value = "parquet",
        requires = "out"
    )]
    format: PartFormat,
    #[command(flatten)]
    share: ShareArgs,
    #[command(flatten)]
    confidence: ConfidenceArgs,
    #[command(flatten)]
    threads: ThreadArgs,
    /// Run a study of more runs than `most_runs` of the plan
    #[arg(long)]
    yes: bool,
    #[command(flatten)]
    output: OutputArgs,
}

/// Format of the tables of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum PartFormat {
    /// Parquet
    Parquet,
    /// Parquet and CSV
    Both,
}

impl StudyRunArgs {
    /// Checks the options that do not depend on the plan, and starts the threads.
    pub fn begin(&self, problems: &mut Problems) {
        handle_interrupts();
        self.out.path(problems);
        self.confidence.get(problems);
        let threads = self.threads.given(problems);
        problems.take(threads::begin(threads));
    }

    /// Checks the directory even after other problems, so that all are reported at once.
    pub fn check_directory(&self, problems: &mut Problems) {
        let begins = !self.resume && !self.share.dry_run && !problems.is_empty();
        if let Some(path) = self.out.out.as_deref().filter(|_| begins) {
            let found = StudyDir::check_free(path, self.out.force);
            problems.take(found.map_err(cite_options));
        }
    }

    /// Reads the vehicles of a plan, and checks the number of runs.
    pub fn prepare(&self, plan: Plan, problems: &mut Problems) -> Option<Study> {
        self.check_run_count(problems.take(Study::prepare(plan))?, problems)
    }

    /// Checks the number of runs of a study.
    pub fn check_run_count(&self, study: Study, problems: &mut Problems) -> Option<Study> {
        self.share.parts(&study, problems);
        let (runs, max) = (study.runs(), study.plan.most_runs);
        if runs > max && !self.yes && !self.share.dry_run {
            let (points, cars) = (study.points, study.cars.len());
            let message = format!(
                "the study has {runs} runs ({points} points, {cars} vehicles), more than {max}"
            );
            let hint =
                "run it with --yes, give fewer values or samples, or raise `most_runs` in the plan";
            let allowed = format!("at most {max} runs without --yes");
            problems.add(bad_value(&study.plan.file, "", &allowed, &message, hint));
        }
        Some(study)
    }

    /// Runs a study, writes its files and returns the text to print.
    pub fn run<S: StudyOutput>(&self, study: &Study, terminal: Terminal) -> CommandResult {
        let results = self.results::<S>(study, terminal);
        results.map_err(|problems| match self.out.out {
            Some(_) => problems,
            None => problems.map(without_resume_hint),
        })
    }

    fn results<S: StudyOutput>(&self, study: &Study, terminal: Terminal) -> CommandResult {
        if self.share.dry_run {
            return share::estimate(study, &self.output);
        }
        // Without --out the parts go to a temporary directory.
        let temporary = match &self.out.out {
            Some(_) => None,
            None => Some(temporary_dir()?),
        };
        let temporary = temporary.as_ref().map(TempDir::path);
        let path = self.out.out.as_deref().or(temporary);
        let dir = self.dir(study, path.unwrap_or(Path::new("")))?;
        if self.compute(study, &dir)? == End::Stopped {
            return Ok(self.stopped(study, &dir));
        }
        if self.share.is_given() && !dir.is_complete() {
            return share::driven(study, &dir, &self.output);
        }
        // Already checked when the study began.
        let confidence = self.confidence.get(&mut Problems::default());
        let found = S::evaluate(StudyManifest::of(study), dir.study()?, confidence)?;
        let list = match &self.out.out {
            Some(_) => tables::written(dir.path(), &dir.finish(&found.files()?)?),
            None => String::new(),
        };
        let tables = || found.tables(terminal.stdout) + &list;
        Ok(found.results()?.output(&self.output, tables))
    }

    fn dir(&self, study: &Study, path: &Path) -> Result<StudyDir, Problem> {
        let manifest = study.manifest(self.format == PartFormat::Both);
        let (manifest, plan) = (manifest.as_bytes(), study.plan.text.as_bytes());
        match self.resume {
            true => StudyDir::resume(path, manifest, plan),
            false => StudyDir::create(path, manifest, plan, self.out.force),
        }
    }

    /// Runs the parts missing in the directory.
    fn compute(&self, study: &Study, dir: &StudyDir) -> Result<End, Problems> {
        let missing = dir.missing().into_iter().map(|part| part as u64);
        // Already checked when the study began.
        let wanted = self.share.parts(study, &mut Problems::default());
        let missing: BTreeSet<u64> = missing.filter(|part| wanted.contains(part)).collect();
        let done = (0..study.parts())
            .filter(|part| !missing.contains(part))
            .collect();
        let points = missing.iter().map(|part| study.part_points(*part));
        let points: u64 = points.map(|points| points.end - points.start).sum();
        let runs = points * study.cars.len() as u64;
        let progress = Progress::counted("runs", runs, self.output.quiet);
        let sink = DirWriter::new(study, dir);
        let end = study.execute(&done, &sink, &progress);
        progress.finish();
        Ok(end?)
    }

    fn stopped(&self, study: &Study, dir: &StudyDir) -> CommandOutput {
        let (parts, path) = (study.parts(), dir.path().display());
        let finished = parts - dir.missing().len() as u64;
        let kept = match &self.out.out {
            Some(_) => {
                format!("{finished} of {parts} parts are kept in {path}; --resume continues")
            }
            None => "nothing is kept without --out".to_owned(),
        };
        CommandOutput {
            stderr: format!("cvtcycle: stopped: {kept}\n"),
            ending: Ending::Interrupted,
            ..CommandOutput::default()
        }
    }
}

/// Results of a study, evaluated from its finished parts.
pub trait StudyOutput: Sized {
    /// Evaluates the finished parts.
    fn evaluate(
        outline: StudyManifest,
        store: store::Study,
        confidence: Confidence,
    ) -> Result<Self, Problem>;

    /// JSON object, with one line for failed runs.
    fn results(&self) -> Result<Results, Problems>;

    /// Files of a finished study: tables and figures.
    fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Problems>;

    /// Tables for the terminal.
    fn tables(&self, paint: Paint) -> String;
}

impl StudyOutput for StudyResults {
    fn evaluate(
        outline: StudyManifest,
        store: store::Study,
        confidence: Confidence,
    ) -> Result<Self, Problem> {
        StudyResults::from_store(outline, store, confidence)
    }

    fn results(&self) -> Result<Results, Problems> {
        let failures = tables::failures(&self.answer.runs);
        let json = json_text(&self.answer)?;
        Ok(Results::new(json, failures, WrittenFiles::default()))
    }

    fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Problems> {
        study_files(self)
    }

    fn tables(&self, paint: Paint) -> String {
        tables::tables(self, paint)
    }
}

/// Replaces the hint for a temporary directory, which can be neither resumed nor replaced.
fn without_resume_hint(problem: Problem) -> Problem {
    if problem.settings.is_empty() {
        return problem;
    }
    let hint = "nothing is kept without --out: name a directory on a disk with room";
    problem.hint(hint).settings(&[])
}

fn temporary_dir() -> Result<TempDir, Problems> {
    let dir = tempfile::Builder::new().prefix("cvtcycle-study-").tempdir();
    dir.map_err(|error| {
        let message = format!("cannot create a temporary directory: {error}");
        problem("--out", &message, "name a directory with --out").into()
    })
}
