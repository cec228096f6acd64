//! `accelerate`: full-throttle times.

use clap::Args;
use cvtcycle::analysis::accelerate::{
    AXLE_SHARE, Conditions, DRIVEN, Drive, GRADE_PERCENT, GRIP, HEIGHT_OVER_BASE, SHIFT_S,
    SPEED_KMH, STEP_S, Span, Times, times, usual_grip, usual_spans,
};
use cvtcycle::config::setup::{self, START, Setup};
use cvtcycle::config::{Bound, Override, Problems};
use cvtcycle::model::drive::Grip;
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::thermal::{NODES, StartTemperatures};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::number::fixed;
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::{SCHEMA, StartWord};
use cvtcycle::output::table::{TextTable, wrapped};
use serde::Serialize;

use super::{Execute, threads};
use crate::args::problems::bad_value;
use crate::args::{
    AmbientArgs, Names, OutputArgs, VehicleArgs, choice_names, count, number, one_of,
};
use crate::print::colour::Paint;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, bold, json_text, sections};

/// Allowed load, kg.
const LOAD_KG: Bound = Bound::closed(0.0, 5000.0);
/// Kilometres in a mile.
const MILE_KM: f64 = 1.609_344;

/// Arguments of `accelerate`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle accelerate
  cvtcycle accelerate --vehicle civic_20_6mt --from 80 --to 120 --gear 4
  cvtcycle accelerate --vehicle mycar.toml --from 0 --to 60mph --grip 0.7 --load 150 --json

Without --from and --to: 0-100 km/h, 0-60 mph, 80-120 km/h, a quarter mile and 1000 m from rest. The car is that of `run`, its engine at full load from idle on; a \
CVT goes to the speed of greatest power, a manual box changes where the next gear pulls more. Grip, load on the axle and time of a change are \
assumed values. `cvtcycle explain AC-1` has the equations.")]
pub struct AccelerateArgs {
    #[command(flatten)]
    vehicle: VehicleArgs,
    #[command(flatten)]
    ambient: AmbientArgs,
    /// Speed at the begin: km/h, or with its unit (60mph) [default: 0 with --to]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    from: Option<String>,
    /// Speed at the end: km/h, or with its unit (60mph) [default: 100 with --from]
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    to: Option<String>,
    /// Grip of the driven tyres, friction coefficient, 0.05 to 2, or none without a limit; assumed, 0.7 to 1.1 on a dry road
    #[arg(
        long,
        value_name = "MU|none",
        default_value = "0.9",
        allow_hyphen_values = true
    )]
    grip: String,
    /// Driven wheels: front, rear or all
    #[arg(long, value_name = "WHEELS", default_value = "front", value_parser = Names(|| choice_names(&DRIVEN)), hide_possible_values = true)]
    driven: String,
    /// Share of the weight on the driven axle at rest, 0.2 to 0.9; assumed, 0.55 to 0.65 for front-wheel drive [default: 0.6, rear 0.5]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    axle_share: Option<String>,
    /// Height of the centre of mass over the wheelbase, 0 to 0.5; assumed, 0.18 to 0.25
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "0.21",
        allow_hyphen_values = true
    )]
    height_over_base: String,
    /// Slope of the road, %, -30 to 40
    #[arg(
        long,
        value_name = "PERCENT",
        default_value = "0",
        allow_hyphen_values = true
    )]
    grade: String,
    /// Load added to the payload of the file, kg, 0 to 5000
    #[arg(
        long,
        value_name = "KG",
        default_value = "0",
        allow_hyphen_values = true
    )]
    load: String,
    /// Time of a change of gear with the clutch open, s, 0 to 3; assumed, 0.2 to 1.0
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "0.5",
        allow_hyphen_values = true
    )]
    shift_time: String,
    /// Gear of a manual box that is kept, as in times from 80 to 120 km/h in fourth [default: changes]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    gear: Option<String>,
    /// Temperatures of the car: of all in degC, or of nodes as with `run`; the car keeps them up to the begin
    #[arg(
        long,
        value_name = "DEGC|NODE=DEGC,...",
        default_value = "coolant=90,sump=80",
        allow_hyphen_values = true
    )]
    start: String,
    /// Time step, s, 0.005 to 0.5; half of it is driven as well, for the error
    #[arg(
        long,
        value_name = "SECONDS",
        default_value = "0.05",
        allow_hyphen_values = true
    )]
    dt: String,
    #[command(flatten)]
    output: OutputArgs,
}

