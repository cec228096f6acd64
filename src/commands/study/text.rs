//! What a study says, for people: the answer first, then the numbers behind it.

use std::path::{Path, PathBuf};

use cvtcycle::report::found::StudyFound;
use cvtcycle::study::answer::{Comparison, OutputAnswer};
use cvtcycle::study::{Answer, StudyManifest};

use super::matrix;
use crate::print::colour::Paint;
use crate::print::grid::Grid;
use cvtcycle::output::number::{fixed, signed};

/// Factors that are told of each output.
const TOLD: usize = 10;

/// Everything that a person wants to see of a study.
pub fn answer(study: &StudyFound, paint: Paint) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let mut text = head(study, paint);
    if let Some(matrix) = &answer.matrix {
        return text + &matrix::tables(matrix, paint);
    }
    if !answer.comparisons.is_empty() {
        text += &format!("\n{}\n", paint.heading("Answer"));
        let drawn = outline.plan.design.is_sampled();
        text.extend(
            answer
                .comparisons
                .iter()
                .map(|comparison| compared(comparison, answer, drawn)),
        );
        text.extend(
            answer
                .comparisons
                .iter()
                .filter_map(|comparison| decided(comparison, answer, outline)),
        );
    }
    text += &format!("\n{}\n{}", paint.heading("Outputs"), outputs(answer));
    text + &factors(answer, outline, paint)
}

fn head(study: &StudyFound, paint: Paint) -> String {
    let (answer, outline) = (&study.answer, &study.outline);
    let mut text = format!("{}\n", paint.heading(&answer.title));
    if !answer.question.is_empty() {
        text += &format!("{}\n", answer.question);
    }
    let runs = &answer.runs;
    let design = design(outline);
    let count = outline.points * outline.cars.len() as u64;
    text += &format!(
        "{design}; {} points, {count} runs of {}\n",
        answer.points,
        outline.cars.join(", ")
    );
    let (there, all) = study.parts();
    if there < all {
        text += &format!(
            "not finished: {there} of {all} parts, {} of {} points; what follows is theirs\n",
            answer.points_done, answer.points
        );
    }
    let bad = runs.failed + runs.not_run;
    if bad > 0 {
        text += &format!(
            "{bad} runs have no good numbers ({} failed a check, {} could not be run) and are left out below\n",
            runs.failed, runs.not_run
        );
    }
    text
}

fn design(outline: &StudyManifest) -> String {
    use cvtcycle::study::plan::Design;
    let factors = match outline.plan.factors.len() {
        1 => "1 factor".to_owned(),
        n => format!("{n} factors"),
    };
    let sampled = |name: &str, seed: u64| format!("{factors}, {name}, seed {seed}");
    match outline.plan.design {
        Design::Grid => format!("{factors}, full grid"),
        Design::OneAtATime { .. } => format!("{factors}, one at a time"),
        Design::LatinHypercube { seed, .. } => sampled("Latin hypercube", seed),
        Design::Sobol { seed, .. } => sampled("Sobol sequence", seed),
        Design::MonteCarlo { seed, .. } => sampled("Monte Carlo", seed),
        Design::Saltelli { samples, seed } => {
            sampled(&format!("Saltelli's blocks of {samples} samples"), seed)
        }
    }
}

/// In how many pairs the subject uses more, and how much more.
///
/// Points that nobody has drawn are no sample: of a grid the share says nothing beyond its own points.
fn compared(of: &Comparison, answer: &Answer, drawn: bool) -> String {
    let subject = answer.cars.first().map_or("the subject", String::as_str);
    let (s, worse) = (&of.excess_percent, &of.worse);
    if worse.n == 0 {
        return format!("{subject} against {}: no pair of good runs\n", of.baseline);
    }
    let spread = [0.05, 0.95, 0.5].map(|p| signed(Some(s.quantile(p)), 1));
    let mean = signed(Some(s.mean), 2);
    if !drawn {
        let ends = [s.min, s.max].map(|x| signed(Some(x), 1));
        return format!(
            "{subject} uses more fuel than {} at {} of {} points; the excess is {} to {} %, {mean} % on average.\n",
            of.baseline, worse.k, worse.n, ends[0], ends[1]
        );
    }
    let percent = |x: f64| fixed(Some(100.0 * x), if worse.n >= 1000 { 1 } else { 0 });
    let [low, high] = worse.interval95;
    format!(
        "{subject} uses more fuel than {} in {} of {} pairs: {} % (95 % interval {} to {} %).\n\
         The excess is {mean} % on average, sd {}; 90 % of the pairs lie between {} and {} %, the median is {} %.\n",
        of.baseline,
        worse.k,
        worse.n,
        percent(worse.share),
        percent(low),
        percent(high),
        fixed(Some(s.sd), 2),
        spread[0],
        spread[1],
        spread[2],
    )
}

