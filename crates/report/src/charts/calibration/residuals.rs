//! Residuals in standard deviations, observation by observation.

use super::super::axis::{Axis, range};
use super::super::figure::{Anchor, Figure, INK, QUIET, Rect, escape, fit};
use super::super::legend::Mark;
use super::super::panel::{BELOW, Panel};
use super::super::picture::{Picture, PictureTable, cell};
use super::super::study::text::{foot, foot_height};
use super::super::style::{CONTEXT, Stroke};
use super::super::symbol::Symbol;
use super::{AFTER, BEFORE, LEFT_OUT, MARGIN, RIGHT, TOP, WIDTH, groups, label, shown, subject};
use cvtcycle_study::fit::outcome::{Outcome, Residual};

/// Residuals within so many standard deviations are no surprise.
const BAND: f64 = 2.0;
/// Room for names, pixels.
const NAMES: f64 = 330.0;
const TEXT: f64 = 11.0;
/// Height of an observation where there are few, and of the name of a group; least distance of two names, pixels.
const ROW: f64 = 15.0;
const HEADING: f64 = 19.0;
const APART: f64 = 13.0;
/// Height of the line above a group of one observation, pixels.
const SEAM: f64 = 3.0;
/// Height of all lines at most, pixels.
const TALL: f64 = 1780.0;
/// With the files' values residuals beyond so many times the others would squeeze those together.
const CLIP: f64 = 3.0;
/// Height of a value of a trace, where there are more than a few, pixels.
const DENSE: f64 = 2.0;
const FEW: f64 = 40.0;
/// Most groups that bear their names.
const MOST_NAMED: usize = 24;

const MARKS: [(usize, &str); 3] = [(0, BEFORE), (0, AFTER), (3, LEFT_OUT)];
const KEYS: [&str; 3] = [
    "With the files' values",
    "Fitted",
    "Predicted: fitted without its fold",
];

