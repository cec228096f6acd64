//! Pictures are valid, readable and correct.

use super::drawn::{every_plot, names, sample};
use cvtcycle::report::charts::Picture;
use cvtcycle::report::charts::study::{
    DistributionSeries, KnownValue, Shown, distribution_plot, sobol_plot, tornado_plot,
};
use cvtcycle::study::statistics::{Estimate, FactorIndices, SobolIndices, TornadoInput, tornado};
use roxmltree::{Document, Node};

fn number(node: Node, name: &str) -> f64 {
    node.attribute(name)
        .and_then(|text| text.parse().ok())
        .unwrap_or(f64::NAN)
}

fn class<'a>(document: &'a Document, class: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    document
        .descendants()
        .filter(move |node| node.attribute("class") == Some(class))
}

/// Shift of the base line, em.
fn shift(dy: &str) -> f64 {
    let ex = dy
        .strip_suffix("ex")
        .map(|n| 0.5 * n.parse::<f64>().unwrap());
    ex.unwrap_or_else(|| dy.trim_end_matches("em").parse().unwrap())
}

/// Box of a text in canvas units: left, top, right, bottom. Uses the widths of a narrow font, so that texts which nearly touch do not count as overlapping.
fn text_box(node: Node) -> [f64; 4] {
    let text = node.text().unwrap_or("").trim();
    let digits = node
        .attribute("font-size")
        .unwrap_or("")
        .trim_end_matches("px")
        .to_owned();
    let size: f64 = digits.parse().unwrap();
    let width = 0.5 * size * text.chars().count() as f64;
    let (x, y) = (number(node, "x"), number(node, "y"));
    let down = node.attribute("dy").map_or(0.0, |dy| shift(dy) * size);
    let from = match node.attribute("text-anchor") {
        Some("middle") => -0.5 * width,
        Some("end") => -width,
        _ => 0.0,
    };
    match node.attribute("transform") {
        None => [x + from, y + down - 0.7 * size, x + from + width, y + down],
        // Rotated text is rotated by a right angle about its position.
        Some(turn) => {
            let about: Vec<f64> = turn
                .trim_start_matches("rotate(")
                .trim_end_matches(')')
                .split([' ', ','])
                .filter(|n| !n.is_empty())
                .map(|n| n.trim().parse().unwrap())
                .collect();
            assert!(
                (about[0].abs() - 90.0).abs() < 1e-9 || (about[0] - 270.0).abs() < 1e-9,
                "{turn}"
            );
            [x + down - 0.7 * size, y - from - width, x + down, y - from]
        }
    }
}

#[test]
fn every_picture_is_sound_and_its_texts_fit_and_stay_apart() {
    let plots = every_plot();
    assert!(plots.len() > 70);
    for (name, picture) in plots {
        let svg = &picture.svg;
        assert!(svg.len() < 400_000, "{name}: {} bytes", svg.len());
        let document = Document::parse(svg).unwrap_or_else(|e| panic!("{name}: {e}"));
        let root = document.root_element();
        let (width, height) = (4.0 * number(root, "width"), 4.0 * number(root, "height"));
        assert_eq!(
            root.attribute("viewBox"),
            Some(format!("0 0 {width} {height}").as_str()),
            "{name}"
        );
        let first: Vec<_> = root.children().filter(Node::is_element).take(2).collect();
        assert_eq!(
            (first[0].tag_name().name(), first[1].tag_name().name()),
            ("title", "desc")
        );
        assert!(
            first
                .iter()
                .all(|node| node.text().is_some_and(|text| text.len() > 10)),
            "{name}"
        );
        for node in document.descendants().filter(Node::is_element) {
            for value in node.attributes().map(|a| a.value()) {
                assert!(
                    !value.contains("NaN") && !value.contains("inf"),
                    "{name}: {value}"
                );
            }
        }
        let texts: Vec<Node> = document
            .descendants()
            .filter(|n| n.tag_name().name() == "text")
            .collect();
        for text in &texts {
            let said = text.text().unwrap_or("");
            assert!(
                !said.contains("NaN") && !said.contains("inf "),
                "{name}: {said}"
            );
        }
        // On A4 a figure of 880 px has texts of 6.6 points.
        assert!(
            width <= 4.0 * 880.0 && height <= 4.0 * 1250.0,
            "{name}: {width} x {height}"
        );
        let size = |t: &Node| {
            t.attribute("font-size")
                .unwrap_or("")
                .trim_end_matches("px")
                .parse::<f64>()
                .unwrap()
        };
        assert!(texts.iter().all(|t| size(t) >= 44.0), "{name}: small text");
        let boxes: Vec<([f64; 4], &str)> = texts
            .iter()
            .map(|t| (text_box(*t), t.text().unwrap_or("").trim()))
            .filter(|(_, text)| !text.is_empty())
            .collect();
        for (i, (a, text)) in boxes.iter().enumerate() {
            assert!(
                a[0] >= 0.0 && a[1] >= 0.0 && a[2] <= width && a[3] <= height,
                "{name}: '{text}' at {a:?} outside {width} x {height}"
            );
            for (b, other) in &boxes[..i] {
                let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(apart, "{name}: '{text}' {a:?} over '{other}' {b:?}");
            }
        }
    }
}

