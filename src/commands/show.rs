//! `show`: every value of a vehicle, lubricant or rig with its status and source, or what a cycle is made of.

use clap::ValueEnum;
use cvtcycle::config::cycle::Cycle;
use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::catalogue;
use cvtcycle::config::setup::{self, Options};
use cvtcycle::config::{KeyInfo, Problems};
use serde::Serialize;

use super::Context;
use crate::args as inputs;
use crate::args::sniff::{Sort, sort_of};
use crate::print::grid::Grid;
use crate::print::{Answer, Reply};
use cvtcycle::output::number::{fixed, signed};

/// Longest value that stands in its own column; longer ones, lists mostly, move to the last.
const VALUE: usize = 18;

/// Arguments of `show`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  cvtcycle show rover_216_cvt --status assumed
  cvtcycle show dexron_iii
  cvtcycle show ece15_eudc")]
pub struct Args {
    /// A vehicle, lubricant, rig or cycle: a name or a file
    #[arg(value_name = "NAME|FILE", value_parser = inputs::Offering(names), hide_possible_values = true)]
    name: String,
    /// Only values of this status; repeatable
    #[arg(long, value_enum, value_name = "STATUS")]
    status: Vec<Status>,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Status {
    /// Printed or published
    Source,
    /// Follows from sources by calculation
    Derived,
    /// Chosen to meet a measured statement
    Fitted,
    /// Judgement
    Assumed,
    /// Given in a file without a status
    User,
    /// Not in the file: the program's own value
    Default,
}

fn names() -> Vec<&'static str> {
    inputs::vehicles()
        .into_iter()
        .chain(inputs::lubricants())
        .chain(inputs::rigs())
        .chain(inputs::cycles())
        .collect()
}

/// One key as JSON.
#[derive(Serialize)]
pub struct KeyLine<'a> {
    key: &'a str,
    value: &'a str,
    unit: &'a str,
    status: &'a str,
    source: &'a str,
    note: &'a str,
    allowed: &'a str,
    meaning: &'a str,
}

impl<'a> From<&'a KeyInfo> for KeyLine<'a> {
    fn from(info: &'a KeyInfo) -> Self {
        KeyLine {
            key: &info.key,
            value: &info.value,
            unit: &info.unit,
            status: &info.status,
            source: &info.source,
            note: &info.note,
            allowed: &info.allowed,
            meaning: &info.doc,
        }
    }
}

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let (sort, word) = sort_of(&args.name, false)?;
    let (title, keys) = match sort {
        Sort::Cycle => return cycle(args, &inputs::cycle("NAME", &word)?, context),
        Sort::Vehicle => {
            let setup = setup::load(&word, "NAME", &Options::default())?;
            // The fluids have pages of their own.
            let own =
                |k: &KeyInfo| !k.key.starts_with("lubricant.") && !k.key.starts_with("engine_oil.");
            (setup.title, setup.keys.into_iter().filter(own).collect())
        }
        Sort::Lubricant => {
            let (oil, keys) = setup::load_lubricant(&word, "NAME", &[], "")?;
            (oil.title, keys)
        }
        Sort::Rig => rig(&word),
        Sort::Calibration => {
            return Err(plan(
                &word,
                "a calibration",
                "name the vehicle that it fits",
            ));
        }
        Sort::Study => return Err(plan(&word, "a study", "name the vehicle that it varies")),
    };
    let wanted = |info: &KeyInfo| {
        args.status.is_empty() || args.status.iter().any(|s| s.word() == info.status)
    };
    let keys: Vec<KeyInfo> = keys.into_iter().filter(wanted).collect();
    if args.json {
        let lines: Vec<KeyLine> = keys.iter().map(KeyLine::from).collect();
        let name = &args.name;
        return Answer::json(
            &serde_json::json!({ "name": name, "kind": sort.word(), "title": title, "keys": lines }),
        );
    }
    let head = format!("{}  {title}\n", context.paint.heading(&args.name));
    if keys.is_empty() {
        return Ok(Answer::text(head + "\nno value of this status\n"));
    }
    Ok(Answer::text(
        head + &tables(&keys, context) + &counts(&keys),
    ))
}

/// A plan, which has nothing to show.
fn plan(word: &str, of: &str, instead: &str) -> Problems {
    let message = format!("`{word}` is the plan of {of}, which holds no values of a car");
    let hint = format!("{instead}; `cvtcycle check` reads a plan");
    inputs::bad_value(
        "NAME",
        word,
        "a vehicle, lubricant, cycle or rig",
        message,
        hint,
    )
    .into()
}

/// Title and keys of an embedded rig.
fn rig(word: &str) -> (String, Vec<KeyInfo>) {
    let keys = catalogue::files()
        .into_iter()
        .find(|file| file.name == word)
        .map(|file| file.keys)
        .unwrap_or_default();
    (
        keys.iter()
            .find(|k| k.key == "rig.title")
            .map(|k| k.value.clone())
            .unwrap_or_default(),
        keys,
    )
}

