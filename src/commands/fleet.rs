//! `fleet`: many cars from a table, driven on tests and compared with measured fuel.

use std::path::Path;

use clap::Args;
use cvtcycle::config::bounded::{self, TABLE};
use cvtcycle::config::procedure::Procedure;
use cvtcycle::config::setup::STEP;
use cvtcycle::config::{Override, Problems};
use cvtcycle::fleet::baselines::{Baseline, baselines};
use cvtcycle::fleet::errors::{
    Entry, ErrorStatistics, GroupErrors, Pair, box_word, by_group, pairs,
};
use cvtcycle::fleet::{ColumnMap, DrivenCar, Fleet, Refused, Sheet, drive, spread, tables};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::SCHEMA;
use cvtcycle::output::table::{TextTable, wrapped};
use cvtcycle::report::charts::{FleetMark, fleet_scatter};
use serde::Serialize;

use super::{Execute, threads};
use crate::args::groups::ThreadArgs;
use crate::args::problems::{bad_value, cite, overrides};
use crate::args::{Names, ResultArgs, number};
use crate::print::colour::Paint;
use crate::print::progress::Progress;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text, sections};

/// Refused rows that are printed one by one.
const MAX_REFUSED: usize = 10;

/// Arguments of `fleet`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle fleet cars.csv --map epa --test ftp75,hwfet,cold_ftp --out fleet
  cvtcycle fleet cars.csv --test wltp --set engine.electrical_w=400

A row of the table is a car, made by the rules of `cvtcycle new`. Without --map a column is headed by an option of `new` (mass, f0, n_over_v; with a unit as \
`mass [lb]`), by a key of the vehicle file (engine.electrical_w) or by a measured figure (ftp75_l_per_100km); the column carid names the car, manual_carid the \
car that it is a pair with. --map epa reads the columns of the US EPA test car lists; a TOML file maps other tables.

Exit codes: 0 success; 1 rows were refused, a column is unknown, or a check of a drive failed: the other cars are driven; 2 bad input.")]
pub struct FleetArgs {
    /// Table of cars, CSV
    #[arg(value_name = "CARS.csv")]
    file: String,
    /// Columns of the table: epa, or a TOML file [default: columns named as the options of `new`]
    #[arg(long, value_name = "epa|FILE.toml")]
    map: Option<String>,
    /// Further columns for the cars, from a table with the same column of names; repeatable
    #[arg(long, value_name = "FILE.csv")]
    join: Vec<String>,
    /// Tests, names or TOML files
    #[arg(long, value_name = "TEST,..", value_delimiter = ',', default_value = "ftp75,hwfet", value_parser = Names(Procedure::names), hide_possible_values = true)]
    test: Vec<String>,
    /// Override one value of all cars; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Column whose groups the regressions leave out in turn [default: the first grouping column; none: each car by itself]
    #[arg(long, value_name = "COLUMN")]
    leave_out: Option<String>,
    /// Columns by which errors are grouped, besides those of the map
    #[arg(long, value_name = "COLUMN,..", value_delimiter = ',')]
    by: Vec<String>,
    /// Longest time step, s, 0.01 to 10
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "1",
        allow_hyphen_values = true
    )]
    dt: String,
    #[command(flatten)]
    threads: ThreadArgs,
    #[command(flatten)]
    results: ResultArgs,
}

/// Checked input.
pub struct FleetPlan {
    sheet: Sheet,
    map: ColumnMap,
    tests: Vec<Procedure>,
    set: Vec<Override>,
    dt_s: f64,
    out: Option<OutputDir>,
}

/// The object of `--json` and `summary.json`.
#[derive(Debug, Serialize)]
struct FleetSummary {
    #[serde(flatten)]
    manifest: Manifest,
    table: String,
    tests: Vec<String>,
    driven: usize,
    refused: usize,
    cars_with_failed_checks: usize,
    errors: Vec<GroupErrors>,
    pair_errors: Vec<PairErrors>,
    baselines: Vec<Baseline>,
}

