//! Losses of the transmission by phase of the cycle: a stacked bar for each car, per distance.
use super::bar_rows::{at_end, axis_with_room, bar, label_room, left_for, name, rows_panel, tall};
use super::{TOP, WIDTH, component_words, grouped, sound};
use crate::charts::figure::{Anchor, Figure, INK, fit};
use crate::charts::legend::{Mark, below_height, legend_below};
use crate::charts::panel::BELOW;
use crate::charts::style::component_fill;
use crate::charts::{Picture, PictureTable, cell};
use cvtcycle_output::Component;

/// Losses of one car by component, in the order of the power flow.
pub type CarParts = Vec<(Component, f64)>;

/// Losses by phase group and car.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseLosses {
    /// The cycle and its conditions.
    pub subject: String,
    /// Names of the cars.
    pub cars: Vec<String>,
    /// For each phase group its name and, for each car, the loss of each component over the group's distance, kJ/km.
    pub groups: Vec<(String, Vec<CarParts>)>,
}

const HEADING: f64 = 23.0;
const GAP: f64 = 12.0;
/// Left edge of the legend, pixels.
const LEGEND: f64 = 40.0;

/// Loss per distance of each phase group, stacked by component in the order of the power flow. A group without any finite loss, such as a
/// soak, in which no distance is driven, is left out.
#[must_use]
pub fn loss_by_phase(of: &PhaseLosses) -> Picture {
    let (of, left_out) = told_groups(of);
    let of = &of;
    let used = used(of);
    let left = left_for(of.cars.iter().map(String::as_str));
    let names: Vec<String> = used.iter().map(|c| component_words(*c)).collect();
    let count = of.groups.len().max(1) as f64;
    let bottom = TOP + count * (HEADING + tall(of.cars.len()) + GAP) - GAP + BELOW + 8.0;
    let size = (
        WIDTH,
        bottom + below_height(names.iter().map(String::as_str), WIDTH - LEGEND - 20.0, "") + 8.0,
    );
    let mut figure = Figure::new(
        size,
        14.0,
        "Transmission losses by phase, per distance",
        &of.subject,
        &describe(of),
    );
    let mut table = PictureTable::new(&[
        ("phase", ""),
        ("car", ""),
        ("component", ""),
        ("loss", "kJ/km"),
    ]);
    if !left_out.is_empty() {
        table.note = format!(
            "Left out, for there is no loss per distance: {}.",
            left_out.join(", ")
        );
    }
    let sums: Vec<f64> = of
        .groups
        .iter()
        .flat_map(|(_, cars)| cars.iter().map(|parts| sum(parts)))
        .collect();
    let room = label_room(sums.iter().map(|sum| grouped(*sum, 1)));
    let axis = axis_with_room(
        "Loss of the transmission [kJ/km]",
        left,
        sums.iter().copied(),
        room,
    );
    let paints: Vec<String> = used
        .iter()
        .map(|c| component_fill(&mut figure, "phase", *c))
        .collect();
    let mut top = TOP;
    for (g, (group, cars)) in of.groups.iter().enumerate() {
        figure.text(
            (left, top + 15.0),
            12.0,
            Anchor::Start,
            "font-weight=\"bold\"",
            INK,
            &fit(group, 12.0, 600.0),
        );
        let panel = rows_panel(
            &mut figure,
            (left, top + HEADING),
            of.cars.len(),
            axis.clone(),
            g + 1 == of.groups.len(),
        );
        for (row, (car, parts)) in of.cars.iter().zip(cars).enumerate() {
            name(&mut figure, &panel, row, car, false);
            let mut base = 0.0;
            for (component, loss) in parts {
                let at = table.push(vec![
                    group.clone(),
                    car.clone(),
                    component_words(*component),
                    cell(*loss, 0.01),
                ]);
                let paint = used
                    .iter()
                    .position(|c| c == component)
                    .and_then(|k| paints.get(k))
                    .map_or("none", String::as_str);
                let next = base + sound(*loss).max(0.0);
                bar(&mut figure, &panel, row, (base, next), paint, at);
                base = next;
            }
            at_end(&mut figure, &panel, row, base, false, &grouped(base, 1));
        }
        panel.outline(&mut figure);
        top = panel.rect.bottom + GAP;
    }
    if of.groups.is_empty() {
        rows_panel(
            &mut figure,
            (left, top + HEADING),
            of.cars.len(),
            axis,
            true,
        )
        .empty(&mut figure);
    }
    let entries: Vec<_> = paints.into_iter().map(Mark::Fill).zip(names).collect();
    legend_below(
        &mut figure,
        (LEGEND, bottom),
        WIDTH - LEGEND - 20.0,
        "",
        &entries,
    );
    Picture {
        svg: figure.finish(),
        table,
    }
}

