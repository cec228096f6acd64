//! The values of one file as the parts of the model have read them: parts are built again from them with other numbers, without the document.

use std::borrow::Cow;
use std::cell::Cell;
use std::sync::Arc;

use super::maps::MapTable;
use super::path::join;
use cvtcycle_model::keys::file_table::{FileRows, FileTable};
use cvtcycle_model::keys::{Bound, Key, Kind, Quantity, Values};
use cvtcycle_model::maps::{Basis, BsfcMap, LossMap};
use rustc_hash::FxHashMap;

/// A value that is no single number.
#[derive(Clone, Debug)]
pub(crate) enum Typed {
    Flag(bool),
    Word(&'static str),
    Text(String),
    Texts(Vec<String>),
    Numbers(Vec<f64>),
    Rows(Vec<Vec<f64>>),
    LossMap(Option<LossMap>),
    FileRows(Option<FileRows>),
    BsfcMap(Arc<MapTable>),
}

/// The row of a number: what it may be.
#[derive(Clone, Debug)]
pub(crate) struct NumberRow {
    /// Dotted key in the file.
    pub key: Box<str>,
    pub quantity: Quantity,
    pub range: Bound,
    pub is_whole: bool,
}

impl NumberRow {
    /// A number in the key's unit as its value in SI units; none of a number that the key does not allow.
    pub fn to_si(&self, number: f64) -> Option<f64> {
        let allowed =
            self.range.contains(number) && (!self.is_whole || number.fract().abs() <= 0.0);
        let number = number + 0.0; // no -0
        allowed.then(|| match self.is_whole {
            true => number,
            false => self.quantity.to_si(number),
        })
    }
}

/// Values by their names, in the order of reading.
#[derive(Clone, Debug)]
struct InOrder<T>(Vec<(Name, T)>);

/// The name of a key: most are found by their address, since the rows of the model are statics.
type Name = Cow<'static, str>;

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        InOrder(Vec::new())
    }
}

impl<T> InOrder<T> {
    /// The value of a name. `next` is the place after the last one found: parts read their keys again in the order in which they first read
    /// them, so that most names are found at once.
    #[inline]
    fn find(&self, name: &str, next: &Cell<usize>) -> Option<&T> {
        let index = match self.0.get(next.get()) {
            Some((own, _)) if std::ptr::eq(&**own, name) => next.get(),
            _ => self.0.iter().position(|(own, _)| **own == *name)?,
        };
        next.set(index + 1);
        Some(&self.0[index].1)
    }

    fn get(&self, name: &str) -> Option<&T> {
        let found = self.0.iter().find(|(own, _)| own == name);
        found.map(|(_, value)| value)
    }

    fn push(&mut self, name: Name, value: T) {
        self.0.push((name, value));
    }

    fn set(&mut self, name: Name, value: T) {
        match self.0.iter_mut().find(|(own, _)| *own == name) {
            Some((_, old)) => *old = value,
            None => self.push(name, value),
        }
    }
}

/// A table of the file.
#[derive(Clone, Debug, Default)]
struct Table {
    numbers: InOrder<usize>,
    others: InOrder<Typed>,
    tables: InOrder<usize>,
    /// True where a part takes another form because the file does not have the table.
    is_absent: bool,
    /// Keys on which a part takes another form, and whether the file has them.
    given: Vec<(Box<str>, bool)>,
}

/// All values of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Recorded {
    tables: Vec<Table>,
    /// Indices of the tables by their paths.
    paths: FxHashMap<String, usize>,
    /// In SI units; NaN for what may be absent and is.
    pub numbers: Vec<f64>,
    pub rows: Vec<NumberRow>,
}

impl Recorded {
    /// Adds the table at a path, and those around it.
    pub fn add_table(&mut self, path: &str) -> usize {
        if let Some(known) = self.paths.get(path) {
            return *known;
        }
        let around = match path.rsplit_once('.') {
            Some((around, name)) => Some((self.add_table(around), name)),
            None if path.is_empty() => None,
            None => Some((self.add_table(""), path)),
        };
        let index = self.tables.len();
        self.tables.push(Table::default());
        self.paths.insert(path.to_owned(), index);
        if let Some((around, name)) = around {
            self.tables[around]
                .tables
                .set(name.to_owned().into(), index);
        }
        index
    }

    fn table_mut(&mut self, path: &str) -> &mut Table {
        let index = self.add_table(path);
        &mut self.tables[index]
    }

    /// Records a number in SI units.
    pub fn number(&mut self, path: &str, key: &Key<'static>, si: f64) {
        let table = self.add_table(path);
        let numbers = &mut self.tables[table].numbers;
        if let Some(index) = numbers.get(key.name) {
            self.numbers[*index] = si;
            return;
        }
        numbers.push(key.name.into(), self.numbers.len());
        self.numbers.push(si);
        self.rows.push(NumberRow {
            key: join(path, key.name).into(),
            quantity: key.quantity,
            range: key.range(),
            is_whole: matches!(key.kind, Kind::Integer(..)),
        });
    }

    /// Records a value that is no single number.
    pub fn other(&mut self, path: &str, key: &Key<'static>, value: Typed) {
        let table = self.table_mut(path);
        table.others.set(key.name.into(), value);
    }

    /// Records that a part looked whether there is a table.
    pub fn exists(&mut self, path: &str, exists: bool) {
        self.table_mut(path).is_absent = !exists;
    }

