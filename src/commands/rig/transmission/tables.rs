//! The tests of the transmission rig as tables.

use cvtcycle::model::bench::BenchPoint;
use cvtcycle::model::bench::transmission::{
    Branch, Loop, Piece, Stage, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::output::Flags;
use cvtcycle::output::rig::{oil_degc, rpm};

use super::{RigPlan, RigResults};
use crate::print::colour::Paint;
use crate::print::table::TextColumns;
use cvtcycle::output::number::{NONE, fixed, plain, signed};

/// Branches closer than this have met, Nm: well within the error of the torque transducer.
pub const MEETING_NM: f64 = 0.1;
/// Speed at which the split is shown, rpm: that of the transients of thesis 5.3.2.
const SPLIT_RPM: f64 = 2500.0;
/// Ratio, speeds in rpm, and totals in Nm that thesis 5.3.1 prints.
const PRINTED: [(&str, f64, f64, f64, f64); 2] = [
    ("low", 1000.0, 4000.0, 8.5, 13.0),
    ("high", 2000.0, 4000.0, 9.0, 13.0),
];
/// Bulk oil of these totals, degC.
const PRINTED_DEGC: [f64; 2] = [25.0, 95.0];
/// Ratio, bulk oil in degC and torque loss in Nm of the warm-up that thesis 5.3.2 prints; the first one at the start.
const PRINTED_TRANSIENT: [(&str, Option<f64>, f64); 5] = [
    ("low", None, 12.5),
    ("low", Some(80.0), 11.0),
    ("low", Some(100.0), 11.25),
    ("high", None, 11.0),
    ("high", Some(100.0), 9.25),
];

/// From the smallest to the largest of some numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Smallest.
    pub low: f64,
    /// Largest.
    pub high: f64,
}

impl Range {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let empty = Range {
            low: f64::INFINITY,
            high: f64::NEG_INFINITY,
        };
        values.filter(|x| x.is_finite()).fold(empty, |r, x| Range {
            low: r.low.min(x),
            high: r.high.max(x),
        })
    }

    fn text(self, decimals: usize) -> String {
        if self.low > self.high {
            return NONE.to_owned();
        }
        format!(
            "{} to {}",
            fixed(self.low, decimals),
            fixed(self.high, decimals)
        )
    }
}

/// Ranges of torque loss, Nm, and pressure, bar, at a ratio.
pub fn ranges(points: &[SteadyPoint], ratio: f64) -> (Range, Range) {
    let on = || points.iter().filter(|p| near(p.set.ratio, ratio));
    (
        Range::of(on().map(|p| p.answer.total_nm())),
        Range::of(on().map(|p| p.answer.secondary_pa / 1e5)),
    )
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Everything that a person wants to see.
pub fn tables(plan: &RigPlan, found: &RigResults, paint: Paint) -> String {
    let (name, setup) = (paint.heading(&plan.setup.name), &plan.setup);
    let (oil, belt) = (&setup.oils().0.name, &plan.formulation);
    let mut text = format!(
        "{name}  {} on the transmission rig\noil {oil}, belt model {belt}\n",
        setup.title
    );
    text.extend(plan.set.iter().map(|set| format!("--set {set}\n")));
    let steady_rpm = shown_rpm(found.steady.iter().map(|p| &p.set));
    let loaded_rpm = shown_rpm(found.loaded.iter().map(|p| &p.set));
    let strip_rpm = shown_rpm(found.strip_down.iter().map(|s| &s.set));
    let sections = [
        (
            "Torque loss without load, Nm at the input".to_owned(),
            steady(plan, &found.steady),
        ),
        (
            format!("Its parts at {} rpm, Nm", plain(steady_rpm)),
            parts(plan, &found.steady, steady_rpm),
        ),
        (
            format!(
                "Torque loss under load at {} rpm, Nm, by torque at the output shaft",
                plain(loaded_rpm)
            ),
            loaded(plan, &found.loaded, loaded_rpm),
        ),
        (
            format!(
                "Strip-down at {} rpm: corrected differences, true losses, interaction, Nm",
                plain(strip_rpm)
            ),
            strip_down(plan, &found.strip_down, strip_rpm),
        ),
        (
            "Transients without load, Nm by bulk oil temperature".to_owned(),
            transients(plan, &found.loops),
        ),
        ("Second box".to_owned(), second_box(plan, found)),
    ];
    for (title, body) in sections.iter().filter(|(_, body)| !body.is_empty()) {
        text += &format!("\n{}\n{body}", paint.heading(title));
    }
    let counts = Flags::NAMES
        .iter()
        .map(|(flag, name)| (name, found.flagged(*flag)));
    let flags: Vec<String> = counts
        .filter(|(_, n)| *n > 0)
        .map(|(name, n)| format!("{name} {n}"))
        .collect();
    if !flags.is_empty() {
        let solved = found.answers().count();
        text += &format!(
            "\nflagged of {solved} points solved: {}\n",
            flags.join(", ")
        );
    }
    text
}

/// The tested speed next to [`SPLIT_RPM`].
fn shown_rpm<'a>(sets: impl Iterator<Item = &'a BenchPoint>) -> f64 {
    let distance = |rpm: &f64| (rpm - SPLIT_RPM).abs();
    sets.map(rpm)
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap_or(SPLIT_RPM)
}

