//! Groups of options, each option declared once. A command flattens the groups that it takes.

use clap::Args;
use cvtcycle::config::channel::Repairs;
use cvtcycle::config::csv::Columns;
use cvtcycle::config::setup::{
    self, AMBIENT, Kind, Options, START, STEP, Setup, TWIN, baseline_of,
};
use cvtcycle::config::{Bound, Problem, Problems};
use cvtcycle::model::drive::Start;
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::summary::{AUTO, StartWord};
use cvtcycle::study::statistics::Confidence;

use super::problems::{bad_value, did_you_mean, overrides, problem};
use super::{Names, choice_names, count, cycles, number, one_of, ranges::values};

/// Maximum number of ambient temperatures of one command: every whole degree of the allowed range.
const MAX_AMBIENTS: usize = 101;

/// The vehicle and its transmission oil.
#[derive(Args, Clone, Debug)]
pub struct VehicleArgs {
    /// Vehicle
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    pub vehicle: String,
    /// Transmission oil of this vehicle [default: from the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Lubricant.names()), hide_possible_values = true)]
    pub lubricant: Option<String>,
    /// Override one value of this vehicle; repeatable. `lubricant.KEY` is a value of its transmission oil
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
}

impl VehicleArgs {
    /// Options for reading this vehicle.
    pub fn options(&self, formulation: Formulation, problems: &mut Problems) -> Options {
        Options {
            lubricant: self.lubricant.clone(),
            set: overrides("--set", &self.set, problems),
            formulation,
            ..Options::default()
        }
    }

    /// Reads the vehicle.
    pub fn load(&self, formulation: Formulation, problems: &mut Problems) -> Option<Setup> {
        let options = self.options(formulation, problems);
        problems.take(setup::load(&self.vehicle, &options))
    }

    /// Reports a manual gearbox for a command that needs a CVT.
    pub fn need_cvt(&self, setup: Option<&Setup>, hint: &str, problems: &mut Problems) {
        if setup.is_some_and(|setup| !setup.transmission().is_cvt()) {
            let (vehicle, allowed) = (&self.vehicle, "a vehicle with a CVT");
            let message = format!("`{vehicle}` has a manual gearbox");
            problems.add(bad_value("--vehicle", vehicle, allowed, &message, hint));
        }
    }
}

/// Variant of the belt model.
#[derive(Args, Clone, Debug)]
pub struct FormulationArgs {
    /// Belt model: smooth (for driving), appendix_c or chapter_8 (as printed in the thesis)
    #[arg(long, value_name = "NAME", default_value = "smooth", value_parser = Names(|| choice_names(&Formulation::NAMES)), hide_possible_values = true)]
    pub formulation: String,
}

impl FormulationArgs {
    /// Parses the variant. After an unknown name it records a problem and returns the default.
    pub fn get(&self, problems: &mut Problems) -> Formulation {
        let found = one_of("--formulation", &self.formulation, &Formulation::NAMES);
        problems.take(found).unwrap_or_default()
    }
}

/// Start and time step of a drive.
#[derive(Args, Clone, Debug)]
pub struct DriveArgs {
    /// Start: `soak` (everything at ambient), `warm` (directly after the same cycle from a soak), all
    /// temperatures in degC, or those of single nodes, coolant=81,sump=60: coolant, engine_oil, sump, metal, belt, tyre; the others follow (TH-10);
    /// `auto`: those with which a log begins, where the cycle is one with such channels, else soak
    #[arg(
        long,
        value_name = "auto|soak|warm|DEGC|NODE=DEGC,...",
        default_value = "auto",
        allow_hyphen_values = true
    )]
    pub start: String,
    /// Longest time step, s, 0.01 to 10
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "1",
        allow_hyphen_values = true
    )]
    pub dt: String,
}

impl DriveArgs {
    /// Parses the start and the longest time step, s. A part with a problem is None.
    pub fn get(&self, problems: &mut Problems) -> (Option<(Start, StartWord)>, Option<f64>) {
        let start = problems.take(start(&self.start));
        (start, problems.take(number("--dt", &self.dt, STEP, "dt_s")))
    }
}

