//! Checks for every picture.

use cvtcycle::report::charts::Picture;

/// Canvas units per pixel.
const UNITS: f64 = 4.0;

/// Approximate width of a text in a wide sans-serif face.
fn text_width(text: &str, size: f64) -> f64 {
    let ems = text.chars().map(|c| match c {
        c if "ijl.,:;|'!()[] ".contains(c) => 0.4,
        c if "mwMW%@".contains(c) => 1.0,
        c if c as u32 >= 0x1100 => 1.05,
        c if c.is_uppercase() => 0.75,
        _ => 0.64,
    });
    ems.sum::<f64>() * size
}

/// Parses a table cell.
pub fn numbers(text: &str) -> f64 {
    text.replace('\u{2212}', "-").parse().unwrap_or(f64::NAN)
}

struct Box {
    text: String,
    x: (f64, f64),
    y: (f64, f64),
}

/// Checks numbers, texts that overlap or leave the canvas, a width within A4, a table row for each mark, and equal lengths of rows; and the drawing for
/// a phone, with text of 11 px at 360 px.
pub fn check(picture: &Picture) {
    let rows = picture.table.rows.len();
    check_drawing(&picture.svg, rows, 880.0);
    if let Some(narrow) = picture.narrow.svg() {
        check_drawing(&narrow, rows, 360.0);
    }
    for row in &picture.table.rows {
        assert_eq!(row.len(), picture.table.columns.len(), "{row:?}");
        assert!(
            !row.iter()
                .any(|cell| cell.contains("NaN") || cell.contains("inf")),
            "{row:?}"
        );
    }
}

/// Checks a drawing, whose title is whole.
pub fn check_drawing(svg: &str, rows: usize, most_wide: f64) {
    let doc = roxmltree::Document::parse(svg).expect("well-formed");
    let size = |name: &str| {
        doc.root_element()
            .attribute(name)
            .and_then(|x| x.parse::<f64>().ok())
            .expect("a size")
    };
    let (width, height) = (size("width"), size("height"));
    assert!(
        width <= most_wide && height > 100.0 && height < 4000.0,
        "{width} {height}"
    );
    let mut boxes: Vec<Box> = Vec::new();
    for node in doc.descendants() {
        for attribute in node.attributes() {
            let value = attribute.value();
            assert!(
                attribute.name() == "id" || !(value.contains("NaN") || value.contains("inf")),
                "{attribute:?}"
            );
        }
        if let Some(row) = node.attribute("data-row") {
            assert!(
                row.parse::<usize>().is_ok_and(|row| row < rows),
                "row {row}"
            );
        }
        if node.has_tag_name("text") {
            let found = text_box(&node);
            // A frame without numbers on its axis has empty labels.
            boxes.extend((!found.text.is_empty()).then_some(found));
        }
    }
    for (k, a) in boxes.iter().enumerate() {
        assert!(
            a.x.0 > -0.5 && a.y.0 > -0.5 && a.x.1 < width + 0.5 && a.y.1 < height + 0.5,
            "outside: {} {:?} {:?}",
            a.text,
            a.x,
            a.y
        );
        for b in &boxes[k + 1..] {
            let apart = a.x.1 <= b.x.0 || b.x.1 <= a.x.0 || a.y.1 <= b.y.0 || b.y.1 <= a.y.0;
            assert!(
                apart,
                "'{}' {:?} {:?} over '{}' {:?} {:?}",
                a.text, a.x, a.y, b.text, b.x, b.y
            );
        }
    }
    let bold = |node: &roxmltree::Node| node.attribute("font-weight") == Some("bold");
    let title = doc
        .descendants()
        .find(|node| node.has_tag_name("text") && bold(node));
    let title = title.and_then(|node| node.text()).unwrap_or_default();
    assert!(!title.contains('\u{2026}'), "cut: {title}");
}

/// Approximate box of a text, pixels.
fn text_box(node: &roxmltree::Node) -> Box {
    let number = |name: &str| {
        node.attribute(name)
            .and_then(|x| x.parse::<f64>().ok())
            .unwrap_or(0.0)
            / UNITS
    };
    let text = node.text().unwrap_or("").trim().to_owned();
    let size = number("font-size");
    assert!(size >= 10.8, "small text: {text} {size}");
    let (x, y) = (number("x"), number("y"));
    let wide = 0.9 * text_width(&text, size);
    let start = match node.attribute("text-anchor") {
        Some("middle") => -0.5 * wide,
        Some("end") => -wide,
        _ => 0.0,
    };
    let (along, across) = ((start, start + wide), (-0.75 * size, 0.2 * size));
    if node.has_attribute("transform") {
        Box {
            text,
            x: (x + across.0, x + across.1),
            y: (y + along.0, y + along.1),
        }
    } else {
        Box {
            text,
            x: (x + along.0, x + along.1),
            y: (y + across.0, y + across.1),
        }
    }
}
