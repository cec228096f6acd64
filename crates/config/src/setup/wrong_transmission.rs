//! Overrides of keys of the other kind of transmission: one problem each, instead of one for every key of it.

use crate::{Document, Override, Problem, Problems, Reader};

/// The kinds of box with their words.
const BOXES: [(&str, &str); 2] = [("cvt", "CVT"), ("manual", "manual box")];

/// Overrides of keys of a kind of box that the vehicle does not have.
pub(super) fn wrong_keys(document: &Document, set: &[Override], name: &str) -> Problems {
    let reader = Reader::new(document);
    let own = reader.root().table("transmission").names();
    let Some((there, has)) = BOXES.iter().find(|(kind, _)| own.contains(kind)) else {
        return Problems::new();
    };
    let of = |by: &Override| {
        let kind = by.key().strip_prefix("transmission.")?.split('.').next()?;
        let (_, lacks) = BOXES
            .iter()
            .find(|(known, _)| *known == kind && !own.contains(known))?;
        let problem = Problem::wrong_transmission(format!("{name} has a {has} and no {lacks}"))
            .at(by.input())
            .key(by.key())
            .value(by.to_string())
            .allowed(format!("keys of [transmission.{there}]"))
            .hint(format!(
                "set a key of [transmission.{there}], or take another vehicle"
            ));
        Some(problem)
    };
    set.iter().filter_map(of).collect()
}
