//! Curves as tables.

use cvtcycle::model::bench::variator::RigFlags;

use super::plan::{Curve, VariatorPlan};
use crate::print::colour::Paint;
use crate::print::table::TextColumns;
use cvtcycle::output::number::{fixed, percent, plain};

/// A line for each curve, and the resolution of the speed sensors.
pub fn tables(plan: &VariatorPlan, curves: &[Curve], paint: Paint) -> String {
    let mut text = format!(
        "{}  variator alone, {}\n",
        paint.heading(&plan.setup.name),
        plan.formulation
    );
    for test in curves.chunk_by(same_test) {
        text += &one_test(test, paint);
    }
    text + "\nbreak: breakpoint, where the compression between segments changes sign; capacity: torque capacity of the clamping\n\
        forces; largest slip up to it and to the limits of the rig; primary, secondary: slip speeds at 3 % slip; linear: R2 of\n\
        a straight line from the breakpoint to 3 %. The rig reads zero slip at zero torque: subtract the slip at 0 Nm to compare.\n"
}

/// Whether two curves differ in pressure only.
pub fn same_test(a: &Curve, b: &Curve) -> bool {
    let key = |curve: &Curve| {
        let held = &curve.summary.held;
        [held.ratio, held.input_rad_s, held.belt_k].map(f64::to_bits)
    };
    key(a) == key(b)
}

/// Ratio, speed and temperature of a test in words.
pub fn test_name(curve: &Curve) -> String {
    let held = &curve.summary.held;
    let rpm = held.input_rad_s * 30.0 / std::f64::consts::PI;
    let ratio = fixed(held.ratio, 3);
    let ratio = ratio.trim_end_matches('0').trim_end_matches('.');
    format!(
        "ratio {ratio}, {} rpm, belt {} \u{b0}C",
        fixed(rpm, 0),
        fixed(held.belt_k - 273.15, 1).trim_end_matches(".0")
    )
}

fn one_test(test: &[Curve], paint: Paint) -> String {
    let columns = TextColumns::new()
        .right("\nbar", |c: &Curve| plain(bar(c)))
        .right("break\nNm", |c| fixed(c.summary.breakpoint_nm, 1))
        .right("capacity\nNm", |c| fixed(c.summary.capacity_nm, 1))
        .right("slip at\n0 Nm %", |c| {
            percent(c.summary.slip_at_zero, 1.0, 2)
        })
        .right("slip at\ncapacity", |c| {
            percent(c.summary.slip_at_capacity, 1.0, 2)
        })
        .right("largest\n%", |c| percent(c.summary.most_slip, 1.0, 2))
        .right("at\nNm", |c| fixed(c.summary.most_slip_nm, 0))
        .right("3 % at\nNm", |c| fixed(c.summary.three_percent_nm, 1))
        .right("primary\nm/s", |c| fixed(c.summary.three_percent_m_s[0], 3))
        .right("secondary\nm/s", |c| {
            fixed(c.summary.three_percent_m_s[1], 3)
        })
        .right("linear\nR2", |c| fixed(c.summary.measured_r2, 3));
    let (heading, table) = (
        paint.heading(&test_name(&test[0])),
        columns.table(test).indented().text(),
    );
    let mut text = format!("\n{heading}\n\n{table}\n  {}\n", resolution(&test[0]));
    let flagged = flags(test);
    if !flagged.is_empty() {
        text += &format!("  flagged points: {flagged}\n");
    }
    text
}

/// Secondary pressure, bar, without the rounding errors of its conversion.
pub fn bar(curve: &Curve) -> f64 {
    (curve.summary.held.pressure_pa / 1e5 * 1e6).round() / 1e6
}

fn resolution(curve: &Curve) -> String {
    let r = &curve.resolution;
    let gate = if r.belt_turns {
        format!("100 turns of the belt take {} s", fixed(r.gate_s, 2))
    } else {
        format!(
            "{} segments in {} s, one more is {} % of belt speed",
            fixed(r.segments, 0),
            fixed(r.gate_s, 0),
            percent(r.belt_per_segment, 1.0, 4)
        )
    };
    let pulse = |k: usize| percent(r.slip_per_pulse[k], 1.0, 4);
    format!(
        "{gate}; one pulse of the primary or secondary sensor is {} or {} % slip",
        pulse(0),
        pulse(1)
    )
}

fn flags(test: &[Curve]) -> String {
    let total: usize = test.iter().map(|curve| curve.rows.len()).sum();
    let count = |flag: RigFlags| {
        test.iter()
            .flat_map(|curve| &curve.rows)
            .filter(|row| row.flags.contains(flag))
            .count()
    };
    let named = RigFlags::NAMES
        .iter()
        .map(|(flag, name)| (name, count(*flag)))
        .filter(|(_, n)| *n > 0);
    named
        .map(|(name, n)| format!("{name} {n} of {total}"))
        .collect::<Vec<_>>()
        .join(", ")
}
