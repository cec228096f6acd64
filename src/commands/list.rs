//! `list`: built-in inputs.

use clap::{Args, ValueEnum};
use cvtcycle::analysis::levers::{Lever, LeverFile};
use cvtcycle::config::Problems;
use cvtcycle::config::csv::UNITS;
use cvtcycle::config::cycle::{self, Cycle};
use cvtcycle::config::procedure::{Procedure, TestResult};
use cvtcycle::config::setup::catalogue::{self, File};
use cvtcycle::config::setup::new_car::ClassOf;
use cvtcycle::config::setup::{self, Kind, Options, Setup};
use cvtcycle::model::drive::Start;
use cvtcycle::model::keys::stem;
use cvtcycle::model::lubricant::{Lubricant, ZERO_DEGC_K};
use cvtcycle::output::number::fixed;
use cvtcycle::output::table::{TextColumns, paragraphs};
use cvtcycle::study::plan::Plan;
use serde_json::{Value, json};

use super::Execute;
use crate::args::JsonArgs;
use crate::print::{CommandOutput, CommandResult, Terminal};

/// Arguments of `list`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "Example: cvtcycle list cycles")]
pub struct ListArgs {
    /// List to print
    #[arg(value_enum)]
    what: ListedKind,
    #[command(flatten)]
    output: JsonArgs,
}

/// Lists that the program has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ListedKind {
    /// Drive cycles with duration, distance, highest speed
    Cycles,
    /// Vehicles
    Vehicles,
    /// Classes of cars, boxes and engines, which vehicle files inherit from
    Classes,
    /// Transmission and engine oils
    Lubricants,
    /// Columns of a cycle's file, with their names in files of other programs
    Columns,
    /// Changes of a car's design
    Levers,
    /// Plans of studies
    Plans,
    /// Tests of `fleet` and `label`
    Tests,
}

/// A list as JSON and as text.
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
            ListedKind::Cycles => Some(list_cycles()),
            ListedKind::Vehicles => list_vehicles(problems),
            ListedKind::Classes => Some(list_classes()),
            ListedKind::Lubricants => list_lubricants(problems),
            ListedKind::Columns => Some(list_columns()),
            ListedKind::Levers => list_levers(problems),
            ListedKind::Plans => list_plans(problems),
            ListedKind::Tests => list_tests(problems),
        }
    }

    fn run(&self, list: Listing, terminal: Terminal) -> CommandResult {
        if self.output.json {
            return CommandOutput::json(&list.json);
        }
        let heading = terminal.stdout.heading(list.heading);
        let (table, note) = (list.table, paragraphs(list.note));
        Ok(CommandOutput::text(format!("{heading}\n{table}\n{note}")))
    }
}

