//! Forms of a report: HTML, Markdown, and the cover; number formats.

use cvtcycle::report::charts::{Picture, PictureTable};
use cvtcycle::report::cover::Cover;
use cvtcycle::report::document::{Block, Document, ReportTable, Section};
use cvtcycle::report::number::{NONE, Quantity, capital, degc, percent, phase, tiny, typeset};
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
            ..Picture::default()
        },
    );
    let again = Picture {
        svg,
        table,
        ..Picture::default()
    };
    section.figure("y", "Again", again);
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

/// Hidden characters are displayed in every form.
#[test]
fn hidden_characters_are_seen_in_every_form() {
    let mut document = document();
    document.title = "T\u{1b}]0;x\u{7}\u{202e}\u{0}".into();
    for page in [html(&document), markdown(&document, "figures")] {
        let page = page.unwrap_or_else(|e| unreachable!("{e}"));
        let hidden = page.chars().find(|c| cvtcycle::config::is_hidden(*c));
        assert!(hidden.is_none(), "{hidden:?}");
        assert!(page.contains("T\u{fffd}"), "{page}");
    }
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

#[test]
fn a_number_keeps_its_unit_and_loses_a_rounded_sign() {
    assert_eq!(Quantity::Fuel.text(7.726), "7.73\u{a0}L/100\u{a0}km");
    assert_eq!(Quantity::Percent.signed(5.94), "+5.9\u{a0}%");
    assert_eq!(Quantity::Percent.signed(-0.01), "0.0\u{a0}%");
    assert_eq!(Quantity::Percent.signed(0.01), "0.0\u{a0}%");
    assert_eq!(Quantity::Percent.bare(-11.93), "\u{2212}11.9");
    assert_eq!(Quantity::Energy.text(27199.1), "27\u{202f}199\u{a0}kJ");
    assert_eq!(
        Quantity::Energy.bare_signed(-1234567.0),
        "\u{2212}1\u{202f}234\u{202f}567"
    );
    assert_eq!(
        (Quantity::Energy.bare(999.96), Quantity::Energy.bare(999.94)),
        ("1000".into(), "999.9".into())
    );
    assert_eq!(
        (phase("ece15"), phase("eudc"), phase("cold_transient")),
        ("ECE15".into(), "EUDC".into(), "cold transient".into())
    );
    assert_eq!(Quantity::Fuel.text(None), NONE);
    assert_eq!(Quantity::Fuel.text(f64::NAN), NONE);
    assert_eq!(
        (degc(-10.0), degc(-0.0), degc(22.5)),
        (
            "\u{2212}10\u{a0}\u{b0}C".into(),
            "0\u{a0}\u{b0}C".into(),
            "22.5\u{a0}\u{b0}C".into()
        )
    );
    assert_eq!(
        (percent(1.0, 8.0), tiny(Some(3.2e-15)), capital("belt_band")),
        ("12.5".into(), "3e\u{2212}15".into(), "Belt band".into())
    );
}

/// ISO 80000-1: a space between number and unit, and between multiplied units; a minus sign instead of a hyphen.
#[test]
fn texts_have_one_style_of_units_and_signs() {
    for (text, written) in [
        (
            "at -10 degC, +-2 Nm",
            "at \u{2212}10\u{a0}\u{b0}C, \u{b1}2\u{a0}N\u{a0}m",
        ),
        ("7 % more, 3 km.", "7\u{a0}% more, 3\u{a0}km."),
        ("Torque [Nm] and [degC]", "Torque [N\u{a0}m] and [\u{b0}C]"),
        (
            "-1 to 3, (-2), a-1, 2-3, x_-4",
            "\u{2212}1 to 3, (\u{2212}2), a-1, 2-3, x_-4",
        ),
        // Input as typed is kept.
        (
            "cvtcycle run --ambient -10 --out x",
            "cvtcycle run --ambient -10 --out x",
        ),
        ("`run -10 degC` at -5", "`run -10 degC` at \u{2212}5"),
        ("a.b_degc=-3 -3", "a.b_degc=-3 \u{2212}3"),
    ] {
        assert_eq!(typeset(text), written);
        assert_eq!(typeset(&typeset(text)), written, "twice is once");
    }
}

#[test]
fn keys_break_at_their_joints_and_hashes_are_folded() {
    let mut section = Section::new("one", "One");
    let hash = "0123456789abcdef".repeat(4);
    let mut table = ReportTable::textual("Files", &["Key", "SHA-256"]);
    table.row([
        "transmission.cvt.belt.band_offset_mm".to_owned(),
        hash.clone(),
    ]);
    section.table(table);
    section.text("`cvtcycle explain` and 12.5 L/100 km of <a_very.long_name>");
    let document = Document {
        sections: vec![section],
        ..Document::default()
    };
    let page = html(&document).unwrap_or_else(|e| unreachable!("{e}"));
    assert!(page.contains("transmission.<wbr>cvt.<wbr>belt.<wbr>band_<wbr>offset_<wbr>mm"));
    assert!(page.contains("<code>cvtcycle explain</code>"));
    assert!(!page.contains("<a_") && page.contains(";a_<wbr>very.<wbr>long_<wbr>name"));
    let shown = format!("title=\"{hash}\">0123456789ab\u{2026}</span>");
    let whole = format!("<span class=\"hash\">{hash}</span>");
    assert_eq!(
        (page.matches(&shown).count(), page.matches(&whole).count()),
        (1, 1)
    );
    let text = markdown(&document, "figures").unwrap_or_else(|e| unreachable!("{e}"));
    assert!(text.contains(&hash), "whole where nothing can be opened");
}
