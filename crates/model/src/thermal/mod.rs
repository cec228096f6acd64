//! Warm-up: a network of five nodes for engine and transmission.
//!
//! | label | statement | status |
//! |---|---|---|
//! | TH-1 | C_i dT_i/dt = P_i + sum G_ij (T_j - T_i) + G_i,air (T_air - T_i) | derived: energy balance; C from masses, G fitted or ASSUMED |
//! | TH-2 | radiator: Q = G_r(v) open(T_c) (T_c - T_amb), open from 0 at 80 degC to 1 at 92 degC | ASSUMED (the thesis prints a knee at 70-80 degC on the oil) |
//! | TH-3 | cooler: G = m c_p (1 - exp(-(U_0 + U_v v)/(m c_p))), flow m from the pump | source: heat exchanger with one side unlimited; coefficients fitted |
//! | TH-4 | air under the bonnet = ambient + r (T_coolant - T_amb) | ASSUMED |
//! | TH-5 | step: (C/dt + K - dQ_r/dT) dT = P - K T + ..., linearly implicit | derived: unconditionally stable, conserves to rounding |
//! | TH-7 | heat exchanger coolant to transmission oil: G open(T_c), open over 5 K above its valve's temperature | ASSUMED valve: without it the exchanger takes the heat that warms the engine |
//! | TH-8 | spray: G = G_2500 n/2500 rpm, never below 10 % of G_2500 | ASSUMED: the pump's flow carries it; G_2500 fitted to a belt about 20 K above the sump (thesis 5.5.2) |
//! | TH-9 | heat through the radiator flows out of a coolant that is warmer than the air, and into a colder one: a step in which TH-5 would turn it round is made with the radiator shut | derived: second law |
//! | TH-6 | with the engine off, radiator and all links that need a pump or splash keep 10 % | ASSUMED |
//!
//! The linear system of TH-5 is solved by elimination (links.rs).
//!
//! Nodes: coolant and block; engine oil; transmission oil; transmission metal with the sheaves; belt with the skin of the sheaves and the oil they spray (unused in a
//! manual box). Soak is the same network with the engine off. Speeds m/s, heat flows W.

mod keys;
mod links;

pub use keys::ThermalKeys;
use links::Links;

use crate::math::{clamp, exp, larger, ln, ramp, smaller};

/// Number of nodes.
pub const NODES: usize = 5;
/// Coolant and block.
pub const COOLANT: usize = 0;
/// Engine oil.
pub const ENGINE_OIL: usize = 1;
/// Transmission oil in the sump.
pub const SUMP: usize = 2;
/// Transmission metal.
pub const METAL: usize = 3;
/// Belt, pulleys and spray.
pub const BELT: usize = 4;

/// The oil-to-air cooler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cooler {
    /// U at standstill, W/K.
    pub still_w_k: f64,
    /// U per road speed, W s/(K m).
    pub per_speed_w_s_k_m: f64,
    /// Share of the pump's flow through the cooler.
    pub flow_share: f64,
    /// Largest flow, m3/s.
    pub highest_m3_s: f64,
    /// Temperature below which the cooler is bypassed, K.
    pub bypass_below_k: f64,
}

