//! Temperatures of single nodes at the start of a drive (TH-10).

use super::{BELT, COOLANT, ENGINE_OIL, Heat, METAL, NODES, SUMP};

/// Names of the nodes that a start may give, the tyres after those of the network: places of [`StartTemperatures::given_k`].
pub const START_NODES: [&str; NODES + 1] =
    ["coolant", "engine_oil", "sump", "metal", "belt", "tyre"];

/// Place of the tyres, which are no node of the network.
const TYRE: usize = NODES;

/// Node from whose temperature a node that is not given takes its own, the nearest first; behind them ambient.
const NEAREST: [&[usize]; NODES + 1] = [
    &[ENGINE_OIL],  // coolant
    &[COOLANT],     // engine oil
    &[METAL, BELT], // sump
    &[SUMP, BELT],  // metal
    &[SUMP, METAL], // belt
    &[],            // tyres
];

/// Temperatures at the start of a drive, those of some nodes given.
///
/// ```
/// use cvtcycle_model::thermal::{COOLANT, ENGINE_OIL, METAL, SUMP, StartTemperatures};
///
/// let mut start = StartTemperatures::default();
/// start.given_k[COOLANT] = Some(354.15);
/// start.given_k[SUMP] = Some(333.15);
/// let (heat, tyre_k) = start.at(293.15);
/// assert_eq!([COOLANT, ENGINE_OIL, SUMP, METAL].map(|node| heat.node_k[node]), [354.15, 354.15, 333.15, 333.15]);
/// assert_eq!(tyre_k, 293.15);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartTemperatures {
    /// Temperature of each node of [`START_NODES`], K; none where it follows.
    pub given_k: [Option<f64>; NODES + 1],
}

impl StartTemperatures {
    /// Node from which a node takes its temperature: itself where it is given; none for ambient.
    pub fn source(&self, node: usize) -> Option<usize> {
        let mut nearest = std::iter::once(&node).chain(NEAREST[node]);
        nearest.find(|node| self.given_k[**node].is_some()).copied()
    }

    /// Temperatures of the network and of the tyres, K, at an ambient temperature.
    pub fn at(&self, ambient_k: f64) -> (Heat, f64) {
        let of = |node: usize| {
            let source = self.source(node);
            source
                .and_then(|node| self.given_k[node])
                .unwrap_or(ambient_k)
        };
        let node_k = std::array::from_fn(of); // TH-10
        (Heat { node_k }, of(TYRE))
    }
}
