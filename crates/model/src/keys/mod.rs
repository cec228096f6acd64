//! Parameters as data: every key of vehicle, lubricant and rig files with unit, range, default and meaning.
//!
//! A part of the model states its keys with `keys!`, one row each, and is built from [`Values`]. TOML
//! reading, `explain`, JSON Schema, overrides, studies and fits use the same rows.
mod allowed;
pub mod file_table;
mod quantity;
mod range;
pub mod spec;

pub use crate::math::{rad_s, rpm};
pub use allowed::count;
pub use quantity::{Quantity, RAD_S, RPM, ZERO_DEGC_K, stem};
pub use range::Bound;

use self::file_table::{FileRows, FileTable};
use crate::maps::{Basis, BsfcMap, LossMap};
use crate::math::Curve;

/// One parameter.
#[derive(Clone, Copy, Debug)]
pub struct Key<'k> {
    /// Name in its table, with the unit as its end.
    pub name: &'k str,
    /// Unit of the value.
    pub quantity: Quantity,
    /// Allowed values.
    pub kind: Kind<'k>,
    /// Requirement, with the value where the key is missing.
    pub presence: Presence<'k>,
    /// Meaning.
    pub doc: &'k str,
    /// Labels of the equations that use it.
    pub labels: &'static [&'static str],
}

/// Allowed values of a key.
#[derive(Clone, Copy, Debug)]
pub enum Kind<'k> {
    /// A number within a range, in the key's unit.
    Number(Bound),
    /// An integer from one number to another; `i64::MAX` is no limit.
    Integer(i64, i64),
    /// True or false.
    Flag,
    /// Any text.
    Text,
    /// The name of a CSV file, whose columns may be named.
    Csv,
    /// One of some words.
    Words(&'k [Choice]),
    /// One of some tables.
    Options(&'k [Choice]),
    /// A list of numbers, each in a range: at least and at most so many.
    Numbers(Bound, usize, usize),
    /// One number, a list or a range `"from..to:step"`.
    Grid(Bound),
    /// A list of texts.
    Texts,
    /// A list of rows.
    Rows(&'k [Column<'k>]),
    /// A list of values of this kind; the text says of what.
    List(&'k Kind<'k>, &'k str),
    /// A text; the function says which ones are known.
    Name(fn() -> String),
    /// A value of any of these kinds.
    Either(&'k [Kind<'k>]),
    /// Anything; the text says what.
    Other(&'k str),
}

/// One option of a choice.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Word in the file.
    pub name: &'static str,
    /// Meaning.
    pub doc: &'static str,
    /// Keys of the table.
    pub table: Table,
}

impl Choice {
    /// An option without keys.
    pub const fn word(name: &'static str, doc: &'static str) -> Self {
        Choice::new(name, doc, Table::EMPTY)
    }

    /// An option with its keys.
    pub const fn new(name: &'static str, doc: &'static str, table: Table) -> Self {
        Choice { name, doc, table }
    }
}

/// One column of a key that holds rows; the unit is the end of its name.
pub type Column<'k> = (&'k str, Bound);

/// Requirement of a key.
#[derive(Clone, Copy, Debug)]
pub enum Presence<'k> {
    /// Always.
    Required,
    /// On the condition stated here.
    RequiredIf(&'k str),
    /// No; without it there is no value.
    Optional,
    /// No; a number in the key's unit without it.
    Number(f64),
    /// No; an integer without it.
    Integer(i64),
    /// No; a truth value without it.
    Flag(bool),
    /// No; a word without it.
    Word(&'k str),
    /// No; the default follows from other values, as stated here.
    Computed(&'k str),
}

/// A table of keys and the tables in it.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// Name in the table around it.
    pub name: &'static str,
    /// Keys in the order of their rows.
    pub keys: &'static [&'static Key<'static>],
    /// Tables in it.
    pub tables: &'static [Table],
    /// How often it occurs.
    pub repeat: Repeat,
}

/// How often a table occurs in the one around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repeat {
    /// Once; keys of an absent table are absent keys.
    Once,
    /// Once or not at all: its keys are required only where it is present.
    Optional,
    /// Any number of times, as `[[name]]`.
    List,
    /// Any number of times under names of the user's, as `[name.NAME]`.
    Named,
}

