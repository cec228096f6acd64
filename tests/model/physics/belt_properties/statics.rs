//! Forces and moments on the belt: what the tension step, band torque and slip must be by statics, and the second law.

use super::*;
use cvtcycle_model::transmission::cvt::variator::Tension;

/// Share of slip in the loss, Nm: below zero it relieves the bands (SL-11).
fn relief_nm(s: &BeltState) -> f64 {
    (s.slip.primary_loss_nm + s.slip.secondary_loss_nm).min(0.0)
}

proptest! {
    #![proptest_config(config(4000))]

    /// The torque at the primary is what the forces on it say, drive, overrun and inverted loading alike: R_p (C_x + dT) turns the belt, the
    /// bands take the force of each interface times its lever, and wedging and penetration what they take. Slip is not in it (TE-7, BT-6, FI-1, SL-11, VA-1).
    #[test]
    fn statics_of_the_primary(p in any_point()) {
        let belt = thesis_belt(Formulation::Smooth);
        let (g, s) = (BeltAtRatio::new(&belt, p.ratio).geometry, p.state(&belt));
        let (t, load) = (s.tension, p.load(Formulation::Smooth));
        let compression_n = p.torque_nm / g.secondary_radius_m - t.step_n; // TE-4
        let (turns, film_n) = ((1.0 / p.ratio - 1.0).abs(), load.film_n);
        let part = (p.ratio.ln() / belt.unity_width).tanh().abs(); // TE-6
        // Step at the innermost interface; boundary friction and film between the bands.
        let innermost_nm = turns * belt.band_offset_m * t.step_n.abs();
        let least = g.primary_wrap_rad.min(g.secondary_wrap_rad);
        let between = (belt.band_count - 1.0) * belt.band_thickness_m;
        let boundary_n = (1.0 - load.band.film_share[1]) * p.mu_band * (t.mean_tension_n(&g) - t.ring_n) * least;
        let others_nm = part * turns * between * (0.5 * boundary_n + film_n[1]);
        let want = g.primary_radius_m * (compression_n + t.step_n)
            + innermost_nm
            + others_nm
            + s.losses.wedge_nm
            + s.losses.penetration_nm;
        prop_assert!((s.input_torque_nm - want).abs() <= 1e-9 + 1e-11 * want.abs(), "{} instead of {want}: {s:?}", s.input_torque_nm);
    }

    /// One force serves both pulleys: the step is friction times the shoulder force of the smaller wrap, whichever pulley has it, and the film's force (TE-7).
    #[test]
    fn tension_step_is_one_force(p in any_point()) {
        let belt = thesis_belt(Formulation::Smooth);
        let (g, t) = (BeltAtRatio::new(&belt, p.ratio).geometry, p.state(&belt).tension);
        let part = (p.ratio.ln() / belt.unity_width).tanh().abs(); // TE-6
        let mean_n = t.mean_tension_n(&g) - t.ring_n;
        let least = g.primary_wrap_rad.min(g.secondary_wrap_rad);
        let force_n = (1.0 - p.film_share) * p.mu_band * mean_n * least + p.film_n()[0];
        prop_assert!((t.step_n.abs() - part * force_n).abs() <= 1e-10 * (1.0 + mean_n));
    }

    /// The step without compression is the tension step of the belt under the torque that makes compression zero, in every form (TE-5, TE-7).
    #[test]
    fn the_bare_step_is_that_without_compression(p in any_point(), formulation in any_formulation()) {
        let belt = thesis_belt(formulation);
        let at = BeltAtRatio::new(&belt, p.ratio);
        let step_n = Tension::bare_step_n(&belt, &at, &p.load(formulation));
        let torque_nm = step_n * at.geometry.secondary_radius_m;
        let t = Point { torque_nm, ..p }.state(&belt).tension;
        let scale_n = 1.0 + step_n.abs() + t.primary_shoulder_n.abs();
        prop_assert!(t.compression_n.abs() <= 1e-11 * scale_n, "{t:?}");
        prop_assert!((t.step_n - step_n).abs() <= 1e-11 * scale_n, "{step_n} N: {t:?}");
    }

    /// Second law: no part of the loss is negative, power out never exceeds power in, and what slip relieves the bands of they have (SL-12).
    #[test]
    fn the_belt_gives_no_energy_back(p in any_point()) {
        let belt = thesis_belt(Formulation::Smooth);
        let s = p.state(&belt);
        let l = &s.losses;
        for part in [l.band_nm, l.film_nm, l.slip_nm, l.wedge_nm, l.penetration_nm] {
            prop_assert!(part >= 0.0, "{s:?}");
        }
        let out_nm = p.torque_nm / p.ratio * (1.0 - l.slip_total);
        prop_assert!(s.input_torque_nm - out_nm >= 0.0, "{s:?}");
        prop_assert!(s.band_nm + s.film_nm + relief_nm(&s) >= -1e-12 * (s.band_nm + s.film_nm), "{s:?}");
    }
}

/// Truth: the worked point of the page on tension, from the two moment equations by hand. I = 0.5, 2500 rpm, 10 Nm, 11.93 kN, friction 0.1275.
#[test]
fn val_worked_point_of_the_tension_step() {
    let belt = |formulation| Belt {
        mass_kg_m: 1.602,
        band_mass_kg_m: 0.0,
        ..thesis_belt(formulation)
    };
    let p = Point {
        rpm: 2500.0,
        torque_nm: 10.0,
        clamp_n: 11_927.0,
        mu_band: 0.127_47,
        film_share: 0.0,
        ..Point::plain(0.5)
    };
    let one = p.state(&belt(Formulation::Smooth)).tension;
    assert!((one.step_n + 996.0).abs() < 12.0, "{one:?}");
    assert!((one.compression_n - 1281.0).abs() < 12.0, "{one:?}");
    // Appendix C takes the primary's wrap: 1.34 times as much force for the same pressure on the shoulders.
    let printed = p.state(&belt(Formulation::AppendixC)).tension;
    let [one, printed] = [one, printed].map(|t| t.step_n.abs() / t.primary_shoulder_n);
    assert!((printed / one - 1.340).abs() < 0.002, "{printed} {one}");
}
