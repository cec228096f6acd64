//! Renders a document as HTML or Markdown, by the templates in `reports/`.

use std::fmt;

use askama::Template;
use askama::filters::Escaper;

use super::charts::Picture;
use super::document::{Block, Document, ReportTable, Section};
use super::live_section::ControlKind;
use super::number::typeset;
use cvtcycle_config::visible;
use cvtcycle_output::{Component, PROGRAM};

/// Answer of a live section.
#[derive(Template)]
#[template(path = "live_answer.html")]
struct LiveAnswer<'a> {
    section: ShownSection<'a>,
}

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
    /// True for the first section, a separate page on paper.
    first: bool,
    id: &'a str,
    title: &'a str,
    blocks: Vec<ShownBlock<'a>>,
}

/// A block with its number among the tables or the figures of the document; empty for other blocks.
struct ShownBlock<'a> {
    block: &'a Block,
    /// Number of a figure or a table. Other views of a figure share its number and add a letter, so that no number is missing on paper.
    number: String,
    /// File name of a figure.
    file: String,
}

/// Escapes text for HTML, with hidden characters as U+FFFD.
#[derive(Clone, Copy)]
pub(crate) struct Html;

impl Escaper for Html {
    fn write_escaped_str<W: fmt::Write>(&self, dest: W, text: &str) -> fmt::Result {
        askama::filters::Html.write_escaped_str(dest, &visible(text))
    }
}

/// Renders the document as one self-contained HTML page.
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

/// Renders the blocks of a live section as HTML, with figures numbered from `first_figure`.
pub(crate) fn live(section: &Section, first_figure: usize) -> String {
    let mut numbering = Numbering {
        figures: first_figure.saturating_sub(1),
        ..Numbering::default()
    };
    let section = numbering.section(false, section, &mut std::iter::empty());
    // Templates of this program cannot fail.
    LiveAnswer { section }.render().unwrap_or_default()
}

/// Renders the document as Markdown; its figures are the SVG files in the folder with the address `figures`.
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
    // Collapses the blank lines that the template leaves between blocks.
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

fn sections(document: &Document) -> Vec<ShownSection<'_>> {
    let mut numbering = Numbering::default();
    let mut files = document.figures().map(|(file, _)| file);
    let sections = document.sections.iter().enumerate();
    let sections = sections.map(|(k, of)| numbering.section(k == 0, of, &mut files));
    sections.collect()
}

/// Numbers of the last figure, of its last view, and of the last table.
#[derive(Default)]
struct Numbering {
    figures: usize,
    views: u8,
    tables: usize,
}

impl Numbering {
    fn number(&mut self, block: &Block) -> String {
        match block {
            Block::Table(_) | Block::Folded(_) => {
                self.tables += 1;
                self.tables.to_string()
            }
            Block::Figure(figure) if figure.view.as_ref().is_some_and(|view| !view.first) => {
                self.views += 1;
                format!("{}{}", self.figures, char::from(b'a' + self.views.min(25)))
            }
            Block::Figure(_) => {
                (self.figures, self.views) = (self.figures + 1, 0);
                self.figures.to_string()
            }
            _ => String::new(),
        }
    }

    fn section<'a>(
        &mut self,
        first: bool,
        of: &'a Section,
        files: &mut dyn Iterator<Item = String>,
    ) -> ShownSection<'a> {
        let shown = |block: &'a Block| {
            let number = self.number(block);
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
        ShownSection {
            first,
            id: &of.id,
            title: &of.title,
            blocks: of.blocks.iter().map(shown).collect(),
        }
    }
}

/// Names of the components as in cells, in small letters.
fn component_names() -> String {
    let names = Component::ALL.map(|component| component.name().replace('_', " "));
    names.join(",").to_lowercase()
}

/// The paragraphs of a remark.
fn paragraphs(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty())
}

/// Maximum height of a drawing at which two fit on a page of A4, pixels.
const TWO_A_PAGE: f64 = 580.0;

/// True for a drawing too tall for two on a page: scaled down its text would be illegible.
fn is_tall(svg: &str) -> bool {
    let height = svg.split(" height=\"").nth(1);
    let height = height.and_then(|rest| rest.split('"').next());
    height
        .and_then(|text| text.parse().ok())
        .is_some_and(|height: f64| height > TWO_A_PAGE)
}

/// The drawing of a figure for a narrow screen.
fn narrow_drawing(picture: &Picture, number: &str) -> Option<String> {
    let svg = picture.narrow.svg()?;
    Some(with_own_ids(&svg, &format!("{number}n")))
}

