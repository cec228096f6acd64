//! A quantity over two axes: filled bands of equal value with labelled lines between them, one panel or several beside each other.
use super::axis::{Axis, number, range, round_step};
use super::contour::Grid;
use super::figure::{Anchor, Figure, INK, Path, Rect, text_width};
use super::panel::{BELOW, LEFT, Panel};
use super::style::{Stroke, ramp};

/// A picture of one quantity over two axes.
#[derive(Clone, Debug)]
pub struct MapFigure<'a> {
    /// What it shows.
    pub title: &'a str,
    /// Of what.
    pub subject: &'a str,
    /// Title of the colour bar, with the unit.
    pub value: &'a str,
    /// Title and values of the horizontal axis, ascending.
    pub x: (&'a str, &'a [f64]),
    /// Title and values of the vertical axis, ascending.
    pub y: (&'a str, &'a [f64]),
    /// Panels: what is held in each, and the values by x, then by y.
    pub panels: Vec<(String, Vec<Vec<f64>>)>,
}

/// Size of the only panel, and of one of several, pixels.
const ALONE: (f64, f64) = (600.0, 420.0);
const ONE_OF_MANY: (f64, f64) = (290.0, 220.0);
const TOP: f64 = 58.0;
/// Room above a panel for its title, pixels.
const ABOVE: f64 = 24.0;
/// Room right of the panels for the colour bar, pixels.
const STRIP: f64 = 110.0;
/// Height of the stripes that make up the filled bands, pixels.
const STRIPE: f64 = 1.5;
/// Places along a stripe at which the values are looked up, pixels.
const LOOK: f64 = 1.0;
/// Most bands of the colour bar.
const BANDS: f64 = 12.0;
const LINE: Stroke = Stroke {
    colour: "#000000",
    width: 0.8,
    dash: &[],
};

/// The bands in common to all panels.
struct Scale {
    step: f64,
    first: f64,
    count: usize,
}

impl Scale {
    fn new(low: f64, high: f64) -> Self {
        // A quantity that hardly changes gets few wide bands, not many that tell rounding apart.
        let step = round_step(((high - low) / BANDS).max(0.02 * high.abs()).max(1e-9));
        let first = (low / step + 1e-9).floor();
        let count = ((high / step - 1e-9).ceil() - first).max(1.0) as usize;
        Scale { step, first, count }
    }

    fn level(&self, k: usize) -> f64 {
        (self.first + k as f64) * self.step + 0.0
    }

    fn band(&self, value: f64) -> Option<usize> {
        value.is_finite().then(|| {
            ((value / self.step - self.first).floor().max(0.0) as usize).min(self.count - 1)
        })
    }

    fn colour(&self, band: usize) -> String {
        ramp((band as f64 + 0.5) / self.count as f64)
    }
}

