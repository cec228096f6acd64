//! Pictures of the transmission rig's tests, after the figures of thesis chapter 5.

use crate::charts::chart::{Chart, ChartPanel, Look, Points, chart};
use cvtcycle_model::bench::BenchPoint;
use cvtcycle_model::bench::transmission::{
    Branch, Conditions, Loop, Piece, Stage, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_output::rig::{clean, oil_degc, rpm};

/// File name and SVG text.
pub type Picture = (String, String);

const SPEED: &str = "Input speed [rpm]";
const LOSS: &str = "Torque loss [Nm]";
const PRESSURE: &str = "Secondary pressure [bar]";

/// What all pictures say of their subject.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// What the rig is set to.
    pub conditions: &'a Conditions,
}

impl Subject<'_> {
    fn of(&self, ratio: f64, more: &str) -> String {
        format!("{}, {}{more}", self.vehicle, self.ratio(ratio))
    }

    /// "low ratio, I = 2.417".
    fn ratio(&self, ratio: f64) -> String {
        let name = self.conditions.ratio_name(ratio);
        if name == format!("{ratio}") {
            format!("I = {ratio}")
        } else {
            format!("{name} ratio, I = {ratio}")
        }
    }

    fn file(&self, kind: &str, ratio: f64) -> String {
        format!(
            "{kind}_{}.svg",
            self.conditions.ratio_name(ratio).replace('.', "_")
        )
    }
}

