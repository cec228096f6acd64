//! Links between the nodes, and the linear system that they make of a step (TH-5).
//!
//! The network is a tree with one loop: engine oil is linked to the coolant, the belt to the sump. Both are eliminated first; coolant, sump
//! and metal are left for Gauss. The matrix is symmetric and diagonally dominant, so no pivot is zero.

use super::{BELT, COOLANT, ENGINE_OIL, METAL, NODES, SUMP};
use crate::math::{Real, physics};

/// Conductances between nodes, W/K.
pub(super) struct Links<R: Real = f64> {
    pub coolant_oil: R,
    pub coolant_metal: R,
    pub coolant_sump: R,
    pub sump_metal: R,
    pub sump_belt: R,
}

#[physics]
impl<R: Real> Links<R> {
    /// Heat that flows into each node from the others, W.
    pub fn flows_w(&self, t: &[R; NODES]) -> [R; NODES] {
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
    pub fn rise_k(&self, own: &[R; NODES], right: &[R; NODES]) -> [R; NODES] {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Outside truth: a general solver of another library, on the whole matrix with every link in it.
    #[test]
    fn val_elimination_agrees_with_a_dense_solver() {
        let links = Links {
            coolant_oil: 57.0,
            coolant_metal: 6.0,
            coolant_sump: 41.0,
            sump_metal: 83.0,
            sump_belt: 29.0,
        };
        let own = [31e3, 9e3, 8.5e3, 14e3, 4.2e3];
        let right = [3100.0, -250.0, 480.0, 70.0, 690.0];
        let pairs = [
            (COOLANT, ENGINE_OIL, links.coolant_oil),
            (COOLANT, METAL, links.coolant_metal),
            (COOLANT, SUMP, links.coolant_sump),
            (SUMP, METAL, links.sump_metal),
            (SUMP, BELT, links.sump_belt),
        ];
        for scale in [1.0, 1e-2, 1e-5] {
            let own = own.map(|c: f64| c * scale); // from links that hardly matter to links that are everything
            let mut matrix = nalgebra::SMatrix::<f64, NODES, NODES>::from_diagonal(
                &nalgebra::SVector::from(own),
            );
            for (i, j, g) in pairs {
                matrix[(i, i)] += g;
                matrix[(j, j)] += g;
                matrix[(i, j)] -= g;
                matrix[(j, i)] -= g;
            }
            let want = matrix
                .lu()
                .solve(&nalgebra::SVector::from(right))
                .expect("regular");
            for (got, want) in links.rise_k(&own, &right).iter().zip(want.iter()) {
                assert!(
                    (got / want - 1.0).abs() < 1e-9,
                    "{scale}: {got} instead of {want}"
                );
            }
        }
    }

    /// Heat that leaves one node through a link arrives at another.
    #[test]
    fn links_create_no_heat() {
        let links = Links {
            coolant_oil: 57.0,
            coolant_metal: 6.0,
            coolant_sump: 41.0,
            sump_metal: 83.0,
            sump_belt: 29.0,
        };
        let flows = links.flows_w(&[350.0, 340.0, 310.0, 300.0, 335.0]);
        assert!(
            flows.iter().sum::<f64>().abs() < 1e-9 && (flows[BELT] + 29.0 * 25.0).abs() < 1e-9,
            "{flows:?}"
        );
    }
}
