//! Groups of data in CSV files.

use std::path::Path;

use super::keys::DATA;
use super::{BenchPoints, Context, Found, Measured, Observable, Observation, stem};
use crate::data::sheet::{SD, Sheet, and_more};
use crate::data::{TIME, bench_points, bytes_of, read_points, read_scalars, read_trace};
use cvtcycle_config::{
    Bound, Place, Problem, ProblemKind, Problems, Section, did_you_mean, embedded, unit_of,
};
use cvtcycle_model::keys::{Quantity, Values};
use cvtcycle_output::provenance::hash;
use cvtcycle_validate::source::{self, Kind, Source};
use cvtcycle_validate::tables::{self, bench};

/// Reads the file of a group; what is wrong is reported to `s`.
pub(super) fn read(s: &Section, way: &str, context: &Context, found: &mut Found) {
    let key = match way {
        "points" => &DATA.points,
        "trace" => &DATA.trace,
        _ => &DATA.scalars,
    };
    let word = Values::text(s, key);
    if word.is_empty() {
        // The other keys are not checked.
        s.pass_over();
        return;
    }
    let folder = Path::new(context.file).parent().unwrap_or(Path::new(""));
    let path = folder.join(&word).to_string_lossy().into_owned();
    let bytes = match bytes_in(context.file, &word, &path, (&s.place(way), way)) {
        Ok(bytes) => Some(bytes),
        Err(problems) => {
            report(s, problems);
            None
        }
    };
    if let Some(bytes) = &bytes {
        found.files.push((path.clone(), hash(bytes)));
    }
    let file = (path.as_str(), bytes.as_deref());
    match way {
        "points" => of_points(s, file, context, found),
        "trace" => of_trace(s, file, context, found),
        _ => of_scalars(s, file, context, found),
    }
}

/// Bytes of a data file: of the program's own for a plan that the program carries.
fn bytes_in(
    plan: &str,
    word: &str,
    path: &str,
    (place, key): (&Place, &str),
) -> Result<Vec<u8>, Problems> {
    let own = || embedded::text(embedded::calibration_points(), &stem(word));
    match plan.strip_prefix("embedded:").and_then(|_| own()) {
        Some(text) => Ok(text.as_bytes().to_vec()),
        None => bytes_of(path, place, key),
    }
}

/// Path and bytes of a file; without bytes only the other keys of the group are checked.
type File<'a> = (&'a str, Option<&'a [u8]>);

fn report(s: &Section, problems: Problems) {
    problems
        .into_iter()
        .for_each(|problem| s.report_problem(problem));
}

/// Standard deviations of the plan: of single columns by their names, of all others under no name.
struct Deviations(Vec<(String, f64)>);

impl Deviations {
    fn read(s: &Section) -> Self {
        let every = s.optional(&DATA.sd);
        let table = s.table("sd_by_column");
        let own = table.names().into_iter().map(|name| {
            // The unit is that of the column: no conversion.
            let sd = table.raw(
                name,
                "above 0",
                "standard deviation, in the unit of the column",
            );
            let sd = sd.and_then(|sd| sd.number(Quantity::NONE, Bound::positive()));
            (name.to_owned(), sd.unwrap_or(f64::NAN))
        });
        Deviations(own.chain(every.map(|sd| (String::new(), sd))).collect())
    }

    /// The standard deviation of a measured column in a row: that of the file goes before those of the plan.
    fn deviation(&self, sheet: &Sheet, row: usize, name: &str) -> Option<f64> {
        let own = sheet.number(row, sheet.find(&format!("{SD}{name}")));
        let named = |wanted: &str| self.0.iter().find(|(key, _)| key == wanted);
        own.or_else(|| Some(named(name).or_else(|| named(""))?.1))
    }

    /// Reports columns without one, and names of the plan that no column has.
    fn check(&self, s: &Section, sheet: &Sheet) {
        let measured = || sheet.measured.iter().map(|k| sheet.columns[*k].as_str());
        // An unknown column, reported already, may be the one that is meant.
        let strange = sheet.columns.iter().any(String::is_empty);
        for (name, _) in self.0.iter().filter(|_| !strange) {
            if !name.is_empty() && !measured().any(|column| column == name) {
                let message = format!("the file measures no `{name}`");
                let hint = did_you_mean(name, measured());
                let hint = hint.unwrap_or_else(|| "remove it".to_owned());
                let table = s.table("sd_by_column");
                table.unknown_key(name, "measured columns of the file", &message, &hint);
            }
        }
        for (k, name) in sheet.measured.iter().zip(measured()) {
            let deviation = sheet.find(&format!("{SD}{name}"));
            let lacks = |row: &usize| {
                sheet.number(*row, Some(*k)).is_some()
                    && !sheet.is_bad(*row, deviation)
                    && self.deviation(sheet, *row, name).is_none()
            };
            if let Some(row) = (0..sheet.rows.len()).find(lacks) {
                let message = format!("{name} has no standard deviation here");
                let hint = format!("add a column {SD}{name}, or `sd` to the [[data]] of the plan");
                let problem = Problem::missing(message).allowed("a standard deviation");
                s.report_problem(sheet.problem(row, *k, problem.hint(hint)).names_key());
            }
        }
    }

