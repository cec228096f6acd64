//! CSV tables that a key names, as data: their columns with ranges, what each gives, and what must hold between rows.

use super::Bound;

/// A table that a key names. Its last columns, those of one group, are its value; the others span a full grid.
#[derive(Clone, Copy, Debug)]
pub struct FileTable {
    /// One word for the kind of table.
    pub kind: &'static str,
    /// All columns that it may have.
    pub columns: &'static [FileColumn],
    /// Group of columns along which the value may not fall.
    pub rises_with: Option<&'static str>,
    /// True if the rows fill a grid.
    pub is_grid: bool,
    /// True if rows of a grid may be missing: the part that reads the table says what is there.
    pub has_holes: bool,
    /// Words of other programs, in lower case and joined by `_`, and the name of a column without its unit.
    pub words: &'static [(&'static str, &'static str)],
}

/// One column of a table.
#[derive(Clone, Copy, Debug)]
pub struct FileColumn {
    /// Name with its unit.
    pub name: &'static str,
    /// Allowed values, in that unit.
    pub range: Bound,
    /// Group of the column; a table has one column of a group.
    pub group: &'static str,
    /// True if a table has to have a column of that group.
    pub required: bool,
    /// Name of the column that gives the same quantity in the program's own unit: in the rows it has that name. Empty for that column itself.
    pub is_like: &'static str,
    /// True of a column that says something of the value, such as its scatter, and spans no axis of a grid.
    pub is_extra: bool,
}

impl FileColumn {
    /// A column that a table has to have, or another one of its group.
    #[must_use]
    pub const fn new(name: &'static str, group: &'static str, range: Bound) -> Self {
        FileColumn {
            name,
            range,
            group,
            required: true,
            is_like: "",
            is_extra: false,
        }
    }

    /// The column, which says something of the value.
    #[must_use]
    pub const fn extra(self) -> Self {
        FileColumn {
            is_extra: true,
            ..self
        }
    }

    /// The same in another unit.
    #[must_use]
    pub const fn in_unit(self, name: &'static str, range: Bound) -> Self {
        FileColumn {
            name,
            range,
            is_like: if self.is_like.is_empty() {
                self.name
            } else {
                self.is_like
            },
            ..self
        }
    }

    /// The column, which a table may be without.
    #[must_use]
    pub const fn or_none(self) -> Self {
        FileColumn {
            required: false,
            ..self
        }
    }
}

impl FileTable {
    /// Group of the columns of which one is the value.
    #[must_use]
    pub fn value_group(&self) -> &'static str {
        self.columns.last().map_or("", |column| column.group)
    }

    /// The columns in words, optional ones in brackets: `speed_kmh, pedal_percent or power_kw, [oil_temp_degc]`.
    #[must_use]
    pub fn words_of_columns(&self) -> String {
        let mut groups: Vec<(&str, String)> = Vec::new();
        for column in self.columns.iter().filter(|own| own.is_like.is_empty()) {
            match groups.iter_mut().find(|(group, _)| *group == column.group) {
                Some((_, words)) => *words += &format!(" or {}", column.name),
                None if column.required => groups.push((column.group, column.name.to_owned())),
                None => groups.push((column.group, format!("where measured {}", column.name))),
            }
        }
        let words: Vec<String> = groups.into_iter().map(|(_, words)| words).collect();
        words.join(", ")
    }
}

/// The rows of a table, in SI units.
#[derive(Clone, Debug, PartialEq)]
pub struct FileRows {
    /// Names of the columns that the file has, in the order of [`FileTable::columns`].
    pub columns: Vec<&'static str>,
    /// A value for each of them.
    pub rows: Vec<Vec<f64>>,
}

impl FileRows {
    /// The column of a name.
    #[must_use]
    pub fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|own| *own == name)
    }

    /// The values of a column, rising, each once; one zero where the file has no such column.
    #[must_use]
    pub fn levels(&self, column: Option<usize>) -> Vec<f64> {
        let Some(column) = column else {
            return vec![0.0];
        };
        let mut levels: Vec<f64> = self.rows.iter().map(|row| row[column]).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by_key(|x| x.to_bits());
        levels
    }
}
