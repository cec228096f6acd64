//! The equations at the heads of the modules, with label, statement and status.
//!
//! `build.rs` reads the heads, so that `explain` and the book of assumptions show what the source has.

/// One line of the head of a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Equation {
    /// Label, such as `SL-3`.
    pub label: &'static str,
    /// Statement.
    pub statement: &'static str,
    /// `source …`, `derived …`, `fitted …` or `ASSUMED …`.
    pub status: &'static str,
    /// Crate and module, such as `model::thermal`.
    pub module: &'static str,
}

/// The equations of the model.
pub const EQUATIONS: &[Equation] = include!(concat!(env!("OUT_DIR"), "/equations.rs"));

#[cfg(test)]
mod tests {
    use super::EQUATIONS;

    #[test]
    fn every_line_has_a_statement_and_a_status() {
        assert!(EQUATIONS.len() > 80, "{}", EQUATIONS.len());
        for equation in EQUATIONS {
            assert!(
                !equation.status.is_empty() && !equation.statement.is_empty(),
                "{equation:?}"
            );
        }
        let find = |label: &str| EQUATIONS.iter().find(|equation| equation.label == label);
        assert!(find("LE-3").is_some_and(|equation| equation.statement.contains("in - out")));
        assert!(find("LE-3").is_some_and(|equation| equation.module.starts_with("model::")));
    }
}
