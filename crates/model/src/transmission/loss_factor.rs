//! Factors on losses: what a car would burn with more of a loss, with less of it, or without it.

use super::component::{ByComponent, Component};
use crate::keys::{Table, Values};

/// A factor on the loss of each component; 1 leaves it as the model has it.
pub type LossFactors = ByComponent<f64>;

/// No loss changed.
pub const UNCHANGED: LossFactors = ByComponent([1.0; Component::COUNT]);

/// True for the key of a factor: no parameter of the physics, and nothing to be measured or fitted.
pub fn is_key(key: &str) -> bool {
    key.contains(".loss_factor.")
}

/// True where a factor is not 1.
pub fn changes(factor: &LossFactors) -> bool {
    factor.iter().any(|f| (f - 1.0).abs() > 0.0)
}

/// Factors that act one after the other.
pub fn product(a: &LossFactors, b: &LossFactors) -> LossFactors {
    ByComponent::from_fn(|component| a[component] * b[component])
}

/// The factors of the table `loss_factor` of a box that has some components; the keys of others are not read.
pub(super) fn from_values<V: Values>(s: &V, table: Table, own: &[Component]) -> LossFactors {
    let s = s.table(table.name);
    let key = |component: Component| table.keys.iter().find(|key| key.name == component.name());
    ByComponent::from_fn(|component| {
        let key = key(component).filter(|_| own.contains(&component));
        key.map_or(1.0, |key| s.number(key))
    })
}
