//! A step of the CVT: CV-1 to CV-6, VA-1, LC-4 and the flags, each worked out again from the solved speeds, pressure and slip with
//! the part models by themselves. Truth: the equations of the driveline as a balance, at every bind of the output torque.

use super::{near, same};
use crate::common::bench_step::{Bench, Setting};
use crate::common::{RPM, ZERO, car};
use cvtcycle_model::engine::EngineAtTemperature;
use cvtcycle_model::flags::Flags;
use cvtcycle_model::maps::LossMap;
use cvtcycle_model::math::{Curve, Grid};
use cvtcycle_model::prime_mover::{FULL_LOAD_LIMIT, PrimeMover};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad};
use cvtcycle_model::transmission::cvt::controller::{ClampLaw, ClampSignals};
use cvtcycle_model::transmission::cvt::floors::Floors;
use cvtcycle_model::transmission::cvt::pulley_bearing::PulleyBearing;
use cvtcycle_model::transmission::cvt::variator::{
    BeltAtRatio, BeltLoad, Geometry, belt_state, sliding_speed_m_s,
};
use cvtcycle_model::transmission::cvt::{Cvt, LossChanges, viscosity_power};
use cvtcycle_model::transmission::{StepOutput, Transmission};

/// Limit that fixes the output torque.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bind {
    Demand,
    Least,
    FullLoad,
}

/// Torque of the input shaft at a viscosity and a speed (IS-1).
pub fn shaft_nm(cvt: &Cvt, nu_m2_s: f64, speed_rad_s: f64) -> f64 {
    let shaft = &cvt.shaft_drag;
    shaft.torque_nm(viscosity_power(nu_m2_s, shaft.exponent), speed_rad_s)
}

/// Fluids of a setting.
pub struct Oil {
    pub eta_sump: f64,
    pub eta_belt: f64,
    pub nu_sump: f64,
}

pub fn oil(b: &Bench, s: &Setting) -> Oil {
    let oil = &b.car.oil;
    let (sump, belt) = (s.sump_degc + ZERO, s.belt_degc + ZERO);
    Oil {
        eta_sump: oil.dynamic_pa_s(sump),
        eta_belt: oil.dynamic_pa_s(belt),
        nu_sump: oil.kinematic_m2_s(sump),
    }
}

fn belt_load(b: &Bench, s: &Setting, wp: f64, secondary_nm: f64, clamp_n: f64) -> BeltLoad {
    let (cvt, f) = (b.cvt(), &b.car.oil.friction);
    let eta = oil(b, s).eta_belt;
    // The film is worked out at the speed without slip.
    let sliding = sliding_speed_m_s(
        &cvt.belt,
        s.ratio,
        s.ratio * cvt.final_drive.ratio * s.wheel_rad_s,
    );
    BeltLoad {
        primary_speed_rad_s: wp,
        output_torque_nm: secondary_nm,
        secondary_clamp_n: clamp_n,
        band: f.band(s.belt_degc + ZERO, eta, sliding),
        film_n: film_n(b, s, eta, sliding),
        segment_friction: f.segment,
        capacity_friction: f.capacity,
        flank_friction: f.flank,
    }
}

/// FI-1 from LU-5, FI-2 and FH-1, interface by interface.
fn film_n(b: &Bench, s: &Setting, eta: f64, sliding: [f64; 2]) -> [f64; 2] {
    let (belt, f) = (&b.cvt().belt, &b.car.oil.friction);
    let g = Geometry::new(s.ratio, belt.centre_distance_m, belt.length_m);
    let (radius_m, wrap_rad) = if s.ratio > 1.0 {
        (g.primary_radius_m, g.primary_wrap_rad)
    } else {
        (g.secondary_radius_m, g.secondary_wrap_rad)
    };
    let area_m2 = radius_m * wrap_rad * belt.band_width_m; // BT-7
    sliding.map(|dv| {
        if dv == 0.0 {
            return 0.0;
        }
        let x = eta * dv / f.half_n_m;
        let share = 1.0 / (1.0 + x.powf(-f.film_exponent));
        let cold_n = share * eta * dv * area_m2 / (f.half_thickness_m * x.powf(0.6));
        let halving_w = f.film_heating_w;
        2.0 * cold_n / (1.0 + (1.0 + 4.0 * cold_n * dv / halving_w).sqrt())
    })
}

