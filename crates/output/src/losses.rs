//! Component losses at one operating point or over a grid of points, as rows with named columns.
//!
//! Values of a grid stay in the units of their columns, so that the user's numbers are written back unchanged.

mod grid;

pub use grid::{Axis, LossGrid, MAX_POINTS};

use std::io::{self, Write};

use cvtcycle_config::setup::Setup;
use cvtcycle_config::to_si;
use cvtcycle_model::rig::{Bench, BenchAnswer, BenchPoint};
use cvtcycle_model::transmission::Transmission;
use serde_json::{Value, json};

use crate::provenance::car_sha256;
use crate::record::Manifest;
use crate::table::{Cell, Column, Scope, json_columns, write_csv, write_json};
use crate::trace::{bar, degc};
use crate::{Component, columns};
use cvtcycle_model::keys::rpm;

/// Version of the JSON object.
const SCHEMA: u32 = 1;

/// One solved point.
#[derive(Clone, Copy, Debug)]
pub struct LossRow {
    /// Requested values, by [`Axis`] in the units of the columns; NaN where not given.
    pub requested: [f64; Axis::COUNT],
    /// Operating point in SI units.
    pub point: BenchPoint,
    /// Answer of the rig.
    pub answer: BenchAnswer,
}

/// Converts requested values from the units of the columns to SI.
pub fn bench_point(requested: &[f64; Axis::COUNT]) -> BenchPoint {
    let value = |axis: Axis| requested[axis as usize];
    let given =
        |axis: Axis, suffix: &str| Some(to_si(suffix, value(axis))).filter(|x| x.is_finite());
    BenchPoint {
        ratio: value(Axis::Ratio),
        input_rad_s: to_si("_rpm", value(Axis::Speed)),
        output_nm: value(Axis::Torque),
        throttle: value(Axis::Throttle),
        pressure_pa: given(Axis::Pressure, "_bar"),
        sump_k: to_si("_degc", value(Axis::Sump)),
        belt_k: given(Axis::Belt, "_degc"),
        ..BenchPoint::default()
    }
}

impl LossGrid {
    /// Solves the points one after the other.
    pub fn rows<'a>(&'a self, bench: &'a Bench) -> impl Iterator<Item = LossRow> + 'a {
        (0..self.len()).map(|index| LossRow::new(bench, self.at(index)))
    }
}

impl LossRow {
    /// Solves a point.
    pub fn new(bench: &Bench, requested: [f64; Axis::COUNT]) -> Self {
        let point = match requested[Axis::InputTorque as usize] {
            wanted_nm if wanted_nm.is_nan() => bench_point(&requested),
            wanted_nm => bench.at_input_torque(&bench_point(&requested), wanted_nm),
        };
        LossRow {
            requested,
            point,
            answer: bench.solve(&point),
        }
    }

    /// Power at the input shaft, W.
    pub fn input_w(&self) -> f64 {
        self.answer.input_nm * self.point.input_rad_s
    }

    /// Power at the output shaft, W.
    pub fn output_w(&self) -> f64 {
        self.point.output_nm * self.answer.output_rad_s
    }

    /// Power out over power in, in either direction of power flow; NaN where both shafts drive.
    pub fn efficiency(&self) -> f64 {
        let (input, output) = (self.input_w(), self.output_w());
        if input > 0.0 && output >= 0.0 {
            output / input
        } else if input <= 0.0 && output < 0.0 {
            input / output
        } else {
            f64::NAN
        }
    }

    /// Belt slip as a fraction; NaN without a belt model.
    pub fn slip(&self) -> f64 {
        self.answer
            .belt
            .map_or(f64::NAN, |belt| belt.losses.slip_total)
    }

    /// Torque capacity of the belt over its torque; infinite without load, NaN without a belt model.
    pub fn clamp_safety(&self) -> f64 {
        self.answer.belt.map_or(f64::NAN, |belt| {
            let secondary_nm = (belt.input_torque_nm - belt.losses.sum_nm()) * self.point.ratio
                / (1.0 - belt.losses.slip_total);
            belt.losses.capacity_nm / secondary_nm.abs()
        })
    }

    /// Status of the belt's solution, as in the `belt` command; empty without a belt model.
    pub fn belt_status(&self) -> &'static str {
        match self.answer.belt {
            None => "",
            Some(belt) if belt.losses.slip_total.is_nan() => "no_active_arc",
            Some(belt) if belt.losses.gross_slip => "gross_slip",
            Some(_) => "ok",
        }
    }

    fn requested_or(&self, axis: Axis, answered: f64) -> f64 {
        let requested = self.requested[axis as usize];
        if requested.is_nan() {
            answered
        } else {
            requested
        }
    }
}

/// Components that the rig covers: all but the launch clutch, which is locked.
fn bench_components(transmission: &Transmission) -> Vec<Component> {
    let mut components = transmission.components();
    components.retain(|c| *c != Component::LaunchClutch);
    components
}

