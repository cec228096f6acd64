//! Engine speed against road speed: time in cells, over the lines of the transmission's limits and targets.

use super::{TOP, drive_subtitle};
use crate::charts::engine::{
    Axis, Block, Chart, End, Entry, ON_CELLS, PLOT_LEFT, Panel, Point, Rect, STROKES, Shape,
    Stroke, Style, WIDTH, cell, stroke, text_width,
};
use crate::charts::grids::Density;
use crate::charts::picture::{Picture, PictureTable};
use crate::number::grouped;

/// Operating points of one car, and the lines that explain them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variogram<'a> {
    /// Name of the car.
    pub subject: String,
    /// Cycle, ambient temperature and start.
    pub conditions: String,
    /// Vehicle speed of each step, km/h.
    pub speed_kmh: &'a [f64],
    /// Engine speed of each step, rpm; steps are omitted if it is zero or not finite, with the engine off.
    pub engine_rpm: &'a [f64],
    /// Length of each step, s.
    pub seconds: &'a [f64],
    /// Up to seven distinguishable lines: lowest and highest ratio and the controller's targets, or the gears of a manual box.
    pub lines: Vec<GuideLine>,
}

/// A line of engine speed against vehicle speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuideLine {
    /// Name with its condition, such as `30 % of rated power`.
    pub name: String,
    /// Vehicle speed, km/h, and engine speed, rpm, by rising vehicle speed.
    pub points: Vec<(f64, f64)>,
    /// True if the vertical axis includes the line over the driven range; otherwise it may leave the picture.
    pub whole: bool,
}

const WIDE: f64 = WIDTH - 20.0 - PLOT_LEFT;
/// Room above the panel for names of lines that leave there, pixels.
const ABOVE: f64 = 16.0;
/// Size of a name, pixels.
const NAME: f64 = 11.0;
const TALL: f64 = 400.0;
/// Maximum number of cells along each axis.
const CELLS: (usize, usize) = (80, 40);
/// Width of the light seam that separates a line from dark cells, pixels.
const SEAM: f64 = 1.6;

impl Variogram<'_> {
    /// Vehicle speed, engine speed and length of the steps in which the engine ran.
    fn steps(&self) -> impl Iterator<Item = (f64, f64, f64)> {
        let speeds = self.speed_kmh.iter().zip(self.engine_rpm);
        let steps = speeds.zip(self.seconds).map(|((v, n), dt)| (*v, *n, *dt));
        steps.filter(|p| p.1 > 0.0)
    }
}

/// Engine speed against vehicle speed: time spent in each cell, with lines over it.
pub fn variogram(data: &Variogram) -> Picture {
    let (x, y) = axes(data);
    let cells = Density::size_for(&x, &y, CELLS);
    // Constant speeds lie on round numbers; these become the middles of cells.
    let half = 0.5 * cells.1;
    let steps = data.steps().map(|(v, n, dt)| (v, n + half, dt));
    let density = Density::new(cells, steps).lowered(half);
    let (seen, outside) = seen(data, &x, &y);
    let columns = ["speed from", "to", "engine speed from", "to", "time"];
    let units = ["km/h", "km/h", "rpm", "rpm", "s"];
    let columns: Vec<_> = columns.into_iter().zip(units).collect();
    let mut table = PictureTable::new(&columns).note(format!(
        "Cells are {} km/h wide and {} rpm tall; those in which no time was spent are left out.{outside}",
        cell(cells.0, cells.0),
        cell(cells.1, cells.1)
    ));
    let names = |(name, points, line): &SeenLine| End {
        at: *points.last().unwrap_or(&(f64::NAN, f64::NAN)),
        text: (*name).to_owned(),
        colour: line.colour,
    };
    let is_high = |end: &End| (end.at.1 - y.high).abs() < 1e-6 * y.high;
    let (above, at_right): (Vec<End>, Vec<End>) = seen.iter().map(names).partition(is_high);
    let room = at_right
        .iter()
        .map(|end| text_width(&end.text, NAME).min(ON_CELLS) + 10.0);
    let wide = WIDE - room.fold(0.0, f64::max);
    let rect = Rect::new(PLOT_LEFT, TOP + ABOVE, wide, TALL);
    let mut panel = Panel::new(rect, x, y).no_data(density.total_s() <= 0.0);
    panel.items = density.items(|data| {
        let step = |(low, high): (f64, f64)| if high - low < 1.0 { 0.01 } else { 1.0 };
        let ends = |x: (f64, f64)| [x.0, x.1].map(|end| cell(end, step(x)));
        let ends = ends(data.x).into_iter().chain(ends(data.y));
        table.push(ends.chain([cell(data.seconds, 0.01)]))
    });
    // All seams lie below all lines; the first of the list is on top.
    for (_, points, line) in &seen {
        let seam = Style::line(stroke("#ffffff", line.width + 2.0 * SEAM, &[]));
        let seam = seam.stroke_opacity(0.75).class("seam");
        panel.add(Shape::Line(points.clone()), seam);
    }
    for (_, points, line) in seen.iter().rev() {
        panel.series(points.clone(), *line);
    }
    (panel.ends, panel.above, panel.on_cells) = (at_right, above, true);
    // A legend repeats names that were cut.
    let is_cut = |data: &&SeenLine| text_width(data.0, NAME) > ON_CELLS;
    let entries = seen.iter().filter(is_cut);
    let entries = entries.map(|(name, _, line)| Entry::line(*line, *name));
    let drive = drive_subtitle(&data.subject, &data.conditions);
    let subtitle = format!("Time in each cell in s; {drive}");
    Chart::new(title(data, &density), &subtitle, PLOT_LEFT)
        .lead("Cells are coloured by the time spent in them")
        .panels([panel])
        .legend((PLOT_LEFT, WIDE), entries)
        .foot(Block::key(
            (PLOT_LEFT, 360.0),
            density.key("Time spent in a cell [s]"),
        ))
        .picture(table)
}

