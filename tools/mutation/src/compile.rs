//! Builds the copy, and drops the points whose mutants do not compile.

use crate::config::Config;
use crate::copy::{self, Copy};
use crate::point::Point;
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The package whose code is changed.
const PACKAGE: &str = "cvtcycle-model";

/// A test program.
#[derive(Clone, Debug)]
pub struct Program {
    /// As the configuration names it: `package/program`, or the package for its unit tests.
    pub name: String,
    /// The executable.
    pub path: PathBuf,
    /// Folder of the package: where Cargo runs its tests.
    pub folder: PathBuf,
}

/// Cargo in the copy, with the profiles of the repository.
fn cargo(root: &Path, args: &[&str]) -> Result<(bool, Vec<Value>), String> {
    let output = Command::new("cargo")
        .args(args)
        .args(["--locked", "--message-format", "json"])
        .current_dir(root)
        .envs([
            ("CARGO_INCREMENTAL", "0"),
            ("CARGO_PROFILE_TEST_DEBUG", "0"),
            ("CARGO_PROFILE_DEV_DEBUG", "0"),
        ])
        .env_remove("CVTCYCLE_MUTANT")
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| format!("cargo: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    Ok((
        output.status.success(),
        text.lines()
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect(),
    ))
}

/// Makes the copy and checks it until only what compiles is left, beginning without what was `dropped` before: a file that is written
/// twice is built twice. Answers with the copy and the names of all that was dropped.
///
/// # Errors
/// An error of the compiler that is in no point, or cargo cannot be run.
pub fn compiling(
    root: &Path,
    to: &Path,
    points: &[Point],
    mut dropped: HashSet<String>,
) -> Result<(Copy, HashSet<String>), String> {
    loop {
        let copy = copy::make(root, to, points, &dropped)?;
        let (good, messages) = cargo(to, &["check", "--lib", "-p", PACKAGE])?;
        if good {
            return Ok((copy, dropped));
        }
        let before = dropped.len();
        let mut unknown = Vec::new();
        for message in messages
            .iter()
            .filter(|m| m["reason"] == "compiler-message" && m["message"]["level"] == "error")
        {
            for span in message["message"]["spans"]
                .as_array()
                .into_iter()
                .flatten()
                .filter(|s| s["is_primary"] == true)
            {
                match guilty(&copy, span, &dropped) {
                    Some(name) => drop(dropped.insert(name)),
                    None => unknown.push(
                        message["message"]["rendered"]
                            .as_str()
                            .unwrap_or_default()
                            .to_owned(),
                    ),
                }
            }
        }
        if dropped.len() == before {
            return Err(format!(
                "the copy does not compile:\n{}",
                unknown.join("\n")
            ));
        }
    }
}

/// The smallest point that holds an error, or the smallest inside of it.
fn guilty(copy: &Copy, span: &Value, dropped: &HashSet<String>) -> Option<String> {
    let file = span["file_name"].as_str()?;
    let (start, end) = (
        span["byte_start"].as_u64()? as usize,
        span["byte_end"].as_u64()? as usize,
    );
    let points = || {
        copy.points
            .iter()
            .zip(&copy.ranges)
            .filter(|(p, r)| p.file == file && !r.is_empty() && !dropped.contains(&copy::name(p)))
    };
    let around = points()
        .filter(|(_, r)| r.start <= start && end <= r.end)
        .min_by_key(|(_, r)| r.len());
    let inside = || {
        points()
            .filter(|(_, r)| start <= r.start && r.end <= end)
            .min_by_key(|(_, r)| r.len())
    };
    around.or_else(inside).map(|(p, _)| copy::name(p))
}

/// Builds the tests that the configuration names.
///
/// # Errors
/// They do not build.
pub fn tests(copy: &Copy, config: &Config) -> Result<Vec<Program>, String> {
    let mut args = vec!["test", "--no-run"];
    for test in &config.tests {
        match test.split_once('/') {
            Some((package, program)) => args.extend(["-p", package, "--test", program]),
            None => args.extend(["-p", test, "--lib"]),
        }
    }
    let (good, messages) = cargo(&copy.root, &args)?;
    if !good {
        let errors = messages.iter().filter_map(|m| {
            m["message"]["rendered"]
                .as_str()
                .filter(|_| m["message"]["level"] == "error")
        });
        return Err(format!(
            "the tests do not build:\n{}",
            errors.collect::<Vec<_>>().join("\n")
        ));
    }
    let mut programs = Vec::new();
    for m in messages.iter().filter(|m| m["profile"]["test"] == true) {
        let (Some(path), Some(manifest), Some(program)) = (
            m["executable"].as_str(),
            m["manifest_path"].as_str(),
            m["target"]["name"].as_str(),
        ) else {
            continue;
        };
        let folder = Path::new(manifest).parent().unwrap_or(&copy.root);
        let package = package(Path::new(manifest))?;
        let name = match m["target"]["kind"][0].as_str() {
            Some("test") => format!("{package}/{program}"),
            _ => package,
        };
        if config.tests.contains(&name) {
            programs.push(Program {
                name,
                path: path.into(),
                folder: folder.into(),
            });
        }
    }
    let place = |p: &Program| config.tests.iter().position(|t| *t == p.name);
    programs.sort_by_key(place);
    Ok(programs)
}

/// Name of the package of a manifest.
fn package(manifest: &Path) -> Result<String, String> {
    let failed = |e: &dyn std::fmt::Display| format!("{}: {e}", manifest.display());
    let text = std::fs::read_to_string(manifest).map_err(|e| failed(&e))?;
    let table: toml::Table = text.parse().map_err(|e| failed(&e))?;
    let name = table["package"]["name"].as_str().unwrap_or_default();
    Ok(name.to_owned())
}
