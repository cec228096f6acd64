//! The loss components of all transmissions: one table with a row each.
//!
//! Columns of traces, benches and studies, fills of charts, the split of heat and the list of a car's components are made from it.

use crate::math::{Gather, Real};
use std::ops::{Index, IndexMut};

/// The transmissions that have a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Coupling between engine and box: every transmission.
    Coupling,
    /// CVT, outside the belt.
    Cvt,
    /// CVT: a part of the loss of belt or chain, absent where a map replaces it.
    Belt,
    /// CVT with a pushing belt: as [`Part::Belt`].
    Bands,
    /// CVT with a chain: as [`Part::Belt`].
    Chain,
    /// CVT with two ranges.
    Ranges,
    /// CVT whose belt is replaced by a measured map.
    BeltMap,
    /// Manual box, absent where a map replaces the box.
    Manual,
    /// Box of either kind that is replaced by a measured map.
    BoxMap,
}

impl Part {
    /// True for the components of a CVT alone, without its coupling.
    pub const fn is_cvt(self) -> bool {
        matches!(
            self,
            Part::Cvt | Part::Belt | Part::Bands | Part::Chain | Part::Ranges | Part::BeltMap
        )
    }
}

/// The thermal node that receives the heat of a component (SI-3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeatTo {
    /// Belt node and sump, by the car's share.
    Belt,
    /// Case and shafts.
    Metal,
    /// Sump.
    Sump,
    /// Sump of a CVT, coolant of a car with a dry clutch.
    Coupling,
}

/// Losses that are shared out together (AT-6).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LossGroup {
    /// Launch device.
    Launch,
    /// Pump.
    Pump,
    /// Shafts of a CVT: input shaft, open clutch, seal rings, pulley bearings.
    Shafts,
    /// Belt.
    Belt,
    /// Final drive of a CVT, with the set for two ranges.
    FinalDrive,
    /// Teeth of a manual box, or the map of a whole box.
    Gears,
    /// Bearings and seals of a manual box.
    BearingsAndSeals,
    /// Churning of a manual box.
    Churning,
}

impl LossGroup {
    /// Name as in JSON keys.
    pub const fn name(self) -> &'static str {
        match self {
            LossGroup::Launch => "launch",
            LossGroup::Pump => "pump",
            LossGroup::Shafts => "shafts",
            LossGroup::Belt => "belt",
            LossGroup::FinalDrive => "final_drive",
            LossGroup::Gears => "gears",
            LossGroup::BearingsAndSeals => "bearings_and_seals",
            LossGroup::Churning => "churning",
        }
    }
}

/// Fill of a component in charts: a place on one of two colour ramps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fill {
    /// Place on the ramp of the CVT's components.
    Cvt(u8),
    /// Place on the ramp of the manual box's components.
    Manual(u8),
}

/// One row of the table of components.
#[derive(Clone, Copy, Debug)]
struct Entry {
    name: &'static str,
    title: &'static str,
    doc: &'static str,
    columns: LossColumns,
    part: Part,
    heat: HeatTo,
    group: LossGroup,
    fill: Fill,
    map_key: Option<&'static str>,
}

/// Names of the columns that hold a component's loss.
#[derive(Clone, Copy, Debug)]
pub struct LossColumns {
    /// Power in a trace, `pump_loss_w`.
    pub loss_w: &'static str,
    /// Torque at the input shaft of a bench, `pump_loss_nm`.
    pub loss_nm: &'static str,
    /// Energy in a study, `pump_loss_kj`.
    pub loss_kj: &'static str,
    /// Torque in a check's table, `pump_nm`.
    pub nm: &'static str,
    /// Energy in a check's table, `pump_kj`.
    pub kj: &'static str,
}

