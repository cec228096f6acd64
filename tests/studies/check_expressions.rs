//! Expressions of validation rows over a small table; verdicts of computed numbers.

use cvtcycle::calibrate::plan::keys::CALIBRATION;
use cvtcycle::config::bounded::SOURCE_ROWS;
use cvtcycle::config::setup::catalogue;
use cvtcycle::validate::expr::{
    Computed, FUNCTIONS, Fault, Gives, MAX_EVALUATIONS, MAX_TOKENS, REDUCTIONS, compute, parse,
};
use cvtcycle::validate::keys::VALIDATION;
use cvtcycle::validate::{
    COMMON, CandidateVehicle, Printed, Verdict, embedded_rows, judge, read, rule,
};

use crate::small_tables::SmallTables;

/// Two groups with y = 2 x + g, and one row at gross slip.
fn fixed() -> SmallTables {
    let x = [1.0, 2.0, 4.0, 1.0, 2.0, 9.0];
    SmallTables::new(x, [2.0, 4.0, 8.0, 3.0, 5.0, 99.0], 1_000_000)
}

fn evaluate(text: &str) -> Result<Computed, String> {
    let names = fixed();
    let expr = parse(text, &names).map_err(|faults| format!("{faults:?}"))?;
    compute(&expr, &names)
}

fn number(text: &str) -> f64 {
    match evaluate(text) {
        Ok(Computed::Number(x)) => x,
        other => panic!("{text}: {other:?}"),
    }
}

fn truth(text: &str) -> bool {
    match evaluate(text) {
        Ok(Computed::Truth(holds, _)) => holds,
        other => panic!("{text}: {other:?}"),
    }
}

#[test]
fn arithmetic_and_its_order() {
    for (text, want) in [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("2 ^ 3 * 2", 16.0),
        ("-2 ^ 2", -4.0),
        ("--3", 3.0),
        ("10 - 4 - 3", 3.0),
        ("1e3 / 4", 250.0),
        ("max(1, min(5, 3), 2)", 3.0),
        ("abs(-4) + sqrt(9) + tan(45)", 8.0),
        ("key(belt.offset_mm) + key(low: belt.offset_mm, 2)", 5.0),
    ] {
        assert!(
            (number(text) - want).abs() < 1e-12,
            "{text}: {}",
            number(text)
        );
    }
}

#[test]
fn reductions_over_rows() {
    for (text, want) in [
        ("min(low: y)", 2.0),
        ("max(low: y)", 8.0),
        ("mean(low: y)", (2.0 + 4.0 + 16.0 + 3.0 + 5.0) / 6.0),
        ("sum(low: 1)", 6.0),
        ("spread(low: y where g == 1)", 2.0),
        ("first(low: y)", 2.0),
        ("last(low: y)", 5.0),
        ("one(low: y where x == 4)", 8.0),
        ("count(low: y > 3)", 3.0),
        ("share(low: x == 4)", 2.0 / 6.0),
        ("slope(low: y over x where g == 0)", 2.0),
        ("r2(low: y over x where g == 0)", 1.0),
        ("interp(low: y over x at 3 where g == 0)", 6.0),
        ("cross(low: y over x at 6 where g == 0)", 3.0),
        ("max(low: y - prev(y) where g == 0 and x > 1)", 4.0),
        ("total(trip: 2 * fuel)", 13.0),
        ("max(low: y where not g == 0)", 5.0),
    ] {
        assert!(
            (number(text) - want).abs() < 1e-12,
            "{text}: {}",
            number(text)
        );
    }
}

#[test]
fn truths_ranges_and_loops() {
    assert!(truth("3 > 2 > 1") && !truth("3 > 1 > 2"));
    assert!(truth("rising(low: y over x by g)") && !truth("falling(low: y over x by g)"));
    assert!(!truth("rising(low: y over x)") || truth("not 1 > 2"));
    assert!(truth("all(low: y >= 2)") && truth("any(low: y == 8)") && !truth("any(low: y == 99)"));
    assert!(
        truth("each(t in 0, 1: min(low: y where g == t) >= 2)")
            && !truth("each(t in 0, 1: min(low: y where g == t) > 2)")
    );
    assert_eq!(evaluate("range(low: y)"), Ok(Computed::Range(2.0, 8.0)));
    assert_eq!(
        evaluate("span(t in 0, 1: min(low: y where g == t))"),
        Ok(Computed::Range(2.0, 3.0))
    );
    assert_eq!(
        evaluate("max(low: y) > 7"),
        Ok(Computed::Truth(true, "8 > 7".to_owned()))
    );
}

