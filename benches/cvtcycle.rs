//! Times of the parts and of whole runs: `cargo bench`.
//!
//! Steps and cycles are those of shipped cars after a soak at -10 degC; `history` and `runs_per_second<true>` keep every row.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark has no interface"
)]

use std::collections::BTreeSet;

use cvtcycle::analysis::attribute::{Attribution, Depth, Pairs, attribute};
use cvtcycle::analysis::levers::{Combine, LeverFile, LeverRequest, prepare};
use cvtcycle::analysis::optimum::{self, Clamp, Limits, Task};
use cvtcycle::config::cycle::{Cycle, embedded, read_csv};
use cvtcycle::config::setup::{Options, ParamSet, Setup, load};
use cvtcycle::config::{Override, Problem, render};
use cvtcycle::model::drive::{Car, Recorder, State, simulate};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::model::lubricant::BandFriction;
use cvtcycle::model::road::WheelDemand;
use cvtcycle::model::thermal::{Heat, HeatInput};
use cvtcycle::model::transmission::cvt::variator::{
    Belt, BeltAtRatio, BeltLoad, Formulation, belt_point, belt_state,
};
use cvtcycle::model::transmission::{StepInput, Transmission, TransmissionState};
use cvtcycle::output::progress::NoProgress;
use cvtcycle::output::summary::{Driven, Settings, run_summary};
use cvtcycle::output::{EnergyTerms, Row};
use cvtcycle::study::plan::Plan;
use cvtcycle::study::store::Rows;
use cvtcycle::study::{PartWriter, Study};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};

const CARS: [&str; 3] = ["rover_216_cvt", "rover_216_5mt", "mondeo_20_5mt"];
const COLD_K: f64 = 263.15;

fn main() {
    divan::main();
}

fn setup(name: &str) -> Setup {
    load(name, &Options::default())
        .unwrap_or_else(|problems| panic!("{}", render(&problems, false)))
}

fn cycle(name: &str) -> Cycle {
    embedded(name).unwrap()
}

fn belt(car: &Car) -> &Belt {
    match &car.transmission {
        Transmission::Cvt(cvt) => &cvt.belt,
        Transmission::Manual(_) => unreachable!("a CVT"),
    }
}

fn load_at(torque_nm: f64) -> BeltLoad {
    BeltLoad {
        primary_speed_rad_s: 200.0,
        output_torque_nm: torque_nm,
        secondary_clamp_n: 20e5 * 0.009_719 + 750.0,
        band: BandFriction {
            film_share: [0.1, 0.01],
            ..BandFriction::dry(0.12)
        },
        film_n: [20.0, 1.0],
        segment_friction: 0.125,
        capacity_friction: 0.09,
        flank_friction: 0.13,
    }
}

/// Evaluates the belt once at a prepared ratio: away from the change of loading branch, and at it.
#[divan::bench(args = [40.0, 3.0, -30.0])]
fn belt_evaluation(bencher: Bencher, torque_nm: f64) {
    let car = setup("rover_216_cvt").car(COLD_K);
    let at = BeltAtRatio::new(belt(&car), 0.7);
    let load = load_at(torque_nm);
    bencher.bench_local(|| belt_state(black_box(belt(&car)), black_box(&at), black_box(&load)));
}

/// Computes belt points with their geometry, as `belt` does, in each formulation: points a second.
#[divan::bench(args = ["smooth", "appendix_c", "chapter_8"])]
fn belt_points(bencher: Bencher, name: &str) {
    let formulation = Formulation::NAMES
        .iter()
        .find(|(known, _)| *known == name)
        .unwrap()
        .1;
    let car = setup("rover_216_cvt").car(COLD_K);
    let belt = Belt {
        formulation,
        ..belt(&car).clone()
    };
    let points: Vec<(f64, BeltLoad)> = (0..100)
        .map(|k| (0.425 + 0.02 * f64::from(k), load_at(-20.0 + f64::from(k))))
        .collect();
    bencher
        .counter(ItemsCount::new(points.len()))
        .bench_local(|| {
            for (ratio, load) in &points {
                black_box(belt_point(&belt, &BeltAtRatio::new(&belt, *ratio), load));
            }
        });
}

#[divan::bench(args = [0.4137, 1.0, 2.4])]
fn belt_geometry(bencher: Bencher, ratio: f64) {
    let car = setup("rover_216_cvt").car(COLD_K);
    bencher.bench_local(|| BeltAtRatio::new(black_box(belt(&car)), black_box(ratio)));
}

