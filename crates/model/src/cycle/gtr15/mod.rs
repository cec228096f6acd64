//! Gears of a manual car on the WLTC, second by second: the procedure of UN GTR No 15, Annex 2.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GS-1 | n = ndv v; a gear below that of the highest speed may reach n95, the highest speed with 95 % of rated power, the others ndv v_max of the cycle; highest speed: road load at 90 % of full load, in the highest gear that reaches no less than the one below | source: UN GTR 15, Annex 2, 2 |
//! | GS-2 | least n: idle in first, 0.9 idle in second (idle before a standstill), above n_idle + 0.125 (n_rated - n_idle), rounded; below them the clutch is open or slips, at idle or at 1.15 idle | source: as GS-1 |
//! | GS-3 | enough power: P_wot(n) (1 - SM - ASM) >= (f0 v + f1 v2 + f2 v3 + 1.03 m a v); first and second gear always, and the possible gear with the most | source: as GS-1, 3.4; SM 0.1 |
//! | GS-4 | first choice: the highest possible gear with enough power; none at rest, first gear a second before a start and until second is chosen, second only from 1.15 idle after first | source: as GS-1, 3.5 |
//! | GS-5 | corrections, twice: no gear above what the rest of an acceleration needs; each gear for two seconds, one after the other; no excursion of up to four seconds; no rise in a deceleration; clutch open for a gear of one or two seconds and for first gear before a standstill | source: as GS-1, 4; order and conditions ASSUMED as in the reference program of the regulation |
//! | GS-6 | phases: rise, fall, constant (0.001 km/h), rest (below 1 km/h); a rise or fall of up to two seconds is none | source: as GS-1, 4 |
//!
//! One sample a second, speeds in km/h, engine speeds in rpm and powers in kW, as the regulation rounds them. Labels are at the lines of code.

mod coast;
mod phases;
mod possible;
mod repair;

use self::coast::open_clutch;
use self::phases::Phases;
use self::possible::Possible;
use self::repair::Schedule;
use super::GearCommand;

/// Data of a car for the procedure.
#[derive(Clone, Debug, PartialEq)]
pub struct GtrVehicle {
    /// Test mass, kg.
    pub test_mass_kg: f64,
    /// Road load: N, N/(km/h), N/(km/h)2.
    pub load: [f64; 3],
    /// Idling speed, rpm.
    pub idle_rpm: f64,
    /// Full load: speed in rpm, power in kW, additional safety margin ASM; linear between.
    pub full_load: Vec<[f64; 3]>,
    /// Engine speed over car speed in each gear, from first, rpm/(km/h).
    pub rpm_per_kmh: Vec<f64>,
    /// Safety margin SM on full load.
    pub safety: f64,
    /// Limits of the maker.
    pub maker: MakerLimits,
}

/// Limits of the maker; 0 where there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MakerLimits {
    /// Highest engine speed, rpm.
    pub highest_rpm: f64,
    /// Least engine speed above second gear: always, speeding up, slowing down, rpm.
    pub least_rpm: [f64; 3],
    /// The same in the start phase, speeding up and slowing down, rpm.
    pub start_rpm: [f64; 2],
    /// End of the start phase, s.
    pub start_s: f64,
}

/// Safety margin of the regulation.
pub const SAFETY: f64 = 0.1;

/// The gears of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct GtrGears {
    /// Gear of each second, 0 for none.
    pub gear: Vec<u8>,
    /// True with the clutch open or slipping.
    pub clutch: Vec<bool>,
    /// True in a second of a deceleration.
    slows: Vec<bool>,
    /// Highest speed of gears below that of the highest car speed, rpm (GS-1).
    pub n95_rpm: f64,
    /// Highest speed of the other gears, rpm (GS-1).
    pub highest_rpm: f64,
    /// The gear of the highest car speed, and that speed in km/h.
    pub top: (u8, f64),
}

/// The gears of a car on a trace of one speed in km/h a second.
#[must_use]
pub fn gears(trace_kmh: &[f64], car: &GtrVehicle) -> GtrGears {
    let phases = Phases::new(trace_kmh);
    let possible = Possible::new(trace_kmh, car, &phases);
    let limits = possible.limits;
    let mut schedule = Schedule::new(trace_kmh, possible, &phases);
    // Corrections may open the way for others: twice, as the regulation has it (GS-5).
    for _ in 0..2 {
        schedule.repair();
        open_clutch(&mut schedule);
    }
    let last = car.rpm_per_kmh.len() as i32;
    let clutch = schedule.clutch.iter().zip(&schedule.gear).enumerate();
    GtrGears {
        clutch: clutch
            .map(|(t, (open, gear))| *open || schedule.possible.slips(t, *gear))
            .collect(),
        // A second without a possible gear is driven in the highest.
        gear: schedule
            .gear
            .iter()
            .map(|gear| if *gear < 0 { last } else { *gear } as u8)
            .collect(),
        slows: phases.slows.clone(),
        n95_rpm: limits.n95_rpm,
        highest_rpm: limits.highest_rpm,
        top: (limits.top_gear as u8 + 1, limits.top_kmh),
    }
}

impl GtrGears {
    /// Action of the driver in each second. A gear change is driven in the gear that follows it; the last gear before a standstill may be none.
    #[must_use]
    pub fn commands(&self, trace_kmh: &[f64]) -> Vec<GearCommand> {
        let mut next = 0;
        let mut list: Vec<GearCommand> = Vec::with_capacity(self.gear.len());
        for t in (0..self.gear.len()).rev() {
            let gear = self.gear[t];
            let at_rest = trace_kmh[t] < phases::REST_KMH;
            list.push(match gear {
                0 if at_rest || next == 0 => GearCommand::Neutral,
                0 => GearCommand::Change(next),
                gear if self.clutch[t] && self.slows[t] => GearCommand::Declutched(gear),
                gear => GearCommand::InGear(gear),
            });
            next = match gear {
                _ if at_rest => 0,
                0 => next,
                gear => gear,
            };
        }
        list.reverse();
        list
    }
}
