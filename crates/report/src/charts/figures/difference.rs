//! Differences between two runs, term by term: the terms add up to the difference of fuel.

use super::bars::{at_end, axis_with_room, bar, bars_panel, name};
use super::{MARGIN, TEXT, TOP, Term, energy, finite};
use crate::charts::engine::{Chart, Fill, INK, QUIET, Style, WIDTH, at, cell, rows_left, stroke};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::{capital, grouped, signed};
use cvtcycle_output::Component;

/// Share of all changes below which terms are combined.
const SMALL: f64 = 0.01;

/// Two runs A and B, term by term.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnergyDifference {
    /// Names of runs A and B.
    pub names: [String; 2],
    /// Energy of a litre of fuel in A and in B, kJ/L.
    pub fuel_kj_per_l: [f64; 2],
    /// Driven distance of A and of B, km.
    pub distance_km: [f64; 2],
    /// Fuel energy of A and of B, kJ.
    pub fuel_kj: [f64; 2],
    /// Uses of the energy, each once.
    pub terms: Vec<DifferenceTerm>,
}

/// One use of the fuel's energy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DifferenceTerm {
    /// Name.
    pub name: String,
    /// Kind of term, for its fill.
    pub term: Term,
    /// Energy in runs A and B, kJ; zero if a run has no such term.
    pub kj: [f64; 2],
}

impl DifferenceTerm {
    /// A component of the transmission.
    pub fn component(component: Component, kj: [f64; 2]) -> Self {
        Self::term(&capital(component.name()), Term::Component(component), kj)
    }

    /// A term of the ledger.
    pub fn term(name: &str, term: Term, kj: [f64; 2]) -> Self {
        let name = name.to_owned();
        DifferenceTerm { name, term, kj }
    }

    fn change(&self) -> f64 {
        finite(self.kj[1]) - finite(self.kj[0])
    }
}

impl EnergyDifference {
    /// Fuel with the energy of a term in A and in B, and the difference, L/100 km.
    fn litres(&self, kj: [f64; 2]) -> [f64; 3] {
        let data = |k: usize| 100.0 * finite(kj[k]) / (self.fuel_kj_per_l[k] * self.distance_km[k]);
        let (a, b) = (data(0), data(1));
        [a, b, b - a]
    }

    /// Splits the terms into those with at least a hundredth of all changes, and the others if there are several.
    fn by_size(&self) -> (Vec<DifferenceTerm>, Vec<DifferenceTerm>) {
        let all: f64 = self.terms.iter().map(|term| term.change().abs()).sum();
        let large = |term: &DifferenceTerm| term.change().abs() >= SMALL * all;
        let (kept, small): (Vec<_>, Vec<_>) = self.terms.iter().cloned().partition(large);
        match small.len() {
            0 | 1 => (self.terms.clone(), Vec::new()),
            _ => (kept, small),
        }
    }

    /// Terms to draw, small ones combined.
    fn folded(&self) -> Vec<DifferenceTerm> {
        let (mut kept, small) = self.by_size();
        if !small.is_empty() {
            let rest = [0, 1].map(|k| small.iter().map(|term| finite(term.kj[k])).sum());
            kept.push(DifferenceTerm::term(
                &format!("{} others", small.len()),
                Term::Other,
                rest,
            ));
        }
        kept
    }

    /// The row of a term.
    fn cells(&self, term: &DifferenceTerm) -> Vec<String> {
        let kj = [term.kj[0], term.kj[1], term.change()].map(|kj| cell(kj, 0.01));
        let fuel = self.litres(term.kj).map(|l| cell(l, 0.0001));
        [term.name.clone()]
            .into_iter()
            .chain(kj)
            .chain(fuel)
            .collect()
    }

    /// Terms, with one for the unaccounted rest of the fuel if it exceeds rounding, and the fuel at the end.
    fn complete_terms(&self) -> Vec<DifferenceTerm> {
        let mut terms = self.folded();
        let sum = |k: usize| {
            let kj = self.terms.iter().map(|term| finite(term.kj[k]));
            kj.sum::<f64>()
        };
        let rest = [0, 1].map(|k| finite(self.fuel_kj[k]) - sum(k));
        let largest = |kj: [f64; 2]| kj[0].abs().max(kj[1].abs());
        if largest(rest) > 1e-6 * largest(self.fuel_kj.map(finite)) {
            terms.push(DifferenceTerm::term("Not accounted for", Term::Other, rest));
        }
        terms.push(DifferenceTerm::term(
            "Fuel: sum of all",
            Term::Other,
            self.fuel_kj,
        ));
        terms
    }
}

