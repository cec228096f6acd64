//! A plan with its cars: all problems at once.

use super::model::Model;
use super::plan::{self, CalibrationPlan};
use cvtcycle_config::Problems;

/// Reads the plan that a word of the user means, and loads its cars.
///
/// # Errors
/// All problems of the plan, of its data files and of its cars.
pub fn open(word: &str) -> Result<CalibrationPlan, Problems> {
    let (plan, mut problems) = plan::gather(word)?;
    // Without a vehicle, reported already, every key would be unknown.
    if !plan.car.vehicle.is_empty() {
        problems.extend(Model::new(&plan).err().unwrap_or_default());
    }
    if problems.is_empty() {
        Ok(plan)
    } else {
        Err(problems)
    }
}
