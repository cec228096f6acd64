//! Several runs side by side: 4 or 8 numbers in the processor's vectors, and records of them gathered from one record a run.
//!
//! [`f64x4`] and [`f64x8`] are [`Real`]: an equation that is written over `R` works on a whole group of runs. Which instructions the processor
//! has is found at run time; [`dispatch`] calls a function once for the best of them, and every part that is inlined into it, or called by
//! [`Real::vectorize`], is compiled for it. Neither level nor width moves a bit: nothing is contracted, and what is no plain arithmetic is done
//! lane by lane in f64.
//!
//! `derive(Gather)` makes the record of a group from one record a run. Fields with `#[gather(same)]` are shared by the runs of a group, so an equation
//! may branch on them; [`Gather::groups_with`] compares them.

use super::curve::Curve;
use super::curves::{Curves, across};
use super::physics;
use super::real::{LaneValue, Mask, Operand, Real, Selectable};
use super::{circular, elementary};
use fearless_simd::{
    Bytes, Select, SimdBase, SimdFloat, SimdMask, mask64x4, mask64x8, u64x4, u64x8,
};
use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

pub use fearless_simd::{Level, Simd, dispatch, f64x4, f64x8};

/// A bool for each lane of a vector of the processor.
#[derive(Clone, Copy)]
pub struct LaneMask<M>(M);

