//! Keys of `[transmission.manual]`, and a manual gearbox from their values.

use super::{Manual, ShiftSpeeds};
use crate::keys::{Key, Kind, Values, keys};
use crate::transmission::box_map::{self, MANUAL_BOX};
use crate::transmission::component::Part;
use crate::transmission::coupling::{self, MANUAL_LAUNCH};
use crate::transmission::gear_train::{GearKeys, GearParts};
use crate::transmission::{BoxKind, components, loss_factor};

keys! {
    /// Keys of `[transmission.manual]` and its tables.
    MANUAL: ManualKeys = "manual" [
        GearKeys::TABLE, MapKeys::TABLE, LossFactorKeys::TABLE
    ] {
        overall_ratios: list(0.5, 40.0, 2, 10), "engine speed over wheel speed in each gear, from first";
        final_ratio: number(1.0, 10.0), "ratio of the final drive, which is part of them", ["MB-1"];
        upshift_kmh: list(1.0, 300.0, 1, 9), "vehicle speeds to shift up where a cycle has no gears", ["MB-5"];
        downshift_kmh: list(1.0, 300.0, 1, 9), "vehicle speeds to shift down", ["MB-5"];
        neutral_share: number(0.0, 1.0), "share of the losses in top gear that turns in neutral";
        launch: MANUAL_LAUNCH, "launch device: a wet or dry friction clutch";
    }

    /// Keys of `[transmission.manual.maps]`.
    MAPS: MapKeys = "maps" [] {
        r#box: optional(csv()), "CSV of measured loss at the input shaft that replaces mesh, bearings, churning and seals; columns where measured gear, input_speed_rpm, input_torque_nm, oil_temp_degc, and torque_loss_nm, power_loss_w or efficiency_percent", ["MP-4", "MP-6"];
        no_load_loss_nm: optional(number(0.0, 1000.0)), "loss without torque of a box map that has efficiencies", ["MP-6"];
    }

    /// Keys of `[transmission.manual.loss_factor]`, by component.
    LOSS_FACTOR: LossFactorKeys = "loss_factor" [] {
        launch_clutch: or(1.0, number(0.0, 5.0)), "factor on the loss of the launch device; 1 is the model, 0 is without it", ["LC-6"];
        gear_mesh: or(1.0, number(0.0, 5.0)), "factor on the loss of the teeth; 1 is the model, 0 is without it", ["MB-6"];
        bearing: or(1.0, number(0.0, 5.0)), "factor on the loss of the bearings; 1 is the model, 0 is without it", ["MB-6"];
        churning: or(1.0, number(0.0, 5.0)), "factor on churning; 1 is the model, 0 is without it", ["MB-6"];
        seal: or(1.0, number(0.0, 5.0)), "factor on the loss of the lip seals; 1 is the model, 0 is without it", ["MB-6"];
        box_map: or(1.0, number(0.0, 5.0)), "factor on the box's measured map, where there is one; 1 is the map, 0 is without loss", ["MB-6"];
    }
}

impl Manual {
    /// A checked manual gearbox from the values of `[transmission.manual]`, and the oil in it.
    pub fn from_values<V: Values>(s: &V, oil_m3: f64) -> Self {
        let overall = s.numbers(&MANUAL.overall_ratios);
        if overall.windows(2).any(|r| r[0] <= r[1]) {
            s.complain(
                "overall_ratios",
                "falling from gear to gear",
                "ratios must fall from first to top gear",
                "order them from first gear; reverse does not belong here",
            );
        }
        let last = s.number(&MANUAL.final_ratio);
        let ratios: Vec<[f64; 2]> = overall.iter().map(|all| [all / last, last]).collect();
        let parts = GearParts::from_values(&s.table("gears"), oil_m3, &ratios);
        let maps = s.table("maps");
        let idle_nm = maps.optional(&MAPS.no_load_loss_nm);
        let map = box_map::from_values(&maps, &MAPS.r#box, &MANUAL_BOX, idle_nm, false);
        let mapped = map.is_some().then_some(Part::BoxMap);
        let own = components(BoxKind::Manual, mapped.as_slice());
        let factors = loss_factor::from_values(s, LossFactorKeys::TABLE, &own);
        let mut manual = Manual {
            shifts: ShiftSpeeds::from_values(s, overall.len()),
            overall,
            trains: ratios
                .into_iter()
                .map(|ratios| parts.train(ratios))
                .collect(),
            neutral_share: s.number(&MANUAL.neutral_share),
            coupling: coupling::drivers_clutch(s, &MANUAL.launch),
            map,
            factor: None,
        };
        manual.scale_losses(&factors);
        manual
    }
}

impl ShiftSpeeds {
    /// One speed between each two of the gears.
    fn from_values<V: Values>(s: &V, gears: usize) -> Self {
        let count = gears.saturating_sub(1).max(1);
        let speeds = |key: &Key<'static>| match key.kind {
            Kind::Numbers(each, ..) => s.numbers(&Key {
                kind: Kind::Numbers(each, count, count),
                ..*key
            }),
            _ => Vec::new(),
        };
        let up = speeds(&MANUAL.upshift_kmh);
        let down = speeds(&MANUAL.downshift_kmh);
        if down.iter().zip(&up).any(|(d, u)| d >= u) {
            s.complain(
                "downshift_kmh",
                "below upshift_kmh in every gear",
                "a down-shift speed is not below its up-shift speed",
                "leave a gap of a few km/h so that the box does not hunt",
            );
        }
        for (key, list) in [("upshift_kmh", &up), ("downshift_kmh", &down)] {
            if list.windows(2).any(|w| w[0] >= w[1]) {
                s.complain(
                    key,
                    "rising",
                    "shift speeds must rise from gear to gear",
                    "order them from first gear",
                );
            }
        }
        ShiftSpeeds {
            up_m_s: up,
            down_m_s: down,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transmission::component::Component;

    #[test]
    fn there_is_a_factor_for_each_loss() {
        let components = Component::ALL.into_iter().filter(|c| !c.part().is_cvt());
        let names: Vec<&str> = components.map(Component::name).collect();
        let keys: Vec<&str> = LossFactorKeys::TABLE.keys.iter().map(|k| k.name).collect();
        assert_eq!(keys, names);
    }
}
