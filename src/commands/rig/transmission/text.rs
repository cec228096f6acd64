//! The transmission rig's tests as tables for people.

use cvtcycle::model::bench::BenchPoint;
use cvtcycle::model::bench::transmission::{Branch, Loop, Piece, Stage, SteadyPoint, StripDown};
use cvtcycle::model::fluid::ZERO_DEGC_K;
use cvtcycle::output::Flags;
use cvtcycle::output::rig::{oil_degc, rpm};

use super::{Found, Job};
use crate::print::colour::Paint;
use crate::print::grid::Grid;
use cvtcycle::output::number::{NONE, fixed, plain, signed};

/// Branches that are closer than this have met, Nm: well within the transducer's error.
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

/// From the least to the largest of some numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Least.
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
        if self.low <= self.high {
            format!(
                "{} to {}",
                fixed(self.low, decimals),
                fixed(self.high, decimals)
            )
        } else {
            NONE.to_owned()
        }
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
pub fn tables(job: &Job, found: &Found, paint: Paint) -> String {
    let mut text = format!(
        "{}  {} on the transmission rig\n",
        paint.heading(&job.setup.name),
        job.setup.title
    );
    text += &format!(
        "oil {}, belt model {}\n",
        job.setup.oils().0.name,
        job.formulation
    );
    text.extend(job.set.iter().map(|set| format!("--set {set}\n")));
    let mut part = |title: String, body: String| {
        if !body.is_empty() {
            text += &format!("\n{}\n{body}", paint.heading(&title));
        }
    };
    part(
        "Torque loss without load, Nm at the input".into(),
        steady(job, &found.steady),
    );
    let split = split_rpm(found.steady.iter().map(|p| &p.set));
    part(
        format!("Its parts at {} rpm, Nm", plain(split)),
        parts(job, &found.steady, split),
    );
    let at = split_rpm(found.loaded.iter().map(|p| &p.set));
    part(
        format!(
            "Torque loss under load at {} rpm, Nm, by torque at the output shaft",
            plain(at)
        ),
        loaded(job, &found.loaded, at),
    );
    let at = split_rpm(found.strip_down.iter().map(|s| &s.set));
    part(
        format!(
            "Strip-down at {} rpm: corrected differences, true losses, interaction, Nm",
            plain(at)
        ),
        strip_down(job, &found.strip_down, at),
    );
    part(
        "Transients without load, Nm by bulk oil temperature".into(),
        transients(job, &found.loops),
    );
    part("Second box".into(), second_box(job, found));
    let flags: Vec<String> = Flags::NAMES
        .iter()
        .map(|(flag, name)| (name, found.flagged(*flag)))
        .filter(|(_, count)| *count > 0)
        .map(|(name, count)| format!("{name} {count}"))
        .collect();
    if !flags.is_empty() {
        text += &format!(
            "\nflagged of {} points solved: {}\n",
            found.answers().count(),
            flags.join(", ")
        );
    }
    text
}

/// Of the speeds tested the one next to [`SPLIT_RPM`].
fn split_rpm<'a>(sets: impl Iterator<Item = &'a BenchPoint>) -> f64 {
    sets.map(rpm)
        .min_by(|a, b| (a - SPLIT_RPM).abs().total_cmp(&(b - SPLIT_RPM).abs()))
        .unwrap_or(SPLIT_RPM)
}

/// Whether the printed totals hold for an oil temperature, but for rounding on its way to kelvin.
fn printed_oil(degc: f64) -> bool {
    let [low, high] = PRINTED_DEGC;
    (low - 1e-6..=high + 1e-6).contains(&degc)
}

fn steady(job: &Job, points: &[SteadyPoint]) -> String {
    if points.is_empty() {
        return String::new();
    }
    let mut grid = Grid::new("lrrrrrrr");
    grid.row([
        "ratio",
        "I",
        "rpm",
        "loss Nm",
        "bar",
        "thesis 5.3.1",
        "over rpm",
        "here",
    ]);
    for &ratio in &job.plan.ratios {
        let name = job.conditions.ratio_name(ratio);
        let on = || points.iter().filter(|p| near(p.set.ratio, ratio));
        let (loss, bar) = ranges(points, ratio);
        let speeds = Range::of(on().map(|p| rpm(&p.set)));
        let printed = PRINTED
            .iter()
            .find(|p| p.0 == name)
            .map(|(_, from, to, low, high)| {
                let tested = |p: &&SteadyPoint| {
                    (*from..=*to).contains(&rpm(&p.set)) && printed_oil(oil_degc(&p.set))
                };
                let here = Range::of(on().filter(tested).map(|p| p.answer.total_nm()));
                let text = |low: &f64, high: &f64| format!("{} to {}", plain(*low), plain(*high));
                [text(low, high), text(from, to), here.text(2)]
            });
        let cells = [
            name,
            plain(ratio),
            speeds.text(0),
            loss.text(2),
            bar.text(1),
        ];
        grid.row(cells.into_iter().chain(printed.into_iter().flatten()));
    }
    grid.text()
}

