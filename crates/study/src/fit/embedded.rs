//! The calibrations that the program carries.

/// Embedded plans: name and TOML text.
#[must_use]
pub fn embedded_calibrations() -> &'static [(&'static str, &'static str)] {
    &[
        (
            "rover_216_transmission",
            include_str!("../../../../calibrations/rover_216_transmission.toml"),
        ),
        (
            "rover_216_warm_up",
            include_str!("../../../../calibrations/rover_216_warm_up.toml"),
        ),
    ]
}
