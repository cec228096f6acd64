//! The variator alone on its rig: slip against output torque at held ratio, pressure and speed (thesis chapter 6).
//!
//! | label | statement | status |
//! |---|---|---|
//! | RV-1 | v_belt = R_p w_p (1 - slip_p), w_s = w_p (1 - slip)/I, slip = slip_p + slip_s | derived: definitions of SL-5, SL-6 |
//! | RV-2 | pulse radii v_belt/w_p, v_belt/w_s; pulse ratio w_p/w_s | source: thesis 6.3.1, 6.4 |
//! | RV-3 | slip reading = I_pulse/I - 1; slip speeds R_p w_p - v_belt and v_belt - R_s w_s | source: thesis 6.3.3; secondary sign of its figures 8-36, 8-37 |
//! | RV-4 | zeroed: geometric ratio and radii are those of the pulse ratio at zero torque (GE-1 to GE-3) | source: thesis 6.3.2 |
//! | RV-5 | breakpoint C_x = 0 at T = -s R_s mu_b (2 F_p tan th + m v2 beta_p) | derived: TE-5 |
//!
//! 6.3.3 prints the secondary's difference the other way round, R_s w_s - v_belt; the text to the figures calls it negative where the pulley
//! runs ahead of the segments (8.7), which is the sign kept here. The geometric ratio is held: that the belt moves towards low under
//! load (6.4) is not modelled, so geometric radii are constant. Valid within Table 6-1; rows beyond it are flagged.

mod summary;

pub use summary::{CurveSummary, Resolution};

use crate::drive::Vehicle;
use crate::flags::flags;
use crate::lubricant::{Lubricant, VALID_K};
use crate::transmission::Transmission;
use crate::transmission::cvt::Cvt;
use crate::transmission::cvt::variator::{
    BeltAtRatio, BeltLoad, BeltState, Geometry, Tension, belt_state,
};

/// Largest torque at the secondary pulley, Nm (Table 6-1).
pub const MAX_OUTPUT_NM: f64 = 400.0;
/// Largest torque at the primary pulley, Nm (Table 6-1).
pub const MAX_INPUT_NM: f64 = 250.0;
/// Largest pressure, Pa (Table 6-1).
pub const MAX_PRESSURE_PA: f64 = 40e5;
/// Largest speed of either shaft, rad/s: 3000 rpm (Table 6-1).
pub const MAX_RAD_S: f64 = 100.0 * std::f64::consts::PI;
/// Passes of the fixed point of slip and secondary speed; it is done after two where the centrifugal head is compensated.
const PASSES: u32 = 40;

/// A variator on its rig.
#[derive(Clone, Debug)]
pub struct VariatorRig {
    cvt: Cvt,
    oil: Lubricant,
}

/// Values held along a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Held {
    /// Belt ratio.
    pub ratio: f64,
    /// Secondary pressure, Pa.
    pub pressure_pa: f64,
    /// Primary speed, rad/s.
    pub input_rad_s: f64,
    /// Belt temperature, K.
    pub belt_k: f64,
}

/// Source of the geometric radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// Pulse ratio at zero torque.
    pub ratio: f64,
    /// Primary and secondary radius for it, m.
    pub radius_m: [f64; 2],
}

flags! {
    /// States of a row and departures from what the rig can do.
    RigFlags {
        GROSS_SLIP = 0, "gross_slip", "Torque above what the clamping forces carry, or slip at its bound.";
        OUTPUT_TORQUE = 1, "rig_output_torque", "Secondary torque above the rig's.";
        INPUT_TORQUE = 2, "rig_input_torque", "Primary torque above the rig's.";
        PRESSURE = 3, "rig_pressure", "Pressure above the rig's.";
        SPEED = 4, "rig_speed", "A shaft faster than the rig's.";
        OUTSIDE_VALIDITY = 5, "outside_validity", "Temperature outside the fluid's range.";
    }
}

impl RigFlags {
    /// True within the rig's limits and within what the belt carries.
    pub fn is_fine(self) -> bool {
        self.0 == 0
    }

    /// Names of what is set, joined by `|`.
    pub fn text(self) -> String {
        self.names().collect::<Vec<_>>().join("|")
    }
}

/// One point of a curve; pairs are primary, secondary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VariatorRow {
    /// Values held.
    pub held: Held,
    /// Torque at the secondary pulley, Nm.
    pub output_nm: f64,
    /// The belt.
    pub belt: BeltState,
    /// Geometry of the held ratio.
    pub geometry: Geometry,
    /// Where the reading has its zero.
    pub zero: Zero,
    /// Speeds of the shafts, rad/s.
    pub shaft_rad_s: [f64; 2],
    /// Belt speed, m/s.
    pub belt_m_s: f64,
    /// Flags that apply.
    pub flags: RigFlags,
}

impl VariatorRow {
    /// Pulse ratio w_p/w_s.
    pub fn pulse_ratio(&self) -> f64 {
        self.held.ratio / (1.0 - self.belt.losses.slip_total) // RV-1: the quotient of the speeds, without their rounding
    }

    /// Radii from belt speed and shaft speed, m.
    pub fn pulse_radius_m(&self) -> [f64; 2] {
        self.shaft_rad_s.map(|w| self.belt_m_s / w) // RV-2
    }

    /// Slip as the rig reads it against the geometric ratio, a fraction.
    pub fn slip_reading(&self) -> f64 {
        self.pulse_ratio() / self.geometry.ratio - 1.0 // RV-3
    }

    /// The reading against the ratio of zero torque.
    pub fn slip_zeroed(&self) -> f64 {
        self.pulse_ratio() / self.zero.ratio - 1.0 // RV-4
    }

