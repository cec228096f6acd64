//! The answer of a study as pictures.

use crate::charts::Picture;
use crate::charts::ambient::{ambient_fuel, ambient_penalty, warm_up};
use crate::charts::study::{
    ConvergencePlot, DistributionPlot, DistributionSeries, EffectFactor, EffectsPlot, RankPlot,
    Shown, SobolPlot, TornadoPlot, convergence_plot, distribution_plot, effects_plot, rank_plot,
    sobol_plot, tornado_plot,
};
use cvtcycle_config::Problem;
use cvtcycle_study::ambient::{Matrix, WarmUp};
use cvtcycle_study::answer::{OutputAnswer, described_numbers};
use cvtcycle_study::outputs::{EXCESS, FUEL};
use cvtcycle_study::statistics::Groups;
use cvtcycle_study::{Answer, StudyManifest, StudyTable};

/// Every picture that the answer has something for, each under a name that can be a file's: of a matrix of ambient temperatures fuel,
/// excess and, where traces were kept, warm-up; else of the outputs that the plan names, or of fuel and excess.
///
/// # Errors
/// A part of the study that cannot be read.
pub fn study_pictures(
    answer: &Answer,
    frame: &StudyTable,
    warm_ups: &[WarmUp],
) -> Result<Vec<(String, Picture)>, Problem> {
    match &answer.matrix {
        Some(matrix) => Ok(of_matrix(matrix, warm_ups, &frame.outline.title)),
        None => of_outputs(answer, frame),
    }
}

fn of_matrix(matrix: &Matrix, warm_ups: &[WarmUp], title: &str) -> Vec<(String, Picture)> {
    let mut list = vec![("ambient_fuel".to_owned(), ambient_fuel(matrix, title))];
    list.extend(
        ambient_penalty(matrix, title).map(|picture| ("ambient_penalty".to_owned(), picture)),
    );
    for (k, start) in matrix
        .starts
        .iter()
        .enumerate()
        .filter(|_| !warm_ups.is_empty())
    {
        let word: String = start
            .chars()
            .map(|c| {
                if c.is_alphanumeric() || c == '-' {
                    c
                } else {
                    '_'
                }
            })
            .collect();
        list.push((
            format!("warm_up_{word}"),
            warm_up(matrix, warm_ups, k, title),
        ));
    }
    list
}

fn of_outputs(answer: &Answer, frame: &StudyTable) -> Result<Vec<(String, Picture)>, Problem> {
    let outline = frame.outline;
    let mut list = Vec::new();
    let pictured: Vec<&OutputAnswer> = answer
        .outputs
        .iter()
        .filter(|output| is_pictured(&output.output, outline))
        .collect();
    for (k, output) in pictured.iter().enumerate() {
        let same: Vec<&&OutputAnswer> = pictured
            .iter()
            .filter(|other| other.output == output.output)
            .collect();
        let first = pictured[..k]
            .iter()
            .all(|before| before.output != output.output);
        if first && outline.plan.design.is_sampled() {
            list.push((
                format!("distribution_{}", output.output),
                distribution(frame, &same)?,
            ));
        }
        list.extend(
            of_output(output, outline)
                .into_iter()
                .map(|(kind, picture)| {
                    (format!("{kind}_{}_{}", output.output, output.car), picture)
                }),
        );
    }
    Ok(list)
}

fn is_pictured(output: &str, outline: &StudyManifest) -> bool {
    !outline.plan.analyse.is_empty() || [FUEL, EXCESS].contains(&output)
}

/// Name of an output as people say it.
fn named(output: &OutputAnswer, outline: &StudyManifest) -> String {
    let subject = outline.cars.first().map_or("", String::as_str);
    let words = output
        .output
        .trim_end_matches("_percent")
        .trim_end_matches("_l_per_100km")
        .replace('_', " ");
    match output.output.as_str() {
        FUEL => format!("fuel of {}", output.car),
        EXCESS => format!("excess fuel of {subject} over {}", output.car),
        _ => format!("{words}, {}", output.car),
    }
}

