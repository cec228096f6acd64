//! Validation files as read: tolerances, sources and rows.

use super::expr::{Computed, Expr};
use super::rule::{Group, Printed, Verdict, verdict};
use super::source::Source;
use cvtcycle_config::Place;

/// A named tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    /// Name.
    pub name: String,
    /// Width in the unit of the row.
    pub absolute: f64,
    /// Width as a share of the printed number, of each end of a range for itself.
    pub relative: f64,
    /// Unit of `absolute`; `-` for any.
    pub unit: String,
    /// Where the width comes from.
    pub source: String,
}

/// A computed number that supports the reason of a row that differs.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// What it is.
    pub what: String,
    /// Its unit.
    pub unit: String,
    /// How it is computed.
    pub compute: Expr,
}

/// The run whose headline a row is: its fuel over that of a baseline, or its fuel.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Vehicle.
    pub subject: String,
    /// Vehicle that its fuel is compared with; none for the fuel itself.
    pub baseline: Option<String>,
    /// Name of the cycle.
    pub cycle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// `soak` or `warm`.
    pub start: String,
    /// Group of phases; none for the whole cycle.
    pub phase: Option<String>,
}

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct ValidationRow {
    /// Identifier, such as `5.18a`.
    pub id: String,
    /// Place of its expression, or of its identifier.
    pub place: Place,
    /// Place of its identifier.
    pub id_place: Place,
    /// Chapter.
    pub chapter: String,
    /// Page of the book.
    pub mechanism: &'static str,
    /// What is compared.
    pub what: String,
    /// At which condition.
    pub condition: String,
    /// The printed text.
    pub printed_text: String,
    /// Unit of printed and computed numbers.
    pub unit: String,
    /// Kind of the statement: N number, O order or sign, C constant, L quoted from others, X record only, F fleet.
    pub kind: &'static str,
    /// Printed in numbers; none for what cannot be compared.
    pub printed: Option<Printed>,
    /// Name of the tolerance; empty for orders and signs.
    pub tolerance: String,
    /// Its widths below the lower and above the upper printed number, in the unit of the row.
    pub tolerance_widths: [f64; 2],
    /// File and lines that the numbers of a fleet come from.
    pub data: String,
    /// Parameters that were fitted to this number.
    pub fitted_to: Vec<String>,
    /// The run whose headline it is.
    pub about: Option<About>,
    /// Recorded verdict.
    pub recorded: Option<Verdict>,
    /// Why it differs or cannot be compared.
    pub reason: String,
    /// What else a reader should know.
    pub remark: String,
    /// Number behind the reason.
    pub cause: Option<Cause>,
    /// How it is computed, as written.
    pub compute_text: String,
    /// How it is computed.
    pub compute: Option<Expr>,
}

impl ValidationRow {
    /// Whether the row tests the program: computed, no parameter was fitted to it, no constant that the program was given, and able to fail.
    #[must_use]
    pub fn is_held_out(&self) -> bool {
        self.compute.is_some()
            && self.fitted_to.is_empty()
            && self.kind != "C"
            && self.recorded != Some(Verdict::Identity)
    }
}

impl ValidationRow {
    /// Whether a number is another one than the row has, by the rule of its verdict.
    #[must_use]
    pub fn contradicts(&self, computed: f64) -> bool {
        let verdict = |printed| {
            verdict(
                &Computed::Number(computed),
                printed,
                self.tolerance_widths,
                false,
            )
        };
        self.printed.map(verdict) == Some(Verdict::Differs)
    }
}

/// A file of rows.
#[derive(Clone, Debug)]
pub struct RowFile {
    /// Name.
    pub name: String,
    /// Whose numbers its rows have.
    pub group: Group,
    /// Own tolerances, then those of the common file.
    pub tolerances: Vec<Tolerance>,
    /// Own sources, then those of the common file.
    pub sources: Vec<Source>,
    /// Rows in order.
    pub rows: Vec<ValidationRow>,
}
