//! Values of keys for all cars, fitted to measured fuel, and what they are worth for groups that were left out.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FF-1 | residual r = 100 ln(F_computed/F_measured), per cent; the values are those of the least sum of r^2, between the ends of the keys' ranges | definition; a key's own range where none is given |
//! | FF-2 | each group is predicted with the values that are fitted to all others | source: cross-validation, Stone 1974 (CA-19) |
//! | FF-3 | figures of a car: the whole result of each test; where that was not measured, its parts | construction: a part is in the whole |

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use cvtcycle_calibrate::solve::{self, Options, Parameter, Residuals};
use cvtcycle_config::procedure::Procedure;
use cvtcycle_config::setup::{Param, ParamSet, catalogue};
use cvtcycle_config::{Override, Problem, Problems, did_you_mean};
use cvtcycle_output::progress::Progress;
use rayon::prelude::*;
use serde::Serialize;

use crate::driven::drive_test;
use crate::errors::ErrorStatistics;
use crate::{CarSets, Fleet, FleetCar};

/// Settings of the search: one start, as a key's range is far wider than what is likely.
const SEARCH: Options = Options {
    starts: 1,
    seed: 1,
    max_evaluations: 60,
    tolerance: 1e-5,
};

/// A key whose value is fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct FitKey {
    /// Dotted key.
    pub key: String,
    /// Ends of its values, in its unit.
    pub ends: [f64; 2],
}

impl FitKey {
    /// Reads `KEY`, within its own range, or `KEY=LOW..HIGH`.
    ///
    /// # Errors
    /// An unknown key, one that holds no number, and ends outside its range.
    pub fn read(text: &str) -> Result<FitKey, Problem> {
        let (key, ends) = match text.split_once('=') {
            Some((key, ends)) => (key.trim(), Some(ends.trim())),
            None => (text.trim(), None),
        };
        let info = catalogue::known_keys().iter().find(|info| info.key == key);
        let row = Override::number(key, 0.0).row();
        let (Some(_), Some(row)) = (info, row) else {
            let names = catalogue::known_names().iter().map(String::as_str);
            let hint = did_you_mean(key, names);
            return Err(Problem::unknown_key(format!("unknown key `{key}`"))
                .value(key)
                .hint(hint.unwrap_or_else(|| {
                    "`cvtcycle explain` lists the keys of vehicles".to_owned()
                })));
        };
        if !row.is_number() {
            return Err(
                Problem::wrong_type(format!("`{key}` holds no single number"))
                    .value(key)
                    .hint("name a key with a number"),
            );
        }
        let range = row.range();
        let own = [range.low(), range.high()];
        let wrong = |message: String, allowed: String| {
            Problem::invalid(message)
                .value(text)
                .allowed(allowed)
                .hint(format!("write {key}=LOW..HIGH, from what is likely"))
        };
        let ends = match ends {
            None => own,
            Some(ends) => {
                let both = ends.split_once("..").and_then(|(low, high)| {
                    Some([low.trim().parse().ok()?, high.trim().parse().ok()?])
                });
                both.ok_or_else(|| {
                    wrong(
                        format!("`{ends}` is no range"),
                        "two numbers with .. between them".to_owned(),
                    )
                })?
            }
        };
        let is_inside = own[0] <= ends[0] && ends[1] <= own[1];
        if !(ends[0] < ends[1] && ends[0].is_finite() && ends[1].is_finite() && is_inside) {
            let message = format!("{} to {} is no range of `{key}`", ends[0], ends[1]);
            return Err(wrong(message, range.to_string()));
        }
        Ok(FitKey {
            key: key.to_owned(),
            ends,
        })
    }
}

/// A group that was predicted by the others.
#[derive(Clone, Debug, Serialize)]
pub struct FoldErrors {
    /// Word of the group.
    pub word: String,
    /// Errors as the cars are made.
    pub as_made: ErrorStatistics,
    /// Errors with the values that are fitted to the others; none where that fit failed.
    pub predicted: Option<ErrorStatistics>,
    /// These values, in the order of the keys.
    pub values: Vec<f64>,
}

/// A fit.
#[derive(Clone, Debug, Serialize)]
pub struct FleetFit {
    /// Keys.
    pub keys: Vec<String>,
    /// Ends of their values.
    pub ends: Vec<[f64; 2]>,
    /// Values before: the mean of the cars that have the key.
    pub before: Vec<f64>,
    /// Values fitted to all cars.
    pub values: Vec<f64>,
    /// How the fit to all ended.
    pub end: String,
    /// Column whose groups were left out.
    pub column: String,
    /// Figures that were fitted.
    pub figures: Vec<String>,
    /// All cars as they are made.
    pub as_made: ErrorStatistics,
    /// All cars with the values that are fitted to them.
    pub fitted: ErrorStatistics,
    /// All cars, each group with the values that are fitted to the others.
    pub predicted: Option<ErrorStatistics>,
    /// By group.
    pub groups: Vec<FoldErrors>,
}

/// A measured figure of a car.
struct Observation<'a> {
    car: usize,
    id: &'a str,
    figure: String,
    measured: f64,
}

