//! Mutation check of the physics: `docs/mutation.md`.
//!
//! All mutants are written into one copy of the sources and built once; `CVTCYCLE_MUTANT=17` switches one of them on.

mod compile;
mod config;
mod copy;
mod exec;
mod find;
mod hunt;
mod page;
mod point;
mod reach;
mod sample;

use clap::Parser;
use config::Config;
use hunt::{Fate, Hunt, Outcome, Quarry};
use page::{Judged, Made};
use point::Point;
use std::collections::HashSet;
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
    /// So many mutants, drawn over all files.
    #[arg(long, value_name = "N")]
    sample: Option<usize>,
    /// Seed of the draw.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Only print the mutants.
    #[arg(long)]
    list: bool,
    /// Write the page of the run there.
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
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
    let all = copy::points(&root, &config, &copy::files(&root)?)?;
    let population = all.iter().map(|p| p.choices.len()).sum::<usize>();
    let known: HashSet<String> = keys(&all).collect();
    let of_files = |p: &Point| arguments.file.is_empty() || arguments.file.contains(&p.file);
    let mut points: Vec<Point> = all.into_iter().filter(of_files).collect();
    if let Some(count) = arguments.sample {
        points = sample::draw(points, count, arguments.seed);
    }
    if arguments.list {
        for point in &points {
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
    let drawn = keys(&points).count();
    let points = hunt(arguments, &root, state, &config, &points)?;
    let mutants = judged(&root, state, &points)?;
    print!("{}", page::table(&mutants));
    let without = complain(&root, &mutants, &known)?;
    if let Some(path) = &arguments.page {
        let made = Made {
            command: &command(arguments),
            counts: (population, drawn - mutants.len()),
            seconds: config.most_seconds,
            methods: &config.methods,
        };
        let text = page::page(&root, &made, &mutants);
        std::fs::write(path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(without == 0)
}

/// Names of all mutants of some points.
fn keys(points: &[Point]) -> impl Iterator<Item = String> {
    points
        .iter()
        .flat_map(|p| p.choices.iter().map(|c| p.key(c)))
}

/// The command that repeats a run.
fn command(arguments: &Arguments) -> String {
    let mut text = "cargo run --release --manifest-path tools/mutation/Cargo.toml --target-dir target/tools --".to_owned();
    for file in &arguments.file {
        text += &format!(" --file {file}");
    }
    if let Some(count) = arguments.sample {
        text += &format!(" --sample {count} --seed {}", arguments.seed);
    }
    if let Some(seconds) = arguments.most_seconds {
        text += &format!(" --most-seconds {seconds}");
    }
    text + " --page docs/mutation.md"
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
    points: &[Point],
) -> Result<Vec<Point>, String> {
    let (copy, dropped) =
        compile::compiling(root, &state.join("copy"), points, read_dropped(state))?;
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
    let tests = reach::measure(state, &programs, config, arguments.jobs)?;
    println!(
        "{} tests, {:.0} s",
        tests.len(),
        tests.iter().map(|t| t.seconds).sum::<f64>()
    );
    let known = hunt::log(state);
    let mut mutants = Vec::new();
    for point in &points {
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
    Hunt {
        state,
        programs: &programs,
        tests: &tests,
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

/// Each mutant with its fate and its reason.
fn judged(root: &Path, state: &Path, points: &[Point]) -> Result<Vec<Judged>, String> {
    let reasons = config::survivors(root)?;
    let log = hunt::log(state);
    let one = |point: &Point, key: String| Judged {
        file: point.file.clone(),
        line: point.line,
        fate: log.get(&key).map(|o| o.fate),
        reason: reasons.get(&key).cloned(),
        key,
    };
    let all = points
        .iter()
        .flat_map(|p| p.choices.iter().map(|c| one(p, p.key(c))));
    Ok(all.collect())
}

/// Prints survivors without a reason, and reasons without a survivor. Answers with the number of the former.
fn complain(root: &Path, mutants: &[Judged], known: &HashSet<String>) -> Result<usize, String> {
    let caught = |m: &&Judged| matches!(m.fate, Some(Fate::Caught | Fate::Hung));
    let mut without = 0;
    for mutant in mutants.iter().filter(|m| !caught(m) && m.reason.is_none()) {
        let fate = mutant
            .fate
            .map_or("not run".to_owned(), |f| format!("{f:?}").to_lowercase());
        println!(
            "no reason, {fate}, {}:{}: {}",
            mutant.file, mutant.line, mutant.key
        );
        without += 1;
    }
    for mutant in mutants.iter().filter(|m| caught(m) && m.reason.is_some()) {
        println!("a reason for a mutant that is caught: {}", mutant.key);
    }
    for key in config::survivors(root)?
        .keys()
        .filter(|k| !known.contains(*k))
    {
        println!("a reason for no mutant: {key}");
    }
    Ok(without)
}
