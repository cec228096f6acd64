//! Lip seals on the shafts that leave the box.
//!
//! | label | statement | status |
//! |---|---|---|
//! | LS-1 | T = 7.34e-5 d^2 Nm a seal, d in mm | source: ISO/TR 14179-2 (P = 7.69e-6 d^2 n W), in an open program of TU Munich |

/// The lip seals of one kind on a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LipSeal {
    /// Shaft on which they are, from 0.
    pub shaft: usize,
    /// How many.
    pub count: f64,
    /// Diameter of the shaft under the lip, m.
    pub diameter_m: f64,
}

impl LipSeal {
    /// Torque of all of them at their shaft, Nm (LS-1).
    pub fn torque_nm(&self) -> f64 {
        let d_mm = 1e3 * self.diameter_m;
        self.count * 7.34e-5 * d_mm * d_mm // LS-1
    }
}
