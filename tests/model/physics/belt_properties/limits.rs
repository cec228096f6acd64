//! Effects that vanish with their causes or depend on them alone. No input of the allowed range gives NaN.

use super::*;

proptest! {
    #![proptest_config(config(1500))]

    /// Without band friction the bands lose nothing, tension makes no step and segments carry all of the torque (TE-3, TE-4, BT-3).
    #[test]
    fn no_band_friction_no_band_loss(f in any_formulation(), p in any_point()) {
        let s = Point { mu_band: 0.0, film_share: 0.0, ..p }.state(&thesis_belt(f));
        prop_assert_eq!((s.band_nm, s.losses.band_nm, s.tension.step_n), (0.0, 0.0, 0.0));
        let radius = BeltAtRatio::new(&thesis_belt(f), p.ratio).geometry.secondary_radius_m;
        prop_assert!((s.tension.compression_n * radius - p.torque_nm).abs() <= 1e-12 * p.torque_nm.abs());
    }

    /// The forces hold together as printed: T_2 - T_1 and C_x carry the torque (TE-4), friction on the shoulders makes the step of
    /// tension (TE-3), clamping, speed and compression press on them (TE-2). Truth: the equations put back into each other.
    #[test]
    fn val_tension_solves_its_equations(f in any_formulation(), p in any_point()) {
        let belt = thesis_belt(f);
        let at = BeltAtRatio::new(&belt, p.ratio);
        let (g, t) = (at.geometry, p.state(&belt).tension);
        let s = -(p.ratio.ln() / belt.unity_width).tanh();
        let v = p.rpm * RPM * g.primary_radius_m;
        let pressing_kg_m = belt.mass_kg_m - if f == Formulation::Smooth { belt.band_mass_kg_m } else { 0.0 };
        prop_assert!((t.mean_tension_n(&g) - t.primary_shoulder_n / g.primary_wrap_rad - (belt.mass_kg_m - pressing_kg_m) * v * v).abs() <= 1e-9 * t.mean_tension_n(&g), "TE-8 {t:?}");
        let pressed = |clamp_n: f64, wrap: f64| {
            2.0 * clamp_n * belt.tan_wedge + wrap * (pressing_kg_m * v * v + t.compression_n.abs() / 2.0)
        };
        let primary_n = p.clamp_n * g.primary_wrap_rad / g.secondary_wrap_rad;
        let small = 1e-11 * (t.primary_shoulder_n + t.secondary_shoulder_n + t.compression_n.abs());
        prop_assert!((t.primary_shoulder_n - pressed(primary_n, g.primary_wrap_rad)).abs() <= small, "TE-2 {t:?}");
        prop_assert!((t.secondary_shoulder_n - pressed(p.clamp_n, g.secondary_wrap_rad)).abs() <= small, "TE-2 {t:?}");
        let gripped_n = if f == Formulation::Smooth { t.primary_shoulder_n.min(t.secondary_shoulder_n) } else { t.primary_shoulder_n };
        let load = p.load(f);
        let force_n = p.mu_band * (1.0 - load.band.film_share[0]) * gripped_n + load.film_n[0];
        prop_assert!((t.step_n + s * force_n).abs() <= small + 1e-12 * force_n, "TE-3, TE-7 {t:?}");
        prop_assert!((t.compression_n + t.step_n - p.torque_nm / g.secondary_radius_m).abs() <= small, "TE-4 {t:?}");
    }

    /// Band loss is friction times sliding over all interfaces of both packs (BT-1, BT-2, thesis eq. 48, 49): n interfaces that press
    /// less and less outwards, the first of which slides by the offset and the others by a band's thickness. BT-4 where it applies.
    #[test]
    fn val_band_loss_is_the_sum_over_interfaces(f in any_formulation(), p in any_point(), n in 1..=40u8) {
        let belt = Belt { band_count: f64::from(n), ..thesis_belt(f) };
        let (g, s) = (BeltAtRatio::new(&belt, p.ratio).geometry, p.state(&belt));
        let sliding = |i: u8| (1.0 / p.ratio - 1.0).abs() / 2.0 * if i == 1 { belt.band_offset_m } else { belt.band_thickness_m };
        let pack = |shoulder_n: f64, wrap: f64, other: f64| {
            let factor = if f == Formulation::Chapter8 { 1.0 } else { (other / wrap).min(1.0) };
            let dry = |i: u8| 1.0 - p.load(f).band.film_share[usize::from(i > 1)]; // LU-5
            let over = (1..=n).map(|i| dry(i) * shoulder_n * (1.0 - f64::from(i - 1) / f64::from(n)) * sliding(i));
            factor * p.mu_band * over.sum::<f64>()
        };
        let want = pack(s.tension.primary_shoulder_n, g.primary_wrap_rad, g.secondary_wrap_rad)
            + pack(s.tension.secondary_shoulder_n, g.secondary_wrap_rad, g.primary_wrap_rad);
        let want = if f == Formulation::Smooth { (p.ratio.ln() / belt.unity_width).tanh().abs() * want } else { want }; // BT-6
        prop_assert!((s.band_nm - want).abs() <= 1e-11 * want + 1e-15, "{} instead of {want}", s.band_nm);
    }

    /// Rigid pulleys, frictionless flanks or no clamping: neither wedging nor penetration (WE-1, WE-3, PE-1).
    #[test]
    fn rigid_pulleys_do_not_wedge(f in any_formulation(), p in any_point()) {
        let belt = thesis_belt(f);
        let rigid = Belt { primary_compliance_per_n: 0.0, secondary_compliance_per_n: 0.0, ..belt.clone() };
        for s in [p.state(&rigid), Point { mu_flank: 0.0, ..p }.state(&belt), Point { clamp_n: 0.0, ..p }.state(&belt)] {
            prop_assert_eq!((s.losses.wedge_nm, s.losses.penetration_nm), (0.0, 0.0));
        }
    }

    /// On its end stop the primary does not deflect: a stiffer one changes nothing (WE-4); AppendixC has no stop.
    #[test]
    fn on_its_stop_the_primary_is_rigid(ratio in 2.417..3.0f64, p in any_point()) {
        let p = Point { ratio, clamp_n: p.clamp_n + 1.0, mu_flank: 0.13, ..p };
        for f in ALL {
            let belt = thesis_belt(f);
            let (soft, stiff) = (p.state(&belt), p.state(&Belt { primary_compliance_per_n: 0.0, ..belt }));
            prop_assert_eq!(soft.losses.wedge_nm == stiff.losses.wedge_nm && soft.losses.penetration_nm == stiff.losses.penetration_nm, f != Formulation::AppendixC);
        }
    }

    /// Gaps come from elasticity alone when there is none at no load: slip falls as 1/E, and is nothing for a rigid belt that does
    /// not slip grossly (SL-1, SL-2, SL-5).
    #[test]
    fn rigid_belt_does_not_slip(f in any_formulation(), p in any_point()) {
        let p = Point { clamp_n: p.clamp_n + 1000.0, mu_segment: 0.125, ..p };
        let belt = |gpa: f64| Belt { youngs_pa: gpa * 1e9, slip_bound: 1e9, ..thesis_belt(f) };
        let (soft, stiff, rigid) = (p.state(&belt(206.0)), p.state(&belt(412.0)), p.state(&belt(1e30)));
        prop_assume!(!soft.losses.gross_slip && !second_law_binds(&soft) && !second_law_binds(&stiff));
        prop_assert!((soft.losses.slip_total - 2.0 * stiff.losses.slip_total).abs() <= 1e-12 * (soft.slip.primary.abs() + soft.slip.secondary.abs()));
        prop_assert!((soft.losses.slip_nm - 2.0 * stiff.losses.slip_nm).abs() <= 1e-12 * soft.losses.slip_nm);
        prop_assert!(rigid.losses.slip_total.abs() <= 1e-15 * (1.0 + soft.losses.slip_total.abs()), "{}", rigid.losses.slip_total);
        // A gap that is there at no load slips in a rigid belt too, by no less than gap over arc (here 0.25 m at the most).
        let gapped = p.state(&Belt { initial_gap_m: 1e-3, ..belt(1e30) });
        let conventional = f == Formulation::Smooth && gapped.tension.compression_n > 9.0 * 120.0;
        prop_assert!(!conventional || gapped.slip.primary > 4e-3, "{:?}", gapped.slip);
    }

    /// The blend weighs the branches by (1 + tanh(C_x/C0))/2 and nothing else (SL-8): at one point, slip and its loss under three widths
    /// C0 lie on one line over that weight, from the inverted branch alone to the conventional one alone.
    #[test]
    fn blend_weighs_the_branches_by_its_width(p in any_point(), (a, b, c) in (1.0..2000.0f64, 1.0..2000.0f64, 1.0..2000.0f64)) {
        let belt = |blend_n: f64| Belt { blend_n, ..thesis_belt(Formulation::Smooth) };
        let cx = p.state(&belt(1.0)).tension.compression_n;
        let at = |blend_n: f64| {
            let s = p.state(&belt(blend_n));
            (0.5 * (1.0 + (cx / blend_n).tanh()), [s.slip.primary, s.slip.secondary, s.slip.primary_loss_nm + s.slip.secondary_loss_nm])
        };
        prop_assume!([a, b, c].iter().all(|width| !second_law_binds(&p.state(&belt(*width)))));
        let ((u, x), (v, y), (w, z)) = (at(a), at(b), at(c));
        // The branches differ as long as neither is held, so that the width has a say where the weight has.
        let free = p.clamp_n > 100.0 && x[0].abs() < 0.02 && y[0].abs() < 0.02;
        prop_assert!(!free || (u - v).abs() < 1e-3 || x[0] != y[0], "{x:?} at {u} and at {v}");
        for k in 0..3 {
            let off = (y[k] - x[k]) * (w - u) - (z[k] - x[k]) * (v - u);
            prop_assert!(off.abs() <= 1e-7 * (x[k].abs() + y[k].abs() + z[k].abs()), "{x:?} at {u}, {y:?} at {v}, {z:?} at {w}");
        }
    }

    /// Flank friction takes no part in tension or slip; films take a share of the step, and their force knows neither torque nor clamping.
    #[test]
    fn causes_do_not_mix(f in any_formulation(), p in any_point()) {
        let (belt, p) = (thesis_belt(f), Point { film_share: 0.5, ..p });
        let (plain, dry) = (p.state(&belt), Point { mu_flank: 0.2, ..p }.state(&belt));
        prop_assert_eq!((plain.tension, plain.band_nm), (dry.tension, dry.band_nm));
        prop_assert!(plain.slip == dry.slip || second_law_binds(&dry));
        prop_assert_eq!(Point { film_share: 0.0, ..p }.state(&belt).losses.film_nm, 0.0);
        // Wedge, penetration and film know neither torque nor band and segment friction; the film does not know clamping either.
        let other = Point { torque_nm: -3.0 - p.torque_nm, mu_band: 0.05, mu_segment: 0.05, ..p }.state(&belt);
        prop_assert_eq!((plain.losses.wedge_nm, plain.losses.penetration_nm, plain.film_nm), (other.losses.wedge_nm, other.losses.penetration_nm, other.film_nm));
        prop_assert_eq!(plain.film_nm, Point { clamp_n: p.clamp_n + 5e3, ..p }.state(&belt).film_nm);
        // Prescribed segment friction leaves the fluid's without effect, Smooth's own does not.
        let sticky = Point { mu_segment: p.mu_segment + 0.05, ..p }.state(&belt);
        prop_assert_eq!(sticky.losses.capacity_nm == plain.losses.capacity_nm, f != Formulation::Smooth || p.clamp_n * 0.05 < 1e-300);
    }

    /// A contact that the film carries whole has the friction of its shear and no other: the step is that force, the bands lose nothing (LU-5, TE-7).
    #[test]
    fn friction_of_a_lifted_contact_is_shear_alone(p in any_point()) {
        let belt = thesis_belt(Formulation::Smooth);
        let lifted = BandFriction { film_share: [1.0; 2], ..BandFriction::dry(p.mu_band) };
        let load = BeltLoad { band: lifted, film_n: [300.0, 7.0], ..p.load(Formulation::Smooth) };
        let s = belt_state(&belt, &BeltAtRatio::new(&belt, p.ratio), &load);
        let part = (p.ratio.ln() / belt.unity_width).tanh(); // TE-6
        prop_assert!((s.tension.step_n - part * 300.0).abs() <= 1e-9);
        prop_assert_eq!(s.band_nm, 0.0);
        let levers = [300.0 * belt.band_offset_m, 7.0 * 11.0 * belt.band_thickness_m];
        let want = part.abs() * (1.0 / p.ratio - 1.0).abs() * (levers[0] + levers[1]);
        prop_assert!((s.film_nm - want).abs() <= 1e-12 * (1.0 + want), "{} {want}", s.film_nm);
    }
}

