//! Quantiles of known distributions at which intervals end.
//!
//! | label | statement | status |
//! |---|---|---|
//! | IV-1 | P(\|T\| <= t) = c for Student's T of nu degrees of freedom; t = z + (z^3 + z) / (4 nu) + (5 z^5 + 16 z^3 + 3 z) / (96 nu^2) above nu = 1000, P(\|Z\| <= z) = c | source: Student 1908 (statrs); first terms of the expansion of Fisher and Cornish 1960 |
//! | IV-2 | k of n: from the quantile a of Beta(k, n - k + 1) to the quantile 1 - a of Beta(k + 1, n - k) | source: Clopper and Pearson 1934 |
//! | IV-3 | quantile p of n values: from the l-th to the u-th least, P(K < l) <= a and P(K >= u) <= a for K of Binomial(n, p) | source: order statistics, e.g. David and Nagaraja 2003, 7.1 |
//! | IV-4 | least n of IV-3: (max(p, 1 - p))^n <= a | derived: then n values reach beyond the quantile p on both sides |
//!
//! c is the confidence, 0.95 unless another is wanted, and a = (1 - c) / 2 its tail. IV-1: statrs' inverse loses digits above some 10^5
//! degrees of freedom (1.83 in place of 1.96 at 10^7), hence the expansion, whose next term is 2.6 / nu^3 (53 / nu^3 of c = 0.999). IV-2:
//! its inverse of Beta never ends where all or none of some 7 * 10^6 draws do something (a Newton step overflows), hence halving of its Beta above 10^6 draws. IV-2
//! and IV-3 hold at least c, for any distribution of independent values.

use super::Confidence;
use statrs::distribution::{Beta, Binomial, ContinuousCDF, DiscreteCDF, Normal, StudentsT};

/// Degrees of freedom above which the expansion is used.
const MANY: f64 = 1000.0;

/// Draws up to which statrs' inverse of Beta is used.
const NEWTON: usize = 1_000_000;

/// Quantile of the standard normal distribution that leaves a tail above it.
pub(super) fn normal(tail: f64) -> f64 {
    Normal::standard().inverse_cdf(1.0 - tail)
}

/// Quantile of Student's t that leaves a tail above it; NaN without a degree of freedom.
pub(super) fn student(freedom: f64, tail: f64) -> f64 {
    if freedom > MANY {
        let z = normal(tail);
        let first = (z.powi(3) + z) / (4.0 * freedom);
        return z
            + first
            + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * freedom * freedom); // IV-1
    }
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| t.inverse_cdf(1.0 - tail)) // IV-1
}

/// Where the probability of `k` of `n` lies; 0 to 1 of nothing.
pub(super) fn clopper_pearson(k: usize, n: usize, tail: f64) -> [f64; 2] {
    let (k, rest) = (k as f64, n.saturating_sub(k) as f64);
    let at = |a: f64, b: f64, p: f64, none: f64| match Beta::new(a, b) {
        Ok(beta) if n <= NEWTON => beta.inverse_cdf(p),
        Ok(beta) => halved(|x| beta.cdf(x) < p),
        Err(_) => none,
    };
    // No Beta has a shape of 0: none or all of n leave the end open, at 0 or at 1.
    [
        at(k, rest + 1.0, tail, 0.0),
        at(k + 1.0, rest, 1.0 - tail, 1.0),
    ] // IV-2
}

/// Where a condition that holds from 0 on ends, of 0 to 1: to the last bit.
fn halved(holds: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        *(if holds(middle) { &mut low } else { &mut high }) = middle;
    }
}

/// Indices, from 0, of the two of `n` ordered values between which the quantile `p` lies; `None` where no value is far enough out.
pub(super) fn quantile_ranks(n: usize, p: f64, tail: f64) -> [Option<usize>; 2] {
    let Ok(below) = Binomial::new(p, n as u64) else {
        return [None; 2];
    };
    // `inverse_cdf(q)` is the least x with P(K <= x) >= q: IV-3 needs l = x at the tail and u = x + 1 at 1 - tail, counted from 1.
    let (lower, upper) = (
        below.inverse_cdf(tail) as usize,
        below.inverse_cdf(1.0 - tail) as usize,
    ); // IV-3
    [lower.checked_sub(1), (upper < n).then_some(upper)]
}

