//! Keys of `[engine]`, and an engine from their values.

use super::start_stop::{StartStop, StartStopKeys};
use super::{EFFICIENCY, Engine, FuelModel, Motored, Willans};
use crate::keys::{Bound, Choice, Repeat, Values, curve, keys};
use crate::lubricant::{Viscosity, viscosity};
use crate::maps::{Basis, BsfcMap};
use crate::math::{Curve, clamp};

keys! {
    /// Keys of `[engine]` and its tables.
    ENGINE: EngineKeys = "engine" [
        IdleKeys::TABLE, FrictionKeys::TABLE, FuelKeys::TABLE, HeatKeys::TABLE, StartStopKeys::TABLE.repeated(Repeat::Optional)
    ] {
        displacement_cc: number(200.0, 10_000.0), "swept volume";
        stroke_mm: number(40.0, 150.0), "piston stroke";
        rated_kw: number(5.0, 600.0), "rated power; the ratio controller's measure of power";
        full_load: rows(&[("speed_rpm", Bound::closed(0.0, 15_000.0)), ("torque_nm", Bound::open_low(0.0, 2000.0))]), "full-load line: rows [speed rpm, torque Nm], at sea level";
        highest_rpm: number(300.0, 12_000.0), "largest speed; above it rows are flagged overspeed";
        inertia_kg_m2: above(0.0, 5.0), "engine, flywheel and primary side", ["SI-1"];
        inertia_torque_nm: or(60.0, number(5.0, 500.0)), "largest torque that changes the speed of the rotating parts", ["SI-2"];
        electrical_w: number(0.0, 5000.0), "electrical load at the shaft", ["EN-4"];
        accessory_nm: number(0.0, 20.0), "torque of pumps and belts", ["EN-4"];
        model: or_word("willans", options(&[
            Choice::new("willans", "extended Willans line", WillansKeys::TABLE),
            Choice::new("bsfc_map", "BSFC map from CSV", BsfcKeys::TABLE),
        ])), "fuel model: extended Willans line, or a BSFC map from CSV";
    }

    /// Keys of `[engine.idle]`.
    IDLE: IdleKeys = "idle" [] {
        hot_rpm: number(400.0, 2000.0), "idle speed, warm", ["EN-1"];
        cold_rpm: number(400.0, 3000.0), "idle speed at cold_degc and below", ["EN-1"];
        cold_degc: or(37.0, number(-40.0, 60.0)), "coolant up to which idle is cold_rpm", ["EN-1"];
        warm_degc: or(71.0, number(0.0, 110.0)), "coolant from which idle is hot_rpm", ["EN-1"];
        after_start_rpm: or(0.0, number(0.0, 2000.0)), "idle speed above that at a cold start", ["EN-1"];
        after_start_s: or(30.0, above(0.0, 300.0)), "time in which that falls to nothing", ["EN-1"];
    }

    /// Keys of `[engine.friction]`.
    FRICTION: FrictionKeys = "friction" [OverrunKeys::TABLE.repeated(Repeat::Optional)] {
        hot_degc: number(60.0, 130.0), "temperature of the warm engine", ["EN-2"];
        viscous_share: number(0.0, 1.0), "share of hot friction that rubs in oil and follows its viscosity", ["EN-2"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["EN-2"];
        film_coolant_share: or(0.0, number(0.0, 1.0)), "temperature of the oil films, from that of the oil (0) to that of the coolant (1)", ["EN-2"];
        reference_kv40_mm2_s: number(1.5, 1000.0), "reference oil at 40 degC, for which the hot friction holds", ["EN-2"];
        reference_kv100_mm2_s: number(1.5, 1000.0), "reference oil at 100 degC", ["EN-2"];
        overrun_factor: or(1.0, number(1.0, 3.0)), "closed-throttle drag over friction, or over that of [engine.friction.overrun] where it is present", ["EN-7"];
    }

    /// Keys of `[engine.friction.overrun]`: the hot engine's drag without fuel, in place of its friction.
    OVERRUN: OverrunKeys = "overrun" [] {
        drag_bar: number(0.05, 5.0), "closed-throttle motoring mean effective pressure of the hot engine at no speed", ["EN-7", "WI-3"];
        drag_bar_per_m_s: or(0.0, number(0.0, 0.5)), "its rise with mean piston speed", ["EN-7", "WI-3"];
        drag_bar_per_m_s2: or(0.0, number(0.0, 0.05)), "its rise with the square of that", ["EN-7", "WI-3"];
    }

    /// Keys of `[engine.fuel]`.
    FUEL: FuelKeys = "fuel" [] {
        cold_enrichment: number(0.0, 2.0), "extra fuel at 0 degC coolant and below, none from 60 degC", ["EN-3"];
        start_g: or(0.0, number(0.0, 100.0)), "fuel of a start at 0 degC and below, none from 60 degC", ["EN-9"];
        start_s: or(30.0, above(0.0, 300.0)), "time in which it is given", ["EN-9"];
        cut_from_degc: or(45.0, number(-40.0, 110.0)), "coolant from which fuel is cut in overrun", ["EN-11"];
        cut_above_rpm: or(1400.0, number(500.0, 6000.0)), "engine speed above which all of it is cut", ["EN-11"];
        fuel_back_rpm: or(1300.0, number(400.0, 6000.0)), "engine speed below which none is cut", ["EN-11"];
        heating_value_mj_kg: number(20.0, 60.0), "lower heating value";
        density_kg_m3: number(500.0, 1000.0), "density of the fuel";
        co2_per_fuel: number(0.0, 4.0), "CO2 per mass of fuel";
    }

    /// Keys of `[engine.heat]`.
    HEAT: HeatKeys = "heat" [] {
        exhaust_share_idle: number(0.0, 1.0), "share of waste heat in the exhaust at idle", ["EN-6"];
        exhaust_share_fast: number(0.0, 1.0), "share at the largest speed", ["EN-6"];
        friction_to_oil: number(0.0, 1.0), "share of friction heat that goes to the oil", ["EN-6"];
    }

    /// Keys of `[engine.model.willans]`.
    WILLANS: WillansKeys = "willans" [] {
        l: or(DEFAULT.l, number(0.0, 5.0)), "hot friction mean effective pressure at zero speed, bar", ["WI-1", "BM-2"];
        l2: or(DEFAULT.l2, number(0.0, 0.05)), "its rise with piston speed squared, bar s2/m2", ["WI-1", "BM-2"];
        a: or(DEFAULT.a, number(0.2, 0.7)), "indicated efficiency at zero speed and load", ["WI-1"];
        b: or(DEFAULT.b, number(-0.02, 0.05)), "its rise with piston speed, s/m", ["WI-1"];
        c: or(DEFAULT.c, number(-0.01, 0.001)), "its bend with piston speed, s2/m2", ["WI-1"];
        a2: or(DEFAULT.a2, number(-0.02, 0.0)), "fall of efficiency with load, 1/bar", ["WI-1"];
        fitted_bar: optional(number(2.0, 40.0)), "brake mean effective pressure up to which the line was fitted; a full load far above it is doubted";
    }

    /// Keys of `[engine.model.bsfc_map]`.
    BSFC: BsfcKeys = "bsfc_map" [] {
        l: or(DEFAULT.l, number(0.0, 5.0)), "hot friction mean effective pressure at zero speed, bar", ["WI-1", "BM-2"];
        l2: or(DEFAULT.l2, number(0.0, 0.05)), "its rise with piston speed squared, bar s2/m2", ["WI-1", "BM-2"];
        measured_cc: optional(number(200.0, 20_000.0)), "swept volume of the engine that was measured, for a file with torque_nm or fuel_g_s; absent: that of the car", ["BM-1"];
        measured_mj_kg: optional(number(20.0, 60.0)), "lower heating value of the fuel that it burnt; absent: that of the car's fuel", ["BM-1"];
        measured_cylinders: optional(number(1.0, 16.0)), "its number of cylinders, for a file with fuel for a stroke (fuel_mg_stroke)", ["BM-1"];
        file: csv(), "table, matrix or ADVISOR file with speed, load (bmep_bar, torque_nm or power_kw) and fuel (bsfc_g_kwh, fuel_g_s, fuel_mg_stroke or efficiency_percent), each in its units; a grid, or points; with a flow loads may be zero and below", ["BM-1", "BM-4"];
    }
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

impl Engine {
    /// A checked engine from the values of `[engine]`.
    pub fn from_values<V: Values>(s: &V) -> Self {
        let (friction, idle) = (s.table("friction"), s.table("idle"));
        let (fuel, heat) = (s.table("fuel"), s.table("heat"));
        let stopping = s.table("start_stop");
        let displacement_m3 = s.number(&ENGINE.displacement_cc);
        let hot_k = friction.number(&FRICTION.hot_degc);
        let (fuel_model, line, fitted_pa) = fuel_model(s, displacement_m3);
        let engine = Engine {
            displacement_m3,
            stroke_m: s.number(&ENGINE.stroke_mm),
            rated_w: s.number(&ENGINE.rated_kw),
            full_load: full_load(s),
            highest_rad_s: s.number(&ENGINE.highest_rpm),
            inertia_kg_m2: s.number(&ENGINE.inertia_kg_m2),
            inertia_torque_nm: s.number(&ENGINE.inertia_torque_nm),
            idle_hot_rad_s: idle.number(&IDLE.hot_rpm),
            idle_cold_rad_s: idle.number(&IDLE.cold_rpm),
            idle_cold_k: idle.number(&IDLE.cold_degc),
            idle_warm_k: idle.number(&IDLE.warm_degc),
            idle_after_start_rad_s: idle.number(&IDLE.after_start_rpm),
            idle_after_start_s: idle.number(&IDLE.after_start_s),
            hot_k,
            viscous_share: friction.number(&FRICTION.viscous_share),
            viscous_exponent: friction.number(&FRICTION.viscous_exponent),
            reference_m2_s: reference_oil(&friction).kinematic_m2_s(hot_k),
            film_coolant_share: friction.number(&FRICTION.film_coolant_share),
            overrun_drag: friction.number(&FRICTION.overrun_factor),
            motored: motored(&friction.table(OverrunKeys::TABLE.name)),
            enrichment: fuel.number(&FUEL.cold_enrichment),
            start_kg: fuel.number(&FUEL.start_g),
            start_s: fuel.number(&FUEL.start_s),
            cut_from_k: fuel.number(&FUEL.cut_from_degc),
            cut_above_rad_s: fuel.number(&FUEL.cut_above_rpm),
            fuel_back_rad_s: fuel.number(&FUEL.fuel_back_rpm),
            electrical_w: s.number(&ENGINE.electrical_w),
            accessory_nm: s.number(&ENGINE.accessory_nm),
            exhaust_idle: heat.number(&HEAT.exhaust_share_idle),
            exhaust_fast: heat.number(&HEAT.exhaust_share_fast),
            friction_to_oil: heat.number(&HEAT.friction_to_oil),
            heating_value_j_kg: fuel.number(&FUEL.heating_value_mj_kg),
            fuel_density_kg_m3: fuel.number(&FUEL.density_kg_m3),
            co2_kg_kg: fuel.number(&FUEL.co2_per_fuel),
            fuel: fuel_model,
            fitted_pa,
            start_stop: StartStop::from_values(&stopping),
        };
        if let Some(on) = &engine.start_stop {
            on.check_store(&stopping, &engine);
        }
        check_efficiency(&line, &engine);
        check_map(&line, &engine);
        check_pairs(&idle, &fuel, &engine);
        engine
    }
}

/// Pairs of values of which one is below the other.
fn check_pairs<V: Values>(idle: &V, fuel: &V, engine: &Engine) {
    if engine.idle_warm_k <= engine.idle_cold_k {
        idle.complain(
            IDLE.warm_degc.name,
            "above cold_degc",
            "idle would be hot before it ceases to be cold",
            "raise it or lower `cold_degc`",
        );
    }
    if engine.fuel_back_rad_s >= engine.cut_above_rad_s {
        fuel.complain(
            FUEL.fuel_back_rpm.name,
            "below cut_above_rpm",
            "fuel would be back at the speed at which it is cut",
            "lower it or raise `cut_above_rpm`",
        );
    }
}

/// The line's efficiency at no load, at every speed of the engine: what leaves the bounds would make fuel of work, or work of nothing.
fn check_efficiency<V: Values>(willans: &V, engine: &Engine) {
    let FuelModel::Willans(line) = &engine.fuel else {
        return;
    };
    let fastest = engine.piston_m_s(engine.highest_rad_s);
    let bend = if line.c.abs() > 0.0 {
        clamp(-0.5 * line.b / line.c, 0.0, fastest)
    } else {
        0.0
    };
    // NaN marks a value that could not be read and has its own problem.
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

/// The points of a measured map below full load.
fn check_map<V: Values>(map_keys: &V, engine: &Engine) {
    if let FuelModel::Map(map) = &engine.fuel
        && let Some(why) = map.judge(|speed| engine.full_load_pa(speed)).refusal
    {
        map_keys.complain(BSFC.file.name, &why.allowed, &why.message, &why.hint);
    }
}

fn full_load<V: Values>(s: &V) -> Curve {
    match s.rows(&ENGINE.full_load) {
        Some(points) => curve(s, &ENGINE.full_load, &points),
        None => Curve::constant(1.0),
    }
}

fn reference_oil<V: Values>(s: &V) -> Viscosity {
    let kv40 = s.number(&FRICTION.reference_kv40_mm2_s);
    let kv100 = s.number(&FRICTION.reference_kv100_mm2_s);
    let points = [(313.15, kv40), (373.15, kv100)];
    let words = [
        "falling as the oil warms",
        "check the two values and their unit, mm2/s (cSt)",
    ];
    viscosity(s, &FRICTION.reference_kv40_mm2_s, &points, words)
}

/// The drag without fuel, if it is not the friction of the fuel line.
fn motored<V: Values>(s: &V) -> Option<Motored> {
    s.exists().then(|| Motored {
        rest_pa: s.number(&OVERRUN.drag_bar),
        pa_per_m_s: s.number(&OVERRUN.drag_bar_per_m_s),
        pa_per_m_s2: s.number(&OVERRUN.drag_bar_per_m_s2),
    })
}

/// The fuel model, the table of its keys, and the load up to which a Willans line was fitted.
fn fuel_model<V: Values>(s: &V, displacement_m3: f64) -> (FuelModel, V, Option<f64>) {
    let (kind, w) = s.choose(&ENGINE.model);
    if kind == "bsfc_map" {
        let friction = (w.number(&BSFC.l), w.number(&BSFC.l2));
        // NaN marks a value that could not be read and has its own problem.
        let measured = |key| w.optional(key).filter(|value: &f64| value.is_finite());
        let measured_j_kg = measured(&BSFC.measured_mj_kg);
        let heating_value =
            measured_j_kg.unwrap_or_else(|| s.table("fuel").number(&FUEL.heating_value_mj_kg));
        let measured_m3 = measured(&BSFC.measured_cc).unwrap_or(displacement_m3);
        let basis = Basis {
            heating_value_j_kg: heating_value,
            displacement_m3: measured_m3,
            cylinders: measured(&BSFC.measured_cylinders),
        };
        let map = w.bsfc_map(&BSFC.file, &basis);
        let model = map.map_or(FuelModel::Willans(DEFAULT), |map| {
            FuelModel::Map(BsfcMap { friction, ..map })
        });
        return (model, w, None);
    }
    let (l, l2) = (w.number(&WILLANS.l), w.number(&WILLANS.l2));
    let line = Willans {
        a: w.number(&WILLANS.a),
        b: w.number(&WILLANS.b),
        c: w.number(&WILLANS.c),
        a2: w.number(&WILLANS.a2),
        l,
        l2,
    };
    let fitted_pa = w.optional(&WILLANS.fitted_bar);
    (FuelModel::Willans(line), w, fitted_pa)
}
