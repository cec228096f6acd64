//! Measured against computed: a panel a unit, a mark an observation.

use super::super::axis::{Axis, range};
use super::super::figure::{Figure, Rect};
use super::super::legend::Mark;
use super::super::panel::{BELOW, LEFT, Panel};
use super::super::picture::{Picture, PictureTable};
use super::super::study::text::{foot, foot_height};
use super::super::style::CONTEXT;
use super::super::symbol::Symbol;
use super::{
    BEFORE, RIGHT, TOP, WIDTH, common_note, groups, in_sd, label, measured_cells, shown, subject,
    symbol, unit,
};
use cvtcycle_study::fit::outcome::{Outcome, Residual};

/// Most panels: more do not fit on a page.
const MOST: usize = 8;
const GAP: (f64, f64) = (18.0, 10.0);
const RADIUS: f64 = 3.4;

/// Draws computed over measured numbers, before (open) and after (filled), with standard deviations, ranges and the line of agreement.
#[must_use]
pub fn scatter_plot(outcome: &Outcome) -> Picture {
    let (kept, thinned) = shown(outcome);
    let mut table = PictureTable::new(&[
        ("Group", ""),
        ("Observation", ""),
        ("Unit", ""),
        ("Measured, or from", ""),
        ("Measured, or to", ""),
        ("Standard deviation", ""),
        ("Files' values", ""),
        ("Fitted", ""),
    ]);
    let rows: Vec<(&Residual, usize)> = kept
        .iter()
        .map(|k| &outcome.residuals[*k])
        .map(|r| (r, table.push(cells(r))))
        .collect();
    let mut units: Vec<&str> = Vec::new();
    for (r, _) in &rows {
        if !units.contains(&unit(&r.unit)) {
            units.push(unit(&r.unit));
        }
    }
    let mut notes = vec!["Bars: a standard deviation on either side, or the measured range. Thin line: computed = measured.".to_owned()];
    notes.extend(thinned);
    notes.extend(common_note(outcome));
    if units.len() > MOST {
        notes.push(format!("In the table only: {}.", units[MOST..].join(", ")));
        units.truncate(MOST);
    }
    table.note = notes.join(" ");
    let names = groups(outcome);
    let mut entries: Vec<(Mark, &str)> = names
        .iter()
        .map(|name| (Mark::Point(symbol(&names, name), true), *name))
        .collect();
    entries.push((
        Mark::Point(Symbol::plain(0, BEFORE), false),
        "open: with the files' values",
    ));
    let layout = Layout::of(units.len());
    let end = (LEFT + 8.0, layout.bottom());
    let wide = RIGHT - end.0;
    let tall = end.1 + foot_height(entries.iter().map(|(_, name)| *name), wide, &notes);
    let desc = describe(outcome, &units);
    let mut figure = Figure::new(
        (WIDTH, tall),
        LEFT + 8.0,
        "Measured and computed",
        &subject(outcome),
        &desc,
    );
    for (k, name) in units.iter().enumerate() {
        let own: Vec<(&Residual, usize)> = rows
            .iter()
            .copied()
            .filter(|(r, _)| unit(&r.unit) == *name)
            .collect();
        draw(&mut figure, layout.rect(k), name, &own, &names);
    }
    foot(&mut figure, end, wide, entries, &notes);
    Picture {
        svg: figure.finish(),
        table,
    }
}

fn cells(r: &Residual) -> Vec<String> {
    let [low, high] = measured_cells(r);
    let computed = [
        in_sd(Some(r.sd), r),
        in_sd(r.before, r),
        in_sd(Some(r.after), r),
    ];
    [
        r.group.clone(),
        label(r),
        unit(&r.unit).to_owned(),
        low,
        high,
    ]
    .into_iter()
    .chain(computed)
    .collect()
}

/// How panels stand: a lone one is larger.
struct Layout {
    panels: usize,
    size: (f64, f64),
}

