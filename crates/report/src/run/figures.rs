//! Sections that are mainly figures: energy, losses, warm-up, driveline, engine.

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
    Picture, PlotRun, driveline, fuel_bars, group_fuel, logged, losses, operating_points, pressure,
    price_dots, published_drive, temperatures,
};
use cvtcycle_config::cycle::phase_group;
use cvtcycle_model::drive::FuelMap;
use cvtcycle_model::keys::RPM;
use cvtcycle_model::transmission::component::LossGroup;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::record::FuelMapRecord;
use cvtcycle_output::summary::Summary;
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
    let runs = cars(found);
    let plots = runs.iter().filter_map(|car| plot(car, &found.summary));
    let plots: Vec<PlotRun> = plots.collect();
    let mut energy = energy::section(all, &conditions(found));
    if plots.len() == all.len() {
        energy.figure(
            "fuel_comparison",
            "Fuel by phase and car.",
            fuel_bars(&plots),
        );
    }
    let details = [
        energy,
        warm_up(all, &plots),
        drive(all, found),
        engine(&plots),
    ];
    let folded = details.map(|mut section| {
        section.more = std::mem::take(&mut section.blocks);
        section
    });
    log_section(found)
        .into_iter()
        .chain([losses_section(found, all)])
        .chain(folded)
        .collect()
}

/// Quantities of a log and of the subject; none of a drive without them.
fn log_section(found: &RunResults) -> Option<Section> {
    let summary = &found.summary;
    let (recording, car) = summary.recording.as_ref().zip(summary.runs.first())?;
    let picture = logged(recording, car.label(), &conditions(found))?;
    let mut section = Section::new("log", "The log next to the computed car");
    section.figure(
        "log",
        format!(
            "Quantities of the log and those computed of {}, means over stretches of the drive.",
            car.label()
        ),
        picture,
    );
    Some(section)
}

fn plot<'a>(car: &Car<'a>, summary: &Summary) -> Option<PlotRun<'a>> {
    let history = car.history?;
    let fuel_map = car.record.map(|record| fuel_map(&record.fuel_map));
    Some(PlotRun {
        name: car.run.label(),
        history,
        fuel_map,
        group_fuel: group_fuel(car.run),
        fuel_unit: car.run.over().unit(),
        fuel_energy_kj: car.run.fuel_energy_kj,
        published: published_drive(&car.run.vehicle, summary),
    })
}

/// Cycle, ambient temperature and start.
fn conditions(found: &RunResults) -> String {
    let cycle = cycle_title(&found.summary, found.record.as_ref());
    format!("{}, {}", brief(&cycle), conditions_line(&found.summary))
}

/// Price and origin of the losses; by phase and over time in the full report.
fn losses_section(found: &RunResults, all: &[Car]) -> Section {
    let mut section = Section::new("losses", "Losses: what they cost, and where they are");
    let conditions = conditions(found);
    section.views("waterfall", waterfalls(all, &conditions));
    let cars = all.iter().map(|car| CarLosses {
        name: car.run.label().to_owned(),
        losses_kj: car.losses_kj(),
        distance_km: car.run.distance_km,
    });
    let picture = loss_by_component(&cars.collect::<Vec<_>>(), &conditions);
    let caption = "Losses of each transmission over the whole cycle.";
    section.figure("loss_by_component", caption, picture);
    let repeated = all.iter().filter_map(|car| {
        let (name, drives, part) = natural_experiment(car)?;
        let caption = format!(
            "{part} driven {} times by {name} while the oil warms: nothing but the temperature changes.",
            drives.len()
        );
        let picture = repeats(&format!("{name}, {part} of {conditions}"), &drives);
        Some((name.to_owned(), file("repeats", all, car), caption, picture))
    });
    section.views("repeats", repeated);
    let priced = all.iter().filter(|car| car.run.price.is_some()).map(|car| {
        let name = car.run.label();
        let caption = format!(
            "What each loss of {name} costs: the car driven again without it. The prices need not add up to that of all together."
        );
        let picture = price_dots(car.run, name);
        (name.to_owned(), format!("price_{}", car.run.vehicle), caption, picture)
    });
    section.views("price", priced);
    let mut more = Section::default();
    section.table(loss_table(all));
    let traced: Vec<&Car> = all.iter().filter(|car| car.history.is_some()).collect();
    if !traced.is_empty() && all[0].run.phases.len() > 1 {
        let picture = loss_by_phase(&phase_losses(all, &traced));
        let caption = "Losses by phase of the cycle, for each kilometre driven in it.";
        more.figure("loss_by_phase", caption, picture);
    }
    let runs = traced.iter().filter_map(|car| plot(car, &found.summary));
    let runs: Vec<PlotRun> = runs.collect();
    if !runs.is_empty() {
        let caption = "Energy that each group of parts has lost since the start, as fuel of that energy; one scale. Without the loss more is saved, for the engine makes that energy from fuel.";
        more.figure("losses", caption, losses(&runs));
    }
    section.more = more.blocks;
    section
}

