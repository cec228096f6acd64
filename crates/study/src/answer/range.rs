//! Ends of an output over points that are no sample: of a grid, of one factor at a time.

use serde::Serialize;

use super::Column;
use super::levels::label;
use crate::plan::{Design, Plan};
use crate::statistics::Numbers;
use cvtcycle_config::Problem;

/// Where a value is that is the same at all points.
const EVERYWHERE: &str = "everywhere";

/// The least and the largest number, and where they are. A mean or a deviation of such points would describe the plan and not the car.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Range {
    /// Number of values.
    pub n: usize,
    /// Number of points without a value.
    pub missing: usize,
    /// Least value.
    pub least: Option<f64>,
    /// The levels there.
    pub least_at: String,
    /// Largest value.
    pub largest: Option<f64>,
    /// The levels there.
    pub largest_at: String,
}

impl Range {
    /// Over the numbers of the points of a plan; none of a plan that draws its points.
    pub(super) fn from_points(plan: &Plan, numbers: &Column) -> Result<Option<Self>, Problem> {
        if plan.design.is_sampled() {
            return Ok(None);
        }
        let (mut point, mut n) = (0_u64, 0);
        // The first of equal ones on both sides.
        let (mut least, mut largest) = (None::<(u64, f64)>, None::<(u64, f64)>);
        numbers.pass(|piece| {
            for x in piece {
                if x.is_finite() {
                    n += 1;
                    if least.is_none_or(|(_, low)| x.total_cmp(&low).is_lt()) {
                        least = Some((point, *x));
                    }
                    if largest.is_none_or(|(_, high)| x.total_cmp(&high).is_gt()) {
                        largest = Some((point, *x));
                    }
                }
                point += 1;
            }
        })?;
        let at = |end: Option<(u64, f64)>| {
            end.map_or_else(String::new, |(point, _)| levels(plan, point))
        };
        let range = Range {
            n,
            missing: usize::try_from(point).unwrap_or(usize::MAX) - n,
            least: least.map(|(_, x)| x),
            least_at: at(least),
            largest: largest.map(|(_, x)| x),
            largest_at: at(largest),
        };
        Ok(Some(match range.is_one() && n > 1 {
            true => Range {
                least_at: EVERYWHERE.to_owned(),
                largest_at: EVERYWHERE.to_owned(),
                ..range
            },
            false => range,
        }))
    }

    /// True if all values have the same bits and there is at least one.
    pub fn is_one(&self) -> bool {
        let bits = |x: Option<f64>| x.map(f64::to_bits);
        self.n > 0 && bits(self.least) == bits(self.largest)
    }
}

/// The levels of a point by name; of a point at which no factor leaves it, the base.
fn levels(plan: &Plan, point: u64) -> String {
    let factors = plan.factors.iter().enumerate();
    let level = |(f, factor): (usize, &crate::plan::Factor)| {
        let value = factor.value(plan.design.level(&plan.factors, point, f))?;
        Some(format!("{} {}", factor.name, label(&value, &factor.unit)))
    };
    let levels: Vec<String> = factors.filter_map(level).collect();
    match (levels.is_empty(), plan.design) {
        (true, Design::OneAtATime { .. }) => "base".to_owned(),
        _ => levels.join(", "),
    }
}
