//! Groups of data in CSV files.

use sha2::{Digest, Sha256};

use super::found::{About, Context, Found, observation};
use super::types::{BenchPoints, Measured, Observable};
use crate::check::source::{self, Kind, Source};
use crate::check::tables;
use crate::fit::data::points::SD;
use crate::fit::data::sheet::Sheet;
use crate::fit::data::{bytes_of, points, scalars, trace};
use cvtcycle_config::{Bound, Problem, Problems, Section, did_you_mean, unit_of};
use cvtcycle_model::keys::Quantity;

/// Seconds after which two values of a trace are independent, where the plan does not say.
const INDEPENDENT_S: f64 = 30.0;

/// Reads the file of a group; what is wrong is reported to `s`.
pub(super) fn read(s: &Section, way: &str, context: &Context, found: &mut Found) {
    let word = s.text(way, "CSV file, relative to the plan");
    if word.is_empty() {
        // The other keys are not checked.
        s.names()
            .into_iter()
            .for_each(|key| drop(s.raw(key, "", "")));
        return;
    }
    let folder = std::path::Path::new(context.file)
        .parent()
        .unwrap_or(std::path::Path::new(""));
    let path = folder.join(&word).to_string_lossy().into_owned();
    let bytes = match bytes_of(&path, &s.place(way), way) {
        Ok(bytes) => bytes,
        Err(problems) => {
            report(s, problems);
            // The keys are read all the same: they may be wrong, too, and are no strangers.
            match way {
                "points" => drop((sds(s), bench_of(s), fold_by(s))),
                "trace" => drop((sds(s), apart_s(s), source_of(s, way, context))),
                _ => drop(source_of(s, way, context)),
            }
            return;
        }
    };
    found.made.files.push((
        path.clone(),
        format!("{:x}", HexOf(Sha256::digest(&bytes).as_slice())),
    ));
    match way {
        "points" => of_points(s, &path, &bytes, found),
        "trace" => of_trace(s, (&path, &bytes), context, found),
        _ => of_scalars(s, (&path, &bytes), context, found),
    }
}

/// Bytes in hexadecimal digits.
struct HexOf<'a>(&'a [u8]);

impl std::fmt::LowerHex for HexOf<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

fn report(s: &Section, problems: Problems) {
    problems
        .into_iter()
        .for_each(|problem| s.report_problem(problem));
}

/// Standard deviations by column: `sd = 0.5` for every column (under no name), a table `sd_by_column` for single ones.
fn sds(s: &Section) -> Vec<(String, f64)> {
    let every = s.optional_number(
        "sd",
        Bound::positive(),
        "standard deviation of every column, in its unit",
    );
    let table = s.table("sd_by_column");
    let own = table.names().into_iter().map(|name| {
        // The unit is that of the column: no conversion.
        let sd = table.raw(
            name,
            "above 0",
            "standard deviation, in the unit of the column",
        );
        (
            name.to_owned(),
            sd.and_then(|written| written.number(Quantity::NONE, Bound::positive()))
                .unwrap_or(f64::NAN),
        )
    });
    own.chain(every.map(|sd| (String::new(), sd))).collect()
}

/// The standard deviation of each measured column, its own column of the file going before.
struct Deviations {
    given: Vec<(String, f64)>,
}

impl Deviations {
    fn of(&self, sheet: &Sheet, row: usize, name: &str) -> Option<f64> {
        let own = sheet.number(row, sheet.find(&format!("{SD}{name}")));
        let named = |wanted: &str| {
            self.given
                .iter()
                .find(|(key, _)| key == wanted)
                .map(|(_, sd)| *sd)
        };
        own.or_else(|| named(name)).or_else(|| named(""))
    }

    /// Reports columns without one, and names of the plan that no column has.
    fn check(&self, s: &Section, sheet: &Sheet, measured: &[(usize, &str)]) {
        // An unknown column, reported already, may be the one that is meant.
        let strange = sheet.columns.iter().any(String::is_empty);
        for (name, _) in &self.given {
            if !strange && !name.is_empty() && !measured.iter().any(|(_, column)| column == name) {
                let hint = did_you_mean(name, measured.iter().map(|(_, column)| *column))
                    .unwrap_or_else(|| "remove it".to_owned());
                s.table("sd_by_column").complain(
                    name,
                    "measured columns of the file",
                    &format!("the file measures no `{name}`"),
                    &hint,
                );
            }
        }
        for (k, name) in measured {
            let deviation = sheet.find(&format!("{SD}{name}"));
            let lacks = |row: &usize| {
                sheet.number(*row, Some(*k)).is_some()
                    && !sheet.is_bad(*row, deviation)
                    && self.of(sheet, *row, name).is_none()
            };
            let without = (0..sheet.rows.len()).find(lacks);
            if let Some(row) = without {
                let message = format!("{name} has no standard deviation here");
                let hint = format!("add a column {SD}{name}, or `sd` to the [[data]] of the plan");
                s.report_problem(
                    sheet.problem(
                        row,
                        *k,
                        Problem::invalid(message)
                            .allowed("a standard deviation")
                            .hint(hint),
                    ),
                );
            }
        }
    }
}

