//! Problems of result files: unreadable, or not of one run.

use std::path::Path;

use cvtcycle_config::Problem;
use cvtcycle_config::bounded::ReadError;
use cvtcycle_output::Component;
use cvtcycle_output::history::History;
use cvtcycle_output::summary::RunSummary;

use crate::charts::figures::TERMS;

/// A problem of a file.
pub(crate) fn problem(path: &Path, message: &str, hint: &str) -> Problem {
    Problem::invalid(message)
        .in_file(path.display().to_string())
        .hint(hint)
}

/// A file or directory that cannot be read.
pub(crate) fn unreadable(path: &Path, error: &ReadError) -> Problem {
    let hint = match error.kind() {
        std::io::ErrorKind::NotFound => "check the path; it is taken from the current directory",
        std::io::ErrorKind::NotADirectory => "name the directory, not a file in it",
        _ => "check the path and its permissions",
    };
    let allowed = error.allowed("");
    problem(
        path,
        &format!("cannot read {}: {error}", path.display()),
        error.hint(hint),
    )
    .allowed(allowed)
}

/// Maximum relative rounding difference of sums over a whole trace.
const ROUNDING: f64 = 1e-6;

fn near(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= ROUNDING * scale.abs() + 1e-9
}

/// Checks that the numbers of a car agree: fuel with distance, and the terms of the ledger with the fuel.
pub(crate) fn consistent(file: &Path, run: &RunSummary) -> Result<(), Problem> {
    let term = |name: &str| run.term_kj(name).unwrap_or(0.0);
    let terms: f64 = TERMS.iter().map(|(name, ..)| term(name)).sum();
    let litres = |fuel: f64| fuel * run.distance_km / 100.0;
    let fuel = run.fuel_l_per_100km;
    let fuel = fuel.is_none_or(|fuel| near(litres(fuel), run.fuel_l, run.fuel_l));
    // A run with an open ledger has already reported it.
    let mut failed = run.failed_checks.iter();
    let open = failed.any(|check| ["ledger_error", "not_finite"].contains(&check.as_str()));
    let closes = |kj: f64| near(kj, run.fuel_energy_kj, run.fuel_energy_kj);
    if fuel && (open || (closes(terms) && closes(term("fuel")))) {
        return Ok(());
    }
    let message = format!(
        "the numbers of {} do not agree with each other: fuel, distance and the terms of its energy ledger",
        run.vehicle
    );
    let hint = "the file has been changed; run it again";
    Err(problem(file, &message, hint))
}

/// Checks that a trace matches the summary: same duration, fuel and losses.
pub(crate) fn belongs(path: &Path, run: &RunSummary, history: &History) -> Result<(), Problem> {
    let dt = history.dt_s();
    let sum = |name: &str| -> f64 {
        let steps = history.column(name).iter().zip(dt);
        steps.map(|(x, dt)| x * dt).filter(|x| x.is_finite()).sum()
    };
    let loss = |c: &Component| sum(&format!("{}_loss_w", c.name()));
    let losses = history.components().iter().map(loss).sum::<f64>() / 1e3;
    let loss = run.transmission_loss_kj();
    let sums = [
        ("time", "s", dt.iter().sum::<f64>(), run.duration_s),
        ("fuel", "g", sum("fuel_g_s"), run.fuel_kg * 1e3),
        ("losses of the transmission", "kJ", losses, loss),
    ];
    let apart = |(_, _, here, there): &(_, _, f64, f64)| !near(*here, *there, *there);
    let Some((what, unit, here, there)) = sums.into_iter().find(apart) else {
        return Ok(());
    };
    let message = format!(
        "the trace of {} is not that of the summary: {what} of {here:.3} {unit} in the trace, {there:.3} {unit} in summary.json",
        run.vehicle
    );
    let file = |ending| path.join(format!("trace_{}.{ending}", run.vehicle));
    let mut files = ["csv", "parquet"].map(file).into_iter();
    let file = files.find(|file| file.exists());
    let hint = "the file has been cut or belongs to another run; run it again";
    Err(problem(file.as_deref().unwrap_or(path), &message, hint))
}
