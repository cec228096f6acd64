//! Refusals of a log: what is missing, lines that are no rows, rows of several cars or drives.

use super::choose::{Chosen, Source};
use super::fill::Filled;
use super::repair::number_of;
use super::{Reader, Refused, propose};
use crate::channel::Quantity;
use crate::{Problem, Problems};

impl Reader<'_, '_> {
    /// Time or speed was not found.
    pub(super) fn missing(&self, chosen: &Chosen) -> Refused {
        let known =
            !chosen.times.is_empty() || !chosen.speeds.is_empty() || !chosen.no_unit.is_empty();
        let mut problems = Problems::new();
        for (quantity, sources) in [
            (Quantity::Time, &chosen.times),
            (Quantity::Speed, &chosen.speeds),
        ] {
            if !sources.is_empty() {
                continue;
            }
            let unit = chosen.no_unit.iter().find(|(own, _)| *own == quantity);
            let problem = match unit {
                Some((_, column)) => Problem::missing(format!(
                    "the unit of `{}` is not stated",
                    self.sheet.label(*column)
                ))
                .allowed(quantity.units().join(", ")),
                None if self.sheet.names.is_empty() => Problem::missing(format!(
                    "the file has no names of columns, so that none is known as {}",
                    quantity.name()
                ))
                .allowed(format!("{} columns", self.sheet.width)),
                None => Problem::missing(format!("no column is known as {}", quantity.name()))
                    .allowed(self.sheet.names.join(", ")),
            };
            problems.add(problem.in_file(self.file).key(quantity.name()));
        }
        let rows = chosen.filters.iter().chain(&chosen.only_no_unit).cloned();
        let filled = Filled::of(
            self.sheet,
            &Chosen {
                filters: rows.collect(),
                ..Chosen::default()
            },
        );
        let mut filters = self.filters(chosen);
        if let Some((column, values)) = filled.identities.first().filter(|_| chosen.trip.is_none())
        {
            problems.add(self.several_values(*column, values));
            let value = values.first().map(|(value, _)| value.clone());
            filters.push((self.sheet.label(*column), value.unwrap_or_default()));
        }
        let guess = propose::guess(self.sheet, chosen, &filters);
        let columns = guess.as_ref().map_or("", |guess| &guess.columns);
        let is_known = known || !columns.is_empty();
        let problems = problems.map(|problem| {
            let is_speed = problem.key == Quantity::Speed.name();
            let hint = guess
                .as_ref()
                .filter(|_| is_speed)
                .map_or("", |guess| &guess.hint);
            let problem = problem.columns(columns);
            if hint.is_empty() {
                problem
            } else {
                problem.hint(hint)
            }
        });
        Refused { problems, is_known }
    }

    /// Rows that the user has chosen.
    pub(super) fn filters(&self, chosen: &Chosen) -> Vec<(String, String)> {
        let filters = chosen.filters.iter();
        filters
            .map(|(column, value)| (self.sheet.label(*column), value.clone()))
            .collect()
    }

    pub(super) fn no_unit(&self, chosen: &Chosen, quantity: Quantity, column: usize) -> Refused {
        let name = self.sheet.label(column);
        let problem = Problem::missing(format!("the unit of `{name}` is not stated"))
            .in_file(self.file)
            .key(quantity.name())
            .allowed(quantity.units().join(", "))
            .hint("a slope of 0.2 may be a share, per cent, degrees or per mille");
        let unit = match quantity {
            Quantity::Grade => "%",
            _ => "m",
        };
        let more = [(quantity, column, unit)];
        Refused::known(problem.columns(propose::columns(
            self.sheet,
            chosen,
            (&chosen.times[0], &chosen.speeds[0]),
            &more,
            &[],
        )))
    }

    /// Lines that are no rows, and none that is one.
    pub(super) fn rows(&self, filled: &Filled) -> Result<(), Refused> {
        if let Some((line, text)) = filled.other.first() {
            let places: Vec<String> = filled
                .other
                .iter()
                .map(|(line, _)| line.to_string())
                .collect();
            let more = if filled.others > places.len() {
                " and others"
            } else {
                ""
            };
            let message = format!(
                "{} without the values of a row between the rows: line {}{more}",
                number_of(filled.others, "line"),
                places.join(", ")
            );
            let problem = Problem::syntax(message)
                .value(crate::one_line(text))
                .allowed(format!("{} values in each row", self.sheet.width));
            let problem = problem.hint(
                "is a cell of time or speed a word? a value without a number is empty, - or NaN",
            );
            let place = self.problem(u32::try_from(*line).unwrap_or(u32::MAX), problem);
            // The program's own reader says more about a cell.
            return Err(Refused {
                problems: place.into(),
                is_known: !self.columns.is_empty(),
            });
        }
        if filled.lines.len() < 2 {
            let problem = Problem::missing("fewer than two rows have a time and a speed")
                .in_file(self.file)
                .allowed("at least two rows");
            let problem = problem.hint("a row holds until the next one");
            return Err(Refused {
                problems: problem.into(),
                is_known: filled.empty > 0,
            });
        }
        Ok(())
    }

    /// Refuses rows of several cars or drives.
    pub(super) fn one_car(
        &self,
        chosen: &Chosen,
        filled: &Filled,
        leading: (&Source, &Source),
    ) -> Result<(), Refused> {
        let Some((column, values)) = filled.identities.first().filter(|_| chosen.trip.is_none())
        else {
            return Ok(());
        };
        Err(self.several(*column, values, chosen, leading))
    }

    fn several_values(&self, column: usize, values: &[(String, usize)]) -> Problem {
        let name = self.sheet.label(column);
        let shown = values
            .iter()
            .take(5)
            .map(|(value, rows)| format!("{value} ({rows} rows)"));
        let shown: Vec<String> = shown.collect();
        let more = if values.len() > shown.len() {
            ", ..."
        } else {
            ""
        };
        let message = format!(
            "`{name}` has {} values: the rows are of several cars or drives",
            values.len()
        );
        Problem::conflict(message)
            .in_file(self.file)
            .key(name.as_str())
            .allowed(format!("one of {}{more}", shown.join(", ")))
    }

    pub(super) fn several(
        &self,
        column: usize,
        values: &[(String, usize)],
        chosen: &Chosen,
        leading: (&Source, &Source),
    ) -> Refused {
        let mut filters = self.filters(chosen);
        let value = values.first().map(|(value, _)| value.clone());
        filters.push((self.sheet.label(column), value.unwrap_or_default()));
        let columns = propose::columns(self.sheet, chosen, leading, &[], &filters);
        Refused::known(self.several_values(column, values).columns(columns))
    }
}
