//! Curves as tables.

use cvtcycle::model::bench::variator::RigFlags;
use cvtcycle::output::number::{fixed, percent, plain};
use cvtcycle::output::table::TextColumns;
use cvtcycle::output::variator::{Curve, VariatorCurves};

use crate::print::colour::Paint;

/// A line for each curve, and the resolution of the speed sensors.
pub fn tables(found: &VariatorCurves, paint: Paint) -> String {
    let (vehicle, belt) = (paint.heading(&found.vehicle), &found.formulation);
    let mut text = format!("{vehicle}  variator alone, {belt}\n");
    for test in found.curves.chunk_by(Curve::is_same_test) {
        text += &one_test(test, paint);
    }
    text + "\nbreak: breakpoint, where the compression between segments changes sign; capacity: torque capacity of the clamping\n\
        forces; largest slip up to it and to the limits of the rig; primary, secondary: slip speeds at 3 % slip; linear: R2 of\n\
        a straight line from the breakpoint to 3 %. The rig reads zero slip at zero torque: subtract the slip at 0 Nm to compare.\n"
}

fn one_test(test: &[Curve], paint: Paint) -> String {
    let columns = TextColumns::new()
        .right("\nbar", |c: &Curve| plain(c.bar()))
        .number("break\nNm", 1, |c| c.summary.breakpoint_nm)
        .number("capacity\nNm", 1, |c| c.summary.capacity_nm)
        .number("slip at\n0 Nm %", 2, |c| 100.0 * c.summary.slip_at_zero)
        .number("slip at\ncapacity", 2, |c| {
            100.0 * c.summary.slip_at_capacity
        })
        .number("largest\n%", 2, |c| 100.0 * c.summary.most_slip)
        .number("at\nNm", 0, |c| c.summary.most_slip_nm)
        .number("3 % at\nNm", 1, |c| c.summary.three_percent_nm)
        .number("primary\nm/s", 3, |c| c.summary.three_percent_m_s[0])
        .number("secondary\nm/s", 3, |c| c.summary.three_percent_m_s[1])
        .number("linear\nR2", 3, |c| c.summary.measured_r2);
    let (heading, table) = (paint.heading(&test[0].test_name()), columns.text(test));
    let mut text = format!("\n{heading}\n\n{table}\n  {}\n", resolution(&test[0]));
    let flagged = flags(test);
    if !flagged.is_empty() {
        text += &format!("  flagged points: {flagged}\n");
    }
    text
}

fn resolution(curve: &Curve) -> String {
    let r = &curve.resolution;
    let gate = if r.belt_turns {
        format!("100 turns of the belt take {} s", fixed(r.gate_s, 2))
    } else {
        let (segments, seconds) = (fixed(r.segments, 0), fixed(r.gate_s, 0));
        let share = percent(r.belt_per_segment, 1.0, 4);
        format!("{segments} segments in {seconds} s, one more is {share} % of belt speed")
    };
    let [primary, secondary] = r.slip_per_pulse.map(|slip| percent(slip, 1.0, 4));
    format!(
        "{gate}; one pulse of the primary or secondary sensor is {primary} or {secondary} % slip"
    )
}

fn flags(test: &[Curve]) -> String {
    let rows = || test.iter().flat_map(|curve| &curve.rows);
    let count = |flag: RigFlags| rows().filter(|row| row.flags.contains(flag)).count();
    let named = RigFlags::NAMES
        .iter()
        .map(|(flag, name)| (name, count(*flag)));
    let named = named.filter(|(_, n)| *n > 0);
    let of = |(name, n)| format!("{name} {n} of {}", rows().count());
    named.map(of).collect::<Vec<_>>().join(", ")
}
