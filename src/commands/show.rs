//! `show`: all values of a vehicle, lubricant or rig with status and source, or the phases of a cycle.

use clap::{Args, ValueEnum};
use cvtcycle::config::cycle::{self, Cycle, Format};
use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::catalogue;
use cvtcycle::config::setup::contacts::{self, KnownContact};
use cvtcycle::config::setup::{self, Kind, Options};
use cvtcycle::config::{KeyInfo, Problems};
use cvtcycle::explain::key_json;
use cvtcycle::output::number::{fixed, signed};
use cvtcycle::output::table::{TextColumns, TextTable, distinct, wrapped};
use serde_json::{Value, json};

use super::Execute;
use crate::args::input_kind::InputKind;
use crate::args::problems::{bad_value, cite};
use crate::args::{ColumnsArgs, JsonArgs, Names, cycles};
use crate::print::colour::Paint;
use crate::print::{CommandOutput, CommandResult, Terminal, sections};

/// Maximum length in the column of values; longer ones, mostly lists, go into the last column.
const MAX_VALUE_LEN: usize = 18;

/// Arguments of `show`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle show rover_216_cvt --status assumed
  cvtcycle show compact_2020
  cvtcycle show dexron_iii
  cvtcycle show ece15_eudc
  cvtcycle show wltc_class2 --csv > wltc2.csv")]
pub struct ShowArgs {
    /// Vehicle, class, lubricant, rig or cycle: a name or a file
    #[arg(value_name = "NAME|FILE", value_parser = Names(|| [Kind::Vehicle.names(), Kind::Class.names(), Kind::Lubricant.names(), Kind::Rig.names(), cycles()].concat()), hide_possible_values = true)]
    name: String,
    /// Only values of this status; repeatable
    #[arg(long, value_enum, value_name = "STATUS")]
    status: Vec<Status>,
    /// Print a cycle as a table: the trace that a manual car drives, with its gears
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    #[command(flatten)]
    columns: ColumnsArgs,
    #[command(flatten)]
    output: JsonArgs,
}

/// Origin of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Status {
    /// Printed or published
    Source,
    /// Calculated from sources
    Derived,
    /// Fitted to measurements
    Fitted,
    /// Engineering judgement
    Assumed,
    /// In a file without a status
    User,
    /// Not in the file: of a class that it inherits from
    Class,
    /// Not in the file: of another car that it inherits from
    Like,
    /// Not in the file: default of the program
    Default,
}

/// Row for a key: name, value, status, source and note. A value longer than `max_len` goes into the last column.
pub fn value_row(name: &str, info: &KeyInfo, max_len: usize, instead: &str) -> [String; 4] {
    let own = value(info);
    let (shown, moved) = match own.chars().count() > max_len {
        true => (instead.to_owned(), own.as_str()),
        false => (own.clone(), ""),
    };
    let source = if is_inherited(info) { "" } else { &info.source };
    let remarks = [moved, source, &info.note].into_iter();
    let remarks: Vec<&str> = remarks.filter(|text| !text.is_empty()).collect();
    [
        name.to_owned(),
        shown,
        info.status.clone(),
        remarks.join("; "),
    ]
}

/// True if the value comes from a class or from another car.
fn is_inherited(info: &KeyInfo) -> bool {
    [Status::Class, Status::Like]
        .iter()
        .any(|status| status.word() == info.status)
}

/// Contents to show.
pub enum Shown {
    /// A cycle.
    Cycle(Box<Cycle>),
    /// Kind, title and keys of a file.
    Keys(InputKind, String, Vec<KeyInfo>),
    /// Title and keys of a lubricant, and what is known of its friction.
    Fluid(String, Vec<KeyInfo>, Vec<KnownContact>, Vec<String>),
}

impl Execute for ShowArgs {
    type Plan = Shown;

