//! Calibrations: known parameters are recovered within their intervals, unidentified ones are reported, and the shipped values are the results of the shipped
//! plans.

use std::collections::BTreeSet;

use cvtcycle::calibrate::model::Model;
use cvtcycle::calibrate::outcome::Outcome;
use cvtcycle::calibrate::plan::{CalibrationPlan, Measured, load, read};
use cvtcycle::calibrate::solve::Residuals;
use cvtcycle::calibrate::{calibrate, embedded_calibrations, fitted};
use cvtcycle::config::setup::{self, Options};
use cvtcycle::output::progress::NoProgress;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use statrs::distribution::{ContinuousCDF, Normal};

/// Plan with a data file in the same folder.
fn plan_with(folder: &tempfile::TempDir, data: &str, text: &str) -> CalibrationPlan {
    std::fs::write(folder.path().join("data.csv"), data).expect("written");
    let file = folder.path().join("plan.toml");
    read(&file.to_string_lossy(), text)
        .unwrap_or_else(|problems| panic!("{}", cvtcycle::config::render(&problems, false)))
}

/// Replaces the measurements by computed values at `truth`, with errors of the plan's standard deviations.
fn measure(plan: &mut CalibrationPlan, truth: &[f64], seed: u64) {
    let computed = Model::new(plan)
        .expect("a sound plan")
        .predict(truth)
        .expect("an answer")
        .computed;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let normal = Normal::standard();
    for (observation, computed) in plan.observations.iter_mut().zip(computed) {
        let u: f64 = random.random_range(1e-9..1.0 - 1e-9);
        observation.measured = Measured::Value(computed + observation.sd * normal.inverse_cdf(u));
    }
}

fn solved(plan: &CalibrationPlan) -> Outcome {
    calibrate(plan, &NoProgress)
        .unwrap_or_else(|problems| panic!("{}", cvtcycle::config::render(&problems, false)))
}

/// Spin loss at two ratios, three pressures, two temperatures, four speeds.
fn spin_points() -> String {
    let mut text = "ratio,speed_rpm,temp_degc,pressure_bar,total_nm\n".to_owned();
    for ratio in [2.0, 0.5] {
        for temp in [25, 75] {
            for (speed, bar) in [(1000, 10), (2000, 25), (3000, 35), (4000, 18)] {
                text += &format!("{ratio},{speed},{temp},{bar},0\n");
            }
        }
    }
    text
}

const SPIN_PLAN: &str = r#"
[calibration]
starts = 1
leave_out = false

[[parameter]]
key = "transmission.cvt.pump.displacement_cc_rev"
low = 3
high = 20

[[parameter]]
key = "transmission.cvt.input_shaft.constant_nm"
low = 0
high = 4

[[parameter]]
key = "transmission.cvt.final_drive.bearing_factor"
low = 0
high = 15

[[data]]
name = "spin loss"
from = "made by the program"
points = "data.csv"
sd = 0.1
"#;

