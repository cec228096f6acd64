//! The frame of a panel: grid, ticks with their labels, and titles of the axes.

use super::chart::LEFT;
use super::panel::{BELOW, Panel};
use super::style::INK;
use super::svg::{Svg, units};

/// Sizes of texts, canvas units.
const TICK_TEXT: f64 = 44.35;
const TITLE_TEXT: f64 = 48.39;
/// Length of a tick, canvas units.
const TICK: i64 = 16;
const GRID: &str = "#dedede";

/// A place in canvas units.
type Place = (i64, i64);

/// Draws grid, ticks and titles of a panel. The axes lie next to the outermost grid lines, which end one unit before the edge.
pub(super) fn frame(svg: &mut Svg, panel: &Panel) {
    let (rect, labelled) = (panel.rect, panel.x_labels);
    let (left, top) = (units(rect.left), units(rect.top));
    let (right, bottom) = (units(rect.right) - 1, units(rect.bottom) - 1);
    let (middle_x, middle_y) = ((right + 1 - left) / 2 + left, (bottom + 1 - top) / 2 + top);
    let down = |share: f64, size: f64| (share * size).round() as i64;
    let title = left - units(LEFT) + down(0.76, TITLE_TEXT);
    let turn = format!(" transform=\"rotate(-90 {title} {middle_y})\"");
    text(
        svg,
        (title, middle_y),
        ("middle", TITLE_TEXT),
        &turn,
        &panel.y.title,
    );
    if labelled {
        let y = bottom + 1 + units(BELOW) - down(0.27, TITLE_TEXT);
        text(
            svg,
            (middle_x, y),
            ("middle", TITLE_TEXT),
            "",
            &panel.x.title,
        );
    }
    let along = |share: f64, from: i64, to: i64| from + (share * (to - from) as f64).round() as i64;
    let xs = panel.x.ticks.iter();
    let xs: Vec<_> = xs
        .map(|(x, label)| (along(panel.x.share(*x), left, right), label))
        .collect();
    let ys = panel.y.ticks.iter();
    let ys: Vec<_> = ys
        .map(|(y, label)| (along(panel.y.share(*y), bottom, top), label))
        .collect();
    for (x, _) in &xs {
        line(svg, (*x, bottom), (*x, top), GRID);
    }
    for (y, _) in &ys {
        line(svg, (left, *y), (right, *y), GRID);
    }
    let (axis_x, axis_y) = (left - 1, bottom + 1);
    line(svg, (axis_x, top), (axis_x, bottom), INK);
    for (y, label) in ys {
        let place = (left - 2 * TICK, y + down(0.27, TICK_TEXT));
        text(svg, place, ("end", TICK_TEXT), "", label);
        line(svg, (axis_x - TICK, y), (axis_x, y), INK);
    }
    if !labelled {
        return;
    }
    line(svg, (left, axis_y), (right, axis_y), INK);
    for (x, label) in xs {
        let place = (x, axis_y + 2 * TICK + down(0.76, TICK_TEXT));
        text(svg, place, ("middle", TICK_TEXT), "", label);
        line(svg, (x, axis_y), (x, axis_y + TICK), INK);
    }
}

fn line(svg: &mut Svg, (x0, y0): Place, (x1, y1): Place, colour: &str) {
    let points = format!("{x0},{y0} {x1},{y1}");
    let paint = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"2\"");
    svg.element("polyline", &[("points", &points)], &paint);
}

fn text(svg: &mut Svg, (x, y): Place, (anchor, size): (&str, f64), turn: &str, text: &str) {
    let paint = format!(
        "text-anchor=\"{anchor}\" font-family=\"sans-serif\" font-size=\"{size:.0}\" fill=\"{INK}\"{turn}"
    );
    if !text.is_empty() {
        svg.text_element(&[("x", &x), ("y", &y)], &paint, text);
    }
}
