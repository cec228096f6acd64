//! Levers: changes of a car's design, each driven with the draws of an uncertainty plan next to the car as it is.
//!
//! | file | contents |
//! |---|---|
//! | `keys`, `read` | lever files |
//! | `cars` | which levers each car can have, and what is wrong with the others |
//! | `combine` | which of them go together |
//! | `request` | what is to be driven, and what the columns of its table are |
//! | `prepare` | levers, cars and ambient temperatures to the columns of a study |
//! | `answer` | the table of that study to differences with their certainty and side effects |
//! | `tables`, `words` | the answer as a table for other programs, and in sentences |

mod answer;
mod cars;
mod combine;
pub mod keys;
mod prepare;
mod read;
mod request;
mod tables;
mod words;

pub use answer::{
    Between, LeverAnswer, LeverBlock, LeverRow, OfForm, SetBy, SideEffect, lever_answer,
};
pub use combine::{COMBINE, Combine};
pub use prepare::prepare;
pub use request::{ColumnNote, LeverNotes, LeverRequest};
pub use tables::csv;
pub use words::answer_in_words;

use cvtcycle_config::setup::{NamedBy, Options};
use cvtcycle_config::{Acts, Override, Place, Problems};

use cvtcycle_study::plan::Factor;

/// The changes of a file.
#[derive(Clone, Debug)]
pub struct LeverFile {
    /// Name of the file, as problems cite it.
    pub file: String,
    /// Name for people.
    pub title: String,
    /// In their order.
    pub levers: Vec<Lever>,
}

/// A change of a car's design.
#[derive(Clone, Debug)]
pub struct Lever {
    /// Unique name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Overrides, in order.
    pub set: Vec<Override>,
    /// Another transmission oil, name or path.
    pub lubricant: Option<String>,
    /// Another engine oil, name or path.
    pub engine_oil: Option<String>,
    /// A combination has one lever of a group.
    pub group: Option<String>,
    /// True if the automatic combination may include it.
    pub combine: bool,
    /// Requirements; may be empty.
    pub needs: String,
    /// `source`, `derived`, `fitted` or `assumed`.
    pub status: String,
    /// Reason or reference; may be empty.
    pub source: String,
    /// `true`: only for cars with a CVT; `false`: only for those without; `None`: for all.
    pub of_cvt: Option<bool>,
    /// True if the user has named it or its file: a car that cannot have it is then an error.
    pub is_named: bool,
    /// Place of its name.
    pub place: Place,
    /// Place of its overrides.
    pub set_place: Place,
}

impl LeverFile {
    /// Reads and checks a lever file; `file` is the name under which problems cite it. Keys of cars are not known here.
    ///
    /// ```
    /// use cvtcycle_analysis::levers::LeverFile;
    /// let text = "[[lever]]\nname = \"lighter\"\nset = [\"road_load.mass_kg*=0.9\"]\n";
    /// assert_eq!(LeverFile::read("own.toml", text)?.levers[0].title, "lighter");
    /// # Ok::<(), cvtcycle_config::Problems>(())
    /// ```
    ///
    /// # Errors
    /// All problems with their places.
    pub fn read(file: &str, text: &str) -> Result<LeverFile, Problems> {
        read::file(file, text)
    }

    /// The lever file of that name or path.
    ///
    /// # Errors
    /// Unknown name, unreadable file, or all problems of the file.
    pub fn open(word: &str) -> Result<LeverFile, Problems> {
        read::open(word)
    }
}

impl Lever {
    /// True if it gives a value to the key of a factor, which is then no longer uncertain.
    fn fixes(&self, factor: &Factor) -> bool {
        let sets = |by: &Override| by.acts() == Acts::Value && by.key() == factor.key;
        self.set.iter().any(sets)
            || (self.lubricant.is_some() && factor.key == "lubricant")
            || (self.engine_oil.is_some() && factor.key == "engine_oil")
    }

    /// Why it does not go together with another one: both give a key different values, or one removes what the other changes.
    fn clash(&self, other: &Lever) -> Option<String> {
        let both = |own: &Option<String>, other: &Option<String>| own.is_some() && other.is_some();
        if both(&self.lubricant, &other.lubricant) || both(&self.engine_oil, &other.engine_oil) {
            return Some("both name an oil".to_owned());
        }
        let pairs = self
            .set
            .iter()
            .flat_map(|own| other.set.iter().map(move |by| (own, by)));
        let clash = |(own, by): (&Override, &Override)| {
            let commute = own.acts() == by.acts() && own.acts() != Acts::Value;
            let same_value = own.acts() == by.acts() && own.value() == by.value();
            if own.key() == by.key() && !commute && !same_value {
                return Some(format!("both change `{}`", own.key()));
            }
            let removed = if removes(own, by) { by } else { own };
            (removes(own, by) || removes(by, own))
                .then(|| format!("one removes `{}`, which the other changes", removed.key()))
        };
        pairs.map(clash).find(Option::is_some).flatten()
    }
}

/// True if an override chooses an option that lacks the key of another override.
fn removes(by: &Override, other: &Override) -> bool {
    let below = other.key().strip_prefix(by.key());
    let option = below.and_then(|below| below.strip_prefix('.')?.split('.').next());
    by.acts() == Acts::Value && option.is_some_and(|option| option != by.value())
}

/// Collects the options that cars with some levers are read with.
fn options<'l>(base: &Options, levers: impl Iterator<Item = &'l Lever>) -> Options {
    let mut options = Options {
        // Another file may have named them, and they are read many times.
        named_by: NamedBy::File,
        ..base.clone()
    };
    for lever in levers {
        options.set.extend(lever.set.iter().cloned());
        options.lubricant = lever.lubricant.clone().or(options.lubricant);
        options.engine_oil = lever.engine_oil.clone().or(options.engine_oil);
    }
    options
}
