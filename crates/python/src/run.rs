//! Drives of cars through a cycle: summary, traces, plots, report.

use std::path::PathBuf;
use std::sync::Arc;

use cvtcycle::analysis::run::{RunQuestion, summary};
use cvtcycle::analysis::sensitivity::Named;
use cvtcycle::config::bounded::kept_steps;
use cvtcycle::config::cycle::Cycle as CoreCycle;
use cvtcycle::config::setup::{AMBIENT, Options, START, STEP, Setup, start_nodes, start_of_nodes};
use cvtcycle::config::{Problem, Problems};
use cvtcycle::model::drive::{
    Conditions, Outcome, Start, distance_counts, drive, fuel_map, litres_per_100km, litres_per_hour,
};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::output::History;
use cvtcycle::output::escape::json_text;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::FILE;
use cvtcycle::output::summary::{Driven, Settings, StartWord, Summary, name_run, start_on};
use cvtcycle::output::trace::columns_for;
use cvtcycle::report::charts::{self, PlotRun};
use cvtcycle::report::report;
use cvtcycle::report::run_files::{self, TraceFormat};
use cvtcycle::report::write::{Form, Target};
use pyo3::exceptions::{PyIndexError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::car::Car;
use crate::cycle::Cycle;
use crate::errors::{bad, number, refused};
use crate::job::{Interrupted, job};
use crate::table::{Table, TableColumn};

/// Number of steps, some ten milliseconds, from which a drive gets a thread of its own; below, starting one would cost more than it gains.
const MIN_STEPS_FOR_THREAD: usize = 20_000;

/// Arguments of a run.
#[derive(Clone, Debug)]
pub struct RunArguments {
    pub ambient_degc: f64,
    pub start: StartWord,
    pub conditions: Conditions,
}

impl RunArguments {
    /// Checks the arguments of a run. `start` is `soak`, `warm` or a temperature in degC.
    /// # Errors
    /// The exception of the argument.
    pub fn new(
        ambient_degc: f64,
        start: &Bound<'_, PyAny>,
        dt_s: f64,
        keep_rows: bool,
    ) -> PyResult<Self> {
        let ambient_degc = number("ambient_degc", ambient_degc, AMBIENT, "degC")?;
        let (state, start) = self::start(start)?;
        let conditions = Conditions {
            ambient_k: ambient_degc + ZERO_DEGC_K,
            start: state,
            max_dt_s: number("dt_s", dt_s, STEP, "s")?,
            keep_rows,
        };
        Ok(RunArguments {
            ambient_degc,
            start,
            conditions,
        })
    }
}

/// Parses a start: `soak`, `warm`, a temperature in degC, or those of nodes.
/// # Errors
/// The exception of the argument.
pub fn start(given: &Bound<'_, PyAny>) -> PyResult<(Start, StartWord)> {
    if let Ok(word) = given.extract::<String>() {
        let state = match word.as_str() {
            "auto" | "soak" => Start::Soak,
            "warm" => Start::Warm,
            nodes if nodes.contains('=') => {
                let found = start_nodes(nodes).map_err(refused)?;
                return Ok((Start::Nodes(found), StartWord::of_nodes(&found)));
            }
            _ => {
                let allowed = format!(
                    "auto, soak, warm, {}, or temperatures of nodes such as coolant=81,sump=60",
                    START.in_unit("degC")
                );
                return Err(bad("start", &word, &allowed, "this start is not known"));
            }
        };
        return Ok((state, StartWord::Word(word)));
    }
    if let Ok(nodes) = given.cast::<PyDict>() {
        let list: Vec<(String, f64)> = nodes
            .iter()
            .map(|(name, degc)| Ok((name.extract()?, degc.extract()?)))
            .collect::<PyResult<_>>()?;
        let found = start_of_nodes(&list).map_err(refused)?;
        return Ok((Start::Nodes(found), StartWord::of_nodes(&found)));
    }
    let degc = given.extract::<f64>();
    let degc = degc.map_err(|_| {
        PyTypeError::new_err(
            "start: 'soak', 'warm', a temperature in degC or temperatures of nodes, {'coolant': 81}",
        )
    })?;
    let degc = number("start", degc, START, "degC")?;
    Ok((Start::At(degc + ZERO_DEGC_K), StartWord::Degc(degc)))
}

/// Car with its drive.
#[derive(Debug)]
struct DrivenCar {
    name: String,
    word: String,
    options: Options,
    is_text: bool,
    setup: Arc<Setup>,
    outcome: Outcome,
}

/// Data of a run.
#[derive(Debug)]
struct RunData {
    arguments: RunArguments,
    cycle: Arc<CoreCycle>,
    price: bool,
    cars: Vec<DrivenCar>,
}

/// Run of cars through a cycle; the first is the subject.
#[pyclass(frozen)]
pub struct Run(Arc<RunData>);

/// Drives cars through a cycle.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the layer of Python names them")]
pub fn run(
    py: Python<'_>,
    cars: Vec<Py<Car>>,
    cycle: &Cycle,
    ambient_degc: f64,
    start: &Bound<'_, PyAny>,
    dt_s: f64,
    keep_rows: bool,
    price: bool,
) -> PyResult<Run> {
    let arguments = RunArguments::new(ambient_degc, start, dt_s, keep_rows)?;
    let Some(subject) = cars.first() else {
        return Err(bad("cars", "", "one car or more", "there is no car"));
    };
    let cycle = cycle.for_car(subject.get());
    let mut arguments = arguments;
    let start = (arguments.conditions.start, arguments.start);
    (arguments.conditions.start, arguments.start) = start_on(&cycle, start);
    let steps = |car: &Py<Car>| {
        let is_cvt = car.get().setup.transmission().is_cvt();
        cycle.trace_for(is_cvt).step_count(dt_s)
    };
    let steps = cars.iter().map(steps).fold(0, usize::saturating_add);
    if keep_rows {
        let named = |problem: Problem| problem.key("dt_s").value(dt_s.to_string());
        kept_steps(steps, dt_s).map_err(|problem| refused(named(problem)))?;
    }
    let setups: Vec<Arc<Setup>> = cars
        .iter()
        .map(|car| Arc::clone(&car.get().setup))
        .collect();
    let (own, conditions) = (Arc::clone(&cycle), arguments.conditions);
    let drive_all = move || -> Vec<Outcome> {
        let one = |setup: &Arc<Setup>| drive(setup, &own, &conditions);
        setups.iter().map(one).collect()
    };
    let outcomes = match steps < MIN_STEPS_FOR_THREAD {
        true => py.detach(drive_all),
        false => job(py, Some(1), Interrupted::Detaches, move |_| drive_all())?,
    };
    let mut driven: Vec<DrivenCar> = Vec::with_capacity(cars.len());
    for (car, outcome) in cars.iter().zip(outcomes) {
        let car = car.get();
        driven.push(DrivenCar {
            name: unique(&car.setup.name, &driven),
            word: car.word.clone(),
            options: car.options.clone(),
            is_text: car.is_text(),
            setup: Arc::clone(&car.setup),
            outcome,
        });
    }
    Ok(Run(Arc::new(RunData {
        arguments,
        cycle,
        price,
        cars: driven,
    })))
}

/// Makes a name unique among those before.
fn unique(name: &str, before: &[DrivenCar]) -> String {
    let taken = |name: &String| before.iter().any(|car| car.name.eq_ignore_ascii_case(name));
    let numbered = (2..).map(|n| format!("{name}_{n}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !taken(name)).unwrap_or_default()
}

impl RunData {
    fn driven(&self) -> Vec<Driven<'_>> {
        let mut driven = Vec::with_capacity(self.cars.len());
        for car in &self.cars {
            driven.push(Driven {
                name: &car.name,
                setup: &car.setup,
                outcome: &car.outcome,
            });
        }
        driven
    }

    fn summary(&self) -> Summary {
        let subject = &self.cars[0].options;
        let question = RunQuestion {
            cycle: &self.cycle,
            conditions: self.arguments.conditions,
            ambient_degc: self.arguments.ambient_degc,
            start: self.arguments.start.clone(),
            settings: Settings {
                dt_s: self.arguments.conditions.max_dt_s,
                formulation: subject.formulation.name().to_owned(),
                set: subject.set.iter().map(ToString::to_string).collect(),
                set_all: Vec::new(),
                strict: false,
            },
            price: self.price,
            has_unchanged: false,
            published: None,
        };
        summary(&question, &self.driven())
    }

    fn phases(&self) -> &[String] {
        match self.cycle.phases.is_empty() {
            true => std::slice::from_ref(&self.cycle.name),
            false => &self.cycle.phases,
        }
    }

    fn history(&self, car: &DrivenCar) -> History {
        let transmission = car.setup.transmission();
        let columns = columns_for(transmission.is_cvt(), &transmission.components());
        History::from_rows(&car.outcome.rows, &columns, self.phases())
    }

    /// Picture of one car, or of all.
    fn picture(&self, kind: &str, car: usize) -> Option<String> {
        let summary = self.summary();
        let histories: Vec<History> = self.cars.iter().map(|car| self.history(car)).collect();
        let plot_run = |k: usize| PlotRun {
            name: &self.cars[k].name,
            history: &histories[k],
            fuel_map: Some(fuel_map(&self.cars[k].setup)),
            group_fuel: charts::group_fuel(&summary.runs[k]),
            fuel_unit: summary.runs[k].over().unit(),
            fuel_energy_kj: summary.runs[k].fuel_energy_kj,
            published: charts::published_drive(&self.cars[k].name, &summary),
        };
        let picture = match kind {
            "driveline" => charts::driveline(&plot_run(car)),
            "pressure" if histories[car].is_cvt() => charts::pressure(&plot_run(car)),
            "temperatures" => charts::temperatures(&[plot_run(car)]),
            "losses" => charts::losses(&[plot_run(car)]),
            "operating_points" => charts::operating_points(&[plot_run(car)]),
            "fuel" => charts::fuel_bars(&(0..self.cars.len()).map(plot_run).collect::<Vec<_>>()),
            _ => return None,
        };
        Some(picture.svg)
    }

    /// Writes the files of `run --out` into a folder.
    fn write(
        &self,
        folder: &PathBuf,
        format: TraceFormat,
        force: bool,
        command: String,
    ) -> Result<Vec<PathBuf>, Problems> {
        if let Some(car) = self.cars.iter().find(|car| car.is_text) {
            let message = "files of a run name the files of its cars, and this car has none";
            let hint = "write the text into a file, and name that";
            return Err(Problem::invalid(message)
                .in_file(car.word.as_str())
                .hint(hint)
                .into());
        }
        let named = |car: &DrivenCar| Named {
            name: car.name.clone(),
            word: car.word.clone(),
            options: car.options.clone(),
        };
        let cars: Vec<(Named, &Setup)> = self
            .cars
            .iter()
            .map(|car| (named(car), &*car.setup))
            .collect();
        let mut dir = OutputDir::create(folder, force)?;
        let mut summary = self.summary();
        let conditions = &self.arguments.conditions;
        let mut record = run_files::record(command, &cars, &self.cycle, conditions, false)?;
        name_run(&mut summary, &mut record);
        run_files::write(&mut dir, format, &summary, &self.cycle, &self.driven())?;
        dir.put("summary.json", json_text(&summary)?)?;
        record.files = dir.sums().clone();
        dir.put(FILE, json_text(&record)?)?;
        Ok(dir.commit()?)
    }
}

#[pymethods]
impl Run {
    /// Names of the cars, subject first.
    #[getter]
    fn cars(&self) -> Vec<String> {
        self.0.cars.iter().map(|car| car.name.clone()).collect()
    }

    #[getter]
    fn has_trace(&self) -> bool {
        self.0.arguments.conditions.keep_rows
    }

    /// Fuel of the subject over the whole cycle, L/100 km; NaN below 10 m and below a mean speed of 1 km/h.
    #[getter]
    fn fuel_l_per_100km(&self) -> f64 {
        let car = &self.0.cars[0];
        let total = car.outcome.totals.total();
        if !distance_counts(total.distance_m, total.duration_s) {
            return f64::NAN;
        }
        litres_per_100km(
            total.fuel_kg,
            car.setup.engine().fuel_density_kg_m3,
            total.distance_m,
        )
    }

    /// Fuel of the subject over the whole cycle, L/h.
    #[getter]
    fn fuel_l_per_h(&self) -> f64 {
        let car = &self.0.cars[0];
        let total = car.outcome.totals.total();
        let density = car.setup.engine().fuel_density_kg_m3;
        litres_per_hour(total.fuel_kg, density, total.duration_s)
    }

    /// JSON of `run --json`.
    fn summary(&self, py: Python<'_>) -> PyResult<String> {
        let whole = Arc::clone(&self.0);
        let text = match whole.price {
            true => job(py, None, Interrupted::Detaches, move |_| {
                json_text(&whole.summary())
            })?,
            false => py.detach(|| json_text(&whole.summary())),
        };
        text.map_err(refused)
    }

    /// Trace of a car.
    fn trace(&self, py: Python<'_>, car: usize) -> PyResult<Table> {
        let whole = &self.0;
        let one = whole
            .cars
            .get(car)
            .ok_or_else(|| PyIndexError::new_err(car))?;
        Ok(py.detach(|| {
            let transmission = one.setup.transmission();
            let columns = columns_for(transmission.is_cvt(), &transmission.components());
            let column = |column| TableColumn::from_rows(column, &one.outcome.rows, whole.phases());
            Table::new(columns.into_iter().map(column).collect())
        }))
    }

    /// Picture as SVG.
    fn picture(&self, py: Python<'_>, kind: &str, car: usize) -> PyResult<String> {
        if car >= self.0.cars.len() {
            return Err(PyIndexError::new_err(car));
        }
        py.detach(|| self.0.picture(kind, car)).ok_or_else(|| {
            let allowed =
                "driveline, pressure (of a CVT), temperatures, losses, operating_points, fuel";
            bad("kind", kind, allowed, "this plot is not known for this car")
        })
    }

    /// Writes the files of a run into a folder, and returns their paths.
    fn write(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        format: &str,
        force: bool,
        command: String,
    ) -> PyResult<Vec<PathBuf>> {
        let format = TraceFormat::NAMES.iter().find(|(name, _)| *name == format);
        let (_, format) = format.ok_or_else(|| {
            bad(
                "format",
                "",
                "csv, parquet, both",
                "this format is not known",
            )
        })?;
        let (whole, format) = (Arc::clone(&self.0), *format);
        let write = move |_: &_| whole.write(&folder, format, force, command);
        job(py, None, Interrupted::Stops, write)?.map_err(refused)
    }

    /// Writes a report, and returns the paths of its files, the document first.
    fn report(
        &self,
        py: Python<'_>,
        file: PathBuf,
        cover: Option<String>,
        force: bool,
        command: String,
    ) -> PyResult<Vec<PathBuf>> {
        let whole = Arc::clone(&self.0);
        let make = move |_: &_| -> Result<Vec<PathBuf>, Problems> {
            let form = Form::from_path(&file).unwrap_or(Form::Html);
            let target = Target::new(&file, form, force)?;
            let no_folder = |error: std::io::Error| {
                Problem::invalid(format!("cannot make a temporary folder: {error}"))
            };
            let folder = tempfile::tempdir().map_err(no_folder)?;
            let run = folder.path().join("run");
            whole.write(&run, TraceFormat::Csv, false, command)?;
            let document = report(&[run], &[], cover.as_deref())?;
            Ok(target.write(&document)?)
        };
        job(py, None, Interrupted::Stops, make)?.map_err(refused)
    }
}
