//! Figures of the two controllers.

use super::reference::{RPM, Reference};
use super::{Line, axes, plot, sweep};
use cvtcycle::model::transmission::cvt::controller::{ClampLaw, ClampSignals, RatioDemand};
use cvtcycle::model::transmission::cvt::variator::{BeltAtRatio, Formulation};

/// Figures by file name.
pub fn figures(r: &Reference) -> Vec<(&'static str, String)> {
    vec![
        ("ratio_variogram", variogram(r)),
        ("clamping_map", clamp_map(r)),
    ]
}

fn demand(r: &Reference, share: f64) -> RatioDemand {
    let cvt = r.cvt();
    let rated_w = r.cvt_car.car(298.15).engine.rated_w;
    let power_w = share * rated_w;
    RatioDemand {
        begins: None,
        secondary_rad_s: 0.0,
        primary_rad_s: 0.0,
        speed_m_s: 0.0,
        power_w,
        share,
        full_load_rad_s: cvt.full_load_route.at(power_w / cvt.ratio.route_efficiency),
        mapped_rad_s: None,
        cold_rad_s: 0.0,
        ratio_before: cvt.ratio.low,
        flow_down_per_s: f64::INFINITY,
        flow_up_per_s: f64::INFINITY,
        coupled: true,
        locks_at: 0.0,
        last_direction: 0,
        free_up_to_rad_s: 0.0,
        dt_s: 1.0,
    }
}

fn variogram(r: &Reference) -> String {
    let cvt = r.cvt();
    let radius_m = r.cvt_car.road_load.base.wheel_radius_m;
    // Engine speed at a road speed for a belt ratio, rpm.
    let geared = |kmh: f64, ratio: f64| kmh / 3.6 / radius_m * cvt.final_drive.ratio * ratio / RPM;
    let limit = |name: &str, ratio: f64| {
        let mut line = sweep(name, 0.0, 180.0, 360, |v| geared(v, ratio));
        line.points.retain(|p| p.1 <= 6200.0);
        line
    };
    let steady = |name: &str, share: f64| {
        let target = cvt.ratio.target_rad_s(&demand(r, share)) / RPM;
        let mut line = sweep(name, 0.0, 180.0, 360, |v| {
            let (low, high) = (geared(v, cvt.ratio.low), geared(v, cvt.ratio.high));
            if target > low {
                low
            } else if target < high {
                high
            } else {
                target
            }
        });
        line.points.retain(|p| p.1 <= 6200.0);
        line
    };
    let lines = vec![
        limit("lowest ratio", cvt.ratio.low),
        limit("highest ratio", cvt.ratio.high),
        steady("gentle (below 15 % power)", 0.10),
        steady("30 % of rated power", 0.30),
        steady("60 % of rated power", 0.60),
        steady("overrun", -0.05),
    ];
    plot(
        "Variogram",
        "engine speed that the control ends at for a steady demand at the wheels, clutch closed",
        "Engine speed against road speed: the lines of lowest and highest ratio and the controller's targets between them.",
        "",
        vec![axes("", "Road speed [km/h]", "Engine speed [rpm]", lines)],
    )
}

fn clamp_map(r: &Reference) -> String {
    let cvt = r.cvt();
    let belt = r.belt(Formulation::Smooth);
    let ClampLaw::Map(map) = &cvt.clamp else {
        return String::new();
    };
    let bar = |ratio: f64, rpm: f64, throttle: f64, degc: f64| {
        let radius_factor = cvt.radius_factor(&BeltAtRatio::new(&belt, ratio));
        let pa = map.pressure_pa(&ClampSignals {
            throttle,
            engine_rad_s: rpm * RPM,
            oil_k: degc + 273.15,
            radius_factor,
            force_log: 0.0,
        });
        pa.clamp(cvt.floors.control_pa, cvt.cap_pa) / 1e5
    };
    let (high, low) = (cvt.ratio.high, cvt.ratio.low);
    let throttles = [0.0, 0.25, 0.5, 1.0];
    let over_ratio: Vec<Line> = throttles
        .iter()
        .map(|&u| {
            sweep(
                &format!("throttle {:.0} %", 100.0 * u),
                high,
                low,
                200,
                |i| bar(i, 2500.0, u, 80.0),
            )
        })
        .collect();
    let over_speed: Vec<Line> = throttles
        .iter()
        .map(|&u| {
            sweep(
                &format!("throttle {:.0} %", 100.0 * u),
                800.0,
                4000.0,
                200,
                |n| bar(1.5, n, u, 80.0),
            )
        })
        .collect();
    let y = "Secondary pressure [bar]";
    plot(
        "Clamp map of the Rover",
        "PC-1 and PC-2 between floor and cap, oil at 80 degC",
        "Secondary pressure against belt ratio and against engine speed at four throttle openings.",
        "",
        vec![
            axes("2500 rpm", "Belt ratio I [-]", y, over_ratio),
            axes("I = 1.5", "Engine speed [rpm]", y, over_speed),
        ],
    )
}
