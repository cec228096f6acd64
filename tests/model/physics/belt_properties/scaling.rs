//! Dimension rescaling: the same belt in other units of length, force and time gives the same fractions.
//!
//! Let lengths grow by a, forces by b and times by c. A torque then grows by a b. What the inputs must do follows from their
//! dimensions, and from what the equations make of them:
//!
//! | input | factor | since |
//! |---|---|---|
//! | centre distance, belt, segment, band thickness, offset, gap | a | GE-3, SL-4, BT-3, SL-5 |
//! | clamp, blend width C0 | b | TE-2, SL-8 |
//! | torque | a b | TE-4: T/R_s |
//! | speed | 1/c | |
//! | mass per length | b c2/a2 | TE-2: m v2 is a force, v grows by a/c |
//! | compliance | 1/b | WE-1: deflection = R F x compliance |
//! | force of a film | b | FI-1 |
//! | E x (band area, strut area) | b | SL-1, SL-2: L F/(E A) is a length |
//! | E x A_arc(C_x) | b | SL-2, the same |
//!
//! The last row is the only one with dimensional constants in it: SL-3 gives A_arc in m2 for C_x in N and cannot be rescaled.
//! Everything but slip is free of it, so (a, b, c) are free for geometry, tension, bands, film, wedge, penetration, capacity. The
//! whole belt rescales where A_arc stays as it is: with b = 1 at any C_x, or with any b where \|C_x\| is beyond the 4492 N at which SL-3
//! is held. There E must grow by b and the areas not at all: the strut's as given, the bands' n w t by a width that grows by 1/a.

use super::*;

/// Factors of length, force, time.
#[derive(Clone, Copy, Debug)]
struct Units {
    length: f64,
    force: f64,
    time: f64,
}

/// The point in the new units.
fn load(p: &Point, f: Formulation, u: &Units) -> BeltLoad {
    let plain = p.load(f);
    BeltLoad {
        primary_speed_rad_s: plain.primary_speed_rad_s / u.time,
        output_torque_nm: plain.output_torque_nm * u.length * u.force,
        secondary_clamp_n: plain.secondary_clamp_n * u.force,
        film_n: plain.film_n.map(|n| n * u.force),
        ..plain
    }
}

fn belt(b: &Belt, u: &Units, width: f64) -> Belt {
    Belt {
        centre_distance_m: b.centre_distance_m * u.length,
        length_m: b.length_m * u.length,
        segment_thickness_m: b.segment_thickness_m * u.length,
        band_thickness_m: b.band_thickness_m * u.length,
        band_offset_m: b.band_offset_m * u.length,
        band_width_m: b.band_width_m * width,
        initial_gap_m: b.initial_gap_m * u.length,
        mass_kg_m: b.mass_kg_m * u.force * u.time * u.time / (u.length * u.length),
        band_mass_kg_m: b.band_mass_kg_m * u.force * u.time * u.time / (u.length * u.length),
        primary_compliance_per_n: b.primary_compliance_per_n / u.force,
        secondary_compliance_per_n: b.secondary_compliance_per_n / u.force,
        blend_n: b.blend_n * u.force,
        youngs_pa: b.youngs_pa * u.force,
        ..b.clone()
    }
}

fn same(name: &str, now: f64, was: f64, factor: f64, scale: f64) -> Result<(), TestCaseError> {
    hold(
        (now - was * factor).abs() <= 1e-6 * scale * factor.abs(),
        || format!("{name}: {was} becomes {now}, factor {factor}"),
    )
}

/// Everything that does not look at SL-3.
fn check_forces(now: &BeltState, was: &BeltState, u: &Units) -> Result<(), TestCaseError> {
    let torque = u.length * u.force;
    let (t, o) = (&now.tension, &was.tension);
    let scale = o.primary_shoulder_n + o.secondary_shoulder_n + 1e-9;
    same("C_x", t.compression_n, o.compression_n, u.force, scale)?;
    same("dT", t.step_n, o.step_n, u.force, scale)?;
    same(
        "Q_p",
        t.primary_shoulder_n,
        o.primary_shoulder_n,
        u.force,
        scale,
    )?;
    same(
        "Q_s",
        t.secondary_shoulder_n,
        o.secondary_shoulder_n,
        u.force,
        scale,
    )?;
    let (l, m) = (&now.losses, &was.losses);
    for (name, a, b) in [
        ("band", now.band_nm, was.band_nm),
        ("film", now.film_nm, was.film_nm),
        ("wedge", l.wedge_nm, m.wedge_nm),
        ("penetration", l.penetration_nm, m.penetration_nm),
    ] {
        same(name, a, b, torque, b)?;
    }
    same(
        "capacity",
        now.losses.capacity_nm,
        was.losses.capacity_nm,
        torque,
        was.losses.capacity_nm,
    )
}

