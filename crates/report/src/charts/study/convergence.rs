//! Sobol indices against the number of samples: whether they have settled.

use super::super::axis::Axis;
use super::super::figure::{Anchor, Figure, INK, Path, QUIET, Rect, UNITS, units};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::style::{STROKES, Stroke};
use super::text::{foot, foot_height, value};
use super::{RIGHT, Shown, WIDTH, interval_cells};
use cvtcycle_study::statistics::{Estimate, SobolIndices};

/// Indices at growing numbers of samples.
#[derive(Clone, Copy, Debug)]
pub struct ConvergencePlot<'a> {
    /// Output and study.
    pub shown: Shown<'a>,
    /// Names of the factors, in the order of the indices.
    pub names: &'a [String],
    /// Indices, the fewest samples first.
    pub steps: &'a [SobolIndices],
}

const TOP: f64 = 58.0;
const TALL: f64 = 230.0;
const GAP: f64 = 20.0;
/// Bands of at least the last number of samples over 2 to this power lie in the plot in full.
const SEEN: f64 = 2.5;
const ZERO: Stroke = Stroke {
    colour: "#000000",
    width: 0.8,
    dash: &[],
};

type Pick = fn(&SobolIndices, usize) -> Option<Estimate>;

/// Draws first-order indices over total ones against the number of samples, with their intervals as bands. Of more than seven factors
/// those with the seven largest total indices.
#[must_use]
pub fn convergence_plot(plot: &ConvergencePlot) -> Picture {
    let chosen = chosen(plot);
    let mut told = vec![
        "Bands: intervals of 95 %. Those of few samples may leave the plot; the table has them."
            .to_owned(),
    ];
    if chosen.len() < plot.names.len() {
        told.push(format!(
            "{} of {} factors, those with the largest total indices.",
            chosen.len(),
            plot.names.len()
        ));
    }
    let left = LEFT + 8.0;
    let place = |k: f64| Rect {
        left,
        right: RIGHT,
        top: TOP + k * (TALL + GAP),
        bottom: TOP + k * (TALL + GAP) + TALL,
    };
    let (upper, lower) = (place(0.0), place(1.0));
    let below = (left, lower.bottom + BELOW + 8.0);
    let tall = below.1
        + foot_height(
            chosen.iter().map(|&i| plot.names[i].as_str()),
            RIGHT - left,
            &told,
        );
    let title = format!("Convergence of Sobol indices: {}", plot.shown.output);
    let mut figure = Figure::new(
        (WIDTH, tall),
        left,
        &title,
        plot.shown.subject,
        &describe(plot, &chosen),
    );
    draw(
        &mut figure,
        plot,
        &chosen,
        upper,
        ("First-order index [-]", |s, i| {
            s.factors.get(i).map(|f| f.first)
        }),
    );
    let panel = draw(
        &mut figure,
        plot,
        &chosen,
        lower,
        ("Total index [-]", |s, i| s.factors.get(i).map(|f| f.total)),
    );
    for step in plot.steps {
        let at = (panel.px(place_of(step)), lower.bottom + 17.0);
        figure.text(at, 11.0, Anchor::Middle, "", INK, &step.samples.to_string());
    }
    let under = (0.5 * (lower.left + lower.right), lower.bottom + 36.0);
    figure.text(under, 12.0, Anchor::Middle, "", INK, "Samples [-]");
    let lines = chosen
        .iter()
        .enumerate()
        .map(|(k, &i)| (Mark::Line(STROKES[k]), plot.names[i].as_str()))
        .collect();
    foot(&mut figure, below, RIGHT - left, lines, &told);
    Picture {
        svg: figure.finish(),
        table: table(plot),
    }
}

/// A row for each number of samples and factor, in this order.
fn table(plot: &ConvergencePlot) -> PictureTable {
    let names = [
        "Samples",
        "Factor",
        "First order",
        "First order: 95 % from",
        "First order: to",
        "Total",
        "Total: 95 % from",
        "Total: to",
    ];
    let mut table = PictureTable::new(&names.map(|name| (name, "")));
    for step in plot.steps {
        for (i, name) in plot.names.iter().enumerate() {
            let mut cells = vec![step.samples.to_string(), name.clone()];
            for estimate in step
                .factors
                .get(i)
                .map(|f| [f.first, f.total])
                .into_iter()
                .flatten()
            {
                cells.push(cell(estimate.value, 1e-3));
                cells.extend(interval_cells(estimate.interval95, 1e-3));
            }
            cells.resize(names.len(), String::new());
            table.push(cells);
        }
    }
    table
}

/// Where a step stands: doublings are equally far apart.
fn place_of(step: &SobolIndices) -> f64 {
    (step.samples.max(1) as f64).log2()
}

