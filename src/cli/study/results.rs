//! What a study says, and the files that say it.

use std::path::Path;

use cvtcycle::config::Problem;
use cvtcycle::review::study_pictures::study_pictures;
use cvtcycle::study::ambient::{WarmUp, warm_ups};
use cvtcycle::study::store;
use cvtcycle::study::{Answer, Frame, Outline, answer};

use super::csv_files;
use crate::cli::answer::json_text;

/// Answer and what its pictures need.
pub struct Results {
    /// The answer.
    pub answer: Answer,
    /// What the study is.
    pub outline: Outline,
    /// Parts that are there, and that there will be.
    pub parts: (usize, usize),
    warm_ups: Vec<WarmUp>,
}

impl Results {
    /// From the parts in a directory.
    pub fn of(outline: &Outline, found: &store::Study) -> Result<Self, Problem> {
        let frame = Frame::new(outline, found)?;
        let answer = answer(&frame)?;
        let traced = found.layout().tables.iter().any(|table| table == cvtcycle::study::manifest::TRACES);
        let warm_ups = match &answer.matrix {
            Some(matrix) if traced => warm_ups(&frame, matrix).unwrap_or_default(),
            _ => Vec::new(),
        };
        let status = found.status();
        Ok(Results { answer, outline: outline.clone(), parts: (status.present, status.expected), warm_ups })
    }

    /// The answer as one JSON object.
    pub fn json(&self) -> Result<String, Vec<Problem>> {
        json_text(&self.answer)
    }

    /// Files of a finished study: numbers and pictures.
    pub fn files(&self, found: &store::Study) -> Result<Vec<(String, Vec<u8>)>, Vec<Problem>> {
        let mut files = vec![("statistics.json".to_owned(), self.json()?.into_bytes())];
        files.extend(csv_files::all(&self.answer, &self.outline));
        let pictures = Frame::new(&self.outline, found).and_then(|frame| study_pictures(&self.answer, &frame, &self.warm_ups));
        let pictures = pictures.map_err(|problem| vec![problem])?;
        files.extend(pictures.into_iter().map(|(name, picture)| (format!("{name}.svg"), picture.svg.into_bytes())));
        Ok(files)
    }
}

/// The results of a study's directory, finished or partial.
pub fn open(path: &Path) -> Result<Results, Problem> {
    let found = store::Study::open(path)?;
    let text = String::from_utf8_lossy(&found.plan()?).into_owned();
    let file = path.join("plan.toml").display().to_string();
    let outline = Outline::read(found.manifest(), &file, &text).map_err(|words| Problem {
        place: cvtcycle::config::Place { file: path.join("study.json").display().to_string(), ..Default::default() },
        message: format!("cannot read the study: {words}"),
        hint: "read it with the program that wrote it, or run it again".into(),
        ..Problem::default()
    })?;
    Results::of(&outline, &found)
}
