//! Overrides of keys of the other kind of transmission: one problem each, instead of one for every key of it.

use crate::{Document, Problem, Problems, Reader};

/// Overrides of keys of a kind of box that the vehicle does not have.
pub(super) fn wrong_transmission_keys(
    document: &Document,
    sets: &[String],
    name: &str,
) -> Problems {
    let reader = Reader::new(document);
    let own = reader.root().table("transmission").names();
    let problem = |set: &String, there: &str, asked: &str| {
        let (has, lacks) = (box_word(there), box_word(asked));
        Problem::wrong_transmission(format!("{name} has a {has} and no {lacks}"))
            .in_file(format!("--set {set}"))
            .key(set.split('=').next().unwrap_or_default().trim())
            .value(set.clone())
            .allowed(format!("keys of [transmission.{there}]"))
            .hint(format!(
                "set a key of [transmission.{there}], or take another vehicle"
            ))
    };
    let of = |set: &String| {
        let kind = set
            .trim()
            .strip_prefix("transmission.")?
            .split('.')
            .next()?;
        let there = own.iter().find(|there| BOXES.contains(there))?;
        (BOXES.contains(&kind) && !own.contains(&kind)).then(|| problem(set, there, kind))
    };
    sets.iter().filter_map(of).collect()
}

const BOXES: [&str; 2] = ["cvt", "manual"];

fn box_word(kind: &str) -> &'static str {
    if kind == "cvt" { "CVT" } else { "manual box" }
}

#[cfg(test)]
mod tests {
    use crate::setup::{Options, load};

    #[test]
    fn a_manual_car_has_no_belt() {
        let set = vec!["transmission.cvt.belt.band_offset_mm=2".to_owned()];
        let problems = load(
            "rover_216_5mt",
            "--vehicle",
            &Options {
                set,
                ..Options::default()
            },
        )
        .unwrap_err();
        assert_eq!(problems.len(), 1, "{problems:?}");
        assert!(
            problems[0].message.contains("manual box and no CVT"),
            "{problems:?}"
        );
        let set = vec!["transmission.manual.mesh_efficiency=0.9".to_owned()];
        assert_eq!(
            load(
                "rover_216_cvt",
                "--vehicle",
                &Options {
                    set,
                    ..Options::default()
                }
            )
            .unwrap_err()
            .len(),
            1
        );
    }
}
