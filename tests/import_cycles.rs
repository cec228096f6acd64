//! Import cycles between the modules of a crate, found from the `use` lines of the sources.
//!
//! The modules of every folder are compared with each other; contents of a folder count as the folder. Unit tests below
//! `#[cfg(test)]` do not count.

#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

type Graph = BTreeMap<String, BTreeSet<String>>;

/// All source files below a folder.
fn sources(folder: &Path, into: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            sources(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// Module path of a source file below its crate's `src`.
fn module_of(file: &Path, src: &Path) -> Vec<String> {
    let mut path: Vec<String> = file
        .strip_prefix(src)
        .unwrap()
        .with_extension("")
        .components()
        .map(|c| c.as_os_str().to_string_lossy().into_owned())
        .collect();
    if matches!(
        path.last().map(String::as_str),
        Some("mod" | "lib" | "main")
    ) {
        path.pop();
    }
    path
}

/// All paths in a `use` tree, as segments: `a::{b, c::d}` gives `a::b` and `a::c::d`.
fn paths(tree: &str, before: &[String], into: &mut Vec<Vec<String>>) {
    let tree = tree.trim();
    let mut head: Vec<String> = before.to_vec();
    let mut rest = tree;
    loop {
        if let Some(inner) = rest.strip_prefix('{') {
            let (mut depth, mut from) = (0, 0);
            let inner = inner.strip_suffix('}').unwrap_or(inner);
            for (at, letter) in inner.char_indices() {
                match letter {
                    '{' => depth += 1,
                    '}' => depth -= 1,
                    ',' if depth == 0 => {
                        paths(&inner[from..at], &head, into);
                        from = at + 1;
                    }
                    _ => {}
                }
            }
            if !inner[from..].trim().is_empty() {
                paths(&inner[from..], &head, into);
            }
            return;
        }
        match rest.split_once("::") {
            Some((segment, tail)) if !segment.contains('{') => {
                head.push(segment.trim().to_owned());
                rest = tail.trim();
            }
            _ => {
                let name = rest.split_whitespace().next().unwrap_or_default();
                if !name.is_empty() {
                    head.push(name.to_owned());
                    into.push(head);
                }
                return;
            }
        }
    }
}

/// Removes comments, and the unit tests at the end.
fn code(text: &str) -> String {
    text.split("#[cfg(test)]")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default())
        .collect::<Vec<_>>()
        .join("\n")
}

/// Absolute paths of all imports of a file, from the crate's root.
fn imports(text: &str, module: &[String]) -> Vec<Vec<String>> {
    let mut found = Vec::new();
    let code = code(text);
    for part in code.split(';') {
        let Some(at) = part
            .rfind("use ")
            .filter(|at| *at == 0 || !part.as_bytes()[at - 1].is_ascii_alphanumeric())
        else {
            continue;
        };
        let mut trees = Vec::new();
        paths(&part[at + 4..].replace('\n', " "), &[], &mut trees);
        found.extend(trees);
    }
    // Paths without a `use`: crate::a::b(..).
    for at in code.match_indices("crate::").map(|(at, _)| at) {
        let path: String = code[at..]
            .chars()
            .take_while(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | ':'))
            .collect();
        found.push(
            path.trim_end_matches(':')
                .split("::")
                .map(str::to_owned)
                .collect(),
        );
    }
    found
        .into_iter()
        .filter_map(|path| match path.first().map(String::as_str) {
            Some("crate") => Some(path[1..].to_vec()),
            Some("super") => {
                let up = path.iter().take_while(|s| *s == "super").count();
                let keep = module.len().checked_sub(up)?;
                Some([&module[..keep], &path[up..]].concat())
            }
            Some("self") => Some([module, &path[1..]].concat()),
            _ => None,
        })
        .collect()
}

/// Imports between the modules directly below `root`, a module path of the crate.
fn graph(src: &Path, root: &[String]) -> Graph {
    let mut files = Vec::new();
    sources(src, &mut files);
    let modules: Vec<Vec<String>> = files.iter().map(|f| module_of(f, src)).collect();
    let names: BTreeSet<&String> = modules
        .iter()
        .filter(|m| m.starts_with(root))
        .filter_map(|m| m.get(root.len()))
        .collect();
    let mut graph = Graph::new();
    for (file, module) in files.iter().zip(&modules) {
        let Some(from) = module.get(root.len()).filter(|_| module.starts_with(root)) else {
            continue;
        };
        for path in imports(&fs::read_to_string(file).unwrap(), module) {
            let to = path.get(root.len()).filter(|_| path.starts_with(root));
            if let Some(to) = to.filter(|to| names.contains(to) && *to != from) {
                graph.entry(from.clone()).or_default().insert(to.clone());
            }
        }
    }
    graph
}

