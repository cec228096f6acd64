//! The vehicle file, and the fluid files, with the fitted values in them.
//!
//! A file keeps its form and comments. A fitted value gets the status `fitted`, the plan, the date and its standard error as its source.
//! What the plan sets is written in with the status `assumed`. Names of files within the vehicle file stay right from wherever the fitted
//! one lies: those that stand beside the vehicle file become whole paths.

use std::path::Path;

use toml_edit::{DocumentMut, InlineTable, Item, Table, Value};

use super::outcome::{Outcome, Parameter};
use super::plan::{Plan, problem};
use cvtcycle_config::Problems;
use cvtcycle_config::setup::{Kind, is_path, text_of};

/// Significant digits of a fitted value, far beyond its standard error.
const DIGITS: usize = 7;

/// Prefixes of fluids, and the keys under which the vehicle names them.
const FLUIDS: [(&str, &str); 2] = [
    ("lubricant.", "transmission_oil"),
    ("engine_oil.", "engine_oil"),
];

/// Names and texts of the fitted files: the vehicle first. `date` is written beside each value.
///
/// # Errors
/// A file that is no longer there, or in which a value cannot be put.
pub fn files(
    plan: &Plan,
    outcome: &Outcome,
    date: &str,
) -> Result<Vec<(String, String)>, Problems> {
    let (_, text, disk) = text_of(&plan.vehicle, Kind::Vehicle, "calibration.vehicle")?;
    let mut vehicle = parsed(plan, &text)?;
    beside(vehicle.as_item_mut(), &disk.folder);
    let source = |p: &Parameter| {
        let error = p.standard_error.map_or_else(
            || "no standard error".to_owned(),
            |x| format!("standard error {} {}", digits(x, 3), p.unit),
        );
        format!(
            "fitted to {} on {date}; {}",
            plan.file,
            error.trim_end_matches(" -")
        )
    };
    let mut written = Vec::new();
    for (prefix, name) in FLUIDS {
        let own: Vec<&Parameter> = outcome
            .parameters
            .iter()
            .filter(|p| p.is_key && p.name.starts_with(prefix))
            .collect();
        let given = if prefix == FLUIDS[0].0 {
            &plan.lubricant
        } else {
            &plan.engine_oil
        };
        let named = text_at(&vehicle, &["vehicle", name]);
        let word = given.clone().unwrap_or(named);
        let sets = plan.set.iter().filter_map(|set| set.strip_prefix(prefix));
        if own.is_empty() && sets.clone().next().is_none() {
            if given.is_some() {
                let word = if is_path(&word) {
                    whole(Path::new(""), &word)
                } else {
                    word
                };
                put(
                    &mut vehicle,
                    &["vehicle", name],
                    Value::from(word),
                    "assumed",
                    &format!("set by {}", plan.file),
                );
            }
            continue;
        }
        let (_, text, _) = text_of(&word, Kind::Lubricant, "calibration.lubricant")?;
        let mut fluid = parsed(plan, &text)?;
        for set in sets {
            assign(&mut fluid, set, plan, &disk.folder);
        }
        for p in own {
            let path: Vec<&str> = p.name[prefix.len()..].split('.').collect();
            put(&mut fluid, &path, number(p.value), "fitted", &source(p));
        }
        let file = format!("{}_fitted.toml", stem(&word));
        put(
            &mut vehicle,
            &["vehicle", name],
            Value::from(file.clone()),
            "fitted",
            &format!("{word} with values fitted to {}", plan.file),
        );
        written.push((file, fluid.to_string()));
    }
    for set in plan.set.iter().filter(|set| {
        !FLUIDS.iter().any(|(prefix, _)| set.starts_with(prefix)) && !set.starts_with("rig.")
    }) {
        assign(&mut vehicle, set, plan, &disk.folder);
    }
    for p in outcome
        .parameters
        .iter()
        .filter(|p| p.is_key && !FLUIDS.iter().any(|(prefix, _)| p.name.starts_with(prefix)))
    {
        put(
            &mut vehicle,
            &p.name.split('.').collect::<Vec<&str>>(),
            number(p.value),
            "fitted",
            &source(p),
        );
    }
    let mut name = format!("{}_fitted.toml", stem(&plan.vehicle));
    if written.iter().any(|(other, _)| *other == name) {
        name = format!("vehicle_{name}");
    }
    written.insert(0, (name, vehicle.to_string()));
    Ok(written)
}

