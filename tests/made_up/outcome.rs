//! Made-up outcomes of calibrations; every number in them is invented. Whoever includes this file brings the types into its parent.
use super::{Direction, Fold, Outcome, Parameter, Residual, SCHEMA, Start};

/// Something like noise between -1 and 1 that is the same every time.
pub fn noise(k: usize) -> f64 {
    ((k as f64 * 12.9898 + 4.1).sin() * 43_758.545).fract()
}

const UNITS: [&str; 4] = ["Nm", "L/100 km", "degC", "-"];

/// A printed or measured number; every fifth is a range, every tenth one that is open above.
pub fn single(k: usize) -> Residual {
    let unit = UNITS[k / 3 % UNITS.len()];
    let size = if unit == "degC" { 60.0 } else { 9.0 };
    let (truth, sd) = (size * (1.0 + 0.4 * noise(k)), 0.04 * size);
    let range = k % 5 == 4;
    let from = if range {
        truth - sd
    } else {
        truth + sd * noise(k + 7)
    };
    let low = Some(from);
    let high = match (range, k % 10) {
        (true, 9) => None,
        (true, _) => Some(truth + 2.0 * sd),
        _ => low,
    };
    let (before, after) = (
        truth * 1.2 + sd * noise(k + 900),
        truth + 0.5 * sd * noise(k + 90),
    );
    let left_out = truth + 2.0 * sd * noise(k + 123);
    let of = |x: f64| if range { 0.0 } else { (x - from) / sd };
    Residual {
        group: format!("group {}", k / 8),
        fold: format!("fold {}", k / 8),
        label: format!("5.{k}"),
        what: "torque loss in low without load at 2000 rpm".to_owned(),
        column: String::new(),
        time_s: None,
        unit: unit.to_owned(),
        low,
        high,
        sd,
        weight_sd: sd,
        before: Some(before),
        after,
        left_out: Some(left_out),
        before_sd: Some(of(before)),
        after_sd: of(after),
        left_out_sd: Some(of(left_out)),
        doubtful: usize::from(k % 20 == 3),
    }
}

/// A value of a measured warm-up.
pub fn of_trace(k: usize, column: &str) -> Residual {
    let time = 2.0 * k as f64;
    let truth = 25.0 + 55.0 * (1.0 - (-time / 600.0).exp());
    let (sd, weight_sd) = (0.8, 3.2);
    let measured = truth + sd * noise(k);
    let (before, after) = (25.0 + 45.0 * (1.0 - (-time / 700.0).exp()), truth + 0.3);
    Residual {
        group: "warm-up".to_owned(),
        fold: "warm-up".to_owned(),
        label: format!("{column} at {time} s"),
        what: String::new(),
        column: column.to_owned(),
        time_s: Some(time),
        unit: "degC".to_owned(),
        low: Some(measured),
        high: Some(measured),
        sd,
        weight_sd,
        before: Some(before),
        after,
        left_out: None,
        before_sd: Some((before - measured) / weight_sd),
        after_sd: (after - measured) / weight_sd,
        left_out_sd: None,
        doubtful: 0,
    }
}

const KEYS: [(&str, &str); 4] = [
    ("transmission.cvt.pump.displacement_cc_rev", "cc/rev"),
    (
        "transmission.cvt.final_drive.viscous_loss_at_reference_conditions_nm",
        "Nm",
    ),
    ("lubricant.friction.band", "-"),
    ("thermal.spray_w_k", "W/K"),
];

/// A parameter; the third lies at a bound, the fourth moves nothing.
pub fn parameter(k: usize) -> Parameter {
    let (key, unit) = KEYS[k % KEYS.len()];
    let dead = k == 3;
    let key = if k < KEYS.len() {
        key.to_owned()
    } else {
        format!("{key}_{k}")
    };
    Parameter {
        name: if k == 4 {
            "common error of group 0".to_owned()
        } else {
            key
        },
        is_key: k != 4,
        unit: unit.to_owned(),
        file_value: 9.0,
        value: if k == 2 { 12.0 } else { 8.2 + 0.7 * noise(k) },
        standard_error: (!dead).then_some(0.21),
        low: 4.0,
        high: 12.0,
        prior: (k.is_multiple_of(2)).then_some([9.5, 1.0]),
        prior_status: if k.is_multiple_of(2) {
            "assumed".to_owned()
        } else {
            String::new()
        },
        source: "made up".to_owned(),
        prior_share: (k.is_multiple_of(2)).then_some(0.044),
        at_bound: (k == 2).then_some("high"),
        is_dead: dead,
    }
}

