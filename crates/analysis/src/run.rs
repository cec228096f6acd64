//! The summary of a run with all that is said of it: maps that were left, prices of the losses, published numbers.

use cvtcycle_config::cycle::Cycle;
use cvtcycle_config::setup::start_of_log;
use cvtcycle_model::drive::{Conditions, Row, drive};
use cvtcycle_model::lubricant::ZERO_DEGC_K;
use cvtcycle_output::summary::{
    Driven, MeasuredSummary, Over, RunSummary, Settings, StartWord, Summary, UNCHANGED,
    find_maps_left, summarise,
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
    /// True if the first baseline is the subject before its changes.
    pub has_unchanged: bool,
    /// Published numbers about the subject, alone and over the baselines, on the cycle, as [`published`](cvtcycle_validate::published) has them, where
    /// they are read already.
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
///     has_unchanged: false,
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
    if let Some(run) = summary.runs.get_mut(1).filter(|_| of.has_unchanged) {
        UNCHANGED.clone_into(&mut run.role);
    }
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
    if let Some((own, recorded)) = summary.recording.as_mut().zip(cycle.recording.as_deref()) {
        let start = start_of_log(recorded).map(|start| StartWord::of_nodes(&start));
        own.starts = start.is_some_and(|start| start == of.start);
    }
    bounds(&mut summary, of, driven);
    compare_log(&mut summary, of, driven);
    summary
}

/// Quantities of a log and how they are computed and printed: name, unit, size of the unit in SI, value of a row in SI.
type Quantity = (&'static str, &'static str, f64, fn(&Row) -> f64);
const QUANTITIES: [Quantity; 5] = [
    ("engine_speed", "rpm", std::f64::consts::PI / 30.0, |row| {
        row.engine_speed_rad_s
    }),
    ("fuel", "g/s", 1e-3, |row| row.fuel_kg_s),
    ("coolant", "degC", 1.0, |row| row.coolant_k - ZERO_DEGC_K),
    ("engine_oil", "degC", 1.0, |row| {
        row.engine_oil_k - ZERO_DEGC_K
    }),
    ("sump", "degC", 1.0, |row| row.sump_k - ZERO_DEGC_K),
];

/// Means of a quantity of a log and of the computed one over stretches of a drive.
struct Series {
    stretch_s: f64,
    /// Time, sums of time, log and computed car of each.
    sums: Vec<[f64; 4]>,
}

impl Series {
    /// Most stretches.
    const MOST: f64 = 300.0;

    fn new(duration_s: f64) -> Self {
        Series {
            stretch_s: (duration_s / Series::MOST).max(1.0),
            sums: Vec::new(),
        }
    }

    fn add(&mut self, row: &Row, there: f64, here: f64) {
        let middle_s = row.time_s - 0.5 * row.dt_s;
        let at = (middle_s / self.stretch_s) as usize;
        if self.sums.len() <= at {
            self.sums.resize(at + 1, [0.0; 4]);
        }
        let own = [
            row.dt_s,
            row.dt_s * middle_s,
            row.dt_s * there,
            row.dt_s * here,
        ];
        for (sum, own) in self.sums[at].iter_mut().zip(own) {
            *sum += own;
        }
    }

    fn means(&self) -> Vec<[f64; 3]> {
        let there = self.sums.iter().filter(|sum| sum[0] > 0.0);
        there
            .map(|sum| [1, 2, 3].map(|k| sum[k] / sum[0]))
            .collect()
    }
}

/// Engine speed, fuel and temperatures of a log next to those that are computed of the subject, step by step.
fn compare_log(summary: &mut Summary, of: &RunQuestion, driven: &[Driven]) {
    let recorded = of.cycle.recording.as_deref();
    let Some(((own, recorded), car)) = summary.recording.as_mut().zip(recorded).zip(driven.first())
    else {
        return;
    };
    if recorded.measured.is_empty() {
        return;
    }
    let conditions = Conditions {
        keep_rows: true,
        ..of.conditions
    };
    let again = car
        .outcome
        .rows
        .is_empty()
        .then(|| drive(car.setup, of.cycle, &conditions));
    let rows = again
        .as_ref()
        .map_or(&car.outcome.rows, |outcome| &outcome.rows);
    for measured in &recorded.measured {
        let Some((name, unit, size, value)) = QUANTITIES
            .iter()
            .find(|(name, ..)| *name == measured.quantity)
        else {
            continue;
        };
        let [mut seconds, mut mean, mut computed, mut square] = [0.0; 4];
        let mut series = Series::new(rows.last().map_or(0.0, |row| row.time_s));
        for row in rows {
            let Some(there) = measured.mean(row.time_s - row.dt_s, row.time_s) else {
                continue;
            };
            let (there, here) = (there / size, value(row) / size);
            seconds += row.dt_s;
            mean += row.dt_s * there;
            computed += row.dt_s * here;
            square += row.dt_s * (here - there) * (here - there);
            series.add(row, there, here);
        }
        if seconds > 0.0 {
            own.measured.push(MeasuredSummary {
                quantity: (*name).to_owned(),
                unit: (*unit).to_owned(),
                measured: mean / seconds,
                computed: computed / seconds,
                rms: (square / seconds).sqrt(),
                seconds,
                series: series.means(),
            });
        }
    }
}

/// How far rate, resolution and smoothing of a recording leave the results open (LG-6): the cars drive it with a quarter and four times the density of
/// LG-3 too, and with speeds lower and higher by their error.
fn bounds(summary: &mut Summary, of: &RunQuestion, driven: &[Driven]) {
    let recorded = of.cycle.recording.as_deref();
    let Some((own, recorded)) = summary.recording.as_mut().zip(recorded) else {
        return;
    };
    let Some(left) = recorded.left else {
        return;
    };
    let conditions = Conditions {
        keep_rows: false,
        ..of.conditions
    };
    let headline = |runs: &[RunSummary]| runs.iter().map(RunSummary::headline_fuel).collect();
    let mut fuels: Vec<Vec<Option<f64>>> = vec![headline(&summary.runs)];
    for trace in &recorded.bounds {
        let cycle = Cycle {
            manual: trace.clone(),
            automatic: None,
            recording: None,
            ..of.cycle.clone()
        };
        let outcomes: Vec<_> = driven
            .iter()
            .map(|car| drive(car.setup, &cycle, &conditions))
            .collect();
        let cars: Vec<Driven> = driven
            .iter()
            .zip(&outcomes)
            .map(|(car, outcome)| Driven { outcome, ..*car })
            .collect();
        let other = summarise(
            &cycle,
            of.ambient_degc,
            of.start.clone(),
            of.settings.clone(),
            &cars,
        );
        fuels.push(headline(&other.runs));
    }
    let hull = |values: &dyn Fn(&Vec<Option<f64>>) -> Option<f64>| {
        let all: Option<Vec<f64>> = fuels.iter().map(values).collect();
        all.map(|all| {
            let low = all.iter().copied().fold(f64::INFINITY, f64::min);
            [low, all.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        })
    };
    let fuel = hull(&|fuels| *fuels.first()?);
    own.fuel =
        fuel.map(|[low, high]| [low * (1.0 - 0.01 * left[0]), high * (1.0 + 0.01 * left[0])]);
    own.percent = (1..driven.len())
        .map(|k| {
            let percent =
                hull(&|fuels| Some(100.0 * ((*fuels.first()?)? / (*fuels.get(k)?)? - 1.0)));
            percent.map(|[low, high]| [low - left[1], high + left[1]])
        })
        .collect();
}
