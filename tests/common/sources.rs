//! Rust sources of all crates, by module.

use std::path::Path;

/// File without its unit tests.
pub struct Source {
    /// Crate and module: `config::bounded`; the program is `cvtcycle`.
    pub module: String,
    /// Text before `#[cfg(test)]`.
    pub code: String,
}

/// Reads every source except files of unit tests.
#[must_use]
pub fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut list = Vec::new();
    walk(&root.join("src"), "cvtcycle", &mut list);
    for entry in std::fs::read_dir(root.join("crates")).unwrap() {
        let folder = entry.unwrap().path();
        let name = folder.file_name().unwrap().to_str().unwrap().to_owned();
        walk(&folder.join("src"), &name, &mut list);
    }
    list.sort_by(|a, b| a.module.cmp(&b.module));
    assert!(list.len() > 200, "{}", list.len());
    list
}

fn walk(folder: &Path, module: &str, list: &mut Vec<Source>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let inner = format!("{module}::{name}");
        if name == "tests" {
            continue;
        } else if path.is_dir() {
            walk(&path, &inner, list);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            let own = ["mod", "lib", "main"].contains(&name);
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            list.push(Source {
                module: if own { module.to_owned() } else { inner },
                code: code.to_owned(),
            });
        }
    }
}
