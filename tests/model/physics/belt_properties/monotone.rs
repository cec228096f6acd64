//! Where physics says which way a number goes: each test gives the reason and the range.

use super::*;

/// Two different numbers of a range, the smaller one first.
fn pair(from: f64, to: f64) -> impl Strategy<Value = (f64, f64)> {
    (from..to, from..to).prop_map(|(a, b)| if a < b { (a, b) } else { (b, a) })
}

/// `b` is not below `a`; where the cause is at work it is above it.
fn rises(name: &str, a: f64, b: f64, strictly: bool) -> Result<(), TestCaseError> {
    let rounding = 1e-12 * (a.abs() + b.abs());
    hold(if strictly { b > a } else { b >= a - rounding }, || {
        format!("{name} goes from {a} to {b}")
    })
}

proptest! {
    #![proptest_config(config(2500))]

    /// Band loss rises with clamping, everywhere: Q_p = A + |C_x| beta_p/2 and TE-5 give dQ_p/dA = 1/(1 -+ s c), which lies above
    /// 1/2, although |C_x| itself falls with clamping on one side of the breakpoint.
    #[test]
    fn band_loss_rises_with_clamp(f in any_formulation(), p in any_point(), (a, b) in pair(0.0, 50e3)) {
        let band = |clamp_n: f64| Point { clamp_n, ..p }.state(&thesis_belt(f)).band_nm;
        rises("band loss", band(a), band(b), b > a + 1.0 && p.mu_band > 1e-3 && p.ratio.ln().abs() > 1e-3)?;
    }

    /// Band loss is proportional to d + t (n - 1)/2 (BT-3): it rises with the offset, on a line that does not go through zero.
    #[test]
    fn band_loss_rises_with_offset(f in any_formulation(), p in any_point(), (a, b) in pair(0.0, 0.02)) {
        let p = Point { film_share: 0.0, ..p };
        let band = |d: f64| p.state(&Belt { band_offset_m: d, ..thesis_belt(f) }).band_nm;
        rises("band loss", band(a), band(b), b > a + 1e-6 && band(b) > 0.0)?;
        let rest = 0.217e-3 * 11.0 / 2.0;
        prop_assert!((band(a) * (b + rest) - band(b) * (a + rest)).abs() <= 1e-12 * band(b));
    }

    /// Band loss rises with band friction: on each side of the breakpoint mu Q_p = mu (A + s' beta_p T/(2 R_s))/(1 + s' c), which
    /// rises in mu as long as Q_p > 0.
    #[test]
    fn band_loss_rises_with_band_friction(f in any_formulation(), p in any_point(), (a, b) in pair(0.0, 0.2)) {
        let band = |mu_band: f64| Point { mu_band, ..p }.state(&thesis_belt(f)).band_nm;
        rises("band loss", band(a), band(b), b > a + 1e-4 && p.clamp_n > 1.0 && p.ratio.ln().abs() > 1e-3)?;
    }

    /// At fixed forces the bands slide further the further the ratio is from 1, on either side: |1/I - 1| rises faster than the factor
    /// 1 + least/largest wrap falls.
    #[test]
    fn bands_slide_further_away_from_unity(f in any_formulation(), (a, b) in pair(0.0, 1.05), low in any::<bool>()) {
        let belt = thesis_belt(f);
        let slide = |log: f64| {
            let [p, s] = BeltAtRatio::new(&belt, if low { log } else { -log }.exp()).prepared.slide_m;
            p + s
        };
        rises("sliding", slide(a), slide(b), b > a + 1e-6)?;
    }

    /// Wedging and penetration rise with clamping: normal force and deflection are both proportional to it, so penetration is
    /// quadratic and wedging, with its root, more than that.
    #[test]
    fn deflection_losses_rise_with_clamp(f in any_formulation(), p in any_point(), (a, b) in pair(0.0, 50e3)) {
        let p = Point { mu_flank: 0.01 + p.mu_flank, ..p };
        let at = |clamp_n: f64| Point { clamp_n, ..p }.state(&thesis_belt(f));
        let (less, more, twice) = (at(a), at(b), at(2.0 * a));
        rises("wedge", less.losses.wedge_nm, more.losses.wedge_nm, b > a + 1.0)?;
        rises("penetration", less.losses.penetration_nm, more.losses.penetration_nm, b > a + 1.0)?;
        prop_assert!((twice.losses.penetration_nm - 4.0 * less.losses.penetration_nm).abs() <= 1e-12 * twice.losses.penetration_nm);
        prop_assert!(twice.losses.wedge_nm >= 4.0 * less.losses.wedge_nm * (1.0 - 1e-12));
    }

    /// A softer pulley loses more: penetration in proportion, wedging with its root more than that. The primary only off its stop.
    #[test]
    fn deflection_losses_rise_with_compliance(f in any_formulation(), p in any_point(), (a, b) in pair(1e-9, 1e-6), primary in any::<bool>()) {
        let p = Point { mu_flank: 0.13, clamp_n: 1.0 + p.clamp_n, ..p };
        let at = |per_n: f64| {
            let (primary_compliance_per_n, secondary_compliance_per_n) = if primary { (per_n, 0.0) } else { (0.0, per_n) };
            p.state(&Belt { primary_compliance_per_n, secondary_compliance_per_n, ..thesis_belt(f) })
        };
        let strictly = b > a * 1.001 && !(primary && p.ratio >= 2.417);
        let (less, more) = (at(a), at(b));
        rises("wedge", less.losses.wedge_nm, more.losses.wedge_nm, strictly)?;
        rises("penetration", less.losses.penetration_nm, more.losses.penetration_nm, strictly)?;
        prop_assert!((less.losses.penetration_nm * b - more.losses.penetration_nm * a).abs() <= 1e-12 * more.losses.penetration_nm * a);
        prop_assert!(more.losses.wedge_nm * a >= less.losses.wedge_nm * b * (1.0 - 1e-12));
    }

    /// Slip rises with torque from the breakpoint on (C_x >= 0, T >= 0), until it is held: active arc and gaps grow while the idle
    /// arc, over which they close, shrinks. Slip is then never negative: the output turns slower.
    #[test]
    fn slip_rises_with_torque_above_the_breakpoint(p in any_point(), (a, b) in pair(0.0, 400.0)) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { clamp_n: 100.0 + p.clamp_n, mu_segment: 0.05 + p.mu_segment, ..p };
        let from = p.breakpoint_nm(&belt).max(0.0);
        let at = |t: f64| Point { torque_nm: from + t, ..p }.state(&belt);
        let (less, more) = (at(a), at(b));
        rises("slip", less.losses.slip_total, more.losses.slip_total, b > a + 0.1 && more.slip.primary < belt.slip_bound)?;
        // Beyond the blend one branch is alone and its slip is positive.
        prop_assert!(more.tension.compression_n < 9.0 * belt.blend_n || more.losses.slip_total > 0.0);
    }

    /// The same in overrun in high ratio: below the breakpoint (C_x <= 0, T <= 0) the output turns the faster the more it drives.
    /// (In low ratio the bands' pull in the idle arc opposes it, no direction is certain.)
    #[test]
    fn slip_rises_with_overrun_torque_in_high(p in any_point(), log in 0.07..1.05f64, (a, b) in pair(0.0, 400.0)) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { ratio: (-log).exp(), clamp_n: 100.0 + p.clamp_n, mu_segment: 0.05 + p.mu_segment, ..p };
        let from = p.breakpoint_nm(&belt);
        let at = |t: f64| Point { torque_nm: from - t, ..p }.state(&belt);
        let (less, more) = (at(a), at(b));
        rises("overrun slip", -less.losses.slip_total, -more.losses.slip_total, b > a + 0.1 && more.slip.secondary > -belt.slip_bound)?;
        prop_assert!(more.tension.compression_n > -9.0 * belt.blend_n || more.losses.slip_total < 0.0);
    }

    /// Far beyond capacity slip stays at its bound in the sense of the torque, however strongly the bands pull the idle segments the
    /// other way (SL-9, SL-10), and says so. Band friction up to 0.13: with more, a belt in high locks itself.
    #[test]
    fn overload_slips_at_the_bound_in_the_sense_of_torque(p in any_point(), over in 10.0..100.0f64, drive in any::<bool>()) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { clamp_n: p.clamp_n / 50.0, mu_band: 0.65 * p.mu_band, mu_segment: 0.02 + p.mu_segment, ..p };
        let reach = 100.0 + over * p.state(&belt).losses.capacity_nm;
        let from = p.breakpoint_nm(&belt);
        let s = Point { torque_nm: if drive { from.max(0.0) + reach } else { from.min(0.0) - reach }, ..p }.state(&belt);
        let bound = if drive { s.slip.primary } else { -s.slip.secondary };
        prop_assert!(s.losses.gross_slip && s.slip.held && (bound - belt.slip_bound).abs() < 1e-6, "{:?}", s.slip);
        prop_assert_eq!(s.losses.slip_total > 0.0, drive);
    }

    /// More grip, less slip, where one branch is alone (C_x > 9 blend) and torque is positive: every force that slip compares with
    /// grip stays as it is.
    #[test]
    fn slip_falls_with_segment_friction(p in any_point(), (a, b) in pair(0.02, 0.4), over in 10.0..400.0f64) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { clamp_n: 100.0 + p.clamp_n, ..p };
        let p = Point { torque_nm: p.breakpoint_nm(&belt).max(0.0) + over, ..p };
        let at = |mu_segment: f64| Point { mu_segment, ..p }.state(&belt);
        prop_assume!(at(a).tension.compression_n > 9.0 * belt.blend_n);
        rises("slip", at(b).losses.slip_total, at(a).losses.slip_total, b > a + 1e-4 && at(b).slip.primary < belt.slip_bound)?;
        rises("capacity", at(a).losses.capacity_nm, at(b).losses.capacity_nm, b > a + 1e-6)?;
    }

    /// Capacity is proportional to clamping and knows neither torque nor speed nor bands (VA-2).
    #[test]
    fn capacity_is_proportional_to_clamp(f in any_formulation(), p in any_point(), (a, b) in pair(1.0, 50e3)) {
        let belt = thesis_belt(f);
        let p = Point { mu_segment: 0.01 + p.mu_segment, ..p };
        let capacity = |clamp_n: f64| Point { clamp_n, ..p }.state(&belt).losses.capacity_nm;
        rises("capacity", capacity(a), capacity(b), b > a + 1e-3)?;
        prop_assert!((capacity(a) * b - capacity(b) * a).abs() <= 1e-12 * capacity(b) * a);
        let other = Point { torque_nm: 1.0 - p.torque_nm, rpm: 7000.0 - p.rpm, mu_band: 0.01, clamp_n: a, ..p };
        prop_assert_eq!(other.state(&belt).losses.capacity_nm, capacity(a));
    }

    /// The breakpoint, found here by bisecting the sign of C_x, lies at T = R_s mu (2 F_p tan th + m beta_p v2) in low and at the same
    /// torque of overrun in high: linear in clamping and in band friction (TE-5; printed in words, thesis 6.4 and 8.9).
    #[test]
    fn val_breakpoint_is_linear_in_clamp_and_friction(p in any_point(), log in 0.1..1.05f64, low in any::<bool>(), clamp_n in 500.0..25e3f64) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { ratio: if low { log } else { -log }.exp(), clamp_n, mu_band: 0.01 + 0.4 * p.mu_band, film_share: 0.0, ..p };
        let found = |p: &Point| {
            let (mut below, mut above) = (-2000.0, 2000.0);
            for _ in 0..60 {
                let torque_nm = 0.5 * (below + above);
                let at = Point { torque_nm, ..*p };
                if at.state(&belt).tension.compression_n < 0.0 { below = torque_nm } else { above = torque_nm }
            }
            above
        };
        let (at_rest, plain) = (found(&Point { rpm: 0.0, ..p }), found(&p));
        prop_assert!(if low { at_rest > 0.0 } else { at_rest < 0.0 }, "{at_rest}");
        prop_assert!((found(&Point { clamp_n: 2.0 * clamp_n, ..p }) - plain - at_rest).abs() < 1e-9, "not linear in clamp");
        prop_assert!((found(&Point { mu_band: 2.0 * p.mu_band, ..p }) - 2.0 * plain).abs() < 1e-9, "not linear in friction");
        prop_assert!((plain - p.breakpoint_nm(&belt)).abs() < 1e-9, "{plain}");
    }

    /// Band loss is even in C_x but not in torque: it is least at the breakpoint and rises on both sides (BT-3 with TE-2), so that in
    /// low ratio it falls and then rises as the output takes more torque (thesis 8.9).
    #[test]
    fn val_band_loss_is_least_at_the_breakpoint(p in any_point(), (a, b) in pair(0.0, 300.0)) {
        let belt = thesis_belt(Formulation::Smooth);
        let p = Point { mu_band: 0.01 + 0.9 * p.mu_band, film_share: 0.9 * p.film_share, clamp_n: 1000.0 + p.clamp_n, ..p };
        prop_assume!(p.ratio.ln().abs() > 0.07 && b > a + 0.1);
        let middle = p.breakpoint_nm(&belt);
        let band = |t: f64| Point { torque_nm: middle + t, ..p }.state(&belt).band_nm;
        rises("band loss above the breakpoint", band(a), band(b), true)?;
        rises("band loss below the breakpoint", band(-a), band(-b), true)?;
        let even = |t: f64| Point { torque_nm: t, ..p }.state(&belt).band_nm;
        prop_assert!((even(b) - even(-b)).abs() > 1e-6 * even(b), "even in torque");
    }
}
