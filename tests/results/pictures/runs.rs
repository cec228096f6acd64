//! Pictures of runs.

use cvtcycle::output::{Flags, Row};
use cvtcycle::report::charts::{
    Picture, bin_losses, fuel_bars, losses, operating_points, temperatures,
};

use super::svg_checks::check_drawing;
use crate::fixtures::every::{all, every_plot};
use crate::fixtures::{CVT, history, phases, rows, run};

fn number_of(node: roxmltree::Node, name: &str) -> f64 {
    node.attribute(name)
        .and_then(|text| text.parse().ok())
        .unwrap_or(f64::NAN)
}

#[test]
fn every_plot_is_a_sound_and_accessible_picture() {
    for (name, picture) in every_plot() {
        let svg = picture.svg;
        assert!(svg.len() < 400_000, "{name}: {} bytes", svg.len());
        let document = roxmltree::Document::parse(&svg).unwrap_or_else(|e| panic!("{name}: {e}"));
        let root = document.root_element();
        assert_eq!(root.attribute("role"), Some("img"));
        let first: Vec<_> = root
            .children()
            .filter(roxmltree::Node::is_element)
            .take(2)
            .collect();
        assert_eq!(first[0].tag_name().name(), "title");
        assert_eq!(first[1].tag_name().name(), "desc");
        assert!(
            first
                .iter()
                .all(|node| node.text().is_some_and(|text| text.len() > 10)),
            "{name}"
        );
        let (width, height) = (number_of(root, "width"), number_of(root, "height"));
        assert!(width <= 880.0, "{name}: {width} px do not fit on a page");
        let view = format!("0 0 {} {}", 4.0 * width, 4.0 * height);
        assert_eq!(root.attribute("viewBox"), Some(view.as_str()), "{name}");
        for node in document.descendants().filter(roxmltree::Node::is_element) {
            for attribute in node.attributes() {
                let value = attribute.value();
                assert!(
                    !value.contains("NaN") && !value.contains("inf"),
                    "{name}: {value}"
                );
            }
            if node.has_tag_name((root.tag_name().namespace().unwrap(), "text")) {
                assert_eq!(node.attribute("font-family"), Some("sans-serif"));
                assert!(
                    number_of(node, "font-size") >= 44.0 - 0.5,
                    "{name}: {:?} is small",
                    node.text()
                );
                let (x, y) = (number_of(node, "x"), number_of(node, "y"));
                assert!(
                    x >= 0.0 && x <= 4.0 * width && y >= 0.0 && y <= 4.0 * height,
                    "{name}"
                );
            }
        }
    }
}

/// On a phone every plot is 360 px wide with its text at 11 px; nothing leaves it, no text lies on another.
#[test]
fn every_plot_fits_on_a_phone() {
    let mut count = 0;
    for (name, picture) in every_plot() {
        let narrow = picture.narrow.svg();
        let narrow = narrow.unwrap_or_else(|| panic!("{name}: no drawing"));
        println!("{name}");
        check_drawing(&narrow, picture.table.rows.len(), 360.0);
        count += 1;
    }
    assert!(count > 40);
}

#[test]
fn legends_lie_below_the_data() {
    let mut entries = 0;
    for (name, picture) in every_plot() {
        let document = roxmltree::Document::parse(&picture.svg).unwrap();
        let class = |node: &roxmltree::Node, class| node.attribute("class") == Some(class);
        let plots: Vec<_> = document
            .descendants()
            .filter(|node| class(node, "plot"))
            .collect();
        assert!(!plots.is_empty(), "{name}");
        let legends = document.descendants().filter(|node| class(node, "legend"));
        for node in legends.flat_map(|legend| legend.descendants()) {
            let y = ["y", "y1", "cy"]
                .map(|key| number_of(node, key))
                .into_iter()
                .find(|y| y.is_finite());
            let Some(y) = y else { continue };
            entries += 1;
            for plot in &plots {
                assert!(
                    y > number_of(*plot, "y") + number_of(*plot, "height"),
                    "{name}"
                );
            }
        }
    }
    assert!(entries > 100);
}

