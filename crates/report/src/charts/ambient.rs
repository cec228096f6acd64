//! Pictures of a matrix of ambient temperatures: fuel, the subject's excess, warm-up side by side.

use super::engine::cell;
use super::lines::{LineChart, LinePanel, Look, Palette, Points, line_chart};
use super::picture::Picture;
use crate::number::{degc, grouped, signed};
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

/// Series of one panel: one look for each car, solid for the first start and dotted for the second.
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
    select: fn(&FuelPart) -> &[Vec<Vec<f64>>],
) -> LineChart {
    let panel = |part: &FuelPart| LinePanel {
        heading: heading(&part.name),
        y_title,
        series: series(matrix, select(part), first_look),
        ..LinePanel::default()
    };
    LineChart {
        x_title: AMBIENT,
        palette: Palette::Cars,
        panels: matrix.fuel.iter().map(panel).collect(),
        marked: true,
        ..LineChart::default()
    }
}

/// Fuel against ambient temperature: whole cycle and phases.
pub fn ambient_fuel(matrix: &Matrix, title: &str) -> Picture {
    line_chart(&LineChart {
        title: fuel_title(matrix),
        subject: format!("{title}; each panel has its own scale"),
        legend: "Car, start".into(),
        names: names(matrix, &matrix.cars, 0),
        ..by_part(matrix, "Fuel [L/100 km]", 0, |part| &part.l_per_100km)
    })
}

/// Range of a difference by measured cars, per cent, by the place of a baseline among the cars, ambient temperature and computed difference.
pub type RangeOf<'r> = &'r dyn Fn(usize, f64, f64) -> Option<[f64; 2]>;

/// Excess of the subject against ambient temperature, with its range from the first start; `None` without baselines.
pub fn ambient_penalty(matrix: &Matrix, title: &str, range_of: RangeOf) -> Option<Picture> {
    let (subject, baselines) = matrix.cars.split_first()?;
    let over: Vec<String> = baselines
        .iter()
        .map(|name| format!("over {name}"))
        .collect();
    let first = matrix
        .fuel
        .first()
        .map_or(&[][..], |part| &part.excess_percent);
    let bands = first.iter().enumerate().map(|(k, by_start)| {
        let numbers = by_start.first().map_or(&[][..], Vec::as_slice);
        let range = |(degc, percent): &(f64, f64)| {
            let [low, high] = range_of(k + 1, *degc, *percent)?;
            Some((*degc, low, high))
        };
        let own = points(&matrix.ambient_degc, numbers);
        own.iter().filter_map(range).collect::<Vec<_>>()
    });
    let bands: Vec<Vec<(f64, f64, f64)>> = bands.collect();
    let is_open = bands
        .first()
        .is_some_and(|band| band.iter().any(|(_, low, high)| low * high < 0.0));
    let mut chart = LineChart {
        title: penalty_title(matrix, subject, is_open),
        subject: title.to_owned(),
        same_y: true,
        legend: "Baseline, start".into(),
        names: names(matrix, &over, 1),
        ..by_part(matrix, "Excess fuel [%]", 1, |part| &part.excess_percent)
    };
    // The phases repeat the same.
    chart.panels.truncate(1);
    for panel in &mut chart.panels {
        panel.with_y = vec![0.0];
        let looks = (0..).map(|k| look(matrix, k + 1, 0));
        panel.bands = looks
            .zip(bands.iter().cloned())
            .filter(|(_, band)| !band.is_empty())
            .collect();
    }
    if let (Some(start), true) = (
        matrix.starts.first(),
        bands.iter().any(|band| !band.is_empty()),
    ) {
        chart.notes = vec![format!(
            "Bands: 90 % range by the error of the model on measured cars, start {start}."
        )];
    }
    if baselines.is_empty() {
        return None;
    }
    let mut picture = line_chart(&chart);
    for (name, band) in over.iter().zip(&bands).filter(|(_, band)| !band.is_empty()) {
        for (end, of) in [("from", 0), ("to", 1)] {
            picture
                .table
                .columns
                .push((format!("{name}, 90 % {end}"), "%"));
            for row in &mut picture.table.rows {
                let own = band
                    .iter()
                    .find(|(degc, ..)| row[0] == cell(*degc, 1.0) || row[0] == cell(*degc, 0.1));
                let own = own.map_or(f64::NAN, |(_, low, high)| [*low, *high][of]);
                row.push(cell(own, 0.1));
            }
        }
    }
    Some(picture)
}

/// Numbers at the lowest and the highest ambient temperature that has one, in that order.
fn ends(matrix: &Matrix, numbers: &[f64]) -> Option<[(f64, f64); 2]> {
    let points = points(&matrix.ambient_degc, numbers);
    let (first, last) = (points.first()?, points.last()?);
    (points.len() > 1).then_some([*first, *last])
}

