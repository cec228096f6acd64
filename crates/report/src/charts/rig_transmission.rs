//! Pictures of the transmission rig's tests, after the figures of thesis chapter 5.

use super::lines::{LineChart, LinePanel, Look, Points, line_chart};
use cvtcycle_model::bench::BenchPoint;
use cvtcycle_model::bench::transmission::{
    Branch, Conditions, Loop, Moment, Piece, Stage, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle_model::fluid::ZERO_DEGC_K;
use cvtcycle_model::keys;
use cvtcycle_output::Component;
use cvtcycle_output::rig::{given, oil_degc, rpm};

/// File name and SVG text.
pub type Picture = (String, String);

const SPEED: &str = "Input speed [rpm]";
const LOSS: &str = "Torque loss [Nm]";
const PRESSURE: &str = "Secondary pressure [bar]";

/// Lines of a panel, each with its look.
type Lines = Vec<(Look, Points)>;

/// The vehicle and the settings of the rig, for titles and file names.
#[derive(Clone, Debug)]
pub struct Subject<'a> {
    /// Name of the vehicle.
    pub vehicle: &'a str,
    /// What the rig is set to.
    pub conditions: &'a Conditions,
}

impl Subject<'_> {
    /// A chart of one ratio against speed, unless it has another axis, with its file name.
    fn picture(&self, kind: &str, ratio: f64, more: &str, mut chart: LineChart) -> Picture {
        let name = self.conditions.ratio_name(ratio);
        let named = name != format!("{ratio}");
        let words = if named {
            format!("{name} ratio, ")
        } else {
            String::new()
        };
        chart.subject = format!("{}, {words}I = {ratio}{more}", self.vehicle);
        if chart.x_title.is_empty() {
            chart.x_title = SPEED;
        }
        let file = format!("{kind}_{}.svg", name.replace('.', "_"));
        (file, line_chart(&chart).svg)
    }
}

/// Rows of a test and their operating points.
struct Sheet<'a, T> {
    rows: &'a [T],
    set: fn(&T) -> &BenchPoint,
}

impl<T> Sheet<'_, T> {
    /// Distinct values in the order of the rows.
    fn distinct(&self, of: impl Fn(&BenchPoint) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::new();
        for x in self.rows.iter().map(|row| of((self.set)(row))) {
            if !values.iter().any(|y| same(x, *y)) {
                values.push(x);
            }
        }
        values
    }

    fn ratios(&self) -> Vec<f64> {
        self.distinct(|set| set.ratio)
    }

    fn temperatures(&self) -> Vec<f64> {
        self.distinct(oil_degc)
    }

    /// Look and name of the line of each temperature.
    fn temperature_names(&self) -> Vec<(Look, String)> {
        names(self.temperatures().iter().map(|t| format!("{t} \u{b0}C")))
    }

    /// A value against speed, over the rows of one ratio and temperature, and of those that `keep` chooses.
    fn line(
        &self,
        (ratio, degc): (f64, f64),
        keep: impl Fn(&BenchPoint) -> bool,
        y: impl Fn(&T) -> f64,
    ) -> Points {
        let here = |set: &BenchPoint| same(set.ratio, ratio) && same(oil_degc(set), degc);
        let rows = self.rows.iter().map(|row| ((self.set)(row), row));
        let rows = rows.filter(|(set, _)| here(set) && keep(set));
        rows.map(|(set, row)| (rpm(set), y(row))).collect()
    }

    /// A line against speed for each temperature.
    fn by_temperature(&self, ratio: f64, y: impl Fn(&T) -> f64) -> Lines {
        let temperatures = self.temperatures().into_iter().enumerate();
        let line = |(k, t)| (Look::solid(k), self.line((ratio, t), |_| true, &y));
        temperatures.map(line).collect()
    }

    /// A panel of losses for each temperature.
    fn panels(&self, lines: impl Fn(f64) -> Lines) -> Vec<LinePanel> {
        let temperatures = self.temperatures().into_iter();
        let panel = |t: f64| panel(&format!("Bulk oil {t} \u{b0}C"), LOSS, lines(t));
        temperatures.map(panel).collect()
    }
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The looks of lines with these names.
fn names(names: impl Iterator<Item = impl Into<String>>) -> Vec<(Look, String)> {
    let name = |(k, name): (usize, _)| (Look::solid(k), Into::into(name));
    names.enumerate().map(name).collect()
}

fn panel(heading: &str, y_title: &'static str, series: Lines) -> LinePanel {
    LinePanel {
        heading: heading.to_owned(),
        y_title,
        series,
        ..LinePanel::default()
    }
}