/// Whether the printed totals apply to an oil temperature, with rounding errors of its conversion.
fn is_printed_oil(degc: f64) -> bool {
    let [low, high] = PRINTED_DEGC;
    (low - 1e-6..=high + 1e-6).contains(&degc)
}

fn steady(plan: &RigPlan, points: &[SteadyPoint]) -> String {
    if points.is_empty() {
        return String::new();
    }
    let on = |ratio: f64| points.iter().filter(move |p| near(p.set.ratio, ratio));
    let printed = |ratio: f64| {
        let name = plan.conditions.ratio_name(ratio);
        PRINTED.iter().find(|p| p.0 == name)
    };
    let span = |low: f64, high: f64| format!("{} to {}", plain(low), plain(high));
    let here = |ratio: &f64| match printed(*ratio) {
        Some((_, from, to, ..)) => {
            let tested = |p: &&SteadyPoint| {
                (*from..=*to).contains(&rpm(&p.set)) && is_printed_oil(oil_degc(&p.set))
            };
            Range::of(on(*ratio).filter(tested).map(|p| p.answer.total_nm())).text(2)
        }
        None => String::new(),
    };
    TextColumns::new()
        .left("ratio", |ratio: &f64| plan.conditions.ratio_name(*ratio))
        .right("I", |ratio| plain(*ratio))
        .right("rpm", |ratio| {
            Range::of(on(*ratio).map(|p| rpm(&p.set))).text(0)
        })
        .right("loss Nm", |ratio| ranges(points, *ratio).0.text(2))
        .right("bar", |ratio| ranges(points, *ratio).1.text(1))
        .right("thesis 5.3.1", |ratio| {
            printed(*ratio).map_or_else(String::new, |p| span(p.3, p.4))
        })
        .right("over rpm", |ratio| {
            printed(*ratio).map_or_else(String::new, |p| span(p.1, p.2))
        })
        .right("here", here)
        .table(&plan.points.ratios)
        .text()
}

fn parts(plan: &RigPlan, points: &[SteadyPoint], at_rpm: f64) -> String {
    if points.is_empty() {
        return String::new();
    }
    let loss = |piece: Piece| move |p: &SteadyPoint| fixed(piece.loss_nm(&p.answer), 2);
    TextColumns::new()
        .left("ratio", |p: &SteadyPoint| {
            plan.conditions.ratio_name(p.set.ratio)
        })
        .right("oil degC", |p| plain(oil_degc(&p.set)))
        .right("total", |p| fixed(p.answer.total_nm(), 2))
        .right("pump", loss(Piece::Pump))
        .right("shaft", loss(Piece::InputShaft))
        .right("clutch", loss(Piece::Clutch))
        .right("belt", loss(Piece::Belt))
        .right("final drive", loss(Piece::FinalDrive))
        .right("bar", |p| fixed(p.answer.secondary_pa / 1e5, 1))
        .right("belt degC", |p| fixed(p.answer.belt_k - ZERO_DEGC_K, 0))
        .table(points.iter().filter(|p| near(rpm(&p.set), at_rpm)))
        .text()
}

