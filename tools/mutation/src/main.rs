//! Mutation check of the physics: `docs/mutation.md`.
//!
//! All mutants are written into one copy of the sources and built once; `CVTCYCLE_MUTANT=17` switches one of them on.

mod compile;
mod config;
mod copy;
mod exec;
mod find;
mod hunt;
mod point;
mod reach;

use clap::Parser;
use config::Config;
use hunt::{Fate, Hunt, Outcome, Quarry};
use point::Point;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Writes mutants of the physics into a copy of the repository, and lists those that no test catches.
#[derive(Debug, Parser)]
#[command(
    after_help = "Example: cargo run --release --manifest-path tools/mutation/Cargo.toml --target-dir target/tools -- --file src/thermal/mod.rs"
)]
struct Arguments {
    /// Root of the repository.
    #[arg(long, default_value = ".")]
    root: PathBuf,
    /// Folder for the copy and the log.
    #[arg(long, default_value = "target/mutation")]
    out: PathBuf,
    /// Tests that run at the same time.
    #[arg(long, default_value_t = 2)]
    jobs: usize,
    /// Only mutants of this file; may be repeated.
    #[arg(long)]
    file: Vec<String>,
    /// Only print the mutants.
    #[arg(long)]
    list: bool,
    /// Only judge what the log holds, without a build.
    #[arg(long)]
    judge: bool,
    /// Only tests of this program, of the configuration or not, against what is not caught yet; may be repeated. What they do not
    /// catch is not logged.
    #[arg(long)]
    test: Vec<String>,
    /// Tests that take longer are not run, s; otherwise the configuration says.
    #[arg(long)]
    most_seconds: Option<f64>,
    /// Hunt again what was caught before.
    #[arg(long)]
    fresh: bool,
}

fn main() -> ExitCode {
    match work(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
    }
}

fn work(arguments: &Arguments) -> Result<bool, String> {
    let root = arguments
        .root
        .canonicalize()
        .map_err(|e| format!("{}: {e}", arguments.root.display()))?;
    let mut config = Config::read(&root)?;
    config.most_seconds = arguments.most_seconds.unwrap_or(config.most_seconds);
    if !arguments.test.is_empty() {
        config.tests.clone_from(&arguments.test);
    }
    if arguments.list {
        for point in copy::points(&root, &config, &copy::files(&root)?)? {
            for choice in &point.choices {
                println!("{}:{} {}", point.file, point.line, point.key(choice));
            }
        }
        return Ok(true);
    }
    let state = &arguments.out;
    std::fs::create_dir_all(state).map_err(|e| format!("{}: {e}", state.display()))?;
    let state = &state
        .canonicalize()
        .map_err(|e| format!("{}: {e}", state.display()))?;
    let points = if arguments.judge {
        let dropped = read_dropped(state);
        let all = copy::points(&root, &config, &copy::files(&root)?)?;
        all.into_iter()
            .filter(|p| !dropped.contains(&copy::name(p)))
            .collect()
    } else {
        hunt(arguments, &root, state, &config)?
    };
    let judged = |p: &&Point| arguments.file.is_empty() || arguments.file.contains(&p.file);
    judge(
        &root,
        state,
        &points.iter().filter(judged).collect::<Vec<_>>(),
    )
}

fn read_dropped(state: &Path) -> HashSet<String> {
    std::fs::read_to_string(state.join("dropped.txt"))
        .unwrap_or_default()
        .lines()
        .map(str::to_owned)
        .collect()
}

