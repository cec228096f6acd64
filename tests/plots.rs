//! Plots of made-up runs, ordinary and not.
#![allow(clippy::unwrap_used, clippy::too_many_lines, reason = "helpers and tables of tests")]

use cvtcycle::report::{bin_losses, fuel_bars, losses, operating_points};
use cvtcycle::results::Component;

#[allow(dead_code, reason = "shared with other tests")]
mod made_up;
use made_up::every::{all, every_plot};
use made_up::{CVT, phases, rows, run};

fn number_of(node: roxmltree::Node, name: &str) -> f64 {
    node.attribute(name).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
}

#[test]
fn every_plot_is_a_sound_and_accessible_picture() {
    for (name, svg) in every_plot() {
        assert!(svg.len() < 400_000, "{name}: {} bytes", svg.len());
        let document = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{name}: {e}"));
        let root = document.root_element();
        assert_eq!(root.attribute("role"), Some("img"));
        let first: Vec<_> = root.children().filter(roxmltree::Node::is_element).take(2).collect();
        assert_eq!(first[0].tag_name().name(), "title");
        assert_eq!(first[1].tag_name().name(), "desc");
        assert!(first.iter().all(|node| node.text().is_some_and(|text| text.len() > 10)), "{name}");
        let (width, height) = (number_of(root, "width"), number_of(root, "height"));
        let view = format!("0 0 {} {}", 4.0 * width, 4.0 * height);
        assert_eq!(root.attribute("viewBox"), Some(view.as_str()), "{name}");
        for node in document.descendants().filter(roxmltree::Node::is_element) {
            for attribute in node.attributes() {
                let value = attribute.value();
                assert!(!value.contains("NaN") && !value.contains("inf"), "{name}: {value}");
            }
            if node.has_tag_name((root.tag_name().namespace().unwrap(), "text")) {
                assert_eq!(node.attribute("font-family"), Some("sans-serif"));
                let (x, y) = (number_of(node, "x"), number_of(node, "y"));
                assert!(x >= 0.0 && x <= 4.0 * width && y >= 0.0 && y <= 4.0 * height, "{name}");
            }
        }
    }
}

#[test]
fn legends_lie_beside_the_data() {
    let mut entries = 0;
    for (name, svg) in every_plot() {
        let document = roxmltree::Document::parse(&svg).unwrap();
        let class = |node: &roxmltree::Node, class| node.attribute("class") == Some(class);
        let plots: Vec<_> = document.descendants().filter(|node| class(node, "plot")).collect();
        assert!(!plots.is_empty(), "{name}");
        let legends = document.descendants().filter(|node| class(node, "legend"));
        for node in legends.flat_map(|legend| legend.descendants()) {
            let x = ["x", "x1", "cx"].map(|key| number_of(node, key)).into_iter().find(|x| x.is_finite());
            let Some(x) = x else { continue };
            let left = x - node.attribute("r").map_or(0.0, |_| number_of(node, "r"));
            entries += 1;
            for plot in &plots {
                assert!(left > number_of(*plot, "x") + number_of(*plot, "width"), "{name}");
            }
        }
    }
    assert!(entries > 100);
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document.descendants().filter(|node| node.tag_name().name() == "text");
    texts.filter_map(|node| node.text().map(|text| text.trim().to_string())).collect()
}

