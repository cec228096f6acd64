//! States of a time step and departures from the validity of the models.

/// States and departures from validity of a row, as a bit set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(pub u32);

impl Flags {
    /// The car cannot follow the trace: engine at full load, torque missing.
    pub const MISSED_TRACE: Flags = Flags(1 << 0);
    /// Belt torque above what the clamping force carries.
    pub const GROSS_SLIP: Flags = Flags(1 << 1);
    /// Actual clamp safety factor below 1.
    pub const LOW_CLAMP: Flags = Flags(1 << 2);
    /// Pump flow does not cover the shift flow and leakage.
    pub const FLOW_LIMITED: Flags = Flags(1 << 3);
    /// An input left the validity range of a model or of a measured map.
    pub const OUTSIDE_VALIDITY: Flags = Flags(1 << 4);
    /// Ratio at one of its limits.
    pub const RATIO_LIMIT: Flags = Flags(1 << 5);
    /// Launch clutch slipping.
    pub const CLUTCH_SLIPPING: Flags = Flags(1 << 6);
    /// Launch clutch open.
    pub const CLUTCH_OPEN: Flags = Flags(1 << 7);
    /// The wheels drive the transmission.
    pub const OVERRUN: Flags = Flags(1 << 8);
    /// Fuel cut off in overrun.
    pub const FUEL_CUT: Flags = Flags(1 << 9);
    /// Engine switched off (soak).
    pub const ENGINE_OFF: Flags = Flags(1 << 10);
    /// The implicit solve stopped at its iteration bound above its tolerance.
    pub const NOT_CONVERGED: Flags = Flags(1 << 11);
    /// Pulling away in another ratio than low.
    pub const LAUNCH_NOT_IN_LOW: Flags = Flags(1 << 12);
    /// Engine speed above its limit.
    pub const OVERSPEED: Flags = Flags(1 << 13);

    /// Names in the order of the bits, as written in the trace.
    pub const NAMES: [(Flags, &'static str); 14] = [
        (Flags::MISSED_TRACE, "missed_trace"),
        (Flags::GROSS_SLIP, "gross_slip"),
        (Flags::LOW_CLAMP, "low_clamp"),
        (Flags::FLOW_LIMITED, "flow_limited"),
        (Flags::OUTSIDE_VALIDITY, "outside_validity"),
        (Flags::RATIO_LIMIT, "ratio_limit"),
        (Flags::CLUTCH_SLIPPING, "clutch_slipping"),
        (Flags::CLUTCH_OPEN, "clutch_open"),
        (Flags::OVERRUN, "overrun"),
        (Flags::FUEL_CUT, "fuel_cut"),
        (Flags::ENGINE_OFF, "engine_off"),
        (Flags::NOT_CONVERGED, "not_converged"),
        (Flags::LAUNCH_NOT_IN_LOW, "launch_not_in_low"),
        (Flags::OVERSPEED, "overspeed"),
    ];

    /// Meanings in the order of [`Flags::NAMES`].
    pub const MEANINGS: [&'static str; Flags::NAMES.len()] = [
        "the car cannot follow the trace: engine at full load, torque missing; exit code 1",
        "belt torque above what the clamping force carries; slip is held at its bound",
        "clamp safety factor (torque capacity over torque) below 1",
        "the pump's flow does not cover leakage, lubrication and shift flow",
        "an input left the validity range of a model or of a measured map",
        "the belt ratio is at one of its limits",
        "the launch clutch slips",
        "the launch clutch is open",
        "the wheels drive the transmission",
        "fuel is cut off in overrun",
        "the engine is switched off (soak)",
        "the implicit solve stopped at its iteration bound above its tolerance; exit code 1",
        "the car pulls away in another ratio than low",
        "engine speed above its limit",
    ];

    /// Whether every bit of `other` is set.
    pub fn contains(self, other: Flags) -> bool {
        self.0 & other.0 == other.0
    }

    /// Names of the flags that are set, in the order of the bits.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let set = Self::NAMES
            .iter()
            .filter(move |(flag, _)| self.contains(*flag));
        set.map(|(_, name)| *name)
    }

    /// Sets the bits of `flag` when `on`.
    pub fn set(&mut self, flag: Flags, on: bool) {
        self.0 |= if on { flag.0 } else { 0 };
    }
}
