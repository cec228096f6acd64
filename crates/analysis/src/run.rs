//! The summary of a run with all that is said of it: maps that were left, prices of the losses, published numbers.

use cvtcycle_config::cycle::Cycle;
use cvtcycle_model::drive::Conditions;
use cvtcycle_output::summary::{
    Driven, Over, RunSummary, Settings, StartWord, Summary, find_maps_left, summarise,
};

use crate::attribute::{Attribution, Depth, attribute};
use crate::words;
use cvtcycle_validate::ValidationRow;

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
    /// Settings of the drives.
    pub settings: Settings,
    /// True to drive each car again without each loss, for the price of that loss in fuel.
    pub price: bool,
    /// Published numbers about the subject on the cycle, as [`published`](cvtcycle_validate::published) has them, where they are read already.
    pub published: Option<Vec<ValidationRow>>,
}

/// The summary of cars that have been driven; the first is the subject.
///
/// ```
/// use cvtcycle_config::cycle;
/// use cvtcycle_config::setup::{Options, load};
/// use cvtcycle_model::drive::{Conditions, Start, drive};
/// use cvtcycle_output::summary::{Driven, Settings, StartWord};
/// use cvtcycle_analysis::run::{RunQuestion, summary};
/// let setup = load("rover_216_cvt", &Options::default())?;
/// let cycle = cycle::find("constant_50")?;
/// let conditions = Conditions { ambient_k: 263.15, start: Start::Soak, max_dt_s: 1.0, keep_rows: false };
/// let outcome = drive(&setup, &cycle, &conditions);
/// let driven = [Driven { name: "rover", setup: &setup, outcome: &outcome }];
/// let question = RunQuestion {
///     cycle: &cycle,
///     conditions,
///     ambient_degc: -10.0,
///     start: StartWord::Word("soak".to_owned()),
///     settings: Settings::default(),
///     price: true,
///     published: None,
/// };
/// let summary = summary(&question, &driven);
/// let price = summary.runs[0].price.as_ref().expect("asked for");
/// assert!(price.together.percent > price.losses["pump"].saved.percent);
/// # Ok::<(), cvtcycle_config::Problems>(())
/// ```
pub fn summary(of: &RunQuestion, driven: &[Driven]) -> Summary {
    let (cycle, settings) = (of.cycle, &of.settings);
    let start = of.start.clone();
    let mut summary = summarise(cycle, of.ambient_degc, start, settings.clone(), driven);
    find_maps_left(&mut summary, cycle, &of.conditions, driven);
    // Without a distance to speak of there is no fuel per distance to save.
    let priced = |run: &RunSummary| of.price && run.over() == Over::Distance;
    let cars = summary.runs.iter_mut().zip(driven);
    for (run, car) in cars.filter(|(run, _)| priced(run)) {
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
    words::run::assess(&mut summary, cycle, driven, of.published.as_deref());
    summary
}
