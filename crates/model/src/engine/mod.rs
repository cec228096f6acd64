//! The engine: full-load line, idle, accessories, friction with temperature, fuel.
//!
//! | label | statement | status |
//! |---|---|---|
//! | EN-1 | idle = hot + (cold - hot) clip((T_w - T_c)/(T_w - T_k), 0, 1) + n_a clip((60 degC - T_start)/30 K, 0, 1) (1 - t/t_a) while t < t_a | T_w, T_k and the line fitted to idle after start of another car (validation/outside); n_a ASSUMED |
//! | EN-2 | friction factor = 1 + s ((nu(T_f)/nu_r(T_hot))^m - 1), T_f = T_o + x (T_c - T_o), at most T_hot | source: Shayler, Leong, Murphy, SAE 2005-01-1654 (rubbing friction follows the oil's viscosity); s and m ASSUMED within its class of engines |
//! | EN-3 | enrichment = 1 + e clip((60 degC - T_c)/60 K, 0, 1) | ASSUMED |
//! | EN-4 | accessories: T = P_el/w + T_0, w at least half the idle speed | source: CO2MPAS class values |
//! | EN-5 | charge g = (p/p_0) (298.15 K/T_amb)^0.5 | source: form of SAE J1349 (charge with pressure and root of temperature, friction constant) |
//! | EN-6 | waste = fuel - crank power; exhaust takes its share, falling linearly with speed, at most fuel - indicated; oil takes its share of friction, the coolant the rest | source: ADVISOR (0.40 to 0.30 of fuel less shaft power); bound derived; unburnt enrichment goes to the exhaust |
//! | EN-7 | overrun torque = x_d Theta L V/(4 pi), or with a drag of its own x_d (D + (Theta - 1) L) V/(4 pi), D = d + d1 cm + d2 cm2; fuel off where the fuel line reaches zero, with a drag of its own (WI-3) at that drag; the wheels drag the engine only above 1.1 idle (LC-3); without fuel cut (EN-11) the engine turns itself | source: CO2MPAS rule; drag factor ASSUMED |
//! | EN-12 | free engine without fuel: w = sqrt(b2 + w0_2 - k w0) - b, k = T dt/J, b = k/2 + (drag at idle) dt/J | derived: its rotating energy turns against its own drag at w and the torque T that it passes on at the mean of w0 and w |
//! | EN-8 | full load = g (T_hot + T_f) - Theta T_f, at least 2 % of T_hot; T_hot the line of the file, T_f hot friction | derived: the air limits indicated torque, friction takes its part |
//!
//! nu is the viscosity of the oil in use, nu_r that of the reference oil, for which the hot friction of the fuel model holds. The share 1 - s of
//! that friction is throttling, gas exchange and accessories, which do not thicken in the cold.

mod fuel;
mod keys;
mod motored;
mod start;
pub mod start_stop;
pub mod starter_generator;

pub use fuel::{EFFICIENCY, FuelModel, FuelPoint, Willans};
pub use keys::{ENGINE, EngineKeys};
pub use motored::Motored;
pub use start::Running;
pub use start_stop::StartStop;

use crate::lubricant::{Lubricant, ZERO_DEGC_K};
use crate::math::{Curve, Gather, Mask, Real, physics};
use crate::prime_mover::PrimeMover;
use std::cell::RefCell;
use std::f64::consts::{FRAC_1_PI, PI};

/// Fuel power up to which none is burnt, W: a car whose demand is just the engine's own drag has some 1e-12 W of rounding, and a second of cut fuel would depend on the last bit.
const NO_FUEL_W: f64 = 1e-3;

/// Angle of the two turns of a four-stroke engine, rad, and one over it.
const FOUR_PI: f64 = 4.0 * PI;
const PER_FOUR_PI: f64 = 1.0 / FOUR_PI;
/// Torque taken up over the engine's own drag, up to which rounding explains it.
const SAME_DRAG: f64 = 1.0 + 1e-4;

/// Part of the full-load line that is left to an engine whose air does not carry its friction: keeps the throttle finite.
const MIN_FULL_LOAD: f64 = 0.02;
/// Highest temperature of the coolant, K: a half-and-half mix of water and glycol boils at 129 degC with 1 bar over ambient.
pub const HIGHEST_COOLANT_K: f64 = 130.0 + ZERO_DEGC_K;

