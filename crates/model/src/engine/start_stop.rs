//! Start-stop: when the engine stops at rest, what feeds the consumers meanwhile, and what a restart takes.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SS-1 | stops after t_d at rest, in neutral, where coolant, sump (of a CVT) and ambient are within their limits, the engine ran t_r since its start (min_run_s) and t_f has passed since key-on (first_stop_after_s), the car was faster than v_min since the last stop, and E > E_0/2 | limits source: service data of Toyota, Honda, Infiniti, Ford; t_d and E ASSUMED |
//! | SS-2 | starts t_l before the car moves, or where a limit fails, E < E_0/4, or after the longest stop | ASSUMED: a driver's foot leaves the brake 0.3 to 1 s before |
//! | SS-3 | fuel of the start m = max(t_i m'_idle, m_0 clip((60 degC - T)/60 K, 0, 1)) in its step; EN-9 and the raised idle of EN-1 are of the first start alone | source: Ford Fusion 2.5 L, a restart is 9 s of idle, enrichment included (FOTW 1239); t_i ASSUMED, 1 to 9 s |
//! | SS-4 | starter: E = (J w_idle2/2 + W_c)/eta_s, W_c = T_drag(w_idle) w_idle t_c/2 heats the block | derived; eta_s source: starter data, 2 kW in and 1.1 kW out; t_c ASSUMED |
//! | SS-5 | pressure of a stopped CVT: p = p_0 exp(-t/tau), or that of its electric pump | ASSUMED: tau 0.3 to 3 s |
//! | EP-1 | electric pump of a stopped CVT: P = p V/eta_p, V by PU-2; all of it heats the sump | derived; p 3 to 8 bar, eta_p 0.4 to 0.75 ASSUMED |
//! | EL-1 | consumers: P_c = eta_a P_el of EN-4, from the store while the engine is stopped | derived: the same consumers by another way |
//! | EL-2 | store: dE/dt = -P/eta_b giving; eta_a eta_b P_s taking, P_s = min(P_max, (E_0 - E)/(eta_b tau_c))/eta_a at the shaft, tau_c = 60 s or the step | efficiencies source: alternators 0.5 to 0.6, 48 V machines 0.8; P_max, eta_b and tau_c ASSUMED |
//! | EL-3 | ledger: power out of the store = -dE/dt; electric loss = what alternator, store and starter lose | derived: power balance |
//!
//! The trace is known, so a start is in time. A step is either with or without engine: a drive cuts its trace where a stop begins and ends. A cycle
//! that switches the engine off itself goes before all of it. Electric losses heat no node.

use super::starter_generator::{Before, Flow, StarterGenerator, StarterGeneratorKeys};
use super::{Engine, EngineAtTemperature};
use crate::keys::{Repeat, Values, keys};
use crate::math::{Real, clamp, exp, larger, physics, smaller};
use crate::prime_mover::PrimeMover;

/// The checked start-stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartStop {
    /// Coolant between which it may stop, K.
    pub coolant_k: [f64; 2],
    /// Transmission oil of a CVT between which it may stop, K.
    pub sump_k: [f64; 2],
    /// Ambient above which it may stop, K.
    pub ambient_k: f64,
    /// Time that the engine has run since its start, s.
    pub min_run_s: f64,
    /// Time from key-on before which it does not stop, s.
    pub first_stop_after_s: f64,
    /// Speed that the car has had since the last stop, m/s.
    pub min_speed_m_s: f64,
    /// Time at rest before it stops, s.
    pub delay_s: f64,
    /// Longest stop, s.
    pub stop_max_s: f64,
    /// Time from the start to the car's motion, s.
    pub lead_s: f64,
    /// Idling time whose fuel a start takes, s.
    pub start_idle_s: f64,
    /// Time of cranking, s.
    pub crank_s: f64,
    /// Electric power over that at the alternator's shaft.
    pub alternator: f64,
    /// Power out of the store over that which left it, and into it.
    pub store: f64,
    /// Shaft power of the starter over its electric power.
    pub starter: f64,
    /// Energy of the full store, J.
    pub store_j: f64,
    /// Largest power that charges it, W.
    pub charge_w: f64,
    /// Time constant of the pressure of a stopped CVT, s.
    pub pressure_s: f64,
    /// Pressure that an electric pump holds in a stopped CVT, Pa; 0 without one.
    pub pump_pa: f64,
    /// Hydraulic over electric power of that pump.
    pub pump: f64,
    /// Belt starter-generator in place of starter and alternator, if there is one.
    pub machine: Option<StarterGenerator>,
}