fn loaded(plan: &RigPlan, points: &[SteadyPoint], at_rpm: f64) -> String {
    if points.is_empty() {
        return String::new();
    }
    // Of many torques the ends; the figure shows all.
    let shown = match plan.points.torques_nm.as_slice() {
        [first, .., last] if plan.points.torques_nm.len() > 8 => vec![*first, *last],
        all => all.to_vec(),
    };
    let mut columns = TextColumns::new()
        .left("ratio", |(ratio, _): &(f64, f64)| {
            plan.conditions.ratio_name(*ratio)
        })
        .right("oil degC", |(_, oil_k)| fixed(oil_k - ZERO_DEGC_K, 0));
    for nm in shown {
        let at = move |p: &&SteadyPoint, (ratio, oil_k): &(f64, f64)| {
            let set = &p.set;
            near(set.ratio, *ratio)
                && near(set.sump_k, *oil_k)
                && near(rpm(set), at_rpm)
                && near(set.output_nm, nm)
        };
        let loss = move |row: &(f64, f64)| {
            points
                .iter()
                .find(|p| at(p, row))
                .map(|p| p.answer.total_nm())
        };
        columns = columns.right(format!("{} Nm", plain(nm)), move |row| fixed(loss(row), 2));
    }
    let at_ratio = |ratio: &f64| {
        plan.points
            .oil_k
            .iter()
            .map(|oil_k| (*ratio, *oil_k))
            .collect::<Vec<_>>()
    };
    let rows: Vec<(f64, f64)> = plan.points.ratios.iter().flat_map(at_ratio).collect();
    columns.table(&rows).text()
}

fn strip_down(plan: &RigPlan, rows: &[StripDown], at_rpm: f64) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let corrected = |piece: Piece| move |s: &StripDown| fixed(s.piece(piece).corrected_nm, 2);
    let own = |piece: Piece| move |s: &StripDown| fixed(s.piece(piece).true_nm, 2);
    let table = TextColumns::new()
        .left("ratio", |s: &StripDown| {
            plan.conditions.ratio_name(s.set.ratio)
        })
        .right("oil degC", |s| plain(oil_degc(&s.set)))
        .right("pump", corrected(Piece::Pump))
        .right("shaft", corrected(Piece::InputShaft))
        .right("clutch", corrected(Piece::Clutch))
        .right("belt", corrected(Piece::Belt))
        .right("true", own(Piece::Belt))
        .right("final drive", corrected(Piece::FinalDrive))
        .right("true", own(Piece::FinalDrive))
        .right("interaction", |s| {
            signed(s.piece(Piece::FinalDrive).interaction_nm(), 2)
        })
        .table(rows.iter().filter(|s| near(rpm(&s.set), at_rpm)));
    let bar = |stage: &Stage| {
        let range = Range::of(rows.iter().map(|s| s.stage(*stage).secondary_pa / 1e5));
        format!("{} {}", stage.name().replace('_', " "), range.text(1))
    };
    let bars: Vec<String> = Stage::ALL[..4].iter().map(bar).collect();
    let remainders = rows
        .iter()
        .flat_map(|s| Piece::ALL.map(|p| s.piece(p).remainder_nm().abs()));
    format!(
        "{}bar: {},\n     {}\n\
         interaction: belt loss of the complete box minus that without final drive (pressure, torque);\n\
         the final drive seems larger by it, the belt smaller\n\
         largest remainder after true loss and interaction, all points: {} Nm\n",
        table.text(),
        bars[..2].join(", "),
        bars[2..].join(", "),
        fixed(Range::of(remainders).high, 3)
    )
}

/// Bulk oil temperatures of the table, degC.
const SHOWN_DEGC: [f64; 6] = [25.0, 40.0, 60.0, 80.0, 95.0, 100.0];

