//! The channels that are meant: by the names of the file where these say all, or by the user.

use super::sheet::{Sheet, is_missing, number, unit_in};
use super::stamp::Form;
use crate::channel::{Quantity, Unit, is_identity};
use crate::csv::{Columns, Entry};
use crate::{Argument, Problem, near, suggestion};

/// How the cells of a channel are read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Reading {
    Number(Unit),
    Stamp(Form),
    Word,
}

/// Column of a channel.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub quantity: Quantity,
    pub column: usize,
    pub reading: Reading,
    /// Only rows in which this other column has this value, in a table of names and values.
    pub only: Option<(usize, String)>,
}

/// Channels that are read.
#[derive(Debug, Default)]
pub(super) struct Chosen {
    pub times: Vec<Source>,
    pub speeds: Vec<Source>,
    pub others: Vec<Source>,
    /// Columns and their values: other rows are passed over.
    pub filters: Vec<(usize, String)>,
    /// Number of the drive that is meant, from 1, where time starts again.
    pub trip: Option<usize>,
    /// Columns of a quantity whose unit nothing states.
    pub no_unit: Vec<(Quantity, usize)>,
    /// The same in a table of names and values: column, and the value of another column.
    pub only_no_unit: Option<(usize, String)>,
}

impl Sheet<'_> {
    fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        let cells = self
            .sample
            .iter()
            .filter_map(move |row| row.get(column).copied());
        cells.filter(|cell| !is_missing(cell))
    }

    /// Cells of the last rows.
    fn last_cells(&self, column: usize) -> impl Iterator<Item = &str> {
        let cells = self
            .tail
            .iter()
            .filter_map(move |row| row.get(column).copied());
        cells.filter(|cell| !is_missing(cell))
    }

    /// Form of the stamps of a column: a clock or a date, in words or in figures alone.
    pub(super) fn form(&self, column: usize) -> Option<Form> {
        let first = self.cells(column).next()?;
        match number(first, self.decimal_comma) {
            None => Form::of_all(self.cells(column), self.last_cells(column)),
            Some(_) => Form::of_figures(self.cells(column), self.last_cells(column)),
        }
    }

    /// Unit of a column by its name or by the row of units.
    pub(super) fn stated_unit(&self, quantity: Quantity, column: usize) -> Option<Unit> {
        /// Names whose units the programs that write them document: openpilot, SUMO, FASTSim.
        const KNOWN: [(&str, &str); 8] = [
            ("logMonoTime", "ns"),
            ("carState.vEgo", "m/s"),
            ("timestep_time", "s"),
            ("vehicle_slope", "deg"),
            ("cycSecs", "s"),
            ("cycMps", "m/s"),
            ("cycGrade", "-"),
            ("vehicle_speed", "m/s"),
        ];
        let name = self.names.get(column).map_or("", String::as_str);
        let stated = unit_in(quantity, name).or_else(|| quantity.unit(self.units.get(column)?));
        let stated = stated.or_else(|| {
            let (_, unit) = KNOWN.iter().find(|(known, _)| *known == name)?;
            // Other programs write `vehicle_speed` too.
            let is_own =
                name != "vehicle_speed" || self.names.iter().any(|name| name == "timestep_time");
            quantity.unit(unit).filter(|_| is_own)
        });
        // In a table of the program's own form `grade` is a share.
        let is_table = name == "grade" && self.names.iter().any(|name| name == "time_s");
        stated.or_else(|| {
            quantity
                .plain_unit()
                .filter(|_| is_table && quantity == Quantity::Grade)
        })
    }

    /// How a column is read as this quantity: by its stated unit, or as stamps; none where numbers have no unit.
    fn reading(&self, quantity: Quantity, column: usize) -> Option<Reading> {
        if quantity == Quantity::Phase {
            return Some(Reading::Word);
        }
        let first = self.cells(column).next()?;
        let is_time = quantity == Quantity::Time;
        if number(first, self.decimal_comma).is_none() {
            return is_time
                .then(|| self.form(column))
                .flatten()
                .map(Reading::Stamp);
        }
        let unit = self.stated_unit(quantity, column);
        if unit.is_none()
            && is_time
            && let Some(form) = self.form(column)
        {
            return Some(Reading::Stamp(form));
        }
        let plain = quantity.plain_unit().filter(|_| !quantity.needs_unit());
        unit.or(plain).map(Reading::Number)
    }

    fn is_number(&self, column: usize) -> bool {
        self.cells(column)
            .next()
            .is_some_and(|cell| number(cell, self.decimal_comma).is_some())
    }

    /// Channels by the names of the file.
    pub(super) fn by_names(&self) -> Chosen {
        let mut chosen = Chosen::default();
        for column in 0..self.names.len().min(self.width) {
            let name = self.names[column].as_str();
            // The row of units may say more than the name, as under "Offset".
            let by_unit = |quantity: Quantity| {
                self.units
                    .get(column)
                    .is_some_and(|unit| quantity.unit(unit).is_some())
            };
            let quantity = match Quantity::of_name(name) {
                Some(Quantity::Time) if by_unit(Quantity::Speed) && !by_unit(Quantity::Time) => {
                    continue;
                }
                Some(quantity) => quantity,
                None => continue,
            };
            if is_identity(name) || self.cells(column).next().is_none() {
                continue;
            }
            match self.reading(quantity, column) {
                Some(reading) => chosen.add(Source {
                    quantity,
                    column,
                    reading,
                    only: None,
                }),
                None if self.is_number(column) => chosen.no_unit.push((quantity, column)),
                None => {}
            }
        }
        // The mean of a trip, or what is wanted, is no speed of the car where another is one.
        let is_own = |source: &Source| !is_other_speed(&self.names[source.column]);
        if chosen.speeds.iter().any(is_own) {
            chosen.speeds.retain(is_own);
        }
        let is_own_column = |(quantity, column): &(Quantity, usize)| {
            *quantity != Quantity::Speed || !is_other_speed(&self.names[*column])
        };
        if chosen
            .no_unit
            .iter()
            .any(|own| own.0 == Quantity::Speed && is_own_column(own))
        {
            chosen.no_unit.retain(is_own_column);
        }
        if chosen.speeds.is_empty() {
            self.by_values(&mut chosen);
        }
        chosen
    }

    /// A table of names and values: a column of words, one of which means the speed, and a column `value`.
    fn by_values(&self, chosen: &mut Chosen) {
        const VALUES: [&str; 6] = ["value", "values", "val", "reading", "data", "wert"];
        let is_value = |column: &usize| {
            let name = crate::channel::bare(&self.names[*column]);
            name.split('_').any(|word| VALUES.contains(&word)) && self.is_number(*column)
        };
        let Some(value) = (0..self.names.len()).find(is_value) else {
            return;
        };
        for column in 0..self.width {
            let is_speed = |cell: &&str| Quantity::of_name(cell) == Some(Quantity::Speed);
            let Some(word) = self
                .cells(column)
                .find(is_speed)
                .filter(|_| column != value && !self.is_number(column))
            else {
                continue;
            };
            let word = word.to_owned();
            let row = self
                .sample
                .iter()
                .find(|row| row.get(column) == Some(&word.as_str()));
            let in_row = row.and_then(|row| {
                row.iter()
                    .enumerate()
                    .filter(|(k, _)| *k != value)
                    .find_map(|(_, cell)| Quantity::Speed.unit(cell))
            });
            match unit_in(Quantity::Speed, &word).or(in_row) {
                Some(unit) => chosen.add(Source {
                    quantity: Quantity::Speed,
                    column: value,
                    reading: Reading::Number(unit),
                    only: Some((column, word)),
                }),
                None => {
                    chosen.no_unit.push((Quantity::Speed, value));
                    chosen.only_no_unit = Some((column, word));
                }
            }
            return;
        }
    }

    /// Channels as the user names them.
    ///
    /// # Errors
    /// A column that is not there, a unit that is missing, unknown or contradicts the file.
    pub(super) fn by_columns(&self, columns: &Columns) -> Result<Chosen, Problem> {
        let mut chosen = Chosen::default();
        for (k, entry) in columns.entries().iter().enumerate() {
            if entry.quantity == "where" {
                self.filter(entry, &mut chosen)?;
                continue;
            }
            let Some(quantity) = Quantity::from_word(&entry.quantity) else {
                let names = Quantity::ALL.iter().map(|(_, name)| *name);
                let close = near(&entry.quantity, names.clone());
                return Err(Problem::unknown_name(format!(
                    "there is no quantity `{}`",
                    entry.quantity
                ))
                .at(Argument::Columns)
                .value(entry.quantity.as_str())
                .allowed(names.chain(["where"]).collect::<Vec<_>>().join(", "))
                .hint(suggestion(&close).unwrap_or_default()));
            };
            let (column, only) = match &entry.name {
                Some(name) => self.column(name)?,
                None => (k, None),
            };
            if column >= self.width {
                let message = format!(
                    "there are {} columns, and {} is the number {}",
                    self.width,
                    entry.quantity,
                    k + 1
                );
                return Err(Problem::out_of_range(message)
                    .at(Argument::Columns)
                    .allowed(format!("up to {} columns", self.width)));
            }
            let reading = self.reading_by(entry, quantity, column)?;
            chosen.add(Source {
                quantity,
                column,
                reading,
                only,
            });
        }
        // `grade=slope:%` alone: time and speed are as the file names them.
        if chosen.times.is_empty() || chosen.speeds.is_empty() {
            let own = self.by_names();
            let is_free = |source: &Source| {
                let others = chosen
                    .others
                    .iter()
                    .chain(&chosen.times)
                    .chain(&chosen.speeds);
                others.clone().all(|other| other.column != source.column)
            };
            let free = |list: Vec<Source>| list.into_iter().filter(is_free).collect::<Vec<_>>();
            let (times, speeds) = (free(own.times), free(own.speeds));
            if chosen.times.is_empty() {
                chosen.times = times;
            }
            if chosen.speeds.is_empty() {
                chosen.speeds = speeds;
            }
            let of_both =
                |(own, _): &(Quantity, usize)| matches!(own, Quantity::Time | Quantity::Speed);
            chosen.no_unit = own.no_unit.into_iter().filter(of_both).collect();
        }
        Ok(chosen)
    }

    fn reading_by(
        &self,
        entry: &Entry,
        quantity: Quantity,
        column: usize,
    ) -> Result<Reading, Problem> {
        let allowed = || quantity.units().join(", ");
        // The name before `=` may be that of a table of cycles, with its unit.
        let own = unit_in(quantity, &entry.quantity);
        let given = entry.unit.as_deref().and_then(|unit| quantity.unit(unit));
        if own.zip(given).is_some_and(|(own, given)| own != given) {
            let message = format!("{} is not read in that unit", entry.quantity);
            return Err(Problem::conflict(message)
                .at(Argument::Columns)
                .value(entry.unit.as_deref().unwrap_or_default())
                .allowed(own.map_or("", |own| own.name)));
        }
        let own = own.map(|unit| unit.name.to_owned());
        let Some(written) = &entry.unit.clone().or(own) else {
            return self.reading(quantity, column).ok_or_else(|| {
                let name = entry.name.as_deref().unwrap_or("NAME");
                let unit = quantity.units().first().copied().unwrap_or("-");
                Problem::missing(format!("{} needs its unit", quantity.name()))
                    .at(Argument::Columns)
                    .allowed(allowed())
                    .hint(format!(
                        "write it behind the name: {}={name}:{unit}",
                        entry.quantity
                    ))
            });
        };
        // Stamps have no unit: `time=Clock:s` is read as the stamp that it is.
        let first = self.cells(column).next();
        let is_number = first.is_some_and(|cell| number(cell, self.decimal_comma).is_some());
        if let Some(Reading::Stamp(form)) = self.reading(quantity, column)
            && (!is_number || written == form.name())
        {
            return Ok(Reading::Stamp(form));
        }
        if quantity == Quantity::Phase {
            return Ok(Reading::Word);
        }
        let Some(unit) = quantity.unit(written) else {
            return Err(Problem::unknown_name(format!(
                "{} is not read in that unit",
                quantity.name()
            ))
            .at(Argument::Columns)
            .value(written.as_str())
            .allowed(allowed())
            .hint(format!(
                "write it behind the name: {}={}:{}",
                entry.quantity,
                entry.name.as_deref().unwrap_or("NAME"),
                quantity.units().first().copied().unwrap_or("-")
            )));
        };
        let stated = self.stated_unit(quantity, column);
        if let Some(stated) = stated.filter(|stated| *stated != unit && !entry.forced) {
            let name = self.label(column);
            let message = format!(
                "`{name}` states {}, and the columns say {}",
                stated.name, unit.name
            );
            return Err(Problem::conflict(message)
                .at(Argument::Columns)
                .value(written.as_str())
                .allowed(stated.name)
                .hint(format!(
                    "leave the unit out, or write {}={name}:{}! if the file is wrong",
                    entry.quantity, unit.name
                )));
        }
        Ok(Reading::Number(unit))
    }

    /// A column by its name, by its number, or `VALUE[PID=Vehicle speed]`.
    fn column(&self, text: &str) -> Result<(usize, Option<(usize, String)>), Problem> {
        if let Some(column) = self.named(text) {
            return Ok((column, None));
        }
        let inner = text.strip_suffix(']').and_then(|text| text.split_once('['));
        if let Some((value, (key, word))) =
            inner.and_then(|(value, rest)| Some((value, rest.split_once('=')?)))
            && let (Some(value), Some(key)) = (self.named(value), self.named(key))
        {
            return Ok((value, Some((key, word.trim().to_owned()))));
        }
        let close = near(text, self.names.iter().map(String::as_str));
        Err(
            Problem::unknown_name(format!("the file has no column `{text}`"))
                .at(Argument::Columns)
                .value(text)
                .allowed("a name of the file's line of column names, as it is written there")
                .hint(suggestion(&close).unwrap_or_default()),
        )
    }

    fn named(&self, text: &str) -> Option<usize> {
        let text = text.trim();
        self.names.iter().position(|name| name == text).or_else(|| {
            let number: usize = text.parse().ok()?;
            (self.names.is_empty() && (1..=self.width).contains(&number)).then(|| number - 1)
        })
    }

    fn filter(&self, entry: &Entry, chosen: &mut Chosen) -> Result<(), Problem> {
        let text = entry.name.as_deref().unwrap_or_default();
        let parts = text
            .match_indices(':')
            .map(|(at, _)| (&text[..at], &text[at + 1..]));
        for (name, value) in parts.clone() {
            if let Some(column) = self.named(name) {
                chosen.filters.push((column, value.trim().to_owned()));
                return Ok(());
            }
            if name == "trip" {
                let number = value.trim().parse().ok().filter(|trip| *trip >= 1);
                chosen.trip = Some(number.ok_or_else(|| {
                    Problem::wrong_type("a trip has a number")
                        .at(Argument::Columns)
                        .value(value)
                        .allowed("1, 2 and so on, by where the time starts again")
                })?);
                return Ok(());
            }
        }
        match parts.clone().next() {
            Some((name, _)) => Err(self.column(name).err().unwrap_or_default()),
            None => Err(Problem::syntax("where names a column and a value")
                .at(Argument::Columns)
                .value(text)
                .allowed("where=COLUMN:VALUE, such as where=VehId:7")),
        }
    }
}

/// True if the name of a speed says that it is a mean, or what the car should drive.
fn is_other_speed(name: &str) -> bool {
    const WORDS: [&str; 9] = [
        "average",
        "avg",
        "mean",
        "target",
        "cruise",
        "reference",
        "ref",
        "moving",
        "setpoint",
    ];
    crate::channel::bare(name)
        .split('_')
        .any(|word| WORDS.contains(&word))
}

impl Chosen {
    fn add(&mut self, source: Source) {
        match source.quantity {
            Quantity::Time => self.times.push(source),
            Quantity::Speed => self.speeds.push(source),
            _ if self
                .others
                .iter()
                .any(|other| other.quantity == source.quantity) => {}
            _ => self.others.push(source),
        }
    }
}