/// Which factors decide the excess over a baseline.
fn decided(of: &Comparison, answer: &Answer, outline: &StudyManifest) -> Option<String> {
    let output = answer
        .outputs
        .iter()
        .find(|o| o.output == cvtcycle::study::outputs::EXCESS && o.car == of.baseline)?;
    let ranked = ranked(output, outline)?;
    let first: Vec<String> = ranked
        .iter()
        .take(3)
        .map(|(name, share)| format!("{name} ({})", fixed(Some(*share), 2)))
        .collect();
    let measure = match (&output.tornado, output.sobol.is_empty()) {
        (Some(_), _) => "swing, points",
        (None, false) => "share of the variance, with interactions",
        _ => "rank correlation",
    };
    Some(format!(
        "Over {} most is decided by {} [{measure}].\n",
        of.baseline,
        first.join(", ")
    ))
}

/// Factors with the measure of the design, the strongest first.
fn ranked(output: &OutputAnswer, outline: &StudyManifest) -> Option<Vec<(String, f64)>> {
    let mut list: Vec<(String, f64)> = if let Some(indices) = output.sobol.last() {
        outline
            .plan
            .factors
            .iter()
            .zip(&indices.factors)
            .map(|(factor, i)| (factor.name.clone(), i.total.value))
            .collect()
    } else if let Some(tornado) = &output.tornado {
        tornado
            .bars
            .iter()
            .map(|bar| (bar.name.clone(), bar.swing))
            .collect()
    } else if let Some(rank) = &output.rank {
        rank.factors
            .iter()
            .zip(&rank.of.factors)
            .map(|(name, f)| (name.clone(), f.spearman.value))
            .collect()
    } else {
        return None;
    };
    list.retain(|(_, x)| x.is_finite());
    list.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    (!list.is_empty()).then_some(list)
}

fn outputs(answer: &Answer) -> String {
    let mut grid = Grid::new("lllrrrrr").indented();
    grid.row(["output", "unit", "car", "n", "mean", "sd", "5 %", "95 %"]);
    let mut last = "";
    for output in &answer.outputs {
        let s = &output.summary;
        let figures = |x: f64| fixed(Some(x), 3);
        let name = if output.output == last {
            ""
        } else {
            &output.output
        };
        let unit = if name.is_empty() { "" } else { &output.unit };
        let cells = [
            figures(s.mean),
            figures(s.sd),
            figures(s.quantile(0.05)),
            figures(s.quantile(0.95)),
        ];
        grid.row(
            [
                name.to_owned(),
                unit.to_owned(),
                output.car.clone(),
                s.n.to_string(),
            ]
            .into_iter()
            .chain(cells),
        );
        last = &output.output;
    }
    grid.text()
}

/// The factors behind the analysed outputs: of the first output of the subject, and of the excess.
fn factors(answer: &Answer, outline: &StudyManifest, paint: Paint) -> String {
    let mut text = String::new();
    let shown = |o: &&OutputAnswer| {
        o.output == cvtcycle::study::outputs::EXCESS
            || answer
                .outputs
                .first()
                .is_some_and(|first| first.output == o.output && first.car == o.car)
    };
    for output in answer.outputs.iter().filter(shown) {
        let table = table(output, outline);
        if !table.is_empty() {
            text += &format!(
                "\n{}\n{table}",
                paint.heading(&format!(
                    "What moves {} ({}), {}",
                    output.output, output.unit, output.car
                ))
            );
        }
    }
    text
}

