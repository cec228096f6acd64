//! Meanings of the flags of a time step.

use cvtcycle::output::Flags;

const MEANINGS: [(Flags, &str); Flags::NAMES.len()] = [
    (
        Flags::MISSED_TRACE,
        "the car cannot follow the trace: engine at full load, torque missing; exit code 1",
    ),
    (
        Flags::GROSS_SLIP,
        "belt torque above what the clamping force carries; slip is held at its bound",
    ),
    (
        Flags::LOW_CLAMP,
        "clamp safety factor (torque capacity over torque) below 1",
    ),
    (
        Flags::FLOW_LIMITED,
        "the pump's flow does not cover leakage, lubrication and shift flow",
    ),
    (
        Flags::OUTSIDE_VALIDITY,
        "an input left the validity range of a model or of a measured map",
    ),
    (Flags::RATIO_LIMIT, "the belt ratio is at one of its limits"),
    (Flags::CLUTCH_SLIPPING, "the launch clutch slips"),
    (Flags::CLUTCH_OPEN, "the launch clutch is open"),
    (Flags::OVERRUN, "the wheels drive the transmission"),
    (Flags::FUEL_CUT, "fuel is cut off in overrun"),
    (Flags::ENGINE_OFF, "the engine is switched off (soak)"),
    (
        Flags::NOT_CONVERGED,
        "the implicit solve stopped at its iteration bound above its tolerance; exit code 1",
    ),
    (
        Flags::LAUNCH_NOT_IN_LOW,
        "the car pulls away in another ratio than low",
    ),
    (Flags::OVERSPEED, "engine speed above its limit"),
];

/// Name and meaning of a flag.
pub fn meaning(name: &str) -> Option<(&'static str, &'static str)> {
    let (flag, name) = Flags::NAMES.iter().find(|(_, known)| *known == name)?;
    MEANINGS
        .iter()
        .find(|(known, _)| known == flag)
        .map(|(_, words)| (*name, *words))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_flag_has_a_meaning() {
        assert!(Flags::NAMES.iter().all(|(_, name)| meaning(name).is_some()));
    }
}
