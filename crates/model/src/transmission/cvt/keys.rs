//! Keys of `[transmission.cvt]`, and a CVT from their values.

use super::circuit::{LineCircuit, TorqueSensorKeys};
use super::clutch_drag::{ClutchDrag, ClutchKeys};
use super::controller::{ClampKeys, PressureTable, RatioControl, RatioKeys, clamp};
use super::final_drive::FinalDrive;
use super::floors::{Floors, PRESSURE, PressureKeys};
use super::pulley_bearing::{PulleyBearing, PulleyBearingKeys};
use super::pump::{Pump, PumpKeys};
use super::range_gear::{LaunchGearKeys, RangeGear, RangeKeys};
use super::seal_ring::{SealRing, SealRingKeys};
use super::selector::{Selector, SelectorKeys};
use super::shaft_drag::{ShaftDrag, ShaftKeys};
use super::variator::{Belt, BeltKeys, Formulation, Geometry, VARIATOR, VariatorKeys};
use super::{Cvt, LossChanges};
use crate::engine::Engine;
use crate::keys::{Choice, Kind, Table, Values, keys};
use crate::lubricant::Lubricant;
use crate::maps::LossMap;
use crate::math::asin;
use crate::transmission::box_map::{self, CVT_BOX, CVT_BOX_POINTS};
use crate::transmission::component::{ByComponent, Component};
use crate::transmission::coupling::{self, Coupling, LAUNCH};
use crate::transmission::gear_train::GearKeys;
use crate::transmission::{BoxKind, components, loss_factor};

/// Table of the final drive: that of a gear train.
const FINAL_DRIVE: Table = Table {
    name: "final_drive",
    ..GearKeys::TABLE
};

/// How the rows of a map of the whole box lie.
const BOX_POINTS: &[Choice] = &[
    Choice::word("grid", "a row for every combination of the columns' values"),
    Choice::word(
        "scattered",
        "points anywhere: local planes through the nearest ones bring them onto a grid",
    ),
];

/// Convention of a ratio by which an overdrive is above one.
const OUTPUT_OVER_INPUT: &str = "output_over_input";
/// Conventions of the ratio of a map of the whole box.
const RATIO_IS: &[Choice] = &[
    Choice::word(
        "input_over_output",
        "speed of the input over that of the output: a reduction is above one",
    ),
    Choice::word(
        OUTPUT_OVER_INPUT,
        "speed of the output over that of the input: an overdrive is above one",
    ),
];

