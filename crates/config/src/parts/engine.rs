//! Reads the `[engine]` table of a vehicle file.

use crate::setup::Files;
use crate::setup::tables;
use crate::{Bound, Section};
use cvtcycle_model::engine::EFFICIENCY;
use cvtcycle_model::engine::{BsfcMap, Engine, FuelModel, Willans};
use cvtcycle_model::fluid::Viscosity;
use cvtcycle_model::math::{Curve, held};

/// Reads a checked engine; problems go to the reader.
#[must_use]
pub fn load(s: &Section, files: &dyn Files) -> Engine {
    let share = Bound::closed(0.0, 1.0);
    let rpm = Bound::closed(300.0, 12_000.0);
    let friction = s.table("friction");
    let idle = s.table("idle");
    let fuel = s.table("fuel");
    let heat = s.table("heat");
    let displacement_m3 = s.number(
        "displacement_cc",
        Bound::closed(200.0, 10_000.0),
        "swept volume",
    );
    let line;
    let engine = Engine {
        displacement_m3,
        stroke_m: s.number("stroke_mm", Bound::closed(40.0, 150.0), "piston stroke"),
        rated_w: s.number(
            "rated_kw",
            Bound::closed(5.0, 600.0),
            "rated power; the ratio controller's measure of power",
        ),
        full_load: full_load(s),
        highest_rad_s: s.number(
            "highest_rpm",
            rpm,
            "largest speed; above it rows are flagged overspeed",
        ),
        inertia_kg_m2: s.number(
            "inertia_kg_m2",
            Bound::open_low(0.0, 5.0),
            "engine, flywheel and primary side (SI-1)",
        ),
        inertia_torque_nm: s.number_or(
            "inertia_torque_nm",
            Bound::closed(5.0, 500.0),
            60.0,
            "largest torque that changes the speed of the rotating parts (SI-2)",
        ),
        idle_hot_rad_s: idle.number(
            "hot_rpm",
            Bound::closed(400.0, 2000.0),
            "idle speed, warm (EN-1)",
        ),
        idle_cold_rad_s: idle.number(
            "cold_rpm",
            Bound::closed(400.0, 3000.0),
            "idle speed at -10 degC coolant and below (EN-1)",
        ),
        friction_exponent: friction.number(
            "temperature_exponent",
            Bound::closed(0.0, 8.0),
            "exponent t of friction with temperature (EN-2)",
        ),
        hot_k: friction.number(
            "hot_degc",
            Bound::closed(60.0, 130.0),
            "temperature of the warm engine (EN-2)",
        ),
        viscous_share: friction.number(
            "viscous_share",
            share,
            "share of friction that follows the oil's viscosity (EN-2)",
        ),
        viscous_exponent: friction.number(
            "viscous_exponent",
            Bound::closed(0.0, 1.5),
            "exponent of viscosity (EN-2)",
        ),
        reference_oil: reference_oil(&friction),
        overrun_drag: friction.number_or(
            "overrun_factor",
            Bound::closed(1.0, 3.0),
            1.0,
            "closed-throttle drag over friction (EN-7)",
        ),
        enrichment: fuel.number(
            "cold_enrichment",
            Bound::closed(0.0, 2.0),
            "extra fuel at 0 degC coolant, none from 60 degC (EN-3)",
        ),
        electrical_w: s.number(
            "electrical_w",
            Bound::closed(0.0, 5000.0),
            "electrical load at the shaft (EN-4)",
        ),
        accessory_nm: s.number(
            "accessory_nm",
            Bound::closed(0.0, 20.0),
            "torque of pumps and belts (EN-4)",
        ),
        exhaust_idle: heat.number(
            "exhaust_share_idle",
            share,
            "share of waste heat in the exhaust at idle (EN-6)",
        ),
        exhaust_fast: heat.number(
            "exhaust_share_fast",
            share,
            "share at the largest speed (EN-6)",
        ),
        friction_to_oil: heat.number(
            "friction_to_oil",
            share,
            "share of friction heat that goes to the oil (EN-6)",
        ),
        heating_value_j_kg: fuel.number(
            "heating_value_mj_kg",
            Bound::closed(20.0, 60.0),
            "lower heating value",
        ),
        fuel_density_kg_m3: fuel.number(
            "density_kg_m3",
            Bound::closed(500.0, 1000.0),
            "density of the fuel",
        ),
        co2_kg_kg: fuel.number(
            "co2_per_fuel",
            Bound::closed(0.0, 4.0),
            "CO2 per mass of fuel",
        ),
        fuel: {
            let (model, table) = fuel_model(s, files, displacement_m3);
            line = table;
            model
        },
    };
    check_efficiency(&line, &engine);
    engine
}