/// Conditions of a drive, and the belt model.
#[derive(Args, Clone, Debug)]
pub struct DrivingArgs {
    #[command(flatten)]
    pub drive: DriveArgs,
    #[command(flatten)]
    pub formulation: FormulationArgs,
}

/// Ambient temperature.
#[derive(Args, Clone, Debug)]
pub struct AmbientArgs {
    /// Ambient temperature, degC, -40 to 60
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "25",
        allow_hyphen_values = true
    )]
    ambient: String,
}

impl AmbientArgs {
    /// Parses the temperature, degC.
    pub fn get(&self, problems: &mut Problems) -> Option<f64> {
        problems.take(number("--ambient", &self.ambient, AMBIENT, "ambient_degc"))
    }
}

/// Ambient temperatures at which a command repeats the same drives.
#[derive(Args, Clone, Debug)]
pub struct AmbientsArgs {
    /// Ambient temperature, degC, -40 to 60: a number, a list or a range
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "25",
        allow_hyphen_values = true
    )]
    pub ambient: String,
}

impl AmbientsArgs {
    /// Parses the temperatures, degC.
    pub fn get(&self, problems: &mut Problems) -> Option<Vec<f64>> {
        let given = values("--ambient", &self.ambient, AMBIENT, "ambient_degc");
        let degc = problems.take(given)?;
        if degc.len() > MAX_AMBIENTS {
            let allowed = format!("at most {MAX_AMBIENTS} temperatures");
            let many = degc.len();
            let message = format!("{many} ambient temperatures are too many for one command");
            let hint = "take a larger step; `cvtcycle study` varies any value";
            let problem = bad_value("--ambient", &self.ambient, &allowed, &message, hint);
            problems.add(problem);
            return None;
        }
        Some(degc)
    }
}

/// Parses a start.
fn start(value: &str) -> Result<(Start, StartWord), Problems> {
    let word = |start: Start| Ok((start, StartWord::Word(value.to_owned())));
    match value {
        AUTO | "soak" => return word(Start::Soak),
        "warm" => return word(Start::Warm),
        nodes if nodes.contains('=') => {
            let found = setup::start_nodes(nodes);
            let found = found.map_err(|problem| problem.in_file("--start").key("--start"))?;
            return Ok((Start::Nodes(found), StartWord::of_nodes(&found)));
        }
        _ => {}
    }
    let named = |mut problem: Problem| {
        problem.allowed = format!(
            "auto, soak, warm, {}, or temperatures of nodes such as coolant=81,sump=60",
            START.in_unit("°C")
        );
        let question = did_you_mean(value, &[AUTO, "soak", "warm"]);
        if !question.is_empty() {
            problem.hint = question;
        }
        problem
    };
    let degc = number("--start", value, START, "start_degc");
    let degc = degc.map_err(|problems| problems.map(named))?;
    Ok((Start::At(degc + ZERO_DEGC_K), StartWord::Degc(degc)))
}

/// Mapping of the columns of a cycle's file.
#[derive(Args, Clone, Debug)]
pub struct ColumnsArgs {
    /// Columns of the cycle's file that are meant, such as time=Time_ADC:s,speed=VehSpd:mph; all others are passed over. For a file
    /// without names the columns in their order: time:s,speed:mph
    #[arg(long, value_name = "LIST")]
    pub columns: Option<String>,
    /// Repairs of a log: empty, stamps, negative, spikes, held and smooth are made, sort and cut where they are named, no-smooth leaves one
    /// out, none all [default: auto]
    #[arg(long, value_name = "LIST")]
    pub repair: Option<String>,
}

impl ColumnsArgs {
    /// Parses the columns. Without the option, or after a problem, the file's own names are used.
    pub fn get(&self, problems: &mut Problems) -> Columns {
        let columns = self.columns.as_deref().map(Columns::parse);
        let columns = problems.take(columns.transpose()).flatten();
        let repairs = self.repair.as_deref().map(Repairs::parse);
        let repairs = problems.take(repairs.transpose()).flatten();
        columns
            .unwrap_or_default()
            .with_repairs(repairs.unwrap_or_default())
    }
}

