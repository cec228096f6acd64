//! Losses of a manual box at a gear, a speed and an oil temperature (MB-1 to MB-4).

use super::Manual;
use crate::maps::{LossMap, MapPoint};
use crate::math::{exp, ln};
use crate::transmission::component::Component;

/// Load-independent torques at the input shaft, Nm.
#[derive(Clone, Copy)]
pub(super) struct Spin {
    pub seal: f64,
    pub bearing: f64,
    pub churning: f64,
    /// The whole box by its map, which then replaces the others.
    pub map: f64,
}

impl Spin {
    pub fn mapped(loss_nm: f64) -> Self {
        Spin {
            seal: 0.0,
            bearing: 0.0,
            churning: 0.0,
            map: loss_nm,
        }
    }

    pub fn sum(&self) -> f64 {
        self.seal + self.bearing + self.churning + self.map
    }
}

/// Speed to which MB-3 and MB-4 refer, rad/s (2000 rpm).
const REFERENCE_RAD_S: f64 = crate::keys::rad_s(2000.0);

impl Manual {
    fn spin(&self, speed_rad_s: f64, nu_m2_s: f64) -> Spin {
        let n = speed_rad_s / REFERENCE_RAD_S;
        if n <= 0.0 {
            return Spin::mapped(0.0);
        }
        let log = ln(nu_m2_s / self.reference_m2_s);
        let [seal, bearing, churning] = [
            self.seal_exponent * log,
            2.0 / 3.0 * (ln(n) + log),
            self.churning_exponent * log,
        ]
        .map(exp);
        Spin {
            seal: self.seal_nm * seal, // MB-2
            bearing: self
                .bearing_heating
                .torque_nm(self.bearing_nm * bearing, speed_rad_s), // MB-3
            churning: self.churning_nm * n * churning, // MB-4
            map: 0.0,
        }
    }

    /// Losses of the unloaded box: the model's, or the map's at no torque.
    pub(super) fn unloaded(&self, gear: u8, speed: f64, nu: f64, oil_k: f64) -> Spin {
        match &self.map {
            Some(map) => Spin::mapped(map_loss(map, gear, speed, 0.0, oil_k).0),
            None => self.spin(speed, nu),
        }
    }

    /// The engaged box at a speed and an oil temperature.
    #[inline]
    pub(super) fn turning(
        &self,
        gear: u8,
        input_rad_s: f64,
        nu_m2_s: f64,
        oil_k: f64,
    ) -> Turning<'_> {
        let spin = if self.map.is_some() {
            Spin::mapped(0.0)
        } else {
            self.spin(input_rad_s, nu_m2_s)
        };
        Turning {
            manual: self,
            gear,
            input_rad_s,
            oil_k,
            spin,
        }
    }

    /// Losses of the engaged box by component, Nm at the input shaft, for an output torque referred to the input (MB-1 to MB-4), and
    /// whether a map, if there is one, holds the point.
    pub fn part_losses_nm(
        &self,
        gear: u8,
        input_rad_s: f64,
        output_nm: f64,
        nu_m2_s: f64,
        oil_k: f64,
    ) -> ([(Component, f64); 5], bool) {
        let (spin, mesh, inside) = self
            .turning(gear, input_rad_s, nu_m2_s, oil_k)
            .losses(output_nm);
        let parts = [
            (Component::GearMesh, mesh),
            (Component::Bearing, spin.bearing),
            (Component::Churning, spin.churning),
            (Component::Seal, spin.seal),
            (Component::BoxMap, spin.map),
        ];
        (parts, inside)
    }
}

/// The engaged box at a speed and an oil temperature: what does not depend on torque is known.
pub(super) struct Turning<'a> {
    manual: &'a Manual,
    gear: u8,
    input_rad_s: f64,
    oil_k: f64,
    /// Nothing where a map holds the losses.
    spin: Spin,
}

/// The engaged box at a torque, Nm at the input shaft.
pub(super) struct Loaded {
    pub output_nm: f64,
    pub input_nm: f64,
    pub spin: Spin,
    pub mesh_nm: f64,
    pub inside_map: bool,
}

