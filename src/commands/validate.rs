//! `validate`: every printed number against the program.

mod text;

use cvtcycle::config::setup;
use cvtcycle::config::{Problem, Problems, bounded, decode};
use cvtcycle::output::files::OutputDir;
use cvtcycle::report::validation_page::page;
use cvtcycle::study::check::{
    COMMON, File, MECHANISMS, Report, Row, Subject, csv, embedded_rows, json, judge, markdown, read,
};

use super::Context;
use crate::args::{self as inputs, Offering};
use crate::print::{Answer, FAILED, Reply, json_text, problem};

/// Arguments of `validate`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle validate
  cvtcycle validate --chapter 5 --mechanism pump
  cvtcycle validate --held-out
  cvtcycle validate --set transmission.cvt.pump.displacement_cc_rev=12
  cvtcycle validate --format html > validation.html

Verdicts: `agrees` (within what is printed and the tolerance), `fit` (the same, but a parameter
was fitted to it), `differs` (with its reason), `not comparable`. Exit code 1: the verdict of a row
is another one than recorded. The rows are TOML files, described in docs/validation_format.md;
--rows adds your own measurements to them.")]
pub struct Args {
    /// Own rows beside the program's; repeatable
    #[arg(long, value_name = "FILE.toml")]
    rows: Vec<String>,
    /// Leave the program's own rows out
    #[arg(long, requires = "rows")]
    only_rows: bool,
    /// Rows of one chapter only, such as 5 or C
    #[arg(long, value_name = "CHAPTER")]
    chapter: Option<String>,
    /// Rows of one mechanism only, named as the page of the book; `all` for every one
    #[arg(long, value_name = "NAME", value_parser = Offering(mechanisms), hide_possible_values = true)]
    mechanism: Option<String>,
    /// Only rows that test the program: no parameter was fitted to them, and they are no constants
    #[arg(long)]
    held_out: bool,
    /// Compute for another vehicle; verdicts are shown against the recorded ones
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Offering(inputs::vehicles), hide_possible_values = true)]
    vehicle: String,
    /// Transmission oil of that vehicle
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Offering(inputs::lubricants), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Override one value of that vehicle; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Print one JSON object instead of tables
    #[arg(long, conflicts_with = "format")]
    json: bool,
    /// Form of the output: table, csv, html, or md (a fragment for the book)
    #[arg(long, value_name = "FORM", default_value = "table", value_parser = Offering(formats), hide_possible_values = true)]
    format: String,
    /// Write summary.json, validation.csv, validation.html and validation.md into this directory
    #[arg(long, value_name = "DIR")]
    out: Option<std::path::PathBuf>,
    /// Replace the files of an earlier run in the --out directory
    #[arg(long, requires = "out")]
    force: bool,
    /// Print no table, only problems and moved rows; --json and other forms still print
    #[arg(long, short)]
    quiet: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    Table,
    Csv,
    Html,
    Markdown,
}

const FORMS: [(&str, Form); 4] = [
    ("table", Form::Table),
    ("csv", Form::Csv),
    ("html", Form::Html),
    ("md", Form::Markdown),
];

/// Every mechanism.
const ALL: &str = "all";

fn formats() -> Vec<&'static str> {
    FORMS.iter().map(|(name, _)| *name).collect()
}

fn mechanisms() -> Vec<&'static str> {
    MECHANISMS.into_iter().chain([ALL]).collect()
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let mut problems = Problems::default();
    let form = problems
        .take(inputs::word("--format", &args.format, &FORMS))
        .unwrap_or(Form::Table);
    let texts = problems.take(texts(args)).unwrap_or_default();
    let files = problems
        .take(read((&embedded_name(COMMON.0), COMMON.1), &texts))
        .unwrap_or_default();
    if !texts.is_empty() {
        filters(args, &files, &mut problems);
    }
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    if !args.only_rows {
        manual(args, &mut problems);
    }
    problems.finish()?;
    let subject = Subject {
        vehicle: args.vehicle.clone(),
        lubricant: args.lubricant.clone(),
        set: args.set.clone(),
    };
    let report = judge(&files, &subject, |row| wanted(args, row))?;
    let written = match out {
        Some(dir) => write(dir, &report)?,
        None => String::new(),
    };
    let moved = text::moved(&report);
    let code = if moved.is_empty() { 0 } else { FAILED };
    let stdout = match form {
        _ if args.json => json_text(&json(&report))?,
        Form::Table if args.quiet => String::new(),
        Form::Table => text::tables(&report, context.paint) + &written,
        Form::Csv => csv(&report),
        Form::Html => html(&report)?,
        Form::Markdown => markdown(&report),
    };
    // The table shows them itself.
    let stderr = if form == Form::Table && !args.json && !args.quiet {
        String::new()
    } else {
        moved
    };
    Ok(Answer {
        stdout,
        stderr,
        code,
    })
}

