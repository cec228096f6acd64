//! `rig transmission`: the tests of thesis chapters 4 and 5 on a CVT.

mod tables;

use clap::Args;
use cvtcycle::config::rig::{OIL, TORQUE};
use cvtcycle::config::setup::{self, Setup};
use cvtcycle::config::{Bound, Override, Problems, Target, to_si};
use cvtcycle::model::rig::transmission::{Conditions, Plan as TestPoints};
use cvtcycle::model::rig::{Bench, solvable_ratios};
use cvtcycle::model::transmission::Transmission;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::record::Manifest;
use cvtcycle::output::rig::{RigResults, RigTest};
use cvtcycle::report::charts::rig_transmission::{self as plots, Subject};
use serde_json::{Value, json};

use crate::args::problems::bad_value;
use crate::args::ranges::{values, values_or_words};
use crate::args::{FormulationArgs, Names, ResultArgs, VehicleArgs, choice_names, one_of};
use crate::commands::Execute;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, json_text};

/// Schema version of the JSON object.
const SCHEMA: u32 = 1;
/// Allowed belt ratios.
const RATIO: Bound = Bound::closed(0.3, 3.0);
/// Allowed input speeds, rpm.
const SPEED: Bound = Bound::closed(100.0, 8000.0);

/// Arguments of `rig transmission`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write summary.json, tables (CSV) and plots (SVG) into this directory")),
    mut_arg("set", |set| set.help("Override one value; repeatable. `rig.KEY` is a value of the rig, `lubricant.KEY` of the oil, any other of the vehicle")),
    after_help = "\
Examples:
  cvtcycle rig transmission
  cvtcycle rig transmission --test strip_down --out strip
  cvtcycle rig transmission --test steady --ratio low,1 --speed 1000..4000:500 --temp -10,25,95
  cvtcycle rig transmission --test transient --set rig.transient.start_degc=10 --json

--ratio, --speed, --temp and --torque take numbers, lists and ranges FROM..TO:STEP; the defaults are the test points of the rig. \
Transients run at rig.transient.speed_rpm, independent of --speed, --temp and --torque. `cvtcycle explain rig.pressure` explains \
the keys of the rig."
)]
pub struct RigTransmissionArgs {
    /// Test: all, steady, loaded, strip_down, transient or second_box
    #[arg(long, value_name = "TEST", default_value = "all", value_parser = Names(|| [vec!["all"], choice_names(&RigTest::NAMES)].concat()), hide_possible_values = true)]
    test: String,
    #[command(flatten)]
    car: VehicleArgs,
    /// Belt ratios, 0.3 to 3, or `low` and `high` of the rig [default: low,high]
    #[arg(long, value_name = "VALUES")]
    ratio: Option<String>,
    /// Input speeds, rpm, 100 to 8000 [default: 1000..4000:250 in low, 1750..4000:250 in high]
    #[arg(long, value_name = "VALUES")]
    speed: Option<String>,
    /// Temperatures of the bulk oil, degC, -30 to 120 [default: 25,50,75,95]
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    temp: Option<String>,
    /// Torques at the output shaft in the loaded test, Nm, -100 to 1000 [default: 0,25,50,75,100]
    #[arg(long, value_name = "VALUES", allow_hyphen_values = true)]
    torque: Option<String>,
    #[command(flatten)]
    formulation: FormulationArgs,
    #[command(flatten)]
    results: ResultArgs,
}

/// Checked input of the tests.
pub struct RigPlan {
    /// Chosen test, or None for all.
    test: Option<RigTest>,
    setup: Setup,
    conditions: Conditions,
    points: TestPoints,
    formulation: String,
    set: Vec<String>,
    out: Option<OutputDir>,
}

impl Execute for RigTransmissionArgs {
    type Plan = RigPlan;

    fn plan(&self, problems: &mut Problems) -> Option<RigPlan> {
        let tests = RigTest::NAMES.map(|(name, test)| (name, Some(test)));
        let tests = [&[("all", None)], tests.as_slice()].concat();
        let test = problems.take(one_of("--test", &self.test, &tests));
        let formulation = self.formulation.get(problems);
        let mut options = self.car.options(formulation, problems);
        let is_of_rig = |by: &mut Override| by.target() == Target::Rig;
        let of_rig: Vec<Override> = options.set.extract_if(.., is_of_rig).collect();
        let vehicle = &self.car.vehicle;
        let setup = problems.take(setup::load(vehicle, &options));
        let hint = format!(
            "`cvtcycle losses --vehicle {vehicle}` computes the losses of a manual gearbox"
        );
        self.car.need_cvt(setup.as_ref(), &hint, problems);
        let conditions = problems.take(cvtcycle::config::rig::load(&of_rig));
        let conditions = conditions.map(|(conditions, _)| conditions);
        let points = self.points(conditions.as_ref(), problems);
        if let (Some(setup), Some(points)) = (&setup, &points) {
            check_ratios(setup, points, problems);
        }
        let out = self.results.out.dir(problems);
        Some(RigPlan {
            test: test?,
            setup: setup?,
            conditions: conditions?,
            points: points?,
            formulation: self.formulation.formulation.clone(),
            set: self.car.set.clone(),
            out,
        })
    }

