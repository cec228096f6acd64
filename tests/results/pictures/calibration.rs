//! Pictures of calibrations.

use super::svg_checks::{check, numbers};
use crate::titles::{assert_number, number, title, written};
use cvtcycle::calibrate::outcome::{Direction, Fold, Outcome, Parameter, Residual, SCHEMA, Start};
use cvtcycle::report::charts::Picture;
use cvtcycle::report::charts::calibration::{
    calibration_pictures, correlation_plot, parameters_plot, residuals_plot, scatter_plot,
    trace_plots,
};

#[path = "../../fixtures/outcome.rs"]
mod outcomes;
use outcomes::{every, named, noise};

#[test]
fn every_picture_is_tidy() {
    for (name, outcome) in every() {
        for (plot, picture) in calibration_pictures(&outcome) {
            println!("{name}: {plot}"); // shown where a check fails
            check(&picture);
            assert!(
                picture.svg.len() < 400_000,
                "{name}: {plot}: {} bytes",
                picture.svg.len()
            );
        }
    }
}

#[test]
fn a_picture_is_there_where_it_has_data() {
    let names = |name: &str| {
        calibration_pictures(&named(name))
            .into_iter()
            .map(|(plot, _)| plot)
            .collect::<Vec<_>>()
    };
    assert_eq!(
        names("ordinary"),
        [
            "measured_computed",
            "residuals",
            "parameters",
            "correlation"
        ]
    );
    let traces = [
        "trace_warm_up_transmission_sump_degc",
        "trace_warm_up_engine_coolant_degc",
    ];
    assert_eq!(names("mixed")[4..], traces);
    assert_eq!(
        names("one"),
        ["measured_computed", "residuals", "parameters"]
    );
    assert!(names("nothing").is_empty());
}

/// Asserts that a cell equals a number of the outcome, to half a unit in its last digit.
fn same(cell: &str, wanted: Option<f64>) {
    match wanted {
        None => assert_eq!(cell, ""),
        Some(x) => {
            let decimals = cell.split_once('.').map_or(0, |(_, after)| after.len());
            let step = 0.500_001 * 10f64.powi(-i32::try_from(decimals).unwrap_or(0));
            assert!((numbers(cell) - x).abs() <= step, "{cell} for {x}");
        }
    }
}

#[test]
fn tables_have_the_numbers_of_the_outcome() {
    let outcome = named("ordinary");
    let (scatter, residuals) = (scatter_plot(&outcome).table, residuals_plot(&outcome).table);
    assert_eq!((scatter.rows.len(), residuals.rows.len()), (24, 24));
    for ((r, row), of_sd) in outcome
        .residuals
        .iter()
        .zip(&scatter.rows)
        .zip(&residuals.rows)
    {
        assert_eq!((&row[0], &of_sd[0]), (&r.group, &r.group));
        for (cell, x) in row[3..]
            .iter()
            .zip([r.low, r.high, Some(r.sd), r.before, Some(r.after)])
        {
            same(cell, x);
        }
        for (cell, x) in of_sd[3..]
            .iter()
            .zip([r.before_sd, Some(r.after_sd), r.left_out_sd])
        {
            same(cell, x);
        }
    }
    for (p, row) in outcome
        .parameters
        .iter()
        .zip(&parameters_plot(&outcome).table.rows)
    {
        let prior = [
            p.prior.map(|x| x[0]),
            p.prior.map(|x| x[1]),
            p.prior_share.map(|x| 100.0 * x),
        ];
        let own = [
            Some(p.file_value),
            Some(p.value),
            p.standard_error,
            Some(p.low),
            Some(p.high),
        ];
        for (cell, x) in row[2..].iter().zip(own.into_iter().chain(prior)) {
            same(cell, x);
        }
    }
    let pairs = correlation_plot(&outcome).table.rows;
    assert_eq!(pairs.len(), 10);
    for (row, (i, j)) in pairs
        .iter()
        .zip((0..5).flat_map(|i| (0..i).map(move |j| (i, j))))
    {
        assert_eq!(
            (&row[0], &row[1]),
            (&outcome.parameters[i].name, &outcome.parameters[j].name)
        );
        same(&row[2], outcome.correlation[i][j]);
    }
}