#[test]
fn rows_at_gross_slip_are_left_out_and_counted_once() {
    let names = fixed();
    let count = |text: &str| {
        names.left_out.set(0);
        drop(compute(&parse(text, &names).expect("parses"), &names));
        names.left_out.get()
    };
    assert_eq!(count("max(low: y)"), 1);
    assert_eq!(count("max(low: y where g == 0)"), 0);
    assert_eq!(count("range(low: y)"), 1);
    assert_eq!(count("all(low: y > 0)"), 1);
}

#[test]
fn an_expression_without_a_value_gives_the_reason() {
    for (text, why) in [
        ("one(low: y)", "5 rows where one was expected"),
        ("max(low: y where x > 5)", "no row is left"),
        ("max(low: y where x > 8)", "gross slip"),
        (
            "cross(low: y over x at 50 where g == 0)",
            "does not pass 50",
        ),
        ("interp(low: y over x at 7 where g == 0)", "outside"),
        ("1 / 0", "not a finite number"),
        ("slope(low: y over x where x == 4)", "two different places"),
        ("ln(-1) > 0", "does not exist"),
    ] {
        let said = evaluate(text).expect_err(text);
        assert!(said.contains(why), "{text}: {said}");
    }
}

fn faults(text: &str) -> Vec<Fault> {
    parse(text, &fixed()).expect_err(text)
}

#[test]
fn faults_have_their_place_and_a_hint() {
    let unknown = faults("max(lwo: y) + max(low: z) + min(low: gg)");
    let places: Vec<(usize, &str)> = unknown.iter().map(|f| (f.at, f.word.as_str())).collect();
    assert_eq!(places, [(4, "lwo"), (23, "z"), (37, "gg")]);
    assert!(
        unknown[0].hint.contains("`low`") && unknown[1].hint.contains("known here: x, g, y"),
        "{unknown:?}"
    );
    for (text, message) in [
        ("max(low: y", "expected `)`"),
        ("mean(low y)", "the name of a source"),
        ("y", "outside of any source"),
        ("maxx(low: y)", "not known"),
        ("1 +", "expected a number"),
        ("1 § 2", "no meaning"),
        ("slope(low: y)", "another form"),
        ("2 * range(low: y)", "no part of a larger expression"),
        ("abs(1, 2)", "one argument"),
        ("each(low: y)", "expected `in`"),
        ("1 2", "an operator or the end"),
        ("total(low: y)", "not known"),
        ("key(belt.offst_mm)", "not known"),
    ] {
        let found = faults(text);
        assert!(
            found.iter().any(|f| f.message.contains(message)),
            "{text}: {found:?}"
        );
    }
    assert!(faults(&"(".repeat(500))[0].message.contains("too deep"));
    assert!(parse(&"-".repeat(500), &fixed()).is_err());
}

/// Runs all recursive walks over an expression on a stack of 1 MiB.
fn walked(text: String) -> Result<f64, String> {
    let walk = move || {
        let names = fixed();
        let expr = parse(&text, &names).map_err(|faults| faults[0].message.clone())?;
        assert!(expr.sources().len() < text.len() && expr.clone() == expr);
        Ok(match compute(&expr, &names)? {
            Computed::Number(x) => x,
            Computed::Truth(holds, _) => f64::from(u8::from(holds)),
            Computed::Range(low, _) => low,
        })
    };
    let thread = std::thread::Builder::new().stack_size(1 << 20).spawn(walk);
    thread.unwrap().join().unwrap()
}

#[test]
fn an_expression_of_a_thousand_tokens_is_the_longest() {
    for (begin, sign, want) in [
        ("-", "+", 498.0),
        ("-", "-", -500.0),
        ("-", "*", -1.0),
        ("-", "^", -1.0),
        ("-", "<", 0.0),
        ("not ", " and ", 0.0),
        ("not ", " or ", 1.0),
    ] {
        let longest = begin.to_owned() + &["1"; MAX_TOKENS / 2].join(sign);
        assert_eq!(walked(longest.clone()), Ok(want), "{sign}");
        let why = walked(longest.clone() + sign + "1").expect_err(sign);
        assert!(why.contains("more than 1000 words"), "{sign}: {why}");
        // However long it is, only the first excess token is examined.
        let longer = parse(&longest.repeat(100), &fixed()).expect_err(sign);
        assert!(
            longer.len() == 1 && longer[0].at == longest.len(),
            "{longer:?}"
        );
    }
    let brackets = format!("{}1{}", "(".repeat(39), ")".repeat(39));
    assert_eq!(walked(brackets), Ok(1.0));
    let previous = format!("max(low: {}y{})", "prev(".repeat(38), ")".repeat(38));
    assert!(walked(previous).is_err_and(|why| why.contains("no number")));
}

