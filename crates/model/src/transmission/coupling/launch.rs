//! The coupling of a box, in a form that the compiler sees through: clutch or converter of several runs side by side, or any other device lane by lane.

use super::{
    Coupling, CouplingLoad, DriverClutch, EngineSide, FrictionClutch, Hold, LockSignals,
    TorqueConverter, Turning,
};
use crate::math::{Gather, Mask, Real, physics};
use std::sync::Arc;

/// The coupling of a box.
#[derive(Clone, Debug)]
pub enum Launch<R: Real = f64> {
    /// A friction clutch, with factors on its loss.
    Clutch(DriverClutch<R>),
    /// A torque converter that loses what its model says.
    Converter(TorqueConverter<R>),
    /// Another device, one for each run, and a one with their lanes.
    Other(R::PerLane<Device>, R),
}

/// A device of one run.
#[derive(Clone, Debug)]
pub struct Device(Arc<dyn Coupling>);

/// Two are the same where they are one.
impl PartialEq for Device {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Launch {
    /// Another device.
    pub(in crate::transmission) fn other(device: impl Coupling + 'static) -> Self {
        Launch::Other(Device(Arc::new(device)), 1.0)
    }
}

impl<R: Real> Launch<R> {
    /// The friction clutch, if it is one.
    fn as_clutch(&self) -> Option<&DriverClutch<R>> {
        match self {
            Launch::Clutch(clutch) => Some(clutch),
            Launch::Converter(_) | Launch::Other(..) => None,
        }
    }

    /// The torque converter, if it is one.
    fn as_converter(&self) -> Option<&TorqueConverter<R>> {
        match self {
            Launch::Converter(converter) => Some(converter),
            Launch::Clutch(_) | Launch::Other(..) => None,
        }
    }

    /// A friction clutch that loses what its model says.
    pub(super) fn clutch(clutch: FrictionClutch<R>) -> Self {
        Launch::Clutch(DriverClutch::new(clutch))
    }
}

impl Gather for Launch {
    type Together<R: Real> = Launch<R>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> Launch<R> {
        let clutches: Option<Vec<_>> = of.iter().map(|launch| launch.as_clutch()).collect();
        let converters: Option<Vec<_>> = of.iter().map(|launch| launch.as_converter()).collect();
        if let Some(clutches) = clutches {
            return Launch::Clutch(Gather::gather(like, &clutches));
        }
        if let Some(converters) = converters {
            return Launch::Converter(Gather::gather(like, &converters));
        }
        let device = |lane: usize| match of[lane] {
            Launch::Clutch(clutch) => Device(Arc::new(clutch.clone())),
            Launch::Converter(converter) => Device(Arc::new(converter.clone())),
            Launch::Other(device, _) => device.clone(),
        };
        Launch::Other(R::per_lane(device), like.splat(1.0))
    }

    fn lane<R: Real>(together: &Launch<R>, lane: usize) -> Self {
        match together {
            Launch::Clutch(clutch) => Launch::Clutch(Gather::lane(clutch, lane)),
            Launch::Converter(converter) => Launch::Converter(Gather::lane(converter, lane)),
            Launch::Other(devices, _) => Launch::Other(R::get(devices, lane).clone(), 1.0),
        }
    }

