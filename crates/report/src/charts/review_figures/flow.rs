//! The energy flow of one car: all of it from fuel to wheel, and its transmission enlarged.
use super::sankey::{Sankey, SankeyBranch, SankeyStage, sankey};
use super::{Term, sound};
use crate::charts::Picture;
use cvtcycle_output::Component;

/// Energies of one run, kJ: fuel = exhaust + heat to the engine + accessories + rotating energy + losses + brakes + wheels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CarEnergy {
    /// Name of the car.
    pub subject: String,
    /// Fuel, lower heating value.
    pub fuel_kj: f64,
    /// Heat and unburnt fuel into the exhaust.
    pub exhaust_kj: f64,
    /// Heat to the engine.
    pub engine_heat_kj: f64,
    /// Accessories.
    pub accessories_kj: f64,
    /// Change of rotating energy; negative where it was given back.
    pub kinetic_kj: f64,
    /// Losses of the transmission in the order of the power flow.
    pub losses_kj: Vec<(Component, f64)>,
    /// Wheel brakes.
    pub brake_kj: f64,
    /// Net work at the wheels, against rolling and air resistance.
    pub wheels_kj: f64,
}

impl CarEnergy {
    /// All losses of the transmission, kJ.
    #[must_use]
    pub fn transmission_kj(&self) -> f64 {
        self.losses_kj.iter().map(|(_, kj)| sound(*kj)).sum()
    }

    /// Work into the transmission at the flywheel, kJ: what leaves it again as losses, at the brakes and at the wheels.
    #[must_use]
    pub fn flywheel_kj(&self) -> f64 {
        self.transmission_kj() + sound(self.brake_kj) + sound(self.wheels_kj)
    }

    fn at_wheels(&self) -> SankeyStage {
        let branches = vec![
            SankeyBranch::term("Brakes", Term::Brake, self.brake_kj),
            SankeyBranch::term("Rolling and air", Term::Wheels, self.wheels_kj),
        ];
        SankeyStage {
            name: "Wheels".to_owned(),
            branches,
        }
    }
}

/// From fuel to wheel; the transmission is one branch.
#[must_use]
pub fn energy_flow(car: &CarEnergy) -> Picture {
    let stage = |name: &str, branches: Vec<SankeyBranch>| SankeyStage {
        name: name.to_owned(),
        branches,
    };
    let engine = vec![
        SankeyBranch::term("Exhaust", Term::Exhaust, car.exhaust_kj),
        SankeyBranch::term("Heat to the engine", Term::EngineHeat, car.engine_heat_kj),
    ];
    let flywheel = vec![
        SankeyBranch::term("Accessories", Term::Accessories, car.accessories_kj),
        SankeyBranch::term("Rotating parts", Term::Kinetic, car.kinetic_kj),
    ];
    let transmission = vec![SankeyBranch::term(
        "Transmission losses",
        Term::Transmission,
        car.transmission_kj(),
    )];
    sankey(&Sankey {
        title: "Energy from fuel to wheel".to_owned(),
        subject: car.subject.clone(),
        source: ("Fuel".to_owned(), car.fuel_kj),
        stages: vec![
            stage("Engine", engine),
            stage("Crankshaft", flywheel),
            stage("Transmission", transmission),
            car.at_wheels(),
        ],
        shares_of: vec![("the fuel".to_owned(), car.fuel_kj)],
    })
}

