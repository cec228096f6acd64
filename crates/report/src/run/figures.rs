//! The sections that are mostly figures: energy, losses, warm-up, driveline, engine.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, capital, phase as phase_name};
use super::super::results::RunResults;
use super::{Car, cars, energy};
use crate::charts::figures::{
    CarLosses, GuideLine, LossTrace, PhaseLosses, Variogram, loss_by_component, loss_by_phase,
    loss_by_temperature, variogram,
};
use crate::charts::{
    PlotRun, driveline, fuel_bars, group_fuel, losses, operating_points, pressure, price_bars,
    temperatures,
};
use cvtcycle_config::cycle::phase_group;
use cvtcycle_model::drive::FuelMap;
use cvtcycle_model::keys::RPM;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::record::FuelMapRecord;
use cvtcycle_output::table::distinct;
use cvtcycle_output::trace::loss_column;

/// g/kWh to kg/J.
const G_KWH: f64 = 1.0 / 3.6e9;

/// A recorded map in SI units.
fn fuel_map(record: &FuelMapRecord) -> FuelMap {
    let si = |b: &Option<f64>| b.map_or(f64::NAN, |b| b * G_KWH);
    let rows = record.bsfc_g_kwh.iter();
    FuelMap {
        speed_rad_s: record.speed_rpm.iter().map(|n| n * RPM).collect(),
        torque_nm: record.torque_nm.clone(),
        bsfc_kg_j: rows.map(|row| row.iter().map(si).collect()).collect(),
        full_load_nm: record.full_load_nm.clone(),
    }
}

pub(super) fn sections(found: &RunResults, all: &[Car]) -> Vec<Section> {
    let plots: Vec<PlotRun> = cars(found).iter().filter_map(plot).collect();
    let mut energy = energy::section(all);
    if plots.len() == all.len() {
        energy.figure(
            "fuel_comparison",
            "Fuel by phase and car.",
            fuel_bars(&plots),
        );
    }
    vec![
        energy,
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

fn losses_section(all: &[Car]) -> Section {
    let mut section = Section::new("losses", "Losses by component");
    section.table(loss_table(all));
    let cars = all.iter().map(|car| CarLosses {
        name: car.run.vehicle.clone(),
        losses_kj: car.losses_kj(),
    });
    let picture = loss_by_component(&cars.collect::<Vec<_>>());
    let caption = "Losses of each transmission over the whole cycle.";
    section.figure("loss_by_component", caption, picture);
    for car in all.iter().filter(|car| car.run.price.is_some()) {
        let name = &car.run.vehicle;
        let caption = format!(
            "What each loss of {name} costs: the car driven again without it. The prices need not add up to that of all together."
        );
        section.figure(format!("price_{name}"), caption, price_bars(car.run, name));
    }
    let traced: Vec<&Car> = all.iter().filter(|car| car.history.is_some()).collect();
    if !traced.is_empty() && all[0].run.phases.len() > 1 {
        let picture = loss_by_phase(&phase_losses(all, &traced));
        let caption = "Losses by phase of the cycle, for each kilometre driven in it.";
        section.figure("loss_by_phase", caption, picture);
    }
    for car in traced {
        let (Some(run), Some(history), name) = (plot(car), car.history, &car.run.vehicle) else {
            continue;
        };
        section.heading(&car.run.title);
        let about =
            format!("Loss power of {name} over time, averaged over stretches of the cycle.");
        section.figure(format!("losses_{name}"), about, losses(&run));
        let caption = format!(
            "Mean loss power of {name} while it moved, against the temperature of its oil. Oil and phase of the cycle change together, so \
             this is no clean sweep of temperature; the command cvtcycle losses draws one."
        );
        let picture = loss_by_temperature(&loss_trace(car, history));
        section.figure(format!("loss_by_temperature_{name}"), caption, picture);
    }
    section
}

fn loss_table(all: &[Car]) -> ReportTable {
    let caption = "Losses over the whole cycle";
    let mut table = energy::with_shares(caption, "Component", "of its transmission", all);
    let total = |car: &Car| car.run.transmission_loss_kj();
    for component in Component::ALL {
        let of = |car: &Car| car.run.loss_kj.get(component.name());
        if all.iter().any(|car| of(car).is_some()) {
            let cells = energy::cells_with_shares(all, |car| Some((Some(of(car)?), total(car))));
            table.named(capital(component.name()), cells);
        }
    }
    let sums = energy::cells_with_shares(all, |car| Some((Some(total(car)), total(car))));
    table.strong("Transmission", sums);
    table
}

/// Loss of each component in a phase group, kJ, and its distance, km.
fn group_losses(history: &History, group: &str) -> Vec<(Component, f64)> {
    let in_group = |i: &usize| {
        let phase = history.phases().get(history.phase(*i));
        phase.is_some_and(|phase| phase_group(phase) == group)
    };
    let own: Vec<usize> = (0..history.len()).filter(in_group).collect();
    let sum = |component: &Component| {
        let (watts, dt) = (loss_w(history, component), history.dt_s());
        let joule = own
            .iter()
            .filter_map(|i| Some(watts.get(*i)? * dt.get(*i)?));
        let joule: f64 = joule.filter(|joule| joule.is_finite()).sum();
        (*component, joule / 1e3)
    };
    history.components().iter().map(sum).collect()
}

/// The loss power of a component over time, W.
fn loss_w<'a>(history: &'a History, component: &Component) -> &'a [f64] {
    loss_column(*component).map_or(&[], |column| history.column(&column.name))
}