/// Property: a number with `also` is one for the keys of both boxes: computed values at a truth give it back, and each fitted file has it at the key that its
/// box has.
#[test]
fn one_number_sets_the_keys_of_two_boxes() {
    const PLAN: &str = r#"
[calibration]
starts = 1
leave_out = false

[sources.manual]
source = "bench"
vehicle = "rover_216_5mt"
ratio = [3, 5]
speed_rpm = [1000, 3000]
temp_degc = [20, 80]

[[parameter]]
key = "transmission.cvt.final_drive.bearing_factor"
also = ["transmission.manual.gears.bearing_factor"]
vehicles = ["rover_216_cvt", "rover_216_5mt"]
low = 0
high = 15

[[data]]
name = "spin loss"
from = "made by the program"
points = "data.csv"
sd = 1e-6

[[data]]
name = "manual box"
from = "made by the program"
compute = "mean(manual: total_nm)"
unit = "Nm"
value = 1
sd = 1e-6
"#;
    let folder = tempfile::tempdir().expect("a folder");
    let mut plan = plan_with(&folder, &spin_points(), PLAN);
    let model = Model::new(&plan).expect("a sound plan");
    let at = |factor: f64| model.predict(&[factor]).expect("an answer").computed;
    let (low, high) = (at(5.0), at(6.3));
    assert!(low.iter().zip(&high).all(|(low, high)| low < high));
    measure(&mut plan, &[6.3], 1);
    let outcome = solved(&plan);
    assert_eq!(outcome.parameters.len(), 1);
    let fitted_to = outcome.parameters[0].value;
    assert!((fitted_to - 6.3).abs() < 1e-4, "{fitted_to}");
    let files = fitted::files(&plan, &outcome, "2024-02-29").expect("files");
    for (name, own, other) in [
        ("rover_216_cvt_fitted.toml", "cvt", "manual"),
        ("rover_216_5mt_fitted.toml", "manual", "cvt"),
    ] {
        let file = files.iter().find(|(file, _)| file == name);
        let (_, text) = file.unwrap_or_else(|| panic!("no {name}"));
        let document: toml::Table = text.parse().expect("TOML");
        let table = &document["transmission"];
        let part = match own {
            "cvt" => &table[own]["final_drive"],
            _ => &table[own]["gears"],
        };
        let value = part["bearing_factor"]["value"].as_float();
        assert!(
            (value.expect("a number") - fitted_to).abs() < 1e-5,
            "{name}"
        );
        assert!(table.get(other).is_none(), "{name} has a table of {other}");
    }
}

/// Property: intervals of 1 and 1.96 standard errors contain the truth as often as they should, for each parameter. Limits of 3.3 standard
/// deviations of the binomial: one false alarm in some 170 sets of six numbers; the seeds are fixed.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    const SEEDS: u64 = 160;
    let folder = tempfile::tempdir().expect("a folder");
    let mut plan = plan_with(&folder, &spin_points(), SPIN_PLAN);
    let truth = [8.2, 1.15, 6.3];
    let mut inside = [[0_u32; 2]; 3];
    for seed in 0..SEEDS {
        measure(&mut plan, &truth, seed);
        let outcome = solved(&plan);
        assert!(outcome.converged, "seed {seed}: {:?}", outcome.warnings);
        for (k, p) in outcome.parameters.iter().enumerate() {
            let off = (p.value - truth[k]).abs() / p.standard_error.expect("a standard error");
            inside[k][0] += u32::from(off < 1.0);
            inside[k][1] += u32::from(off < 1.96);
        }
    }
    for (k, counts) in inside.iter().enumerate() {
        for (count, share) in counts.iter().zip([0.6827, 0.95]) {
            let n = SEEDS as f64;
            let wide = 3.3 * (n * share * (1.0 - share)).sqrt();
            assert!(
                (f64::from(*count) - n * share).abs() < wide,
                "parameter {k}: {count} of {SEEDS} where {share} was promised"
            );
        }
    }
}

/// Property: without noise the exact parameters are found from any start.
#[test]
fn truth_without_noise_is_found_from_every_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut plan = plan_with(&folder, &spin_points(), SPIN_PLAN);
    plan.search.starts = 5;
    let truth = [12.0, 2.0, 0.9];
    let computed = Model::new(&plan)
        .expect("sound")
        .predict(&truth)
        .expect("an answer")
        .computed;
    plan.observations
        .iter_mut()
        .zip(computed)
        .for_each(|(o, x)| o.measured = Measured::Value(x));
    let outcome = solved(&plan);
    for (p, truth) in outcome.parameters.iter().zip(truth) {
        assert!(
            (p.value / truth - 1.0).abs() < 1e-5,
            "{}: {} in place of {truth}",
            p.name,
            p.value
        );
    }
    assert!(
        outcome
            .starts
            .iter()
            .all(|start| start.cost.is_some_and(|cost| cost < 1e-6)),
        "{:?}",
        outcome.starts
    );
}

