//! Words to checked curves.

use cvtcycle::config::setup::{self, Options, Setup};
use cvtcycle::config::{Bound, Problems, to_si};
use cvtcycle::model::bench::solvable_ratios;
use cvtcycle::model::bench::variator::{
    CurveSummary, Held, MOST_RAD_S, Resolution, VariatorRig, VariatorRow,
};
use cvtcycle::model::transmission::cvt::variator::Formulation;
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::MAX_POINTS;

use super::Args;
use crate::args::ranges::{values, values_or_words};
use crate::args::{self as inputs, bad_value};
use crate::print::problem;

/// The rig's high ratio (thesis Appendix C; 5.5.1 refers to it).
const HIGH: f64 = 0.5;
/// Speed where none is given: chapter 6 prints none, Appendix C begins with it (ASSUMED).
const SPEED_RPM: f64 = 2000.0;
const SPEED: Bound = Bound::open_low(0.0, 10_000.0);
const PRESSURE: Bound = Bound::closed(0.0, 100.0);
const TEMP: Bound = Bound::closed(-40.0, 160.0);
const TORQUE: Bound = Bound::closed(-1000.0, 1000.0);
const PULSES: Bound = Bound::closed(1.0, 10_000.0);
/// Pressures of the thesis in low and in high ratio (6.4).
const LOW_BAR: [f64; 5] = [15.0, 20.0, 25.0, 30.0, 35.0];
const HIGH_BAR: [f64; 5] = [10.0, 10.5, 11.0, 11.5, 12.0];
/// How far past the capacity torque goes where none is given.
const PAST: f64 = 1.1;

/// Everything that the command needs, checked.
pub struct Plan {
    pub setup: Setup,
    pub rig: VariatorRig,
    pub formulation: String,
    pub set: Vec<String>,
    pub held: Vec<Held>,
    pub torque_nm: Option<Vec<f64>>,
    pub pulses: f64,
    pub out: Option<OutputDir>,
}

/// One curve with all that is known of it.
pub struct Curve {
    pub summary: CurveSummary,
    pub resolution: Resolution,
    pub rows: Vec<VariatorRow>,
}

impl Plan {
    /// Solves all curves.
    pub fn curves(&self) -> Vec<Curve> {
        self.held.iter().map(|held| self.curve(held)).collect()
    }

    fn curve(&self, held: &Held) -> Curve {
        let summary = self.rig.summary(held);
        let rows = match &self.torque_nm {
            Some(torques) => self.rig.rows(held, torques),
            None => self
                .rig
                .rows(held, &default_torques(held, summary.capacity_nm)),
        };
        let belt = &self.rig.cvt().belt;
        let idle = &self.rig.rows(held, &[0.0])[0];
        Curve {
            summary,
            resolution: Resolution::new(idle, belt.length_m, belt.segment_thickness_m, self.pulses),
            rows,
        }
    }
}

/// From nothing to past the capacity.
fn default_torques(held: &Held, capacity_nm: f64) -> Vec<f64> {
    let step = if held.ratio > 1.0 { 5.0 } else { 2.0 };
    let count = (PAST * capacity_nm / step).ceil().clamp(1.0, 1000.0) as u32;
    (0..=count).map(|i| step * f64::from(i)).collect()
}

/// Reads all arguments.
pub fn plan(args: &Args) -> Result<Plan, Problems> {
    let mut problems = Problems::default();
    let formulation = problems.take(inputs::word(
        "--formulation",
        &args.formulation,
        &Formulation::NAMES,
    ));
    let options = Options {
        lubricant: args.lubricant.clone(),
        set: args.set.clone(),
        formulation: formulation.unwrap_or_default(),
        ..Options::default()
    };
    let setup = problems.take(setup::load(&args.vehicle, "--vehicle", &options));
    let rig = setup.as_ref().and_then(|setup| VariatorRig::new(setup));
    if setup.is_some() && rig.is_none() {
        let hint = "name a vehicle with a CVT, such as rover_216_cvt";
        problems.add(problem(
            "--vehicle",
            &format!("{} has a manual box, which has no variator", args.vehicle),
            hint,
        ));
    }
    let limits = rig
        .as_ref()
        .map_or((0.1, 10.0), |rig| solvable_ratios(&rig.cvt().belt));
    let low = rig.as_ref().map_or(2.4, |rig| rig.cvt().ratio.low);
    let words = [("low", low), ("high", HIGH)];
    let ratios = problems.take(values_or_words(
        "--ratio",
        &args.ratio,
        Bound::closed(limits.0, limits.1),
        "",
        &words,
    ));
    let pressures = args.pressure.as_ref().map(|text| {
        problems
            .take(values("--pressure", text, PRESSURE, "_bar"))
            .unwrap_or_default()
    });
    let speeds = args.speed.as_ref().map(|text| {
        problems
            .take(values("--speed", text, SPEED, "_rpm"))
            .unwrap_or_default()
    });
    let temps = problems
        .take(values("--temp", &args.temp, TEMP, "_degc"))
        .unwrap_or_default();
    let torque_nm = args.torque.as_ref().map(|text| {
        problems
            .take(values("--torque", text, TORQUE, "_nm"))
            .unwrap_or_default()
    });
    let pulses = problems.take(inputs::number("--pulses", &args.pulses, PULSES, ""));
    let ratios = ratios.unwrap_or_default();
    let count =
        |list: &Option<Vec<f64>>, default: usize| list.as_ref().map_or(default, Vec::len) as f64;
    let curves = ratios.len() as f64
        * count(&pressures, LOW_BAR.len())
        * count(&speeds, 1)
        * temps.len() as f64;
    let points = curves * count(&torque_nm, 100);
    if points > MAX_POINTS as f64 {
        let message = format!("{curves:.0} curves with {points:.0} points");
        problems.add(bad_value(
            "rig variator",
            "",
            &format!("at most {MAX_POINTS} points"),
            message,
            "take larger steps or do it in parts".to_owned(),
        ));
    }
    let out = args
        .out
        .as_ref()
        .map(|dir| OutputDir::create(dir, args.force).map_err(Problems::from));
    let out = out.and_then(|dir| problems.take(dir));
    problems.finish()?;
    let (Some(setup), Some(rig), Some(pulses)) = (setup, rig, pulses) else {
        unreachable!("what is missing has left a problem")
    };
    let held = held(&ratios, pressures.as_deref(), speeds.as_deref(), &temps);
    Ok(Plan {
        setup,
        rig,
        formulation: args.formulation.clone(),
        set: args.set.clone(),
        held,
        torque_nm,
        pulses,
        out,
    })
}

/// Every combination, ratio outermost, pressure fastest.
fn held(
    ratios: &[f64],
    pressures: Option<&[f64]>,
    speeds: Option<&[f64]>,
    temps: &[f64],
) -> Vec<Held> {
    let mut list = Vec::new();
    for ratio in ratios {
        // No rig turns its secondary faster than its limit.
        let default_rad_s = to_si("_rpm", SPEED_RPM).min(MOST_RAD_S * ratio);
        let speeds = speeds.map_or_else(
            || vec![default_rad_s],
            |list| list.iter().map(|n| to_si("_rpm", *n)).collect(),
        );
        let own: &[f64] = if *ratio > 1.0 { &LOW_BAR } else { &HIGH_BAR };
        for input_rad_s in speeds {
            for temp in temps {
                for bar in pressures.unwrap_or(own) {
                    list.push(Held {
                        ratio: *ratio,
                        pressure_pa: to_si("_bar", *bar),
                        input_rad_s,
                        belt_k: to_si("_degc", *temp),
                    });
                }
            }
        }
    }
    list
}