/// A film gives no torque at rest, little at -40 degC, and each interface has its own speed (FI-1, FI-2, FH-1): the shipped fluid at 4000 rpm.
#[test]
fn films_of_the_shipped_fluid() {
    let setup = crate::common::car("rover_216_cvt", &[]);
    let oil = setup.oils().0;
    let belt = thesis_belt(Formulation::Smooth);
    let film = |degc: f64, rpm: f64| {
        let load = BeltLoad {
            secondary_clamp_n: 12e3,
            ..BeltLoad::turning(&belt, oil, degc + 273.15, 0.5, rpm * RPM)
        };
        (
            load,
            belt_state(&belt, &BeltAtRatio::new(&belt, 0.5), &load),
        )
    };
    let (rest, at_rest) = film(-40.0, 0.0);
    assert!(rest.film_n == [0.0; 2] && at_rest.film_nm == 0.0 && at_rest.band_nm > 1.0);
    let (cold, at_cold) = film(-40.0, 4000.0);
    assert!(
        at_cold.film_nm > 0.5 && at_cold.film_nm < 4.0,
        "{} Nm",
        at_cold.film_nm
    );
    assert!(cold.band.film_share[0] > 0.99);
    let [inner, outer] = film(25.0, 2500.0).0.band.film_share;
    assert!(inner > 0.2 && outer < 0.05, "{inner} {outer}");
}

