//! Arguments of `rig variator` to checked curves.

use cvtcycle::config::setup::Setup;
use cvtcycle::config::{Bound, Problems, to_si};
use cvtcycle::model::rig::solvable_ratios;
use cvtcycle::model::rig::variator::{Held, MAX_RAD_S, VariatorRig};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::MAX_POINTS;
use cvtcycle::output::variator::{Curve, VariatorCurves};

use super::RigVariatorArgs;
use crate::args::number;
use crate::args::problems::bad_value;
use crate::args::ranges::{values, values_or_words};

/// Default ratios.
pub const RATIOS: &str = "low,high";
/// High ratio of the rig (thesis Appendix C; 5.5.1 refers to it).
const HIGH: f64 = 0.5;
/// Default speed, rpm. Chapter 6 prints none; Appendix C starts with this one (ASSUMED).
const SPEED_RPM: f64 = 2000.0;
const SPEED: Bound = Bound::open_low(0.0, 10_000.0);
const PRESSURE: Bound = Bound::closed(0.0, 100.0);
const TEMP: Bound = Bound::closed(-40.0, 160.0);
const TORQUE: Bound = Bound::closed(-1000.0, 1000.0);
const PULSES: Bound = Bound::closed(1.0, 10_000.0);
/// Pressures of the thesis at low and at high ratio (6.4).
const LOW_BAR: [f64; 5] = [15.0, 20.0, 25.0, 30.0, 35.0];
const HIGH_BAR: [f64; 5] = [10.0, 10.5, 11.0, 11.5, 12.0];

/// Checked input of `rig variator`.
pub struct VariatorPlan {
    setup: Setup,
    rig: VariatorRig,
    formulation: String,
    set: Vec<String>,
    held: Vec<Held>,
    torque_nm: Option<Vec<f64>>,
    pulses: f64,
    pub out: Option<OutputDir>,
}

impl VariatorPlan {
    /// Solves all curves.
    pub fn solve(self) -> VariatorCurves {
        let torques = self.torque_nm.as_deref();
        let curve = |held: &Held| Curve::solve(&self.rig, held, torques, self.pulses);
        VariatorCurves {
            curves: self.held.iter().map(curve).collect(),
            lubricant: self.setup.oils().0.name.clone(),
            vehicle: self.setup.name,
            formulation: self.formulation,
            set: self.set,
            pulses: self.pulses,
        }
    }
}

/// Checks all arguments.
pub fn plan(args: &RigVariatorArgs, problems: &mut Problems) -> Option<VariatorPlan> {
    let formulation = args.formulation.get(problems);
    let setup = args.car.load(formulation, problems);
    let rig = setup.as_ref().and_then(|setup| VariatorRig::new(setup));
    let hint = "name a vehicle with a CVT, such as rover_216_cvt";
    args.car.need_cvt(setup.as_ref(), hint, problems);
    // Without a rig, after a problem with the vehicle, checks against limits valid for any belt.
    let (limits, low) = rig.as_ref().map_or(((0.1, 10.0), 2.4), |rig| {
        (solvable_ratios(&rig.cvt().belt), rig.cvt().ratio.low)
    });
    let words = [("low", low), ("high", HIGH)];
    let range = Bound::closed(limits.0, limits.1);
    let ratios = values_or_words("--ratio", &args.ratio, range, "", &words);
    let ratios = problems.take(ratios).unwrap_or_default();
    let mut list = |option: &str, text: Option<&String>, range: Bound, suffix: &str| {
        let found = problems.take(values(option, text?, range, suffix));
        Some(found.unwrap_or_default())
    };
    let pressures = list("--pressure", args.pressure.as_ref(), PRESSURE, "_bar");
    let speeds = list("--speed", args.speed.as_ref(), SPEED, "_rpm");
    let temps = list("--temp", Some(&args.temp), TEMP, "_degc").unwrap_or_default();
    let torque_nm = list("--torque", args.torque.as_ref(), TORQUE, "_nm");
    let pulses = problems.take(number("--pulses", &args.pulses, PULSES, ""));
    let held = held(&ratios, pressures.as_deref(), speeds.as_deref(), &temps);
    let points = held.len() * torque_nm.as_ref().map_or(100, Vec::len);
    if points > MAX_POINTS {
        let message = format!("{} curves with {points} points", held.len());
        let allowed = format!("at most {MAX_POINTS} points");
        let hint = "use larger steps or several runs";
        problems.add(bad_value("rig variator", "", &allowed, &message, hint));
    }
    Some(VariatorPlan {
        out: args.out.dir(problems),
        setup: setup?,
        rig: rig?,
        formulation: args.formulation.formulation.clone(),
        set: args.car.set.clone(),
        held,
        torque_nm,
        pulses: pulses?,
    })
}

/// All combinations: ratio in the outermost loop, pressure in the innermost.
fn held(
    ratios: &[f64],
    pressures: Option<&[f64]>,
    speeds: Option<&[f64]>,
    temps: &[f64],
) -> Vec<Held> {
    let mut list = Vec::new();
    for ratio in ratios {
        // Keeps the secondary below the speed limit of the rig.
        let default_rad_s = to_si("_rpm", SPEED_RPM).min(MAX_RAD_S * ratio);
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
