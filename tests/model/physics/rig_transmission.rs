//! The transmission rig of thesis chapters 4 and 5: what it must give by construction, what the thesis prints (`val_`), the command.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests say what they found"
)]

use crate::common::bench_step::{self, Setting};
use crate::common::{RPM, ZERO, car, larger};
use cvtcycle_config::Override;
use cvtcycle_config::setup::{Options, load};
use cvtcycle_model::flags::Flags;
use cvtcycle_model::rig::transmission::{
    Branch, Conditions, Loop, MAX_DURATION_S, Moment, Piece, Plan, Stage, StripDown, loaded,
    on_the_rig, second_box, steady, strip_down, transient,
};
use cvtcycle_model::rig::{Bench, BenchPoint};
use cvtcycle_model::thermal::{Heat, HeatInput, METAL, SUMP};
use cvtcycle_model::transmission::component::Component;
use cvtcycle_model::transmission::cvt::variator::Formulation;

const CAR: &str = "rover_216_cvt";

fn rig(sets: &[&str]) -> Conditions {
    Override::parse_all(sets)
        .and_then(|set| cvtcycle_config::rig::load(&set))
        .unwrap_or_else(|p| panic!("{p:#?}"))
        .0
}

fn stripped(vehicle: &[&str], of_rig: &[&str]) -> Vec<StripDown> {
    let c = rig(of_rig);
    strip_down(
        &Bench::new(&car(CAR, vehicle)),
        &c,
        &Plan::from_conditions(&c),
    )
}

fn place(s: &StripDown) -> String {
    format!(
        "I {} {:.0} rpm {:.0} degC",
        s.set.ratio,
        s.set.input_rad_s / RPM,
        s.set.sump_k - ZERO
    )
}

// ---- Strip-down

/// The shipped box without seal rings, whose torque goes with the primary's pressure and not as D p.
const NO_RINGS: &str = "transmission.cvt.seal_ring.friction=0";

/// The differences, corrected for pressure, give every component back within 0.1 Nm plus the interaction, at every point of the rig; with rings
/// too.
#[test]
fn the_strip_down_gives_the_parts_back() {
    for s in stripped(&[], &[]) {
        for piece in Piece::ALL {
            let found = s.piece(piece);
            let rest = found.remainder_nm();
            assert!(rest.abs() <= 0.1, "{} {piece:?}: {found:?}", place(&s));
        }
    }
    let rows = stripped(&[NO_RINGS], &[]);
    assert_eq!(rows.len(), 4 * (13 + 10));
    let (mut most, mut interaction) = (0.0, 0.0);
    for s in &rows {
        for piece in Piece::ALL {
            let found = s.piece(piece);
            most = larger(found.remainder_nm().abs(), most);
            interaction = larger(found.interaction_nm().abs(), interaction);
            assert!(
                found.remainder_nm().abs() <= 0.1,
                "{} {piece:?}: {found:?}",
                place(s)
            );
        }
        // The parts add up to the complete box, whatever the pressures were.
        let sum: f64 = Piece::ALL.iter().map(|p| s.piece(*p).corrected_nm).sum();
        let complete = s.stage(Stage::Complete).total_nm();
        assert!(
            (sum - complete).abs() < 1e-9,
            "{}: {sum} and {complete}",
            place(s)
        );
    }
    println!("largest remainder {most:.1e}, largest interaction {interaction:.2} Nm");
    // A fixed pump without friction and a box without rings leave nothing, and the interaction is not forgotten: belt loss does depend on pressure.
    assert!(most < 1e-9 && interaction > 0.1 && interaction < 1.0);
}

/// Displacement of the shipped pump, as its file has it.
fn displacement_cc_rev() -> f64 {
    let setup = car(CAR, &[]);
    setup
        .keys
        .iter()
        .find(|key| key.key == "transmission.cvt.pump.displacement_cc_rev")
        .unwrap()
        .value
        .parse()
        .unwrap()
}

/// Hand calculation: without correction a difference is off by D dP, here D / 2 pi times 5 % of the pressure.
#[test]
fn val_the_correction_is_displacement_times_pressure_difference() {
    for s in stripped(&[NO_RINGS], &["rig.pressure.final_drive_removed=0.95"]) {
        let bar = s.stage(Stage::Complete).secondary_pa / 1e5;
        let by_hand = displacement_cc_rev() * 1e-6 / std::f64::consts::TAU * 0.05 * bar * 1e5;
        let found = s.piece(Piece::FinalDrive);
        assert!(
            (found.uncorrected_nm - found.corrected_nm - by_hand).abs() < 1e-9,
            "{}: {found:?}, {by_hand} Nm",
            place(&s)
        );
        assert!(by_hand > 0.06, "{by_hand}");
    }
}

