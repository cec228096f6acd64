//! A belt starter-generator (P0): recuperation into the store of start-stop, assistance out of it, and starts of the engine.
//!
//! | label | statement | status |
//! |---|---|---|
//! | SG-1 | P_el = eta_m P_shaft generating, P_shaft = eta_m P_el driving, at the crankshaft: eta_m of machine, inverter and belt; each P_el <= its largest, P_shaft <= T_max w | derived; eta_m source: 48 V machines with inverter 0.85 to 0.88 at best, belt 0.93 to 0.97 ASSUMED |
//! | SG-2 | the store is kept at E_t = x E_0 without recuperation; E above it is used, below it is filled by EL-2 | ASSUMED: the plainest rule that keeps the charge; a car's own is not known |
//! | SG-3 | wheels that brake, engine above n_min: P_g = min(SG-1, room (E_0 - E)/(dt eta_m eta_b), eta_d \|P_w\| - T_drag w), at least 0; the brakes take what CV-3 leaves | ASSUMED: eta_d 0.8; n_min 950 rpm (Suzuki, Baleno manual) |
//! | SG-4 | E > E_t: the consumers are fed from the store, EL-1, in part where E - E_t is less than they take in the step | derived from SG-2 |
//! | SG-5 | E > E_t and driving: P_a = min(SG-1, (E - E_t) eta_m eta_b/tau, x_a P_w), tau 10 s or the step, after SG-4 | ASSUMED: x_a 0.3, so that the engine keeps a load |
//! | SG-6 | a counted drive begins with the E with which it ends: the drive is repeated until \|dE\| < 0.1 % of the fuel's energy | derived: the balance that label procedures (UNECE R154, SAE J1711) correct to, without their slopes |
//!
//! w engine speed before the step, P_w power at the wheels, dt the step, eta_b of the store each way. Electric losses heat no node (EL-3).

use crate::keys::{Values, keys};
use crate::math::{larger, smaller};

/// The checked machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarterGenerator {
    /// Largest electric power of recuperation, W.
    pub recuperation_w: f64,
    /// Largest electric power of assistance, W.
    pub assistance_w: f64,
    /// Largest torque at the crankshaft, Nm.
    pub torque_nm: f64,
    /// Efficiency of machine, inverter and belt.
    pub efficiency: f64,
    /// Engine speed from which it recuperates, rad/s.
    pub least_rad_s: f64,
    /// Share of the store that is kept.
    pub kept: f64,
    /// Largest share of the power at the wheels that it assists with.
    pub assisted: f64,
}

/// Share of the power of braking wheels that reaches the crankshaft (SG-3). ASSUMED, 0.7 to 0.9.
const THROUGH_BOX: f64 = 0.8;
/// Time constant of assistance, s (SG-5). ASSUMED, 5 to 30 s.
const ASSIST_S: f64 = 10.0;

/// Shaft power of the machine in a step, and the consumers that are off its shaft.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Flow {
    /// Shaft power into the machine, W: generating above zero, driving below.
    pub shaft_w: f64,
    /// Share of the consumers that the store feeds.
    pub consumers: f64,
}

/// The car before a step.
#[derive(Clone, Copy, Debug)]
pub struct Before {
    /// Power at the wheels, W.
    pub wheel_w: f64,
    /// Engine speed, rad/s.
    pub engine_rad_s: f64,
    /// Drag of the engine there, Nm.
    pub drag_nm: f64,
    /// Energy above the kept charge, J.
    pub above_j: f64,
    /// Room in the store, J.
    pub room_j: f64,
    /// Electric power of the consumers, W.
    pub consumers_w: f64,
    /// Length of the step, s.
    pub dt_s: f64,
}

impl StarterGenerator {
    /// Largest shaft power at a speed for a largest electric one, generating or driving, W (SG-1).
    fn most_w(&self, electric_w: f64, generates: bool, engine_rad_s: f64) -> f64 {
        let shaft_w = match generates {
            true => electric_w / self.efficiency,
            false => electric_w * self.efficiency,
        };
        smaller(shaft_w, self.torque_nm * engine_rad_s)
    }

