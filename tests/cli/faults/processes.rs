//! Several processes on one folder in any order, each of which may be killed at any moment. Afterwards the folder has one of the complete
//! results, a successful reader has read one, and the next command leaves no hidden file.
//! `cargo test` tries a few interleavings. For more: `CVTCYCLE_INTERLEAVINGS=1000 CVTCYCLE_SEED=7 cargo test --test cli processes`. A failing one
//! is repeated by its number: `CVTCYCLE_SEED=7 CVTCYCLE_FIRST=412 CVTCYCLE_INTERLEAVINGS=1`, though timing depends on the machine.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::{bin, ends, folder, program, tree, words};

/// Number of interleavings of `cargo test`.
const DEFAULT_INTERLEAVINGS: u64 = 24;

const PLANS: [(&str, &str); 2] = [
    ("p.toml", "1000, 1050, 1100"),
    ("q.toml", "1200, 1300, 1400"),
];
/// Number of points of a plan, each of which is a part.
const PARTS: usize = 3;

/// Kinds of commands on the folder `it`.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Writes into a new folder.
    Write,
    /// Replaces an earlier result.
    Replace,
    /// Reads, with its answer in the file `answer` or on standard output.
    Read,
}

const A: &str = "run --cycle minute.csv --vehicle rover_216_5mt --baseline none --sensitivity never --quiet --out it";
const B: &str = "run --cycle minute.csv --vehicle rover_216_5mt --baseline none --sensitivity never --ambient 0 --quiet --out it";
const LOSSES: &str = "losses --ratio low --speed 2000 --temp 80 --quiet --out it";
const P: &str = "study p.toml --quiet --out it";
const Q: &str = "study q.toml --quiet --out it";

/// Commands: kind, line, and option. Add here every new command that writes or reads a folder of results.
const COMMANDS: [(Kind, &str, &str); 13] = [
    (Kind::Write, A, ""),
    (Kind::Write, B, ""),
    (Kind::Write, LOSSES, ""),
    (Kind::Write, P, ""),
    (Kind::Replace, A, " --force"),
    (Kind::Replace, B, " --force"),
    (Kind::Replace, LOSSES, " --force"),
    (Kind::Replace, P, " --resume"),
    (Kind::Replace, P, " --force"),
    (Kind::Replace, Q, " --force"),
    (
        Kind::Read,
        "report it --quiet --force --out answer.html",
        "",
    ),
    (Kind::Read, "study show it --json", ""),
    (
        Kind::Read,
        "study export it --quiet --force --out answer.csv",
        "",
    ),
];

/// Random numbers from a seed (splitmix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) % n
    }
}

type Files = BTreeMap<PathBuf, Vec<u8>>;

/// Contents of a folder without command lines, which differ by an option.
fn files(dir: &Path) -> Files {
    let mut files = match dir.exists() {
        true => tree(dir),
        false => Files::new(),
    };
    if let Some(record) = files.get_mut(Path::new("inputs.json")) {
        let text = String::from_utf8_lossy(record).into_owned();
        let lines = text
            .lines()
            .filter(|line| !line.starts_with("  \"command\":"));
        *record = lines.collect::<Vec<_>>().join("\n").into_bytes();
    }
    files
}

fn is_hidden(path: &Path) -> bool {
    path.iter()
        .any(|name| name.to_string_lossy().starts_with('.'))
}