/// Hand calculation: pump friction C_f goes with the pressure too, but the correction D dP leaves it out: D C_f dP remains.
#[test]
fn val_the_remainder_is_what_the_pump_does_not_owe_to_displacement() {
    let friction = 0.3;
    let pump = format!("transmission.cvt.pump.friction_coefficient={friction}");
    for s in stripped(&[&pump, NO_RINGS], &[]) {
        let (before, after) = (
            s.stage(Stage::Complete).secondary_pa,
            s.stage(Stage::FinalDriveRemoved).secondary_pa,
        );
        let by_hand =
            displacement_cc_rev() * 1e-6 / std::f64::consts::TAU * friction * (before - after);
        let found = s.piece(Piece::FinalDrive).remainder_nm();
        assert!(
            (found - by_hand).abs() < 1e-9 && by_hand > 0.015,
            "{}: {found}, by hand {by_hand}",
            place(&s)
        );
    }
}

/// Hand calculation: the primary's rings follow its own pressure, F_p/A_p, which the correction D dP leaves out.
#[test]
fn val_the_remainder_is_the_primary_rings() {
    let bench = Bench::new(&car(CAR, &[]));
    let cvt = bench.cvt().unwrap();
    for s in stripped(&[], &[]) {
        let primary_n = |stage| s.stage(stage).belt.unwrap().losses.holding_n;
        let less_n = primary_n(Stage::Complete) - primary_n(Stage::FinalDriveRemoved);
        let primary_pa = less_n / cvt.primary_piston_m2;
        let by_hand = cvt.seal_ring.torque_per_pa() * primary_pa;
        let found = s.piece(Piece::FinalDrive).remainder_nm();
        assert!(
            (found - by_hand).abs() < 1e-9 && by_hand > 1e-3,
            "{}: {found}, by hand {by_hand}",
            place(&s)
        );
    }
}

/// With equal pressures no correction is due and only the final drive's torque acts on the belt; heavier pressure differences act more.
#[test]
fn the_interaction_follows_the_pressures() {
    let all = |factor: f64| {
        ["final_drive_removed", "belt_removed", "clutch_removed"]
            .map(|test| format!("rig.pressure.{test}={factor}"))
    };
    let of = |factor: f64| {
        let sets = all(factor);
        stripped(&[], &sets.iter().map(String::as_str).collect::<Vec<_>>())
    };
    for (equal, (less, least)) in of(1.0).iter().zip(of(0.95).iter().zip(of(0.9).iter())) {
        for piece in Piece::ALL {
            let found = equal.piece(piece);
            assert!(
                (found.uncorrected_nm - found.corrected_nm).abs() < 1e-6,
                "{} {piece:?}",
                place(equal)
            );
            assert!(
                found.by_pressure_nm.abs() < 1e-6,
                "{} {piece:?}: {found:?}",
                place(equal)
            );
        }
        let by_pressure = |s: &StripDown| s.piece(Piece::FinalDrive).by_pressure_nm;
        assert!(
            by_pressure(least) > by_pressure(less) && by_pressure(less) > 0.05,
            "{}",
            place(equal)
        );
        let torque = less.piece(Piece::FinalDrive).by_torque_nm;
        assert!(
            torque.abs() < 0.3 && torque.abs() > 1e-4,
            "{}: {torque}",
            place(less)
        );
        assert!((torque + less.piece(Piece::Belt).by_torque_nm).abs() < 1e-12);
    }
}

/// 5.5.1: the final drive in low is below 1 Nm at the input and larger at 25 degC than warm; 5.5.3: the clutch at most 0.7 Nm. Here as
/// the strip-down finds them, with the interaction in them, in the middle of the speeds.
#[test]
fn val_parts_as_the_strip_down_finds_them() {
    let mut outside = Vec::new();
    for s in stripped(&[], &[])
        .iter()
        .filter(|s| (s.set.input_rad_s / RPM - 2500.0).abs() < 1.0)
    {
        let (drive, clutch) = (
            s.piece(Piece::FinalDrive).corrected_nm,
            s.piece(Piece::Clutch).corrected_nm,
        );
        let belt = s.piece(Piece::Belt).corrected_nm;
        println!(
            "{}: final drive {drive:.2}, clutch {clutch:.2}, belt {belt:.2} Nm",
            place(s)
        );
        assert!(clutch > 0.1 && clutch <= 0.7);
        let low = s.set.ratio > 1.0;
        let (most, band) = if low {
            (1.0 + 0.15, 3.0..=5.0)
        } else {
            (3.0, 3.5..=8.5)
        };
        assert!(drive > 0.25 && drive < most, "{}", place(s));
        if !band.contains(&belt) {
            outside.push(place(s));
        }
        assert!(belt < 5.2 || !low, "{}", place(s));
    }
    // Known: 5.17 Nm, by 0.17 Nm, since the law of bearings leaves less for the final drive in low (GT-1).
    assert_eq!(outside, ["I 2.417 2500 rpm 95 degC"]);
}

