//! The sections that are mostly figures: energy, losses, warm-up, driveline, engine.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, capital, percent, phase as phase_name};
use super::super::results::RunResults;
use super::{Car, cars, energy};
use crate::charts::figures::{
    CarLosses, GuideLine, LossTrace, PhaseLosses, Variogram, loss_by_component, loss_by_phase,
    loss_by_temperature, variogram,
};
use crate::charts::{
    PlotRun, driveline, fuel_bars, losses, operating_points, pressure, temperatures,
};
use cvtcycle_config::cycle::phase_group;
use cvtcycle_model::drive::FuelMap;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::record::FuelMapRecord;
use cvtcycle_output::summary::RunSummary;
use cvtcycle_output::trace::loss_column;

/// rpm to rad/s.
const RPM: f64 = std::f64::consts::PI / 30.0;
/// g/kWh to kg/J.
const G_KWH: f64 = 1.0 / 3.6e9;

/// A recorded map in SI units.
#[must_use]
pub fn fuel_map(record: &FuelMapRecord) -> FuelMap {
    FuelMap {
        speed_rad_s: record.speed_rpm.iter().map(|n| n * RPM).collect(),
        torque_nm: record.torque_nm.clone(),
        bsfc_kg_j: record
            .bsfc_g_kwh
            .iter()
            .map(|row| {
                row.iter()
                    .map(|b| b.map_or(f64::NAN, |b| b * G_KWH))
                    .collect()
            })
            .collect(),
        full_load_nm: record.full_load_nm.clone(),
    }
}

pub(super) fn sections(found: &RunResults, all: &[Car]) -> Vec<Section> {
    let plots: Vec<PlotRun> = cars(found).iter().filter_map(plot).collect();
    let mut answer_energy = energy::section(all);
    if plots.len() == all.len() {
        answer_energy.figure(
            "fuel_comparison",
            "Fuel by phase and car.",
            fuel_bars(&plots),
        );
    }
    vec![
        answer_energy,
        losses_section(all),
        warm_up(all),
        drive(all),
        engine(all),
    ]
}

fn plot<'a>(car: &Car<'a>) -> Option<PlotRun<'a>> {
    let history = car.history?;
    let fuel_map = car.record.map(|record| fuel_map(&record.fuel_map));
    Some(PlotRun {
        name: &car.run.vehicle,
        history,
        fuel_map,
        group_fuel: group_fuel(car.run),
    })
}

/// Fuel of each phase group and of the whole, for the bars.
fn group_fuel(run: &RunSummary) -> Vec<(String, f64)> {
    let number = |x: Option<f64>| x.unwrap_or(f64::NAN);
    let phases = run.phases.iter().filter(|_| run.phases.len() > 1);
    let mut groups: Vec<(String, f64)> = phases
        .map(|p| (p.name.clone(), number(p.fuel_l_per_100km)))
        .collect();
    groups.push(("total".to_owned(), number(run.fuel_l_per_100km)));
    groups.extend(
        run.weighted_fuel_l_per_100km
            .map(|fuel| ("weighted".to_owned(), fuel)),
    );
    groups
}

fn losses_section(all: &[Car]) -> Section {
    let mut section = Section::new("losses", "Losses by component");
    section.table(loss_table(all));
    let cars: Vec<CarLosses> = all
        .iter()
        .map(|car| CarLosses {
            name: car.run.vehicle.clone(),
            losses_kj: car.losses_kj(),
        })
        .collect();
    section.figure(
        "loss_by_component",
        "Losses of each transmission over the whole cycle.",
        loss_by_component(&cars),
    );
    let traced: Vec<&Car> = all.iter().filter(|car| car.history.is_some()).collect();
    if !traced.is_empty() && all[0].run.phases.len() > 1 {
        let picture = loss_by_phase(&phase_losses(all, &traced));
        section.figure(
            "loss_by_phase",
            "Losses by phase of the cycle, for each kilometre driven in it.",
            picture,
        );
    }
    for car in traced {
        let (Some(run), Some(history), name) = (plot(car), car.history, &car.run.vehicle) else {
            continue;
        };
        section.heading(car.run.title.clone());
        section.figure(
            format!("losses_{name}"),
            format!("Loss power of {name} over time, averaged over stretches of the cycle."),
            losses(&run),
        );
        let caption = format!(
            "Mean loss power of {name} while it moved, against the temperature of its oil. Oil and phase of the cycle change together, so \
             this is no clean sweep of temperature; the command cvtcycle losses draws one."
        );
        section.figure(
            format!("loss_by_temperature_{name}"),
            caption,
            loss_by_temperature(&loss_trace(car, history)),
        );
    }
    section
}

fn loss_table(all: &[Car]) -> ReportTable {
    let columns = all.iter().flat_map(|car| {
        [
            (car.run.vehicle.clone(), "kJ".to_owned()),
            ("of its transmission".to_owned(), "%".to_owned()),
        ]
    });
    let mut table = ReportTable::of_numbers("Losses over the whole cycle", "Component", columns);
    for component in Component::ALL {
        let of = |car: &Car| car.run.loss_kj.get(component.name());
        if all.iter().any(|car| of(car).is_some()) {
            let cells = all.iter().flat_map(|car| match of(car) {
                Some(kj) => [
                    Quantity::Energy.bare(kj),
                    percent(kj, car.run.transmission_loss_kj()),
                ],
                None => [String::new(), String::new()],
            });
            table.named(capital(component.name()), cells);
        }
    }
    let sums = all.iter().flat_map(|car| {
        [
            Quantity::Energy.bare(car.run.transmission_loss_kj()),
            percent(1.0, 1.0),
        ]
    });
    table.strong("Transmission".to_owned(), sums);
    table
}

