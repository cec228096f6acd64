//! Tables and failures of made-up outcomes.

use cvtcycle::calibrate::outcome::{Direction, Fold, Outcome, Parameter, Residual, SCHEMA, Start};

use super::{date, failures, tables};
use crate::print::Terminal;

#[path = "../fixtures/outcome.rs"]
mod fixtures;
use fixtures::{every, named};

fn printed(outcome: &Outcome) -> String {
    tables::tables(outcome, Terminal::new(clap::ColorChoice::Never).stdout)
}

#[test]
fn every_outcome_is_printed_without_broken_numbers_and_within_its_width() {
    for (name, outcome) in every() {
        let text = printed(&outcome);
        assert!(
            !text.contains("NaN") && !text.contains("inf "),
            "{name}: {text}"
        );
        assert!(text.contains("A fit is no validation"), "{name}");
        if name != "odd" {
            // Columns of numbers cannot be wrapped, so they may exceed the width of prose slightly.
            for line in text.lines().skip(1) {
                assert!(
                    line.chars().count() <= 118,
                    "{name}: {} {line}",
                    line.chars().count()
                );
            }
        }
    }
}

#[test]
fn counts_and_root_mean_squares_are_those_of_the_outcome() {
    for (name, n) in [("nothing", 0), ("one", 1), ("hundred", 100)] {
        let outcome = named(name);
        let text = printed(&outcome);
        let s = if n == 1 { "" } else { "s" };
        assert!(
            text.contains(&format!("fitted to {n} observation{s};")),
            "{text}"
        );
        let line = |begin: &str| {
            text.lines()
                .find(|line| line.trim_start().starts_with(begin))
                .expect("a line")
                .to_owned()
        };
        let figure = |line: &str, begin: &str| {
            line.trim_start()[begin.len()..]
                .split_whitespace()
                .next()
                .unwrap_or("")
                .to_owned()
        };
        let [before, after, left_out] = outcome.rms_sd();
        for (begin, wanted) in [
            ("with the values of the files", before),
            ("fitted ", after),
            ("predicted ", left_out),
        ] {
            let line = line(begin);
            let wanted = wanted.map_or("-".to_owned(), |x| format!("{x:.2}"));
            assert_eq!(figure(&line, begin), wanted, "{line}");
        }
        assert_eq!(text.contains("Largest residuals"), n > 0);
        assert_eq!(text.contains("\nParameters"), n > 0);
    }
}

#[test]
fn the_five_largest_residuals_are_listed_largest_first() {
    let outcome = named("hundred");
    let text = printed(&outcome);
    let section = text
        .split("Largest residuals\n")
        .nth(1)
        .and_then(|rest| rest.split("\n\n").next())
        .expect("a section");
    let found: Vec<f64> = section
        .lines()
        .filter_map(|line| {
            line.split_whitespace()
                .next()
                .filter(|x| x.contains(['+', '-']))?
                .parse()
                .ok()
        })
        .collect();
    let mut wanted: Vec<f64> = outcome.residuals.iter().map(|r| r.after_sd).collect();
    wanted.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
    assert_eq!(found.len(), 5);
    assert!(
        found
            .iter()
            .zip(&wanted)
            .all(|(a, b)| (a - b).abs() <= 0.0051),
        "{found:?} {wanted:?}"
    );
}

#[test]
fn starts_that_ended_elsewhere_are_named() {
    let text = printed(&named("ordinary"));
    assert!(
        text.contains("2 of 4 reached the same smallest sum of squares, 41.000"),
        "{text}"
    );
    assert!(
        text.contains("start 3: sum of squares 44.000; converged")
            && text.contains("start 4: sum of squares -; no answer")
    );
    let bound = text
        .lines()
        .find(|line| line.contains("lubricant.friction.band"))
        .expect("a row");
    assert!(bound.ends_with(" high"), "{bound}");
}

#[test]
fn a_fit_that_failed_says_why() {
    let mut outcome = named("ordinary");
    let clean = |outcome: &mut Outcome| {
        outcome
            .parameters
            .iter_mut()
            .for_each(|p| p.is_dead = false);
        outcome.residuals.iter_mut().for_each(|r| r.doubtful = 0);
    };
    assert_eq!(failures(&outcome).len(), 3, "{:?}", failures(&outcome));
    clean(&mut outcome);
    let at_bound = failures(&outcome);
    assert!(
        at_bound.len() == 1 && at_bound[0].contains("friction.band lies at its high bound"),
        "{at_bound:?}"
    );
    // A coefficient that is found to be 0 is a result.
    for p in outcome
        .parameters
        .iter_mut()
        .filter(|p| p.at_bound.is_some())
    {
        p.value = 0.0;
    }
    assert!(failures(&outcome).is_empty());
    outcome.chi2_probability = Some(1e-6);
    assert!(failures(&outcome)[0].contains("the model does not fit these data"));
    outcome.chi2_probability = Some(0.3);
    (outcome.converged, outcome.end) = (false, "out of evaluations".to_owned());
    assert!(failures(&outcome)[0].contains("out of evaluations"));
    assert!(printed(&outcome).contains("not converged"));
}

#[test]
fn numbers_have_the_digits_that_their_error_leaves() {
    let formatted = |x, error| tables::to_error(x, Some(error));
    assert_eq!(
        [
            formatted(8.298_4, 0.098),
            formatted(14_750.0, 6317.0),
            formatted(0.002_24, 0.000_72)
        ],
        ["8.298", "14750", "0.00224"]
    );
    assert_eq!(
        [
            formatted(0.000_029_8, 0.000_003_4),
            formatted(-0.000_000_5, 0.000_1)
        ],
        ["2.98e-5", "0.00000"]
    );
    assert_eq!(
        (formatted(f64::NAN, 1.0), tables::to_error(0.0, None)),
        ("-".to_owned(), "0".to_owned())
    );
}

#[test]
fn val_known_days() {
    // As printed by `date -u -d @SECONDS +%F`.
    assert_eq!(
        [0, 58, 59].map(date),
        ["1970-01-01", "1970-02-28", "1970-03-01"]
    );
    assert_eq!(
        [11_016, 11_017, 19_782].map(date),
        ["2000-02-29", "2000-03-01", "2024-02-29"]
    );
    assert_eq!([20_819, u64::MAX].map(date), ["2027-01-01", "9999-12-31"]);
}