/// Columns for a transmission, in output order.
pub fn columns(transmission: &Transmission) -> Vec<Column<LossRow>> {
    let components = bench_components(transmission);
    let mut list = columns! { LossRow;
        number "input_speed_rpm", "rpm", "speed of the input shaft", r => r.requested[Axis::Speed as usize];
        number "belt_ratio", "-", "belt ratio, secondary over primary running radius", r => r.requested[Axis::Ratio as usize], Scope::Cvt;
        count "gear", "", "gear", r => r.requested[Axis::Ratio as usize] as u64, Scope::Manual;
        number "output_torque_nm", "Nm", "torque taken from the output shaft, after the final drive", r => r.point.output_nm;
        number "transmission_sump_degc", "degC", "transmission oil in the sump", r => r.requested[Axis::Sump as usize];
        number "belt_spray_degc", "degC", "belt, pulleys and the oil sprayed off them", r => r.requested_or(Axis::Belt, degc(r.answer.belt_k)), Scope::Cvt;
        number "throttle", "-", "throttle that the clamp law sees", r => r.point.throttle, Scope::Cvt;
        number "secondary_pressure_bar", "bar", "secondary pulley pressure", r => r.requested_or(Axis::Pressure, bar(r.answer.secondary_pa)), Scope::Cvt;
        number "slip_percent", "%", "belt slip", r => 100.0 * r.slip(), Scope::Cvt;
        number "active_segments", "-", "segments that carry; whole numbers in the printed forms, 0 where there are none", r => r.answer.belt.map_or(f64::NAN, |belt| belt.slip.active_segments), Scope::Cvt;
        text "belt_status", "", "ok, gross_slip, or no_active_arc: no number of segments carries the load (printed forms only)", r => r.belt_status(), Scope::Cvt;
        number "clamp_safety", "-", "torque capacity of the belt over its torque; none without load", r => r.clamp_safety(), Scope::Cvt;
    };
    list.retain(|column| column.scope.includes(transmission.is_cvt(), &components));
    list.extend(components.into_iter().map(|component| {
        let doc = format!("{}, torque at the input shaft", component.doc());
        let name = format!("{}_loss_nm", component.name());
        Column::number(name, "Nm", doc, move |r: &LossRow| {
            r.answer.part_nm(component)
        })
    }));
    list.extend(columns! { LossRow;
        number "total_loss_nm", "Nm", "all losses, torque at the input shaft", r => r.answer.total_nm();
        number "input_torque_nm", "Nm", "torque at the input shaft", r => r.answer.input_nm;
        number "input_power_w", "W", "power at the input shaft", r => r.input_w();
        number "output_speed_rpm", "rpm", "speed of the output shaft", r => rpm(r.answer.output_rad_s);
        number "output_power_w", "W", "power at the output shaft", r => r.output_w();
        number "efficiency", "-", "power out over power in; none where both shafts drive", r => r.efficiency();
        words "flags", "", "states and departures from validity", r => Cell::Flags(r.answer.flags);
    });
    list
}

/// Losses of a transmission over a grid of points, with their inputs.
#[derive(Debug)]
pub struct LossTable {
    /// Checked vehicle.
    pub setup: Setup,
    /// Rig with the vehicle's transmission.
    pub bench: Bench,
    /// Operating points.
    pub grid: LossGrid,
    /// Name of the belt model.
    pub formulation: String,
    /// Overrides of the vehicle, as the user wrote them.
    pub set: Vec<String>,
}

impl LossTable {
    /// True for a CVT.
    pub fn is_cvt(&self) -> bool {
        self.setup.transmission().is_cvt()
    }

    /// Solves the points one after the other.
    pub fn rows(&self) -> impl Iterator<Item = LossRow> + '_ {
        self.grid.rows(&self.bench)
    }

    /// Components that have a loss on the rig.
    pub fn components(&self) -> Vec<Component> {
        bench_components(self.setup.transmission())
    }

    /// Components in groups, the parts of the belt as one, with the title of each group.
    pub fn groups(&self) -> Vec<(String, Vec<Component>)> {
        let mut list: Vec<(String, Vec<Component>)> = Vec::new();
        for component in self.components() {
            let title = if component.is_belt() {
                "Belt"
            } else {
                component.title()
            };
            match list.iter_mut().find(|(name, _)| name == title) {
                Some((_, parts)) => parts.push(component),
                None => list.push((title.to_owned(), vec![component])),
            }
        }
        list
    }

    /// Formats the values of some axes at a point in words.
    pub fn values_in_words(&self, requested: &[f64; Axis::COUNT], axes: &[Axis]) -> String {
        let cvt = self.is_cvt();
        let given = |axis: &&Axis| {
            !requested[**axis as usize].is_nan() && (cvt || **axis != Axis::Throttle)
        };
        let axes = axes.iter().filter(given);
        let words = axes.map(|axis| axis.words(cvt, requested[*axis as usize]));
        words.collect::<Vec<_>>().join(", ")
    }

    fn columns(&self) -> Vec<Column<LossRow>> {
        columns(self.setup.transmission())
    }

    /// Builds the JSON object without its points; `map` names the component if they continue as its map.
    pub fn json_head(&self, map: Option<&str>) -> Value {
        let rest = json!({
            "settings": {
                "vehicle": self.setup.name,
                "transmission": if self.is_cvt() { "cvt" } else { "manual" },
                "lubricant": self.setup.oils().0.name,
                "formulation": self.formulation,
                "set": self.set,
            },
            "columns": json_columns(&self.columns()),
            "count": self.grid.len(),
        });
        // The run is named by its inputs: the points are computed while they are written.
        let inputs = (&rest, car_sha256(&self.setup), &self.grid.values, map);
        Manifest::new(SCHEMA).for_run(&inputs).with(&rest)
    }

    /// Writes rows as CSV.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn write_csv(
        &self,
        out: &mut dyn Write,
        rows: impl Iterator<Item = LossRow>,
    ) -> io::Result<()> {
        write_csv(out, &self.columns(), rows, &[])
    }

    /// Writes the JSON object with rows as its points, one a line.
    ///
    /// # Errors
    /// I/O errors of `out`.
    pub fn write_json(
        &self,
        out: &mut dyn Write,
        rows: impl Iterator<Item = LossRow>,
    ) -> io::Result<()> {
        write_json(out, &self.json_head(None), &self.columns(), rows)
    }
}
