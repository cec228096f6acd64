//! A row to a car, by the rules of `cvtcycle new`, in memory.

use std::collections::BTreeMap;
use std::collections::HashSet;

use cvtcycle_config::procedure::Procedure;
use cvtcycle_config::setup::new_car::{self, Answers};
use cvtcycle_config::setup::{ParamSet, catalogue};
use cvtcycle_config::{Override, Problem, Problems, did_you_mean};
use cvtcycle_model::transmission::Transmission;
use rayon::prelude::*;

use crate::map::{ColumnMap, WORDS, is_option};
use crate::setting::Setting;
use crate::sheet::{Row, Sheet};
use crate::{Fleet, Refused};

/// Values of a car for its drives.
#[derive(Clone, Debug)]
pub struct CarSets {
    /// Values of the car.
    pub params: ParamSet,
    /// For tests that give it options of their own, those values; the test's factor on the road load is then in them.
    pub by_test: BTreeMap<String, ParamSet>,
    /// Of a car with a CVT that is a pair: its twin by the rules of TW-1 to TW-4.
    pub twin: Option<ParamSet>,
}

/// Numbers of a car by which errors are compared.
#[derive(Clone, Copy, Debug)]
pub struct CarFacts {
    /// True with a CVT.
    pub is_cvt: bool,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Displacement of the engine, m3.
    pub displacement_m3: f64,
    /// Engine speed over road speed in the highest ratio, rad/m.
    pub top_rad_m: f64,
}

impl CarFacts {
    fn of(params: &ParamSet) -> Self {
        let vehicle = params.vehicle();
        let overall = match vehicle.transmission() {
            Transmission::Cvt(cvt) => cvt.ratio.high * cvt.final_drive.ratio,
            Transmission::Manual(manual) => manual.overall.last().copied().unwrap_or(f64::NAN),
        };
        let road = &vehicle.road_load.base;
        CarFacts {
            is_cvt: vehicle.transmission().is_cvt(),
            mass_kg: road.mass_kg,
            displacement_m3: vehicle.engine().displacement_m3,
            top_rad_m: overall / road.wheel_radius_m,
        }
    }
}

/// A car of a table.
#[derive(Clone, Debug)]
pub struct FleetCar {
    /// Name.
    pub id: String,
    /// Line of its row.
    pub line: u64,
    /// Numbers by which its errors are compared.
    pub facts: CarFacts,
    /// Values for its drives; `None` after [`Fleet::driven`], as they take half a megabyte a car.
    pub sets: Option<CarSets>,
    /// Doubts about its numbers.
    pub doubts: Vec<String>,
    /// Measured figures by column, L/100 km.
    pub measured: BTreeMap<String, f64>,
    /// Name of the car that it is a pair with; empty for none.
    pub pair: String,
    /// Words of the columns by which errors are grouped.
    pub words: BTreeMap<String, String>,
}

/// Use of the columns of a table.
struct Columns<'a> {
    map: &'a ColumnMap,
    sheet: &'a Sheet,
    /// Templates of the options.
    options: Vec<(String, String)>,
    /// Columns headed by keys of a vehicle file.
    keys: Vec<usize>,
    /// Columns of measured figures.
    measured: Vec<usize>,
    groups: Vec<(String, usize)>,
    id: usize,
    pair: Option<usize>,
    tests: &'a [Procedure],
    set: &'a [Setting],
}

/// Index of the column with the names of the cars.
fn id_column(sheet: &Sheet, map: &ColumnMap) -> Result<usize, Problems> {
    sheet.column(&map.id).ok_or_else(|| {
        let problem = Problem::missing(format!(
            "the table has no column `{}` with the names of the cars",
            map.id
        ))
        .in_file(&sheet.file);
        let hint = did_you_mean(&map.id, sheet.names.iter().map(String::as_str));
        problem
            .allowed(sheet.names.join(", "))
            .hint(hint.unwrap_or_else(|| {
                "a row is a car; a map names the columns of other tables".to_owned()
            }))
            .into()
    })
}

