//! Likely slips in the values of a car, though each is within its range: `new`, `check` and `run` have the same sentences.
//!
//! The limits leave every shipped car and every class without a doubt. Power over displacement has wide ones: the mean of the 257 midsize
//! cars of a class, turbo engines among them, is 70 kW per litre, so that 78 is no slip.

use std::ops::RangeInclusive;

use super::Setup;
use cvtcycle_model::engine::FuelModel;
use cvtcycle_model::keys::rpm;
use cvtcycle_model::lubricant::Lubricant;
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::variator::{
    BeltAtRatio, BeltLoad, Geometry, belt_capacity_nm,
};

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
/// Greatest one.
const MOST_SPAN: f64 = 9.0;
/// Greatest road load at 80 km/h over mass, N/kg: the mean of the classes and four standard deviations.
const MOST_N_KG: f64 = 0.36;
/// Keys of the road load.
const COEFFICIENTS: [&str; 3] = [
    "road_load.form.coefficients.f0_n",
    "road_load.form.coefficients.f1_n_per_kmh",
    "road_load.form.coefficients.f2_n_per_kmh2",
];
/// Highest torque over displacement, Nm/l.
const NM_PER_LITRE: RangeInclusive<f64> = 60.0..=230.0;
/// Torque over displacement above which, in Nm/l, and speed of the greatest power below which, in rpm, an engine is a diesel.
const DIESEL: (f64, f64) = (110.0, 4500.0);
/// Density of the fuel from which it is that of a diesel, kg/m3.
const DIESEL_FUEL_KG_M3: f64 = 800.0;
/// Full load over the load up to which a Willans line was fitted, from which it is doubted.
const BEYOND_FIT: f64 = 1.25;
/// Mean effective pressure that no engine reaches without a charger, bar.
const CHARGED_BAR: f64 = 15.0;
/// Idle speeds of warm engines, rpm.
const IDLE_RPM: RangeInclusive<f64> = 500.0..=1100.0;
/// Dynamic radii of wheels, mm.
const WHEEL_MM: RangeInclusive<f64> = 240.0..=400.0;
/// Engine speeds at 100 km/h in the highest gear, rpm.
const TOP_RPM: RangeInclusive<f64> = 1200.0..=4500.0;
/// Stall speeds of torque converters, rpm.
const STALL_RPM: RangeInclusive<f64> = 1500.0..=3200.0;
/// Least running radius of a belt, m.
const LEAST_RADIUS_M: f64 = 0.025;
/// Engine speed at 80 km/h in top below which a CVT's reduction is not whole, rpm: 129 US cars of 2010 to 2019 have 1044 to 1675.
const LEAST_80_RPM: f64 = 1000.0;
/// A warm box, K, and a slow belt, rad/s, at which its grip is looked at.
pub(super) const WARM_K: f64 = 353.15;
const SLOW_RAD_S: f64 = 100.0;

/// The doubts about a car, a sentence each.
pub(super) fn doubts(setup: &Setup) -> Vec<String> {
    let all = [
        of_road_load(setup),
        mass_doubt(setup),
        size_doubt(setup),
        of_full_load(setup),
        torque_doubt(setup),
        range_doubt(setup),
        idle_doubt(setup),
        wheel_doubt(setup),
        of_top_gear(setup),
        stall_doubt(setup),
    ];
    let of_fuel = fuel_map_doubts(setup);
    let of_box = match setup.transmission() {
        Transmission::Cvt(cvt) => [
            span_doubt(cvt),
            overrun_doubt(setup, cvt),
            radius_doubt(cvt),
            grip_doubt(setup, cvt),
            pump_doubt(setup, cvt),
            ratio_doubt(setup, cvt),
        ],
        Transmission::Manual(_) => [None, None, None, None, None, None],
    };
    // Doubts about a measured map are first: every number depends on it.
    let [.., ratio] = &of_box;
    let first = ratio.iter().cloned().chain(of_fuel);
    let others = all.into_iter().chain(of_box.clone().into_iter().take(5));
    let of_oil = super::contacts::doubts(setup.vehicle.oils().0, &setup.keys);
    first.chain(others.flatten()).chain(of_oil).collect()
}