/// State of start-stop between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StartStopState {
    /// True while the engine is stopped.
    pub stopped: bool,
    /// Time since the last start, s.
    pub ran_s: f64,
    /// Time since key-on, stops included, s.
    pub on_s: f64,
    /// Highest speed of the car since the last stop, m/s.
    pub fastest_m_s: f64,
    /// Time at rest so far, s.
    pub stood_s: f64,
    /// Time of the present stop, s.
    pub stopped_s: f64,
    /// Energy taken out of the store, J: of the full one, or of the charge that a starter-generator keeps (SG-2), and then below zero above it.
    pub drawn_j: f64,
}

/// Inputs of start-stop before a step.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Coolant, K.
    pub coolant_k: f64,
    /// Transmission oil of a CVT, K.
    pub sump_k: Option<f64>,
    /// Ambient, K.
    pub ambient_k: f64,
    /// Highest speed in the step, m/s.
    pub speed_m_s: f64,
    /// Time from the begin of the step until the car moves, s.
    pub rest_s: f64,
    /// True in neutral.
    pub neutral: bool,
    /// Length of the step, s.
    pub dt_s: f64,
}

/// Action of the engine in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// It runs.
    Run,
    /// It is at rest.
    Stop,
    /// It is started, and runs.
    Start,
}

/// Times closer than this are the same, s.
const SAME_S: f64 = 1e-9;
/// Share of the store above which the engine may stop (SS-1), ...
const STOPS_ABOVE: f64 = 0.5;
/// ... and below which it starts (SS-2).
const STARTS_BELOW: f64 = 0.25;
/// Time constant with which the store is filled, s (EL-2).
const FILL_S: f64 = 60.0;

impl StartStop {
    /// Decides the action of the engine in the next step (SS-1, SS-2).
    pub fn command(&self, now: &Conditions, past: &mut StartStopState) -> Command {
        let was_stopped = past.stopped;
        past.fastest_m_s = larger(now.speed_m_s, past.fastest_m_s);
        let rests = now.speed_m_s <= 0.0; // exact: a trace has 0 where the car is at rest
        past.stopped = rests && self.stops(now, past);
        past.on_s += now.dt_s;
        past.stood_s = if rests { past.stood_s + now.dt_s } else { 0.0 };
        if past.stopped {
            past.fastest_m_s = 0.0;
            past.stopped_s += now.dt_s;
            return Command::Stop;
        }
        past.stopped_s = 0.0;
        if was_stopped {
            past.ran_s = now.dt_s;
            return Command::Start;
        }
        past.ran_s += now.dt_s;
        Command::Run
    }

    /// True where the engine stops or stays stopped at rest.
    fn stops(&self, now: &Conditions, past: &StartStopState) -> bool {
        let within = |[least, most]: [f64; 2], x: f64| least <= x && x <= most;
        let allowed = now.neutral
            && within(self.coolant_k, now.coolant_k)
            && now.sump_k.is_none_or(|sump_k| within(self.sump_k, sump_k))
            && now.ambient_k >= self.ambient_k
            && now.rest_s > self.lead_s + SAME_S
            && past.on_s >= self.first_stop_after_s - SAME_S;
        let left_j = self.kept_j() - past.drawn_j;
        if past.stopped {
            return allowed
                && left_j > STARTS_BELOW * self.kept_j()
                && past.stopped_s < self.stop_max_s - SAME_S; // SS-2
        }
        allowed
            && left_j > STOPS_ABOVE * self.kept_j()
            && past.stood_s >= self.delay_s - SAME_S
            && past.ran_s >= self.min_run_s - SAME_S
            && past.fastest_m_s > self.min_speed_m_s // SS-1
    }

    /// Energy that the store has without recuperation, J (SG-2).
    pub fn kept_j(&self) -> f64 {
        match &self.machine {
            Some(machine) => machine.kept * self.store_j,
            None => self.store_j,
        }
    }

