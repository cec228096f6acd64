//! `fmu`: a car as an FMU, a unit of a co-simulation.

use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use cvtcycle::config::setup::carried::CarriedCar;
use cvtcycle::config::setup::{Kind as FileKind, Options, Setup};
use cvtcycle::config::{Problem, Problems, bounded};
use cvtcycle::output::file::OutputFile;
use cvtcycle_fmu::Kind;
use cvtcycle_fmu::description::Fmi;
use cvtcycle_fmu::package::{Package, Platform};

use super::Execute;
use crate::args::problems::{bad_value, cite_car, cite_options, overrides, problem};
use crate::args::{Names, OutArgs, choice_names, one_of};
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Arguments of `fmu`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE.fmu").help("Write this file [default: NAME_KIND.fmu]")),
    mut_arg("force", |force| force.help("Replace the file")),
    after_help = "\
Examples:
  cvtcycle fmu rover_216_cvt --kind car
  cvtcycle fmu mycar.toml --kind losses --fmi 3 --out mycar_losses.fmu

The FMU holds the car's files and a shared library for each platform. The libraries are taken from the folder of this program, or named with --library; \
`cargo build --release -p cvtcycle-fmu-library` builds that of this machine, with --target x86_64-pc-windows-gnu that of Windows. docs/fmu.md has the variables."
)]
pub struct FmuArgs {
    /// Vehicle
    #[arg(value_name = "NAME|FILE.toml", value_parser = Names(|| FileKind::Vehicle.names()), hide_possible_values = true)]
    car: String,
    /// Kind of unit: `car`, the whole car that follows a speed; `losses`, the transmission at an operating point
    #[arg(long, value_name = "KIND", default_value = "car", value_parser = Names(|| choice_names(&Kind::NAMES)), hide_possible_values = true)]
    kind: String,
    /// Version of the standard: 2 (FMI 2.0) or 3 (FMI 3.0)
    #[arg(long, value_name = "VERSION", default_value = "2", value_parser = Names(|| choice_names(&Fmi::NAMES)), hide_possible_values = true)]
    fmi: String,
    /// Transmission oil [default: from the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| FileKind::Lubricant.names()), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Engine oil [default: from the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| FileKind::Lubricant.names()), hide_possible_values = true)]
    engine_oil: Option<String>,
    /// Override one value of the vehicle; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Shared library of cvtcycle-fmu-library, for Linux or Windows; repeatable [default: those in the folder of this program]
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    #[command(flatten)]
    out: OutArgs,
}

/// Contents of an FMU, and its file.
pub struct FmuPlan {
    kind: Kind,
    fmi: Fmi,
    setup: Setup,
    car: CarriedCar,
    libraries: Vec<(Platform, Vec<u8>)>,
    file: OutputFile,
}

impl Execute for FmuArgs {
    type Plan = FmuPlan;

    fn plan(&self, problems: &mut Problems) -> Option<FmuPlan> {
        let kind = problems.take(one_of("--kind", &self.kind, &Kind::NAMES));
        let fmi = problems.take(one_of("--fmi", &self.fmi, &Fmi::NAMES));
        let options = Options {
            lubricant: self.lubricant.clone(),
            engine_oil: self.engine_oil.clone(),
            set: overrides("--set", &self.set, problems),
            ..Options::default()
        };
        let car = CarriedCar::load(&self.car, &options);
        let car = problems.take(car.map_err(|found| found.map(cite_car)));
        let libraries = problems.take(self.libraries());
        let usual = car.as_ref().zip(kind);
        let usual = usual.map(|((_, setup), kind)| format!("{}_{}.fmu", setup.name, kind.name()));
        let file = self.out.file(usual.map(PathBuf::from), "fmu", problems);
        let (car, setup) = car?;
        let (kind, fmi) = (kind?, fmi?);
        if !kind.fits(setup.transmission()) {
            let name = kind.name();
            let message = format!("{} has a manual box, and `{name}` is a CVT", setup.name);
            let found = problem(
                "--kind",
                &message,
                "take `car` or `losses`, or a car with a CVT",
            );
            problems.add(found.value(name));
        }
        let (libraries, file) = (libraries?, file?);
        Some(FmuPlan {
            kind,
            fmi,
            setup,
            car,
            libraries,
            file,
        })
    }

