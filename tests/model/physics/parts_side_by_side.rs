//! The parts of a CVT, its clutch and its ratio control with several runs side by side: each lane has the bits of its run alone.
//!
//! Truth: the f64 instance of the same text, on cars whose every number is drawn anew.

use crate::side_by_side::{Draw, assert_alone, numbers, together, with_lanes};
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::lubricant::Lubricant;
use cvtcycle_model::math::{Mask, Real};
use cvtcycle_model::transmission::Transmission;
use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad, Launch, Reach, Turning};
use cvtcycle_model::transmission::cvt::Cvt;
use cvtcycle_model::transmission::cvt::controller::{Moment, RatioControl, RatioDemand};
use cvtcycle_model::transmission::cvt::pump::{Pump, PumpKind};

const MOST: usize = 8;

/// Temperature, speeds, torque, pressure and flow of a point.
type Point<R> = [R; 8];

/// A car's CVT and oil with other numbers, and where they are looked at.
struct Drawn {
    cvts: Vec<Cvt>,
    oils: Vec<Lubricant>,
    points: Vec<Point<f64>>,
}

fn plain(vehicle: &str) -> (Cvt, Lubricant) {
    let car = load(vehicle, &Options::default()).unwrap().car(298.15);
    match car.transmission {
        Transmission::Cvt(cvt) => (*cvt, car.oil),
        Transmission::Manual(_) => panic!("not a CVT"),
    }
}

impl Drawn {
    fn new((cvt, oil): &(Cvt, Lubricant), kind: PumpKind, draw: &mut Draw) -> Self {
        let mut near = |x: f64| x * draw.between(0.8, 1.25);
        let another = |_| {
            let mut own = cvt.clone();
            own.pump = Pump {
                kind,
                displacement_m3_rad: near(own.pump.displacement_m3_rad),
                viscous: near(own.pump.viscous),
                leakage_m3_s_pa: near(own.pump.leakage_m3_s_pa),
                inlet_pa_s_m3: near(1e7),
                ..own.pump
            };
            own.shaft_drag.viscous_nm_s = near(own.shaft_drag.viscous_nm_s);
            own.clutch_drag.drag_nm = near(own.clutch_drag.drag_nm);
            own.clutch_drag.peak_rad_s = Some(near(300.0));
            own.ratio.hysteresis = near(own.ratio.hysteresis);
            own.ratio.gentle_rad_s = near(own.ratio.gentle_rad_s);
            own.ratio.cold.rise_rad_s = near(40.0);
            own.ratio.up_per_s = near(own.ratio.up_per_s);
            if let Launch::Clutch(clutch) = &mut own.coupling {
                clutch.clutch.creep_nm = near(clutch.clutch.creep_nm);
                clutch.clutch.gain_nm_s2 = near(clutch.clutch.gain_nm_s2);
            }
            own
        };
        let cvts = (0..MOST).map(another).collect();
        let point = |_| {
            [
                draw.between(233.0, 433.0),
                draw.between(-20.0, 500.0),
                draw.between(0.0, 500.0),
                draw.between(-100.0, 250.0),
                draw.between(1e5, 5e6),
                draw.between(0.0, 1e-4),
                draw.between(0.45, 2.4),
                draw.between(-20e3, 60e3),
            ]
        };
        let points = (0..MOST).map(point).collect();
        Drawn {
            cvts,
            oils: vec![oil.clone(); MOST],
            points,
        }
    }

    fn alone(&self, lane: usize) -> Vec<String> {
        numbers(&parts(
            &self.cvts[lane],
            &self.oils[lane],
            self.points[lane],
        ))
    }
}

fn hold<R: Real>(like: R, of: &Drawn) {
    let side_by_side = parts(
        &together(like, &of.cvts),
        &together(like, &of.oils),
        together(like, &of.points),
    );
    assert_alone(R::LANES, &side_by_side, |lane| of.alone(lane), &of.points);
}