impl Table {
    /// A table without keys.
    pub const EMPTY: Table = Table {
        name: "",
        keys: &[],
        tables: &[],
        repeat: Repeat::Once,
    };

    /// A file, or a part without keys of its own, of these tables.
    pub const fn from_tables(tables: &'static [Table]) -> Self {
        Table {
            tables,
            ..Table::EMPTY
        }
    }

    /// The table with another number of times.
    pub const fn repeated(self, repeat: Repeat) -> Self {
        Table { repeat, ..self }
    }

    /// Calls `visit` with the dotted path of every key below `path`, those of unchosen options too.
    pub fn walk(&self, path: &str, visit: &mut impl FnMut(String, &'static Key<'static>)) {
        let below = |name: &str| match (path, name) {
            (path, "") => path.to_owned(),
            ("", name) => name.to_owned(),
            _ => format!("{path}.{name}"),
        };
        for key in self.keys {
            visit(below(key.name), key);
            if let Kind::Options(choices) = key.kind {
                for choice in choices {
                    choice
                        .table
                        .walk(&below(&format!("{}.{}", key.name, choice.name)), visit);
                }
            }
        }
        for table in self.tables {
            table.walk(&below(table.name), visit);
        }
    }
}

impl<'k> Key<'k> {
    /// A key with its unit from its name.
    pub const fn new(name: &'k str, spec: (Kind<'k>, Presence<'k>), doc: &'k str) -> Self {
        Key {
            name,
            quantity: Quantity::from_key(name),
            kind: spec.0,
            presence: spec.1,
            doc,
            labels: &[],
        }
    }

    /// The key with the labels of the equations that use it.
    pub const fn in_equations(self, labels: &'static [&'static str]) -> Self {
        Key { labels, ..self }
    }

    /// Meaning and labels as they are printed: "displacement (PU-1, PU-4)".
    pub fn meaning(&self) -> String {
        with_labels(self.doc, self.labels)
    }

    /// The key with the unit of this suffix, which its name does not end in.
    pub const fn in_unit_of(self, suffix: &str) -> Self {
        Key {
            quantity: Quantity::from_key(suffix),
            ..self
        }
    }
}

/// A meaning followed by the labels of its equations in brackets.
pub fn with_labels(doc: &str, labels: &[&str]) -> String {
    match labels {
        [] => doc.to_owned(),
        _ => format!("{doc} ({})", labels.join(", ")),
    }
}

