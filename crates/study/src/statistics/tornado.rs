//! One factor at a time: what each does to an output against the base.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TO-1 | effect = output - output of the base; swing = max(effects, 0) - min(effects, 0) | derived: length of the bar from the base |
//!
//! Two values of a factor are its low and its high end, in the order of the plan. Of more, the ends are those with the least and the largest
//! output. Words are labels like any other; every level is kept.

use serde::Serialize;

/// A factor's runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TornadoInput {
    /// Name of the factor.
    pub name: String,
    /// Value of the factor, as people read it, and the output there, in the order of the plan, without the base.
    pub entries: Vec<(String, f64)>,
}

/// One end of a bar.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TornadoEnd {
    /// Value of the factor.
    pub label: String,
    /// Output there.
    pub output: f64,
    /// Difference from the base.
    pub effect: f64,
}

/// One factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TornadoBar {
    /// Name of the factor.
    pub name: String,
    /// The first of two values, or that with the least output of more. `None` without an output.
    pub low: Option<TornadoEnd>,
    /// The second of two values, or that with the largest output of more. `None` without an output.
    pub high: Option<TornadoEnd>,
    /// Width of the range that base and ends span; NaN if neither end has an output.
    pub swing: f64,
    /// Every level, in the order of the plan; NaN where there is no output.
    pub entries: Vec<TornadoEnd>,
    /// Number of them without an output.
    pub missing: usize,
}

impl TornadoBar {
    /// Levels that are neither end of the bar, of those with an output.
    pub fn between(&self) -> impl Iterator<Item = &TornadoEnd> {
        let is_end = |entry: &TornadoEnd| [&self.low, &self.high].contains(&&Some(entry.clone()));
        let known = |entry: &&TornadoEnd| entry.effect.is_finite();
        self.entries
            .iter()
            .filter(known)
            .filter(move |entry| !is_end(entry))
    }
}

/// All factors, the widest swing first; those without an output last.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tornado {
    /// Output of the base.
    pub base: f64,
    /// The factors.
    pub bars: Vec<TornadoBar>,
}

/// Effects of factors on an output, sorted. Without an output of the base nothing has an effect: all swings are NaN.
pub fn tornado(base: f64, factors: &[TornadoInput]) -> Tornado {
    let mut bars: Vec<TornadoBar> = factors.iter().map(|factor| bar(base, factor)).collect();
    // A stable sort: equal swings stay in the order of the plan.
    let widest = |a: f64, b: f64| a.is_nan().cmp(&b.is_nan()).then(b.total_cmp(&a));
    bars.sort_by(|a, b| widest(a.swing, b.swing));
    Tornado { base, bars }
}

fn bar(base: f64, factor: &TornadoInput) -> TornadoBar {
    let end = |(label, output): &(String, f64)| TornadoEnd {
        label: label.clone(),
        output: *output,
        effect: output - base,
    }; // TO-1
    let is_known = |entry: &&(String, f64)| (entry.1 - base).is_finite();
    let known: Vec<&(String, f64)> = factor.entries.iter().filter(is_known).collect();
    let by_output = |a: &&&(String, f64), b: &&&(String, f64)| a.1.total_cmp(&b.1);
    let kept = |entry: &(String, f64)| Some(entry).filter(is_known).map(end);
    let (low, high) = match (factor.entries.as_slice(), known.as_slice()) {
        ([a, b], _) => (kept(a), kept(b)),
        // On the side to which it goes.
        (_, [one]) if one.1 < base => (Some(end(one)), None),
        (_, [one]) => (None, Some(end(one))),
        // The first of equal ones on both sides.
        _ => (
            known.iter().min_by(by_output).map(|e| end(e)),
            known.iter().rev().max_by(by_output).map(|e| end(e)),
        ),
    };
    let effects = || low.iter().chain(&high).map(|end| end.effect);
    let swing = effects().fold(0.0, f64::max) - effects().fold(0.0, f64::min); // TO-1
    let swing = effects().next().map_or(f64::NAN, |_| swing);
    let missing = factor.entries.len() - known.len();
    TornadoBar {
        name: factor.name.clone(),
        low,
        high,
        swing,
        entries: factor.entries.iter().map(end).collect(),
        missing,
    }
}
