//! The page of a run, `docs/mutation.md`: counts by file, and the reason of each mutant that no test catches.

use crate::config::Methods;
use crate::hunt::Fate;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// What became of one mutant.
pub struct Judged {
    /// Path of its file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Name.
    pub key: String,
    /// Its fate; nothing where it was not run.
    pub fate: Option<Fate>,
    /// Why no test needs to catch it.
    pub reason: Option<String>,
}

/// Mutants of one file: all, caught, survived, not reached, with a reason.
#[derive(Clone, Copy, Default)]
struct Counts([usize; 5]);

impl Counts {
    fn add(&mut self, mutant: &Judged) {
        let fate = match mutant.fate {
            Some(Fate::Caught | Fate::Hung) => 1,
            Some(Fate::Survived) => 2,
            Some(Fate::Unreached) | None => 3,
        };
        self.0[0] += 1;
        self.0[fate] += 1;
        self.0[4] += usize::from(fate > 1 && mutant.reason.is_some());
    }
}

/// The table of counts.
#[must_use]
pub fn table(mutants: &[Judged]) -> String {
    let mut files: BTreeMap<&str, Counts> = BTreeMap::new();
    let mut sum = Counts::default();
    for mutant in mutants {
        files.entry(&mutant.file).or_default().add(mutant);
        sum.add(mutant);
    }
    let mut text =
        "| file | mutants | caught | survived | not reached | with a reason |\n|---|---|---|---|---|---|\n"
            .to_owned();
    for (name, Counts([all, caught, survived, unreached, reasoned])) in
        files.into_iter().chain([("all", sum)])
    {
        let name = name.strip_prefix("crates/model/src/").unwrap_or(name);
        let _ = writeln!(
            text,
            "| {name} | {all} | {caught} | {survived} | {unreached} | {reasoned} |"
        );
    }
    text
}

/// The commit, and whether sources or tests differ from it.
fn commit(root: &Path) -> String {
    let git = |args: &[&str]| {
        let output = Command::new("git").args(args).current_dir(root).output();
        output.map_or(String::new(), |o| {
            String::from_utf8_lossy(&o.stdout).trim().to_owned()
        })
    };
    let commit = git(&["rev-parse", "--short=12", "HEAD"]);
    if git(&[
        "status",
        "--porcelain",
        "--",
        "crates/model",
        "crates/config",
        "tests",
    ])
    .is_empty()
    {
        commit
    } else {
        format!("{commit} with changes")
    }
}

/// How a run was made.
pub struct Made<'a> {
    /// The command that repeats it.
    pub command: &'a str,
    /// Mutants that can be made, and those of the sample that do not compile.
    pub counts: (usize, usize),
    /// The time that a test may take, s.
    pub seconds: f64,
    /// Methods that are changed.
    pub methods: &'a Methods,
}

/// The page.
#[must_use]
pub fn page(root: &Path, made: &Made, mutants: &[Judged]) -> String {
    let Made {
        command,
        counts: (population, lost),
        seconds,
        methods,
    } = made;
    let mut changes = String::new();
    for (name, with) in &methods.replace {
        let _ = write!(changes, "`{name}` to {}; ", with.join(", "));
    }
    let names = |names: &mut dyn Iterator<Item = &String>| {
        names
            .map(|n| format!("`{n}`"))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut text = format!(
        "<!-- Written by tools/mutation; do not edit. -->\n# Mutation check of the physics\n\n\
        `tools/mutation` changes the model in one place at a time and runs the tests of the model that reach the place. A change that no test notices survives; \
        each survivor gets a test, or a reason in `tools/mutation/survivors.toml`.\n\n\
        ```console\n$ {command}\n```\n\n\
        Commit {}. {population} mutants can be made; {} were drawn from all files, {lost} of them do not compile, and the others were tried, each in the same build \
        (`CVTCYCLE_MUTANT` switches one on), with the tests that take at most {seconds} s.\n\n\
        | what | becomes |\n|---|---|\n\
        | `+ - * / %`, `+= -= *= /=`, `== !=`, `&& \\|\\|`, `& \\|` of masks | its opposite |\n\
        | `< <= > >=` | the same with or without the bound, and its negation |\n\
        | methods | {changes}{} with the values exchanged |\n\
        | `-x`, `!x`, {} | `x` |\n\
        | literal above 0, constant of type f64 | times 1.05 |\n\
        | `powi(n)` | `powi(n + 1)` |\n\
        | `true`, `false`, condition of an `if` | its opposite |\n\
        | body of a function of f64, bool, Option or nothing | 0, 1, -1; true, false; None; nothing |\n\n\
        {}",
        commit(root),
        mutants.len() + lost,
        names(&mut methods.swap.iter()),
        names(&mut methods.drop.iter()),
        table(mutants),
    );
    let mut reasons: BTreeMap<&str, Vec<&Judged>> = BTreeMap::new();
    let caught = |m: &&Judged| matches!(m.fate, Some(Fate::Caught | Fate::Hung));
    for mutant in mutants.iter().filter(|m| !caught(m)) {
        let reason = mutant.reason.as_deref().unwrap_or("No reason yet.");
        reasons.entry(reason).or_default().push(mutant);
    }
    if !reasons.is_empty() {
        text += "\n## Not caught\n";
    }
    for (reason, mutants) in reasons {
        let _ = writeln!(text, "\n{reason}\n");
        for mutant in mutants {
            let _ = writeln!(text, "- `{}`", mutant.key);
        }
    }
    text
}
