//! Content of a live page: its section with levers, states and answers. `live` makes it, `render` puts it into a page.

use std::collections::BTreeMap;

use cvtcycle_config::Override;
use cvtcycle_output::number::fixed;
use cvtcycle_output::summary::DrawnDifference;
use serde::{Deserialize, Serialize};

use crate::number::sign;

/// The live section of a page.
#[derive(Clone, Debug)]
pub struct LiveSection {
    /// Initial state.
    pub state: State,
    /// Levers.
    pub controls: Vec<Control>,
    /// Words of the cars available for comparison in the figures, with their names.
    pub cars: Vec<(String, String)>,
    /// Names of the cycles.
    pub cycles: Vec<String>,
    /// Names of transmission oils.
    pub oils: Vec<String>,
    /// First answer.
    pub answer: Answer,
    /// Intervals of the answer, once drawn.
    pub(crate) drawn: Option<Vec<DrawnDifference>>,
    /// Scene as JSON, for the page's script.
    pub(crate) scene: String,
}

/// Answer to a state.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answer {
    /// Sentences and figures as HTML.
    pub html: String,
    /// Command that prints the same numbers.
    pub command: String,
    /// True if there is a difference whose interval can be drawn.
    pub can_draw: bool,
    /// True if the car cannot be built or driven; the sentences then give the reason.
    pub failed: bool,
}

/// A state of cycle, ambient, fluid and levers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Name or path of the cycle.
    pub cycle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// Transmission oil; by default that of the car's file.
    pub lubricant: Option<String>,
    /// Position of each moved lever: a number, or the name of a change.
    #[serde(default)]
    pub levers: BTreeMap<String, String>,
    /// Word of the car for comparison in the figures; the first one if unknown.
    #[serde(default)]
    pub against: String,
}

/// A lever of a page.
#[derive(Clone, Debug)]
pub struct Control {
    /// Name in states and addresses.
    pub name: String,
    /// Name for people.
    pub title: &'static str,
    /// Kind and range.
    pub kind: ControlKind,
}

/// Kinds of lever.
#[derive(Clone, Debug)]
pub enum ControlKind {
    /// A number.
    Slider(Slider),
    /// A choice of at most one change.
    Choice(Vec<ControlChange>),
}

/// An adjustable number, in the unit of its key.
#[derive(Clone, Debug)]
pub struct Slider {
    /// Dotted key.
    pub key: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Value of the car.
    pub base: f64,
    /// Ends.
    pub ends: [f64; 2],
    /// Distance of two positions.
    pub step: f64,
    /// Combined range of the car's value, of the shipped levers and of the plan of uncertainty; nothing is known outside it.
    pub known: [f64; 2],
    /// Meaning of the key.
    pub meaning: &'static str,
}

/// A change of a car.
#[derive(Clone, Debug)]
pub struct ControlChange {
    /// Name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// Requirement; may be empty.
    pub needs: String,
    /// Overrides.
    pub set: Vec<Override>,
}

impl Slider {
    /// Number of decimals of its positions.
    #[must_use]
    pub fn decimals(&self) -> usize {
        (-self.step.log10().floor()).clamp(0.0, 6.0) as usize
    }

    /// Known range on the track, from 0 to 1.
    #[must_use]
    pub fn band(&self) -> [f64; 2] {
        let [from, to] = self.ends;
        self.known
            .map(|x| ((x - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// Tests that a value lies in the known range; a position may be rounded.
    #[must_use]
    pub fn knows(&self, value: f64) -> bool {
        let half = 0.5 * self.step;
        (self.known[0] - half..=self.known[1] + half).contains(&value)
    }
}

impl Slider {
    /// Formats a value with its unit.
    pub fn with_unit(&self, value: f64) -> String {
        let number = fixed(Some(value), self.decimals());
        format!("{number} {}", self.unit).trim_end().to_owned()
    }

    /// Formats the car's value with its unit.
    pub fn base_text(&self) -> String {
        self.with_unit(self.base)
    }

    /// Formats the known range in words.
    pub fn known_text(&self) -> String {
        let [low, high] = self.known.map(|x| fixed(Some(x), self.decimals()));
        let text = format!("{low} to {high} {}", self.unit);
        text.trim_end().to_owned()
    }

    /// Unit as printed.
    pub fn unit_sign(&self) -> &'static str {
        sign(self.unit)
    }

    /// Ends of the known range on the track, per cent.
    pub fn band_percent(&self) -> [String; 2] {
        self.band().map(|share| format!("{:.1}", 100.0 * share))
    }

    /// Formats a number as an attribute.
    pub fn attribute(&self, value: &f64) -> String {
        format!("{value:.*}", self.decimals())
    }
}
