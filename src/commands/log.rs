//! `log`: what is understood of a recorded drive, and the cycle that it is.

use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::config::channel::Quantity;
use cvtcycle::config::cycle::{Cycle, Format, Look, Recording, look, write};
use cvtcycle::config::log::{Channel, Log};
use cvtcycle::output::file::OutputFile;
use cvtcycle::output::number::fixed;
use cvtcycle::output::table::{TextTable, wrapped};
use serde_json::{Value, json};

use super::Execute;
use crate::args::problems::{cite, cite_options};
use crate::args::{ColumnsArgs, JsonArgs};
use crate::print::{CommandOutput, CommandResult, Terminal, json_text, sections};

/// Width and height of the picture of the speed, characters.
const PICTURE: (usize, usize) = (72, 6);

/// Arguments of `log`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle log drive.csv
  cvtcycle log drive.csv --columns \"time=Timestamp:ms,speed=VehSpd:mph,where=VehId:7\"
  cvtcycle log drive.csv --repair cut --out drive_cycle.csv

Prints the channels with their units, rate and resolution, what was repaired and what is doubted, and a picture of the speed. With --out \
the repaired cycle is written in the program's own form.")]
pub struct LogArgs {
    /// Table in text: CSV, semicolons, tabs or blanks, of a logger, an instrument or another program
    #[arg(value_name = "FILE")]
    file: String,
    #[command(flatten)]
    columns: ColumnsArgs,
    /// Write the cycle, in the program's own form, to this file
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Replace the file
    #[arg(long, requires = "out")]
    force: bool,
    #[command(flatten)]
    output: JsonArgs,
}

/// The log, and the file to write.
pub struct LogPlan {
    look: Look,
    file: Option<OutputFile>,
}

impl Execute for LogArgs {
    type Plan = LogPlan;

    fn plan(&self, problems: &mut Problems) -> Option<LogPlan> {
        let columns = self.columns.get(problems);
        let found = look(&self.file, &columns).map_err(|found| cite("FILE", found));
        let found = problems.take(found);
        let file = self.out.as_deref();
        let file = file.map(|path| OutputFile::create(path, self.force));
        let file = problems.take(file.transpose().map_err(cite_options));
        Some(LogPlan {
            look: found?,
            file: file?,
        })
    }

    fn run(&self, plan: LogPlan, terminal: Terminal) -> CommandResult {
        let LogPlan { look, file } = plan;
        let stdout = match self.output.json {
            true => json_text(&to_json(&look))?,
            false => text(&look, terminal),
        };
        let mut stderr = String::new();
        if let Some(mut file) = file {
            let written = write(&look.cycle, &look.cycle.manual, Format::Csv);
            let done = file.write_all(written.text.as_bytes());
            done.map_err(|error| cite_options(file.cannot_write(&error)))?;
            let path = file.commit().map_err(cite_options)?;
            stderr = format!("cvtcycle: wrote {}\n", path.display());
        }
        Ok(CommandOutput {
            stdout,
            stderr,
            ..CommandOutput::default()
        })
    }
}

/// Number of values, least and largest, in the unit of the file.
fn range(channel: &Channel) -> (usize, f64, f64) {
    let values = channel.values.iter().copied().filter(|x| x.is_finite());
    let count = values.clone().count();
    let low = values.clone().fold(f64::INFINITY, f64::min);
    (count, low, values.fold(f64::NEG_INFINITY, f64::max))
}

/// Unit in which a channel is printed, and its size in SI.
fn printed(channel: &Channel) -> (&'static str, f64, usize) {
    match channel.quantity {
        Quantity::Time => ("s", 1.0, 2),
        Quantity::Speed => ("km/h", 1.0 / 3.6, 2),
        Quantity::Grade => ("%", 0.01, 2),
        Quantity::Altitude => ("m", 1.0, 1),
        Quantity::EngineSpeed => ("rpm", std::f64::consts::PI / 30.0, 0),
        Quantity::Fuel => ("g/s", 1e-3, 3),
        Quantity::Coolant | Quantity::EngineOil | Quantity::Sump | Quantity::Ambient => {
            ("degC", 1.0, 1)
        }
        Quantity::EngineOn | Quantity::EngineOff | Quantity::Phase => ("-", 1.0, 0),
    }
}

fn text(look: &Look, terminal: Terminal) -> String {
    let cycle = &look.cycle;
    let mut parts = Vec::new();
    if let Some(log) = &look.log {
        parts.push(("Channels".to_owned(), channels(log)));
        parts.push(("Rate and resolution".to_owned(), rate(log)));
    }
    let recording = cycle.recording.as_deref();
    parts.push(("Repairs and doubts".to_owned(), said(recording)));
    parts.push(("Speed".to_owned(), picture(cycle)));
    let trace = &cycle.manual;
    let head = format!(
        "{}: {} s, {} km\n",
        cycle.title,
        fixed(trace.duration_s(), 1),
        fixed(trace.distance_m() / 1e3, 3)
    );
    let read_as = cycle
        .read_as
        .iter()
        .map(|words| wrapped(words, "read as: "));
    head + &read_as.collect::<String>() + &sections(parts, terminal.stdout)
}