thread_local! {
    /// Bits of idle and highest speed, full-load line, and what [`Engine::speed_for_power`] makes of them.
    static ROUTE: RefCell<Option<([u64; 2], Curve, Curve)>> = const { RefCell::new(None) };
}

/// The checked engine.
#[derive(Clone, Debug, Gather, PartialEq)]
pub struct Engine<R: Real = f64> {
    /// Displacement, m3.
    pub displacement_m3: R,
    /// Stroke, m.
    pub stroke_m: R,
    /// Rated power, W.
    pub rated_w: R,
    /// Full-load torque over speed, rad/s to Nm, at sea level.
    pub full_load: R::Curve,
    /// Largest speed, rad/s.
    pub highest_rad_s: R,
    /// Moment of inertia of engine, flywheel and primary side, kg m2.
    pub inertia_kg_m2: R,
    /// Largest torque that speeds up or slows down the rotating parts, Nm.
    pub inertia_torque_nm: R,
    /// Idle speed hot, rad/s.
    pub idle_hot_rad_s: R,
    /// Idle speed cold, rad/s.
    pub idle_cold_rad_s: R,
    /// Coolant up to which idle is cold, K.
    pub idle_cold_k: R,
    /// Coolant from which idle is hot, K.
    pub idle_warm_k: R,
    /// Idle speed above that at a cold start, rad/s.
    pub idle_after_start_rad_s: R,
    /// Time in which that falls to nothing, s.
    pub idle_after_start_s: R,
    /// Temperature at which friction is that of the warm engine, K.
    pub hot_k: R,
    /// Share s of hot friction that rubs in oil.
    pub viscous_share: R,
    /// Exponent m of viscosity.
    pub viscous_exponent: R,
    /// Viscosity of the reference oil in the warm engine, m2/s.
    pub reference_m2_s: R,
    /// Temperature of the oil films between that of the oil (0) and the coolant (1).
    pub film_coolant_share: R,
    /// Overrun drag over friction, or over what `motored` has.
    pub overrun_drag: R,
    /// Drag without fuel where it is not the friction of the fuel line.
    pub motored: Option<Motored<R>>,
    /// Enrichment e.
    pub enrichment: R,
    /// Fuel of a start at 0 degC and below, kg.
    pub start_kg: R,
    /// Time in which it is given, s.
    pub start_s: R,
    /// Coolant from which fuel is cut in overrun, K.
    pub cut_from_k: R,
    /// Speed above which all of it is cut, rad/s.
    pub cut_above_rad_s: R,
    /// Speed below which none is cut, rad/s.
    pub fuel_back_rad_s: R,
    /// Electrical load at the shaft, W.
    pub electrical_w: R,
    /// Torque of pumps and belts, Nm.
    pub accessory_nm: R,
    /// Share of the waste heat in the exhaust at idle.
    pub exhaust_idle: R,
    /// Share of the waste heat in the exhaust at the highest speed.
    pub exhaust_fast: R,
    /// Share of friction heat that goes to the oil.
    pub friction_to_oil: R,
    /// Lower heating value, J/kg.
    pub heating_value_j_kg: R,
    /// Fuel density, kg/m3.
    pub fuel_density_kg_m3: R,
    /// CO2 per fuel mass, kg/kg.
    pub co2_kg_kg: R,
    /// Fuel model.
    pub fuel: FuelModel<R>,
    /// Brake mean effective pressure up to which a Willans line was fitted, Pa; no equation uses it.
    pub fitted_pa: Option<R>,
    /// Start-stop, if there is one.
    #[gather(same)]
    pub start_stop: Option<StartStop>,
}

/// The engine at one temperature state, in one air.
#[derive(Clone, Copy, Debug)]
pub struct EngineAtTemperature<'a, R: Real = f64> {
    /// The engine.
    pub engine: &'a Engine<R>,
    /// Friction over hot friction (EN-2).
    pub friction_factor: R,
    /// Idle speed, rad/s (EN-1).
    pub idle_rad_s: R,
    /// Fuel factor of enrichment (EN-3).
    pub enrichment: R,
    /// Fuel of the start, kg/s (EN-9).
    pub start_kg_s: R,
    /// Share of its own drag that the engine takes up in overrun, with fuel cut (EN-11).
    pub cut_share: R,
    /// Charge of the cylinders over that at 25 degC and sea level (EN-5).
    pub charge: R,
    /// Power at the alternator's shaft that charges the store of start-stop, W (EL-2).
    pub charging_w: R,
}

