//! Pictures of the transmission rig's tests, after the figures of thesis chapter 5.

use crate::charts::lines::{LineChart, LinePanel, Look, Points, line_chart};
use cvtcycle_model::bench::BenchPoint;
use cvtcycle_model::bench::transmission::{
    Branch, Conditions, Loop, Moment, SteadyPoint, TwoBoxes,
};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_output::rig::{given, oil_degc, rpm};

/// File name and SVG text.
pub type Picture = (String, String);

pub(super) const SPEED: &str = "Input speed [rpm]";
pub(super) const LOSS: &str = "Torque loss [Nm]";
pub(super) const PRESSURE: &str = "Secondary pressure [bar]";

/// What all pictures say of their subject.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// What the rig is set to.
    pub conditions: &'a Conditions,
}

impl Subject<'_> {
    pub(super) fn of(&self, ratio: f64, more: &str) -> String {
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

    pub(super) fn file(&self, kind: &str, ratio: f64) -> String {
        format!(
            "{kind}_{}.svg",
            self.conditions.ratio_name(ratio).replace('.', "_")
        )
    }
}

/// Distinct values in the order in which they come.
pub(super) fn distinct<T>(rows: &[T], of: impl Fn(&T) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = Vec::new();
    for x in rows.iter().map(of) {
        if !values.iter().any(|y| (x - y).abs() < 1e-9) {
            values.push(x);
        }
    }
    values
}

pub(super) fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

pub(super) fn line(index: usize) -> Look {
    Look {
        index,
        dotted: false,
    }
}

pub(super) fn degrees(temps: &[f64]) -> Vec<(Look, String)> {
    temps
        .iter()
        .enumerate()
        .map(|(k, t)| (line(k), format!("{t} \u{b0}C")))
        .collect()
}

