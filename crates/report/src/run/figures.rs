//! The sections that are mostly figures: energy, losses, warm-up, driveline, engine.

use super::super::document::{ReportTable, Section};
use super::super::number::{Quantity, capital, phase as phase_name};
use super::super::results::RunResults;
use super::answer::brief;
use super::{Car, cars, conditions_line, cycle_title, energy};
use crate::charts::decision::{Repeat, repeats, waterfall};
use crate::charts::figures::{
    CarLosses, GuideLine, PhaseLosses, Variogram, loss_by_component, loss_by_phase, variogram,
};
use crate::charts::{
    PlotRun, driveline, fuel_bars, group_fuel, losses, operating_points, pressure, price_bars,
    temperatures,
};
use cvtcycle_config::cycle::phase_group;
use cvtcycle_model::drive::FuelMap;
use cvtcycle_model::keys::RPM;
use cvtcycle_model::transmission::component::LossGroup;
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
    let details = [energy, warm_up(all), drive(all), engine(all)];
    let folded = details.map(|mut section| {
        section.more = std::mem::take(&mut section.blocks);
        section
    });
    std::iter::once(losses_section(found, all))
        .chain(folded)
        .collect()
}

fn plot<'a>(car: &Car<'a>) -> Option<PlotRun<'a>> {
    let history = car.history?;
    let fuel_map = car.record.map(|record| fuel_map(&record.fuel_map));
    Some(PlotRun {
        name: car.run.label(),
        history,
        fuel_map,
        group_fuel: group_fuel(car.run),
    })
}

/// What the losses cost and where they come from; by phase and over time in the full report.
fn losses_section(found: &RunResults, all: &[Car]) -> Section {
    let mut section = Section::new("losses", "Losses: what they cost, and where they are");
    let cycle = cycle_title(&found.summary, found.record.as_ref());
    let conditions = format!("{}, {}", brief(&cycle), conditions_line(&found.summary));
    if let [subject, baseline, ..] = all {
        let of = energy::per_km(subject, baseline);
        let [own, other] = &of.names;
        let caption = format!(
            "Energy over distance from the fuel of {other} to that of {own}; the terms add up."
        );
        section.figure("waterfall", caption, waterfall(&of, &conditions));
    }
    let cars = all.iter().map(|car| CarLosses {
        name: car.run.label().to_owned(),
        losses_kj: car.losses_kj(),
    });
    let picture = loss_by_component(&cars.collect::<Vec<_>>());
    let caption = "Losses of each transmission over the whole cycle.";
    section.figure("loss_by_component", caption, picture);
    if let Some((subject, drives, part)) = all.first().and_then(natural_experiment) {
        let caption = format!(
            "{part} driven {} times by {subject} while the oil warms: nothing but the temperature changes.",
            drives.len()
        );
        let of = format!("{subject}, {part} of {conditions}");
        section.figure("repeats", caption, repeats(&of, &drives));
    }
    let mut more = Section::default();
    for (k, car) in all.iter().filter(|car| car.run.price.is_some()).enumerate() {
        let (file, name) = (&car.run.vehicle, car.run.label());
        let caption = format!(
            "What each loss of {name} costs: the car driven again without it. The prices need not add up to that of all together."
        );
        let of = if k == 0 { &mut section } else { &mut more };
        of.figure(format!("price_{file}"), caption, price_bars(car.run, name));
    }
    section.table(loss_table(all));
    let traced: Vec<&Car> = all.iter().filter(|car| car.history.is_some()).collect();
    if !traced.is_empty() && all[0].run.phases.len() > 1 {
        let picture = loss_by_phase(&phase_losses(all, &traced));
        let caption = "Losses by phase of the cycle, for each kilometre driven in it.";
        more.figure("loss_by_phase", caption, picture);
    }
    for car in traced {
        let Some(run) = plot(car) else { continue };
        more.heading(&car.run.title);
        let name = car.run.label();
        let about =
            format!("Loss power of {name} over time, averaged over stretches of the cycle.");
        more.figure(format!("losses_{}", car.run.vehicle), about, losses(&run));
    }
    section.more = more.blocks;
    section
}