/// Draws the picture. Where values are not finite the panel stays white.
#[must_use]
pub fn map_figure(of: &MapFigure) -> String {
    let several = of.panels.len() > 1;
    let (wide, tall) = if several { ONE_OF_MANY } else { ALONE };
    let columns = match of.panels.len() {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    let rows = of.panels.len().div_ceil(columns).max(1);
    let above = if several || of.panels.iter().any(|(title, _)| !title.is_empty()) {
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
    let all = of
        .panels
        .iter()
        .flat_map(|(_, values)| values.iter().flatten().copied());
    let found = range(all);
    let (low, high) = found.unwrap_or((0.0, 1.0));
    let scale = Scale::new(low, high);
    let edge = place(columns - 1).right;
    let bottom = place((rows - 1) * columns).bottom;
    let mut figure = Figure::new(
        (edge + STRIP, bottom + BELOW + 6.0),
        LEFT + 8.0,
        of.title,
        of.subject,
        &told(of, found),
    );
    let x = Axis::exact(
        of.x.0,
        of.x.1[0],
        of.x.1[of.x.1.len() - 1],
        if several { 4 } else { 8 },
    );
    let y = Axis::exact(
        of.y.0,
        of.y.1[0],
        of.y.1[of.y.1.len() - 1],
        if several { 5 } else { 8 },
    );
    for (k, (title, values)) in of.panels.iter().enumerate() {
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
        fill(&mut figure, &panel, of, values, &scale);
        lines(&mut figure, &panel, of, values, &scale);
        panel.outline(&mut figure);
        if found.is_none() {
            panel.empty(&mut figure);
        }
    }
    bar(
        &mut figure,
        &scale,
        of.value,
        Rect {
            left: edge + 20.0,
            right: edge + 40.0,
            top: TOP + above + 18.0,
            bottom: place(0).bottom,
        },
    );
    figure.finish()
}

fn told(of: &MapFigure, found: Option<(f64, f64)>) -> String {
    let Some((low, high)) = found else {
        return format!("{} over {} and {}, without data.", of.value, of.x.0, of.y.0);
    };
    let step = (high - low) / 100.0;
    let names: Vec<&str> = of
        .panels
        .iter()
        .map(|(title, _)| title.as_str())
        .filter(|title| !title.is_empty())
        .collect();
    let panels = if names.is_empty() {
        String::new()
    } else {
        format!(" Panels: {}.", names.join("; "))
    };
    format!(
        "{} over {} and {}, from {} to {}.{panels}",
        of.value,
        of.x.0,
        of.y.0,
        number(low, step),
        number(high, step)
    )
}

/// Value between the grid's points, bilinear; NaN beside a point without value.
fn between(of: &MapFigure, values: &[Vec<f64>], x: f64, y: f64) -> f64 {
    let cell = |axis: &[f64], v: f64| {
        let i = axis.partition_point(|a| *a <= v).clamp(1, axis.len() - 1) - 1;
        (i, ((v - axis[i]) / (axis[i + 1] - axis[i])).clamp(0.0, 1.0))
    };
    let ((i, s), (j, t)) = (cell(of.x.1, x), cell(of.y.1, y));
    let side = |column: &[f64]| column[j] * (1.0 - t) + column[j + 1] * t;
    side(&values[i]) * (1.0 - s) + side(&values[i + 1]) * s
}

/// Fills the bands with stripes: each as long as its band goes on.
fn fill(figure: &mut Figure, panel: &Panel, of: &MapFigure, values: &[Vec<f64>], scale: &Scale) {
    let rect = panel.rect;
    let (across, up) = (
        (rect.right - rect.left) / LOOK,
        (rect.bottom - rect.top) / STRIPE,
    );
    let mut paths: Vec<Path> = (0..scale.count).map(|_| Path::default()).collect();
    for j in 0..up.ceil() as usize {
        let top = rect.top + j as f64 * STRIPE;
        let low = (top + STRIPE).min(rect.bottom);
        let share = (rect.bottom - 0.5 * (top + low)) / (rect.bottom - rect.top);
        let y = panel.y.low + share * (panel.y.high - panel.y.low);
        let band_at = |i: usize| {
            let x = panel.x.low + ((i as f64 + 0.5) / across) * (panel.x.high - panel.x.low);
            scale.band(between(of, values, x, y))
        };
        let count = across.round() as usize;
        let mut from = 0;
        while from < count {
            let band = band_at(from);
            let to = (from + 1..count)
                .find(|i| band_at(*i) != band)
                .unwrap_or(count);
            if let Some(band) = band {
                let (x0, x1) = (rect.left + from as f64 * LOOK, rect.left + to as f64 * LOOK);
                let path = &mut paths[band];
                path.move_to(x0, top);
                path.line_to(x1, top);
                path.line_to(x1, low);
                path.line_to(x0, low);
                path.close();
            }
            from = to;
        }
    }
    for (band, path) in paths.into_iter().enumerate() {
        let data = path.finish();
        if !data.is_empty() {
            // The renderer must not blend the edges of neighbouring stripes with the ground.
            figure.raw(&format!(
                "<path class=\"band\" d=\"{data}\" fill=\"{}\" shape-rendering=\"crispEdges\"/>",
                scale.colour(band)
            ));
        }
    }
}

/// Lines between the bands; in a panel whose values span few bands, finer ones. Labels stand apart from each other.
fn lines(figure: &mut Figure, panel: &Panel, of: &MapFigure, values: &[Vec<f64>], scale: &Scale) {
    let Some((low, high)) = range(values.iter().flatten().copied()) else {
        return;
    };
    let own = round_step(((high - low) / 6.0).max(0.02 * high.abs()).max(1e-9));
    let step = if own < scale.step { own } else { scale.step };
    let grid = Grid {
        x: of.x.1,
        y: of.y.1,
        values,
    };
    let mut labels: Vec<(f64, f64, String)> = Vec::new();
    let first = (low / step).ceil() as i64;
    for k in first..=(high / step).floor() as i64 {
        let level = k as f64 * step;
        let mut longest: Vec<(f64, f64)> = Vec::new();
        for line in grid.lines(level) {
            panel.line_any(figure, &line, LINE);
            let pixels: Vec<(f64, f64)> = dense(
                &line
                    .iter()
                    .map(|p| (panel.px(p.0), panel.py(p.1)))
                    .collect::<Vec<_>>(),
            );
            if pixels.len() > longest.len() {
                longest = pixels;
            }
        }
        let text = number(level, step);
        let place = label_place(panel, &longest, &labels, &text);
        labels.extend(place.map(|(x, y)| (x, y, text)));
    }
    for (x, y, text) in labels {
        let half = 0.5 * text_width(&text, 10.0) + 1.0;
        let rect = Rect {
            left: x - half,
            right: x + half,
            top: y - 6.0,
            bottom: y + 6.0,
        };
        figure.rect(rect, "fill=\"#ffffff\" fill-opacity=\"0.8\"");
        figure.text(
            (x, y + 3.6),
            10.0,
            Anchor::Middle,
            "class=\"iso\"",
            INK,
            &text,
        );
    }
}

/// A line with a point every few pixels: one between grid points far apart has none where a label could stand.
fn dense(line: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out = Vec::new();
    for pair in line.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / 4.0).ceil().max(1.0);
        out.extend(
            (0..count as u32)
                .map(|i| f64::from(i) / count)
                .map(|t| (x0 + t * (x1 - x0), y0 + t * (y1 - y0))),
        );
    }
    out.extend(line.last());
    out
}

