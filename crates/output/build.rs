//! Gives the crate the identity of the build as `CVTCYCLE_BUILD`.

#[path = "build/identity.rs"]
mod identity;

use std::error::Error;
use std::path::Path;

/// What counts of a published package, below its own folder: version and commit. The packages of a release are of one commit.
const PACKED: [&str; 2] = [".cargo_vcs_info.json", "Cargo.toml.orig"];

fn main() -> Result<(), Box<dyn Error>> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    // Cargo keeps the manifest as written in the packages that it makes: there is no workspace around them.
    let (root, inputs) = match own.join("Cargo.toml.orig").exists() {
        true => (own.to_path_buf(), &PACKED[..]),
        false => (own.join("../.."), &identity::INPUTS[..]),
    };
    for input in inputs {
        let path = root.join(input);
        // A path that is not there would make every build a new one.
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