#[test]
fn axes_series_and_names_can_be_read_as_text() {
    let (phases, rows) = (phases(), rows(1180, 1.0, true));
    let run = run("Car & <CVT>", true, &rows, &phases);
    let wanted: [(&str, &[&str]); 6] = [
        ("driveline", &["Vehicle speed [km/h]", "Belt ratio [-]", "Engine speed [rpm]", "Time [s]", "ECE 1", "EUDC", "200", "1000"]),
        ("pressure", &["Pressure [bar]", "Secondary", "Primary", "Vehicle speed", "Time [s]"]),
        (
            "temperatures",
            &[
                "Temperature [\u{b0}C]",
                "Coolant",
                "Engine oil",
                "Transmission sump",
                "Transmission metal",
                "Belt spray",
                "Cooler outlet",
                "Time [s]",
            ],
        ),
        ("losses", &["Loss power [W]", "Time [s]"]),
        ("operating_points", &["Engine speed [rpm]", "Engine torque [Nm]", "Full load", "Consumption [g/kWh]", "Time spent [s]", "255"]),
        ("fuel_bars", &["Fuel [L/100 km]", "ECE 15", "EUDC", "total", "9.30", "6.10", "7.32"]),
    ];
    for ((plot, svg), (name, words)) in all(&run).into_iter().zip(wanted) {
        assert_eq!(plot, name);
        let texts = texts(&svg);
        for word in words.iter().chain(&["Car & <CVT>"]) {
            assert!(texts.iter().any(|text| text == word), "{name} lacks {word}: {texts:?}");
        }
        assert!(!texts.iter().any(|text| text.contains("200.0")), "{name}");
    }
    let losses = texts(&losses(&run));
    for component in CVT {
        let start = component.name().replace('_', " ");
        assert!(losses.iter().any(|text| text.to_lowercase().starts_with(&start)), "{start}");
    }
}

#[test]
fn a_name_that_does_not_fit_is_still_in_the_file() {
    let (phases, rows) = (phases(), rows(20, 1.0, true));
    let name = "very long name ".repeat(20);
    for (plot, svg) in all(&run(name.trim(), true, &rows, &phases)) {
        let document = roxmltree::Document::parse(&svg).unwrap();
        let titles = document.descendants().filter(|node| node.tag_name().name() == "title");
        assert!(titles.filter_map(|n| n.text()).any(|text| text.contains(name.trim())), "{plot}");
        assert!(texts(&svg).iter().all(|text| text.chars().count() < 160), "{plot}");
    }
}

#[test]
fn stacked_losses_keep_their_energy() {
    let mut uneven = rows(2000, 0.7, true);
    for (i, row) in uneven.iter_mut().enumerate() {
        row.dt_s = if i % 3 == 0 { 0.2 } else { 0.95 };
    }
    for rows in [rows(1180, 1.0, true), rows(30_000, 0.1, true), uneven, rows(7, 1.0, true), rows(1, 0.5, true)] {
        let bins = bin_losses(&rows, 300);
        assert!(bins.mean_w.len() <= 300 && bins.edges_s.len() == bins.mean_w.len() + 1);
        assert!(bins.edges_s.is_sorted());
        for component in Component::ALL {
            let sum: f64 = rows.iter().map(|row| row.loss_w[component as usize] * row.dt_s).sum();
            let error = (bins.energy_j(component) - sum).abs();
            assert!(error <= 1e-11 * sum, "{}: {error} J of {sum} J", component.name());
        }
    }
}

#[test]
fn bars_stand_on_zero_and_are_as_high_as_their_values() {
    let (phases, rows) = (phases(), rows(10, 1.0, true));
    let run = run("car", true, &rows, &phases);
    let svg = fuel_bars(std::slice::from_ref(&run));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let bars: Vec<_> = document.descendants().filter(|n| n.attribute("class") == Some("bar")).collect();
    let scale = number_of(bars[0], "height") / run.group_fuel[0].1;
    for (bar, (_, fuel)) in bars.iter().zip(&run.group_fuel) {
        assert!((number_of(*bar, "height") / scale - fuel).abs() < 0.01);
    }
    assert_eq!(bars.len(), run.group_fuel.len());
}

#[test]
fn circles_have_areas_in_proportion_to_time() {
    let (phases, rows) = (phases(), rows(1180, 1.0, true));
    let svg = operating_points(&run("car", true, &rows, &phases));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let spots = document.descendants().filter(|n| n.attribute("class") == Some("spot"));
    let area: f64 = spots.map(|spot| number_of(spot, "r").powi(2)).sum();
    let key = texts(&svg).into_iter().find_map(|t| t.strip_suffix(" s")?.parse::<f64>().ok()).unwrap();
    let largest = document
        .descendants()
        .filter(|n| n.tag_name().name() == "circle" && n.attribute("class").is_none())
        .map(|n| number_of(n, "r"))
        .fold(0.0, f64::max);
    let seconds = area / largest.powi(2) * key;
    assert!((seconds - 1180.0).abs() < 12.0, "{seconds}");
}