    fn run(&self, plan: FmuPlan, _: Terminal) -> CommandResult {
        let mut file = plan.file;
        let platforms: Vec<&str> = plan.libraries.iter().map(|own| own.0.words()).collect();
        let platforms = platforms.join(", ");
        let package = Package {
            kind: plan.kind,
            fmi: plan.fmi,
            setup: &plan.setup,
            car: plan.car,
            libraries: plan.libraries,
        };
        // Writing a zip needs seeking, which a pending output file does not allow.
        let mut bytes = io::Cursor::new(Vec::new());
        let written = package.write(&mut bytes);
        let written = written.and_then(|()| io::Write::write_all(&mut file, bytes.get_ref()));
        written.map_err(|error| cite_options(file.cannot_write(&error)))?;
        let path = file.commit().map_err(cite_options)?;
        Ok(CommandOutput::text(format!(
            "{}  {}, FMI {}.0, {platforms}\n",
            path.display(),
            plan.kind.words(),
            self.fmi
        )))
    }
}

impl FmuArgs {
    /// Shared libraries, at most one for each platform.
    fn libraries(&self) -> Result<Vec<(Platform, Vec<u8>)>, Problems> {
        let mut problems = Problems::new();
        let mut found: Vec<(Platform, Vec<u8>)> = Vec::new();
        for path in &self.library {
            let Some((platform, bytes)) = problems.take(library(path)) else {
                continue;
            };
            if found.iter().any(|(known, _)| *known == platform) {
                let (value, words) = (path.display().to_string(), platform.words());
                let message = format!("a second library for {words}");
                let allowed = "one library for each platform";
                problems.add(bad_value("--library", &value, allowed, &message, ""));
                continue;
            }
            found.push((platform, bytes));
        }
        if self.library.is_empty() {
            found = problems.take(own_libraries()).unwrap_or_default();
        }
        found.sort_by_key(|(platform, _)| *platform);
        problems.finish().map(|()| found)
    }
}

/// Reads a library named by the option.
fn library(path: &Path) -> Result<(Platform, Vec<u8>), Problem> {
    let value = path.display().to_string();
    let bytes = bounded::read_file(path, bounded::RECORD).map_err(|error| {
        let message = format!("cannot read the library: {error}");
        let hint = "build it: cargo build --release -p cvtcycle-fmu-library";
        bad_value("--library", &value, "a readable file", &message, hint)
    })?;
    let platform = Platform::detect(&bytes).ok_or_else(|| {
        let allowed = "a shared library for Linux (ELF) or Windows (PE) on x86-64";
        let message = "the file is no such library";
        bad_value("--library", &value, allowed, message, "")
    })?;
    Ok((platform, bytes))
}

/// Libraries next to this program; that for Windows is also searched in Cargo's target folder.
fn own_libraries() -> Result<Vec<(Platform, Vec<u8>)>, Problem> {
    let program = std::env::current_exe().unwrap_or_default();
    let folder = program.parent().unwrap_or(Path::new("."));
    let beyond = folder.join("../x86_64-pc-windows-gnu/release");
    let mut found = Vec::new();
    for platform in Platform::ALL {
        let places = [folder, beyond.as_path()].map(|folder| folder.join(platform.library()));
        if let Some(path) = places.iter().find(|path| path.is_file()) {
            found.push(library(path)?);
        }
    }
    if !found.is_empty() {
        return Ok(found);
    }
    let message = format!("there is no shared library in {}", folder.display());
    let hint = "build it: cargo build --release -p cvtcycle-fmu-library";
    Err(problem("--library", &message, hint))
}
