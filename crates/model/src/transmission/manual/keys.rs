//! Keys of `[transmission.manual]`, and a manual gearbox from their values.

use super::{Manual, ShiftSpeeds};
use crate::keys::{Key, Kind, Values, keys};
use crate::transmission::coupling::{self, LAUNCH};
use crate::transmission::viscous_self_heating::{SELF_HEATING, ViscousSelfHeating};

keys! {
    /// Keys of `[transmission.manual]` and its tables.
    MANUAL: ManualKeys = "manual" [
        MeshKeys::TABLE, SealKeys::TABLE, BearingKeys::TABLE, ChurningKeys::TABLE, MapKeys::TABLE
    ] {
        overall_ratios: list(0.5, 40.0, 2, 10), "engine speed over wheel speed in each gear, from first";
        upshift_kmh: list(1.0, 300.0, 1, 9), "vehicle speeds to shift up where a cycle has no gears", ["MB-5"];
        downshift_kmh: list(1.0, 300.0, 1, 9), "vehicle speeds to shift down", ["MB-5"];
        reference_mm2_s: number(1.5, 1000.0), "viscosity at which the torques hold", ["MB-2"];
        neutral_share: number(0.0, 1.0), "share of the losses that turns in neutral";
        launch: LAUNCH, "launch device: a wet or dry friction clutch";
    }

    /// Keys of `[transmission.manual.mesh]`.
    MESH: MeshKeys = "mesh" [] {
        efficiency: number(0.8, 1.0), "of gear and final drive together", ["MB-1"];
    }

    /// Keys of `[transmission.manual.seal]`.
    SEAL: SealKeys = "seal" [] {
        torque_nm: number(0.0, 20.0), "at reference viscosity", ["MB-2"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["MB-2"];
    }

    /// Keys of `[transmission.manual.bearing]`.
    BEARING: BearingKeys = "bearing" [] {
        torque_nm: number(0.0, 20.0), "at 2000 rpm and reference viscosity", ["MB-3"];
        film_heating_w: SELF_HEATING, "dissipation at which the heat of the films halves the torque; absent: no heating", ["MB-3", "FH-1"];
    }

    /// Keys of `[transmission.manual.churning]`.
    CHURNING: ChurningKeys = "churning" [] {
        torque_nm: number(0.0, 20.0), "at 2000 rpm and reference viscosity", ["MB-4"];
        viscous_exponent: number(0.0, 1.5), "exponent of viscosity", ["MB-4"];
    }

    /// Keys of `[transmission.manual.maps]`.
    MAPS: MapKeys = "maps" [] {
        r#box: optional(text()), "CSV of measured torque loss at the input shaft that replaces mesh, bearings, churning and seals";
    }
}

impl Manual {
    /// A checked manual gearbox from the values of `[transmission.manual]`.
    pub fn from_values<V: Values>(s: &V) -> Self {
        let overall = s.numbers(&MANUAL.overall_ratios);
        if overall.windows(2).any(|r| r[0] <= r[1]) {
            s.complain(
                "overall_ratios",
                "falling from gear to gear",
                "ratios must fall from first to top gear",
                "order them from first gear; reverse does not belong here",
            );
        }
        let (seal, bearing, churning, mesh) = (
            s.table("seal"),
            s.table("bearing"),
            s.table("churning"),
            s.table("mesh"),
        );
        Manual {
            shifts: ShiftSpeeds::from_values(s, overall.len()),
            overall,
            mesh_efficiency: mesh.number(&MESH.efficiency),
            seal_nm: seal.number(&SEAL.torque_nm),
            seal_exponent: seal.number(&SEAL.viscous_exponent),
            bearing_nm: bearing.number(&BEARING.torque_nm),
            bearing_heating: ViscousSelfHeating::from_values(&bearing, &BEARING.film_heating_w),
            churning_nm: churning.number(&CHURNING.torque_nm),
            churning_exponent: churning.number(&CHURNING.viscous_exponent),
            reference_m2_s: s.number(&MANUAL.reference_mm2_s),
            neutral_share: s.number(&MANUAL.neutral_share),
            coupling: coupling::from_values(s, &MANUAL.launch, 0.0),
            map: s.table("maps").loss_map(&MAPS.r#box, "gear"),
        }
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
