//! The files that a study writes when it is finished.

use cvtcycle::config::Problems;
use cvtcycle::report::found::StudyFound;
use cvtcycle::report::study_pictures::study_pictures;
use cvtcycle::study::tables::tables;

use crate::print::json_text;

/// Files of a finished study: numbers and pictures.
pub fn files(study: &StudyFound) -> Result<Vec<(String, Vec<u8>)>, Problems> {
    let mut files = vec![(
        "statistics.json".to_owned(),
        json_text(&study.answer)?.into_bytes(),
    )];
    files.extend(tables(&study.answer, &study.outline));
    let pictures = study
        .frame()
        .and_then(|frame| study_pictures(&study.answer, &frame, &study.warm_ups));
    let pictures = pictures?;
    files.extend(
        pictures
            .into_iter()
            .map(|(name, picture)| (format!("{name}.svg"), picture.svg.into_bytes())),
    );
    Ok(files)
}