/// The factors that are drawn, the largest total index of the last step first.
fn chosen(plot: &ConvergencePlot) -> Vec<usize> {
    let total = |i: usize| {
        plot.steps
            .last()
            .and_then(|s| s.factors.get(i))
            .map_or(f64::NAN, |f| f.total.value)
    };
    let mut order: Vec<usize> = (0..plot.names.len()).collect();
    order.sort_by(|&i, &j| {
        total(i)
            .is_nan()
            .cmp(&total(j).is_nan())
            .then(total(j).total_cmp(&total(i)))
    });
    order.truncate(STROKES.len());
    order
}

fn draw(
    figure: &mut Figure,
    plot: &ConvergencePlot,
    chosen: &[usize],
    rect: Rect,
    (title, pick): (&str, Pick),
) -> Panel {
    let estimates = |i: usize| {
        plot.steps
            .iter()
            .filter_map(move |s| pick(s, i).map(|e| (place_of(s), e)))
    };
    let places: Vec<f64> = plot.steps.iter().map(place_of).collect();
    let (first, last) = (
        places.first().copied().unwrap_or(0.0),
        places.last().copied().unwrap_or(1.0),
    );
    // The bands of few samples are so wide that nothing else would be seen: they may leave the plot.
    let seen = |x: f64, e: Estimate| {
        e.interval95
            .filter(|_| x > last - SEEN)
            .into_iter()
            .flatten()
            .chain([e.value, 0.0])
    };
    let y = Axis::round(
        title,
        chosen
            .iter()
            .flat_map(|&i| estimates(i))
            .flat_map(|(x, e)| seen(x, e)),
        6,
    );
    let mut x = Axis::exact("", first - 0.25, last + 0.25, 6);
    x.ticks = places;
    let panel = Panel::draw(figure, rect, x, y, false);
    let (left, top) = (units(rect.left), units(rect.top));
    let (wide, tall) = (units(rect.right) - left, units(rect.bottom) - top);
    figure
        .define(&format!("<clipPath id=\"within-{top}\"><rect x=\"{left}\" y=\"{top}\" width=\"{wide}\" height=\"{tall}\"/></clipPath>\n"));
    figure.raw(&format!("<g clip-path=\"url(#within-{top})\">"));
    for (k, &i) in chosen.iter().enumerate().rev() {
        let bounds: Vec<(f64, [f64; 2])> = estimates(i)
            .filter_map(|(x, e)| e.interval95.map(|ends| (x, ends)))
            .collect();
        band(figure, &panel, &bounds, STROKES[k].colour);
    }
    figure.close();
    panel.line(figure, &[(panel.x.low, 0.0), (panel.x.high, 0.0)], ZERO);
    for (k, &i) in chosen.iter().enumerate().rev() {
        panel.line(
            figure,
            &estimates(i).map(|(x, e)| (x, e.value)).collect::<Vec<_>>(),
            STROKES[k],
        );
        for (at, step) in plot.steps.iter().enumerate() {
            let Some(estimate) = pick(step, i).filter(|e| e.value.is_finite()) else {
                continue;
            };
            let (cx, cy, r) = (
                units(panel.px(place_of(step))),
                units(panel.py(estimate.value)),
                2.8 * UNITS,
            );
            let (row, colour) = (at * plot.names.len() + i, STROKES[k].colour);
            figure.raw(&format!("<circle class=\"mark\" data-row=\"{row}\" cx=\"{cx}\" cy=\"{cy}\" r=\"{r:.1}\" fill=\"{colour}\"/>"));
        }
    }
    if plot.steps.is_empty() || chosen.is_empty() {
        let at = (
            0.5 * (rect.left + rect.right),
            0.5 * (rect.top + rect.bottom),
        );
        figure.text(at, 12.0, Anchor::Middle, "", QUIET, "no data");
    }
    panel.outline(figure);
    panel
}

/// The area between lower and upper bounds.
fn band(figure: &mut Figure, panel: &Panel, bounds: &[(f64, [f64; 2])], colour: &str) {
    let mut path = Path::default();
    for (x, [_, high]) in bounds {
        path.line_to(panel.px(*x), panel.py(*high));
    }
    for (x, [low, _]) in bounds.iter().rev() {
        path.line_to(panel.px(*x), panel.py(*low));
    }
    path.close();
    let data = path.finish();
    if bounds.len() > 1 {
        figure.raw(&format!("<path class=\"band\" d=\"{data}\" fill=\"{colour}\" fill-opacity=\"0.14\" stroke=\"none\"/>"));
    }
}

fn describe(plot: &ConvergencePlot, chosen: &[usize]) -> String {
    let at = |step: &SobolIndices| {
        let total = |&i: &usize| {
            step.factors.get(i).map(|f| {
                format!(
                    "{} {} and {}",
                    plot.names[i],
                    value(f.first.value, 0.9),
                    value(f.total.value, 0.9)
                )
            })
        };
        format!(
            "{} samples: {}",
            step.samples,
            chosen
                .iter()
                .filter_map(total)
                .collect::<Vec<_>>()
                .join(", ")
        )
    };
    format!(
        "First-order and total indices of factors. {}.",
        plot.steps.iter().map(at).collect::<Vec<_>>().join("; ")
    )
}
