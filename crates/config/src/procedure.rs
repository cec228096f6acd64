//! Tests as data: a cycle with its start, temperature, load and the figures that it gives.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TE-1 | result = (1 - s) F_start + s F_warm, F fuel per distance, s `warm_share`; F_warm of the same cycle directly after | source: the test's regulation, in its file |
//! | TE-3 | F_reported = F (0.4 + 0.6 X/X_ref), X heating value of a litre of the car's fuel, X_ref `reference_mj_per_litre` | source: 40 CFR 600.113-12, its factor 0.6 and 31.78 MJ/L (specific gravity 0.739 at 60 degF, 0.7383 kg/L, of 18 507 Btu/lb), from memory: fuel economy is stated for the fuel of 1975 |
//! | TE-2 | road load times `load_factor`, electrical load plus `electrical_w` | source: as TE-1 |
//!
//! The selector of an automatic box is in neutral after a start as long as the cycle says so (SE-1). A file of the user is read like the shipped ones,
//! which are in `cycles/tests`.

use std::path::Path;

use crate::cycle;
use crate::problem::near::suggest;
use crate::setup::ParamSet;
use crate::setup::{Kind as FileKind, NamedBy, is_path, text_of};
use crate::{Document, Problem, ProblemKind, Problems, Reader};
use cvtcycle_model::cycle::Cycle;
use cvtcycle_model::drive::{Conditions, Start, Vehicle};
use cvtcycle_model::keys;
use cvtcycle_model::keys::{Choice, Kind, Repeat, Table, Values};

/// A file of a test.
pub const TEST_FILE: Table =
    Table::from_tables(&[TestKeys::TABLE, ResultKeys::TABLE.repeated(Repeat::List)]);

keys! {
    /// Keys of `[test]`.
    TEST: TestKeys = "test" [] {
        title: computed("name of the file", text()), "name for people";
        cycle: text(), "cycle by name or path; wltc: that of the car's class";
        start: words(&[
            Choice::word("soak", "everything at the ambient temperature"),
            Choice::word("warm", "directly after the same cycle"),
        ], "soak"), "temperatures at the start";
        ambient_degc: number(-40.0, 60.0), "ambient temperature";
        load_factor: or(1.0, number(0.1, 3.0)), "factor on the road load, not on the mass", ["TE-2"];
        electrical_w: or(0.0, number(0.0, 6000.0)), "electrical load at the engine's shaft in addition to the car's own", ["TE-2"];
        warm_share: or(0.0, number(0.0, 1.0)), "share of the result that is of the same cycle driven directly after", ["TE-1"];
        reference_mj_per_litre: optional(number(20.0, 50.0)), "heating value of a litre of the fuel that the figures are stated for; absent: the car's own", ["TE-3"];
        source: computed("none", text()), "regulation or reference";
    }

    /// Keys of `[[result]]`.
    RESULT: ResultKeys = "result" [] {
        name: text(), "unique name of a-z, 0-9 and _; the column is NAME_l_per_100km";
        phases: optional(list_of(&Kind::Text, "a list of names of phases")), "phases of the cycle that it is of; absent: the whole test, weighted as its regulation says";
    }
}

/// Keys of a car that a test changes (TE-2).
const LOAD_FACTOR: &str = "road_load.load_factor";
const ELECTRICAL_W: &str = "engine.electrical_w";

/// A test.
#[derive(Clone, Debug)]
pub struct Procedure {
    /// Name of its file without `.toml`.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Word of its cycle.
    pub cycle_word: String,
    /// Cycle; `wltc` still has to be chosen for a car ([`Procedure::cycle_for`]).
    pub cycle: Cycle,
    /// Start; the second run of TE-1 is always warm.
    pub start: Start,
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Factor on the road load.
    pub load_factor: f64,
    /// Electrical load besides the car's own, W.
    pub electrical_w: f64,
    /// Share of the warm run (TE-1).
    pub warm_share: f64,
    /// Heating value of a litre of the fuel that figures are stated for, MJ (TE-3).
    pub reference_mj_per_litre: Option<f64>,
    /// Figures.
    pub results: Vec<TestResult>,
}

/// A figure of a test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TestResult {
    /// Name, such as `bag1`.
    pub name: String,
    /// Phases of the cycle; empty for the whole test.
    pub phases: Vec<String>,
}

impl TestResult {
    /// Name of its column in tables.
    #[must_use]
    pub fn column(&self) -> String {
        format!("{}_l_per_100km", self.name)
    }
}