/// Errors of the differences of pairs, points.
#[derive(Debug, Serialize)]
struct PairErrors {
    figure: String,
    measured_percent: f64,
    computed_percent: f64,
    #[serde(flatten)]
    errors: ErrorStatistics,
}

impl Execute for FleetArgs {
    type Plan = FleetPlan;

    fn plan(&self, problems: &mut Problems) -> Option<FleetPlan> {
        let given = self.threads.given(problems);
        problems.take(threads::begin(given));
        let set = overrides("--set", &self.set, problems);
        let map = match &self.map {
            None => Some(ColumnMap::own()),
            Some(word) => {
                problems.take(ColumnMap::open(word).map_err(|found| cite("--map", found)))
            }
        };
        let tests: Vec<Option<Procedure>> = self
            .test
            .iter()
            .map(|word| problems.take(Procedure::open(word).map_err(|found| cite("--test", found))))
            .collect();
        let dt_s = problems.take(number("--dt", &self.dt, STEP, "dt_s"));
        let mut sheet = problems.take(read("CARS.csv", &self.file));
        for file in &self.join {
            let other = problems.take(read("--join", file));
            if let (Some(sheet), Some(other), Some(map)) = (&mut sheet, other, &map) {
                problems.take(sheet.join(&other, &map.id));
            }
        }
        let (sheet, mut map) = (sheet?, map?);
        for column in self.by.iter().chain(&self.leave_out) {
            if sheet.column(column).is_none() && column != "none" {
                let message = format!("the table has no column `{column}`");
                problems.add(bad_value(
                    "--by",
                    column,
                    &sheet.names.join(", "),
                    &message,
                    "",
                ));
            } else if !map.groups.contains(column) && column != "none" {
                map.groups.push(column.clone());
            }
        }
        let out = self.results.out.dir(problems);
        Some(FleetPlan {
            sheet,
            map,
            tests: tests.into_iter().collect::<Option<_>>()?,
            set,
            dt_s: dt_s?,
            out,
        })
    }

    fn run(&self, mut plan: FleetPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let fleet = Fleet::from_sheet(&plan.sheet, &plan.map, &plan.tests, &plan.set)?;
        let progress =
            Progress::counted("cars", fleet.cars.len() as u64, self.results.output.quiet);
        let driven = drive(&fleet.cars, &plan.tests, plan.dt_s, &progress);
        progress.finish();
        let entries: Vec<Entry> = fleet.cars.iter().zip(&driven).collect();
        let figures: Vec<String> = plan
            .tests
            .iter()
            .flat_map(|test| test.results.iter().map(|result| result.column()))
            .collect();
        let leave_out = match self.leave_out.as_deref() {
            Some("none") => None,
            Some(column) => Some(column),
            None => fleet.groups.first().map(String::as_str),
        };
        let pairs = pairs(&entries, &figures);
        let summary = FleetSummary {
            manifest: Manifest::new(SCHEMA),
            table: plan.sheet.file.clone(),
            tests: plan.tests.iter().map(|test| test.name.clone()).collect(),
            driven: fleet.cars.len(),
            refused: fleet.refused.len(),
            cars_with_failed_checks: driven
                .iter()
                .filter(|car| !car.failed_checks().is_empty())
                .count(),
            errors: by_group(&entries, &figures, &fleet.groups),
            pair_errors: pair_errors(&pairs, &figures),
            baselines: baselines(&entries, leave_out),
        };
        let json = json_text(&summary)?;
        let files = WrittenFiles::write(out, |dir| {
            dir.put(
                "fleet.csv",
                tables::fleet_csv(&fleet, &entries, &plan.tests, &spread::known),
            )?;
            dir.put("errors.csv", tables::errors_csv(&summary.errors))?;
            dir.put("pairs.csv", tables::pairs_csv(&pairs))?;
            dir.put("baselines.csv", tables::baselines_csv(&summary.baselines))?;
            for (kind, marks) in marks(&entries, &plan.tests, leave_out) {
                dir.put(&format!("measured_{kind}.svg"), &fleet_scatter(&marks).svg)?;
            }
            let column = leave_out.unwrap_or_default();
            dir.put(
                "spread.csv",
                spread::csv(&spread::spreads(&entries, &pairs, &figures, column)),
            )?;
            dir.put("summary.json", &json)?;
            Ok("")
        })?;
        let results = Results::new(json, failures(&fleet, &driven), files);
        Ok(results.output(&self.results.output, || {
            text(&summary, &fleet, terminal.stdout)
        }))
    }
}

