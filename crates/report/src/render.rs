//! A document in its form: HTML or Markdown, by the templates in `reports/`.

use askama::Template;

use super::document::{Block, Document, Figure, ReportTable, table_of};
use cvtcycle_output::PROGRAM;

#[derive(Template)]
#[template(path = "review.html")]
struct Page<'a> {
    program: &'static str,
    document: &'a Document,
    sections: Vec<ShownSection<'a>>,
}

#[derive(Template)]
#[template(path = "review.md", escape = "none")]
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
    blocks: Vec<Shown<'a>>,
}

/// A block with what only the whole document knows: numbers of figures, labels that occur once.
enum Shown<'a> {
    Lead(&'a str),
    Text(&'a str),
    Alert(&'a str),
    Remark(Vec<&'a str>),
    Heading(&'a str),
    List(&'a [String]),
    Facts(&'a [(String, String)]),
    Table(ShownTable),
    Folded(ShownTable),
    Figure(ShownFigure<'a>),
}

struct ShownTable {
    table: ReportTable,
    label: String,
}

struct ShownFigure<'a> {
    name: &'a str,
    number: usize,
    caption: &'a str,
    svg: String,
    shown: ShownTable,
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

fn sections(document: &Document) -> Vec<ShownSection<'_>> {
    let (mut figures, mut tables) = (0, 0);
    let section = |section: &super::document::Section| Vec::with_capacity(section.blocks.len());
    let mut list = Vec::new();
    for own in &document.sections {
        let mut blocks = section(own);
        for block in &own.blocks {
            blocks.push(shown(block, &mut figures, &mut tables));
        }
        list.push(ShownSection {
            id: &own.id,
            title: &own.title,
            blocks,
        });
    }
    list
}

fn shown<'a>(block: &'a Block, figures: &mut usize, tables: &mut usize) -> Shown<'a> {
    let mut labelled = |table: &ReportTable| {
        *tables += 1;
        ShownTable {
            table: table.clone(),
            label: format!("Table {tables}: {}", table.caption),
        }
    };
    match block {
        Block::Lead(text) => Shown::Lead(text),
        Block::Text(text) => Shown::Text(text),
        Block::Alert(text) => Shown::Alert(text),
        Block::Remark(text) => Shown::Remark(
            text.lines()
                .map(str::trim)
                .filter(|line| !line.is_empty())
                .collect(),
        ),
        Block::Heading(text) => Shown::Heading(text),
        Block::List(items) => Shown::List(items),
        Block::Facts(facts) => Shown::Facts(facts),
        Block::Table(table) => Shown::Table(labelled(table)),
        Block::Folded(table) => Shown::Folded(labelled(table)),
        Block::Figure(figure) => {
            *figures += 1;
            Shown::Figure(shown_figure(figure, *figures))
        }
    }
}

fn shown_figure(figure: &Figure, number: usize) -> ShownFigure<'_> {
    let table = table_of(
        &format!("Numbers of figure {number}"),
        &figure.picture.table,
    );
    ShownFigure {
        name: &figure.name,
        number,
        caption: &figure.caption,
        svg: apart(&figure.picture.svg, number),
        shown: ShownTable {
            label: format!("Figure {number}, numbers"),
            table,
        },
    }
}

/// A drawing whose ids no other drawing of the page has.
fn apart(svg: &str, number: usize) -> String {
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

#[cfg(test)]
mod tests {
    use super::super::document::Section;
    use super::*;
    use crate::charts::{Picture, PictureTable};

    fn document() -> Document {
        let mut section = Section::new("one", "First <b>");
        section.text("a & b < c | d * e");
        section
            .blocks
            .push(Block::Remark("<script>alert(1)</script>\n\nsecond".into()));
        let mut table = PictureTable::new(&[("time", "s"), ("speed", "km/h")]);
        table.push(vec!["1".into(), "\u{2212}2.5".into()]);
        let svg = "<svg><defs><pattern id=\"p\"/></defs><rect fill=\"url(#p)\"/></svg>".to_owned();
        section.figure(
            "x",
            "What <is> seen",
            Picture {
                svg: svg.clone(),
                table: table.clone(),
            },
        );
        section.figure("y", "Again", Picture { svg, table });
        Document {
            title: "T \"q\" <i>".into(),
            sections: vec![section],
            ..Document::default()
        }
    }

    #[test]
    fn words_stay_words_and_ids_stay_apart_in_html() {
        let page = html(&document()).unwrap_or_else(|e| unreachable!("{e}"));
        assert!(!page.contains("<script>alert") && page.contains("alert(1)"));
        assert!(!page.contains("<b>") && !page.contains("<i>") && !page.contains("What <is>"));
        assert!(
            page.contains("id=\"f1-p\"")
                && page.contains("url(#f2-p)")
                && !page.contains("url(#p)")
        );
        assert!(
            page.contains("class=\"numbers\""),
            "a true minus is a number's sign"
        );
        assert!(page.contains("Figure 2.") && page.contains("Table of figure 2"));
    }

    #[test]
    fn words_stay_words_in_markdown() {
        let text = markdown(&document(), "figures").unwrap_or_else(|e| unreachable!("{e}"));
        assert!(text.contains("a &amp; b &lt; c \\| d \\* e"), "{text}");
        assert!(!text.contains("<script>"));
        assert!(text.contains("](figures/x.svg)"));
        assert!(
            text.contains("| time [s] | speed [km/h] |") || text.contains("Figure 1."),
            "{text}"
        );
        assert!(!text.contains("\n\n\n"));
    }
}
