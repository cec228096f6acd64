//! `list`: what the program carries.

use clap::ValueEnum;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle;
use cvtcycle::config::setup::{self, Options};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use serde::Serialize;

use super::Context;
use crate::args::{lubricants, vehicles};
use crate::print::grid::Grid;
use crate::print::{Answer, Reply};
use cvtcycle::output::number::fixed;

/// Arguments of `list`.
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "Example: cvtcycle list cycles")]
pub struct Args {
    /// What to list
    #[arg(value_enum)]
    what: What,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// What can be listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum What {
    /// Drive cycles with duration, distance, highest speed
    Cycles,
    /// Cars
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

/// Runs the command.
pub fn answer(args: &Args, context: Context) -> Reply {
    let heading = |words: &str| context.paint.heading(words) + "\n";
    match args.what {
        What::Cycles => {
            let list = cycle_lines();
            if args.json {
                return Answer::json(&serde_json::json!({ "cycles": list }));
            }
            let more = "\nAlso constant_V, V in km/h, such as constant_90, and any CSV file with time_s and speed_kmh.\n\
                Where the distances differ, a manual car drives the trace with gear-change plateaux, an automatic the straight one.\n";
            Ok(Answer::text(heading("Cycles") + &cycle_table(&list) + more))
        }
        What::Vehicles => {
            let list = vehicle_lines()?;
            if args.json {
                return Answer::json(&serde_json::json!({ "vehicles": list }));
            }
            let more = "\n`cvtcycle show NAME` prints every value with its source; --vehicle also takes the path of a TOML file.\n";
            Ok(Answer::text(
                heading("Vehicles") + &vehicle_table(&list) + more,
            ))
        }
        What::Lubricants => {
            let list = lubricant_lines()?;
            if args.json {
                return Answer::json(&serde_json::json!({ "lubricants": list }));
            }
            let more = "\nKinematic viscosities in mm2/s at -10, 40 and 100 degC, density in kg/m3 at 15 degC.\n";
            Ok(Answer::text(
                heading("Lubricants") + &lubricant_table(&list) + more,
            ))
        }
    }
}

fn cycle_lines() -> Vec<CycleLine> {
    let cycles = cycle::names()
        .iter()
        .filter_map(|name| cycle::embedded(name).map(|cycle| (*name, cycle)));
    cycles
        .map(|(name, cycle)| {
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
        })
        .collect()
}

fn cycle_table(list: &[CycleLine]) -> String {
    let mut grid = Grid::new("lrrrrl");
    grid.row(["name", "s", "km", "km (auto)", "max km/h", "title"]);
    for line in list {
        let (manual, automatic) = (
            fixed(line.distance_km, 3),
            fixed(line.distance_automatic_km, 3),
        );
        let automatic = if manual == automatic {
            String::new()
        } else {
            automatic
        };
        grid.row([
            line.name,
            &fixed(line.duration_s, 0),
            &manual,
            &automatic,
            &fixed(line.max_speed_kmh, 1),
            &line.title,
        ]);
    }
    grid.text()
}

fn vehicle_lines() -> Result<Vec<VehicleLine>, Problems> {
    let line = |name: &'static str| {
        let setup = setup::load(name, "list", &Options::default())?;
        let car = setup.car(ZERO_DEGC_K + 20.0);
        Ok(VehicleLine {
            name,
            transmission: if setup.transmission().is_cvt() {
                "cvt"
            } else {
                "manual"
            },
            mass_kg: car.road_load.mass_kg,
            displacement_l: car.engine.displacement_m3 * 1e3,
            rated_kw: car.engine.rated_w / 1e3,
            title: setup.title,
            baselines: setup.baselines,
        })
    };
    vehicles().into_iter().map(line).collect()
}

fn vehicle_table(list: &[VehicleLine]) -> String {
    let mut grid = Grid::new("llrrrl");
    grid.row(["name", "gearbox", "kg", "litres", "kW", "title"]);
    for line in list {
        let numbers = [
            fixed(line.mass_kg, 0),
            fixed(line.displacement_l, 2),
            fixed(line.rated_kw, 0),
        ];
        grid.row([
            line.name,
            line.transmission,
            &numbers[0],
            &numbers[1],
            &numbers[2],
            &line.title,
        ]);
    }
    grid.text()
}

fn lubricant_lines() -> Result<Vec<LubricantLine>, Problems> {
    let line = |name: &'static str| {
        let (oil, _) = setup::load_lubricant(name, "list", &[], "")?;
        let kv = |degc: f64| oil.kinematic_m2_s(degc + ZERO_DEGC_K) * 1e6;
        Ok(LubricantLine {
            name,
            kv_minus10_mm2_s: kv(-10.0),
            kv40_mm2_s: kv(40.0),
            kv100_mm2_s: kv(100.0),
            density15_kg_m3: oil.density15_kg_m3,
            title: oil.title,
        })
    };
    lubricants().into_iter().map(line).collect()
}

fn lubricant_table(list: &[LubricantLine]) -> String {
    let mut grid = Grid::new("lrrrrl");
    grid.row(["name", "KV-10", "KV40", "KV100", "density", "title"]);
    for line in list {
        let kv = [
            fixed(line.kv_minus10_mm2_s, 0),
            fixed(line.kv40_mm2_s, 1),
            fixed(line.kv100_mm2_s, 2),
        ];
        grid.row([
            line.name,
            &kv[0],
            &kv[1],
            &kv[2],
            &fixed(line.density15_kg_m3, 0),
            &line.title,
        ]);
    }
    grid.text()
}
