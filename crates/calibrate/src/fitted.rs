//! The vehicle file, and the fluid files, with the fitted values in them.
//!
//! A file keeps its form and comments. A fitted value gets the status `fitted`, the plan, the date and its standard error as its source.
//! Values that the plan sets get the status `assumed`. Paths in the vehicle file that are relative to it become
//! absolute, so that the fitted file may be in any folder.

use std::path::Path;

use toml_edit::{DocumentMut, InlineTable, Item, Table, TableLike, Value};

use super::outcome::{Outcome, Parameter};
use super::plan::{CalibrationPlan, FreeParameter, problem, stem};
use cvtcycle_config::setup::{Kind, NamedBy, Options, ParamSet, is_path, text_of};
use cvtcycle_config::{Acts, Override, ProblemKind, Problems, Target};

/// Significant digits of a fitted value, far beyond its standard error.
const DIGITS: usize = 7;

/// The fluids, and the keys under which the vehicle names them.
const FLUIDS: [(Target, &str); 2] = [
    (Target::Lubricant, "transmission_oil"),
    (Target::EngineOil, "engine_oil"),
];

/// Names and texts of the fitted files: the vehicle first. `date` is written with each value.
///
/// # Errors
/// A file that does not exist any more, or in which a value cannot be put.
pub fn files(
    plan: &CalibrationPlan,
    outcome: &Outcome,
    date: &str,
) -> Result<Vec<(String, String)>, Problems> {
    let (_, text, disk) = text_of(&plan.car.vehicle, Kind::Vehicle, NamedBy::File)?;
    let job = Job {
        plan,
        outcome,
        date,
        folder: &disk.folder,
    };
    let mut vehicle = parsed(plan, &text)?;
    make_absolute(vehicle.as_item_mut(), job.folder);
    let mut written = Vec::new();
    for (target, name) in FLUIDS {
        written.extend(job.fluid(&mut vehicle, target, name)?);
    }
    job.put_all(&mut vehicle, Target::Vehicle);
    let mut name = format!("{}_fitted.toml", stem(&plan.car.vehicle));
    if written.iter().any(|(other, _)| *other == name) {
        name = format!("vehicle_{name}");
    }
    written.insert(0, (name, vehicle.to_string()));
    let mut others: Vec<&String> = plan.parameters.iter().flat_map(|p| &p.vehicles).collect();
    others.retain(|vehicle| **vehicle != plan.car.vehicle);
    others.sort();
    others.dedup();
    for other in others {
        written.push(job.other(other)?);
    }
    Ok(written)
}

/// The values to be written.
struct Job<'a> {
    plan: &'a CalibrationPlan,
    outcome: &'a Outcome,
    date: &'a str,
    /// Folder of the vehicle file.
    folder: &'a Path,
}

impl Job<'_> {
    /// Puts the overrides and the fitted values of a file.
    fn put_all(&self, document: &mut DocumentMut, target: Target) {
        for by in self.plan.car.set.iter().filter(|by| by.target() == target) {
            self.put_override(document, by);
        }
        for (key, p) in self.fitted(&self.plan.car.vehicle, target) {
            self.put_fitted(document, key, p);
        }
    }

    /// Keys within a file of a vehicle with their fitted values.
    fn fitted<'b>(
        &'b self,
        vehicle: &'b str,
        target: Target,
    ) -> impl Iterator<Item = (&'b str, &'b Parameter)> {
        // The keys come first, in the order of the plan.
        let all = self.plan.parameters.iter().zip(&self.outcome.parameters);
        let own = all.filter(move |(free, _)| free.is_of(vehicle, self.plan));
        let keys = own.flat_map(move |(free, p)| {
            let keys = self.keys(vehicle, free).into_iter();
            keys.map(move |key| (Target::from_key(key), p))
        });
        keys.filter_map(move |((of, key), p)| (of == target).then_some((key, p)))
    }

    /// Keys of a parameter that a vehicle has. One that sets several is looked up in the car, since the file may inherit them.
    fn keys<'b>(&self, vehicle: &str, free: &'b FreeParameter) -> Vec<&'b str> {
        let mut keys: Vec<&str> = free.keys().collect();
        if free.also.is_empty() {
            return keys;
        }
        let options = match vehicle == self.plan.car.vehicle {
            true => self.plan.car.options(None),
            false => Options::default(),
        };
        // The model was loaded from it before.
        if let Ok(base) = ParamSet::load(vehicle, &options) {
            keys.retain(|key| base.param(key).is_ok());
        }
        keys
    }

    /// The file of another vehicle of the plan with its values; those of a fluid are in the files of the plan's own.
    fn other(&self, vehicle: &str) -> Result<(String, String), Problems> {
        let (_, text, disk) = text_of(vehicle, Kind::Vehicle, NamedBy::File)?;
        let mut document = parsed(self.plan, &text)?;
        make_absolute(document.as_item_mut(), &disk.folder);
        for (key, p) in self.fitted(vehicle, Target::Vehicle) {
            self.put_fitted(&mut document, key, p);
        }
        let name = format!("{}_fitted.toml", stem(vehicle));
        Ok((name, document.to_string()))
    }

    /// The file of a fluid with its values, named in the vehicle file; none if nothing of it changes.
    fn fluid(
        &self,
        vehicle: &mut DocumentMut,
        target: Target,
        name: &str,
    ) -> Result<Option<(String, String)>, Problems> {
        let (car, path) = (&self.plan.car, ["vehicle", name]);
        let given = match target {
            Target::EngineOil => &car.engine_oil,
            _ => &car.lubricant,
        };
        let is_set = car.set.iter().any(|by| by.target() == target);
        if !is_set && self.fitted(&car.vehicle, target).next().is_none() {
            if let Some(word) = given {
                let word = match is_path(word) {
                    true => absolute(Path::new(""), word),
                    false => word.clone(),
                };
                put(vehicle, &path, Value::from(word), "assumed", &self.set_by());
            }
            return Ok(None);
        }
        let word = given.clone().unwrap_or_else(|| text_at(vehicle, &path));
        let (_, text, _) = text_of(&word, Kind::Lubricant, NamedBy::File)?;
        let mut fluid = parsed(self.plan, &text)?;
        self.put_all(&mut fluid, target);
        let file = format!("{}_fitted.toml", stem(&word));
        let source = format!("{word} with values fitted to {}", self.plan.file);
        put(vehicle, &path, Value::from(file.clone()), "fitted", &source);
        Ok(Some((file, fluid.to_string())))
    }

    /// Puts a fitted value at its key.
    fn put_fitted(&self, document: &mut DocumentMut, key: &str, p: &Parameter) {
        let error = match p.standard_error {
            Some(x) => format!("standard error {} {}", rounded(x, 3), p.unit),
            None => "no standard error".to_owned(),
        };
        let error = error.trim_end_matches(" -");
        let source = format!("fitted to {} on {}; {error}", self.plan.file, self.date);
        let path: Vec<&str> = key.split('.').collect();
        let value = Value::from(rounded(p.value, DIGITS));
        put(document, &path, value, "fitted", &source);
    }

    /// Puts the value of an override of the plan.
    fn put_override(&self, document: &mut DocumentMut, by: &Override) {
        let (_, key) = Target::from_key(by.key());
        let path: Vec<&str> = key.split('.').map(str::trim).collect();
        let value = match by.acts() {
            Acts::Value => by.value().parse::<Value>().ok(),
            _ => by.number_over(number_at(document, &path)).map(Value::from),
        };
        let mut item = Item::Value(value.unwrap_or_else(|| Value::from(by.value())));
        make_absolute(&mut item, self.folder);
        let Ok(value) = item.into_value() else { return };
        put(document, &path, value, "assumed", &self.set_by());
    }

    fn set_by(&self) -> String {
        format!("set by {}", self.plan.file)
    }
}