keys! {
    /// Keys of `[transmission.cvt]` and its tables.
    CVT: CvtKeys = "cvt" [
        RatioKeys::TABLE, BeltKeys::TABLE, VariatorKeys::TABLE, PressureKeys::TABLE, PumpKeys::TABLE,
        PulleyBearingKeys::TABLE, SealRingKeys::TABLE, ShaftKeys::TABLE, ClutchKeys::TABLE, FINAL_DRIVE, MapKeys::TABLE,
        LossFactorKeys::TABLE, SelectorKeys::TABLE
    ] {
        final_drive_ratio: number(1.0, 20.0), "secondary speed over wheel speed", ["CV-1"];
        final_drive_first_ratio: number(0.3, 6.0), "share of that ratio in the stage at the secondary", ["FD-1"];
        clamp: or_word("map", options(ClampKeys::CHOICES)), "clamp law: the Rover's map, torque following, slip limited, or a table of the user's";
        circuit: or_word("line_is_secondary", options(&[
            Choice::word("line_is_secondary", "one line pressure, that of the secondary, which feeds the primary"),
            Choice::word("independent", "a valve for each cylinder: the line has the higher of the two pressures"),
            Choice::new("torque_sensor", "clamping and shifting pistons apart, the clamp by torque", TorqueSensorKeys::TABLE),
        ])), "hydraulic circuit of the cylinders", ["HC-1", "HC-2", "HC-3"];
        ranges: or_word("one", options(&[
            Choice::word("one", "the secondary turns with the final drive"),
            Choice::new("two", "a planetary set with a low and a high range behind the secondary", RangeKeys::TABLE),
            Choice::new("launch_gear", "a pair of gears next to the belt for pulling away", LaunchGearKeys::TABLE),
        ])), "ranges of the box", ["RG-1"];
        launch: LAUNCH, "launch device: a friction clutch, or a torque converter";
        launch_at: words(&[
            Choice::word("input", "between engine and variator"),
            Choice::word("output", "between variator and final drive: belt and pulleys turn with the engine"),
        ], "input"), "place of the launch clutch", ["LO-1"];
        belt_heat_share: or(0.7, number(0.0, 1.0)), "share of belt loss that heats belt and pulleys", ["SI-3"];
    }

    /// Keys of `[transmission.cvt.maps]`: measured losses in place of a model.
    MAPS: MapKeys = "maps" [] {
        belt: optional(csv()), "CSV of measured torque loss at the primary that replaces the belt model";
        pump: optional(csv()), "CSV of measured torque loss at the primary that replaces the pump model";
        input_shaft: optional(csv()), "CSV of measured torque loss at the primary that replaces the input shaft model";
        clutch_drag: optional(csv()), "CSV of measured torque loss at the primary that replaces the reverse-clutch drag";
        seal_ring: optional(csv()), "CSV of measured torque loss at the primary that replaces the rings of both pulleys";
        final_drive: optional(csv()), "CSV of measured torque loss at the primary that replaces the final drive model";
        r#box: optional(csv()), "CSV of measured loss at the input shaft that replaces all losses but those of the launch device; columns where measured ratio, input_speed_rpm, input_torque_nm, oil_temp_degc, and torque_loss_nm, power_loss_w or efficiency_percent", ["MP-3", "MP-6"];
        box_points: words(BOX_POINTS, "grid"), "how the rows of that map lie", ["MP-5"];
        ratio_is: words(RATIO_IS, "input_over_output"), "what the column ratio of that map is, in speeds; a column speed_ratio is output over input", ["MP-3"];
        no_load_loss_nm: optional(number(0.0, 1000.0)), "loss without torque of a box map that has efficiencies", ["MP-6"];
        at_rest_loss_nm: optional(number(0.0, 1000.0)), "loss torque of a box that is a map with the car at rest in gear; absent: that of the map, which has parts that do not turn then", ["MP-3"];
    }

    /// Keys of `[transmission.cvt.loss_factor]`, by component.
    LOSS_FACTOR: LossFactorKeys = "loss_factor" [] {
        launch_clutch: or(1.0, number(0.0, 5.0)), "factor on the loss of the launch device; 1 is the model, 0 is without it", ["LC-6"];
        pump: or(1.0, number(0.0, 5.0)), "factor on the loss of the pump; 1 is the model, 0 is without it", ["CV-7"];
        input_shaft: or(1.0, number(0.0, 5.0)), "factor on the loss of the input shaft; 1 is the model, 0 is without it", ["CV-7"];
        clutch_drag: or(1.0, number(0.0, 5.0)), "factor on the drag of the reverse clutch; 1 is the model, 0 is without it", ["CV-7"];
        seal_ring: or(1.0, number(0.0, 5.0)), "factor on the friction of the seal rings; 1 is the model, 0 is without it", ["CV-7"];
        pulley_bearing: or(1.0, number(0.0, 5.0)), "factor on the load friction of the pulleys' bearings; 1 is the model, 0 is without it", ["CV-7"];
        belt_band: or(1.0, number(0.0, 5.0)), "factor on the boundary friction of the bands; 1 is the model, 0 is without it", ["CV-7"];
        belt_film: or(1.0, number(0.0, 5.0)), "factor on the shear between the bands; 1 is the model, 0 is without it", ["CV-7"];
        chain_joint: or(1.0, number(0.0, 5.0)), "factor on the friction in the joints of a chain; 1 is the model, 0 is without it", ["CV-7"];
        chain_pin: or(1.0, number(0.0, 5.0)), "factor on the friction of the pin ends of a chain; 1 is the model, 0 is without it", ["CV-7"];
        belt_slip: or(1.0, number(0.0, 5.0)), "factor on slip and its loss; 1 is the model, 0 is without it", ["CV-7"];
        belt_wedge: or(1.0, number(0.0, 5.0)), "factor on the loss of wedging; 1 is the model, 0 is without it", ["CV-7"];
        belt_penetration: or(1.0, number(0.0, 5.0)), "factor on the loss of penetration; 1 is the model, 0 is without it", ["CV-7"];
        belt_map: or(1.0, number(0.0, 5.0)), "factor on the belt's measured map, where there is one; 1 is the map, 0 is without loss", ["CV-7"];
        range_gear: or(1.0, number(0.0, 5.0)), "factor on the loss of the set with two ranges; 1 is the model, 0 is without it", ["CV-7"];
        final_drive: or(1.0, number(0.0, 5.0)), "factor on the loss of the final drive; 1 is the model, 0 is without it", ["CV-7"];
        box_map: or(1.0, number(0.0, 5.0)), "factor on the map of the whole box, where there is one; 1 is the map, 0 is without loss", ["CV-7"];
    }
}