#[test]
fn a_trace_has_a_row_for_each_value_up_to_600_and_draws_its_deviation() {
    let outcome = named("mixed");
    let (name, picture) = trace_plots(&outcome).remove(0);
    assert_eq!(
        (name.as_str(), picture.table.rows.len()),
        ("trace_warm_up_transmission_sump_degc", 590)
    );
    let own: Vec<&Residual> = outcome
        .residuals
        .iter()
        .filter(|r| r.column == "transmission_sump_degc")
        .collect();
    for (r, row) in own.iter().zip(&picture.table.rows) {
        for (cell, x) in row.iter().zip([
            r.time_s,
            r.low,
            Some(r.sd),
            r.before,
            Some(r.after),
            r.left_out,
        ]) {
            same(cell, x);
        }
    }
    assert!(picture.svg.contains("class=\"band\"") && !picture.svg.contains("Predicted"));
    assert_eq!(picture.svg.matches("class=\"series\"").count(), 3);
}

#[test]
fn marks_are_placed_at_their_numbers() {
    // A fitted residual of zero is in the middle of the grey band, which is symmetric.
    let mut outcome = named("one");
    (
        outcome.residuals[0].after_sd,
        outcome.residuals[0].before_sd,
        outcome.residuals[0].left_out_sd,
    ) = (0.0, Some(40.0), None);
    let picture = residuals_plot(&outcome);
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let number = |node: &roxmltree::Node, name: &str| {
        node.attribute(name)
            .and_then(|x| x.parse::<f64>().ok())
            .expect("a number")
    };
    let band = doc
        .descendants()
        .find(|node| node.attribute("class") == Some("band"))
        .expect("a band");
    let mark = doc
        .descendants()
        .find(|n| n.has_tag_name("circle") && n.has_attribute("data-row"))
        .expect("a mark");
    let centre = number(&band, "x") + 0.5 * number(&band, "width");
    assert!((number(&mark, "cx") - centre).abs() <= 2.0);
    // 40 standard deviations are beyond three times the others, and marked so.
    assert!(
        picture.table.note.contains("1 residuals"),
        "{}",
        picture.table.note
    );
    // With computed = measured the mark is on the diagonal of agreement.
    outcome.residuals[0].low = Some(outcome.residuals[0].after);
    outcome.residuals[0].high = outcome.residuals[0].low;
    let picture = scatter_plot(&outcome);
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let plot = doc
        .descendants()
        .find(|node| node.attribute("class") == Some("plot"))
        .expect("a frame");
    let mark = doc
        .descendants()
        .rfind(|n| n.has_tag_name("circle") && n.has_attribute("data-row"))
        .expect("a mark");
    let across = (number(&mark, "cx") - number(&plot, "x")) / number(&plot, "width");
    let up = 1.0 - (number(&mark, "cy") - number(&plot, "y")) / number(&plot, "height");
    assert!((across - up).abs() < 0.005, "{across} {up}");
}

#[test]
fn long_data_are_thinned_and_say_so() {
    const MAX_SHOWN: usize = 600;
    let outcome = named("mixed");
    let table = scatter_plot(&outcome).table;
    let shown = table.rows.len();
    assert!(shown <= MAX_SHOWN + 10 && shown > MAX_SHOWN / 2, "{shown}");
    let single = outcome.residuals.iter().filter(|r| r.time_s.is_none());
    let single: Vec<&str> = single.map(|r| r.label.as_str()).collect();
    let listed = table.rows.iter().filter(|row| {
        single
            .iter()
            .any(|label| row[1] == *label || row[1].starts_with(&format!("{label}: ")))
    });
    assert_eq!(listed.count(), 40, "single numbers are all shown");
    assert!(table.note.contains("of 1220 observations"));
    let all = scatter_plot(&named("hundred")).table;
    assert_eq!(all.rows.len(), named("hundred").residuals.len());
    assert!(!all.note.contains("observations are shown"));
    assert!(noise(3).abs() <= 1.0);
}