impl Turning<'_> {
    /// Input torque and losses for an output torque referred to the input (MB-1).
    pub fn at(&self, output_nm: f64) -> Loaded {
        let (spin, mesh_nm, inside_map) = self.losses(output_nm);
        Loaded {
            output_nm,
            input_nm: output_nm + spin.sum() + mesh_nm, // MB-1
            spin,
            mesh_nm,
            inside_map,
        }
    }

    /// Box loss torque at the input for an output torque referred to the input: (spin, mesh, inside map).
    fn losses(&self, output_nm: f64) -> (Spin, f64, bool) {
        if let Some(map) = &self.manual.map {
            let (loss, inside) = map_loss(map, self.gear, self.input_rad_s, output_nm, self.oil_k);
            return (Spin::mapped(loss), 0.0, inside);
        }
        let eta = self.manual.mesh_efficiency;
        let mesh = if output_nm >= 0.0 {
            output_nm * (1.0 / eta - 1.0)
        } else {
            output_nm * (eta - 1.0)
        }; // MB-1
        (self.spin, mesh, true)
    }

    /// Output torque referred to the input for an input torque: the inverse of MB-1, by secant where a map is used.
    pub fn output_for(&self, input_nm: f64) -> (f64, u16) {
        let mut x = input_nm;
        let mut count = 0;
        while count < 60 {
            let (spin, mesh, _) = self.losses(x);
            let miss = x + spin.sum() + mesh - input_nm;
            count += 1;
            if miss.abs() <= 1e-10 * (1.0 + input_nm.abs()) {
                break;
            }
            x -= miss;
        }
        (x, count)
    }
}

/// Loss of a measured map, whose torque axis is the input torque, for an output torque: T_in = T_out + loss(T_in) by fixed point.
fn map_loss(
    map: &LossMap,
    gear: u8,
    input_speed_rad_s: f64,
    output_nm: f64,
    oil_k: f64,
) -> (f64, bool) {
    let at = |torque_nm: f64| {
        map.loss_nm(&MapPoint {
            ratio: f64::from(gear),
            input_speed_rad_s,
            torque_nm,
            pressure_pa: 0.0,
            oil_k,
        })
    };
    let mut answer = at(output_nm);
    for _ in 0..8 {
        answer = at(output_nm + answer.0);
    }
    answer
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transmission::coupling::FrictionClutch;
    use crate::transmission::manual::ShiftSpeeds;
    use crate::transmission::viscous_self_heating::ViscousSelfHeating;
    use std::sync::Arc;

    fn manual() -> Manual {
        Manual {
            overall: vec![13.45, 7.67, 5.25, 4.15, 3.33],
            mesh_efficiency: 0.985,
            seal_nm: 0.78,
            seal_exponent: 0.15,
            bearing_nm: 0.12,
            bearing_heating: ViscousSelfHeating::NONE,
            churning_nm: 0.84,
            churning_exponent: 0.2,
            reference_m2_s: 12.9e-6,
            neutral_share: 0.5,
            shifts: ShiftSpeeds {
                up_m_s: vec![4.2, 9.7, 13.9, 19.4],
                down_m_s: vec![3.0, 7.0, 11.0, 15.0],
            },
            coupling: Arc::new(FrictionClutch {
                engage_rad_s: 105.0,
                gain_nm_s2: 0.0019,
                creep_nm: 0.0,
                release_rad_s: 90.0,
            }),
            map: None,
        }
    }

    /// CO2MPAS hot class values for 145 Nm: 0.925 Nm + 0.000407 Nm/rpm.
    #[test]
    fn val_hot_spin_loss() {
        let m = manual();
        for rpm in [1000.0, 2000.0, 3000.0, 4000.0] {
            let got = m.spin(rpm * std::f64::consts::PI / 30.0, 12.9e-6).sum();
            let want = 0.925 + 0.000_407 * rpm;
            assert!(
                (got / want - 1.0).abs() < 0.05,
                "{rpm} rpm: {got:.3} instead of {want:.3}"
            );
        }
    }

    #[test]
    fn output_is_the_inverse_of_input() {
        let m = manual();
        for torque in [-20.0, -2.0, 0.0, 3.0, 80.0] {
            let turning = m.turning(3, 200.0, 30e-6, 320.0);
            let (x, _) = turning.output_for(torque);
            let (spin, mesh, _) = turning.losses(x);
            assert!((x + spin.sum() + mesh - torque).abs() < 1e-8 && mesh >= 0.0);
        }
    }

    #[test]
    fn losses_fall_as_the_oil_warms() {
        let m = manual();
        let cold = m.spin(200.0, 1202e-6).sum();
        let warm = m.spin(200.0, 12.9e-6).sum();
        assert!(cold > 2.0 * warm && cold < 10.0, "{cold} {warm}");
    }
}
