//! Entries of a document that no reading asked for: what their keys most likely mean.
use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::document::target::rows_of;
use crate::document::{Document, Entry, Span, Table, Value};
use crate::problem::Problem;
use crate::problem::near::{is_suggestion, similarity, suggestion};
use crate::reader::log::Log;
use crate::reader::path::{join, last, parent};
use cvtcycle_model::files::VEHICLE;
use cvtcycle_model::keys::{Quantity, stem};

/// Similarity above which a name in another table may be what was meant: short names of all tables are like each other.
const ELSEWHERE: f64 = 0.75;

/// Ends of keys and tables of earlier versions, and what to do instead.
const REPLACED: [(&str, &str); 16] = [
    (
        "engine.friction.temperature_exponent",
        "remove it: friction in the cold follows the oil's viscosity, with `viscous_share` and `viscous_exponent` (EN-2)",
    ),
    (
        "transmission.cvt.pressure.floor_bar",
        "write `control_bar`, the pressure that the valves need; clutch, belt and shifts have keys of their own (PC-5)",
    ),
    ("friction.band_floor", WITHOUT_BOUNDS),
    ("friction.band_ceiling", WITHOUT_BOUNDS),
    ("final_drive.boundary_nm", BY_PRELOAD),
    ("final_drive.boundary_rpm", BY_PRELOAD),
    ("final_drive.viscous_nm", BY_BEARINGS),
    ("final_drive.viscous_exponent", BY_BEARINGS),
    (
        "final_drive.film_heating_w",
        "write `bearing_heating_w`, the dissipation of one bearing that halves its torque (BR-1, FH-1)",
    ),
    ("final_drive.mesh_efficiency", BY_TEETH),
    (
        "transmission.manual.reference_mm2_s",
        "remove it: losses follow the viscosity of the oil itself (MB-1 to MB-4)",
    ),
    ("transmission.manual.mesh", BY_TEETH),
    ("transmission.manual.seal", BY_GEARS),
    ("transmission.manual.bearing", BY_GEARS),
    ("transmission.manual.churning", BY_GEARS),
    (
        "friction.lift_off",
        "write `[friction.film]`: `half_n_per_m`, `exponent`, `half_thickness_um` and `film_heating_w` in place of `reduction`, `load_n_per_m` and `film_thickness_um` (LU-5, FI-2)",
    ),
];

/// Successor of the part of the final drive's loss that fell with speed.
const BY_PRELOAD: &str =
    "give the preload in the rows of `bearings`, with `preload_factor` on all of them (BR-2)";

/// Successor of the viscous part of that loss.
const BY_BEARINGS: &str =
    "give the rows of `bearings`, with `bearing_factor` on their torque without load (BR-1)";

/// Successor of efficiencies.
const BY_TEETH: &str = "give the wheels as the rows of `stages`; `oil_factor` acts on the friction of their teeth (GM-1, GM-2)";

/// Successor of the torques of a manual box.
const BY_GEARS: &str = "give `[transmission.manual.gears]` with `stages`, `bearings`, `churners` and `seals` (MB-1 to MB-4)";

/// Successor of the bounds of band friction.
const WITHOUT_BOUNDS: &str =
    "remove it: band friction follows `band_rise_per_k` at any temperature, without bounds (LU-4)";

/// Table whose keys of bands and segments a chain has not.
pub(crate) const BELT: &str = "transmission.cvt.belt.";

impl Log {
    /// The problem of an entry that was not read, and the known key it most likely means.
    pub fn unknown(
        &self,
        document: &Document,
        path: &str,
        entry: &Entry,
    ) -> (Problem, Option<String>) {
        let is_table =
            matches!(&entry.node.value, Value::Table(table) if table.wrapped().is_none());
        let span = if is_table {
            &entry.node.span
        } else {
            &entry.key
        };
        let mut problem = Problem::unknown_key(format!(
            "unknown {} `{path}`",
            if is_table { "table" } else { "key" }
        ))
        .at(document.place(span))
        .key(path)
        .names_key()
        .value(if is_table {
            String::new()
        } else {
            document.shown(&entry.node.span)
        });
        if self.tables.contains(path) {
            if let Value::Table(Table {
                choice: Some(word), ..
            }) = &entry.node.value
            {
                (problem.place, problem.value) =
                    (document.place(&word.span), document.shown(&word.span));
            }
            problem.message = format!("`{path}` is a table, not a value");
            return (problem, None);
        }
        let replaced = |key: &str| path.ends_with(key) || parent(path).ends_with(key);
        if let Some((_, instead)) = REPLACED.iter().find(|(key, _)| replaced(key)) {
            problem.hint = (*instead).to_string();
            return (problem, None);
        }
        if path.starts_with(BELT) && is_row(path) {
            problem.message = format!("`{path}` is of a pushing belt, and this car has a chain");
            problem.hint = "remove it, or set transmission.cvt.belt.kind = \"push_belt\" with all keys of a belt".to_owned();
            return (problem, None);
        }
        if let Some(known) = self.other_unit(path, span) {
            let (unit, shown) = (Quantity::from_key(known).unit(), shown(path, known, span));
            problem.message = match Quantity::from_key(last(path)).unit() {
                "-" => format!("no unit: `{path}` is not known, `{shown}` is"),
                _ => format!("wrong unit: `{path}` is not known, `{shown}` is"),
            };
            problem.hint = match unit {
                "-" => format!("write `{shown}`, which has no unit"),
                unit => format!("give the value in {unit} as `{shown}`"),
            };
            return (problem, Some(known.to_string()));
        }
        let names = self.nearest(path);
        let meant = names
            .first()
            .filter(|name| span.is_set() || parent(name) == parent(path));
        let shown: Vec<&str> = names.iter().map(|name| shown(path, name, span)).collect();
        problem = problem.suggest(&shown);
        problem.hint = if names.is_empty() {
            self.neighbours(path)
        } else {
            suggestion(&shown).unwrap_or_default()
        };
        (problem, meant.map(|name| (*name).to_string()))
    }