/// Makes the cars of a table; `each` takes every one as soon as it is made, in parallel.
pub(crate) fn fleet<T: Send>(
    sheet: &Sheet,
    map: &ColumnMap,
    tests: &[Procedure],
    set: &[Setting],
    each: impl Fn(&mut FleetCar) -> T + Sync,
) -> Result<(Fleet, Vec<T>), Problems> {
    let id = id_column(sheet, map)?;
    let known_keys: HashSet<&str> = catalogue::known_names()
        .iter()
        .map(String::as_str)
        .collect();
    let is_key = |name: &str| name.contains('.') && known_keys.contains(name);
    let results: HashSet<String> = tests
        .iter()
        .flat_map(|test| test.results.iter().map(|result| result.column()))
        .collect();
    let all_results: HashSet<String> = Procedure::names()
        .into_iter()
        .filter_map(|name| Procedure::open(name).ok())
        .flat_map(|test| test.results.into_iter().map(|result| result.column()))
        .collect();
    let indices = |is: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..sheet.names.len())
            .filter(|k| is(&sheet.names[*k]))
            .collect()
    };
    let columns = Columns {
        options: map.options_of(&sheet.names).into_iter().collect(),
        keys: indices(&is_key),
        measured: indices(&|name| results.contains(name)),
        groups: map
            .groups
            .iter()
            .filter_map(|name| Some((name.clone(), sheet.column(name)?)))
            .collect(),
        pair: map.pair.as_ref().and_then(|name| sheet.column(name)),
        map,
        sheet,
        id,
        tests,
        set,
    };
    let is_set = |name: &str| {
        let column = sheet.column(name);
        column.is_some_and(|k| set.iter().any(|setting| setting.reads(k)))
    };
    let is_known =
        |name: &str| map.knows(name) || is_key(name) || all_results.contains(name) || is_set(name);
    let unknown = unknown_columns(&sheet.names, &is_known);
    let mut seen: HashSet<&str> = HashSet::new();
    let is_new: Vec<bool> = sheet
        .rows
        .iter()
        .map(|row| seen.insert(row.cells[id].as_str()))
        .collect();
    let rows: Vec<(usize, (&Row, bool))> = sheet.rows.iter().zip(is_new).enumerate().collect();
    let made: Vec<Result<(FleetCar, T), Refused>> = rows
        .into_par_iter()
        .map(|(index, (row, is_new))| {
            let refuse = |reason: String| Refused {
                line: row.line,
                id: row.cells[id].clone(),
                reason,
            };
            match row.cells[id].as_str() {
                "" => Err(refuse(format!("{}: the car has no name", map.id))),
                _ if !is_new => Err(refuse(format!("{}: an earlier row has this name", map.id))),
                _ => {
                    let mut car = columns.car(index, row).map_err(refuse)?;
                    let taken = each(&mut car);
                    Ok((car, taken))
                }
            }
        })
        .collect();
    let mut all = Vec::new();
    let mut fleet = Fleet {
        cars: Vec::new(),
        refused: sheet.refused.clone(),
        unknown,
        groups: columns
            .groups
            .iter()
            .map(|(name, _)| name.clone())
            .collect(),
    };
    for car in made {
        match car {
            Ok((car, taken)) => {
                fleet.cars.push(car);
                all.push(taken);
            }
            Err(refused) => fleet.refused.push(refused),
        }
    }
    fleet.refused.sort_by_key(|refused| refused.line);
    Ok((fleet, all))
}

/// Columns that nothing reads, each with the near names.
fn unknown_columns(names: &[String], is_known: &dyn Fn(&str) -> bool) -> Vec<(String, String)> {
    let options = new_car::NUMBERS.iter().map(|(name, _)| *name).chain(WORDS);
    let keys = catalogue::known_names().iter().map(String::as_str);
    let known: Vec<&str> = keys.chain(options).collect();
    let near = |name: &String| {
        let others = known.iter().copied().filter(|known| known != name);
        did_you_mean(name, others).unwrap_or_default()
    };
    let unknown = names.iter().filter(|name| !is_known(name));
    unknown.map(|name| (name.clone(), near(name))).collect()
}