/// Torque at the engine's side of the clutch (CV-6).
fn engine_side(primary_nm: f64, wp: f64, we: f64) -> f64 {
    if primary_nm < 0.0 {
        primary_nm * wp / we
    } else {
        primary_nm
    }
}

/// Works out every loss, torque and flag of a moving step again. Answers with what bound the output torque.
fn check(b: &Bench, s: &Setting, d: &StepOutput) -> Bind {
    let (cvt, o) = (b.cvt(), oil(b, s));
    let engine = b.car.engine.at(
        s.engine_degc + ZERO,
        s.engine_degc + ZERO,
        &b.car.engine_oil,
        1.0,
    );
    let place = format!("{s:?} {d:?}");
    assert!(
        d.residual <= 1e-7 && !d.flags.contains(Flags::NOT_CONVERGED),
        "{place}"
    );
    let ws = cvt.final_drive.ratio * s.wheel_rad_s;
    let wp = s.ratio * ws / (1.0 - d.slip); // CV-1
    let (we, pa, demand_nm) = (
        d.engine_rad_s,
        d.secondary_pa,
        s.wheel_nm * s.wheel_rad_s / ws,
    );
    let output_nm = d.output_w / ws;
    let clutch_nm = cvt
        .clutch_drag
        .torque_nm(viscosity_power(o.nu_sump, cvt.clutch_drag.exponent), wp);
    // The demand decides the friction of the teeth, whatever is driven of it (GM-2).
    let sump = b.car.oil.state(s.sump_degc + ZERO);
    let geared_nm = cvt
        .final_drive
        .train
        .turning(ws, demand_nm, sump)
        .input_nm(output_nm);
    let at = BeltAtRatio::new(&cvt.belt, s.ratio);
    let clamp_n = cvt.secondary_clamp_n(pa, ws);
    let pull_n = PulleyBearing::pull_per_clamp(&cvt.belt, &at) * clamp_n;
    let bearing = [0, 1].map(|k| cvt.pulley_bearing.torque_nm(k, pull_n));
    let per_pa = cvt.seal_ring.torque_per_pa();
    let secondary_nm = geared_nm + bearing[1] + per_pa * pa;
    let load = belt_load(b, s, wp, secondary_nm, clamp_n);
    let belt = belt_state(&cvt.belt, &at, &load);
    let primary_pa = belt.losses.holding_n / cvt.primary_piston_m2;
    let ring = [primary_pa, pa].map(|p| per_pa * p);
    let lost = |c: Component| d.loss_w[c];
    // The solve stops at 1e-7 of slip, which is as much of the power through the belt (SL-11).
    let slip_w = 1e-7 * d.output_w.abs();
    let watts = |got: f64, want: f64| {
        assert!(
            (got - want).abs() <= 2e-6 * want.abs() + 2e-5 + slip_w,
            "{got} instead of {want}: {place}"
        )
    };
    for (part, nm) in [
        (Component::BeltBand, belt.losses.band_nm),
        (Component::BeltFilm, belt.losses.film_nm),
        (Component::BeltSlip, belt.losses.slip_nm),
        (Component::BeltWedge, belt.losses.wedge_nm),
        (Component::BeltPenetration, belt.losses.penetration_nm),
        (Component::ClutchDrag, clutch_nm),
    ] {
        watts(lost(part), nm * wp);
    }
    watts(lost(Component::FinalDrive), (geared_nm - output_nm) * ws);
    watts(
        lost(Component::PulleyBearing),
        bearing[0] * wp + bearing[1] * ws,
    );
    watts(lost(Component::SealRing), ring[0] * wp + ring[1] * ws);
    let pump = cvt.pump.state(
        &cvt.pump.at(o.eta_sump),
        we,
        pa,
        cvt.pump.steady_need_m3_s(pa, o.eta_sump),
    );
    watts(lost(Component::Pump), pump.torque_nm * we);
    watts(
        lost(Component::InputShaft),
        shaft_nm(cvt, o.nu_sump, we) * we,
    );
    near(d.oil_flow_m3_s, pump.working_m3_s, 1e-6);
    assert!((belt.losses.slip_total - d.slip).abs() < 2e-7, "{place}");
    let primary_nm = belt.input_torque_nm + clutch_nm + bearing[0] + ring[0]; // CV-2
    let spin_nm = pump.torque_nm + shaft_nm(cvt, o.nu_sump, we);
    let tight = |got: f64, want: f64| {
        assert!(
            (got - want).abs() <= 1e-5 * (1.0 + want.abs()),
            "{got} instead of {want}: {place}"
        )
    };
    tight(d.shaft_nm, engine_side(primary_nm, wp, we) + spin_nm);
    watts(
        lost(Component::LaunchClutch),
        primary_nm.max(0.0) * (we - wp),
    ); // LC-4
    assert!(lost(Component::BeltMap) == 0.0 && lost(Component::GearMesh) == 0.0);

    // Binding limit and demanded torque of the engine (CV-3, CV-4).
    let idle = engine.idle_rad_s;
    let together = 1.0 - ((we / wp - 1.0) / 0.02).clamp(0.0, 1.0);
    let dragged = engine.drag_nm(we) + engine.accessories_nm(we) + spin_nm;
    let least = if wp < idle {
        cvt.coupling.creep_nm(wp, idle)
    } else {
        -together * cvt.coupling.overrun_share(wp, idle) * dragged
    };
    let most = engine.full_load_nm(we) - engine.accessories_nm(we) - spin_nm;
    let power = s.wheel_nm * s.wheel_rad_s;
    let bind = if (d.output_w - power).abs() <= 1e-9 * power.abs()
        && primary_nm > least - 1e-4
        && primary_nm < most + 1e-4
    {
        Bind::Demand
    } else if output_nm > demand_nm {
        Bind::Least
    } else {
        Bind::FullLoad
    };
    match bind {
        Bind::Demand => assert!(d.brake_w == 0.0 && d.deficit_w == 0.0, "{place}"),
        Bind::Least => {
            tight(primary_nm, least);
            watts(d.brake_w, d.output_w - power);
            assert!(d.deficit_w == 0.0);
        }
        Bind::FullLoad => {
            tight(primary_nm, most);
            watts(d.deficit_w, power - d.output_w);
            assert!(d.brake_w == 0.0);
        }
    }
    engine_and_clamp(&Solved {
        b,
        s,
        d,
        engine: &engine,
        wp,
        primary_nm,
        secondary_nm,
        load,
        at,
    });
    flags(
        &Solved {
            b,
            s,
            d,
            engine: &engine,
            wp,
            primary_nm,
            secondary_nm,
            load,
            at,
        },
        bind,
        belt.losses.gross_slip,
        belt.losses.capacity_nm,
    );
    bind
}

