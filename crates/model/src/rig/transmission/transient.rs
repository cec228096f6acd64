//! Temperature transients (thesis 5.3.2): the box warms up by its own losses, then the rig's cooler takes it back.
//!
//! | label | statement | status |
//! |---|---|---|
//! | RT-1 | box on the rig: sump, metal, belt and case as in the car (TH-1); no heat from an engine, no cooler of the car, room air at rest | derived: thesis ch. 4 has a motor in the engine's place |
//! | RT-2 | rig's cooler: Q = m c_p (1 - exp(-U/(m c_p))) (T_sump - T_coolant) while cooling | source: heat exchanger with one side unlimited, flow printed in 4.6; U and coolant ASSUMED |
//!
//! Losses follow the sump and the belt's own temperature at the beginning of each second; the cooler's heat follows the sump there,
//! so that heat in = stored + to the air + to the cooler holds to rounding. Nothing drives the output shaft.

use super::conditions::Conditions;
use crate::drive::loss_heat_w;
use crate::math::exp;
use crate::rig::cvt_bench::Near;
use crate::rig::{AtRatio, Bench, BenchAnswer, BenchPoint};
use crate::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, HeatInput, METAL, Network, SUMP};
use crate::transmission::cvt::Series;

/// Step, s: the rig recorded once a second (thesis 5.3).
const STEP_S: f64 = 1.0;
/// A branch that takes longer has come to rest before its end.
pub const MAX_DURATION_S: f64 = 4.0 * 3600.0;

/// Seconds for which there is room from the start: most loops are shorter.
const USUAL_S: usize = 2500;

/// Half of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// By its own losses.
    Warming,
    /// By the rig's cooler, against its own losses.
    Cooling,
}

impl Branch {
    /// Word for tables.
    pub fn word(self) -> &'static str {
        match self {
            Branch::Warming => "warming",
            Branch::Cooling => "cooling",
        }
    }
}

/// One second of a transient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time from the start of the warm-up, s.
    pub time_s: f64,
    /// Warming or cooling.
    pub branch: Branch,
    /// Sump, K.
    pub sump_k: f64,
    /// Metal, K.
    pub metal_k: f64,
    /// The bench's answer at these temperatures.
    pub answer: BenchAnswer,
}

/// Energies of a loop, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopEnergy {
    /// Put in at the shaft.
    pub shaft_j: f64,
    /// Stored in sump, metal and belt.
    pub stored_j: f64,
    /// Given to the room.
    pub to_air_j: f64,
    /// Given to the rig's cooler.
    pub to_cooler_j: f64,
}

impl LoopEnergy {
    /// Imbalance over the energy put in.
    pub fn error(&self) -> f64 {
        (self.shaft_j - self.stored_j - self.to_air_j - self.to_cooler_j) / self.shaft_j
    }
}

/// A warm-up and the cooling after it.
#[derive(Clone, Debug, PartialEq)]
pub struct Loop {
    /// Belt ratio.
    pub ratio: f64,
    /// All seconds in order.
    pub moments: Vec<Moment>,
    /// Where the energy went.
    pub energy: LoopEnergy,
    /// True if both branches reached their ends.
    pub complete: bool,
    /// True if the sump only warms while warming and only cools while cooling.
    monotone: bool,
    /// Sump, K, and total loss, Nm, of each second: searched again and again.
    line: Vec<(f64, f64)>,
    /// The first second of cooling.
    cooling: usize,
}

impl Loop {
    /// Torque loss on a branch at a sump temperature, Nm, between neighbouring seconds; none where the branch does not come by.
    pub fn loss_nm(&self, branch: Branch, sump_k: f64) -> Option<f64> {
        let (before, share) = self.passed(branch, sump_k)?;
        let [(_, from), (_, to)] = [self.line[before], self.line[before + 1]];
        Some(from + share * (to - from))
    }

    /// Anything on a branch at a sump temperature.
    pub fn at(&self, branch: Branch, sump_k: f64, of: impl Fn(&Moment) -> f64) -> Option<f64> {
        let (before, share) = self.passed(branch, sump_k)?;
        let [from, to] = [&self.moments[before], &self.moments[before + 1]].map(of);
        Some(from + share * (to - from))
    }