/// The line's efficiency at no load, at every speed of the engine: what leaves the bounds would make fuel of work, or work of nothing.
fn check_efficiency(willans: &Section, engine: &Engine) {
    let FuelModel::Willans(line) = &engine.fuel else {
        return;
    };
    let fastest = engine.piston_m_s(engine.highest_rad_s);
    let bend = if line.c.abs() > 0.0 {
        held(-0.5 * line.b / line.c, 0.0, fastest)
    } else {
        0.0
    };
    // What could not be read is no number, and has its own complaint.
    let outside = |speed: &f64| {
        line.efficiency(*speed) < *EFFICIENCY.start() || line.efficiency(*speed) > *EFFICIENCY.end()
    };
    if let Some(speed) = [0.0, bend, fastest].into_iter().find(outside) {
        let what = format!(
            "the engine's efficiency a + b v + c v² is {:.2} at a piston speed v of {speed:.1} m/s",
            line.efficiency(speed)
        );
        let allowed = format!(
            "{} to {} from rest to highest_rpm",
            EFFICIENCY.start(),
            EFFICIENCY.end()
        );
        willans.complain(
            "a",
            &allowed,
            &what,
            "the three belong together: change a, b or c, or lower highest_rpm",
        );
    }
}

fn full_load(s: &Section) -> Curve {
    let columns = [
        ("speed_rpm", Bound::closed(0.0, 15_000.0)),
        ("torque_nm", Bound::open_low(0.0, 2000.0)),
    ];
    let points = s.required_rows(
        "full_load",
        &columns,
        "full-load line: rows [speed rpm, torque Nm], at sea level",
    );
    points.map_or_else(
        || Curve::constant(1.0),
        |points| tables::curve(s, "full_load", &points),
    )
}

fn reference_oil(s: &Section) -> Viscosity {
    let allowed = Bound::closed(1.5, 1000.0);
    let kv40 = s.number(
        "reference_kv40_mm2_s",
        allowed,
        "reference oil at 40 degC, for which the temperature exponent holds (EN-2)",
    );
    let kv100 = s.number(
        "reference_kv100_mm2_s",
        allowed,
        "reference oil at 100 degC (EN-2)",
    );
    tables::viscosity(s, "reference_kv40_mm2_s", kv40, kv100)
}

/// The fuel model, and the table that it stands in.
fn fuel_model<'r>(
    s: &Section<'r>,
    files: &dyn Files,
    displacement_m3: f64,
) -> (FuelModel, Section<'r>) {
    let (kind, w) = s.choose(
        "model",
        &["willans", "bsfc_map"],
        Some("willans"),
        "fuel model: extended Willans line, or a BSFC map from CSV",
    );
    let d = DEFAULT;
    let l = w.number_or(
        "l",
        Bound::closed(0.0, 5.0),
        d.l,
        "hot friction mean effective pressure at zero speed, bar (WI-1, BM-2)",
    );
    let l2 = w.number_or(
        "l2",
        Bound::closed(0.0, 0.05),
        d.l2,
        "its rise with piston speed squared, bar s2/m2 (WI-1, BM-2)",
    );
    if kind == "bsfc_map" {
        let file = w.text(
            "file",
            "CSV with speed_rpm, bmep_bar or torque_nm, bsfc_g_kwh on a full grid (BM-1)",
        );
        let lhv = s.table("fuel").number(
            "heating_value_mj_kg",
            Bound::closed(20.0, 60.0),
            "lower heating value",
        );
        let model = match tables::bsfc_map(&w, &file, files, lhv, displacement_m3) {
            Some(map) => FuelModel::Map(BsfcMap {
                friction: (l, l2),
                ..map
            }),
            None => FuelModel::Willans(d),
        };
        return (model, w);
    }
    let line = Willans {
        a: w.number_or(
            "a",
            Bound::closed(0.2, 0.7),
            d.a,
            "indicated efficiency at zero speed and load (WI-1)",
        ),
        b: w.number_or(
            "b",
            Bound::closed(-0.02, 0.05),
            d.b,
            "its rise with piston speed, s/m (WI-1)",
        ),
        c: w.number_or(
            "c",
            Bound::closed(-0.01, 0.001),
            d.c,
            "its bend with piston speed, s2/m2 (WI-1)",
        ),
        a2: w.number_or(
            "a2",
            Bound::closed(-0.02, 0.0),
            d.a2,
            "fall of efficiency with load, 1/bar (WI-1)",
        ),
        l,
        l2,
    };
    (FuelModel::Willans(line), w)
}

/// Spark ignition, natural aspiration (CO2MPAS default set).
const DEFAULT: Willans = Willans {
    a: 0.4851,
    b: 0.01193,
    c: -0.000_65,
    a2: -0.003_85,
    l: 2.398_82,
    l2: 0.002_86,
};

/// Rubbing friction of the default Willans line: at rest, and its rise with piston speed.
pub(crate) const DEFAULT_FRICTION: (f64, f64) = (DEFAULT.l, DEFAULT.l2);