/// File name of a figure: the first car has no suffix.
fn file(name: &str, all: &[Car], car: &Car) -> String {
    match all
        .first()
        .is_some_and(|first| first.run.vehicle == car.run.vehicle)
    {
        true => name.to_owned(),
        false => format!("{name}_{}", car.run.vehicle),
    }
}

/// Waterfalls from the fuel of the first baseline to that of the subject, and from that of the subject to each baseline.
fn waterfalls(all: &[Car], conditions: &str) -> Vec<(String, String, String, Picture)> {
    let Some((subject, baselines)) = all.split_first() else {
        return Vec::new();
    };
    let first = baselines.first().map(|baseline| (subject, baseline));
    let others = baselines.iter().map(|baseline| (baseline, subject));
    let view = |(own, other): (&Car, &Car)| {
        let energies = energy::per_km(own, other);
        let [name, from] = &energies.names;
        let caption = format!(
            "Energy over distance from the fuel of {from} to that of {name}; the terms add up."
        );
        let picture = waterfall(&energies, conditions);
        (name.clone(), file("waterfall", all, own), caption, picture)
    };
    first.into_iter().chain(others).map(view).collect()
}

/// Part of the cycle that a car drives repeatedly with the same speeds: its name, and the losses of each drive.
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
            let parts = components.iter().filter(|c| c.group() == *group);
            let at = |c, i: &usize| Some(loss_w(history, c).get(*i)? * history.dt_s().get(*i)?);
            let joule = parts.flat_map(|c| own.iter().filter_map(move |i| at(c, i)));
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

/// Loss power of a component over time, W.
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

fn warm_up(all: &[Car], runs: &[PlotRun]) -> Section {
    let mut section = Section::new("warm_up", "Warm-up");
    let columns = all
        .iter()
        .map(|car| (car.run.label().to_owned(), Quantity::Degc.unit()));
    let mut table = ReportTable::numeric("Temperatures at the end", "Node", columns);
    let nodes = all.iter().flat_map(|car| car.run.end_degc.iter());
    for node in distinct(nodes.map(|(name, _)| name)) {
        let ends = all.iter().map(|car| car.run.end_degc.get(node));
        table.named(capital(node), ends.map(|degc| Quantity::Degc.bare(degc)));
    }
    section.table(table);
    if !runs.is_empty() {
        let caption = "Temperatures over the cycle, all cars on one scale.";
        section.figure("temperatures", caption, temperatures(runs));
    }
    section
}

fn drive(all: &[Car], found: &RunResults) -> Section {
    let summary = &found.summary;
    let mut section = Section::new("driveline", "Ratio, engine speed, pressure and slip");
    let runs = || {
        all.iter()
            .filter_map(|car| Some((car, plot(car, summary)?)))
    };
    let named = |kind: &str, car: &Car| format!("{kind}_{}", car.run.vehicle);
    let driven = runs().map(|(car, run)| {
        let caption = format!("Speed, ratio, engine speed and throttle of {}.", run.name);
        (
            run.name.to_owned(),
            named("driveline", car),
            caption,
            driveline(&run),
        )
    });
    section.views("driveline", driven);
    let pressed = runs()
        .filter(|(_, run)| run.history.is_cvt())
        .map(|(car, run)| {
            let caption = format!(
                "Pulley pressures, belt slip and used share of the clamping capacity of {}.",
                run.name
            );
            (
                run.name.to_owned(),
                named("pressure", car),
                caption,
                pressure(&run),
            )
        });
    section.views("pressure", pressed);
    let grams = runs().map(|(car, run)| {
        let name = run.name.to_owned();
        let lines = car.record.map(|record| record.speed_lines.clone());
        let lines = lines.into_iter().flatten().map(|line| GuideLine {
            whole: line.name.starts_with("target"),
            name: line.name,
            points: line.points,
        });
        let picture = variogram(&Variogram {
            subject: name.clone(),
            conditions: conditions(found),
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
        (name, named("variogram", car), caption, picture)
    });
    section.views("variogram", grams);
    section
}

fn engine(runs: &[PlotRun]) -> Section {
    let mut section = Section::new("engine", "Engine operating points");
    if !runs.is_empty() {
        let caption = "Fuel that each engine burnt at each speed and torque, on its fuel map when hot, with the line of least consumption for each power.";
        section.figure("operating_points", caption, operating_points(runs));
    }
    section
}