    /// Sets the power of a running engine's starter-generator in a step by SG-2 to SG-5, that of an alternator by EL-2.
    pub fn flow(
        &self,
        engine: &EngineAtTemperature,
        (wheel_w, engine_rad_s): (f64, f64),
        past: &StartStopState,
        dt_s: f64,
    ) -> Flow {
        let charging = Flow {
            shaft_w: self.charging_w(past, dt_s),
            consumers: 0.0,
        };
        let Some(machine) = &self.machine else {
            return charging;
        };
        let now = Before {
            wheel_w,
            engine_rad_s,
            drag_nm: engine.own_drag_nm(engine_rad_s),
            above_j: -past.drawn_j,
            room_j: self.store_j - self.kept_j() + past.drawn_j,
            consumers_w: self.alternator * engine.engine.electrical_w,
            dt_s,
        };
        let flow = machine.flow(&now, self.store);
        if flow == Flow::default() && past.drawn_j > 0.0 {
            return charging;
        }
        flow
    }

    /// Pressure of a stopped CVT that had another before, Pa (SS-5).
    pub fn held_pa(&self, before_pa: f64, stopped_s: f64) -> f64 {
        let fallen_pa = before_pa * exp(-stopped_s / self.pressure_s); // SS-5
        larger(fallen_pa, self.pump_pa)
    }

    /// Power of the electric pump of a stopped CVT, W, for the flow that its pressure needs, m3/s (EP-1).
    pub fn pump_w(&self, need_m3_s: f64) -> f64 {
        self.pump_pa * need_m3_s / self.pump // EP-1
    }

    /// Electric power over that at the shaft of what charges the store: alternator, or starter-generator (SG-1).
    fn generator(&self) -> f64 {
        match &self.machine {
            Some(machine) => machine.efficiency,
            None => self.alternator,
        }
    }

    /// Shaft power that charges the store in a step, W (EL-2).
    pub fn charging_w(&self, past: &StartStopState, dt_s: f64) -> f64 {
        let wanted_w = larger(past.drawn_j, 0.0) / (self.store * larger(FILL_S, dt_s));
        smaller(wanted_w, self.charge_w) / self.generator() // EL-2
    }
}

/// Electric power of a step, W.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Electric<R: Real = f64> {
    /// Out of the store; negative into it.
    pub store_w: R,
    /// Lost in alternator, store and starter.
    pub loss_w: R,
    /// Shaft power of charging, which is none of the accessories.
    pub charging_w: R,
    /// Consumers that the store feeds.
    pub consumers_w: R,
    /// Rotating energy from the starter.
    pub kinetic_w: R,
    /// Heat of the engine that is cranked.
    pub crank_w: R,
    /// Fuel of a start beyond what the running engine burns, kg/s.
    pub start_kg_s: R,
    /// The electric pump.
    pub pump_w: R,
}

#[physics]
impl<R: Real> Electric<R> {
    /// Without start-stop, for the runs of a number.
    pub fn none(number: R) -> Self {
        let zero = number.splat(0.0);
        Electric {
            store_w: zero,
            loss_w: zero,
            charging_w: zero,
            consumers_w: zero,
            kinetic_w: zero,
            crank_w: zero,
            start_kg_s: zero,
            pump_w: zero,
        }
    }
}

impl Electric {
    /// While the engine is stopped: consumers and pump from the store (EL-1, EL-2, EP-1).
    pub fn stopped(on: &StartStop, engine: &Engine, pump_w: f64) -> Self {
        let consumers_w = on.alternator * engine.electrical_w; // EL-1
        let given_w = consumers_w + pump_w;
        let store_w = given_w / on.store; // EL-2
        Electric {
            store_w,
            loss_w: store_w - given_w, // EL-3
            consumers_w,
            pump_w,
            ..Electric::default()
        }
    }

