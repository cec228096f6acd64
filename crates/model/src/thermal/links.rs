//! Links between the nodes, and the linear system that they make of a step (TH-5).
//!
//! The network is a tree with one loop: engine oil is linked to the coolant, the belt to the sump. Both are eliminated first; coolant, sump
//! and metal are left for Gauss. The matrix is symmetric and diagonally dominant, so no pivot is zero.

use super::{BELT, COOLANT, ENGINE_OIL, METAL, NODES, SUMP};

/// Conductances between nodes, W/K.
pub(super) struct Links {
    pub coolant_oil: f64,
    pub coolant_metal: f64,
    pub coolant_sump: f64,
    pub sump_metal: f64,
    pub sump_belt: f64,
}

impl Links {
    /// Heat that flows into each node from the others, W.
    #[inline(always)]
    pub fn flows_w(&self, t: &[f64; NODES]) -> [f64; NODES] {
        let into_oil = self.coolant_oil * (t[COOLANT] - t[ENGINE_OIL]);
        let into_belt = self.sump_belt * (t[SUMP] - t[BELT]);
        let sump_from_coolant = self.coolant_sump * (t[COOLANT] - t[SUMP]);
        let metal_from_coolant = self.coolant_metal * (t[COOLANT] - t[METAL]);
        let metal_from_sump = self.sump_metal * (t[SUMP] - t[METAL]);
        [
            -into_oil - metal_from_coolant - sump_from_coolant,
            into_oil,
            sump_from_coolant - metal_from_sump - into_belt,
            metal_from_coolant + metal_from_sump,
            into_belt,
        ]
    }

    /// Rise of the nodes: solves (own + links) rise = right, `own` the diagonal without links (TH-5).
    #[inline(always)]
    pub fn rise_k(&self, own: &[f64; NODES], right: &[f64; NODES]) -> [f64; NODES] {
        let (oil, metal, exchanger) = (self.coolant_oil, self.coolant_metal, self.coolant_sump);
        // Leaves: what is left of the link after the leaf's own capacity and air.
        let oil_pivot = 1.0 / (own[ENGINE_OIL] + oil);
        let belt_pivot = 1.0 / (own[BELT] + self.sump_belt);
        let (to_oil, to_belt) = (oil * oil_pivot, self.sump_belt * belt_pivot);
        let coolant = own[COOLANT] + metal + exchanger + oil * own[ENGINE_OIL] * oil_pivot;
        let sump =
            own[SUMP] + exchanger + self.sump_metal + self.sump_belt * own[BELT] * belt_pivot;
        let coolant_right = right[COOLANT] + to_oil * right[ENGINE_OIL];
        let sump_right = right[SUMP] + to_belt * right[BELT];
        // Coolant, then sump, then metal.
        let coolant_pivot = 1.0 / coolant;
        let (sump_share, metal_share) = (exchanger * coolant_pivot, metal * coolant_pivot);
        let sump_pivot = 1.0 / (sump - exchanger * sump_share);
        let sump_metal = self.sump_metal + sump_share * metal;
        let sump_right = sump_right + sump_share * coolant_right;
        let share = sump_metal * sump_pivot;
        let metal_pivot =
            own[METAL] + metal + self.sump_metal - metal * metal_share - sump_metal * share;
        let metal_k =
            (right[METAL] + metal_share * coolant_right + share * sump_right) / metal_pivot;
        let sump_k = sump_right * sump_pivot + share * metal_k;
        let coolant_k = coolant_right * coolant_pivot + sump_share * sump_k + metal_share * metal_k;
        let oil_k = right[ENGINE_OIL] * oil_pivot + to_oil * coolant_k;
        let belt_k = right[BELT] * belt_pivot + to_belt * sump_k;
        [coolant_k, oil_k, sump_k, metal_k, belt_k]
    }
}