impl Status {
    fn word(self) -> &'static str {
        match self {
            Status::Source => "source",
            Status::Derived => "derived",
            Status::Fitted => "fitted",
            Status::Assumed => "assumed",
            Status::User => "user",
            Status::Default => "default",
        }
    }
}

/// Table and last name of a key.
fn split(key: &str) -> (&str, &str) {
    key.rsplit_once('.').unwrap_or(("", key))
}

fn tables(keys: &[KeyInfo], context: Context) -> String {
    let width = |of: &dyn Fn(&KeyInfo) -> usize| keys.iter().map(of).max().unwrap_or(0);
    let short = |info: &KeyInfo| value(info).chars().count().min(VALUE);
    let widths = [
        width(&|k| split(&k.key).1.len()),
        width(&short),
        width(&|k| k.status.len()),
    ];
    // In the order of reading, but every table in one piece.
    let mut order: Vec<&str> = Vec::new();
    for info in keys {
        if !order.contains(&split(&info.key).0) {
            order.push(split(&info.key).0);
        }
    }
    let mut text = String::new();
    for table in order {
        let heading = if table.is_empty() {
            "[top]".to_owned()
        } else {
            format!("[{table}]")
        };
        text += &format!("\n{}\n", context.paint.heading(&heading));
        let mut grid = Grid::new("llll").indented();
        for info in keys.iter().filter(|info| split(&info.key).0 == table) {
            grid.row([
                split(&info.key).1,
                &own_column(info),
                &info.status,
                &remarks(info),
            ]);
        }
        text += &grid.text_with_widths(&widths);
    }
    text
}

fn own_column(info: &KeyInfo) -> String {
    let text = value(info);
    if text.chars().count() > VALUE {
        "...".to_owned()
    } else {
        text
    }
}

fn remarks(info: &KeyInfo) -> String {
    let text = value(info);
    let long = (text.chars().count() > VALUE).then_some(text);
    let parts = long
        .iter()
        .chain([&info.source, &info.note])
        .filter(|part| !part.is_empty());
    parts.cloned().collect::<Vec<_>>().join("; ")
}

fn counts(keys: &[KeyInfo]) -> String {
    let words = Status::value_variants().iter().map(|status| status.word());
    let counts = words.map(|word| (word, keys.iter().filter(|info| info.status == word).count()));
    let parts: Vec<String> = counts
        .filter(|(_, n)| *n > 0)
        .map(|(word, n)| format!("{n} {word}"))
        .collect();
    format!("\n{} keys: {}\n", keys.len(), parts.join(", "))
}

#[derive(Serialize)]
struct PhaseLine {
    name: String,
    distance_km: f64,
    distance_automatic_km: f64,
}

fn cycle(args: &Args, cycle: &Cycle, context: Context) -> Reply {
    let (manual, automatic) = (cycle.trace_for(false), cycle.trace_for(true));
    let km = |trace: &cvtcycle::config::cycle::Trace, phases: &[u16]| {
        phases
            .iter()
            .map(|phase| trace.phase_distance_m(*phase))
            .sum::<f64>()
            / 1e3
    };
    let phases: Vec<PhaseLine> = cycle
        .phase_groups()
        .into_iter()
        .map(|(name, list)| PhaseLine {
            name,
            distance_km: km(manual, &list),
            distance_automatic_km: km(automatic, &list),
        })
        .collect();
    if args.json {
        return Answer::json(&serde_json::json!({
            "name": args.name, "kind": "cycle", "title": cycle.title, "duration_s": manual.duration_s(),
            "distance_km": manual.distance_m() / 1e3, "distance_automatic_km": automatic.distance_m() / 1e3,
            "max_speed_kmh": manual.max_speed_m_s() * 3.6, "gears_prescribed": cycle.has_gears(), "phases": phases,
        }));
    }
    let mut grid = Grid::new("lrr").indented();
    grid.row(["phase", "km", "km (automatic)"]);
    for phase in &phases {
        grid.row([
            &phase.name,
            &fixed(phase.distance_km, 3),
            &fixed(phase.distance_automatic_km, 3),
        ]);
    }
    grid.row([
        "total",
        &fixed(manual.distance_m() / 1e3, 3),
        &fixed(automatic.distance_m() / 1e3, 3),
    ]);
    let gears = if cycle.has_gears() {
        "prescribed for manual cars"
    } else {
        "left to the car"
    };
    let mean = manual.distance_m() / manual.duration_s() * 3.6;
    let more = manual.distance_m() - automatic.distance_m();
    let mut text = format!(
        "{}  {}\n\n{}",
        context.paint.heading(&cycle.name),
        cycle.title,
        grid.text()
    );
    text += &format!(
        "\nduration {} s, highest speed {} km/h, mean {} km/h; gears {gears}\n",
        fixed(manual.duration_s(), 0),
        fixed(manual.max_speed_m_s() * 3.6, 1),
        fixed(mean, 1)
    );
    if more.abs() > 0.5 {
        text += &format!(
            "in its gear-change plateaux a manual car drives {} m\n",
            signed(more, 0)
        );
    }
    Ok(Answer::text(text))
}
