//! Residuals in standard deviations, observation by observation.

use super::{
    AFTER, BEFORE, LEFT_OUT, MARGIN, RIGHT, TOP, WIDE_FOOT, groups, label, rms_in_words, shown,
    subject,
};
use crate::charts::engine::{
    Axis, CONTEXT, Chart, Cut, Entry, Label, Panel, Place, RULE, Rect, Style, Symbol, at,
    optional_cell, range, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use cvtcycle_calibrate::outcome::{Outcome, Residual};

/// Residuals expected to lie within this band, standard deviations.
const BAND: f64 = 2.0;
/// Room for names, pixels.
const NAMES: f64 = 330.0;
/// Height of an observation if there are few, and of the name of a group; minimum distance of two names, pixels.
const ROW: f64 = 15.0;
const HEADING: f64 = 19.0;
const APART: f64 = 13.0;
/// Height of the line above a group of one observation, pixels.
const SEAM: f64 = 3.0;
/// Maximum height of all lines, pixels.
const TALL: f64 = 1780.0;
/// Ratio beyond which residuals with the files' values are clipped, so that they do not compress the others.
const CLIP: f64 = 3.0;
/// Height of a value of a trace with more than `FEW` values, pixels.
const DENSE: f64 = 2.0;
const FEW: f64 = 40.0;
/// Maximum number of named groups.
const MAX_NAMED: usize = 24;

/// Line of the picture; a group of one observation has only a line above it, no name.
enum Line<'a> {
    Group(&'a str),
    Alone,
    Observation(&'a Residual, usize),
}

impl<'a> Line<'a> {
    fn observation(&self) -> Option<&'a Residual> {
        match self {
            Line::Observation(r, _) => Some(r),
            _ => None,
        }
    }
}

/// Heights of lines, pixels: legible for a limited number of single observations, dense for values of a trace.
struct Pitch {
    single: f64,
    traced: f64,
}

impl Pitch {
    fn new(lines: &[Line]) -> Self {
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

/// Title: numbers of observations that the fit meets and predicts.
fn title(outcome: &Outcome) -> String {
    let all = &outcome.residuals;
    let within = |of: fn(&Residual) -> Option<f64>| {
        let values = all.iter().filter_map(of);
        values.filter(|sd| sd.abs() <= BAND).count()
    };
    let fitted = within(|r| Some(r.after_sd));
    let predicted = within(|r| r.left_out_sd);
    let known = all.iter().filter(|r| r.left_out_sd.is_some()).count();
    let rest = match known {
        0 => String::new(),
        n => format!("; {predicted} of {n} when predicted without their fold"),
    };
    format!(
        "{fitted} of {} observations lie within two standard deviations{rest}",
        all.len()
    )
}

/// Draws the residuals by group: with the files' values, fitted, and predicted by a fit that has not seen the observation.
pub fn residuals_plot(outcome: &Outcome) -> Picture {
    let (kept, thinned) = shown(outcome);
    let mut table = table();
    let rows = kept.iter().map(|k| &outcome.residuals[*k]);
    let lines = lines(outcome, rows.map(|r| (r, table.push(cells(r)))));
    let axis = axis(&lines);
    let mut notes = vec![
        "Grey band: two standard deviations. Within a measured range the residual is 0.".to_owned(),
    ];
    let before = lines
        .iter()
        .filter_map(|line| line.observation()?.before_sd);
    let beyond = before.filter(|x| off(&axis, *x)).count();
    if beyond > 0 {
        notes.push(format!("Triangles at the edge: {beyond} residuals with the files' values lie beyond it; the table has them."));
    }
    notes.extend(thinned);
    table.note = notes.join(" ");
    let circle = |style: Style, name: &str| Entry::symbol(Symbol::CIRCLE, style, name);
    let mut entries = vec![
        circle(Symbol::open(BEFORE), "With the files' values"),
        circle(Symbol::filled(AFTER), "Fitted"),
    ];
    if outcome.residuals.iter().any(|r| r.left_out_sd.is_some()) {
        let (style, name) = (
            Symbol::filled(LEFT_OUT),
            "Predicted: fitted without its fold",
        );
        entries.push(Entry::symbol(Symbol::DIAMOND, style, name));
    }
    Chart::new(title(outcome), subject(outcome), MARGIN)
        .lead(rms_in_words(outcome))
        .panels([panel(&lines, axis)])
        .legend(WIDE_FOOT, entries)
        .notes(WIDE_FOOT, notes)
        .picture(table)
}

fn table() -> PictureTable {
    let names = ["Group", "Observation", "Fold"].map(str::to_owned);
    let whose = ["Files' values", "Fitted", "Predicted"];
    let whose = whose.map(|whose| format!("{whose}, standard deviations"));
    PictureTable::with_columns(names.into_iter().chain(whose).map(|name| (name, "")))
}

/// Observations by group. A group has its name above it if it has several observations and the groups are not too many.
fn lines<'a>(
    outcome: &Outcome,
    rows: impl Iterator<Item = (&'a Residual, usize)>,
) -> Vec<Line<'a>> {
    let all = &outcome.residuals;
    let size = |name: &str| all.iter().filter(|other| other.group == name).count();
    let names = groups(outcome);
    let named = names.len() <= 3 * MAX_NAMED
        && names.into_iter().filter(|name| size(name) > 1).count() <= MAX_NAMED;
    let mut lines: Vec<Line> = Vec::new();
    let mut last = "";
    for (r, row) in rows {
        if named && r.group != last {
            let several = size(&r.group) > 1;
            lines.push(if several {
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

fn cells(r: &Residual) -> impl Iterator<Item = String> {
    let numbers = [r.before_sd, Some(r.after_sd), r.left_out_sd];
    let words = [r.group.clone(), label(r), r.fold.clone()];
    let numbers = numbers.map(|x| optional_cell(x, 0.01));
    words.into_iter().chain(numbers)
}

fn off(axis: &Axis, x: f64) -> bool {
    x < axis.low || x > axis.high
}

fn axis(lines: &[Line]) -> Axis {
    let observations = || lines.iter().filter_map(Line::observation);
    let fitted = observations().flat_map(|r| [Some(r.after_sd), r.left_out_sd]);
    let ends = [-BAND * 1.25, BAND * 1.25];
    let (low, high) = range(fitted.flatten().chain(ends)).unwrap_or((-BAND, BAND));
    let before = observations().filter_map(|r| r.before_sd);
    let (least, most) = range(before.chain([low, high])).unwrap_or((low, high));
    let limit = CLIP * low.abs().max(high.abs());
    let (low, high) = (least.max(-limit), most.min(limit));
    let room = 0.03 * (high - low);
    Axis::exact("Residual [standard deviations]", low - room, high + room, 9)
}

/// The panel of all lines; its vertical axis counts pixels from the top.
fn panel(lines: &[Line], x: Axis) -> Panel {
    let pitches = Pitch::new(lines);
    let heights: f64 = lines.iter().map(|line| pitches.height(line)).sum();
    let tall = heights.max(60.0) + 6.0;
    let rect = Rect::new(MARGIN + NAMES, TOP, RIGHT - MARGIN - NAMES, tall);
    let mut panel = Panel::new(rect, x, Axis::bare(tall, 0.0));
    let band = Style::colour(CONTEXT.colour).fill_opacity(0.16);
    let (low, high) = (at(-BAND, f64::NEG_INFINITY), at(BAND, f64::INFINITY));
    panel.rectangle(low, high, band.class("band"));
    panel.upright(0.0, stroke(CONTEXT.colour, 1.4, &[]));
    let left = |y: f64| at(f64::NEG_INFINITY, y).shift(-NAMES, 0.0);
    let name = |y: f64, text: &str| Label::new(left(y), text).cut(Cut::End, NAMES - 12.0);
    let (mut top, mut last) = (3.0, f64::NEG_INFINITY);
    for line in lines {
        let pitch = pitches.height(line);
        if !matches!(line, Line::Observation(..)) {
            let end = at(f64::INFINITY, top + 1.0);
            panel.segment(left(top + 1.0), end, Style::line(RULE));
        }
        match line {
            Line::Alone => {}
            Line::Group(group) => {
                last = top + 14.0;
                panel.label(name(last, group).bold(true));
            }
            Line::Observation(r, row) => {
                let y = top + 0.5 * pitch;
                if y + 4.0 - last >= APART {
                    last = y + 4.0;
                    panel.label(name(last, &label(r)).quiet().class("row").row(*row));
                }
                marks(&mut panel, r, (*row, y), pitch);
            }
        }
        top += pitch;
    }
    panel
}

/// Adds the marks of an observation at a height.
fn marks(panel: &mut Panel, r: &Residual, (row, y): (usize, f64), pitch: f64) {
    let radius = (0.3 * pitch).clamp(1.6, 3.6);
    let ends = (panel.x.low, panel.x.high);
    let place = |x: f64| -> Place { at(x.clamp(ends.0, ends.1), y) };
    if let Some(x) = r.before_sd.filter(|x| x.is_finite()) {
        if pitch > 8.0 && r.after_sd.is_finite() {
            let style = Style::line(stroke(BEFORE, 0.5, &[])).stroke_opacity(0.5);
            panel.segment(place(x), place(r.after_sd), style.row(row));
        }
        // A triangle at the edge marks a residual beyond it.
        let (symbol, style) = if off(&panel.x, x) {
            (Symbol::edge(x > 0.0), Style::colour(BEFORE))
        } else {
            (Symbol::CIRCLE, Symbol::open(BEFORE))
        };
        panel.symbol(symbol, place(x), radius, style.row(row));
    }
    let mut filled = |symbol: Symbol, x: f64, colour: &'static str| {
        if x.is_finite() {
            let style = Symbol::filled(colour).row(row);
            panel.symbol(symbol, place(x), 0.9 * radius, style);
        }
    };
    filled(Symbol::DIAMOND, r.left_out_sd.unwrap_or(f64::NAN), LEFT_OUT);
    filled(Symbol::CIRCLE, r.after_sd, AFTER);
}
