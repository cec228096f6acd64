//! Variables of a CVT driven by a torque.

use cvtcycle_model::lubricant::VALID_K;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

use super::{Causality, CvtResult, Get, Variable, car, flag_words, input, mechanical, row};

/// Torque at the flywheel, Nm.
pub const TORQUE: usize = 1;
/// Speed of the wheels, rad/s.
pub const SPEED: usize = 2;
/// Requested belt ratio.
pub const RATIO: usize = 3;
/// Oil in the sump, K.
pub const OIL: usize = 4;
/// Coolant and engine oil, K.
pub const COOLANT: usize = 5;

/// Temperature of a warm engine, K.
const WARM_K: f64 = 363.15;

/// Adds the rows for a transmission. A manual box has no such unit.
pub(super) fn rows(transmission: &Transmission, all: &mut Vec<Variable>) {
    let Transmission::Cvt(cvt) = transmission else {
        return;
    };
    all.extend([
        input(
            "trq_FW_PNT_in_Nm",
            "N.m",
            0.0,
            (-2000.0, 2000.0),
            "torque of the engine at the flywheel in the coming step; the inertia of engine and flywheel is in this unit",
        ),
        input(
            "w_DS_PNT_in_radps",
            "rad/s",
            0.0,
            (0.0, 400.0),
            "speed of the drive shafts at the end of the coming step; linear from that of the step before",
        ),
        input(
            "ratio_VAR_in",
            "1",
            cvt.ratio.low,
            (cvt.ratio.high, cvt.ratio.low),
            "belt ratio that is asked for; the box goes there as fast as its shift rate and its oil allow",
        ),
        input(
            "T_oil_AT_PNT_in_K",
            "K",
            353.15,
            (*VALID_K.start(), *VALID_K.end()),
            "transmission oil in the sump",
        ),
        input(
            "T_cool_ENG_PNT_in_K",
            "K",
            WARM_K,
            (car::AMBIENT_RANGE_K.0, car::START_RANGE_K.1),
            "coolant and oil of the engine: its idle speed, its drag and its full load",
        ),
    ]);
    let mut output = |name: &str, unit: &'static str, get, description: &str| {
        all.push(Variable {
            get: Get::Cvt(get),
            whole: unit.is_empty(),
            unit: if unit.is_empty() { "1" } else { unit },
            ..row(name, Causality::Output, unit, description)
        });
    };
    power(&mut output);
    inside(&mut output);
}

type CvtOutput<'f> = dyn FnMut(&str, &'static str, fn(&CvtResult) -> f64, &str) + 'f;

fn power(output: &mut CvtOutput) {
    output(
        "w_ENG_PNT_radps",
        "rad/s",
        |c| c.turned.output.engine_rad_s,
        "engine speed, back to the engine",
    );
    output(
        "trq_DS_PNT_out_Nm",
        "N.m",
        |c| c.turned.wheel_nm(),
        "torque at the drive shafts, after the final drive",
    );
    output(
        "w_DS_PNT_radps",
        "rad/s",
        |c| c.turned.wheel_rad_s,
        "mean speed of the drive shafts in the step, 0.02 at least",
    );
    output(
        "trq_FW_PNT_out_Nm",
        "N.m",
        |c| c.turned.taken_nm,
        "torque taken at the flywheel, that of inertia included: the one given, or the nearest that box and engine of the file allow",
    );
    output(
        "P_kin_AT_PNT_W",
        "W",
        |c| c.turned.kinetic_w,
        "power into the rotating energy of engine, flywheel and primary shaft",
    );
    output(
        "trq_R_AT_PNT_Nm",
        "N.m",
        |c| c.turned.wheel_nm() - c.turned.output.shaft_nm,
        "torque that holds the case: that of the drive shafts less that of the flywheel",
    );
}

/// The unit `""` marks an integer.
fn inside(output: &mut CvtOutput) {
    output(
        "ratio_AT",
        "1",
        |c| c.turned.output.belt_ratio * c.turned.output.range_ratio * c.cvt.final_drive.ratio,
        "ratio of the transmission: belt ratio times range and final drive",
    );
    output(
        "ratio_VAR",
        "1",
        |c| c.turned.output.belt_ratio,
        "belt ratio at the end of the step, secondary over primary running radius",
    );
    output(
        "p_line_Pa",
        "Pa",
        |c| c.turned.output.secondary_pa,
        "pressure of the secondary pulley, by the clamp law of the box",
    );
    output(
        "p_pri_Pa",
        "Pa",
        |c| c.turned.output.primary_pa,
        "pressure of the primary pulley",
    );
    output(
        "T_belt_AT_PNT_K",
        "K",
        |c| c.belt_k,
        "belt, pulleys and the oil sprayed off them",
    );
    output(
        "Qf_HYD_PNT_W",
        "W",
        |c| c.turned.output.loss_w[Component::Pump],
        "heat of the pump into the oil",
    );
    output(
        "Qf_GB_PNT_W",
        "W",
        |c| mechanical(&c.turned.output.loss_w),
        "heat of all other losses, launch device included",
    );
    output(
        "P_el_AT_PNT_W",
        "W",
        |c| c.turned.output.alternator_w,
        "power that an electric pump takes from the flywheel by way of the alternator, beyond its own loss",
    );
    output(
        "flags_AT_PNT",
        "",
        |c| f64::from(c.turned.output.flags.0),
        &flag_words(),
    );
}