    /// The second after which a branch first passes a sump temperature, and the share of the next one.
    fn passed(&self, branch: Branch, sump_k: f64) -> Option<(usize, f64)> {
        let rising = branch == Branch::Warming;
        let (first, on) = match rising {
            true => (0, &self.line[..self.cooling]),
            false => (self.cooling, &self.line[self.cooling..]),
        };
        // Where the sump goes one way only, the first pair around the temperature is found by bisection.
        let from = if self.monotone {
            on.partition_point(|(k, _)| if rising { *k < sump_k } else { *k > sump_k })
                .saturating_sub(1)
        } else {
            0
        };
        on[from..]
            .windows(2)
            .zip(from..)
            .find_map(|(pair, before)| {
                let (a, b) = (pair[0].0, pair[1].0);
                let share = (sump_k - a) / (b - a);
                (0.0..=1.0)
                    .contains(&share)
                    .then_some((first + before, share))
            })
    }

    /// Cooling over warming at a sump temperature, Nm.
    pub fn gap_nm(&self, sump_k: f64) -> Option<f64> {
        Some(self.loss_nm(Branch::Cooling, sump_k)? - self.loss_nm(Branch::Warming, sump_k)?)
    }

    /// Sump temperature at which the cooling branch comes down to within `near_nm` of the warming one, K; none if it never does.
    ///
    /// Looked for downwards from where the branches are furthest apart.
    pub fn meeting_k(&self, near_nm: f64) -> Option<f64> {
        let gaps = self.gaps();
        let widest = gaps
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.1.total_cmp(&b.1.1))
            .map(|(k, _)| k)?;
        gaps[..=widest]
            .iter()
            .rev()
            .find(|(_, gap)| *gap <= near_nm)
            .map(|(k, _)| *k)
    }

    /// Largest gap between the branches, Nm, and where, K.
    pub fn widest(&self) -> Option<(f64, f64)> {
        self.gaps()
            .into_iter()
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map(|(k, gap)| (gap, k))
    }

    /// Sump temperature, K, and gap, Nm, at every half kelvin that both branches come by.
    fn gaps(&self) -> Vec<(f64, f64)> {
        let from = self
            .moments
            .iter()
            .map(|m| m.sump_k)
            .fold(f64::INFINITY, f64::min);
        let to = self
            .moments
            .iter()
            .map(|m| m.sump_k)
            .fold(f64::NEG_INFINITY, f64::max);
        let count = if to > from {
            ((to - from) / 0.5).ceil() as u32
        } else {
            0
        };
        (0..=count)
            .map(|k| from + 0.5 * f64::from(k))
            .filter_map(|k| Some((k, self.gap_nm(k)?)))
            .collect()
    }
}

/// The car's network as it is on the rig (RT-1).
pub fn on_the_rig(car: &Network) -> Network {
    Network {
        coolant_oil_w_k: 0.0,
        block_air_w_k: 0.0,
        block_air_per_speed: 0.0,
        pan_air_w_k: 0.0,
        pan_air_per_speed: 0.0,
        radiator_w_k: 0.0,
        radiator_per_speed: 0.0,
        bell_housing_w_k: 0.0,
        exchanger_w_k: 0.0,
        cooler: None,
        under_bonnet: 0.0,
        ..car.clone() // RT-1
    }
}

/// The rig while a transient runs.
struct Running<'a> {
    bench: &'a Bench,
    at_ratio: AtRatio<'a>,
    conditions: &'a Conditions,
    network: Network,
    heat: Heat,
    time_s: f64,
    /// Seconds solved.
    seconds: u32,
    /// Slip of the seconds before, and the pressure of the last, Pa.
    slip: Series,
    pressure_pa: f64,
}