impl Layout {
    fn of(panels: usize) -> Self {
        let room = (RIGHT - 8.0 - 2.0 * LEFT - GAP.0) / 2.0;
        Layout {
            panels: panels.max(1),
            size: if panels > 1 {
                (room, 290.0)
            } else {
                (560.0, 440.0)
            },
        }
    }

    fn rect(&self, k: usize) -> Rect {
        let left = 8.0 + LEFT + (LEFT + self.size.0 + GAP.0) * (k % 2) as f64;
        let top = TOP + (self.size.1 + BELOW + GAP.1) * (k / 2) as f64;
        Rect {
            left,
            right: left + self.size.0,
            top,
            bottom: top + self.size.1,
        }
    }

    fn bottom(&self) -> f64 {
        TOP + (self.size.1 + BELOW + GAP.1) * self.panels.div_ceil(2) as f64
    }
}

/// Where the mark of an observation stands on the measured axis: in the middle of a range, or at the end that there is.
fn place(r: &Residual) -> Option<f64> {
    let finite = |x: Option<f64>| x.filter(|x| x.is_finite());
    match (finite(r.low), finite(r.high)) {
        (Some(low), Some(high)) => Some(f64::midpoint(low, high)),
        (one, other) => one.or(other),
    }
}

/// What was measured, and what may have been, on the measured axis; an open end is none.
fn bar(r: &Residual) -> [Option<f64>; 2] {
    match (r.low, r.high) {
        (Some(low), Some(high)) if low.total_cmp(&high).is_eq() => {
            [Some(low - r.sd), Some(high + r.sd)]
        }
        (low, high) => [
            low.filter(|x| x.is_finite()),
            high.filter(|x| x.is_finite()),
        ],
    }
}

fn draw(figure: &mut Figure, rect: Rect, name: &str, rows: &[(&Residual, usize)], groups: &[&str]) {
    let seen = |r: &Residual| {
        bar(r)
            .into_iter()
            .flatten()
            .chain([r.after])
            .chain(r.before)
            .collect::<Vec<f64>>()
    };
    let (low, high) = range(rows.iter().flat_map(|(r, _)| seen(r))).unwrap_or((0.0, 1.0));
    let span = high - low;
    let room = if span > 1e-9 * high.abs() {
        0.05 * span
    } else {
        0.1 * high.abs() + 1e-3
    };
    let axis = |what: &str| Axis::exact(&format!("{what} [{name}]"), low - room, high + room, 7);
    let panel = Panel::draw(figure, rect, axis("Measured"), axis("Computed"), true);
    panel.line(
        figure,
        &[(panel.x.low, panel.y.low), (panel.x.high, panel.y.high)],
        CONTEXT,
    );
    for (r, row) in rows {
        let (Some(x), mark) = (place(r), symbol(groups, &r.group)) else {
            continue;
        };
        let of_row = format!("data-row=\"{row}\"");
        if let Some(y) = r.before.filter(|y| y.is_finite()) {
            mark.open(figure, (panel.px(x), panel.py(y)), RADIUS, &of_row);
        }
        if !r.after.is_finite() {
            continue;
        }
        let y = panel.py(r.after);
        let [from, to] = bar(r);
        let ends = [
            from.map_or(rect.left, |x| panel.px(x)),
            to.map_or(rect.right, |x| panel.px(x)),
        ];
        let paint = format!(
            "stroke=\"{}\" stroke-width=\"3\" stroke-opacity=\"0.6\" {of_row}",
            mark.colour()
        );
        figure.line((ends[0], y), (ends[1], y), &paint);
        mark.filled(figure, (panel.px(x), y), RADIUS, &of_row);
    }
    panel.outline(figure);
}

fn describe(outcome: &Outcome, units: &[&str]) -> String {
    let [before, after, _] = outcome
        .rms_sd()
        .map(|x| x.map_or_else(|| "unknown".to_owned(), |x| format!("{x:.2}")));
    format!(
        "Computed over measured numbers, a panel for each of the units {}. Root mean square of the residuals {before} standard deviations with the files' values, {after} fitted.",
        units.join(", ")
    )
}
