//! Properties of the CVT's other parts, each by itself: pump, shaft, clutch drag, launch clutch.
//!
//! Truth comes from conservation (hydraulic and shaft power), from algebra on the labelled equations and from limits.
#![allow(
    missing_docs,
    clippy::float_cmp,
    reason = "some equalities hold to the last bit"
)]

use crate::common::{at, car, cycle, try_car};
use cvtcycle_model::drive::{Start, drive};
use cvtcycle_model::transmission::coupling::{Coupling, CouplingLoad, FrictionClutch};
use cvtcycle_model::transmission::cvt::clutch_drag::ClutchDrag;
use cvtcycle_model::transmission::cvt::pump::{Pump, PumpAtTemperature, PumpKind};
use cvtcycle_model::transmission::cvt::shaft_drag::ShaftDrag;
use cvtcycle_model::transmission::cvt::{NU_REFERENCE_M2_S, viscosity_power};
use cvtcycle_model::transmission::viscous_self_heating::ViscousSelfHeating;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const RPM: f64 = std::f64::consts::PI / 30.0;

fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(2001),
        ..ProptestConfig::with_cases(cases)
    }
}

/// Size of the largest jump of `f` between neighbours after halving each pair towards its larger difference.
fn largest_jump(from: f64, to: f64, f: &dyn Fn(f64) -> f64) -> f64 {
    let n = 400;
    let x = |i: i32| from + (to - from) * f64::from(i) / f64::from(n);
    let jump = |i: i32| {
        let (mut a, mut b) = ((x(i), f(x(i))), (x(i + 1), f(x(i + 1))));
        for _ in 0..40 {
            let middle = 0.5 * (a.0 + b.0);
            let middle = (middle, f(middle));
            if (middle.1 - a.1).abs() > (b.1 - middle.1).abs() {
                b = middle
            } else {
                a = middle
            }
        }
        (b.1 - a.1).abs()
    };
    (0..n).map(jump).fold(0.0, f64::max)
}

fn pair(from: f64, to: f64) -> impl Strategy<Value = (f64, f64)> {
    (from..to, from..to).prop_map(|(a, b)| if a < b { (a, b) } else { (b, a) })
}

// ---------------------------------------------------------------- pump

fn any_kind() -> impl Strategy<Value = PumpKind> {
    prop_oneof![
        Just(PumpKind::Fixed),
        (0.05..1.0f64).prop_map(|share| PumpKind::DualCavity { share }),
        (0.05..1.0f64).prop_map(|least| PumpKind::Variable { least }),
    ]
}

/// Heating of films from none to strong.
fn any_heating() -> impl Strategy<Value = ViscousSelfHeating> {
    prop_oneof![1 => Just(ViscousSelfHeating::NONE), 3 => (10.0..1e4f64).prop_map(|w| ViscousSelfHeating::halving_at_w(Some(w)))]
}

fn any_pump() -> impl Strategy<Value = Pump> {
    let inlet = prop_oneof![1 => Just(0.0), 3 => 1e6..1e9f64];
    let heat = (any_heating(), inlet);
    (
        any_kind(),
        2e-6..40e-6f64,
        0.0..0.3f64,
        0.0..1e5f64,
        0.0..2.0f64,
        0.0..5e5f64,
        heat,
    )
        .prop_map(|all| {
            let (kind, cc, friction, viscous, t_c, drop, (heating, inlet_pa_s_m3)) = all;
            Pump {
                heating,
                inlet_pa_s_m3,
                inlet_depression_pa: 0.7e5,
                kind,
                displacement_m3_rad: cc / std::f64::consts::TAU,
                friction,
                viscous,
                viscous_exponent: 0.9,
                hydrodynamic_nm_s2: 0.0,
                constant_nm: t_c,
                line_drop_pa: drop,
                residual_pa: 1e5,
                lubrication_m3_s: 5e-5,
                leakage_m3_s_pa: 1.7e-11,
            }
        })
}

/// The pump's oil at a viscous factor; the inlet's drop follows it, as both follow the viscosity.
fn oil(pump: &Pump, factor: f64) -> PumpAtTemperature {
    pump.with_factor(0.01 * factor, factor)
}