impl FinalDrive {
    /// The final drive from the values of `[transmission.cvt]`, in the oil of the sump.
    pub(crate) fn from_cvt_values<V: Values>(s: &V, oil_m3: f64) -> Self {
        FinalDrive::from_values(
            &s.table("final_drive"),
            s.number(&CVT.final_drive_ratio),
            s.number(&CVT.final_drive_first_ratio),
            oil_m3,
        )
    }
}

impl Cvt {
    /// A checked CVT from the values of `[transmission.cvt]`, and the oil in its sump; `final_drive` is that of the same values, if there is one.
    pub fn from_values<V: Values>(
        s: &V,
        engine: &Engine,
        (oil, oil_m3): (&Lubricant, f64),
        formulation: Formulation,
        final_drive: Option<&FinalDrive>,
    ) -> Self {
        let v = s.table("variator");
        let full_load_route = engine.speed_for_power();
        // The route ends at the greatest power.
        let fastest_rad_s = full_load_route
            .points()
            .last()
            .map_or(engine.highest_rad_s, |p| p.1);
        let ratio = RatioControl::from_values(&s.table("ratio"), fastest_rad_s);
        let belt = Belt::from_values(&s.table("belt"), &v, formulation);
        let low = Geometry::new(ratio.low, belt.centre_distance_m, belt.length_m);
        check_reach(s, &ratio, &belt, &low);
        check_wedge(&v, &belt, oil);
        let pressure = s.table("pressure");
        let (clamp, pressure_table) = clamp(s, &CVT.clamp);
        let radius_exponent = pressure.number(&PRESSURE.radius_exponent);
        let (floors, cap_pa) = Floors::from_values(&pressure);
        check_cap(s, pressure_table.as_deref(), cap_pa);
        let changes = maps(&s.table("maps"));
        let ranges = RangeGear::from_values(s, &CVT.ranges, &ratio);
        check_ranges(s, ranges.is_some(), changes.as_deref());
        let maps = changes
            .iter()
            .flat_map(|changes| Component::ALL.map(|c| changes.maps[c].as_ref().map(|_| c.part())));
        let own = components(
            BoxKind::of_cvt(&belt, ranges.is_some()),
            &maps.flatten().collect::<Vec<_>>(),
        );
        let factors = loss_factor::from_values(s, LossFactorKeys::TABLE, &own);
        let launch = coupling::from_values(s, &CVT.launch, 5.0);
        let launch_behind = launch_behind(s, &launch, (changes.as_deref(), ranges.as_deref()));
        let mut cvt = Cvt {
            final_drive: match final_drive {
                Some(known) => known.clone(),
                None => FinalDrive::from_cvt_values(s, oil_m3),
            },
            secondary_piston_m2: v.number(&VARIATOR.secondary_piston_cm2),
            primary_piston_m2: v.number(&VARIATOR.primary_piston_cm2),
            spring_n: v.number(&VARIATOR.spring_n),
            centrifugal_n_s2: centrifugal(&v, oil),
            circuit: LineCircuit::from_values(s, &CVT.circuit),
            pump: Pump::from_values(&s.table("pump")),
            shaft_drag: ShaftDrag::from_values(&s.table("input_shaft")),
            clutch_drag: ClutchDrag::from_values(&s.table("reverse_clutch")),
            pulley_bearing: PulleyBearing::from_values(&s.table("pulley_bearing")),
            seal_ring: SealRing::from_values(&s.table("seal_ring")),
            ranges,
            ratio,
            clamp,
            pressure_table,
            radius_exponent,
            floors,
            cap_pa,
            low_radius_m: low.primary_radius_m,
            launch_behind,
            coupling: launch,
            selector: Selector::from_values(&s.table("selector")),
            full_load_route,
            changes,
            belt_heat_share: s.number(&CVT.belt_heat_share),
            belt,
        };
        cvt.scale_losses(&factors);
        cvt
    }
}

