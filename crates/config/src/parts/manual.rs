//! Reads the `[transmission.manual]` table of a vehicle file.

use super::{film_heating, launch};
use crate::setup::{Files, tables};
use crate::{Bound, Section};
use cvtcycle_model::transmission::manual::{Manual, ShiftSpeeds};

/// Reads a checked manual box; problems go to the reader.
#[must_use]
pub fn load(s: &Section, files: &dyn Files) -> Manual {
    let nm = Bound::closed(0.0, 20.0);
    let exponent = Bound::closed(0.0, 1.5);
    let overall = s.numbers(
        "overall_ratios",
        Bound::closed(0.5, 40.0),
        2..=10,
        "engine speed over wheel speed in each gear, from first",
    );
    if overall.windows(2).any(|r| r[0] <= r[1]) {
        s.complain(
            "overall_ratios",
            "falling from gear to gear",
            "ratios must fall from first to top gear",
            "order them from first gear; reverse does not belong here",
        );
    }
    let (seal, bearing, churning, mesh) = (
        s.table("seal"),
        s.table("bearing"),
        s.table("churning"),
        s.table("mesh"),
    );
    Manual {
        shifts: shifts(s, overall.len()),
        overall,
        mesh_efficiency: mesh.number(
            "efficiency",
            Bound::closed(0.8, 1.0),
            "of gear and final drive together (MB-1)",
        ),
        seal_nm: seal.number("torque_nm", nm, "at reference viscosity (MB-2)"),
        seal_exponent: seal.number("viscous_exponent", exponent, "exponent of viscosity (MB-2)"),
        bearing_nm: bearing.number(
            "torque_nm",
            nm,
            "at 2000 rpm and reference viscosity (MB-3)",
        ),
        bearing_heating: film_heating::load(
            &bearing,
            "dissipation at which the heat of the films halves the torque; absent: no heating (MB-3, FH-1)",
        ),
        churning_nm: churning.number(
            "torque_nm",
            nm,
            "at 2000 rpm and reference viscosity (MB-4)",
        ),
        churning_exponent: churning.number(
            "viscous_exponent",
            exponent,
            "exponent of viscosity (MB-4)",
        ),
        reference_m2_s: s.number(
            "reference_mm2_s",
            Bound::closed(1.5, 1000.0),
            "viscosity at which the torques hold (MB-2)",
        ),
        neutral_share: s.number(
            "neutral_share",
            Bound::closed(0.0, 1.0),
            "share of the losses that turns in neutral",
        ),
        launch: launch::load(s, 0.0),
        map: tables::loss_map(
            &s.table("maps"),
            "box",
            "CSV of measured torque loss at the input shaft that replaces mesh, bearings, churning and seals",
            files,
            "gear",
        ),
    }
}

fn shifts(s: &Section, gears: usize) -> ShiftSpeeds {
    let count = gears.saturating_sub(1).max(1);
    let kmh = Bound::closed(1.0, 300.0);
    let up = s.numbers(
        "upshift_kmh",
        kmh,
        count..=count,
        "vehicle speeds to shift up where a cycle has no gears (MB-5)",
    );
    let down = s.numbers(
        "downshift_kmh",
        kmh,
        count..=count,
        "vehicle speeds to shift down (MB-5)",
    );
    if down.iter().zip(&up).any(|(d, u)| d >= u) {
        s.complain(
            "downshift_kmh",
            "below upshift_kmh in every gear",
            "a down-shift speed is not below its up-shift speed",
            "leave a gap of a few km/h so that the box does not hunt",
        );
    }
    for (key, list) in [("upshift_kmh", &up), ("downshift_kmh", &down)] {
        if list.windows(2).any(|w| w[0] >= w[1]) {
            s.complain(
                key,
                "rising",
                "shift speeds must rise from gear to gear",
                "order them from first gear",
            );
        }
    }
    // Keys in km/h read in SI: the lists are in m/s here.
    ShiftSpeeds {
        up_m_s: up,
        down_m_s: down,
    }
}