    fn groups_with(&self, other: &Self) -> bool {
        match (self, other) {
            (Launch::Clutch(own), Launch::Clutch(other)) => own.groups_with(other),
            (Launch::Converter(own), Launch::Converter(other)) => own.groups_with(other),
            (Launch::Other(..), Launch::Other(..)) => {
                let with_factor = |launch: &Launch| launch.loss_factor().is_some();
                self.by_command() == other.by_command() && with_factor(self) == with_factor(other)
            }
            _ => false,
        }
    }
}

/// The engine's side of each run.
#[physics]
fn sides<R: Real>(like: R, side: impl Fn(usize) -> EngineSide) -> EngineSide<R> {
    let mut all = EngineSide {
        engine_nm: like,
        engine_rad_s: like,
        loss_w: like,
    };
    for lane in 0..R::LANES {
        let one = side(lane);
        all.engine_nm = all.engine_nm.with_lane(lane, one.engine_nm);
        all.engine_rad_s = all.engine_rad_s.with_lane(lane, one.engine_rad_s);
        all.loss_w = all.loss_w.with_lane(lane, one.loss_w);
    }
    all
}

/// The device of a lane.
#[physics]
fn one<R: Real>(devices: &R::PerLane<Device>, lane: usize) -> &dyn Coupling {
    &*R::get(devices, lane).0
}

/// The turning speeds of a lane.
#[physics]
fn turning<R: Real>(at: &Turning<R>, lane: usize) -> Turning {
    Turning {
        output_rad_s: at.output_rad_s.lane(lane),
        engine_rad_s: at.engine_rad_s.lane(lane),
        idle_rad_s: at.idle_rad_s.lane(lane),
        locked: at.locked.lane(lane),
    }
}

/// Hold of the device of one run, in each lane.
fn holds<R: Real>(devices: &R::PerLane<Device>, now: &LockSignals<R>, past: R::Mask) -> Hold<R> {
    let like = now.output_rad_s;
    let hold = |lane: usize| {
        let now = LockSignals {
            speed_m_s: now.speed_m_s,
            sump_k: now.sump_k.lane(lane),
            output_rad_s: now.output_rad_s.lane(lane),
            idle_rad_s: now.idle_rad_s.lane(lane),
            faster_rad_s: now.faster_rad_s.lane(lane),
            dt_s: now.dt_s,
        };
        one::<R>(devices, lane).hold(&now, past.lane(lane))
    };
    Hold {
        coupled: like.mask_lanes(|lane| hold(lane).coupled),
        locked_from_rad_s: like.map_lanes(|lane| hold(lane).locked_from_rad_s),
        slip_rad_s: like.map_lanes(|lane| hold(lane).slip_rad_s),
        closing_rad_s: like.map_lanes(|lane| hold(lane).closing_rad_s),
        left_share: like.map_lanes(|lane| hold(lane).left_share),
    }
}

/// One number of the clutch or converter, or of the device of each lane.
macro_rules! ask {
    ($self:ident, $like:ident, $lane:ident, $method:ident($($argument:expr),*), $($own:expr),*) => {
        match $self {
            Launch::Clutch(clutch) => clutch.$method($($argument),*),
            Launch::Converter(converter) => converter.$method($($argument),*),
            Launch::Other(devices, _) => {
                $like.map_lanes(|$lane| one::<R>(devices, $lane).$method($($own),*))
            }
        }
    };
}

#[physics]
impl<R: Real> Coupling<R> for Launch<R> {
    fn engine_rad_s(&self, load: &CouplingLoad<R>) -> R {
        let like = load.output_nm;
        let own = |lane: usize| CouplingLoad {
            output_nm: load.output_nm.lane(lane),
            output_rad_s: load.output_rad_s.lane(lane),
            idle_rad_s: load.idle_rad_s.lane(lane),
            coupled: load.coupled.lane(lane),
        };
        ask!(self, like, lane, engine_rad_s(load), &own(lane))
    }

    fn min_engine_rad_s(&self, output_rad_s: R) -> R {
        ask!(
            self,
            output_rad_s,
            lane,
            min_engine_rad_s(output_rad_s),
            output_rad_s.lane(lane)
        )
    }

    fn locked_from_rad_s(&self, idle_rad_s: R) -> R {
        ask!(
            self,
            idle_rad_s,
            lane,
            locked_from_rad_s(idle_rad_s),
            idle_rad_s.lane(lane)
        )
    }

    fn by_command(&self) -> bool {
        match self {
            Launch::Clutch(clutch) => clutch.by_command(),
            Launch::Converter(converter) => converter.by_command(),
            Launch::Other(devices, _) => one::<R>(devices, 0).by_command(),
        }
    }

