//! The answer in numbers: bounds, how far from them each controller is, the line and its proof.

use cvtcycle_config::Problems;
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::{Disk, Options, Setup, read};
use cvtcycle_model::cycle::Step;
use cvtcycle_model::drive::{Car, Conditions, Row, Totals, drive, litres_per_100km, start_state};
use cvtcycle_model::keys::{rad_s, rpm};
use rayon::prelude::*;
use serde::Serialize;

use super::limits::{Infeasible, LimitName};
use super::line::{Line, LineFit, burnt, fit_line};
use super::{Bound, Clamp, Limits, Task, bound};

/// Gap between the driven path and the bound above which the bound is not tight.
pub const TIGHT: f64 = 5e-3;
/// Relative difference of two sums of the same drive.
const PROVEN: f64 = 1e-9;

/// A car under one of its clamp laws.
#[derive(Clone, Copy, Debug)]
pub struct LawCar<'a> {
    /// Name of the law.
    pub law: &'a str,
    /// Its input.
    pub setup: &'a Setup,
}

/// What is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Question<'a> {
    /// The car with its own clamp law, then with the others.
    pub cars: &'a [LawCar<'a>],
    /// The cycle.
    pub cycle: &'a Cycle,
    /// How it is driven.
    pub conditions: Conditions,
    /// Least engine speed with the clutch locked, rpm.
    pub least_rpm: f64,
    /// Share of full load that is kept.
    pub reserve: f64,
    /// Least safety factor and largest slip of a free clamp; none: no bound for one.
    pub free: Option<(f64, f64)>,
    /// Rates of ln I towards high and low, 1/s; those of the car if there are none.
    pub rates_per_s: Option<(f64, f64)>,
    /// Ratios of the grid.
    pub grid: usize,
    /// Whether the operating line is sought.
    pub line: bool,
    /// Other least engine speeds, rpm.
    pub least_speeds_rpm: &'a [f64],
    /// Other cycles on which the line is driven.
    pub elsewhere: &'a [Cycle],
}

/// The bound for one clamp law.
#[derive(Clone, Debug, Serialize)]
pub struct LawBound {
    /// Clamp law, or `free`.
    pub clamp: String,
    /// Fuel of the car with this law and its own ratio control, L/100 km; none for `free`.
    pub own_l_per_100km: Option<f64>,
    /// Time in which that car keeps less engine speed or reserve than the limits want, with the clutch locked, s.
    pub own_outside_s: Option<f64>,
    /// Fuel with this law and the operating line, L/100 km.
    pub line_l_per_100km: Option<f64>,
    /// Time outside the limits with the line, s.
    pub line_outside_s: Option<f64>,
    /// Least fuel (DP-9).
    pub least_l_per_100km: f64,
    /// Tolerance (DP-11).
    pub tolerance_l_per_100km: f64,
    /// Fuel of the best path as driven (DP-10).
    pub driven_l_per_100km: f64,
    /// That above the least fuel less the tolerance, per cent.
    pub gap_percent: f64,
    /// Least fuel by ratios of the grid, coarsest first.
    pub grid: Vec<(usize, f64)>,
    /// Least fuel in each set of temperatures, on half of the grid.
    pub temperatures: Vec<f64>,
}

/// What a limit costs.
#[derive(Clone, Debug, Serialize)]
pub struct LimitPrice {
    /// Limit.
    pub limit: &'static str,
    /// Fuel saved without it, per cent.
    pub percent: f64,
}

/// The line on a cycle that it is not made for.
#[derive(Clone, Debug, Serialize)]
pub struct Elsewhere {
    /// Cycle.
    pub cycle: String,
    /// Fuel of the car as it is, L/100 km.
    pub own_l_per_100km: f64,
    /// Fuel with the line, L/100 km.
    pub line_l_per_100km: f64,
}

/// The operating line.
#[derive(Clone, Debug, Serialize)]
pub struct LineAnswer {
    /// Share of rated power, per cent; engine speed, rpm.
    pub drive: Vec<(f64, f64)>,
    /// Road speed, km/h; engine speed, rpm.
    pub overrun: Vec<(f64, f64)>,
    /// Fuel of the car of the vehicle file, read and driven from the state in which the car as it is begins.
    pub l_per_100km: f64,
    /// That above the least fuel with the same clamp law, per cent: what looking ahead is worth.
    pub above_least_percent: f64,
    /// The same above the least fuel less the tolerance.
    pub above_bound_percent: f64,
    /// Whether the car of the file burns what the line does.
    pub proven: bool,
    /// Slowest engine where there is a choice, rpm.
    pub slowest_rpm: f64,
    /// Drives that the search took.
    pub drives: usize,
    /// Fuel on other cycles.
    pub elsewhere: Vec<Elsewhere>,
    /// The vehicle file.
    #[serde(skip)]
    pub file: String,
}

/// The answer.
#[derive(Clone, Debug, Serialize)]
pub struct Answer {
    /// By clamp law, that of the car first.
    pub bounds: Vec<LawBound>,
    /// Least fuel with the car's law by least engine speed, rpm; none where no ratio holds it.
    pub least_speeds: Vec<(f64, Option<f64>)>,
    /// What each limit costs with the car's law.
    pub limits: Vec<LimitPrice>,
    /// The operating line, if it was sought.
    pub line: Option<LineAnswer>,
    /// Failed checks.
    pub failures: Vec<String>,
    /// Rows of the best path as driven, with the car's law.
    #[serde(skip)]
    pub path: Vec<Row>,
}

