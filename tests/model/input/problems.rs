//! Lists of problems.

use cvtcycle_config::{Input, Problem, Problems};

const MAX_DESCRIBED: usize = 1000;

fn file(name: &str) -> Input {
    Input::File(name.into())
}

fn some(count: usize) -> Problems {
    (0..count)
        .map(|_| Problem::invalid("no").in_file("f"))
        .collect()
}

#[test]
fn problems_beyond_some_number_are_counted_together() {
    let mut all = Problems::new();
    all.append(some(MAX_DESCRIBED - 1));
    assert_eq!(all.len(), MAX_DESCRIBED - 1);
    all.append(some(2));
    assert_eq!(all[MAX_DESCRIBED].message, "1 more problem is not shown");
    let mut found = some(3);
    found.push(Problem::more(file("f"), 70));
    all.append(found);
    all.append(Problems::new());
    assert_eq!(
        (all.len(), &all[MAX_DESCRIBED]),
        (MAX_DESCRIBED + 1, &Problem::more(file("f"), 74))
    );
    let shown = |problem: &Problem| problem.not_shown().is_none();
    assert!(all[..MAX_DESCRIBED].iter().all(shown));
    let mut short = some(1);
    short.append(Problem::more(file("g"), 5).into());
    short.append(some(1));
    assert_eq!((short.len(), short[2].not_shown()), (3, Some(5)));
    assert_eq!(short.iter().filter_map(Problem::not_shown).count(), 1);
}

#[test]
fn problems_are_an_error_with_text() {
    let mut problems = some(1);
    problems.push(Problem::missing("no mass").hint("add it"));
    let error: Box<dyn std::error::Error> = Box::new(problems);
    assert_eq!(error.to_string(), "f: no\nno mass (add it)");
}
