//! Tables of `docs/results.md`.

#[path = "../../examples/results/tables.rs"]
mod tables;

/// Truth: the program. Every table is computed again, and every cell equals the printed one.
#[test]
fn the_page_of_results_has_the_numbers_of_the_program() {
    let page = include_str!("../../docs/results.md");
    let made = tables::filled(page).unwrap();
    for (printed, made) in page.lines().zip(made.lines()) {
        assert_eq!(
            printed, made,
            "`cargo run --release --example results` writes the page"
        );
    }
    assert_eq!(page.lines().count(), made.lines().count());
}