/// Solves a driveline implicitly once at 60 km/h, away from its last answer.
#[divan::bench(args = CARS)]
fn driveline_step(bencher: Bencher, name: &str) {
    let car = setup(name).car(COLD_K);
    let heat = Heat::uniform(300.0);
    let engine = car.engine.at(300.0, 300.0, &car.engine_oil, 1.0);
    let demand = |power_w: f64| WheelDemand {
        speed_m_s: 16.7,
        wheel_rad_s: 59.0,
        power_w,
        ..WheelDemand::default()
    };
    let wheels = [demand(6000.0), demand(7000.0)];
    let around = |k: usize| StepInput {
        wheel: &wheels[k],
        engine: &engine,
        oil: &car.oil,
        heat: &heat,
        gear: None,
        dt_s: 1.0,
        engine_off: false,
        neutral_share: 0.0,
        kinetic_j: 0.5 * car.engine.inertia_kg_m2 * 200.0 * 200.0,
    };
    let mut state: TransmissionState = car.transmission.start(&around(0));
    let mut k = 0;
    bencher.bench_local(|| {
        k = 1 - k;
        car.transmission.solve(black_box(&around(k)), &mut state)
    });
}

#[divan::bench]
fn thermal_advance(bencher: Bencher) {
    let car = setup("rover_216_cvt").car(COLD_K);
    let heat = Heat::uniform(320.0);
    let input = HeatInput {
        power_w: [3e3, 5e2, 5e2, 3e2, 7e2],
        ambient_k: COLD_K,
        speed_m_s: 15.0,
        pump_rad_s: 200.0,
        oil_flow_m3_s: 3e-4,
        oil_volume_heat_j_m3k: 1.7e6,
        dt_s: 1.0,
        running: true,
    };
    bencher.bench_local(|| car.network.advance(black_box(&heat), black_box(&input)));
}

struct NullRecorder;

impl Recorder for NullRecorder {
    fn record(&mut self, row: &Row, _: &EnergyTerms) {
        black_box(row.fuel_kg_s);
    }
}

/// Drives whole cycles without totals: time a step.
#[divan::bench(args = CARS)]
fn step_of_a_cycle(bencher: Bencher, name: &str) {
    let car = setup(name).car(COLD_K);
    let cycle = cycle("ece15_eudc");
    let trace = cycle.trace_for(car.transmission.is_cvt());
    bencher
        .counter(ItemsCount::new(trace.step_count(1.0)))
        .bench_local(|| simulate(&car, trace, 1.0, State::at(COLD_K), &mut NullRecorder));
}

fn drive_cycle(bencher: Bencher, name: &str, cycle_name: &str, keep_rows: bool) {
    let setup = setup(name);
    let cycle = cycle(cycle_name);
    let conditions = Conditions {
        ambient_k: COLD_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows,
    };
    let steps = cycle
        .trace_for(setup.transmission().is_cvt())
        .step_count(1.0);
    bencher
        .counter(ItemsCount::new(steps))
        .bench_local(|| drive(&setup, black_box(&cycle), &conditions));
}

#[divan::bench(args = CARS)]
fn cycle_without_history(bencher: Bencher, name: &str) {
    drive_cycle(bencher, name, "ece15_eudc", false);
}

#[divan::bench(args = CARS)]
fn cycle_with_history(bencher: Bencher, name: &str) {
    drive_cycle(bencher, name, "ece15_eudc", true);
}

