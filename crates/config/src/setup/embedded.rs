//! The files that the program carries.

/// Embedded vehicles: name and TOML text.
#[must_use]
pub fn embedded_vehicles() -> &'static [(&'static str, &'static str)] {
    &[
        (
            "mondeo_20_5mt",
            include_str!("../../../../vehicles/mondeo_20_5mt.toml"),
        ),
        (
            "rover_216_5mt",
            include_str!("../../../../vehicles/rover_216_5mt.toml"),
        ),
        (
            "rover_216_cvt",
            include_str!("../../../../vehicles/rover_216_cvt.toml"),
        ),
    ]
}

/// Embedded lubricants: name and TOML text.
#[must_use]
pub fn embedded_lubricants() -> &'static [(&'static str, &'static str)] {
    &[
        (
            "cvtf_ezl799_class",
            include_str!("../../../../lubricants/cvtf_ezl799_class.toml"),
        ),
        (
            "dexron_ii",
            include_str!("../../../../lubricants/dexron_ii.toml"),
        ),
        (
            "dexron_iii",
            include_str!("../../../../lubricants/dexron_iii.toml"),
        ),
        (
            "gear_75w80",
            include_str!("../../../../lubricants/gear_75w80.toml"),
        ),
        (
            "engine_5w30",
            include_str!("../../../../lubricants/engine_5w30.toml"),
        ),
        (
            "engine_10w40",
            include_str!("../../../../lubricants/engine_10w40.toml"),
        ),
    ]
}

/// Embedded conditions of the test rigs: name and TOML text.
#[must_use]
pub fn embedded_rigs() -> &'static [(&'static str, &'static str)] {
    &[crate::rig::FILE]
}

/// Embedded measured maps by name.
#[must_use]
pub fn embedded_map(name: &str) -> Option<&'static str> {
    (name == "si_1900_bsfc").then_some(include_str!("../../../../vehicles/maps/si_1900_bsfc.csv"))
}
