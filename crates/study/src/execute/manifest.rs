//! The manifest of a study, `study.json`: the same study gives the same bytes, by which a resumed study is recognised.

use cvtcycle_config::Problems;
use cvtcycle_config::setup::Setup;
use cvtcycle_output::provenance::{car_sha256, cycle_sha256, hash};
use cvtcycle_output::record::Manifest;
use cvtcycle_output::summary::differences;
use serde::Deserialize;
use serde_json::{Value, json};

use super::prepare::Study;
use crate::plan::{Design, Factor, FactorValue, FactorValues, Plan};
use crate::store::Head;
use crate::store::Layout;

pub use crate::store::{RUNS, TRACES};

/// Version of the manifest and of the tables; a new number when a name goes or changes its meaning.
pub const SCHEMA: u32 = 1;

impl Study {
    /// The manifest as indented JSON with a line end.
    pub fn manifest(&self, csv: bool) -> String {
        let plan = &self.plan;
        let manifest = Manifest {
            kind: Some("study".to_owned()),
            ..Manifest::new(SCHEMA)
        };
        let mut rest = json!({
            "title": plan.title,
            "question": plan.question,
            "plan_sha256": hash(plan.text.as_bytes()),
            "layout": Layout { parts: usize::try_from(self.parts()).unwrap_or(usize::MAX), tables: self.tables(), csv },
            "design": plan.design,
            "points": self.points,
            "runs": self.runs(),
            "points_per_part": self.points_per_part(),
            "base": self.base(),
            "factors": plan.factors.iter().map(factor).collect::<Vec<_>>(),
            "analyse": self.analysed(),
            "phases": self.phases,
            "cycles": self.cycles.iter().map(|cycle| json!({"name": cycle.name, "sha256": cycle_sha256(cycle)})).collect::<Vec<_>>(),
            "columns": columns(&self.columns),
            "trace_columns": columns(&self.trace_columns),
            "cars": self.cars.iter().map(|car| self.car_values(car)).collect::<Vec<_>>(),
        });
        if !self.notes.is_empty() {
            rest["notes"] = json!(self.notes);
        }
        if let Some(levers) = &self.levers {
            rest["levers"] = levers.clone();
        }
        let value = manifest.for_run(&rest).with(&rest);
        let text = serde_json::to_string_pretty(&value).unwrap_or_default();
        text + "\n"
    }

    /// Names of the tables of a part, in the order in which they are written.
    fn tables(&self) -> Vec<String> {
        let traces = (!self.traces.is_empty()).then_some(TRACES);
        let names = traces.into_iter().chain([RUNS]);
        names.map(str::to_owned).collect()
    }

    fn base(&self) -> Value {
        let base = &self.plan.base;
        json!({
            "vehicle": base.vehicle,
            "baselines": base.baselines,
            "cycle": base.cycle,
            "ambient_degc": base.ambient_degc,
            "start": base.start,
            "lubricant": base.lubricant,
            "engine_oil": base.engine_oil,
            "set": base.set,
            "set_all": base.set_all,
            "dt_s": base.dt_s,
            "formulation": base.formulation.name(),
        })
    }

    /// Every value of a car that no factor changes, as it was resolved, with its status.
    fn car_values(&self, car: &super::cars::StudyCar) -> Value {
        let Ok(variant) = car.variant(0, &self.plan.factors) else {
            return Value::Null;
        };
        let setup = &variant.setup;
        let values = setup.keys.iter().map(|info| {
            let value = json!({"value": info.value, "unit": info.unit, "status": info.status});
            (info.key.clone(), value)
        });
        json!({
            "name": &*car.name,
            "role": &*car.role,
            "title": setup.title,
            "short": setup.short,
            "transmission": word(setup),
            "like_for_like": alike(self, car),
            "lubricant": setup.oils().0.name,
            "engine_oil": setup.oils().1.name,
            // Other files, such as measured maps, are in the car though not in its keys.
            "sha256": car_sha256(setup),
            "values": values.collect::<serde_json::Map<_, _>>(),
        })
    }
}

fn word(setup: &Setup) -> &'static str {
    match setup.transmission().is_cvt() {
        true => "cvt",
        false => "manual",
    }
}

fn kind(study: &Study, car: &super::cars::StudyCar) -> String {
    let variant = car.variant(0, &study.plan.factors);
    variant.map_or_else(|_| String::new(), |variant| word(&variant.setup).to_owned())
}

/// True of a car that has the road load, tyres and engine of the subject, as the comparison of a run says it.
fn alike(study: &Study, car: &super::cars::StudyCar) -> bool {
    let factors = &study.plan.factors;
    let subject = study.cars.first().map(|own| own.variant(0, factors));
    match (subject, car.variant(0, factors)) {
        (Some(Ok(subject)), Ok(car)) => differences(&subject.setup, &car.setup).is_empty(),
        _ => false,
    }
}

fn columns(columns: &[Head]) -> Vec<Value> {
    let column = |head: &Head| json!({"name": head.name, "unit": head.unit, "doc": head.doc});
    columns.iter().map(column).collect()
}

fn factor(factor: &Factor) -> Value {
    let values = match &factor.values {
        FactorValues::List(list) => list.iter().map(entry).collect(),
        FactorValues::Distribution(distribution) => json!(format!("{distribution:?}")),
    };
    let mut value = json!({
        "key": factor.key, "name": factor.name, "unit": factor.unit, "cars": factor.cars, "acts": factor.acts, "values": values,
        "status": factor.status, "source": factor.source,
    });
    if !factor.test.is_empty() {
        value["test"] = json!(factor.test);
    }
    value
}

