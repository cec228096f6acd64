//! Keys of a lubricant file, and a lubricant from their values.

use super::bench::{self, Bench, BenchUse, FRICTION_TABLE, bench_rows};
use super::contact::Contact;
use super::{Friction, Lubricant, MAX_BAND_FRICTION, VALID_K, Viscosity, ZERO_DEGC_K};
use crate::keys::spec::Spec;
use crate::keys::{Bound, Choice, Key, Values, keys};
use crate::math::{exp, ln};
use std::sync::Arc;

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
    FRICTION: FrictionKeys = "friction" [
        FilmKeys::TABLE, BandContactKeys::TABLE, MicroSlipKeys::TABLE, MacroSlipKeys::TABLE, WetClutchKeys::TABLE, GearKeys::TABLE
    ] {
        band: or(0.13, number(0.0, 0.4)), "band boundary friction at 85 degC", ["LU-4"];
        band_rise_per_k: or(0.003, number(0.0, 0.02)), "rise of band friction with belt temperature", ["LU-4"];
        segment: or(0.125, number(0.02, 0.4)), "friction segment on pulley in micro slip", ["SL-4"];
        capacity: or(0.09, number(0.02, 0.4)), "friction segment on pulley in macro slip: torque capacity", ["VA-4"];
        flank: or(0.13, number(0.0, 0.4)), "friction in wedging and penetration", ["WE-3", "PE-1"];
    }

    /// Keys of `[friction.film]`.
    FILM: FilmKeys = "film" [] {
        enabled: flag(true), "whether the bands can ride on oil", ["LU-5"];
        half_n_per_m: or(0.09, above(0.0, 10.0)), "eta dv at which the film carries half", ["LU-5"];
        exponent: or(1.86, number(0.3, 8.0)), "exponent of the film's share", ["LU-5"];
        half_thickness_um: or(1.05, number(0.01, 100.0)), "thickness of the film where it carries half", ["FI-2"];
        film_heating_w: or(4000.0, number(1.0, 1e9)), "dissipation of an interface that halves the shear of its film", ["FI-1", "FH-1"];
    }

    /// Keys of `[friction.bands]`.
    BANDS: BandContactKeys = "bands" [] {
        table: TABLE_FILE, "CSV of measured friction in place of band, band_rise_per_k, film.half_n_per_m and film.exponent; columns sliding_m_s, where measured pressure_mpa, temp_degc, where measured sd, and friction", ["FR-1", "FR-5"];
        test: TEST, "kind of bench that measured it";
        pressure_mpa: or(4.0, PRESSURE), "mean pressure of the contact, at which the table is read", ["FR-2"];
        spread: SPREAD, "half width of what is known of the friction, over it: two standard deviations", ["FR-6", "FR-8"];
        place: or(0.0, PLACE), "place of the friction in this spread, for studies: 1 is its upper end", ["FR-6"];
    }

    /// Keys of `[friction.micro_slip]`.
    MICRO: MicroSlipKeys = "micro_slip" [] {
        table: TABLE_FILE, "CSV of measured friction in place of segment; columns as in bands", ["FR-1", "FR-5"];
        test: TEST, "kind of bench that measured it";
        pressure_mpa: or(100.0, PRESSURE), "mean pressure of the contact, at which the table is read", ["FR-2"];
        slip_percent: or(0.5, number(0.01, 10.0)), "sliding speed over belt speed at which the table is read", ["FR-4"];
        spread: SPREAD, "half width of what is known of the friction, over it: two standard deviations", ["FR-6", "FR-8"];
        place: or(0.0, PLACE), "place of the friction in this spread, for studies: 1 is its upper end", ["FR-6"];
    }

    /// Keys of `[friction.macro_slip]`.
    MACRO: MacroSlipKeys = "macro_slip" [] {
        table: TABLE_FILE, "CSV of measured friction in place of capacity; columns as in bands", ["FR-1", "FR-5"];
        test: TEST, "kind of bench that measured it";
        pressure_mpa: or(100.0, PRESSURE), "mean pressure of the contact, at which the table is read", ["FR-2"];
        slip_percent: or(2.0, number(0.01, 20.0)), "sliding speed over belt speed at which the table is read", ["FR-4"];
        spread: SPREAD, "half width of what is known of the friction, over it: two standard deviations", ["FR-6", "FR-8"];
        place: or(0.0, PLACE), "place of the friction in this spread, for studies: 1 is its upper end", ["FR-6"];
    }

    /// Keys of `[friction.wet_clutch]`, which no equation reads: what the fluid's file knows of it is checked and shown.
    WET: WetClutchKeys = "wet_clutch" [] {
        table: TABLE_FILE, "CSV of measured friction of the clutch's lining; columns as in bands; no loss depends on it", ["FR-5"];
        test: TEST, "kind of bench that measured it";
        pressure_mpa: or(1.0, PRESSURE), "mean pressure of the plates", ["FR-2"];
    }

    /// Keys of `[friction.gears]`.
    GEAR_OIL: GearKeys = "gears" [] {
        oil_factor: or(1.0, number(0.1, 2.0)), "factor of this fluid on the friction of the teeth, X_L: mineral oil 1; times that of the box", ["FR-7", "GM-2"];
        spread: or(0.0, number(0.0, 0.9)), "half width of what is known of the factor, over it: two standard deviations", ["FR-6"];
        place: or(0.0, PLACE), "place of the factor in this spread, for studies: 1 is its upper end", ["FR-6"];
    }
}