/// The program's own rows look into a CVT: with a manual box every one of their sources would be a problem.
fn manual(args: &Args, problems: &mut Problems) {
    // What is wrong with the vehicle itself is told with its overrides.
    let vehicle = setup::load(&args.vehicle, "--vehicle", &setup::Options::default());
    if vehicle.is_ok_and(|setup| !setup.transmission().is_cvt()) {
        let hint =
            "`--only-rows` with `--rows FILE.toml` holds your own rows against it".to_owned();
        let message = format!("`{}` has a manual box", args.vehicle);
        problems.add(inputs::bad_value(
            "--vehicle",
            &args.vehicle,
            "a vehicle with a CVT for the program's own rows",
            message,
            hint,
        ));
    }
}

fn embedded_name(name: &str) -> String {
    format!("embedded:{name}.toml")
}

/// Names and texts of all files of rows.
fn texts(args: &Args) -> Result<Vec<(String, String)>, Problems> {
    let mut problems = Problems::default();
    let embedded = embedded_rows().iter().filter(|_| !args.only_rows);
    let mut texts: Vec<(String, String)> = embedded
        .map(|(name, text)| (embedded_name(name), (*text).to_owned()))
        .collect();
    for path in &args.rows {
        let text =
            inputs::bytes("--rows", path, bounded::TOML).and_then(|bytes| decode(path, &bytes));
        texts.extend(problems.take(text).map(|text| (path.clone(), text)));
    }
    problems.finish()?;
    Ok(texts)
}

fn wanted(args: &Args, row: &Row) -> bool {
    let is = |asked: &Option<String>, own: &str| {
        asked
            .as_ref()
            .is_none_or(|asked| asked.eq_ignore_ascii_case(own))
    };
    let mechanism = args.mechanism.clone().filter(|name| name != ALL);
    is(&args.chapter, &row.chapter)
        && is(&mechanism, &row.mechanism)
        && (!args.held_out || row.is_held_out())
}

/// A chapter or mechanism that nothing has is a slip of the pen; a known mechanism without rows is not.
fn filters(args: &Args, files: &[File], problems: &mut Problems) {
    let rows = || files.iter().flat_map(|file| &file.rows);
    if let Some(chapter) = &args.chapter
        && !rows().any(|row| row.chapter.eq_ignore_ascii_case(chapter))
    {
        let mut known: Vec<&str> = rows().map(|row| row.chapter.as_str()).collect();
        known.dedup();
        problems.add(inputs::bad_value(
            "--chapter",
            chapter,
            &known.join(", "),
            format!("no row belongs to chapter `{chapter}`"),
            String::new(),
        ));
    }
    if let Some(name) = &args.mechanism
        && name != ALL
        && !MECHANISMS
            .iter()
            .any(|known| known.eq_ignore_ascii_case(name))
    {
        let hint = inputs::did_you_mean(name, &MECHANISMS).unwrap_or_default();
        problems.add(inputs::bad_value(
            "--mechanism",
            name,
            &MECHANISMS.join(", "),
            format!("there is no mechanism `{name}`"),
            hint,
        ));
    }
}

fn html(report: &Report) -> Result<String, Problem> {
    page(report).map_err(|why| problem("--format", &why, ""))
}

fn write(mut dir: OutputDir, report: &Report) -> Result<String, Problem> {
    let json = json_text(&json(report)).map_err(|mut problems| problems.remove(0))?;
    let files = [
        ("summary.json", json),
        ("validation.csv", csv(report)),
        ("validation.html", html(report)?),
        ("validation.md", markdown(report)),
    ];
    for (name, text) in files {
        dir.write(name, |out| out.write_all(text.as_bytes()))?;
    }
    let paths: Vec<String> = dir
        .commit()?
        .iter()
        .map(|path| format!("  {}\n", path.display()))
        .collect();
    Ok(format!("\nFiles written\n{}", paths.concat()))
}