/// One line of the picture; a group of one observation has no name above it, only a line.
enum Line<'a> {
    Group(&'a str),
    Alone,
    Observation(&'a Residual, usize),
}

/// Heights of lines, pixels: single numbers can be read as long as there are not too many, values of a trace follow each other closely.
struct Pitch {
    single: f64,
    traced: f64,
}

impl Pitch {
    fn of(lines: &[Line]) -> Self {
        let count =
            |wanted: fn(&Line) -> bool| lines.iter().filter(|line| wanted(line)).count() as f64;
        let headings = count(|line| matches!(line, Line::Group(_)));
        let alone = count(|line| matches!(line, Line::Alone));
        let traced = count(|line| matches!(line, Line::Observation(r, _) if r.time_s.is_some()));
        let single = lines.len() as f64 - headings - alone - traced;
        let dense = if traced > FEW { DENSE } else { ROW };
        let room = TALL - HEADING * headings - SEAM * alone;
        let single_pitch = ((room - dense * traced).max(0.3 * room) / single.max(1.0)).min(ROW);
        Pitch {
            single: single_pitch,
            traced: ((room - single_pitch * single) / traced.max(1.0)).min(dense),
        }
    }

    fn height(&self, line: &Line) -> f64 {
        match line {
            Line::Group(_) => HEADING,
            Line::Alone => SEAM,
            Line::Observation(r, _) if r.time_s.is_some() => self.traced,
            Line::Observation(..) => self.single,
        }
    }
}

/// Draws the residuals by group: with the files' values, fitted, and predicted by a fit that has not seen the observation.
#[must_use]
pub fn residuals_plot(outcome: &Outcome) -> Picture {
    let (kept, thinned) = shown(outcome);
    let sds = "standard deviations";
    let mut table = PictureTable::new(&[
        ("Group", ""),
        ("Observation", ""),
        ("Fold", ""),
        (&format!("Files' values, {sds}"), ""),
        (&format!("Fitted, {sds}"), ""),
        (&format!("Predicted, {sds}"), ""),
    ]);
    let lines = lines(
        outcome,
        kept.iter()
            .map(|k| &outcome.residuals[*k])
            .map(|r| (r, table.push(cells(r)))),
    );
    let axis = axis(&lines);
    let predicted = outcome.residuals.iter().any(|r| r.left_out_sd.is_some());
    let mut notes = vec![
        "Grey band: two standard deviations. Within a measured range the residual is 0.".to_owned(),
    ];
    let beyond = lines.iter().filter(|line| matches!(line, Line::Observation(r, _) if r.before_sd.is_some_and(|x| off(&axis, x)))).count();
    if beyond > 0 {
        notes.push(format!("Triangles at the edge: {beyond} residuals with the files' values lie beyond it; the table has them."));
    }
    notes.extend(thinned);
    table.note = notes.join(" ");
    let keys = if predicted { 3 } else { 2 };
    let entries: Vec<(Mark, &str)> = (0..keys)
        .map(|k| {
            (
                Mark::Point(Symbol::plain(MARKS[k].0, MARKS[k].1), k > 0),
                KEYS[k],
            )
        })
        .collect();
    let pitch = Pitch::of(&lines);
    let left = MARGIN + NAMES;
    let rect = Rect {
        left,
        right: RIGHT,
        top: TOP,
        bottom: TOP
            + 6.0
            + lines
                .iter()
                .map(|line| pitch.height(line))
                .sum::<f64>()
                .max(60.0),
    };
    let (end, wide) = ((MARGIN, rect.bottom + BELOW + 8.0), RIGHT - MARGIN);
    let tall = end.1 + foot_height(KEYS[..keys].iter().copied(), wide, &notes);
    let mut figure = Figure::new(
        (WIDTH, tall),
        MARGIN,
        "Residuals",
        &subject(outcome),
        &describe(outcome),
    );
    let panel = frame(&mut figure, rect, axis);
    draw(&mut figure, &panel, &lines, &pitch);
    panel.outline(&mut figure);
    foot(&mut figure, end, wide, entries, &notes);
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// Observations by group; where there are not too many groups, each has its name above it, unless it has one observation only.
fn lines<'a>(
    outcome: &Outcome,
    rows: impl Iterator<Item = (&'a Residual, usize)>,
) -> Vec<Line<'a>> {
    let size = |name: &str| {
        outcome
            .residuals
            .iter()
            .filter(|other| other.group == name)
            .count()
    };
    let names = groups(outcome);
    let named = names.len() <= 3 * MOST_NAMED
        && names.into_iter().filter(|name| size(name) > 1).count() <= MOST_NAMED;
    let mut lines: Vec<Line> = Vec::new();
    let mut last = "";
    for (r, row) in rows {
        if named && r.group != last {
            lines.push(if size(&r.group) > 1 {
                Line::Group(&r.group)
            } else {
                Line::Alone
            });
        }
        last = &r.group;
        lines.push(Line::Observation(r, row));
    }
    lines
}

fn cells(r: &Residual) -> Vec<String> {
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| cell(x, 0.01));
    vec![
        r.group.clone(),
        label(r),
        r.fold.clone(),
        number(r.before_sd),
        number(Some(r.after_sd)),
        number(r.left_out_sd),
    ]
}

fn off(axis: &Axis, x: f64) -> bool {
    x < axis.low || x > axis.high
}

fn axis(lines: &[Line]) -> Axis {
    let observations = || {
        lines.iter().filter_map(|line| {
            if let Line::Observation(r, _) = line {
                Some(*r)
            } else {
                None
            }
        })
    };
    let fitted = observations()
        .flat_map(|r| [Some(r.after_sd), r.left_out_sd])
        .flatten();
    let (low, high) = range(fitted.chain([-BAND * 1.25, BAND * 1.25])).unwrap_or((-BAND, BAND));
    let (least, most) = range(
        observations()
            .filter_map(|r| r.before_sd)
            .chain([low, high]),
    )
    .unwrap_or((low, high));
    let limit = CLIP * low.abs().max(high.abs());
    let (low, high) = (least.max(-limit), most.min(limit));
    let room = 0.03 * (high - low);
    Axis::exact("Residual [standard deviations]", low - room, high + room, 9)
}

fn frame(figure: &mut Figure, rect: Rect, x: Axis) -> Panel {
    let mut y = Axis::exact("", 0.0, 1.0, 2);
    // Rows have names in place of numbers.
    y.ticks.clear();
    let panel = Panel::draw(figure, rect, x, y, true);
    let band = Rect {
        left: panel.px(-BAND).max(rect.left),
        right: panel.px(BAND).min(rect.right),
        ..rect
    };
    figure.rect(
        band,
        "class=\"band\" fill=\"#777777\" fill-opacity=\"0.16\" stroke=\"none\"",
    );
    panel.line(
        figure,
        &[(0.0, 0.0), (0.0, 1.0)],
        Stroke {
            width: 1.4,
            ..CONTEXT
        },
    );
    panel
}