#[test]
fn unknown_correlations_are_crossed_out_and_strong_ones_written() {
    let outcome = named("ordinary");
    let picture = correlation_plot(&outcome);
    let unknown = outcome
        .correlation
        .iter()
        .flatten()
        .filter(|r| r.is_none())
        .count();
    assert_eq!(
        picture.svg.matches("stroke=\"#8c8c8c\"").count(),
        unknown - 1,
        "all but the diagonal"
    );
    let strong = (0..5)
        .flat_map(|i| (0..5).map(move |j| (i, j)))
        .filter(|(i, j)| i != j);
    let strong = strong
        .filter(|(i, j)| outcome.correlation[*i][*j].is_some_and(|r| r.abs() >= 0.5))
        .count();
    let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
    let written = doc
        .descendants()
        .filter(|n| n.has_tag_name("text"))
        .filter_map(|n| n.text());
    let written = written
        .map(|text| text.trim_start_matches('\u{2212}'))
        // Correlations of the colour key have one decimal.
        .filter(|text| text.len() == 4 && text.starts_with("0."))
        .count();
    assert!(strong > 0);
    assert_eq!(written, strong);
}

/// Title without the subject of the calibration.
fn sentence(picture: &Picture, outcome: &Outcome) -> String {
    let title = title(&picture.svg);
    let subject = outcome.title.replace('&', "&amp;");
    let subject = subject.replace('<', "&lt;").replace('>', "&gt;");
    title
        .split(&format!(": {subject}"))
        .next()
        .unwrap()
        .to_owned()
}

#[test]
fn titles_have_the_numbers_of_the_outcome() {
    for (name, outcome) in every() {
        if matches!(name, "nothing" | "odd") {
            continue;
        }
        let title_and_numbers = |picture: &Picture| {
            (
                sentence(picture, &outcome),
                written(&sentence(picture, &outcome)),
            )
        };
        let (text, said) = title_and_numbers(&scatter_plot(&outcome));
        let squares = |title_and_numbers: fn(&Residual) -> Option<f64>| {
            let all: Option<Vec<f64>> = outcome.residuals.iter().map(title_and_numbers).collect();
            all.map(|all| (all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt())
        };
        if let (Some(before), Some(after)) =
            (squares(|r| r.before_sd), squares(|r| Some(r.after_sd)))
        {
            assert_number(&said[0], before, &text);
            assert_number(said.last().unwrap(), after, &text);
        }
        let (text, said) = title_and_numbers(&residuals_plot(&outcome));
        let within = |title_and_numbers: fn(&Residual) -> Option<f64>| {
            let all = outcome.residuals.iter().filter_map(title_and_numbers);
            all.filter(|x| x.abs() <= 2.0).count() as f64
        };
        assert_number(&said[0], within(|r| Some(r.after_sd)), &text);
        assert_number(&said[1], outcome.residuals.len() as f64, &text);
        if said.len() > 2 {
            assert_number(&said[2], within(|r| r.left_out_sd), &text);
            let known = outcome.residuals.iter().filter(|r| r.left_out_sd.is_some());
            assert_number(&said[3], known.count() as f64, &text);
        }
        let (text, _) = title_and_numbers(&parameters_plot(&outcome));
        let least = outcome.parameters.iter().filter_map(|p| p.prior_share);
        let least = least.fold(f64::INFINITY, f64::min);
        assert_number(
            &written(text.split(": ").last().unwrap())[0],
            100.0 * least,
            &text,
        );
        let (text, said) = title_and_numbers(&correlation_plot(&outcome));
        let known = |(i, j): (usize, usize)| Some((outcome.correlation[i][j]?, i, j));
        let pairs = (0..outcome.parameters.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        if let Some((r, i, j)) = pairs
            .filter_map(known)
            .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        {
            for (said, wanted) in said.iter().zip([r, j as f64 + 1.0, i as f64 + 1.0]) {
                assert_number(said, wanted, &text);
            }
        }
    }
}

#[test]
fn the_title_of_a_trace_has_its_distance_from_the_measured_one() {
    let outcome = named("mixed");
    for (_, picture) in trace_plots(&outcome) {
        let text = sentence(&picture, &outcome);
        let rows = &picture.table.rows;
        let off = |column: usize| {
            let square = |row: &Vec<String>| (numbers(&row[column]) - numbers(&row[1])).powi(2);
            (rows.iter().map(square).sum::<f64>() / rows.len() as f64).sqrt()
        };
        let said = written(&text);
        // Cells are rounded.
        assert!(
            (number(&said[0]) - off(3)).abs() < 0.02,
            "{} {}: {text}",
            said[0],
            off(3)
        );
        assert!(
            (number(&said[1]) - off(4)).abs() < 0.02,
            "{} {}: {text}",
            said[1],
            off(4)
        );
    }
}