fn phase_losses(all: &[Car], traced: &[&Car]) -> PhaseLosses {
    let groups = all[0].run.phases.iter().enumerate().map(|(k, phase)| {
        let of = |car: &&Car| {
            let phases = &car.run.phases;
            let km = phases.get(k).map_or(f64::NAN, |phase| phase.distance_km);
            let losses = car
                .history
                .map(|history| group_losses(history, &phase.name));
            let losses = losses.unwrap_or_default().into_iter();
            let losses = losses.map(|(component, kj)| (component, kj / km));
            losses.filter(|(_, x)| x.is_finite()).collect()
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
    let losses = history.components().into_iter();
    let losses = losses.map(|c| (c, loss_w(history, &c)));
    LossTrace {
        subject: car.run.vehicle.clone(),
        seconds: history.dt_s(),
        sump_degc: history.column("transmission_sump_degc"),
        speed_kmh: history.column("speed_kmh"),
        losses_w: losses.collect(),
    }
}

fn warm_up(all: &[Car]) -> Section {
    let mut section = Section::new("warm_up", "Warm-up");
    let columns = all
        .iter()
        .map(|car| (car.run.vehicle.clone(), Quantity::Degc.unit()));
    let mut table = ReportTable::of_numbers("Temperatures at the end", "Node", columns);
    let nodes = all.iter().flat_map(|car| car.run.end_degc.iter());
    for node in distinct(nodes.map(|(name, _)| name)) {
        let ends = all.iter().map(|car| car.run.end_degc.get(node));
        table.named(capital(node), ends.map(|degc| Quantity::Degc.bare(degc)));
    }
    section.table(table);
    for run in all.iter().filter_map(plot) {
        let name = run.name;
        let caption = format!("Temperatures of {name} over the cycle.");
        section.figure(format!("temperatures_{name}"), caption, temperatures(&run));
    }
    section
}

fn drive(all: &[Car]) -> Section {
    let mut section = Section::new("driveline", "Ratio, engine speed, pressure and slip");
    for car in all {
        let Some(run) = plot(car) else { continue };
        let name = run.name;
        section.heading(&car.run.title);
        let caption = format!("Speed, ratio, engine speed and throttle of {name}.");
        section.figure(format!("driveline_{name}"), caption, driveline(&run));
        if run.history.is_cvt() {
            let caption = format!(
                "Pulley pressures, belt slip and clamping safety of {name}; safety is drawn up to four times its least value, for at low torque it has no end."
            );
            section.figure(format!("pressure_{name}"), caption, pressure(&run));
        }
        let lines = car.record.map(|record| record.speed_lines.clone());
        let lines = lines.into_iter().flatten().map(|line| GuideLine {
            whole: line.name.starts_with("target"),
            name: line.name,
            points: line.points,
        });
        let picture = variogram(&Variogram {
            subject: name.to_owned(),
            speed_kmh: run.history.column("speed_kmh"),
            engine_rpm: run.history.column("engine_speed_rpm"),
            seconds: run.history.dt_s(),
            lines: lines.collect(),
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
        let picture = operating_points(&run);
        section.figure(format!("operating_points_{name}"), caption, picture);
    }
    section
}