fn channels(log: &Log) -> String {
    let mut table = TextTable::new("lllrrrl");
    table.row([
        "quantity",
        "column",
        "unit",
        "values",
        "least",
        "largest",
        "printed in",
    ]);
    for channel in &log.channels {
        let (count, low, high) = range(channel);
        let (unit, size, decimals) = printed(channel);
        let number = |x: f64| fixed(Some(x / size).filter(|x| x.is_finite()), decimals);
        table.row([
            channel.quantity.name().to_owned(),
            channel.name.clone(),
            channel.unit.to_owned(),
            count.to_string(),
            number(low),
            number(high),
            unit.to_owned(),
        ]);
    }
    let mut text = table.text();
    if !log.passed_over.is_empty() {
        let names = log.passed_over.join(", ");
        text += &wrapped(&names, "passed over: ");
    }
    text
}

fn rate(log: &Log) -> String {
    let [low, middle, high] = log.steps_s().map(|step| fixed(step, 3));
    let mut text = format!("steps of {middle} s, {low} to {high} s\n");
    if let Some(own) = log.resolution() {
        text += &format!(
            "speeds in steps of {} km/h, errors of {} km/h: accelerations to {} m/s2\n",
            fixed(3.6 * own.speed_m_s, 3),
            fixed(3.6 * own.error_m_s, 3),
            fixed(own.accel_m_s2(), 3)
        );
    }
    text
}

fn said(recording: Option<&Recording>) -> String {
    let recording = recording.cloned().unwrap_or_default();
    let repairs = recording.repairs.iter();
    let repairs = repairs.map(|own| wrapped(&own.what, &format!("{}: ", own.name)));
    let doubts = recording
        .doubts
        .iter()
        .map(|doubt| wrapped(doubt, "doubt: "));
    let text: String = repairs.chain(doubts).collect();
    match text.is_empty() {
        true => "none\n".to_owned(),
        false => text,
    }
}

/// Speed over time in characters.
fn picture(cycle: &Cycle) -> String {
    const LEVELS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let (width, height) = PICTURE;
    let trace = &cycle.manual;
    let duration = trace.duration_s();
    let mut columns = vec![0.0_f64; width];
    for interval in trace.intervals.iter() {
        let at = |time: f64| ((time / duration * width as f64) as usize).min(width - 1);
        let speed = interval.start_speed_m_s.max(interval.end_speed_m_s);
        for column in &mut columns[at(interval.start_s)..=at(interval.end_s - 1e-9)] {
            *column = column.max(speed);
        }
    }
    let top = columns.iter().copied().fold(0.0, f64::max);
    let mut text = format!("{} km/h\n", fixed(3.6 * top, 0));
    for row in (0..height).rev() {
        let cell = |speed: &f64| {
            let filled = speed / top.max(0.1) * height as f64 - row as f64;
            LEVELS[(filled.clamp(0.0, 1.0) * 8.0).round() as usize]
        };
        let line: String = columns.iter().map(cell).collect();
        text += &format!("{}\n", line.trim_end());
    }
    let end = format!("{} s", fixed(duration, 0));
    text + &format!("0{end:>0$}\n", width - 1)
}

fn to_json(look: &Look) -> Value {
    let channel = |channel: &Channel| {
        let (count, low, high) = range(channel);
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        json!({
            "quantity": channel.quantity.name(),
            "column": channel.name,
            "unit": channel.unit,
            "values": count,
            "least_si": finite(low),
            "largest_si": finite(high),
        })
    };
    let recording = look.cycle.recording.clone().unwrap_or_default();
    let log = look.log.as_ref();
    let repair = |own: &cvtcycle::config::cycle::Repair| json!({ "name": own.name, "count": own.count, "what": own.what });
    json!({
        "read_as": look.cycle.read_as,
        "channels": log.map(|log| log.channels.iter().map(channel).collect::<Vec<_>>()),
        "passed_over": log.map(|log| &log.passed_over),
        "steps_s": log.map(Log::steps_s),
        "resolution": log.and_then(Log::resolution).map(|own| json!({
            "step_s": own.step_s,
            "speed_m_s": own.speed_m_s,
            "error_m_s": own.error_m_s,
            "accel_m_s2": own.accel_m_s2(),
            "is_coarse": own.is_coarse(),
        })),
        "repairs": recording.repairs.iter().map(repair).collect::<Vec<_>>(),
        "doubts": recording.doubts,
        "is_log": recording.is_log,
        "duration_s": look.cycle.manual.duration_s(),
        "distance_m": look.cycle.manual.distance_m(),
    })
}
