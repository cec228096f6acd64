//! `label`: the figures of a fuel label.

use clap::Args;
use cvtcycle::analysis::label::{self, COLD_LOAD_FACTOR, Cars, Cycles, Figures};
use cvtcycle::config::csv::Columns;
use cvtcycle::config::cycle::{self, Cycle};
use cvtcycle::config::setup::{self, Kind, Options, Setup};
use cvtcycle::config::{Bound, Override, Problems};
use cvtcycle::output::number::fixed;
use cvtcycle::output::record::Manifest;
use cvtcycle::output::summary::SCHEMA;
use cvtcycle::output::table::{TextTable, wrapped};
use serde::Serialize;

use super::{Execute, threads};
use crate::args::problems::overrides;
use crate::args::{Names, OutputArgs, number};
use crate::print::colour::Paint;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text, sections};

/// Allowed electric load of air conditioning or heating at the shaft, W.
const LOAD_W: Bound = Bound::closed(0.0, 6000.0);
/// Longest step, s.
const STEP_S: f64 = 1.0;
/// Key of the load at the shaft.
const LOAD_KEY: &str = "engine.electrical_w";

/// Arguments of `label`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cvtcycle label civic_20_cvt civic_20_6mt
  cvtcycle label civic_20_cvt --cold-w 300 --ac-w 2000
  cvtcycle label mycar.toml --set road_load.mass_kg=1320 --json

Each car drives FTP75, HWFET and US06 at 24 degC, FTP75 with 10 % more road load at -6.7 degC, SC03 at 35 degC, and the WLTC of its class at 23 and \
14 degC. The tests are those of cycles/tests, their figures stated for the fuel of 1975 (TE-3). `cvtcycle explain LB-4` has the formulas. Not for certification: the figures compare cars, and show what a label makes of a loss.")]
pub struct LabelArgs {
    /// Vehicles
    #[arg(value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    cars: Vec<String>,
    /// Override one value of all vehicles; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Load of the air conditioning at the engine's shaft in SC03, W, 0 to 6000
    #[arg(
        long,
        value_name = "W",
        default_value = "0",
        allow_hyphen_values = true
    )]
    ac_w: String,
    /// Load of heating and blower at the engine's shaft in the cold test, W, 0 to 6000
    #[arg(
        long,
        value_name = "W",
        default_value = "0",
        allow_hyphen_values = true
    )]
    cold_w: String,
    #[command(flatten)]
    output: OutputArgs,
}

/// Car in the variants of the three climates.
struct Car {
    name: String,
    mild: Setup,
    cold: Setup,
    hot: Setup,
    wltc: Cycle,
}

/// Checked input.
pub struct LabelPlan {
    cars: Vec<Car>,
    us: [Cycle; 4],
    loads: Loads,
}

/// Electric loads of heating and air conditioning, W.
#[derive(Clone, Copy, Debug, Serialize)]
struct Loads {
    cold_w: f64,
    ac_w: f64,
}

/// The object of `--json`.
#[derive(Debug, Serialize)]
struct LabelSummary {
    #[serde(flatten)]
    manifest: Manifest,
    #[serde(flatten)]
    loads: Loads,
    cars: Vec<CarLabel>,
}

/// Car with its label figures.
#[derive(Debug, Serialize)]
struct CarLabel {
    vehicle: String,
    #[serde(flatten)]
    figures: Figures,
}

impl Execute for LabelArgs {
    type Plan = LabelPlan;

    fn plan(&self, problems: &mut Problems) -> Option<LabelPlan> {
        problems.take(threads::begin(None));
        let set = overrides("--set", &self.set, problems);
        let load = |option: &str, text: &str| number(option, text, LOAD_W, "w");
        let ac_w = problems.take(load("--ac-w", &self.ac_w));
        let cold_w = problems.take(load("--cold-w", &self.cold_w));
        let loads = Loads {
            ac_w: ac_w.unwrap_or(0.0),
            cold_w: cold_w.unwrap_or(0.0),
        };
        let mut open = |name: &str| problems.take(cycle::open(name, &Columns::default()));
        let us = [open("ftp75"), open("hwfet"), open("us06"), open("sc03")];
        let wltc = open("wltc")?;
        let cars: Vec<Car> = self
            .cars
            .iter()
            .filter_map(|name| car(name, &set, &loads, &wltc, problems))
            .collect();
        let [ftp75, hwfet, us06, sc03] = us;
        Some(LabelPlan {
            cars,
            us: [ftp75?, hwfet?, us06?, sc03?],
            loads,
        })
    }

    fn run(&self, plan: LabelPlan, terminal: Terminal) -> CommandResult {
        let [ftp75, hwfet, us06, sc03] = &plan.us;
        let drive = |car: &Car| {
            let cars = Cars {
                mild: &car.mild,
                cold: &car.cold,
                hot: &car.hot,
            };
            let cycles = Cycles {
                ftp75,
                hwfet,
                us06,
                sc03,
                wltc: &car.wltc,
            };
            let figures = label::figures(&cars, &cycles, STEP_S)?;
            Ok::<_, Problems>(CarLabel {
                vehicle: car.name.clone(),
                figures,
            })
        };
        let found = LabelSummary {
            manifest: Manifest::new(SCHEMA),
            loads: plan.loads,
            cars: plan.cars.iter().map(drive).collect::<Result<_, _>>()?,
        };
        let json = json_text(&found)?;
        let failures = found.cars.iter().flat_map(|car| {
            let missed = car.figures.missed_s.iter();
            missed.map(|(test, seconds)| {
                format!(
                    "check failed: {}: {test} missed for {seconds:.0} s",
                    car.vehicle
                )
            })
        });
        let results = Results::new(json, failures.collect(), WrittenFiles::default());
        Ok(results.output(&self.output, || text(&found, terminal.stdout)))
    }
}

