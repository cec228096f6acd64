//! Keys of a lubricant file, and a lubricant from their values.

use super::{Friction, Lubricant, MAX_BAND_FRICTION, VALID_K, Viscosity, ZERO_DEGC_K};
use crate::keys::{Bound, Key, Values, keys};
use crate::math::exp;

keys! {
    /// Keys of a lubricant file.
    FLUID: FluidKeys = "" [FrictionKeys::TABLE] {
        title: computed("name of the file", text()), "name for people";
        viscosity_table: optional(rows(&[("temp_degc", Bound::closed(-60.0, 200.0)), ("kinematic_mm2_s", Bound::closed(1.0, 1e7))])), "rows [temperature degC, kinematic viscosity mm2/s]; replaces kv40 and kv100", ["LU-1"];
        kv40_mm2_s: required_if("without viscosity_table", number(1.5, 5000.0)), "kinematic viscosity at 40 degC", ["LU-1"];
        kv100_mm2_s: required_if("without viscosity_table", number(1.5, 5000.0)), "kinematic viscosity at 100 degC", ["LU-1"];
        density15_kg_m3: number(650.0, 1200.0), "density at 15 degC", ["LU-2", "LU-3"];
    }

    /// Keys of `[friction]`.
    FRICTION: FrictionKeys = "friction" [FilmKeys::TABLE] {
        band: or(0.13, number(0.0, 0.4)), "band boundary friction at 85 degC", ["LU-4"];
        band_rise_per_k: or(0.003_01, number(0.0, 0.02)), "rise of band friction with belt temperature", ["LU-4"];
        segment: or(0.125, number(0.02, 0.4)), "friction segment on pulley in micro slip", ["SL-4"];
        capacity: or(0.09, number(0.02, 0.4)), "friction segment on pulley in macro slip: torque capacity", ["VA-4"];
        flank: or(0.13, number(0.0, 0.4)), "friction in wedging and penetration", ["WE-3", "PE-1"];
    }

    /// Keys of `[friction.film]`.
    FILM: FilmKeys = "film" [] {
        enabled: flag(true), "whether the bands can ride on oil", ["LU-5"];
        half_n_per_m: or(0.087, above(0.0, 10.0)), "eta dv at which the film carries half", ["LU-5"];
        exponent: or(1.85, number(0.3, 8.0)), "exponent of the film's share", ["LU-5"];
        half_thickness_um: or(1.05, number(0.01, 100.0)), "thickness of the film where it carries half", ["FI-2"];
        film_heating_w: or(4000.0, number(1.0, 1e9)), "dissipation of an interface that halves the shear of its film", ["FI-1", "FH-1"];
    }
}

impl Lubricant {
    /// A checked lubricant from the values of its file.
    pub fn from_values<V: Values>(s: &V, name: &str) -> Self {
        Lubricant {
            name: name.to_owned(),
            title: s.text_or(&FLUID.title, name),
            viscosity: of_fluid(s),
            density15_kg_m3: s.number(&FLUID.density15_kg_m3),
            friction: Friction::from_values(&s.table("friction")),
        }
    }
}

fn of_fluid<V: Values>(s: &V) -> Viscosity {
    let ends = [&FLUID.kv40_mm2_s, &FLUID.kv100_mm2_s];
    let Some(table) = s.rows(&FLUID.viscosity_table) else {
        for key in ends {
            let _ = s.optional(key);
        }
        return any_viscosity();
    };
    let key = if table.is_empty() {
        ends[0]
    } else {
        &FLUID.viscosity_table
    };
    let points: Vec<(f64, f64)> = if table.is_empty() {
        let [kv40, kv100] = ends.map(|key| s.number(key));
        vec![(40.0 + ZERO_DEGC_K, kv40), (100.0 + ZERO_DEGC_K, kv100)]
    } else {
        for key in ends.into_iter().filter(|key| s.has(key)) {
            let _ = s.optional(key);
            s.complain(
                key.name,
                "viscosity_table, or kv40_mm2_s and kv100_mm2_s",
                "both a viscosity table and this value are given",
                "keep one of them: the table replaces kv40 and kv100",
            );
        }
        table.iter().map(|r| (r[0], r[1])).collect()
    };
    let words = [
        "viscosities that fall as temperature rises",
        "check the order of the points and their unit, mm2/s (cSt)",
    ];
    viscosity(s, key, &points, words)
}

impl Friction {
    fn from_values<V: Values>(s: &V) -> Self {
        let film = s.table("film");
        let band = s.number(&FRICTION.band);
        let band_rise_per_k = s.number(&FRICTION.band_rise_per_k);
        let hot = band * exp(band_rise_per_k * (VALID_K.end() - ZERO_DEGC_K - 85.0)); // LU-4
        if hot > MAX_BAND_FRICTION {
            let allowed = format!("band friction up to {MAX_BAND_FRICTION} at 160 degC");
            let message = format!(
                "at 160 degC, band friction is {hot:.3}: the bands would block themselves (TE-5)"
            );
            s.complain("band_rise_per_k", &allowed, &message, "lower it or `band`");
        }
        Friction {
            band,
            band_rise_per_k,
            segment: s.number(&FRICTION.segment),
            capacity: s.number(&FRICTION.capacity),
            flank: s.number(&FRICTION.flank),
            film: film.flag(&FILM.enabled),
            half_n_m: film.number(&FILM.half_n_per_m),
            film_exponent: film.number(&FILM.exponent),
            half_thickness_m: film.number(&FILM.half_thickness_um),
            film_heating_w: film.number(&FILM.film_heating_w),
        }
    }
}

/// A viscosity from points of temperature in K and kinematic viscosity in m2/s. If the points are
/// finite and do not make one, a problem at the key with what is allowed and a hint; points that are
/// not finite have a problem already.
pub(crate) fn viscosity<V: Values>(
    s: &V,
    key: &Key<'_>,
    points: &[(f64, f64)],
    [allowed, hint]: [&str; 2],
) -> Viscosity {
    Viscosity::new(points).unwrap_or_else(|why| {
        if points.iter().all(|p| p.0.is_finite() && p.1.is_finite()) {
            s.complain(key.name, allowed, &why, hint);
        }
        any_viscosity()
    })
}

/// Replaces a viscosity after a problem, so that reading goes on.
fn any_viscosity() -> Viscosity {
    Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)])
        .unwrap_or_else(|_| unreachable!("constant points"))
}