// ---- Transients

fn loops(vehicle: &[&str], of_rig: &[&str]) -> [Loop; 2] {
    let c = rig(of_rig);
    let bench = Bench::new(&car(CAR, vehicle));
    [c.low_ratio, c.high_ratio].map(|ratio| transient(&bench, &c, ratio))
}

/// Heat in = stored + given to the air + given to the cooler, over a whole loop; each of them counts.
#[test]
fn heat_of_a_transient_balances() {
    for l in loops(&[], &[]) {
        let e = l.energy;
        println!("I {}: {e:.0?} J, error {:.1e}", l.ratio, e.error());
        assert!(l.complete && e.error().abs() < 1e-12, "{e:?}");
        assert!(
            e.to_air_j > 0.02 * e.shaft_j && e.to_cooler_j > 0.3 * e.shaft_j && e.stored_j > 0.0,
            "{e:?}"
        );
        for wrong in [2.0, 0.0] {
            let mut doubled = e;
            doubled.to_air_j *= wrong;
            assert!(doubled.error().abs() > 0.01, "{doubled:?}");
        }
    }
}

/// 5.3.2, Figs 5-5 and 5-6, within 0.6 Nm (the transducer's 0.5 Nm and the reading): warming in low 12.5 at the start, 11 at 80 and 11.25 Nm at
/// 100 degC; in high "as low as 9.25 Nm", so at its least, and about 11 Nm at the start: within the 1 Nm of two boxes (5.3.4) only, since up to 3 Nm of final
/// drive and 13 Nm in all, printed for 25 degC (5.3.1, 5.5.1), ask for more (docs/results.md); the cooling branch above the warming one. Printed, not asserted: the
/// branches meet near 40 degC, and the small rise from 80 to 100 degC in low.
#[test]
fn val_transients() {
    let [low, high] = loops(&[], &[]);
    let start = |l: &Loop| l.moments[0].answer.total_nm();
    let warm = |l: &Loop, degc: f64| l.loss_nm(Branch::Warming, degc + ZERO).unwrap();
    let least = |l: &Loop| {
        let warming = l.moments.iter().filter(|m| m.branch == Branch::Warming);
        warming
            .map(|m| m.answer.total_nm())
            .fold(f64::INFINITY, f64::min)
    };
    let rows = [
        ("low at the start", start(&low), 12.5, 0.6),
        ("low at 80 degC", warm(&low, 80.0), 11.0, 0.6),
        ("low at 100 degC", warm(&low, 100.0), 11.25, 0.6),
        ("high at the start", start(&high), 11.0, 1.0),
        ("high at its least", least(&high), 9.25, 0.6),
    ];
    for (what, found, printed, _) in rows {
        println!("{what}: {found:.2} Nm, printed {printed}");
    }
    for l in [&low, &high] {
        println!(
            "I {}: widest {:.2?}, meeting {:.1?} K",
            l.ratio,
            l.widest(),
            l.meeting_k(0.1)
        );
        let gaps: Vec<f64> = (5..20)
            .map(|k| l.gap_nm(5.0 * f64::from(k) + ZERO).unwrap())
            .collect();
        assert!(gaps.iter().all(|gap| *gap > 0.0), "{gaps:?}");
        assert!(gaps.iter().any(|gap| *gap > 0.1), "{gaps:?}");
    }
    let outside = rows
        .iter()
        .filter(|(_, found, printed, width)| (found - printed).abs() > *width);
    // Known: by 0.02 Nm, since one law of bearings gives the final drive more in high when warm (GT-1).
    let names: Vec<&str> = outside.map(|row| row.0).collect();
    assert_eq!(names, ["high at its least"], "{rows:?}");
    assert!(
        rows.iter()
            .all(|(_, found, printed, _)| (found - printed).abs() < 0.65)
    );
}

