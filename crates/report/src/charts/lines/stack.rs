//! Parts of a sum stacked over one axis, one panel or several.

use crate::charts::engine::{Axis, BELOW, Chart, Entry, Fill, LEFT, PLOT_LEFT, Panel, Side, grid};
use crate::charts::picture::PictureTable;

use super::{Look, stack_layers};

/// A picture of stacked parts.
#[derive(Clone, Debug)]
pub(crate) struct StackFigure<'a> {
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
    /// Panels: what is held constant in each, and the values by part, then by x. None is negative.
    pub panels: Vec<(String, Vec<Vec<f64>>)>,
}

/// Sizes of a lone panel and of one of several, pixels.
const SIZES: [(f64, f64); 2] = [(600.0, 400.0), (290.0, 220.0)];
const TOP: f64 = 58.0;
const ABOVE: f64 = 24.0;
/// Width of the legend, pixels.
const STRIP: f64 = 190.0;

/// Draws the picture.
pub(crate) fn stack_figure(of: &StackFigure) -> String {
    let several = of.panels.len() > 1;
    let size = SIZES[usize::from(several)];
    let columns = if of.panels.len() > 4 {
        3
    } else {
        of.panels.len().clamp(1, 2)
    };
    let titled = of.panels.iter().any(|(title, _)| !title.is_empty());
    let top = TOP + if titled { ABOVE } else { 0.0 };
    let pitch = (size.0 + LEFT + 20.0, size.1 + ABOVE + BELOW + 8.0);
    let place = grid((PLOT_LEFT, top), size, pitch, columns);
    let sums = sums(of);
    let ticks = if several { (4, 5) } else { (8, 8) };
    let xs = of.x.1;
    let x = Axis::exact(of.x.0, xs[0], xs[xs.len() - 1], ticks.0);
    let y = Axis::round(of.value, sums.iter().copied().chain([0.0]), ticks.1);
    let count = of.parts.len();
    let panel = |(k, (title, parts)): (usize, &(String, Vec<Vec<f64>>))| {
        let mut panel = Panel::new(place(k), x.clone(), y.clone()).heading(title);
        let layer = |(k, values): (usize, &Vec<f64>)| {
            let points = xs.iter().copied().zip(values.iter().copied());
            (Look::solid(k), points.collect())
        };
        let series = parts.iter().enumerate().map(layer).collect();
        stack_layers(&mut panel, series, count);
        panel
    };
    // Listed from the top, as they lie in the stack.
    let entries = of.parts.iter().enumerate().rev();
    let entries = entries.map(|(k, name)| Entry::fill(Fill::nth(k, count), name));
    let edge = place(columns - 1).right;
    let side = Side {
        corner: (edge + 16.0, top),
        width: STRIP - 8.0,
        entries: entries.collect(),
        ..Side::default()
    };
    let parts = of.parts.join(", ");
    Chart::new(of.title, of.subject, PLOT_LEFT)
        .lead(format!("Stacked from the bottom: {parts}"))
        .width(edge + STRIP + 16.0)
        .panels(of.panels.iter().enumerate().map(panel))
        .side(side)
        .picture(PictureTable::default())
        .svg
}

/// Heights of the stacks of all panels.
fn sums(of: &StackFigure) -> Vec<f64> {
    let at = |parts: &[Vec<f64>], i: usize| {
        let values = parts.iter().map(|values| values[i]);
        values.filter(|x| x.is_finite()).sum::<f64>()
    };
    let panels = of.panels.iter();
    panels
        .flat_map(|(_, parts)| (0..of.x.1.len()).map(move |i| at(parts, i)))
        .collect()
}