/// A step and what was worked out of it.
struct Solved<'a> {
    b: &'a Bench,
    s: &'a Setting,
    d: &'a StepOutput,
    engine: &'a EngineAtTemperature<'a>,
    wp: f64,
    primary_nm: f64,
    secondary_nm: f64,
    load: BeltLoad,
    at: BeltAtRatio,
}

/// Largest pressure that the pump keeps up at an engine speed without a shift, Pa (PU-2, PU-6).
fn most_pa(b: &Bench, s: &Setting, we: f64) -> f64 {
    let (pump, eta) = (&b.cvt().pump, oil(b, s).eta_sump);
    let drawn = pump.at(eta).drawn_m3_s(pump.displacement_m3_rad * we);
    let lubrication = pump.lubrication_m3_s * (1.0 / eta).min(1.0);
    let per_leakage = eta / (pump.leakage_m3_s_pa * 0.01);
    ((drawn - lubrication) * per_leakage).max(1e4)
}

/// Engine speed (LC-1, LC-5), throttle and pressure (CV-5), primary pressure (VA-3, TE-1) and clamp safety (VA-2).
fn engine_and_clamp(x: &Solved) {
    let (cvt, d, engine, wp) = (x.b.cvt(), x.d, x.engine, x.wp);
    let (we, idle) = (d.engine_rad_s, engine.idle_rad_s);
    let wanted = cvt
        .coupling
        .engine_rad_s(&CouplingLoad::new(x.primary_nm, wp, idle, x.s.coupled));
    near(we, wanted.max(wp), 1e-5);
    let throttle =
        ((d.shaft_nm + engine.accessories_nm(we)) / engine.full_load_nm(we)).clamp(0.0, 1.0);
    assert!(
        (d.throttle - throttle).abs() < 1e-5,
        "{} {throttle}",
        d.throttle
    );
    let signals = ClampSignals {
        throttle,
        engine_rad_s: we,
        oil_k: x.s.sump_degc + ZERO,
        radius_factor: cvt.radius_factor(&x.at),
        force_log: 0.0,
    };
    let ws = cvt.final_drive.ratio * x.s.wheel_rad_s;
    let set_pa = cvt.pressure_pa(&signals, &x.at, || x.load, ws).0;
    let most_pa = most_pa(x.b, x.s, we);
    near(d.secondary_pa, set_pa.min(most_pa), 1e-5);
    let short = d.flags.contains(Flags::FLOW_LIMITED);
    assert!(short == (set_pa > most_pa) || (set_pa / most_pa - 1.0).abs() < 1e-5);
    let belt = belt_state(&cvt.belt, &x.at, &x.load);
    near(
        d.primary_pa,
        belt.losses.holding_n / cvt.primary_piston_m2,
        1e-5,
    );
    near(
        d.clamp_safety,
        belt.losses.capacity_nm / x.secondary_nm.abs(),
        1e-5,
    );
    same(d.belt_ratio, x.s.ratio);
}