/// Speed rad/s, pressure Pa, need m3/s, viscous factor.
fn any_duty() -> impl Strategy<Value = (f64, f64, f64, f64)> {
    (
        prop_oneof![1 => Just(0.0), 9 => 0.0..700.0f64],
        0.0..60e5f64,
        prop_oneof![1 => Just(0.0), 9 => 0.0..1e-3f64],
        0.1..200.0f64,
    )
}

proptest! {
    #![proptest_config(config(3000))]

    /// Second law: the shaft gives at least the hydraulic power of the flow that works, at the pressure it works against, and what
    /// works covers the need unless the flow is said to fall short (PU-1, PU-4).
    #[test]
    fn pump_takes_at_least_hydraulic_power_and_covers_the_need(pump in any_pump(), (w, p, need, factor) in any_duty()) {
        let now = oil(&pump, factor);
        let s = pump.state(&now, w, p, need);
        let drawn = now.drawn_m3_s(s.flow_m3_s);
        prop_assert!(drawn <= s.flow_m3_s && (now.inv_inlet_flow == 0.0 || drawn * now.inv_inlet_flow <= 1.0 + 1e-12));
        prop_assert!(s.torque_nm.is_finite() && s.torque_nm >= 0.0 && s.flow_m3_s >= 0.0);
        let hydraulic = s.working_m3_s * (p + pump.line_drop_pa);
        prop_assert!(s.torque_nm * w >= hydraulic * (1.0 - 1e-12), "{} W for {hydraulic} W", s.torque_nm * w);
        prop_assert!(s.working_m3_s <= s.flow_m3_s * (1.0 + 1e-12));
        prop_assert_eq!(s.flow_limited, need > drawn);
        prop_assert!(s.flow_limited || s.working_m3_s >= need * (1.0 - 1e-12), "{} of {need} m3/s", s.working_m3_s);
    }

    /// Torque rises with pressure, viscosity and need (the last only where displacement follows it); nothing works less than the least
    /// displacement nor more than all of it.
    #[test]
    fn pump_torque_rises_with_each_cause(pump in any_pump(), (w, p, need, factor) in any_duty(), (a, b) in pair(0.0, 1.0)) {
        let torque = |p: f64, need: f64, factor: f64| pump.state(&oil(&pump, factor), w, p, need).torque_nm;
        prop_assert!(b - a < 1e-6 || torque(60e5 * a, need, factor) < torque(60e5 * b, need, factor));
        let drags = pump.viscous > 1.0 && w > 1.0 && b > a + 1e-3;
        prop_assert!(torque(p, need, 200.0 * a) <= torque(p, need, 200.0 * b));
        prop_assert!(!drags || torque(p, need, 200.0 * a) < torque(p, need, 200.0 * b));
        let p = p + pump.residual_pa;
        prop_assert!(torque(p, 1e-3 * a, factor) <= torque(p, 1e-3 * b, factor) * (1.0 + 1e-12));
        let now = oil(&pump, factor);
        let all = Pump { kind: PumpKind::Fixed, ..pump }.state(&now, w, p, need);
        prop_assert!(torque(p, need, factor) <= all.torque_nm * (1.0 + 1e-12));
        prop_assert_eq!(all.working_m3_s, now.drawn_m3_s(all.flow_m3_s));
    }

    /// A pressure that is held without a look at PU-5's roots is within what the flow keeps up (PU-6); without a bound at the inlet the two agree.
    #[test]
    fn pump_holds_what_it_surely_holds(pump in any_pump(), (w, p, _, factor) in any_duty(), flow in 0.0..2e-4f64) {
        let now = oil(&pump, factor);
        let most_pa = pump.deliverable_pa(&now, w, flow);
        let surely = pump.turning(&now, w).surely_holds(p, flow);
        prop_assert!(!surely || p <= most_pa, "{p} Pa of {most_pa}");
        let clearly = p < most_pa * (1.0 - 1e-9) && most_pa > 1e4;
        prop_assert!(surely || !clearly || now.inv_inlet_flow > 0.0);
    }

    /// Twice the displacement at half the speed for the same need: twice the pressure and Coulomb torque at the same flow, while the
    /// viscous torque, which is proportional to speed and displacement, stays (PU-1).
    #[test]
    fn pump_rescales_with_displacement(pump in any_pump(), (w, p, need, factor) in any_duty()) {
        let pump = Pump { constant_nm: 0.0, heating: ViscousSelfHeating::NONE, ..pump };
        let twice = Pump { displacement_m3_rad: 2.0 * pump.displacement_m3_rad, ..pump };
        let now = oil(&pump, factor);
        let viscous = pump.state(&now, w, p, need).torque_nm - pump.state(&PumpAtTemperature { viscous_factor: 0.0, ..now }, w, p, need).torque_nm;
        let (small, large) = (pump.state(&now, w, p, need), twice.state(&now, 0.5 * w, p, need));
        prop_assert!((large.torque_nm - (2.0 * small.torque_nm - viscous)).abs() <= 1e-9 * (small.torque_nm + 1.0));
        prop_assert!((large.working_m3_s - small.working_m3_s).abs() <= 1e-12 * small.flow_m3_s);
    }
}

