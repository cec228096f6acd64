//! Pictures of artificial statistics: few and many factors, long names, tiny and negative values, no data.

use cvtcycle::report::charts::Picture;
use cvtcycle::report::charts::study::{
    DistributionSeries, EffectFactor, KnownValue, Shown, convergence_plot, distribution_plot,
    effects_plot, rank_plot, sobol_plot, tornado_plot,
};
use cvtcycle::study::statistics::{
    Blocks, Bootstrap, Confidence, Groups, TornadoInput, group_means, rank_sensitivity,
    sobol_convergence, sobol_indices, tornado,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

pub const LONG: &str = "transmission.variator.segment_friction_coefficient_between_bands_and_shoulders_at_40_degc & <so on>";

/// Names of factors, some of them long or with characters that XML escapes.
pub fn names(count: usize) -> Vec<String> {
    let name = |i: usize| match i % 5 {
        0 => format!("ambient_degc {i}"),
        1 => format!("{LONG} {i}"),
        2 => format!("pump.displacement {i}"),
        3 => format!("lubricant.viscosity_at_100_degc_mm2_s {i}"),
        _ => format!("k{i}"),
    };
    (0..count).map(name).collect()
}

/// Uniform numbers between 0 and 1.
pub fn draws(seed: u64, count: usize) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    (0..count).map(|_| random.random::<f64>()).collect()
}

fn shown(scale: f64) -> Shown<'static> {
    if scale.abs() < 1e-3 {
        Shown {
            output: "Gear-box oil temperature at the end of a very long cycle with several phases",
            unit: "kg/s",
            subject: LONG,
            ..Shown::default()
        }
    } else {
        Shown {
            output: "Fuel, total",
            unit: "L/100 km",
            subject: "rover_cvt, 1024 samples",
            ..Shown::default()
        }
    }
}

/// Decreasing weights of factors in the artificial output, some negative.
fn weight(i: usize) -> f64 {
    let sign = if i % 3 == 1 { -1.0 } else { 1.0 };
    sign * 0.75_f64.powi(i as i32)
}

/// Outputs of a Saltelli design of an artificial function, with an interaction of the first two factors.
fn design(factors: usize, samples: usize, scale: f64) -> Vec<Vec<f64>> {
    let evaluate_at = |x: &[f64]| {
        let sum: f64 = x
            .iter()
            .enumerate()
            .map(|(i, x)| weight(i) * (x - 0.5))
            .sum();
        scale * (7.0 + sum + 1.5 * (x[0] - 0.5) * (x[1] - 0.5))
    };
    let mut columns = vec![Vec::new(); factors + 2];
    for s in 0..samples {
        let (a, b) = (
            draws(9 + s as u64, factors),
            draws(1_000_000 + s as u64, factors),
        );
        columns[0].push(evaluate_at(&a));
        columns[1].push(evaluate_at(&b));
        for i in 0..factors {
            let mut mixed = a.clone();
            mixed[i] = b[i];
            columns[i + 2].push(evaluate_at(&mixed));
        }
    }
    columns
}

fn sobol(factors: usize, samples: usize, scale: f64) -> Vec<(String, Picture)> {
    let columns = design(factors, samples, scale);
    let blocks = Blocks {
        a: &columns[0],
        b: &columns[1],
        ab: columns[2..].iter().map(Vec::as_slice).collect(),
    };
    let (names, quick) = (
        names(factors),
        Bootstrap {
            resamples: 100,
            seed: 1,
            ..Bootstrap::default()
        },
    );
    let (indices, steps) = (
        sobol_indices(&blocks, quick),
        sobol_convergence(&blocks, quick),
    );
    vec![
        (
            format!("sobol {factors}"),
            sobol_plot(&shown(scale), &names, &indices),
        ),
        (
            format!("convergence {factors}"),
            convergence_plot(&shown(scale), &names, &steps),
        ),
    ]
}

fn ranks(factors: usize, scale: f64) -> (String, Picture) {
    let columns: Vec<Vec<f64>> = (0..factors).map(|i| draws(i as u64, 200)).collect();
    let output: Vec<f64> = (0..200)
        .map(|r| {
            scale
                * (0..factors)
                    .map(|i| weight(i) * (columns[i][r] - 0.2 * columns[i][(r + 7) % 200]))
                    .sum::<f64>()
        })
        .collect();
    let inputs: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    (
        format!("ranks {factors}"),
        rank_plot(
            &shown(scale),
            &names(factors),
            &rank_sensitivity(&inputs, &output, Confidence::default()),
        ),
    )
}

