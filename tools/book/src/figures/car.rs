//! Figures of fluid, engine, road load, warm-up and measured maps.

use super::reference::{RPM, Reference};
use super::{Line, LinePanel, axes, plot, sweep};
use cvtcycle::config::cycle;
use cvtcycle::model::drive::{Conditions, Start, drive};
use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::maps::{LossMap, MapPoint};
use cvtcycle::model::math::Grid;
use cvtcycle::model::prime_mover::PrimeMover;
use cvtcycle::model::road::{Ambient, Surface};
use cvtcycle::model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};

/// Figures by file name.
pub fn figures(r: &Reference) -> Result<Vec<(&'static str, String)>, String> {
    Ok(vec![
        ("engine_fuel", engine(r)),
        ("road_load_force", road_load(r)),
        ("thermal_warm_up", warm_up(r)?),
        ("maps_edge", maps(r)?),
    ])
}

fn engine(r: &Reference) -> String {
    let car = r.cvt_car.car(293.15);
    let now = |degc: f64| {
        car.engine
            .at(degc + ZERO_DEGC_K, degc + ZERO_DEGC_K, &car.engine_oil, 1.0)
    };
    let hot = now(90.0);
    let fuel = |rpm: f64| {
        let w = rpm * RPM;
        let mut line = sweep(&format!("{rpm:.0} rpm"), 2.0, 145.0, 143, |t| {
            3.6e9 * hot.burn(w, t).fuel_kg_s / (t * w)
        });
        line.points
            .retain(|&(t, g)| t <= hot.full_load_nm(w) && g < 900.0);
        line
    };
    let factor = |name: &str, part: &dyn Fn(f64) -> f64| sweep(name, -20.0, 100.0, 120, part);
    let idle_hot = car.engine.idle_hot_rad_s;
    let cold = vec![
        factor("friction over hot friction", &|t| now(t).friction_factor),
        factor("fuel over stoichiometric fuel", &|t| now(t).enrichment),
        factor("idle speed over hot idle speed", &|t| {
            now(t).idle_rad_s / idle_hot
        }),
    ];
    plot(
        "Fuel consumption and what the cold adds",
        "engine of the Rover (WI-1, EN-1 to EN-3), coolant and oil at one temperature",
        "Specific fuel consumption against torque at three speeds with the engine hot; friction, enrichment and idle factors against temperature.",
        "",
        vec![
            LinePanel {
                with_y: vec![200.0],
                ..axes(
                    "Hot",
                    "Crankshaft torque [Nm]",
                    "Fuel [g/kWh]",
                    [1500.0, 2500.0, 4000.0].map(fuel).to_vec(),
                )
            },
            axes("Cold", "Temperature [degC]", "Factor [-]", cold),
        ],
    )
}

fn road_load(r: &Reference) -> String {
    let base = r.cvt_car.road_load.base;
    let rolling = r.cvt_car.road_load.rolling_per_k;
    let force = |name: &str, surface: Surface, degc: f64| {
        let ambient = Ambient {
            temp_k: degc + ZERO_DEGC_K,
            altitude_m: 0.0,
        };
        let load = base.for_ambient(surface, &ambient, rolling);
        sweep(name, 0.0, 130.0, 130, |kmh| {
            let v = kmh / 3.6;
            load.f0_n + load.f1_n_per_m_s * v + load.f2_n_per_m_s2 * v * v
        })
    };
    let lines = vec![
        force(
            "dynamometer at any ambient, road at 20 degC",
            Surface::Dynamometer,
            -10.0,
        ),
        force("road at -10 degC", Surface::Road, -10.0),
    ];
    plot(
        "Road load at constant speed",
        "coefficients of the Rover (RL-1, RL-2)",
        "Force at the wheels against road speed on the dynamometer and on the road at two ambients.",
        "",
        vec![axes("", "Road speed [km/h]", "Force [N]", lines)],
    )
}

fn warm_up(r: &Reference) -> Result<String, String> {
    let cycle = cycle::embedded("ece15_eudc").ok_or("no such cycle: ece15_eudc")?;
    let conditions = Conditions {
        ambient_k: 263.15,
        start: Start::Soak,
        max_dt_s: 1.0,
        keep_rows: true,
    };
    let rows = drive(&r.cvt_car, &cycle, &conditions).rows;
    let names = [
        (COOLANT, "coolant and block"),
        (ENGINE_OIL, "engine oil"),
        (SUMP, "transmission oil"),
        (METAL, "transmission metal"),
        (BELT, "belt, pulleys, spray"),
    ];
    let lines = names
        .map(|(node, name)| {
            let at = |row: &cvtcycle::output::Row| {
                [
                    row.coolant_k,
                    row.engine_oil_k,
                    row.sump_k,
                    row.metal_k,
                    row.belt_spray_k,
                ][node]
                    - ZERO_DEGC_K
            };
            let start = (0.0, conditions.ambient_k - ZERO_DEGC_K);
            let points = std::iter::once(start)
                .chain(
                    rows.iter()
                        .step_by(4)
                        .map(|row| (row.time_s / 60.0, at(row))),
                )
                .collect();
            Line {
                name: name.to_owned(),
                points,
            }
        })
        .to_vec();
    Ok(plot(
        "Warm-up of the five nodes",
        "Rover CVT, ECE15+EUDC from a soak at -10 degC",
        "Temperatures of coolant, engine oil, transmission oil, transmission metal and belt over the cycle.",
        "",
        vec![axes("", "Time [min]", "Temperature [degC]", lines)],
    ))
}

fn maps(r: &Reference) -> Result<String, String> {
    let pump = r.cvt().pump;
    let eta = r.oil().dynamic_pa_s(80.0 + ZERO_DEGC_K);
    let model = |bar: f64| {
        pump.state(&pump.at(eta), 2000.0 * RPM, bar * 1e5, 0.0)
            .torque_nm
            * (1.0 + 0.15 * (0.2 * bar).sin())
    };
    let points = [8.0, 14.0, 22.0, 32.0];
    let rows: Vec<_> = points
        .iter()
        .map(|&bar| ([0.0, 0.0, 0.0, bar * 1e5, 0.0], model(bar)))
        .collect();
    let map = LossMap::new(Grid::from_rows(&rows)?);
    let read = |bar: f64| {
        map.loss_nm(&MapPoint {
            ratio: 1.0,
            input_speed_rad_s: 200.0,
            torque_nm: 0.0,
            pressure_pa: bar * 1e5,
            oil_k: 353.15,
        })
    };
    let inside = |bar: f64| if read(bar).1 { read(bar).0 } else { f64::NAN };
    let outside = |bar: f64| if read(bar).1 { f64::NAN } else { read(bar).0 };
    let lines = vec![
        sweep("what was measured (made up)", 0.0, 40.0, 200, model),
        sweep("read within the map", 0.0, 40.0, 400, inside),
        sweep("held outside, row flagged", 0.0, 40.0, 400, outside),
    ];
    Ok(plot(
        "Reading a map of four pressures",
        "one axis of a torque-loss map; invented curve",
        "An invented loss curve, the piecewise linear reading of a map with four points, and the values held outside it.",
        "",
        vec![axes(
            "",
            "Secondary pressure [bar]",
            "Torque loss [Nm]",
            lines,
        )],
    ))
}
