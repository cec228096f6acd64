//! The network against a tiny step, closed forms and conservation.
use cvtcycle_model::thermal::*;

pub fn network() -> Network {
    Network {
        capacity_j_k: [28e3, 22e3, 8.4e3, 24e3, 6e3],
        coolant_oil_w_k: 150.0,
        block_air_w_k: 8.0,
        block_air_per_speed: 1.0,
        pan_air_w_k: 3.0,
        pan_air_per_speed: 0.5,
        radiator_w_k: 100.0,
        radiator_per_speed: 40.0,
        thermostat_from_k: 353.15,
        thermostat_to_k: 365.15,
        oil_metal_w_k: 250.0,
        case_air_w_k: 9.0,
        case_air_per_speed: 1.2,
        bell_housing_w_k: 4.0,
        spray_w_k: 70.0,
        exchanger_w_k: 0.0,
        exchanger_opens_k: 343.15,
        cooler: Some(Cooler {
            still_w_k: 3.0,
            per_speed_w_s_k_m: 2.0,
            flow_share: 0.5,
            highest_m3_s: 2e-4,
            bypass_below_k: 0.0,
        }),
        under_bonnet: 0.1,
    }
}

fn input(dt_s: f64) -> HeatInput {
    HeatInput {
        power_w: [8e3, 1.5e3, 700.0, 100.0, 500.0],
        ambient_k: 263.15,
        speed_m_s: 10.0,
        pump_rad_s: SPRAY_REFERENCE_RAD_S,
        oil_flow_m3_s: 3e-4,
        oil_volume_heat_j_m3k: 1.67e6,
        running: true,
        dt_s,
    }
}

fn run(total_s: f64, dt_s: f64) -> Heat {
    let n = network();
    let mut heat = Heat::uniform(263.15);
    for _ in 0..(total_s / dt_s).round() as usize {
        heat = n.advance(&heat, &input(dt_s)).heat;
    }
    heat
}

/// One-second steps stay within 0.3 K of steps of 10 ms over a cold start into an open thermostat.
#[test]
fn second_steps_follow_tiny_steps() {
    let (coarse, fine) = (run(1200.0, 1.0), run(1200.0, 0.01));
    for i in 0..NODES {
        assert!(
            (coarse.node_k[i] - fine.node_k[i]).abs() < 0.3,
            "node {i}: {} {}",
            coarse.node_k[i],
            fine.node_k[i]
        );
    }
    assert!(fine.node_k[COOLANT] > 353.0, "thermostat not reached");
}

/// Heat in = stored + to air, to rounding, for steps from a millisecond to an hour, and no node leaves the physical range.
#[test]
fn conserves_and_is_stable_for_any_step() {
    let n = network();
    for dt in [1e-3, 0.1, 1.0, 60.0, 3600.0] {
        let mut heat = Heat::uniform(263.15);
        for _ in 0..50 {
            let s = n.advance(&heat, &input(dt));
            let power: f64 = input(dt).power_w.iter().sum();
            let scale = power + s.stored_w.abs() + s.to_air_w.abs();
            assert!(
                (power - s.stored_w - s.to_air_w).abs() < 1e-11 * scale,
                "dt {dt}"
            );
            heat = s.heat;
            assert!(
                heat.node_k.iter().all(|t| (260.0..800.0).contains(t)),
                "dt {dt}: {heat:?}"
            );
        }
    }
}

/// Closed form: one node alone cools as exp(-G t/C).
#[test]
fn val_soak_is_exponential() {
    let mut n = network();
    n.coolant_oil_w_k = 0.0;
    n.bell_housing_w_k = 0.0;
    n.thermostat_from_k = 900.0;
    n.thermostat_to_k = 910.0;
    n.under_bonnet = 0.0;
    let mut heat = Heat {
        node_k: [350.0, 263.15, 263.15, 263.15, 263.15],
    };
    let soak = HeatInput {
        power_w: [0.0; NODES],
        speed_m_s: 0.0,
        oil_flow_m3_s: 0.0,
        ..input(0.5)
    };
    for _ in 0..7200 {
        heat = n.advance(&heat, &soak).heat;
    }
    let want = 263.15 + 86.85 * (-8.0 * 3600.0 / 28e3f64).exp();
    assert!(
        (heat.node_k[COOLANT] - want).abs() < 0.05,
        "{} {want}",
        heat.node_k[COOLANT]
    );
}

/// Everything at ambient without heat stays there.
#[test]
fn rests_at_ambient() {
    let n = network();
    let s = n.advance(
        &Heat::uniform(263.15),
        &HeatInput {
            power_w: [0.0; NODES],
            ..input(1.0)
        },
    );
    assert!(s.heat.node_k.iter().all(|t| (t - 263.15).abs() < 1e-12) && s.to_air_w.abs() < 1e-9);
}

/// TH-8 by hand: half the speed, half the conductance; at rest a tenth.
#[test]
fn val_spray_follows_the_pump() {
    let n = network();
    for (share, want) in [(2.0, 140.0), (1.0, 70.0), (0.5, 35.0), (0.0, 7.0)] {
        assert!(
            (n.spray_now_w_k(share * SPRAY_REFERENCE_RAD_S) - want).abs() < 1e-9,
            "{share}"
        );
    }
}
