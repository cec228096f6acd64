//! First values of the starts (CA-4, CA-9).

use cvtcycle::study::NoProgress;
use cvtcycle::study::fit::solve::{Options, Parameter, fit};

use super::{Model, parameter, with_prior};

/// First values of all starts; the model has a result everywhere and no residual changes.
fn starts(parameters: &[Parameter], starts: usize, seed: u64) -> Vec<Vec<f64>> {
    let options = Options {
        starts,
        seed,
        max_evaluations: 1,
        tolerance: 1e-8,
    };
    let flat = Model(1, |_: &[f64]| Ok(vec![1.0]));
    let fit = fit(&flat, parameters, &options, &NoProgress).expect("a fit");
    fit.starts.into_iter().map(|start| start.from).collect()
}

#[test]
fn one_value_in_each_part_of_the_region_and_another_seed_elsewhere() {
    let free = || parameter("p", 1.0, [0.0, 10.0]);
    let parameters = [
        free(),
        with_prior(free(), 5.0, 1.0),
        with_prior(free(), 9.0, 1.0),
        with_prior(free(), 50.0, 1.0),
    ];
    let regions = [[0.0, 10.0], [3.0, 7.0], [7.0, 10.0], [0.0, 10.0]];
    let all = starts(&parameters, 9, 7);
    assert_eq!((all.len(), &all[0]), (9, &vec![1.0; 4]));
    for (k, [low, high]) in regions.into_iter().enumerate() {
        let mut parts: Vec<usize> = all[1..]
            .iter()
            .map(|start| ((start[k] - low) / (high - low) * 8.0) as usize)
            .collect();
        parts.sort_unstable();
        assert_eq!(parts, (0..8).collect::<Vec<_>>(), "{k}");
    }
    assert_eq!(all, starts(&parameters, 9, 7));
    assert_ne!(all, starts(&parameters, 9, 8));
    assert_eq!(starts(&parameters, 0, 7).len(), 1);
}

#[test]
fn starts_move_inside_by_a_hundredth() {
    for (x, want) in [
        (-3.0, 0.1),
        (0.0, 0.1),
        (1e-9, 0.1),
        (1e-6, 1e-6),
        (5.0, 5.0),
        (10.0, 9.9),
        (99.0, 9.9),
    ] {
        let from = starts(&[parameter("p", x, [0.0, 10.0])], 1, 0)[0][0];
        assert!((from - want).abs() < 1e-15, "{x}");
    }
}