macro_rules! lanes {
    ($($vector:ident $mask:ident $bits:ident $count:literal),*) => {$(
        #[physics]
        impl<S: Simd> BitAnd for LaneMask<$mask<S>> {
            type Output = Self;
            fn bitand(self, other: Self) -> Self {
                LaneMask(self.0 & other.0)
            }
        }

        #[physics]
        impl<S: Simd> BitOr for LaneMask<$mask<S>> {
            type Output = Self;
            fn bitor(self, other: Self) -> Self {
                LaneMask(self.0 | other.0)
            }
        }

        #[physics]
        impl<S: Simd> Not for LaneMask<$mask<S>> {
            type Output = Self;
            fn not(self) -> Self {
                LaneMask(!self.0)
            }
        }

        impl<S: Simd> Debug for LaneMask<$mask<S>> {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.debug_list()
                    .entries((0..$count).map(|lane| self.lane(lane)))
                    .finish()
            }
        }

        impl<S: Simd> PartialEq for LaneMask<$mask<S>> {
            fn eq(&self, other: &Self) -> bool {
                self.0.to_bitmask() == other.0.to_bitmask()
            }
        }

        #[physics]
        impl<S: Simd> Mask for LaneMask<$mask<S>> {
            fn any(self) -> bool {
                self.0.any_true()
            }

            fn all(self) -> bool {
                self.0.all_true()
            }

            fn lane(self, lane: usize) -> bool {
                (self.0.to_bitmask() >> lane) & 1 == 1
            }
        }

        #[physics]
        impl<S: Simd> Selectable<Self> for LaneMask<$mask<S>> {
            fn select(mask: Self, if_true: Self, if_false: Self) -> Self {
                (mask & if_true) | (!mask & if_false)
            }
        }

        #[physics]
        impl<S: Simd> Selectable<LaneMask<$mask<S>>> for $vector<S> {
            fn select(mask: LaneMask<$mask<S>>, if_true: Self, if_false: Self) -> Self {
                mask.0.select(if_true, if_false)
            }
        }

        #[physics]
        impl<S: Simd> Operand<$vector<S>> for f64 {
            fn broadcast(self, like: $vector<S>) -> $vector<S> {
                like.splat(self)
            }
        }

        #[physics]
        impl<S: Simd> Real for $vector<S> {
            type Mask = LaneMask<$mask<S>>;
            type PerLane<T: LaneValue> = [T; $count];
            type Curve = Curves<$count>;
            const LANES: usize = $count;

            fn splat(self, number: f64) -> Self {
                SimdBase::splat(self.simd, number)
            }

            fn map_lanes(self, f: impl Fn(usize) -> f64) -> Self {
                Self::from_fn(self.simd, f)
            }

            fn lane(self, lane: usize) -> f64 {
                self[lane]
            }

            fn with_lane(mut self, lane: usize, number: f64) -> Self {
                self[lane] = number;
                self
            }

            fn splat_mask(self, yes: bool) -> Self::Mask {
                LaneMask($mask::splat(self.simd, yes))
            }

            fn mask_lanes(self, f: impl Fn(usize) -> bool) -> Self::Mask {
                let bits = (0..$count).fold(0, |bits, lane| bits | (u64::from(f(lane)) << lane));
                LaneMask($mask::from_bitmask(self.simd, bits))
            }

            fn per_lane<T: LaneValue>(f: impl FnMut(usize) -> T) -> [T; $count] {
                std::array::from_fn(f)
            }

            fn get<T: LaneValue>(values: &[T; $count], lane: usize) -> &T {
                &values[lane]
            }

            fn get_mut<T: LaneValue>(values: &mut [T; $count], lane: usize) -> &mut T {
                &mut values[lane]
            }

            fn curves(of: impl FnMut(usize) -> Curve) -> Curves<$count> {
                Curves::new(of)
            }

            fn curve(of: &Curves<$count>, lane: usize) -> &Curve {
                of.one(lane)
            }

            fn interpolate(self, curves: &Curves<$count>) -> Self {
                match curves.common() {
                    Some(curve) if self.ge(self).all() => {
                        across(curve, self, (self.reduce_min(), self.reduce_max()))
                    }
                    _ => {
                        let y = curves.at(std::array::from_fn(|lane| self[lane]));
                        Real::map_lanes(self, |lane| y[lane])
                    }
                }
            }

            fn map(self, f: impl Fn(f64) -> f64) -> Self {
                Self::from_fn(self.simd, |lane| f(self[lane]))
            }

            fn gt(self, other: impl Operand<Self>) -> Self::Mask {
                LaneMask(self.simd_gt(other.broadcast(self)))
            }

            fn ge(self, other: impl Operand<Self>) -> Self::Mask {
                LaneMask(self.simd_ge(other.broadcast(self)))
            }

            fn bits_eq(self, other: Self) -> Self::Mask {
                let bits: $bits<S> = self.bitcast();
                LaneMask(bits.simd_eq(other.bitcast::<$bits<S>>()))
            }

            fn abs(self) -> Self {
                <Self as SimdBase<S>>::abs(self)
            }

            fn sqrt(self) -> Self {
                <Self as SimdFloat<S>>::sqrt(self)
            }

            fn vectorize<T>(self, part: impl FnOnce() -> T) -> T {
                self.simd.vectorize(part)
            }

            fn exp(self) -> Self {
                elementary::exp_lanes(self)
            }

            fn ln(self) -> Self {
                elementary::ln_lanes(self)
            }

            fn tanh(self) -> Self {
                elementary::tanh_lanes(self)
            }

            fn asin(self) -> Self {
                circular::asin_lanes(self)
            }

            fn exp_array<const COUNT: usize>(mut x: [Self; COUNT]) -> [Self; COUNT] {
                for x in &mut x {
                    *x = x.exp();
                }
                x
            }

            fn ln_array<const COUNT: usize>(mut x: [Self; COUNT]) -> [Self; COUNT] {
                for x in &mut x {
                    *x = x.ln();
                }
                x
            }
        }
    )*};
}

lanes!(f64x4 mask64x4 u64x4 4, f64x8 mask64x8 u64x8 8);

/// Largest number of lanes.
pub(crate) const MAX_LANES: usize = 8;

/// Four zeros, from which other numbers take their lanes.
#[physics]
pub fn four<S: Simd>(simd: S) -> f64x4<S> {
    SimdBase::splat(simd, 0.0)
}

/// Eight zeros.
#[physics]
pub fn eight<S: Simd>(simd: S) -> f64x8<S> {
    SimdBase::splat(simd, 0.0)
}

/// A record of one run that several runs side by side can have together.
pub trait Gather: Sized {
    /// The record of all of them.
    type Together<R: Real>;

    /// The record of the runs of a group, one for each lane of `like`; they are [`Gather::groups_with`].
    fn gather<R: Real>(like: R, runs: &[&Self]) -> Self::Together<R>;

    /// The record of one run out of that of a group.
    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self;

    /// True if two records fit in one group: their shared fields are equal.
    fn groups_with(&self, other: &Self) -> bool;
}

impl Gather for f64 {
    type Together<R: Real> = R;

