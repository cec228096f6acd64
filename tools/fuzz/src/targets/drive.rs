//! Short runs of valid cars.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::sync::OnceLock;

use cvtcycle::config::cycle::{Cycle, read_csv};
use cvtcycle::config::setup::{Options, Param, ParamSet, Setup};
use cvtcycle::config::{KeyInfo, Override};
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::model::drive::{Recorder, State, simulate};
use cvtcycle::output::{Component, EnergyTerms, Row};

use super::range::range;
use super::{Bytes, within_memory};

/// Cars with options for other components: fuel model, clamping, pump, thrust ratio, cooler, fluids.
const CARS: [(&str, &[&str]); 10] = [
    ("rover_216_cvt", &[]),
    (
        "rover_216_cvt",
        &[
            "transmission.cvt.clamp=map",
            "engine.model.bsfc_map.file=si_1900_bsfc",
        ],
    ),
    (
        "rover_216_cvt",
        &[
            "transmission.cvt.clamp=torque_following",
            "transmission.cvt.pump.kind=dual_cavity",
        ],
    ),
    (
        "rover_216_cvt",
        &[
            "transmission.cvt.clamp=slip_limited",
            "transmission.cvt.pump.kind=variable",
        ],
    ),
    (
        "rover_216_cvt",
        &[
            "transmission.cvt.belt.thrust_ratio=[[0.4, 1.2], [1, 1.1], [2.5, 0.9]]",
            "thermal.cooler.bypassed=true",
        ],
    ),
    (
        "rover_216_cvt",
        &[
            "transmission.cvt.variator.compensated=false",
            "thermal.transmission.exchanger_w_k=120",
        ],
    ),
    (
        "rover_216_cvt",
        &[
            "vehicle.transmission_oil=dexron_iii",
            "thermal.cooler.bypass_below_degc=20",
        ],
    ),
    ("rover_216_5mt", &[]),
    (
        "rover_216_5mt",
        &[
            "engine.model.bsfc_map.file=si_1900_bsfc",
            "road_load.surface=road",
        ],
    ),
    ("mondeo_20_5mt", &[]),
];

/// Maximum number of changed numbers of a car.
const MAX_CHANGES: usize = 40;

/// Number of legs of a cycle.
const LEGS: usize = 8;

struct Car {
    base: ParamSet,
    parameters: Vec<(Param, f64, f64, f64, bool)>,
}

fn car((name, words): (&str, &[&str])) -> Car {
    let options = Options {
        set: Override::parse_all(words).unwrap_or_else(|p| panic!("{p}")),
        ..Options::default()
    };
    let base = ParamSet::load(name, &options)
        .unwrap_or_else(|problems| panic!("{name} {words:?}: {}", problems[0].message));
    let parameter = |info: &KeyInfo| {
        info.si?;
        let (low, high) = range(&info.allowed)?;
        let number: f64 = info.value.parse().ok()?;
        let param = base.param(&info.key).ok()?;
        Some((
            param,
            low,
            high,
            number,
            info.allowed.starts_with("integer"),
        ))
    };
    let parameters = base.keys().iter().filter_map(parameter).collect();
    Car { base, parameters }
}

/// True if car and cycle of an input are printed: `CVTCYCLE_FUZZ_PRINT=1`.
fn prints_input() -> bool {
    static PRINTS_INPUT: OnceLock<bool> = OnceLock::new();
    *PRINTS_INPUT.get_or_init(|| std::env::var_os("CVTCYCLE_FUZZ_PRINT").is_some())
}

/// Applies the changes of the input to the car. If the result is invalid, tries the first half of them, then its first half.
fn setup(car: &Car, bytes: &mut Bytes) -> Option<Setup> {
    let mut changes = Vec::new();
    for _ in 0..usize::from(bytes.byte()) % (MAX_CHANGES + 1) {
        let place = usize::from(bytes.short()) % car.parameters.len();
        let (_, low, high, base, whole) = &car.parameters[place];
        let (way, toward) = (bytes.byte(), 2.0 * bytes.share() - 1.0);
        let end = if toward < 0.0 { low } else { high };
        let number = match way % 4 {
            0 => *end,
            1 => base + toward * toward * (end - base),
            _ => base * (0.4 * toward).exp(),
        };
        let number = if *whole { number.round() } else { number };
        changes.push((place, number.clamp(*low, *high)));
    }
    loop {
        let numbers = changes.iter();
        let numbers = numbers.map(|(place, number)| (&car.parameters[*place].0, *number));
        match car.base.with_numbers(&numbers.collect::<Vec<_>>()) {
            Ok(set) => {
                if prints_input() {
                    changes.iter().for_each(|(place, number)| {
                        eprintln!("--set {}={number:?}", car.parameters[*place].0.key())
                    });
                }
                return Some(Setup::from_params(&set));
            }
            Err(_) if changes.is_empty() => return None,
            Err(_) => changes.truncate(changes.len() / 2),
        }
    }
}

