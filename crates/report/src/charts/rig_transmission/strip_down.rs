//! Pictures of the strip-down test.

use super::plots::{
    LOSS, PRESSURE, Picture, SPEED, Subject, bulk_oil, by_temperature, degrees, distinct, line,
    panel, picture, points, same, words,
};
use crate::charts::lines::{LineChart, LinePanel, Look};
use cvtcycle_model::bench::transmission::{Piece, Stage, StripDown};
use cvtcycle_output::rig::oil_degc;

/// The strip-down: stages (Figs 5-17 to 5-27), contributions (5-33 to 5-40), components (5-41 to 5-45).
#[must_use]
pub fn strip_down(rows: &[StripDown], subject: &Subject) -> Vec<Picture> {
    type Draw = fn(&[StripDown], &Subject, f64) -> LineChart;
    let kinds: [(&str, Draw); 3] = [
        ("strip_down", stages),
        ("contributions", contributions),
        ("components", components),
    ];
    let mut pictures = Vec::new();
    for ratio in distinct(rows, |r| r.set.ratio) {
        for (kind, draw) in kinds {
            pictures.push(picture(subject, kind, ratio, &draw(rows, subject, ratio)));
        }
    }
    pictures
}

fn stage_words(stage: Stage) -> &'static str {
    match stage {
        Stage::Complete => "Complete",
        Stage::FinalDriveRemoved => "Final drive removed",
        Stage::BeltRemoved => "Belt removed",
        Stage::ClutchRemoved => "Clutch removed (in low)",
        Stage::PumpRemoved => "Pump removed: input shaft",
    }
}

fn piece_words(piece: Piece) -> &'static str {
    match piece {
        Piece::Pump => "Pump",
        Piece::InputShaft => "Input shaft",
        Piece::Clutch => "Reverse clutch",
        Piece::Belt => "Belt",
        Piece::FinalDrive => "Final drive",
    }
}

/// Torque loss and pressure after each part was removed.
fn stages(rows: &[StripDown], subject: &Subject, ratio: f64) -> LineChart {
    let names = degrees(&distinct(rows, |r| oil_degc(&r.set)));
    let mut panels = Vec::new();
    for stage in Stage::ALL {
        let words = stage_words(stage);
        let lines = |y: &dyn Fn(&StripDown) -> f64| by_temperature(rows, |r| &r.set, ratio, y);
        panels.push(panel(words, LOSS, lines(&|r| r.stage(stage).total_nm())));
        if stage != Stage::PumpRemoved {
            let pressure = lines(&|r| r.stage(stage).secondary_pa / 1e5);
            panels.push(panel(words, PRESSURE, pressure));
        }
    }
    LineChart {
        title: "Strip-down: torque loss and pressure of each stage".to_owned(),
        subject: subject.of(ratio, ""),
        description: words(
            "Torque loss and secondary pressure against input speed after each part removed, a line for each temperature",
            &names,
        ),
        x_title: SPEED,
        panels,
        legend: "Bulk oil".to_owned(),
        names,
        ..LineChart::default()
    }
}

/// The losses found by the strip-down, stacked.
fn contributions(rows: &[StripDown], subject: &Subject, ratio: f64) -> LineChart {
    let pieces = || Piece::ALL.into_iter().enumerate();
    let names = pieces().map(|(k, piece)| (line(k), piece_words(piece).to_owned()));
    let names: Vec<(Look, String)> = names.collect();
    let of = |degc: f64| {
        let layer = |(k, piece): (usize, Piece)| {
            let own = rows
                .iter()
                .filter(|r| same(r.set.ratio, ratio) && same(oil_degc(&r.set), degc));
            (
                line(k),
                points(own, |r| &r.set, |r| r.piece(piece).corrected_nm),
            )
        };
        LinePanel {
            stacked: true,
            ..panel(&bulk_oil(degc), LOSS, pieces().map(layer).collect())
        }
    };
    let temps = distinct(rows, |r| oil_degc(&r.set));
    LineChart {
        title: "Contributions to the torque loss, from the strip-down".to_owned(),
        subject: subject.of(ratio, ", corrected for pressure"),
        description: words(
            "Losses found by the strip-down, stacked, against input speed, a panel for each temperature",
            &names,
        ),
        x_title: SPEED,
        panels: temps.into_iter().map(of).collect(),
        same_y: true,
        legend: "From the strip-down".to_owned(),
        names,
        ..LineChart::default()
    }
}

/// Each component from the strip-down, and dotted its own loss in the complete box.
fn components(rows: &[StripDown], subject: &Subject, ratio: f64) -> LineChart {
    let dotted = |look: Look| Look {
        dotted: true,
        ..look
    };
    let temps = distinct(rows, |r| oil_degc(&r.set));
    let mut names = degrees(&temps);
    let own = temps.iter().enumerate();
    names.extend(own.map(|(k, t)| (dotted(line(k)), format!("{t} \u{b0}C, true"))));
    let of = |piece: Piece| {
        let lines = |y: &dyn Fn(&StripDown) -> f64| by_temperature(rows, |r| &r.set, ratio, y);
        let mut series = lines(&|r| r.piece(piece).corrected_nm);
        let own = lines(&|r| r.piece(piece).true_nm).into_iter();
        series.extend(own.map(|(look, points)| (dotted(look), points)));
        LinePanel {
            with_y: vec![0.0],
            ..panel(piece_words(piece), LOSS, series)
        }
    };
    LineChart {
        title: "Components from the strip-down and of the model".to_owned(),
        subject: subject.of(ratio, ", corrected for pressure"),
        description: words(
            "Loss of each component against input speed; dotted: its own loss in the complete box",
            &names,
        ),
        x_title: SPEED,
        panels: Piece::ALL.into_iter().map(of).collect(),
        legend: "Bulk oil".to_owned(),
        names,
        ..LineChart::default()
    }
}
