//! Thermal network: TH-1 to TH-9 against a plain solution of the same step, a tiny step, closed forms and conservation.

use super::same;
use cvtcycle_model::thermal::{
    BELT, COOLANT, Cooler, ENGINE_OIL, Heat, HeatInput, METAL, NODES, Network,
    SPRAY_REFERENCE_RAD_S, SUMP,
};

/// The network of the part's tests, with a heat exchanger and a bypassed cooler.
fn network() -> Network {
    let base = small_network();
    let bypassed = |cooler| Cooler {
        bypass_below_k: 340.0,
        ..cooler
    };
    Network {
        exchanger_w_k: 60.0,
        cooler: base.cooler.map(bypassed),
        ..base
    }
}

fn input() -> HeatInput {
    HeatInput {
        power_w: [8e3, 1.5e3, 700.0, 100.0, 500.0],
        ambient_k: 263.15,
        speed_m_s: 11.0,
        pump_rad_s: 190.0,
        oil_flow_m3_s: 3e-4,
        oil_volume_heat_j_m3k: 1.67e6,
        running: true,
        dt_s: 2.0,
    }
}

/// One step of TH-5 with every conductance written down, solved by nalgebra's general solver: rise of the nodes and the heat to the air.
fn step(n: &Network, t: &[f64; NODES], i: &HeatInput) -> ([f64; NODES], f64, (f64, f64)) {
    let stir = if i.running { 1.0 } else { 0.1 };
    let amb = i.ambient_k;
    let mut m = nalgebra::SMatrix::<f64, NODES, NODES>::zeros();
    let mut b = nalgebra::SVector::<f64, NODES>::from(i.power_w);
    for (node, capacity) in n.capacity_j_k.iter().enumerate() {
        m[(node, node)] += capacity / i.dt_s;
    }
    let open = ((t[COOLANT] - n.exchanger_opens_k) / 5.0).clamp(0.0, 1.0); // TH-7
    let spray = n.spray_w_k
        * if i.running {
            (i.pump_rad_s / SPRAY_REFERENCE_RAD_S).max(0.1)
        } else {
            0.1
        }; // TH-8
    let links = [
        (COOLANT, ENGINE_OIL, stir * n.coolant_oil_w_k),
        (COOLANT, METAL, n.bell_housing_w_k),
        (COOLANT, SUMP, stir * n.exchanger_w_k * open),
        (SUMP, METAL, stir * n.oil_metal_w_k),
        (SUMP, BELT, spray),
    ];
    for (x, y, g) in links {
        m[(x, x)] += g;
        m[(y, y)] += g;
        m[(x, y)] -= g;
        m[(y, x)] -= g;
        b[x] -= g * (t[x] - t[y]);
        b[y] -= g * (t[y] - t[x]);
    }
    let bonnet = amb + n.under_bonnet * (t[COOLANT] - amb); // TH-4
    let mut cooler = (0.0, 0.0);
    if let Some(c) = &n.cooler {
        let carried =
            (c.flow_share * i.oil_flow_m3_s).min(c.highest_m3_s) * i.oil_volume_heat_j_m3k;
        let through = ((t[SUMP] - c.bypass_below_k) / 2.0).clamp(0.0, 1.0);
        let u = c.still_w_k + c.per_speed_w_s_k_m * i.speed_m_s;
        cooler = (
            carried,
            if carried > 0.0 {
                through * carried * (1.0 - (-u / carried).exp())
            } else {
                0.0
            },
        ); // TH-3
    }
    let wind = if i.speed_m_s > 0.0 {
        i.speed_m_s.powf(0.7)
    } else {
        0.0
    };
    let air = [
        (
            COOLANT,
            n.block_air_w_k + n.block_air_per_speed * i.speed_m_s,
            bonnet,
        ),
        (
            ENGINE_OIL,
            n.pan_air_w_k + n.pan_air_per_speed * i.speed_m_s,
            bonnet,
        ),
        (SUMP, cooler.1, amb),
        (METAL, n.case_air_w_k + n.case_air_per_speed * wind, bonnet),
    ];
    for (node, g, to) in air {
        m[(node, node)] += g;
        b[node] -= g * (t[node] - to);
    }
    let full =
        (n.radiator_w_k + n.radiator_per_speed * i.speed_m_s) * if i.running { 1.0 } else { 0.1 };
    let width = n.thermostat_to_k - n.thermostat_from_k;
    let valve = ((t[COOLANT] - n.thermostat_from_k) / width).clamp(0.0, 1.0);
    let over = t[COOLANT] - amb;
    let slope = if valve > 0.0 && valve < 1.0 && over > 0.0 {
        full * (valve + over / width)
    } else {
        full * valve
    };
    m[(COOLANT, COOLANT)] += slope;
    b[COOLANT] -= full * valve * over; // TH-2
    if n.capacity_j_k[BELT] <= 0.0 {
        m[(BELT, BELT)] += 1.0;
        b[BELT] = 0.0;
    }
    let rise = m.lu().solve(&b).unwrap();
    let to_air: f64 = air
        .iter()
        .map(|(node, g, to)| g * (t[*node] + rise[*node] - to))
        .sum::<f64>()
        + full * valve * over
        + slope * rise[COOLANT];
    (rise.into(), to_air, cooler)
}