fn label_place(
    panel: &Panel,
    line: &[(f64, f64)],
    labels: &[(f64, f64, String)],
    text: &str,
) -> Option<(f64, f64)> {
    let r = panel.rect;
    let half = 0.5 * text_width(text, 10.0) + 3.0;
    let inside = |x: f64, y: f64| {
        x > r.left + half && x < r.right - half && y > r.top + 8.0 && y < r.bottom - 8.0
    };
    let apart = |x: f64, y: f64| {
        labels.iter().all(|(u, v, t)| {
            (x - u).abs() > half + 0.5 * text_width(t, 10.0) + 3.0 || (y - v).abs() > 14.0
        })
    };
    [50, 60, 40, 70, 30, 80, 20, 90, 10, 65, 35, 75, 25, 5, 95]
        .iter()
        .filter_map(|percent| line.get(percent * line.len() / 100).copied())
        .find(|&(x, y)| inside(x, y) && apart(x, y))
}

fn bar(figure: &mut Figure, scale: &Scale, title: &str, rect: Rect) {
    figure.open("legend");
    figure.text(
        (rect.left, rect.top - 10.0),
        11.0,
        Anchor::Start,
        "",
        INK,
        title,
    );
    let tall = (rect.bottom - rect.top) / scale.count as f64;
    for band in 0..scale.count {
        let bottom = rect.bottom - band as f64 * tall;
        let part = Rect {
            left: rect.left,
            right: rect.right,
            top: bottom - tall,
            bottom,
        };
        figure.rect(
            part,
            &format!(
                "fill=\"{}\" stroke=\"{INK}\" stroke-width=\"1\"",
                scale.colour(band)
            ),
        );
    }
    for k in 0..=scale.count {
        let y = rect.bottom - k as f64 * tall;
        figure.text(
            (rect.right + 5.0, y + 3.8),
            11.0,
            Anchor::Start,
            "",
            INK,
            &number(scale.level(k), scale.step),
        );
    }
    figure.close();
}