/// An outcome of these observations and so many parameters.
pub fn of(residuals: Vec<Residual>, parameters: usize) -> Outcome {
    let all: Vec<Parameter> = (0..parameters).map(parameter).collect();
    let known = |i: usize, j: usize| !all[i].is_dead && !all[j].is_dead;
    let r = |i: usize, j: usize| {
        if i == j {
            1.0
        } else {
            noise(7 * i.min(j) + i.max(j))
        }
    };
    let matrix = |scale: f64| {
        (0..parameters)
            .map(|i| {
                (0..parameters)
                    .map(|j| known(i, j).then(|| scale * r(i, j)))
                    .collect()
            })
            .collect()
    };
    let mut names: Vec<String> = residuals.iter().map(|r| r.fold.clone()).collect();
    names.dedup();
    let folds = names.into_iter().enumerate().map(|(k, name)| Fold {
        observations: residuals.iter().filter(|r| r.fold == name).count(),
        fitted_rms_sd: 0.61,
        predicted_rms_sd: (k != 2).then_some(1.43),
        end: if k == 2 {
            "no answer at the start".to_owned()
        } else {
            "converged".to_owned()
        },
        name,
    });
    Outcome {
        schema: SCHEMA,
        program: "cvtcycle 0.0.0".to_owned(),
        title: "Made up <to be drawn> & told".to_owned(),
        plan: "made_up.toml".to_owned(),
        plan_sha256: "0".repeat(64),
        files: vec![["made_up.csv".to_owned(), "1".repeat(64)]],
        vehicle: "rover_216_cvt".to_owned(),
        end: "converged".to_owned(),
        converged: true,
        cost_before: Some(812.0),
        cost_after: 41.0,
        chi2: 39.5,
        degrees_of_freedom: residuals.len().saturating_sub(parameters),
        chi2_probability: Some(0.62),
        correlation: matrix(1.0),
        covariance: matrix(0.044),
        directions: vec![Direction {
            singular_value: 0.0,
            weights: vec![0.5; parameters],
        }],
        not_identified: vec![
            "pump.displacement_cc_rev and pressure in low: only their product".to_owned(),
        ],
        folds: folds.collect(),
        starts: (0..4)
            .map(|k| Start {
                from: vec![9.0; parameters],
                to: vec![8.2; parameters],
                cost: (k != 3).then_some(if k == 2 { 44.0 } else { 41.0 }),
                end: if k == 3 {
                    "no answer at the start".to_owned()
                } else {
                    "converged".to_owned()
                },
                evaluations: 310,
            })
            .collect(),
        evaluations: 1240,
        warnings: vec![
            "transmission.x lies at its high bound: widen it, or ask why the data want more."
                .to_owned(),
        ],
        parameters: all,
        residuals,
    }
}

/// Named outcomes: ordinary ones, long ones, empty ones and odd ones.
pub fn every() -> Vec<(&'static str, Outcome)> {
    let singles = |n: usize| (0..n).map(single).collect::<Vec<_>>();
    let mut mixed = singles(40);
    for column in ["transmission_sump_degc", "engine_coolant_degc"] {
        mixed.extend((0..590).map(|k| of_trace(k, column)));
    }
    let mut no_folds = of(singles(12), 3);
    no_folds.folds.clear();
    no_folds.residuals.iter_mut().for_each(|r| {
        (r.left_out, r.left_out_sd, r.before, r.before_sd) = (None, None, None, None)
    });
    let mut odd = of(singles(6), 4);
    for r in &mut odd.residuals {
        (r.after, r.after_sd, r.sd) = (f64::NAN, f64::INFINITY, 0.0);
        r.group =
            "A <very> long & \"quoted\" name ]]> that goes on and on, far beyond whatever edge it could be asked to keep to".to_owned();
        (r.low, r.high, r.before) = (None, Some(f64::INFINITY), Some(f64::NEG_INFINITY));
    }
    odd.parameters[0].value = f64::NAN;
    (odd.parameters[1].low, odd.parameters[1].high) = (1.0, 1.0);
    odd.title = "A very long title that goes on ".repeat(9);
    let lone = of_trace(4, "transmission_sump_degc");
    vec![
        ("ordinary", of(singles(24), 5)),
        ("hundred", of(singles(100), 12)),
        ("mixed", of(mixed, 3)),
        ("many", of(singles(900), 30)),
        ("one", of(singles(1), 1)),
        ("nothing", of(Vec::new(), 0)),
        ("no folds", no_folds),
        ("odd", odd),
        ("one value of a trace", of(vec![lone], 1)),
    ]
}