/// From standstill, through the speed where the flow first covers the need, to where the smaller displacement does.
#[test]
fn pump_is_continuous_in_speed_and_need() {
    for kind in [
        PumpKind::Fixed,
        PumpKind::DualCavity { share: 0.5 },
        PumpKind::Variable { least: 0.2 },
    ] {
        let pump = Pump {
            kind,
            displacement_m3_rad: 9.8e-6 / std::f64::consts::TAU,
            friction: 0.1,
            viscous: 14_750.0,
            viscous_exponent: 0.9,
            heating: ViscousSelfHeating::halving_at_w(Some(600.0)),
            inlet_pa_s_m3: 2e7,
            inlet_depression_pa: 0.7e5,
            hydrodynamic_nm_s2: 0.0,
            constant_nm: 0.0,
            line_drop_pa: 0.0,
            residual_pa: 1e5,
            lubrication_m3_s: 5e-5,
            leakage_m3_s_pa: 1.7e-11,
        };
        for factor in [0.5, 20.0] {
            let now = oil(&pump, factor);
            let jump = largest_jump(0.0, 600.0, &|w| pump.state(&now, w, 20e5, 1e-4).torque_nm);
            assert!(
                jump < 1e-6,
                "{kind:?}: torque jumps by {jump} Nm over speed"
            );
            let jump = largest_jump(0.0, 1e-3, &|need| {
                pump.state(&now, 200.0, 20e5, need).torque_nm
            });
            assert!(jump < 1e-6, "{kind:?}: torque jumps by {jump} Nm over need");
            let jump = largest_jump(0.0, 600.0, &|w| {
                1e6 * pump.state(&now, w, 20e5, 1e-4).working_m3_s
            });
            assert!(jump < 1e-6, "{kind:?}: flow jumps by {jump} cm3/s");
        }
    }
}

// ---------------------------------------------------------------- shaft, reverse clutch

fn any_shaft() -> impl Strategy<Value = ShaftDrag> {
    (0.0..3.0f64, 0.0..1e-3f64, 0.0..1.5f64, any_heating()).prop_map(
        |(constant_nm, viscous_nm_s, exponent, heating)| ShaftDrag {
            constant_nm,
            viscous_nm_s,
            exponent,
            heating,
        },
    )
}

/// Torque of the input shaft at a viscosity and a speed.
fn shaft_nm(shaft: &ShaftDrag, nu: f64, w: f64) -> f64 {
    shaft.torque_nm(viscosity_power(nu, shaft.exponent), w)
}