impl Columns<'_> {
    fn car(&self, index: usize, row: &Row) -> Result<FleetCar, String> {
        let id = row.cells[self.id].clone();
        let options: Vec<(&str, &str)> = self
            .options
            .iter()
            .map(|(option, template)| (option.as_str(), template.as_str()))
            .collect();
        let answers = self.answers(row, &options)?;
        let set = self.overrides(index, row, &answers)?;
        let params = made(&answers, &set)?;
        let pair = self.pair.map_or("", |k| row.cells[k].as_str());
        let twin = match pair {
            "" => None,
            _ => new_car::twin_set(&answers, &set).map_err(|problems| sentence(&problems))?,
        };
        let mut by_test = BTreeMap::new();
        for test in self.tests {
            let Some(own) = self.map.tests.get(&test.name) else {
                continue;
            };
            let own: Vec<(&str, &str)> = own
                .iter()
                .map(|(option, template)| (option.as_str(), template.as_str()))
                .collect();
            let all: Vec<(&str, &str)> = options
                .iter()
                .filter(|(option, _)| own.iter().all(|(other, _)| other != option))
                .copied()
                .chain(own.iter().copied())
                .collect();
            // A row without all of them is driven with the test's factor.
            let mut filled = true;
            for (_, template) in &own {
                filled &= self
                    .map
                    .fill(template, &|name| self.cell(row, name))?
                    .is_some();
            }
            if filled {
                by_test.insert(test.name.clone(), made(&self.answers(row, &all)?, &set)?);
            }
        }
        let mut measured = BTreeMap::new();
        for k in &self.measured {
            let (name, text) = (&self.sheet.names[*k], row.cells[*k].as_str());
            match text.parse::<f64>() {
                _ if text.is_empty() => {}
                Ok(litres) if (0.5..=60.0).contains(&litres) => {
                    measured.insert(name.clone(), litres);
                }
                Ok(_) => {
                    return Err(format!(
                        "{name}: {text} is outside 0.5 to 60 L/100 km: is it in another unit?"
                    ));
                }
                Err(_) => {
                    return Err(format!(
                        "{name}: `{text}` is no number; write it with a decimal point, or leave the cell empty"
                    ));
                }
            }
        }
        Ok(FleetCar {
            doubts: params.setup().doubts(),
            line: row.line,
            pair: pair.to_owned(),
            words: self
                .groups
                .iter()
                .map(|(name, k)| (name.clone(), row.cells[*k].clone()))
                .collect(),
            id,
            facts: CarFacts::of(&params),
            sets: Some(CarSets {
                params,
                by_test,
                twin,
            }),
            measured,
        })
    }

    fn cell(&self, row: &Row, name: &str) -> Option<String> {
        self.sheet.column(name).map(|k| row.cells[k].clone())
    }

    /// The options of `new` that a row gives.
    fn answers(&self, row: &Row, options: &[(&str, &str)]) -> Result<Answers, String> {
        let (mut text, mut empty) = (String::new(), Vec::new());
        for (option, template) in options {
            if let Some(value) = self.map.fill(template, &|name| self.cell(row, name))? {
                debug_assert!(is_option(option), "checked with the map");
                text += &format!(
                    "{} = {}\n",
                    option.replace('-', "_"),
                    toml::Value::String(value)
                );
            } else {
                empty.push(*option);
            }
        }
        let has = |option: &str| {
            let is_option = |(own, _): &(&str, &str)| *own == option;
            options.iter().any(is_option) && !empty.contains(&option)
        };
        let is_needed = |option: &&&str| match **option {
            _ if has("like") => false,
            "mass" => true,
            "displacement" | "power" => !has("engine-like"),
            _ => false,
        };
        if let Some(option) = empty.iter().find(is_needed) {
            return Err(format!(
                "{option}: the cell is empty, and the value of a class is that of another car; fill it, or remove the row"
            ));
        }
        let mut answers = Answers {
            title: row.cells[self.id].clone(),
            ..Answers::default()
        };
        answers
            .add_file(&self.sheet.file, &text)
            .map_err(|problems| sentence(&problems))?;
        // The lines of that text are none of the table.
        answers.places.clear();
        Ok(answers)
    }

    /// Values of a row: the settings first, then the columns that are keys.
    fn overrides(
        &self,
        index: usize,
        row: &Row,
        answers: &Answers,
    ) -> Result<Vec<Override>, String> {
        let is_manual = answers
            .gearbox
            .as_deref()
            .is_some_and(|name| name.contains("manual"));
        let mut set = Vec::new();
        for setting in self.set.iter().filter(|setting| setting.is_of(!is_manual)) {
            set.extend(setting.in_row(self.sheet, index)?);
        }
        for k in &self.keys {
            let text = row.cells[*k].as_str();
            if !text.is_empty() {
                let name = &self.sheet.names[*k];
                set.push(
                    Override::new(name, text)
                        .map_err(|problem| format!("{name}: {}", problem.message))?,
                );
            }
        }
        Ok(set)
    }
}

fn made(answers: &Answers, set: &[Override]) -> Result<ParamSet, String> {
    new_car::param_set(answers, set).map_err(|problems| sentence(&problems))
}

/// All problems of a row in one line: column or key, value, message, what is allowed.
fn sentence(problems: &Problems) -> String {
    let one = |problem: &Problem| {
        let mut text = match problem.key.as_str() {
            "" => problem.message.clone(),
            key => format!("{key}: {}", problem.message),
        };
        if !problem.value.is_empty() {
            text += &format!(", not {}", problem.value);
        }
        if !problem.allowed.is_empty() {
            text += &format!(" (allowed: {})", problem.allowed);
        }
        if !problem.hint.is_empty() {
            text += &format!("; {}", problem.hint);
        }
        text
    };
    let all: Vec<String> = problems.iter().map(one).collect();
    all.join(" | ").replace(['\n', '\r'], " ")
}
