//! One step of a driveline with given speeds, torques and temperatures, as on a test bench with fixed ratio.

use cvtcycle_config::cycle::GearCommand;
use cvtcycle_config::setup::Setup;
use cvtcycle_model::drive::Car;
use cvtcycle_model::road::WheelDemand;
use cvtcycle_model::thermal::{BELT, COOLANT, ENGINE_OIL, Heat, METAL, SUMP};
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::CvtState;
use cvtcycle_model::transmission::cvt::variator::BeltAtRatio;
use cvtcycle_model::transmission::{StepInput, StepOutput, Transmission, TransmissionState};

use super::ZERO;

/// Conditions of the bench.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Belt ratio, held constant, or gear of a manual box.
    pub ratio: f64,
    /// Wheel speed, rad/s.
    pub wheel_rad_s: f64,
    /// Torque at the wheels, Nm.
    pub wheel_nm: f64,
    /// Transmission oil, degC.
    pub sump_degc: f64,
    /// Belt and spray, degC.
    pub belt_degc: f64,
    /// Coolant and engine oil, degC.
    pub engine_degc: f64,
    /// True if the launch device is locked.
    pub coupled: bool,
}

impl Default for Setting {
    fn default() -> Self {
        Setting {
            ratio: 1.0,
            wheel_rad_s: 30.0,
            wheel_nm: 0.0,
            sump_degc: 60.0,
            belt_degc: 70.0,
            engine_degc: 90.0,
            coupled: true,
        }
    }
}

/// Car on the bench: the ratio stays fixed, and the engine reaches any speed at once.
pub struct Bench {
    pub car: Car,
}

impl Bench {
    /// Mounts a car on the bench.
    pub fn new(setup: &Setup) -> Self {
        let mut car = setup.car(293.15);
        if let Transmission::Cvt(cvt) = &mut car.transmission {
            (cvt.ratio.low, cvt.ratio.high) = (3.0, 0.3);
            (cvt.ratio.up_per_s, cvt.ratio.down_per_s) = (0.0, 0.0);
        }
        Bench { car }
    }

    /// The CVT.
    pub fn cvt(&self) -> &Cvt {
        match &self.car.transmission {
            Transmission::Cvt(cvt) => cvt,
            Transmission::Manual(_) => panic!("not a CVT"),
        }
    }

    /// Primary speed over wheel speed without slip; for a manual box, input speed over wheel speed.
    pub fn overall(&self, ratio: f64) -> f64 {
        match &self.car.transmission {
            Transmission::Cvt(cvt) => cvt.final_drive.ratio * ratio,
            Transmission::Manual(manual) => manual.overall[ratio as usize - 1],
        }
    }

    /// Solves one step without history.
    pub fn solve(&self, s: &Setting) -> StepOutput {
        let mut node_k = [0.0; 5];
        node_k[COOLANT] = s.engine_degc + ZERO;
        node_k[ENGINE_OIL] = s.engine_degc + ZERO;
        node_k[SUMP] = s.sump_degc + ZERO;
        node_k[METAL] = s.sump_degc + ZERO;
        node_k[BELT] = s.belt_degc + ZERO;
        self.solve_at(s, &Heat { node_k })
    }

    /// Solves one step at given temperatures of the nodes.
    pub fn solve_at(&self, s: &Setting, heat: &Heat) -> StepOutput {
        let car = &self.car;
        let engine = car.engine.at(
            heat.node_k[COOLANT],
            heat.node_k[ENGINE_OIL],
            &car.engine_oil,
            1.0,
        );
        let wheel = WheelDemand {
            speed_m_s: s.wheel_rad_s * car.road_load.wheel_radius_m,
            wheel_rad_s: s.wheel_rad_s,
            power_w: s.wheel_nm * s.wheel_rad_s,
            ..WheelDemand::default()
        };
        let cvt = car.transmission.is_cvt();
        let around = StepInput {
            wheel: &wheel,
            engine: &engine,
            oil: &car.oil,
            heat,
            gear: (!cvt).then_some(GearCommand::InGear(s.ratio as u8)),
            dt_s: 100.0, // long enough for any change of engine speed
            engine_off: false,
            neutral_share: 0.0,
            kinetic_j: 0.5 * car.engine.inertia_kg_m2 * engine.idle_rad_s * engine.idle_rad_s,
        };
        let mut state: TransmissionState = car.transmission.start(&around);
        if let Transmission::Cvt(cvt) = &car.transmission {
            state.cvt = Some(CvtState::new(BeltAtRatio::new(&cvt.belt, s.ratio)));
        } else {
            state.driveline.gear = s.ratio as u8;
        }
        state.driveline.engine_rad_s = engine.idle_rad_s;
        state.driveline.throttle = 0.1;
        state.driveline.secondary_pa = 10e5;
        state.driveline.coupled = s.coupled;
        state.driveline.stood = false;
        car.transmission.solve(&around, &mut state)
    }
}