/// The checked network.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    /// Heat capacities, J/K; 0 for an unused node.
    pub capacity_j_k: [f64; NODES],
    /// Oil in the sump of the transmission, m3.
    pub sump_oil_m3: f64,
    /// Coolant to engine oil, W/K.
    pub coolant_oil_w_k: f64,
    /// Block to air at standstill and per speed.
    pub block_air_w_k: f64,
    /// Block to air per road speed, W s/(K m).
    pub block_air_per_speed: f64,
    /// Engine oil pan to air at standstill, W/K.
    pub pan_air_w_k: f64,
    /// Engine oil pan to air per road speed, W s/(K m).
    pub pan_air_per_speed: f64,
    /// Radiator fully open at standstill, W/K.
    pub radiator_w_k: f64,
    /// Radiator per road speed, W s/(K m).
    pub radiator_per_speed: f64,
    /// Thermostat begins to open, K.
    pub thermostat_from_k: f64,
    /// Thermostat fully open, K.
    pub thermostat_to_k: f64,
    /// Transmission oil to metal, W/K.
    pub oil_metal_w_k: f64,
    /// Case to air at standstill, W/K.
    pub case_air_w_k: f64,
    /// Case to air times v^0.7, W/K.
    pub case_air_per_speed: f64,
    /// Block to transmission metal through the bell housing, W/K.
    pub bell_housing_w_k: f64,
    /// Belt to transmission oil by spray with the pump at 2500 rpm, W/K (TH-8).
    pub spray_w_k: f64,
    /// Coolant to transmission oil heat exchanger, W/K.
    pub exchanger_w_k: f64,
    /// Coolant temperature from which the heat exchanger's valve opens, over 5 K, K.
    pub exchanger_opens_k: f64,
    /// Oil-to-air cooler.
    pub cooler: Option<Cooler>,
    /// Under-bonnet air: rise as a share of coolant over ambient.
    pub under_bonnet: f64,
}

/// Share of a conductance that is left with nothing turning (TH-6).
const STILL: f64 = 0.1;

/// Pump speed at which the spray's conductance is given, rad/s: the transients of thesis 5.3.2 ran at 2500 rpm.
pub const SPRAY_REFERENCE_RAD_S: f64 = crate::keys::rad_s(2500.0);

/// Temperatures of the nodes, K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heat {
    /// Node temperatures, K.
    pub node_k: [f64; NODES],
}

impl Heat {
    /// All nodes at one temperature.
    pub fn uniform(temp_k: f64) -> Self {
        Heat {
            node_k: [temp_k; NODES],
        }
    }
}

/// What happens around the nodes in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatInput {
    /// Heat into the nodes, W.
    pub power_w: [f64; NODES],
    /// Ambient temperature, K.
    pub ambient_k: f64,
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Speed of the pump, rad/s.
    pub pump_rad_s: f64,
    /// Oil flow that the pump gives, m3/s.
    pub oil_flow_m3_s: f64,
    /// Heat capacity flow of the oil per volume flow, J/(m3 K).
    pub oil_volume_heat_j_m3k: f64,
    /// Whether engine and pumps turn.
    pub running: bool,
    /// Step, s.
    pub dt_s: f64,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatStep {
    /// Temperatures at its end.
    pub heat: Heat,
    /// Heat stored, W.
    pub stored_w: f64,
    /// Heat given to the air, W.
    pub to_air_w: f64,
    /// Oil to the cooler, K; NaN without one.
    pub cooler_in_k: f64,
    /// Oil from the cooler, K; NaN without one.
    pub cooler_out_k: f64,
}

/// Conductances of one step.
struct Now {
    /// Block, engine oil pan and transmission case to the air under the bonnet, W/K.
    block_air_w_k: f64,
    pan_air_w_k: f64,
    case_air_w_k: f64,
    /// Air under the bonnet, K.
    bonnet_k: f64,
    /// Between nodes, W/K.
    links: Links,
    /// Radiator heat now and its slope.
    radiator: (f64, f64),
    /// Heat capacity flow through the cooler, W/K.
    cooler_flow_w_k: f64,
    /// Cooler conductance, transmission oil to ambient air, W/K.
    cooler_w_k: f64,
}

impl Now {
    /// Conductance of each node to its air, W/K; the radiator's slope is kept apart.
    #[inline]
    fn air_w_k(&self) -> [f64; NODES] {
        [
            self.block_air_w_k,
            self.pan_air_w_k,
            self.cooler_w_k,
            self.case_air_w_k,
            0.0,
        ]
    }

