//! The tests of the transmission rig as tables.

use cvtcycle::model::lubricant::ZERO_DEGC_K;
use cvtcycle::model::rig::BenchPoint;
use cvtcycle::model::rig::transmission::{
    Branch, Conditions, Loop, Piece, Stage, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle::output::Flags;
use cvtcycle::output::number::{NONE, fixed, plain, signed};
use cvtcycle::output::rig::{MEETING_NM, Range, RigResults, is_near, oil_degc, ranges, rpm};
use cvtcycle::output::table::{TextColumns, paragraphs};

use super::RigPlan;
use crate::print::colour::Paint;
use crate::print::sections;

/// Speed of the table of components, rpm: that of the transients of thesis 5.3.2.
const SPLIT_RPM: f64 = 2500.0;
/// Totals printed in thesis 5.3.1: ratio, two speeds in rpm, their torques in Nm.
const PRINTED: [(&str, f64, f64, f64, f64); 2] = [
    ("low", 1000.0, 4000.0, 8.5, 13.0),
    ("high", 2000.0, 4000.0, 9.0, 13.0),
];
/// Bulk oil temperatures of these totals, degC, widened by the rounding of the conversion.
const PRINTED_DEGC: std::ops::RangeInclusive<f64> = 25.0 - 1e-6..=95.0 + 1e-6;
/// Warm-up printed in thesis 5.3.2: ratio, bulk oil in degC, torque loss in Nm; without temperature at the start.
const PRINTED_TRANSIENT: [(&str, Option<f64>, f64); 5] = [
    ("low", None, 12.5),
    ("low", Some(80.0), 11.0),
    ("low", Some(100.0), 11.25),
    ("high", None, 11.0),
    ("high", Some(100.0), 9.25),
];
/// Bulk oil temperatures in the table of transients, degC.
const SHOWN_DEGC: [f64; 6] = [25.0, 40.0, 60.0, 80.0, 95.0, 100.0];

/// Prints all results.
pub fn tables(plan: &RigPlan, found: &RigResults, paint: Paint) -> String {
    let (setup, c, belt) = (&plan.setup, &plan.conditions, &plan.formulation);
    let (name, title) = (paint.heading(&setup.name), &setup.title);
    let oil = &setup.oils().0.name;
    let mut text = paragraphs(&format!(
        "{name}  {title} on the transmission rig\noil {oil}, belt model {belt}"
    ));
    text.extend(plan.set.iter().map(|set| format!("--set {set}\n")));
    let steady_rpm = shown_rpm(found.steady.iter().map(|p| &p.set));
    let loaded_rpm = shown_rpm(found.loaded.iter().map(|p| &p.set));
    let strip_rpm = shown_rpm(found.strip_down.iter().map(|s| &s.set));
    let torque = "Torque loss without load, Nm at the input".to_owned();
    let parts_of = format!("Its parts at {} rpm, Nm", plain(steady_rpm));
    let load = plain(loaded_rpm);
    let load = format!("Torque loss under load at {load} rpm, Nm, by torque at the output shaft");
    let strip = plain(strip_rpm);
    let strip =
        format!("Strip-down at {strip} rpm: corrected differences, true losses, interaction, Nm");
    let warming = "Transients without load, Nm by bulk oil temperature".to_owned();
    text += &sections(
        [
            (torque, steady(plan, &found.steady)),
            (parts_of, parts(c, &found.steady, steady_rpm)),
            (load, loaded(plan, &found.loaded, loaded_rpm)),
            (strip, strip_down(c, found, strip_rpm)),
            (warming, transients(c, &found.loops)),
            ("Second box".to_owned(), second_box(plan, found)),
        ],
        paint,
    );
    let counts = Flags::NAMES.map(|(flag, name)| (name, found.flagged(flag)));
    let flags = counts.iter().filter(|(_, n)| *n > 0);
    let flags = flags.map(|(name, n)| format!("{name} {n}"));
    let flags: Vec<String> = flags.collect();
    if !flags.is_empty() {
        let (solved, flags) = (found.answers().count(), flags.join(", "));
        text += &format!("\nflagged of {solved} points solved: {flags}\n");
    }
    text
}

/// Tested speed nearest to [`SPLIT_RPM`].
fn shown_rpm<'a>(sets: impl Iterator<Item = &'a BenchPoint>) -> f64 {
    let distance = |rpm: &f64| (rpm - SPLIT_RPM).abs();
    let nearest = sets
        .map(rpm)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    nearest.unwrap_or(SPLIT_RPM)
}

