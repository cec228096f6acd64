//! A document in its form: HTML or Markdown, by the templates in `reports/`.

use std::fmt;

use askama::Template;
use askama::filters::Escaper;

use super::document::{Block, Document};
use cvtcycle_config::visible;
use cvtcycle_output::PROGRAM;

#[derive(Template)]
#[template(path = "report.html")]
struct Page<'a> {
    program: &'static str,
    document: &'a Document,
    sections: Vec<ShownSection<'a>>,
}

#[derive(Template)]
#[template(path = "report.md", escape = "none")]
struct Text<'a> {
    program: &'static str,
    document: &'a Document,
    sections: Vec<ShownSection<'a>>,
    /// Address of the folder of figures.
    figures: &'a str,
}

struct ShownSection<'a> {
    id: &'a str,
    title: &'a str,
    blocks: Vec<ShownBlock<'a>>,
}

/// A block with its number among the tables or the figures of the document, which other blocks have no use for.
struct ShownBlock<'a> {
    block: &'a Block,
    number: usize,
    /// Name of the file of a figure.
    file: String,
}

/// Text of files in HTML: escaped, with hidden characters as U+FFFD.
#[derive(Clone, Copy)]
pub(crate) struct Html;

impl Escaper for Html {
    fn write_escaped_str<W: fmt::Write>(&self, dest: W, text: &str) -> fmt::Result {
        askama::filters::Html.write_escaped_str(dest, &visible(text))
    }
}

/// The document as one HTML page that loads nothing.
///
/// # Errors
/// Never for the templates of this program.
pub fn html(document: &Document) -> Result<String, String> {
    Page {
        program: PROGRAM,
        document,
        sections: sections(document),
    }
    .render()
    .map_err(|error| error.to_string())
}

/// The document as Markdown; its figures are the SVG files in the folder with the address `figures`.
///
/// # Errors
/// Never for the templates of this program.
pub fn markdown(document: &Document, figures: &str) -> Result<String, String> {
    let text = Text {
        program: PROGRAM,
        document,
        sections: sections(document),
        figures,
    };
    let text = text.render().map_err(|error| error.to_string())?;
    // What the template leaves between blocks.
    let mut out = String::with_capacity(text.len());
    let mut empty = 0;
    for line in text.lines().map(str::trim_end) {
        empty = if line.is_empty() { empty + 1 } else { 0 };
        if empty < 2 {
            out.push_str(line);
            out.push('\n');
        }
    }
    Ok(out)
}

fn sections<'a>(document: &'a Document) -> Vec<ShownSection<'a>> {
    let (mut figures, mut tables) = (0, 0);
    let mut files = document.figures().map(|(file, _)| file);
    let mut shown = |block: &'a Block| {
        let count = match block {
            Block::Table(_) | Block::Folded(_) => &mut tables,
            Block::Figure(_) => &mut figures,
            _ => &mut 0,
        };
        *count += 1;
        let number = *count;
        let file = match block {
            Block::Figure(_) => files.next().unwrap_or_default(),
            _ => String::new(),
        };
        ShownBlock {
            block,
            number,
            file,
        }
    };
    let sections = document.sections.iter();
    let sections = sections.map(|of| ShownSection {
        id: &of.id,
        title: &of.title,
        blocks: of.blocks.iter().map(&mut shown).collect(),
    });
    sections.collect()
}

/// The paragraphs of a remark.
fn paragraphs(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty())
}

/// A drawing whose ids no other drawing of the page has.
fn with_own_ids(svg: &str, number: &usize) -> String {
    svg.replace(" id=\"", &format!(" id=\"f{number}-"))
        .replace("url(#", &format!("url(#f{number}-"))
}

/// Filters of the templates.
mod filters {
    use std::fmt::Display;

    use cvtcycle_output::escape;

    /// Text that Markdown and HTML take as it is.
    #[askama::filter_fn]
    pub fn md(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(escape::markdown(&text.to_string()))
    }

    /// The name of a file as part of an address.
    #[askama::filter_fn]
    pub fn url(name: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(escape::url_path(name.to_string().as_bytes()))
    }
}
