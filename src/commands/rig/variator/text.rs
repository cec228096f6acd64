//! Curves as tables for people.

use cvtcycle::model::bench::variator::RigFlags;

use super::plan::{Curve, Plan};
use crate::print::colour::Paint;
use crate::print::grid::Grid;
use cvtcycle::output::number::{fixed, percent, plain};

/// A line a curve, and what the counters can resolve.
pub fn tables(plan: &Plan, curves: &[Curve], paint: Paint) -> String {
    let mut text = format!(
        "{}  variator alone, {}\n",
        paint.heading(&plan.setup.name),
        plan.formulation
    );
    for test in curves.chunk_by(same_test) {
        text += &one_test(test, paint);
    }
    text + "\nbreak: breakpoint, where the compression between segments changes sign; carried: what the clamping forces carry;\n\
        largest slip within that and the rig's limits; primary, secondary: slip speeds at 3 % slip; linear: straight line from\n\
        the breakpoint to 3 %. The rig reads slip as zero at zero torque: subtract the slip at 0 Nm to compare.\n"
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
    let mut grid = Grid::new("rrrrrrrrrrr").indented();
    grid.row([
        "",
        "break",
        "carried",
        "slip at",
        "at",
        "largest",
        "at",
        "3 % at",
        "primary",
        "secondary",
        "linear",
    ]);
    grid.row([
        "bar", "Nm", "Nm", "0 Nm %", "carried", "%", "Nm", "Nm", "m/s", "m/s", "R2",
    ]);
    for curve in test {
        let s = &curve.summary;
        grid.row([
            plain((s.held.pressure_pa / 1e5 * 1e6).round() / 1e6),
            fixed(s.breakpoint_nm, 1),
            fixed(s.capacity_nm, 1),
            percent(s.slip_at_zero, 1.0, 2),
            percent(s.slip_at_capacity, 1.0, 2),
            percent(s.most_slip, 1.0, 2),
            fixed(s.most_slip_nm, 0),
            fixed(s.three_percent_nm, 1),
            fixed(s.three_percent_m_s[0], 3),
            fixed(s.three_percent_m_s[1], 3),
            fixed(s.measured_r2, 3),
        ]);
    }
    let mut text = format!(
        "\n{}\n\n{}",
        paint.heading(&test_name(&test[0])),
        grid.text()
    );
    text += &format!("\n  {}\n", resolution(&test[0]));
    let flagged = flags(test);
    if flagged.is_empty() {
        text
    } else {
        text + &format!("  flagged points: {flagged}\n")
    }
}

fn resolution(curve: &Curve) -> String {
    let r = &curve.resolution;
    let gate = if r.belt_turns {
        format!("100 belt turns last {} s", fixed(r.gate_s, 2))
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
        "{gate}; one pulse more of primary or secondary is {} or {} % of slip",
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