/// Checked input.
pub struct AcceleratePlan {
    setup: Setup,
    spans: Vec<(String, Span)>,
    conditions: Conditions,
    summary: Asked,
}

/// Input as the object of `--json` has it.
#[derive(Clone, Debug, Serialize)]
struct Asked {
    vehicle: String,
    title: String,
    mass_kg: f64,
    load_kg: f64,
    ambient_degc: f64,
    start: StartWord,
    grade_percent: f64,
    grip: Option<f64>,
    driven: String,
    axle_share: f64,
    height_over_base: f64,
    /// Null for a CVT.
    shift_s: Option<f64>,
    gear: Option<u8>,
    dt_s: f64,
}

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct AccelerateSummary {
    #[serde(flatten)]
    manifest: Manifest,
    #[serde(flatten)]
    asked: Asked,
    #[serde(flatten)]
    times: Times,
}

impl Execute for AccelerateArgs {
    type Plan = AcceleratePlan;

    fn plan(&self, problems: &mut Problems) -> Option<AcceleratePlan> {
        problems.take(threads::begin(None));
        let load_kg = problems.take(number("--load", &self.load, LOAD_KG, "kg"));
        let setup = self.setup(load_kg.unwrap_or(0.0), problems);
        let ambient_degc = self.ambient.get(problems);
        let spans = self.spans(problems);
        let grip = self.grip(problems);
        let grade = problems.take(number("--grade", &self.grade, GRADE_PERCENT, "percent"));
        let shift_s = problems.take(number("--shift-time", &self.shift_time, SHIFT_S, "s"));
        let dt_s = problems.take(number("--dt", &self.dt, STEP_S, "s"));
        let start = self.start(problems);
        let gear = setup.as_ref().and_then(|setup| self.gear(setup, problems));
        let (setup, ambient_degc, (grip, rest)) = (setup?, ambient_degc?, grip?);
        let (grade, shift_s, dt_s, start) = (grade?, shift_s?, dt_s?, start?);
        let manual = !setup.transmission().is_cvt();
        Some(AcceleratePlan {
            summary: Asked {
                vehicle: self.vehicle.vehicle.clone(),
                title: setup.title.clone(),
                mass_kg: setup.road_load.base.mass_kg,
                load_kg: load_kg?,
                ambient_degc,
                start: StartWord::of_nodes(&start),
                grade_percent: grade,
                grip: grip.map(|grip| grip.mu),
                driven: self.driven.clone(),
                axle_share: rest.axle_share,
                height_over_base: rest.height_over_base,
                shift_s: manual.then_some(shift_s),
                gear,
                dt_s,
            },
            conditions: Conditions {
                ambient_k: ambient_degc + ZERO_DEGC_K,
                start,
                grade: grade / 100.0,
                grip,
                shift_s,
                gear,
                dt_s,
            },
            setup,
            spans: spans?,
        })
    }

    fn run(&self, plan: AcceleratePlan, terminal: Terminal) -> CommandResult {
        let found = AccelerateSummary {
            manifest: Manifest::new(SCHEMA),
            times: times(&plan.setup, &plan.spans, &plan.conditions),
            asked: plan.summary,
        };
        let json = json_text(&found)?;
        let vehicle = &found.asked.vehicle;
        let failed = found.times.failed_checks().into_iter();
        let failures = failed.map(|words| format!("check failed: {vehicle}: {words}"));
        let results = Results::new(json, failures.collect(), WrittenFiles::default());
        Ok(results.output(&self.output, || {
            text(&found, &plan.setup.doubts(), terminal.stdout)
        }))
    }
}

