//! Terms of the field, and the names of keys, tables, columns and flags that belong to them.

/// A line for each concept: its terms, a colon, the names.
const TERMS: &str = include_str!("terms.txt");

/// Items of a list separated by commas.
fn items(list: &'static str) -> impl Iterator<Item = &'static str> {
    list.split(',').map(str::trim)
}

fn concepts() -> impl Iterator<Item = (&'static str, &'static str)> {
    TERMS.lines().filter_map(|line| line.split_once(':'))
}

/// All terms.
pub fn terms() -> impl Iterator<Item = &'static str> {
    concepts().flat_map(|(terms, _)| items(terms))
}

/// Names that belong to a term; `-` and `_` count as blanks.
pub fn names_of(word: &str) -> Vec<&'static str> {
    let plain = |text: &str| text.to_lowercase().replace(['-', '_'], " ");
    let has = |terms| items(terms).any(|term| plain(term) == plain(word));
    let found = concepts().find(|(terms, _)| has(terms));
    found.map_or_else(Vec::new, |(_, names)| items(names).collect())
}
