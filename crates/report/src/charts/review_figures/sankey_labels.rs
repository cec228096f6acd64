//! The words of an energy flow: what begins at the left, the stages above the trunk, the columns at the right.
use super::sankey::{BAND_TOP, Flows, LEFT, Ribbon, Sankey, stage_x};
use super::{TEXT, WIDTH, energy, percent, remark_lines};
use crate::charts::figure::{Anchor, Figure, INK, QUIET, fit, wrap};

const LINE: f64 = 14.0;

/// Name, energy and share left of where a flow begins.
pub(super) fn source_label(figure: &mut Figure, of: &Sankey, name: &str, kj: f64, middle: f64) {
    let share = of
        .shares_of
        .first()
        .map_or(String::new(), |(_, whole)| percent(kj, *whole));
    let room = LEFT - 8.0 - 14.0;
    let mut lines = wrap(name, TEXT, room);
    let names = lines.len();
    lines.extend(
        [energy(kj), share]
            .into_iter()
            .filter(|line| !line.is_empty()),
    );
    let first = middle - 0.5 * LINE * (lines.len() - 1) as f64 + 4.0;
    for (k, line) in lines.iter().enumerate() {
        let weight = if k < names {
            "font-weight=\"bold\""
        } else {
            ""
        };
        // Bold letters are wider than plain ones.
        let line = fit(line, TEXT, room);
        figure.text(
            (LEFT - 8.0, first + LINE * k as f64),
            TEXT,
            Anchor::End,
            weight,
            INK,
            &line,
        );
    }
}

/// Names of the stages above the trunk, with what arrives at each.
pub(super) fn stage_names(figure: &mut Figure, of: &Sankey, flows: &Flows, end: f64) {
    let named: Vec<usize> = (0..of.stages.len())
        .filter(|s| !of.stages[*s].name.is_empty())
        .collect();
    for (k, &s) in named.iter().enumerate() {
        let x = stage_x(of, end, s);
        let room = named
            .get(k + 1)
            .map_or(end + 30.0, |next| stage_x(of, end, *next))
            - x
            - 9.0;
        let came = flows
            .entering
            .iter()
            .filter(|ribbon| ribbon.stage == s)
            .map(|ribbon| -ribbon.of.kj)
            .sum::<f64>();
        let kj = flows.trunk_kj[s] + came;
        let share = of
            .shares_of
            .first()
            .map_or(String::new(), |(_, whole)| percent(kj, *whole));
        let mut lines = wrap(&of.stages[s].name, TEXT, room);
        lines.extend(
            [energy(kj), share]
                .into_iter()
                .map(|text| fit(&text, TEXT, room)),
        );
        let attributes = format!("stroke=\"{QUIET}\" stroke-width=\"2\"");
        let foot = flows.trunk[s].1.max(flows.trunk[s].0 + 4.0);
        figure.line((x, BAND_TOP + 2.0), (x, foot), &attributes);
        for (n, line) in lines.iter().enumerate() {
            figure.text(
                (x + 5.0, BAND_TOP + 12.0 + LINE * n as f64),
                TEXT,
                Anchor::Start,
                "",
                INK,
                line,
            );
        }
    }
}

/// Places of the columns of labels at the right.
pub(super) struct Columns {
    /// Where ribbons end.
    pub end: f64,
    energy: f64,
    shares: Vec<f64>,
}

/// Distance between two columns of shares, pixels.
const SHARE: f64 = 76.0;

impl Columns {
    /// Columns with room for one or two shares.
    pub fn of(of: &Sankey) -> Self {
        let count = of.shares_of.len().min(2);
        let right = WIDTH - 10.0;
        let shares = (0..count)
            .map(|k| right - SHARE * (count - 1 - k) as f64)
            .collect();
        let energy = right - SHARE * count as f64;
        Columns {
            end: energy - 224.0,
            energy,
            shares,
        }
    }

    /// Name, energy and shares of what leaves.
    pub fn label(&self, figure: &mut Figure, of: &Sankey, ribbon: &Ribbon) {
        let middle = ribbon.at_end + 0.5 * ribbon.wide;
        let attributes = format!("stroke=\"{QUIET}\" stroke-width=\"2\"");
        figure.line(
            (self.end + 2.0, middle),
            (self.end + 10.0, middle),
            &attributes,
        );
        let y = middle + 4.0;
        let name = fit(&ribbon.of.name, TEXT, self.energy - 72.0 - self.end - 14.0);
        figure.text((self.end + 14.0, y), TEXT, Anchor::Start, "", INK, &name);
        figure.text(
            (self.energy, y),
            TEXT,
            Anchor::End,
            "",
            INK,
            &energy(ribbon.of.kj),
        );
        for (x, (_, whole)) in self.shares.iter().zip(&of.shares_of) {
            figure.text(
                (*x, y),
                TEXT,
                Anchor::End,
                "",
                INK,
                &percent(ribbon.of.kj, *whole),
            );
        }
    }

    /// What the shares are shares of, above their columns.
    pub fn headings(&self, figure: &mut Figure, of: &Sankey, first: Option<&Ribbon>) {
        let Some(first) = first else { return };
        let foot = first.at_end + 0.5 * first.wide - 18.0;
        for (x, (name, _)) in self.shares.iter().zip(&of.shares_of) {
            let lines = remark_lines(&format!("of {name}"), SHARE - 2.0);
            for (k, line) in lines.iter().rev().enumerate() {
                figure.text(
                    (*x, foot - 13.0 * k as f64),
                    11.0,
                    Anchor::End,
                    "",
                    QUIET,
                    line,
                );
            }
        }
    }
}
