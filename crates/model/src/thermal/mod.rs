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
//! | TH-10 | at a start whose nodes are given one by one a node without a temperature has that of the nearest given one: coolant and engine oil each other's; sump, metal and belt the sump's, then metal's, then belt's; else ambient, as tyres have it | ASSUMED: engine and box soak as two lumps |
//! | TH-6 | with the engine off, radiator and all links that need a pump or splash keep 10 % | ASSUMED |
//!
//! The linear system of TH-5 is solved by elimination (links.rs).
//!
//! Nodes: coolant and block; engine oil; transmission oil; transmission metal with the sheaves; belt with the skin of the sheaves and the oil they spray (unused in a
//! manual box). Soak is the same network with the engine off. Speeds m/s, heat flows W.

mod keys;
mod links;
mod start;

pub use keys::ThermalKeys;
use links::Links;
pub use start::{START_NODES, StartTemperatures};

use crate::math::{Gather, Mask, Real, exp, ln, physics, places, ramp};

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
#[derive(Clone, Copy, Debug, Gather, PartialEq)]
pub struct Cooler<R: Real = f64> {
    /// U at standstill, W/K.
    pub still_w_k: R,
    /// U per road speed, W s/(K m).
    pub per_speed_w_s_k_m: R,
    /// Share of the pump's flow through the cooler.
    pub flow_share: R,
    /// Largest flow, m3/s.
    pub highest_m3_s: R,
    /// Temperature below which the cooler is bypassed, K.
    pub bypass_below_k: R,
}

/// The checked network.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Network<R: Real = f64> {
    /// Heat capacities, J/K; 0 for an unused node.
    pub capacity_j_k: [R; NODES],
    /// Oil in the sump of the transmission, m3.
    pub sump_oil_m3: R,
    /// Coolant to engine oil, W/K.
    pub coolant_oil_w_k: R,
    /// Block to air at standstill and per speed.
    pub block_air_w_k: R,
    /// Block to air per road speed, W s/(K m).
    pub block_air_per_speed: R,
    /// Engine oil pan to air at standstill, W/K.
    pub pan_air_w_k: R,
    /// Engine oil pan to air per road speed, W s/(K m).
    pub pan_air_per_speed: R,
    /// Radiator fully open at standstill, W/K.
    pub radiator_w_k: R,
    /// Radiator per road speed, W s/(K m).
    pub radiator_per_speed: R,
    /// Thermostat begins to open, K.
    pub thermostat_from_k: R,
    /// Thermostat fully open, K.
    pub thermostat_to_k: R,
    /// Transmission oil to metal, W/K.
    pub oil_metal_w_k: R,
    /// Case to air at standstill, W/K.
    pub case_air_w_k: R,
    /// Case to air times v^0.7, W/K.
    pub case_air_per_speed: R,
    /// Block to transmission metal through the bell housing, W/K.
    pub bell_housing_w_k: R,
    /// Belt to transmission oil by spray with the pump at 2500 rpm, W/K (TH-8).
    pub spray_w_k: R,
    /// Coolant to transmission oil heat exchanger, W/K.
    pub exchanger_w_k: R,
    /// Coolant temperature from which the heat exchanger's valve opens, over 5 K, K.
    pub exchanger_opens_k: R,
    /// Oil-to-air cooler.
    pub cooler: Option<Cooler<R>>,
    /// Under-bonnet air: rise as a share of coolant over ambient.
    pub under_bonnet: R,
}

/// Share of a conductance that is left with nothing turning (TH-6).
const STILL: f64 = 0.1;

/// Pump speed at which the spray's conductance is given, rad/s: the transients of thesis 5.3.2 ran at 2500 rpm.
pub const SPRAY_REFERENCE_RAD_S: f64 = crate::keys::rad_s(2500.0);

/// Temperatures of the nodes, K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heat<R: Real = f64> {
    /// Node temperatures, K.
    pub node_k: [R; NODES],
}

impl<R: Real> Heat<R> {
    /// All nodes at one temperature.
    pub fn uniform(temp_k: R) -> Self {
        Heat {
            node_k: [temp_k; NODES],
        }
    }
}

/// Inputs of the nodes in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatInput<R: Real = f64> {
    /// Heat into the nodes, W.
    pub power_w: [R; NODES],
    /// Ambient temperature, K.
    pub ambient_k: R,
    /// Road speed, m/s.
    pub speed_m_s: f64,
    /// Speed of the pump, rad/s.
    pub pump_rad_s: R,
    /// Oil flow that the pump gives, m3/s.
    pub oil_flow_m3_s: R,
    /// Heat capacity flow of the oil per volume flow, J/(m3 K).
    pub oil_volume_heat_j_m3k: R,
    /// True with engine and pumps turning.
    pub running: bool,
    /// Step, s.
    pub dt_s: f64,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeatStep<R: Real = f64> {
    /// Temperatures at its end.
    pub heat: Heat<R>,
    /// Heat stored, W.
    pub stored_w: R,
    /// Heat given to the air, W.
    pub to_air_w: R,
    /// Oil to the cooler, K; NaN without one.
    pub cooler_in_k: R,
    /// Oil from the cooler, K; NaN without one.
    pub cooler_out_k: R,
}