impl AccelerateArgs {
    /// The vehicle with its load.
    fn setup(&self, load_kg: f64, problems: &mut Problems) -> Option<Setup> {
        let mut options = self.vehicle.options(Formulation::default(), problems);
        if load_kg > 0.0 {
            let more = format!("road_load.payload_kg+={load_kg:?}");
            options.set.extend(more.parse::<Override>().ok());
        }
        problems.take(setup::load(&self.vehicle.vehicle, &options))
    }

    fn spans(&self, problems: &mut Problems) -> Option<Vec<(String, Span)>> {
        if self.from.is_none() && self.to.is_none() {
            return Some(usual_spans());
        }
        let (from, to) = (
            self.from.as_deref().unwrap_or("0"),
            self.to.as_deref().unwrap_or("100"),
        );
        let from_kmh = speed_kmh("--from", from, problems);
        let to_kmh = speed_kmh("--to", to, problems);
        let (from_kmh, to_kmh) = (from_kmh?, to_kmh?);
        if from_kmh >= to_kmh {
            let message = "the speed at the end is not above that at the begin";
            let allowed = format!("above {from}");
            problems.add(bad_value("--to", to, &allowed, message, ""));
            return None;
        }
        let word = |text: &str| match text.trim().parse::<f64>() {
            Ok(_) => format!("{} km/h", text.trim()),
            Err(_) => text.trim().to_owned(),
        };
        let name = format!("{} to {}", word(from), word(to));
        Some(vec![(name, Span::Speeds(from_kmh / 3.6, to_kmh / 3.6))])
    }

    /// The grip, if there is a limit, and its other values.
    fn grip(&self, problems: &mut Problems) -> Option<(Option<Grip>, Grip)> {
        let driven = problems.take(one_of("--driven", &self.driven, &DRIVEN));
        let usual = usual_grip(driven.unwrap_or(Grip::default().driven));
        let share = match self.axle_share.as_deref() {
            Some(share) => problems.take(number("--axle-share", share, AXLE_SHARE, "")),
            None => Some(usual.axle_share),
        };
        let height = &self.height_over_base;
        let height = problems.take(number("--height-over-base", height, HEIGHT_OVER_BASE, ""));
        let mu = match self.grip.as_str() {
            "none" => Some(None),
            mu => problems.take(number("--grip", mu, GRIP, "")).map(Some),
        };
        let mu = mu?;
        let grip = Grip {
            mu: mu.unwrap_or(f64::INFINITY),
            driven: driven?,
            axle_share: share?,
            height_over_base: height?,
        };
        Some((mu.map(|_| grip), grip))
    }

    fn start(&self, problems: &mut Problems) -> Option<StartTemperatures> {
        if self.start.contains('=') {
            let found = setup::start_nodes(&self.start);
            return problems.take(found.map_err(|p| p.in_file("--start").key("--start")));
        }
        let degc = problems.take(number("--start", &self.start, START, "start_degc"))?;
        Some(StartTemperatures {
            given_k: [Some(degc + ZERO_DEGC_K); NODES + 1],
        })
    }

    fn gear(&self, setup: &Setup, problems: &mut Problems) -> Option<u8> {
        let text = self.gear.as_deref()?;
        let Transmission::Manual(manual) = setup.transmission() else {
            let message = "this car has no gears to be kept";
            problems.add(bad_value("--gear", text, "none with a CVT", message, ""));
            return None;
        };
        let most = manual.overall.len() as u64;
        let gear = problems.take(count("--gear", text, 1..=most))?;
        u8::try_from(gear).ok()
    }
}