    /// Heat from each node to its air at the beginning of the step, W, that of the radiator included.
    #[inline]
    fn air_w(&self, t: &[f64; NODES], ambient_k: f64) -> [f64; NODES] {
        let bonnet = |node: usize, w_k: f64| w_k * (t[node] - self.bonnet_k);
        [
            bonnet(COOLANT, self.block_air_w_k) + self.radiator.0,
            bonnet(ENGINE_OIL, self.pan_air_w_k),
            self.cooler_w_k * (t[SUMP] - ambient_k),
            bonnet(METAL, self.case_air_w_k),
            0.0,
        ]
    }
}

/// v^0.7, 0 at standstill.
pub(crate) fn speed_power(v: f64) -> f64 {
    if v > 0.0 { exp(0.7 * ln(v)) } else { 0.0 }
}

impl Network {
    /// Belt to transmission oil by spray at a pump speed, W/K (TH-8).
    #[inline]
    pub fn spray_now_w_k(&self, pump_rad_s: f64) -> f64 {
        let share = pump_rad_s / SPRAY_REFERENCE_RAD_S;
        self.spray_w_k * larger(share, STILL) // TH-8
    }

    #[inline(always)]
    fn radiator(&self, coolant_k: f64, input: &HeatInput) -> (f64, f64) {
        let full = self.radiator_w_k + self.radiator_per_speed * input.speed_m_s;
        let full = if input.running { full } else { STILL * full };
        let width = self.thermostat_to_k - self.thermostat_from_k;
        let open = clamp((coolant_k - self.thermostat_from_k) / width, 0.0, 1.0);
        let over = coolant_k - input.ambient_k;
        // A coolant that is colder than the air warms towards it: with the opening held, the step ends between the two (TH-9).
        let slope = if open > 0.0 && open < 1.0 && over > 0.0 {
            full * (open + over / width)
        } else {
            full * open
        };
        (full * open * over, slope) // TH-2
    }

    #[inline(always)]
    fn cooler(&self, sump_k: f64, input: &HeatInput) -> (f64, f64) {
        let Some(c) = &self.cooler else {
            return (0.0, 0.0);
        };
        let flow = c.flow_share * input.oil_flow_m3_s;
        let flow = smaller(flow, c.highest_m3_s);
        let carried = flow * input.oil_volume_heat_j_m3k;
        let open = clamp((sump_k - c.bypass_below_k) / 2.0, 0.0, 1.0);
        if carried <= 0.0 || open <= 0.0 {
            return (carried, 0.0);
        }
        let u = c.still_w_k + c.per_speed_w_s_k_m * input.speed_m_s;
        (carried, open * carried * (1.0 - exp(-u / carried))) // TH-3
    }

    #[inline(always)]
    fn now(&self, heat: &Heat, input: &HeatInput, speed_power_07: f64) -> Now {
        let t = &heat.node_k;
        let v = input.speed_m_s;
        let (cooler_flow_w_k, cooler_w_k) = self.cooler(t[SUMP], input);
        let stirred = if input.running { 1.0 } else { STILL };
        Now {
            block_air_w_k: self.block_air_w_k + self.block_air_per_speed * v,
            pan_air_w_k: self.pan_air_w_k + self.pan_air_per_speed * v,
            case_air_w_k: self.case_air_w_k + self.case_air_per_speed * speed_power_07,
            bonnet_k: input.ambient_k + self.under_bonnet * (t[COOLANT] - input.ambient_k), // TH-4
            links: Links {
                coolant_oil: stirred * self.coolant_oil_w_k,
                coolant_metal: self.bell_housing_w_k,
                coolant_sump: if self.exchanger_w_k > 0.0 {
                    stirred
                        * self.exchanger_w_k
                        * ramp(
                            t[COOLANT],
                            self.exchanger_opens_k,
                            self.exchanger_opens_k + 5.0,
                        ) // TH-7
                } else {
                    0.0
                },
                sump_metal: stirred * self.oil_metal_w_k,
                sump_belt: self.spray_now_w_k(if input.running { input.pump_rad_s } else { 0.0 }),
            },
            radiator: self.radiator(t[COOLANT], input),
            cooler_flow_w_k,
            cooler_w_k,
        }
    }

