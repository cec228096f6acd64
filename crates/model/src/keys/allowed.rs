//! Allowed values of a key, in words.

use super::{Bound, Choice, Key, Kind, Quantity};

impl Key<'_> {
    /// Allowed values, such as "0.5 to 10 mm".
    pub fn allowed(&self) -> String {
        self.kind.allowed(self.quantity)
    }

    /// Unit as written for people; of rows, the units of the columns.
    pub fn unit(&self) -> String {
        match &self.kind {
            Kind::Rows(columns) => {
                let units = columns
                    .iter()
                    .map(|(name, _)| Quantity::from_key(name).unit());
                units.collect::<Vec<_>>().join(", ")
            }
            _ => self.quantity.unit().to_owned(),
        }
    }

    /// The range of a key that holds numbers, in its unit.
    #[must_use]
    pub const fn range(&self) -> Bound {
        match self.kind {
            Kind::Number(range) | Kind::Numbers(range, ..) | Kind::Grid(range) => range,
            Kind::Integer(low, high) => Bound::closed(low as f64, high as f64),
            _ => Bound::any(),
        }
    }

    /// True if the value is a single number.
    pub fn is_number(&self) -> bool {
        matches!(self.kind, Kind::Number(_) | Kind::Integer(..))
    }
}

impl Kind<'_> {
    fn allowed(&self, quantity: Quantity) -> String {
        let each = |range: &Bound| range.in_unit(quantity.unit());
        match self {
            Kind::Number(range) => each(range),
            Kind::Integer(low, i64::MAX) => format!("integer of at least {low}"),
            Kind::Integer(low, high) => format!("integer from {low} to {high}"),
            Kind::Flag => "true or false".to_owned(),
            Kind::Text => "text".to_owned(),
            Kind::Csv => "the name of a CSV file".to_owned(),
            Kind::Words(choices) | Kind::Options(choices) => one_of(choices),
            Kind::Numbers(range, least, most) => {
                format!("{}, each {}", count(*least, *most), each(range))
            }
            Kind::Grid(range) => format!(
                "a number, a list or a range \"from..to:step\", each {}",
                each(range)
            ),
            Kind::Texts => "a list of texts".to_owned(),
            Kind::Rows(columns) => {
                let words = columns.iter().map(|(name, range)| {
                    format!("{name} {}", range.in_unit(Quantity::from_key(name).unit()))
                });
                format!("rows of {}", words.collect::<Vec<_>>().join(", "))
            }
            Kind::Other(words) | Kind::List(_, words) => (*words).to_owned(),
            Kind::Name(known) => known(),
            Kind::Either(kinds) => {
                let each: Vec<String> = kinds.iter().map(|kind| kind.allowed(quantity)).collect();
                each.join(", or ")
            }
        }
    }
}

/// "one of a, b, c".
fn one_of(choices: &[Choice]) -> String {
    let names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
    format!("one of {}", names.join(", "))
}

/// A number of numbers, in words.
pub fn count(least: usize, most: usize) -> String {
    match (least, most) {
        (1, 1) => "1 number".to_owned(),
        (least, most) if least == most => format!("{least} numbers"),
        (least, usize::MAX) => format!("at least {least} numbers"),
        (least, most) => format!("{least} to {most} numbers"),
    }
}