    /// In the step of a start (SS-3, SS-4).
    pub fn starting(
        on: &StartStop,
        engine: &EngineAtTemperature,
        coolant_k: f64,
        dt_s: f64,
    ) -> Self {
        let (e, w) = (engine.engine, engine.idle_rad_s);
        let kinetic_w = 0.5 * e.inertia_kg_m2 * w * w / dt_s;
        let crank_w = 0.5 * engine.own_drag_nm(w) * w * on.crank_s / dt_s; // SS-4
        let store_w = (kinetic_w + crank_w) / (on.starter() * on.store); // SS-4, EL-2
        let idling = engine.burn(w, engine.accessories_nm(w));
        let idle_kg = on.start_idle_s * (idling.fuel_kg_s - engine.start_kg_s);
        let cold_kg = e.start_kg * super::start::cold_share(coolant_k);
        Electric {
            store_w,
            loss_w: store_w - kinetic_w - crank_w, // EL-3
            kinetic_w,
            crank_w,
            start_kg_s: larger(idle_kg, cold_kg) / dt_s, // SS-3
            ..Electric::default()
        }
    }

    /// While the engine runs at a speed with what is asked of alternator or starter-generator (EL-2, SG-1, SG-4).
    pub fn running(
        on: &StartStop,
        engine: &EngineAtTemperature,
        speed_rad_s: f64,
        flow: &Flow,
    ) -> Self {
        let share = engine.charging_share(speed_rad_s);
        let charging_w = flow.shaft_w * share;
        let through = on.generator() * on.store;
        let stored_w = match charging_w < 0.0 {
            true => charging_w / through,  // SG-1
            false => through * charging_w, // EL-2
        };
        let consumers_w = flow.consumers * share * on.alternator * engine.engine.electrical_w;
        let given_w = consumers_w / on.store; // EL-1
        Electric {
            store_w: given_w - stored_w,
            loss_w: charging_w - stored_w + (given_w - consumers_w), // EL-3
            charging_w,
            consumers_w,
            ..Electric::default()
        }
    }

    /// The energy that is out of the store after a step, J.
    pub fn drawn_j(&self, on: &StartStop, before_j: f64, dt_s: f64) -> f64 {
        let full_j = on.kept_j() - on.store_j;
        larger(before_j + self.store_w * dt_s, full_j) // EL-2
    }
}

keys! {
    /// Keys of `[engine.start_stop]`.
    START_STOP: StartStopKeys = "start_stop" [StarterGeneratorKeys::TABLE.repeated(Repeat::Optional)] {
        coolant_min_degc: or(40.0, number(-40.0, 120.0)), "coolant from which the engine may stop", ["SS-1"];
        coolant_max_degc: or(105.0, number(-40.0, 130.0)), "coolant up to which it may stop", ["SS-1"];
        sump_min_degc: or(25.0, number(-60.0, 150.0)), "transmission oil of a CVT from which it may stop", ["SS-1"];
        sump_max_degc: or(115.0, number(-60.0, 160.0)), "transmission oil of a CVT up to which it may stop", ["SS-1"];
        ambient_min_degc: or(-5.0, number(-60.0, 60.0)), "ambient from which it may stop", ["SS-1"];
        min_run_s: or(20.0, number(0.0, 600.0)), "time that the engine runs after each start, restarts included", ["SS-1"];
        first_stop_after_s: or(0.0, number(0.0, 3600.0)), "time from key-on before which it does not stop; later stops are free of it", ["SS-1"];
        min_speed_kmh: or(5.0, number(0.0, 50.0)), "speed that the car must have exceeded since the last stop", ["SS-1"];
        delay_s: or(0.5, number(0.0, 10.0)), "time at rest before the engine stops", ["SS-1"];
        stop_max_s: or(180.0, above(0.0, 3600.0)), "longest stop", ["SS-2"];
        lead_s: or(0.5, number(0.0, 10.0)), "time from the start of the engine to the car's motion", ["SS-2"];
        start_idle_s: or(5.0, number(0.0, 30.0)), "idling time whose fuel a start takes", ["SS-3"];
        crank_s: or(0.3, number(0.0, 3.0)), "time of cranking", ["SS-4"];
        starter_efficiency: or(0.55, above(0.05, 1.0)), "shaft power over electric power of the starter", ["SS-4"];
        alternator_efficiency: or(0.6, above(0.05, 1.0)), "electric power over shaft power of the alternator", ["EL-1", "EL-2"];
        store_efficiency: or(0.9, above(0.05, 1.0)), "of the electric store, each way", ["EL-2"];
        store_wh: or(20.0, above(0.0, 10_000.0)), "energy of the electric store that is used", ["EL-2", "SS-1"];
        charge_w: or(600.0, above(0.0, 20_000.0)), "largest electric power that charges it", ["EL-2"];
        pressure_decay_s: or(1.0, above(0.0, 60.0)), "time constant of the pressure in a stopped CVT", ["SS-5"];
        pump_bar: or(0.0, number(0.0, 20.0)), "pressure that an electric pump holds in a stopped CVT; 0 without one", ["SS-5", "EP-1"];
        pump_efficiency: or(0.6, above(0.05, 1.0)), "hydraulic over electric power of that pump", ["EP-1"];
    }
}

