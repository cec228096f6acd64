//! Forms of a report: HTML, Markdown, and the cover.

use cvtcycle::report::charts::{Picture, PictureTable};
use cvtcycle::report::cover::Cover;
use cvtcycle::report::document::{Block, Document, Section};
use cvtcycle::report::render::{html, markdown};

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
        page.contains("id=\"f1-p\"") && page.contains("url(#f2-p)") && !page.contains("url(#p)")
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

fn written(text: &str, logo: &[u8]) -> (tempfile::TempDir, String) {
    let dir = tempfile::tempdir().unwrap_or_else(|e| unreachable!("{e}"));
    let path = dir.path().join("cover.toml");
    let done = std::fs::write(&path, text)
        .and_then(|()| std::fs::write(dir.path().join("logo.svg"), logo));
    assert!(done.is_ok());
    let name = path.display().to_string();
    (dir, name)
}

#[test]
fn a_cover_comes_before_the_sections_own_words() {
    let (_dir, path) = written(
        "title = \"Mine\"\nauthor = \"A\"\ndate = \"today\"\nlogo = \"logo.svg\"\n[remarks]\nanswer = \"so\"\nengine = \"none\"",
        b"<svg/>",
    );
    let cover = Cover::read(&path).unwrap_or_else(|p| unreachable!("{p:?}"));
    let mut section = Section::new("answer", "Answer");
    section.text("own");
    let mut document = Document {
        title: "own".into(),
        sections: vec![section],
        ..Document::default()
    };
    cover.apply(&mut document);
    assert_eq!(
        (document.title.as_str(), document.byline.len()),
        ("Mine", 2)
    );
    assert_eq!(
        document.logo.as_ref().map(|l| l.0.as_str()),
        Some("data:image/svg+xml;base64,PHN2Zy8+")
    );
    assert!(matches!(&document.sections[0].blocks[0], Block::Remark(text) if text == "so"));
    assert!(document.warnings.len() == 1 && document.warnings[0].contains("engine"));
}

#[test]
fn all_problems_are_reported_at_once() {
    let (_dir, path) = written(
        "titel = \"x\"\nauthor = 3\nlogo = \"logo.svg\"\n[remarks]\nloses = \"x\"",
        b"GIF89a",
    );
    let problems = Cover::read(&path).err().unwrap_or_default();
    let keys: Vec<&str> = problems.iter().map(|p| p.key.as_str()).collect();
    assert_eq!(problems.len(), 4, "{problems:?}");
    for key in ["titel", "author", "logo", "remarks.loses"] {
        assert!(keys.contains(&key), "{keys:?}");
    }
    assert!(problems.iter().all(|p| p.place.line > 0), "{problems:?}");
    assert!(Cover::read("no/such.toml").is_err_and(|p| p[0].message.contains("cannot read")));
}