/// Doubts about the points of a measured map of fuel, a sentence each.
fn fuel_map_doubts(setup: &Setup) -> Vec<String> {
    let engine = setup.engine();
    match &engine.fuel {
        FuelModel::Map(map) => map.judge(|speed| engine.full_load_pa(speed)).doubts,
        FuelModel::Willans(_) => Vec::new(),
    }
}

/// Difference of the ends of two ranges of ratios, as sum of the logarithms, from which the nearer one is the right one. ASSUMED.
const RANGE_FITS: f64 = 0.25;
/// Loss in the highest ratio over that in low, at slow speed and high torque, from which the ratio is likely the other way round. ASSUMED: the
/// models of the Rover have 0.91 with the same points, the measured box of a Subaru Justy (ADVISOR, TX_CVT50_SUBARU) 0.6.
const LOSES_MORE: f64 = 1.1;

/// A map of the whole box whose ratio is likely output over input: its range fits that of the box better the other way round, or it loses more in
/// overdrive than in low where torque and not speed makes the losses (the primary's small radius in low needs the greatest clamping force for a torque).
fn ratio_doubt(setup: &Setup, cvt: &Cvt) -> Option<String> {
    const KEY: &str = "transmission.cvt.maps.ratio_is";
    let mut keys = setup.keys.iter();
    let is_said = keys.any(|info| info.key == KEY && info.status != "default");
    let mut maps = setup.transmission().maps();
    let (_, map) = maps.find(|(component, _)| *component == Component::BoxMap)?;
    let axes = map.grid().axes();
    let (Some(&least), Some(&most)) = (axes[0].first(), axes[0].last()) else {
        return None;
    };
    if is_said || most - least <= 0.0 {
        return None;
    }
    let misfit =
        |low: f64, high: f64| (low / cvt.ratio.low).ln().abs() + (high / cvt.ratio.high).ln().abs();
    let range = [misfit(most, least), misfit(1.0 / least, 1.0 / most)];
    let by_range = range[1] + RANGE_FITS < range[0];
    let losses = slow_losses(map);
    let by_loss = least < 1.0 / STRADDLES && most > STRADDLES && losses[1] > LOSES_MORE * losses[0];
    let why = match (by_range, by_loss) {
        (true, _) => format!(
            "that of the belt from {:.2} to {:.2}, and turned over it would fit better",
            cvt.ratio.high, cvt.ratio.low
        ),
        (false, true) => format!(
            "and at slow speed and high torque it loses {:.0} % more at the low end than at the high one, where a belt needs the greatest force",
            100.0 * (losses[1] / losses[0] - 1.0)
        ),
        (false, false) => return None,
    };
    Some(format!(
        "the ratio of the map of the whole box goes from {least:.2} to {most:.2}, {why}: is it output over input? Then write ratio_is = \"output_over_input\" next to the map, or name the column speed_ratio; if it is not, ratio_is = \"input_over_output\""
    ))
}

/// How far both ends of a range are beyond 1 at least, so that they can be compared.
const STRADDLES: f64 = 1.3;

/// Mean loss of a map of the whole box at its highest and at its lowest ratio, over its slower speeds and higher torques, Nm.
fn slow_losses(map: &LossMap) -> [f64; 2] {
    let axes = map.grid().axes();
    let (speeds, torques) = (&axes[1], &axes[2]);
    let middle = 0.5 * (speeds[0] + speeds[speeds.len() - 1]);
    let high = 0.5 * torques[torques.len() - 1];
    let at = |ratio: f64| {
        let slow = speeds.iter().filter(|speed| **speed <= middle);
        let points = slow.flat_map(|speed| {
            let loaded = torques
                .iter()
                .filter(|torque| **torque >= high && high > 0.0);
            loaded.map(move |torque| [ratio, *speed, *torque, axes[3][0], axes[4][0]])
        });
        let losses: Vec<f64> = points.map(|x| map.grid().at(x).0).collect();
        losses.iter().sum::<f64>() / losses.len().max(1) as f64
    };
    let (least, most) = (axes[0][0], axes[0][axes[0].len() - 1]);
    [at(most), at(least)]
}