    /// Advances the nodes by one step (TH-5).
    pub fn advance(&self, heat: &Heat, input: &HeatInput) -> HeatStep {
        self.advance_in_wind(heat, input, speed_power(input.speed_m_s))
    }

    /// The same, with the road speed to the power of 0.7, which a trace knows.
    #[inline(always)]
    pub fn advance_in_wind(&self, heat: &Heat, input: &HeatInput, speed_power_07: f64) -> HeatStep {
        let mut now = self.now(heat, input, speed_power_07);
        let t = &heat.node_k;
        let per_s = 1.0 / input.dt_s;
        let capacity_w_k = self.capacity_j_k.map(|capacity| capacity * per_s);
        let (air_w_k, mut air_w) = (now.air_w_k(), now.air_w(t, input.ambient_k));
        let mut rise = self.rise_k(&now, t, input, &capacity_w_k, (&air_w_k, &air_w));
        // Only beyond the end of the thermostat's ramp can both be: the step was too long for its slope.
        if now.radiator.0 + now.radiator.1 * rise[COOLANT] < 0.0
            && t[COOLANT] + rise[COOLANT] > input.ambient_k
        {
            now.radiator = (0.0, 0.0); // TH-9
            air_w = now.air_w(t, input.ambient_k);
            rise = self.rise_shut_k(&now, t, input, &capacity_w_k, (&air_w_k, &air_w));
        }
        let mut node_k = *t;
        let (mut stored_w, mut to_air_w) = (0.0, now.radiator.1 * rise[COOLANT]);
        for i in 0..NODES {
            node_k[i] += rise[i];
            stored_w += capacity_w_k[i] * rise[i];
            to_air_w += air_w[i] + air_w_k[i] * rise[i];
        }
        let (cooler_in_k, cooler_out_k) = self.cooler_ends(&now, node_k[SUMP], input.ambient_k);
        HeatStep {
            heat: Heat { node_k },
            stored_w,
            to_air_w,
            cooler_in_k,
            cooler_out_k,
        }
    }

    /// Rise of the nodes within the step, K, with conductance and heat to the air of each (TH-5).
    #[inline(always)]
    fn rise_k(
        &self,
        now: &Now,
        t: &[f64; NODES],
        input: &HeatInput,
        capacity_w_k: &[f64; NODES],
        (air_w_k, air_w): (&[f64; NODES], &[f64; NODES]),
    ) -> [f64; NODES] {
        let mut right = now.links.flows_w(t);
        let mut own = *capacity_w_k;
        for i in 0..NODES {
            own[i] += air_w_k[i];
            right[i] += input.power_w[i] - air_w[i];
        }
        own[COOLANT] += now.radiator.1;
        if self.capacity_j_k[BELT] <= 0.0 {
            own[BELT] += 1.0; // unused node: keeps its pivot above zero, changes nothing else
            right[BELT] = 0.0;
        }
        now.links.rise_k(&own, &right)
    }

    /// The same for the rare step in which the thermostat shuts (TH-9), kept out of the way of the others.
    #[cold]
    #[inline(never)]
    fn rise_shut_k(
        &self,
        now: &Now,
        t: &[f64; NODES],
        input: &HeatInput,
        capacity_w_k: &[f64; NODES],
        air: (&[f64; NODES], &[f64; NODES]),
    ) -> [f64; NODES] {
        self.rise_k(now, t, input, capacity_w_k, air)
    }

    #[inline]
    fn cooler_ends(&self, now: &Now, sump_k: f64, ambient_k: f64) -> (f64, f64) {
        if self.cooler.is_none() {
            return (f64::NAN, f64::NAN);
        }
        let effect = if now.cooler_flow_w_k > 0.0 {
            now.cooler_w_k / now.cooler_flow_w_k
        } else {
            0.0
        };
        (sump_k, sump_k - effect * (sump_k - ambient_k))
    }
}