/// Difference B - A of every term, in kJ and as fuel of that energy in L/100 km, with the difference of fuel at the end.
pub fn difference_bars(data: &EnergyDifference) -> Picture {
    let terms = data.complete_terms();
    let last = terms.len() - 1;
    let (kept, small) = data.by_size();
    let place_of_others = kept.len();
    let words = |term: &DifferenceTerm| label(term.change(), data.litres(term.kj)[2]);
    let left = rows_left(terms.iter().map(|term| term.name.as_str()), TEXT);
    let changes = terms.iter().map(DifferenceTerm::change);
    let title = "B \u{2212} A over the cycle [kJ]";
    let x = axis_with_room(title, left, changes, terms.iter().map(words));
    let mut panel = bars_panel((left, TOP), terms.len(), x);
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let units = ["kJ", "L/100 km"];
    let columns = units.map(|unit| ["A", "B", "B \u{2212} A"].map(|name| (name, unit)));
    let mut table = PictureTable::new(&[&[("term", "")], &columns.concat()[..]].concat());
    table.note = explain(data);
    for (row, term) in terms.iter().enumerate() {
        let (sum, change) = (row == last, term.change());
        // The table lists each small term, the figure their sum.
        let at_row = match term.term {
            Term::Other if !small.is_empty() && row == place_of_others => {
                table.rows.extend(small.iter().map(|term| data.cells(term)));
                None
            }
            _ => Some(table.push(data.cells(term))),
        };
        if sum {
            let [start, end] = [f64::NEG_INFINITY, f64::INFINITY].map(|x| at(x, row as f64));
            let rule = Style::line(stroke(QUIET, 0.75, &[]));
            panel.segment(start.shift(MARGIN - left, 0.0), end, rule);
        }
        let fill = if sum {
            Fill::plain(INK)
        } else {
            term.term.fill()
        };
        name(&mut panel, row, &term.name, sum);
        let mut style = Style::edged(fill, 0.5);
        style.row = at_row;
        bar(&mut panel, row, (0.0, change), style);
        at_end(&mut panel, row, change, sum, words(term));
    }
    let subject = format!("A: {}; B: {}", data.names[0], data.names[1]);
    Chart::new(title_of(data), subject, MARGIN)
        .panels([panel])
        .notes((MARGIN, WIDTH - 40.0), vec![explain(data)])
        .picture(table)
}

/// Share from which a part is most of a whole.
const MOST: f64 = 0.5;

/// Title: fuel that B burns more or less, and the largest part of it.
fn title_of(data: &EnergyDifference) -> String {
    let fuel = finite(data.fuel_kj[1]) - finite(data.fuel_kj[0]);
    if fuel.abs() < 1e-9 {
        return "B burns as much as A".to_owned();
    }
    let largest = data
        .terms
        .iter()
        .max_by(|a, b| a.change().abs().total_cmp(&b.change().abs()));
    let largest = largest.map_or_else(String::new, |term| {
        let change = term.change();
        // Parts of both signs add up: one may be larger than the whole.
        let word = match change / fuel > MOST {
            true => "most of it",
            false => "the largest part",
        };
        format!(
            ", {word} {} ({})",
            term.name.to_lowercase(),
            signed(energy(change), change)
        )
    });
    let more = if fuel < 0.0 { "less" } else { "more" };
    format!("B burns {} {more} than A{largest}", energy(fuel.abs()))
}

fn label(kj: f64, litres: f64) -> String {
    let energy = signed(energy(kj), kj);
    if litres.is_finite() {
        format!("{energy}, {} L/100 km", signed(grouped(litres, 3), litres))
    } else {
        energy
    }
}

fn explain(data: &EnergyDifference) -> String {
    let [a, b] = data.distance_km;
    let far = if (a - b).abs() > 1e-6 * a.abs().max(b.abs()) {
        format!(
            " The runs differ in distance, {} and {} km: kJ are those driven, L/100 km take the distance in.",
            grouped(a, 3),
            grouped(b, 3)
        )
    } else {
        String::new()
    };
    format!(
        "Each term is also given as the fuel with that energy; both columns add up to the difference of fuel.{far}"
    )
}

#[cfg(test)]
mod tests {
    use super::EnergyDifference;

    #[test]
    fn fuel_of_terms_sums_to_fuel_of_run() {
        let data = EnergyDifference {
            fuel_kj_per_l: [32_000.0, 31_500.0],
            distance_km: [11.0, 10.9],
            ..EnergyDifference::default()
        };
        let terms = [
            [15_000.0, 14_900.0],
            [-0.8, 0.0],
            [390.0, 520.5],
            [2300.0, 2310.0],
        ];
        let sum: f64 = terms.iter().map(|kj| data.litres(*kj)[2]).sum();
        let all = [0, 1].map(|k| terms.iter().map(|kj| kj[k]).sum());
        assert!((sum - data.litres(all)[2]).abs() < 1e-12);
    }
}
