//! Pictures of the transmission rig's tests, after the figures of thesis chapter 5, with the numbers of the thesis next to the computed ones;
//! titles are sentences with numbers of the picture.

mod says;

use super::lines::{LineChart, LinePanel, Look, Palette, Points, PrintedMark, line_chart};
use super::printed::{RigNumber, rig};
use cvtcycle_model::keys;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::rig::BenchPoint;
use cvtcycle_model::rig::transmission::{
    Branch, Conditions, Loop, Moment, Piece, Stage, SteadyPoint, StripDown, TwoBoxes,
};
use cvtcycle_output::Component;
use cvtcycle_output::rig::{given, oil_degc, rpm};

/// File name and SVG text.
pub type NamedSvg = (String, String);

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
    /// Settings of the rig.
    pub conditions: &'a Conditions,
}

impl Subject<'_> {
    /// A chart of one ratio against speed, unless it has another axis, with its file name.
    fn picture(&self, kind: &str, ratio: f64, more: &str, mut chart: LineChart) -> NamedSvg {
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

    /// "in low", or "at I = 1.25".
    fn place(&self, ratio: f64) -> String {
        let name = self.conditions.ratio_name(ratio);
        match name == format!("{ratio}") {
            true => format!("at I = {ratio}"),
            false => format!("in {name}"),
        }
    }

    /// Numbers of the thesis for a quantity at a ratio.
    fn printed(&self, ratio: f64, quantity: RigNumber) -> Vec<PrintedMark> {
        rig(self.vehicle, &self.conditions.ratio_name(ratio), quantity)
    }
}

/// Rows of a test and their operating points.
struct Sheet<'a, T> {
    rows: &'a [T],
    set: fn(&T) -> &BenchPoint,
}

