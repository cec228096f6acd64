//! No input is dead: a changed value of any key changes some output of some run, or the reason is listed here.
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use crate::common::{CARS, ZERO, at, car, cycle, hill, larger, try_car};
use cvtcycle_config::KeyInfo;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Conditions, Row, Start, drive};

/// Everything that a run shows, as numbers: sums, end temperatures, means of the trace.
fn outputs(setup: &Setup, cycle: &Cycle, start_degc: f64) -> Vec<f64> {
    let o = drive(
        setup,
        cycle,
        &Conditions {
            keep_rows: true,
            ..at(start_degc, Start::Soak)
        },
    );
    let t = o.totals.total();
    let engine = setup.car(ZERO).engine;
    let mut out = vec![
        t.fuel_kg,
        t.fuel_kg / engine.fuel_density_kg_m3,
        t.fuel_kg * engine.co2_kg_kg,
        t.wheel_positive_j,
        t.wheel_negative_j,
        o.totals.min_clamp_safety,
    ];
    out.extend(t.loss_j);
    out.extend(t.terms.as_array());
    out.extend(o.end.node_k);
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    let sum = |f: fn(&Row) -> f64| o.rows.iter().map(|r| finite(f(r)) * r.dt_s).sum::<f64>();
    out.extend([
        sum(|r| r.engine_speed_rad_s),
        sum(|r| r.engine_torque_nm),
        sum(|r| r.throttle),
        sum(|r| r.belt_ratio),
        sum(|r| r.primary_pressure_pa),
        sum(|r| r.secondary_pressure_pa),
        sum(|r| r.slip),
        sum(|r| f64::from(r.gear)),
        sum(|r| r.coolant_k),
        sum(|r| r.cooler_in_k),
        sum(|r| r.cooler_out_k),
    ]);
    out
}

/// Largest relative difference between two lists of outputs.
fn moved(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).fold(0.0, |most, (x, y)| {
        let scale = x.abs() + y.abs();
        let d = if scale > 0.0 {
            (x - y).abs() / scale
        } else {
            0.0
        };
        if x.is_finite() && y.is_finite() {
            larger(d, most)
        } else {
            most
        }
    })
}

/// Assignments that move a key a little, the likelier first; empty for what is no number, switch or list of numbers.
fn moves(info: &KeyInfo) -> Vec<String> {
    let v = info.value.trim();
    let set = |value: String| format!("{}={value}", info.key);
    if v == "true" || v == "false" {
        return vec![set((v != "true").to_string())];
    }
    if let Ok(x) = v.parse::<f64>() {
        if info.allowed.contains("whole")
            || info.allowed.contains("integer")
            || info.key.ends_with("band_count")
        {
            return vec![
                set(format!("{}", x as i64 + 1)),
                set(format!("{}", x as i64 - 1)),
            ];
        }
        if x == 0.0 {
            return [0.05, 0.5, 5.0, 50.0, 1.0]
                .iter()
                .map(|d| set(format!("{d:?}")))
                .collect();
        }
        return [1.03, 0.97, 1.005, 0.995]
            .iter()
            .map(|f| set(format!("{:?}", x * f)))
            .collect();
    }
    if v.starts_with("[[") {
        // Rows: move the last column.
        let rows: Vec<Vec<f64>> = serde_json::from_str(v).unwrap_or_default();
        return [1.03, 0.97]
            .iter()
            .map(|f| {
                set(format!(
                    "{:?}",
                    rows.iter()
                        .map(|r| {
                            let (last, before) = r.split_last().unwrap();
                            [before, &[last * f]].concat()
                        })
                        .collect::<Vec<_>>()
                ))
            })
            .collect();
    }
    if v.starts_with('[') {
        let list: Vec<f64> = serde_json::from_str(v).unwrap_or_default();
        let mut sets = Vec::new();
        for f in [1.03, 0.97] {
            for k in 0..list.len() {
                let mut moved = list.clone();
                moved[k] *= f;
                sets.push(set(format!("{moved:?}")));
            }
        }
        return sets;
    }
    Vec::new()
}

