//! The thermal network by itself, with random conductances: second law, conservation, a dense solver, an exponential, the order of the step.

use cvtcycle_model::thermal::{
    BELT, COOLANT, Cooler, ENGINE_OIL, Heat, HeatInput, METAL, NODES, Network,
    SPRAY_REFERENCE_RAD_S, SUMP,
};
use nalgebra::{SMatrix, SVector};
use proptest::prelude::*;

use super::hold;
use crate::common::ZERO;

type Matrix = SMatrix<f64, NODES, NODES>;
type Vector = SVector<f64, NODES>;

/// From nothing to strong, small values as often as large ones.
fn w_k() -> impl Strategy<Value = f64> {
    prop_oneof![1 => Just(0.0), 8 => (-1.0_f64..3.7).prop_map(|x| 10_f64.powf(x))]
}

fn capacity() -> impl Strategy<Value = f64> {
    (2.0_f64..6.0).prop_map(|x| 10_f64.powf(x))
}

fn cooler() -> impl Strategy<Value = Option<Cooler>> {
    let some = (w_k(), 0.0..50.0, 0.0..1.0, 1e-6..1e-3, -60.0..100.0);
    prop::option::of(some.prop_map(
        |(still_w_k, per_speed_w_s_k_m, flow_share, highest_m3_s, bypass)| Cooler {
            still_w_k,
            per_speed_w_s_k_m,
            flow_share,
            highest_m3_s,
            bypass_below_k: ZERO + bypass,
        },
    ))
}

/// Networks of a CVT and of a manual box, whose belt node is unused.
fn networks() -> impl Strategy<Value = Network> {
    let conductances = prop::collection::vec(w_k(), 15);
    let thermostat = (40.0..120.0, 1.0..30.0);
    (
        prop::collection::vec(capacity(), NODES),
        conductances,
        thermostat,
        cooler(),
        -60.0..120.0,
        prop::bool::weighted(0.3),
    )
        .prop_map(
            |(c, g, (from, width), cooler, exchanger_opens, manual)| Network {
                capacity_j_k: [c[0], c[1], c[2], c[3], if manual { 0.0 } else { c[4] }],
                sump_oil_m3: 5e-3,
                coolant_oil_w_k: g[0],
                block_air_w_k: g[1],
                block_air_per_speed: 0.1 * g[2],
                pan_air_w_k: g[3],
                pan_air_per_speed: 0.1 * g[4],
                radiator_w_k: g[5],
                radiator_per_speed: g[6],
                thermostat_from_k: ZERO + from,
                thermostat_to_k: ZERO + from + width,
                oil_metal_w_k: g[7],
                case_air_w_k: g[8],
                case_air_per_speed: g[9],
                bell_housing_w_k: g[10],
                spray_w_k: if manual { 0.0 } else { g[11] },
                exchanger_w_k: g[12],
                exchanger_opens_k: ZERO + exchanger_opens,
                cooler,
                under_bonnet: 0.0,
            },
        )
}

fn temperatures() -> impl Strategy<Value = [f64; NODES]> {
    prop::array::uniform5(-40.0..150.0).prop_map(|t: [f64; NODES]| t.map(|t| ZERO + t))
}

fn inputs() -> impl Strategy<Value = HeatInput> {
    (
        -40.0..60.0,
        0.0..40.0,
        0.0..700.0,
        0.0..2e-3,
        -2.0_f64..1.0,
        any::<bool>(),
    )
        .prop_map(
            |(ambient, speed_m_s, pump_rad_s, oil_flow_m3_s, dt, running)| HeatInput {
                power_w: [0.0; NODES],
                ambient_k: ZERO + ambient,
                speed_m_s,
                pump_rad_s: if running { pump_rad_s } else { 0.0 },
                oil_flow_m3_s: if running { oil_flow_m3_s } else { 0.0 },
                oil_volume_heat_j_m3k: 1.67e6,
                dt_s: 10_f64.powf(dt),
                running,
            },
        )
}

/// Node temperatures as they count: the unused node of a manual box is left out.
fn used(network: &Network) -> impl Iterator<Item = usize> + '_ {
    (0..NODES).filter(|k| network.capacity_j_k[*k] > 0.0)
}