/// A chart with its title, panels, and the heading and names of its legend.
fn chart(
    title: &str,
    panels: Vec<LinePanel>,
    legend: &str,
    names: Vec<(Look, String)>,
) -> LineChart {
    LineChart {
        title: title.to_owned(),
        panels,
        legend: legend.to_owned(),
        names,
        ..LineChart::default()
    }
}

/// A quantity of the steady test: kind, title, axis and value.
type Quantity = (
    &'static str,
    &'static str,
    &'static str,
    fn(&SteadyPoint) -> f64,
);

const STEADY: [Quantity; 2] = [
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

/// Torque loss and secondary pressure against speed, a line for each temperature (Figs 5-1 to 5-4).
pub fn steady(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let mut pictures = Vec::new();
    for ratio in sheet.ratios() {
        for (kind, title, y_title, y) in STEADY {
            let panels = vec![panel("", y_title, sheet.by_temperature(ratio, y))];
            let chart = chart(title, panels, "Bulk oil", sheet.temperature_names());
            pictures.push(subject.picture(kind, ratio, "", chart));
        }
    }
    pictures
}

/// Torque loss under load against speed, a line for each torque, a panel for each temperature.
pub fn loaded(rows: &[SteadyPoint], subject: &Subject) -> Vec<Picture> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let torques = sheet.distinct(|set| set.output_nm);
    let of_ratio = |ratio: f64| {
        let line = |degc: f64, (k, nm): (usize, &f64)| {
            let own = |set: &BenchPoint| same(set.output_nm, *nm);
            (
                Look::solid(k),
                sheet.line((ratio, degc), own, |r| r.answer.total_nm()),
            )
        };
        let lines = |degc: f64| {
            torques
                .iter()
                .enumerate()
                .map(|of| line(degc, of))
                .collect()
        };
        let names = names(torques.iter().map(|t| format!("{t} Nm")));
        let mut chart = chart(
            "Torque loss under load",
            sheet.panels(lines),
            "Output torque",
            names,
        );
        chart.same_y = true;
        subject.picture("loaded_loss", ratio, "", chart)
    };
    sheet.ratios().into_iter().map(of_ratio).collect()
}

/// Torque loss against bulk oil temperature, warming and cooling (Figs 5-5 and 5-6).
pub fn transients(loops: &[Loop], subject: &Subject) -> Vec<Picture> {
    // The looks of the second and the third line.
    let branches = [
        (Look::solid(1), Branch::Warming),
        (Look::solid(2), Branch::Cooling),
    ];
    let names = ["Warming by its own losses", "Cooling by the rig's cooler"];
    let speed = given(keys::rpm(subject.conditions.transient.speed_rad_s));
    let of_loop = |l: &Loop| {
        let both = |y: fn(&Moment) -> f64| {
            let on = |(look, branch): (Look, Branch)| {
                let moments = l.moments.iter().filter(|m| m.branch == branch);
                (
                    look,
                    moments.map(|m| (m.sump_k - ZERO_DEGC_K, y(m))).collect(),
                )
            };
            branches.map(on).to_vec()
        };
        let belt = both(|m| m.answer.belt_k - ZERO_DEGC_K);
        let panels = vec![
            panel("Complete box", LOSS, both(|m| m.answer.total_nm())),
            panel("Belt alone", LOSS, both(|m| m.answer.belt_nm())),
            panel("Belt and spray", "Temperature [\u{b0}C]", belt),
        ];
        let names = branches
            .iter()
            .zip(names)
            .map(|((look, _), name)| (*look, name.to_owned()));
        let mut chart = chart(
            "Temperature transient without load",
            panels,
            "",
            names.collect(),
        );
        chart.x_title = "Bulk oil [\u{b0}C]";
        subject.picture("transient", l.ratio, &format!(", {speed} rpm"), chart)
    };
    loops.iter().map(of_loop).collect()
}

/// Torque loss of both boxes against speed, a panel for each temperature (Figs 5-7 to 5-14).
pub fn second_box(rows: &[TwoBoxes], subject: &Subject) -> Vec<Picture> {
    let sheet = Sheet {
        rows,
        set: |r| &r.first.set,
    };
    let boxes: [fn(&TwoBoxes) -> f64; 2] = [
        |r| r.first.answer.total_nm(),
        |r| r.second.answer.total_nm(),
    ];
    let pressure = subject.conditions.pressure.second_box;
    let of_ratio = |ratio: f64| {
        let line = |degc: f64, k: usize| sheet.line((ratio, degc), |_| true, boxes[k]);
        let lines = |degc: f64| [0, 1].map(|k| (Look::solid(k), line(degc, k))).to_vec();
        let names = names(["First box", "Second box"].into_iter());
        let title = "Torque loss of two boxes without load";
        let mut chart = chart(title, sheet.panels(lines), "", names);
        chart.same_y = true;
        let more = format!(", pressure of the second {pressure} of the first");
        subject.picture("second_box", ratio, &more, chart)
    };
    sheet.ratios().into_iter().map(of_ratio).collect()
}

