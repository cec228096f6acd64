//! What is mutated and what is run, `tools/mutation/mutation.toml`; and the mutants that no test catches, each with its reason,
//! `tools/mutation/survivors.toml`.

use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// Folders (with a final slash) and files whose code is changed.
    pub mutate: Vec<String>,
    /// Files among them that are left alone, each with its reason.
    pub leave: Vec<Left>,
    /// Files among them whose operators are changed and whose literals are not.
    pub keep_literals: Vec<String>,
    /// Methods of numbers and masks that are changed.
    pub methods: Methods,
    /// Test programs that may catch a mutant: `package/program`, or a package for its unit tests.
    pub tests: Vec<String>,
    /// Tests that take longer are not run, s.
    pub most_seconds: f64,
    /// Beginnings of names, as `program::name`, of tests that are run however long they take.
    pub always: Vec<String>,
    /// Tests that are not run, each with its reason.
    pub skip: Vec<Skipped>,
}

/// Methods of numbers and masks, by name.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Methods {
    /// Of one argument: the methods that take its place.
    pub replace: BTreeMap<String, Vec<String>>,
    /// Called no longer: the value stays.
    pub drop: BTreeSet<String>,
    /// The last two values are exchanged.
    pub swap: BTreeSet<String>,
}

impl Methods {
    /// All names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let names = self.replace.keys().chain(&self.drop).chain(&self.swap);
        names.map(String::as_str)
    }
}

/// Something left alone.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Left {
    /// A folder (with a final slash), a file, or the end of the names of several.
    pub file: String,
    /// Why.
    pub because: String,
}

/// A test left out.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Skipped {
    /// Program and beginning of the test's name: `physics::conserve::`.
    pub test: String,
    /// Why.
    pub because: String,
}

impl Config {
    /// Reads it.
    ///
    /// # Errors
    /// No file, no TOML, other keys.
    pub fn read(root: &Path) -> Result<Self, String> {
        let path = root.join("tools/mutation/mutation.toml");
        let text =
            std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let config: Self = toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let reasons = config
            .leave
            .iter()
            .map(|l| &l.because)
            .chain(config.skip.iter().map(|s| &s.because));
        if reasons.clone().any(|because| because.is_empty()) {
            return Err(format!("{}: `because` is empty", path.display()));
        }
        Ok(config)
    }

    /// Whether a file of the repository is mutated.
    #[must_use]
    pub fn mutates(&self, file: &str) -> bool {
        let named = |name: &str| {
            if name.ends_with('/') {
                file.starts_with(name)
            } else {
                file == name
            }
        };
        let left = |name: &str| named(name) || file.ends_with(name);
        file.ends_with(".rs")
            && self.mutate.iter().any(|n| named(n))
            && !self.leave.iter().any(|l| left(&l.file))
    }

    /// Whether the literals of a file stay.
    #[must_use]
    pub fn keeps_literals(&self, file: &str) -> bool {
        self.keep_literals.iter().any(|end| file.ends_with(end))
    }

    /// Whether a test, as `program::name`, is quick enough.
    #[must_use]
    pub fn quick(&self, test: &str, seconds: f64) -> bool {
        seconds <= self.most_seconds || self.always.iter().any(|a| test.starts_with(a))
    }

    /// Whether a test, as `program::name`, may be run.
    #[must_use]
    pub fn runs(&self, test: &str) -> bool {
        !self.skip.iter().any(|s| test.starts_with(&s.test))
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    #[serde(default)]
    reason: Vec<Reason>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Reason {
    because: String,
    mutants: Vec<String>,
}

/// Reads the list: the reason of each mutant.
///
/// # Errors
/// It is no TOML, has other keys, or names a mutant twice.
pub fn survivors(root: &Path) -> Result<BTreeMap<String, String>, String> {
    let path = root.join("tools/mutation/survivors.toml");
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let list: List = toml::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut reasons = BTreeMap::new();
    for reason in list.reason {
        for mutant in reason.mutants {
            if let Some(_other) = reasons.insert(mutant.clone(), reason.because.clone()) {
                return Err(format!("{}: twice: {mutant}", path.display()));
            }
        }
    }
    Ok(reasons)
}
