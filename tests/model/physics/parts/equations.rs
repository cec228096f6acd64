//! Unit tests of `model::equations`.
use cvtcycle_model::equations::EQUATIONS;

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
