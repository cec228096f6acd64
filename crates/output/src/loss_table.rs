//! Losses of the model in the format of the measured maps of a vehicle file: `[transmission.cvt.maps]`, `[transmission.manual.maps]`.
//!
//! The torque axis depends on the component: torque at the secondary pulley for the belt, behind it without the final drive's loss for the final
//! drive, at the input shaft for a whole box. Other components of a CVT do not depend on torque.

use std::io::{self, Write};

use super::losses::{Axis, LossGrid, bench_point};
use crate::Component;
use crate::table::{Column, write_csv};
use cvtcycle_model::rig::{Bench, BenchPoint, Parts};

/// Component that a map can replace, named like its key in the vehicle file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapPart {
    /// Whole belt.
    Belt,
    /// Pump.
    Pump,
    /// Input shaft.
    InputShaft,
    /// Reverse clutch drag.
    ClutchDrag,
    /// Seal rings of both pulleys.
    SealRing,
    /// Final drive of the CVT.
    FinalDrive,
    /// Whole box, of a CVT without its launch device.
    Box,
}

impl MapPart {
    /// Names as in the vehicle file.
    pub const NAMES: [(&'static str, MapPart); 7] = [
        ("belt", MapPart::Belt),
        ("pump", MapPart::Pump),
        ("input_shaft", MapPart::InputShaft),
        ("clutch_drag", MapPart::ClutchDrag),
        ("seal_ring", MapPart::SealRing),
        ("final_drive", MapPart::FinalDrive),
        ("box", MapPart::Box),
    ];

    /// True for a part that only a CVT has.
    pub fn is_cvt_only(self) -> bool {
        self != MapPart::Box
    }

    /// Name of the map's torque column, if the loss depends on torque.
    pub fn torque_column(self) -> Option<&'static str> {
        match self {
            MapPart::Belt | MapPart::FinalDrive => Some("output_torque_nm"),
            MapPart::Box => Some("input_torque_nm"),
            MapPart::Pump | MapPart::InputShaft | MapPart::ClutchDrag | MapPart::SealRing => None,
        }
    }

    /// Loss at a point whose torque is that of the map's axis, Nm at the input shaft.
    pub fn loss_nm(self, bench: &Bench, point: &BenchPoint) -> f64 {
        let part = |component: Component, point: &BenchPoint| bench.solve(point).part_nm(component);
        let at_output = BenchPoint {
            output_nm: point.output_nm * bench.own_ratio(point),
            ..*point
        };
        match self {
            MapPart::Pump => part(Component::Pump, point),
            MapPart::InputShaft => part(Component::InputShaft, point),
            MapPart::ClutchDrag => part(Component::ClutchDrag, point),
            MapPart::SealRing => part(Component::SealRing, point),
            MapPart::FinalDrive => part(Component::FinalDrive, &at_output),
            MapPart::Belt => {
                // Without the losses of final drive and rings, the rig's torque is that of the belt with its bearings.
                let parts = Parts {
                    final_drive: false,
                    seal_rings: false,
                    ..point.parts
                };
                let at_pulley = BenchPoint { parts, ..at_output };
                let answer = bench.solve(&at_pulley);
                answer.belt_nm() + answer.part_nm(Component::PulleyBearing)
            }
            MapPart::Box => {
                let at_input = bench.at_input_torque(point, point.output_nm);
                bench.solve(&at_input).total_nm()
            }
        }
    }
}

/// Axes of a map and the loss.
type MapPoint = ([f64; Axis::COUNT], f64);

/// Columns of the map over a grid: axes, then the loss.
fn map_columns(part: MapPart, is_cvt: bool, grid: &LossGrid) -> Vec<Column<MapPoint>> {
    let ratio = if is_cvt { "ratio" } else { "gear" };
    let pressure = !grid.axis_values(Axis::Pressure).is_empty() && part.is_cvt_only();
    let axes = [
        (Some(ratio), Axis::Ratio),
        (Some("input_speed_rpm"), Axis::Speed),
        (part.torque_column(), Axis::Torque),
        (pressure.then_some("secondary_pressure_bar"), Axis::Pressure),
        (Some("oil_temp_degc"), Axis::Sump),
    ];
    let axes = axes.into_iter().filter_map(|(name, axis)| {
        let get = move |(requested, _): &MapPoint| requested[axis as usize];
        Some(Column::number(name?, "", "", get))
    });
    let loss = Column::number("torque_loss_nm", "", "", |(_, loss)| *loss);
    axes.chain([loss]).collect()
}

/// Writes the map of a component over a grid as CSV, one line a point.
///
/// # Errors
/// I/O errors of `out`.
pub fn write_map(
    out: &mut dyn Write,
    bench: &Bench,
    part: MapPart,
    grid: &LossGrid,
) -> io::Result<()> {
    let rows = (0..grid.len()).map(|index| {
        let requested = grid.at(index);
        (requested, part.loss_nm(bench, &bench_point(&requested)))
    });
    let is_cvt = bench.car().transmission.is_cvt();
    write_csv(out, &map_columns(part, is_cvt, grid), rows, &[])
}
