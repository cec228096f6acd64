//! Fuel cut in overrun.
//!
//! | label | statement | known from |
//! |---|---|---|
//! | CL-5 | overrun: a second, and the one before, in which the wheels give more than 3 % of the rated power (without a car: the car loses more than 0.7 m/s2), engine above 1.1 warm idle, road speed above 5 km/h; cut where the flow is below a tenth of that at idle | ASSUMED: more than an engine drags (1.0 to 1.5 bar), so that it needs no fuel |
//! | CL-6 | fuel comes back between the engine speeds of the last second of a cut and the next one with fuel while the wheels give power: with a tenth of the flow at idle (cut ends), with 70 % of it (fuel is back) | derived: a threshold lies between them |
//! | CL-7 | coolant from which fuel is cut: the one that parts overrun without a cut from overrun with one, fewest seconds of either on the wrong side, engine above CL-6 | definition |

use super::idle::{FEWEST, seconds};
use super::resample::{Estimate, between, estimate, quantile};
use super::seconds::Second;
use super::{Found, Value};

/// Share of the flow at idle below which fuel is cut (CL-5).
const CUT_SHARE: f64 = 0.1;
/// Share of it from which all of it is back.
const BACK_SHARE: f64 = 0.7;
/// Fewest events of a threshold.
const FEWEST_EVENTS: usize = 4;
/// Width of the band in which fuel comes back where both ends are one, rpm.
const LEAST_BAND_RPM: f64 = 20.0;

/// True in overrun (CL-5).
fn overruns(own: &Second, idle_rpm: f64) -> bool {
    let pulled = match own.share {
        Some(share) => share < -3.0,
        None => own.accel() < -0.7,
    };
    pulled && own.kmh() > 5.0 && own.rpm.is_some_and(|rpm| rpm > 1.1 * idle_rpm) // CL-5
}

pub fn find(found: &mut Found) {
    let has_fuel = found.seconds.iter().any(|own| own.fuel_g_s.is_some());
    let (Some(idle_rpm), true) = (found.value("idle, warm"), has_fuel) else {
        return;
    };
    let Some(idle_g_s) = found.value("flow at warm idle").filter(|flow| *flow > 0.0) else {
        found.cannot("fuel cut: there is no flow of a warm car at rest to compare with");
        return;
    };
    let pairs: Vec<[Second; 2]> = found
        .seconds
        .windows(2)
        .filter(|pair| pair[1].follows(&pair[0]))
        .map(|pair| [pair[0], pair[1]])
        .collect();
    let is_cut = |own: &Second| own.fuel_g_s.map(|flow| flow < CUT_SHARE * idle_g_s);
    let in_overrun: Vec<&Second> = pairs
        .iter()
        .filter(|pair| pair.iter().all(|own| overruns(own, idle_rpm)))
        .map(|pair| &pair[1])
        .collect();
    let flags: Vec<(usize, f64)> = in_overrun
        .iter()
        .filter(|own| own.is_warm())
        .filter_map(|own| Some((own.block, if is_cut(own)? { 100.0 } else { 0.0 })))
        .collect();
    if flags.len() < FEWEST {
        found.cannot(format!(
            "fuel cut: {} of warm overrun",
            seconds(flags.len())
        ));
        return;
    }
    let mean = |list: &mut [f64]| Some(list.iter().sum::<f64>() / list.len() as f64);
    let Some(share) = estimate(&flags, mean) else {
        return;
    };
    found.add(Value::of_seconds(
        "fuel cut in overrun",
        None,
        "CL-5",
        "% of time",
        share,
    ));
    if share.value < 1.0 {
        found.findings.doubts.push(
            "fuel is never cut in overrun: is the channel of the fuel a flow of that second, or one that is made of air and load?".to_owned(),
        );
        return;
    }
    if let Some(cut_rpm) = ends(found, &pairs, idle_g_s) {
        from_coolant(found, &in_overrun, cut_rpm, &is_cut);
    }
}

/// An engine speed from the ends of cuts (CL-6).
fn of_ends(name: &'static str, key: &'static str, own: Estimate) -> Value {
    Value {
        counted: "ends",
        ..Value::of_seconds(name, Some(key), "CL-6", "rpm", own)
    }
}

