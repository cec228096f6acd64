//! `fleet`: many cars from a table, driven on tests and compared with measured fuel.

use std::path::Path;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::config::bounded::{self, TABLE};
use cvtcycle::config::procedure::Procedure;
use cvtcycle::config::setup::STEP;
use cvtcycle::fleet::baselines::{Baseline, baselines};
use cvtcycle::fleet::errors::{
    Entry, ErrorChange, ErrorStatistics, GroupErrors, Pair, box_word, by_group, changes,
    error_percent, pairs,
};
use cvtcycle::fleet::fit::{self, FitKey, FleetFit};
use cvtcycle::fleet::{
    ColumnMap, DrivenCar, Fleet, FleetCar, Refused, Setting, Sheet, spread, tables,
};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::SCHEMA;
use cvtcycle::output::table::{TextTable, wrapped};
use cvtcycle::report::charts::{
    FleetError, FleetMark, FleetPair, Picture, fleet_by_group, fleet_over, fleet_pairs,
    fleet_scatter,
};
use serde::Serialize;

use super::{Execute, threads};
use crate::args::groups::ThreadArgs;
use crate::args::problems::{bad_value, cite};
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
  cvtcycle fleet cars.csv --map epa --set 'engine.electrical_w = 300 + 100*displ'
  cvtcycle fleet cars.csv --map epa --fit engine.electrical_w=300..700 --leave-out make

A row of the table is a car, made by the rules of `cvtcycle new`. Without --map a column is headed by an option of `new` (mass, f0, n_over_v; with a unit as \
`mass [lb]`), by a key of the vehicle file (engine.electrical_w) or by a measured figure (ftp75_l_per_100km); the column carid names the car, manual_carid the \
car that it is a pair with. --map epa reads the columns of the US EPA test car lists; a TOML file maps other tables.

With --set the cars are driven without it as well, and the errors of the same cars are printed next to each other. An expression has the names of columns, numbers, + - * / ^ \
and the functions of validation rows (sqrt, ln, exp, min, max); a car whose cell is empty keeps its value, and so does a car of the other box. --fit finds the values of keys that \
are best for all cars, and predicts each group of --leave-out with the values that are best for the others: what they are worth for other cars.

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
    /// Override one value of all cars, or of each by an expression of the columns; repeatable
    #[arg(long, value_name = "KEY=VALUE|EXPRESSION")]
    set: Vec<String>,
    /// Fit these numbers of all cars to the measured fuel, within their ranges or those given
    #[arg(long, value_name = "KEY[=LOW..HIGH],..", value_delimiter = ',')]
    fit: Vec<String>,
    /// Column whose groups the regressions and fits leave out in turn [default: the first grouping column; none: each car by itself]
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
    set: Vec<Setting>,
    fit: Vec<FitKey>,
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
    /// How many cars the ranges hold that are made from the cars of other groups.
    coverage: Vec<spread::Coverage>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    changes: Vec<ErrorChange>,
    #[serde(skip_serializing_if = "Option::is_none")]
    fit: Option<FleetFit>,
}

/// Errors of the differences of pairs, points.
#[derive(Debug, Serialize)]
struct PairErrors {
    figure: String,
    measured_percent: f64,
    computed_percent: f64,
    #[serde(flatten)]
    errors: ErrorStatistics,
    /// Differences to the twins of the cars, and the errors of these.
    #[serde(skip_serializing_if = "Option::is_none")]
    twin_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    twin_errors: Option<ErrorStatistics>,
}

impl Execute for FleetArgs {
    type Plan = FleetPlan;

