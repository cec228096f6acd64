//! Reads a lubricant file.

use crate::{Bound, Section};
use cvtcycle_model::fluid::{Friction, Lubricant, Viscosity, ZERO_DEGC_K};

/// Reads a checked lubricant from the root of its file; problems go to the reader.
#[must_use]
pub fn load(root: &Section, name: &str) -> Lubricant {
    Lubricant {
        name: name.to_owned(),
        title: root.text_or("title", name, "name for people"),
        viscosity: viscosity(root),
        density15_kg_m3: root.number(
            "density15_kg_m3",
            Bound::closed(650.0, 1200.0),
            "density at 15 degC (LU-2, LU-3)",
        ),
        friction: friction(&root.table("friction")),
    }
}

fn viscosity(root: &Section) -> Viscosity {
    let columns = [
        ("temp_degc", Bound::closed(-60.0, 200.0)),
        ("kinematic_mm2_s", Bound::closed(1.0, 1e7)),
    ];
    let doc = "rows [temperature degC, kinematic viscosity mm2/s]; replaces kv40 and kv100 (LU-1)";
    let Some(table) = root.sound_rows("viscosity_table", &columns, doc) else {
        for key in ["kv40_mm2_s", "kv100_mm2_s"] {
            let _ = root.optional_number(
                key,
                Bound::closed(1.5, 5000.0),
                "kinematic viscosity (LU-1)",
            );
        }
        return placeholder();
    };
    let points: Vec<(f64, f64)> = if table.is_empty() {
        let allowed = Bound::closed(1.5, 5000.0);
        let kv40 = root.number(
            "kv40_mm2_s",
            allowed,
            "kinematic viscosity at 40 degC (LU-1)",
        );
        let kv100 = root.number(
            "kv100_mm2_s",
            allowed,
            "kinematic viscosity at 100 degC (LU-1)",
        );
        if kv40.is_nan() || kv100.is_nan() {
            return placeholder();
        }
        vec![(40.0 + ZERO_DEGC_K, kv40), (100.0 + ZERO_DEGC_K, kv100)]
    } else {
        for key in ["kv40_mm2_s", "kv100_mm2_s"] {
            if root.has(key) {
                let _ = root.optional_number(
                    key,
                    Bound::closed(1.5, 5000.0),
                    "kinematic viscosity (LU-1)",
                );
                root.complain(
                    key,
                    "viscosity_table, or kv40_mm2_s and kv100_mm2_s",
                    "both a viscosity table and this value are given",
                    "keep one of them: the table replaces kv40 and kv100",
                );
            }
        }
        table.iter().map(|r| (r[0], r[1])).collect()
    };
    Viscosity::new(&points).unwrap_or_else(|why| {
        let key = if table.is_empty() {
            "kv40_mm2_s"
        } else {
            "viscosity_table"
        };
        if points.iter().all(|p| p.0.is_finite() && p.1.is_finite()) {
            root.complain(
                key,
                "viscosities that fall as temperature rises",
                &why,
                "check the order of the points and their unit, mm2/s (cSt)",
            );
        }
        placeholder()
    })
}

/// Stands in after a problem, so that reading goes on and finds the others.
fn placeholder() -> Viscosity {
    Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)])
        .unwrap_or_else(|_| unreachable!("constant points"))
}

/// Largest friction of the bands, rise with temperature included: at 0.53 they would block themselves in the larger wrap (TE-5).
const MOST_BAND_FRICTION: f64 = 0.5;

fn friction(s: &Section) -> Friction {
    let mu = Bound::closed(0.0, 0.4);
    let lift = s.table("lift_off");
    let band = s.number_or("band", mu, 0.13, "band boundary friction at 85 degC (LU-4)");
    let band_rise_per_k = s.number_or(
        "band_rise_per_k",
        Bound::closed(0.0, 0.02),
        0.002,
        "rise of band friction with belt temperature (LU-4)",
    );
    let band_floor = s.number_or(
        "band_floor",
        Bound::closed(0.1, 1.0),
        0.7,
        "lower bound of the temperature factor (LU-4)",
    );
    let band_ceiling = s.number_or(
        "band_ceiling",
        Bound::closed(1.0, 2.0),
        1.04,
        "upper bound of the temperature factor (LU-4)",
    );
    if band * band_ceiling > MOST_BAND_FRICTION {
        let allowed = format!("band times band_ceiling up to {MOST_BAND_FRICTION}");
        let message = format!(
            "when hot, band friction could be {:.3}: the bands would block themselves (TE-5)",
            band * band_ceiling
        );
        s.complain("band_ceiling", &allowed, &message, "lower it or `band`");
    }
    Friction {
        band,
        band_rise_per_k,
        band_floor,
        band_ceiling,
        segment: s.number_or(
            "segment",
            Bound::closed(0.02, 0.4),
            0.125,
            "friction segment on pulley (SL-4, VA-2)",
        ),
        flank: s.number_or(
            "flank",
            mu,
            0.13,
            "friction in wedging and penetration (WE-3, PE-1)",
        ),
        lift_off: lift.boolean_or("enabled", true, "whether the bands can ride on oil (LU-5)"),
        lift_reduction: lift.number_or(
            "reduction",
            Bound::closed(0.0, 0.95),
            0.2,
            "part of the boundary friction that a carrying film removes (LU-4)",
        ),
        lift_n_m: lift.number_or(
            "load_n_per_m",
            Bound::open_low(0.0, 10.0),
            0.0075,
            "eta dv at which the film carries half (LU-5)",
        ),
        lift_exponent: lift.number_or(
            "exponent",
            Bound::closed(0.5, 8.0),
            5.0,
            "sharpness of lift-off (LU-5)",
        ),
        film_thickness_m: lift.number_or(
            "film_thickness_um",
            Bound::closed(0.01, 100.0),
            1.5,
            "thickness of the carrying film (FI-1)",
        ),
    }
}
