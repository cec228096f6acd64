//! The final drive of the CVT, two meshes and a differential behind the secondary shaft.
//!
//! | label | statement | status |
//! |---|---|---|
//! | FD-1 | final drive at the secondary shaft: T = c exp(-n/n0) + c_v (nu/nu_80)^m, the second term by FH-1 | fitted to thesis 5.5.1; the fall with speed is measured and unexplained there |
//! | FD-2 | mesh: \|T_sec - T_wheel/i - FD-1\| = (1 - eta) \|T\| in both directions of power | ASSUMED eta, 0.98 to 0.985 for two helical meshes |
//!
//! nu_80 = 11 mm2/s is the viscosity at which the constants hold, without the heating of the films. Below 25 degC the viscous term is
//! extrapolated, bounded by the heating of its films (FH-1). Unmeasured there.

use crate::keys::{Values, keys};
use crate::transmission::viscous_self_heating::{SELF_HEATING, ViscousSelfHeating};

/// The checked final drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinalDrive {
    /// Speed of the secondary over that of the wheels (CV-1).
    pub ratio: f64,
    /// FD-1 torque that falls with speed, Nm.
    pub boundary_nm: f64,
    /// FD-1 speed scale n0, rad/s.
    pub scale_rad_s: f64,
    /// FD-1 viscous torque at reference viscosity, Nm.
    pub viscous_nm: f64,
    /// FD-1 exponent of viscosity.
    pub exponent: f64,
    /// Heating of its films (FH-1).
    pub heating: ViscousSelfHeating,
    /// FD-2 mesh efficiency.
    pub mesh_efficiency: f64,
}

impl FinalDrive {
    /// -n/n0 of FD-1.
    #[inline]
    pub fn fall_exponent(&self, secondary_rad_s: f64) -> f64 {
        -secondary_rad_s / self.scale_rad_s
    }

    /// Load-independent torque at the secondary shaft, Nm, with the power (nu/nu_80)^m and exp(-n/n0) known (FD-1).
    #[inline]
    pub fn drag_nm(&self, power: f64, fall: f64, secondary_rad_s: f64) -> f64 {
        self.boundary_nm * fall
            + self
                .heating
                .torque_nm(self.viscous_nm * power, secondary_rad_s) // FD-1
    }

    /// Torque at the secondary shaft for a torque after the final drive, both at the secondary's speed, Nm (FD-2).
    #[inline]
    pub fn secondary_torque_nm(&self, drag_nm: f64, output_nm: f64) -> f64 {
        let through = output_nm + drag_nm;
        through
            * if through >= 0.0 {
                1.0 / self.mesh_efficiency
            } else {
                self.mesh_efficiency
            } // FD-2
    }
}

keys! {
    /// Keys of `[transmission.cvt.final_drive]`.
    DRIVE: DriveKeys = "final_drive" [] {
        boundary_nm: number(0.0, 20.0), "part that falls with speed, at the secondary", ["FD-1"];
        boundary_rpm: number(10.0, 20_000.0), "its speed scale", ["FD-1"];
        viscous_nm: number(0.0, 20.0), "viscous part at 11 mm2/s", ["FD-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["FD-1"];
        film_heating_w: SELF_HEATING, "viscous dissipation at which the heat of the films halves it; absent: no heating", ["FD-1", "FH-1"];
        mesh_efficiency: number(0.8, 1.0), "efficiency of the meshes", ["FD-2"];
    }
}

impl FinalDrive {
    /// The final drive from the values of its table.
    pub(super) fn from_values<V: Values>(s: &V, ratio: f64) -> Self {
        FinalDrive {
            ratio,
            boundary_nm: s.number(&DRIVE.boundary_nm),
            scale_rad_s: s.number(&DRIVE.boundary_rpm),
            viscous_nm: s.number(&DRIVE.viscous_nm),
            exponent: s.number(&DRIVE.viscous_exponent),
            heating: ViscousSelfHeating::from_values(s, &DRIVE.film_heating_w),
            mesh_efficiency: s.number(&DRIVE.mesh_efficiency),
        }
    }
}
