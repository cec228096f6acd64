//! The answer of a matrix of ambient temperatures and starts: fuel, the subject's excess, end temperatures, warm-up.

use serde::Serialize;

use super::study_table::StudyTable;
use crate::execute::outputs::{EXCESS, FUEL, phase_excess, phase_fuel};
use crate::plan::{Design, FactorValue, Plan};
use crate::store::Values;
use cvtcycle_config::Problem;

/// The matrix. Numbers by car, start and ambient; NaN where a run has none.
#[derive(Clone, Debug, Serialize)]
pub struct Matrix {
    /// Names of the cars, the subject first.
    pub cars: Vec<String>,
    /// Starts as the plan names them.
    pub starts: Vec<String>,
    /// Ambient temperatures, degC.
    pub ambient_degc: Vec<f64>,
    /// Whole cycle first, then each phase.
    pub fuel: Vec<FuelPart>,
    /// Temperatures at the end.
    pub ends: Vec<EndPart>,
}

/// Fuel in a part of the cycle.
#[derive(Clone, Debug, Serialize)]
pub struct FuelPart {
    /// `total`, or the phase.
    pub name: String,
    /// Fuel, L/100 km.
    pub l_per_100km: Vec<Vec<Vec<f64>>>,
    /// Fuel of the subject over that of each baseline, per cent.
    pub excess_percent: Vec<Vec<Vec<f64>>>,
}

/// A temperature at the end.
#[derive(Clone, Debug, Serialize)]
pub struct EndPart {
    /// Name of the part.
    pub name: String,
    /// Temperature, degC.
    pub degc: Vec<Vec<Vec<f64>>>,
}

/// A node's temperature over time in one run.
#[derive(Clone, Debug, Default)]
pub struct WarmUp {
    /// Index of the car.
    pub car: usize,
    /// Index of the start.
    pub start: usize,
    /// Index of the ambient temperature.
    pub ambient: usize,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Transmission oil in the sump, degC.
    pub sump_degc: Vec<f64>,
    /// Engine oil, degC.
    pub engine_oil_degc: Vec<f64>,
}

/// The axes of a study that is such a matrix: ambient temperatures and starts, in this order.
fn axes(plan: &Plan) -> Option<(Vec<f64>, Vec<String>)> {
    let [ambient, start] = &plan.factors[..] else {
        return None;
    };
    let is_matrix = plan.design == Design::Grid
        && (ambient.key.as_str(), start.key.as_str()) == ("ambient_degc", "start");
    let word = |value: &FactorValue| match value {
        FactorValue::Number(x) => format!("{x} degC"),
        FactorValue::Word(word) => word.to_string(),
    };
    let (degc, starts) = (ambient.values.list(), start.values.list());
    if !is_matrix || degc.is_empty() || starts.is_empty() {
        return None;
    }
    let degc = degc
        .iter()
        .map(FactorValue::number)
        .collect::<Option<_>>()?;
    Some((degc, starts.iter().map(word).collect()))
}

/// The matrix of a study; none if it is something else.
///
/// # Errors
/// A part that cannot be read.
pub fn matrix(frame: &StudyTable) -> Result<Option<Matrix>, Problem> {
    let outline = frame.outline;
    let Some((ambient_degc, starts)) = axes(&outline.plan) else {
        return Ok(None);
    };
    // Points run over the starts first: the last factor of a grid is the fastest.
    let by = |column: &str, car: usize| -> Result<Vec<Vec<f64>>, Problem> {
        let numbers = frame.all_numbers(column, car)?;
        let at = |point: usize| numbers.get(point).copied().unwrap_or(f64::NAN);
        let of_start = |start: usize| {
            let points = (0..ambient_degc.len()).map(|ambient| ambient * starts.len() + start);
            points.map(at).collect()
        };
        Ok((0..starts.len()).map(of_start).collect())
    };
    let all = |column: &str, from: usize| {
        let cars = from..outline.cars.len();
        cars.map(|car| by(column, car))
            .collect::<Result<Vec<_>, _>>()
    };
    let fuel = |name: &str, fuel: &str, excess: &str| {
        Ok(FuelPart {
            name: name.to_owned(),
            l_per_100km: all(fuel, 0)?,
            excess_percent: all(excess, 1)?,
        })
    };
    let end = |(name, column): (&str, &str)| {
        Ok(EndPart {
            name: name.to_owned(),
            degc: all(column, 0)?,
        })
    };
    let phases = outline.phases.iter();
    let phases = phases.map(|phase| fuel(phase, &phase_fuel(phase), &phase_excess(phase)));
    let ends = [
        ("transmission sump", "end_transmission_sump_degc"),
        ("engine oil", "end_engine_oil_degc"),
        ("coolant", "end_coolant_degc"),
    ];
    Ok(Some(Matrix {
        cars: outline.cars.clone(),
        fuel: [fuel("total", FUEL, EXCESS)]
            .into_iter()
            .chain(phases)
            .collect::<Result<_, Problem>>()?,
        ends: ends.into_iter().map(end).collect::<Result<_, Problem>>()?,
        starts: starts.clone(),
        ambient_degc: ambient_degc.clone(),
    }))
}

/// Warm-up of every run, where the study has kept traces.
///
/// # Errors
/// A part that cannot be read.
pub fn warm_ups(
    frame: &StudyTable,
    matrix: &Matrix,
    names: &[String],
) -> Result<Vec<WarmUp>, Problem> {
    let mut list: Vec<WarmUp> = Vec::new();
    let columns = ["time_s", "transmission_sump_degc", "engine_oil_degc"];
    frame.each_trace(&columns, |points, cars, values| {
        let [
            Values::Number(time),
            Values::Number(sump),
            Values::Number(oil),
        ] = values
        else {
            return;
        };
        for k in 0..points.len() {
            let point = usize::try_from(points[k]).unwrap_or(0);
            let is_car = |name: &String| **name == *cars[k];
            let Some(car) = names.iter().position(is_car) else {
                continue;
            };
            let (ambient, start) = (point / matrix.starts.len(), point % matrix.starts.len());
            let of_run = (car, start, ambient);
            if list
                .last()
                .is_none_or(|run| (run.car, run.start, run.ambient) != of_run)
            {
                list.push(WarmUp {
                    car,
                    start,
                    ambient,
                    ..WarmUp::default()
                });
            }
            if let Some(run) = list.last_mut() {
                run.time_s.push(time[k]);
                run.sump_degc.push(sump[k]);
                run.engine_oil_degc.push(oil[k]);
            }
        }
    })?;
    Ok(list)
}
