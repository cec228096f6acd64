//! Values of keys for the cars of a table: one for all, or an expression of the columns of each row.

use cvtcycle_config::setup::catalogue;
use cvtcycle_config::{Input, Override, Problem, Problems, did_you_mean};
use cvtcycle_validate::expr::{Expr, Fault, Gives, Names, Table, compute_row, parse};

use crate::sheet::Sheet;

/// A value of a key.
#[derive(Clone, Debug)]
pub struct Setting {
    /// Dotted key.
    key: String,
    kind: Kind,
}

#[derive(Clone, Debug)]
enum Kind {
    /// The same for all cars.
    Value(Override),
    /// `KEY=`, `KEY*=` or `KEY+=` and what is to follow.
    Expression { before: String, expr: Box<Expr> },
}

impl From<Override> for Setting {
    fn from(value: Override) -> Self {
        Setting {
            key: value.key().to_owned(),
            kind: Kind::Value(value),
        }
    }
}

/// Columns of a table as names of an expression.
struct ColumnNames<'a>(&'a [String]);

impl Names for ColumnNames<'_> {
    fn sources(&self) -> Vec<&str> {
        Vec::new()
    }

    fn columns(&self, _: usize, _: bool) -> Vec<&str> {
        Vec::new()
    }

    fn keys(&self) -> &[String] {
        &[]
    }

    fn row(&self) -> Vec<&str> {
        self.0.iter().map(String::as_str).collect()
    }
}

impl Setting {
    /// Reads `KEY=VALUE`, or `KEY=EXPRESSION` with columns of a table; `KEY*=` and `KEY+=` multiply and add.
    ///
    /// ```
    /// use cvtcycle_fleet::{Setting, Sheet};
    /// let sheet = Sheet::read("cars.csv", b"carid,litres\none,1.5\ntwo,2\n")?;
    /// let set = Setting::read("engine.electrical_w=200 + 100*litres", &sheet.names)?;
    /// assert_eq!(set.in_row(&sheet, 1).unwrap().unwrap().to_string(), "engine.electrical_w=400.0");
    /// assert!(Setting::read("engine.electrical_w=200 + 100*liters", &sheet.names).is_err());
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// A text that is none, an unknown key, an unknown column, and an expression that gives no number.
    pub fn read(text: &str, columns: &[String]) -> Result<Setting, Problem> {
        let (before, value) = text.split_once('=').unwrap_or((text, ""));
        let key = before.trim_end_matches(['*', '+', ' ']).trim();
        let plain = || text.parse::<Override>();
        let is_number = catalogue::known_keys()
            .iter()
            .any(|info| info.key == key && info.is_number);
        let is_literal = value.trim().parse::<f64>().is_ok();
        if value.trim().is_empty() || is_literal || !is_number && !known(key) {
            let value = plain()?;
            return match known(value.key()) {
                true => Ok(value.into()),
                false => Err(unknown_key(text, value.key())),
            };
        }
        match parse(value, &ColumnNames(columns)) {
            Ok(expr) if expr.gives() != Gives::Number => Err(Problem::wrong_type(
                "the expression gives a condition, not a number",
            )
            .at(Input::Override(text.to_owned()))
            .key(key)
            .allowed("numbers, columns of the table, + - * / ^, sqrt, ln, exp, min, max")),
            Ok(expr) if has_column(&expr) => Ok(Setting {
                key: key.to_owned(),
                kind: Kind::Expression {
                    before: before.to_owned(),
                    expr: Box::new(expr),
                },
            }),
            // A sum of numbers is a number.
            Ok(expr) if is_number => {
                let number = compute_row(&expr, &empty(), 0).map_err(Problem::invalid)?;
                Ok(format!("{before}={number:?}").parse::<Override>()?.into())
            }
            // Words of keys that hold words.
            _ if !is_number => Ok(plain()?.into()),
            Ok(_) => Ok(plain()?.into()),
            Err(faults) => Err(wrong(text, key, &faults, columns)),
        }
    }