fn draw(figure: &mut Figure, panel: &Panel, lines: &[Line], pitches: &Pitch) {
    let rect = panel.rect;
    let mut top = rect.top + 3.0;
    let mut last = f64::NEG_INFINITY;
    for line in lines {
        let pitch = pitches.height(line);
        if !matches!(line, Line::Observation(..)) {
            figure.line(
                (MARGIN, top + 1.0),
                (rect.right, top + 1.0),
                "stroke=\"#dedede\" stroke-width=\"3\"",
            );
        }
        match line {
            Line::Alone => {}
            Line::Group(name) => {
                let y = top + 14.0;
                text(figure, (MARGIN, y), "font-weight=\"bold\"", INK, name);
                last = y;
            }
            Line::Observation(r, row) => {
                let y = top + 0.5 * pitch;
                if y + 4.0 - last >= APART {
                    last = y + 4.0;
                    text(
                        figure,
                        (MARGIN, last),
                        &format!("class=\"row\" data-row=\"{row}\""),
                        QUIET,
                        &label(r),
                    );
                }
                marks(
                    figure,
                    panel,
                    r,
                    (*row, y),
                    ((0.3 * pitch).clamp(1.6, 3.6), pitch),
                );
            }
        }
        top += pitch;
    }
}

/// A name cut at its end; the full one shows under the pointer.
fn text(figure: &mut Figure, at: (f64, f64), attributes: &str, colour: &str, name: &str) {
    let short = fit(name, TEXT, NAMES - 12.0);
    let cut = short != name;
    if cut {
        figure.raw(&format!("<g><title>{}</title>", escape(name)));
    }
    figure.text(at, TEXT, Anchor::Start, attributes, colour, &short);
    if cut {
        figure.close();
    }
}

fn marks(
    figure: &mut Figure,
    panel: &Panel,
    r: &Residual,
    (row, y): (usize, f64),
    (radius, pitch): (f64, f64),
) {
    let of_row = format!("data-row=\"{row}\"");
    let [before, after, left_out] = MARKS.map(|(shape, colour)| Symbol::plain(shape, colour));
    let at = |x: f64| panel.px(x.clamp(panel.x.low, panel.x.high));
    if let Some(x) = r.before_sd.filter(|x| x.is_finite()) {
        if pitch > 8.0 && r.after_sd.is_finite() {
            let paint =
                format!("stroke=\"{BEFORE}\" stroke-width=\"2\" stroke-opacity=\"0.5\" {of_row}");
            figure.line((at(x), y), (at(r.after_sd), y), &paint);
        }
        if off(&panel.x, x) {
            edge(figure, (at(x), y), x > 0.0, radius, &of_row);
        } else {
            before.open(figure, (at(x), y), radius, &of_row);
        }
    }
    if let Some(x) = r.left_out_sd.filter(|x| x.is_finite()) {
        left_out.filled(figure, (at(x), y), 0.9 * radius, &of_row);
    }
    if r.after_sd.is_finite() {
        after.filled(figure, (at(r.after_sd), y), 0.9 * radius, &of_row);
    }
}

/// A triangle at the edge, for what lies beyond it.
fn edge(figure: &mut Figure, (x, y): (f64, f64), right: bool, size: f64, attributes: &str) {
    let mut path = super::super::figure::Path::default();
    let back = if right { -2.0 * size } else { 2.0 * size };
    for (dx, dy) in [(0.0, 0.0), (back, -size), (back, size)] {
        path.line_to(x + dx, y + dy);
    }
    path.close();
    let data = path.finish();
    figure.raw(&format!(
        "<path d=\"{data}\" fill=\"{BEFORE}\" stroke=\"none\" {attributes}/>"
    ));
}

fn describe(outcome: &Outcome) -> String {
    let told = |x: Option<f64>| x.map_or_else(|| "not known".to_owned(), |x| format!("{x:.2}"));
    let [before, after, left_out] = outcome.rms_sd().map(told);
    format!(
        "Distance of computed from measured numbers over their standard deviation, by group. Root mean square: {before} with the files' values, \
         {after} fitted, {left_out} predicted."
    )
}