/// The box on the bench.
fn bench_of(s: &Section) -> Source {
    let mut own = source::empty("points", Kind::Bench);
    own.place = s.place("points");
    own.lubricant = s.optional_text("lubricant", "transmission oil in place of the vehicle's");
    own.set = s.overrides("set", "overrides KEY=VALUE of the car on the bench");
    own.without = source::without(s);
    own
}

fn fold_by(s: &Section) -> Option<String> {
    s.optional_text(
        "fold_by",
        "column whose values divide the points into folds",
    )
}

fn of_points(s: &Section, path: &str, bytes: &[u8], found: &mut Found) {
    let deviations = Deviations { given: sds(s) };
    let (own, fold_by) = (bench_of(s), fold_by(s));
    let (sheet, problems) = points::read(path, bytes);
    report(s, problems);
    let Some(sheet) = sheet else { return };
    let measured = points::measured(&sheet);
    deviations.check(s, &sheet, &measured);
    let fold_column = fold_by.as_deref().map(|name| (name, sheet.find(name)));
    if let Some((name, None)) = fold_column {
        let columns: Vec<&str> = sheet
            .columns
            .iter()
            .map(String::as_str)
            .filter(|name| !name.is_empty())
            .collect();
        s.complain(
            "fold_by",
            &columns.join(", "),
            &format!("the file has no column `{name}`"),
            "name one of the file's columns",
        );
    }
    let names = tables::bench::columns();
    for row in 0..sheet.rows.len() {
        for (k, name) in &measured {
            let Some(value) = sheet.number(row, Some(*k)) else {
                continue;
            };
            let sd = deviations.of(&sheet, row, name).unwrap_or(f64::NAN);
            let what = Observable::Point {
                bench: 0,
                row,
                column: names.iter().position(|column| column == name).unwrap_or(0),
            };
            let about = About {
                label: format!("{name}, line {}", sheet.rows[row].line),
                what: setting(&sheet, row),
                unit: unit_of(name).to_owned(),
                place: sheet.place(row, *k),
            };
            let mut observed = observation(about, Measured::Value(value), sd, what);
            (*name).clone_into(&mut observed.column);
            found.observations.push(observed);
            if let Some((name, Some(column))) = fold_column {
                let level = sheet
                    .number(row, Some(column))
                    .map_or_else(|| "-".to_owned(), |x| x.to_string());
                found.folds.push(format!("{name} {level}"));
            }
        }
    }
    found.made.benches.push(BenchPoints {
        points: points::points(&sheet, tables::bench::parts(&own)),
        source: own,
    });
}

/// The setting of a row in words.
fn setting(sheet: &Sheet, row: usize) -> String {
    let word = |key: &str| {
        sheet
            .number(row, sheet.find(key))
            .map(|x| format!("{key} {x}"))
    };
    [
        "ratio",
        "speed_rpm",
        "temp_degc",
        "torque_nm",
        "pressure_bar",
    ]
    .into_iter()
    .filter_map(word)
    .collect::<Vec<_>>()
    .join(", ")
}

/// The source that a trace or totals belong to.
fn source_of(s: &Section, way: &str, context: &Context) -> Option<Source> {
    if way == "points" {
        return None;
    }
    let name = s.text("source", "source of the plan that was measured");
    let kinds: &[Kind] = if way == "trace" {
        &[Kind::Run, Kind::Transient]
    } else {
        &[Kind::Run]
    };
    let fitting = || {
        context
            .sources
            .iter()
            .filter(|source| kinds.contains(&source.kind))
            .map(|source| source.name.as_str())
    };
    let source = context
        .sources
        .iter()
        .find(|source| source.name == name && kinds.contains(&source.kind));
    if source.is_none() && !name.is_empty() {
        let all: Vec<&str> = fitting().collect();
        let hint = did_you_mean(&name, fitting()).unwrap_or_else(|| {
            "add [sources.NAME] with source = \"run\", its cycle, ambient and start".to_owned()
        });
        s.complain(
            "source",
            &all.join(", "),
            &format!("there is no such source `{name}` for a {way} file"),
            &hint,
        );
    }
    if let Some(source) = source.filter(|source| source.kind == Kind::Transient)
        && let Some(count) = source
            .axis_or_none("ratio")
            .map(|list| list.len())
            .filter(|count| *count > 1)
    {
        let message = format!("source `{name}` is {count} tests, one at each ratio");
        s.complain(
            "source",
            "a source of one test",
            &message,
            "write a source with one `ratio`, continuing it with `like`",
        );
        return None;
    }
    source.cloned()
}