/// Residuals, or why there are none.
type Evaluated = Result<Vec<f64>, String>;

/// Cars with the places of the keys in them.
struct Model<'a> {
    cars: Vec<&'a FleetCar>,
    /// By car and key; `None` of a car without the key.
    places: Vec<Vec<Option<Param>>>,
    keys: &'a [FitKey],
    tests: &'a [Procedure],
    observations: Vec<Observation<'a>>,
    dt_s: f64,
    /// Residuals by the bits of the values: folds begin at common ones.
    known: Mutex<HashMap<Vec<u64>, Evaluated>>,
}

fn no(message: &str, hint: &str) -> Problems {
    Problem::missing(message).hint(hint).into()
}

impl<'a> Model<'a> {
    fn new(
        fleet: &'a Fleet,
        tests: &'a [Procedure],
        keys: &'a [FitKey],
        dt_s: f64,
    ) -> Result<Self, Problems> {
        let cars: Vec<&FleetCar> = fleet.cars.iter().collect();
        let of_car = |(k, car): (usize, &&'a FleetCar)| {
            let (id, car) = (car.id.as_str(), *car);
            let figures = tests.iter().flat_map(move |test| figures_of(car, test));
            figures.map(move |(figure, measured)| Observation {
                car: k,
                id,
                figure,
                measured,
            })
        };
        let observations: Vec<Observation> = cars.iter().enumerate().flat_map(of_car).collect();
        if observations.is_empty() {
            return Err(no(
                "there is nothing to fit to: no measured fuel of these tests",
                "a column is headed by a figure of a test, such as ftp75_l_per_100km",
            ));
        }
        let place = |car: &FleetCar, key: &FitKey| {
            let param = car.sets.as_ref()?.params.param(&key.key).ok();
            param.filter(Param::is_active)
        };
        let places = cars
            .iter()
            .map(|car| keys.iter().map(|key| place(car, key)).collect())
            .collect();
        Ok(Model {
            cars,
            places,
            keys,
            tests,
            observations,
            dt_s,
            known: Mutex::default(),
        })
    }

    /// Mean values of the cars, and the parameters that start from them.
    fn parameters(&self) -> Result<(Vec<f64>, Vec<Parameter>), Problems> {
        let mut found = Vec::new();
        for (k, key) in self.keys.iter().enumerate() {
            let of_car = |of: &Vec<Option<Param>>| of[k].as_ref().map(Param::base);
            let bases = self.places.iter().filter_map(of_car);
            let bases: Vec<f64> = bases.filter(|x| x.is_finite()).collect();
            if bases.is_empty() {
                let message = format!("no car has a value of `{}`", key.key);
                return Err(no(&message, "name a key that the cars have"));
            }
            let before = bases.iter().sum::<f64>() / bases.len() as f64;
            let [low, high] = key.ends;
            let start = before.clamp(low, high);
            found.push((before, Parameter::new(&key.key, start, low, high)));
        }
        Ok(found.into_iter().unzip())
    }

    /// Words of the groups in order, and the group of each observation.
    fn groups(&self, column: &str) -> (Vec<String>, Vec<usize>) {
        let word = |o: &Observation| {
            let word = self.cars[o.car].words.get(column);
            word.cloned().unwrap_or_default()
        };
        let words: Vec<String> = self.observations.iter().map(word).collect();
        let mut groups = words.clone();
        groups.sort();
        groups.dedup();
        let place = |word: &String| groups.binary_search(word).unwrap_or(0);
        let of_group = words.iter().map(place).collect();
        (groups, of_group)
    }

    /// Statistics of the errors of some observations.
    fn statistics(&self, residuals: &[f64], of: &dyn Fn(usize) -> bool) -> Option<ErrorStatistics> {
        let errors: Vec<(&str, f64)> = residuals
            .iter()
            .enumerate()
            .filter(|(k, r)| of(*k) && r.is_finite())
            .map(|(k, r)| (self.observations[k].id, 100.0 * (r / 100.0).exp_m1()))
            .collect();
        ErrorStatistics::new(&errors)
    }

    /// A car with the values in place of its own.
    fn changed(&self, car: usize, own: &CarSets, values: &[f64]) -> Result<CarSets, String> {
        let numbers: Vec<(&Param, f64)> = self.places[car]
            .iter()
            .zip(values)
            .filter_map(|(place, value)| Some((place.as_ref()?, *value)))
            .collect();
        let id = &self.cars[car].id;
        let said = |problems: Problems| {
            let first = problems.iter().next();
            let message = first.map_or("", |problem| problem.message.as_str());
            format!("{id}: {message}")
        };
        let mut changed = CarSets {
            params: own.params.with_numbers(&numbers).map_err(said)?,
            ..own.clone()
        };
        // The places are those of the car's own set.
        for params in changed.by_test.values_mut() {
            let with =
                |set: ParamSet, (param, value): &(&Param, f64)| set.with(param.key(), *value);
            *params = numbers
                .iter()
                .try_fold(params.clone(), with)
                .map_err(said)?;
        }
        Ok(changed)
    }