/// Fuel and heat of the engine at one operating point, W unless said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Burn<R: Real = f64> {
    /// Fuel mass flow, kg/s.
    pub fuel_kg_s: R,
    /// Fuel power.
    pub fuel_w: R,
    /// Heat into coolant and block.
    pub to_coolant_w: R,
    /// Heat into the engine oil.
    pub to_oil_w: R,
    /// Exhaust, sensible heat and unburnt fuel.
    pub exhaust_w: R,
    /// True where fuel is cut off.
    pub cut: R::Mask,
    /// True where the fuel model left its validity.
    pub outside: R::Mask,
}

impl Engine {
    /// The engine long after its start, with fuel cut in overrun, at coolant and oil temperature, oil and charge.
    pub fn at(
        &self,
        coolant_k: f64,
        oil_k: f64,
        oil: &Lubricant,
        charge: f64,
    ) -> EngineAtTemperature<'_> {
        EngineAtTemperature {
            cut_share: 1.0,
            ..self.in_step(coolant_k, oil_k, oil, charge, &Running::LONG, 1.0)
        }
    }

    /// Mean effective pressure at full load of the hot engine at sea level, Pa.
    pub fn full_load_pa(&self, speed_rad_s: f64) -> f64 {
        self.mep_pa(self.full_load.at(speed_rad_s))
    }

    /// Speed of the greatest full-load power, rad/s.
    pub fn peak_power_rad_s(&self) -> f64 {
        self.speed_for_power()
            .points()
            .last()
            .map_or(self.highest_rad_s, |p| p.1)
    }

    /// Lowest speed, on a fine grid, at which full load gives a power; as a curve power W to speed rad/s. The last one of the thread is kept:
    /// cars of a study that differ in other parts have it in common.
    pub fn speed_for_power(&self) -> Curve {
        let ends = [self.idle_hot_rad_s, self.highest_rad_s].map(f64::to_bits);
        ROUTE.with_borrow_mut(|kept| match kept {
            Some((of, line, route)) if *of == ends && *line == self.full_load => route.clone(),
            _ => {
                let route = self.route();
                *kept = Some((ends, self.full_load.clone(), route.clone()));
                route
            }
        })
    }

    fn route(&self) -> Curve {
        let lo = self.idle_hot_rad_s;
        let mut points: Vec<(f64, f64)> = vec![(0.0, lo)];
        let mut best = 0.0;
        for i in 0..=400 {
            let speed = lo + (self.highest_rad_s - lo) * f64::from(i) / 400.0;
            let power = speed * self.full_load.at(speed);
            if power > best * (1.0 + 1e-9) && power > 0.0 {
                points.push((power, speed));
                best = power;
            }
        }
        Curve::new(&points).unwrap_or_else(|_| Curve::constant(lo))
    }
}