/// 5.5.2: steady, the spray is about 20 K above the bulk oil; in a warm-up the belt lags behind that, in cooling it stays above it.
#[test]
fn the_belt_lags_behind_the_oil() {
    let setup = car(CAR, &[]);
    let bench = Bench::new(&setup);
    for l in loops(&[], &[]) {
        let sump_k = 60.0 + ZERO;
        let held = bench
            .solve(&BenchPoint {
                ratio: l.ratio,
                sump_k,
                ..BenchPoint::default()
            })
            .belt_k;
        let belt = |branch| l.at(branch, sump_k, |m| m.answer.belt_k).unwrap();
        let (warming, cooling) = (belt(Branch::Warming), belt(Branch::Cooling));
        println!(
            "I {}: belt over 60 degC: warming {:.1}, held {:.1}, cooling {:.1} K",
            l.ratio,
            warming - sump_k,
            held - sump_k,
            cooling - sump_k
        );
        assert!(warming < held && held < cooling);
    }
}

/// No engine, no cooler of the car, no wind: from its nodes nothing reaches the box, and the box at room temperature stays there.
#[test]
fn on_the_rig_no_engine_heats_the_box() {
    let network = on_the_rig(
        &Bench::new(&car(CAR, &["thermal.transmission.exchanger_w_k=200"]))
            .car()
            .network,
    );
    let mut heat = Heat::uniform(293.15);
    heat.node_k[0] = 363.15;
    heat.node_k[1] = 363.15;
    let input = HeatInput {
        power_w: [0.0; 5],
        ambient_k: 293.15,
        speed_m_s: 0.0,
        pump_rad_s: 260.0,
        oil_flow_m3_s: 3e-4,
        oil_volume_heat_j_m3k: 1.7e6,
        running: true,
        dt_s: 1000.0,
    };
    let after = network.advance(&heat, &input);
    assert!(
        (after.heat.node_k[METAL] - 293.15).abs() < 1e-9
            && (after.heat.node_k[SUMP] - 293.15).abs() < 1e-9
    );
    assert!(after.to_air_w.abs() < 1e-9);
}

/// A cooler that cannot bring the box back ends the loop all the same, and says so.
#[test]
fn a_weak_cooler_leaves_the_loop_open() {
    let [low, _] = loops(
        &[],
        &["rig.cooler.coolant_degc=19", "rig.transient.end_degc=60"],
    );
    assert!(!low.complete && low.moments.len() < 20_000);
    // The cooling is given up at its longest duration and not a second later.
    let last = low.moments.last().unwrap();
    let is_cooling = |moment: &&Moment| moment.branch == Branch::Cooling;
    let lasted_s = last.time_s - low.moments.iter().find(is_cooling).unwrap().time_s;
    assert!((lasted_s - MAX_DURATION_S).abs() < 1e-6, "{lasted_s} s");
}

// ---- Steady maps, loads, the second box

/// 5.3.4: the second box lost about 1 Nm less, its pressure being 5 to 10 % lower; within 0.6 Nm.
#[test]
fn val_second_box() {
    let c = rig(&[]);
    for t in second_box(&Bench::new(&car(CAR, &[])), &c, &Plan::from_conditions(&c)) {
        let ratio = t.second.answer.secondary_pa / t.first.answer.secondary_pa;
        assert!((ratio - 0.925).abs() < 1e-6, "{ratio}");
        assert!(
            (t.difference_nm() + 1.0).abs() <= 0.6,
            "{:.2} Nm at {:?}",
            t.difference_nm(),
            t.first.set
        );
    }
}

/// Power in = power out + losses at every loaded point; nothing is flagged there but the pump, which does not hold the pressure of the hot box in low at 1000 rpm.
#[test]
fn loaded_points_balance() {
    let c = rig(&[]);
    let points = loaded(&Bench::new(&car(CAR, &[])), &c, &Plan::from_conditions(&c));
    assert_eq!(points.len(), 5 * 4 * (13 + 10));
    for p in &points {
        let w = p.set.input_rad_s;
        let (input, output, lost) = (
            p.answer.input_nm * w,
            p.set.output_nm * p.answer.output_rad_s,
            p.answer.total_nm() * w,
        );
        assert!((input - output - lost).abs() < 1e-9 * input, "{:?}", p.set);
        let short = w < 1100.0 * RPM && p.set.ratio > 2.0 && p.set.sump_k > 360.0;
        let mut flags = p.answer.flags;
        flags.set(
            Flags::FLOW_LIMITED,
            flags.contains(Flags::FLOW_LIMITED) && !short,
        );
        assert!(
            flags == Flags::default(),
            "{:?} {:?}",
            p.answer.flags,
            p.set
        );
    }
    let high = |nm: f64| {
        points
            .iter()
            .find(|p| p.set.ratio < 1.0 && (p.set.output_nm - nm).abs() < 1e-9)
            .unwrap()
            .answer
            .total_nm()
    };
    assert!(high(100.0) > high(0.0) + 0.3);
}

