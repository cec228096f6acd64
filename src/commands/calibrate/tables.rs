//! A calibration as tables: errors first, then the underlying numbers.

use cvtcycle::calibrate::outcome::{Fold, Outcome, Parameter, Residual, Start, rms};
use cvtcycle::output::number::{NONE, fixed, signed};
use cvtcycle::output::table::{TextColumns, TextTable, cut, distinct, paragraphs, wrapped};

use crate::print::colour::Paint;
use crate::print::sections;

/// Maximum number of residuals listed.
const MAX_RESIDUALS: usize = 5;
/// Maximum number of parameter combinations listed.
const MAX_COMBINATIONS: usize = 12;
/// Maximum length of a key in a table. Longer ones are cut at the front, since their ends are unique.
const MAX_KEY_LEN: usize = 30;
/// Maximum length of a name in a table.
const MAX_NAME_LEN: usize = 40;
/// Relative distance from the smallest sum of squares within which a start counts as having found the same minimum.
const SAME_COST: f64 = 1e-3;

/// Prints all results of a calibration.
pub fn tables(outcome: &Outcome, paint: Paint) -> String {
    let warnings = outcome.warnings.iter().map(|text| wrapped(text, "  ! "));
    let data = "Data, root mean square of the residuals in standard deviations";
    let body = [
        ("Quality of the fit", quality(outcome)),
        ("Warnings", warnings.collect()),
        ("Parameters", parameters(outcome)),
        (data, groups(outcome)),
        ("Folds left out", folds(outcome)),
        ("Largest residuals", largest(outcome)),
        ("Not identifiable from the data", not_identified(outcome)),
        ("Starts", starts(outcome)),
    ];
    head(outcome, paint) + &sections(body, paint)
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

fn head(o: &Outcome, paint: Paint) -> String {
    let data = count(o.residuals.len(), "observation");
    let free = count(o.parameters.len(), "parameter");
    let evaluations = count(o.evaluations, "evaluation");
    let (title, plan, vehicle, end) = (paint.heading(&o.title), &o.plan, &o.vehicle, &o.end);
    let mut text = paragraphs(&format!(
        "{title}  {plan}\n{vehicle}: {free} fitted to {data}; {end} after {evaluations}"
    ));
    if !o.converged {
        let failure = "not converged: the values are those of the best point so far, no minimum";
        text += &format!("{}\n", paint.bad(failure));
    }
    text
}

/// Root mean square of the known numbers, and their count.
fn rms_and_count(list: impl Iterator<Item = Option<f64>>) -> (Option<f64>, usize) {
    let known: Vec<f64> = list.flatten().collect();
    (rms(known.iter().copied()), known.len())
}

fn quality(o: &Outcome) -> String {
    let all = o.residuals.len();
    let (before, _) = rms_and_count(o.residuals.iter().map(|r| r.before_sd));
    let (after, _) = rms_and_count(o.residuals.iter().map(|r| Some(r.after_sd)));
    let (left_out, predicted) = rms_and_count(o.residuals.iter().map(|r| r.left_out_sd));
    let how = match predicted {
        0 => "no fold was left out".to_owned(),
        n if n < all => format!("of {n} observations; the others could not be predicted"),
        _ => "each fold by a fit without it".to_owned(),
    };
    let agrees = "to the same data: no evidence that the model is right";
    let mut table = TextTable::new("lrl").indented();
    table.row(["root mean square of the residuals", "in sd", ""]);
    table.row(["with the values of the files", &fixed(before, 2), ""]);
    table.row(["fitted", &fixed(after, 2), agrees]);
    table.row(["predicted", &fixed(left_out, 2), &how]);
    let chance = o.chi2_probability.map_or_else(String::new, |p| {
        let small = p < 0.001 && p > 0.0;
        let p = if small {
            format!("{p:.0e}")
        } else {
            fixed(p, 3)
        };
        format!(", probability of more by chance {p}")
    });
    let [before, after, chi2] = [o.cost_before, Some(o.cost_after), Some(o.chi2)].map(sum);
    let freedom = count(o.degrees_of_freedom, "degree");
    let sums = format!(
        "sum of squares {before} with the values of the files, {after} fitted ({chi2} of it from the data), {freedom} of freedom{chance}"
    );
    let note = "A fit is no validation: fitted numbers agree by construction. The prediction error of the data that were left out \
        estimates the error of a new measurement of the same kind.";
    table.text() + &wrapped(&sums, "  ") + &wrapped(note, "  ")
}

/// Formats a sum of squares, with more decimals for small ones.
fn sum(x: Option<f64>) -> String {
    let small = x.is_some_and(|x| x.abs() < 10.0);
    fixed(x, if small { 3 } else { 1 })
}

/// Formats a number to two significant digits of its standard error.
pub(super) fn to_error(x: f64, error: Option<f64>) -> String {
    let error = error.filter(|e| *e > 0.0 && e.is_finite());
    let scale = error.unwrap_or(x.abs() / 100.0);
    if !x.is_finite() || scale <= 0.0 {
        return fixed(x, 0);
    }
    let decimals = 1 - scale.log10().floor() as i32;
    match usize::try_from(decimals) {
        Ok(decimals) if decimals > 5 => {
            let digits = x.abs().max(scale).log10().floor() - scale.log10().floor() + 1.0;
            format!("{x:.*e}", digits.clamp(0.0, 9.0) as usize)
        }
        Ok(decimals) => fixed(x, decimals),
        Err(_) => fixed(x, 0),
    }
}

/// Shortens a key to its end, from a dot on.
fn short(key: &str) -> String {
    if key.chars().count() <= MAX_KEY_LEN || !key.contains('.') {
        return key.to_owned();
    }
    let mut ends = key.match_indices('.').map(|(at, _)| &key[at + 1..]);
    let end = ends.find(|end| end.chars().count() < MAX_KEY_LEN || !end.contains('.'));
    format!("…{}", end.unwrap_or(key))
}

fn parameters(o: &Outcome) -> String {
    let name = |p: &Parameter| {
        let own = short(&p.name);
        let same = o.parameters.iter().filter(|p| short(&p.name) == own);
        if same.count() == 1 {
            own
        } else {
            p.name.clone()
        }
    };
    let prior = |p: &Parameter| match p.prior {
        Some([mean, sd]) => format!("{} +- {}", to_error(mean, Some(sd)), to_error(sd, Some(sd))),
        None => NONE.to_owned(),
    };
    let share = |p: &Parameter| {
        let share = p
            .prior_share
            .map(|share| format!("{} %", fixed(100.0 * share, 0)));
        share.unwrap_or_else(|| NONE.to_owned())
    };
    let error = |p: &Parameter| {
        let error = p.standard_error.map(|e| to_error(e, Some(e)));
        error.unwrap_or_else(|| NONE.to_owned())
    };
    let table = TextColumns::new()
        .left("parameter", name)
        .right("file", |p: &Parameter| {
            to_error(p.file_value, p.standard_error)
        })
        .right("fitted", |p| to_error(p.value, p.standard_error))
        .right("+-", error)
        .left("unit", |p| p.unit.clone())
        .left("prior", prior)
        .right("share", share)
        .left("bound", |p| p.at_bound.unwrap_or_default())
        // An empty last column keeps comfy-table from wrapping the one before.
        .left("", |_| "")
        .text(&o.parameters);
    if table.is_empty() {
        return table;
    }
    let cut = match o.parameters.iter().any(|p| short(&p.name).starts_with('…')) {
        true => " … replaces the beginning of a key.",
        false => "",
    };
    let note = format!(
        "+-: standard error from the given deviations. share: variance after the fit over that of the prior; near 100 % the data do not \
         determine the parameter.{cut}"
    );
    table + &wrapped(&note, "  ")
}

fn groups(o: &Outcome) -> String {
    let names = distinct(o.residuals.iter().map(|r| r.group.as_str()));
    let group_rms = |get: fn(&Residual) -> Option<f64>| {
        move |name: &&str| rms_and_count(o.residuals.iter().filter(|r| r.group == *name).map(get))
    };
    let (before, after) = (group_rms(|r| r.before_sd), group_rms(|r| Some(r.after_sd)));
    let left_out = group_rms(|r| r.left_out_sd);
    TextColumns::new()
        .left("group", |name: &&str| cut(name, MAX_NAME_LEN))
        .right("n", |name| after(name).1.to_string())
        .number("files", 2, |name| before(name).0)
        .number("fitted", 2, |name| after(name).0)
        .number("predicted", 2, |name| left_out(name).0)
        .text(&names)
}

/// Table of folds; empty if they equal the groups and none failed.
fn folds(o: &Outcome) -> String {
    let is_group = |fold: &Fold| {
        let own = |r: &&Residual| r.fold == fold.name || r.group == fold.name;
        o.residuals.iter().filter(own).all(|r| r.fold == r.group)
    };
    if o.folds
        .iter()
        .all(|fold| is_group(fold) && fold.end == "converged")
    {
        return String::new();
    }
    TextColumns::new()
        .left("fold", |f: &Fold| cut(&f.name, MAX_NAME_LEN))
        .right("n", |f| f.observations.to_string())
        .number("fitted", 2, |f| f.fitted_rms_sd)
        .number("predicted", 2, |f| f.predicted_rms_sd)
        .left("the fit without it", |f| cut(&f.end, MAX_NAME_LEN))
        .text(&o.folds)
}

fn largest(o: &Outcome) -> String {
    let finite = o.residuals.iter().filter(|r| r.after_sd.is_finite());
    let mut worst: Vec<&Residual> = finite.collect();
    worst.sort_by(|a, b| b.after_sd.abs().total_cmp(&a.after_sd.abs()));
    let what = |r: &Residual| match r.what.as_str() {
        "" => r.label.clone(),
        what => format!("{}: {what}", r.label),
    };
    TextColumns::new()
        .right("fitted, sd", |r: &Residual| signed(r.after_sd, 2))
        .right("predicted, sd", |r| signed(r.left_out_sd, 2))
        .right("measured", measured)
        .right("computed", |r| to_error(r.after, Some(r.sd)))
        .left("unit", |r| r.unit.clone())
        .left("observation", what)
        .text(worst.into_iter().take(MAX_RESIDUALS))
}

fn measured(r: &Residual) -> String {
    let text = |x: f64| to_error(x, Some(r.sd));
    match (r.low, r.high) {
        (Some(a), Some(b)) if a.total_cmp(&b).is_eq() => text(a),
        (Some(a), Some(b)) => format!("{} .. {}", text(a), text(b)),
        (Some(a), None) => format!("from {}", text(a)),
        (None, Some(b)) => format!("up to {}", text(b)),
        (None, None) => NONE.to_owned(),
    }
}

fn not_identified(o: &Outcome) -> String {
    let shown = o.not_identified.iter().take(MAX_COMBINATIONS);
    let mut text: String = shown.map(|line| wrapped(line, "  - ")).collect();
    let more = o.not_identified.len().saturating_sub(MAX_COMBINATIONS);
    if more > 0 {
        text += &format!("  and {more} more: `not_identified` of --json\n");
    }
    text
}

fn starts(o: &Outcome) -> String {
    if o.starts.is_empty() {
        return String::new();
    }
    let max = o.cost_after * (1.0 + SAME_COST) + 1e-9;
    let is_same = |cost: Option<f64>| cost.is_some_and(|cost| cost <= max);
    let starts = o.starts.iter().enumerate();
    let others = || starts.clone().filter(|(_, start)| !is_same(start.cost));
    let (all, smallest) = (o.starts.len(), fixed(o.cost_after, 3));
    let reached = all - others().count();
    let other = |(k, start): (usize, &Start)| {
        let (number, cost, end) = (k + 1, fixed(start.cost, 3), &start.end);
        let text = format!("start {number}: sum of squares {cost}; {end}");
        wrapped(&text, "  ")
    };
    format!("  {reached} of {all} reached the same smallest sum of squares, {smallest}\n")
        + &others().map(other).collect::<String>()
}
