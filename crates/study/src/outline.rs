//! What is needed to read a study's tables: from the study itself, or from its directory long after, when its cars may be gone.

use serde_json::Value;

use super::plan::{Design, Plan};
use super::prepare::Study;

/// A study without its cars.
#[derive(Clone, Debug)]
pub struct Outline {
    /// Name for people.
    pub title: String,
    /// The question; may be empty.
    pub question: String,
    /// Names of the cars, the subject first.
    pub cars: Vec<String>,
    /// Phase groups.
    pub phases: Vec<String>,
    /// Numbers of a row that are analysed, with their units.
    pub analysed: Vec<(String, String)>,
    /// Names and units of the columns of the table of runs.
    pub columns: Vec<(String, String)>,
    /// Number of points.
    pub points: u64,
    /// Points of a part.
    pub points_per_part: u64,
    /// Factors and design.
    pub plan: Plan,
}

impl Outline {
    /// Of a study that is ready to run.
    #[must_use]
    pub fn of(study: &Study) -> Self {
        let columns: Vec<(String, String)> = study
            .columns
            .iter()
            .map(|c| (c.name.clone(), c.unit.clone()))
            .collect();
        Outline {
            title: study.plan.title.clone(),
            question: study.plan.question.clone(),
            cars: study.cars.iter().map(|car| car.name.to_string()).collect(),
            phases: study.phases.clone(),
            analysed: analysed(&study.analysed(), &columns),
            columns,
            points: study.points,
            points_per_part: study.points_per_part(),
            plan: study.plan.clone(),
        }
    }

    /// Of a study's directory: its manifest and the text of its plan.
    ///
    /// # Errors
    /// What is wrong with the manifest, in words.
    pub fn read(manifest: &Value, file: &str, plan: &str) -> Result<Self, String> {
        let text = |key: &str| {
            manifest[key]
                .as_str()
                .map(str::to_owned)
                .ok_or_else(|| missing(key))
        };
        let number = |key: &str| manifest[key].as_u64().ok_or_else(|| missing(key));
        let schema = number("schema")?;
        if schema != u64::from(super::manifest::SCHEMA) {
            return Err(format!(
                "it has schema {schema}; this program reads schema {}",
                super::manifest::SCHEMA
            ));
        }
        let mut plan = Plan::read(file, plan).map_err(|problems| {
            problems
                .iter()
                .map(|p| p.message.clone())
                .collect::<Vec<_>>()
                .join("; ")
        })?;
        plan.design = design(&manifest["design"]).ok_or_else(|| missing("design"))?;
        // The tables are as large as the plan says, so a damaged number here would ask for any amount of memory.
        let (points, points_per_part) = (number("points")?, number("points_per_part")?);
        if plan.design.points(&plan.factors) != Some(points)
            || !(1..=points.max(1)).contains(&points_per_part)
        {
            return Err("its number of points is not that of its plan".to_owned());
        }
        let strings = |value: &Value| {
            value.as_array().map(|list| {
                list.iter()
                    .filter_map(|v| v.as_str().map(str::to_owned))
                    .collect::<Vec<_>>()
            })
        };
        let field = |value: &Value, key: &str| value[key].as_str().unwrap_or_default().to_owned();
        let columns = manifest["columns"]
            .as_array()
            .ok_or_else(|| missing("columns"))?;
        let columns: Vec<(String, String)> = columns
            .iter()
            .map(|c| (field(c, "name"), field(c, "unit")))
            .collect();
        let cars = manifest["cars"].as_array().ok_or_else(|| missing("cars"))?;
        let names = strings(&manifest["analyse"]).ok_or_else(|| missing("analyse"))?;
        Ok(Outline {
            title: text("title")?,
            question: text("question")?,
            cars: cars.iter().map(|car| field(car, "name")).collect(),
            phases: strings(&manifest["phases"]).ok_or_else(|| missing("phases"))?,
            analysed: analysed(&names, &columns),
            columns,
            points,
            points_per_part,
            plan,
        })
    }

    /// Number of parts.
    #[must_use]
    pub fn parts(&self) -> u64 {
        self.points.div_ceil(self.points_per_part)
    }
}

fn missing(key: &str) -> String {
    format!("`{key}` is missing or of the wrong kind")
}

fn analysed(names: &[String], columns: &[(String, String)]) -> Vec<(String, String)> {
    let known = |name: &String| columns.iter().find(|(column, _)| column == name).cloned();
    names.iter().filter_map(known).collect()
}

fn design(value: &Value) -> Option<Design> {
    let (samples, seed) = (value["samples"].as_u64(), value["seed"].as_u64());
    Some(match value["kind"].as_str()? {
        "grid" => Design::Grid,
        "one_at_a_time" => Design::OneAtATime {
            quantile: value["quantile"].as_f64()?,
        },
        "latin_hypercube" => Design::LatinHypercube {
            samples: samples?,
            seed: seed?,
        },
        "sobol" => Design::Sobol {
            samples: samples?,
            seed: seed?,
        },
        "monte_carlo" => Design::MonteCarlo {
            samples: samples?,
            seed: seed?,
        },
        "saltelli" => Design::Saltelli {
            samples: samples?,
            seed: seed?,
        },
        _ => return None,
    })
}