#[test]
fn legends_lie_below_the_data() {
    let mut entries = 0;
    for (name, picture) in every_plot() {
        let document = Document::parse(&picture.svg).unwrap();
        let bottom = class(&document, "plot")
            .map(|plot| number(plot, "y") + number(plot, "height"))
            .fold(0.0, f64::max);
        assert!(bottom > 0.0, "{name}");
        for node in class(&document, "legend").flat_map(|legend| legend.descendants()) {
            let Some(y) = ["y", "y1"]
                .map(|key| number(node, key))
                .into_iter()
                .find(|y| y.is_finite())
            else {
                continue;
            };
            entries += 1;
            assert!(y > bottom, "{name}");
        }
    }
    assert!(entries > 200);
}

#[test]
fn every_mark_has_its_row_and_every_row_all_its_cells() {
    let mut marks = 0;
    for (name, Picture { svg, table, .. }) in every_plot() {
        assert!(
            !table.columns.is_empty()
                && table
                    .rows
                    .iter()
                    .all(|row| row.len() == table.columns.len()),
            "{name}"
        );
        let said = |cell: &String| !cell.contains("NaN") && !cell.contains("inf");
        assert!(
            table.rows.iter().flatten().all(said)
                && table.columns.iter().all(|(column, _)| !column.is_empty()),
            "{name}"
        );
        let document = Document::parse(&svg).unwrap();
        let over_table = document.descendants().any(|n| n.has_attribute("data-x0"));
        for node in document.descendants().filter(|n| {
            ["bar", "mark", "interval"]
                .iter()
                .any(|c| n.attribute("class") == Some(c))
        }) {
            marks += 1;
            match node
                .attribute("data-row")
                .map(|row| row.parse::<usize>().unwrap())
            {
                Some(row) => assert!(row < table.rows.len(), "{name}: {row}"),
                None => assert!(over_table, "{name}: a mark without its row"),
            }
        }
    }
    assert!(marks > 2000);
}

#[test]
fn truncated_texts_are_complete_in_the_file() {
    for (name, picture) in every_plot()
        .into_iter()
        .filter(|(name, _)| name.contains(" 30 "))
    {
        let document = Document::parse(&picture.svg).unwrap();
        let titles: Vec<&str> = document
            .descendants()
            .filter(|n| n.tag_name().name() == "title")
            .filter_map(|n| n.text())
            .collect();
        let shown: Vec<&str> = document
            .descendants()
            .filter(|n| n.tag_name().name() == "text")
            .filter_map(|n| n.text())
            .collect();
        // Indices are drawn for the six factors with the largest total index, their convergence for seven, effects for the twelve largest: here
        // approximately the first ones.
        let least = if name.starts_with("sobol") {
            3
        } else if name.starts_with("conv") {
            4
        } else if name.starts_with("effects") {
            8
        } else {
            30
        };
        for (k, full) in names(30).into_iter().enumerate() {
            assert!(
                picture
                    .table
                    .rows
                    .iter()
                    .flatten()
                    .any(|cell| *cell == full),
                "{name}: {full} is not in the table"
            );
            // A factor with one level has no effect, and is drawn last.
            if k >= least || name.starts_with("effects") && k % 4 == 3 {
                continue;
            }
            assert!(
                titles.iter().any(|title| title.starts_with(&full))
                    || shown
                        .iter()
                        .any(|text| text.trim() == full
                            || text.trim() == format!("{full} [\u{b0}C]")),
                "{name} lacks {full}"
            );
        }
        assert!(
            shown
                .iter()
                .any(|text| text.contains('\u{2026}') && text.starts_with("trans")),
            "{name}"
        );
    }
}

