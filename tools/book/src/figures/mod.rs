//! Generated parts of the book: figures of the models, tables of values and labels.

mod belt;
mod car;
mod clamp;
mod cold;
mod drawn;
mod parts;
mod plates;
mod point;
mod prices;
mod reference;
mod round;
pub mod tables;
pub mod worked;

use cvtcycle::report::charts::lines::{self, LineChart, Look, Points, line_chart};
use std::path::Path;

/// Page of the book.
pub struct Page {
    /// File name without its ending.
    pub stem: &'static str,
    /// Vehicle with the displayed values.
    pub vehicle: &'static str,
    /// Keys of the page in addition to those whose meaning cites one of its labels; a whole table with a final dot.
    pub keys: &'static [&'static str],
}

const CVT: &str = "rover_216_cvt";

const fn page(stem: &'static str, keys: &'static [&'static str]) -> Page {
    Page {
        stem,
        vehicle: CVT,
        keys,
    }
}

/// Pages of mechanisms in the order of the book.
pub const PAGES: [Page; 26] = [
    page(
        "geometry",
        &[
            "transmission.cvt.belt.kind",
            "transmission.cvt.ranges",
            "transmission.cvt.belt.length_m",
            "transmission.cvt.ratio.low",
            "transmission.cvt.ratio.high",
        ],
    ),
    page("tension", &["transmission.cvt.variator.half_wedge_deg"]),
    page("slip", &[]),
    page(
        "bands",
        &[
            "transmission.cvt.belt.band_count",
            "transmission.cvt.belt.band_thickness_mm",
            "transmission.cvt.belt.band_width_mm",
        ],
    ),
    page("film", &["transmission.cvt.belt.band_offset_mm"]),
    page("deflection", &["transmission.cvt.variator.half_wedge_deg"]),
    page(
        "belt",
        &[
            "transmission.cvt.variator.half_wedge_deg",
            "transmission.cvt.variator.primary_piston_cm2",
        ],
    ),
    page("formulations", &[]),
    page("pump", &["transmission.cvt.pump."]),
    page("input_shaft", &[]),
    page("reverse_clutch", &[]),
    page("seal_ring", &[]),
    page("pulley_bearing", &[]),
    Page {
        stem: "gear_train",
        vehicle: "rover_216_cvt",
        keys: &["transmission.cvt.final_drive."],
    },
    page(
        "final_drive",
        &[
            "transmission.cvt.final_drive_ratio",
            "transmission.cvt.final_drive_first_ratio",
        ],
    ),
    page("launch", &["transmission.cvt.launch"]),
    page("ratio_control", &["transmission.cvt.ratio."]),
    page(
        "pressure",
        &["transmission.cvt.clamp", "transmission.cvt.pressure."],
    ),
    page("solve", &["transmission"]),
    Page {
        stem: "manual",
        vehicle: "rover_216_5mt",
        keys: &["transmission.manual."],
    },
    page("lubricant", &["lubricant.", "engine_oil."]),
    page("engine", &["engine."]),
    page("road_load", &["road_load."]),
    page("thermal", &["thermal."]),
    page("maps", &["transmission.cvt.maps."]),
    page("ledgers", &["vehicle."]),
];

/// Generated files: name below the book's `src`, and text.
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
        .chain(round::figures(&reference)?)
        .chain(plates::figures(&reference)?)
    {
        files.push((format!("img/{name}.svg"), svg));
    }
    files.push(("generated/cold_losses.md".to_owned(), cold::table()?));
    let (picture, table) = prices::picture_and_table()?;
    files.push(("img/price_rover_216_cvt.svg".to_owned(), picture));
    files.push(("generated/prices.md".to_owned(), table));
    files.extend(worked::files(&reference)?);
    files.extend(tables::files(source)?);
    Ok(files)
}

/// Line through `f` at `count` + 1 places from `low` to `high`.
fn sweep(name: &str, low: f64, high: f64, count: u32, f: impl Fn(f64) -> f64) -> Line {
    let at = |i: u32| low + (high - low) * f64::from(i) / f64::from(count);
    Line {
        name: name.to_owned(),
        points: (0..=count).map(|i| (at(i), f(at(i)))).collect(),
    }
}

/// Points under a name. Lines of equal names look the same in every panel.
#[derive(Clone)]
struct Line {
    name: String,
    points: Points,
}

/// Pair of axes.
struct LinePanel {
    heading: String,
    x: &'static str,
    y: &'static str,
    /// Values to include in the range of the vertical axis.
    with_y: Vec<f64>,
    lines: Vec<Line>,
}

/// Pair of axes with titles. The vertical axis includes zero.
fn axes(heading: &str, x: &'static str, y: &'static str, lines: Vec<Line>) -> LinePanel {
    LinePanel {
        heading: heading.to_owned(),
        x,
        y,
        with_y: vec![0.0],
        lines,
    }
}

/// Draws a plot with title and description.
fn plot(title: &str, subject: &str, desc: &str, legend: &str, panels: Vec<LinePanel>) -> String {
    let mut names: Vec<String> = Vec::new();
    for line in panels
        .iter()
        .flat_map(|panel| &panel.lines)
        .filter(|line| !line.name.is_empty())
    {
        if !names.contains(&line.name) {
            names.push(line.name.clone());
        }
    }
    let look = |name: &str| Look {
        index: names.iter().position(|other| other == name).unwrap_or(0),
        dotted: false,
    };
    let panel = |panel: LinePanel| lines::LinePanel {
        heading: panel.heading,
        x_title: panel.x,
        y_title: panel.y,
        with_y: panel.with_y,
        series: panel
            .lines
            .into_iter()
            .map(|line| (look(&line.name), line.points))
            .collect(),
        ..lines::LinePanel::default()
    };
    let text = |s: &str| s.to_owned();
    let picture = line_chart(&LineChart {
        title: text(title),
        subject: text(subject),
        description: text(desc),
        panels: panels.into_iter().map(panel).collect(),
        own_x: true,
        legend: text(legend),
        names: names
            .iter()
            .map(|name| (look(name), name.clone()))
            .collect(),
        ..LineChart::default()
    });
    picture.svg
}