/// A warm-up trace and two totals of the same run.
#[test]
fn a_warm_up_trace_identifies_the_heat_capacity() {
    let folder = tempfile::tempdir().expect("a folder");
    let rows: String = (1..=39).map(|k| format!("{},0\n", 30 * k)).collect();
    std::fs::write(
        folder.path().join("scalars.csv"),
        "quantity,value,sd,phase\nend_sump_degc,0,0.5,\nfuel_l_per_100km,0,0.05,ece15\n",
    )
    .expect("written");
    let text = r#"
[calibration]
starts = 1

[sources.cold]
source = "run"
ambient_degc = -10

[[parameter]]
key = "thermal.transmission.metal_kj_k"
low = 8
high = 60

[[parameter]]
key = "thermal.transmission.case_air_w_k"
low = 1
high = 60

[[data]]
name = "trace"
from = "made by the program"
trace = "data.csv"
source = "cold"
sd_by_column = { transmission_sump_degc = 0.3 }

[[data]]
name = "totals"
from = "made by the program"
scalars = "scalars.csv"
source = "cold"
"#;
    let mut plan = plan_with(
        &folder,
        &format!("time_s,transmission_sump_degc\n{rows}"),
        text,
    );
    assert_eq!(plan.observations.len(), 41);
    // Values are independent every 30 s: 39 values over 1140 s count as 39.
    assert!((plan.observations[0].weight_sd / 0.3 - 1.0).abs() < 1e-12);
    let truth = [30.0, 16.0];
    let mut misses = Vec::new();
    for seed in 0..6 {
        measure(&mut plan, &truth, seed);
        let outcome = solved(&plan);
        assert!(outcome.converged);
        for (p, truth) in outcome.parameters.iter().zip(truth) {
            misses.push((p.value - truth) / p.standard_error.expect("a standard error"));
        }
        let fold = outcome
            .folds
            .iter()
            .find(|fold| fold.name == "totals")
            .expect("a fold");
        assert!(fold.predicted_rms_sd.expect("predicted") < 4.0, "{fold:?}");
    }
    // Twelve deviations, independent in pairs: their root mean square is 1 within 3 standard deviations of 1/sqrt(24).
    let rms = (misses.iter().map(|x| x * x).sum::<f64>() / misses.len() as f64).sqrt();
    assert!((0.4..1.65).contains(&rms), "{misses:?}");
}

/// Sampling four times as densely in time does not add four times the information (CM-2).
#[test]
fn a_denser_trace_adds_no_information() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "[calibration]\n[sources.cold]\nsource = \"run\"\n[[parameter]]\nkey = \"thermal.transmission.metal_kj_k\"\nlow = 8\nhigh = 60\n\
                [[data]]\nfrom = \"made up\"\ntrace = \"data.csv\"\nsource = \"cold\"\nsd = 0.3\n";
    let weight = |step: u32| {
        let rows: String = (0..=1160 / step)
            .map(|k| format!("{},20\n", step * k))
            .collect();
        let plan = plan_with(
            &folder,
            &format!("time_s,transmission_sump_degc\n{rows}"),
            text,
        );
        plan.observations
            .iter()
            .map(|o| o.weight_sd.powi(-2))
            .sum::<f64>()
    };
    let (sparse, dense) = (weight(40), weight(5));
    assert!((dense / sparse - 1.0).abs() < 0.4, "{sparse} and {dense}");
}