#[test]
fn nested_loops_and_reductions_end_with_the_evaluations() {
    let sums = (0..9).fold("y".to_owned(), |inner, _| format!("sum(low: {inner})"));
    let nested = |kind: &str, depth: usize, innermost: &str| {
        (0..depth).fold(innermost.to_owned(), |inner, k| {
            format!("{kind}(a{k} in 0,1,2,3,4,5,6,7,8,9: {inner})")
        })
    };
    for text in [
        sums.clone(),
        format!("{sums} > 0"),
        nested("each", 30, "1 == 1"),
        format!("span(b in 0, 1: {})", nested("each", 29, "b < 2")),
        format!("min(low: {})", nested("each", 30, "y > 0")),
    ] {
        assert_eq!(
            evaluate(&text),
            Err("no evaluations are left".to_owned()),
            "{text}"
        );
    }
    // Three levels are cheap, but not all of their numbers are listed.
    match evaluate(&nested("each", 3, "a0 + a1 + a2 < 100")) {
        Ok(Computed::Truth(true, behind)) => assert!(
            behind.starts_with("0: 0: 0: 0 < 100; 1: 1 < 100")
                && behind.ends_with("...")
                && behind.len() < 5000,
            "{behind}"
        ),
        other => panic!("{other:?}"),
    }
}

/// Number of evaluations of an expression.
fn spent(text: &str) -> u64 {
    let names = fixed();
    let before = names.left.get();
    let expr = parse(text, &names).expect(text);
    assert!(compute(&expr, &names).is_ok(), "{text}");
    before - names.left.get()
}

/// By hand: a part counts one evaluation, a row one, finding a table or a key eight, sorting n rows n log2 n, rounded down.
#[test]
fn evaluations_count_the_work() {
    for (text, evaluations) in [
        ("1", 1),
        ("1 + 2 * 3", 5),
        ("key(belt.offset_mm)", 1 + 8),
        // Five of six rows have a value: the last is at gross slip.
        ("max(low: 1)", 1 + 8 + 6 + 5),
        ("max(low: y where g == 0)", 1 + 8 + 6 + 6 * 3 + 3),
        ("slope(low: y over x)", 1 + 8 + 6 + 5 * 2 + 5 * 2),
        (
            "interp(low: y over x at 3 where g == 0)",
            1 + 8 + 6 + 6 * 3 + 3 * 2 + 1 + 3,
        ),
        // Twice: for the truth value, and for the listed numbers.
        ("1 < 2", 3 + 2),
        ("all(low: y > 0)", (1 + 8 + 6 + 5 * 3) + (8 + 6 + 5 * 3)),
    ] {
        assert_eq!(spent(text), evaluations, "{text}");
    }
}

/// The list of numbers has room for less than 500 of `a: n < 100`; the others are not computed again.
#[test]
fn numbers_that_are_not_listed_are_not_computed() {
    let digits = "0,1,2,3,4,5,6,7,8,9";
    let body = (0..4).fold("a0 + a1 < 100".to_owned(), |body, k| {
        format!("each(a{k} in {digits}: {body})")
    });
    // A loop counts one evaluation, and each of its ten numbers one more than the body; the innermost body has five.
    let truth = (0..4).fold(5, |inner, _| 1 + 10 * (1 + inner));
    let all = spent(&body);
    assert!(
        all > truth && all < truth + 500 * 5,
        "{all}, of these {truth}"
    );
}

/// The limit is 500 000 rows.
#[test]
fn the_sources_of_a_shipped_file_have_less_than_half_of_the_rows_that_are_allowed() {
    let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
    let texts: Vec<_> = embedded_rows().iter().map(owned).collect();
    for file in read(COMMON, &texts).unwrap() {
        let rows: usize = file.sources.iter().map(|source| source.rows()).sum();
        assert!(rows < SOURCE_ROWS / 2, "{}: {rows}", file.name);
    }
}

