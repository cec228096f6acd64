//! Reads the `[road_load]` table of a vehicle file.

use crate::{Bound, Section};
use cvtcycle_model::road::{GRAVITY_M_S2, RoadLoad, RoadLoadInput, Surface};

/// Rows of the UN R83 table: reference mass up to, inertia class kg, a N, b N/(km/h)2.
const R83: [(f64, f64, f64, f64); 22] = [
    (480.0, 455.0, 3.8, 0.0261),
    (540.0, 510.0, 4.2, 0.0282),
    (595.0, 570.0, 4.4, 0.0296),
    (650.0, 625.0, 4.6, 0.0309),
    (710.0, 680.0, 4.8, 0.0323),
    (765.0, 740.0, 5.0, 0.0337),
    (850.0, 800.0, 5.2, 0.0351),
    (965.0, 910.0, 5.7, 0.0385),
    (1080.0, 1020.0, 6.1, 0.0412),
    (1190.0, 1130.0, 6.4, 0.0433),
    (1305.0, 1250.0, 6.8, 0.0460),
    (1420.0, 1360.0, 7.1, 0.0481),
    (1530.0, 1470.0, 7.4, 0.0502),
    (1640.0, 1590.0, 7.6, 0.0515),
    (1760.0, 1700.0, 7.9, 0.0536),
    (1870.0, 1810.0, 8.2, 0.0557),
    (1980.0, 1930.0, 8.5, 0.0577),
    (2100.0, 2040.0, 8.7, 0.0591),
    (2210.0, 2150.0, 8.9, 0.0605),
    (2380.0, 2270.0, 9.1, 0.0619),
    (2610.0, 2270.0, 9.5, 0.0646),
    (f64::INFINITY, 2270.0, 9.9, 0.0674),
];

/// Reads the checked road load; problems go to the reader.
#[must_use]
pub fn load(s: &Section) -> RoadLoadInput {
    let surface = s.word_or(
        "surface",
        &["dynamometer", "road"],
        "dynamometer",
        "dynamometer: fixed coefficients; road: air and rolling follow ambient (RL-2); for the road give body or coast-down coefficients, since the R83 table has most of the rolling in f2",
    );
    let payload = s.number_or(
        "payload_kg",
        Bound::closed(0.0, 5000.0),
        0.0,
        "load added to the mass (RL-1)",
    );
    let rotating = s.number_or(
        "rotating_factor",
        Bound::closed(0.0, 0.2),
        0.015,
        "rotating inertia of wheels and output side over mass (RL-1)",
    );
    let altitude_m = s.number_or(
        "altitude_m",
        Bound::closed(-500.0, 5000.0),
        0.0,
        "altitude of the road (RL-4, EN-5)",
    );
    let (kind, form) = s.choose(
        "form",
        &["coefficients", "body", "r83"],
        None,
        "coefficients f0 f1 f2; body (c_d, area, rolling); or r83 (class from reference mass)",
    );
    let (mass, f0, f1, f2) = match kind {
        "coefficients" => coefficients(s, &form),
        "body" => body(s, &form),
        _ => r83(&form),
    };
    let mass_kg = mass + payload;
    // Rolling resistance grows with the load that the tyres carry; on rollers with fixed coefficients it does not.
    let f0_n = if surface == "road" {
        f0 * mass_kg / mass
    } else {
        f0
    };
    RoadLoadInput {
        base: RoadLoad {
            f0_n,
            f1_n_per_m_s: f1,
            f2_n_per_m_s2: f2,
            mass_kg,
            inertia_kg: mass_kg * (1.0 + rotating),
            wheel_radius_m: s.number(
                "wheel_radius_m",
                Bound::closed(0.15, 0.6),
                "dynamic tyre radius",
            ),
        },
        surface: if surface == "road" {
            Surface::Road
        } else {
            Surface::Dynamometer
        },
        rolling_per_k: s.number_or(
            "rolling_per_k",
            Bound::closed(0.0, 0.03),
            0.00864,
            "rise of rolling resistance per kelvin below 20 degC (RL-2)",
        ),
        altitude_m,
    }
}

fn mass(s: &Section) -> f64 {
    s.number(
        "mass_kg",
        Bound::closed(200.0, 5000.0),
        "inertia mass without payload (RL-1)",
    )
}

fn coefficients(s: &Section, form: &Section) -> (f64, f64, f64, f64) {
    (
        mass(s),
        form.number("f0_n", Bound::closed(0.0, 2000.0), "constant part (RL-1)"),
        form.number_or(
            "f1_n_per_kmh",
            Bound::closed(0.0, 50.0),
            0.0,
            "part linear in speed (RL-1)",
        ),
        form.number(
            "f2_n_per_kmh2",
            Bound::closed(0.0, 1.0),
            "part quadratic in speed, per (km/h)2 (RL-1)",
        ),
    )
}

fn body(s: &Section, form: &Section) -> (f64, f64, f64, f64) {
    let mass = mass(s);
    let drag = form.number("drag_coefficient", Bound::closed(0.1, 1.5), "c_d (RL-3)");
    let area = form.number(
        "frontal_area_m2",
        Bound::closed(0.5, 6.0),
        "frontal area (RL-3)",
    );
    let rolling = form.number(
        "rolling_coefficient",
        Bound::closed(0.002, 0.05),
        "c_r (RL-3)",
    );
    (
        mass,
        mass * GRAVITY_M_S2 * rolling,
        0.0,
        0.5 * 1.204 * drag * area,
    ) // RL-3, air at 20 degC and sea level
}

fn r83(form: &Section) -> (f64, f64, f64, f64) {
    let reference = form.number(
        "reference_mass_kg",
        Bound::closed(200.0, 5000.0),
        "unladen mass + 100 kg; picks the class of UN R83",
    );
    let row = R83.iter().find(|r| reference <= r.0).unwrap_or(&R83[0]);
    (row.1, row.2, 0.0, row.3 * 12.96)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every row of the table gives the force at 80 km/h that belongs to its power: F80 = a + 6400 b.
    #[test]
    fn val_r83_rows_give_the_published_force() {
        let f80 = [
            171.0, 185.0, 194.0, 203.0, 212.0, 221.0, 230.0, 252.0, 270.0, 284.0, 302.0, 315.0,
            329.0, 338.0, 351.0, 365.0, 378.0, 387.0, 396.0, 405.0, 423.0, 441.0,
        ];
        for (row, want) in R83.iter().zip(f80) {
            let got = row.2 + 6400.0 * row.3;
            assert!((got - want).abs() < 1.0, "{} kg: {got} N", row.1);
        }
    }
}