/// Builds, measures, hunts; answers with the points that compile.
fn hunt(
    arguments: &Arguments,
    root: &Path,
    state: &Path,
    config: &Config,
) -> Result<Vec<Point>, String> {
    let (copy, dropped) =
        compile::compiling(root, &state.join("copy"), config, read_dropped(state))?;
    let mut names: Vec<&str> = dropped.iter().map(String::as_str).collect();
    names.sort_unstable();
    std::fs::write(state.join("dropped.txt"), names.join("\n"))
        .map_err(|e| format!("{}: {e}", state.display()))?;
    let points: Vec<Point> = copy
        .points
        .iter()
        .filter(|p| !dropped.contains(&copy::name(p)))
        .cloned()
        .collect();
    let count: usize = points.iter().map(|p| p.choices.len()).sum();
    println!(
        "{count} mutants at {} points; {} points do not compile",
        points.len(),
        dropped.len()
    );
    let programs = compile::tests(&copy, config)?;
    let tests = reach::measure(&copy.root, state, &programs, config, arguments.jobs)?;
    println!(
        "{} tests, {:.0} s",
        tests.len(),
        tests.iter().map(|t| t.seconds).sum::<f64>()
    );
    let known = hunt::log(state);
    let mut mutants = Vec::new();
    for point in points
        .iter()
        .filter(|p| arguments.file.is_empty() || arguments.file.contains(&p.file))
    {
        let source = source(root, &point.file)?;
        for choice in &point.choices {
            let key = point.key(choice);
            let caught =
                |o: &Outcome| o.source == source && matches!(o.fate, Fate::Caught | Fate::Hung);
            if arguments.fresh || !known.get(&key).is_some_and(caught) {
                mutants.push(Quarry {
                    number: choice.number,
                    key,
                    source,
                });
            }
        }
    }
    println!("{} mutants to hunt", mutants.len());
    let all_tests = arguments.test.is_empty();
    Hunt {
        root: &copy.root,
        state,
        programs: &programs,
        tests: &tests,
        all_tests,
    }
    .all(&mutants, arguments.jobs)?;
    Ok(points)
}

/// A file's text without its tests as a number.
fn source(root: &Path, file: &str) -> Result<u64, String> {
    let text = std::fs::read_to_string(root.join(file)).map_err(|e| format!("{file}: {e}"))?;
    let code = text
        .split_once("#[cfg(test)]\nmod tests {")
        .map_or(text.as_str(), |(code, _)| code);
    let mut hasher = DefaultHasher::new();
    code.hash(&mut hasher);
    Ok(hasher.finish())
}

/// Counts of one file.
#[derive(Default)]
struct Counts {
    mutants: usize,
    caught: usize,
    survived: usize,
    unreached: usize,
    reasoned: usize,
}

/// Prints counts, survivors without a reason, and reasons without a survivor. Whether all survivors have a reason.
fn judge(root: &Path, state: &Path, points: &[&Point]) -> Result<bool, String> {
    let reasons = config::survivors(root)?;
    let log = hunt::log(state);
    let mut files: BTreeMap<&str, Counts> = BTreeMap::new();
    let (mut without, mut fates) = (Vec::new(), HashMap::new());
    for point in points {
        let counts = files.entry(&point.file).or_default();
        for choice in &point.choices {
            let key = point.key(choice);
            let fate = log.get(&key).map(|o| o.fate);
            counts.mutants += 1;
            match fate {
                Some(Fate::Caught | Fate::Hung) => counts.caught += 1,
                Some(Fate::Survived) => counts.survived += 1,
                Some(Fate::Unreached) | None => counts.unreached += 1,
            }
            if !matches!(fate, Some(Fate::Caught | Fate::Hung)) {
                match reasons.get(&key) {
                    Some(_) => counts.reasoned += 1,
                    None => without.push((fate, point.line, key.clone())),
                }
            }
            fates.insert(key, fate);
        }
    }
    println!(
        "| file | mutants | caught | survived | not reached | with a reason |\n|---|---|---|---|---|---|"
    );
    let mut sum = Counts::default();
    for (file, c) in &files {
        println!(
            "| {file} | {} | {} | {} | {} | {} |",
            c.mutants, c.caught, c.survived, c.unreached, c.reasoned
        );
        sum.mutants += c.mutants;
        sum.caught += c.caught;
        sum.survived += c.survived;
        sum.unreached += c.unreached;
        sum.reasoned += c.reasoned;
    }
    println!(
        "| all | {} | {} | {} | {} | {} |",
        sum.mutants, sum.caught, sum.survived, sum.unreached, sum.reasoned
    );
    for (fate, line, key) in &without {
        let fate = fate.map_or("not run".to_owned(), |f| format!("{f:?}").to_lowercase());
        println!("no reason, {fate}, line {line}: {key}");
    }
    for key in reasons
        .keys()
        .filter(|k| files.contains_key(k.split(" | ").next().unwrap_or_default()))
    {
        match fates.get(key) {
            None => println!("a reason for no mutant: {key}"),
            Some(Some(Fate::Caught | Fate::Hung)) => {
                println!("a reason for a mutant that is caught: {key}")
            }
            Some(_) => {}
        }
    }
    Ok(without.is_empty())
}
