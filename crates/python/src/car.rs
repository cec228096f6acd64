//! Cars: a vehicle file with its fluids and changes, validated.

use std::path::PathBuf;
use std::sync::Arc;

use cvtcycle::analysis::accelerate::{
    AXLE_SHARE, Conditions, DRIVEN, GRADE_PERCENT, GRIP, HEIGHT_OVER_BASE, SHIFT_S, SPEED_KMH,
    STEP_S, Span, times, usual_grip, usual_spans,
};
use cvtcycle::analysis::answer::{HEARD_RPM, Question, drive, prepare, shipped_levers};
use cvtcycle::config::setup::{
    self, AMBIENT, Disk, NamedBy, Options, ParamSet, STEP, Setup, baseline_of,
};
use cvtcycle::config::{Override, Problem, Problems};
use cvtcycle::explain::key_json;
use cvtcycle::model::drive::{Grip, Start};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::thermal::{NODES, StartTemperatures};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::escape::json_text;
use cvtcycle::output::progress::NoProgress;
use cvtcycle::study::plan::Base;
use pyo3::prelude::*;
use serde_json::Value;

use crate::errors::{bad, number, refused};

/// Text of a vehicle without a file.
#[derive(Clone, Debug)]
struct Source {
    text: String,
    folder: PathBuf,
    is_twin: bool,
}

/// Validated car.
#[pyclass(frozen)]
pub struct Car {
    pub setup: Arc<Setup>,
    /// Values of the car, kept so that changing them again reads no file.
    pub params: ParamSet,
    /// Name or path of its file, or the name of its text in problems.
    pub word: String,
    pub options: Options,
    source: Option<Source>,
}

/// Looks up a belt model.
/// # Errors
/// The exception of the argument.
pub fn formulation(name: &str) -> PyResult<Formulation> {
    Formulation::named(name).ok_or_else(|| {
        let names = Formulation::NAMES.map(|(name, _)| name).join(", ");
        bad("formulation", name, &names, "this formulation is not known")
    })
}

fn options(
    set: &[String],
    (lubricant, engine_oil): (Option<String>, Option<String>),
    named: &str,
) -> PyResult<Options> {
    Ok(Options {
        lubricant,
        engine_oil,
        set: Override::parse_all(set).map_err(refused)?,
        formulation: formulation(named)?,
        named_by: NamedBy::Caller,
    })
}

impl Car {
    fn load(word: String, options: Options, source: Option<Source>) -> Result<Self, Problems> {
        let params = match &source {
            None => ParamSet::load(&word, &options)?,
            Some(source) => {
                let read = match source.is_twin {
                    true => ParamSet::read_twin,
                    false => ParamSet::read,
                };
                read(&word, &source.text, source.files(), &options)?
            }
        };
        Ok(Car {
            setup: Arc::new(params.setup()),
            params,
            word,
            options,
            source,
        })
    }

    /// Problem of an operation that needs a car with a file.
    pub fn needs_file_problem(&self, message: &str) -> Problem {
        let hint = "write the text into a file, and name that";
        Problem::invalid(message)
            .in_file(self.word.as_str())
            .hint(hint)
    }

    /// True for a car read from a text.
    pub fn is_text(&self) -> bool {
        self.source.is_some()
    }
}

impl Source {
    fn files(&self) -> Box<Disk> {
        Box::new(Disk {
            folder: self.folder.clone(),
        })
    }
}

#[pymethods]
impl Car {
    #[new]
    #[pyo3(signature = (word, set, lubricant=None, engine_oil=None, formulation="smooth"))]
    fn new(
        py: Python<'_>,
        word: PathBuf,
        set: Vec<String>,
        lubricant: Option<String>,
        engine_oil: Option<String>,
        formulation: &str,
    ) -> PyResult<Self> {
        let options = options(&set, (lubricant, engine_oil), formulation)?;
        let word = word.to_string_lossy().into_owned();
        py.detach(|| Car::load(word, options, None))
            .map_err(refused)
    }

