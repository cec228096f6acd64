//! Keys of `[road_load]`, and a road load from their values.

use super::tyre::{Tyre, TyreKeys};
use super::{GRAVITY_M_S2, RoadLoad, RoadLoadInput, Surface};
use crate::keys::{Choice, Values, keys};
use crate::math::{clamp, larger, smaller};

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

keys! {
    /// Keys of `[road_load]`.
    ROAD_LOAD: RoadLoadKeys = "road_load" [TyreKeys::TABLE] {
        surface: words(&[
            Choice::word("dynamometer", "fixed coefficients"),
            Choice::word("road", "air and rolling follow ambient (RL-2)"),
        ], "dynamometer"), "dynamometer: fixed coefficients; road: air and rolling follow ambient; for the road give body or coast-down coefficients, since the R83 table has most of the rolling in f2", ["RL-2"];
        payload_kg: or(0.0, number(0.0, 5000.0)), "load added to the mass", ["RL-1"];
        rotating_factor: or(0.015, number(0.0, 0.2)), "rotating inertia of wheels and output side over mass", ["RL-1"];
        altitude_m: or(0.0, number(-500.0, 5000.0)), "altitude of the road", ["RL-4", "EN-5"];
        form: options(&[
            Choice::new("coefficients", "coast-down coefficients f0, f1, f2", CoefficientKeys::TABLE),
            Choice::new("body", "drag coefficient, frontal area and rolling resistance", BodyKeys::TABLE),
            Choice::new("r83", "class of UN R83 from the reference mass", R83Keys::TABLE),
        ]), "coefficients f0 f1 f2; body (c_d, area, rolling); or r83 (class from reference mass)";
        mass_kg: required_if("with form coefficients or body", number(200.0, 5000.0)), "inertia mass without payload", ["RL-1"];
        wheel_radius_m: number(0.15, 0.6), "dynamic tyre radius";
        rolling_per_k: or(0.00864, number(0.0, 0.03)), "rise of rolling resistance per kelvin below 20 degC, without tyres that warm up", ["RL-2"];
        load_factor: or(1.0, number(0.2, 3.0)), "factor on the road load, not on the inertia: 1.1 in the US cold test", ["RL-8"];
    }

    /// Keys of `[road_load.form.coefficients]`.
    COEFFICIENTS: CoefficientKeys = "coefficients" [] {
        f0_n: number(0.0, 2000.0), "constant part", ["RL-1"];
        f1_n_per_kmh: or(0.0, number(-20.0, 50.0)), "part linear in speed; US targets have some below zero", ["RL-1"];
        f2_n_per_kmh2: number(0.0, 1.0), "part quadratic in speed, per (km/h)2", ["RL-1"];
        driveline_f0_n: or(0.0, number(-200.0, 200.0)), "no-load drag of the box that f0 has in it, of a coast-down in neutral", ["RL-9"];
        driveline_f1_n_per_kmh: or(0.0, number(-5.0, 5.0)), "the same of f1", ["RL-9"];
        driveline_f2_n_per_kmh2: or(0.0, number(-0.05, 0.05)), "the same of f2", ["RL-9"];
    }

    /// Keys of `[road_load.form.body]`.
    BODY: BodyKeys = "body" [] {
        drag_coefficient: number(0.1, 1.5), "c_d", ["RL-3"];
        frontal_area_m2: number(0.5, 6.0), "frontal area", ["RL-3"];
        rolling_coefficient: number(0.002, 0.05), "c_r", ["RL-3"];
    }

    /// Keys of `[road_load.form.r83]`.
    R83_CLASS: R83Keys = "r83" [] {
        reference_mass_kg: number(200.0, 5000.0), "unladen mass + 100 kg; picks the class of UN R83";
    }
}

/// Speed up to which a road load must resist, m/s (200 km/h).
const FASTEST_M_S: f64 = 200.0 / 3.6;

/// Mass in kg and coefficients f0, f1, f2 in SI units.
type Forces = (f64, f64, f64, f64);

impl RoadLoadInput {
    /// A checked road load from the values of `[road_load]`.
    pub fn from_values<V: Values>(s: &V) -> Self {
        let is_road = s.word(&ROAD_LOAD.surface) == "road";
        let payload = s.number(&ROAD_LOAD.payload_kg);
        let rotating = s.number(&ROAD_LOAD.rotating_factor);
        let altitude_m = s.number(&ROAD_LOAD.altitude_m);
        let (kind, form) = s.choose(&ROAD_LOAD.form);
        let (mass, f0, f1, f2) = match kind {
            "coefficients" => coefficients(s, &form),
            "body" => body(s, &form),
            _ => r83(&form),
        };
        let mass_kg = mass + payload;
        RoadLoadInput {
            base: RoadLoad {
                // Rolling resistance grows with the load of the tyres; on rollers with fixed coefficients it does not.
                f0_n: if is_road { f0 * mass_kg / mass } else { f0 },
                f1_n_per_m_s: f1,
                f2_n_per_m_s2: f2,
                mass_kg,
                inertia_kg: mass_kg * (1.0 + rotating),
                wheel_radius_m: s.number(&ROAD_LOAD.wheel_radius_m),
            },
            surface: if is_road {
                Surface::Road
            } else {
                Surface::Dynamometer
            },
            rolling_per_k: s.number(&ROAD_LOAD.rolling_per_k),
            altitude_m,
            load_factor: s.number(&ROAD_LOAD.load_factor),
            payload_kg: payload,
            tyre: Tyre::from_values(&s.table("tyre"), mass_kg),
        }
    }
}

fn coefficients<V: Values>(s: &V, form: &V) -> Forces {
    let (f0, f1, f2) = (
        form.number(&COEFFICIENTS.f0_n) - form.number(&COEFFICIENTS.driveline_f0_n), // RL-9
        form.number(&COEFFICIENTS.f1_n_per_kmh) - form.number(&COEFFICIENTS.driveline_f1_n_per_kmh), // RL-9
        form.number(&COEFFICIENTS.f2_n_per_kmh2)
            - form.number(&COEFFICIENTS.driveline_f2_n_per_kmh2), // RL-9
    );
    let force = |v: f64| f0 + (f1 + f2 * v) * v;
    let bend = clamp(-0.5 * f1 / larger(f2, f64::MIN_POSITIVE), 0.0, FASTEST_M_S);
    let least = smaller(force(bend), force(FASTEST_M_S));
    if least < 0.0 {
        form.complain(
            COEFFICIENTS.f1_n_per_kmh.name,
            "a road load above zero up to 200 km/h",
            &format!(
                "the road load is {least:.1} N where it is least: the road would push the car"
            ),
            "the three belong together: check the sign and the unit of each",
        );
    }
    (s.number(&ROAD_LOAD.mass_kg), f0, f1, f2)
}

fn body<V: Values>(s: &V, form: &V) -> Forces {
    let mass = s.number(&ROAD_LOAD.mass_kg);
    let drag = form.number(&BODY.drag_coefficient);
    let area = form.number(&BODY.frontal_area_m2);
    let rolling = form.number(&BODY.rolling_coefficient);
    // RL-3, air at 20 degC and sea level
    let f2 = 0.5 * 1.204 * drag * area;
    (mass, mass * GRAVITY_M_S2 * rolling, 0.0, f2)
}

fn r83<V: Values>(form: &V) -> Forces {
    let reference = form.number(&R83_CLASS.reference_mass_kg);
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