fn parts(job: &Job, points: &[SteadyPoint], at_rpm: f64) -> String {
    if points.is_empty() {
        return String::new();
    }
    let mut grid = Grid::new("lrrrrrrrrr");
    grid.row([
        "ratio",
        "oil degC",
        "total",
        "pump",
        "shaft",
        "clutch",
        "belt",
        "final drive",
        "bar",
        "belt degC",
    ]);
    for p in points.iter().filter(|p| near(rpm(&p.set), at_rpm)) {
        let mut cells = vec![
            job.conditions.ratio_name(p.set.ratio),
            plain(oil_degc(&p.set)),
            fixed(p.answer.total_nm(), 2),
        ];
        cells.extend(Piece::ALL.map(|piece| fixed(piece.loss_nm(&p.answer), 2)));
        cells.push(fixed(p.answer.secondary_pa / 1e5, 1));
        cells.push(fixed(p.answer.belt_k - ZERO_DEGC_K, 0));
        grid.row(cells);
    }
    grid.text()
}

fn loaded(job: &Job, points: &[SteadyPoint], at_rpm: f64) -> String {
    if points.is_empty() {
        return String::new();
    }
    let torques = &job.plan.torques_nm;
    // A picture shows more than a table of a hundred columns.
    let shown: Vec<f64> = if torques.len() <= 8 {
        torques.clone()
    } else {
        [torques[0], torques[torques.len() - 1]].to_vec()
    };
    let mut grid = Grid::new(&("lr".to_owned() + &"r".repeat(shown.len())));
    grid.row(
        ["ratio".to_owned(), "oil degC".to_owned()]
            .into_iter()
            .chain(shown.iter().map(|t| format!("{} Nm", plain(*t)))),
    );
    for &ratio in &job.plan.ratios {
        for &oil_k in &job.plan.oil_k {
            let here = |p: &&SteadyPoint| {
                near(p.set.ratio, ratio) && near(p.set.sump_k, oil_k) && near(rpm(&p.set), at_rpm)
            };
            let cell = |nm: &f64| {
                let found = points
                    .iter()
                    .filter(here)
                    .find(|p| near(p.set.output_nm, *nm));
                fixed(found.map(|p| p.answer.total_nm()), 2)
            };
            let head = [
                job.conditions.ratio_name(ratio),
                fixed(oil_k - ZERO_DEGC_K, 0),
            ];
            grid.row(head.into_iter().chain(shown.iter().map(cell)));
        }
    }
    grid.text()
}

fn strip_down(job: &Job, rows: &[StripDown], at_rpm: f64) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut grid = Grid::new("lrrrrrrrrr");
    grid.row([
        "ratio",
        "oil degC",
        "pump",
        "shaft",
        "clutch",
        "belt",
        "true",
        "final drive",
        "true",
        "interaction",
    ]);
    for s in rows.iter().filter(|s| near(rpm(&s.set), at_rpm)) {
        let found = |piece: Piece| fixed(s.piece(piece).corrected_nm, 2);
        let own = |piece: Piece| fixed(s.piece(piece).true_nm, 2);
        grid.row([
            job.conditions.ratio_name(s.set.ratio),
            plain(oil_degc(&s.set)),
            found(Piece::Pump),
            found(Piece::InputShaft),
            found(Piece::Clutch),
            found(Piece::Belt),
            own(Piece::Belt),
            found(Piece::FinalDrive),
            own(Piece::FinalDrive),
            signed(s.piece(Piece::FinalDrive).interaction_nm(), 2),
        ]);
    }
    let bar = |stage: &Stage| {
        let range = Range::of(rows.iter().map(|s| s.stage(*stage).secondary_pa / 1e5));
        format!("{} {}", stage.name().replace('_', " "), range.text(1))
    };
    let pressures: Vec<String> = Stage::ALL[..4].iter().map(bar).collect();
    let largest = Range::of(
        rows.iter()
            .flat_map(|s| Piece::ALL.map(|p| s.piece(p).remainder_nm().abs())),
    )
    .high;
    grid.text()
        + &format!(
            "bar: {},\n     {}\n",
            pressures[..2].join(", "),
            pressures[2..].join(", ")
        )
        + "interaction: belt loss of the complete box less that without final drive (pressure, torque);\n\
           the final drive seems larger by it, the belt smaller\n"
        + &format!(
            "largest remainder beside true loss and interaction, all points: {} Nm\n",
            fixed(largest, 3)
        )
}

