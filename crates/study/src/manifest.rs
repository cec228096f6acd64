//! What a study is, as `study.json` keeps it: the same study gives the same bytes, so that one that is resumed can be told from another.

use cvtcycle_output::hash::hash;
use serde::Serialize;
use serde_json::{Value, json};

use super::plan::{Acts, Cars, Design, Factor, FactorValue, FactorValues};
use super::prepare::Study;
use super::store::Layout;
use super::table::Head;

/// Name of the table of runs.
pub const RUNS: &str = "runs";
/// Name of the table of traces.
pub const TRACES: &str = "trace";
/// Version of the manifest and of the tables; a new number when a name goes or changes its meaning.
pub const SCHEMA: u32 = 1;

impl Study {
    /// The manifest as indented JSON with a line end.
    #[must_use]
    pub fn manifest(&self, csv: bool) -> String {
        let plan = &self.plan;
        let value = json!({
            "schema": SCHEMA,
            "kind": "study",
            "program": cvtcycle_output::PROGRAM,
            "title": plan.title,
            "question": plan.question,
            "plan_sha256": hash(plan.text.as_bytes()),
            "layout": Layout { parts: usize::try_from(self.parts()).unwrap_or(usize::MAX), tables: self.tables(), csv },
            "design": design(&plan.design),
            "points": self.points,
            "runs": self.runs(),
            "points_per_part": self.points_per_part(),
            "base": self.base(),
            "factors": plan.factors.iter().map(factor).collect::<Vec<_>>(),
            "analyse": self.analysed(),
            "phases": self.phases,
            "cycles": self.cycles.iter().map(|cycle| json!({"name": cycle.name, "sha256": hash(format!("{cycle:?}").as_bytes())})).collect::<Vec<_>>(),
            "columns": columns(&self.columns),
            "trace_columns": columns(&self.trace_columns),
            "cars": self.cars.iter().map(|car| self.car_values(car)).collect::<Vec<_>>(),
        });
        let text = serde_json::to_string_pretty(&value).unwrap_or_default();
        text + "\n"
    }

    /// Names of the tables of a part, in the order in which they are written.
    fn tables(&self) -> Vec<String> {
        let traces = (!self.traces.is_empty()).then_some(TRACES);
        traces
            .into_iter()
            .chain([RUNS])
            .map(str::to_owned)
            .collect()
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
            "formulation": cvtcycle_output::summary::name_of(base.formulation),
        })
    }

    /// Every value of a car that no factor changes, as it was resolved, with its status.
    fn car_values(&self, car: &super::cars::StudyCar) -> Value {
        let Ok(variant) = car.variant(0, &self.plan.factors) else {
            return Value::Null;
        };
        let setup = &variant.setup;
        let values: serde_json::Map<String, Value> = setup
            .keys
            .iter()
            .map(|info| {
                (
                    info.key.clone(),
                    json!({"value": info.value, "unit": info.unit, "status": info.status}),
                )
            })
            .collect();
        json!({
            "name": &*car.name,
            "role": &*car.role,
            "title": setup.title,
            "transmission": if setup.transmission().is_cvt() { "cvt" } else { "manual" },
            "lubricant": setup.oils().0.name,
            "engine_oil": setup.oils().1.name,
            // Files beside the vehicle's own, such as measured maps, are in the car though not in its keys.
            "sha256": hash(format!("{:?}", setup.car(cvtcycle_model::road::REFERENCE_K)).as_bytes()),
            "values": values,
        })
    }
}

fn columns(columns: &[Head]) -> Vec<Value> {
    columns
        .iter()
        .map(|column| json!({"name": column.name, "unit": column.unit, "doc": column.doc}))
        .collect()
}

fn design(design: &Design) -> Value {
    match *design {
        Design::Grid => json!({"kind": "grid"}),
        Design::OneAtATime { quantile } => json!({"kind": "one_at_a_time", "quantile": quantile}),
        Design::LatinHypercube { samples, seed } => sampled("latin_hypercube", samples, seed),
        Design::Sobol { samples, seed } => sampled("sobol", samples, seed),
        Design::MonteCarlo { samples, seed } => sampled("monte_carlo", samples, seed),
        Design::Saltelli { samples, seed } => sampled("saltelli", samples, seed),
    }
}

fn sampled(kind: &str, samples: u64, seed: u64) -> Value {
    json!({"kind": kind, "samples": samples, "seed": seed})
}

fn factor(factor: &Factor) -> Value {
    let cars = match factor.cars {
        Cars::Subject => "subject",
        Cars::Baselines => "baselines",
        Cars::All => "all",
    };
    let acts = match factor.acts {
        Acts::Value => "value",
        Acts::Scale => "scale",
        Acts::Offset => "offset",
    };
    let values = match &factor.values {
        FactorValues::List(list) => list.iter().map(entry).collect(),
        FactorValues::Distribution(distribution) => json!(format!("{distribution:?}")),
    };
    json!({
        "key": factor.key, "name": factor.name, "unit": factor.unit, "cars": cars, "acts": acts, "values": values,
        "status": factor.status, "source": factor.source,
    })
}

fn entry(value: &FactorValue) -> Value {
    match value {
        FactorValue::Number(x) => json!(x),
        FactorValue::Word(word) => json!(&**word),
    }
}

/// A value as indented JSON with a line end.
///
/// # Errors
/// For maps whose keys are no text; the studies have none.
pub fn json_text(value: &impl Serialize) -> serde_json::Result<String> {
    serde_json::to_string_pretty(value).map(|text| text + "\n")
}
