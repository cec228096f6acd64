//! `corpus unpack` writes every line of `corpus.txt` as a file `corpus/TARGET/NUMBER` for libFuzzer. `corpus pack` writes
//! `corpus.txt` from these folders.
#![forbid(unsafe_code)]

use std::error::Error;
use std::fs;
use std::path::Path;

use cvtcycle_fuzz::corpus::{inputs, lines};
use cvtcycle_fuzz::targets::TARGETS;

fn main() -> Result<(), Box<dyn Error>> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = package.join("corpus.txt");
    let folder = |target: &str| package.join("corpus").join(target);
    match std::env::args().nth(1).as_deref() {
        Some("unpack") => {
            let text = fs::read_to_string(&file)?;
            for (target, _) in TARGETS {
                fs::create_dir_all(folder(target))?;
                let wrong = |line| format!("{}:{line}: wrong escape", file.display());
                let inputs = inputs(&text, target).map_err(wrong)?;
                for (number, input) in inputs.iter().enumerate() {
                    fs::write(folder(target).join(format!("{number:04}")), input)?;
                }
            }
        }
        Some("pack") => {
            let mut text = String::new();
            for (target, _) in TARGETS {
                let read = |entry: std::io::Result<fs::DirEntry>| fs::read(entry?.path());
                let inputs = fs::read_dir(folder(target))?.map(read);
                text += &lines(target, inputs.collect::<Result<_, _>>()?);
            }
            fs::write(&file, text)?;
        }
        _ => return Err("usage: corpus pack|unpack".into()),
    }
    Ok(())
}
