//! Numbers in reports.

use cvtcycle::report::number::{NONE, Quantity, capital, degc, percent, phase, tiny};

#[test]
fn a_number_keeps_its_unit_and_loses_a_rounded_sign() {
    assert_eq!(Quantity::Fuel.text(7.726), "7.73\u{a0}L/100\u{a0}km");
    assert_eq!(Quantity::Percent.signed(5.94), "+5.9\u{a0}%");
    assert_eq!(Quantity::Percent.signed(-0.01), "0.0\u{a0}%");
    assert_eq!(Quantity::Percent.signed(0.01), "0.0\u{a0}%");
    assert_eq!(Quantity::Percent.bare(-11.93), "\u{2212}11.9");
    assert_eq!(Quantity::Energy.text(27199.1), "27\u{202f}199\u{a0}kJ");
    assert_eq!(
        Quantity::Energy.bare_signed(-1234567.0),
        "\u{2212}1\u{202f}234\u{202f}567"
    );
    assert_eq!(
        (Quantity::Energy.bare(999.96), Quantity::Energy.bare(999.94)),
        ("1000".into(), "999.9".into())
    );
    assert_eq!(
        (phase("ece15"), phase("eudc"), phase("cold_transient")),
        ("ECE15".into(), "EUDC".into(), "cold transient".into())
    );
    assert_eq!(Quantity::Fuel.text(None), NONE);
    assert_eq!(Quantity::Fuel.text(f64::NAN), NONE);
    assert_eq!(
        (degc(-10.0), degc(-0.0), degc(22.5)),
        (
            "\u{2212}10\u{a0}\u{b0}C".into(),
            "0\u{a0}\u{b0}C".into(),
            "22.5\u{a0}\u{b0}C".into()
        )
    );
    assert_eq!(
        (percent(1.0, 8.0), tiny(Some(3.2e-15)), capital("belt_band")),
        ("12.5".into(), "3e\u{2212}15".into(), "Belt band".into())
    );
}