fn parsed(plan: &Plan, text: &str) -> Result<DocumentMut, Problems> {
    // The model was loaded from it before.
    text.parse().map_err(|error| {
        problem(
            &plan.place,
            "vehicle",
            "",
            format!("the file cannot be changed: {error}"),
            "",
        )
        .into()
    })
}

fn stem(word: &str) -> String {
    Path::new(word).file_stem().map_or_else(
        || word.to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

/// A number with some significant digits, as short as it goes.
fn digits(x: f64, count: usize) -> String {
    format!("{x:.*e}", count - 1)
        .parse::<f64>()
        .map_or_else(|_| x.to_string(), |x| x.to_string())
}

fn number(x: f64) -> Value {
    Value::from(digits(x, DIGITS).parse::<f64>().unwrap_or(x))
}

/// The text of a value, bare or in a table; empty where there is none.
fn text_at(document: &DocumentMut, path: &[&str]) -> String {
    let mut item = document.as_item();
    for part in path {
        let Some(next) = item.get(part) else {
            return String::new();
        };
        item = next;
    }
    let inner = item.get("value").unwrap_or(item);
    inner.as_str().unwrap_or_default().to_owned()
}

/// Writes what the plan sets by `KEY=VALUE`; a file that it names lies beside the vehicle file.
fn assign(document: &mut DocumentMut, set: &str, plan: &Plan, folder: &Path) {
    let Some((key, text)) = set.split_once('=') else {
        return;
    };
    let mut item = Item::Value(
        text.trim()
            .parse::<Value>()
            .unwrap_or_else(|_| Value::from(text.trim())),
    );
    beside(&mut item, folder);
    let Ok(value) = item.into_value() else { return };
    let path: Vec<&str> = key.trim().split('.').map(str::trim).collect();
    put(
        document,
        &path,
        value,
        "assumed",
        &format!("set by {}", plan.file),
    );
}

/// Puts a value with its status and source at a path, keeping the comments around it. A note of the old value does not hold any more.
fn put(document: &mut DocumentMut, path: &[&str], value: Value, status: &str, source: &str) {
    let Some((last, tables)) = path.split_last() else {
        return;
    };
    let mut item = document.as_item_mut();
    for part in tables {
        if !item.is_table_like() {
            *item = Item::Table(Table::new());
        }
        let Some(table) = item.as_table_like_mut() else {
            return;
        };
        item = table.entry(part).or_insert_with(|| {
            let mut table = Table::new();
            table.set_implicit(true);
            Item::Table(table)
        });
    }
    if !item.is_table_like() {
        *item = Item::Table(Table::new());
    }
    let Some(table) = item.as_table_like_mut() else {
        return;
    };
    let mut told = InlineTable::new();
    told.insert("value", value);
    told.insert("status", Value::from(status));
    told.insert("source", Value::from(source));
    let mut told = Value::from(told);
    if let Some(old) = table.get(last).and_then(Item::as_value) {
        *told.decor_mut() = old.decor().clone();
    }
    table.insert(last, Item::Value(told));
}

/// A path as seen from anywhere, where there is such a file.
fn whole(folder: &Path, word: &str) -> String {
    std::fs::canonicalize(folder.join(word)).map_or_else(
        |_| word.to_owned(),
        |path| path.to_string_lossy().into_owned(),
    )
}

/// Makes the names of files beside the vehicle file whole paths, in all values below an item.
fn beside(item: &mut Item, folder: &Path) {
    let is_file = |text: &str| is_path(text) && !text.contains('\n') && folder.join(text).is_file();
    if let Some(text) = item.as_str().filter(|text| is_file(text)) {
        let path = whole(folder, text);
        if let Some(value) = item.as_value_mut() {
            let decor = value.decor().clone();
            *value = Value::from(path);
            *value.decor_mut() = decor;
        }
        return;
    }
    if let Some(table) = item.as_table_like_mut() {
        table.iter_mut().for_each(|(_, item)| beside(item, folder));
    }
}
