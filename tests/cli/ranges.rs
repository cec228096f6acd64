//! Values of an option: numbers, lists, ranges.

use super::*;

fn good(text: &str) -> Vec<f64> {
    values("--speed", text, Bound::closed(-100.0, 7000.0), "_rpm")
        .unwrap_or_else(|p| panic!("{text}: {p:?}"))
}

fn bad(text: &str) -> Problems {
    values("--speed", text, Bound::closed(-100.0, 7000.0), "_rpm").expect_err(text)
}

#[test]
fn numbers_lists_and_ranges_mixed() {
    assert_eq!(good("2500"), [2500.0]);
    assert_eq!(good(" 25, 50 ,75"), [25.0, 50.0, 75.0]);
    assert_eq!(good("1000..1500:250"), [1000.0, 1250.0, 1500.0]);
    assert_eq!(good("-10..40:25"), [-10.0, 15.0, 40.0]);
    assert_eq!(good("5,1..3:1,3,7"), [5.0, 1.0, 2.0, 3.0, 7.0]);
    assert_eq!(good("3..3"), [3.0]);
    assert_eq!(good("-0"), [0.0]);
    assert!(good("0,-0").len() == 1);
}

/// By hand: both ends belong to a range, and decimal steps stay decimal.
#[test]
fn val_ends_and_decimals() {
    assert_eq!(good("0..0.3:0.1"), [0.0, 0.1, 0.2, 0.3]);
    assert_eq!(good("1000..2100:500"), [1000.0, 1500.0, 2000.0, 2100.0]);
    assert_eq!(
        good("1000..4000"),
        [1000.0, 1500.0, 2000.0, 2500.0, 3000.0, 3500.0, 4000.0]
    );
    assert_eq!(good("0..100").len(), 11);
    assert_eq!(good("10..12:0.5"), [10.0, 10.5, 11.0, 11.5, 12.0]);
    assert_eq!(good("1e3..3e3:1e3"), [1000.0, 2000.0, 3000.0]);
}

#[test]
fn words_replace_numbers() {
    let words = [("low", 2.4), ("high", 0.4)];
    let found = values_or_words(
        "--ratio",
        "high,1..low:1",
        Bound::closed(0.3, 3.0),
        "",
        &words,
    )
    .expect("words");
    assert_eq!(found, [0.4, 1.0, 2.0, 2.4]);
    let problems =
        values_or_words("--ratio", "lo", Bound::closed(0.3, 3.0), "", &words).expect_err("no word");
    assert!(
        problems[0].allowed.contains("low, high, or 0.3 to 3"),
        "{problems:?}"
    );
}

#[test]
fn every_bad_part_is_reported() {
    assert_eq!(bad("25,x,50,9999").len(), 2);
    for (text, word) in [
        ("", "empty"),
        ("25,", "empty"),
        ("nan", "not a number"),
        ("inf", "not a number"),
        ("5..1:1", "begins above"),
        ("1..5:0", "above zero"),
        ("1..5:-1", "above zero"),
        ("1..5:x", "not a number"),
        ("1..", "not a number"),
        ("..5", "not a number"),
        ("1..2..3", "not a number"),
        ("0..7000:0.001", "7000001 values"),
        ("0..8000:1", "out of range"),
        ("1000-4000", "not a number"),
    ] {
        let problems = bad(text);
        assert!(
            problems[0].message.contains(word),
            "{text}: {:?}",
            problems[0]
        );
        assert_eq!(problems[0].allowed, "-100 to 7000 rpm");
    }
    assert!(
        bad("x")[0].hint.contains("--speed 10..40:5"),
        "{}",
        bad("x")[0].hint
    );
}
