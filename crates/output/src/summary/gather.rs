//! Totals to the numbers of a summary.

use super::{
    Comparison, Deficit, Driven, Named, PhaseSummary, RunSummary, SCHEMA, Settings, Solve,
    StartWord, Summary,
};
use crate::number::finite;
use crate::record::Manifest;
use crate::{Component, Flags, PhaseTotals, TERM_NAMES};
use cvtcycle_config::cycle::{Cycle, Weighting};
use cvtcycle_model::drive::{Outcome, litres_per_100km};
use cvtcycle_model::engine::Engine;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};
use cvtcycle_model::transmission::cvt::variator::Formulation;

/// Miles per imperial gallon at 1 L/100 km.
const MPG_UK: f64 = 282.481;
/// Miles per US gallon at 1 L/100 km.
const MPG_US: f64 = 235.215;
const ZERO_DEGC_K: f64 = cvtcycle_model::fluid::ZERO_DEGC_K;

/// Puts the numbers of a run together; the first car is the subject.
///
/// ```
/// use cvtcycle_config::Problems;
/// use cvtcycle_config::cycle;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::{Conditions, Start, drive};
/// use cvtcycle_output::summary::{Driven, Settings, StartWord, summarise};
/// let setup = load("rover_216_cvt", &Options::default())?;
/// let cycle = cycle::find("ece15_eudc")?;
/// let conditions = Conditions {
///     ambient_k: 263.15,
///     start: Start::Soak,
///     max_dt_s: 1.0,
///     keep_rows: false,
/// };
/// let outcome = drive(&setup, &cycle, &conditions);
/// let driven = [Driven { name: "rover", setup: &setup, outcome: &outcome }];
/// let start = StartWord::Word("soak".to_owned());
/// let summary = summarise(&cycle, -10.0, start, Settings::default(), &driven);
/// let fuel = summary.runs[0].fuel_l_per_100km.unwrap_or(f64::NAN);
/// assert!((5.0..12.0).contains(&fuel), "{fuel} L/100 km");
/// # Ok::<(), Problems>(())
/// ```
pub fn summarise(
    cycle: &Cycle,
    ambient_degc: f64,
    start: StartWord,
    settings: Settings,
    driven: &[Driven],
) -> Summary {
    let roles = ["subject"].into_iter().chain(std::iter::repeat("baseline"));
    let runs = driven.iter().zip(roles);
    let runs: Vec<RunSummary> = runs
        .map(|(car, role)| run_summary(cycle, role, &settings, car))
        .collect();
    let baselines = runs.iter().skip(1);
    let comparison = baselines
        .map(|baseline| compare(&runs[0], baseline))
        .collect();
    Summary {
        manifest: Manifest::new(SCHEMA),
        cycle: cycle.name.clone(),
        ambient_degc,
        start,
        settings,
        runs,
        comparison,
    }
}