impl<T> Sheet<'_, T> {
    /// Distinct values in the order of the rows.
    fn distinct(&self, quantity: impl Fn(&BenchPoint) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::new();
        for x in self.rows.iter().map(|row| quantity((self.set)(row))) {
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

    /// A value against speed, over the rows of one ratio and temperature that `keep` selects.
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

    /// A panel for each temperature.
    fn panels(&self, y_title: &'static str, lines: impl Fn(f64) -> Lines) -> Vec<LinePanel> {
        let temperatures = self.temperatures().into_iter();
        let panel = |t: f64| panel(&bulk_oil(t), y_title, lines(t));
        temperatures.map(panel).collect()
    }

    /// First and last temperature, which enclose the others.
    fn ends(&self) -> Vec<f64> {
        let all = self.temperatures();
        let last = all.last().copied().filter(|_| all.len() > 1);
        all.first().copied().into_iter().chain(last).collect()
    }

    /// The rows of a ratio.
    fn at(&self, ratio: f64) -> impl Iterator<Item = &T> {
        self.rows
            .iter()
            .filter(move |row| same((self.set)(row).ratio, ratio))
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

fn bulk_oil(degc: f64) -> String {
    format!("Bulk oil {degc} \u{b0}C")
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
    title: String,
    panels: Vec<LinePanel>,
    legend: &str,
    names: Vec<(Look, String)>,
) -> LineChart {
    LineChart {
        title,
        panels,
        legend: legend.to_owned(),
        names,
        ..LineChart::default()
    }
}

/// Torque loss and secondary pressure against speed, a line for each temperature (Figs 5-1 to 5-4).
pub fn steady(rows: &[SteadyPoint], subject: &Subject) -> Vec<NamedSvg> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let of_ratio = |ratio: f64| {
        let figure = |kind: &str, title: String, y_title, y: fn(&SteadyPoint) -> f64, printed| {
            let mut panel = panel("", y_title, sheet.by_temperature(ratio, y));
            panel.printed = printed;
            panel.with_y = vec![0.0];
            let mut chart = chart(title, vec![panel], "Bulk oil", sheet.temperature_names());
            chart.palette = Palette::Ordered;
            subject.picture(kind, ratio, "", chart)
        };
        let (place, printed) = (
            subject.place(ratio),
            subject.printed(ratio, RigNumber::Total),
        );
        let loss = |r: &SteadyPoint| r.answer.total_nm();
        let bar = |r: &SteadyPoint| r.answer.secondary_pa / 1e5;
        let losses = says::range(sheet.at(ratio).map(loss));
        let pressures = says::range(sheet.at(ratio).map(bar));
        let apart = says::apart(sheet.at(ratio).map(|r| (rpm(&r.set), bar(r))));
        [
            figure(
                "steady_loss",
                says::loss(losses, &place, &printed),
                LOSS,
                loss,
                printed,
            ),
            figure(
                "steady_pressure",
                says::pressure(pressures, apart, &place),
                PRESSURE,
                bar,
                Vec::new(),
            ),
        ]
    };
    sheet.ratios().into_iter().flat_map(of_ratio).collect()
}

/// Torque loss added by a load, against speed: a line for each torque, a panel for each temperature.
pub fn loaded(rows: &[SteadyPoint], subject: &Subject) -> Vec<NamedSvg> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let mut torques = sheet.distinct(|set| set.output_nm);
    torques.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let Some((least, others)) = torques.split_first() else {
        return Vec::new();
    };
    let of_ratio = |ratio: f64| {
        let line = |degc: f64, nm: f64| {
            let own = |set: &BenchPoint| same(set.output_nm, nm);
            sheet.line((ratio, degc), own, |r| r.answer.total_nm())
        };
        let added = |degc: f64, nm: f64| -> Points {
            let pairs = line(degc, nm).into_iter().zip(line(degc, *least));
            pairs.map(|((x, y), (_, base))| (x, y - base)).collect()
        };
        let lines = |degc: f64| {
            let torques = others.iter().enumerate();
            torques
                .map(|(k, nm)| (Look::solid(k), added(degc, *nm)))
                .collect()
        };
        let names = names(others.iter().map(|t| format!("{t} Nm")));
        let most = others.last().copied().unwrap_or(*least);
        let at_most = sheet
            .temperatures()
            .into_iter()
            .flat_map(|t| added(t, most));
        let title = says::load(
            says::range(at_most.map(|p| p.1)),
            most,
            &subject.place(ratio),
        );
        let mut panels = sheet.panels("Added loss [Nm]", lines);
        panels.iter_mut().for_each(|panel| panel.with_y = vec![0.0]);
        let mut chart = chart(title, panels, "Torque at the output", names);
        (chart.same_y, chart.palette) = (true, Palette::Ordered);
        let more = format!(", above the loss at {least} Nm");
        subject.picture("loaded_loss", ratio, &more, chart)
    };
    sheet.ratios().into_iter().map(of_ratio).collect()
}

/// Torque loss against bulk oil temperature, warming and cooling (Figs 5-5 and 5-6).
pub fn transients(loops: &[Loop], subject: &Subject) -> Vec<NamedSvg> {
    // Looks of the second and the third line.
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
        let mut whole = panel("Complete box", LOSS, both(|m| m.answer.total_nm()));
        let start_degc = l
            .moments
            .first()
            .map_or(f64::NAN, |m| m.sump_k - ZERO_DEGC_K);
        whole.printed = subject.printed(l.ratio, RigNumber::Warming { start_degc });
        let panels = vec![
            whole,
            panel("Belt alone", LOSS, both(|m| m.answer.belt_nm())),
            panel("Belt and spray", "Temperature [\u{b0}C]", belt),
        ];
        let names = branches
            .iter()
            .zip(names)
            .map(|((look, _), name)| (*look, name.to_owned()));
        let mut chart = chart(
            says::transient(l.widest(), &subject.place(l.ratio)),
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
pub fn second_box(rows: &[TwoBoxes], subject: &Subject) -> Vec<NamedSvg> {
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
        let gap = |r: &TwoBoxes| r.second.answer.total_nm() - r.first.answer.total_nm();
        let title = says::second_box(
            pressure,
            says::mean(sheet.at(ratio).map(gap)),
            &subject.place(ratio),
        );
        let mut chart = chart(title, sheet.panels(LOSS, lines), "", names);
        chart.same_y = true;
        let more = format!(", pressure of the second {pressure} of the first");
        subject.picture("second_box", ratio, &more, chart)
    };
    sheet.ratios().into_iter().map(of_ratio).collect()
}

/// The strip-down: stages (Figs 5-17 to 5-27), contributions (5-33 to 5-40), components (5-41 to 5-45).
pub fn strip_down(rows: &[StripDown], subject: &Subject) -> Vec<NamedSvg> {
    let sheet = Sheet {
        rows,
        set: |r| &r.set,
    };
    let corrected = ", corrected for pressure";
    let of_ratio = |ratio: f64| {
        let place = subject.place(ratio);
        let printed = |quantity: RigNumber| subject.printed(ratio, quantity);
        let stages = stages(&sheet, ratio, &place);
        let contributions = contributions(&sheet, ratio, &place, &printed(RigNumber::Sum));
        let components = components(&sheet, ratio, &place, &printed);
        [
            subject.picture("strip_down", ratio, "", stages),
            subject.picture("contributions", ratio, corrected, contributions),
            subject.picture("components", ratio, corrected, components),
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

/// Torque loss and pressure of each stage: a line for each, between the coldest and the warmest oil.
fn stages(sheet: &Sheet<StripDown>, ratio: f64, place: &str) -> LineChart {
    let line = |degc: f64, y: &dyn Fn(&StripDown, Stage) -> f64, keep: &dyn Fn(Stage) -> bool| {
        let stages = STAGES
            .into_iter()
            .enumerate()
            .filter(|(_, named)| keep(named.0));
        let line = |(k, (stage, _)): (usize, (Stage, &str))| {
            (
                Look::solid(k),
                sheet.line((ratio, degc), |_| true, |r| y(r, stage)),
            )
        };
        stages.map(line).collect::<Lines>()
    };
    let loss = |r: &StripDown, stage: Stage| r.stage(stage).total_nm();
    let bar = |r: &StripDown, stage: Stage| r.stage(stage).secondary_pa / 1e5;
    let mut panels = Vec::new();
    for degc in sheet.ends() {
        panels.push(panel(&bulk_oil(degc), LOSS, line(degc, &loss, &|_| true)));
        let with_pump = |stage| stage != Stage::PumpRemoved;
        panels.push(panel(
            &bulk_oil(degc),
            PRESSURE,
            line(degc, &bar, &with_pump),
        ));
    }
    let first = sheet.ends().first().copied().unwrap_or(f64::NAN);
    let here = sheet.at(ratio).filter(|r| same(oil_degc(&r.set), first));
    let near = here.min_by(|a, b| says::from_shown(&a.set).total_cmp(&says::from_shown(&b.set)));
    let left = near.map(|r| (rpm(&r.set), first, STAGES.map(|(stage, _)| loss(r, stage))));
    let names = names(STAGES.into_iter().map(|(_, words)| words));
    let mut chart = chart(says::stages(left, place), panels, "", names);
    (chart.same_y, chart.palette) = (true, Palette::Ordered);
    chart
}

/// The losses found by the strip-down, stacked, in the coldest and the warmest oil.
fn contributions(
    sheet: &Sheet<StripDown>,
    ratio: f64,
    place: &str,
    printed: &[PrintedMark],
) -> LineChart {
    let found = |r: &StripDown, piece: Piece| r.piece(piece).corrected_nm;
    let lines = |degc: f64| {
        let line = |piece: Piece| sheet.line((ratio, degc), |_| true, |r| found(r, piece));
        let pieces = PIECES.into_iter().enumerate();
        pieces
            .map(|(k, (piece, ..))| (Look::solid(k), line(piece)))
            .collect()
    };
    let ends = sheet.ends();
    let of_end = |t: &f64| {
        let mut panel = panel(&bulk_oil(*t), LOSS, lines(*t));
        panel.stacked = true;
        panel.printed = printed.to_vec();
        panel
    };
    let panels = ends.iter().map(of_end).collect();
    let drawn = |r: &&StripDown| ends.iter().any(|t| same(oil_degc(&r.set), *t));
    let sums = PIECES.map(|(piece, words, _)| {
        let losses = sheet.at(ratio).filter(drawn).map(|r| found(r, piece));
        (words, losses.sum::<f64>())
    });
    let names = names(PIECES.into_iter().map(|(_, words, _)| words));
    let title = says::contributions(&sums, place);
    let mut chart = chart(title, panels, "From the strip-down", names);
    chart.same_y = true;
    chart.parts = PIECES.into_iter().map(|(.., part)| part).collect();
    chart
}

/// Each component from the strip-down, with its own loss in the complete box as a dotted line.
fn components(
    sheet: &Sheet<StripDown>,
    ratio: f64,
    place: &str,
    printed: &dyn Fn(RigNumber) -> Vec<PrintedMark>,
) -> LineChart {
    fn dotted<T>((mut look, rest): (Look, T)) -> (Look, T) {
        look.dotted = true;
        (look, rest)
    }
    let piece_panel = |(piece, words, _): (Piece, &str, Component)| {
        let mut series = sheet.by_temperature(ratio, |r| r.piece(piece).corrected_nm);
        let own = sheet.by_temperature(ratio, |r| r.piece(piece).true_nm);
        series.extend(own.into_iter().map(dotted));
        let mut panel = panel(words, LOSS, series);
        panel.with_y = vec![0.0];
        panel.printed = printed(RigNumber::Piece(piece));
        panel
    };
    let mut names = sheet.temperature_names();
    let own = names.clone().into_iter().map(dotted);
    names.extend(own.map(|(look, name)| (look, name + ", true")));
    let panels = PIECES.into_iter().map(piece_panel).collect();
    let more = |r: &StripDown| {
        let piece = r.piece(Piece::FinalDrive);
        piece.corrected_nm - piece.true_nm
    };
    let title = says::components(says::mean(sheet.at(ratio).map(more)), place);
    let mut chart = chart(title, panels, "Bulk oil", names);
    chart.palette = Palette::Ordered;
    chart
}
