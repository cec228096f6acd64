//! Compares numbers in titles of pictures with those of tables and files.
#![allow(dead_code, reason = "each test crate uses a part of it")]

use std::path::Path;

/// Title and subject of a picture with plain spaces and minus signs, and without thin spaces between groups of digits.
pub fn title(svg: &str) -> String {
    let title = svg.split("<title>").nth(1).unwrap();
    let title = title.split("</title>").next().unwrap();
    plain(title)
}

/// As [`title`], for a file.
pub fn title_of_file(folder: &Path, name: &str) -> String {
    title(&std::fs::read_to_string(folder.join(name)).unwrap())
}

fn plain(text: &str) -> String {
    text.replace('\u{a0}', " ")
        .replace('\u{202f}', "")
        .replace('\u{2212}', "-")
}

/// Numbers of a text as written, with their signs: a sign follows a space or a bracket.
pub fn written(text: &str) -> Vec<String> {
    let part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
    let text = plain(text);
    let words = text
        .split(|c| !part(c))
        .map(|word| word.trim_end_matches('.'));
    let numbers = words.filter(|word| word.parse::<f64>().is_ok());
    numbers.map(str::to_owned).collect()
}

/// Parses a number of a table; NaN for an empty cell.
pub fn number(cell: &str) -> f64 {
    plain(cell)
        .trim_start_matches('+')
        .parse()
        .unwrap_or(f64::NAN)
}

/// Half a unit in the last digit of a number.
fn half(text: &str) -> f64 {
    let decimals = text.split_once('.').map_or(0, |(_, after)| after.len());
    0.500_001 * 10_f64.powi(-i32::try_from(decimals).unwrap())
}

/// Asserts that a number of a title equals one of the data, to half a unit in its last digit.
pub fn assert_number(said: &str, wanted: f64, title: &str) {
    assert!(
        (number(said) - wanted).abs() <= half(said),
        "{said}, not {wanted}: {title}"
    );
}

/// As [`assert_number`], with a cell of a table, which is rounded too.
pub fn assert_cell(said: &str, cell: &str, title: &str) {
    assert!(
        (number(said) - number(cell)).abs() <= half(said) + half(&plain(cell)),
        "{said}, not {cell}: {title}"
    );
}