fn table(output: &OutputAnswer, outline: &StudyManifest) -> String {
    if let Some(indices) = output.sobol.last() {
        return sobol(output, outline, indices);
    }
    if let Some(tornado) = &output.tornado {
        let mut grid = Grid::new("lrrrrr").indented();
        grid.row(["factor", "low", "effect", "high", "effect", "swing"]);
        for bar in &tornado.bars {
            let end = |end: &Option<cvtcycle::study::statistics::TornadoEnd>| {
                end.as_ref()
                    .map_or(["-".to_owned(), "-".to_owned()], |end| {
                        [end.label.clone(), signed(Some(end.effect), 3)]
                    })
            };
            let cells = [
                vec![bar.name.clone()],
                end(&bar.low).to_vec(),
                end(&bar.high).to_vec(),
                vec![fixed(Some(bar.swing), 3)],
            ];
            grid.row(cells.concat());
        }
        return format!("  base {}\n{}", fixed(Some(tornado.base), 3), grid.text());
    }
    let mut text = String::new();
    if let Some(rank) = &output.rank {
        let mut list: Vec<_> = rank.factors.iter().zip(&rank.of.factors).collect();
        list.sort_by(|a, b| {
            b.1.spearman
                .value
                .abs()
                .total_cmp(&a.1.spearman.value.abs())
        });
        let mut grid = Grid::new("lrrr").indented();
        grid.row(["factor", "rank correlation", "from", "to"]);
        for (name, factor) in list.into_iter().take(TOLD) {
            let [low, high] = factor.spearman.interval95.unwrap_or([f64::NAN; 2]);
            grid.row([
                name.clone(),
                signed(Some(factor.spearman.value), 2),
                signed(Some(low), 2),
                signed(Some(high), 2),
            ]);
        }
        text += &grid.text();
    }
    for (name, groups) in &output.levels {
        let mut grid = Grid::new("lrrrr").indented();
        grid.row([name.as_str(), "n", "mean", "least", "most"]);
        for group in &groups.groups {
            grid.row([
                group.label.clone(),
                group.n.to_string(),
                fixed(Some(group.mean), 3),
                fixed(Some(group.min), 3),
                fixed(Some(group.max), 3),
            ]);
        }
        text += &grid.text();
    }
    text
}

fn sobol(
    output: &OutputAnswer,
    outline: &StudyManifest,
    indices: &cvtcycle::study::statistics::SobolIndices,
) -> String {
    let Some(ranked) = ranked(output, outline) else {
        return "  the output does not vary\n".to_owned();
    };
    let mut grid = Grid::new("lrrrr").indented();
    grid.row([
        "factor",
        "first order",
        "95 % interval",
        "total",
        "95 % interval",
    ]);
    let span = |e: Option<[f64; 2]>| {
        e.map_or("-".to_owned(), |[a, b]| {
            format!("{} .. {}", fixed(Some(a), 3), fixed(Some(b), 3))
        })
    };
    for (name, _) in ranked.iter().take(TOLD) {
        let Some(k) = outline
            .plan
            .factors
            .iter()
            .position(|factor| factor.name == *name)
        else {
            continue;
        };
        let f = &indices.factors[k];
        grid.row([
            name.clone(),
            fixed(Some(f.first.value), 3),
            span(f.first.interval95),
            fixed(Some(f.total.value), 3),
            span(f.total.interval95),
        ]);
    }
    let rest = ranked.len().saturating_sub(TOLD);
    let more = if rest > 0 {
        format!("  {rest} more factors have a smaller total index\n")
    } else {
        String::new()
    };
    format!(
        "{}{more}  sum of first-order indices {}\n",
        grid.text(),
        fixed(Some(indices.sum_first.value), 3)
    )
}

/// A word on standard error about runs that failed.
pub fn failures(answer: &Answer) -> String {
    let runs = &answer.runs;
    let told: Vec<String> = runs
        .reasons
        .iter()
        .take(5)
        .map(|(reason, count)| format!("  {count} x {reason}\n"))
        .collect();
    let more = runs.reasons.len().saturating_sub(5);
    let more = if more > 0 {
        format!("  and {more} other reasons\n")
    } else {
        String::new()
    };
    format!(
        "cvtcycle: {} of {} runs failed; each stands in the table with its reason\n{}{more}",
        runs.failed + runs.not_run,
        runs.ok + runs.failed + runs.not_run,
        told.concat()
    )
}

/// Where the files are.
pub fn written(dir: &Path, files: &[PathBuf]) -> String {
    let names: Vec<String> = files
        .iter()
        .filter_map(|file| file.file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    format!(
        "\nFiles written in {}\n  parts/  {}\n",
        dir.display(),
        names.join("  ")
    )
}