/// Keys that need another key before they can matter: (end of the key, what is set with it, why).
const NEEDS: [(&str, &[&str], &str); 39] = [
    (
        "pulley_bearing.secondary_nm_per_rpm",
        &["transmission.cvt.pulley_bearing.secondary_nm_per_rpm=0.0005"],
        "0 without a value, and its range is smaller than the smallest move from 0",
    ),
    (
        "driveline_f2_n_per_kmh2",
        &["road_load.form.coefficients.driveline_f2_n_per_kmh2=0.001"],
        "a part of f2, which is smaller than the smallest move from 0",
    ),
    (
        "reverse_clutch.oil_share",
        &["transmission.cvt.reverse_clutch.peak_rpm=4000"],
        "rupture of the film, only with a speed of largest drag",
    ),
    (
        "variator.piston_outer_mm",
        &["transmission.cvt.variator.compensated=false"],
        "centrifugal head, only where it is not balanced",
    ),
    (
        "variator.piston_inner_mm",
        &["transmission.cvt.variator.compensated=false"],
        "centrifugal head, only where it is not balanced",
    ),
    (
        "road_load.rolling_per_k",
        &[
            "road_load.surface=road",
            "road_load.tyre.rolling_coefficient=0",
        ],
        "a dynamometer's coefficients are fixed",
    ),
    (
        "pump.residual_bar",
        &["transmission.cvt.pump.kind=variable"],
        "only where displacement can idle",
    ),
    (
        "engine.inertia_torque_nm",
        &["engine.inertia_torque_nm=10"],
        "bounds the torque of inertia; never reached at steps of 1 s",
    ),
    (
        "engine.fuel.start_s",
        &["engine.fuel.start_s=250"],
        "the same grams in another time: seen where a phase ends within it",
    ),
    (
        "engine.fuel.cut_above_rpm",
        &["engine.fuel.cut_above_rpm=1800"],
        "a belt's overrun is faster than the shipped speeds",
    ),
    (
        "engine.fuel.fuel_back_rpm",
        &[
            "engine.fuel.cut_above_rpm=1560",
            "engine.fuel.fuel_back_rpm=1530",
        ],
        "a belt's overrun is faster than the shipped speeds",
    ),
    (
        "ratio.down_per_s",
        &["transmission.cvt.ratio.down_per_s=0.4"],
        "the shipped rate suffices for the stops of these cycles",
    ),
    (
        "ratio.rate_speed_rpm",
        &["transmission.cvt.ratio.rate_speed_rpm=2500"],
        "the shipped rates are full from 1000 rpm",
    ),
    (
        "ratio.drive_line",
        &["transmission.cvt.ratio.drive_line=[[0,1400],[100,4000]]"],
        "the shipped cars have no line",
    ),
    (
        "ratio.overrun_line",
        &["transmission.cvt.ratio.overrun_line=[[0,1500],[120,2000]]"],
        "the shipped cars have no line",
    ),
    (
        "ratio.cold_from_degc",
        &["transmission.cvt.ratio.cold_rise_rpm=500"],
        "where the line of a cold car begins, only with one",
    ),
    (
        "ratio.cold_to_degc",
        &["transmission.cvt.ratio.cold_rise_rpm=500"],
        "where the line of a cold car ends, only with one",
    ),
    (
        "belt.slip_bound_percent",
        &[
            "transmission.cvt.clamp.map.base_bar=5",
            "transmission.cvt.clamp.map.throttle_bar=0",
            "transmission.cvt.pressure.control_bar=4",
        ],
        "bounds gross slip, which needs a clamp that is too weak",
    ),
    (
        "pressure.control_bar",
        &["transmission.cvt.clamp.map.base_bar=12"],
        "the Rover's map stays above its floor",
    ),
    (
        "pressure.clutch_return_bar",
        &[
            "transmission.cvt.clamp=torque_following",
            "transmission.cvt.pressure.clutch_bar_per_nm=0.3",
        ],
        "a map was measured with its causes in it",
    ),
    (
        "pressure.clutch_bar_per_nm",
        &[
            "transmission.cvt.clamp=torque_following",
            "transmission.cvt.pressure.clutch_bar_per_nm=0.3",
        ],
        "as the clutch's spring",
    ),
    (
        "pressure.strand_n",
        &[
            "transmission.cvt.clamp=torque_following",
            "transmission.cvt.pressure.strand_n=2000",
        ],
        "as the clutch's spring",
    ),
    (
        "pressure.creep_per_rad",
        &[
            "transmission.cvt.clamp=torque_following",
            "transmission.cvt.pressure.control_bar=1",
        ],
        "as the clutch's spring",
    ),
    (
        "pump.lubrication_l_min",
        &["transmission.cvt.pump.kind=variable"],
        "a fixed pump gives all its flow: shifts are limited only near idle",
    ),
    (
        "pump.inlet_depression_bar",
        &["transmission.cvt.pump.inlet_bar_per_l_min=0.004"],
        "bounds the flow of oil thicker than in these runs; a fixed pump needs little of its flow",
    ),
    (
        "pump.inlet_bar_per_l_min",
        &["transmission.cvt.pump.inlet_bar_per_l_min=0.004"],
        "bounds the flow of oil thicker than in these runs; a fixed pump needs little of its flow",
    ),
    (
        "pump.leakage_l_min_per_bar",
        &["transmission.cvt.pump.kind=variable"],
        "as the lubrication flow",
    ),
    (
        "friction.bands.spread",
        &[
            "lubricant.friction.bands.spread=0.2",
            "lubricant.friction.bands.place=1",
        ],
        "width of what is known, in whose middle a friction is",
    ),
    (
        "friction.bands.place",
        &["lubricant.friction.bands.spread=0.2"],
        "place within what is known, which is all for the reference fluid",
    ),
    (
        "friction.micro_slip.spread",
        &[
            "lubricant.friction.micro_slip.spread=0.2",
            "lubricant.friction.micro_slip.place=1",
        ],
        "width of what is known, in whose middle a friction is",
    ),
    (
        "friction.micro_slip.place",
        &["lubricant.friction.micro_slip.spread=0.2"],
        "place within what is known, which is all for the reference fluid",
    ),
    (
        "friction.macro_slip.spread",
        &[
            "lubricant.friction.macro_slip.spread=0.2",
            "lubricant.friction.macro_slip.place=1",
        ],
        "width of what is known, in whose middle a friction is",
    ),
    (
        "friction.macro_slip.place",
        &["lubricant.friction.macro_slip.spread=0.2"],
        "place within what is known, which is all for the reference fluid",
    ),
    (
        "friction.gears.spread",
        &[
            "lubricant.friction.gears.spread=0.2",
            "lubricant.friction.gears.place=1",
        ],
        "width of what is known, in whose middle a friction is",
    ),
    (
        "friction.gears.place",
        &["lubricant.friction.gears.spread=0.2"],
        "place within what is known, which is all for the reference fluid",
    ),
    (
        "engine.highest_rpm",
        &["engine.highest_rpm=3000"],
        "bounds engine speed; the cycles stay below it",
    ),
    (
        "transmission.exchanger_opens_degc",
        &["thermal.transmission.exchanger_w_k=150"],
        "the shipped cars have no exchanger",
    ),
    (
        "cooler.bypass_below_degc",
        &["thermal.cooler.bypass_below_degc=20"],
        "the shipped cooler is always open",
    ),
    (
        "cooler.highest_l_min",
        &["thermal.cooler.highest_l_min=5"],
        "bounds the flow at speed",
    ),
];

