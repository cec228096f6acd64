//! `compare`: runs next to each other.

use std::path::PathBuf;

use clap::Args;
use cvtcycle::analysis::words::between;
use cvtcycle::config::Problems;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::summary::Over;
use cvtcycle::output::table::{TextTable, wrapped};
use cvtcycle::report::compare::{RunComparison, Side, compare, names};

use super::{Execute, threads};
use crate::args::OutputArgs;
use crate::args::problems::bad_value;
use crate::print::colour::Paint;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text, sections};

/// Maximum number of runs of a comparison.
const MAX_RUNS: usize = 20;
/// Maximum number of runs abreast in a table.
const MAX_RUNS_ABREAST: usize = 5;

/// Arguments of `compare`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle run --out offset_3mm
  cvtcycle run --set transmission.cvt.belt.band_offset_mm=2 --out offset_2mm
  cvtcycle run --set transmission.cvt.belt.band_offset_mm=1 --out offset_1mm
  cvtcycle compare offset_3mm offset_2mm offset_1mm
  cvtcycle compare offset_*mm --reference offset_2mm --json

The subject of each run, against that of the first one or of --reference. Losses are for a kilometre; those that hardly differ are left \
out of the table. `cvtcycle report A B` writes a document on two runs.")]
pub struct CompareArgs {
    /// Directories written by `run --out`, 2 to 20
    #[arg(value_name = "DIR", required = true)]
    dirs: Vec<PathBuf>,
    /// Name of the directory that the others are compared with [default: the first]
    #[arg(long, value_name = "NAME")]
    reference: Option<String>,
    /// Compare runs of different cycles, temperatures or steps as well
    #[arg(long)]
    loosely: bool,
    #[command(flatten)]
    output: OutputArgs,
}

impl Execute for CompareArgs {
    type Plan = RunComparison;

    fn plan(&self, problems: &mut Problems) -> Option<RunComparison> {
        problems.take(threads::begin(None));
        let count = self.dirs.len();
        if !(2..=MAX_RUNS).contains(&count) {
            let message = format!("{count} directories cannot be compared");
            let hint = "name the directories of the runs, the one to compare with first";
            let allowed = format!("2 to {MAX_RUNS} directories");
            problems.add(bad_value(
                "DIR",
                &count.to_string(),
                &allowed,
                &message,
                hint,
            ));
            return None;
        }
        let names = names(&self.dirs);
        let place = |word: &String| names.iter().position(|name| name == word);
        let reference = match &self.reference {
            None => 0,
            Some(word) => place(word).unwrap_or_else(|| {
                let message = format!("none of the runs is named `{word}`");
                let allowed = format!("one of {}", names.join(", "));
                problems.add(bad_value("--reference", word, &allowed, &message, ""));
                0
            }),
        };
        problems.take(compare(&self.dirs, reference, self.loosely))
    }

    fn run(&self, found: RunComparison, terminal: Terminal) -> CommandResult {
        let json = json_text(&found)?;
        let failures = found.runs.iter().flat_map(|run| {
            let failed = run.faults.iter();
            failed.map(|check| format!("check failed: {}: {check}", run.name))
        });
        let results = Results::new(json, failures.collect(), WrittenFiles::default());
        Ok(results.output(&self.output, || text(&found, terminal.stdout)))
    }
}

fn text(found: &RunComparison, paint: Paint) -> String {
    let (reference, others) = found.runs.split_at(1);
    let tables = others.chunks(MAX_RUNS_ABREAST).map(|chunk| {
        let runs: Vec<&Side> = reference.iter().chain(chunk).collect();
        (format!("Against {}", found.reference), table(found, &runs))
    });
    let faults = found.runs.iter().filter(|run| !run.faults.is_empty());
    let faults = faults.map(|run| {
        let list = run.faults.join(", ");
        let line = format!(
            "{}: {list}; not the numbers of a car that drives this cycle",
            run.name
        );
        wrapped(&line, "FAILED: ")
    });
    let cause = found.cause().map(|cause| wrapped(&cause, ""));
    let conditions = found.conditions.iter().map(|different| {
        let line = format!("{}: {}", different.key, different.values.join(", "));
        wrapped(&line, "not alike: ")
    });
    let body = sections(tables.collect::<Vec<_>>(), paint);
    let notes = faults.chain(conditions).chain(cause).collect::<String>();
    body.trim_start().to_owned() + "\n" + &notes
}

fn table(found: &RunComparison, runs: &[&Side]) -> String {
    let mut table = TextTable::new(&("ll".to_owned() + &"r".repeat(runs.len())));
    let mut add = |name: &str, unit: &str, cell: &dyn Fn(&Side) -> String| {
        let head = [name.to_owned(), unit.to_owned()].into_iter();
        table.row(head.chain(runs.iter().map(|run| cell(run))));
    };
    add("", "", &|run| run.name.clone());
    let over = runs.first().map_or(Over::Distance, |run| run.over());
    add("fuel", over.unit(), &|run| {
        let fuel = match over {
            Over::Distance => run.fuel_l_per_100km,
            Over::Time => run.fuel_l_per_h,
        };
        fixed(fuel, 3)
    });
    let own = |run: &Side| run.name == found.reference;
    add("difference", over.unit(), &|run| match (own(run), over) {
        (true, _) => String::new(),
        (false, Over::Distance) => signed(run.difference_l_per_100km, 3),
        (false, Over::Time) => signed(run.difference_l_per_h, 3),
    });
    add("", "%", &|run| match own(run) {
        true => String::new(),
        false => signed(run.difference_percent, 2),
    });
    if runs.iter().any(|run| run.drawn.is_some()) {
        add("90 %, uncertain inputs", "", &|run| {
            let drawn = run.drawn.as_ref();
            drawn.map_or_else(String::new, |drawn| match drawn.ends() {
                Some(ends) => between(ends, "%"),
                None => format!(
                    "{} of {} fail",
                    drawn.left_out,
                    drawn.left_out + drawn.draws
                ),
            })
        });
    }
    if runs.iter().any(|run| !run.faults.is_empty()) {
        add("verdict", "", &|run| match run.faults.is_empty() {
            true => "drives the cycle".to_owned(),
            false => "FAILED".to_owned(),
        });
    }
    if runs.iter().any(|run| run.fleet.is_some()) {
        add("90 %, error of the model", "", &|run| {
            let range = run.fleet.as_ref();
            range.map_or_else(String::new, |range| between(range.ends, "%"))
        });
    }
    let unit = match over {
        Over::Distance => {
            add("CO2", "g/km", &|run| fixed(run.co2_g_per_km, 1));
            "kJ/km"
        }
        Over::Time => "kJ/h",
    };
    for name in &found.components {
        add(&name.replace('_', " "), unit, &|run| {
            fixed(run.losses_kj(over).get(name).copied().flatten(), 2)
        });
    }
    add("transmission", unit, &|run| match over {
        Over::Distance => fixed(run.transmission_loss_kj_per_km, 2),
        Over::Time => fixed(run.transmission_loss_kj_per_h, 2),
    });
    if runs.iter().any(|run| run.min_clamp_safety.is_some()) {
        add("clamp safety, least", "-", &|run| {
            fixed(run.min_clamp_safety, 2)
        });
    }
    if runs.iter().any(|run| run.trace_missed_s > 0.0) {
        add("trace missed", "s", &|run| fixed(run.trace_missed_s, 1));
    }
    table.text()
}
