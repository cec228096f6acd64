//! Levers of a car: sliders of single values and choices among shipped changes, as far as the car has them.

use cvtcycle_analysis::draws::PLAN;
use cvtcycle_analysis::levers::{Lever, LeverFile};
use cvtcycle_config::setup::{Kind as FileKind, Options, Param, ParamSet, Setup, load};
use cvtcycle_config::{Acts, Bound, Override, Problems};
use cvtcycle_study::execute::relative;
use cvtcycle_study::plan::{Factor, FactorValues, Plan};

use crate::live_section::{Control, ControlChange, ControlKind, Slider};

/// Maximum number of levers of a page.
const MAX_CONTROLS: usize = 6;
/// Minimum number of positions of a slider.
const POSITIONS: f64 = 100.0;
/// Extension of a slider beyond the known range, in widths of that range; without a width, as a share of the value.
const BEYOND: f64 = 0.5;

/// Candidates in order of importance: the first ones that a car has, up to [`MAX_CONTROLS`], are shown.
enum Candidate {
    /// A number: name, title, key.
    Number(&'static str, &'static str, &'static str),
    /// Shipped changes of a group: name and title. Omits changes of a key that has a slider, or of the file's own value.
    Group(&'static str, &'static str),
}
use Candidate::{Group, Number};

const CANDIDATES: [Candidate; 14] = [
    Number(
        "pump",
        "Pump displacement",
        "transmission.cvt.pump.displacement_cc_rev",
    ),
    Group("pump", "Kind of pump"),
    Group("clamp", "Clamp law"),
    Number(
        "offset",
        "Band offset",
        "transmission.cvt.belt.band_offset_mm",
    ),
    Number(
        "line",
        "Engine speed in gentle acceleration",
        "transmission.cvt.ratio.gentle_rpm",
    ),
    Number(
        "wedge",
        "Half wedge angle",
        "transmission.cvt.variator.half_wedge_deg",
    ),
    Group("start_stop", "Start-stop"),
    Number("final", "Final drive", "transmission.manual.final_ratio"),
    Number(
        "churning",
        "Churning, factor",
        "transmission.manual.gears.churning_factor",
    ),
    Number(
        "preload",
        "Preload of bearings, factor",
        "transmission.manual.gears.preload_factor",
    ),
    Number(
        "final_cvt",
        "Final drive",
        "transmission.cvt.final_drive_ratio",
    ),
    Number("mass", "Inertia mass", "road_load.mass_kg"),
    Number("idle", "Idle speed, warm", "engine.idle.hot_rpm"),
    Number("radius", "Radius of the wheels", "road_load.wheel_radius_m"),
];

/// Selects the levers of a car.
///
/// # Errors
/// Problems of the car.
pub(super) fn car_controls(word: &str, options: &Options) -> Result<Vec<Control>, Problems> {
    let params = ParamSet::load(word, options)?;
    let setup = params.setup();
    let (plan, _) = relative(Plan::open(PLAN)?)?;
    let mut shipped = Vec::new();
    for name in FileKind::Levers.names() {
        shipped.extend(LeverFile::open(name)?.levers);
    }
    let keys = CANDIDATES.iter().filter_map(|candidate| match candidate {
        Number(.., key) => Some(*key),
        Group(..) => None,
    });
    let keys: Vec<&str> = keys.collect();
    let control = |candidate: &Candidate| {
        let (name, title, kind) = match candidate {
            Number(name, title, key) => {
                let param = params.param(key).ok();
                let param = param.filter(|of| of.is_active() && of.base().is_finite())?;
                let slider = slider(key, &param, &shipped, &plan.factors)?;
                (format!("l.{name}"), *title, ControlKind::Slider(slider))
            }
            Group(name, title) => {
                let own = shipped
                    .iter()
                    .filter(|lever| lever.group.as_deref() == Some(name));
                let own = own.filter(|lever| is_choice(lever, &keys));
                let own = own.filter(|lever| can_have(word, options, &setup, lever));
                let changes: Vec<ControlChange> = own.map(change).collect();
                (!changes.is_empty())
                    .then(|| (format!("g.{name}"), *title, ControlKind::Choice(changes)))?
            }
        };
        Some(Control { name, title, kind })
    };
    Ok(CANDIDATES
        .iter()
        .filter_map(control)
        .take(MAX_CONTROLS)
        .collect())
}

fn slider(
    key: &'static str,
    param: &Param,
    shipped: &[Lever],
    factors: &[Factor],
) -> Option<Slider> {
    let base = param.base();
    let row = Override::number(key, base).row()?;
    let of_levers = shipped.iter().flat_map(|lever| &lever.set);
    let of_levers = of_levers.filter(|by| by.key() == key);
    let of_levers = of_levers.filter_map(|by| by.number_over(Some(base)));
    let of_plan = factors.iter().filter(|factor| factor.key == key);
    let of_plan = of_plan.flat_map(|factor| match &factor.values {
        FactorValues::Distribution(candidate) => {
            let (low, high) = candidate.support();
            [low, high].map(|x| factor.acts.resolved(base, x))
        }
        FactorValues::List(_) => [base, base],
    });
    let bound = row.range();
    let all = of_levers.chain(of_plan).filter(|x| bound.contains(*x));
    let known = all.fold([base, base], |[low, high], x| [low.min(x), high.max(x)]);
    let width = known[1] - known[0];
    let beyond = BEYOND * if width > 0.0 { width } else { base.abs() };
    let (ends, step) = positions([known[0] - beyond, known[1] + beyond], bound)?;
    Some(Slider {
        key,
        unit: if param.unit() == "-" {
            ""
        } else {
            param.unit()
        },
        base,
        ends,
        step,
        known,
        meaning: row.doc,
    })
}

/// Ends at whole steps within the allowed range, and the step: a power of ten with at least [`POSITIONS`].
fn positions([low, high]: [f64; 2], bound: Bound) -> Option<([f64; 2], f64)> {
    let (low, high) = (low.max(bound.low()), high.min(bound.high()));
    let exponent = ((high - low) / POSITIONS).log10().floor();
    let step = 10_f64.powi(exponent as i32);
    // Negative powers of ten are inexact, their inverses exact.
    let at = |count: f64| match exponent < 0.0 {
        true => count / 10_f64.powi(-exponent as i32),
        false => count * step,
    };
    let first = (low / step).ceil();
    let first = if bound.contains(at(first)) {
        first
    } else {
        first + 1.0
    };
    let ends = [at(first), at((high / step).floor())];
    (ends[0] < ends[1] && ends.iter().all(|x| x.is_finite())).then_some((ends, step))
}

/// True if a lever sets only values, and none that a slider sets.
fn is_choice(lever: &Lever, sliders: &[&str]) -> bool {
    let is_own = |by: &Override| by.acts() == Acts::Value && !sliders.contains(&by.key());
    !lever.set.is_empty()
        && lever.set.iter().all(is_own)
        && lever.lubricant.is_none()
        && lever.engine_oil.is_none()
}

/// True if the car accepts a lever, and changes by it.
fn can_have(word: &str, options: &Options, base: &Setup, lever: &Lever) -> bool {
    let mut options = options.clone();
    options.set.extend(lever.set.iter().cloned());
    let differs = |with: Setup| {
        let values = |setup: &Setup| -> Vec<(String, String)> {
            let keys = setup.keys.iter();
            keys.map(|info| (info.key.clone(), info.value.clone()))
                .collect()
        };
        values(&with) != values(base)
    };
    load(word, &options).is_ok_and(differs)
}

fn change(lever: &Lever) -> ControlChange {
    ControlChange {
        name: lever.name.clone(),
        title: lever.title.clone(),
        needs: lever.needs.clone(),
        set: lever.set.clone(),
    }
}