/// Second law without any source: all temperatures stay between the extremes of nodes and air, and entropy never falls, node by node and
/// air together. By TH-5 every flow is that of the temperatures at the end of the step, and ln x >= 1 - 1/x.
#[test]
fn heat_never_flows_from_cold_to_hot() {
    hold(
        20_000,
        &(networks(), temperatures(), inputs()),
        |(network, before, input)| {
            let step = network.advance(&Heat { node_k: before }, &input);
            let after = step.heat.node_k;
            let all = || used(&network).map(|k| before[k]).chain([input.ambient_k]);
            let (coldest, hottest) = (
                all().fold(f64::INFINITY, f64::min),
                all().fold(0.0, f64::max),
            );
            for k in used(&network) {
                prop_assert!(
                    (coldest - 1e-7..=hottest + 1e-7).contains(&after[k]),
                    "node {}: {:?} to {:?}",
                    k,
                    before,
                    after
                );
            }
            let stored: f64 = used(&network)
                .map(|k| network.capacity_j_k[k] * (after[k] - before[k]))
                .sum();
            let moved: f64 = used(&network)
                .map(|k| network.capacity_j_k[k] * (after[k] - before[k]).abs())
                .sum();
            prop_assert!(
                (stored + step.to_air_w * input.dt_s).abs() <= 1e-9 * moved + 1e-6,
                "{} J stored, {} W to air",
                stored,
                step.to_air_w
            );
            let nodes: f64 = used(&network)
                .map(|k| network.capacity_j_k[k] * (after[k] / before[k]).ln())
                .sum();
            let entropy = nodes + step.to_air_w * input.dt_s / input.ambient_k;
            prop_assert!(
                entropy >= -1e-9 * moved / input.ambient_k - 1e-9,
                "entropy {} J/K: {:?} to {:?}",
                entropy,
                before,
                after
            );
            Ok(())
        },
    );
}

/// Links and air of the network at one state, written down anew from TH-1 to TH-8 with thermostat and valve fully open or shut.
fn matrix(
    n: &Network,
    input: &HeatInput,
    radiator_open: bool,
    exchanger_open: bool,
) -> (Matrix, Vector) {
    let stirred = if input.running { 1.0 } else { 0.1 };
    let turning = if input.running {
        input.pump_rad_s / SPRAY_REFERENCE_RAD_S
    } else {
        0.0
    };
    let mut k = Matrix::zeros();
    let links = [
        (COOLANT, ENGINE_OIL, stirred * n.coolant_oil_w_k),
        (COOLANT, METAL, n.bell_housing_w_k),
        (
            COOLANT,
            SUMP,
            if exchanger_open {
                stirred * n.exchanger_w_k
            } else {
                0.0
            },
        ),
        (SUMP, METAL, stirred * n.oil_metal_w_k),
        (SUMP, BELT, n.spray_w_k * turning.max(0.1)),
    ];
    for (i, j, g) in links {
        k[(i, i)] += g;
        k[(j, j)] += g;
        k[(i, j)] -= g;
        k[(j, i)] -= g;
    }
    let v = input.speed_m_s;
    let radiator = if radiator_open {
        stirred * (n.radiator_w_k + n.radiator_per_speed * v)
    } else {
        0.0
    };
    let air = Vector::from([
        n.block_air_w_k + n.block_air_per_speed * v + radiator,
        n.pan_air_w_k + n.pan_air_per_speed * v,
        n.cooler.map_or(0.0, |c| cooler_w_k(&c, input)),
        n.case_air_w_k + n.case_air_per_speed * v.powf(0.7),
        0.0,
    ]);
    for i in 0..NODES {
        k[(i, i)] += air[i];
    }
    (k, air)
}

fn cooler_w_k(c: &Cooler, input: &HeatInput) -> f64 {
    let carried =
        (c.flow_share * input.oil_flow_m3_s).min(c.highest_m3_s) * input.oil_volume_heat_j_m3k;
    if carried > 0.0 {
        carried * (1.0 - (-(c.still_w_k + c.per_speed_w_s_k_m * input.speed_m_s) / carried).exp())
    } else {
        0.0
    }
}

/// A state in which thermostat and valve are fully shut or open, and stay so.
fn steady(mut n: Network, warm: bool) -> Network {
    let at = ZERO + if warm { -90.0 } else { 900.0 };
    (n.thermostat_from_k, n.thermostat_to_k, n.exchanger_opens_k) = (at - 1.0, at, at - 6.0);
    if let Some(cooler) = &mut n.cooler {
        cooler.bypass_below_k = ZERO - 200.0;
    }
    if n.capacity_j_k[BELT] <= 0.0 {
        (n.capacity_j_k[BELT], n.spray_w_k) = (5e3, 40.0);
    }
    n
}

/// Outside truth: the step by a dense solver of another library, over a matrix that is written down here.
#[test]
fn val_a_step_is_that_of_a_dense_solver() {
    let powers = prop::array::uniform5(0.0..20e3);
    hold(
        5_000,
        &(networks(), temperatures(), inputs(), powers, any::<bool>()),
        |(network, before, input, power_w, warm)| {
            let network = steady(network, warm);
            let input = HeatInput { power_w, ..input };
            let (k, air) = matrix(&network, &input, warm, warm);
            let capacity = Vector::from(network.capacity_j_k) / input.dt_s;
            let t = Vector::from(before);
            let right = Vector::from(power_w) + air * input.ambient_k - k * t;
            let rise = (k + Matrix::from_diagonal(&capacity))
                .lu()
                .solve(&right)
                .unwrap();
            let after = network
                .advance(&Heat { node_k: before }, &input)
                .heat
                .node_k;
            for i in 0..NODES {
                let want = before[i] + rise[i];
                prop_assert!(
                    (after[i] - want).abs() <= 1e-8 * (want.abs() + 300.0),
                    "node {}: {} instead of {}",
                    i,
                    after[i],
                    want
                );
            }
            Ok(())
        },
    );
}

