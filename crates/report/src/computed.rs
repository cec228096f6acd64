//! Answer of a run from one sample of what is uncertain of its cars: ranges, price of each loss, options, next test.

use cvtcycle_analysis::answer::{DRAWS, HEARD_RPM, Question, prepare, shipped_levers};
use cvtcycle_config::{Problem, Problems};
use cvtcycle_output::summary::Over;
use cvtcycle_study::Study;

use crate::results::RunResults;
use crate::whatif::base_of_run;

/// The study of a run's question.
///
/// # Errors
/// Why there is none, in words: a car or the cycle has changed since the run, or there is no distance to compare.
pub(crate) fn study_of_run(found: &RunResults) -> Result<Study, String> {
    let summary = &found.summary;
    if summary
        .runs
        .first()
        .is_none_or(|run| run.over() == Over::Time)
    {
        return Err("the cycle has no distance".to_owned());
    }
    let Some(record) = &found.record else {
        return Err("the run has no inputs.json".to_owned());
    };
    let words = |problems: Problems| first_message(&problems);
    let base = base_of_run(&found.path, summary, record).map_err(words)?;
    let question = Question {
        base,
        levers: shipped_levers().map_err(words)?,
        prices: true,
        draws: DRAWS,
        heard_rpm: HEARD_RPM,
    };
    prepare(&question).map_err(words)
}

fn first_message(problems: &Problems) -> String {
    let first = problems.iter().next();
    first.map_or_else(String::new, |problem: &Problem| problem.message.clone())
}
