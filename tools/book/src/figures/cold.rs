//! Table of cold losses: each component at four oil temperatures, with its basis and its bound.

use super::reference::RPM;
use cvtcycle::config::setup::{Options, Setup, load};
use cvtcycle::config::{Override, render};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::prime_mover::PrimeMover;
use cvtcycle::model::rig::{Bench, BenchPoint};
use cvtcycle::output::Component;
use std::fmt::Write as _;

/// Temperatures of oil, belt and engine, degC.
const AT: [f64; 4] = [25.0, 0.0, -10.0, -30.0];
const SPEED: f64 = 2000.0 * RPM;

/// Overrides that remove the bounds.
const UNBOUND_CVT: [&str; 4] = [
    "transmission.cvt.final_drive.bearing_heating_w=1e9",
    "transmission.cvt.input_shaft.film_heating_w=1e9",
    "transmission.cvt.pump.film_heating_w=1e9",
    "transmission.cvt.pump.inlet_bar_per_l_min=0",
];
const UNBOUND_MANUAL: [&str; 1] = ["transmission.manual.gears.bearing_heating_w=1e9"];

/// Line of the table.
struct Line {
    name: &'static str,
    parts: &'static [Component],
    /// True if the belt is still as cold as the sump, instead of in steady state above it.
    soaked: bool,
    carries: &'static str,
    bounds: &'static str,
    measured: &'static str,
}

const fn line(
    name: &'static str,
    parts: &'static [Component],
    carries: &'static str,
    bounds: &'static str,
    measured: &'static str,
) -> Line {
    Line {
        name,
        parts,
        soaked: false,
        carries,
        bounds,
        measured,
    }
}

const FEW: &str = "25 to 95 degC; a few totals from -5 to 10";
const NEVER: &str = "not in the thesis; hot class values";

const CVT: [Line; 8] = [
    line(
        "bands",
        &[Component::BeltBand],
        "friction that rises with belt temperature (LU-4)",
        "its fall with temperature, and the film that carries (LU-5)",
        FEW,
    ),
    line(
        "film between the bands",
        &[Component::BeltFilm],
        "viscosity at belt temperature (FI-1)",
        "its thickness (FI-2), its heat (FH-1), the belt's own warming",
        "never by itself",
    ),
    Line {
        soaked: true,
        ..line(
            "the same, belt still as cold as the sump",
            &[Component::BeltFilm],
            "as above, first seconds of a soak",
            "lasts until the belt is warm",
            "never",
        )
    },
    line(
        "slip, wedging, penetration",
        &[
            Component::BeltSlip,
            Component::BeltWedge,
            Component::BeltPenetration,
        ],
        "pressure (PC-1), no viscosity",
        "pressure cap",
        FEW,
    ),
    line(
        "pump",
        &[Component::Pump],
        "pressure, and viscosity (PU-1)",
        "heat of its gaps (FH-1); flow by its inlet (PU-5)",
        FEW,
    ),
    line(
        "input shaft",
        &[Component::InputShaft],
        "power of viscosity (IS-1)",
        "heat of its films (FH-1)",
        FEW,
    ),
    line(
        "reverse clutch",
        &[Component::ClutchDrag],
        "nothing: at its cap (CD-1)",
        "`cap_nm`: the film between plates ruptures",
        "about 0.5 Nm below 25 degC",
    ),
    line(
        "final drive",
        &[Component::FinalDrive],
        "power 2/3 of viscosity and speed in its bearings (BR-1)",
        "heat of their films (FH-1)",
        FEW,
    ),
];

const MANUAL: [Line; 3] = [
    line(
        "manual: bearings",
        &[Component::Bearing],
        "power 2/3 of viscosity and speed (BR-1)",
        "heat of their films (FH-1)",
        NEVER,
    ),
    line(
        "manual: churning",
        &[Component::Churning],
        "power 0.21 of viscosity (CH-1)",
        "the small power: the sump itself is sheared",
        NEVER,
    ),
    line(
        "manual: seals",
        &[Component::Seal],
        "nothing (LS-1)",
        "lips rub, whatever the oil",
        NEVER,
    ),
];