/// The numbers of one car. `role` is `subject` or `baseline`.
pub fn run_summary(cycle: &Cycle, role: &str, settings: &Settings, driven: &Driven) -> RunSummary {
    let Driven {
        name,
        setup,
        outcome,
    } = *driven;
    let totals = &outcome.totals;
    let (engine, cvt) = (setup.engine(), setup.transmission().is_cvt());
    let (oil, engine_oil) = setup.oils();
    let all = totals.total();
    let fuel = PhaseFuel::of(&all, engine);
    let weighted = weighted_fuel(cycle, driven, engine);
    let headline = weighted.or(fuel.l_per_100km).filter(|l| *l > 0.0);
    let mpg = |factor: f64| headline.map(|l| factor / l);
    let seconds = |flag: Flags| totals.seconds(flag);
    let flags = Flags::NAMES.iter().zip(totals.flag_s);
    let terms = TERM_NAMES.iter().zip(all.terms.as_array());
    let mut summary = RunSummary {
        vehicle: name.to_owned(),
        title: setup.title.clone(),
        role: role.to_owned(),
        transmission: if cvt { "cvt" } else { "manual" }.to_owned(),
        lubricant: oil.name.clone(),
        engine_oil: engine_oil.name.clone(),
        gear_schedule: (!outcome.gear_schedule.is_empty())
            .then(|| outcome.gear_schedule.to_owned()),
        distance_km: all.distance_m / 1e3,
        duration_s: all.duration_s,
        fuel_kg: all.fuel_kg,
        fuel_l: all.fuel_kg / engine.fuel_density_kg_m3 * 1e3,
        fuel_l_per_100km: fuel.l_per_100km,
        weighted_fuel_l_per_100km: weighted,
        mpg_uk: mpg(MPG_UK),
        mpg_us: mpg(MPG_US),
        co2_g_per_km: fuel.co2_g_per_km,
        weighted_co2_g_per_km: weighted
            .map(|l| l * engine.fuel_density_kg_m3 * engine.co2_kg_kg / 100.0),
        phases: phases(cycle, driven, engine),
        wheel_work_positive_kj: all.wheel_positive_j / 1e3,
        wheel_work_negative_kj: all.wheel_negative_j / 1e3,
        fuel_energy_kj: all.terms.fuel / 1e3,
        loss_kj: losses(driven, settings, &all),
        kinetic_kj: all.terms.kinetic / 1e3,
        ledger_kj: terms
            .map(|(name, joules)| (*name, finite(joules / 1e3)))
            .collect(),
        standstill_fuel_g: all.standstill_fuel_kg * 1e3,
        min_clamp_safety: finite(totals.min_clamp_safety).filter(|_| cvt),
        at_ratio_limit_s: cvt.then(|| seconds(Flags::RATIO_LIMIT)),
        end_degc: end_temperatures(outcome, cvt),
        ledger_error: finite(totals.ledger_error),
        run_ledger_error: finite(larger(all.terms.power_error(), all.terms.heat_error())),
        trace_missed_s: seconds(Flags::MISSED_TRACE),
        outside_validity_s: seconds(Flags::OUTSIDE_VALIDITY),
        flags_s: flags.map(|((_, name), s)| (*name, finite(s))).collect(),
        worst_deficit: worst_deficit(cycle, driven, cvt),
        solve: Solve {
            worst_residual: totals.worst_residual,
            evaluations_per_step: finite(totals.evaluations as f64 / totals.rows as f64),
        },
        failed_checks: Vec::new(),
    };
    summary.failed_checks = summary.checks(settings.strict);
    summary
}

fn larger(a: f64, b: f64) -> f64 {
    // What is no number must not hide behind the other.
    if a.is_nan() || a > b { a } else { b }
}

/// Fuel of some part of a cycle over its distance.
struct PhaseFuel {
    l_per_100km: Option<f64>,
    co2_g_per_km: Option<f64>,
}

impl PhaseFuel {
    fn of(part: &PhaseTotals, engine: &Engine) -> Self {
        let litres = litres_per_100km(part.fuel_kg, engine.fuel_density_kg_m3, part.distance_m);
        PhaseFuel {
            l_per_100km: finite(litres),
            co2_g_per_km: finite(part.fuel_kg * engine.co2_kg_kg * 1e6 / part.distance_m),
        }
    }
}

fn phases(cycle: &Cycle, driven: &Driven, engine: &Engine) -> Vec<PhaseSummary> {
    let groups = cycle.phase_groups().into_iter();
    groups
        .map(|(name, phases)| {
            let part = driven.outcome.totals.over(&phases);
            let fuel = PhaseFuel::of(&part, engine);
            PhaseSummary {
                name,
                distance_km: part.distance_m / 1e3,
                duration_s: part.duration_s,
                fuel_kg: part.fuel_kg,
                fuel_l_per_100km: fuel.l_per_100km,
                co2_g_per_km: fuel.co2_g_per_km,
                transmission_loss_kj: part.terms.losses / 1e3,
            }
        })
        .collect()
}

