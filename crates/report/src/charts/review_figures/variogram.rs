//! Where the engine runs against road speed: time in cells, over the lines between which the box can or wants to run.
use super::{TOP, WIDTH};
use crate::charts::axis::{Axis, number};
use crate::charts::density::{Density, KEY_HEIGHT, colour_key, draw_cells};
use crate::charts::figure::{Figure, Path, Rect, UNITS};
use crate::charts::legend::{Mark, below_height, legend_below};
use crate::charts::panel::{BELOW, LEFT, Panel};
use crate::charts::style::{STROKES, Stroke};
use crate::charts::{Picture, PictureTable, cell};

/// Operating points of one car, and the lines that explain them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variogram<'a> {
    /// Name of the car.
    pub subject: String,
    /// Vehicle speed of each step, km/h.
    pub speed_kmh: &'a [f64],
    /// Engine speed of each step, rpm; zero or not finite where the engine is off, and then left out.
    pub engine_rpm: &'a [f64],
    /// Length of each step, s.
    pub seconds: &'a [f64],
    /// Lines, up to seven that stay apart: lowest and highest ratio and the controller's targets, or the gears of a manual box.
    pub lines: Vec<GuideLine>,
}

/// A line of engine speed against vehicle speed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GuideLine {
    /// Name with the condition that it stands for, such as `30 % of rated power`.
    pub name: String,
    /// Vehicle speed, km/h, and engine speed, rpm, by rising vehicle speed.
    pub points: Vec<(f64, f64)>,
    /// Whether the vertical axis takes the line in as far as the car drove; otherwise it may run out of the picture.
    pub whole: bool,
}

const PLOT_LEFT: f64 = LEFT + 8.0;
const PLOT_RIGHT: f64 = WIDTH - 20.0;
const TALL: f64 = 400.0;
/// Most cells along each axis.
const CELLS: (usize, usize) = (80, 40);
/// Width of the light seam along a line, which parts it from dark cells, pixels.
const SEAM: f64 = 1.6;

