//! The trace of a car on a cycle: the gears of a manual box, and the WLTC that is the car's own.
//!
//! | label | statement | status |
//! |---|---|---|
//! | CY-2 | WLTC by rated power over mass without payload: class 3 above 34 W/kg, 3b if 90 % of rated power meets the road load at 120 km/h, else 3a; class 2 above 22 W/kg; else class 1 | source: UN GTR 15, Annex 1; the maker's highest speed, which it means, ASSUMED from power |

use std::borrow::Cow;

use super::Vehicle;
use crate::cycle::gears::GearColumns;
use crate::cycle::gtr15::{self, GtrVehicle, MakerLimits};
use crate::cycle::{Cycle, Trace};
use crate::keys::rpm;
use crate::transmission::Transmission;

/// Power over mass above which a car is of class 3 and of class 2, W/kg.
const CLASSES_W_KG: [f64; 2] = [34.0, 22.0];
/// Highest speed from which a car of class 3 is of class 3b, km/h.
const CLASS_3B_KMH: f64 = 120.0;
/// Share of rated power at the wheels.
const AT_WHEELS: f64 = 0.9;

/// The trace of a car, and what decides its gears.
#[derive(Clone, Debug)]
pub struct CarTrace<'c> {
    /// The cycle's own, or one with the gears of this car.
    pub trace: Cow<'c, Trace>,
    /// Gear schedule in words; empty for a CVT.
    pub schedule: &'static str,
}

/// The WLTC of a car (CY-2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WltcClass {
    /// Name of the cycle.
    pub cycle: &'static str,
    /// Rated power over mass without payload, W/kg.
    pub w_per_kg: f64,
    /// True if 90 % of rated power meets the road load at 120 km/h.
    pub reaches_120_kmh: bool,
}

impl Vehicle {
    /// The trace that the car drives. A manual box takes the gears of the cycle, on a WLTC those of UN GTR 15, Annex 2 (GS-1 to GS-6), else its
    /// own shift speeds.
    pub fn trace<'c>(&self, cycle: &'c Cycle) -> CarTrace<'c> {
        let Transmission::Manual(manual) = self.transmission() else {
            let trace = Cow::Borrowed(cycle.trace_for(true));
            return CarTrace {
                trace,
                schedule: "",
            };
        };
        let trace = cycle.trace_for(false);
        if let Some(car) = self.gtr15().filter(|_| cycle.is_wltc && !trace.has_gears()) {
            let trace = Cow::Owned(with_gears(trace, &car));
            let schedule = "gears by UN GTR 15, Annex 2";
            return CarTrace { trace, schedule };
        }
        let schedule = if trace.gears(manual.overall.len()).is_some() {
            "gears prescribed by the cycle"
        } else if trace.has_gears() {
            "shift speeds of the vehicle file: the cycle's gear column does not fit this box"
        } else {
            "shift speeds of the vehicle file"
        };
        CarTrace {
            trace: Cow::Borrowed(trace),
            schedule,
        }
    }

    /// Number of gears; 0 of a car without a manual box.
    pub fn gear_count(&self) -> usize {
        match self.transmission() {
            Transmission::Manual(manual) => manual.overall.len(),
            Transmission::Cvt(_) => 0,
        }
    }

    /// Data of the car for UN GTR 15, Annex 2; `None` without a manual box.
    pub fn gtr15(&self) -> Option<GtrVehicle> {
        let Transmission::Manual(manual) = self.transmission() else {
            return None;
        };
        let (engine, load) = (self.engine(), &self.road_load.base);
        let points = engine.full_load.points();
        // Revolutions a minute of the wheels at 1 km/h.
        let wheel_rpm = 1000.0 / 60.0 / (2.0 * std::f64::consts::PI * load.wheel_radius_m);
        Some(GtrVehicle {
            test_mass_kg: load.mass_kg,
            load: [
                load.f0_n,
                load.f1_n_per_m_s / 3.6,
                load.f2_n_per_m_s2 / (3.6 * 3.6),
            ],
            idle_rpm: rpm(engine.idle_hot_rad_s),
            full_load: points.map(|(w, nm)| [rpm(w), w * nm / 1e3, 0.0]).collect(),
            rpm_per_kmh: manual
                .overall
                .iter()
                .map(|ratio| ratio * wheel_rpm)
                .collect(),
            safety: gtr15::SAFETY,
            maker: MakerLimits::default(),
        })
    }

    /// The WLTC of the car (CY-2).
    pub fn wltc(&self) -> WltcClass {
        let (engine, input) = (self.engine(), &self.road_load);
        let load = &input.base;
        let w_per_kg = engine.rated_w / (load.mass_kg - input.payload_kg);
        let v = CLASS_3B_KMH / 3.6;
        let force_n = load.f0_n + (load.f1_n_per_m_s + load.f2_n_per_m_s2 * v) * v;
        let reaches_120_kmh = AT_WHEELS * engine.rated_w >= force_n * v;
        let cycle = match (w_per_kg > CLASSES_W_KG[0], w_per_kg > CLASSES_W_KG[1]) {
            (true, _) if reaches_120_kmh => "wltc_class3b",
            (true, _) => "wltc_class3a",
            (false, true) => "wltc_class2",
            (false, false) => "wltc_class1",
        }; // CY-2
        WltcClass {
            cycle,
            w_per_kg,
            reaches_120_kmh,
        }
    }
}

/// A trace of one interval a second with the gears of a car.
fn with_gears(trace: &Trace, car: &GtrVehicle) -> Trace {
    let first = trace.intervals.first().map(|i| i.start_speed_m_s);
    let ends = trace.intervals.iter().map(|i| i.end_speed_m_s);
    let kmh: Vec<f64> = first.into_iter().chain(ends).map(|v| v * 3.6).collect();
    let mut commands = gtr15::gears(&kmh, car).commands(&kmh);
    commands.truncate(trace.intervals.len());
    let mut shifted = trace.clone();
    *shifted.gear_columns_mut() = GearColumns::new(None, None, Some(commands));
    shifted
}
