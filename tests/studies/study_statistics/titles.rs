//! Titles of pictures of statistics contain the numbers of the table below the picture.

use super::drawn::{every_plot, sample};
use super::{Outputs, additive};
use crate::titles::{assert_cell, assert_number, number, title, written};
use cvtcycle::report::charts::study::{
    DistributionSeries, KnownValue, Shown, distribution_plot, sobol_plot,
};
use cvtcycle::report::charts::{Picture, PictureTable};
use cvtcycle::study::statistics::{Bootstrap, sobol_indices};

/// Pictures of outputs of the magnitude of fuel whose name has a prefix, with their titles.
fn named(start: &str) -> Vec<(String, Picture)> {
    let of_fuel = |name: &str| name.ends_with(" x1") || name.ends_with(" x-1");
    let all = every_plot().into_iter();
    let own = all.filter(|(name, _)| name.starts_with(start) && of_fuel(name));
    let own: Vec<_> = own
        .map(|(_, picture)| (title(&picture.svg), picture))
        .collect();
    assert!(own.len() >= 2, "{start}");
    own
}

/// Indices of an additive function, with the first factor at 9/14 of the variance.
fn apart() -> (String, Picture) {
    let outputs = Outputs::sobol(&additive(), 1024, 3);
    let names: Vec<String> = ["first", "second", "third", "idle"]
        .map(str::to_owned)
        .into();
    let shown = Shown {
        output: "fuel",
        ..Shown::default()
    };
    let picture = sobol_plot(
        &shown,
        &names,
        &sobol_indices(&outputs.blocks(), Bootstrap::default()),
    );
    (title(&picture.svg), picture)
}

/// Rows sorted by a column in descending order; rows without a number last.
fn ordered(table: &PictureTable, column: usize) -> Vec<&Vec<String>> {
    let mut rows: Vec<&Vec<String>> = table.rows.iter().collect();
    let size = |row: &Vec<String>| {
        let x = number(&row[column]).abs();
        if x.is_nan() { -1.0 } else { x }
    };
    rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
    rows
}

/// True if the title begins with the name, as displayed or as escaped for XML.
fn begins(title: &str, name: &str) -> bool {
    let name = name
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    title.to_lowercase().starts_with(&name.to_lowercase())
}

#[test]
fn sobol_titles_have_the_indices_of_the_table_and_name_a_factor_only_where_it_is_apart() {
    let (mut decided, mut open) = (0, 0);
    for (title, picture) in named("sobol ").into_iter().chain([apart()]) {
        let rows = ordered(&picture.table, 4);
        let apart = number(&rows[0][5]) > number(&rows[1][6]);
        assert_eq!(title.contains(" decides: "), apart, "{title} {rows:?}");
        if !apart {
            assert!(title.contains("single out no factor"), "{title}");
            open += 1;
            continue;
        }
        assert!(begins(&title, &rows[0][0]), "{title}");
        let (own, next) = title
            .split_once(" decides: ")
            .unwrap()
            .1
            .split_once("the next has ")
            .unwrap();
        assert_cell(&written(own)[0], &rows[0][4], &title);
        assert_cell(&written(next)[0], &rows[1][4], &title);
        decided += 1;
    }
    assert!(decided > 0 && open > 0, "{decided} {open}");
}

#[test]
fn rank_titles_have_the_largest_correlation_of_the_table() {
    for (title, picture) in named("ranks ") {
        let rows = ordered(&picture.table, 1);
        let said = title.split("rank correlation ").nth(1).unwrap();
        assert_cell(&written(said)[0], &rows[0][1], &title);
    }
}

#[test]
fn tornado_titles_have_the_ends_of_the_widest_bar() {
    for (title, picture) in named("tornado ") {
        let both = |row: &&Vec<String>| !row[2].is_empty() && !row[4].is_empty();
        let row = picture.table.rows.iter().find(both).unwrap();
        assert!(begins(&title, &row[0]), "{title}");
        let ends = [&row[2], &row[4]];
        let first = usize::from(number(ends[1]) < number(ends[0]));
        let said = written(title.split(" most: ").nth(1).unwrap());
        assert_cell(&said[0], ends[first], &title);
        assert_cell(&said[1], ends[1 - first], &title);
    }
}

#[test]
fn effects_titles_have_the_widest_range_of_means() {
    for (title, picture) in named("effects ") {
        let rows = &picture.table.rows;
        let range = |name: &str| {
            let own = rows.iter().filter(|row| row[0] == name);
            let means: Vec<f64> = own.map(|row| number(&row[2])).collect();
            let low = means.iter().copied().fold(f64::INFINITY, f64::min);
            means.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low
        };
        let widest = rows.iter().map(|row| range(&row[0])).fold(0.0, f64::max);
        let first = &rows[0][0];
        assert!(begins(&title, first), "{title}");
        assert!(
            range(first) >= 0.998 * widest,
            "{} {widest}: {title}",
            range(first)
        );
        let said = written(title.split(" most: by ").nth(1).unwrap());
        let off = (number(&said[0]) - widest).abs();
        assert!(off <= 0.01 * widest, "{} {widest}: {title}", said[0]);
    }
}

/// Truth: the values, drawn again.
#[test]
fn distribution_titles_have_the_counts_and_ends_of_the_values() {
    let draw = |name, values: &[f64], differences| {
        let shown = Shown {
            output: "fuel",
            unit: "%",
            ..Shown::default()
        };
        let known = KnownValue::default();
        let Ok(picture) = distribution_plot(
            &shown,
            &[DistributionSeries {
                name,
                values,
                known,
            }],
            differences,
        );
        title(&picture.svg)
    };
    let values = sample(7, 1000, 0.2, 1.0);
    let above = values.iter().filter(|x| **x > 0.0).count();
    let text = draw("a - b", &values, true);
    let said = written(&text);
    assert_eq!(said[..2], [above.to_string(), "1000".to_owned()], "{text}");
    assert_number(&said[2], 0.1 * above as f64, &text);
    let text = draw("a", &values, false);
    let mut sorted = values;
    sorted.sort_by(f64::total_cmp);
    let said = written(&text);
    assert_eq!(said[0], "90", "{text}");
    // Between the 50th and the 51st value, and between the 950th and the 951st.
    for (said, [low, high]) in said[1..].iter().zip([[49, 50], [949, 950]]) {
        let x = number(said);
        assert!(
            sorted[low] - 0.006 <= x && x <= sorted[high] + 0.006,
            "{text}"
        );
    }
}

#[test]
fn convergence_titles_have_the_last_step_of_the_table() {
    for (title, picture) in named("convergence ") {
        let rows = &picture.table.rows;
        let last = &rows.last().unwrap()[0];
        let own = rows.iter().filter(|row| row[0] == *last);
        let table = PictureTable {
            rows: own.cloned().collect(),
            ..PictureTable::default()
        };
        let largest = ordered(&table, 5)[0];
        let (start, end) = title.split_once(" the total index of ").unwrap();
        assert_cell(&written(start)[0], last, &title);
        assert!(begins(end, &largest[1]), "{title}");
        let said = written(end.split(" is ").last().unwrap());
        for (said, cell) in said.iter().zip(&largest[5..8]) {
            assert_cell(said, cell, &title);
        }
    }
}