fn flags(x: &Solved, bind: Bind, gross: bool, capacity_nm: f64) {
    let (cvt, d) = (x.b.cvt(), x.d);
    let share = (d.shaft_nm + x.engine.accessories_nm(d.engine_rad_s))
        / x.engine.full_load_nm(d.engine_rad_s);
    let cold = |degc: f64| !(-40.0..=160.0).contains(&degc);
    // The solve stops at 1e-7 of full load: a clutch that carries less carries nothing, in whichever direction.
    let primary_nm = x.primary_nm;
    let carries = primary_nm.abs() > 1e-7 * x.engine.full_load_nm(d.engine_rad_s);
    let settled = |flag: Flags, on: bool| if carries { on } else { d.flags.contains(flag) };
    let want = [
        (Flags::FULL_LOAD, bind == Bind::FullLoad),
        (Flags::GROSS_SLIP, gross),
        (Flags::LOW_CLAMP, capacity_nm < x.secondary_nm.abs()),
        (
            Flags::PRIMARY_PRESSURE_SHORT,
            d.primary_pa > d.secondary_pa + cvt.pump.line_drop_pa,
        ),
        (
            Flags::CLUTCH_SLIPPING,
            settled(
                Flags::CLUTCH_SLIPPING,
                d.engine_rad_s > x.wp * (1.0 + 1e-9) && primary_nm > 0.0,
            ),
        ),
        (
            Flags::CLUTCH_OPEN,
            bind == Bind::Least && x.wp < x.engine.idle_rad_s,
        ),
        (Flags::OVERRUN, settled(Flags::OVERRUN, primary_nm < 0.0)),
        (Flags::NOT_CONVERGED, false),
        (Flags::LAUNCH_NOT_IN_LOW, false),
        (
            Flags::RATIO_LIMIT,
            x.s.ratio <= cvt.ratio.high || x.s.ratio >= cvt.ratio.low,
        ),
        (
            Flags::OVERSPEED,
            d.engine_rad_s > x.engine.engine.highest_rad_s,
        ),
        (
            Flags::OUTSIDE_VALIDITY,
            cold(x.s.sump_degc) || cold(x.s.belt_degc) || share > FULL_LOAD_LIMIT,
        ),
        (Flags::ENGINE_OFF, false),
    ];
    for (flag, want) in want {
        assert_eq!(d.flags.contains(flag), want, "{:?}: {:?} {d:?}", flag, x.s);
    }
}

/// The shipped CVT with a film on its bands, an uncompensated cylinder and heating films, so that no term is zero.
pub fn bench() -> Bench {
    let setup = car(
        "rover_216_cvt",
        &["transmission.cvt.variator.compensated=false"],
    );
    let mut bench = Bench::new(&setup);
    bench.car.oil.friction.film = true;
    bench
}