macro_rules! components {
    ($($variant:ident: $name:literal, $title:literal, $part:ident, $heat:ident, $group:ident, $fill:expr, $map:expr, $doc:literal;)*) => {
        /// A loss component of the transmission, in the order of the power flow from the engine to the wheels.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum Component {
            $(#[doc = $doc] $variant,)*
        }

        impl Component {
            /// All components, in the order of the power flow.
            pub const ALL: [Component; Self::COUNT] = [$(Component::$variant),*];
            /// Number of components.
            pub const COUNT: usize = [$(Component::$variant),*].len();
        }

        static TABLE: [Entry; Component::COUNT] = [$(Entry {
            name: $name,
            title: $title,
            doc: $doc,
            columns: LossColumns {
                loss_w: concat!($name, "_loss_w"),
                loss_nm: concat!($name, "_loss_nm"),
                loss_kj: concat!($name, "_loss_kj"),
                nm: concat!($name, "_nm"),
                kj: concat!($name, "_kj"),
            },
            part: Part::$part,
            heat: HeatTo::$heat,
            group: LossGroup::$group,
            fill: $fill,
            map_key: $map,
        }),*];
    };
}

// name, title, transmission, heat, group, fill, key of the map that replaces the model, what the loss is
components! {
    LaunchClutch: "launch_clutch", "Launch clutch", Coupling, Coupling, Launch, Fill::Cvt(0), None, "loss of launch clutch slip and creep";
    Pump: "pump", "Pump", Cvt, Sump, Pump, Fill::Cvt(1), Some("pump"), "loss of the oil pump";
    InputShaft: "input_shaft", "Input shaft", Cvt, Metal, Shafts, Fill::Cvt(2), Some("input_shaft"), "loss of the input shaft's bearings and seals";
    ClutchDrag: "clutch_drag", "Clutch drag", Cvt, Sump, Shafts, Fill::Cvt(3), Some("clutch_drag"), "drag of the open reverse clutch";
    SealRing: "seal_ring", "Seal ring", Cvt, Sump, Shafts, Fill::Cvt(4), Some("seal_ring"), "friction of the rings that seal the oil feed of the rotating cylinders";
    PulleyBearing: "pulley_bearing", "Pulley bearing", Belt, Metal, Shafts, Fill::Cvt(5), None, "load friction of the pulley shafts' bearings under the belt's pull";
    BeltBand: "belt_band", "Belt band", Bands, Belt, Belt, Fill::Cvt(6), None, "boundary friction between bands and between band and segments";
    BeltFilm: "belt_film", "Belt film", Bands, Belt, Belt, Fill::Cvt(7), None, "viscous shear between the bands";
    ChainJoint: "chain_joint", "Chain joint", Chain, Belt, Belt, Fill::Cvt(6), None, "friction in the rocker joints of a chain";
    ChainPin: "chain_pin", "Chain pin", Chain, Belt, Belt, Fill::Cvt(7), None, "friction of the pin ends of a chain, which turn on the sheaves at entry and exit";
    BeltSlip: "belt_slip", "Belt slip", Belt, Belt, Belt, Fill::Cvt(8), None, "sliding of the segments, or of a chain's pins, along the pulleys";
    BeltWedge: "belt_wedge", "Belt wedge", Belt, Belt, Belt, Fill::Cvt(9), None, "wedging at pulley entry and exit";
    BeltPenetration: "belt_penetration", "Belt penetration", Belt, Belt, Belt, Fill::Cvt(10), None, "penetration into the deflected pulleys";
    BeltMap: "belt_map", "Belt map", BeltMap, Belt, Belt, Fill::Cvt(6), Some("belt"), "loss of the whole belt, from its measured map";
    RangeGear: "range_gear", "Range gear", Ranges, Sump, FinalDrive, Fill::Cvt(11), None, "loss of the planetary set with two ranges behind the secondary";
    FinalDrive: "final_drive", "Final drive", Cvt, Sump, FinalDrive, Fill::Cvt(12), Some("final_drive"), "loss of the final drive of the CVT";
    GearMesh: "gear_mesh", "Gear mesh", Manual, Sump, Gears, Fill::Manual(1), None, "gear mesh loss of the manual box, with its final drive";
    Bearing: "bearing", "Bearing", Manual, Metal, BearingsAndSeals, Fill::Manual(2), None, "bearing loss of the manual box";
    Churning: "churning", "Churning", Manual, Sump, Churning, Fill::Manual(3), None, "churning loss of the manual box";
    Seal: "seal", "Seal", Manual, Metal, BearingsAndSeals, Fill::Manual(4), None, "seal loss of the manual box";
    BoxMap: "box_map", "Box map", BoxMap, Sump, Gears, Fill::Manual(1), Some("box"), "loss of the whole box, from its measured map";
}