    /// Full-throttle times, the JSON of `accelerate --json` without its manifest; the usual spans without a speed at the end.
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn accelerate(
        &self,
        py: Python<'_>,
        speeds_kmh: Option<(f64, f64)>,
        grip: Option<f64>,
        driven: &str,
        axle_share: Option<f64>,
        height_over_base: f64,
        grade_percent: f64,
        shift_s: f64,
        gear: Option<u8>,
        ambient_degc: f64,
        start: &Bound<'_, PyAny>,
        dt_s: f64,
    ) -> PyResult<String> {
        let spans = match speeds_kmh {
            None => usual_spans(),
            Some((from, to)) => {
                let from = number("from_kmh", from, SPEED_KMH, "km/h")?;
                let to = number("to_kmh", to, SPEED_KMH, "km/h")?;
                if from >= to {
                    let allowed = format!("above {from}");
                    return Err(bad(
                        "to_kmh",
                        &to.to_string(),
                        &allowed,
                        "the speed at the end is not above that at the begin",
                    ));
                }
                let span = Span::Speeds(from / 3.6, to / 3.6);
                vec![(format!("{from} km/h to {to} km/h"), span)]
            }
        };
        let named = DRIVEN.iter().find(|(name, _)| *name == driven);
        let Some((_, wheels)) = named else {
            return Err(bad(
                "driven",
                driven,
                "front, rear, all",
                "these wheels are not known",
            ));
        };
        let usual = usual_grip(*wheels);
        let share = axle_share.unwrap_or(usual.axle_share);
        let limits = Grip {
            mu: grip.map_or(Ok(usual.mu), |mu| number("grip", mu, GRIP, "-"))?,
            axle_share: number("axle_share", share, AXLE_SHARE, "-")?,
            height_over_base: number("height_over_base", height_over_base, HEIGHT_OVER_BASE, "-")?,
            ..usual
        };
        let gears = match self.setup.transmission() {
            Transmission::Manual(manual) => manual.overall.len(),
            Transmission::Cvt(_) => 0,
        };
        if let Some(gear) = gear.filter(|gear| !(1..=gears).contains(&usize::from(*gear))) {
            let allowed = match gears {
                0 => "None with a CVT".to_owned(),
                gears => format!("1 to {gears}"),
            };
            return Err(bad(
                "gear",
                &gear.to_string(),
                &allowed,
                "this car has no such gear",
            ));
        }
        let ambient_degc = number("ambient_degc", ambient_degc, AMBIENT, "degC")?;
        let start = match crate::run::start(start)?.0 {
            Start::Nodes(nodes) => nodes,
            Start::At(temp_k) => StartTemperatures {
                given_k: [Some(temp_k); NODES + 1],
            },
            Start::Soak | Start::Warm => StartTemperatures::default(),
        };
        let conditions = Conditions {
            ambient_k: ambient_degc + ZERO_DEGC_K,
            start,
            grade: number("grade_percent", grade_percent, GRADE_PERCENT, "%")? / 100.0,
            grip: grip.map(|_| limits),
            shift_s: number("shift_s", shift_s, SHIFT_S, "s")?,
            gear,
            dt_s: number("dt_s", dt_s, STEP_S, "s")?,
        };
        let setup = Arc::clone(&self.setup);
        let found = py.detach(move || json_text(&times(&setup, &spans, &conditions)));
        found.map_err(refused)
    }