#[test]
fn the_shipped_rows_take_less_than_a_third_of_the_evaluations() {
    let owned = |(name, text): &(&str, &str)| ((*name).to_owned(), (*text).to_owned());
    let texts: Vec<_> = embedded_rows().iter().map(owned).collect();
    let candidate = CandidateVehicle {
        vehicle: "rover_216_cvt".to_owned(),
        ..CandidateVehicle::default()
    };
    let report = judge(&read(COMMON, &texts).unwrap(), &candidate, |_| true).unwrap();
    let taken = report.evaluations;
    assert!(taken > 0 && taken < MAX_EVALUATIONS / 3, "{taken}");
}

#[test]
fn a_total_gives_what_its_value_gives() {
    let names = fixed();
    assert_eq!(
        parse("total(trip: fuel)", &names).map(|e| e.gives()),
        Ok(Gives::Number)
    );
    assert_eq!(
        parse("total(trip: fuel) > 1", &names).map(|e| e.gives()),
        Ok(Gives::Truth)
    );
}

#[test]
fn the_page_names_every_function_and_reduction() {
    let page = include_str!("../../docs/validation_format.md");
    let names = FUNCTIONS.iter().map(|f| f.name);
    for name in names.chain(REDUCTIONS.iter().map(|r| r.name)) {
        let word = |c: char| !c.is_ascii_alphanumeric() && c != '_';
        assert!(page.split(word).any(|found| found == name), "{name}");
    }
}

#[test]
fn the_pages_name_every_key() {
    let rows = include_str!("../../docs/validation_format.md");
    let calibrations = include_str!("../../docs/calibration.md");
    let both = [rows, calibrations].concat();
    for (page, keys) in [(rows, VALIDATION), (&*both, CALIBRATION)] {
        for info in catalogue::keys_of(&keys) {
            let name = info.key.rsplit('.').next().unwrap_or_default();
            assert!(page.contains(name) && !info.doc.is_empty(), "{}", info.key);
        }
    }
}

/// By hand: 8.5 to 13 with 0.5 on both sides.
#[test]
fn distance_in_widths() {
    let off = |computed: Computed| rule::off(&computed, Printed::Range(8.5, 13.0), [0.5, 0.5]);
    assert_eq!(off(Computed::Number(10.0)), Some(0.0));
    assert_eq!(off(Computed::Number(8.25)), Some(0.5));
    assert_eq!(off(Computed::Number(14.0)), Some(2.0));
    assert_eq!(off(Computed::Range(8.0, 13.25)), Some(1.0));
    assert_eq!(off(Computed::Truth(true, String::new())), None);
}

#[test]
fn numbers_ranges_and_truths() {
    let v =
        |computed: Computed, printed, fitted| rule::verdict(&computed, printed, [0.5; 2], fitted);
    let printed = Printed::Range(8.5, 13.0);
    assert_eq!(v(Computed::Number(8.0), printed, false), Verdict::Agrees);
    assert_eq!(v(Computed::Number(7.99), printed, false), Verdict::Differs);
    assert_eq!(
        v(Computed::Range(8.2, 13.4), printed, false),
        Verdict::Agrees
    );
    assert_eq!(
        v(Computed::Range(8.2, 13.6), printed, false),
        Verdict::Differs
    );
    assert_eq!(
        v(Computed::Range(7.9, 13.0), printed, true),
        Verdict::Differs
    );
    assert_eq!(v(Computed::Range(9.0, 13.0), printed, true), Verdict::Fit);
    assert_eq!(
        v(
            Computed::Number(1e9),
            Printed::Range(3.0, f64::INFINITY),
            false
        ),
        Verdict::Agrees
    );
    assert_eq!(
        v(Computed::Number(f64::NAN), printed, false),
        Verdict::Differs
    );
    assert_eq!(
        v(
            Computed::Truth(true, String::new()),
            Printed::Truth(true),
            true
        ),
        Verdict::Fit
    );
    assert_eq!(
        v(
            Computed::Truth(false, String::new()),
            Printed::Truth(true),
            false
        ),
        Verdict::Differs
    );
    assert_eq!(
        v(
            Computed::Truth(false, String::new()),
            Printed::Truth(false),
            false
        ),
        Verdict::Agrees
    );
}