fn estimate(value: f64, half: f64) -> Estimate {
    Estimate {
        value,
        interval: Some([value - half, value + half]),
    }
}

#[test]
fn bars_are_as_long_as_their_indices_and_sorted() {
    let factor = |first: f64, total: f64| FactorIndices {
        first: estimate(first, 0.02),
        total: estimate(total, 0.03),
    };
    let indices = SobolIndices {
        samples: 512,
        missing: 2,
        variance: 1.0,
        factors: vec![factor(0.1, 0.2), factor(0.5, 0.6), factor(-0.04, 0.1)],
        sum_first: estimate(0.56, 0.05),
        resamples: 1000,
    };
    let names = ["a".to_owned(), "b".to_owned(), "c".to_owned()];
    let picture = sobol_plot(
        &Shown {
            output: "Fuel",
            ..Shown::default()
        },
        &names,
        &indices,
    );
    let document = Document::parse(&picture.svg).unwrap();
    let rows: Vec<&str> = class(&document, "row").filter_map(|n| n.text()).collect();
    assert_eq!(rows, ["b", "a", "c"]);
    let widths: Vec<f64> = class(&document, "bar")
        .map(|bar| number(bar, "width"))
        .collect();
    let unit = widths[1] / 0.6;
    for (width, truth) in widths.iter().zip([0.5, 0.6, 0.1, 0.2, 0.04, 0.1]) {
        assert!(
            (width - unit * truth).abs() < 3.0,
            "{width} against {}",
            unit * truth
        );
    }
    // The negative one ends where the others begin.
    let left: Vec<f64> = class(&document, "bar")
        .map(|bar| number(bar, "x"))
        .collect();
    assert!((left[4] + widths[4] - left[0]).abs() < 3.0);
    let spans: Vec<f64> = class(&document, "interval")
        .map(|n| number(n, "x2") - number(n, "x1"))
        .filter(|w| *w > 0.0)
        .collect();
    for (k, span) in spans.iter().enumerate() {
        let half = if k.is_multiple_of(2) { 0.02 } else { 0.03 };
        assert!((span - unit * 2.0 * half).abs() < 3.0, "{span}");
    }
    assert_eq!(spans.len(), 6);
    let said: Vec<&str> = document
        .descendants()
        .filter(|n| n.tag_name().name() == "text")
        .filter_map(|n| n.text())
        .collect();
    assert!(
        said.join(" ").contains("0.560 (0.510 to 0.610)")
            && said
                .join(" ")
                .contains("512 samples; 2 left out, for a value"),
        "{said:?}"
    );
    let cells: Vec<&str> = picture.table.rows[1].iter().map(String::as_str).collect();
    assert_eq!(
        cells,
        ["a", "0.100", "0.080", "0.120", "0.200", "0.170", "0.230"]
    );
}

#[test]
fn a_tornado_says_where_low_and_high_lead() {
    let input = |name: &str, low: f64, high: f64| TornadoInput {
        name: name.to_owned(),
        entries: vec![("0.1".to_owned(), low), ("0.3".to_owned(), high)],
    };
    let found = tornado(
        7.0,
        &[
            input("falling", 7.2, 6.9),
            input("rising", 6.5, 7.4),
            input("one side", 7.1, 7.05),
        ],
    );
    let shown = Shown {
        output: "Fuel",
        unit: "L/100 km",
        subject: "a study",
        ..Shown::default()
    };
    let Picture { svg, table, .. } = tornado_plot(&shown, &found);
    let document = Document::parse(&svg).unwrap();
    let rows: Vec<&str> = class(&document, "row").filter_map(|n| n.text()).collect();
    assert_eq!(rows, ["rising", "falling", "one side"]);
    let bars: Vec<(f64, f64)> = class(&document, "bar")
        .map(|bar| (number(bar, "x"), number(bar, "width")))
        .collect();
    // Increasing: low ends at the base, high begins there; lengths 0.5 and 0.4.
    let base = bars[1].0;
    assert!(
        (bars[0].0 + bars[0].1 - base).abs() < 3.0 && (bars[0].1 / bars[1].1 - 1.25).abs() < 0.01
    );
    // Decreasing: the low value points to the right.
    assert!((bars[2].0 - base).abs() < 3.0 && bars[3].0 < base);
    let heights: Vec<f64> = class(&document, "bar")
        .map(|bar| number(bar, "y"))
        .collect();
    assert!(
        heights[4] < heights[5] && (heights[2] - heights[3]).abs() < 1.0,
        "ends on one side lie below each other"
    );
    assert!(
        svg.contains("Base: 7.00 L/100 km") || svg.contains("Base: 7.000 L/100 km"),
        "{svg}"
    );
    assert!(svg.contains("Change against the base [L/100 km]"));
    let cells: Vec<&str> = table.rows[0].iter().map(String::as_str).collect();
    assert_eq!(
        cells,
        ["rising", "0.1", "\u{2212}0.500", "0.3", "0.400", "0.900"]
    );
    let last = table.columns.last().unwrap();
    assert_eq!((last.0.as_str(), last.1), ("Swing", "L/100 km"));
}

