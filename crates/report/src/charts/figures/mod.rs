//! Figures of the design-review report: energy flow, losses, the controller's variogram, two runs side by side.
//!
//! Each is a function from plain numbers, in the units that its input states, to a [`Picture`](super::Picture).

mod bar_rows;
mod difference;
mod flow;
mod loss_bars;
mod overlay;
mod phase_bars;
mod sankey;
mod temperature_bars;
mod variogram;

pub use difference::{Difference, DifferenceTerm, difference_bars};
pub use flow::{CarEnergy, energy_flow, transmission_flow};
pub use loss_bars::{CarLosses, loss_by_component};
pub use overlay::{Overlay, OverlayPanel, overlay};
pub use phase_bars::{CarParts, PhaseLosses, loss_by_phase};
pub use sankey::{Sankey, SankeyBranch, SankeyStage, sankey};
pub use temperature_bars::{LossTrace, loss_by_temperature};
pub use variogram::{GuideLine, Variogram, variogram};

use super::engine::{Fill, WIDTH};
use cvtcycle_output::Component;

/// Upper edge of what is drawn, below title and subject, pixels.
const TOP: f64 = 60.0;
/// Left edge of titles of figures with rows, pixels.
const MARGIN: f64 = 14.0;
/// Size of labels, pixels.
const TEXT: f64 = 11.5;
/// A minus sign as wide as a digit.
const MINUS: char = '\u{2212}';

/// A plain decimal with groups of three digits and a true minus sign; `decimals` after the point.
fn grouped(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let text = format!("{:.decimals$}", value.abs());
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let mut out = String::new();
    // Four digits read well without a gap.
    for (k, digit) in whole.chars().enumerate() {
        if k > 0 && whole.len() > 4 && (whole.len() - k).is_multiple_of(3) {
            out.push('\u{2009}');
        }
        out.push(digit);
    }
    let zero = !text.contains(|c: char| ('1'..='9').contains(&c));
    format!(
        "{}{out}{rest}",
        if value < 0.0 && !zero {
            MINUS.to_string()
        } else {
            String::new()
        }
    )
}

/// An energy given in kJ, as a label: MJ from 100 MJ on, with three digits at least where it is small.
fn energy(kj: f64) -> String {
    let size = kj.abs();
    match size {
        s if s >= 1e5 => format!("{} MJ", grouped(kj / 1e3, 1)),
        s if s >= 99.95 => format!("{} kJ", grouped(kj, 0)),
        s if s >= 0.995 || s <= 0.0 => format!("{} kJ", grouped(kj, 1)),
        _ => format!("{} kJ", grouped(kj, 2)),
    }
}

/// A share as a label in per cent; what rounds to zero without being zero is less than a tenth.
fn percent(part: f64, whole: f64) -> String {
    let share = 100.0 * part / whole;
    match share {
        s if !s.is_finite() => String::new(),
        s if s.abs() < 0.05 && s.abs() > 0.0 => {
            format!("{}0.1 %", if s < 0.0 { "> \u{2212}" } else { "< " })
        }
        s => format!("{} %", grouped(s, 1)),
    }
}

/// Finite numbers as they are, everything else as zero.
fn finite(x: f64) -> f64 {
    if x.is_finite() { x } else { 0.0 }
}

/// Where energy goes, apart from the components of the transmission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Term {
    /// What has not yet left the way to the wheels.
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
    /// Wheel brakes.
    Brake,
    /// Rolling and air resistance, as the net work at the wheels.
    Wheels,
    /// Anything else.
    #[default]
    Other,
}

impl Term {
    /// Its fill, or that of a component of the transmission.
    fn fill(self, component: Option<Component>) -> Fill {
        let colour = match self {
            Term::Trunk => "#d4dae6",
            Term::EngineHeat => "#e5b98e",
            Term::Exhaust => "#b98b66",
            Term::Accessories => "#bca9cf",
            Term::Kinetic => "#8f8f8f",
            Term::Transmission => "#b5442f",
            Term::Brake => "#4d4d4d",
            Term::Wheels => "#4f86b8",
            Term::Other => "#bcbcbc",
        };
        component.map_or_else(|| Fill::plain(colour), Fill::component)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_once_and_plainly() {
        assert_eq!(energy(27199.14), "27\u{2009}199 kJ");
        assert_eq!(
            [energy(562.15), energy(14.04), energy(-0.822), energy(0.0)],
            ["562 kJ", "14.0 kJ", "\u{2212}0.82 kJ", "0.0 kJ"]
        );
        assert_eq!(
            [energy(123_456.0), energy(-9999.4), energy(f64::NAN)],
            ["123.5 MJ", "\u{2212}9999 kJ", "\u{2013} kJ"]
        );
        assert_eq!(
            [
                percent(1.0, 4.0),
                percent(1e-9, 1.0),
                percent(-1e-9, 1.0),
                percent(0.0, 1.0)
            ],
            ["25.0 %", "< 0.1 %", "> \u{2212}0.1 %", "0.0 %"]
        );
        assert_eq!(percent(1.0, 0.0), "");
    }
}
