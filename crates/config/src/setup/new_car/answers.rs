//! Catalogue numbers from a file: a TOML table with the names of the options.

use super::{Answers, NUMBERS};
use crate::document::{Document, Value};
use crate::problem::near::suggest;
use crate::{Problem, Problems};

/// Names that are no numbers.
const WORDS: [&str; 7] = [
    "title",
    "like",
    "class",
    "engine",
    "engine-year",
    "engine-like",
    "box",
];

impl Answers {
    /// Adds the values of a file that are not given already: `mass = "3000lb"`, `displacement = 1800`, `class = "compact_2020"`.
    ///
    /// # Errors
    /// Invalid TOML, unknown names, and values that are neither text nor a number.
    pub fn add_file(&mut self, file: &str, text: &str) -> Result<(), Problems> {
        let document = Document::parse(file, text)?;
        let mut problems = Problems::new();
        for (name, entry) in document.root.entries.iter() {
            let place =
                |span: &crate::document::Span| document.sources[0].place(span.range.clone());
            let text = match words(&entry.node.value) {
                Ok(text) => text,
                Err(kind) => {
                    let problem =
                        Problem::wrong_type(format!("expected text or a number, found {kind}"));
                    let problem = problem.at(place(&entry.node.span)).key(name);
                    problems.push(
                        problem
                            .allowed("text, a number, or a list of numbers")
                            .hint("write it as the option has it: \"3000lb\""),
                    );
                    continue;
                }
            };
            // Keys of TOML files have `_` where options have `-`.
            let option = name.replace('_', "-");
            let number = NUMBERS.iter().find(|(own, _)| *own == option);
            match (number, option.as_str()) {
                (Some((own, _)), _) if !self.numbers.contains_key(own) => {
                    self.numbers.insert(own, text);
                    self.places.insert(own, place(&entry.node.span));
                }
                (Some(_), _) => {}
                (None, "title") if self.title.is_empty() => self.title = text,
                (None, "like") => drop(self.like.get_or_insert(text)),
                (None, "class") => drop(self.class.get_or_insert(text)),
                (None, "box") => drop(self.gearbox.get_or_insert(text)),
                (None, "engine") => drop(self.engine.get_or_insert(text)),
                (None, "engine-year") => drop(self.engine_year.get_or_insert(text)),
                (None, "engine-like") => drop(self.engine_like.get_or_insert(text)),
                (None, "title") => {}
                (None, _) => {
                    let known = NUMBERS.iter().map(|(own, _)| *own).chain(WORDS);
                    let known: Vec<&str> = known.collect();
                    let problem =
                        Problem::unknown_name(format!("there is no option named `{name}`"));
                    let problem = problem.at(place(&entry.key)).key(name);
                    problems.push(
                        problem
                            .names_key()
                            .allowed(known.join(", "))
                            .hint(suggest(name, &known)),
                    );
                }
            }
        }
        problems.finish()
    }
}

/// A value as the option has it; a list as its items with commas. What it is, if it is none of these.
fn words(value: &Value) -> Result<String, &'static str> {
    match value {
        Value::Text(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        Value::List(items) => {
            let items = items.iter().map(|item| words(&item.value));
            Ok(items.collect::<Result<Vec<_>, _>>()?.join(","))
        }
        other => Err(other.kind()),
    }
}