/// Conductances of one step.
struct Now<R: Real = f64> {
    /// Block, engine oil pan and transmission case to the air under the bonnet, W/K.
    block_air_w_k: R,
    pan_air_w_k: R,
    case_air_w_k: R,
    /// Air under the bonnet, K.
    bonnet_k: R,
    /// Between nodes, W/K.
    links: Links<R>,
    /// Radiator heat now and its slope.
    radiator: (R, R),
    /// Heat capacity flow through the cooler, W/K.
    cooler_flow_w_k: R,
    /// Cooler conductance, transmission oil to ambient air, W/K.
    cooler_w_k: R,
}

#[physics]
impl<R: Real> Now<R> {
    /// Conductance of each node to its air, W/K; the radiator's slope is kept apart.
    fn air_w_k(&self) -> [R; NODES] {
        [
            self.block_air_w_k,
            self.pan_air_w_k,
            self.cooler_w_k,
            self.case_air_w_k,
            self.cooler_w_k.splat(0.0),
        ]
    }

    /// Heat from each node to its air at the beginning of the step, W, that of the radiator included.
    fn air_w(&self, t: &[R; NODES], ambient_k: R) -> [R; NODES] {
        [
            self.block_air_w_k * (t[COOLANT] - self.bonnet_k) + self.radiator.0,
            self.pan_air_w_k * (t[ENGINE_OIL] - self.bonnet_k),
            self.cooler_w_k * (t[SUMP] - ambient_k),
            self.case_air_w_k * (t[METAL] - self.bonnet_k),
            ambient_k.splat(0.0),
        ]
    }
}

/// v^0.7, 0 at standstill.
pub(crate) fn speed_power(v: f64) -> f64 {
    if v > 0.0 { exp(0.7 * ln(v)) } else { 0.0 }
}

#[physics]
impl<R: Real> Network<R> {
    /// Belt to transmission oil by spray at a pump speed, W/K (TH-8).
    pub fn spray_now_w_k(&self, pump_rad_s: R) -> R {
        let share = pump_rad_s * SPRAY_REFERENCE_RAD_S.recip();
        self.spray_w_k * share.max(STILL) // TH-8
    }

    fn radiator(&self, coolant_k: R, input: &HeatInput<R>) -> (R, R) {
        let full = self.radiator_w_k + self.radiator_per_speed * input.speed_m_s;
        let full = if input.running { full } else { STILL * full };
        let per_width = 1.0 / (self.thermostat_to_k - self.thermostat_from_k);
        let open = ((coolant_k - self.thermostat_from_k) * per_width).clamp(0.0, 1.0);
        let over = coolant_k - input.ambient_k;
        // A coolant that is colder than the air warms towards it: with the opening held, the step ends between the two (TH-9).
        let opens = open.gt(0.0) & open.splat(1.0).gt(open) & over.gt(0.0);
        let flow = full * open;
        let slope = if opens.any() {
            opens.select(full * (open + over * per_width), flow)
        } else {
            flow
        };
        (flow * over, slope) // TH-2
    }

    fn cooler(&self, sump_k: R, input: &HeatInput<R>) -> (R, R) {
        let zero = sump_k.splat(0.0);
        let Some(c) = &self.cooler else {
            return (zero, zero);
        };
        let flow = c.flow_share * input.oil_flow_m3_s;
        let flow = flow.min(c.highest_m3_s);
        let carried = flow * input.oil_volume_heat_j_m3k;
        let open = ((sump_k - c.bypass_below_k) * 0.5).clamp(0.0, 1.0);
        let passed = zero.ge(carried) | zero.ge(open);
        if passed.all() {
            return (carried, zero);
        }
        let u = c.still_w_k + c.per_speed_w_s_k_m * input.speed_m_s;
        let cools = open * carried * (1.0 - (-u / carried).exp());
        (carried, passed.select(zero, cools)) // TH-3
    }

    /// The heat exchanger between coolant and transmission oil, W/K, with the pumps at a share of their flow (TH-7).
    fn exchanger_now_w_k(&self, coolant_k: R, stirred: f64) -> R {
        let there = self.exchanger_w_k.gt(0.0);
        let none = coolant_k.splat(0.0);
        if !there.any() {
            return none;
        }
        let opens_k = self.exchanger_opens_k;
        let open = ramp(coolant_k, opens_k, opens_k + 5.0);
        there.select(stirred * self.exchanger_w_k * open, none) // TH-7
    }

