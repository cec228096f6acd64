//! Everything in the book that the program itself writes: figures of its models, tables of its values and labels.

mod belt;
mod car;
mod clamp;
mod drawn;
mod parts;
mod reference;
pub mod tables;

use cvtcycle::report::{Line, LinePanel, LinePlot};
use std::path::Path;

/// A page of the book.
pub struct Page {
    /// File name without its ending.
    pub stem: &'static str,
    /// Vehicle whose values it shows.
    pub vehicle: &'static str,
    /// Keys that belong to it beside those whose meaning cites one of its labels: a table where it ends in a dot.
    pub keys: &'static [&'static str],
}

const CVT: &str = "rover_216_cvt";

const fn page(stem: &'static str, keys: &'static [&'static str]) -> Page {
    Page { stem, vehicle: CVT, keys }
}

/// Pages of mechanisms in the order of the book.
pub const PAGES: [Page; 23] = [
    page("belt", &["transmission.cvt.variator.half_wedge_deg", "transmission.cvt.variator.primary_piston_cm2"]),
    page("geometry", &["transmission.cvt.belt.length_m", "transmission.cvt.ratio.low", "transmission.cvt.ratio.high"]),
    page("tension", &["transmission.cvt.variator.half_wedge_deg"]),
    page("bands", &["transmission.cvt.belt.band_count", "transmission.cvt.belt.band_thickness_mm", "transmission.cvt.belt.band_width_mm"]),
    page("film", &["transmission.cvt.belt.band_offset_mm"]),
    page("slip", &[]),
    page("deflection", &["transmission.cvt.variator.half_wedge_deg"]),
    page("formulations", &[]),
    page("pump", &["transmission.cvt.pump."]),
    page("input_shaft", &[]),
    page("reverse_clutch", &[]),
    page("final_drive", &["transmission.cvt.final_drive_ratio"]),
    page("launch", &["transmission.cvt.launch"]),
    page("ratio_control", &["transmission.cvt.ratio."]),
    page("pressure", &["transmission.cvt.clamp", "transmission.cvt.pressure."]),
    page("solve", &["transmission"]),
    Page { stem: "manual", vehicle: "rover_216_5mt", keys: &["transmission.manual."] },
    page("lubricant", &["lubricant.", "engine_oil."]),
    page("engine", &["engine."]),
    page("road_load", &["road_load."]),
    page("thermal", &["thermal."]),
    page("maps", &["transmission.cvt.maps."]),
    page("ledgers", &["vehicle."]),
];

/// Every generated file, its name below the book's `src`, and its text.
///
/// # Errors
/// A sentence, if a vehicle or a page cannot be read.
pub fn files(source: &Path) -> Result<Vec<(String, String)>, String> {
    let reference = reference::Reference::load()?;
    let mut files = Vec::new();
    for (name, svg) in belt::figures(&reference)
        .into_iter()
        .chain(clamp::figures(&reference))
        .chain(drawn::figures(&reference))
        .chain(parts::figures(&reference))
        .chain(car::figures(&reference)?)
    {
        files.push((format!("img/{name}.svg"), svg));
    }
    files.extend(tables::files(source)?);
    Ok(files)
}

/// A line through `f` at `count` + 1 places from `low` to `high`.
fn sweep(name: &str, low: f64, high: f64, count: u32, f: impl Fn(f64) -> f64) -> Line {
    let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(count);
    Line { name: name.to_owned(), points: (0..=count).map(|i| (at(i), f(at(i)))).collect() }
}

/// One pair of axes with its titles; its vertical axis takes in zero.
fn axes(heading: &str, x: &str, y: &str, lines: Vec<Line>) -> LinePanel {
    LinePanel { heading: heading.to_owned(), x: x.to_owned(), y: y.to_owned(), with_y: vec![0.0], lines }
}

/// A named plot.
fn plot(title: &str, subject: &str, desc: &str, legend: &str, panels: Vec<LinePanel>) -> String {
    let text = |s: &str| s.to_owned();
    cvtcycle::report::line_plot(&LinePlot { title: text(title), subject: text(subject), desc: text(desc), legend: text(legend), panels })
}