/// Title: the subject's extra fuel in the cold, from the first start.
fn fuel_title(matrix: &Matrix) -> String {
    let whole = matrix
        .fuel
        .first()
        .and_then(|part| part.l_per_100km.first()?.first());
    let ends = whole.and_then(|numbers| ends(matrix, numbers));
    let Some(([cold, warm], car, start)) = ends
        .zip(matrix.cars.first())
        .zip(matrix.starts.first())
        .map(|((a, b), c)| (a, b, c))
    else {
        return "Fuel against ambient temperature".into();
    };
    format!(
        "{car} uses {} L/100 km at {} and {} at {} ({start})",
        grouped(cold.1, 2),
        degc(cold.0),
        grouped(warm.1, 2),
        degc(warm.0)
    )
}

/// Title: dependence of the difference to the first baseline on the ambient temperature; `is_open` where the range of measured cars holds both signs.
fn penalty_title(matrix: &Matrix, subject: &str, is_open: bool) -> String {
    let part = matrix.fuel.first();
    let percent = part.and_then(|part| part.excess_percent.first()?.first());
    let numbers = percent
        .map_or(&[][..], Vec::as_slice)
        .iter()
        .copied()
        .filter(|x| x.is_finite());
    let low = numbers.clone().fold(f64::INFINITY, f64::min);
    let high = numbers.fold(f64::NEG_INFINITY, f64::max);
    let named = matrix.cars.get(1).zip(matrix.starts.first());
    let open = match is_open {
        true => ", less than the error of the model",
        false => "",
    };
    match named {
        Some((baseline, start)) if low <= high && low > 0.0 => format!(
            "{subject} uses {} to {} % more than {baseline} at every temperature ({start}){open}",
            grouped(low, 1),
            grouped(high, 1)
        ),
        Some((baseline, start)) if low <= high => format!(
            "{subject} uses {} to {} % against {baseline} over the temperatures ({start})",
            signed(grouped(low, 1), low),
            signed(grouped(high, 1), high)
        ),
        _ => format!("Fuel of {subject} over that of its baselines"),
    }
}

/// Warm-up of the transmissions from one start: a panel for each car, all on one scale; a line for each ambient temperature.
pub fn warm_up(matrix: &Matrix, runs: &[WarmUp], start: usize, title: &str) -> Picture {
    let own = |car: usize| {
        runs.iter()
            .filter(move |run| run.car == car && run.start == start)
    };
    let panel = |(car, name): (usize, &String)| LinePanel {
        heading: name.clone(),
        y_title: "Transmission sump [\u{b0}C]",
        series: own(car).map(|run| warm_up_line(matrix, run)).collect(),
        ..LinePanel::default()
    };
    let mut order: Vec<f64> = matrix.ambient_degc.clone();
    order.sort_by(f64::total_cmp);
    let names = order.iter().enumerate();
    let names = names.map(|(index, ambient)| (Look::solid(index), degc(*ambient)));
    let word = matrix.starts.get(start).map_or("", String::as_str);
    let end = |ambient: f64| {
        let mut runs_there =
            own(0).filter(|run| matrix.ambient_degc.get(run.ambient) == Some(&ambient));
        runs_there
            .next()?
            .sump_degc
            .iter()
            .copied()
            .rfind(|x| x.is_finite())
    };
    let ends = order.first().zip(order.last());
    let ends_of_first =
        ends.and_then(|(a, b)| Some((*a, end(*a)?, *b, end(*b)?, matrix.cars.first()?)));
    let said = ends_of_first.map_or_else(
        || format!("Warm-up, start {word}"),
        |(cold, low, warm, high, car)| {
            format!(
                "The sump of {car} ends at {} after {} and at {} after {} ({word})",
                degc(low.round()),
                degc(cold),
                degc(high.round()),
                degc(warm)
            )
        },
    );
    line_chart(&LineChart {
        title: said,
        subject: title.to_owned(),
        x_title: "Time [s]",
        panels: matrix.cars.iter().enumerate().map(panel).collect(),
        same_y: true,
        tight: true,
        palette: Palette::Ordered,
        legend: "Ambient temperature".into(),
        names: names.collect(),
        ..LineChart::default()
    })
}

/// Line of a run, with the look of its ambient temperature among all.
fn warm_up_line(matrix: &Matrix, run: &WarmUp) -> (Look, Points) {
    let own = matrix
        .ambient_degc
        .get(run.ambient)
        .copied()
        .unwrap_or(f64::NAN);
    let colder = matrix
        .ambient_degc
        .iter()
        .filter(|other| **other < own)
        .count();
    let points = run
        .time_s
        .iter()
        .copied()
        .zip(run.sump_degc.iter().copied());
    (Look::solid(colder), points.collect())
}

fn heading(part: &str) -> String {
    if part == "total" {
        "Whole cycle".to_owned()
    } else {
        part.to_uppercase()
    }
}
