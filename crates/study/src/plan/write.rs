//! The plan of a matrix of ambient temperatures and starts, made from values, with its text.

use toml::Value;

use super::factor::unit;
use super::keys::{FACTOR, STUDY, default};
use super::{Acts, Base, Cars, Design, Factor, FactorValue, FactorValues, Keep, Places, Plan};
use cvtcycle_config::{Override, Place, Problem, Problems};
use cvtcycle_model::keys::Key;
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Values of one direction of a matrix.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The values, in the unit of the run option.
    pub values: Vec<FactorValue>,
    /// Where they are from, as problems cite it.
    pub place: Place,
}

/// The values of an empty plan.
impl Default for Base {
    fn default() -> Self {
        let text = |row: &Key| default(row).map_or_else(String::new, |value| value.to_string());
        let number = |row: &Key| default(row).and_then(|x| x.number()).unwrap_or(f64::NAN);
        Base {
            vehicle: text(&STUDY.vehicle),
            baselines: None,
            cycle: text(&STUDY.cycle),
            ambient_degc: number(&STUDY.ambient_degc),
            start: text(&STUDY.start),
            lubricant: None,
            engine_oil: None,
            set: Vec::new(),
            set_all: Vec::new(),
            dt_s: number(&STUDY.dt_s),
            formulation: Formulation::default(),
        }
    }
}

impl Plan {
    /// The grid of ambient temperatures and starts, for the cars and the cycle of `base`, whose other values are the defaults;
    /// `places` are those of the keys of `[study]`.
    ///
    /// # Errors
    /// Values that are listed twice.
    pub fn matrix(
        title: &str,
        base: Base,
        axes: [Axis; 2],
        keep: Keep,
        places: Places,
    ) -> Result<Plan, Problems> {
        let mut problems = Problems::new();
        for Axis { values, place } in &axes {
            let again = (0..values.len()).filter(|&k| values[..k].contains(&values[k]));
            problems.extend(again.map(|k| {
                Problem::duplicate(format!("`{}` is listed twice", values[k]))
                    .at(place.clone())
                    .hint("remove one")
            }));
        }
        problems.finish()?;
        let text = text(title, &base, &keep, &axes);
        let [ambient, start] = axes;
        Ok(Plan {
            file: "study ambient".to_owned(),
            text,
            title: title.to_owned(),
            question: String::new(),
            base,
            factors: vec![
                factor("ambient_degc", "ambient", ambient),
                factor("start", "start", start),
            ],
            forms: Vec::new(),
            design: Design::Grid,
            keep,
            analyse: Vec::new(),
            most_runs: default(&STUDY.most_runs)
                .and_then(|runs| runs.number())
                .map_or(0, |runs| runs as u64),
            by_box: None,
            skip_missing: false,
            clip: false,
            places,
        })
    }
}

fn factor(key: &str, name: &str, axis: Axis) -> Factor {
    let values = FactorValues::List(axis.values).unmixed();
    Factor {
        key: key.to_owned(),
        name: name.to_owned(),
        unit: if values.are_numbers() {
            unit(key, Acts::Value)
        } else {
            String::new()
        },
        cars: Cars::All,
        acts: Acts::Value,
        values,
        form: None,
        status: String::new(),
        source: String::new(),
        test: String::new(),
        places: Places::new(axis.place.clone()),
        place: axis.place,
    }
}

/// The text of the plan, from which its directory is read again.
fn text(title: &str, base: &Base, keep: &Keep, axes: &[Axis; 2]) -> String {
    let word = |word: &String| Value::String(word.clone());
    let list = |words: &Vec<String>| Value::Array(words.iter().map(word).collect());
    let overrides = |all: &[Override]| {
        let texts = all.iter().map(|by| Value::String(by.to_string()));
        (!all.is_empty()).then(|| Value::Array(texts.collect()))
    };
    let keep = match keep {
        Keep::Summary => None,
        Keep::Columns(names) => Some(list(names)),
        Keep::Everything => Some(Value::String("everything".to_owned())),
    };
    let head = [
        (&STUDY.title, Some(Value::String(title.to_owned()))),
        (&STUDY.vehicle, Some(word(&base.vehicle))),
        (&STUDY.baselines, base.baselines.as_ref().map(list)),
        (&STUDY.cycle, Some(word(&base.cycle))),
        (&STUDY.lubricant, base.lubricant.as_ref().map(word)),
        (&STUDY.engine_oil, base.engine_oil.as_ref().map(word)),
        (&STUDY.set, overrides(&base.set)),
        (&STUDY.set_all, overrides(&base.set_all)),
        (&STUDY.keep, keep),
    ];
    let mut text = "# Made by `cvtcycle study ambient`.\n[study]\n".to_owned();
    for (row, value) in head {
        if let Some(value) = value {
            text += &format!("{} = {value}\n", row.name);
        }
    }
    text += "\n[study.design.grid]\n\n";
    let value = |value: &FactorValue| match value {
        FactorValue::Number(x) => Value::Float(*x),
        FactorValue::Word(word) => Value::String(word.to_string()),
    };
    let [ambient, start] = axes.each_ref().map(|axis| {
        let values = Value::Array(axis.values.iter().map(value).collect());
        format!("{} = {values}\n", FACTOR.values.name)
    });
    text += &format!("[[factor]]\nkey = \"ambient_degc\"\nname = \"ambient\"\n{ambient}\n");
    text += &format!("[[factor]]\nkey = \"start\"\n{start}");
    text
}
