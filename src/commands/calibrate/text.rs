//! What a calibration says, for people: what it is worth first, then the numbers behind it.

use cvtcycle::study::fit::outcome::{Outcome, Residual, rms};

use crate::print::colour::Paint;
use crate::print::grid::{Grid, WIDTH};
use cvtcycle::output::number::{NONE, fixed, signed};

/// Largest residuals that are told.
const TOLD: usize = 5;
/// Combinations of parameters that are told.
const UNKNOWN: usize = 12;
/// Longest key in a table; of longer ones the end is shown, which tells them apart.
const KEY: usize = 30;
/// Longest name in a table.
const NAME: usize = 40;
/// A start within this share of the least sum of squares found the same minimum.
const SAME_COST: f64 = 1e-3;

/// Everything that a person wants to see of a calibration.
pub fn answer(outcome: &Outcome, paint: Paint) -> String {
    let mut text = head(outcome, paint);
    let mut section = |title: &str, body: String| {
        if !body.is_empty() {
            text += &format!("\n{}\n{body}", paint.heading(title));
        }
    };
    section("What the fit is worth", worth(outcome));
    section(
        "Warnings",
        outcome
            .warnings
            .iter()
            .map(|said| lines(said, "  ! "))
            .collect(),
    );
    section("Parameters", parameters(outcome));
    section(
        "Data, root mean square of the residuals in standard deviations",
        groups(outcome),
    );
    section("Folds left out", folds(outcome));
    section("Largest residuals", largest(outcome));
    section("What the data do not tell", unknown(outcome));
    section("Starts", starts(outcome));
    text
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

/// A sentence in as many lines as it takes, the first with a mark before it, the others as far in.
fn lines(sentence: &str, mark: &str) -> String {
    let room = usize::from(WIDTH) - mark.chars().count();
    let mut done: Vec<String> = Vec::new();
    for word in sentence.split_whitespace() {
        match done.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => done.push(word.to_owned()),
        }
    }
    let blank = " ".repeat(mark.chars().count());
    done.iter()
        .enumerate()
        .map(|(k, line)| format!("{}{line}\n", if k == 0 { mark } else { &blank }))
        .collect()
}

fn head(o: &Outcome, paint: Paint) -> String {
    let mut text = format!("{}  {}\n", paint.heading(&o.title), o.plan);
    let (data, free) = (
        count(o.residuals.len(), "observation"),
        count(o.parameters.len(), "parameter"),
    );
    text += &format!(
        "{}: {free} fitted to {data}; {} after {}\n",
        o.vehicle,
        o.end,
        count(o.evaluations, "evaluation")
    );
    if !o.converged {
        text += &format!(
            "{}\n",
            paint.bad("not converged: the values are those of the best point so far, no minimum")
        );
    }
    text
}

/// Root mean square of those that are there, and how many they are.
fn of(list: impl Iterator<Item = Option<f64>>) -> (Option<f64>, usize) {
    let there: Vec<f64> = list.flatten().collect();
    (rms(there.iter().copied()), there.len())
}

