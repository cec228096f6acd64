//! The summary of a run with all that is said of it: maps that were left, prices of the losses, published numbers.

use cvtcycle_config::cycle::Cycle;
use cvtcycle_model::drive::Conditions;
use cvtcycle_output::summary::{Driven, Settings, StartWord, Summary, find_maps_left, summarise};

use crate::attribute::{Attribution, Depth, attribute};
use crate::words;

/// How the cars of a run were driven, and what is wanted of it.
#[derive(Clone, Debug)]
pub struct RunQuestion<'a> {
    /// The cycle.
    pub cycle: &'a Cycle,
    /// As each car was driven.
    pub conditions: Conditions,
    /// Ambient temperature as it was given, degC.
    pub ambient_degc: f64,
    /// Start as it was given.
    pub start: StartWord,
    /// What else was asked for.
    pub settings: Settings,
    /// Whether each car is driven again without each loss, for the fuel that it costs.
    pub price: bool,
}

/// The summary of cars that have been driven; the first is the subject.
pub fn summary(of: &RunQuestion, driven: &[Driven]) -> Summary {
    let (cycle, settings) = (of.cycle, &of.settings);
    let start = of.start.clone();
    let mut summary = summarise(cycle, of.ambient_degc, start, settings.clone(), driven);
    find_maps_left(&mut summary, cycle, &of.conditions, driven);
    for (run, car) in summary.runs.iter_mut().zip(driven).filter(|_| of.price) {
        let priced = Attribution {
            setup: car.setup,
            cycle,
            conditions: of.conditions,
            settings,
            factor: 0.0,
            depth: Depth::default(),
        };
        run.price = Some(attribute(&priced, run));
    }
    words::run::assess(&mut summary, cycle, driven);
    summary
}
