//! The files that the program carries, by kind. The cycles are in [`crate::cycle`].

/// Name and text of a file.
pub type File = (&'static str, &'static str);

macro_rules! embedded {
    ($($(#[$meta:meta])* $function:ident: $folder:literal $ending:literal [$($name:literal)*];)*) => {
        $(
            $(#[$meta])*
            #[must_use]
            pub const fn $function() -> &'static [File] {
                &[$(($name, include_str!(concat!("../../data/", $folder, "/", $name, $ending)))),*]
            }
        )*
    };
}

embedded! {
    /// Vehicles.
    vehicles: "vehicles" ".toml" ["c_segment_20_6mt" "civic_20_6mt" "civic_20_cvt" "justy_ecvt" "mondeo_20_5mt" "rover_216_5mt" "rover_216_cvt"];
    /// Classes of cars, boxes and engines, which vehicle files inherit from.
    classes: "classes" ".toml" [
        "compact_1995" "compact_2020" "midsize_2020" "subcompact_2020" "suv_2020" "box_cvt_clutch" "box_cvt_converter" "box_cvt_chain" "box_cvt_chain_clutch" "box_cvt_two_range" "box_cvt_launch_gear" "box_manual_5" "box_manual_6"
        "engine_pfi_1990" "engine_pfi_2000" "engine_pfi_2005" "engine_pfi_2010" "engine_pfi_2013" "engine_di_2012" "engine_di_high_compression_2012" "engine_atkinson_2017" "engine_turbo_2010" "engine_turbo_2015" "engine_diesel_2015"
        "engine_bmw_n57" "engine_ford_ecoboost_16" "engine_ford_ecoboost_27" "engine_gm_lv3" "engine_honda_l15b7" "engine_mazda_skyactiv_g_20" "engine_toyota_a25a_fks"
    ];
    /// Lubricants.
    lubricants: "lubricants" ".toml" [
        "cvtf_ezl799_class" "cvt_blend_high_friction" "cvt_blend_low_friction" "dexron_ii" "dexron_iii" "santotrac_50"
        "gear_75w80" "engine_0w20" "engine_5w30" "engine_10w40"
    ];
    /// Conditions of the test rigs.
    rigs: "rigs" ".toml" ["rig_transmission"];
    /// Measured maps.
    maps: "vehicles/maps" ".csv" [
        "si_1900_bsfc" "bmw_n57" "ford_ecoboost_16" "ford_ecoboost_27" "gm_lv3" "honda_l15b7" "mazda_skyactiv_g_20" "toyota_a25a_fks"
    ];
    /// Plans of studies.
    plans: "plans" ".toml" ["fluids_by_ambient" "oil_at_minus_10" "pump_and_offset" "uncertainty_rover"];
    /// Changes of a car's design.
    levers: "levers" ".toml" ["cvt" "manual"];
    /// Tests of a regulation.
    tests: "cycles/tests" ".toml" ["ftp75" "hwfet" "us06" "sc03" "cold_ftp" "nedc" "wltp" "wltp_14" "jc08"];
    /// Plans of calibrations.
    calibrations: "calibrations" ".toml" ["rover_216_transmission" "rover_216_warm_up"];
    /// Measured points that those name.
    calibration_points: "calibrations" ".csv" ["justy_ecvt"];
    /// Tolerances and sources that all files with published values may use.
    common_rows: "validation" ".toml" ["common"];
    /// Published values, in the order of the thesis, then those of other cars.
    rows: "validation" ".toml" [
        "chapter_1" "chapter_2" "chapter_3" "chapter_4" "chapter_5" "chapter_6" "chapter_7" "chapter_8" "chapter_9"
        "appendix_c" "outside" "civic_20"
    ];
}

/// The text of a file among `files`.
#[must_use]
pub fn text(files: &'static [File], name: &str) -> Option<&'static str> {
    let found = files.iter().find(|(known, _)| *known == name);
    found.map(|(_, text)| *text)
}

/// True if a word given by the user is meant as a path.
#[must_use]
pub fn is_path(word: &str) -> bool {
    word.contains(['/', '\\']) || std::path::Path::new(word).extension().is_some()
}