fn read(option: &str, file: &str) -> Result<Sheet, Problems> {
    let bytes = bounded::read(Path::new(file), TABLE).map_err(|error| {
        let message = format!("cannot read `{file}`: {error}");
        bad_value(
            option,
            file,
            &error.allowed("a readable file"),
            &message,
            error.hint("check the path and its permissions"),
        )
    })?;
    Sheet::read(file, &bytes)
}

/// Cars with measured fuel by box, for the picture: the whole result of each test.
fn marks(
    entries: &[Entry],
    tests: &[Procedure],
    column: Option<&str>,
) -> Vec<(&'static str, Vec<FleetMark>)> {
    let of = |kind: &'static str| {
        let own = entries.iter().filter(|(car, _)| box_word(car) == kind);
        let all = own.flat_map(|(car, driven)| {
            let whole = tests.iter().flat_map(|test| {
                test.results
                    .iter()
                    .filter(|result| result.phases.is_empty())
            });
            whole.filter_map(|result| {
                let column_name = result.column();
                Some(FleetMark {
                    car: car.id.clone(),
                    group: column
                        .and_then(|column| car.words.get(column))
                        .cloned()
                        .unwrap_or_else(|| kind.to_owned()),
                    figure: result.name.to_uppercase(),
                    measured: *car.measured.get(&column_name)?,
                    computed: driven.fuel(&column_name)?,
                })
            })
        });
        (kind, all.collect::<Vec<_>>())
    };
    ["cvt", "manual"]
        .map(of)
        .into_iter()
        .filter(|(_, marks)| !marks.is_empty())
        .collect()
}

fn pair_errors(pairs: &[Pair], figures: &[String]) -> Vec<PairErrors> {
    let of = |figure: &String| {
        let own: Vec<&Pair> = pairs
            .iter()
            .filter(|pair| pair.figure == *figure && pair.error().is_finite())
            .collect();
        let errors: Vec<(&str, f64)> = own
            .iter()
            .map(|pair| (pair.car.as_str(), pair.error()))
            .collect();
        let mean =
            |x: fn(&Pair) -> f64| own.iter().map(|pair| x(pair)).sum::<f64>() / own.len() as f64;
        Some(PairErrors {
            figure: figure.clone(),
            measured_percent: mean(|pair| pair.measured_percent),
            computed_percent: mean(|pair| pair.computed_percent),
            errors: ErrorStatistics::new(&errors)?,
        })
    };
    figures.iter().filter_map(of).collect()
}

/// Lists unread columns, refused rows and failed checks, a line each: exit code 1.
fn failures(fleet: &Fleet, driven: &[DrivenCar]) -> Vec<String> {
    let mut lines: Vec<String> = fleet
        .unknown
        .iter()
        .map(|(name, near)| {
            format!("column `{name}` is not read; {near}")
                .trim_end_matches("; ")
                .to_owned()
        })
        .collect();
    let row =
        |Refused { line, id, reason }: &Refused| format!("line {line} {id}: refused: {reason}");
    lines.extend(fleet.refused.iter().take(MAX_REFUSED).map(row));
    if fleet.refused.len() > MAX_REFUSED {
        lines.push(format!(
            "{} more rows refused: fleet.csv of --out has their reasons",
            fleet.refused.len() - MAX_REFUSED
        ));
    }
    let failed: Vec<String> = fleet
        .cars
        .iter()
        .zip(driven)
        .filter(|(_, driven)| !driven.failed_checks().is_empty())
        .map(|(car, driven)| {
            format!(
                "check failed: {}: {}",
                car.id,
                driven.failed_checks().join(", ")
            )
        })
        .collect();
    let more = failed.len().saturating_sub(MAX_REFUSED);
    lines.extend(failed.into_iter().take(MAX_REFUSED));
    if more > 0 {
        lines.push(format!(
            "{more} more cars with failed checks: fleet.csv of --out has them"
        ));
    }
    lines
}

