//! Keys of a vehicle file.

use crate::engine::EngineKeys;
use crate::keys::{Choice, Kind, Presence, keys};
use crate::road::RoadLoadKeys;
use crate::thermal::ThermalKeys;
use crate::transmission::cvt::CvtKeys;
use crate::transmission::manual::ManualKeys;

/// Names: one text with commas, or a list of texts.
const NAMES: Kind<'static> = Kind::Either(&[Kind::Text, Kind::Texts]);

keys! {
    /// Keys of `[vehicle]`.
    HEAD: HeadKeys = "vehicle" [] {
        title: computed("name of the file", text()), "name for people";
        short: computed("name of the file", text()), "name in tables and figures, a word or two";
        like: (NAMES, Presence::Optional), "what gives the values that this file leaves out: vehicles by name or path, and classes as class:NAME; of several, the later takes precedence";
        baselines: (NAMES, Presence::Computed("none")), "names of the baseline vehicles; twin is the same car with a manual box";
        transmission_oil: text(), "name of the transmission oil";
        engine_oil: text(), "name of the engine oil";
    }

    /// Keys of `[twin]`: the manual box of the twin of a car with a CVT.
    TWIN: TwinKeys = "twin" [] {
        gears: integer(5, 6, 6), "gears of the rule for the ratios";
        first_rpm_per_kmh: computed("126 with six gears, 161 with five", number(60.0, 250.0)), "engine speed over road speed in first";
        span: computed("5.39 with six gears, 4.98 with five", number(3.0, 9.0)), "ratio of first over that of top";
        overall_ratios: optional(list(0.5, 40.0, 0, 10)), "engine speed over wheel speed in each gear, from first, in place of the rule";
        shift_kmh: optional(list(1.0, 300.0, 0, 9)), "vehicle speeds to shift up, in place of shares of the speed of rated power";
        r#box: computed("class:box_manual_6, with five gears class:box_manual_5", text()), "class or vehicle that gives the losses and heat paths of the box, and its oil";
    }

    /// Keys of a vehicle file.
    VEHICLE_FILE: VehicleKeys = "" [HeadKeys::TABLE, TwinKeys::TABLE, RoadLoadKeys::TABLE, EngineKeys::TABLE, ThermalKeys::TABLE] {
        transmission: options(&[
            Choice::new("cvt", "CVT with a pushing belt", CvtKeys::TABLE),
            Choice::new("manual", "manual gearbox", ManualKeys::TABLE),
        ]), "kind of transmission";
    }
}