fn car(name: &str, sets: &[&str]) -> Result<Setup, String> {
    let set = Override::parse_all(sets).map_err(|problems| render(&problems, false))?;
    load(
        name,
        &Options {
            set,
            ..Options::default()
        },
    )
    .map_err(|problems| render(&problems, false))
}

/// Bench point in overdrive or fifth gear at 2000 rpm without load.
fn point(ratio: f64, degc: f64, soaked: bool) -> BenchPoint {
    let sump_k = degc + ZERO_DEGC_K;
    BenchPoint {
        ratio,
        input_rad_s: SPEED,
        sump_k,
        belt_k: soaked.then_some(sump_k),
        ..BenchPoint::default()
    }
}

/// Lines of one car at its `ratio`, with the sum of those that are not soaked.
fn lines(
    text: &mut String,
    name: &str,
    unbound: &[&str],
    ratio: f64,
    lines: &[Line],
) -> Result<(), String> {
    let shipped = Bench::new(&*car(name, &[])?);
    let unbound = Bench::new(&*car(name, unbound)?);
    let mut sums = [0.0; AT.len() + 1];
    for line in lines {
        let loss = |bench: &Bench, degc: f64| {
            let answer = bench.solve(&point(ratio, degc, line.soaked));
            line.parts
                .iter()
                .map(|part| answer.part_nm(*part))
                .sum::<f64>()
        };
        let _ = write!(
            text,
            "| {} | {} | {} |",
            line.name, line.carries, line.bounds
        );
        let last = loss(&unbound, AT[AT.len() - 1]);
        for (sum, nm) in sums.iter_mut().zip(
            AT.map(|degc| loss(&shipped, degc))
                .into_iter()
                .chain([last]),
        ) {
            let _ = write!(text, " {nm:.2} |");
            *sum += if line.soaked { 0.0 } else { nm };
        }
        let _ = writeln!(text, " {} |", line.measured);
    }
    let total = if name.ends_with("cvt") {
        "CVT, all of these"
    } else {
        "manual, all of these"
    };
    let cells: Vec<String> = sums.iter().map(|nm| format!("{nm:.2}")).collect();
    let _ = writeln!(text, "| {total} | | | {} | |", cells.join(" | "));
    Ok(())
}

/// Writes the table.
pub fn table() -> Result<String, String> {
    let mut text = "<!-- Written by `tools/docs` from the bench at 2000 rpm without load. -->\n\n\
        | part | what carries it below 25 degC | what bounds it | 25 degC | 0 degC | -10 degC | -30 degC | -30 degC without FH-1, PU-5 | measured |\n\
        |---|---|---|---|---|---|---|---|---|\n"
        .to_owned();
    let cvt = car("rover_216_cvt", &[])?;
    let high = match cvt.transmission() {
        cvtcycle::model::transmission::Transmission::Cvt(cvt) => cvt.ratio.high,
        cvtcycle::model::transmission::Transmission::Manual(_) => unreachable!("the car has a CVT"),
    };
    lines(&mut text, "rover_216_cvt", &UNBOUND_CVT, high, &CVT)?;
    lines(&mut text, "rover_216_5mt", &UNBOUND_MANUAL, 5.0, &MANUAL)?;
    let car = cvt.car(ZERO_DEGC_K);
    let drag = AT.map(|degc| {
        let k = degc + ZERO_DEGC_K;
        format!(
            "{:.1}",
            car.engine.at(k, k, &car.engine_oil, 1.0).drag_nm(SPEED)
        )
    });
    let _ = writeln!(
        text,
        "| engine friction, for comparison | the published power of temperature (EN-2) | a power of temperature, not of viscosity | {} | {} | never |",
        drag.join(" | "),
        drag[AT.len() - 1]
    );
    Ok(text)
}
