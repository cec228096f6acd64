//! Pictures of a calibration: measured against computed numbers, before and after, and the parameters.

mod correlation;
mod parameters;
mod residuals;
mod scatter;
mod trace;

use super::engine::{PLOT_LEFT, Symbol, WIDTH, optional_cell, round_step};
use super::picture::Picture;
use crate::number::sign;
use cvtcycle_calibrate::outcome::{Outcome, Residual};
use cvtcycle_output::table::distinct;

pub use correlation::correlation_plot;
pub use parameters::parameters_plot;
pub use residuals::residuals_plot;
pub use scatter::scatter_plot;
pub use trace::trace_plots;

/// Edges of the plots, and left edge of titles and notes of pictures with rows, pixels.
const RIGHT: f64 = WIDTH - 24.0;
const TOP: f64 = 58.0;
const MARGIN: f64 = 12.0;
/// Left edge and width of blocks below the plots, pixels.
const FOOT: (f64, f64) = (PLOT_LEFT, RIGHT - PLOT_LEFT);
const WIDE_FOOT: (f64, f64) = (MARGIN, RIGHT - MARGIN);
/// Maximum number of drawn observations; longer traces are thinned to every second or third value and so on.
const MAX_SHOWN: usize = 600;
/// Colours of computed numbers: with the files' values, fitted, predicted.
const BEFORE: &str = "#777777";
const AFTER: &str = "#0072b2";
const LEFT_OUT: &str = "#d55e00";

/// Draws all pictures that the outcome has data for, with names that are valid file names.
pub fn calibration_pictures(outcome: &Outcome) -> Vec<(String, Picture)> {
    let mut list = Vec::new();
    if !outcome.residuals.is_empty() {
        list.push(("measured_computed".to_owned(), scatter_plot(outcome)));
        list.push(("residuals".to_owned(), residuals_plot(outcome)));
    }
    if !outcome.parameters.is_empty() {
        list.push(("parameters".to_owned(), parameters_plot(outcome)));
    }
    if outcome.parameters.len() > 1 {
        list.push(("correlation".to_owned(), correlation_plot(outcome)));
    }
    list.extend(trace_plots(outcome));
    list
}

/// The line below the title.
fn subject(outcome: &Outcome) -> String {
    let (data, free) = (outcome.residuals.len(), outcome.parameters.len());
    let s = |n: usize| if n == 1 { "" } else { "s" };
    format!(
        "{}: {}, {data} observation{}, {free} parameter{}",
        outcome.title,
        outcome.vehicle,
        s(data),
        s(free)
    )
}

/// Names of the groups in the order of the data.
fn groups(outcome: &Outcome) -> Vec<&str> {
    distinct(outcome.residuals.iter().map(|r| r.group.as_str()))
}

/// Symbol of a group, the same in every picture.
fn symbol(groups: &[&str], name: &str) -> (Symbol, &'static str) {
    Symbol::nth(groups.iter().position(|group| *group == name).unwrap_or(0))
}

/// Indices of the shown observations, by group, and a remark on the omitted ones.
fn shown(outcome: &Outcome) -> (Vec<usize>, Option<String>) {
    let all = &outcome.residuals;
    let traced = all.iter().filter(|r| r.time_s.is_some()).count();
    let single = all.len() - traced;
    // Traces are thinned first: neighbouring values look alike.
    let room = MAX_SHOWN.saturating_sub(single).max(MAX_SHOWN / 2);
    let of_traces = traced.div_ceil(room).max(1);
    let of_single = single.div_ceil(MAX_SHOWN).max(1);
    let names = groups(outcome);
    let (mut counts, mut kept) = ([0_usize; 2], Vec::new());
    for name in names {
        for (k, r) in all.iter().enumerate().filter(|(_, r)| r.group == name) {
            let kind = usize::from(r.time_s.is_some());
            if counts[kind].is_multiple_of([of_single, of_traces][kind]) {
                kept.push(k);
            }
            counts[kind] += 1;
        }
    }
    let (count, all) = (kept.len(), all.len());
    let note = format!("{count} of {all} observations are shown; residuals.csv has all.");
    let note = (count < all).then_some(note);
    (kept, note)
}

/// Formats a unit for a bracket.
fn unit(unit: &str) -> &str {
    match unit {
        "" => "-",
        // Keys spell it this way.
        "N m" => "Nm",
        other => sign(other),
    }
}

/// Name of an observation.
fn label(r: &Residual) -> String {
    if r.what.is_empty() {
        r.label.clone()
    } else {
        format!("{}: {}", r.label, r.what)
    }
}

/// Formats a number of an observation as a cell, with three digits of its standard deviation.
fn in_sd(x: Option<f64>, r: &Residual) -> String {
    let known = r.sd > 0.0 && r.sd.is_finite();
    let scale = if known { r.sd } else { 1.0 };
    optional_cell(x, round_step(scale / 200.0))
}

/// Sentence that must accompany the computed numbers if a group has a common error.
fn common_note(outcome: &Outcome) -> Option<String> {
    let common = outcome.parameters.iter().any(|p| !p.is_key);
    common.then(|| {
        "Computed numbers are without the common error of a group; residuals are with it."
            .to_owned()
    })
}

/// Title: reduction of the distance between computed and measured numbers by the fit.
fn rms_title(outcome: &Outcome) -> String {
    match outcome.rms_sd() {
        [Some(before), Some(after), _] => {
            let [before, after] = [before, after].map(|x| format!("{x:.2}"));
            let moved = if before == after {
                format!("leaves the residuals at {after}")
            } else {
                format!("brings the residuals from {before} to {after}")
            };
            format!("The fit {moved} standard deviations (root mean square)")
        }
        _ => "Measured and computed".to_owned(),
    }
}

/// Root mean square of the residuals, for the picture in words.
fn rms_in_words(outcome: &Outcome) -> String {
    let number = |x: Option<f64>| x.map_or_else(|| "not known".to_owned(), |x| format!("{x:.2}"));
    let [before, after, left_out] = outcome.rms_sd().map(number);
    format!(
        "Root mean square of the residuals in standard deviations: {before} with the files' values, {after} fitted, {left_out} predicted"
    )
}