fn worth(o: &Outcome) -> String {
    let all = o.residuals.len();
    let (before, _) = of(o.residuals.iter().map(|r| r.before_sd));
    let (after, _) = of(o.residuals.iter().map(|r| Some(r.after_sd)));
    let (left_out, predicted) = of(o.residuals.iter().map(|r| r.left_out_sd));
    let mut grid = Grid::new("lrl").indented();
    grid.row(["root mean square of the residuals", "in sd", ""]);
    grid.row([
        "with the files' values".to_owned(),
        fixed(before, 2),
        String::new(),
    ]);
    grid.row([
        "fitted".to_owned(),
        fixed(after, 2),
        "to the same data: no evidence that the model is right".to_owned(),
    ]);
    let how = match predicted {
        0 => "no fold was left out".to_owned(),
        n if n < all => format!("of {n} observations; the others could not be predicted"),
        _ => "each fold by a fit that has not seen it".to_owned(),
    };
    grid.row(["predicted".to_owned(), fixed(left_out, 2), how]);
    let mut text = grid.text();
    let chance = o.chi2_probability.map_or_else(String::new, |p| {
        format!(", probability of more by chance {}", probability(p))
    });
    let sums = format!(
        "sum of squares {} with the files' values, {} fitted ({} of it the data's), {}{chance}",
        sum(o.cost_before),
        sum(Some(o.cost_after)),
        sum(Some(o.chi2)),
        count(o.degrees_of_freedom, "degree") + " of freedom",
    );
    text += &lines(&sums, "  ");
    text += &lines(
        "A fit is no validation: fitted numbers agree because they were asked to. How far off a new measurement may be is told by the \
         prediction error of what was left out, and only as far as it is like these data.",
        "  ",
    );
    text
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

fn probability(p: f64) -> String {
    if p < 0.001 && p > 0.0 {
        format!("{p:.0e}")
    } else {
        fixed(p, 3)
    }
}

/// A number with as many decimals as its error leaves meaningful: two digits of the error.
pub(super) fn to_error(x: f64, error: Option<f64>) -> String {
    let scale = error
        .filter(|e| *e > 0.0 && e.is_finite())
        .unwrap_or(x.abs() / 100.0);
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
    if key.chars().count() <= KEY || !key.contains('.') {
        return key.to_owned();
    }
    let mut ends = key.match_indices('.').map(|(at, _)| &key[at + 1..]);
    let last = key.rsplit('.').next().unwrap_or(key);
    format!(
        "…{}",
        ends.find(|end| end.chars().count() < KEY).unwrap_or(last)
    )
}

fn parameters(o: &Outcome) -> String {
    if o.parameters.is_empty() {
        return String::new();
    }
    let shortened: Vec<String> = o.parameters.iter().map(|p| short(&p.name)).collect();
    // An empty last column, for the last one would be wrapped.
    let mut grid = Grid::new("lrrrllrll").indented();
    grid.row([
        "parameter",
        "file",
        "fitted",
        "+-",
        "unit",
        "prior",
        "share",
        "bound",
        "",
    ]);
    for (p, name) in o.parameters.iter().zip(&shortened) {
        let alone = shortened.iter().filter(|other| *other == name).count() == 1;
        let prior = p.prior.map_or_else(
            || NONE.to_owned(),
            |[mean, sd]| format!("{} +- {}", to_error(mean, Some(sd)), to_error(sd, Some(sd))),
        );
        grid.row([
            if alone { name.clone() } else { p.name.clone() },
            to_error(p.file_value, p.standard_error),
            to_error(p.value, p.standard_error),
            p.standard_error
                .map_or_else(|| NONE.to_owned(), |e| to_error(e, Some(e))),
            p.unit.clone(),
            prior,
            p.prior_share.map_or_else(
                || NONE.to_owned(),
                |share| format!("{} %", fixed(100.0 * share, 0)),
            ),
            p.at_bound.unwrap_or_default().to_owned(),
            String::new(),
        ]);
    }
    let cut = if shortened.iter().any(|name| name.starts_with('…')) {
        " … stands for the beginning of a key."
    } else {
        ""
    };
    let words = format!(
        "+-: standard error from the given deviations. share: variance after the fit over that of the prior; near 100 % the data say nothing.{cut}"
    );
    grid.text() + &lines(&words, "  ")
}

fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        text.to_owned()
    } else {
        text.chars().take(most - 1).collect::<String>() + "…"
    }
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
    let mut grid = Grid::new("lrrrr").indented();
    grid.row(["group", "n", "files", "fitted", "predicted"]);
    for name in names {
        let own = || o.residuals.iter().filter(|r| r.group == name);
        let numbers = [
            of(own().map(|r| r.before_sd)),
            of(own().map(|r| Some(r.after_sd))),
            of(own().map(|r| r.left_out_sd)),
        ];
        let cells = numbers.map(|(x, _)| fixed(x, 2));
        grid.row(
            [cut(name, NAME), own().count().to_string()]
                .into_iter()
                .chain(cells),
        );
    }
    grid.text()
}

/// The folds, where they are not the groups or one of them failed.
fn folds(o: &Outcome) -> String {
    let is_group = |name: &str| {
        o.residuals
            .iter()
            .filter(|r| r.fold == name || r.group == name)
            .all(|r| r.fold == r.group)
    };
    if o.folds
        .iter()
        .all(|fold| is_group(&fold.name) && fold.end == "converged")
    {
        return String::new();
    }
    let mut grid = Grid::new("lrrrl").indented();
    grid.row(["fold", "n", "fitted", "predicted", "the fit without it"]);
    for fold in &o.folds {
        let numbers = [
            fixed(fold.fitted_rms_sd, 2),
            fixed(fold.predicted_rms_sd, 2),
        ];
        grid.row(
            [cut(&fold.name, NAME), fold.observations.to_string()]
                .into_iter()
                .chain(numbers)
                .chain([cut(&fold.end, NAME)]),
        );
    }
    grid.text()
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
    let mut grid = Grid::new("rrrrll").indented();
    grid.row([
        "fitted, sd",
        "predicted, sd",
        "measured",
        "computed",
        "unit",
        "observation",
    ]);
    for r in worst.into_iter().take(TOLD) {
        let what = if r.what.is_empty() {
            r.label.clone()
        } else {
            format!("{}: {}", r.label, r.what)
        };
        grid.row([
            signed(r.after_sd, 2),
            signed(r.left_out_sd, 2),
            measured(r),
            to_error(r.after, Some(r.sd)),
            r.unit.clone(),
            what,
        ]);
    }
    grid.text()
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

fn unknown(o: &Outcome) -> String {
    let rest = o.not_identified.len().saturating_sub(UNKNOWN);
    let more = if rest > 0 {
        format!("  and {rest} more: `not_identified` of --json\n")
    } else {
        String::new()
    };
    o.not_identified
        .iter()
        .take(UNKNOWN)
        .map(|said| lines(said, "  - "))
        .collect::<String>()
        + &more
}

fn starts(o: &Outcome) -> String {
    if o.starts.is_empty() {
        return String::new();
    }
    let same = |cost: Option<f64>| {
        cost.is_some_and(|cost| cost <= o.cost_after * (1.0 + SAME_COST) + 1e-9)
    };
    let reached = o.starts.iter().filter(|start| same(start.cost)).count();
    let mut text = format!(
        "  {reached} of {} reached the same least sum of squares, {}\n",
        o.starts.len(),
        fixed(o.cost_after, 3)
    );
    for (k, start) in o
        .starts
        .iter()
        .enumerate()
        .filter(|(_, start)| !same(start.cost))
    {
        text += &lines(
            &format!(
                "start {}: sum of squares {}; {}",
                k + 1,
                fixed(start.cost, 3),
                start.end
            ),
            "  ",
        );
    }
    text
}