fn parsed(plan: &CalibrationPlan, text: &str) -> Result<DocumentMut, Problems> {
    // The model was loaded from it before.
    text.parse().map_err(|error| {
        let message = format!("the file cannot be changed: {error}");
        problem(ProblemKind::Syntax, &plan.place, "vehicle", "", message, "").into()
    })
}

/// A number with some significant digits.
fn rounded(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits - 1).parse().unwrap_or(x)
}

/// A value, bare or in a table.
fn value_at<'d>(document: &'d DocumentMut, path: &[&str]) -> Option<&'d Item> {
    let item = path
        .iter()
        .try_fold(document.as_item(), |item, part| item.get(part))?;
    Some(item.get("value").unwrap_or(item))
}

/// The text of a value; empty where there is none.
fn text_at(document: &DocumentMut, path: &[&str]) -> String {
    let text = value_at(document, path).and_then(Item::as_str);
    text.unwrap_or_default().to_owned()
}

/// The number of a value.
fn number_at(document: &DocumentMut, path: &[&str]) -> Option<f64> {
    let item = value_at(document, path)?;
    item.as_float()
        .or_else(|| item.as_integer().map(|n| n as f64))
}

/// Puts a value with its status and source at a path, keeping the comments around it. A note of the old value does not hold any more.
fn put(document: &mut DocumentMut, path: &[&str], value: Value, status: &str, source: &str) {
    let Some((last, tables)) = path.split_last() else {
        return;
    };
    let mut item = document.as_item_mut();
    for part in tables {
        let Some(table) = as_table(item) else { return };
        item = table.entry(part).or_insert_with(|| {
            let mut table = Table::new();
            table.set_implicit(true);
            Item::Table(table)
        });
    }
    let Some(table) = as_table(item) else { return };
    let mut entry = InlineTable::new();
    entry.insert("value", value);
    entry.insert("status", Value::from(status));
    entry.insert("source", Value::from(source));
    let mut entry = Value::from(entry);
    if let Some(old) = table.get(last).and_then(Item::as_value) {
        *entry.decor_mut() = old.decor().clone();
    }
    table.insert(last, Item::Value(entry));
}

/// The table of an item, which becomes one if it is something else.
fn as_table(item: &mut Item) -> Option<&mut dyn TableLike> {
    if !item.is_table_like() {
        *item = Item::Table(Table::new());
    }
    item.as_table_like_mut()
}

/// The absolute path of a file; the word itself if there is no such file.
fn absolute(folder: &Path, word: &str) -> String {
    let path = std::fs::canonicalize(folder.join(word));
    path.map_or_else(
        |_| word.to_owned(),
        |path| path.to_string_lossy().into_owned(),
    )
}

/// Makes the paths of files in a folder absolute, in all values below an item.
fn make_absolute(item: &mut Item, folder: &Path) {
    let is_file =
        |text: &&str| is_path(text) && !text.contains('\n') && folder.join(text).is_file();
    let path = item
        .as_str()
        .filter(is_file)
        .map(|text| absolute(folder, text));
    if let Some((path, value)) = path.zip(item.as_value_mut()) {
        let decor = value.decor().clone();
        *value = Value::from(path);
        *value.decor_mut() = decor;
    } else if let Some(table) = item.as_table_like_mut() {
        for (_, inner) in table.iter_mut() {
            make_absolute(inner, folder);
        }
    }
}