impl StartStop {
    /// The start-stop of an engine from the values of its table, if there is one.
    pub(super) fn from_values<V: Values>(s: &V) -> Option<Self> {
        if !s.exists() {
            return None;
        }
        let number = |key| s.number(key);
        let on = StartStop {
            coolant_k: [&START_STOP.coolant_min_degc, &START_STOP.coolant_max_degc].map(number),
            sump_k: [&START_STOP.sump_min_degc, &START_STOP.sump_max_degc].map(number),
            ambient_k: number(&START_STOP.ambient_min_degc),
            min_run_s: number(&START_STOP.min_run_s),
            first_stop_after_s: number(&START_STOP.first_stop_after_s),
            min_speed_m_s: number(&START_STOP.min_speed_kmh),
            delay_s: number(&START_STOP.delay_s),
            stop_max_s: number(&START_STOP.stop_max_s),
            lead_s: number(&START_STOP.lead_s),
            start_idle_s: number(&START_STOP.start_idle_s),
            crank_s: number(&START_STOP.crank_s),
            starter: number(&START_STOP.starter_efficiency),
            alternator: number(&START_STOP.alternator_efficiency),
            store: number(&START_STOP.store_efficiency),
            store_j: number(&START_STOP.store_wh),
            charge_w: number(&START_STOP.charge_w),
            pressure_s: number(&START_STOP.pressure_decay_s),
            pump_pa: number(&START_STOP.pump_bar),
            pump: number(&START_STOP.pump_efficiency),
            machine: StarterGenerator::from_values(&s.table(StarterGeneratorKeys::TABLE.name)),
        };
        let ranges = [
            (
                &START_STOP.coolant_max_degc,
                on.coolant_k,
                "coolant_min_degc",
            ),
            (&START_STOP.sump_max_degc, on.sump_k, "sump_min_degc"),
        ];
        for (key, [least, most], other) in ranges {
            if most < least {
                s.complain(
                    key.name,
                    &format!("at least {other}"),
                    "the engine could never stop",
                    &format!("raise it or lower `{other}`"),
                );
            }
        }
        Some(on)
    }

    /// Shaft power of a start over electric power: of the starter, or of the starter-generator (SG-1).
    fn starter(&self) -> f64 {
        match &self.machine {
            Some(machine) => machine.efficiency,
            None => self.starter,
        }
    }

    /// The energy that a start of the warm engine takes out of the store, J.
    fn start_j(&self, engine: &Engine) -> f64 {
        let w = engine.idle_hot_rad_s;
        let friction_pa = engine.fuel.hot_friction_pa(engine.piston_m_s(w));
        let drag_nm = engine.drag_nm_of(w, friction_pa);
        let shaft_j = 0.5 * w * (engine.inertia_kg_m2 * w + drag_nm * self.crank_s);
        shaft_j / (self.starter() * self.store)
    }

    /// A store from which the engine cannot be started is reported.
    pub(super) fn check_store<V: Values>(&self, s: &V, engine: &Engine) {
        let least_j = self.start_j(engine) / STARTS_BELOW;
        if self.kept_j() < least_j {
            s.complain(
                START_STOP.store_wh.name,
                &format!("at least {:.2} Wh", least_j / 3600.0),
                "a quarter of the store does not start the warm engine",
                "give a larger store",
            );
        }
    }
}

impl EngineAtTemperature<'_> {
    /// Share of a shaft power that the alternator takes at a speed (EN-4).
    fn charging_share(&self, speed_rad_s: f64) -> f64 {
        clamp(speed_rad_s / (0.5 * self.engine.idle_hot_rad_s), 0.0, 1.0)
    }
}
