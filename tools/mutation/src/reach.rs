//! Which test reaches which mutants, and how long it takes.

use crate::compile::Program;
use crate::config::Config;
use crate::exec::{self, End, Run};
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, UNIX_EPOCH};

/// One test.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Test {
    /// Its program.
    pub program: String,
    /// Its name.
    pub name: String,
    /// Seconds with no mutant on.
    pub seconds: f64,
    /// Numbers of the mutants that it reaches; nothing for one that fails without a mutant.
    pub reaches: Vec<u32>,
    /// Whether it passes without a mutant.
    pub good: bool,
}

/// What was measured of one build of a program.
#[derive(Debug, Serialize, Deserialize)]
struct Measured {
    build: String,
    tests: Vec<Test>,
}

/// Which build a program is.
fn build(program: &Program) -> Result<String, String> {
    let data =
        fs::metadata(&program.path).map_err(|e| format!("{}: {e}", program.path.display()))?;
    let time = data
        .modified()
        .ok()
        .and_then(|t| t.duration_since(UNIX_EPOCH).ok())
        .map_or(0, |d| d.as_nanos());
    Ok(format!("{} {} {time}", program.path.display(), data.len()))
}

/// Runs each test once by itself, unless the same build was measured before.
///
/// # Errors
/// A program cannot be run, a file not be written.
pub fn measure(
    state: &Path,
    programs: &[Program],
    config: &Config,
    jobs: usize,
) -> Result<Vec<Test>, String> {
    let mut all = Vec::new();
    for program in programs {
        let kept = state.join(format!("reach_{}.json", program.name.replace('/', "_")));
        let build = build(program)?;
        let old: Option<Measured> = fs::read(&kept)
            .ok()
            .and_then(|b| serde_json::from_slice(&b).ok());
        if let Some(old) = old.filter(|o| o.build == build) {
            all.extend(
                old.tests
                    .into_iter()
                    .filter(|t| config.runs(&format!("{}::{}", t.program, t.name))),
            );
            continue;
        }
        let names: Vec<String> = exec::list(program)?;
        let names: Vec<String> = names
            .into_iter()
            .filter(|n| config.runs(&format!("{}::{n}", program.name)))
            .collect();
        let done = Mutex::new(Vec::new());
        exec::share(jobs, names.len(), |worker, index| {
            let test = one(state, program, &names[index], worker)?;
            exec::lock(&done).push(test);
            Ok(())
        })?;
        let mut tests = exec::lock(&done).clone();
        tests.sort_by(|a, b| a.name.cmp(&b.name));
        let seconds: f64 = tests.iter().map(|t| t.seconds).sum();
        println!("{}: {} tests, {seconds:.1} s", program.name, tests.len());
        let text = serde_json::to_vec(&Measured {
            build,
            tests: tests.clone(),
        })
        .map_err(|e| e.to_string())?;
        fs::write(&kept, text).map_err(|e| format!("{}: {e}", kept.display()))?;
        all.extend(tests);
    }
    for test in all.iter().filter(|t| !t.good) {
        println!(
            "left out, fails without a mutant: {}::{}",
            test.program, test.name
        );
    }
    let count = all.len();
    all.retain(|t| t.good && config.quick(&format!("{}::{}", t.program, t.name), t.seconds));
    println!("{} of {count} tests are run", all.len());
    Ok(all)
}

fn one(state: &Path, program: &Program, name: &str, worker: usize) -> Result<Test, String> {
    let reached = state.join(format!("reached_{worker}"));
    let output = state.join(format!("output_{worker}"));
    let _ = fs::remove_file(&reached);
    let run = |env| Run {
        program,
        names: vec![name],
        env,
        limit: Duration::from_secs(600),
        output: &output,
    };
    let (end, _) = exec::run(&run(Some((
        "CVTCYCLE_MUTANTS_REACHED",
        reached.display().to_string(),
    ))))?;
    let text = fs::read_to_string(&reached).unwrap_or_default();
    let mut reaches: Vec<u32> = text.lines().filter_map(|l| l.parse().ok()).collect();
    reaches.sort_unstable();
    reaches.dedup();
    let (again, time) = if reaches.is_empty() {
        (end, Duration::ZERO)
    } else {
        exec::run(&run(None))?
    };
    let good = end == End::Passed && again == End::Passed;
    Ok(Test {
        program: program.name.clone(),
        name: name.to_owned(),
        seconds: time.as_secs_f64(),
        reaches,
        good,
    })
}