fn list_cycles() -> Listing {
    let embedded = cycle::names().iter();
    let list: Vec<Cycle> = embedded.filter_map(|name| cycle::embedded(name)).collect();
    let km = |c: &Cycle, automatic: bool| c.trace_for(automatic).distance_m() / 1e3;
    let kmh = |c: &Cycle| c.trace_for(false).max_speed_m_s() * 3.6;
    let automatic = |c: &Cycle| match fixed(km(c, true), 3) {
        same if same == fixed(km(c, false), 3) => String::new(),
        other => other,
    };
    let aliases = |c: &Cycle| -> Vec<&'static str> {
        let own = cycle::ALIASES.iter().filter(|(_, name)| *name == c.name);
        own.map(|(alias, _)| *alias).collect()
    };
    let columns = TextColumns::new()
        .left("name", |c: &Cycle| c.name.clone())
        .number("s", 0, |c| c.trace_for(false).duration_s())
        .number("km", 3, |c| km(c, false))
        .right("km (auto)", automatic)
        .number("max km/h", 1, kmh)
        .left("title", |c| match aliases(c).join(", ") {
            also if also.is_empty() => c.title.clone(),
            also => format!("{} (also {also})", c.title),
        });
    let json = |c: &Cycle| {
        json!({
            "name": c.name, "aliases": aliases(c), "title": c.title, "duration_s": c.trace_for(false).duration_s(),
            "distance_km": km(c, false), "distance_automatic_km": km(c, true),
            "max_speed_kmh": kmh(c), "gears_prescribed": c.has_gears(),
        })
    };
    Listing {
        json: json!({ "cycles": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Cycles",
        table: columns.lines(&list),
        note: "Names in any capitals and with any signs between their words; wltc and wltp are the class of the car.\n\
            Also constant_V with V in km/h, such as constant_90, and any file with time and speed: `cvtcycle list columns`.\n\
            Two distances: a manual car drives the trace with gear-change plateaux, an automatic car the one without.\n",
    }
}

fn list_vehicles(problems: &mut Problems) -> Option<Listing> {
    let read = |name: &str| problems.take(setup::load(name, &Options::default()));
    let list: Vec<Setup> = Kind::Vehicle
        .names()
        .into_iter()
        .map(read)
        .collect::<Option<_>>()?;
    let gearbox = |v: &Setup| match v.transmission().is_cvt() {
        true => "cvt",
        false => "manual",
    };
    let mass_kg = |v: &Setup| v.road_load.base.mass_kg;
    let litres = |v: &Setup| v.engine().displacement_m3 * 1e3;
    let rated_kw = |v: &Setup| v.engine().rated_w / 1e3;
    let columns = TextColumns::new()
        .left("name", |v: &Setup| v.name.clone())
        .left("gearbox", gearbox)
        .number("kg", 0, mass_kg)
        .number("litres", 2, litres)
        .number("kW", 0, rated_kw)
        .left("title", |v| v.title.clone());
    let json = |v: &Setup| {
        json!({
            "name": v.name, "title": v.title, "transmission": gearbox(v), "mass_kg": mass_kg(v),
            "displacement_l": litres(v), "rated_kw": rated_kw(v), "baselines": v.baselines,
        })
    };
    Some(Listing {
        json: json!({ "vehicles": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Vehicles",
        table: columns.lines(&list),
        note: "`cvtcycle show NAME` prints every value with its source; --vehicle also takes the path of a TOML file.\n",
    })
}

fn list_classes() -> Listing {
    let files = catalogue::files().into_iter();
    let list: Vec<File> = files.filter(|file| file.kind == Kind::Class).collect();
    let value = |file: &File, key: &str| {
        let info = file.keys.iter().find(|info| info.key == key);
        info.map_or_else(String::new, |info| info.value.clone())
    };
    let of = |file: &File| match ClassOf::of_name(file.name) {
        ClassOf::Body => "body",
        ClassOf::Box => "box",
        ClassOf::Engine => "engine",
    };
    let shown = |key: &'static str| move |file: &File| value(file, key);
    let columns = TextColumns::new()
        .left("name", |file: &File| file.name)
        .left("of", |file: &File| of(file))
        .right("kg", shown("road_load.mass_kg"))
        .right("cm3", shown("engine.displacement_cc"))
        .right("kW", shown("engine.rated_kw"))
        .left("title", shown("vehicle.title"));
    let json = |file: &File| json!({ "name": file.name, "of": of(file), "title": value(file, "vehicle.title"), "keys": file.keys.len() });
    Listing {
        json: json!({ "classes": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Classes",
        table: columns.lines(&list),
        note: "A vehicle file takes what it leaves out from them, of several from the later: like = [\"class:compact_2020\", \"class:engine_pfi_2013\", \"class:box_cvt_clutch\"] in [vehicle].\n\
            `cvtcycle show NAME` prints every value with its source.\n",
    }
}

fn list_levers(problems: &mut Problems) -> Option<Listing> {
    let read = |name: &'static str| {
        let levers = problems.take(LeverFile::open(name))?.levers.into_iter();
        Some(levers.map(|lever| (name, lever)).collect::<Vec<_>>())
    };
    let files = Kind::Levers.names().into_iter().map(read);
    let files: Vec<_> = files.collect::<Option<_>>()?;
    let list: Vec<(&str, Lever)> = files.into_iter().flatten().collect();
    let group = |lever: &Lever| lever.group.clone().unwrap_or_default();
    let columns = TextColumns::new()
        .left("file", |(file, _): &(&str, Lever)| *file)
        .left("name", |(_, lever)| lever.name.clone())
        .left("group", move |(_, lever)| group(lever))
        .left("title", |(_, lever)| lever.title.clone());
    let json = |(file, lever): &(&str, Lever)| {
        json!({
            "file": file, "name": lever.name, "title": lever.title, "set": lever.set, "lubricant": lever.lubricant,
            "engine_oil": lever.engine_oil, "group": lever.group, "combine": lever.combine, "needs": lever.needs,
            "status": lever.status, "source": lever.source,
        })
    };
    Some(Listing {
        json: json!({ "levers": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Levers",
        table: columns.lines(&list),
        note: "`cvtcycle levers` drives them next to the car as it is; it takes your own TOML file as well.\n",
    })
}

fn list_tests(problems: &mut Problems) -> Option<Listing> {
    let read = |name: &'static str| problems.take(Procedure::open(name));
    let list: Vec<Procedure> = Procedure::names()
        .into_iter()
        .map(read)
        .collect::<Option<_>>()?;
    let columns = |test: &Procedure| {
        test.results
            .iter()
            .map(TestResult::column)
            .collect::<Vec<_>>()
    };
    let degc = |test: &Procedure| test.ambient_k - ZERO_DEGC_K;
    let text = TextColumns::new()
        .left("name", |test: &Procedure| test.name.clone())
        .left("cycle", |test| test.cycle_word.clone())
        .left("start", |test| {
            if test.start == Start::Warm {
                "warm"
            } else {
                "soak"
            }
        })
        .number("degC", 1, move |test| degc(test))
        .left("title", |test| test.title.clone());
    let json = |test: &Procedure| json!({ "name": test.name, "title": test.title, "cycle": test.cycle_word, "ambient_degc": degc(test), "columns": columns(test) });
    Some(Listing {
        json: json!({ "tests": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Tests",
        table: text.lines(&list),
        note: "`cvtcycle fleet` and `cvtcycle label` drive them; `fleet --test` takes your own TOML file as well.\n",
    })
}

fn list_plans(problems: &mut Problems) -> Option<Listing> {
    let read = |name: &'static str| Some((name, problems.take(Plan::open(name))?));
    let list = Kind::Plan.names().into_iter().map(read);
    let list: Vec<(&str, Plan)> = list.collect::<Option<_>>()?;
    let points = |plan: &Plan| plan.design.points(&plan.factors);
    let columns = TextColumns::new()
        .left("name", |(name, _): &(&str, Plan)| *name)
        .right("factors", |(_, plan)| plan.factors.len().to_string())
        .right("points", move |(_, plan)| {
            points(plan).map_or_else(String::new, |n| n.to_string())
        })
        .left("title", |(_, plan)| plan.title.clone());
    let json = |(name, plan): &(&str, Plan)| json!({ "name": name, "title": plan.title, "factors": plan.factors.len(), "points": points(plan) });
    Some(Listing {
        json: json!({ "plans": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Plans of studies",
        table: columns.lines(&list),
        note: "`cvtcycle study NAME` runs one; it takes your own TOML file as well. `--vehicle` puts another car in its place.\n",
    })
}

fn list_lubricants(problems: &mut Problems) -> Option<Listing> {
    let read = |name: &'static str| {
        let (oil, _) = problems.take(setup::load_lubricant(name))?;
        Some((name, oil))
    };
    let list = Kind::Lubricant.names().into_iter().map(read);
    let list: Vec<(&str, Lubricant)> = list.collect::<Option<_>>()?;
    let kv = |oil: &Lubricant, degc: f64| oil.kinematic_m2_s(degc + ZERO_DEGC_K) * 1e6;
    let columns = TextColumns::new()
        .left("name", |(name, _): &(&str, Lubricant)| *name)
        .number("KV-10", 0, |(_, oil)| kv(oil, -10.0))
        .number("KV40", 1, |(_, oil)| kv(oil, 40.0))
        .number("KV100", 2, |(_, oil)| kv(oil, 100.0))
        .number("density", 0, |(_, oil)| oil.density15_kg_m3)
        .left("title", |(_, oil)| oil.title.clone());
    let json = |(name, oil): &(&str, Lubricant)| {
        json!({
            "name": name, "title": oil.title, "kv_minus10_mm2_s": kv(oil, -10.0), "kv40_mm2_s": kv(oil, 40.0),
            "kv100_mm2_s": kv(oil, 100.0), "density15_kg_m3": oil.density15_kg_m3,
        })
    };
    Some(Listing {
        json: json!({ "lubricants": list.iter().map(json).collect::<Vec<_>>() }),
        heading: "Lubricants",
        table: columns.lines(&list),
        note: "Kinematic viscosities in mm2/s at -10, 40 and 100 degC, density in kg/m3 at 15 degC.\n",
    })
}

/// Column of a cycle's file: name here, names in files of other programs, and synonyms.
type ColumnNames = (String, Vec<&'static str>, Vec<&'static str>);

fn list_columns() -> Listing {
    let foreign = cycle::FOREIGN;
    let names_for = |list: &[(&'static str, &'static str)], wanted: &str| -> Vec<&'static str> {
        let own = list.iter().filter(|(_, name)| *name == wanted);
        own.map(|(written, _)| *written).collect()
    };
    let names = |name: String| -> ColumnNames {
        let (headings, words) = (
            names_for(foreign.headings, &name),
            names_for(foreign.words, stem(&name)),
        );
        (name, headings, words)
    };
    let list: Vec<ColumnNames> = cycle::columns().into_iter().map(names).collect();
    let columns = TextColumns::new()
        .left("column", |(name, ..): &ColumnNames| name.clone())
        .left("in other programs", |(_, headings, _)| headings.join(", "))
        .left("other words, with their unit", |(.., words)| {
            words.join(", ")
        });
    let units = UNITS
        .iter()
        .map(|(written, unit)| json!({ "written": written, "unit": unit }));
    let json = |(name, headings, words): &ColumnNames| json!({ "name": name, "headings": headings, "words": words });
    Listing {
        json: json!({ "columns": list.iter().map(json).collect::<Vec<_>>(), "units": units.collect::<Vec<_>>() }),
        heading: "Columns of a cycle's file",
        table: columns.lines(&list),
        note: "A unit is in the name (speed_kmh), in brackets or behind a comma (\"Speed (km/h)\", \"Time, s\"), or in a row of units below the names.\n\
            Commas, semicolons or tabs separate; decimal commas with the last two. --columns time=Time_ADC:s,speed=VehSpd:mph reads any other table.\n",
    }
}