/// The rig's no-load points are the first torque of its loaded ones, and a plan's own values are obeyed.
#[test]
fn plans_are_obeyed() {
    let (c, bench) = (rig(&[]), Bench::new(&car(CAR, &[])));
    let plan = Plan {
        ratios: vec![1.0],
        speeds_rad_s: Some(vec![200.0, 100.0]),
        oil_k: vec![300.0],
        torques_nm: vec![0.0, 30.0],
    };
    let (none, some) = (steady(&bench, &c, &plan), loaded(&bench, &c, &plan));
    assert_eq!((none.len(), some.len()), (2, 4));
    assert_eq!(none[..], some[..2]);
    assert!(
        (none[0].set.input_rad_s - 200.0).abs() < 1e-12
            && (some[2].set.output_nm - 30.0).abs() < 1e-12
    );
}

/// The bench and a step of driving are two solutions of the same equations: equal at the same point, driving and overrunning. With a film
/// they differ by the belt's slip: driving takes the bands' sliding speed without it.
#[test]
fn the_bench_equals_a_step_of_driving() {
    for formulation in [
        Formulation::AppendixC,
        Formulation::Chapter8,
        Formulation::Smooth,
    ] {
        let setup = load(
            CAR,
            &Options {
                formulation,
                ..Options::default()
            },
        )
        .unwrap();
        let (bench, step) = (Bench::new(&setup), bench_step::Bench::new(&setup));
        let mut overrun = 0;
        for ratio in [2.4, 1.7, 1.0, 0.7, 0.5, 0.42] {
            for wheel_nm in [0.0, 60.0, 250.0, -40.0, -300.0] {
                for (sump_degc, belt_degc) in [(-5.0, 10.0), (40.0, 55.0), (90.0, 110.0)] {
                    let wheel_rad_s = 2200.0 * RPM / step.overall(ratio);
                    let s = Setting {
                        ratio,
                        wheel_rad_s,
                        wheel_nm,
                        sump_degc,
                        belt_degc,
                        ..Setting::default()
                    };
                    overrun += usize::from(compare(
                        &bench,
                        &step,
                        &s,
                        formulation == Formulation::Smooth,
                    ));
                }
            }
        }
        assert!(overrun > 10, "{overrun}");
    }
}

/// Compares one point; says whether the box was driven by its output.
fn compare(bench: &Bench, step: &bench_step::Bench, s: &Setting, film: bool) -> bool {
    let d = step.solve(s);
    assert!(
        !d.flags.contains(Flags::NOT_CONVERGED) && d.loss_w[Component::LaunchClutch].abs() < 1e-3,
        "{s:?}"
    );
    let w = d.engine_rad_s;
    let b = bench.solve(&BenchPoint {
        ratio: s.ratio,
        input_rad_s: w,
        output_nm: d.output_w / s.wheel_rad_s,
        throttle: d.throttle,
        sump_k: s.sump_degc + ZERO,
        belt_k: Some(s.belt_degc + ZERO),
        ..BenchPoint::default()
    });
    assert!(!b.flags.contains(Flags::NOT_CONVERGED), "{s:?}");
    assert!(
        (b.secondary_pa / d.secondary_pa - 1.0).abs() < 1e-4,
        "{s:?}: {} and {} Pa",
        b.secondary_pa,
        d.secondary_pa
    );
    let mut allowed_nm = 1e-3;
    for component in Component::ALL {
        let (bench_nm, step_nm) = (b.part_nm(component), d.loss_w[component] / w);
        // Friction and shear of a film go with the sliding speed to a power of about 3 at most.
        let slid = film
            && matches!(
                component,
                Component::BeltBand | Component::BeltFilm | Component::BeltSlip
            );
        let allowed = if slid {
            1e-3 + 4.0 * d.slip.abs() * step_nm.abs()
        } else {
            1e-3
        };
        allowed_nm += if slid { allowed } else { 0.0 };
        assert!(
            (bench_nm - step_nm).abs() <= allowed,
            "{s:?}: {} {bench_nm} and {step_nm} Nm",
            component.name()
        );
    }
    assert!(
        (b.input_nm - d.shaft_nm).abs() <= allowed_nm,
        "{s:?}: {} and {} Nm",
        b.input_nm,
        d.shaft_nm
    );
    assert!(
        (b.output_rad_s / s.wheel_rad_s - 1.0).abs() < if film { 1e-3 } else { 1e-5 },
        "{s:?}"
    );
    b.flags.contains(Flags::OVERRUN)
}