/// The strip-down: stages (Figs 5-17 to 5-27), contributions (5-33 to 5-40), components (5-41 to 5-45).
pub fn strip_down(rows: &[StripDown], subject: &Subject) -> Vec<Picture> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let corrected = ", corrected for pressure";
    let of_ratio = |ratio: f64| {
        [
            subject.picture("strip_down", ratio, "", stages(&sheet, ratio)),
            subject.picture(
                "contributions",
                ratio,
                corrected,
                contributions(&sheet, ratio),
            ),
            subject.picture("components", ratio, corrected, components(&sheet, ratio)),
        ]
    };
    sheet.ratios().into_iter().flat_map(of_ratio).collect()
}

const STAGES: [(Stage, &str); 5] = [
    (Stage::Complete, "Complete"),
    (Stage::FinalDriveRemoved, "Final drive removed"),
    (Stage::BeltRemoved, "Belt removed"),
    (Stage::ClutchRemoved, "Clutch removed (in low)"),
    (Stage::PumpRemoved, "Pump removed: input shaft"),
];

/// Pieces of the strip-down with their names and the component whose colours they have.
const PIECES: [(Piece, &str, Component); 5] = [
    (Piece::Pump, "Pump", Component::Pump),
    (Piece::InputShaft, "Input shaft", Component::InputShaft),
    (Piece::Clutch, "Reverse clutch", Component::ClutchDrag),
    (Piece::Belt, "Belt", Component::BeltBand),
    (Piece::FinalDrive, "Final drive", Component::FinalDrive),
];

/// Torque loss and pressure after each part was removed.
fn stages(sheet: &Sheet<StripDown>, ratio: f64) -> LineChart {
    let mut panels = Vec::new();
    for (stage, words) in STAGES {
        let loss = sheet.by_temperature(ratio, |r| r.stage(stage).total_nm());
        panels.push(panel(words, LOSS, loss));
        if stage != Stage::PumpRemoved {
            let pressure = sheet.by_temperature(ratio, |r| r.stage(stage).secondary_pa / 1e5);
            panels.push(panel(words, PRESSURE, pressure));
        }
    }
    let title = "Strip-down: torque loss and pressure of each stage";
    chart(title, panels, "Bulk oil", sheet.temperature_names())
}

/// The losses found by the strip-down, stacked.
fn contributions(sheet: &Sheet<StripDown>, ratio: f64) -> LineChart {
    let lines = |degc: f64| {
        let line =
            |piece: Piece| sheet.line((ratio, degc), |_| true, |r| r.piece(piece).corrected_nm);
        let pieces = PIECES.into_iter().enumerate();
        pieces
            .map(|(k, (piece, ..))| (Look::solid(k), line(piece)))
            .collect()
    };
    let mut panels = sheet.panels(lines);
    panels.iter_mut().for_each(|panel| panel.stacked = true);
    let names = names(PIECES.into_iter().map(|(_, words, _)| words));
    let title = "Contributions to the torque loss, from the strip-down";
    let mut chart = chart(title, panels, "From the strip-down", names);
    chart.same_y = true;
    chart.parts = PIECES.into_iter().map(|(.., part)| part).collect();
    chart
}

/// Each component from the strip-down, and dotted its own loss in the complete box.
fn components(sheet: &Sheet<StripDown>, ratio: f64) -> LineChart {
    fn dotted<T>((mut look, of): (Look, T)) -> (Look, T) {
        look.dotted = true;
        (look, of)
    }
    let of = |(piece, words, _): (Piece, &str, Component)| {
        let mut series = sheet.by_temperature(ratio, |r| r.piece(piece).corrected_nm);
        let own = sheet.by_temperature(ratio, |r| r.piece(piece).true_nm);
        series.extend(own.into_iter().map(dotted));
        let mut panel = panel(words, LOSS, series);
        panel.with_y = vec![0.0];
        panel
    };
    let mut names = sheet.temperature_names();
    let own = names.clone().into_iter().map(dotted);
    names.extend(own.map(|(look, name)| (look, name + ", true")));
    let panels = PIECES.into_iter().map(of).collect();
    let title = "Components from the strip-down and of the model";
    chart(title, panels, "Bulk oil", names)
}