/// Independent truth: pump torque is displacement times pressure (PU-1). At one speed, with the clamp law's pressure and without other effects of
/// pressure, only their product is identified.
#[test]
fn pump_displacement_and_pressure_are_identified_as_a_product() {
    let folder = tempfile::tempdir().expect("a folder");
    let data: String = [2.4, 2.0, 1.6, 1.2]
        .iter()
        .map(|ratio| format!("{ratio},3000,80,0\n"))
        .collect();
    let text = r#"
[calibration]
starts = 1
set = ["transmission.cvt.pump.viscous_coefficient=0", "transmission.cvt.pressure.cap_bar=200"]

[[parameter]]
key = "transmission.cvt.pump.displacement_cc_rev"
low = 3
high = 20

[[parameter]]
key = "transmission.cvt.clamp.map.base_bar"
low = 10
high = 60

[[data]]
from = "made by the program"
points = "data.csv"
sd = 0.05
without = ["belt", "final_drive", "reverse_clutch"]
"#;
    let mut plan = plan_with(
        &folder,
        &format!("ratio,speed_rpm,temp_degc,pump_nm\n{data}"),
        text,
    );
    measure(&mut plan, &[9.0, 36.5], 1);
    let outcome = solved(&plan);
    let said = outcome.not_identified.join(" ");
    assert!(
        said.contains("displacement_cc_rev")
            && said.contains("base_bar")
            && said.contains("product"),
        "{said}"
    );
    let product: f64 = outcome.parameters.iter().map(|p| p.value).product();
    assert!((product / (9.0 * 36.5) - 1.0).abs() < 0.05, "{product}");
}

/// A parameter without effect is named, and the fit fails.
#[test]
fn a_parameter_without_effect_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SPIN_PLAN.to_owned()
        + "\n[[parameter]]\nkey = \"thermal.engine.block_kj_k\"\nlow = 10\nhigh = 60\n";
    let mut plan = plan_with(&folder, &spin_points(), &text);
    measure(&mut plan, &[9.0, 1.0, 0.3, 28.0], 3);
    let outcome = solved(&plan);
    assert!(outcome.parameters[3].is_dead && outcome.parameters[3].standard_error.is_none());
    assert!(
        outcome
            .warnings
            .iter()
            .any(|w| w.contains("block_kj_k moves no datum")),
        "{:?}",
        outcome.warnings
    );
}

/// Property: an error common to all data is estimated as such, and widens the intervals that depend on the level.
#[test]
fn a_common_error_is_separated() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SPIN_PLAN.replace("sd = 0.1", "sd = 0.1\ncommon_sd = 0.5");
    let mut plain = plan_with(&folder, &spin_points(), SPIN_PLAN);
    let mut plan = plan_with(&folder, &spin_points(), &text);
    measure(&mut plain, &[9.0, 1.0, 0.3], 5);
    measure(&mut plan, &[9.0, 1.0, 0.3, 0.0], 5);
    let (narrow, wide) = (solved(&plain), solved(&plan));
    assert_eq!(wide.parameters.len(), 4);
    let error = |outcome: &Outcome, k: usize| outcome.parameters[k].standard_error.expect("known");
    // The constant of the input shaft is the level of all data, so its error includes the common one.
    assert!(
        error(&wide, 1) > 0.45 && error(&narrow, 1) < 0.2,
        "{} {}",
        error(&narrow, 1),
        error(&wide, 1)
    );
    assert!((error(&wide, 0) / error(&narrow, 0) - 1.0).abs() < 0.2);
}

