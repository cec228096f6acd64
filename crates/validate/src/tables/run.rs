//! A car through a cycle as a table: its trace, or its totals.

use std::borrow::Cow;
use std::rc::Rc;
use std::sync::LazyLock;

use super::{Column, Marks, Rows, names};
use crate::expr::{Table, truth};
use crate::source::{Source, cycle};
use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::{Conditions, Outcome, PhaseTotals, Row, Start, litres_per_100km};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, METAL, SUMP};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_output::trace::COLUMNS;

/// A finished run.
#[derive(Clone, Debug)]
pub struct Driven {
    cycle: Cow<'static, Cycle>,
    outcome: Outcome,
    rated_w: f64,
    fuel_density_kg_m3: f64,
    co2_per_fuel: f64,
}

/// A row of the trace in its run.
struct Step {
    driven: Rc<Driven>,
    place: usize,
    /// Number of the launch, counted from 1.
    launch: f64,
    since_launch_s: f64,
}

impl Step {
    fn row(&self) -> &Row {
        &self.driven.outcome.rows[self.place]
    }
}

/// Columns after those of the trace and its flags.
fn more() -> Vec<Column<Step>> {
    columns! { Step;
    "moving" s => truth(!s.row().rests());
    "coupled" s => truth(!s.row().flags.contains(Flags::CLUTCH_SLIPPING) && !s.row().flags.contains(Flags::CLUTCH_OPEN));
    "launch" s => s.launch;
    "since_launch_s" s => s.since_launch_s;
    "power_share" s => s.row().wheel_power_w / s.driven.rated_w;
    "transmission_loss_w" s => s.row().loss_w.iter().sum::<f64>();
    }
}

/// Totals of some phases of a run. Temperatures and the missed trace are those of the whole run.
type Totals<'a> = (&'a Driven, &'a PhaseTotals);

/// Columns of the totals before those of the components.
fn of_totals<'a>() -> Vec<Column<Totals<'a>>> {
    columns! { Totals;
    "fuel_l_per_100km" (d, t) => litres_per_100km(t.fuel_kg, d.fuel_density_kg_m3, t.distance_m);
    "fuel_kg" (_, t) => t.fuel_kg;
    "fuel_energy_kj" (_, t) => t.terms.fuel / 1e3;
    "co2_g_per_km" (d, t) => 1e3 * t.fuel_kg * d.co2_per_fuel / (t.distance_m / 1e3);
    "distance_km" (_, t) => t.distance_m / 1e3;
    "duration_s" (_, t) => t.duration_s;
    "standstill_fuel_kg" (_, t) => t.standstill_fuel_kg;
    "wheel_work_positive_kj" (_, t) => t.wheel_positive_j / 1e3;
    "wheel_work_negative_kj" (_, t) => t.wheel_negative_j / 1e3;
    "transmission_kj" (_, t) => t.loss_j.iter().sum::<f64>() / 1e3;
    "belt_kj" (_, t) => Component::ALL.into_iter().filter(|c| c.is_belt()).map(|c| t.loss_j[c]).sum::<f64>() / 1e3;
    "end_sump_degc" (d, _) => d.end_degc(SUMP);
    "end_engine_oil_degc" (d, _) => d.end_degc(ENGINE_OIL);
    "end_coolant_degc" (d, _) => d.end_degc(COOLANT);
    "end_metal_degc" (d, _) => d.end_degc(METAL);
    "end_belt_degc" (d, _) => d.end_degc(BELT);
    "missed_trace_s" (d, _) => d.outcome.totals.seconds(Flags::MISSED_TRACE);
    }
}

static LOSSES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| Component::ALL.iter().map(|c| c.columns().kj).collect());

/// Names of the columns of the trace.
pub fn columns() -> Vec<&'static str> {
    let trace = COLUMNS.iter().map(|column| &*column.name);
    let flags = Flags::NAMES.iter().map(|(_, name)| *name);
    trace.chain(flags).chain(names(more())).collect()
}

