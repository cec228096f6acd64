//! Results of a study of levers, for `levers` and `study show`.

mod tables;

use cvtcycle::analysis::levers::{LeverAnswer, csv, lever_answer};
use cvtcycle::config::{Problem, Problems};
use cvtcycle::report::study_pictures::lever_pictures;
use cvtcycle::study::statistics::Confidence;
use cvtcycle::study::{StudyManifest, StudyTable, store};

use super::execution::StudyOutput;
use super::tables::failures;
use crate::print::colour::Paint;
use crate::print::{Results, WrittenFiles, json_text};

/// Evaluated study of levers.
pub struct LeverResults {
    answer: LeverAnswer,
    parts: (usize, usize),
}

impl StudyOutput for LeverResults {
    fn evaluate(
        outline: StudyManifest,
        store: store::Study,
        confidence: Confidence,
    ) -> Result<Self, Problem> {
        let answer = lever_answer(&StudyTable::new(&outline, &store)?, confidence)?;
        store.unchanged()?;
        let status = store.status();
        Ok(LeverResults {
            answer,
            parts: (status.present, status.expected),
        })
    }

    fn results(&self) -> Result<Results, Problems> {
        // Single failing draws are results. A car that fails in most of its draws is a failed check.
        let failures = match self.answer.is_failed() {
            true => failures(&self.answer.runs),
            false => Vec::new(),
        };
        let json = json_text(&self.answer)?;
        Ok(Results::new(json, failures, WrittenFiles::default()))
    }

    fn files(&self) -> Result<Vec<(String, Vec<u8>)>, Problems> {
        let json = json_text(&self.answer)?.into_bytes();
        let csv = csv(&self.answer).map(|csv| ("levers.csv".to_owned(), csv));
        let json = ("levers.json".to_owned(), json);
        let svg = lever_pictures(&self.answer)
            .map(|(name, picture)| (format!("{name}.svg"), picture.svg.into_bytes()));
        Ok(std::iter::once(json).chain(csv).chain(svg).collect())
    }

    fn tables(&self, paint: Paint) -> String {
        tables::tables(&self.answer, self.parts, paint)
    }
}