proptest! {
    #![proptest_config(config(3000))]

    /// Drags are finite, never negative, do not fall with viscosity, and the clutch's never exceeds its cap (IS-1, CD-1).
    #[test]
    fn drags_rise_with_viscosity(
        shaft in any_shaft(),
        (clutch_nm, exponent) in (0.0..1.0f64, 0.0..1.5f64),
        (a, b) in pair(1e-6, 5e-3),
        w in 0.0..1500.0f64,
    ) {
        let clutch = ClutchDrag { drag_nm: clutch_nm, exponent, cap_nm: 0.5, peak_rad_s: None, clearance_m: 0.3e-3, oil_share: 1.0, set_nm: 0.0, set_nm_s: 0.0 };
        let drags = |nu: f64| [shaft_nm(&shaft, nu, w), clutch.torque_nm(viscosity_power(nu, exponent), w)];
        for (x, y) in drags(a).iter().zip(drags(b)) {
            prop_assert!(x.is_finite() && *x >= 0.0 && y >= x * (1.0 - 1e-12), "{x} then {y}");
        }
        prop_assert!(drags(b)[1] <= 0.5);
        // At the reference viscosity and without heating the constants hold as they are, whatever the exponents; heating takes away
        // from the viscous part only.
        let plain_shaft = ShaftDrag { heating: ViscousSelfHeating::NONE, ..shaft };
        prop_assert!((shaft_nm(&plain_shaft, NU_REFERENCE_M2_S, w) - shaft.constant_nm - shaft.viscous_nm_s * w).abs() < 1e-12);
        prop_assert!(shaft_nm(&shaft, b, w) <= shaft_nm(&plain_shaft, b, w));
        prop_assert!(shaft_nm(&shaft, b, w) >= shaft.constant_nm);
    }

    /// CD-2: no drag at rest, the feed's share of the film's largest drag at that share of the peak's speed and less at any other speed; half the drag
    /// of twice the clearance, less drag of less oil (signs of thesis 7.6).
    #[test]
    fn val_the_film_of_the_reverse_clutch_ruptures(
        (drag_nm, power) in (0.05..1.0f64, 0.3..3.0f64),
        (peak, oil_share) in (50.0..800.0f64, 0.05..2.0f64),
        w in 0.0..1500.0f64,
    ) {
        let clutch = ClutchDrag { drag_nm, exponent: 0.5, cap_nm: 20.0, peak_rad_s: Some(peak), clearance_m: 0.3e-3, oil_share, set_nm: 0.0, set_nm_s: 0.0 };
        let largest = clutch.torque_nm(power, oil_share * peak);
        prop_assert_eq!(clutch.torque_nm(power, 0.0), 0.0);
        prop_assert!((largest - oil_share * drag_nm * power).abs() <= 1e-12 * largest);
        let here = clutch.torque_nm(power, w);
        prop_assert!(here <= largest * (1.0 + 1e-12));
        let wide = ClutchDrag { clearance_m: 0.6e-3, ..clutch };
        prop_assert!((2.0 * wide.torque_nm(power, w) - here).abs() <= 1e-12 * here);
        let dry = ClutchDrag { oil_share: 0.9 * oil_share, ..clutch };
        prop_assert!(dry.torque_nm(power, w) <= here && (w < 1.0 || dry.torque_nm(power, w) < here));
    }

    /// The shaft's drag does not fall with speed (thesis 5.5.5).
    #[test]
    fn val_drags_against_speed(shaft in any_shaft(), (a, b) in pair(0.0, 1500.0), nu in 1e-6..5e-3f64) {
        prop_assert!(shaft_nm(&shaft, nu, a) <= shaft_nm(&shaft, nu, b));
    }
}

// ---------------------------------------------------------------- launch clutch

fn any_clutch() -> impl Strategy<Value = FrictionClutch> {
    (
        500.0..2500.0f64,
        1e-6..1e-3f64,
        0.0..20.0f64,
        0.0..2000.0f64,
    )
        .prop_map(|(engage, gain, creep_nm, release)| FrictionClutch {
            engage_rad_s: engage * RPM,
            gain_nm_s2: gain / RPM / RPM,
            creep_nm,
            release_rad_s: release * RPM,
        })
}