#[test]
fn every_mark_has_its_row_and_every_row_all_columns() {
    for (name, picture) in every_plot() {
        let table = &picture.table;
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len()),
            "{name}"
        );
        assert!(
            table.rows.len() <= 3300,
            "{name}: {} rows",
            table.rows.len()
        );
        let document = roxmltree::Document::parse(&picture.svg).unwrap();
        let marks = document
            .descendants()
            .filter_map(|node| node.attribute("data-row"));
        assert!(
            marks
                .map(|row| row.parse::<usize>().unwrap())
                .all(|row| row < table.rows.len()),
            "{name}"
        );
        for plot in document
            .descendants()
            .filter(|node| node.attribute("data-x0").is_some())
        {
            let (from, to) = (number_of(plot, "data-x0"), number_of(plot, "data-x1"));
            assert!(from < to, "{name}");
            if to > 1e9 {
                continue; // written with an exponent and cut there
            }
            let mut times = table
                .rows
                .iter()
                .filter_map(|row| row[0].parse::<f64>().ok());
            assert!(
                times.all(|t| t >= from - 0.06 && t <= to * (1.0 + 1e-9) + 0.06),
                "{name}"
            );
        }
    }
}

#[test]
fn a_long_trace_is_listed_in_part_and_says_so() {
    let phases = phases();
    for (steps, listed, words) in [
        (600, 600, ""),
        (601, 301, "Every second step"),
        (30_000, 600, "Every 50th step"),
    ] {
        let history = history(true, &rows(steps, 0.1, true), &phases);
        let table = temperatures(&[run("car", &history)]).table;
        assert_eq!(table.rows.len(), listed);
        assert_eq!(
            table.note.contains("step is listed"),
            !words.is_empty(),
            "{}",
            table.note
        );
        assert!(
            table.note.contains(words)
                && (words.is_empty() || table.note.contains("trace_car.csv"))
        );
    }
    let history = history(true, &rows(100, 1.0, true), &phases);
    let table = temperatures(&[run("car", &history)]).table;
    let sump = table
        .columns
        .iter()
        .position(|(name, unit)| name == "Transmission sump" && *unit == "\u{b0}C")
        .unwrap();
    let wanted = history.column("transmission_sump_degc")[57];
    assert!(
        (table.rows[57][sump].parse::<f64>().unwrap() - wanted).abs() < 0.05
            && table.rows[57][0] == "58.0"
    );
}

fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let texts = document
        .descendants()
        .filter(|node| node.tag_name().name() == "text");
    texts
        .filter_map(|node| node.text().map(|text| text.trim().to_string()))
        .collect()
}

#[test]
fn axes_series_and_names_can_be_read_as_text() {
    let history = history(true, &rows(1180, 1.0, true), &phases());
    let run = run("Car & <CVT>", &history);
    let wanted: [(&str, &[&str]); 6] = [
        (
            "driveline",
            &[
                "Throttle [-]",
                "Vehicle speed [km/h]",
                "Belt ratio [-]",
                "Engine speed [rpm]",
                "Time [s]",
                "ECE 1",
                "EUDC",
                "200",
                "1000",
            ],
        ),
        (
            "pressure",
            &[
                "Pressure [bar]",
                "Secondary pressure",
                "Primary pressure",
                "Belt slip [%]",
                "Clamping used [%]",
                "Speed [km/h]",
                "Time [s]",
            ],
        ),
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
        ("losses", &["Energy lost, as fuel [L/100 km]", "Time [s]"]),
        (
            "operating_points",
            &[
                "Engine speed [rpm]",
                "Engine torque [N m]",
                "Full load",
                "Consumption [g/kWh]",
                "255",
            ],
        ),
        (
            "fuel_bars",
            &[
                "Fuel [L/100 km]",
                "ECE 15",
                "EUDC",
                "total",
                "9.30",
                "6.10",
                "7.32",
            ],
        ),
    ];
    for ((plot, picture), (name, words)) in all(&run).into_iter().zip(wanted) {
        assert_eq!(plot, name);
        let texts = texts(&picture.svg);
        for word in words.iter().chain(&["Car & <CVT>"]) {
            assert!(
                texts.iter().any(|text| text == word),
                "{name} lacks {word}: {texts:?}"
            );
        }
        assert!(!texts.iter().any(|text| text.contains("200.0")), "{name}");
    }
    let losses = texts(&losses(std::slice::from_ref(&run)).svg);
    for component in CVT {
        let start = component.group().name().replace('_', " ");
        assert!(
            losses
                .iter()
                .any(|text| text.to_lowercase().starts_with(&start)),
            "{start}"
        );
    }
}