impl Procedure {
    /// Names of the tests that the program carries.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        FileKind::Test.names()
    }

    /// A test by its name or path.
    ///
    /// ```
    /// use cvtcycle_config::procedure::Procedure;
    /// let test = Procedure::open("cold_ftp")?;
    /// assert_eq!(test.load_factor, 1.1);
    /// assert_eq!(test.results[1].column(), "cold_bag1_l_per_100km");
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// Unknown name, unreadable file, all problems of the file, an unknown cycle.
    pub fn open(word: &str) -> Result<Procedure, Problems> {
        let (file, text, _) = text_of(word, FileKind::Test, NamedBy::Caller)?;
        Procedure::read(&file, &text)
    }

    /// Reads the text of a test; `file` is its name or path, which problems cite.
    ///
    /// # Errors
    /// As [`Procedure::open`].
    pub fn read(file: &str, text: &str) -> Result<Procedure, Problems> {
        let mut document = Document::parse(file, text)?;
        let tables = document.take_tables("result");
        let reader = Reader::new(&document);
        let s = reader.root().table("test");
        let stem = Path::new(file.trim_start_matches("embedded:")).file_stem();
        let name = stem.map_or_else(
            || file.to_owned(),
            |stem| stem.to_string_lossy().into_owned(),
        );
        let title = s.text_or(&TEST.title, &name);
        let word = Values::text(&s, &TEST.cycle);
        let cycle_word = match Path::new(file).parent() {
            Some(folder) if is_path(&word) => folder.join(&word).to_string_lossy().into_owned(),
            _ => word,
        };
        let start = match s.word(&TEST.start) {
            "warm" => Start::Warm,
            _ => Start::Soak,
        };
        let place = s.place("cycle");
        let (ambient_k, load_factor, electrical_w, warm_share) = (
            s.number(&TEST.ambient_degc),
            s.number(&TEST.load_factor),
            s.number(&TEST.electrical_w),
            s.number(&TEST.warm_share),
        );
        let reference_mj_per_litre = s.optional(&TEST.reference_mj_per_litre);
        let _ = s.text_or(&TEST.source, "");
        let mut problems = reader.finish().err().unwrap_or_default();
        let cycle =
            match problems.is_empty() {
                true => problems.take(cycle::find(&cycle_word).map_err(|found| {
                    found.map(|problem| problem.at(place.clone()).key("test.cycle"))
                })),
                false => None,
            };
        let mut results: Vec<TestResult> = Vec::new();
        for table in &tables {
            let Some(result) = problems.take(read_result(table, cycle.as_ref(), &results)) else {
                continue;
            };
            results.push(result);
        }
        if tables.is_empty() && problems.is_empty() {
            let problem = Problem::missing("the test has no result")
                .in_file(file)
                .key("result");
            problems.push(
                problem.hint("add [[result]] with a name; without phases it is the whole test"),
            );
        }
        let Some(cycle) = cycle.filter(|_| problems.is_empty()) else {
            return Err(problems);
        };
        Ok(Procedure {
            name,
            title,
            cycle_word,
            cycle,
            start,
            ambient_k,
            load_factor,
            electrical_w,
            warm_share,
            reference_mj_per_litre,
            results,
        })
    }

    /// The cycle as a car drives it: of `wltc` that of its class.
    #[must_use]
    pub fn cycle_for(&self, car: &Vehicle) -> Cycle {
        cycle::for_car(&self.cycle_word, self.cycle.clone(), car)
    }

    /// Stated over burnt fuel of a car (TE-3).
    #[must_use]
    pub fn stated_share(&self, car: &Vehicle) -> f64 {
        let engine = car.engine();
        let own_mj_l = engine.heating_value_j_kg * engine.fuel_density_kg_m3 / 1e9;
        self.reference_mj_per_litre
            .map_or(1.0, |reference| 0.4 + 0.6 * own_mj_l / reference) // TE-3
    }

    /// Conditions of the run that it measures, with steps of at most some time, s.
    #[must_use]
    pub fn conditions(&self, max_dt_s: f64) -> Conditions {
        Conditions {
            ambient_k: self.ambient_k,
            start: self.start,
            max_dt_s,
            keep_rows: false,
        }
    }

    /// The car with the load of the test (TE-2).
    ///
    /// # Errors
    /// Loads that the car's keys refuse.
    pub fn load(&self, car: &ParamSet) -> Result<ParamSet, Problems> {
        let mut loaded = car.clone();
        if (self.load_factor - 1.0).abs() > 0.0 {
            let own = loaded.param(LOAD_FACTOR)?.base();
            loaded = loaded.with(LOAD_FACTOR, own * self.load_factor)?;
        }
        if self.electrical_w > 0.0 {
            let own = loaded.param(ELECTRICAL_W)?.base();
            loaded = loaded.with(ELECTRICAL_W, own + self.electrical_w)?;
        }
        Ok(loaded)
    }
}

fn read_result(
    table: &Document,
    cycle: Option<&Cycle>,
    earlier: &[TestResult],
) -> Result<TestResult, Problems> {
    let reader = Reader::new(table);
    let s = reader.root();
    let name = Values::text(&s, &RESULT.name);
    let is_plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    if s.has("name") && (name.is_empty() || !name.chars().all(is_plain)) {
        let message = format!("`{name}` is no name of a result");
        s.unknown_name(
            "name",
            "letters a-z, digits and _",
            &message,
            "write it as a column has it: bag1",
        );
    }
    if earlier.iter().any(|other| other.name == name) {
        s.complain(
            ProblemKind::Duplicate,
            "name",
            "a name of its own",
            &format!("the test has two results named `{name}`"),
            "rename one of them",
        );
    }
    let phases = Values::texts(&s, &RESULT.phases);
    if let Some(cycle) = cycle {
        let groups = cycle.phase_groups();
        let known: Vec<&str> = groups.iter().map(|(name, _)| name.as_str()).collect();
        for phase in phases
            .iter()
            .filter(|phase| !known.contains(&phase.as_str()))
        {
            let message = format!("the cycle {} has no phase `{phase}`", cycle.name);
            s.complain(
                ProblemKind::UnknownName,
                "phases",
                &known.join(", "),
                &message,
                &suggest(phase, &known),
            );
        }
    }
    reader.finish().map(|_| TestResult { name, phases })
}
