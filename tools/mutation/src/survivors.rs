//! The list of mutants that no test catches, each with its reason: `tools/mutation/survivors.toml`.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

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
pub fn read(root: &Path) -> Result<BTreeMap<String, String>, String> {
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
