//! Builds the copy, and drops the points whose mutants do not compile.

use crate::config::Config;
use crate::copy::{self, Copy};
use serde_json::Value;
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The package whose code is changed, and the name of its unit tests.
const PACKAGE: &str = "cvtcycle-model";
const UNIT_TESTS: &str = "cvtcycle_model";

/// A test program.
#[derive(Clone, Debug)]
pub struct Program {
    /// `cvtcycle_model` for the unit tests of the model, or the name of a file or folder in `tests/`.
    pub name: String,
    /// The executable.
    pub path: PathBuf,
}

/// Cargo in the copy, with a profile that makes tests fast.
fn cargo(root: &Path, args: &[&str]) -> Result<(bool, Vec<Value>), String> {
    let output = Command::new("cargo")
        .args(args)
        .args(["--locked", "--message-format", "json"])
        .current_dir(root)
        .env("CARGO_INCREMENTAL", "0")
        .envs([
            ("CARGO_PROFILE_TEST_OPT_LEVEL", "2"),
            ("CARGO_PROFILE_TEST_DEBUG", "0"),
        ])
        .envs([
            ("CARGO_PROFILE_DEV_OPT_LEVEL", "2"),
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
    config: &Config,
    mut dropped: HashSet<String>,
) -> Result<(Copy, HashSet<String>), String> {
    loop {
        let copy = copy::make(root, to, config, &dropped)?;
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
    let mut args = vec![
        "test", "--no-run", "-p", "cvtcycle", "-p", PACKAGE, "--bin", "cvtcycle",
    ];
    for test in &config.tests {
        match test.as_str() {
            UNIT_TESTS => args.push("--lib"),
            other => args.extend(["--test", other]),
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
        if let (Some(path), Some(kind), Some(name)) = (
            m["executable"].as_str(),
            m["target"]["kind"][0].as_str(),
            m["target"]["name"].as_str(),
        ) && kind != "bin"
            && config.tests.iter().any(|t| t == name)
        {
            programs.push(Program {
                name: name.to_owned(),
                path: path.into(),
            });
        }
    }
    let place = |p: &Program| config.tests.iter().position(|t| *t == p.name);
    programs.sort_by_key(place);
    Ok(programs)
}