    /// Residuals of a car (FF-1).
    fn of_car(&self, car: usize, values: Option<&[f64]>) -> Result<Vec<f64>, String> {
        let Some(own) = &self.cars[car].sets else {
            return Err(format!("{}: was driven already", self.cars[car].id));
        };
        let changed = match values {
            Some(values) => self.changed(car, own, values)?,
            None => own.clone(),
        };
        let wanted = self.observations.iter().filter(|o| o.car == car);
        let mut fuel: HashMap<String, f64> = HashMap::new();
        for test in self.tests {
            let columns: Vec<String> = test.results.iter().map(|result| result.column()).collect();
            let is_wanted = wanted.clone().any(|o| columns.contains(&o.figure));
            if is_wanted {
                fuel.extend(drive_test(&changed, test, self.dt_s).fuel);
            }
        }
        wanted
            .map(|o| {
                let computed = fuel.get(&o.figure).copied().unwrap_or(f64::NAN);
                let r = 100.0 * (computed / o.measured).ln(); // FF-1
                match r.is_finite() {
                    true => Ok(r),
                    false => Err(format!("{}: {} cannot be driven", o.id, o.figure)),
                }
            })
            .collect()
    }

    fn residuals(&self, values: Option<&[f64]>) -> Result<Vec<f64>, String> {
        let parts: Vec<Vec<f64>> = (0..self.cars.len())
            .into_par_iter()
            .map(|car| self.of_car(car, values))
            .collect::<Result<_, _>>()?;
        Ok(parts.concat())
    }
}

impl Residuals for Model<'_> {
    fn count(&self) -> usize {
        self.observations.len()
    }

    fn at(&self, values: &[f64]) -> Result<Vec<f64>, String> {
        let bits: Vec<u64> = values.iter().map(|x| x.to_bits()).collect();
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known().get(&bits) {
            return found.clone();
        }
        let found = self.residuals(Some(values));
        known().insert(bits, found.clone());
        found
    }
}

/// Fits the values of some keys to the measured figures of a fleet, and predicts each group of a column with the values that are fitted to the others.
///
/// # Errors
/// A key that no car has, no measured figure, and a fit without a result.
pub fn fit(
    fleet: &Fleet,
    tests: &[Procedure],
    keys: &[FitKey],
    column: &str,
    dt_s: f64,
    progress: &dyn Progress,
) -> Result<FleetFit, Problems> {
    let model = Model::new(fleet, tests, keys, dt_s)?;
    let (before, parameters) = model.parameters()?;
    let (groups, of_group) = model.groups(column);
    let invalid = |why: String| Problems::from(Problem::invalid(why));
    let as_made = model.residuals(None).map_err(invalid)?;
    let found = solve::fit(&model, &parameters, &SEARCH, progress)
        .map_err(|failure| invalid(failure.to_string()))?;
    let folds = match groups.len() {
        0 | 1 => Vec::new(),
        _ => solve::leave_out(&model, &parameters, &of_group, &found, &SEARCH, progress),
    };
    let all = |residuals: &[f64]| model.statistics(residuals, &|_| true);
    let mut predicted = vec![f64::NAN; as_made.len()];
    for fold in &folds {
        let places = (0..as_made.len()).filter(|k| of_group[*k] == fold.group);
        for (k, r) in places.zip(&fold.residuals) {
            predicted[k] = *r; // FF-2
        }
    }
    let missing = || invalid("no error could be computed".to_owned());
    let by_group = groups.iter().enumerate().filter_map(|(g, word)| {
        let own = |k: usize| of_group[k] == g;
        let fold = folds.iter().find(|fold| fold.group == g);
        Some(FoldErrors {
            word: word.clone(),
            as_made: model.statistics(&as_made, &own)?,
            predicted: model.statistics(&predicted, &own),
            values: fold.map_or_else(Vec::new, |fold| fold.values.clone()),
        })
    });
    let mut figures: Vec<String> = model
        .observations
        .iter()
        .map(|o| o.figure.clone())
        .collect();
    figures.sort();
    figures.dedup();
    Ok(FleetFit {
        keys: keys.iter().map(|key| key.key.clone()).collect(),
        ends: keys.iter().map(|key| key.ends).collect(),
        before,
        groups: by_group.collect(),
        end: found.end.name().to_owned(),
        column: column.to_owned(),
        as_made: all(&as_made).ok_or_else(missing)?,
        fitted: all(&found.residuals).ok_or_else(missing)?,
        predicted: all(&predicted),
        values: found.values,
        figures,
    })
}

/// Measured figures of a car on a test (FF-3).
fn figures_of(car: &FleetCar, test: &Procedure) -> Vec<(String, f64)> {
    let of = |is_whole: bool| -> Vec<(String, f64)> {
        let results = test.results.iter();
        let results = results.filter(|result| result.phases.is_empty() == is_whole);
        let columns = results.map(|result| result.column());
        columns
            .filter_map(|column| {
                let measured = *car.measured.get(&column)?;
                Some((column, measured))
            })
            .collect()
    };
    match of(true) {
        whole if whole.is_empty() => of(false),
        whole => whole,
    }
}