/// Distinct values in the order in which they come.
fn distinct<T>(rows: &[T], of: impl Fn(&T) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for x in rows.iter().map(of) {
        if !values.iter().any(|y| (x - y).abs() < 1e-9) {
            values.push(x);
        }
    }
    values
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

fn line(index: usize) -> Look {
    Look {
        index,
        dotted: false,
    }
}

fn degrees(temps: &[f64]) -> Vec<(Look, String)> {
    temps
        .iter()
        .enumerate()
        .map(|(k, t)| (line(k), format!("{t} \u{b0}C")))
        .collect()
}

/// A line a temperature against speed.
fn by_temperature<T>(
    rows: &[T],
    set: fn(&T) -> &BenchPoint,
    ratio: f64,
    y: impl Fn(&T) -> f64,
) -> Vec<(Look, Points)> {
    let line_at = |t: f64| {
        let here = rows
            .iter()
            .filter(|r| same(set(r).ratio, ratio) && same(oil_degc(set(r)), t));
        here.map(|r| (rpm(set(r)), y(r))).collect::<Points>()
    };
    distinct(rows, |r| oil_degc(set(r)))
        .into_iter()
        .enumerate()
        .map(|(k, t)| (line(k), line_at(t)))
        .collect()
}

fn panel(heading: &str, y_title: &'static str, series: Vec<(Look, Points)>) -> ChartPanel {
    ChartPanel {
        heading: heading.to_owned(),
        y_title,
        series,
        ..ChartPanel::default()
    }
}

fn words(what: &str, names: &[(Look, String)]) -> String {
    let list: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
    format!("{what}: {}.", list.join(", "))
}

/// Something of the steady points against speed; file, title and axis.
fn against_speed(
    rows: &[SteadyPoint],
    subject: &Subject,
    ratio: f64,
    (file, title, y_title): (&str, &str, &'static str),
    y: fn(&SteadyPoint) -> f64,
) -> Picture {
    let names = degrees(&distinct(rows, |r| oil_degc(&r.set)));
    let picture = chart(&Chart {
        title: title.to_owned(),
        subject: subject.of(ratio, ""),
        description: words(
            &format!("{title} against input speed, a line for each temperature of the bulk oil"),
            &names,
        ),
        x_title: SPEED,
        panels: vec![panel(
            "",
            y_title,
            by_temperature(rows, |r| &r.set, ratio, y),
        )],
        legend: "Bulk oil".to_owned(),
        names,
        ..Chart::default()
    });
    (subject.file(file, ratio), picture.svg)
}

/// Torque loss and secondary pressure against speed, a line a temperature (Figs 5-1 to 5-4).
#[must_use]
pub fn steady(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    let mut pictures = Vec::new();
    for ratio in distinct(rows, |r| r.set.ratio) {
        pictures.push(against_speed(
            rows,
            subject,
            ratio,
            ("steady_loss", "Torque loss without load", LOSS),
            |r| r.answer.total_nm(),
        ));
        let pressure = (
            "steady_pressure",
            "Secondary pressure without load",
            PRESSURE,
        );
        pictures.push(against_speed(rows, subject, ratio, pressure, |r| {
            r.answer.secondary_pa / 1e5
        }));
    }
    pictures
}

/// Torque loss under load against speed, a line a torque, a panel a temperature.
#[must_use]
pub fn loaded(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    let torques = distinct(rows, |r| r.set.output_nm);
    let names: Vec<(Look, String)> = torques
        .iter()
        .enumerate()
        .map(|(k, t)| (line(k), format!("{t} Nm")))
        .collect();
    let of_ratio = |ratio: f64| {
        let on = move |r: &&SteadyPoint, t: f64, nm: f64| {
            same(r.set.ratio, ratio) && same(oil_degc(&r.set), t) && same(r.set.output_nm, nm)
        };
        let lines = |t: f64| {
            let at = |nm: f64| {
                rows.iter()
                    .filter(move |r| on(r, t, nm))
                    .map(|r| (rpm(&r.set), r.answer.total_nm()))
                    .collect()
            };
            torques
                .iter()
                .enumerate()
                .map(|(k, nm)| (line(k), at(*nm)))
                .collect()
        };
        let panels = distinct(rows, |r| oil_degc(&r.set))
            .into_iter()
            .map(|t| panel(&format!("Bulk oil {t} \u{b0}C"), LOSS, lines(t)))
            .collect();
        let picture = chart(&Chart {
            title: "Torque loss under load".to_owned(),
            subject: subject.of(ratio, ""),
            description: words(
                "Torque loss against input speed, a panel for each temperature, a line for each torque at the output shaft",
                &names,
            ),
            x_title: SPEED,
            panels,
            same_y: true,
            legend: "Output torque".to_owned(),
            names: names.clone(),
            ..Chart::default()
        });
        (subject.file("loaded_loss", ratio), picture.svg)
    };
    distinct(rows, |r| r.set.ratio)
        .into_iter()
        .map(of_ratio)
        .collect()
}

/// Torque loss against bulk oil temperature, warming and cooling (Figs 5-5 and 5-6).
#[must_use]
pub fn transients(loops: &[Loop], subject: &Subject) -> Vec<Picture> {
    let names = vec![
        (line(1), "Warming by its own losses".to_owned()),
        (line(2), "Cooling by the rig's cooler".to_owned()),
    ];
    let speed = clean(subject.conditions.transient.speed_rad_s * 30.0 / std::f64::consts::PI);
    let picture = |l: &Loop| {
        let on = |branch: Branch, y: fn(&cvtcycle_model::bench::transmission::Moment) -> f64| {
            l.moments
                .iter()
                .filter(|m| m.branch == branch)
                .map(|m| (m.sump_k - ZERO_DEGC_K, y(m)))
                .collect::<Points>()
        };
        let both = |y| {
            vec![
                (line(1), on(Branch::Warming, y)),
                (line(2), on(Branch::Cooling, y)),
            ]
        };
        let picture = chart(&Chart {
            title: "Temperature transient without load".to_owned(),
            subject: subject.of(l.ratio, &format!(", {speed} rpm")),
            description: words(
                "Torque loss, and below it belt temperature, against bulk oil temperature",
                &names,
            ),
            x_title: "Bulk oil [\u{b0}C]",
            panels: vec![
                panel("Complete box", LOSS, both(|m| m.answer.total_nm())),
                panel("Belt alone", LOSS, both(|m| m.answer.belt_nm())),
                panel(
                    "Belt and spray",
                    "Temperature [\u{b0}C]",
                    both(|m| m.answer.belt_k - ZERO_DEGC_K),
                ),
            ],
            names: names.clone(),
            ..Chart::default()
        });
        (subject.file("transient", l.ratio), picture.svg)
    };
    loops.iter().map(picture).collect()
}

/// Torque loss of both boxes against speed, a panel a temperature (Figs 5-7 to 5-14).
#[must_use]
pub fn second_box(rows: &[TwoBoxes], subject: &Subject) -> Vec<Picture> {
    let names = vec![
        (line(0), "First box".to_owned()),
        (line(1), "Second box".to_owned()),
    ];
    let picture = |ratio: f64| {
        let on = |t: f64, y: fn(&TwoBoxes) -> f64| {
            let here = rows
                .iter()
                .filter(|r| same(r.first.set.ratio, ratio) && same(oil_degc(&r.first.set), t));
            here.map(|r| (rpm(&r.first.set), y(r))).collect::<Points>()
        };
        let lines = |t: f64| {
            vec![
                (line(0), on(t, |r| r.first.answer.total_nm())),
                (line(1), on(t, |r| r.second.answer.total_nm())),
            ]
        };
        let temps = distinct(rows, |r| oil_degc(&r.first.set));
        let picture = chart(&Chart {
            title: "Torque loss of two boxes without load".to_owned(),
            subject: subject.of(
                ratio,
                &format!(
                    ", pressure of the second {} of the first",
                    subject.conditions.pressure.second_box
                ),
            ),
            description: words(
                "Torque loss against input speed, a panel for each temperature of the bulk oil",
                &names,
            ),
            x_title: SPEED,
            panels: temps
                .into_iter()
                .map(|t| panel(&format!("Bulk oil {t} \u{b0}C"), LOSS, lines(t)))
                .collect(),
            same_y: true,
            names: names.clone(),
            ..Chart::default()
        });
        (subject.file("second_box", ratio), picture.svg)
    };
    distinct(rows, |r| r.first.set.ratio)
        .into_iter()
        .map(picture)
        .collect()
}

/// The strip-down: stages (Figs 5-17 to 5-27), contributions (5-33 to 5-40), components (5-41 to 5-45).
#[must_use]
pub fn strip_down(rows: &[StripDown], subject: &Subject) -> Vec<Picture> {
    let mut pictures = Vec::new();
    for ratio in distinct(rows, |r| r.set.ratio) {
        pictures.push((
            subject.file("strip_down", ratio),
            stages(rows, subject, ratio),
        ));
        pictures.push((
            subject.file("contributions", ratio),
            contributions(rows, subject, ratio),
        ));
        pictures.push((
            subject.file("components", ratio),
            components(rows, subject, ratio),
        ));
    }
    pictures
}

fn stage_words(stage: Stage) -> &'static str {
    match stage {
        Stage::Complete => "Complete",
        Stage::FinalDriveRemoved => "Final drive removed",
        Stage::BeltRemoved => "Belt removed",
        Stage::ClutchRemoved => "Clutch removed (in low)",
        Stage::PumpRemoved => "Pump removed: input shaft",
    }
}

fn piece_words(piece: Piece) -> &'static str {
    match piece {
        Piece::Pump => "Pump",
        Piece::InputShaft => "Input shaft",
        Piece::Clutch => "Reverse clutch",
        Piece::Belt => "Belt",
        Piece::FinalDrive => "Final drive",
    }
}

