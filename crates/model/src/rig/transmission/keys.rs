//! Keys of a rig file, and the conditions of the rig from their values.

use super::{Conditions, PressureFactors, RigCooler, Speeds, TransientTest};
use crate::keys::{Bound, Key, Values, keys};

/// Oil temperatures that the rig can be set to, degC.
pub const OIL: Bound = Bound::closed(-30.0, 120.0);
/// Torques that the rig can be set to, Nm: the transducer's range both ways.
pub const TORQUE: Bound = Bound::closed(-100.0, 1000.0);

keys! {
    /// Keys of `[rig]` and its tables.
    RIG: RigKeys = "rig" [
        RatioKeys::TABLE, SpeedKeys::TABLE, OilKeys::TABLE, LoadKeys::TABLE, PressureKeys::TABLE,
        TransientKeys::TABLE, RoomKeys::TABLE, CoolerKeys::TABLE, TransducerKeys::TABLE
    ] {
        title: text(), "name for people";
    }

    /// Keys of `[rig.ratio]`.
    RATIO: RatioKeys = "ratio" [] {
        low: number(0.3, 3.0), "belt ratio of the tests in low";
        high: number(0.3, 3.0), "belt ratio of the tests in high";
    }

    /// Keys of `[rig.speed]`.
    SPEED: SpeedKeys = "speed" [] {
        low_from_rpm: number(100.0, 8000.0), "lowest input speed in low ratio";
        low_to_rpm: number(100.0, 8000.0), "highest input speed in low ratio";
        step_rpm: number(25.0, 4000.0), "step of the input speed";
        high_from_rpm: number(100.0, 8000.0), "lowest input speed in high ratio";
        high_to_rpm: number(100.0, 8000.0), "highest input speed in high ratio";
    }

    /// Keys of `[rig.oil]`.
    OIL_TABLE: OilKeys = "oil" [] {
        temps_degc: numbers(OIL, 1, 20), "temperatures of the bulk oil in the steady tests";
    }

    /// Keys of `[rig.load]`.
    LOAD: LoadKeys = "load" [] {
        torques_nm: numbers(TORQUE, 1, 40), "torques at the output shaft in the loaded tests";
        throttle_percent: number(0.0, 100.0), "throttle that the clamp law sees";
    }

    /// Keys of `[rig.pressure]`.
    PRESSURE: PressureKeys = "pressure" [] {
        final_drive_removed: number(0.5, 1.5), "secondary pressure with the final drive removed, over that of the complete box";
        belt_removed: number(0.5, 1.5), "secondary pressure with the belt removed as well, over that of the complete box";
        clutch_removed: number(0.5, 1.5), "secondary pressure with the clutch plates removed as well, over that of the complete box";
        second_box: number(0.5, 1.5), "secondary pressure of the second box, over that of the complete box", ["RT-6"];
    }

    /// Keys of `[rig.transient]`.
    TRANSIENT: TransientKeys = "transient" [] {
        speed_rpm: number(500.0, 8000.0), "input speed of the transients";
        start_degc: within(OIL), "everything at the start, and the sump when cooling ends";
        end_degc: within(OIL), "sump when the warm-up ends";
    }

    /// Keys of `[rig.room]`.
    ROOM: RoomKeys = "room" [] {
        temp_degc: number(-40.0, 60.0), "air around the box";
    }

    /// Keys of `[rig.cooler]`.
    COOLER: CoolerKeys = "cooler" [] {
        flow_l_min: above(0.0, 100.0), "oil flow through the rig's cooler", ["RT-2"];
        conductance_w_k: above(0.0, 20_000.0), "conductance of the rig's cooler", ["RT-2"];
        coolant_degc: number(-60.0, 60.0), "coolant of the rig's cooler", ["RT-2"];
    }

    /// Keys of `[rig.transducer]`.
    TRANSDUCER: TransducerKeys = "transducer" [] {
        error_nm: number(0.0, 10.0), "error of the torque transducer";
    }
}

impl Conditions {
    /// The conditions from the values of a rig file.
    pub fn from_values<V: Values>(root: &V) -> Self {
        let root = &root.table("rig");
        root.text(&RIG.title);
        let (ratio, speed, load) = (root.table("ratio"), root.table("speed"), root.table("load"));
        Conditions {
            low_ratio: ratio.number(&RATIO.low),
            high_ratio: ratio.number(&RATIO.high),
            low_speeds: Speeds::from_values(&speed, &SPEED.low_from_rpm, &SPEED.low_to_rpm),
            high_speeds: Speeds::from_values(&speed, &SPEED.high_from_rpm, &SPEED.high_to_rpm),
            oil_k: root.table("oil").numbers(&OIL_TABLE.temps_degc),
            torques_nm: load.numbers(&LOAD.torques_nm),
            throttle: load.number(&LOAD.throttle_percent),
            pressure: PressureFactors::from_values(&root.table("pressure")),
            transient: TransientTest::from_values(&root.table("transient")),
            room_k: root.table("room").number(&ROOM.temp_degc),
            cooler: RigCooler::from_values(&root.table("cooler")),
            transducer_nm: root.table("transducer").number(&TRANSDUCER.error_nm),
        }
    }
}

impl Speeds {
    fn from_values<V: Values>(s: &V, from: &Key<'static>, to: &Key<'static>) -> Self {
        let speeds = Speeds {
            from_rad_s: s.number(from),
            to_rad_s: s.number(to),
            step_rad_s: s.number(&SPEED.step_rpm),
        };
        if speeds.from_rad_s > speeds.to_rad_s {
            s.complain(
                to.name,
                "at least the lowest speed",
                "the highest speed is below the lowest",
                &format!("swap `{}` and `{}`", from.name, to.name),
            );
        }
        speeds
    }
}

impl PressureFactors {
    fn from_values<V: Values>(s: &V) -> Self {
        PressureFactors {
            final_drive_removed: s.number(&PRESSURE.final_drive_removed),
            belt_removed: s.number(&PRESSURE.belt_removed),
            clutch_removed: s.number(&PRESSURE.clutch_removed),
            second_box: s.number(&PRESSURE.second_box),
        }
    }
}

impl TransientTest {
    fn from_values<V: Values>(s: &V) -> Self {
        let test = TransientTest {
            speed_rad_s: s.number(&TRANSIENT.speed_rpm),
            start_k: s.number(&TRANSIENT.start_degc),
            end_k: s.number(&TRANSIENT.end_degc),
        };
        if test.end_k - test.start_k < 5.0 {
            s.complain(
                "end_degc",
                "at least 5 K above the start",
                "the warm-up has no way to go",
                "raise the end or lower `rig.transient.start_degc`",
            );
        }
        test
    }
}

impl RigCooler {
    fn from_values<V: Values>(s: &V) -> Self {
        RigCooler {
            flow_m3_s: s.number(&COOLER.flow_l_min),
            conductance_w_k: s.number(&COOLER.conductance_w_k),
            coolant_k: s.number(&COOLER.coolant_degc),
        }
    }
}