fn text(summary: &FleetSummary, fleet: &Fleet, paint: Paint) -> String {
    let mut head = format!(
        "{} cars driven on {}",
        summary.driven,
        summary.tests.join(", ")
    );
    if summary.refused > 0 {
        head += &format!(", {} rows refused", summary.refused);
    }
    if summary.cars_with_failed_checks > 0 {
        head += &format!(
            ", {} cars with failed checks",
            summary.cars_with_failed_checks
        );
    }
    let doubtful = fleet
        .cars
        .iter()
        .filter(|car| !car.doubts.is_empty())
        .count();
    if doubtful > 0 {
        head += &format!(", {doubtful} with doubts");
    }
    let mut parts = Vec::new();
    if !summary.errors.is_empty() {
        parts.push((
            "Computed against measured fuel, %".to_owned(),
            errors_table(&summary.errors),
        ));
    }
    if !summary.pair_errors.is_empty() {
        parts.push((
            "Pairs of cars: difference to the other box".to_owned(),
            pairs_table(&summary.pair_errors),
        ));
    }
    if !summary.baselines.is_empty() {
        parts.push((
            "Regressions on the same measurements, each group predicted from the others, %"
                .to_owned(),
            baselines_table(&summary.baselines),
        ));
    }
    wrapped(&head, "") + &sections(parts, paint)
}

fn errors_table(groups: &[GroupErrors]) -> String {
    table(
        &["figure", "column", "word"],
        groups.iter().map(|group| {
            (
                vec![
                    group.figure.clone(),
                    group.column.clone(),
                    group.word.clone(),
                ],
                &group.errors,
            )
        }),
    )
}

fn baselines_table(baselines: &[Baseline]) -> String {
    table(
        &["figure", "box", "knows"],
        baselines.iter().map(|own| {
            (
                vec![
                    own.figure.clone(),
                    own.transmission.clone(),
                    own.knows.clone(),
                ],
                &own.errors,
            )
        }),
    )
}

fn table<'a>(
    names: &[&str],
    rows: impl Iterator<Item = (Vec<String>, &'a ErrorStatistics)>,
) -> String {
    let mut table = TextTable::new(&("l".repeat(names.len()) + "rrrrrr"));
    table.row(
        names
            .iter()
            .copied()
            .chain(["n", "mean", "sd", "rms", "within 5 %", "worst"]),
    );
    for (words, e) in rows {
        let numbers = [
            e.n.to_string(),
            signed(e.mean_percent, 1),
            fixed(e.sd_percent, 1),
            fixed(e.rms_percent, 1),
            fixed(e.within_5_percent, 0),
            signed(e.worst_percent, 1),
        ];
        table.row(words.into_iter().chain(numbers));
    }
    table.text()
}

fn pairs_table(pairs: &[PairErrors]) -> String {
    let mut table = TextTable::new("lrrrrrr");
    table.row([
        "figure",
        "n",
        "measured %",
        "computed %",
        "error",
        "sd",
        "rms",
    ]);
    for pair in pairs {
        let e = &pair.errors;
        table.row([
            pair.figure.clone(),
            e.n.to_string(),
            signed(pair.measured_percent, 1),
            signed(pair.computed_percent, 1),
            signed(e.mean_percent, 1),
            fixed(e.sd_percent, 1),
            fixed(e.rms_percent, 1),
        ]);
    }
    table.text()
}