/// From the flywheel to the wheels, with a branch for each component.
#[must_use]
pub fn transmission_flow(car: &CarEnergy) -> Picture {
    let source = car.flywheel_kj();
    let mut stages: Vec<SankeyStage> = car
        .losses_kj
        .iter()
        .map(|(c, kj)| SankeyStage {
            name: String::new(),
            branches: vec![SankeyBranch::of(*c, *kj)],
        })
        .collect();
    stages.push(car.at_wheels());
    sankey(&Sankey {
        title: "Energy through the transmission, flywheel to wheel".to_owned(),
        subject: car.subject.clone(),
        source: ("Flywheel".to_owned(), source),
        stages,
        shares_of: vec![
            ("flywheel work".to_owned(), source),
            ("the fuel".to_owned(), car.fuel_kj),
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::super::tidy::{check, numbers};
    use super::*;

    fn car() -> CarEnergy {
        let losses = [
            (Component::LaunchClutch, 225.0),
            (Component::Pump, 556.0),
            (Component::BeltFilm, 0.02),
            (Component::FinalDrive, 507.0),
        ];
        let mut car = CarEnergy {
            subject: "A < B & \"C\"".to_owned(),
            exhaust_kj: 6030.0,
            engine_heat_kj: 15784.0,
            accessories_kj: 562.0,
            kinetic_kj: -0.8,
            losses_kj: losses.to_vec(),
            brake_kj: 203.0,
            wheels_kj: 2301.0,
            ..CarEnergy::default()
        };
        car.fuel_kj = 6030.0 + 15784.0 + 562.0 - 0.8 + car.flywheel_kj();
        car
    }

    /// Energy of the rows of one way, kJ.
    fn sum(picture: &Picture, way: &str) -> f64 {
        picture
            .table
            .rows
            .iter()
            .filter(|row| row[1] == way)
            .map(|row| numbers(&row[2]))
            .sum()
    }

    /// Heights of the ribbons at both ends, canvas units, by row of the table.
    fn widths(svg: &str) -> Vec<(usize, f64, f64)> {
        let doc = roxmltree::Document::parse(svg).expect("well-formed");
        let ribbons = doc
            .descendants()
            .filter(|n| n.attribute("class") == Some("ribbon"));
        ribbons
            .map(|node| {
                let d: Vec<f64> = node
                    .attribute("d")
                    .unwrap_or("")
                    .split(|c: char| !c.is_ascii_digit())
                    .filter_map(|n| n.parse().ok())
                    .collect();
                let row = node
                    .attribute("data-row")
                    .and_then(|row| row.parse().ok())
                    .expect("a row");
                // M x0 a C m a m c x1 c V d C m d m b x0 b
                (row, d[14] - d[1], d[8] - d[7])
            })
            .collect()
    }

    #[test]
    fn what_enters_leaves_and_widths_are_in_proportion() {
        for picture in [energy_flow(&car()), transmission_flow(&car())] {
            check(&picture);
            let (entered, left) = (sum(&picture, "enters"), sum(&picture, "leaves"));
            assert!((entered - left).abs() < 0.06, "{entered} {left}");
            let widths = widths(&picture.svg);
            assert_eq!(
                widths.len(),
                picture
                    .table
                    .rows
                    .iter()
                    .filter(|row| row[1] != "arrives")
                    .count()
                    - 1,
                "a ribbon for each but the source"
            );
            for (row, start, end) in widths {
                let wanted = 4.0 * 300.0 * numbers(&picture.table.rows[row][2]) / entered;
                assert!(
                    (start - wanted).abs() <= 1.1 && (end - wanted).abs() <= 1.1,
                    "{:?}: {start} {end} {wanted}",
                    picture.table.rows[row]
                );
            }
        }
    }

    #[test]
    fn every_flow_has_its_label_however_thin() {
        let picture = transmission_flow(&car());
        for word in [
            "Belt film",
            "0.02 kJ",
            "&lt; 0.1 %",
            "Rolling and air",
            "A &lt; B &amp; &quot;C&quot;",
        ] {
            assert!(picture.svg.contains(word), "{word}");
        }
        assert!(
            energy_flow(&car()).svg.contains("0.80 kJ"),
            "what flows in is labelled too"
        );
    }

    #[test]
    fn odd_energies_are_still_pictures() {
        let nothing = CarEnergy::default();
        let driven = CarEnergy {
            wheels_kj: -900.0,
            losses_kj: vec![(Component::Churning, 100.0)],
            brake_kj: 500.0,
            ..CarEnergy::default()
        };
        let broken = CarEnergy {
            fuel_kj: f64::NAN,
            exhaust_kj: f64::INFINITY,
            ..car()
        };
        let huge = CarEnergy {
            fuel_kj: 1e12,
            exhaust_kj: 1e12,
            subject: "n".repeat(400),
            ..CarEnergy::default()
        };
        for car in [nothing, driven, broken, huge] {
            for picture in [energy_flow(&car), transmission_flow(&car)] {
                check(&picture);
            }
        }
    }

    #[test]
    fn energy_that_is_missing_is_shown() {
        let mut car = car();
        car.fuel_kj += 100.0;
        let picture = energy_flow(&car);
        assert!(
            picture.svg.contains("Not accounted for")
                && (sum(&picture, "enters") - sum(&picture, "leaves")).abs() < 0.06
        );
    }
}