/// Belts as different as the input file allows in what the smooth rules look at.
fn any_belt() -> impl Strategy<Value = Belt> {
    let gap = prop_oneof![Just(0.0), 0.0..1e-3f64];
    let smoothing = (1e-4..0.2f64, 1.0..2000.0f64, 0.01..0.5f64);
    (any_formulation(), gap, smoothing, 1..=40u8, 0.0..0.02f64).prop_map(
        |(f, gap, (unity, blend, bound), bands, offset)| Belt {
            initial_gap_m: gap,
            unity_width: unity,
            blend_n: blend,
            slip_bound: bound,
            band_count: f64::from(bands),
            band_offset_m: offset,
            ..thesis_belt(f)
        },
    )
}

fn losses(s: &BeltState) -> [f64; 5] {
    [
        s.losses.band_nm,
        s.losses.film_nm,
        s.losses.slip_nm,
        s.losses.wedge_nm,
        s.losses.penetration_nm,
    ]
}

/// Finite, losses not negative, slips within their bound, capacity and its flag true to VA-2.
fn check_numbers(belt: &Belt, p: &Point, s: &BeltState) -> Result<(), TestCaseError> {
    let t = &s.tension;
    let more = [
        t.primary_shoulder_n,
        t.secondary_shoulder_n,
        s.losses.capacity_nm,
        s.slip.active_segments,
        s.losses.sum_nm(),
    ];
    for (x, name) in values(s).iter().zip(NAMES).chain(
        more.iter()
            .zip(["Q_p", "Q_s", "capacity", "segments", "sum"]),
    ) {
        hold(x.is_finite(), || format!("{name} is {x}: {s:?}"))?;
    }
    for (x, name) in losses(s).iter().zip(NAMES) {
        hold(*x >= 0.0, || format!("{name} loss is {x}"))?;
    }
    let bound = belt.slip_bound * (1.0 + 1e-12);
    hold(
        s.slip.primary.abs() <= bound && s.slip.secondary.abs() <= bound,
        || {
            format!(
                "slip {} and {} over its bound {} (SL-9)",
                s.slip.primary, s.slip.secondary, belt.slip_bound
            )
        },
    )?;
    hold(s.losses.capacity_nm >= 0.0, || {
        format!("capacity {}", s.losses.capacity_nm)
    })?;
    hold(
        s.losses.gross_slip || p.torque_nm.abs() <= s.losses.capacity_nm,
        || "gross slip goes unflagged".into(),
    )?;
    hold(
        p.ratio != 1.0 || s.losses.band_nm == 0.0 && s.losses.film_nm == 0.0,
        || {
            format!(
                "bands slide at ratio 1: {} {}",
                s.losses.band_nm, s.losses.film_nm
            )
        },
    )
}

