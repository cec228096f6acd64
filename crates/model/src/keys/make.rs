//! Curves and viscosities from the values of keys.

use super::{Key, Values};
use crate::fluid::Viscosity;
use crate::math::Curve;

/// A curve from two-column rows; a problem at the key if they do not make one.
pub fn curve<V: Values>(s: &V, key: &Key<'_>, rows: &[Vec<f64>]) -> Curve {
    let points: Vec<(f64, f64)> = rows.iter().map(|r| (r[0], r[1])).collect();
    Curve::new(&points).unwrap_or_else(|why| {
        s.complain(
            key.name,
            "rows [x, y] with rising x",
            &why,
            "give at least one row; sort them by their first number and remove doubled ones",
        );
        Curve::constant(1.0)
    })
}

/// A viscosity from points of temperature in K and kinematic viscosity in m2/s. If the points are
/// finite and do not make one, a problem at the key with what is allowed and a hint; points that are
/// not finite have a problem already.
pub fn viscosity<V: Values>(
    s: &V,
    key: &Key<'_>,
    points: &[(f64, f64)],
    [allowed, hint]: [&str; 2],
) -> Viscosity {
    Viscosity::new(points).unwrap_or_else(|why| {
        if points.iter().all(|p| p.0.is_finite() && p.1.is_finite()) {
            s.complain(key.name, allowed, &why, hint);
        }
        any_viscosity()
    })
}

/// Replaces a viscosity after a problem, so that reading goes on.
pub fn any_viscosity() -> Viscosity {
    Viscosity::new(&[(313.15, 36e-6), (373.15, 7.2e-6)])
        .unwrap_or_else(|_| unreachable!("constant points"))
}
