//! `list`: what is built in.

use clap::{Args, ValueEnum};
use cvtcycle::config::setup::{self, Options};
use cvtcycle::config::{Problems, cycle};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use serde::Serialize;
use serde_json::{Value, json};

use super::Execute;
use crate::args::{JsonArgs, lubricants, vehicles};
use crate::print::table::TextColumns;
use crate::print::{CommandOutput, CommandResult, Terminal};
use cvtcycle::output::number::fixed;

/// Arguments of `list`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: cvtcycle list cycles")]
pub struct ListArgs {
    /// What to list
    #[arg(value_enum)]
    what: ListedKind,
    #[command(flatten)]
    output: JsonArgs,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ListedKind {
    /// Drive cycles with duration, distance, highest speed
    Cycles,
    /// Vehicles
    Vehicles,
    /// Transmission and engine oils
    Lubricants,
}

#[derive(Serialize)]
struct CycleLine {
    name: &'static str,
    title: String,
    duration_s: f64,
    distance_km: f64,
    distance_automatic_km: f64,
    max_speed_kmh: f64,
    gears_prescribed: bool,
}

#[derive(Serialize)]
struct VehicleLine {
    name: &'static str,
    title: String,
    transmission: &'static str,
    mass_kg: f64,
    displacement_l: f64,
    rated_kw: f64,
    baselines: Vec<String>,
}

#[derive(Serialize)]
struct LubricantLine {
    name: &'static str,
    title: String,
    kv_minus10_mm2_s: f64,
    kv40_mm2_s: f64,
    kv100_mm2_s: f64,
    density15_kg_m3: f64,
}

/// A list in both forms.
pub struct Listing {
    json: Value,
    heading: &'static str,
    table: String,
    note: &'static str,
}

impl Execute for ListArgs {
    type Plan = Listing;

    fn plan(&self, problems: &mut Problems) -> Option<Listing> {
        match self.what {
            ListedKind::Cycles => Some(cycles()),
            ListedKind::Vehicles => list_vehicles(problems),
            ListedKind::Lubricants => list_lubricants(problems),
        }
    }

    fn run(&self, list: Listing, terminal: Terminal) -> CommandResult {
        if self.output.json {
            return CommandOutput::json(&list.json);
        }
        let heading = terminal.stdout.heading(list.heading);
        Ok(CommandOutput::text(format!(
            "{heading}\n{}\n{}",
            list.table, list.note
        )))
    }
}

fn cycles() -> Listing {
    let embedded = cycle::names()
        .iter()
        .filter_map(|name| Some((*name, cycle::embedded(name)?)));
    let line = |(name, cycle): (&'static str, cycle::Cycle)| {
        let (manual, automatic) = (cycle.trace_for(false), cycle.trace_for(true));
        CycleLine {
            name,
            duration_s: manual.duration_s(),
            distance_km: manual.distance_m() / 1e3,
            distance_automatic_km: automatic.distance_m() / 1e3,
            max_speed_kmh: manual.max_speed_m_s() * 3.6,
            gears_prescribed: cycle.has_gears(),
            title: cycle.title,
        }
    };
    let list: Vec<CycleLine> = embedded.map(line).collect();
    let automatic = |c: &CycleLine| match fixed(c.distance_automatic_km, 3) {
        same if same == fixed(c.distance_km, 3) => String::new(),
        other => other,
    };
    let columns = TextColumns::new()
        .left("name", |c: &CycleLine| c.name)
        .right("s", |c| fixed(c.duration_s, 0))
        .right("km", |c| fixed(c.distance_km, 3))
        .right("km (auto)", automatic)
        .right("max km/h", |c| fixed(c.max_speed_kmh, 1))
        .left("title", |c| c.title.clone());
    Listing {
        json: json!({ "cycles": list }),
        heading: "Cycles",
        table: columns.table(&list).text(),
        note: "Also constant_V with V in km/h, such as constant_90, and any CSV file with time_s and speed_kmh.\n\
            Two distances: a manual car drives the trace with gear-change plateaux, an automatic car the one without.\n",
    }
}

fn list_vehicles(problems: &mut Problems) -> Option<Listing> {
    let line = |name: &'static str| {
        let setup = problems.take(setup::load(name, &Options::default()))?;
        let car = setup.car(ZERO_DEGC_K + 20.0);
        let cvt = setup.transmission().is_cvt();
        Some(VehicleLine {
            name,
            transmission: if cvt { "cvt" } else { "manual" },
            mass_kg: car.road_load.mass_kg,
            displacement_l: car.engine.displacement_m3 * 1e3,
            rated_kw: car.engine.rated_w / 1e3,
            title: setup.title,
            baselines: setup.baselines,
        })
    };
    let list: Vec<VehicleLine> = vehicles().into_iter().map(line).collect::<Option<_>>()?;
    let columns = TextColumns::new()
        .left("name", |v: &VehicleLine| v.name)
        .left("gearbox", |v| v.transmission)
        .right("kg", |v| fixed(v.mass_kg, 0))
        .right("litres", |v| fixed(v.displacement_l, 2))
        .right("kW", |v| fixed(v.rated_kw, 0))
        .left("title", |v| v.title.clone());
    Some(Listing {
        json: json!({ "vehicles": list }),
        heading: "Vehicles",
        table: columns.table(&list).text(),
        note: "`cvtcycle show NAME` prints every value with its source; --vehicle also takes the path of a TOML file.\n",
    })
}

fn list_lubricants(problems: &mut Problems) -> Option<Listing> {
    let line = |name: &'static str| {
        let (oil, _) = problems.take(setup::load_lubricant(name))?;
        let kv = |degc: f64| oil.kinematic_m2_s(degc + ZERO_DEGC_K) * 1e6;
        Some(LubricantLine {
            name,
            kv_minus10_mm2_s: kv(-10.0),
            kv40_mm2_s: kv(40.0),
            kv100_mm2_s: kv(100.0),
            density15_kg_m3: oil.density15_kg_m3,
            title: oil.title,
        })
    };
    let list: Vec<LubricantLine> = lubricants().into_iter().map(line).collect::<Option<_>>()?;
    let columns = TextColumns::new()
        .left("name", |l: &LubricantLine| l.name)
        .right("KV-10", |l| fixed(l.kv_minus10_mm2_s, 0))
        .right("KV40", |l| fixed(l.kv40_mm2_s, 1))
        .right("KV100", |l| fixed(l.kv100_mm2_s, 2))
        .right("density", |l| fixed(l.density15_kg_m3, 0))
        .left("title", |l| l.title.clone());
    Some(Listing {
        json: json!({ "lubricants": list }),
        heading: "Lubricants",
        table: columns.table(&list).text(),
        note: "Kinematic viscosities in mm2/s at -10, 40 and 100 degC, density in kg/m3 at 15 degC.\n",
    })
}
