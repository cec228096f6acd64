//! Unit tests of `model::cycle::gears`.
use cvtcycle_model::cycle::gears::{GearColumns, GearCommand, Note, commands};

use GearCommand::{Change, Declutched, InGear, Neutral};

fn decode(rows: &[(u8, &str)]) -> Vec<GearCommand> {
    commands(
        rows.iter()
            .map(|&(gear, note)| (gear, Note::parse(note).unwrap())),
    )
}

#[test]
fn notes_become_commands() {
    let rows = [
        (0, "PM"),
        (0, "K1"),
        (1, "1"),
        (0, "GC"),
        (0, "GC"),
        (2, ""),
        (0, "K2"),
        (0, ""),
        (3, "pm"),
        (4, "k5"),
    ];
    let expected = [
        Neutral,
        Declutched(1),
        InGear(1),
        Change(2),
        Change(2),
        InGear(2),
        Declutched(2),
        Neutral,
        Neutral,
        Declutched(5),
    ];
    assert_eq!(decode(&rows), expected);
}

#[test]
fn a_change_goes_into_its_own_gear_then_into_the_next_engaged() {
    assert_eq!(decode(&[(3, "GC"), (2, "")]), [Change(3), InGear(2)]);
    assert_eq!(decode(&[(0, "GC"), (0, "K2")]), [Change(2), Declutched(2)]);
    assert_eq!(
        decode(&[(0, "GC"), (0, "PM"), (1, "")]),
        [Change(1), Neutral, InGear(1)]
    );
    assert_eq!(
        decode(&[(4, ""), (0, "GC"), (0, "PM")]),
        [InGear(4), Neutral, Neutral]
    );
}

#[test]
fn only_known_notes_are_taken() {
    for bad in [
        "K", "K0", "K11", "K+1", "KX", "P", "GCC", "K1 ", "é", "11", "-1", "+1",
    ] {
        assert_eq!(Note::parse(bad), None, "{bad}");
    }
}

#[test]
fn a_column_serves_the_gear_counts_it_was_made_for() {
    let columns = GearColumns::new(Some(vec![InGear(5)]), Some(vec![InGear(6)]), None);
    assert_eq!(columns.for_count(5), Some(&[InGear(5)][..]));
    assert_eq!(columns.for_count(6), Some(&[InGear(6)][..]));
    assert_eq!(columns.for_count(4), None);
    let columns = GearColumns::new(Some(vec![InGear(5)]), None, Some(vec![Change(4)]));
    assert_eq!(columns.for_count(3), None);
    assert_eq!(columns.for_count(4), Some(&[Change(4)][..]));
    assert_eq!(columns.for_count(5), Some(&[InGear(5)][..]));
    assert_eq!(columns.for_count(6), Some(&[Change(4)][..]));
}