/// Modules of an import cycle, if there is one.
fn cycle(graph: &Graph) -> Option<Vec<String>> {
    fn visit(graph: &Graph, at: &str, way: &mut Vec<String>, done: &mut BTreeSet<String>) -> bool {
        if let Some(from) = way.iter().position(|m| m == at) {
            way.drain(..from);
            return true;
        }
        if done.contains(at) {
            return false;
        }
        way.push(at.to_owned());
        for to in graph.get(at).into_iter().flatten() {
            if visit(graph, to, way, done) {
                return true;
            }
        }
        way.pop();
        done.insert(at.to_owned());
        false
    }
    let (mut way, mut done) = (Vec::new(), BTreeSet::new());
    graph
        .keys()
        .any(|at| visit(graph, at, &mut way, &mut done))
        .then_some(way)
}

fn complaint(src: &str, root: &[String]) -> Option<String> {
    let found = graph(&Path::new(env!("CARGO_MANIFEST_DIR")).join(src), root);
    assert!(
        !found.is_empty() || !root.is_empty(),
        "no imports below {src}"
    );
    cycle(&found).map(|way| {
        format!(
            "{src} {}: {} -> {}",
            root.join("::"),
            way.join(" -> "),
            way[0]
        )
    })
}

/// Property: the modules of each crate can be ordered so that each imports earlier ones only.
#[test]
fn modules_import_in_one_direction() {
    let crates = [
        "analysis",
        "calibrate",
        "config",
        "fleet",
        "fmu",
        "model",
        "output",
        "report",
        "study",
        "validate",
    ];
    let folders = crates.map(|name| format!("crates/{name}/src"));
    let mut found = Vec::new();
    for src in folders.iter().map(String::as_str).chain(["src"]) {
        found.extend(rooms(src).iter().filter_map(|room| complaint(src, room)));
    }
    assert!(found.is_empty(), "import cycles:\n{}", found.join("\n"));
}

/// Module paths of a crate that have submodules, including the crate's root.
fn rooms(src: &str) -> BTreeSet<Vec<String>> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(src);
    let mut files = Vec::new();
    sources(&src, &mut files);
    let modules = files.iter().map(|file| module_of(file, &src));
    modules
        .filter_map(|module| module.split_last().map(|(_, above)| above.to_vec()))
        .collect()
}

/// Property: `docs/img/house.svg` names the modules of every crate, and no others: `tools/house` draws it.
#[test]
fn the_picture_of_the_house_matches_the_modules() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let picture = fs::read_to_string(root.join("docs/img/house.svg")).unwrap();
    let floors = [
        "src",
        "report",
        "fleet",
        "analysis",
        "calibrate",
        "study",
        "validate",
        "output",
        "config",
        "model",
    ];
    let mut parts = picture.split("class=\"t\">").skip(1);
    for floor in floors {
        let drawn = parts.next().expect("a part for each crate");
        let names = drawn.split("class=\"m\">").skip(1);
        let names: BTreeSet<&str> = names.filter_map(|n| n.split('<').next()).collect();
        let folder = root.join(if floor == "src" {
            floor.to_owned()
        } else {
            format!("crates/{floor}/src")
        });
        let modules: BTreeSet<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .filter(|name| !["lib", "main", "tests"].contains(&name.as_str()))
            .collect();
        assert!(modules.iter().eq(names), "{floor}: draw {modules:?}");
    }
}

/// Imports are found in nested trees, `super`, `self` and inline paths, but not in comments or unit tests.
#[test]
fn imports_are_read() {
    let text = "use crate::a::{b, c::{D, e}};\nuse super::{x::Y, z};\nuse self::own;\nuse std::fmt;\n// use crate::not;\n\
                fn f() { crate::g::h(1) }\n#[cfg(test)]\nmod tests { use crate::never; }";
    let module = ["m".to_owned(), "n".to_owned()];
    let mut found: Vec<String> = imports(text, &module)
        .iter()
        .map(|p| p.join("::"))
        .collect();
    found.sort();
    found.dedup();
    let wanted = [
        "a",
        "a::b",
        "a::c::D",
        "a::c::e",
        "g::h",
        "m::n::own",
        "m::x::Y",
        "m::z",
    ];
    assert_eq!(found, wanted);
    let graph = |pairs: &[(&str, &str)]| -> Graph {
        let mut graph = Graph::new();
        for (from, to) in pairs {
            graph
                .entry((*from).into())
                .or_default()
                .insert((*to).into());
        }
        graph
    };
    assert_eq!(cycle(&graph(&[("a", "b"), ("b", "c"), ("a", "c")])), None);
    let way = cycle(&graph(&[("a", "b"), ("b", "c"), ("c", "b")])).unwrap();
    assert_eq!(way, ["b", "c"]);
}
