//! Means of an output over the levels of a factor: of a factor that is words, and main effects of grids.
//!
//! | label | statement | status |
//! |---|---|---|
//! | GR-1 | eta^2 = sum over levels of n_l (mean_l - mean)^2 / sum of (y - mean)^2 | source: Pearson's correlation ratio |
//!
//! In a grid with all combinations the mean at a level averages over all other factors evenly: its course is the main effect, and eta^2 the
//! part of the grid's variance that it explains. There the rows are no random draws: a group has neither a deviation nor an interval, but ends (min, max).

use std::ops::Deref;

use serde::Serialize;

use super::Confidence;
use super::passes::{Moments, Numbers};
use super::spread::Spread;

/// Rows up to which all of them are summed group by group.
const HELD: usize = 1 << 18;

/// The output at one level.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The level.
    pub label: String,
    /// The values there; read through the group, its fields are the group's own.
    #[serde(flatten)]
    pub spread: Spread,
    /// Interval of the mean; none where the rows are no sample.
    pub mean_interval: Option<[f64; 2]>,
}

impl Deref for Group {
    type Target = Spread;

    fn deref(&self) -> &Spread {
        &self.spread
    }
}

/// The output at all levels of a factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Groups {
    /// In the order in which the levels first appear.
    pub groups: Vec<Group>,
    /// Largest minus least mean; NaN without two means.
    pub range: f64,
    /// Share of the variance between the levels (GR-1), 0 to 1; NaN of a constant output.
    pub eta_squared: f64,
}

/// Groups an output by the levels of a factor, row by row; a row without a level counts for none. Without a confidence the rows are no
/// sample.
pub fn group_means<S: AsRef<str>>(
    levels: &[S],
    output: &[f64],
    confidence: Option<Confidence>,
) -> Groups {
    let Ok(groups) = group_means_over(|| levels.iter(), output, confidence);
    groups
}

/// The same of an output that is not held; `levels` begins with the level of its first row each time.
///
/// # Errors
/// Numbers that cannot be had.
pub fn group_means_over<P: Numbers + ?Sized, L: Iterator<Item: AsRef<str>>>(
    levels: impl Fn() -> L,
    output: &P,
    confidence: Option<Confidence>,
) -> Result<Groups, P::Error> {
    let mut known: Vec<(String, Moments)> = Vec::new();
    let mut all = Moments::default();
    let mut rows = Some(Vec::new());
    for _ in 0..Moments::PASSES {
        let mut levels = levels();
        output.pass(|piece| {
            for (y, level) in piece.iter().zip(levels.by_ref()) {
                let level = level.as_ref();
                let at = known.iter().position(|(name, _)| name == level);
                let at = at.unwrap_or_else(|| {
                    known.push((level.to_owned(), Moments::default()));
                    known.len() - 1
                });
                known[at].1.add(*y);
                all.add(*y);
                if let Some(list) = rows.as_mut().filter(|_| all.is_first()) {
                    list.push((at, *y));
                }
            }
            rows = rows.take().filter(|list| list.len() <= HELD);
        })?;
        known.iter_mut().for_each(|(_, moments)| moments.turn());
        all.turn();
    }
    let group = |(label, moments): (String, Moments)| {
        let spread = moments.spread();
        Group {
            label,
            mean_interval: confidence.and_then(|confidence| spread.mean_interval(confidence)),
            spread: match confidence {
                Some(_) => spread,
                None => Spread {
                    sd: f64::NAN,
                    ..spread
                },
            },
        }
    };
    let groups: Vec<Group> = known.into_iter().map(group).collect();
    // Few rows are summed group by group, as they always were; many in the order of the points. That moves the last bit at most.
    let all = match rows {
        Some(mut rows) => {
            rows.sort_by_key(|(group, _)| *group);
            let rows: Vec<f64> = rows.into_iter().map(|(_, y)| y).collect();
            let Ok(all) = Moments::compute(rows.as_slice());
            all
        }
        None => all.spread(),
    };
    Ok(Groups::new(groups, &all))
}

impl Groups {
    /// From the groups, and all rows together.
    fn new(groups: Vec<Group>, all: &Spread) -> Self {
        let filled = || groups.iter().filter(|g| g.n > 0);
        let between = |g: &Group| g.n as f64 * (g.mean - all.mean).powi(2);
        let between: f64 = filled().map(between).sum();
        let within = all.sd.powi(2) * (all.n as f64 - 1.0);
        // Both are rounding errors for a constant.
        let eta_squared = match all.max > all.min {
            true => (between / within).min(1.0), // GR-1
            false => f64::NAN,
        };
        let means = || filled().map(|g| g.mean);
        let least = means().fold(f64::INFINITY, |low, x| x.min(low));
        let largest = means().fold(f64::NEG_INFINITY, |high, x| x.max(high));
        Groups {
            range: match filled().count() {
                0 | 1 => f64::NAN,
                _ => largest - least,
            },
            groups,
            eta_squared,
        }
    }
}