/// Title: the row of cells with the largest share of time.
fn title(data: &Variogram, density: &Density) -> String {
    let mut rows: Vec<((f64, f64), f64)> = Vec::new();
    for cell in density.cells() {
        match rows
            .iter_mut()
            .find(|row| (row.0.0 - cell.y.0).abs() < 1e-6)
        {
            Some(row) => row.1 += cell.seconds,
            None => rows.push((cell.y, cell.seconds)),
        }
    }
    let longest = rows.into_iter().max_by(|a, b| a.1.total_cmp(&b.1));
    match longest.filter(|_| density.total_s() > 0.0) {
        Some(((from, to), seconds)) => format!(
            "The engine of {} runs at {} to {} rpm for {} % of its time",
            data.subject,
            grouped(from, 0),
            grouped(to, 0),
            grouped(100.0 * seconds / density.total_s(), 0)
        ),
        None => "Engine speed against vehicle speed".to_owned(),
    }
}

/// Axes over the steps with the engine running, and over the lines to be included as far as the car drove.
fn axes(data: &Variogram) -> (Axis, Axis) {
    let finite = |p: &(f64, f64, f64)| p.0.is_finite() && p.1.is_finite() && p.2 > 0.0;
    let steps = data.steps().filter(finite).map(|p| (p.0, p.1));
    let (mut speeds, mut revs): (Vec<f64>, Vec<f64>) = steps.unzip();
    let alone = speeds.is_empty();
    let points = || {
        let lines = data.lines.iter().filter(|line| line.whole || alone);
        lines.flat_map(|line| &line.points).copied()
    };
    if alone {
        speeds.extend(points().map(|p| p.0));
    }
    let x = Axis::round("Vehicle speed [km/h]", speeds.into_iter().chain([0.0]), 9);
    revs.extend(points().filter(|p| p.0 <= x.high).map(|p| p.1));
    let y = Axis::round("Engine speed [rpm]", revs.into_iter().chain([0.0]), 8);
    (x, y)
}

/// A line with its name, visible points and look.
type SeenLine<'a> = (&'a str, Vec<Point>, Stroke);

/// Lines that are partly within the axes, and a remark on the others.
fn seen<'a>(data: &'a Variogram, x: &Axis, y: &Axis) -> (Vec<SeenLine<'a>>, String) {
    let (mut seen, mut others) = (Vec::new(), Vec::new());
    for (line, stroke) in data.lines.iter().zip(STROKES.into_iter().cycle()) {
        let points = within((x, y), &line.points);
        if points.is_empty() {
            others.push(line.name.as_str());
        } else {
            seen.push((line.name.as_str(), points, stroke));
        }
    }
    let remark = format!(" Outside the picture: {}.", others.join(", "));
    (
        seen,
        if others.is_empty() {
            String::new()
        } else {
            remark
        },
    )
}

/// Parts of a line within the axes, with gaps between them.
fn within(axes: (&Axis, &Axis), points: &[Point]) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    for pair in points.windows(2) {
        let Some((from, to)) = clipped(axes, pair[0], pair[1]) else {
            continue;
        };
        match out.last() {
            Some(last) if (last.0 - from.0).abs() <= 1e-9 && (last.1 - from.1).abs() <= 1e-9 => {}
            Some(_) => out.extend([(f64::NAN, f64::NAN), from]),
            None => out.push(from),
        }
        out.push(to);
    }
    out
}

/// Clips a segment to the axes.
fn clipped((x, y): (&Axis, &Axis), a: Point, b: Point) -> Option<(Point, Point)> {
    if ![a.0, a.1, b.0, b.1].iter().all(|value| value.is_finite()) {
        return None;
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    // Liang and Barsky: each side of the panel shortens the segment.
    for (start, change, low, high) in [
        (a.0, b.0 - a.0, x.low, x.high),
        (a.1, b.1 - a.1, y.low, y.high),
    ] {
        if change.abs() > 0.0 {
            let (one, other) = ((low - start) / change, (high - start) / change);
            from = from.max(one.min(other));
            to = to.min(one.max(other));
        } else if start < low || start > high {
            return None;
        }
    }
    let at = |t: f64| (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1));
    (from <= to).then(|| (at(from), at(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn line_is_clipped_to_the_frame() {
        let axes = (
            &Axis::exact("", 0.0, 10.0, 5),
            &Axis::exact("", 0.0, 10.0, 5),
        );
        let (from, to) = clipped(axes, (-5.0, 5.0), (5.0, 15.0)).expect("it touches the corner");
        assert!(
            from.0.abs() < 1e-9 && (from.1 - 10.0).abs() < 1e-9 && (to.0 - from.0).abs() < 1e-9
        );
        let (from, to) = clipped(axes, (0.0, 0.0), (20.0, 10.0)).expect("half of it is within");
        assert!(from.1.abs() < 1e-9 && (to.0 - 10.0).abs() < 1e-9 && (to.1 - 5.0).abs() < 1e-9);
        assert!(
            clipped(axes, (11.0, 0.0), (11.0, 5.0)).is_none()
                && clipped(axes, (f64::NAN, 0.0), (1.0, 1.0)).is_none()
        );
    }
}