/// Engine speed against vehicle speed: time spent in each cell, with lines over it.
#[must_use]
pub fn variogram(of: &Variogram) -> Picture {
    let steps = || {
        of.speed_kmh
            .iter()
            .zip(of.engine_rpm)
            .zip(of.seconds)
            .map(|((v, n), dt)| (*v, *n, *dt))
            .filter(|p| p.1 > 0.0)
    };
    let (x, y) = axes(
        of,
        steps().filter(|p| p.0.is_finite() && p.1.is_finite() && p.2 > 0.0),
    );
    let cells = (
        Density::size_for(&x, CELLS.0),
        Density::size_for(&y, CELLS.1),
    );
    let density = Density::gather(cells, steps());
    let rect = Rect {
        left: PLOT_LEFT,
        right: PLOT_RIGHT,
        top: TOP,
        bottom: TOP + TALL,
    };
    let (seen, unseen) = seen(of, &x, &y);
    let names: Vec<String> = seen.iter().map(|(line, _)| line.name.clone()).collect();
    let legend_top = TOP + TALL + BELOW + 8.0;
    let key_top = legend_top
        + if names.is_empty() {
            0.0
        } else {
            below_height(
                names.iter().map(String::as_str),
                WIDTH - PLOT_LEFT - 20.0,
                "",
            ) + 6.0
        };
    let size = (WIDTH, key_top + KEY_HEIGHT + 10.0);
    let mut figure = Figure::new(
        size,
        PLOT_LEFT,
        "Engine speed against vehicle speed",
        &of.subject,
        &describe(of, &density),
    );
    let panel = Panel::draw(&mut figure, rect, x, y, true);
    let scale = density.scale();
    let columns = [
        ("speed from", "km/h"),
        ("to", "km/h"),
        ("engine speed from", "rpm"),
        ("to", "rpm"),
        ("time", "s"),
    ];
    let mut table = PictureTable::new(&columns);
    let (wide, tall) = (cell(cells.0, cells.0), cell(cells.1, cells.1));
    table.note = format!(
        "Cells are {wide} km/h wide and {tall} rpm tall; those in which no time was spent are left out.{unseen}"
    );
    draw_cells(&mut figure, &panel, &density, &scale, |of| {
        let step = |(low, high): (f64, f64)| if high - low < 1.0 { 0.01 } else { 1.0 };
        let edges = [
            (of.x.0, step(of.x)),
            (of.x.1, step(of.x)),
            (of.y.0, step(of.y)),
            (of.y.1, step(of.y)),
            (of.seconds, 0.01),
        ];
        table.push(
            edges
                .iter()
                .map(|(value, step)| cell(*value, *step))
                .collect(),
        )
    });
    let paths: Vec<(Stroke, String)> = seen
        .iter()
        .map(|(line, stroke)| (*stroke, path(&panel, &line.points)))
        .collect();
    // All seams below all lines; the first of the list ends up on top.
    for (stroke, data) in &paths {
        let width = (stroke.width + 2.0 * SEAM) * UNITS;
        let attributes =
            format!("stroke=\"#ffffff\" stroke-opacity=\"0.75\" stroke-width=\"{width:.1}\"");
        figure.raw(&format!(
            "<path class=\"seam\" d=\"{data}\" fill=\"none\" {attributes}/>"
        ));
    }
    for (stroke, data) in paths.iter().rev() {
        figure.raw(&format!(
            "<path class=\"series\" d=\"{data}\" {}/>",
            stroke.attributes()
        ));
    }
    if density.total_s() <= 0.0 {
        panel.empty(&mut figure);
    }
    panel.outline(&mut figure);
    let entries: Vec<_> = paths
        .iter()
        .map(|(stroke, _)| Mark::Line(*stroke))
        .zip(names)
        .collect();
    legend_below(
        &mut figure,
        (PLOT_LEFT, legend_top),
        WIDTH - PLOT_LEFT - 20.0,
        "",
        &entries,
    );
    colour_key(&mut figure, (PLOT_LEFT, key_top), 360.0, &scale);
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// Axes over the steps in which the engine ran, and over those lines that are to be seen as a whole as far as the car drove.
fn axes(of: &Variogram, steps: impl Iterator<Item = (f64, f64, f64)>) -> (Axis, Axis) {
    let (mut speeds, mut revs): (Vec<f64>, Vec<f64>) = steps.map(|p| (p.0, p.1)).unzip();
    let alone = speeds.is_empty();
    let points = || {
        of.lines
            .iter()
            .filter(|line| line.whole || alone)
            .flat_map(|line| &line.points)
            .copied()
    };
    if alone {
        speeds.extend(points().map(|p| p.0));
    }
    let x = Axis::round("Vehicle speed [km/h]", speeds.into_iter().chain([0.0]), 9);
    revs.extend(points().filter(|p| p.0 <= x.high).map(|p| p.1));
    (
        x,
        Axis::round("Engine speed [rpm]", revs.into_iter().chain([0.0]), 8),
    )
}

/// Lines of which a part lies within the axes, with their look, and words about the others.
fn seen<'a>(of: &'a Variogram, x: &Axis, y: &Axis) -> (Vec<(&'a GuideLine, Stroke)>, String) {
    let (mut seen, mut others) = (Vec::new(), Vec::new());
    for (k, line) in of.lines.iter().enumerate() {
        if line
            .points
            .windows(2)
            .any(|pair| clipped((x, y), pair[0], pair[1]).is_some())
        {
            seen.push((line, STROKES[k % STROKES.len()]));
        } else {
            others.push(line.name.as_str());
        }
    }
    let words = if others.is_empty() {
        String::new()
    } else {
        format!(" Outside the picture: {}.", others.join(", "))
    };
    (seen, words)
}

/// The path of a line within the panel.
fn path(panel: &Panel, points: &[(f64, f64)]) -> String {
    let mut path = Path::default();
    let mut at: Option<(f64, f64)> = None;
    for pair in points.windows(2) {
        let piece = clipped((&panel.x, &panel.y), pair[0], pair[1]);
        let piece = piece.map(|(a, b)| {
            (
                (panel.px(a.0), panel.py(a.1)),
                (panel.px(b.0), panel.py(b.1)),
            )
        });
        if let Some((from, to)) = piece {
            if at.is_none_or(|at| (at.0 - from.0).hypot(at.1 - from.1) > 0.01) {
                path.move_to(from.0, from.1);
            }
            path.line_to(to.0, to.1);
        }
        at = piece.map(|(_, to)| to);
    }
    path.finish()
}

/// The part of a piece of line that lies within the axes.
fn clipped(
    (x, y): (&Axis, &Axis),
    a: (f64, f64),
    b: (f64, f64),
) -> Option<((f64, f64), (f64, f64))> {
    if ![a.0, a.1, b.0, b.1].iter().all(|value| value.is_finite()) {
        return None;
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    // Liang and Barsky: each side of the panel shortens the piece.
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

fn describe(of: &Variogram, density: &Density) -> String {
    let lines: Vec<&str> = of.lines.iter().map(|line| line.name.as_str()).collect();
    let over = if lines.is_empty() {
        String::new()
    } else {
        format!(", over lines for {}", lines.join(", "))
    };
    let most = density
        .cells()
        .max_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let told = most.map_or_else(
        || "no time at all".to_owned(),
        |c| {
            let whole = |x: f64| number(x, 1.0);
            let (n, v) = ((whole(c.y.0), whole(c.y.1)), (whole(c.x.0), whole(c.x.1)));
            format!(
                "most, {} s, at {} to {} km/h and {} to {} rpm",
                whole(c.seconds),
                v.0,
                v.1,
                n.0,
                n.1
            )
        },
    );
    format!(
        "Engine speed against vehicle speed{over}. Cells are coloured by the time spent in them, {} s in all; {told}.",
        number(density.total_s(), 1.0)
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    fn line(name: &str, per_kmh: f64) -> GuideLine {
        GuideLine {
            name: name.to_owned(),
            points: (0..=40)
                .map(|k| (5.0 * f64::from(k), 5.0 * f64::from(k) * per_kmh))
                .collect(),
            whole: false,
        }
    }

    #[test]
    fn all_time_is_in_the_table_and_lines_stay_in_the_panel() {
        let speed: Vec<f64> = (0..500).map(|k| 0.24 * f64::from(k)).collect();
        let rpm: Vec<f64> = speed
            .iter()
            .map(|v| (v * 100.0).clamp(850.0, 2600.0))
            .collect();
        let (mut speed, mut rpm, mut seconds) = (speed, rpm, vec![0.5; 500]);
        // A soak with the engine off is no operating point.
        speed.push(0.0);
        rpm.push(0.0);
        seconds.push(600.0);
        let lines = vec![
            line("lowest ratio", 130.0),
            line("highest & <odd>", 22.0),
            line(&"a long name ".repeat(20), 40.0),
        ];
        let picture = variogram(&Variogram {
            subject: "s".to_owned(),
            speed_kmh: &speed,
            engine_rpm: &rpm,
            seconds: &seconds,
            lines,
        });
        check(&picture);
        let time: f64 = picture.table.rows.iter().map(|row| numbers(&row[4])).sum();
        assert!((time - 250.0).abs() < 1e-6, "{time}");
        assert_eq!(picture.svg.matches("class=\"series\"").count(), 3);
        assert_eq!(
            picture.svg.matches("class=\"cell\"").count(),
            picture.table.rows.len()
        );
        assert!(
            !picture.table.rows.iter().any(|row| row[2] == "0"),
            "the engine was off"
        );
        assert_eq!(
            picture
                .svg
                .matches("highest &amp; &lt;odd&gt;</text>")
                .count(),
            1
        );
    }

    #[test]
    fn a_line_is_cut_at_the_frame() {
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

    #[test]
    fn the_axis_takes_in_whole_lines_and_says_which_are_outside() {
        let (speed, rpm, seconds) = ([10.0, 90.0], [1500.0, 2400.0], [1.0, 1.0]);
        let flat = |name: &str, rpm: f64, whole| GuideLine {
            name: name.to_owned(),
            points: vec![(20.0, rpm), (95.0, rpm)],
            whole,
        };
        let lines = vec![flat("target", 3500.0, true), flat("beyond", 5900.0, false)];
        let picture = variogram(&Variogram {
            speed_kmh: &speed,
            engine_rpm: &rpm,
            seconds: &seconds,
            lines,
            ..Variogram::default()
        });
        check(&picture);
        assert!(picture.svg.contains(">target</text>") && !picture.svg.contains(">beyond</text>"));
        assert!(picture.table.note.ends_with("Outside the picture: beyond."));
    }

    #[test]
    fn nothing_is_still_a_picture() {
        check(&variogram(&Variogram::default()));
        let broken = [f64::NAN, f64::INFINITY, 3.0];
        let lines = vec![GuideLine {
            name: String::new(),
            points: vec![(f64::NAN, 1.0), (0.0, 1.0)],
            whole: true,
        }];
        check(&variogram(&Variogram {
            speed_kmh: &broken,
            engine_rpm: &broken,
            seconds: &broken,
            lines,
            ..Variogram::default()
        }));
    }
}