fn lone(values: &[f64], known: KnownValue) -> Picture {
    let series = [DistributionSeries {
        name: "cvt - manual",
        values,
        known,
    }];
    let shown = Shown {
        output: "Fuel, total",
        unit: "L/100 km",
        subject: "a study",
        ..Shown::default()
    };
    let Ok(picture) = distribution_plot(&shown, &series, true);
    picture
}

/// Truth: quantiles of the values by hand. A hundred dots of a thousand values are those of 0.5, 1.5 ... 99.5 %.
#[test]
fn dots_are_equal_shares_of_the_values() {
    let values: Vec<f64> = (0..1000).map(|i| f64::from(i) / 100.0 - 2.0).collect();
    let picture = lone(&values, KnownValue::default());
    let document = Document::parse(&picture.svg).unwrap();
    assert_eq!(class(&document, "dot").count(), 100);
    let rows = picture
        .table
        .rows
        .iter()
        .filter(|row| numbers(&row[1]).is_finite());
    for (k, row) in rows.enumerate() {
        let share = k as f64 + 0.5;
        assert!((numbers(&row[1]) - share).abs() < 0.051, "{row:?}");
        assert!(
            (numbers(&row[2]) - (share / 10.0 - 2.0)).abs() < 0.02,
            "{row:?}"
        );
    }
    // Dots are within half a stack of their values, and within the row.
    let plot = class(&document, "plot").next().unwrap();
    let (top, bottom) = (
        number(plot, "y"),
        number(plot, "y") + number(plot, "height"),
    );
    let places: Vec<(f64, f64)> = class(&document, "dot")
        .map(|dot| (number(dot, "cx"), number(dot, "cy")))
        .collect();
    assert!(places.iter().all(|(_, y)| *y > top && *y < bottom));
    assert!(places.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    let (first, last) = (places[0].0, places[99].0);
    for (k, (x, _)) in places.iter().enumerate() {
        let own = first + (last - first) * k as f64 / 99.0;
        assert!(
            (x - own).abs() < number(plot, "width") / 55.0,
            "{k}: {x} {own}"
        );
    }
}

fn numbers(cell: &str) -> f64 {
    crate::titles::number(cell)
}

#[test]
fn the_share_above_zero_is_written_and_what_is_below_shaded() {
    let values = sample(4, 777, 0.1, 0.4);
    let above = values.iter().filter(|x| **x > 0.0).count();
    let mut gaps = values.clone();
    gaps.push(f64::NAN);
    let known = KnownValue {
        nominal: Some(0.31),
        published: Some([0.4, 0.6]),
    };
    let Picture { svg, table, .. } = lone(&gaps, known);
    assert!(
        svg.contains(&format!("is above zero in {above} of 777 pairs"))
            && svg.contains("1 missing")
    );
    assert!(svg.contains("Difference: Fuel, total [L/100 km]"));
    let document = Document::parse(&svg).unwrap();
    let count = |name: &str| class(&document, name).count();
    assert_eq!([count("below"), count("mark"), count("printed")], [1, 2, 1]);
    let cell = |what: &str| {
        let own = table.rows.iter().find(|row| row[1] == what);
        numbers(&own.unwrap()[2])
    };
    assert!(
        (cell("nominal values") - 0.31).abs() < 0.006 && (cell("published") - 0.5).abs() < 0.006
    );
    let always = lone(&[1.0, 2.0, 3.0], KnownValue::default());
    assert!(
        !always.svg.contains("class=\"below\""),
        "nothing lies below zero"
    );
}
