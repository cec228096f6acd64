//! What all studies share: threads, directory, progress, the way to the answer.

use std::path::PathBuf;

use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::found::StudyFound;
use cvtcycle::study::disk::DirWriter;
use cvtcycle::study::plan::Plan;
use cvtcycle::study::store::StudyDir;
use cvtcycle::study::{End, Study, StudyManifest};

use super::results;
use super::text;
use crate::commands::Context;
use crate::print::progress::{INTERRUPTED, Progress, listen};
use crate::print::{Answer, FAILED, Reply, json_text, problem};

/// Options of every study that runs.
#[derive(Clone, Debug, clap::Args)]
pub struct Common {
    /// Keep tables, statistics and plots in this directory; without it they are gone after the answer is printed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Go on with the interrupted study in the --out directory; finished parts are not run again
    #[arg(long, requires = "out", conflicts_with = "force")]
    pub resume: bool,
    /// Replace an earlier study in the --out directory
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Format of the tables in the --out directory
    #[arg(
        long,
        value_enum,
        value_name = "FORMAT",
        default_value = "parquet",
        requires = "out"
    )]
    pub format: Format,
    /// Threads, 1 to 1024 [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Run a study of more runs than the plan's `most_runs`
    #[arg(long)]
    pub yes: bool,
    /// Print one JSON object instead of tables
    #[arg(long)]
    pub json: bool,
    /// Print nothing but problems
    #[arg(long, short)]
    pub quiet: bool,
}

/// Files that the tables of a part are written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Parquet
    Parquet,
    /// Parquet, and CSV beside it
    Both,
}

/// Runs a plan, and answers.
pub fn run(plan: Plan, common: &Common, context: Context) -> Reply {
    listen();
    let study = Study::prepare(plan)?;
    agreed(&study, common)?;
    let manifest = study.manifest(common.format == Format::Both);
    // Without --out the parts go the same way, to a directory that is gone afterwards.
    let temporary = match &common.out {
        Some(_) => None,
        None => Some(
            tempfile::Builder::new()
                .prefix("cvtcycle-study-")
                .tempdir()
                .map_err(|e| no_room(&e))?,
        ),
    };
    let path = match (&common.out, &temporary) {
        (Some(path), _) => path.clone(),
        (None, Some(temporary)) => temporary.path().to_path_buf(),
        (None, None) => PathBuf::new(),
    };
    let plan_text = study.plan.text.as_bytes();
    let dir = match common.resume {
        true => StudyDir::resume(&path, manifest.as_bytes(), plan_text),
        false => StudyDir::create(&path, manifest.as_bytes(), plan_text, common.force),
    };
    let dir = dir?;
    match execute(&study, &dir, common)? {
        End::Complete => finish(&study, &dir, common, context),
        End::Stopped => Ok(stopped(&study, &dir, common)),
    }
}

/// More runs than the plan says need a word of the user.
fn agreed(study: &Study, common: &Common) -> Result<(), Problems> {
    let (runs, most) = (study.runs(), study.plan.most_runs);
    if runs <= most || common.yes {
        return Ok(());
    }
    let message = format!(
        "the study has {runs} runs ({} points, {} cars), more than {most}",
        study.points,
        study.cars.len()
    );
    let hint = "run it with --yes, give fewer values or samples, or raise `most_runs` in the plan";
    Err(problem(&study.plan.file, &message, hint)
        .allowed(format!("at most {most} runs without --yes"))
        .into())
}

fn no_room(error: &std::io::Error) -> Problem {
    problem(
        "--out",
        &format!("cannot create a temporary directory: {error}"),
        "name a directory with --out",
    )
}

fn execute(study: &Study, dir: &StudyDir, common: &Common) -> Result<End, Problems> {
    let threads = common.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|e| {
        problem(
            "--threads",
            &format!("cannot start threads: {e}"),
            "give fewer",
        )
    })?;
    let missing: std::collections::BTreeSet<u64> =
        dir.missing().into_iter().map(|part| part as u64).collect();
    let done = (0..study.parts())
        .filter(|part| !missing.contains(part))
        .collect();
    let left: u64 = missing
        .iter()
        .map(|part| study.part_points(*part))
        .map(|points| points.end - points.start)
        .sum();
    let progress = Progress::new(left * study.cars.len() as u64, common.quiet);
    let end = pool.install(|| study.execute(&done, &DirWriter::new(study, dir), &progress));
    progress.finish();
    end.map_err(Problems::from)
}

fn finish(study: &Study, dir: &StudyDir, common: &Common, context: Context) -> Reply {
    let outline = StudyManifest::of(study);
    let found = dir.study()?;
    let study = StudyFound::of(outline, found)?;
    let mut reply = reply(&study, common.json, common.quiet, context)?;
    if common.out.is_some() {
        let written = dir.finish(&results::files(&study)?)?;
        if !common.json && !common.quiet {
            reply.stdout += &text::written(dir.path(), &written);
        }
    }
    Ok(reply)
}

/// What a study that has run says, and whether all its runs were fine.
pub fn reply(study: &StudyFound, json: bool, quiet: bool, context: Context) -> Reply {
    let failed = study.answer.runs.failed + study.answer.runs.not_run > 0;
    let code = if failed { FAILED } else { 0 };
    let told = if failed {
        text::failures(&study.answer)
    } else {
        String::new()
    };
    if json || quiet {
        let stdout = if json {
            json_text(&study.answer)?
        } else {
            String::new()
        };
        return Ok(Answer {
            stdout,
            stderr: told,
            code,
        });
    }
    Ok(Answer {
        stdout: text::answer(study, context.paint),
        stderr: told,
        code,
    })
}

fn stopped(study: &Study, dir: &StudyDir, common: &Common) -> Answer {
    let whole = study.parts() - dir.missing().len() as u64;
    let kept = match &common.out {
        Some(_) => format!(
            "{whole} of {} parts are kept in {}; --resume goes on",
            study.parts(),
            dir.path().display()
        ),
        None => "nothing is kept, as there was no --out".to_owned(),
    };
    Answer {
        stderr: format!("cvtcycle: stopped: {kept}\n"),
        code: INTERRUPTED,
        ..Answer::default()
    }
}