/// Slip and all that follows from it.
fn check_slip(now: &BeltState, was: &BeltState, u: &Units) -> Result<(), TestCaseError> {
    let scale = was.slip.primary.abs() + was.slip.secondary.abs() + 1e-9;
    same(
        "primary slip",
        now.slip.primary,
        was.slip.primary,
        1.0,
        scale,
    )?;
    same(
        "secondary slip",
        now.slip.secondary,
        was.slip.secondary,
        1.0,
        scale,
    )?;
    same(
        "slip loss",
        now.losses.slip_nm,
        was.losses.slip_nm,
        u.length * u.force,
        was.losses.slip_nm + 1e-6,
    )?;
    same(
        "segments",
        now.slip.active_segments,
        was.slip.active_segments,
        1.0,
        was.slip.active_segments + 1e-3,
    )?;
    same(
        "input torque",
        now.input_torque_nm,
        was.input_torque_nm,
        u.length * u.force,
        was.input_torque_nm.abs() + was.losses.sum_nm(),
    )
}

fn log_range(factor: f64) -> impl Strategy<Value = f64> {
    (-factor.ln()..factor.ln()).prop_map(f64::exp)
}

fn any_units() -> impl Strategy<Value = Units> {
    (log_range(5.0), log_range(20.0), log_range(20.0)).prop_map(|(length, force, time)| Units {
        length,
        force,
        time,
    })
}

proptest! {
    #![proptest_config(config(2500))]

    /// Geometry, tension, bands, film, wedge, penetration and capacity under any change of units, every width growing by a. The
    /// thesis's two readings lift C_x below 30 N, which only slip looks at.
    #[test]
    fn forces_rescale_in_length_force_and_time(f in any_formulation(), p in any_point(), u in any_units()) {
        let plain = thesis_belt(f);
        let scaled = belt(&plain, &u, u.length);
        let (g, h) = (BeltAtRatio::new(&plain, p.ratio).geometry, BeltAtRatio::new(&scaled, p.ratio).geometry);
        same("R_p", h.primary_radius_m, g.primary_radius_m, u.length, g.primary_radius_m)?;
        same("strut", h.strut_m, g.strut_m, u.length, g.strut_m)?;
        same("wrap", h.primary_wrap_rad, g.primary_wrap_rad, 1.0, 1.0)?;
        let now = belt_state(&scaled, &BeltAtRatio::new(&scaled, p.ratio), &load(&p, plain.formulation, &u));
        check_forces(&now, &p.state(&plain), &u)?;
    }

    /// The whole belt with slip, in length and time (b = 1), at every C_x, with a gap at no load and without.
    #[test]
    fn slip_rescales_in_length_and_time(f in any_formulation(), p in any_point(), u in any_units(), gap in any::<bool>()) {
        let u = Units { force: 1.0, ..u };
        let p = Point { clamp_n: 100.0 + p.clamp_n, mu_segment: 0.02 + p.mu_segment, ..p };
        let plain = Belt { initial_gap_m: if gap { 2e-4 } else { 0.0 }, ..thesis_belt(f) };
        let scaled = belt(&plain, &u, 1.0 / u.length);
        let (now, was) = (belt_state(&scaled, &BeltAtRatio::new(&scaled, p.ratio), &load(&p, plain.formulation, &u)), p.state(&plain));
        check_forces(&now, &was, &u)?;
        // A C_x of rounding size falls to either side of the thesis's 30 N rule.
        prop_assume!(f == Formulation::Smooth || was.tension.compression_n.abs() > 1e-6);
        check_slip(&now, &was, &u)?;
    }

    /// The whole belt with slip in length, force and time where both C_x lie beyond 4492 N.
    #[test]
    fn slip_rescales_in_force_beyond_the_held_area(
        (log, low, sense) in (0.05..1.05f64, any::<bool>(), any::<bool>()), clamp_n in 10e3..50e3f64, share in 0.0..1.0f64,
        u in any_units(), rpm in 0.0..7000.0f64, wide in any::<bool>()
    ) {
        // A wide blend keeps the branch without compression in the sum; it has no contact area to look at.
        let plain = Belt { blend_n: if wide { 2000.0 } else { 120.0 }, ..thesis_belt(Formulation::Smooth) };
        let u = Units { force: u.force.max(1.0 / u.force), ..u };
        let p = Point { ratio: if low { log } else { -log }.exp(), clamp_n, rpm, ..Point::plain(1.0) };
        let reach = 4600.0 * BeltAtRatio::new(&plain, p.ratio).geometry.secondary_radius_m * 1.3 + 200.0 * share;
        let p = Point { torque_nm: p.breakpoint_nm(&plain) + if sense { reach } else { -reach }, ..p };
        let was = p.state(&plain);
        prop_assert!(was.tension.compression_n.abs() > 4492.0, "C_x {}", was.tension.compression_n);
        let scaled = belt(&plain, &u, 1.0 / u.length);
        let now = belt_state(&scaled, &BeltAtRatio::new(&scaled, p.ratio), &load(&p, plain.formulation, &u));
        check_forces(&now, &was, &u)?;
        check_slip(&now, &was, &u)?;
    }
}