/// Makes the ids of a drawing unique within the page.
fn with_own_ids(svg: &str, number: &str) -> String {
    svg.replace(" id=\"", &format!(" id=\"f{number}-"))
        .replace("url(#", &format!("url(#f{number}-"))
}

/// Length from which on a key or a path may break at its joints.
const LONG_KEY: usize = 12;
/// Number of digits of a shortened hash, and of a whole one.
const HASH: (usize, usize) = (12, 64);

/// Formats text in HTML: typeset, escaped, with breaks only between words and at the joints of keys; `fold` shortens hashes.
fn flowing(text: &str, fold: bool) -> String {
    let text = typeset(text);
    let words = text.split(' ').map(|word| match is_hash(word) {
        true if fold => format!(
            "<span class=\"hash\" title=\"{word}\">{}\u{2026}</span>",
            &word[..HASH.0]
        ),
        true => format!("<span class=\"hash\">{word}</span>"),
        false => jointed(&escaped(word)),
    });
    coded(&words.collect::<Vec<_>>().join(" "))
}

/// Marks terminal input in HTML: the text between each pair of backticks.
fn coded(html: &str) -> String {
    let mut out = String::with_capacity(html.len());
    let mut rest = html;
    while let Some((before, [code, after])) = rest
        .split_once('`')
        .and_then(|(before, rest)| Some((before, <[&str; 2]>::from(rest.split_once('`')?))))
    {
        out += &format!("{before}<code>{code}</code>");
        rest = after;
    }
    out + rest
}

fn is_hash(word: &str) -> bool {
    word.len() == HASH.1 && word.bytes().all(|b| b.is_ascii_hexdigit())
}

fn escaped(text: &str) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = Html.write_escaped_str(&mut out, text);
    out
}

/// Adds places to break to a key, after its points, lines and strokes; other words are unchanged.
fn jointed(word: &str) -> String {
    let joint = |c: char| "_./:=".contains(c);
    let is_key = word.chars().count() >= LONG_KEY
        && word.contains(joint)
        && !word.contains('\u{a0}')
        && word.contains(|c: char| c.is_alphabetic());
    if !is_key {
        return word.to_owned();
    }
    let mut out = "<span class=\"key\">".to_owned();
    let mut rest = word.chars().peekable();
    while let Some(c) = rest.next() {
        out.push(c);
        if joint(c) && rest.peek().is_some_and(|next| next.is_alphanumeric()) {
            out += "<wbr>";
        }
    }
    out + "</span>"
}

/// True for a table with hashes, which are then shortened.
fn has_hashes(table: &ReportTable) -> bool {
    let mut cells = table.rows.iter().flat_map(|row| &row.cells);
    cells.any(|cell| is_hash(cell))
}

/// Hashes among facts.
fn hashes_of(facts: &[(String, String)]) -> Vec<&(String, String)> {
    facts.iter().filter(|(_, value)| is_hash(value)).collect()
}

/// Filters of the templates.
mod filters {
    use std::fmt::Display;

    use cvtcycle_output::escape;

    /// Escapes text for Markdown and the HTML in it.
    #[askama::filter_fn]
    pub fn md(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(escape::markdown(&super::typeset(&text.to_string())))
    }

    /// Typesets text, before escaping.
    #[askama::filter_fn]
    pub fn typeset(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(super::typeset(&text.to_string()))
    }

    /// Formats text as HTML with places to break keys, and shortened hashes.
    #[askama::filter_fn]
    pub fn flow(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(super::flowing(&text.to_string(), true))
    }

    /// As [`flow`], with whole hashes.
    #[askama::filter_fn]
    pub fn whole(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(super::flowing(&text.to_string(), false))
    }

    /// Unit as printed.
    #[askama::filter_fn]
    pub fn unit(unit: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(crate::number::sign(&unit.to_string()).to_owned())
    }

    /// Escapes text for the quotes of a style sheet.
    #[askama::filter_fn]
    pub fn css(text: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        let text = super::typeset(&text.to_string());
        let code = |c: char| match c {
            c if c.is_alphanumeric() || " ,.()".contains(c) => c.to_string(),
            c => format!("\\{:x} ", u32::from(c)),
        };
        Ok(super::visible(&text).chars().map(code).collect())
    }

    /// Encodes a file name for an address.
    #[askama::filter_fn]
    pub fn url(name: impl Display, _: &dyn askama::Values) -> askama::Result<String> {
        Ok(escape::url_path(name.to_string().as_bytes()))
    }
}
