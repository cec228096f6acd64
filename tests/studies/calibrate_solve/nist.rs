//! Statistical Reference Datasets of NIST, nonlinear regression (<https://www.itl.nist.gov/div898/strd/nls/nls_main.shtml>, public domain): data,
//! starts, certified values and certified standard deviations. These are scaled by the residual standard deviation, so it is the data's here.

use cvtcycle::calibrate::solve::{FitEnd, uncertainty};

use super::{curve, fitted, near, parameter};

struct Certified<'a> {
    data: &'a [(f64, f64)],
    residual_sd: f64,
    starts: &'a [&'a [f64]],
    bounds: &'a [[f64; 2]],
    values: &'a [f64],
    deviations: &'a [f64],
}

fn holds(truth: &Certified, f: fn(&[f64], f64) -> f64) {
    let (y, x): (Vec<f64>, Vec<f64>) = truth.data.iter().copied().unzip();
    let model = curve(x, y, truth.residual_sd, f);
    for starts in truth.starts {
        let parameters: Vec<_> = starts
            .iter()
            .zip(truth.bounds)
            .map(|(start, bounds)| parameter("b", *start, *bounds))
            .collect();
        let found = fitted(&model, &parameters);
        let worth = uncertainty(&found, &parameters);
        assert_eq!(found.end, FitEnd::Converged);
        for (k, (value, deviation)) in truth.values.iter().zip(truth.deviations).enumerate() {
            let error = worth.standard_error[k].expect("identified");
            // Derivatives are finite differences, so the minimum is found to a small part of its standard deviation.
            assert!(
                (found.values[k] - value).abs() <= 1e-4 * deviation,
                "b{} from {starts:?}: {} {value}",
                k + 1,
                found.values[k]
            );
            assert!(
                near(error, *deviation, 2e-4),
                "sd of b{} from {starts:?}: {error} {deviation}",
                k + 1
            );
        }
        assert_eq!(worth.degrees_of_freedom, truth.data.len() - starts.len());
        assert!(
            worth.reduced_chi2.is_some_and(|chi2| near(chi2, 1.0, 1e-8)),
            "{:?}",
            worth.reduced_chi2
        );
    }
}

#[test]
fn val_misra1a() {
    let data = [
        (10.07, 77.6),
        (14.73, 114.9),
        (17.94, 141.1),
        (23.93, 190.8),
        (29.61, 239.9),
        (35.18, 289.0),
        (40.02, 332.8),
        (44.82, 378.4),
        (50.76, 434.8),
        (55.05, 477.3),
        (61.01, 536.8),
        (66.40, 593.1),
        (75.47, 689.1),
        (81.78, 760.0),
    ];
    let truth = Certified {
        data: &data,
        residual_sd: 1.018_787_633_0e-1,
        starts: &[&[500.0, 1e-4], &[250.0, 5e-4]],
        bounds: &[[50.0, 1000.0], [1e-5, 1e-2]],
        values: &[2.389_421_291_8e2, 5.501_564_318_1e-4],
        deviations: &[2.707_007_524_1, 7.266_868_843_6e-6],
    };
    holds(&truth, |b, x| b[0] * (1.0 - (-b[1] * x).exp()));
}

#[test]
fn val_mgh09() {
    let data = [
        (1.957e-1, 4.0),
        (1.947e-1, 2.0),
        (1.735e-1, 1.0),
        (1.600e-1, 0.5),
        (8.44e-2, 0.25),
        (6.27e-2, 0.167),
        (4.56e-2, 0.125),
        (3.42e-2, 0.1),
        (3.23e-2, 0.0833),
        (2.35e-2, 0.0714),
        (2.46e-2, 0.0625),
    ];
    let truth = Certified {
        data: &data,
        residual_sd: 6.627_923_655_1e-3,
        starts: &[&[0.25, 0.39, 0.415, 0.39]],
        bounds: &[[0.0, 5.0]; 4],
        values: &[
            1.928_069_345_8e-1,
            1.912_823_287_3e-1,
            1.230_565_069_3e-1,
            1.360_623_306_8e-1,
        ],
        deviations: &[
            1.143_531_222_7e-2,
            1.963_322_091_1e-1,
            8.084_203_123_2e-2,
            9.002_554_230_8e-2,
        ],
    };
    holds(&truth, |b, x| {
        b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3])
    });
}

#[rustfmt::skip]
const THURBER: [(f64, f64); 37] = [
    (80.574, -3.067), (84.248, -2.981), (87.264, -2.921), (87.195, -2.912), (89.076, -2.840), (89.608, -2.797), (89.868, -2.702),
    (90.101, -2.699), (92.405, -2.633), (95.854, -2.481), (100.696, -2.363), (101.060, -2.322), (401.672, -1.501), (390.724, -1.460),
    (567.534, -1.274), (635.316, -1.212), (733.054, -1.100), (759.087, -1.046), (894.206, -0.915), (990.785, -0.714), (1090.109, -0.566),
    (1080.914, -0.545), (1122.643, -0.400), (1178.351, -0.309), (1260.531, -0.109), (1273.514, -0.103), (1288.339, 0.010),
    (1327.543, 0.119), (1353.863, 0.377), (1414.509, 0.790), (1425.208, 0.963), (1421.384, 1.006), (1442.962, 1.115), (1464.350, 1.572),
    (1468.705, 1.841), (1447.894, 2.047), (1457.628, 2.200),
];

#[test]
fn val_thurber() {
    let truth = Certified {
        data: &THURBER,
        residual_sd: 1.371_460_078_4e1,
        starts: &[
            &[1000.0, 1000.0, 400.0, 40.0, 0.7, 0.3, 0.03],
            &[1300.0, 1500.0, 500.0, 75.0, 1.0, 0.4, 0.05],
        ],
        bounds: &[
            [500.0, 3000.0],
            [500.0, 3000.0],
            [100.0, 1500.0],
            [1.0, 300.0],
            [0.1, 3.0],
            [0.05, 2.0],
            [0.001, 0.3],
        ],
        values: &[
            1.288_139_680_0e3,
            1.491_079_253_5e3,
            5.832_383_687_7e2,
            7.541_664_429_1e1,
            9.662_950_286_4e-1,
            3.979_728_579_7e-1,
            4.972_729_734_9e-2,
        ],
        deviations: &[
            4.664_796_334_4,
            3.957_115_608_6e1,
            2.869_869_610_2e1,
            5.567_537_027_0,
            3.133_334_068_7e-2,
            1.498_492_819_8e-2,
            6.584_234_462_3e-3,
        ],
    };
    holds(&truth, |b, x| {
        let above = b[0] + x * (b[1] + x * (b[2] + x * b[3]));
        above / (1.0 + x * (b[4] + x * (b[5] + x * b[6])))
    });
}