/// Engine speeds between which a flow of so much is back (CL-6).
fn backs(pairs: &[[Second; 2]], idle_g_s: f64, level: f64) -> Vec<[f64; 2]> {
    let is_cut = |own: &Second| own.fuel_g_s.map(|flow| flow < CUT_SHARE * idle_g_s);
    let mut list = Vec::new();
    let mut cut: Option<Second> = None;
    for [before, own] in pairs {
        if is_cut(before) == Some(true) && before.is_warm() {
            cut = Some(*before);
        }
        let flow = own.fuel_g_s.unwrap_or(0.0);
        // Power again is another reason for fuel.
        let still = own.accel() < 0.0 && own.share.is_none_or(|share| share < 0.0);
        if !still {
            cut = None;
        }
        if let Some((high, low)) = cut.and_then(|cut| cut.rpm).zip(own.rpm)
            && flow >= level * idle_g_s
            && is_cut(own) == Some(false)
        {
            list.push([low, high]); // CL-6
            cut = None;
        }
    }
    list
}

/// Engine speeds at which a cut ends; that with the first fuel.
fn ends(found: &mut Found, pairs: &[[Second; 2]], idle_g_s: f64) -> Option<f64> {
    let events = |level: f64| backs(pairs, idle_g_s, level);
    let ends = events(CUT_SHARE);
    let Some(end) = between(&ends).filter(|own| own.count >= FEWEST_EVENTS) else {
        let count = match ends.len() {
            1 => "1 end".to_owned(),
            n => format!("{n} ends"),
        };
        found.cannot(format!(
            "engine speed at which fuel comes back: {count} of a cut in overrun, {FEWEST_EVENTS} are needed"
        ));
        return None;
    };
    let back = between(&events(BACK_SHARE)).filter(|own| own.count >= FEWEST_EVENTS);
    found.add(of_ends("fuel cut ends", "engine.fuel.cut_above_rpm", end));
    let mut own = back.unwrap_or(end);
    own.value = own.value.min(end.value - LEAST_BAND_RPM);
    found.add(of_ends("fuel is back", "engine.fuel.fuel_back_rpm", own));
    Some(end.value)
}

/// Coolant from which fuel is cut (CL-7).
fn from_coolant(
    found: &mut Found,
    in_overrun: &[&Second],
    cut_rpm: f64,
    is_cut: &dyn Fn(&Second) -> Option<bool>,
) {
    let fast = in_overrun
        .iter()
        .filter(|own| own.rpm.is_some_and(|rpm| rpm > cut_rpm));
    let list: Vec<(usize, (f64, bool))> = fast
        .filter_map(|own| Some((own.block, (own.coolant_degc?, is_cut(own)?))))
        .collect();
    if list.is_empty() {
        return;
    }
    let own = estimate(&list, parting); // CL-7
    let colder = |degc: f64| {
        list.iter()
            .filter(|(_, (own, is_cut))| *own < degc && !is_cut)
            .count()
    };
    match own.filter(|own| colder(own.value) >= FEWEST) {
        Some(own) => found.add(Value::of_seconds(
            "fuel cut from",
            Some("engine.fuel.cut_from_degc"),
            "CL-7",
            "degC",
            own,
        )),
        None => {
            let mut cut: Vec<f64> = list
                .iter()
                .filter(|(_, (_, is_cut))| *is_cut)
                .map(|(_, (degc, _))| *degc)
                .collect();
            let coldest = quantile(&mut cut, 0.05).map_or_else(String::new, |degc| {
                format!(
                    "; it is cut from {} degC on, the coldest of the log",
                    degc.round()
                )
            });
            found.cannot(format!(
                "coolant from which fuel is cut: there is no overrun of a colder car without a cut{coldest}"
            ));
        }
    }
}

/// The coolant that parts seconds without a cut from those with one, fewest of each on the wrong side; none where all are of one kind.
fn parting(list: &mut [(f64, bool)]) -> Option<f64> {
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    let uncut = list.iter().filter(|(_, is_cut)| !is_cut).count();
    if uncut == 0 || uncut == list.len() {
        return None;
    }
    // Below the first all are cut: those without a cut are on the wrong side.
    let (mut wrong, mut best) = (uncut, (uncut, 0));
    for (k, (_, is_cut)) in list.iter().enumerate() {
        wrong = if *is_cut { wrong + 1 } else { wrong - 1 };
        if wrong < best.0 {
            best = (wrong, k + 1);
        }
    }
    let at = |k: usize| list.get(k).map(|own| own.0);
    match best.1 {
        0 => None,
        k => at(k - 1).map(|below| 0.5 * (below + at(k).unwrap_or(below))),
    }
}