/// Number of independent draws from which on a quantile has an interval; of all draws that do something, also the number from which on
/// they show that at least this share of all does.
pub fn least_draws(p: f64, confidence: Confidence) -> usize {
    let n = confidence.tail().ln() / p.max(1.0 - p).ln(); // IV-4
    if n.is_finite() {
        n.ceil() as usize
    } else {
        usize::MAX
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tail of intervals of 95 %.
    const TAIL: f64 = 0.025;

    #[test]
    fn val_student_and_clopper_pearson_as_in_scipy() {
        // scipy 1.17: stats.t.ppf(0.975, nu); stats.beta.ppf.
        let t = [
            (1.0, 12.706_204_736_175),
            (10.0, 2.228_138_851_986),
            (1e3, 1.962_339_080_826),
            (1e4, 1.960_201_239_891),
        ];
        let far = [(1e5, 1.959_987_707_535), (1e7, 1.959_964_221_767)];
        for (nu, truth) in t.into_iter().chain(far) {
            assert!(
                (student(nu, TAIL) - truth).abs() < 2e-9,
                "{nu}: {}",
                student(nu, TAIL)
            );
        }
        assert!(student(0.0, TAIL).is_nan());
        // The two branches meet.
        for (tail, near) in [(TAIL, 1e-8), (0.25, 1e-8), (0.0005, 1e-7)] {
            let [below, above] = [1000.0, 1_000.000_01].map(|nu| student(nu, tail));
            assert!((below - above).abs() < near, "{tail}: {below} {above}");
        }
        let shares = [
            (3, 10, [0.066_739_511_178, 0.652_452_850_060]),
            (93, 100, [0.861_080_271_544, 0.971_394_711_093]),
            (5000, 10_000, [0.490_151_380_590, 0.509_848_619_410]),
            (500_000, 1_000_000, [0.499_019_519_195, 0.500_980_480_805]),
            (0, 10_000_000, [0.0, 3.688_878_773_722e-7]),
            (5, 10_000_000, [1.623_486_583_030e-7, 1.166_832_818_877e-6]),
            (
                3_000_000,
                10_000_000,
                [0.299_715_982_165, 0.300_284_133_634],
            ),
            (
                5_000_000,
                10_000_000,
                [0.499_690_052_521, 0.500_309_947_479],
            ),
            (
                9_999_997,
                10_000_000,
                [0.999_999_123_273, 0.999_999_938_133],
            ),
            (10_000_000, 10_000_000, [0.999_999_631_112_123, 1.0]),
            (
                400_000_000,
                1_000_000_000,
                [0.399_969_636_158, 0.400_030_364_421],
            ),
        ];
        for (k, n, truth) in shares {
            let ends = clopper_pearson(k, n, TAIL);
            assert!(
                ends.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-10),
                "{k} of {n}: {ends:?}"
            );
        }
        // By hand: none of n ends at 1 - 0.025^(1/n), all of n begins at 0.025^(1/n).
        let end = 1.0 - TAIL.powf(0.1);
        assert!(
            clopper_pearson(0, 10, TAIL)[0].abs() < 1e-300
                && (clopper_pearson(0, 10, TAIL)[1] - end).abs() < 1e-9
        );
        assert!(
            (clopper_pearson(10, 10, TAIL)[0] - (1.0 - end)).abs() < 1e-9
                && (clopper_pearson(10, 10, TAIL)[1] - 1.0).abs() < 1e-300
        );
        let [low, high] = clopper_pearson(0, 0, TAIL);
        assert!(low.abs() < 1e-300 && (high - 1.0).abs() < 1e-300);
    }

    /// Truth: the quantiles of one and of two degrees of freedom are tan(pi (p - 1/2)) and (2 p - 1) / sqrt(2 p (1 - p)); normal ones are
    /// printed in tables; all of n begins at the n-th root of the tail.
    #[test]
    fn val_other_confidences_by_closed_forms() {
        for c in [0.5, 0.8, 0.9, 0.99, 0.999_f64] {
            let (tail, p) = ((1.0 - c) / 2.0, (1.0 + c) / 2.0);
            let one = (std::f64::consts::PI * (p - 0.5)).tan();
            let two = (2.0 * p - 1.0) / (2.0 * p * (1.0 - p)).sqrt();
            for (nu, truth) in [(1.0, one), (2.0, two)] {
                let found = student(nu, tail);
                assert!(
                    (found / truth - 1.0).abs() < 1e-8,
                    "{c} {nu}: {found} {truth}"
                );
            }
            let [low, high] = clopper_pearson(12, 12, tail);
            assert!((low - tail.powf(1.0 / 12.0)).abs() < 1e-9 && high >= 1.0);
        }
        let z = [
            (0.25, 0.674_489_750_196),
            (TAIL, 1.959_963_984_540_054),
            (0.005, 2.575_829_303_549),
            (0.0005, 3.290_526_731_492),
        ];
        for (tail, truth) in z {
            assert!(
                (normal(tail) - truth).abs() < 1e-12,
                "{tail}: {}",
                normal(tail)
            );
        }
        // By hand: 2 (1/2)^5 = 1/16: least and largest of 5 hold the median with 15/16, so with 90 %, and not with 95 %.
        assert_eq!(quantile_ranks(5, 0.5, 0.05), [Some(0), Some(4)]);
    }

    /// Truth: the ranks themselves; by hand 0.5^6 = 1/64, 0.95^72 = 0.0249, 0.9^36 = 0.0225, each the first below 0.025.
    #[test]
    fn val_fewest_draws_of_a_quantile() {
        let usual = Confidence::default();
        for (p, n) in [(0.5, 6), (0.95, 72), (0.05, 72), (0.9, 36)] {
            assert_eq!(least_draws(p, usual), n, "{p}");
            let both = |n| quantile_ranks(n, p, TAIL).iter().all(Option::is_some);
            assert!(both(n) && !both(n - 1), "{p} {n}");
        }
        assert!(clopper_pearson(36, 36, TAIL)[0] >= 0.9 && clopper_pearson(35, 35, TAIL)[0] < 0.9);
    }

    #[test]
    fn ranks_leave_out_at_most_a_fortieth_on_each_side_and_no_less_than_needed() {
        for n in [5_usize, 10, 37, 150, 1000] {
            for p in [0.025, 0.25, 0.5, 0.95] {
                let cdf = |below: usize| {
                    below
                        .checked_sub(1)
                        .map_or(0.0, |k| Binomial::new(p, n as u64).unwrap().cdf(k as u64))
                };
                let [lower, upper] = quantile_ranks(n, p, TAIL);
                // l - 1 = index from 0.
                let l = lower.map_or(0, |i| i + 1);
                assert!(l == 0 || cdf(l) <= TAIL, "{n} {p}");
                assert!(cdf(l + 1) > TAIL, "{n} {p}: the next one would do");
                let u = upper.map_or(n + 1, |i| i + 1);
                assert!(u > n || 1.0 - cdf(u) <= TAIL, "{n} {p}");
                assert!(1.0 - cdf(u - 1) > TAIL, "{n} {p}: the one before would do");
            }
        }
        // By hand: 2 (1/2)^5 = 1/16 > 0.05, so no two of 5 hold the median with 95 %; 2nd and 9th of 10 do.
        assert_eq!(quantile_ranks(5, 0.5, TAIL), [None, None]);
        assert_eq!(quantile_ranks(10, 0.5, TAIL), [Some(1), Some(8)]);
    }
}
