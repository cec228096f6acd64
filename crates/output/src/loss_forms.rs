//! Loss maps of a whole box by input torque, in the formats of other programs.
//!
//! | form | what it is | source |
//! |---|---|---|
//! | `vtlm` | transmission loss map of VECTO: input speed, input torque, torque loss; of one ratio and oil temperature | columns and signs by VECTO's user manual: loss never negative, overrun included |
//! | `gem` | power loss table of 40 CFR 1037.565(g): speed to 0.1 rpm, torque to 0.01 Nm, loss to 0.0001 kW | 40 CFR 1037.565 as of 87 FR 64864 |
//! | `modelica` | tables for Modelica.Blocks.Tables.CombiTable2Ds: rows input speed, rad/s, columns kinematic viscosity, m2/s, value torque loss, Nm; one table for each ratio and input torque | text format of the Modelica Standard Library |

use std::io::{self, Write};

use cvtcycle_model::keys::rpm;
use cvtcycle_model::rig::{Bench, BenchPoint};

use crate::losses::{Axis, LossGrid, bench_point};

/// Form of a map of a whole box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MapForm {
    /// Format of the maps named in a vehicle file.
    Csv,
    /// Transmission loss map of VECTO.
    Vtlm,
    /// Power loss table of 40 CFR 1037.565.
    Gem,
    /// Tables of Modelica over speed and viscosity.
    Modelica,
}

impl MapForm {
    /// Names as on the command line.
    pub const NAMES: [(&'static str, MapForm); 4] = [
        ("csv", MapForm::Csv),
        ("vtlm", MapForm::Vtlm),
        ("gem", MapForm::Gem),
        ("modelica", MapForm::Modelica),
    ];

    /// File extension.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            MapForm::Csv | MapForm::Gem => "csv",
            MapForm::Vtlm => "vtlm",
            MapForm::Modelica => "txt",
        }
    }

    /// Axes limited to a single value in this format.
    #[must_use]
    pub fn single(self) -> &'static [Axis] {
        match self {
            MapForm::Csv | MapForm::Modelica => &[],
            MapForm::Vtlm => &[Axis::Ratio, Axis::Sump],
            MapForm::Gem => &[Axis::Sump],
        }
    }
}

/// Lowest speed and rounding step of intermediate speeds by 40 CFR 1037.565(d)(1), rpm.
const GEM_SPEED_RPM: (f64, f64) = (600.0, 50.0);
/// Oil temperatures of 40 CFR 1037.565(b)(7), degC: middle of the ranges for automatic transmissions and for others.
const GEM_OIL_DEGC: [f64; 2] = [90.0, 80.0];

/// Speeds (rpm), input torques (Nm) and oil (degC) of 40 CFR 1037.565(d): 600 rpm, the engine's highest speed and three between them to the nearest
/// 50 rpm; no load, and the engine's highest torque in place of the box's rated one (ASSUMED: the box is rated for its engine).
#[must_use]
pub fn gem_grid(bench: &Bench) -> [(Axis, Vec<f64>); 3] {
    let engine = &bench.car().engine;
    let (low, round) = GEM_SPEED_RPM;
    let high = rpm(engine.highest_rad_s);
    let between = |k: i32| low + (high - low) * f64::from(k) / 4.0;
    let speed = |k: i32| match k {
        0 => low,
        4 => high,
        k => (between(k) / round).round() * round,
    };
    let torques = (0..=400).map(|k| {
        let share = f64::from(k) / 400.0;
        engine.full_load.at(engine.highest_rad_s * share)
    });
    let max_nm = torques.fold(0.0, f64::max);
    let oil = GEM_OIL_DEGC[usize::from(!bench.car().transmission.is_cvt())];
    [
        (Axis::Speed, (0..=4).map(speed).collect()),
        (Axis::Torque, vec![0.0, max_nm]),
        (Axis::Sump, vec![oil]),
    ]
}

/// Axis values and torque loss, Nm, at a point of a grid over torque at the input shaft.
fn loss_nm(bench: &Bench, grid: &LossGrid, index: usize) -> ([f64; Axis::COUNT], f64) {
    let requested = grid.at(index);
    let point = bench_point(&requested);
    let at_input = bench.at_input_torque(&point, point.output_nm);
    (requested, bench.solve(&at_input).total_nm())
}