    /// Reads several.
    ///
    /// # Errors
    /// All problems.
    pub fn read_all<S: AsRef<str>>(
        texts: &[S],
        columns: &[String],
    ) -> Result<Vec<Setting>, Problems> {
        let mut problems = Problems::new();
        let read = |text: &S| problems.take(Setting::read(text.as_ref(), columns));
        let all = texts.iter().filter_map(read).collect();
        problems.finish().map(|()| all)
    }

    /// True for an expression that reads a column, by its index.
    pub(crate) fn reads(&self, column: usize) -> bool {
        match &self.kind {
            Kind::Value(_) => false,
            Kind::Expression { expr, .. } => reads(expr, column),
        }
    }

    /// False for a key of the box that a car does not have, of an expression; a value for all is one that all have.
    pub(crate) fn is_of(&self, is_cvt: bool) -> bool {
        let other = match is_cvt {
            true => "transmission.manual.",
            false => "transmission.cvt.",
        };
        matches!(self.kind, Kind::Value(_)) || !self.key.starts_with(other)
    }

    /// The override of a row, by its index; `None` where a cell that the expression reads is empty.
    ///
    /// # Errors
    /// A sentence on a cell that is no number, or on a result that is none.
    pub fn in_row(&self, sheet: &Sheet, row: usize) -> Result<Option<Override>, String> {
        let (before, expr) = match &self.kind {
            Kind::Value(value) => return Ok(Some(value.clone())),
            Kind::Expression { before, expr } => (before, expr),
        };
        let cells = sheet.rows.get(row).map_or(&[][..], |row| &row.cells);
        let mut numbers = vec![f64::NAN; sheet.names.len()];
        for (k, number) in numbers
            .iter_mut()
            .enumerate()
            .filter(|(k, _)| reads(expr, *k))
        {
            let text = cells.get(k).map_or("", String::as_str);
            if text.is_empty() {
                return Ok(None);
            }
            *number = text.parse().map_err(|_| {
                format!(
                    "{}: `{text}` in the column {} is no number",
                    self.key, sheet.names[k]
                )
            })?;
        }
        let columns = numbers.len();
        let one = Table::new(
            columns,
            Box::new(move |k| vec![numbers[k]]),
            vec![1.0],
            [Vec::new(), Vec::new()],
        );
        let number = compute_row(expr, &one, 0).map_err(|why| format!("{}: {why}", self.key))?;
        let read = format!("{before}={number:?}").parse::<Override>();
        read.map(Some)
            .map_err(|problem| format!("{}: {}", self.key, problem.message))
    }
}

fn empty() -> Table {
    Table::new(
        0,
        Box::new(|_| Vec::new()),
        vec![1.0],
        [Vec::new(), Vec::new()],
    )
}

fn known(key: &str) -> bool {
    let names = catalogue::known_names();
    // A table with another option is chosen by its name.
    let table = format!("{key}.");
    names
        .iter()
        .any(|name| name == key || name.starts_with(&table))
}

fn unknown_key(text: &str, key: &str) -> Problem {
    let names = catalogue::known_names().iter().map(String::as_str);
    Problem::unknown_key(format!("unknown key `{key}`"))
        .at(Input::Override(text.to_owned()))
        .key(key)
        .names_key()
        .hint(
            did_you_mean(key, names)
                .unwrap_or_else(|| "`cvtcycle explain` lists the keys of vehicles".to_owned()),
        )
}

fn wrong(text: &str, key: &str, faults: &[Fault], columns: &[String]) -> Problem {
    let fault = faults.first();
    let message = fault.map_or("this is no expression", |fault| fault.message.as_str());
    let hint = fault.map_or("", |fault| fault.hint.as_str());
    Problem::unknown_name(message)
        .at(Input::Override(text.to_owned()))
        .key(key)
        .allowed(format!(
            "a number, or an expression of the columns {}",
            columns.join(", ")
        ))
        .hint(hint)
}

fn has_column(expr: &Expr) -> bool {
    matches!(expr, Expr::Column(_)) || expr.parts().into_iter().any(has_column)
}

fn reads(expr: &Expr, column: usize) -> bool {
    matches!(expr, Expr::Column(k) if *k == column)
        || expr.parts().into_iter().any(|part| reads(part, column))
}