    /// Sets its power in a step by SG-3 to SG-5, with the store's efficiency each way; 0 below the kept charge in drive.
    pub fn flow(&self, now: &Before, store: f64) -> Flow {
        let w = now.engine_rad_s;
        if now.wheel_w < 0.0 && w >= self.least_rad_s {
            let room_w = now.room_j / (now.dt_s * self.efficiency * store);
            let wheels_w = THROUGH_BOX * -now.wheel_w - now.drag_nm * w;
            let most_w = smaller(self.most_w(self.recuperation_w, true, w), room_w);
            return Flow {
                shaft_w: larger(smaller(most_w, wheels_w), 0.0), // SG-3
                consumers: 0.0,
            };
        }
        if now.above_j <= 0.0 {
            return Flow::default();
        }
        let consumed_j = now.consumers_w / store * now.dt_s;
        let consumers = match consumed_j > 0.0 {
            true => smaller(now.above_j / consumed_j, 1.0), // SG-4
            false => 0.0,
        };
        let left_j = larger(now.above_j - consumers * consumed_j, 0.0);
        let by_charge_w = left_j * self.efficiency * store / larger(ASSIST_S, now.dt_s);
        let most_w = smaller(self.most_w(self.assistance_w, false, w), by_charge_w);
        let assist_w = smaller(most_w, self.assisted * larger(now.wheel_w, 0.0)); // SG-5
        Flow {
            shaft_w: -assist_w,
            consumers,
        }
    }
}

keys! {
    /// Keys of `[engine.start_stop.starter_generator]`.
    MACHINE: StarterGeneratorKeys = "starter_generator" [] {
        recuperation_w: number(0.0, 50_000.0), "largest electric power of recuperation", ["SG-1"];
        assistance_w: or(0.0, number(0.0, 50_000.0)), "largest electric power of assistance; 0 without any", ["SG-1", "SG-5"];
        torque_nm: number(1.0, 1000.0), "largest torque at the crankshaft, either way", ["SG-1"];
        efficiency: or(0.8, above(0.05, 1.0)), "of machine, inverter and belt, each way", ["SG-1"];
        least_rpm: or(950.0, number(0.0, 5000.0)), "engine speed from which it recuperates", ["SG-3"];
        kept_share: or(0.5, number(0.3, 0.95)), "share of the store that is kept", ["SG-2"];
        assisted_share: or(0.3, number(0.0, 1.0)), "largest share of the power at the wheels that it assists with", ["SG-5"];
    }
}

impl StarterGenerator {
    /// The machine from the values of its table, if there is one.
    pub(super) fn from_values<V: Values>(s: &V) -> Option<Self> {
        s.exists().then(|| StarterGenerator {
            recuperation_w: s.number(&MACHINE.recuperation_w),
            assistance_w: s.number(&MACHINE.assistance_w),
            torque_nm: s.number(&MACHINE.torque_nm),
            efficiency: s.number(&MACHINE.efficiency),
            least_rad_s: s.number(&MACHINE.least_rpm),
            kept: s.number(&MACHINE.kept_share),
            assisted: s.number(&MACHINE.assisted_share),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MACHINE: StarterGenerator = StarterGenerator {
        recuperation_w: 10e3,
        assistance_w: 8e3,
        torque_nm: 140.0,
        efficiency: 0.8,
        least_rad_s: 100.0,
        kept: 0.5,
        assisted: 0.3,
    };

    fn before(wheel_w: f64) -> Before {
        Before {
            wheel_w,
            engine_rad_s: 200.0,
            drag_nm: 20.0,
            above_j: 50e3,
            room_j: 500e3,
            consumers_w: 300.0,
            dt_s: 1.0,
        }
    }

    /// The worked point of the page, and each bound of SG-1 and SG-3 to SG-5 where it binds: by hand from the table of labels.
    #[test]
    fn val_the_worked_point_of_the_starter_generator() {
        let near = |got: f64, want: f64| {
            assert!(
                (got - want).abs() < 1e-6 * want.abs().max(1.0),
                "{got} for {want}"
            )
        };
        let shaft = |now: &Before| MACHINE.flow(now, 0.9).shaft_w;
        near(shaft(&before(-15e3)), 8e3); // 0.8 15 kW - 20 Nm 200 rad/s
        near(shaft(&before(-40e3)), 12.5e3); // 10 kW/0.8
        assert!(
            shaft(&Before {
                engine_rad_s: 99.0,
                ..before(-40e3)
            }) <= 0.0
        ); // below n_min it is no generator
        near(
            shaft(&Before {
                room_j: 3.6e3,
                ..before(-40e3)
            }),
            5e3,
        ); // 3.6/(0.8 0.9)
        near(shaft(&before(-3e3)), 0.0); // less than the engine's drag
        let flow = MACHINE.flow(&before(20e3), 0.9);
        near(flow.consumers, 1.0);
        // (50 kJ - 333.3 J) 0.8 0.9/10 s
        near(flow.shaft_w, -3_576.0);
        near(shaft(&before(5e3)), -1.5e3); // 0.3 5 kW
        let flow = MACHINE.flow(
            &Before {
                above_j: 200.0,
                ..before(20e3)
            },
            0.9,
        );
        near(flow.consumers, 0.6); // 200 J of 333.3 J
        near(flow.shaft_w, 0.0);
        assert_eq!(
            MACHINE.flow(
                &Before {
                    above_j: -1.0,
                    ..before(20e3)
                },
                0.9
            ),
            Flow::default()
        );
    }
}