#[physics]
impl<R: Real> Engine<R> {
    /// The engine in a step of `dt_s`, after what it did before.
    pub fn in_step(
        &self,
        coolant_k: R,
        oil_k: R,
        oil: &Lubricant<R>,
        charge: R,
        running: &Running<R>,
        dt_s: f64,
    ) -> EngineAtTemperature<'_, R> {
        let cold = start::cold_share(coolant_k);
        EngineAtTemperature {
            engine: self,
            friction_factor: self.friction_factor(coolant_k, oil_k, oil),
            idle_rad_s: self.idle_rad_s(coolant_k, running, dt_s),
            enrichment: 1.0 + self.enrichment * cold, // EN-3
            start_kg_s: self.start_kg_s(running, dt_s),
            cut_share: self.cut_share(coolant_k, running),
            charge,
            charging_w: coolant_k.splat(0.0),
        }
    }

    /// Idle speed, its mean over a step, rad/s.
    fn idle_rad_s(&self, coolant_k: R, running: &Running<R>, dt_s: f64) -> R {
        let width = self.idle_warm_k - self.idle_cold_k;
        let cold = ((self.idle_warm_k - coolant_k) / width).clamp(0.0, 1.0);
        let started = ((start::COLD_K - running.start_k) * 30_f64.recip()).clamp(0.0, 1.0);
        // Integral of 1 - t/t_a: half of what is spent, times t_a.
        let fading = running.spending_per_s(self.idle_after_start_s, dt_s);
        let raised = 0.5 * self.idle_after_start_s * fading * started;
        self.idle_hot_rad_s
            + (self.idle_cold_rad_s - self.idle_hot_rad_s) * cold
            + self.idle_after_start_rad_s * raised // EN-1
    }

    /// Friction over that of the warm engine with the reference oil.
    fn friction_factor(&self, coolant_k: R, oil_k: R, oil: &Lubricant<R>) -> R {
        let film_k = oil_k + self.film_coolant_share * (coolant_k - oil_k);
        let film_k = film_k.min(self.hot_k);
        let thicker = oil.kinematic_m2_s(film_k) / self.reference_m2_s;
        1.0 + self.viscous_share * ((self.viscous_exponent * thicker.ln()).exp() - 1.0) // EN-2
    }

    /// Torque of a mean effective pressure (four-stroke), Nm.
    pub fn torque_nm(&self, mep_pa: R) -> R {
        mep_pa * self.displacement_m3 * PER_FOUR_PI
    }

    /// Torque taken up without fuel at a friction mean effective pressure, Nm (EN-7).
    pub(crate) fn drag_nm_of(&self, speed_rad_s: R, friction_pa: R) -> R {
        match &self.motored {
            None => self.torque_nm(friction_pa) * self.overrun_drag, // EN-7
            Some(motored) => {
                let piston_m_s = self.piston_m_s(speed_rad_s);
                // Cold oil adds to it what it adds to friction.
                let colder = friction_pa - self.fuel.hot_friction_pa(piston_m_s);
                self.torque_nm(motored.hot_pa(piston_m_s) + colder) * self.overrun_drag // EN-7
            }
        }
    }

    /// Mean effective pressure of a torque (four-stroke), Pa.
    pub fn mep_pa(&self, torque_nm: R) -> R {
        torque_nm * FOUR_PI / self.displacement_m3
    }

    /// Mean piston speed, m/s.
    pub fn piston_m_s(&self, speed_rad_s: R) -> R {
        speed_rad_s * self.stroke_m * FRAC_1_PI
    }
}

#[physics]
impl<R: Real> PrimeMover<R> for EngineAtTemperature<'_, R> {
    fn idle_rad_s(&self) -> R {
        self.idle_rad_s
    }

    fn max_rad_s(&self) -> R {
        self.engine.highest_rad_s
    }

    fn rated_w(&self) -> R {
        self.engine.rated_w
    }

    fn warm_power_w(&self, power_w: R, speed_rad_s: R) -> R {
        let hot = speed_rad_s.interpolate(&self.engine.full_load);
        power_w * hot / self.full_load_of(hot, speed_rad_s)
    }

    fn max_accel_rad_s2(&self) -> R {
        self.engine.inertia_torque_nm / self.engine.inertia_kg_m2
    }

    fn rotating_j(&self, speed_rad_s: R) -> R {
        0.5 * self.engine.inertia_kg_m2 * speed_rad_s * speed_rad_s
    }

    /// EN-12: the drag at idle is that of the slowest engine, so that none of it is missing on the way.
    fn slowed_rad_s(&self, from_rad_s: R, load_nm: R, dt_s: f64) -> R {
        let drag_nm = self.own_drag_nm(self.idle_rad_s);
        let per_nm = dt_s / self.engine.inertia_kg_m2;
        let k = load_nm * per_nm;
        let b = 0.5 * k + drag_nm * per_nm;
        let square = b * b + from_rad_s * (from_rad_s - k);
        (square.max(0.0).sqrt() - b).max(0.0) // EN-12
    }

    fn full_load_nm(&self, speed_rad_s: R) -> R {
        self.full_load_of(speed_rad_s.interpolate(&self.engine.full_load), speed_rad_s)
    }

    /// EN-4: none at standstill.
    fn accessories_nm(&self, speed_rad_s: R) -> R {
        let least = 0.5 * self.engine.idle_hot_rad_s;
        let w = speed_rad_s.max(least);
        let turning_nm =
            (self.engine.electrical_w + self.charging_w) / w + self.engine.accessory_nm;
        speed_rad_s.gt(0.0).select(turning_nm, w.splat(0.0)) // EN-4
    }

    /// EN-7: in overrun with fuel cut off; where it is not cut, the engine burns what turns it and drags nothing (EN-11).
    fn drag_nm(&self, speed_rad_s: R) -> R {
        self.cut_share * self.own_drag_nm(speed_rad_s) // EN-11
    }
}