    fn hold(&self, now: &LockSignals<R>, past: R::Mask) -> Hold<R> {
        match self {
            Launch::Clutch(clutch) => clutch.hold(now, past),
            Launch::Converter(converter) => converter.hold(now, past),
            Launch::Other(devices, _) => holds::<R>(devices, now, past),
        }
    }

    fn locked_side(&self, output_nm: R, output_rad_s: R, slip_rad_s: R) -> EngineSide<R> {
        match self {
            Launch::Clutch(clutch) => clutch.locked_side(output_nm, output_rad_s, slip_rad_s),
            Launch::Converter(converter) => {
                converter.locked_side(output_nm, output_rad_s, slip_rad_s)
            }
            Launch::Other(devices, _) => sides(output_nm, |lane| {
                let (w, slip) = (output_rad_s.lane(lane), slip_rad_s.lane(lane));
                one::<R>(devices, lane).locked_side(output_nm.lane(lane), w, slip)
            }),
        }
    }

    fn engine_side(&self, output_nm: R, output_rad_s: R, engine_rad_s: R) -> EngineSide<R> {
        match self {
            Launch::Clutch(clutch) => clutch.engine_side(output_nm, output_rad_s, engine_rad_s),
            Launch::Converter(converter) => {
                converter.engine_side(output_nm, output_rad_s, engine_rad_s)
            }
            Launch::Other(devices, _) => sides(output_nm, |lane| {
                let (output, engine) = (output_rad_s.lane(lane), engine_rad_s.lane(lane));
                one::<R>(devices, lane).engine_side(output_nm.lane(lane), output, engine)
            }),
        }
    }

    fn output_nm(&self, engine_nm: R, output_rad_s: R, engine_rad_s: R) -> R {
        ask!(
            self,
            engine_nm,
            lane,
            output_nm(engine_nm, output_rad_s, engine_rad_s),
            engine_nm.lane(lane),
            output_rad_s.lane(lane),
            engine_rad_s.lane(lane)
        )
    }

    fn creep_nm(&self, output_rad_s: R, idle_rad_s: R) -> R {
        ask!(
            self,
            idle_rad_s,
            lane,
            creep_nm(output_rad_s, idle_rad_s),
            output_rad_s.lane(lane),
            idle_rad_s.lane(lane)
        )
    }

    fn overrun_share(&self, output_rad_s: R, idle_rad_s: R) -> R {
        ask!(
            self,
            idle_rad_s,
            lane,
            overrun_share(output_rad_s, idle_rad_s),
            output_rad_s.lane(lane),
            idle_rad_s.lane(lane)
        )
    }

    fn min_output_nm(&self, at: &Turning<R>, absorbed_nm: R) -> R {
        ask!(
            self,
            absorbed_nm,
            lane,
            min_output_nm(at, absorbed_nm),
            &turning(at, lane),
            absorbed_nm.lane(lane)
        )
    }

    #[inline]
    fn at_least_speed(&self) -> Option<Launch<R>> {
        match self {
            Launch::Clutch(clutch) => clutch.at_least_speed(),
            Launch::Converter(converter) => converter.at_least_speed(),
            Launch::Other(devices, like) => {
                let each = (0..R::LANES).map(|lane| one::<R>(devices, lane).at_least_speed());
                let each: Vec<Launch> = each.collect::<Option<_>>()?;
                let of: Vec<&Launch> = each.iter().collect();
                Some(Launch::gather(*like, &of))
            }
        }
    }

    #[inline]
    fn device(&self) -> &'static str {
        match self {
            Launch::Clutch(clutch) => clutch.device(),
            Launch::Converter(converter) => converter.device(),
            Launch::Other(devices, _) => one::<R>(devices, 0).device(),
        }
    }

    fn loss_factor(&self) -> Option<R> {
        match self {
            Launch::Clutch(clutch) => clutch.loss_factor(),
            Launch::Converter(converter) => converter.loss_factor(),
            Launch::Other(devices, like) => {
                one::<R>(devices, 0).loss_factor()?;
                Some(like.map_lanes(|lane| one::<R>(devices, lane).loss_factor().unwrap_or(1.0)))
            }
        }
    }
}
