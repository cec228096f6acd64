//! `rig variator`: the belt alone on its rig, slip against output torque.

mod plan;

use clap::Args;
use cvtcycle::config::Problems;
use cvtcycle::model::rig::variator::RigFlags;
use cvtcycle::output::number::{fixed, percent, plain};
use cvtcycle::output::table::{TextColumns, wrapped};
use cvtcycle::output::variator::{Curve, VariatorCurves};
use cvtcycle::report::charts::variator_figures;

use crate::args::{FormulationArgs, OutArgs, TableOutputArgs, VehicleArgs};
use crate::commands::Execute;
use crate::print::colour::Paint;
use crate::print::{CommandResult, Results, Terminal, WrittenFiles, stream};
use plan::VariatorPlan;

/// Arguments of `rig variator`.
#[derive(Args, Clone, Debug)]
#[command(
    mut_arg("out", |out| out.help("Write curves.csv, points.csv, summary.json and plots (SVG) into this directory")),
    mut_arg("format", |format| format.help("Print a line for each curve, or CSV with all points")),
    after_help = "\
Examples:
  cvtcycle rig variator
  cvtcycle rig variator --ratio low --pressure 15..35:5 --torque 0..300:5 --format csv
  cvtcycle rig variator --ratio high --pressure 11 --speed 1500 --out variator

A numeric option takes a number, a list (15,25,35), a range with a step (15..35:5, both ends included) or without one \
(15..35), or these mixed. Torques are those at the secondary pulley. Rows beyond the limits of the rig are flagged, not \
removed: 400 Nm and 250 Nm at secondary and primary, 40 bar, 3000 rpm at either shaft."
)]
pub struct RigVariatorArgs {
    #[command(flatten)]
    car: VehicleArgs,
    /// Belt ratio: a number, `low` (of the vehicle) or `high` (0.5, of the rig)
    #[arg(long, value_name = "R|low|high", default_value = plan::RATIOS, allow_hyphen_values = true)]
    ratio: String,
    /// Secondary pressure, bar [default: 15..35:5 above ratio 1, 10..12:0.5 below]
    #[arg(long, value_name = "BAR", allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Primary speed, rpm [default: 2000, or less to keep the secondary at 3000]
    #[arg(long, value_name = "RPM", allow_hyphen_values = true)]
    speed: Option<String>,
    /// Belt temperature, degC
    #[arg(
        long,
        value_name = "DEGC",
        default_value = "85",
        allow_hyphen_values = true
    )]
    temp: String,
    /// Torque at the secondary pulley, Nm [default: from 0 to beyond the torque capacity]
    #[arg(long, value_name = "NM", allow_hyphen_values = true)]
    torque: Option<String>,
    /// Pulses per turn of the speed sensors, for the resolution; not published for this rig (60 on the first one, 4.2.4)
    #[arg(
        long,
        value_name = "N",
        default_value = "60",
        allow_hyphen_values = true
    )]
    pulses: String,
    #[command(flatten)]
    formulation: FormulationArgs,
    #[command(flatten)]
    out: OutArgs,
    #[command(flatten)]
    output: TableOutputArgs,
}

impl Execute for RigVariatorArgs {
    type Plan = VariatorPlan;

    fn plan(&self, problems: &mut Problems) -> Option<VariatorPlan> {
        plan::plan(self, problems)
    }

    fn run(&self, mut plan: VariatorPlan, terminal: Terminal) -> CommandResult {
        let out = plan.out.take();
        let found = plan.solve();
        let files = WrittenFiles::write(out, |dir| {
            dir.write("curves.csv", |out| found.write_curves(out))?;
            dir.write("points.csv", |out| found.write_points(out))?;
            dir.write("summary.json", |out| found.write_json(out))?;
            for (name, svg) in variator_figures(&found) {
                dir.put(name, svg)?;
            }
            Ok("")
        })?;
        stream(
            &self.output,
            |out| found.write_json(out),
            |out| found.write_points(out),
        )?;
        let results = Results::new(String::new(), Vec::new(), files);
        Ok(results.table_output(&self.output, || tables(&found, terminal.stdout)))
    }
}

/// Table with a line for each curve, and the resolution of the speed sensors.
fn tables(found: &VariatorCurves, paint: Paint) -> String {
    let (vehicle, belt) = (paint.heading(&found.vehicle), &found.formulation);
    let mut text = format!("{vehicle}  variator alone, {belt}\n");
    for test in found.curves.chunk_by(Curve::is_same_test) {
        text += &one_test(test, paint);
    }
    let meaning = "break: breakpoint, where the compression between segments changes sign; capacity: torque capacity of the clamping \
        forces; largest slip up to it and to the limits of the rig; primary, secondary: slip speeds at 3 % slip; linear: R2 of \
        a straight line from the breakpoint to 3 %. The rig reads zero slip at zero torque: subtract the slip at 0 Nm to compare.";
    text + "\n" + &wrapped(meaning, "")
}

fn one_test(test: &[Curve], paint: Paint) -> String {
    let columns = TextColumns::new()
        .right("\nbar", |c: &Curve| plain(c.bar()))
        .number("break\nNm", 1, |c| c.summary.breakpoint_nm)
        .number("capacity\nNm", 1, |c| c.summary.capacity_nm)
        .number("slip at\n0 Nm %", 2, |c| 100.0 * c.summary.slip_at_zero)
        .number("slip at\ncapacity", 2, |c| {
            100.0 * c.summary.slip_at_capacity
        })
        .number("largest\n%", 2, |c| 100.0 * c.summary.most_slip)
        .number("at\nNm", 0, |c| c.summary.most_slip_nm)
        .number("3 % at\nNm", 1, |c| c.summary.three_percent_nm)
        .number("primary\nm/s", 3, |c| c.summary.three_percent_m_s[0])
        .number("secondary\nm/s", 3, |c| c.summary.three_percent_m_s[1])
        .number("linear\nR2", 3, |c| c.summary.measured_r2);
    let (heading, table) = (paint.heading(&test[0].test_name()), columns.text(test));
    let resolution = wrapped(&resolution(&test[0]), "  ");
    let mut text = format!("\n{heading}\n\n{table}\n{resolution}");
    let flagged = flags(test);
    if !flagged.is_empty() {
        text += &format!("  flagged points: {flagged}\n");
    }
    text
}

fn resolution(curve: &Curve) -> String {
    let r = &curve.resolution;
    let gate = if r.belt_turns {
        format!("100 turns of the belt take {} s", fixed(r.gate_s, 2))
    } else {
        let (segments, seconds) = (fixed(r.segments, 0), fixed(r.gate_s, 0));
        let share = percent(r.belt_per_segment, 1.0, 4);
        format!("{segments} segments in {seconds} s, one more is {share} % of belt speed")
    };
    let [primary, secondary] = r.slip_per_pulse.map(|slip| percent(slip, 1.0, 4));
    format!(
        "{gate}; one pulse of the primary or secondary sensor is {primary} or {secondary} % slip"
    )
}

fn flags(test: &[Curve]) -> String {
    let rows = || test.iter().flat_map(|curve| &curve.rows);
    let count = |flag: RigFlags| rows().filter(|row| row.flags.contains(flag)).count();
    let named = RigFlags::NAMES
        .iter()
        .map(|(flag, name)| (name, count(*flag)));
    let named = named.filter(|(_, n)| *n > 0);
    let flag_text = |(name, n)| format!("{name} {n} of {}", rows().count());
    named.map(flag_text).collect::<Vec<_>>().join(", ")
}
