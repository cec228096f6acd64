//! Gives the crate the identity of the build as `CVTCYCLE_BUILD`.

#[path = "build/identity.rs"]
mod identity;

use std::error::Error;
use std::path::Path;

/// Files below a published package's own folder that identify it: version and commit. All packages of a release share one commit.
const PACKED: [&str; 2] = [".cargo_vcs_info.json", "Cargo.toml.orig"];

fn main() -> Result<(), Box<dyn Error>> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Cargo adds the manifest as written to a package; a package has no workspace around it.
    let (root, inputs) = match own.join("Cargo.toml.orig").exists() {
        true => (own.to_path_buf(), &PACKED[..]),
        false => (own.join("../.."), &identity::INPUTS[..]),
    };
    for input in inputs {
        let path = root.join(input);
        // Cargo rebuilds every time if a watched path does not exist.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    println!(
        "cargo::rustc-env=CVTCYCLE_BUILD={}",
        identity::identity(&root, inputs)?
    );
    Ok(())
}
