//! Random valid cars.

use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};

use cvtcycle_config::setup::{Options, ParamSet, Setup};
use cvtcycle_config::{KeyInfo, Override};
use proptest::prelude::*;
use proptest::sample::Index;

use crate::common::CARS;
use crate::common::range::range;

/// Groups of changes that were offered to the reader, and those that it accepted.
static OFFERED: AtomicUsize = AtomicUsize::new(0);
static ACCEPTED: AtomicUsize = AtomicUsize::new(0);
/// Changes that are offered to the reader together: a group that makes no possible car is left out as a whole.
const GROUP: usize = 5;

/// One number of a car, moved.
#[derive(Clone, Debug)]
struct Change {
    key: Index,
    /// From -1 to 1: towards the lower or the upper end.
    toward: f64,
    /// Range of the draw: all that the key allows, or values of another car of the kind.
    wide: bool,
}

/// How a car is made from a shipped one.
#[derive(Clone)]
pub struct Recipe {
    vehicle: usize,
    words: Vec<&'static str>,
    lubricant: Option<&'static str>,
    engine_oil: Option<&'static str>,
    changes: Vec<Change>,
}

/// A car, and what makes it, for messages.
pub struct RandomCar {
    pub setup: Setup,
    pub text: String,
}

const CVT_FLUIDS: [&str; 3] = ["cvtf_ezl799_class", "dexron_ii", "dexron_iii"];

/// Words of any car: road load, fuel model, cooler, full load.
const WORDS: [&[&str]; 5] = [
    &["road_load.surface=dynamometer", "road_load.surface=road"],
    &["", "", "engine.model.bsfc_map.file=si_1900_bsfc"],
    &[
        "",
        "thermal.cooler.bypassed=true",
        "thermal.cooler.fitted=true",
        "thermal.cooler.bypass_below_degc=20",
    ],
    &["", "thermal.transmission.exchanger_w_k=120"],
    &[
        "",
        "engine.full_load=[[600, 60], [1500, 90], [3000, 120], [4500, 110], [6500, 90]]",
        "engine.full_load=[[800, 150], [2000, 210], [4000, 220], [6000, 170]]",
    ],
];
/// Words of a CVT.
const CVT_WORDS: [&[&str]; 4] = [
    &[
        "transmission.cvt.clamp=map",
        "transmission.cvt.clamp=torque_following",
        "transmission.cvt.clamp=slip_limited",
    ],
    &[
        "transmission.cvt.pump.kind=fixed",
        "transmission.cvt.pump.kind=dual_cavity",
        "transmission.cvt.pump.kind=variable",
    ],
    &["", "transmission.cvt.variator.compensated=false"],
    &[
        "",
        "transmission.cvt.belt.thrust_ratio=[[0.4, 1.2], [1, 1.1], [2.5, 0.9]]",
    ],
];

/// Where a shipped value is zero: what another car might have (end of the key, value).
const INSTEAD_OF_ZERO: [(&str, f64); 7] = [
    ("payload_kg", 400.0),
    ("altitude_m", 1500.0),
    ("f1_n_per_kmh", 0.6),
    ("exchanger_w_k", 150.0),
    ("under_bonnet_rise", 0.3),
    ("line_drop_bar", 3.0),
    ("initial_gap_mm", 0.3),
];

fn change(wide: f64) -> impl Strategy<Value = Change> {
    (any::<Index>(), -1.0..1.0, prop::bool::weighted(wide)).prop_map(|(key, toward, wide)| Change {
        key,
        toward,
        wide,
    })
}

/// Cars with up to 60 numbers changed; `wide` is the share of them that may lie anywhere in what their key allows.
pub fn recipes(wide: f64) -> impl Strategy<Value = Recipe> {
    let words = prop::collection::vec(any::<Index>(), WORDS.len() + CVT_WORDS.len());
    let fluids = (
        prop::option::of(prop::sample::select(&CVT_FLUIDS[..])),
        prop::option::of(Just("engine_5w30")),
    );
    (
        0..CARS.len() + 2,
        words,
        fluids,
        prop::collection::vec(change(wide), 0..60),
    )
        .prop_map(|(vehicle, words, fluids, changes)| {
            // The CVT three times as often as each of the others: it has more to vary.
            let vehicle = if vehicle < CARS.len() { vehicle } else { 0 };
            let cvt = vehicle == 0;
            let lists = WORDS.iter().chain(CVT_WORDS.iter().filter(|_| cvt));
            let words = lists
                .zip(&words)
                .map(|(list, at)| *at.get(list))
                .filter(|word| !word.is_empty())
                .collect();
            Recipe {
                vehicle,
                words,
                lubricant: fluids.0.filter(|_| cvt),
                engine_oil: fluids.1,
                changes,
            }
        })
}