/// Bulk oil temperatures of the table, degC.
const SHOWN_DEGC: [f64; 6] = [25.0, 40.0, 60.0, 80.0, 95.0, 100.0];

fn transients(job: &Job, loops: &[Loop]) -> String {
    if loops.is_empty() {
        return String::new();
    }
    let mut grid = Grid::new("llrrrrrrr");
    let degrees = SHOWN_DEGC.map(|t| format!("{} degC", plain(t)));
    grid.row(
        [
            "ratio".to_owned(),
            "branch".to_owned(),
            "start or end".to_owned(),
        ]
        .into_iter()
        .chain(degrees),
    );
    for l in loops {
        for branch in [Branch::Warming, Branch::Cooling] {
            let on = || l.moments.iter().filter(|m| m.branch == branch);
            let end = if branch == Branch::Warming {
                on().next()
            } else {
                on().next_back()
            };
            let head = [
                job.conditions.ratio_name(l.ratio),
                branch.word().to_owned(),
                fixed(end.map(|m| m.answer.total_nm()), 2),
            ];
            grid.row(
                head.into_iter()
                    .chain(SHOWN_DEGC.map(|t| fixed(l.loss_nm(branch, t + ZERO_DEGC_K), 2))),
            );
        }
    }
    let mut text = grid.text();
    for l in loops {
        let name = job.conditions.ratio_name(l.ratio);
        let place = |degc: &Option<f64>| {
            degc.map_or_else(
                || "Nm at the start".to_owned(),
                |t| format!("at {} degC", plain(t)),
            )
        };
        let printed: Vec<String> = PRINTED_TRANSIENT
            .iter()
            .filter(|p| p.0 == name)
            .map(|(_, degc, nm)| format!("{} {}", plain(*nm), place(degc)))
            .collect();
        let widest = l.widest().map_or_else(
            || NONE.to_owned(),
            |(gap, k)| format!("{} Nm at {:.0} degC", signed(gap, 2), k - ZERO_DEGC_K),
        );
        let meeting = l.meeting_k(MEETING_NM).map_or_else(
            || "nowhere".to_owned(),
            |k| format!("at {:.0} degC", k - ZERO_DEGC_K),
        );
        let minutes = |branch: Branch| {
            let times = Range::of(
                l.moments
                    .iter()
                    .filter(|m| m.branch == branch)
                    .map(|m| m.time_s / 60.0),
            );
            fixed(times.high - times.low, 0)
        };
        text += &format!(
            "{name}: warming {} min, cooling {} min\n",
            minutes(Branch::Warming),
            minutes(Branch::Cooling)
        );
        text += &format!(
            "  cooling above warming by {widest} at most; below that they meet {meeting} (within {MEETING_NM} Nm)\n"
        );
        if !printed.is_empty() {
            text += &format!(
                "  thesis 5.3.2: warming {}; meeting near 40 degC\n",
                printed.join(", ")
            );
        }
    }
    text
}

fn second_box(job: &Job, found: &Found) -> String {
    if found.second_box.is_empty() {
        return String::new();
    }
    let mut grid = Grid::new("lrrrrl");
    grid.row([
        "ratio",
        "pressure",
        "first Nm",
        "second Nm",
        "difference Nm",
        "thesis 5.3.4",
    ]);
    for &ratio in &job.plan.ratios {
        let on = || {
            found
                .second_box
                .iter()
                .filter(|t| near(t.first.set.ratio, ratio))
        };
        grid.row([
            job.conditions.ratio_name(ratio),
            format!("x {}", plain(job.conditions.pressure.second_box)),
            Range::of(on().map(|t| t.first.answer.total_nm())).text(2),
            Range::of(on().map(|t| t.second.answer.total_nm())).text(2),
            Range::of(on().map(|t| t.difference_nm())).text(2),
            "about -1, 5 to 10 % less pressure".to_owned(),
        ]);
    }
    grid.text()
}
