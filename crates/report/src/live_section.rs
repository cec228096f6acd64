//! What a live page shows: its section with levers, states and answers. `live` makes it, `render` puts it into a page.

use std::collections::BTreeMap;

use cvtcycle_config::Override;
use cvtcycle_output::number::fixed;
use cvtcycle_output::summary::DrawnDifference;
use serde::{Deserialize, Serialize};

use crate::number::sign;

/// The live section of a page.
#[derive(Clone, Debug)]
pub struct LiveSection {
    /// How it begins.
    pub state: State,
    /// The levers.
    pub controls: Vec<Control>,
    /// Words of the cars that the figures can hold the subject against, with their names.
    pub cars: Vec<(String, String)>,
    /// Names of the cycles.
    pub cycles: Vec<String>,
    /// Names of transmission oils.
    pub oils: Vec<String>,
    /// The first answer.
    pub answer: Answer,
    /// Its interval, once drawn.
    pub(crate) drawn: Option<Vec<DrawnDifference>>,
    /// The scene as JSON, for the page's script.
    pub(crate) scene: String,
}

/// The answer to a state.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Answer {
    /// Sentences and figures as HTML.
    pub html: String,
    /// The command that prints the same numbers.
    pub command: String,
    /// Whether there is a difference whose interval can be drawn.
    pub can_draw: bool,
    /// Whether no such car can be built or driven; the sentences then say why.
    pub failed: bool,
}

/// A state of cycle, ambient, fluid and levers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Name or path of the cycle.
    pub cycle: String,
    /// Ambient temperature, degC.
    pub ambient_degc: f64,
    /// Transmission oil; that of the car's file if none.
    pub lubricant: Option<String>,
    /// What each moved lever is at: a number, or the name of a change.
    #[serde(default)]
    pub levers: BTreeMap<String, String>,
    /// The word of the car that the figures hold the subject against; the first one if it is none of them.
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
    /// What it is.
    pub kind: Kind,
}

/// Kinds of lever.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A number.
    Slider(Slider),
    /// One of some changes, or none.
    Choice(Vec<Change>),
}

/// A number that can be moved, all in the unit of its key.
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
    /// The range of the car's value, of the shipped levers and of the plan of uncertainty; beyond it nothing is known.
    pub known: [f64; 2],
    /// What the key means.
    pub meaning: &'static str,
}

/// A change of a car.
#[derive(Clone, Debug)]
pub struct Change {
    /// Name.
    pub name: String,
    /// Name for people.
    pub title: String,
    /// What it takes; may be empty.
    pub needs: String,
    /// Overrides.
    pub set: Vec<Override>,
}

impl Slider {
    /// Decimals of its positions.
    #[must_use]
    pub fn decimals(&self) -> usize {
        (-self.step.log10().floor()).clamp(0.0, 6.0) as usize
    }

    /// The known range on the track, from 0 to 1.
    #[must_use]
    pub fn band(&self) -> [f64; 2] {
        let [from, to] = self.ends;
        self.known
            .map(|x| ((x - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// Whether a value is one that something is known of; a position may be rounded.
    #[must_use]
    pub fn knows(&self, value: f64) -> bool {
        let half = 0.5 * self.step;
        (self.known[0] - half..=self.known[1] + half).contains(&value)
    }
}

impl Slider {
    /// A value with its unit.
    pub fn with_unit(&self, value: f64) -> String {
        let number = fixed(Some(value), self.decimals());
        format!("{number} {}", self.unit).trim_end().to_owned()
    }

    /// The car's value with its unit.
    pub fn base_text(&self) -> String {
        self.with_unit(self.base)
    }

    /// The known range in words.
    pub fn known_text(&self) -> String {
        let [low, high] = self.known.map(|x| fixed(Some(x), self.decimals()));
        let text = format!("{low} to {high} {}", self.unit);
        text.trim_end().to_owned()
    }

    /// Its unit as people write it.
    pub fn unit_sign(&self) -> &'static str {
        sign(self.unit)
    }

    /// Where the known range begins and ends on the track, per cent.
    pub fn band_percent(&self) -> [String; 2] {
        self.band().map(|share| format!("{:.1}", 100.0 * share))
    }

    /// A number of it, as an attribute has it.
    pub fn attribute(&self, value: &f64) -> String {
        format!("{value:.*}", self.decimals())
    }
}
