//! Numbers by name that keep their order, as a JSON object.

use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// Numbers by name, in the order in which they were put in; none is a number that was not computed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Named(IndexMap<String, Option<f64>>);

impl Named {
    /// The number of that name, if it is there and was computed.
    pub fn get(&self, name: &str) -> Option<f64> {
        *self.0.get(name)?
    }

    /// Names and numbers in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Option<f64>)> {
        self.0.iter().map(|(name, value)| (name.as_str(), *value))
    }
}

impl<'a> FromIterator<(&'a str, Option<f64>)> for Named {
    fn from_iter<I: IntoIterator<Item = (&'a str, Option<f64>)>>(list: I) -> Self {
        let owned = list
            .into_iter()
            .map(|(name, value)| (name.to_owned(), value));
        Named(owned.collect())
    }
}
