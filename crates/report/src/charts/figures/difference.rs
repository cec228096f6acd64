//! What changed between two runs, term by term: the terms add up to the difference of fuel.

use super::bar_rows::{at_end, axis_with_room, bar, bars_panel, label_room, name};
use super::{MARGIN, TEXT, TOP, Term, energy, finite, grouped};
use crate::charts::engine::{
    Block, Chart, Fill, INK, QUIET, Shape, Style, WIDTH, at, cell, rows_left, stroke,
};
use crate::charts::picture::{Picture, PictureTable};
use crate::number::capital;
use cvtcycle_output::Component;

/// Two runs A and B, term by term.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Difference {
    /// Name of run A.
    pub a: String,
    /// Name of run B.
    pub b: String,
    /// Energy of a litre of fuel in A and in B, kJ/L.
    pub fuel_kj_per_l: (f64, f64),
    /// Driven distance of A and of B, km.
    pub distance_km: (f64, f64),
    /// Fuel energy of A and of B, kJ.
    pub fuel_kj: (f64, f64),
    /// Where it went, each once.
    pub terms: Vec<DifferenceTerm>,
}

/// One use of the fuel's energy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DifferenceTerm {
    /// Name; a component of the transmission has its own words.
    pub name: String,
    /// Component of the transmission, for its fill.
    pub component: Option<Component>,
    /// What it is otherwise, for its fill.
    pub term: Term,
    /// Energy in run A, kJ; nothing if A has no such component.
    pub a_kj: f64,
    /// Energy in run B, kJ.
    pub b_kj: f64,
}

impl DifferenceTerm {
    /// A component of the transmission.
    #[must_use]
    pub fn of(component: Component, a_kj: f64, b_kj: f64) -> Self {
        DifferenceTerm {
            name: capital(component.name()),
            component: Some(component),
            term: Term::Other,
            a_kj,
            b_kj,
        }
    }

    /// A term of the ledger.
    #[must_use]
    pub fn term(name: &str, term: Term, a_kj: f64, b_kj: f64) -> Self {
        DifferenceTerm {
            name: name.to_owned(),
            component: None,
            term,
            a_kj,
            b_kj,
        }
    }
}

impl Difference {
    /// Fuel with the energy of a term in A and in B, and the difference, L/100 km.
    fn litres(&self, a_kj: f64, b_kj: f64) -> (f64, f64, f64) {
        let a = 100.0 * finite(a_kj) / (self.fuel_kj_per_l.0 * self.distance_km.0);
        let b = 100.0 * finite(b_kj) / (self.fuel_kj_per_l.1 * self.distance_km.1);
        (a, b, b - a)
    }

    /// The terms, with one for what they leave of the fuel if that is more than rounding.
    fn complete_terms(&self) -> Vec<DifferenceTerm> {
        let sum = |of: fn(&DifferenceTerm) -> f64| {
            self.terms.iter().map(|term| finite(of(term))).sum::<f64>()
        };
        let a = finite(self.fuel_kj.0) - sum(|term| term.a_kj);
        let b = finite(self.fuel_kj.1) - sum(|term| term.b_kj);
        let size_kj = finite(self.fuel_kj.0)
            .abs()
            .max(finite(self.fuel_kj.1).abs());
        let mut terms = self.terms.clone();
        if a.abs().max(b.abs()) > 1e-6 * size_kj {
            terms.push(DifferenceTerm::term("Not accounted for", Term::Other, a, b));
        }
        terms
    }
}

impl DifferenceTerm {
    fn change(&self) -> f64 {
        finite(self.b_kj) - finite(self.a_kj)
    }
}

