//! A document in its form: HTML or Markdown, by the templates in `reports/`.

use askama::Template;

use super::document::{Block, Document};
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
    /// Folder of the figures.
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

/// The document as Markdown; its figures are the SVG files in the folder `figures`.
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
    let mut shown = |block: &'a Block| {
        let count = match block {
            Block::Table(_) | Block::Folded(_) => &mut tables,
            Block::Figure(_) => &mut figures,
            _ => &mut 0,
        };
        *count += 1;
        let number = *count;
        ShownBlock { block, number }
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

    /// Text that Markdown and HTML take as it is.
    #[askama::filter_fn]
    pub fn md(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(super::plain_markdown(&text.to_string()))
    }
}

/// Text with everything that Markdown or HTML could take for markup escaped.
fn plain_markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '#' | '~' | '!' => {
                out.push('\\');
                out.push(c);
            }
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '\n' | '\r' | '\t' => out.push(' '),
            c => out.push(c),
        }
    }
    out
}
