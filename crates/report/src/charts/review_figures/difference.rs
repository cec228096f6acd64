//! What changed between two runs, term by term: the terms add up to the difference of fuel.
use super::bar_rows::{
    PITCH, at_end, axis_with_room, bar, label_room, left_for, name, rows_panel, tall,
};
use super::{
    TOP, Term, WIDTH, component_words, energy, grouped, remark, remark_lines, sound, term_fill,
};
use crate::charts::figure::{Figure, INK, QUIET};
use crate::charts::panel::BELOW;
use crate::charts::style::component_fill;
use crate::charts::{Picture, PictureTable, cell};
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
            name: component_words(component),
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

/// A row of the picture.
struct Part {
    name: String,
    paint: String,
    a_kj: f64,
    b_kj: f64,
    sum: bool,
}

impl Difference {
    /// Fuel consumption that stands for an energy in A and one in B, and the difference, L/100 km.
    fn litres(&self, a_kj: f64, b_kj: f64) -> (f64, f64, f64) {
        let a = 100.0 * sound(a_kj) / (self.fuel_kj_per_l.0 * self.distance_km.0);
        let b = 100.0 * sound(b_kj) / (self.fuel_kj_per_l.1 * self.distance_km.1);
        (a, b, b - a)
    }

    fn left_over(&self) -> (f64, f64) {
        let sum = |of: fn(&DifferenceTerm) -> f64| {
            self.terms.iter().map(|term| sound(of(term))).sum::<f64>()
        };
        (
            sound(self.fuel_kj.0) - sum(|term| term.a_kj),
            sound(self.fuel_kj.1) - sum(|term| term.b_kj),
        )
    }
}

/// Difference B - A of every term, in kJ and as the fuel that it stands for in L/100 km, with the difference of fuel at the end.
#[must_use]
pub fn difference_bars(of: &Difference) -> Picture {
    let lines = remark_lines(&explain(of), WIDTH - 40.0);
    let mut rows = of.terms.len();
    let left_over = of.left_over();
    let size_kj = sound(of.fuel_kj.0).abs().max(sound(of.fuel_kj.1).abs());
    let incomplete = left_over.0.abs().max(left_over.1.abs()) > 1e-6 * size_kj;
    rows += 1 + usize::from(incomplete);
    let below = TOP + tall(rows) + BELOW + 8.0;
    let size = (WIDTH, below + 14.0 * lines.len() as f64 + 8.0);
    let subject = format!("A: {}; B: {}", of.a, of.b);
    let mut figure = Figure::new(
        size,
        14.0,
        "Difference of energies, B \u{2212} A",
        &subject,
        &describe(of),
    );
    let parts = parts(&mut figure, of, incomplete.then_some(left_over));
    let changes = parts.iter().map(|part| sound(part.b_kj) - sound(part.a_kj));
    let left = left_for(parts.iter().map(|part| part.name.as_str()));
    let words = |part: &Part| {
        label(
            sound(part.b_kj) - sound(part.a_kj),
            of.litres(part.a_kj, part.b_kj).2,
        )
    };
    let room = label_room(parts.iter().map(words));
    let axis = axis_with_room("B \u{2212} A over the cycle [kJ]", left, changes, room);
    let panel = rows_panel(&mut figure, (left, TOP), rows, axis, true);
    let columns = [
        ("term", ""),
        ("A", "kJ"),
        ("B", "kJ"),
        ("B \u{2212} A", "kJ"),
        ("A", "L/100 km"),
        ("B", "L/100 km"),
        ("B \u{2212} A", "L/100 km"),
    ];
    let mut table = PictureTable::new(&columns);
    table.note = explain(of);
    let zero = panel.px(0.0);
    figure.line(
        (zero, panel.rect.top),
        (zero, panel.rect.bottom),
        &format!("stroke=\"{INK}\" stroke-width=\"4\""),
    );
    for (row, part) in parts.iter().enumerate() {
        let change = sound(part.b_kj) - sound(part.a_kj);
        let (a, b, litres) = of.litres(part.a_kj, part.b_kj);
        let kj = [part.a_kj, part.b_kj, change].map(|kj| cell(kj, 0.01));
        let fuel = [a, b, litres].map(|l| cell(l, 0.0001));
        let at = table.push(
            [part.name.clone()]
                .into_iter()
                .chain(kj)
                .chain(fuel)
                .collect(),
        );
        if part.sum {
            let y = panel.rect.top + 2.0 + PITCH * row as f64;
            figure.line(
                (14.0, y),
                (panel.rect.right, y),
                &format!("stroke=\"{QUIET}\" stroke-width=\"3\""),
            );
        }
        name(&mut figure, &panel, row, &part.name, part.sum);
        bar(&mut figure, &panel, row, (0.0, change), &part.paint, at);
        at_end(
            &mut figure,
            &panel,
            row,
            change,
            part.sum,
            &label(change, litres),
        );
    }
    panel.outline(&mut figure);
    remark(&mut figure, (14.0, below), &lines);
    Picture {
        svg: figure.finish(),
        table,
    }
}