/// Reads a car in three variants: as is, for the cold test, and with air conditioning.
fn car(
    name: &str,
    set: &[Override],
    loads: &Loads,
    wltc: &Cycle,
    problems: &mut Problems,
) -> Option<Car> {
    let options = |more: &[String]| {
        let more = more.iter().filter_map(|text| text.parse().ok());
        Options {
            set: set.iter().cloned().chain(more).collect(),
            ..Options::default()
        }
    };
    let mild = problems.take(setup::load(name, &options(&[])))?;
    let factor = format!("{:?}", COLD_LOAD_FACTOR * mild.road_load.load_factor);
    let load_w = |more_w: f64| format!("{LOAD_KEY}+={more_w:?}");
    let cold = [
        format!("road_load.load_factor={factor}"),
        load_w(loads.cold_w),
    ];
    let cold = problems.take(setup::load(name, &options(&cold)));
    let hot = problems.take(setup::load(name, &options(&[load_w(loads.ac_w)])));
    Some(Car {
        name: name.to_owned(),
        wltc: cycle::for_car("wltc", wltc.clone(), &mild),
        cold: cold?,
        hot: hot?,
        mild,
    })
}

fn text(found: &LabelSummary, paint: Paint) -> String {
    let parts = [
        ("Tests, as burnt", tests(found)),
        ("US label", labels(found)),
        ("WLTP", wltp(found)),
    ];
    let parts = parts.map(|(title, table)| (title.to_owned(), table));
    let mut notes = String::new();
    let mut note = |words: &str| notes += &wrapped(words, "");
    if found.loads.ac_w <= 0.0 {
        note(
            "SC03 is without air conditioning, which the test has on: --ac-w (1500 to 3000 W for a compact car is usual)",
        );
    }
    if found.loads.cold_w <= 0.0 {
        note("the cold test is without heating, which it has on: --cold-w (300 W for the blower)");
    }
    note(
        "not computed: NEDC from WLTP, correction of WLTP for the battery, figures of hybrids; not for certification",
    );
    sections(parts.to_vec(), paint).trim_start().to_owned() + "\n" + &notes
}

/// Row of a table: name, unit, decimals, and accessor of the value.
type Line<'a> = (&'a str, &'a str, usize, &'a dyn Fn(&Figures) -> f64);

/// A table with a column for each car.
fn by_car(found: &LabelSummary, rows: &[Line]) -> String {
    let mut table = TextTable::new(&("ll".to_owned() + &"r".repeat(found.cars.len())));
    let names = found.cars.iter().map(|car| car.vehicle.clone());
    table.row([String::new(), String::new()].into_iter().chain(names));
    for (name, unit, digits, value) in rows {
        let head = [(*name).to_owned(), (*unit).to_owned()].into_iter();
        let cells = found
            .cars
            .iter()
            .map(|car| fixed(value(&car.figures), *digits));
        table.row(head.chain(cells));
    }
    table.text()
}

fn tests(found: &LabelSummary) -> String {
    let unit = "L/100 km";
    by_car(
        found,
        &[
            ("FTP75, 24 degC", unit, 2, &|f| f.tests.ftp75),
            ("  bag 1", unit, 2, &|f| f.tests.bags[0]),
            ("  bag 2", unit, 2, &|f| f.tests.bags[1]),
            ("  bag 3", unit, 2, &|f| f.tests.bags[2]),
            ("FTP75, -6.7 degC, bag 1", unit, 2, &|f| {
                f.tests.cold_bags[0]
            }),
            ("  bag 2", unit, 2, &|f| f.tests.cold_bags[1]),
            ("  bag 3", unit, 2, &|f| f.tests.cold_bags[2]),
            ("HWFET", unit, 2, &|f| f.tests.hwfet),
            ("US06, city", unit, 2, &|f| f.tests.us06[0]),
            ("US06, highway", unit, 2, &|f| f.tests.us06[1]),
            ("SC03, 35 degC", unit, 2, &|f| f.tests.sc03),
        ],
    )
}

fn labels(found: &LabelSummary) -> String {
    let unit = "mpg (US)";
    by_car(
        found,
        &[
            ("unadjusted (LB-1), city", unit, 1, &|f| {
                f.unadjusted.city_mpg
            }),
            ("  highway", unit, 1, &|f| f.unadjusted.highway_mpg),
            ("  combined", unit, 1, &|f| f.unadjusted.combined_mpg),
            ("formulas of 2008 (LB-2), city", unit, 1, &|f| {
                f.derived.city_mpg
            }),
            ("  highway", unit, 1, &|f| f.derived.highway_mpg),
            ("  combined", unit, 1, &|f| f.derived.combined_mpg),
            ("five cycles (LB-4), city", unit, 1, &|f| {
                f.five_cycle.city_mpg
            }),
            ("  highway", unit, 1, &|f| f.five_cycle.highway_mpg),
            ("  combined", unit, 1, &|f| f.five_cycle.combined_mpg),
        ],
    )
}

fn wltp(found: &LabelSummary) -> String {
    by_car(
        found,
        &[
            ("WLTC, 23 degC", "L/100 km", 2, &|f| {
                f.wltp[0].fuel_l_per_100km
            }),
            ("", "g CO2/km", 1, &|f| f.wltp[0].co2_g_per_km),
            ("WLTC, 14 degC", "L/100 km", 2, &|f| {
                f.wltp[1].fuel_l_per_100km
            }),
            ("", "g CO2/km", 1, &|f| f.wltp[1].co2_g_per_km),
            ("CO2 at 14 over 23 degC (LB-5)", "", 4, &|f| {
                f.co2_14_over_23
            }),
        ],
    )
}
