//! Keys of a gear train, which CVT and manual box share, and its parts from their values.

use super::GearParts;
use super::bearing::{Bearing, BearingFactors};
use super::churning::Churner;
use super::mesh::{Stage, Teeth};
use super::seal::LipSeal;
use crate::keys::{Bound, Column, Key, Values, keys};

/// Shaft of a row: 0 driven, 1 between the stages, 2 with the wheels.
const SHAFT: Column<'static> = ("shaft", Bound::closed(0.0, 2.0));
const COUNT: Column<'static> = ("count", Bound::closed(1.0, 10.0));

keys! {
    /// Keys of `[transmission.manual.gears]` and, under its own name, of `[transmission.cvt.final_drive]`.
    GEARS: GearKeys = "gears" [] {
        bearing_friction: or(0.0015, number(0.0, 0.01)), "friction of the bearings under load, at the bore", ["BR-3"];
        bearing_factor: or(1.0, number(0.0, 20.0)), "factor on the torque without load of the bearings with preload", ["BR-1"];
        bearing_heating_w: or(400.0, number(1.0, 1e9)), "dissipation of one bearing at which the heat of its film halves its torque without load", ["BR-1", "FH-1"];
        preload_factor: or(1.0, number(0.0, 10.0)), "factor on the preload of all bearings", ["BR-2"];
        churning_factor: or(1.0, number(0.0, 20.0)), "factor on churning", ["CH-1"];
        roughness_um: or(0.5, number(0.05, 5.0)), "roughness of the flanks", ["GM-2"];
        oil_factor: or(1.0, number(0.0, 1.5)), "factor of the kind of oil on the friction of the teeth: mineral 1, polyglycol 0.75", ["GM-2"];
        stages: rows(&[
            ("centre_mm", Bound::closed(20.0, 400.0)), ("module_mm", Bound::closed(0.5, 8.0)), ("face_mm", Bound::closed(5.0, 100.0)),
            ("helix_deg", Bound::closed(0.0, 40.0))
        ]), "two rows [centre distance mm, normal module mm, face width mm, helix angle deg], from the driven shaft", ["GM-1", "GM-2"];
        bearings: rows(&[
            SHAFT, COUNT, ("mean_mm", Bound::closed(10.0, 200.0)), ("bore_mm", Bound::closed(5.0, 150.0)), ("f0", Bound::closed(0.0, 20.0)),
            ("preload_nm", Bound::closed(0.0, 20.0))
        ]), "rows [shaft 0 to 2, number, mean diameter mm, bore mm, f_0, boundary friction of them all by preload Nm]", ["BR-1", "BR-2", "BR-3"];
        churners: rows(&[
            SHAFT, ("radius_mm", Bound::closed(10.0, 400.0)), ("face_mm", Bound::closed(1.0, 300.0)), ("immersion_mm", Bound::closed(0.0, 400.0))
        ]), "rows [shaft 0 to 2, tip radius mm, width mm, depth in the oil mm] of the wheels in the sump", ["CH-1"];
        seals: rows(&[SHAFT, COUNT, ("diameter_mm", Bound::closed(5.0, 200.0))]), "rows [shaft 0 to 2, number, diameter mm] of the lip seals", ["LS-1"];
    }
}

/// Teeth below which a wheel cannot be cut.
const MIN_TEETH: f64 = 5.0;

/// Where the reader has reported rows that are none: any pair of wheels.
const ANY_STAGE: Stage = Stage {
    centre_m: 0.1,
    module_m: 0.002,
    face_m: 0.03,
    helix_rad: 0.5,
};

/// Rows of a key whose first column is a shaft, with that shaft's number.
fn on_shafts<V: Values>(s: &V, key: &Key<'static>) -> Vec<(usize, Vec<f64>)> {
    let rows = s.rows(key).unwrap_or_default();
    if rows.iter().any(|row| row[0].fract() != 0.0) {
        s.complain(
            key.name,
            "shaft 0, 1 or 2",
            "a shaft has a whole number",
            "0 is driven, 1 lies between the stages, 2 turns with the wheels",
        );
        return Vec::new();
    }
    rows.into_iter().map(|row| (row[0] as usize, row)).collect()
}

impl GearParts {
    /// The parts from the values of their table, and the oil in which they run; `ratios` are all those that the two stages will have.
    pub(in crate::transmission) fn from_values<V: Values>(
        s: &V,
        oil_m3: f64,
        ratios: &[[f64; 2]],
    ) -> Self {
        GearParts {
            stages: stages(s, ratios),
            teeth: Teeth {
                roughness_m: s.number(&GEARS.roughness_um),
                oil_factor: s.number(&GEARS.oil_factor),
            },
            bearings: on_shafts(s, &GEARS.bearings)
                .into_iter()
                .map(|(shaft, row)| Bearing {
                    shaft,
                    count: row[1],
                    mean_m: row[2],
                    bore_m: row[3],
                    f0: row[4],
                    preload_nm: row[5],
                })
                .collect(),
            bearing: BearingFactors {
                friction: s.number(&GEARS.bearing_friction),
                unloaded: s.number(&GEARS.bearing_factor),
                preload: s.number(&GEARS.preload_factor),
                heating_w: s.number(&GEARS.bearing_heating_w),
            },
            churners: on_shafts(s, &GEARS.churners)
                .into_iter()
                .map(|(shaft, row)| Churner {
                    shaft,
                    radius_m: row[1],
                    face_m: row[2],
                    immersion_m: row[3],
                })
                .collect(),
            churning: s.number(&GEARS.churning_factor),
            seals: on_shafts(s, &GEARS.seals)
                .into_iter()
                .map(|(shaft, row)| LipSeal {
                    shaft,
                    count: row[1],
                    diameter_m: row[2],
                })
                .collect(),
            oil_m3,
        }
    }
}

/// The two pairs of wheels, which can be cut at all their ratios.
fn stages<V: Values>(s: &V, ratios: &[[f64; 2]]) -> [Stage; 2] {
    let Some(rows) = s.rows(&GEARS.stages) else {
        return [ANY_STAGE; 2];
    };
    let [first, second] = rows.as_slice() else {
        s.complain(
            "stages",
            "two rows",
            &format!("a gear train has two stages, not {}", rows.len()),
            "give one row for the gear, or the stage at the secondary, and one for the final drive",
        );
        return [ANY_STAGE; 2];
    };
    let stages = [first, second].map(|row| Stage {
        centre_m: row[0],
        module_m: row[1],
        face_m: row[2],
        helix_rad: row[3],
    });
    let too_few = |ratios: &[f64; 2]| {
        let teeth = |k: usize| stages[k].pinion_teeth(ratios[k]);
        teeth(0) < MIN_TEETH || teeth(1) < MIN_TEETH
    };
    if ratios.iter().any(too_few) {
        s.complain(
            "stages",
            "",
            "a pinion would have fewer than 5 teeth",
            "take a smaller module, a larger centre distance, or ratios that are nearer to each other",
        );
    }
    stages
}
