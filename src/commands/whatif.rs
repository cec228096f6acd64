//! `whatif`: a page on which a car can be driven again with other values, without this program.

use std::path::PathBuf;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::config::cycle;
use cvtcycle::config::setup::Kind;
use cvtcycle::output::summary::start_on;
use cvtcycle::report::document::Document;
use cvtcycle::report::whatif::{LiveSection, Scene, State};
use cvtcycle::report::write::{Form, Target};

use super::Execute;
use super::vehicles::{self, Baselines};
use crate::args::problems::cite_car;
use crate::args::{AmbientArgs, ComparisonArgs, DrivingArgs, Names, ResultArgs, VehicleArgs};
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};

/// Arguments of `whatif`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.value_name("FILE.html").help("The page [default: whatif.html]")),
    after_help = "\
Examples:
  cvtcycle whatif --ambient -10
  cvtcycle whatif mycar.toml --baseline twin --out mycar.html
  cvtcycle whatif civic_20_cvt --cycle wltp --lubricant dexron_iii

The page is one file that loads nothing: it has the simulator with it, and the files that the car is made of, measured maps and own fluids \
as well. It computes fuel, losses and temperatures as levers are moved, and the interval of each difference from draws of the uncertain \
values when they rest. Its command prints the same numbers here. A browser without WebAssembly shows the car as it is."
)]
pub struct WhatifArgs {
    /// Vehicle
    #[arg(value_name = "NAME|FILE.toml", default_value = "rover_216_cvt", value_parser = Names(|| Kind::Vehicle.names()), hide_possible_values = true)]
    vehicle: String,
    /// Transmission oil of this vehicle [default: from the vehicle file]
    #[arg(long, value_name = "NAME|FILE.toml", value_parser = Names(|| Kind::Lubricant.names()), hide_possible_values = true)]
    lubricant: Option<String>,
    /// Override one value of this vehicle, whatever the levers are at; repeatable
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    comparison: ComparisonArgs,
    #[command(flatten)]
    ambient: AmbientArgs,
    #[command(flatten)]
    driving: DrivingArgs,
    #[command(flatten)]
    results: ResultArgs,
}

impl Execute for WhatifArgs {
    type Plan = (Scene, String, Target);

    fn plan(&self, problems: &mut Problems) -> Option<Self::Plan> {
        let cycle = problems.take(cycle::find(&self.comparison.cycle.word));
        let formulation = self.driving.formulation.get(problems);
        let car = VehicleArgs {
            vehicle: self.vehicle.clone(),
            lubricant: self.lubricant.clone(),
            set: self.set.clone(),
        };
        let comparison = (&self.comparison, Baselines::OfFile);
        let mut found = Problems::new();
        let cars = vehicles::load(&car, comparison, formulation, &mut found);
        problems.append(found.map(cite_car));
        let ambient = self.ambient.get(problems);
        let (start, dt_s) = self.driving.drive.get(problems);
        let file = self.results.out.out.clone();
        let file = file.unwrap_or_else(|| PathBuf::from("whatif.html"));
        let target = problems.take(Target::new(&file, Form::Html, self.results.out.force));
        let start = start_on(&cycle?, start?);
        let (subject, baselines) = cars.split_first()?;
        let scene = Scene {
            vehicle: car.vehicle,
            baselines: baselines.iter().map(|car| car.word.clone()).collect(),
            set: car.set,
            set_all: self.comparison.set_all.clone(),
            engine_oil: self.comparison.engine_oil.clone(),
            start: start.1.text(),
            dt_s: dt_s?,
            formulation: formulation.name().to_owned(),
            state: State {
                cycle: self.comparison.cycle.word.clone(),
                ambient_degc: ambient?,
                lubricant: car.lubricant,
                ..State::default()
            },
            first_figure: 1,
            ..Scene::default()
        };
        Some((scene, subject.setup.title.clone(), target?))
    }

    fn run(&self, (scene, title, target): Self::Plan, _: Terminal) -> CommandResult {
        let document = Document {
            subtitle: "Levers of its design, driven in this page".to_owned(),
            running: scene.state.cycle.clone(),
            title,
            live: Some(LiveSection::new(scene)?),
            ..Document::default()
        };
        let paths = target.write(&document)?;
        let page = paths.first().map(|path| path.display().to_string());
        let page = page.unwrap_or_default();
        let json = json_text(&serde_json::json!({ "page": page }))?;
        let results = Results::new(json, Vec::new(), WrittenFiles::default());
        Ok(results.output(&self.results.output, || format!("{page}\n")))
    }
}
