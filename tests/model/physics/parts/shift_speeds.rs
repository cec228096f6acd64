//! Unit tests of `model::transmission::manual::gears`.
use cvtcycle_model::transmission::manual::ShiftSpeeds;

#[test]
fn shifts_with_hysteresis() {
    let s = ShiftSpeeds {
        up_m_s: vec![5.0, 10.0],
        down_m_s: vec![3.0, 7.0],
    };
    assert_eq!(s.for_speed(6.0, 1, 3), 2);
    assert_eq!(s.for_speed(4.0, 2, 3), 2);
    assert_eq!(s.for_speed(2.0, 2, 3), 1);
    assert_eq!(s.for_speed(30.0, 0, 3), 3);
    assert_eq!(s.for_speed(8.0, 3, 3), 3);
}
