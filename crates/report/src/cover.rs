//! The user's own title, logo, author and remarks, from a TOML file.
//!
//! ```toml
//! title = "Band offset of 2 mm"
//! subtitle = "Design review 7"
//! author = "A. Engineer"
//! organisation = "Example Ltd"
//! date = "2026-11-21"
//! logo = "logo.svg"        # PNG, JPEG or SVG, up to 500 kB, in the folder of this file
//! logo_words = "Example Ltd"
//! [remarks]
//! answer = "First paragraph.\nSecond paragraph."
//! losses = "..."
//! ```

use std::path::Path;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

use super::document::{Block, Document};
use cvtcycle_config::bounded::{self, ReadError};
use cvtcycle_config::{Argument, Document as Toml, ProblemKind, Problems, Reader, decode};
use cvtcycle_model::keys::{Key, spec};

/// Sections of a report, in order.
pub const SECTIONS: [&str; 13] = [
    "answer",
    "conditions",
    "difference",
    "energy",
    "losses",
    "warm_up",
    "driveline",
    "engine",
    "ambient",
    "uncertainty",
    "values",
    "validation",
    "reproducibility",
];

/// The cover, and remarks on sections.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cover {
    /// Title that replaces the report's own.
    pub title: Option<String>,
    /// Line below the title.
    pub subtitle: Option<String>,
    /// Author, organisation, date.
    pub byline: Vec<String>,
    /// Logo as a data URI, with its alternative text.
    pub logo: Option<(String, String)>,
    /// Section and remark.
    pub remarks: Vec<(&'static str, String)>,
}

impl Cover {
    /// Reads a cover.
    ///
    /// # Errors
    /// All problems of the file, with line and hint, and of the logo.
    pub fn read(path: &str) -> Result<Self, Problems> {
        let bytes = cvtcycle_config::cycle::bytes(Argument::Cover, path, bounded::TOML)?;
        Self::parse(path, &decode(path, &bytes)?)
    }

    /// Parses a cover; `path` is the name that problems cite, and its folder holds the logo.
    ///
    /// # Errors
    /// As [`Cover::read`].
    pub fn parse(path: &str, text: &str) -> Result<Self, Problems> {
        let toml = Toml::parse(path, text)?;
        let reader = Reader::new(&toml);
        let root = reader.root();
        let text = |key: &str, doc: &str| {
            root.optional_text(&Key::new(key, spec::text(), doc))
                .filter(|text| !text.trim().is_empty())
        };
        let mut cover = Cover {
            title: text("title", "title of the report"),
            subtitle: text("subtitle", "a line below it"),
            ..Cover::default()
        };
        for (key, doc) in [
            ("author", "who made the report"),
            ("organisation", "for whom the author works"),
            ("date", "when, in any form"),
        ] {
            cover.byline.extend(text(key, doc));
        }
        let logo = text("logo", "file of the logo, in the folder of this file");
        let words = text("logo_words", "the logo in words");
        if let Some(name) = logo {
            match logo_data(path, &name) {
                Ok(data) => cover.logo = Some((data, words.unwrap_or_else(|| "Logo".to_owned()))),
                Err((message, hint)) => {
                    let allowed = "a PNG, JPEG or SVG file of at most 500 kB";
                    root.complain(ProblemKind::Unreadable, "logo", allowed, &message, &hint);
                }
            }
        }
        let remarks = root.table("remarks");
        for section in SECTIONS {
            let meaning = "remark at the beginning of that section";
            let remark = remarks.optional_text(&Key::new(section, spec::text(), meaning));
            let remark = remark.filter(|text| !text.trim().is_empty());
            cover.remarks.extend(remark.map(|text| (section, text)));
        }
        reader.finish()?;
        Ok(cover)
    }

    /// Applies the cover to a report. Remarks on missing sections become warnings.
    pub fn apply(&self, document: &mut Document) {
        if let Some(title) = &self.title {
            document.title.clone_from(title);
        }
        if let Some(subtitle) = &self.subtitle {
            document.subtitle.clone_from(subtitle);
        }
        document.byline.clone_from(&self.byline);
        document.logo.clone_from(&self.logo);
        for (id, text) in &self.remarks {
            let mut sections = document.sections.iter_mut();
            match sections.find(|section| section.id == *id) {
                Some(section) => section.blocks.insert(0, Block::Remark(text.clone())),
                None => document.warnings.push(format!(
                    "the cover has a remark on `{id}`, a section that this report does not have"
                )),
            }
        }
    }
}

/// Reads a logo as a data URI; the error is the problem and its hint.
fn logo_data(cover: &str, name: &str) -> Result<String, (String, String)> {
    let folder = Path::new(cover).parent().unwrap_or(Path::new(""));
    let path = folder.join(name);
    let bytes = bounded::read_file(&path, bounded::LOGO).map_err(|error| match error {
        ReadError::TooLarge(Some(size), limit) => {
            (format!("the logo has {size} bytes"), limit.hint.to_owned())
        }
        _ => {
            let hint = error.hint("the path is taken from the folder of this file");
            let message = format!("cannot read {}: {error}", path.display());
            (message, hint.to_owned())
        }
    })?;
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(1000)]).to_lowercase();
    let kind = match () {
        () if bytes.starts_with(b"\x89PNG\r\n\x1a\n") => "image/png",
        () if bytes.starts_with(b"\xff\xd8\xff") => "image/jpeg",
        () if head.contains("<svg") => "image/svg+xml",
        () => {
            return Err((
                "the file is no PNG, JPEG or SVG".to_owned(),
                "save the logo in one of these forms".to_owned(),
            ));
        }
    };
    let data = BASE64_STANDARD.encode(&bytes);
    Ok(format!("data:{kind};base64,{data}"))
}