fn steady(plan: &RigPlan, points: &[SteadyPoint]) -> String {
    if points.is_empty() {
        return String::new();
    }
    let name = |ratio: &f64| plan.conditions.ratio_name(*ratio);
    let on = |ratio: f64| points.iter().filter(move |p| is_near(p.set.ratio, ratio));
    let printed = |ratio: &f64| PRINTED.iter().find(|p| p.0 == name(ratio));
    let span = |low: f64, high: f64| format!("{} to {}", plain(low), plain(high));
    let here = |ratio: &f64| {
        let (_, from, to, ..) = printed(ratio)?;
        let tested = |p: &&SteadyPoint| {
            (*from..=*to).contains(&rpm(&p.set)) && PRINTED_DEGC.contains(&oil_degc(&p.set))
        };
        Some(Range::over(on(*ratio).filter(tested).map(|p| p.answer.total_nm())).text(2))
    };
    TextColumns::new()
        .left("ratio", name)
        .right("I", |ratio| plain(*ratio))
        .right("rpm", |ratio| {
            Range::over(on(*ratio).map(|p| rpm(&p.set))).text(0)
        })
        .right("loss Nm", |ratio| ranges(points, *ratio).0.text(2))
        .right("bar", |ratio| ranges(points, *ratio).1.text(1))
        .right("thesis 5.3.1", |ratio| {
            printed(ratio).map_or_else(String::new, |p| span(p.3, p.4))
        })
        .right("over rpm", |ratio| {
            printed(ratio).map_or_else(String::new, |p| span(p.1, p.2))
        })
        .right("here", |ratio| here(ratio).unwrap_or_default())
        .table(&plan.points.ratios)
        .text()
}

fn parts(c: &Conditions, points: &[SteadyPoint], at_rpm: f64) -> String {
    let loss = |piece: Piece| move |p: &SteadyPoint| piece.loss_nm(&p.answer);
    let columns = TextColumns::new()
        .left("ratio", |p: &SteadyPoint| c.ratio_name(p.set.ratio))
        .right("oil degC", |p| plain(oil_degc(&p.set)))
        .number("total", 2, |p| p.answer.total_nm())
        .number("pump", 2, loss(Piece::Pump))
        .number("shaft", 2, loss(Piece::InputShaft))
        .number("clutch", 2, loss(Piece::Clutch))
        .number("belt", 2, loss(Piece::Belt))
        .number("final drive", 2, loss(Piece::FinalDrive))
        .number("bar", 1, |p| p.answer.secondary_pa / 1e5)
        .number("belt degC", 0, |p| p.answer.belt_k - ZERO_DEGC_K);
    columns.lines(points.iter().filter(|p| is_near(rpm(&p.set), at_rpm)))
}

fn loaded(plan: &RigPlan, points: &[SteadyPoint], at_rpm: f64) -> String {
    if points.is_empty() {
        return String::new();
    }
    // With many torques the table has the first and the last; the figure has all.
    let shown = match plan.points.torques_nm.as_slice() {
        [first, .., last] if plan.points.torques_nm.len() > 8 => vec![*first, *last],
        all => all.to_vec(),
    };
    let mut columns = TextColumns::new()
        .left("ratio", |(ratio, _): &(f64, f64)| {
            plan.conditions.ratio_name(*ratio)
        })
        .number("oil degC", 0, |(_, oil_k)| oil_k - ZERO_DEGC_K);
    for nm in shown {
        let loss = move |(ratio, oil_k): &(f64, f64)| {
            let wanted = [*ratio, *oil_k, at_rpm, nm];
            let set = |p: &BenchPoint| [p.ratio, p.sump_k, rpm(p), p.output_nm];
            let at = |p: &&SteadyPoint| set(&p.set).iter().zip(wanted).all(|(a, b)| is_near(*a, b));
            points.iter().find(at).map(|p| p.answer.total_nm())
        };
        columns = columns.number(format!("{} Nm", plain(nm)), 2, loss);
    }
    let oils = &plan.points.oil_k;
    let at_ratio = |&ratio: &f64| oils.iter().map(move |oil_k| (ratio, *oil_k));
    let rows: Vec<(f64, f64)> = plan.points.ratios.iter().flat_map(at_ratio).collect();
    columns.lines(&rows)
}