/// Parses a speed, km/h: a number, or one with its unit.
fn speed_kmh(option: &str, text: &str, problems: &mut Problems) -> Option<f64> {
    let trimmed = text.trim();
    if let Some(mph) = trimmed.strip_suffix("mph") {
        let range = Bound::closed(0.0, 250.0);
        let mph = problems.take(number(option, mph, range, "mph"))?;
        return Some(mph * MILE_KM);
    }
    let kmh = trimmed.strip_suffix("km/h").or(trimmed.strip_suffix("kmh"));
    problems.take(number(option, kmh.unwrap_or(trimmed), SPEED_KMH, "kmh"))
}

fn text(found: &AccelerateSummary, doubts: &[String], paint: Paint) -> String {
    let (asked, times) = (&found.asked, &found.times);
    let mut text = bold(&headline(found), paint) + "\n";
    let mut table = TextTable::new("lrrr");
    table.row(["", "time s", "error of the step s", "end km/h"].map(str::to_owned));
    for span in &times.spans {
        table.row([
            span.span.clone(),
            span.time_s
                .map_or("not reached".to_owned(), |s| fixed(s, 2)),
            fixed(span.error_s, 3),
            fixed(span.end_kmh, 1),
        ]);
    }
    let parts = vec![("Times".to_owned(), table.text())];
    text += sections(parts, paint).trim_start();
    text.push('\n');
    let mut note = |words: &str| text += &wrapped(words, "");
    for drive in &times.drives {
        note(&about(asked, drive));
    }
    note(&assumed(asked));
    if let Some(doubt) = doubts.first() {
        note(&format!("doubt: {doubt}"));
    }
    text
}

/// First line: the first time.
fn headline(found: &AccelerateSummary) -> String {
    let vehicle = &found.asked.vehicle;
    let first = found.times.spans.first();
    let said = first.map(|first| match first.time_s {
        Some(time_s) => format!("{vehicle}: {} in {} s.", first.span, fixed(time_s, 1)),
        None => format!(
            "{vehicle}: {} is not reached, {} km/h is the highest speed.",
            first.span,
            fixed(first.end_kmh, 1)
        ),
    });
    said.unwrap_or_default()
}

/// Result of a drive.
fn about(asked: &Asked, drive: &Drive) -> String {
    let mut parts = Vec::new();
    if asked.grip.is_some() {
        let seconds = fixed(drive.grip_limited_s, 2);
        parts.push(format!("grip is the limit for {seconds} s"));
    }
    let shifts = drive.shifts.iter();
    let shifts: Vec<String> = shifts
        .map(|(time_s, gear)| format!("{gear} at {} s", fixed(*time_s, 1)))
        .collect();
    if !shifts.is_empty() {
        parts.push(format!("gears {}", shifts.join(", ")));
    }
    if let Some(foot_s) = drive.first_foot_s {
        let foot_s = fixed(foot_s, 2);
        parts.push(format!(
            "the first foot, which US magazines do not count, takes {foot_s} s"
        ));
    }
    for (flag, words) in [
        ("gross_slip", "the belt slips grossly"),
        ("outside_validity", "a model is outside its validity"),
    ] {
        let seconds = drive.flags_s.get(flag);
        parts.extend(seconds.map(|s| format!("{words} for {} s", fixed(*s, 1))));
    }
    format!(
        "from {} km/h: {}",
        fixed(drive.from_kmh, 0),
        parts.join("; ")
    )
}

/// Assumed values of the drives.
fn assumed(asked: &Asked) -> String {
    let mut parts = vec![format!("{} kg", fixed(asked.mass_kg, 0))];
    if let Some(mu) = asked.grip {
        parts.push(format!(
            "grip {} of the {} wheels with {} of the weight, centre of mass {} of the wheelbase high (AC-3)",
            fixed(mu, 2),
            asked.driven,
            fixed(asked.axle_share, 2),
            fixed(asked.height_over_base, 2)
        ));
    }
    if let Some(shift_s) = asked.shift_s {
        let shift_s = fixed(shift_s, 2);
        parts.push(format!("{shift_s} s for a change of gear (AC-4)"));
    }
    let nodes = asked.start.nodes_in_words().unwrap_or_default();
    format!("assumed: {}; {nodes}", parts.join(", "))
}