/// Writes the map of a whole box over a grid of input torques, in a format other than [`MapForm::Csv`].
///
/// # Errors
/// I/O errors of `out`.
pub fn write_form(
    out: &mut dyn Write,
    form: MapForm,
    bench: &Bench,
    grid: &LossGrid,
) -> io::Result<()> {
    match form {
        MapForm::Csv => Ok(()),
        MapForm::Vtlm => vtlm(out, bench, grid),
        MapForm::Gem => gem(out, bench, grid),
        MapForm::Modelica => modelica(out, bench, grid),
    }
}

fn vtlm(out: &mut dyn Write, bench: &Bench, grid: &LossGrid) -> io::Result<()> {
    writeln!(out, "Input Speed [rpm],Input Torque [Nm],Torque Loss [Nm]")?;
    (0..grid.len()).try_for_each(|index| {
        let (requested, loss) = loss_nm(bench, grid, index);
        let (speed, torque) = (
            requested[Axis::Speed as usize],
            requested[Axis::Torque as usize],
        );
        writeln!(out, "{speed:.2},{torque:.2},{loss:.4}")
    })
}

fn gem(out: &mut dyn Write, bench: &Bench, grid: &LossGrid) -> io::Result<()> {
    let ratio = if bench.car().transmission.is_cvt() {
        "Belt ratio"
    } else {
        "Gear"
    };
    writeln!(
        out,
        "{ratio},Input speed [r/min],Input torque [N.m],Power loss [kW]"
    )?;
    (0..grid.len()).try_for_each(|index| {
        let requested = grid.at(index);
        let point = bench_point(&requested);
        // An unloaded output shaft turns freely, and the input torque is the loss (1037.565(e)(4), (f)(1)).
        let unloaded = point.output_nm.abs() <= 0.0;
        let point = match unloaded {
            true => point,
            false => bench.at_input_torque(&point, point.output_nm),
        };
        let answer = bench.solve(&point);
        let loss_kw = answer.total_nm() * point.input_rad_s / 1e3;
        let (ratio, speed) = (
            requested[Axis::Ratio as usize],
            requested[Axis::Speed as usize],
        );
        writeln!(
            out,
            "{ratio:.3},{speed:.1},{:.2},{loss_kw:.4}",
            answer.input_nm
        )
    })
}

fn modelica(out: &mut dyn Write, bench: &Bench, grid: &LossGrid) -> io::Result<()> {
    // Viscosity ascends as temperature descends.
    let mut oil: Vec<f64> = grid.axis_values(Axis::Sump).to_vec();
    oil.sort_by(|a, b| b.total_cmp(a));
    oil.dedup();
    let mut speeds: Vec<f64> = grid.axis_values(Axis::Speed).to_vec();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    let point = |ratio: f64, torque: f64, oil: f64, speed: f64| -> BenchPoint {
        let mut requested = [f64::NAN; Axis::COUNT];
        for (axis, value) in [
            (Axis::Ratio, ratio),
            (Axis::Torque, torque),
            (Axis::Sump, oil),
            (Axis::Speed, speed),
            (Axis::Throttle, 0.0),
        ] {
            requested[axis as usize] = value;
        }
        bench_point(&requested)
    };
    writeln!(out, "#1")?;
    let name = &bench.car().oil.name;
    writeln!(
        out,
        "# torque loss at the input shaft, Nm, over input speed, rad/s (rows), and kinematic viscosity of the oil in the sump, m2/s (columns); computed with {name}"
    )?;
    let ratios = (1..).zip(grid.axis_values(Axis::Ratio));
    for (i, ratio) in ratios {
        for (k, torque) in (1..).zip(grid.axis_values(Axis::Torque)) {
            writeln!(out, "# ratio or gear {ratio}, input torque {torque} Nm")?;
            let (rows, columns) = (speeds.len() + 1, oil.len() + 1);
            write!(out, "double loss_{i}_{k}({rows},{columns})\n0")?;
            for degc in &oil {
                let sump_k = point(*ratio, *torque, *degc, 1000.0).sump_k;
                write!(out, " {:e}", bench.car().oil.kinematic_m2_s(sump_k))?;
            }
            for speed in &speeds {
                let row = |degc: &f64| {
                    let requested = point(*ratio, *torque, *degc, *speed);
                    let at_input = bench.at_input_torque(&requested, *torque);
                    bench.solve(&at_input).total_nm()
                };
                write!(
                    out,
                    "\n{}",
                    point(*ratio, *torque, 20.0, *speed).input_rad_s
                )?;
                oil.iter()
                    .try_for_each(|degc| write!(out, " {}", row(degc)))?;
            }
            writeln!(out)?;
        }
    }
    Ok(())
}
