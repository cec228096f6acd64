//! The candidate vehicle: the one that is validated or fitted.

use super::source::Source;
use cvtcycle_config::rig;
use cvtcycle_config::setup::{NamedBy, Options};
use cvtcycle_config::{KeyInfo, Override, Problems, Target};
use cvtcycle_model::bench::transmission::Conditions;

/// Vehicle of all sources that name none, with its fluids and overrides.
#[derive(Clone, Debug, Default)]
pub struct CandidateVehicle {
    /// Name or path.
    pub vehicle: String,
    /// Transmission oil in place of its own.
    pub lubricant: Option<String>,
    /// Engine oil in place of its own.
    pub engine_oil: Option<String>,
    /// Overrides.
    pub set: Vec<Override>,
    /// What gives the names of vehicle and fluids.
    pub named_by: NamedBy,
}

impl CandidateVehicle {
    /// Name or path of the vehicle of a source.
    #[must_use]
    pub fn vehicle_of<'a>(&'a self, source: Option<&'a Source>) -> &'a str {
        let own = source.and_then(|source| source.vehicle.as_deref());
        own.unwrap_or(&self.vehicle)
    }

    /// Options of the vehicle of a source.
    #[must_use]
    pub fn options(&self, source: Option<&Source>) -> Options {
        let own = source.is_none_or(|source| source.vehicle.is_none());
        let mut set = self.overrides(source);
        set.drain(..if own { 0 } else { self.set.len() });
        set.retain(|by| by.target() != Target::Rig);
        let lubricant = source.and_then(|source| source.lubricant.clone());
        Options {
            lubricant: lubricant.or_else(|| self.lubricant.clone().filter(|_| own)),
            engine_oil: self.engine_oil.clone().filter(|_| own),
            set,
            formulation: source.map(|source| source.formulation).unwrap_or_default(),
            named_by: if own { self.named_by } else { NamedBy::File },
        }
    }

    /// Overrides of the candidate, then those of a source.
    #[must_use]
    pub fn overrides(&self, source: Option<&Source>) -> Vec<Override> {
        let own = source.map_or(&[][..], |source| &source.set);
        self.set.iter().chain(own).cloned().collect()
    }

    /// Settings of the transmission rig for a source.
    ///
    /// # Errors
    /// The problems of its values.
    pub fn conditions(
        &self,
        source: Option<&Source>,
    ) -> Result<(Conditions, Vec<KeyInfo>), Problems> {
        rig::load(&self.overrides(source))
    }
}
