//! What looks like a slip in the values of a car, though each is within its range: `new`, `check` and `run` have the same sentences.
//!
//! The limits leave every shipped car and every class without a doubt. Power over displacement has wide ones: the mean of the 257 midsize
//! cars of a class, turbo engines among them, is 70 kW per litre, so that 78 is no slip.

use std::ops::RangeInclusive;

use super::Setup;
use cvtcycle_model::keys::rpm;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::cvt::Cvt;

/// Least road load at 80 km/h over mass, N/kg.
const LEAST_N_KG: f64 = 0.15;
/// Greatest mass of a car, kg.
const MOST_KG: f64 = 2500.0;
/// Rated power over displacement, kW/l.
const KW_PER_LITRE: RangeInclusive<f64> = 25.0..=150.0;
/// Greatest power of the full-load line over rated power.
const OF_RATED: RangeInclusive<f64> = 0.95..=1.05;
/// Least span of the belt's ratio: those of 1987 have 5.
const LEAST_SPAN: f64 = 4.0;

/// The doubts about a car, a sentence each.
pub(super) fn doubts(setup: &Setup) -> Vec<String> {
    let all = [
        of_road_load(setup),
        of_mass(setup),
        of_size(setup),
        of_full_load(setup),
    ];
    let of_box = match setup.transmission() {
        Transmission::Cvt(cvt) => [of_span(cvt), of_overrun(setup, cvt)],
        Transmission::Manual(_) => [None, None],
    };
    all.into_iter().chain(of_box).flatten().collect()
}

fn of_road_load(setup: &Setup) -> Option<String> {
    let base = &setup.road_load.base;
    let v = 80.0 / 3.6;
    let force_n = base.f0_n + (base.f1_n_per_m_s + base.f2_n_per_m_s2 * v) * v;
    (force_n < LEAST_N_KG * base.mass_kg).then(|| {
        format!(
            "the road load is {force_n:.0} N at 80 km/h, of cars of the classes 0.22 to 0.28 N per kg: are the coefficients in lbf?"
        )
    })
}

fn of_mass(setup: &Setup) -> Option<String> {
    let mass_kg = setup.road_load.base.mass_kg;
    (mass_kg > MOST_KG).then(|| format!("the mass is {mass_kg:.0} kg: is it in lb?"))
}

fn of_size(setup: &Setup) -> Option<String> {
    let engine = setup.engine();
    let per_litre = engine.rated_w / 1e3 / (engine.displacement_m3 * 1e3);
    (!KW_PER_LITRE.contains(&per_litre)).then(|| {
        format!("the engine has {per_litre:.0} kW per litre: check displacement and power")
    })
}

fn of_full_load(setup: &Setup) -> Option<String> {
    let engine = setup.engine();
    let points = engine.full_load.points();
    let (power_w, speed) = points
        .map(|(rad_s, nm)| (rad_s * nm, rad_s))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    (!OF_RATED.contains(&(power_w / engine.rated_w))).then(|| {
        format!(
            "the line of full load has {:.0} kW at {:.0} rpm, the rated power is {:.0} kW: check both, and their units",
            power_w / 1e3,
            rpm(speed),
            engine.rated_w / 1e3
        )
    })
}

fn of_span(cvt: &Cvt) -> Option<String> {
    let (low, high) = (cvt.ratio.low, cvt.ratio.high);
    (low < LEAST_SPAN * high).then(|| {
        format!(
            "the belt's ratio goes from {low} to {high}, a span of {:.2}; that of cars is 5 and more: is one end that of the other?",
            low / high
        )
    })
}

fn of_overrun(setup: &Setup, cvt: &Cvt) -> Option<String> {
    let engine = setup.engine();
    let [overrun, all, none] = [
        cvt.ratio.overrun_rad_s,
        engine.cut_above_rad_s,
        engine.fuel_back_rad_s,
    ]
    .map(rpm);
    let cut = if overrun <= none {
        "never"
    } else {
        "only in part"
    };
    (overrun < all).then(|| {
        format!(
            "the box keeps the engine at {overrun:.0} rpm in overrun (transmission.cvt.ratio.overrun_rpm); all fuel is cut above {all:.0} rpm, none below {none:.0} rpm (engine.fuel): it is {cut} cut"
        )
    })
}
