//! A question answered: bounds, how far from them each controller is, the line and its proof.

use cvtcycle_config::Problems;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{Disk, Options, Setup, read};
use cvtcycle_model::cycle::{Step, Trace};
use cvtcycle_model::drive::{Car, Row, Start, State, drive_into, litres_per_100km, own_trace};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::keys::{rad_s, rpm};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::coupling::Coupling;
use cvtcycle_model::transmission::cvt::variator::Formulation;
use rayon::prelude::*;

use super::file::{LineFile, ReadFrom, again};
use super::limits::LimitName;
use super::line::{Line, LineFit, OUTSIDE, burnt, fit_line};
use super::question::{
    Answer, Elsewhere, LawBound, LawCar, LimitPrice, LineAnswer, LockFloor, NoAnswer, Question,
};
use super::{Bound, Clamp, Limits, Task, bound, cvt};

/// Gap between the driven path and the bound above which the bound is not tight. ASSUMED: half of what the dearest choice of a controller is worth.
pub const TIGHT: f64 = 5e-3;
/// Relative difference of two sums of the same drive. Derived: rounding of some thousand steps is below 1e-12; numbers written to a file are exact.
const PROVEN: f64 = 1e-9;
/// Relative difference by which a path misses a limit that it is held at. Derived: what a solve leaves.
const SAME: f64 = 1e-3;

/// Answers a question about a car that was read from somewhere.
///
/// # Errors
/// The limits cannot be held.
pub fn answer(of: &Question, from: &ReadFrom) -> Result<Answer, NoAnswer> {
    let ready = |law: &LawCar| law.setup.car(of.conditions.ambient_k);
    let mut cars: Vec<Car> = of.cars.iter().map(ready).collect();
    let first = cars.first().ok_or(NoAnswer::NoCvt)?;
    if cvt(first).is_some_and(|cvt| cvt.ranges.is_some()) {
        return Err(NoAnswer::TwoRanges);
    }
    let trace = own_trace(first, of.cycle.trace_for(true));
    let steps: Vec<Step> = trace.steps(of.conditions.max_dt_s).collect();
    let least_speeds: Vec<f64> = of.least_speeds_rpm.iter().map(|n| rad_s(*n)).collect();
    let at_idle = of.launch_at_idle.then(|| launched_at_idle(first)).flatten();
    cars.extend(at_idle);
    let tasks = of.tasks(&cars, (&trace, &steps), &least_speeds);
    let bounds: Result<Vec<Bound>, _> = tasks.par_iter().map(bound).collect();
    let bounds = bounds.map_err(NoAnswer::Infeasible)?;
    let (Some(task), Some(main)) = (tasks.first(), bounds.first()) else {
        return Err(NoAnswer::NoCvt);
    };
    let litres = |kg: f64| {
        let density = task.car.engine.fuel_density_kg_m3;
        litres_per_100km(kg, density, trace.distance_m())
    };
    let fit = of.line.then(|| fit_line(task, main));
    let laws = (0..).zip(tasks.iter().zip(&bounds));
    let laws = laws.map(|(k, (task, bound))| {
        let law = of.cars.get(k).map(|car| car.law);
        law_bound((law, fit.as_ref()), task, bound, &litres)
    });
    let mut laws: Vec<LawBound> = laws.collect();
    let idle = of.launched_at_idle(&cars, &mut laws);
    of.consistent(&mut laws);
    let mut failures: Vec<String> = laws.iter().filter_map(loose).collect();
    let line = fit.map(|fit| of.proven(fit, (task, main), &litres, from));
    let line = line.transpose().map_err(NoAnswer::Line)?;
    failures.extend(line.iter().filter(|line| !line.proven).map(|_| {
        "line not proven: its file, read and driven, gives another fuel than the line".to_owned()
    }));
    let speeds = main.least_speeds.iter();
    let prices = main.without.iter();
    let prices = prices.map(|(name, kg)| price(name.name(), kg / main.fuel_kg));
    let least = laws[0].least_l_per_100km;
    let launch = idle.map(|number| price("launch_law", laws[number].least_l_per_100km / least));
    Ok(Answer {
        least_speeds: speeds
            .map(|(w, kg)| (rpm(*w).round(), kg.map(litres)))
            .collect(),
        limits: prices.chain(launch).collect(),
        lock_floor: lock_floor(task, main),
        bounds: laws,
        line,
        failures,
        path: main.rows.clone(),
    })
}

