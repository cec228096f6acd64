//! Losses of the transmission by component: a panel of bars for each car.
use super::bar_rows::{at_end, axis_with_room, bar, label_room, left_for, name, rows_panel, tall};
use super::{TOP, WIDTH, component_words, energy, percent, sound};
use crate::charts::figure::{Anchor, Figure, INK, fit};
use crate::charts::panel::BELOW;
use crate::charts::style::component_fill;
use crate::charts::{Picture, PictureTable, cell};
use cvtcycle_output::Component;

/// Losses of one car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarLosses {
    /// Name of the car.
    pub name: String,
    /// Energy lost by each component over the cycle, kJ, in the order of the power flow.
    pub losses_kj: Vec<(Component, f64)>,
}

impl CarLosses {
    /// All of them, kJ.
    #[must_use]
    pub fn total_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| sound(*kj)).sum()
    }
}

const HEADING: f64 = 24.0;
const GAP: f64 = 16.0;

/// Losses over the cycle by component, in the order of the power flow, with their share of the car's transmission loss.
#[must_use]
pub fn loss_by_component(cars: &[CarLosses]) -> Picture {
    let subject = match cars {
        [car] => car.name.clone(),
        _ => format!(
            "{} cars, one scale; components in the order of the power flow",
            cars.len()
        ),
    };
    let panels: f64 = cars
        .iter()
        .map(|car| HEADING + tall(car.losses_kj.len()) + GAP)
        .sum();
    let height = TOP + panels.max(HEADING + tall(1) + GAP) - GAP + BELOW + 8.0;
    let mut figure = Figure::new(
        (WIDTH, height),
        14.0,
        "Transmission losses by component",
        &subject,
        &describe(cars),
    );
    let mut table = PictureTable::new(&[
        ("car", ""),
        ("component", ""),
        ("energy", "kJ"),
        ("share of the transmission's loss", "%"),
    ]);
    let values: Vec<f64> = cars
        .iter()
        .flat_map(|car| car.losses_kj.iter().map(|(_, kj)| sound(*kj)))
        .collect();
    let words: Vec<String> = cars
        .iter()
        .flat_map(|car| car.losses_kj.iter().map(|(c, _)| component_words(*c)))
        .collect();
    let left = left_for(words.iter().map(String::as_str));
    let labels = cars.iter().flat_map(|car| {
        car.losses_kj
            .iter()
            .map(|(_, kj)| label(*kj, car.total_kj()))
    });
    let room = label_room(labels);
    let axis = axis_with_room(
        "Energy lost over the cycle [kJ]",
        left,
        values.into_iter(),
        room,
    );
    let mut top = TOP;
    for (k, car) in cars.iter().enumerate() {
        let total = car.total_kj();
        let heading = format!("{}: {} in all", fit(&car.name, 12.0, 500.0), energy(total));
        figure.text(
            (left, top + 15.0),
            12.0,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            &heading,
        );
        top += HEADING;
        let panel = rows_panel(
            &mut figure,
            (left, top),
            car.losses_kj.len(),
            axis.clone(),
            k + 1 == cars.len(),
        );
        for (row, (component, kj)) in car.losses_kj.iter().enumerate() {
            let words = component_words(*component);
            let at = table.push(vec![
                car.name.clone(),
                words.clone(),
                cell(*kj, 0.01),
                cell(100.0 * kj / total, 0.01),
            ]);
            let paint = component_fill(&mut figure, "parts", *component);
            name(&mut figure, &panel, row, &words, false);
            bar(&mut figure, &panel, row, (0.0, sound(*kj)), &paint, at);
            at_end(
                &mut figure,
                &panel,
                row,
                sound(*kj),
                false,
                &label(*kj, total),
            );
        }
        if car.losses_kj.is_empty() {
            panel.empty(&mut figure);
        }
        panel.outline(&mut figure);
        top = panel.rect.bottom + GAP;
    }
    if cars.is_empty() {
        rows_panel(&mut figure, (left, top + HEADING), 1, axis, true).empty(&mut figure);
    }
    Picture {
        svg: figure.finish(),
        table,
    }
}

fn label(kj: f64, total: f64) -> String {
    let share = percent(kj, total);
    if share.is_empty() {
        energy(kj)
    } else {
        format!("{}, {share}", energy(kj))
    }
}

fn describe(cars: &[CarLosses]) -> String {
    let told = |car: &CarLosses| {
        let total = car.total_kj();
        let part = |(c, kj): &(Component, f64)| {
            format!(
                "{} {} {}",
                component_words(*c).to_lowercase(),
                energy(*kj),
                percent(*kj, total)
            )
        };
        let parts: Vec<String> = car.losses_kj.iter().map(part).collect();
        format!(
            "{}: {} in all; {}",
            car.name,
            energy(total),
            parts.join(", ")
        )
    };
    format!(
        "Energy lost by component over the cycle. {}.",
        cars.iter().map(told).collect::<Vec<_>>().join(". ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    fn car(name: &str, losses: &[(Component, f64)]) -> CarLosses {
        CarLosses {
            name: name.to_owned(),
            losses_kj: losses.to_vec(),
        }
    }

    #[test]
    fn bars_are_in_proportion_and_shares_are_of_the_own_car() {
        let cars = [
            car(
                "one",
                &[
                    (Component::Pump, 550.0),
                    (Component::BeltBand, 400.0),
                    (Component::BeltFilm, 0.01),
                    (Component::FinalDrive, 0.0),
                ],
            ),
            car(
                &"long & odd <name> ".repeat(12),
                &[(Component::Churning, 275.0)],
            ),
        ];
        let picture = loss_by_component(&cars);
        check(&picture);
        let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
        let width = |row: &str| {
            let bar = doc.descendants().find(|n| {
                n.attribute("class") == Some("bar") && n.attribute("data-row") == Some(row)
            });
            bar.and_then(|n| n.attribute("width"))
                .and_then(|w| w.parse::<f64>().ok())
                .unwrap_or(0.0)
        };
        assert!(
            (width("0") / width("4") - 2.0).abs() < 0.01,
            "one scale for all cars"
        );
        assert!((width("0") / width("1") - 550.0 / 400.0).abs() < 0.01);
        let shares: f64 = picture.table.rows[..4]
            .iter()
            .map(|row| numbers(&row[3]))
            .sum();
        assert!((shares - 100.0).abs() < 0.03);
        assert_eq!(picture.table.rows[4][3], "100.00");
    }

    #[test]
    fn nothing_or_broken_numbers_are_still_pictures() {
        for cars in [
            vec![],
            vec![car("", &[])],
            vec![car(
                "x",
                &[(Component::Seal, f64::NAN), (Component::Bearing, 0.0)],
            )],
        ] {
            check(&loss_by_component(&cars));
        }
    }
}
