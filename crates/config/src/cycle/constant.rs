//! Driving at constant speed, as the older fuel figures at 90 and 120 km/h (80/1268/EEC) have it.

use super::{Cycle, Interval, Trace, Weighting};
use crate::{Argument, Problem};

const PREFIX: &str = "constant_";
// ASSUMED: long enough for the fluids of a warm car to settle, short enough to wait for
const DURATION_S: f64 = 600.0;
const HIGHEST_KMH: f64 = 250.0;

/// The cycle `constant_90`, `constant_120` or, in general, `constant_V`: 600 s at V km/h with a flying start.
/// `None` if the name does not begin with `constant_`.
///
/// # Errors
/// V is not a plain decimal number above 0 and up to 250.
#[must_use]
pub fn constant_speed(name: &str) -> Option<Result<Cycle, Problem>> {
    let text = name.strip_prefix(PREFIX)?;
    Some(
        speed_kmh(text)
            .map(|kmh| cycle(name, text, kmh))
            .ok_or_else(|| problem(name, text)),
    )
}

fn speed_kmh(text: &str) -> Option<f64> {
    // f64::from_str would also take signs, exponents, inf and nan
    if !text
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.')
    {
        return None;
    }
    let kmh = text.parse::<f64>().ok()?;
    (kmh > 0.0 && kmh <= HIGHEST_KMH).then_some(kmh)
}

fn cycle(name: &str, text: &str, kmh: f64) -> Cycle {
    let speed_m_s = kmh / 3.6;
    let interval = Interval {
        start_s: 0.0,
        end_s: DURATION_S,
        start_speed_m_s: speed_m_s,
        end_speed_m_s: speed_m_s,
        phase: 0,
        grade: 0.0,
        engine_off: false,
    };
    Cycle {
        name: name.to_owned(),
        title: format!("Constant {text} km/h for {DURATION_S} s, flying start"),
        phases: Vec::new(),
        weighting: Weighting::None,
        manual: Trace::without_gears(vec![interval]),
        automatic: None,
    }
}

fn problem(name: &str, text: &str) -> Problem {
    let hint = if text.contains(',') {
        "write a decimal point, as in constant_88.5"
    } else {
        "write, for example, constant_90"
    };
    Problem::out_of_range("this is not a constant speed the program can drive")
        .at(Argument::Cycle)
        .value(name)
        .allowed(format!(
            "constant_V with V in km/h, above 0 and up to {HIGHEST_KMH}"
        ))
        .hint(hint)
}