    fn plan(&self, problems: &mut Problems) -> Option<FleetPlan> {
        let given = self.threads.given(problems);
        problems.take(threads::begin(given));
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
        let set = Setting::read_all(&self.set, &sheet.names).map_err(|found| cite("--set", found));
        let set = problems.take(set);
        let read =
            |text: &String| problems.take(FitKey::read(text).map_err(|found| cite("--fit", found)));
        let fit: Vec<FitKey> = self.fit.iter().filter_map(read).collect();
        if !fit.is_empty() && self.leave_out.as_deref() == Some("none") {
            let message = "a fit is judged by groups that it has not seen";
            problems.add(bad_value(
                "--leave-out",
                "none",
                &sheet.names.join(", "),
                message,
                "name a column such as make",
            ));
        }
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
            set: set?,
            fit,
            dt_s: dt_s?,
            out,
        })
    }

    fn run(&self, mut plan: FleetPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let driven_with = |set: &[Setting]| -> Result<(Fleet, Vec<DrivenCar>), Problems> {
            let cars = plan.sheet.rows.len() as u64;
            let progress = Progress::counted("cars", cars, self.results.output.quiet);
            let (sheet, map, tests) = (&plan.sheet, &plan.map, &plan.tests);
            let driven = Fleet::driven(sheet, map, tests, set, plan.dt_s, &progress);
            progress.finish();
            driven
        };
        let (fleet, driven) = driven_with(&plan.set)?;
        let entries: Vec<Entry> = fleet.cars.iter().zip(&driven).collect();
        let without = match plan.set.is_empty() {
            true => None,
            false => Some(driven_with(&[])?),
        };
        let before = without
            .iter()
            .flat_map(|(fleet, driven)| fleet.cars.iter().zip(driven));
        let before: Vec<Entry> = before.collect();
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
        let fit = match (plan.fit.as_slice(), leave_out) {
            ([], _) | (_, None) => None,
            (keys, Some(column)) => {
                let progress = Progress::evaluations(self.results.output.quiet);
                // The values of the cars again: those of the drives are gone.
                let made = Fleet::from_sheet(&plan.sheet, &plan.map, &plan.tests, &plan.set)?;
                let found = fit::fit(&made, &plan.tests, keys, column, plan.dt_s, &progress);
                progress.finish();
                Some(found.map_err(|found| cite("--fit", found))?)
            }
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
            coverage: spread::coverages(&entries, &pairs, &figures, leave_out.unwrap_or_default()),
            changes: changes(&before, &entries, &figures),
            fit,
        };
        let json = json_text(&summary)?;
        let files = WrittenFiles::write(out, |dir| {
            dir.put(
                "fleet.csv",
                tables::fleet_csv(&fleet, &entries, &before, &plan.tests, &spread::known),
            )?;
            dir.put("errors.csv", tables::errors_csv(&summary.errors))?;
            dir.put("pairs.csv", tables::pairs_csv(&pairs))?;
            dir.put("baselines.csv", tables::baselines_csv(&summary.baselines))?;
            if !summary.changes.is_empty() {
                dir.put("changes.csv", tables::changes_csv(&summary.changes))?;
            }
            if let Some(fit) = &summary.fit {
                dir.put("fit.csv", tables::fit_csv(fit))?;
            }
            for (kind, marks) in marks(&entries, &plan.tests, leave_out) {
                dir.put(&format!("measured_{kind}.svg"), &fleet_scatter(&marks).svg)?;
            }
            for (name, picture) in pictures(&entries, &pairs, &plan.tests, &fleet.groups) {
                dir.put(&format!("{name}.svg"), &picture.svg)?;
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

/// The whole results of the tests: column and name.
fn whole_figures(tests: &[Procedure]) -> Vec<(String, String)> {
    let results = tests.iter().flat_map(|test| &test.results);
    let whole = results.filter(|result| result.phases.is_empty());
    whole
        .map(|result| (result.column(), result.name.to_uppercase()))
        .collect()
}

/// From rad/m to rpm/(km/h).
const RPM_PER_KMH: f64 = 60.0 / (2.0 * std::f64::consts::PI) / 3.6;

/// Errors by the words of each grouping column and over N/V, and differences of pairs, each with the name of its file. None without measured fuel.
fn pictures(
    entries: &[Entry],
    pairs: &[Pair],
    tests: &[Procedure],
    columns: &[String],
) -> Vec<(String, Picture)> {
    let figures = whole_figures(tests);
    let errors = |group: &dyn Fn(&FleetCar) -> String| -> Vec<FleetError> {
        let all = figures.iter().flat_map(|(column, name)| {
            entries.iter().filter_map(move |entry| {
                Some(FleetError {
                    car: entry.0.id.clone(),
                    group: group(entry.0),
                    over: entry.0.facts.top_rad_m * RPM_PER_KMH,
                    transmission: box_word(entry.0).to_owned(),
                    figure: name.clone(),
                    error_percent: error_percent(*entry, column)?,
                })
            })
        });
        all.collect()
    };
    let word = |car: &FleetCar, column: &str| {
        let word = car.words.get(column).filter(|word| !word.is_empty());
        word.cloned().unwrap_or_else(|| "-".to_owned())
    };
    let mut all = Vec::new();
    let over = errors(&|_| String::new());
    if over.is_empty() {
        return all;
    }
    for column in columns {
        let own = errors(&|car| word(car, column));
        all.push((format!("errors_by_{column}"), fleet_by_group(column, &own)));
    }
    let over = fleet_over("engine speed over road speed in top [rpm/(km/h)]", &over);
    all.push(("errors_over_n_over_v".to_owned(), over));
    let group = |id: &str| {
        let own = entries.iter().find(|entry| entry.0.id == id);
        own.zip(columns.first())
            .map_or_else(String::new, |(entry, column)| word(entry.0, column))
    };
    let own = figures.iter().flat_map(|(column, name)| {
        let own = pairs.iter().filter(move |pair| pair.figure == *column);
        own.filter(|pair| pair.error().is_finite())
            .map(move |pair| FleetPair {
                car: pair.car.clone(),
                group: group(&pair.car),
                figure: name.clone(),
                measured_percent: pair.measured_percent,
                computed_percent: pair.computed_percent,
            })
    });
    let own: Vec<FleetPair> = own.collect();
    if !own.is_empty() {
        all.push(("pairs".to_owned(), fleet_pairs(&own)));
    }
    all
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
        let twins: Vec<(&str, f64)> = own
            .iter()
            .map(|pair| (pair.car.as_str(), pair.twin_error()))
            .filter(|(_, error)| error.is_finite())
            .collect();
        let has_all = twins.len() == own.len();
        Some(PairErrors {
            twin_percent: has_all.then(|| mean(|pair| pair.twin_percent)),
            twin_errors: ErrorStatistics::new(&twins).filter(|_| has_all),
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
    if !summary.changes.is_empty() {
        parts.push((
            "The same cars without and with --set, errors, %".to_owned(),
            changes_table(&summary.changes),
        ));
    }
    if let Some(fit) = &summary.fit {
        let title = format!(
            "Fitted to {}; each {} predicted with the values that are fitted to the others, errors, %",
            fit.figures.join(", "),
            fit.column
        );
        parts.push((title, fit_table(fit)));
    }
    wrapped(&head, "") + &sections(parts, paint)
}

fn changes_table(changes: &[ErrorChange]) -> String {
    let mut table = TextTable::new("llrrrrrrrrrr");
    table.row([
        "figure",
        "box",
        "n before",
        "after",
        "both",
        "mean before",
        "after",
        "rms before",
        "after",
        "change",
        "sd",
        "nearer",
    ]);
    for own in changes {
        let counts = [own.cars[0], own.cars[1], own.n].map(|n| n.to_string());
        let means = own.mean_percent.map(|x| signed(x, 1));
        let rms = own.rms_percent.map(|x| fixed(x, 1));
        let change = [
            signed(own.mean_change, 1),
            fixed(own.sd_change, 1),
            own.nearer.to_string(),
        ];
        let figure = own.figure.trim_end_matches("_l_per_100km").to_owned();
        let words = [figure, own.transmission.clone()].into_iter();
        table.row(words.chain(counts).chain(means).chain(rms).chain(change));
    }
    table.text()
}

fn fit_table(fit: &FleetFit) -> String {
    let mut table = TextTable::new(&("lrrrrr".to_owned() + &"r".repeat(fit.keys.len())));
    let heads = [
        fit.column.as_str(),
        "n",
        "mean as made",
        "rms",
        "mean predicted",
        "rms",
    ];
    let keys = fit.keys.iter().map(String::as_str);
    table.row(heads.into_iter().chain(keys));
    let mut row =
        |word: &str, own: &ErrorStatistics, other: Option<&ErrorStatistics>, values: &[f64]| {
            let of = |e: Option<&ErrorStatistics>| {
                [
                    signed(e.map(|e| e.mean_percent), 1),
                    fixed(e.map(|e| e.rms_percent), 1),
                ]
            };
            let numbers = [own.n.to_string()].into_iter();
            let numbers = numbers.chain(of(Some(own))).chain(of(other));
            // Four digits of the range of each key.
            let values = values.iter().zip(&fit.ends).map(|(x, [low, high])| {
                let digits = (3.0 - (high - low).log10().floor()).clamp(0.0, 6.0);
                fixed(*x, digits as usize)
            });
            table.row([word.to_owned()].into_iter().chain(numbers).chain(values));
        };
    for group in &fit.groups {
        row(
            &group.word,
            &group.as_made,
            group.predicted.as_ref(),
            &group.values,
        );
    }
    row(
        "all, each group by the others",
        &fit.as_made,
        fit.predicted.as_ref(),
        &[],
    );
    row(
        "all, fitted to all of them",
        &fit.as_made,
        Some(&fit.fitted),
        &fit.values,
    );
    row("values as made", &fit.as_made, None, &fit.before);
    let at_end = fit.values.iter().zip(&fit.ends).zip(&fit.keys);
    let at_end: Vec<&str> = at_end
        .filter(|((x, [low, high]), _)| (*x - low).min(high - *x) < 1e-3 * (high - low))
        .map(|(_, key)| key.as_str())
        .collect();
    let mut text = table.text();
    if !at_end.is_empty() {
        text += &wrapped(
            &format!("at an end of its range: {}", at_end.join(", ")),
            "",
        );
    }
    if fit.end != "converged" {
        text += &wrapped(&format!("the fit to all cars ended {}", fit.end), "");
    }
    text
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
    let mut table = TextTable::new("lrrrrrrrr");
    table.row([
        "figure",
        "n",
        "measured %",
        "computed %",
        "error",
        "sd",
        "rms",
        "twin %",
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
            signed(pair.twin_percent, 1),
            fixed(pair.twin_errors.as_ref().map(|e| e.rms_percent), 1),
        ]);
    }
    table.text()
}
