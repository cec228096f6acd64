//! `calibrate` on logs of a car: idle, fuel cut, ratios, lines and warm-up, read from their channels.

use std::path::Path;

use cvtcycle::calibrate::recorded::{
    Findings, KnownCar, Line, Question, RecordedLog, Value, estimate, ranges, vehicle,
};
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{bytes, read_columns};
use cvtcycle::config::setup::{Options, ParamSet, name_of};
use cvtcycle::config::{Argument, Problems, bounded};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::fixed;
use cvtcycle::output::table::{TextTable, wrapped};

use crate::args::problems::cite;
use crate::args::{OutputArgs, word_for_plan};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text, sections};

/// Logs, and where the results go.
pub struct LogsPlan {
    pub question: Question,
    pub out: Option<OutputDir>,
}

/// Reads the logs and the car.
pub fn question(
    files: &[String],
    columns: &Columns,
    car: Option<(&str, &Options)>,
    ambient_degc: f64,
    problems: &mut Problems,
) -> Option<Question> {
    let log = |file: &String| {
        let text = bytes(Argument::File, file, bounded::LOG);
        let cycle = text.and_then(|text| read_columns(file, &text, columns));
        cycle.map_err(|found| cite("LOG", found))
    };
    let mut logs = Vec::new();
    for file in files {
        let cycle = problems.take(log(file))?;
        let path = Path::new(file).file_name();
        let name = path.map_or_else(|| file.clone(), |name| name.to_string_lossy().into_owned());
        logs.push(RecordedLog { name, cycle });
    }
    let car = match car {
        None => None,
        Some((word, options)) => Some(KnownCar {
            word: word_for_plan(word),
            values: problems.take(ParamSet::load(word, options))?,
        }),
    };
    Some(Question {
        logs,
        car,
        ambient_degc,
    })
}

/// Estimates and prints.
pub fn run(plan: LogsPlan, args: &OutputArgs, terminal: Terminal) -> CommandResult {
    let findings = estimate(&plan.question)?;
    let json = json_text(&findings)?;
    let title = findings
        .car
        .as_deref()
        .map(|car| format!("{} by its logs", name_of(car)));
    let files = WrittenFiles::write(plan.out, |dir| {
        if let Some(text) = vehicle(&findings, title.as_deref().unwrap_or_default()) {
            dir.put("car.toml", &text)?;
            dir.put("ranges.toml", ranges(&findings))?;
        }
        dir.put("findings.json", &json)?;
        Ok("")
    })?;
    let results = Results::new(json, Vec::new(), files);
    Ok(results.output(args, || text(&findings, terminal)))
}

fn text(findings: &Findings, terminal: Terminal) -> String {
    let mut head = String::new();
    for log in &findings.logs {
        head += &format!(
            "{}: {} s, {} km; {}\n",
            log.name,
            fixed(log.duration_s, 0),
            fixed(log.distance_km, 2),
            match log.channels.is_empty() {
                true => "no channel but time and speed".to_owned(),
                false => log.channels.join(", "),
            }
        );
        head += &log
            .said
            .iter()
            .map(|own| wrapped(own, "  "))
            .collect::<String>();
    }
    let list = |list: &[String]| {
        list.iter()
            .map(|own| wrapped(own, "- "))
            .collect::<String>()
    };
    let mut parts = vec![("Found".to_owned(), values(&findings.values))];
    for line in &findings.lines {
        parts.push((
            format!("{} ({})", capital(line.name), line.label),
            points(line),
        ));
    }
    parts.push(("Doubts".to_owned(), list(&findings.doubts)));
    parts.push((
        "What the log cannot tell".to_owned(),
        list(&findings.cannot_tell),
    ));
    head + &sections(parts, terminal.stdout)
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// Decimals of a value: three digits of its range, or four of itself.
fn decimals(value: f64, range: Option<[f64; 2]>) -> usize {
    let scale = range
        .map_or(0.0, |[low, high]| high - low)
        .max(value.abs() / 100.0);
    let digits = 1.0 - scale.max(1e-6).log10().floor();
    digits.clamp(0.0, 4.0) as usize
}

fn ends(range: Option<[f64; 2]>, decimals: usize) -> String {
    range.map_or_else(
        || "-".to_owned(),
        |[low, high]| format!("{} to {}", fixed(low, decimals), fixed(high, decimals)),
    )
}

fn values(values: &[Value]) -> String {
    if values.is_empty() {
        return String::new();
    }
    let mut table = TextTable::new("lrllrlr");
    table.row(["quantity", "value", "90 %", "unit", "from", "", "file"]);
    for own in values {
        let decimals = decimals(own.value, own.range);
        table.row([
            format!("{} ({})", own.name, own.label),
            fixed(own.value, decimals),
            ends(own.range, decimals),
            own.unit.to_owned(),
            own.count.to_string(),
            own.counted.to_owned(),
            own.before
                .map_or_else(String::new, |before| fixed(before, decimals)),
        ]);
    }
    table.text() + "file: the value of the car's own files\n"
}

fn points(line: &Line) -> String {
    let mut table = TextTable::new("rrllr");
    table.row([line.unit, "rpm", "90 %", "middle half", "s"]);
    for own in &line.points {
        table.row([
            fixed(own.x, 1),
            fixed(own.rpm, 0),
            ends(own.range, 0),
            ends(Some(own.quartiles), 0),
            own.seconds.to_string(),
        ]);
    }
    let left = format!(
        "engine speeds are {} rpm (rms) off the line, {} % of that by road speed (CL-14)",
        fixed(line.rms_rpm, 0),
        fixed(100.0 * line.by_speed, 0)
    );
    table.text() + &wrapped(&left, "")
}