#[track_caller]
fn check(n: &Network, t: [f64; NODES], i: &HeatInput) {
    let got = n.advance(&Heat { node_k: t }, i);
    let (rise, to_air, cooler) = step(n, &t, i);
    for node in 0..NODES {
        assert!(
            (got.heat.node_k[node] - t[node] - rise[node]).abs() < 1e-10,
            "node {node}: {} {}",
            got.heat.node_k[node] - t[node],
            rise[node]
        );
    }
    let stored: f64 = (0..NODES)
        .map(|k| n.capacity_j_k[k] * rise[k] / i.dt_s)
        .sum();
    assert!(
        (got.stored_w - stored).abs() < 1e-8 * (1.0 + stored.abs()),
        "stored {} {stored}",
        got.stored_w
    );
    assert!(
        (got.to_air_w - to_air).abs() < 1e-8 * (1.0 + to_air.abs()),
        "air {} {to_air}",
        got.to_air_w
    );
    if n.cooler.is_some() {
        let end = got.heat.node_k[SUMP];
        same(got.cooler_in_k, end);
        same(
            got.cooler_out_k,
            end - if cooler.0 > 0.0 {
                cooler.1 / cooler.0
            } else {
                0.0
            } * (end - i.ambient_k),
        );
    } else {
        assert!(got.cooler_in_k.is_nan() && got.cooler_out_k.is_nan());
    }
}

/// TH-1 to TH-8 in every regime of their valves: cold, in each ramp, hot; driving, standing, engine off; with and without a cooler.
#[test]
fn val_steps_against_a_dense_solver() {
    let n = network();
    let dry = Network {
        cooler: None,
        exchanger_w_k: 0.0,
        ..network()
    };
    let manual = Network {
        capacity_j_k: [28e3, 22e3, 8.4e3, 24e3, 0.0],
        spray_w_k: 0.0,
        ..network()
    };
    for n in [&n, &dry, &manual] {
        for t in [
            [263.15; NODES],
            [300.0, 290.0, 280.0, 275.0, 310.0],
            [345.0, 330.0, 341.0, 320.0, 350.0],
            [349.0, 350.0, 339.9, 330.0, 360.0],
            [358.0, 360.0, 345.0, 340.0, 365.0],
            [370.0, 375.0, 360.0, 350.0, 380.0],
        ] {
            for i in [
                input(),
                HeatInput {
                    speed_m_s: 0.0,
                    ..input()
                },
                HeatInput {
                    running: false,
                    ..input()
                },
                HeatInput {
                    pump_rad_s: 10.0,
                    oil_flow_m3_s: 0.0,
                    ..input()
                },
                HeatInput {
                    oil_flow_m3_s: 9e-4,
                    dt_s: 0.5,
                    ..input()
                },
                HeatInput {
                    ambient_k: 320.0,
                    power_w: [0.0; NODES],
                    ..input()
                },
            ] {
                check(n, t, &i);
            }
        }
    }
}