fn bars(factors: usize, scale: f64) -> (String, Picture) {
    let entry = |i: usize| match i % 4 {
        0 => vec![
            ("0.08".to_owned(), 7.0 - weight(i)),
            ("0.12".to_owned(), 7.0 + 0.8 * weight(i)),
        ],
        1 => vec![
            ("soak".to_owned(), 7.0 - weight(i)),
            ("half warm".to_owned(), 7.0 - 0.5 * weight(i)),
        ],
        2 => (0..4)
            .map(|k| {
                (
                    format!("{LONG} {k}"),
                    7.0 + weight(i) * (f64::from(k) - 1.5),
                )
            })
            .collect(),
        _ => vec![
            ("low".to_owned(), 7.0),
            (
                "high".to_owned(),
                if i == 3 { f64::NAN } else { 7.0 + weight(i) },
            ),
        ],
    };
    let scaled = |i: usize| entry(i).into_iter().map(|(l, y)| (l, scale * y)).collect();
    let inputs: Vec<TornadoInput> = names(factors)
        .into_iter()
        .enumerate()
        .map(|(i, name)| TornadoInput {
            name,
            entries: scaled(i),
        })
        .collect();
    (
        format!("tornado {factors}"),
        tornado_plot(&shown(scale), &tornado(7.0 * scale, &inputs)),
    )
}

fn effects(factors: usize, scale: f64) -> (String, Picture) {
    let labels = |i: usize| -> Vec<String> {
        match i % 4 {
            0 => [-10.0, 0.0, 25.0, 40.0]
                .map(|x: f64| (x * scale).to_string())
                .to_vec(),
            1 => ["soak".to_owned(), "warm".to_owned()].to_vec(),
            2 => (0..7).map(|k| format!("{} {k}", &LONG[..30 + k])).collect(),
            _ => ["0.1".to_owned()].to_vec(),
        }
    };
    let group = |i: usize| -> Groups {
        let labels = labels(i);
        let rows: Vec<&String> = (0..60).map(|r| &labels[r % labels.len()]).collect();
        let y: Vec<f64> = draws(i as u64, 60)
            .iter()
            .enumerate()
            .map(|(r, u)| {
                scale * (7.0 + 0.5 * weight(i) * ((r % labels.len()) as f64 - 1.0) + 0.3 * u)
            })
            .collect();
        group_means(&rows, &y, (!i.is_multiple_of(3)).then(Confidence::default))
    };
    let (names, groups): (Vec<String>, Vec<Groups>) =
        (names(factors), (0..factors).map(group).collect());
    let at = |g: &Groups| {
        g.groups
            .iter()
            .map_while(|g| g.label.parse().ok())
            .collect()
    };
    let list: Vec<EffectFactor> = names
        .iter()
        .zip(&groups)
        .map(|(name, g)| EffectFactor {
            name,
            unit: "\u{b0}C",
            at: at(g),
            groups: g,
        })
        .collect();
    (
        format!("effects {factors}"),
        effects_plot(&shown(scale), &list),
    )
}

/// Skewed sample about a centre.
pub fn sample(seed: u64, count: usize, centre: f64, width: f64) -> Vec<f64> {
    draws(seed, count)
        .iter()
        .zip(draws(seed + 50, count))
        .map(|(u, v)| centre + width * (u + v * v - 0.9))
        .collect()
}

fn distributions(scale: f64) -> Vec<(String, Picture)> {
    let (subject, first, second) = (
        sample(1, 4000, 7.4 * scale, 0.8 * scale),
        sample(2, 4000, 6.9 * scale, 0.5 * scale),
        sample(3, 20, 7.1 * scale, scale),
    );
    let one: Vec<f64> = subject.iter().zip(&first).map(|(a, b)| a - b).collect();
    let two: Vec<f64> = subject.iter().zip(&second).map(|(a, b)| a - b).collect();
    let draw = |name: &str, differences: bool, list: &[(&str, &[f64])]| {
        let series: Vec<DistributionSeries> = list
            .iter()
            .map(|&(name, values)| DistributionSeries {
                name,
                values,
                known: KnownValue::default(),
            })
            .collect();
        let Ok(picture) = distribution_plot(&shown(scale), &series, differences);
        (name.to_owned(), picture)
    };
    vec![
        draw(
            "output",
            false,
            &[
                ("rover_cvt", &subject),
                ("rover_manual", &first),
                (LONG, &second),
            ],
        ),
        draw("difference", true, &[("rover_cvt - rover_manual", &one)]),
        draw(
            "differences",
            true,
            &[("rover_cvt - rover_manual", &one), (LONG, &two)],
        ),
        draw(
            "always above",
            true,
            &[("a - b", &sample(5, 300, 3.0 * scale, 0.2 * scale))],
        ),
    ]
}