proptest! {
    #![proptest_config(config(3000))]

    /// Energy: the engine never turns slower than the input while it drives, so that slip heat T (w_e - w_in) is never negative, nor
    /// below idle unless locked; locked it turns with the input to the last bit (LC-1, LC-4, LC-5).
    #[test]
    fn engine_never_turns_slower_than_what_it_drives(
        c in any_clutch(), torque in -200.0..300.0f64, input in prop_oneof![1 => Just(0.0), 9 => 0.0..600.0f64],
        idle in 50.0..160.0f64, coupled in any::<bool>()
    ) {
        let engine = c.engine_rad_s(&CouplingLoad::new(torque, input, idle, coupled));
        prop_assert!(engine.is_finite() && engine >= input && engine >= idle * (1.0 - 1e-12), "{engine} over {input}, idle {idle}");
        prop_assert!(!(coupled && (input >= c.locked_from_rad_s(idle))) || engine == input);
        let share = c.overrun_share(input, idle);
        let creep = c.creep_nm(input, idle);
        prop_assert!((0.0..=1.0).contains(&share) && (0.0..=c.creep_nm).contains(&creep));
        prop_assert!(share == 0.0 || creep == 0.0, "creeps and brakes at once");
    }

    /// More torque takes no less engine speed; more input speed no more creep and no less of the overrun.
    #[test]
    fn launch_is_monotone(c in any_clutch(), (a, b) in pair(0.0, 1.0), input in 0.0..600.0f64, idle in 50.0..160.0f64, coupled in any::<bool>()) {
        let engine = |torque: f64| c.engine_rad_s(&CouplingLoad::new(torque, input, idle, coupled));
        prop_assert!(engine(300.0 * a) <= engine(300.0 * b));
        prop_assert!(c.creep_nm(300.0 * a, idle) >= c.creep_nm(300.0 * b, idle));
        prop_assert!(c.overrun_share(300.0 * a, idle) <= c.overrun_share(300.0 * b, idle));
    }

}

proptest! {
    #![proptest_config(config(150))]

    /// Engine speed has no jump over torque (creep, engagement) nor over input speed (lock-up; the clutch that once coupled slips again).
    #[test]
    fn launch_is_continuous(c in any_clutch(), torque in 0.0..300.0f64, input in 0.0..600.0f64, idle in 50.0..160.0f64, coupled in any::<bool>()) {
        let by_torque = largest_jump(-50.0, 300.0, &|t| c.engine_rad_s(&CouplingLoad::new(t, input, idle, coupled)));
        let by_speed = largest_jump(0.0, 600.0, &|w| c.engine_rad_s(&CouplingLoad::new(torque, w, idle, coupled)));
        let share = largest_jump(0.0, 600.0, &|w| c.overrun_share(w, idle) + c.creep_nm(w, idle));
        prop_assert!(by_torque < 1e-6 && by_speed < 1e-6 && share < 1e-6, "{by_torque} {by_speed} {share}");
    }
}

// ---------------------------------------------------------------- end stop of the primary, from the input file on

fn stop(from: f64, to: f64) -> [String; 2] {
    [
        format!("transmission.cvt.variator.stop_from_ratio={from}"),
        format!("transmission.cvt.variator.stop_to_ratio={to}"),
    ]
}

/// A stop that is met before it begins is said to be wrong, and not read the other way round.
#[test]
fn an_end_stop_the_wrong_way_round_is_a_problem() {
    let said = try_car("rover_216_cvt", &stop(2.4, 2.3))
        .err()
        .unwrap_or_default();
    assert!(
        said.contains("stop_to_ratio") && said.contains("1 problem"),
        "{said}"
    );
}

/// A stop without a ramp, at the very ratio at which the car pulls away, still drives, and moves fuel by less than 0.5 %.
#[test]
fn an_end_stop_without_a_ramp_drives() {
    let fuel = |sets: &[String]| {
        let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
        drive(
            &car("rover_216_cvt", &sets),
            &cycle("ece15_eudc"),
            &at(20.0, Start::Soak),
        )
        .totals
        .total()
        .fuel_kg
    };
    let (ramp, step) = (fuel(&[]), fuel(&stop(2.4169, 2.4169)));
    assert!(
        (step / ramp - 1.0).abs() < 5e-3,
        "{ramp} kg with the ramp, {step} kg without"
    );
}