/// The fitted files reproduce the numbers of the outcome.
#[test]
fn fitted_files_hold_what_was_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = SPIN_PLAN.to_owned()
        + "\n[[parameter]]\nkey = \"lubricant.friction.band\"\nlow = 0.1\nhigh = 0.15\nprior = { mean = 0.13, sd = 0.005 }\nstatus = \"assumed\"\n";
    let mut plan = plan_with(&folder, &spin_points(), &text);
    measure(&mut plan, &[8.0, 1.2, 0.4, 0.127], 8);
    let outcome = solved(&plan);
    let files = fitted::files(&plan, &outcome, "2026-01-31").expect("written");
    assert_eq!(
        files
            .iter()
            .map(|(name, _)| name.as_str())
            .collect::<Vec<_>>(),
        ["rover_216_cvt_fitted.toml", "cvtf_ezl799_class_fitted.toml"]
    );
    for (name, text) in &files {
        std::fs::write(folder.path().join(name), text).expect("written");
    }
    let path = folder.path().join("rover_216_cvt_fitted.toml");
    let car = setup::load(&path.to_string_lossy(), &Options::default())
        .unwrap_or_else(|problems| panic!("{}", cvtcycle::config::render(&problems, false)));
    let info = |key: &str| car.keys.iter().find(|info| info.key == key).expect("a key");
    for p in &outcome.parameters {
        let found = info(&p.name);
        let value: f64 = found.value.parse().expect("a number");
        assert!(
            (value / p.value - 1.0).abs() < 1e-6,
            "{}: {value} in place of {}",
            p.name,
            p.value
        );
        assert_eq!(found.status, "fitted");
        assert!(
            found
                .source
                .contains("plan.toml on 2026-01-31; standard error"),
            "{}",
            found.source
        );
    }
    let mut again = plan;
    again.car.vehicle = path.to_string_lossy().into_owned();
    let model = Model::new(&again).expect("sound");
    let cost: f64 = model
        .at(&model.file_values())
        .expect("an answer")
        .iter()
        .map(|r| r * r)
        .sum();
    assert!(
        (cost / outcome.chi2 - 1.0).abs() < 1e-4,
        "{cost} in place of {}",
        outcome.chi2
    );
}

/// Every fitted value of the Rover and its fluid is the result of a shipped plan, to a quarter of its standard error. The files have rounded values, and
/// statements printed as orders of magnitude make a flat valley with kinked walls: starts end within a per cent of the minimum sum of squares. Each plan fixes the parameters of the others at the shipped values.
#[test]
fn shipped_plans_give_the_shipped_values() {
    let mut free = BTreeSet::new();
    for (name, _) in embedded_calibrations() {
        let mut plan = load(name)
            .unwrap_or_else(|problems| panic!("{}", cvtcycle::config::render(&problems, false)));
        plan.leave_out = false;
        let outcome = solved(&plan);
        assert!(outcome.converged, "{name}: {:?}", outcome.warnings);
        for p in outcome.parameters.iter().filter(|p| p.is_key) {
            let Some(error) = p.standard_error else {
                // At a bound, which the file has too.
                let is_at = (p.value - p.file_value).abs() <= 1e-9 * p.high;
                assert!(p.at_bound.is_some() && is_at, "{name}: {}", p.name);
                continue;
            };
            assert!(
                (p.value - p.file_value).abs() < 0.25 * error,
                "{name}: {} is {} in the file, {} +- {error} fitted",
                p.name,
                p.file_value,
                p.value
            );
            if !p.name.contains(" of ") {
                free.insert(p.name.clone());
            }
        }
    }
    let car = setup::load("rover_216_cvt", &Options::default()).expect("the shipped car");
    let fitted: BTreeSet<String> = car
        .keys
        .iter()
        .filter(|k| k.status == "fitted" && !k.key.starts_with("engine_oil."))
        .map(|k| k.key.clone())
        .collect();
    assert_eq!(
        fitted, free,
        "fitted values of the file, and keys that the plans free"
    );
}

/// A row used by a shipped plan names the parameters fitted to it, and only keys that are free in a plan or have a source.
#[test]
fn rows_and_plans_agree_on_what_was_fitted() {
    let texts: Vec<(String, String)> = cvtcycle::validate::embedded_rows()
        .iter()
        .map(|(n, t)| ((*n).to_owned(), (*t).to_owned()))
        .collect();
    let files =
        cvtcycle::validate::read(cvtcycle::validate::COMMON, &texts).expect("the shipped rows");
    for (name, _) in embedded_calibrations() {
        let plan = load(name).expect("a shipped plan");
        for id in &plan.rows {
            let row = files
                .iter()
                .flat_map(|file| &file.rows)
                .find(|row| row.id == *id)
                .expect("a row");
            assert!(
                !row.fitted_to.is_empty(),
                "{name} uses row {id}, which says that nothing was fitted to it"
            );
            assert!(
                row.fitted_to
                    .iter()
                    .any(|key| plan.parameters.iter().any(|free| free.key == *key)),
                "{name}: row {id}"
            );
        }
    }
}
