//! Arguments of `rig variator` to checked curves.

use cvtcycle::config::setup::Setup;
use cvtcycle::config::{Bound, Problems, to_si};
use cvtcycle::model::bench::solvable_ratios;
use cvtcycle::model::bench::variator::{
    CurveSummary, Held, MAX_RAD_S, Resolution, VariatorRig, VariatorRow,
};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::losses::MAX_POINTS;

use super::RigVariatorArgs;
use crate::args::number;
use crate::args::problems::bad_value;
use crate::args::ranges::{values, values_or_words};

/// Default ratios.
pub const RATIOS: &str = "low,high";
/// High ratio of the rig (thesis Appendix C; 5.5.1 refers to it).
const HIGH: f64 = 0.5;
/// Default speed: chapter 6 prints none, Appendix C begins with this one (ASSUMED).
const SPEED_RPM: f64 = 2000.0;
const SPEED: Bound = Bound::open_low(0.0, 10_000.0);
const PRESSURE: Bound = Bound::closed(0.0, 100.0);
const TEMP: Bound = Bound::closed(-40.0, 160.0);
const TORQUE: Bound = Bound::closed(-1000.0, 1000.0);
const PULSES: Bound = Bound::closed(1.0, 10_000.0);
/// Pressures of the thesis in low and in high ratio (6.4).
const LOW_BAR: [f64; 5] = [15.0, 20.0, 25.0, 30.0, 35.0];
const HIGH_BAR: [f64; 5] = [10.0, 10.5, 11.0, 11.5, 12.0];
/// Largest default torque over the torque capacity.
const MAX_TORQUE: f64 = 1.1;

/// Checked input of `rig variator`.
pub struct VariatorPlan {
    pub setup: Setup,
    pub rig: VariatorRig,
    pub formulation: String,
    pub set: Vec<String>,
    pub held: Vec<Held>,
    pub torque_nm: Option<Vec<f64>>,
    pub pulses: f64,
    pub out: Option<OutputDir>,
}

/// One curve with its points.
pub struct Curve {
    pub summary: CurveSummary,
    pub resolution: Resolution,
    pub rows: Vec<VariatorRow>,
}

impl VariatorPlan {
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

/// From zero to beyond the torque capacity.
fn default_torques(held: &Held, capacity_nm: f64) -> Vec<f64> {
    let step = if held.ratio > 1.0 { 5.0 } else { 2.0 };
    let count = (MAX_TORQUE * capacity_nm / step).ceil().clamp(1.0, 1000.0) as u32;
    (0..=count).map(|i| step * f64::from(i)).collect()
}

/// Checks all arguments.
pub fn plan(args: &RigVariatorArgs, problems: &mut Problems) -> Option<VariatorPlan> {
    let formulation = args.formulation.get(problems);
    let setup = args.car.load(formulation, problems);
    let rig = setup.as_ref().and_then(|setup| VariatorRig::new(setup));
    if setup.is_some() && rig.is_none() {
        problems.add(
            args.car
                .needs_cvt("name a vehicle with a CVT, such as rover_216_cvt"),
        );
    }
    // Without a rig the values are checked against limits that any belt meets.
    let (limits, low) = rig.as_ref().map_or(((0.1, 10.0), 2.4), |rig| {
        (solvable_ratios(&rig.cvt().belt), rig.cvt().ratio.low)
    });
    let words = [("low", low), ("high", HIGH)];
    let range = Bound::closed(limits.0, limits.1);
    let ratios = values_or_words("--ratio", &args.ratio, range, "", &words);
    let ratios = problems.take(ratios).unwrap_or_default();
    let mut list = |option: &str, text: &str, range: Bound, suffix: &str| {
        problems
            .take(values(option, text, range, suffix))
            .unwrap_or_default()
    };
    let pressures = args
        .pressure
        .as_ref()
        .map(|text| list("--pressure", text, PRESSURE, "_bar"));
    let speeds = args
        .speed
        .as_ref()
        .map(|text| list("--speed", text, SPEED, "_rpm"));
    let temps = list("--temp", &args.temp, TEMP, "_degc");
    let torque_nm = args
        .torque
        .as_ref()
        .map(|text| list("--torque", text, TORQUE, "_nm"));
    let pulses = problems.take(number("--pulses", &args.pulses, PULSES, ""));
    let held = held(&ratios, pressures.as_deref(), speeds.as_deref(), &temps);
    let points = held.len() * torque_nm.as_ref().map_or(100, Vec::len);
    if points > MAX_POINTS {
        let message = format!("{} curves with {points} points", held.len());
        let allowed = format!("at most {MAX_POINTS} points");
        problems.add(bad_value(
            "rig variator",
            "",
            &allowed,
            &message,
            "use larger steps or several runs",
        ));
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

/// Every combination, ratio outermost, pressure fastest.
fn held(
    ratios: &[f64],
    pressures: Option<&[f64]>,
    speeds: Option<&[f64]>,
    temps: &[f64],
) -> Vec<Held> {
    let mut list = Vec::new();
    for ratio in ratios {
        // The secondary stays below the speed limit of the rig.
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
