//! Shift speeds for cycles that prescribe no gears.

/// Vehicle speeds at which a driver shifts, with hysteresis; one less than there are gears.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftSpeeds {
    /// Up from gear k to k+1 above `up_m_s[k-1]`, m/s.
    pub up_m_s: Vec<f64>,
    /// Down from gear k+1 to k below `down_m_s[k-1]`, m/s.
    pub down_m_s: Vec<f64>,
}

impl ShiftSpeeds {
    /// Gear at a speed, coming from `gear` (0: standing).
    pub fn for_speed(&self, speed_m_s: f64, gear: u8, count: usize) -> u8 {
        let last = count.min(self.up_m_s.len() + 1);
        let mut gear = usize::from(gear).clamp(1, last);
        while gear < last && speed_m_s > self.up_m_s[gear - 1] {
            gear += 1;
        }
        while gear > 1 && speed_m_s < self.down_m_s[gear - 2] {
            gear -= 1;
        }
        gear as u8
    }
}
