//! Pump PU-1, PU-2, PU-4, PU-5 (PU-3: `belt`); shaft and reverse clutch: IS-1, CD-1, CD-2, FH-1.

use super::same;
use cvtcycle_model::transmission::cvt::clutch_drag::ClutchDrag;
use cvtcycle_model::transmission::cvt::pump::{ETA_REFERENCE_PA_S, Pump, PumpKind};
use cvtcycle_model::transmission::cvt::shaft_drag::ShaftDrag;
use cvtcycle_model::transmission::cvt::{NU_REFERENCE_M2_S, viscosity_power};
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;

fn pump(kind: PumpKind) -> Pump {
    Pump {
        kind,
        displacement_m3_rad: 1.6e-6,
        friction: 0.07,
        viscous: 15_000.0,
        viscous_exponent: 0.9,
        heating: ViscousSelfHeating::halving_at_w(Some(900.0)),
        inlet_pa_s_m3: 1.2e7,
        inlet_depression_pa: 0.6e5,
        hydrodynamic_nm_s2: 2e-6,
        constant_nm: 0.11,
        line_drop_pa: 0.8e5,
        residual_pa: 1.5e5,
        lubrication_m3_s: 5e-5,
        leakage_m3_s_pa: 1.7e-11,
    }
}

/// Drag with the heating of its film (FH-1).
fn heated(unheated: f64, speed: f64, halving_w: f64) -> f64 {
    2.0 * unheated / (1.0 + (1.0 + 4.0 * unheated * speed / halving_w).sqrt())
}

/// PU-1, PU-4, PU-5 for each kind of pump, below, within and above the need that it follows.
#[test]
fn val_pump_by_hand() {
    let (eta, w, pa) = (0.25, 260.0, 17e5);
    let drawn = |flow: f64| flow / (1.0 + (flow * 1.2e7 * eta / 0.01 / 0.6e5).powi(4)).powf(0.25);
    let flow = 1.6e-6 * w;
    let smooth = |u: f64| u * u * (3.0 - 2.0 * u);
    for need in [0.0, 0.44, 0.47, 0.49, 0.6, 0.9, 1.0, 1.3].map(|share| share * drawn(flow)) {
        let wanted = need / drawn(flow);
        let cavity = ((wanted - 0.85 * 0.5) / (0.15 * 0.5)).clamp(0.0, 1.0);
        let dual = 0.5 + 0.5 * smooth(cavity);
        for (kind, share) in [
            (PumpKind::Fixed, 1.0),
            (PumpKind::DualCavity { share: 0.5 }, dual),
            (PumpKind::Variable { least: 0.2 }, wanted.clamp(0.2, 1.0)),
        ] {
            let p = pump(kind);
            let s = p.state(&p.at(eta), w, pa, need);
            let against = share * (pa + 0.8e5) + (1.0 - share) * 1.5e5;
            let viscous = heated(
                15_000.0 * 0.01 * (eta / 0.01f64).powf(0.9) * w * 1.6e-6,
                w,
                900.0,
            );
            let accelerated = 2e-6 * w * w; // C_h
            same(
                s.torque_nm,
                1.6e-6 * 1.07 * against + (viscous + accelerated) + 0.11,
            );
            same(s.flow_m3_s, flow);
            same(s.working_m3_s, drawn(share * flow));
            assert_eq!(s.flow_limited, need > drawn(flow));
        }
    }
    // A pump that draws nothing works with all it has.
    for kind in [
        PumpKind::Fixed,
        PumpKind::DualCavity { share: 0.5 },
        PumpKind::Variable { least: 0.2 },
    ] {
        let p = pump(kind);
        same(
            p.state(&p.at(eta), 0.0, pa, 1e-5).torque_nm,
            1.6e-6 * 1.07 * (pa + 0.8e5) + 0.11,
        );
    }
}

/// PU-2.
#[test]
fn val_need_by_hand() {
    let p = pump(PumpKind::Fixed);
    same(ETA_REFERENCE_PA_S, 0.010);
    same(p.at(0.04).leakage_m3_s_pa, 1.7e-11 / 4.0);
    same(p.steady_need_m3_s(20e5, 0.04), 5e-5 + 20e5 * 1.7e-11 / 4.0);
    same(p.steady_need_m3_s(0.0, 0.9), 5e-5);
    same(p.steady_need_m3_s(0.0, 4.0), 5e-5 / 4.0);
}

/// PU-6: what lubrication and shift leave of the flow, over the leakage; a tenth of a bar where they leave nothing.
#[test]
fn val_pressure_that_a_flow_keeps_up_by_hand() {
    let p = pump(PumpKind::Fixed);
    let now = p.at(0.04);
    let w = 300.0;
    let spare = now.drawn_m3_s(p.displacement_m3_rad * w) - 5e-5 - 2e-5;
    same(p.deliverable_pa(&now, w, 2e-5), spare * 4.0 / 1.7e-11);
    same(p.deliverable_pa(&now, 1.0, 2e-5), 1e4);
    // Where the flow just covers the need, it keeps up the pressure of that need.
    let pa = p.deliverable_pa(&now, w, 0.0);
    same(
        p.steady_need_m3_s(pa, 0.04),
        now.drawn_m3_s(p.displacement_m3_rad * w),
    );
}

/// IS-1, CD-1 to CD-3 at the reference viscosity, warmer and colder.
#[test]
fn val_shafts_by_hand() {
    let shaft = ShaftDrag {
        constant_nm: 0.97,
        viscous_nm_s: 7e-4,
        exponent: 0.75,
        heating: ViscousSelfHeating::halving_at_w(Some(400.0)),
    };
    let clutch = ClutchDrag {
        drag_nm: 0.25,
        exponent: 0.55,
        cap_nm: 0.5,
        peak_rad_s: None,
        clearance_m: 0.3e-3,
        oil_share: 1.0,
        set_nm: 0.0,
        set_nm_s: 0.0,
    };
    same(NU_REFERENCE_M2_S, 11e-6);
    for ratio in [0.6, 1.0, 3.0, 40.0f64] {
        let power = |exponent: f64| viscosity_power(11e-6 * ratio, exponent);
        for w in [0.0, 90.0, 300.0] {
            same(
                shaft.torque_nm(power(0.75), w),
                0.97 + heated(7e-4 * ratio.powf(0.75) * w, w, 400.0),
            );
        }
        let film_nm = |clearance_mm: f64| (0.25 * ratio.powf(0.55) * 0.3 / clearance_mm).min(0.5);
        for w in [0.0, 90.0, 700.0] {
            same(clutch.torque_nm(power(0.55), w), film_nm(0.3));
            let wide = ClutchDrag {
                peak_rad_s: Some(420.0),
                clearance_m: 0.5e-3,
                oil_share: 0.4,
                ..clutch
            };
            let rise = 2.0 * w / 420.0 / (1.0 + (w / 168.0) * (w / 168.0));
            same(wide.torque_nm(power(0.55), w), film_nm(0.5) * rise);
            let set = ClutchDrag {
                set_nm: 0.3,
                set_nm_s: 4e-4,
                ..wide
            };
            let bearings_nm = 0.3 + 4e-4 * ratio.powf(0.55) * w;
            same(
                set.torque_nm(power(0.55), w),
                film_nm(0.5) * rise + bearings_nm,
            );
        }
    }
}