/// 40 CFR 86.144: Y = 0.43 (Y_ct + Y_s)/(D_ct + D_s) + 0.57 (Y_ht + Y_s)/(D_ht + D_s).
fn weighted_fuel(cycle: &Cycle, driven: &Driven, engine: &Engine) -> Option<f64> {
    if cycle.weighting != Weighting::Ftp75 {
        return None;
    }
    let groups = cycle.phase_groups();
    let bags = |names: [&str; 2]| {
        let named = groups
            .iter()
            .filter(|(name, _)| names.contains(&name.as_str()));
        let phases: Vec<u16> = named.flat_map(|(_, list)| list.clone()).collect();
        PhaseFuel::of(&driven.outcome.totals.over(&phases), engine).l_per_100km
    };
    let cold = bags(["cold_transient", "stabilised"])?;
    let hot = bags(["hot_transient", "stabilised"])?;
    Some(Weighting::FTP75_COLD * cold + Weighting::FTP75_HOT * hot)
}

fn losses(driven: &Driven, settings: &Settings, all: &PhaseTotals) -> Named {
    // The verification formulations know no film of its own: whatever shear there is belongs to the bands.
    let film =
        settings.formulation.is_empty() || settings.formulation == Formulation::Smooth.name();
    let joules = |c: Component| all.loss_j[c];
    let part = |c: Component| match c {
        Component::BeltFilm if !film => None,
        Component::BeltBand if !film => finite((joules(c) + joules(Component::BeltFilm)) / 1e3),
        _ => finite(joules(c) / 1e3),
    };
    let components = driven.setup.transmission().components();
    let components = components.into_iter().map(|c| (c.name(), part(c)));
    let rest = [
        ("accessories", all.terms.accessories),
        ("brake", all.terms.brake),
    ];
    let rest = rest.map(|(name, joules)| (name, finite(joules / 1e3)));
    components.chain(rest).collect()
}

fn end_temperatures(outcome: &Outcome, cvt: bool) -> Named {
    let degc = |node: usize| finite(outcome.end.node_k[node] - ZERO_DEGC_K);
    [
        ("transmission_sump", degc(SUMP)),
        ("engine_oil", degc(ENGINE_OIL)),
        ("coolant", degc(COOLANT)),
        ("transmission_metal", degc(METAL)),
        ("belt_spray", degc(BELT).filter(|_| cvt)),
    ]
    .into_iter()
    .collect()
}

fn worst_deficit(cycle: &Cycle, driven: &Driven, cvt: bool) -> Option<Deficit> {
    let totals = &driven.outcome.totals;
    let at_s = finite(totals.worst_deficit_at_s)?;
    let intervals = &cycle.trace_for(cvt).intervals;
    let interval = intervals.iter().find(|i| at_s <= i.end_s + 1e-9)?;
    let phase = cycle
        .phases
        .get(usize::from(interval.phase))
        .unwrap_or(&cycle.name);
    Some(Deficit {
        power_w: totals.worst_deficit_w,
        wheel_torque_nm: finite(totals.worst_deficit_nm),
        at_s,
        phase: phase.to_lowercase(),
    })
}

/// The subject against one baseline.
pub fn compare(subject: &RunSummary, baseline: &RunSummary) -> Comparison {
    let percent =
        |s: Option<f64>, b: Option<f64>| s.zip(b).and_then(|(s, b)| finite((s / b - 1.0) * 100.0));
    let phases = subject.phases.iter().zip(&baseline.phases);
    let phases = phases.map(|(s, b)| (&*s.name, percent(s.fuel_l_per_100km, b.fuel_l_per_100km)));
    Comparison {
        baseline: baseline.vehicle.clone(),
        fuel_percent: percent(subject.headline_fuel(), baseline.headline_fuel()),
        phases_percent: phases.collect(),
    }
}