    /// The observation of a cell; none where nothing was measured.
    fn observation(
        &self,
        sheet: &Sheet,
        (row, k): (usize, usize),
        label: impl Fn(&str) -> String,
        observable: impl Fn(&str) -> Observable,
    ) -> Option<Observation> {
        let (value, name) = (sheet.number(row, Some(k))?, &sheet.columns[k]);
        let sd = self.deviation(sheet, row, name).unwrap_or(f64::NAN);
        let measured = Measured::Value(value);
        Some(Observation {
            column: name.clone(),
            unit: unit_of(name).to_owned(),
            place: sheet.place(row, k),
            ..Observation::new(label(name), measured, sd, observable(name))
        })
    }
}

/// Index of a name, which is there.
fn index(names: &[&str], name: &str) -> usize {
    names.iter().position(|known| *known == name).unwrap_or(0)
}

fn of_points(s: &Section, (path, bytes): File, context: &Context, found: &mut Found) {
    let deviations = Deviations::read(s);
    let vehicle = s.optional_text(&DATA.vehicle);
    let car = Source {
        place: s.place("points"),
        vehicle: vehicle.map(|word| source::relative_to(context.file, &word)),
        lubricant: s.optional_text(&DATA.lubricant),
        set: s.overrides(&DATA.set),
        without: source::without(s, &DATA.without),
        ..Source::new("points", Kind::Bench)
    };
    let fold_by = s.optional_text(&DATA.fold_by);
    let Some(bytes) = bytes else { return };
    let (sheet, problems) = read_points(path, bytes);
    report(s, problems);
    let Some(sheet) = sheet else { return };
    deviations.check(s, &sheet);
    let fold_column = fold_by.as_deref().map(|name| (name, sheet.find(name)));
    if let Some((name, None)) = fold_column {
        let columns = sheet.columns.iter().map(String::as_str);
        let columns: Vec<&str> = columns.filter(|name| !name.is_empty()).collect();
        let message = format!("the file has no column `{name}`");
        let hint = "name one of the file's columns";
        s.unknown_key("fold_by", &columns.join(", "), &message, hint);
    }
    let (names, bench) = (bench::columns(), context.benches);
    for row in 0..sheet.rows.len() {
        for k in &sheet.measured {
            let label = |name: &str| format!("{name}, line {}", sheet.rows[row].line);
            let observable = |name: &str| Observable::Point {
                bench,
                row,
                column: index(&names, name),
            };
            let observation = deviations.observation(&sheet, (row, *k), label, observable);
            let Some(observation) = observation else {
                continue;
            };
            found.observations.push(Observation {
                what: setting(&sheet, row),
                ..observation
            });
            if let Some((name, Some(column))) = fold_column {
                let level = sheet.number(row, Some(column)).map(|x| x.to_string());
                found
                    .folds
                    .push(format!("{name} {}", level.as_deref().unwrap_or("-")));
            }
        }
    }
    found.benches.push(BenchPoints {
        points: bench_points(&sheet, bench::parts(&car)),
        source: car,
    });
}

/// The setting of a row in words.
fn setting(sheet: &Sheet, row: usize) -> String {
    let word = |key: &str| {
        let number = sheet.number(row, sheet.find(key));
        number.map(|x| format!("{key} {x}"))
    };
    let keys = [
        "ratio",
        "speed_rpm",
        "temp_degc",
        "torque_nm",
        "pressure_bar",
    ];
    keys.into_iter()
        .filter_map(word)
        .collect::<Vec<_>>()
        .join(", ")
}

/// The source that a trace or totals belong to.
fn source_of(s: &Section, way: &str, kinds: &[Kind], context: &Context) -> Option<Source> {
    let name = Values::text(s, &DATA.source);
    if name.is_empty() {
        return None;
    }
    let sources = context.names.sources.iter();
    let fitting: Vec<&Source> = sources
        .filter(|source| kinds.contains(&source.kind))
        .collect();
    let Some(source) = fitting.iter().find(|source| source.name == name) else {
        let known: Vec<&str> = fitting.iter().map(|source| &*source.name).collect();
        let add = "add [sources.NAME] with source = \"run\", its cycle, ambient and start";
        let hint = did_you_mean(&name, known.iter().copied()).unwrap_or_else(|| add.to_owned());
        let message = format!("there is no such source `{name}` for a {way} file");
        s.unknown_name("source", &known.join(", "), &message, &hint);
        return None;
    };
    let ratios = source.axes.iter().find(|(key, _)| *key == "ratio");
    let tests = ratios
        .and_then(|(_, list)| list.as_ref())
        .map_or(1, Vec::len);
    if source.kind == Kind::Transient && tests > 1 {
        let message = format!("source `{name}` is {tests} tests, one at each ratio");
        let hint = "write a source with one `ratio`, continuing it with `like`";
        s.complain_by_name(
            ProblemKind::Conflict,
            "source",
            "a source of one test",
            &message,
            hint,
        );
        return None;
    }
    Some((*source).clone())
}

