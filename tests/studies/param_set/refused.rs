//! Cars that a template refuses, and keys that cannot be set. Truth: the ordinary reading.

use super::*;

#[test]
fn impossible_cars_give_the_messages_of_the_ordinary_load() {
    let (cvt, manual) = (
        params(CARS[0], &Options::default()),
        params(CARS[1], &Options::default()),
    );
    let bad: [&[(&str, f64)]; 17] = [
        &[
            ("transmission.cvt.variator.stop_from_ratio", 2.3),
            ("transmission.cvt.variator.stop_to_ratio", 2.0),
        ],
        &[("transmission.cvt.pressure.control_bar", 41.0)],
        &[("transmission.cvt.pressure.cap_bar", 4.0)],
        &[
            ("transmission.cvt.ratio.low", 0.4),
            ("transmission.cvt.ratio.high", 2.4),
        ],
        &[("transmission.cvt.belt.length_m", 0.3)],
        &[("transmission.cvt.belt.band_count", 12.5)],
        &[("transmission.cvt.belt.band_count", 0.0)],
        &[("transmission.cvt.belt.band_count", 1e30)],
        &[("transmission.cvt.belt.band_offset_mm", 20.001)],
        &[("thermal.radiator.thermostat_from_degc", 95.0)],
        &[("lubricant.kv40_mm2_s", 7.0)],
        &[
            ("lubricant.kv100_mm2_s", 40.0),
            ("engine_oil.kv40_mm2_s", -1.0),
            ("road_load.mass_kg", 10.0),
        ],
        &[("engine.friction.reference_kv100_mm2_s", 500.0)],
        &[("road_load.mass_kg", f64::NAN)],
        &[
            ("road_load.mass_kg", f64::INFINITY),
            ("road_load.payload_kg", f64::NEG_INFINITY),
        ],
        &[("engine.inertia_kg_m2", 0.0)],
        &[("thermal.transmission.oil_l", 1e300)],
    ];
    for numbers in bad {
        assert!(
            !same(CARS[0], &Options::default(), &cvt, numbers),
            "{numbers:?}"
        );
    }
    for numbers in [
        [("thermal.radiator.thermostat_to_degc", 79.0)],
        [("transmission.manual.gears.oil_factor", 2.5)],
    ] {
        assert!(!same(CARS[1], &Options::default(), &manual, &numbers));
    }
    assert!(same(
        CARS[0],
        &Options::default(),
        &cvt,
        &[
            ("transmission.cvt.belt.band_count", 40.0),
            ("engine.stroke_mm", 80.0)
        ]
    ));
}

/// Unknown keys get the messages of `--set`; keys without a single number have a message of their own.
#[test]
fn keys_that_cannot_be_set() {
    let unknown = [
        (
            CARS[0],
            "transmission.cvt.belt.band_ofset_mm",
            "did you mean `transmission.cvt.belt.band_offset_mm`",
        ),
        (
            CARS[0],
            "transmission.cvt.belt.band_offset_m",
            "give the value in mm as",
        ),
        (CARS[0], "lubricant.kv41_mm2_s", "kv40_mm2_s"),
        (CARS[0], "zebra", "remove it"),
        (
            CARS[0],
            "transmission.manual.gears.oil_factor",
            "or take another vehicle",
        ),
        (
            CARS[1],
            "transmission.cvt.belt.band_offset_mm",
            "or take another vehicle",
        ),
        (
            CARS[1],
            "thermal.transmission.belt_kj_k",
            "thermal.transmission.",
        ),
        (CARS[1], "engine.stroke_mm.value.x", ""),
        (CARS[1], "engine..stroke_mm", ""),
        (CARS[1], "", ""),
    ];
    for (car, key, hint) in unknown {
        let problem = params(car, &Options::default()).param(key).unwrap_err();
        let set = format!("{key}=0");
        let with = |set| Options {
            set,
            ..Options::default()
        };
        let ordinary = Override::parse_all(&[set]).and_then(|set| load(car, &with(set)));
        let ordinary = ordinary.unwrap_err();
        assert!(
            ordinary
                .iter()
                .any(|p| p.message == problem.message && p.hint == problem.hint),
            "{problem:?}\ninstead of\n{ordinary:?}"
        );
        assert!(
            problem.hint.contains(hint) && problem.place.assignment() == Some(key),
            "{problem:?}"
        );
    }
    let texts = [
        "vehicle.title",
        "transmission.cvt.clamp",
        "engine.full_load",
        "thermal.cooler.fitted",
        "road_load.surface",
    ];
    for key in texts.into_iter().chain([
        "transmission.cvt.maps.belt",
        "lubricant.title",
        "lubricant.viscosity_table",
    ]) {
        let problem = params(CARS[0], &Options::default()).param(key).unwrap_err();
        assert!(
            problem.message.contains("no single number") && !problem.allowed.is_empty(),
            "{problem:?}"
        );
    }
}
