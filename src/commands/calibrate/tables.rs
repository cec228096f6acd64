//! A calibration as tables: errors first, then the numbers behind them.

use cvtcycle::study::fit::outcome::{Fold, Outcome, Parameter, Residual, rms};

use crate::print::colour::Paint;
use crate::print::table::{TextColumns, TextTable, WIDTH, cut};
use cvtcycle::output::number::{NONE, fixed, signed};

/// Number of residuals that are listed.
const MAX_RESIDUALS: usize = 5;
/// Number of combinations of parameters that are listed.
const MAX_COMBINATIONS: usize = 12;
/// Longest key in a table; of longer ones the end is shown, which is unique.
const MAX_KEY_LEN: usize = 30;
/// Longest name in a table.
const MAX_NAME_LEN: usize = 40;
/// A start within this share of the smallest sum of squares found the same minimum.
const SAME_COST: f64 = 1e-3;

/// Everything that a person wants to see of a calibration.
pub fn tables(outcome: &Outcome, paint: Paint) -> String {
    let warnings = outcome
        .warnings
        .iter()
        .map(|warning| wrapped(warning, "  ! "));
    let sections = [
        ("Quality of the fit", quality(outcome)),
        ("Warnings", warnings.collect()),
        ("Parameters", parameters(outcome)),
        (
            "Data, root mean square of the residuals in standard deviations",
            groups(outcome),
        ),
        ("Folds left out", folds(outcome)),
        ("Largest residuals", largest(outcome)),
        ("Not identifiable from the data", not_identified(outcome)),
        ("Starts", starts(outcome)),
    ];
    let shown = sections.iter().filter(|(_, body)| !body.is_empty());
    let section = |(title, body): &(&str, String)| format!("\n{}\n{body}", paint.heading(title));
    head(outcome, paint) + &shown.map(section).collect::<String>()
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A sentence wrapped to the width of the tables, with a mark before its first line.
fn wrapped(sentence: &str, mark: &str) -> String {
    let mut table = TextTable::new("l");
    let blank = " ".repeat(mark.chars().count());
    table.row([sentence]);
    let text = table.width(usize::from(WIDTH) - blank.len()).text();
    let marks = [mark].into_iter().chain(std::iter::repeat(blank.as_str()));
    text.lines()
        .zip(marks)
        .map(|(line, mark)| format!("{mark}{line}\n"))
        .collect()
}

fn head(o: &Outcome, paint: Paint) -> String {
    let data = count(o.residuals.len(), "observation");
    let free = count(o.parameters.len(), "parameter");
    let evaluations = count(o.evaluations, "evaluation");
    let mut text = format!(
        "{}  {}\n{}: {free} fitted to {data}; {} after {evaluations}\n",
        paint.heading(&o.title),
        o.plan,
        o.vehicle,
        o.end
    );
    if !o.converged {
        let failure = "not converged: the values are those of the best point so far, no minimum";
        text += &format!("{}\n", paint.bad(failure));
    }
    text
}

/// Root mean square of the known numbers, and how many they are.
fn rms_of(list: impl Iterator<Item = Option<f64>>) -> (Option<f64>, usize) {
    let known: Vec<f64> = list.flatten().collect();
    (rms(known.iter().copied()), known.len())
}

fn quality(o: &Outcome) -> String {
    let all = o.residuals.len();
    let (before, _) = rms_of(o.residuals.iter().map(|r| r.before_sd));
    let (after, _) = rms_of(o.residuals.iter().map(|r| Some(r.after_sd)));
    let (left_out, predicted) = rms_of(o.residuals.iter().map(|r| r.left_out_sd));
    let how = match predicted {
        0 => "no fold was left out".to_owned(),
        n if n < all => format!("of {n} observations; the others could not be predicted"),
        _ => "each fold by a fit without it".to_owned(),
    };
    let mut table = TextTable::new("lrl").indented();
    table.row(["root mean square of the residuals", "in sd", ""]);
    table.row(["with the values of the files", &fixed(before, 2), ""]);
    table.row([
        "fitted",
        &fixed(after, 2),
        "to the same data: no evidence that the model is right",
    ]);
    table.row(["predicted", &fixed(left_out, 2), &how]);
    let chance = o.chi2_probability.map_or_else(String::new, |p| {
        let p = if p < 0.001 && p > 0.0 {
            format!("{p:.0e}")
        } else {
            fixed(p, 3)
        };
        format!(", probability of more by chance {p}")
    });
    let sums = format!(
        "sum of squares {} with the values of the files, {} fitted ({} of it from the data), {} of freedom{chance}",
        sum(o.cost_before),
        sum(Some(o.cost_after)),
        sum(Some(o.chi2)),
        count(o.degrees_of_freedom, "degree"),
    );
    let note = "A fit is no validation: fitted numbers agree by construction. The prediction error of the data that were left out \
        estimates the error of a new measurement of the same kind.";
    table.text() + &wrapped(&sums, "  ") + &wrapped(note, "  ")
}

/// A sum of squares: small ones with more decimals.
fn sum(x: Option<f64>) -> String {
    fixed(
        x,
        if x.is_some_and(|x| x.abs() < 10.0) {
            3
        } else {
            1
        },
    )
}

/// A number with the decimals that its error leaves meaningful: two digits of the error.
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

/// The end of a key, from a dot on.
fn short(key: &str) -> String {
    if key.chars().count() <= MAX_KEY_LEN || !key.contains('.') {
        return key.to_owned();
    }
    let mut ends = key.match_indices('.').map(|(at, _)| &key[at + 1..]);
    let last = key.rsplit('.').next().unwrap_or(key);
    format!(
        "…{}",
        ends.find(|end| end.chars().count() < MAX_KEY_LEN)
            .unwrap_or(last)
    )
}

fn parameters(o: &Outcome) -> String {
    if o.parameters.is_empty() {
        return String::new();
    }
    let name = |p: &Parameter| {
        let unique = o
            .parameters
            .iter()
            .filter(|other| short(&other.name) == short(&p.name))
            .count()
            == 1;
        if unique {
            short(&p.name)
        } else {
            p.name.clone()
        }
    };
    let prior = |p: &Parameter| match p.prior {
        Some([mean, sd]) => format!("{} +- {}", to_error(mean, Some(sd)), to_error(sd, Some(sd))),
        None => NONE.to_owned(),
    };
    let share = |p: &Parameter| {
        p.prior_share.map_or_else(
            || NONE.to_owned(),
            |share| format!("{} %", fixed(100.0 * share, 0)),
        )
    };
    let error = |p: &Parameter| {
        p.standard_error
            .map_or_else(|| NONE.to_owned(), |e| to_error(e, Some(e)))
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
        // The last column would be wrapped: an empty one.
        .left("", |_| "")
        .table(&o.parameters);
    let cut = match o.parameters.iter().any(|p| short(&p.name).starts_with('…')) {
        true => " … replaces the beginning of a key.",
        false => "",
    };
    let note = format!(
        "+-: standard error from the given deviations. share: variance after the fit over that of the prior; near 100 % the data do not \
         determine the parameter.{cut}"
    );
    table.indented().text() + &wrapped(&note, "  ")
}

fn groups(o: &Outcome) -> String {
    let mut names: Vec<&str> = Vec::new();
    for r in &o.residuals {
        if !names.contains(&r.group.as_str()) {
            names.push(&r.group);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let of = |get: fn(&Residual) -> Option<f64>| {
        move |name: &&str| {
            fixed(
                rms_of(o.residuals.iter().filter(|r| r.group == *name).map(get)).0,
                2,
            )
        }
    };
    TextColumns::new()
        .left("group", |name: &&str| cut(name, MAX_NAME_LEN))
        .right("n", |name| {
            o.residuals
                .iter()
                .filter(|r| r.group == *name)
                .count()
                .to_string()
        })
        .right("files", of(|r| r.before_sd))
        .right("fitted", of(|r| Some(r.after_sd)))
        .right("predicted", of(|r| r.left_out_sd))
        .table(&names)
        .indented()
        .text()
}

/// The folds, if they are not the groups or one of them failed.
fn folds(o: &Outcome) -> String {
    let is_group = |name: &str| {
        let mut own = o
            .residuals
            .iter()
            .filter(|r| r.fold == name || r.group == name);
        own.all(|r| r.fold == r.group)
    };
    if o.folds
        .iter()
        .all(|fold| is_group(&fold.name) && fold.end == "converged")
    {
        return String::new();
    }
    TextColumns::new()
        .left("fold", |f: &Fold| cut(&f.name, MAX_NAME_LEN))
        .right("n", |f| f.observations.to_string())
        .right("fitted", |f| fixed(f.fitted_rms_sd, 2))
        .right("predicted", |f| fixed(f.predicted_rms_sd, 2))
        .left("the fit without it", |f| cut(&f.end, MAX_NAME_LEN))
        .table(&o.folds)
        .indented()
        .text()
}

fn largest(o: &Outcome) -> String {
    let mut worst: Vec<&Residual> = o
        .residuals
        .iter()
        .filter(|r| r.after_sd.is_finite())
        .collect();
    if worst.is_empty() {
        return String::new();
    }
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
        .table(worst.into_iter().take(MAX_RESIDUALS))
        .indented()
        .text()
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
    let shown = o
        .not_identified
        .iter()
        .take(MAX_COMBINATIONS)
        .map(|line| wrapped(line, "  - "));
    let mut text: String = shown.collect();
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
    let numbered = o.starts.iter().enumerate();
    let others: Vec<_> = numbered.filter(|(_, start)| !is_same(start.cost)).collect();
    let (all, reached) = (o.starts.len(), o.starts.len() - others.len());
    let mut text = format!(
        "  {reached} of {all} reached the same smallest sum of squares, {}\n",
        fixed(o.cost_after, 3)
    );
    for (k, start) in others {
        let (number, cost, end) = (k + 1, fixed(start.cost, 3), &start.end);
        text += &wrapped(
            &format!("start {number}: sum of squares {cost}; {end}"),
            "  ",
        );
    }
    text
}