/// Where the ratio control is at a point.
fn demand<R: Real>(c: &RatioControl<R>, p: Point<R>) -> RatioDemand<R> {
    let [sump_k, speed, w, _, _, _, ratio, power_w] = p;
    let flow = 1.0 + ratio;
    let half = |x: R| 0.5 * x;
    RatioDemand {
        begins: Some(Moment {
            secondary_rad_s: half(speed),
            speed_m_s: 10.0,
            power_w: half(power_w),
            share: half(power_w) / 60e3,
            full_load_rad_s: 0.7 * w,
            mapped_rad_s: None,
        }),
        locks_at: 0.4 * ratio,
        secondary_rad_s: speed,
        primary_rad_s: ratio * speed,
        speed_m_s: 12.0,
        power_w,
        share: power_w / 60e3,
        full_load_rad_s: 0.8 * w,
        mapped_rad_s: None,
        cold_rad_s: c.cold.at(sump_k, sump_k),
        ratio_before: ratio,
        flow_down_per_s: flow,
        flow_up_per_s: 0.2 * flow,
        coupled: w.gt(100.0),
        last_direction: R::per_lane(|lane| if power_w.lane(lane) > 20e3 { 1 } else { -1 }),
        free_up_to_rad_s: ratio.splat(100.0),
        dt_s: 1.0,
    }
}

/// Results of the parts at a point, by one text.
fn parts<R: Real>(cvt: &Cvt<R>, oil: &Lubricant<R>, p: Point<R>) -> (Vec<R>, Vec<R::Mask>) {
    let [sump_k, speed, w, nm, pa, flow, _, _] = p;
    let state = oil.state(sump_k);
    let train = cvt.final_drive.train.turning(speed, nm, state);
    let losses = train.losses(nm);
    let now = cvt.pump.at(oil.dynamic_pa_s(sump_k));
    let pump = cvt.pump.state(&now, w + 1.0, pa, flow);
    let coupling = &cvt.coupling;
    let idle = w.splat(90.0);
    let locked = w.gt(300.0);
    let load = CouplingLoad::new(nm, speed.max(1.0), idle, locked);
    let reach = Reach {
        from_rad_s: w,
        slowest_rad_s: w - 30.0,
        fastest_rad_s: w + 40.0,
    };
    let side = coupling.solve(&load, &reach);
    let turning = Turning {
        output_rad_s: load.output_rad_s,
        engine_rad_s: side.engine_rad_s,
        idle_rad_s: idle,
        locked,
    };
    let way = cvt.ratio.step(&demand(&cvt.ratio, p));
    let (ratio, change, short) = (way.mean, way.change, way.held);
    let numbers = vec![
        state.kinematic_m2_s,
        oil.heat_capacity_j_kgk(sump_k),
        train.no_load_nm(),
        train.share(),
        train.input_nm(nm),
        train.output_nm(nm),
        losses.mesh,
        losses.bearing,
        pump.torque_nm,
        pump.working_m3_s,
        cvt.pump.deliverable_pa(&now, w + 1.0, flow),
        cvt.shaft_drag.torque_nm(now.viscous_factor, w),
        cvt.clutch_drag.torque_nm(now.viscous_factor, w),
        cvt.seal_ring.torque_per_pa(),
        cvt.floors.force_log(change, w),
        side.engine_nm,
        side.engine_rad_s,
        side.loss_w,
        coupling.min_output_nm(&turning, nm),
        coupling.output_nm(nm, load.output_rad_s, side.engine_rad_s),
        ratio,
        change,
    ];
    (
        numbers,
        vec![
            pump.flow_limited,
            short,
            short & short.select(short, locked),
        ],
    )
}

/// Draws and compares; without optimization the inlined equations of eight lanes need more stack than a test has.
fn compare_parts() {
    let kinds = [
        PumpKind::Fixed,
        PumpKind::DualCavity { share: 0.5 },
        PumpKind::Variable { least: 0.25 },
    ];
    let mut draw = Draw(7);
    for vehicle in ["rover_216_cvt", "civic_20_cvt"] {
        let plain = plain(vehicle);
        for kind in kinds {
            for _ in 0..150 {
                let drawn = Drawn::new(&plain, kind, &mut draw);
                with_lanes!(like => hold(like, &drawn));
            }
        }
    }
}

#[test]
fn parts_of_a_cvt_have_the_bits_of_their_run_alone() {
    let large = std::thread::Builder::new().stack_size(64 << 20);
    large.spawn(compare_parts).unwrap().join().unwrap();
}
