//! Settings of the transmission rig.

/// Most speeds of one test.
const MAX_SPEEDS: f64 = 400.0;

/// Speeds of a test, rad/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Lowest.
    pub from_rad_s: f64,
    /// Highest.
    pub to_rad_s: f64,
    /// Step.
    pub step_rad_s: f64,
}

impl Speeds {
    /// All speeds, ascending, rad/s.
    pub fn list(&self) -> Vec<f64> {
        // A thousandth of a step for what was lost in rounding.
        let count = ((self.to_rad_s - self.from_rad_s) / self.step_rad_s + 1e-3)
            .floor()
            .clamp(0.0, MAX_SPEEDS) as u32;
        (0..=count)
            .map(|k| self.from_rad_s + f64::from(k) * self.step_rad_s)
            .collect()
    }
}

/// Pressure of each test over that of the complete box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureFactors {
    /// Without the final drive.
    pub final_drive_removed: f64,
    /// Without the belt.
    pub belt_removed: f64,
    /// Without the plates of the reverse clutch.
    pub clutch_removed: f64,
    /// Second box.
    pub second_box: f64,
}

/// The warm-up and cooling runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransientTest {
    /// Input speed, rad/s.
    pub speed_rad_s: f64,
    /// Everything at the beginning, and the sump at the end of cooling, K.
    pub start_k: f64,
    /// Sump at the end of the warm-up, K.
    pub end_k: f64,
}

/// The rig's oil cooler (RT-2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigCooler {
    /// Oil flow, m3/s.
    pub flow_m3_s: f64,
    /// Conductance of the heat exchanger, W/K.
    pub conductance_w_k: f64,
    /// Coolant, K.
    pub coolant_k: f64,
}

/// Everything that the rig is set to.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditions {
    /// Low ratio.
    pub low_ratio: f64,
    /// High ratio of the rig.
    pub high_ratio: f64,
    /// Speeds in low ratio.
    pub low_speeds: Speeds,
    /// Speeds in high ratio.
    pub high_speeds: Speeds,
    /// Temperatures of the bulk oil, K.
    pub oil_k: Vec<f64>,
    /// Torques at the output shaft, Nm.
    pub torques_nm: Vec<f64>,
    /// Throttle that the clamp law sees, 0..1.
    pub throttle: f64,
    /// Pressures of the tests.
    pub pressure: PressureFactors,
    /// Transients.
    pub transient: TransientTest,
    /// Room, K.
    pub room_k: f64,
    /// Oil cooler.
    pub cooler: RigCooler,
    /// Error of the torque transducer, Nm.
    pub transducer_nm: f64,
}

impl Conditions {
    /// Name of a ratio: low, high, or its number.
    pub fn ratio_name(&self, ratio: f64) -> String {
        let is = |other: f64| (ratio - other).abs() < 1e-9;
        if is(self.low_ratio) {
            "low".to_owned()
        } else if is(self.high_ratio) {
            "high".to_owned()
        } else {
            format!("{ratio}")
        }
    }

    /// Speeds at which a ratio is tested: the short range in the rig's high ratio and beyond, the long one else.
    pub fn speeds(&self, ratio: f64) -> Speeds {
        if ratio <= self.high_ratio {
            self.high_speeds
        } else {
            self.low_speeds
        }
    }
}