    fn gather<R: Real>(like: R, runs: &[&f64]) -> R {
        like.map_lanes(|lane| *runs[lane])
    }

    fn lane<R: Real>(together: &R, lane: usize) -> f64 {
        together.lane(lane)
    }

    fn groups_with(&self, _: &f64) -> bool {
        true
    }
}

impl Gather for bool {
    type Together<R: Real> = R::Mask;

    fn gather<R: Real>(like: R, runs: &[&bool]) -> R::Mask {
        like.mask_lanes(|lane| *runs[lane])
    }

    fn lane<R: Real>(together: &R::Mask, lane: usize) -> bool {
        together.lane(lane)
    }

    fn groups_with(&self, _: &bool) -> bool {
        true
    }
}

/// Implements `Gather` for types that are looked up lane by lane.
macro_rules! gather_each {
    ($($name:ty),* $(,)?) => {$(
        impl $crate::math::Gather for $name {
            type Together<R: $crate::math::Real> = R::PerLane<$name>;

            fn gather<R: $crate::math::Real>(_: R, runs: &[&Self]) -> R::PerLane<$name> {
                R::per_lane(|lane| runs[lane].clone())
            }

            fn lane<R: $crate::math::Real>(together: &R::PerLane<$name>, lane: usize) -> Self {
                R::get(together, lane).clone()
            }

            fn groups_with(&self, _: &Self) -> bool {
                true
            }
        }
    )*};
}
pub(crate) use gather_each;

impl Gather for Curve {
    type Together<R: Real> = R::Curve;

    fn gather<R: Real>(_: R, runs: &[&Self]) -> R::Curve {
        R::curves(|lane| runs[lane].clone())
    }

    fn lane<R: Real>(together: &R::Curve, lane: usize) -> Self {
        R::curve(together, lane).clone()
    }

    fn groups_with(&self, _: &Self) -> bool {
        true
    }
}

impl<T: Gather, const COUNT: usize> Gather for [T; COUNT] {
    type Together<R: Real> = [T::Together<R>; COUNT];

    fn gather<R: Real>(like: R, runs: &[&Self]) -> Self::Together<R> {
        std::array::from_fn(|k| {
            let each: Vec<&T> = runs.iter().map(|one| &one[k]).collect();
            T::gather(like, &each)
        })
    }

    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self {
        std::array::from_fn(|k| T::lane(&together[k], lane))
    }

    fn groups_with(&self, other: &Self) -> bool {
        self.iter().zip(other).all(|(a, b)| a.groups_with(b))
    }
}

impl<T: Gather> Gather for Vec<T> {
    type Together<R: Real> = Vec<T::Together<R>>;

    fn gather<R: Real>(like: R, runs: &[&Self]) -> Self::Together<R> {
        let part = |k: usize| {
            let each: Vec<&T> = runs.iter().map(|one| &one[k]).collect();
            T::gather(like, &each)
        };
        (0..runs[0].len()).map(part).collect()
    }

    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self {
        together.iter().map(|part| T::lane(part, lane)).collect()
    }

    fn groups_with(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().zip(other).all(|(a, b)| a.groups_with(b))
    }
}

impl<T: Gather> Gather for Option<T> {
    type Together<R: Real> = Option<T::Together<R>>;

    fn gather<R: Real>(like: R, runs: &[&Self]) -> Self::Together<R> {
        let each: Option<Vec<&T>> = runs.iter().map(|one| one.as_ref()).collect();
        each.map(|each| T::gather(like, &each))
    }

    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self {
        together.as_ref().map(|one| T::lane(one, lane))
    }

    fn groups_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Some(a), Some(b)) => a.groups_with(b),
            (None, None) => true,
            _ => false,
        }
    }
}

impl<T: Gather> Gather for Box<T> {
    type Together<R: Real> = Box<T::Together<R>>;

    fn gather<R: Real>(like: R, runs: &[&Self]) -> Self::Together<R> {
        let each: Vec<&T> = runs.iter().map(|one| &***one).collect();
        Box::new(T::gather(like, &each))
    }

    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self {
        Box::new(T::lane(together, lane))
    }

    fn groups_with(&self, other: &Self) -> bool {
        (**self).groups_with(other)
    }
}