/// True if a value is that of a class or of another car.
fn is_inherited(setup: &Setup, key: &str) -> bool {
    let mut keys = setup.keys.iter();
    keys.any(|info| info.key == key && ["class", "like"].contains(&info.status.as_str()))
}

fn of_road_load(setup: &Setup) -> Option<String> {
    let base = &setup.road_load.base;
    let v = 80.0 / 3.6;
    let force_n = base.f0_n + (base.f1_n_per_m_s + base.f2_n_per_m_s2 * v) * v;
    let per_kg = force_n / base.mass_kg;
    let of_class = "of cars of the classes 0.22 to 0.28 N per kg";
    if per_kg < LEAST_N_KG {
        // Who gave no coefficient cannot have mistaken its unit.
        let is_by_mass = COEFFICIENTS.iter().all(|key| is_inherited(setup, key));
        return match (is_by_mass, base.mass_kg > MOST_KG) {
            (true, true) => None,
            (true, false) => Some(format!(
                "the road load is {force_n:.0} N at 80 km/h for {:.0} kg, {of_class}: is the mass in lb?",
                base.mass_kg
            )),
            (false, _) => Some(format!(
                "the road load is {force_n:.0} N at 80 km/h, {of_class}: are the coefficients in lbf?"
            )),
        };
    }
    (per_kg > MOST_N_KG).then(|| {
        format!(
            "the road load is {force_n:.0} N at 80 km/h, {per_kg:.2} N per kg, {of_class}: check coefficients and mass, and their units"
        )
    })
}

/// Full load beyond what the fuel model was made from, or beyond the point at which a Willans line turns.
fn range_doubt(setup: &Setup) -> Option<String> {
    let engine = setup.engine();
    let limit_bar = |rad_s: f64| match &engine.fuel {
        FuelModel::Willans(line) => {
            let v = engine.piston_m_s(rad_s);
            let b = line.efficiency(v);
            let turn_bar = -0.25 * b * b / line.a2 - (line.l + line.l2 * v * v);
            let fitted_bar = engine.fitted_pa.map(|fitted| BEYOND_FIT * fitted / 1e5);
            fitted_bar.map_or(turn_bar, |fitted_bar| turn_bar.min(fitted_bar))
        }
        FuelModel::Map(map) => map.bmep_pa.last().map_or(0.0, |pa| pa / 1e5),
    };
    let highest_nm = engine.full_load.points().map(|(_, nm)| nm);
    let per_litre = highest_nm.fold(0.0, f64::max) / (engine.displacement_m3 * 1e3);
    if !NM_PER_LITRE.contains(&per_litre) {
        return None; // then displacement or torque is doubted
    }
    let points = engine.full_load.points();
    let over = |(rad_s, nm): (f64, f64)| {
        let bar = engine.mep_pa(nm) / 1e5;
        (bar, limit_bar(rad_s), rpm(rad_s))
    };
    let (bar, limit, at_rpm) = points
        .map(over)
        .max_by(|a, b| (a.0 - a.1).total_cmp(&(b.0 - b.1)))?;
    let (model, made_bar) = match &engine.fuel {
        FuelModel::Willans(_) => ("Willans line", engine.fitted_pa.map_or(0.0, |pa| pa / 1e5)),
        FuelModel::Map(_) => ("map of fuel", limit),
    };
    let advice = match made_bar > CHARGED_BAR {
        true => "it is one of charged engines: check displacement, power, torque and their speeds",
        false => "a turbo or diesel engine has its own (`cvtcycle list classes`)",
    };
    (bar > limit).then(|| {
        format!(
            "full load is {bar:.1} bar at {at_rpm:.0} rpm, and the engine's {model} holds up to {limit:.1} bar: {advice}"
        )
    })
}

