//! The car with the values that its logs tell, and the ranges of these as factors of a study.

use super::{Findings, Line, Value};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A text as a TOML string.
fn quoted(text: &str) -> String {
    toml_edit::Value::from(text).to_string()
}

/// A number with a digit more than its range has.
fn rounded(value: f64) -> f64 {
    let digits = 4 - value.abs().max(1e-9).log10().floor() as i32;
    let scale = 10_f64.powi(digits.clamp(0, 9));
    (value * scale).round() / scale
}

/// The logs by name.
fn names(findings: &Findings) -> String {
    let names: Vec<&str> = findings.logs.iter().map(|log| log.name.as_str()).collect();
    names.join(", ")
}

/// A vehicle file: the car of the findings, with what the logs tell of it in place of its own values. None without a car or without a value for it.
#[must_use]
pub fn vehicle(findings: &Findings, title: &str) -> Option<String> {
    let car = findings.car.as_deref()?;
    let logs = names(findings);
    let mut tables: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for value in &findings.values {
        let Some((table, key)) = value.key.and_then(|key| key.rsplit_once('.')) else {
            continue;
        };
        let line = format!(
            "{key} = {}",
            with_origin(
                &format!("{:?}", rounded(value.value)),
                &source(value, &logs)
            )
        );
        tables.entry(table).or_default().push(line);
    }
    for line in &findings.lines {
        let Some((table, key)) = line.key.rsplit_once('.') else {
            continue;
        };
        let rows = line
            .points
            .iter()
            .map(|point| format!("[{}, {}]", rounded(point.x), point.rpm.round()));
        let rows: Vec<String> = rows.collect();
        let text = format!(
            "{key} = {}",
            with_origin(&format!("[{}]", rows.join(", ")), &line_source(line, &logs))
        );
        tables.entry(table).or_default().push(text);
    }
    if tables.is_empty() {
        return None;
    }
    let mut text = format!(
        "# {}: values of `{car}` that logs tell, each with the range of 90 % of resamples of the logs. All else is that car's.\n[vehicle]\ntitle = {}\nshort = {}\nlike = {}\n",
        title,
        quoted(title),
        quoted(title),
        quoted(car)
    );
    for (table, lines) in tables {
        // Writing into a String cannot fail.
        let _ = write!(text, "\n[{table}]\n{}\n", lines.join("\n"));
    }
    Some(text)
}

fn with_origin(value: &str, source: &str) -> String {
    format!(
        "{{ value = {value}, status = \"fitted\", source = {} }}",
        quoted(source)
    )
}

/// "drive.csv, 213 s (CL-3); 698 to 705 rpm".
fn source(value: &Value, logs: &str) -> String {
    let range = match value.range {
        Some([low, high]) => format!("{} to {} {}", rounded(low), rounded(high), value.unit),
        None => "no range: too few blocks of time".to_owned(),
    };
    format!(
        "{logs}, {} {} ({}); {}",
        value.count,
        value.counted,
        value.label,
        range.trim_end_matches(" -")
    )
}

fn line_source(line: &Line, logs: &str) -> String {
    let range = |point: &super::LinePoint| match point.range {
        Some([low, high]) => format!("{} to {}", low.round(), high.round()),
        None => "no range".to_owned(),
    };
    let ranges: Vec<String> = line.points.iter().map(range).collect();
    let seconds: usize = line.points.iter().map(|point| point.seconds).sum();
    format!(
        "{logs}, {seconds} s ({}); rpm from point to point {}",
        line.label,
        ranges.join(", ")
    )
}

/// The ranges as factors of a plan of a study of that vehicle file, to be put into one.
#[must_use]
pub fn ranges(findings: &Findings) -> String {
    let logs = names(findings);
    let mut text = String::new();
    for value in &findings.values {
        let (Some(key), Some([low, high])) = (value.key, value.range) else {
            continue;
        };
        if low >= high {
            continue;
        }
        // Writing into a String cannot fail.
        let _ = write!(
            text,
            "[[factor]]\nkey = {}\nname = {}\nstatus = \"fitted\"\nsource = {}\ndistribution.uniform = {{ low = {:?}, high = {:?} }}\n\n",
            quoted(key),
            quoted(value.name),
            quoted(&source(value, &logs)),
            rounded(low),
            rounded(high)
        );
    }
    text
}
