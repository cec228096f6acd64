//! Checks that the files of a run belong together.

use std::path::Path;

use super::problems::problem;
use cvtcycle_config::Problem;
use cvtcycle_output::history::History;
use cvtcycle_output::summary::RunSummary;

/// Relative difference that rounding in sums over a whole trace may leave.
const ROUNDING: f64 = 1e-6;

fn near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= ROUNDING * scale.abs() + 1e-9
}

/// Whether the numbers of a car agree with each other: fuel with distance, and the terms of the ledger with the fuel.
pub(crate) fn consistent(file: &Path, run: &RunSummary) -> Result<(), Problem> {
    let ledger = |name: &str| run.ledger_kj.get(name).unwrap_or(0.0);
    let terms: f64 = [
        "wheels",
        "brake",
        "losses",
        "accessories",
        "kinetic",
        "engine_heat",
        "exhaust",
    ]
    .into_iter()
    .map(ledger)
    .sum();
    let fuel = run
        .fuel_l_per_100km
        .is_none_or(|fuel| near(fuel * run.distance_km / 100.0, run.fuel_l, run.fuel_l));
    // A run whose ledger did not close has said so itself.
    let open = run
        .failed_checks
        .iter()
        .any(|check| check == "ledger_error");
    if fuel
        && (open
            || (near(terms, run.fuel_energy_kj, run.fuel_energy_kj)
                && near(ledger("fuel"), run.fuel_energy_kj, run.fuel_energy_kj)))
    {
        return Ok(());
    }
    let message = format!(
        "the numbers of {} do not agree with each other: fuel, distance and the terms of its energy ledger",
        run.vehicle
    );
    Err(problem(
        file,
        &message,
        "the file has been changed; run it again",
    ))
}

/// Whether a trace is that of the summary: as long, with the same fuel and the same losses.
pub(crate) fn belongs(path: &Path, run: &RunSummary, history: &History) -> Result<(), Problem> {
    let sum = |name: &str| {
        history
            .column(name)
            .iter()
            .zip(history.dt_s())
            .map(|(x, dt)| x * dt)
            .filter(|x| x.is_finite())
            .sum::<f64>()
    };
    let losses: f64 = history
        .components()
        .iter()
        .map(|c| sum(&format!("{}_loss_w", c.name())))
        .sum::<f64>()
        / 1e3;
    let sums = [
        (
            "time",
            "s",
            history.dt_s().iter().sum::<f64>(),
            run.duration_s,
        ),
        ("fuel", "g", sum("fuel_g_s"), run.fuel_kg * 1e3),
        (
            "losses of the transmission",
            "kJ",
            losses,
            run.transmission_loss_kj(),
        ),
    ];
    let Some((what, unit, here, there)) = sums
        .into_iter()
        .find(|(_, _, here, there)| !near(*here, *there, *there))
    else {
        return Ok(());
    };
    let message = format!(
        "the trace of {} is not that of the summary: {what} of {here:.3} {unit} in the trace, {there:.3} {unit} in summary.json",
        run.vehicle
    );
    let file = ["csv", "parquet"]
        .map(|ending| path.join(format!("trace_{}.{ending}", run.vehicle)))
        .into_iter()
        .find(|file| file.exists());
    Err(problem(
        &file.unwrap_or_else(|| path.to_path_buf()),
        &message,
        "the file has been cut or belongs to another run; run it again",
    ))
}