/// Difference B - A of every term, in kJ and as fuel of that energy in L/100 km, with the difference of fuel at the end.
#[must_use]
pub fn difference_bars(of: &Difference) -> Picture {
    let mut terms = of.complete_terms();
    let (a_kj, b_kj) = of.fuel_kj;
    terms.push(DifferenceTerm::term(
        "Fuel: sum of all",
        Term::Other,
        a_kj,
        b_kj,
    ));
    let last = terms.len() - 1;
    let words = |term: &DifferenceTerm| label(term.change(), of.litres(term.a_kj, term.b_kj).2);
    let left = rows_left(terms.iter().map(|term| term.name.as_str()), TEXT);
    let changes = terms.iter().map(DifferenceTerm::change);
    let room = label_room(terms.iter().map(words));
    let x = axis_with_room("B \u{2212} A over the cycle [kJ]", left, changes, room);
    let mut panel = bars_panel((left, TOP), terms.len(), x);
    panel.upright(0.0, stroke(INK, 1.0, &[]));
    let mut table = table();
    table.note = explain(of);
    for (row, term) in terms.iter().enumerate() {
        let (sum, change) = (row == last, term.change());
        let (a, b, litres) = of.litres(term.a_kj, term.b_kj);
        let kj = [term.a_kj, term.b_kj, change].map(|kj| cell(kj, 0.01));
        let fuel = [a, b, litres].map(|l| cell(l, 0.0001));
        let at_row = table.push([std::slice::from_ref(&term.name), &kj[..], &fuel[..]].concat());
        if sum {
            let start = at(f64::NEG_INFINITY, row as f64).shift(MARGIN - left, 0.0);
            let rule = Style::line(stroke(QUIET, 0.75, &[]));
            panel.add(Shape::Segment(start, at(f64::INFINITY, row as f64)), rule);
        }
        let fill = if sum {
            Fill::plain(INK)
        } else {
            term.term.fill(term.component)
        };
        name(&mut panel, row, &term.name, sum);
        bar(
            &mut panel,
            row,
            (0.0, change),
            Style::edged(fill, 0.5).row(at_row),
        );
        at_end(&mut panel, row, change, sum, words(term));
    }
    let chart = Chart {
        title: "Difference of energies, B \u{2212} A".to_owned(),
        subject: format!("A: {}; B: {}", of.a, of.b),
        description: describe(of),
        left: MARGIN,
        panels: vec![panel],
        foot: vec![Block::notes((MARGIN, WIDTH - 40.0), vec![explain(of)])],
        table,
        ..Chart::default()
    };
    chart.picture()
}

fn table() -> PictureTable {
    PictureTable::new(&[
        ("term", ""),
        ("A", "kJ"),
        ("B", "kJ"),
        ("B \u{2212} A", "kJ"),
        ("A", "L/100 km"),
        ("B", "L/100 km"),
        ("B \u{2212} A", "L/100 km"),
    ])
}

/// A plus sign before what is not zero as it is written.
fn signed(text: String, value: f64) -> String {
    if value > 0.0 && text.contains(|c: char| ('1'..='9').contains(&c)) {
        format!("+{text}")
    } else {
        text
    }
}

fn label(kj: f64, litres: f64) -> String {
    let energy = signed(energy(kj), kj);
    if litres.is_finite() {
        format!("{energy}, {} L/100 km", signed(grouped(litres, 3), litres))
    } else {
        energy
    }
}

fn explain(of: &Difference) -> String {
    let (a, b) = of.distance_km;
    let apart = (a - b).abs() > 1e-6 * a.abs().max(b.abs());
    let far = format!(
        " The runs differ in distance, {} and {} km: kJ are those driven, L/100 km take the distance in.",
        grouped(a, 3),
        grouped(b, 3)
    );
    format!(
        "Each term is also given as the fuel with that energy; both columns add up to the difference of fuel.{}",
        if apart { far } else { String::new() }
    )
}

fn describe(of: &Difference) -> String {
    let term = |name: &str, a: f64, b: f64| {
        format!("{name} {}", label(finite(b) - finite(a), of.litres(a, b).2))
    };
    let terms = of.terms.iter().map(|of| term(&of.name, of.a_kj, of.b_kj));
    let mut list: Vec<String> = terms.collect();
    list.push(term("fuel", of.fuel_kj.0, of.fuel_kj.1));
    format!(
        "Difference of run B, {}, to run A, {}, by term: {}.",
        of.b,
        of.a,
        list.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fuel_of_the_terms_adds_up_to_that_of_the_run() {
        let of = Difference {
            fuel_kj_per_l: (32_000.0, 31_500.0),
            distance_km: (11.0, 10.9),
            ..Difference::default()
        };
        let terms = [
            (15_000.0, 14_900.0),
            (-0.8, 0.0),
            (390.0, 520.5),
            (2300.0, 2310.0),
        ];
        let sum: f64 = terms.iter().map(|(a, b)| of.litres(*a, *b).2).sum();
        let (a, b) = (
            terms.iter().map(|t| t.0).sum(),
            terms.iter().map(|t| t.1).sum(),
        );
        assert!((sum - of.litres(a, b).2).abs() < 1e-12);
    }
}
