//! Input shaft, reverse clutch and final drive of the CVT: losses that turn with the shafts.
//!
//! | label | statement | status |
//! |---|---|---|
//! | IS-1 | input shaft: T = c0 + c1 (nu/nu_80)^m n/1000 rpm, the second term by FH-1 | source: thesis 7.3, 5.5.5 in form; fitted to 1-2 Nm over 1000-4000 rpm |
//! | CD-1 | reverse clutch: T = min(c (nu/nu_80)^m, cap) | source: thesis 7.6 in form; fitted to 5.5.3; cap: 5.5.3 "approximately 0.5 Nm" below 25 degC |
//! | FD-1 | final drive at the secondary shaft: T = c exp(-n/n0) + c_v (nu/nu_80)^m, the second term by FH-1 | fitted to thesis 5.5.1; the fall with speed is measured and unexplained there |
//! | FD-2 | mesh: \|T_sec - T_wheel/i - FD-1\| = (1 - eta) \|T\| in both directions of power | ASSUMED eta, 0.98 to 0.985 for two helical meshes |
//!
//! nu_80 = 11 mm2/s is the viscosity at which the constants hold, without the heating of the films. Below 25 degC all three are
//! extrapolated; the cap bounds CD-1, the heating of their films (FH-1) the viscous terms of IS-1 and FD-1. Unmeasured there.

use crate::keys::{Values, keys};
use crate::math::{exp, exp_each, ln, smaller};
use crate::transmission::viscous_self_heating::SELF_HEATING;
use crate::transmission::viscous_self_heating::ViscousSelfHeating;

/// Kinematic viscosity to which the constants refer, m2/s.
pub const NU_REFERENCE_M2_S: f64 = 11.0e-6;

/// The checked constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spin {
    /// IS-1 constant, Nm.
    pub shaft_constant_nm: f64,
    /// IS-1 slope at reference viscosity, Nm s/rad.
    pub shaft_viscous_nm_s: f64,
    /// IS-1 exponent.
    pub shaft_exponent: f64,
    /// Heating of the input shaft's films (FH-1).
    pub shaft_heating: ViscousSelfHeating,
    /// CD-1 torque at reference viscosity, Nm.
    pub clutch_nm: f64,
    /// CD-1 exponent.
    pub clutch_exponent: f64,
    /// CD-1 cap, Nm.
    pub clutch_cap_nm: f64,
    /// FD-1 torque that falls with speed, Nm.
    pub drive_boundary_nm: f64,
    /// FD-1 speed scale n0, rad/s.
    pub drive_scale_rad_s: f64,
    /// FD-1 viscous torque at reference viscosity, Nm.
    pub drive_viscous_nm: f64,
    /// FD-1 exponent.
    pub drive_exponent: f64,
    /// Heating of the final drive's films (FH-1).
    pub drive_heating: ViscousSelfHeating,
    /// FD-2 mesh efficiency.
    pub mesh_efficiency: f64,
}

/// The constants at one oil temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpinAtTemperature {
    shaft_constant_nm: f64,
    shaft_slope_nm_s: f64,
    shaft_heating: ViscousSelfHeating,
    /// Reverse clutch drag, Nm.
    pub clutch_nm: f64,
    drive_viscous_nm: f64,
}

impl Spin {
    /// The constants at a viscosity.
    #[inline]
    pub fn at(&self, nu_m2_s: f64) -> SpinAtTemperature {
        self.with_powers(exp_each(self.exponents(ln(nu_m2_s / NU_REFERENCE_M2_S))))
    }

    /// Logarithms of the powers of viscosity in IS-1, CD-1 and FD-1, from ln(nu/nu_80).
    #[inline]
    pub fn exponents(&self, log_nu: f64) -> [f64; 3] {
        [
            self.shaft_exponent * log_nu,
            self.clutch_exponent * log_nu,
            self.drive_exponent * log_nu,
        ]
    }

    /// The constants with the powers of viscosity known.
    #[inline]
    pub fn with_powers(&self, [shaft, clutch, drive]: [f64; 3]) -> SpinAtTemperature {
        let clutch_nm = self.clutch_nm * clutch;
        SpinAtTemperature {
            shaft_constant_nm: self.shaft_constant_nm,
            shaft_slope_nm_s: self.shaft_viscous_nm_s * shaft,
            shaft_heating: self.shaft_heating,
            clutch_nm: smaller(clutch_nm, self.clutch_cap_nm), // CD-1
            drive_viscous_nm: self.drive_viscous_nm * drive,
        }
    }

