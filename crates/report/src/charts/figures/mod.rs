//! Figures of the design-review report: energy flow, losses, the controller's variogram, two runs side by side.
//!
//! Each is a function from plain numbers, in the units that its input states, to a [`Picture`](super::Picture).

mod bars;
mod difference;
mod flow;
mod overlay;
mod sankey;
mod trace_difference;
mod variogram;

pub use bars::{CarLosses, CarParts, PhaseLosses, loss_by_component, loss_by_phase};
pub use difference::{DifferenceTerm, EnergyDifference, difference_bars};
pub use flow::{CarEnergy, energy_flow, transmission_flow};
pub use overlay::{Overlay, OverlayPanel, overlay};
pub use trace_difference::{TraceDifference, trace_difference};
pub use variogram::{GuideLine, Variogram, variogram};

use super::engine::Fill;
use crate::number::grouped;
use cvtcycle_output::Component;

/// Upper edge of the drawing, below title and subject, pixels.
const TOP: f64 = 60.0;
/// Left edge of titles of figures with rows, pixels.
const MARGIN: f64 = 14.0;
/// Size of labels, pixels.
const TEXT: f64 = 11.5;

/// Label of an energy given in kJ: in MJ from 100 MJ on, with at least three digits where it is small.
fn energy(kj: f64) -> String {
    match kj.abs() {
        size if size >= 1e5 => format!("{} MJ", grouped(kj / 1e3, 1)),
        size if size >= 99.95 => format!("{} kJ", grouped(kj, 0)),
        size if size >= 0.995 || size <= 0.0 => format!("{} kJ", grouped(kj, 1)),
        _ => format!("{} kJ", grouped(kj, 2)),
    }
}

/// Label of an energy over a distance, kJ/km.
fn per_km(kj_km: f64) -> String {
    energy(kj_km) + "/km"
}

/// Label of a share in per cent; a nonzero share that rounds to zero is given as less than a tenth.
fn percent(part: f64, whole: f64) -> String {
    match 100.0 * part / whole {
        share if !share.is_finite() => String::new(),
        share if share > 0.0 && share < 0.05 => "< 0.1 %".to_owned(),
        share if share < 0.0 && share > -0.05 => "> \u{2212}0.1 %".to_owned(),
        share => format!("{} %", grouped(share, 1)),
    }
}

/// Car and conditions of a drive, for the line below a title: "CVT; NEDC, ambient -10 degC".
fn drive_subtitle(subject: &str, conditions: &str) -> String {
    let words = [subject, conditions].into_iter();
    let known: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    known.join("; ")
}

/// Replaces numbers that are not finite by zero.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

/// Uses of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Term {
    /// Energy still on the way to the wheels.
    Trunk,
    /// Heat into the engine.
    EngineHeat,
    /// Exhaust.
    Exhaust,
    /// Accessories.
    Accessories,
    /// Change of rotating energy.
    Kinetic,
    /// All losses of the transmission.
    Transmission,
    /// Loss of one component of the transmission.
    Component(Component),
    /// Wheel brakes.
    Brake,
    /// Rolling and air resistance, as the net work at the wheels.
    Wheels,
    /// Anything else.
    #[default]
    Other,
}

impl Term {
    pub(crate) fn fill(self) -> Fill {
        Fill::plain(match self {
            Term::Trunk => "#d4dae6",
            Term::EngineHeat => "#e5b98e",
            Term::Exhaust => "#b98b66",
            Term::Accessories => "#bca9cf",
            Term::Kinetic => "#8f8f8f",
            Term::Transmission => "#b5442f",
            Term::Component(component) => return Fill::component(component),
            Term::Brake => "#4d4d4d",
            Term::Wheels => "#4f86b8",
            Term::Other => "#bcbcbc",
        })
    }
}

/// Terms of the power ledger with name, title and kind; for [`RunSummary::term_kj`](cvtcycle_output::summary::RunSummary::term_kj).
pub(crate) const TERMS: [(&str, &str, Term); 8] = [
    ("wheels", "rolling and air, net", Term::Wheels),
    ("brake", "brakes", Term::Brake),
    ("losses", "transmission", Term::Transmission),
    ("accessories", "accessories", Term::Accessories),
    ("electric", "battery and starter", Term::Accessories),
    ("kinetic", "rotating parts", Term::Kinetic),
    ("engine_heat", "heat to the engine", Term::EngineHeat),
    ("exhaust", "exhaust", Term::Exhaust),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_digits_by_magnitude() {
        let kj = [
            27199.14,
            562.15,
            14.04,
            -0.822,
            0.0,
            123_456.0,
            -9999.4,
            f64::NAN,
        ];
        assert_eq!(
            kj.map(energy).join("; "),
            "27\u{202f}199 kJ; 562 kJ; 14.0 kJ; \u{2212}0.82 kJ; 0.0 kJ; 123.5 MJ; \u{2212}9999 kJ; \u{2013} kJ"
        );
        let shares = [0.25, 1e-9, -1e-9, 0.0].map(|x| percent(x, 1.0));
        assert_eq!(shares.join("; "), "25.0 %; < 0.1 %; > \u{2212}0.1 %; 0.0 %");
        assert_eq!(percent(1.0, 0.0), "");
    }
}
