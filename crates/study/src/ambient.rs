//! The answer of a matrix of ambient temperatures and starts: fuel, the subject's excess, end temperatures, warm-up.

use serde::Serialize;

use super::outputs::{EXCESS, FUEL, phase_excess, phase_fuel};
use super::plan::{Design, FactorValue, FactorValues};
use super::study_table::StudyTable;
use cvtcycle_config::Problem;

/// The matrix. Numbers stand by car, start and ambient; NaN where a run has none.
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
    /// Whose.
    pub name: String,
    /// Temperature, degC.
    pub degc: Vec<Vec<Vec<f64>>>,
}

/// A node's temperature over time in one run.
#[derive(Clone, Debug)]
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
fn axes(frame: &StudyTable) -> Option<(Vec<f64>, Vec<String>)> {
    let plan = &frame.outline.plan;
    let [ambient, start] = &plan.factors[..] else {
        return None;
    };
    if plan.design != Design::Grid || ambient.key != "ambient_degc" || start.key != "start" {
        return None;
    }
    let (FactorValues::List(degc), FactorValues::List(starts)) = (&ambient.values, &start.values)
    else {
        return None;
    };
    let number = |value: &FactorValue| match value {
        FactorValue::Number(x) => Some(*x),
        FactorValue::Word(_) => None,
    };
    let word = |value: &FactorValue| match value {
        FactorValue::Number(x) => format!("{x} degC"),
        FactorValue::Word(word) => word.to_string(),
    };
    Some((
        degc.iter().map(number).collect::<Option<_>>()?,
        starts.iter().map(word).collect(),
    ))
}

/// The matrix of a study; none if it is something else.
///
/// # Errors
/// A part that cannot be read.
pub fn matrix(frame: &StudyTable) -> Result<Option<Matrix>, Problem> {
    let Some((ambient_degc, starts)) = axes(frame) else {
        return Ok(None);
    };
    let outline = frame.outline;
    let cars = outline.cars.len();
    // Points run over the starts first: the last factor of a grid is the fastest.
    let by = |column: &str, car: usize| -> Result<Vec<Vec<f64>>, Problem> {
        let numbers = frame.all_numbers(column, car)?;
        let at = |start: usize, ambient: usize| {
            numbers
                .get(ambient * starts.len() + start)
                .copied()
                .unwrap_or(f64::NAN)
        };
        Ok((0..starts.len())
            .map(|s| (0..ambient_degc.len()).map(|a| at(s, a)).collect())
            .collect())
    };
    let all = |column: &str, from: usize| {
        (from..cars)
            .map(|car| by(column, car))
            .collect::<Result<Vec<_>, _>>()
    };
    let mut fuel = vec![FuelPart {
        name: "total".into(),
        l_per_100km: all(FUEL, 0)?,
        excess_percent: all(EXCESS, 1)?,
    }];
    for phase in &outline.phases {
        fuel.push(FuelPart {
            name: phase.clone(),
            l_per_100km: all(&phase_fuel(phase), 0)?,
            excess_percent: all(&phase_excess(phase), 1)?,
        });
    }
    let mut ends = Vec::new();
    for (name, column) in [
        ("transmission sump", "end_transmission_sump_degc"),
        ("engine oil", "end_engine_oil_degc"),
        ("coolant", "end_coolant_degc"),
    ] {
        ends.push(EndPart {
            name: name.into(),
            degc: all(column, 0)?,
        });
    }
    Ok(Some(Matrix {
        cars: outline.cars.clone(),
        starts,
        ambient_degc,
        fuel,
        ends,
    }))
}

/// Warm-up of every run, where the study has kept traces.
///
/// # Errors
/// A part that cannot be read.
pub fn warm_ups(frame: &StudyTable, matrix: &Matrix) -> Result<Vec<WarmUp>, Problem> {
    let mut list: Vec<WarmUp> = Vec::new();
    let columns = ["time_s", "transmission_sump_degc", "engine_oil_degc"];
    frame.each_trace(&columns, |points, cars, values| {
        let [
            super::table::Values::Number(time),
            super::table::Values::Number(sump),
            super::table::Values::Number(oil),
        ] = values
        else {
            return;
        };
        for k in 0..points.len() {
            let point = usize::try_from(points[k]).unwrap_or(0);
            let car = matrix
                .cars
                .iter()
                .position(|name| **name == *cars[k])
                .unwrap_or(0);
            let (ambient, start) = (point / matrix.starts.len(), point % matrix.starts.len());
            let same = list
                .last()
                .is_some_and(|run| (run.car, run.start, run.ambient) == (car, start, ambient));
            if !same {
                list.push(WarmUp {
                    car,
                    start,
                    ambient,
                    time_s: Vec::new(),
                    sump_degc: Vec::new(),
                    engine_oil_degc: Vec::new(),
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