/// The CVT with each launch device, and with a converter that never locks.
#[divan::bench(args = ["friction_clutch.creep_nm=5", "torque_converter.capacity_nm=27", "torque_converter.lockup.enabled=false"])]
fn launch_device(bencher: Bencher, set: &str) {
    let launch = "transmission.cvt.launch";
    let sets = [
        format!(
            "{launch}.{}",
            set.replace("lockup.enabled=false", "capacity_nm=27")
        ),
        format!("{launch}.{set}"),
    ];
    let options = Options {
        set: Override::parse_all(&sets).unwrap_or_else(|p| panic!("{}", render(&p, false))),
        ..Options::default()
    };
    let setup = load("rover_216_cvt", &options).unwrap_or_else(|p| panic!("{}", render(&p, false)));
    let cycle = cycle("ece15_eudc");
    let conditions = Conditions {
        ambient_k: COLD_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    bencher.bench_local(|| drive(&setup, black_box(&cycle), &conditions));
}

/// Runs ECE15+EUDC, rebuilding the car for each run as in a study: runs a second on one core (target of studies: 3 000).
#[divan::bench(args = ["rover_216_cvt", "rover_216_5mt"], consts = [false, true])]
fn runs_per_second<const ROWS: bool>(bencher: Bencher, name: &str) {
    let (setup, cycle) = (setup(name), cycle("ece15_eudc"));
    let conditions = Conditions {
        ambient_k: COLD_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: ROWS,
    };
    bencher
        .counter(ItemsCount::new(1usize))
        .bench_local(|| drive(&setup, black_box(&cycle), &conditions));
}

/// Runs the main job with the price of each loss of the CVT: on all cores, the whole car first; with both orders of all pairs and shares of
/// groups too.
#[divan::bench(args = [false, true])]
fn prices_of_the_main_job(bencher: Bencher, pairs: bool) {
    let (setup, cycle) = (setup("rover_216_cvt"), cycle("ece15_eudc"));
    let conditions = Conditions {
        ambient_k: COLD_K,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: false,
    };
    let settings = Settings::default();
    let depth = Depth {
        alone: pairs,
        pairs: if pairs { Pairs::All } else { Pairs::None },
        shapley: pairs,
    };
    bencher.bench_local(|| {
        let outcome = drive(&setup, black_box(&cycle), &conditions);
        let driven = Driven {
            name: "rover_216_cvt",
            setup: &setup,
            outcome: &outcome,
        };
        let base = run_summary(&cycle, "subject", &settings, &driven);
        let of = Attribution {
            setup: &setup,
            cycle: &cycle,
            conditions,
            settings: &settings,
            factor: 0.0,
            depth,
        };
        attribute(&of, &base)
    });
}

/// Optimises the fuel of the CVT on ECE15+EUDC in steps of a quarter of a second, under its own clamp law and under a free one.
#[divan::bench(args = [false, true], sample_count = 3)]
fn least_fuel(bencher: Bencher, free: bool) {
    let (car, cycle) = (setup("rover_216_cvt").car(COLD_K), cycle("ece15_eudc"));
    let steps: Vec<_> = cycle.trace_for(true).steps(0.25).collect();
    let cvt = optimum::cvt(&car).unwrap();
    let task = Task {
        car: &car,
        cvt,
        steps: &steps,
        trace: cycle.trace_for(true),
        start: State::at(COLD_K),
        warm: false,
        clamp: match free {
            true => Clamp::Free {
                safety: 1.3,
                slip: 0.03,
            },
            false => Clamp::Law,
        },
        limits: Limits {
            least_rad_s: 1100.0 * std::f64::consts::PI / 30.0,
            reserve: 0.1,
            up_per_s: cvt.ratio.up_per_s,
            down_per_s: cvt.ratio.down_per_s,
        },
        grid: 97,
        least_speeds_rad_s: &[],
        prices: &[],
    };
    bencher.bench_local(|| {
        optimum::bound(black_box(&task))
            .map(|bound| bound.fuel_kg)
            .ok()
    });
}

#[divan::bench(args = ["us06", "wltc_class3b", "ftp75"])]
fn other_cycle_without_history(bencher: Bencher, name: &str) {
    drive_cycle(bencher, "rover_216_cvt", name, false);
}

#[divan::bench(args = CARS)]
fn load_vehicle(bencher: Bencher, name: &str) {
    bencher.bench_local(|| setup(black_box(name)));
}

#[divan::bench(args = ["ece15_eudc", "wltc_class3b"])]
fn parse_embedded_cycle(bencher: Bencher, name: &str) {
    bencher.bench_local(|| cycle(black_box(name)));
}

#[divan::bench]
fn parse_user_cycle(bencher: Bencher) {
    let mut text = String::from("time_s,speed_kmh,grade_percent\n");
    for i in 0..1800 {
        text.push_str(&format!(
            "{i},{:.2},{:.1}\n",
            40.0 + 30.0 * f64::from(i).sin().abs().min(0.02 * f64::from(i)),
            0.5
        ));
    }
    let rows = text.lines().count() - 1;
    bencher
        .counter(ItemsCount::new(rows))
        .bench_local(|| read_csv("user.csv", black_box(text.as_bytes())).map_err(|p| p.len()));
}

/// Numbers of the CVT, and one each of road load, oil and engine.
fn param_keys() -> Vec<String> {
    let base = ParamSet::load(CARS[0], &Options::default())
        .unwrap_or_else(|p| panic!("{}", render(&p, false)));
    let keys = base.keys().into_iter().map(|info| info.key);
    let of_cvt = keys.filter(|key| key.starts_with("transmission.cvt."));
    let others = [
        "road_load.mass_kg",
        "lubricant.kv40_mm2_s",
        "engine.idle.hot_rpm",
    ];
    let all = others.map(str::to_owned).into_iter().chain(of_cvt);
    let has_number = |key: &String| base.param(key).is_ok_and(|param| param.base().is_finite());
    all.filter(has_number).collect()
}

/// Builds a car with one changed number, as at the start of each run of a study.
#[divan::bench(args = param_keys())]
fn car_from_params(bencher: Bencher, key: &str) {
    let base = ParamSet::load(CARS[0], &Options::default())
        .unwrap_or_else(|p| panic!("{}", render(&p, false)));
    let param = base.param(key).unwrap();
    // A number at the end of its range has one side.
    let changed = [1.01, 0.99, 1.0].map(|factor| param.base() * factor);
    let valid = |number: &f64| base.with_numbers(&[(&param, *number)]).is_ok();
    let number = changed.into_iter().find(valid).unwrap();
    bencher.bench_local(|| {
        let set = base.with_numbers(&[(&param, black_box(number))]).unwrap();
        Setup::from_params(&set)
    });
}

/// Sink that drops the parts of a study.
struct NullSink;

impl PartWriter for NullSink {
    fn write(&self, _: u64, runs: &Rows, trace: Option<&Rows>) -> Result<(), Problem> {
        black_box((runs.len(), trace.map(Rows::len)));
        Ok(())
    }
}

/// Runs a study of 512 points of the CVT alone over ECE15+EUDC, each with four changed numbers: runs a second, on one and two threads, without
/// and with all columns of the traces.
#[divan::bench(args = [(1, false), (2, false), (1, true), (2, true)], sample_count = 10)]
fn study_runs(bencher: Bencher, (threads, traces): (usize, bool)) {
    let keep = if traces { "everything" } else { "summary" };
    let factor = |key: &str, low: f64, high: f64| {
        format!(
            "[[factor]]\nkey = \"{key}\"\nstatus = \"assumed\"\ndistribution.uniform = {{ low = {low}, high = {high} }}\n"
        )
    };
    let text = format!(
        "[study]\ntitle = \"bench\"\nbaselines = []\nambient_degc = -10\nkeep = \"{keep}\"\n[study.design.monte_carlo]\nsamples = 512\n"
    ) + &factor("transmission.cvt.pump.displacement_cc_rev", 7.0, 11.0)
        + &factor("transmission.cvt.belt.band_offset_mm", 2.0, 4.0)
        + &factor("lubricant.kv40_mm2_s", 30.0, 40.0)
        + &factor("road_load.mass_kg", 1000.0, 1250.0);
    let plan = Plan::read("bench", &text)
        .unwrap_or_else(|problems| panic!("{}", render(&problems, false)));
    let study =
        Study::prepare(plan).unwrap_or_else(|problems| panic!("{}", render(&problems, false)));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    bencher.counter(ItemsCount::new(512_usize)).bench_local(|| {
        pool.install(|| {
            study
                .execute(&BTreeSet::new(), &NullSink, &NoProgress)
                .map_err(|p| p.message)
        })
    });
}

/// Evaluates the built-in levers of a CVT, each with 256 draws in two cars over ECE15+EUDC, on two threads.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn levers(bencher: Bencher) {
    let request = LeverRequest {
        levers: LeverFile::open("cvt").unwrap().levers,
        vehicles: vec!["rover_216_cvt".to_owned(); 2],
        ambients_degc: vec![25.0],
        cycle: "ece15_eudc".to_owned(),
        start: "soak".to_owned(),
        dt_s: 1.0,
        base: Options::default(),
        set_all: Vec::new(),
        others: Vec::new(),
        draws: Some((Plan::open("uncertainty_rover").unwrap(), 256, 1)),
        combine: Combine::Automatic,
        heard_rpm: 1300.0,
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .unwrap();
    bencher.bench_local(|| {
        pool.install(|| {
            let study =
                prepare(&request).unwrap_or_else(|problems| panic!("{}", render(&problems, false)));
            study
                .execute(&BTreeSet::new(), &NullSink, &NoProgress)
                .map_err(|p| p.message)
        })
    });
}