/// A table of friction.
const TABLE_FILE: Spec = crate::keys::spec::optional(crate::keys::spec::csv());
/// Kind of a test.
const TEST: Spec = crate::keys::spec::words(TESTS, "unnamed");
/// Mean pressure of a contact, MPa.
const PRESSURE: Spec = crate::keys::spec::above(0.0, 5000.0);
/// Half width of what is known.
const SPREAD: Spec = crate::keys::spec::computed(
    "of a table its scatter and what the form misses; else 0",
    crate::keys::spec::number(0.0, 0.9),
);
/// Place in it.
const PLACE: Spec = crate::keys::spec::number(-1.0, 1.0);

/// Kinds of bench.
const TESTS: &[Choice] = &[
    Choice::word(
        "mtm",
        "mini-traction machine: a steel ball on a steel disc, rolling and sliding",
    ),
    Choice::word(
        "block_on_ring",
        "block on ring (LFW-1, ASTM D2714): steel on steel, sliding",
    ),
    Choice::word(
        "jaso_m358",
        "JASO M358: elements of a belt on a disc of pulley steel, block on ring",
    ),
    Choice::word(
        "pin_on_disc",
        "pin or ring on disc (ASTM G99): steel on steel, sliding",
    ),
    Choice::word(
        "sae_no2",
        "SAE No. 2 machine (JASO M348): plates of a wet clutch",
    ),
    Choice::word(
        "lvfa",
        "low velocity friction apparatus (JASO M349): plates of a wet clutch",
    ),
    Choice::word("unnamed", "another one, or not said"),
];