/// A line a temperature against speed.
pub(super) fn by_temperature<T>(
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

pub(super) fn panel(
    heading: &str,
    y_title: &'static str,
    series: Vec<(Look, Points)>,
) -> LinePanel {
    LinePanel {
        heading: heading.to_owned(),
        y_title,
        series,
        ..LinePanel::default()
    }
}

pub(super) fn words(what: &str, names: &[(Look, String)]) -> String {
    let list: Vec<&str> = names.iter().map(|(_, name)| name.as_str()).collect();
    format!("{what}: {}.", list.join(", "))
}

/// A chart with its file name.
pub(super) fn picture(subject: &Subject, kind: &str, ratio: f64, chart: &LineChart) -> Picture {
    (subject.file(kind, ratio), line_chart(chart).svg)
}

/// Points of rows against speed.
pub(super) fn points<'r, T: 'r>(
    rows: impl Iterator<Item = &'r T>,
    set: fn(&T) -> &BenchPoint,
    y: impl Fn(&T) -> f64,
) -> Points {
    rows.map(|row| (rpm(set(row)), y(row))).collect()
}

/// Heading of a panel of one temperature.
pub(super) fn bulk_oil(degc: f64) -> String {
    format!("Bulk oil {degc} \u{b0}C")
}

/// Torque loss and secondary pressure against speed, a line for each temperature (Figs 5-1 to 5-4).
#[must_use]
pub fn steady(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    type Quantity = (
        &'static str,
        &'static str,
        &'static str,
        fn(&SteadyPoint) -> f64,
    );
    let quantities: [Quantity; 2] = [
        ("steady_loss", "Torque loss without load", LOSS, |r| {
            r.answer.total_nm()
        }),
        (
            "steady_pressure",
            "Secondary pressure without load",
            PRESSURE,
            |r| r.answer.secondary_pa / 1e5,
        ),
    ];
    let names = degrees(&distinct(rows, |r| oil_degc(&r.set)));
    let mut pictures = Vec::new();
    for ratio in distinct(rows, |r| r.set.ratio) {
        for (kind, title, y_title, y) in quantities {
            let what =
                format!("{title} against input speed, a line for each temperature of the bulk oil");
            let chart = LineChart {
                title: title.to_owned(),
                subject: subject.of(ratio, ""),
                description: words(&what, &names),
                x_title: SPEED,
                panels: vec![panel(
                    "",
                    y_title,
                    by_temperature(rows, |r| &r.set, ratio, y),
                )],
                legend: "Bulk oil".to_owned(),
                names: names.clone(),
                ..LineChart::default()
            };
            pictures.push(picture(subject, kind, ratio, &chart));
        }
    }
    pictures
}

/// Torque loss under load against speed, a line for each torque, a panel for each temperature.
#[must_use]
pub fn loaded(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    let torques = distinct(rows, |r| r.set.output_nm);
    let names = torques
        .iter()
        .enumerate()
        .map(|(k, t)| (line(k), format!("{t} Nm")));
    let names: Vec<(Look, String)> = names.collect();
    let lines = |ratio: f64, degc: f64| {
        let at = |nm: f64| {
            let own = rows.iter().filter(move |r| {
                same(r.set.ratio, ratio)
                    && same(oil_degc(&r.set), degc)
                    && same(r.set.output_nm, nm)
            });
            points(own, |r| &r.set, |r| r.answer.total_nm())
        };
        torques
            .iter()
            .enumerate()
            .map(|(k, nm)| (line(k), at(*nm)))
            .collect()
    };
    let of_ratio = |ratio: f64| {
        let temps = distinct(rows, |r| oil_degc(&r.set)).into_iter();
        let chart = LineChart {
            title: "Torque loss under load".to_owned(),
            subject: subject.of(ratio, ""),
            description: words(
                "Torque loss against input speed, a panel for each temperature, a line for each torque at the output shaft",
                &names,
            ),
            x_title: SPEED,
            panels: temps
                .map(|t| panel(&bulk_oil(t), LOSS, lines(ratio, t)))
                .collect(),
            same_y: true,
            legend: "Output torque".to_owned(),
            names: names.clone(),
            ..LineChart::default()
        };
        picture(subject, "loaded_loss", ratio, &chart)
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
    let speed = given(subject.conditions.transient.speed_rad_s * 30.0 / std::f64::consts::PI);
    let of_loop = |l: &Loop| {
        let both = |y: fn(&Moment) -> f64| {
            let on = |branch: Branch| {
                let moments = l.moments.iter().filter(|m| m.branch == branch);
                moments
                    .map(|m| (m.sump_k - ZERO_DEGC_K, y(m)))
                    .collect::<Points>()
            };
            vec![
                (line(1), on(Branch::Warming)),
                (line(2), on(Branch::Cooling)),
            ]
        };
        let belt = both(|m| m.answer.belt_k - ZERO_DEGC_K);
        let chart = LineChart {
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
                panel("Belt and spray", "Temperature [\u{b0}C]", belt),
            ],
            names: names.clone(),
            ..LineChart::default()
        };
        picture(subject, "transient", l.ratio, &chart)
    };
    loops.iter().map(of_loop).collect()
}

/// Torque loss of both boxes against speed, a panel for each temperature (Figs 5-7 to 5-14).
#[must_use]
pub fn second_box(rows: &[TwoBoxes], subject: &Subject) -> Vec<Picture> {
    let names = vec![
        (line(0), "First box".to_owned()),
        (line(1), "Second box".to_owned()),
    ];
    let pressure = subject.conditions.pressure.second_box;
    let of_ratio = |ratio: f64| {
        let lines = |degc: f64| {
            let on = |y: fn(&TwoBoxes) -> f64| {
                let own = rows.iter().filter(|r| {
                    same(r.first.set.ratio, ratio) && same(oil_degc(&r.first.set), degc)
                });
                points(own, |r| &r.first.set, y)
            };
            vec![
                (line(0), on(|r| r.first.answer.total_nm())),
                (line(1), on(|r| r.second.answer.total_nm())),
            ]
        };
        let temps = distinct(rows, |r| oil_degc(&r.first.set)).into_iter();
        let more = format!(", pressure of the second {pressure} of the first");
        let chart = LineChart {
            title: "Torque loss of two boxes without load".to_owned(),
            subject: subject.of(ratio, &more),
            description: words(
                "Torque loss against input speed, a panel for each temperature of the bulk oil",
                &names,
            ),
            x_title: SPEED,
            panels: temps.map(|t| panel(&bulk_oil(t), LOSS, lines(t))).collect(),
            same_y: true,
            names: names.clone(),
            ..LineChart::default()
        };
        picture(subject, "second_box", ratio, &chart)
    };
    distinct(rows, |r| r.first.set.ratio)
        .into_iter()
        .map(of_ratio)
        .collect()
}