/// Why a bound is none: nothing that drives may be below it, and the best path is to be near it.
fn loose(law: &LawBound) -> Option<String> {
    let (clamp, gap) = (&law.clamp, law.gap_percent);
    if gap < 0.0 {
        let below = -gap;
        return Some(format!(
            "no bound: with the clamp `{clamp}` the best path, driven, burns {below:.2} % less than it"
        ));
    }
    (gap > 100.0 * TIGHT).then(|| {
        format!(
            "bound not tight: with the clamp `{clamp}` the best path burns {gap:.2} % more than the bound"
        )
    })
}

/// The car with a clutch that carries any torque at idle speed (LC-7); none with a device that cannot.
fn launched_at_idle(car: &Car) -> Option<Car> {
    let mut car = car.clone();
    let Transmission::Cvt(cvt) = &mut car.transmission else {
        return None;
    };
    cvt.coupling = cvt.coupling.at_least_speed()?;
    Some(car)
}

/// Where the coupling's own limit is above the least engine speed.
fn lock_floor(task: &Task, bound: &Bound) -> Option<LockFloor> {
    let floors = bound.floor_rad_s.iter().zip(task.steps);
    let floors = floors.filter_map(|(floor, step)| Some(((*floor)?, step.dt_s)));
    let start = (f64::INFINITY, 0.0, 0.0);
    let least_rad_s = task.limits.least_rad_s;
    let (least, most, above_s) = floors.fold(start, |(least, most, above_s), (floor, dt_s)| {
        let above_s = if floor > least_rad_s {
            above_s + dt_s
        } else {
            above_s
        };
        (floor.min(least), floor.max(most), above_s)
    });
    (most > 0.0).then(|| LockFloor {
        least_rpm: rpm(least),
        most_rpm: rpm(most),
        above_s,
    })
}

/// The bound of a task as numbers, with the fuel of its car and of its car with the line; of a free clamp without a law.
fn law_bound(
    (law, fit): (Option<&str>, Option<&LineFit>),
    task: &Task,
    bound: &Bound,
    litres: &impl Fn(f64) -> f64,
) -> LawBound {
    let own = law.map(|_| burnt(task, &bound.chosen, task.car));
    let lined = law
        .and(fit)
        .map(|fit| burnt(task, &bound.chosen, &fit.line.on(task.car)));
    let grid = bound.coarser.iter();
    let rows = || bound.rows.iter().zip(&bound.chosen);
    let rows = || {
        rows()
            .filter(|(row, chosen)| **chosen && locked(row))
            .map(|(row, _)| row)
    };
    LawBound {
        clamp: law.unwrap_or("free").to_owned(),
        launch: "law",
        bound_l_per_100km: litres(bound.least_kg()),
        least_safety: rows()
            .map(|row| row.clamp_safety)
            .fold(f64::INFINITY, f64::min),
        most_slip_percent: rows().map(|row| 100.0 * row.slip.abs()).fold(0.0, f64::max),
        own_l_per_100km: own.as_ref().map(|own| litres(own.fuel_kg)),
        own_outside_s: own.map(|own| own.outside_s),
        line_l_per_100km: lined.as_ref().map(|lined| litres(lined.fuel_kg)),
        line_outside_s: lined.map(|lined| lined.outside_s),
        least_l_per_100km: litres(bound.fuel_kg),
        tolerance_l_per_100km: litres(bound.tolerance_kg),
        driven_l_per_100km: litres(bound.driven_kg),
        gap_percent: 100.0 * bound.gap(),
        grid: grid.map(|(n, kg)| (*n, litres(*kg))).collect(),
        temperatures: bound.temperatures.iter().map(|kg| litres(*kg)).collect(),
    }
}

/// True where the coupling of a car that rolls is locked.
fn locked(row: &Row) -> bool {
    let unlocked = Flags::CLUTCH_SLIPPING.0 | Flags::CLUTCH_OPEN.0 | Flags::LOCKUP_OPEN.0;
    !row.rests() && !row.flags.any(Flags(unlocked | Flags::ENGINE_OFF.0))
}