impl Recipe {
    /// The car.
    pub fn car(&self) -> RandomCar {
        let owned = |word: Option<&str>| word.map(str::to_owned);
        let set = Override::parse_all(&self.words).unwrap_or_else(|p| panic!("{p}"));
        let options = Options {
            lubricant: owned(self.lubricant),
            engine_oil: owned(self.engine_oil),
            set,
            ..Options::default()
        };
        let name = CARS[self.vehicle];
        let base = ParamSet::load(name, &options)
            .unwrap_or_else(|problems| panic!("{name} {options:?}: {}", problems[0].message));
        let numbers = base.keys().into_iter().filter(|info| info.si.is_some());
        let numbers: Vec<KeyInfo> = numbers.collect();
        let mut kept: Vec<(&str, f64)> = Vec::new();
        let mut setup = Setup::from_params(&base);
        for group in self.changes.chunks(GROUP) {
            let moved: Vec<(&str, f64)> = group
                .iter()
                .filter_map(|change| moved(change.key.get(&numbers), change))
                .collect();
            let all: Vec<(&str, f64)> = kept.iter().copied().chain(moved).collect();
            OFFERED.fetch_add(1, Ordering::Relaxed);
            if let Some(accepted) = built(&base, &all) {
                ACCEPTED.fetch_add(1, Ordering::Relaxed);
                (kept, setup) = (all, accepted);
            }
        }
        let numbers: String = kept
            .iter()
            .map(|(key, number)| format!(" --set {key}={number}"))
            .collect();
        let words: String = self
            .words
            .iter()
            .map(|word| format!(" --set '{word}'"))
            .collect();
        let fluids = format!("{:?} {:?}", self.lubricant, self.engine_oil);
        RandomCar {
            setup,
            text: format!("--vehicle {name}{words}{numbers} ({fluids})"),
        }
    }
}

fn built(base: &ParamSet, numbers: &[(&str, f64)]) -> Option<Setup> {
    let param = |key: &str| {
        let param = base.param(key);
        param.unwrap_or_else(|problem| panic!("{key}: {}", problem.message))
    };
    let params: Vec<_> = numbers.iter().map(|(key, x)| (param(key), *x)).collect();
    let numbers: Vec<_> = params.iter().map(|(param, x)| (param, *x)).collect();
    let set = base.with_numbers(&numbers).ok()?;
    Some(Setup::from_params(&set))
}

/// The key and its new value; nothing for a key that is the truth of another one, or whose range has no ends.
fn moved<'k>(info: &'k KeyInfo, change: &Change) -> Option<(&'k str, f64)> {
    let (low, high) = range(&info.allowed)?;
    let base: f64 = info.value.parse().ok()?;
    let end = if change.toward < 0.0 { low } else { high };
    let number = if change.wide {
        // Nearer to the shipped value more often than to the end.
        base + change.toward * change.toward * (end - base)
    } else if base.abs() > 0.0 {
        base * (0.4 * change.toward).exp()
    } else {
        let usual = INSTEAD_OF_ZERO
            .iter()
            .find(|(key, _)| info.key.ends_with(key))
            .map_or(0.01 * high, |(_, usual)| *usual);
        usual * change.toward.abs()
    };
    let number = if info.allowed.starts_with("integer") {
        number.round()
    } else {
        number
    };
    Some((&info.key, number.clamp(low, high)))
}

/// How many groups of changes the reader was offered and accepted, so far and over all tests.
pub fn acceptance() -> (usize, usize) {
    (
        ACCEPTED.load(Ordering::Relaxed),
        OFFERED.load(Ordering::Relaxed),
    )
}

impl fmt::Debug for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.car().text)
    }
}