/// A part of the cycle that a car drives again and again with the same speeds: its name, and what each drive loses.
fn natural_experiment<'a>(car: &Car<'a>) -> Option<(&'a str, Vec<Repeat>, String)> {
    let history = car.history?;
    let rows = |phase: usize| (0..history.len()).filter(move |i| history.phase(*i) == phase);
    let speeds = history.column("speed_kmh");
    let trace = |phase: usize| {
        rows(phase)
            .filter_map(|i| speeds.get(i))
            .collect::<Vec<_>>()
    };
    let names = history.phases();
    let first = (0..names.len()).find(|k| {
        let same = |other: &usize| other != k && trace(*other) == trace(*k);
        (0..names.len()).any(|other| same(&other))
    })?;
    let same: Vec<usize> = (first..names.len())
        .filter(|k| trace(*k) == trace(first))
        .collect();
    let oil = history.column("transmission_sump_degc");
    let components = history.components();
    let groups = distinct(components.iter().map(|c| c.group()));
    let drive = |phase: &usize| {
        let own: Vec<usize> = rows(*phase).collect();
        let (begin, end) = (own.first()?, own.last()?);
        let loss = |group: &LossGroup| {
            let of = components.iter().filter(|c| c.group() == *group);
            let at = |c, i: &usize| Some(loss_w(history, c).get(*i)? * history.dt_s().get(*i)?);
            let joule = of.flat_map(|c| own.iter().filter_map(move |i| at(c, i)));
            (*group, joule.filter(|x| x.is_finite()).sum::<f64>() / 1e3)
        };
        Some(Repeat {
            oil_degc: [*oil.get(begin.saturating_sub(1))?, *oil.get(*end)?],
            losses_kj: groups.iter().map(loss).collect(),
        })
    };
    let drives: Vec<Repeat> = same.iter().filter_map(drive).collect();
    let part = phase_name(&phase_group(&names[first]));
    (drives.len() > 1).then(|| (car.run.label(), drives, part))
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
        cars: traced
            .iter()
            .map(|car| car.run.label().to_owned())
            .collect(),
        groups: groups.collect(),
    }
}

fn warm_up(all: &[Car]) -> Section {
    let mut section = Section::new("warm_up", "Warm-up");
    let columns = all
        .iter()
        .map(|car| (car.run.label().to_owned(), Quantity::Degc.unit()));
    let mut table = ReportTable::of_numbers("Temperatures at the end", "Node", columns);
    let nodes = all.iter().flat_map(|car| car.run.end_degc.iter());
    for node in distinct(nodes.map(|(name, _)| name)) {
        let ends = all.iter().map(|car| car.run.end_degc.get(node));
        table.named(capital(node), ends.map(|degc| Quantity::Degc.bare(degc)));
    }
    section.table(table);
    for car in all {
        let Some(run) = plot(car) else { continue };
        let name = run.name;
        let caption = format!("Temperatures of {name} over the cycle.");
        section.figure(
            format!("temperatures_{}", car.run.vehicle),
            caption,
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
        section.heading(&car.run.title);
        let caption = format!("Speed, ratio, engine speed and throttle of {name}.");
        section.figure(
            format!("driveline_{}", car.run.vehicle),
            caption,
            driveline(&run),
        );
        if run.history.is_cvt() {
            let caption = format!(
                "Pulley pressures, belt slip and clamping safety of {name}; the axis of safety is clipped at four times its minimum; it is unbounded at low torque."
            );
            section.figure(
                format!("pressure_{}", car.run.vehicle),
                caption,
                pressure(&run),
            );
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
        section.figure(format!("variogram_{}", car.run.vehicle), caption, picture);
    }
    section
}

fn engine(all: &[Car]) -> Section {
    let mut section = Section::new("engine", "Engine operating points");
    for car in all {
        let Some(run) = plot(car) else { continue };
        let name = run.name;
        let caption = format!(
            "Time that the engine of {name} spent at each speed and torque, on its fuel map when hot."
        );
        let picture = operating_points(&run);
        section.figure(
            format!("operating_points_{}", car.run.vehicle),
            caption,
            picture,
        );
    }
    section
}
