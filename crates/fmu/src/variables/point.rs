//! Variables of an operating point.

use cvtcycle_model::lubricant::VALID_K;
use cvtcycle_model::rig::solvable_ratios;
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::component::Component;

use super::{Causality, Get, LossResult, Variable, flag_words, input, mechanical, row};

/// Speed of the input shaft, rad/s.
pub const SPEED: usize = 1;
/// Torque at the input shaft, Nm.
pub const TORQUE: usize = 2;
/// Oil in the sump, K.
pub const OIL: usize = 3;
/// Belt ratio or gear.
pub const RATIO: usize = 4;
/// Secondary pressure of a CVT, Pa.
pub const PRESSURE: usize = 5;

/// Adds the rows for a transmission.
pub(super) fn rows(transmission: &Transmission, all: &mut Vec<Variable>) {
    all.extend([
        input(
            "w_FW_PNT_in_radps",
            "rad/s",
            200.0,
            (0.0, 1100.0),
            "speed of the input shaft; at 0 nothing is lost",
        ),
        input(
            "trq_FW_PNT_in_Nm",
            "N.m",
            0.0,
            (-2000.0, 2000.0),
            "torque at the input shaft; negative in overrun",
        ),
        input(
            "T_oil_AT_PNT_in_K",
            "K",
            353.15,
            (*VALID_K.start(), *VALID_K.end()),
            "transmission oil in the sump; the belt is in steady state above it",
        ),
    ]);
    match transmission {
        Transmission::Cvt(cvt) => all.extend([
            input(
                "ratio_VAR_in",
                "1",
                1.0,
                solvable_ratios(&cvt.belt),
                "belt ratio, secondary over primary running radius",
            ),
            input(
                "p_line_in_Pa",
                "Pa",
                0.0,
                (0.0, 1e7),
                "pressure of the secondary pulley; 0: by the clamp law of the box",
            ),
        ]),
        Transmission::Manual(manual) => all.push(Variable {
            whole: true,
            ..input(
                "gear_AT_PNT_in",
                "1",
                1.0,
                (1.0, manual.overall.len() as f64),
                "gear",
            )
        }),
    }
    let mut output = |name: &str, unit: &'static str, get, description: &str| {
        all.push(Variable {
            get: Get::Losses(get),
            whole: unit.is_empty(),
            unit: if unit.is_empty() { "1" } else { unit },
            ..row(name, Causality::Output, unit, description)
        });
    };
    outputs(transmission.is_cvt(), &mut output);
}

type LossOutput<'f> = dyn FnMut(&str, &'static str, fn(&LossResult) -> f64, &str) + 'f;

/// Results at the operating point of the inputs. The unit `""` marks an integer.
fn outputs(is_cvt: bool, output: &mut LossOutput) {
    output(
        "trq_DS_PNT_out_Nm",
        "N.m",
        |l| l.point.output_nm,
        "torque at the output shaft, after the final drive",
    );
    output(
        "w_DS_PNT_out_radps",
        "rad/s",
        |l| l.answer.output_rad_s,
        "speed of the output shaft",
    );
    output(
        "trq_loss_AT_PNT_Nm",
        "N.m",
        |l| l.answer.total_nm(),
        "all losses, torque at the input shaft",
    );
    output(
        "P_loss_AT_PNT_W",
        "W",
        |l| l.answer.total_nm() * l.point.input_rad_s,
        "all losses",
    );
    output(
        "eta_AT",
        "1",
        efficiency,
        "power out over power in, whichever way it flows; 0 where both shafts drive",
    );
    output(
        "Qf_HYD_PNT_W",
        "W",
        |l| l.answer.part_nm(Component::Pump) * l.point.input_rad_s,
        "heat of the pump into the oil",
    );
    output(
        "Qf_GB_PNT_W",
        "W",
        |l| mechanical(&l.answer.loss_nm) * l.point.input_rad_s,
        "heat of all other losses",
    );
    if is_cvt {
        output(
            "p_line_Pa",
            "Pa",
            |l| l.answer.secondary_pa,
            "pressure of the secondary pulley",
        );
        output(
            "T_belt_AT_PNT_K",
            "K",
            |l| l.answer.belt_k,
            "belt, pulleys and the oil sprayed off them",
        );
    }
    output(
        "flags_AT_PNT",
        "",
        |l| f64::from(l.answer.flags.0),
        &flag_words(),
    );
}

fn efficiency(l: &LossResult) -> f64 {
    let input = l.answer.input_nm * l.point.input_rad_s;
    let output = l.point.output_nm * l.answer.output_rad_s;
    if input > 0.0 && output >= 0.0 {
        output / input
    } else if input <= 0.0 && output < 0.0 {
        input / output
    } else {
        0.0
    }
}