fn distribution(frame: &StudyTable, outputs: &[&&OutputAnswer]) -> Result<Picture, Problem> {
    let outline = frame.outline;
    let mut values = Vec::new();
    for output in outputs {
        let car = outline
            .cars
            .iter()
            .position(|car| *car == output.car)
            .unwrap_or(0);
        values.push(described_numbers(frame, &output.output, car)?);
    }
    let excess = outputs
        .first()
        .is_some_and(|output| output.output.starts_with("subject_excess_"));
    let names: Vec<String> = outputs
        .iter()
        .map(|output| {
            if excess {
                format!("over {}", output.car)
            } else {
                output.car.clone()
            }
        })
        .collect();
    let series: Vec<DistributionSeries> = names
        .iter()
        .zip(&values)
        .map(|(name, values)| DistributionSeries { name, values })
        .collect();
    let title = match outputs.first() {
        Some(output) if output.output == FUEL => "fuel".to_owned(),
        Some(output) if excess => {
            format!(
                "excess fuel of {}",
                outline.cars.first().map_or("", String::as_str)
            ) + &tail(&output.output)
        }
        Some(output) => output.output.replace('_', " "),
        None => String::new(),
    };
    let unit = outputs.first().map_or("", |output| output.unit.as_str());
    let shown = Shown {
        output: &title,
        unit,
        subject: &outline.title,
    };
    Ok(distribution_plot(&DistributionPlot {
        shown,
        series: &series,
        differences: excess,
    }))
}

/// The phase of an excess, if it is of one.
fn tail(output: &str) -> String {
    let phase = output
        .strip_prefix("subject_excess_")
        .and_then(|rest| rest.strip_suffix("_percent"));
    phase.map_or_else(String::new, |phase| {
        format!(" in {}", phase.replace('_', " "))
    })
}

fn of_output(output: &OutputAnswer, outline: &StudyManifest) -> Vec<(&'static str, Picture)> {
    let name = named(output, outline);
    let shown = Shown {
        output: &name,
        unit: &output.unit,
        subject: &outline.title,
    };
    let factors = &outline.plan.factors;
    let names: &[String] = &factors
        .iter()
        .map(|factor| factor.name.clone())
        .collect::<Vec<_>>();
    let mut list = Vec::new();
    if let Some(indices) = output.sobol.last() {
        let steps = &output.sobol;
        list.push((
            "sobol",
            sobol_plot(&SobolPlot {
                shown,
                names,
                indices,
            }),
        ));
        let plot = ConvergencePlot {
            shown,
            names,
            steps,
        };
        list.push(("convergence", convergence_plot(&plot)));
    }
    if let Some(tornado) = &output.tornado {
        list.push(("tornado", tornado_plot(&TornadoPlot { shown, tornado })));
    }
    if let Some(rank) = &output.rank {
        let (names, ranks) = (&rank.factors, &rank.of);
        list.push((
            "ranks",
            rank_plot(&RankPlot {
                shown,
                names,
                ranks,
            }),
        ));
    }
    if !output.levels.is_empty() {
        let levels = output.levels.iter();
        let factors = levels.map(|(name, groups)| effect(name, groups, outline));
        let factors: &[EffectFactor] = &factors.collect::<Vec<_>>();
        list.push(("effects", effects_plot(&EffectsPlot { shown, factors })));
    }
    list
}

/// A factor's levels: at their numbers, or side by side where they are words.
fn effect<'a>(name: &'a str, groups: &'a Groups, outline: &'a StudyManifest) -> EffectFactor<'a> {
    let unit = outline
        .plan
        .factors
        .iter()
        .find(|factor| factor.name == name)
        .map_or("", |factor| factor.unit.as_str());
    let at: Option<Vec<f64>> = groups
        .groups
        .iter()
        .map(|group| group.label.parse().ok())
        .collect();
    EffectFactor {
        name,
        unit,
        at: at.unwrap_or_default(),
        groups,
    }
}