impl Lubricant {
    /// A checked lubricant from the values of its file.
    pub fn from_values<V: Values>(s: &V, name: &str) -> Self {
        let mut fluid = Lubricant {
            name: name.to_owned(),
            title: s.text_or(&FLUID.title, name),
            viscosity: of_fluid(s),
            density15_kg_m3: s.number(&FLUID.density15_kg_m3),
            friction: Friction::any(),
            benches: Vec::new(),
        };
        let (friction, benches) = Friction::from_values(&s.table("friction"), &fluid);
        fluid.friction = friction;
        fluid.benches = benches;
        fluid
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

/// Keys of a contact that has a table.
struct ContactKeys {
    table: &'static Key<'static>,
    test: &'static Key<'static>,
    pressure_mpa: &'static Key<'static>,
    slip: Option<&'static Key<'static>>,
}

/// The curve through the table of a contact; none without one, and after a problem.
fn bench_of<V: Values>(
    s: &V,
    contact: Contact,
    keys: &ContactKeys,
    fluid: &Lubricant,
) -> Option<Arc<Bench>> {
    let table = s.file_table(keys.table, &FRICTION_TABLE);
    let of = BenchUse {
        contact,
        test: s.word(keys.test),
        pressure_pa: s.number(keys.pressure_mpa),
        slip: keys.slip.map_or(0.0, |key| s.number(key)),
    };
    let rows = bench_rows(&table?);
    let eta: Vec<f64> = rows
        .iter()
        .map(|row| fluid.dynamic_pa_s(row.temp_k))
        .collect();
    match bench::bench(&of, &rows, &eta) {
        Ok(bench) => Some(bench),
        Err(why) => {
            s.complain(
                keys.table.name,
                "three rows or more, better ten at two temperatures",
                &why,
                "add the rows, or give the number itself",
            );
            None
        }
    }
}

/// The factor on a friction by its place in what is known of it (FR-6); 1 in the middle.
fn placed<V: Values>(
    s: &V,
    spread: &'static Key<'static>,
    place: &'static Key<'static>,
    bench: Option<&Arc<Bench>>,
) -> f64 {
    let of_table = bench.map_or(0.0, |bench| bench.spread.min(0.9));
    1.0 + s.number_or(spread, of_table) * s.number(place) // FR-6
}

/// A number that the curve of a table replaces, as it is shown: given all the same, it moves the curve in proportion.
struct Replaced {
    key: &'static Key<'static>,
    /// The curve's number.
    of_curve: f64,
    /// The same in the places that are shown.
    shown: f64,
}

impl Replaced {
    fn new(key: &'static Key<'static>, of_curve: f64) -> Self {
        Replaced {
            key,
            of_curve,
            shown: (1e6 * of_curve).round() / 1e6,
        }
    }

    /// The number in force.
    fn number<V: Values>(&self, s: &V) -> f64 {
        let number = s.number_or(self.key, self.shown);
        let moves = (number - self.shown).abs() > 0.0;
        match moves && self.shown.abs() > 0.0 {
            true => self.of_curve * (number / self.shown),
            false => self.of_curve,
        }
    }
}

/// The tables of bands, micro slip, macro slip and wet clutch.
fn benches<V: Values>(s: &V, fluid: &Lubricant) -> [Option<Arc<Bench>>; 4] {
    let bands = ContactKeys {
        table: &BANDS.table,
        test: &BANDS.test,
        pressure_mpa: &BANDS.pressure_mpa,
        slip: None,
    };
    let micro = ContactKeys {
        table: &MICRO.table,
        test: &MICRO.test,
        pressure_mpa: &MICRO.pressure_mpa,
        slip: Some(&MICRO.slip_percent),
    };
    let of_macro = ContactKeys {
        table: &MACRO.table,
        test: &MACRO.test,
        pressure_mpa: &MACRO.pressure_mpa,
        slip: Some(&MACRO.slip_percent),
    };
    let wet = ContactKeys {
        table: &WET.table,
        test: &WET.test,
        pressure_mpa: &WET.pressure_mpa,
        slip: None,
    };
    [
        ("bands", Contact::Bands, bands),
        ("micro_slip", Contact::MicroSlip, micro),
        ("macro_slip", Contact::MacroSlip, of_macro),
        ("wet_clutch", Contact::WetClutch, wet),
    ]
    .map(|(name, contact, keys)| bench_of(&s.table(name), contact, &keys, fluid))
}

impl Friction {
    fn from_values<V: Values>(s: &V, fluid: &Lubricant) -> (Self, Vec<Arc<Bench>>) {
        let film = s.table("film");
        let [of_bands, of_micro, of_macro] =
            ["bands", "micro_slip", "macro_slip"].map(|name| s.table(name));
        let [bands, micro, macro_, wet] = benches(s, fluid);
        let of_gears = s.table("gears");
        let carries = bands.as_ref().filter(|bench| bench.film_carries());
        // Where there is a table, its curve is the default of the numbers that it replaces.
        let of_curve = |s: &V, key, curve: Option<f64>| match curve {
            Some(number) => Replaced::new(key, number).number(s),
            None => s.number(key),
        };
        let boundary = |bench: &Option<Arc<Bench>>| bench.as_ref().map(|of| of.curve.boundary);
        let band = of_curve(s, &FRICTION.band, boundary(&bands));
        let band_rise_per_k = of_curve(
            s,
            &FRICTION.band_rise_per_k,
            bands.as_ref().map(|bench| bench.curve.rise_per_k),
        );
        let segment = of_curve(s, &FRICTION.segment, boundary(&micro));
        let capacity = of_curve(s, &FRICTION.capacity, boundary(&macro_));
        let half_n_m = of_curve(
            &film,
            &FILM.half_n_per_m,
            carries.map(|bench| bench.curve.half_n_m),
        );
        let film_exponent = of_curve(
            &film,
            &FILM.exponent,
            carries.map(|bench| bench.curve.exponent),
        );
        let by_bands = placed(&of_bands, &BANDS.spread, &BANDS.place, bands.as_ref());
        let by_micro = placed(&of_micro, &MICRO.spread, &MICRO.place, micro.as_ref());
        let by_macro = placed(&of_macro, &MACRO.spread, &MACRO.place, macro_.as_ref());
        let by_gears = placed(&of_gears, &GEAR_OIL.spread, &GEAR_OIL.place, None);
        let band = by_bands * band;
        let hot = band * exp(band_rise_per_k * (VALID_K.end() - ZERO_DEGC_K - 85.0)); // LU-4
        if hot > MAX_BAND_FRICTION {
            let allowed = format!("band friction up to {MAX_BAND_FRICTION} at 160 degC");
            let message = format!(
                "at 160 degC, band friction is {hot:.3}: the bands would block themselves (TE-5)"
            );
            match bands {
                Some(_) => of_bands.complain(
                    BANDS.table.name,
                    &allowed,
                    &message,
                    "check the table's temperatures and its friction",
                ),
                None => s.complain("band_rise_per_k", &allowed, &message, "lower it or `band`"),
            }
        }
        let friction = Friction {
            band,
            band_rise_per_k,
            segment: by_micro * segment,
            capacity: by_macro * capacity,
            flank: s.number(&FRICTION.flank),
            film: film.flag(&FILM.enabled),
            half_n_m,
            film_exponent,
            half_thickness_m: film.number(&FILM.half_thickness_um),
            film_heating_w: film.number(&FILM.film_heating_w),
            micro_slip: (micro.as_ref())
                .map(|bench| bench.curve.times(by_micro * segment / bench.curve.boundary)),
            macro_slip: (macro_.as_ref()).map(|bench| {
                bench
                    .curve
                    .times(by_macro * capacity / bench.curve.boundary)
            }),
            log_gear_factor: ln(by_gears * of_gears.number(&GEAR_OIL.oil_factor)), // FR-7
        };
        let benches = [bands, micro, macro_, wet].into_iter().flatten();
        (friction, benches.collect())
    }

    /// Some friction, which is replaced.
    const fn any() -> Self {
        Friction {
            band: 0.0,
            band_rise_per_k: 0.0,
            segment: 0.1,
            capacity: 0.1,
            flank: 0.0,
            film: false,
            half_n_m: 1.0,
            film_exponent: 1.0,
            half_thickness_m: 1.0,
            film_heating_w: 1.0,
            micro_slip: None,
            macro_slip: None,
            log_gear_factor: 0.0,
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
