//! Fuel of the phases of a cycle, and of the cycle where its phases are weighted.

use super::Driven;
use crate::PhaseTotals;
use crate::number::finite;
use cvtcycle_config::cycle::{Cycle, Weighting};
use cvtcycle_model::drive::{co2_g_per_km, distance_counts, litres_per_100km, litres_per_hour};
use cvtcycle_model::engine::Engine;
use serde::{Deserialize, Serialize};

/// One group of phases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PhaseSummary {
    /// Name of the group.
    pub name: String,
    /// Driven distance.
    pub distance_km: f64,
    /// Duration.
    pub duration_s: f64,
    /// Fuel mass.
    pub fuel_kg: f64,
    /// Fuel over time; null in files of an earlier version.
    #[serde(default)]
    pub fuel_l_per_h: Option<f64>,
    /// Fuel; null without distance.
    pub fuel_l_per_100km: Option<f64>,
    /// Carbon dioxide; null without distance.
    pub co2_g_per_km: Option<f64>,
    /// Losses of the transmission.
    pub transmission_loss_kj: f64,
}

/// Fuel of some part of a cycle over its distance and its time.
pub(super) struct PhaseFuel {
    pub(super) l_per_h: Option<f64>,
    pub(super) l_per_100km: Option<f64>,
    pub(super) co2_g_per_km: Option<f64>,
}

impl PhaseFuel {
    pub(super) fn new(part: &PhaseTotals, engine: &Engine) -> Self {
        let (fuel_kg, distance_m) = (part.fuel_kg, part.distance_m);
        let density = engine.fuel_density_kg_m3;
        let counts = distance_counts(distance_m, part.duration_s);
        let over_distance = |number: f64| finite(number).filter(|_| counts);
        PhaseFuel {
            l_per_h: finite(litres_per_hour(fuel_kg, density, part.duration_s)),
            l_per_100km: over_distance(litres_per_100km(fuel_kg, density, distance_m)),
            co2_g_per_km: over_distance(co2_g_per_km(fuel_kg, engine.co2_kg_kg, distance_m)),
        }
    }
}

pub(super) fn phases(cycle: &Cycle, driven: &Driven, engine: &Engine) -> Vec<PhaseSummary> {
    let groups = cycle.phase_groups().into_iter();
    groups
        .map(|(name, phases)| {
            let part = driven.outcome.totals.over(&phases);
            let fuel = PhaseFuel::new(&part, engine);
            PhaseSummary {
                name,
                distance_km: part.distance_m / 1e3,
                duration_s: part.duration_s,
                fuel_kg: part.fuel_kg,
                fuel_l_per_h: fuel.l_per_h,
                fuel_l_per_100km: fuel.l_per_100km,
                co2_g_per_km: fuel.co2_g_per_km,
                transmission_loss_kj: part.terms.losses / 1e3,
            }
        })
        .collect()
}

/// 40 CFR 86.144: Y = 0.43 (Y_ct + Y_s)/(D_ct + D_s) + 0.57 (Y_ht + Y_s)/(D_ht + D_s).
pub(super) fn weighted_fuel(cycle: &Cycle, driven: &Driven, engine: &Engine) -> Option<f64> {
    if cycle.weighting != Weighting::Ftp75 {
        return None;
    }
    let groups = cycle.phase_groups();
    let bags = |names: [&str; 2]| {
        let named = groups
            .iter()
            .filter(|(name, _)| names.contains(&name.as_str()));
        let phases: Vec<u16> = named.flat_map(|(_, list)| list.clone()).collect();
        PhaseFuel::new(&driven.outcome.totals.over(&phases), engine).l_per_100km
    };
    let cold = bags(["cold_transient", "stabilised"])?;
    let hot = bags(["hot_transient", "stabilised"])?;
    Some(Weighting::FTP75_COLD * cold + Weighting::FTP75_HOT * hot)
}