fn strip_down(c: &Conditions, found: &RigResults, at_rpm: f64) -> String {
    let rows = &found.strip_down;
    if rows.is_empty() {
        return String::new();
    }
    let corrected = |piece: Piece| move |s: &StripDown| s.piece(piece).corrected_nm;
    let own = |piece: Piece| move |s: &StripDown| s.piece(piece).true_nm;
    let columns = TextColumns::new()
        .left("ratio", |s: &StripDown| c.ratio_name(s.set.ratio))
        .right("oil degC", |s| plain(oil_degc(&s.set)))
        .number("pump", 2, corrected(Piece::Pump))
        .number("shaft", 2, corrected(Piece::InputShaft))
        .number("clutch", 2, corrected(Piece::Clutch))
        .number("belt", 2, corrected(Piece::Belt))
        .number("true", 2, own(Piece::Belt))
        .number("final drive", 2, corrected(Piece::FinalDrive))
        .number("true", 2, own(Piece::FinalDrive))
        .right("interaction", |s| {
            signed(s.piece(Piece::FinalDrive).interaction_nm(), 2)
        });
    let table = columns.lines(rows.iter().filter(|s| is_near(rpm(&s.set), at_rpm)));
    let bar = |stage: &Stage| {
        let range = Range::over(rows.iter().map(|s| s.stage(*stage).secondary_pa / 1e5));
        format!("{} {}", stage.name().replace('_', " "), range.text(1))
    };
    let bars: Vec<String> = Stage::ALL[..4].iter().map(bar).collect();
    let (first, rest) = (bars[..2].join(", "), bars[2..].join(", "));
    let remainder = fixed(found.largest_remainder_nm(), 3);
    let notes = format!(
        "bar: {first},\n     {rest}\n\
         interaction: belt loss of the complete box minus that without final drive (pressure, torque);\n\
         the final drive seems larger by it, the belt smaller\n\
         largest remainder after true loss and interaction, all points: {remainder} Nm\n"
    );
    table + &paragraphs(&notes)
}

fn transients(c: &Conditions, loops: &[Loop]) -> String {
    let end = |(l, branch): &(&Loop, Branch)| {
        let mut on = l.moments.iter().filter(|m| m.branch == *branch);
        let moment = match branch {
            Branch::Warming => on.next(),
            Branch::Cooling => on.next_back(),
        };
        moment.map(|m| m.answer.total_nm())
    };
    let mut columns = TextColumns::new()
        .left("ratio", |(l, _): &(&Loop, Branch)| c.ratio_name(l.ratio))
        .left("branch", |(_, branch)| branch.word())
        .number("start or end", 2, end);
    for degc in SHOWN_DEGC {
        columns = columns.number(format!("{} degC", plain(degc)), 2, move |(l, branch)| {
            l.loss_nm(*branch, degc + ZERO_DEGC_K)
        });
    }
    let both = |l| [(l, Branch::Warming), (l, Branch::Cooling)];
    let rows: Vec<(&Loop, Branch)> = loops.iter().flat_map(both).collect();
    columns.lines(&rows) + &loops.iter().map(|l| loop_notes(c, l)).collect::<String>()
}

fn loop_notes(c: &Conditions, l: &Loop) -> String {
    let name = c.ratio_name(l.ratio);
    let minutes = |branch: Branch| {
        let on = l.moments.iter().filter(|m| m.branch == branch);
        let times = Range::over(on.map(|m| m.time_s / 60.0));
        fixed(times.high - times.low, 0)
    };
    let [warming, cooling] = [Branch::Warming, Branch::Cooling].map(minutes);
    let degc = |k: f64| format!("at {:.0} degC", k - ZERO_DEGC_K);
    let widest = l
        .widest()
        .map(|(gap, k)| format!("{} Nm {}", signed(gap, 2), degc(k)));
    let widest = widest.unwrap_or_else(|| NONE.to_owned());
    let meeting = l
        .meeting_k(MEETING_NM)
        .map_or_else(|| "nowhere".to_owned(), degc);
    let mut text = format!(
        "{name}: warming {warming} min, cooling {cooling} min\n  \
         cooling above warming by {widest} at most; below it they meet {meeting} (within {MEETING_NM} Nm)\n"
    );
    let value = |(_, degc, nm): &(&str, Option<f64>, f64)| match degc {
        Some(t) => format!("{} at {} degC", plain(*nm), plain(*t)),
        None => format!("{} Nm at the start", plain(*nm)),
    };
    let printed = PRINTED_TRANSIENT.iter().filter(|p| p.0 == name);
    let printed: Vec<String> = printed.map(value).collect();
    if !printed.is_empty() {
        let printed = printed.join(", ");
        text += &format!("  thesis 5.3.2: warming {printed}; meeting near 40 degC\n");
    }
    paragraphs(&text)
}

fn second_box(plan: &RigPlan, found: &RigResults) -> String {
    if found.second_box.is_empty() {
        return String::new();
    }
    let c = &plan.conditions;
    let factor = format!("x {}", plain(c.pressure.second_box));
    let range = |get: fn(&TwoBoxes) -> f64| {
        move |ratio: &f64| {
            let on = found
                .second_box
                .iter()
                .filter(|t| is_near(t.first.set.ratio, *ratio));
            Range::over(on.map(get)).text(2)
        }
    };
    TextColumns::new()
        .left("ratio", |ratio: &f64| c.ratio_name(*ratio))
        .right("pressure", |_| &factor)
        .right("first Nm", range(|t| t.first.answer.total_nm()))
        .right("second Nm", range(|t| t.second.answer.total_nm()))
        .right("difference Nm", range(TwoBoxes::difference_nm))
        .left("thesis 5.3.4", |_| "about -1, 5 to 10 % less pressure")
        .table(&plan.points.ratios)
        .text()
}