/// Reads the place of the launch clutch, true behind the variator; a converter there, or a map of the whole box, is reported.
fn launch_behind<V: Values>(
    s: &V,
    launch: &dyn Coupling,
    (changes, ranges): (Option<&LossChanges>, Option<&RangeGear>),
) -> bool {
    let behind = s.word(&CVT.launch_at) == "output";
    if behind && launch.by_command() {
        s.complain(
            "launch_at",
            "input where launch is torque_converter",
            "a torque converter is driven by the engine, in front of the variator",
            "set launch = \"friction_clutch\", or launch_at = \"input\"",
        );
    }
    let whole_box = |changes: &LossChanges| changes.maps[Component::BoxMap].is_some();
    if behind && changes.is_some_and(whole_box) {
        s.complain(
            "launch_at",
            "input where maps.box is given",
            "the map of a whole box is that of a box whose launch device is at its input",
            "leave maps.box out, or set launch_at = \"input\"",
        );
    }
    if behind && ranges.is_some_and(|set| set.past_belt) {
        s.complain(
            "launch_at",
            "input where ranges is launch_gear",
            "the launch gear goes from the primary past the belt, and past a clutch behind it",
            "set launch_at = \"input\", or ranges = \"one\"",
        );
    }
    behind
}

/// A map of the whole box has the ratio of the belt alone, and no range.
fn check_ranges<V: Values>(s: &V, two: bool, changes: Option<&LossChanges>) {
    let whole_box = |changes: &LossChanges| changes.maps[Component::BoxMap].is_some();
    if two && changes.is_some_and(whole_box) {
        s.complain(
            CVT.ranges.name,
            "one where maps.box is given",
            "the map of a whole box has no column of the range",
            "leave maps.box out, or remove ranges",
        );
    }
}

/// The belt runs at both ends of the ratio, and the pulleys do not run into each other.
fn check_reach<V: Values>(s: &V, ratio: &RatioControl, belt: &Belt, low: &Geometry) {
    let read = [ratio.low, ratio.high, belt.centre_distance_m, belt.length_m]
        .iter()
        .all(|x| x.is_finite());
    let high = Geometry::new(ratio.high, belt.centre_distance_m, belt.length_m);
    let fits = |g: &Geometry| {
        let (primary, secondary) = (g.primary_radius_m, g.secondary_radius_m);
        primary > 0.005
            && secondary > 0.005
            && primary + secondary <= belt.centre_distance_m
            && g.strut_m > 0.0
    };
    let ends = [("low", fits(low)), ("high", fits(&high))];
    if let Some((end, _)) = ends.iter().find(|(_, fits)| read && !fits) {
        s.table("ratio").complain(
            end,
            "",
            "the belt cannot reach this ratio",
            "check belt length and centre distance against the ratio limits",
        );
    }
}

