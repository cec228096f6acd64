//! Causes of the secondary pressure of a CVT.

/// Cause of the secondary pressure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(usize)]
pub enum ClampCause {
    /// The clamp law.
    #[default]
    Law,
    /// Valves and lubrication.
    Control,
    /// Forward clutch.
    Clutch,
    /// Strands that keep the segments in line.
    Belt,
    /// Shift towards low.
    ShiftDown,
    /// Shift towards high.
    ShiftUp,
    /// The largest pressure.
    Cap,
}

impl ClampCause {
    /// The cause as a number, which masks can select; [`ClampCause::from_number`] is the way back.
    #[crate::math::physics]
    pub(crate) const fn number(self) -> f64 {
        self as u8 as f64
    }

    /// The cause of a number.
    pub(crate) fn from_number(number: f64) -> Self {
        Self::NAMES[number as usize].0
    }

    /// All causes with their names in files.
    pub const NAMES: [(ClampCause, &'static str); 7] = [
        (ClampCause::Law, "law"),
        (ClampCause::Control, "control"),
        (ClampCause::Clutch, "clutch"),
        (ClampCause::Belt, "belt"),
        (ClampCause::ShiftDown, "shift_down"),
        (ClampCause::ShiftUp, "shift_up"),
        (ClampCause::Cap, "cap"),
    ];

    /// Name as in files.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].1
    }
}
