//! The files of an attribution.

use cvtcycle::config::Problem;
use cvtcycle::output::attribution::{PricedCar, write_pairs, write_prices, write_shares};
use cvtcycle::output::files::OutputDir;
use cvtcycle::output::number::plain;
use cvtcycle::report::charts::price_dots;

use super::AttributionSummary;

/// Writes tables and pictures.
///
/// # Errors
/// Problems of the directory.
pub fn write(dir: &mut OutputDir, summary: &AttributionSummary) -> Result<(), Problem> {
    let conditions = summary.conditions.iter();
    let cars = conditions.flat_map(|conditions| {
        let ambient_degc = conditions.ambient_degc;
        let runs = conditions.runs.iter();
        runs.map(move |run| PricedCar { run, ambient_degc })
    });
    let cars: Vec<PricedCar> = cars.collect();
    dir.write("attribution.csv", |out| write_prices(out, &cars))?;
    dir.write("pairs.csv", |out| write_pairs(out, &cars))?;
    let shared = |car: &PricedCar| car.run.price.as_ref().is_some_and(|p| !p.groups.is_empty());
    if cars.iter().any(shared) {
        dir.write("shapley.csv", |out| write_shares(out, &cars))?;
    }
    for car in &cars {
        let (name, ambient) = (&car.run.vehicle, plain(car.ambient_degc));
        let subject = format!("{name}, {ambient} \u{b0}C");
        let file = match summary.conditions.len() {
            1 => format!("price_{name}.svg"),
            _ => format!("price_{name}_{ambient}.svg"),
        };
        dir.put(&file, price_dots(car.run, &subject).svg)?;
    }
    Ok(())
}
