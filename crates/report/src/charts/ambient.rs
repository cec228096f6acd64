//! Pictures of a matrix of ambient temperatures: fuel, the subject's excess, warm-up side by side.

use super::lines::{LineChart, LinePanel, Look, Points, line_chart};
use super::picture::Picture;
use cvtcycle_study::answer::ambient::{FuelPart, Matrix, WarmUp};

const AMBIENT: &str = "Ambient temperature [\u{b0}C]";

/// Ambient temperatures, degC, and a number at each, sorted from cold to warm.
fn points(x: &[f64], y: &[f64]) -> Points {
    let all = x.iter().copied().zip(y.iter().copied());
    let mut list: Points = all
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    list.sort_by(|a, b| a.0.total_cmp(&b.0));
    list
}

/// Series of one panel: a look for each car, solid for the first start and dotted for the second.
fn series(matrix: &Matrix, by_car: &[Vec<Vec<f64>>], first_look: usize) -> Vec<(Look, Points)> {
    let mut list = Vec::new();
    for (car, by_start) in by_car.iter().enumerate() {
        for (start, numbers) in by_start.iter().enumerate() {
            let look = look(matrix, car + first_look, start);
            list.push((look, points(&matrix.ambient_degc, numbers)));
        }
    }
    list
}

/// With two starts a car keeps its colour and the second start is dotted; with more, every line has its own look.
fn look(matrix: &Matrix, car: usize, start: usize) -> Look {
    match matrix.starts.len() {
        0..=2 => Look {
            index: car,
            dotted: start == 1,
        },
        starts => Look::solid(car * starts + start),
    }
}

fn names(matrix: &Matrix, cars: &[String], first_look: usize) -> Vec<(Look, String)> {
    let mut list = Vec::new();
    for (car, name) in cars.iter().enumerate() {
        for (start, word) in matrix.starts.iter().enumerate() {
            let look = look(matrix, car + first_look, start);
            list.push((look, format!("{name}, {word}")));
        }
    }
    list
}

/// A chart with a panel for each part of the fuel.
fn by_part(
    matrix: &Matrix,
    y_title: &'static str,
    first_look: usize,
    of: fn(&FuelPart) -> &[Vec<Vec<f64>>],
) -> LineChart {
    let panel = |part: &FuelPart| LinePanel {
        heading: heading(&part.name),
        y_title,
        series: series(matrix, of(part), first_look),
        ..LinePanel::default()
    };
    LineChart {
        x_title: AMBIENT,
        panels: matrix.fuel.iter().map(panel).collect(),
        marked: true,
        ..LineChart::default()
    }
}

/// Fuel against ambient temperature: whole cycle and phases.
pub fn ambient_fuel(matrix: &Matrix, title: &str) -> Picture {
    line_chart(&LineChart {
        title: "Fuel against ambient temperature".into(),
        subject: title.to_owned(),
        legend: "Car, start".into(),
        names: names(matrix, &matrix.cars, 0),
        ..by_part(matrix, "Fuel [L/100 km]", 0, |part| &part.l_per_100km)
    })
}

/// Excess of the subject against ambient temperature; none without baselines.
pub fn ambient_penalty(matrix: &Matrix, title: &str) -> Option<Picture> {
    let (subject, baselines) = matrix.cars.split_first()?;
    let over: Vec<String> = baselines
        .iter()
        .map(|name| format!("over {name}"))
        .collect();
    let mut chart = LineChart {
        title: format!("Fuel of {subject} over that of its baselines"),
        subject: title.to_owned(),
        same_y: true,
        legend: "Baseline, start".into(),
        names: names(matrix, &over, 1),
        ..by_part(matrix, "Excess fuel [%]", 1, |part| &part.excess_percent)
    };
    for panel in &mut chart.panels {
        panel.with_y = vec![0.0];
    }
    (!baselines.is_empty()).then(|| line_chart(&chart))
}

/// Warm-up from one start: a row of panels for each car, sump at the left, engine oil at the right; a line for each ambient temperature.
pub fn warm_up(matrix: &Matrix, runs: &[WarmUp], start: usize, title: &str) -> Picture {
    let mut panels = Vec::new();
    for (car, name) in matrix.cars.iter().enumerate() {
        let own = |run: &&WarmUp| run.car == car && run.start == start;
        let own = || runs.iter().filter(own);
        let panel = |what: &str, of: fn(&WarmUp) -> &[f64]| LinePanel {
            heading: format!("{name}: {what}"),
            y_title: "Temperature [\u{b0}C]",
            series: own().map(|run| warm_up_line(run, of(run))).collect(),
            ..LinePanel::default()
        };
        panels.push(panel("transmission sump", |run| &run.sump_degc));
        panels.push(panel("engine oil", |run| &run.engine_oil_degc));
    }
    let names = matrix.ambient_degc.iter().enumerate();
    let names = names.map(|(index, degc)| (Look::solid(index), degrees(*degc)));
    let word = matrix.starts.get(start).map_or("", String::as_str);
    line_chart(&LineChart {
        title: format!("Warm-up, start {word}"),
        subject: title.to_owned(),
        x_title: "Time [s]",
        panels,
        same_y: true,
        tight: true,
        legend: "Ambient temperature".into(),
        names: names.collect(),
        ..LineChart::default()
    })
}

fn warm_up_line(run: &WarmUp, degc: &[f64]) -> (Look, Points) {
    let points = run.time_s.iter().copied().zip(degc.iter().copied());
    (Look::solid(run.ambient), points.collect())
}

/// "−10 °C".
fn degrees(degc: f64) -> String {
    format!("{degc} \u{b0}C").replace('-', "\u{2212}")
}

fn heading(part: &str) -> String {
    if part == "total" {
        "Whole cycle".to_owned()
    } else {
        part.to_uppercase()
    }
}
