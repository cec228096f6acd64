//! Gives the crate the identity of the build as `CVTCYCLE_BUILD`.

#[path = "build/identity.rs"]
mod identity;

use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for input in identity::INPUTS {
        let path = root.join(input);
        // A path that is not there would make every build a new one.
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    println!(
        "cargo::rustc-env=CVTCYCLE_BUILD={}",
        identity::identity(&root)?
    );
    Ok(())
}