fn cycle(bytes: &mut Bytes) -> Option<Cycle> {
    let mut text = String::from("time_s,speed_kmh,grade,engine_off\n");
    let (mut time_s, mut kmh) = (
        0.0,
        if bytes.one_in(4) {
            100.0 * bytes.share()
        } else {
            0.0
        },
    );
    for _ in 0..=usize::from(bytes.byte()) % LEGS {
        let grade = if bytes.one_in(4) {
            0.2 * bytes.share() - 0.1
        } else {
            0.0
        };
        let next = if bytes.one_in(4) {
            0.0
        } else {
            140.0 * bytes.share()
        };
        let engine_off = u8::from(kmh <= 0.0 && next <= 0.0 && bytes.one_in(2));
        let _ = writeln!(text, "{time_s},{kmh},{grade},{engine_off}");
        time_s += 0.25 + 12.0 * bytes.share() * bytes.share();
        kmh = next;
    }
    let _ = writeln!(text, "{},{kmh},0,0", time_s + 1.0);
    if prints_input() {
        eprintln!("{text}");
    }
    // Hard braking or acceleration may be refused.
    read_csv("fuzz.csv", text.as_bytes()).ok()
}

/// Checks every row.
struct CheckRows;

impl Recorder for CheckRows {
    fn record(&mut self, row: &Row, terms: &EnergyTerms) {
        assert!(
            terms.power_error() <= 1e-9 && terms.heat_error() <= 1e-9,
            "ledgers {terms:?} in {row:?}"
        );
        for component in Component::ALL {
            let loss = row.loss_w[component];
            assert!(
                loss >= 0.0 && loss.is_finite(),
                "{} loses {loss} W in {row:?}",
                component.name()
            );
        }
        for x in [
            row.fuel_kg_s,
            row.brake_w,
            row.deficit_w,
            row.exhaust_w,
            row.engine_heat_w,
            row.engine_speed_rad_s,
            row.throttle,
        ] {
            assert!(x >= 0.0 && x.is_finite(), "{x} in {row:?}");
        }
        for k in [row.coolant_k, row.engine_oil_k, row.sump_k] {
            // There is no upper limit: an engine may produce any heat.
            assert!(k >= 200.0 && k.is_finite(), "{k} K in {row:?}");
        }
    }
}

pub fn drive_car(data: &[u8]) {
    thread_local!(static MADE: RefCell<[Option<Car>; CARS.len()]> = const { RefCell::new([const { None }; CARS.len()]) });
    let mut bytes = Bytes(data);
    let which = usize::from(bytes.byte()) % CARS.len();
    let conditions = Conditions {
        ambient_k: 233.15 + 100.0 * bytes.share(),
        start: match bytes.byte() % 4 {
            0 => Start::Warm,
            1 => Start::At(233.15 + 170.0 * bytes.share()),
            _ => Start::Soak,
        },
        max_dt_s: bytes.pick(&[1.0, 1.0, 0.5, 5.0]),
        keep_rows: true,
    };
    if prints_input() {
        eprintln!("{:?}\n{conditions:?}", CARS[which]);
    }
    MADE.with_borrow_mut(|made| {
        let car = made[which].get_or_insert_with(|| car(CARS[which]));
        within_memory(data.len(), || {
            let mut bytes = Bytes(bytes.0);
            let Some(cycle) = cycle(&mut bytes) else {
                return;
            };
            let Some(setup) = setup(car, &mut bytes) else {
                return;
            };
            let trace = cycle.trace_for(setup.transmission().is_cvt());
            let start_k = if let Start::At(temp_k) = conditions.start {
                temp_k
            } else {
                conditions.ambient_k
            };
            simulate(
                &setup.car(conditions.ambient_k),
                trace,
                conditions.max_dt_s,
                State::at(start_k),
                &mut CheckRows,
            );
            // Runs like the command, with its start and its sums.
            if matches!(conditions.start, Start::Warm) {
                let outcome = drive(&setup, &cycle, &conditions);
                let fuel_kg: f64 = outcome
                    .rows
                    .iter()
                    .map(|row| row.fuel_kg_s * row.dt_s)
                    .sum();
                assert!(
                    fuel_kg.is_finite() && fuel_kg >= 0.0,
                    "{fuel_kg} kg of fuel"
                );
            }
        });
    });
}