fn of_trace(s: &Section, (path, bytes): (&str, &[u8]), context: &Context, found: &mut Found) {
    let deviations = Deviations { given: sds(s) };
    let apart_s = apart_s(s);
    let source = source_of(s, "trace", context);
    // Without a source a column of any is as good as known.
    let kinds = source
        .as_ref()
        .map_or(vec![Kind::Run, Kind::Transient], |source| vec![source.kind]);
    let names: Vec<&'static str> = kinds
        .into_iter()
        .flat_map(|kind| tables::columns(kind, false))
        .collect();
    let (sheet, problems) = trace::read(path, bytes, &names);
    report(s, problems);
    let Some(sheet) = sheet else { return };
    let measured = trace::measured(&sheet);
    deviations.check(s, &sheet, &measured);
    let time = sheet.find(trace::TIME);
    let at = |row: usize| sheet.number(row, time).unwrap_or(f64::NAN);
    let duration_s = at(sheet.rows.len().saturating_sub(1)) - at(0);
    let Some(source) = source else { return };
    if let Some(end_s) = end_of(&source) {
        let late: Vec<usize> = (0..sheet.rows.len())
            .filter(|row| at(*row) > end_s)
            .collect();
        if let Some(first) = late.first() {
            let message = format!(
                "this time is beyond the end of the cycle{}",
                trace::and_more(late.len())
            );
            let hint = "cut the trace, or name the cycle that was driven";
            s.report_problem(
                sheet.problem(
                    *first,
                    time.unwrap_or(0),
                    Problem::invalid(message)
                        .allowed(format!("up to {end_s} s"))
                        .hint(hint),
                ),
            );
        }
    }
    for (k, name) in &measured {
        let rows: Vec<usize> = (0..sheet.rows.len())
            .filter(|row| sheet.number(*row, Some(*k)).is_some())
            .collect();
        let independent = if apart_s > 0.0 {
            duration_s / apart_s + 1.0
        } else {
            f64::INFINITY
        };
        let wider = (rows.len() as f64 / independent).max(1.0).sqrt();
        for row in rows {
            let Some(value) = sheet.number(row, Some(*k)) else {
                continue;
            };
            let sd = deviations.of(&sheet, row, name).unwrap_or(f64::NAN);
            let column = names.iter().position(|column| column == name).unwrap_or(0);
            let about = About {
                label: format!("{name} at {} s", at(row)),
                what: String::new(),
                unit: unit_of(name).to_owned(),
                place: sheet.place(row, *k),
            };
            let what = Observable::Trace {
                run: 0,
                column,
                time_s: at(row),
            };
            let mut observed = observation(about, Measured::Value(value), sd, what);
            observed.weight_sd = sd * wider;
            (*name).clone_into(&mut observed.column);
            found.observations.push(observed);
        }
    }
    found.made.runs.push(source);
}

fn apart_s(s: &Section) -> f64 {
    let doc = "time after which two values of a trace are independent";
    s.number_or(
        "independent_every_s",
        Bound::closed(0.0, 1e5),
        INDEPENDENT_S,
        doc,
    )
}

/// End of a run's cycle, s.
fn end_of(source: &Source) -> Option<f64> {
    if source.kind != Kind::Run {
        return None;
    }
    let cycle = source::cycle(source).ok()?;
    cycle
        .trace_for(true)
        .steps(1.0)
        .map(|step| step.time_s)
        .reduce(f64::max)
}

fn of_scalars(s: &Section, (path, bytes): (&str, &[u8]), context: &Context, found: &mut Found) {
    let source = source_of(s, "scalars", context);
    let names = tables::columns(Kind::Run, true);
    let cycle = source
        .as_ref()
        .and_then(|source| source::cycle(source).ok());
    let phases = cycle.map(|cycle| {
        cycle
            .phase_groups()
            .into_iter()
            .map(|(name, _)| name)
            .collect::<Vec<String>>()
    });
    let (sheet, problems) = scalars::read(path, bytes, &names, phases.as_deref());
    report(s, problems);
    let (Some(source), Some(sheet)) = (source, sheet) else {
        return;
    };
    let find = |name: &str| sheet.find(name);
    for row in 0..sheet.rows.len() {
        let (quantity, phase) = (
            sheet.word(row, find("quantity")).to_owned(),
            sheet.word(row, find("phase")).to_owned(),
        );
        let (Some(value), Some(sd)) = (
            sheet.number(row, find("value")),
            sheet.number(row, find("sd")),
        ) else {
            continue;
        };
        let what = Observable::Total {
            run: found.made.runs.len(),
            column: names.iter().position(|name| *name == quantity).unwrap_or(0),
        };
        let label = if phase.is_empty() {
            quantity.clone()
        } else {
            format!("{quantity}, {phase}")
        };
        let about = About {
            label,
            what: String::new(),
            unit: quantity_unit(&quantity),
            place: sheet.place(row, find("value").unwrap_or(0)),
        };
        let mut observed = observation(about, Measured::Value(value), sd, what);
        observed.column = quantity;
        found.observations.push(observed);
        found.made.runs.push(Source {
            phase,
            ..source.clone()
        });
    }
}

/// Unit of a total; those of fuel and CO2 are no units of a key.
fn quantity_unit(quantity: &str) -> String {
    match quantity {
        "fuel_l_per_100km" => "L/100 km".to_owned(),
        "co2_g_per_km" => "g/km".to_owned(),
        _ if quantity.ends_with("_kj") => "kJ".to_owned(),
        _ if quantity.ends_with("_km") => "km".to_owned(),
        _ => unit_of(quantity).to_owned(),
    }
}
