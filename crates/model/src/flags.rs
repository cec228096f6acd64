//! States of a time step and departures from the validity of the models.

/// Declares a set of flags: of each its bit, its name in files and what it means, in the order of the bits.
macro_rules! flags {
    (
        $(#[$meta:meta])*
        $set:ident { $($flag:ident = $bit:literal, $name:literal, $doc:literal;)* }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $set(pub u32);

        impl $set {
            $(#[doc = $doc] pub const $flag: $set = $set(1 << $bit);)*

            /// Names in the order of the bits.
            pub const NAMES: [($set, &'static str); [$($bit),*].len()] = [$(($set::$flag, $name)),*];

            /// Meanings in the order of the bits.
            pub const MEANINGS: [&str; [$($bit),*].len()] = [$($doc),*];

            /// True where every bit of `other` is set.
            pub fn contains(self, other: $set) -> bool {
                self.0 & other.0 == other.0
            }

            /// True where a bit of `other` is set.
            pub fn any(self, other: $set) -> bool {
                self.0 & other.0 != 0
            }

            /// Names of the flags that are set, in the order of the bits.
            pub fn names(self) -> impl Iterator<Item = &'static str> {
                let set = Self::NAMES.iter().filter(move |(flag, _)| self.contains(*flag));
                set.map(|(_, name)| *name)
            }

            /// Sets the bits of `flag` when `on`.
            pub fn set(&mut self, flag: $set, on: bool) {
                self.0 |= if on { flag.0 } else { 0 };
            }
        }
    };
}
pub(crate) use flags;

flags! {
    /// States and departures from validity of a row, as a bit set.
    Flags {
        MISSED_TRACE = 0, "missed_trace", "the car is slower than its trace by more than the tolerance of the test, after rows of full_load; exit code 1";
        GROSS_SLIP = 1, "gross_slip", "belt torque above what the clamping force carries; slip is held at its bound";
        LOW_CLAMP = 2, "low_clamp", "clamp safety factor (torque capacity over torque) below 1";
        FLOW_LIMITED = 3, "flow_limited", "the pump's flow does not cover leakage, lubrication and shift flow";
        OUTSIDE_VALIDITY = 4, "outside_validity", "an input left the validity range of a model or of a measured map";
        RATIO_LIMIT = 5, "ratio_limit", "the belt ratio is at one of its limits";
        CLUTCH_SLIPPING = 6, "clutch_slipping", "the launch clutch slips";
        CLUTCH_OPEN = 7, "clutch_open", "the launch clutch is open";
        OVERRUN = 8, "overrun", "the wheels drive the transmission";
        FUEL_CUT = 9, "fuel_cut", "fuel is cut off in overrun";
        ENGINE_OFF = 10, "engine_off", "the engine is switched off (soak)";
        NOT_CONVERGED = 11, "not_converged", "the implicit solve stopped at its iteration bound above its tolerance; exit code 1";
        LAUNCH_NOT_IN_LOW = 12, "launch_not_in_low", "the car pulls away in another ratio than low";
        OVERSPEED = 13, "overspeed", "engine speed above its limit; exit code 1 if more than 1 % above the end of the full-load line as well";
        TOO_HOT = 14, "too_hot", "coolant above 130 degC (a half-and-half mix boils at 129 degC with 1 bar over ambient), or engine oil or transmission oil above 160 degC; exit code 1";
        WRONG_GEAR = 15, "wrong_gear", "the cycle prescribes no gear or an open clutch while the car is driven faster; a gear was engaged; exit code 1";
        PRIMARY_PRESSURE_SHORT = 16, "primary_pressure_short", "the primary needs a higher pressure than the line pressure for its clamping force; its piston is too small for this ratio";
        LOCKUP_OPEN = 17, "lockup_open", "the car moves over the open lock-up clutch of its torque converter";
        FULL_LOAD = 18, "full_load", "the engine is at full load, and torque for the trace is missing";
    }
}

impl Flags {
    /// Flags that no car can set, given its engine, its oil and its cycle.
    pub const IMPOSSIBLE: Flags =
        Flags(Flags::OVERSPEED.0 | Flags::TOO_HOT.0 | Flags::WRONG_GEAR.0);
}