impl Component {
    const fn entry(self) -> &'static Entry {
        &TABLE[self as usize]
    }

    /// Name as in JSON keys and CSV columns.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// Name in words, with a capital.
    pub const fn title(self) -> &'static str {
        self.entry().title
    }

    /// Meaning of the loss, one phrase.
    pub const fn doc(self) -> &'static str {
        self.entry().doc
    }

    /// Names of the columns that hold the loss.
    pub const fn columns(self) -> LossColumns {
        self.entry().columns
    }

    /// The transmissions that have the component.
    pub const fn part(self) -> Part {
        self.entry().part
    }

    /// The thermal node that receives the heat.
    pub const fn heat(self) -> HeatTo {
        self.entry().heat
    }

    /// The group with which the loss is shared out.
    pub const fn group(self) -> LossGroup {
        self.entry().group
    }

    /// Fill in charts.
    pub const fn fill(self) -> Fill {
        self.entry().fill
    }

    /// Key of the measured map that replaces the component's model, below `maps` of its transmission.
    pub const fn map_key(self) -> Option<&'static str> {
        self.entry().map_key
    }

    /// True for the parts of the belt's own loss and for its map; not for the bearings that its pull loads.
    pub const fn is_belt(self) -> bool {
        matches!(self.heat(), HeatTo::Belt)
    }
}

/// One value for each component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByComponent<T>(pub [T; Component::COUNT]);

impl<T> ByComponent<T> {
    /// A value of each component.
    pub fn from_fn(mut value: impl FnMut(Component) -> T) -> Self {
        ByComponent(Component::ALL.map(&mut value))
    }

    /// The values in the order of [`Component::ALL`].
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.0.iter()
    }

    /// The values in the order of [`Component::ALL`], to be changed.
    pub fn iter_mut(&mut self) -> std::slice::IterMut<'_, T> {
        self.0.iter_mut()
    }

    /// Another value made of each.
    pub fn map<U>(self, f: impl FnMut(T) -> U) -> ByComponent<U> {
        ByComponent(self.0.map(f))
    }
}

impl<T: Gather> Gather for ByComponent<T> {
    type Together<R: Real> = ByComponent<T::Together<R>>;

    fn gather<R: Real>(like: R, of: &[&Self]) -> Self::Together<R> {
        let values: Vec<&[T; Component::COUNT]> = of.iter().map(|one| &one.0).collect();
        ByComponent(Gather::gather(like, &values))
    }

    fn lane<R: Real>(together: &Self::Together<R>, lane: usize) -> Self {
        ByComponent(Gather::lane::<R>(&together.0, lane))
    }

    fn groups_with(&self, other: &Self) -> bool {
        self.0.groups_with(&other.0)
    }
}

impl<T> Index<Component> for ByComponent<T> {
    type Output = T;

    #[inline]
    fn index(&self, component: Component) -> &T {
        &self.0[component as usize]
    }
}

impl<T> IndexMut<Component> for ByComponent<T> {
    #[inline]
    fn index_mut(&mut self, component: Component) -> &mut T {
        &mut self.0[component as usize]
    }
}

impl<T> IntoIterator for ByComponent<T> {
    type Item = T;
    type IntoIter = std::array::IntoIter<T, { Component::COUNT }>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl<'a, T> IntoIterator for &'a ByComponent<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}