/// TH-9: a long step in which the slope of the thermostat would turn the radiator's heat round is made with the radiator shut.
#[test]
fn radiator_never_heats_a_coolant_above_the_air() {
    let n = network();
    let i = HeatInput {
        power_w: [0.0; NODES],
        dt_s: 600.0,
        ..input()
    };
    let t = [353.3, 280.0, 280.0, 280.0, 280.0];
    let (rise, _, _) = step(&n, &t, &i);
    let full = 100.0 + 40.0 * 11.0;
    let valve = (353.3 - 353.15) / 12.0;
    let over = 353.3 - 263.15;
    let heat = full * valve * over + full * (valve + over / 12.0) * rise[COOLANT];
    assert!(
        heat < 0.0 && t[COOLANT] + rise[COOLANT] > i.ambient_k,
        "the case is none: {heat} {rise:?}"
    );
    let shut = Network {
        radiator_w_k: 0.0,
        radiator_per_speed: 0.0,
        ..network()
    };
    let (got, want) = (
        n.advance(&Heat { node_k: t }, &i),
        shut.advance(&Heat { node_k: t }, &i),
    );
    for k in 0..NODES {
        same(got.heat.node_k[k], want.heat.node_k[k]);
    }
    same(got.to_air_w, want.to_air_w);
}

/// TH-8 on both sides of its floor, closely.
#[test]
fn val_spray_at_its_floor() {
    for (share, want) in [(0.09, 7.0), (0.103, 7.21), (0.2, 14.0)] {
        same(network().spray_now_w_k(share * SPRAY_REFERENCE_RAD_S), want);
    }
}

/// A cooler whose file says nothing of a bypass has none above -60 degC.
#[test]
fn a_cooler_is_open_where_nothing_is_said() {
    let text = include_str!("../../../../vehicles/rover_216_cvt.toml");
    let kept: Vec<&str> = text
        .lines()
        .filter(|line| !line.starts_with("bypass_below_degc"))
        .collect();
    assert_eq!(kept.len() + 1, text.lines().count());
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("car.toml");
    std::fs::write(&file, kept.join("\n")).unwrap();
    let car = cvtcycle_config::setup::load(
        file.to_str().unwrap(),
        &cvtcycle_config::setup::Options::default(),
    )
    .unwrap()
    .car(293.15);
    same(car.network.cooler.unwrap().bypass_below_k, 213.15);
}

pub fn small_network() -> Network {
    Network {
        capacity_j_k: [28e3, 22e3, 8.4e3, 24e3, 6e3],
        sump_oil_m3: 4.5e-3,
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

fn driving(dt_s: f64) -> HeatInput {
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
    let n = small_network();
    let mut heat = Heat::uniform(263.15);
    for _ in 0..(total_s / dt_s).round() as usize {
        heat = n.advance(&heat, &driving(dt_s)).heat;
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
    let n = small_network();
    for dt in [1e-3, 0.1, 1.0, 60.0, 3600.0] {
        let mut heat = Heat::uniform(263.15);
        for _ in 0..50 {
            let s = n.advance(&heat, &driving(dt));
            let power: f64 = driving(dt).power_w.iter().sum();
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
    let mut n = small_network();
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
        ..driving(0.5)
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
    let n = small_network();
    let s = n.advance(
        &Heat::uniform(263.15),
        &HeatInput {
            power_w: [0.0; NODES],
            ..driving(1.0)
        },
    );
    assert!(s.heat.node_k.iter().all(|t| (t - 263.15).abs() < 1e-12) && s.to_air_w.abs() < 1e-9);
}

/// TH-8 by hand: half the speed, half the conductance; at rest a tenth.
#[test]
fn val_spray_follows_the_pump() {
    let n = small_network();
    for (share, want) in [(2.0, 140.0), (1.0, 70.0), (0.5, 35.0), (0.0, 7.0)] {
        assert!(
            (n.spray_now_w_k(share * SPRAY_REFERENCE_RAD_S) - want).abs() < 1e-9,
            "{share}"
        );
    }
}