/// Temperatures after a time by so many equal steps.
fn stepped(
    network: &Network,
    before: &[f64; NODES],
    input: &HeatInput,
    seconds: f64,
    steps: u32,
) -> Vector {
    let input = HeatInput {
        dt_s: seconds / f64::from(steps),
        ..*input
    };
    let mut heat = Heat { node_k: *before };
    for _ in 0..steps {
        heat = network.advance(&heat, &input).heat;
    }
    Vector::from(heat.node_k)
}

/// The stated order of TH-5 is one (linearly implicit Euler): against the exact solution by a matrix exponential, half the step leaves half
/// the error.
#[test]
fn val_half_the_step_leaves_half_the_error() {
    let powers = prop::array::uniform5(0.0..20e3);
    hold(
        300,
        &(networks(), temperatures(), inputs(), powers, any::<bool>()),
        |(network, before, input, power_w, warm)| {
            let network = steady(network, warm);
            let input = HeatInput { power_w, ..input };
            let (k, air) = matrix(&network, &input, warm, warm);
            let inverse =
                Matrix::from_diagonal(&Vector::from(network.capacity_j_k.map(|c| 1.0 / c)));
            let rates = inverse * k;
            // Over a time in which the fastest node moves, but not so many of its time constants that nothing is left to compare.
            let seconds = 1.0 / rates.norm().max(1e-9);
            // x' = A x + b as one exponential of (A b; 0 0), which needs no inverse of A.
            let mut whole = SMatrix::<f64, 6, 6>::zeros();
            whole
                .fixed_view_mut::<5, 5>(0, 0)
                .copy_from(&(-rates * seconds));
            whole
                .fixed_view_mut::<5, 1>(0, 5)
                .copy_from(&(inverse * (Vector::from(power_w) + air * input.ambient_k) * seconds));
            let exact = (whole.exp()
                * SVector::<f64, 6>::from([
                    before[0], before[1], before[2], before[3], before[4], 1.0,
                ]))
            .fixed_rows::<5>(0)
            .into_owned();
            let error = |steps| (stepped(&network, &before, &input, seconds, steps) - exact).norm();
            let (coarse, fine) = (error(64), error(128));
            if coarse > 1e-6 {
                prop_assert!(
                    (fine / coarse - 0.5).abs() < 0.02,
                    "errors {} and {} K",
                    coarse,
                    fine
                );
            }
            prop_assert!(
                coarse < 1e-2 * (1.0 + (exact - Vector::from(before)).norm()),
                "error {} K",
                coarse
            );
            Ok(())
        },
    );
}

/// The same order where the thermostat opens on the way, against steps sixty-four times finer.
#[test]
fn half_the_step_leaves_half_the_error_across_the_thermostat() {
    let strategy = (8e3..25e3, 60e3..200e3, 200.0..700.0, 5.0..25.0, -20.0..40.0);
    hold(
        100,
        &strategy,
        |(power, block_j_k, fan_w_k, width, ambient)| {
            let network = Network {
                capacity_j_k: [block_j_k, 22e3, 8e3, 24e3, 6e3],
                sump_oil_m3: 5e-3,
                coolant_oil_w_k: 200.0,
                block_air_w_k: 8.0,
                block_air_per_speed: 0.6,
                pan_air_w_k: 2.0,
                pan_air_per_speed: 0.5,
                radiator_w_k: fan_w_k,
                radiator_per_speed: 40.0,
                thermostat_from_k: ZERO + 70.0,
                thermostat_to_k: ZERO + 70.0 + width,
                oil_metal_w_k: 250.0,
                case_air_w_k: 10.0,
                case_air_per_speed: 1.2,
                bell_housing_w_k: 4.0,
                spray_w_k: 55.0,
                exchanger_w_k: 0.0,
                exchanger_opens_k: ZERO + 70.0,
                cooler: None,
                under_bonnet: 0.0,
            };
            let input = HeatInput {
                power_w: [power, 2e3, 700.0, 100.0, 500.0],
                ambient_k: ZERO + ambient,
                speed_m_s: 8.0,
                pump_rad_s: 200.0,
                oil_flow_m3_s: 3e-4,
                oil_volume_heat_j_m3k: 1.67e6,
                dt_s: 1.0,
                running: true,
            };
            let run = |steps| stepped(&network, &[ZERO + 60.0; NODES], &input, 600.0, steps);
            let exact = run(64 * 1200);
            let (coarse, fine) = ((run(600) - exact).norm(), (run(1200) - exact).norm());
            prop_assert!(exact[COOLANT] > ZERO + 70.0, "the thermostat stays shut");
            prop_assert!(
                fine <= 0.6 * coarse + 1e-6 && coarse < 1.0,
                "errors {} and {} K",
                coarse,
                fine
            );
            Ok(())
        },
    );
}