    fn known(&self) -> impl Iterator<Item = &str> {
        self.keys
            .iter()
            .map(|info| info.key.as_str())
            .chain(self.tables.iter().map(String::as_str))
    }

    /// The known key for the same quantity in another unit; assignments may name the wrong table too.
    fn other_unit(&self, path: &str, span: &Span) -> Option<&str> {
        let same = |key: &&str| {
            stem(last(key)) == stem(last(path)) && (span.is_set() || parent(key) == parent(path))
        };
        let keys = || self.keys.iter().map(|info| info.key.as_str());
        let misplaced = keys().any(|key| last(key) == last(path));
        keys()
            .filter(|_| !misplaced)
            .filter(same)
            .max_by(|a, b| similarity(a, path).total_cmp(&similarity(b, path)))
    }

    /// Up to three known paths like this one. The last names decide, whole paths only between equals:
    /// paths share long beginnings, which say nothing about the slip.
    fn nearest(&self, path: &str) -> Vec<&str> {
        let lower = path.to_lowercase();
        let mut rated: Vec<(f64, f64, &str)> = self
            .known()
            .map(|known| {
                (
                    similarity(last(known), last(&lower)),
                    similarity(known, &lower),
                    known,
                )
            })
            .filter(|(own, _, known)| {
                is_suggestion(*own)
                    && *known != path
                    && (parent(known) == parent(path) || *own > ELSEWHERE)
            })
            .collect();
        rated.sort_by(|a, b| b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1)));
        rated
            .into_iter()
            .take(3)
            .map(|(_, _, known)| known)
            .collect()
    }

    /// Known names in the table of an entry that is similar to none.
    fn neighbours(&self, path: &str) -> String {
        let names: BTreeSet<&str> = self
            .known()
            .filter(|known| parent(known) == parent(path))
            .map(last)
            .collect();
        if names.is_empty() || names.len() > 12 {
            return "remove it".to_string();
        }
        let names: Vec<&str> = names.into_iter().collect();
        format!("remove it; known here: {}", names.join(", "))
    }
}

/// True if a vehicle file may have this key or table, whatever options it chooses.
pub(crate) fn is_row(path: &str) -> bool {
    static ROWS: OnceLock<BTreeSet<String>> = OnceLock::new();
    let rows = ROWS.get_or_init(|| {
        let rows = rows_of("", &VEHICLE).into_iter();
        rows.map(|(path, _)| path).collect()
    });
    let table = format!("{path}.");
    let mut below = rows.range(table.clone()..);
    rows.contains(path) || below.next().is_some_and(|key| key.starts_with(&table))
}

/// Collects the entries that were not read; an unknown table counts as one entry.
pub(crate) fn unread<'t>(
    log: &Log,
    table: &'t Table,
    path: &str,
    unknown: &mut Vec<(String, &'t Entry)>,
) {
    for (name, entry) in table.entries.iter() {
        let path = join(path, name);
        if log.read.contains(&path) {
            continue;
        }
        match &entry.node.value {
            Value::Table(inner) if log.tables.contains(&path) => {
                if inner.choice.is_some() && !log.choices.contains(&path) {
                    unknown.push((path.clone(), entry));
                }
                unread(log, inner, &path, unknown);
            }
            // An assignment makes its tables itself: the user wrote the whole path.
            Value::Table(inner)
                if entry.node.span.is_set()
                    && inner.wrapped().is_none()
                    && !inner.entries.is_empty() =>
            {
                unread(log, inner, &path, unknown);
            }
            _ => unknown.push((path, entry)),
        }
    }
}

/// A known path as the user should write it: the bare name within the same table of a file.
fn shown<'k>(path: &str, known: &'k str, span: &Span) -> &'k str {
    if !span.is_set() && parent(path) == parent(known) {
        last(known)
    } else {
        known
    }
}