    /// Ranges, prices of the losses, changes of the design and the next test from draws of what is uncertain: JSON of the answer.
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn answer(
        &self,
        py: Python<'_>,
        cycle: String,
        ambient_degc: f64,
        start: &Bound<'_, PyAny>,
        baselines: Option<Vec<String>>,
        draws: u64,
        levers: bool,
        dt_s: f64,
    ) -> PyResult<String> {
        if self.is_text() {
            let problem = self.needs_file_problem("the draws read the car from its file");
            return Err(refused(problem));
        }
        if !(2..=100_000).contains(&draws) {
            let message = "so many draws are not driven";
            return Err(bad("draws", &draws.to_string(), "2 to 100000", message));
        }
        let question = Question {
            base: Base {
                vehicle: self.word.clone(),
                baselines,
                cycle,
                ambient_degc: number("ambient_degc", ambient_degc, AMBIENT, "degC")?,
                start: crate::run::start(start)?.1.text(),
                lubricant: self.options.lubricant.clone(),
                engine_oil: self.options.engine_oil.clone(),
                set: self.options.set.clone(),
                set_all: Vec::new(),
                dt_s: number("dt_s", dt_s, STEP, "s")?,
                formulation: self.options.formulation,
            },
            levers: match levers {
                true => shipped_levers().map_err(refused)?,
                false => Vec::new(),
            },
            prices: true,
            draws,
            heard_rpm: HEARD_RPM,
        };
        let found = py.detach(move || {
            let study = prepare(&question)?;
            drive(&study, &NoProgress)
        });
        let answer = found.map_err(refused)?;
        json_text(&answer).map_err(refused)
    }

    /// Reads the text of a vehicle file. Problems cite it as `name`; its maps are in `folder`.
    #[staticmethod]
    #[pyo3(signature = (name, text, folder, set, lubricant=None, engine_oil=None, formulation="smooth"))]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn from_text(
        py: Python<'_>,
        name: String,
        text: String,
        folder: PathBuf,
        set: Vec<String>,
        lubricant: Option<String>,
        engine_oil: Option<String>,
        formulation: &str,
    ) -> PyResult<Self> {
        let options = options(&set, (lubricant, engine_oil), formulation)?;
        let source = Source {
            text,
            folder,
            is_twin: false,
        };
        py.detach(|| Car::load(name, options, Some(source)))
            .map_err(refused)
    }

    /// Converts a JSON object to TOML.
    #[staticmethod]
    fn json_to_toml(json: &str) -> PyResult<String> {
        let no_table = |message: String| {
            bad(
                "data",
                "",
                "tables, lists, text, numbers, true, false",
                &message,
            )
        };
        let value: Value =
            serde_json::from_str(json).map_err(|error| no_table(error.to_string()))?;
        toml::to_string(&value).map_err(|error| no_table(error.to_string()))
    }

    /// Same car with a manual box.
    fn twin(&self, py: Python<'_>) -> PyResult<Self> {
        let options = self.options.of_twin(NamedBy::Caller);
        let (word, source) = match &self.source {
            None => (baseline_of(&self.word, setup::TWIN), None),
            Some(source) => {
                let source = Source {
                    is_twin: true,
                    ..source.clone()
                };
                (self.word.clone(), Some(source))
            }
        };
        py.detach(|| Car::load(word, options, source))
            .map_err(refused)
    }

    #[getter]
    fn name(&self) -> &str {
        &self.setup.name
    }

    #[getter]
    fn title(&self) -> &str {
        &self.setup.title
    }

    #[getter]
    fn is_cvt(&self) -> bool {
        self.setup.transmission().is_cvt()
    }

    #[getter]
    fn baselines(&self) -> Vec<String> {
        let names = self.setup.baselines.iter();
        let word = |name: &String| match name.as_str() {
            setup::TWIN => name.clone(),
            _ => baseline_of(&self.word, name),
        };
        names.map(word).collect()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        let doubts = self.setup.doubts();
        self.setup.notes.iter().cloned().chain(doubts).collect()
    }

    /// Every key with value, unit, status, source and meaning, as JSON.
    fn keys(&self) -> String {
        let keys: Vec<Value> = self.setup.keys.iter().map(key_json).collect();
        Value::Array(keys).to_string()
    }
}