/// Highest torque over displacement, and what looks like a diesel with the fuel of a petrol engine.
fn torque_doubt(setup: &Setup) -> Option<String> {
    let engine = setup.engine();
    let points = || engine.full_load.points();
    let highest_nm = points().map(|(_, nm)| nm).fold(0.0, f64::max);
    let per_litre = highest_nm / (engine.displacement_m3 * 1e3);
    if !NM_PER_LITRE.contains(&per_litre) {
        return Some(format!(
            "the engine has {per_litre:.0} Nm per litre, engines 60 to 230: check displacement and torque, and their units"
        ));
    }
    let at_most = points().max_by(|a, b| (a.0 * a.1).total_cmp(&(b.0 * b.1)));
    let rated_rpm = at_most.map_or(f64::NAN, |(rad_s, _)| rpm(rad_s));
    let burns_petrol = engine.fuel_density_kg_m3 < DIESEL_FUEL_KG_M3;
    (burns_petrol && per_litre > DIESEL.0 && rated_rpm < DIESEL.1).then(|| {
        format!(
            "{per_litre:.0} Nm per litre with the greatest power at {rated_rpm:.0} rpm are those of a diesel: the engine is one with spark ignition, and its fuel would be wrong (the class `engine_diesel_2015` is one)"
        )
    })
}

fn idle_doubt(setup: &Setup) -> Option<String> {
    let idle_rpm = rpm(setup.engine().idle_hot_rad_s);
    (!IDLE_RPM.contains(&idle_rpm)).then(|| {
        format!("the warm engine idles at {idle_rpm:.0} rpm, engines of cars at 500 to 1100 rpm")
    })
}

fn wheel_doubt(setup: &Setup) -> Option<String> {
    let radius_mm = 1e3 * setup.road_load.base.wheel_radius_m;
    (!WHEEL_MM.contains(&radius_mm)).then(|| {
        format!("the wheels roll on {radius_mm:.0} mm, those of cars on 240 to 400 mm: is it the radius, in the unit of its key?")
    })
}

fn of_top_gear(setup: &Setup) -> Option<String> {
    let overall = match setup.transmission() {
        Transmission::Cvt(cvt) => cvt.ratio.high * cvt.final_drive.ratio,
        Transmission::Manual(manual) => *manual.overall.last()?,
    };
    let at_100_rpm = rpm(100.0 / 3.6 / setup.road_load.base.wheel_radius_m * overall);
    let at_80_rpm = 0.8 * at_100_rpm;
    if setup.transmission().is_cvt() && at_80_rpm < LEAST_80_RPM {
        return Some(format!(
            "in the highest ratio the engine turns at {at_80_rpm:.0} rpm at 80 km/h, in cars with a CVT at 1044 to 1675 rpm: an axle ratio is often not the whole reduction; give engine over road speed (n-over-v of a new car)"
        ));
    }
    (!TOP_RPM.contains(&at_100_rpm)).then(|| {
        format!(
            "in the highest gear the engine turns at {at_100_rpm:.0} rpm at 100 km/h, in cars at 1200 to 4500 rpm: check the final drive, the highest ratio and the wheels"
        )
    })
}