fn transients(plan: &RigPlan, loops: &[Loop]) -> String {
    if loops.is_empty() {
        return String::new();
    }
    let end = |(l, branch): &(&Loop, Branch)| {
        let mut on = l.moments.iter().filter(|m| m.branch == *branch);
        let moment = match branch {
            Branch::Warming => on.next(),
            Branch::Cooling => on.next_back(),
        };
        fixed(moment.map(|m| m.answer.total_nm()), 2)
    };
    let mut columns = TextColumns::new()
        .left("ratio", |(l, _): &(&Loop, Branch)| {
            plan.conditions.ratio_name(l.ratio)
        })
        .left("branch", |(_, branch)| branch.word())
        .right("start or end", end);
    for degc in SHOWN_DEGC {
        let loss = move |(l, branch): &(&Loop, Branch)| l.loss_nm(*branch, degc + ZERO_DEGC_K);
        columns = columns.right(format!("{} degC", plain(degc)), move |row| {
            fixed(loss(row), 2)
        });
    }
    let rows = loops
        .iter()
        .flat_map(|l| [(l, Branch::Warming), (l, Branch::Cooling)]);
    let rows: Vec<(&Loop, Branch)> = rows.collect();
    columns.table(&rows).text()
        + &loops
            .iter()
            .map(|l| loop_notes(plan, l))
            .collect::<String>()
}

fn loop_notes(plan: &RigPlan, l: &Loop) -> String {
    let name = plan.conditions.ratio_name(l.ratio);
    let minutes = |branch: Branch| {
        let on = l.moments.iter().filter(|m| m.branch == branch);
        let times = Range::of(on.map(|m| m.time_s / 60.0));
        fixed(times.high - times.low, 0)
    };
    let widest = l.widest().map_or_else(
        || NONE.to_owned(),
        |(gap, k)| format!("{} Nm at {:.0} degC", signed(gap, 2), k - ZERO_DEGC_K),
    );
    let meeting = l.meeting_k(MEETING_NM).map_or_else(
        || "nowhere".to_owned(),
        |k| format!("at {:.0} degC", k - ZERO_DEGC_K),
    );
    let mut text = format!(
        "{name}: warming {} min, cooling {} min\n  \
         cooling above warming by {widest} at most; below that they meet {meeting} (within {MEETING_NM} Nm)\n",
        minutes(Branch::Warming),
        minutes(Branch::Cooling)
    );
    let place = |degc: &Option<f64>| match degc {
        Some(t) => format!("at {} degC", plain(*t)),
        None => "Nm at the start".to_owned(),
    };
    let printed = PRINTED_TRANSIENT.iter().filter(|p| p.0 == name);
    let printed: Vec<String> = printed
        .map(|(_, degc, nm)| format!("{} {}", plain(*nm), place(degc)))
        .collect();
    if !printed.is_empty() {
        text += &format!(
            "  thesis 5.3.2: warming {}; meeting near 40 degC\n",
            printed.join(", ")
        );
    }
    text
}

fn second_box(plan: &RigPlan, found: &RigResults) -> String {
    if found.second_box.is_empty() {
        return String::new();
    }
    let range = |get: fn(&TwoBoxes) -> f64| {
        move |ratio: &f64| {
            let on = found
                .second_box
                .iter()
                .filter(|t| near(t.first.set.ratio, *ratio));
            Range::of(on.map(get)).text(2)
        }
    };
    TextColumns::new()
        .left("ratio", |ratio: &f64| plan.conditions.ratio_name(*ratio))
        .right("pressure", |_| {
            format!("x {}", plain(plan.conditions.pressure.second_box))
        })
        .right("first Nm", range(|t| t.first.answer.total_nm()))
        .right("second Nm", range(|t| t.second.answer.total_nm()))
        .right("difference Nm", range(TwoBoxes::difference_nm))
        .left("thesis 5.3.4", |_| "about -1, 5 to 10 % less pressure")
        .table(&plan.points.ratios)
        .text()
}
