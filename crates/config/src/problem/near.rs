//! Names that a mistyped one may have meant.

/// Similarity below which a known name is no plausible reading of the written one.
const MIN_SIMILARITY: f64 = 0.6;

/// Length from which on the first word of a name is taken for it.
const LEAST_WORD: usize = 4;

/// A longer word is no mistyped name and is not compared with names: that takes time with its length.
const MAX_LEN: usize = 200;

/// Similarity of two names, from 0 to 1.
pub(crate) fn similarity(a: &str, b: &str) -> f64 {
    if a.len().max(b.len()) > MAX_LEN {
        return 0.0;
    }
    let edit = strsim::normalized_damerau_levenshtein(a, b);
    // Truncated and extended names ("mass" for "mass_kg") cost many edits; their common start
    // counts only when the similarity is high, since names of one table often begin alike.
    let start = strsim::jaro_winkler(a, b);
    // The first word of a name is enough.
    let is_first_word =
        a.len() >= LEAST_WORD && b.strip_prefix(a).is_some_and(|b| b.starts_with('_'));
    match is_first_word || start > 0.9 {
        true => edit.max(start),
        false => edit,
    }
}

/// True if a similarity is high enough to suggest the name.
pub(crate) fn is_suggestion(similarity: f64) -> bool {
    similarity >= MIN_SIMILARITY
}

/// Up to three of the `known` names that are plausible readings of `wanted`, best first.
pub fn near<'a>(wanted: &str, known: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    if wanted.len() > MAX_LEN {
        return Vec::new();
    }
    let lower = wanted.to_lowercase();
    let mut rated: Vec<(f64, &str)> = known
        .map(|name| (similarity(&lower, &name.to_lowercase()), name))
        .filter(|(rating, _)| is_suggestion(*rating))
        .collect();
    rated.sort_by(|a, b| b.0.total_cmp(&a.0));
    rated.dedup_by(|a, b| a.1 == b.1);
    rated.into_iter().take(3).map(|(_, name)| name).collect()
}

/// "did you mean `a` or `b`?"; none without names.
#[must_use]
pub fn suggestion(names: &[&str]) -> Option<String> {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    (!names.is_empty()).then(|| format!("did you mean {}?", quoted.join(" or ")))
}

/// [`suggestion`] of the known names that are close to `wanted`.
#[must_use]
pub fn did_you_mean<'a>(wanted: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    suggestion(&near(wanted, known.into_iter()))
}

/// "one of a, b, c".
pub(crate) fn one_of(words: &[&str]) -> String {
    format!("one of {}", words.join(", "))
}

/// Question for near names, else the list of what is known.
pub(crate) fn suggest(wanted: &str, known: &[&str]) -> String {
    did_you_mean(wanted, known.iter().copied())
        .unwrap_or_else(|| format!("write {}", one_of(known)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_of_any_length_takes_no_time() {
        let long = "mass_kg".repeat(1 << 20);
        assert!(near(&long, std::iter::repeat_n("mass_kg", 100_000)).is_empty());
        assert!(similarity(&long, "mass_kg") <= 0.0 && similarity("mass_kg", &long) <= 0.0);
    }
}