#[test]
fn a_name_that_does_not_fit_is_still_in_the_file() {
    let history = history(true, &rows(20, 1.0, true), &phases());
    let name = "very long name ".repeat(20);
    for (plot, picture) in all(&run(name.trim(), &history)) {
        let svg = picture.svg;
        let document = roxmltree::Document::parse(&svg).unwrap();
        let titles = document
            .descendants()
            .filter(|node| node.tag_name().name() == "title");
        assert!(
            titles
                .filter_map(|n| n.text())
                .any(|text| text.contains(name.trim())),
            "{plot}"
        );
        assert!(
            texts(&svg).iter().all(|text| text.chars().count() < 160),
            "{plot}"
        );
    }
}

#[test]
fn stacked_losses_keep_their_energy() {
    let mut uneven = rows(2000, 0.7, true);
    for (i, row) in uneven.iter_mut().enumerate() {
        row.dt_s = if i % 3 == 0 { 0.2 } else { 0.95 };
    }
    for rows in [
        rows(1180, 1.0, true),
        rows(30_000, 0.1, true),
        uneven,
        rows(7, 1.0, true),
        rows(1, 0.5, true),
    ] {
        let bins = bin_losses(&history(true, &rows, &phases()), 300);
        assert!(bins.mean_w.len() <= 300 && bins.edges_s.len() == bins.mean_w.len() + 1);
        assert!(bins.edges_s.is_sorted());
        for component in CVT {
            let sum: f64 = rows
                .iter()
                .map(|row| row.loss_w[component] * row.dt_s)
                .sum();
            let error = (bins.energy_j(component) - sum).abs();
            assert!(
                error <= 1e-11 * sum,
                "{}: {error} J of {sum} J",
                component.name()
            );
        }
    }
}

#[test]
fn bars_start_at_zero_and_have_the_height_of_their_values() {
    let history = history(true, &rows(10, 1.0, true), &phases());
    let run = run("car", &history);
    let Picture { svg, table, .. } = fuel_bars(std::slice::from_ref(&run));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let bars: Vec<_> = document
        .descendants()
        .filter(|n| n.attribute("class") == Some("bar"))
        .collect();
    let scale = number_of(bars[0], "height") / run.group_fuel[0].1;
    for (bar, (_, fuel)) in bars.iter().zip(&run.group_fuel) {
        assert!((number_of(*bar, "height") / scale - fuel).abs() < 0.01);
    }
    assert_eq!(bars.len(), run.group_fuel.len());
    for (bar, (group, fuel)) in bars.iter().zip(&run.group_fuel) {
        let row = &table.rows[bar.attribute("data-row").unwrap().parse::<usize>().unwrap()];
        assert_eq!(
            row,
            &[group.clone(), "car".to_owned(), format!("{fuel:.2}")]
        );
    }
}

#[test]
fn cells_hold_all_time_in_which_the_engine_runs() {
    let mut off = rows(1180, 1.0, true);
    off[..100]
        .iter_mut()
        .for_each(|row| row.flags.set(Flags::ENGINE_OFF, true));
    let fast: Vec<Row> = rows(1180, 1.0, true)
        .into_iter()
        .map(|row| Row {
            engine_speed_rad_s: 30.0 * row.engine_speed_rad_s,
            ..row
        })
        .collect();
    for (rows, wanted) in [
        (rows(1180, 1.0, true), 1180.0),
        (off, 1080.0),
        (fast, 1180.0),
        (rows(400, 0.1, true), 40.0),
    ] {
        let history = history(true, &rows, &phases());
        let Picture { svg, table, .. } = operating_points(&[run("car", &history)]);
        let seconds: f64 = table
            .rows
            .iter()
            .map(|row| row[2].parse::<f64>().unwrap())
            .sum();
        assert!((seconds - wanted).abs() < 1e-6, "{seconds} s of {wanted} s");
        let document = roxmltree::Document::parse(&svg).unwrap();
        let mut drawn: Vec<usize> = document
            .descendants()
            .filter_map(|n| n.attribute("data-row")?.parse().ok())
            .collect();
        drawn.sort_unstable();
        assert_eq!(
            drawn,
            (0..table.rows.len()).collect::<Vec<_>>(),
            "a cell each row"
        );
        assert!(table.rows.len() > 20);
    }
}
