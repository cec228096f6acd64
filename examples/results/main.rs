//! Regenerates the tables of `docs/results.md`: `cargo run --release --example results` writes the page.

mod tables;

use std::error::Error;
use std::fs;

use cvtcycle::config::render;

const PAGE: &str = "docs/results.md";

fn main() -> Result<(), Box<dyn Error>> {
    let page = fs::read_to_string(PAGE)?;
    let filled = tables::filled(&page).map_err(|problems| render(&problems, false))?;
    Ok(fs::write(PAGE, filled)?)
}
