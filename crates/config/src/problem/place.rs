//! Where a problem is: in a file, in an override, or in an argument of a call.

use std::fmt;

use serde::Serialize;

/// Input that contains a place. As text: the file's name, `override KEY=VALUE`, or the argument's name.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Input {
    /// A file by its name as given, or `embedded:NAME`; empty where there is none.
    File(String),
    /// An override, `KEY=VALUE` as given.
    Override(String),
    /// An argument of a call.
    Argument(Argument),
}

/// An argument of a call whose value is a name or a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Argument {
    /// The vehicle.
    Vehicle,
    /// The transmission oil.
    Lubricant,
    /// The engine oil.
    EngineOil,
    /// The drive cycle.
    Cycle,
    /// The plan of a study.
    Plan,
    /// The plan of a calibration.
    Calibration,
    /// The cover of a report.
    Cover,
    /// Any other file that is read.
    File,
    /// The columns of a table that are meant.
    Columns,
    /// The repairs of a log that are wanted.
    Repair,
    /// Written value.
    Output,
}

impl Argument {
    /// Name, such as "engine oil".
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Argument::Vehicle => "vehicle",
            Argument::Lubricant => "lubricant",
            Argument::EngineOil => "engine oil",
            Argument::Cycle => "cycle",
            Argument::Plan => "plan",
            Argument::Calibration => "calibration",
            Argument::Cover => "cover",
            Argument::File => "file",
            Argument::Columns => "columns",
            Argument::Repair => "repair",
            Argument::Output => "output",
        }
    }
}

impl Default for Input {
    fn default() -> Self {
        Input::File(String::new())
    }
}

impl fmt::Display for Input {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Input::File(name) => f.write_str(name),
            Input::Override(text) => write!(f, "override {text}"),
            Input::Argument(argument) => f.write_str(argument.name()),
        }
    }
}

/// Location in an input. As JSON: `{"file": "car.toml", "line": 7, ..}`, `{"override": "KEY=VALUE", ..}` or `{"argument": "vehicle", ..}`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Input that contains it.
    #[serde(flatten)]
    pub input: Input,
    /// Line, counted from 1; 0 where the input has no lines.
    pub line: usize,
    /// Column of the first character of the value, counted from 1; 0 where unknown.
    pub column: usize,
    /// The text of that line, for the caret; empty where unknown.
    pub line_text: Box<str>,
    /// Number of characters that the caret underlines.
    pub width: usize,
}

impl Place {
    /// A whole file.
    #[must_use]
    pub fn file(file: impl Into<String>) -> Self {
        Input::File(file.into()).into()
    }

    /// Name of the file; none in an override or an argument.
    #[must_use]
    pub fn file_name(&self) -> Option<&str> {
        match &self.input {
            Input::File(name) => Some(name),
            _ => None,
        }
    }

    /// Text of the override; none in a file or an argument.
    #[must_use]
    pub fn assignment(&self) -> Option<&str> {
        match &self.input {
            Input::Override(text) => Some(text),
            _ => None,
        }
    }

    /// Narrowed to a text in its line, such as an item of a list; unchanged if the text is not in the line.
    #[must_use]
    pub fn of_item(mut self, text: &str) -> Place {
        if let Some(at) = self.line_text.find(text).filter(|_| !text.is_empty()) {
            self.column = self.line_text[..at].chars().count() + 1;
            self.width = text.chars().count();
        }
        self
    }

    /// True in that argument.
    #[must_use]
    pub fn is_argument(&self, argument: Argument) -> bool {
        self.input == Input::Argument(argument)
    }
}

impl From<Input> for Place {
    fn from(input: Input) -> Self {
        Place {
            input,
            ..Place::default()
        }
    }
}

impl From<Argument> for Place {
    fn from(argument: Argument) -> Self {
        Input::Argument(argument).into()
    }
}