fn of_trace(s: &Section, (path, bytes): File, context: &Context, found: &mut Found) {
    let deviations = Deviations::read(s);
    let apart_s = Values::number(s, &DATA.independent_every_s);
    let kinds = [Kind::Run, Kind::Transient];
    let source = source_of(s, "trace", &kinds, context);
    let Some(bytes) = bytes else { return };
    // Without a source a column of any is as good as known.
    let kinds = source
        .as_ref()
        .map_or(kinds.to_vec(), |source| vec![source.kind]);
    let names = kinds
        .into_iter()
        .flat_map(|kind| tables::columns(kind, false));
    let names: Vec<&'static str> = names.collect();
    let (sheet, problems) = read_trace(path, bytes, &names);
    report(s, problems);
    let Some(sheet) = sheet else { return };
    deviations.check(s, &sheet);
    let Some(source) = source else { return };
    let time = sheet.find(TIME);
    let at = |row: usize| sheet.number(row, time).unwrap_or(f64::NAN);
    if let Some(end_s) = end_of(&source) {
        let late = (0..sheet.rows.len()).filter(|row| at(*row) > end_s);
        let late: Vec<usize> = late.collect();
        if let Some(first) = late.first() {
            let more = and_more(late.len());
            let problem =
                Problem::out_of_range(format!("this time is beyond the end of the cycle{more}"))
                    .allowed(format!("up to {end_s} s"))
                    .hint("cut the trace, or name the cycle that was driven");
            s.report_problem(sheet.problem(*first, time.unwrap_or(0), problem));
        }
    }
    let duration_s = at(sheet.rows.len().saturating_sub(1)) - at(0);
    let independent = match apart_s > 0.0 {
        true => duration_s / apart_s + 1.0,
        false => f64::INFINITY,
    };
    let run = context.runs;
    for k in &sheet.measured {
        let observations = (0..sheet.rows.len()).filter_map(|row| {
            let time_s = at(row);
            let label = |name: &str| format!("{name} at {time_s} s");
            let observable = |name: &str| Observable::Trace {
                run,
                column: index(&names, name),
                time_s,
            };
            deviations.observation(&sheet, (row, *k), label, observable)
        });
        let mut observations: Vec<Observation> = observations.collect();
        let wider = (observations.len() as f64 / independent).max(1.0).sqrt();
        for observation in &mut observations {
            observation.weight_sd = observation.sd * wider; // CM-2
        }
        found.observations.append(&mut observations);
    }
    found.runs.push(source);
}

/// End of a run's cycle, s.
fn end_of(source: &Source) -> Option<f64> {
    let run = Some(source).filter(|source| source.kind == Kind::Run)?;
    let cycle = source::cycle(run).ok()?;
    let times = cycle.trace_for(true).steps(1.0).map(|step| step.time_s);
    times.reduce(f64::max)
}

fn of_scalars(s: &Section, (path, bytes): File, context: &Context, found: &mut Found) {
    let source = source_of(s, "scalars", &[Kind::Run], context);
    let Some(bytes) = bytes else { return };
    let names = tables::columns(Kind::Run, true);
    let cycle = source
        .as_ref()
        .and_then(|source| source::cycle(source).ok());
    let phases = cycle.as_ref().map(|cycle| source::phases(cycle));
    let (sheet, problems) = read_scalars(path, bytes, &names, phases.as_deref());
    report(s, problems);
    let (Some(source), Some(sheet)) = (source, sheet) else {
        return;
    };
    let [quantity, phase, value, sd] = ["quantity", "phase", "value", "sd"].map(|n| sheet.find(n));
    for row in 0..sheet.rows.len() {
        let [quantity, phase] = [quantity, phase].map(|column| sheet.word(row, column).to_owned());
        let numbers = sheet.number(row, value).zip(sheet.number(row, sd));
        let Some((number, sd)) = numbers else {
            continue;
        };
        let observable = Observable::Total {
            run: context.runs + found.runs.len(),
            column: index(&names, &quantity),
        };
        let label = match phase.as_str() {
            "" => quantity.clone(),
            phase => format!("{quantity}, {phase}"),
        };
        found.observations.push(Observation {
            unit: quantity_unit(&quantity).to_owned(),
            place: sheet.place(row, value.unwrap_or(0)),
            column: quantity,
            ..Observation::new(label, Measured::Value(number), sd, observable)
        });
        found.runs.push(Source {
            phase,
            ..source.clone()
        });
    }
}

/// Unit of a total; those of fuel and CO2 are no units of a key.
fn quantity_unit(quantity: &str) -> &str {
    match quantity {
        "fuel_l_per_100km" => "L/100 km",
        "co2_g_per_km" => "g/km",
        _ if quantity.ends_with("_kj") => "kJ",
        _ if quantity.ends_with("_km") => "km",
        _ => unit_of(quantity),
    }
}