/// Warms the box up and cools it down again, without load.
pub fn transient(bench: &Bench, conditions: &Conditions, ratio: f64) -> Loop {
    let test = &conditions.transient;
    let heat = Heat::uniform(test.start_k);
    let mut running = Running {
        bench,
        conditions,
        at_ratio: bench.at_ratio(ratio),
        network: on_the_rig(&bench.car().network),
        heat,
        time_s: 0.0,
        seconds: 0,
        slip: Series::default(),
        pressure_pa: 0.0,
    };
    // The engine's nodes stay at room temperature: nothing leads to them.
    (
        running.heat.node_k[COOLANT],
        running.heat.node_k[ENGINE_OIL],
    ) = (conditions.room_k, conditions.room_k);
    let mut result = Loop {
        ratio,
        moments: Vec::with_capacity(USUAL_S),
        energy: LoopEnergy::default(),
        complete: true,
        monotone: true,
        line: Vec::with_capacity(USUAL_S),
        cooling: 0,
    };
    for (branch, until_k) in [
        (Branch::Warming, test.end_k),
        (Branch::Cooling, test.start_k),
    ] {
        let began = running.time_s;
        if branch == Branch::Cooling {
            result.cooling = result.moments.len();
        }
        loop {
            let moment = running.moment(branch);
            let total_nm = moment.answer.total_nm();
            result.line.push((moment.sump_k, total_nm));
            result.moments.push(moment);
            let there = if branch == Branch::Warming {
                moment.sump_k >= until_k
            } else {
                moment.sump_k <= until_k
            };
            if there || running.time_s - began >= MAX_DURATION_S {
                result.complete &= there;
                break;
            }
            running.step(&moment, &mut result.energy);
            let (before, after) = (moment.sump_k, running.heat.node_k[SUMP]);
            result.monotone &= if branch == Branch::Warming {
                before < after
            } else {
                before > after
            };
        }
    }
    result
}

impl Running<'_> {
    fn moment(&mut self, branch: Branch) -> Moment {
        let t = self.heat.node_k;
        let point = BenchPoint {
            input_rad_s: self.conditions.transient.speed_rad_s,
            throttle: self.conditions.throttle,
            sump_k: t[SUMP],
            belt_k: Some(t[BELT]),
            ..BenchPoint::default()
        };
        Moment {
            time_s: self.time_s,
            branch,
            sump_k: t[SUMP],
            metal_k: t[METAL],
            answer: self.solve(&point),
        }
    }

    /// Solves a second, begun where the seconds before lead: slip goes on smoothly.
    fn solve(&mut self, point: &BenchPoint) -> BenchAnswer {
        let near = self.seconds.checked_sub(1).map(|before| Near {
            slip: self.slip.next(before),
            pressure_pa: self.pressure_pa,
        });
        let answer = self.at_ratio.solve_near(point, near);
        let slip = answer.belt.map_or(0.0, |belt| belt.losses.slip_total);
        self.slip.push(slip);
        self.pressure_pa = answer.secondary_pa;
        self.seconds = self.seconds.saturating_add(1);
        answer
    }

    fn step(&mut self, moment: &Moment, energy: &mut LoopEnergy) {
        let car = self.bench.car();
        let w = self.conditions.transient.speed_rad_s;
        let loss_w = moment.answer.loss_nm.map(|nm| nm * w);
        let mut power_w = loss_heat_w(car, &loss_w);
        let oil_volume_heat_j_m3k =
            car.oil.density_kg_m3(moment.sump_k) * car.oil.heat_capacity_j_kgk(moment.sump_k);
        let to_cooler_w = if moment.branch == Branch::Cooling {
            self.cooler_w(moment.sump_k, oil_volume_heat_j_m3k)
        } else {
            0.0
        };
        power_w[SUMP] -= to_cooler_w;
        let step = self.network.advance(
            &self.heat,
            &HeatInput {
                power_w,
                ambient_k: self.conditions.room_k,
                speed_m_s: 0.0,
                pump_rad_s: w,
                oil_flow_m3_s: moment.answer.oil_flow_m3_s,
                oil_volume_heat_j_m3k,
                running: true,
                dt_s: STEP_S,
            },
        );
        energy.shaft_j += moment.answer.input_nm * w * STEP_S;
        energy.stored_j += step.stored_w * STEP_S;
        energy.to_air_j += step.to_air_w * STEP_S;
        energy.to_cooler_j += to_cooler_w * STEP_S;
        self.heat = step.heat;
        self.time_s += STEP_S;
    }

    /// Heat to the rig's cooler, W (RT-2).
    fn cooler_w(&self, sump_k: f64, oil_volume_heat_j_m3k: f64) -> f64 {
        let cooler = &self.conditions.cooler;
        let carried_w_k = cooler.flow_m3_s * oil_volume_heat_j_m3k;
        carried_w_k
            * (1.0 - exp(-cooler.conductance_w_k / carried_w_k))
            * (sump_k - cooler.coolant_k) // RT-2
    }
}