    /// Slip speeds at the pulleys, m/s.
    pub fn slip_m_s(&self) -> [f64; 2] {
        self.slip_speeds([
            self.geometry.primary_radius_m,
            self.geometry.secondary_radius_m,
        ])
    }

    /// Slip speeds with the radii of zero torque, m/s.
    pub fn slip_zeroed_m_s(&self) -> [f64; 2] {
        self.slip_speeds(self.zero.radius_m) // RV-4
    }

    fn slip_speeds(&self, radius_m: [f64; 2]) -> [f64; 2] {
        let [w_p, w_s] = self.shaft_rad_s;
        [
            radius_m[0] * w_p - self.belt_m_s,
            self.belt_m_s - radius_m[1] * w_s,
        ] // RV-3
    }
}

impl VariatorRig {
    /// Takes the variator out of a vehicle's box; none for a manual box.
    pub fn new(vehicle: &Vehicle) -> Option<Self> {
        match vehicle.transmission() {
            Transmission::Cvt(cvt) => Some(VariatorRig {
                cvt: (**cvt).clone(),
                oil: vehicle.oils().0.clone(),
            }),
            Transmission::Manual(_) => None,
        }
    }

    /// Belt, pulleys and limits.
    pub fn cvt(&self) -> &Cvt {
        &self.cvt
    }

    /// Clamping and friction at a point, with the slip of the pass before.
    fn load(&self, held: &Held, output_nm: f64, slip: f64) -> BeltLoad {
        let belt = &self.cvt.belt;
        BeltLoad {
            output_torque_nm: output_nm,
            secondary_clamp_n: self.cvt.secondary_clamp_n(
                held.pressure_pa,
                held.input_rad_s * (1.0 - slip) / held.ratio,
            ),
            ..BeltLoad::turning(belt, &self.oil, held.belt_k, held.ratio, held.input_rad_s)
        }
    }

    fn state(&self, held: &Held, at: &BeltAtRatio, output_nm: f64) -> BeltState {
        let mut state = belt_state(&self.cvt.belt, at, &self.load(held, output_nm, 0.0));
        for _ in 0..PASSES {
            let next = belt_state(
                &self.cvt.belt,
                at,
                &self.load(held, output_nm, state.losses.slip_total),
            );
            let still = (next.losses.slip_total - state.losses.slip_total).abs() <= 1e-14;
            state = next;
            if still {
                break;
            }
        }
        state
    }

    /// One point of a curve; [`VariatorRig::zero`] gives the zero of its reading.
    fn row(&self, held: &Held, at: &BeltAtRatio, zero: &Zero, output_nm: f64) -> VariatorRow {
        let belt = self.state(held, at, output_nm);
        let w_p = held.input_rad_s;
        let w_s = w_p * (1.0 - belt.losses.slip_total) / held.ratio; // RV-1
        let over = |x: f64, most: f64| x.abs() > most * (1.0 + 1e-9);
        let mut flags = RigFlags::default();
        flags.set(RigFlags::GROSS_SLIP, belt.losses.gross_slip);
        flags.set(RigFlags::OUTPUT_TORQUE, over(output_nm, MAX_OUTPUT_NM));
        flags.set(
            RigFlags::INPUT_TORQUE,
            over(belt.input_torque_nm, MAX_INPUT_NM),
        );
        flags.set(RigFlags::PRESSURE, over(held.pressure_pa, MAX_PRESSURE_PA));
        flags.set(
            RigFlags::SPEED,
            over(w_p, MAX_RAD_S) || over(w_s, MAX_RAD_S),
        );
        flags.set(RigFlags::OUTSIDE_VALIDITY, !VALID_K.contains(&held.belt_k));
        VariatorRow {
            held: *held,
            output_nm,
            belt,
            geometry: at.geometry,
            zero: *zero,
            shaft_rad_s: [w_p, w_s],
            belt_m_s: at.geometry.primary_radius_m * w_p * (1.0 - belt.slip.primary), // RV-1
            flags,
        }
    }

    /// Where the rig's reading has its zero: slip is taken to be none at zero torque (RV-4).
    fn zero(&self, held: &Held, at: &BeltAtRatio) -> Zero {
        let ratio = held.ratio / (1.0 - self.state(held, at, 0.0).losses.slip_total);
        let g = Geometry::new(
            ratio,
            self.cvt.belt.centre_distance_m,
            self.cvt.belt.length_m,
        );
        Zero {
            ratio,
            radius_m: [g.primary_radius_m, g.secondary_radius_m],
        }
    }

    /// Rows of a curve at given torques, Nm at the secondary, in their order.
    pub fn rows(&self, held: &Held, output_nm: &[f64]) -> Vec<VariatorRow> {
        let at = BeltAtRatio::new(&self.cvt.belt, held.ratio);
        let zero = self.zero(held, &at);
        output_nm
            .iter()
            .map(|torque| self.row(held, &at, &zero, *torque))
            .collect()
    }

    /// Torque at which the compression between segments changes sign, Nm at the secondary (RV-5); negative in high ratio.
    pub fn breakpoint_nm(&self, held: &Held) -> f64 {
        let belt = &self.cvt.belt;
        let at = BeltAtRatio::new(belt, held.ratio);
        // The slip at the breakpoint acts on an uncompensated centrifugal head only: two passes are plenty.
        let mut torque = 0.0;
        for _ in 0..3 {
            let load = self.load(
                held,
                torque,
                self.state(held, &at, torque).losses.slip_total,
            );
            let step_n = Tension::bare_step_n(belt, &at, &load);
            torque = at.geometry.secondary_radius_m * step_n; // RV-5
        }
        torque
    }
}