/// First law: T_in w_in - T_out w_out is the sum of the losses; w_out is the slipped speed. Second law: what the driven shaft gets is
/// never more than what the driving one gives, whichever drives.
fn check_energy(p: &Point, s: &BeltState) -> Result<(), TestCaseError> {
    let w_in = if p.rpm > 0.0 { p.rpm * RPM } else { 1.0 };
    let w_out = w_in / p.ratio * (1.0 - s.losses.slip_total);
    let (given, taken) = (s.input_torque_nm * w_in, p.torque_nm * w_out);
    let lost: f64 = losses(s).iter().map(|x| x * w_in).sum();
    let rounding = 1e-14 * (given.abs() + taken.abs() + lost) + f64::MIN_POSITIVE;
    hold((given - taken - lost).abs() <= 8.0 * rounding, || {
        format!("{given} W in, {taken} W out, {lost} W lost")
    })?;
    hold(given >= taken - 8.0 * rounding, || {
        format!("{given} W in, {taken} W out")
    })
}

proptest! {
    #![proptest_config(config(6000))]

    /// Ratio 0.35 to 3, 0 to 7000 rpm, -400 to 400 Nm, 0 to 50 kN, all frictions 0 to 0.2, with the corners oftener than by chance.
    #[test]
    fn any_point_gives_finite_numbers_and_keeps_energy(belt in any_belt(), p in any_point()) {
        let s = p.state(&belt);
        check_numbers(&belt, &p, &s)?;
        check_energy(&p, &s)?;
    }

    /// Losses do not know which way round the pulleys turn.
    #[test]
    fn losses_are_even_in_the_sense_of_rotation(f in any_formulation(), p in any_point()) {
        let belt = thesis_belt(f);
        prop_assert_eq!(values(&p.state(&belt)), values(&Point { rpm: -p.rpm, ..p }.state(&belt)));
    }

    /// Slip is defined at standstill: a creeping belt's answer goes over into the standing one's. Segments without a grip have none that holds even the
    /// force of a creeping film.
    #[test]
    fn standing_is_the_limit_of_creeping(p in any_point()) {
        let grips = p.mu_segment * p.clamp_n > 1e-3;
        let p = Point { film_share: if grips { p.film_share } else { 0.0 }, ..p };
        let belt = thesis_belt(Formulation::Smooth);
        let (rests, creeps) = (values(&Point { rpm: 0.0, ..p }.state(&belt)), values(&Point { rpm: 1e-5, ..p }.state(&belt)));
        for ((a, b), name) in rests.iter().zip(&creeps).zip(NAMES) {
            hold((a - b).abs() <= 1e-6 * (a.abs() + b.abs()) + 1e-6, || format!("{name}: {a} standing, {b} creeping"))?;
        }
    }
}