fn entry(value: &FactorValue) -> Value {
    match value {
        FactorValue::Number(x) => json!(x),
        FactorValue::Word(word) => json!(&**word),
    }
}

/// The part of a study that its tables are read with: from a study, or from its directory when its cars may be gone.
#[derive(Clone, Debug)]
pub struct StudyManifest {
    /// Name for people.
    pub title: String,
    /// The question; may be empty.
    pub question: String,
    /// Names of the cars, the subject first.
    pub cars: Vec<String>,
    /// Kinds of their boxes, `cvt` or `manual`; empty words in studies of earlier versions.
    pub kinds: Vec<String>,
    /// True of cars with the road load, tyres and engine of the subject; false in studies of earlier versions.
    pub alike: Vec<bool>,
    /// Phase groups.
    pub phases: Vec<String>,
    /// Limits of the results, a sentence each.
    pub notes: Vec<String>,
    /// Names and units of the numbers that are analysed.
    pub analysed: Vec<(String, String)>,
    /// Names and units of the columns of the table of runs.
    pub columns: Vec<(String, String)>,
    /// Number of points.
    pub points: u64,
    /// Points of a part.
    pub points_per_part: u64,
    /// Factors and design.
    pub plan: Plan,
    /// Description of the columns, where they are changes of cars.
    pub levers: Option<Value>,
}

/// The entries of `study.json` that are read.
#[derive(Deserialize)]
struct Stored {
    #[serde(flatten)]
    manifest: Manifest,
    title: String,
    question: String,
    #[serde(default)]
    notes: Vec<String>,
    design: Design,
    points: u64,
    points_per_part: u64,
    analyse: Vec<String>,
    phases: Vec<String>,
    columns: Vec<StoredColumn>,
    cars: Vec<StoredCar>,
    #[serde(default)]
    levers: Option<Value>,
}

#[derive(Deserialize)]
struct StoredColumn {
    name: String,
    unit: String,
}

#[derive(Deserialize)]
struct StoredCar {
    name: String,
    #[serde(default)]
    transmission: String,
    #[serde(default)]
    like_for_like: bool,
}

impl StudyManifest {
    /// The manifest of a study that is ready to run.
    pub fn new(study: &Study) -> Self {
        let heads = study.columns.iter();
        let columns: Vec<_> = heads.map(|c| (c.name.clone(), c.unit.clone())).collect();
        StudyManifest {
            title: study.plan.title.clone(),
            question: study.plan.question.clone(),
            notes: study.notes.clone(),
            cars: study.cars.iter().map(|car| car.name.to_string()).collect(),
            kinds: study.cars.iter().map(|car| kind(study, car)).collect(),
            alike: study.cars.iter().map(|car| alike(study, car)).collect(),
            phases: study.phases.clone(),
            analysed: analysed(&study.analysed(), &columns),
            columns,
            points: study.points,
            points_per_part: study.points_per_part(),
            plan: study.plan.clone(),
            levers: study.levers.clone(),
        }
    }

    /// Reads the manifest of a study's directory; `plan` is the text of its plan and `file` the name that problems cite.
    ///
    /// # Errors
    /// The first mistake in the manifest, in words.
    pub fn read(manifest: &Value, file: &str, plan: &str) -> Result<Self, String> {
        let stored = Stored::deserialize(manifest).map_err(|error| error.to_string())?;
        if stored.manifest.schema != SCHEMA {
            let found = stored.manifest.schema;
            return Err(format!(
                "it has schema {found}; this program reads schema {SCHEMA}"
            ));
        }
        let messages = |problems: &Problems| -> Vec<String> {
            problems.iter().map(|p| p.message.clone()).collect()
        };
        let plan = Plan::read(file, plan);
        let mut plan = plan.map_err(|problems| messages(&problems).join("; "))?;
        plan.design = stored.design;
        // The tables are as large as the plan says: a damaged number here would ask for any amount of memory.
        let (points, points_per_part) = (stored.points, stored.points_per_part);
        if plan.design.points(&plan.factors) != Some(points)
            || !(1..=points.max(1)).contains(&points_per_part)
        {
            return Err("its number of points is not that of its plan".to_owned());
        }
        let heads = stored.columns.into_iter();
        let columns: Vec<_> = heads.map(|c| (c.name, c.unit)).collect();
        let alike = stored.cars.iter().map(|car| car.like_for_like).collect();
        let (cars, kinds) = stored
            .cars
            .into_iter()
            .map(|car| (car.name, car.transmission))
            .unzip();
        Ok(StudyManifest {
            kinds,
            alike,
            title: stored.title,
            question: stored.question,
            notes: stored.notes,
            cars,
            phases: stored.phases,
            analysed: analysed(&stored.analyse, &columns),
            columns,
            points,
            points_per_part,
            plan,
            levers: stored.levers,
        })
    }

    /// Number of parts.
    pub fn parts(&self) -> u64 {
        self.points.div_ceil(self.points_per_part)
    }
}

fn analysed(names: &[String], columns: &[(String, String)]) -> Vec<(String, String)> {
    let known = |name: &String| columns.iter().find(|(column, _)| column == name).cloned();
    names.iter().filter_map(known).collect()
}