/// A field's name without the mark of a raw identifier.
pub const fn bare(name: &'static str) -> &'static str {
    match name.as_bytes() {
        [b'r', b'#', ..] => name.split_at(2).1,
        _ => name,
    }
}

/// Values of one table of keys. Problems are collected by the implementation; after one a number is NaN.
pub trait Values: Sized {
    /// The table `name` in this one.
    fn table(&self, name: &str) -> Self;

    /// True if the table is present.
    fn exists(&self) -> bool;

    /// True if the key is given.
    fn has(&self, key: &Key<'static>) -> bool;

    /// A number in SI units: the value given or the key's default.
    fn number(&self, key: &Key<'static>) -> f64;

    /// A number in SI units with a computed default in the key's unit.
    fn number_or(&self, key: &Key<'static>, default: f64) -> f64;

    /// A number in SI units that may be absent.
    fn optional(&self, key: &Key<'static>) -> Option<f64>;

    /// An integer; the default also after a problem.
    fn integer(&self, key: &Key<'static>) -> i64;

    /// A truth value; the default also after a problem.
    fn flag(&self, key: &Key<'static>) -> bool;

    /// A text: the value given, or the key's default; empty without one, and after a problem.
    fn text(&self, key: &Key<'static>) -> String;

    /// A text with a default; empty after a problem.
    fn text_or(&self, key: &Key<'static>, default: &str) -> String;

    /// Texts, written as one with commas or as a list; none where the key is absent.
    fn texts(&self, key: &Key<'static>) -> Vec<String>;

    /// One of the key's words.
    fn word(&self, key: &Key<'static>) -> &'static str;

    /// The chosen option of the key, and its table.
    fn choose(&self, key: &Key<'static>) -> (&'static str, Self);

    /// Numbers in SI units; as many as the key allows, NaN after a problem.
    fn numbers(&self, key: &Key<'static>) -> Vec<f64>;

    /// Rows in SI units by column; none after a problem, empty where the key may be absent and is.
    fn rows(&self, key: &Key<'static>) -> Option<Vec<Vec<f64>>>;

    /// A measured loss map from the file that the key names; `first` is the name of its first axis.
    fn loss_map(&self, key: &Key<'static>, first: &'static str) -> Option<LossMap>;

    /// The rows of the CSV table that the key names; none where it is absent and may be, and after a problem.
    fn file_table(&self, key: &Key<'static>, table: &'static FileTable) -> Option<FileRows>;

    /// A map of fuel from the file that the key names, for the engine that was measured; the
    /// caller gives it its friction.
    fn bsfc_map(&self, key: &Key<'static>, basis: &Basis) -> Option<BsfcMap>;

    /// Reports a problem at a key of this table.
    fn complain(&self, key: &str, allowed: &str, message: &str, hint: &str);
}

/// Declares tables of keys: of each a struct of rows, a static with them, and its [`Table`].
///
/// A row is `NAME: SPEC, MEANING, [LABELS];` with a maker of [`spec`](crate::keys::spec) and the labels of the equations that use
/// the key, if any; the unit is the end of the name, or that of a last entry such as `"_degc"`.
///
/// ```
/// cvtcycle_model::keys! {
///     /// Keys of `[oven]`.
///     OVEN: OvenKeys = "oven" [] {
///         temp_degc: or(180.0, number(50.0, 250.0)), "temperature of the air";
///     }
/// }
/// assert_eq!(OVEN.temp_degc.allowed(), "50 to 250 °C");
/// ```
#[macro_export]
macro_rules! keys {
    ($(
        $(#[$meta:meta])*
        $table:ident: $keys:ident = $path:literal [$($inner:expr),* $(,)?] {
            $($name:ident: $spec:expr, $doc:literal $(, [$($label:literal),+])? $(, $unit:literal)?;)*
        }
    )+) => {$(
        $(#[$meta])*
        #[derive(Debug)]
        pub struct $keys {
            $(#[doc = $doc] pub $name: $crate::keys::Key<'static>,)*
        }
        $(#[$meta])*
        pub static $table: $keys = {
            use $crate::keys::spec::*;
            $keys { $($name: $crate::keys::Key::new($crate::keys::bare(stringify!($name)), $spec, $doc)
                $(.in_equations(&[$($label),+]))?$(.in_unit_of($unit))?,)* }
        };
        impl $keys {
            /// The keys as a table of the file.
            pub const TABLE: $crate::keys::Table = $crate::keys::Table {
                name: $path,
                keys: &[$(&$table.$name),*],
                tables: &[$($inner),*],
                repeat: $crate::keys::Repeat::Once,
            };
        }
    )+};
}
pub use keys;

/// A curve from two-column rows; a problem at the key if they do not make one.
pub(crate) fn curve<V: Values>(s: &V, key: &Key<'_>, rows: &[Vec<f64>]) -> Curve {
    let points: Vec<(f64, f64)> = rows.iter().map(|r| (r[0], r[1])).collect();
    Curve::new(&points).unwrap_or_else(|why| {
        s.complain(
            key.name,
            "rows [x, y] with rising x",
            &why,
            "give at least one row; sort them by their first number and remove doubled ones",
        );
        Curve::constant(1.0)
    })
}