/// Statistics of no numbers, of one number, of constants.
fn odd() -> Vec<(String, Picture)> {
    let shown = Shown::default();
    let gap = [f64::NAN; 4];
    let cases: [(&str, Vec<&[f64]>); 6] = [
        ("none", vec![]),
        ("empty", vec![&[]]),
        ("gaps", vec![&gap]),
        ("one", vec![&[7.25]]),
        ("constant", vec![&[7.25; 30], &[7.25; 5]]),
        ("outlier", vec![&[1.0, 1.01, 1.02, 1.015, 1e6, -1e-9]]),
    ];
    let mut plots = Vec::new();
    for (name, columns) in cases {
        let series: Vec<DistributionSeries> = columns
            .iter()
            .map(|&values| DistributionSeries {
                name: "car",
                values,
                known: KnownValue::default(),
            })
            .collect();
        for differences in [false, true] {
            let Ok(svg) = distribution_plot(&shown, &series, differences);
            plots.push((format!("{name} {differences}"), svg));
        }
    }
    let constant = [7.0; 64];
    for (name, column) in [("constant", &constant[..]), ("empty", &[])] {
        let blocks = Blocks {
            a: column,
            b: column,
            ab: vec![column; 3],
        };
        let (names, quick) = (
            names(3),
            Bootstrap {
                resamples: 20,
                seed: 1,
                ..Bootstrap::default()
            },
        );
        let (indices, steps) = (
            sobol_indices(&blocks, quick),
            sobol_convergence(&blocks, quick),
        );
        plots.push((
            format!("sobol {name}"),
            sobol_plot(&shown, &names, &indices),
        ));
        plots.push((
            format!("convergence {name}"),
            convergence_plot(&shown, &names, &steps),
        ));
        let ranks = rank_sensitivity(&[column, column, column], column, Confidence::default());
        plots.push((format!("ranks {name}"), rank_plot(&shown, &names, &ranks)));
        let words = vec!["a"; column.len()];
        let groups = group_means(&words, column, Some(Confidence::default()));
        let factor = EffectFactor {
            name: "x",
            unit: "",
            at: Vec::new(),
            groups: &groups,
        };
        plots.push((format!("effects {name}"), effects_plot(&shown, &[factor])));
    }
    let lost = TornadoInput {
        name: "lost".to_owned(),
        entries: vec![("1".to_owned(), f64::NAN), ("2".to_owned(), f64::NAN)],
    };
    let still = TornadoInput {
        name: "still".to_owned(),
        entries: vec![("1".to_owned(), 5.0), ("2".to_owned(), 5.0)],
    };
    for (name, base, list) in [
        ("none", 5.0, vec![]),
        ("lost", 5.0, vec![lost.clone(), still]),
        ("no base", f64::NAN, vec![lost]),
    ] {
        plots.push((
            format!("tornado {name}"),
            tornado_plot(&shown, &tornado(base, &list)),
        ));
    }
    plots.push(("no effects".to_owned(), effects_plot(&shown, &[])));
    plots
}

/// All pictures by name.
pub fn every_plot() -> Vec<(String, Picture)> {
    let mut plots = odd();
    for scale in [1.0, -1.0, 1e-7] {
        let mut of_scale = distributions(scale);
        for factors in [3, 12, 30] {
            of_scale.extend(sobol(factors, 96, scale));
            of_scale.extend([
                ranks(factors, scale),
                bars(factors, scale),
                effects(factors, scale),
            ]);
        }
        plots.extend(
            of_scale
                .into_iter()
                .map(|(name, svg)| (format!("{name} x{scale}"), svg)),
        );
    }
    plots
}