/// Computes the price of a limit from the fuel without it, a fraction of the fuel with it.
fn price(limit: &'static str, without: f64) -> LimitPrice {
    LimitPrice {
        limit,
        percent: 100.0 * (1.0 - without),
    }
}

impl Question<'_> {
    /// The tasks of all clamp laws, then that of a free clamp, then that of another launch.
    fn tasks<'a>(
        &self,
        cars: &'a [Car],
        (trace, steps): (&'a Trace, &'a [Step]),
        least_speeds_rad_s: &'a [f64],
    ) -> Vec<Task<'a>> {
        let ambient_k = self.conditions.ambient_k;
        let start = match self.conditions.start {
            Start::At(temp_k) => State::at(temp_k),
            Start::Soak | Start::Warm => State::at(ambient_k),
            Start::Nodes(nodes) => {
                let (heat, tyre_k) = nodes.at(ambient_k);
                State {
                    heat,
                    tyre_k,
                    ..State::at(ambient_k)
                }
            }
        };
        let task = |(number, car): (usize, &'a Car), clamp: Clamp| {
            let main = number == 0 && clamp == Clamp::Law;
            Some(Task {
                car,
                cvt: super::cvt(car)?,
                steps,
                trace,
                start,
                warm: self.conditions.start == Start::Warm,
                clamp,
                limits: self.limits(car),
                grid: self.grid,
                least_speeds_rad_s: if main { least_speeds_rad_s } else { &[] },
                prices: if main { &LimitName::ALL } else { &[] },
            })
        };
        let (laws, launch) = cars.split_at(self.cars.len());
        let laws = laws.iter().enumerate();
        let laws = laws.filter_map(|car| task(car, Clamp::Law));
        let launch = launch.iter().map(|car| (self.cars.len(), car));
        let launch = launch.filter_map(|car| task(car, Clamp::Law));
        let free = self.free.iter().filter_map(|(safety, slip)| {
            let (safety, slip) = (*safety, *slip);
            task((0, cars.first()?), Clamp::Free { safety, slip })
        });
        laws.chain(free).chain(launch).collect()
    }

    /// Names the bound of a car that is launched at idle speed, if there is one: its number.
    fn launched_at_idle(&self, cars: &[Car], laws: &mut [LawBound]) -> Option<usize> {
        let last = laws.len().checked_sub(1)?;
        if cars.len() == self.cars.len() {
            return None;
        }
        laws[last].clamp = laws[0].clamp.clone();
        laws[last].launch = "idle";
        Some(last)
    }

    /// A free clamp can do what each law does that keeps its limits: its bound is no higher than that of such a law.
    fn consistent(&self, laws: &mut [LawBound]) {
        let Some((safety, slip)) = self.free else {
            return;
        };
        let keeps = |law: &&LawBound| {
            law.launch == "law"
                && law.least_safety >= safety * (1.0 - SAME)
                && law.most_slip_percent <= 100.0 * slip * (1.0 + SAME)
        };
        let kept = laws.iter().filter(keeps).map(|law| law.bound_l_per_100km);
        let least = kept.fold(f64::INFINITY, f64::min);
        if let Some(free) = laws.iter_mut().find(|law| law.clamp == "free") {
            free.bound_l_per_100km = free.bound_l_per_100km.min(least);
        }
    }

    /// The line with the proof that its file is it.
    fn proven(
        &self,
        fit: LineFit,
        (task, main): (&Task, &Bound),
        litres: &impl Fn(f64) -> f64,
        from: &ReadFrom,
    ) -> Result<LineAnswer, Problems> {
        let (file, here, options) = self.file(&fit.line, from);
        let setup = read("line.toml", &here, Box::new(Disk::default()), &options)?;
        let car = setup.car(self.conditions.ambient_k);
        let proven_kg = burnt(task, &main.chosen, &car).fuel_kg;
        let above = |kg: f64| 100.0 * (proven_kg / kg - 1.0);
        Ok(LineAnswer {
            l_per_100km: litres(proven_kg),
            above_least_percent: above(main.fuel_kg),
            above_bound_percent: above(main.least_kg()),
            proven: (proven_kg / fit.fuel_kg - 1.0).abs() <= PROVEN,
            slowest_rpm: rpm(fit.slowest_rad_s),
            drives: fit.drives,
            elsewhere: self
                .elsewhere
                .iter()
                .map(|cycle| self.on(cycle, &setup))
                .collect(),
            drive: fit.line.drive,
            overrun: fit.line.overrun,
            again: again_in_words(&options),
            file,
        })
    }

    fn limits(&self, car: &Car) -> Limits {
        let own = super::cvt(car).map(|cvt| (cvt.ratio.up_per_s, cvt.ratio.down_per_s));
        let (up_per_s, down_per_s) = self.rates_per_s.or(own).unwrap_or((0.0, 0.0));
        Limits {
            least_rad_s: rad_s(self.least_rpm),
            reserve: self.reserve,
            up_per_s,
            down_per_s,
        }
    }

    /// A vehicle file that is like the car but for its line: as it is written, as it is read here, and with what it has to be read.
    fn file(&self, line: &Line, from: &ReadFrom) -> (String, String, Options) {
        let degc = self.conditions.ambient_k - 273.15;
        let (cycle, car) = (&self.cycle.name, self.cars[0].setup);
        let least_rpm = self.least_rpm;
        let head = format!(
            "# Operating line of the least fuel on {cycle} at {degc:.0} degC, engine at least {least_rpm} rpm (cvtcycle optimum)."
        );
        let title = format!("{} with the best line on {cycle}", car.name);
        let texts = |from: &ReadFrom| {
            let file = LineFile {
                head: &head,
                title: &title,
                car,
                read: from,
            };
            let here = file.text(line, &|word| word.to_owned())?;
            Some((file.text(line, from.named)?, here))
        };
        let options = again(from.options);
        let reads =
            |here: &str| read("line.toml", here, Box::new(Disk::default()), &options).is_ok();
        if let Some((file, here)) = texts(from).filter(|(_, here)| reads(here)) {
            return (file, here, options);
        }
        // Options that no file can hold are given again.
        let options = Options {
            lubricant: None,
            engine_oil: None,
            ..from.options.clone()
        };
        let none = Options {
            set: Vec::new(),
            ..from.options.clone()
        };
        let plain = ReadFrom {
            options: &none,
            ..*from
        };
        let (file, here) = texts(&plain).unwrap_or_default();
        (file, here, options)
    }

    /// Fuel of a car on a cycle, L/100 km, and the time in which its engine is below the least speed though a lower ratio is left, s.
    fn driven(&self, car: &Setup, cycle: &Cycle) -> (f64, f64) {
        let low = optimum_low(car.transmission());
        let least_rad_s = (1.0 - OUTSIDE) * rad_s(self.least_rpm);
        let below = |row: &&Row| {
            locked(row) && row.belt_ratio < low && row.engine_speed_rad_s < least_rad_s
        };
        let mut below_s = 0.0;
        let mut see = |rows: &[Row]| {
            below_s += rows.iter().filter(below).map(|row| row.dt_s).sum::<f64>();
        };
        let driven = drive_into(car, cycle, &self.conditions, Some(&mut see));
        let density = car.engine().fuel_density_kg_m3;
        let kg = driven.totals.total().fuel_kg;
        let distance_m = cycle.trace_for(true).distance_m();
        (litres_per_100km(kg, density, distance_m), below_s)
    }

    /// The car as it is and with its line on another cycle.
    fn on(&self, cycle: &Cycle, line: &Setup) -> Elsewhere {
        let (line_l_per_100km, line_below_s) = self.driven(line, cycle);
        Elsewhere {
            cycle: cycle.name.clone(),
            own_l_per_100km: self.driven(self.cars[0].setup, cycle).0,
            line_l_per_100km,
            line_below_s,
        }
    }
}

/// Belt ratio below which a lower one is left; none where there is no belt.
fn optimum_low(of: &Transmission) -> f64 {
    match of {
        Transmission::Cvt(cvt) => (1.0 - OUTSIDE) * cvt.ratio.low,
        Transmission::Manual(_) => 0.0,
    }
}

/// Lists the options that must be given again with a file, as users write them.
fn again_in_words(options: &Options) -> Vec<String> {
    let sets = options.set.iter().map(|by| by.input().to_string());
    let plain = options.formulation == Formulation::default();
    let belt = (!plain).then(|| format!("formulation {}", options.formulation.name()));
    sets.chain(belt).collect()
}