fn stages(rows: &[StripDown], subject: &Subject, ratio: f64) -> String {
    let names = degrees(&distinct(rows, |r| oil_degc(&r.set)));
    let mut panels = Vec::new();
    for stage in Stage::ALL {
        let words = stage_words(stage);
        panels.push(panel(
            words,
            LOSS,
            by_temperature(rows, |r| &r.set, ratio, |r| r.stage(stage).total_nm()),
        ));
        if stage != Stage::PumpRemoved {
            panels.push(panel(
                words,
                PRESSURE,
                by_temperature(
                    rows,
                    |r| &r.set,
                    ratio,
                    |r| r.stage(stage).secondary_pa / 1e5,
                ),
            ));
        }
    }
    chart(&Chart {
        title: "Strip-down: torque loss and pressure of each stage".to_owned(),
        subject: subject.of(ratio, ""),
        description: words(
            "Torque loss and secondary pressure against input speed after each part removed, a line for each temperature",
            &names,
        ),
        x_title: SPEED,
        panels,
        legend: "Bulk oil".to_owned(),
        names,
        ..Chart::default()
    })
    .svg
}

fn contributions(rows: &[StripDown], subject: &Subject, ratio: f64) -> String {
    let names: Vec<(Look, String)> = Piece::ALL
        .iter()
        .enumerate()
        .map(|(k, p)| (line(k), piece_words(*p).to_owned()))
        .collect();
    let layers = |t: f64| {
        let here = || {
            rows.iter()
                .filter(move |r| same(r.set.ratio, ratio) && same(oil_degc(&r.set), t))
        };
        let of = |piece: Piece| {
            here()
                .map(|r| (rpm(&r.set), r.piece(piece).corrected_nm))
                .collect::<Points>()
        };
        Piece::ALL
            .iter()
            .enumerate()
            .map(|(k, piece)| (line(k), of(*piece)))
            .collect()
    };
    let temps = distinct(rows, |r| oil_degc(&r.set));
    let of = |t: f64| ChartPanel {
        stacked: true,
        ..panel(&format!("Bulk oil {t} \u{b0}C"), LOSS, layers(t))
    };
    chart(&Chart {
        title: "Contributions to the torque loss, from the strip-down".to_owned(),
        subject: subject.of(ratio, ", corrected for pressure"),
        description: words("Losses found by the strip-down, stacked, against input speed, a panel for each temperature", &names),
        x_title: SPEED,
        panels: temps.into_iter().map(of).collect(),
        same_y: true,
        legend: "From the strip-down".to_owned(),
        names,
        ..Chart::default()
    })
    .svg
}

fn components(rows: &[StripDown], subject: &Subject, ratio: f64) -> String {
    let temps = distinct(rows, |r| oil_degc(&r.set));
    let mut names = degrees(&temps);
    names.extend(temps.iter().enumerate().map(|(index, t)| {
        (
            Look {
                index,
                dotted: true,
            },
            format!("{t} \u{b0}C, true"),
        )
    }));
    let lines = |piece: Piece| {
        let mut lines = by_temperature(rows, |r| &r.set, ratio, |r| r.piece(piece).corrected_nm);
        let own = by_temperature(rows, |r| &r.set, ratio, |r| r.piece(piece).true_nm);
        lines.extend(own.into_iter().map(|(look, points)| {
            (
                Look {
                    dotted: true,
                    ..look
                },
                points,
            )
        }));
        lines
    };
    let of = |piece: Piece| ChartPanel {
        with_y: vec![0.0],
        ..panel(piece_words(piece), LOSS, lines(piece))
    };
    chart(&Chart {
        title: "Components from the strip-down, beside those of the model".to_owned(),
        subject: subject.of(ratio, ", corrected for pressure"),
        description: words(
            "Loss of each component against input speed; dotted: its own loss in the complete box",
            &names,
        ),
        x_title: SPEED,
        panels: Piece::ALL.into_iter().map(of).collect(),
        legend: "Bulk oil".to_owned(),
        names,
        ..Chart::default()
    })
    .svg
}