    /// Records that a part looked whether a key is given.
    pub fn given(&mut self, path: &str, key: &str, given: bool) {
        self.table_mut(path).given.push((key.into(), given));
    }

    /// Index of the number of a dotted key; none of what is no number, and of a number whose presence gives a part another form.
    pub fn find(&self, key: &str) -> Option<usize> {
        let (path, name) = key.rsplit_once('.').unwrap_or(("", key));
        let table = &self.tables[*self.paths.get(path)?];
        let index = *table.numbers.get(name)?;
        let decides = |(of, given): &(Box<str>, bool)| **of == *name && !given;
        (!table.is_absent && !table.given.iter().any(decides)).then_some(index)
    }
}

/// A table of recorded values, with numbers in place of those that were read.
pub(crate) struct RecordedTable<'r> {
    recorded: &'r Recorded,
    numbers: &'r [f64],
    table: Option<&'r Table>,
    refused: &'r Cell<bool>,
    /// Places at which the next number, other value and table are looked for.
    next: [Cell<usize>; 3],
}

impl<'r> RecordedTable<'r> {
    /// The file with these numbers. `refused` becomes true when a part complains of a value, or needs one that was not recorded.
    pub fn root(recorded: &'r Recorded, numbers: &'r [f64], refused: &'r Cell<bool>) -> Self {
        RecordedTable {
            recorded,
            numbers,
            table: recorded.tables.first(),
            refused,
            next: Default::default(),
        }
    }

    fn refuse<T>(&self, instead: T) -> T {
        self.refused.set(true);
        instead
    }

    fn other(&self, key: &Key<'_>) -> Option<&'r Typed> {
        self.table?.others.find(key.name, &self.next[1])
    }
}

/// The value of a key where it has that form; a refusal and the last expression otherwise.
macro_rules! other {
    ($self:ident, $key:ident, $form:ident, $value:ident => $result:expr, $instead:expr) => {
        match $self.other($key) {
            Some(Typed::$form($value)) => $result,
            _ => $self.refuse($instead),
        }
    };
}

impl Values for RecordedTable<'_> {
    fn table(&self, name: &str) -> Self {
        let tables = self.table.map(|table| &table.tables);
        let index = tables.and_then(|tables| tables.find(name, &self.next[2]));
        RecordedTable {
            table: index.map(|index| &self.recorded.tables[*index]),
            next: Default::default(),
            ..*self
        }
    }

    fn exists(&self) -> bool {
        match self.table {
            Some(table) => !table.is_absent,
            None => self.refuse(false),
        }
    }

    fn has(&self, key: &Key<'static>) -> bool {
        let given = self.table.and_then(|table| {
            let mut given = table.given.iter();
            given.find(|(name, _)| **name == *key.name)
        });
        match given {
            Some((_, given)) => *given,
            None => self.refuse(false),
        }
    }

    fn number(&self, key: &Key<'static>) -> f64 {
        let numbers = self.table.map(|table| &table.numbers);
        match numbers.and_then(|numbers| numbers.find(key.name, &self.next[0])) {
            Some(index) => self.numbers[*index],
            None => self.refuse(f64::NAN),
        }
    }

    fn number_or(&self, key: &Key<'static>, _: f64) -> f64 {
        self.number(key)
    }

    fn optional(&self, key: &Key<'static>) -> Option<f64> {
        Some(self.number(key)).filter(|x| !x.is_nan())
    }

    fn integer(&self, key: &Key<'static>) -> i64 {
        self.number(key) as i64
    }

    fn flag(&self, key: &Key<'static>) -> bool {
        other!(self, key, Flag, value => *value, false)
    }

    fn text(&self, key: &Key<'static>) -> String {
        other!(self, key, Text, value => value.clone(), String::new())
    }

    fn text_or(&self, key: &Key<'static>, _: &str) -> String {
        self.text(key)
    }

    fn texts(&self, key: &Key<'static>) -> Vec<String> {
        other!(self, key, Texts, value => value.clone(), Vec::new())
    }

    fn word(&self, key: &Key<'static>) -> &'static str {
        other!(self, key, Word, value => value, "")
    }

    fn choose(&self, key: &Key<'static>) -> (&'static str, Self) {
        let option = self.word(key);
        (option, self.table(key.name).table(option))
    }

    fn numbers(&self, key: &Key<'static>) -> Vec<f64> {
        other!(self, key, Numbers, value => value.clone(), Vec::new())
    }

    fn rows(&self, key: &Key<'static>) -> Option<Vec<Vec<f64>>> {
        other!(self, key, Rows, value => Some(value.clone()), None)
    }

    fn loss_map(&self, key: &Key<'static>, _: &'static str) -> Option<LossMap> {
        other!(self, key, LossMap, value => value.clone(), None)
    }

    fn file_table(&self, key: &Key<'static>, _: &'static FileTable) -> Option<FileRows> {
        other!(self, key, FileRows, value => value.clone(), None)
    }

    fn bsfc_map(&self, key: &Key<'static>, basis: &Basis) -> Option<BsfcMap> {
        let Some(Typed::BsfcMap(table)) = self.other(key) else {
            return self.refuse(None);
        };
        let map = table.bsfc_map(basis);
        map.unwrap_or_else(|_| self.refuse(None))
    }

    fn complain(&self, _: &str, _: &str, _: &str, _: &str) {
        self.refused.set(true);
    }
}