/// Drive, overrun, launch, creeping on the brake, full load and beyond, cold and warm, in and out of validity.
#[test]
fn val_steps_of_the_cvt_from_their_parts() {
    let b = bench();
    let mut binds = [0; 3];
    for ratio in [0.3, 0.45, 0.9, 1.7, 2.4, 3.0] {
        for wheel_rad_s in [0.4, 3.0, 7.0, 12.0, 30.0, 80.0] {
            for wheel_nm in [-900.0, -150.0, -20.0, 0.0, 20.0, 90.0, 250.0, 700.0, 2500.0] {
                for (sump_degc, belt_degc, engine_degc, coupled) in [
                    (60.0, 75.0, 90.0, true),
                    (-20.0, -18.0, -15.0, false),
                    (60.0, 165.0, 90.0, false),
                    (-41.0, 0.0, 0.0, true),
                ] {
                    let s = Setting {
                        ratio,
                        wheel_rad_s,
                        wheel_nm,
                        sump_degc,
                        belt_degc,
                        engine_degc,
                        coupled,
                    };
                    let d = b.solve(&s);
                    assert_eq!(
                        d.flags.contains(Flags::LOW_CLAMP),
                        d.clamp_safety < 1.0,
                        "{s:?}"
                    );
                    if d.flags.contains(Flags::GROSS_SLIP) && d.residual > 1e-7 {
                        assert!(d.flags.contains(Flags::NOT_CONVERGED));
                        continue; // at its capacity the belt moves no more
                    }
                    binds[check(&b, &s, &d) as usize] += 1;
                }
            }
        }
    }
    assert!(binds.iter().all(|n| *n > 40), "{binds:?}");
}

/// Less pressure than the torque needs is flagged in both directions of power.
#[test]
fn a_weak_clamp_is_flagged() {
    let mut b = bench();
    let Transmission::Cvt(cvt) = &mut b.car.transmission else {
        panic!("a CVT")
    };
    cvt.floors = Floors::of_control(1e3);
    (cvt.cap_pa, cvt.spring_n, cvt.centrifugal_n_s2) = (2e4, 50.0, 0.0);
    let mut low = [0; 2];
    for wheel_nm in [-80.0, -30.0, -10.0, -1.0, 1.0, 10.0, 30.0, 80.0] {
        let d = b.solve(&Setting {
            wheel_nm,
            wheel_rad_s: 60.0,
            ..Setting::default()
        });
        assert_eq!(
            d.flags.contains(Flags::LOW_CLAMP),
            d.clamp_safety < 1.0,
            "{wheel_nm}: {d:?}"
        );
        low[usize::from(wheel_nm > 0.0)] += i32::from(d.flags.contains(Flags::LOW_CLAMP));
    }
    assert!(low.iter().all(|n| *n > 0), "{low:?}");
}

/// Standing in gear: creep torque, pump, shaft and accessories on the engine, and the flags.
#[test]
fn val_standstill_from_its_parts() {
    let mut b = bench();
    standing(&b);
    if let Transmission::Cvt(cvt) = &mut b.car.transmission {
        cvt.clamp = ClampLaw::TorqueFollowing {
            safety: 1.5,
            least_torque_nm: 1.0,
        }; // looks at the creep torque
        cvt.floors = Floors::of_control(1e3);
        cvt.spring_n = 10.0;
    }
    standing(&b);
}

fn standing(b: &Bench) {
    for (degc, cvt_ratio) in [(60.0, 3.0), (-20.0, 2.0), (-45.0, 3.0), (165.0, 1.0)] {
        let s = Setting {
            ratio: cvt_ratio,
            wheel_rad_s: 0.0,
            sump_degc: degc,
            belt_degc: degc,
            engine_degc: degc,
            ..Setting::default()
        };
        let (d, o, cvt) = (b.solve(&s), oil(b, &s), b.cvt());
        let engine = b
            .car
            .engine
            .at(degc + ZERO, degc + ZERO, &b.car.engine_oil, 1.0);
        let idle = engine.idle_rad_s;
        same(d.engine_rad_s, idle);
        let creep = cvt.coupling.creep_nm(0.0, idle);
        let shaft_nm = shaft_nm(cvt, o.nu_sump, idle);
        let pump = cvt.pump.state(
            &cvt.pump.at(o.eta_sump),
            idle,
            d.secondary_pa,
            cvt.pump.steady_need_m3_s(d.secondary_pa, o.eta_sump),
        );
        same(d.shaft_nm, creep + pump.torque_nm + shaft_nm);
        same(d.loss_w[Component::LaunchClutch], creep * idle);
        same(d.loss_w[Component::Pump], pump.torque_nm * idle);
        same(d.loss_w[Component::InputShaft], shaft_nm * idle);
        same(d.oil_flow_m3_s, pump.working_m3_s);
        let share = (d.shaft_nm + engine.accessories_nm(idle)) / engine.full_load_nm(idle);
        assert!(
            (d.throttle - share.clamp(0.0, 1.0)).abs() < 1e-6
                && d.slip == 0.0
                && d.belt_ratio == cvt_ratio
        );
        let at = BeltAtRatio::new(&cvt.belt, cvt_ratio);
        let signals = ClampSignals {
            throttle: d.throttle,
            engine_rad_s: idle,
            oil_k: degc + ZERO,
            radius_factor: cvt.radius_factor(&at),
            force_log: 0.0,
        };
        let load = belt_load(
            b,
            &s,
            0.0,
            creep * cvt_ratio,
            cvt.secondary_clamp_n(d.secondary_pa, 0.0),
        );
        let set_pa = cvt.pressure_pa(&signals, &at, || load, 0.0).0;
        let most_pa = most_pa(b, &s, idle);
        near(d.secondary_pa, set_pa.min(most_pa), 1e-6);
        let belt = belt_state(&cvt.belt, &at, &load);
        near(
            d.primary_pa,
            belt.losses.holding_n / cvt.primary_piston_m2,
            1e-9,
        );
        let capacity = belt.losses.capacity_nm;
        near(d.clamp_safety, capacity / (creep * cvt_ratio), 1e-9);
        for (flag, want) in [
            (Flags::CLUTCH_SLIPPING, true),
            (Flags::FLOW_LIMITED, set_pa > most_pa),
            (Flags::NOT_CONVERGED, false),
            (
                Flags::OUTSIDE_VALIDITY,
                !(-40.0..=160.0).contains(&degc) || share > FULL_LOAD_LIMIT,
            ),
            (Flags::RATIO_LIMIT, cvt_ratio >= 3.0),
            (Flags::OVERSPEED, false),
        ] {
            assert_eq!(d.flags.contains(flag), want, "{flag:?} at {degc}");
        }
        assert!((d.engine_rad_s / RPM) > 500.0 && d.brake_w == 0.0 && d.output_w == 0.0);
    }
}

