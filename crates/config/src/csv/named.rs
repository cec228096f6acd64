//! Columns as the user names them: which column of a logger's table is which quantity, in which unit. All others are passed over.

use super::heading::unit_named;
use super::text::split;
use crate::channel::{Quantity, Repairs};
use crate::{Argument, Problem};

/// Word of a choice of rows: `where=VehId:7`.
const WHERE: &str = "where";

/// Form of an entry.
const FORM: &str = "QUANTITY=NAME:UNIT with a comma between columns, or QUANTITY:UNIT for each column of a file without names";

/// The columns that are meant, all that have a name of the schema if there are none; and the repairs of a log that are wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    pub(super) list: Vec<Entry>,
    repairs: Repairs,
}

/// One column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Entry {
    /// A quantity, such as `speed`, a column of the schema, or `where`.
    pub quantity: String,
    /// Name in the file; none where the columns are given in their order.
    pub name: Option<String>,
    pub unit: Option<String>,
    /// True where the unit holds against the one that the file states: `km/h!`.
    pub forced: bool,
}

impl Columns {
    /// Reads `speed=VehSpd:mph,time=Time_ADC:s`, or `time:s,speed:mph` for the columns of a file without names in their order. An entry
    /// with a comma in it is put into double quotes.
    ///
    /// ```
    /// use cvtcycle_config::csv::Columns;
    /// assert!(Columns::parse("speed=VehSpd:mph,\"time=Time, secs\"").is_ok());
    /// assert!(Columns::parse("speed").is_err());
    /// ```
    ///
    /// # Errors
    /// An entry of another form, a quantity that is given twice, or both forms at once.
    pub fn parse(text: &str) -> Result<Columns, Problem> {
        let mut fields = Vec::new();
        let wrong = |message: String| {
            let problem = Problem::syntax(message).at(Argument::Columns).value(text);
            Err(problem
                .allowed(FORM)
                .hint("for example time=Time_ADC:s,speed=VehSpd:mph"))
        };
        if split(text, ',', &mut fields).is_err() {
            return wrong("a quote is not closed".to_owned());
        }
        let mut list: Vec<Entry> = Vec::new();
        for field in fields {
            let own = text.get(field.start..field.end).unwrap_or_default();
            let Some(entry) = Entry::parse(own) else {
                return wrong(format!("`{own}` names no column"));
            };
            if entry.quantity != WHERE && list.iter().any(|other| other.quantity == entry.quantity)
            {
                return wrong(format!("{} is given twice", entry.quantity));
            }
            list.push(entry);
        }
        let named = list.iter().filter(|entry| entry.name.is_some()).count();
        if named > 0 && named < list.len() {
            return wrong("some columns are named and some are not".to_owned());
        }
        Ok(Columns {
            list,
            repairs: Repairs::default(),
        })
    }

    /// With these repairs of a log.
    #[must_use]
    pub fn with_repairs(self, repairs: Repairs) -> Self {
        Columns { repairs, ..self }
    }

    /// Repairs of a log that are wanted.
    #[must_use]
    pub fn repairs(&self) -> Repairs {
        self.repairs
    }

    pub(crate) fn entries(&self) -> &[Entry] {
        &self.list
    }

    /// True where the names of the file say themselves what they are.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// True where the file has no line of names.
    pub fn are_in_order(&self) -> bool {
        self.list.iter().any(|entry| entry.name.is_none())
    }

    /// True if a name of the file is one of them.
    pub(super) fn has(&self, text: &str) -> bool {
        self.list
            .iter()
            .any(|entry| entry.name.as_deref() == Some(text))
    }
}

impl Entry {
    fn parse(text: &str) -> Option<Entry> {
        let some = |text: &str| (!text.trim().is_empty()).then(|| text.trim().to_owned());
        let Some((quantity, rest)) = text.split_once('=') else {
            let (quantity, unit) = text.split_once(':')?;
            return Some(Entry {
                quantity: some(quantity)?,
                name: None,
                unit: Some(some(unit)?),
                forced: false,
            });
        };
        let is_unit = |unit: &str| {
            let unit = unit.trim_end_matches('!');
            unit_named(unit).is_some()
                || Quantity::ALL
                    .iter()
                    .any(|(own, _)| own.unit(unit).is_some())
        };
        // A name may have a colon itself.
        let (name, unit) = match rest.rsplit_once(':') {
            Some((name, unit)) if quantity.trim() != WHERE && is_unit(unit) => (name, some(unit)),
            _ => (rest, None),
        };
        Some(Entry {
            quantity: some(quantity)?,
            name: Some(some(name)?),
            forced: unit.as_deref().is_some_and(|unit| unit.ends_with('!')),
            unit: unit.map(|unit| unit.trim_end_matches('!').to_owned()),
        })
    }
}