fn put(dir: &Path, files: &Files) {
    drop(fs::remove_dir_all(dir));
    for (name, bytes) in files {
        let path = dir.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// Answer of a reader that has ended: page, table, or standard output.
fn answer(dir: &Path, line: &str, printed: Vec<u8>) -> Vec<u8> {
    match line.rsplit_once("--out ") {
        Some((_, file)) => fs::read(dir.join(file)).unwrap_or_default(),
        None => printed,
    }
}

/// Expected results: each command alone in an empty folder, and the answers of each reader to these results, complete or partial.
struct Golden {
    dir: tempfile::TempDir,
    /// Files by command line; for a study those with each set of its parts.
    results: BTreeMap<String, Files>,
    answers: BTreeMap<&'static str, BTreeSet<Vec<u8>>>,
}

impl Golden {
    fn new() -> Self {
        let dir = folder();
        let plan = |values: &str| {
            format!(
                "[study]\ntitle = \"t\"\nvehicle = \"rover_216_5mt\"\nbaselines = []\ncycle = \"minute.csv\"\n\
                keep = [\"time_s\", \"gear\"]\n[study.design.grid]\n[[factor]]\nkey = \"road_load.mass_kg\"\nvalues = [{values}]\n"
            )
        };
        for (name, values) in PLANS {
            fs::write(dir.path().join(name), plan(values)).unwrap();
        }
        let it = dir.path().join("it");
        let mut golden = Golden {
            results: BTreeMap::new(),
            answers: BTreeMap::new(),
            dir,
        };
        let writers = COMMANDS.iter().filter(|(kind, ..)| *kind != Kind::Read);
        for (_, line, option) in writers.filter(|(_, _, option)| *option != " --resume") {
            drop(fs::remove_dir_all(&it));
            if !option.is_empty() {
                ends(golden.path(), line, 0);
            }
            ends(golden.path(), &format!("{line}{option}"), 0);
            let whole = tree(&it);
            golden
                .results
                .insert(format!("{line}{option}"), whole.clone());
            let begun = if line.starts_with("study") {
                1 << PARTS
            } else {
                1
            };
            for gone in 0..begun {
                put(&it, &whole);
                for part in (0..PARTS).filter(|part| gone >> part & 1 == 1) {
                    fs::remove_file(it.join(format!("parts/part_{part:05}.sha256"))).unwrap();
                }
                golden.ask();
            }
        }
        golden
    }

    fn path(&self) -> &Path {
        self.dir.path()
    }

    /// Records the answers of all readers to the current folder.
    fn ask(&mut self) {
        for (_, line, _) in COMMANDS.iter().filter(|(kind, ..)| *kind == Kind::Read) {
            let output = program(self.path(), &words(line)).output().unwrap();
            if matches!(output.status.code(), Some(0 | 1)) {
                let answer = answer(self.path(), line, output.stdout);
                self.answers.entry(line).or_default().insert(answer);
            }
        }
    }

    /// Files of a command, without command lines.
    fn whole(&self, line: &str) -> Files {
        let dir = self.path().join("golden");
        put(&dir, &self.results[line]);
        files(&dir)
    }
}

impl Golden {
    /// True if all files of a result are present, and others only as leftovers of an earlier result.
    fn is_whole(&self, shown: &Files) -> bool {
        let all: Vec<Files> = self.results.keys().map(|line| self.whole(line)).collect();
        let has = |result: &Files, name: &PathBuf| result.get(name) == shown.get(name);
        all.iter().any(|result| {
            let mut left = shown.keys().filter(|name| !result.contains_key(*name));
            result.keys().all(|name| has(result, name))
                && left.all(|name| all.iter().any(|earlier| has(earlier, name)))
        })
    }
}

/// System calls after which a process may be killed: those that change a folder or make changes durable.
const KILLED_CALLS: &str =
    "rename,renameat,renameat2,unlink,unlinkat,link,linkat,mkdir,fsync,ftruncate";

struct Process {
    name: String,
    kind: Kind,
    line: &'static str,
    place: PathBuf,
    traced: bool,
    child: Child,
}

/// Starts a command, which may be killed at one of its calls.
fn begin(dir: &Path, number: usize, traced: bool, random: &mut Random) -> Process {
    let (kind, line, option) = COMMANDS[random.below(COMMANDS.len() as u64) as usize];
    let place = dir.join(format!("place_{number}"));
    fs::create_dir(&place).unwrap();
    let text = format!("{line}{option}").replace("answer.", &format!("place_{number}/answer."));
    let at_call = traced && random.below(2) == 0;
    let when = 1 + random.below(40);
    let mut command = match at_call {
        true => {
            let mut command = Command::new("strace");
            command
                .args([
                    "-f",
                    "-qq",
                    "-o",
                    "/dev/null",
                    "-e",
                    &format!("trace={KILLED_CALLS}"),
                    "-e",
                ])
                .arg(format!("inject={KILLED_CALLS}:signal=KILL:when={when}"))
                .arg(bin());
            command
        }
        false => Command::new(bin()),
    };
    let child = command
        .current_dir(dir)
        .args(words(&text))
        .env("RAYON_NUM_THREADS", "2")
        .stdout(fs::File::create(place.join("stdout")).unwrap())
        .stderr(fs::File::create(place.join("stderr")).unwrap())
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    let name = match at_call {
        true => format!("{text} (killed at call {when})"),
        false => text,
    };
    Process {
        name,
        kind,
        line,
        place,
        traced: at_call,
        child,
    }
}

/// Runs one interleaving; the error describes the violation.
fn interleaving(golden: &Golden, traced: bool, random: &mut Random) -> Result<(), String> {
    let dir = golden.path();
    let it = dir.join("it");
    for number in 0..3 {
        drop(fs::remove_dir_all(dir.join(format!("place_{number}"))));
    }
    let start = [None, Some(A), Some(P), Some(P)][random.below(4) as usize];
    put(
        &it,
        &start.map_or_else(Files::new, |line| golden.results[line].clone()),
    );
    if start == Some(P) && random.below(2) == 0 {
        fs::remove_file(it.join("parts/part_00001.sha256")).unwrap();
    }
    let count = if random.below(3) == 0 { 3 } else { 2 };
    let mut processes = Vec::new();
    for number in 0..count {
        processes.push(begin(dir, number, traced, random));
        sleep(Duration::from_millis(random.below(60)));
    }
    if random.below(3) == 0 {
        let victim = &processes[random.below(count as u64) as usize];
        let signal = ["INT", "KILL", "TERM"][random.below(3) as usize];
        // A traced process would continue without its tracer. It may have ended.
        if !victim.traced {
            let id = victim.child.id().to_string();
            let mut kill = Command::new("kill");
            kill.args(["-s", signal, &id]).stderr(Stdio::null());
            drop(kill.status());
        }
    }
    let mut said = format!("from {}", start.unwrap_or("nothing"));
    let mut written = 0;
    for process in &mut processes {
        let status = process.child.wait().unwrap();
        let (code, signal) = (status.code(), status.signal());
        let stderr = fs::read_to_string(process.place.join("stderr")).unwrap();
        said += &format!("\n{}: {code:?} {signal:?} {stderr}", process.name);
        // 128 + signal: strace ends as its tracee does.
        let allowed = match (code, signal) {
            (Some(code), _) => [0, 1, 2, 130, 137].contains(&code),
            (_, Some(signal)) => [2, 9, 15].contains(&signal),
            _ => false,
        };
        if !allowed {
            return Err(format!("{said}\nends in no way that is promised"));
        }
        written += usize::from(process.kind == Kind::Write && code == Some(0));
        if process.kind == Kind::Read && matches!(code, Some(0 | 1)) {
            let printed = fs::read(process.place.join("stdout")).unwrap();
            let answer = answer(&process.place, process.line, printed);
            if !golden.answers[process.line].contains(&answer) {
                return Err(format!(
                    "{said}\nan answer of no whole result: {}",
                    process.name
                ));
            }
        }
    }
    if written > 1 || written == 1 && start.is_some() {
        return Err(format!("{said}\nmore than one wrote where nothing may be"));
    }
    // A reader completes a pending commit.
    drop(program(dir, &words("report it --quiet --force --out now.html")).output());
    let shown: Files = files(&it)
        .into_iter()
        .filter(|(name, _)| !is_hidden(name))
        .collect();
    let is_study = it.join("study.json").exists();
    if !is_study && !shown.is_empty() && !golden.is_whole(&shown) {
        let names: Vec<_> = shown.keys().collect();
        return Err(format!("{said}\nno whole result: {names:?}"));
    }
    let next = match (is_study, shown.is_empty()) {
        (true, _) => format!("{P} --force"),
        (false, true) => A.to_owned(),
        (false, false) => format!("{A} --force"),
    };
    let output = program(dir, &words(&next)).output().unwrap();
    if output.status.code() != Some(0) {
        let stderr = String::from_utf8_lossy(&output.stderr);
        return Err(format!(
            "{said}\nthe next command: {next}: {:?} {stderr}",
            output.status
        ));
    }
    let (after, expected) = (files(&it), golden.whole(&next));
    // An earlier result of a run may have more files, which --force keeps and reports.
    let differs = |name: &&PathBuf| after.get(*name) != expected.get(*name);
    let mut wrong = expected
        .keys()
        .filter(differs)
        .chain(after.keys().filter(|name| is_hidden(name)));
    match wrong.next() {
        None => Ok(()),
        Some(name) => Err(format!("{said}\nafter {next}: {}", name.display())),
    }
}

fn number_of(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

#[test]
fn processes_on_one_folder_leave_whole_results() {
    let traced = Command::new("strace")
        .args(["-f", "-o", "/dev/null", "-e", "trace=fsync", "true"])
        .status()
        .is_ok_and(|status| status.success());
    if !traced {
        eprintln!("skipped: ends at chosen calls, strace does not work here");
    }
    let golden = Golden::new();
    let (seed, first) = (
        number_of("CVTCYCLE_SEED").unwrap_or(23),
        number_of("CVTCYCLE_FIRST").unwrap_or(0),
    );
    let count = number_of("CVTCYCLE_INTERLEAVINGS").unwrap_or(DEFAULT_INTERLEAVINGS);
    let mut failed = Vec::new();
    for number in first..first + count {
        let mut random = Random(seed ^ number.wrapping_mul(0x2545_f491_4f6c_dd1d));
        if let Err(words) = interleaving(&golden, traced, &mut random) {
            eprintln!("interleaving {number} of seed {seed}: {words}\n");
            failed.push(number);
        }
    }
    assert!(failed.is_empty(), "of {count}, seed {seed}: {failed:?}");
}