/// The corners by name, in every combination.
#[test]
fn every_corner_is_finite() {
    let mut count = 0;
    for f in ALL {
        let belt = thesis_belt(f);
        for ratio in [0.35, 1.0 - 1e-12, 1.0, 1.0 + 1e-12, 2.30, 2.417, 3.0] {
            for rpm in [0.0, 1e-9, 7000.0] {
                for clamp_n in [0.0, f64::MIN_POSITIVE, 1e-9, 750.0, 50e3] {
                    for (mu_band, mu_segment) in [
                        (0.0, 0.0),
                        (0.0, 0.2),
                        (0.2, 0.0),
                        (0.2, 0.2),
                        (1e-300, 1e-300),
                    ] {
                        let p = Point {
                            rpm,
                            clamp_n,
                            mu_band,
                            mu_segment,
                            ..Point::plain(ratio)
                        };
                        let at_zero_cx = p.breakpoint_nm(&belt);
                        for torque_nm in [-400.0, -1e-12, 0.0, 1e-12, 400.0, at_zero_cx] {
                            let p = Point { torque_nm, ..p };
                            let s = p.state(&belt);
                            let result =
                                check_numbers(&belt, &p, &s).and_then(|()| check_energy(&p, &s));
                            assert!(result.is_ok(), "{f:?} {p:?}: {result:?}");
                            count += 1;
                        }
                    }
                }
            }
        }
    }
    assert_eq!(count, 3 * 7 * 3 * 5 * 5 * 6);
}

/// A stop without a ramp is a step: all of the deflection below it, none at it or above, and never NaN.
#[test]
fn a_stop_without_a_ramp_is_a_step() {
    let belt = Belt {
        stop_from_ratio: 2.4,
        stop_to_ratio: 2.4,
        ..thesis_belt(Formulation::Smooth)
    };
    let stop = |ratio: f64| BeltAtRatio::new(&belt, ratio).prepared.stop;
    assert_eq!([stop(2.3999), stop(2.4), stop(2.4001)], [1.0, 0.0, 0.0]);
}