#[physics]
impl<R: Real> EngineAtTemperature<'_, R> {
    /// Full load at a speed from that of the hot engine there, Nm (EN-8).
    fn full_load_of(&self, hot: R, speed_rad_s: R) -> R {
        let piston_m_s = self.engine.piston_m_s(speed_rad_s);
        let friction = self
            .engine
            .torque_nm(self.engine.fuel.hot_friction_pa(piston_m_s));
        // Written so that a warm engine in the reference air has its line to the bit.
        let now =
            hot + (self.charge - 1.0) * (hot + friction) - (self.friction_factor - 1.0) * friction;
        now.max(MIN_FULL_LOAD * hot) // EN-8
    }

    /// Torque that slows the engine down without fuel, Nm: what its own rotating energy may turn against, whether or not fuel is cut for the wheels.
    pub fn own_drag_nm(&self, speed_rad_s: R) -> R {
        let friction_pa = self.friction_pa(speed_rad_s);
        self.engine.drag_nm_of(speed_rad_s, friction_pa)
    }

    /// Friction mean effective pressure at the present temperature, Pa.
    pub fn friction_pa(&self, speed_rad_s: R) -> R {
        self.engine
            .fuel
            .hot_friction_pa(self.engine.piston_m_s(speed_rad_s))
            * self.friction_factor
    }

    /// Fuel and heat at a speed and crankshaft torque (with accessories and inertia), Nm.
    pub fn burn(&self, speed_rad_s: R, torque_nm: R) -> Burn<R> {
        let e = self.engine;
        let zero = speed_rad_s.splat(0.0);
        let rests = zero.ge(speed_rad_s);
        if rests.all() {
            return Burn {
                fuel_kg_s: zero,
                fuel_w: zero,
                to_coolant_w: zero,
                to_oil_w: zero,
                exhaust_w: zero,
                cut: !rests,
                outside: !rests,
            };
        }
        let brake_pa = e.mep_pa(torque_nm);
        let friction_pa = self.friction_pa(speed_rad_s);
        let piston_m_s = e.piston_m_s(speed_rad_s);
        let point = match &e.motored {
            None => e
                .fuel
                .fuel_mep(piston_m_s, speed_rad_s, brake_pa, friction_pa),
            Some(motored) => {
                let colder = friction_pa - e.fuel.hot_friction_pa(piston_m_s);
                let drag_pa = (motored.hot_pa(piston_m_s) + colder) * e.overrun_drag;
                e.fuel
                    .fuel_mep_above_drag(piston_m_s, speed_rad_s, brake_pa, friction_pa, drag_pa)
            }
        };
        let burns = point.fuel_pa.gt(0.0);
        let watts = e.displacement_m3 * speed_rad_s * PER_FOUR_PI;
        let burnt = point.fuel_pa * watts;
        let indicated = point.indicated_pa * watts;
        let friction = match &e.motored {
            // With fuel cut, throttle losses add to friction: what is taken up is the drag itself.
            None => burns.select(friction_pa * watts, -brake_pa * watts),
            // From the friction of the fuel line to the drag as fuel goes to nothing (WI-3).
            Some(_) => indicated - brake_pa * watts,
        };
        let fast = (speed_rad_s - e.idle_hot_rad_s) / (e.highest_rad_s - e.idle_hot_rad_s);
        let exhaust_share =
            e.exhaust_idle + (e.exhaust_fast - e.exhaust_idle) * fast.clamp(0.0, 1.0);
        let waste = burnt - brake_pa * watts;
        // The exhaust has no more than the gas kept: nothing once fuel is cut.
        let hot_gas = (exhaust_share * waste).min(burnt - indicated);
        let to_oil = e.friction_to_oil * friction;
        let start_w = self.start_kg_s * e.heating_value_j_kg;
        let fuel_w = burnt * self.enrichment + start_w;
        // More taken up than the closed throttle explains would be energy from nowhere in the heat of friction.
        let drawn = zero.ge(point.fuel_pa)
            & (-torque_nm).gt(self.own_drag_nm(speed_rad_s) * SAME_DRAG + 1e-3);
        Burn {
            fuel_kg_s: rests.select(zero, fuel_w / e.heating_value_j_kg),
            fuel_w: rests.select(zero, fuel_w),
            to_coolant_w: rests.select(zero, waste - hot_gas - to_oil), // EN-6
            to_oil_w: rests.select(zero, to_oil),
            exhaust_w: rests.select(zero, hot_gas + (self.enrichment - 1.0) * burnt + start_w), // EN-9
            cut: !rests & zero.splat(NO_FUEL_W).ge(fuel_w),
            outside: !rests & (point.outside | drawn),
        }
    }
}