/// Why there is no answer.
#[derive(Debug)]
pub enum NoAnswer {
    /// The limits cannot be held.
    Infeasible(Box<Infeasible>),
    /// The line's own file cannot be read.
    Line(Problems),
    /// The car has no CVT.
    NoCvt,
}

/// Answers a question; `like` names the car in the line's file, `options` are those it was read with.
///
/// # Errors
/// The limits cannot be held.
pub fn answer(of: &Question, like: &str, options: &Options) -> Result<Answer, NoAnswer> {
    let trace = of.cycle.trace_for(true);
    let steps: Vec<Step> = trace.steps(of.conditions.max_dt_s).collect();
    let ready = |law: &LawCar| law.setup.car(of.conditions.ambient_k);
    let cars: Vec<Car> = of.cars.iter().map(ready).collect();
    let least_speeds: Vec<f64> = of.least_speeds_rpm.iter().map(|n| rad_s(*n)).collect();
    let tasks = of.tasks(&cars, &steps, &least_speeds);
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
    let laws: Vec<LawBound> = laws.collect();
    let loose = laws.iter().filter(|law| law.gap_percent > 100.0 * TIGHT);
    let mut failures: Vec<String> = loose.map(not_tight).collect();
    let line = fit.map(|fit| of.proven(fit, (task, main), &litres, (like, options)));
    let line = line.transpose().map_err(NoAnswer::Line)?;
    failures.extend(line.iter().filter(|line| !line.proven).map(|_| {
        "line not proven: its file, read and driven, gives another fuel than the line".to_owned()
    }));
    let speeds = main.least_speeds.iter();
    Ok(Answer {
        bounds: laws,
        least_speeds: speeds
            .map(|(w, kg)| (rpm(*w).round(), kg.map(litres)))
            .collect(),
        limits: main
            .without
            .iter()
            .map(|(name, kg)| price(*name, *kg, main))
            .collect(),
        line,
        failures,
        path: main.rows.clone(),
    })
}

fn not_tight(law: &LawBound) -> String {
    format!(
        "bound not tight: with the clamp `{}` the best path burns {:.2} % more than the bound",
        law.clamp, law.gap_percent
    )
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
    LawBound {
        clamp: law.unwrap_or("free").to_owned(),
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

fn price(name: LimitName, without_kg: f64, bound: &Bound) -> LimitPrice {
    LimitPrice {
        limit: name.name(),
        percent: 100.0 * (1.0 - without_kg / bound.fuel_kg),
    }
}

impl Question<'_> {
    /// The tasks of all clamp laws, then that of a free clamp.
    fn tasks<'a>(
        &self,
        cars: &'a [Car],
        steps: &'a [Step],
        least_speeds_rad_s: &'a [f64],
    ) -> Vec<Task<'a>> {
        let trace = self.cycle.trace_for(true);
        let task = |(number, car): (usize, &'a Car), clamp: Clamp| {
            let main = number == 0 && clamp == Clamp::Law;
            Some(Task {
                car,
                cvt: super::cvt(car)?,
                steps,
                start: start_state(car, trace, &self.conditions),
                clamp,
                limits: self.limits(car),
                grid: self.grid,
                least_speeds_rad_s: if main { least_speeds_rad_s } else { &[] },
                prices: if main { &LimitName::ALL } else { &[] },
            })
        };
        let laws = cars.iter().enumerate();
        let laws = laws.filter_map(|car| task(car, Clamp::Law));
        let free = self.free.iter().filter_map(|(safety, slip)| {
            let (safety, slip) = (*safety, *slip);
            task((0, cars.first()?), Clamp::Free { safety, slip })
        });
        laws.chain(free).collect()
    }

    /// The line with the proof that its file is it.
    fn proven(
        &self,
        fit: LineFit,
        (task, main): (&Task, &Bound),
        litres: &impl Fn(f64) -> f64,
        (like, options): (&str, &Options),
    ) -> Result<LineAnswer, Problems> {
        let file = self.file(&fit.line, like);
        let setup = read("line.toml", &file, Box::new(Disk::default()), options)?;
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

    /// A vehicle file that is like the car but for its line.
    fn file(&self, line: &Line, like: &str) -> String {
        let degc = self.conditions.ambient_k - 273.15;
        format!(
            "# Operating line of the least fuel on {} at {degc:.0} degC, engine at least {} rpm (cvtcycle optimum).\n\
             # What was given by --set or --lubricant has to be given again.\n\
             [vehicle]\ntitle = \"{} with the best line on {}\"\nlike = {}\n\n{}",
            self.cycle.name,
            self.least_rpm,
            self.cars[0].setup.name,
            self.cycle.name,
            serde_json::Value::from(like),
            line.table()
        )
    }

    /// A car on a cycle.
    fn driven(&self, car: &Setup, cycle: &Cycle) -> Totals {
        let conditions = Conditions {
            keep_rows: false,
            ..self.conditions
        };
        drive(car, cycle, &conditions).totals
    }

    /// The car as it is and with its line on another cycle.
    fn on(&self, cycle: &Cycle, line: &Setup) -> Elsewhere {
        let litres = |car: &Setup| {
            let density = car.engine().fuel_density_kg_m3;
            let kg = self.driven(car, cycle).total().fuel_kg;
            litres_per_100km(kg, density, cycle.trace_for(true).distance_m())
        };
        Elsewhere {
            cycle: cycle.name.clone(),
            own_l_per_100km: litres(self.cars[0].setup),
            line_l_per_100km: litres(line),
        }
    }
}