/// No pressure of a table is above the cap, which would hold it.
fn check_cap<V: Values>(s: &V, table: Option<&PressureTable>, cap_pa: f64) {
    let pressures = table.map_or(&[][..], |table| table.grid().values());
    let most_pa = pressures.iter().copied().fold(0.0, f64::max);
    if most_pa > cap_pa {
        s.table("clamp").table("table").complain(
            "file",
            &format!("at most pressure.cap_bar, {} bar", cap_pa / 1e5),
            &format!("a pressure of the table is {} bar", most_pa / 1e5),
            "raise cap_bar, or correct the table or its unit",
        );
    }
}

/// A segment leaves the wedge by itself: at an angle of friction above that of the wedge it would hold itself there, and the balance of forces
/// between sheave and belt (GE, VA-2) would no longer be theirs. The printed forms run as printed.
fn check_wedge<V: Values>(v: &V, belt: &Belt, oil: &Lubricant) {
    let mu = oil.friction.largest_segment();
    if belt.formulation.by_statics() && belt.tan_wedge <= mu {
        v.complain(
            "half_wedge_deg",
            &format!(
                "above {:.2}, the angle of friction of segments on pulleys",
                asin(mu / (1.0 + mu * mu).sqrt()).to_degrees()
            ),
            "segments would hold themselves in this wedge",
            "open the angle, or take a fluid with less segment friction",
        );
    }
}

fn centrifugal<V: Values>(v: &V, oil: &Lubricant) -> f64 {
    let compensated = v.flag(&VARIATOR.compensated);
    let outer = v.number(&VARIATOR.piston_outer_mm);
    let inner = v.number(&VARIATOR.piston_inner_mm);
    if compensated {
        return 0.0;
    }
    if outer < inner {
        v.complain(
            "piston_inner_mm",
            "at most piston_outer_mm",
            "the oil chamber's inner radius is above its outer one",
            "give both as radii, the smaller one here",
        );
    }
    let squares = outer * outer + inner * inner;
    let difference = (outer - inner) * (outer + inner);
    std::f64::consts::PI * oil.density_kg_m3(353.15) * (squares * difference) / 4.0 // VA-3
}

/// The map of the whole box.
fn whole_box<V: Values>(s: &V) -> Option<LossMap> {
    let idle_nm = s.optional(&MAPS.no_load_loss_nm);
    let table = match s.word(&MAPS.box_points) {
        "scattered" => &CVT_BOX_POINTS,
        _ => &CVT_BOX,
    };
    let is_inverse = s.word(&MAPS.ratio_is) == OUTPUT_OVER_INPUT;
    box_map::from_values(s, &MAPS.r#box, table, idle_nm, is_inverse)
}

/// The measured maps that `[transmission.cvt.maps]` names.
fn maps<V: Values>(s: &V) -> Option<Box<LossChanges>> {
    let mut maps = ByComponent::from_fn(|component| {
        let name = component.map_key().filter(|_| component.part().is_cvt())?;
        let key = MapKeys::TABLE.keys.iter().find(|key| key.name == name)?;
        s.loss_map(key, "ratio")
    });
    maps[Component::BoxMap] = whole_box(s);
    let at_rest_nm = s.optional(&MAPS.at_rest_loss_nm);
    let mut others = MapKeys::TABLE
        .keys
        .iter()
        .filter(|key| matches!(key.kind, Kind::Csv));
    if let Some(other) = others.find(|key| key.name != MAPS.r#box.name && s.has(key))
        && s.has(&MAPS.r#box)
    {
        s.complain(
            other.name,
            "a map of the whole box, or maps of its parts",
            "the map of the whole box is in the place of this one",
            "remove one of them",
        );
    }
    maps.iter().any(Option::is_some).then(|| {
        Box::new(LossChanges {
            maps,
            at_rest_nm,
            ..LossChanges::default()
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transmission::component::Part;

    #[test]
    fn there_is_a_factor_for_each_loss() {
        let own = |c: &Component| c.part() != Part::Manual;
        let components = Component::ALL.into_iter().filter(own);
        let names: Vec<&str> = components.map(Component::name).collect();
        let keys: Vec<&str> = LossFactorKeys::TABLE.keys.iter().map(|k| k.name).collect();
        assert_eq!(keys, names);
    }
}
