//! `corpus unpack` writes every line of `corpus/TARGET.txt` as a file `corpus/TARGET/NUMBER`, as libFuzzer reads it; `corpus pack`
//! writes the text files from these folders.
#![forbid(unsafe_code)]

use std::error::Error;
use std::fs;
use std::path::Path;

use cvtcycle_fuzz::corpus::{format, parse};
use cvtcycle_fuzz::targets::TARGETS;

fn main() -> Result<(), Box<dyn Error>> {
    let command = std::env::args().nth(1).unwrap_or_default();
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus");
    for (target, _) in TARGETS {
        let (folder, file) = (
            corpus.join(target),
            corpus.join(target).with_extension("txt"),
        );
        match command.as_str() {
            "unpack" => {
                fs::create_dir_all(&folder)?;
                let wrong = |line| format!("{}:{line}: wrong escape", file.display());
                let inputs = parse(&fs::read_to_string(&file)?).map_err(wrong)?;
                for (number, input) in inputs.iter().enumerate() {
                    fs::write(folder.join(format!("{number:04}")), input)?;
                }
            }
            "pack" => {
                let read = |entry: std::io::Result<fs::DirEntry>| fs::read(entry?.path());
                let inputs = fs::read_dir(&folder)?.map(read).collect::<Result<_, _>>()?;
                fs::write(&file, format(inputs))?;
            }
            _ => return Err("usage: corpus pack|unpack".into()),
        }
    }
    Ok(())
}
