//! The variables of a whole car.

use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

use super::{CarResult, Causality, Get, Variable, flag_words, input, mechanical, row};

/// Vehicle speed, m/s.
pub const SPEED: usize = 1;
/// Slope.
pub const GRADE: usize = 2;
/// Ambient, K.
pub const AMBIENT: usize = 3;
/// Temperature at the start, K.
pub const START: usize = 4;
/// Gear of a manual box.
pub const GEAR: usize = 5;

/// Maximum grade, as in tables of cycles.
const MAX_GRADE: f64 = 0.35;
/// Ambient temperatures of a run, K.
pub(crate) const AMBIENT_RANGE_K: (f64, f64) = (233.15, 333.15);
/// Default ambient, K, as in a run.
pub(crate) const START_AMBIENT_K: f64 = 298.15;
/// Maximum speed, m/s: that of a cycle, 300 km/h.
const MAX_SPEED_M_S: f64 = 300.0 / 3.6;
/// Range of the initial temperature of all parts, K; 0 means the ambient.
pub(crate) const START_RANGE_K: (f64, f64) = (0.0, 403.15);

/// Adds the rows for a transmission.
pub(super) fn rows(transmission: &Transmission, all: &mut Vec<Variable>) {
    use Causality::{Output, Parameter};
    all.extend([
        input(
            "v_VEH_PNT_in_mps",
            "m/s",
            0.0,
            (0.0, MAX_SPEED_M_S),
            "vehicle speed at the end of the coming step; linear from that of the step before. A master that sets the speed at the beginning of the step drives the same trace one step later",
        ),
        input(
            "grade_VEH_PNT_in",
            "1",
            0.0,
            (-MAX_GRADE, MAX_GRADE),
            "slope of the road in the coming step, rise over run",
        ),
        input(
            "T_AMB_PNT_in_K",
            "K",
            START_AMBIENT_K,
            AMBIENT_RANGE_K,
            "ambient temperature",
        ),
        Variable {
            range: START_RANGE_K,
            ..row(
                "T_start_VEH_PNT_K",
                Parameter,
                "K",
                "temperature of all parts at the start, 233.15 or more; 0: as ambient",
            )
        },
    ]);
    if let Transmission::Manual(manual) = transmission {
        all.push(Variable {
            whole: true,
            ..input(
                "gear_AT_PNT_in",
                "1",
                -1.0,
                (-1.0, manual.overall.len() as f64),
                "gear of the coming step; 0 neutral, -1 by the shift speeds of the car",
            )
        });
    }
    let mut output = |name: &str, unit: &'static str, get, description: &str| {
        all.push(Variable {
            get: Get::Car(get),
            whole: unit.is_empty(),
            unit: if unit.is_empty() { "1" } else { unit },
            ..row(name, Output, unit, description)
        });
    };
    outputs(transmission.is_cvt(), &mut output);
}

type CarOutput<'f> = dyn FnMut(&str, &'static str, fn(&CarResult) -> f64, &str) + 'f;

/// Means over the last step, and temperatures at its end. The unit `""` marks an integer.
fn outputs(is_cvt: bool, output: &mut CarOutput) {
    motion(output);
    ratio(is_cvt, output);
    heat(output);
}

fn motion(output: &mut CarOutput) {
    output(
        "mf_fuel_ENG_PNT_out_kgps",
        "kg/s",
        |c| c.row.fuel_kg_s,
        "fuel mass flow",
    );
    output(
        "m_fuel_ENG_PNT_out_kg",
        "kg",
        |c| c.fuel_kg,
        "fuel since the start",
    );
    output(
        "s_VEH_PNT_out_m",
        "m",
        |c| c.distance_m,
        "distance since the start",
    );
    output(
        "w_ENG_PNT_radps",
        "rad/s",
        |c| c.row.engine_speed_rad_s,
        "engine speed",
    );
    output(
        "trq_FW_PNT_out_Nm",
        "N.m",
        |c| c.row.engine_torque_nm,
        "torque at the flywheel into the transmission",
    );
    output(
        "w_DS_PNT_out_radps",
        "rad/s",
        |c| c.row.speed_m_s / c.car.road_load.wheel_radius_m,
        "speed of the wheels",
    );
    output(
        "trq_DS_PNT_out_Nm",
        "N.m",
        |c| c.row.wheel_torque_nm,
        "torque at the driven wheels that the speed demands",
    );
    output(
        "P_deficit_VEH_PNT_W",
        "W",
        |c| c.row.deficit_w,
        "demanded power that the engine cannot give",
    );
    output(
        "P_brake_VEH_PNT_W",
        "W",
        |c| c.row.brake_w,
        "power into the wheel brakes",
    );
}

fn ratio(is_cvt: bool, output: &mut CarOutput) {
    if is_cvt {
        output(
            "ratio_AT",
            "1",
            |c| c.row.belt_ratio * c.row.range_ratio * final_ratio(c),
            "ratio of the transmission: belt ratio times range and final drive",
        );
        output(
            "ratio_VAR",
            "1",
            |c| c.row.belt_ratio,
            "belt ratio, secondary over primary running radius",
        );
        output(
            "p_line_Pa",
            "Pa",
            |c| c.row.secondary_pressure_pa,
            "pressure of the secondary pulley",
        );
        output(
            "p_pri_Pa",
            "Pa",
            |c| c.row.primary_pressure_pa,
            "pressure of the primary pulley",
        );
        output(
            "T_belt_AT_PNT_K",
            "K",
            |c| c.row.belt_spray_k,
            "belt, pulleys and the oil sprayed off them",
        );
    } else {
        output("gear_AT", "", |c| f64::from(c.row.gear), "gear; 0 neutral");
    }
}

fn heat(output: &mut CarOutput) {
    output(
        "ToutOil",
        "K",
        |c| c.row.sump_k,
        "transmission oil in the sump",
    );
    output(
        "T_case_AT_PNT_K",
        "K",
        |c| c.row.metal_k,
        "case and shafts of the transmission",
    );
    output(
        "T_cool_ENG_PNT_K",
        "K",
        |c| c.row.coolant_k,
        "coolant and block of the engine",
    );
    output("T_oil_ENG_PNT_K", "K", |c| c.row.engine_oil_k, "engine oil");
    output(
        "Qf_HYD_PNT_W",
        "W",
        |c| c.row.loss_w[Component::Pump],
        "heat of the pump into the oil",
    );
    output(
        "Qf_GB_PNT_W",
        "W",
        |c| mechanical(&c.row.loss_w),
        "heat of all other losses of the transmission",
    );
    output(
        "Qf_ENG_PNT_W",
        "W",
        |c| c.row.engine_heat_w,
        "heat into coolant, block and oil of the engine",
    );
    output(
        "throttle_ENG_PNT",
        "1",
        |c| c.row.throttle,
        "engine torque over full load",
    );
    output(
        "flags_VEH_PNT",
        "",
        |c| f64::from(c.row.flags.0),
        &flag_words(),
    );
}

fn final_ratio(result: &CarResult) -> f64 {
    match &result.car.transmission {
        Transmission::Cvt(cvt) => cvt.final_drive.ratio,
        Transmission::Manual(_) => 1.0,
    }
}
