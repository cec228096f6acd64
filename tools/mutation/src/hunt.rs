//! Runs the tests that reach a mutant, cheap ones first, until one fails.

use crate::compile::Program;
use crate::exec::{self, End, Run};
use crate::reach::Test;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

/// Tests of one program that are cheaper than this go together, s.
const CHEAP_S: f64 = 0.1;

/// What became of a mutant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fate {
    /// A test failed.
    Caught,
    /// A test did not end.
    Hung,
    /// All tests passed.
    Survived,
    /// No test runs it.
    Unreached,
}

/// A line of the log.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Outcome {
    /// Name of the mutant.
    pub key: String,
    /// Its fate.
    pub fate: Fate,
    /// The test that failed.
    #[serde(default)]
    pub by: String,
    /// Text that the verdict rests on: the mutated file's.
    pub source: u64,
}

/// A mutant to be hunted.
pub struct Quarry {
    /// Number.
    pub number: u32,
    /// Name.
    pub key: String,
    /// Its file's text as a number.
    pub source: u64,
}

/// Tries and catches of a batch.
type Luck = HashMap<String, (u32, u32)>;

/// Everything a hunt needs.
pub struct Hunt<'a> {
    /// Folder of the log.
    pub state: &'a Path,
    /// Test programs.
    pub programs: &'a [Program],
    /// Their tests.
    pub tests: &'a [Test],
}

/// Tests that run in one process.
struct Batch<'a> {
    name: String,
    program: &'a Program,
    names: Vec<&'a str>,
    seconds: f64,
}

impl Hunt<'_> {
    /// Hunts all, each result into the log as soon as it is there.
    ///
    /// # Errors
    /// A program cannot be run, the log not be written.
    pub fn all(&self, mutants: &[Quarry], jobs: usize) -> Result<(), String> {
        let path = self.state.join("results.jsonl");
        let log = fs::OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(|e| format!("{}: {e}", path.display()))?;
        let (log, luck) = (Mutex::new(log), Mutex::new(Luck::new()));
        let done = Mutex::new(0);
        exec::share(jobs, mutants.len(), |worker, index| {
            let (fate, by) = self.one(&mutants[index], worker, &luck)?;
            let Quarry { key, source, .. } = &mutants[index];
            let line = serde_json::to_string(&Outcome {
                key: key.clone(),
                fate,
                by,
                source: *source,
            })
            .map_err(|e| e.to_string())?;
            exec::lock(&log)
                .write_all(format!("{line}\n").as_bytes())
                .map_err(|e| format!("{}: {e}", path.display()))?;
            let mut done = exec::lock(&done);
            *done += 1;
            if *done % 20 == 0 {
                println!("{done} of {} mutants", mutants.len());
            }
            Ok(())
        })
    }

    fn one(
        &self,
        mutant: &Quarry,
        worker: usize,
        luck: &Mutex<Luck>,
    ) -> Result<(Fate, String), String> {
        let mut batches = self.batches(mutant.number);
        if batches.is_empty() {
            return Ok((Fate::Unreached, String::new()));
        }
        {
            let luck = exec::lock(luck);
            let price = |b: &Batch| {
                let (tries, catches) = luck.get(&b.name).copied().unwrap_or_default();
                b.seconds * f64::from(tries + 2) / f64::from(catches + 1)
            };
            batches.sort_by(|a, b| price(a).total_cmp(&price(b)));
        }
        let output = self.state.join(format!("output_{worker}"));
        for batch in &batches {
            let limit = Duration::from_secs_f64(20.0 + 10.0 * batch.seconds);
            let env = Some(("CVTCYCLE_MUTANT", mutant.number.to_string()));
            let (end, _) = exec::run(&Run {
                program: batch.program,
                names: batch.names.clone(),
                env,
                limit,
                output: &output,
            })?;
            let mut luck = exec::lock(luck);
            let (tries, catches) = luck.entry(batch.name.clone()).or_default();
            *tries += 1;
            if end != End::Passed {
                *catches += 1;
                let by = exec::first_failed(&output).unwrap_or_else(|| batch.names[0].to_owned());
                let fate = if end == End::Late {
                    Fate::Hung
                } else {
                    Fate::Caught
                };
                return Ok((fate, format!("{}::{by}", batch.program.name)));
            }
        }
        Ok((Fate::Survived, String::new()))
    }

    fn batches(&self, number: u32) -> Vec<Batch<'_>> {
        let mut batches: Vec<Batch> = Vec::new();
        for test in self
            .tests
            .iter()
            .filter(|t| t.reaches.binary_search(&number).is_ok())
        {
            let Some(program) = self.programs.iter().find(|p| p.name == test.program) else {
                continue;
            };
            let cheap = test.seconds < CHEAP_S;
            let name = if cheap {
                test.program.clone()
            } else {
                format!("{}::{}", test.program, test.name)
            };
            match batches.iter_mut().find(|b| b.name == name) {
                Some(batch) => {
                    batch.names.push(&test.name);
                    batch.seconds += test.seconds;
                }
                None => batches.push(Batch {
                    name,
                    program,
                    names: vec![&test.name],
                    seconds: test.seconds,
                }),
            }
        }
        batches
    }
}

/// All lines of the log, the last one of each mutant.
#[must_use]
pub fn log(state: &Path) -> HashMap<String, Outcome> {
    let text = fs::read_to_string(state.join("results.jsonl")).unwrap_or_default();
    let lines = text
        .lines()
        .filter_map(|l| serde_json::from_str::<Outcome>(l).ok());
    lines.map(|r| (r.key.clone(), r)).collect()
}
