//! Parts of a sum stacked over one axis, one panel or several.
use super::axis::{Axis, number, range};
use super::figure::{Anchor, Figure, INK, Path, Rect};
use super::legend::{Mark, legend};
use super::panel::{BELOW, LEFT, Panel};
use super::style::fill;

/// A picture of stacked parts.
#[derive(Clone, Debug)]
pub struct StackFigure<'a> {
    /// What it shows.
    pub title: &'a str,
    /// Of what.
    pub subject: &'a str,
    /// Title of the vertical axis, with the unit.
    pub value: &'a str,
    /// Title and values of the horizontal axis, ascending.
    pub x: (&'a str, &'a [f64]),
    /// Names of the parts, from the bottom of the stack.
    pub parts: Vec<String>,
    /// Panels: what is held in each, and the values by part, then by x. None is negative.
    pub panels: Vec<(String, Vec<Vec<f64>>)>,
}

const ALONE: (f64, f64) = (600.0, 400.0);
const ONE_OF_MANY: (f64, f64) = (290.0, 220.0);
const TOP: f64 = 58.0;
const ABOVE: f64 = 24.0;
const STRIP: f64 = 190.0;

/// Draws the picture.
#[must_use]
pub fn stack_figure(of: &StackFigure) -> String {
    let several = of.panels.len() > 1;
    let (wide, tall) = if several { ONE_OF_MANY } else { ALONE };
    let columns = if of.panels.len() > 4 {
        3
    } else {
        of.panels.len().clamp(1, 2)
    };
    let rows = of.panels.len().div_ceil(columns).max(1);
    let above = if of.panels.iter().any(|(title, _)| !title.is_empty()) {
        ABOVE
    } else {
        0.0
    };
    let place = |k: usize| {
        let left = LEFT + 8.0 + (k % columns) as f64 * (wide + LEFT + 20.0);
        let top = TOP + above + (k / columns) as f64 * (tall + ABOVE + BELOW + 8.0);
        Rect {
            left,
            top,
            right: left + wide,
            bottom: top + tall,
        }
    };
    let sum = |parts: &[Vec<f64>], i: usize| {
        parts
            .iter()
            .map(|values| values[i])
            .filter(|x| x.is_finite())
            .sum::<f64>()
    };
    let sums: Vec<f64> = of
        .panels
        .iter()
        .flat_map(|(_, parts)| (0..of.x.1.len()).map(move |i| sum(parts, i)))
        .collect();
    let edge = place(columns - 1).right;
    let bottom = place((rows - 1) * columns).bottom;
    let names = of.parts.join(", ");
    let desc = match range(sums.iter().copied()) {
        Some((low, high)) => format!(
            "{} over {}, stacked from the bottom: {names}. Sum from {} to {}.",
            of.value,
            of.x.0,
            number(low, 0.01),
            number(high, 0.01)
        ),
        None => format!("{} over {}, without data.", of.value, of.x.0),
    };
    let mut figure = Figure::new(
        (edge + STRIP + 16.0, bottom + BELOW + 6.0),
        LEFT + 8.0,
        of.title,
        of.subject,
        &desc,
    );
    let x = Axis::exact(
        of.x.0,
        of.x.1[0],
        of.x.1[of.x.1.len() - 1],
        if several { 4 } else { 8 },
    );
    let y = Axis::round(
        of.value,
        sums.into_iter().chain([0.0]),
        if several { 5 } else { 8 },
    );
    let count = of.parts.len();
    let paints: Vec<String> = (0..count)
        .map(|i| fill(&mut figure, "stack", i, count))
        .collect();
    for (k, (title, parts)) in of.panels.iter().enumerate() {
        let rect = place(k);
        let panel = Panel::draw(&mut figure, rect, x.clone(), y.clone(), true);
        figure.text(
            (rect.left, rect.top - 7.0),
            12.0,
            Anchor::Start,
            "",
            INK,
            title,
        );
        let mut base = vec![0.0; of.x.1.len()];
        for (values, paint) in parts.iter().zip(&paints) {
            layer(&mut figure, &panel, of.x.1, values, &mut base, paint);
        }
        panel.outline(&mut figure);
    }
    // Listed from the top, as they lie in the stack.
    let entries: Vec<_> = paints
        .into_iter()
        .map(Mark::Fill)
        .zip(of.parts.iter().cloned())
        .rev()
        .collect();
    legend(
        &mut figure,
        (edge + 16.0, TOP + above),
        STRIP - 8.0,
        "",
        &entries,
    );
    figure.finish()
}

/// Draws one part on top of `base`, and raises that.
fn layer(
    figure: &mut Figure,
    panel: &Panel,
    x: &[f64],
    values: &[f64],
    base: &mut [f64],
    paint: &str,
) {
    let top: Vec<f64> = base
        .iter()
        .zip(values)
        .map(|(low, v)| low + if v.is_finite() { *v } else { 0.0 })
        .collect();
    if top.iter().zip(base.iter()).any(|(high, low)| high > low) {
        let mut path = Path::default();
        for (i, (x, high)) in x.iter().zip(&top).enumerate() {
            if i == 0 {
                path.move_to(panel.px(*x), panel.py(*high));
            } else {
                path.line_to(panel.px(*x), panel.py(*high));
            }
        }
        for (x, low) in x.iter().zip(base.iter()).rev() {
            path.line_to(panel.px(*x), panel.py(*low));
        }
        path.close();
        let data = path.finish();
        figure.raw(&format!(
            "<path class=\"layer\" d=\"{data}\" fill=\"{paint}\" stroke=\"{INK}\" stroke-width=\"2\" stroke-linejoin=\"round\"/>"
        ));
    }
    base.copy_from_slice(&top);
}