    fn plan(&self, problems: &mut Problems) -> Option<Shown> {
        let (kind, word) = problems.take(InputKind::detect(&self.name, false))?;
        let by_name = |found: Problems| cite("NAME", found);
        let mut known = None;
        let (title, mut keys) = match kind {
            InputKind::Cycle => {
                let columns = self.columns.get(problems);
                let cycle = problems.take(cycle::open(&word, &columns).map_err(by_name))?;
                return Some(Shown::Cycle(Box::new(cycle)));
            }
            InputKind::Vehicle => {
                let setup =
                    problems.take(setup::load(&word, &Options::default()).map_err(by_name))?;
                // Fluids have a heading of their own names.
                let fluid =
                    |key: &str| key.starts_with("lubricant.") || key.starts_with("engine_oil.");
                let own = setup.keys.into_iter().filter(|info| !fluid(&info.key));
                (setup.title, own.collect())
            }
            InputKind::Lubricant => {
                let (oil, keys) = problems.take(setup::load_lubricant(&word).map_err(by_name))?;
                let doubts = oil.benches.iter().flat_map(|bench| bench.doubts.clone());
                known = Some((contacts::contacts(&oil, &keys, ""), doubts.collect()));
                (oil.title, keys)
            }
            InputKind::Class | InputKind::Rig => embedded(&word),
            InputKind::Calibration | InputKind::Study | InputKind::Levers | InputKind::Test => {
                let (plan, instead) = match kind {
                    InputKind::Calibration => {
                        ("the plan of a calibration", "name the vehicle that it fits")
                    }
                    InputKind::Study => ("the plan of a study", "name the vehicle that it varies"),
                    InputKind::Test => ("a test", "name its cycle, or a vehicle that drives it"),
                    _ => ("a file of levers", "name a vehicle that can have them"),
                };
                let message = format!("`{word}` is {plan}, which has no values of a vehicle");
                let hint = format!("{instead}; `cvtcycle check` reads a plan");
                let allowed = "a vehicle, lubricant, cycle or rig";
                problems.add(bad_value("NAME", &word, allowed, &message, &hint));
                return None;
            }
        };
        if self.csv {
            let message = format!("`{word}` is no cycle");
            let allowed = "a cycle of `cvtcycle list cycles`, or the path of its file";
            let hint = "leave out --csv: it prints the speed of a cycle over time";
            problems.add(bad_value("--csv", "", allowed, &message, hint));
            return None;
        }
        let status: Vec<String> = self.status.iter().map(|status| status.word()).collect();
        keys.retain(|info| status.is_empty() || status.contains(&info.status));
        Some(match known {
            Some((known, doubts)) => Shown::Fluid(title, keys, known, doubts),
            None => Shown::Keys(kind, title, keys),
        })
    }

    fn run(&self, shown: Shown, terminal: Terminal) -> CommandResult {
        let paint = terminal.stdout;
        match (shown, self.output.json) {
            (Shown::Cycle(cycle), _) if self.csv => {
                let written = cycle::write(&cycle, &cycle.manual, Format::Csv);
                Ok(CommandOutput::text(written.text))
            }
            (Shown::Cycle(cycle), true) => CommandOutput::json(&cycle_json(&self.name, &cycle)),
            (Shown::Cycle(cycle), false) => Ok(CommandOutput::text(cycle_text(&cycle, paint))),
            (Shown::Keys(kind, title, keys), true) => {
                let lines: Vec<Value> = keys.iter().map(key_json).collect();
                let kind = kind.word();
                CommandOutput::json(
                    &json!({ "name": self.name, "kind": kind, "title": title, "keys": lines }),
                )
            }
            (Shown::Fluid(title, keys, known, doubts), true) => {
                let lines: Vec<Value> = keys.iter().map(key_json).collect();
                let contact = |own: &KnownContact| json!({ "contact": own.contact.name(), "origin": own.origin.word(), "words": own.words });
                let known: Vec<Value> = known.iter().map(contact).collect();
                let kind = InputKind::Lubricant.word();
                CommandOutput::json(
                    &json!({ "name": self.name, "kind": kind, "title": title, "friction": known, "doubts": doubts, "keys": lines }),
                )
            }
            (Shown::Fluid(title, keys, known, doubts), false) => {
                let body = match keys.is_empty() {
                    true => "\nno value has this status\n".to_owned(),
                    false => tables(&keys, paint) + &counts(&keys),
                };
                let heading = paint.heading(&self.name);
                let known = match self.status.is_empty() {
                    true => friction(&known, &doubts),
                    false => String::new(),
                };
                Ok(CommandOutput::text(format!(
                    "{heading}  {title}\n{known}{body}"
                )))
            }
            (Shown::Keys(_, title, keys), false) => {
                let body = match keys.is_empty() {
                    true => "\nno value has this status\n".to_owned(),
                    false => tables(&keys, paint) + &counts(&keys),
                };
                let heading = paint.heading(&self.name);
                Ok(CommandOutput::text(format!("{heading}  {title}\n{body}")))
            }
        }
    }
}

/// Measured friction of a fluid, contact by contact, and doubts about its tables.
fn friction(known: &[KnownContact], doubts: &[String]) -> String {
    let mut text = String::from("\nFriction by contact:\n");
    for own in known {
        let line = format!(
            "{}: {}: {}",
            own.contact.words(),
            own.origin.word(),
            own.words
        );
        text += &wrapped(&line, "  ");
    }
    for doubt in doubts {
        text += &wrapped(doubt, "  doubt: ");
    }
    text
}

/// Title and keys of an embedded class or rig.
fn embedded(word: &str) -> (String, Vec<KeyInfo>) {
    let mut files = catalogue::files().into_iter();
    let keys = files
        .find(|file| file.name == word)
        .map_or_else(Vec::new, |file| file.keys);
    let is_title = |info: &&KeyInfo| ["vehicle.title", "rig.title"].contains(&info.key.as_str());
    let title = keys.iter().find(is_title);
    (
        title.map_or_else(String::new, |info| info.value.clone()),
        keys,
    )
}