    fn now(&self, heat: &Heat<R>, input: &HeatInput<R>, speed_power_07: f64) -> Now<R> {
        let t = &heat.node_k;
        let v = input.speed_m_s;
        let (cooler_flow_w_k, cooler_w_k) = self.cooler(t[SUMP], input);
        let stirred = if input.running { 1.0 } else { STILL };
        let pump_rad_s = if input.running {
            input.pump_rad_s
        } else {
            input.pump_rad_s.splat(0.0)
        };
        Now {
            block_air_w_k: self.block_air_w_k + self.block_air_per_speed * v,
            pan_air_w_k: self.pan_air_w_k + self.pan_air_per_speed * v,
            case_air_w_k: self.case_air_w_k + self.case_air_per_speed * speed_power_07,
            bonnet_k: input.ambient_k + self.under_bonnet * (t[COOLANT] - input.ambient_k), // TH-4
            links: Links {
                coolant_oil: stirred * self.coolant_oil_w_k,
                coolant_metal: self.bell_housing_w_k,
                coolant_sump: self.exchanger_now_w_k(t[COOLANT], stirred),
                sump_metal: stirred * self.oil_metal_w_k,
                sump_belt: self.spray_now_w_k(pump_rad_s),
            },
            radiator: self.radiator(t[COOLANT], input),
            cooler_flow_w_k,
            cooler_w_k,
        }
    }

    /// Advances the nodes by one step (TH-5).
    #[inline]
    pub fn advance(&self, heat: &Heat<R>, input: &HeatInput<R>) -> HeatStep<R> {
        self.advance_in_wind(heat, input, speed_power(input.speed_m_s))
    }

    /// The same, with the road speed to the power of 0.7, which a trace knows.
    pub fn advance_in_wind(
        &self,
        heat: &Heat<R>,
        input: &HeatInput<R>,
        speed_power_07: f64,
    ) -> HeatStep<R> {
        let mut now = self.now(heat, input, speed_power_07);
        let t = &heat.node_k;
        let per_s = input.dt_s.recip();
        let capacity_w_k = places!(i in 0, 1, 2, 3, 4 => self.capacity_j_k[i] * per_s);
        let (air_w_k, mut air_w) = (now.air_w_k(), now.air_w(t, input.ambient_k));
        let mut rise = self.rise_k(&now, t, input, &capacity_w_k, (&air_w_k, &air_w));
        // Only beyond the end of the thermostat's ramp can both be: the step was too long for its slope.
        let zero = input.ambient_k.splat(0.0);
        let shuts = zero.gt(now.radiator.0 + now.radiator.1 * rise[COOLANT])
            & (t[COOLANT] + rise[COOLANT]).gt(input.ambient_k);
        if shuts.any() {
            now.radiator.0 = shuts.select(zero, now.radiator.0); // TH-9
            now.radiator.1 = shuts.select(zero, now.radiator.1);
            air_w = now.air_w(t, input.ambient_k);
            // Rare: kept out of the way of the other steps.
            rise =
                zero.vectorize(|| self.rise_k(&now, t, input, &capacity_w_k, (&air_w_k, &air_w)));
        }
        let node_k = places!(i in 0, 1, 2, 3, 4 => t[i] + rise[i]);
        let [s0, s1, s2, s3, s4] = places!(i in 0, 1, 2, 3, 4 => capacity_w_k[i] * rise[i]);
        let [a0, a1, a2, a3, a4] = places!(i in 0, 1, 2, 3, 4 => air_w[i] + air_w_k[i] * rise[i]);
        let stored_w = s0 + s1 + s2 + s3 + s4;
        let to_air_w = now.radiator.1 * rise[COOLANT] + a0 + a1 + a2 + a3 + a4;
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
    fn rise_k(
        &self,
        now: &Now<R>,
        t: &[R; NODES],
        input: &HeatInput<R>,
        capacity_w_k: &[R; NODES],
        (air_w_k, air_w): (&[R; NODES], &[R; NODES]),
    ) -> [R; NODES] {
        let flows_w = now.links.flows_w(t);
        let mut own = places!(i in 0, 1, 2, 3, 4 => capacity_w_k[i] + air_w_k[i]);
        let mut right = places!(i in 0, 1, 2, 3, 4 => flows_w[i] + (input.power_w[i] - air_w[i]));
        own[COOLANT] = own[COOLANT] + now.radiator.1;
        let zero = input.ambient_k.splat(0.0);
        let unused = zero.ge(self.capacity_j_k[BELT]);
        if unused.any() {
            // It keeps its pivot above zero and changes nothing else.
            own[BELT] = unused.select(own[BELT] + 1.0, own[BELT]);
            right[BELT] = unused.select(zero, right[BELT]);
        }
        now.links.rise_k(&own, &right)
    }

    fn cooler_ends(&self, now: &Now<R>, sump_k: R, ambient_k: R) -> (R, R) {
        if self.cooler.is_none() {
            let none = sump_k.splat(f64::NAN);
            return (none, none);
        }
        let flows = now.cooler_flow_w_k.gt(0.0);
        let effect = now.cooler_w_k / now.cooler_flow_w_k;
        let effect = flows.select(effect, sump_k.splat(0.0));
        (sump_k, sump_k - effect * (sump_k - ambient_k))
    }
}