    fn run(&self, mut plan: RigPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let bench = Bench::new(&plan.setup);
        let found = RigResults::run(&bench, &plan.conditions, &plan.points, plan.test);
        let failures = found.failures(&plan.conditions);
        let json = json_text(&plan.json(&found, &failures))?;
        let files = WrittenFiles::write(out, |dir| {
            dir.put("summary.json", &json)?;
            for (name, csv) in found.tables() {
                dir.put(name, csv)?;
            }
            for (name, svg) in plan.pictures(&found) {
                dir.put(&name, svg)?;
            }
            Ok("")
        })?;
        let results = Results::new(json, failures, files);
        Ok(results.output(&self.results.output, || {
            tables::tables(&plan, &found, terminal.stdout)
        }))
    }
}

impl RigTransmissionArgs {
    /// Merges the rig's test points with those of the options. None if the rig's conditions have problems.
    fn points(
        &self,
        conditions: Option<&Conditions>,
        problems: &mut Problems,
    ) -> Option<TestPoints> {
        let mut list = |option: &str, text: &Option<String>, range: Bound, suffix: &str| {
            let read = problems.take(values(option, text.as_ref()?, range, suffix))?;
            let si = read.into_iter().map(|x| to_si(suffix, x));
            Some(si.collect::<Vec<f64>>())
        };
        let speeds_rad_s = list("--speed", &self.speed, SPEED, "_rpm");
        let oil_k = list("--temp", &self.temp, OIL, "_degc");
        let torques_nm = list("--torque", &self.torque, TORQUE, "_nm");
        // `low` and `high` are defined by the conditions.
        let conditions = conditions?;
        let (low, high) = (conditions.low_ratio, conditions.high_ratio);
        let words = [("low", low), ("high", high)];
        let read =
            |text: &String| problems.take(values_or_words("--ratio", text, RATIO, "", &words));
        let ratios = self.ratio.as_ref().and_then(read);
        let own = TestPoints::from_conditions(conditions);
        Some(TestPoints {
            ratios: ratios.unwrap_or(own.ratios),
            speeds_rad_s,
            oil_k: oil_k.unwrap_or(own.oil_k),
            torques_nm: torques_nm.unwrap_or(own.torques_nm),
        })
    }
}

/// Reports ratios at which a belt of this length does not fit.
fn check_ratios(setup: &Setup, points: &TestPoints, problems: &mut Problems) {
    let Transmission::Cvt(cvt) = setup.transmission() else {
        return;
    };
    let (low, high) = solvable_ratios(&cvt.belt);
    let allowed = format!("{low} to {high} with this belt");
    let hint = "check the belt length and the centre distance, or choose other ratios with --ratio";
    for ratio in points
        .ratios
        .iter()
        .filter(|ratio| !(low..=high).contains(*ratio))
    {
        let message = format!("the belt does not fit around the pulleys at ratio {ratio}");
        let value = ratio.to_string();
        problems.add(bad_value("--ratio", &value, &allowed, &message, hint));
    }
}

impl RigPlan {
    fn json(&self, found: &RigResults, failures: &[String]) -> Value {
        let mut all = json!({
            "command": "rig transmission",
            "vehicle": self.setup.name,
            "lubricant": self.setup.oils().0.name,
            "formulation": self.formulation,
            "set": self.set,
        });
        if let Value::Object(entries) = &mut all {
            entries.extend(found.json(&self.points));
            entries.insert("failed_checks".to_owned(), json!(failures));
        }
        Manifest::new(SCHEMA).for_run(&all).with(&all)
    }

    fn pictures(&self, found: &RigResults) -> impl Iterator<Item = (String, String)> {
        let (vehicle, conditions) = (&self.setup.name, &self.conditions);
        let subject = Subject {
            vehicle,
            conditions,
        };
        let pictures = [
            plots::steady(&found.steady, &subject),
            plots::loaded(&found.loaded, &subject),
            plots::strip_down(&found.strip_down, &subject),
            plots::transients(&found.loops, &subject),
            plots::second_box(&found.second_box, &subject),
        ];
        pictures.into_iter().flatten()
    }
}