impl Status {
    /// Name, as in files and on the command line.
    fn word(self) -> String {
        let name = self.to_possible_value();
        name.map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Splits a key into table and last name.
fn split(key: &str) -> (&str, &str) {
    key.rsplit_once('.').unwrap_or(("", key))
}

fn tables(keys: &[KeyInfo], paint: Paint) -> String {
    let width = |length: &dyn Fn(&KeyInfo) -> usize| keys.iter().map(length).max().unwrap_or(0);
    let inherits = keys.iter().any(is_inherited);
    let widths = [
        width(&|info| split(&info.key).1.len()),
        width(&|info| value(info).chars().count().min(MAX_VALUE_LEN)),
        width(&|info| info.status.len()),
        width(&|info| if inherits { info.from.len() } else { 0 }),
    ];
    // Keeps the order of reading, with each table in one block.
    let order = distinct(keys.iter().map(|info| split(&info.key).0));
    let section = |name: &str| {
        let mut table = match inherits {
            true => TextTable::new("lllll"),
            false => TextTable::new("llll"),
        };
        table = table.indented().min_widths(&widths);
        for info in keys.iter().filter(|info| split(&info.key).0 == name) {
            let [key, value, status, remarks] =
                value_row(split(&info.key).1, info, MAX_VALUE_LEN, "...");
            let from = inherits.then(|| info.from.clone());
            let cells = [key, value, status].into_iter().chain(from);
            table.row(cells.chain([remarks]));
        }
        let name = if name.is_empty() { "top" } else { name };
        (format!("[{name}]"), table.text())
    };
    sections(order.into_iter().map(section), paint)
}

fn counts(keys: &[KeyInfo]) -> String {
    let count = |status: &Status| {
        let word = status.word();
        let n = keys.iter().filter(|info| info.status == word).count();
        (n > 0).then(|| format!("{n} {word}"))
    };
    let parts: Vec<String> = Status::value_variants().iter().filter_map(count).collect();
    let sentence = format!("{} keys: {}", keys.len(), parts.join(", "));
    format!("\n{}", wrapped(&sentence, ""))
}

/// Name of each phase, and its distances in km for a manual and for an automatic car.
fn phases(cycle: &Cycle) -> Vec<(String, [f64; 2])> {
    let km = |automatic: bool, phases: &[u16]| {
        let trace = cycle.trace_for(automatic);
        let m = phases.iter().map(|phase| trace.phase_distance_m(*phase));
        m.sum::<f64>() / 1e3
    };
    let groups = cycle.phase_groups().into_iter();
    groups
        .map(|(name, list)| (name, [km(false, &list), km(true, &list)]))
        .collect()
}

fn cycle_json(name: &str, cycle: &Cycle) -> Value {
    let (manual, automatic) = (cycle.trace_for(false), cycle.trace_for(true));
    let phase = |(name, km): (String, [f64; 2])| json!({ "name": name, "distance_km": km[0], "distance_automatic_km": km[1] });
    let phases: Vec<Value> = phases(cycle).into_iter().map(phase).collect();
    json!({
        "name": name, "kind": "cycle", "title": cycle.title, "duration_s": manual.duration_s(),
        "distance_km": manual.distance_m() / 1e3, "distance_automatic_km": automatic.distance_m() / 1e3,
        "max_speed_kmh": manual.max_speed_m_s() * 3.6, "gears_prescribed": cycle.has_gears(), "phases": phases,
        "read_as": cycle.read_as,
    })
}

fn cycle_text(cycle: &Cycle, paint: Paint) -> String {
    let (manual, automatic) = (cycle.trace_for(false), cycle.trace_for(true));
    let whole = [manual, automatic].map(|trace| trace.distance_m() / 1e3);
    let mut lines = phases(cycle);
    lines.push(("total".to_owned(), whole));
    let table = TextColumns::new()
        .left("phase", |(name, _): &(String, [f64; 2])| name.clone())
        .number("km", 3, |(_, km)| km[0])
        .number("km (automatic)", 3, |(_, km)| km[1])
        .text(&lines);
    let gears = match cycle.has_gears() {
        true => "prescribed for manual cars",
        false => "chosen by the shift rule of the car",
    };
    let (name, title) = (paint.heading(&cycle.name), &cycle.title);
    let duration = fixed(manual.duration_s(), 0);
    let highest = fixed(manual.max_speed_m_s() * 3.6, 1);
    let mean = fixed(manual.distance_m() / manual.duration_s() * 3.6, 1);
    let facts = format!(
        "duration {duration} s, highest speed {highest} km/h, mean {mean} km/h; gears {gears}"
    );
    let mut text = format!("{name}  {title}\n\n{table}\n{}", wrapped(&facts, ""));
    text.extend(
        cycle
            .read_as
            .iter()
            .map(|words| wrapped(words, "read as: ")),
    );
    let more = manual.distance_m() - automatic.distance_m();
    if more.abs() > 0.5 {
        let more = signed(more, 0);
        text += &format!("a manual car drives {more} m in gear-change plateaux\n");
    }
    text
}
