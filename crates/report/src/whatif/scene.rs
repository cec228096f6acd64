//! Subject of a page, and a state of its levers.

use std::collections::BTreeMap;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use cvtcycle_config::setup::{AMBIENT, Options, START, start_nodes};
use cvtcycle_config::{Argument, Override, Problem, Problems, carried};
use cvtcycle_model::drive::Start;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::transmission::cvt::variator::Formulation;
use cvtcycle_output::summary::{Contradiction, DrawnDifference, StartWord};
use serde::{Deserialize, Serialize};

use crate::live_section::State;

/// Number of draws of the uncertain values behind an interval.
pub const DRAWS: u64 = 256;

/// Cars and conditions of a page, as on the command line, and the files that they are read from.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Scene {
    /// Name or path of the subject.
    pub vehicle: String,
    /// Names or paths of the baselines.
    pub baselines: Vec<String>,
    /// Overrides of the subject, which no lever reverts.
    pub set: Vec<String>,
    /// Overrides of all cars.
    pub set_all: Vec<String>,
    /// Engine oil of all cars; by default that of each file.
    pub engine_oil: Option<String>,
    /// `soak`, `warm`, or the temperature of all parts, degC.
    pub start: String,
    /// Maximum step, s.
    pub dt_s: f64,
    /// Reading of the belt model.
    pub formulation: String,
    /// Initial state.
    pub state: State,
    /// Number of the first figure of the live section.
    pub first_figure: usize,
    /// Differences of the initial state over its draws.
    #[serde(default)]
    pub drawn: Option<Vec<DrawnDifference>>,
    /// Published numbers that the initial state contradicts: the page has no table of them.
    #[serde(default)]
    pub contradicted: Vec<Contradiction>,
    /// User's files by path, in Base64.
    pub files: BTreeMap<String, String>,
}

impl Scene {
    /// Adds the user's files that were read for it.
    #[must_use]
    pub fn with_files(mut self, files: carried::Files) -> Self {
        let encoded = files
            .into_iter()
            .map(|(path, bytes)| (path, STANDARD.encode(bytes)));
        self.files.extend(encoded);
        self
    }

    /// Decodes the user's files.
    ///
    /// # Errors
    /// The page is damaged.
    pub fn files(&self) -> Result<carried::Files, Problem> {
        let decode = |(path, text): (&String, &String)| {
            let bytes = STANDARD.decode(text).map_err(|error| {
                Problem::invalid(format!("the file in the page is damaged: {error}"))
                    .in_file(path.as_str())
                    .hint("make the page again")
            })?;
            Ok((path.clone(), bytes))
        };
        self.files.iter().map(decode).collect()
    }

    /// Parses the overrides of all cars, and the additional ones of the subject.
    pub(super) fn overrides(&self) -> Result<[Vec<Override>; 2], Problem> {
        let parse = |list: &[String]| -> Result<Vec<Override>, Problem> {
            list.iter().map(|text| text.parse()).collect()
        };
        Ok([parse(&self.set_all)?, parse(&self.set)?])
    }

    /// Options of the subject at a state; `moved` are the overrides of the levers.
    pub(super) fn subject(&self, state: &State, moved: &[Override]) -> Result<Options, Problem> {
        let [set_all, own] = self.overrides()?;
        let moved = moved.iter().cloned();
        Ok(Options {
            lubricant: state.lubricant.clone(),
            engine_oil: self.engine_oil.clone(),
            set: set_all.into_iter().chain(own).chain(moved).collect(),
            formulation: self.formulation(),
            ..Options::default()
        })
    }

    pub(super) fn formulation(&self) -> Formulation {
        Formulation::named(&self.formulation).unwrap_or_default()
    }

    /// Start of the drive, and its word.
    pub(super) fn start(&self) -> Result<(Start, StartWord), Problem> {
        let word = |start| Ok((start, StartWord::Word(self.start.clone())));
        match self.start.as_str() {
            "soak" => return word(Start::Soak),
            "warm" => return word(Start::Warm),
            nodes if nodes.contains('=') => {
                let found = start_nodes(nodes)?;
                return Ok((Start::Nodes(found), StartWord::of_nodes(&found)));
            }
            _ => {}
        }
        let degc = self.start.parse().ok().filter(|degc| START.contains(*degc));
        let degc: f64 =
            degc.ok_or_else(|| Problem::invalid("this is no start").value(&*self.start))?;
        Ok((Start::At(degc + ZERO_DEGC_K), StartWord::Degc(degc)))
    }
}

impl State {
    /// Ambient temperature, K.
    pub(super) fn ambient_k(&self) -> Result<f64, Problems> {
        match AMBIENT.contains(self.ambient_degc) {
            true => Ok(self.ambient_degc + ZERO_DEGC_K),
            false => Err(Problem::out_of_range("ambient temperature")
                .at(Argument::File)
                .value(self.ambient_degc.to_string())
                .allowed(AMBIENT.in_unit("degC"))
                .into()),
        }
    }
}