    /// Load-independent torque of the final drive at the secondary shaft, Nm (FD-1).
    #[inline]
    pub fn drive_nm(&self, now: &SpinAtTemperature, secondary_rad_s: f64) -> f64 {
        self.drive_with_fall_nm(
            now,
            secondary_rad_s,
            exp(self.drive_fall_exponent(secondary_rad_s)),
        )
    }

    /// -n/n0 of FD-1.
    #[inline]
    pub fn drive_fall_exponent(&self, secondary_rad_s: f64) -> f64 {
        -secondary_rad_s / self.drive_scale_rad_s
    }

    /// The same torque, Nm, with exp(-n/n0) known (FD-1).
    #[inline]
    pub fn drive_with_fall_nm(
        &self,
        now: &SpinAtTemperature,
        secondary_rad_s: f64,
        fall: f64,
    ) -> f64 {
        self.drive_boundary_nm * fall
            + self
                .drive_heating
                .torque_nm(now.drive_viscous_nm, secondary_rad_s) // FD-1
    }

    /// Torque at the secondary shaft for a torque after the final drive, both at the secondary's speed, Nm (FD-2).
    #[inline]
    pub fn secondary_torque_nm(&self, drive_nm: f64, output_nm: f64) -> f64 {
        let through = output_nm + drive_nm;
        through
            * if through >= 0.0 {
                1.0 / self.mesh_efficiency
            } else {
                self.mesh_efficiency
            } // FD-2
    }
}

impl SpinAtTemperature {
    /// Input shaft torque, Nm (IS-1).
    #[inline]
    pub fn shaft_nm(&self, speed_rad_s: f64) -> f64 {
        self.shaft_constant_nm
            + self
                .shaft_heating
                .torque_nm(self.shaft_slope_nm_s * speed_rad_s, speed_rad_s) // IS-1
    }
}

keys! {
    /// Keys of `[transmission.cvt.input_shaft]`.
    SHAFT: ShaftKeys = "input_shaft" [] {
        constant_nm: number(0.0, 20.0), "torque at rest", ["IS-1"];
        viscous_nm_per_rpm: number(0.0, 0.01), "slope at 11 mm2/s", ["IS-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["IS-1"];
        film_heating_w: SELF_HEATING, "viscous dissipation at which the heat of the films halves it; absent: no heating", ["IS-1", "FH-1"];
    }

    /// Keys of `[transmission.cvt.reverse_clutch]`.
    CLUTCH: ClutchKeys = "reverse_clutch" [] {
        drag_nm: number(0.0, 20.0), "drag at 11 mm2/s", ["CD-1"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["CD-1"];
        cap_nm: number(0.0, 20.0), "largest drag", ["CD-1"];
    }

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

impl Spin {
    /// The spin losses from the values of `[transmission.cvt]`.
    pub fn from_values<V: Values>(s: &V) -> Self {
        let (shaft, clutch, drive) = (
            s.table("input_shaft"),
            s.table("reverse_clutch"),
            s.table("final_drive"),
        );
        Spin {
            shaft_constant_nm: shaft.number(&SHAFT.constant_nm),
            shaft_viscous_nm_s: shaft.number(&SHAFT.viscous_nm_per_rpm),
            shaft_exponent: shaft.number(&SHAFT.viscous_exponent),
            shaft_heating: ViscousSelfHeating::from_values(&shaft, &SHAFT.film_heating_w),
            clutch_nm: clutch.number(&CLUTCH.drag_nm),
            clutch_exponent: clutch.number(&CLUTCH.viscous_exponent),
            clutch_cap_nm: clutch.number(&CLUTCH.cap_nm),
            drive_boundary_nm: drive.number(&DRIVE.boundary_nm),
            drive_scale_rad_s: drive.number(&DRIVE.boundary_rpm),
            drive_viscous_nm: drive.number(&DRIVE.viscous_nm),
            drive_exponent: drive.number(&DRIVE.viscous_exponent),
            drive_heating: ViscousSelfHeating::from_values(&drive, &DRIVE.film_heating_w),
            mesh_efficiency: drive.number(&DRIVE.mesh_efficiency),
        }
    }
}