/// Keys that name things or have no physics: (end of the key, why).
const WORDS: [(&str, &str); 8] = [
    ("vehicle.title", "a name for people"),
    ("vehicle.short", "a name in tables"),
    ("vehicle.baselines", "names"),
    (
        "vehicle.transmission_oil",
        "a name; the fluids' own keys are tested",
    ),
    (
        "vehicle.engine_oil",
        "a name; the fluids' own keys are tested",
    ),
    ("title", "a name for people"),
    ("road_load.form", "which table; its keys are tested"),
    ("transmission", "which table; its keys are tested"),
];

/// Relative change that counts as an effect; the rest of the implicit solve stays below it.
const MOVED: f64 = 1e-6;

struct Scenario {
    cycle: Cycle,
    ambient: f64,
}

fn scenarios() -> Vec<Scenario> {
    let s = |cycle: Cycle, ambient: f64| Scenario { cycle, ambient };
    vec![
        s(cycle("ece15_eudc"), -10.0),
        s(cycle("us06"), 0.0),
        s(hill(), 25.0),
        s(cycle("ftp75"), 25.0),
        s(cycle("constant_120"), 40.0),
    ]
}

/// Reason why a key is without effect in this car, if it is.
fn no_effect(name: &str, key: &str) -> Option<&'static str> {
    let fluid = key.strip_prefix("engine_oil.").is_some();
    if key.contains(".friction.")
        || key.starts_with("lubricant.friction")
        || key.starts_with("engine_oil.friction")
    {
        if fluid {
            return Some("friction of belt contacts means nothing in an engine");
        }
        if key.ends_with("pressure_mpa") || key.ends_with("slip_percent") {
            return Some("where a table is read, and no shipped fluid has one");
        }
        if key.starts_with("lubricant.")
            && !name.ends_with("cvt")
            && !key.contains("friction.gears.")
        {
            return Some("friction of belt contacts means nothing in a manual box");
        }
    }
    if key == "transmission.cvt.belt.segment_thickness_mm" {
        return Some(
            "with a real-valued count of segments the pitch cancels (SL-4): active arc = C_x / (force per length)",
        );
    }
    if key.starts_with("thermal.cooler.")
        && key != "thermal.cooler.fitted"
        && !name.ends_with("cvt")
    {
        return Some("no cooler is fitted to the manual boxes");
    }
    if key == "engine.rated_kw" && !name.ends_with("cvt") {
        return Some("the ratio controller's measure of power; a manual box has none");
    }
    if key == "engine_oil.density15_kg_m3" {
        return Some("the engine's oil heat capacity is given, its viscosity is kinematic");
    }
    None
}