/// Loss of each component in a phase group, kJ, and its distance, km.
fn group_losses(history: &History, group: &str) -> Vec<(Component, f64)> {
    let dt = history.dt_s();
    let in_group = |i: usize| {
        history
            .phases()
            .get(history.phase(i))
            .is_some_and(|phase| phase_group(phase) == group)
    };
    let own: Vec<usize> = (0..history.len()).filter(|i| in_group(*i)).collect();
    let sum = |component: &Component| {
        let column = loss_column(*component).map_or(&[][..], |column| history.column(&column.name));
        own.iter()
            .filter_map(|i| Some(column.get(*i)? * dt.get(*i)?))
            .filter(|joule| joule.is_finite())
            .sum::<f64>()
            / 1e3
    };
    history
        .components()
        .iter()
        .map(|component| (*component, sum(component)))
        .collect()
}

fn phase_losses(all: &[Car], traced: &[&Car]) -> PhaseLosses {
    let groups = all[0].run.phases.iter().enumerate().map(|(k, phase)| {
        let of = |car: &&Car| {
            let km = car
                .run
                .phases
                .get(k)
                .map_or(f64::NAN, |phase| phase.distance_km);
            let losses = car
                .history
                .map(|history| group_losses(history, &phase.name))
                .unwrap_or_default();
            losses
                .into_iter()
                .map(|(component, kj)| (component, kj / km))
                .filter(|(_, x)| x.is_finite())
                .collect()
        };
        (phase_name(&phase.name), traced.iter().map(of).collect())
    });
    PhaseLosses {
        subject: String::new(),
        cars: traced.iter().map(|car| car.run.vehicle.clone()).collect(),
        groups: groups.collect(),
    }
}

fn loss_trace<'a>(car: &Car, history: &'a History) -> LossTrace<'a> {
    let column = |component: &Component| {
        loss_column(*component).map_or(&[][..], |column| history.column(&column.name))
    };
    LossTrace {
        subject: car.run.vehicle.clone(),
        seconds: history.dt_s(),
        sump_degc: history.column("transmission_sump_degc"),
        speed_kmh: history.column("speed_kmh"),
        losses_w: history
            .components()
            .iter()
            .map(|component| (*component, column(component)))
            .collect(),
    }
}

fn warm_up(all: &[Car]) -> Section {
    let mut section = Section::new("warm_up", "Warm-up");
    let columns = all
        .iter()
        .map(|car| (car.run.vehicle.clone(), Quantity::Degc.unit().to_owned()));
    let mut table = ReportTable::of_numbers("Temperatures at the end", "Node", columns);
    let mut nodes: Vec<&str> = Vec::new();
    for (name, _) in all.iter().flat_map(|car| car.run.end_degc.iter()) {
        if !nodes.contains(&name) {
            nodes.push(name);
        }
    }
    for node in nodes {
        table.named(
            capital(node),
            all.iter()
                .map(|car| Quantity::Degc.bare(car.run.end_degc.get(node))),
        );
    }
    section.table(table);
    for run in all.iter().filter_map(plot) {
        let name = run.name;
        section.figure(
            format!("temperatures_{name}"),
            format!("Temperatures of {name} over the cycle."),
            temperatures(&run),
        );
    }
    section
}

fn drive(all: &[Car]) -> Section {
    let mut section = Section::new("driveline", "Ratio, engine speed, pressure and slip");
    for car in all {
        let Some(run) = plot(car) else { continue };
        let name = run.name;
        section.heading(car.run.title.clone());
        section.figure(
            format!("driveline_{name}"),
            format!("Speed, ratio, engine speed and throttle of {name}."),
            driveline(&run),
        );
        if run.history.is_cvt() {
            let caption = format!(
                "Pulley pressures, belt slip and clamping safety of {name}; safety is drawn up to four times its least value, for at low torque it has no end."
            );
            section.figure(format!("pressure_{name}"), caption, pressure(&run));
        }
        let lines = car
            .record
            .map(|record| record.speed_lines.clone())
            .unwrap_or_default();
        let picture = variogram(&Variogram {
            subject: name.to_owned(),
            speed_kmh: run.history.column("speed_kmh"),
            engine_rpm: run.history.column("engine_speed_rpm"),
            seconds: run.history.dt_s(),
            lines: lines
                .into_iter()
                .map(|line| GuideLine {
                    whole: line.name.starts_with("target"),
                    name: line.name,
                    points: line.points,
                })
                .collect(),
        });
        let caption = match run.history.is_cvt() {
            true => format!(
                "Where {name} ran between its lowest and highest ratio, and the targets of its ratio control."
            ),
            false => format!("Where {name} ran, and the lines of its gears."),
        };
        section.figure(format!("variogram_{name}"), caption, picture);
    }
    section
}

fn engine(all: &[Car]) -> Section {
    let mut section = Section::new("engine", "Engine operating points");
    for run in all.iter().filter_map(plot) {
        let name = run.name;
        let caption = format!(
            "Time that the engine of {name} spent at each speed and torque, on its fuel map when hot."
        );
        section.figure(
            format!("operating_points_{name}"),
            caption,
            operating_points(&run),
        );
    }
    section
}
