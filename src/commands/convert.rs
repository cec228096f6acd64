//! `convert`: a cycle from one form of file to another.

use std::io::Write;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use cvtcycle::config::Problems;
use cvtcycle::config::cycle::{self, Cycle, Format, Written};
use cvtcycle::config::setup::{self, Kind, Options};
use cvtcycle::output::file::OutputFile;

use super::Execute;
use crate::args::problems::{bad_value, cite, cite_options, problem};
use crate::args::{ColumnsArgs, Names, choice_names, cycles, one_of};
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Arguments of `convert`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle convert cycle ftpcol.txt --out ftp.csv
  cvtcycle convert cycle log.csv --columns time=Time_ADC:s,speed=VehSpd:mph --out trip.csv
  cvtcycle convert cycle wltc --gears mondeo_20_5mt --to vdri

How the file was read, and what the new form cannot hold, is said on standard error; `cvtcycle list columns` prints the names that are known.")]
pub struct ConvertArgs {
    /// Kind of the file
    #[arg(value_enum)]
    what: ConvertedKind,
    /// Cycle: a name, constant_V (V in km/h), or a file
    #[arg(value_name = "NAME|FILE", value_parser = Names(cycles), hide_possible_values = true)]
    file: String,
    /// Form: csv (of this program), vdri (VECTO), fastsim or epa
    #[arg(long, value_name = "FORM", default_value = "csv", value_parser = Names(|| choice_names(&Format::NAMES)), hide_possible_values = true)]
    to: String,
    /// With the gears that this manual car drives, in place of the cycle's columns
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    gears: Option<String>,
    /// The trace that an automatic car drives, where the cycle has two
    #[arg(long, conflicts_with = "gears")]
    automatic: bool,
    #[command(flatten)]
    columns: ColumnsArgs,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Replace the file
    #[arg(long, requires = "out")]
    force: bool,
}

/// Kinds of input that can be converted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ConvertedKind {
    /// A drive cycle
    Cycle,
}

/// Converted text, notes about it, and its destination.
pub struct ConvertPlan {
    written: Written,
    said: Vec<String>,
    file: Option<OutputFile>,
}

impl Execute for ConvertArgs {
    type Plan = ConvertPlan;

    fn plan(&self, problems: &mut Problems) -> Option<ConvertPlan> {
        let ConvertedKind::Cycle = self.what;
        let columns = self.columns.get(problems);
        let found = cycle::open(&self.file, &columns).map_err(|found| cite("FILE", found));
        let found = problems.take(found);
        let format = problems.take(one_of("--to", &self.to, &Format::NAMES));
        let car = self.gears.as_deref().map(|word| {
            let found = setup::load(word, &Options::default());
            found.map_err(|found| cite("--gears", found))
        });
        let car = problems.take(car.transpose()).flatten();
        let file = self
            .out
            .as_deref()
            .map(|path| OutputFile::create(path, self.force));
        let file = problems
            .take(file.transpose().map_err(cite_options))
            .flatten();
        let (mut cycle, format) = (found?, format?);
        let mut said: Vec<String> = Vec::new();
        said.extend(
            cycle
                .read_as
                .iter()
                .map(|words| format!("read as: {words}")),
        );
        if let Some(car) = &car {
            cycle = cycle::for_car(&self.file, cycle, car);
            said.push(self.shift(&mut cycle, car, problems)?);
        }
        let trace = cycle.trace_for(self.automatic);
        let written = cycle::write(&cycle, trace, format);
        if !written.left_out.is_empty() {
            said.push(format!("left out: {}", written.left_out.join(", ")));
        }
        Some(ConvertPlan {
            written,
            said,
            file,
        })
    }

    fn run(&self, plan: ConvertPlan, _: Terminal) -> CommandResult {
        let said = plan.said.iter().map(|line| format!("cvtcycle: {line}\n"));
        let stderr = said.collect();
        let Some(mut file) = plan.file else {
            return Ok(CommandOutput {
                stdout: plan.written.text,
                stderr,
                ..CommandOutput::default()
            });
        };
        let written = file.write_all(plan.written.text.as_bytes());
        written.map_err(|error| cite_options(file.cannot_write(&error)))?;
        let path = file.commit().map_err(cite_options)?;
        Ok(CommandOutput {
            stdout: format!("{}\n", path.display()),
            stderr,
            ..CommandOutput::default()
        })
    }
}

impl ConvertArgs {
    /// Adds the gears of a car to the cycle and notes their origin. Records a problem and returns None if they depend on the drive.
    fn shift(
        &self,
        cycle: &mut Cycle,
        car: &setup::Setup,
        problems: &mut Problems,
    ) -> Option<String> {
        let word = self.gears.as_deref().unwrap_or_default();
        if car.transmission().is_cvt() {
            let message = format!("`{word}` has a CVT");
            problems.add(bad_value(
                "--gears",
                word,
                "a vehicle with a manual gearbox",
                &message,
                "",
            ));
            return None;
        }
        let own = car.trace(cycle);
        if !own.trace.has_gears() || !own.schedule.starts_with("gears") {
            let message =
                "the car chooses its gears while it drives this cycle, by its shift speeds";
            let hint = "leave out --gears; a WLTC, and a cycle with gears for this box, have gears beforehand";
            problems.add(problem("--gears", message, hint));
            return None;
        }
        let (schedule, mut trace) = (own.schedule.to_owned(), own.trace.into_owned());
        let gears = trace.gears(car.gear_count()).map(<[_]>::to_vec);
        *trace.gear_columns_mut() = cycle::gears::GearColumns::new(None, None, gears);
        cycle.manual = trace;
        Some(schedule)
    }
}