/// Property: no number of a shipped file is dead. Each, moved by a few per cent, moves an output in some run.
#[test]
fn no_input_is_dead() {
    let runs = scenarios();
    let mut dead = Vec::new();
    let mut smallest = (f64::INFINITY, String::new());
    for name in CARS {
        let plain = car(name, &[]);
        let mut seen = 0;
        for info in &plain.keys {
            if WORDS
                .iter()
                .any(|(key, _)| info.key == *key || (info.key.ends_with(".title")))
            {
                continue;
            }
            let needs = NEEDS
                .iter()
                .find(|(end, _, _)| info.key.ends_with(end))
                .map_or(&[][..], |n| n.1);
            let with: Vec<String> = needs
                .iter()
                .filter(|n| !n.starts_with(&format!("{}=", info.key)))
                .map(|n| (*n).to_owned())
                .collect();
            let own: Option<&&str> = needs
                .iter()
                .find(|n| n.starts_with(&format!("{}=", info.key)));
            let mut start: Vec<String> = with.clone();
            start.extend(own.map(|o| (*o).to_owned()));
            let base = match try_car(name, &start) {
                Ok(base) => base,
                Err(e) => {
                    dead.push(format!("{name} {}: base {start:?} refused: {e}", info.key));
                    continue;
                }
            };
            let own_value = base
                .keys
                .iter()
                .find(|k| k.key == info.key)
                .cloned()
                .unwrap_or_else(|| info.clone());
            let candidates = moves(&own_value);
            if candidates.is_empty() {
                println!("not moved: {name} {} = {:?}", info.key, info.value);
                continue;
            }
            seen += 1;
            let mut best = 0.0;
            let mut accepted = 0;
            let mut refused = String::new();
            'search: for candidate in &candidates {
                let mut sets = with.clone();
                sets.push(candidate.clone());
                let other = match try_car(name, &sets) {
                    Ok(other) => other,
                    Err(problems) => {
                        refused = problems;
                        continue;
                    }
                };
                accepted += 1;
                for run in &runs {
                    let d = moved(
                        &outputs(&base, &run.cycle, run.ambient),
                        &outputs(&other, &run.cycle, run.ambient),
                    );
                    best = larger(d, best);
                    if best > MOVED {
                        break 'search;
                    }
                }
            }
            if best < smallest.0 && best > MOVED {
                smallest = (best, format!("{name} {}", info.key));
            }
            match no_effect(name, &info.key) {
                Some(_) if best <= MOVED => {}
                Some(why) => dead.push(format!(
                    "{name} {}: expected no effect ({why}), but it moves outputs by {best:e}",
                    info.key
                )),
                None if best <= MOVED => dead.push(format!(
                    "{name} {} = {}: {accepted} of {} moves accepted, no output moves{}",
                    info.key,
                    info.value,
                    candidates.len(),
                    if accepted > 0 { "" } else { &refused }
                )),
                None => {}
            }
        }
        println!("{name}: {seen} keys of {} moved", plain.keys.len());
    }
    println!("least effect: {smallest:?}");
    assert!(dead.is_empty(), "{} dead:\n{}", dead.len(), dead.join("\n"));
}
