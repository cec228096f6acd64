//! Terms of the field, and the names under which this program has them.

/// A term with its spellings, and names of keys, tables, columns, flags and equations.
pub const TERMS: &[(&[&str], &[&str])] = &[
    (
        &[
            "clamping force",
            "clamping pressure",
            "clamping",
            "line pressure",
        ],
        &[
            "transmission.cvt.clamp",
            "transmission.cvt.pressure",
            "secondary_pressure_bar",
            "clamp_safety",
        ],
    ),
    (
        &["safety factor", "torque capacity", "clamp safety factor"],
        &[
            "clamp_safety",
            "min_clamp_safety",
            "low_clamp",
            "gross_slip",
        ],
    ),
    (
        &["spin loss", "no-load loss", "parasitic loss"],
        &[
            "pump_loss_w",
            "input_shaft_loss_w",
            "clutch_drag_loss_w",
            "final_drive_loss_w",
            "churning_loss_w",
        ],
    ),
    (
        &["drag torque", "drag", "clutch drag"],
        &[
            "transmission.cvt.reverse_clutch",
            "clutch_drag_loss_w",
            "input_shaft_loss_w",
        ],
    ),
    (
        &["road load", "running resistance"],
        &["road_load", "wheel_torque_nm"],
    ),
    (
        &["coast-down", "coastdown", "coast-down coefficients"],
        &["road_load.form.coefficients"],
    ),
    (
        &["rolling resistance"],
        &[
            "road_load.form.coefficients.f0_n",
            "road_load.rolling_per_k",
        ],
    ),
    (
        &["air drag", "aerodynamic drag"],
        &["road_load.form.coefficients.f2_n_per_kmh2"],
    ),
    (
        &["belt slip", "slip", "slip speed"],
        &["slip_percent", "belt_slip_loss_w", "gross_slip"],
    ),
    (
        &["ratio span", "ratio coverage", "ratio spread"],
        &["transmission.cvt.ratio.low", "transmission.cvt.ratio.high"],
    ),
    (
        &["variogram", "ratio schedule", "shift schedule"],
        &["transmission.cvt.ratio"],
    ),
    (
        &["speed ratio", "belt ratio", "underdrive", "overdrive"],
        &["belt_ratio", "overall_ratio", "ratio_limit"],
    ),
    (
        &["oil pump", "pump loss"],
        &["transmission.cvt.pump", "pump_loss_w", "flow_limited"],
    ),
    (
        &["steel bands", "band friction", "ring slip"],
        &[
            "belt_band_loss_w",
            "belt_film_loss_w",
            "transmission.cvt.belt.band_offset_mm",
        ],
    ),
    (
        &["pulley deflection", "wedge loss"],
        &["belt_wedge_loss_w", "belt_penetration_loss_w"],
    ),
    (
        &["launch clutch", "start-up clutch", "creep"],
        &[
            "transmission.cvt.launch",
            "launch_clutch_loss_w",
            "clutch_slipping",
        ],
    ),
    (&["kickdown"], &["transmission.cvt.ratio.rise_rpm"]),
    (
        &["fuel consumption", "fuel economy"],
        &["fuel_l_per_100km", "headline_fuel_l_per_100km", "fuel_g_s"],
    ),
    (
        &["fuel penalty", "fuel difference"],
        &["subject_excess_percent"],
    ),
    (
        &["willans line", "engine friction", "fmep"],
        &["engine.model.willans", "engine.friction"],
    ),
    (
        &["overrun fuel cut", "fuel cut-off"],
        &["fuel_cut", "overrun"],
    ),
    (
        &["warm-up", "heat capacity"],
        &["thermal.engine", "thermal.transmission"],
    ),
    (
        &["oil cooler", "transmission cooler"],
        &["thermal.cooler", "cooler_in_degc", "cooler_out_degc"],
    ),
    (
        &["thermostat"],
        &[
            "thermal.radiator.thermostat_from_degc",
            "thermal.radiator.thermostat_to_degc",
        ],
    ),
    (
        &["viscosity"],
        &["lubricant.kv40_mm2_s", "lubricant.kv100_mm2_s"],
    ),
    (
        &["energy balance", "energy error"],
        &["ledger_error", "power_ledger_error", "heat_ledger_error"],
    ),
    (
        &["gear mesh", "gear loss"],
        &["gear_mesh_loss_w", "final_drive_loss_w"],
    ),
];

/// Names of a term; `-` and `_` in it count as blanks.
pub fn names_of(word: &str) -> &'static [&'static str] {
    let plain = |text: &str| text.to_lowercase().replace(['-', '_'], " ");
    let word = plain(word);
    let found = TERMS
        .iter()
        .find(|(terms, _)| terms.iter().any(|term| plain(term) == word));
    found.map_or(&[], |(_, names)| names)
}