/// The groups in which some loss is a number, and the names of the others.
fn told_groups(of: &PhaseLosses) -> (PhaseLosses, Vec<String>) {
    let empty = |cars: &[CarParts]| !cars.iter().flatten().any(|(_, x)| x.is_finite());
    let (left_out, groups): (Vec<_>, Vec<_>) =
        of.groups.iter().cloned().partition(|(_, cars)| empty(cars));
    (
        PhaseLosses {
            groups,
            ..of.clone()
        },
        left_out.into_iter().map(|(name, _)| name).collect(),
    )
}

/// Components of any car, in the order of the power flow.
fn used(of: &PhaseLosses) -> Vec<Component> {
    let has = |c: &Component| {
        of.groups
            .iter()
            .any(|(_, cars)| cars.iter().flatten().any(|(own, _)| own == c))
    };
    Component::ALL.into_iter().filter(has).collect()
}

fn sum(parts: &[(Component, f64)]) -> f64 {
    parts.iter().map(|(_, loss)| sound(*loss).max(0.0)).sum()
}

fn describe(of: &PhaseLosses) -> String {
    let group = |(name, cars): &(String, Vec<CarParts>)| {
        let told: Vec<String> = of
            .cars
            .iter()
            .zip(cars)
            .map(|(car, parts)| format!("{car} {}", grouped(sum(parts), 1)))
            .collect();
        format!("{name}: {}", told.join(", "))
    };
    format!(
        "Loss of the transmission per distance, kJ/km. {}.",
        of.groups.iter().map(group).collect::<Vec<_>>().join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    #[test]
    fn parts_stand_end_to_end_and_the_label_is_their_sum() {
        let parts = |k: f64| {
            vec![
                (Component::Pump, 40.0 * k),
                (Component::BeltBand, 0.0),
                (Component::FinalDrive, 25.5 * k),
            ]
        };
        let groups = vec![
            ("ece15".to_owned(), vec![parts(4.0), parts(1.0)]),
            ("e<u>dc".to_owned(), vec![parts(2.0), vec![]]),
        ];
        let of = PhaseLosses {
            subject: "s".to_owned(),
            cars: vec!["a".to_owned(), "very long name of a car & more".repeat(4)],
            groups,
        };
        let picture = loss_by_phase(&of);
        check(&picture);
        assert!(picture.svg.contains(">262.0</text>") && picture.svg.contains(">0.0</text>"));
        let all: f64 = picture.table.rows.iter().map(|row| numbers(&row[3])).sum();
        assert!((all - 65.5 * 7.0).abs() < 1e-6);
        let doc = roxmltree::Document::parse(&picture.svg).expect("well-formed");
        let number = |n: &roxmltree::Node, key: &str| {
            n.attribute(key)
                .and_then(|x| x.parse::<f64>().ok())
                .unwrap_or(f64::NAN)
        };
        let bars: Vec<_> = doc
            .descendants()
            .filter(|n| n.attribute("class") == Some("bar"))
            .take(2)
            .collect();
        assert!(
            (number(&bars[0], "x") + number(&bars[0], "width") - number(&bars[1], "x")).abs() < 0.5
        );
    }

    #[test]
    fn nothing_is_still_a_picture() {
        check(&loss_by_phase(&PhaseLosses::default()));
        let no_cars = PhaseLosses {
            groups: vec![("g".to_owned(), vec![])],
            ..PhaseLosses::default()
        };
        check(&loss_by_phase(&no_cars));
        let broken = vec![("g".to_owned(), vec![vec![(Component::Seal, f64::NAN)]])];
        let soak = loss_by_phase(&PhaseLosses {
            cars: vec!["c".to_owned()],
            groups: broken,
            ..PhaseLosses::default()
        });
        check(&soak);
        assert!(soak.table.note.ends_with("per distance: g.") && soak.table.rows.is_empty());
    }
}
