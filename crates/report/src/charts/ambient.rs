//! Pictures of a matrix of ambient temperatures: fuel, the subject's excess, warm-up side by side.

use super::lines::{LineChart, LinePanel, Look, Points, line_chart};
use super::picture::Picture;
use cvtcycle_study::ambient::{FuelPart, Matrix, WarmUp};

const AMBIENT: &str = "Ambient temperature [\u{b0}C]";

/// Ambient temperatures, degC, and a number at each, sorted from cold to warm.
fn points(x: &[f64], y: &[f64]) -> Points {
    let mut list: Points = x
        .iter()
        .copied()
        .zip(y.iter().copied())
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
            list.push((
                look(matrix, car + first_look, start),
                points(&matrix.ambient_degc, numbers),
            ));
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
        starts => solid(car * starts + start),
    }
}

fn names(matrix: &Matrix, cars: &[String], first_look: usize) -> Vec<(Look, String)> {
    let mut list = Vec::new();
    for (car, name) in cars.iter().enumerate() {
        for (start, word) in matrix.starts.iter().enumerate() {
            list.push((
                look(matrix, car + first_look, start),
                format!("{name}, {word}"),
            ));
        }
    }
    list
}

/// Fuel against ambient temperature: whole cycle and phases.
#[must_use]
pub fn ambient_fuel(matrix: &Matrix, title: &str) -> Picture {
    let panel = |part: &FuelPart| LinePanel {
        heading: heading(&part.name),
        y_title: "Fuel [L/100 km]",
        series: series(matrix, &part.l_per_100km, 0),
        ..LinePanel::default()
    };
    let describe = |part: &FuelPart| {
        describe(
            matrix,
            &part.name,
            &part.l_per_100km,
            &matrix.cars,
            "L/100 km",
        )
    };
    line_chart(&LineChart {
        title: "Fuel against ambient temperature".into(),
        subject: title.to_owned(),
        description: matrix
            .fuel
            .iter()
            .map(describe)
            .collect::<Vec<_>>()
            .join(". "),
        x_title: AMBIENT,
        panels: matrix.fuel.iter().map(panel).collect(),
        marked: true,
        legend: "Car, start".into(),
        names: names(matrix, &matrix.cars, 0),
        ..LineChart::default()
    })
}

/// Excess of the subject against ambient temperature; none without baselines.
#[must_use]
pub fn ambient_penalty(matrix: &Matrix, title: &str) -> Option<Picture> {
    let (subject, baselines) = matrix.cars.split_first()?;
    if baselines.is_empty() {
        return None;
    }
    let panel = |part: &FuelPart| LinePanel {
        heading: heading(&part.name),
        y_title: "Excess fuel [%]",
        with_y: vec![0.0],
        series: series(matrix, &part.excess_percent, 1),
        ..LinePanel::default()
    };
    let describe =
        |part: &FuelPart| describe(matrix, &part.name, &part.excess_percent, baselines, "%");
    let over: Vec<String> = baselines
        .iter()
        .map(|name| format!("over {name}"))
        .collect();
    Some(line_chart(&LineChart {
        title: format!("Fuel of {subject} over that of its baselines"),
        subject: title.to_owned(),
        description: matrix
            .fuel
            .iter()
            .map(describe)
            .collect::<Vec<_>>()
            .join(". "),
        x_title: AMBIENT,
        panels: matrix.fuel.iter().map(panel).collect(),
        same_y: true,
        marked: true,
        legend: "Baseline, start".into(),
        names: names(matrix, &over, 1),
        ..LineChart::default()
    }))
}

/// Warm-up from one start: a row of panels for each car, sump at the left, engine oil at the right; a line for each ambient temperature.
#[must_use]
pub fn warm_up(matrix: &Matrix, runs: &[WarmUp], start: usize, title: &str) -> Picture {
    let mut panels = Vec::new();
    for (car, name) in matrix.cars.iter().enumerate() {
        let own = || {
            runs.iter()
                .filter(|run| run.car == car && run.start == start)
        };
        let panel = |what: &str, of: fn(&WarmUp) -> &[f64]| LinePanel {
            heading: format!("{name}: {what}"),
            y_title: "Temperature [\u{b0}C]",
            series: own().map(|run| warm_up_line(run, of(run))).collect(),
            ..LinePanel::default()
        };
        panels.push(panel("transmission sump", |run| &run.sump_degc));
        panels.push(panel("engine oil", |run| &run.engine_oil_degc));
    }
    let ends = runs.iter().filter(|run| run.start == start);
    let ends: Vec<String> = ends.map(|run| warm_up_end(matrix, run)).collect();
    let names = matrix.ambient_degc.iter().enumerate();
    let names = names.map(|(index, degc)| (solid(index), degrees(*degc)));
    let word = matrix.starts.get(start).map_or("", String::as_str);
    line_chart(&LineChart {
        title: format!("Warm-up, start {word}"),
        subject: title.to_owned(),
        description: ends.join(". "),
        x_title: "Time [s]",
        panels,
        same_y: true,
        tight: true,
        legend: "Ambient temperature".into(),
        names: names.collect(),
        ..LineChart::default()
    })
}

fn solid(index: usize) -> Look {
    let dotted = false;
    Look { index, dotted }
}

fn warm_up_line(run: &WarmUp, degc: &[f64]) -> (Look, Points) {
    let points = run.time_s.iter().copied().zip(degc.iter().copied());
    (solid(run.ambient), points.collect())
}

/// The temperatures at the end of a run in words.
fn warm_up_end(matrix: &Matrix, run: &WarmUp) -> String {
    let last = |list: &[f64]| list.last().copied().unwrap_or(f64::NAN);
    let ambient = matrix
        .ambient_degc
        .get(run.ambient)
        .copied()
        .unwrap_or(f64::NAN);
    let car = matrix.cars.get(run.car).map_or("", String::as_str);
    let (sump, oil) = (last(&run.sump_degc), last(&run.engine_oil_degc));
    format!(
        "{car} at {}: sump ends at {sump:.0}, engine oil at {oil:.0} \u{b0}C",
        degrees(ambient)
    )
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

/// The numbers of a panel in words.
fn describe(
    matrix: &Matrix,
    part: &str,
    by_car: &[Vec<Vec<f64>>],
    names: &[String],
    unit: &str,
) -> String {
    let mut list = Vec::new();
    for (name, by_start) in names.iter().zip(by_car) {
        for (start, numbers) in matrix.starts.iter().zip(by_start) {
            let cells: Vec<String> = matrix
                .ambient_degc
                .iter()
                .zip(numbers)
                .map(|(degc, x)| format!("{x:.2} at {}", degrees(*degc)))
                .collect();
            list.push(format!("{name} from {start}: {}", cells.join(", ")));
        }
    }
    format!("{}, {unit}: {}", heading(part), list.join("; "))
}
