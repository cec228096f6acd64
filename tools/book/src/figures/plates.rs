//! Sketches with numbers of the shipped files: fluids on the axes of their law, thermal network.

use super::reference::Reference;
use crate::sketch::Anchor::{End, Middle, Start};
use crate::sketch::{Sketch, colour};
use cvtcycle::config::render;
use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::{Kind, load_lubricant};
use cvtcycle::model::lubricant::{Lubricant, ZERO_DEGC_K};

/// Figures by file name.
/// # Errors
/// A sentence, if a fluid cannot be read or a number of the network has no key.
pub fn figures(r: &Reference) -> Result<Vec<(&'static str, String)>, String> {
    Ok(vec![
        ("lubricant_viscosity", viscosity()?),
        ("thermal_network", network(r)?),
    ])
}

/// Colour and dashes of a line, one for each fluid.
const LINES: [(&str, &str); 8] = [
    (colour::INK, ""),
    (colour::FORCE, ""),
    (colour::BLUE, ""),
    (colour::GREEN, ""),
    (colour::FORCE, "6 4"),
    (colour::BLUE, "6 4"),
    (colour::GREEN, "6 4"),
    (colour::INK, "6 4"),
];
/// Corners of the axes, pixels: left, right, bottom, top.
const AXES: [f64; 4] = [52.0, 388.0, 330.0, 34.0];
const DEGC: [f64; 2] = [-40.0, 120.0];
const NU: [f64; 2] = [3.0, 20_000.0];

/// Place of a temperature and a viscosity, mm2/s, on axes where LU-1 is a straight line.
fn place(degc: f64, nu: f64) -> (f64, f64) {
    let [left, right, bottom, top] = AXES;
    let x = |degc: f64| (degc + ZERO_DEGC_K).ln();
    let y = |nu: f64| (nu + 0.7).ln().ln();
    let share = |at: f64, [from, to]: [f64; 2]| (at - from) / (to - from);
    (
        left + (right - left) * share(x(degc), DEGC.map(x)),
        bottom + (top - bottom) * share(y(nu), NU.map(y)),
    )
}

/// Shipped fluids, of those with one line the first.
fn fluids() -> Result<Vec<(&'static str, Lubricant)>, String> {
    let mut fluids: Vec<(&'static str, Lubricant)> = Vec::new();
    for name in Kind::Lubricant.names() {
        let (oil, _) = load_lubricant(name).map_err(|problems| render(&problems, false))?;
        let line = |oil: &Lubricant| {
            [40.0, 100.0].map(|degc| oil.kinematic_m2_s(degc + ZERO_DEGC_K).to_bits())
        };
        if fluids.iter().all(|(_, other)| line(other) != line(&oil)) {
            fluids.push((name, oil));
        }
    }
    Ok(fluids)
}

fn viscosity() -> Result<String, String> {
    let mut s = Sketch::new(400.0, 466.0);
    let head = "Kinematic viscosity [mm²/s] on the axes of ASTM D341";
    s.text((8.0, 18.0), Start, 13.0, colour::QUIET, head);
    for degc in [-40.0, -20.0, 0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0] {
        let (x, _) = place(degc, NU[0]);
        s.line(&[(x, AXES[2]), (x, AXES[3])], colour::GRID, 1.0, "");
        let words = format!("{degc:.0}").replace('-', "\u{2212}");
        s.text((x, AXES[2] + 17.0), Middle, 12.0, colour::INK, &words);
    }
    for nu in [3.0, 5.0, 10.0, 20.0, 50.0, 100.0, 1000.0, 10_000.0] {
        let (_, y) = place(0.0, nu);
        s.line(&[(AXES[0], y), (AXES[1], y)], colour::GRID, 1.0, "");
        s.text(
            (AXES[0] - 5.0, y + 4.0),
            End,
            12.0,
            colour::INK,
            &format!("{nu:.0}"),
        );
    }
    let foot = "Temperature [°C], as ln $T$; upward ln ln ($ν$ + 0.7)";
    s.text(
        (0.5 * (AXES[0] + AXES[1]), AXES[2] + 35.0),
        Middle,
        12.0,
        colour::QUIET,
        foot,
    );
    for (k, (name, oil)) in fluids()?.iter().enumerate() {
        let (ink, dash) = LINES[k % LINES.len()];
        let nu = |degc: f64| 1e6 * oil.kinematic_m2_s(degc + ZERO_DEGC_K);
        let points: Vec<(f64, f64)> = (0..=160)
            .map(|i| DEGC[0] + f64::from(i))
            .filter(|t| (NU[0]..=NU[1]).contains(&nu(*t)))
            .map(|t| place(t, nu(t)))
            .collect();
        s.line(&points, ink, 1.8, dash);
        for degc in [40.0, 100.0] {
            s.dot(place(degc, nu(degc)), 2.6, ink);
        }
        let (x, y) = (8.0 + 196.0 * (k % 2) as f64, 392.0 + 20.0 * (k / 2) as f64);
        s.line(&[(x, y - 4.0), (x + 26.0, y - 4.0)], ink, 1.8, dash);
        s.text((x + 32.0, y), Start, 12.0, colour::INK, name);
    }
    Ok(s.finish(
        "Viscosity of the shipped fluids on the axes of ASTM D341",
        "Kinematic viscosity of the shipped fluids against temperature: straight lines through the two values of the data sheet, at 40 and 100 degC.",
    ))
}

/// Drawing of the network, with the name of a key in double braces in place of its value.
const NETWORK: &str = include_str!("thermal_network.svg");

fn network(r: &Reference) -> Result<String, String> {
    let mut svg = String::with_capacity(NETWORK.len());
    let mut rest = NETWORK;
    while let Some((before, after)) = rest.split_once("{{") {
        let (key, behind) = after.split_once("}}").ok_or("a brace without end")?;
        svg.push_str(before);
        svg.push_str(&number(r, key)?);
        rest = behind;
    }
    svg.push_str(rest);
    Ok(svg)
}

fn number(r: &Reference, key: &str) -> Result<String, String> {
    if key == "oil_kj_k" {
        // The sump's heat capacity is computed from its volume.
        let (oil, k) = (r.oil(), 20.0 + ZERO_DEGC_K);
        let litres: f64 = number_of(r, "thermal.transmission.oil_l")?;
        let kj_k = 1e-6 * litres * oil.density_kg_m3(k) * oil.heat_capacity_j_kgk(k);
        return Ok(format!("{litres} l: {kj_k:.1} kJ/K"));
    }
    let info = r.cvt_car.keys.iter().find(|info| info.key == key);
    info.map(value)
        .ok_or_else(|| format!("thermal_network.svg: the car has no key {key}"))
}

fn number_of(r: &Reference, key: &str) -> Result<f64, String> {
    let info = r.cvt_car.keys.iter().find(|info| info.key == key);
    let found = info.and_then(|info| info.value.parse().ok());
    found.ok_or_else(|| format!("thermal_network.svg: {key} is no number of the car"))
}