/// Names of the columns of the totals.
pub fn total_columns() -> Vec<&'static str> {
    names(of_totals()).chain(LOSSES.iter().copied()).collect()
}

/// Drives a source's cycle.
///
/// # Errors
/// There is no such cycle.
pub fn drive(source: &Source, setup: &Setup) -> Result<Driven, String> {
    let cycle = cycle(source)?;
    let start = match (source.start_k(), source.start) {
        (Some(k), _) => Start::At(k),
        (None, "warm") => Start::Warm,
        _ => Start::Soak,
    };
    let conditions = Conditions {
        ambient_k: source.ambient_k(),
        start,
        max_dt_s: source.dt_s(),
        keep_rows: true,
    };
    let outcome = cvtcycle_model::drive::drive(setup, &cycle, &conditions);
    let engine = setup.car(source.ambient_k()).engine;
    let co2 = |info: &&cvtcycle_config::KeyInfo| info.key == "engine.fuel.co2_per_fuel";
    let co2 = setup.keys.iter().find(co2).and_then(|info| info.si);
    Ok(Driven {
        cycle,
        outcome,
        rated_w: engine.rated_w,
        fuel_density_kg_m3: engine.fuel_density_kg_m3,
        co2_per_fuel: co2.unwrap_or(f64::NAN),
    })
}

impl Driven {
    fn end_degc(&self, node: usize) -> f64 {
        self.outcome.end.node_k[node] - ZERO_DEGC_K
    }

    /// Indices of the phases that count.
    fn phases(&self, source: &Source) -> Vec<u16> {
        let groups = self.cycle.phase_groups().into_iter();
        groups
            .filter(|(name, _)| source.phase.is_empty() || *name == source.phase)
            .flat_map(|(_, list)| list)
            .collect()
    }
}

/// The trace of a run, weighted with the length of the steps.
pub fn trace(source: &Source, driven: &Rc<Driven>) -> Table {
    let wanted = driven.phases(source);
    let (mut launch, mut since_launch_s, mut at_rest) = (0.0, f64::NAN, true);
    let mut rows = Rows::new(driven.outcome.rows.len());
    for (place, row) in driven.outcome.rows.iter().enumerate() {
        let moving = !row.rests();
        if moving && at_rest {
            (launch, since_launch_s) = (launch + 1.0, 0.0);
        }
        since_launch_s += row.dt_s;
        at_rest = !moving;
        let flags = row.flags;
        let marks = Marks {
            weight: row.dt_s,
            gross: flags.contains(Flags::GROSS_SLIP),
            outside: flags.contains(Flags::OUTSIDE_VALIDITY) || flags.any(Flags::IMPOSSIBLE),
        };
        if wanted.contains(&row.phase) {
            let step = Step {
                driven: driven.clone(),
                place,
                launch,
                since_launch_s,
            };
            rows.add(step, &marks);
        }
    }
    let more = more();
    let (own, flags) = (COLUMNS.len(), Flags::NAMES.len());
    rows.table(own + flags + more.len(), move |step, column| {
        if column < own {
            COLUMNS[column].number_of(step.row())
        } else if let Some((flag, _)) = Flags::NAMES.get(column - own) {
            truth(step.row().flags.contains(*flag))
        } else {
            (more[column - own - flags].get)(step)
        }
    })
}

/// The totals of a run as a table of one row.
pub fn totals(source: &Source, driven: &Driven) -> Table {
    let sum = driven.outcome.totals.over(&driven.phases(source));
    let own = of_totals()
        .into_iter()
        .map(|column| (column.get)(&(driven, &sum)));
    let numbers: Vec<f64> = own.chain(sum.loss_j.iter().map(|j| j / 1e3)).collect();
    let width = numbers.len();
    let mut rows = Rows::new(1);
    rows.add(numbers, &Marks::default());
    rows.table(width, |numbers, column| numbers[column])
}
