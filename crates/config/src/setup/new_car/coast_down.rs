//! The drag of the box inside a coast-down in neutral (RL-9).

/// No-load drag of a CVT in f0 and f1, with the keys that take it off.
pub(super) const DRAG: [(&str, &str); 2] = [
    ("road_load.form.coefficients.driveline_f0_n", "27.0"),
    (
        "road_load.form.coefficients.driveline_f1_n_per_kmh",
        "-0.13",
    ),
];

/// Where it is from.
pub(super) const SOURCE: &str = "RL-9: through CVT over manual of the same car, 30 16 11 16 N at 20 50 80 110 km/h (sd 21 to 31, 23 pairs of US lists)";