fn parts(figure: &mut Figure, of: &Difference, left_over: Option<(f64, f64)>) -> Vec<Part> {
    let mut parts = Vec::new();
    for term in &of.terms {
        let paint = match term.component {
            Some(component) => component_fill(figure, "difference", component),
            None => term_fill(term.term).to_owned(),
        };
        parts.push(Part {
            name: term.name.clone(),
            paint,
            a_kj: term.a_kj,
            b_kj: term.b_kj,
            sum: false,
        });
    }
    if let Some((a_kj, b_kj)) = left_over {
        let paint = term_fill(Term::Other).to_owned();
        parts.push(Part {
            name: "Not accounted for".to_owned(),
            paint,
            a_kj,
            b_kj,
            sum: false,
        });
    }
    let (a_kj, b_kj) = of.fuel_kj;
    parts.push(Part {
        name: "Fuel: sum of all".to_owned(),
        paint: INK.to_owned(),
        a_kj,
        b_kj,
        sum: true,
    });
    parts
}

/// A plus sign before what is more than nothing as it is written.
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
        "Each term is also told as the fuel whose energy it is; both columns add up to the difference of fuel.{}",
        if apart { far } else { String::new() }
    )
}

fn describe(of: &Difference) -> String {
    let told = |name: &str, a: f64, b: f64| {
        format!("{name} {}", label(sound(b) - sound(a), of.litres(a, b).2))
    };
    let mut list: Vec<String> = of
        .terms
        .iter()
        .map(|term| told(&term.name, term.a_kj, term.b_kj))
        .collect();
    list.push(told("fuel", of.fuel_kj.0, of.fuel_kj.1));
    format!(
        "Difference of run B, {}, to run A, {}, by term: {}.",
        of.b,
        of.a,
        list.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    fn two() -> Difference {
        let mut two = Difference {
            a: "3 mm & <band>".to_owned(),
            b: "2 mm".to_owned(),
            fuel_kj_per_l: (32_000.0, 31_500.0),
            distance_km: (11.0, 10.9),
            terms: vec![
                DifferenceTerm::term("Heat to the engine", Term::EngineHeat, 15_000.0, 14_900.0),
                DifferenceTerm::term("Rotating parts", Term::Kinetic, -0.8, 0.0),
                DifferenceTerm::of(Component::BeltBand, 390.0, 520.5),
                DifferenceTerm::of(Component::BeltWedge, 110.0, 110.0),
                DifferenceTerm::term("Rolling and air", Term::Wheels, 2300.0, 2310.0),
            ],
            ..Difference::default()
        };
        two.fuel_kj = (
            two.terms.iter().map(|t| t.a_kj).sum(),
            two.terms.iter().map(|t| t.b_kj).sum(),
        );
        two
    }

    #[test]
    fn terms_add_up_to_the_difference_of_fuel() {
        let of = two();
        let picture = difference_bars(&of);
        check(&picture);
        let (fuel, terms) = picture.table.rows.split_last().expect("rows");
        for column in 1..7 {
            let sum: f64 = terms.iter().map(|row| numbers(&row[column])).sum();
            assert!(
                (sum - numbers(&fuel[column])).abs() < 0.03,
                "column {column}: {sum} {}",
                fuel[column]
            );
        }
        let (a, b) = (
            of.fuel_kj.0 / 32_000.0 / 11.0 * 100.0,
            of.fuel_kj.1 / 31_500.0 / 10.9 * 100.0,
        );
        assert!((numbers(&fuel[6]) - (b - a)).abs() < 1e-4);
        let exact: f64 = of.terms.iter().map(|t| of.litres(t.a_kj, t.b_kj).2).sum();
        assert!((exact - (b - a)).abs() < 1e-12);
    }

    #[test]
    fn less_goes_left_of_zero_and_more_goes_right() {
        let picture = difference_bars(&two());
        let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
        let edges = |row: &str| {
            let bar = doc
                .descendants()
                .find(|n| {
                    n.attribute("class") == Some("bar") && n.attribute("data-row") == Some(row)
                })
                .expect("a bar");
            let number = |key: &str| {
                bar.attribute(key)
                    .and_then(|x| x.parse::<f64>().ok())
                    .expect("a number")
            };
            (number("x"), number("x") + number("width"))
        };
        let (heat, band) = (edges("0"), edges("2"));
        assert!(
            (heat.1 - band.0).abs() <= 1.0,
            "both begin at zero: {heat:?} {band:?}"
        );
        assert!(((band.1 - band.0) / (heat.1 - heat.0) - 1.305).abs() < 0.01);
        assert!(picture.svg.contains("+130 kJ") || picture.svg.contains("+131 kJ"));
    }

    #[test]
    fn what_is_missing_is_named_and_nothing_is_still_a_picture() {
        let mut of = two();
        of.fuel_kj.1 += 50.0;
        assert!(difference_bars(&of).svg.contains("Not accounted for"));
        assert!(!difference_bars(&two()).svg.contains("Not accounted for"));
        check(&difference_bars(&Difference::default()));
        let same = Difference {
            terms: vec![DifferenceTerm::of(Component::Seal, 5.0, 5.0)],
            fuel_kj: (5.0, 5.0),
            ..two()
        };
        check(&difference_bars(&same));
        let broken = Difference {
            terms: vec![DifferenceTerm::term(
                &"n".repeat(99),
                Term::Other,
                f64::NAN,
                1e9,
            )],
            fuel_kj: (0.0, 1e9),
            ..two()
        };
        check(&difference_bars(&broken));
        let falls = Difference {
            terms: vec![DifferenceTerm::of(Component::Seal, 9.0, 5.0)],
            fuel_kj: (9.0, 5.0),
            ..two()
        };
        check(&difference_bars(&falls));
    }
}