/// Speed at which full load holds the engine against a converter at rest, rad/s; none of a friction clutch.
fn stall_rad_s(setup: &Setup) -> Option<f64> {
    let coupling = setup.transmission().coupling();
    if !coupling.by_command() {
        return None; // a friction clutch has none
    }
    let engine = setup.engine();
    let taken_nm = |speed: f64| {
        let creep_nm = coupling.creep_nm(0.0, speed);
        coupling.engine_side(creep_nm, 0.0, speed).engine_nm
    };
    let (mut low, mut high) = (engine.idle_hot_rad_s, 2.0 * engine.highest_rad_s);
    // Without creep at idle speed the box is in neutral there, and says nothing of stall.
    if taken_nm(high) <= 0.0 {
        return None;
    }
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        match taken_nm(middle) < engine.full_load.at(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(low)
}

fn stall_doubt(setup: &Setup) -> Option<String> {
    let stall_rpm = rpm(stall_rad_s(setup)?);
    (!STALL_RPM.contains(&stall_rpm)).then(|| {
        format!("full load stalls the converter at {stall_rpm:.0} rpm, those of cars at 1500 to 3200 rpm: check its capacity")
    })
}

/// Least running radius of the belt at the ends of the ratio.
fn radius_doubt(cvt: &Cvt) -> Option<String> {
    let belt = &cvt.belt;
    let at = |ratio: f64| Geometry::new(ratio, belt.centre_distance_m, belt.length_m);
    let least_m = (at(cvt.ratio.low).primary_radius_m).min(at(cvt.ratio.high).secondary_radius_m);
    (least_m < LEAST_RADIUS_M).then(|| {
        format!(
            "the belt runs down to a radius of {:.1} mm, belts to 25 to 35 mm: check its length, the centre distance and the ratio limits",
            1e3 * least_m
        )
    })
}

/// Torque of the primary that a clamping force, N, grips in low, Nm.
pub(super) fn gripped_nm(cvt: &Cvt, oil: &Lubricant, secondary_clamp_n: f64) -> f64 {
    let at = BeltAtRatio::new(&cvt.belt, cvt.ratio.low);
    let load = BeltLoad {
        secondary_clamp_n,
        ..BeltLoad::turning(&cvt.belt, oil, WARM_K, cvt.ratio.low, SLOW_RAD_S)
    };
    belt_capacity_nm(&cvt.belt, &at, &load) / cvt.ratio.low
}

/// The pump's flow at idle against what creeps, and at the speed of stall against full load.
fn pump_doubt(setup: &Setup, cvt: &Cvt) -> Option<String> {
    let (oil, engine) = (setup.car(WARM_K).oil, setup.engine());
    let now = cvt.pump.at(oil.dynamic_pa_s(WARM_K));
    let idle = engine.idle_hot_rad_s;
    let mut duties = vec![("idle", idle, cvt.coupling.creep_nm(0.0, idle))];
    if let Some(stall) = stall_rad_s(setup) {
        duties.push(("stall", stall, cvt.coupling.creep_nm(0.0, stall)));
    }
    duties.into_iter().find_map(|(of, rad_s, nm)| {
        let held_pa = cvt.pump.deliverable_pa(&now, rad_s, 0.0);
        let pa = held_pa.min(cvt.cap_pa);
        let gripped = gripped_nm(cvt, &oil, cvt.secondary_clamp_n(pa, 0.0));
        (held_pa < cvt.cap_pa && gripped < nm).then(|| {
            format!(
                "the pump is too small: at {of}, {:.0} rpm, it holds {:.0} bar in warm oil, which grip {gripped:.0} of {nm:.0} Nm in low: check pump.displacement_cc_rev",
                rpm(rad_s),
                pa / 1e5
            )
        })
    })
}

/// Highest torque of the engine in low against what the largest pressure grips.
fn grip_doubt(setup: &Setup, cvt: &Cvt) -> Option<String> {
    let oil = setup.car(WARM_K).oil;
    let gripped_nm = gripped_nm(cvt, &oil, cvt.secondary_clamp_n(cvt.cap_pa, 0.0));
    let points = setup.engine().full_load.points();
    let highest_nm = points.map(|(_, nm)| nm).fold(0.0, f64::max);
    (gripped_nm < highest_nm).then(|| {
        format!(
            "the belt slips at full load: {:.0} bar grip {gripped_nm:.0} Nm of the engine in low, and it has {highest_nm:.0} Nm: check pressure.cap_bar and secondary_piston_cm2",
            cvt.cap_pa / 1e5
        )
    })
}

fn mass_doubt(setup: &Setup) -> Option<String> {
    let mass_kg = setup.road_load.base.mass_kg;
    (mass_kg > MOST_KG).then(|| format!("the mass is {mass_kg:.0} kg: is it in lb?"))
}

fn size_doubt(setup: &Setup) -> Option<String> {
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

fn span_doubt(cvt: &Cvt) -> Option<String> {
    let (low, high) = (cvt.ratio.low, cvt.ratio.high);
    if low > MOST_SPAN * high {
        return Some(format!(
            "the belt's ratio goes from {low} to {high}, a span of {:.2}; that of cars is up to 8: check both ends",
            low / high
        ));
    }
    (low < LEAST_SPAN * high).then(|| {
        format!(
            "the belt's ratio goes from {low} to {high}, a span of {:.2}; that of cars is 5 and more: is one end that of the other?",
            low / high
        )
    })
}

fn overrun_doubt(setup: &Setup, cvt: &Cvt) -> Option<String> {
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