/// A measured final drive takes its torque at the input; outside a map the row is flagged, moving and standing.
#[test]
fn val_maps_in_a_step() {
    let mut b = bench();
    let rows: Vec<([f64; 5], f64)> = [20.0 + ZERO, 100.0 + ZERO]
        .map(|k| ([1.0, 200.0, 0.0, 1e6, k], 0.7))
        .to_vec();
    let map = LossMap::new(Grid::from_rows(&rows).unwrap());
    if let Transmission::Cvt(cvt) = &mut b.car.transmission {
        let mut changes = LossChanges::default();
        changes.maps[Component::FinalDrive] = Some(map.clone());
        changes.maps[Component::Pump] = Some(map);
        cvt.changes = Some(Box::new(changes));
    }
    for (sump_degc, wheel_rad_s) in [(60.0, 30.0), (110.0, 30.0), (60.0, 0.0), (10.0, 0.0)] {
        let s = Setting {
            sump_degc,
            wheel_rad_s,
            wheel_nm: 90.0,
            ..Setting::default()
        };
        let d = b.solve(&s);
        assert_eq!(
            d.flags.contains(Flags::OUTSIDE_VALIDITY),
            !(20.0..=100.0).contains(&sump_degc),
            "{s:?}"
        );
        let wp = b.cvt().final_drive.ratio * wheel_rad_s / (1.0 - d.slip);
        near(d.loss_w[Component::FinalDrive] + 1.0, 0.7 * wp + 1.0, 1e-9);
        near(d.loss_w[Component::Pump], 0.7 * d.engine_rad_s, 1e-9);
    }
}

/// Where the idling engine cannot turn its own box, by a ten-thousandth and by less than rounding, the row is flagged and not.
#[test]
fn an_engine_too_weak_to_idle_is_flagged() {
    let mut b = bench();
    let s = Setting {
        ratio: 2.0,
        wheel_rad_s: 0.0,
        ..Setting::default()
    };
    b.car.engine.full_load = Curve::constant(0.1);
    let d = b.solve(&s);
    let nm = d.shaft_nm
        + b.car
            .engine
            .at(
                s.engine_degc + ZERO,
                s.engine_degc + ZERO,
                &b.car.engine_oil,
                1.0,
            )
            .accessories_nm(d.engine_rad_s);
    for (share, want) in [(1.0 + 1e-4, true), (1.04, true), (1.0 + 1e-6, false)] {
        b.car.engine.full_load = Curve::constant(nm / share);
        let d = b.solve(&s);
        assert!(d.throttle == 1.0);
        assert_eq!(d.flags.contains(Flags::OUTSIDE_VALIDITY), want, "{share}");
    }
}
