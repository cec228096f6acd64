//! The vehicle file of an operating line: like the car, with what its reading changed, and with the line.

use cvtcycle_config::setup::{Options, Setup};
use cvtcycle_config::{Acts, Override, Target};
use toml_edit::{Array, DocumentMut, Item, Table, Value};

use super::line::Line;

/// Where the ratio control has its keys.
const RATIO: [&str; 3] = ["transmission", "cvt", "ratio"];

/// A car that a file is to describe.
#[derive(Clone, Copy)]
pub struct LineFile<'a> {
    /// First lines, each a comment.
    pub head: &'a str,
    /// Title of the car.
    pub title: &'a str,
    /// The car as it is.
    pub car: &'a Setup,
    /// Where it comes from.
    pub read: &'a ReadFrom<'a>,
}

/// Where a car comes from.
#[derive(Clone, Copy)]
pub struct ReadFrom<'a> {
    /// Name or path of its vehicle.
    pub vehicle: &'a str,
    /// What it was read with.
    pub options: &'a Options,
    /// How the written file names a vehicle or a fluid that a name or a path has here.
    pub named: &'a dyn Fn(&str) -> String,
}

/// What has to be given again when the file is read, as the options of a reading: values of a fluid and the reading of the belt model, which a
/// vehicle file does not have.
pub fn again(options: &Options) -> Options {
    let of_fluid = |by: &&Override| by.target() != Target::Vehicle;
    Options {
        set: options.set.iter().filter(of_fluid).cloned().collect(),
        lubricant: None,
        engine_oil: None,
        ..options.clone()
    }
}

impl LineFile<'_> {
    /// The text of the file, which names other files as `named` says; none where an override cannot be written into it.
    pub fn text(&self, line: &Line, named: &dyn Fn(&str) -> String) -> Option<String> {
        let mut file = DocumentMut::new();
        let root = file.as_table_mut();
        put(root, &["vehicle", "title"], self.title.into())?;
        put(root, &["vehicle", "like"], named(self.read.vehicle).into())?;
        let options = self.read.options;
        for by in options
            .set
            .iter()
            .filter(|by| by.target() == Target::Vehicle)
        {
            let path: Vec<&str> = by.key().split('.').map(str::trim).collect();
            put(root, &path, self.value_of(by)?)?;
        }
        let oils = [
            ("transmission_oil", &options.lubricant),
            ("engine_oil", &options.engine_oil),
        ];
        for (key, word) in oils {
            if let Some(word) = word {
                put(root, &["vehicle", key], named(word).into())?;
            }
        }
        for (key, value) in line.values() {
            put(root, &[RATIO[0], RATIO[1], RATIO[2], key], value)?;
        }
        Some(format!("{}\n{file}", self.head))
    }

    /// The value that an override leaves in the car.
    fn value_of(&self, by: &Override) -> Option<Value> {
        let text = match by.acts() {
            Acts::Value => by.value(),
            _ => {
                &self
                    .car
                    .keys
                    .iter()
                    .find(|info| info.key == by.key())?
                    .value
            }
        };
        Some(text.parse().unwrap_or_else(|_| text.into()))
    }
}

impl Line {
    /// Keys of the ratio control and their values: the line, followed at once and in a cold car too.
    fn values(&self) -> [(&'static str, Value); 5] {
        let rows = |points: &[(f64, f64)]| {
            let row = |(x, n): &(f64, f64)| Array::from_iter([*x, *n]);
            Value::from(Array::from_iter(points.iter().map(row)))
        };
        [
            ("filter_s", 0.0.into()),
            ("hysteresis", 0.0.into()),
            ("cold_rise_rpm", 0.0.into()),
            ("drive_line", rows(&self.drive)),
            ("overrun_line", rows(&self.overrun)),
        ]
    }
}

/// Puts a value at a path; none where something on the way is no table.
fn put(table: &mut Table, path: &[&str], value: Value) -> Option<()> {
    let (name, rest) = path.split_first()?;
    if rest.is_empty() {
        table.insert(name, Item::Value(value));
        return Some(());
    }
    let inner = table.entry(name).or_insert_with(|| {
        let mut inner = Table::new();
        inner.set_implicit(true);
        Item::Table(inner)
    });
    put(inner.as_table_mut()?, rest, value)
}