/// Confidence of intervals.
#[derive(Args, Clone, Debug)]
pub struct ConfidenceArgs {
    /// Confidence of all intervals, and share of the draws between the two ends that are printed of an output, 0.5 to 0.999
    /// [default: 0.95 of intervals, 0.9 of the draws]
    #[arg(long, value_name = "P", allow_hyphen_values = true)]
    confidence: Option<String>,
}

/// Allowed confidence.
const CONFIDENCE: Bound = Bound::closed(0.5, 0.999);

impl ConfidenceArgs {
    /// Parses the confidence. After a problem it returns the default.
    pub fn get(&self, problems: &mut Problems) -> Confidence {
        let given = self.confidence.as_ref();
        let level = given.map(|text| number("--confidence", text, CONFIDENCE, ""));
        let level = level.and_then(|level| problems.take(level));
        level.map_or_else(Confidence::default, Confidence::from_level)
    }
}

/// The cycle.
#[derive(Args, Clone, Debug)]
pub struct CycleArgs {
    /// Cycle: a name, constant_V (V in km/h, 600 s), or a CSV file
    #[arg(id = "cycle", long = "cycle", value_name = "NAME|FILE.csv", default_value = "ece15_eudc", value_parser = Names(cycles), hide_possible_values = true)]
    pub word: String,
}

/// The cycle, and the vehicles that are compared on it.
#[derive(Args, Clone, Debug)]
pub struct ComparisonArgs {
    #[command(flatten)]
    pub cycle: CycleArgs,
    /// Vehicle to compare with; repeatable; `twin` for the same car with a manual box, `none` for no comparison [default: baselines of the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml|twin|none", value_parser = Names(|| [Kind::Vehicle.names(), vec!["twin", "none"]].concat()), hide_possible_values = true)]
    pub baseline: Vec<String>,
    /// Engine oil of all vehicles
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Lubricant.names()), hide_possible_values = true)]
    pub engine_oil: Option<String>,
    /// Override one value of the vehicle and of all baselines; repeatable. `--set` takes precedence
    #[arg(long, value_name = "KEY=VALUE")]
    pub set_all: Vec<String>,
}

impl ComparisonArgs {
    /// Names of the baselines: those of the options, else those of the vehicle file.
    pub fn baselines(
        &self,
        vehicle: &str,
        setup: Option<&Setup>,
        problems: &mut Problems,
    ) -> Vec<String> {
        if self.baseline.is_empty() {
            let own = setup.iter().flat_map(|setup| &setup.baselines);
            return own.map(|name| baseline_of(vehicle, name)).collect();
        }
        let word = |name: &String| match name.as_str() {
            TWIN => baseline_of(vehicle, name),
            name => name.to_owned(),
        };
        let named: Vec<String> = self.named_baselines().map(word).collect();
        if !named.is_empty() && named.len() < self.baseline.len() {
            let message = "`none` together with a baseline";
            let hint = "give either `--baseline none` or names";
            problems.add(problem("--baseline", message, hint));
        }
        named
    }

    /// True if nothing is to be compared.
    pub fn has_none(&self) -> bool {
        self.baseline.iter().any(|name| name == "none")
    }

    /// Baselines of the options without `none`.
    pub fn named_baselines(&self) -> impl Iterator<Item = &String> {
        self.baseline.iter().filter(|name| *name != "none")
    }
}

/// Maximum number of threads.
pub const MAX_THREADS: u64 = 1024;

/// Number of threads.
#[derive(Args, Clone, Debug)]
pub struct ThreadArgs {
    /// Threads, 1 to 1024 [default: one for each core]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    threads: Option<String>,
}

impl ThreadArgs {
    /// Parses the number of threads. Without the option it is None, after a problem 1.
    pub fn given(&self, problems: &mut Problems) -> Option<u64> {
        let text = self.threads.as_ref()?;
        let given = count("--threads", text, 1..=MAX_THREADS);
        Some(problems.take(given).unwrap_or(1))
    }
}
