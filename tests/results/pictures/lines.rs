//! Charts of lines.

use cvtcycle::report::charts::lines::{LineChart, LinePanel, Look, line_chart};

fn lone(points: &[(f64, f64)]) -> LinePanel {
    LinePanel {
        y_title: "Force [N]",
        series: vec![(Look::default(), points.to_vec())],
        ..LinePanel::default()
    }
}

fn chart(panels: Vec<LinePanel>) -> LineChart {
    let names = vec![
        (Look::default(), "a".to_owned()),
        (
            Look {
                index: 1,
                dotted: false,
            },
            "b".to_owned(),
        ),
    ];
    LineChart {
        title: "t".to_owned(),
        x_title: "Speed [rpm]",
        panels,
        names,
        ..LineChart::default()
    }
}

#[test]
fn a_table_has_a_column_for_each_line_and_a_row_for_each_place() {
    let mut first = lone(&[(1000.0, 1.0), (2000.0, 2.5)]);
    first.heading = "cold".to_owned();
    first.series.push((
        Look {
            index: 1,
            dotted: false,
        },
        vec![(2000.0, f64::NAN), (3000.0, 4.0)],
    ));
    let second = LinePanel {
        heading: "warm".to_owned(),
        ..lone(&[(1000.0, -0.5)])
    };
    let picture = line_chart(&chart(vec![first, second]));
    let columns: Vec<(&str, &str)> = picture
        .table
        .columns
        .iter()
        .map(|(name, unit)| (name.as_str(), *unit))
        .collect();
    assert_eq!(
        columns,
        [
            ("Speed", "rpm"),
            ("cold: a", "N"),
            ("cold: b", "N"),
            ("warm: a", "N")
        ]
    );
    let rows: Vec<Vec<&str>> = picture
        .table
        .rows
        .iter()
        .map(|row| row.iter().map(String::as_str).collect())
        .collect();
    assert_eq!(
        rows,
        [
            vec!["1000", "1.000", "", "\u{2212}0.5000"],
            vec!["2000", "2.500", "", ""],
            vec!["3000", "", "4.000", ""]
        ]
    );
    assert!(
        picture
            .svg
            .contains("data-x0=\"1000.0\" data-x1=\"3000.0\""),
        "{}",
        picture.svg
    );
    assert!(
        picture.svg.contains("data-columns=\"1 2\"") && picture.svg.contains("data-columns=\"3\"")
    );
}

#[test]
fn panels_over_other_quantities_have_columns_of_their_own() {
    let own = LinePanel {
        x_title: "Pressure [bar]",
        ..lone(&[(10.0, 3.0)])
    };
    let picture = line_chart(&chart(vec![lone(&[(1000.0, 1.0)]), own]));
    assert_eq!(picture.table.columns.len(), 4);
    assert_eq!(
        picture
            .table
            .rows
            .iter()
            .map(|row| row[1].as_str())
            .collect::<Vec<_>>(),
        ["", "10"]
    );
    assert!(
        !picture.svg.contains("data-x0"),
        "no column is the axis of both"
    );
}

#[test]
fn long_tables_are_thinned_and_say_so() {
    let points: Vec<(f64, f64)> = (0..1300).map(|i| (f64::from(i), 1.0)).collect();
    let picture = line_chart(&chart(vec![lone(&points)]));
    assert_eq!(picture.table.rows.len(), 434);
    assert!(picture.table.note.contains("in 3"));
}

#[test]
fn lines_that_turn_back_keep_their_order_and_gaps_stay_gaps() {
    let back = line_chart(&chart(vec![lone(&[(0.0, 0.0), (10.0, 1.0), (5.0, 2.0)])]));
    assert_eq!(
        back.svg.matches("stroke-width=\"8.8\"").count(),
        2,
        "the line and its entry"
    );
    let gap = line_chart(&chart(vec![lone(&[
        (0.0, 0.0),
        (1.0, 1.0),
        (2.0, f64::NAN),
        (3.0, 1.0),
        (4.0, 0.0),
    ])]));
    let doc = roxmltree::Document::parse(&gap.svg).expect("well-formed");
    let line = doc
        .descendants()
        .find(|node| node.attribute("class") == Some("series"))
        .and_then(|node| node.attribute("d"))
        .expect("a line");
    assert_eq!(line.matches('M').count(), 2, "{line}");
    assert!(!gap.svg.contains("NaN"));
}

#[test]
fn a_chart_without_lines_is_valid() {
    for empty in [
        LineChart::default(),
        chart(vec![LinePanel::default()]),
        chart(vec![lone(&[(f64::NAN, 1.0)])]),
    ] {
        let picture = line_chart(&empty);
        assert!(picture.svg.ends_with("</svg>\n") && !picture.svg.contains("inf"));
    }
    assert!(line_chart(&chart(vec![lone(&[])])).svg.contains("no data"));
}

#[test]
fn many_lines_in_words_are_the_span_of_each_quantity() {
    let curve = |k: u32| {
        let height = f64::from(k);
        let look = Look::solid(k as usize);
        (look, vec![(1000.0, height), (2000.0, 10.0 * height)])
    };
    let force = LinePanel {
        series: (1..=4).map(curve).collect(),
        ..lone(&[])
    };
    let heat = LinePanel {
        y_title: "Heat [W]",
        series: (5..=8).map(curve).collect(),
        ..LinePanel::default()
    };
    let said = |panels: Vec<LinePanel>| {
        let svg = line_chart(&chart(panels)).svg;
        let words = svg.split("<desc>").nth(1).expect("a picture in words");
        words.split("</desc>").next().unwrap_or_default().to_owned()
    };
    assert_eq!(
        said(vec![force.clone(), heat]),
        "Force [N], Heat [W] over Speed [rpm]. Speed [rpm] from 1000 to 2000; Force [N] from 1.00 to 40.0; Heat [W] from 5.0 to 80.0."
    );
    let few = said(vec![lone(&[(1.0, 2.0), (3.0, 4.0)])]);
    assert!(
        few.starts_with("Force [N] over Speed [rpm]. Speed [rpm], "),
        "{few}"
    );
}
