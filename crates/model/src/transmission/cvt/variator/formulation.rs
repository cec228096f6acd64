//! The points where the thesis's chapter 8 and its own program (Appendix C) disagree, as one switch.
//!
//! In driving, every formulation keeps the smooth rules (TE-6, SL-8, real segment count, bounded slip); the choice moves only
//! the rows below.

use crate::keys::Choice;
use crate::math::{Real, physics, tan};

/// Reading of the belt model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    /// For driving: Appendix C, with chapter 8's sign of the primary slip in inverted loading and the end-stop ramp.
    #[default]
    Smooth,
    /// The printed program's choices.
    AppendixC,
    /// The chapter's equations.
    Chapter8,
}

#[physics]
impl Formulation {
    /// Names as on the command line.
    pub const NAMES: [(&'static str, Formulation); 3] = [
        ("smooth", Formulation::Smooth),
        ("appendix_c", Formulation::AppendixC),
        ("chapter_8", Formulation::Chapter8),
    ];

    /// The names as options of a key.
    pub const CHOICES: &'static [Choice] = &[
        Choice::word(
            Self::NAMES[0].0,
            "for driving: smooth between loading cases",
        ),
        Choice::word(Self::NAMES[1].0, "as the printed program of Appendix C"),
        Choice::word(Self::NAMES[2].0, "as the equations of chapter 8"),
    ];

    /// Name of the formulation.
    pub fn name(self) -> &'static str {
        let own = Self::NAMES.iter().find(|(_, other)| *other == self);
        own.map_or("", |(name, _)| name)
    }

    /// The formulation of a name.
    pub fn named(name: &str) -> Option<Self> {
        let own = Self::NAMES.iter().find(|(other, _)| *other == name);
        own.map(|(_, formulation)| *formulation)
    }

    /// Segment friction where the formulation prescribes it; the fluid's otherwise.
    pub fn segment_friction<R: Real>(self, fluid: R) -> R {
        match self {
            Formulation::Smooth => fluid,
            Formulation::AppendixC => fluid.splat(0.125),
            Formulation::Chapter8 => fluid.splat(0.13),
        }
    }

    /// Friction that bounds the torque: of macro slip (VA-4), in the printed forms that of micro slip (VA-2).
    pub fn capacity_friction<R: Real>(self, segment: R, macro_slip: R) -> R {
        match self {
            Formulation::Smooth => macro_slip,
            Formulation::AppendixC | Formulation::Chapter8 => segment,
        }
    }

    /// True if the bands may ride on oil: the film is no part of the thesis's two readings (LU-4, FI-1).
    #[inline]
    pub fn has_film(self) -> bool {
        self == Formulation::Smooth
    }

    /// One force between bands and segments on both pulleys (TE-7, BT-6), and the share of slip in the loss by statics (SL-11, SL-12). The
    /// printed forms take the tension step from the primary alone, and count slip by the forces on the segments (SL-7).
    #[inline]
    pub fn by_statics(self) -> bool {
        self == Formulation::Smooth
    }

    /// Band friction force scaled by the smaller wrap.
    #[inline]
    pub fn scales_band_force(self) -> bool {
        self != Formulation::Chapter8
    }

    /// Idle slip of conventional loading with its sign (eq. 67) instead of its magnitude.
    #[inline]
    pub fn signed_idle_slip(self) -> bool {
        self == Formulation::Chapter8
    }

    /// Slip loss of the idle arc counted (eq. 75, 76).
    #[inline]
    pub fn counts_idle_arc(self) -> bool {
        self == Formulation::Chapter8
    }

    /// The program's extra minus on the primary slip of inverted loading.
    #[inline]
    pub fn flips_inverted_primary(self) -> bool {
        self == Formulation::AppendixC
    }

    /// Wedge arcs counted for each pulley.
    #[inline]
    pub fn wedge_arcs(self) -> f64 {
        if self == Formulation::Chapter8 {
            2.0
        } else {
            1.0
        }
    }

    /// Wedge force at the secondary from the secondary's own clamping.
    #[inline]
    pub fn own_wedge_force(self) -> bool {
        self == Formulation::Chapter8
    }

    /// Penetration depth delta/(2 tan th) (eq. 95) instead of delta.
    #[inline]
    pub fn radial_penetration(self) -> bool {
        self == Formulation::Chapter8
    }

    /// tan of the angle in the wedge terms: the program has a literal 11 degrees.
    pub fn wedge_tan<R: Real>(self, own: R) -> R {
        if self == Formulation::AppendixC {
            own.splat(tan(11.0f64.to_radians()))
        } else {
            own
        }
    }

    /// Part of the primary's deflection left near its end stop, from the ramp's value (1 away from the stop).
    pub fn primary_stop<R: Real>(self, ramp: R) -> R {
        match self {
            Formulation::AppendixC => ramp.splat(1.0),
            Formulation::Smooth | Formulation::Chapter8 => ramp,
        }
    }

    /// Segment compression as the slip equations take it: the program lifts \|C_x\| < 30 N to +30 N, the chapter to 30 N with its sign.
    pub fn compression_n<R: Real>(self, cx: R) -> R {
        let lifted = |cx: f64| match self {
            Formulation::AppendixC if cx.abs() < 30.0 => 30.0,
            Formulation::Chapter8 if cx.abs() < 30.0 => 30.0f64.copysign(cx),
            _ => cx,
        };
        match self {
            Formulation::Smooth => cx,
            Formulation::AppendixC | Formulation::Chapter8 => cx.map(lifted),
        }
    }
}
