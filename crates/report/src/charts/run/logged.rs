//! Quantities of a log over time, next to the computed ones.

use crate::charts::lines::{LineChart, LinePanel, Look, line_chart};
use crate::charts::picture::Picture;
use crate::number::grouped;
use cvtcycle_output::summary::{MeasuredSummary, RecordingSummary};

/// Titles of axes and headings by quantity.
const TITLES: [(&str, &str, &str); 5] = [
    ("engine_speed", "Engine speed", "Engine speed [rpm]"),
    ("fuel", "Fuel", "Fuel [g/s]"),
    ("coolant", "Coolant", "Temperature [degC]"),
    ("engine_oil", "Engine oil", "Temperature [degC]"),
    ("sump", "Transmission sump", "Temperature [degC]"),
];

/// Draws the quantities of a log and the computed ones; none of a log without such channels.
pub fn logged(recording: &RecordingSummary, car: &str, subject: &str) -> Option<Picture> {
    let [log, computed] = [0, 1].map(|index| Look {
        index,
        dotted: false,
    });
    let panel = |own: &MeasuredSummary| {
        let (_, heading, y_title) = TITLES.iter().find(|(name, ..)| *name == own.quantity)?;
        let line = |k: usize| {
            own.series
                .iter()
                .map(|point| (point[0], point[k]))
                .collect()
        };
        (!own.series.is_empty()).then(|| LinePanel {
            heading: (*heading).to_owned(),
            y_title,
            series: vec![(log, line(1)), (computed, line(2))],
            ..LinePanel::default()
        })
    };
    let panels: Vec<LinePanel> = recording.measured.iter().filter_map(panel).collect();
    let of_fuel = recording.measured.iter().find(|own| own.quantity == "fuel");
    let title = match of_fuel.filter(|own| own.measured > 0.0) {
        Some(own) => {
            let percent = 100.0 * (own.computed / own.measured - 1.0);
            let more = if percent < 0.0 { "less" } else { "more" };
            format!(
                "{car} burns {} % {more} than the log",
                grouped(percent.abs(), 1)
            )
        }
        None => format!("{car} and the log"),
    };
    (!panels.is_empty()).then(|| {
        line_chart(&LineChart {
            title,
            subject: subject.to_owned(),
            description: "Quantities of a log and those of the computed car.".to_owned(),
            x_title: "Time [s]",
            panels,
            names: vec![(log, "log".to_owned()), (computed, "computed".to_owned())],
            ..LineChart::default()
        })
    })
}
